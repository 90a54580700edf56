"""Poles of nets whose springs have loss factors: eigenvalues above the real axis with k (1 + i loss), and their mirror images."""

import copy

from flint import acb, acb_mat, ctx, fmpq

from . import loss, poles
from .exact import I
from .mechanics import eigenvalues
from .modes import squares
from .tally import decimal

BITS = 400


def scene(rng):
    """A net with loss factors, of few coordinates and without bodies that have no mass."""
    while True:
        net = loss.scene(rng)
        if all(decimal(mass) != 0 for mass in net.masses):
            return net


def check(net, program, tally, rng):
    """Compares the list of poles and the verdict."""
    ctx.prec = BITS
    told = program.ask(tally, "analyze", loss.text(net), "--format", "json")
    if told is None:
        return
    true = true_poles(net)
    if true is None:
        tally.refuse("oracle")
    elif not told["poles"]:
        tally.refuse("poles not computed")
    else:
        poles.compare(told, true, squares(net), tally)


def true_poles(net):
    """The eigenvalues that are told of, or None where they are not separated."""
    found = values(net)
    if found and any(s.imag == 0 for s in found) and any(decimal(word) != 0 for word in net.losses):
        # Beside a loss factor a value may be a little above or below the axis. Where sixteen hundred bits do not tell, the
        # losses are in other parts of the net.
        ctx.prec = 4 * BITS
        found = values(net)
        ctx.prec = BITS
    if found is None:
        return None
    true = [s for s in found if s.imag == 0]
    for s in found:
        if s.imag > 0:
            true += [s, s.conjugate()]
    return true


def values(net):
    """All eigenvalues with k (1 + i loss), or None where they are not separated."""
    other = copy.deepcopy(net)
    other.springs = [(a, b, net.fraction(k) * (1 + decimal(word))) for (a, b, k), word in zip(net.springs, net.losses)]
    other.fraction = lambda word, replaced=None: word if isinstance(word, fmpq) else net.fraction(word, replaced)
    (m, c, k), stiff, size = net.matrices(), other.matrices()[2], net.size()
    inverse = m.inv()

    def entry(i, j):
        if i < size:
            return acb(1 if j == i + size else 0)
        row = range(size)
        if j < size:
            return sum((-inverse[i - size, r] * (acb(k[r, j]) + I * acb(stiff[r, j] - k[r, j])) for r in row), acb(0))
        return sum((acb(-inverse[i - size, r] * c[r, j - size]) for r in row), acb(0))

    try:
        return eigenvalues(acb_mat(2 * size, 2 * size, [entry(i, j) for i in range(2 * size) for j in range(2 * size)]))
    except ValueError:
        return None
