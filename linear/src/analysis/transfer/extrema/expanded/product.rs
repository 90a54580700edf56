//! F, half the derivative of |H|^2, over an interval: a polynomial with bounds of its errors, and its roots. Beside a pole it is the
//! numerator of F: with H = P / delta, delta = i t + a + i b, T = t + b, A = re(conj P dP/dt),
//!
//! F = (A (T^2 + a^2) - |P|^2 T) / |delta|^4, and on the axis, where a = 0, F = (A T - |P|^2) / T^3.

use super::MOST_STEPS;
use crate::analysis::transfer::partial_fractions::{DEGREE, Expansion, size};
use crate::base::{down, up};

/// The position at which an interval is cut: not the middle, where models with round numbers have their extrema.
pub const CUT: f64 = 0.4871;
/// A piece of an interval is cut down to this part of it.
const SMALLEST: f64 = 1.0 / 64.0;
/// The coefficients of F alone, and those beside a pole.
const PLAIN: usize = 2 * DEGREE;
const BESIDE: usize = 2 * DEGREE + 4;

/// F over an interval as a polynomial in t, -1 <= t <= 1, times half; and bounds of the errors of F and of its derivative.
pub struct Product {
    coefficients: [f64; BESIDE],
    count: usize,
    errors: [f64; 2],
    /// The part of the error of F that stays in a smaller interval.
    pub noise: f64,
}

/// F over |t - at| <= half.
#[derive(Clone, Copy, Debug)]
pub struct Piece {
    pub at: f64,
    pub half: f64,
    /// F in the middle, a bound of its distance from F elsewhere, and one of its error.
    pub value: f64,
    pub swing: f64,
    error: f64,
    /// The value, swing and error of dF/dt.
    pub slope: f64,
    slope_swing: f64,
    slope_error: f64,
}

impl Product {
    pub fn of(expansion: &Expansion) -> Product {
        let c = &expansion.coefficients;
        let degree = if expansion.pole.is_some() { DEGREE + 1 } else { DEGREE };
        let (mut slope, mut square) = ([0.0; BESIDE], [0.0; BESIDE]);
        for (i, a) in c.iter().enumerate().take(degree + 1) {
            for (j, b) in c.iter().enumerate().take(degree + 1).skip(1) {
                slope[i + j - 1] += j as f64 * (a.re * b.re + a.im * b.im);
            }
        }
        let [h0, h1, h2] = [0, 1, 2].map(|k| size(c, k));
        let [e0, e1, e2] = expansion.errors;
        let [f0, f1, _] = [0, 1, 2].map(|k| expansion.errors[k] - expansion.cut[k]);
        // The products of coefficients, their sums and the shift of the polynomial: no more than 2,000 roundings.
        let lost = 2000.0 * f64::EPSILON;
        // Of A, |P|^2 and A'.
        let of_a = h0 * e1 + h1 * e0 + e0 * e1;
        let of_square = 2.0 * h0 * e0 + e0 * e0;
        let of_slope = 2.0 * h1 * e1 + e1 * e1 + h0 * e2 + h2 * e0 + e0 * e2;
        let (a, next) = (h0 * h1, h1 * h1 + h0 * h2);
        let own = |errors: [f64; 2]| errors.map(|x| x * up::DOZENS + f64::MIN_POSITIVE);
        let Some(pole) = expansion.pole else {
            let errors = own([of_a + lost * a, of_slope + lost * next]);
            return Product { coefficients: slope, count: PLAIN, errors, noise: 0.5 * (h0 * f1 + h1 * f0) };
        };
        // |P|^2 is P(0)^2 and twice the integral of A.
        square[0] = c[0].re * c[0].re + c[0].im * c[0].im;
        (1..BESIDE).for_each(|k| square[k] = 2.0 * slope[k - 1] / k as f64);
        let times_t = |of: &[f64; BESIDE]| -> [f64; BESIDE] {
            std::array::from_fn(|k| k.checked_sub(1).map_or(0.0, |k| of[k]) + pole.offset.im * of[k])
        };
        let (s, blur) = (pole.reach, pole.blur);
        let scale = if pole.is_on_axis() { s } else { s * s };
        let lost_by_slope = lost * (scale * next + 4.0 * s * a + h0 * h0);
        let (coefficients, errors) = if pole.is_on_axis() {
            let all = times_t(&slope);
            let error = s * of_a + blur * (a + of_a) + of_square + lost * (s * a + h0 * h0);
            // A' T - A
            let of_next = s * of_slope + blur * (next + of_slope) + of_a + lost_by_slope;
            (std::array::from_fn(|k| all[k] - square[k]), [error, of_next])
        } else {
            let (twice, once) = (times_t(&times_t(&slope)), times_t(&square));
            let re = pole.offset.re * pole.offset.re;
            let error = scale * of_a + s * of_square + lost * (scale * a + s * h0 * h0);
            // A' (T^2 + a^2) - |P|^2
            let of_next = scale * of_slope + of_square + lost_by_slope;
            (std::array::from_fn(|k| twice[k] + re * slope[k] - once[k]), [error, of_next])
        };
        let noise = 0.5 * (scale * (h0 * f1 + h1 * f0) + 2.0 * s * h0 * f0);
        Product { coefficients, count: BESIDE, errors: own(errors), noise }
    }

