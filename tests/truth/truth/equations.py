"""Equations of motion in symbols, against SymPy: `LagrangesMethod` on energies that this module writes down itself.

What the program prints is read back as text. The difference of each equation to SymPy's is evaluated at random fractions for every name with
fifty digits; so are constraints, conditions of rest, velocity ratios and the equations without multipliers. Entries of M, C, K and of the
input columns are computed from second derivatives of the energies at a rest that is solved for here with forty digits, and compared with
the text of each entry at these values and with the number that is printed for it, within its bound.
"""

import re

import mpmath
import sympy
from sympy.physics.mechanics import LagrangesMethod, dynamicsymbols

DIGITS = 50
mpmath.mp.dps = DIGITS
# Differences are rounding alone below this.
SMALL = mpmath.mpf(10) ** -35
TOKEN = re.compile(r"\s*(?:(?P<number>\d+(?:\.\d+)?)|(?P<name>[A-Za-z_][A-Za-z0-9_]*(?:\[\d+\])*(?:\.[A-Za-z_][A-Za-z0-9_]*(?:\[\d+\])*)*(?:,[A-Za-z0-9_]+)*'*)|(?P<sign>[-+*/^(),=]))")
FUNCTIONS = {"sin": sympy.sin, "cos": sympy.cos, "sqrt": sympy.sqrt, "tan": sympy.tan, "asin": sympy.asin, "atan": sympy.atan, "atan2": sympy.atan2, "abs": sympy.Abs}


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

    # Rounding of the oracle beside a bound.
    digits = -32
    # How far things are moved where equations are compared.
    reach = 1

    def __init__(self):
        self.rows, self.parameters = [], {}
        self.coordinates, self.symbols = [], []
        self.T = self.V = self.D = sympy.Integer(0)
        self.Q = {}
        self.bases = []
        # The place on which each component of an unbalance acts, and what the angular frequencies are that have a name.
        self.rotors, self.speeds = {}, {}
        # What is held at zero, in the order of the joints and couplings.
        self.constraints = []

    def parameter(self, name, word, unit):
        self.rows.append(f"param {name} = {word} {unit}")
        self.parameters[name] = sympy.Symbol(name, real=True)
        return self.parameters[name]

    def coordinate(self, body, motion):
        q = dynamicsymbols(f"q{len(self.symbols)}")
        self.coordinates.append((body, motion))
        self.symbols.append(q)
        return q

    def unbalance(self, name, place, size, speed, sense=1):
        """The force of a heavy spot, the opposite of its momentum's rate, on a point that is where `place` says.

        `speed` is the name of a parameter in rad/s, a form of the angular frequency that has none, or None: then the angle is a name."""
        t = sympy.Symbol("t", real=True)
        if speed is None:
            angle, rate, more = (sympy.Symbol(f"phi_{name}" + primes, real=True) for primes in ("", "'", "''"))
            derived = lambda f: f.diff(angle) * rate + f.diff(rate) * more
        else:
            omega = self.parameters.get(speed)
            if omega is None:
                # A speed in Hz: the angular frequency has a name, whose definition is read.
                omega = sympy.Symbol(f"omega_{name}", real=True)
                self.speeds[omega.name] = speed
            angle = omega * t
            derived = lambda f: f.diff(t)
        for axis, (along, where) in enumerate(zip((sympy.cos(angle), sense * sympy.sin(angle)), place)):
            force = -derived(derived(size * along))
            self.rotors[f"{name}.{'xy'[axis]}"] = where
            for q in self.symbols:
                self.Q[q] = self.Q.get(q, 0) + force * where.diff(q)

    def rotor(self, rng, ends, place):
        """An unbalance of some speed, or without one."""
        size = self.parameter("mu", word(rng), "kg*m")
        kind, clockwise = rng.randrange(3), rng.random() < 0.5
        speed = None
        if kind == 0:
            self.parameter("Omega", word(rng), "rad/s")
            speed = "Omega"
        elif kind == 1:
            speed = 2 * sympy.pi * self.parameter("f", word(rng), "Hz")
        given = ["", ", speed = Omega", ", speed = f"][0 if speed is None else 1 + kind]
        self.rows.append(f"unbalance U: {ends} {{ me = mu{given}{', clockwise' if clockwise else ''} }}")
        self.unbalance("U", place, size, speed, -1 if clockwise else 1)

    def moved_by(self):
        """Motions of bases that are functions of time here, each with its printed name."""
        return [base for base in self.bases if isinstance(base, tuple)]

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
    if rng.random() < 0.4:
        scene.rotor(rng, f"{carrier}@{place}", top)
    if rng.random() < 0.5:
        # Not M: if a model uses that name, the program renames the mass matrix.
        scene.rows.append(f"torque Q3: {carrier}")
        scene.Q[before] = scene.Q.get(before, 0) + sympy.Symbol("Q3", real=True)


