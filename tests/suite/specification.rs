//! Every code that the program can say has one clause in spec.md, in one form, with an example that shows it.

use super::models::{Run, codes_in_sources};
use vibc::backend::explain;

/// Codes that no check of a model's text can show (bytes, tables, `vibc simulate`, systems that no model gives): their clauses tell
/// the example in words.
const IN_WORDS: [&str; 16] = [
    "vib::file::not_utf8",
    "vib::limit::signal",
    "vib::limit::states",
    "vib::motion::still",
    "vib::motion::unsettled",
    "vib::mass::indefinite",
    "vib::mass::singular",
    "vib::scene::more_findings",
    "vib::signal::base_impulse",
    "vib::syntax::character",
    "vib::syntax::more_errors",
    "vib::table::heading",
    "vib::table::order",
    "vib::table::row",
    "vib::table::too_short",
    "vib::table::unreadable",
];

#[test]
fn every_code_has_one_clause_and_every_clause_a_code() {
    let codes = codes_in_sources();
    let clauses: Vec<&str> = explain::clauses().map(|(code, _)| code).collect();
    let missing: Vec<&String> = codes.iter().filter(|code| !clauses.contains(&code.as_str())).collect();
    assert!(missing.is_empty(), "without a clause in spec.md: {missing:#?}");
    let unknown: Vec<&&str> = clauses.iter().filter(|clause| !codes.contains(**clause)).collect();
    assert!(unknown.is_empty(), "clauses that no code belongs to: {unknown:#?}");
    for code in &codes {
        assert_eq!(clauses.iter().filter(|clause| *clause == code).count(), 1, "clauses of {code}");
    }
}

#[test]
fn every_clause_tells_the_meaning_an_example_and_the_mend() {
    for (code, body) in explain::clauses() {
        let meaning = body.split("```").next().unwrap_or_default().trim();
        assert!(meaning.len() > 20, "{code} does not say what it means");
        assert!(body.lines().any(|line| line.starts_with("Mend:")), "{code} has no paragraph that begins with `Mend:`");
    }
}

#[test]
fn the_example_of_a_clause_gives_just_its_code() {
    let mut wrong = Vec::new();
    for (code, body) in explain::clauses() {
        match body.split("```vib\n").nth(1).and_then(|rest| rest.split("```").next()) {
            Some(example) => {
                let found = Run::new(code, example.as_bytes()).codes();
                if found != [code] {
                    wrong.push(format!("{code}: its example gives {found:?}"));
                }
            }
            None if IN_WORDS.contains(&code) => assert!(body.contains("Example:"), "{code} has no example in words"),
            None => wrong.push(format!("{code} has no `vib` block")),
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
