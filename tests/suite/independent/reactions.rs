//! Reactions of joints, couplings and supports beside the multipliers of the second formulation, in which no joint is
//! released; and beside closed forms. See docs/method/linearisation.md#reactions.

use super::extended::{Matrix, solve};
use super::formulation::{Formulation, Reacted};
use super::random_scenes;
use super::{chosen, displacement, from_columns, from_form};
use crate::ask::{Answer, ask, refusal, try_ask};
use vibc::analysis::damping::rayleigh;
use vibc::base::Number;
use vibc::base::number::Dd;
use vibc::kinds::motions::ReactionComponent;
use vibc::model::scene::{Freedom, Motion, Reaction};

/// The reactions that a scene may be asked for, as a model names them.
fn named(answer: &Answer) -> Vec<String> {
    let scene = answer.scene.scene();
    let mut list = Vec::new();
    for joint in &scene.joints {
        let words = if joint.kind.turns { &["fx", "fy"][..] } else { &["fx", "fy", "moment"] };
        list.extend(words.iter().map(|word| format!("{}.{word}", scene.words.display(joint.name))));
    }
    list.extend(scene.couples.iter().map(|couple| format!("{}.force", scene.words.display(couple.name))));
    for body in &scene.bodies {
        let Freedom::OnGround { translations, turns } = &body.freedom else { continue };
        let mut words = Vec::new();
        match &translations[..] {
            [] => words.extend(["support_x", "support_y"]),
            [one] if one.motion == "x" => words.push("support_y"),
            [one] if one.motion == "y" => words.push("support_x"),
            [_] => words.extend(["support_x", "support_y"]),
            _ => {}
        }
        if !turns {
            words.push("support_moment");
        }
        list.extend(words.iter().map(|word| format!("{}.{word}", scene.words.display(body.name))));
    }
    list
}

/// The gain of the last output from each input at a real s.
fn gains(answer: &Answer, s: f64) -> Vec<Dd> {
    let system = &answer.lowered.system;
    let (n, s) = (system.n(), Dd::from(s));
    let power = |order: usize| (0..order).fold(Dd::ONE, |power, _| power * s);
    let sum = |parts: [Matrix; 3]| {
        let mut sum = Matrix::zero(parts[0].rows, parts[0].columns);
        for (order, part) in parts.iter().enumerate() {
            for i in 0..sum.rows {
                for j in 0..sum.columns {
                    *sum.at_mut(i, j) += power(order) * part.at(i, j);
                }
            }
        }
        sum
    };
    let impedance = sum([&system.k, &system.c, &system.m].map(|form| from_form(form, n)));
    let driven = sum([0, 1, 2].map(|order| from_columns(n, system.inputs.iter().map(|input| &input.b[order]))));
    let moved = solve(impedance, driven).expect("no pole");
    let output = system.outputs.last().expect("the reaction");
    let mut gains = vec![Dd::ZERO; system.inputs.len()];
    for order in 0..3 {
        for (input, gain) in gains.iter_mut().enumerate() {
            let own = output.p[order].iter().map(|(i, value)| value.to_ball().mid * moved.at(i.index(), input));
            let through = output.d[order].iter().filter(|(from, _)| *from as usize == input);
            let all = own.chain(through.map(|(_, value)| value.to_ball().mid));
            *gain += power(order) * all.fold(Dd::ZERO, |sum, part| sum + part);
        }
    }
    gains
}

/// The size of the largest of some numbers, at least one.
fn size(numbers: &[Dd]) -> f64 {
    numbers.iter().map(|number| number.to_f64().abs()).fold(1.0, f64::max)
}

