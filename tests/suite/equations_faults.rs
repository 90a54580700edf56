//! Faults injected into the lowered system and into the symbols of a scene: each is reported as a defect, at the part
//! that is wrong.

use vibc::base::{Diagnostics, Number, Rational, SourceFile, Sources};
use vibc::equations::{Equations, EquationsError, derive, verify};
use vibc::lower::{self, Lowered};
use vibc::model::{self, CheckedScene, Overrides, Written};
use vibc::symbols::Sum;
use vibc::system::{Form, Nature};

/// A cart with a pendulum that is held by a slanted spring and damper, drawn at rest.
const MODEL: &str = "param m = 2 kg
param M = 3 kg
param L = 1.5 m
param k = 40 N/m
param c = 2 N*s/m
gravity 9.81 m/s^2
body cart { mass = M, moves x, at = (0, 0) }
body rod  { mass = m, shape = rod((0, 0), (0, -L)) }
pivot p: cart@(0, 0) -- rod
spring s: ground@(-1 m, 0) -- cart { k = k }
spring v: ground@(1 m, -L) -- rod@(0, -L) { k = k }
damper d: ground@(1 m, -L) -- rod@(0, -L) { c = c }
force  F: rod@(0, -L) along x
output sway = cart.x
output pull = d.force
";

/// A linkage, in which two angles follow a third, and a coupled roller with a damper.
const LOOP: &str = "param m = 6 kg
param l = 3 kg
param c = 2 N*s/m
param k = 50 N/m
gravity 9.81 m/s^2
body left  { mass = l, shape = rod((0, 0), (1 m, -2 m)) }
body bar   { mass = m, shape = rod((1 m, -2 m), (3 m, -2 m)) }
body right { mass = l, shape = rod((3 m, -2 m), (4 m, 0)) }
pivot a: ground@(0, 0) -- left
pivot b: left@(1 m, -2 m) -- bar
pivot q: bar@(3 m, -2 m) -- right
pivot d: right@(4 m, 0) -- ground
body wheel { mass = m, moves x, at = (9 m, 0) }
spring s: ground@(8 m, 0) -- wheel { k = k }
damper e: ground@(8 m, 0) -- wheel { c = c }
force  F: bar along x
output sway = bar.x
";

pub struct Scene {
    sources: Sources,
    checked: CheckedScene,
    pub written: Written,
}

fn scene() -> Scene {
    scene_of(MODEL)
}

pub fn scene_of(model: &str) -> Scene {
    let mut sources = Sources::new();
    let file = sources.add(SourceFile::model("faults.vib", model));
    let tree = vibc::syntax::parse(&sources, file).tree;
    let (checked, written) = model::check_written(&sources, &tree, &Overrides::default(), &[]);
    let (checked, written) = (checked.scene.expect("a sound model"), written.expect("its expressions"));
    Scene { sources, checked, written }
}

impl Scene {
    pub fn lowered(&self) -> Lowered {
        let mut unheard = Diagnostics::new();
        let outcome = lower::lower(&self.checked);
        unheard.extend(outcome.diagnostics);
        outcome.lowered.expect("a sound scene")
    }

    pub fn derive(&self, written: &Written, lowered: &Lowered) -> Result<Equations, EquationsError> {
        derive(self.checked.scene(), written, lowered)
    }

    /// The name in the model at which a defect is reported.
    pub fn place(&self, error: EquationsError) -> String {
        match error {
            EquationsError::Defect { span, .. } => self.sources.slice(span).to_string(),
            other => panic!("no defect: {other:?}"),
        }
    }
}

/// The form with each term changed by `change`, or removed if that returns nothing.
pub fn changed(
    form: &Form,
    names: &[&str],
    display: impl Fn(u32) -> String,
    change: impl Fn(&mut Number, &mut Vec<Number>, Nature) -> bool,
) -> Form {
    let mut result = Form::new();
    for source in 0..form.source_count() as u32 {
        result.source(form.source_of(source));
    }
    for term in form.terms() {
        let row = form.row(term);
        let (mut weight, mut values): (Number, Vec<Number>) =
            (term.weight.clone(), row.iter().map(|(_, v)| v.clone()).collect());
        if names.contains(&display(term.source).as_str()) && !change(&mut weight, &mut values, term.nature) {
            continue;
        }
        let ids = row.iter().map(|(id, _)| *id);
        result.push(term.source, term.nature, weight, ids.zip(values));
    }
    result
}

