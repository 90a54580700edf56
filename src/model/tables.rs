//! Tables of signals: CSV files with two columns, time and value, with their units in the heading or in the model. In: a file's
//! text. Out: its rows in SI, or the error and its line. See docs/method/response.md#signals.
//!
//! The first line may name the columns. Empty lines and lines that begin with `#` are skipped. The file may be anything,
//! and the model that names it may come from a stranger, so the contents of a file are shown only once a row of it was
//! read.

use super::Check;
use super::error::{PartError, RowFault};
use super::evaluate::{Evaluated, Stop};
use super::expect::Expected;
use super::scene::TableRows;
use super::scope::Environment;
use crate::base::unit::{self, Scale, Unit};
use crate::base::{Angle, Dimension, FileId, Literals, Number, Rational, Span};
use std::cmp::Ordering;
use std::ops::Range;
use std::sync::Arc;

/// Rows reported one by one; a file that is not a table has many more errors.
const MAX_REPORTED: usize = 10;

/// Limit on the rows of all tables of a model together; each takes some 300 bytes.
const MOST_ROWS: usize = 1_000_000;

/// Lower-case words of a heading that name an acceleration.
const ACCELERATIONS: [&str; 7] = ["acceleration", "accel", "acc", "beschleunigung", "ag", "g", "gal"];
/// Lower-case words of a heading that name a velocity.
const VELOCITIES: [&str; 5] = ["velocity", "vel", "geschwindigkeit", "speed", "v"];

/// The unit and speed that a model gives for a table.
pub struct TableRequest<'e> {
    pub named: Span,
    /// The SI value of a 1 in the table, and where it is written.
    pub unit: Option<(Number, Span)>,
    pub first: First,
    /// The quantity of the values.
    pub read: &'e Expected,
}

/// The content of a table's first column.
pub enum First {
    Time,
    /// A distance that is covered at this speed, m/s.
    Distance(Number),
    Frequency,
    /// The variable of a law.
    Variable(Dimension),
}

/// The heading of a table.
pub struct Heading {
    pub first: Column,
    pub values: Column,
}

/// A column of a heading.
pub struct Column {
    pub span: Span,
    /// The unit in square brackets.
    pub unit: Option<Unit>,
    /// The text in the brackets is not a unit.
    pub is_unreadable: bool,
}

impl<'a> Check<'a> {
    /// The rows of a table, in SI and over time.
    pub fn table_rows(
        &mut self,
        file: FileId,
        asked: &TableRequest,
        environment: Environment,
    ) -> Evaluated<Arc<TableRows>> {
        let heading = self.heading(file);
        if let Some(heading) = &heading {
            self.check_heading(heading, asked, environment)?;
        }
        let rows = match self.tables.get(&file) {
            Some(known) => known.clone().ok_or(Stop::Reported)?,
            None => {
                let rows = self.read_table(file, asked.named, environment);
                self.tables.insert(file, rows.as_ref().ok().cloned());
                rows?
            }
        };
        if asked.unit.is_none() && heading.as_ref().is_none_or(|heading| heading.values.unit.is_none()) {
            self.report(environment, PartError::TableWithoutUnit { span: asked.named, read: asked.read.noun });
        }
        let factor = |column: &Column| match column.unit.as_ref().map(|unit| &unit.scale) {
            Some(Scale::Linear(factor)) => factor.clone(),
            _ => Number::ONE,
        };
        let first = heading.as_ref().map_or(Number::ONE, |heading| factor(&heading.first));
        let first = match &asked.first {
            First::Distance(speed) => &first / speed,
            First::Time | First::Frequency | First::Variable(_) => first,
        };
        let values = match (&asked.unit, &heading) {
            (Some((unit, _)), _) => unit.clone(),
            (None, Some(heading)) => factor(&heading.values),
            (None, None) => Number::ONE,
        };
        if first.is_one() && values.is_one() {
            return Ok(rows);
        }
        let scaled = |list: &[Number], by: &Number| list.iter().map(|x| x * by).collect();
        Ok(Arc::new(TableRows { times: scaled(&rows.times, &first), values: scaled(&rows.values, &values) }))
    }

