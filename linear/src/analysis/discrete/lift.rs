//! Two states as a lifted step: v <- v - c v - k x + g u, x <- x + p v (both with the opposite sign if the motion turns
//! by more than a quarter of a period). In: the step of a block. Out: c, k, p in the precision of the target, and
//! coordinates in which F has that form; nothing if F is nearly a multiple of one, which has no such form.
//!
//! The determinant of the step is 1 - c and |1 - lambda|^2 is p k, whatever c, k and p are: c is rounded with its own
//! relative error, and only the product of k and p matters, so k is chosen among neighbours such that p rounds well. So
//! amplitude and phase drift far less than if each entry of a rotation were rounded (lifting: Bruekers and van den
//! Enden, IEEE JSAC 10 (1992) 129), and near-critical and critical damping need no other form. See docs/method/emit.md.

use crate::analysis::discrete::precision::Precision;
use crate::analysis::discrete::turn::Turn;
use crate::base::{Dd, Power};
use crate::kernel::dense::Matrix;
use crate::kernel::simd::simd;

/// The step of a pair of states.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lift {
    /// Whether the motion turns by more than a quarter of a period: F is minus the lifted step.
    pub turned: bool,
    pub decay: Decay,
    pub k: f64,
    pub p: f64,
}

/// The remaining part of v: v - c v, or r v.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Decay {
    Lose(f64),
    Keep(f64),
}

impl Decay {
    /// The number c or r.
    pub fn value(self) -> f64 {
        match self {
            Decay::Lose(value) | Decay::Keep(value) => value,
        }
    }
}

/// A lifted step and its coordinates (x, v) = s w.
#[derive(Clone, Debug)]
pub struct Lifted {
    pub lift: Lift,
    pub s: Matrix<Dd>,
}

/// A motion that decays faster than this in a step has nothing left that a lifted form could preserve.
const LEAST: f64 = 1e-10;

/// Square root of the golden ratio.
const GOLDEN_ROOT: f64 = 1.272019649514069;

/// Neighbours that are tried for k: the best product is accurate to twelve bits more than the precision.
const TRIALS: u32 = 4096;

/// Rows x and v closer than this (sine of the angle between them) are not usable as coordinates: F is nearly a multiple
/// of one, for which every x gives such rows.
const LEAST_ANGLE: f64 = 0.05;

/// F in lifted form, if possible in coordinates in which the input `drive` (a column of w) acts only on v, with factor
/// one.
pub fn lift(turn: &Turn, drive: Option<[Dd; 2]>, precision: Precision) -> Option<Lifted> {
    let (lost, product) = (turn.lost, turn.product);
    let det = Dd::ONE - lost;
    if product.hi < 0.0 || det.hi <= LEAST {
        return None;
    }
    let (k, p) = factors(product, det, precision);
    let decay = if det.hi > 0.25 { Decay::Lose(precision.round(lost)) } else { Decay::Keep(precision.round(det)) };
    let lift = Lift { turned: turn.turned, decay, k, p };
    let s = coordinates(turn, det, Dd::from(p), drive)?;
    Some(Lifted { lift, s })
}

simd! {
    /// k and p with k p = product, balanced by p det = k.
    fn factors(product: Dd, det: Dd, precision: Precision) -> (f64, f64) {
        if product.hi == 0.0 {
            return (0.0, 1.0);
        }
        let root = det.hi.clamp(0.01, 1.0).sqrt();
        // If k is one unit in the last place larger, p is 0.618 units smaller: so the trials are spread evenly (golden
        // ratio), while for k = p they would all round alike.
        let start = product.hi.sqrt() * root * GOLDEN_ROOT;
        let mut best = (start, f64::INFINITY, 0.0);
        let mut k = precision.round(Dd::from(start));
        for _ in 0..TRIALS {
            // The quotient of two words by one, to the last digit but for a rare rounding; of the difference of near numbers the
            // operation loses nothing that counts.
            let quotient = product.hi / k;
            let rest = (-quotient).mul_add(k, product.hi) + product.lo;
            let p = precision.round(Dd::from(quotient + rest / k));
            let error = (k.mul_add(p, -product.hi) - product.lo).abs();
            if error < best.1 {
                best = (k, error, p);
            }
            k = precision.next(k);
        }
        (best.0, best.2)
    }
}

