//! Cases along which lengths move terms and the rest, side by side: beside closed forms, and along the steps between them. See
//! docs/method/studies.md#pieces.

use std::f64::consts::PI;
use std::fs;
use std::process::{Command, Output};

fn ran(model: &str, arguments: &[&str]) -> Output {
    let folder = tempfile::tempdir().expect("a temporary folder");
    fs::write(folder.path().join("m.vib"), model).expect("a file");
    let mut command = Command::new(env!("CARGO_BIN_EXE_vibc"));
    command.args(["sweep", "m.vib"]).args(arguments).current_dir(folder.path()).output().expect("the program starts")
}

/// Values, frequencies and their bounds, case by case. The numbers of these models have no quotes.
fn rows(model: &str, arguments: &[&str]) -> Vec<Vec<f64>> {
    let output = ran(model, &[arguments, &["--format", "csv"]].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).expect("UTF-8");
    let mut lines = text.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let heading = lines.next().expect("a heading");
    let wanted: Vec<usize> = (0..heading.len()).filter(|&i| heading[i].starts_with("frequency") || i == 1).collect();
    lines.map(|row| wanted.iter().map(|&i| row[i].parse().unwrap_or(f64::NAN)).collect()).collect()
}

/// The frequencies of a row are the true ones, in Hz, up to the rounding of these; returns the widest relative bound.
fn meets(row: &[f64], truth: &[f64]) -> f64 {
    let found = row[1..].chunks(2);
    assert_eq!(found.len(), truth.len(), "{row:?}");
    let bound = |(own, truth): (&[f64], &f64)| {
        assert!((own[0] - truth).abs() <= own[1] + 1e-13 * truth, "{row:?}, not {truth}");
        own[1] / own[0]
    };
    found.zip(truth).map(bound).fold(0.0, f64::max)
}

/// Half of the cases and more have bounds of binary64, those of the cases side by side; one by one they have thirty digits.
fn are_side_by_side(bounds: &[f64]) {
    let side_by_side = bounds.iter().filter(|bound| **bound > 1e-18).count();
    assert!(2 * side_by_side > bounds.len(), "{side_by_side} of {}", bounds.len());
    assert!(bounds.iter().all(|bound| *bound <= 1e-10), "{bounds:?}");
}

/// A block that hangs from two springs at anchors 2 w apart. It sinks by y, where 2 k (s - s0) y / s = m g with s^2 = w^2 + y^2; a spring of
/// the tension t = k (s - s0) has k y^2/s^2 + (t/s) w^2/s^2 along y, the reverse along x.
#[test]
fn a_block_between_two_slanted_springs() {
    let model = "model slanted\nparam w = 1 m\ngravity 9.81 m/s^2\nbody b { mass = 3 kg, at = (0, 0), moves x y }\n\
                 spring l: ground@(-w, 0) -- b { k = 200 N/m, free_length = 0.4 m }\n\
                 spring r: ground@(w, 0) -- b { k = 200 N/m, free_length = 0.4 m }\n";
    let mut bounds = Vec::new();
    for row in rows(model, &["--over", "w=0.5m..0.9m:600", "--modes=2"]) {
        let (w, k, s0) = (row[0], 200.0, 0.4);
        let force = |y: f64| 2.0 * k * (w.hypot(y) - s0) * y / w.hypot(y) - 3.0 * 9.81;
        let (mut low, mut high) = (0.0, 2.0);
        for _ in 0..200 {
            let y = 0.5 * (low + high);
            if force(y) < 0.0 { low = y } else { high = y }
        }
        let s = w.hypot(low);
        let (along, across) = (k, k * (s - s0) / s);
        let stiffness = |c: f64| 2.0 * (along * c * c + across * (1.0 - c * c));
        let mut truth = [stiffness(w / s), stiffness(low / s)].map(|k| (k / 3.0).sqrt() / (2.0 * PI));
        truth.sort_by(f64::total_cmp);
        bounds.push(meets(&row, &truth));
    }
    are_side_by_side(&bounds);
}

