//! The language server: messages of a client in, answers out. Only this module knows the protocol (LSP 3.17); it gets
//! the content of its answers from the neighbouring modules.
//!
//! A change marks its text as new; when no message waits, or a request needs it, the text goes through every stage and
//! its findings are published. Larger scenes are analysed as far as there is time; a second thread completes the
//! analysis, and its results are shown when they are ready.

mod answers;
mod files;
mod place;
mod requests;

use super::document::Document;
use crate::base::{FileId, SourceFile, SourceKind, Sources};
use crossbeam_channel::{Receiver, Sender, select, unbounded};
use gen_lsp_types::{
    DidChangeTextDocumentParams, DidCloseTextDocumentParams, DidOpenTextDocumentParams, PositionEncodingKind,
    PublishDiagnosticsParams, TextDocumentContentChangeEvent, Uri,
};
use lsp_server::{Connection, ErrorCode, Message, Notification, Request, RequestId, Response};
use place::Encoding;
use serde_json::Value;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::thread;

/// The purpose for which a model names a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Named {
    Table,
    Components,
}

/// Reads a file that a model names, if it lies below one of the folders. Returns the key that identifies the file and
/// its content, or the reason why it cannot be read.
pub type Read<'a> = dyn Fn(&str, &[String], Named) -> Result<(String, Vec<u8>), String> + 'a;

/// The way in which a client disconnected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Leave {
    /// The client sent `shutdown` before `exit`.
    Announced,
    /// Without `shutdown`.
    Unannounced,
}

/// Serves a client until it disconnects.
pub fn serve(connection: &Connection, read: &Read) -> Leave {
    let Some((id, params)) = wait_for_initialize(connection) else { return Leave::Unannounced };
    let folders = folders(&params);
    let capabilities = &params["capabilities"];
    let offered = position_encodings(&capabilities["general"]["positionEncodings"]);
    let encoding = Encoding::negotiate(offered.as_deref());
    let refreshes = capabilities["workspace"]["inlayHint"]["refreshSupport"].as_bool();
    let (jobs, results) = worker();
    let mut server = Server {
        connection,
        read,
        folders,
        encoding,
        refreshes: refreshes == Some(true),
        is_shut: false,
        texts: Vec::new(),
        jobs,
        refreshed: 0,
    };
    server.send(Response::new_ok(id, answers::capabilities(encoding)));
    server.run(&results);
    if server.is_shut { Leave::Announced } else { Leave::Unannounced }
}

/// Waits for `initialize`; `None` if the client disconnects first.
fn wait_for_initialize(connection: &Connection) -> Option<(RequestId, Value)> {
    loop {
        match connection.receiver.recv().ok()? {
            Message::Request(request) if request.method == "initialize" => return Some((request.id, request.params)),
            Message::Request(request) => {
                let (code, why) = (ErrorCode::ServerNotInitialized as i32, "the first request is `initialize`");
                // A client that has disconnected does not read this; the next receive reports it.
                let _ = connection.sender.send(Response::new_err(request.id, code, why.into()).into());
            }
            Message::Notification(notification) if notification.method == "exit" => return None,
            Message::Notification(_) | Message::Response(_) => {}
        }
    }
}

/// The position encodings that the client offers, in its order of preference; `None` if it names none.
///
/// Each capability is read by itself: the type of all of them would take longer to compile than the rest of the server, and one
/// that is malformed would lose the others.
fn position_encodings(offered: &Value) -> Option<Vec<PositionEncodingKind>> {
    serde_json::from_value(offered.clone()).ok()
}

/// The folders that the client has open.
fn folders(params: &Value) -> Vec<String> {
    let several = folders_of(&params["workspaceFolders"]);
    let one = params["rootUri"].as_str().filter(|_| several.is_empty());
    several.into_iter().chain(one.map(|uri| path(&Uri(uri.into())))).collect()
}

