//! exp(A) of two states, minus or plus one, in closed form: with half the trace a and the angle w, w^2 = det A - a^2,
//! the exponential is e^a (cos w + sin w / w (A - a)), and the angle is reduced by whole and half turns. So entries
//! keep their relative accuracy however near a step is to a whole number of periods; a general exponential would leave
//! only the digits beyond one. In: A times the step, and the angle minus whole turns if it is known exactly. Out: F
//! minus or plus one. See docs/method/emit.md.

use crate::analysis::discrete::precision::exp_minus_one;
use crate::base::{Ball, Dd, Number, Power};
use crate::kernel::dense::Matrix;

/// F = sign (1 + change), with the minus sign if the motion turns by more than a quarter of a period.
#[derive(Clone, Debug)]
pub struct Turn {
    pub turned: bool,
    pub change: Matrix<Dd>,
    /// 1 - det F
    pub lost: Dd,
    /// |1 -+ lambda|^2 for a complex pair, (1 - lambda_1)(1 - lambda_2) for real ones.
    pub product: Dd,
}

impl Turn {
    /// F
    pub fn whole(&self) -> Matrix<Dd> {
        let sign = if self.turned { -Dd::ONE } else { Dd::ONE };
        Matrix::from_fn(2, 2, |i, j| sign * (self.change[(i, j)] + if i == j { Dd::ONE } else { Dd::ZERO }))
    }
}

/// Beyond this angle, in rad, too few digits of a double-double are left for the phase of a motion.
const MOST_ANGLE: f64 = 1e9;

/// An exponent at which nothing is left of a motion.
const GONE: f64 = -700.0;

/// Whether two states turn so far that their phase is lost before they have decayed.
pub fn too_far(a: &Matrix<Dd>) -> bool {
    let half = (a[(0, 0)].hi + a[(1, 1)].hi) * 0.5;
    let square = (a[(0, 0)].hi - half).power(2) + a[(0, 1)].hi * a[(1, 0)].hi;
    half >= GONE && -square > MOST_ANGLE * MOST_ANGLE
}

/// The step of w' = A w over a unit of time; `None` if out of range. `angle`: the angle of an undamped motion minus
/// whole turns, if it is known.
pub fn turn(a: &Matrix<Dd>, angle: Option<Dd>) -> Option<Turn> {
    let half = (a[(0, 0)] + a[(1, 1)]) * 0.5;
    let aside = (a[(0, 0)] - a[(1, 1)]) * 0.5;
    let square = aside.square() + a[(0, 1)] * a[(1, 0)];
    // A - a
    let rest = [[aside, a[(0, 1)]], [a[(1, 0)], -aside]];
    let lost = -exp_minus_one(half * 2.0)?;
    if square.hi < 0.0 {
        let w = (-square).sqrt();
        let gone = half.hi < GONE;
        let (turned, reduce_angle) = reduce_angle(if gone { Dd::ZERO } else { angle.unwrap_or(w) })?;
        let keep = Dd::ONE + exp_minus_one(half)?;
        let (sine, cosine_lost) = sine_and_versine(reduce_angle)?;
        let shrunk = exp_minus_one(half)?;
        let along = keep * sine / w;
        let own = shrunk - keep * cosine_lost;
        let change = Matrix::from_fn(2, 2, |i, j| along * rest[i][j] + if i == j { own } else { Dd::ZERO });
        let product = shrunk.square() + keep * cosine_lost * 2.0;
        return Some(Turn { turned, change, lost, product });
    }
    let d = square.sqrt();
    let (fast, slow) = (exp_minus_one(half + d)?, exp_minus_one(half - d)?);
    let keep = Dd::ONE + exp_minus_one(half)?;
    // sinh d / d
    let along = if d.hi < 0.03 { keep * hyperbolic(square) } else { (fast - slow) / (d * 2.0) };
    let own = (fast + slow) * 0.5;
    let change = Matrix::from_fn(2, 2, |i, j| along * rest[i][j] + if i == j { own } else { Dd::ZERO });
    Some(Turn { turned: false, change, lost, product: fast * slow })
}

