//! Fixes: each one removes its finding, and every finding with an obvious fix has it.

use super::client::{Client, URI};
use serde_json::{Value, json};
use std::fs;
use std::path::Path;

/// The actions on a finding.
fn actions(client: &mut Client, finding: &Value) -> Vec<Value> {
    let params = json!({
        "textDocument": { "uri": URI }, "range": finding["range"], "context": { "diagnostics": [finding] },
    });
    let actions = client.ask("textDocument/codeAction", params);
    let own = actions.as_array().expect("actions").iter().filter(|action| {
        let fixed = &action["diagnostics"][0];
        fixed["code"] == finding["code"] && fixed["range"] == finding["range"]
    });
    own.cloned().collect()
}

fn codes(findings: &[Value]) -> Vec<String> {
    findings.iter().map(|finding| finding["code"].as_str().expect("a code").to_string()).collect()
}

/// The findings of `tests/diagnostics` with an obvious fix: a unit, a name, a field, a bracket, or one of two of which
/// one is too many.
const MENDED: [&str; 39] = [
    "base_no_motion",
    "body_freedom",
    "body_given_twice",
    "body_no_freedom",
    "element_direction_unknown",
    "element_torsion_along",
    "element_zero_length",
    "field_duplicate",
    "field_missing",
    "field_unknown",
    "freedom_loose",
    "freedom_no_inertia",
    "function_unknown",
    "inertia_missing",
    "input_direction_unknown",
    "joint_direction",
    "joint_no_place",
    "mass_missing",
    "measure_mode",
    "measure_unknown",
    "name_duplicate",
    "name_unknown",
    "part_unknown",
    "position_unknown",
    "repeat_reversed",
    "scene_empty",
    "shape_unknown",
    "spring_free_length_and_preload",
    "syntax_stray",
    "syntax_unclosed",
    "syntax_unclosed_2",
    "syntax_unclosed_string",
    "syntax_unknown_keyword",
    "unit_ambiguous",
    "unit_frequency",
    "unit_missing",
    "unit_unknown",
    "unused_parameter",
    "unused_property",
];

#[test]
fn each_fix_removes_its_finding() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/diagnostics");
    let mut models: Vec<_> =
        fs::read_dir(folder).expect("models").map(|entry| entry.expect("an entry").path()).collect();
    models.retain(|path| path.extension().is_some_and(|extension| extension == "vib"));
    models.sort();
    let mut wrong = Vec::new();
    for path in models {
        let stem = path.file_stem().unwrap().to_string_lossy().into_owned();
        let Ok(text) = fs::read_to_string(&path) else { continue };
        let mut client = Client::open(&text);
        let findings = client.findings();
        let mut fixed = 0;
        for finding in &findings {
            for action in actions(&mut client, finding).iter().filter(|action| action.get("edit").is_some()) {
                let edited = client.edited(&action["edit"]);
                client.change(&edited);
                let left = codes(&client.findings());
                client.change(&text);
                client.findings();
                let code = finding["code"].as_str().expect("a code");
                let before = codes(&findings).iter().filter(|other| *other == code).count();
                let after = left.iter().filter(|other| *other == code).count();
                let breaks =
                    left.iter().any(|code| code.starts_with("vib::syntax") && !codes(&findings).contains(code));
                if after >= before || breaks {
                    wrong.push(format!("{stem}: `{}` gives {left:?}:\n{edited}", action["title"]));
                }
                fixed += 1;
            }
        }
        if MENDED.contains(&stem.as_str()) && fixed == 0 {
            wrong.push(format!("{stem}: no fix for {:?}", codes(&findings)));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn the_likeliest_fix_is_preferred_and_the_page_is_offered() {
    let mut client = Client::open("body b { mass = 1 kgg, moves x }\nspring s: ground -- b { k = 1 N/m }\n");
    let finding = client.findings().remove(0);
    let actions = actions(&mut client, &finding);
    assert_eq!(actions[0]["isPreferred"], true);
    let last = actions.last().unwrap();
    assert_eq!(last["command"]["command"], "vibc.explain");
    assert_eq!(last["command"]["arguments"], json!(["vib::unit::unknown"]));
}

#[test]
fn fixes_are_what_a_user_would_type() {
    for (text, fixed) in [
        ("body b { mass = 2, moves x }", "body b { mass = 2 kg, moves x }"),
        ("param m = 2\nbody b { mass = m, moves x }", "param m = 2 kg\nbody b { mass = m, moves x }"),
        ("body b { moves x }", "body b { moves x, mass = 1 kg }"),
        ("body b {\n  moves x\n}", "body b {\n  moves x\n  mass = 1 kg\n}"),
        ("body b { mass = 1 kg, moves x", "body b { mass = 1 kg, moves x }"),
        ("body b { mass = (1 kg, moves x }", "body b { mass = (1 kg), moves x }"),
        ("body b { mas = 1 kg, moves x }", "body b { mass = 1 kg, moves x }"),
        ("bodi b { mass = 1 kg, moves x }", "body b { mass = 1 kg, moves x }"),
        ("body b { mass = 1 kg, moves x, mass = 2 kg }", "body b { mass = 1 kg, moves x }"),
        ("body b { mass: 1 kg, moves x }", "body b { mass = 1 kg, moves x }"),
        ("body b { mass = 1 kg moves x }", "body b { mass = 1 kg , moves x }"),
        ("body b { mass = 1 kg, moves x }\noutput y = b.xx", "body b { mass = 1 kg, moves x }\noutput y = b.x"),
        (
            "body b { mass = 1 kg, moves x, turns = 1, inertia = 1 kg*m^2 }",
            "body b { mass = 1 kg, moves x, turns, inertia = 1 kg*m^2 }",
        ),
        (
            "body b { mass = 1 kg, moves x }\nforce F: b = harmonik(1 N, 2 Hz)",
            "body b { mass = 1 kg, moves x }\nforce F: b = harmonic(1 N, 2 Hz)",
        ),
        (
            "body b { mass = 1 kg, moves x }\nbody b { mass = 1 kg, moves x }",
            "body b { mass = 1 kg, moves x }\nbody b2 { mass = 1 kg, moves x }",
        ),
        ("k = 1 N/m", "param k = 1 N/m"),
        ("param k = 1 N/m # stiff", "param k = 1 N/m // stiff"),
        ("param k = 5 1/s", "param k = 5 /s"),
    ] {
        let whole = |text: &str| format!("{text}\nbody other {{ mass = 1 kg, moves x }}\n");
        let mut client = Client::open(&whole(text));
        let findings = client.findings();
        let all: Vec<Value> = findings.iter().flat_map(|finding| actions(&mut client, finding)).collect();
        let edits = all.iter().filter_map(|action| action.get("edit"));
        let fixes: Vec<String> = edits.map(|edit| client.edited(edit)).collect();
        assert!(fixes.contains(&whole(fixed)), "{text}: {findings:?}\n{fixes:#?}");
    }
}
