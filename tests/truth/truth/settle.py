"""Settling time and overshoot: the last crossing of a band about the final value, and the farthest place beyond it."""

from flint import acb, arb, ctx

from . import draw, motions, signals, transfer
from .measures import Track, simple
from .net import Net
from .tally import decimal

BITS = 400
# Points of the grid on which the course is looked at, and points in the quickest turn.
MOST_POINTS = 60000
DENSE = 24
# What rounding adds to a sum of binary64 terms, as a part of them, with room; and the most maxima that may be the largest.
NOISE = 1e-13
MOST_TOPS = 200


def scene(rng):
    """A damped net under a force that lasts, with other signals that end, and an initial state."""
    net = Net()
    count = rng.choice((1, 1, 2, 2, 3))
    draw.bodies(rng, net, count, 0)
    draw.springs(rng, net, count, 0)
    net.dampers = [(a, b, draw.decimal_word(rng, -1, 1)) for a, b, _ in net.springs]
    net.forces.append(rng.randrange(count))
    transfer.outputs(rng, net, 1)
    sign = rng.choice(("", "-"))
    net.signals = [signals.Steps("step", sign + draw.decimal_word(rng, 0, 1), rng.choice(("0", "1.25")))]
    if rng.random() < 0.4:
        net.signals.append(signals.Steps("pulse", draw.decimal_word(rng, 0, 1), "0.5", "1"))
    if rng.random() < 0.3:
        net.signals.append(signals.Steps("ramp", draw.decimal_word(rng, 0, 1), "0.25", "2"))
    for i in range(count):
        if rng.random() < 0.3:
            net.initial[i] = (draw.decimal_word(rng, -2, 0), draw.decimal_word(rng, -2, 0))
    net.band = rng.choice(("2", "5", "0.1", "1e-6", "37", "0.01"))
    net.lines = [f"require settling(y0, {net.band} %) < 1e9 s", "require overshoot(y0) < 1e9"]
    return net


def check(net, program, tally, rng):
    """Compares both measures; where there is no final value the program has to say so."""
    ctx.prec = BITS
    told = program.ask(tally, "analyze", net.text(), "--format", "json")
    if told is None:
        return
    numerator, denominator = transfer.function(net, 0, "F0")
    lasting = sum(decimal(s.numbers[0]) for s in net.signals if s.word in ("step", "ramp"))
    end = arb(numerator(0) / denominator(0) * lasting)
    rows = told["requirements"]
    if end == 0:
        for row in rows:
            tally.verdict("no final value", row["value"], None)
        return
    course = Course(net, end)
    if course.grid is None:
        tally.refuse("too long for the oracle")
        return
    settling = course.settling(abs(end) * decimal(net.band) / 100)
    if settling is not None:
        tally.absolute("settling", rows[0]["value"], rows[0]["error_bound"] and rows[0]["error_bound"] * float(settling.mid()), settling)
    beyond = course.beyond()
    if beyond is None:
        tally.refuse("overshoot too small for the oracle")
        return
    beyond = beyond / abs(end)
    tally.absolute("overshoot", rows[1]["value"], overshoot_bound(rows[1], beyond), beyond, unit=arb(1))


def overshoot_bound(row, truth):
    """Bounds are relative to the value, and absolute where it may be zero."""
    bound = row["error_bound"]
    return bound if bound is None or truth == 0 else bound * float(truth.mid())


class Course:
    """output - end, piece by piece, until it has decayed."""

    def __init__(self, net, end):
        track = Track(net)
        self.sign = 1 if end > 0 else -1
        poles = [p for p, _ in track.poles]
        slowest = min(float(-p.real.mid()) for p in poles)
        fastest = max(float(abs(p).mid()) for p in poles)
        last = max(float(delay.p) / float(delay.q) for delay, _ in track.terms)
        until = last + 50 / slowest
        self.grid = None
        if slowest <= 0 or (until * fastest / 6) * DENSE > MOST_POINTS:
            return
        whole = decimal(repr(round(until, 3) + 1.0))
        self.grid = []
        for start, length, parts in track.pieces(whole):
            parts = parts + [(acb(0), [acb(-end)])]
            size = float(length.p) / float(length.q)
            count = max(int(size * fastest / 6 * DENSE), 50)
            self.grid.append((start, size, parts, count))

    def settling(self, level):
        """The last time at which |output - end| is the level, by bisection in balls; None where it is not clear."""
        rough_level = float(level.mid())
        for start, size, parts, count in reversed(self.grid):
            rough = [(complex(p), [complex(g) for g in gs]) for p, gs in parts]
            times = [size * i / count for i in range(count + 1)]
            sizes = [abs(simple(rough, t)) for t in times]
            noise = NOISE * magnitude(rough, size)
            for i in range(count, -1, -1):
                top = 0 < i < count and sizes[i] >= sizes[i - 1] and sizes[i] >= sizes[i + 1]
                if top and 0.98 * rough_level < sizes[i] < rough_level:
                    return None
                is_above = sizes[i] >= rough_level
                if abs(sizes[i] - rough_level) <= noise:
                    is_above = abs(motions.evaluated_complex(parts, acb(times[i])).real) >= level
                if is_above:
                    if i == count:
                        return arb(start) + arb(size)
                    return arb(start) + bisected(parts, times[i], times[i + 1], level)
        return arb(0)

    def beyond(self):
        """The largest sign (output - end), or zero; None where binary64 does not tell where to look."""
        best = arb(0)
        for _, size, parts, count in self.grid:
            rough = [(complex(p), [complex(g) for g in gs]) for p, gs in parts]
            times = [size * i / count for i in range(count + 1)]
            heights = [self.sign * simple(rough, t) for t in times]
            most, noise = max(heights), NOISE * magnitude(rough, size)
            tops = [i for i, height in enumerate(heights) if height >= max(0.99 * most, -most) - 2 * noise]
            if len(tops) > MOST_TOPS:
                return None
            for i in tops:
                low, high = times[max(i - 1, 0)], times[min(i + 1, count)]
                best = best.max(self.top(parts, low, high))
        return best

    def top(self, parts, low, high):
        """The largest signed height in a bracket, by golden sections and the ends."""

        def height(t):
            return (self.sign * motions.evaluated_complex(parts, acb(t)).real).mid()

        a, b = arb(low), arb(high)
        ends = height(a).max(height(b))
        share = (arb(5).sqrt() - 1) / 2
        c, d = (b - share * (b - a)).mid(), (a + share * (b - a)).mid()
        at_c, at_d = height(c), height(d)
        for _ in range(120):
            if at_c > at_d:
                b, d, at_d = d, c, at_c
                c = (b - share * (b - a)).mid()
                at_c = height(c)
            else:
                a, c, at_c = c, d, at_d
                d = (a + share * (b - a)).mid()
                at_d = height(d)
        return ends.max(at_c).max(at_d)


def magnitude(rough, size):
    """The most that the terms of a piece are together, whatever their signs."""
    return sum(abs(g) * max(size, 1.0) ** k for p, gs in rough for k, g in enumerate(gs))


def bisected(parts, low, high, level):
    """The crossing between a place at or above the level and one below."""
    a, b = arb(low), arb(high)
    for _ in range(160):
        middle = ((a + b) / 2).mid()
        if abs(motions.evaluated_complex(parts, acb(middle)).real) >= level:
            a = middle
        else:
            b = middle
    return (a + b) / 2