fn folders_of(list: &Value) -> Vec<String> {
    let uris = list.as_array().into_iter().flatten().filter_map(|folder| folder["uri"].as_str());
    uris.map(|uri| path(&Uri(uri.into()))).collect()
}

/// A text that the client has open.
struct Text {
    uri: Uri,
    /// The key that identifies the file: its path without links, if it is a file.
    key: String,
    version: i32,
    /// The text in the client's current version.
    text: String,
    /// The analysed document: of this text, or of an earlier one if `is_new`.
    document: Option<Document>,
    is_new: bool,
    /// The keys of the files of the document, by their numbers; `None` for a table.
    keys: Vec<Option<String>>,
    /// The findings that the client knows.
    published: Vec<gen_lsp_types::Diagnostic>,
    /// Whether a model that uses it has changed, and so possibly the findings in this text.
    is_touched: bool,
    /// Number of times that it went through the stages. A file that it uses may change without a new version of the
    /// text.
    revision: u64,
}

struct Server<'a> {
    connection: &'a Connection,
    read: &'a Read<'a>,
    /// The folders that the client has open; only files below them are read.
    folders: Vec<String>,
    encoding: Encoding,
    /// Whether the client requests hints again when it is notified.
    refreshes: bool,
    /// Whether the client has requested `shutdown`.
    is_shut: bool,
    texts: Vec<Text>,
    jobs: Sender<Job>,
    refreshed: i32,
}

/// A text whose complete analysis takes a while.
struct Job {
    uri: Uri,
    revision: u64,
    sources: Sources,
    file: FileId,
}

/// A version of a text whose analysis is complete.
struct Done {
    uri: Uri,
    revision: u64,
    document: Document,
}

/// Starts a thread that always takes the newest job, and ends with the server.
fn worker() -> (Sender<Job>, Receiver<Done>) {
    let (jobs, inbox) = unbounded::<Job>();
    let (outbox, results) = unbounded();
    thread::spawn(move || {
        while let Ok(mut job) = inbox.recv() {
            while let Ok(newer) = inbox.try_recv() {
                job = newer;
            }
            let Job { uri, revision, sources, file } = job;
            let found = catch_unwind(AssertUnwindSafe(|| Document::whole(sources, file, None)));
            let Ok(document) = found else { continue };
            if outbox.send(Done { uri, revision, document }).is_err() {
                break;
            }
        }
    });
    (jobs, results)
}

/// The error of a request without an answer.
pub struct Refusal {
    code: ErrorCode,
    message: String,
}

