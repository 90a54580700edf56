//! Upper bounds as they leave the program: bounds of errors, and of values known only by their size.
//!
//! A number with a bound is a promise, so a [`Bound`] is made from an enclosure. If a bound rests on a separate
//! argument (a disc in the complex plane, the rounding of emitted code), the analysis that has the argument calls
//! [`Bound::by_proof`]; the layers that print can only pass bounds on (`tests/suite/house.rs`). See
//! docs/method/numbers.md.

use super::{Ball, Rounded, larger, up};
use std::ops::Add;

/// An upper bound, rounded upwards: at least 0, infinite if nothing is known.
///
/// A plain number cannot become a bound:
///
/// ```compile_fail,E0423
/// # use vibc_linear::base as vibc;
/// let bound = vibc::Bound(1e-16);
/// ```
///
/// ```compile_fail,E0277
/// # use vibc_linear::base as vibc;
/// let bound: vibc::Bound = 1e-16.into();
/// ```
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct Bound(f64);

impl Bound {
    /// The bound of a number without error.
    pub const ZERO: Bound = Bound(0.0);
    /// The infinite bound, for a number of which nothing is known.
    pub const UNKNOWN: Bound = Bound(f64::INFINITY);

    /// A bound of |printed - true|, for the binary64 number that is printed for an enclosed one.
    pub fn absolute(enclosed: Ball) -> Bound {
        Rounded::of(enclosed).map_or(Bound::UNKNOWN, Rounded::bound)
    }

    /// A bound of |printed - true| / |true|, for the binary64 number that is printed for an enclosed one.
    pub fn relative(enclosed: Ball) -> Bound {
        Rounded::of(enclosed).map_or(Bound::UNKNOWN, Rounded::relative_bound)
    }

    /// A bound of |midpoint - true| / |true|, for numbers that are printed with more digits than binary64 has.
    pub fn of_midpoint(enclosed: Ball) -> Bound {
        Bound::by_proof(enclosed.relative_error())
    }

    /// A bound of |x|.
    pub fn size(enclosed: Ball) -> Bound {
        Bound::by_proof(if enclosed.is_zero() { 0.0 } else { enclosed.magnitude() })
    }

    /// A bound for which the caller has a proof, rounded upwards; NaN becomes infinite. Only the stages that compute
    /// call this: the layers that print have no proof.
    pub fn by_proof(bound: f64) -> Bound {
        Bound(larger(bound, 0.0))
    }

    /// The bound in the unit of the number that it bounds.
    pub fn value(self) -> f64 {
        self.0
    }

    pub fn is_finite(self) -> bool {
        self.0.is_finite()
    }

    /// The larger of two.
    pub fn or_larger(self, other: Bound) -> Bound {
        if other.0 > self.0 { other } else { self }
    }

    /// The bound in units of another size; unknown if that may be zero.
    pub fn per(self, size: Ball) -> Bound {
        if self.0 == 0.0 { Bound::ZERO } else { Bound::by_proof(self.0 / size.mignitude() * up::FEW) }
    }
}

impl Add for Bound {
    type Output = Bound;
    fn add(self, other: Bound) -> Bound {
        match (self.0, other.0) {
            (0.0, _) => other,
            (_, 0.0) => self,
            (a, b) => Bound((a + b).next_up()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::Dd;

    #[test]
    fn no_number_is_no_bound() {
        assert_eq!(Bound::by_proof(f64::NAN), Bound::UNKNOWN);
        assert_eq!(Bound::absolute(Ball::new(Dd::ONE, f64::INFINITY)), Bound::UNKNOWN);
        assert_eq!(Bound::relative(Ball::new(Dd::ZERO, 1.0)), Bound::UNKNOWN);
        assert_eq!(Bound::of_midpoint(Ball::new(Dd::ZERO, 1.0)), Bound::UNKNOWN);
        assert_eq!(Bound::by_proof(1.0).per(Ball::new(Dd::ZERO, 1.0)), Bound::UNKNOWN);
        assert_eq!(Bound::ZERO.or_larger(Bound::UNKNOWN), Bound::UNKNOWN);
        assert_eq!(Bound::UNKNOWN.or_larger(Bound::ZERO), Bound::UNKNOWN);
        assert_eq!(Bound::UNKNOWN + Bound::ZERO, Bound::UNKNOWN);
    }

    /// 1/3 with a radius of 1e-10, and the bound of the number that is printed for it.
    #[test]
    fn bounds_are_of_the_printed_number() {
        let third = Ball::new(Dd::ONE / Dd::from(3.0), 1e-10);
        assert!(Bound::relative(third).value() >= 3e-10 && Bound::absolute(third).value() >= 1e-10);
        assert!(Bound::size(third).value() >= third.mid.hi + 1e-10 && Bound::of_midpoint(third).value() >= 3e-10);
        assert_eq!(Bound::absolute(Ball::from(0.25)), Bound::ZERO);
        assert_eq!(Bound::size(Ball::ZERO), Bound::ZERO);
    }

    #[test]
    fn sums_and_quotients_are_rounded_upwards() {
        let (one, small) = (Bound::by_proof(1.0), Bound::by_proof(0.4 * f64::EPSILON));
        assert!((one + small).value() > 1.0);
        assert_eq!((one + Bound::ZERO, Bound::ZERO + small), (one, small));
        assert!(one.per(Ball::from(3.0)).value() > 1.0 / 3.0);
        assert!(one.per(Ball::new(Dd::from(3.0), 1.0)).value() >= 0.5);
        assert_eq!(one.or_larger(small), one);
    }
}
