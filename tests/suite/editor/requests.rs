//! Each request of the protocol, on models whose answers are known.

use super::client::{Client, URI, applied};
use serde_json::{Value, json};
use std::fs;
use vibc::base::{SourceFile, Sources};

fn example(name: &str) -> String {
    fs::read_to_string(format!("{}/examples/{name}.vib", env!("CARGO_MANIFEST_DIR"))).expect("an example")
}

/// One mass on one spring: sqrt(k/m) = 10 rad/s, 1.592 Hz.
const OSCILLATOR: &str = "model oscillator
/// How stiff
param k = 0.1 kN/m
let w = sqrt(k / 1 kg)
body block { mass = 1 kg, moves x }
spring s: ground -- block { k = k }
damper d: ground -- block { c = 2*0.05*w * 1 kg }
output y = block.x
solve k in 50 N/m .. 200 N/m: frequency(1) = 2 Hz
require frequency(1) > 0.5 Hz
require frequency(1) > 4 Hz
";

fn strings(values: &Value, field: &str) -> Vec<String> {
    let values = values.as_array().expect("a list").iter();
    values.map(|value| value[field].as_str().expect("a text").to_string()).collect()
}

#[test]
fn the_server_lists_its_capabilities() {
    let client = Client::open("");
    let can = &client.capabilities["capabilities"];
    for provider in [
        "hoverProvider",
        "inlayHintProvider",
        "completionProvider",
        "definitionProvider",
        "referencesProvider",
        "renameProvider",
        "documentSymbolProvider",
        "semanticTokensProvider",
        "foldingRangeProvider",
        "documentFormattingProvider",
        "codeActionProvider",
    ] {
        assert!(!can[provider].is_null(), "{provider}: {can}");
    }
    assert_eq!(client.capabilities["serverInfo"]["name"], "vibc");
}

#[test]
fn a_body_shows_its_equations_of_motion() {
    let mut client = Client::open(&example("cart"));
    let rod = hover(&mut client, "rod   {", 0);
    for line in [
        "m2 L/2 cos(theta) x'' + m2 L^2/3 theta'' + m2 g L/2 sin(theta) = 0\n",
        "m2 L/2 x'' + m2 L^2/3 theta'' + m2 g L/2 theta = 0\n",
    ] {
        assert!(rod.contains(line), "{rod}");
    }
    assert!(!rod.contains("b x'"), "the equation of the block is not that of the rod: {rod}");
    // Nobody waits for a hundred of them.
    let mut client = Client::open(&example("long_chain"));
    assert!(!hover(&mut client, "mass[1] {", 0).contains("equations of motion"));
    // What has errors has no equations.
    let mut client = Client::open(&example("cart").replace("moves x", "moves z"));
    assert!(!hover(&mut client, "rod   {", 0).contains("equations of motion"));
}

/// The gas pushes with 1200 N: the main bearing takes them along and 5/12 of them across, the cylinder the latter alone; a pivot that
/// turns has no moment, and the cylinder's passes through its middle.
#[test]
fn a_joint_shows_what_it_carries_at_rest() {
    let mut client = Client::open(&example("slider_crank"));
    let main = hover(&mut client, "main:", 0);
    assert!(main.contains("`main` carries at rest: `fx` = 1200 N, `fy` = -500 N\n"), "{main}");
    let cylinder = hover(&mut client, "cylinder:", 0);
    assert!(cylinder.contains("`fy` = 500 N, `moment` = 0 N*m"), "{cylinder}");
}

#[test]
fn columns_count_in_the_negotiated_encoding() {
    // 𝛼 is two units of UTF-16, four bytes, and in a comment.
    let text = "param a = 1 /* \n/// 𝛼ω\nparam ω = 1 kgg // 𝛼\nbody b { mass = ω, moves x }\n";
    let encodings = |list: Value| json!({ "general": { "positionEncodings": list } });
    for (offered, expected, column) in [
        (json!({}), "utf-16", 12),
        (encodings(json!(["utf-16"])), "utf-16", 12),
        (encodings(json!(["utf-16", "utf-8"])), "utf-8", 13),
    ] {
        let mut client = Client::open_as(text, offered);
        assert_eq!(client.capabilities["capabilities"]["positionEncoding"], expected);
        let findings = client.findings();
        let unit = findings.iter().find(|finding| finding["code"] == "vib::unit::unknown").expect("the unit");
        assert_eq!(unit["range"]["start"], json!({ "line": 2, "character": column }));
    }
}