impl Server<'_> {
    fn run(&mut self, results: &Receiver<Done>) {
        loop {
            select! {
                recv(self.connection.receiver) -> message => match message {
                    Ok(message) => {
                        if self.message(message) {
                            return;
                        }
                    }
                    // The client has disconnected.
                    Err(_) => return,
                },
                recv(results) -> done => if let Ok(done) = done {
                    self.add(done);
                },
            }
            if self.connection.receiver.is_empty() {
                self.publish_all();
            }
        }
    }

    /// Handles a message; returns whether it was the last one.
    fn message(&mut self, message: Message) -> bool {
        match message {
            Message::Request(request) => self.request(request),
            Message::Notification(notification) if notification.method == "exit" => return true,
            Message::Notification(notification) if !self.is_shut => self.notification(notification),
            Message::Notification(_) | Message::Response(_) => {}
        }
        false
    }

    fn send(&self, message: impl Into<Message>) {
        // A client that has disconnected does not read this; the next receive reports it.
        let _ = self.connection.sender.send(message.into());
    }

    fn notification(&mut self, Notification { method, params }: Notification) {
        match method.as_str() {
            "textDocument/didOpen" => self.open(params),
            "textDocument/didChange" => self.change(params),
            "textDocument/didClose" => self.close(params),
            // A table or a file of components beside the model may have been written.
            "textDocument/didSave" => self.look_at_files_again(),
            "workspace/didChangeWorkspaceFolders" => self.change_folders(&params["event"]),
            _ => {}
        }
    }

    fn look_at_files_again(&mut self) {
        let names = |text: &str| text.contains("table") || text.contains("use");
        for index in 0..self.texts.len() {
            let key = self.key_of(&self.texts[index].uri);
            let text = &mut self.texts[index];
            text.is_new |= names(&text.text);
            text.key = key;
        }
    }

    /// Marks the models that use a text for a new check after it has changed.
    fn look_at_users_again(&mut self, of: &Uri) {
        let path = path(of);
        for text in self.texts.iter_mut().filter(|text| text.uri != *of) {
            let Some(document) = &text.document else { continue };
            let uses = |file: FileId| {
                let source = document.sources.file(file);
                source.unread.is_some() || plain(&source.name) == path
            };
            text.is_new |=
                document.tree.uses.iter().any(|using| document.sources.used_file(using.text).is_none_or(uses));
        }
    }

    fn change_folders(&mut self, event: &Value) {
        let removed = folders_of(&event["removed"]);
        self.folders.retain(|folder| !removed.contains(folder));
        self.folders.extend(folders_of(&event["added"]));
        self.look_at_files_again();
    }

    fn open(&mut self, params: Value) {
        let Ok(DidOpenTextDocumentParams { text_document: item }) = serde_json::from_value(params) else { return };
        self.texts.retain(|text| text.uri != item.uri);
        let (uri, version, text) = (item.uri, item.version, item.text);
        self.look_at_users_again(&uri);
        self.texts.push(Text {
            key: self.key_of(&uri),
            uri,
            version,
            text,
            document: None,
            is_new: true,
            keys: Vec::new(),
            published: Vec::new(),
            is_touched: false,
            revision: 0,
        });
    }

    fn change(&mut self, params: Value) {
        let Ok(DidChangeTextDocumentParams { text_document, content_changes }) = serde_json::from_value(params) else {
            return;
        };
        let uri = text_document.text_document_identifier.uri;
        let Some(text) = self.texts.iter_mut().find(|text| text.uri == uri) else { return };
        // Changes contain the whole text, so only the last one counts.
        for change in content_changes {
            if let TextDocumentContentChangeEvent::TextDocumentContentChangeWholeDocument(whole) = change {
                text.text = whole.text;
            }
        }
        (text.version, text.is_new) = (text_document.version, true);
        self.look_at_users_again(&uri);
    }

    fn close(&mut self, params: Value) {
        let Ok(DidCloseTextDocumentParams { text_document }) = serde_json::from_value(params) else { return };
        for index in
            (0..self.texts.len()).filter(|index| self.texts[*index].uri == text_document.uri).collect::<Vec<_>>()
        {
            self.touch_used(index);
        }
        self.texts.retain(|text| text.uri != text_document.uri);
        self.look_at_users_again(&text_document.uri);
        let params = PublishDiagnosticsParams { uri: text_document.uri, version: None, diagnostics: Vec::new() };
        self.send(Notification::new("textDocument/publishDiagnostics".into(), params));
    }

    fn publish_all(&mut self) {
        let updated: Vec<bool> = (0..self.texts.len()).map(|index| self.bring_up_to_date(index)).collect();
        for (index, updated) in updated.into_iter().enumerate() {
            self.publish(index, updated);
        }
    }

    /// Analyses a text if it is new; returns whether it was.
    fn bring_up_to_date(&mut self, index: usize) -> bool {
        if !std::mem::take(&mut self.texts[index].is_new) {
            return false;
        }
        self.texts[index].revision += 1;
        self.touch_used(index);
        let before = self.texts[index].document.take();
        let made = catch_unwind(AssertUnwindSafe(|| {
            document_of(&self.texts, index, before.as_ref(), self.read, &self.folders)
        }));
        let text = &mut self.texts[index];
        let Ok((document, keys)) = made else {
            self.log(format!("a defect of vibc in `{}`", self.texts[index].uri.0));
            return false;
        };
        if !document.is_whole {
            let (uri, sources) = (text.uri.clone(), document.sources.clone());
            // The worker lives as long as the server.
            let _ = self.jobs.send(Job { uri, revision: text.revision, sources, file: document.file });
        }
        text.document = Some(document);
        text.keys = keys;
        self.touch_used(index);
        true
    }

    /// Marks the files that a text uses: the findings in them may have changed with it.
    fn touch_used(&mut self, index: usize) {
        let keys = std::mem::take(&mut self.texts[index].keys);
        for (other, text) in self.texts.iter_mut().enumerate() {
            text.is_touched |= other != index && keys.iter().flatten().any(|key| *key == text.key);
        }
        self.texts[index].keys = keys;
    }

    /// Publishes the findings of a text after an analysis, or if those of the models that use it have changed.
    fn publish(&mut self, index: usize, is_analysed: bool) {
        if !std::mem::take(&mut self.texts[index].is_touched) && !is_analysed {
            return;
        }
        let Text { uri, version, document: Some(_), published, .. } = &self.texts[index] else { return };
        let diagnostics = self.findings(index);
        if !is_analysed && diagnostics == *published {
            return;
        }
        let params =
            PublishDiagnosticsParams { uri: uri.clone(), version: Some(*version), diagnostics: diagnostics.clone() };
        self.texts[index].published = diagnostics;
        self.send(Notification::new("textDocument/publishDiagnostics".into(), params));
    }

    /// Adds a completed analysis; the client is notified to request hints again.
    fn add(&mut self, Done { uri, revision, mut document }: Done) {
        let newest = |text: &Text| text.uri == uri && text.revision == revision && !text.is_new;
        let Some(index) = self.texts.iter().position(newest) else { return };
        let text = &mut self.texts[index];
        let before = text.document.take();
        // A `solve` without an answer leaves the declared values as the known ones.
        document.known = document.known.or_else(|| before.as_ref()?.known.clone());
        let is_news = before.is_none_or(|before| before.findings != document.findings);
        text.document = Some(document);
        if is_news {
            self.touch_used(index);
            for other in 0..self.texts.len() {
                self.publish(other, other == index);
            }
        }
        if self.refreshes {
            self.refreshed += 1;
            let id = RequestId::from(format!("hints-{}", self.refreshed));
            self.send(Request::new(id, "workspace/inlayHint/refresh".into(), Value::Null));
        }
    }

    fn log(&self, message: String) {
        let params = serde_json::json!({ "type": 1, "message": message });
        self.send(Notification::new("window/logMessage".into(), params));
    }

    fn request(&mut self, Request { id, method, params }: Request) {
        let answer = catch_unwind(AssertUnwindSafe(|| match method.as_str() {
            _ if self.is_shut => Err(invalid("the server is shut down")),
            "initialize" => Err(invalid("the server is already initialized")),
            "shutdown" => {
                self.is_shut = true;
                Ok(Value::Null)
            }
            _ => self.answer(&method, params),
        }));
        let response = match answer {
            Ok(Ok(value)) => Response::new_ok(id, value),
            Ok(Err(Refusal { code, message })) => Response::new_err(id, code as i32, message),
            Err(_) => Response::new_err(id, ErrorCode::InternalError as i32, "a defect of vibc".into()),
        };
        self.send(response);
    }
}

