//! Compares the dense method with the methods for small problems, whose bounds are a million times smaller, and with
//! closed forms.

use super::*;
use crate::analysis::answer::{ModeKind, Modes};
use crate::analysis::modes::modes_as;
use crate::analysis::modes::request::{Request, Which};
use crate::analysis::test_systems::{blank, push};
use crate::base::{Name, Number, Words};
use crate::system::{CoordinateId, Label, LinearSystem, Nature};

/// Decimal digits from a linear congruential generator (Knuth's MMIX).
struct Digits(u64);

impl Digits {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) % n as u64) as usize
    }

    /// d.ddd with a random exponent from this many decades about zero.
    fn decimal(&mut self, decades: usize) -> String {
        let exponent = self.below(decades + 1) as i64 - decades as i64 / 2;
        format!("{}.{:03}e{exponent}", 1 + self.below(9), self.below(1000))
    }
}

/// Masses, each on springs to three earlier ones, and the first on a spring to the ground if `held`.
fn net(n: usize, decades: usize, held: bool) -> LinearSystem {
    let (mut digits, mut system) = (Digits(13 + decades as u64), blank(n));
    if held {
        push(&mut system.k, "3.7", 0, None);
    }
    for i in 0..n {
        push(&mut system.m, &digits.decimal(0), i, None);
        for _ in 0..3.min(i) {
            push(&mut system.k, &digits.decimal(decades), digits.below(i), Some(i));
        }
    }
    system
}

/// Levers that join three coordinates each by springs, and masses that move with two; some springs to the ground are
/// negative.
fn levers(n: usize, decades: usize, negative: bool) -> LinearSystem {
    let (mut digits, mut system) = (Digits(7), blank(n));
    let source = Label { name: Name::plain(Words::new().intern("")), motion: "" };
    let (of_m, of_k) = (system.m.source(source), system.k.source(source));
    let row = |entries: &[(usize, &str)]| -> Vec<(CoordinateId, Number)> {
        entries.iter().map(|(i, a)| (CoordinateId(*i as u32), Number::from(*a))).collect()
    };
    for i in 1..n {
        push(&mut system.m, &digits.decimal(0), i - 1, None);
        let mass = Number::from(digits.decimal(0).as_str());
        system.m.push(of_m, Nature::Property, mass, row(&[(i - 1, "1.3"), (i, "0.7")]));
        let ends = [digits.below(i), i];
        let mut entries = row(&[(ends[0], "0.3"), (ends[1], "1")]);
        entries[0].1 = -&entries[0].1;
        system.k.push(of_k, Nature::Property, Number::from(digits.decimal(decades).as_str()), entries);
        push(&mut system.k, &digits.decimal(decades), i, None);
        if negative && i % 7 == 3 {
            system.k.push(of_k, Nature::Property, -&Number::from("3.3"), row(&[(i, "1")]));
        }
    }
    system
}

fn all(system: &LinearSystem, tolerance: f64) -> Modes {
    modes_as(system, &Request { tolerance, ..Request::default() }).expect("modes")
}

/// Largest relative bound of the elastic modes.
fn worst(modes: &Modes) -> f64 {
    let elastic = modes.list.iter().filter(|mode| mode.kind != ModeKind::Rigid);
    elastic.map(|mode| mode.omega_squared.rad / mode.omega_squared.mid.abs().to_f64()).fold(0.0, f64::max)
}

/// Checks that the dense method's enclosures contain the values of the method for small problems. Returns the median of
/// bound over error.
fn compare(system: &LinearSystem, reached: f64) -> f64 {
    let (dense, small) = (all(system, 1e-12), all(system, 1e-30));
    assert_eq!(dense.list.len(), small.list.len());
    assert!(dense.list.iter().all(|mode| matches!(mode.route, Route::Dense | Route::Exact)));
    assert!(worst(&dense) <= reached && worst(&small) <= 1e-30, "{:e} {:e}", worst(&dense), worst(&small));
    let mut ratios = Vec::new();
    for (a, b) in dense.list.iter().zip(&small.list) {
        assert_eq!(a.kind, b.kind);
        let error = (a.omega_squared.mid - b.omega_squared.mid).abs().to_f64();
        assert!(error <= a.omega_squared.rad + b.omega_squared.rad, "{:?} {:?}", a.omega_squared, b.omega_squared);
        ratios.push(a.omega_squared.rad / error);
    }
    ratios.sort_by(f64::total_cmp);
    ratios[ratios.len() / 2]
}

#[test]
fn networks_agree_with_the_method_for_small_parts() {
    // The rounding bound of a sum is a few hundred times the rounding error on average. After a step, which the third
    // case takes, only that bound is left, and the errors are far below it.
    let cases = [(0, true, 1e-23, 1e3), (8, true, 1e-18, 1e3), (16, true, 1e-12, 1e7), (6, false, 1e-20, 1e3)];
    for (decades, held, reached, most) in cases {
        let ratio = compare(&net(64, decades, held), reached);
        assert!(ratio < most, "{decades}: {ratio}");
    }
}

