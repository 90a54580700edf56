//! Data shared by the open files: the files in which a name may be used, and findings in files that a model uses.

use super::answers::{self, Places};
use super::place::Encoding;
use super::{Server, Text, path};
use crate::base::{Diagnostic, FileId, Span};
use crate::editor::document::Document;
use crate::editor::lexed::Lexed;
use crate::editor::project::{Project, ProjectFile};
use gen_lsp_types::{Location, Uri};

/// A file of a project: in which document, and as which of its texts.
struct Entry<'a> {
    key: &'a str,
    text: &'a Text,
    document: &'a Document,
    id: FileId,
}

impl Text {
    /// The key of a file of its document.
    fn key_of(&self, id: FileId) -> Option<&str> {
        self.keys.get(usize::from(id.0))?.as_deref()
    }
}

impl Server<'_> {
    /// The key that identifies a file: its path without links. For a text that has not been saved, its future path.
    pub(super) fn key_of(&self, uri: &Uri) -> String {
        let path = path(uri);
        if !uri.0.starts_with("file://") {
            return path;
        }
        let own = std::path::Path::new(&path).parent().map(|folder| folder.to_string_lossy().into_owned());
        let own: Vec<String> = own.into_iter().collect();
        let folders = if self.folders.is_empty() { &own } else { &self.folders };
        (self.read)(&path, folders, super::Named::Components).map_or_else(|_| super::plain(&path), |(key, _)| key)
    }

    /// Answers a question about names: in a text and the files that it uses, and in whatever else is open if `is_wide`.
    pub(super) fn in_project<'a, R>(&'a self, asked: usize, is_wide: bool, ask: impl FnOnce(&Project) -> R) -> R {
        let mut texts = vec![&self.texts[asked]];
        texts.extend(
            self.texts.iter().enumerate().filter(|(index, _)| is_wide && *index != asked).map(|(_, text)| text),
        );
        let texts: Vec<(&Text, &Document)> =
            texts.into_iter().filter_map(|text| Some((text, text.document.as_ref()?))).collect();
        // Each file once, with the editor's content if it is open.
        let mut files: Vec<Entry> = Vec::new();
        let mut enter = |entry: Entry<'a>| {
            if files.iter().all(|known| known.key != entry.key) {
                files.push(entry);
            }
        };
        for &(text, document) in &texts {
            enter(Entry { key: &text.key, text, document, id: document.file });
            for (key, id) in used_files(text, document) {
                let open = self.opened_as(key).and_then(|open| Some((open, open.document.as_ref()?)));
                enter(match open {
                    Some((text, document)) => Entry { key, text, document, id: document.file },
                    None => Entry { key, text, document, id },
                });
            }
        }
        let others: Vec<Option<Lexed>> = files
            .iter()
            .map(|Entry { document, id, .. }| (*id != document.file).then(|| Lexed::new(document.sources.text(*id))))
            .collect();
        let asked: Vec<(&str, FileId)> = texts.first().map_or(Vec::new(), |(text, document)| {
            std::iter::once((&*text.key, document.file)).chain(used_files(text, document)).collect()
        });
        let list = files.iter().zip(&others).map(|(Entry { key, text, document, id }, lexed)| {
            let uses = document.tree.uses.iter().filter(|using| using.text.file() == *id);
            let used = uses.filter_map(|using| text.key_of(document.sources.used_file(using.text)?));
            let uses = used.filter_map(|key| files.iter().position(|known| known.key == key)).collect();
            let id = asked.iter().find(|(known, _)| known == key).map(|(_, id)| *id);
            ProjectFile { key: key.to_string(), lexed: lexed.as_ref().unwrap_or(document), id, uses }
        });
        ask(&Project::new(list.collect()))
    }

    fn opened_as(&self, key: &str) -> Option<&Text> {
        self.texts.iter().find(|text| text.key == key)
    }

    /// The URI of a file: the client's own if the file is open; `None` for a file that comes with the program.
    pub(super) fn uri(&self, key: &str) -> Option<Uri> {
        match self.opened_as(key) {
            Some(text) => Some(text.uri.clone()),
            None => std::path::Path::new(key).is_absolute().then(|| Uri(file_uri(key))),
        }
    }

    /// The findings in a text: those of its own analysis, and those that models using it have in it.
    pub(super) fn findings(&self, index: usize) -> Vec<gen_lsp_types::Diagnostic> {
        let text = &self.texts[index];
        let Some(document) = &text.document else { return Vec::new() };
        let places = OfText { server: self, text, document };
        let mut list = answers::diagnostics(document, self.encoding, &places);
        for other in self.texts.iter().filter(|other| other.uri != text.uri) {
            let Some(user) = &other.document else { continue };
            let own =
                used_files(other, user).find(|(key, id)| *key == text.key && user.sources.text(*id) == document.text());
            let Some((_, id)) = own else { continue };
            let places = OfText { server: self, text: other, document: user };
            for finding in user.findings.iter().filter(|finding| finding.primary.span.file() == id) {
                let range = self.encoding.range(document, finding.primary.span.range());
                let found = answers::diagnostic_at(range, &places, finding);
                if !list.iter().any(|known| known.code == found.code && known.range == found.range) {
                    list.push(found);
                }
            }
        }
        list
    }

    /// The places of a finding of a text.
    pub(super) fn places_of<'a>(&'a self, text: &'a Text, document: &'a Document) -> impl Places + 'a {
        OfText { server: self, text, document }
    }
}

