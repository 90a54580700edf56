//! Equations with belts: closed forms, energies by the normals at which spans touch their disks, generated scenes, and faults.

use super::belts::spans;
use super::equations::{example, says, text_of};
use super::equations_faults::{Fault, Scene, assert_reported, changed, doubled, scene_of};
use super::equations_linter as linter;
use std::collections::BTreeMap;
use vibc::backend::equations::{document, text};
use vibc::base::{Number, Rational, SourceFile, Sources};
use vibc::equations::Equations;
use vibc::equations::energy::Element;
use vibc::model::{Overrides, Written};
use vibc::symbols::{Dependence, Sum, Symbol};

fn assert_says(text: &str, lines: &[&str]) {
    for line in lines {
        assert!(says(text, line), "{line} is not in\n{text}");
    }
}

fn fixed(more: &str, second: &str) -> String {
    format!(
        "param r1 = 0.1 m\nparam r2 = 0.25 m\nparam m1 = 2 kg\nparam m2 = 5 kg\nparam k = 200 kN/m\n\
         body motor {{ mass = m1, shape = disk(r1), at = (0, 0), turns }}\n\
         body pump {{ mass = m2, shape = ring({second}), at = (0.7 m, 0.2 m), turns }}\n\
         belt r: motor -- pump {{ k = k{more} }}\ntorque M: motor\noutput pull = r.force\n"
    )
}

/// Two spans of stiffness k that a relative turn stretches by +-(r1 theta1 -+ r2 theta2), whatever their tension.
#[test]
fn a_belt_between_fixed_centres_has_the_equations_of_the_textbook() {
    let open = [
        "V = k (r1 theta_motor - r2 theta_pump)^2",
        "m1 r1^2/2 theta_motor'' + 2 k r1^2 theta_motor - 2 k r1 r2 theta_pump = M",
        "m2 r2^2 theta_pump'' - 2 k r1 r2 theta_motor + 2 k r2^2 theta_pump = 0",
    ];
    let crossed = [
        "V = k (r1 theta_motor + r2 theta_pump)^2",
        "m1 r1^2/2 theta_motor'' + 2 k r1^2 theta_motor + 2 k r1 r2 theta_pump = M",
        "m2 r2^2 theta_pump'' + 2 k r1 r2 theta_motor + 2 k r2^2 theta_pump = 0",
    ];
    for preload in ["", ", preload = 80 N"] {
        let text = text_of("belt", &fixed(preload, "r2"));
        assert_says(&text, &open);
        // The rigid motion stretches nothing: both polynomials have lost their factors s.
        assert_says(&text, &["pull/M = 2 m2 k/(m1 m2 r1 s^2 + 2 k r1 (m1 + 2 m2))"]);
        assert_says(&text_of("belt", &fixed(&format!("{preload}, crossed"), "r2")), &crossed);
        assert_says(&text_of("belt", &fixed(preload, "r1")), &["V = k r1^2 (theta_motor - theta_pump)^2"]);
    }
}

/// The belt to a disk on an arm: what is wound up is the turn against the arm, as in a planetary gear.
#[test]
fn a_belt_on_an_arm_winds_up_what_turns_against_the_arm() {
    let text = text_of(
        "arm",
        "param r1 = 0.1 m\nparam r2 = 0.05 m\nparam L = 0.5 m\nparam k = 200 kN/m\nbody arm { mass = 2 kg, shape = rod((0, 0), (L, 0)) }\n\
         pivot p: ground@(0, 0) -- arm\nbody sun { mass = 3 kg, shape = disk(r1), at = (0, 0), turns }\n\
         body planet { mass = 1 kg, shape = disk(r2), at = (L, 0) }\npivot q: arm@(L, 0) -- planet\nspring t: ground -- sun { k = 10 N*m/rad }\n\
         belt b: sun -- planet { k = k }\n",
    );
    // r1 (theta_sun - theta_arm) - r2 (theta_planet - theta_arm)
    assert_says(&text, &["V = 5 theta_sun^2 + k ((r2 - r1) theta_arm + r1 theta_sun - r2 theta_planet)^2"]);
}

