//! Emitted programs against the exact response: C and Rust print the same bits, and both are within rounding of the
//! motion that `vibc simulate` computes with bounds. See docs/method/emit.md.

use super::emit::{STRICT, emission, examples, options, silently, write};
use super::systems::{Builder, HardCase, number};
use super::transfer::with_every_pair;
use std::process::Command;
use tempfile::TempDir;
use vibc::analysis::discrete::{DiscreteSystem, Hold, Options, Precision, Why};
use vibc::analysis::{self, History, Signal, discretise, respond};
use vibc::backend::emit::{self, Language, Program};
use vibc::base::{Number, SourceFile, SourceKind, Sources};
use vibc::model::Overrides;
use vibc::system::{CoordinateId, LinearSystem};

/// The output of a program.
pub struct Printed {
    header: String,
    pub rows: Vec<Vec<f64>>,
}

/// Compiles and runs the programs in C and Rust; they must print the same bytes.
pub fn printed(name: &str, system: &DiscreteSystem, program: &Program) -> Printed {
    let folder = tempfile::tempdir().expect("a folder");
    let main = run_c(&folder, name, system, program, "gcc", &[]);
    same(&main, &run_rust(&folder, name, system, program), name);
    let mut lines = main.lines();
    let header = lines.next().expect("a header").to_string();
    let read = |field: &str| field.parse::<f64>().expect("a number");
    Printed { header, rows: lines.map(|line| line.split(',').map(read).collect()).collect() }
}

/// Every example under its own signals, with a second C compiler.
#[test]
#[ignore = "needs clang"]
fn another_compiler_finds_the_same_bits() {
    for (name, text) in examples() {
        let wanted = Options { built_in: true, ..options("0.01") };
        let system = emission(&name, &text, &wanted).system;
        let program = Program { step: number("0.01"), samples: 1001 };
        let folder = tempfile::tempdir().expect("a folder");
        let [gcc, clang] = ["gcc", "clang"].map(|compiler| run_c(&folder, &name, &system, &program, compiler, &[]));
        same(&gcc, &clang, &name);
    }
}

/// Asserts that two texts are equal; shows the first line that differs.
fn same(a: &str, b: &str, name: &str) {
    let differ = a.lines().zip(b.lines()).find(|(a, b)| a != b);
    assert!(differ.is_none() && a.len() == b.len(), "{name}: {differ:?}");
}

fn run_c(
    folder: &TempDir,
    name: &str,
    system: &DiscreteSystem,
    program: &Program,
    compiler: &str,
    more: &[&str],
) -> String {
    let files = emit::files(name, system, Language::C, Some(program));
    write(folder, &files);
    let sources: Vec<&str> = files.iter().map(|file| file.name.as_str()).filter(|name| name.ends_with(".c")).collect();
    silently(folder, compiler, &[&STRICT[..], &["-O1", "-o", "c"], more, &sources, &["-lm"]].concat());
    output(folder, "c")
}

fn run_rust(folder: &TempDir, name: &str, system: &DiscreteSystem, program: &Program) -> String {
    write(folder, &emit::files(name, system, Language::Rust, Some(program)));
    silently(folder, "rustc", &["-C", "opt-level=1", "-o", "r", "main.rs"]);
    output(folder, "r")
}

pub fn output(folder: &TempDir, program: &str) -> String {
    let output = Command::new(folder.path().join(program)).output().expect("it runs");
    assert!(output.status.success());
    String::from_utf8(output.stdout).expect("text")
}

/// The largest error of each output relative to its largest value, over every 997th sample and the last one; the exact
/// motion must be accurate to `room` of that.
fn errors(printed: &Printed, history: impl Fn(&[Number]) -> History, step: &Number, room: f64) -> Vec<f64> {
    let last = printed.rows.len() - 1;
    let samples: Vec<usize> = (0..last).step_by(997).chain([last]).collect();
    let times: Vec<Number> = samples.iter().map(|&k| step * &Number::from(k as i64)).collect();
    let exact = history(&times);
    let outputs = printed.rows[0].len() - 1;
    let of = |output: usize| {
        let largest = printed.rows.iter().map(|row| row[output + 1].abs()).fold(0.0, f64::max);
        let error = |(&k, row): (&usize, &Vec<vibc::base::Ball>)| {
            let value = row[output];
            assert!(value.rad < room * largest.max(1e-300), "the reference is good to {:e}", value.rad);
            (printed.rows[k][output + 1] - value.to_f64()).abs()
        };
        let worst = samples.iter().zip(&exact.values).map(error).fold(0.0, f64::max);
        if worst == 0.0 { 0.0 } else { worst / largest }
    };
    (0..outputs).map(of).collect()
}

