"""Measures, as `require` tells them: frequency, damping, gain, phase, amplitude, static, peak, rms; and its verdicts."""

import cmath

from flint import acb, arb, ctx, fmpq

from . import draw, motions, signals, transfer
from .exact import I, pi, value
from .modes import squares
from .net import Net
from .poles import true_poles
from .tally import decimal

BITS = 400


def scene(rng):
    """A well-damped net under a force, with one requirement for each measure."""
    net = Net()
    count = rng.choice((1, 1, 2, 2, 3))
    draw.bodies(rng, net, count, 0)
    draw.springs(rng, net, count, 0)
    net.dampers = [(a, b, draw.decimal_word(rng, -1, 1)) for a, b, _ in net.springs]
    net.forces.append(rng.randrange(count))
    transfer.outputs(rng, net, 1)
    net.signals = [signals.Harmonic(draw.decimal_word(rng, 0, 1), draw.decimal_word(rng, -1, 1), str(rng.choice((0, 30, 90))))]
    if rng.random() < 0.5:
        net.signals.append(signals.Steps("step", draw.decimal_word(rng, 0, 1), "1.25"))
    if rng.random() < 0.4:
        net.signals.append(signals.Steps("pulse", draw.decimal_word(rng, 0, 1), "0.5", "1"))
    if rng.random() < 0.3:
        net.signals.append(signals.Harmonic(draw.decimal_word(rng, 0, 1), draw.decimal_word(rng, -1, 1), "0"))
    for i in range(count):
        if rng.random() < 0.4:
            net.initial[i] = (draw.decimal_word(rng, -2, 0), draw.decimal_word(rng, -2, 0))
    net.at = draw.decimal_word(rng, -1, 1)
    net.asked = []
    for measure in ("frequency", "damping", "gain", "phase", "amplitude", "static", "peak", "rms"):
        if rng.random() < (0.35 if measure in ("peak", "rms") else 0.7):
            net.asked.append((measure, rng.choice((0, 0, 2, 6, 15, 17, 25, 29))))
    return net


def unit_of(net, over=""):
    """The unit of the one output, over another one."""
    kind = net.outputs[0][0][1]
    word = {"x": "m", "vx": "m/s", "ax": "m/s^2", "k.force": "N", "c.force": "N", "k.stretch": "m"}[kind]
    return word + over


def truths(net, until):
    """The true value of each measure asked for: the value, its unit, its words in the model."""
    numerator, denominator = transfer.function(net, 0, "F0")
    s = I * 2 * pi() * decimal(net.at)
    found = {}
    response = value(numerator, s) / value(denominator, s)
    per_newton = unit_of(net, "/N")
    found["gain"] = (abs(response), per_newton, f"gain(F0 -> y0, {net.at} Hz)")
    found["phase"] = (arb.atan2(response.imag, response.real), "rad", f"phase(F0 -> y0, {net.at} Hz)")
    found["frequency"] = (squares(net)[0].sqrt(), "rad/s", "frequency(1)")
    first = true_poles(net)
    first.sort(key=lambda p: float(abs(p).mid()))
    if all(p.imag != 0 for p in first):
        found["damping"] = (-first[0].real / abs(first[0]), "", "damping(1)")
    found["amplitude"] = (amplitude(net, numerator, denominator), unit_of(net), "amplitude(y0)")
    lasting = sum((decimal(s.numbers[0]) for s in net.signals if isinstance(s, signals.Steps) and s.word == "step"), fmpq(0))
    zero = fmpq(0)
    if lasting != 0:
        found["static"] = (arb(numerator(zero) / denominator(zero) * lasting), unit_of(net), "static(y0)")
    if until is not None:
        motion = Track(net)
        found["peak"] = (motion.peak(until), unit_of(net), "peak(y0)")
        found["rms"] = (motion.rms(until), unit_of(net), "rms(y0)")
    return found


def amplitude(net, numerator, denominator):
    """The amplitudes of each frequency, added up."""
    total = arb(0)
    for f, a in motions.harmonics(net):
        s = I * 2 * pi() * f
        total += abs(value(numerator, s) / value(denominator, s) * a)
    return total


class Track(motions.Motion):
    """One output between the times at which something happens."""

    def __init__(self, net):
        super().__init__(net, 0)

    def pieces(self, until):
        """(start, length, parts): over each piece the output is the sum of parts c t^k/k! e^(p t) from its start."""
        times = sorted({delay for delay, _ in self.terms if delay < until} | {fmpq(0)}, key=lambda t: float(t.p) / float(t.q))
        for start, end in zip(times, times[1:] + [until]):
            parts = []
            for delay, fractions in self.terms:
                if delay <= start:
                    parts += [moved(p, gs, start - delay) for p, gs in fractions]
            yield start, end - start, parts

    def rms(self, until):
        """The root of the mean square, by the integral of every product of two parts."""
        total = acb(0)
        for _, length, parts in self.pieces(until):
            for p, gs in parts:
                for q, hs in parts:
                    total += overlap(p, gs, q, hs, acb(length))
        return (total.real / until).sqrt()

    def peak(self, until):
        """The largest size: a fine grid in binary64, its best places made sharp by golden sections in balls."""
        best = arb(0)
        for start, length, parts in self.pieces(until):
            for low, high in self.tops(parts, float(length.p) / float(length.q)):
                best = best.max(sharp(parts, low, high, length))
        return best

    @staticmethod
    def tops(parts, length):
        """Brackets of the highest places of a piece, on a grid of 60 points in the quickest turn."""
        rough = [(complex(p), [complex(g) for g in gs]) for p, gs in parts]
        fastest = max(abs(p.imag) + abs(p.real) for p, _ in rough)
        count = min(int(length * fastest * 10) + 60, 40000)
        grid = [length * i / count for i in range(count + 1)]
        heights = [abs(simple(rough, t)) for t in grid]
        most = max(heights)
        found = [(0.0, 0.0), (length, length)]
        for i in range(1, count):
            if heights[i] >= heights[i - 1] and heights[i] >= heights[i + 1] and heights[i] > 0.99 * most:
                found.append((grid[i - 1], grid[i + 1]))
        if count > 1:
            found += [(grid[0], grid[1]), (grid[-2], grid[-1])]
        return found


