"""Equations of motion in symbols, against SymPy: `LagrangesMethod` on energies that this module writes down itself.

What the program prints is read back as text, and the difference of each equation to SymPy's is evaluated at random fractions
for every name with fifty digits; entries of M, C and K are subtracted from second derivatives of the energies in symbols.
"""

import re

import sympy
from sympy.physics.mechanics import LagrangesMethod, dynamicsymbols

DIGITS = 50
# Differences below this are rounding errors.
SMALL = sympy.Float("1e-35", DIGITS)
TOKEN = re.compile(r"\s*(?:(?P<number>\d+(?:\.\d+)?)|(?P<name>[A-Za-z_][A-Za-z0-9_]*(?:\[\d+\])*(?:,[A-Za-z0-9_]+)*'*)|(?P<sign>[-+*/^(),=]))")
FUNCTIONS = {"sin": sympy.sin, "cos": sympy.cos, "sqrt": sympy.sqrt, "tan": sympy.tan, "atan2": sympy.atan2}


class Reader:
    """Formulas as the program prints them: a blank multiplies, a slash divides by one factor."""

    def __init__(self, text, names):
        self.tokens, place = [], 0
        text = text.strip()
        while place < len(text):
            found = TOKEN.match(text, place)
            if not found:
                raise ValueError(f"not a formula: {text[place:]}")
            self.tokens.append(next((kind, word) for kind, word in found.groupdict().items() if word))
            place = found.end()
        self.place, self.names = 0, names

    def peek(self):
        return self.tokens[self.place] if self.place < len(self.tokens) else (None, None)

    def take(self):
        self.place += 1
        return self.tokens[self.place - 1]

    def sum(self):
        sign = 1
        if self.peek()[1] == "-":
            self.take()
            sign = -1
        total = sign * self.product()
        while self.peek()[1] in ("+", "-"):
            sign = 1 if self.take()[1] == "+" else -1
            total += sign * self.product()
        return total

    def product(self):
        value = self.power()
        while True:
            kind, word = self.peek()
            if word == "/":
                self.take()
                value = value / self.power()
            elif kind in ("number", "name") or word == "(":
                value = value * self.power()
            else:
                return value

    def power(self):
        base = self.factor()
        if self.peek()[1] == "^":
            self.take()
            return base ** self.factor()
        return base

    def factor(self):
        kind, word = self.take()
        if kind == "number":
            return sympy.Rational(word)
        if word == "(":
            value = self.sum()
            self.take()
            return value
        if word == "pi":
            return sympy.pi
        if word in FUNCTIONS and self.peek()[1] == "(":
            self.take()
            arguments = [self.sum()]
            while self.take()[1] == ",":
                arguments.append(self.sum())
            return FUNCTIONS[word](*arguments)
        return self.names.setdefault(word, sympy.Symbol(word, real=True))


def read(text, names):
    """The formula of a text without an equals sign."""
    reader = Reader(text, names)
    value = reader.sum()
    if reader.place != len(reader.tokens):
        raise ValueError(f"not read to its end: {text}")
    return value


class Scene:
    """A model and its energies. `coordinates` are (body, motion), `bases` the same for prescribed motions."""

    def __init__(self):
        self.rows, self.parameters = [], {}
        self.coordinates, self.symbols = [], []
        self.T = self.V = self.D = sympy.Integer(0)
        self.Q = {}
        self.bases = []

    def parameter(self, name, word, unit):
        self.rows.append(f"param {name} = {word} {unit}")
        self.parameters[name] = sympy.Symbol(name, real=True)
        return self.parameters[name]

    def coordinate(self, body, motion):
        q = dynamicsymbols(f"q{len(self.symbols)}")
        self.coordinates.append((body, motion))
        self.symbols.append(q)
        return q

    def text(self):
        return "model generated\n" + "\n".join(self.rows) + "\n"

    def smaller(self):
        return iter(())


TIME = dynamicsymbols._t


def word(rng, low=1, high=40):
    return str(rng.randint(low, high) / 8)


