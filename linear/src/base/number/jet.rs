//! A number that depends on one parameter, with its derivative: both enclosed over a whole range of the parameter. In: numbers
//! of a model in which a parameter is [`Jet::of_parameter`]. Out: for every value of the parameter in the range, the number lies
//! in `value` and its derivative in `slope` (automatic differentiation in ball arithmetic: L. B. Rall, *Automatic
//! Differentiation*, LNCS 120, 1981). See docs/method/numbers.md.
//!
//! If a number is converted into a plain ball, its derivative is lost; [`watch_divisions`] reports whether that happened, so that a result
//! computed from such a ball is not taken for constant.

use super::rounding::up;
use super::series::{self, Series};
use super::{Ball, Dd, Number};
use std::cell::Cell;
use std::ops::Deref;

/// A number over a range of one parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct Jet {
    /// Encloses the number for every value of the parameter.
    pub value: Ball,
    /// Encloses its derivative by the parameter for every value of the parameter.
    pub slope: Ball,
}

/// The same, and where it was asked for a [`Series`].
#[derive(Clone, Debug, PartialEq)]
pub struct Ranged {
    jet: Jet,
    series: Option<Box<Series>>,
}

impl Ranged {
    pub fn series(&self) -> Option<&Series> {
        self.series.as_deref()
    }

    /// f(self), from f and f' over the value, and f of the series.
    pub(super) fn through(&self, value: Ball, slope: Ball, f: impl FnOnce(&Series) -> Option<Series>) -> Number {
        Jet { value, slope: slope * self.jet.slope }.with(self.series().and_then(f))
    }

    pub(super) fn negative(&self) -> Number {
        let Jet { value, slope } = self.jet;
        Jet { value: -value, slope: -slope }.with(self.series().map(Series::negative))
    }
}

impl Deref for Ranged {
    type Target = Jet;

    fn deref(&self) -> &Jet {
        &self.jet
    }
}

impl From<Jet> for Number {
    fn from(jet: Jet) -> Number {
        jet.with(None)
    }
}

thread_local! {
    /// Set when a derivative is lost.
    static LOST: Cell<bool> = const { Cell::new(false) };
    /// Set when a question about a number has not the same answer over the whole range.
    static DIVIDED: Cell<bool> = const { Cell::new(false) };
}

/// Runs a function and reports whether it lost a derivative.
pub fn watch_divisions<T>(run: impl FnOnce() -> T) -> (T, bool) {
    let before = LOST.replace(false);
    let result = run();
    let lost = LOST.replace(before);
    (result, lost)
}

/// Runs a function; its result, unless it lost a derivative or asked a question that has not certainly the same answer for every
/// value of the parameter. Otherwise it took the same way that it takes for each of them.
pub fn without_division<T>(run: impl FnOnce() -> T) -> Option<T> {
    let before = DIVIDED.replace(false);
    let (result, lost) = watch_divisions(run);
    let divided = DIVIDED.replace(before);
    (!lost && !divided).then_some(result)
}

/// Runs a search that takes one number for all of a range. What it finds has to be proved afterwards, so nothing is lost and no question
/// counts.
pub fn in_the_middle<T>(search: impl FnOnce() -> T) -> T {
    let (lost, divided) = (LOST.get(), DIVIDED.get());
    let found = search();
    LOST.set(lost);
    DIVIDED.set(divided);
    found
}

impl Jet {
    /// Notes a question about the sign of a number that is not zero everywhere.
    pub(super) fn note_question(&self) {
        if self.value.contains_zero() && !self.is_zero() {
            DIVIDED.set(true);
        }
    }

    /// Notes that one number was taken for all.
    pub(super) fn note_choice() {
        DIVIDED.set(true);
    }

    /// The parameter itself, somewhere in a ball.
    pub fn of_parameter(range: Ball) -> Number {
        Number::from(Jet { value: range, slope: Ball::ONE })
    }

    /// The parameter within `reach` of a middle. Numbers that depend on it have a [`Series`] in it, so no two such parameters may meet.
    pub fn of_parameter_in_series(middle: Ball, reach: f64) -> Number {
        Jet { value: middle.widen(reach), slope: Ball::ONE }.with(Some(Series::of_parameter(middle, reach)))
    }

    /// The same number, known also by a series.
    pub fn with(self, series: Option<Series>) -> Number {
        Number::Jet(Box::new(Ranged { jet: self, series: series.map(Box::new) }))
    }

    /// Any number; one without a derivative is a constant.
    pub fn of(number: &Number) -> Jet {
        match number {
            Number::Jet(jet) => jet.jet.clone(),
            constant => Jet { value: constant.enclosure(), slope: Ball::ZERO },
        }
    }

    pub(super) fn note_loss() {
        LOST.set(true);
    }

    pub(super) fn is_zero(&self) -> bool {
        self.value.is_zero() && self.slope.is_zero()
    }
}

pub(super) fn sum(a: &Number, b: &Number) -> Number {
    let series = series::sum(a, b);
    let (a, b) = (Jet::of(a), Jet::of(b));
    Jet { value: a.value + b.value, slope: a.slope + b.slope }.with(series)
}

pub(super) fn product(a: &Number, b: &Number) -> Number {
    // Identical numbers, not only numbers with the same enclosures.
    let same = std::ptr::eq(a, b);
    let series = series::product(a, b);
    let (a, b) = (Jet::of(a), Jet::of(b));
    let (value, slope) = match same {
        true => (square(a.value), a.value * a.slope * Ball::from(2.0)),
        false => (a.value * b.value, a.value * b.slope + b.value * a.slope),
    };
    Jet { value, slope }.with(series)
}

