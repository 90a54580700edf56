//! Undamped modes of linear systems built by hand: frequencies, shapes, shares, and refusals.

use super::exact::{ExactPencil, binary, value};
use super::systems::{Builder, Random, number};
use vibc::analysis::{self, AnalysisError, ModeKind, Normalise, Stability, normalise};
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
        let shape: Vec<f64> = normalise(mode, Normalise::Translation).iter().map(|entry| entry.0).collect();
        assert_eq!(shape[0], 1.0);
        assert!((shape[1] - ratio).abs() < 1e-11, "{shape:?}");
    }
}

#[test]
fn shares_name_the_moving_parts_and_the_springs() {
    let system = cart();
    let modes = analysis::modes(&system).expect("a regular system");
    for mode in &modes.list {
        let kinetic: f64 = mode.kinetic.iter().map(|share| share.part.0).sum();
        let strain: f64 = mode.strain.iter().map(|share| share.part.0).sum();
        assert!((kinetic - 1.0).abs() < 1e-14 && (strain - 1.0).abs() < 1e-14);
    }
    // The cart's body has 1 kg x^2 of x^T M x, the rod the rest; the shape is (1, 1.2939).
    let (x, theta) = (1.0, 1.29393000254f64);
    let block = 1.0 / (1.5 * x * x + 2.0 * 0.5 * x * theta + 2.0 / 3.0 * theta * theta);
    let of =
        |name| modes.list[0].kinetic.iter().find(|share| system.display(share.of) == name).map(|share| share.part.0);
    assert!(of("rod").is_some_and(|rod| (rod + block - 1.0).abs() < 1e-10), "{:?}", modes.list[0].kinetic);
    // In phase, the rod's weight and the spring both restore; the strain energies are 10 x^2 and 4.905 theta^2.
    let low = &modes.list[0];
    let spring = 10.0 * x * x / (10.0 * x * x + 4.905 * theta * theta);
    let share = low.strain.iter().find(|share| system.display(share.of) == "k1").expect("the spring has a share");
    assert!((share.part.0 - spring).abs() < 1e-10);
}

/// What takes no shares from its modes does not pay for them, and finds the same modes.
#[test]
fn modes_without_shares_are_the_same_modes() {
    let system = cart();
    let modes = analysis::modes(&system).expect("a regular system").list;
    let request = analysis::Request::default().without_shares();
    let alone = analysis::all_modes(&system, &request).expect("a regular system").list;
    assert_eq!(modes.len(), alone.len());
    for (mode, alone) in modes.iter().zip(&alone) {
        assert!(!mode.kinetic.is_empty() && !mode.strain.is_empty());
        assert!(alone.kinetic.is_empty() && alone.strain.is_empty());
        let rest = |mode: &analysis::Mode| {
            let mut mode = mode.clone();
            mode.kinetic.clear();
            mode.strain.clear();
            format!("{mode:?}")
        };
        assert_eq!(rest(mode), rest(alone));
    }
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
    // A point with two degrees of freedom, held by one spring at 60 degrees: it moves freely across.
    let mut b = Builder::numbered(2);
    (0..2).for_each(|i| b.mass(i, &number("2")));
    let sine = &number("3").sqrt().expect("positive") / &number("2");
    b.stiffness("s", Nature::Property, &number("50"), &[(0, number("0.5")), (1, sine)]);
    let modes = analysis::modes(&b.finish()).expect("a regular system");
    assert_eq!(modes.list[0].kind, ModeKind::Rigid);
    assert!(modes.list[0].omega.is_zero());
    assert!((modes.list[1].omega.to_f64() - 5.0).abs() < 1e-15);
}

/// Two arms whose springs pass through the hinges to within the accuracy of the numbers: the stretch may be zero.
#[test]
fn a_stretch_that_may_be_zero_loses_no_mode() {
    let (sine, cosine) = Number::ONE.sin_cos().expect("an angle");
    let nearly_zero = &(&sine.square() + &cosine.square()) - &Number::ONE;
    let scenes =
        [Nature::Property, Nature::Geometric].map(|nature| [(nature, nearly_zero.clone()), (nature, -&nearly_zero)]);
    for (nature, nearly_zero) in scenes.into_iter().flatten() {
        let mut b = Builder::numbered(2);
        (0..2).for_each(|i| b.mass(i, &number("1")));
        let (weight, lever) = match nature {
            Nature::Property => (number("3"), nearly_zero.clone()),
            Nature::Geometric => (nearly_zero.clone(), number("3")),
        };
        b.stiffness("s", nature, &weight, &[(0, lever)]);
        let system = b.finish();
        let modes = analysis::modes(&system).expect("a regular system");
        let poles = analysis::poles(&system, &modes).expect("poles");
        assert_eq!(analysis::stability(&system, &modes, &poles), Stability::Undetermined);
        assert_eq!(modes.list.len(), 2);
        assert_eq!(modes.infinite, 0);
        // The arm without a spring is certainly rigid; for the other one, zero is only the best estimate.
        let certain = modes.list.iter().filter(|mode| mode.omega.is_zero()).count();
        let unknown = modes.list.iter().filter(|mode| mode.kind == ModeKind::Undetermined).count();
        assert_eq!((certain, unknown), (1, 1), "{:?}", modes.list);
        // Still, its highest possible frequency is known, from the lever or the stiffness of 3, each at its largest;
        // the union of enclosures adds midpoints.
        let most = (9.0 * nearly_zero.to_ball().magnitude()).sqrt() * 1.01;
        assert!(modes.list.iter().all(|mode| mode.omega.magnitude() < most), "{:?}", modes.list);
    }
}

