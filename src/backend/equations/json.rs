//! Equations as JSON for programs: each entry as text, as LaTeX and with its value and bound, and the sections of the
//! layout. Form: schema/equations.schema.json.

use super::build::Builder;
use super::document::{Document, Item};
use super::formula::Formula;
use super::{latex, text};
use crate::backend::json_number::JsonNumber;
use crate::base::Number;
use crate::base::readable::escape;
use crate::equations::closed::Part;
use crate::equations::transfer::Transfer;
use crate::equations::{Entry, Equations};
use crate::symbols::Sum;
use serde::Serialize;

#[derive(Serialize)]
struct Page<'a> {
    schema: &'static str,
    title: &'a str,
    coordinates: Vec<Coordinate>,
    mass: Vec<Vec<Term>>,
    damping: Vec<Vec<Term>>,
    stiffness: Vec<Vec<Term>>,
    inputs: Vec<Input>,
    outputs: Vec<Output>,
    parts: Vec<Modes>,
    transfer_functions: Vec<Quotient>,
    sections: Vec<Section<'a>>,
}

/// A coordinate with its position at rest, measured from the drawing. Independent coordinates are in the order of the
/// matrices.
#[derive(Serialize)]
struct Coordinate {
    name: String,
    body: String,
    motion: &'static str,
    /// `independent`, `dependent` or `prescribed`.
    role: &'static str,
    rest: JsonNumber,
    rest_bound: JsonNumber,
}

/// A sum of names with its value.
#[derive(Serialize)]
struct Term {
    text: String,
    latex: String,
    value: JsonNumber,
    bound: JsonNumber,
}

/// The right side of the linearised equations: by the order of the derivative of the input, an entry for each coordinate.
#[derive(Serialize)]
struct Input {
    name: String,
    columns: Vec<Vec<Term>>,
    /// For an unbalance, its force as a function of time: the opposite of its second derivative.
    #[serde(skip_serializing_if = "Option::is_none")]
    force: Option<Term>,
}

#[derive(Serialize)]
struct Output {
    name: String,
    rows: Vec<Vec<Term>>,
}

/// Coordinates that are coupled, the squares of their natural frequencies and their damping ratio.
#[derive(Serialize)]
struct Modes {
    coordinates: Vec<String>,
    omega_squared: Vec<Term>,
    #[serde(skip_serializing_if = "Option::is_none")]
    damping_ratio: Option<Term>,
}

/// Coefficients by powers of s, the constant first.
#[derive(Serialize)]
struct Quotient {
    input: String,
    output: String,
    numerator: Vec<Term>,
    denominator: Vec<Term>,
}

#[derive(Serialize)]
struct Section<'a> {
    heading: &'a str,
    items: Vec<Line>,
}

#[derive(Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
enum Line {
    Sentence { text: String },
    Formula { text: String, latex: String, note: String },
    Matrix { name: String, text: Vec<Vec<String>>, latex: Vec<Vec<String>> },
}

pub fn json(equations: &Equations, document: &Document) -> String {
    let sections = document
        .sections
        .iter()
        .map(|section| Section { heading: section.heading, items: section.items.iter().flat_map(entries).collect() });
    let terms = Terms { equations, build: Builder::new(&equations.names) };
    let matrix = |entries: &[Vec<Entry>]| {
        entries.iter().map(|row| row.iter().map(|entry| terms.term(&entry.sum, &entry.value)).collect()).collect()
    };
    let linear = &equations.linear;
    let page = Page {
        schema: "vibc-equations-2",
        title: &document.title,
        coordinates: terms.coordinates(),
        mass: matrix(&linear.mass),
        damping: matrix(&linear.damping),
        stiffness: matrix(&linear.stiffness),
        inputs: terms.inputs(),
        outputs: terms.outputs(),
        parts: equations.parts.iter().map(|part| terms.modes(part)).collect(),
        transfer_functions: equations.transfers.iter().map(|transfer| terms.quotient(transfer)).collect(),
        sections: sections.collect(),
    };
    escape(serde_json::to_string_pretty(&page).expect("strings and numbers always have a JSON form")) + "\n"
}

struct Terms<'a> {
    equations: &'a Equations,
    build: Builder<'a>,
}

