"""Transfer functions where Q(s) is singular: at 0 Hz of scenes with rigid motions, at an undamped natural frequency.

There H is a limit: poles that a zero cancels are divided out of numerator and denominator, as polynomials over fractions."""

from flint import acb, ctx, fmpq, fmpq_poly

from . import draw, transfer
from .exact import I, value
from .net import GROUND, Net, end, free, with_unit


class Singular(Net):
    """A net with inerters, and the frequency in rad/s at which it is asked."""

    def __init__(self):
        super().__init__()
        self.inerters = []
        self.omega = 0

    def text(self):
        """The model."""
        rows = [f"inerter v{i}: {end(a)} -- {end(b)} {{ b = {with_unit(word, 'kg')} }}" for i, (a, b, word) in enumerate(self.inerters)]
        return super().text() + "".join(row + "\n" for row in rows)

    def mass(self, replaced=None):
        """M."""
        return super().mass(replaced) + self.network(self.inerters, replaced)[0]

    def column(self, name):
        """B(s) of an input."""
        column = super().column(name)
        if name[0] == "u":
            driven = self.network(self.inerters)[1]
            for j in range(self.size()):
                column[j][2] += driven[j, int(name[1:])]
        return column

    def without(self, i):
        """Bodies stay."""
        return None


def scene(rng):
    """A scene with rigid motions, or one with an undamped natural frequency that is a whole number of rad/s."""
    net = Singular()
    count = rng.choice((1, 1, 2, 2, 3, 4))
    draw.bodies(rng, net, count, rng.choice((0, 0, 1)))
    places = list(range(count))
    ends = places + [GROUND]
    if rng.random() < 0.5:
        net.bases.append("")
        ends.append(("base", 0))
    else:
        net.forces.append(rng.choice(places))
    (at_rest if rng.random() < 0.6 else at_resonance)(rng, net, ends)
    transfer.outputs(rng, net) if net.springs else plain_outputs(rng, net)
    return net


def element(rng, net, ends, word):
    """An element from a body to something else."""
    b = rng.randrange(net.size())
    a = rng.choice([place for place in ends if place != b])
    return a, b, word


def at_rest(rng, net, ends):
    """Few springs; dampers and inerters hold some of the motions, or none."""
    fixed = [place for place in ends if not free(place)]
    for elements, most in ((net.springs, 2), (net.dampers, 3), (net.inerters, 2)):
        for _ in range(rng.randint(0, most)):
            elements.append(element(rng, net, ends, draw.decimal_word(rng, -1, 2)))
    if rng.random() < 0.3:
        # Two springs that cancel: the coordinate is free, although springs act on it.
        word = draw.decimal_word(rng, 0, 2)
        b = rng.randrange(net.size())
        net.springs += [(rng.choice(fixed), b, word), (rng.choice(fixed), b, "-" + word)]


def at_resonance(rng, net, ends):
    """Springs from the ground balance the inertia of one shape at one frequency."""
    count = net.size()
    for elements, most in ((net.springs, 3), (net.inerters, 2)):
        for _ in range(rng.randint(0, most)):
            elements.append(element(rng, net, ends, draw.decimal_word(rng, -1, 2, digits=2)))
    net.omega = rng.randint(1, 9)
    shape = [fmpq(rng.choice((1, -1, 2, 1))) for _ in range(count)]
    if rng.random() < 0.3:
        shape[rng.randrange(count)] = fmpq(0)
    m, _, k = net.matrices()
    fixed = [place for place in ends if not free(place)]
    for i in range(count):
        left = sum(((m[i, j] * net.omega ** 2 - k[i, j]) * shape[j] for j in range(count)), fmpq(0))
        if shape[i] == 0 or left == 0:
            continue
        net.springs.append((rng.choice(fixed), i, word_of(left / shape[i])))


def word_of(fraction):
    """A fraction whose denominator divides a power of ten, as a decimal word."""
    digits = 0
    while fraction.q != 1 and digits < 40:
        fraction, digits = fraction * 10, digits + 1
    return f"{fraction.p}e-{digits}" if digits else str(fraction.p)


def plain_outputs(rng, net):
    """Motions of bodies."""
    for _ in range(rng.randint(1, 3)):
        net.outputs.append([("1", rng.choice(("x", "vx", "ax")), rng.randrange(net.size()))])


def check(net, program, tally, rng):
    """Compares the limits of every pair."""
    ctx.prec = transfer.BITS
    asked = "0Hz" if net.omega == 0 else f"{net.omega} rad/s"
    told = program.ask(tally, "transfer", net.text(), "--format", "json", "--at", asked)
    if told is None:
        return
    factor = fmpq_poly([0, 1]) if net.omega == 0 else fmpq_poly([net.omega ** 2, 0, 1])
    for name, output, row in transfer.rows(told):
        numerator, denominator = transfer.function(net, int(output[1:]), name)
        while numerator != 0 and divides(factor, denominator) and divides(factor, numerator):
            numerator, denominator = numerator // factor, denominator // factor
        is_infinite = numerator != 0 and divides(factor, denominator)
        if row["re"] is None and not row.get("infinite"):
            tally.refuse("no value")
            continue
        tally.verdict("infinite", bool(row.get("infinite")), is_infinite)
        if not is_infinite and row["re"] is not None:
            s = I * net.omega
            truth = acb(0) if divides(factor, numerator) else value(numerator, s) / value(denominator, s)
            transfer.compare_value(row, truth, tally)


def divides(factor, poly):
    """Whether a polynomial has this factor."""
    return poly % factor == 0