#[test]
fn the_sound_scene_has_equations() {
    let scene = scene();
    scene.derive(&scene.written, &scene.lowered()).expect("no defect");
}

#[test]
fn ten_faults_in_the_lowered_system_are_reported_where_they_are() {
    type Change = fn(&mut Number, &mut Vec<Number>, Nature) -> bool;
    let negate: Change = |weight, _, _| {
        *weight = -&*weight;
        true
    };
    let double: Change = |weight, _, _| {
        *weight = &*weight + &*weight;
        true
    };
    let leave_out: Change = |_, _, _| false;
    let third: Change = |weight, _, _| {
        *weight = &*weight / &Number::from(3);
        true
    };
    let lever: Change = |_, values, _| {
        values[0] = &values[0] * &Number::from(Rational::new(11, 10));
        true
    };
    let sign_of_lever: Change = |_, values, _| {
        let last = values.len() - 1;
        values[last] = -&values[last];
        true
    };
    let no_curvature: Change = |_, _, nature| nature == Nature::Property;
    // Matrix, part, fault, and where it is reported.
    let faults: [(&str, &str, Change, &str); 10] = [
        ("M", "cart", double, "cart"),
        ("M", "rod", third, "rod"),
        ("M", "rod", lever, "rod"),
        ("K", "s", negate, "s"),
        ("K", "v", double, "v"),
        ("K", "v", sign_of_lever, "v"),
        ("K", "gravity", no_curvature, "rod"),
        ("K", "gravity", double, "rod"),
        ("C", "d", leave_out, "d"),
        ("C", "d", lever, "d"),
    ];
    let scene = scene();
    for (matrix, part, change, place) in faults {
        let mut lowered = scene.lowered();
        let system = lowered.system.clone();
        let form = match matrix {
            "M" => &mut lowered.system.m,
            "C" => &mut lowered.system.c,
            _ => &mut lowered.system.k,
        };
        let original = form.clone();
        *form = changed(&original, &[part], |source| system.display(original.source_of(source)), change);
        let error = scene.derive(&scene.written, &lowered).expect_err("a fault");
        assert_eq!(scene.place(error), place, "{matrix} of {part}");
    }
}

#[test]
fn ten_faults_in_the_symbols_are_reported() {
    let twice = |sum: &Sum| sum.scale(&Rational::from(2));
    type Fault = Box<dyn Fn(&mut Written)>;
    let faults: Vec<(&str, Fault, &str)> = vec![
        ("mass", Box::new(move |w| w.bodies[0].mass = w.bodies[0].mass.as_ref().map(twice)), "cart"),
        ("inertia", Box::new(move |w| w.bodies[1].inertia = w.bodies[1].inertia.as_ref().map(twice)), "rod"),
        ("inertia dropped", Box::new(|w| w.bodies[1].inertia = None), "rod"),
        (
            "centre",
            Box::new(move |w| w.bodies[1].centre = w.bodies[1].centre.as_ref().map(|c| c.each_ref().map(twice))),
            "rod",
        ),
        ("sign of k", Box::new(|w| w.elements[0].coefficient = -&w.elements[0].coefficient), "s"),
        ("factor of k", Box::new(move |w| w.elements[1].coefficient = twice(&w.elements[1].coefficient)), "v"),
        (
            "lever",
            Box::new(move |w| {
                w.elements[1].ends[1] = w.elements[1].ends[1].as_ref().map(|p| p.each_ref().map(|c| c.halve()))
            }),
            "v",
        ),
        ("damper", Box::new(move |w| w.elements[2].coefficient = twice(&w.elements[2].coefficient)), "d"),
        (
            "gravity",
            Box::new(|w| {
                w.gravity = w.gravity.as_ref().map(|g| g.each_ref().map(|c| -c));
                w.free_fall = None
            }),
            "rod",
        ),
        (
            "lever of a force",
            Box::new(move |w| {
                w.inputs[0].ends[0] = w.inputs[0].ends[0].as_ref().map(|p| p.each_ref().map(|c| c.halve()))
            }),
            "rod",
        ),
    ];
    assert_eq!(faults.len(), 10);
    let scene = scene();
    let lowered = scene.lowered();
    for (name, fault, place) in faults {
        let mut written = scene.written.clone();
        fault(&mut written);
        let error = scene.derive(&written, &lowered).expect_err(name);
        assert_eq!(scene.place(error), place, "{name}");
    }
}

/// A fault in one thing that was derived, and the place in the model where it is reported.
pub type Fault = (&'static str, fn(&mut Equations), &'static str);

