"""Maxima under response spectra: SRSS, CQC and missing mass from the residues of p^T (K - x M)^-1 v at the squares of the frequencies."""

from flint import arb, ctx, fmpq, fmpq_mat

from . import draw
from .exact import determinant, interpolate, pi, real_roots, value
from .modes import scale
from .net import Net
from .tally import decimal

BITS = 400
UNITS = ("m", "m/s", "m/s^2")


class Spectrum:
    """Points of a spectrum of displacements, velocities or accelerations, and its damping."""

    def __init__(self, points, derivative, damping):
        self.points, self.derivative, self.damping = points, derivative, damping

    def words(self):
        points = ", ".join(f"({f} Hz, {a} {UNITS[self.derivative]})" for f, a in self.points)
        return f"spectrum({points}, damping = {self.damping})"

    def acceleration(self, size, hertz):
        return size * (2 * pi() * hertz) ** (2 - self.derivative)

    def rigid(self):
        f, a = self.points[-1]
        return self.acceleration(arb(decimal(a)), arb(decimal(f)))

    def at(self, hertz):
        """The pseudo-acceleration, and whether it is that of the rigid range; None below the lowest point."""
        ends = [(arb(decimal(f)), arb(decimal(a))) for f, a in self.points]
        if hertz > ends[-1][0]:
            return self.rigid(), True
        if hertz < ends[0][0]:
            return None
        for (f, a), (g, b) in zip(ends, ends[1:]):
            if hertz < g:
                return self.acceleration(a * (b / a) ** ((hertz / f).log() / (g / f).log()), hertz), False
        return None


def scene(rng):
    """An undamped net on one or two bases, one damping ratio for all of its modes, and a spectrum for each base."""
    net = Net()
    count = draw.size(rng, 4)
    decades = rng.choice((0, 0, 0, 1, 2, 4))
    draw.bodies(rng, net, count, decades)
    draw.springs(rng, net, count, decades, grounded=False)
    if rng.random() < 0.4 or count == 1:
        net.springs = [(a, b, k) for a, b, k in net.springs if a != -1 or rng.random() < 0.5]
    net.bases = [""] * rng.choice((1, 1, 2))
    for i, _ in enumerate(net.bases):
        net.springs.append((("base", i), rng.randrange(count), draw.spring_word(rng, decades, 0.0)))
    net.damping = ("modal", rng.choice(("0.02", "0.05", "5e-3", "0.3", "1e-9", draw.decimal_word(rng, -4, 0))))
    for _ in range(rng.choice((1, 2, 3, 4))):
        net.outputs.append(output(rng, net, count))
    net.spectra = [spectrum(rng, net) for _ in net.bases]
    plain = net.text

    def text():
        rows = []
        for row in plain().splitlines():
            words = row.split()
            rows.append(row + (f" = {net.spectra[int(words[1][1:])].words()}" if words[0] == "base" else ""))
        return "\n".join(rows) + "\n"

    net.text = text
    net.smaller = lambda: iter(())
    return net


def output(rng, net, count):
    kind = rng.choice(("k.force", "k.force", "k.stretch", "ax", "ax", "x", "x-x"))
    if kind[0] == "k":
        return [("1", kind, rng.randrange(len(net.springs)))]
    if kind == "x-x" and count > 1:
        i, j = rng.sample(range(count), 2)
        return [("1", "x", i), ("-1", "x", j)]
    return [(rng.choice(("1", "-2.5")), kind if kind == "ax" else "x", rng.randrange(count))]


def spectrum(rng, net):
    """About the frequencies, mostly: some modes lie above the last point, and seldom one below the first."""
    ctx.prec = 100
    sizes = [float((x.sqrt() / (2 * pi())).mid()) for x in squares(net) if x > 0] or [1.0]
    low, high = min(sizes), max(sizes)
    found = {f"{low * 10 ** rng.uniform(-1, 0.02 if rng.random() < 0.2 else -0.1):.3e}"}
    while len(found) < rng.choice((2, 3, 4, 5)):
        found.add(f"{10 ** rng.uniform(0, 1.5) * rng.choice((low, high)):.{rng.choice((1, 3, 6))}e}")
    words = sorted(found, key=float)
    other = rng.choice(("0.05", "0.02", "0.1", "0.5")) if rng.random() < 0.3 else net.damping[1]
    return Spectrum([(f, draw.decimal_word(rng, -2, 2)) for f in words], rng.randrange(3), other)


def squares(net):
    m, _, k = net.matrices()
    return [x for x, _ in real_roots(determinant([k, -m], scale(m, k)), max(ctx.prec, 100))]


def residues(net, row, column, squares):
    """(p^T x_i) (x_i^T v) for each mode."""
    m, _, k = net.matrices()
    size = net.size()
    slope = determinant([k, -m], scale(m, k)).derivative()

    def at(x):
        q = k - m * fmpq(x)
        bordered = fmpq_mat(size, size, [q[i, j] + column[i] * row[j] for i in range(size) for j in range(size)])
        return bordered.det() - q.det()

    numerator = interpolate(at, size)
    return [-value(numerator, x) / value(slope, x) for x in squares]


