//! Derivatives of measures with respect to parameters: central differences with exact steps. In: a function of a number.
//! Out: the quotient [f(p + h) - f(p - h)] / 2h as a ball; by the mean value theorem it is the derivative itself at a
//! value within h of p, and h is some 10^-10 of p. So it includes the effect of the parameter on the rest, the geometry
//! and everything else. See docs/method/measures.md.

use super::search::to_fraction;
use crate::base::{Ball, Dd, Number, two_to};

/// The reason why there is no derivative.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoSlope {
    /// The function has no value on one side.
    Undefined,
    /// The derivatives on the two sides differ, as for frequencies that are equal here.
    Kink,
}

/// The step is at least 2^`LEAST` times the parameter.
const LEAST: i32 = -33;
/// The step is at most 2^`MOST` times the parameter.
const MOST: i32 = -7;

/// The step for a function known to a relative error: the cube root of that error, which balances the quotient's own
/// error and its distance from the derivative at p. A power of two times the parameter, or times `unit` if the parameter
/// is zero.
pub fn step(p: &Number, unit: &Number, relative_error: f64) -> Number {
    let size = if p.may_be_zero() { unit.to_f64().abs() } else { p.to_f64().abs() };
    let exponent = (LEAST..=MOST).find(|&k| two_to(3 * k) >= relative_error).unwrap_or(MOST);
    // Rounded down to a power of two, so that the steps are short fractions.
    let bits = ((size.max(f64::MIN_POSITIVE).to_bits() >> 52) & 0x7ff) as i32 - 1023;
    to_fraction(Dd::from(two_to((bits + exponent).clamp(-1000, 1000))))
}

/// The slope of a function from its values at p - h, p and p + h.
pub fn slope(before: Option<Ball>, here: Option<Ball>, after: Option<Ball>, h: &Number) -> Result<Ball, NoSlope> {
    let (Some(before), Some(here), Some(after)) = (before, here, after) else { return Err(NoSlope::Undefined) };
    if before == here && here == after {
        // Equal to the last bit of the enclosure: the parameter does not enter.
        return Ok(Ball::ZERO);
    }
    let difference = after - before;
    let bend = ((after - here) - (here - before)).abs();
    let known = difference.rad.max(here.rad);
    // A smooth function bends by about h times the change of its slope; a kink bends by the difference of two slopes.
    if bend.mid.hi > 4.0 * known && bend.mid.hi > KINK * difference.mid.hi.abs() {
        return Err(NoSlope::Kink);
    }
    let slope = difference / (Ball::from(2.0) * h.to_ball());
    if slope.is_finite() { Ok(slope) } else { Err(NoSlope::Undefined) }
}

/// Bends larger than this share of the difference are kinks, or slopes of nearly zero at a turning point.
const KINK: f64 = 0.05;

#[cfg(test)]
mod tests {
    use super::*;

    fn of(f: impl Fn(Ball) -> Ball, p: i64) -> Result<Ball, NoSlope> {
        let p = Number::from(p);
        let h = step(&p, &Number::ONE, 0.0);
        let at = |x: Number| Some(f(x.to_ball()));
        slope(at(&p - &h), at(p.clone()), at(&p + &h), &h)
    }

    #[test]
    fn a_smooth_function_has_its_slope() {
        let slope = of(|x| x.sqrt(), 4).expect("smooth");
        assert!((slope.to_f64() - 0.25).abs() < 1e-16, "{slope:?}");
        assert!(slope.rad < 1e-18, "{slope:?}");
    }

    #[test]
    fn a_kink_has_none() {
        assert_eq!(of(|x| (x - Ball::from(4.0)).abs(), 4), Err(NoSlope::Kink));
    }
}