impl Terms<'_> {
    fn term(&self, sum: &Sum, value: &Number) -> Term {
        let formula = self.build.sum(sum);
        let ball = value.to_ball();
        Term {
            text: text::formula(&formula),
            latex: latex::formula(&formula),
            value: JsonNumber::from_enclosure(ball),
            bound: JsonNumber::absolute_bound(ball),
        }
    }

    fn sum(&self, sum: &Sum) -> Term {
        match self.equations.names.value_of(sum) {
            Some(value) => self.term(sum, &value),
            None => Term { value: JsonNumber::NULL, bound: JsonNumber::NULL, ..self.term(sum, &Number::ZERO) },
        }
    }

    /// A number that has no symbols.
    fn number(&self, value: Option<&Number>) -> Term {
        let (text, latex) = (String::new(), String::new());
        let ball = value.map(Number::to_ball);
        let bound = ball.map_or(JsonNumber::NULL, JsonNumber::absolute_bound);
        Term { text, latex, value: JsonNumber::of(ball), bound }
    }

    fn coordinates(&self) -> Vec<Coordinate> {
        let Equations { motion, linear, rest, names, bodies, .. } = self.equations;
        let dependent = (0..motion.free).filter(|index| !linear.coordinates.contains(index));
        let order = linear.coordinates.iter().copied().chain(dependent).chain(motion.free..motion.coordinates.len());
        let coordinate = |index: usize| {
            let own = &motion.coordinates[index];
            let role = match index {
                _ if own.input.is_some() => "prescribed",
                _ if linear.coordinates.contains(&index) => "independent",
                _ => "dependent",
            };
            let at_rest = rest.moved.iter().find(|(place, ..)| *place == index).map(|(.., value)| value);
            let ball = at_rest.unwrap_or(&Number::ZERO).to_ball();
            let is_known = own.input.is_none();
            Coordinate {
                name: names.label(own.symbols[0]).plain(),
                body: bodies[index].clone(),
                motion: own.motion,
                role,
                rest: JsonNumber::from_enclosure(ball).only_if(is_known),
                rest_bound: JsonNumber::absolute_bound(ball).only_if(is_known && rest.proven),
            }
        };
        order.map(coordinate).collect()
    }

    fn inputs(&self) -> Vec<Input> {
        let columns = self.equations.linear.inputs.iter();
        let input = |column: &crate::equations::linear::Column| Input {
            name: self.equations.inputs[column.input].clone(),
            columns: column.parts.iter().map(|part| part.iter().map(|sum| self.sum(sum)).collect()).collect(),
            force: column.force.as_ref().map(|force| self.sum(force)),
        };
        columns.map(input).collect()
    }

    fn outputs(&self) -> Vec<Output> {
        let output = |output: &crate::equations::transfer::Output| Output {
            name: output.name.clone(),
            rows: output.rows.iter().map(|row| row.iter().map(|sum| self.sum(sum)).collect()).collect(),
        };
        self.equations.outputs.iter().map(output).collect()
    }

    fn modes(&self, part: &Part) -> Modes {
        let square = |square: &crate::equations::closed::Square| match (&square.form, &square.value) {
            (Some(form), Some(value)) => self.term(form, value),
            (_, value) => self.number(value.as_ref()),
        };
        Modes {
            coordinates: part.places.iter().map(|place| self.equations.label(*place).plain()).collect(),
            omega_squared: part.squares.iter().map(square).collect(),
            damping_ratio: part.damping_ratio.as_ref().map(|(form, value)| self.term(form, value)),
        }
    }

    fn quotient(&self, transfer: &Transfer) -> Quotient {
        let numbers = |numbers: &[Number]| numbers.iter().map(|number| self.number(Some(number))).collect();
        let sums = |sums: &[Sum]| sums.iter().map(|sum| self.sum(sum)).collect();
        let part = &self.equations.parts[transfer.part];
        let (numerator, denominator) = match part.characteristic.is_empty() {
            true => (numbers(&transfer.numbers), numbers(&part.numbers)),
            false => (sums(&transfer.reduced.0), sums(&transfer.reduced.1)),
        };
        let input = self.equations.inputs[transfer.input].clone();
        let output = self.equations.outputs[transfer.output].name.clone();
        Quotient { input, output, numerator, denominator }
    }
}

fn entries(item: &Item) -> Vec<Line> {
    match item {
        Item::Paragraph(inlines) => vec![Line::Sentence { text: text::sentence(inlines) }],
        Item::Formula { formula, note } => {
            let note = text::sentence(note);
            vec![Line::Formula { text: text::formula(formula), latex: latex::formula(formula), note }]
        }
        Item::Matrices(matrices) => matrices.iter().map(matrix).collect(),
    }
}

fn matrix((name, rows): &(Formula, Vec<Vec<Formula>>)) -> Line {
    let each = |write: fn(&Formula) -> String| rows.iter().map(|row| row.iter().map(write).collect()).collect();
    Line::Matrix { name: text::formula(name), text: each(text::formula), latex: each(latex::formula) }
}
