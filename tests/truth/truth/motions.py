"""Motions in time: free, under signals of each kind, from bases and tables; and the steady state."""

from flint import acb, arb, ctx, fmpq, fmpq_mat, fmpq_poly

from . import draw, signals, transfer
from .exact import I, roots, value
from .tally import decimal

BITS = 500


def scene(rng):
    """A net with an initial state, one to three signals, and times to look at."""
    net = transfer.scene(rng, 3, rng.choice((0, 0, 0, 1, 2)))
    net.longest = rng.choice((0, 0, 1, 1, 2, 3, 6, 8))
    net.samples = rng.randint(2, 9)
    net.until = f"{rng.randint(1, 9)}{rng.choice(('', '.5', '.001', '.37'))}e{net.longest}"
    base = bool(net.bases)
    net.signals = [] if rng.random() < 0.2 else [signals.signal(rng, base, net.longest, base) for _ in range(rng.choice((1, 1, 2)))]
    for i in range(net.size()):
        if rng.random() < 0.6:
            net.initial[i] = (draw.decimal_word(rng, -2, 1), "-" + draw.decimal_word(rng, -2, 1))
    return net


class Motion:
    """An output over time: a sum of g t^k e^(p t) that begins at given times, and integrals over chirps."""

    def __init__(self, net, output):
        name = net.inputs()[0]
        row, direct = net.row(output, name)
        forced, bottom = transfer.quotient(net, row, net.column(name), direct)
        column = self.start(net)
        free = transfer.quotient(net, row, column)[0]
        self.forced, self.bottom = forced, bottom
        self.poles = roots(bottom, BITS)
        self.terms = [(fmpq(0), self.fractions(free.coeffs(), self.poles, bottom.leading_coefficient()))]
        self.chirps = []
        for signal in net.signals:
            if isinstance(signal, signals.Chirp):
                self.chirps.append(signal)
                continue
            for piece in signal.pieces():
                self.terms.append((piece.delay, self.piece(piece)))
        if self.chirps:
            self.impulse = self.fractions(forced.coeffs(), self.poles, bottom.leading_coefficient())
            self.through = divmod(forced, bottom)[0]
            if self.through.degree() > 0:
                raise ValueError("a chirp through a derivative")

    @staticmethod
    def start(net):
        """What the initial state adds on the right: M v + C q + M q s."""
        m, c, _ = net.matrices()
        size = net.size()
        q, v = fmpq_mat(size, 1), fmpq_mat(size, 1)
        for i, (x, speed) in net.initial.items():
            q[i, 0], v[i, 0] = decimal(x), decimal(speed)
        first, second = m * v + c * q, m * q
        return [[first[i, 0], second[i, 0], fmpq(0)] for i in range(size)]

    def piece(self, piece):
        """Partial fractions of H times a piece of a signal."""
        numerator = product(self.forced.coeffs(), piece.numerator)
        leading = self.bottom.leading_coefficient()
        if piece.omega is None:
            return self.fractions(numerator, merged(self.poles, piece.zeros), leading)
        if isinstance(piece.omega, fmpq):
            whole = self.bottom * fmpq_poly([piece.omega * piece.omega, 0, 1])
            return self.fractions(numerator, roots(whole, BITS), leading)
        pair = [(I * piece.omega, 1), (-I * piece.omega, 1)]
        return self.fractions(numerator, self.poles + pair, leading)

    @staticmethod
    def fractions(numerator, poles, leading):
        """The principal parts at all poles: (pole, coefficients of e^(p t), t e^(p t), t^2/2 e^(p t), ...)."""
        found = []
        for i, (p, many) in enumerate(poles):
            series = shifted(numerator, p, many)
            for j, (other, count) in enumerate(poles):
                for _ in range(count if j != i else 0):
                    series = divide(series, p - other)
            found.append((p, [g / leading for g in reversed(series)]))
        return found

    def at(self, t):
        """The output at an exact time, just after what happens at it."""
        total = acb(0)
        for delay, fractions in self.terms:
            if t >= delay:
                total += evaluated(fractions, t - delay)
        for chirp in self.chirps:
            last = decimal(chirp.duration)
            end = t if t < last else last
            if end > 0:
                total += self.convolution(chirp, t, end)
            if t < last:
                total += value(self.through, arb(0)) * chirp.value(acb(t))
        return total.real

    def convolution(self, chirp, t, end):
        """The integral of the impulse response times the signal."""
        return acb.integral(lambda x, _: evaluated_complex(self.impulse, t - x) * chirp.value(x), 0, acb(end))

    def parts(self, t):
        """The sizes of the parts, for what a sum of them may lose."""
        total = arb(0)
        for delay, fractions in self.terms:
            if t >= delay:
                total += sum((abs(evaluated([part], t - delay)) for part in fractions), arb(0))
        return total


def product(a, b):
    """Coefficients of a product; fractions or balls."""
    result = [acb(0)] * max(len(a) + len(b) - 1, 0)
    for i, x in enumerate(a):
        for j, y in enumerate(b):
            result[i + j] = result[i + j] + acb(x) * acb(y)
    return result