/// Compares every reaction of a scene; returns how many were compared and how many refused.
fn assert_reactions(text: &str, reversed: bool) -> [usize; 2] {
    const S: f64 = 1.75;
    let bare = ask(text);
    let scene = bare.scene.scene();
    let second = if reversed { Formulation::reversed(scene) } else { Formulation::new(scene) };
    let (chosen, start) = (chosen(&bare), displacement(&bare));
    let [mut compared, mut refused] = [0, 0];
    for name in named(&bare) {
        let answer = match try_ask(&format!("{text}\noutput reaction = {name}")) {
            Ok(answer) => answer,
            Err(said) => {
                let codes: Vec<String> = said.iter().filter(|d| d.is_error()).map(|d| d.code.to_string()).collect();
                assert_eq!(codes, ["vib::reaction::undetermined"], "{name} in\n{text}");
                refused += 1;
                continue;
            }
        };
        let output = answer.scene.scene().outputs.last().expect("the reaction");
        let Motion::Reaction(reaction) = output.terms[0].motion else { panic!("{name} is a reaction") };
        let found = second.reactions(&chosen, &start, S, &[reaction]).expect("the second formulation solves it");
        let Reacted { at_rest, gains: truth } = &found[0];
        let rest = &answer.lowered.rest;
        let own = answer.lowered.mechanism.at_rest(answer.scene.scene(), rest, &output.terms, output.span);
        let own = own.expect("a value at rest").to_ball();
        let off = (own.mid - *at_rest).abs().to_f64();
        let scale = size(&[*at_rest]);
        assert!(off <= own.rad + 1e-13 * scale, "{name} rests at {own:?}, by multipliers {at_rest:?} in\n{text}");
        let gains = gains(&answer, S);
        for (input, (gain, truth)) in gains.iter().zip(truth).enumerate() {
            let off = (*gain - *truth).abs().to_f64();
            let (a, b) = (gain.to_f64(), truth.to_f64());
            assert!(off <= 1e-13 * size(&gains), "{name} under input {input}: {a:e}, by multipliers {b:e} in\n{text}");
        }
        compared += 1;
    }
    [compared, refused]
}

#[test]
fn reactions_of_random_trees() {
    let mut compared = 0;
    for seed in 1..=25 {
        let [own, refused] = assert_reactions(&random_scenes::tree(seed, 5, true), false);
        assert_eq!(refused, 0, "a tree determines all, seed {seed}");
        compared += own;
    }
    assert!(compared > 150, "{compared}");
}

/// Of several joints that hold the same, the second formulation may leave out any: a reaction that depends on which is
/// refused, and all others agree with both choices.
#[test]
fn reactions_of_random_linkages() {
    let mut compared = 0;
    for seed in 1..=60 {
        let text = random_scenes::linkage(seed, 4, seed % 2 == 0);
        if try_ask(&text).is_ok() {
            compared += assert_reactions(&text, seed % 3 == 0)[0];
        }
    }
    assert!(compared > 100, "{compared}");
}

const PARALLELOGRAM: &str = "gravity 9.81 m/s^2
body bar { mass = 2 kg, shape = rod((0, -1 m), (2 m, -1 m)) }
repeat i in 0..2 {
  body  link[i] { mass = 1 kg, shape = rod((i * 1 m, 0), (i * 1 m, -1 m)) }
  pivot a[i]: ground@(i * 1 m, 0) -- link[i]
  pivot b[i]: bar@(i * 1 m, -1 m) -- link[i]
}
spring s: ground@(-1 m, -1 m) -- bar@(0, -1 m) { k = 10 N/m }
force F: bar@(2 m, -1 m) along (1, 2)
body bob { mass = 0.3 kg, inertia = 0.1 kg*m^2, at = (1.5 m, -2 m) }
pivot c: bar@(1.5 m, -1 m) -- bob";

#[test]
fn what_redundant_joints_leave_open_is_refused() {
    for reversed in [false, true] {
        // Three links may share a force along them in any way, and each share turns with its link. The bob below hangs on
        // the bar alone.
        assert_eq!(assert_reactions(PARALLELOGRAM, reversed), [2, 12]);
    }
    let twice = "body block { mass = 1 kg, at = (0, 0) }
slide left: ground@(-1 m, 0) -- block along x
slide right: ground@(1 m, 0) -- block along x
spring s: ground@(-2 m, 0) -- block { k = 10 N/m }";
    for word in ["left.fy", "left.moment", "right.fy", "right.moment"] {
        assert_eq!(refusal(&format!("{twice}\noutput r = {word}")), ["vib::reaction::undetermined"], "{word}");
    }
    let welds = "body a { mass = 1 kg, at = (0, 0), moves x }
body b { mass = 1 kg, at = (1 m, 0) }
weld u: a@(0, 0) -- b
weld v: a@(0.5 m, 0) -- b
spring s: ground@(-2 m, 0) -- a { k = 10 N/m }";
    for word in ["u.fx", "v.moment"] {
        assert_eq!(refusal(&format!("{welds}\noutput r = {word}")), ["vib::reaction::undetermined"], "{word}");
    }
}

