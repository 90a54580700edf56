//! Places in source texts: files, byte ranges, lines and columns.

use super::readable::readable;
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// Index of a file in [`Sources`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct FileId(pub u8);

/// A byte range of a file, eight bytes large: a scene of a million bodies keeps millions of them.
///
/// The length saturates at [`Span::MAX_LEN`]; only spans of whole files are longer, and only their start is ever shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Span {
    start: u32,
    /// File in the upper 8 bits, length in the lower 24.
    file_and_len: u32,
}

impl Span {
    pub const MAX_LEN: usize = (1 << 24) - 1;

    /// The range `start..end` of a file. `start` is below 4 GiB: see `syntax` for the limit of a file's size.
    #[inline]
    pub fn new(file: FileId, start: usize, end: usize) -> Span {
        let len = end.saturating_sub(start).min(Span::MAX_LEN) as u32;
        Span { start: start as u32, file_and_len: u32::from(file.0) << 24 | len }
    }

    #[inline]
    pub fn file(self) -> FileId {
        FileId((self.file_and_len >> 24) as u8)
    }

    #[inline]
    pub fn start(self) -> usize {
        self.start as usize
    }

    #[inline]
    pub fn end(self) -> usize {
        self.start() + self.len()
    }

    #[inline]
    pub fn len(self) -> usize {
        (self.file_and_len & 0x00ff_ffff) as usize
    }

    #[inline]
    pub fn is_empty(self) -> bool {
        self.len() == 0
    }

    /// The smallest span that covers both; both are in one file.
    pub fn to(self, other: Span) -> Span {
        Span::new(self.file(), self.start().min(other.start()), self.end().max(other.end()))
    }

    pub fn range(self) -> std::ops::Range<usize> {
        self.start()..self.end()
    }
}

/// The role of a file in a run, which decides how its places are shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SourceKind {
    /// A model file, or a file of components.
    Model,
    /// A TOML file of settings.
    Settings,
    /// The `--set NAME=VALUE` arguments, one per line.
    Arguments,
    /// A CSV file that a signal is read from.
    Table,
}

/// A named text.
#[derive(Clone, Debug)]
pub struct SourceFile {
    pub kind: SourceKind,
    /// The name shown in messages: the path as the user gave it, `<stdin>`, or `--set`.
    pub name: String,
    /// Directory that relative paths in the file (tables of signals) are relative to.
    pub directory: PathBuf,
    pub text: String,
    /// Offset and value of the first byte that is not UTF-8; the text is good up to there.
    pub first_bad_byte: Option<(usize, u8)>,
    /// The reason why the file could not be read; its text is then empty.
    pub unread: Option<String>,
}

impl SourceFile {
    pub fn model(name: impl Into<String>, text: impl Into<String>) -> SourceFile {
        let name = name.into();
        let directory = Path::new(&name).parent().map(Path::to_path_buf).unwrap_or_default();
        SourceFile { kind: SourceKind::Model, name, directory, text: text.into(), first_bad_byte: None, unread: None }
    }

    /// A file from its bytes. A byte that is not UTF-8 is read as U+FFFD; [`SourceFile::first_bad_byte`] remembers the first.
    pub fn decode(kind: SourceKind, name: impl Into<String>, bytes: Vec<u8>) -> SourceFile {
        match String::from_utf8(bytes) {
            Ok(text) => SourceFile { kind, ..SourceFile::model(name, text) },
            Err(error) => {
                let first_bad_byte =
                    Some((error.utf8_error().valid_up_to(), error.as_bytes()[error.utf8_error().valid_up_to()]));
                SourceFile {
                    kind,
                    first_bad_byte,
                    ..SourceFile::model(name, String::from_utf8_lossy(error.as_bytes()))
                }
            }
        }
    }

    /// A file that could not be read, and why.
    pub fn unread(kind: SourceKind, name: impl Into<String>, reason: impl Into<String>) -> SourceFile {
        SourceFile { kind, unread: Some(reason.into()), ..SourceFile::model(name, "") }
    }

    /// The name of a file that this one names, relative to its directory.
    pub fn relative_name(&self, written: &str) -> String {
        self.directory.join(written).to_string_lossy().into_owned()
    }

