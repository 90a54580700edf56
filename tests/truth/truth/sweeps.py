"""Cases of `vibc sweep`: nets whose masses, springs, dampers and slanted springs are functions of a few parameters, one or two of which
take many values. Frequencies and poles of some of the cases, from characteristic polynomials in exact arithmetic, lie within the bounds
that stand beside them, however many cases the program computes at once."""

import math

from flint import arb, arb_mat, ctx, fmpq, fmpq_mat

from . import draw
from .exact import I, pi, roots
from .loaded import Text
from .tally import decimal
from .tolerated import FORMS

BITS = 250
COMPARED = 10


class Beyond(Exception):
    """A case of which nothing is known here: bodies without mass, for the matrices are divided by masses; springs that hold too little."""


class Study:
    """Parameters, weights of them, and the values that some of them take."""

    def __init__(self, rng):
        self.values, self.rows = {}, ["model truth"]
        for kind, unit in (("m", "kg"), ("k", "N/m"), ("c", "N*s/m"), ("h", "m")):
            for i in range(rng.choice((1, 1, 2))):
                self.values[f"{kind}{i}"] = (draw.decimal_word(rng, -2 if kind == "c" else -1, 1, rng.choice((1, 2, 3))), unit)
        self.rows += [f"param {name} = {value} {unit}" for name, (value, unit) in self.values.items()]
        n = rng.choice((1, 2, 2, 3, 3, 4, 5, 6))
        self.masses = [self.weight(rng, "m", "kg") for _ in range(n)]
        links = [(-1, 0)] + [(rng.randrange(i), i) for i in range(1, n)]
        links += [(rng.randrange(-1, n), rng.randrange(n)) for _ in range(rng.choice((0, 1, 2)))]
        links = [(a, b) for a, b in links if a != b]
        self.springs = [(a, b, self.weight(rng, "k", "N/m")) for a, b in links]
        is_damped = rng.random() < 0.6
        self.dampers = [(a, b, self.weight(rng, "c", "N*s/m")) for a, b in links if is_damped and rng.random() < 0.7]
        self.rows += [f"body b{i} {{ mass = {m[0]}, at = ({i} m, 0 m), moves x }}" for i, m in enumerate(self.masses)]
        end = lambda a: f"ground@(-1 m, 0 m)" if a < 0 else f"b{a}"
        for word, field, elements in (("spring", "k", self.springs), ("damper", "c", self.dampers)):
            self.rows += [f"{word} {field}_{i}: {end(a)} -- {end(b)} {{ {field} = {w[0]} }}" for i, (a, b, w) in enumerate(elements)]
        self.slanted = []
        for _ in range(rng.choice((0, 0, 1, 2))):
            self.slant(rng)

    def weight(self, rng, kind, unit):
        """A number or a function of parameters of this kind, as text and as a function."""
        if rng.random() < 0.4:
            word = draw.decimal_word(rng, -1, 1, rng.choice((1, 2, 3)))
            return f"{word} {unit}", lambda values: decimal(word)
        own = [name for name in self.values if name[0] == kind]
        p, q = rng.choice(own), rng.choice(own)
        text, of = rng.choice(FORMS) if rng.random() < 0.5 else FORMS[0]
        return text.format(p=p, q=q), lambda values: of(values[p], values[q])

    def slant(self, rng):
        """A spring from a place above a body, not stretched as drawn: k d^2 / (d^2 + h^2) along x."""
        body, word = rng.randrange(len(self.masses)), draw.decimal_word(rng, 0, 1, 2)
        h, k, d = rng.choice([name for name in self.values if name[0] == "h"]), self.weight(rng, "k", "N/m"), decimal(word)
        self.rows.append(f"spring slanted_{len(self.slanted)}: ground@({body} m - {word} m, {h}) -- b{body} {{ k = {k[0]} }}")
        self.slanted.append((body, lambda values: k[1](values) * d * d / (d * d + values[h] ** 2)))

    def choose(self, rng):
        """What is varied: options, and the values of every case in their order."""
        used = [name for name in self.values if any(name in row for row in self.rows if not row.startswith("param"))]
        names = rng.sample(used, min(len(used), rng.choice((1, 1, 1, 2))))
        options, lists = ["--modes", str(len(self.masses)), "--poles"], []
        if rng.random() < 0.2:
            options += ["--tolerance", rng.choice(("1e-13", "1e-7"))]
        for name in names:
            value, unit = self.values[name]
            x = float(decimal(value))
            low, high = f"{x * rng.choice((0, 0.01, 0.3, 0.9, 0.99)):.4g}", f"{x * rng.choice((1, 1.02, 2, 5)) * 1.01:.4g}"
            count = rng.choice((2, 9, 40, 200) if len(names) == 1 else (3, 12))
            if rng.random() < 0.2:
                words = [f"{x * rng.uniform(0.2, 3):.4g}" for _ in range(count)]
                options += ["--over", f"{name}=" + ",".join(word + unit for word in words)]
                lists.append([decimal(word) for word in words])
            else:
                options += ["--over", f"{name}={low}{unit}..{high}{unit}:{count}"]
                a, b = decimal(low), decimal(high)
                lists.append([a + (b - a) * fmpq(i, count - 1) for i in range(count)])
        cases = [{}]
        for name, values in zip(names, lists):
            cases = [case | {name: value} for case in cases for value in values]
        return options, cases

    def exact(self, case):
        """The squares of the undamped frequencies, ascending, and all poles; `None` where a mass is negative."""
        values = {name: decimal(value) for name, (value, _) in self.values.items()} | case
        masses = [m[1](values) for m in self.masses]
        if any(x == 0 for x in masses):
            raise Beyond
        if any(x < 0 for x in masses):
            return None
        n = len(masses)
        matrices = []
        for links in (self.springs, self.dampers):
            matrix = [[fmpq(0)] * n for _ in range(n)]
            for a, b, weight in links:
                x = weight[1](values)
                for i, j, sign in ((a, a, 1), (b, b, 1), (a, b, -1), (b, a, -1)):
                    if i >= 0 and j >= 0:
                        matrix[i][j] += sign * x
            matrices.append(matrix)
        k, c = matrices
        for body, weight in self.slanted:
            k[body][body] += weight(values)
        over = lambda matrix: [[x / masses[i] for x in row] for i, row in enumerate(matrix)]
        k, c = over(k), over(c)
        squares = sorted((r.real for r, count in roots(fmpq_mat(k).charpoly()) for _ in range(count)), key=lambda x: float(x.mid()))
        rows = [[fmpq(0)] * n + [fmpq(int(i == j)) for j in range(n)] for i in range(n)]
        rows += [[-x for x in k[i]] + [-x for x in c[i]] for i in range(n)]
        return squares, [root for root, count in roots(fmpq_mat(rows).charpoly()) for _ in range(count)]


