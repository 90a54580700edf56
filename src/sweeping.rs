//! The command `sweep`: prepares a study, computes its cases block by block and writes them. See docs/cli.md#sweeps.

use crate::files::{Input, arguments, open, write_by};
use crate::parts::{Header, Progress, fingerprint, is_finished, partial};
use crate::{Status, columns, deliver, failure, report_delivery, report_error, show};
use std::fs::{self, File};
use std::io::{self, IsTerminal, Write};
use std::path::Path;
use std::sync::mpsc;
use std::thread;
use std::time::{Duration, Instant};
use vibc::answers::ranges::{Drawing, Ranges};
use vibc::answers::report;
use vibc::backend::npz::Npz;
use vibc::backend::plot::curves::plot;
use vibc::backend::{self, sweep as rows};
use vibc::cli::{MOST_CASES, MOST_ORDERS, MOST_SHARDS, Messages, Shard, ShardOption, Sweep, SweepFormat};
use vibc::questions::answer::REPLICATES;
use vibc::questions::cases::Study;
use vibc::questions::rows::Rows;
use vibc::sweep::{Draws, StudyRequest, some_rows, study};

/// Columns of every table, which no parameter may be taken for.
const OWN_COLUMNS: [&str; 2] = ["case", "code"];

pub fn sweep(options: &Sweep, messages: &Messages) -> Status {
    let shard = match options.shard.map(resolve_shard).transpose() {
        Ok(shard) => shard,
        Err(text) => {
            report_error(&text);
            return Status::Usage;
        }
    };
    if shard.is_some() && options.format != SweepFormat::Csv {
        report_error("parts are CSV: add `--format csv`");
        return Status::Usage;
    }
    if options.sobol && options.samples.is_some_and(|count| u64::from(count) % REPLICATES != 0) {
        report_error(
            "`--sobol` draws from 16 sequences in turn: the number of samples has to be a multiple of 16, best a power of two",
        );
        return Status::Usage;
    }
    if options.follow {
        let refused = match () {
            () if options.samples.is_some() => {
                "`--follow` needs neighbours, and `--samples` are random: give the values by `--over`"
            }
            () if options.over.len() > 1 => "`--follow` follows modes along one parameter: give one `--over`",
            () if options.orders.len() > MOST_ORDERS => "`--orders` takes at most 20 of them",
            () if shard.is_some() => "`--follow` needs the neighbours of each case: leave `--shard` out",
            () => "",
        };
        if !refused.is_empty() {
            report_error(refused);
            return Status::Usage;
        }
    }
    let path = options.output.file.as_deref();
    if options.format == SweepFormat::Npz && path.is_none_or(|path| path == Path::new("-")) {
        report_error("arrays are written to a file: add `-o FILE.npz`");
        return Status::Usage;
    }
    let mut outputs: Vec<_> = options.output.file.iter().flat_map(|path| [path.clone(), partial(path)]).collect();
    outputs.extend(options.svg.clone());
    let mut input = match open(&options.file, &options.overrides, &outputs, messages) {
        Ok(input) => input,
        Err(status) => return status,
    };
    let request = request(options, &mut input);
    let asked = format!("{request:?} {:?}", options.overrides.literals);
    let mut outcome = study(&input.sources, input.model, &input.overrides, request);
    let status = failure(outcome.failure());
    let found = outcome.answer.take();
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
    if shard.unwrap_or(Shard::WHOLE).rows(count) > MOST_CASES || count == u64::MAX {
        report_error(&format!("that would be {count} cases; the limit of a run is {MOST_CASES}"));
        return Status::Usage;
    }
    let is_table = matches!(options.format, SweepFormat::Csv | SweepFormat::Npz);
    if let Some(column) = study.columns.iter().find(|column| is_table && OWN_COLUMNS.contains(&&*column.name)) {
        let name = &column.name;
        report_error(&format!(
            "the table has a column `{name}` of its own: rename the parameter, or write `--format json`"
        ));
        return Status::Usage;
    }
    let picture = study.followed.as_ref().zip(options.svg.as_deref());
    let drawn = picture.map_or(Status::Done, |(followed, to)| deliver(Some(to), &plot(&model, followed)));
    let status = status.max(drawn);
    let written = match options.format {
        SweepFormat::Text => {
            let mut ranges = Ranges::new(&study.columns, drawing(options));
            let gathered = if ranges.is_random() {
                let found = |numbers: &[u64]| some_rows(&study, numbers, Rows::clone);
                in_blocks(0..count, true, found, |list| {
                    list.iter().for_each(|rows| ranges.add(rows));
                    Ok(())
                })
            } else {
                let of_some = |rows: &Rows| {
                    let mut own = Ranges::new(&study.columns, Drawing::Given);
                    own.add(rows);
                    own
                };
                let found = |numbers: &[u64]| some_rows(&study, numbers, of_some);
                in_blocks(0..count, true, found, |list| {
                    list.into_iter().for_each(|own| ranges.join(own));
                    Ok(())
                })
            };
            if let Err(error) = gathered {
                return report_delivery(path, Err(error));
            }
            let report = report::study(&model, &study.columns, &ranges, study.followed.as_ref());
            return deliver(path, &backend::report::laid_out(&report, columns(&options.page, path))).max(status);
        }
        SweepFormat::Json => write_by(path, |out| write_json(&model, &study, path.is_some(), out)),
        SweepFormat::Npz => {
            let Some((npz, begun)) = Npz::begin(&study.columns, count) else {
                report_error("that is too much for one file of arrays: write `--format csv`, or fewer cases");
                return Status::Usage;
            };
            write_by(path, |out| write_arrays(npz, &begun, &study, out))
        }
        SweepFormat::Csv => {
            let heading = rows::csv_heading(&study.columns);
            let of_study = fingerprint(&input.sources, &asked, &heading);
            let header = Header { shard: shard.unwrap_or(Shard::WHOLE), cases: count, study: of_study };
            match path.filter(|path| is_regular(path)) {
                Some(path) => write_file(&study, path, &header, &heading, shard.is_some()),
                None => write_by(path, |out| {
                    out.write_all(heading.as_bytes())?;
                    write_rows(&study, &header, 0, path.is_some(), out)
                }),
            }
        }
    };
    report_delivery(path, written).max(status)
}

