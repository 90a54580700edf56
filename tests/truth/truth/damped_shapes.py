"""Shapes of damped motions: the complex null vector at each pole, with the entry that is told as 1."""

from flint import acb, acb_mat, ctx

from . import draw, poles, transfer
from .net import Net

BITS = 400


def scene(rng):
    """Nets with dampers out of proportion, Rayleigh damping, negative dampers, bodies without mass; some outputs."""
    net = Net()
    count = rng.choice((1, 2, 2, 3, 4, 6, 13))
    decades = rng.choice((0, 0, 1, 3))
    draw.bodies(rng, net, count, decades)
    draw.springs(rng, net, count, decades)
    draw.dampers(rng, net, count, decades, share=rng.choice((0.3, 0.8)), negative=rng.choice((0, 0, 0.2)))
    if rng.random() < 0.15 and count > 1:
        net.masses[rng.randrange(count)] = "0"
    if rng.random() < 0.15:
        net.damping = ("rayleigh", draw.decimal_word(rng, -3, 1), draw.decimal_word(rng, -4, 0))
    net.forces.append(rng.randrange(count))
    transfer.outputs(rng, net, 1)
    return net


def check(net, program, tally, rng):
    """Compares every entry and output of the shapes."""
    ctx.prec = BITS
    told = program.ask(tally, "analyze", net.text(), "--shapes", "damped", "--format", "json")
    if told is None:
        return
    true = poles.true_poles(net)
    if true is None:
        return
    m, c, k = net.matrices()
    names = told["coordinates"]
    motions = [pole for pole in told["poles"] if pole["im"] >= 0]
    for row in told.get("damped_shapes", []):
        if row["not_computed"] is not None:
            tally.refuse("not computed")
            continue
        at = acb(motions[row["motion"] - 1]["re"], motions[row["motion"] - 1]["im"])
        near = sorted(true, key=lambda p: float(abs(p - at).mid()))
        if len(near) > 1 and abs(near[1] - near[0]) < 1e-9 * abs(near[0]):
            tally.refuse("double pole")
            continue
        s = near[0]
        entries = [row["shape"][name] for name in names]
        leading = [i for i, entry in enumerate(entries) if entry["re"] == 1 and entry["im"] == 0 and entry["error_bound"] == 0]
        tally.verdict("an entry is 1", bool(leading), True)
        if not leading:
            continue
        x = shape(m, c, k, s, leading[0])
        if x is None:
            tally.refuse("oracle")
            continue
        for entry, value in zip(entries, x):
            compare(tally, "entry", entry, value)
        for i in range(len(net.outputs)):
            rows, _ = net.row(i, net.inputs()[0])
            value = sum((x[j] * sum((acb(f) * s**power for power, f in enumerate(rows[j])), acb(0)) for j in range(len(x))), acb(0))
            compare(tally, "output", row["outputs"][f"y{i}"], value)


def compare(tally, kind, entry, value):
    """A complex number with a bound relative to it, and its phase."""
    if value.contains(0):
        tally.absolute(kind + " of zero", entry["magnitude"], entry["error_bound"], abs(value).mid() * 0)
        return
    tally.relative(kind, (entry["re"], entry["im"]), entry["error_bound"], value, size=abs(value))
    if entry["phase_error_bound"] is not None:
        transfer.phase(tally, kind + " phase", entry["phase_deg"], entry["phase_error_bound"], entry["error_bound"], value)


def shape(m, c, k, s, leading):
    """x with Q(s) x = 0 and one entry 1, by the bordered equations in balls."""
    n = m.nrows()
    rows = [[acb(m[i, j]) * s * s + acb(c[i, j]) * s + acb(k[i, j]) for j in range(n)] + [acb(int(i == leading))] for i in range(n)]
    rows.append([acb(int(j == leading)) for j in range(n)] + [acb(0)])
    try:
        found = acb_mat(rows).solve(acb_mat([[acb(int(i == n))] for i in range(n + 1)]))
    except ZeroDivisionError:
        return None
    return [found[i, 0] for i in range(n)]
