"""Determinants of polynomial matrices, their roots, and certified numbers from them. Nothing here rounds unseen."""

from functools import lru_cache

from flint import arb, acb, ctx, fmpq, fmpq_mat, fmpq_poly

I = acb(0, 1)


def pi():
    """Pi to the present precision."""
    return arb.pi()


@lru_cache(maxsize=None)
def _lagrange(count):
    """The inverse of the Vandermonde matrix of the points 0, 1, -1, 2, -2, ..."""
    points = _points(count)
    return fmpq_mat(count, count, [fmpq(x) ** j for x in points for j in range(count)]).inv()


def _points(count):
    return [0] + [x for k in range(1, count) for x in (k, -k)][: count - 1]


def interpolate(f, degree):
    """The polynomial of at most this degree that f, a function of a whole number, is."""
    count = degree + 1
    values = fmpq_mat(count, 1, [f(x) for x in _points(count)])
    return fmpq_poly((_lagrange(count) * values).entries())


def square(rows):
    """A fraction matrix of a list of rows."""
    return fmpq_mat(len(rows), len(rows[0]), [entry for row in rows for entry in row])


def determinant(parts, scale=fmpq(1)):
    """det(A0 + A1 x + A2 x^2 + ...) as a polynomial; `parts` are square matrices of fractions.

    `scale` is a unit of x near the roots: numbers stay short where the matrices are graded."""
    size = parts[0].nrows()
    degree = size * (len(parts) - 1)

    def at(x):
        total = parts[0]
        power = fmpq(x) * scale
        factor = power
        for part in parts[1:]:
            total = total + part * factor
            factor = factor * power
        return total.det()

    scaled = interpolate(at, degree)
    return stretch(scaled, 1 / fmpq(scale))


def stretch(poly, factor):
    """p(factor x)."""
    coefficients = []
    power = fmpq(1)
    for c in poly.coeffs():
        coefficients.append(c * power)
        power = power * factor
    return fmpq_poly(coefficients)


def roots(poly, bits=None):
    """All roots with their multiplicities, as disjoint balls; zero is exactly zero and real roots are real."""
    found = []
    coefficients = poly.coeffs()
    zeros = 0
    while zeros < len(coefficients) and coefficients[zeros] == 0:
        zeros += 1
    if zeros:
        found.append((acb(0), zeros))
        poly = fmpq_poly(coefficients[zeros:])
    if poly.degree() < 1:
        return found
    before = ctx.prec
    if bits:
        ctx.prec = bits
    try:
        found.extend((root, count) for root, count in poly.complex_roots())
    finally:
        ctx.prec = before
    return found


def real_roots(poly, bits=None):
    """The real roots in ascending order, with their multiplicities."""
    return sorted(((r.real, m) for r, m in roots(poly, bits) if r.imag == 0), key=lambda pair: _key(pair[0]))


def _key(x):
    return _Order(x)


class _Order:
    """Balls that are disjoint, ordered."""

    __slots__ = ("x",)

    def __init__(self, x):
        self.x = x

    def __lt__(self, other):
        return bool(self.x < other.x)


def value(poly, z):
    """A polynomial of fractions at a ball, by Horner's scheme."""
    total = acb(0) if isinstance(z, acb) else arb(0)
    for c in reversed(poly.coeffs()):
        total = total * z + c
    return total


def argument(z):
    """The angle of a complex number in degrees, in (-180, 180]."""
    return arb.atan2(z.imag, z.real) * 180 / pi()
