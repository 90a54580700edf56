//! Undamped modes of linear systems built by hand: frequencies, shapes, shares, and what is refused.

use super::systems::{Builder, number};
use vibc::analysis::{self, AnalysisError, ModeKind, Normalise, normalise};
use vibc::base::Number;
use vibc::system::{CoordinateKind, LinearSystem, Nature};

/// A cart of 1 kg on a spring of 10 N/m carrying a rod of 0.5 kg, 1 m, hanging: M = [1.5 0.5*0.5; ...] from its two bodies.
fn cart() -> LinearSystem {
    let mut b = Builder::new(&["block.x", "rod.angle"]);
    b.mass(0, &number("1"));
    let label = b.label("rod");
    let source = b.m.source(label);
    let id = |i| vibc::system::CoordinateId(i);
    b.m.push(source, Nature::Property, number("0.5"), [(id(0), number("1")), (id(1), number("1"))]);
    b.m.push(source, Nature::Property, &Number::from(1) / &Number::from(6), [(id(1), number("1"))]);
    b.stiffness("k1", Nature::Property, &number("10"), &[(0, number("1"))]);
    b.stiffness("gravity", Nature::Geometric, &number("4.905"), &[(1, number("1"))]);
    b.kind(1, CoordinateKind::Rotation);
    b.finish()
}

#[test]
fn the_cart_has_its_published_frequencies_and_shapes() {
    let system = cart();
    let modes = analysis::modes(&system).expect("a regular system");
    let expected = [(2.15817927443011, 1.29393000254), (3.74715239993107, -1.57561535762)];
    for (mode, (omega, ratio)) in modes.list.iter().zip(expected) {
        assert!((mode.omega.to_f64() / omega - 1.0).abs() < 1e-14, "{:?}", mode.omega);
        assert!(mode.omega.relative_error() < 1e-29);
        let shape = normalise(mode, &system, Normalise::Translation);
        assert_eq!(shape[0], 1.0);
        assert!((shape[1] - ratio).abs() < 1e-11, "{shape:?}");
    }
}

#[test]
fn shares_name_what_moves_and_what_holds() {
    let system = cart();
    let modes = analysis::modes(&system).expect("a regular system");
    for mode in &modes.list {
        let kinetic: f64 = mode.kinetic.iter().map(|share| share.part).sum();
        let strain: f64 = mode.strain.iter().map(|share| share.part).sum();
        assert!((kinetic - 1.0).abs() < 1e-14 && (strain - 1.0).abs() < 1e-14);
    }
    // In phase, the rod's weight and the spring both hold; the strain energies are 10 x^2 and 4.905 theta^2.
    let low = &modes.list[0];
    let (x, theta) = (1.0, 1.29393000254f64);
    let spring = 10.0 * x * x / (10.0 * x * x + 4.905 * theta * theta);
    let share = low.strain.iter().find(|share| system.display(share.of) == "k1").expect("the spring has a share");
    assert!((share.part - spring).abs() < 1e-10);
}

#[test]
fn an_upright_rod_on_a_weak_hinge_diverges() {
    // J = 1/3, k = 2 - m g l / 2 = 2 - 4.905: omega^2 = -8.715 1/s^2.
    let mut b = Builder::new(&["rod.angle"]);
    b.mass(0, &(&Number::from(1) / &Number::from(3)));
    b.stiffness("hinge", Nature::Property, &number("2"), &[(0, number("1"))]);
    b.stiffness("gravity", Nature::Geometric, &number("-4.905"), &[(0, number("1"))]);
    let modes = analysis::modes(&b.finish()).expect("a regular system");
    let mode = &modes.list[0];
    assert_eq!(mode.kind, ModeKind::Divergence);
    assert!((mode.omega_squared.to_f64() + 8.715).abs() < 1e-14);
    assert!((mode.omega.to_f64() - 8.715f64.sqrt()).abs() < 1e-14 && mode.omega.relative_error() < 1e-29);
}

#[test]
fn exactly_at_buckling_the_motion_is_rigid() {
    let mut b = Builder::new(&["rod.angle", "cart.x"]);
    b.mass(0, &number("0.3"));
    b.mass(1, &number("1"));
    b.stiffness("hinge", Nature::Property, &number("9.81"), &[(0, number("1"))]);
    b.stiffness("gravity", Nature::Geometric, &number("-9.81"), &[(0, number("1"))]);
    b.spring(None, 1, &number("3"));
    let modes = analysis::modes(&b.finish()).expect("a regular system");
    assert_eq!(modes.list[0].kind, ModeKind::Rigid);
    assert!(modes.list[0].omega.is_zero());
    assert_eq!(modes.list[1].kind, ModeKind::Oscillation);
}

#[test]
fn a_rigid_motion_in_an_irrational_direction_is_exactly_zero() {
    // A point with two freedoms held by one spring at 60 degrees: it moves freely across.
    let mut b = Builder::numbered(2);
    (0..2).for_each(|i| b.mass(i, &number("2")));
    let sine = &number("3").sqrt().expect("positive") / &number("2");
    b.stiffness("s", Nature::Property, &number("50"), &[(0, number("0.5")), (1, sine)]);
    let modes = analysis::modes(&b.finish()).expect("a regular system");
    assert_eq!(modes.list[0].kind, ModeKind::Rigid);
    assert!(modes.list[0].omega.is_zero());
    assert!((modes.list[1].omega.to_f64() - 5.0).abs() < 1e-15);
}

#[test]
fn motions_without_inertia_are_named() {
    let mut b = Builder::new(&["a.x", "b.x"]);
    b.mass(0, &number("1"));
    b.spring(None, 0, &number("1"));
    b.spring(Some(0), 1, &number("1"));
    let error = analysis::modes(&b.finish()).expect_err("b has no mass");
    assert!(matches!(&error, AnalysisError::SingularMass { coordinates, .. } if coordinates == &["b.x"]), "{error:?}");
    assert_eq!(error.to_diagnostic().code.0, "vib::mass::singular");
}
