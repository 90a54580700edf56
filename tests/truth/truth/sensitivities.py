"""Sensitivities: derivatives of frequencies and damping ratios by a parameter, from those of the determinant."""

from flint import ctx, fmpq

from . import draw
from .exact import determinant, pi, value
from .modes import scale, squares
from .net import GROUND, Net
from .poles import true_poles
from .tally import decimal

BITS = 400


def scene(rng):
    """A parameter in one or more elements; veering, repeated and ordinary frequencies."""
    net = Net()
    kind = rng.choice(("plain", "plain", "veering", "veering", "ring"))
    net.unit = "N/m"
    if kind == "veering":
        count = 2
        coupling = rng.choice((0, -3, -6, -9, -10, -12, -15))
        detuning = rng.choice((0, -6, -9, -12))
        net.masses = ["1", "1"]
        part = f"{rng.randint(1, 9)}" if detuning else "0"
        value = "1." + "0" * (-detuning - 1) + part if detuning else "1.5"
        net.parameters["p"] = f"{value} N/m"
        net.springs = [(GROUND, 0, "@p"), (GROUND, 1, "1"), (0, 1, draw.decimal_word(rng, coupling, coupling + 1, 1))]
    else:
        count = rng.choice((1, 2, 3, 4))
        draw.bodies(rng, net, count, 0)
        draw.springs(rng, net, count, 0)
        net.parameters["p"] = f"{draw.decimal_word(rng, 0, 1)} N/m"
        for i in rng.sample(range(len(net.springs)), min(len(net.springs), rng.choice((1, 1, 2)))):
            a, b, _ = net.springs[i]
            net.springs[i] = (a, b, "@p")
        if kind == "ring":
            net.masses = ["1"] * count
    if rng.random() < 0.5:
        draw.dampers(rng, net, count, 0, share=0.6, low=-4)
    return net


def derivatives(net, poly_of, places):
    """dz/dp of each simple root z of a polynomial F(z, p), by -F_p / F_z."""
    p = decimal(net.parameters["p"].split()[0])
    degree = sum("@" in v for _, _, v in net.springs + net.dampers)
    polys = [poly_of(p + j) for j in range(degree + 1)]
    # The derivative with respect to p of the polynomial in p through these points, at the first of them.
    slope = polys[0] * 0
    difference = list(polys)
    for order in range(1, degree + 1):
        difference = [b - a for a, b in zip(difference, difference[1:])]
        slope = slope + difference[0] * fmpq((-1) ** (order - 1), order)
    down = polys[0].derivative()
    found = []
    for z in places:
        bottom = value(down, z)
        found.append(None if bottom.contains(0) else -value(slope, z) / bottom)
    return found


def check(net, program, tally, rng):
    """Compares the derivatives of frequencies and damping ratios."""
    ctx.prec = BITS
    tally.command = "vibc analyze MODEL --sensitivity --format json"
    answer = program.run("analyze", net.text(), "--sensitivity", "--format", "json")
    told = answer.json()
    if told is None or not told.get("sensitivities"):
        tally.refuse(answer.reason())
        return
    p = decimal(net.parameters["p"].split()[0])

    def stiff(q):
        m, _, k = net.matrices({"p": q})
        return determinant([k, -m], scale(m, k))

    def damped(q):
        m, c, k = net.matrices({"p": q})
        return determinant([k, c, m])

    places = squares(net)
    slopes = derivatives(net, stiff, places)
    row = told["sensitivities"][0]
    for mode in row["frequencies"]:
        square, slope = places[mode["mode"] - 1], slopes[mode["mode"] - 1]
        if slope is None or square == 0:
            if mode["kind"] == "smooth":
                tally.refuse("repeated frequency told as smooth")
            continue
        if mode["kind"] != "smooth":
            tally.refuse("frequency told as " + mode["kind"])
            continue
        true = slope / (4 * pi() * square.sqrt())
        tally.relative("derivative of a frequency", mode["derivative"], mode["error_bound"], true)
        if mode["relative_error_bound"] is not None:
            tally.relative("relative derivative", mode["relative"], mode["relative_error_bound"], slope * p / (2 * square))
    poles = [s for s in true_poles(net) if s.imag >= 0]
    turns = derivatives(net, damped, poles)
    for entry in row["damping"]:
        damping(entry, poles, turns, tally)


def damping(entry, poles, turns, tally):
    """The derivative of a damping ratio; poles count upwards by size, complex ones once."""
    if any(s.imag == 0 for s in poles) or entry.get("derivative") is None:
        tally.refuse("damping told as " + str(entry.get("kind")))
        return
    # Sizes may agree in the first twenty digits: they are compared as enclosures.
    sizes = [abs(s) for s in poles]
    before = [sum(1 for other in sizes if other < size) for size in sizes]
    if entry["motion"] - 1 not in before or before.count(entry["motion"] - 1) > 1:
        tally.refuse("damped motions of one size")
        return
    i = before.index(entry["motion"] - 1)
    s, slope = poles[i], turns[i]
    if slope is None:
        return
    size = abs(s)
    true = -slope.real / size + s.real * (s.real * slope.real + s.imag * slope.imag) / size ** 3
    tally.relative("derivative of a damping ratio", entry["derivative"], entry["error_bound"], true)
