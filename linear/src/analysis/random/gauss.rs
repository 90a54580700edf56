//! Gauss's rule with an error bound for functions that are known to be bounded in a complex neighbourhood. In: nothing. Out: nodes and
//! weights as enclosures. See docs/method/random.md#loss-factors.

use crate::base::{Ball, Dd, up};
use crate::kernel::big_float::Float;
use num_bigint::BigInt;
use std::sync::OnceLock;

/// The number of nodes.
pub const NODES: usize = 24;
/// The ellipse about -1 and 1 through 2 has these half-axes, the second one sqrt 3, and rho = 2 + sqrt 3.
pub const ACROSS: f64 = 2.0;
pub const UP_AND_DOWN: f64 = 1.732_050_807_568_877_4;
const RHO: f64 = 3.732;
/// Ranges of more than this ratio are cut in the geometric middle.
const WIDE: f64 = 4.0;

pub struct Rule {
    pub nodes: Vec<(Ball, Ball)>,
}

impl Rule {
    /// A bound of the rule's error over -1 .. 1 for a function with |f| <= `largest` in the ellipse (Trefethen,
    /// Approximation Theory and Approximation Practice, theorem 19.3).
    pub fn error(&self, largest: f64) -> f64 {
        let falls = (0..2 * (NODES - 1)).fold(1.0, |product, _| product / RHO);
        64.0 / 15.0 * largest * falls / (1.0 - 1.0 / (RHO * RHO)) * up::DOZENS
    }
}

/// The rule, computed once.
pub fn rule() -> &'static Rule {
    static RULE: OnceLock<Rule> = OnceLock::new();
    RULE.get_or_init(|| Rule { nodes: (0..NODES).map(node).collect() })
}

/// The place at which a range is cut if it is too wide; `None` if it cannot be cut.
pub fn cut(from: f64, to: f64) -> Option<f64> {
    let cut = if from > 0.0 && to > WIDE * from { (from * to).sqrt() } else { 0.5 * (from + to) };
    (from < cut && cut < to && to - from > 1e-13 * to).then_some(cut)
}

/// The coefficients of 2^n P(x) of x^n, x^(n-2) .., n the number of nodes: (-1)^k (n over k) (2 n - 2 k over n).
fn coefficients() -> Vec<BigInt> {
    let binomial = |n: usize, k: usize| (0..k).fold(BigInt::from(1), |product, i| product * (n - i) / (i + 1));
    let of =
        |k: usize| binomial(NODES, k) * binomial(2 * NODES - 2 * k, NODES) * if k.is_multiple_of(2) { 1 } else { -1 };
    (0..=NODES / 2).map(of).collect()
}

/// The Legendre polynomial and its derivative at an exact place; only the last operation rounds.
fn legendre(x: Dd) -> [Ball; 2] {
    let x = &Float::from(x.hi) + &Float::from(x.lo);
    let square = &x * &x;
    let (mut value, mut slope) = (Float::zero(), Float::zero());
    for (k, coefficient) in coefficients().into_iter().enumerate() {
        // The derivative is x times a polynomial in x^2, as the number of nodes is even.
        let power = NODES - 2 * k;
        value = &(&value * &square) + &Float::from(coefficient.clone());
        if power > 0 {
            slope = &(&slope * &square) + &Float::from(coefficient * power);
        }
    }
    let shrunk = |sum: Float| sum.times_power_of_two(-(NODES as i64)).to_ball(0.0);
    [shrunk(value), shrunk(&slope * &x)]
}

/// A node with its weight 2 / ((1 - x^2) P'(x)^2).
fn node(i: usize) -> (Ball, Ball) {
    /// P''(1), the largest value of the second derivative.
    const BEND: f64 = ((NODES - 1) * NODES * (NODES + 1) * (NODES + 2)) as f64 / 8.0;
    let mut x = Dd::from(libm::cos(std::f64::consts::PI * (i as f64 + 0.75) / (NODES as f64 + 0.5)));
    for _ in 0..5 {
        let [value, slope] = legendre(x);
        x -= value.mid / slope.mid;
    }
    let [value, slope] = legendre(x);
    // Between two places at which the signs differ; there are as many zeros as starts.
    let mut reach = (2.0 * value.magnitude() / slope.mignitude()).max(Dd::EPSILON);
    let sign = |x: Dd| {
        let [value, _] = legendre(x);
        i8::from(value.is_positive()) - i8::from(value.is_negative())
    };
    while sign(x - Dd::from(reach)) * sign(x + Dd::from(reach)) >= 0 {
        reach *= 2.0;
    }
    let reach = reach * up::FEW + Dd::EPSILON;
    let (x, slope) = (Ball::new(x, reach), slope.widen(reach * BEND));
    (x, Ball::from(2.0) / ((Ball::ONE - x * x) * slope * slope))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The rule is exact for polynomials up to the degree 47: the integral of x^k is 2 / (k + 1) or 0.
    #[test]
    fn powers_are_integrated_exactly() {
        for k in 0..2 * NODES {
            let power = |x: Ball| (0..k).fold(Ball::ONE, |product, _| product * x);
            let sum = rule().nodes.iter().fold(Ball::ZERO, |sum, (x, weight)| sum + power(*x) * *weight);
            let truth = if k % 2 == 0 { Ball::from(2.0) / Ball::from(k as f64 + 1.0) } else { Ball::ZERO };
            assert!((sum - truth).contains_zero() && sum.rad < rule().error(1.0), "{k}: {sum:?}");
        }
    }

    /// 1 / (x - 3) has the integral -ln 2, and is at most one in the ellipse through 2.
    #[test]
    fn the_error_is_below_its_bound() {
        let sum = rule().nodes.iter().fold(Ball::ZERO, |sum, (x, weight)| sum + *weight / (*x - Ball::from(3.0)));
        let off = (sum + Ball::LN_2).magnitude();
        assert!(off < rule().error(1.0) && rule().error(1.0) < 1e-25, "{off}");
    }
}