#[test]
fn findings_come_with_codes_places_and_pages() {
    let mut client = Client::open("param k = 1 N/m\nparam k = 2 N/m\nbody b { mass = 1 kgg, moves x }\n");
    let findings = client.findings();
    let codes = strings(&json!(findings), "code");
    assert_eq!(codes, ["vib::name::duplicate", "vib::unit::unknown"]);
    let (twice, unit) = (&findings[0], &findings[1]);
    assert_eq!(twice["severity"], 1);
    assert_eq!(client.slice(&twice["range"]), "k");
    let other = &twice["relatedInformation"][0];
    assert_eq!(
        (other["location"]["uri"].as_str(), &other["location"]["range"]["start"]["line"]),
        (Some(URI), &json!(0))
    );
    assert_eq!(client.slice(&unit["range"]), "kgg");
    assert_eq!(unit["codeDescription"]["href"], "vibc:/vib::unit::unknown.md");
    assert!(unit["message"].as_str().unwrap().contains("help: "), "{unit}");
    client.change("body b { mass = 1 kg, moves x }\nspring s: ground -- b { k = 1 N/m }\n");
    assert_eq!(client.findings(), Vec::<Value>::new());
    client.change("param unused = 1\nbody b { mass = 1 kg, moves x }\nspring s: ground -- b { k = 1 N/m }\n");
    let unused = client.findings().remove(0);
    assert_eq!((&unused["severity"], &unused["tags"]), (&json!(2), &json!([1])));
    client.tell("textDocument/didClose", client.document());
    assert_eq!(client.hear("textDocument/publishDiagnostics")["diagnostics"], json!([]));
}

#[test]
fn a_page_is_sent_on_request() {
    let mut client = Client::open("");
    let page = client
        .ask("workspace/executeCommand", json!({ "command": "vibc.explain", "arguments": ["vib::unit::missing"] }));
    assert!(page.as_str().unwrap().contains("Fix:"));
    assert_eq!(client.hear("window/showMessage")["message"], page);
    let no = client.refusal("workspace/executeCommand", json!({ "command": "vibc.explain", "arguments": ["x"] }));
    assert!(no.contains("no diagnostic has the code"), "{no}");
}

fn hover(client: &mut Client, mark: &str, nth: usize) -> String {
    let hover = client.ask_at("textDocument/hover", mark, nth);
    hover["contents"]["value"].as_str().unwrap_or_else(|| panic!("nothing at {mark}")).to_string()
}

#[test]
fn the_pointer_shows_values_in_their_unit_and_in_si() {
    let text = OSCILLATOR.lines().take(8).collect::<Vec<_>>().join("\n");
    let mut client = Client::open(&text);
    let k = hover(&mut client, "k / 1", 0);
    assert!(k.contains("**0.1 kN/m** = 100 N/m = 100 kg/s^2 in SI base units") && k.contains("How stiff"), "{k}");
    let w = hover(&mut client, "w = sqrt", 0);
    assert!(w.contains("`w` = **10 1/s**"), "{w}");
    assert!(hover(&mut client, "0.1 kN/m", 0).contains("1 kN/m = 1000 kg/s^2"));
}

/// Bodies that move as one share its energy in proportion to their masses, in whatever coordinate it is reported.
#[test]
fn kinetic_energy_is_of_bodies() {
    let mut client = Client::open(
        "model welded\nbody block { mass = 1 kg, moves x, at = (0, 0) }\nbody box { mass = 3 kg, at = (0, 0) }\n\
         weld w: block@(0, 0) -- box\nspring s: ground -- block { k = 10 N/m, along = x }\n",
    );
    assert!(hover(&mut client, "block {", 0).contains("| 25 % |"));
    assert!(hover(&mut client, "box {", 0).contains("| 75 % |"));
}

