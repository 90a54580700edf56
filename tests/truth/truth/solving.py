"""`solve`: all roots in the range, and no other."""

from flint import arb, ctx, fmpq, fmpq_poly

from . import draw, extrema, signals, transfer
from .exact import determinant, interpolate, real_roots
from .modes import scale
from .net import GROUND, Net
from .tally import decimal

BITS = 400


def scene(rng):
    """A parameter in one or two elements, a measure of it, and a range of one to four decades."""
    net = Net()
    kind = rng.choice(("gain", "gain", "absorber", "absorber", "frequency", "static", "critical"))
    net.question = kind
    count = 1 if kind == "critical" else rng.choice((1, 2, 2, 3))
    if kind == "absorber":
        absorber(rng, net)
    else:
        draw.bodies(rng, net, count, 0)
        draw.springs(rng, net, count, 0)
        draw.dampers(rng, net, count, 0, share=0.7)
        place(rng, net, kind)
    net.forces.append(0)
    if kind == "static":
        net.signals.append(signals.Steps("step", "1", "0"))
    net.outputs.append([("1", "x", 0)])
    net.parameters["p"] = f"10 {net.unit}"
    low = rng.choice(("1", "2", "0.5"))
    net.range = (low, rng.choice(("20", "100", "1000")))
    ask(rng, net)
    return net


def absorber(rng, net):
    """A light absorber tuned by the parameter: narrow resonances in the range."""
    light = rng.randint(-8, -1)
    net.masses = [draw.decimal_word(rng, 0, 1, 1), draw.decimal_word(rng, light, light + 1, 1)]
    own = draw.decimal_word(rng, light, light + 2, 1)
    net.springs = [(GROUND, 0, draw.decimal_word(rng, 1, 2, 1)), (GROUND, 0, "@p"), (0, 1, f"{own}*@p")]
    net.dampers = [(GROUND, 0, draw.decimal_word(rng, -3, 0, 1))]
    if rng.random() < 0.5:
        net.dampers.append((0, 1, draw.decimal_word(rng, light - 4, light - 1, 1)))
    net.unit = "N/m"


def place(rng, net, kind):
    """The parameter in a spring, or for critical damping in the only damper."""
    if kind == "critical":
        net.springs = net.springs[:1]
        net.dampers = [(GROUND, 0, "@p")]
        net.unit = "N*s/m"
        return
    i = rng.randrange(len(net.springs))
    a, b, _ = net.springs[i]
    net.springs[i] = (a, b, "@p")
    net.unit = "N/m"


def ask(rng, net):
    """The line `solve`, with a value that the measure takes somewhere in the range."""
    low, high = (decimal(word) for word in net.range)
    share = fmpq(rng.randint(1, 999), 1000)
    inner = low + (high - low) * share ** 3
    net.at, net.index = draw.decimal_word(rng, 0, 2, 1), rng.randint(1, net.size())
    ctx.prec = BITS
    values = {"p": inner}
    digits = rng.choice((3, 6, 12))
    if net.question in ("gain", "absorber"):
        if net.question == "absorber":
            net.at = transfer.plain(squares_at(net, values)[-1].sqrt().mid().str(3, radius=False))
        top, bottom = moduli(net, inner)
        net.wanted = word((top / bottom), digits, root=True)
        measure = f"gain(F0 -> y0, {net.at} rad/s) = {net.wanted} m/N"
    elif net.question == "frequency":
        net.wanted = transfer.plain(squares_at(net, values)[net.index - 1].sqrt().mid().str(digits, radius=False))
        measure = f"frequency({net.index}) = {net.wanted} rad/s"
    elif net.question == "static":
        net.wanted = word(static(net, inner), digits)
        measure = f"static(y0) = {net.wanted} m"
    else:
        net.wanted = rng.choice(("1", "0.5", "0.05", "0.999999", "1"))
        measure = f"damping(1) = {net.wanted}"
    net.lines = [f"solve p in {net.range[0]} {net.unit} .. {net.range[1]} {net.unit}: {measure}"]


def word(x, digits, root=False):
    x = arb(x)
    return transfer.plain((x.sqrt() if root else x).mid().str(digits, radius=False))


def with_parameter(net, p):
    """The net with the parameter at a fraction, for the functions that read decimal words."""
    return Fixed(net, {"p": p})


