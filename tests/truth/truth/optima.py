"""Optima: the absorber of Nishihara and Asami for the lowest peak, and gains at one frequency over a stiffness, whose derivative is
a polynomial with known roots."""

from flint import acb, arb, ctx, fmpq

from . import draw
from .exact import pi
from .loaded import Text
from .tally import decimal

BITS = 300


def scene(rng):
    return absorber(rng) if rng.random() < 0.5 else one_parameter(rng)


def absorber(rng):
    """An absorber on an undamped mass, with ranges around the optimum."""
    mass, stiffness = draw.decimal_word(rng, -1, 2), draw.decimal_word(rng, 1, 4)
    mu = rng.choice(("0.05", "0.1", "0.2", "0.25", "0.5", "1"))
    k, c, _ = optimum(decimal(mass), decimal(stiffness), decimal(mu))
    ends = lambda x: [f"{float(x.mid()) * part:.3g}" for part in (rng.uniform(0.6, 0.9), rng.uniform(1.15, 1.6))]
    (c0, c1), (k0, k1) = ends(c), ends(k)
    text = (f"param M = {mass} kg\nparam K = {stiffness} N/m\nparam k = {k0} N/m\nparam c = {c0} N*s/m\nbody m {{ mass = M, moves x }}\n"
            f"body a {{ mass = {mu} * M, moves x }}\nspring s: ground -- m {{ k = K }}\nspring l: m -- a {{ k = k }}\n"
            f"damper o: m -- a {{ c = c }}\nforce F: m along x\noutput x = m.x\n"
            f"minimise peak_gain(F -> x) over c in {c0} N*s/m .. {c1} N*s/m, k in {k0} N/m .. {k1} N/m\n")
    return Text(text, mass=mass, stiffness=stiffness, mu=mu, form="absorber")


def optimum(mass, stiffness, mu):
    """k, c and the peak, as balls: O. Nishihara, T. Asami, J. Vib. Acoust. 124 (2002) 576."""
    mu, r = arb(mu), arb(4 + 3 * mu).sqrt()
    tuning = 2 / (1 + mu) * (2 * (16 + 23 * mu + 9 * mu ** 2 + 2 * (2 + mu) * r) / (3 * (64 + 80 * mu + 27 * mu ** 2))).sqrt()
    zeta = ((8 + 9 * mu - 4 * r) / (1 + mu)).sqrt() / 4
    natural = (arb(stiffness) / arb(mass)).sqrt()
    own = mu * arb(mass)
    k, c = own * (natural * tuning) ** 2, 2 * zeta * own * natural * tuning
    return k, c, height(arb(mass), arb(stiffness), own, k, c)


def height(mass, stiffness, own, k, c):
    """The largest |H| at given k and c."""
    def square(x):
        # |k + i c w - m w^2|^2 over |(K + k - M w^2)(k - m w^2) - k^2 + ...|^2, x = w^2
        top = (k - own * x) ** 2 + c * c * x
        re = (stiffness - mass * x) * (k - own * x) - own * k * x
        im = stiffness - mass * x - own * x
        return top / (re * re + c * c * x * im * im)

    natural = float((stiffness / mass).mid())
    # A scan, then golden sections in numbers of 300 bits: the value at the top is flat, so it has twice the digits of the place.
    best = max((natural * (0.2 + 0.004 * i) for i in range(400)), key=lambda x: float(square(arb(x)).mid()))
    low, high, part = arb(best * 0.98), arb(best * 1.02), (arb(5).sqrt() - 1) / 2
    for _ in range(260):
        a, b = (high - (high - low) * part).mid(), (low + (high - low) * part).mid()
        if square(a).mid() > square(b).mid():
            high = b
        else:
            low = a
    return square(((low + high) / 2).mid()).sqrt()