def merged(poles, zeros):
    """The poles with `zeros` more of them at zero."""
    if zeros == 0:
        return poles
    rest = [(p, m) for p, m in poles if p != 0]
    many = sum(m for p, m in poles if p == 0)
    return [(acb(0), many + zeros)] + rest


def shifted(coefficients, p, count):
    """The first coefficients of a polynomial in powers of s - p."""
    rest = [acb(c) for c in coefficients]
    series = []
    for _ in range(count):
        total = acb(0)
        quotient = []
        for c in reversed(rest):
            quotient.append(total)
            total = total * p + c
        series.append(total)
        rest = list(reversed(quotient[1:])) if len(quotient) > 1 else []
    return series


def divide(series, d):
    """A power series divided by d + x."""
    result = []
    before = acb(0)
    for c in series:
        before = (c - before) / d
        result.append(before)
    return result


def evaluated(fractions, t):
    """The sum of g t^k/k! e^(p t) at an exact time."""
    return evaluated_complex(fractions, acb(t))


def evaluated_complex(fractions, t):
    total = acb(0)
    for p, parts in fractions:
        polynomial = acb(0)
        for k in range(len(parts) - 1, -1, -1):
            polynomial = polynomial * t / (k + 1) + parts[k]
        total += polynomial * (p * t).exp()
    return total


def check(net, program, tally, rng):
    """Compares the samples of each output, and the steady state."""
    ctx.prec = BITS
    step = decimal(net.until) / net.samples
    word = draw_step(net, step)
    told = program.ask(tally, "simulate", net.text(), "--until", net.until + "s", "--step", word + "s", "--format", "json", tables=net.tables)
    if told is None:
        return
    try:
        motions = {f"y{i}": Motion(net, i) for i in range(len(net.outputs))}
    except ValueError:
        return
    truths = {}
    for output in told["outputs"]:
        motion = motions[output["name"]]
        bounds = output.get("error_bounds", output.get("error_bound"))
        unit = max((abs(arb(v)) for v in output["values"] if v is not None), default=arb(0)) + arb(2) ** -100
        for k, shown in enumerate(output["values"]):
            bound = bounds[k] if isinstance(bounds, list) else bounds
            truth = motion.at(decimal(word) * k)
            truths[output["name"], k] = truth
            tally.absolute("sample", shown, bound, truth, unit)
    steady(net, told, motions, tally)
    if rng.random() < 0.3:
        table(net, program, word, truths, tally)


def table(net, program, word, truths, tally):
    """The same samples as CSV, with the columns that `--bounds` adds."""
    options = ("--until", net.until + "s", "--step", word + "s", "--format", "csv", "--bounds")
    answer = program.run("simulate", net.text(), *options, tables=net.tables)
    if answer.status == 2:
        tally.refuse("no --bounds")
        return
    tally.command = "vibc simulate MODEL " + " ".join(options)
    lines = answer.out.splitlines()
    names = lines[0].split(",") if lines else []
    for k, line in enumerate(lines[1:]):
        cells = dict(zip(names, line.split(",")))
        for (name, at), truth in truths.items():
            if at == k and cells.get(name) and cells.get(name + "_bound"):
                tally.absolute("sample as CSV", float(cells[name]), float(cells[name + "_bound"]), truth, arb(1))
            elif at == k:
                tally.without_bound += 1


def draw_step(net, step):
    """The step as a decimal number of few digits, at most the exact one."""
    return f"{float(step.p) / float(step.q):.3g}".replace("e+", "e")


def steady(net, told, motions, tally):
    """Amplitude and phase of what remains under each harmonic."""
    for row in told.get("steady_state") or []:
        motion = motions[row["output"]]
        for f, amplitude in harmonics(net):
            if abs(float(f.mid()) - row["frequency_hz"]) > 1e-12 * row["frequency_hz"]:
                continue
            s = I * 2 * arb.pi() * f
            bottom = value(motion.bottom, s)
            if bottom.contains(0) or row["amplitude"] is None:
                tally.refuse("no steady state")
                continue
            truth = value(motion.forced, s) / bottom * amplitude
            tally.relative("steady amplitude", row["amplitude"], row["error_bound"], abs(truth))
            if row["error_bound"] is not None and row["phase_deg"] is not None and not truth.contains(0):
                transfer.phase(tally, "steady phase", row["phase_deg"], row.get("phase_error_bound"), row["error_bound"], truth)


def harmonics(net):
    """Frequencies in Hz with the sum of the complex amplitudes there."""
    sums = {}
    for signal in net.signals:
        if isinstance(signal, signals.Harmonic):
            key = (decimal(signal.f), signal.unit)
            sums[key] = sums.get(key, acb(0)) + signal.amplitude()
    return [(arb(f) if unit == "Hz" else arb(f) / (2 * arb.pi()), a) for (f, unit), a in sums.items()]