#[test]
fn hover_describes_a_part() {
    let mut client = Client::open(&example("cart"));
    let block = hover(&mut client, "block {", 0);
    for fact in ["mass 1 kg", "degrees of freedom: `block.x`", "| 1 | 0.3435 Hz | 26 % |", "| 2 | 0.5964 Hz | 63 % |"] {
        assert!(block.contains(fact), "{fact}: {block}");
    }
    let rod = hover(&mut client, "rod   {", 0);
    assert!(rod.contains("inertia 0.166667 kg*m^2") && rod.contains("centre (0 m, -1 m)"), "{rod}");
    let spring = hover(&mut client, "s: ground", 0);
    assert!(
        spring.contains("k = 10 N/m") && spring.contains("tension 0 N") && spring.contains("| 1 | 0.3435 Hz | 55 % |")
    );
    let keyword = hover(&mut client, "spring", 1);
    assert!(keyword.starts_with("# spring\n\nA linear spring"), "{keyword}");
    assert!(hover(&mut client, "free_length", 0).contains("length without tension"));
}

#[test]
fn hover_explains_the_words_of_noise() {
    let mut client = Client::open(
        "body b { mass = 1 kg, moves y }\nbase lane { moves y } = noise(road(16e-6 m^3, 20 m/s))\n\
         spring s: lane -- b { k = 1 N/m }\ndamper d: lane -- b { c = 1 N*s/m }\n\
         force F: b along y = noise(white 3 N^2/Hz)\noutput y = b.y\n",
    );
    assert!(hover(&mut client, "noise(", 0).contains("power spectral density"));
    assert!(hover(&mut client, "road(", 0).contains("ISO 8608"));
    assert!(hover(&mut client, "white 3", 0).contains("the same at all frequencies"));
}

#[test]
fn a_spring_shows_its_tension_at_rest() {
    // 2 kg hang on 100 N/m with a free length of 0.5 m, drawn 0.4 m long.
    let text = "gravity 10 m/s^2\nbody b { mass = 2 kg, at = (0, -0.4 m), moves y }\nspring s: ground@(0, 0) -- b { k = 100 N/m, free_length = 0.5 m }\n";
    let mut client = Client::open(text);
    let reported = hover(&mut client, "s: ground", 0);
    assert!(
        reported.contains("stretch 0.2 m from its free length, 0.3 m from the drawing, tension 20 N"),
        "{reported}"
    );
}

fn hints(client: &mut Client) -> Vec<(u64, String)> {
    let params = json!({ "textDocument": { "uri": URI }, "range": client.all() });
    let hints = client.ask("textDocument/inlayHint", params);
    let hints = hints.as_array().expect("hints").iter();
    let text = |hint: &Value| hint["label"].as_str().expect("a label").to_string();
    hints.map(|hint| (hint["position"]["line"].as_u64().expect("a line"), text(hint))).collect()
}

#[test]
fn hints_show_frequencies_damping_and_values() {
    let mut client = Client::open(&example("cart"));
    assert_eq!(hints(&mut client), [(6, "2 degrees of freedom: 0.4224 Hz ζ 11.68 %, 0.4849 Hz ζ 62.76 %".to_string())]);
    client.change("let w = 2 * 3 rad/s\nparam n = 2 - 1\nbody b { mass = n * 1 kg, moves x }\nspring s: ground -- b { k = 1 kg * w^2 }\n");
    assert_eq!(
        hints(&mut client),
        [(0, "= 6 rad/s".to_string()), (0, "1 degree of freedom: 0.9549 Hz".into()), (1, "= 1".into())],
        "without a model line they stand behind the first one"
    );
}

/// No digit of what moves about a rest that is not proven, and no tension there.
#[test]
fn a_rest_that_is_not_proven_has_no_hints_of_numbers() {
    let text = "body m { mass = 1 kg, at = (0, 0.1 m), moves y }\n\
        spring a: ground@(-1 m, 0) -- m@(0, 0.1 m) { k = 100 N/m, free_length = 1 m }\n\
        spring b: ground@(1 m, 0) -- m@(0, 0.1 m) { k = 100 N/m, free_length = 1 m }\n\
        body n { mass = 1 kg, moves x }\nspring s: ground -- n { k = 1 N/m }\n";
    let mut client = Client::open(text);
    assert_eq!(hints(&mut client), [(0, "2 degrees of freedom, rest not proven".to_string())]);
    let position = json!({ "line": 1, "character": 7 });
    let hover = client.ask("textDocument/hover", json!({ "textDocument": { "uri": URI }, "position": position }));
    let shown = hover["contents"]["value"].as_str().expect("a page");
    assert!(shown.contains("k = 100 N/m") && !shown.contains("tension") && !shown.contains("Hz"), "{shown}");
}

