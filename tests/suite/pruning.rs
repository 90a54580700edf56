//! Only what the scene needs is computed: anything left out is reported and changes no result, to the last bit;
//! uncoupled parts are solved separately, with the same results as together.

use super::ask::{Answer, ask};
use vibc::analysis::{self, Mode, NetForm, Request, nets};
use vibc::base::{Number, SourceFile, Sources};
use vibc::model::Overrides;

/// A scene with everything that can be left out.
const CLUTTERED: &str = "gravity 9.81 m/s^2
    body block { mass = 1 kg, moves x }
    spring s: ground -- block { k = 10 N/m }
    body a { mass = 3 kg, moves x }
    spring u: block -- a { k = 7 N/m }
    damper v: block -- a { c = 0.3 N*s/m }
    body rod { mass = 0.5 kg, shape = rod((0, 0), (0, -2 m)) }
    pivot p: ground@(0, 0) -- rod
    body wheel { mass = 3 kg, inertia = 1.3 kg*m^2, turns }
    spring t: ground -- wheel { k = 11 N*m/rad }
    body plate { mass = 1 kg, at = (0, 0) }
    weld w: plate -- block
    spring idle: plate@(0, 0) -- block@(1 m, 0) { k = 5 N/m, preload = 3 N }
    damper still: plate@(0, 0) -- block@(1 m, 0) { c = 5 N*s/m }
    body tower { mass = 10 kg, at = (5 m, 0) }
    weld f: tower -- ground@(5 m, 0)
    spring rail: tower -- ground@(0, 0) { k = 1000 N/m, preload = 100 N }
    spring twist: block -- ground { k = 0 N/m }
    force F: block along x";

/// `CLUTTERED` without the parts that are left out.
const NEEDED: &str = "gravity 9.81 m/s^2
    body block { mass = 1 kg, moves x }
    spring s: ground -- block { k = 10 N/m }
    body a { mass = 3 kg, moves x }
    spring u: block -- a { k = 7 N/m }
    damper v: block -- a { c = 0.3 N*s/m }
    body rod { mass = 0.5 kg, shape = rod((0, 0), (0, -2 m)) }
    pivot p: ground@(0, 0) -- rod
    body wheel { inertia = 1.3 kg*m^2, turns }
    spring t: ground -- wheel { k = 11 N*m/rad }
    body plate { mass = 1 kg, at = (0, 0) }
    weld w: plate -- block
    force F: block along x";

/// Every number of a mode, as bits.
fn bits(mode: &Mode) -> Vec<u64> {
    let balls = [mode.omega, mode.omega_squared];
    let balls = balls.iter().flat_map(|ball| [ball.mid.hi, ball.mid.lo, ball.rad]);
    balls.chain(mode.shape.iter().copied()).map(f64::to_bits).collect()
}

fn pole_bits(answer: &Answer) -> Vec<u64> {
    let balls = answer.poles.list.iter().flat_map(|pole| [pole.re, pole.im]);
    balls.flat_map(|ball| [ball.mid.hi, ball.mid.lo, ball.rad]).map(f64::to_bits).collect()
}

#[test]
fn omissions_change_no_bit() {
    let (cluttered, needed) = (ask(CLUTTERED), ask(NEEDED));
    let modes = |answer: &Answer| answer.modes.list.iter().flat_map(bits).collect::<Vec<u64>>();
    assert_eq!(modes(&cluttered), modes(&needed));
    assert_eq!(pole_bits(&cluttered), pole_bits(&needed));
}

#[test]
fn omissions_are_reported() {
    let mut sources = Sources::new();
    let file = sources.add(SourceFile::model("scene.vib", CLUTTERED));
    let explained = vibc::explain(&sources, file, &Overrides::default()).answer.expect("an explanation");
    let reported: Vec<&str> = explained.account.left_out.iter().map(|remark| remark.what.as_str()).collect();
    assert_eq!(reported, ["mass of wheel", "tower", "idle", "still", "rail", "twist"]);
    let gravity = explained.account.kept.iter().find(|remark| remark.what == "gravity");
    assert!(gravity.is_some_and(|remark| remark.why.contains("stiffness")), "the rod hangs");
}

#[test]
fn gravity_without_work_is_reported() {
    let mut sources = Sources::new();
    let text = "gravity 9.81 m/s^2\nbody a { mass = 1 kg, moves x }\nspring s: ground -- a { k = 1 N/m }";
    let file = sources.add(SourceFile::model("scene.vib", text));
    let explained = vibc::explain(&sources, file, &Overrides::default()).answer.expect("an explanation");
    assert_eq!(explained.account.left_out.len(), 1);
    assert_eq!(explained.account.left_out[0].what, "gravity");
}

