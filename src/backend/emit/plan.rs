//! The content that a target language prints: constants, the state's arrays and the statements of each function, in the
//! order in which the operations happen, so that every target computes the same bits. In: a discrete system. Out: a
//! plan that is independent of the language. See docs/method/emit.md.

use crate::analysis::discrete::{Again, Precision};
use std::collections::BTreeSet;
use std::fmt;

/// The complete program, independent of the language.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Prefix of all names: the model's name.
    pub name: String,
    pub precision: Precision,
    pub style: Style,
    /// The comment at the top, by lines.
    pub header: Vec<String>,
    pub inputs: Vec<Field>,
    pub outputs: Vec<Field>,
    pub coordinates: Vec<Field>,
    /// The state's arrays.
    pub state: Vec<Array>,
    pub tables: Vec<Table>,
    /// Samples with events; if there are any, the state counts its steps.
    pub events: Vec<u64>,
    /// One step; for equations, the derivative.
    pub step: Vec<Statement>,
    /// Whether the state can be set and read in the model's coordinates; of equations it always is.
    pub tabled: bool,
    pub set_state: Vec<Statement>,
    pub get_state: Vec<Statement>,
    /// The outputs of equations.
    pub observe: Vec<Statement>,
}

/// The place of a state in the arrays.
#[derive(Clone, Debug)]
pub struct Slot {
    pub array: String,
    pub at: usize,
}

/// The kind of code.
#[derive(Clone, Debug)]
pub enum Style {
    /// The exact discrete system.
    Steps,
    /// The right-hand side of a first-order system, with displacements and velocities at t = 0.
    Equations { start: Vec<(f64, f64)> },
    /// Steps with an adjustable parameter, and its initial value.
    Parameter { value: f64, statements: Vec<Statement> },
}

/// An input, an output or a coordinate.
#[derive(Clone, Debug)]
pub struct Field {
    pub identifier: String,
    /// The name in the model, with its unit.
    pub note: String,
}

/// A part of the state.
#[derive(Clone, Debug)]
pub struct Array {
    pub name: String,
    pub start: Start,
    pub note: String,
}

/// Initial values of an array.
#[derive(Clone, Debug)]
pub enum Start {
    Number(f64),
    Numbers(Vec<f64>),
}

/// Constants, row by row; a table of one row has no row index.
#[derive(Clone, Debug)]
pub struct Table {
    pub name: String,
    /// Zero if the table has one row.
    pub columns: usize,
    pub values: Vec<f64>,
    pub note: String,
}