/// The change of a belt's length, 2 sqrt(d^2 - g^2) + 2 g asin(g/d) + pi (r1 + r2), is twice e; the tensioner holds 2 T cos(beta).
#[test]
fn the_belt_drive_has_its_equations() {
    assert_says(
        &example("belt_drive.vib"),
        &[
            "d_drive = 0.8 - x",
            "beta_drive = asin(0.12/d_drive)",
            "e_drive = d_drive cos(beta_drive) + 0.12 beta_drive - 0.04 sqrt(391) - 0.12 asin(0.15)",
            "20 x'' + 300 x' + T_tensioner + 40000 x - (2 k e_drive + 600) cos(beta_drive) = 0",
            "T_tensioner = 30 sqrt(391) = 593.212    the tension of tensioner as drawn, in SI units",
            "0.064 theta_motor'' + 0.0128 k theta_motor - 0.032 k theta_fan = T",
        ],
    );
}

fn equations_of(model: &str) -> Equations {
    let mut sources = Sources::new();
    let file = sources.add(SourceFile::model("belts.vib", model));
    let outcome = vibc::equations(&sources, file, &Overrides::default());
    let shown = vibc::diagnostics_short(&sources, &outcome.diagnostics);
    outcome.answer.unwrap_or_else(|| panic!("{model}\n{shown}"))
}

/// Values of coordinates by their names, as `a.x`; of what depends on them by what it stands for.
struct State<'a> {
    equations: &'a Equations,
    given: BTreeMap<Symbol, Number>,
}

impl State<'_> {
    fn value(&self, sum: &Sum) -> f64 {
        self.number(sum).expect("a value").to_f64()
    }

    fn number(&self, sum: &Sum) -> Option<Number> {
        sum.value(&|symbol| {
            let own = || self.equations.energies.lengths.0.iter().find(|(name, _)| *name == symbol);
            let known = self.given.get(&symbol).or_else(|| self.equations.names.value(symbol)).cloned();
            known.or_else(|| match &own()?.1 {
                Dependence::Root(square) => self.number(square)?.sqrt(),
                Dependence::Form { form, .. } => self.number(form),
            })
        })
    }

    /// k e^2/2 + T e of every spring.
    fn energy(&self) -> f64 {
        let of = |element: &Element| {
            let stretched = self.value(&element.elongation());
            0.5 * self.value(&element.coefficient) * stretched * stretched + self.value(&element.tension) * stretched
        };
        self.equations.energies.elements.iter().map(of).sum::<f64>()
    }
}

/// A number from 0 to 1: xorshift.
struct Dice(u64);

impl Dice {
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    fn from(&mut self, low: i64, high: i64) -> i64 {
        low + (self.next() * (high - low + 1) as f64) as i64
    }

    fn one_of<T: Copy>(&mut self, all: &[T]) -> T {
        all[self.from(0, all.len() as i64 - 1) as usize]
    }
}