#[test]
fn a_massless_node_passes_its_springs_in_series() {
    // 3 N/m and 6 N/m in series are 2 N/m: omega = 1 for 2 kg. The node follows by 6 / 9.
    let mut b = Builder::new(&["a.x", "node.x"]);
    b.mass(0, &number("2"));
    b.spring(None, 1, &number("3"));
    b.spring(Some(0), 1, &number("6"));
    let modes = analysis::modes(&b.finish()).expect("a regular system");
    assert_eq!((modes.list.len(), modes.infinite), (1, 1));
    let mode = &modes.list[0];
    assert_eq!(mode.omega.to_f64(), 1.0);
    assert!((mode.shape[1] / mode.shape[0] - 2.0 / 3.0).abs() < 1e-15);
    let strain: f64 = mode.strain.iter().map(|share| share.part.0).sum();
    assert!((strain - 1.0).abs() < 1e-14);
}

#[test]
fn a_bob_on_a_massless_rod_has_one_frequency() {
    // A point of 2 kg at 1.5 m on a body without mass of its own: it heaves on a spring and turns without inertia.
    let mut b = Builder::new(&["y", "turn"]);
    b.coupled_mass(&number("2"), &[(0, number("1")), (1, number("1.5"))]);
    b.spring(None, 0, &number("8"));
    b.stiffness("hinge", Nature::Property, &number("9"), &[(1, number("1"))]);
    let modes = analysis::modes(&b.finish()).expect("a regular system");
    // Flexibilities at the point add: 1/8 + 1.5^2/9 = 3/8, so omega^2 = 8/3/2.
    assert_eq!((modes.list.len(), modes.infinite), (1, 1));
    assert!((modes.list[0].omega_squared.to_f64() - 4.0 / 3.0).abs() < 1e-15);
}

#[test]
fn unrestrained_massless_motions_are_named() {
    let mut b = Builder::new(&["a.x", "b.x", "c.x"]);
    b.mass(0, &number("1"));
    b.spring(None, 0, &number("10"));
    b.spring(Some(1), 2, &number("5"));
    let error = analysis::modes(&b.finish()).expect_err("b and c float");
    assert!(
        matches!(&error, AnalysisError::SingularMass { coordinates, .. } if coordinates == &["b.x", "c.x"]),
        "{error:?}"
    );
    assert_eq!(error.to_diagnostic().code.0, "vib::mass::singular");
}

#[test]
fn a_mass_below_zero_is_refused_at_its_coordinate() {
    let mut b = Builder::new(&["a.x", "b.x"]);
    b.mass(0, &number("1"));
    b.mass(1, &number("-1"));
    b.spring(None, 0, &number("10"));
    b.spring(Some(0), 1, &number("5"));
    let error = analysis::modes(&b.finish()).expect_err("the kinetic energy of b is negative");
    assert_eq!(error.to_diagnostic().code.0, "vib::mass::indefinite");
}

#[test]
fn independent_parts_are_solved_separately_and_listed_together() {
    let mut b = Builder::numbered(5);
    (0..5).for_each(|i| b.mass(i, &number("1")));
    // Two equal oscillators, one stiffer pair that floats.
    b.spring(None, 0, &number("4"));
    b.spring(None, 3, &number("4"));
    b.spring(Some(1), 4, &number("8"));
    b.spring(None, 2, &number("1"));
    let modes = analysis::modes(&b.finish()).expect("a regular system");
    let omega: Vec<f64> = modes.list.iter().map(|mode| mode.omega.to_f64()).collect();
    assert_eq!(omega, [0.0, 1.0, 2.0, 2.0, 4.0]);
    let clusters: Vec<_> = modes.list.iter().map(|mode| mode.cluster).collect();
    assert_eq!(clusters, [None, None, Some(0), Some(0), None]);
    assert_eq!(modes.list[2].shape, [1.0, 0.0, 0.0, 0.0, 0.0]);
}

