"""Undamped frequencies, growth rates, rigid motions and their number; with `--digits 30` the digits themselves."""

from flint import ctx, fmpq

from . import draw
from .exact import determinant, pi, real_roots
from .net import GROUND, Net

BITS = 320


def scene(rng):
    """Chains, trees, stars, nets and dense ones; graded, floating, negative, without mass here and there."""
    net = Net()
    count = draw.size(rng, 12)
    decades = draw.width(rng)
    draw.bodies(rng, net, count, decades)
    draw.springs(rng, net, count, decades, grounded=rng.random() < 0.85, negative=rng.choice((0, 0, 0, 0.15)))
    if count > 1 and rng.random() < 0.2:
        for i in rng.sample(range(count), rng.randint(1, count - 1)):
            net.masses[i] = "0"
    if count > 1 and rng.random() < 0.15:
        repeat(rng, net, count)
    return net


def repeat(rng, net, count):
    """Equal bodies on equal springs: frequencies that repeat, or nearly."""
    near = rng.choice((0, 0, -9, -14, -17, -25))
    mass, ground = (draw.decimal_word(rng, -1, 2, 2) for _ in range(2))
    link = draw.decimal_word(rng, near, near + 1, 2)
    net.masses = [mass] * count
    net.springs = [(GROUND, i, ground) for i in range(count)]
    ring = [(i, (i + 1) % count) for i in range(count)] if count > 2 else [(0, 1)]
    net.springs += [(min(a, b), max(a, b), link) for a, b in ring]


def squares(net):
    """The squares of the frequencies, ascending, each as often as it occurs."""
    m, _, k = net.matrices()
    poly = determinant([k, -m], scale(m, k))
    if poly.is_zero():
        return None
    return [x for x, count in real_roots(poly, BITS) for _ in range(count)]


def scale(m, k):
    """A power of two near the middle of the squares: keeps the numbers of the interpolation short."""
    traces = [k[i, i] / m[i, i] for i in range(m.nrows()) if m[i, i] != 0 and k[i, i] != 0]
    if not traces:
        return fmpq(1)
    middle = sorted(abs(t) for t in traces)[len(traces) // 2]
    return fmpq(2) ** (int(middle.p).bit_length() - int(middle.q).bit_length()) if middle != 0 else fmpq(1)


def check(net, program, tally, rng):
    """Compares the list of modes."""
    ctx.prec = BITS
    told = program.ask(tally, "analyze", net.text(), "--format", "json")
    if told is None:
        return
    compare(told, squares(net), tally)


def compare(told, true, tally):
    """A list of modes against the true squares of frequencies."""
    modes = told["modes"]
    if true is None:
        return
    if any(mode["kind"] == "undetermined" for mode in modes):
        tally.refuse("undetermined")
        return
    tally.verdict("number of modes", len(modes), len(true))
    if len(modes) != len(true):
        return
    for mode, square in zip(modes, true):
        kind = "rigid" if square == 0 else "oscillation" if square > 0 else "divergence"
        tally.verdict("kind of mode", mode["kind"], kind)
        if mode["kind"] != kind or kind == "rigid":
            continue
        size = abs(square).sqrt()
        if kind == "divergence":
            tally.relative("growth rate", mode["growth_rate"], mode["omega_error_bound"], size)
            continue
        tally.relative("omega", mode["omega"], mode["omega_error_bound"], size)
        tally.relative("frequency", mode["frequency_hz"], mode["omega_error_bound"], size / (2 * pi()))
    for split in told.get("splits", []):
        a, b = split["modes"]
        gap = true[b - 1].sqrt() - true[a - 1].sqrt()
        tally.relative("split", split["omega"], split["error_bound"], gap)


def check_digits(net, program, tally, rng):
    """Compares the digits of `--digits 30`, in units of the last one shown."""
    ctx.prec = BITS
    told = program.ask(tally, "analyze", net.text(), "--format", "json", "--digits", "30")
    if told is None:
        return
    true = squares(net)
    if true is None or len(told["modes"]) != len(true):
        return
    for mode, square in zip(told["modes"], true):
        word = mode.get("omega_digits") or mode.get("growth_rate_digits")
        if word is None or mode["kind"] not in ("oscillation", "divergence"):
            if mode["kind"] != "rigid":
                tally.without_bound += 1
            continue
        size = abs(square).sqrt()
        tally.digits("digits of omega", word, size)
