//! H of one input and one output as a sum over poles, with a bound of the error of the sum:
//!
//! ```text
//! H(s) = sum r_j / (s - s_j) + e_0 + e_1 s + e_2 s^2 + e_3 s^3 + rest,
//! |rest| <= sum_j sum_m q_jm |s|^m / |s - s_j|
//! ```
//!
//! at every frequency, and within half the distance from it to the nearest pole, so that Cauchy's formula bounds the
//! derivatives of the rest. In: a system and the residues of its poles, or other [sums](Given). Out: H and its derivative with respect to omega
//! at a frequency in double-double, and Taylor polynomials about one in binary64. See
//! docs/method/transfer.md#sum-over-poles.

mod at_zero;
mod expansion;
mod sums;

use crate::analysis::poles::residues::Residues;
use crate::analysis::transfer::{Disc, Frequency, Gain, feed_through};
use crate::base::{Ball, Dd, Power, up};
use crate::kernel::complex::Complex;
use crate::system::LinearSystem;
use at_zero::AtZero;
pub use expansion::{Expander, Expansion, Obstacle, size};
use sums::{Lined, near_sums, nearest, sums};

/// H of one input and one output.
#[derive(Clone, Debug)]
pub struct PartialFractions {
    terms: Vec<Term>,
    lined: Lined,
    /// The coefficients of powers of s.
    polynomial: [Ball; 4],
    at_zero: AtZero,
    part: Part,
    /// The highest frequency at which the sum is H, rad/s, and bounds up to there of what else it and its first two derivatives are
    /// off by.
    reach: f64,
    flat: [f64; 3],
}

/// Whether H is known to be real, or imaginary, at every frequency.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    Real,
    Imaginary,
    Both,
}

/// A pole, one of each conjugate pair: it contributes sum_m products[m] s^m / (s - pole) to H.
pub struct Given {
    pub s: Complex<Dd>,
    /// A bound of the distance of the pole from `s`, on the same axis. Zero for a pole off both axes: such an `s` is exact.
    pub loose: f64,
    pub products: [Complex<Ball>; 5],
    /// The bounds q of the rest.
    pub rest: [f64; 5],
}

/// r / (s - s_j), of a pole or of its conjugate.
#[derive(Clone, Copy, Debug)]
struct Term {
    s: Complex<Dd>,
    r: Complex<Dd>,
    /// A bound of |r|, one of the error of r, and one of the distance of the pole from s.
    size: f64,
    doubt: f64,
    loose: f64,
    /// The bounds q of the rest.
    rest: [f64; 5],
}

/// H and dH/domega at a frequency.
#[derive(Clone, Copy, Debug)]
pub struct Local {
    pub h: Complex<Dd>,
    pub slope: Complex<Dd>,
    /// Bounds of the errors of both.
    pub errors: [f64; 2],
}

/// The largest uncertainty of a pole's place relative to its distance.
const MOST_BLUR: f64 = 1e-3;

/// The degree of Taylor polynomials.
pub const DEGREE: usize = 16;

impl PartialFractions {
    /// `None` if a bound is not finite.
    pub fn of(system: &LinearSystem, residues: &Residues, input: usize, output: usize) -> Option<PartialFractions> {
        let (excited, seen) = (residues.inputs.get(input)?, residues.outputs.get(output)?);
        let given = residues.poles.iter().enumerate().map(|(j, &s)| {
            let mut given = Given { s, loose: 0.0, products: [Complex::<Ball>::ZERO; 5], rest: [0.0; 5] };
            for (a, seen) in seen.iter().enumerate() {
                for (b, excited) in excited.iter().enumerate() {
                    let (Some(seen), Some(excited)) = (seen, excited) else { continue };
                    given.products[a + b] = given.products[a + b] + seen[j] * excited.amplitudes[j];
                    given.rest[a + b] += seen[j].magnitude() * excited.rest[j] * up::FEW;
                }
            }
            given
        });
        PartialFractions::of_poles(given, [Ball::ZERO; 5], feed_through(&system.outputs[output], input), Part::Both)
    }

