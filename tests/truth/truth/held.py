"""Inputs that are held from sample to sample, or joined by lines: the outputs in ball arithmetic, and the sizes of their parts.

The response to an input is a sum over the poles of g t^k/k! e^(p t), so at sample n it is a sum over the samples before it of
(n - j)^k e^(p h (n - j)) times how the input changes at j. The powers are products of two from tables, each a certified exponential: nothing
is carried from step to step, where balls about a rotation would grow."""

from math import factorial

from flint import acb, acb_mat, ctx, fmpq

from . import motions, transfer
from .exact import roots
from .tally import decimal

BITS = 256
# The length of the table of small powers.
BLOCK = 512


class Output:
    """An output under one input, of which every sample is known as a binary64 number."""

    def __init__(self, net, output, inputs):
        ctx.prec = motions.BITS
        name = net.inputs()[0]
        row, direct = net.row(output, name)
        forced, bottom = transfer.quotient(net, row, net.column(name), direct)
        self.step, self.first, self.inputs = decimal(net.step), net.hold == "first", inputs
        free = transfer.quotient(net, row, motions.Motion.start(net))[0]
        self.poles, self.leading, self.forced = roots(bottom, motions.BITS), bottom.leading_coefficient(), forced
        self.free = motions.Motion.fractions(free.coeffs(), self.poles, self.leading)
        self.impulse = motions.Motion.fractions(forced.coeffs(), self.poles, self.leading)
        through = divmod(forced, bottom)[0].coeffs()
        if len(through) > 1:
            raise ValueError("an output that follows the rate of a held input")
        self.through = through[0] if through else fmpq(0)
        # A jump and, where inputs are joined by lines, a change of slope: the responses to both.
        self.jump = self.response(1)
        self.bend = self.response(2) if self.first else []
        values = [fmpq(*u.as_integer_ratio()) for u in inputs]
        before = [fmpq(0)] + values
        self.jumps = [values[0]] if self.first else [u - b for u, b in zip(values, before)]
        slopes = [fmpq(0)] + [(v - u) / self.step for u, v in zip(values, values[1:])]
        self.bends = [b - a for a, b in zip(slopes, slopes[1:])]
        self.tables = {}

    def response(self, zeros):
        """The response to 1 / s^zeros, by poles."""
        numerator = motions.product(self.forced.coeffs(), [1])
        return motions.Motion.fractions(numerator, motions.merged(self.poles, zeros), self.leading)

    def at(self, sample):
        """The output at a sample, just after what happens at it."""
        ctx.prec = BITS
        total = motions.evaluated(self.free, self.step * sample)
        total += self.summed(self.jump, self.jumps, sample)
        total += self.summed(self.bend, self.bends, sample)
        return total.real

    def summed(self, response, changes, sample):
        """What all changes up to a sample have led to."""
        total = acb(0)
        for p, parts in response:
            small, large = self.powers(p, len(self.inputs))
            for k, g in enumerate(parts):
                total += acb(g) * self.moment(changes, small, large, k, sample)
        return total

    def moment(self, changes, small, large, k, sample):
        """The sum over j of changes[j] e^(p h m) (h m)^k / k!, m = sample - j."""
        factor = self.step ** k / factorial(k)
        count = min(len(changes), sample + 1)
        sums = {}
        for j in range(count):
            m = sample - j
            weight = changes[j] * m ** k if k else changes[j]
            sums[m // BLOCK] = sums.get(m // BLOCK, 0) + small[m % BLOCK] * weight
        return sum((large[block] * inner for block, inner in sums.items()), acb(0)) * factor

    def powers(self, p, count):
        """e^(p h m) for m below the length of a block, and for whole blocks."""
        key = p.str(50)
        if key not in self.tables:
            angle = acb(p) * self.step
            self.tables[key] = ([(angle * m).exp() for m in range(BLOCK)], [(angle * (m * BLOCK)).exp() for m in range(count // BLOCK + 1)])
        return self.tables[key]

    def sizes(self, share=lambda p: 1.0):
        """The sum of the largest sizes that the parts have had up to each sample: of each pole, times its share, and of the
        input itself.

        These are numbers that a bound is relative to; binary64 is enough."""
        count = len(self.inputs)
        sums = [0.0] * count
        for (p, drive), (_, start) in zip(self.impulse, self.free):
            part = share(complex(p))
            for k, x in enumerate(self.largest(p, drive, start)):
                sums[k] += part * x
        most, through = 0.0, abs(float(self.through.p) / float(self.through.q))
        for k, u in enumerate(self.inputs):
            most = max(most, through * abs(u))
            sums[k] += most
        return sums

    def largest(self, p, drive, start):
        """The largest size so far of the part of one pole: z_k' = p z_k + z_(k+1) + g_k u, of which z_0 is seen."""
        many = len(drive)
        size = many + 2
        a = [[acb(0)] * size for _ in range(size)]
        for k in range(many):
            a[k][k] = acb(p)
            if k + 1 < many:
                a[k][k + 1] = acb(1)
            a[k][many] = acb(drive[k])
        a[many][many + 1] = acb(1)
        whole = (acb_mat(size, size, [x for row in a for x in row]) * acb(self.step)).exp()
        f = [[complex(whole[i, j]) for j in range(size)] for i in range(many)]
        h = float(self.step.p) / float(self.step.q)
        z = [complex(acb(x)) for x in start] + [0j] * (many - len(start))
        most = 0.0
        for k, u in enumerate(self.inputs):
            most = max(most, abs(z[0]))
            yield most
            slope = (self.inputs[k + 1] - u) / h if self.first and k + 1 < len(self.inputs) else 0.0
            z = [sum(f[i][j] * z[j] for j in range(many)) + f[i][many] * u + f[i][many + 1] * slope for i in range(many)]