fn invalid(why: &str) -> Refusal {
    Refusal { code: ErrorCode::InvalidRequest, message: why.into() }
}

/// The document of a text, with the tables and component files that it names, and the keys of these files. They must
/// lie below an open folder or, if none is open, below the folder of the text, which then has to be a file. An open
/// file counts with its content in the editor.
fn document_of(
    texts: &[Text],
    index: usize,
    before: Option<&Document>,
    read: &Read,
    folders: &[String],
) -> (Document, Vec<Option<String>>) {
    let text = &texts[index];
    let mut sources = Sources::new();
    let file = sources.add(SourceFile::model(path(&text.uri), text.text.clone()));
    let is_file = text.uri.0.starts_with("file://");
    let own = is_file.then(|| sources.file(file).directory.to_string_lossy().into_owned());
    let own: Vec<String> = own.into_iter().collect();
    let folders = if folders.is_empty() { &own } else { folders };
    let mut room = crate::syntax::limits::USED;
    let mut named: Vec<(String, String)> = Vec::new();
    crate::add_used_files(&mut sources, file, Some(text.key.clone()), |name| {
        let stored = read(name, folders, Named::Components);
        let key = stored.as_ref().map_or_else(|_| plain(name), |(key, _)| key.clone());
        let (key, bytes) = match texts.iter().find(|text| text.key == key || path(&text.uri) == plain(name)) {
            Some(open) => (open.key.clone(), open.text.clone().into_bytes()),
            None => stored?,
        };
        let full =
            || format!("the files that a model uses have at most {} MiB in all", crate::syntax::limits::USED >> 20);
        room = room.checked_sub(bytes.len()).ok_or_else(full)?;
        named.push((name.to_string(), key.clone()));
        Ok((key, bytes))
    });
    // A file of the program has no other key than its name.
    let key = |id: FileId| {
        let name = &sources.file(id).name;
        let key = named.iter().find(|(known, _)| known == name).map_or(name, |(_, key)| key);
        if id == file { text.key.clone() } else { key.clone() }
    };
    let models: Vec<FileId> = sources.models().collect();
    let mut keys = vec![None; sources.len()];
    models.iter().for_each(|id| keys[usize::from(id.0)] = Some(key(*id)));
    for of in models {
        for written in crate::table_files(&sources, of) {
            let name = sources.file(of).relative_name(&written);
            if sources.len() >= MOST_FILES {
                break;
            }
            sources.add(match read(&name, folders, Named::Table) {
                Ok((_, bytes)) => SourceFile::decode(SourceKind::Table, name, bytes),
                Err(reason) => SourceFile::unread(SourceKind::Table, name, reason),
            });
        }
    }
    (Document::new(sources, file, before), keys)
}

