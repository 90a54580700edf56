//! The damped poles of a few modes of a large system, each with a disc that proves it. In: a system, its lowest undamped modes.
//! Out: a disc for each of the modes wanted that could be followed; of infinite size where nothing is proved. Clause: spec.md 11.11.
//!
//! 1. Each mode is followed to a pole ([`iteration`]), with sparse factors of Q(s) ([`elimination`]).
//! 2. The undamped modes and a count that holds bound what all other motions do to it ([`frame`]).
//! 3. A circle about each is found on which Rouche's theorem counts one pole ([`disc`]).
//!
//! That no other pole lies between is not proved: heavily damped motions of any mode may be as slow.

mod disc;
mod elimination;
mod frame;
mod iteration;

use crate::analysis::answer::{Mode, ModeKind};
use crate::analysis::modes::mesh::elimination::Pattern;
use crate::analysis::modes::mesh::network::Network;
use crate::analysis::modes::parts::Part;
use crate::analysis::modes::terms::Terms;
use crate::analysis::numeric::complex::Complex;
use crate::analysis::poles::discs::Disc;
use crate::analysis::poles::pencil::Pencil;
use crate::analysis::poles::targeted::disc::disc;
use crate::analysis::poles::targeted::elimination::Networks;
use crate::analysis::poles::targeted::frame::{Forms, Frame};
use crate::analysis::poles::targeted::iteration::follow;
use crate::base::Ball;
use crate::system::LinearSystem;

/// The poles in the upper half plane of the oscillations among the first `wanted` modes, in their order, without
/// those that could not be followed; `None` where the system is not sparse. `modes` are the lowest, all of them up to the last; those beyond the wanted ones only prove.
pub fn targeted(
    system: &LinearSystem,
    whole: &Part,
    modes: &[Mode],
    wanted: usize,
    tolerance: f64,
) -> Option<Vec<Disc>> {
    let forms = Forms { k: Terms::of(&system.k), c: Terms::of(&system.c), m: Terms::of(&system.m) };
    let n = system.n();
    let of = |terms: &Terms| Network::of(terms, n).filter(|_| terms.is_finite());
    let (k, c, m) = (of(&forms.k)?, of(&forms.c)?, of(&forms.m)?);
    let pattern = Pattern::of(&[&k, &m, &c])?;
    let networks = Networks { k, c, m, pattern };
    let local: Vec<u32> = (0..n as u32).collect();
    let exact = Pencil::of(system, whole, &local);
    let pencil = exact.to_dd();
    let columns: Vec<(f64, &[f64])> = modes.iter().map(|mode| (mode.omega_squared.mid.hi, &mode.shape[..])).collect();
    let frame = Frame::of(&forms, &networks, &columns, wanted);
    let oscillations = modes.iter().take(wanted).enumerate().filter(|(_, mode)| mode.kind == ModeKind::Oscillation);
    let found = oscillations.filter_map(|(index, mode)| {
        let pair = follow(&networks, &pencil, mode.omega.mid.hi, &mode.shape)?;
        let proved = frame.as_ref().and_then(|frame| disc(frame, &exact, &pair, index, tolerance));
        Some(proved.unwrap_or_else(|| unproved(pair.s.to_ball())))
    });
    Some(apart(found.collect()))
}

/// The midpoint was found, and nothing is proved of it.
fn unproved(s: Complex<Ball>) -> Disc {
    let unknown = |x: Ball| Ball::new(x.mid, f64::INFINITY);
    Disc { s: Complex::new(unknown(s.re), unknown(s.im)), clusters: [None; 2] }
}

/// Discs that meet may hold one pole together: then neither proves its own.
fn apart(discs: Vec<Disc>) -> Vec<Disc> {
    let meets = |i: usize, j: usize| {
        let d = discs[i].s - discs[j].s;
        i != j && discs[i].is_certified() && discs[j].is_certified() && d.re.contains_zero() && d.im.contains_zero()
    };
    let alone = |i: usize| !(0..discs.len()).any(|j| meets(i, j));
    (0..discs.len()).map(|i| if alone(i) { discs[i] } else { unproved(discs[i].s) }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::test_systems::{blank, push};
    use crate::analysis::{Modes, modes, poles};

    /// Numbers with decimal mantissas from a linear congruence (Knuth's MMIX).
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

    /// A chain with springs to the second neighbour too, and dampers beside all, of about 10^c.
    fn band(n: usize, k_decades: u64, c: i32, c_decades: u64, held: bool) -> LinearSystem {
        let (mut system, mut digits) = (blank(n), Digits(5));
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

    fn followed(system: &LinearSystem, all: &Modes, wanted: usize) -> Vec<Disc> {
        let list = &all.list[..wanted + 6];
        targeted(system, &Part::whole(system), list, wanted, 1e-12).expect("sparse")
    }

    fn distance(disc: &Disc, re: Ball, im: Ball) -> f64 {
        let part = |a: Ball, b: Ball| (a.mid - b.mid).to_f64();
        part(disc.s.re, re).hypot(part(disc.s.im, im))
    }

    /// Against all poles at once, another road: each disc holds one of them, and no two the same.
    #[test]
    fn discs_hold_poles_of_the_whole_system() {
        for (k_decades, c, c_decades, held) in [(0, -3, 2, true), (6, -4, 4, true), (2, -1, 1, true), (2, -2, 2, false)]
        {
            let system = band(40, k_decades, c, c_decades, held);
            let all = modes(&system).expect("modes");
            let truth = poles(&system, &all).expect("poles").list;
            let mut taken = Vec::new();
            let discs = followed(&system, &all, 12);
            assert_eq!(discs.len(), if held { 12 } else { 11 });
            for disc in &discs {
                assert!(disc.is_certified(), "{k_decades} {c}: {disc:?}");
                let near = |i: &usize| distance(disc, truth[*i].re, truth[*i].im);
                let best = (0..truth.len()).min_by(|a, b| near(a).total_cmp(&near(b))).expect("poles");
                let known = truth[best].re.rad.hypot(truth[best].im.rad);
                assert!(near(&best) <= disc.s.radius() + known, "{disc:?} {:?}", truth[best]);
                assert!(disc.s.radius() <= 1e-20 * disc.s.mid().to_f64().abs(), "{disc:?}");
                assert!(!taken.contains(&best));
                taken.push(best);
            }
        }
    }

    /// s^2 + 2 zeta_j omega_j s + omega_j^2 for C = alpha M + beta K, here not recognised as such.
    #[test]
    fn proportional_damping_has_its_closed_form() {
        let mut system = band(30, 2, 0, 0, true);
        system.c = crate::system::Form::new();
        crate::analysis::damping::rayleigh(&mut system, &"0.01".into(), &"0.0001".into());
        let all = modes(&system).expect("modes");
        for (disc, mode) in followed(&system, &all, 8).iter().zip(&all.list) {
            let omega = mode.omega.to_f64();
            let decay = 0.5 * (0.01 + 0.0001 * omega * omega);
            assert!((disc.s.mid().to_f64().re + decay).abs() <= 1e-14 * decay, "{disc:?}");
            assert!(disc.s.radius() <= 1e-25 * omega, "{disc:?}");
        }
    }
}
