//! A model at many values of its parameters, as a table of numbers.

use crate::model::Model;
use crate::{Told, printed, told};
use vibc::{Bound, Draws, Entry, Holds, Outcome, SourceFile, SourceKind, StudyRequest};

/// The name of a column, its unit, and whether it has bounds.
pub type Heading = (String, String, bool);

/// What is asked for, in the words of the command line.
pub struct Asked {
    pub over: Vec<String>,
    /// The number of cases with random values, and the seed.
    pub samples: Option<(u64, u64)>,
    /// Whether they fill their ranges evenly.
    pub sobol: bool,
    pub measures: Vec<String>,
    pub modes: Option<u32>,
    pub poles: bool,
    pub hold_solved: bool,
    pub tolerance: Option<f64>,
}

/// Numbers row by row.
pub struct Table {
    pub headings: Vec<Heading>,
    /// NaN where there is none; a verdict is one or zero.
    pub values: Vec<f64>,
    /// Absolute; infinite where nothing is known.
    pub bounds: Vec<f64>,
    /// Empty for a case without a finding.
    pub codes: Vec<&'static str>,
}

/// Entries of a table; more are for files.
const MOST: u64 = 100_000_000;

pub fn table(model: &Model, asked: &Asked) -> Told<Result<Table, String>> {
    let mut sources = model.sources.clone();
    let mut lines = |name: &str, lines: &[String]| {
        let text: String = lines.iter().map(|line| format!("{line}\n")).collect();
        sources.add(SourceFile { kind: SourceKind::Arguments, ..SourceFile::model(name, text) })
    };
    let over = lines("values", &asked.over);
    let measures = (!asked.measures.is_empty()).then(|| lines("measures", &asked.measures));
    let request = StudyRequest {
        follow: false,
        orders: Vec::new(),
        over,
        samples: asked.samples.map(|(count, seed)| Draws { count, seed, sobol: asked.sobol }),
        measures,
        modes: asked.modes,
        poles: asked.poles,
        hold_solved: asked.hold_solved,
        until: None,
        tolerance: asked.tolerance,
    };
    let Outcome { answer, diagnostics } = vibc::cases_of(&sources, model.file, &model.overrides, request);
    told(answer.map(|found| found.and_then(|(_, study)| filled(&study))), &sources, &diagnostics)
}

fn filled(study: &vibc::Cases) -> Result<Table, String> {
    let (cases, width) = (study.count(), study.columns.len());
    if cases.saturating_mul(width as u64) > MOST {
        return Err(format!(
            "that would be {cases} cases with {width} columns: write them to a file with `vibc sweep`"
        ));
    }
    let has_bound = |holds| !matches!(holds, Holds::Parameter | Holds::Verdict);
    let headings = study.columns.iter().map(|of| (of.name.clone(), of.unit.clone(), has_bound(of.holds))).collect();
    let numbers: Vec<u64> = (0..cases).collect();
    let computed = vibc::computed_cases(study, &numbers, |case| {
        (case.entries.iter().map(number).unzip::<_, _, Vec<f64>, Vec<f64>>(), case.code.unwrap_or(""))
    });
    let mut table =
        Table { headings, values: Vec::new(), bounds: Vec::new(), codes: Vec::with_capacity(numbers.len()) };
    for ((values, bounds), code) in computed {
        table.values.extend(values);
        table.bounds.extend(bounds);
        table.codes.push(code);
    }
    Ok(table)
}

/// An entry and its bound, as the program prints them.
fn number(entry: &Entry) -> (f64, f64) {
    match *entry {
        Entry::Enclosed(value) => (printed(Some(value)), Bound::absolute(value).value()),
        Entry::Unproven(value) => (value.0 + 0.0, f64::INFINITY),
        Entry::Infinite => (f64::INFINITY, f64::INFINITY),
        Entry::Verdict(holds) => (f64::from(u8::from(holds)), f64::INFINITY),
        Entry::None(..) => (f64::NAN, f64::INFINITY),
    }
}
