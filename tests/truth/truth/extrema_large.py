"""Peaks and antiresonances of nets of 13 to 20 coordinates, more than the program's exact polynomials take: ordinary and graded ones,
lightly damped and undamped ones, and arms on one body that are nearly equal, or damped critically so that poles meet."""

from . import draw, transfer
from .net import GROUND, Net


def scene(rng):
    """A net, its force and its outputs."""
    kind = rng.choice(("plain", "graded", "light", "undamped", "rayleigh", "twins", "twins", "critical", "far"))
    count = rng.randint(13, 20 if kind in ("plain", "light", "undamped") else 16)
    net = Net()
    if kind in ("twins", "critical"):
        arms(rng, net, count, kind)
    else:
        decades = rng.choice((1, 2, 4)) if kind == "graded" else 0
        draw.bodies(rng, net, count, decades)
        draw.springs(rng, net, count, decades)
        if kind == "rayleigh":
            net.damping = ("rayleigh", draw.decimal_word(rng, -6, 0, 2), draw.decimal_word(rng, -8, -1, 2))
        elif kind == "light":
            draw.dampers(rng, net, count, 0, share=rng.choice((0.2, 1.0)), low=rng.choice((-15, -11, -8, -5)))
            net.dampers = [(a, b, "1e-" + str(rng.randint(3, 15))) for a, b, _ in net.dampers]
        elif kind != "undamped":
            draw.dampers(rng, net, count, decades, share=rng.choice((0.2, 0.6)))
    net.forces.append(rng.randrange(count))
    transfer.outputs(rng, net, 2)
    if kind == "far":
        # A node of little mass behind a stiff spring: a pole far above all others.
        net.masses[rng.randrange(count)] = draw.decimal_word(rng, -9, -3, 2)
    return net


def arms(rng, net, count, kind):
    """Oscillators on one body, equal but for one part in 10^3 to 10^14."""
    net.masses = [draw.decimal_word(rng, 0, 2, 2)] + ["1"] * (count - 1)
    net.springs = [(GROUND, 0, draw.decimal_word(rng, 0, 2, 2))]
    net.dampers = [(GROUND, 0, draw.decimal_word(rng, -4, 0, 2))]
    near = rng.choice((3, 6, 9, 12, 14))
    groups = rng.choice((1, 2, 4))
    for i in range(1, count):
        stiffness = str((1, 4, 9, 16)[i % groups])
        if rng.random() < 0.7:
            stiffness += "." + "0" * (near - 1) + str(rng.randint(1, 9))
        net.springs.append((0, i, stiffness))
        damping = str(2 * (1, 2, 3, 4)[i % groups]) if kind == "critical" else draw.decimal_word(rng, -6, -2, 1)
        if kind == "critical" or rng.random() < 0.8:
            net.dampers.append((0, i, damping))