fn drawing(options: &Sweep) -> Drawing {
    match (options.samples, options.sobol) {
        (None, _) => Drawing::Given,
        (Some(_), false) => Drawing::Independent,
        (Some(_), true) => Drawing::Replicated,
    }
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
        samples: options.samples.map(|count| Draws {
            count: u64::from(count),
            seed: options.seed.unwrap_or(0),
            sobol: options.sobol,
        }),
        measures,
        modes: options.modes,
        follow: options.follow,
        orders: options.orders.clone(),
        poles: options.poles,
        hold_solved: options.hold_solved,
        until: options.measured.until(&options.overrides).cloned(),
        tolerance: options.tolerance,
    }
}

/// The part that is asked for; with `auto` the innermost array that this process is a task of.
fn resolve_shard(option: ShardOption) -> Result<Shard, String> {
    let given = match option {
        ShardOption::Given(shard) => return Ok(shard),
        ShardOption::Auto(count) => count,
    };
    let number = |name: &str| match std::env::var(name) {
        Ok(text) => text.parse().map(Some).map_err(|_| format!("`{name}` is `{text}`, which is no number")),
        Err(_) => Ok(None),
    };
    let mut of_array = (None, None);
    for name in ["HQ_TASK_ID", "JOB_COMPLETION_INDEX"] {
        if let (None, Some(index)) = (of_array.0, number(name)?) {
            of_array = (Some(index), None);
        }
    }
    if let (None, Some(task)) = (of_array.0, number("SLURM_ARRAY_TASK_ID")?) {
        let first: u64 = number("SLURM_ARRAY_TASK_MIN")?.unwrap_or(0);
        let step: u64 = number("SLURM_ARRAY_TASK_STEP")?.unwrap_or(1).max(1);
        let index = u64::checked_sub(task, first).ok_or("`SLURM_ARRAY_TASK_ID` is less than `SLURM_ARRAY_TASK_MIN`")?;
        of_array = (Some(index / step), number("SLURM_ARRAY_TASK_COUNT")?);
    }
    let index = of_array.0.ok_or(
        "`--shard auto` is for tasks of a job array: neither SLURM_ARRAY_TASK_ID nor JOB_COMPLETION_INDEX nor HQ_TASK_ID is set",
    )?;
    let count =
        given.or(of_array.1).ok_or("the job array does not say how many tasks it has: write `--shard auto/N`")?;
    match index < count && count <= MOST_SHARDS {
        true => Ok(Shard { index, count }),
        false => Err(format!(
            "this is task {index} of the job array, but parts are counted from 0 to {}",
            count.min(MOST_SHARDS) - 1
        )),
    }
}

/// Whether a path is, or would be, a regular file, beside which progress can be kept.
fn is_regular(path: &Path) -> bool {
    path != Path::new("-") && fs::metadata(path).map_or(true, |found| found.is_file())
}

/// Writes the rows through `FILE.partial`, from where an earlier run ended; a part that is finished is left as it is.
fn write_file(study: &Study, path: &Path, header: &Header, heading: &str, is_part: bool) -> io::Result<()> {
    if is_part
        && let Ok(mut file) = File::open(path)
        && is_finished(&mut file)?
        && let Some((found, _)) = Header::of_file(file)?
        && found == *header
    {
        return Ok(());
    }
    let mut progress = Progress::open(path, header, heading)?;
    write_rows(study, header, progress.done, true, &mut progress.file)?;
    match is_part {
        true => progress.finish_part(path),
        false => progress.finish_whole(|rows| write_by(Some(path), |out| io::copy(rows, out).map(|_| ()))),
    }
}

