//! Damped poles of systems built by hand.

use super::systems::{Builder, number};
use vibc::analysis::{self, Pole, PoleKind, Poles, Stability};
use vibc::system::LinearSystem;

fn poles(system: &LinearSystem) -> Poles {
    let modes = analysis::modes(system).expect("modes");
    analysis::poles(system, &modes).expect("poles")
}

fn kinds(poles: &Poles) -> Vec<PoleKind> {
    poles.list.iter().map(|pole| pole.kind).collect()
}

fn close(pole: &Pole, re: f64, im: f64) -> bool {
    (pole.re.to_f64() - re).abs() < 1e-8 && (pole.im.to_f64() - im).abs() < 1e-8
}

/// A cart of 1 kg on a spring of 10 N/m and a damper of 5 N*s/m; on it hangs a slender rod of 0.5 kg and 2 m.
fn cart() -> LinearSystem {
    let mut cart = Builder::new(&["x", "angle"]);
    cart.mass(0, &number("1"));
    cart.inertia(&number("0.5"), &[(0, number("1")), (1, number("1"))]);
    cart.inertia(&(&number("1") / &number("6")), &[(1, number("1"))]);
    cart.spring(None, 0, &number("10"));
    cart.damper(None, 0, &number("5"));
    cart.spring(None, 1, &number("4.905"));
    cart.finish()
}

#[test]
fn the_cart_of_the_first_example() {
    let system = cart();
    let poles = poles(&system);
    let expected = [
        (-0.309953841, -2.636171869),
        (-0.309953841, 2.636171869),
        (-1.912268381, -2.371873795),
        (-1.912268381, 2.371873795),
    ];
    for (pole, (re, im)) in poles.list.iter().zip(expected) {
        assert!(close(pole, re, im), "{pole:?}");
        assert!(pole.relative_error < 1e-28, "{pole:?}");
        assert_eq!(pole.kind, PoleKind::Oscillation);
    }
    assert_eq!(poles.list.len(), 4);
}

#[test]
fn a_free_chain_with_inner_dampers_keeps_a_double_pole_at_zero() {
    let mut chain = Builder::numbered(3);
    for i in 0..3 {
        chain.mass(i, &number("1.5"));
    }
    chain.spring(Some(0), 1, &number("7"));
    chain.spring(Some(1), 2, &number("0.3"));
    chain.damper(Some(1), 2, &number("0.1"));
    let system = chain.finish();
    let poles = poles(&system);
    assert_eq!(kinds(&poles)[..2], [PoleKind::Rigid; 2]);
    assert!(poles.list[..2].iter().all(|pole| pole.re.is_zero() && pole.im.is_zero() && pole.damping_ratio.is_none()));
    assert!(poles.list[2..].iter().all(|pole| pole.kind == PoleKind::Oscillation && pole.re.is_negative()));
    assert!(poles.list.iter().all(|pole| pole.relative_error < 1e-25));
    let modes = analysis::modes(&system).expect("modes");
    assert_eq!(analysis::stability(&modes, &poles), Stability::Neutral);
}

#[test]
fn a_free_chain_dragged_on_the_ground_has_one_pole_at_zero() {
    let mut chain = Builder::numbered(3);
    for i in 0..3 {
        chain.mass(i, &number("1.5"));
    }
    chain.spring(Some(0), 1, &number("7"));
    chain.spring(Some(1), 2, &number("0.3"));
    chain.damper(None, 2, &number("0.1"));
    let poles = poles(&chain.finish());
    let rigid = poles.list.iter().filter(|pole| pole.kind == PoleKind::Rigid).count();
    let overdamped = poles.list.iter().filter(|pole| pole.kind == PoleKind::Overdamped).count();
    assert_eq!((rigid, overdamped, poles.list.len()), (1, 1, 6));
    assert!(poles.list.iter().all(|pole| pole.relative_error < 1e-25));
}

#[test]
fn an_undamped_system_has_its_poles_on_the_imaginary_axis() {
    let mut pair = Builder::numbered(2);
    pair.mass(0, &number("2"));
    pair.mass(1, &number("2"));
    pair.spring(None, 0, &number("8"));
    pair.spring(None, 1, &number("-18"));
    let system = pair.finish();
    let poles = poles(&system);
    assert_eq!(
        kinds(&poles),
        [PoleKind::Oscillation, PoleKind::Oscillation, PoleKind::Overdamped, PoleKind::Divergence]
    );
    assert!(close(&poles.list[0], 0.0, -2.0) && close(&poles.list[3], 3.0, 0.0));
    assert!(poles.list[..2].iter().all(|pole| pole.re.is_zero()));
    let modes = analysis::modes(&system).expect("modes");
    assert_eq!(analysis::stability(&modes, &poles), Stability::Unstable);
}

#[test]
fn parts_that_nothing_joins_are_solved_apart() {
    let mut three = Builder::numbered(3);
    for i in 0..3 {
        three.mass(i, &number("1"));
        three.spring(None, i, &number("4"));
    }
    three.damper(None, 1, &number("4"));
    three.damper(None, 2, &number("5"));
    let poles = poles(&three.finish());
    assert_eq!(poles.list.len(), 6);
    // An undamped pair, a critically damped one, and s^2 + 5 s + 4.
    assert_eq!(kinds(&poles).iter().filter(|kind| **kind == PoleKind::Oscillation).count(), 2);
    let together: Vec<_> = poles.list.iter().filter(|pole| pole.cluster.is_some()).collect();
    assert_eq!(together.len(), 2);
    assert!(together.iter().all(|pole| close(pole, -2.0, 0.0)));
    assert!(close(&poles.list[0], -1.0, 0.0) && close(&poles.list[5], -4.0, 0.0));
}

#[test]
fn a_negative_damper_makes_flutter_and_the_rest_unstable() {
    let mut pair = Builder::numbered(2);
    pair.mass(0, &number("1"));
    pair.mass(1, &number("2"));
    pair.spring(None, 0, &number("3"));
    pair.spring(Some(0), 1, &number("5"));
    pair.damper(None, 0, &number("-0.01"));
    let system = pair.finish();
    let poles = poles(&system);
    assert_eq!(kinds(&poles), [PoleKind::Flutter; 4]);
    let modes = analysis::modes(&system).expect("modes");
    assert_eq!(analysis::stability(&modes, &poles), Stability::Unstable);
}
