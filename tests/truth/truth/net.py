"""Scenes along a line: bodies, springs and dampers between them, the ground and moving bases, as a description.

The description makes both the model's text and, on its own way, the exact matrices of
(M s^2 + C s + K) q = (B0 + B1 s + B2 s^2) u. Numbers are decimal words, so that text and matrices mean the same fraction."""

from copy import deepcopy

from flint import fmpq, fmpq_mat, fmpq_poly

from .tally import decimal

GROUND = -1


def null_space(matrix):
    """A basis of the vectors that a matrix takes to zero."""
    reduced, rank = matrix.rref()
    pivots = [next(j for j in range(matrix.ncols()) if reduced[i, j] != 0) for i in range(rank)]
    found = []
    for column in (j for j in range(matrix.ncols()) if j not in pivots):
        v = [fmpq(0)] * matrix.ncols()
        v[column] = fmpq(1)
        for row, pivot in enumerate(pivots):
            v[pivot] = -reduced[row, column]
        found.append(v)
    return found


class Net:
    """Bodies `b0, b1, ...`; ends of elements are numbers of bodies, GROUND, or ("base", i)."""

    def __init__(self):
        self.masses = []
        self.springs = []
        self.dampers = []
        self.bases = []
        self.forces = []
        self.outputs = []
        self.initial = {}
        self.damping = None
        self.lines = []
        self.parameters = {}
        self.signals = []

    # --- text

    @property
    def tables(self):
        """The files of the signals, by name."""
        self.name_tables()
        return {s.name: s.content() for s in self.signals if hasattr(s, "content")}

    def name_tables(self):
        """Gives each table a file name of its own."""
        for i, signal in enumerate(s for s in self.signals if hasattr(s, "content")):
            signal.name = f"table{i}.csv"

    def driven(self, first, unit):
        """What drives the first base or force: the signals, if there are some."""
        words = " + ".join(s.text(unit) for s in self.signals if hasattr(s, "text")) if first else ""
        return f" = {words}" if words else ""

    def text(self):
        """The model."""
        rows = ["model truth"]
        self.name_tables()
        rows += [f"param {name} = {value}" for name, value in self.parameters.items()]
        rows += [f"base u{i} {{ moves x }}" + self.driven(i == 0, "m") for i, _ in enumerate(self.bases)]
        rows += [f"body b{i} {{ mass = {with_unit(m, 'kg')}, moves x }}" for i, m in enumerate(self.masses)]
        for word, elements, field, unit in (("spring", self.springs, "k", "N/m"), ("damper", self.dampers, "c", "N*s/m")):
            for i, (a, b, value) in enumerate(elements):
                rows.append(f"{word} {field}{i}: {end(a)} -- {end(b)} {{ {field} = {with_unit(value, unit)} }}")
        for i, at in enumerate(self.forces):
            rows.append(f"force F{i}: b{at} along x" + self.driven(i == 0 and not self.bases, "N"))
        for i, terms in enumerate(self.outputs):
            rows.append(f"output y{i} = " + " + ".join(term(*part) for part in terms))
        for i, (x, v) in self.initial.items():
            rows.append(f"initial b{i} {{ x = {x} m, vx = {v} m/s }}")
        if self.damping:
            kind, *values = self.damping
            words = {"modal": "modal {0}", "rayleigh": "rayleigh({0} /s, {1} s)"}[kind]
            rows.append("damping " + words.format(*values))
        return "\n".join(rows + self.lines) + "\n"

    # --- matrices

    def size(self):
        return len(self.masses)

    def mass(self, replaced=None):
        """M."""
        size = self.size()
        rows = fmpq_mat(size, size)
        for i, m in enumerate(self.masses):
            rows[i, i] = self.fraction(m, replaced)
        return rows

    def network(self, elements, replaced=None):
        """K of springs or C of dampers, and the columns that bases drive through them."""
        size = self.size()
        matrix = fmpq_mat(size, size)
        columns = fmpq_mat(size, max(len(self.bases), 1))
        for a, b, word in elements:
            value = self.fraction(word, replaced)
            for p, q in ((a, b), (b, a)):
                if not free(p):
                    continue
                matrix[p, p] += value
                if free(q):
                    matrix[p, q] -= value
                elif q != GROUND:
                    columns[p, q[1]] += value
        return matrix, columns

    def matrices(self, replaced=None):
        """M, C, K, without what `damping modal` adds."""
        m = self.mass(replaced)
        c, _ = self.network(self.dampers, replaced)
        k, _ = self.network(self.springs, replaced)
        if self.damping and self.damping[0] == "rayleigh":
            c = c + m * decimal(self.damping[1]) + k * decimal(self.damping[2])
        return m, c, k

    def fraction(self, word, replaced=None):
        """A number as written; words that begin with @ name a parameter, perhaps times a number: `@p`, `2*@p`."""
        if "@" not in word:
            return decimal(word)
        factor, _, name = word.rpartition("@")
        value = (replaced or {}).get(name)
        if value is None:
            value = decimal(self.parameters[name].split()[0])
        return value * (decimal(factor.rstrip("* ")) if factor else 1)

    def inputs(self):
        """Names of the inputs, in the program's order: forces and bases as declared; bases come first in the text."""
        return [f"u{i}" for i in range(len(self.bases))] + [f"F{i}" for i in range(len(self.forces))]

    def column(self, name):
        """B(s) of an input: for each coordinate the coefficients of 1, s, s^2."""
        size = self.size()
        column = [[fmpq(0)] * 3 for _ in range(size)]
        i = int(name[1:])
        if name[0] == "F":
            column[self.forces[i]][0] += 1
            return column
        k = self.network(self.springs)[1]
        c = self.network(self.dampers)[1]
        for j in range(size):
            column[j][0] += k[j, i]
            column[j][1] += c[j, i]
        if self.damping and self.damping[0] == "rayleigh":
            alpha, beta = (decimal(word) for word in self.damping[1:])
            momentum = self.mass() * self.carried([k[j, i] for j in range(size)])
            for j in range(size):
                column[j][1] += beta * k[j, i] + alpha * momentum[j, 0]
        return column

    def carried(self, pushed):
        """What follows a base statically, K r = pushed, with no momentum in motions that K does not restrain."""
        size = self.size()
        m, (k, _) = self.mass(), self.network(self.springs)
        unrestrained = null_space(k)
        count = len(unrestrained)
        whole, right = fmpq_mat(size + count, size + count), fmpq_mat(size + count, 1)
        for i in range(size):
            right[i, 0] = pushed[i]
            for j in range(size):
                whole[i, j] = k[i, j]
        for at, v in enumerate(unrestrained):
            for i in range(size):
                whole[size + at, i] = whole[i, size + at] = m[i, i] * v[i]
        r = whole.solve(right)
        return fmpq_mat(size, 1, [r[i, 0] for i in range(size)])

    def row(self, i, name=None):
        """P(s) of output i: for each coordinate the coefficients of 1, s, s^2; and D(s) from the input `name`."""
        size = self.size()
        row = [[fmpq(0)] * 3 for _ in range(size)]
        direct = [fmpq(0)] * 3
        for factor, kind, which in self.outputs[i]:
            f = decimal(factor)
            if kind in ("x", "vx", "ax"):
                power = ("x", "vx", "ax").index(kind)
                row[which][power] += f
                continue
            elements, power = (self.springs, 0) if kind[0] == "k" else (self.dampers, 1)
            a, b, word = elements[which]
            value = f * (self.fraction(word) if kind.endswith("force") else 1)
            for place, sign in ((b, 1), (a, -1)):
                if free(place):
                    row[place][power] += sign * value
                elif place != GROUND and name == f"u{place[1]}":
                    direct[power] += sign * value
        return row, direct

    # --- smaller scenes

    def smaller(self):
        """Scenes with less in them, to look for the smallest one that still shows a violation."""
        for name in ("dampers", "springs", "forces", "outputs"):
            items = getattr(self, name)
            if name in ("forces", "outputs") and len(items) < 2:
                continue
            for i in reversed(range(len(items))):
                if name != "outputs" and self.refers(name, i):
                    continue
                copy = deepcopy(self)
                del getattr(copy, name)[i]
                yield copy
        for i in reversed(range(self.size())):
            if self.size() > 1:
                copy = self.without(i)
                if copy is not None:
                    yield copy
        for i in range(len(self.signals) if len(self.signals) > 1 else 0):
            copy = deepcopy(self)
            del copy.signals[i]
            yield copy
        for i in list(self.initial):
            copy = deepcopy(self)
            del copy.initial[i]
            yield copy
        for digits in (1, 2, 4):
            yield from self.shorter(digits)

    def refers(self, name, i):
        """Whether an output or a question needs this element or a later one of its kind."""
        letter = {"dampers": "c", "springs": "k", "forces": "-"}[name]
        named = any(kind[0] == letter and "." in kind and which >= i for terms in self.outputs for _, kind, which in terms)
        return named or (name == "forces" and any("F" in line for line in self.lines))

    def without(self, i):
        """The scene without body i and all that hangs on it."""
        if self.lines or any(w == i and kind in ("x", "vx", "ax") for terms in self.outputs for _, kind, w in terms):
            return None
        if any("." in kind for terms in self.outputs for _, kind, _ in terms) or i in self.forces:
            return None
        copy = deepcopy(self)

        def moved(place):
            return place - 1 if free(place) and place > i else place

        del copy.masses[i]
        copy.springs = [(moved(a), moved(b), v) for a, b, v in self.springs if i not in (a, b)]
        copy.dampers = [(moved(a), moved(b), v) for a, b, v in self.dampers if i not in (a, b)]
        copy.forces = [moved(at) for at in self.forces]
        copy.outputs = [[(f, kind, moved(w)) for f, kind, w in terms] for terms in self.outputs]
        copy.initial = {moved(j): state for j, state in self.initial.items() if j != i}
        return copy

    def shorter(self, digits):
        """The scene with one number rounded to a few digits."""
        for i, m in enumerate(self.masses):
            if rounded(m, digits) != m:
                copy = deepcopy(self)
                copy.masses[i] = rounded(m, digits)
                yield copy
        for name in ("springs", "dampers"):
            for i, (a, b, value) in enumerate(getattr(self, name)):
                if rounded(value, digits) != value:
                    copy = deepcopy(self)
                    getattr(copy, name)[i] = (a, b, rounded(value, digits))
                    yield copy


def free(place):
    """Whether an end is on a body."""
    return isinstance(place, int) and place >= 0


def end(place):
    """An end as the language writes it."""
    if place == GROUND:
        return "ground"
    return f"u{place[1]}" if isinstance(place, tuple) else f"b{place}"


def with_unit(word, unit):
    """A number with its unit, or a parameter that has one."""
    return word.replace("@", "") if "@" in word else f"{word} {unit}"


def term(factor, kind, which):
    """A term of an output: `x`, `vx`, `ax` of a body; `k.force`, `c.force`, `k.stretch` of an element."""
    name = f"b{which}.{kind}" if "." not in kind else f"{kind[0]}{which}.{kind[2:]}"
    return name if factor == "1" else f"{factor}*{name}"


def rounded(word, digits):
    """A number with fewer digits; what holds a parameter or is short already stays."""
    if "@" in word or len(word.strip("-0.")) <= digits:
        return word
    return f"{float(word):.{digits}g}" if abs(float(word)) < 1e300 else word


def entry(part, i, j):
    """An entry of a polynomial matrix, as a polynomial."""
    return fmpq_poly([matrix[i, j] for matrix in part])
