//! Chains, whose transfer functions are quotients of determinants of tridiagonal matrices: by recurrence, in binary64.

use super::*;
use crate::analysis::test_systems::{blank, push};
use crate::analysis::transfer::extrema::{Extremum, FeatureKind};
use crate::analysis::transfer::table::{Sweep, table_around};
use crate::analysis::transfer::{Frequency, Gain};
use crate::system::LinearSystem;

/// Masses and springs that differ a little, held at the first, and dampers beside the springs.
struct Chain {
    m: Vec<f64>,
    k: Vec<f64>,
    c: Vec<f64>,
}

impl Chain {
    fn of(n: usize, c: f64) -> Chain {
        let of = |base: f64, step: f64, by: usize| (0..n).map(|i| base + step * (i * by % 8) as f64).collect();
        Chain { m: of(1.0, 0.125, 1), k: of(90.0, 2.0, 3), c: of(c, 0.5 * c, 5) }
    }

    fn system(&self) -> LinearSystem {
        let mut system = blank(self.m.len());
        for i in 0..self.m.len() {
            push(&mut system.m, &self.m[i].to_string(), i, None);
            push(&mut system.k, &self.k[i].to_string(), i, i.checked_sub(1));
            if self.c[i] != 0.0 {
                push(&mut system.c, &self.c[i].to_string(), i, i.checked_sub(1));
            }
        }
        system
    }

    /// The receptance between two masses, a < b: the determinants of what is before a and behind b, and the couplings between.
    fn truth(&self, omega: f64, a: usize, b: usize) -> Complex<f64> {
        let n = self.m.len();
        let spring = |i: usize| if i < n { Complex::new(self.k[i], omega * self.c[i]) } else { Complex::ZERO };
        let own = |i: usize| spring(i) + spring(i + 1) - Complex::real(self.m[i] * omega * omega);
        // Divided by the springs, so that nothing overflows.
        let (mut before, mut last) = (Complex::real(1.0), Complex::ZERO);
        let mut minors = vec![before];
        for i in 0..n {
            let next = (own(i) * before - spring(i) * last) * inverse(spring(i + 1));
            (last, before) = (before, next);
            minors.push(next);
        }
        let (mut behind, mut last) = (Complex::real(1.0), Complex::ZERO);
        for i in (b + 1..n).rev() {
            let next = (own(i) * behind - spring(i + 1) * last) * inverse(spring(i));
            (last, behind) = (behind, next);
        }
        // The couplings between a and b are what is left of the divisors.
        minors[a] * behind * minors[n].recip()
    }

    /// The local extrema on a fine grid: of which kind, and between which frequencies.
    fn extrema(&self, (low, high): (f64, f64), a: usize, b: usize) -> Vec<(FeatureKind, [f64; 2])> {
        let count = 10_000;
        let at = |i: usize| low + (high - low) * i as f64 / count as f64;
        let sizes: Vec<f64> = (0..=count).map(|i| self.truth(at(i), a, b).abs()).collect();
        let of = |i: usize| {
            let kind = match (sizes[i] > sizes[i - 1], sizes[i] > sizes[i + 1]) {
                (true, true) => FeatureKind::Peak,
                (false, false) => FeatureKind::Antiresonance,
                _ => return None,
            };
            Some((kind, [at(i - 1), at(i + 1)]))
        };
        (1..count).filter_map(of).collect()
    }
}

/// Of the coupling behind the last mass, one.
fn inverse(coupling: Complex<f64>) -> Complex<f64> {
    if coupling == Complex::ZERO { Complex::real(1.0) } else { coupling.recip() }
}

fn sweep(range: [&str; 2], input: usize, output: usize) -> Sweep {
    let range = range.map(Number::from);
    let features_only = true;
    Sweep { range: Some(range.into()), features_only, inputs: vec![input], outputs: vec![output], ..Sweep::default() }
}

fn hertz(extremum: &Extremum) -> f64 {
    extremum.frequency.to_f64()
}

