"""Peaks of the density of an output under noise: the real roots of the derivative's numerator, a polynomial in omega, in each range in
which every density keeps its course. Each is compared, and their number."""

from flint import acb_poly, arb, arb_poly, ctx, fmpq, fmpq_poly

from . import noise, transfer
from .exact import pi, roots

BITS = 400
X = fmpq_poly([0, 1])


def scene(rng):
    """White noise, flat bands, corner points of any slope; one noise or two."""
    return noise.scene(rng, rng.choice((("white",), ("flat",), ("points",))), rng.choice(("one", "one", "two")))


def square(poly):
    """|f(i w)|^2 by powers of w."""
    mirrored = fmpq_poly([x * (-1) ** i for i, x in enumerate(poly.coeffs())])
    return fmpq_poly([x * (-1) ** (i // 2) for i, x in enumerate((poly * mirrored).coeffs())])


def courses(net, low, high):
    """For each noise with power between two frequencies, Hz: size and slope of size f^slope."""
    found = {}
    for name, own in net.noises.items():
        if own.white is not None:
            found[name] = (arb(own.white), own.white, 0)
        for f, t, size, slope, last in own.pieces or ():
            if f <= low and high is not None and high <= t:
                if slope is None:
                    slope = (arb(last) / arb(size)).log() / (arb(t) / arb(f)).log()
                    whole = slope.unique_fmpz()
                    exact = size / f ** int(whole) if whole is not None and last * f ** int(whole) == size * t ** int(whole) else None
                    slope = int(whole) if exact is not None else slope
                    found[name] = (arb(size) / (arb(f) ** arb(slope)), exact, slope)
                else:
                    found[name] = (arb(size) / arb(f) ** arb(slope) if f else arb(size), size / f ** int(slope) if f else size, int(slope))
    return found


def peaks(net, i):
    """Frequencies and densities; None where they are not computed."""
    ctx.prec = BITS
    edges = sorted({fmpq(0)} | {edge for own in net.noises.values() for piece in own.pieces or () for edge in piece[:2]})
    found = []
    for low, high in zip(edges, edges[1:] + [None]):
        active = {}
        for name, course in courses(net, low, high).items():
            top, bottom = noise.reduced(*transfer.function(net, i, name))
            if not top.is_zero():
                active[name] = (*course, square(top), square(bottom), net.noises[name].derivative)
        if not active:
            continue
        if len(active) > 1 and (any(part[1] is None for part in active.values()) or len({part[2] for part in active.values()}) > 1):
            return None
        above, below = fmpq_poly([0]), fmpq_poly([1])
        for _, exact, _, top, bottom, derivative in active.values():
            bottom = bottom * X ** (2 * derivative)
            above, below = above * bottom + below * top * (1 if len(active) == 1 else exact), below * bottom
        above, below = noise.reduced(above, below)
        slope = next(iter(active.values()))[2]
        rest = X * (above.derivative() * below - above * below.derivative())
        sign, places = signs(above * below, slope, rest)
        if places is None:
            return None
        for root in places:
            if not root.imag.contains(0) or not root.real > 0:
                continue
            w = refined(sign, root.real)
            f = w / (2 * pi())
            step = arb(2) ** -60 * w
            if not (f > arb(low) and (high is None or f < arb(high))):
                continue
            if sign(w - step) > 0 and sign(w + step) < 0:
                value = sum(size * f ** slope * arb_poly(top)(w) / arb_poly(bottom)(w) / w ** (2 * d) for size, _, slope, top, bottom, d in active.values())
                found.append((f, value))
    return sorted(found, key=lambda pair: float(pair[0].mid()))


def signs(product, slope, rest):
    """slope product + rest, a polynomial with the sign of the derivative, and its roots; None where they are not found."""
    if isinstance(slope, int):
        whole = product * slope + rest
        return arb_poly(whole), [root for root, _ in roots(whole)] if not whole.is_zero() else []
    whole = arb_poly(product) * slope + arb_poly(rest)
    try:
        return whole, acb_poly(whole).roots()
    except ValueError:
        return whole, None


def refined(sign, near):
    """A simple real root to the working precision, by bisection of its enclosure."""
    if near.rel_accuracy_bits() > 250:
        return near
    low, high = near.mid() - 2 * near.rad(), near.mid() + 2 * near.rad()
    rising = sign(high) > 0
    for _ in range(250):
        middle = ((low + high) / 2).mid()
        if (sign(middle) > 0) == rising:
            high = middle
        else:
            low = middle
    return low.union(high)


def check(net, program, tally, rng):
    """Compares all peaks of every output whose rms is finite."""
    told = program.ask(tally, "analyze", net.text(), "--format", "json")
    if told is None:
        return
    for row in told.get("noise") or []:
        i = int(row["output"][1:])
        if row["peaks"] is None:
            tally.refuse(row["peaks_reason"])
            continue
        truth = peaks(net, i)
        if truth is None:
            continue
        tally.verdict("number of peaks", len(row["peaks"]), len(truth))
        for own, (frequency, density) in zip(row["peaks"], truth) if len(row["peaks"]) == len(truth) else ():
            tally.relative("frequency of a peak", own["frequency_hz"], own["frequency_error_bound"], frequency)
            tally.relative("density of a peak", own["density"], own["density_error_bound"], density)
