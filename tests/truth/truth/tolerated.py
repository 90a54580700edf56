"""Ranges within tolerances: nets whose masses and stiffnesses are functions of a few parameters. The eigenvalues at all corners of the box
and at places inside, from characteristic polynomials in exact arithmetic, lie in the ranges that are told; where these are proved, their
ends are those at corners. A requirement that holds everywhere fails at no place, and one that fails does so where it is said."""

from flint import acb, acb_mat, arb, ctx, fmpq, fmpq_mat

from . import draw
from .exact import pi, roots
from .loaded import Text
from .tally import decimal

BITS = 200
INSIDE = 150

# A weight of parameters p and q, as text and as a function; the last two have no direction in some boxes.
FORMS = (
    ("{p}", lambda p, q: p),
    ("2 * {p}", lambda p, q: 2 * p),
    ("{p} + {q}", lambda p, q: p + q),
    ("{p}^2 / {q}", lambda p, q: p * p / q),
    ("sqrt({p} * {p})", lambda p, q: p),
    ("3 * {p} - {q}", lambda p, q: 3 * p - q),
    ("{p} * {q} / ({p} + {q})", lambda p, q: p * q / (p + q)),
)


class Box:
    """Parameters with their ranges, and the weights of masses and springs."""

    def __init__(self, rng):
        self.names, self.ends, self.rows = [], [], ["model truth"]
        for kind, unit in (("m", "kg"), ("k", "N/m")):
            for i in range(rng.choice((1, 2, 2))):
                self.parameter(rng, f"{kind}{i}", unit)
        n = rng.choice((1, 2, 3, 4))
        self.masses = [self.weight(rng, "m", "kg") for _ in range(n)]
        links = [(-1, 0)] + [(rng.randrange(i), i) for i in range(1, n)]
        links += [(rng.randrange(-1, n), rng.randrange(n)) for _ in range(rng.choice((0, 1, 2)))]
        self.springs = [(a, b, self.weight(rng, "k", "N/m")) for a, b in links if a != b]
        self.rows += [f"body b{i} {{ mass = {m[0]}, moves x }}" for i, m in enumerate(self.masses)]
        end = lambda a: "ground" if a < 0 else f"b{a}"
        self.rows += [f"spring s{i}: {end(a)} -- {end(b)} {{ k = {k[0]} }}" for i, (a, b, k) in enumerate(self.springs)]
        self.requirements = []

    def parameter(self, rng, name, unit):
        value = draw.decimal_word(rng, -1, 2)
        x = decimal(value)
        if rng.random() < 0.5:
            share = rng.choice(("1", "5", "20", "0.1"))
            self.rows.append(f"param {name} = {value} {unit} within {share} %")
            self.ends.append((x - x * decimal(share) / 100, x + x * decimal(share) / 100))
        else:
            low, high = f"{float(x) * rng.uniform(0.5, 0.99):.3g}", f"{float(x) * rng.uniform(1.01, 2):.3g}"
            self.rows.append(f"param {name} = {value} {unit} within {low} {unit} .. {high} {unit}")
            self.ends.append((decimal(low), decimal(high)))
        self.names.append(name)

    def weight(self, rng, kind, unit):
        own = [name for name in self.names if name.startswith(kind)]
        p, q = rng.choice(own), rng.choice(own)
        text, of = rng.choice(FORMS) if rng.random() < 0.6 else FORMS[0]
        if rng.random() < 0.2:
            word = draw.decimal_word(rng, -1, 2)
            return f"{word} {unit}", lambda values: decimal(word)
        return text.format(p=p, q=q), lambda values: of(values[p], values[q])

    def frequencies(self, values):
        """Hz, ascending, of a mode that diverges None; None where a mass is not positive."""
        weights = [m[1](values) for m in self.masses], [k[1](values) for _, _, k in self.springs]
        if any(x <= 0 for x in weights[0]):
            return None
        n = len(weights[0])
        matrix = [[fmpq(0)] * n for _ in range(n)]
        for (a, b, _), k in zip(self.springs, weights[1]):
            for i, j, sign in ((a, a, 1), (b, b, 1), (a, b, -1), (b, a, -1)):
                if i >= 0 and j >= 0:
                    matrix[i][j] += sign * k / weights[0][i]
        found = [root.real for root, count in roots(fmpq_mat(matrix).charpoly()) for _ in range(count)]
        return [x.sqrt() / (2 * pi()) if x > 0 else None for x in sorted(found, key=lambda x: float(x.mid()))]

    def place(self, shares):
        return {name: low + (high - low) * share for name, (low, high), share in zip(self.names, self.ends, shares)}

    def places(self, rng):
        k = len(self.names)
        corners = [[fmpq(bits >> i & 1) for i in range(k)] for bits in range(1 << k)]
        return [self.place(shares) for shares in corners + [[fmpq(rng.randrange(1001), 1000) for _ in range(k)] for _ in range(INSIDE)]]


