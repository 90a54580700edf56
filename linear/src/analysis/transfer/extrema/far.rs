//! Roots of which is known only how many there are at most, and how far away: the highest coefficient of a polynomial may
//! vanish, and then a root is at infinity. In: a number and a distance. Out: what they change in the slope of ln |H| and
//! in H. See docs/method/transfer.md#extrema.

use crate::base::{down, larger, up};

/// At most `count` roots, zeros or poles, none within `beyond` of zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Far {
    pub count: usize,
    /// rad/s
    pub beyond: f64,
}

/// The largest count times omega / beyond for which the spread is stated.
const NEAR: f64 = 0.25;

impl Far {
    pub const NONE: Far = Far { count: 0, beyond: f64::INFINITY };

    /// The far roots of two polynomials together.
    pub fn and(self, other: Far) -> Far {
        Far { count: self.count + other.count, beyond: -larger(-self.beyond, -other.beyond) }
    }

    /// Bounds of what they add to g, to g' and to g'' / 2 below omega: a root z adds the real part of 1 / (omega + i z).
    pub fn slopes(self, omega: f64) -> [f64; 3] {
        if self.count == 0 {
            return [0.0; 3];
        }
        let distance = (self.beyond - omega) * down::FEW;
        if distance.is_nan() || distance <= 0.0 {
            return [f64::INFINITY; 3];
        }
        let first = self.count as f64 / distance * up::DOZENS;
        [first, first / distance * up::FEW, first / distance / distance * up::FEW]
    }

    /// A bound of |prod (1 - s / z) - 1| and of |prod 1 / (1 - s / z) - 1| at |s| = omega, infinite unless they are far
    /// away: (1 - x)^-m - 1 <= 2 m x for m x <= 1/4.
    pub fn spread(self, omega: f64) -> f64 {
        if self.count == 0 {
            return 0.0;
        }
        let ratio = self.count as f64 * (omega / self.beyond) * up::DOZENS;
        if ratio <= NEAR { 2.0 * ratio } else { f64::INFINITY }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::complex::Complex;

    /// Roots at the least distance, in several directions, alone and three together: the sums and products themselves.
    #[test]
    fn what_far_roots_change_is_bounded() {
        for (count, unit) in [(1, 1.0), (3, 1.0), (3, 1.0 / 65536.0)] {
            let far = Far { count, beyond: 100.0 * unit };
            for omega in [0.0, 0.5, 5.0, 8.0].map(|omega| omega * unit) {
                let [g, slope, curvature] = far.slopes(omega);
                for direction in [0.0, 0.7, 1.6, 2.5, 3.1] {
                    let z = Complex::new(libm::cos(direction), libm::sin(direction)).scale(100.0 * unit);
                    let from = Complex::new(omega - z.im, z.re).recip();
                    let n = count as f64;
                    assert!(n * from.re.abs() <= g && n * (from * from).re.abs() <= slope);
                    assert!(n * (from * from * from).re.abs() <= curvature);
                    let one = Complex::new(1.0, 0.0) - Complex::new(0.0, omega) * z.recip();
                    let product = (1..count).fold(one, |product, _| product * one);
                    let off = [product, product.recip()].map(|x| (x - Complex::new(1.0, 0.0)).abs());
                    assert!(off.into_iter().all(|off| off <= far.spread(omega) + 1e-15), "{omega} {direction}");
                }
            }
            assert_eq!(far.slopes(100.0 * unit), [f64::INFINITY; 3]);
            assert_eq!(far.spread(50.0 * unit), f64::INFINITY);
        }
        assert_eq!((Far::NONE.slopes(1e300), Far::NONE.spread(1e300)), ([0.0; 3], 0.0));
    }

    /// Beyond the nearest of them nothing is bounded; of two polynomials, roots are as many as of both, and as near as the nearest.
    #[test]
    fn far_roots_of_two_polynomials_are_counted_together() {
        let [a, b] = [(2, 100.0), (3, 70.0)].map(|(count, beyond)| Far { count, beyond });
        for both in [a.and(b), b.and(a)] {
            assert_eq!((both.count, both.beyond), (5, 70.0));
            assert_eq!((both.slopes(120.0), both.spread(120.0)), ([f64::INFINITY; 3], f64::INFINITY));
        }
        assert_eq!(a.and(Far::NONE), a);
        assert!(a.and(Far { count: 1, beyond: f64::NAN }).slopes(1.0).iter().all(|x| *x == f64::INFINITY));
    }
}