/// Runs a linear system under signals for 1e5 steps; every output must be accurate to 1e-12 of its largest value.
fn check(name: &str, system: &LinearSystem, drives: &[Vec<Signal>], step: &str) {
    let wanted = Options { built_in: true, internal: drives.to_vec(), ..options(step) };
    check_as(100_001, name, system, drives, step, &wanted, 1e-12);
}

/// Like `check`, for this many samples; if the run is known, the rounding error in the header must be above every
/// error, and at most a thousand times the worst.
pub fn check_as(
    samples: u64,
    name: &str,
    system: &LinearSystem,
    drives: &[Vec<Signal>],
    step: &str,
    options: &Options,
    most: f64,
) {
    let modes = analysis::modes(system).expect("modes");
    let discrete = discretise(system, &modes, options).expect("a discrete system");
    let step = number(step);
    let printed = printed(name, &discrete, &Program { step: step.clone(), samples });
    let history = |times: &[Number]| respond(system, drives, times).expect("a motion");
    let room = 1e-14;
    let wrong = printed.rows.iter().enumerate().find(|(k, row)| {
        let time = (&step * &Number::from(*k as i64)).to_f64();
        // A step that is not a fraction of small numbers is rounded too.
        let once = time.abs() < 4e9 && (&step * &Number::from(1_000_000_000)).to_f64() < 4e9;
        if once { row[0] != time } else { (row[0] - time).abs() > 2.0 * f64::EPSILON * time }
    });
    assert_eq!(wrong.map(|(k, row)| (k, row[0])), None, "{name}: a time that is off");
    for (output, error) in errors(&printed, history, &step, room).into_iter().enumerate() {
        assert!(error <= most, "{name}, output {output}: {error:e} in {}", discrete.method);
    }
    if let Some(rounding) = &discrete.rounding {
        // If inputs come from outside (here they are zero), the bound holds for any inputs.
        let bound = rounding.error_after(samples).value();
        for error in errors(&printed, history, &step, room) {
            assert!(error <= bound + 2e-16, "{name}: {error:e} above {bound:e}");
        }
    }
    for reported in &discrete.measured {
        let rows = printed.rows[..printed.rows.len().min(reported.steps as usize + 1)].to_vec();
        let found = errors(&Printed { header: String::new(), rows }, history, &step, room);
        let worst = found.into_iter().fold(0.0, f64::max);
        // The reference is rounded to binary64.
        assert!(worst <= reported.error.value() + 2e-16, "{name}: {reported:?}, {worst:e}");
        assert!(reported.error.value() <= 1e3 * worst.max(1e-17), "{name}: {reported:?}, {worst:e}");
    }
}

/// Displacement and velocity of each coordinate, a force on each.
pub fn observed(system: &LinearSystem) -> LinearSystem {
    let mut system = with_every_pair(system.clone());
    for i in 0..system.n() {
        let mut velocity = system.outputs[i].clone();
        velocity.p.swap(0, 1);
        system.outputs.push(velocity);
    }
    system
}

/// All kinds of signals in turn on the examples' inputs.
fn signals(count: usize, step: &str) -> Vec<Vec<Signal>> {
    let (one, h) = (Number::ONE, number(step));
    let at = |steps: &str| &h * &number(steps);
    let all = [
        vec![
            Signal::Harmonic { value: one.clone(), frequency: number("1.7"), phase: number("0.3"), at: Number::ZERO },
            Signal::Step { value: number("2"), at: at("123.4") },
        ],
        vec![
            Signal::Ramp { value: number("3"), from: at("10"), to: at("170.7") },
            Signal::Pulse { value: one.clone(), from: at("301.25"), to: at("407") },
        ],
    ];
    (0..count).map(|i| all[i % 2].clone()).collect()
}

