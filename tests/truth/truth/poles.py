"""Damped poles: their number, places, damping ratios, kinds, and the verdict of stability."""

from flint import acb, arb, ctx, fmpq

from . import draw
from .exact import determinant, pi, roots
from .modes import scale, squares
from .net import GROUND, Net
from .tally import decimal

BITS = 400


def scene(rng):
    """Ordinary and graded nets, and those in which poles meet."""
    kind = rng.choice(("plain",) * 4 + ("critical",) * 2 + ("twins", "negative", "massless", "rayleigh", "modal", "floating"))
    if kind == "critical":
        return critical(rng)
    if kind == "twins":
        return twins(rng)
    net = Net()
    count = draw.size(rng, 6)
    decades = draw.width(rng)
    draw.bodies(rng, net, count, decades)
    draw.springs(rng, net, count, decades, grounded=kind != "floating", negative=0.15 if kind == "negative" else 0)
    draw.dampers(rng, net, count, decades, share=rng.choice((0.3, 0.8)), negative=0.2 if kind == "negative" else 0)
    if kind == "massless" and count > 1:
        for i in rng.sample(range(count), rng.randint(1, count - 1)):
            net.masses[i] = "0"
    if kind == "rayleigh":
        net.damping = ("rayleigh", draw.decimal_word(rng, -3, 1), draw.decimal_word(rng, -4, 0))
        if rng.random() < 0.5:
            net.dampers = []
    if kind == "modal":
        net.damping = ("modal", rng.choice(("0.02", "5e-3", "0.3", "0.999999", "1e-9", draw.decimal_word(rng, -3, 0))))
        net.dampers = []
    return net


def nines(rng, value):
    """A number just below or just above this whole one, by 1e-15 to 1e-89, or the number itself."""
    depth = rng.choice((0, 3, 8, 15, 16, 17, 20, 30, 40, 50, 60, 89))
    if depth == 0:
        return str(value)
    if rng.random() < 0.5:
        return f"{value - 1}." + "9" * depth
    return f"{value}." + "0" * (depth - 1) + "1"


def critical(rng):
    """Several bodies near critical damping, alike or not, joined by springs or dampers, some of these negative."""
    net = Net()
    count = rng.choice((1, 2, 2, 2, 3, 4))
    alike = rng.random() < 0.7
    root = rng.choice((1, 2, 3, 5))
    damper = nines(rng, 2 * root)
    for i in range(count):
        if not alike:
            root = rng.choice((1, 2, 3, 5))
            damper = nines(rng, 2 * root)
        net.masses.append("1")
        net.springs.append((GROUND, i, str(root * root)))
        net.dampers.append((GROUND, i, damper))
    for i in range(1, count):
        link = rng.choice(("spring", "damper", "both", "none", "proportional"))
        j = rng.randrange(i)
        if link in ("spring", "both"):
            net.springs.append((j, i, draw.decimal_word(rng, 0, 1, 1)))
        if link in ("damper", "both"):
            sign = "-" if rng.random() < 0.4 else ""
            net.dampers.append((j, i, sign + draw.decimal_word(rng, 0, 1, 1)))
        if link == "proportional":
            k = rng.choice((1, 3, 4, 8))
            net.springs.append((j, i, str(k)))
            net.dampers.append((j, i, nines(rng, rng.choice((1, 2, 4)))))
    return net


def twins(rng):
    """Equal oscillators, joined weakly or not at all: clusters, and poles that are defective or nearly so."""
    net = Net()
    count = rng.choice((2, 2, 3, 4))
    mass, k, c = (draw.decimal_word(rng, -1, 2, 2) for _ in range(3))
    low = rng.choice((-1, -6, -12, -18, -30))
    for i in range(count):
        net.masses.append(mass)
        net.springs.append((GROUND, i, k))
        net.dampers.append((GROUND, i, c))
    for i in range(1, count):
        if rng.random() < 0.8:
            net.springs.append((i - 1, i, draw.decimal_word(rng, low, low + 1, 2)))
        if rng.random() < 0.5:
            net.dampers.append((i - 1, i, draw.decimal_word(rng, low, low + 1, 2)))
    return net


def true_poles(net):
    """All finite poles, each as often as it occurs."""
    if net.damping and net.damping[0] == "modal":
        return modal(net)
    m, c, k = net.matrices()
    square = abs(scale(m, k))
    half = (int(square.p).bit_length() - int(square.q).bit_length()) // 2
    poly = determinant([k, c, m], fmpq(2) ** half if half >= 0 else 1 / fmpq(2) ** -half)
    if poly.is_zero():
        return None
    return [root for root, count in roots(poly, BITS) for _ in range(count)]


def modal(net):
    """The poles where each oscillation has one damping ratio below 1."""
    zeta = arb(decimal(net.damping[1]))
    found = []
    for square in squares(net):
        omega = abs(square).sqrt()
        if square > 0:
            root = (1 - zeta * zeta).sqrt() * omega
            found += [acb(-zeta * omega, root), acb(-zeta * omega, -root)]
        else:
            found += [acb(omega), acb(-omega)] if square < 0 else [acb(0), acb(0)]
    return found