#[derive(Clone, Debug)]
pub enum Statement {
    Note(String),
    /// A local that is never changed.
    Let(String, Expression),
    /// A local that is changed.
    Variable(String, Expression),
    Assign(Target, Expression),
    /// Sums in this many lanes, all zero.
    Lanes(String, usize),
    /// A local matrix of zeros.
    Matrix(String, usize, usize),
    /// For i in 0, width, ... below the count, for l in 0..width: the body, at i + l.
    Blocks {
        count: usize,
        width: usize,
        body: Vec<Statement>,
    },
    /// Counts the step, and runs the body if the next of this many events is due; what follows the last one, if they come
    /// again.
    WhenDue(usize, Option<Again>, Vec<Statement>),
    /// Runs the body this many times.
    Repeat(usize, Vec<Statement>),
    /// Runs the body for `i` (or another name) from 0 up to the count (exclusive).
    Loop(&'static str, usize, Vec<Statement>),
}

#[derive(Clone, Debug)]
pub enum Target {
    Local(String),
    State(String, Index),
    Output(usize),
    /// The sum of a lane.
    Lane(String),
    /// An entry of a local matrix.
    Entry(String, Index, Index),
    /// A displacement that `get_state` returns.
    Displacement(Index),
    Velocity(Index),
    /// A derivative that the equations return.
    DisplacementRate(Index),
    VelocityRate(Index),
}

#[derive(Clone, Debug)]
pub enum Index {
    At(usize),
    /// The variable is a single number, not an array.
    Only,
    /// The index of a loop.
    Of(&'static str),
    /// i + l in blocks of this width.
    Lane(usize),
    /// The event that is due.
    Event,
    /// Text in a syntax that all languages share: sums and products of indices.
    Text(String),
}

#[derive(Clone, Debug)]
pub enum Expression {
    Number(f64),
    Local(String),
    State(String, Index),
    Table(String, Index),
    /// An entry of a table with rows.
    Entry(String, Index, Index),
    Input(usize),
    Lane(String),
    /// A displacement that `set_state` is given.
    Displacement(Index),
    Velocity(Index),
    Sum(Box<Expression>, Box<Expression>),
    Difference(Box<Expression>, Box<Expression>),
    Product(Box<Expression>, Box<Expression>),
    Negative(Box<Expression>),
    Quotient(Box<Expression>, Box<Expression>),
    /// The sum of this many lanes, in pairs, and pairs of pairs.
    LaneSum(String, usize),
}

/// The factor of a term.
#[derive(Clone, Debug)]
pub enum Factor {
    Number(f64),
    /// The negative of this number.
    Less(f64),
    Table(Expression),
    LessTable(Expression),
}

impl Factor {
    /// The factor to multiply with, if any, and whether the term is subtracted.
    fn parts(self) -> (Option<Expression>, bool) {
        let number = |x: f64| (x.abs() != 1.0).then(|| Expression::Number(x.abs()));
        match self {
            Factor::Number(x) => (number(x), x < 0.0),
            Factor::Less(x) => (number(x), x >= 0.0),
            Factor::Table(table) => (Some(table), false),
            Factor::LessTable(table) => (Some(table), true),
        }
    }
}

/// Adds a term to a sum: factors of one and signs cost no operation.
pub fn plus(so_far: Option<Expression>, factor: Factor, of: Expression) -> Expression {
    match (so_far, factor.parts()) {
        (None, (None, false)) => of,
        (None, (None, true)) => Expression::Negative(Box::new(of)),
        (None, (Some(Expression::Number(x)), true)) => product(Expression::Number(-x), of),
        (None, (Some(factor), negative)) => {
            let term = product(factor, of);
            if negative { Expression::Negative(Box::new(term)) } else { term }
        }
        (Some(so_far), (factor, negative)) => {
            let term = match factor {
                Some(factor) => product(factor, of),
                None => of,
            };
            if negative { difference(so_far, term) } else { sum(so_far, term) }
        }
    }
}

pub fn sum(a: Expression, b: Expression) -> Expression {
    Expression::Sum(Box::new(a), Box::new(b))
}

pub fn difference(a: Expression, b: Expression) -> Expression {
    Expression::Difference(Box::new(a), Box::new(b))
}

pub fn product(a: Expression, b: Expression) -> Expression {
    Expression::Product(Box::new(a), Box::new(b))
}

/// A sum of terms with numerical factors.
pub fn total(terms: impl IntoIterator<Item = (f64, Expression)>) -> Option<Expression> {
    terms.into_iter().fold(None, |so_far, (factor, of)| Some(plus(so_far, Factor::Number(factor), of)))
}

impl Expression {
    pub fn local(name: impl Into<String>) -> Expression {
        Expression::Local(name.into())
    }

    pub fn state(array: &str, index: Index) -> Expression {
        Expression::State(array.to_string(), index)
    }
}

impl Target {
    pub fn state(array: &str, index: Index) -> Target {
        Target::State(array.to_string(), index)
    }
}

/// Number of multiplications (including divisions) and additions (including subtractions).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Operations {
    pub multiplications: usize,
    pub additions: usize,
}

impl Operations {
    /// Operations of statements that are run once; those of events are not counted.
    pub fn of(list: &[Statement]) -> Operations {
        list.iter().fold(Operations::default(), |sum, statement| sum.and(1, statement.operations()))
    }

    fn and(self, times: usize, other: Operations) -> Operations {
        Operations {
            multiplications: self.multiplications + times * other.multiplications,
            additions: self.additions + times * other.additions,
        }
    }
}

impl fmt::Display for Operations {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let counted = |count: usize, what: &str| format!("{count} {what}{}", if count == 1 { "" } else { "s" });
        let (products, sums) = (counted(self.multiplications, "multiplication"), counted(self.additions, "addition"));
        write!(f, "{products} and {sums}")
    }
}

/// Removes constants that are never read, and turns locals that never change into constants.
pub fn remove_unused(list: Vec<Statement>) -> Vec<Statement> {
    let mut changed: BTreeSet<String> = BTreeSet::new();
    list.iter().for_each(|statement| statement.collect_reassigned(&mut changed));
    let constant = |statement| match statement {
        Statement::Variable(name, value) if !changed.contains(&name) => Statement::Let(name, value),
        other => other,
    };
    without_unused(list.into_iter().map(constant).collect())
}

/// Removes constants that are never read.
fn without_unused(list: Vec<Statement>) -> Vec<Statement> {
    let mut read: BTreeSet<String> = BTreeSet::new();
    let mut kept: Vec<Statement> = Vec::new();
    // From the end, because a local is read after its declaration.
    for statement in list.into_iter().rev() {
        if matches!(&statement, Statement::Let(name, _) if !read.contains(name)) {
            continue;
        }
        statement.locals(&mut read);
        kept.push(statement);
    }
    kept.reverse();
    kept
}