#[test]
fn examples_are_exact_after_1e5_steps() {
    for (name, text) in examples() {
        let mut sources = Sources::new();
        let model = sources.add(SourceFile::decode(SourceKind::Model, &name, text.into_bytes()));
        crate::examples::add_used_files(&mut sources, model);
        let dynamics = vibc::dynamics(&sources, model, &Overrides::default()).answer.expect("an example has answers");
        let mut system = dynamics.system;
        if system.n() > 20 {
            // The reference, which is dense, takes long.
            continue;
        }
        system.initial = vec![(CoordinateId(0), number("0.01"), number("-0.02"))];
        let drives = signals(system.inputs.len(), "0.001");
        check(&name, &system, &drives, "0.001");
    }
}

#[test]
fn hard_cases_are_exact_after_1e5_steps() {
    // Steps of about a twentieth of the period of the fastest motion that is not overdamped; of the slow motion if
    // rates lie far apart.
    let cases = [
        ("o12_critical_sdof", "0.01"),
        ("o13_near_critical_sdof", "0.01"),
        ("o15_nonproportional_2dof", "0.01"),
        ("o22_preload_tiny_dynamics", "0.001"),
        ("o27_long_phase", "0.015625"),
        ("o28_stiff_transient", "0.001"),
        ("o29_seed_cart", "0.01"),
        ("o32_nearcritical_2dof", "0.01"),
    ];
    for (name, step) in cases {
        let mut system = observed(&HardCase::load(name).system);
        system.initial = vec![(CoordinateId(0), number("0.5"), Number::ONE)];
        let drives = signals(system.inputs.len(), step);
        check(name, &system, &drives, step);
    }
}

/// `vibc emit --program` prints the same as `vibc simulate`, to 1e-12 or what its header says of rounding, starting from the text of the model: its signals, its
/// initial state, and the results of its `solve` lines.
#[test]
fn programs_print_what_simulate_does() {
    let solving = "param k = 1 N/m\nbody a { mass = 2 kg, moves x }\nbody b { mass = 1 kg, moves x }\n\
                   spring s: ground -- a { k = k }\nspring t: a -- b { k = 3 * k }\ndamper d: a -- b { c = 0.3 N*s/m }\n\
                   force F: a along x = pulse(4 N, 0.105 s, 0.4 s) + step(1 N, 0 s) + ramp(2 N, 0 s, 1.003 s)\n\
                   force G: b along x = impulse(1 N*s, 0 s) + impulse(-2 N*s, 0.7042 s)\nbody far { mass = 1 kg, moves x }\n\
                   spring u: ground -- far { k = 9000 N/m }\nforce unfelt: far along x = step(1 N, 0.05 s)\n\
                   force H: a along x = ramp(1 N, 0.2 s, 0.9 s)\ninitial b { x = 2 cm, vx = 0.1 m/s }\noutput xa = a.x\n\
                   output ab = b.ax\nsolve k in 1 N/m .. 1e4 N/m: frequency(1) = 2 Hz\n";
    // Dampers between a moving base and a body: the base enters velocities and accelerations directly; modes that the
    // damper couples, and modes that it does not.
    let riding = |other: &str| {
        format!(
            "body a {{ mass = 2 kg, moves y }}\nbody b {{ mass = 3 kg, moves y }}\nbase f {{ moves y }} = harmonic(1 cm, 1.3 Hz, 20 deg)\n\
             base g {{ moves y }} = ramp(2 cm, 0.103 s, 0.6 s)\nspring s: f -- a {{ k = 300 N/m }}\ndamper d: f -- a {{ c = 6 N*s/m }}\n\
             spring t: a -- b {{ k = 500 N/m }}\nspring u: g -- b {{ k = 450 N/m }}\ndamper e: g -- b {{ c = {other} }}\n\
             output aa = a.ay\noutput ab = b.ay\noutput va = a.vy\noutput pull = d.force\n"
        )
    };
    // C = K / 50: 6 = 300/50, 9 = 450/50, 10 = 500/50.
    let apart = format!("{}damper w: a -- b {{ c = 10 N*s/m }}\n", riding("9 N*s/m"));
    let rotor = "body b { mass = 5 kg, at = (0, 0), inertia = 2 kg*m^2, free }\nspring s: ground@(0, 1 m) -- b@(0.2 m, 0) { k = 3 kN/m }\n\
                 spring t: ground@(1 m, 0.3 m) -- b@(0, -0.1 m) { k = 2 kN/m }\nspring v: ground@(-1 m, 1 m) -- b { k = 1 kN/m }\n\
                 damper d: ground@(0, 1 m) -- b { c = 3 N*s/m }\nunbalance U: b@(0.1 m, 0) { me = 0.01 kg*m, speed = 5 Hz, clockwise }\n\
                 output x in mm = b.x\noutput ay = b.ay\noutput turn in deg = b.angle\n";
    let scenes = [
        ("solving", solving.to_string()),
        ("joined", riding("1 N*s/m")),
        ("apart", apart),
        ("rotor", rotor.to_string()),
    ];
    let all = examples().into_iter().chain(scenes.map(|(name, text)| (name.to_string(), text)));
    let step = number("0.01");
    let has_signal = |line: &str| {
        ["force", "torque", "base", "unbalance"].iter().any(|kind| line.starts_with(kind)) && line.contains(" = ")
    };
    for (name, text) in all.filter(|(_, text)| text.lines().any(has_signal)) {
        let wanted = Options { built_in: true, ..options("0.01") };
        let emitted = emission(&name, &text, &wanted);
        let program = Program { step: step.clone(), samples: 301 };
        let printed = printed(&name, &emitted.system, &program);
        let mut sources = Sources::new();
        let model = sources.add(SourceFile::decode(SourceKind::Model, &name, text.into_bytes()));
        crate::examples::add_used_files(&mut sources, model);
        let simulate = |times: &[Number]| {
            let motion = vibc::simulate(&sources, model, &Overrides::default(), times);
            motion.answer.expect("a motion").history
        };
        // Springs that ride on a table which flies off are rounded as its displacement is: as much as the header says.
        let most = emitted.system.measured.iter().map(|known| known.error.value()).fold(1e-12, f64::max);
        for (output, error) in errors(&printed, simulate, &step, 1e-14).into_iter().enumerate() {
            assert!(error <= most, "{name}, output {output}: {error:e}, {most:e}");
        }
    }
}

