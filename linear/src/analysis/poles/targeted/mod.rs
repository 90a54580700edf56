//! The damped poles of a few modes of a large system, each with a proven disc. In: a system, its lowest undamped modes.
//! Out: a disc for each of the wanted modes that could be followed; of infinite size if nothing is proved. See
//! docs/method/poles.md#poles-followed-from-modes.
//!
//! 1. The undamped modes and a certified count bound the influence of all other motions on them ([`frame`]).
//! 2. Q in the span of these modes gives starts ([`projection`]), from which an iteration with sparse factors of Q(s)
//!    ([`elimination`]) converges to poles ([`iteration`]).
//! 3. About each pole a circle is found on which Rouche's theorem counts one pole ([`disc`]).
//!
//! It is not proved that no other pole lies between them: heavily damped motions of any mode may be as slow.

pub(in crate::analysis) mod around;
mod disc;
mod elimination;
mod frame;
mod iteration;
mod projection;

use crate::analysis::answer::{Mode, ModeKind};
use crate::analysis::modes::mesh::elimination::Pattern;
use crate::analysis::modes::mesh::network::Network;
use crate::analysis::modes::parts::Part;
use crate::analysis::modes::terms::Terms;
use crate::analysis::poles::discs::PoleEnclosure;
use crate::analysis::poles::pencil::Pencil;
use crate::analysis::poles::targeted::disc::disc;
use crate::analysis::poles::targeted::elimination::Networks;
use crate::analysis::poles::targeted::frame::{Forms, Frame};
use crate::analysis::poles::targeted::iteration::{Start, follow};
use crate::analysis::poles::targeted::projection::project;
use crate::base::Ball;
use crate::kernel::complex::Complex;
use crate::kernel::triple::Precise;
use crate::system::LinearSystem;

/// The poles of least |s| in the upper half plane, as many as there are oscillations among the first `wanted` modes,
/// without those that could not be followed; `None` if the system is not sparse. `modes` are the lowest modes without a
/// gap; those beyond the wanted ones serve only for proofs.
pub fn lowest_poles(
    system: &LinearSystem,
    whole: &Part,
    modes: &[Mode],
    wanted: usize,
    tolerance: f64,
) -> Option<Vec<PoleEnclosure>> {
    let large = Large::of(system, whole)?;
    let pencil = large.exact.to_dd();
    let frame = large.frame(modes, wanted);
    let oscillations = modes.iter().take(wanted).filter(|mode| mode.kind == ModeKind::Oscillation).count();
    let starts =
        frame.as_ref().and_then(|frame| project(frame, oscillations)).unwrap_or_else(|| undamped_starts(modes, wanted));
    let found = starts.iter().filter_map(|start| {
        let pair = follow(&large.networks, &pencil, start)?;
        let proved = frame.as_ref().and_then(|frame| disc(frame, &large.exact, &pair, start.mode, tolerance));
        Some(proved.unwrap_or_else(|| unproved_disc(pair.s.to_ball())))
    });
    Some(discard_overlapping(found.collect()))
}

/// Starts from the undamped oscillations.
fn undamped_starts(modes: &[Mode], wanted: usize) -> Vec<Start> {
    let oscillations = modes.iter().take(wanted).enumerate().filter(|(_, mode)| mode.kind == ModeKind::Oscillation);
    let start = |(mode, found): (usize, &Mode)| Start {
        s: Complex::new(0.0, found.omega.mid.hi),
        x: found.shape.iter().map(|&x| Complex::real(x)).collect(),
        mode,
    };
    oscillations.map(start).collect()
}

/// A system in the representations that the steps need.
struct Large<'a> {
    forms: Forms<'a>,
    networks: Networks,
    exact: Pencil<Precise>,
}

impl<'a> Large<'a> {
    fn of(system: &'a LinearSystem, whole: &Part) -> Option<Large<'a>> {
        let forms = Forms { k: Terms::of(&system.k), c: Terms::of(&system.c), m: Terms::of(&system.m) };
        let n = system.n();
        let of = |terms: &Terms| Network::of(terms, n).filter(|_| terms.is_finite());
        let (k, c, m) = (of(&forms.k)?, of(&forms.c)?, of(&forms.m)?);
        let pattern = Pattern::of(&[&k, &m, &c])?;
        let local: Vec<u32> = (0..n as u32).collect();
        Some(Large { forms, networks: Networks { k, m, c, pattern }, exact: Pencil::of(system, whole, &local) })
    }

    fn frame(&self, modes: &[Mode], wanted: usize) -> Option<Frame<'_>> {
        let columns: Vec<(f64, &[f64])> =
            modes.iter().map(|mode| (mode.omega_squared.mid.hi, &mode.shape[..])).collect();
        Frame::of(&self.forms, &self.networks, &columns, wanted)
    }
}

