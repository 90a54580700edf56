"""Numbers near both ends of binary64: the same modes, poles and transfer values with masses and springs of 1e-300 to 1e300."""

from flint import ctx

from . import draw, modes, poles, transfer
from .net import Net

BITS = 500


def moved(word, decades):
    """A decimal number times a power of ten."""
    mantissa, _, exponent = word.partition("e")
    return f"{mantissa}e{int(exponent or 0) + decades}"


def scene(rng):
    """A small net, its masses, springs and dampers each moved by some hundred decades."""
    net = Net()
    count = rng.choice((1, 2, 2, 3, 4, 6))
    decades = rng.choice((0, 0, 1, 3))
    draw.bodies(rng, net, count, decades)
    draw.springs(rng, net, count, decades)
    if rng.random() < 0.7:
        draw.dampers(rng, net, count, decades)
    far = 297 - decades
    m = rng.choice((-far, far, rng.randint(-far, far), 0))
    k = rng.choice((-far, far, rng.randint(-far, far), m))
    c = max(-far, min(far, (m + k) // 2 + rng.choice((0, 0, 5, -5, -100, 100))))
    net.masses = [moved(word, m) for word in net.masses]
    net.springs = [(a, b, moved(word, k)) for a, b, word in net.springs]
    net.dampers = [(a, b, moved(word, c)) for a, b, word in net.dampers]
    net.forces.append(rng.randrange(count))
    transfer.outputs(rng, net, 2)
    return net


def check(net, program, tally, rng):
    """Compares what is told of all three."""
    ctx.prec = BITS
    told = program.ask(tally, "analyze", net.text(), "--format", "json")
    if told is None:
        return
    true = poles.true_poles(net)
    modes.compare(told, modes.squares(net), tally)
    poles.compare(told, true, None, tally)
    transfer.check(net, program, tally, rng)
