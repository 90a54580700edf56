//! The program as a process: commands, streams, files, exit status. See docs/cli.md#streams-and-exit-status.

use serde_json::Value;
use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};
use tempfile::TempDir;

const CART: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/cart.vib");

/// The results of a run of the program.
struct Run {
    status: i32,
    out: String,
    err: String,
}

fn vibc(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_vibc"));
    command.args(arguments).stdin(Stdio::null()).env_remove("NO_COLOR").env_remove("CLICOLOR_FORCE");
    command
}

fn run(arguments: &[&str]) -> Run {
    finished(vibc(arguments).output().expect("the program starts"))
}

fn run_with_input(arguments: &[&str], input: &[u8]) -> Run {
    let mut command = vibc(arguments);
    let mut child =
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("it starts");
    // A program that rejects its command line reads nothing.
    let _ = child.stdin.take().expect("a pipe").write_all(input);
    finished(child.wait_with_output().expect("it ends"))
}

fn finished(output: std::process::Output) -> Run {
    Run {
        status: output.status.code().expect("no signal"),
        out: String::from_utf8(output.stdout).expect("UTF-8"),
        err: String::from_utf8(output.stderr).expect("UTF-8"),
    }
}

/// A model in a file of its own.
fn file(folder: &TempDir, name: &str, text: impl AsRef<[u8]>) -> String {
    let path = folder.path().join(name);
    fs::write(&path, text).expect("a temporary file");
    path.to_string_lossy().into_owned()
}

fn folder() -> TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

fn objects(lines: &str) -> Vec<Value> {
    lines.lines().map(|line| serde_json::from_str(line).expect("a line is an object")).collect()
}

const OSCILLATOR: &str = "param k = 9 N/m\nbody b { mass = 1 kg, moves x }\nspring s: ground -- b { k = k }\n";
/// A body without support.
const FALLS: &str = "gravity 9.81 m/s^2\nbody b { mass = 1 kg, moves y }\n";
const WRONG: &str = "param k = 9 kg\nbody b { mass = 1 kg, moves x }\nspring s: ground -- b { k = k }\n";
/// A model with a single warning.
const UNUSED: &str =
    "param k = 9 N/m\nparam spare = 1 m\nbody b { mass = 1 kg, moves x }\nspring s: ground -- b { k = k }\n";

fn omega(run: &Run) -> f64 {
    let report: Value = serde_json::from_str(&run.out).expect("an object");
    report["modes"][0]["omega"].as_f64().expect("a number")
}

#[test]
fn the_exit_status_says_what_happened() {
    let folder = folder();
    assert_eq!(run(&["analyze", CART]).status, 0);
    assert_eq!(run(&["check", CART]).status, 0);
    assert_eq!(run(&["analyze", &file(&folder, "wrong.vib", WRONG)]).status, 1);
    assert_eq!(run(&["check", &file(&folder, "wrong.vib", WRONG)]).status, 1);
    assert_eq!(run(&["analyze", &file(&folder, "falls.vib", FALLS)]).status, 4);
    assert_eq!(run(&["analyze", &file(&folder, "unused.vib", UNUSED)]).status, 0);
    for usage in [
        &[][..],
        &["analyze"],
        &["check"],
        &["analyse", CART],
        &["analyze", CART, "--format", "csv"],
        &["analyze", CART, "--set", "k"],
    ] {
        assert_eq!(run(usage).status, 2, "{usage:?}");
    }
    assert_eq!(run(&["analyze", "no such file.vib"]).status, 3);
    assert_eq!(run(&["analyze", folder.path().to_str().expect("a path")]).status, 3);
    assert_eq!(run(&["analyze", CART, "-o", "no such folder/report.txt"]).status, 3);
}

#[test]
fn of_several_files_the_largest_status_counts() {
    let folder = folder();
    let (wrong, falls) = (file(&folder, "wrong.vib", WRONG), file(&folder, "falls.vib", FALLS));
    assert_eq!(run(&["check", CART, &wrong, CART]).status, 1);
    assert_eq!(run(&["check", &wrong, "missing.vib"]).status, 3);
    let all = run(&["check", &wrong, "missing.vib", &falls, "--message-format", "short"]);
    assert_eq!(all.status, 4);
    for reported in ["wrong.vib:3:", "missing.vib:1:1: error[io]", "falls.vib:2:6: error[vib::rest::not_found]"] {
        assert!(all.err.contains(reported), "{reported} is not in {}", all.err);
    }
}

#[test]
fn results_go_to_one_stream_and_diagnostics_to_the_other() {
    let folder = folder();
    let unused = run(&["analyze", &file(&folder, "unused.vib", UNUSED)]);
    assert!(unused.out.starts_with("unused · 1 degree of freedom"), "{}", unused.out);
    assert!(unused.err.contains("spare") && !unused.out.contains("spare"));
    let wrong = run(&["analyze", &file(&folder, "wrong.vib", WRONG)]);
    assert!(wrong.out.is_empty() && wrong.err.contains("vib::unit::mismatch"));
    assert_eq!(run(&["check", CART]).out, "");
}

