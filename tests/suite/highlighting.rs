//! The colours of editors that know the language by a grammar of their own: the TextMate grammar on every example,
//! compared word by word with the language itself, and the word lists of all grammars.
//!
//! The grammar has only rules within one line, so its interpreter is short: at each place it takes the rule that
//! matches first, and of two at one place the one that is listed first, as TextMate does.

use fancy_regex::Regex;
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use vibc::editor::outline::Outline;
use vibc::editor::roles::{Role, roles};
use vibc::editor::tokens::{TokenKind, tokens};
use vibc::kinds::DECLARATIONS;

const GRAMMAR: &str = include_str!("../../editors/vscode/syntaxes/vib.tmLanguage.json");
const VIM: &str = include_str!("../../editors/neovim/syntax/vib.vim");
const TREE_SITTER: &str = include_str!("../../editors/tree-sitter-vib/grammar.js");
const TREE_SITTER_COLOURS: &str = include_str!("../../editors/tree-sitter-vib/queries/highlights.scm");
const TREE_SITTER_PARSER: &str = include_str!("../../editors/tree-sitter-vib/src/parser.c");

/// A rule: its expression, its scope, and the scopes of its groups.
struct Rule {
    expression: Regex,
    name: Option<String>,
    groups: Vec<(usize, String)>,
}

/// The rules in their order, with includes resolved.
fn rules(grammar: &Value, patterns: &Value, list: &mut Vec<Rule>) {
    for pattern in patterns.as_array().expect("patterns") {
        if let Some(include) = pattern["include"].as_str() {
            let named = &grammar["repository"][include.trim_start_matches('#')];
            match named.get("patterns") {
                Some(patterns) => rules(grammar, patterns, list),
                None => list.push(rule(named)),
            }
        } else {
            list.push(rule(pattern));
        }
    }
}

fn rule(pattern: &Value) -> Rule {
    let groups = pattern["captures"].as_object().map(|captures| {
        let scope = |(number, value): (&String, &Value)| {
            (number.parse().expect("a number"), value["name"].as_str().expect("a scope").to_string())
        };
        captures.iter().map(scope).collect()
    });
    let expression = pattern["match"].as_str().expect("a rule of one line");
    Rule {
        expression: Regex::new(expression).unwrap_or_else(|error| panic!("{expression}: {error}")),
        name: pattern["name"].as_str().map(String::from),
        groups: groups.unwrap_or_default(),
    }
}

/// The scope of each byte of a line; empty if it has none.
fn scopes(rules: &[Rule], line: &str) -> Vec<String> {
    let mut scopes = vec![String::new(); line.len()];
    let mut at = 0;
    while at < line.len() {
        let found = rules.iter().enumerate().filter_map(|(order, rule)| {
            let captures = rule.expression.captures_from_pos(line, at).expect("no endless search")?;
            let whole = captures.get(0).expect("the whole match");
            (whole.end() > whole.start()).then_some((whole.start(), order, captures))
        });
        let Some((_, order, captures)) = found.min_by_key(|(start, order, _)| (*start, *order)) else { break };
        let rule = &rules[order];
        let named =
            rule.name.iter().map(|name| (0, name)).chain(rule.groups.iter().map(|(group, name)| (*group, name)));
        for (group, name) in named {
            for byte in captures.get(group).map_or(0..0, |range| range.start()..range.end()) {
                scopes[byte] = name.clone();
            }
        }
        at = captures.get(0).map_or(line.len(), |whole| whole.end());
    }
    scopes
}

/// The expected start of a token's scope; `None` if any or no scope is allowed.
fn expected(kind: TokenKind, role: Role) -> Option<&'static str> {
    Some(match (kind, role) {
        (TokenKind::Comment, _) => "comment.line",
        (TokenKind::Number { .. }, _) => "constant.numeric",
        (TokenKind::Text, _) => "string",
        (TokenKind::Word, Role::Keyword) => "keyword.declaration",
        (TokenKind::Word, Role::Word) => "keyword.other",
        (TokenKind::Word, Role::Direction) => "constant.language",
        (TokenKind::Word, Role::Field) => "variable.parameter",
        (TokenKind::Word, Role::Member) => "variable.other.member",
        (TokenKind::Word, Role::Constant) => "variable.language",
        (TokenKind::Word, Role::Function) => "support.function",
        (TokenKind::Word, Role::Declaration { .. } | Role::Title) => "entity.name",
        // A name has no colour of its own where it is used; after `initial` and `solve` it looks like a declaration.
        (TokenKind::Word, Role::Reference { .. }) => "",
        _ => return None,
    })
}

fn examples() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    let entries = fs::read_dir(folder).expect("the examples").map(|entry| entry.expect("an example").path());
    let mut examples: Vec<PathBuf> = entries.filter(|path| path.extension().is_some_and(|e| e == "vib")).collect();
    examples.sort();
    examples
}