/// An angle minus whole turns, or minus an odd number of half turns if that is nearer.
fn reduce_angle(angle: Dd) -> Option<(bool, Dd)> {
    if !angle.is_finite() {
        return None;
    }
    let halves = (angle.hi / std::f64::consts::PI).round();
    Some((halves % 2.0 != 0.0, angle - Dd::PI * halves))
}

/// sin x and 1 - cos x = 2 sin^2(x / 2) for |x| <= pi / 2, to the relative accuracy of a double-double.
fn sine_and_versine(x: Dd) -> Option<(Dd, Dd)> {
    let half = sine(x * 0.5)?;
    Some((sine(x)?, half.square() * 2.0))
}

fn sine(x: Dd) -> Option<Dd> {
    if x.hi.abs() > 0.1 {
        return Some(Number::Ball(Ball::exact(x)).sin_cos()?.0.to_ball().mid);
    }
    // The remainder after eleven terms is 0.1^22 / 23! of the first.
    let square = x.square();
    let (mut term, mut sum) = (x, x);
    for i in 1..11 {
        term = -(term * square) / Dd::from(f64::from(2 * i * (2 * i + 1)));
        sum += term;
    }
    Some(sum)
}

/// sinh d / d as a function of d^2, for d below 0.03.
fn hyperbolic(square: Dd) -> Dd {
    let (mut term, mut sum) = (Dd::ONE, Dd::ONE);
    for i in 1..9 {
        term = term * square / Dd::from(f64::from(2 * i * (2 * i + 1)));
        sum += term;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::discrete::hold::propagator;

    /// Compares with the general exponential, minus or plus one: slow and fast, damped, critical and overdamped.
    #[test]
    fn the_closed_form_is_the_exponential() {
        for (k, c) in [
            (1.0, 0.0),
            (400.0, 0.3),
            (1e4, 20.0),
            (9.0, 6.0),
            (9.0, 6.0001),
            (9.0, 5.9999),
            (0.0, 0.0),
            (0.0, 3.0),
            (1e-8, 0.0),
            (987.0, 1.0),
            (-4.0, 0.5),
        ] {
            let a = Matrix::from_fn(2, 2, |i, j| Dd::from([[0.0, 1.0], [-k, -c]][i][j]));
            let h = Dd::from(0.1);
            let f = propagator(&a, h).expect("in range").f;
            let found = turn(&a.map(|x| x * h), None).expect("in range");
            let sign = if found.turned { -Dd::ONE } else { Dd::ONE };
            for i in 0..2 {
                for j in 0..2 {
                    let own = if i == j { Dd::ONE } else { Dd::ZERO };
                    let error = (sign * (found.change[(i, j)] + own) - f[(i, j)]).hi.abs();
                    assert!(error < 1e-27 * k.abs().max(1.0), "k {k} c {c} {i}{j}: {error:e}");
                }
            }
            let det = f[(0, 0)] * f[(1, 1)] - f[(0, 1)] * f[(1, 0)];
            assert!((Dd::ONE - det - found.lost).hi.abs() < 1e-28);
        }
    }

    /// A step of a million periods and 1e-9 rad: the remainder keeps its digits.
    #[test]
    fn the_phase_after_whole_turns_keeps_its_digits() {
        let over = Dd::from(1e-9);
        let w = Dd::PI * 2e6 + over;
        let a = Matrix::from_fn(2, 2, |i, j| [[Dd::ZERO, w], [-w, Dd::ZERO]][i][j]);
        let found = turn(&a, None).expect("in range");
        assert!(!found.turned);
        assert!((found.change[(0, 1)] / over - Dd::ONE).hi.abs() < 1e-15);
        assert!((found.product / over.square() - Dd::ONE).hi.abs() < 1e-15);
        let exact = turn(&a, Some(Dd::ZERO)).expect("in range");
        assert!(exact.product.is_zero() && exact.change[(1, 0)].is_zero());
        let half = turn(&a, Some(Dd::PI)).expect("in range");
        assert!(half.turned && half.change[(1, 0)].is_zero());
    }
}