#[test]
fn quiet_leaves_errors_only() {
    let folder = folder();
    let unused = run(&["analyze", "-q", &file(&folder, "unused.vib", UNUSED)]);
    assert_eq!((unused.status, unused.err.as_str()), (0, ""));
    assert!(run(&["check", "-q", &file(&folder, "wrong.vib", WRONG)]).err.contains("vib::unit::mismatch"));
}

#[test]
fn the_json_report_has_its_fields_in_their_order() {
    let report = run(&["analyze", CART, "--format", "json"]).out;
    let fields = [
        "\"vibc\":",
        "\"model\":\"cart\"",
        "\"coordinates\":[\"block.x\",\"rod.angle\"]",
        "\"rest\":{\"stable\":true,\"kind\":\"stable\"",
        "\"displacement\":{\"block.x\":0.0,\"rod.angle\":0.0}",
        "\"residual\":0.0",
        "\"matrices\":{\"m\":[[1.5,0.5],[0.5,0.6666666666666666]]",
        "\"c\":[[5.0,0.0],[0.0,0.0]]",
        "\"k\":[[10.0,0.0],[0.0,4.905]]",
        "\"modes\":[{\"mode\":1,\"kind\":\"oscillation\",\"omega\":2.158",
        "\"frequency_hz\":0.343",
        "\"omega_error_bound\":",
        "\"shape\":{\"block.x\":1.0,\"rod.angle\":1.29393",
        "\"poles\":[{\"re\":-0.3099",
        "\"im\":",
        "\"omega\":",
        "\"frequency_hz\":",
        "\"damping_ratio\":0.11",
        "\"damped_frequency_hz\":0.41",
        "\"kind\":\"oscillation\"",
        "\"error_bound\":",
        "\"solved\":[]",
        "\"requirements\":[]",
    ];
    let mut from = 0;
    for field in fields {
        let at = report[from..].find(field).unwrap_or_else(|| panic!("{field} is not behind byte {from} of {report}"));
        from += at + field.len();
    }
    let value: Value = serde_json::from_str(&report).expect("one object");
    assert_eq!(value["poles"].as_array().map(Vec::len), Some(4));
    assert!(report.ends_with("}\n"));
}

#[test]
fn large_matrices_come_on_demand() {
    let folder = folder();
    // Independent parts, so that the analysis itself takes no time.
    let row =
        "repeat i in 1..201 {\n  body m[i] { mass = 1 kg, moves x }\n  spring k[i]: ground -- m[i] { k = 3 N/m }\n}\n";
    let row = file(&folder, "row.vib", row);
    let without: Value = serde_json::from_str(&run(&["analyze", &row, "--format", "json"]).out).expect("an object");
    assert!(without["matrices"].is_null());
    let with: Value =
        serde_json::from_str(&run(&["analyze", &row, "--format", "json", "--matrices"]).out).expect("an object");
    assert_eq!(with["matrices"]["k"][200][200], 3.0);
}

#[test]
fn standard_input_is_a_model() {
    let piped = run_with_input(&["analyze", "-"], OSCILLATOR.as_bytes());
    assert_eq!(piped.status, 0, "{}", piped.err);
    assert!(piped.out.contains("3.000000"));
    let wrong = run_with_input(&["check", "--message-format", "short", "-"], WRONG.as_bytes());
    assert!(wrong.err.starts_with("<stdin>:3:29: error[vib::unit::mismatch]"), "{}", wrong.err);
}

#[test]
fn parameters_are_set_from_the_command_line_and_from_a_file() {
    let folder = folder();
    let model = file(&folder, "oscillator.vib", OSCILLATOR);
    let settings = file(&folder, "settings.toml", "k = \"16 N/m\"\n");
    let json = ["analyze", &model, "--format", "json"];
    assert_eq!(omega(&run(&json)), 3.0);
    assert_eq!(omega(&run(&[&json[..], &["--set", "k=25N/m"]].concat())), 5.0);
    assert_eq!(omega(&run(&[&json[..], &["--settings", &settings]].concat())), 4.0);
    // The command line has precedence.
    assert_eq!(omega(&run(&[&json[..], &["--settings", &settings, "--set", "k=25N/m"]].concat())), 5.0);
    assert_eq!(run(&[&json[..], &["--settings", "missing.toml"]].concat()).status, 3);
    let wrong = run(&[&json[..], &["--set", "k=25kg", "--message-format", "short"]].concat());
    assert_eq!(wrong.status, 1);
    assert!(wrong.err.starts_with("--set:1:"), "{}", wrong.err);
}

#[test]
fn an_output_file_is_replaced_whole_or_left_as_it_was() {
    let folder = folder();
    let (model, wrong) = (file(&folder, "oscillator.vib", OSCILLATOR), file(&folder, "wrong.vib", WRONG));
    let report = file(&folder, "report.txt", "old");
    assert_eq!(run(&["analyze", &wrong, "-o", &report]).status, 1);
    assert_eq!(fs::read_to_string(&report).unwrap(), "old");
    let written = run(&["analyze", &model, "-o", &report]);
    assert_eq!((written.status, written.out.as_str()), (0, ""));
    assert_eq!(fs::read_to_string(&report).unwrap(), run(&["analyze", &model]).out);
    assert_eq!(run(&["analyze", &model, "-o", "-"]).out, run(&["analyze", &model]).out);
    let names = fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name());
    assert_eq!(names.count(), 3, "nothing temporary is left");
}

