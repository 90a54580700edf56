//! The files of a run: reads every text within limits, and writes results completely or not at all.
//! See docs/cli.md#streams-and-exit-status.

pub use crate::named::Named;

use crate::named::{add_named, read_limited};
use crate::{Status, report_error, write_to};
use serde::Serialize;
use serde_json::ser::{Formatter, Serializer};
use std::ffi::OsString;
use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use vibc::backend::diagnostics;
use vibc::base::readable::escape;
use vibc::base::{FileId, SourceFile, SourceKind, Sources};
use vibc::cli::{MessageFormat, Messages, OverrideOptions};
use vibc::model::Overrides;

/// The texts of a run.
pub struct Input {
    pub sources: Sources,
    pub model: FileId,
    pub overrides: Overrides,
}

/// A file that could not be read.
pub struct Unreadable {
    path: PathBuf,
    error: io::Error,
}

/// Reads all input of a run; an error if the run would write one of these files.
pub fn open<'a>(
    model: &Path,
    overrides: &OverrideOptions,
    outputs: impl IntoIterator<Item = &'a PathBuf>,
    messages: &Messages,
) -> Result<Input, Status> {
    let input = read_all(model, overrides).map_err(|unreadable| unreadable.report(messages))?;
    refuse_overwriting(&input, model, overrides, outputs)?;
    Ok(input)
}

/// Refuses to overwrite a file that the run reads, or to write two outputs to one file.
pub fn refuse_overwriting<'a>(
    input: &Input,
    model: &Path,
    overrides: &OverrideOptions,
    outputs: impl IntoIterator<Item = &'a PathBuf>,
) -> Result<(), Status> {
    let mut written: Vec<PathBuf> = Vec::new();
    for output in outputs {
        // Before they are written, files are told apart by their folders and names.
        let folder = output.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let file = fs::canonicalize(folder).ok().zip(output.file_name()).map(|(folder, name)| folder.join(name));
        if let Some(file) = file.map(|file| fs::canonicalize(&file).unwrap_or(file)).filter(|file| !is_stream(file)) {
            if written.contains(&file) {
                report_error(&format!(
                    "`{}` is to be written twice: the second would replace the first",
                    output.display()
                ));
                return Err(Status::Usage);
            }
            written.push(file);
        }
        let Ok(target) = fs::canonicalize(output) else { continue };
        // A name that is not valid text is in the sources only in displayable form, so the paths are compared too; tables
        // are only in the sources.
        let named = input.sources.files().map(|file| Path::new(&file.name));
        let mut inputs = std::iter::once(model).chain(overrides.settings_file.as_deref()).chain(named);
        if target.is_file() && inputs.any(|input| fs::canonicalize(input).is_ok_and(|input| input == target)) {
            report_error(&format!("`{}` is an input file and would be overwritten", output.display()));
            return Err(Status::Usage);
        }
    }
    Ok(())
}

/// Whether what is written there is no file that is replaced, as `/dev/null`.
fn is_stream(path: &Path) -> bool {
    path.exists() && !path.is_file()
}

pub fn read_all(model: &Path, overrides: &OverrideOptions) -> Result<Input, Unreadable> {
    let mut sources = Sources::new();
    let path = model;
    let model = sources.add(read(path, SourceKind::Model)?);
    let settings = match &overrides.settings_file {
        Some(path) => Some(sources.add(read(path, SourceKind::Settings)?)),
        None => None,
    };
    let arguments = (!overrides.settings.is_empty()).then(|| sources.add(arguments("--set", &overrides.settings)));
    let outside = "it lies outside the model's folder; `--root` allows another";
    add_named(&mut sources, model, path, overrides.root.as_deref(), outside);
    Ok(Input { sources, model, overrides: Overrides { arguments, settings, literals: overrides.literals.into() } })
}

/// A file, or standard input for `-`.
pub fn read(path: &Path, kind: SourceKind) -> Result<SourceFile, Unreadable> {
    let (name, content) = if path == Path::new("-") {
        ("<stdin>".to_string(), read_limited(io::stdin().lock()))
    } else {
        (path.to_string_lossy().into_owned(), File::open(path).and_then(read_limited))
    };
    let bytes = content.map_err(|error| Unreadable { path: path.to_path_buf(), error })?;
    Ok(SourceFile::decode(kind, name, bytes))
}

/// The values of an option as a file, one per line.
pub fn arguments(option: &str, values: &[String]) -> SourceFile {
    let text: String = values.iter().map(|value| format!("{value}\n")).collect();
    SourceFile { kind: SourceKind::Arguments, ..SourceFile::model(option, text) }
}

impl Unreadable {
    /// Reports it like a diagnostic, with the code `io`.
    pub fn report(&self, messages: &Messages) -> Status {
        let (name, error) = (self.path.to_string_lossy(), &self.error);
        let name = diagnostics::readable(&name);
        let text = match messages.message_format {
            MessageFormat::Human => format!("error: cannot read `{name}`: {error}\n"),
            MessageFormat::Short => format!("{name}:1:1: error[io]: cannot read the file: {error}\n"),
            MessageFormat::Json => diagnostics::unreadable_json(&self.path.to_string_lossy(), &error.to_string()),
        };
        write_to(&mut io::stderr().lock(), &text);
        Status::Io
    }
}