pub(super) fn quotient(a: &Number, b: &Number) -> Number {
    let series = series::quotient(a, b);
    let (a, b) = (Jet::of(a), Jet::of(b));
    if b.value.contains_zero() {
        let unknown = Ball::new(Dd::ZERO, f64::INFINITY);
        return Number::from(Jet { value: unknown, slope: unknown });
    }
    let value = a.value / b.value;
    Jet { value, slope: (a.slope - value * b.slope) / b.value }.with(series)
}

/// The square of a number that is the same in both factors: never negative.
pub fn square(x: Ball) -> Ball {
    // (m + e)^2 = m^2 + r^2/2 + (2 m e + e^2 - r^2/2), and the last part is at most 2 |m| r + r^2/2 in size.
    let half = x.rad * x.rad * 0.5;
    if half == 0.0 {
        x.square()
    } else {
        (Ball::exact(x.mid).square() + Ball::from(half)).widen(2.0 * x.mid.hi.abs() * x.rad * up::FEW + half)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The derivative of an expression at a point and over a range holds the true one.
    fn check(f: impl Fn(&Number) -> Option<Number>, at: f64, truth: impl Fn(f64) -> f64) {
        for radius in [0.0, 1e-3, 0.05] {
            let Some(Number::Jet(jet)) = f(&Jet::of_parameter(Ball::new(Dd::from(at), radius))) else {
                panic!("a jet")
            };
            for part in [-1.0, 0.0, 0.7, 1.0] {
                let slope = truth(at + part * radius);
                let off = (jet.slope - Ball::from(slope)).mid.hi.abs();
                assert!(off <= jet.slope.rad + 1e-13 * slope.abs(), "{jet:?} {slope}");
            }
        }
    }

    #[test]
    fn derivatives_hold() {
        let two = Number::from(2);
        check(|x| Some(&(x * x) * x), 1.5, |x| 3.0 * x * x);
        check(|x| x.recip(), 1.5, |x| -1.0 / (x * x));
        check(|x| (x + &two).sqrt(), 1.5, |x| 0.5 / (x + 2.0).sqrt());
        check(|x| x.powi(-3), 1.5, |x| -3.0 * x.powi(-4));
        check(|x| x.pow(&Number::from("1.3")), 1.5, |x| 1.3 * x.powf(0.3));
        check(|x| x.exp(), 1.5, f64::exp);
        check(|x| x.ln(), 1.5, |x| 1.0 / x);
        check(|x| x.sin_cos().map(|(s, _)| s), 1.5, f64::cos);
        check(|x| x.sin_cos().map(|(_, c)| c), 1.5, |x| -x.sin());
        check(|x| Number::atan2(x, &two), 1.5, |x| 2.0 / (4.0 + x * x));
        check(|x| x.asin(), 0.5, |x| 1.0 / (1.0 - x * x).sqrt());
    }

    #[test]
    fn cancelled_terms_are_zero() {
        let x = Jet::of_parameter(Ball::from(3.0));
        assert!((&(&x - &x) * &Number::from(5)).is_zero());
        assert!(!(&x - &Number::from(3)).is_zero(), "it is zero at the middle alone");
    }

    #[test]
    fn a_question_with_two_answers_divides_the_range() {
        let x = Jet::of_parameter(Ball::from(3.0).widen(1.0));
        let from = |low: i64| &x - &Number::from(low);
        assert_eq!(without_division(|| from(1).is_positive()), Some(true));
        let point = Jet::of_parameter(Ball::from(3.0));
        assert_eq!(without_division(|| (&point - &point).is_zero()), Some(true));
        assert_eq!(without_division(|| from(3).is_positive()), None);
        assert_eq!(without_division(|| from(3).is_negative()), None);
        assert_eq!(without_division(|| from(3).is_zero()), None);
        assert!(without_division(|| &from(3) * &Number::from(2)).is_some(), "a product has one form");
        assert_eq!(without_division(|| from(3).may_be_zero()), None);
        assert_eq!(without_division(|| x.compare(&Number::from(5))), Some(Some(std::cmp::Ordering::Less)));
        assert_eq!(without_division(|| x.compare(&Number::from(4))), None);
        assert_eq!(without_division(|| x.to_f64()), None);
        assert_eq!(without_division(|| x.to_ball()), None);
        assert!(without_division(|| 0).is_some(), "an earlier question is not this one's");
    }

    #[test]
    fn a_search_in_the_middle_leaves_no_trace() {
        let x = Jet::of_parameter(Ball::from(3.0).widen(1.0));
        assert_eq!(without_division(|| in_the_middle(|| x.to_f64())), Some(3.0));
        let before = || x.to_f64() + in_the_middle(|| 1.0);
        assert_eq!(without_division(before), None, "what was noted before stays");
        assert!(watch_divisions(|| (x.to_ball(), in_the_middle(|| x.to_ball()))).1);
    }

    #[test]
    fn a_lost_derivative_is_reported() {
        let x = Jet::of_parameter(Ball::from(3.0));
        assert!(!watch_divisions(|| (&x * &x).is_positive()).1);
        assert!(watch_divisions(|| x.to_ball()).1);
        assert!(!watch_divisions(|| Number::pi().to_ball()).1);
    }
}