def line(rng, scene, i, top, drawn):
    """A spring or damper from the ground to the tip of a link: its length changes as that of a line does."""
    away = scene.parameter(f"a{i}", word(rng), "m")
    length = sympy.sqrt((top[0] - away) ** 2 + (top[1] - drawn) ** 2)
    ends = f"ground@(a{i}, 0 m" + "".join(f" - L{j}" for j in range(1, i + 1)) + f") -- r{i}@P{i}"
    kind = rng.random()
    if kind < 0.2:
        b = scene.parameter(f"bs{i}", word(rng), "kg")
        scene.rows.append(f"inerter v{i}: {ends} {{ b = bs{i} }}")
        scene.T += b * length.diff(TIME) ** 2 / 2
    elif kind < 0.7:
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
    if rng.random() < 0.3:
        q = rng.choice(qs)
        scene.rotor(rng, f"b{qs.index(q) + 1}", (q, sympy.Integer(0)))


def turn(arm, angle):
    return (arm[0] * sympy.cos(angle) - arm[1] * sympy.sin(angle), arm[0] * sympy.sin(angle) + arm[1] * sympy.cos(angle))


def plus(a, b):
    return (a[0] + b[0], a[1] + b[1])


def minus(a, b):
    return (a[0] - b[0], a[1] - b[1])


def rod(scene, mass, ends, q, at):
    """Energies of a rod between two drawn points that turns by q; `at` tells where its first end is now."""
    a, b = ends
    arm = minus(b, a)
    centre = plus(at, turn((arm[0] / 2, arm[1] / 2), q))
    inertia = mass * (arm[0] ** 2 + arm[1] ** 2) / 12
    scene.T += mass * (centre[0].diff(TIME) ** 2 + centre[1].diff(TIME) ** 2) / 2 + inertia * q.diff(TIME) ** 2 / 2
    return centre, plus(at, turn(arm, q))


def four_bar(rng, scene):
    """A linkage of three bars, drawn at fractions; with gravity it rests away from the drawing."""
    def fraction(low, high):
        return sympy.Rational(rng.randint(low, high), 8)

    a, d = (sympy.Integer(0), sympy.Integer(0)), (fraction(20, 28), fraction(-3, 3))
    b, c = (fraction(3, 8), fraction(-16, -9)), (fraction(14, 20), fraction(-16, -9))
    drawn = {name: f"({float(point[0])} m, {float(point[1])} m)" for name, point in (("A", a), ("B", b), ("C", c), ("D", d))}
    scene.rows += [f"point {name} = {text}" for name, text in drawn.items()]
    masses = [scene.parameter(f"m{i}", word(rng), "kg") for i in (1, 2, 3)]
    for body, i, ends in (("left", 1, "A, B"), ("bar", 2, "B, C"), ("right", 3, "C, D")):
        scene.rows.append(f"body {body} {{ mass = m{i}, shape = rod({ends}) }}")
    scene.rows += ["pivot a: ground@A -- left", "pivot b: left@B -- bar", "pivot c: bar@C -- right", "pivot d: right@D -- ground"]
    q = [scene.coordinate(body, "angle") for body in ("left", "bar", "right")]
    left, at_b = rod(scene, masses[0], (a, b), q[0], a)
    bar, at_c = rod(scene, masses[1], (b, c), q[1], at_b)
    right, other_c = rod(scene, masses[2], (d, c), q[2], d)
    scene.constraints += list(minus(other_c, at_c))
    k = scene.parameter("kt", str(rng.randint(300, 800) / 8), "N*m/rad")
    scene.rows.append("spring t: ground -- left { k = kt }")
    scene.V += k * q[0] ** 2 / 2
    if rng.random() < 0.6:
        g = scene.parameter("g", "9.81", "m/s^2")
        scene.rows.append("gravity g")
        scene.V += g * sum(m * centre[1] for m, centre in zip(masses, (left, bar, right)))
    if rng.random() < 0.5:
        ct = scene.parameter("ct", word(rng), "N*m*s/rad")
        scene.rows.append("damper u: ground -- right { c = ct }")
        scene.D += ct * q[2].diff(TIME) ** 2 / 2
    if rng.random() < 0.5:
        scene.rows.append("force F: bar along x")
        for coordinate in q:
            scene.Q[coordinate] = sympy.Symbol("F", real=True) * bar[0].diff(coordinate)