def eta(zeta):
    """EN 1998-1:2004, 3.2.2.2 (3)."""
    root = (arb(fmpq(10, 100)) / (arb(fmpq(5, 100)) + zeta)).sqrt()
    least = arb(fmpq(55, 100))
    return root if root > least else least


def correlation(a, b, zeta):
    """Der Kiureghian's, for one damping ratio."""
    r = b / a
    return 8 * zeta ** 2 * (1 + r) * r * r.sqrt() / ((1 - r * r) ** 2 + 4 * zeta ** 2 * r * (1 + r) ** 2)


def combined(parts, omegas, is_rigid, zeta, is_added):
    """SRSS, CQC and the missing part."""
    swing = [i for i, rigid in enumerate(is_rigid) if not rigid]
    missing = abs(sum((part for part, rigid in zip(parts, is_rigid) if rigid), arb(0)))
    more = missing ** 2 if is_added else arb(0)
    srss = sum((parts[i] ** 2 for i in swing), arb(0)) + more
    cqc = srss
    for place, i in enumerate(swing):
        for j in swing[:place]:
            cqc += 2 * parts[i] * parts[j] * correlation(omegas[i], omegas[j], zeta)
    return root(srss), root(cqc), missing


def root(square):
    """Of a sum of squares."""
    return square.sqrt() if square > 0 else abs(square).sqrt()


def direction(net, number, listed, is_added):
    """What is true about one base: a word, or its masses and for each output its kind and numbers."""
    m, _, k = net.matrices()
    size, own = net.size(), net.spectra[number]
    drive = net.column(f"u{number}")
    carried = k.solve(fmpq_mat(size, 1, [entry[0] for entry in drive]))
    v = [(m * carried)[i, 0] for i in range(size)]
    masses = residues(net, v, v, listed)
    omegas = [x.sqrt() for x in listed]
    zeta, given = arb(decimal(net.damping[1])), arb(decimal(own.damping))
    found = [own.at(omega / (2 * pi())) for omega in omegas]
    total = sum(masses, arb(0))
    # Participation factors are known to some 28 digits.
    if any(at is None and mass > total * arb(10) ** -40 for at, mass in zip(found, masses)):
        return "below"
    if any(at is None for at in found):
        return "open"
    factor = eta(zeta) / eta(given) if net.damping[1] != own.damping else arb(1)
    is_rigid = [rigid for _, rigid in found]
    values = [at if rigid else at * factor for at, rigid in found]
    outputs = []
    for i, terms in enumerate(net.outputs):
        row, direct = net.row(i, f"u{number}")
        power = 2 if terms[0][1] == "ax" else 0
        p = [entry[power] for entry in row]
        follows = sum((x * carried[j, 0] for j, x in enumerate(p)), fmpq(0)) + direct[0]
        if power == 0 and follows != 0:
            outputs.append(None)
            continue
        shares = residues(net, p, v, listed)
        parts = [share * at / (x if power == 0 else 1) for share, at, x in zip(shares, values, listed)]
        outputs.append(("relative" if power == 0 else "absolute", *combined(parts, omegas, is_rigid, zeta, is_added)))
    missing = sum((mass for mass, rigid in zip(masses, is_rigid) if rigid), arb(0))
    return missing, outputs


def check(net, program, tally, rng):
    ctx.prec = BITS
    m, _, k = net.matrices()
    poly = determinant([k, -m], scale(m, k))
    found = real_roots(poly, BITS)
    if any(count > 1 or not x > 0 for x, count in found):
        return
    listed = [x for x, _ in found]
    is_added = rng.random() < 0.5
    options = ["--other-damping", "--across-directions"] + (["--missing-mass"] if is_added else [])
    told = program.ask(tally, "analyze", net.text(), "--format", "json", *options)
    if told is None:
        return
    told = told["response_spectra"]
    truths = [direction(net, number, listed, is_added) for number, _ in enumerate(net.bases)]
    for claim, true in zip(told["directions"], truths):
        if true == "open":
            tally.refuse("a mode that is hardly excited lies below the spectrum")
            continue
        tally.verdict("refused", claim["reason"] is not None, true == "below")
        if true == "below" or claim["reason"] is not None:
            continue
        missing, outputs = true
        tally.absolute("missing mass", claim["missing_mass"], claim["missing_mass_error_bound"], missing)
        for output, expected in zip(claim["outputs"], outputs):
            tally.verdict("kind", output["of"], expected and expected[0])
            if expected is None or output["of"] is None:
                continue
            _, srss, cqc, part = expected
            tally.relative("srss", output["srss"], output["srss_error_bound"], srss)
            tally.relative("cqc", output["cqc"], output["cqc_error_bound"], cqc)
            tally.absolute("missing part", output["missing"], output["missing_error_bound"], part)
    if any(isinstance(true, str) for true in truths):
        return
    across = {claim["output"]: claim for claim in told.get("across_directions", [])}
    for i, _ in enumerate(net.outputs):
        parts = [outputs[i] for _, outputs in truths]
        claim = across.get(f"y{i}")
        tally.verdict("across", claim is None, any(part is None for part in parts))
        if claim is not None and all(parts):
            for name, place in (("srss", 1), ("cqc", 2)):
                truth = sum((part[place] ** 2 for part in parts), arb(0))
                tally.relative(f"across {name}", claim[name], claim[f"{name}_error_bound"], root(truth))