def scene(rng):
    box = Box(rng)
    ctx.prec = BITS
    middle = box.frequencies(box.place([fmpq(1, 2)] * len(box.names)))
    for _ in range(2 if middle else 0):
        i = rng.randrange(len(middle))
        if middle[i] is None:
            continue
        sign, f = rng.choice("<>"), f"{float(middle[i].mid()) * rng.uniform(0.9, 1.1):.5g}"
        box.rows.append(f"require frequency({i + 1}) {sign} {f} Hz")
        box.requirements.append((i, sign, decimal(f)))
    net = Text("\n".join(box.rows) + "\n")
    net.box = box
    return net


def check(net, program, tally, rng):
    told = program.ask(tally, "analyze", net.text(), "--tolerances", "--format", "json")
    if told is None or "tolerances" not in told:
        return
    ctx.prec = BITS
    box, found = net.box, told["tolerances"]
    seen = [(place, box.frequencies(place)) for place in box.places(rng)]
    corners = [f for _, f in seen[: 1 << len(box.names)]]
    for i, row in enumerate(found["frequencies"]):
        stops = any(f is None or f[i] is None for _, f in seen)
        if row["least_hz"] is None:
            tally.verdict("a mode that does not oscillate", stops, True)
            continue
        if stops:
            tally.verdict("a range over places without oscillations is not proved", row["proved"], False)
            continue
        at_corners = [f[i] for f in corners]
        least, largest = (pick(at_corners, key=lambda x: x.mid()) for pick in (min, max))
        if row["proved"]:
            if found["least_at"] is not None:
                tally.relative("least frequency", row["least_hz"], row["least_error_bound"], least)
                tally.relative("largest frequency", row["largest_hz"], row["largest_error_bound"], largest)
            else:
                w = max(f[i] for _, f in seen) - min(f[i] for _, f in seen)
                wide = arb(row["largest_hz"]) - arb(row["least_hz"]) > w * arb(3) / 2 + largest / 10**6
                tally.verdict("a range from boxes, wide", bool(wide), False) if not wide else tally.refuse("proved, but more than 1.5 times as wide")
            # One part in 1e12 is what binary64 may lose of the ends.
            low, high = arb(row["least_hz"]) * (1 - arb(10) ** -12), arb(row["largest_hz"]) * (1 + arb(10) ** -12)
            tally.verdict("values outside of a range", sum(1 for _, f in seen if not (low <= f[i] <= high)), 0)
        else:
            tally.refuse("not proved")
    for (i, sign, limit), row in zip(box.requirements, found["requirements"]):
        keeps = lambda f: f is not None and f[i] is not None and bool(f[i] < arb(limit) if sign == "<" else f[i] > arb(limit))
        if row["verdict"] == "holds":
            tally.verdict("places where it fails", sum(1 for _, f in seen if not keeps(f)), 0)
        elif row["verdict"] == "fails":
            ends = dict(zip(box.names, box.ends))
            exact = lambda name, x: min((*ends[name], fmpq(*float(x).as_integer_ratio())), key=lambda end: abs(float(end) - x))
            tally.verdict("holds where it is said to fail", keeps(box.frequencies({name: exact(name, x) for name, x in row["at"].items()})), False)
        else:
            tally.refuse("a requirement is not decided")


# Damped nets: damping ratios, poles, a gain, an amplitude and a final value at the same places.

PLACES = 60


