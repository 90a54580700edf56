//! Pitfalls of numerical vibration analysis in which other programs have been caught, each with its name: what goes
//! wrong, and a test that it does not happen here. (`literals` shows that both readings of a literal are correct.)

use super::exact::{binary, value};
use super::systems::{Builder, HardCase, Random, number};
use super::transfer::with_every_pair;
use num_rational::BigRational;
use vibc::analysis::{self, Frequency, ModeKind, Request, Transfer, Which, respond};
use vibc::base::number::dd::two_prod;
use vibc::base::{Ball, Number};
use vibc::system::{CoordinateId, LinearSystem};

/// n masses between n + 1 springs, both ends held.
fn chain(n: usize, stiffness: impl Fn(usize) -> Number) -> LinearSystem {
    let mut b = Builder::numbered(n);
    (0..n).for_each(|i| b.mass(i, &number("1")));
    for i in 0..=n {
        b.spring(i.checked_sub(1).filter(|_| i < n), i.min(n - 1), &stiffness(i));
    }
    b.finish()
}

/// Inverse iteration from a vector that is linear in the index never finds the modes that are orthogonal to it. With
/// damping, so that poles are found by such iterations: 2 sin(i pi / 2 (n + 1)) for unit masses and springs.
#[test]
fn a_nice_start_vector_misses_no_symmetric_mode() {
    let n = 9;
    let mut system = chain(n, |_| number("1"));
    let mut b = Builder::numbered(n);
    // The dampers are as symmetric as the rest, and not proportional.
    b.damper(None, 0, &number("1e-6"));
    b.damper(None, n - 1, &number("1e-6"));
    system.c = b.finish().c;
    let modes = analysis::modes(&system).expect("modes");
    let poles = analysis::poles(&system, &modes).expect("poles");
    let upper: Vec<f64> = poles.list.iter().map(|pole| pole.im.to_f64()).filter(|im| *im > 0.0).collect();
    for i in 1..=n {
        let omega = 2.0 * (i as f64 * std::f64::consts::PI / (2 * (n + 1)) as f64).sin();
        assert!((modes.list[i - 1].omega.to_f64() - omega).abs() < 1e-14);
        assert!((upper[i - 1] - omega).abs() < 1e-10, "{:?}", upper);
    }
}

/// Stiffnesses that are powers of two are added without rounding, so plain elimination looks exact: a sweep over such
/// numbers tests nothing. Those of the sweeps have decimal mantissas, and their sums round.
#[test]
fn random_stiffnesses_are_no_powers_of_two() {
    let mut random = Random::new(3);
    let rounds = |_| {
        let (a, b) = (random.decimal(24.0).to_f64(), random.decimal(24.0).to_f64());
        binary(a) + binary(b) != binary(a + b)
    };
    let rounded = (0..400).map(rounds).filter(|rounded| *rounded).count();
    assert!(rounded > 300, "{rounded} of 400 sums round");
}

/// At the frequency of a branch its impedance is infinite: a recursion over the tree divides by zero exactly at the
/// antiresonance for which the branch was built. There the driven mass is exactly at rest.
#[test]
fn an_antiresonance_of_a_branch_is_no_division_by_zero() {
    let mut b = Builder::numbered(2);
    b.mass(0, &number("3"));
    b.mass(1, &number("1"));
    b.spring(None, 0, &number("7"));
    b.spring(Some(0), 1, &number("4"));
    let system = with_every_pair(b.finish());
    let gains = Transfer::of(&system).at(&Frequency::radians(&number("2")));
    let standing = gains[0][0].disc().expect("finite");
    assert_eq!(standing.value.re.to_f64().abs() + standing.value.im.to_f64().abs(), 0.0);
    assert!(standing.radius < 1e-28);
    // The branch carries the force: x2 = -F / k2.
    assert!((gains[1][0].disc().expect("finite").value.re.to_f64() + 0.25).abs() < 1e-16);
}

