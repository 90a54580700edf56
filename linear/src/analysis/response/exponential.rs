//! exp(A t) in double-double with a bound, by scaling and squaring. In: a matrix known to within `error` in the 2-norm,
//! and a bound `rate` of its logarithmic norm, so that |exp(A t)| <= e^(rate t): in energy coordinates a system without
//! sources has rate 0, and then errors only add up from squaring to squaring, but do not grow. See
//! docs/method/response.md.
//!
//! Scaled to |A h| <= 1/2, the Taylor polynomial of degree 24 has a remainder below 2 (1/2)^25 / 25! < 1e-32. It is
//! evaluated in eight products (Paterson and Stockmeyer 1973). With F = exp + e, |F^2 - exp^2| <= 2 |F| |e| + |e|^2,
//! and the norms of the computed powers are used, so that a decayed exponential keeps its relative error.

use crate::base::{Ball, Dd, Number, two_to, up};
use crate::kernel::dense::enclosure::norm_bound;
use crate::kernel::dense::{Matrix, add_scaled, dot};

/// A constant matrix of a linear system z' = A z.
#[derive(Clone, Debug)]
pub struct Generator {
    pub a: Matrix<Dd>,
    /// A bound of |true - a|.
    pub error: f64,
    /// A bound of the logarithmic norm of the true matrix.
    pub rate: f64,
    /// A bound of |true|.
    pub norm: f64,
}

/// exp(A t) for one t.
#[derive(Clone, Debug)]
pub struct Exponential {
    pub f: Matrix<Dd>,
    /// A bound of |exp(A t) - f|, 2-norm.
    pub error: f64,
    /// A bound of |exp(A t)|.
    pub norm: f64,
    /// A bound of the 2-norm of |f|.
    pub absolute_norm: f64,
}

/// A representation of exp(A t): exp(A h) for a short time h, and the number of times to square it.
pub struct Parts {
    pub power: Exponential,
    pub first: Ball,
    pub squarings: u32,
}

/// Twice the relative error of one operation.
const UNIT: f64 = 2.0 * Dd::EPSILON;
const UP: f64 = up::THOUSANDS;
/// Terms in a block of the polynomial, and blocks.
const BLOCK: usize = 5;
/// 2^100 times the fastest period is longer than any useful time.
const MOST_SQUARINGS: u32 = 100;

impl Generator {
    /// `None` if the exponent is out of range.
    pub fn exponential(&self, t: Ball) -> Option<Exponential> {
        let Parts { mut power, squarings, .. } = self.parts(t)?;
        for k in 1..=squarings {
            power = self.square_of(&power, t, squarings - k);
        }
        power.f.column(0).iter().all(|x| x.is_finite()).then_some(power)
    }

    /// exp(A h) for the longest h with |A h| <= 1/2; `None` if the exponent is out of range.
    pub fn parts(&self, t: Ball) -> Option<Parts> {
        let size = self.norm * t.magnitude() * 2.0;
        let mut squarings = 0u32;
        while size > two_to(squarings as i32) {
            squarings += 1;
            if squarings > MOST_SQUARINGS {
                return None;
            }
        }
        let scale = 1.0 / two_to(squarings as i32);
        let first = Ball::new(t.mid.scale(scale), t.rad * scale);
        Some(Parts { power: self.taylor(first), first, squarings })
    }

    /// A bound of |exp(A t)| for all t >= 0; `None` if no decay is proved. With powers of two of a short time h, any t is
    /// a sum of them and a rest below h; from the first time at which the norm is below one half, it repeats.
    pub fn bound_for_all_times(&self) -> Option<f64> {
        let h = if self.norm > 0.0 { 0.5 / self.norm } else { return None };
        let Parts { mut power, first, .. } = self.parts(Ball::from(h))?;
        let mut bound = growth(self.rate.max(0.0) * h);
        for k in 1..=MOST_SQUARINGS {
            if power.norm < 0.5 {
                return bound.is_finite().then_some(bound);
            }
            bound *= power.norm.max(1.0) * UP;
            power = square(&power, growth(self.rate * first.magnitude() * two_to(k as i32)));
        }
        None
    }

    /// The square of a power; `left` squarings later it is exp(A t).
    pub fn square_of(&self, power: &Exponential, t: Ball, left: u32) -> Exponential {
        let time = t.magnitude() / two_to(left as i32);
        square(power, growth(self.rate * time))
    }

    /// The Taylor polynomial of degree 24, for |A h| <= 1/2: five blocks of five terms, from the highest down.
    fn taylor(&self, h: Ball) -> Exponential {
        let n = self.a.rows();
        let mut powers = vec![self.a.map(|a| a * h.mid)];
        for k in 1..BLOCK {
            powers.push(multiply(&powers[k - 1], &powers[0]));
        }
        let mut coefficients = vec![Dd::ONE];
        for k in 1..BLOCK * BLOCK {
            coefficients.push(coefficients[k - 1] / Dd::from(k as f64));
        }
        let block = |from: usize| {
            let c = &coefficients[from..from + BLOCK];
            Matrix::from_fn(n, n, |i, j| {
                let one = if i == j { c[0] } else { Dd::ZERO };
                (1..BLOCK).rev().fold(Dd::ZERO, |sum, k| sum + c[k] * powers[k - 1][(i, j)]) + one
            })
        };
        let mut f = block(BLOCK * (BLOCK - 1));
        for k in (0..BLOCK - 1).rev() {
            f = add(&block(BLOCK * k), &multiply(&powers[BLOCK - 1], &f));
        }
        // Every entry is a sum of terms whose absolute values add up to less than exp(1/2), each rounded at most two
        // dozen times; the sums of n products are of powers from the second on, which stay below 0.15. Then the
        // remainder, and the uncertainty of A and h.
        let rounding = (0.5 * n as f64 + 40.0) * UNIT + 1e-32;
        let uncertain = (self.error * h.magnitude() + self.norm * h.rad) * 2.0;
        finish(f, (rounding + uncertain) * UP, growth(self.rate * h.magnitude()))
    }
}