#[test]
fn hints_show_solutions_and_requirements() {
    let mut client = Client::open(OSCILLATOR);
    let hints = hints(&mut client);
    let at = |line: u64| hints.iter().find(|(at, _)| *at == line).map_or("", |(_, text)| text);
    // k = (2 pi 2 Hz)^2 1 kg = 157.914 N/m.
    assert_eq!(at(0), "1 degree of freedom: 2.000 Hz ζ 5.000 %");
    assert_eq!(at(3), "= 12.5664 1/s");
    assert_eq!(at(8), "k = 0.157914 kN/m");
    assert_eq!(at(9), "✓ 2 Hz, margin 300 %");
    assert_eq!(at(10), "✗ 2 Hz, margin -50 %");
}

#[test]
fn completion_knows_the_place() {
    let text = "point A = (0, 0)
param k = 1 N/m
body block { mass = 1 kg, moves x }
body wheel { mass = 1 kg, inertia = 1 kg*m^2, at = A, turns }
base road { moves y }
spring s: ground -- block { k = k }
force F: block along x
output y = block.x
";
    let mut client = Client::open(text);
    for (added, wanted, unwanted) in [
        ("", vec!["spring", "body", "require"], vec!["block"]),
        ("spring t: ", vec!["block", "wheel", "road", "ground"], vec!["s", "k"]),
        ("spring t: block -- gr", vec!["ground", "wheel"], vec!["k"]),
        ("spring t: block@", vec!["A"], vec!["k", "block"]),
        ("spring t: block -- wheel { ", vec!["k", "along", "preload", "free_length"], vec!["mass", "c"]),
        ("spring t: block -- wheel { k = 1 N/m, ", vec!["along", "preload"], vec!["k"]),
        ("spring t: block -- wheel { k = 10 ", vec!["N/m", "kN/m", "N*m/rad"], vec!["kg", "m"]),
        ("damper t: block -- wheel { c = 10 N", vec!["N*s/m"], vec!["N/m"]),
        ("body b { mass = 1 ", vec!["kg", "g", "lb"], vec!["N/m"]),
        ("body b { mass = ", vec!["k", "sqrt"], vec!["block"]),
        ("body b { moves ", vec!["x", "y", "along"], vec!["k"]),
        ("body b { shape = ", vec!["rod", "disk", "ring", "box"], vec!["harmonic"]),
        ("unbalance U: block { ", vec!["me", "speed", "clockwise"], vec!["k"]),
        ("unbalance U: block { me = 1 kg*m, speed = 3 ", vec!["rpm", "Hz"], vec!["kg"]),
        ("output z ", vec!["in"], vec!["block"]),
        ("output z in ", vec!["mm", "deg", "kN"], vec!["block", "in"]),
        ("output z in N*", vec!["m"], vec!["block"]),
        ("output z in mm = ", vec!["block"], vec!["mm"]),
        ("output z = block.", vec!["x", "vx", "ax"], vec!["y", "angle", "force"]),
        ("output z = wheel.", vec!["angle", "omega", "alpha"], vec!["x"]),
        ("output z = s.", vec!["force", "stretch"], vec!["x"]),
        ("output z = ", vec!["block", "wheel", "s"], vec![]),
        // After a complete operand, Enter ends the line: no list may be open that captures it.
        ("output z = block.x ", vec![], vec!["block", "sqrt", "k"]),
        ("output z = block.x + ", vec!["block"], vec![]),
        ("param q = 2 * k ", vec![], vec!["k", "pi"]),
        ("param q = (k + k) ", vec![], vec!["k", "pi"]),
        ("solve k in ", vec!["k", "pi"], vec![]),
        ("force G: block along x = ", vec!["harmonic", "step"], vec!["frequency"]),
        ("force G: block along x = harmonic(1 N, 2 ", vec!["Hz", "rad/s"], vec!["N"]),
        ("force G: block along x = n", vec!["noise"], vec!["frequency"]),
        ("force G: block along x = noise(", vec!["white", "table", "road"], vec!["harmonic", "block"]),
        ("force G: block along x = noise(white 3 ", vec!["N^2/Hz"], vec!["N", "m^2/Hz"]),
        ("base b { moves y } = noise(3 ", vec!["m^2/Hz", "g0^2/Hz"], vec!["N^2/Hz"]),
        ("force G: block along x = noise(3 N^2/Hz, 2 ", vec!["Hz"], vec!["N"]),
        ("force G: block along x = noise((2 ", vec!["Hz"], vec!["N^2/Hz", "N"]),
        ("force G: block along x = noise((2 Hz, 3 N^2/Hz), (4 Hz, 5 ", vec!["N^2/Hz"], vec!["N", "Hz", "m^2/Hz"]),
        ("base b { moves y } = spectrum((2 Hz, 3 ", vec!["m/s^2", "g0"], vec!["Hz", "kg"]),
        ("require ", vec!["frequency", "gain", "stable", "rms", "crossings", "psd"], vec!["harmonic"]),
        ("require psd(", vec!["y"], vec!["F"]),
        ("require gain(", vec!["F", "road"], vec!["y"]),
        ("require gain(F -> ", vec!["y", "block"], vec!["F"]),
        ("repeat i in 1..3 {\n body m[", vec!["i"], vec![]),
        ("damping ", vec!["modal", "rayleigh"], vec!["k"]),
        ("initial ", vec!["block"], vec!["road", "s"]),
        ("gravity 9.81 ", vec!["m/s^2", "g0"], vec!["kg"]),
        ("param q = 1 // ", vec![], vec!["kg", "k", "spring"]),
    ] {
        client.change(&format!("{text}{added}"));
        let params = json!({ "textDocument": { "uri": URI }, "position": client.position(client.text.len()) });
        let labels = strings(&client.ask("textDocument/completion", params), "label");
        for word in wanted {
            assert!(labels.iter().any(|label| label == word), "`{added}` wants `{word}`: {labels:?}");
        }
        for word in unwanted {
            assert!(!labels.iter().any(|label| label == word), "`{added}` has no `{word}`: {labels:?}");
        }
    }
}

