"""Values of transfer functions: the complex number, its gain and its phase."""

from flint import acb, arb, ctx, fmpq

from . import draw
from .exact import I, argument, interpolate, pi, roots, value
from .net import GROUND
from .tally import decimal, number

BITS = 400
# Numbers below are outside the range that the program reads.
LEAST_FREQUENCY = fmpq(1, 10 ** 305)


def scene(rng, most=4, decades=None, base=True):
    """A damped net with an input and outputs of several kinds."""
    net = draw.plain(rng, most, decades, damped=rng.random() < 0.9)
    count = net.size()
    if base and rng.random() < 0.35:
        net.bases.append("")
        places = [i for i, (a, _, _) in enumerate(net.springs) if a == GROUND] or [0]
        for i in places:
            a, b, k = net.springs[i]
            net.springs[i] = (("base", 0), b, k) if a == GROUND else (a, b, k)
        net.dampers = [(("base", 0), b, c) if a == GROUND and rng.random() < 0.7 else (a, b, c) for a, b, c in net.dampers]
    else:
        net.forces.append(rng.randrange(count))
    outputs(rng, net)
    return net


def outputs(rng, net, most=3):
    """Motions, combinations of them, forces and stretches of elements."""
    count = net.size()
    for _ in range(rng.randint(1, most)):
        kind = rng.choice(("x", "x", "vx", "ax", "sum", "force", "damper"))
        if kind == "sum" and count > 1:
            a, b = rng.sample(range(count), 2)
            net.outputs.append([("1", "x", a), (rng.choice(("1", "-1", "-2", "0.5")), "x", b)])
        elif kind == "force":
            net.outputs.append([("1", rng.choice(("k.force", "k.stretch")), rng.randrange(len(net.springs)))])
        elif kind == "damper" and net.dampers:
            net.outputs.append([("1", "c.force", rng.randrange(len(net.dampers)))])
        else:
            net.outputs.append([("1", kind if kind in ("x", "vx", "ax") else "x", rng.randrange(count))])


def function(net, output, name):
    """N(s) and D(s) of an output from an input: H = N / D."""
    row, direct = net.row(output, name)
    return quotient(net, row, net.column(name), direct)


def quotient(net, row, column, direct=(fmpq(0),) * 3):
    """N and D with row adj(Q) column + direct det Q = N and det Q = D, Q = M s^2 + C s + K."""
    m, c, k = net.matrices()
    size = net.size()

    def at(x):
        x = fmpq(x)
        q = k + c * x + m * (x * x)
        plain = q.det()
        b = [part[0] + part[1] * x + part[2] * x * x for part in column]
        p = [part[0] + part[1] * x + part[2] * x * x for part in row]
        bordered = q.__class__(size, size, [q[i, j] + b[i] * p[j] for i in range(size) for j in range(size)])
        return bordered.det() - plain + (direct[0] + direct[1] * x + direct[2] * x * x) * plain

    numerator = interpolate(at, 2 * size + 4)
    denominator = interpolate(lambda x: (k + c * fmpq(x) + m * fmpq(x * x)).det(), 2 * size)
    return numerator, denominator


def frequencies(rng, denominator):
    """Frequencies as decimal words: near poles, on a decade, far out."""
    words = []
    places = [abs(root) / (2 * pi()) for root, _ in roots(denominator, 100) if root != 0]
    for _ in range(rng.randint(2, 5)):
        kind = rng.choice(("near", "near", "at", "decade", "far"))
        if kind in ("near", "at") and places:
            word = rng.choice(places).mid().str(rng.choice((3, 6, 12, 17)) if kind == "near" else 17, radius=False)
            words.append(plain(word))
        elif kind == "far":
            words.append(draw.decimal_word(rng, -40, 40))
        else:
            words.append(draw.decimal_word(rng, -2, 2))
    return [word for word in dict.fromkeys(words) if decimal(word) > LEAST_FREQUENCY]


def plain(word):
    """A decimal word as the command line takes it: digits on both sides of the point, or none."""
    word = word.strip("[]").split(" ")[0]
    return word.replace("e+", "e")


def check(net, program, tally, rng):
    """Compares the values at some frequencies."""
    ctx.prec = BITS
    parts = {}
    for name in net.inputs():
        for i in range(len(net.outputs)):
            parts[name, f"y{i}"] = function(net, i, name)
    if not parts:
        return
    words = frequencies(rng, next(iter(parts.values()))[1])
    if not words:
        return
    asked = [option for word in words for option in ("--at", word + "Hz")]
    told = program.ask(tally, "transfer", net.text(), "--format", "json", *asked)
    if told is None:
        return
    exact = {}
    for word in words:
        exact[float(word)] = decimal(word)
    for name, output, row in rows(told):
        f = exact.get(row["frequency_hz"], None)
        if f is None:
            continue
        compare(row, *parts[name, output], f, tally)


def rows(told):
    """Input, output and row of each value, of both forms of the JSON."""
    if isinstance(told, list):
        return [(row["input"], row["output"], row) for row in told]
    return [(pair["input"], pair["output"], row) for pair in told["pairs"] for row in pair["values"]]


def compare(row, numerator, denominator, f, tally):
    """A row of the table against H at the exact frequency."""
    s = I * 2 * pi() * f
    bottom = value(denominator, s)
    if bottom.contains(0):
        return
    compare_value(row, acb(0) if numerator.is_zero() else value(numerator, s) / bottom, tally)


def compare_value(row, truth, tally):
    """A row of the table against H."""
    if row["re"] is None:
        tally.refuse("no value")
        return
    tally.relative("transfer value", (row["re"], row["im"]), row["error_bound"], truth)
    if row["error_bound"] is None:
        return
    tally.relative("gain", row["gain"], row["gain_error_bound"], abs(truth))
    if truth == 0 or truth.contains(0) or row["phase_deg"] is None:
        return
    tally.absolute("level", row["gain_db"], row["gain_db_error_bound"], 20 * abs(truth).log() / arb(10).log())
    phase(tally, "phase", row["phase_deg"], row.get("phase_error_bound"), row["error_bound"], truth)


def phase(tally, kind, told, bound, relative, truth):
    """An angle in degrees. Without a bound of its own it may turn by what the relative bound allows, and its own rounding."""
    angle = argument(truth)
    if bound is None:
        if relative is None or relative >= 1:
            return
        bound = arb(relative).asin() * 180 / pi() + abs(number(told)) * arb(2) ** -53
    difference = number(told) - angle
    turn = (difference / 360 + arb(0.5)).mid().floor()
    tally.comparisons += 1
    error = abs(difference - 360 * turn)
    if error > arb(bound):
        tally.violate(kind, told, angle.str(25, radius=False), str(bound))
