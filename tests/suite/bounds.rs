//! Every printed bound holds: random systems against eigenvalue counts in exact arithmetic.

use super::exact::{ExactPencil, binary, value};
use super::systems::{Builder, Random};
use num_rational::BigRational;
use vibc::analysis;
use vibc::base::{Ball, Number};
use vibc::system::{LinearSystem, Nature};

/// What a sweep saw: enclosures checked, and how many of them are more than ten times the error.
#[derive(Default)]
struct Seen {
    bounds: usize,
    loose: usize,
}

/// Checks the bounds of all frequencies of a system: the k-th eigenvalue is within the k-th enclosure.
fn check(system: &LinearSystem, seen: &mut Seen, what: &str) {
    let exact = ExactPencil::of(system);
    let modes = analysis::modes(system).expect("a regular system");
    for (k, mode) in modes.list.iter().enumerate() {
        let omega = mode.omega;
        assert!(omega.relative_error() < 1e-12, "{what}: mode {k} of {:?}", omega);
        if omega.is_zero() {
            assert!(encloses(&exact, mode.omega_squared, k, 1e-300), "{what}: mode {k} is not rigid");
            continue;
        }
        let sign = if mode.omega_squared.to_f64() < 0.0 { -1 } else { 1 };
        assert!(encloses_root(&exact, omega, k, sign, omega.rad), "{what}: mode {k}: {omega:?}");
        assert!(encloses(&exact, mode.omega_squared, k, mode.omega_squared.rad), "{what}: mode {k}: square");
        seen.bounds += 1;
        seen.loose += usize::from(encloses_root(&exact, omega, k, sign, omega.rad / 10.0));
    }
}

/// The k-th eigenvalue (from 0) is within `radius` of the ball's midpoint.
fn encloses(exact: &ExactPencil, ball: Ball, k: usize, radius: f64) -> bool {
    let (mid, radius) = (value(ball.mid), binary(radius));
    between(exact, k, &(&mid - &radius), &(mid + radius))
}

/// The same of the root of sign x eigenvalue.
fn encloses_root(exact: &ExactPencil, ball: Ball, k: usize, sign: i64, radius: f64) -> bool {
    let (mid, radius) = (value(ball.mid), binary(radius));
    let square = |x: BigRational| BigRational::from_integer(sign.into()) * &x * &x;
    let (a, b) = (square(&mid - &radius), square(mid + radius));
    if a < b { between(exact, k, &a, &b) } else { between(exact, k, &b, &a) }
}

fn between(exact: &ExactPencil, k: usize, low: &BigRational, high: &BigRational) -> bool {
    // A leading minor that vanishes exactly at a bound would make the count fail; a nudge outwards by 2^-900 does not matter.
    let nudge = binary(2f64.powi(-900));
    let count = |s: &BigRational, step: &BigRational| {
        (0..4).scan(s.clone(), |s, _| Some(std::mem::replace(s, &*s + step))).find_map(|s| exact.below(&s))
    };
    let below = count(low, &-&nudge).expect("a regular point");
    let beyond = count(high, &nudge).expect("a regular point");
    below <= k && beyond > k
}

/// A connected network of n masses with decimal springs over so many decades, `extra` more springs that close cycles.
fn network(random: &mut Random, n: usize, decades: f64, extra: usize, grounded: bool) -> LinearSystem {
    let mut b = Builder::numbered(n);
    (0..n).for_each(|i| b.mass(i, &random.decimal(decades / 2.0)));
    if grounded {
        b.spring(None, random.below(n), &random.decimal(decades));
    }
    for i in 1..n {
        let from = random.below(i);
        b.spring(Some(from), i, &random.decimal(decades));
    }
    for _ in 0..extra {
        let (i, j) = (random.below(n), random.below(n));
        if i != j {
            b.spring(Some(i), j, &random.decimal(decades));
        }
    }
    b.finish()
}

/// Rows and coupled masses of any coefficients, signs included if `mixed`.
fn levers(random: &mut Random, n: usize, decades: f64, mixed: bool) -> LinearSystem {
    let mut b = Builder::numbered(n);
    for i in 0..n {
        b.mass(i, &random.decimal(decades / 2.0));
        let row: Vec<(usize, Number)> = (0..n).map(|j| (j, random.signed())).collect();
        b.coupled_mass(&random.decimal(decades / 2.0), &row);
    }
    for t in 0..n + 1 {
        let row: Vec<(usize, Number)> = (0..n).map(|j| (j, random.signed())).collect();
        let weight = random.decimal(decades);
        let negative = mixed && t == n;
        b.stiffness(&format!("s{t}"), Nature::Property, &if negative { -&weight } else { weight }, &row);
    }
    b.finish()
}

fn assert_tight(seen: &Seen) {
    assert!(
        2 * seen.loose <= seen.bounds,
        "{} of {} bounds are more than ten times the error",
        seen.loose,
        seen.bounds
    );
}

#[test]
fn bounds_of_networks_hold_and_are_tight() {
    let (mut random, mut seen) = (Random::new(20_261_121), Seen::default());
    for i in 0..120 {
        let (n, decades) = (2 + i % 4, [0.0, 4.0, 12.0, 24.0][i / 4 % 4]);
        let system = network(&mut random, n, decades, i % 3, i % 5 != 0);
        check(&system, &mut seen, &format!("network {i}"));
    }
    assert_tight(&seen);
}

#[test]
fn bounds_of_levers_hold_and_are_tight() {
    let (mut random, mut seen) = (Random::new(4), Seen::default());
    for i in 0..60 {
        let (n, decades) = (2 + i % 3, [0.0, 4.0, 16.0][i / 3 % 3]);
        check(&levers(&mut random, n, decades, false), &mut seen, &format!("levers {i}"));
    }
    assert_tight(&seen);
}

#[test]
fn bounds_hold_with_negative_stiffness() {
    let (mut random, mut seen) = (Random::new(9), Seen::default());
    for i in 0..60 {
        let (n, decades) = (2 + i % 3, [0.0, 2.0, 6.0][i / 3 % 3]);
        check(&levers(&mut random, n, decades, true), &mut seen, &format!("mixed {i}"));
    }
    assert_tight(&seen);
}
