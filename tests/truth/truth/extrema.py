"""Peaks and antiresonances of transfer functions: every one in the range, its place, gain, phase and half-power width."""

from flint import arb, ctx, fmpq, fmpq_poly

from . import draw, transfer
from .exact import I, pi, real_roots, roots, value
from .net import GROUND, Net
from .tally import decimal

BITS = 400


def scene(rng):
    """Ordinary, graded, very lightly damped and nearly uncontrollable nets."""
    kind = rng.choice(("plain", "plain", "graded", "light", "light", "absorber", "chain"))
    if kind == "plain":
        return transfer.scene(rng, 3, 0)
    if kind == "graded":
        return transfer.scene(rng, 5, rng.choice((1, 2, 4)))
    net = Net()
    if kind == "absorber":
        draw.bodies(rng, net, 2, 0)
        net.springs = [(GROUND, 0, draw.decimal_word(rng, 0, 2, 2)), (0, 1, draw.decimal_word(rng, -9, 0, 2))]
        net.masses[1] = draw.decimal_word(rng, -9, 0, 2)
        net.dampers = [(GROUND, 0, draw.decimal_word(rng, -3, 0, 2)), (0, 1, draw.decimal_word(rng, -12, -2, 2))]
    else:
        count = rng.choice((1, 1, 2, 3)) if kind == "light" else rng.randint(4, 9)
        draw.bodies(rng, net, count, 0)
        net.springs = [(i - 1, i, draw.decimal_word(rng, 0, 2, 2)) for i in range(count)]
        low = rng.choice((-17, -15, -12, -8, -5, -3)) if kind == "light" else -2
        net.dampers = [(i - 1, i, draw.decimal_word(rng, low, low + 1, 2)) for i in range(count)]
    net.forces.append(rng.randrange(net.size()))
    transfer.outputs(rng, net, 2)
    return net


class Undecided(Exception):
    """The oracle has too few digits."""


class Curve:
    """|H|^2 = A(x) / B(x) over x = omega^2, with its extrema."""

    def __init__(self, numerator, denominator):
        self.numerator, self.denominator = numerator, denominator
        top, bottom = modulus(numerator), modulus(denominator)
        common = top.gcd(bottom)
        if not top.is_zero() and common.degree() > 0:
            top, bottom = divided(top, common), divided(bottom, common)
        self.top, self.bottom = top, bottom
        slope = top.derivative() * bottom - top * bottom.derivative()
        self.extrema = []
        if slope.is_zero():
            return
        # Poles on the axis, where the gain is infinite, make both zero. Else more digits tell that it is finite.
        may_be_infinite = bottom.gcd(slope).degree() > 0
        for bits in (BITS, 4 * BITS, 16 * BITS):
            ctx.prec = bits
            places = [(x, many) for x, many in real_roots(slope, bits) if x > 0]
            if may_be_infinite or not any(value(bottom, x).contains(0) for x, _ in places):
                break
        sign = 1 if slope.leading_coefficient() > 0 else -1
        for x, many in reversed(places):
            if many % 2 == 0:
                continue
            sign = -sign
            self.extrema.append((x, "peak" if sign > 0 else "antiresonance"))
        self.extrema.reverse()

    def gain_squared(self, x):
        """|H|^2, None where it is infinite."""
        bottom = value(self.bottom, x)
        if bottom.contains(0):
            return None
        return value(self.top, x) / bottom

    def is_below(self, x, half):
        """Whether |H|^2 is less than this; `Undecided` where the digits do not tell."""
        square = self.gain_squared(x)
        if square is None or square.overlaps(half):
            raise Undecided
        return bool(square < half)

    def complex(self, x):
        """H at omega = sqrt(x)."""
        s = I * x.sqrt()
        return value(self.numerator, s) / value(self.denominator, s)

    def width(self, index):
        """The distance in Hz of the places where |H|^2 is half its peak; None where there is none."""
        x, _ = self.extrema[index]
        half = self.gain_squared(x) / 2
        below = self.extrema[index - 1][0] if index > 0 else arb(0)
        if index + 1 < len(self.extrema):
            above = self.extrema[index + 1][0]
        else:
            above = x * 2
            while not self.is_below(above, half):
                if above > x * fmpq(10) ** 40:
                    return None
                above = above * 4
        sides = []
        for other in (below, above):
            if not self.is_below(other, half):
                return None
            sides.append(self.crossing(x, other, half))
        return (sides[1].sqrt() - sides[0].sqrt()) / (2 * pi())

    def crossing(self, high, low, half):
        """Where the monotone piece between a peak and its neighbour crosses half of the peak."""
        high, low = high.mid(), low.mid()
        # Near the peak, search on a scale of ratios of the distance, then bisect.
        for _ in range(BITS - 60):
            middle = ((high + low) / 2).mid()
            if self.gain_squared(middle) > half:
                high = middle
            elif self.gain_squared(middle) < half:
                low = middle
            else:
                break
        return high.union(low)


def divided(poly, other):
    quotient, rest = divmod(poly, other)
    assert rest.is_zero()
    return quotient


