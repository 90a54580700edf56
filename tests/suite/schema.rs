//! The printed JSON has the published form: every output of every example is valid, and has no field that the schema
//! does not describe.

use super::documents::root;
use serde_json::Value;
use std::fs;
use std::path::PathBuf;
use std::process::Command;

/// A schema, prepared for validation.
struct Form {
    schemas: boon::Schemas,
    index: boon::SchemaIndex,
}

impl Form {
    /// The published schema, made stricter: objects have no other fields than those that it describes.
    fn published(name: &str) -> Form {
        let path = root().join("schema").join(format!("{name}.schema.json"));
        let text = fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        let mut schema = serde_json::from_str(&text).expect("a schema is JSON");
        close(&mut schema);
        let mut schemas = boon::Schemas::new();
        let mut compiler = boon::Compiler::new();
        compiler.add_resource("form.json", schema).expect("a schema");
        let index = compiler.compile("form.json", &mut schemas).unwrap_or_else(|error| panic!("{name}: {error:#}"));
        Form { schemas, index }
    }

    fn assert_valid(&self, of: &str, text: &str) {
        let value: Value = serde_json::from_str(text).unwrap_or_else(|error| panic!("{of}: {error}\n{text:.200}"));
        if let Err(error) = self.schemas.validate(&value, self.index) {
            panic!("{of}: {error:#}");
        }
    }
}

/// Forbids undescribed fields in every object whose fields the schema lists.
fn close(schema: &mut Value) {
    if let Value::Object(keys) = schema {
        if keys.contains_key("properties") && !keys.contains_key("additionalProperties") {
            keys.insert("additionalProperties".into(), Value::Bool(false));
        }
        keys.values_mut().for_each(close);
    }
}

fn examples() -> Vec<PathBuf> {
    let entries = fs::read_dir(root().join("examples")).expect("examples").map(|entry| entry.expect("an entry").path());
    let mut models: Vec<PathBuf> = entries.filter(|path| path.extension().is_some_and(|it| it == "vib")).collect();
    models.sort();
    models
}

fn printed(arguments: &[&str]) -> (String, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_vibc")).args(arguments).output().expect("the program starts");
    (String::from_utf8(output.stdout).expect("UTF-8"), String::from_utf8(output.stderr).expect("UTF-8"))
}

/// Validates the output of a command for each example; if there is none, the command must say why.
fn validate(command: &str, options: &[&str]) {
    let form = Form::published(command);
    for model in examples() {
        let model = model.to_string_lossy();
        let (result, findings) = printed(&[&[command, &model, "--format", "json"], options].concat());
        match result.is_empty() {
            true => assert!(!findings.is_empty(), "{command} {model} prints nothing"),
            false => form.assert_valid(&format!("{command} {model}"), &result),
        }
    }
}

#[test]
fn reports_have_the_published_form() {
    validate("analyze", &[]);
    validate("analyze", &["--digits", "20", "--explain-model", "--normalise", "mass"]);
}

#[test]
fn sensitivities_have_the_published_form() {
    let form = Form::published("analyze");
    for example in ["cart", "isolation_table", "quarter_car"] {
        let model = root().join("examples").join(format!("{example}.vib"));
        let (result, _) = printed(&["analyze", &model.to_string_lossy(), "--sensitivity", "--format", "json"]);
        form.assert_valid(example, &result);
    }
}

#[test]
fn tolerances_have_the_published_form() {
    let form = Form::published("analyze");
    let folder = tempfile::tempdir().expect("a folder");
    let model = folder.path().join("m.vib");
    let text = "param k = 10 N/m within 5 %\nparam m = 1 kg within 0.9 kg .. 1.2 kg\nbody b { mass = m, moves x }\n\
                spring s: ground -- b { k = k }\nspring t: ground -- b { k = 20 N/m - k * LAW }\n\
                require frequency(1) > 0.6 Hz\nrequire frequency(1) > 0.64 Hz\nrequire damping(1) < 1 %\n";
    for law in ["0", "1 m/N * k / (10 N/m)"] {
        fs::write(&model, text.replace("LAW", law).replace("k * 1 m/N * k", "k * k")).expect("a file");
        let (result, findings) = printed(&["analyze", &model.to_string_lossy(), "--tolerances", "--format", "json"]);
        assert!(result.contains("\"tolerances\""), "{findings}");
        form.assert_valid(law, &result);
    }
}

