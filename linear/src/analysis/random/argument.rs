//! Arguments of functions that are integrated over a band: complex numbers, and matrices of order two for a pair of
//! poles that nearly coincide. All are enclosures, with bounds of their norms.

use crate::base::{Ball, Number, up};
use crate::kernel::complex::Complex;

pub type Point = Complex<Ball>;

/// A matrix of order two, by rows.
#[derive(Clone, Copy, Debug)]
pub struct Two(pub [[Point; 2]; 2]);

/// An argument of functions that are power series or contain a logarithm.
pub trait Argument: Copy {
    fn of(z: Point) -> Self;
    fn plus(self, other: Self) -> Self;
    fn times(self, other: Self) -> Self;
    fn scale(self, by: Ball) -> Self;
    fn inverse(self) -> Self;
    /// An upper bound of the norm.
    fn size(self) -> f64;
    /// The argument with every entry widened.
    fn widen(self, by: f64) -> Self;
    /// The integral of 1 / (x - z) over -1 .. 1, if z lies in the upper half-plane or beyond one of the ends.
    fn logarithm(self) -> Self;

    fn plus_number(self, x: Ball) -> Self {
        self.plus(Self::of(Complex::real(x)))
    }

    /// The product with -i.
    fn times_minus_i(self) -> Self {
        self.times(Self::of(Complex::new(Ball::ZERO, -Ball::ONE)))
    }
}

fn unknown() -> Ball {
    Ball::ZERO.widen(f64::INFINITY)
}

impl Argument for Point {
    fn of(z: Point) -> Point {
        z
    }

    fn plus(self, other: Point) -> Point {
        self + other
    }

    fn times(self, other: Point) -> Point {
        self * other
    }

    fn scale(self, by: Ball) -> Point {
        Complex::scale(self, by)
    }

    fn inverse(self) -> Point {
        Complex::real(Ball::ONE) / self
    }

    fn size(self) -> f64 {
        self.magnitude()
    }

    fn widen(self, by: f64) -> Point {
        Complex::new(self.re.widen(by), self.im.widen(by))
    }

    /// x - z stays on one side of the real axis, or of the imaginary one.
    fn logarithm(self) -> Point {
        let ends = [Ball::ONE - self.re, -Ball::ONE - self.re];
        let is_beyond = ends[1].is_positive() || ends[0].is_negative();
        if !(self.im.is_positive() || is_beyond) {
            return Complex::new(unknown(), unknown());
        }
        let [after, before] = ends.map(|re| re * re + self.im * self.im);
        // Both x - z turned by half a turn have the same ratio, and their angles are on one side of the cut.
        let sign = if ends[0].is_negative() { -Ball::ONE } else { Ball::ONE };
        let angle = |re: Ball| {
            let [re, im] = [sign * re, -(sign * self.im)].map(Number::Ball);
            Number::atan2(&im, &re).map_or(unknown(), |angle| angle.to_ball())
        };
        let size = Number::Ball(after / before).ln().map_or(unknown(), |ln| ln.to_ball() * Ball::from(0.5));
        Complex::new(size, angle(ends[0]) - angle(ends[1]))
    }
}

impl Two {
    fn map(self, f: impl Fn(Point) -> Point) -> Two {
        Two(self.0.map(|row| row.map(&f)))
    }

    pub fn conj(self) -> Two {
        self.map(|z| z.conj())
    }

    /// Half the trace, as an exact number.
    pub fn mean(self) -> Point {
        let sum = (self.0[0][0] + self.0[1][1]).mid();
        Complex::new(sum.re.scale(0.5), sum.im.scale(0.5)).to_ball()
    }
}

impl Argument for Two {
    fn of(z: Point) -> Two {
        Two([[z, Complex::ZERO], [Complex::ZERO, z]])
    }

    fn plus(self, other: Two) -> Two {
        Two(std::array::from_fn(|i| std::array::from_fn(|j| self.0[i][j] + other.0[i][j])))
    }

