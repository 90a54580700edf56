"""Tables that come again: lines for a force, the closed cubic spline for a base; motions in time."""

from flint import fmpq, fmpq_mat

from . import draw, motions, signals, transfer
from .tally import decimal


class Periodic:
    """Rows of one period, which begin anywhere; the last one may have the time at which the first one comes again."""

    def __init__(self, rows, period, spline, until, name="table.csv"):
        self.rows, self.period, self.spline, self.until, self.name = rows, period, spline, until, name

    def text(self, unit):
        return f'periodic(table("{self.name}"), {self.period} s)'

    def content(self):
        return "time,value\n" + "".join(f"{t},{v}\n" for t, v in self.rows)

    def pieces(self):
        times = [decimal(t) for t, _ in self.rows]
        values = [decimal(v) for _, v in self.rows]
        period, until = decimal(self.period), decimal(self.until)
        if times[-1] - times[0] < period:
            times, values = times + [times[0] + period], values + [values[0]]
        spans = list(zip(times, times[1:], values, values[1:]))
        bends = self.bends(spans) if self.spline else [fmpq(0)] * len(times)
        # u, u', u'', u''' at the beginning of each span.
        starts = []
        for i, (begin, end, left, right) in enumerate(spans):
            h = end - begin
            slope = (right - left) / h - h * (2 * bends[i] + bends[i + 1]) / 6
            starts.append((begin, [left, slope, bends[i], (bends[i + 1] - bends[i]) / h]))
        first = (-times[0] / period).floor() - 1
        last = ((until - times[0]) / period).ceil() + 1
        every = [(begin + k * period, start) for k in range(int(first), int(last) + 1) for begin, start in starts]
        begin, start = [(begin, start) for begin, start in every if begin <= 0][-1]
        coming = [(fmpq(0), moved(start, -begin))] + [(begin, start) for begin, start in every if 0 < begin <= until]
        found, now, at = [], [fmpq(0)] * 4, fmpq(0)
        for begin, start in coming:
            for power, (a, b) in enumerate(zip(moved(now, begin - at), start)):
                if a != b:
                    found.append(signals.Piece(begin, [b - a], power + 1))
            at, now = begin, start
        return found

    @staticmethod
    def bends(spans):
        """Second derivatives by a full matrix: the slopes from both sides of each row are the same, also around the circle."""
        n = len(spans)
        matrix, right = fmpq_mat(n, n), fmpq_mat(n, 1)
        for i, (begin, end, left, value) in enumerate(spans):
            h = end - begin
            j = (i + 1) % n
            # The slope at the beginning is the chord's less h (2 b_i + b_j) / 6, at the end it is more by h (b_i + 2 b_j) / 6.
            for a, b, factor in ((i, i, 3), (i, j, 6), (j, i, 6), (j, j, 3)):
                matrix[a, b] = matrix[a, b] + h / factor
            right[i, 0] = right[i, 0] + (value - left) / h
            right[j, 0] = right[j, 0] - (value - left) / h
        found = matrix.solve(right).entries()
        return found + [found[0]]


def moved(derivatives, t):
    """The derivatives of a cubic a time later."""
    u, v, a, j = derivatives
    return [u + v * t + a * t * t / 2 + j * t * t * t / 6, v + a * t + j * t * t / 2, a + j * t, j]


def scene(rng):
    """A net with an initial state under a table of two to seven rows, and perhaps another signal."""
    net = transfer.scene(rng, 3, rng.choice((0, 0, 0, 1, 2)))
    net.longest = rng.choice((0, 0, 1, 2, 4))
    net.samples = rng.randint(2, 9)
    net.until = f"{rng.randint(2, 9)}e{net.longest}"
    base = bool(net.bases)
    # Thousandths of the longest time.
    steps = [rng.randint(60, 400) for _ in range(rng.randint(2, 7))]
    start = rng.choice((0, 0, rng.randint(-3000, 3000)))
    times = [start + sum(steps[:i]) for i in range(len(steps))]
    values = [f"{rng.uniform(-1, 1):.3f}" for _ in steps]
    if rng.random() < 0.5 or len(steps) == 2 or steps[-1] > max(steps[:-1]):
        times.append(start + sum(steps))
        values.append(values[0] if base or rng.random() < 0.5 else f"{rng.uniform(-1, 1):.3f}")
    rows = [(signals.time_word(t, net.longest), v) for t, v in zip(times, values)]
    net.signals = [Periodic(rows, signals.time_word(sum(steps), net.longest), base, net.until)]
    if rng.random() < 0.3:
        net.signals.append(signals.Steps("step", draw.decimal_word(rng, -2, 2), "0"))
    for i in range(net.size()):
        if rng.random() < 0.6:
            net.initial[i] = (draw.decimal_word(rng, -2, 1), "-" + draw.decimal_word(rng, -2, 1))
    return net


check = motions.check
