"""Values of transfer functions of nets that `damping modal` damps: sums over the undamped modes.

With N(x) = det (K - x M + b p^T) - det (K - x M) and D(x) = det (K - x M), a mode of the square lambda adds
-N(lambda) / D'(lambda) / (s^2 + 2 zeta omega s + lambda). Where a base drives the net, the damping is relative to what follows the base
statically: by x^T M r = x^T K_b / lambda that is another factor 1 + 2 zeta s / omega."""

from flint import acb, ctx, fmpq

from . import draw, transfer
from .exact import I, determinant, interpolate, pi, real_roots, value
from .modes import scale
from .net import GROUND
from .tally import decimal

BITS = 400


def scene(rng):
    """An undamped net with a force or a moving base, and one ratio for all of its modes."""
    net = draw.plain(rng, 4, rng.choice((0, 0, 1, 3)), damped=False)
    net.damping = ("modal", rng.choice(("0.02", "5e-3", "0.3", "1", "1.25", "1e6", "1e-9", draw.decimal_word(rng, -4, 0))))
    held = [i for i, (a, _, _) in enumerate(net.springs) if a == GROUND]
    if held and rng.random() < 0.4:
        net.bases.append("")
        for place in held[:rng.randint(1, len(held))]:
            _, b, k = net.springs[place]
            net.springs[place] = (("base", 0), b, k)
    else:
        net.forces.append(rng.randrange(net.size()))
    transfer.outputs(rng, net)
    return net


def residues(net, row, column, squares):
    """For each power of s in the row, what each mode adds to p^T X (...) X^T b, over its mass."""
    m, _, k = net.matrices()
    size = net.size()
    slope = determinant([k, -m], scale(m, k)).derivative()
    found = []
    for power in range(3):
        def at(x):
            q = k - m * fmpq(x)
            bordered = q.__class__(size, size, [q[i, j] + column[i][0] * row[j][power] for i in range(size) for j in range(size)])
            return bordered.det() - q.det()

        numerator = interpolate(at, size)
        found.append([-value(numerator, x) / value(slope, x) for x in squares])
    return found


def check(net, program, tally, rng):
    """Compares the values at some frequencies."""
    ctx.prec = BITS
    m, _, k = net.matrices()
    poly = determinant([k, -m], scale(m, k))
    listed = real_roots(poly, BITS)
    if any(count > 1 for _, count in listed):
        return
    squares = [x for x, _ in listed]
    ratio = decimal(net.damping[1])
    name = "u0" if net.bases else "F0"
    parts, through = {}, {}
    for i in range(len(net.outputs)):
        row, through[f"y{i}"] = net.row(i, name)
        parts[f"y{i}"] = residues(net, row, net.column(name), squares)
    words = []
    for x in squares:
        if x > 0 and rng.random() < 0.7:
            words.append(transfer.plain((x.sqrt() / (2 * pi())).mid().str(rng.choice((3, 6, 12, 17)), radius=False)))
    words += [draw.decimal_word(rng, -2, 2) for _ in range(2)]
    asked = [option for word in dict.fromkeys(words) for option in ("--at", word + "Hz")]
    told = program.ask(tally, "transfer", net.text(), "--format", "json", *asked)
    if told is None:
        return
    exact = {float(word): decimal(word) for word in words}
    for _, output, line in transfer.rows(told):
        f = exact.get(line["frequency_hz"])
        if f is None:
            continue
        s = I * 2 * pi() * f
        truth = sum((s ** power * part for power, part in enumerate(through[output])), acb(0))
        for power, shares in enumerate(parts[output]):
            for x, share in zip(squares, shares):
                if share != 0:
                    carried = 1 + 2 * ratio * s / abs(x).sqrt() if net.bases else 1
                    truth += s ** power * share * carried / (s * s + 2 * ratio * abs(x).sqrt() * s + x)
        transfer.compare_value(line, truth, tally)
