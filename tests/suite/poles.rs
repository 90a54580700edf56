//! Damped poles of systems built by hand.

use super::systems::{Builder, number};
use vibc::analysis::{self, Pole, PoleKind, Poles, Stability};
use vibc::backend::{ReportOptions, report};
use vibc::base::{SourceFile, Sources};
use vibc::model::Overrides;
use vibc::system::{LinearSystem, Nature};

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
    assert_eq!(analysis::stability(&system, &modes, &poles), Stability::Neutral);
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
    assert_eq!(analysis::stability(&system, &modes, &poles), Stability::Unstable);
}

#[test]
fn unconnected_parts_are_solved_separately() {
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
    assert_eq!(analysis::stability(&system, &modes, &poles), Stability::Unstable);
}

/// Two equal masses on equal springs and dampers, coupled by a spring and a damper.
fn twins(ground: [&str; 2], between: [&str; 2]) -> LinearSystem {
    let mut pair = Builder::numbered(2);
    for i in 0..2 {
        pair.mass(i, &number("1"));
        pair.spring(None, i, &number(ground[0]));
        pair.damper(None, i, &number(ground[1]));
    }
    pair.spring(Some(0), 1, &number(between[0]));
    pair.damper(Some(0), 1, &number(between[1]));
    pair.finish()
}

#[test]
fn critical_damping_of_both_modes_is_two_double_poles() {
    // omega = 1 with c = 2, and omega = 3 with c = 6.
    let poles = poles(&twins(["1", "2"], ["4", "2"]));
    let expected = [(-1.0, 0), (-1.0, 0), (-3.0, 1), (-3.0, 1)];
    for (pole, (re, cluster)) in poles.list.iter().zip(expected) {
        assert!(pole.re.to_f64() == re && pole.im.is_zero() && pole.relative_error < 1e-30, "{pole:?}");
        assert!(pole.defective && pole.cluster == Some(cluster) && pole.kind == PoleKind::Overdamped);
    }
}

#[test]
fn a_double_pole_with_two_vectors_is_not_defective() {
    // The same two masses twice, in coordinates rotated by (3, 4)/5: x1, x2 of one and y1, y2 of the other.
    let mut four = Builder::numbered(4);
    for turn in [["0.6", "0.8"], ["0.8", "-0.6"]] {
        let [p, q] = turn.map(number);
        let first = [(0, p.clone()), (2, q.clone())];
        let second = [(1, p.clone()), (3, q.clone())];
        let between = [(0, p.clone()), (1, -&p), (2, q.clone()), (3, -&q)];
        four.inertia(&number("1"), &first);
        four.inertia(&number("2"), &second);
        four.dashpot(&number("0.7"), &first);
        four.stiffness("a", Nature::Property, &number("3"), &first);
        four.stiffness("b", Nature::Property, &number("5"), &between);
    }
    let poles = poles(&four.finish());
    assert_eq!(kinds(&poles), [PoleKind::Oscillation; 8]);
    assert!(poles.list.iter().all(|pole| !pole.defective && pole.relative_error < 1e-30), "{:?}", poles.list);
    let clusters: Vec<_> = poles.list.iter().map(|pole| pole.cluster).collect();
    assert_eq!(clusters, [0, 0, 1, 1, 2, 2, 3, 3].map(Some));
}

#[test]
fn damping_that_is_not_proportional_can_be_critical_too() {
    // det Q = (s + 2)^2 (s^2 + 2 s + 2) - (s + 2)^2 = (s + 1)^2 (s + 2)^2.
    let mut pair = Builder::numbered(2);
    pair.mass(0, &number("1"));
    pair.mass(1, &number("1"));
    pair.spring(None, 0, &number("2"));
    pair.spring(Some(0), 1, &number("2"));
    pair.damper(None, 0, &number("3"));
    pair.damper(None, 1, &number("1"));
    pair.damper(Some(0), 1, &number("1"));
    let poles = poles(&pair.finish());
    let expected = [(-1.0, 0), (-1.0, 0), (-2.0, 1), (-2.0, 1)];
    for (pole, (re, cluster)) in poles.list.iter().zip(expected) {
        assert!(pole.re.to_f64() == re && pole.im.is_zero() && pole.relative_error < 1e-30, "{pole:?}");
        assert!(pole.defective && pole.cluster == Some(cluster));
    }
}