/// Events after the end of the motion are not built in, events before it are.
#[test]
fn signals_end_with_the_motion() {
    let text = "body a { mass = 1 kg, moves x }\nspring s: ground -- a { k = 9 N/m }\n\
                force F: a along x = pulse(1 N, 1 s, 2 s) + pulse(1 N, 3 s, 5 s) + impulse(1 N*s, 4 s) + impulse(1 N*s, 1.5 s)\n\
                output x = a.x\n";
    let ticks = |until: Option<&str>| -> Vec<u64> {
        let wanted = Options { built_in: true, until: until.map(number), ..options("0.01") };
        emission("ends", text, &wanted).system.events.iter().map(|event| event.tick).collect()
    };
    assert_eq!(ticks(None), [100, 150, 200, 300, 400, 500]);
    assert_eq!(ticks(Some("3.5")), [100, 150, 200, 300]);
    assert_eq!(ticks(Some("1.2")), [100]);
}

/// Steps of a quarter period and more, steps in which the fastest motion is aliased, and steps in which a motion decays
/// almost completely: the step is exact in all cases.
#[test]
fn steps_are_exact_however_long() {
    // A step of 0.1 s; k and c of uncoupled oscillators of 1 kg.
    let cases = [
        ("144", "0"),      // 1.2 rad
        ("400", "0"),      // 2 rad: past a quarter turn
        ("841", "1"),      // 2.9 rad
        ("400", "16"),     // past a quarter turn, decayed to a fifth
        ("100", "15"),     // decayed to a fifth, before a quarter turn
        ("2025", "0.5"),   // 4.5 rad: past half a turn
        ("3600", "0"),     // 6 rad
        ("100", "101"),    // rates 1 / s and 100 / s
        ("0", "5"),        // free, damped
        ("0", "0"),        // free
        ("100", "20"),     // critical
        ("100000", "400"), // decayed after a step
    ];
    let mut b = Builder::numbered(cases.len());
    for (i, (k, c)) in cases.into_iter().enumerate() {
        b.mass(i, &Number::ONE);
        b.spring(None, i, &number(k));
        b.damper(None, i, &number(c));
    }
    let mut system = observed(&b.finish());
    system.initial = (0..cases.len()).map(|i| (CoordinateId(i as u32), number("0.3"), number("-2"))).collect();
    let drives = signals(system.inputs.len(), "0.1");
    let wanted = Options { built_in: true, internal: drives.clone(), ..options("0.1") };
    check_as(1001, "steps", &system, &drives, "0.1", &wanted, 1e-12);
}

