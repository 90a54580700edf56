//! The double pole of free motions: r / s^2 = -r / omega^2. In: r. Out: what it adds to values, Taylor polynomials and bounds.

use super::DEGREE;
use super::sums::TaylorSums;
use crate::base::{Ball, Dd, Power, up};

/// r
#[derive(Clone, Copy, Debug)]
pub struct AtZero(pub Ball);

impl AtZero {
    pub fn is_none(self) -> bool {
        self.0.is_zero()
    }

    /// The value and the slope at a frequency, and bounds of their errors.
    pub fn at(self, omega: Dd) -> [Ball; 2] {
        if self.is_none() {
            return [Ball::ZERO; 2];
        }
        let omega = Ball::exact(omega);
        let value = -(self.0 / (omega * omega));
        [value, -(value + value) / omega]
    }

    /// Bounds of the size of both at frequencies of at least `omega`, rad/s.
    pub fn most(self, omega: f64) -> [f64; 2] {
        if self.is_none() {
            return [0.0; 2];
        }
        let value = self.0.magnitude() / (omega * omega) * up::DOZENS;
        [value, 2.0 * value / omega * up::DOZENS]
    }

    /// Adds -r / (m + half t)^2 = -r / m^2 sum (k + 1) (-half t / m)^k, for |half / m| <= 1/2.
    pub fn add_to(self, sums: &mut TaylorSums, middle: Dd, half: f64) {
        if self.is_none() {
            return;
        }
        let (m, r) = (middle.to_f64(), self.0);
        let [mut term, step] = [self.at(middle)[0].mid, Dd::from(-half) / middle];
        for (k, sum) in sums.coefficients.iter_mut().enumerate() {
            sum.re += term * Dd::from((k + 1) as f64);
            term = term * step;
        }
        let q = (half / m.abs()) * up::DOZENS;
        let sum = 1.0 / (1.0 - q);
        // sum (k + 1) q^k, and with k and k (k - 1), from 0 on and from DEGREE + 1 on.
        let weights = [sum * sum, 2.0 * q * sum.power(3), 6.0 * q * q * sum.power(4)];
        let (power, n) = (q.power(DEGREE as i32 + 1), DEGREE as f64);
        let tails = [sum * sum, (n + 1.0) * sum.power(3), n * (n + 1.0) * sum.power(4)];
        let (size, doubt) = (r.magnitude() / (m * m), r.rad / (m * m));
        for k in 0..3 {
            sums.sizes[k] += size * weights[k] * up::DOZENS;
            sums.doubts[k] += doubt * weights[k] * up::DOZENS;
            sums.cut[k] += size * power * (n + 2.0) * tails[k] * up::DOZENS;
        }
    }
}