    /// Refuses a heading that contradicts the expected quantity, or names a quantity without its unit.
    fn check_heading(&mut self, heading: &Heading, asked: &TableRequest, environment: Environment) -> Evaluated<()> {
        let (named, read) = (asked.named, asked.read.noun);
        for column in [&heading.first, &heading.values] {
            if column.is_unreadable {
                return self.fail(environment, PartError::TableUnitUnknown { span: column.span, named });
            }
        }
        let wanted = match asked.first {
            First::Time => Dimension::TIME,
            First::Distance(_) => Dimension::LENGTH,
            First::Frequency => Dimension::FREQUENCY,
            First::Variable(over) => over,
        };
        if let Some(unit) = &heading.first.unit
            && (unit.dimension != wanted || (wanted == Dimension::FREQUENCY && unit.angle != Angle::Cycles))
        {
            let span = heading.first.span;
            if wanted == Dimension::FREQUENCY {
                return self.fail(environment, PartError::TableFrequencies { span, named });
            }
            let is_distance = unit.dimension == Dimension::LENGTH;
            return self.fail(environment, PartError::TableFirstColumn { span, named, is_distance });
        }
        let span = heading.values.span;
        match (&heading.values.unit, &asked.unit) {
            (Some(unit), _) if unit.dimension != asked.read.dimension => {
                let word = self.sources.slice(span).to_string();
                self.fail(environment, PartError::TableHeading { span, named, word, read })
            }
            (Some(unit), Some((factor, at))) if !matches!(&unit.scale, Scale::Linear(own) if own == factor) => {
                self.fail(environment, PartError::TableUnitsDiffer { span: *at, heading: span })
            }
            (Some(_), _) => Ok(()),
            (None, unit) => {
                let stated = unit.as_ref().map(|_| asked.read.dimension);
                match self.contradiction(span, asked.read.dimension, stated) {
                    Some(word) => self.fail(environment, PartError::TableHeading { span, named, word, read }),
                    None => Ok(()),
                }
            }
        }
    }

    /// A word of a heading without a unit that names another quantity than the expected one, or one whose unit is not
    /// given.
    fn contradiction(&self, span: Span, read: Dimension, stated: Option<Dimension>) -> Option<String> {
        let is_word = |c: char| c.is_alphanumeric() || matches!(c, '/' | '^' | '*' | '%' | '²');
        let text = self.sources.slice(span);
        let words = text.split(|c: char| !is_word(c)).filter(|word| !word.is_empty());
        let found = words.into_iter().find(|word| match (quantity(word), stated) {
            (Some(of), Some(stated)) => of != stated,
            (Some(_), None) => true,
            (None, Some(_)) => false,
            (None, None) => is_other_unit(word, read),
        });
        found.map(str::to_string)
    }

    /// The heading of a table that has one, and rows below it.
    pub fn heading(&self, file: FileId) -> Option<Heading> {
        let text = self.sources.text(file);
        let (place, line) = lines(text).next()?;
        let fields = fields(line);
        let is_table = || lines(text).nth(1).is_some_and(|(_, row)| self.is_row(row));
        if !is_heading(line, &fields, place, text) || !is_table() {
            return None;
        }
        let column = |at: &Range<usize>| {
            let bracketed = line[at.clone()].split_once('[').and_then(|(_, rest)| rest.split_once(']'));
            let read = bracketed.map(|(unit, _)| unit::parse(unit.trim()).ok());
            let is_linear = |unit: &Unit| matches!(unit.scale, Scale::Linear(_));
            let unit = read.clone().flatten().filter(is_linear);
            let is_unreadable = read.is_some() && unit.is_none();
            Column { span: Span::new(file, place + at.start, place + at.end), unit, is_unreadable }
        };
        Some(Heading { first: column(&fields[0]), values: column(&fields[1]) })
    }