/// A block between two long springs rests above the line of their anchors or below it. Where it is drawn decides which: of the values
/// that draw it below, through the line, to above, each has its own rest, though there is one above for all. It is drawn beside the middle,
/// so that cases are side by side where their rest is one.
#[test]
fn each_case_has_the_rest_that_is_found_from_its_drawing() {
    let model = "model arch\nparam h = 0.3 m\ngravity 9.81 m/s^2\nbody b { mass = 3 kg, at = (0.1 m, h), moves x y }\n\
                 spring l: ground@(-1 m, 0) -- b { k = 400 N/m, free_length = 1.3 m }\n\
                 spring r: ground@(1 m, 0) -- b { k = 400 N/m, free_length = 1.3 m }\n";
    let (k, s0, weight) = (400.0, 1.3, 3.0 * 9.81);
    let frequencies = |[mut low, mut high]: [f64; 2]| {
        let force = |y: f64| 2.0 * k * (1f64.hypot(y) - s0) * y / 1f64.hypot(y) + weight;
        for _ in 0..200 {
            let y = 0.5 * (low + high);
            if force(y) < 0.0 { low = y } else { high = y }
        }
        let (y, s) = (low, 1f64.hypot(low));
        let stiffness = |c: f64| 2.0 * (k * c * c + k * (s - s0) / s * (1.0 - c * c));
        let mut list = [stiffness(1.0 / s), stiffness(y / s)].map(|k| (k / 3.0).sqrt() / (2.0 * PI));
        list.sort_by(f64::total_cmp);
        list
    };
    let [below, above] = [[-1.5, -0.83], [0.6, 1.5]].map(frequencies);
    let rows_of = |arguments: &[&str]| rows(model, arguments);
    let rows = rows_of(&["--over", "h=-0.7m..0.9m:400", "--modes=2"]);
    assert!(below.iter().zip(&above).any(|(a, b)| (a - b).abs() > 0.1), "{below:?} {above:?}");
    let sure = rows.iter().filter(|row| row[0].abs() > 0.4);
    are_side_by_side(&sure.map(|row| meets(row, if row[0] < 0.0 { &below } else { &above })).collect::<Vec<_>>());
    // Just above the line the weight wins: the first cases have the rest below, where each of them alone has it.
    let ends = rows_of(&["--over", "h=0.05m,0.4m", "--modes=2"]);
    let along = rows_of(&["--over", "h=0.05m..0.4m:200", "--modes=2"]);
    for (ends, truth) in [([&ends[0], &along[0]], &below), ([&ends[1], &along[199]], &above)] {
        for row in ends {
            meets(row, truth);
        }
    }
}

/// The double pendulum, drawn far from its rest: omega^2 = (2 -+ sqrt 2) g/l, over a length that becomes ten times as large.
#[test]
fn a_double_pendulum_of_any_length() {
    let model =
        fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/double_pendulum.vib")).expect("there");
    let rows = rows(&model, &["--over", "l=0.5m..5m:500", "--modes=2"]);
    let truth = |l: f64| [2.0 - 2f64.sqrt(), 2.0 + 2f64.sqrt()].map(|x| (x * 9.81 / l).sqrt() / (2.0 * PI));
    are_side_by_side(&rows.iter().map(|row| meets(row, &truth(row[0]))).collect::<Vec<_>>());
}

/// A rod on a torsion spring at its foot: it falls over beyond a length, so that cases before that have a frequency and no others.
#[test]
fn cases_at_the_end_of_stability_are_left_to_themselves() {
    let model = "model rod\nparam L = 1 m\ngravity 9.81 m/s^2\npoint O = (0, 0)\n\
                 body rod { mass = 2 kg, shape = rod(O, (0, L)) }\npivot p: ground@O -- rod\n\
                 spring t: ground -- rod { k = 10 N*m/rad }\n";
    let rows = rows(model, &["--over", "L=0.4m..1.6m:301", "--modes=1"]);
    let critical = 10.0 / 9.81;
    let mut bounds = Vec::new();
    for row in &rows {
        let square = (10.0 - 9.81 * row[0]) / (2.0 * row[0] * row[0] / 3.0);
        match row[0] < critical {
            true => bounds.push(meets(row, &[square.sqrt() / (2.0 * PI)])),
            false => assert!(row[1].is_nan(), "{row:?}"),
        }
    }
    let side_by_side = bounds.iter().filter(|bound| **bound > 1e-18).count();
    assert!(3 * side_by_side > 2 * bounds.len(), "{side_by_side} of {}", bounds.len());
}
