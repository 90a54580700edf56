"""Root mean squares and upward zero crossings under noise: white (partial fractions in exact arithmetic), in bands, between corner points,
on roads (certified integrals of |H|^2 S), under several independent noises, and under one that drives two inputs at different times."""

from flint import acb, acb_poly, arb, ctx, fmpq, fmpq_mat, fmpq_poly

from . import draw, transfer
from .exact import I, pi, roots
from .net import GROUND
from .tally import decimal

# Precisions that are tried in turn.
BITS = (160, 300, 700)
# What a bound leaves below binary64 is compared too: enclosures have some 28 digits.
DIGITS = 110
RELATIVE = arb(2) ** -(DIGITS + 4)


# A piece is straight in a linear plot.
LINE = "line"


class Noise:
    """A density: pieces (f1, f2, value at f1, slope, LINE or None, value at f2) in Hz, or a white one; and the file that it is in, if any."""

    def __init__(self, words, pieces=None, white=None, derivative=0, table=None):
        self.words, self.pieces, self.white, self.derivative, self.table = words, pieces, white, derivative, table


def scene(rng, forms, form="one"):
    """A damped net under noise of one of the forms; "two" inputs have noises of their own, or the second the "delayed" first one."""
    while True:
        net = transfer.scene(rng, 4, rng.choice((0, 0, 1, 2, 3)))
        # Damping that is declared for the whole of it acts on motion relative to what follows a base.
        if rng.random() < 0.25:
            words = [draw.decimal_word(rng, -3, 1), draw.decimal_word(rng, -4, 0)]
            if rng.random() < 0.5:
                words[rng.randrange(2)] = "0"
            net.damping = ("rayleigh", *words)
        if net.dampers or net.damping:
            break
    unit, kinds = "N^2", 1
    if net.bases:
        unit, kinds = "m^2", 3
    first = net.inputs()[0]
    net.noises = {first: drawn(rng, net, unit, kinds, forms)}
    net.delays = {}
    if form == "two":
        net.forces.append(rng.randrange(net.size()))
        net.noises[net.inputs()[-1]] = drawn(rng, net, "N^2", 1, forms)
    if form == "delayed":
        follow(rng, net, first)
    return written(net)


def written(net):
    """The net with its noises in its text."""
    plain = net.text

    def text():
        rows = []
        for row in plain().splitlines():
            words = row.split()
            name = words[1].rstrip(":") if words[0] in ("base", "force") else None
            if name in net.noises:
                row += f" = noise({net.noises[name].words})"
            elif name in net.delays:
                row += f" = delayed({net.delays[name][0]}, {net.delays[name][1]} s)"
            rows.append(row)
        return "\n".join(rows) + "\n"

    net.text = text
    net.smaller = lambda: iter(())
    return net


def follow(rng, net, first):
    """A second input of the same kind, later; at times by no time at all."""
    if net.bases:
        net.bases.append("")
        _, _, k = net.springs[0]
        net.springs.append((("base", 1), rng.randrange(net.size()), k))
        second = "u1"
    else:
        net.forces.append(rng.randrange(net.size()))
        second = net.inputs()[-1]
    ctx.prec = 100
    slowest = min([float(abs(root).mid()) for root, _ in roots(denominator(net), 60) if root != 0] or [1.0])
    word = "0" if rng.random() < 0.1 else f"{10 ** rng.uniform(-1.5, 1.0) / slowest:.3e}"
    net.delays[second] = (first, word)


def of_form(*forms, form="one"):
    """Scenes of one class."""
    return lambda rng: scene(rng, forms, form)