#[test]
fn an_output_shows_its_unit() {
    let model = "body b { mass = 1 kg, moves x }\nspring s: ground -- b { k = 1 N/m }\noutput x in mm = b.x\n";
    let mut client = Client::open(model);
    assert!(hover(&mut client, "mm", 0).contains("1 mm = 0.001 m"));
}

#[test]
fn a_completion_replaces_the_typed_prefix() {
    let mut client = Client::open("spring t: ground -- block { k = 10 kN");
    let items = client.ask("textDocument/completion", client.behind("10 kN"));
    let item = items.as_array().unwrap().iter().find(|item| item["label"] == "kN/m").expect("kN/m").clone();
    let text = applied(&client.text, &[item["textEdit"].clone()]);
    assert_eq!(text, "spring t: ground -- block { k = 10 kN/m");
}

/// `param k` and `spring k` are two names, and each index belongs to its own `repeat`.
const NAMES: &str = "param k = 1 N/m
body m[1] { mass = 1 kg, moves x }
spring k: ground -- m[1] { k = k }
repeat i in 2..3 {
  body m[i] { mass = 1 kg, moves x }
  spring s[i]: m[i-1] -- m[i] { k = k }
}
repeat i in 1..3 {
  output y[i] = m[i].x + k.stretch
}
";

#[test]
fn names_lead_to_their_declarations() {
    let mut client = Client::open(NAMES);
    let lines = |places: Value| -> Vec<u64> {
        places.as_array().unwrap().iter().map(|place| place["range"]["start"]["line"].as_u64().unwrap()).collect()
    };
    let parameter = client.ask_at("textDocument/definition", "k }", 1);
    assert_eq!(lines(parameter), [0]);
    let spring = client.ask_at("textDocument/definition", "k.stretch", 0);
    assert_eq!(lines(spring), [2]);
    let bodies = client.ask_at("textDocument/definition", "m[i].x", 0);
    assert_eq!(lines(bodies), [1, 4]);
    let index = client.ask_at("textDocument/definition", "i].x", 0);
    assert_eq!(lines(index), [7]);
    let mut params = client.at("k = 1 N/m", 0);
    params["context"] = json!({ "includeDeclaration": false });
    assert_eq!(lines(client.ask("textDocument/references", params.clone())), [2, 5]);
    params["context"] = json!({ "includeDeclaration": true });
    assert_eq!(lines(client.ask("textDocument/references", params)), [0, 2, 5]);
    assert_eq!(lines(client.ask_at("textDocument/documentHighlight", "k:", 0)), [2, 8]);
}

