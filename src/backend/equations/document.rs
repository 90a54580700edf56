//! The layout of the equations: sections of sentences and formulas, shared by all output formats.

use super::build::Builder;
use super::formula::Formula;
use crate::equations::Equations;
use crate::equations::coordinate::Coordinate;
use crate::equations::names::Label;
use crate::symbols::Symbol;

/// The laid-out text.
#[derive(Clone, Debug)]
pub struct Document {
    pub title: String,
    pub sections: Vec<Section>,
}

#[derive(Clone, Debug)]
pub struct Section {
    pub heading: &'static str,
    pub items: Vec<Item>,
}

#[derive(Clone, Debug)]
pub enum Item {
    Paragraph(Vec<Inline>),
    Formula {
        formula: Formula,
        note: Vec<Inline>,
    },
    /// Matrices with their names, in rows.
    Matrices(Vec<(Formula, Vec<Vec<Formula>>)>),
}

#[derive(Clone, Debug)]
pub enum Inline {
    Text(String),
    Formula(Formula),
}

pub const DIGITS: usize = 6;

pub fn document(equations: &Equations) -> Document {
    let writer = Writer { equations, build: Builder::new(&equations.names) };
    let sections = [
        writer.assumptions(),
        writer.energies(),
        writer.nonlinear(),
        writer.rest(),
        writer.linear(),
        writer.values(),
        writer.solutions(),
    ];
    let n = equations.linear.coordinates.len();
    let title = format!(
        "{} · equations of motion, {n} {}",
        equations.model,
        if n == 1 { "degree of freedom" } else { "degrees of freedom" }
    );
    Document { title, sections: sections.into_iter().filter(|section| !section.items.is_empty()).collect() }
}

pub struct Writer<'a> {
    pub equations: &'a Equations,
    pub build: Builder<'a>,
}

pub fn words(text: impl Into<String>) -> Inline {
    Inline::Text(text.into())
}

pub fn paragraph(text: impl Into<String>) -> Item {
    Item::Paragraph(vec![words(text)])
}

pub fn display(formula: Formula) -> Item {
    Item::Formula { formula, note: Vec::new() }
}

impl Writer<'_> {
    pub fn name(&self, symbol: Symbol) -> Formula {
        Formula::Name(self.equations.names.label(symbol))
    }

    /// `T`, `V_2`: the symbol of a quantity that is not named in the model. If the model uses the same name, energies
    /// become E_kin, E_pot, E_dis, and matrices get the index mat.
    pub fn letter(&self, symbol: &'static str, index: Option<Formula>) -> Formula {
        let taken = self.equations.names.is_taken(symbol) || self.equations.inputs.iter().any(|input| input == symbol);
        let (symbol, distinct) = match symbol {
            _ if !taken || index.is_some() => (symbol, None),
            "T" => ("E", Some("kin")),
            "V" => ("E", Some("pot")),
            "D" => ("E", Some("dis")),
            other => (other, Some("mat")),
        };
        let distinct = distinct.map(|word| Formula::Name(Label::new(word, "")));
        Formula::Symbol(symbol, index.or(distinct).map(Box::new))
    }

    pub fn coordinate(&self, index: usize) -> &Coordinate {
        &self.equations.motion.coordinates[index]
    }
}