pub fn doubled(sum: &mut Sum) {
    *sum = sum.scale(&Rational::from(2));
}

pub fn assert_reported(scene: &Scene, faults: &[Fault]) {
    let lowered = scene.lowered();
    let sound = scene.derive(&scene.written, &lowered).expect("no defect");
    let verify = |equations: &Equations| verify::verify(equations, scene.checked.scene(), &lowered);
    verify(&sound).expect("no defect");
    for (name, fault, place) in faults {
        let mut faulty = sound.clone();
        fault(&mut faulty);
        assert_eq!(scene.place(verify(&faulty).expect_err(name)), *place, "{name}");
    }
}

/// Ten faults in what is derived from the energies, besides those in what it is derived from.
#[test]
fn ten_faults_in_the_derived_symbols_are_reported_where_they_are() {
    let faults: [Fault; 10] = [
        ("an entry of M", |e| doubled(&mut e.linear.mass[1][1].sum), "rod"),
        ("the sign of an entry of C", |e| e.linear.damping[1][1].sum = -&e.linear.damping[1][1].sum, "rod"),
        ("the curvature in K", |e| e.linear.stiffness[1][1].sum = Sum::ZERO, "rod"),
        ("the column of an input", |e| doubled(&mut e.linear.inputs[0].parts[0][1]), "rod"),
        ("the row of an output", |e| e.outputs[0].rows[0][0] = -&e.outputs[0].rows[0][0], "sway"),
        ("the row of a force", |e| e.outputs[1].rows[1][1] = Sum::ZERO, "pull"),
        (
            "a natural frequency",
            |e| {
                let value = e.parts[0].squares[0].value.as_mut().expect("a frequency");
                *value = &*value * &Number::from(Rational::new(1001, 1000));
            },
            "cart",
        ),
        ("a numerator", |e| doubled(&mut e.transfers[0].reduced.0[0]), "sway"),
        ("a denominator", |e| e.transfers[0].reduced.1[2] = Sum::ZERO, "sway"),
        ("the kinetic energy", |e| doubled(&mut e.energies.kinetic), "cart"),
    ];
    assert_reported(&scene(), &faults);
}

fn reduced(equations: &mut Equations) -> &mut vibc::equations::loops::Reduced {
    equations.reduced.as_mut().expect("constraints").as_mut().expect("a loop that is solved")
}

#[test]
fn faults_in_loop_and_damper_terms_are_reported() {
    let faults: [Fault; 5] = [
        ("a velocity ratio", |e| doubled(&mut reduced(e).follows[0].ratios[0].form), "q"),
        ("a term without multipliers", |e| doubled(&mut reduced(e).equations[0].plain), "left"),
        ("the force without multipliers", |e| reduced(e).equations[0].forces = Sum::ZERO, "left"),
        ("the slope of a constraint", |e| doubled(&mut e.nonlinear[0].reactions[0].1), "left"),
        (
            "a damping ratio",
            |e| {
                let part = e.parts.iter_mut().find(|part| part.damping_ratio.is_some()).expect("a damped part");
                let ratio = part.damping_ratio.as_mut().expect("a ratio");
                ratio.1 = -&ratio.1;
            },
            "wheel",
        ),
    ];
    assert_reported(&scene_of(LOOP), &faults);
}

/// The equations of motion are held against derivatives of the energies: a term that is changed in one of them is found.
#[test]
fn faults_in_the_equations_of_motion_are_reported() {
    let scene = scene();
    let lowered = scene.lowered();
    let sound = scene.derive(&scene.written, &lowered).expect("no defect");
    let verify = |equations: &Equations| verify::verify(equations, scene.checked.scene(), &lowered);
    for (index, body) in ["cart", "rod"].into_iter().enumerate() {
        for place in 0..sound.nonlinear[index].plain.terms().len() {
            let mut faulty = sound.clone();
            let mut terms = sound.nonlinear[index].plain.terms().to_vec();
            terms[place].1 = -&terms[place].1;
            faulty.nonlinear[index].plain = Sum::of_terms(terms);
            let error = verify(&faulty).expect_err("a changed term");
            assert_eq!(scene.place(error), body, "term {place}");
        }
        let mut faulty = sound.clone();
        for line in &mut faulty.nonlinear[index].lines {
            line.slope = line.slope.scale(&Rational::from(2));
        }
        if !faulty.nonlinear[index].lines.is_empty() {
            assert_eq!(scene.place(verify(&faulty).expect_err("changed slopes")), body);
        }
    }
}

