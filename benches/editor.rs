//! Response times of the language server as its client sees them: over an in-memory connection, from a change to the
//! findings, and for each request after it. Targets: 10 ms up to 50 coordinates, 100 ms for 1,000.
//!
//! Medians of the wall-clock time between the message and its answer; every round changes a number of the text, so that
//! nothing can be cached.

use lsp_server::{Connection, Message, Notification, Request, RequestId};
use serde_json::{Value, json};
use std::io::Write;
use std::time::Instant;

const URI: &str = "file:///bench.vib";
const ROUNDS: usize = 15;

/// A server with an open text, and its client.
struct Session {
    connection: Connection,
    server: std::thread::JoinHandle<()>,
    requests: i32,
    version: i32,
}

impl Session {
    fn new() -> Session {
        let (connection, other) = Connection::memory();
        let server = std::thread::spawn(move || {
            let read = |_: &str, _: &[String], _| Err(String::from("no files here"));
            vibc::editor::server::serve(&other, &read);
        });
        let mut session = Session { connection, server, requests: 0, version: 0 };
        session.ask("initialize", json!({ "capabilities": {} }));
        session.tell("initialized", json!({}));
        session
    }

    fn tell(&self, method: &str, params: Value) {
        self.connection.sender.send(Notification::new(method.into(), params).into()).expect("the server listens");
    }

    fn ask(&mut self, method: &str, params: Value) -> Value {
        self.requests += 1;
        let id = RequestId::from(self.requests);
        let request = Request::new(id.clone(), method.into(), params);
        self.connection.sender.send(request.into()).expect("the server listens");
        loop {
            if let Message::Response(response) = self.connection.receiver.recv().expect("an answer")
                && response.id == id
            {
                return response.response_result.expect("an answer");
            }
        }
    }

    fn change(&mut self, text: &str) {
        self.version += 1;
        let document = json!({ "uri": URI, "languageId": "vib", "version": self.version, "text": text });
        if self.version == 1 {
            self.tell("textDocument/didOpen", json!({ "textDocument": document }));
        } else {
            self.tell(
                "textDocument/didChange",
                json!({ "textDocument": document, "contentChanges": [{ "text": text }] }),
            );
        }
    }

    /// The number of findings of the newest version.
    fn findings(&self) -> usize {
        loop {
            if let Message::Notification(reported) = self.connection.receiver.recv().expect("findings")
                && reported.method == "textDocument/publishDiagnostics"
                && reported.params["version"] == json!(self.version)
            {
                return reported.params["diagnostics"].as_array().map_or(0, Vec::len);
            }
        }
    }

    fn end(mut self) {
        self.ask("shutdown", Value::Null);
        self.tell("exit", Value::Null);
        self.server.join().expect("the server ends well");
    }
}

/// The requests after each change, besides the findings.
const ASKED: [&str; 7] = [
    "vibc/page",
    "textDocument/inlayHint",
    "textDocument/hover",
    "textDocument/completion",
    "textDocument/semanticTokens/full",
    "textDocument/codeAction",
    "textDocument/rename",
];

fn params(method: &str, text: &str) -> Value {
    let lines = text.lines().count();
    let range = json!({ "start": { "line": 0, "character": 0 }, "end": { "line": lines, "character": 0 } });
    let mut params =
        json!({ "textDocument": { "uri": URI }, "position": { "line": 1, "character": 6 }, "range": range });
    if method.ends_with("codeAction") {
        params["context"] = json!({ "diagnostics": [] });
    }
    if method.ends_with("rename") {
        params["newName"] = json!("stiffness");
    }
    if method.ends_with("completion") {
        params["position"] = json!({ "line": lines - 1, "character": 11 });
    }
    params
}

/// A chain, written with `repeat` or line by line; with dampers between all masses, or none.
fn chain(n: usize, damped: bool, written_out: bool, round: usize) -> String {
    let mut text = format!(
        "model chain\nparam k = {} N/m\nbody m[1] {{ mass = 1 kg, moves x }}\nspring k[1]: ground -- m[1] {{ k = k }}\n",
        100 + round
    );
    let damper = |i: &str, before: &str| match damped {
        true => format!("damper d[{i}]: m[{before}] -- m[{i}] {{ c = 0.1 N*s/m }}\n"),
        false => String::new(),
    };
    if written_out {
        for i in 2..=n {
            let (i, before) = (i.to_string(), (i - 1).to_string());
            text +=
                &format!("body m[{i}] {{ mass = 1 kg, moves x }}\nspring k[{i}]: m[{before}] -- m[{i}] {{ k = k }}\n");
            text += &damper(&i, &before);
        }
    } else {
        text += &format!(
            "repeat i in 2..{n} {{\nbody m[i] {{ mass = 1 kg, moves x }}\nspring k[i]: m[i-1] -- m[i] {{ k = k }}\n"
        );
        text += &damper("i", "i-1");
        text += "}\n";
    }
    text + "output y = m[1].x\n"
}

fn median(times: &mut [f64]) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

/// Milliseconds to the findings, and to each answer.
fn measured(text: impl Fn(usize) -> String) -> Vec<f64> {
    let mut session = Session::new();
    let mut times = vec![Vec::new(); 1 + ASKED.len()];
    for round in 0..ROUNDS {
        let text = text(round);
        let start = Instant::now();
        session.change(&text);
        assert_eq!(session.findings(), 0, "a good model");
        times[0].push(1e3 * start.elapsed().as_secs_f64());
        for (asked, method) in ASKED.iter().enumerate() {
            let start = Instant::now();
            let answer = session.ask(method, params(method, &text));
            times[asked + 1].push(1e3 * start.elapsed().as_secs_f64());
            assert!(!answer.is_null(), "{method} has an answer");
        }
    }
    session.end();
    times.iter_mut().map(|times| median(times)).collect()
}

/// Arguments that are no options choose the models whose names contain one of them.
fn main() {
    let chosen: Vec<String> = std::env::args().skip(1).filter(|argument| !argument.starts_with('-')).collect();
    let mut out = std::io::stdout().lock();
    writeln!(out, "milliseconds on the wall, medians of {ROUNDS}").expect("standard output");
    let head = ["findings", "page", "hints", "hover", "completion", "colours", "fixes", "rename"];
    writeln!(out, "{:<32}{}", "model", head.map(|name| format!("{name:>12}")).concat()).expect("standard output");
    for (n, damped, written_out) in [
        (2, true, false),
        (10, true, false),
        (30, true, false),
        (50, false, true),
        (50, true, true),
        (1000, false, false),
        (1000, true, false),
        (1000, false, true),
        (1000, true, true),
    ] {
        let form = if written_out { "written out" } else { "by repeat" };
        let name = format!("{n} masses{}, {form}", if damped { " and dampers" } else { "" });
        if !chosen.is_empty() && !chosen.iter().any(|part| name.contains(part.as_str())) {
            continue;
        }
        let times = measured(|round| chain(n, damped, written_out, round));
        let cells: String = times.iter().map(|time| format!("{time:>12.2}")).collect();
        writeln!(out, "{name:<32}{cells}").expect("standard output");
    }
}
