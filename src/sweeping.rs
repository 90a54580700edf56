//! The command `sweep`: prepares a study, computes its cases block by block and writes them. See docs/cli.md#sweeps.

use crate::files::{Input, arguments, open, write_by};
use crate::{Status, columns, deliver, delivered, failure, report_error, show};
use std::io::{self, Write};
use vibc::answers::ranges::Ranges;
use vibc::answers::report;
use vibc::backend::{self, sweep as rows};
use vibc::cli::{MOST_CASES, Messages, Sweep, SweepFormat};
use vibc::questions::cases::Study;
use vibc::sweep::{StudyRequest, blocks, cases, study};

pub fn sweep(options: &Sweep, messages: &Messages) -> Status {
    let mut input = match open(&options.file, &options.overrides, &options.output.file, messages) {
        Ok(input) => input,
        Err(status) => return status,
    };
    let request = request(options, &mut input);
    let mut outcome = study(&input.sources, input.model, &input.overrides, request);
    let status = failure(outcome.failure());
    let found = outcome.answer.take();
    // What the model says about its declared values alone is not about the cases.
    show(&input.sources, outcome.diagnostics, messages);
    let (model, study) = match found {
        None => return status,
        Some(Err(reason)) => {
            report_error(&reason);
            return Status::Usage;
        }
        Some(Ok(found)) => found,
    };
    let count = study.count();
    if count > MOST_CASES {
        report_error(&format!("that would be {count} cases; the limit is {MOST_CASES}"));
        return Status::Usage;
    }
    let path = options.output.file.as_deref();
    let written = match options.format {
        SweepFormat::Text => {
            let mut ranges = Ranges::new(&study.columns);
            for block in blocks(0..count) {
                cases(&study, &block, |case| case).iter().for_each(|case| ranges.add(case));
            }
            let report = report::study(&model, &study.columns, &ranges);
            let text = backend::report::laid_out(&report, columns(&options.page, path));
            return deliver(path, &text).max(status);
        }
        SweepFormat::Csv => write_by(path, |out| write_csv(&study, out)),
        SweepFormat::Json => write_by(path, |out| write_json(&model, &study, out)),
    };
    delivered(path, written).max(status)
}

/// The request, with its texts among the sources.
fn request(options: &Sweep, input: &mut Input) -> StudyRequest {
    let over = input.sources.add(arguments("--over", &options.over));
    let measures = match options.measure.is_empty() {
        true => None,
        false => Some(input.sources.add(arguments("--measure", &options.measure))),
    };
    StudyRequest {
        over,
        measures,
        modes: options.modes,
        poles: options.poles,
        hold_solved: options.hold_solved,
        until: options.measured.until(&options.overrides).cloned(),
    }
}

fn write_csv(study: &Study, out: &mut dyn Write) -> io::Result<()> {
    out.write_all(rows::csv_heading(&study.columns).as_bytes())?;
    for block in blocks(0..study.count()) {
        let text = cases(study, &block, |case| rows::csv_row(&study.columns, &case)).concat();
        out.write_all(text.as_bytes())?;
    }
    Ok(())
}

fn write_json(model: &str, study: &Study, out: &mut dyn Write) -> io::Result<()> {
    out.write_all(rows::json_heading(model, &study.columns).as_bytes())?;
    for (i, block) in blocks(0..study.count()).enumerate() {
        let text = cases(study, &block, |case| rows::json_row(&case)).join(",");
        out.write_all(if i == 0 { b"" } else { b"," })?;
        out.write_all(text.as_bytes())?;
    }
    out.write_all(rows::JSON_END.as_bytes())
}