/// Every extremum of the truth is listed and no other, between masses far from each other and next to each other, without
/// damping and with dampers that join the modes.
#[test]
fn all_extrema_of_a_part_of_the_modes_are_found_and_proved() {
    let two_pi = 2.0 * std::f64::consts::PI;
    for (c, a, b) in [(0.0, 20, 131), (0.001, 20, 131), (0.01, 70, 71), (0.015, 0, 159)] {
        let chain = Chain::of(160, c);
        let (low, high) = (0.005, 0.5);
        let found = table_around(&chain.system(), &sweep(["0.005", "0.5"], a, b));
        let found = found.expect("a small table").unwrap_or_else(|| panic!("{c}"));
        let extrema = &found.extrema.as_ref().expect("no grid")[0][0];
        assert!(extrema.is_complete());
        let truth = chain.extrema((low * two_pi, high * two_pi), a, b);
        assert!(truth.len() > 14, "{}", truth.len());
        assert_eq!(extrema.list.len(), truth.len(), "{c} {a} {b}");
        for (extremum, (kind, [from, to])) in extrema.list.iter().zip(&truth) {
            assert_eq!(extremum.kind, *kind);
            let omega = hertz(extremum) * two_pi;
            assert!(omega > *from && omega < *to, "{omega} {from} {to}");
            if let Gain::Finite(disc) = extremum.gain {
                let truth = chain.truth(omega, a, b).abs();
                let size = disc.value.to_f64().abs();
                assert!((size - truth).abs() <= 1e-7 * truth + 1e-9, "{size} {truth}");
                assert!(c == 0.0 || disc.relative_error() < 1e-14, "{:e}", disc.relative_error());
            } else {
                assert!(c == 0.0 && *kind == FeatureKind::Peak);
            }
        }
    }
}

/// The sum and an elimination at the frequency: both enclose H, and the sum is sharp.
#[test]
fn sums_enclose_what_elimination_encloses() {
    for c in [0.0, 0.01] {
        let system = Chain::of(160, c).system();
        let transfer = Transfer::of(&system);
        let surroundings = Surroundings::of(&transfer, &[20], &[131], 3.3).expect("light damping");
        let h = surroundings.pair(&transfer, (0, 20), (0, 131)).expect("bounds");
        for omega in ["0.001", "0.1", "0.33", "1.5", "2.71", "3.299"] {
            let frequency = Frequency::radians(&Number::from(omega));
            let sum = h.gain(&frequency).disc().expect("finite");
            let truth = transfer.between(&frequency, &[20], &[131])[0][0].disc().expect("finite");
            let off = (sum.value - truth.value).to_f64().abs();
            assert!(off <= sum.radius + truth.radius, "{omega}: {off:e} {:e} {:e}", sum.radius, truth.radius);
            assert!(sum.relative_error() < 1e-16, "{omega}: {:e}", sum.relative_error());
        }
        // Beyond the range, nothing is claimed.
        assert_eq!(h.gain(&Frequency::radians(&Number::from("3.31"))), Gain::Unknown);
    }
}

/// Where dampers join a mode to all its neighbours nothing is proved, and nothing is listed.
#[test]
fn heavy_dampers_and_repeated_frequencies_are_left_to_others() {
    let heavy = Chain::of(160, 100.0).system();
    assert!(table_around(&heavy, &sweep(["0.005", "0.14"], 0, 1)).expect("a small table").is_none());
    // Two equal chains beside each other.
    let chain = Chain::of(100, 0.0);
    let mut twice = blank(200);
    for i in 0..200usize {
        let (own, back) = (i % 100, if i == 100 { None } else { i.checked_sub(1) });
        push(&mut twice.m, &chain.m[own].to_string(), i, None);
        push(&mut twice.k, &chain.k[own].to_string(), i, back);
    }
    assert!(table_around(&twice, &sweep(["0.005", "0.14"], 0, 1)).expect("a small table").is_none());
}