def drawn(rng, net, unit, kinds, forms):
    """Noise of one of the forms, near the poles of a net mostly."""
    derivative = rng.randrange(kinds)
    kind = rng.choice([form for form in forms if form != "road" or unit == "m^2"] or ["points"])
    unit = {0: unit, 1: "m^2/s^2", 2: "m^2/s^4"}[derivative] if unit == "m^2" else unit
    level = draw.decimal_word(rng, -3, 3)
    if kind == "white":
        return Noise(f"white {level} {unit}/Hz", white=decimal(level), derivative=derivative)
    if kind == "road":
        speed = draw.decimal_word(rng, 0, 2, 2)
        v = decimal(speed)
        low, high = fmpq(11, 1000) * v, fmpq(283, 100) * v
        size = decimal(level) * (fmpq(1, 10) / fmpq(11, 1000)) ** 2 / v
        return Noise(f"road({level} m^3, {speed} m/s)", [(low, high, size, fmpq(-2), None)], derivative=0)
    words = frequencies(rng, net, 2 if kind == "flat" else rng.choice((2, 3, 4)))
    if kind == "table":
        return tabulated(rng, words, unit, derivative)
    if kind == "flat":
        if rng.random() < 0.25:
            words[0] = "0"
        low, high = decimal(words[0]), decimal(words[1])
        return Noise(f"{level} {unit}/Hz, {words[0]} Hz .. {words[1]} Hz", [(low, high, decimal(level), fmpq(0), None)],
                     derivative=derivative)
    levels = [draw.decimal_word(rng, -3, 3) for _ in words]
    points = ", ".join(f"({f} Hz, {s} {unit}/Hz)" for f, s in zip(words, levels))
    ends = list(zip(map(decimal, words), map(decimal, levels)))
    return Noise(points, [(a, b, s, None, t) for (a, s), (b, t) in zip(ends, ends[1:])], derivative=derivative)


def tabulated(rng, words, unit, derivative):
    """Rows of a file, straight between them; one or another is zero, or as large as the one before it."""
    if rng.random() < 0.25:
        words[0] = "0"
    levels = []
    for _ in words:
        word = draw.decimal_word(rng, -1, 1)
        levels.append(rng.choice([word] * 6 + ["0"] + levels[-1:]))
    name = f"n{rng.randrange(10 ** 6)}.csv"
    rows = [(decimal(f), decimal(s)) for f, s in zip(words, levels)]
    pieces = [(a, b, s, LINE, t) for (a, s), (b, t) in zip(rows, rows[1:])]
    content = "".join(f"{f},{s}\n" for f, s in zip(words, levels))
    return Noise(f'table("{name}", 1 {unit}/Hz)', pieces, derivative=derivative, table=(name, content))


def tables(net):
    """The files of all noises, by name."""
    return dict(own.table for own in net.noises.values() if own.table)


def frequencies(rng, net, count):
    """Ascending decimal words about the poles, or anywhere."""
    ctx.prec = 100
    m, c, k = net.matrices()
    sizes = [float(abs(root).mid()) / 6.283 for root, _ in roots(denominator(net), 60) if root != 0] or [1.0]
    found = set()
    while len(found) < count:
        place = rng.choice(sizes) * 10 ** rng.uniform(-1.5, 1.5)
        word = f"{place:.{rng.choice((1, 2, 5))}e}"
        found.add(word)
    return sorted(found, key=float)


def denominator(net):
    """det Q"""
    row = [[fmpq(0)] * 3 for _ in range(net.size())]
    return transfer.quotient(net, row, row)[1]