def bead(rng, scene):
    """A bead that slides on an arm, held by a spring: it rests lower than it is drawn."""
    g = scene.parameter("g", "9.81", "m/s^2")
    r, m, J, k = (scene.parameter(*row) for row in (("r", word(rng), "m"), ("m", word(rng), "kg"), ("J", word(rng), "kg*m^2"), ("k", word(rng, 160, 400), "N/m")))
    scene.rows += ["gravity g", "body arm { mass = 3 kg, inertia = J, at = (0, 0) }", "body bead { mass = m, inertia = 0 kg*m^2, at = (0, -r) }",
                   "pivot p: ground@(0, 0) -- arm", "slide s: arm -- bead along (0, -1)", "spring h: arm@(0, 0) -- bead { k = k, free_length = r }"]
    q, s = scene.coordinate("arm", "angle"), scene.coordinate("bead", "slide")
    place = turn((sympy.Integer(0), -(r + s)), q)
    scene.T += J * q.diff(TIME) ** 2 / 2 + m * (place[0].diff(TIME) ** 2 + place[1].diff(TIME) ** 2) / 2
    scene.V += k * s ** 2 / 2 + m * g * place[1]
    if rng.random() < 0.5:
        c = scene.parameter("c", word(rng), "N*s/m")
        scene.rows.append("damper d: arm@(0, 0) -- bead { c = c }")
        scene.D += c * s.diff(TIME) ** 2 / 2
    if rng.random() < 0.5:
        scene.rows.append("torque Q3: arm")
        scene.Q[q] = sympy.Symbol("Q3", real=True)


def leaning(rng, scene):
    """A rod or two that lean, held by springs on their angles: they rest away from the drawing, where a number tells."""
    g = scene.parameter("g", "9.81", "m/s^2")
    scene.rows.append("gravity g")
    at, start, carrier, before = (sympy.Integer(0), sympy.Integer(0)), (sympy.Integer(0), sympy.Integer(0)), "ground", sympy.Integer(0)
    place = "(0, 0)"
    for i in range(1, rng.randint(1, 2) + 1):
        m, L = scene.parameter(f"m{i}", word(rng), "kg"), scene.parameter(f"L{i}", word(rng, 4, 12), "m")
        across, up = rng.choice(((3, 4), (4, 3), (5, 12), (12, 5)))
        size = {3: 5, 4: 5, 5: 13, 12: 13}[across]
        end = plus(start, (L * across / size, L * up / size))
        scene.rows.append(f"point P{i} = " + ("" if i == 1 else f"P{i - 1} + ") + f"(L{i} * {across} / {size}, L{i} * {up} / {size})")
        scene.rows.append(f"body r{i} {{ mass = m{i}, shape = rod({place}, P{i}) }}")
        scene.rows.append(f"pivot j{i}: {carrier}@{place} -- r{i}")
        q = scene.coordinate(f"r{i}", "angle")
        centre, at = rod(scene, m, (start, end), q, at)
        scene.V += m * g * centre[1]
        k = scene.parameter(f"kt{i}", str(rng.randint(400, 900)), "N*m/rad")
        scene.rows.append(f"spring t{i}: {carrier} -- r{i} {{ k = kt{i} }}")
        scene.V += k * (q - before) ** 2 / 2
        start, carrier, before, place = end, f"r{i}", q, f"P{i}"


def braced(rng, scene):
    """A rod and a trolley in springs and a damper along lines that turn: lengths at rest, lever arms and tensions have names there."""
    g = scene.parameter("g", "9.81", "m/s^2")
    scene.rows.append("gravity g")
    m, M = scene.parameter("m", word(rng), "kg"), scene.parameter("M1", word(rng), "kg")
    end = (sympy.Rational(rng.randint(8, 14), 8), sympy.Rational(rng.randint(-14, 3), 8))
    scene.rows += [f"point P = ({float(end[0])} m, {float(end[1])} m)", "body rod { mass = m, shape = rod((0, 0), P) }", "pivot p: ground@(0, 0) -- rod"]
    q = scene.coordinate("rod", "angle")
    zero = (sympy.Integer(0), sympy.Integer(0))
    centre, tip = rod(scene, m, (zero, end), q, zero)
    scene.V += m * g * centre[1]
    a, h = scene.parameter("a", word(rng, 4, 12), "m"), scene.parameter("h", word(rng, 12, 24), "m")
    scene.rows.append("body trolley { mass = M1, moves x, at = (a, h) }")
    x = scene.coordinate("trolley", "x")
    scene.T += M * x.diff(TIME) ** 2 / 2

    def away(ends):
        return sympy.sqrt(sum((b - a) ** 2 for a, b in zip(*ends)))

    far = (sympy.Rational(rng.randint(16, 24), 8), sympy.Rational(rng.randint(-8, 8), 8))
    b = scene.parameter("b1", word(rng, 20, 30), "m")
    lines = [("s", f"ground@({float(far[0])} m, {float(far[1])} m) -- rod@P", (far, end), (far, tip), rng.randint(200, 500)),
             ("t", "ground@(b1, 0) -- trolley", ((b, zero[0]), (a, h)), ((b, zero[0]), (a + x, h)), rng.randint(100, 300))]
    if rng.random() < 0.6:
        lines.append(("u", "rod@P -- trolley", (end, (a, h)), (tip, (a + x, h)), rng.randint(20, 80)))
    for name, ends, drawn, moved, stiff in lines:
        k = scene.parameter(f"k{name}", str(stiff), "N/m")
        scene.rows.append(f"spring {name}: {ends} {{ k = k{name} }}")
        scene.V += k * (away(moved) - away(drawn)) ** 2 / 2
    if rng.random() < 0.6:
        c = scene.parameter("c", word(rng), "N*s/m")
        scene.rows.append("damper d: rod@P -- trolley { c = c }")
        scene.D += c * away((tip, (a + x, h))).diff(TIME) ** 2 / 2
    if rng.random() < 0.5:
        scene.rows.append("force F: trolley along x")
        scene.Q[x] = sympy.Symbol("F", real=True)


