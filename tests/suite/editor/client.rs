//! A client of the language server in the same process: it writes and reads the protocol's messages as plain JSON, so
//! that the tests do not rely on the server's own types.

use lsp_server::{Connection, Message, Notification, Request, RequestId};
use serde_json::{Value, json};
use std::thread::JoinHandle;
use std::time::Duration;
use vibc::editor::server::{Leave, Named};

/// The text's URI.
pub const URI: &str = "file:///models/model.vib";

pub struct Client {
    connection: Connection,
    server: Option<JoinHandle<()>>,
    requests: i32,
    version: i32,
    /// Notifications that arrived while waiting for an answer.
    heard: Vec<Notification>,
    pub text: String,
    /// The server's answer to `initialize`.
    pub capabilities: Value,
}

/// Longer than any answer takes; a silent server fails the test.
const PATIENCE: Duration = Duration::from_secs(60);

impl Client {
    /// A client that counts columns in UTF-16, with one text open.
    pub fn open(text: &str) -> Client {
        Client::open_as(text, json!({}))
    }

    pub fn open_as(text: &str, capabilities: Value) -> Client {
        let (own, other) = Connection::memory();
        let server = std::thread::spawn(move || {
            let read = |path: &str, _: &[String], _: Named| Err(format!("there is no `{path}`"));
            assert_eq!(vibc::editor::server::serve(&other, &read), Leave::Announced);
        });
        let text = text.to_string();
        let mut client = Client {
            connection: own,
            server: Some(server),
            requests: 0,
            version: 0,
            heard: Vec::new(),
            text: String::new(),
            capabilities: Value::Null,
        };
        client.capabilities = client.ask("initialize", json!({ "capabilities": capabilities }));
        client.tell("initialized", json!({}));
        client.text = text.clone();
        let document = json!({ "uri": URI, "languageId": "vib", "version": 0, "text": text });
        client.tell("textDocument/didOpen", json!({ "textDocument": document }));
        client
    }

    pub fn change(&mut self, text: &str) {
        self.text = text.to_string();
        self.version += 1;
        let document = json!({ "uri": URI, "version": self.version });
        self.tell("textDocument/didChange", json!({ "textDocument": document, "contentChanges": [{ "text": text }] }));
    }

    pub fn tell(&self, method: &str, params: Value) {
        let message = Notification::new(method.into(), params);
        self.connection.sender.send(message.into()).expect("the server listens");
    }

    /// The answer to a request that must succeed.
    pub fn ask(&mut self, method: &str, params: Value) -> Value {
        self.response(method, params).unwrap_or_else(|message| panic!("{method}: {message}"))
    }

    /// The error message of a request that must fail.
    pub fn refusal(&mut self, method: &str, params: Value) -> String {
        match self.response(method, params) {
            Err(message) => message,
            Ok(answer) => panic!("{method} is answered with {answer}"),
        }
    }

    fn response(&mut self, method: &str, params: Value) -> Result<Value, String> {
        self.requests += 1;
        let id = RequestId::from(self.requests);
        let message = Request::new(id.clone(), method.into(), params);
        self.connection.sender.send(message.into()).expect("the server listens");
        loop {
            match self.next() {
                // As in the protocol: `result` or `error`.
                Message::Response(response) if response.id == id => {
                    let written = serde_json::to_value(response).expect("JSON");
                    return match written["error"]["message"].as_str() {
                        Some(message) => Err(message.to_string()),
                        None => Ok(written["result"].clone()),
                    };
                }
                Message::Notification(notification) => self.heard.push(notification),
                // The server asks the client to request hints again.
                Message::Request(_) => {}
                Message::Response(other) => panic!("an answer to {:?}", other.id),
            }
        }
    }

    fn next(&self) -> Message {
        self.connection.receiver.recv_timeout(PATIENCE).expect("the server says something")
    }