def reduced(top, bottom):
    common = top.gcd(bottom)
    return (top // common, bottom // common) if common.degree() > 0 else (top, bottom)


def white(top, bottom):
    """The integral of |H|^2 over all frequencies from 0, Hz; None if it is infinite."""
    if top.is_zero():
        return arb(0)
    top, bottom = reduced(top, bottom)
    n = bottom.degree()
    if top.degree() >= n:
        return None
    if any(not root.real < 0 for root, _ in roots(bottom, 200)):
        return None
    # N(s) N(-s) = X(s) D(-s) + X(-s) D(s); half the integral is x_{n-1} / d_n.
    mirrored = lambda p: fmpq_poly([x * (-1) ** i for i, x in enumerate(p.coeffs())])
    product = top * mirrored(top)
    rows = fmpq_mat(n, n)
    right = fmpq_mat(n, 1)
    d = bottom.coeffs()
    for m in range(n):
        # The coefficient of s^(2 m): X(s) D(-s) has x_j d_l (-1)^l, twice.
        for j in range(n):
            l = 2 * m - j
            if 0 <= l <= n:
                rows[m, j] += 2 * d[l] * (-1) ** l
        right[m, 0] = product[2 * m] if 2 * m <= product.degree() else fmpq(0)
    x = rows.solve(right)
    return arb(x[n - 1, 0] / d[n]) / 2


def together(parts, delays):
    """The covariance of the first two of an output under white noise of unit one-sided density, the second one later: the residues of
    H1(s) H2(-s) e^(s t) at the poles of H1, half of the sum; None where a pole is multiple."""
    (top, bottom), (other, below) = [reduced(*part) for part in parts]
    mirrored = lambda p: acb_poly(fmpq_poly([x * (-1) ** i for i, x in enumerate(p.coeffs())]))
    later = arb(delays[1]) - arb(delays[0])
    total = acb(0)
    for root, count in roots(bottom):
        if count > 1:
            return None
        total += acb_poly(top)(root) / acb_poly(bottom.derivative())(root) * mirrored(other)(root) / mirrored(below)(root) * (root * later).exp()
    return total.real / 2


def banded(parts, delays, noise, more):
    """The integral of |sum H e^(-i 2 pi f t)|^2 S (2 pi f)^more over the bands, Hz; None if it is infinite."""
    parts = [(reduced(top, bottom), t) for (top, bottom), t in zip(parts, delays) if not top.is_zero()]
    if not parts:
        return arb(0)
    curves = [(acb_poly(top), acb_poly(bottom), arb(t)) for (top, bottom), t in parts]
    total, evaluations = arb(0), 0

    def of(s):
        return sum((above(s) / below(s) * (-s * t).exp() for above, below, t in curves), acb(0))

    for low, high, size, slope, last in noise.pieces:
        if slope == LINE and size == 0 and last == 0:
            continue
        if any(rings(bottom, low, high) for (_, bottom), _ in parts):
            return None
        course = density(low, high, size, slope, last)

        def gain(f):
            nonlocal evaluations
            evaluations += 1
            if evaluations > MOST_EVALUATIONS:
                return acb(float("nan"))
            s = I * 2 * pi() * f
            h = of(s) * of(-s)
            return h * (2 * pi() * f) ** more if more else h

        if low == 0:
            if any(bottom.coeffs()[0] == 0 for (_, bottom), _ in parts):
                return None
            total += acb.integral(lambda f, _: gain(f) * course(f), 0, high, rel_tol=RELATIVE).real
            continue

        def of_log(x, _):
            f = x.exp()
            return gain(f) * course(f) * f

        found = [root for (_, bottom), _ in parts for root, _ in roots(bottom, 60)]
        places = sorted({float(abs(root.imag).mid()) / 6.283185307179586 for root in found})
        cuts = [arb(low)] + [arb(p) for p in places if float(low.p) / float(low.q) < p < float(high.p) / float(high.q)] + [arb(high)]
        for a, b in zip(cuts, cuts[1:]):
            total += acb.integral(of_log, a.log(), b.log(), rel_tol=RELATIVE).real
    return total if evaluations <= MOST_EVALUATIONS else OPEN


def density(low, high, size, slope, last):
    """A piece of a density as a function of the frequency, Hz."""
    if slope == LINE:
        return lambda f: (f - arb(low)) * arb((last - size) / (high - low)) + arb(size)
    if slope == 0:
        return lambda f: arb(size)
    exponent = (arb(last) / arb(size)).log() / (arb(high) / arb(low)).log() if slope is None else arb(slope)
    return lambda f: ((f / arb(low)).log() * exponent).exp() * arb(size)


def rings(bottom, low, high):
    """Whether a pole is on the axis within a band, Hz; no pole is on the right."""
    mirrored = fmpq_poly([x * (-1) ** i for i, x in enumerate(bottom.coeffs())])
    found = [abs(root.imag) / (2 * pi()) for root, _ in roots(bottom.gcd(mirrored)) if root != 0]
    return any(arb(low) < f and f < arb(high) for f in found)


def true_square(net, i, more):
    """The mean square of an output (more = 0), or of its rate (more = 2): None if it is infinite."""
    for bits in BITS:
        ctx.prec = bits
        found = square_at(net, i, more)
        if found is None or found is OPEN or found == 0 or found.rel_accuracy_bits() > DIGITS:
            break
    return found


def square_at(net, i, more):
    total = arb(0)
    for name, noise in net.noises.items():
        followers = [(other, word) for other, (source, word) in net.delays.items() if source == name]
        delays = [fmpq(0)] + [decimal(word) for _, word in followers]
        parts = []
        for driven in [name] + [other for other, _ in followers]:
            top, bottom = transfer.function(net, i, driven)
            parts.append((top, bottom * fmpq_poly([0, 1]) ** noise.derivative))
        if len(set(delays)) == 1:
            parts, delays = [(sum((top for top, _ in parts), fmpq_poly([])), parts[0][1])], [fmpq(0)]
        part = banded(parts, delays, noise, more) if noise.white is None else whites(parts, delays, noise, more)
        if part is OPEN or part is None:
            return part
        total += part
    return total


# No truth is computed.
OPEN = object()
# Delays that turn the phase a thousand times in a band: some seconds.
MOST_EVALUATIONS = 100_000



def whites(parts, delays, noise, more):
    """The mean square under white noise; of two bases that drift one after the other nothing is computed."""
    s = fmpq_poly([0, 1])
    parts = [(top * s ** (more // 2), bottom) for top, bottom in parts]
    own = [white(top, bottom) for top, bottom in parts]
    if any(square is None for square in own):
        return OPEN if len(own) > 1 else None
    sum_of = sum(own, arb(0))
    if len(own) > 1 and not any(top.is_zero() for top, _ in parts):
        mixed = together(parts, delays)
        if mixed is None:
            return OPEN
        sum_of += 2 * mixed
    return sum_of * arb(noise.white)


def check(net, program, tally, rng):
    """Compares every rms and every rate of crossings."""
    told = program.ask(tally, "analyze", net.text(), "--format", "json", tables=tables(net))
    if told is None:
        return
    found = {row["output"]: row for row in told.get("noise") or []}
    for i in range(len(net.outputs)):
        row = found.get(f"y{i}")
        if row is None:
            continue
        square = true_square(net, i, 0)
        if square is OPEN:
            continue
        compare(tally, "rms", row["rms"], row["rms_error_bound"], row["rms_reason"], None if square is None else square.sqrt())
        if square is None or row["crossings_reason"] is not None and "rate" in row["crossings_reason"]:
            continue
        rate = true_square(net, i, 2)
        if rate is OPEN or rate is not None and not square > 0:
            continue
        truth = None if rate is None else (rate / square).sqrt() / (2 * pi())
        compare(tally, "crossings", row["crossings_hz"], row["crossings_error_bound"], row["crossings_reason"], truth)


def compare(tally, kind, told, bound, reason, truth):
    """A number, or that it is infinite, or that nothing is proved."""
    if told is None:
        is_infinite = reason.startswith("infinite")
        if is_infinite:
            tally.verdict(f"{kind} is infinite", True, truth is None)
        else:
            tally.refuse(reason)
        return
    if truth is None:
        tally.violate(kind, told, "infinite", bound)
        return
    tally.relative(kind, told, bound, truth)