#[test]
fn a_name_is_renamed_everywhere() {
    let mut client = Client::open(NAMES);
    let rename = |client: &mut Client, mark: &str, new: &str| {
        let mut params = client.at(mark, 0);
        params["newName"] = json!(new);
        let edit = client.ask("textDocument/rename", params);
        client.edited(&edit)
    };
    let renamed = rename(&mut client, "k = 1 N/m", "stiffness");
    assert_eq!(renamed, NAMES.replace("param k", "param stiffness").replace("k = k", "k = stiffness"));
    let renamed = rename(&mut client, "i in 2", "j");
    let (head, tail) = NAMES.split_at(NAMES.find("repeat i in 1").unwrap());
    let swapped = head.replace("[i", "[j").replace("repeat i", "repeat j");
    assert_eq!(renamed, swapped + tail);
    let prepared = client.ask_at("textDocument/prepareRename", "k:", 0);
    assert_eq!(prepared["placeholder"], "k");
    assert!(client.ask_at("textDocument/prepareRename", "moves", 0).is_null());
    for (mark, new, reason) in [
        ("k = 1 N/m", "2k", "is not a name"),
        ("k = 1 N/m", "sqrt", "a word of the language"),
        ("m[1]", "k", "is declared already"),
        ("m[1]", "ground", "a word of the language"),
        ("i in 2", "k", "is declared already"),
        ("mass", "weight", "there is no name here"),
    ] {
        let mut params = client.at(mark, 0);
        params["newName"] = json!(new);
        let reported = client.refusal("textDocument/rename", params);
        assert!(reported.contains(reason), "{mark} to {new}: {reported}");
    }
}

#[test]
fn the_outline_has_every_declaration() {
    let mut client = Client::open(NAMES);
    let symbols = client.ask("textDocument/documentSymbol", client.document());
    assert_eq!(strings(&symbols, "name"), ["k", "m[1]", "k", "i", "i"]);
    assert_eq!(strings(&symbols, "detail"), ["param", "body", "spring", "repeat", "repeat"]);
    assert_eq!(strings(&symbols[3]["children"], "name"), ["m[i]", "s[i]"]);
    assert_eq!(client.slice(&symbols[2]["selectionRange"]), "k");
    assert!(client.slice(&symbols[3]["range"]).ends_with('}'));
}

#[test]
fn repeats_fields_and_comments_fold() {
    let mut client = Client::open(&format!("// one\n// two\n{NAMES}body b {{\n  mass = 1 kg\n  moves x\n}}\n"));
    let folds = client.ask("textDocument/foldingRange", client.document());
    let folds: Vec<(u64, u64)> = folds
        .as_array()
        .unwrap()
        .iter()
        .map(|fold| (fold["startLine"].as_u64().unwrap(), fold["endLine"].as_u64().unwrap()))
        .collect();
    assert_eq!(folds, [(0, 1), (5, 8), (9, 11), (12, 15)]);
}

#[test]
fn every_word_and_number_has_a_colour() {
    let mut client = Client::open(NAMES);
    let legend = client.capabilities["capabilities"]["semanticTokensProvider"]["legend"]["tokenTypes"].clone();
    let answer = client.ask("textDocument/semanticTokens/full", client.document());
    let data: Vec<u64> = answer["data"].as_array().unwrap().iter().map(|n| n.as_u64().unwrap()).collect();
    let lines: Vec<&str> = NAMES.lines().collect();
    let (mut line, mut column, mut seen) = (0, 0, Vec::new());
    for token in data.chunks(5) {
        column = if token[0] == 0 { column + token[1] as usize } else { token[1] as usize };
        line += token[0] as usize;
        let kind = legend[token[3] as usize].as_str().unwrap();
        seen.push((&lines[line][column..column + token[2] as usize], kind));
    }
    let first: Vec<(&str, &str)> = seen[..6].to_vec();
    assert_eq!(
        first,
        [
            ("param", "keyword"),
            ("k", "variable"),
            ("=", "operator"),
            ("1", "number"),
            ("N/m", "type"),
            ("body", "keyword")
        ]
    );
    let words = |text: &str| text.split(|c: char| !c.is_alphanumeric() && c != '/').filter(|w| !w.is_empty()).count();
    let coloured = seen.iter().filter(|(text, _)| words(text) == 1).count();
    assert_eq!(coloured, words(NAMES), "{seen:?}");
}

