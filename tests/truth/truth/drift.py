"""Noise where no spring or no damper holds some motions: what cancels in an output, what drifts away, and what rings for ever. Few different
numbers, so that zeros and poles cancel exactly."""

from . import noise
from .exact import roots
from .net import GROUND, Net

KINDS = ("x", "vx", "ax", "difference", "difference", "sum", "stretch", "damper")


def scene(rng):
    """A chain with gaps, under one noise of one form."""
    while True:
        net = chain(rng)
        if net is not None and any(not root.real < 0 for root, _ in roots(noise.denominator(net), 200)):
            break
    first = net.inputs()[0]
    unit, kinds = ("m^2", 3) if net.bases else ("N^2", 1)
    net.noises = {first: noise.drawn(rng, net, unit, kinds, ("white", "white", "flat", "flat", "points"))}
    net.delays = {}
    return noise.written(net)


def word(rng):
    return rng.choice(("1", "1", "1", "2", "2", "0.5", "3.7"))


def chain(rng):
    """Bodies one behind the other, each tied to the one before it, and some to the ground, by a spring, a damper, both or nothing."""
    net = Net()
    net.masses = [word(rng) for _ in range(rng.randint(1, 4))]
    count = net.size()
    if rng.random() < 0.6:
        net.bases.append("")
    else:
        net.forces.append(rng.randrange(count))
    start = ("base", 0) if net.bases else GROUND
    ties = [(start if i == 0 else i - 1, i) for i in range(count)]
    ties += [(rng.choice((GROUND, start)), i) for i in range(1, count) if rng.random() < 0.25]
    for a, b in ties:
        if rng.random() < 0.55:
            net.springs.append((a, b, word(rng)))
        if rng.random() < 0.55:
            net.dampers.append((a, b, word(rng)))
    is_tied = any(isinstance(a, tuple) for a, _, _ in net.springs + net.dampers)
    if net.bases and not is_tied:
        return None
    for _ in range(rng.randint(2, 4)):
        net.outputs.append(output(rng, net))
    return net


def output(rng, net):
    kind, count = rng.choice(KINDS), net.size()
    if kind in ("difference", "sum") and count > 1:
        a, b = rng.sample(range(count), 2)
        return [("1", "x", a), ("-1" if kind == "difference" else "1", "x", b)]
    if kind == "stretch" and net.springs:
        return [("1", "k.stretch", rng.randrange(len(net.springs)))]
    if kind == "damper" and net.dampers:
        return [("1", "c.force", rng.randrange(len(net.dampers)))]
    return [("1", kind if kind in ("vx", "ax") else "x", rng.randrange(count))]