/// The places of a document's findings.
struct OfText<'a, 'b> {
    server: &'a Server<'b>,
    text: &'a Text,
    document: &'a Document,
}

impl Places for OfText<'_, '_> {
    fn location(&self, span: Span) -> Option<Location> {
        let OfText { server, text, document } = self;
        let encoding: Encoding = server.encoding;
        if span.file() == document.file {
            return Some(Location { uri: text.uri.clone(), range: encoding.range(document, span.range()) });
        }
        let key = text.key_of(span.file())?;
        let uri = server.uri(key)?;
        Some(Location { uri, range: encoding.range(&Lexed::new(document.sources.text(span.file())), span.range()) })
    }
}

/// The files that a text uses, directly or not, by their keys.
fn used_files<'a>(text: &'a Text, document: &'a Document) -> impl Iterator<Item = (&'a str, FileId)> {
    let others = document.sources.models().filter(|id| *id != document.file);
    others.filter_map(|id| Some((text.key_of(id)?, id)))
}

/// The file URI of a path.
fn file_uri(path: &str) -> String {
    let mut uri = "file://".to_string();
    for byte in path.bytes() {
        match byte {
            b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'/' | b'-' | b'.' | b'_' | b'~' => uri.push(char::from(byte)),
            _ => uri += &format!("%{byte:02X}"),
        }
    }
    uri
}

/// The place in a document at which a finding is shown: its own place or, for a finding in a used file, a related place
/// or the `use` that leads there.
pub(super) fn shown_at(document: &Document, finding: &Diagnostic) -> std::ops::Range<usize> {
    let mut spans = std::iter::once(&finding.primary).chain(&finding.related).map(|label| label.span);
    let uses = document.tree.uses.iter().filter(|using| using.text.file() == document.file);
    let leads = |text: &Span| document.sources.used_file(*text) == Some(finding.primary.span.file());
    let own_uses: Vec<Span> = uses.map(|using| using.text).collect();
    // A file that is used by a used file has no `use` in this text.
    let using = || own_uses.iter().copied().find(leads).or_else(|| own_uses.first().copied());
    let span = spans.find(|span| span.file() == document.file).or_else(using);
    let range = span.map_or(0..0, |span| span.range());
    range.start.min(document.text().len())..range.end.min(document.text().len())
}
