"""Random numbers, shapes and signals of the scenes, from one seeded generator each."""

from .net import GROUND, Net


def decimal_word(rng, low, high, digits=None):
    """A decimal number between 10^low and 10^high, of a few digits."""
    digits = digits or rng.choice((1, 1, 2, 3, 6, 16))
    mantissa = str(rng.randrange(10 ** (digits - 1), 10 ** digits))
    exponent = rng.randint(low, max(low, high - 1))
    written = mantissa[0] + ("." + mantissa[1:] if len(mantissa) > 1 else "")
    return written if exponent == 0 else f"{written}e{exponent}"


def width(rng):
    """How many decades the numbers of a scene cover to each side."""
    return rng.choice((0, 0, 0, 1, 2, 4, 8, 12))


def links(rng, size, shape):
    """Pairs of bodies that a spring joins; most scenes have ground too."""
    pairs = []
    if shape == "chain":
        pairs = [(i - 1, i) for i in range(1, size)]
    elif shape == "tree":
        pairs = [(rng.randrange(i), i) for i in range(1, size)]
    elif shape == "star":
        pairs = [(0, i) for i in range(1, size)]
    elif shape == "dense":
        pairs = [(i, j) for j in range(size) for i in range(j)]
    else:
        pairs = [(rng.randrange(i), i) for i in range(1, size)]
        for _ in range(rng.randint(0, size)):
            i, j = rng.randrange(size), rng.randrange(size)
            if i != j:
                pairs.append((min(i, j), max(i, j)))
    return pairs


SHAPES = ("chain", "chain", "tree", "star", "net", "dense")


def size(rng, most=6):
    """How many bodies: few, mostly."""
    return min(most, rng.choice((1, 2, 2, 2, 3, 3, 4, 5, 6, 8, 12)))


def springs(rng, net, count, decades, grounded=True, negative=0.0):
    """A connected network of springs, joined to the ground unless it floats."""
    shape = rng.choice(SHAPES)
    for a, b in links(rng, count, shape):
        net.springs.append((a, b, spring_word(rng, decades, negative)))
    if grounded:
        for i in range(count):
            if i == 0 or rng.random() < 0.4:
                net.springs.append((GROUND, i, spring_word(rng, decades, negative)))
    if not net.springs:
        net.springs.append((GROUND, 0, spring_word(rng, decades, 0.0)))


def spring_word(rng, decades, negative):
    sign = "-" if rng.random() < negative else ""
    return sign + decimal_word(rng, -decades, decades + 2)


def bodies(rng, net, count, decades):
    net.masses = [decimal_word(rng, -decades, decades + 1) for _ in range(count)]


def dampers(rng, net, count, decades, share=0.6, negative=0.0, low=-3):
    """Dampers beside some of the springs, and to the ground."""
    places = {(a, b) for a, b, _ in net.springs} | {(GROUND, i) for i in range(count)}
    for a, b in sorted(places):
        if rng.random() < share:
            sign = "-" if rng.random() < negative else ""
            net.dampers.append((a, b, sign + decimal_word(rng, low - decades, decades + 1)))


def plain(rng, most=4, decades=None, damped=True):
    """An ordinary net with dampers."""
    net = Net()
    count = size(rng, most)
    decades = width(rng) if decades is None else decades
    bodies(rng, net, count, decades)
    springs(rng, net, count, decades)
    if damped:
        dampers(rng, net, count, decades)
    return net