def links(rng, scene):
    """A chain of rods that hangs from the ground or from a cart, with springs and dampers."""
    g = scene.parameter("g", "9.81", "m/s^2")
    scene.rows.append("gravity g")
    x, carrier = sympy.Integer(0), "ground"
    if rng.random() < 0.6:
        m = scene.parameter("m", word(rng), "kg")
        q = scene.coordinate("cart", "x")
        scene.rows.append("body cart { mass = m, moves x, at = (0, 0) }")
        scene.T += m * q.diff(TIME) ** 2 / 2
        x, carrier = q, "cart"
        if rng.random() < 0.8:
            k = scene.parameter("k", word(rng), "N/m")
            scene.rows.append("spring s: ground -- cart { k = k, along = x }")
            scene.V += k * q ** 2 / 2
        if rng.random() < 0.6:
            c = scene.parameter("c", word(rng), "N*s/m")
            scene.rows.append("damper d: ground -- cart { c = c, along = x }")
            scene.D += c * q.diff(TIME) ** 2 / 2
        if rng.random() < 0.5:
            scene.rows.append("force F: cart along x")
            scene.Q[q] = scene.Q.get(q, 0) + sympy.Symbol("F", real=True)
    top = (x, sympy.Integer(0))
    place = "(0, 0)"
    drawn, before = sympy.Integer(0), None
    for i in range(1, rng.randint(1, 3) + 1):
        m = scene.parameter(f"m{i}", word(rng), "kg")
        length = scene.parameter(f"L{i}", word(rng), "m")
        drawn -= length
        end = "(0, " + " - ".join(["0 m"] + [f"L{j}" for j in range(1, i + 1)]) + ")"
        scene.rows.append(f"point P{i} = {end}")
        scene.rows.append(f"body r{i} {{ mass = m{i}, shape = rod({place}, P{i}) }}")
        scene.rows.append(f"pivot j{i}: {carrier}@{place} -- r{i}")
        q = scene.coordinate(f"r{i}", "angle")
        centre = (top[0] + length / 2 * sympy.sin(q), top[1] - length / 2 * sympy.cos(q))
        top = (top[0] + length * sympy.sin(q), top[1] - length * sympy.cos(q))
        scene.T += m * (centre[0].diff(TIME) ** 2 + centre[1].diff(TIME) ** 2) / 2 + m * length ** 2 / 24 * q.diff(TIME) ** 2
        scene.V += m * g * centre[1]
        if rng.random() < 0.5:
            kt = scene.parameter(f"kt{i}", word(rng), "N*m/rad")
            scene.rows.append(f"spring t{i}: {carrier} -- r{i} {{ k = kt{i} }}")
            scene.V += kt * (q - (before if before is not None else 0)) ** 2 / 2
        if rng.random() < 0.4:
            ct = scene.parameter(f"ct{i}", word(rng), "N*m*s/rad")
            scene.rows.append(f"damper u{i}: {carrier} -- r{i} {{ c = ct{i} }}")
            scene.D += ct * (q - (before if before is not None else 0)).diff(TIME) ** 2 / 2
        if rng.random() < 0.4:
            line(rng, scene, i, top, drawn)
        carrier, place, before = f"r{i}", f"P{i}", q
    if rng.random() < 0.5:
        # Not M: if a model uses that name, the program renames the mass matrix.
        scene.rows.append(f"torque Q3: {carrier}")
        scene.Q[before] = scene.Q.get(before, 0) + sympy.Symbol("Q3", real=True)


def line(rng, scene, i, top, drawn):
    """A spring or damper from the ground to the tip of a link: its length changes as that of a line does."""
    away = scene.parameter(f"a{i}", word(rng), "m")
    length = sympy.sqrt((top[0] - away) ** 2 + (top[1] - drawn) ** 2)
    ends = f"ground@(a{i}, 0 m" + "".join(f" - L{j}" for j in range(1, i + 1)) + f") -- r{i}@P{i}"
    if rng.random() < 0.7:
        k = scene.parameter(f"ks{i}", word(rng), "N/m")
        scene.rows.append(f"spring v{i}: {ends} {{ k = ks{i} }}")
        scene.V += k * (length - away) ** 2 / 2
    else:
        c = scene.parameter(f"cs{i}", word(rng), "N*s/m")
        scene.rows.append(f"damper v{i}: {ends} {{ c = cs{i} }}")
        scene.D += c * length.diff(TIME) ** 2 / 2


def net(rng, scene):
    """Bodies in a row of springs and dampers, with a base and a force."""
    base = rng.random() < 0.5
    u = sympy.Symbol("u", real=True)
    du = sympy.Symbol("u'", real=True)
    if base:
        scene.rows.append("base floor { moves x }")
        scene.bases.append("floor")
    count = rng.randint(1, 4)
    qs = []
    for i in range(1, count + 1):
        m = scene.parameter(f"m{i}", word(rng), "kg")
        scene.rows.append(f"body b{i} {{ mass = m{i}, moves x }}")
        q = scene.coordinate(f"b{i}", "x")
        qs.append(q)
        scene.T += m * q.diff(TIME) ** 2 / 2
    ends = [("ground", 0, 0)] + [(f"b{i}", qs[i - 1], qs[i - 1].diff(TIME)) for i in range(1, count + 1)]
    if base:
        ends.append(("floor", u, du))
    for number in range(rng.randint(count, 2 * count + 1)):
        a, b = rng.sample(range(len(ends)), 2)
        if {ends[a][0], ends[b][0]} <= {"ground", "floor"}:
            continue
        if rng.random() < 0.7:
            k = scene.parameter(f"k{number}", word(rng), "N/m")
            scene.rows.append(f"spring s{number}: {ends[a][0]} -- {ends[b][0]} {{ k = k{number} }}")
            scene.V += k * (ends[a][1] - ends[b][1]) ** 2 / 2
        else:
            c = scene.parameter(f"c{number}", word(rng), "N*s/m")
            scene.rows.append(f"damper d{number}: {ends[a][0]} -- {ends[b][0]} {{ c = c{number} }}")
            scene.D += c * (ends[a][2] - ends[b][2]) ** 2 / 2
    if rng.random() < 0.5:
        q = rng.choice(qs)
        scene.rows.append(f"force F: b{qs.index(q) + 1} along x")
        scene.Q[q] = scene.Q.get(q, 0) + sympy.Symbol("F", real=True)