    pub fn piece(&self, at: f64, half: f64) -> Piece {
        let mut shifted = self.coefficients;
        let shifted = &mut shifted[..self.count];
        // About the middle it is as it is.
        let steps = if at == 0.0 { 0 } else { shifted.len() - 1 };
        for first in 0..steps {
            for k in (first..shifted.len() - 1).rev() {
                shifted[k] += at * shifted[k + 1];
            }
        }
        let (mut power, mut swing, mut slope_swing) = (1.0, 0.0, 0.0);
        for (k, c) in shifted.iter().enumerate().skip(1) {
            if k > 1 {
                slope_swing += k as f64 * c.abs() * power;
            }
            power *= half;
            swing += c.abs() * power;
        }
        let [error, slope_error] = self.errors;
        Piece { at, half, value: shifted[0], swing, error, slope: shifted[1], slope_swing, slope_error }
    }

    /// Pieces with one root each, over which F is monotone, and pieces of which nothing is known.
    pub fn roots(&self) -> (Vec<Piece>, Vec<Piece>) {
        let (mut roots, mut open) = (Vec::new(), Vec::new());
        let mut left = vec![(0.0, 1.0)];
        while let Some((at, half)) = left.pop() {
            let piece = self.piece(at, half);
            if piece.has_no_root() {
                continue;
            }
            if piece.is_monotone() {
                let [low, high] = [piece.low(), piece.high()].map(|t| self.sign(t));
                if low != 0 && high != 0 {
                    if low != high {
                        roots.push(piece);
                    }
                    continue;
                }
            }
            if half < SMALLEST {
                open.push(piece);
                continue;
            }
            // The parts overlap by more than the rounding of their ends.
            let (left_half, right_half) = (half * CUT * up::DOZENS, half * (1.0 - CUT) * up::DOZENS);
            left.push((piece.at + half * CUT, right_half));
            left.push((piece.at - half * (1.0 - CUT), left_half));
        }
        (roots, open)
    }

