"""Rayleigh damping of nets on moving bases: beta on the rates of strains, alpha on motion relative to what the bases carry along."""

from . import draw, rates, transfer


def scene(rng):
    """A net on a moving base, with or without dampers of its own."""
    while True:
        net = transfer.scene(rng, 4, rng.choice((0, 0, 1, 3)))
        if net.bases:
            break
    words = [draw.decimal_word(rng, -3, 1), draw.decimal_word(rng, -4, 0)]
    if rng.random() < 0.3:
        words[rng.randrange(2)] = "0"
    net.damping = ("rayleigh", *words)
    return net


def check(net, program, tally, rng):
    """Compares values from the displacement of the base, or from its velocity and acceleration with their limits."""
    (rates if rng.random() < 0.3 else transfer).check(net, program, tally, rng)