def one_parameter(rng):
    """A mass on the ground and one beside it: the gain at one frequency over the spring between them."""
    words = [draw.decimal_word(rng, -1, 1) for _ in range(2)] + [draw.decimal_word(rng, 1, 3), draw.decimal_word(rng, -1, 1),
                                                                 draw.decimal_word(rng, -1, 1)]
    at = draw.decimal_word(rng, -1, 1)
    low = draw.decimal_word(rng, 0, 2)
    high = f"{float(low) * rng.choice((1.5, 4, 15)):.4g}"
    most = rng.random() < 0.4
    m, n, k, c, d = words
    text = (f"param q = {low} N/m\nbody a {{ mass = {m} kg, moves x }}\nbody b {{ mass = {n} kg, moves x }}\n"
            f"spring s: ground -- a {{ k = {k} N/m }}\nspring t: a -- b {{ k = q }}\ndamper e: ground -- a {{ c = {c} N*s/m }}\n"
            f"damper f: a -- b {{ c = {d} N*s/m }}\nforce F: a along x\noutput x = a.x\n"
            f"{'maximise' if most else 'minimise'} gain(F -> x, {at} Hz) over q in {low} N/m .. {high} N/m\n")
    return Text(text, words=words, at=at, low=low, high=high, most=most, form="one")


def extreme(scene):
    """The best place and value of a gain over a stiffness q: |a + b q|^2 / |c + d q|^2, whose derivative is a quadratic."""
    m, n, k, c, d = (acb(decimal(word)) for word in scene.words)
    w = 2 * pi() * decimal(scene.at)
    s = acb(0, 1) * w
    # x = (q + d s + n s^2) / ((m s^2 + (c + d) s + k + q)(n s^2 + d s + q) - (d s + q)^2)
    top = (d * s + n * s * s, acb(1))
    own, link, other = m * s * s + (c + d) * s + k, d * s, n * s * s + d * s
    bottom = (own * other - link * link, own + other - 2 * link)

    def square(pair):
        """|a + b q|^2 as coefficients of 1, q, q^2."""
        a, b = pair
        return (a * a.conjugate()).real, 2 * (a * b.conjugate()).real, (b * b.conjugate()).real

    t, u = square(top), square(bottom)
    value = lambda q: ((t[0] + t[1] * q + t[2] * q * q) / (u[0] + u[1] * q + u[2] * q * q)).sqrt()
    x, y, z = t[1] * u[0] - t[0] * u[1], 2 * (t[2] * u[0] - t[0] * u[2]), t[2] * u[1] - t[1] * u[2]
    root = y * y - 4 * x * z
    low, high = arb(decimal(scene.low)), arb(decimal(scene.high))
    places = [low, high]
    if root > 0:
        places += [q for q in ((-y + root.sqrt()) / (2 * z), (-y - root.sqrt()) / (2 * z)) if q > low and q < high]
    values = [value(q) for q in places]
    best = max(values, key=lambda v: float(v.mid())) if scene.most else min(values, key=lambda v: float(v.mid()))
    return places[values.index(best)], best


def check(scene, program, tally, rng):
    """Compares the value, the parameters, and what is claimed to be proved."""
    ctx.prec = BITS
    told = program.ask(tally, "analyze", scene.text(), "--format", "json")
    if told is None:
        return
    row = told["optimised"][0]
    found = {p["parameter"]: p for p in row["parameters"]}
    if scene.form == "absorber":
        k, c, peak = optimum(decimal(scene.mass), decimal(scene.stiffness), decimal(scene.mu))
        truths = {"k": k, "c": c}
    else:
        place, peak = extreme(scene)
        truths = {"q": place}
    sign = -1 if scene.form == "one" and scene.most else 1
    # No value is better than the best, and what is proved is as good but for the gap.
    better = (peak - arb(row["value"])) * sign
    allowed = arb(row["value"]) * (arb(row["error_bound"]) + arb(2) ** -52)
    tally.comparisons += 1
    if better > allowed:
        tally.violate("better than the best", row["value"], peak.str(30, radius=False), row["error_bound"])
    if row["proved"] == "everywhere":
        tally.comparisons += 1
        if -better > arb(row["gap"]) + allowed:
            tally.violate("gap", row["value"], peak.str(30, radius=False), row["gap"])
    else:
        tally.refuse(f"proved: {row['proved']}")
    for name, truth in truths.items():
        if found[name]["error_bound"] is None:
            tally.without_bound += 1
        else:
            tally.absolute("parameter", found[name]["si"], found[name]["error_bound"] + 2.0 ** -52 * abs(found[name]["si"]), truth)
