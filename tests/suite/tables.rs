//! Tables as signals, in whole runs of the program: the motion that a CSV file drives, and the report for a file that
//! is not a table. See docs/method/response.md#signals.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};
use tempfile::TempDir;

/// A folder with the model `m.vib` and the table `drive.csv`.
fn scene(signal: &str, table: &str) -> TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let model = format!(
        "body b {{ mass = 2 kg, moves x }}\nbase wall {{ moves x }}\nspring s: wall -- b {{ k = 8 N/m }}\n\
         damper d: wall -- b {{ c = 0.5 N*s/m }}\n{signal}\noutput x = b.x\noutput v = b.vx\n"
    );
    fs::write(folder.path().join("m.vib"), model).expect("a file");
    fs::write(folder.path().join("drive.csv"), table).expect("a file");
    folder
}

/// Runs the program in another directory than the model's.
fn simulate(folder: &Path, more: &[&str]) -> Output {
    let model = folder.join("m.vib");
    let mut command = Command::new(env!("CARGO_BIN_EXE_vibc"));
    command.args(["simulate", "--until", "3s", "--step", "0.5s"]).args(more).arg(&model);
    command.output().expect("the program starts")
}

fn rows(output: &Output) -> Vec<Vec<f64>> {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8_lossy(&output.stdout);
    text.lines().skip(1).map(|line| line.split(',').map(|x| x.parse().expect("a number")).collect()).collect()
}

#[test]
fn a_table_of_a_force_is_lines_between_its_rows() {
    let ramp = rows(&simulate(scene("force F: b along x = ramp(3 N, 0 s, 1.5 s)", "").path(), &[]));
    let heading = "time_s,F\n# measured\n0,0\n\n 0.3, 0.6\n1.5,3e0\n";
    let table = rows(&simulate(scene("force F: b along x = table(\"drive.csv\")", heading).path(), &[]));
    assert_eq!(ramp, table);
}

/// The natural spline through (0, 0), (1, 1), (2, 0) in closed form; it stays at 0 afterwards.
#[test]
fn a_table_of_a_base_is_a_natural_spline() {
    let points = "0,0\n1,1\n2,0\n";
    let table = scene("", points);
    let model = fs::read_to_string(table.path().join("m.vib")).expect("a file");
    let driven = model.replace("base wall { moves x }", "base wall { moves x } = table(\"drive.csv\")");
    assert_ne!(model, driven);
    fs::write(table.path().join("m.vib"), driven).expect("a file");
    let moved = rows(&simulate(table.path(), &[]));
    // The spline is u = 1.5 t - t^3 / 2 up to 1, then its mirror image, then 0. An independent computation applies the
    // forces k u + c u' in small Runge-Kutta steps.
    let rise = |t: f64| (1.5 * t - 0.5 * t.powi(3), 1.5 - 1.5 * t * t);
    let drive = |t: f64| match t {
        t if t < 1.0 => rise(t),
        t if t < 2.0 => (rise(2.0 - t).0, -rise(2.0 - t).1),
        _ => (0.0, 0.0),
    };
    let slope = |t: f64, [x, v]: [f64; 2]| {
        let (u, rate) = drive(t);
        [v, (8.0 * (u - x) + 0.5 * (rate - v)) / 2.0]
    };
    let (mut state, h) = ([0.0, 0.0], 1e-3);
    for step in 0..3000 {
        let t = f64::from(step) * h;
        let at = |k: [f64; 2], f: f64| [state[0] + f * k[0], state[1] + f * k[1]];
        let k1 = slope(t, state);
        let k2 = slope(t + 0.5 * h, at(k1, 0.5 * h));
        let k3 = slope(t + 0.5 * h, at(k2, 0.5 * h));
        // The end of a step belongs to the piece that ends there.
        let k4 = slope(t + h - 1e-12, at(k3, h));
        for i in 0..2 {
            state[i] += h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
        }
        if (step + 1) % 500 == 0 {
            let row = &moved[(step as usize + 1) / 500];
            assert!((row[1] - state[0]).abs() < 1e-9 && (row[2] - state[1]).abs() < 1e-9, "{t} {row:?} {state:?}");
        }
    }
}

#[test]
fn table_errors_are_reported_with_their_line() {
    let force = "force F: b along x = table(\"drive.csv\")";
    for (table, line, code) in [
        ("0,0\n1,x\n", 2, "vib::table::row"),
        ("t,F\n0,0\n\n1\n", 4, "vib::table::row"),
        ("0,0\n1,2,3\n", 2, "vib::table::row"),
        ("0,0\n,2\n", 2, "vib::table::row"),
        ("0,0\n2,1\n1,2\n", 3, "vib::table::order"),
        ("0,0\n0,1\n", 2, "vib::table::order"),
    ] {
        let refused = simulate(scene(force, table).path(), &["--message-format", "json"]);
        assert_eq!(refused.status.code(), Some(1), "{table}");
        let reported: serde_json::Value = serde_json::from_slice(&refused.stderr).expect("one object");
        assert_eq!(reported["line"], line, "{table}");
        assert_eq!(reported["code"], code, "{table}");
        assert!(reported["file"].as_str().expect("a name").ends_with("drive.csv"));
    }
    let empty = simulate(scene(force, "").path(), &["--message-format", "json"]);
    let reported: serde_json::Value = serde_json::from_slice(&empty.stderr).expect("one object");
    assert_eq!((empty.status.code(), &reported["code"]), (Some(1), &"vib::table::too_short".into()));
    let folder = scene(force, "");
    fs::remove_file(folder.path().join("drive.csv")).expect("it was there");
    let missing = simulate(folder.path(), &["--message-format", "json"]);
    let reported: serde_json::Value = serde_json::from_slice(&missing.stderr).expect("one object");
    assert_eq!((missing.status.code(), &reported["code"]), (Some(3), &"vib::table::unreadable".into()));
    assert_eq!(reported["line"], 5);
}