impl Plan {
    /// Whether all numbers are within the precision, and no factor underflows to zero.
    pub fn fits(&self) -> bool {
        let mut numbers: Vec<f64> = self.tables.iter().flat_map(|table| table.values.clone()).collect();
        for array in &self.state {
            match &array.start {
                Start::Number(x) => numbers.push(*x),
                Start::Numbers(list) => numbers.extend(list),
            }
        }
        let mut written = Vec::new();
        let lists = [&self.step, &self.set_state, &self.get_state, &self.observe];
        lists.into_iter().flatten().for_each(|statement| statement.numbers(&mut written));
        if let Style::Parameter { value, statements } = &self.style {
            written.push(*value);
            statements.iter().for_each(|statement| statement.numbers(&mut written));
        }
        let whole = |x: f64| self.precision.round(x.into()).is_finite();
        let kept = |x: f64| x == 0.0 || self.precision.round(x.into()).abs() >= self.precision.least();
        numbers.into_iter().all(whole) && written.into_iter().all(|x| whole(x) && kept(x))
    }
}

impl Statement {
    fn numbers(&self, list: &mut Vec<f64>) {
        match self {
            Statement::Let(_, e) | Statement::Variable(_, e) | Statement::Assign(_, e) => e.numbers(list),
            Statement::Blocks { body, .. }
            | Statement::Loop(_, _, body)
            | Statement::Repeat(_, body)
            | Statement::WhenDue(_, _, body) => body.iter().for_each(|statement| statement.numbers(list)),
            Statement::Note(_) | Statement::Lanes(..) | Statement::Matrix(..) => {}
        }
    }

    /// Collects the locals that are assigned again.
    fn collect_reassigned(&self, names: &mut BTreeSet<String>) {
        match self {
            Statement::Assign(Target::Local(name), _) => {
                names.insert(name.clone());
            }
            Statement::Blocks { body, .. }
            | Statement::Loop(_, _, body)
            | Statement::Repeat(_, body)
            | Statement::WhenDue(_, _, body) => {
                body.iter().for_each(|statement| statement.collect_reassigned(names));
            }
            _ => {}
        }
    }

    fn operations(&self) -> Operations {
        match self {
            Statement::Let(_, e) | Statement::Variable(_, e) | Statement::Assign(_, e) => e.operations(),
            Statement::Blocks { count, body, .. }
            | Statement::Loop(_, count, body)
            | Statement::Repeat(count, body) => Operations::default().and(*count, Operations::of(body)),
            Statement::WhenDue(..) | Statement::Note(_) | Statement::Lanes(..) | Statement::Matrix(..) => {
                Operations::default()
            }
        }
    }

    fn locals(&self, read: &mut BTreeSet<String>) {
        match self {
            Statement::Let(_, e) | Statement::Variable(_, e) | Statement::Assign(_, e) => e.locals(read),
            Statement::Blocks { body, .. }
            | Statement::Loop(_, _, body)
            | Statement::Repeat(_, body)
            | Statement::WhenDue(_, _, body) => {
                body.iter().for_each(|statement| statement.locals(read));
            }
            Statement::Note(_) | Statement::Lanes(..) | Statement::Matrix(..) => {}
        }
    }
}

impl Expression {
    fn numbers(&self, list: &mut Vec<f64>) {
        match self {
            Expression::Number(x) => list.push(*x),
            Expression::Sum(a, b)
            | Expression::Difference(a, b)
            | Expression::Product(a, b)
            | Expression::Quotient(a, b) => {
                a.numbers(list);
                b.numbers(list);
            }
            Expression::Negative(a) => a.numbers(list),
            _ => {}
        }
    }

    fn operations(&self) -> Operations {
        let one = |multiplications, additions| Operations { multiplications, additions };
        match self {
            Expression::Sum(a, b) | Expression::Difference(a, b) => {
                one(0, 1).and(1, a.operations()).and(1, b.operations())
            }
            Expression::Product(a, b) | Expression::Quotient(a, b) => {
                one(1, 0).and(1, a.operations()).and(1, b.operations())
            }
            Expression::Negative(a) => a.operations(),
            Expression::LaneSum(_, width) => one(0, width - 1),
            _ => Operations::default(),
        }
    }

    fn locals(&self, read: &mut BTreeSet<String>) {
        match self {
            Expression::Local(name) if !read.contains(name) => {
                read.insert(name.clone());
            }
            Expression::Sum(a, b)
            | Expression::Difference(a, b)
            | Expression::Product(a, b)
            | Expression::Quotient(a, b) => {
                a.locals(read);
                b.locals(read);
            }
            Expression::Negative(a) => a.locals(read),
            _ => {}
        }
    }
}
