//! Numbers as they leave the program.
//!
//! Inside, a number is an enclosure: exact, a ball, a disc. A result has room for one binary64 number. [`Rounded`] is
//! that number together with a bound of its own error, the rounding to binary64 included. It can only be made from an
//! enclosure, so no result can carry a bound that was computed for another number. A number without a proven bound
//! leaves as [`Unproven`]. See docs/method/numbers.md.

use super::{Ball, Bound, Dd, Number};

/// The binary64 number that is printed for an enclosed one: |value - true| <= bound.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rounded {
    value: f64,
    bound: Bound,
}

impl Rounded {
    /// The nearest binary64 number to the midpoint; `None` if the enclosure is infinite, or outside the range of
    /// binary64.
    pub fn of(enclosed: Ball) -> Option<Rounded> {
        if !enclosed.is_finite() {
            return None;
        }
        // Adding 0.0 turns -0.0 into 0.0, which is the same number and reads better.
        let value = enclosed.mid.to_f64() + 0.0;
        // The difference is one low word or zero, so it is exact.
        let rounding = (enclosed.mid - Dd::from(value)).abs().to_f64();
        let bound = Bound::by_proof(enclosed.rad) + Bound::by_proof(rounding);
        (value.is_finite() && bound.is_finite()).then_some(Rounded { value, bound })
    }

    /// Rounds a number that may be exact; `None` if nothing is known about it.
    pub fn of_number(number: &Number) -> Option<Rounded> {
        Rounded::of(number.to_ball())
    }

    /// The value, in the unit of the number that it was made from.
    pub fn value(self) -> f64 {
        self.value
    }

    /// The bound of the absolute error, in the same unit; 0 only if the value is exact.
    pub fn bound(self) -> Bound {
        self.bound
    }

    /// A bound of |value - true| / |true|: 0 for an exact value, infinite where the true value may be 0.
    pub fn relative_bound(self) -> Bound {
        if self.bound == Bound::ZERO {
            return Bound::ZERO;
        }
        let least = (self.value.abs() - self.bound.value()).next_down();
        if least > 0.0 { Bound::by_proof((self.bound.value() / least).next_up()) } else { Bound::UNKNOWN }
    }
}

/// A number without a proven bound: a displacement in a mode shape, a share of energy, a measured time. Reports show
/// few digits of it, and README.md lists the numbers of this kind.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct Unproven(pub f64);

#[cfg(test)]
mod tests {
    use super::super::Rational;
    use super::*;

    #[test]
    fn the_bound_is_of_the_number_that_is_printed() {
        // A third as a double-double is known to 32 digits; printed as binary64 it is wrong in the 17th.
        let third = Number::from(Rational::new(1, 3));
        let rounded = Rounded::of_number(&third).expect("finite");
        let error = &third - &Number::from(Rational::from_f64(rounded.value()).expect("finite"));
        let error = error.to_f64().abs();
        assert!(error > 1e-17 && error <= rounded.bound().value() && rounded.bound().value() <= 1.01 * error);
        assert!(error * 3.0 <= rounded.relative_bound().value() && rounded.relative_bound().value() <= 3.1 * error);
    }

    #[test]
    fn a_radius_and_a_rounding_add_up() {
        let rounded = Rounded::of(Ball::new(Dd { hi: 1.0, lo: 1e-17 }, 2e-17)).expect("finite");
        assert_eq!(rounded.value(), 1.0);
        assert!(rounded.bound().value() >= 3e-17 && rounded.bound().value() < 3.000_001e-17);
    }

    #[test]
    fn exact_numbers_have_no_error_and_zero_has_no_sign() {
        for x in [0.0, -0.0, 1.5, -3e300, 5e-324] {
            let rounded = Rounded::of(Ball::from(x)).expect("finite");
            assert_eq!((rounded.value().to_bits(), rounded.bound().value()), ((x + 0.0).to_bits(), 0.0));
            assert_eq!(rounded.relative_bound().value(), 0.0);
        }
    }

    #[test]
    fn nothing_known_is_not_a_number() {
        assert_eq!(Rounded::of(Ball::new(Dd::ONE, f64::INFINITY)), None);
        assert_eq!(Rounded::of(Ball::new(Dd::from(f64::NAN), 0.0)), None);
        let may_be_zero = Rounded::of(Ball::new(Dd::from(1e-3), 2e-3)).expect("finite");
        assert!(!may_be_zero.relative_bound().is_finite());
    }

    #[test]
    fn the_least_numbers_keep_a_bound() {
        let rounded = Rounded::of(Ball::new(Dd::from(1e-310), 5e-324)).expect("finite");
        assert!(rounded.bound().value() >= 5e-324 && rounded.relative_bound().value() > 0.0);
    }

    /// 1 + 2^-54 is not a binary64 number: the nearest one, 1, would be too small a bound.
    #[test]
    fn a_bound_is_rounded_upwards() {
        let rounded = Rounded::of(Ball::new(Dd { hi: 1.0, lo: 0.5f64.powi(54) }, 1.0)).expect("finite");
        assert!(rounded.value() == 1.0 && rounded.bound().value() > 1.0, "{rounded:?}");
    }
}