#[test]
fn a_model_is_never_overwritten_by_its_report() {
    let folder = folder();
    let model = file(&folder, "oscillator.vib", OSCILLATOR);
    let refused = run(&["analyze", &model, "-o", &model]);
    assert_eq!(refused.status, 2);
    assert_eq!(fs::read_to_string(&model).unwrap(), OSCILLATOR);
}

#[test]
fn a_table_is_never_overwritten_by_its_output() {
    let folder = folder();
    let table = file(&folder, "road.csv", "0,0\n1,2\n");
    let driven = format!("{OSCILLATOR}\nforce R: b along x = table(\"road.csv\")\noutput there = b.x\n");
    let model = file(&folder, "driven.vib", driven);
    let done = run(&["simulate", &model, "--until", "1s", "--step", "1s"]);
    assert_eq!(done.status, 0, "{}", done.err);
    let refused = run(&["simulate", &model, "--until", "1s", "--step", "1s", "-o", &table]);
    assert_eq!(refused.status, 2, "{}", refused.err);
    assert_eq!(fs::read_to_string(&table).unwrap(), "0,0\n1,2\n");
}

#[cfg(unix)]
#[test]
fn links_devices_and_permissions_survive() {
    use std::os::unix::fs::{FileTypeExt, PermissionsExt, symlink};
    let folder = folder();
    let model = file(&folder, "oscillator.vib", OSCILLATOR);
    let target = file(&folder, "target.txt", "old");
    fs::set_permissions(&target, fs::Permissions::from_mode(0o640)).unwrap();
    let link = folder.path().join("link.txt");
    symlink(&target, &link).unwrap();
    assert_eq!(run(&["analyze", &model, "-o", link.to_str().unwrap()]).status, 0);
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    assert!(fs::read_to_string(&target).unwrap().starts_with("oscillator"));
    assert_eq!(fs::metadata(&target).unwrap().permissions().mode() & 0o777, 0o640);
    assert_eq!(run(&["analyze", &model, "-o", "/dev/null"]).status, 0);
    assert!(fs::metadata("/dev/null").unwrap().file_type().is_char_device());
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_reported_and_a_closed_pipe_is_not() {
    let full = fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    let reported = finished(vibc(&["analyze", CART]).stdout(full).output().unwrap());
    assert_eq!(reported.status, 3);
    assert!(reported.err.contains("standard output"));
    let (reader, writer) = std::io::pipe().unwrap();
    drop(reader);
    let closed = finished(vibc(&["analyze", CART]).stdout(writer).output().unwrap());
    assert_eq!((closed.status, closed.err.as_str()), (0, ""));
}

#[test]
fn diagnostics_for_programs_have_their_fields() {
    let folder = folder();
    let model = "param ω = 9 kg\nbody b { mass = 1 kg, moves x }\n/* ω */ spring s: ground -- b { k = ω }\n"
        .replace("/* ω */ ", "");
    let model = file(&folder, "greek.vib", model);
    let lines = run(&["check", &model, "--message-format", "json"]).err;
    let found = objects(&lines);
    assert_eq!(found.len(), 1, "{lines}");
    let expected = [
        ("code", Value::from("vib::unit::mismatch")),
        ("severity", Value::from("error")),
        ("file", Value::from(model.clone())),
        ("line", Value::from(3)),
        ("column", Value::from(29)),
        ("end_line", Value::from(3)),
        ("end_column", Value::from(30)),
    ];
    for (field, value) in expected {
        assert_eq!(found[0][field], value, "{field} in {lines}");
    }
    assert!(found[0]["message"].is_string() && found[0]["help"].is_string());
    for related in found[0]["related"].as_array().expect("a list") {
        assert!(related["message"].is_string() && related["line"].is_u64() && related["end_column"].is_u64());
    }
    let io = objects(&run(&["check", "missing.vib", "--message-format", "json"]).err);
    assert_eq!((&io[0]["code"], &io[0]["line"]), (&Value::from("io"), &Value::from(1)));
}

#[test]
fn colour_is_for_terminals_and_for_those_who_ask() {
    let folder = folder();
    let wrong = file(&folder, "wrong.vib", WRONG);
    let coloured = |arguments: &[&str]| run(&[&["check", &wrong], arguments].concat()).err.contains('\u{1b}');
    assert!(!coloured(&[]));
    assert!(coloured(&["--color", "always"]));
    assert!(!coloured(&["--color", "never"]));
}

#[test]
fn a_file_of_another_program_is_refused_at_the_byte() {
    let folder = folder();
    let binary = file(&folder, "backup.vib", b"model x\n// caf\xe9\nbody b { moves x }\n");
    let refused = run(&["check", &binary, "--message-format", "short"]);
    assert_eq!(refused.status, 1);
    assert_eq!(refused.err, format!("{binary}:2:7: error[vib::file::not_utf8]: this file is not UTF-8 text\n"));
}

#[test]
fn every_finding_is_in_the_forms_for_programs() {
    let folder = folder();
    let wrong: String = (0..60).map(|i| format!("param a{i} = 1 kg + 1 m\n")).collect();
    let wrong = file(&folder, "wrong.vib", wrong);
    let count = |form| run(&["check", "-q", &wrong, "--message-format", form]).err.lines().count();
    assert_eq!((count("short"), count("json")), (60, 60));
    let drawn = run(&["check", "-q", &wrong]).err;
    assert_eq!(drawn.matches('×').count(), 20);
    assert!(
        drawn.trim_end().ends_with("and 40 more: 60 errors in all (`--message-format short` lists every one)"),
        "{drawn}"
    );
}

#[test]
fn a_code_is_explained_and_an_unknown_one_gets_the_nearest() {
    let reported = run(&["explain", "vib::unit::mismatch"]);
    assert_eq!(reported.status, 0);
    assert!(reported.out.starts_with("vib::unit::mismatch\n\n") && reported.out.contains("Fix:"));
    assert_eq!(run(&["explain", "unit::mismatch"]).out, reported.out);
    let unknown = run(&["explain", "vib::unit::mismach"]);
    assert_eq!((unknown.status, unknown.out.as_str()), (2, ""));
    assert!(unknown.err.contains("`vib::unit::mismatch`"));
}

/// Every method for each answer, in three formats; only the times differ from run to run.
#[test]
fn bench_prints_speed_against_error() {
    let folder = folder();
    let model = file(&folder, "o.vib", OSCILLATOR);
    let picture = folder.path().join("o.svg").to_string_lossy().into_owned();
    let text = run(&["bench", &model, "--svg", &picture]);
    assert_eq!(text.status, 0, "{}", text.err);
    for reported in ["natural frequencies", "poles", "transfer", "motion", "Runge-Kutta 4", "Newmark", "→", "growth"]
    {
        assert!(text.out.contains(reported), "{reported}: {}", text.out);
    }
    let drawn = fs::read_to_string(&picture).expect("a picture");
    assert!(drawn.starts_with("<svg") && drawn.ends_with("</svg>\n"));
    assert_eq!(drawn.matches("taken by itself").count(), 4);
    let without_times = |run: &Run| -> Vec<String> {
        let line = |line: &str| {
            let fields: Vec<&str> = line.split(',').collect();
            [fields[..2].join(","), fields[4].into(), fields[5].into()].join(",")
        };
        run.out.lines().filter(|line| !line.contains('"')).map(line).collect()
    };
    let csv = run(&["bench", &model, "--format", "csv"]);
    assert!(csv.out.starts_with("question,method,ordinary,time_s,error,bound,pareto,chosen,note\n"));
    assert_eq!(without_times(&csv), without_times(&run(&["bench", &model, "--format", "csv"])));
    assert_eq!(run(&["bench", &file(&folder, "wrong.vib", WRONG)]).status, 1);
}

#[test]
fn the_same_model_gives_the_same_bytes() {
    let once = run(&["analyze", CART, "--format", "json"]).out;
    assert_eq!(once, run(&["analyze", CART, "--format", "json"]).out);
    let from_elsewhere =
        vibc(&["analyze", "cart.vib", "--format", "json"]).current_dir(Path::new(CART).parent().unwrap()).output();
    assert_eq!(once.as_bytes(), from_elsewhere.unwrap().stdout);
}

#[test]
fn shapes_are_scaled_as_asked() {
    let shape = |normalise| {
        let report = run(&["analyze", CART, "--format", "json", "--normalise", normalise]).out;
        let report: Value = serde_json::from_str(&report).expect("an object");
        let shape = &report["modes"][0]["shape"];
        (shape["block.x"].as_f64().expect("a number"), shape["rod.angle"].as_f64().expect("a number"))
    };
    let ratio = 1.29393000254;
    assert_eq!((shape("translation").0, shape("max").1, shape("first").0), (1.0, 1.0, 1.0));
    assert!((shape("first").1 - ratio).abs() < 1e-10);
    let (x, angle) = shape("mass");
    // x^T M x with the mass matrix of the problem set.
    assert!((1.5 * x * x + x * angle + 2.0 / 3.0 * angle * angle - 1.0).abs() < 1e-14);
}

/// Twelve equal masses between two walls: x_i(j) = sin(i j pi / 13), the largest entry 1; more coordinates than columns.
#[test]
fn every_entry_of_the_shapes_is_printed_on_demand() {
    let mut model = String::from("body m[1] { mass = 1 kg, moves x }\nspring k[1]: ground -- m[1] { k = 1 N/m }\n");
    for j in 2..=12 {
        let before = j - 1;
        model +=
            &format!("body m[{j}] {{ mass = 1 kg, moves x }}\nspring k[{j}]: m[{before}] -- m[{j}] {{ k = 1 N/m }}\n");
    }
    model += "spring k[13]: m[12] -- ground { k = 1 N/m }\n";
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("chain.vib");
    std::fs::write(&path, model).expect("a file");
    let path = path.to_string_lossy();
    assert!(!run(&["analyze", &path]).out.contains("shapes  "));
    let text = run(&["analyze", &path, "--shapes", "all"]).out;
    let tables: Vec<&str> = text.split("\n  shapes ").skip(1).collect();
    assert_eq!(tables.len(), 2, "{text}");
    for (table, first) in tables.iter().zip([1, 7]) {
        assert!(table.trim_start().starts_with(&format!("mode {first} ")), "{table}");
        for j in 1..=12 {
            let name = format!("m[{j}].x ");
            let row = table.lines().find(|line| line.trim_start().starts_with(&name)).expect("a row");
            let entries: Vec<f64> = row.split_whitespace().skip(2).map(|x| x.parse().expect("a number")).collect();
            assert_eq!(entries.len(), 6, "{row}");
            for (entry, i) in entries.iter().zip(first..) {
                let shape = |j: usize| ((i * j) as f64 * std::f64::consts::PI / 13.0).sin();
                let largest = (1..=12).map(shape).fold(0.0_f64, |most, x| most.max(x.abs()));
                // The sign is that of the entry that is scaled to 1.
                assert!((entry.abs() - shape(j).abs() / largest).abs() < 1e-4, "mode {i}: {row}");
            }
        }
    }
}

#[test]
fn a_transfer_table_has_three_formats() {
    let text = run(&["transfer", CART, "--to", "x"]);
    assert_eq!((text.status, text.err.as_str()), (0, ""));
    assert!(text.out.contains("peak") && text.out.contains("antiresonance"), "{}", text.out);
    let csv = run(&["transfer", CART, "--range", "0.1Hz..2Hz", "--points", "3", "--format", "csv"]);
    let lines: Vec<&str> = csv.out.lines().collect();
    assert_eq!(lines[0], "frequency_hz,input,output,re,im,gain,gain_db,phase_deg,error_bound");
    // Three frequencies, one input, two outputs.
    assert_eq!(lines.len(), 7);
    assert!(lines[1].starts_with("0.1,F,x,") && lines[6].starts_with("2.0,F,theta,"), "{}", csv.out);
    let json = run(&["transfer", CART, "--at", "1Hz", "--at", "2rad/s", "--format", "json"]);
    let table: Value = serde_json::from_str(&json.out).expect("an object");
    assert_eq!((&table["schema"], &table["model"]), (&1.into(), &"cart".into()));
    let pairs = table["pairs"].as_array().expect("an array");
    assert_eq!(pairs.len(), 2);
    let values = pairs[0]["values"].as_array().expect("an array");
    // The two frequencies in the order of the request.
    assert_eq!(values.len(), 2);
    assert!((values[1]["frequency_hz"].as_f64().expect("a number") - 1.0 / std::f64::consts::PI).abs() < 1e-15);
    assert!(values[0]["error_bound"].as_f64().expect("a number") < 2.3e-16);
}

/// The mortar after its shot: x0 = -25 * 9.81 / 15791 m and -0.375 m/s, damped by 1 %.
#[test]
fn a_motion_is_printed_as_csv() {
    let model = format!("{}/examples/mortar.vib", env!("CARGO_MANIFEST_DIR"));
    let csv = run(&["simulate", &model, "--until", "1s", "--step", "250ms"]);
    assert_eq!((csv.status, csv.err.as_str()), (0, ""));
    let lines: Vec<&str> = csv.out.lines().collect();
    assert_eq!((lines[0], lines.len()), ("time_s,y", 6));
    let x: f64 = lines[5].strip_prefix("1.0,").expect("the last time").parse().expect("a number");
    let (x0, v0, w2, a) = (-25.0 * 9.81 / 15791.0, -0.375, 1.5791f64, 251.33 / 20000.0);
    let wd = (w2 - a * a).sqrt();
    let closed = (-a).exp() * (x0 * wd.cos() + (v0 + a * x0) / wd * wd.sin());
    assert!((x - closed).abs() < 1e-15, "{x} {closed}");
}

#[test]
fn tables_that_cannot_be_made_are_usage_errors() {
    for arguments in [
        &["--from", "G"][..],
        &["--to", "nothing"],
        &["--range", "2Hz..1Hz"],
        &["--range", "1Hz"],
        &["--range", "1..2"],
        &["--points", "0"],
        &["--at", "3kg"],
        &["--at", "3"],
        &["--tolerance", "2"],
        &["--at", "1Hz", "--points", "3"],
    ] {
        let refused = run(&[&["transfer", CART], arguments].concat());
        assert_eq!((refused.status, refused.out.as_str()), (2, ""), "{arguments:?}");
    }
    for arguments in
        [["--until", "0s", "--step", "1s"], ["--until", "1s", "--step", "-1s"], ["--until", "1Hz", "--step", "1s"]]
    {
        let refused = run(&[&["simulate", CART], &arguments[..]].concat());
        assert_eq!((refused.status, refused.out.as_str()), (2, ""), "{arguments:?}");
    }
    let many = run(&["simulate", CART, "--until", "1h", "--step", "1us"]);
    assert_eq!(many.status, 2);
    assert!(many.err.contains("samples"), "{}", many.err);
}

/// A row of numbers and their bounds: at rest, then sin(1 s) with its rounding error in binary64. A scene without
/// outputs, and one with unknown samples, have their own exit statuses.
#[test]
fn samples_are_printed_with_their_bounds() {
    let folder = folder();
    let swing = "body a { mass = 1 kg, moves x }\nspring s: ground -- a { k = 1 N/m }\ninitial a { vx = 1 m/s }\n";
    let simulate = |text: &str, more: &[&str]| {
        let path = file(&folder, "swing.vib", text);
        run(&[&["simulate", &path, "--until", "1s", "--step", "62.5ms"], more].concat())
    };
    let reported = simulate(&format!("{swing}output x = a.x\n"), &["--bounds"]);
    assert_eq!((reported.status, reported.err.as_str()), (0, ""));
    let lines: Vec<&str> = reported.out.lines().collect();
    assert_eq!((lines[0], lines.len()), ("time_s,x,x_bound", 18));
    assert!(lines[1].starts_with("0.0,0.0,"), "{}", lines[1]);
    let last: Vec<f64> = lines[17].split(',').map(|field| field.parse().expect("a number")).collect();
    // sin 1 = 0.841470984807896506652502...: the nearest binary64 number is 1.7768450932935e-18 below.
    assert_eq!(last[..2], [1.0, 0.8414709848078965]);
    assert!((1.776845093e-18..1.776845094e-18).contains(&last[2]), "{}", last[2]);
    let plain = simulate(&format!("{swing}output x = a.x\n"), &[]);
    assert_eq!(plain.out.lines().next(), Some("time_s,x"));
    let none = simulate(swing, &[]);
    assert_eq!((none.status, none.out.as_str()), (2, ""));
    assert!(none.err.contains("no output"), "{}", none.err);
    let still = simulate(
        &format!("{}output x = a.x\n", swing.replace("vx = 1 m/s", "vx = 0 m/s")),
        &["--message-format", "short"],
    );
    assert_eq!(still.status, 0);
    assert!(still.err.contains("warning[vib::motion::still]"), "{}", still.err);
}

/// x = sin t: after half a second it reaches 0.4794255386 m, and no more.
#[test]
fn measures_are_simulated_for_the_given_time() {
    let folder = folder();
    let model = |limit: &str| {
        let text = format!(
            "body a {{ mass = 1 kg, moves x }}\nspring s: ground -- a {{ k = 1 N/m }}\n\
             initial a {{ vx = 1 m/s }}\noutput x = a.x\nrequire peak(x) < {limit} m\n"
        );
        file(&folder, &format!("swing{limit}.vib"), text)
    };
    let (holds, fails) = (model("0.4794255387"), model("0.4794255386"));
    for command in ["analyze", "check"] {
        for more in [&["--until", "500ms"][..], &["--until", "0.5s", "--literals", "binary64"]] {
            let of = |path: &str| run(&[&[command, path], more].concat());
            assert_eq!(of(&holds).status, 0, "{command} {more:?}: {}", of(&holds).err);
            assert_eq!(of(&fails).status, 1, "{command} {more:?}: {}", of(&fails).err);
        }
        assert_eq!(run(&[command, &holds]).status, 1, "a whole swing goes to 1 m");
        let refused = run(&[command, &holds, "--until", "3 kg"]);
        assert_eq!((refused.status, refused.out.as_str()), (2, ""));
    }
}

#[test]
fn damping_of_all_modes_gives_each_its_ratio() {
    let folder = folder();
    let model = "body a { mass = 2 kg, moves x }\nbody b { mass = 1 kg, moves x }\n\
                 spring s: ground -- a { k = 100 N/m }\nspring t: a -- b { k = 50 N/m }\n";
    for (damping, ratios) in
        [("damping modal 2 %", [0.02, 0.02]), ("damping rayleigh(0.2 /s, 4e-3 s)", [0.02 + 0.01, 0.01 + 0.02])]
    {
        let path = file(&folder, "damped.vib", format!("{model}{damping}\n"));
        let report: Value = serde_json::from_str(&run(&["analyze", &path, "--format", "json"]).out).expect("a report");
        let poles = report["poles"].as_array().expect("poles");
        for (pair, ratio) in poles.chunks(2).zip(ratios) {
            let zeta = pair[0]["damping_ratio"].as_f64().expect("a ratio");
            // omega = 5 and 10 rad/s: alpha / (2 omega) + beta omega / 2.
            assert!((zeta - ratio).abs() < 1e-16, "{damping}: {zeta}");
        }
    }
}

/// Settings are read like the model: a difference that is zero in decimals is 2^-55 in binary64.
#[test]
fn both_readings_of_literals_are_at_hand() {
    let folder = folder();
    let model = file(&folder, "oscillator.vib", OSCILLATOR);
    let stiffness = |literals: &str| {
        let set = "k=1 N/m + (0.1 + 0.2 - 0.3) * 2^56 * 1 N/m";
        let run = run(&["analyze", "--literals", literals, "--format", "json", "--set", set, &model]);
        let json: Value = serde_json::from_str(&run.out).unwrap_or_else(|_| panic!("{}", run.err));
        json["matrices"]["k"][0][0].as_f64()
    };
    assert_eq!(stiffness("decimal"), Some(1.0));
    assert_eq!(stiffness("binary64"), Some(3.0));
}

#[test]
fn a_file_is_laid_out_in_its_place() {
    let folder = folder();
    let (loose, tidy) = (file(&folder, "loose.vib", "param k=1 N/m\n"), file(&folder, "tidy.vib", "param k = 1 N/m\n"));
    let check = run(&["fmt", "--check", &tidy, &loose]);
    assert_eq!((check.status, check.out.trim_end(), check.err.as_str()), (1, loose.as_str(), ""));
    assert_eq!(fs::read_to_string(&loose).unwrap(), "param k=1 N/m\n");
    let done = run(&["fmt", &tidy, &loose]);
    assert_eq!((done.status, done.out.as_str(), done.err.as_str()), (0, "", ""));
    assert_eq!(fs::read_to_string(&loose).unwrap(), fs::read_to_string(&tidy).unwrap());
    assert_eq!(run(&["fmt", "--check", &tidy, &loose]).status, 0);
}

#[test]
fn standard_input_is_laid_out_to_standard_output() {
    let done = run_with_input(&["fmt", "-"], b"param k=1 N/m\n");
    assert_eq!((done.status, done.out.as_str()), (0, "param k = 1 N/m\n"));
    assert_eq!(run_with_input(&["fmt", "-"], b"param k = 1 N/m\n").out, "param k = 1 N/m\n");
    let check = run_with_input(&["fmt", "--check", "-"], b"param k=1 N/m\n");
    assert_eq!((check.status, check.out.as_str()), (1, "<stdin>\n"));
}

#[test]
fn a_file_with_syntax_errors_is_left_as_it_is() {
    let folder = folder();
    let broken = file(&folder, "broken.vib", "param  k = \nparam  m=1 kg\n");
    let refused = run(&["fmt", "--message-format", "short", &broken]);
    assert_eq!((refused.status, refused.out.as_str()), (1, ""));
    assert!(refused.err.contains("vib::syntax::unexpected"), "{}", refused.err);
    assert_eq!(fs::read_to_string(&broken).unwrap(), "param  k = \nparam  m=1 kg\n");
    assert_eq!(run(&["fmt", "nowhere.vib"]).status, 3);
}

#[test]
fn shells_and_man_know_every_command() {
    let help = run(&["help"]).out;
    let commands = ["analyze", "transfer", "simulate", "check", "fmt", "explain"];
    for shell in ["bash", "elvish", "fish", "powershell", "zsh"] {
        let script = run(&["completions", shell]);
        assert_eq!(script.status, 0);
        assert!(commands.iter().all(|command| script.out.contains(command)), "{shell}");
    }
    let page = run(&["man"]).out;
    assert!(page.contains(".TH vibc 1") && commands.iter().all(|command| page.contains(command)), "{page}");
    for command in commands {
        assert!(help.contains(command));
        let page = run(&["man", command]);
        assert!(page.status == 0 && page.out.contains(&format!(".TH vibc-{command} 1")), "{}", page.out);
    }
    assert_eq!(run(&["man", "nothing"]).status, 2);
    // A shell completes each command of the list after `man`.
    let listed = help.lines().skip_while(|line| *line != "Commands:").skip(1).take_while(|line| !line.is_empty());
    let listed = listed.filter(|line| !line.starts_with("   ")).filter_map(|line| line.split_whitespace().next());
    let names: Vec<&str> = listed.filter(|name| *name != "help").collect();
    let script = run(&["completions", "bash"]).out;
    let of_man = script.split("vibc__subcmd__man)").nth(1).unwrap_or_default().split("esac").next().unwrap_or_default();
    assert!(names.len() > 8 && names.iter().all(|name| of_man.contains(name)), "{names:?}\n{of_man}");
}

/// A frequency in rad/s is exact, even if it is not in Hz: it coincides with the system's own frequency instead of just
/// missing it.
#[test]
fn an_undamped_system_at_its_own_frequency_in_radians_is_infinite() {
    let model = "body block { mass = 1 kg, moves x }\nspring s: ground -- block { k = 4 N/m }\nforce F: block along x\noutput x = block.x\n";
    let reported = run_with_input(&["transfer", "-", "--at", "2rad/s", "--format", "csv"], model.as_bytes());
    assert!(reported.out.ends_with(",F,x,,,inf,inf,,\n"), "{}", reported.out);
}

/// An accuracy that cannot be reached is reported with the one that was reached, along with the answer.
#[test]
fn an_unmet_tolerance_has_its_own_exit_status() {
    let folder = folder();
    let text = "body b { mass = 1 kg, moves x }\nspring s: ground -- b { k = (cos(20 deg)^2 + sin(20 deg)^2 - 1 + 1e-25) * 1 N/m }\n";
    let model = file(&folder, "hard.vib", text);
    for (tolerance, status) in [("1e-4", 0), ("1e-6", 4)] {
        let run = run(&["analyze", "--tolerance", tolerance, "--message-format", "short", &model]);
        assert_eq!(run.status, status, "{}", run.err);
        assert!(run.out.contains("undamped modes"), "{}", run.out);
        assert_eq!(
            run.err.contains("error[vib::limit::tolerance]: the frequency of mode 1"),
            status == 4,
            "{}",
            run.err
        );
    }
    let default = run(&["analyze", "--message-format", "short", &model]);
    assert_eq!(default.status, 0);
    assert!(default.err.contains("warning[vib::limit::tolerance]"), "{}", default.err);
    assert_eq!(run(&["analyze", "--tolerance", "1e-29", CART]).status, 0);
    assert_eq!(run(&["analyze", "--tolerance", "0", CART]).status, 2);
}

/// Two weakly coupled pendulums, and an inverted one near its buckling load, to thirty digits, as far as these are
/// certain.
#[test]
fn digits_are_printed_as_far_as_they_are_certain() {
    let folder = folder();
    let text = "gravity 10 m/s^2
                body a { mass = 1 kg, at = (0, -1 m) }
                pivot p: ground@(0, 0) -- a
                body b { mass = 1 kg, at = (5 m, -1 m) }
                pivot q: ground@(5 m, 0) -- b
                spring s: a -- b { k = 1e-10 N*m/rad }
                body c { mass = 1 kg, at = (9 m, 1 m) }
                pivot r: ground@(9 m, 0) -- c
                spring t: ground -- c { k = 10.0000000000000001 N*m/rad }";
    let model = file(&folder, "pendulums.vib", text);
    let json = run(&["analyze", "--digits", "30", "--format", "json", &model]).out;
    let json: Value = serde_json::from_str(&json).expect("JSON");
    // sqrt(10) and sqrt(10 + 2e-10), by mpmath.
    assert_eq!(json["modes"][1]["omega_digits"], "3.16227766016837933199889354443");
    assert_eq!(json["modes"][2]["omega_digits"], "3.16227766020000210860041922387");
    let split = &json["splits"][0];
    assert_eq!((&split["modes"][0], &split["modes"][1]), (&Value::from(2), &Value::from(3)));
    let digits = split["omega_digits"].as_str().expect("digits");
    assert!("3.162277660152567943698209e-11".starts_with(&digits[..17]), "{digits}");
    // k - m g l = 1e-16, so omega = 1e-8 and the load factor 1 + 1e-17.
    let near = json["modes"][0]["omega_digits"].as_str().expect("digits");
    assert!(near.starts_with("1.000000000000000000000000") && near.ends_with("e-8"), "{near}");
    let margin = json["buckling"]["margin"].as_f64().expect("a number");
    let bound = json["buckling"]["margin_error_bound"].as_f64().expect("a number");
    assert!((margin - 1e-17).abs() <= bound * 1e-17 && bound < 1e-12, "{margin:e} to {bound:e}");
    assert_eq!(json["buckling"]["load_factor_digits"], "1.00000000000000001000000000000");
    let text = run(&["analyze", "--digits", "30", &model]).out;
    for part in [
        "3.16227766016837933199889354443",
        "modes 2 and 3 are 3.162277660152567",
        "load factor to buckling 1.00000000000000001",
    ] {
        assert!(text.contains(part), "{part} in\n{text}");
    }
}

/// Two frequencies that differ by 2^(1/4) / 2 in the 32nd digit, a few times their own radius: that they differ is proved, and not
/// one digit of the difference.
#[test]
fn frequencies_that_hardly_differ_have_a_largest_difference() {
    let folder = folder();
    let text = "body a { mass = 1 kg, moves x }
                body b { mass = 1 kg, moves x }
                spring s: ground -- a { k = sqrt(2) * 1 N/m, along = x }
                spring t: ground -- b { k = sqrt(2) * 1.00000000000000000000000000000001 N/m, along = x }";
    let out = run(&["analyze", &file(&folder, "near.vib", text)]).out;
    let most = out.split_once("modes 1 and 2 differ, by at most ").expect("a line on the two modes").1;
    let most: f64 = most.split_once(" rad/s\n").expect("a unit").0.parse().expect("a number");
    let truth = 2f64.powf(0.25) / 2.0 * 1e-32;
    assert!(truth <= most && most < 5.0 * truth, "{most:e} {truth:e}");
}

#[test]
fn words_of_the_language_are_explained() {
    for (word, meaning) in [
        ("spring", "k = "),
        ("harmonic", "`harmonic("),
        ("mass", "In `body`"),
        ("moves", "In `base`"),
        ("along", "In `spring`, `damper`"),
        ("white", "noise(white"),
        ("mm", "As a unit: a length: 1 mm = 0.001 m."),
    ] {
        let told = run(&["explain", word]);
        assert_eq!((told.status, told.err.as_str()), (0, ""), "{word}");
        assert!(told.out.starts_with(word) && told.out.contains(meaning), "{}", told.out);
    }
    let unknown = run(&["explain", "harmonik"]);
    assert_eq!((unknown.status, unknown.out.as_str()), (2, ""));
    assert!(unknown.err.contains("did you mean `harmonic`?"), "{}", unknown.err);
}