/// A rotor on a frame that turns, in a component that is mirrored, and one whose speed is not given.
const ROTORS: &str = "param m = 50 kg
param b = 0.3 m
component rotor(part p, f = 20 Hz, h = 0.3 m, e = 2 mm) {
  unbalance U: p@(0.2 m, h) { me = 0.4 kg * e, speed = f, clockwise }
}
body frame { mass = m, inertia = 2 kg*m^2, at = (0, 0), moves x y, turns }
spring a: ground@(-0.5 m, -1 m) -- frame@(-0.5 m, 0) { k = 200 kN/m, along = y }
spring b: ground@(0.5 m, -1 m) -- frame@(0.5 m, 0) { k = 200 kN/m, along = y }
spring c: ground@(-1.5 m, 0) -- frame@(-0.5 m, 0) { k = 200 kN/m, along = x }
place left = rotor(p = frame) at (0, 0) mirrored x
unbalance V: frame@(0, b) { me = 3 g*m }
output tilt = frame.angle
";

fn unbalance(equations: &mut Equations, work: usize) -> &mut vibc::equations::unbalance::Unbalance {
    equations.energies.works[work].unbalance.as_mut().expect("an unbalance")
}

#[test]
fn faults_in_the_force_of_an_unbalance_are_reported() {
    let scene = scene_of(ROTORS);
    let lowered = scene.lowered();
    scene.derive(&scene.written, &lowered).expect("no defect");
    // In the lowered column: the opposite, another factor, another derivative, another lever.
    for (name, fault) in [
        (
            "sign",
            Box::new(|b: &mut [Vec<_>]| b[2].iter_mut().for_each(|(_, value)| *value = -&*value))
                as Box<dyn Fn(&mut [Vec<_>])>,
        ),
        ("factor", Box::new(|b| b[2].iter_mut().for_each(|(_, value)| *value = &*value + &*value))),
        ("derivative", Box::new(|b| b.swap(0, 2))),
        (
            "lever",
            Box::new(|b| {
                b[2].iter_mut()
                    .rev()
                    .take(1)
                    .for_each(|(_, value)| *value = &*value * &Number::from(Rational::new(11, 10)))
            }),
        ),
    ] {
        for input in 0..4 {
            let mut lowered = scene.lowered();
            fault(&mut lowered.system.inputs[input].b[..]);
            let error = scene.derive(&scene.written, &lowered).expect_err(name);
            assert_eq!(scene.place(error), "frame", "{name} of {input}");
        }
    }
    // In what the symbols are made from.
    type Change = fn(&mut model::written::WrittenInput);
    let changes: [(&str, usize, Change, &str); 6] = [
        ("size", 0, |own| doubled(&mut own.rotation.as_mut().expect("a rotation").unbalance), "U"),
        ("speed", 1, |own| doubled(own.rotation.as_mut().expect("a rotation").speed.as_mut().expect("a speed")), "U"),
        ("sense", 1, |own| own.rotation.as_mut().expect("a rotation").clockwise = false, "U"),
        ("sense of the free rotor", 3, |own| own.rotation.as_mut().expect("a rotation").clockwise = true, "V"),
        ("axis", 0, |own| own.along = own.along.as_ref().map(|along| along.each_ref().map(|part| -part)), "frame"),
        ("place", 2, |own| own.ends[0] = own.ends[0].as_ref().map(|at| at.each_ref().map(Sum::halve)), "frame"),
    ];
    for (name, input, change, place) in changes {
        let mut written = scene.written.clone();
        change(&mut written.inputs[input]);
        let error = scene.derive(&written, &lowered).expect_err(name);
        assert_eq!(scene.place(error), place, "{name}");
    }
    // In what is derived and printed.
    let faults: [Fault; 6] = [
        ("the force", |e| doubled(&mut unbalance(e, 1).force), "U"),
        ("the sign of the free force", |e| unbalance(e, 2).force = -&unbalance(e, 2).force, "V"),
        ("the place of the heavy spot", |e| unbalance(e, 3).place = -&unbalance(e, 3).place, "V"),
        ("the force of the linearised equations", |e| e.linear.inputs[0].force = Some(Sum::one()), "U"),
        ("its column", |e| doubled(&mut e.linear.inputs[1].parts[2][1]), "frame"),
        ("the generalised force", |e| doubled(&mut e.nonlinear[2].forces), "frame"),
    ];
    assert_reported(&scene, &faults);
}
