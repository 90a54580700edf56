"""Nets of 10 to 30 coordinates: modes and poles, by certified eigenvalues of a matrix of balls."""

from flint import arb_mat, ctx

from . import draw, planar, poles
from .mechanics import eigenvalues
from .net import Net

BITS = 500


def scene(rng):
    """A damped net of any shape, graded or not."""
    net = Net()
    count = rng.randint(10, 30)
    decades = rng.choice((0, 0, 1, 3, 6))
    draw.bodies(rng, net, count, decades)
    draw.springs(rng, net, count, decades)
    draw.dampers(rng, net, count, decades, share=rng.choice((0.2, 0.6)), negative=rng.choice((0, 0, 0.05)))
    return net


def check(net, program, tally, rng):
    """Compares modes and poles."""
    ctx.prec = BITS
    told = program.ask(tally, "analyze", net.text(), "--format", "json")
    if told is None:
        return
    m, c, k = net.matrices()
    size = net.size()
    inverse = m.inv()
    stiff, damp = arb_mat(inverse * k), arb_mat(inverse * c)
    state = arb_mat(2 * size, 2 * size)
    for i in range(size):
        state[i, size + i] = 1
        for j in range(size):
            state[size + i, j] = -stiff[i, j]
            state[size + i, size + j] = -damp[i, j]
    try:
        squares = sorted((v.real for v in eigenvalues(stiff)), key=lambda x: float(x.mid()))
        places = eigenvalues(state)
    except ValueError:
        tally.refuse("the oracle isolates no eigenvalues")
        return
    planar.modes(told, squares, tally)
    poles.compare(told, places, None, tally)
