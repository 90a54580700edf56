//! Complex numbers over any of our real types: `Complex<f64>` finds starting values, `Complex<Dd>` refines them, and
//! `Complex<Ball>` (an enclosing rectangle) proves them. They only use + - * / and the square root, which are the same
//! on every machine.

use crate::base::{Ball, Dd, larger, up};
use crate::kernel::real::{Real, Scalar};
use crate::kernel::simd::simd;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// re + i im.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Complex<T> {
    pub re: T,
    pub im: T,
}

impl<T: Real> Complex<T> {
    pub const ZERO: Complex<T> = Complex { re: T::ZERO, im: T::ZERO };

    #[inline]
    pub fn new(re: T, im: T) -> Complex<T> {
        Complex { re, im }
    }

    #[inline]
    pub fn real(re: T) -> Complex<T> {
        Complex { re, im: T::ZERO }
    }

    #[inline]
    pub fn conj(self) -> Complex<T> {
        Complex { re: self.re, im: -self.im }
    }

    /// The product with a real number.
    #[inline]
    pub fn scale(self, by: T) -> Complex<T> {
        Complex { re: self.re * by, im: self.im * by }
    }
}

impl<T: Real> Complex<T> {
    /// Rounded to binary64.
    #[inline]
    pub fn to_f64(self) -> Complex<f64> {
        Complex { re: self.re.to_f64(), im: self.im.to_f64() }
    }
}

impl<T: Real> Neg for Complex<T> {
    type Output = Complex<T>;
    #[inline]
    fn neg(self) -> Complex<T> {
        Complex { re: -self.re, im: -self.im }
    }
}

impl<T: Real> Add for Complex<T> {
    type Output = Complex<T>;
    #[inline(always)]
    fn add(self, b: Complex<T>) -> Complex<T> {
        Complex { re: self.re + b.re, im: self.im + b.im }
    }
}

impl<T: Real> Sub for Complex<T> {
    type Output = Complex<T>;
    #[inline(always)]
    fn sub(self, b: Complex<T>) -> Complex<T> {
        Complex { re: self.re - b.re, im: self.im - b.im }
    }
}

impl<T: Real> Mul for Complex<T> {
    type Output = Complex<T>;
    #[inline(always)]
    fn mul(self, b: Complex<T>) -> Complex<T> {
        Complex { re: self.re * b.re - self.im * b.im, im: self.re * b.im + self.im * b.re }
    }
}

impl Div for Complex<Ball> {
    type Output = Complex<Ball>;
    /// The quotient; infinite rectangles if the divisor may be zero.
    #[inline]
    fn div(self, b: Complex<Ball>) -> Complex<Ball> {
        let square = b.re * b.re + b.im * b.im;
        let product = self * b.conj();
        Complex { re: product.re / square, im: product.im / square }
    }
}

impl Complex<f64> {
    /// |re| + |im|: within a factor of sqrt(2) of the modulus, without computing a root.
    #[inline]
    pub fn one_norm(self) -> f64 {
        self.re.abs() + self.im.abs()
    }

    /// The modulus, scaled against overflow; infinite if a part is NaN.
    #[inline]
    pub fn abs(self) -> f64 {
        let size = larger(self.re.abs(), self.im.abs());
        if size == 0.0 || !size.is_finite() {
            return size;
        }
        let (re, im) = (self.re / size, self.im / size);
        size * (re * re + im * im).sqrt()
    }

    /// 1 / self, scaled against overflow (Smith 1962).
    #[inline]
    pub fn recip(self) -> Complex<f64> {
        if self.re.abs() >= self.im.abs() {
            let r = self.im / self.re;
            let d = self.re + self.im * r;
            Complex::new(1.0 / d, -r / d)
        } else {
            let r = self.re / self.im;
            let d = self.re * r + self.im;
            Complex::new(r / d, -1.0 / d)
        }
    }

    /// The square root with a non-negative real part.
    pub fn sqrt(self) -> Complex<f64> {
        let modulus = self.abs();
        if modulus == 0.0 {
            return Complex::ZERO;
        }
        let large = ((self.re.abs() + modulus) / 2.0).sqrt();
        let small = self.im / (2.0 * large);
        match (self.re >= 0.0, self.im >= 0.0) {
            (true, _) => Complex::new(large, small),
            (false, true) => Complex::new(small, large),
            (false, false) => Complex::new(-small, -large),
        }
    }

    #[inline]
    pub fn is_finite(self) -> bool {
        self.re.is_finite() && self.im.is_finite()
    }
}

impl Complex<Dd> {
    /// The number as an enclosure of radius zero.
    #[inline]
    pub fn to_ball(self) -> Complex<Ball> {
        Complex::new(Ball::exact(self.re), Ball::exact(self.im))
    }
}

impl From<Complex<f64>> for Complex<Dd> {
    #[inline]
    fn from(z: Complex<f64>) -> Complex<Dd> {
        Complex::new(Dd::from(z.re), Dd::from(z.im))
    }
}

