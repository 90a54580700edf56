"""Values of transfer functions of nets whose springs have loss factors: k (1 + i loss) in place of k.

All numbers of a net are of first degree in its stiffnesses, so what the factors add is the difference of the net with k (1 + loss)
and the net with k."""

import copy
import re

from flint import acb, acb_mat, ctx, fmpq

from . import draw, transfer
from .exact import I, pi
from .tally import decimal

BITS = 400


def scene(rng):
    """A net with one input and a loss factor, or none, for each spring."""
    net = transfer.scene(rng)
    net.losses = [rng.choice(("0", "0.1", "0.02", "1.5", draw.decimal_word(rng, -6, 0))) for _ in net.springs]
    return net


def text(net):
    """The model, with the loss factors in the order of the springs."""
    left = iter(net.losses)
    return re.sub(r"^(spring .*) }", lambda found: f"{found[1]}, loss = {next(left)} }}", net.text(), flags=re.M)


def check(net, program, tally, rng):
    """Compares the values at some frequencies."""
    ctx.prec = BITS
    other = copy.deepcopy(net)
    other.springs = [(a, b, net.fraction(k) * (1 + decimal(loss))) for (a, b, k), loss in zip(net.springs, net.losses)]
    other.fraction = lambda word, replaced=None: word if isinstance(word, fmpq) else net.fraction(word, replaced)
    names = net.inputs()
    if not names:
        return
    words = transfer.frequencies(rng, transfer.function(net, 0, names[0])[1])
    asked = [option for word in words for option in ("--at", word + "Hz")]
    if not words:
        return
    told = program.ask(tally, "transfer", text(net), "--format", "json", *asked)
    if told is None:
        return
    exact = {float(word): decimal(word) for word in words}
    for name, output, row in transfer.rows(told):
        f = exact.get(row["frequency_hz"])
        if f is not None:
            truth = value(net, other, int(output[1:]), name, f)
            if truth is not None:
                transfer.compare_value(row, truth, tally)


def value(net, other, output, name, f):
    """H at a frequency."""
    s = I * 2 * pi() * f

    def lossy(plain, stiffer):
        return sum((s ** power * a for power, a in enumerate(plain)), acb(0)) + I * sum((b - a for a, b in zip(plain, stiffer)), fmpq(0))

    size = net.size()
    (m, c, k), stiff = net.matrices(), other.matrices()[2]
    q = acb_mat(size, size, [lossy((k[i, j], c[i, j], m[i, j]), (stiff[i, j], c[i, j], m[i, j])) for i in range(size) for j in range(size)])
    (row, direct), (row2, direct2) = net.row(output, name), other.row(output, name)
    b = acb_mat(size, 1, [lossy(x, y) for x, y in zip(net.column(name), other.column(name))])
    try:
        x = q.solve(b)
    except ZeroDivisionError:
        return None
    return sum((lossy(p, p2) * x[i, 0] for i, (p, p2) in enumerate(zip(row, row2))), acb(0)) + lossy(direct, direct2)
