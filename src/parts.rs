//! Parts of a study as files: their first line, which study they belong to, progress that a later run continues. See
//! docs/cli.md#shards.

use sha2::{Digest, Sha256};
use std::fmt;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, BufRead, BufReader, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use vibc::base::Sources;
use vibc::cli::Shard;

/// The first line of a part.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Header {
    pub shard: Shard,
    /// Cases of the whole study.
    pub cases: u64,
    /// Everything that the study depends on: texts, options, the version of the program.
    pub study: String,
}

/// The beginning of the last line of a part, without which it was cut off; the SHA-256 of all before it follows.
pub const END: &str = "# end ";
/// Bytes of the last line.
const END_LENGTH: u64 = END.len() as u64 + 65;

const OPENING: &str = "# vibc sweep part ";

/// No header is longer.
const LONGEST_HEADER: u64 = 256;

impl fmt::Display for Header {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Header { shard, cases, study } = self;
        writeln!(f, "{OPENING}{}/{} of {cases} cases, study {study}", shard.index, shard.count)
    }
}

impl Header {
    /// The header in a first line; `None` if it is not one.
    pub fn read(line: &str) -> Option<Header> {
        let (shard, rest) = line.strip_prefix(OPENING)?.split_once(" of ")?;
        let (cases, study) = rest.trim_end_matches('\n').split_once(" cases, study ")?;
        let (index, count) = shard.split_once('/')?;
        let shard = Shard { index: index.parse().ok()?, count: count.parse().ok()? };
        let header = Header { shard, cases: cases.parse().ok()?, study: study.to_string() };
        (header.to_string() == line).then_some(header)
    }

    /// The header of a file, and a reader behind it; `None` if it has none.
    pub fn of_file(file: File) -> io::Result<Option<(Header, BufReader<File>)>> {
        let mut reader = BufReader::new(file);
        let mut line = Vec::new();
        reader.by_ref().take(LONGEST_HEADER).read_until(b'\n', &mut line)?;
        Ok(String::from_utf8(line).ok().and_then(|line| Header::read(&line)).map(|header| (header, reader)))
    }

    /// The number of cases in the part.
    pub fn rows(&self) -> u64 {
        self.shard.rows(self.cases)
    }
}

/// The SHA-256 of everything that a study depends on.
pub fn fingerprint(sources: &Sources, options: &str, heading: &str) -> String {
    let mut hash = Sha256::new();
    let mut add = |text: &str| {
        hash.update((text.len() as u64).to_le_bytes());
        hash.update(text.as_bytes());
    };
    add(env!("CARGO_PKG_VERSION"));
    add(options);
    add(heading);
    for file in sources.files() {
        add(&file.text);
    }
    hexadecimal(hash)
}

fn hexadecimal(hash: Sha256) -> String {
    hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}

/// The last line of a part of which everything else is in the first `length` bytes of a file.
fn last_line(file: &mut File, length: u64) -> io::Result<String> {
    file.seek(SeekFrom::Start(0))?;
    let (mut hash, mut buffer, mut left) = (Sha256::new(), vec![0; 1 << 16], length);
    while left > 0 {
        let most = left.min(buffer.len() as u64) as usize;
        file.read_exact(&mut buffer[..most])?;
        hash.update(&buffer[..most]);
        left -= most as u64;
    }
    Ok(format!("{END}{}\n", hexadecimal(hash)))
}

/// Whether a file ends as a finished part does, and is as it was written.
pub fn is_finished(file: &mut File) -> io::Result<bool> {
    let length = file.metadata()?.len();
    if length < END_LENGTH {
        return Ok(false);
    }
    let line = last_line(file, length - END_LENGTH)?;
    let mut end = [0; END_LENGTH as usize];
    file.read_exact(&mut end)?;
    file.seek(SeekFrom::Start(0))?;
    Ok(end == line.as_bytes())
}

/// The rows of a part so far, in `FILE.partial`.
pub struct Progress {
    path: PathBuf,
    pub file: File,
    /// Rows that are in the file already.
    pub done: u64,
    /// Bytes of the header.
    start: u64,
}

/// The name of the file with the progress of another.
pub fn partial(path: &Path) -> PathBuf {
    let mut name = path.as_os_str().to_os_string();
    name.push(".partial");
    PathBuf::from(name)
}

impl Progress {
    /// Opens the progress of a part; that of another study is dropped. A file that is no progress is not touched.
    pub fn open(path: &Path, header: &Header, heading: &str) -> io::Result<Progress> {
        let path = partial(path);
        let mut file = OpenOptions::new().read(true).write(true).create(true).truncate(false).open(&path)?;
        if !file.metadata()?.is_file() {
            return Err(progress_error(&path, "it is not a regular file"));
        }
        if let Err(TryLockError::WouldBlock) = file.try_lock() {
            return Err(progress_error(&path, "another run is writing it"));
        }
        let first = header.to_string() + heading;
        let start = header.to_string().len() as u64;
        let (done, length) = match Header::of_file(file.try_clone()?)? {
            Some((found, reader)) if found == *header => rows_in(reader, header, heading)?,
            Some(_) => (0, 0),
            None if file.metadata()?.len() == 0 => (0, 0),
            None => return Err(progress_error(&path, "it is no progress of a sweep")),
        };
        let length = match length {
            0 => {
                file.set_len(0)?;
                file.seek(SeekFrom::Start(0))?;
                file.write_all(first.as_bytes())?;
                first.len() as u64
            }
            length => start + length,
        };
        file.set_len(length)?;
        file.seek(SeekFrom::Start(length))?;
        Ok(Progress { path, file, done, start })
    }

    /// Closes the part and gives it its name.
    pub fn finish_part(mut self, to: &Path) -> io::Result<()> {
        let length = self.file.stream_position()?;
        let line = last_line(&mut self.file, length)?;
        self.file.write_all(line.as_bytes())?;
        self.file.sync_all()?;
        fs::rename(&self.path, to)
    }

    /// Hands the rows without the header to `write`, and removes the progress.
    pub fn finish_whole(mut self, write: impl FnOnce(&mut File) -> io::Result<()>) -> io::Result<()> {
        self.file.seek(SeekFrom::Start(self.start))?;
        write(&mut self.file)?;
        fs::remove_file(&self.path)
    }
}

fn progress_error(progress: &Path, why: &str) -> io::Error {
    io::Error::other(format!("its progress would be in `{}`, but {why}", progress.display()))
}

/// The complete rows behind a header, from the first one on without a gap, and the bytes of them and of the heading; none if
/// the heading is another.
fn rows_in(mut reader: BufReader<File>, header: &Header, heading: &str) -> io::Result<(u64, u64)> {
    let mut line = Vec::new();
    reader.read_until(b'\n', &mut line)?;
    if line != heading.as_bytes() {
        return Ok((0, 0));
    }
    let (mut done, mut length) = (0, line.len() as u64);
    while done < header.rows() {
        line.clear();
        reader.read_until(b'\n', &mut line)?;
        let number = header.shard.case(done).to_string();
        if !(line.starts_with(number.as_bytes()) && line.get(number.len()) == Some(&b',') && line.ends_with(b"\n")) {
            break;
        }
        done += 1;
        length += line.len() as u64;
    }
    Ok((done, length))
}
