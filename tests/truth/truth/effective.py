"""Effective masses of nets on moving bases: with b = M r, K r = K_b u, the mode of the square lambda has -N(lambda) / D'(lambda),
D(x) = det (K - x M), N(x) = det (K - x M + b b^T) - D(x); all of them together r^T M r."""

from flint import ctx, fmpq, fmpq_mat

from . import draw
from .exact import determinant, real_roots
from .modal import residues
from .modes import scale
from .net import GROUND

BITS = 400


def scene(rng):
    """A net of springs on one or two bases; some of it may stand on the ground as well."""
    net = draw.plain(rng, 6, rng.choice((0, 0, 1, 3)), damped=False)
    net.bases = [""] * rng.choice((1, 1, 2))
    held = [i for i, (a, _, _) in enumerate(net.springs) if a == GROUND] or [0]
    for place, i in enumerate(held):
        a, b, k = net.springs[i]
        if a == GROUND and (place == 0 or rng.random() < 0.8):
            net.springs[i] = (("base", rng.randrange(len(net.bases)) if place else 0), b, k)
    return net


def check(net, program, tally, rng):
    """Compares every effective mass, their running sums and the total."""
    ctx.prec = BITS
    m, _, k = net.matrices()
    listed = real_roots(determinant([k, -m], scale(m, k)), BITS)
    if any(count > 1 for _, count in listed):
        return
    squares = [x for x, _ in listed]
    told = program.ask(tally, "analyze", net.text(), "--participation", "--format", "json")
    if told is None:
        return
    size = net.size()
    for excited in told["base_excitation"] or []:
        if excited["not_computed"] is not None:
            tally.refuse("not computed")
            continue
        pushed = fmpq_mat(size, 1, [entry[0] for entry in net.column(excited["input"])])
        carried = k.solve(pushed)
        moved = m * carried
        column = [[moved[i, 0], fmpq(0), fmpq(0)] for i in range(size)]
        masses = residues(net, column, column, squares)[0]
        total = (carried.transpose() * moved)[0, 0]
        tally.absolute("total", excited["total"], excited["total_error_bound"], total)
        running = 0
        for row, mass in zip(excited["modes"], masses):
            running = running + mass
            tally.absolute("effective mass", row["effective_mass"], row["effective_mass_error_bound"], mass, unit=total)
            tally.absolute("running sum", row["sum"], row["sum_error_bound"], running, unit=total)
