//! The table of kinds is the only place for its words: word lists outside the program are generated from it, and no
//! other file of the program has its own list.
//!
//! `VIBC_WRITE_WORDS=1 cargo test --test suite kinds::` writes the lists; without the variable the test compares them.

use crate::models::SOURCES;
use std::fs;
use std::path::Path;
use vibc::base::{Field, Takes};
use vibc::kinds::functions::{self, FunctionKind};
use vibc::kinds::{DECLARATIONS, Declaration, Piece, Shape};

/// A list of words in a file: it ends before `after` and starts after the last `before` that precedes it.
struct List {
    file: &'static str,
    before: &'static str,
    after: &'static str,
    words: String,
}

fn keywords(of: impl Fn(&Declaration) -> bool) -> Vec<&'static str> {
    DECLARATIONS.iter().filter(|declaration| of(declaration)).map(|declaration| declaration.keyword).collect()
}

/// The names of fields, each once.
fn fields(of: impl Fn(&Field) -> bool) -> Vec<&'static str> {
    let mut names: Vec<&str> = Vec::new();
    for field in DECLARATIONS.iter().flat_map(|declaration| declaration.fields).filter(|field| of(field)) {
        if !names.contains(&field.name) {
            names.push(field.name);
        }
    }
    names
}

/// Functions that are called with brackets.
fn called(of: impl Fn(FunctionKind) -> bool) -> Vec<&'static str> {
    let functions = functions::functions().filter(|(kind, function)| of(*kind) && function.form.contains('('));
    functions.map(|(_, function)| function.name).collect()
}

/// Words within declarations: `in`, `as`, `modal`.
fn markers() -> Vec<&'static str> {
    let mut words = vec!["along", "about"];
    for piece in DECLARATIONS.iter().flat_map(|declaration| declaration.pieces) {
        match piece {
            Piece::Marker(word, _) if !words.contains(word) => words.push(word),
            Piece::OneOf(choices, ..) => words.extend(*choices),
            _ => {}
        }
    }
    words
}

/// Words in quotes, in indented lines of at most 120 columns.
fn quoted(words: &[&str], indent: &str) -> String {
    let mut text = String::new();
    let mut column = 120;
    for word in words {
        if column + word.len() + 3 > 118 {
            text += &format!("\n{indent}\"{word}\"");
            column = indent.len() + word.len() + 2;
        } else {
            text += &format!(" \"{word}\"");
            column += word.len() + 3;
        }
    }
    text
}

const TEXTMATE: &str = "editors/vscode/syntaxes/vib.tmLanguage.json";
const VIM: &str = "editors/neovim/syntax/vib.vim";
const GRAMMAR: &str = "editors/tree-sitter-vib/grammar.js";
const COLOURS: &str = "editors/tree-sitter-vib/queries/highlights.scm";
const DICTIONARY: &str = "fuzz/vib.dict";

fn lists() -> Vec<List> {
    let all = keywords(|_| true);
    let valued = fields(|field| !field.stands_alone());
    let alone = fields(|field| matches!(field.takes, Takes::Nothing));
    let functions = called(|kind| kind != FunctionKind::Damping);
    let joined = |words: &[&str], between: &str| words.join(between);
    let list = |file, before, after, words| List { file, before, after, words };
    let mut dictionary: Vec<&str> = all.clone();
    for word in markers().into_iter().chain(fields(|_| true)).chain(functions::functions().map(|(_, f)| f.name)) {
        if !dictionary.contains(&word) {
            dictionary.push(word);
        }
    }
    let dictionary: String = dictionary.iter().map(|word| format!("\"{word}\"\n")).collect();
    vec![
        list(
            TEXTMATE,
            "\\\\s*(",
            ")[ \\\\t]+([\\\\p{L}_][\\\\p{L}\\\\p{N}_]*)\",",
            joined(&keywords(|declaration| declaration.naming().is_some()), "|"),
        ),
        list(
            TEXTMATE,
            "\\\\s*(",
            ")(?=[ \\\\t(])\"",
            joined(&keywords(|declaration| matches!(declaration.pieces[0], Piece::Apart)), "|"),
        ),
        list(TEXTMATE, "\\\\p{N}_])(", ")(?=[ \\\\t]*=(?!=))\"", joined(&valued, "|")),
        list(TEXTMATE, "\\\\p{N}_])(", "|about|in)\\\\b(?!", joined(&alone, "|")),
        list(TEXTMATE, "\\\\b(", ")(?=\\\\()\"", joined(&functions, "|")),
        list(VIM, "\\zs\\(", "\\)\\>'", joined(&all, "\\|")),
        list(VIM, "'\\<\\(", "\\)(\\@='", joined(&called(|_| true), "\\|")),
        list(COLOURS, "(unit) @type\n\n[", "\n] @keyword\n", quoted(&all, "  ")),
        list(COLOURS, "@function.builtin", "))\n\n((name", quoted(&functions, "    ")),
        list(COLOURS, "(#any-of? @keyword \"", "\"))\n\n(assignment", joined(&alone, "\" \"")),
        list(
            GRAMMAR,
            "element: ($) => seq(choice('",
            "'), field('name', $.name), ':', $.end, '--', $.end, $.fields),",
            joined(&keywords(|declaration| declaration.is_element()), "', '"),
        ),
        list(
            GRAMMAR,
            "joint: ($) => seq(choice('",
            "'), field('name', $.name), ':', $.end, '--', $.end),",
            joined(&keywords(|d| matches!(d.shape, Shape::Joint(_)) && !d.has_along()), "', '"),
        ),
        list(DICTIONARY, "`-dict=`.\n", "\"ground\"\n", dictionary),
    ]
}

