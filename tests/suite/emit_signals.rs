//! Signals built into emitted code: steps of (nearly) a whole number of periods of a signal or a mode, chirps and
//! tables that change within a step, and their ends; and the rounding errors stated in the header. See
//! docs/method/emit.md.

use super::emit::{emission, options, silently, write};
use super::emit_exact::{check_as, observed, output, printed};
use super::systems::{Builder, number};
use std::fs;
use vibc::analysis::discrete::{Hold, Options, Precision};
use vibc::analysis::{Signal, respond};
use vibc::backend::emit::{self, Language, Program};
use vibc::base::{Number, Rational, SourceFile, SourceKind, Sources};
use vibc::system::{CoordinateId, Course, LinearSystem, Table};

/// Oscillators of 1 kg, uncoupled unless `joined`.
fn oscillators(list: &[(&str, &str)], joined: bool) -> LinearSystem {
    let mut b = Builder::numbered(list.len());
    for (i, (k, c)) in list.iter().enumerate() {
        b.mass(i, &Number::ONE);
        b.spring(None, i, &number(k));
        b.damper(None, i, &number(c));
    }
    if joined {
        // Makes the poles differ from those of the modes, so that the other method for the blocks is used.
        b.damper(Some(0), 1, &number("1e-9"));
    }
    let mut system = observed(&b.finish());
    system.initial = (0..list.len()).map(|i| (CoordinateId(i as u32), number("0.7"), number("-0.4"))).collect();
    system
}

fn harmonic(frequency: &str, phase: &str) -> Vec<Signal> {
    vec![Signal::Harmonic { value: Number::ONE, frequency: number(frequency), phase: number(phase), at: Number::ZERO }]
}

/// Steps of whole, half and nearly whole numbers of periods of the forces, with phases; 1e4 steps.
#[test]
fn steps_may_be_whole_periods_of_a_signal() {
    let cases = [
        ("1", ["50", "7", "0.5", "0.25", "50.000000001", "49.5", "49.999999999999", "0.3333"]),
        ("0.1", ["50", "7", "5", "10.000000000000001", "1000", "2.5", "15", "0.00001"]),
        ("3550", ["9.2", "0.0001408450704225352", "0.01", "1", "0.001", "2.0001", "0.1", "0.5"]),
    ];
    for (step, frequencies) in cases {
        let springs = ["100", "39.5", "3", "1000", "25", "0.5", "7", "90"];
        let list: Vec<(&str, &str)> = springs.iter().map(|&k| (k, "0.3")).collect();
        let mut system = oscillators(&list, false);
        for i in 0..frequencies.len() {
            // Accelerations depend directly on the signal.
            let mut acceleration = system.outputs[i].clone();
            acceleration.p.swap(0, 2);
            system.outputs.push(acceleration);
        }
        let phases = ["0.5235987755982988", "0", "1.2", "-2", "3.1", "0.7", "-0.3", "2.2"];
        let drives: Vec<Vec<Signal>> = frequencies.iter().zip(phases).map(|(f, phase)| harmonic(f, phase)).collect();
        let wanted = Options { built_in: true, internal: drives.clone(), ..options(step) };
        // Beyond 1e9 rad there is no reference to compare with.
        let samples = if step == "3550" { 1001 } else { 10_001 };
        check_as(samples, "periods", &system, &drives, step, &wanted, 2e-12);
    }
}

/// Steps of (nearly) whole and half numbers of periods of modes: undamped, hardly damped, damped; along with equal or
/// close real poles, and critical ones.
#[test]
fn steps_may_be_whole_periods_of_a_mode() {
    let cases = [
        // 2 pi s
        (
            "6.283185307179586",
            vec![
                ("1", "0"),
                ("1", "1e-7"),
                ("4", "1e-3"),
                ("0.25", "1e-9"),
                ("2.25", "1e-4"),
                ("1", "0.02"),
                ("1.0000001", "1e-7"),
            ],
        ),
        // 1 s; (2 pi)^2, (2 pi 50)^2, pi^2, (3 pi)^2
        (
            "1",
            vec![
                ("39.47841760435743", "1e-8"),
                ("98696.04401089358", "1e-6"),
                ("9.869604401089358", "1e-5"),
                ("88.82643960980423", "0.1"),
                ("39.47841760435743", "0"),
            ],
        ),
        // Equal rates, close rates, critical and slightly overcritical, long and short relative to the step.
        (
            "0.01",
            vec![
                ("100", "20"),
                ("100", "20.000001"),
                ("100", "19.99999"),
                ("0.0001", "0.02"),
                ("1e-10", "2e-5"),
                ("1e6", "2000"),
            ],
        ),
    ];
    for (step, list) in cases {
        for joined in [false, true] {
            let system = oscillators(&list, joined);
            check_as(10_001, "modes", &system, &[], step, &Options { built_in: true, ..options(step) }, 2e-12);
        }
    }
}

