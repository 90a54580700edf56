"""Root mean squares, crossings and peaks under noise where springs have loss factors: certified integrals and slopes of |H|^2 S, H as
a quotient of polynomials with complex fractions."""

import copy
import re

from flint import acb, acb_poly, arb, ctx, fmpq, fmpq_poly

from . import noise, noise_maxima
from .exact import I, pi, roots
from .tally import decimal

BITS = 260
RELATIVE = arb(2) ** -110


def scene(rng):
    """A small net with a loss factor for most springs, under one noise, two, or one that comes again."""
    while True:
        form = rng.choice(("one", "one", "one", "two", "delayed"))
        forms = ("flat", "points", "road", "table") if form == "delayed" else ("white", "white", "flat", "points", "road", "table")
        net = noise.scene(rng, forms, form)
        # Other springs would have other damping, and the loss factors are the difference.
        if net.size() <= 3 and not net.damping:
            break
    net.losses = [rng.choice(("0", "0.1", "0.02", "1.5", "1e-3")) for _ in net.springs]
    plain = net.text
    net.text = lambda: lossy(net, plain())
    return net


def lossy(net, text):
    left = iter(net.losses)
    return re.sub(r"^(spring .*) }", lambda found: f"{found[1]}, loss = {next(left)} }}", text, flags=re.M)


def stiffer(net):
    """The net with each stiffness times 1 + loss."""
    other = copy.copy(net)
    other.springs = [(a, b, net.fraction(k) * (1 + decimal(loss))) for (a, b, k), loss in zip(net.springs, net.losses)]
    other.fraction = lambda word, replaced=None: word if isinstance(word, fmpq) else net.fraction(word, replaced)
    return other


class Poly:
    """A polynomial in s of which each coefficient is a complex fraction."""

    def __init__(self, re, im):
        self.re, self.im = fmpq_poly(re), fmpq_poly(im)

    def __add__(self, other):
        return Poly(self.re + other.re, self.im + other.im)

    def __mul__(self, other):
        return Poly(self.re * other.re - self.im * other.im, self.re * other.im + self.im * other.re)

    def negated(self):
        return Poly(-self.re, -self.im)

    def degree(self):
        return max(self.re.degree(), self.im.degree())

    def coefficients(self):
        """By powers of f, s = 2 pi i f."""
        pad = lambda list: list + [fmpq(0)] * (self.degree() + 1 - len(list))
        pairs = zip(pad(self.re.coeffs()), pad(self.im.coeffs()))
        return [acb(arb(x), arb(y)) * (2 * pi() * I) ** power for power, (x, y) in enumerate(pairs)]


class Gain:
    """The transfer functions from the inputs of a noise to an output together, times s^rate."""

    def __init__(self, net, other, output, name, rate):
        followers = [(own, word) for own, (source, word) in net.delays.items() if source == name]
        self.ways = [(name, arb(0))] + [(own, arb(decimal(word))) for own, word in followers]
        size = range(net.size())
        (m, c, k), stiff = net.matrices(), other.matrices()[2]
        q = [[of_s((k[i, j], c[i, j], m[i, j]), (stiff[i, j], c[i, j], m[i, j])) for j in size] for i in size]
        below = determinant(q)
        above = []
        for own, _ in self.ways:
            (row, direct), (row2, direct2) = net.row(output, own), other.row(output, own)
            column = [of_s(a, b) for a, b in zip(net.column(own), other.column(own))]
            sum_of = of_s(direct, direct2) * below
            for i in size:
                replaced = [[column[k] if j == i else q[k][j] for j in size] for k in size]
                sum_of += of_s(row[i], row2[i]) * determinant(replaced)
            above.append(sum_of * Poly([0] * rate + [1], []))
        # A base that drifts with its noise: common powers of s are cancelled.
        below = below * Poly([0] * net.noises[name].derivative + [1], [])
        while all(part.re[0] == 0 and part.im[0] == 0 for part in (below, *above)):
            below, *above = (Poly(part.re.coeffs()[1:], part.im.coeffs()[1:]) for part in (below, *above))
        self.below, self.above = below, above

    def at(self, f):
        value = lambda part: acb_poly(part.coefficients())(f)
        phases = ((-2 * pi() * I * f * time).exp() for _, time in self.ways)
        return sum((value(above) * phase for above, phase in zip(self.above, phases)), acb(0)) / value(self.below)

    def excess(self):
        """The degree of the denominator less that of the numerator."""
        return self.below.degree() - self.above[0].degree()

    def at_period(self, x):
        """At 1 / x, over x."""
        value = lambda part: acb_poly(part.coefficients()[::-1])(x)
        return value(self.above[0]) / value(self.below) * x ** (self.excess() - 1)