/// Frequencies and shapes of the parts, compared with those of the scene solved as one: the displayed numbers are the
/// same.
#[test]
fn separate_and_joint_solutions_agree() {
    let system = &ask(CLUTTERED).lowered.system;
    let apart = analysis::modes_as(system, &Request::default()).expect("modes");
    let together = analysis::modes_as(system, &Request { together: true, ..Request::default() }).expect("modes");
    assert_eq!(apart.list.len(), together.list.len());
    for (a, b) in apart.list.iter().zip(&together.list) {
        assert_eq!(a.omega.to_f64().to_bits(), b.omega.to_f64().to_bits(), "{:?} {:?}", a.omega, b.omega);
        for (x, y) in a.shape.iter().zip(&b.shape) {
            // A coordinate of another part is exactly at rest; solved together, it is zero to the rounding of a
            // double-double.
            assert!((x - y).abs() <= 1e-15 * x.abs().max(1e-13), "{x:e} {y:e}");
        }
    }
}

#[test]
fn parts_are_reported_with_their_form() {
    let forms = |text: &str| nets(&ask(text).lowered.system).iter().map(|net| net.form).collect::<Vec<_>>();
    assert_eq!(forms(CLUTTERED), [NetForm::Chain, NetForm::Single, NetForm::Single]);
    let bodies = |n: usize| (0..n).map(|i| format!("body b{i} {{ mass = 1 kg, moves x }}\n")).collect::<String>();
    let spring = |i: usize, j: usize| format!("spring s{i}_{j}: b{i} -- b{j} {{ k = 1 N/m }}\n");
    let star = bodies(4) + &spring(0, 1) + &spring(0, 2) + &spring(0, 3);
    assert_eq!(forms(&star), [NetForm::Tree]);
    let ladder = bodies(20) + &(0..18).map(|i| spring(i, i + 1) + &spring(i, i + 2)).collect::<String>();
    assert_eq!(forms(&ladder), [NetForm::Band { width: 2 }]);
    assert_eq!(forms("body puck { mass = 1 kg, moves x }"), [NetForm::Free]);
}

/// A pendulum without constraints beside a loaded spring: only the rest of the loaded part is searched, and the others
/// rest exactly as drawn.
#[test]
fn unloaded_parts_rest_exactly_as_drawn() {
    let answer = ask("body a { mass = 1 kg, moves x }
        spring s: ground -- a { k = 3 N/m }
        body b { mass = 1 kg, moves x }
        spring t: ground -- b { k = 3 N/m }
        force F: a along x = constant(1 N)");
    let rest = &answer.lowered.rest.displacement;
    assert!(rest[1].is_zero());
    assert_eq!(rest[0], &Number::ONE / &Number::from(3));
}

/// The source of a term is identified by the element that made it: names have no meaning, and keywords are not
/// reserved.
#[test]
fn a_spring_called_gravity_is_not_gravity() {
    let explained = |text: &str| {
        let mut sources = Sources::new();
        let file = sources.add(SourceFile::model("scene.vib", text));
        vibc::explain(&sources, file, &Overrides::default()).answer.expect("an explanation").account
    };
    let falling =
        "gravity 9.81 m/s^2\nbody a { mass = 1 kg, moves y }\nspring gravity: ground -- a { k = 100 N/m, along = y }";
    let account = explained(falling);
    let gravity = account.kept.iter().find(|remark| remark.what == "gravity").expect("its weight loads the rest");
    assert!(gravity.why.contains("it adds no stiffness"), "nothing turns: {}", gravity.why);
    // Conversely, gravity's own terms are not those of an idle spring.
    let hanging = "gravity 9.81 m/s^2\nbody rod { mass = 1 kg, inertia = 0.1 kg*m^2, at = (0 m, -0.5 m) }\n\
                   pivot hinge: ground@(0 m, 0 m) -- rod\nbody a { mass = 1 kg, moves x }\nspring gravity: ground -- a { k = 100 N/m, along = y }\n\
                   spring s: ground -- a { k = 100 N/m }";
    let account = explained(hanging);
    let idle: Vec<&str> = account.left_out.iter().map(|remark| remark.what.as_str()).collect();
    assert_eq!(idle, ["gravity"]);
    assert!(account.kept.iter().any(|remark| remark.what == "1 spring"), "{:?}", account.kept);
    let shares = &ask(hanging).modes.list[0].strain;
    assert_eq!(shares.len(), 1, "the rod swings: {shares:?}");
    assert_eq!(shares[0].of.origin, vibc::system::Origin::Gravity);
}