def scene(rng):
    """A chain of links or a row of masses."""
    made = Scene()
    (links if rng.random() < 0.65 else net)(rng, made)
    return made


def names_of(told):
    """The printed name of each coordinate, from the sentences of the first section."""
    found = {}
    for item in told["sections"][0]["items"]:
        if item["kind"] == "sentence":
            match = re.match(r"(\S+): (angle|displacement) of (\S+?)(?:,| |$)", item["text"])
            if match:
                found[match.group(3), match.group(2)] = match.group(1)
    return found


def section(told, number):
    """The items of a section by the number of its heading."""
    return next((s["items"] for s in told["sections"] if s["heading"].startswith(f"{number} ")), [])


def check(scene, program, tally, rng):
    """Compares the equations of motion at random fractions, and the matrices in symbols."""
    tally.command = "vibc equations MODEL --format json"
    answer = program.run("equations", scene.text(), "--format", "json")
    told = answer.json()
    if told is None:
        tally.refuse(answer.reason())
        return
    printed = names_of(told)
    kind = {"x": "displacement", "y": "displacement", "angle": "angle"}
    labels = [printed[body, kind[motion]] for body, motion in scene.coordinates]
    names = {}
    moving = {}
    for q, label in zip(scene.symbols, labels):
        for order, primes in enumerate(("", "'", "''")):
            moving[q.diff(TIME, order) if order else q] = names.setdefault(label + primes, sympy.Symbol(label + primes, real=True))
    lengths = definitions(told, names)
    method = LagrangesMethod(scene.T - scene.V, scene.symbols)
    own = method.form_lagranges_equations()
    equations = [item["text"] for item in section(told, 3) if item["kind"] == "formula"]
    equations = [text for text in equations if not re.match(r"l_\S+' = ", text)]
    tally.verdict("number of equations", len(equations), len(scene.symbols))
    for q, mine, text in zip(scene.symbols, own, equations):
        mine = mine + scene.D.diff(q.diff(TIME)) - scene.Q.get(q, 0)
        mine = still_times(mine, moving)
        left, right = text.split(" = ")
        theirs = read(left, names) - read(right, names)
        for _ in range(2):
            difference, size = at_fractions(mine, theirs, lengths, rng)
            tally.comparisons += 1
            if not abs(difference) <= SMALL * size:
                tally.violate("equation of motion", text, f"{mine} differs by {difference}")
    matrices(scene, told, names, tally)


def definitions(told, names):
    """Lengths and their rates, in the order in which they may be put in."""
    found = []
    for number in (3, 2):
        for item in section(told, number):
            if item["kind"] == "formula" and re.match(r"l_\S+ = ", item["text"]):
                left, right = item["text"].split(" = ")
                found.append((names.setdefault(left, sympy.Symbol(left, real=True)), read(right, names)))
    return found


def still_times(expression, moving):
    """Derivatives of time functions as names, the highest first."""
    expression = expression.doit()
    for wanted in (2, 1, 0):
        pairs = {old: new for old, new in moving.items() if order_of(old) == wanted}
        expression = expression.xreplace(pairs)
    return expression


def order_of(symbol):
    return symbol.derivative_count if isinstance(symbol, sympy.Derivative) else 0


def at_fractions(mine, theirs, lengths, rng):
    """The difference at random fractions, and the size of what it is the difference of."""
    for name, value in lengths:
        theirs = theirs.subs(name, value)
    names = sorted(mine.free_symbols | theirs.free_symbols, key=str)
    values = {name: sympy.Rational(rng.randint(1, 60), 64) for name in names}
    mine, theirs = (part.subs(values).evalf(DIGITS) for part in (mine, theirs))
    return mine - theirs, 1 + abs(mine)


def matrices(scene, told, names, tally):
    """M, C and K as second derivatives at rest."""
    printed = {item["name"]: item["text"] for item in section(told, 5) if item["kind"] == "matrix"}
    rates = [q.diff(TIME) for q in scene.symbols]
    plain = [sympy.Symbol(f"plain{i}") for i in range(len(rates))]
    quick = dict(zip(rates, plain))
    T, D = scene.T.doit().xreplace(quick), scene.D.doit().xreplace(quick)
    rest = {**{q: 0 for q in scene.symbols}, **{v: 0 for v in plain}}
    for name, energy, by in (("M", T, plain), ("C", D, plain), ("K", scene.V, scene.symbols)):
        rows = printed.get(name)
        for i, a in enumerate(by):
            for j, b in enumerate(by):
                mine = energy.diff(a).diff(b).subs(rest)
                theirs = read(rows[i][j], names) if rows else sympy.Integer(0)
                positive = {s: sympy.Symbol(s.name, positive=True) for s in (mine - theirs).free_symbols}
                tally.comparisons += 1
                if sympy.simplify((mine - theirs).xreplace(positive)) != 0:
                    tally.violate(f"entry of {name}", str(theirs), str(mine))
