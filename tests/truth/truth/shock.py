"""Shock response spectra: tables of accelerations and velocities of a base, any damping; the largest values of the exact motion by interval
bisection."""

from flint import acb, arb, ctx

from . import draw
from .exact import pi
from .tally import decimal

BITS = 160
# The search ends where the largest value is known to this, relative to the size of the motion.
KNOWN = arb(2) ** -66


class Record:
    """Rows of a table, a damping ratio and frequencies, as decimal words."""

    def __init__(self, times, values, derivative, damping, frequencies):
        self.times, self.values, self.derivative = times, values, derivative
        self.damping, self.frequencies = damping, frequencies

    def text(self):
        unit = "m/s" if self.derivative == 1 else "m/s^2"
        return (f'base g {{ moves x }} = table("t.csv", 1 {unit})\nbody b {{ mass = 1 kg, moves x }}\n'
                "spring s: g -- b { k = 1 N/m }\n")

    def tables(self):
        return {"t.csv": "".join(f"{t},{a}\n" for t, a in zip(self.times, self.values))}

    def smaller(self):
        for i in range(1, len(self.times)):
            if len(self.times) > 2:
                yield Record(self.times[:i] + self.times[i + 1:], self.values[:i] + self.values[i + 1:], self.derivative, self.damping,
                             self.frequencies)
        if len(self.frequencies) > 1:
            for f in self.frequencies:
                yield Record(self.times, self.values, self.derivative, self.damping, [f])


def scene(rng):
    count = rng.choice((2, 3, 5, 9, 14))
    even = rng.random() < 0.5
    length = 10 ** rng.uniform(-3, 1)
    times, t = ["0"], 0.0
    for i in range(1, count):
        t += length if even else length * 10 ** rng.uniform(-2, 0.5)
        word = f"{i * length:.6e}" if even else f"{t:.7e}"
        times.append(word)
    values = [("-" if rng.random() < 0.5 else "") + draw.decimal_word(rng, -1, 1, rng.choice((1, 3, 6))) for _ in range(count)]
    if rng.random() < 0.5:
        values[0] = "0"
    damping = rng.choice(("0", "1e-6", "0.01", "0.05", "0.3", "0.5", "0.7", "0.999999", "1", "1.000001", "1.7", "12"))
    frequencies = sorted({f"{10 ** rng.uniform(-1.3, 1.3) / length:.3e}" for _ in range(rng.choice((1, 3, 9)))}, key=float)
    return Record(times, values, rng.choice((1, 2, 2, 2)), damping, frequencies)


class Motion:
    """y(t) = rest + rate t + sum of exponentials (or (c1 + c2 t) e^(s t)) from a state under a + slope t."""

    def __init__(self, y, v, a, slope, w, z):
        self.w, self.z = w, z
        self.rate = slope / w ** 2
        self.rest = a / w ** 2 - 2 * z * slope / w ** 3
        y, v = y - self.rest, v - self.rate
        gap = z * z - 1
        self.critical = gap.is_zero()
        if self.critical:
            self.s, self.c = [acb(-w)], [acb(y), acb(v + w * y)]
            return
        root = acb(gap).sqrt() * w
        self.s = [acb(-z * w) + root, acb(-z * w) - root]
        self.c = [(v - self.s[1] * y) / (self.s[0] - self.s[1]), (self.s[0] * y - v) / (self.s[0] - self.s[1])]

    def at(self, t):
        if self.critical:
            e = (self.s[0] * t).exp()
            c, d, s = self.c[0], self.c[1], self.s[0]
            return self.rest + self.rate * t + ((c + d * t) * e).real, self.rate + ((d + s * (c + d * t)) * e).real
        e = [c * (s * t).exp() for c, s in zip(self.c, self.s)]
        return self.rest + self.rate * t + sum(x.real for x in e), self.rate + sum((x * s).real for x, s in zip(e, self.s))