def kind_of(s):
    """The word for a pole."""
    if s.imag == 0:
        if s.real == 0:
            return "rigid"
        return "overdamped" if s.real < 0 else "divergence"
    return "flutter" if s.real > 0 else "oscillation"


def check(net, program, tally, rng):
    """Compares the list of poles and the verdict."""
    ctx.prec = BITS
    told = program.ask(tally, "analyze", net.text(), "--format", "json")
    if told is None:
        return
    true = true_poles(net)
    if true is None:
        return
    compare(told, true, squares(net), tally)


def compare(told, true, modes, tally):
    """A list of poles against the true ones."""
    poles = told["poles"]
    stability(told, true, tally)
    bounded = [p for p in poles if p["error_bound"] is not None and p["error_bound"] < 1]
    if any(p["error_bound"] is None for p in poles):
        tally.refuse("poles without bounds")
        if len(bounded) > len(true):
            tally.violate("number of poles", len(bounded), len(true))
    elif any("all poles" in words for words in told["not_computed"].get("not_proved", [])):
        tally.refuse("poles not counted")
    else:
        tally.verdict("number of poles", len(poles), len(true))
    for pole, other, around in pairs(bounded, true, tally):
        tally.relative("pole", (pole["re"], pole["im"]), pole["error_bound"], other)
        one(pole, other, around, tally)


def one(pole, other, around, tally):
    """What is told of a pole besides its place. `around` are all poles within its bound: any of them may be meant."""
    if other != 0:
        ratio = min((-s.real / abs(s) for s in around), key=lambda z: float(abs(z - pole["damping_ratio"]).mid()))
        size = arb(1) if pole["damping_ratio"] == 0 else None
        tally.relative("damping ratio", pole["damping_ratio"], pole.get("damping_ratio_error_bound"), ratio, size)
        size = min((abs(s) for s in around), key=lambda z: float(abs(z - pole["omega"]).mid()))
        tally.relative("modulus of a pole", pole["omega"], pole["error_bound"], size)
        turns = min((abs(s) / (2 * pi()) for s in around), key=lambda z: float(abs(z - pole["frequency_hz"]).mid()))
        tally.relative("frequency of a pole", pole["frequency_hz"], pole["error_bound"], turns)
        damped = pole["damped_frequency_hz"]
        turns = min((abs(s.imag) / (2 * pi()) for s in around), key=lambda z: float(abs(z - damped).mid()))
        tally.relative("damped frequency of a pole", damped, pole["damped_frequency_error_bound"], turns, size / (2 * pi()))
    if pole["kind"] == "undetermined":
        tally.refuse("kind of pole")
        return
    if all(settled(s) for s in around):
        words = sorted({kind_of(s) for s in around})
        tally.verdict("kind of pole", pole["kind"], pole["kind"] if pole["kind"] in words else " or ".join(words))


def settled(s):
    """Whether the oracle knows the signs of a pole."""
    return (s.real == 0 or not s.real.contains(0)) and (s.imag == 0 or not s.imag.contains(0))


def stability(told, true, tally):
    """The verdict about the rest against the poles."""
    rest = told["rest"]
    signs = [1 if s.real > 0 else 0 if s.real == 0 else -1 if s.real < 0 else None for s in true]
    if rest["kind"] == "undetermined" or None in signs:
        if rest["kind"] == "undetermined":
            tally.refuse("undetermined rest")
        return
    if any(sign > 0 for sign in signs):
        tally.verdict("stability", rest["kind"], "unstable")
    else:
        tally.verdict("stability", rest["kind"], "neutral" if any(s == 0 for s in true) else "stable")


def pairs(poles, true, tally):
    """Told poles with true ones within their bounds, one to one; a pole that has none is a violation."""
    near = []
    for pole in poles:
        place = acb(arb(pole["re"]), arb(pole["im"]))
        bound = arb(pole["error_bound"])
        fits = []
        for j, other in enumerate(true):
            distance = abs(place - other)
            if not distance > bound * abs(other):
                fits.append((float((distance / (abs(other) + abs(place) + arb(2) ** -1000)).mid()), j))
        near.append([j for _, j in sorted(fits)])
    owner = {}

    def place_for(i, seen):
        for j in near[i]:
            if j in seen:
                continue
            seen.add(j)
            if j not in owner or place_for(owner[j], seen):
                owner[j] = i
                return True
        return False

    for i, pole in enumerate(poles):
        if not place_for(i, set()):
            told = f"{pole['re']!r} + {pole['im']!r} i"
            tally.comparisons += 1
            tally.violate("pole that is none", told, "; ".join(s.str(20, radius=False) for s in true), pole["error_bound"])
    return [(poles[i], true[j], [true[n] for n in near[i] if true[n] != 0 or true[j] == 0]) for j, i in sorted(owner.items())]
