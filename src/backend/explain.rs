//! The long text of a diagnostic: its clause in spec.md, for a terminal. Clause: spec.md, "Diagnostics".

use strsim::damerau_levenshtein;

const SPECIFICATION: &str = include_str!("../../spec.md");

/// The clause of a code, or the known code that is nearest to what was asked. `unit::mismatch` is short for
/// `vib::unit::mismatch`.
pub fn explain(asked: &str) -> Result<String, Unknown> {
    let code = if asked.starts_with("vib::") { asked.to_string() } else { format!("vib::{asked}") };
    match clauses().find(|(name, _)| *name == code) {
        Some((name, body)) => Ok(format!("{name}\n\n{}", terminal(body))),
        None => Err(Unknown { nearest: nearest(&code) }),
    }
}

/// A code that no clause explains.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unknown {
    pub nearest: Option<&'static str>,
}

/// Code and text of each clause, in the order of the specification.
pub fn clauses() -> impl Iterator<Item = (&'static str, &'static str)> {
    SPECIFICATION.split("\n### ").filter(|section| section.starts_with("vib::")).map(|section| {
        let (name, rest) = section.split_once('\n').unwrap_or((section, ""));
        let body = rest.split("\n## ").next().unwrap_or(rest);
        (name.trim(), body.trim_matches('\n'))
    })
}

fn nearest(code: &str) -> Option<&'static str> {
    let distance = |name: &str| damerau_levenshtein(name, code);
    let (name, _) = clauses().min_by_key(|(name, _)| distance(name))?;
    (distance(name) * 3 <= code.chars().count()).then_some(name)
}

/// Fenced blocks indented, the rest as it is written.
fn terminal(markdown: &str) -> String {
    let mut text = String::new();
    let mut fenced = false;
    for line in markdown.lines() {
        if line.starts_with("```") {
            fenced = !fenced;
        } else if fenced && !line.is_empty() {
            text += &format!("    {line}\n");
        } else {
            text += &format!("{line}\n");
        }
    }
    text
}