    /// `None` if a bound is not finite. `free` are the products of the double pole at zero, by power of s.
    pub fn of_poles(
        list: impl Iterator<Item = Given>,
        free: [Ball; 5],
        through: [Ball; 3],
        part: Part,
    ) -> Option<PartialFractions> {
        let mut polynomial = [through[0], through[1], through[2], Ball::ZERO];
        // s^m / s^2 is 1 / s for m = 1, and a power of s beyond.
        for (power, &product) in free[2..].iter().enumerate() {
            polynomial[power] = polynomial[power] + product;
        }
        let mut terms = Vec::new();
        if !free[1].is_zero() {
            let (s, r) = (Complex::ZERO, Complex::real(free[1]));
            terms.push(Term { s, r: r.mid(), size: r.magnitude(), doubt: r.radius(), loose: 0.0, rest: [0.0; 5] });
        }
        for Given { s, loose, products, rest } in list {
            let is_real = s.im.is_zero();
            let along = |x: Dd| if x.is_zero() { Ball::ZERO } else { Ball::new(x, loose) };
            let pole = Complex::new(along(s.re), along(s.im));
            // s^m / (s - s_j) = s_j^m / (s - s_j) + s_j^(m - 1) + s_j^(m - 2) s + .. + s^(m - 1)
            let mut r = Complex::<Ball>::ZERO;
            for (m, &product) in products.iter().enumerate() {
                let mut scaled = product;
                for power in (0..m).rev() {
                    let both = if is_real { scaled.re } else { scaled.re * Ball::from(2.0) };
                    polynomial[power] = polynomial[power] + both;
                    scaled = scaled * pole;
                }
                r = r + scaled;
            }
            let term = Term { s, r: r.mid(), size: r.magnitude(), doubt: r.radius(), loose, rest };
            terms.push(term);
            if !is_real {
                terms.push(Term { s: s.conj(), r: r.mid().conj(), ..term });
            }
        }
        let finite = |term: &Term| term.size.is_finite() && term.rest.iter().all(|x| x.is_finite());
        let known = terms.iter().all(finite) && polynomial.iter().chain(&free).all(Ball::is_finite);
        if !known {
            return None;
        }
        let (lined, at_zero) = (Lined::of(&terms), AtZero(free[0]));
        Some(PartialFractions { lined, terms, polynomial, at_zero, part, reach: f64::INFINITY, flat: [0.0; 3] })
    }

    /// This sum where it is H up to a frequency alone, rad/s, and is off by more: by `flat`, and so are its derivatives.
    pub fn over(self, reach: f64, flat: [f64; 3]) -> Option<PartialFractions> {
        flat.iter().all(|x| x.is_finite()).then_some(PartialFractions { reach, flat, ..self })
    }

    /// The highest frequency at which the sum is H, rad/s.
    pub fn reach(&self) -> f64 {
        self.reach
    }

    /// What is not zero of a value of H; `None` if both parts may be.
    pub fn only_part(&self, h: Complex<f64>) -> Option<f64> {
        match self.part {
            Part::Real => Some(h.re),
            Part::Imaginary => Some(h.im),
            Part::Both => None,
        }
    }

    /// The number of poles.
    pub fn count(&self) -> usize {
        self.terms.len()
    }

    /// The largest |s_j|, rad/s.
    pub fn largest(&self) -> f64 {
        self.terms.iter().map(|term| term.s.to_f64().abs()).fold(0.0, f64::max)
    }

    /// Whether H is zero as far as the sum shows: the output sees no motion that the input drives.
    pub fn is_nothing(&self) -> bool {
        self.terms.iter().all(|term| term.size == 0.0)
            && self.polynomial.iter().all(Ball::is_zero)
            && self.at_zero.is_none()
    }

    /// A lower bound of the distance of a frequency from the nearest pole, rad/s.
    pub fn clearance(&self, omega: Dd) -> f64 {
        let least = nearest(&self.lined, omega).1[0].sqrt() * (1.0 - 1e-12);
        if self.at_zero.is_none() { least } else { least.min(omega.to_f64().abs()) }
    }

    /// Whether a motion is free: |H| is infinite at zero.
    pub fn is_infinite_at_zero(&self) -> bool {
        !self.at_zero.is_none() || self.terms.iter().any(|term| term.s == Complex::ZERO)
    }