def rolling(rng, scene):
    """Wheels that roll, and masses that follow them by a ratio; a weight hangs on one of them."""
    r, m = scene.parameter("r", word(rng), "m"), scene.parameter("m", word(rng), "kg")
    scene.rows += ["body wheel { mass = m, shape = disk(r), moves x, turns, at = (0, r) }", "couple roll: wheel.angle = -wheel.x / r"]
    x, q = scene.coordinate("wheel", "x"), scene.coordinate("wheel", "angle")
    scene.T += m * x.diff(TIME) ** 2 / 2 + m * r ** 2 * q.diff(TIME) ** 2 / 4
    scene.constraints.append(q + x / r)
    k = scene.parameter("k", word(rng, 80, 400), "N/m")
    scene.rows.append("spring s: ground@(-1 m, r) -- wheel { k = k, along = x }")
    scene.V += k * x ** 2 / 2
    if rng.random() < 0.6:
        n, M2 = scene.parameter("n", word(rng), ""), scene.parameter("m2", word(rng), "kg")
        scene.rows += ["body load { mass = m2, moves y, at = (3 m, 0) }", "couple rope: load.y = n * wheel.x"]
        y = scene.coordinate("load", "y")
        scene.T += M2 * y.diff(TIME) ** 2 / 2
        scene.constraints.append(y - n * x)
        if rng.random() < 0.6:
            g = scene.parameter("g", "9.81", "m/s^2")
            scene.rows.append("gravity g")
            scene.V += M2 * g * y
    if rng.random() < 0.5:
        c = scene.parameter("c", word(rng), "N*m*s/rad")
        scene.rows.append("damper d: ground -- wheel { c = c }")
        # Two ends without places act on the angle.
        scene.D += c * q.diff(TIME) ** 2 / 2
    if rng.random() < 0.5:
        scene.rows.append("force F: wheel along x")
        scene.Q[x] = sympy.Symbol("F", real=True)


def belt_spans(first, second, radii, angles, moving, sense):
    """How much longer both spans are than drawn, by the normals at which they touch the disks; `sense` is -1 for a crossed belt."""
    r, R = radii[0], sense * radii[1]

    def lengths(centres, turned):
        (x, y), gap = minus(centres[1], centres[0]), r - R
        d = sympy.sqrt(x ** 2 + y ** 2)
        # From its drawing the line of centres turns by less than a quarter.
        normals = [(sympy.atan(y / x) + side * sympy.acos(gap / d), side) for side in (1, -1)]
        return [sympy.sqrt(x ** 2 + y ** 2 - gap ** 2) + side * (r * (turned[0] - normal) - R * (turned[1] - normal)) for normal, side in normals]

    still = {q: 0 for q in moving}
    drawn = lengths([tuple(sympy.sympify(part).xreplace(still) for part in centre) for centre in (first, second)], (0, 0))
    return [now - before for now, before in zip(lengths((first, second), angles), drawn)]


def belts(rng, scene):
    """Two disks that move and turn in springs, with an open or crossed belt; centres stay on one line, or turn about each other."""
    sense = rng.choice((1, -1))
    m, M = scene.parameter("m", word(rng), "kg"), scene.parameter("M1", word(rng), "kg")
    r, R = (scene.parameter(name, word(rng, 1, 7), "m") if rng.random() < 0.7 else None for name in ("r1", "r2"))
    radii = [sympy.Rational(rng.randint(2, 9), 10) if own is None else own for own in (r, R)]
    written = [f"{float(radius)} m" if own is None else f"{own.name}" for own, radius in zip((r, R), radii)]
    far = (sympy.Rational(rng.choice((-1, 1)) * rng.randint(32, 48), 8), sympy.Rational(rng.choice((0, 0, -12, 10)), 8))
    first, second = ["x"], rng.choice((["x"], ["x", "y"], []))
    moves = [", moves " + " ".join(ways) if ways else "" for ways in (first, second)]
    scene.rows.append(f"body a {{ mass = m, shape = disk({written[0]}), at = (0, 0){moves[0]}, turns }}")
    scene.rows.append(f"body b {{ mass = M1, shape = ring({written[1]}), at = ({float(far[0])} m, {float(far[1])} m){moves[1]}, turns }}")
    shifts, moving = [], []
    for body, own, mass in (("a", first, m), ("b", second, M)):
        by = {way: scene.coordinate(body, way) for way in own}
        scene.T += sum(mass * q.diff(TIME) ** 2 / 2 for q in by.values())
        shifts.append((by.get("x", 0), by.get("y", 0)))
        moving += by.values()
        for way, q in by.items():
            stiff = scene.parameter(f"k{body}{way}", word(rng, 800, 4000), "N/m")
            scene.rows.append(f"spring s{body}{way}: ground -- {body} {{ k = k{body}{way}, along = {way} }}")
            scene.V += stiff * q ** 2 / 2
        q = scene.coordinate(body, "angle")
        scene.T += mass * radii[body == "b"] ** 2 * q.diff(TIME) ** 2 / (4 if body == "a" else 2)
        stiff = scene.parameter(f"kt{body}", word(rng, 800, 4000), "N*m/rad")
        scene.rows.append(f"spring t{body}: ground -- {body} {{ k = kt{body} }}")
        scene.V += stiff * q ** 2 / 2
        shifts[-1] += (q,)
    k, T = scene.parameter("k", word(rng, 800, 4000), "N/m"), scene.parameter("T", word(rng), "N")
    scene.rows.append(f"belt r: a -- b {{ k = k, preload = T{', crossed' if sense < 0 else ''} }}")
    places = [(shifts[0][0], shifts[0][1]), plus(far, shifts[1][:2])]
    for stretch in belt_spans(*places, radii, (shifts[0][2], shifts[1][2]), moving, sense):
        scene.V += k * stretch ** 2 / 2 + T * stretch
    if rng.random() < 0.5:
        scene.rows.append("torque M: a")
        scene.Q[shifts[0][2]] = sympy.Symbol("M", real=True)


