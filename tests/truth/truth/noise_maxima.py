"""Peaks of the density of an output under noise that comes again later, and under two noises of different slopes: where the derivative,
a power series of first order in balls, changes its sign between neighbours of a fine grid. Each is compared, and their number; where the
numbers differ the grid is made finer before that counts."""

import math

from flint import arb, arb_poly, arb_series, ctx, fmpq

from . import noise, transfer
from .exact import pi, roots
from .tally import decimal

BITS = 200
# Intervals of the grid for each factor of e, within a time, and about a pole.
FINE = 60


def scene(rng):
    form = rng.choice(("delayed", "delayed", "two"))
    return noise.scene(rng, ("points", "flat", "road") if form == "delayed" else ("white", "points", "points"), form)


def tabulated(rng):
    """Under rows of a file, alone, again later, or beside another noise."""
    form = rng.choice(("one", "one", "delayed", "two"))
    return noise.scene(rng, ("table", "table", "white", "points") if form == "two" else ("table",), form)


class Part:
    """A noise with its paths: zeros over poles and a time each, as real and imaginary parts by powers of omega."""

    def __init__(self, net, i, name):
        inputs = [(name, fmpq(0))] + [(other, decimal(word)) for other, (source, word) in net.delays.items() if source == name]
        self.paths, self.roots = [], []
        for own, time in inputs:
            top, bottom = noise.reduced(*transfer.function(net, i, own))
            if not top.is_zero():
                self.paths.append((split(top), split(bottom), time))
                self.roots += [root for root, _ in roots(bottom, 60)]
        self.derivative = net.noises[name].derivative

    def density(self, x, course):
        """By the angular frequency x, a series."""
        total = (arb_series(0), arb_series(0))
        for (a, b), (c, d), time in self.paths:
            a, b, c, d = (of(poly, x) for poly in (a, b, c, d))
            norm = c * c + d * d
            re, im = (a * c + b * d) / norm, (b * c - a * d) / norm
            turn = x * arb(time)
            cosine, sine = turn.cos(), turn.sin()
            total = (total[0] + re * cosine + im * sine, total[1] + im * cosine - re * sine)
        size = total[0] * total[0] + total[1] * total[1]
        return course(x / (2 * pi())) * size / x ** (2 * self.derivative)


def split(poly):
    """f(i w) as a real and an imaginary polynomial."""
    signs = ((1, 0), (0, 1), (-1, 0), (0, -1))
    coefficients = poly.coeffs()
    return [arb_poly([arb(x * signs[k % 4][part]) for k, x in enumerate(coefficients)]) for part in (0, 1)]


def of(poly, x):
    """By Horner's scheme."""
    total = arb_series(0)
    for a in reversed(poly.coeffs()):
        total = total * x + a
    return total


def peaks(net, i, fine, part=Part):
    """Frequencies and densities; None where there is white noise that comes again."""
    ctx.prec = BITS
    parts = {name: part(net, i, name) for name in net.noises}
    edges = sorted({fmpq(0)} | {edge for own in net.noises.values() for piece in own.pieces or () for edge in piece[:2]})
    found = []
    for low, high in zip(edges, edges[1:] + [None]):
        active = [(parts[name], course) for name, course in courses(net, low, high).items() if parts[name].paths]
        if not active:
            continue
        if high is None and any(len(part.paths) > 1 for part, _ in active):
            return None

        def density(w, order=2):
            x = arb_series([w, 1], prec=order)
            return sum((part.density(x, course) for part, course in active), arb_series(0))

        def slope_at(w):
            return density(w)[1]

        places = grid([part for part, _ in active], low, high, fine)
        signs = [slope_at(arb(w)) for w in places]
        for w, after, one, other in zip(places, places[1:], signs, signs[1:]):
            if one > 0 and other < 0:
                a, b = arb(w), arb(after)
                for _ in range(150):
                    middle = ((a + b) / 2).mid()
                    if slope_at(middle) > 0:
                        a = middle
                    else:
                        b = middle
                root = a.union(b)
                found.append((root / (2 * pi()), density(root)[0]))
    return found


def courses(net, low, high):
    """The densities with power between two frequencies, Hz, by the name of the input."""
    found = {}
    for name, own in net.noises.items():
        if own.white is not None:
            found[name] = lambda f, size=arb(own.white): arb_series([size])
        for piece in own.pieces or ():
            is_zero = piece[3] == noise.LINE and piece[2] == 0 and piece[4] == 0
            if piece[0] <= low and high is not None and high <= piece[1] and not is_zero:
                found[name] = lambda f, course=noise.density(*piece): arb_series(0) + course(f)
    return found


def grid(parts, low, high, fine):
    """Frequencies in rad/s, ascending, in a range in Hz."""
    sizes = [abs(complex(root)) for part in parts for root in part.roots]
    sizes = [size for size in sizes if size > 0] or [1.0]
    to = 2 * math.pi * float(high) if high is not None else 3000 * max(sizes)
    at = 2 * math.pi * float(low) if low else min(min(sizes), to) * 1e-3
    places = {at * (1 + 1e-12), to * (1 - 1e-12)}
    count = int(math.log(to / at) * FINE * fine) + 2
    places |= {at * (to / at) ** (j / count) for j in range(1, count)}
    if not low:
        # Far below all poles a density that rises from 0 Hz on has a peak where a slow motion begins to fall behind.
        least = at * 1e-15
        places |= {at * 10 ** (-j / 4) for j in range(1, 60)}
        at = least
    for root in {root for part in parts for root in map(complex, part.roots)}:
        width = max(abs(root.real), 1e-9 * abs(root))
        places |= {abs(root.imag) + width * math.sinh(6 * j / (FINE * fine)) for j in range(-2 * FINE * fine, 2 * FINE * fine + 1)}
    longest = max(float(time) for part in parts for _, _, time in part.paths)
    if longest:
        count = min(int((to - at) * longest * 8) * fine, 40_000)
        places |= {at + (to - at) * j / count for j in range(1, count)}
    return sorted(w for w in places if at <= w <= to)


def check_all(net, program, tally, rng):
    """Root mean squares and crossings too."""
    noise.check(net, program, tally, rng)
    check(net, program, tally, rng)


def check(net, program, tally, rng):
    """Compares all peaks of every output whose rms is finite."""
    told = program.ask(tally, "analyze", net.text(), "--format", "json", tables=noise.tables(net))
    if told is None:
        return
    for row in told.get("noise") or []:
        compare(net, row, tally)


def compare(net, row, tally, part=Part):
    """The peaks of an output."""
    if row["peaks"] is None:
        tally.refuse(row["peaks_reason"])
        return
    i, told = int(row["output"][1:]), row["peaks"]
    truth = peaks(net, i, 1, part)
    if truth is None or len(truth) != len(told):
        truth = peaks(net, i, 8, part)
    tally.verdict("number of peaks", len(told), None if truth is None else len(truth))
    for own, (frequency, density) in zip(told, truth) if truth is not None and len(told) == len(truth) else ():
        tally.relative("frequency of a peak", own["frequency_hz"], own["frequency_error_bound"], frequency)
        tally.relative("density of a peak", own["density"], own["density_error_bound"], density)