    /// Bounds of the rest and of its first two derivatives at frequencies between `omega` - `half` and `omega` + `half`, given
    /// the sums over `terms` of q_m / |i omega - s_j| at `omega`, where every pole is at least twice as far as `half`.
    fn rest(&self, sums: [f64; 5], omega: f64, half: f64, clearance: f64) -> [f64; 3] {
        // Distances of poles are at least half as large anywhere in the interval, and half of that in the disc of Cauchy's
        // formula about a point in it.
        let radius = 0.25 * clearance;
        let reach = omega.abs() + half + radius;
        let most = 4.0 * sums.iter().rev().fold(0.0, |sum, &q| sum * reach + q);
        [most, most / radius, 2.0 * most / (radius * radius)].map(|bound| bound * up::MILLIONS)
    }

    /// H and dH/domega at a frequency, rad/s.
    pub fn at(&self, omega: Dd) -> Local {
        let sums = sums(&self.lined, omega);
        let count = (4 * self.terms.len() + 64) as f64 * Dd::EPSILON;
        let w = omega.to_f64().abs() * up::FEW;
        let mut errors = [0, 1].map(|k| (sums.sizes[k] * count + sums.doubts[k]) * up::MILLIONS);
        let rest = self.rest(sums.rests, w, 0.0, self.clearance(omega));
        // d/domega of 1 / (i omega - s) is -i / (i omega - s)^2.
        let mut h = sums.first;
        let mut slope = Complex::new(sums.second.im, -sums.second.re);
        let [e0, e1, e2, e3] = self.polynomial.map(|e| e.mid);
        let square = omega * omega;
        h = h + Complex::new(e0 - e2 * square, (e1 - e3 * square) * omega);
        slope = slope + Complex::new(-(e2 * omega).scale(2.0), e1 - e3 * square * Dd::from(3.0));
        let [value, steepness] = self.at_zero.at(omega);
        (h.re, slope.re) = (h.re + value.mid, slope.re + steepness.mid);
        for (error, ball) in errors.iter_mut().zip([value, steepness]) {
            *error += ball.rad + 64.0 * Dd::EPSILON * ball.magnitude();
        }
        let loose = self.polynomial.map(|e| e.rad + 64.0 * Dd::EPSILON * e.magnitude());
        let powers = [1.0, w, w * w, w * w * w];
        for power in 0..4 {
            errors[0] += loose[power] * powers[power];
            if power > 0 {
                errors[1] += power as f64 * loose[power] * powers[power - 1];
            }
        }
        let errors = [0, 1].map(|k| (errors[k] + rest[k] + self.flat[k]) * up::DOZENS + f64::MIN_POSITIVE);
        Local { h, slope, errors }
    }

    /// Approximations of H and dH/domega in binary64, to steer a search.
    pub fn near(&self, omega: Dd) -> [Complex<f64>; 2] {
        let [mut h, mut slope] = near_sums(&self.lined, omega);
        let w = omega.to_f64();
        let [e0, e1, e2, e3] = self.polynomial.map(|e| e.to_f64());
        h = h + Complex::new(e0 - e2 * w * w, (e1 - e3 * w * w) * w);
        slope = slope + Complex::new(-2.0 * e2 * w, e1 - 3.0 * e3 * w * w);
        let [value, steepness] = self.at_zero.at(omega).map(|ball| ball.to_f64());
        (h.re, slope.re) = (h.re + value, slope.re + steepness);
        [h, slope]
    }

    /// H at a frequency; unknown if it is too close to a pole.
    pub fn gain(&self, frequency: &Frequency) -> Gain {
        let omega = frequency.omega;
        let (clearance, reach) = (self.clearance(omega.mid), omega.rad);
        let is_clear = 4.0 * reach <= clearance && omega.magnitude() <= self.reach;
        if !is_clear {
            return Gain::Unknown;
        }
        let local = self.at(omega.mid);
        // Over the ball |dH/domega| is at most 4 sum |r| / |i omega - s|^2, and that of the polynomial, and of the rest.
        let steepest = 4.0 * sums(&self.lined, omega.mid).sizes[1]
            + 4.0 * self.at_zero.most(omega.to_f64().abs())[1]
            + (1..4)
                .map(|l| l as f64 * self.polynomial[l].magnitude() * omega.magnitude().power(l as i32 - 1))
                .sum::<f64>();
        let radius = (local.errors[0] + reach * (steepest * up::MILLIONS + local.errors[1])) * up::MILLIONS;
        let disc = Disc { value: local.h, radius };
        let finite = radius.is_finite() && local.h.re.is_finite() && local.h.im.is_finite();
        if finite { Gain::Finite(disc) } else { Gain::Unknown }
    }
}

#[cfg(test)]
mod tests;
