//! Complex numbers with one radius: discs. A product turns and stretches a disc into a disc, where rectangles grow with each
//! turn, so long products stay as narrow as their conditioning allows.

use crate::base::{Ball, Dd, down, up};
use crate::kernel::complex::Complex;
use std::ops::{Mul, Sub};

/// A complex number within `radius` of `value`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disc {
    pub value: Complex<Dd>,
    /// A bound of |true - value|, absolute.
    pub radius: f64,
}

/// Relative error of a complex operation in double-double: two products and a sum for each part are below 2^-100 of the
/// modulus, a reciprocal below 2^-98.
const UNIT: f64 = 4.0 * Dd::EPSILON;
/// Covers the roundings of a radius, and underflow.
const UP: f64 = up::DOZENS;
const TINY: f64 = 1e-300;
/// Underflow error of the four products and two sums of a complex product.
const UNDERFLOW: f64 = 1e-317;

impl Disc {
    pub const ZERO: Disc = Disc { value: Complex { re: Dd::ZERO, im: Dd::ZERO }, radius: 0.0 };

    /// The disc around a rectangle.
    pub fn of(value: Complex<Ball>) -> Disc {
        Disc { value: value.mid(), radius: value.radius() }
    }

    #[inline(always)]
    pub fn is_zero(&self) -> bool {
        self.value.re.is_zero() && self.value.im.is_zero() && self.radius == 0.0
    }

    /// `None` if the number may be zero: |1/z - 1/m| <= r / (|m| (|m| - r)).
    #[inline(always)]
    pub fn recip(self) -> Option<Disc> {
        let (re, im) = (self.value.re, self.value.im);
        let size = self.size() * (1.0 - 4e-14) - 2.0 * TINY;
        if !(size > self.radius && size > 1e-140 && size < 1e140) {
            return None;
        }
        let square = re * re + im * im;
        let value = Complex::new(re / square, -(im / square));
        let radius = self.radius / (size * (size - self.radius)) + 4.0 * UNIT / size;
        Some(Disc { value, radius: radius * UP })
    }

    /// A bound of |true - value| / |true|; 0 for an exact number, infinite where the disc contains zero.
    pub fn relative_error(&self) -> f64 {
        if self.radius == 0.0 {
            return 0.0;
        }
        let size = self.value.to_f64().abs() * down::FEW;
        if size > self.radius { self.radius / (size - self.radius) * up::THOUSANDS } else { f64::INFINITY }
    }

    /// An upper bound of the modulus of the value, without the radius.
    #[inline(always)]
    fn size(&self) -> f64 {
        let (re, im) = (self.value.re.hi, self.value.im.hi);
        let root = (re * re + im * im).sqrt();
        // Squares of smaller numbers may underflow.
        if root > 1e-150 { root * UP + TINY } else { re.abs() + im.abs() + TINY }
    }
}

impl Mul for Disc {
    type Output = Disc;
    #[inline(always)]
    fn mul(self, b: Disc) -> Disc {
        if self.is_zero() || b.is_zero() {
            return Disc::ZERO;
        }
        let (size, other) = (self.size(), b.size());
        let radius = size * b.radius + other * self.radius + self.radius * b.radius + UNIT * size * other + UNDERFLOW;
        Disc { value: self.value * b.value, radius: radius * UP }
    }
}

impl Sub for Disc {
    type Output = Disc;
    #[inline(always)]
    fn sub(self, b: Disc) -> Disc {
        let value = self.value - b.value;
        let difference = Disc { value, radius: 0.0 };
        Disc { value, radius: (self.radius + b.radius + UNIT * difference.size()) * UP }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn disc(re: f64, im: f64, radius: f64) -> Disc {
        Disc { value: Complex::new(Dd::from(re), Dd::from(im)), radius }
    }

    /// A product that underflows is not known to be zero, and the radius of a product with a small factor is small.
    #[test]
    fn underflow_keeps_a_radius() {
        let product = disc(1e-200, 0.0, 0.0) * disc(1e-150, 0.0, 0.0);
        assert!(product.radius > 0.0 && !product.is_zero());
        // 1e-170 (3 +- 2): within 2e-170 of its midpoint, and no less.
        let scaled = disc(1e-170, 0.0, 0.0) * disc(3.0, 0.0, 2.0);
        assert!(scaled.radius >= 2e-170, "{:e}", scaled.radius);
    }

    /// Points on the edges of two discs: their products, differences and reciprocals lie in the results, which are little wider
    /// than they must be.
    #[test]
    fn results_contain_those_of_the_edges_and_are_no_wider_than_they_must_be() {
        let (a, b) = (disc(3.0, -4.0, 0.5), disc(-1.0, 2.0, 0.25));
        let on = |disc: &Disc, turn: usize| {
            let angle = turn as f64 * std::f64::consts::TAU / 64.0;
            disc.value.to_f64() + Complex::new(libm::cos(angle), libm::sin(angle)) * Complex::real(disc.radius)
        };
        let mut reach = [0.0_f64; 3];
        let results = [a * b, a - b, a.recip().expect("zero lies outside")];
        for (i, j) in (0..64).flat_map(|i| (0..64).map(move |j| (i, j))) {
            let (x, y) = (on(&a, i), on(&b, j));
            for ((reach, exact), found) in reach.iter_mut().zip([x * y, x - y, x.recip()]).zip(&results) {
                *reach = reach.max((exact - found.value.to_f64()).abs() / found.radius);
            }
        }
        // The points are computed in binary64, and no pair of them need be the farthest one.
        assert!(reach.iter().all(|reach| *reach < 1.0 + 1e-13 && *reach > 0.99), "{reach:?}");
    }

    #[test]
    fn a_disc_around_zero_has_no_reciprocal_and_no_relative_error() {
        assert_eq!(disc(0.3, 0.4, 0.5).recip(), None);
        assert_eq!(disc(0.3, 0.4, 0.5).relative_error(), f64::INFINITY);
        assert_eq!(disc(3.0, 4.0, 0.0).relative_error(), 0.0);
        assert!(disc(3.0, 4.0, 1.0).relative_error() >= 0.25 && disc(3.0, 4.0, 1.0).relative_error() < 0.2501);
    }
}