#[test]
fn dampers_in_series_without_a_mass_between_them() {
    // 2 and 3 N*s/m in series are 1.2 N*s/m; once the mass is at rest, the point between them may be anywhere.
    let mut chain = Builder::numbered(2);
    chain.mass(0, &number("1"));
    chain.spring(None, 0, &number("4"));
    chain.damper(Some(0), 1, &number("2"));
    chain.damper(None, 1, &number("3"));
    let poles = poles(&chain.finish());
    assert_eq!(kinds(&poles), [PoleKind::Rigid, PoleKind::Oscillation, PoleKind::Oscillation]);
    assert!(close(&poles.list[2], -0.6, (4.0f64 - 0.36).sqrt()));
    assert_eq!(poles.infinite(), Some(1));
}

#[test]
fn the_report_names_critical_damping() {
    let text = "model twin\nbody a { mass = 1 kg, moves x }\nspring s: ground -- a { k = 4 N/m }\ndamper d: ground -- a { c = 4 N*s/m }\n";
    let mut sources = Sources::new();
    let model = sources.add(SourceFile::model("twin.vib", text));
    let outcome = vibc::analyze(&sources, model, &Overrides::default());
    let report = report::text(&outcome.answer.expect("an answer"), &ReportOptions::default());
    assert!(report.contains("poles 1, 2: one pole with a single shape, exactly: critical damping"), "{report}");
}

/// A rest that is not isolated leaves stiffnesses that cannot be distinguished from zero, and no elastic motion to
/// start from.
#[test]
fn poles_that_cannot_be_found_are_refused_not_left_out() {
    let text = "
body b0 { mass = 0.5 kg, inertia = 1 kg*m^2, at = (0.5 m, -1 m) }
pivot j0: ground@(sqrt(2) * 1 m, -1 m) -- b0
damper s2: ground@(3 m, 3 m) -- b0@(0, 1 m / 3) { c = 2 N*s/m }
body b1 { mass = 0.01 kg, inertia = 0.5 kg*m^2, at = (1 m, -1 m) }
pivot j1: b0@(sqrt(2) * 1 m, sqrt(2) * 1 m) -- b1
spring s4: b0@(3 m, 3 m) -- b1@(0, 0) { k = 40 N/m }
";
    let mut sources = Sources::new();
    let file = sources.add(SourceFile::model("hinge.vib", text));
    let outcome = vibc::analyze(&sources, file, &Overrides::default());
    let complete = outcome.answer.is_some_and(|answer| answer.poles.list.len() == 4);
    assert!(complete || outcome.diagnostics.iter().any(|found| found.is_error()));
}

/// Poles within the range of binary64 whose squares are outside of it.
#[test]
fn poles_whose_squares_are_out_of_range_are_certified() {
    let one = |m: &str, c: &str, k: &str| {
        let mut b = Builder::numbered(1);
        b.mass(0, &number(m));
        b.spring(None, 0, &number(k));
        b.damper(None, 0, &number(c));
        let system = b.finish();
        let modes = analysis::modes(&system).expect("modes");
        analysis::poles(&system, &modes).expect("poles").list
    };
    // -c / m and -k / c.
    let real = one("1e-100", "1e205", "1e20");
    for (pole, rate) in real.iter().zip([-1e-185, -1e305]) {
        assert!((pole.re.to_f64() / rate - 1.0).abs() < 1e-14, "{pole:?}");
        assert!(pole.relative_error > 0.0 && pole.relative_error < 1e-27, "{pole:?}");
    }
    // 1e-160 / 2 +- i 1e-160
    for pole in one("4e160", "4", "5e-160") {
        assert!((pole.re.to_f64() / -0.5e-160 - 1.0).abs() < 1e-14, "{pole:?}");
        assert!((pole.im.to_f64().abs() / 1e-160 - 1.0).abs() < 1e-14, "{pole:?}");
        assert!((pole.modulus().to_f64() / 1.25f64.sqrt() / 1e-160 - 1.0).abs() < 1e-14, "{pole:?}");
        assert!(pole.relative_error > 0.0 && pole.relative_error < 1e-27, "{pole:?}");
    }
}

