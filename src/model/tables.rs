//! Tables of signals: CSV files with two columns, time in s and value in SI units. In: a file's text; out: its rows, or
//! what is wrong with which line. Clause: spec.md, "Response" 11b.2.
//!
//! The first line may name the columns. Empty lines and lines that begin with `#` are passed over.

use super::Check;
use super::error::{PartError, RowFault};
use super::evaluate::{Evaluated, Stop};
use super::scene::TableRows;
use super::scope::Environment;
use crate::base::{FileId, Literals, Number, Rational, Span};
use std::cmp::Ordering;
use std::ops::Range;
use std::sync::Arc;

/// Rows told one by one; a file that is no table at all has more.
const MOST_TOLD: usize = 10;

impl<'a> Check<'a> {
    /// The rows of a table that the model names at `named`.
    pub fn table_rows(&mut self, file: FileId, named: Span, environment: Environment) -> Evaluated<Arc<TableRows>> {
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
        for (place, line) in lines(text) {
            let span = |at: &Range<usize>| Span::new(file, place + at.start, place + at.end);
            let fields = fields(line);
            let error = match row(line, &fields, self.literals) {
                Err(_) if table.times.is_empty() && told == 0 && is_heading(line, &fields, place, text) => continue,
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
}

/// The lines with something on them, and where each begins.
fn lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let mut start = 0;
    let placed = text.split_inclusive('\n').map(move |line| {
        let place = start;
        start += line.len();
        (place, line.trim_end_matches(['\n', '\r']))
    });
    placed.filter(|(_, line)| !line.trim().is_empty() && !line.trim_start().starts_with('#'))
}

/// Where the fields of a line stand, without the spaces around them.
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

/// Time and value, or what is wrong and where.
fn row(line: &str, fields: &[Range<usize>], literals: Literals) -> Result<(Number, Number), (RowFault, Range<usize>)> {
    let [time, value] = fields else { return Err((RowFault::Fields(fields.len()), 0..line.len())) };
    let whole = |at: &Range<usize>| if at.is_empty() { 0..line.len() } else { at.clone() };
    let time = number(&line[time.clone()], literals).ok_or_else(|| (RowFault::Time, whole(time)))?;
    let value = number(&line[value.clone()], literals).ok_or_else(|| (RowFault::Value, whole(value)))?;
    Ok((time, value))
}

/// A decimal number; some programs put a mark before the first one of a file.
fn number(text: &str, literals: Literals) -> Option<Number> {
    let text = text.trim_start_matches('\u{feff}');
    match text.strip_prefix('-') {
        Some(size) => Rational::from_literal(size, literals).map(|size| -&Number::from(size)),
        None => Rational::from_literal(text.strip_prefix('+').unwrap_or(text), literals).map(Number::from),
    }
}

/// Two names on the first line that says anything.
fn is_heading(line: &str, fields: &[Range<usize>], place: usize, text: &str) -> bool {
    let first = lines(text).next().is_some_and(|(first, _)| first == place);
    first
        && fields.len() == 2
        && fields.iter().all(|at| !at.is_empty() && number(&line[at.clone()], Literals::Decimal).is_none())
}