const RIG: &str = "body j { mass = 2.5 kg, moves y }\nspring s: ground -- j { k = 3.7 N/m, along = y }\n\
                   damper d: ground -- j { c = 2 N*s/m, along = y }\nbase f { moves y } = BASE\n\
                   spring t: f -- j { k = 40 N/m, along = y }\ndamper e: f -- j { c = 0.3 N*s/m, along = y }\n\
                   force w: j along y = FORCE\noutput y = j.y\noutput v = j.vy\noutput a = j.ay\n";

/// The worst error of each output in a program's rows, compared with the exact motion, relative to its largest value.
fn differences(text: &str, step: &str, samples: u64, precision: Precision) -> Vec<f64> {
    let wanted = Options { built_in: true, precision, ..options(step) };
    let emitted = emission("rig", text, &wanted).system;
    let rows = printed("rig", &emitted, &Program { step: number(step), samples }).rows;
    let picked: Vec<usize> = (0..rows.len()).filter(|k| k % 7 == 0 || k % 50 < 2).collect();
    let times: Vec<Number> = picked.iter().map(|&k| &number(step) * &Number::from(k as i64)).collect();
    let mut sources = Sources::new();
    let model = SourceFile::decode(SourceKind::Model, "rig", text.as_bytes().to_vec());
    let model = sources.add(model);
    let exact = vibc::simulate(&sources, model, &Default::default(), &times).answer.expect("a motion").history;
    (0..rows[0].len() - 1)
        .map(|output| {
            let largest = exact.values.iter().map(|row| row[output].to_f64().abs()).fold(0.0, f64::max);
            let worst = picked.iter().zip(&exact.values).map(|(&k, row)| {
                assert!(row[output].rad < 1e-11 * largest, "the reference is good to {:e}", row[output].rad);
                (rows[k][output + 1] - row[output].to_f64()).abs()
            });
            worst.fold(0.0, f64::max) / largest
        })
        .collect()
}

/// Chirps, lines and splines, with steps that are short, that miss the ends of the pieces, and that are longer than
/// many of them: during the signals, at their ends and long after.
#[test]
fn chirps_and_tables_are_exact_beyond_their_ends() {
    let forces = [
        ("chirp(1 N, 1 Hz, 5 Hz, 1 s)", "harmonic(1 cm, 1.3 Hz)"),
        (
            "half_sine(1 N, 0.1003 s, 0.4 s) + trapezoid(1 N, 0.5 s, 0.61 s, 0.7 s, 0.9 s)",
            "haversine(1 cm, 0.2 s, 0.7 s)",
        ),
        ("chirp(1 N, 5 Hz, 0.5 Hz, 2.0003 s) + ramp(2 N, 0.1 s, 0.7301 s)", "chirp(1 cm, 0 Hz, 3 Hz, 1.7 s)"),
    ];
    for (force, base) in forces {
        let text = RIG.replace("FORCE", force).replace("BASE", base);
        for (step, samples) in [("0.001", 4001), ("0.0037", 2001), ("0.05", 2001), ("0.5", 201), ("1.9", 101)] {
            for (output, error) in differences(&text, step, samples, Precision::Double).into_iter().enumerate() {
                assert!(error < 1e-12, "{force}, step {step}, output {output}: {error:e}");
            }
        }
        for (step, samples) in [("0.001", 4001), ("0.05", 2001), ("0.5", 201)] {
            for (output, error) in differences(&text, step, samples, Precision::Single).into_iter().enumerate() {
                assert!(error < 1e-4, "{force}, step {step}, output {output}: {error:e} in single precision");
            }
        }
    }
}

/// A base that is driven by its acceleration drifts away with what hangs on it: in double precision, which has digits for both.
#[test]
fn a_base_by_its_acceleration_is_exact() {
    let text =
        RIG.replace("FORCE", "sawtooth(1 N, 0.1003 s, 0.4 s)").replace("BASE", "half_sine(2 m/s^2, 0.1 s, 0.3 s)");
    for (step, samples) in [("0.0037", 2001), ("0.5", 201)] {
        for (output, error) in differences(&text, step, samples, Precision::Double).into_iter().enumerate() {
            assert!(error < 1e-12, "step {step}, output {output}: {error:e}");
        }
    }
}