/// A document has room for 256 files.
const MOST_FILES: usize = 250;

/// A path without `.` and, if a folder precedes them, without `..`, in the form in which the client names open files.
fn plain(path: &str) -> String {
    let mut parts: Vec<&str> = Vec::new();
    for part in path.split('/') {
        match part {
            "." => {}
            ".." if parts.last().is_some_and(|last| !matches!(*last, "" | "..")) => drop(parts.pop()),
            part => parts.push(part),
        }
    }
    parts.join("/")
}

/// The path of a file's URI; a URI of another kind is returned unchanged.
fn path(uri: &Uri) -> String {
    let Some(encoded) = uri.0.strip_prefix("file://") else { return uri.0.clone() };
    let bytes = encoded.as_bytes();
    let mut decoded = Vec::with_capacity(bytes.len());
    let mut at = 0;
    while at < bytes.len() {
        let code = encoded.get(at + 1..at + 3).and_then(|code| u8::from_str_radix(code, 16).ok());
        match (bytes[at], code) {
            (b'%', Some(byte)) => {
                decoded.push(byte);
                at += 3;
            }
            (byte, _) => {
                decoded.push(byte);
                at += 1;
            }
        }
    }
    String::from_utf8_lossy(&decoded).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_uri_is_a_path() {
        assert_eq!(path(&Uri("file:///home/a%20b/cart.vib".into())), "/home/a b/cart.vib");
        assert_eq!(path(&Uri("untitled:1".into())), "untitled:1");
        assert_eq!(path(&Uri("file:///50%".into())), "/50%");
    }
}
