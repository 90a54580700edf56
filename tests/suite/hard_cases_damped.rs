//! The damped hard cases of tests/hardcases: each pole within its tolerance, each bound holding, each fact reported.

use super::systems::{HardCase, error};
use vibc::analysis::{self, Pole, PoleKind, Poles};
use vibc::base::{Ball, Number};

/// Modes and poles of a case.
fn solved(name: &str) -> (HardCase, Poles) {
    let case = HardCase::load(name);
    let modes = analysis::modes(&case.system).expect("the case has modes");
    let poles = analysis::poles(&case.system, &modes).expect("the case has poles");
    (case, poles)
}

/// One pole of each pair, in the order of |lambda|, like the references lambda_k.
fn one_of_each_pair(poles: &Poles) -> Vec<&Pole> {
    poles.list.iter().filter(|pole| pole.im.mid.hi >= 0.0).collect()
}

/// Checks every lambda_k, its parts and its damping ratio to `digits` digits, and that every bound holds.
fn check(name: &str, digits: f64) -> Poles {
    let (case, poles) = solved(name);
    let mut seen = 0;
    for (k, pole) in one_of_each_pair(&poles).iter().enumerate() {
        let k = k + 1;
        let parts = [(format!("lambda_{k}_re"), pole.re), (format!("lambda_{k}_im"), pole.im)];
        for (id, ball) in parts {
            if let Some(truth) = case.reference(&id) {
                seen += 1;
                check_ball(name, &id, ball, &truth, digits);
            }
        }
        if let (Some(truth), Some(zeta)) = (case.reference(&format!("zeta_{k}")), pole.damping_ratio) {
            check_ball(name, &format!("zeta_{k}"), zeta, &truth, digits);
        }
        assert!(pole.relative_error < 10f64.powf(-digits), "{name}: bound {:e} of pole {k}", pole.relative_error);
    }
    let wanted = case.json["reference"].as_array().expect("a list");
    let wanted = wanted.iter().filter(|r| r["id"].as_str().is_some_and(|id| id.starts_with("lambda_"))).count();
    assert_eq!(seen, wanted, "{name}: a reference has no pole");
    poles
}

fn check_ball(name: &str, id: &str, ball: Ball, truth: &Number, digits: f64) {
    // The references are correct to 36 digits.
    let size = truth.abs().to_f64();
    let (error, holds) = error(ball, truth, 1e-35 * size);
    assert!(holds, "{name} {id}: error {error:e}, bound {:e}", ball.rad);
    assert!(error <= 10f64.powf(-digits) * size, "{name} {id}: {} digits", -(error / size).log10());
}

fn kinds(poles: &Poles) -> Vec<PoleKind> {
    poles.list.iter().map(|pole| pole.kind).collect()
}

#[test]
fn poles_of_ordinary_damping() {
    for name in ["o15_nonproportional_2dof", "o22_preload_tiny_dynamics", "o29_seed_cart"] {
        let poles = check(name, 28.0);
        assert_eq!(kinds(&poles), [PoleKind::Oscillation; 4], "{name}");
    }
}

#[test]
fn light_damping_keeps_its_digits() {
    for name in ["o16_light_damping_frf", "o25_absorber_antiresonance"] {
        check(name, 28.0);
    }
}

#[test]
fn rates_far_apart_keep_their_digits() {
    let poles = check("o14_overdamped_1e12", 28.0);
    assert_eq!(kinds(&poles), [PoleKind::Overdamped; 6]);
    check("o28_stiff_transient", 28.0);
}

#[test]
fn near_critical_damping_keeps_its_digits() {
    check("o13_near_critical_sdof", 28.0);
    let poles = check("o32_nearcritical_2dof", 24.0);
    assert_eq!(kinds(&poles), [PoleKind::Overdamped; 4]);
}

#[test]
fn critical_damping_is_reported_as_a_double_pole() {
    let poles = check("o12_critical_sdof", 30.0);
    assert_eq!(kinds(&poles), [PoleKind::Overdamped; 2]);
    assert!(poles.list.iter().all(|pole| pole.cluster == Some(0) && pole.defective));
}

#[test]
fn a_spring_and_damper_in_series_relax_at_their_own_rate() {
    let poles = check("o18_zener_maxwell", 28.0);
    assert_eq!(kinds(&poles), [PoleKind::Oscillation, PoleKind::Oscillation, PoleKind::Overdamped]);
    assert_eq!(poles.infinite(), Some(1));
}