def largest(motion, length, sign, low, size, force):
    """The largest of `low` and sign * y on (0, length), to KNOWN * size. From a time on y is at most y + v h + b h^2 / 2, and b is
    bounded by the energy, which grows by `force`, the largest acceleration, alone."""
    w, z = motion.w, motion.z
    parts = [(arb(0), length)]
    while parts:
        kept = []
        for start, width in parts:
            y, v = motion.at(start)
            y, v = sign * y, sign * v
            low = low.max(y)
            energy = w * abs(y) + abs(v) + width * force
            high = y + v.max(arb(0)) * width + width ** 2 / 2 * (force + (1 + 2 * z) * w * energy)
            if not high <= low + KNOWN * size:
                kept += [(start, width / 2), (start + width / 2, width / 2)]
        parts = kept
        if len(parts) > 4000 or (parts and parts[0][1] < length * arb(2) ** -80):
            raise ValueError("not found")
    return low


def truth(record, hertz):
    """omega^2 y: primary and residual, positive and negative."""
    w, z = 2 * pi() * arb(decimal(hertz)), arb(decimal(record.damping))
    times = [arb(decimal(t)) for t in record.times]
    values = [arb(decimal(a)) for a in record.values]
    y, v = arb(0), arb(0)
    found, sizes = [arb(0), arb(0)], []
    if record.derivative == 1:
        # The velocity begins with its first value.
        v = values[0]
    for t, u, a, b in zip(times, times[1:], values, values[1:]):
        h = u - t
        slope = (b - a) / h
        motion = Motion(y, v, a, slope, w, z) if record.derivative == 2 else Motion(y, v, slope, arb(0), w, z)
        size = abs(y) + abs(v) / w + (abs(a) + abs(b)) / w ** 2 if record.derivative == 2 else abs(y) + (abs(v) + abs(a) + abs(b)) / w
        sizes.append(size)
        force = abs(a).max(abs(b)) if record.derivative == 2 else abs(slope)
        found = [largest(motion, h, sign, low, size, force) for sign, low in zip((1, -1), found)]
        y, v = motion.at(h)
        found = [low.max(sign * y) for sign, low in zip((1, -1), found)]
    if record.derivative == 1:
        v = v - values[-1]
    motion = Motion(y, v, arb(0), arb(0), w, z)
    if z < 1:
        # Both first extrema lie within a period.
        length = 2 * pi() / (w * (1 - z * z).sqrt())
    else:
        slow = w / (z + (z * z - 1).sqrt()) if z > 1 else w
        length = 60 / slow
    size = abs(y) + abs(v) / w
    after = [largest(motion, length, sign, arb(0).max(sign * y), size, arb(0)) for sign in (1, -1)]
    off = KNOWN * max(sizes + [size], key=float)
    return [(x * w * w).union((x + off) * w * w) for x in found + after]


def check(record, program, tally, rng):
    ctx.prec = BITS
    asked = [option for f in record.frequencies for option in ("--at", f"{f}Hz")]
    told = program.ask(tally, "shock", record.text(), "--damping", record.damping, "--format", "json", *asked, tables=record.tables())
    if told is None:
        return
    spectrum = told["spectra"][0]
    for i, hertz in enumerate(record.frequencies):
        try:
            true = truth(record, hertz)
        except ValueError:
            tally.refuse("the oracle finds no maximum")
            continue
        size = true[0].max(true[1]).max(true[2]).max(true[3])
        names = ("primary_positive", "primary_negative", "residual_positive", "residual_negative")
        for name, value in zip(names, true):
            told, bound = spectrum[name][i], spectrum[f"{name}_error_bounds"][i]
            if value.lower() <= 0:
                # The motion does not reach this side, by more than the oracle knows.
                tally.verdict(name, told <= bound + float(value.upper()), True)
            else:
                tally.absolute(name, told, bound, value, size)
        tally.absolute("maximax", spectrum["maximax"][i], spectrum["maximax_error_bounds"][i], size, size)
