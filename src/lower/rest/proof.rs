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

    /// Where no force depends on what is a range, the search for one value is that for all.
    pub fn by_one_search() -> Reached {
        Reached(())
    }

    /// A quadratic energy has no other rest than one that is isolated.
    pub fn of_linear(proven: Option<Proven>) -> Option<Reached> {
        proven.map(|_| Reached(()))
    }

    /// Where a step may lead while the energy is at most as drawn, the stiffness changes by a part of itself at the most: `changes` are
    /// upper bounds of what 1 less the stiffness over that of the middle makes of a vector with the entries `of`, within
    /// [`Reached::reach_of_steps`]. See docs/method/rest.md#where-the-search-ends.
    pub fn by_convexity(change: f64, changes: &[f64], of: &[f64]) -> Option<Reached> {
        let is_small = |(own, of): (&f64, &f64)| *own <= change * of && of.is_finite();
        (changes.len() == of.len() && changes.iter().zip(of).all(is_small)).then_some(Reached(()))
    }

    /// How far from the rest each step of the search ends, in units of the most that the drawing may be away and in the norm of the
    /// stiffness, if that changes by a part of itself below 1/2: 1 / sqrt(1 - (change / (1 - change))^2), and some room.
    pub fn reach_of_steps(change: f64) -> f64 {
        let turned = change / (1.0 - change);
        ROOM / (1.0 - turned * turned).sqrt()
    }

    /// Both of two parts are reached.
    pub fn and(first: Option<Reached>, second: Option<Reached>) -> Option<Reached> {
        first.and(second)
    }
}

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
        let reached = |changes: &[f64]| Reached::by_convexity(0.25, changes, &[1.0, 2.0]);
        assert!(reached(&[0.2, 0.5]).is_some());
        assert_eq!([&[0.3, 0.5][..], &[0.2, 0.6], &[f64::NAN, 0.5], &[0.2]].map(reached), [None; 4]);
    }

    /// A step -(H + s D)^-1 G e from e leads no farther than is said, and hardly less far for some H and G within c of 1, D that is
    /// positive and s >= 0: planes at random.
    #[test]
    fn a_step_ends_in_the_region() {
        let mut state = 7u64;
        let mut random = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        for change in [0.25, 0.3] {
            let most = Reached::reach_of_steps(change) / ROOM;
            let mut longest = 0.0f64;
            for _ in 0..100_000 {
                let mut turned = |[a, b]: [f64; 2]| {
                    let (sine, cosine) = (std::f64::consts::TAU * random()).sin_cos();
                    nalgebra::Matrix2::new(
                        a * cosine * cosine + b * sine * sine,
                        (a - b) * sine * cosine,
                        (a - b) * sine * cosine,
                        a * sine * sine + b * cosine * cosine,
                    )
                };
                let ends = [1.0 - change, 1.0 + change];
                let (h, g, d) = (turned(ends), turned(ends), turned([1e-3, 1.0]));
                let shift = if random() < 0.5 { 0.0 } else { 10f64.powf(6.0 * random() - 3.0) };
                let e = nalgebra::Vector2::new(1.0, 0.0);
                let step = (h + d * shift).try_inverse().expect("positive") * (g * e);
                longest = longest.max((e - step).norm());
            }
            assert!(longest <= most && longest > 1.0 + 0.5 * (most - 1.0), "{change} {longest}");
        }
    }

    #[test]
    fn both_of_two_proofs_are_needed() {
        let one = Proven::definiteness(1.0);
        assert!(Proven::and(one, one).is_some());
        assert_eq!([Proven::and(one, None), Proven::and(None, one)], [None, None]);
    }
}