/// The file with the list generated from the table.
fn written(text: &str, list: &List) -> String {
    let List { file, before, after, words } = list;
    assert_eq!(text.matches(after).count(), 1, "{file}: one place ends with {after}");
    let end = text.find(after).expect("the end of the list");
    let start = text[..end].rfind(before).unwrap_or_else(|| panic!("{file}: a list starts with {before}"));
    format!("{}{words}{}", &text[..start + before.len()], &text[end..])
}

#[test]
fn lists_of_words_are_those_of_the_table() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let write = std::env::var_os("VIBC_WRITE_WORDS").is_some();
    for list in lists() {
        let path = root.join(list.file);
        let text = fs::read_to_string(&path).expect(list.file);
        let wanted = written(&text, &list);
        if write && wanted != text {
            fs::write(&path, &wanted).expect(list.file);
        } else {
            assert!(
                wanted == text,
                "{} has another list than the table of kinds:\n{}\nVIBC_WRITE_WORDS=1 cargo test --test suite kinds:: writes it; \
                 then `npm run generate` in editors/tree-sitter-vib makes the parser",
                list.file,
                list.words
            );
        }
    }
}

/// Finds words of elements and joints in strings of `src` that do not come from the table. Exceptions: a coordinate of
/// a slide is called `slide`, and a column of the report `spring`.
#[test]
fn no_other_file_has_the_words_of_elements_and_joints() {
    let known = [
        ("lower/kinematics.rs", "slide"),
        ("equations/motion.rs", "slide"),
        ("backend/equations/assumptions.rs", "slide"),
        ("answers/report/rest.rs", "spring"),
        // Classes of glyphs in a written figure.
        ("picture/figure.rs", "spring"),
        ("picture/figure.rs", "damper"),
        ("picture/figure.rs", "inerter"),
        ("picture/figure.rs", "belt"),
    ];
    let words = keywords(|declaration| matches!(declaration.shape, Shape::Element(_) | Shape::Joint(_)));
    assert!(words.contains(&"inerter") && words.contains(&"weld"));
    let mut found = Vec::new();
    let mut folders = SOURCES.map(|folder| Path::new(env!("CARGO_MANIFEST_DIR")).join(folder)).to_vec();
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).expect("a folder of sources") {
            let path = entry.expect("an entry").path();
            let name = path.to_string_lossy().into_owned();
            if path.is_dir() && !["elements", "joints", "kinds"].iter().any(|table| name.ends_with(table)) {
                folders.push(path);
            } else if name.ends_with(".rs") {
                let text = fs::read_to_string(&path).expect("a source");
                let shipped = text.split("\n#[cfg(test)]\nmod tests {").next().unwrap_or_default();
                let own = words.iter().filter(|word| shipped.contains(&format!("\"{word}\"")));
                found.extend(
                    own.filter(|word| !known.contains(&(tail(&name), **word))).map(|word| format!("{name}: {word}")),
                );
            }
        }
    }
    found.retain(|place| !place.contains("/model/tests.rs"));
    assert!(found.is_empty(), "{found:#?}");
}

/// The path below `src`.
fn tail(path: &str) -> &str {
    path.rsplit_once("/src/").map_or(path, |(_, tail)| tail)
}