/// An upper bound of e^x.
pub fn growth(x: f64) -> f64 {
    match Number::from(Ball::from(x)).exp() {
        Some(value) => value.to_ball().magnitude() * UP,
        None if x < 0.0 => f64::MIN_POSITIVE,
        None => f64::INFINITY,
    }
}

/// Fills in the norms: that of the computed matrix, or the bound from the rate if it is smaller.
fn finish(f: Matrix<Dd>, error: f64, allowed: f64) -> Exponential {
    let absolute_norm = norm_bound(f.rows(), f.columns(), |i, j| f[(i, j)].hi.abs() * UP);
    let norm = allowed.min((absolute_norm + error) * UP);
    Exponential { f, error, norm, absolute_norm }
}

fn square(e: &Exponential, allowed: f64) -> Exponential {
    let f = multiply(&e.f, &e.f);
    let rounding = (e.f.rows() as f64 + 4.0) * UNIT * e.absolute_norm * e.absolute_norm;
    let computed = e.absolute_norm.min(e.norm + e.error);
    let error = (2.0 * computed * e.error + e.error * e.error + rounding) * UP;
    let squared = (e.norm * e.norm) * UP;
    let mut next = finish(f, error, allowed.min(squared));
    next.norm = next.norm.min(squared);
    next
}

fn add(a: &Matrix<Dd>, b: &Matrix<Dd>) -> Matrix<Dd> {
    Matrix::from_fn(a.rows(), a.columns(), |i, j| a[(i, j)] + b[(i, j)])
}

impl Matrix<Dd> {
    /// A B; zeros of B are skipped.
    pub fn times(&self, b: &Matrix<Dd>) -> Matrix<Dd> {
        multiply(self, b)
    }

    /// A^T B
    pub fn transposed_times(&self, b: &Matrix<Dd>) -> Matrix<Dd> {
        Matrix::from_fn(self.columns(), b.columns(), |i, j| dot(self.column(i), b.column(j)))
    }
}

/// A B; zeros of B are skipped.
fn multiply(a: &Matrix<Dd>, b: &Matrix<Dd>) -> Matrix<Dd> {
    let mut c = Matrix::zeros(a.rows(), b.columns());
    for j in 0..b.columns() {
        for (k, &factor) in b.column(j).iter().enumerate() {
            if !factor.is_zero() {
                add_scaled(c.column_mut(j), factor, a.column(k));
            }
        }
    }
    c
}

#[cfg(test)]
mod tests {
    use super::*;

    /// exp of a rotation's generator gives cosines and sines, also after 1e6 turns.
    #[test]
    fn a_rotation_stays_one() {
        let a = Matrix::from_fn(2, 2, |i, j| match (i, j) {
            (0, 1) => Dd::ONE,
            (1, 0) => -Dd::ONE,
            _ => Dd::ZERO,
        });
        let generator = Generator { a, error: 0.0, rate: 0.0, norm: 1.0 };
        for t in [1.0, 1e6] {
            let e = generator.exponential(Ball::from(t)).expect("in range");
            let (s, c) = Number::from(Ball::from(t)).sin_cos().expect("in range");
            assert!((e.f[(0, 0)] - c.to_ball().mid).abs().to_f64() <= e.error + c.to_ball().rad);
            assert!((e.f[(0, 1)] - s.to_ball().mid).abs().to_f64() <= e.error + s.to_ball().rad);
            assert!(e.error < 1e-28 * t.max(1.0), "{:e}", e.error);
        }
    }

    /// A matrix far from normal: |exp(A t)| rises to about 50 t e^-t, at most 50 / e, before it decays. The product of the
    /// norms is far above that, and still a bound. Without decay nothing is claimed.
    #[test]
    fn a_bound_for_all_times() {
        let of = |rate: f64, coupling: f64| {
            let a = Matrix::from_fn(2, 2, |i, j| Dd::from([[rate, coupling], [0.0, rate]][i][j]));
            let generator = Generator { a, error: 0.0, rate: rate + coupling / 2.0, norm: rate.abs() + coupling };
            generator.bound_for_all_times()
        };
        let bound = of(-1.0, 50.0).expect("it decays");
        assert!((50.0 / std::f64::consts::E..1e8).contains(&bound), "{bound}");
        assert!(of(-1.0, 0.0).is_some_and(|bound| (1.0..1.001).contains(&bound)));
        assert_eq!(of(0.0, 0.0), None);
        assert_eq!(of(0.0, 1.0), None);
        assert_eq!(of(1e-3, 0.0), None);
    }

    /// An exponential that has decayed to e^-80 keeps its digits.
    #[test]
    fn a_decay_keeps_its_relative_error() {
        let a = Matrix::from_fn(1, 1, |_, _| Dd::from(-2.0));
        let generator = Generator { a, error: 0.0, rate: -2.0, norm: 2.0 };
        let e = generator.exponential(Ball::from(40.0)).expect("in range");
        let truth = Number::from(Ball::from(-80.0)).exp().expect("in range").to_ball();
        assert!((e.f[(0, 0)] - truth.mid).abs().to_f64() <= e.error + truth.rad);
        assert!(e.error < 1e-25 * truth.to_f64());
    }
}