/// Every form of the language page, in addition to the examples.
const FORMS: &str = "model cart // a comment
param k = 10 N/m
param m[1] = 1 kg within 0.9 kg .. 1.2 kg
param c = k within 5 %
param e = 2 mm spread lognormal 3 % within 5 %
param f = 3 Hz spread uniform within 3 %
correlate e, m[1] -0.8
let w = sqrt(k / m1) + .5 /s * 1e-4 kg·m²
gravity (0, -9.81 m/s^2)
body block { mass = 1 kg, moves x y }
body rod { shape = rod(A, (0, -2 m)), at = (0, 0), inertia = 0.8 kg*m^2 about A, turns }
body slug { moves along (1, 1), free }
slide g: arm -- slug along (1, 0)
couple r: wheel.angle = -block.x / 0.3 m
spring s: ground@(-0.5 m, 0) -- block@A { k = k, free_length = 0.5 m, along = x }
force G: block along x = harmonic(10 N, 1.5 Hz) + table(\"a b.csv\")
initial block { x = 16 mm, vx = 0.375 m/s }
output tip = rod@(0, -2 m).x
damping modal 2 %
damping rayleigh(0.1 /s, 1e-4 s)
rest as drawn
repeat i in 2..100 {
  body m[i] { mass = 1 kg, moves x }
}
solve fn in 5 Hz .. 29 Hz: gain(floor -> table.y, 30 Hz) = -12 dB
require frequency(1) > 2 Hz
require stable
";

#[test]
fn the_grammar_colours_every_word_of_every_example_as_the_language_has_it() {
    let grammar: Value = serde_json::from_str(GRAMMAR).expect("JSON");
    let mut list = Vec::new();
    rules(&grammar, &grammar["patterns"], &mut list);
    let mut texts = vec![("forms".to_string(), FORMS.to_string())];
    texts.extend(examples().iter().map(|path| (path.display().to_string(), fs::read_to_string(path).unwrap())));
    let mut wrong = Vec::new();
    for (name, text) in texts {
        let coloured: Vec<String> = text
            .split_inclusive('\n')
            .flat_map(|line| {
                let mut scopes = scopes(&list, line.trim_end_matches('\n'));
                scopes.resize(line.len(), String::new());
                scopes
            })
            .collect();
        let tokens = tokens(&text);
        let outline = Outline::new(&text, &tokens);
        for (token, role) in tokens.iter().zip(roles(&text, &tokens, &outline)) {
            let scope = &coloured[token.range.start];
            let before = text[..token.range.start].trim_end();
            let after_keyword = ["initial", "solve", "correlate"].iter().any(|word| before.ends_with(word));
            let Some(wanted) = expected(token.kind, role).filter(|_| !after_keyword) else { continue };
            if !scope.starts_with(wanted) || wanted.is_empty() && !scope.is_empty() {
                wrong.push(format!("{name}: `{}` is {scope:?}, not {wanted:?}", token.text(&text)));
            }
            if let Some(unit) = token.unit(&text).filter(|unit| !coloured[unit.start].starts_with("support.type.unit"))
            {
                wrong.push(format!("{name}: the unit `{}` is {:?}", &text[unit.clone()], coloured[unit.start]));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

fn keywords() -> impl Iterator<Item = &'static str> {
    DECLARATIONS.iter().map(|declaration| declaration.keyword)
}

/// The alternatives in `a|b|c` or `a\|b\|c`.
fn alternatives(text: &str) -> Vec<&str> {
    text.split(|c: char| !c.is_alphanumeric() && c != '_').filter(|word| !word.is_empty()).collect()
}

#[test]
fn every_grammar_knows_every_keyword_and_function() {
    for (name, text) in [("TextMate", GRAMMAR), ("Vim", VIM), ("tree-sitter's colours", TREE_SITTER_COLOURS)] {
        let words = alternatives(text);
        let functions = vibc::model::functions();
        for word in keywords().chain(functions).chain(["ground", "pi", "moves", "turns", "free", "about"]) {
            assert!(words.contains(&word), "{name} does not know `{word}`");
        }
    }
}

/// The words in quotes, except in comments.
fn quoted<'a>(text: &'a str, comment: &str, quote: char) -> Vec<&'a str> {
    let lines = text.lines().filter(|line| !line.trim_start().starts_with(comment));
    let quoted = lines.flat_map(|line| line.split(quote).skip(1).step_by(2));
    quoted.filter(|text| text.chars().all(|c| c.is_ascii_lowercase())).collect()
}

#[test]
fn the_tree_sitter_grammar_its_parser_and_its_colours_have_the_same_keywords() {
    let grammar = quoted(TREE_SITTER, "//", '\'');
    let colours = quoted(TREE_SITTER_COLOURS, ";", '"');
    for word in keywords().chain(["as", "drawn", "in", "along", "about", "moves", "modal", "rayleigh"]) {
        assert!(grammar.contains(&word), "grammar.js does not know `{word}`");
        assert!(colours.contains(&word), "highlights.scm does not know `{word}`");
        // The parser is generated from the grammar by `tree-sitter generate`.
        let symbol = format!("[anon_sym_{word}] = \"{word}\"");
        assert!(TREE_SITTER_PARSER.contains(&symbol), "parser.c does not know `{word}`");
    }
}