def simple(parts, t):
    """A sum of parts in binary64."""
    total = 0.0
    for p, gs in parts:
        polynomial = 0.0
        for k in range(len(gs) - 1, -1, -1):
            polynomial = polynomial * t / (k + 1) + gs[k]
        total += (polynomial * cmath.exp(p * t)).real
    return total


def sharp(parts, low, high, length):
    """The largest size in a bracket that has one top."""
    a, b = arb(low), arb(high)
    last = arb(length)
    a, b = (a if a < last else last), (b if b < last else last)

    def height(t):
        return abs(motions.evaluated_complex(parts, acb(t)).real).mid()

    if not a < b:
        return height(a)
    share = (arb(5).sqrt() - 1) / 2
    c, d = (b - share * (b - a)).mid(), (a + share * (b - a)).mid()
    at_c, at_d = height(c), height(d)
    for _ in range(90):
        if at_c > at_d:
            b, d, at_d = d, c, at_c
            c = (b - share * (b - a)).mid()
            at_c = height(c)
        else:
            a, c, at_c = c, d, at_d
            d = (a + share * (b - a)).mid()
            at_d = height(d)
    return at_c.max(at_d).max(height(a)).max(height(b))


def moved(p, gs, by):
    """The part as it goes on after some time: t becomes t + by."""
    if by == 0:
        return p, gs
    factor = (p * by).exp()
    result = []
    for k in range(len(gs)):
        total = acb(0)
        power = acb(1)
        for j in range(k, len(gs)):
            total += gs[j] * power
            power = power * by / (j - k + 1)
        result.append(total * factor)
    return p, result


def overlap(p, gs, q, hs, length):
    """The integral of the product of two parts from 0 to the length."""
    total = acb(0)
    factorials = [arb(1)]
    for k in range(1, len(gs) + len(hs) + 1):
        factorials.append(factorials[-1] * k)
    whole = powers(p + q, length, len(gs) + len(hs))
    for j, g in enumerate(gs):
        for k, h in enumerate(hs):
            total += g * h * whole[j + k] / (factorials[j] * factorials[k])
    return total


def powers(a, length, count):
    """The integrals of t^n e^(a t) from 0 to the length, n below count."""
    if a.contains(0):
        # For a pole and its mirror image, both on the axis, or for a zero pole with itself, the sum is zero.
        return [length ** (n + 1) / (n + 1) for n in range(count)]
    e = (a * length).exp()
    found = [(e - 1) / a]
    for n in range(1, count):
        found.append((length ** n * e - n * found[-1]) / a)
    return found


def check(net, program, tally, rng):
    """Compares values and verdicts of the requirements; limits lie near the true values, on either side."""
    ctx.prec = BITS
    known = truths(net, None)
    lines, plan = [], []
    for measure, digits in net.asked:
        if measure in ("peak", "rms"):
            lines.append(f"require {measure}(y0) < 1e9 {unit_of(net)}")
            plan.append((measure, None))
        elif measure in known:
            true, unit, words = known[measure]
            limit = near(true, digits, rng)
            sign = rng.choice(("<", ">"))
            lines.append(f"require {words} {sign} {limit} {unit}".rstrip())
            plan.append((measure, (sign, decimal(limit))))
    net.lines = lines
    told = program.ask(tally, "analyze", net.text(), "--format", "json")
    if told is None:
        return
    until = next((row["until_s"] for row in told["requirements"] if row["until_s"] is not None), None)
    if until is not None:
        if until > 400:
            until = None
        else:
            known = truths(net, decimal(repr(until)))
    for (measure, limit), row in zip(plan, told["requirements"]):
        if measure in known:
            compare(measure, limit, row, known[measure][0], tally)


def near(true, digits, rng):
    """A limit: the true value with so many digits, the last one moved a little; or one far from it."""
    if digits == 0 or true == 0:
        return draw.decimal_word(rng, -2, 2)
    word = transfer.plain(true.mid().str(digits + 1, radius=False))
    return word


def compare(measure, limit, row, true, tally):
    """A row of the requirements."""
    tally.relative(measure, row["value"], row["error_bound"], true / (2 * pi()) if measure == "frequency" else true)
    if limit is None:
        return
    sign, border = limit
    if row["holds"] is None:
        tally.refuse("undetermined requirement")
        return
    difference = true - border
    if difference > 0:
        tally.verdict("verdict", row["holds"], sign == ">")
    elif difference < 0:
        tally.verdict("verdict", row["holds"], sign == "<")