/// Writes the result to standard output, or completely into a file.
pub fn write_result(path: Option<&Path>, text: &str) -> io::Result<()> {
    write_by(path, |out| out.write_all(text.as_bytes()))
}

/// Like [`write_result`], of a value as JSON and a line feed, piece by piece: of a large scene the whole text never exists.
pub fn write_json(path: Option<&Path>, value: &impl Serialize) -> io::Result<()> {
    write_by(path, |out| {
        let mut out = BufWriter::with_capacity(JSON_AT_ONCE, out);
        value.serialize(&mut Serializer::with_formatter(&mut out, Harmless))?;
        out.write_all(b"\n")?;
        out.flush()
    })
}

/// Bytes of JSON that are written at once.
const JSON_AT_ONCE: usize = 1 << 16;

/// Compact JSON without characters that control a terminal.
struct Harmless;

impl Formatter for Harmless {
    fn write_string_fragment<W: ?Sized + Write>(&mut self, out: &mut W, fragment: &str) -> io::Result<()> {
        if fragment.is_ascii() && !fragment.contains('\u{7f}') {
            return out.write_all(fragment.as_bytes());
        }
        out.write_all(escape(fragment.to_string()).as_bytes())
    }
}

/// Writes a result piece by piece to standard output, or completely into a file.
pub fn write_by(path: Option<&Path>, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    match path {
        Some(path) if path != Path::new("-") => replace_file(path, write),
        _ => {
            let mut stdout = io::stdout().lock();
            match write(&mut stdout).and_then(|()| stdout.flush()) {
                // Whoever reads the output has stopped reading; that is not an error.
                Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
                result => result,
            }
        }
    }
}

/// Replaces the content of a file completely or not at all: writes a new file beside it, then renames it. Anything but a
/// regular file (a device, a pipe) is written to directly; for a link, its target is replaced, not the link.
fn replace_file(path: &Path, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let existing = fs::metadata(path);
    if existing.as_ref().is_ok_and(|metadata| !metadata.is_file()) {
        return write(&mut OpenOptions::new().write(true).open(path)?);
    }
    let existing = existing.ok();
    let target = if existing.is_some() { fs::canonicalize(path)? } else { resolve_missing(path)? };
    let (beside, file) = new_beside(&target, existing.is_some())?;
    let written = write_new(file, write, existing).and_then(|()| fs::rename(&beside, &target));
    if written.is_err() {
        let _ = fs::remove_file(&beside);
    }
    written
}

/// The path that a name without a file leads to: a link may point to a file that does not exist yet.
fn resolve_missing(path: &Path) -> io::Result<PathBuf> {
    /// As many links as operating systems follow.
    const LINKS: usize = 40;
    let mut path = path.to_path_buf();
    for _ in 0..LINKS {
        match fs::read_link(&path) {
            Ok(target) => path = path.parent().unwrap_or(Path::new("")).join(target),
            Err(_) => return Ok(path),
        }
    }
    Err(io::Error::new(io::ErrorKind::InvalidInput, "it is a link that leads back to itself"))
}

/// Creates a new file in the same directory under an unused name; another run may have left one of ours behind.
fn new_beside(target: &Path, is_private: bool) -> io::Result<(PathBuf, File)> {
    const TRIES: u32 = 1000;
    let name =
        target.file_name().ok_or_else(|| io::Error::new(io::ErrorKind::InvalidInput, "it does not name a file"))?;
    let mut options = OpenOptions::new();
    options.write(true).create_new(true);
    #[cfg(unix)]
    if is_private {
        // Private until it gets the permissions of the file that it replaces.
        std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
    }
    let mut tries = 0..TRIES;
    loop {
        let mut hidden = OsString::from(".");
        hidden.push(name);
        hidden.push(format!(".{}-{}.new", std::process::id(), tries.next().unwrap_or(TRIES)));
        let path = target.with_file_name(hidden);
        match options.open(&path) {
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists && !tries.is_empty() => {}
            opened => return opened.map(|file| (path, file)),
        }
    }
}

fn write_new(
    mut file: File,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    replaced: Option<fs::Metadata>,
) -> io::Result<()> {
    if let Some(metadata) = replaced {
        keep_owner(&file, &metadata);
        file.set_permissions(metadata.permissions())?;
    }
    write(&mut file)?;
    file.sync_all()
}

/// Only the superuser can give files to other users, and only members of a group to that group; otherwise the writer owns
/// the file.
#[cfg(unix)]
fn keep_owner(file: &File, replaced: &fs::Metadata) {
    use std::os::unix::fs::{MetadataExt, fchown};
    let _ = fchown(file, None, Some(replaced.gid()));
    let _ = fchown(file, Some(replaced.uid()), None);
}

#[cfg(not(unix))]
fn keep_owner(_: &File, _: &fs::Metadata) {}