/// Each mode has its frequency to 1e-12, in its place by the signs of leading minors in exact arithmetic. Returns how many come by this
/// route.
#[track_caller]
fn certain_by(system: &LinearSystem, route: &str) -> usize {
    let modes = analysis::modes(system).expect("a regular system");
    let pencil = ExactPencil::of(system);
    for (i, mode) in modes.list.iter().enumerate() {
        assert!(mode.omega.relative_error() < 1e-12, "{i}: {:?}", mode.omega);
        let [mid, rad] = [value(mode.omega_squared.mid), binary(mode.omega_squared.rad)];
        assert!(pencil.below(&(&mid - &rad)).is_none_or(|count| count <= i), "{i}: {:?}", mode.omega_squared);
        assert!(pencil.below(&(&mid + &rad)).is_none_or(|count| count > i), "{i}: {:?}", mode.omega_squared);
    }
    modes.list.iter().filter(|mode| mode.route.name() == route).count()
}

/// A net of n masses on springs whose stiffnesses range over so many decades.
fn random_net(n: usize, decades: f64, random: &mut Random) -> Builder {
    let mut b = Builder::numbered(n);
    b.spring(None, 0, &random.decimal(decades));
    for i in 0..n {
        b.mass(i, &random.decimal(0.0));
        if i > 0 {
            b.spring(Some(random.below(i)), i, &random.decimal(decades));
        }
    }
    for _ in 0..n {
        let (i, j) = (random.below(n), random.below(n));
        if i != j {
            b.spring(Some(i), j, &random.decimal(decades));
        }
    }
    b
}

/// Nets of springs over a hundred decades, to which no vectors of three words do justice.
#[test]
fn few_coordinates_of_any_stiffness_have_bounds() {
    let mut random = Random::new(5);
    let nets = [4, 8, 8, 10, 11].map(|n| certain_by(&random_net(n, 100.0, &mut random).finish(), "exact"));
    assert!(nets.iter().sum::<usize>() > 0);
}

/// The same of more coordinates, and with springs that push away and levers.
#[test]
fn coordinates_of_any_stiffness_have_bounds_by_counts() {
    let mut random = Random::new(6);
    let mut counted = 0;
    for (n, decades) in [(21, 120.0), (24, 80.0), (26, 120.0)] {
        for signed in [false, true] {
            let mut b = random_net(n, decades, &mut random);
            for i in 0..if signed { 4 } else { 0 } {
                let lever = [(i, number("1")), (i + 5, -&number("1.5")), (i + 9, number("0.25"))];
                b.stiffness("lever", Nature::Property, &random.decimal(decades), &lever);
                b.stiffness("push", Nature::Geometric, &-&random.decimal(decades), &[(i + 2, number("1"))]);
            }
            counted += certain_by(&b.finish(), "counted");
        }
    }
    assert!(counted > 0, "{counted}");
}

/// A hub with equal arms of masses, two and two of them on springs of 10^120 N/m.
fn star(arms: usize, length: usize) -> LinearSystem {
    let mut b = Builder::numbered(1 + arms * length);
    b.mass(0, &number("3"));
    b.spring(None, 0, &number("2"));
    for arm in 0..arms {
        for i in 0..length {
            let at = 1 + arm * length + i;
            b.mass(at, &number("1.1"));
            let stiffness = number(&format!("{}e{}", i + 2, if i % 2 == 0 { 0 } else { 120 }));
            b.spring(Some(if i == 0 { 0 } else { at - 1 }), at, &stiffness);
        }
    }
    b.finish()
}

/// Motions of the arms against each other have one frequency: one less than arms. That of all arms together differs from it, by a
/// part of 10^120 where stiff springs stretch, which no number of thirty digits shows.
#[test]
fn repeated_frequencies_of_any_stiffness_are_counted() {
    for (arms, length, route) in [(3, 4, "exact"), (4, 4, "exact"), (3, 8, "counted"), (4, 6, "counted")] {
        let system = star(arms, length);
        assert!(certain_by(&system, route) > 0, "{arms} {length}");
        let modes = analysis::modes(&system).expect("a regular system").list;
        let mut sizes = vec![0; modes.len()];
        modes.iter().filter_map(|mode| mode.cluster).for_each(|cluster| sizes[cluster as usize] += 1);
        sizes.retain(|&size| size > 0);
        assert_eq!(sizes, [vec![arms - 1; length / 2], vec![arms; length / 2]].concat(), "{arms} {length}");
        // Shapes of one cluster are orthogonal in M, and each is one of its eigenvalue: the hub rests.
        for (a, b) in modes.iter().zip(&modes[1..]).filter(|(a, b)| a.cluster.is_some() && a.cluster == b.cluster) {
            let inertia = |i: usize| if i == 0 { 3.0 } else { 1.1 };
            let product: f64 = (0..system.n()).map(|i| inertia(i) * a.shape[i] * b.shape[i]).sum();
            let size = |x: &[f64]| (0..system.n()).map(|i| inertia(i) * x[i] * x[i]).sum::<f64>().sqrt();
            assert!(product.abs() < 1e-12 * size(&a.shape) * size(&b.shape), "{arms} {length}: {product}");
            assert!(a.shape[0].abs() < 1e-12 * size(&a.shape), "{:?}", a.shape);
        }
    }
}
