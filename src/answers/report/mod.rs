//! A report as a value: sections of sentences, tables and matrices, whose numbers keep their enclosures and whose names
//! keep their places in the model. It is built once; text, Markdown and pages only lay it out. The content of a report,
//! its order, names and number of digits are decided here. See docs/method/report.md.
//!
//! The JSON of `analyze` is not laid out from it: a program needs every entry under a stable key, a reader wants the
//! twenty largest in a sentence. Both take their numbers from the same answers by the same methods (`analysis::derived`,
//! [`super::ModalAnswer`]), so that neither computes, bounds or judges a number of its own.

mod bench;
mod curves;
mod damped_shapes;
mod equations;
mod excitation;
mod modes;
mod motion;
mod parts;
mod poles;
mod questions;
mod random;
mod rest;
mod robust;
mod sensitivities;
pub mod shock;
mod spectral;
mod study;
mod table;
mod tolerances;
mod transfer;

pub use bench::bench;
pub use modes::at_outputs;
pub use motion::motion;
pub use parts::explanation;
pub use questions::requirements;
pub use shock::shock;
pub use study::study;
pub use table::{Align, Cell, Column, Table};
pub use transfer::transfer;

use crate::analysis::{Mode, ModeKind, Normalise, Share, Stability};
use crate::answers::ModalAnswer;
use crate::base::{Ball, Bound, Number, Rounded, Span, Unproven};
use crate::system::{Coordinate, CoordinateKind, LinearSystem, Source};
use std::borrow::Cow;

/// Options for the contents of a modal report.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Options {
    pub normalise: Normalise,
    /// Show the matrices, however large.
    pub matrices: bool,
    /// Number of digits of frequencies and poles, if that many are certain; without it, a handful.
    pub digits: Option<u32>,
    /// Show every entry of the shapes, however many coordinates there are.
    pub all_shapes: bool,
}

impl Options {
    /// Number of digits to show for a number that usually has `usual`, unless another number is requested.
    fn digits(&self, usual: usize) -> usize {
        self.digits.map_or(usual, |digits| digits as usize)
    }
}

/// A report, ready to be laid out.
#[derive(Clone, Debug, Default)]
pub struct Report {
    pub title: Line,
    pub sections: Vec<Section>,
}

/// A part of a report with its own heading.
#[derive(Clone, Debug)]
pub struct Section {
    /// For layouts that show headings; in others, the section's first block introduces it.
    pub heading: &'static str,
    pub blocks: Vec<Block>,
}

#[derive(Clone, Debug)]
pub enum Block {
    Line(Line),
    /// A detail of the line before it.
    Item(Line),
    Table(Table),
    Matrices(Matrices),
}

/// Square matrices of one system, row by row.
#[derive(Clone, Debug)]
pub struct Matrices {
    pub list: Vec<(&'static str, Vec<Vec<Number>>)>,
    /// Requested explicitly: shown even if they do not fit side by side.
    pub wanted: bool,
    /// Significant digits of an entry.
    pub digits: usize,
}

/// Words, names and numbers in sequence: a sentence, or the content of a cell. A no-break space marks where a line must
/// not break.
#[derive(Clone, Debug, Default)]
pub struct Line {
    pub parts: Vec<Part>,
}

#[derive(Clone, Debug)]
pub enum Part {
    /// The report's own words.
    Words(&'static str),
    /// Text from the model: a layout makes sure that it cannot act as a control sequence or markup.
    Named(Named),
    Figure(Figure),
}

/// A name from the model and, if known, the place that declares it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Named {
    pub text: String,
    pub place: Option<Span>,
}

/// A number with its unit; the unit is empty if the table's column shows it.
#[derive(Clone, Debug)]
pub struct Figure {
    pub value: Value,
    pub unit: Cow<'static, str>,
}

#[derive(Clone, Debug)]
pub enum Value {
    /// A number shown with at most `digits` digits, and only those that its radius determines.
    Enclosed {
        number: Number,
        digits: usize,
    },
    /// A level or an angle, shown with two digits after the decimal point.
    Hundredths(Ball),
    /// A number without a proven bound.
    Unproven {
        number: Unproven,
        digits: usize,
    },
    /// A share of a whole, shown as a percentage.
    Share(Unproven),
    /// An upper bound, shown with one digit, rounded up.
    Bound(Bound),
    /// Shown in place of a bound, for a number without error.
    Exact,
    Count(usize),
}

impl Report {
    fn new(title: Line, sections: impl IntoIterator<Item = Section>) -> Report {
        Report { title, sections: sections.into_iter().filter(|section| !section.blocks.is_empty()).collect() }
    }