/// Writes the rows from the one with index `first` on.
fn write_rows(study: &Study, header: &Header, first: u64, is_file: bool, out: &mut dyn Write) -> io::Result<()> {
    let made = |indices: &[u64]| {
        let numbers: Vec<u64> = indices.iter().map(|&index| header.shard.case(index)).collect();
        let of_some = |some: &Rows| {
            let mut text = Vec::new();
            some.for_each(|case| rows::csv_row(&study.columns, case, &mut text));
            text
        };
        some_rows(study, &numbers, of_some).concat()
    };
    in_blocks(first..header.rows(), is_file, made, |rows| out.write_all(&rows))
}

fn write_arrays(mut npz: Npz, begun: &[u8], study: &Study, out: &mut dyn Write) -> io::Result<()> {
    out.write_all(begun)?;
    let found = |numbers: &[u64]| some_rows(study, numbers, Rows::clone);
    in_blocks(0..study.count(), true, found, |list| list.iter().try_for_each(|rows| out.write_all(&npz.rows(rows))))?;
    out.write_all(&npz.end())
}

fn write_json(model: &str, study: &Study, is_file: bool, out: &mut dyn Write) -> io::Result<()> {
    out.write_all(rows::json_heading(model, &study.columns, study.followed.as_ref()).as_bytes())?;
    let mut comma = &b""[..];
    let of_some = |some: &Rows| {
        let mut list = Vec::with_capacity(some.len());
        some.for_each(|case| list.push(rows::json_row(case)));
        list.join(",")
    };
    let made = |numbers: &[u64]| some_rows(study, numbers, of_some).join(",");
    in_blocks(0..study.count(), is_file, made, |rows| {
        out.write_all(std::mem::replace(&mut comma, b","))?;
        out.write_all(rows.as_bytes())
    })?;
    out.write_all(rows::JSON_END.as_bytes())
}

/// Makes something of numbers in blocks that take about a second at most, so that little is lost where a run is ended, and takes it in
/// their order while the next block is made; how they are divided changes no row. A terminal is told how far the run is, unless rows are
/// written to one meanwhile: `is_quiet` says that none are.
fn in_blocks<T: Send>(
    numbers: std::ops::Range<u64>,
    is_quiet: bool,
    make: impl Fn(&[u64]) -> T + Sync,
    mut take: impl FnMut(T) -> io::Result<()>,
) -> io::Result<()> {
    let mut bar = Bar::new(numbers.end, is_quiet);
    let mut take = |(done, block): (u64, T)| {
        take(block)?;
        bar.show(done);
        Ok(())
    };
    let taken = if thread::available_parallelism().map_or(1, |cores| cores.get()) == 1 {
        make_blocks(numbers, make, &mut take)
    } else {
        thread::scope(|scope| {
            // Without room between the two, no more than two blocks are there at a time. Where taking fails, the receiver is gone, and
            // so the next sending fails.
            let (sender, receiver) = mpsc::sync_channel(0);
            let make = &make;
            scope.spawn(move || make_blocks(numbers, make, |block| sender.send(block)));
            receiver.into_iter().try_for_each(&mut take)
        })
    };
    bar.remove();
    taken
}

/// Makes each block, and sends it with the number behind its last until that fails.
fn make_blocks<T, E>(
    numbers: std::ops::Range<u64>,
    make: impl Fn(&[u64]) -> T,
    mut send: impl FnMut((u64, T)) -> Result<(), E>,
) -> Result<(), E> {
    const SIZES: [u64; 2] = [16, 1 << 16];
    let (mut at, mut size) = (numbers.start, SIZES[0]);
    while at < numbers.end {
        let end = numbers.end.min(at + size);
        let begun = Instant::now();
        let block = make(&(at..end).collect::<Vec<u64>>());
        let took = begun.elapsed();
        send((end, block))?;
        size = match () {
            () if took < Duration::from_millis(200) => SIZES[1].min(2 * size),
            () if took > Duration::from_secs(1) => SIZES[0].max(size / 2),
            () => size,
        };
        at = end;
    }
    Ok(())
}

/// The share of a run that is done, on a terminal; nothing on a pipe, and for a run of less than a second.
struct Bar {
    total: u64,
    begun: Instant,
    is_wanted: bool,
    is_there: bool,
}

impl Bar {
    fn new(total: u64, is_quiet: bool) -> Bar {
        let is_wanted = io::stderr().is_terminal() && (is_quiet || !io::stdout().is_terminal());
        Bar { total, begun: Instant::now(), is_wanted, is_there: false }
    }

    fn show(&mut self, done: u64) {
        const WIDTH: u64 = 40;
        if self.is_wanted && self.begun.elapsed() > Duration::from_secs(1) {
            let part = |of: u64| (u128::from(of) * u128::from(done) / u128::from(self.total.max(1))) as usize;
            let bar = "#".repeat(part(WIDTH));
            // What cannot be shown is no reason to stop.
            let _ = write!(io::stderr(), "\r[{bar:<40}] {} %, {done} of {} cases", part(100), self.total);
            self.is_there = true;
        }
    }

    fn remove(&self) {
        if self.is_there {
            // To the start of the line, which is erased.
            let _ = write!(io::stderr(), "\r\x1b[K");
        }
    }
}
