//! One oscillator under a polynomial acceleration of its base: its state after a step, and its motion in between as a
//! polynomial. See docs/method/shock.md#steps.
//!
//! The state is (x, v) with x = omega y and v = y', where y is by how much the mass lags behind the base:
//! y'' + 2 zeta omega y' + omega^2 y = a. Both have one unit, and without an acceleration x^2 + v^2 never grows.

use crate::base::{Ball, Power};

/// omega h max(1, 2 zeta) of a step is at most this.
pub const LONGEST: f64 = 0.5;
/// Terms of the series for the entries of a step: with |x| <= 1/2 the rest is below 2^-20 / 20!, 4e-25.
const TERMS: usize = 20;
/// The most terms of the motion within a step, and the least; the rest is bounded by the last two.
const MOTION_TERMS: usize = 20;
const LEAST_TERMS: usize = 8;
/// Further terms would be smaller than rounding errors by this factor.
const NEGLIGIBLE: f64 = 1e-18;

/// Exact entries of a step: x' = a11 x + a12 v + sum f_k d_k, v' = -a12 x + a22 v + sum g_k d_k, for the derivatives d_k of
/// the acceleration at its start.
pub struct Step {
    pub own: [Ball; 3],
    /// (f_k, g_k)
    pub forcing: Vec<(Ball, Ball)>,
}

/// 1 / n!
pub struct Factorials(Vec<Ball>);

impl Factorials {
    pub fn new(most: usize) -> Factorials {
        let mut list = vec![Ball::ONE];
        for n in 1..=most {
            list.push(list[n - 1] / Ball::from(n as f64));
        }
        Factorials(list)
    }
}

/// Number of factorials that a step with this many derivatives needs.
pub fn factorials_for(derivatives: usize) -> usize {
    TERMS + derivatives + 2
}

/// Entries for a step of length h, with omega h max(1, 2 zeta) <= 1/2.
///
/// With g the motion after an impulse of the acceleration and p_k the one under t^k / k!, p_(-1) = g and p_k' = p_(k-1), so that
/// p_(k-2) = h^k / k! - 2 zeta omega p_(k-1) - omega^2 p_k: two series, and the rest follows downwards.
pub fn step(omega: Ball, damping: Ball, h: Ball, derivatives: usize, factorials: &Factorials) -> Step {
    let theta = omega * h;
    let twice = damping * Ball::from(2.0);
    let top = derivatives.max(1) - 1;
    // g^(j) = omega^(j-1) c_j: c_1 = 1, c_(j+2) = -2 zeta c_(j+1) - c_j.
    let (mut before, mut now, mut power) = (Ball::ZERO, Ball::ONE, Ball::ONE);
    let mut sums = [Ball::ZERO; 2];
    for j in 1..=TERMS {
        let term = power * now;
        for (k, sum) in sums.iter_mut().enumerate() {
            // p_top, and p_(top-1).
            *sum = *sum + term * factorials.0[j + top + 1 - k];
        }
        (before, now) = (now, -(twice * now) - before);
        power = power * theta;
    }
    // |theta^j c_(j+1)| <= (theta (1 + 2 zeta))^j, at most 1.
    let rest = (3.0 * theta.magnitude().max((theta * twice).magnitude())).min(1.0).power(TERMS as i32)
        * (factorials.0[TERMS + top].mid.hi * 1.1);
    let mut powers = vec![Ball::ONE];
    for k in 0..=top + 1 {
        powers.push(powers[k] * h);
    }
    // p[k + 2] is p_k, from p_(-2) = g' on.
    let mut p = vec![Ball::ZERO; top + 3];
    p[top + 2] = sums[0].widen(rest) * powers[top + 2];
    p[top + 1] = sums[1].widen(rest) * powers[top + 1];
    let (rate, square) = (twice * omega, omega.square());
    for k in (0..=top).rev() {
        p[k] = powers[k] * factorials.0[k] - rate * p[k + 1] - square * p[k + 2];
    }
    let forcing = (0..=top).map(|k| (omega * p[k + 2], p[k + 1])).collect();
    Step { own: [Ball::ONE - square * p[2], omega * p[1], p[0]], forcing }
}

/// The step of twice the length h of a step: in its second half the derivatives are sum d_k h^(k - i) / (k - i)!.
pub fn double_step(step: &Step, h: Ball, factorials: &Factorials) -> Step {
    let [a11, a12, a22] = step.own;
    let cross = a12.square();
    let own = [a11.square() - cross, a12 * (a11 + a22), a22.square() - cross];
    let mut powers = vec![Ball::ONE];
    for k in 1..step.forcing.len() {
        powers.push(powers[k - 1] * h);
    }
    let forcing = |k: usize| {
        let (x, v) = step.forcing[k];
        (0..=k).fold((a11 * x + a12 * v, a22 * v - a12 * x), |(x, v), i| {
            let (factor, (f, g)) = (powers[k - i] * factorials.0[k - i], step.forcing[i]);
            (x + factor * f, v + factor * g)
        })
    };
    Step { own, forcing: (0..step.forcing.len()).map(forcing).collect() }
}

/// x within a step as a polynomial in s = t / h, from 0 to 1, and a bound of the rest and of rounding; `shape`: 2 zeta omega h,
/// (omega h)^2, omega h.
pub fn within_step(state: [f64; 2], [damped, square, theta]: [f64; 3], h: f64, derivatives: &[f64]) -> (Vec<f64>, f64) {
    let mut terms = vec![state[0], theta * state[1]];
    let mut parts = terms[0].abs() + 2.0 * terms[1].abs();
    let mut power = theta * h;
    for j in 0..MOTION_TERMS - 2 {
        if terms.len() >= LEAST_TERMS.max(derivatives.len() + 2) && last_two(&terms) < NEGLIGIBLE * parts {
            break;
        }
        let d = derivatives.get(j).map_or(0.0, |d| d * power);
        power *= h / (j as f64 + 1.0);
        let (first, second) = (damped * (j as f64 + 1.0) * terms[j + 1], square * terms[j]);
        let scale = 1.0 / ((j + 1) as f64 * (j + 2) as f64);
        terms.push((d - first - second) * scale);
        parts += (d.abs() + first.abs() + second.abs()) * scale;
    }
    // With eight terms a further one is at most (1/2) / 8 of the last and 1/4 / (7 8) of the one before it.
    let rest = last_two(&terms) * 0.1;
    // Each term is off by some ten units of its parts, and by half the error of both before it.
    (terms, (rest + 64.0 * f64::EPSILON * parts) * 1.001)
}

/// The larger of the last two terms.
fn last_two(terms: &[f64]) -> f64 {
    terms.iter().rev().take(2).fold(0.0, |largest, term| f64::max(largest, term.abs()))
}