/// Forty drives in all positions: the energy of the symbols is that of the normals, each entry is that of `analyze` (or there would be a
/// defect), and each line is written as people write.
#[test]
fn generated_belts_have_the_energy_of_their_normals() {
    let mut dice = Dice(0x9e37_79b9_7f4a_7c15);
    for case in 0..40 {
        let crossed = dice.one_of(&[false, true]);
        let radii = [0, 1].map(|_| dice.from(5, 30) as f64 / 100.0);
        let radii = if case % 8 == 0 { [radii[0]; 2] } else { radii };
        let centre = match case % 5 {
            0 => [dice.one_of(&[-1.0, 1.0]), 0.0],
            1 => [0.0, dice.one_of(&[-1.0, 1.0])],
            2 => [-1.0, dice.one_of(&[-0.01, 0.01])],
            _ => [dice.one_of(&[-0.9, 0.7]), dice.one_of(&[-0.6, 0.8])],
        };
        let moves = [dice.one_of(&["", "x", "y", "x y"]), dice.one_of(&["x", "y", "x y"])];
        let rests = dice.one_of(&["", "rest as drawn\n", "gravity 9.81 m/s^2\n"]);
        // As parameters or as numbers.
        let named = dice.one_of(&[true, false]);
        let radius = |which: usize| if named { format!("r{which}") } else { format!("{} m", radii[which]) };
        let mut model =
            format!("param k = 30 kN/m\nparam T = 80 N\nparam r0 = {} m\nparam r1 = {} m\n{rests}", radii[0], radii[1]);
        for (which, (name, ways)) in ["a", "b"].into_iter().zip(moves).enumerate() {
            let at = if which == 0 { [0.0; 2] } else { centre };
            let moving = if ways.is_empty() { String::new() } else { format!(", moves {ways}") };
            let shape = radius(which);
            model += &format!(
                "body {name} {{ mass = 2 kg, shape = disk({shape}), at = ({} m, {} m){moving}, turns }}\n",
                at[0], at[1]
            );
            model += &format!("spring t{name}: ground -- {name} {{ k = 90 N*m/rad }}\n");
            for way in ways.split_whitespace() {
                model += &format!("spring s{name}{way}: ground -- {name} {{ k = 9 kN/m, along = {way} }}\n");
            }
        }
        let sense = if crossed { ", crossed" } else { "" };
        model +=
            &format!("belt q: a -- b {{ k = k, preload = T{sense} }}\noutput pull = q.force\noutput e = q.stretch\n");
        let model = if named {
            model
        } else {
            model.replace(&format!("param r0 = {} m\nparam r1 = {} m\n", radii[0], radii[1]), "")
        };
        let equations = equations_of(&model);
        for formula in linter::formulas(&text(&document(&equations), vibc::backend::report::WIDTH)) {
            let found = linter::faults(&formula);
            assert!(found.is_empty(), "{found:?} in {formula}\n{model}");
        }
        let coordinates = &equations.motion.coordinates;
        let mut energies = [0.0; 2];
        let mut truths = [0.0; 2];
        for state in 0..2 {
            let mut given = BTreeMap::new();
            // x, y and angle of both disks, from the drawing.
            let mut places = [[0.0, 0.0, 0.0], [centre[0], centre[1], 0.0]];
            let mut others = 0.0;
            for (index, coordinate) in coordinates.iter().enumerate() {
                let moved = 0.1 * dice.next() - 0.05;
                given.insert(coordinate.symbols[0], Number::Ball(vibc::base::Ball::from(moved)));
                let rest = equations.names.value_of(&coordinate.rest).expect("a rest").to_f64();
                let which = usize::from(equations.bodies[index] == "b");
                let way = ["x", "y", "angle"].iter().position(|way| *way == coordinate.motion).expect("a motion");
                places[which][way] += moved + rest;
                others += 0.5 * if way == 2 { 90.0 } else { 9e3 } * (moved + rest).powi(2);
            }
            let drawn = spans([0.0; 3], [centre[0], centre[1], 0.0], radii, crossed);
            // The angle of the line of centres jumps where it points to the left.
            let below = |y: f64| f64::from(u8::from(y < 0.0));
            let [_, level, _] = [0, 1, 2].map(|way| places[1][way] - places[0][way]);
            let turns = if centre[0] < 0.0 { below(level) - below(centre[1]) } else { 0.0 };
            let gap = if crossed { radii[0] + radii[1] } else { radii[0] - radii[1] };
            let now = spans(places[0], places[1], radii, crossed);
            let stretch = |side: usize| {
                let jump = std::f64::consts::TAU * gap * turns;
                now[side] - drawn[side] - if side == 0 { jump } else { -jump }
            };
            truths[state] = others + [0, 1].map(stretch).iter().map(|e| 15e3 * e * e + 80.0 * e).sum::<f64>();
            // Tensions that hold the drawing are in the energy of the symbols, too.
            let point = State { equations: &equations, given };
            let held = |element: &Element| {
                let is_belt = element.name == "q";
                if is_belt { 0.0 } else { point.value(&element.tension) * point.value(&element.elongation()) }
            };
            energies[state] = point.energy() - equations.energies.elements.iter().map(held).sum::<f64>();
        }
        for (found, truth) in energies.into_iter().zip(truths) {
            assert!((found - truth).abs() < 1e-9 * (1.0 + truth.abs()), "{found}, not {truth}:\n{model}");
        }
    }
}

/// A drive whose centres turn about each other, and whose spans pull unequally at rest.
const DRIVE: &str = "param r = 0.1 m
param R = 0.2 m
param k = 2 kN/m
param T = 90 N
body motor { mass = 1 kg, shape = disk(r), at = (0, 0), moves x, turns }
body pump { mass = 1 kg, shape = disk(R), at = (0.6 m, 0.3 m), moves y, turns }
spring s: ground -- motor { k = 3 kN/m, along = x }
spring u: ground -- pump { k = 5 kN/m, along = y }
spring t: ground -- motor { k = 40 N*m/rad }
spring v: ground -- pump { k = 60 N*m/rad }
belt q: motor -- pump { k = k, preload = T }
torque M: motor = constant(5 N*m)
output pull = q.force
";