def modulus(poly):
    """|p(i omega)|^2 as a polynomial in omega^2."""
    even, odd = [], []
    for power, c in enumerate(poly.coeffs()):
        signed = c if power // 2 % 2 == 0 else -c
        (even if power % 2 == 0 else odd).append(signed)
    even, odd = fmpq_poly(even), fmpq_poly(odd)
    return even * even + fmpq_poly([0, 1]) * odd * odd


def borders(rng, denominator):
    """A range around the poles, as decimal words."""
    sizes = [abs(root) / (2 * pi()) for root, _ in roots(denominator, 100) if root != 0]
    if not sizes:
        return "0.01", "100"
    small, large = sizes[0], sizes[0]
    for size in sizes:
        small = size if size < small else small
        large = size if size > large else large
    spread = rng.choice((1.5, 4, 20))
    low = transfer.plain((small / spread).mid().str(3, radius=False))
    high = transfer.plain((large * spread).mid().str(3, radius=False))
    return low, high


def check(net, program, tally, rng):
    """Compares the list of extrema of each pair."""
    ctx.prec = BITS
    curves = {}
    for name in net.inputs():
        for i in range(len(net.outputs)):
            curves[name, f"y{i}"] = Curve(*transfer.function(net, i, name))
    if not curves:
        return
    low, high = borders(rng, next(iter(curves.values())).denominator)
    told = program.ask(tally, "transfer", net.text(), "--format", "json", "--range", f"{low}Hz..{high}Hz")
    if told is None:
        return
    if isinstance(told, list):
        told = from_text(program.run("transfer", net.text(), "--range", f"{low}Hz..{high}Hz").out)
    edges = [(2 * pi() * decimal(word)) ** 2 for word in (low, high)]
    for pair in told["pairs"]:
        compare(pair, curves[pair["input"], pair["output"]], edges, tally)


def compare(pair, curve, edges, tally):
    """The extrema told of one pair."""
    inside = [i for i, (x, _) in enumerate(curve.extrema) if x > edges[0] and x < edges[1]]
    told = pair["extrema"]
    if pair["complete"]:
        tally.verdict("list of extrema", [row["kind"] for row in told], [curve.extrema[i][1] for i in inside])
    else:
        tally.refuse("not complete")
    free = list(inside)
    for row in told:
        index = nearest(row, curve, free)
        if index is None:
            tally.comparisons += 1
            tally.violate("extremum that is none", f"{row['kind']} at {row['frequency_hz']} Hz", "none near it")
            continue
        free.remove(index)
        one(row, curve, index, tally)


def nearest(row, curve, free):
    """The true extremum of this kind next to the place that was told."""
    if row["frequency_hz"] is None:
        return None
    place = (2 * pi() * arb(row["frequency_hz"])) ** 2
    fits = [i for i in free if curve.extrema[i][1] == row["kind"]]
    return min(fits, key=lambda i: float(abs(curve.extrema[i][0] / place - 1).mid()), default=None)


def one(row, curve, index, tally):
    """One extremum: frequency, gain, phase, width."""
    x, kind = curve.extrema[index]
    if "digits" in row:
        return words(row, curve, index, tally)
    tally.relative("frequency of an extremum", row["frequency_hz"], row["frequency_error_bound"], x.sqrt() / (2 * pi()))
    square = curve.gain_squared(x)
    if square is None:
        tally.verdict("infinite gain", row["gain"], None)
        return
    if square.contains(0):
        tally.absolute("gain of an extremum", row["gain"], 0.0 if row["gain"] == 0 else row["gain_error_bound"], arb(0))
        return
    tally.relative("gain of an extremum", row["gain"], row["gain_error_bound"], square.sqrt())
    if row.get("phase_error_bound") is not None:
        transfer.phase(tally, "phase of an extremum", row["phase_deg"], row["phase_error_bound"], None, curve.complex(x))
    if kind == "peak":
        try:
            width = curve.width(index)
        except Undecided:
            tally.refuse("the oracle has too few digits for a width")
            return
        if width is None:
            tally.verdict("width", row.get("width_hz"), None)
        elif row.get("width_hz") is None:
            tally.refuse("no width")
        elif row.get("width_error_bound") is not None:
            tally.relative("width", row.get("width_hz"), row["width_error_bound"], width)
        else:
            tally.without_bound += 1


def from_text(out):
    """The extrema of the text form, whose digits are to hold to one unit of the last."""
    pairs, pair = [], None
    for line in out.splitlines():
        cells = line.split()
        if " · " in line and " from " in line:
            name = line.split(" · ")[1]
            pair = {"output": name.split()[0], "input": name.split(" from ")[1].split()[0], "complete": True, "extrema": []}
            pairs.append(pair)
        elif cells[:1] in (["peak"], ["antiresonance"]) and len(cells) > 2 and pair is not None:
            pair["extrema"].append({"kind": cells[0], "frequency_hz": float(cells[1]), "digits": (cells[1], cells[2])})
    return {"pairs": pairs}


def words(row, curve, index, tally):
    """Digits of the text form."""
    x, _ = curve.extrema[index]
    tally.digits("digits of an extremum", row["digits"][0], x.sqrt() / (2 * pi()))
    square = curve.gain_squared(x)
    if square is not None and row["digits"][1][0].isdigit() and not square.contains(0):
        tally.digits("digits of its gain", row["digits"][1], square.sqrt())