#[test]
fn a_text_is_formatted_unless_it_has_a_syntax_error() {
    let loose = "model  m\n\nparam k=1 N/m\nparam mass = 1 kg\nbody b{mass=mass,moves x}\n";
    let mut client = Client::open(loose);
    let options = json!({ "textDocument": { "uri": URI }, "options": { "tabSize": 2, "insertSpaces": true } });
    let edits = client.ask("textDocument/formatting", options.clone());
    let laid_out = applied(loose, edits.as_array().unwrap());
    let mut sources = Sources::new();
    let file = sources.add(SourceFile::model("m.vib", loose));
    assert_eq!(Some(laid_out.as_str()), vibc::format(&sources, file).answer.as_deref());
    client.change(&laid_out);
    assert_eq!(client.ask("textDocument/formatting", options.clone()), json!([]));
    client.change("param k = \n");
    assert!(client.ask("textDocument/formatting", options).is_null());
    let messages = client.hear("window/showMessage")["message"].to_string();
    assert!(messages.contains("fix the syntax error in line 1 first"), "{messages}");
}

#[test]
fn unknown_requests_are_refused_and_the_server_continues() {
    let mut client = Client::open("param k = 1 N/m\n");
    assert!(client.refusal("textDocument/unheardOf", json!({})).contains("is not known"));
    client.refusal("textDocument/hover", json!({ "textDocument": 3 }));
    let elsewhere =
        json!({ "textDocument": { "uri": "file:///other.vib" }, "position": { "line": 0, "character": 0 } });
    assert!(client.refusal("textDocument/hover", elsewhere).contains("is not open"));
    let beyond = json!({ "textDocument": { "uri": URI }, "position": { "line": 99, "character": 99 } });
    assert!(client.ask("textDocument/hover", beyond).is_null());
    assert!(hover(&mut client, "k =", 0).contains("1 N/m"));
}

/// The poles of a thousand masses with a few dampers are not computed: their frequencies are shown as undamped ones.
#[test]
fn missing_poles_are_not_shown() {
    let chain = "body m[1] { mass = 1 kg, moves x }
spring k[1]: ground -- m[1] { k = 100 N/m }
repeat i in 2..1000 {
  body m[i] { mass = 1 kg, moves x }
  spring k[i]: m[i-1] -- m[i] { k = 100 N/m }
  damper d[i]: m[i-1] -- m[i] { c = 0.1 N*s/m }
}
";
    let mut client = Client::open_as(chain, json!({ "workspace": { "inlayHint": { "refreshSupport": true } } }));
    client.hear("workspace/inlayHint/refresh");
    let label = &hints(&mut client)[0].1;
    assert!(label.starts_with("1000 degrees of freedom, undamped: 0.002499 Hz, ") || label.contains('ζ'), "{label}");
}

/// Thirty-one damped masses: more than are analysed between two keystrokes.
#[test]
fn damping_of_larger_scenes_comes_when_it_is_there() {
    let chain = "body m[1] { mass = 1 kg, moves x }
spring k[1]: ground -- m[1] { k = 100 N/m }
damper d: ground -- m[1] { c = 1 N*s/m }
repeat i in 2..31 {
  body m[i] { mass = 1 kg, moves x }
  spring k[i]: m[i-1] -- m[i] { k = 100 N/m }
}
";
    let mut client = Client::open_as(chain, json!({ "workspace": { "inlayHint": { "refreshSupport": true } } }));
    client.hear("workspace/inlayHint/refresh");
    let label = &hints(&mut client)[0].1;
    assert!(label.starts_with("31 degrees of freedom: ") && label.contains('ζ'), "{label}");
}

/// The page beside a text: figure, modes; while the text has errors the last figure stays and the errors stand over it.
#[test]
fn the_preview_is_fresh_and_outlives_errors() {
    let mut client =
        Client::open("model m\nbody block { mass = 2 kg, moves x }\nspring s: ground -- block { k = 200 N/m }\n");
    let page = |client: &mut Client| {
        let params = client.document();
        client.ask("vibc/page", params)["html"].as_str().expect("a page").to_string()
    };
    let first = page(&mut client);
    assert!(first.contains("class=\"vibc-figure\"") && first.contains("1.592"), "sqrt(100) / 2 pi Hz");
    assert!(!first.contains("id=\"L1\""), "the text stands in the editor");
    client.change("model m\nbody block { mass = 2 kg, moves x }\nspring s: ground -- block { k = 800 N/m }\n");
    assert!(page(&mut client).contains("3.183"), "sqrt(400) / 2 pi Hz");
    client.change("model m\n\nbody block { mass = 2 kg, moves x }\nspring s: ground -- block { k = 800 N }\n");
    let broken = page(&mut client);
    assert!(broken.contains("role=\"alert\"") && broken.contains("line 4"), "the error at its line");
    assert!(broken.contains("class=\"vibc-figure\"") && broken.contains("3.183"), "the last figure");
}

