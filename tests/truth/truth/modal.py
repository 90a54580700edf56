"""Values of transfer functions of nets that `damping modal` damps: sums over the undamped modes.

With N(x) = det (K - x M + b p^T) - det (K - x M) and D(x) = det (K - x M), a mode of the square lambda adds
-N(lambda) / D'(lambda) / (s^2 + 2 zeta omega s + lambda)."""

from flint import acb, ctx, fmpq

from . import draw, transfer
from .exact import I, determinant, interpolate, pi, real_roots, value
from .modes import scale
from .tally import decimal

BITS = 400


def scene(rng):
    """An undamped net with a force, and one ratio for all of its modes."""
    net = draw.plain(rng, 4, rng.choice((0, 0, 1, 3)), damped=False)
    net.damping = ("modal", rng.choice(("0.02", "5e-3", "0.3", "1", "1e-9", draw.decimal_word(rng, -4, 0))))
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
    parts = {}
    for i in range(len(net.outputs)):
        row, _ = net.row(i, "F0")
        parts[f"y{i}"] = residues(net, row, net.column("F0"), squares)
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
        truth = acb(0)
        for power, shares in enumerate(parts[output]):
            for x, share in zip(squares, shares):
                if share != 0:
                    truth += s ** power * share / (s * s + 2 * ratio * abs(x).sqrt() * s + x)
        transfer.compare_value(line, truth, tally)