fn single(m: &str, c: &str, k: &str) -> LinearSystem {
    let mut b = Builder::numbered(1);
    b.mass(0, &number(m));
    b.spring(None, 0, &number(k));
    b.damper(None, 0, &number(c));
    observed(&b.finish())
}

/// Single precision, undamped, after 1e5 steps: within the bound stated in the header, with a large margin.
#[test]
fn single_precision_stays_within_its_bound() {
    let mut system = single("1", "0", "400");
    system.initial = vec![(CoordinateId(0), Number::ONE, Number::ZERO)];
    let wanted = Options { precision: Precision::Single, ..options("0.01") };
    let modes = analysis::modes(&system).expect("modes");
    let discrete = discretise(&system, &modes, &wanted).expect("a discrete system");
    let bound = discrete.rounding.as_ref().expect("the force is an input").error_after(100_000).value();
    check_as(100_001, "single", &system, &[], "0.01", &wanted, bound.min(1e-3));
}

/// Interpolation does not lose a change of the input between two samples: a ramp that follows the samples is exact with
/// `--hold first`.
#[test]
fn inputs_along_a_line_are_exact() {
    let folder = tempfile::tempdir().expect("a folder");
    let system = single("2", "0.7", "90");
    let modes = analysis::modes(&system).expect("modes");
    let discrete = discretise(&system, &modes, &Options { hold: Hold::First, ..options("0.01") }).expect("a system");
    write(&folder, &emit::files("line", &discrete, Language::C, None));
    // u = 3 + 5 t, from the first step on; the state is read back during the run.
    let main = "#include \"line.h\"\n#include <stdio.h>\nint main(void) { line_state s; line_inputs u; line_outputs y; line_motion m; \
                int k; line_init(&s); for (k = 0; k <= 200; k++) { u.x1 = 3.0 + 5.0 * (0.01 * k); line_step(&s, &u, &y); } \
                printf(\"%.17g %.17g\\n\", y.x1, y.x1_2); line_get_state(&s, &m); line_set_state(&s, &m); line_get_state(&s, &m); \
                printf(\"%.17g %.17g\\n\", m.displacement[0], m.velocity[0]); return 0; }\n";
    let main = main.replace("u.x1 =", &format!("u.{} =", input_field(&discrete)));
    std::fs::write(folder.path().join("main.c"), main).expect("a file");
    silently(&folder, "gcc", &["-std=c99", "-O1", "-o", "line_program", "main.c", "line.c", "-lm"]);
    let text = output(&folder, "line_program");
    let numbers: Vec<f64> = text.split_whitespace().map(|x| x.parse().expect("a number")).collect();
    let drive = vec![
        Signal::Step { value: number("3"), at: Number::ZERO },
        Signal::Ramp { value: number("500"), from: Number::ZERO, to: number("100") },
    ];
    let exact = respond(&system, &[drive], &[number("2")]).expect("a motion");
    for (value, exact) in numbers.iter().zip(&exact.values[0]) {
        assert!((value - exact.to_f64()).abs() < 1e-13, "{value:e} {:e}", exact.to_f64());
    }
    // At the next sample the input is still 13: the last interval has a constant force.
    let later = vec![
        Signal::Step { value: number("3"), at: Number::ZERO },
        Signal::Ramp { value: number("10"), from: Number::ZERO, to: number("2") },
    ];
    let exact = respond(&system, &[later], &[number("2.01")]).expect("a motion");
    for (value, exact) in numbers[2..].iter().zip(&exact.values[0]) {
        assert!((value - exact.to_f64()).abs() < 1e-13, "{value:e} {:e}", exact.to_f64());
    }
}

