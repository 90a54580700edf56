//! Rows and terms that follow one rule, as those of a `repeat` do, written once with a running index.
//!
//! Two neighbours follow one rule if they differ only in numbers in names (`y_2`, `mass[2]`), and each of these
//! increases by one.

use super::formula::{Formula, Running};
use crate::equations::names::{Label, Names};

/// Rows and terms in a run that is folded, at least.
const LEAST_ROWS: usize = 3;
const LEAST_TERMS: usize = 4;

/// A letter for the index that is not used by the model.
pub fn index_letter(names: &Names) -> &'static str {
    let is_free = |letter: &&str| !names.is_taken(letter);
    ["i", "j", "n"].into_iter().find(is_free).unwrap_or("i")
}

/// Folds rows: rows that follow a rule are written once, with their range, before the others.
pub fn rows(rows: Vec<Formula>, letter: &str) -> Vec<(Formula, Option<Running>)> {
    let runs = runs(&rows, LEAST_ROWS, letter);
    let mut folded: Vec<(Formula, Option<Running>)> =
        runs.iter().map(|run| (run.rule.clone(), Some(run.running(letter)))).collect();
    for (place, row) in rows.into_iter().enumerate() {
        if !runs.iter().any(|run| run.places.contains(&place)) {
            folded.push((row, None));
        }
    }
    folded
}

/// Terms of a sum: runs with one sign as sums over an index.
pub fn terms(terms: Vec<(bool, Formula)>, letter: &str) -> Vec<(bool, Formula)> {
    let mut folded = Vec::new();
    let mut rest = &terms[..];
    while let Some((negative, _)) = rest.first() {
        let same = rest.iter().take_while(|(other, _)| other == negative).count();
        let (own, others) = rest.split_at(same);
        let formulas: Vec<Formula> = own.iter().map(|(_, formula)| formula.clone()).collect();
        let runs = runs(&formulas, LEAST_TERMS, letter);
        for (place, formula) in formulas.into_iter().enumerate() {
            match runs.iter().find(|run| run.places.contains(&place)) {
                Some(run) if run.places.start == place => {
                    folded.push((*negative, Formula::Series(run.running(letter), Box::new(run.rule.clone()))));
                }
                Some(_) => {}
                None => folded.push((*negative, formula)),
            }
        }
        rest = others;
    }
    folded
}

/// Neighbours that follow one rule.
struct Run {
    places: std::ops::Range<usize>,
    /// The index of the first.
    first: i64,
    rule: Formula,
}

impl Run {
    fn running(&self, letter: &str) -> Running {
        Running { index: letter.to_string(), first: self.first, last: self.first + self.places.len() as i64 - 1 }
    }
}

fn runs(formulas: &[Formula], least: usize, letter: &str) -> Vec<Run> {
    let mut runs: Vec<Run> = Vec::new();
    for (place, pair) in formulas.windows(2).enumerate() {
        let mut found = Comparison { letter, anchor: None };
        let rule = found.rule(&pair[0], &pair[1]);
        let (Some(rule), Some(first)) = (rule, found.anchor) else { continue };
        match runs.last_mut() {
            Some(run) if run.places.end == place + 1 && run.rule == rule => run.places.end += 1,
            // A run ends where the next one begins: a row belongs to one of them.
            Some(run) if run.places.end == place + 1 && run.places.len() >= least => {}
            _ => runs.push(Run { places: place..place + 2, first, rule }),
        }
    }
    runs.retain(|run| run.places.len() >= least);
    runs
}

/// Two formulas side by side.
struct Comparison<'a> {
    letter: &'a str,
    /// The value of the index in the first formula: the number in the first name that changes.
    anchor: Option<i64>,
}

