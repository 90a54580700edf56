//! The command `merge`: the parts of a study as the file that one run would have written. See docs/cli.md#shards.

use crate::files::write_by;
use crate::named::open_regular;
use crate::parts::{END, Header, is_finished};
use crate::{Status, report_error};
use std::fs::File;
use std::io::{self, BufRead, BufReader, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use vibc::cli::Merge;

/// Missing parts that are named.
const NAMED: usize = 8;

/// A part, of which a piece is in memory: with thousands of parts, not all files can be open.
struct Part {
    path: PathBuf,
    header: Header,
    /// Where the next piece begins.
    offset: u64,
    piece: Vec<u8>,
    /// Where the next row begins in the piece.
    at: usize,
}

/// Bytes of a piece, unless a row is longer.
const PIECE: u64 = 1 << 15;

pub fn merge(options: &Merge) -> Status {
    let parts = match parts(&options.files) {
        Ok(parts) => parts,
        Err(refused) => return refused.report(),
    };
    let path = options.output.file.as_deref();
    let is_part = |output: &Path| std::fs::canonicalize(output).ok();
    if let Some(target) = path.and_then(is_part)
        && parts.iter().any(|part| is_part(&part.path).as_deref() == Some(&target))
    {
        return Refused::wrong(&target, "is a part and would be overwritten").report();
    }
    let mut refused = None;
    let written = write_by(path, |out| {
        join(parts, out).map_err(|found| match found {
            Failed::Write(error) => error,
            Failed::Part(found) => {
                refused = Some(found);
                io::Error::other("a part was refused")
            }
        })
    });
    match (refused, written) {
        (Some(refused), _) => refused.report(),
        (None, written) => crate::report_delivery(path, written),
    }
}

/// Why a part cannot be used.
struct Refused {
    text: String,
    status: Status,
}

enum Failed {
    Write(io::Error),
    Part(Refused),
}

impl Refused {
    fn wrong(path: &Path, why: &str) -> Refused {
        Refused { text: format!("`{}` {why}", path.display()), status: Status::Usage }
    }

    fn unreadable(path: &Path, error: &io::Error) -> Refused {
        Refused { text: format!("cannot read `{}`: {error}", path.display()), status: Status::Io }
    }

    fn report(self) -> Status {
        report_error(&self.text);
        self.status
    }
}

/// The parts in their order, once it is certain that they are whole, of one study, and all of it.
fn parts(files: &[PathBuf]) -> Result<Vec<Part>, Refused> {
    let mut parts: Vec<Part> = files.iter().map(|path| part(path)).collect::<Result<_, _>>()?;
    parts.sort_by_key(|part| part.header.shard.index);
    let first = &parts[0];
    let (count, same) = (first.header.shard.count, |a: &Header, b: &Header| {
        a.study == b.study && a.cases == b.cases && a.shard.count == b.shard.count
    });
    if let Some(other) = parts.iter().find(|part| !same(&part.header, &first.header)) {
        return Err(Refused::wrong(
            &other.path,
            &format!("belongs to another study, or another division of it, than `{}`", first.path.display()),
        ));
    }
    if let Some(pair) = parts.windows(2).find(|pair| pair[0].header.shard == pair[1].header.shard) {
        let why = format!("is part {} like `{}`", pair[1].header.shard.index, pair[0].path.display());
        return Err(Refused::wrong(&pair[1].path, &why));
    }
    let is_there = |index: &u64| parts.binary_search_by_key(index, |part| part.header.shard.index).is_ok();
    let mut missing = (0..count).filter(|index| !is_there(index));
    let named: Vec<String> = missing.by_ref().take(NAMED).map(|index| format!("{index}/{count}")).collect();
    if !named.is_empty() {
        let more = missing.count();
        let more = if more > 0 { format!(" and {more} more") } else { String::new() };
        let text = format!("missing parts: {}{more}", named.join(", "));
        return Err(Refused { text, status: Status::Usage });
    }
    Ok(parts)
}

fn part(path: &Path) -> Result<Part, Refused> {
    let unreadable = |error: io::Error| Refused::unreadable(path, &error);
    let mut file = open_regular(path).map_err(unreadable)?;
    let finished = is_finished(&mut file).map_err(unreadable)?;
    let Some((header, _)) = Header::of_file(file).map_err(unreadable)? else {
        return Err(Refused::wrong(path, "is no part of a sweep; parts are written with `--shard`"));
    };
    if !finished {
        return Err(Refused::wrong(path, "is cut off or damaged: compute this part again"));
    }
    let offset = header.to_string().len() as u64;
    Ok(Part { path: path.to_path_buf(), header, offset, piece: Vec::new(), at: 0 })
}

impl Part {
    /// The next line with its line feed.
    fn line(&mut self) -> Result<&[u8], Refused> {
        if self.at == self.piece.len() {
            self.read().map_err(|error| Refused::unreadable(&self.path, &error))?;
        }
        let rest = &self.piece[self.at..];
        let length = rest.iter().position(|byte| *byte == b'\n').map_or(rest.len(), |at| at + 1);
        self.at += length;
        Ok(&self.piece[self.at - length..self.at])
    }

    /// Reads the next whole lines.
    fn read(&mut self) -> io::Result<()> {
        let mut file = File::open(&self.path)?;
        file.seek(SeekFrom::Start(self.offset))?;
        let mut reader = BufReader::new(file);
        self.piece.clear();
        reader.by_ref().take(PIECE).read_to_end(&mut self.piece)?;
        if !self.piece.ends_with(b"\n") {
            reader.read_until(b'\n', &mut self.piece)?;
        }
        self.offset += self.piece.len() as u64;
        self.at = 0;
        Ok(())
    }

    fn ends_early(&self) -> Failed {
        Failed::Part(Refused::wrong(&self.path, "has missing or changed rows: compute this part again"))
    }
}

/// Writes the rows of all parts in the order of their cases.
fn join(mut parts: Vec<Part>, out: &mut dyn Write) -> Result<(), Failed> {
    let mut out = io::BufWriter::with_capacity(1 << 16, out);
    let heading = parts[0].line().map_err(Failed::Part)?.to_vec();
    for part in &mut parts[1..] {
        if part.line().map_err(Failed::Part)? != heading {
            return Err(part.ends_early());
        }
    }
    out.write_all(&heading).map_err(Failed::Write)?;
    let (cases, count) = (parts[0].header.cases, parts.len() as u64);
    for case in 0..cases {
        let part = &mut parts[(case % count) as usize];
        let number = case.to_string();
        let row = part.line().map_err(Failed::Part)?;
        if !row.starts_with(number.as_bytes()) || row.get(number.len()) != Some(&b',') {
            return Err(part.ends_early());
        }
        out.write_all(row).map_err(Failed::Write)?;
    }
    for part in &mut parts {
        if !part.line().map_err(Failed::Part)?.starts_with(END.as_bytes()) {
            return Err(part.ends_early());
        }
    }
    out.flush().map_err(Failed::Write)
}