/// Tables as forces and a spline as a base, by the interface of signals: rows far closer than a step, and far apart.
#[test]
fn tables_are_exact_whatever_the_step() {
    let list = [("90", "0.7"), ("400", "0.1")];
    let system = oscillators(&list, false);
    let row = |i: i64| (&Number::from(i * i % 17 - 8) / &Number::from(5), &Number::from(i) / &number("33.7"));
    let (values, times): (Vec<Number>, Vec<Number>) = (0..70).map(row).unzip();
    let table =
        |course| vec![Signal::Table(Table { times: times.clone(), values: values.clone(), course, period: None })];
    let late = |signal| vec![Signal::Delayed { of: Box::new(signal), by: number("0.31") }];
    let wave = vec![Signal::Harmonic {
        value: number("1"),
        frequency: number("1.3"),
        phase: number("0.7"),
        at: number("0.4003"),
    }];
    let delayed = late(table(Course::Lines).remove(0));
    for drives in [[table(Course::Lines), table(Course::Spline)], [delayed, wave]] {
        let drives = drives.to_vec();
        for step in ["0.001", "0.0297", "0.4", "3"] {
            let wanted = Options { built_in: true, internal: drives.clone(), ..options(step) };
            check_as(3001, "tables", &system, &drives, step, &wanted, 1e-12);
        }
    }
}

/// A state that is read before a sample includes the events since the last one, and a state that is set there is not
/// changed by them.
#[test]
fn a_state_is_read_and_set_after_events_between_samples() {
    let text = "body a { mass = 2 kg, moves x }\nspring s: ground -- a { k = 90 N/m }\n\
                force F: a along x = pulse(3 N, 0.0237 s, 0.5 s) + impulse(1 N*s, 0.0151 s)\noutput x = a.x\n";
    let emitted = emission("mid", text, &Options { built_in: true, ..options("0.01") }).system;
    let folder = tempfile::tempdir().expect("a folder");
    write(&folder, &emit::files("mid", &emitted, Language::C, None));
    let main = "#include \"mid.h\"\n#include <stdio.h>\nint main(void) { mid_state s; mid_outputs y; mid_motion m; int k; mid_init(&s);\n\
                for (k = 0; k < 6; k++) { mid_get_state(&s, &m); printf(\"%.17g %.17g\\n\", m.displacement[0], m.velocity[0]);\n\
                mid_set_state(&s, &m); mid_step(&s, &y); printf(\"%.17g\\n\", y.x); } return 0; }\n";
    fs::write(folder.path().join("main.c"), main).expect("a file");
    silently(&folder, "gcc", &["-std=c99", "-O1", "-o", "mid_program", "main.c", "mid.c", "-lm"]);
    let found: Vec<f64> =
        output(&folder, "mid_program").split_whitespace().map(|x| x.parse().expect("a number")).collect();
    // x = 3 (1 - cos w (t - b)) / 90 from b on, and sin w (t - a) / (2 w) after the impulse at a, w^2 = 45.
    let w = 45f64.sqrt();
    for (k, found) in found.chunks(3).enumerate() {
        let t = 0.01 * k as f64;
        let (since, impulse) = ((t - 0.0237).max(0.0), (t - 0.0151).max(0.0));
        let struck = if impulse > 0.0 { (w * impulse).cos() / 2.0 } else { 0.0 };
        let x = (1.0 - (w * since).cos()) / 30.0 + (w * impulse).sin() / (2.0 * w);
        let v = w * (w * since).sin() / 30.0 + struck;
        for (value, exact) in found.iter().zip([x, v, x]) {
            assert!((value - exact).abs() < 1e-15, "{k}: {value:e} {exact:e}");
        }
    }
}