    /// An approximation of the only root in a piece.
    pub fn bisect(&self, piece: &Piece, rising: bool) -> f64 {
        let (mut low, mut high) = (piece.low(), piece.high());
        for _ in 0..MOST_STEPS {
            let middle = 0.5 * (low + high);
            if !(low < middle && middle < high) || high - low < 1e-16 {
                break;
            }
            if (self.at(middle) < 0.0) == rising { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    }

    fn at(&self, t: f64) -> f64 {
        self.coefficients[..self.count].iter().rev().fold(0.0, |sum, c| sum * t + c)
    }

    /// The sign of F, 0 if it is not certain.
    pub fn sign(&self, t: f64) -> i8 {
        let value = self.at(t);
        if value.abs() > self.errors[0] * up::THOUSANDS { if value > 0.0 { 1 } else { -1 } } else { 0 }
    }
}

impl Piece {
    pub fn low(&self) -> f64 {
        self.at - self.half
    }

    pub fn high(&self) -> f64 {
        self.at + self.half
    }

    /// `false` for NaN and infinities.
    fn has_no_root(&self) -> bool {
        self.value.abs() > (self.swing + self.error) * up::THOUSANDS
    }

    pub fn is_monotone(&self) -> bool {
        self.slope.abs() > (self.slope_swing + self.slope_error) * up::THOUSANDS
    }

    /// A lower bound of |dF/dt| where it is monotone.
    pub fn least_slope(&self) -> f64 {
        self.slope.abs() * down::THOUSANDS - (self.slope_swing + self.slope_error) * up::THOUSANDS
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::Dd;
    use crate::kernel::complex::Complex;

    /// A polynomial of complex coefficients and its first two derivatives at t.
    fn derivatives(c: &[Complex<Dd>], t: Dd) -> [Complex<Dd>; 3] {
        let mut found = [Complex::<Dd>::ZERO; 3];
        for &c in c.iter().rev() {
            found[2] = found[2].scale(t) + found[1].scale(Dd::from(2.0));
            found[1] = found[1].scale(t) + found[0];
            found[0] = found[0].scale(t) + c;
        }
        found
    }

    fn dot(a: Complex<Dd>, b: Complex<Dd>) -> Dd {
        a.re * b.re + a.im * b.im
    }

    /// F and dF/dt by their definitions, with the pole moved by `moved`.
    fn truth(c: &[Complex<Dd>], t: f64, pole: Option<Complex<f64>>, moved: f64) -> [Dd; 2] {
        let [p, p1, p2] = derivatives(c, Dd::from(t));
        let (a, next, square) = (dot(p, p1), dot(p1, p1) + dot(p, p2), dot(p, p));
        let Some(offset) = pole else { return [a, next] };
        let distance = Dd::from(t) + Dd::from(offset.im) + Dd::from(moved);
        if offset.re == 0.0 {
            return [a * distance - square, next * distance - a];
        }
        let both = distance * distance + Dd::product(offset.re, offset.re);
        [a * both - square * distance, next * both - square]
    }

    /// What the polynomial and its derivative are off by at t.
    fn off(product: &Product, t: f64, [f, next]: [Dd; 2]) -> [f64; 2] {
        let (mut value, mut slope) = (Dd::ZERO, Dd::ZERO);
        for &c in product.coefficients.iter().rev() {
            slope = slope * Dd::from(t) + value;
            value = value * Dd::from(t) + Dd::from(c);
        }
        [(value - f).to_f64().abs(), (slope - next).to_f64().abs()]
    }

    const POLES: [Option<Complex<f64>>; 5] = [
        None,
        Some(Complex { re: 0.0, im: 0.2 }),
        Some(Complex { re: 0.0, im: -9.0 }),
        Some(Complex { re: 0.3, im: 0.4 }),
        Some(Complex { re: 2.0, im: 9.0 }),
    ];

    /// Coefficients that are off by a constant, a line or a parabola, and a pole that is not where it is said to be, move F and its
    /// derivative by no more than the bounds, and at times by a good part of them.
    #[test]
    fn errors_of_the_expansion_are_in_f() {
        const SMALL: f64 = 1e-5;
        let mut largest = [0.0f64; 2];
        for (c, pole) in [[0.7, 0.0, 0.0], [0.01, 2.0, 0.0], [0.9, -0.4, 0.3], [0.1, 0.01, 3.0]]
            .into_iter()
            .flat_map(|c| POLES.map(|pole| (c, pole)))
        {
            let c = [Complex::new(c[0], 0.1 * c[1]), Complex::new(c[1], 0.0), Complex::new(c[2], -0.2 * c[2])];
            let blurs = if pole.is_some_and(|offset| offset.re == 0.0) { vec![0.0, SMALL] } else { vec![0.0] };
            for (shape, blur) in [0, 1, 2, 3].into_iter().flat_map(|shape| blurs.iter().map(move |&blur| (shape, blur)))
            {
                let errors = [[SMALL, 0.0, 0.0], [SMALL, SMALL, 0.0], [0.5 * SMALL, SMALL, SMALL], [0.0; 3]][shape];
                let size = [SMALL, SMALL, 0.5 * SMALL, 0.0][shape];
                let product = Product::of(&Expansion::sample(&c, errors, pole.map(|offset| (offset, blur))));
                for turn in [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)] {
                    let mut moved: Vec<Complex<Dd>> = c.iter().map(|&c| c.into()).collect();
                    let at = shape.min(2);
                    moved[at] = moved[at] + Complex::new(Dd::from(size * turn.0), Dd::from(size * turn.1));
                    for (t, side) in [-1.0, -0.3, 0.0, 0.5, 1.0].into_iter().flat_map(|t| [(t, -1.0), (t, 1.0)]) {
                        let off = off(&product, t, truth(&moved, t, pole, side * blur));
                        for k in 0..2 {
                            assert!(off[k] <= product.errors[k], "{c:?} {pole:?} {shape} {blur} {t} {k}: {off:?}");
                            largest[k] = largest[k].max(off[k] / product.errors[k]);
                        }
                    }
                }
            }
        }
        assert!(largest[0] > 0.4 && largest[1] > 0.4, "{largest:?}");
    }

    /// Coefficients without an error: what is lost is the rounding of their products.
    #[test]
    fn roundings_of_products_are_in_f() {
        let c: Vec<Complex<f64>> = (0..DEGREE)
            .map(|k| Complex::new(0.1 / (1.0 + k as f64), if k % 3 == 0 { -0.3 } else { 0.7 / (2.0 + k as f64) }))
            .collect();
        let wide: Vec<Complex<Dd>> = c.iter().map(|&c| c.into()).collect();
        for pole in POLES {
            let product = Product::of(&Expansion::sample(&c, [0.0; 3], pole.map(|offset| (offset, 0.0))));
            for t in [-1.0, -0.6, 0.1, 0.9] {
                let off = off(&product, t, truth(&wide, t, pole, 0.0));
                assert!(off[0] <= product.errors[0] && off[1] <= product.errors[1], "{pole:?} {t}: {off:?}");
            }
        }
    }
}
