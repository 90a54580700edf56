//! Proofs that a scene rests at the reported position. A [`Proven`] is made only by these tests, so nothing can claim
//! to be proven without one. See docs/method/rest.md#as-drawn, docs/method/rest.md#proof and
//! docs/method/rest.md#large-linear-parts.

use crate::base::{Number, down};

/// Proof that the rest lies in the enclosure reported. Only the tests in this file make one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Proven(());

impl Proven {
    /// Every force vanishes exactly.
    pub fn prove_balance<'a>(forces: impl IntoIterator<Item = &'a Number>) -> Option<Proven> {
        forces.into_iter().all(Number::is_zero).then_some(Proven(()))
    }

    /// An operator whose fixed points are the rests maps a box into its interior: bounds of the distance of the image
    /// from the middle, and the radii of the box.
    pub fn inclusion(mapped: &[f64], radii: &[f64]) -> Option<Proven> {
        let inside = |(mapped, radius): (&f64, &f64)| mapped < radius && radius.is_finite();
        (mapped.len() == radii.len() && mapped.iter().zip(radii).all(inside)).then_some(Proven(()))
    }

    /// The energy rises everywhere on a sphere: `force` is an upper bound of the gradient at its centre, `least` a lower
    /// bound of the curvature inside.
    pub fn convexity(force: f64, least: f64, radius: f64) -> Option<Proven> {
        let rises = least > 0.0 && radius.is_finite() && force <= least * radius * down::FEW;
        rises.then_some(Proven(()))
    }

    /// A linear system is regular: K w > 0 for some w > 0, and K has no positive entry off its diagonal.
    pub fn positivity(w: &[f64], least_of_kw: &[f64]) -> Option<Proven> {
        let positive = |x: &[f64]| x.iter().all(|x| *x > 0.0 && x.is_finite());
        (w.len() == least_of_kw.len() && positive(w) && positive(least_of_kw)).then_some(Proven(()))
    }

    /// A linear system is regular: `least` is a lower bound of its eigenvalues.
    pub fn definiteness(least: f64) -> Option<Proven> {
        (least > 0.0 && least.is_finite()).then_some(Proven(()))
    }

    /// Both of two parts are proven.
    pub fn and(first: Option<Proven>, second: Option<Proven>) -> Option<Proven> {
        first.and(second)
    }
}

/// Proof that the search for the rest, which goes downhill from the drawing, ends in the one that is enclosed and in no other, for
/// all values of the parameters that are ranges. Only the tests in this file make one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reached(());

impl Reached {
    /// Where nothing moves there is no search.
    pub fn as_drawn() -> Reached {
        Reached(())
    }

    /// A quadratic energy has no other rest than one that is isolated.
    pub fn of_linear(proven: Option<Proven>) -> Option<Reached> {
        proven.map(|_| Reached(()))
    }

    /// Where the energy is at most as drawn, the stiffness changes by a part of itself at the most, and in all places that a step from
    /// there may lead to it is positive: `near` and `far` are upper bounds, in the two regions, of what 1 less the stiffness over that of
    /// the middle makes of a vector with the entries `of`. See docs/method/rest.md#where-the-search-ends.
    pub fn by_convexity(change: f64, near: &[f64], far: &[f64], of: &[f64]) -> Option<Reached> {
        let is_within = |changes: &[f64], most: f64| {
            let is_small = |(change, of): (&f64, &f64)| *change <= most * of && of.is_finite();
            changes.len() == of.len() && changes.iter().zip(of).all(is_small)
        };
        (is_within(near, change) && is_within(far, LESS_THAN_ALL)).then_some(Reached(()))
    }

    /// The distances from the rest, in units of the most that the drawing may be away and in the norm of the stiffness, within which the
    /// search stays and within which each of its steps ends, if the stiffness changes by this part of itself in the first: 1, with room
    /// for what rounding does to energies, and (1 + change) / (1 - change) of that.
    pub fn regions(change: f64) -> [f64; 2] {
        [ROOM, ROOM * (1.0 + change) / (1.0 - change)]
    }

    /// Both of two parts are reached.
    pub fn and(first: Option<Reached>, second: Option<Reached>) -> Option<Reached> {
        first.and(second)
    }
}

/// Below 1, a change leaves the stiffness positive; with room for what rounding may add.
const LESS_THAN_ALL: f64 = 0.9;
/// Of the energy that the search can lose at most, rounding may add a tenth.
const ROOM: f64 = 1.05;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::Ball;

    #[test]
    fn forces_that_may_be_zero_do_not_balance() {
        assert!(Proven::prove_balance(&[Number::ZERO, Number::ZERO]).is_some());
        let near = Number::Ball(Ball::new(crate::base::Dd::ZERO, 1e-30));
        assert_eq!(Proven::prove_balance(&[Number::ZERO, near]), None);
    }

    #[test]
    fn a_box_on_its_own_edge_is_not_inside() {
        assert!(Proven::inclusion(&[0.5, 0.0], &[1.0, 0.1]).is_some());
        for (mapped, radii) in
            [([0.5, 0.1], [1.0, 0.1]), ([f64::NAN, 0.0], [1.0, 1.0]), ([1.0, 1.0], [f64::INFINITY; 2])]
        {
            assert_eq!(Proven::inclusion(&mapped, &radii), None);
        }
        assert_eq!(Proven::inclusion(&[0.5], &[1.0, 1.0]), None);
    }

    #[test]
    fn non_positive_residuals_prove_nothing() {
        assert!(Proven::convexity(0.9, 1.0, 1.0).is_some() && Proven::definiteness(1e-300).is_some());
        for (force, least, radius) in [(1.0, 1.0, 1.0), (0.0, 0.0, 1.0), (0.0, -1.0, 1.0), (f64::NAN, 1.0, 1.0)] {
            assert_eq!(Proven::convexity(force, least, radius), None);
        }
        assert_eq!([0.0, -1.0, f64::NAN, f64::INFINITY].map(Proven::definiteness), [None; 4]);
        assert!(Proven::positivity(&[1.0, 2.0], &[0.1, 0.1]).is_some());
        for (w, v) in [([1.0, 0.0], [1.0, 1.0]), ([1.0, 1.0], [1.0, f64::NAN]), ([1.0, 1.0], [1.0, -1.0])] {
            assert_eq!(Proven::positivity(&w, &v), None);
        }
    }

    #[test]
    fn a_search_that_may_leave_the_region_proves_nothing() {
        let reached = |near: [f64; 2], far: [f64; 2]| Reached::by_convexity(0.25, &near, &far, &[1.0, 2.0]);
        assert!(reached([0.2, 0.5], [0.8, 1.7]).is_some());
        assert_eq!(reached([0.3, 0.5], [0.8, 1.7]), None);
        assert_eq!(reached([0.2, 0.5], [0.8, 2.0]), None);
        assert_eq!(reached([f64::NAN, 0.5], [0.8, 1.7]), None);
        assert_eq!(Reached::by_convexity(0.25, &[0.2], &[0.8, 1.7], &[1.0, 2.0]), None);
        // A step from the edge of the first region ends within 5/3 of its distance, if stiffnesses are within a quarter.
        let [near, far] = Reached::regions(0.25);
        assert!(near > 1.0 && (far / near - 5.0 / 3.0).abs() < 1e-12);
    }

    #[test]
    fn both_of_two_proofs_are_needed() {
        let one = Proven::definiteness(1.0);
        assert!(Proven::and(one, one).is_some());
        assert_eq!([Proven::and(one, None), Proven::and(None, one)], [None, None]);
    }
}