#[test]
fn levers_coupled_masses_and_negative_springs_too() {
    for (decades, negative, reached) in [(4, false, 1e-20), (10, true, 1e-12)] {
        compare(&levers(65, decades, negative), reached);
    }
}

/// Equal masses on equal springs to the ground and to each other: the eigenvalue k_g/m once, (k_g + n k)/m otherwise.
#[test]
fn repeated_frequencies_are_certified_as_a_group() {
    let n = 64;
    let mut system = blank(n);
    for i in 0..n {
        push(&mut system.m, "2", i, None);
        push(&mut system.k, "3", i, None);
        (0..i).for_each(|j| push(&mut system.k, "7", j, Some(i)));
    }
    let modes = all(&system, 1e-12);
    assert!(worst(&modes) < 1e-24);
    for (i, mode) in modes.list.iter().enumerate() {
        let truth = if i == 0 { 1.5 } else { (3.0 + 7.0 * n as f64) / 2.0 };
        assert!((mode.omega_squared.mid - Dd::from(truth)).abs().to_f64() <= mode.omega_squared.rad);
        assert_eq!(mode.cluster, (i > 0).then_some(0));
    }
}

/// Two equal nets joined by springs a trillion times softer: each frequency occurs twice, with a tiny difference.
#[test]
fn close_frequencies_are_separated() {
    let (half, mut digits, mut system) = (32, Digits(5), blank(64));
    for i in 0..half {
        let (mass, ground) = (digits.decimal(0), digits.decimal(2));
        let springs: Vec<(usize, String)> = (0..2.min(i)).map(|_| (digits.below(i), digits.decimal(2))).collect();
        for at in [0, half] {
            push(&mut system.m, &mass, at + i, None);
            push(&mut system.k, &ground, at + i, None);
            springs.iter().for_each(|(other, k)| push(&mut system.k, k, at + other, Some(at + i)));
        }
        push(&mut system.k, "1e-12", i, Some(i + half));
    }
    compare(&system, 1e-24);
    assert!(all(&system, 1e-12).list.iter().all(|mode| mode.cluster.is_none()));
}

/// Compares a chain with the method for trees, whose bounds have an independent proof.
#[test]
fn a_chain_agrees_with_the_tree_method() {
    let mut system = blank(101);
    for i in 0..101 {
        push(&mut system.m, "0.3", i, None);
        push(&mut system.k, "1e4", i, i.checked_sub(1));
    }
    let dense = all(&system, 1e-12);
    let request = Request { which: Which::Lowest(12), tolerance: 1e-28, ..Request::default() };
    let tree = modes_as(&system, &request).expect("modes");
    assert_eq!((dense.list[0].route, tree.list[0].route), (Route::Dense, Route::Tree));
    for (a, b) in dense.list.iter().zip(&tree.list) {
        let error = (a.omega_squared.mid - b.omega_squared.mid).abs().to_f64();
        assert!(error <= a.omega_squared.rad + b.omega_squared.rad);
    }
}

/// Vectors that are wrong in the third digit still get bounds that hold.
#[test]
fn bounds_hold_for_poor_vectors() {
    let n = 40;
    let system = net(n, 2, true);
    let (stiffness, masses) = (Terms::of(&system.k), Terms::of(&system.m));
    let problem = Problem { n, form: &system.k, stiffness: &stiffness, masses: &masses, tolerance: 1e-12 };
    let (mut x, diagonal) = problem.first().expect("finite");
    let pencil = Pencil::new(&stiffness, &masses, &diagonal);
    let good = Candidate::of(&pencil, x.clone());
    for (size, finite) in [(1e-10, 40), (1e-6, 40), (1e-4, 20)] {
        let mut digits = Digits(3);
        x.data_mut().iter_mut().for_each(|x| *x += size * (digits.below(1000) as f64 / 500.0 - 1.0));
        let poor = Candidate::of(&pencil, x.clone());
        assert!(poor.radii.iter().filter(|radius| radius.is_finite()).count() >= finite);
        for (i, radius) in poor.radii.iter().enumerate() {
            let error = (poor.pencil.theta[i] - good.pencil.theta[i]).abs().to_f64();
            assert!(error <= radius + good.radii[i], "{size}: {error:e} {radius:e}");
        }
        // One Newton step recovers the accuracy.
        let next = Candidate::of(&pencil, step::newton_step(&poor.x, &poor.pencil).expect("finite"));
        assert!(next.worst(0) < 1e-4 * poor.worst(0).min(1.0));
    }
}