KINDS = ((links, 0.25), (net, 0.16), (four_bar, 0.14), (bead, 0.08), (leaning, 0.1), (rolling, 0.1), (braced, 0.09), (belts, 0.08))


def scene(rng):
    """A scene of one of the kinds above."""
    made = Scene()
    kind = rng.choices([kind for kind, _ in KINDS], [share for _, share in KINDS])[0]
    kind(rng, made)
    return made


def section(told, number):
    """The items of a section by the number of its heading."""
    return next((s["items"] for s in told["sections"] if s["heading"].startswith(f"{number} ")), [])


def formulas(items):
    return [item for item in items if item["kind"] == "formula"]


def check(scene, program, tally, rng):
    """Everything that is printed for a scene."""
    told = program.ask(tally, "equations", scene.text(), "--format", "json")
    if told is None:
        return
    Comparison(scene, told, tally, rng).run()


class Comparison:
    """One scene beside what is printed of it."""

    def __init__(self, scene, told, tally, rng):
        self.scene, self.told, self.tally, self.rng = scene, told, tally, rng
        self.names, self.moving = {}, {}
        printed = {(row["body"], row["motion"]): row["name"] for row in told["coordinates"]}
        self.labels = [printed[key] for key in scene.coordinates]
        for q, label in zip(scene.symbols, self.labels):
            for order, primes in enumerate(("", "'", "''")):
                self.moving[q.diff(TIME, order) if order else q] = self.symbol(label + primes)
        for u, label in scene.moved_by():
            for order, primes in enumerate(("", "'", "''")):
                self.moving[u.diff(TIME, order) if order else u] = self.symbol(label + primes)

    def symbol(self, name):
        return self.names.setdefault(name, sympy.Symbol(name, real=True))

    def read(self, text):
        return read(text, self.names)

    def run(self):
        self.rests()
        self.lengths = self.definitions()
        self.multipliers = [self.symbol(f"lambda_{i + 1}") for i in range(len(self.scene.constraints))]
        self.speeds()
        self.motions()
        self.values()

    def speeds(self):
        """Angular frequencies by their definitions."""
        told = dict(item["text"].split(" = ", 1) for item in formulas(section(self.told, 1)) if " = " in item["text"])
        for name, mine in self.scene.speeds.items():
            self.agree("angular frequency", mine, self.read(told.get(name, "0")), name)

    # ---- Where the scene rests ----

    def rests(self):
        """q stands for q_0 + q: a name, or the closed form of an angle."""
        self.at_rest = {}
        for item in formulas(section(self.told, 4)):
            if "from the drawing" not in item["note"]:
                continue
            name, form = item["text"].split(" = ")
            place = next(i for i, label in enumerate(self.labels) if name == label_at_rest(label))
            is_closed = item["note"].startswith("=")
            is_angle = self.scene.coordinates[place][1] == "angle"
            self.at_rest[self.scene.symbols[place]] = self.read(form) if is_closed and is_angle else self.symbol(name)

    def moved(self, expression):
        """An expression of the drawing's coordinates in those that are measured from rest, as names."""
        shift = {self.moving[q]: self.moving[q] + value for q, value in self.at_rest.items()}
        return still_times(expression, self.moving).xreplace(shift)

    def definitions(self):
        """Lengths, their rates, the names of belts and velocity ratios; those that stand on others come first. Of ratios at rest the values are checked elsewhere."""
        found = []
        for number in (2, 3, 5):
            for item in formulas(section(self.told, number)):
                of_belts = number == 2 and re.match(r"(d|e|beta|psi)_\S+ = ", item["text"])
                if of_belts or re.match(r"(l|h)_\S+ = ", item["text"]) and (number < 5 or item["text"].startswith("l")):
                    left, right = item["text"].split(" = ")
                    found.append((left.count("'"), self.symbol(left), self.read(right)))
        for item in formulas(section(self.told, 1)):
            # g_belt = r2 - r1
            if re.match(r"g_\S+ = ", item["text"]):
                left, right = item["text"].split(" = ")
                found.append((-1, self.symbol(left), self.read(right)))
        rank = {"h": 3, "e": 2, "b": 1}
        found.sort(key=lambda row: (rank.get(row[1].name[0], 0), row[0]), reverse=True)
        return [(name, value) for _, name, value in found]

    # ---- Equations of motion ----

    def agree(self, kind, mine, theirs, told):
        """Equal at random fractions; what an equation holds at rest is zero there, and may be left out where nothing else is constant."""
        moving = {name: sympy.Integer(0) for name in self.moving.values()}
        forces = {name: sympy.Integer(0) for q in self.scene.Q.values() for name in q.free_symbols if name not in self.scene.parameters.values()}
        at_rest = mine.xreplace({**moving, **forces})
        for _ in range(2):
            values = fractions([mine, theirs, at_rest], self.lengths, self.rng, self.scene.reach)
            own, other, constant = (worth(part, values) for part in (mine, theirs, at_rest))
            self.tally.comparisons += 1
            size = 1 + abs(own)
            if not (abs(own - other) <= SMALL * size or abs(own - other - constant) <= SMALL * size):
                self.tally.violate(kind, told, f"{mine} differs by {own - other}")
                return

    def motions(self):
        items = section(self.told, 3)
        parted = next((i for i, item in enumerate(items) if item["kind"] == "sentence"), len(items))
        rows = formulas(items[:parted])
        held = [item["text"] for item in rows if item["note"].startswith("held by")]
        equations = [text for item in rows if not item["note"].startswith("held by") for text in unfolded(item)]
        equations = [text for text in equations if not re.match(r"l_\S+' = ", text)]
        self.tally.verdict("number of constraints", len(held), len(self.scene.constraints))
        self.tally.verdict("number of equations", len(equations), len(self.scene.symbols))
        for mine, text in zip(self.scene.constraints, held):
            self.agree("constraint", self.moved(mine), self.read(text.split(" = ")[0]), text)
        scene = self.scene
        own = LagrangesMethod(scene.T - scene.V, scene.symbols).form_lagranges_equations()
        self.free = [
            self.moved(mine + scene.D.diff(q.diff(TIME)) - scene.Q.get(q, 0)) for q, mine in zip(scene.symbols, own)
        ]
        self.slopes = [[self.moved(g.diff(q)) for q in scene.symbols] for g in scene.constraints]
        for place, (mine, text) in enumerate(ordered(equations, self.labels, self.free)):
            pull = sum((factor * row[place] for factor, row in zip(self.multipliers, self.slopes)), sympy.Integer(0))
            left, right = text.split(" = ")
            self.agree("equation of motion", mine + pull, self.read(left) - self.read(right), text)
        self.reduced(formulas(items[parted:]))

    def reduced(self, rows):
        """Ratios hold the rates of the constraints, and the equations are those sums of the others that they tell."""
        if not rows:
            return
        ratios, equations, put_in = {}, [], {}
        for item in rows:
            for text in unfolded(item):
                left, right = text.split(" = ")
                label = left.rstrip("'")
                if label in self.labels and left.count("'") < 2:
                    ratios[self.labels.index(label)] = (left.endswith("'"), self.read(right))
                elif not left.startswith("h_"):
                    equations.append(text)
        independent = [i for i in range(len(self.labels)) if i not in ratios]
        self.tally.verdict("number of equations without multipliers", len(equations), len(independent))
        factor = {}
        for place, (is_rate, right) in ratios.items():
            for i in independent:
                factor[place, i] = right.diff(self.symbol(self.labels[i] + ("'" if is_rate else "")))
            if not is_rate:
                for primes in ("", "'", "''"):
                    along = {self.symbol(self.labels[i]): self.symbol(self.labels[i] + primes) for i in independent}
                    put_in[self.symbol(self.labels[place] + primes)] = right.xreplace(along)
        for text, i in zip(equations, independent):
            for row in self.slopes:
                rate = row[i] + sum((factor[place, i] * row[place] for place in ratios), sympy.Integer(0))
                self.agree("velocity ratio", rate, sympy.Integer(0), text)
            mine = self.free[i] + sum((factor[place, i] * self.free[place] for place in ratios), sympy.Integer(0))
            left, right = text.split(" = ")
            mine = mine.xreplace(put_in)
            self.agree("equation without multipliers", mine, self.read(left) - self.read(right), text)

    # ---- Values at rest ----

    def values(self):
        """M, C, K and the columns of forces at a rest that is solved for here."""
        scene, told = self.scene, self.told
        given = {scene.parameters[name]: value for name, value in parameters(scene).items()}
        unknown = [sympy.Symbol(f"rest{i}") for i in range(len(scene.symbols))]
        drawn = dict(zip(scene.symbols, unknown))
        drawn.update({u: sympy.Integer(0) for u, _ in scene.moved_by()})
        drawn.update({sympy.Symbol(word, real=True): sympy.Integer(0) for word in ("u", "u'")})
        V = scene.V.xreplace(drawn).xreplace(given)
        G = [g.xreplace(drawn).xreplace(given) for g in scene.constraints]
        factors = [sympy.Symbol(f"pull{i}") for i in range(len(G))]
        whole = V + sum((f * g for f, g in zip(factors, G)), sympy.Integer(0))
        variables = unknown + factors
        gradient = [whole.diff(v) for v in variables]
        function = sympy.lambdify(variables, gradient, "mpmath")
        rest = {(row["body"], row["motion"]): row["rest"] for row in told["coordinates"]}
        start = [mpmath.mpf(rest[key]) for key in scene.coordinates]
        start += self.pulls(whole, unknown, factors, start)
        point = [mpmath.mpf(x) for x in start]
        jacobian = sympy.lambdify(variables, sympy.Matrix(gradient).jacobian(variables), "mpmath")
        for _ in range(8):
            if max(abs(x) for x in function(*point)) < mpmath.mpf(10) ** -45:
                break
            step = mpmath.lu_solve(mpmath.matrix(jacobian(*point)), -mpmath.matrix(function(*point)))
            point = [x + d for x, d in zip(point, step)]
        for key, value in zip(scene.coordinates, point):
            row = next(row for row in told["coordinates"] if (row["body"], row["motion"]) == key)
            if row["rest_bound"] is not None:
                self.number("rest", row["rest"], row["rest_bound"], value)
        at = dict(zip(unknown, point[:len(unknown)]))
        rates = [sympy.Symbol(f"rate{i}") for i in range(len(unknown))]
        quick = {q.diff(TIME): v for q, v in zip(scene.symbols, rates)}
        still = {v: sympy.Integer(0) for v in rates}
        for u, _ in scene.moved_by():
            quick[u.diff(TIME)] = sympy.Integer(0)

        def second(energy, by):
            own = energy.doit().xreplace(quick).xreplace(drawn).xreplace(given)
            return mpmath.matrix([[worth(own.diff(a).diff(b).xreplace(still), at) for b in by] for a in by])

        matrices = {"mass": second(scene.T, rates), "damping": second(scene.D, rates)}
        matrices["stiffness"] = mpmath.matrix(jacobian(*point))[:len(unknown), :len(unknown)]
        keys = [(row["body"], row["motion"]) for row in told["coordinates"] if row["role"] == "independent"]
        independent = [scene.coordinates.index(key) for key in keys]
        follows = self.following(G, unknown, at, independent)
        known = self.known_values(given, point)
        for name, matrix in matrices.items():
            true = follows.T * matrix * follows
            for i, row in enumerate(told[name]):
                for j, entry in enumerate(row):
                    self.entry(f"entry of {name}", entry, true[i, j], known)
        for column in told["inputs"]:
            if column["name"] in scene.rotors:
                # The force is the opposite of the second derivative of the input.
                where = scene.rotors[column["name"]]
                slope = [-worth(where.diff(q).xreplace(drawn).xreplace(given), at) for q in scene.symbols]
                for entry, true in zip(column["columns"][2], follows.T * mpmath.matrix(slope)):
                    self.entry("column of an unbalance", entry, true, known)
                continue
            own = [scene.Q.get(q, sympy.Integer(0)) for q in scene.symbols]
            force = sympy.Symbol(column["name"], real=True)
            if not any(force in entry.free_symbols for entry in own):
                continue
            slope = [worth(entry.diff(force).xreplace(drawn).xreplace(given), at) for entry in own]
            true = follows.T * mpmath.matrix(slope)
            for i, entry in enumerate(column["columns"][0]):
                self.entry("column of an input", entry, true[i], known)

    def pulls(self, whole, unknown, factors, start):
        """Multipliers at rest to begin with: the least squares of what is left over."""
        if not factors:
            return []
        at = dict(zip(unknown, start))
        none = {f: sympy.Integer(0) for f in factors}
        rows = [[worth(whole.diff(v).diff(f), at) for f in factors] for v in unknown]
        right = [-worth(whole.diff(v).xreplace(none), at) for v in unknown]
        return list(mpmath.lu_solve(mpmath.matrix(rows), mpmath.matrix(right)))

    def following(self, G, unknown, at, independent):
        """N: what each coordinate moves by the independent ones."""
        dependent = [i for i in range(len(unknown)) if i not in independent]
        N = mpmath.zeros(len(unknown), len(independent))
        for column, i in enumerate(independent):
            N[i, column] = 1
        if dependent:
            slope = [[worth(g.diff(v), at) for v in unknown] for g in G]
            own = mpmath.matrix([[row[d] for d in dependent] for row in slope])
            for column, i in enumerate(independent):
                solved = mpmath.lu_solve(own, -mpmath.matrix([row[i] for row in slope]))
                for d, value in zip(dependent, solved):
                    N[d, column] = value
        return N

    def known_values(self, given, point):
        """True values of every name that an entry may have."""
        known = {symbol.name: value for symbol, value in given.items()}
        for q, label, value in zip(self.scene.symbols, self.labels, point):
            known[label_at_rest(label)] = value
        for i, value in enumerate(point[len(self.scene.symbols):]):
            known[f"lambda_{i + 1}"] = value
        free = [item for item in formulas(section(self.told, 2)) if re.match(r"l_\S+,free = ", item["text"])]
        named = [item for number in (1, 4, 5) for item in formulas(section(self.told, number))]
        for item in free + named:
            left, right = item["text"].split(" = ", 1)
            if re.match(r"[A-Za-z]\w*(,\w+)*$", left) and left not in known and not left.endswith("'") and " = " not in right:
                if left in self.labels or left in [row["name"] for row in self.told["coordinates"]]:
                    continue
                known[left] = self.worth(right, known)
        return known

    def worth(self, text, known):
        expression = self.read(text)
        return worth(expression, {symbol: known[symbol.name] for symbol in expression.free_symbols})

    def entry(self, kind, entry, true, known):
        """The text of an entry at the true values, and its number within its bound."""
        self.tally.comparisons += 1
        value = self.worth(entry["text"], known)
        if abs(value - true) > mpmath.mpf(10) ** -30 * (1 + abs(true)):
            self.tally.violate(kind, f"{entry['text']} = {value}", str(true))
        self.number(f"number of {kind}", entry["value"], entry["bound"], true)

    def number(self, kind, told, bound, true):
        self.tally.comparisons += 1
        rounding = mpmath.mpf(10) ** self.scene.digits * (1 + abs(true))
        if not abs(mpmath.mpf(told) - true) <= mpmath.mpf(bound) + rounding:
            self.tally.violate(kind, str(told), str(true), bound)