#[test]
fn ten_faults_in_the_lowered_spans_are_reported_at_the_belt() {
    let scene = scene_of(DRIVE);
    type Change = fn(&mut Number, &mut Vec<Number>) -> bool;
    let faults: [(&str, Change); 10] = [
        ("sign", |weight, _| negate(weight)),
        ("factor", |weight, _| scale(weight, 2, 1)),
        ("half", |weight, _| scale(weight, 1, 2)),
        ("a little", |weight, _| scale(weight, 1001, 1000)),
        ("left out", |_, _| false),
        ("first lever", |_, values| scale(&mut values[0], 11, 10)),
        ("sign of the first lever", |_, values| negate(&mut values[0])),
        ("last lever", |_, values| values.last_mut().is_some_and(|last| scale(last, 11, 10))),
        ("sign of the last lever", |_, values| values.last_mut().is_some_and(negate)),
        ("one lever for both", |_, values| {
            let first = values[0].clone();
            values.last_mut().is_some_and(|last| {
                *last = first;
                true
            })
        }),
    ];
    for (name, fault) in faults {
        // In each term of the belt by itself: both spans, and what their tensions add.
        for wanted in 0.. {
            let mut lowered = scene.lowered();
            let system = lowered.system.clone();
            let count = std::cell::Cell::new(0);
            let display = |source| system.display(system.k.source_of(source));
            lowered.system.k = changed(&system.k, &["q"], display, |weight, values, _| {
                let own = count.replace(count.get() + 1) == wanted;
                !own || fault(weight, values)
            });
            if count.get() <= wanted {
                assert!(wanted >= 2, "the terms of a belt");
                break;
            }
            if lowered.system.k.terms().len() == system.k.terms().len() && same(&lowered.system.k, &system.k) {
                continue;
            }
            let error = scene.derive(&scene.written, &lowered).expect_err(name);
            assert_eq!(scene.place(error), "q", "{name} of term {wanted}");
        }
    }
}

fn same(a: &vibc::system::Form, b: &vibc::system::Form) -> bool {
    a.terms().zip(b.terms()).all(|(first, second)| {
        let row = |form: &vibc::system::Form, term| form.row(term).iter().map(|(_, v)| v.to_f64()).collect::<Vec<_>>();
        first.weight.to_f64() == second.weight.to_f64() && row(a, first) == row(b, second)
    })
}

fn negate(number: &mut Number) -> bool {
    *number = -&*number;
    true
}

fn scale(number: &mut Number, numerator: i64, denominator: i64) -> bool {
    *number = &*number * &Number::from(Rational::new(numerator, denominator));
    true
}

#[test]
fn ten_faults_in_what_a_belt_is_written_from_are_reported() {
    let scene = scene_of(DRIVE);
    let lowered = scene.lowered();
    type Change = fn(&mut Written);
    let belt = |written: &Written| written.elements.len() - 1;
    assert_eq!(belt(&scene.written), 4);
    fn pair(place: &mut Option<[Sum; 2]>, change: impl Fn(&Sum) -> Sum) {
        *place = place.as_ref().map(|place| place.each_ref().map(change));
    }
    let faults: [(&str, Change); 10] = [
        ("sign of k", |w| w.elements[4].coefficient = -&w.elements[4].coefficient),
        ("factor of k", |w| doubled(&mut w.elements[4].coefficient)),
        ("sign of the preload", |w| w.elements[4].preload = w.elements[4].preload.as_ref().map(|sum| -sum)),
        ("factor of the preload", |w| w.elements[4].preload.iter_mut().for_each(doubled)),
        ("first radius", |w| w.bodies[0].radius.iter_mut().for_each(doubled)),
        ("sign of the first radius", |w| w.bodies[0].radius = w.bodies[0].radius.as_ref().map(|sum| -sum)),
        ("second radius", |w| w.bodies[1].radius = w.bodies[1].radius.as_ref().map(Sum::halve)),
        ("sign of the second radius", |w| w.bodies[1].radius = w.bodies[1].radius.as_ref().map(|sum| -sum)),
        ("a centre", |w| pair(&mut w.bodies[1].centre, |sum| sum.scale(&Rational::new(11, 10)))),
        ("the other side", |w| pair(&mut w.bodies[1].centre, |sum| -sum)),
    ];
    for (name, fault) in faults {
        let mut written = scene.written.clone();
        fault(&mut written);
        let error = scene.derive(&written, &lowered).expect_err(name);
        assert_eq!(scene.place(error), "q", "{name}");
    }
}