    /// The file's name without directory and extension: the model's name if it declares none. It is printed, so characters
    /// that would control a terminal are made visible.
    pub fn stem(&self) -> String {
        let stem = Path::new(&self.name).file_stem().map(|stem| stem.to_string_lossy());
        stem.map_or_else(|| "model".into(), |stem| readable(&stem).into_owned())
    }

    /// Line and column of a byte offset, both from 1, the column in characters.
    pub fn position(&self, offset: usize) -> Position {
        let offset = floor_char_boundary(&self.text, offset);
        let before = &self.text[..offset];
        let line_start = before.rfind('\n').map_or(0, |at| at + 1);
        let line = before.bytes().filter(|&b| b == b'\n').count() + 1;
        Position { line, column: self.text[line_start..offset].chars().count() + 1 }
    }
}

fn floor_char_boundary(text: &str, offset: usize) -> usize {
    let mut at = offset.min(text.len());
    while !text.is_char_boundary(at) {
        at -= 1;
    }
    at
}

/// A place in a text for people: counted from 1, columns in characters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Position {
    pub line: usize,
    pub column: usize,
}

/// The texts of one run, in the order in which they were added.
#[derive(Clone, Debug, Default)]
pub struct Sources {
    files: Vec<SourceFile>,
    /// The target of each `use`, by the file and the name as written in it.
    used: HashMap<(FileId, String), FileId>,
}

impl Sources {
    pub fn new() -> Sources {
        Sources::default()
    }

    /// Adds a file. A run has a model, a settings file, the arguments and some tables: fewer than 256.
    pub fn add(&mut self, file: SourceFile) -> FileId {
        let id = u8::try_from(self.files.len()).expect("a run reads a handful of files");
        self.files.push(file);
        FileId(id)
    }

    pub fn len(&self) -> usize {
        self.files.len()
    }

    pub fn is_empty(&self) -> bool {
        self.files.is_empty()
    }

    /// The model and the files that it uses, unless they could not be read.
    pub fn models(&self) -> impl Iterator<Item = FileId> {
        let is_model = |file: &SourceFile| file.kind == SourceKind::Model && file.unread.is_none();
        (0..).map(FileId).zip(&self.files).filter(move |(_, file)| is_model(file)).map(|(id, _)| id)
    }

    /// All files, in the order in which they were added.
    pub fn files(&self) -> impl Iterator<Item = &SourceFile> {
        self.files.iter()
    }

    pub fn file(&self, id: FileId) -> &SourceFile {
        &self.files[id.0 as usize]
    }

    /// The table that a file names, if it was added.
    pub fn table(&self, of: FileId, written: &str) -> Option<FileId> {
        let name = self.file(of).relative_name(written);
        let place = self.files.iter().position(|file| file.kind == SourceKind::Table && file.name == name)?;
        u8::try_from(place).ok().map(FileId)
    }

    /// Remembers which file a `use` of another one names.
    pub fn link(&mut self, of: FileId, written: impl Into<String>, to: FileId) {
        self.used.insert((of, written.into()), to);
    }

    /// The file that the text of a `use` names, quotes included, if it was added.
    pub fn used_file(&self, text: Span) -> Option<FileId> {
        let written = self.slice(text).trim_matches('"');
        self.used.get(&(text.file(), written.to_string())).copied()
    }

    pub fn text(&self, id: FileId) -> &str {
        &self.file(id).text
    }

    /// The text that a span covers.
    pub fn slice(&self, span: Span) -> &str {
        self.text(span.file()).get(span.range()).unwrap_or("")
    }

    /// The positions of the start and the end of a span.
    pub fn positions(&self, span: Span) -> (Position, Position) {
        let file = self.file(span.file());
        (file.position(span.start()), file.position(span.end()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_count_characters_and_start_at_one() {
        let file = SourceFile::model("a.vib", "param ω = 1\nparam b = 2\n");
        assert_eq!(file.position(0), Position { line: 1, column: 1 });
        assert_eq!(file.position("param ω".len()), Position { line: 1, column: 8 });
        assert_eq!(file.position("param ω = 1\npa".len()), Position { line: 2, column: 3 });
    }

    #[test]
    fn a_span_is_small() {
        assert_eq!(std::mem::size_of::<Span>(), 8);
        let span = Span::new(FileId(3), 10, 14);
        assert_eq!((span.file(), span.range()), (FileId(3), 10..14));
        assert_eq!(span.to(Span::new(FileId(3), 20, 22)).range(), 10..22);
    }
}
