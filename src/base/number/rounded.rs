//! Numbers as they leave the program.
//!
//! Inside, a number is an enclosure: exact, a ball, a disc. A result has room for one binary64 number. [`Rounded`] is that
//! number together with a bound of its own error, the rounding to binary64 included; it can be made from an enclosure
//! only, so that no result can carry a bound that was computed for some other number. What has no proven bound leaves as
//! [`Unproven`]. See docs/method/numbers.md.

use super::{Ball, Dd, Number};

/// The binary64 number that is printed for an enclosed one: |value - true| <= bound.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rounded {
    value: f64,
    bound: f64,
}

impl Rounded {
    /// The nearest binary64 number to the midpoint; `None` where the enclosure says nothing, or where its numbers lie
    /// outside the range of binary64.
    pub fn of(enclosed: Ball) -> Option<Rounded> {
        if !enclosed.is_finite() {
            return None;
        }
        // Adding 0.0 turns -0.0 into 0.0, which is the same number and reads better.
        let value = enclosed.mid.to_f64() + 0.0;
        // The difference is one low word or zero, so it is exact.
        let rounding = (enclosed.mid - Dd::from(value)).abs().to_f64();
        let bound = match (enclosed.rad, rounding) {
            (0.0, 0.0) => 0.0,
            (radius, rounding) => (radius + rounding).next_up(),
        };
        (value.is_finite() && bound.is_finite()).then_some(Rounded { value, bound })
    }

    /// A bound of |value - true| for the number that is printed for an enclosed one; infinite where nothing is known.
    pub fn bound_of(enclosed: Ball) -> f64 {
        Rounded::of(enclosed).map_or(f64::INFINITY, Rounded::bound)
    }

    /// A bound of |value - true| / |true| for the number that is printed for an enclosed one; infinite where nothing is
    /// known.
    pub fn relative_bound_of(enclosed: Ball) -> f64 {
        Rounded::of(enclosed).map_or(f64::INFINITY, Rounded::relative_bound)
    }

    /// Rounds a number that may be exact; `None` where nothing is known.
    pub fn of_number(number: &Number) -> Option<Rounded> {
        Rounded::of(number.to_ball())
    }

    /// In the unit of what it was made from.
    pub fn value(self) -> f64 {
        self.value
    }

    /// Absolute, in the same unit; 0 only where the value is exact.
    pub fn bound(self) -> f64 {
        self.bound
    }

    /// A bound of |value - true| / |true|: 0 for an exact value, infinite where the true value may be 0.
    pub fn relative_bound(self) -> f64 {
        if self.bound == 0.0 {
            return 0.0;
        }
        let least = (self.value.abs() - self.bound).next_down();
        if least > 0.0 { (self.bound / least).next_up() } else { f64::INFINITY }
    }
}

/// A number without a proven bound: a displacement in a mode shape, a share of energy, a measured time. Reports show few
/// digits of it, and README.md lists what is of this kind.
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
        assert!(error > 1e-17 && error <= rounded.bound() && rounded.bound() <= 1.01 * error);
        assert!(error * 3.0 <= rounded.relative_bound() && rounded.relative_bound() <= 3.1 * error);
    }

    /// 1/3 with a radius of 1e-10, and the bound of the number that is printed for it.
    #[test]
    fn a_relative_bound_is_of_the_printed_number() {
        let third = Ball::new(Dd::ONE / Dd::from(3.0), 1e-10);
        assert!(Rounded::relative_bound_of(third) >= 3e-10 && Rounded::bound_of(third) >= 1e-10);
        assert_eq!(Rounded::relative_bound_of(Ball::new(Dd::ONE, f64::NAN)), f64::INFINITY);
    }

    #[test]
    fn a_radius_and_a_rounding_add_up() {
        let rounded = Rounded::of(Ball::new(Dd { hi: 1.0, lo: 1e-17 }, 2e-17)).expect("finite");
        assert_eq!(rounded.value(), 1.0);
        assert!(rounded.bound() >= 3e-17 && rounded.bound() < 3.000_001e-17);
    }

    #[test]
    fn exact_numbers_have_no_error_and_zero_has_no_sign() {
        for x in [0.0, -0.0, 1.5, -3e300, 5e-324] {
            let rounded = Rounded::of(Ball::from(x)).expect("finite");
            assert_eq!((rounded.value().to_bits(), rounded.bound()), ((x + 0.0).to_bits(), 0.0));
            assert_eq!(rounded.relative_bound(), 0.0);
        }
    }

    #[test]
    fn nothing_known_is_not_a_number() {
        assert_eq!(Rounded::of(Ball::new(Dd::ONE, f64::INFINITY)), None);
        assert_eq!(Rounded::of(Ball::new(Dd::from(f64::NAN), 0.0)), None);
        let may_be_zero = Rounded::of(Ball::new(Dd::from(1e-3), 2e-3)).expect("finite");
        assert!(may_be_zero.relative_bound().is_infinite());
    }

    #[test]
    fn the_least_numbers_keep_a_bound() {
        let rounded = Rounded::of(Ball::new(Dd::from(1e-310), 5e-324)).expect("finite");
        assert!(rounded.bound() >= 5e-324 && rounded.relative_bound() > 0.0);
    }

    /// 1 + 2^-54 is no binary64: its nearest, 1, would be too small a bound.
    #[test]
    fn a_bound_is_rounded_upwards() {
        let rounded = Rounded::of(Ball::new(Dd { hi: 1.0, lo: 0.5f64.powi(54) }, 1.0)).expect("finite");
        assert!(rounded.value() == 1.0 && rounded.bound() > 1.0, "{rounded:?}");
    }
}