fn input_field(system: &DiscreteSystem) -> String {
    system.inputs[0].name.replace('.', "_")
}

/// States that no input reaches are not emitted, and the outputs do not change by a bit.
#[test]
fn a_symmetric_scene_driven_symmetrically_has_half_of_the_states() {
    let mut b = Builder::numbered(4);
    for i in 0..4 {
        b.mass(i, &number("1.3"));
    }
    for (from, to) in [(None, 0), (Some(0), 1), (Some(1), 2), (Some(2), 3), (None, 3)] {
        b.spring(from, to, &number("170.7"));
        b.damper(from, to, &number("0.2"));
    }
    let mut system = observed(&b.finish());
    // One force that acts equally on both ends.
    system.inputs.truncate(1);
    system.inputs[0].b[0] = vec![(CoordinateId(0), Number::ONE), (CoordinateId(3), Number::ONE)];
    let modes = analysis::modes(&system).expect("modes");
    let drives = signals(1, "0.01");
    let wanted = Options { built_in: true, internal: drives.clone(), ..options("0.01") };
    let whole = discretise(&system, &modes, &Options { unpruned: true, ..wanted.clone() }).expect("a system");
    let half = discretise(&system, &modes, &wanted).expect("a system");
    let of_signals: usize = half.cells[..half.signals].iter().map(|cell| cell.size()).sum();
    assert_eq!((whole.states() - of_signals, half.states() - of_signals), (8, 4));
    assert_eq!(half.left.len(), 2);
    let program = Program { step: number("0.01"), samples: 2001 };
    let (all, some) = (printed("whole", &whole, &program), printed("half", &half, &program));
    assert_eq!(all.header, some.header);
    let largest = all.rows.iter().flatten().fold(0.0f64, |most, x| most.max(x.abs()));
    for (a, b) in all.rows.iter().flatten().zip(some.rows.iter().flatten()) {
        assert!((a - b).abs() <= 1e-13 * largest, "{a:e} {b:e}");
    }
}

/// With a tolerance, fast modes that add little over the band are left out, and their static part is kept.
#[test]
fn a_tolerance_drops_fast_modes_and_keeps_their_static_part() {
    let mut b = Builder::numbered(2);
    b.mass(0, &Number::ONE);
    b.mass(1, &number("1e-6"));
    b.spring(None, 0, &number("100"));
    b.spring(Some(0), 1, &number("1e6"));
    b.damper(None, 0, &number("0.5"));
    b.damper(Some(0), 1, &number("1e-3"));
    let system = observed(&b.finish());
    let modes = analysis::modes(&system).expect("modes");
    let of = |tolerance| discretise(&system, &modes, &Options { tolerance, ..options("0.01") }).expect("a system");
    let mut fewer = of(Some(1e-2));
    assert_eq!(of(None).states(), 4);
    // The velocity of the light mass depends directly on its own fast mode, so that one is kept.
    if fewer.states() == 4 {
        let mut seen = system.clone();
        seen.outputs.truncate(1);
        seen.inputs.truncate(1);
        fewer = discretise(&seen, &modes, &Options { tolerance: Some(1e-6), ..options("0.01") }).expect("a system");
    }
    assert_eq!(fewer.states(), 2);
    let text = emit::whole("fewer", &fewer, Language::C);
    assert!(text.contains("its static part is kept"), "{text}");
}