    /// The report about an unproven rest. A bound of the linear system there would be mistaken for one of the scene, so
    /// every bound is shown as unknown, whichever section it is in.
    fn without_bounds(mut self) -> Report {
        for block in self.sections.iter_mut().flat_map(|section| &mut section.blocks) {
            match block {
                Block::Line(line) | Block::Item(line) => line.forget_bounds(),
                Block::Table(table) => table.forget_bounds(),
                Block::Matrices(_) => {}
            }
        }
        self
    }
}

impl Section {
    fn new(heading: &'static str, blocks: impl IntoIterator<Item = Block>) -> Section {
        Section { heading, blocks: blocks.into_iter().collect() }
    }
}

impl Line {
    /// Appends a part to the line.
    fn and(mut self, part: impl Into<Line>) -> Line {
        self.parts.extend(part.into().parts);
        self
    }

    fn is_empty(&self) -> bool {
        self.parts.is_empty()
    }

    /// Marks all bounds in the line as unknown.
    fn forget_bounds(&mut self) {
        for part in &mut self.parts {
            match part {
                Part::Figure(figure) if figure.is_bound() => figure.value = Value::Bound(Bound::UNKNOWN),
                _ => {}
            }
        }
    }
}

/// A line of its parts, in order.
macro_rules! line {
    ($($part:expr),* $(,)?) => { $crate::answers::report::Line::default()$(.and($part))* };
}
use line;

impl From<&'static str> for Line {
    fn from(words: &'static str) -> Line {
        Line { parts: if words.is_empty() { Vec::new() } else { vec![Part::Words(words)] } }
    }
}

/// Text that is composed at run time may contain names from the model.
impl From<String> for Line {
    fn from(text: String) -> Line {
        Line::from(Named { text, place: None })
    }
}

impl From<Named> for Line {
    fn from(named: Named) -> Line {
        Line { parts: vec![Part::Named(named)] }
    }
}

impl From<Figure> for Line {
    fn from(figure: Figure) -> Line {
        Line { parts: vec![Part::Figure(figure)] }
    }
}

impl From<usize> for Line {
    fn from(count: usize) -> Line {
        Line::from(Figure::of(Value::Count(count)))
    }
}

impl From<Line> for Block {
    fn from(line: Line) -> Block {
        Block::Line(line)
    }
}

impl From<Table> for Block {
    fn from(table: Table) -> Block {
        Block::Table(table)
    }
}

impl Figure {
    fn of(value: Value) -> Figure {
        Figure { value, unit: Cow::Borrowed("") }
    }

    fn ball(value: Ball, digits: usize) -> Figure {
        Figure::number(Number::Ball(value), digits)
    }

    fn number(number: Number, digits: usize) -> Figure {
        Figure::of(Value::Enclosed { number, digits })
    }

    fn bound(bound: Bound) -> Figure {
        Figure::of(Value::Bound(bound))
    }

    fn exact() -> Figure {
        Figure::of(Value::Exact)
    }

    fn share(part: Unproven) -> Figure {
        Figure::of(Value::Share(part))
    }

    /// Whether the figure shows a bound: the bound of another figure, or a bound in place of a number without a certain
    /// digit.
    fn is_bound(&self) -> bool {
        /// The relative error at which one digit is still certain.
        const ONE_DIGIT: f64 = 0.05;
        match &self.value {
            Value::Enclosed { number, .. } => !number.is_zero() && number.to_ball().relative_error() > ONE_DIGIT,
            Value::Bound(_) | Value::Exact => true,
            Value::Hundredths(_) | Value::Unproven { .. } | Value::Share(_) | Value::Count(_) => false,
        }
    }

    /// The figure with this unit.
    fn unit(self, unit: impl Into<Cow<'static, str>>) -> Figure {
        Figure { unit: unit.into(), ..self }
    }

    /// The binary64 number that represents an enclosed one, and its bound.
    pub fn to_rounded(&self) -> Option<Rounded> {
        match &self.value {
            Value::Enclosed { number, .. } => Rounded::of_number(number),
            Value::Hundredths(ball) => Rounded::of(*ball),
            Value::Unproven { .. } | Value::Share(_) | Value::Bound(_) | Value::Exact | Value::Count(_) => None,
        }
    }
}

/// The modal report.
pub fn modal(answer: &ModalAnswer, options: &Options) -> Report {
    let account = answer.account.as_ref().map(|account| parts::account_section(account, &answer.system));
    let sections = [
        questions::solve_section(&answer.solved),
        questions::optimum_section(&answer.optimised),
        questions::requirement_section(&answer.requirements),
        rest::section(answer, options),
        equations::section(answer, options),
        modes::section(answer, options),
        modes::split_lines(answer),
        excitation::section(answer),
        poles::section(answer, options),
        damped_shapes::section(answer),
        random::section(answer, options),
        spectral::section(answer, options),
        sensitivities::section(answer),
        tolerances::section(answer),
        parts::section(answer),
    ];
    let report = Report::new(title(answer), sections.into_iter().chain(account));
    if answer.rest.is_proven() { report } else { report.without_bounds() }
}