/// Masses of 1 kg in a row on springs of 100 N/m, each with an additional damper of `dragged` N*s/m to the ground, and
/// modal damping.
fn row_damped_by_modes(count: usize, ratio: &str, dragged: &str) -> vibc::answers::ModalAnswer {
    let text = format!(
        "damping modal {ratio}\nparam c = {dragged} N*s/m\n\
         body mass[1] {{ mass = 1 kg, moves y }}\nspring link[1]: ground -- mass[1] {{ k = 100 N/m }}\n\
         damper drag[1]: ground -- mass[1] {{ c = c }}\n\
         repeat i in 2..{count} {{\n  body mass[i] {{ mass = 1 kg, moves y }}\n\
         spring link[i]: mass[i-1] -- mass[i] {{ k = 100 N/m }}\n  damper drag[i]: ground -- mass[i] {{ c = c }}\n}}\n"
    );
    let mut sources = Sources::new();
    let model = sources.add(SourceFile::model("row.vib", &text));
    vibc::analyze(&sources, model, &Overrides::default()).answer.expect("an answer")
}

/// omega_i = 20 sin((2i - 1) pi / 402), and the poles of a mode are omega (-zeta +- sqrt(zeta^2 - 1)): here they span
/// eighteen decades, which took 17 s when the ratio was first spread over all coordinates.
#[test]
fn ratios_far_beyond_one_have_their_poles_in_closed_form() {
    let answer = row_damped_by_modes(100, "1e9", "0");
    let mut expected: Vec<f64> = (1..=100)
        .map(|i| 20.0 * (f64::from(2 * i - 1) * std::f64::consts::PI / 402.0).sin())
        .flat_map(|omega| [-omega / 2e9, -2e9 * omega])
        .collect();
    expected.sort_by(|a, b| b.total_cmp(a));
    assert_eq!(answer.poles.list.len(), 200);
    assert!(answer.poles.is_complete());
    assert_eq!(answer.stability, Stability::Stable);
    for (pole, expected) in answer.poles.list.iter().zip(expected) {
        assert!((pole.re.to_f64() / expected - 1.0).abs() < 1e-13 && pole.im.is_zero(), "{pole:?} {expected}");
        assert!(pole.relative_error < 1e-25, "{pole:?}");
    }
}

/// Dampers to the ground make each mode decay at 0.5 1/s, from which a negative ratio takes 0.1 omega: those above
/// 5 rad/s grow. Only the slowest modes of the 500 masses are computed, and the others are not called stable.
#[test]
fn a_negative_ratio_of_modes_that_are_not_computed_is_not_called_stable() {
    assert_eq!(row_damped_by_modes(30, "-10 %", "1").stability, Stability::Unstable);
    assert_eq!(row_damped_by_modes(30, "-1 %", "1").stability, Stability::Stable);
    let many = row_damped_by_modes(500, "-10 %", "1");
    assert!(many.poles.left_out > 0 && many.poles.list.iter().all(|pole| pole.re.is_negative()));
    assert_eq!(many.stability, Stability::Undetermined);
    assert_eq!(row_damped_by_modes(500, "10 %", "1").stability, Stability::Stable);
}