class Fixed:
    """A net whose parameters have values of their own."""

    def __init__(self, net, values):
        self.net, self.values = net, values

    def matrices(self):
        return self.net.matrices(self.values)

    def size(self):
        return self.net.size()

    def column(self, name):
        return self.net.column(name)

    def row(self, i, name=None):
        return self.net.row(i, name)


def squares_at(net, values):
    m, _, k = net.matrices(values)
    return [x for x, count in real_roots(determinant([k, -m], scale(m, k)), BITS) for _ in range(count)]


def moduli(net, p):
    """|N|^2 and |D|^2 of the gain at the frequency asked for."""
    numerator, denominator = transfer.function(with_parameter(net, p), 0, "F0")
    square = decimal(net.at) ** 2
    return extrema.modulus(numerator)(square), extrema.modulus(denominator)(square)


def static(net, p):
    numerator, denominator = transfer.function(with_parameter(net, p), 0, "F0")
    return numerator(fmpq(0)) / denominator(fmpq(0))


def true_roots(net):
    """All values of the parameter in the range that make the measure what it should be."""
    low, high = (decimal(w) for w in net.range)
    wanted = decimal(net.wanted)
    count = sum("@" in v for _, _, v in net.springs + net.dampers)
    if net.question in ("gain", "absorber"):
        def f(p):
            top, bottom = moduli(net, fmpq(p))
            return top - wanted ** 2 * bottom
        poly = interpolate(f, 2 * count)
    elif net.question == "static":
        def f(p):
            numerator, denominator = transfer.function(with_parameter(net, fmpq(p)), 0, "F0")
            return numerator(fmpq(0)) - wanted * denominator(fmpq(0))
        poly = interpolate(f, count)
    elif net.question == "frequency":
        def f(p):
            m, _, k = net.matrices({"p": fmpq(p)})
            return (k - m * wanted ** 2).det()
        poly = interpolate(f, count)
    else:
        m, _, k = net.matrices({"p": fmpq(1)})
        poly = fmpq_poly([-4 * m[0, 0] * k[0, 0] * wanted ** 2, 0, 1])
    if poly.is_zero():
        return None
    found = [x for x, _ in real_roots(poly, BITS) if within(x, poly, low, high)]
    if net.question == "frequency":
        found = [x for x in found if index_fits(net, x, wanted)]
    return found


def within(x, poly, low, high):
    """Whether a root lies in the range; its ends belong to it."""
    at_end = any(poly(end) == 0 and (x - end).contains(0) for end in (low, high))
    return at_end or bool(x > low and x < high)


def index_fits(net, x, wanted):
    """Whether the frequency at this root is the one that is asked for, by its number."""
    near = fraction(x)
    values = squares_at(net, {"p": near})
    distances = [float((abs(v / wanted ** 2 - 1)).mid()) for v in values]
    return distances.index(min(distances)) == net.index - 1


def fraction(x):
    """A fraction within 2^-200 of a ball's middle."""
    man, exp = x.mid().man_exp()
    return fmpq(man) * fmpq(2) ** int(exp) if exp >= 0 else fmpq(man) / fmpq(2) ** int(-exp)


def check(net, program, tally, rng):
    """Compares what solve finds with all roots."""
    ctx.prec = BITS
    true = true_roots(net)
    if true is None:
        return
    tally.command = "vibc analyze MODEL --format json"
    answer = program.run("analyze", net.text(), "--format", "json")
    told = answer.json()
    codes = answer.codes()
    many = "one" if len(true) == 1 else "none" if not true else "several"
    if told is not None and told.get("solved"):
        row = told["solved"][0]
        if len(true) != 1:
            tally.comparisons += 1
            words = ", ".join(x.str(20, radius=False) for x in true)
            tally.violate("number of roots, one told", f"one: {row['value']}", f"{len(true)}: {words}")
            return
        tally.verdict("number of roots, one told", "one", many)
        tally.relative("root", row["value"], row["error_bound"], true[0])
        return
    if "vib::solve::no_root" in codes:
        tally.verdict("number of roots, none told", "none", many)
    elif "vib::solve::several_roots" in codes:
        tally.verdict("number of roots, several told", "several", many)
    else:
        tally.refuse(answer.reason())