class DampedBox(Box):
    """The same with dampers along springs, a force on the first body and the displacement of another one."""

    def __init__(self, rng):
        super().__init__(rng)
        self.parameter(rng, "c0", "N*s/m")
        own = [name for name in self.names if name.startswith("c")]
        self.dampers = []
        for i, (a, b, _) in enumerate(self.springs):
            if i == 0 or rng.random() < 0.6:
                text, of = rng.choice(FORMS[:3])
                p, q = rng.choice(own), rng.choice(own)
                self.dampers.append((a, b, lambda values, of=of, p=p, q=q: of(values[p], values[q])))
                end = lambda a: "ground" if a < 0 else f"b{a}"
                self.rows.append(f"damper d{i}: {end(a)} -- {end(b)} {{ c = {text.format(p=p, q=q)} }}")
        self.out, self.word = rng.randrange(len(self.masses)), draw.decimal_word(rng, -1, 0)
        self.rows += [f"force F: b0 along x = step(1 N, 0 s)", f"force G: b0 along x = harmonic(1 N, {self.word} Hz)", f"output y = b{self.out}.x"]
        limits = ("damping(1) < 1e9", f"gain(F -> y, {self.word} Hz) < 1e99 m/N", "amplitude(y) < 1e99 m", "static(y) < 1e99 m", "frequency(1) * damping(1) < 1e99 Hz")
        self.rows += [f"require {limit}" for limit in limits]

    def exact(self, values):
        """Fractions M, C and K; `None` where a mass is not positive."""
        n = len(self.masses)
        masses = [m[1](values) for m in self.masses]
        if any(x <= 0 for x in masses):
            return None
        forms = []
        for links in (self.dampers, self.springs):
            matrix = [[fmpq(0)] * n for _ in range(n)]
            for a, b, weight in links:
                x = weight[1](values) if isinstance(weight, tuple) else weight(values)
                for i, j, sign in ((a, a, 1), (b, b, 1), (a, b, -1), (b, a, -1)):
                    if i >= 0 and j >= 0:
                        matrix[i][j] += sign * x
            forms.append(matrix)
        return masses, *forms

    def measured(self, values):
        """Lists of poles above the real axis, ascending in |s|, if all are there, and numbers by name."""
        found = self.exact(values)
        if found is None:
            return None
        masses, c, k = found
        n = len(masses)
        rows = [[fmpq(0)] * n + [fmpq(int(i == j)) for j in range(n)] for i in range(n)]
        rows += [[-k[i][j] / masses[i] for j in range(n)] + [-c[i][j] / masses[i] for j in range(n)] for i in range(n)]
        poles = [root for root, count in roots(fmpq_mat(rows).charpoly()) for _ in range(count)]
        upper = sorted((s for s in poles if s.imag > 0), key=lambda s: float(abs(s).mid()))
        numbers = {}
        stable = all(s.real < 0 for s in poles)
        omega = 2 * pi() * arb(decimal(self.word))
        z = acb_mat(n, n, [acb(arb(k[i][j]) - (omega**2 * arb(masses[i]) if i == j else 0), omega * arb(c[i][j])) for i in range(n) for j in range(n)])
        force = acb_mat(n, 1, [acb(int(i == 0)) for i in range(n)])
        numbers["gain"] = abs(z.solve(force)[self.out, 0])
        if stable:
            numbers["amplitude"] = numbers["gain"]
            still = fmpq_mat([[x for x in row] for row in k])
            numbers["static"] = arb(still.solve(fmpq_mat([[fmpq(int(i == 0))] for i in range(n)]))[self.out, 0])
        return upper if len(upper) == n else None, numbers


def damped_scene(rng):
    box = DampedBox(rng)
    net = Text("\n".join(box.rows) + "\n")
    net.box = box
    return net


def damped_check(net, program, tally, rng):
    told = program.ask(tally, "analyze", net.text(), "--tolerances", "--format", "json")
    if told is None or "tolerances" not in told:
        return
    ctx.prec = BITS
    box, found = net.box, told["tolerances"]
    corners = box.places(rng)
    seen = [box.measured(place) for place in corners[: 2 ** len(box.names) + PLACES]]
    inside = lambda row, x: arb(row["least"]) - abs(x) * arb(10) ** -12 <= x <= arb(row["largest"]) + abs(x) * arb(10) ** -12

    def compare(kind, row, values):
        if row is None or row["least"] is None:
            tally.refuse("no value somewhere")
        elif not row["proved"]:
            tally.refuse("not proved")
        else:
            for x in values:
                tally.verdict(f"value in its range: {kind}", inside(row, x), True)

    poles = [entry[0] for entry in seen if entry is not None and entry[0] is not None]
    # Poles of the same size have no order.
    apart = lambda upper: all(abs(b) > abs(a) for a, b in zip(upper, upper[1:]))
    poles = [upper for upper in poles if apart(upper)]
    for i, row in enumerate(found["poles"]):
        compare("re", row["re"], [upper[i].real for upper in poles if i < len(upper)])
        compare("im", row["im"], [upper[i].imag for upper in poles if i < len(upper)])
    for i, row in enumerate(found["damping_ratios"]):
        compare("damping ratio", row, [-upper[i].real / abs(upper[i]) for upper in poles if i < len(upper)])
    for name, place in (("gain", 1), ("amplitude", 2), ("static", 3)):
        values = [entry[1][name] for entry in seen if entry is not None and name in entry[1]]
        compare(name, found["requirements"][place]["values"], values)