/// Root mean squares under noise, and maxima under a response spectrum, of the text as it stands.
#[test]
fn the_preview_has_noise_and_spectra() {
    let scene = |signal: &str| {
        format!(
            "model m\nbase g {{ moves x }} = {signal}\nbody b {{ mass = 2 kg, moves x }}\nspring s: g -- b {{ k = 200 N/m }}\n\
             damper d: g -- b {{ c = 2 N*s/m }}\noutput pull = s.force\n"
        )
    };
    let mut client = Client::open(&scene("noise(white 3 m^2/s^4/Hz)"));
    let page = |client: &mut Client| {
        let params = client.document();
        client.ask("vibc/page", params)["html"].as_str().expect("a page").to_string()
    };
    // k^2 m^2 S / (4 c k), c = 2 N*s/m: sqrt(300) N
    let first = page(&mut client);
    assert!(first.contains("stationary response to noise") && first.contains("17.3205"), "{first}");
    client.change(&scene("noise(white 12 m^2/s^4/Hz)"));
    assert!(page(&mut client).contains("34.6410"), "twice as much");
    client.change(&scene("spectrum((0.5 Hz, 4 m/s^2), (9 Hz, 4 m/s^2), damping = 5 %)"));
    let spectral = page(&mut client);
    assert!(spectral.contains("maxima under response spectra") && spectral.contains("8.00000"), "{spectral}");
}

/// A scene whose poles take longer than a key stroke has its figure and modes at once, and the poles when they are there.
#[test]
fn the_preview_does_not_wait_for_poles() {
    let chain = |k: u32| {
        format!(
            "body m[1] {{ mass = 1 kg, moves x }}\nspring k[1]: ground -- m[1] {{ k = {k} N/m }}\n\
             damper d: ground -- m[1] {{ c = 1 N*s/m }}\nrepeat i in 2..31 {{\nbody m[i] {{ mass = 1 kg, moves x }}\n\
             spring k[i]: m[i-1] -- m[i] {{ k = {k} N/m }}\n}}\n"
        )
    };
    let mut client = Client::open_as(&chain(100), json!({ "workspace": { "inlayHint": { "refreshSupport": true } } }));
    let page = |client: &mut Client| {
        let params = client.document();
        client.ask("vibc/page", params)["html"].as_str().expect("a page").to_string()
    };
    let first = page(&mut client);
    // 2 sqrt(k/m) sin(pi/126) / 2 pi
    assert!(first.contains("class=\"vibc-figure\"") && first.contains("0.0793"), "the first mode");
    assert!(!first.contains("Damped motion"), "nothing is said of poles that are on their way");
    client.hear("workspace/inlayHint/refresh");
    let second = page(&mut client);
    assert!(second.contains("Damped motion") && second.contains("ζ"), "the poles");
}

/// The function whose arguments are typed, the innermost one, and which argument it is.
#[test]
fn signatures_are_those_of_the_innermost_call() {
    let text = "model m\nbody b { mass = 1 kg, moves x }\nspring s: ground -- b { k = 1 N/m }\nforce f: b along x = step(10 N, sqrt(4) * 1 s)\n";
    let mut client = Client::open(text);
    let mut at = |mark: &str| {
        let found = client.ask("textDocument/signatureHelp", client.behind(mark));
        let label = found["signatures"][0]["label"].as_str().unwrap_or_default().to_string();
        (label, found["activeParameter"].as_u64())
    };
    assert_eq!(at("step(").0, "step(a, at)");
    assert_eq!(at("step(").1, Some(0));
    assert_eq!(at("10 N, ").1, Some(1));
    assert!(at("sqrt(").0.starts_with("sqrt("));
    assert_eq!(at("sqrt(4) * ").0, "step(a, at)");
    assert_eq!(at("moves x"), (String::new(), None));
}