/// Modal damping against its closed form: two equal masses, whose modes are their sum and their difference, under a
/// constant force.
#[test]
fn modal_damping_is_that_of_each_mode() {
    let text = "body a { mass = 1 kg, moves x }\nbody b { mass = 1 kg, moves x }\nspring s: ground -- a { k = 50 N/m }\n\
                spring t: a -- b { k = 30 N/m }\nspring u: ground -- b { k = 50 N/m }\ndamping modal 3 %\n\
                force F: a along x = step(2 N, 0 s)\noutput xa = a.x\noutput xb = b.x\noutput vb = b.vx\n";
    let emitted = emission("modal", text, &Options { built_in: true, ..options("0.01") }).system;
    let rows = printed("modal", &emitted, &Program { step: number("0.01"), samples: 3001 }).rows;
    let mode = |k: f64, t: f64| {
        let (w, zeta) = (k.sqrt(), 0.03f64);
        let d = w * (1.0 - zeta * zeta).sqrt();
        let gone = (-zeta * w * t).exp();
        let x = (1.0 - gone * ((d * t).cos() + zeta * w / d * (d * t).sin())) / k;
        (x, gone * (d * t).sin() / d)
    };
    for row in rows.iter().step_by(37) {
        let ((sum, sum_rate), (difference, difference_rate)) = (mode(50.0, row[0]), mode(110.0, row[0]));
        let exact = [sum + difference, sum - difference, sum_rate - difference_rate];
        for (value, exact) in row[1..].iter().zip(exact) {
            assert!((value - exact).abs() < 1e-14, "t = {}: {value:e} {exact:e}", row[0]);
        }
    }
}

/// Interpolated inputs: irregular samples of a force and of a base with a damper give the same motion as `simulate`
/// with a table of these samples; held inputs give that of steps.
#[test]
fn inputs_between_samples_are_lines_or_steps() {
    let text = RIG.replace(" = BASE", "").replace(" = FORCE", "");
    let count = 40;
    let sample = |i: usize, salt: u64| ((i as u64 + salt) * 2_654_435_761 % 1000) as f64 / 500.0 - 1.0;
    let exact = |x: f64| Number::Exact(Rational::from_f64(x).expect("finite"));
    for hold in [Hold::First, Hold::Zero] {
        let first = hold == Hold::First;
        let system = emission("line", &text, &Options { hold, ..options("0.125") }).system;
        let folder = tempfile::tempdir().expect("a folder");
        write(&folder, &emit::files("line", &system, Language::C, None));
        let list = |salt| (0..count).map(|i| format!("{:?}", sample(i, salt))).collect::<Vec<_>>().join(", ");
        let main = format!(
            "#include \"line.h\"\n#include <stdio.h>\nstatic const double f[] = {{{}}};\nstatic const double b[] = {{{}}};\n\
             int main(void) {{ line_state s; line_inputs u; line_outputs y; int k; line_init(&s); for (k = 0; k < {count}; k++) {{\n\
             u.f = b[k]; u.w = f[k]; line_step(&s, &u, &y); printf(\"%.17g %.17g\\n\", y.y, y.v); }} return 0; }}\n",
            list(1),
            list(7)
        );
        fs::write(folder.path().join("main.c"), main).expect("a file");
        silently(&folder, "gcc", &["-std=c99", "-O1", "-o", "line_program", "main.c", "line.c", "-lm"]);
        let found: Vec<f64> =
            output(&folder, "line_program").split_whitespace().map(|x| x.parse().expect("a number")).collect();
        let mut sources = Sources::new();
        let file = SourceFile::decode(SourceKind::Model, "line", text.clone().into_bytes());
        let model = sources.add(file);
        let linear = vibc::linear(&sources, model, &Default::default()).answer.expect("a system").1;
        let time = |i: usize| &Number::from(i as i64) / &Number::from(8);
        let drive = |salt: u64| -> Vec<Signal> {
            if first {
                let values = (0..count).map(|i| exact(sample(i, salt))).collect();
                return vec![Signal::Table(Table {
                    times: (0..count).map(time).collect(),
                    values,
                    course: Course::Lines,
                    period: None,
                })];
            }
            let before = |i: usize| if i == 0 { 0.0 } else { sample(i - 1, salt) };
            (0..count)
                .map(|i| Signal::Step { value: &exact(sample(i, salt)) - &exact(before(i)), at: time(i) })
                .collect()
        };
        let names: Vec<String> = linear.inputs.iter().map(|input| linear.display(input.name)).collect();
        let drives: Vec<Vec<Signal>> = names.iter().map(|name| drive(if name == "w" { 1 } else { 7 })).collect();
        let picked: Vec<usize> = (0..count - 1).step_by(3).collect();
        let times: Vec<Number> = picked.iter().map(|&k| time(k)).collect();
        let history = respond(&linear, &drives, &times).expect("a motion");
        for (&k, row) in picked.iter().zip(&history.values) {
            // If the base has no jump, a velocity that its damper drives has none either.
            for output in 0..if first { 2 } else { 1 } {
                let (value, exact) = (found[2 * k + output], row[output].to_f64());
                assert!((value - exact).abs() < 1e-13, "{hold:?}, sample {k}, output {output}: {value:e} {exact:e}");
            }
        }
    }
}