    /// Waits for a notification.
    pub fn hear(&mut self, method: &str) -> Value {
        loop {
            if let Some(place) = self.heard.iter().position(|notification| notification.method == method) {
                return self.heard.remove(place).params;
            }
            match self.next() {
                Message::Notification(notification) => self.heard.push(notification),
                Message::Request(request) if request.method == method => return request.params,
                Message::Request(_) => {}
                Message::Response(other) => panic!("an answer to {:?}", other.id),
            }
        }
    }

    /// The findings of the open version.
    pub fn findings(&mut self) -> Vec<Value> {
        loop {
            let reported = self.hear("textDocument/publishDiagnostics");
            if reported["version"] == json!(self.version) {
                return reported["diagnostics"].as_array().cloned().unwrap_or_default();
            }
        }
    }

    /// A request about a place: the first byte of the nth occurrence of `mark` in the text, counted from 0.
    pub fn ask_at(&mut self, method: &str, mark: &str, nth: usize) -> Value {
        let params = self.at(mark, nth);
        self.ask(method, params)
    }

    /// The parameters of a request about a place.
    pub fn at(&self, mark: &str, nth: usize) -> Value {
        let places = self.text.match_indices(mark).nth(nth);
        let (offset, _) = places.unwrap_or_else(|| panic!("`{mark}` is not {nth} times in {}", self.text));
        json!({ "textDocument": { "uri": URI }, "position": self.position(offset) })
    }

    /// The parameters of a request about the place after the first occurrence of `mark`.
    pub fn behind(&self, mark: &str) -> Value {
        let offset = self.text.find(mark).unwrap_or_else(|| panic!("`{mark}` is not in {}", self.text)) + mark.len();
        json!({ "textDocument": { "uri": URI }, "position": self.position(offset) })
    }

    pub fn position(&self, offset: usize) -> Value {
        let before = &self.text[..offset];
        let line = before.matches('\n').count();
        let start = before.rfind('\n').map_or(0, |at| at + 1);
        json!({ "line": line, "character": before[start..].encode_utf16().count() })
    }

    pub fn offset(&self, position: &Value) -> usize {
        offset(&self.text, position)
    }

    /// The text of a range.
    pub fn slice(&self, range: &Value) -> &str {
        &self.text[self.offset(&range["start"])..self.offset(&range["end"])]
    }

    pub fn document(&self) -> Value {
        json!({ "textDocument": { "uri": URI } })
    }

    /// The whole text as a range.
    pub fn all(&self) -> Value {
        json!({ "start": { "line": 0, "character": 0 }, "end": self.position(self.text.len()) })
    }

    /// The text with an edit of the workspace applied.
    pub fn edited(&self, edit: &Value) -> String {
        applied(&self.text, edit["changes"][URI].as_array().expect("edits of the text"))
    }
}

/// A text with the edits of the protocol applied.
pub fn applied(text: &str, edits: &[Value]) -> String {
    let mut edits: Vec<(usize, usize, &str)> = edits
        .iter()
        .map(|edit| {
            let place = |end: &str| offset(text, &edit["range"][end]);
            (place("start"), place("end"), edit["newText"].as_str().expect("a text"))
        })
        .collect();
    edits.sort_unstable();
    let mut edited = text.to_string();
    for (start, end, new) in edits.iter().rev() {
        edited.replace_range(*start..*end, new);
    }
    edited
}

fn offset(text: &str, position: &Value) -> usize {
    let number = |name: &str| position[name].as_u64().expect("a number") as usize;
    let start = text.split_inclusive('\n').take(number("line")).map(str::len).sum::<usize>();
    let mut units = 0;
    let inside = text[start..].char_indices().find(|(_, c)| {
        let found = units >= number("character") || *c == '\n';
        units += c.len_utf16();
        found
    });
    inside.map_or(text.len(), |(at, _)| start + at)
}

impl Drop for Client {
    fn drop(&mut self) {
        if std::thread::panicking() {
            return;
        }
        self.ask("shutdown", Value::Null);
        self.tell("exit", Value::Null);
        self.server.take().map(JoinHandle::join).expect("a server").expect("the server ends well");
    }
}