class Part(noise_maxima.Part):
    """A noise with its paths, for [`noise_maxima.peaks`]."""

    def __init__(self, net, i, name):
        gain = Gain(net, stiffer(net), i, name, 0)
        ways = zip(gain.above, [fmpq(0)] + [decimal(word) for source, word in net.delays.values() if source == name])
        self.paths = [(split(above), split(gain.below), time) for above, time in ways if above.degree() >= 0]
        self.roots = [root for root, _ in roots(noise.denominator(net), 60)]
        self.derivative = 0


def split(poly):
    """At i w, as a real and an imaginary polynomial in w."""
    (a, b), (c, d) = noise_maxima.split(poly.re), noise_maxima.split(poly.im)
    return [a - d, b + c]


def determinant(rows):
    """By the first row."""
    if not rows:
        return Poly([1], [])
    total = Poly([], [])
    for j, entry in enumerate(rows[0]):
        part = entry * determinant([row[:j] + row[j + 1:] for row in rows[1:]])
        total += part if j % 2 == 0 else part.negated()
    return total


def of_s(plain, stiff):
    """a + b s + c s^2, and i times what the loss factors add."""
    return Poly([fmpq(x) for x in plain], [sum((b - a for a, b in zip(plain, stiff)), fmpq(0))])


def square(net, output, rate):
    """The mean square of an output, or with rate = 1 of its rate; None if it is infinite."""
    ctx.prec = BITS
    other = stiffer(net)
    total = arb(0)
    for name, own in net.noises.items():
        gain = Gain(net, other, output, name, rate)
        if all(above.degree() < 0 for above in gain.above):
            continue
        mirrored = lambda of: lambda x, _: of(x) * of(x.conjugate()).conjugate()
        found = [root for root, _ in roots(noise.denominator(net), 60)]
        places = sorted({float(abs(root).mid()) / 6.283185307179586 for root in found if root != 0})
        if own.white is not None:
            if gain.excess() < 1:
                return None
            end = 8 * max(places + [1.0])
            total += (integral(mirrored(gain.at), 0, end, places) + integral(mirrored(gain.at_period), 0, 1 / arb(end), [])) * arb(own.white)
        for low, high, *rest in own.pieces or ():
            if rest[0] or rest[2]:
                course, of = noise.density(low, high, *rest), mirrored(gain.at)
                total += integral(lambda f, _: of(f, _) * course(f), low, high, places)
    return total


def integral(of, low, high, places):
    cuts = [arb(low)] + [arb(p) for p in places if float(arb(low).mid()) < p < float(arb(high).mid())] + [arb(high)]
    total = arb(0)
    for a, b in zip(cuts, cuts[1:]):
        total += acb.integral(of, a, b, rel_tol=RELATIVE, eval_limit=200_000).real
    return total


def check(net, program, tally, rng):
    """Compares what is told as a number; whether something is infinite is for classes without loss factors."""
    told = program.ask(tally, "analyze", net.text(), "--format", "json", tables=noise.tables(net))
    if told is None:
        return
    for row in told.get("noise") or []:
        if row["rms"] is None:
            tally.refuse(row["rms_reason"])
            continue
        noise_maxima.compare(net, row, tally, Part)
        i = int(row["output"][1:])
        mean = square(net, i, 0)
        if mean is None:
            tally.violate("rms", row["rms"], "infinite", row["rms_error_bound"])
            continue
        enclosed(tally, "rms", row["rms"], row["rms_error_bound"], mean.sqrt())
        if row["crossings_hz"] is None:
            tally.refuse(row["crossings_reason"])
        elif mean > 0:
            truth = square(net, i, 1)
            enclosed(tally, "crossings", row["crossings_hz"], row["crossings_error_bound"], (truth / mean).sqrt() / (2 * pi()))


def enclosed(tally, kind, told, bound, truth):
    """A truth of which fewer than thirty digits are known is none."""
    if truth.is_finite() and truth.rel_accuracy_bits() > 100:
        tally.relative(kind, told, bound, truth)