/// A disc for a midpoint of which nothing is proved.
fn unproved_disc(s: Complex<Ball>) -> PoleEnclosure {
    let unknown = |x: Ball| Ball::new(x.mid, f64::INFINITY);
    PoleEnclosure { s: Complex::new(unknown(s.re), unknown(s.im)), clusters: [None; 2] }
}

/// Discs that touch may contain the same pole: then neither is proved.
fn discard_overlapping(discs: Vec<PoleEnclosure>) -> Vec<PoleEnclosure> {
    let meets = |i: usize, j: usize| {
        let d = discs[i].s - discs[j].s;
        i != j && discs[i].is_certified() && discs[j].is_certified() && d.re.contains_zero() && d.im.contains_zero()
    };
    let alone = |i: usize| !(0..discs.len()).any(|j| meets(i, j));
    (0..discs.len()).map(|i| if alone(i) { discs[i] } else { unproved_disc(discs[i].s) }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::test_systems::{blank, push};
    use crate::analysis::{Modes, Pole, modes, poles};

    /// Numbers with decimal mantissas from a linear congruential generator (Knuth's MMIX).
    struct Digits(u64);

    impl Digits {
        fn below(&mut self, n: u64) -> u64 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 33) % n
        }

        fn decimal(&mut self, exponent: i32, decades: u64) -> String {
            let e = exponent + self.below(decades + 1) as i32 - decades as i32 / 2;
            format!("{}.{:03}e{e}", 1 + self.below(9), self.below(1000))
        }
    }

    /// A chain with springs also to second neighbours, and dampers of about 10^c parallel to all springs.
    pub(super) fn band(n: usize, k_decades: u64, c: i32, c_decades: u64, held: bool, seed: u64) -> LinearSystem {
        let (mut system, mut digits) = (blank(n), Digits(seed));
        for i in 0..n {
            push(&mut system.m, &digits.decimal(0, 0), i, None);
            for back in 1..=2 {
                if i >= back {
                    push(&mut system.k, &digits.decimal(3, k_decades), i, Some(i - back));
                    push(&mut system.c, &digits.decimal(c, c_decades), i, Some(i - back));
                }
            }
        }
        if held {
            push(&mut system.k, "31.7", 0, None);
            push(&mut system.c, "0.01", 0, None);
        }
        system
    }

    fn followed_discs(system: &LinearSystem, all: &Modes, wanted: usize) -> Vec<PoleEnclosure> {
        let list = &all.list[..wanted + 6];
        lowest_poles(system, &Part::whole(system), list, wanted, 1e-12).expect("sparse")
    }

    fn distance(disc: &PoleEnclosure, pole: &Pole) -> f64 {
        let part = |a: Ball, b: Ball| (a.mid - b.mid).to_f64();
        part(disc.s.re, pole.re).hypot(part(disc.s.im, pole.im))
    }

    /// The number of known poles within a disc.
    fn poles_within(disc: &PoleEnclosure, truth: &[Pole]) -> usize {
        let room = |pole: &Pole| disc.s.radius() + pole.re.rad.hypot(pole.im.rad);
        truth.iter().filter(|pole| distance(disc, pole) <= room(pole)).count()
    }

    /// Compares with the method for all poles at once: each disc contains one of them, and no two the same.
    #[test]
    fn discs_hold_poles_of_the_whole_system() {
        for (k_decades, c, c_decades, is_held) in
            [(0, -3, 2, true), (6, -4, 4, true), (2, -1, 1, true), (2, -2, 2, false)]
        {
            let system = band(40, k_decades, c, c_decades, is_held, 5);
            let all = modes(&system).expect("modes");
            let truth = poles(&system, &all).expect("poles").list;
            let discs = followed_discs(&system, &all, 12);
            assert_eq!(discs.len(), if is_held { 12 } else { 11 });
            for disc in &discs {
                assert!(disc.is_certified(), "{k_decades} {c}: {disc:?}");
                assert_eq!(poles_within(disc, &truth), 1, "{disc:?}");
                assert!(disc.s.radius() <= 1e-20 * disc.s.mid().to_f64().abs(), "{disc:?}");
            }
        }
    }

    /// Light and heavy dampers: a proved disc contains one pole, however strongly motions are coupled.
    #[test]
    fn no_disc_is_proved_that_holds_no_pole() {
        let (mut proved, mut found) = (0, 0);
        for seed in 0..24 {
            let system = band(24, seed % 4 * 2, seed as i32 % 5 - 2, 2, seed % 3 > 0, seed + 1);
            let all = modes(&system).expect("modes");
            let truth = poles(&system, &all).expect("poles").list;
            let discs = followed_discs(&system, &all, 8);
            found += discs.len();
            for disc in discs.iter().filter(|disc| disc.is_certified()) {
                proved += 1;
                assert_eq!(poles_within(disc, &truth), 1, "seed {seed}: {disc:?}");
            }
        }
        assert!(2 * proved > found, "{proved} of {found}");
    }

    /// Wrong vectors and numbers: the disc is wider, and still valid.
    #[test]
    fn a_disc_is_as_wide_as_its_pair_is_wrong() {
        let system = band(40, 2, -2, 2, true, 5);
        let all = modes(&system).expect("modes");
        let truth = poles(&system, &all).expect("poles").list;
        let large = Large::of(&system, &Part::whole(&system)).expect("sparse");
        let (frame, pencil) = (large.frame(&all.list[..14], 8).expect("a gap"), large.exact.to_dd());
        let mut digits = Digits(9);
        for index in 0..8 {
            let start = undamped_starts(&all.list[..8], 8).swap_remove(index);
            let right = follow(&large.networks, &pencil, &start).expect("a pole");
            for size in [1e-4, 1e-7, 1e-12] {
                let mut pair = right.clone();
                let mut slip = || size * (digits.below(2001) as f64 / 1000.0 - 1.0);
                let omega = pair.s.to_f64().abs();
                pair.s = pair.s + Complex::new(slip() * omega, slip() * omega).into();
                (0..40).for_each(|i| pair.x.add(i, Complex::new(slip(), slip())));
                let Some(disc) = disc(&frame, &large.exact, &pair, index, 1e-12) else {
                    assert!(size > 1e-6, "{size:e}");
                    continue;
                };
                assert_eq!(poles_within(&disc, &truth), 1, "{size:e} {disc:?}");
                assert!(disc.s.radius() > 1e-4 * size * size * omega, "{size:e} {disc:?}");
            }
        }
    }

    /// A vector that is a mixture of two motions, a number between two poles, and pairs that are far off: a circle
    /// without a proof by Rouche's theorem gives no disc.
    #[test]
    fn non_poles_get_no_disc() {
        let system = band(40, 2, -2, 2, true, 5);
        let all = modes(&system).expect("modes");
        let truth = poles(&system, &all).expect("poles").list;
        let large = Large::of(&system, &Part::whole(&system)).expect("sparse");
        let (frame, pencil) = (large.frame(&all.list[..14], 8).expect("a gap"), large.exact.to_dd());
        let starts = undamped_starts(&all.list[..8], 8);
        let pairs: Vec<_> =
            starts.iter().map(|start| follow(&large.networks, &pencil, start).expect("a pole")).collect();
        for index in 0..7 {
            let (a, b) = (&pairs[index], &pairs[index + 1]);
            let mut between = a.clone();
            between.s = (a.s.to_f64() + b.s.to_f64()).scale(0.5).into();
            (0..40).for_each(|i| between.x.add(i, b.x.entry(i).to_f64()));
            assert_eq!(disc(&frame, &large.exact, &between, index, 1e-12), None, "{index}");
        }
        let (mut digits, mut refused) = (Digits(3), 0);
        for (index, right) in pairs.iter().enumerate() {
            for size in [1.0, 0.3, 0.1, 0.03] {
                let mut pair = right.clone();
                let mut slip = || size * (digits.below(2001) as f64 / 1000.0 - 1.0);
                (0..40).for_each(|i| pair.x.add(i, Complex::new(slip(), slip())));
                match disc(&frame, &large.exact, &pair, index, 1e-12) {
                    Some(disc) => assert_eq!(poles_within(&disc, &truth), 1, "{size:e} {disc:?}"),
                    None => refused += 1,
                }
            }
        }
        assert!(refused >= 16, "{refused}");
    }

    /// s^2 + 2 zeta_j omega_j s + omega_j^2 for C = alpha M + beta K, which is not recognised as such here.
    #[test]
    fn proportional_damping_has_its_closed_form() {
        let mut system = band(30, 2, 0, 0, true, 5);
        system.c = crate::system::Form::new();
        crate::analysis::damping::rayleigh(&mut system, &"0.01".into(), &"0.0001".into());
        let all = modes(&system).expect("modes");
        for (disc, mode) in followed_discs(&system, &all, 8).iter().zip(&all.list) {
            let omega = mode.omega.to_f64();
            let decay = 0.5 * (0.01 + 0.0001 * omega * omega);
            assert!((disc.s.mid().to_f64().re + decay).abs() <= 1e-14 * decay, "{disc:?}");
            assert!(disc.s.radius() <= 1e-25 * omega, "{disc:?}");
        }
    }
}