def scene(rng):
    return with_cases(Study(rng), rng)


def with_cases(study, rng):
    net = Text("\n".join(study.rows) + "\n")
    net.study = study
    net.options, net.cases = study.choose(rng)
    return net


def has_numbers(row, truth, tally):
    """Whether a case can be compared: one without a truth has to be told as one, and others may be refused."""
    if truth is None:
        tally.verdict("a case without a meaning is told as one", bool(row.get("code")), True)
    elif row.get("code"):
        tally.refuse(row["code"])
    return truth is not None and not row.get("code")


def check(net, program, tally, rng):
    """Some of the cases, the first and the last among them."""
    told = program.ask(tally, "sweep", net.text(), "--format", "json", *net.options)
    if told is None or "cases" not in told:
        return
    ctx.prec = BITS
    tally.verdict("number of cases", len(told["cases"]), len(net.cases))
    places = {column["name"]: at for at, column in enumerate(told["columns"])}
    chosen = {0, len(net.cases) - 1} | {rng.randrange(len(net.cases)) for _ in range(COMPARED)}
    for number in sorted(chosen):
        row = told["cases"][number]
        try:
            truth = net.study.exact(net.cases[number])
        except Beyond:
            continue
        except ZeroDivisionError:
            truth = None
        if not has_numbers(row, truth, tally):
            continue
        value = lambda name: (row["values"][places[name]], row["error_bounds"][places[name]])
        squares, poles = truth
        for i, square in enumerate(squares):
            told_value, bound = value(f"frequency_{i + 1}")
            if square > 0:
                tally.absolute("frequency", told_value, bound, square.sqrt() / (2 * pi()))
            else:
                tally.refuse("a motion that does not oscillate")
        listed = [i for i in range(1, 2 * len(squares) + 1) if f"pole_{i}_re" in places]
        left = list(poles)
        for i in listed:
            (re, re_bound), (im, im_bound) = value(f"pole_{i}_re"), value(f"pole_{i}_im")
            if re is None or im is None:
                tally.without_bound += 1
                continue
            nearest = min(range(len(left)), key=lambda j: abs(complex(re, im) - complex(left[j].mid())))
            true = left.pop(nearest)
            tally.absolute("real part of a pole", re, re_bound, true.real, abs(true))
            tally.absolute("imaginary part of a pole", im, im_bound, true.imag, abs(true))


# Rods one on another under gravity, held by torsion springs that hold more than every weight turns: the potential is convex, and there is
# one rest, which moves with masses, lengths and springs.

GRAVITY = fmpq(981, 100)
# rad N*m: what the springs hold more than the weights turn by, at least; a residual over it is as far as the rest can be.
SPARE = fmpq(1, 10)