/// Double-double seems safe for assembled matrices, but keeps only 8 digits of this chain, with springs of 1e-12 and
/// 1e12 N/m.
#[test]
fn terms_hold_what_assembled_matrices_lose_even_in_double_double() {
    let case = HardCase::load("o02_chain_zigzag");
    let modes = analysis::modes(&case.system).expect("modes");
    let assembled = case.system.k.assemble(case.system.n());
    let lost = assembled.iter().enumerate().filter(|(i, row)| {
        let terms = case.system.k.terms();
        let on_diagonal = terms.filter(|term| case.system.k.row(*term).iter().any(|(j, _)| j.index() == *i));
        let least = on_diagonal.map(|term| term.weight.to_f64()).fold(f64::INFINITY, f64::min);
        // The softer spring has fewer than nine digits left in the sum.
        least < 1e9 * row[*i].mid.hi * 2f64.powi(-105)
    });
    assert!(lost.count() > 0, "the case is not graded enough to show anything");
    for (i, mode) in modes.list.iter().enumerate() {
        let truth = case.reference(&format!("omega_{}", i + 1)).expect("a reference");
        let (error, holds) = super::systems::error(mode.omega, &truth, 1e-35 * truth.to_f64());
        assert!(holds && error <= 1e-30 * truth.to_f64(), "mode {}: {error:e}", i + 1);
    }
}

/// Squaring exp(A h) - 1 to the end leaves no digit of a motion that has decayed. Critically damped at 2/s, after 40 s:
/// (1 + 80) exp(-80), 1e-33 of the start, must have correct digits.
#[test]
fn decayed_motions_keep_their_digits() {
    let mut b = Builder::numbered(1);
    b.mass(0, &number("1"));
    b.spring(None, 0, &number("4"));
    b.damper(None, 0, &number("4"));
    let mut system = with_every_pair(b.finish());
    system.initial = vec![(CoordinateId(0), Number::ONE, Number::ZERO)];
    let history = respond(&system, &[Vec::new()], &[number("40")]).expect("a motion");
    let truth = (&number("81") * &number("-80").exp().expect("in range")).to_ball();
    let found: Ball = history.values[0][0];
    let difference = (found - truth).magnitude();
    assert!(difference <= 1e-13 * truth.mid.hi, "{found:?}, {truth:?}");
}

/// A shift mu m added to a stiff diagonal is lost before signs are counted: for 120 masses in stiff pairs on soft
/// springs, the lowest modes are those of 60 double masses, and none is missed.
#[test]
fn a_shift_keeps_its_digits_next_to_stiff_diagonals() {
    let n = 120;
    let system = chain(n, |i| number(if i % 2 == 1 { "1e17" } else { "1" }));
    // Accurate enough for comparison with the closed form in binary64, whose own rounding error is a few 1e-16.
    let request = Request { which: Which::Lowest(6), tolerance: 1e-14, ..Request::default() };
    let modes = analysis::modes_as(&system, &request).expect("modes");
    for (i, mode) in (1..).zip(modes.list.iter()) {
        // Springs 0, 2, ..., n are soft: 61 of them hold 60 double masses.
        let omega = 2f64.sqrt() * (f64::from(i) * std::f64::consts::PI / (2 * (n / 2 + 1)) as f64).sin();
        assert_eq!(mode.kind, ModeKind::Oscillation);
        assert!(mode.omega.relative_error() <= request.tolerance, "mode {i}: {:?}", mode.omega);
        assert!((mode.omega.to_f64() / omega - 1.0).abs() < 1.1e-14, "mode {i}: {:?}, {omega}", mode.omega);
    }
    assert_eq!(modes.list.len(), 6);
}

/// A fused multiply-add that rounds twice (as some run-time libraries emulate it) invalidates every double-double
/// product.
#[test]
fn products_have_no_error_that_is_not_known() {
    let mut random = Random::new(8);
    for _ in 0..200 {
        let (a, b) = (random.decimal(20.0).to_f64(), random.signed().to_f64());
        let (high, low) = two_prod(a, b);
        let exact: BigRational = binary(a) * binary(b);
        assert_eq!(value(vibc::base::Dd { hi: high, lo: low }), exact, "{a:e} x {b:e}");
    }
}