    fn read_table(&mut self, file: FileId, named: Span, environment: Environment) -> Evaluated<Arc<TableRows>> {
        if let Some(reason) = self.sources.file(file).unread.clone() {
            return self.fail(environment, PartError::TableUnread { span: named, reason });
        }
        let (mut table, mut reported_count) = (TableRows::default(), 0);
        let text = self.sources.text(file);
        let before: usize = self.tables.values().flatten().map(|table| table.times.len()).sum();
        for (place, line) in lines(text) {
            if before + table.times.len() == MOST_ROWS {
                let reason = format!("the tables of a model have at most {MOST_ROWS} rows in total");
                return self.fail(environment, PartError::TableUnread { span: named, reason });
            }
            let span = |at: &Range<usize>| Span::new(file, place + at.start, place + at.end);
            let fields = fields(line);
            let error = match row(line, &fields, self.literals) {
                Err(_) if table.times.is_empty() && reported_count == 0 && is_heading(line, &fields, place, text) => {
                    continue;
                }
                Err(_) if table.times.is_empty() => {
                    let line = self.sources.file(file).position(place).line;
                    return self.fail(environment, PartError::NotATable { span: named, line });
                }
                Err((found, at)) => PartError::TableRow { span: span(&at), found, named },
                Ok((time, value)) => {
                    let late = table.times.last().is_none_or(|last| time.compare(last) == Some(Ordering::Greater));
                    table.times.push(time);
                    table.values.push(value);
                    if late {
                        continue;
                    }
                    PartError::TableOrder { span: span(&fields[0]), named }
                }
            };
            self.report(environment, error);
            reported_count += 1;
            if reported_count == MAX_REPORTED {
                break;
            }
        }
        if reported_count > 0 {
            return Err(Stop::Reported);
        }
        if table.times.len() < 2 {
            let rows = table.times.len();
            return self.fail(environment, PartError::TableTooShort { span: named, rows });
        }
        Ok(Arc::new(table))
    }

    fn is_row(&self, line: &str) -> bool {
        row(line, &fields(line), self.literals).is_ok()
    }
}

/// The rate or acceleration that a word of a heading names.
fn quantity(word: &str) -> Option<Dimension> {
    let word = word.to_lowercase();
    match word.as_str() {
        word if ACCELERATIONS.contains(&word) => Some(Dimension::ACCELERATION),
        word if VELOCITIES.contains(&word) => Some(Dimension::VELOCITY),
        _ => None,
    }
}

/// Whether a word of a heading is a unit other than the SI unit of the expected quantity.
fn is_other_unit(word: &str, read: Dimension) -> bool {
    // `x` and `F` are names before they are units; so is `a`.
    let Ok(unit) = unit::parse(word) else { return false };
    let is_si = matches!(&unit.scale, Scale::Linear(factor) if *factor == Number::ONE);
    word.chars().count() > 1 && unit.dimension != Dimension::NONE && !(unit.dimension == read && is_si)
}

/// The lines that are neither empty nor comments, and their byte offsets.
fn lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let mut start = 0;
    let placed = text.split_inclusive('\n').map(move |line| {
        let place = start;
        start += line.len();
        (place, line.trim_end_matches(['\n', '\r']))
    });
    placed.filter(|(_, line)| !line.trim().is_empty() && !line.trim_start().starts_with('#'))
}

/// The ranges of a line's fields, without surrounding spaces.
fn fields(line: &str) -> Vec<Range<usize>> {
    let mut start = 0;
    let field = |text: &str| {
        let from = start + text.len() - text.trim_start().len();
        let to = (start + text.trim_end().len()).max(from);
        start += text.len() + 1;
        from..to
    };
    line.split(',').map(field).collect()
}

/// Time and value, or the error and its place.
fn row(line: &str, fields: &[Range<usize>], literals: Literals) -> Result<(Number, Number), (RowFault, Range<usize>)> {
    let [time, value] = fields else { return Err((RowFault::Fields(fields.len()), 0..line.len())) };
    let whole = |at: &Range<usize>| if at.is_empty() { 0..line.len() } else { at.clone() };
    let time = number(&line[time.clone()], literals).ok_or_else(|| (RowFault::Time, whole(time)))?;
    let value = number(&line[value.clone()], literals).ok_or_else(|| (RowFault::Value, whole(value)))?;
    Ok((time, value))
}

/// A decimal number; some programs write a byte order mark before the first one of a file.
fn number(text: &str, literals: Literals) -> Option<Number> {
    let text = text.trim_start_matches('\u{feff}');
    match text.strip_prefix('-') {
        Some(size) => Rational::from_literal(size, literals).map(|size| -&Number::from(size)),
        None => Rational::from_literal(text.strip_prefix('+').unwrap_or(text), literals).map(Number::from),
    }
}

/// Whether this is the first line with content and holds two names.
fn is_heading(line: &str, fields: &[Range<usize>], place: usize, text: &str) -> bool {
    let first = lines(text).next().is_some_and(|(first, _)| first == place);
    first
        && fields.len() == 2
        && fields.iter().all(|at| !at.is_empty() && number(&line[at.clone()], Literals::Decimal).is_none())
}