def label_at_rest(label):
    """`theta_0`, `theta_left,0`."""
    return f"{label},0" if "_" in label else f"{label}_0"


def parameters(scene):
    """Exact values of the parameters, as the rows of the model have them."""
    found = {symbol.name: value for symbol, value in getattr(scene, "given", {}).items()}
    for row in scene.rows:
        match = re.match(r"param (\w+) = (-?[0-9.]+)", row)
        if match:
            found[match.group(1)] = sympy.Rational(match.group(2))
    return found


def unfolded(item):
    """The rows that a running index stands for."""
    match = re.match(r"([ijn]) = (\d+),(?: \.\.\.,)? (\d+)$", item["note"])
    if not match:
        return [item["text"]]
    letter, first, last = match.group(1), int(match.group(2)), int(match.group(3))
    return [at_index(item["text"], letter, number) for number in range(first, last + 1)]


def at_index(text, letter, number):
    text = re.sub(rf"_\({letter}([+-]\d+)\)", lambda m: f"_{number + int(m.group(1))}", text)
    return re.sub(rf"_{letter}\b", f"_{number}", text)


def ordered(texts, labels, own):
    """Equations in the order of the coordinates: folded rows stand before the others."""
    if len(texts) != len(own):
        return
    leading = [re.search(r"\b" + re.escape(label) + r"''", text) for label, text in zip(labels, texts)]
    if not all(leading):
        # A motion without inertia has no acceleration: its equation stays in its place.
        texts = [next((t for t in texts if re.search(r"\b" + re.escape(label) + r"''", t)), own) for label, own in zip(labels, texts)]
    yield from zip(own, texts)


def still_times(expression, moving):
    """Derivatives of time functions as names, the highest first."""
    expression = expression.doit()
    for wanted in (2, 1, 0):
        pairs = {old: new for old, new in moving.items() if order_of(old) == wanted}
        expression = expression.xreplace(pairs)
    return expression


def order_of(symbol):
    return symbol.derivative_count if isinstance(symbol, sympy.Derivative) else 0


def fractions(expressions, definitions, rng, reach=1):
    """A fraction below `reach` for every name, and what those are then that are defined by others."""
    defined = [name for name, _ in definitions]
    free = set().union(*(part.free_symbols for part in (*expressions, *(value for _, value in definitions)))) - set(defined)
    values = {name: mpmath.mpf(rng.randint(1, 60)) * reach / 64 for name in sorted(free, key=str)}
    for name, value in reversed(definitions):
        values[name] = worth(value, values)
    return values


def worth(expression, values):
    """The value of an expression with those of its names, with all digits."""
    names = sorted(expression.free_symbols, key=str)
    numbers = (value.evalf(DIGITS) if isinstance(value, sympy.Basic) else value for value in (values[name] for name in names))
    return mpmath.mpf(sympy.lambdify(names, expression, "mpmath")(*map(mpmath.mpf, numbers)))