class Rods(Study):
    """One or two rods; masses stand at their ends."""

    def __init__(self, rng):
        self.values, self.rows = {}, ["model truth", "gravity 9.81 m/s^2", "point P0 = (0 m, 0 m)"]
        n = rng.choice((1, 2, 2))
        self.masses = [None] * n
        number = lambda low, high: f"{rng.uniform(low, high):.3g}"
        for i in range(n):
            self.values |= {f"m{i}": (number(0.5, 3), "kg"), f"l{i}": (number(0.3, 1.5), "m"), f"k{i}": (number(150, 500), "N*m/rad")}
        self.rows += [f"param {name} = {value} {unit}" for name, (value, unit) in self.values.items()]
        self.inertia = rng.choice(("0.05", "1e-3", "2"))
        self.ways = [(f"{x:.3f}", f"{y:.3f}") for x, y in ((math.cos(a), math.sin(a)) for a in (rng.uniform(-3, 1) for _ in range(n)))]
        before = lambda i: f"b{i - 1}" if i else "ground"
        for i, (x, y) in enumerate(self.ways):
            self.rows.append(f"point P{i + 1} = P{i} + l{i} * ({x}, {y})")
        for i in range(n):
            self.rows.append(f"body b{i} {{ mass = m{i}, inertia = {self.inertia} kg*m^2, at = P{i + 1} }}")
            self.rows.append(f"pivot p{i}: {before(i)}@P{i} -- b{i}@P{i}")
            self.rows.append(f"spring s{i}: {before(i)} -- b{i} {{ k = k{i} }}")
        self.dampers = []

    def exact(self, case):
        """As above."""
        values = {name: decimal(value) for name, (value, _) in self.values.items()} | case
        n = len(self.ways)
        mass, length, spring = ([values[f"{kind}{i}"] for i in range(n)] for kind in "mlk")
        if any(x <= 0 for x in mass + length + spring):
            raise Beyond
        above = [GRAVITY * sum(mass[i:]) for i in range(n)]
        stiffness = [[fmpq(0)] * n for _ in range(n)]
        for i, k in enumerate(spring):
            stiffness[i][i] += k
            if i:
                stiffness[i - 1][i - 1] += k
                stiffness[i][i - 1] -= k
                stiffness[i - 1][i] -= k
        drawn = [(decimal(x) * l, decimal(y) * l) for (x, y), l in zip(self.ways, length)]
        # The longest that a rod can be in any direction is |x| + |y|.
        spare = fmpq_mat([[stiffness[i][j] - (i == j) * (above[i] * sum(map(abs, drawn[i])) + SPARE) for j in range(n)] for i in range(n)])
        if spare[0, 0] <= 0 or spare.det() <= 0:
            raise Beyond
        turn = [arb(0)] * n
        for _ in range(40):
            turned = [(a.cos() * x - a.sin() * y, a.sin() * x + a.cos() * y) for a, (x, y) in zip(turn, drawn)]
            force = [above[i] * turned[i][0] + sum(stiffness[i][j] * turn[j] for j in range(n)) for i in range(n)]
            k = arb_mat(n, n, [stiffness[i][j] - (above[i] * turned[i][1] if i == j else 0) for i in range(n) for j in range(n)])
            step = k.solve(arb_mat(n, 1, force))
            turn = [(turn[i] - step[i, 0]).mid() for i in range(n)]
        turned = [(a.cos() * x - a.sin() * y, a.sin() * x + a.cos() * y) for a, (x, y) in zip(turn, drawn)]
        force = [above[i] * turned[i][0] + sum(stiffness[i][j] * turn[j] for j in range(n)) for i in range(n)]
        reach = sum(abs(f) for f in force) / SPARE
        turn = [a + arb(0, reach.upper()) for a in turn]
        turned = [(a.cos() * x - a.sin() * y, a.sin() * x + a.cos() * y) for a, (x, y) in zip(turn, drawn)]
        k = [[stiffness[i][j] - (above[i] * turned[i][1] if i == j else 0) for j in range(n)] for i in range(n)]
        m = [[sum(mass[max(i, j):]) * (turned[i][0] * turned[j][0] + turned[i][1] * turned[j][1]) + (decimal(self.inertia) if i == j else 0) for j in range(n)] for i in range(n)]
        if n == 1:
            squares = [k[0][0] / m[0][0]]
        else:
            # det (K - x M) = a x^2 - 2 b x + c
            a, c = (q[0][0] * q[1][1] - q[0][1] * q[1][0] for q in (m, k))
            b = (m[0][0] * k[1][1] + m[1][1] * k[0][0] - m[0][1] * k[1][0] - m[1][0] * k[0][1]) / 2
            high = b + (b * b - a * c).sqrt()
            squares = [c / high, high / a]
        poles = [sign * I * square.sqrt() for square in squares for sign in (-1, 1)]
        return squares, poles


def scene_at_rest(rng):
    return with_cases(Rods(rng), rng)