/// Rows x and v with x' = x + p v', v' = det v - k x: x can be any row that is not a left eigenvector; v = x (1 - F^-1)
/// / p, and 1 - F^-1 = (E + det E) / det F with F = 1 + E.
fn coordinates(turn: &Turn, det: Dd, p: Dd, drive: Option<[Dd; 2]>) -> Option<Matrix<Dd>> {
    let step = &turn.change;
    let inverse = Matrix::from_fn(2, 2, |i, j| {
        let entry = if i == j { Dd::ONE + step[(1 - i, 1 - j)] } else { -step[(i, j)] };
        entry / det
    });
    let rows = |x: [Dd; 2]| {
        let change = |j: usize| {
            let terms = [x[j] * turn.product, x[0] * step[(0, j)], x[1] * step[(1, j)]];
            let sum = terms[0] + terms[1] + terms[2];
            let size: f64 = terms.iter().map(|x| x.hi.abs()).sum();
            // A result within rounding error of zero is zero.
            if sum.hi.abs() <= 1e-26 * size { Dd::ZERO } else { sum / (p * det) }
        };
        [x, [change(0), change(1)]]
    };
    // Independence of the rows, measured in coordinates balanced by the magnitude of the motion.
    let balance = (step[(0, 1)].hi.abs() / step[(1, 0)].hi.abs()).sqrt();
    let balance = if balance.is_finite() && balance > 0.0 { balance } else { 1.0 };
    let independence = |s: [[Dd; 2]; 2]| {
        let length = |r: [Dd; 2]| hypotenuse(r[0].hi * balance, r[1].hi);
        let det = (s[0][0] * s[1][1] - s[0][1] * s[1][0]).hi.abs() * balance;
        det / (length(s[0]) * length(s[1]))
    };
    let mut plain = rows([Dd::ONE, Dd::ZERO]);
    let other = rows([Dd::ZERO, Dd::ONE]);
    if independence(plain) < 0.3 * independence(other) {
        plain = other;
    }
    if independence(plain).is_nan() || independence(plain) < LEAST_ANGLE {
        return None;
    }
    let mut chosen = plain;
    if let Some(g) = drive {
        // x F^-1 g = 0: then the input's contribution to x' is p times that to v'.
        let back = [0, 1].map(|i| inverse[(i, 0)] * g[0] + inverse[(i, 1)] * g[1]);
        let driven = rows([back[1], -back[0]]);
        if independence(driven) >= 0.3 * independence(plain) {
            chosen = driven;
        }
    }
    let mut scale = Dd::from(1.0 / hypotenuse(chosen[1][0].hi * balance, chosen[1][1].hi));
    if let Some(g) = drive {
        let on_v = chosen[1][0] * g[0] + chosen[1][1] * g[1];
        let alone = (chosen[0][0] * g[0] + chosen[0][1] * g[1] - p * on_v).hi.abs() <= 1e-20 * (p * on_v).hi.abs();
        if alone && on_v.hi != 0.0 && (1e-12..1e12).contains(&(on_v.hi.abs() * scale.hi)) {
            scale = Dd::ONE / on_v;
        }
    }
    let s = Matrix::from_fn(2, 2, |i, j| chosen[i][j] * scale);
    (0..2).all(|j| s.column(j).iter().all(|x| x.is_finite())).then_some(s)
}

/// The hypotenuse, written out so that it is the same on every machine.
fn hypotenuse(a: f64, b: f64) -> f64 {
    let most = a.abs().max(b.abs());
    if most == 0.0 { 0.0 } else { most * ((a / most).power(2) + (b / most).power(2)).sqrt() }
}

impl Lift {
    /// The step as a matrix on (x, v), with the rounded coefficients.
    pub fn matrix(&self) -> Matrix<Dd> {
        let (k, p) = (Dd::from(self.k), Dd::from(self.p));
        let keep = match self.decay {
            Decay::Lose(c) => Dd::ONE - Dd::from(c),
            Decay::Keep(r) => Dd::from(r),
        };
        let sign = if self.turned { -Dd::ONE } else { Dd::ONE };
        Matrix::from_fn(2, 2, |i, j| {
            sign * match (i, j) {
                (0, 0) => Dd::ONE - p * k,
                (0, 1) => p * keep,
                (1, 0) => -k,
                _ => keep,
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::discrete::block::product;
    use crate::analysis::discrete::hold::propagator;
    use crate::analysis::discrete::turn::turn;

    /// Undamped and damped oscillators, slow and fast relative to the step, critical and rigid: the lifted step is F in
    /// other coordinates.
    #[test]
    fn the_lifted_step_is_the_propagator() {
        for (k, c) in
            [(1.0, 0.0), (400.0, 0.3), (1e6, 20.0), (9.0, 6.0), (9.0, 6.0001), (0.0, 0.0), (1e-8, 0.0), (7.4, 1.0)]
        {
            for drive in [None, Some([Dd::from(0.1), Dd::from(0.7)])] {
                let a = Matrix::from_fn(2, 2, |i, j| Dd::from([[0.0, 1.0], [-k, -c]][i][j]));
                let h = Dd::from(0.1);
                let f = propagator(&a, h).expect("in range").f;
                let turn = turn(&a.map(|x| x * h), None).expect("in range");
                let lifted = lift(&turn, drive, Precision::Double).expect("a form");
                let left = product(&lifted.s, &f);
                let right = product(&lifted.lift.matrix(), &lifted.s);
                for j in 0..2 {
                    let size = (0..2).map(|i| left[(i, j)].hi.abs()).fold(0.0, f64::max);
                    for i in 0..2 {
                        let error = (left[(i, j)] - right[(i, j)]).hi.abs();
                        assert!(error <= 3e-16 * size, "k {k} c {c} {i}{j}: {error:e} {size:e} {lifted:?}");
                    }
                }
            }
        }
    }

    /// The product of the factors is accurate to far more than the sixteen digits of a double.
    #[test]
    fn the_phase_is_better_than_rounding() {
        let exact = Dd::from(2.0) - Dd::from(0.3f64.cos()) * 2.0;
        for (precision, most) in [(Precision::Double, 1e-19), (Precision::Single, 1e-10)] {
            let (k, p) = factors(exact, Dd::ONE, precision);
            let error = (Dd::product(k, p) / exact - Dd::ONE).hi.abs();
            assert!(error < most, "{error:e}");
        }
    }
}