/// A fast mode whose static part is twice that of the slow one: with a tolerance it is left out, its static part keeps
/// the motion under a held force within the tolerance, and the sum of everything left out is below it.
#[test]
fn omitted_modes_stay_below_the_tolerance() {
    let mut b = Builder::numbered(3);
    b.mass(0, &Number::ONE);
    b.spring(None, 0, &number("100"));
    b.damper(None, 0, &number("0.5"));
    for i in [1, 2] {
        b.mass(i, &number(["", "1e-6", "2e-6"][i]));
        b.spring(Some(0), i, &number("50"));
        b.damper(Some(0), i, &number("1e-3"));
    }
    let mut system = with_every_pair(b.finish());
    system.inputs.drain(..1);
    let modes = analysis::modes(&system).expect("modes");
    let of = |tolerance| {
        let step = vec![Signal::Step { value: Number::ONE, at: Number::ZERO }];
        let wanted = Options { tolerance, built_in: true, internal: vec![step.clone(), step], ..options("0.01") };
        discretise(&system, &modes, &wanted).expect("a system")
    };
    let share = |system: &DiscreteSystem| -> f64 {
        let shares = system.left.iter().map(|left| match left.why {
            Why::Small(share) => share.0,
            Why::Unreached | Why::Unseen => 0.0,
        });
        shares.sum()
    };
    let both = of(Some(0.01));
    assert_eq!(both.left.len(), 2);
    let together = share(&both);
    assert!((1e-6..0.01).contains(&together), "{together:e}");
    let one = of(Some(0.9 * together));
    assert_eq!(one.left.len(), 1);
    assert!(share(&one) <= 0.9 * together);
    let program = Program { step: number("0.01"), samples: 501 };
    let (whole, fewer) = (printed("whole", &of(None), &program), printed("fewer", &both, &program));
    // The largest gain is that of the slow mode at its resonance, Q / k = 20 / 100; a fast mode decays within 0.05 s.
    let most = together * 0.2 * 2.0;
    for (a, b) in whole.rows.iter().zip(&fewer.rows).skip(10) {
        assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() <= most), "{a:?} {b:?}");
    }
}

/// A mode that no input reaches is kept if the motion starts in it.
#[test]
fn an_initial_state_keeps_modes_that_no_input_reaches() {
    let mut b = Builder::numbered(2);
    for i in 0..2 {
        b.mass(i, &Number::ONE);
        b.spring(None, i, &number("30"));
    }
    b.spring(Some(0), 1, &number("20"));
    let mut system = observed(&b.finish());
    system.inputs.truncate(1);
    system.inputs[0].b[0] = vec![(CoordinateId(0), Number::ONE), (CoordinateId(1), Number::ONE)];
    let modes = analysis::modes(&system).expect("modes");
    let states = |system: &LinearSystem| discretise(system, &modes, &options("0.01")).expect("a system").states();
    assert_eq!(states(&system), 2);
    system.initial = vec![(CoordinateId(0), Number::ONE, Number::ZERO)];
    assert_eq!(states(&system), 4);
}

/// The compiler's sanitizers find no undefined behaviour and no memory error.
#[test]
fn sanitizers_find_nothing() {
    let mut system = observed(&HardCase::load("o29_seed_cart").system);
    system.initial = vec![(CoordinateId(0), number("0.5"), Number::ONE)];
    let drives = signals(system.inputs.len(), "0.01");
    let modes = analysis::modes(&system).expect("modes");
    let wanted = Options { built_in: true, internal: drives, ..options("0.01") };
    let discrete = discretise(&system, &modes, &wanted).expect("a system");
    let folder = tempfile::tempdir().expect("a folder");
    let program = Program { step: number("0.01"), samples: 1001 };
    let flags = ["-fsanitize=address,undefined", "-fno-sanitize-recover=all"];
    let checked = run_c(&folder, "checked", &discrete, &program, "gcc", &flags);
    same(&checked, &run_c(&folder, "checked", &discrete, &program, "gcc", &["-O2", "-march=native"]), "native");
}

/// A force acts on another mass at once not at all: its share in that one's acceleration is zero, as the masses are, whatever the sum over
/// the modes leaves of it. (An error of 1e-33 is infinite beside an output that is zero.)
#[test]
fn what_a_force_does_not_act_on_has_no_share_of_it() {
    for damper in ["", "damper d: ground -- b { c = 0.3 N*s/m }\n"] {
        let text = format!(
            "model two\nbody a {{ mass = 4 kg, moves x }}\nbody b {{ mass = 5 kg, moves x }}\nspring s: a -- b {{ k = 1.848 N/m }}\n\
             spring t: ground -- a {{ k = 9.23 N/m }}\n{damper}force F: a along x\noutput y = b.ax\noutput z = a.ax\n"
        );
        let system = emission("two", &text, &options("0.01")).system;
        assert!(system.direct[0].iter().all(|(_, share)| *share == 0.0), "{:?}", system.direct);
        assert!(system.direct[1].iter().any(|(_, share)| (share - 0.25).abs() < 1e-15), "{:?}", system.direct);
    }
}