    fn times(self, other: Two) -> Two {
        let entry = |i: usize, j: usize| self.0[i][0] * other.0[0][j] + self.0[i][1] * other.0[1][j];
        Two(std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j))))
    }

    fn scale(self, by: Ball) -> Two {
        self.map(|z| Complex::scale(z, by))
    }

    fn inverse(self) -> Two {
        let [[a, b], [c, d]] = self.0;
        let inverse = Complex::real(Ball::ONE) / (a * d - b * c);
        Two([[d, -b], [-c, a]]).map(|z| z * inverse)
    }

    /// The magnitude of the mean plus the Frobenius norm of the rest: hardly more than the larger of two poles that
    /// nearly coincide.
    fn size(self) -> f64 {
        let mean = self.mean();
        let square = |(i, j): (usize, usize)| {
            let entry = if i == j { self.0[i][j] - mean } else { self.0[i][j] };
            entry.magnitude() * entry.magnitude()
        };
        let rest = [(0, 0), (0, 1), (1, 0), (1, 1)].into_iter().map(square).sum::<f64>().sqrt();
        (mean.magnitude() + rest) * up::DOZENS
    }

    fn widen(self, by: f64) -> Two {
        self.map(|z| z.widen(by))
    }

    /// ln(1 - z - N) - ln(-1 - z - N) as power series in N, z the mean.
    fn logarithm(self) -> Two {
        const MOST: usize = 200;
        const SETTLED: f64 = 1e-36;
        let mean = self.mean();
        let rest = self.plus(Two::of(-mean));
        let mut sum = Two::of(mean.logarithm());
        for end in [Ball::ONE, -Ball::ONE] {
            let inverse = Complex::real(Ball::ONE) / (Complex::real(end) - mean);
            let by = rest.map(|z| z * inverse);
            let ratio = by.size();
            let is_small = ratio < 0.5;
            if !is_small {
                return sum.widen(f64::INFINITY);
            }
            let sign = if end.is_positive() { -Ball::ONE } else { Ball::ONE };
            let mut power = by;
            for k in 1..=MOST {
                sum = sum.plus(power.scale(sign / Ball::from(k as f64)));
                let size = power.size() * ratio;
                if size < SETTLED || k == MOST {
                    sum = sum.widen(2.0 * size * up::FEW);
                    break;
                }
                power = power.times(by);
            }
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// On the diagonal of a triangular matrix are the logarithms of its numbers, and in its corner their divided difference.
    #[test]
    fn a_logarithm_of_a_matrix_is_that_of_its_numbers() {
        let point = |re: f64, im: f64| Complex::new(Ball::from(re), Ball::from(im));
        let (a, b, corner) = (point(0.0375, 1.0), point(0.039, 1.0625), Ball::from(0.125));
        let found = Two([[a, Complex::real(corner)], [Complex::ZERO, b]]).logarithm();
        let [x, y] = [a, b].map(|z| z.logarithm());
        let difference = Complex::scale((x - y) / (a - b), corner);
        for (entry, truth, most) in
            [(found.0[0][0], x, 1e-26), (found.0[1][1], y, 1e-26), (found.0[0][1], difference, 1e-24)]
        {
            let off = entry - truth;
            assert!(off.re.contains_zero() && off.im.contains_zero() && off.magnitude() < most, "{entry:?} {truth:?}");
        }
    }

    /// On the path or on both sides of it, the integral is not known, nor below it, where the cut would be crossed;
    /// beyond an end it is the integral of real numbers.
    #[test]
    fn a_logarithm_on_the_path_is_unknown() {
        let at = |re: f64, im: Ball| Complex::new(Ball::from(re), im).logarithm();
        for im in [Ball::ZERO, Ball::ZERO.widen(0.1), -Ball::ONE] {
            assert!(!at(0.5, im).re.is_finite() && !at(0.5, im).im.is_finite());
        }
        let beyond = at(3.0, Ball::ZERO);
        // ln |-2 / -4|
        assert!((beyond.re + Ball::from(std::f64::consts::LN_2)).magnitude() < 1e-15 && beyond.im.magnitude() < 1e-30);
        assert!(at(0.5, Ball::from(1e-3)).re.is_finite());
    }
}
