//! Tables of signals: CSV files with two columns, time in s and value in SI units. In: a file's text. Out: its rows, or
//! the error and its line. See docs/method/response.md#signals.
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
use crate::base::unit::{self, Scale};
use crate::base::{Dimension, FileId, Literals, Number, Rational, Span};
use std::cmp::Ordering;
use std::ops::Range;
use std::sync::Arc;

/// Rows reported one by one; a file that is not a table has many more errors.
const MOST_TOLD: usize = 10;

/// Limit on the rows of all tables of a model together; each takes some 300 bytes.
const MOST_ROWS: usize = 1_000_000;

/// Lower-case words of a heading for quantities that no table of a signal holds.
const OTHER_QUANTITIES: [&str; 12] = [
    "acceleration",
    "accel",
    "acc",
    "beschleunigung",
    "ag",
    "g",
    "gal",
    "velocity",
    "vel",
    "geschwindigkeit",
    "speed",
    "v",
];

impl<'a> Check<'a> {
    /// The rows of a table that the model names at `named`, with values read as `read`: for example a displacement in m.
    pub fn table_rows(
        &mut self,
        file: FileId,
        named: Span,
        read: &Expected,
        environment: Environment,
    ) -> Evaluated<Arc<TableRows>> {
        self.heading(file, named, read, environment);
        if let Some(known) = self.tables.get(&file) {
            return known.clone().ok_or(Stop::Reported);
        }
        let rows = self.read_table(file, named, environment);
        self.tables.insert(file, rows.as_ref().ok().cloned());
        rows
    }

    fn read_table(&mut self, file: FileId, named: Span, environment: Environment) -> Evaluated<Arc<TableRows>> {
        if let Some(reason) = self.sources.file(file).unread.clone() {
            return self.fail(environment, PartError::TableUnread { span: named, reason });
        }
        let (mut table, mut told) = (TableRows::default(), 0);
        let text = self.sources.text(file);
        let before: usize = self.tables.values().flatten().map(|table| table.times.len()).sum();
        for (place, line) in lines(text) {
            if before + table.times.len() == MOST_ROWS {
                let reason = format!("the tables of a model have at most {MOST_ROWS} rows in all");
                return self.fail(environment, PartError::TableUnread { span: named, reason });
            }
            let span = |at: &Range<usize>| Span::new(file, place + at.start, place + at.end);
            let fields = fields(line);
            let error = match row(line, &fields, self.literals) {
                Err(_) if table.times.is_empty() && told == 0 && is_heading(line, &fields, place, text) => continue,
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
            told += 1;
            if told == MOST_TOLD {
                break;
            }
        }
        if told > 0 {
            return Err(Stop::Reported);
        }
        if table.times.len() < 2 {
            let rows = table.times.len();
            return self.fail(environment, PartError::TableTooShort { span: named, rows });
        }
        Ok(Arc::new(table))
    }

    /// Warns if the heading names another quantity than the one the values are read as.
    fn heading(&mut self, file: FileId, named: Span, read: &Expected, environment: Environment) {
        let text = self.sources.text(file);
        let Some((place, line)) = lines(text).next() else { return };
        let fields = fields(line);
        let is_table = || lines(text).nth(1).is_some_and(|(_, row)| self.is_row(row));
        if !is_heading(line, &fields, place, text) || !is_table() {
            return;
        }
        let at = fields[1].clone();
        let is_word = |c: char| c.is_alphanumeric() || matches!(c, '/' | '^' | '*' | '%' | '²');
        let words = line[at.clone()].split(|c: char| !is_word(c)).filter(|word| !word.is_empty());
        let Some(word) = words.into_iter().find(|word| is_other(word, read.dimension)).map(str::to_string) else {
            return;
        };
        let span = Span::new(file, place + at.start, place + at.end);
        self.report(environment, PartError::TableHeading { span, named, word, read: described(read.dimension) });
    }

    fn is_row(&self, line: &str) -> bool {
        row(line, &fields(line), self.literals).is_ok()
    }
}

/// Whether a word of a heading names a quantity or a unit other than the one that is read.
fn is_other(word: &str, read: Dimension) -> bool {
    if OTHER_QUANTITIES.contains(&word.to_lowercase().as_str()) {
        return true;
    }
    // `x` and `F` are names before they are units; so is `a`.
    let Ok(unit) = unit::parse(word) else { return false };
    let is_si = matches!(&unit.scale, Scale::Linear(factor) if *factor == Number::ONE);
    word.chars().count() > 1 && unit.dimension != Dimension::NONE && !(unit.dimension == read && is_si)
}

/// The values of a table of this dimension, as a phrase.
fn described(dimension: Dimension) -> &'static str {
    match dimension {
        Dimension::FORCE => "forces in N",
        Dimension::TORQUE => "torques in N*m",
        Dimension::LENGTH => "displacements in m",
        _ => "angles in rad",
    }
}

/// The lines that are neither empty nor comments, and where each begins.
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