#[test]
fn worst_cases_have_the_published_form() {
    let form = Form::published("analyze");
    let folder = tempfile::tempdir().expect("a folder");
    let model = folder.path().join("m.vib");
    let text = "param k = 10 N/m within 5 %\nparam c = 1 N*s/m\nbody b { mass = 1 kg, moves x }\nspring s: ground -- b { k = k }\n\
                damper d: ground -- b { c = c }\nforce F: b along x = step(1 N, 0 s)\noutput x = b.x\n\
                LINE over c in 0.1 N*s/m .. 8 N*s/m while damping(1) < 0.6\n";
    for line in ["minimise gain(F -> x, 1 Hz)", "maximise gain(F -> x, 0.5 Hz)"] {
        fs::write(&model, text.replace("LINE", line)).expect("a file");
        let (result, findings) = printed(&["analyze", &model.to_string_lossy(), "--robust", "--format", "json"]);
        assert!(result.contains("\"best_possible\""), "{findings}");
        form.assert_valid(line, &result);
    }
    // Nothing is proved of a measure in time: no bound, no best value, no gap.
    fs::write(&model, text.replace("LINE", "minimise peak(x)")).expect("a file");
    let (result, findings) = printed(&["analyze", &model.to_string_lossy(), "--robust", "--format", "json"]);
    form.assert_valid("peak", &result);
    let told: serde_json::Value = serde_json::from_str(&result).expect("JSON");
    let found = &told["optimised"][0];
    let worst = &found["worst_case"];
    assert!(
        worst["bound"].is_null() && worst["best_possible"].is_null() && found["gap"].is_null(),
        "{findings} {worst}"
    );
    assert!(worst["reached"].is_number() && worst["nominal"]["worst_bound"].is_null(), "{worst}");
}

#[test]
fn effective_masses_have_the_published_form() {
    let form = Form::published("analyze");
    for example in ["earthquake", "quarter_car", "inerter_table"] {
        let model = root().join("examples").join(format!("{example}.vib"));
        let (result, _) = printed(&["analyze", &model.to_string_lossy(), "--participation", "--format", "json"]);
        assert!(result.contains("base_excitation"), "{example}");
        form.assert_valid(example, &result);
    }
}

#[test]
fn shapes_on_demand_have_the_published_form() {
    let form = Form::published("analyze");
    for (shapes, field) in [("damped", "damped_shapes"), ("all", "\"outputs\"")] {
        for example in ["quarter_car", "cart", "inerter_table"] {
            let model = root().join("examples").join(format!("{example}.vib"));
            let (result, _) = printed(&["analyze", &model.to_string_lossy(), "--shapes", shapes, "--format", "json"]);
            assert!(result.contains(field), "{example} {shapes}");
            form.assert_valid(example, &result);
        }
    }
}

#[test]
fn transfer_functions_have_the_published_form() {
    validate("transfer", &[]);
    validate("transfer", &["--points", "3"]);
}

#[test]
fn time_responses_have_the_published_form() {
    validate("simulate", &["--until", "1s", "--step", "100ms"]);
}

#[test]
fn shock_response_spectra_have_the_published_form() {
    validate("shock", &["--range", "1Hz..100Hz", "--points", "7"]);
}

#[test]
fn studies_have_the_published_form() {
    let form = Form::published("sweep");
    for (model, arguments) in [
        ("cart", &["--over", "k=5N/m,10N/m", "--poles", "--modes", "1", "--measure", "gain(F -> x, 1 Hz)"][..]),
        ("isolation_table", &["--over", "zeta=5%..15%:3"]),
        ("cart", &["--over", "k=5N/m..50N/m:4", "--follow"]),
        ("inverted_pendulum", &["--over", "k=1N/m..5N/m:4", "--follow", "--poles"]),
        ("rotor", &["--over", "speed=600rpm..3000rpm:5", "--follow", "--orders", "1,2"]),
        ("cart", &["--over", "L=0m,1m", "--over", "b=0", "--measure", "peak_gain(F -> x)"]),
    ] {
        let path = root().join("examples").join(format!("{model}.vib"));
        let (result, findings) =
            printed(&[&["sweep", &path.to_string_lossy(), "--format", "json"], arguments].concat());
        assert_eq!(findings, "", "{model}");
        form.assert_valid(model, &result);
    }
}

#[test]
fn equations_have_the_published_form() {
    validate("equations", &[]);
}

#[test]
fn diagnostics_have_the_published_form() {
    let form = Form::published("diagnostic");
    let folder = root().join("tests/diagnostics");
    let mut models: Vec<PathBuf> =
        fs::read_dir(folder).expect("models").map(|entry| entry.expect("an entry").path()).collect();
    models.retain(|path| path.extension().is_some_and(|it| it == "vib"));
    models.sort();
    for model in models.iter().step_by(3) {
        let model = model.to_string_lossy();
        for line in printed(&["check", &model, "--message-format", "json"]).1.lines() {
            form.assert_valid(&model, line);
        }
    }
    let (_, missing) = printed(&["check", "missing.vib", "--message-format", "json"]);
    form.assert_valid("a missing file", &missing);
}

#[test]
fn a_field_that_no_schema_describes_is_seen() {
    let form = Form::published("diagnostic");
    let (_, line) = printed(&["check", "missing.vib", "--message-format", "json"]);
    let mut value: Value = serde_json::from_str(&line).expect("an object");
    value["colour"] = Value::from("red");
    assert!(form.schemas.validate(&value, form.index).is_err());
}
