//! The code follows ARCHITECTURE.md: what may import what, and what no file may do.

use crate::models::SOURCES;
use std::collections::HashSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// A source file, without its comments and its unit tests.
struct Source {
    /// Path relative to its `src`.
    path: PathBuf,
    first_line: String,
    code: String,
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn sources() -> Vec<Source> {
    let mut all = Vec::new();
    for folder in SOURCES {
        let mut files = Vec::new();
        collect(&root().join(folder), &mut files);
        assert!(files.len() > 30, "the sources are where they are looked for");
        all.extend(files.iter().map(|file| source(&root().join(folder), file)));
    }
    all.sort_by(|a, b| a.path.cmp(&b.path));
    all
}

fn collect(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("a folder of sources") {
        let path = entry.expect("an entry of the folder").path();
        if path.is_dir() {
            collect(&path, files);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
}

fn source(folder: &Path, file: &Path) -> Source {
    let text = fs::read_to_string(file).expect("a source");
    let shipped = text.split("\n#[cfg(test)]\nmod tests {").next().unwrap_or_default();
    let code: Vec<&str> = shipped.lines().filter(|line| !line.trim_start().starts_with("//")).collect();
    Source {
        path: file.strip_prefix(folder).expect("a file below src").to_path_buf(),
        first_line: text.lines().next().unwrap_or_default().to_string(),
        code: code.join("\n"),
    }
}

/// The first folder of a path below `src`; `None` for the files in `src` itself.
fn layer(path: &Path) -> Option<String> {
    let mut parts = path.components();
    let first = parts.next()?.as_os_str().to_string_lossy().into_owned();
    parts.next().map(|_| first)
}

/// Each folder with what it may import, from the fenced table of ARCHITECTURE.md.
fn table() -> Vec<(String, Vec<String>)> {
    let text = fs::read_to_string(root().join("ARCHITECTURE.md")).expect("ARCHITECTURE.md");
    let table = text.split("```imports\n").nth(1).and_then(|rest| rest.split("```").next()).expect("a block `imports`");
    let rows = table.lines().map(|line| line.split_whitespace().map(String::from).collect::<Vec<_>>());
    rows.map(|mut row| (row.remove(0), row)).collect()
}

/// The path after each `crate::` in a text: `model::scene::Scene`, and one for each member of `use crate::{a, b}`.
fn imports(code: &str) -> Vec<String> {
    let mut found = Vec::new();
    for rest in code.split("crate::").skip(1) {
        match rest.strip_prefix('{') {
            Some(group) => {
                let group: String = group.chars().take_while(|c| *c != ';').collect();
                let depth_one = group.split(',').map(|member| member.trim_start_matches(['{', ' ', '\n']).trim());
                found.extend(depth_one.map(path_at_start));
            }
            None => found.extend(members(rest)),
        }
    }
    found.retain(|path| !path.is_empty());
    found
}

/// `model::scene::{Body, Joint}` names two paths with one prefix; only the prefix matters.
fn members(rest: &str) -> Vec<String> {
    let prefix = path_at_start(rest);
    let after = &rest[prefix.len().min(rest.len())..];
    match after.strip_prefix("::{") {
        Some(group) => {
            let group: String = group.chars().take_while(|c| *c != '}').collect();
            group.split(',').map(|member| format!("{prefix}::{}", path_at_start(member.trim()))).collect()
        }
        None => vec![prefix],
    }
}

fn path_at_start(text: &str) -> String {
    let path: String = text.chars().take_while(|c| c.is_alphanumeric() || *c == '_' || *c == ':').collect();
    path.trim_end_matches(':').to_string()
}

fn allowed(import: &str, own: &str, table: &[String]) -> bool {
    let below = |prefix: &str| import == prefix || import.starts_with(&format!("{prefix}::"));
    below(own) || table.iter().any(|prefix| below(prefix))
}

#[test]
fn folders_import_what_the_table_names() {
    let table = table();
    let mut wrong = Vec::new();
    let mut seen = Vec::new();
    let mut used: Vec<(String, String)> = Vec::new();
    for source in sources() {
        let Some(layer) = layer(&source.path) else { continue };
        let Some((own, row)) = table.iter().find(|(name, _)| *name == layer) else {
            panic!("{layer} has no line in the table of ARCHITECTURE.md");
        };
        for import in imports(&source.code) {
            if !allowed(&import, own, row) {
                wrong.push(format!("{} imports {import}", source.path.display()));
            }
            used.push((layer.clone(), import));
        }
        seen.push(layer);
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    for (name, _) in &table {
        assert!(seen.contains(name), "{name} is in the table and not in src");
    }
    for (name, row) in &table {
        for entry in row {
            let uses = used.iter().any(|(layer, import)| layer == name && allowed(import, entry, &[]));
            assert!(uses, "{name} may import {entry} and does not");
        }
    }
}

#[test]
fn the_scanner_sees_every_form_of_import() {
    let code = "use crate::model::scene::{Body, Joint};\nfn f() { crate::lower::rest::find() }\nuse crate::{base, system::Form};";
    let expected = ["model::scene::Body", "model::scene::Joint", "lower::rest::find", "base", "system::Form"];
    assert_eq!(imports(code), expected);
    assert!(allowed("model::scene::Body", "joints", &["model::scene".to_string()]));
    assert!(!allowed("model::scenery", "joints", &["model::scene".to_string()]));
}

/// Files, streams, the clock and the environment belong to the program, not to the library.
#[test]
fn only_main_touches_the_world() {
    let world = [
        "std::fs",
        "std::io",
        "std::net",
        "std::env::",
        "std::process",
        "std::time",
        "std::thread::sleep",
        "File::open",
        "File::create",
        "println!",
        "eprintln!",
        "print!(",
        "Instant::",
        "SystemTime",
    ];
    let program = [
        "main.rs",
        "emitting.rs",
        "files.rs",
        "merging.rs",
        "named.rs",
        "parts.rs",
        "sweeping.rs",
        "terminal.rs",
        "transport.rs",
        "watch.rs",
    ]
    .map(Path::new);
    for source in sources().iter().filter(|source| !program.contains(&source.path.as_path())) {
        for word in world {
            assert!(!source.code.contains(word), "{} uses {word}", source.path.display());
        }
    }
}

/// The library's interface is what `src/lib.rs` declares public or re-exports; the layers below are hidden.
#[test]
fn the_interface_is_small() {
    let text = fs::read_to_string(root().join("src/lib.rs")).expect("src/lib.rs");
    let lines: Vec<&str> = text.lines().collect();
    for (number, line) in lines.iter().enumerate().filter(|(_, line)| line.starts_with("pub mod ")) {
        let before = &lines[number - 2..number];
        assert_eq!(before, ["#[cfg(feature = \"program\")]", "#[doc(hidden)]"], "{line}");
    }
    let declared = lines.iter().enumerate().filter(|(_, line)| {
        ["pub fn ", "pub struct ", "pub enum ", "pub type "].iter().any(|item| line.starts_with(item))
    });
    let mut items = 0;
    for (number, line) in declared {
        let is_attribute = |line: &&str| line.starts_with("#[");
        let above = lines[..number].iter().rev().find(|line| !is_attribute(line)).expect("a line above");
        assert!(above.starts_with("/// "), "{line} has no documentation");
        // For the program alone.
        if lines[number - 1] != "#[doc(hidden)]" {
            items += 1;
        }
    }
    let texts: Vec<&str> = text.split("\npub use ").collect();
    for pair in texts.windows(2).filter(|pair| !pair[0].ends_with("#[doc(hidden)]")) {
        let group = pair[1].split(';').next().expect("an end");
        assert!(!group.contains('*'), "{group}");
        items += group
            .rsplit('{')
            .next()
            .expect("a last part")
            .split(',')
            .filter(|name| name.contains(char::is_alphabetic))
            .count();
    }
    assert!((80..150).contains(&items), "{items} items");
}

#[test]
fn every_file_says_what_it_is_for() {
    for source in sources() {
        assert!(source.first_line.starts_with("//! "), "{} opens without //!", source.path.display());
        let name = source.path.file_stem().unwrap().to_string_lossy().into_owned();
        let vague = ["utils", "util", "helpers", "helper", "common", "misc", "more", "stuff"];
        assert!(!vague.contains(&name.as_str()), "{} has not been understood yet", source.path.display());
    }
}

/// Results for programs are made of `JsonNumber` or integers: a field for any binary64 number would let one be written
/// without deciding whether it has a bound.
#[test]
fn no_bare_number_leaves_in_json() {
    let mut seen = 0;
    for source in sources() {
        // The only type that holds a number for JSON; it requires that decision.
        if source.path == Path::new("backend/json_number.rs") {
            continue;
        }
        for item in serialised(&source.code) {
            assert!(!has_bare_number(item), "{} serialises a bare number: {item}", source.path.display());
            seen += 1;
        }
        assert!(!source.code.contains("serialize_f"), "{} serialises a bare number", source.path.display());
    }
    assert!(seen > 20, "{seen} serialised items: this test looks for them in the wrong way");
}

/// The items that derive `Serialize`, each from its derive to its end.
fn serialised(code: &str) -> Vec<&str> {
    let derives = code.match_indices("#[derive(").filter(|(at, _)| {
        code[*at..]
            .split(")]")
            .next()
            .is_some_and(|derive| derive.ends_with("Serialize") || derive.contains("Serialize,"))
    });
    derives
        .map(|(at, _)| code[at..].split("\n}").next().unwrap_or_default().split(");\n").next().unwrap_or_default())
        .collect()
}

fn has_bare_number(item: &str) -> bool {
    item.contains("f64") || item.contains("f32") || item.contains("Dd") || item.contains("Ball")
}

#[test]
fn every_form_of_a_bare_number_is_seen() {
    let code = "#[derive(serde::Serialize)]\nstruct A {\n    x: Option<f64>,\n}\n#[derive(Debug, Serialize, Clone)]\nstruct B(Vec<f64>);\nstruct C(f64);\n#[derive(Serialize)]\nstruct D<'a> {\n    x: &'a str,\n}\n";
    let items = serialised(code);
    assert_eq!(items.iter().map(|item| has_bare_number(item)).collect::<Vec<_>>(), [true, true, false]);
}

/// JSON that is built value by value has no types that could be looked at: the language server's messages, which have no
/// results, and what a page's script draws, whose numbers are rounded to the digits of a picture.
#[test]
fn json_without_types_is_for_messages_and_pictures() {
    let known = ["backend/page/payload.rs", "editor/server/", "transport.rs"];
    let words = ["json!(", "serde_json::Value", "serde_json::{Value", "serde_json::{Map", "serde_json::Map"];
    let mut seen = 0;
    for source in sources() {
        let path = source.path.display().to_string();
        let untyped = words.iter().any(|word| source.code.contains(word));
        assert!(!untyped || known.iter().any(|known| path.starts_with(known)), "{path} builds JSON without a type");
        seen += usize::from(untyped);
    }
    assert!(seen >= known.len(), "{seen} files: this test looks for them in the wrong way");
}

/// Displacements of a mode shape have no bound: they are written through `normalise`, which marks them.
#[test]
fn shapes_leave_as_unproven_numbers() {
    for source in
        sources().iter().filter(|source| layer(&source.path).is_some_and(|layer| PRINTING.contains(&&layer[..])))
    {
        for field in ["mode.shape", "modes.shape", "m.shape"] {
            assert!(!source.code.contains(field), "{} reads a shape without `normalise`", source.path.display());
        }
    }
}

/// The layers that write numbers.
const PRINTING: [&str; 3] = ["answers", "backend", "editor"];

/// The packages that the program is built from, as cargo counts them.
#[test]
#[cfg(target_os = "linux")]
fn the_count_of_packages_is_right() {
    let count = |more: &[&str]| {
        let mut cargo = Command::new(env!("CARGO"));
        let tree = ["tree", "--locked", "--offline", "--prefix", "none", "-e", "normal"];
        let output = cargo.current_dir(root()).args(tree).args(more).output().expect("cargo");
        let text = String::from_utf8(output.stdout).expect("UTF-8");
        // The program's own crates are listed with their folders.
        let others = text.lines().filter(|line| !line.is_empty() && !line.contains(" (/"));
        others.map(|line| line.split(' ').take(2).collect()).collect::<HashSet<Vec<&str>>>().len()
    };
    let text = fs::read_to_string(root().join("ARCHITECTURE.md")).expect("ARCHITECTURE.md");
    let (all, library) = (count(&[]), count(&["--no-default-features"]));
    assert!(text.contains(&format!("{all} packages in all on Linux")), "{all}");
    assert!(text.contains(&format!("({library} without the feature `program`)")), "{library}");
}

/// What prints passes enclosures and bounds on. It makes none of a bare number: an enclosure there is a ball that a stage
/// has made, or an exact number (a factor, the end of a range that was asked for), and a bound is one of an enclosure.
#[test]
fn what_prints_makes_no_enclosure_and_no_bound() {
    for source in sources() {
        let prints = layer(&source.path).is_none_or(|layer| PRINTING.contains(&&layer[..]));
        // Instances for unit tests, which do not ship.
        if prints && source.path != Path::new("answers/samples.rs") {
            let made = enclosures_of_bare_numbers(&source.code);
            assert!(made.is_empty(), "{}: {}", source.path.display(), made.join(", "));
        }
    }
}

/// The places in code that call a number exact, give it a radius of their own, or call it a bound.
fn enclosures_of_bare_numbers(code: &str) -> Vec<&str> {
    /// Numbers that are exact as they stand: the ends of a range that was asked for or is named by a grid, a factor, and
    /// the decimal that is printed for a sample, whose distance from the sample is added to its radius.
    const EXACT: [&str; 4] = ["hertz", "*end", "factor", "settled"];
    let constructors = ["Ball::exact", "Ball::new", "Ball {", "Ball::from", "Bound::by_proof"];
    let mut found = Vec::new();
    for constructor in constructors {
        for (at, _) in code.match_indices(constructor) {
            let is_word = code[..at].chars().next_back().is_none_or(|c| !c.is_alphanumeric() && c != '_' && c != ':');
            let place = code[at..].lines().next().unwrap_or_default();
            let argument = place[constructor.len()..].trim_start_matches('(').split(')').next().unwrap_or_default();
            let is_literal = argument.starts_with(|c: char| c.is_ascii_digit());
            if is_word && !(constructor == "Ball::from" && (is_literal || EXACT.contains(&argument))) {
                found.push(place);
            }
        }
    }
    found
}

#[test]
fn every_way_to_call_a_number_proved_is_seen() {
    let code = "Ball::exact(mid)\nBall::new(mid, 0.0)\nBall { mid, rad }\nBall::from(x)\nf(Bound::by_proof(x))";
    assert_eq!(enclosures_of_bare_numbers(code).len(), 5);
    let code = "Ball::from(100.0)\nBall::from(hertz)\nBound::relative(ball)\nFigure::bound(bound)";
    assert!(enclosures_of_bare_numbers(code).is_empty());
}

/// In the modal report each number is about the rest, which may lack a proof: its bounds are made by `Bounds`, which knows
/// that, and by nothing else. (The text's are forgotten in one place, whatever the section.)
#[test]
fn bounds_of_the_modal_report_know_whether_the_rest_is_proven() {
    for source in sources() {
        let modal = ["backend/json.rs", "backend/json_questions.rs", "backend/json_spectra.rs"]
            .map(Path::new)
            .contains(&source.path.as_path());
        for word in ["JsonNumber::bound", "JsonNumber::relative_bound", "JsonNumber::absolute_bound", "certain("] {
            let uses = source.code.matches(word).count();
            // Certain digits are written by one function, which asks first.
            assert!(!modal || uses <= usize::from(word == "certain("), "{}: {word}", source.path.display());
        }
    }
}

/// Participles and adverbs that do not end in `ed` or `ly`. Words that are verbs or prepositions as well are not among them: `read`,
/// `set`, `over`.
const IRREGULAR: [&str; 32] = [
    "again",
    "alone",
    "apart",
    "broken",
    "built",
    "chosen",
    "drawn",
    "felt",
    "forbidden",
    "found",
    "given",
    "grown",
    "held",
    "hidden",
    "kept",
    "known",
    "left",
    "lost",
    "made",
    "met",
    "nothing",
    "proven",
    "said",
    "seen",
    "several",
    "shown",
    "still",
    "swept",
    "taken",
    "together",
    "told",
    "written",
];

/// Verbs and nouns that look like participles or adverbs.
const NO_PARTICIPLES: [&str; 7] = ["apply", "embed", "family", "feed", "multiply", "seed", "speed"];

fn is_participle(name: &str) -> bool {
    let looks = name.ends_with("ed") || name.ends_with("ly") || IRREGULAR.contains(&name);
    looks && !name.contains('_') && !NO_PARTICIPLES.contains(&name)
}

/// The names of the functions that a text declares.
fn functions(code: &str) -> impl Iterator<Item = &str> {
    code.split("fn ").skip(1).map(|rest| {
        let end = rest.find(|c: char| !c.is_ascii_alphanumeric() && c != '_').unwrap_or(rest.len());
        &rest[..end]
    })
}

/// docs/style.md: functions are verbs or name their result.
#[test]
fn no_function_is_a_bare_participle_or_adverb() {
    for source in sources() {
        for name in functions(&source.code) {
            assert!(!is_participle(name), "{}: `fn {name}`", source.path.display());
        }
    }
}

#[test]
fn participles_are_seen() {
    assert_eq!(functions("pub fn told(x: u8) {}\nfn to_told<T>() {}").collect::<Vec<_>>(), ["told", "to_told"]);
    assert!(["together", "lowered", "exactly", "shown"].iter().all(|name| is_participle(name)));
    assert!(!["apply", "read", "lowered_system", "over", "seed"].iter().any(|name| is_participle(name)));
}

/// Files that sort lists as long as the scene by a closure, for which the standard library's sort is compiled once more.
const LONG_SORTS: [&str; 8] = [
    "analysis/modes/mesh/network.rs",
    "analysis/modes/shape.rs",
    "analysis/modes/tree/forest.rs",
    "analysis/nets.rs",
    "base/order.rs",
    "lower/kinematics/numbering.rs",
    "lower/rest/definite.rs",
    "merging.rs",
];

#[test]
fn short_lists_share_one_sort() {
    let sorts = ["sort_by(|", "sort_by_key(", "sort_unstable_by(|", "sort_unstable_by_key("];
    let users = sources().into_iter().filter(|source| sorts.iter().any(|sort| source.code.contains(sort)));
    let users: Vec<String> = users.map(|source| source.path.to_string_lossy().into_owned()).collect();
    assert_eq!(users, LONG_SORTS, "`OrderBy` sorts, unless the list is as long as the scene");
}