impl Complex<Ball> {
    /// An upper bound of the modulus.
    #[inline]
    pub fn magnitude(self) -> f64 {
        let (re, im) = (self.re.magnitude(), self.im.magnitude());
        Complex::new(re, im).abs() * (1.0 + 8.0 * f64::EPSILON)
    }

    /// An upper bound of the distance of enclosed numbers from the midpoint.
    #[inline]
    pub fn radius(self) -> f64 {
        Complex::new(self.re.rad, self.im.rad).abs() * (1.0 + 8.0 * f64::EPSILON)
    }

    #[inline]
    pub fn mid(self) -> Complex<Dd> {
        Complex::new(self.re.mid, self.im.mid)
    }
}

/// A rectangle that holds the arc of a circle between two angles, of at most a quarter turn.
pub fn arc(centre: Complex<Ball>, radius: f64, [from, to]: [f64; 2]) -> Complex<Ball> {
    let middle = 0.5 * (from + to);
    // No point of the arc is farther from its middle than half of the arc is long.
    let reach = (0.5 * (to - from) + 1e-14) * radius * up::FEW;
    let part = |x: f64| Ball::new(Dd::from(x * radius), reach);
    Complex::new(centre.re + part(libm::cos(middle)), centre.im + part(libm::sin(middle)))
}

impl Scalar for Complex<f64> {
    const ZERO: Complex<f64> = Complex { re: 0.0, im: 0.0 };
    const ONE: Complex<f64> = Complex { re: 1.0, im: 0.0 };

    fn of_f64(x: f64) -> Complex<f64> {
        Complex::real(x)
    }

    #[inline]
    fn recip(self) -> Complex<f64> {
        Complex::recip(self)
    }

    /// An upper bound on the modulus.
    #[inline]
    fn size(self) -> f64 {
        self.one_norm()
    }
}

impl Scalar for Complex<Dd> {
    const ZERO: Complex<Dd> = Complex { re: Dd::ZERO, im: Dd::ZERO };
    const ONE: Complex<Dd> = Complex { re: Dd::ONE, im: Dd::ZERO };

    fn of_f64(x: f64) -> Complex<Dd> {
        Complex::real(Dd::from(x))
    }

    #[inline]
    fn recip(self) -> Complex<Dd> {
        let square = self.re * self.re + self.im * self.im;
        Complex::new(self.re / square, -self.im / square)
    }

    /// An upper bound on the modulus.
    #[inline]
    fn size(self) -> f64 {
        (self.re.hi.abs() + self.im.hi.abs()) * (1.0 + f64::EPSILON)
    }

    fn subtract_products(x: &mut [Complex<Dd>], f: &[Complex<Dd>], y: Complex<Dd>) {
        subtract_complex_products(x, f, y);
    }
}

simd! {
    /// x_i <- x_i - f_i y
    fn subtract_complex_products(x: &mut [Complex<Dd>], f: &[Complex<Dd>], y: Complex<Dd>) {
        for (x, &f) in x.iter_mut().zip(f) {
            *x = *x - f * y;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_arc_lies_in_its_rectangle() {
        let centre = Complex::new(Ball::from(-3.0), Ball::from(5.0));
        for (from, to) in [(0.0f64, 0.4f64), (1.5, 1.6), (3.0, 4.5), (6.0, 6.3)] {
            let rectangle = arc(centre, 2.0, [from, to]);
            for part in 0..=10 {
                let angle = from + (to - from) * f64::from(part) / 10.0;
                let point = [2.0 * angle.cos() - 3.0, 2.0 * angle.sin() + 5.0].map(Ball::from);
                let is_in = |ball: Ball, x: Ball| (ball - x).contains_zero();
                assert!(is_in(rectangle.re, point[0]) && is_in(rectangle.im, point[1]), "{from} {to} {part}");
            }
            assert!(rectangle.re.rad <= to - from + 1e-12, "{rectangle:?}");
        }
    }

    #[test]
    fn the_square_of_a_root_is_the_number() {
        for (re, im) in [(3.0, 4.0), (-3.0, 4.0), (-3.0, -4.0), (0.0, -2.0), (-1.0, 0.0), (1e-200, 1e200)] {
            let z = Complex::new(re, im);
            let root = z.sqrt();
            assert!((root * root - z).abs() <= 4.0 * f64::EPSILON * z.abs(), "{z:?}");
            assert!(root.re >= 0.0);
        }
    }

    #[test]
    fn a_number_times_its_reciprocal_is_one() {
        for (re, im) in [(3.0, 4.0), (1e-3, 1e5), (-1e150, 1e150)] {
            let z = Complex::new(re, im);
            assert!((z * z.recip() - Complex::real(1.0)).abs() < 4.0 * f64::EPSILON);
        }
    }

    #[test]
    fn nan_has_no_modulus() {
        for (re, im) in [(f64::NAN, 0.0), (0.0, f64::NAN), (f64::NAN, 5.0), (f64::INFINITY, f64::NAN)] {
            assert_eq!(Complex::new(re, im).abs(), f64::INFINITY);
        }
    }
}