/// What a name of the belt stands for, by its word.
fn dependence<'a>(equations: &'a mut Equations, word: &str) -> &'a mut Dependence {
    let names = equations.names.clone();
    let found = equations.energies.lengths.0.iter_mut().find(|(name, _)| names.label(*name).word == word);
    &mut found.expect("a name").1
}

fn form<'a>(equations: &'a mut Equations, word: &str) -> &'a mut Sum {
    match dependence(equations, word) {
        Dependence::Root(sum) | Dependence::Form { form: sum, .. } => sum,
    }
}

fn part<'a>(equations: &'a mut Equations, label: &str) -> &'a mut Sum {
    let names = equations.names.clone();
    let found = equations.linear.parts.iter_mut().find(|(name, _)| names.label(*name).plain() == label);
    &mut found.unwrap_or_else(|| panic!("{label}")).1
}

fn drive() -> Scene {
    scene_of(DRIVE)
}

#[test]
fn faults_in_what_is_derived_of_a_belt_are_reported() {
    let faults: [Fault; 12] = [
        ("the distance", |e| doubled(form(e, "d")), "motor"),
        ("the slant", |e| doubled(form(e, "beta")), "motor"),
        ("the mean stretch", |e| *form(e, "e") = -&*form(e, "e"), "motor"),
        ("the turn of the centres", |e| *form(e, "psi") = -&*form(e, "psi"), "motor"),
        ("the lever on the pump", |e| doubled(&mut e.nonlinear[2].lines[1].slope), "pump"),
        ("the lever of the pump's angle", |e| e.nonlinear[3].lines[0].slope = Sum::ZERO, "pump"),
        ("the lever of the mean", |e| doubled(&mut e.nonlinear[0].lines[0].slope), "motor"),
        ("the lever of the difference", |e| doubled(&mut e.nonlinear[1].lines[0].slope), "motor"),
        ("an entry", |e| doubled(&mut e.linear.stiffness[0][2].sum), "motor"),
        ("the force that is put out", |e| e.outputs[0].rows[0][1] = -&e.outputs[0].rows[0][1], "pull"),
        ("a condition of rest", |e| e.rest.conditions[0].1 = &e.rest.conditions[0].1 + &Sum::one(), "motor"),
        (
            "a numerator",
            |e| {
                let transfer = e.transfers.first_mut().expect("a transfer function");
                transfer.numbers[0] = &transfer.numbers[0] + &transfer.numbers[0];
            },
            "pull",
        ),
    ];
    assert_reported(&drive(), &faults);
}

/// Definitions of names at rest have the values that entries are computed with.
#[test]
fn names_of_a_belt_have_the_values_of_the_geometry() {
    let mut equations = equations_of(DRIVE);
    let names = equations.names.clone();
    let rest: Vec<f64> =
        equations.motion.coordinates.iter().map(|c| names.value_of(&c.rest).expect("a rest").to_f64()).collect();
    let (x, y) = (0.6 - rest[0], 0.3 + rest[2]);
    let (d, drawn) = (x.hypot(y), 0.6_f64.hypot(0.3));
    let beta = |d: f64| (0.1 / d).asin();
    let mean = |d: f64| d * beta(d).cos() + 0.1 * beta(d);
    let (e, psi) = (mean(d) - mean(drawn), y.atan2(x) - 0.3_f64.atan2(0.6));
    let half = 0.1 * rest[1] - 0.2 * rest[3] + 0.1 * psi;
    assert!(half.abs() > 1e-4 && e.abs() > 1e-4, "{half} {e}");
    let pull = 2.0 * 2000.0 * e + 180.0;
    for (label, value) in [
        ("beta_q,0", beta(d)),
        ("e_q,0", e),
        ("psi_q,0", psi),
        ("q_q", pull * beta(d).cos() / d),
        ("S_q", 2.0 * 2000.0 * half),
        ("n_q", 2.0 * 2000.0 * half / d),
        ("r_q,x", -x / d),
        ("r_q,y", y / d),
        ("w_q,x", 0.1 * y / (d * d)),
        ("w_q,y", 0.1 * x / (d * d)),
    ] {
        let written = names.value_of(part(&mut equations, label)).expect("a value").to_f64();
        assert!((written - value).abs() < 1e-10 * (1.0 + value.abs()), "{label}: {written}, not {value}");
    }
}