impl Comparison<'_> {
    /// The rule of both, with the index in it.
    fn rule(&mut self, a: &Formula, b: &Formula) -> Option<Formula> {
        Some(match (a, b) {
            (Formula::Name(a), Formula::Name(b)) => Formula::Name(self.label(a, b)?),
            (Formula::Sum(a), Formula::Sum(b)) if a.len() == b.len() => {
                let terms = a.iter().zip(b).map(
                    |((sign, a), (other, b))| {
                        if sign == other { Some((*sign, self.rule(a, b)?)) } else { None }
                    },
                );
                Formula::Sum(terms.collect::<Option<_>>()?)
            }
            (Formula::Product(a), Formula::Product(b)) => Formula::Product(self.list(a, b)?),
            (Formula::Call(function, a), Formula::Call(other, b)) if function == other => {
                Formula::Call(function, self.list(a, b)?)
            }
            (Formula::Quotient(a, under), Formula::Quotient(b, other)) => {
                Formula::Quotient(Box::new(self.rule(a, b)?), Box::new(self.rule(under, other)?))
            }
            (Formula::Equal(a, right), Formula::Equal(b, other)) => {
                Formula::Equal(Box::new(self.rule(a, b)?), Box::new(self.rule(right, other)?))
            }
            (Formula::Power(a, exponent), Formula::Power(b, other)) if exponent == other => {
                Formula::Power(Box::new(self.rule(a, b)?), *exponent)
            }
            (Formula::Root(a), Formula::Root(b)) => Formula::Root(Box::new(self.rule(a, b)?)),
            (Formula::Symbol(letter, Some(a)), Formula::Symbol(other, Some(b))) if letter == other => {
                Formula::Symbol(letter, Some(Box::new(self.rule(a, b)?)))
            }
            (a, b) if a == b => a.clone(),
            _ => return None,
        })
    }

    fn list(&mut self, a: &[Formula], b: &[Formula]) -> Option<Vec<Formula>> {
        if a.len() != b.len() {
            return None;
        }
        a.iter().zip(b).map(|(a, b)| self.rule(a, b)).collect()
    }

    fn label(&mut self, a: &Label, b: &Label) -> Option<Label> {
        if a.dots != b.dots {
            return None;
        }
        let word = self.text(&a.word, &b.word)?;
        let parts = || (a.index.split(','), b.index.split(','));
        let (own, other) = parts();
        if own.count() != other.count() {
            return None;
        }
        let (own, other) = parts();
        let index: Option<Vec<String>> = own.zip(other).map(|(a, b)| self.index(a, b)).collect();
        Some(Label { word, index: index?.join(","), dots: a.dots })
    }

    /// `2` and `3` become the index; text that is not a number stays.
    fn index(&mut self, a: &str, b: &str) -> Option<String> {
        match (a.parse::<i64>(), b.parse::<i64>()) {
            (Ok(from), Ok(to)) => self.number(from, to),
            _ => self.text(a, b),
        }
    }

    /// `wagon[2]` and `wagon[3]`: numbers in brackets.
    fn text(&mut self, a: &str, b: &str) -> Option<String> {
        if a == b {
            return Some(a.to_string());
        }
        let (mut own, mut other) = (a.split('['), b.split('['));
        let mut text = String::new();
        loop {
            match (own.next(), other.next()) {
                (None, None) => return Some(text),
                (Some(a), Some(b)) if text.is_empty() && a == b => text += a,
                (Some(a), Some(b)) => {
                    let ((from, rest), (to, left)) = (a.split_once(']')?, b.split_once(']')?);
                    if rest != left {
                        return None;
                    }
                    let number = self.number(from.parse().ok()?, to.parse().ok()?)?;
                    text += &format!("[{number}]{rest}");
                }
                _ => return None,
            }
        }
    }

    fn number(&mut self, from: i64, to: i64) -> Option<String> {
        if from == to {
            return Some(from.to_string());
        }
        if from.checked_add(1)? != to {
            return None;
        }
        let letter = self.letter;
        Some(match from.checked_sub(*self.anchor.get_or_insert(from))? {
            0 => letter.to_string(),
            more if more > 0 => format!("{letter}+{more}"),
            less => format!("{letter}{less}"),
        })
    }
}