/// What only turns about its centre needs no mass; what carries it does.
#[test]
fn a_weight_that_is_not_given_is_asked_for() {
    let model = "gravity 10 m/s^2
body disc { MASS inertia = 1 kg*m^2, at = (0, 0), turns }
spring s: ground -- disc { k = 3 N*m/rad }
output r = disc.support_y";
    assert_eq!(refusal(&model.replace("MASS", "")), ["vib::reaction::undetermined"]);
    let given = model.replace("MASS", "mass = 2 kg,");
    assert_close(at_rest(&given), 20.0);
    assert_eq!(ask(&given).remarks, []);
    let still = "gravity 10 m/s^2
body block { mass = 2 kg, at = (0, 0), moves x }
spring s: ground -- block { k = 3 N/m }
output r = block.support_y";
    assert_eq!(ask(still).remarks, []);
    assert_close(at_rest(still), 20.0);
}

/// Every holder under loads, on bases that move and turn, with slides whose second part carries the first.
#[test]
fn reactions_on_moving_bases() {
    let text = "gravity 9.81 m/s^2
base floor { moves x y, at = (0, 0) }
base shaft { turns, at = (3 m, 0) }
body rod { mass = 2 kg, inertia = 0.4 kg*m^2, at = (1 m, -1 m) }
body bob { mass = 1 kg, inertia = 0.1 kg*m^2, at = (2 m, -2 m) }
body tip { mass = 0.5 kg, inertia = 0.2 kg*m^2, at = (2.5 m, -2 m) }
body cam { mass = 3 kg, inertia = 0.3 kg*m^2, at = (4 m, 1 m) }
pivot p: floor@(0, 0) -- rod
slide q: bob@(1.5 m, -1.5 m) -- rod along (1, -2)
weld w: tip@(2.2 m, -2 m) -- bob@(2.2 m, -2 m)
weld v: shaft@(3 m, 0) -- cam
spring s: rod@(1 m, -1 m) -- bob@(2 m, -2 m) { k = 300 N/m, preload = 4 N }
spring t: ground@(5 m, -2 m) -- tip@(2.5 m, -2.5 m) { k = 200 N/m, free_length = 2 m }
damper d: cam@(4 m, 1 m) -- rod@(1 m, 0) { c = 5 N*s/m }
inerter b: floor@(0.5 m, 0) -- tip@(2.5 m, -2 m) { b = 2 kg }
force F: tip@(2.5 m, -1.5 m) along (2, 1)
torque T: bob -- rod";
    assert_eq!(assert_reactions(text, false), [11, 0]);
}

fn gain(model: &str, s: f64) -> f64 {
    gains(&ask(model), s)[0].to_f64()
}

fn at_rest(model: &str) -> f64 {
    let answer = ask(model);
    let output = answer.scene.scene().outputs.last().expect("an output");
    let Answer { scene, lowered, .. } = &answer;
    let value = lowered.mechanism.at_rest(scene.scene(), &lowered.rest, &output.terms, output.span);
    value.expect("a value").to_f64()
}

fn assert_close(found: f64, truth: f64) {
    assert!((found - truth).abs() <= 1e-15 * truth.abs().max(1.0), "{found} instead of {truth}");
}

/// A rod that hangs: the force at its tip turns it about the pivot, which carries what is left.
#[test]
fn the_bearing_of_a_pendulum() {
    let model = "gravity 10 m/s^2
body rod { mass = 3 kg, shape = rod((0, 0), (0, -2 m)) }
pivot p: ground@(0, 0) -- rod
force F: rod@(0, -2 m) along x
output r = p.";
    let s: f64 = 2.0;
    let angle = 2.0 / (4.0 * s * s + 30.0);
    assert_close(gain(&format!("{model}fx"), s), 3.0 * s * s * angle - 1.0);
    assert_close(gain(&format!("{model}fy"), s), 0.0);
    assert_close(at_rest(&format!("{model}fy")), 30.0);
    // On the ground: the second part decides.
    let other = model.replace("ground@(0, 0) -- rod", "rod@(0, 0) -- ground");
    assert_close(gain(&format!("{other}fx"), s), 1.0 - 3.0 * s * s * angle);
    assert_close(at_rest(&format!("{other}fy")), -30.0);
}

#[test]
fn the_rails_of_an_incline() {
    let model = "gravity 10 m/s^2
body block { mass = 2 kg, at = (1 m, 1 m), moves along (3, 4) }
spring s: ground -- block { k = 100 N/m, along = (3, 4) }
output r = block.support_";
    assert_close(at_rest(&format!("{model}x")), -9.6);
    assert_close(at_rest(&format!("{model}y")), 7.2);
    assert_close(at_rest(&format!("{model}moment")), 0.0);
}