/// `cart · 2 degrees of freedom, linearised about a stable rest`
fn title(answer: &ModalAnswer) -> Line {
    let verdict = match answer.stability.kind() {
        Stability::Stable => "a stable rest",
        Stability::Neutral => "a neutral rest",
        Stability::Unstable => "an UNSTABLE rest",
        Stability::Undetermined => "a rest of UNDETERMINED stability",
    };
    let rigid =
        answer.modes.list.iter().filter(|mode| mode.kind == ModeKind::Rigid).count() + answer.modes.before.rigid;
    let title = line![
        answer.model.clone(),
        " · ",
        count_of(answer.system.n(), "degree of freedom", "degrees of freedom"),
        ", linearised about ",
        verdict
    ];
    if rigid == 0 { title } else { line![title, " · ", count_of(rigid, "rigid-body mode", "rigid-body modes")] }
}

/// `1 mode`, `3 modes`
fn count_of(count: usize, one: &'static str, several: &'static str) -> Line {
    line![count, " ", if count == 1 { one } else { several }]
}

/// `a, b, c`
fn enumeration(items: impl IntoIterator<Item = Line>) -> Line {
    let separated = |line: Line, item: Line| if line.is_empty() { item } else { line![line, ", ", item] };
    items.into_iter().fold(Line::default(), separated)
}

/// Items of which only some are shown: `a, b, 12 more`. If only one would be left out, it is shown too.
fn first_of(items: Vec<Line>, most: usize) -> Line {
    match items.len().checked_sub(most) {
        Some(more) if more > 1 => {
            line![enumeration(items.into_iter().take(most)), ", ", more, " more"]
        }
        _ => enumeration(items),
    }
}

fn unit(kind: CoordinateKind) -> &'static str {
    match kind {
        CoordinateKind::Translation => "m",
        CoordinateKind::Rotation => "rad",
    }
}

fn coordinate(system: &LinearSystem, coordinate: &Coordinate) -> Named {
    Named { text: system.display(coordinate.name), place: Some(coordinate.span) }
}

/// The largest shares by name, in a longer and a shorter wording: `block 61 %, rod 39 %`. The rest is counted
/// (`8 more 63 %`), unless it is a single share, which is named.
fn shares(system: &LinearSystem, shares: &[Share<Source>]) -> Cell {
    /// Shares are named until they cover this much, and at most `MOST` of them.
    const COVERED: f64 = 0.98;
    const MOST: usize = 3;
    /// If no share reaches this much, naming a few of them is not informative.
    const WORTH_NAMING: f64 = 0.05;
    let named = |share: &Share<Source>| line![system.display(share.of), "\u{a0}", Figure::share(share.part)];
    let sum = |shares: &[Share<Source>]| shares.iter().map(|share| share.part.0).sum::<f64>();
    let Some(largest) = shares.first() else { return Cell::default() };
    if largest.part.0.abs() < WORTH_NAMING {
        // If there are very many, the list holds only the largest.
        let all = (1.0 - sum(shares)).abs() < 0.01;
        let parts = if all { line![shares.len()] } else { line!["many"] };
        return line![
            "spread over ",
            parts,
            ", at most ",
            Figure::share(largest.part),
            " (",
            system.display(largest.of),
            ")"
        ]
        .into();
    }
    let enough = (1..=shares.len()).find(|count| sum(&shares[..*count]) >= COVERED).unwrap_or(shares.len());
    let wording = |count: usize| {
        let left = 1.0 - sum(&shares[..count]);
        match shares.len() - count {
            _ if left.abs() < 0.005 => enumeration(shares[..count].iter().map(named)),
            0 | 1 => enumeration(shares.iter().map(named)),
            more => line![
                enumeration(shares[..count].iter().map(named)),
                ", ",
                more,
                "\u{a0}more\u{a0}",
                Figure::share(Unproven(left))
            ],
        }
    };
    let few = enough.min(MOST);
    let all_named = if enough <= MOST + 1 { Some(enough) } else { None };
    Cell::wordings(all_named.into_iter().chain((1..=few).rev()).map(wording))
}

/// `≤ 3e-16`, `0`, or `?` if nothing is proven.
fn error(bound: Bound) -> Line {
    line![if bound.is_finite() { "≤ " } else { "" }, Figure::bound(bound)]
}

/// The bodies that carry a mode's kinetic energy.
fn carried_by(system: &LinearSystem, mode: &Mode) -> Line {
    shares(system, &mode.kinetic).longest()
}
