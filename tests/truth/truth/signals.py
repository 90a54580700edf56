"""Signals: their text, and their Laplace transforms as delayed fractions."""

from flint import acb, arb, fmpq, fmpq_mat

from . import draw
from .exact import pi
from .tally import decimal


class Piece:
    """numerator(s) e^(-delay s) / (s^zeros (s^2 + omega^2)), the last factor where omega is given.

    `numerator` holds the coefficients of 1, s, ... as fractions or balls."""

    def __init__(self, delay, numerator, zeros=0, omega=None):
        self.delay, self.numerator, self.zeros, self.omega = delay, numerator, zeros, omega


class Harmonic:
    """a sin(2 pi f t + phase), f in Hz or, exactly, in rad/s."""

    def __init__(self, a, f, phase, unit="Hz"):
        self.a, self.f, self.phase, self.unit = a, f, phase, unit

    def text(self, unit):
        return f"harmonic({self.a} {unit}, {self.f} {self.unit}, {self.phase} deg)"

    def omega(self):
        return decimal(self.f) * 2 * pi() if self.unit == "Hz" else decimal(self.f)

    def amplitude(self):
        """The complex amplitude that the steady state is multiplied with."""
        angle = arb(decimal(self.phase) / 180)
        return acb(angle.cos_pi(), angle.sin_pi()) * decimal(self.a)

    def pieces(self):
        angle = arb(decimal(self.phase) / 180)
        a = decimal(self.a)
        omega = self.omega()
        return [Piece(fmpq(0), [angle.cos_pi() * omega * a, angle.sin_pi() * a], 0, omega)]


class Steps:
    """Steps, ramps, pulses and impulses: polynomials in time from given times on."""

    def __init__(self, word, *numbers):
        self.word, self.numbers = word, numbers

    def text(self, unit):
        a, *times = self.numbers
        unit = f"{unit}*s" if self.word == "impulse" else unit
        return f"{self.word}({a} {unit}, " + ", ".join(f"{t} s" for t in times) + ")"

    def pieces(self):
        a, *times = [decimal(word) for word in self.numbers]
        if self.word == "impulse":
            return [Piece(times[0], [a])]
        if self.word == "step":
            return [Piece(times[0], [a], 1)]
        if self.word == "pulse":
            return [Piece(times[0], [a], 1), Piece(times[1], [-a], 1)]
        slope = a / (times[1] - times[0])
        return [Piece(times[0], [slope], 2), Piece(times[1], [-slope], 2)]


class Table:
    """Rows of a file: lines between them for a force, a natural cubic spline for a base."""

    def __init__(self, rows, spline, name="table.csv"):
        self.rows, self.spline, self.name = rows, spline, name

    def text(self, unit):
        return f'table("{self.name}")'

    def content(self):
        return "time,value\n" + "".join(f"{t},{v}\n" for t, v in self.rows)

    def pieces(self):
        times = [decimal(t) for t, _ in self.rows]
        values = [decimal(v) for _, v in self.rows]
        bends = self.bends(times, values) if self.spline else [fmpq(0)] * len(times)
        found = [Piece(fmpq(0), [values[0]], 1)]
        slope, third = fmpq(0), fmpq(0)
        for i, t in enumerate(times):
            before, before_third = slope, third
            if i + 1 < len(times):
                h = times[i + 1] - t
                third = (bends[i + 1] - bends[i]) / h
                start = (values[i + 1] - values[i]) / h - h * (2 * bends[i] + bends[i + 1]) / 6
                slope = start + h * (bends[i] + bends[i + 1]) / 2
            else:
                start, slope, third = fmpq(0), fmpq(0), fmpq(0)
            if start != before:
                found.append(Piece(t, [start - before], 2))
            if third != before_third:
                found.append(Piece(t, [third - before_third], 4))
        return found

    @staticmethod
    def bends(times, values):
        """Second derivatives of the natural cubic spline at its knots."""
        inner = len(times) - 2
        bends = [fmpq(0)] * len(times)
        if inner < 1:
            return bends
        matrix, right = fmpq_mat(inner, inner), fmpq_mat(inner, 1)
        for i in range(inner):
            left, h = times[i + 1] - times[i], times[i + 2] - times[i + 1]
            matrix[i, i] = (left + h) / 3
            if i > 0:
                matrix[i, i - 1] = left / 6
            if i + 1 < inner:
                matrix[i, i + 1] = h / 6
            right[i, 0] = (values[i + 2] - values[i + 1]) / h - (values[i + 1] - values[i]) / left
        return [fmpq(0)] + matrix.solve(right).entries() + [fmpq(0)]


class Chirp:
    """a sin(2 pi (f0 t + (f1 - f0) t^2 / (2 T))) until T."""

    def __init__(self, a, f0, f1, duration):
        self.a, self.f0, self.f1, self.duration = a, f0, f1, duration

    def text(self, unit):
        return f"chirp({self.a} {unit}, {self.f0} Hz, {self.f1} Hz, {self.duration} s)"

    def value(self, t):
        """The signal at a complex time before its end."""
        f0, f1, last = (decimal(word) for word in (self.f0, self.f1, self.duration))
        return (2 * pi() * (t * f0 + t * t * ((f1 - f0) / (2 * last)))).sin() * decimal(self.a)


def signal(rng, spline, longest, base=False):
    """A signal of any kind; times are below the longest."""
    amount = draw.decimal_word(rng, -2, 2)
    if rng.random() < 0.3:
        amount = "-" + amount
    kind = rng.choice(("harmonic", "harmonic", "radians", "step", "ramp", "pulse", "impulse", "table", "chirp"))
    if base and kind in ("impulse", "chirp"):
        kind = "harmonic"
    times = sorted(rng.sample(range(1, 1000), 2))
    early, late = (time_word(t, longest) for t in times)
    if kind == "harmonic":
        return Harmonic(amount, draw.decimal_word(rng, -2, 2), str(rng.choice((0, 0, 30, 90, 180, 17, -45))))
    if kind == "radians":
        return Harmonic(amount, draw.decimal_word(rng, 0, 1, 2), str(rng.choice((0, 90, 30))), "rad/s")
    if kind == "chirp":
        return Chirp(amount, draw.decimal_word(rng, -1, 1, 2), draw.decimal_word(rng, -1, 1, 2), late)
    if kind == "table":
        knots = sorted(rng.sample(range(0, 1000), rng.randint(2, 8)))
        return Table([(time_word(t, longest), f"{rng.uniform(-1, 1):.3f}") for t in knots], spline)
    if kind in ("step", "impulse"):
        return Steps(kind, amount, rng.choice(("0", early)))
    return Steps(kind, amount, rng.choice(("0", early)), late)


def time_word(thousandths, longest):
    """A share of the longest time, a decimal number."""
    return f"{thousandths}e{longest - 3}"