#[test]
fn the_teeth_of_gears() {
    let model = "body a { inertia = 1 kg*m^2, turns }
body b { inertia = 4 kg*m^2, turns }
couple g: b.angle = -a.angle / 2
torque T: a
spring s: ground -- a { k = 3 N*m/rad }
output r = g.force";
    let s: f64 = 1.5;
    let angle = 1.0 / (2.0 * s * s + 3.0);
    assert_close(gain(model, s), -2.0 * s * s * angle);
    let other = model.replace("b.angle = -a.angle / 2", "0 = b.angle + a.angle / 2");
    assert_close(gain(&other, s), 2.0 * s * s * angle);
}

/// `rayleigh` puts dashpots beside springs and on masses: the weld of a mass on a sprung block carries the mass' own share.
#[test]
fn a_weld_carries_the_damping_of_what_it_holds() {
    let model = "body block { mass = 2 kg, at = (0, 0), moves x }
body rider { mass = 3 kg, at = (0, 1 m) }
weld w: block -- rider
spring s: ground -- block { k = 50 N/m }
force F: block along x
damping rayleigh(0.5 /s, 0.01 s)
output r = w.fx";
    let s: f64 = 0.75;
    let mut answer = ask(model);
    let [alpha, beta] = [2, 100].map(|part| &Number::ONE / &Number::from(part));
    rayleigh(&mut answer.lowered.system, &alpha, &beta);
    let x = 1.0 / (5.0 * s * s + (2.5 + 0.5) * s + 50.0);
    let found = gains(&answer, s)[0].to_f64();
    assert!((found - (3.0 * s * s + 1.5 * s) * x).abs() < 1e-12, "{found}");
}

/// A component turned by any angle speaks of its own axes.
#[test]
fn a_reaction_in_a_turned_component() {
    let answer = ask("component hanger() {
  body rod { mass = 1 kg, shape = rod((0, 0), (0, -1 m)) }
  pivot p: ground@(0, 0) -- rod
  spring s: ground@(1 m, -1 m) -- rod@(0, -1 m) { k = 10 N/m }
  output r = p.fx
}
place h = hanger() at (1 m, 2 m) turned 30 deg
force F: h.rod@(1.5 m, 1 m) along x");
    let output = answer.scene.scene().outputs.last().expect("the reaction");
    let components: Vec<ReactionComponent> = output
        .terms
        .iter()
        .map(|term| match term.motion {
            Motion::Reaction(Reaction { component, .. }) => component,
            _ => panic!("a reaction"),
        })
        .collect();
    assert_eq!(components, [ReactionComponent::X, ReactionComponent::Y]);
    let factors: Vec<f64> = output.terms.iter().map(|term| term.coefficient.to_f64()).collect();
    assert_close(factors[0], 0.75_f64.sqrt());
    assert_close(factors[1], 0.5);
}

const SLIDER_CRANK: &str = include_str!("../../../examples/slider_crank.vib");

/// Statics of the rod at 5 to 12, and every bearing under the pulsating gas by multipliers.
#[test]
fn the_bearings_of_a_slider_crank() {
    for (word, truth) in [
        ("main.fx", 1200.0),
        ("main.fy", -500.0),
        ("pin.fx", 1200.0),
        ("pin.fy", -500.0),
        ("wrist.fx", 1200.0),
        ("wrist.fy", -500.0),
        ("cylinder.fx", 0.0),
        ("cylinder.fy", 500.0),
        ("cylinder.moment", 0.0),
    ] {
        let found = at_rest(&format!("{SLIDER_CRANK}\noutput r = {word}"));
        assert!((found - truth).abs() < 1e-10, "{word}: {found} instead of {truth}");
    }
    // The second formulation is given the torque that holds the drawing.
    let held = SLIDER_CRANK.replace("rest as drawn\n", "").replace("900 N*m/rad", "900 N*m/rad, preload = 63 N*m");
    assert_eq!(assert_reactions(&held, false), [9, 0]);
    for word in ["main.fx", "pin.fy", "cylinder.moment"] {
        let [found, given] = [SLIDER_CRANK, &held].map(|text| gain(&format!("{text}\noutput r = {word}"), 3.0));
        assert!((found - given).abs() < 1e-13, "{word}: {found}, {given}");
    }
}
