//! `vibc watch`: the report of a model on 127.0.0.1, updated after each save of a file that it depends on. If the
//! newest text has errors, they are shown above the last report without errors. See docs/report.md#watching.
//!
//! Pages of other sites cannot reach it: a request has to name this server as its host and, if it has an origin, as its
//! origin.

use crate::files::{Input, read_all};
use crate::{Status, report_error};
use notify::{RecursiveMode, Watcher};
use std::collections::BTreeSet;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::Duration;
use tiny_http::{Header, Method, Request, Response, Server};
use vibc::base::{FileId, Sources};
use vibc::cli::{Messages, Watch};
use vibc::overview::{self, Overview, Shown};

/// Saving causes several events; those within this time count as one.
const QUIET: Duration = Duration::from_millis(40);
/// Pages that may wait for changes at the same time.
const MOST_LISTENERS: usize = 32;
/// Interval of lines that keep a silent connection open, and detect whether the client is still there.
const BEAT: Duration = Duration::from_secs(15);

/// The content that is served.
#[derive(Default)]
struct Served {
    page: String,
    version: u64,
    listeners: Vec<Sender<u64>>,
}

type Shared = Arc<Mutex<Served>>;

fn lock(shared: &Shared) -> MutexGuard<'_, Served> {
    // The page is complete, even if the thread that wrote it has panicked.
    shared.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Serves until the process is ended.
pub fn watch(options: &Watch, messages: &Messages) -> Status {
    let mut maker = Maker { options, last: None, version: 0 };
    let (page, files) = match maker.make() {
        Ok(made) => made,
        Err(unreadable) => return unreadable.report(messages),
    };
    let server = match Server::http(("127.0.0.1", options.port)) {
        Ok(server) => server,
        Err(error) => {
            report_error(&format!("port {} of 127.0.0.1 cannot be served: {error}", options.port));
            return Status::Io;
        }
    };
    let port = server.server_addr().to_ip().map_or(options.port, |address| address.port());
    let (events, changes) = mpsc::channel();
    let mut watcher = match notify::recommended_watcher(move |event| {
        // The receiver lives as long as the program.
        let _ = events.send(event);
    }) {
        Ok(watcher) => watcher,
        Err(error) => {
            report_error(&format!("files cannot be watched: {error}"));
            return Status::Io;
        }
    };
    let mut watched = Folders::default();
    watched.watch(&mut watcher, &files);
    let shared = Shared::default();
    {
        let mut served = lock(&shared);
        (served.page, served.version) = (page, maker.version);
    }
    // If the address cannot be printed, nobody can find the page.
    let mut out = io::stdout();
    if writeln!(out, "http://127.0.0.1:{port}/").and_then(|()| out.flush()).is_err() {
        return Status::Io;
    }
    let of_server = Arc::clone(&shared);
    thread::spawn(move || {
        for request in server.incoming_requests() {
            let shared = Arc::clone(&of_server);
            thread::spawn(move || answer(request, port, &shared));
        }
    });
    while watched.wait_for_change(&changes) {
        let Ok((page, files)) = maker.make() else { continue };
        watched.watch(&mut watcher, &files);
        let mut served = lock(&shared);
        (served.page, served.version) = (page, maker.version);
        let version = served.version;
        served.listeners.retain(|listener| listener.send(version).is_ok());
    }
    Status::Done
}

/// Makes the page, and keeps the last one without errors.
struct Maker<'a> {
    options: &'a Watch,
    last: Option<(Overview, Sources, FileId)>,
    version: u64,
}

impl Maker<'_> {
    /// The page, and the files that it was made from.
    fn make(&mut self) -> Result<(String, Vec<PathBuf>), crate::files::Unreadable> {
        let Input { sources, model, overrides } = read_all(&self.options.file, &self.options.overrides)?;
        let study =
            vibc::Study { until: self.options.measured.until(&self.options.overrides), ..vibc::Study::default() };
        let outcome = overview::overview(&sources, model, &overrides, &study);
        let named = sources.files().map(|file| PathBuf::from(&file.name));
        let settings = self.options.overrides.settings_file.clone();
        let files = named.chain([self.options.file.clone()]).chain(settings).collect();
        let name = self.options.file.display().to_string();
        self.version += 1;
        let version = Some(self.version);
        let newer = Some((&sources, model));
        let shown = Shown { newer, findings: &outcome.diagnostics, version, ..Shown::default() };
        let page = match outcome.answer {
            Some(overview) => {
                let page = overview.page((&sources, model), &shown);
                self.last = Some((overview, sources, model));
                page
            }
            None => match &self.last {
                Some((overview, of, of_model)) => overview.page((of, *of_model), &shown),
                None => overview::page_of_errors(&name, (&sources, model), &shown),
            },
        };
        Ok((page, files))
    }
}

/// The folders of the files that are watched: editors replace a file rather than write to it.
#[derive(Default)]
struct Folders {
    known: BTreeSet<PathBuf>,
    names: BTreeSet<PathBuf>,
}

impl Folders {
    fn watch(&mut self, watcher: &mut impl Watcher, files: &[PathBuf]) {
        for file in files {
            let folder = file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
            if let Ok(folder) = folder.canonicalize() {
                self.names.extend(file.file_name().map(|name| folder.join(name)));
                if self.known.insert(folder.clone()) {
                    // A folder that cannot be watched holds a file that is read once.
                    let _ = watcher.watch(&folder, RecursiveMode::NonRecursive);
                }
            }
        }
    }

    /// Blocks until a file has changed; `false` if no more changes can be reported.
    fn wait_for_change(&self, changes: &Receiver<notify::Result<notify::Event>>) -> bool {
        let is_ours = |event: &notify::Result<notify::Event>| {
            event
                .as_ref()
                .is_ok_and(|event| !event.kind.is_access() && event.paths.iter().any(|path| self.names.contains(path)))
        };
        loop {
            match changes.recv() {
                Err(_) => return false,
                Ok(event) if is_ours(&event) => break,
                Ok(_) => {}
            }
        }
        loop {
            match changes.recv_timeout(QUIET) {
                Ok(_) => {}
                Err(RecvTimeoutError::Timeout) => return true,
                Err(RecvTimeoutError::Disconnected) => return false,
            }
        }
    }
}

fn answer(request: Request, port: u16, shared: &Shared) {
    let refused = |request: Request, status: u16, why: &str| {
        // A client that has disconnected does not read this.
        let _ = request.respond(Response::from_string(format!("{why}\n")).with_status_code(status));
    };
    if !is_own(&request, port) {
        return refused(request, 403, "this server answers pages of its own only");
    }
    if *request.method() != Method::Get {
        return refused(request, 405, "GET is the only method");
    }
    match request.url() {
        "/" | "/page" => {
            let page = lock(shared).page.clone();
            let headers = [
                ("Content-Type", "text/html; charset=utf-8"),
                ("Cache-Control", "no-store"),
                ("X-Content-Type-Options", "nosniff"),
                ("X-Frame-Options", "DENY"),
                ("Referrer-Policy", "no-referrer"),
            ];
            let headers = headers.into_iter().filter_map(|(name, value)| Header::from_bytes(name, value).ok());
            let response = headers.fold(Response::from_string(page), Response::with_header);
            let _ = request.respond(response);
        }
        "/events" => events(request, shared),
        _ => refused(request, 404, "there is no such page"),
    }
}

/// Whether a request names this server as its host and, if the browser sends an origin, as its origin.
fn is_own(request: &Request, port: u16) -> bool {
    let hosts = [format!("127.0.0.1:{port}"), format!("localhost:{port}")];
    let header = |name: &'static str| {
        let found = request.headers().iter().find(|header| header.field.equiv(name));
        found.map(|header| header.value.as_str())
    };
    let is_host = |value: &str| hosts.iter().any(|host| host == value);
    let is_origin = |value: &str| value.strip_prefix("http://").is_some_and(is_host);
    header("Host").is_some_and(is_host) && header("Origin").is_none_or(is_origin)
}

/// Server-sent events: a line for each new version.
fn events(request: Request, shared: &Shared) {
    let (listener, news) = mpsc::channel();
    // The page may be older than the version that is served now.
    let current = {
        let mut served = lock(shared);
        if served.listeners.len() >= MOST_LISTENERS {
            served.listeners.remove(0);
        }
        served.listeners.push(listener);
        served.version
    };
    // Written by hand: the library would send its answer only when a buffer is full.
    let mut stream = request.into_writer();
    let head =
        "HTTP/1.1 200 OK\r\nContent-Type: text/event-stream\r\nCache-Control: no-store\r\nConnection: close\r\n\r\n";
    let mut say = |text: &str| stream.write_all(text.as_bytes()).and_then(|()| stream.flush());
    let mut heard = say(head).and_then(|()| say(&format!("data: {current}\n\n")));
    while heard.is_ok() {
        heard = match news.recv_timeout(BEAT) {
            Ok(version) => say(&format!("data: {version}\n\n")),
            Err(RecvTimeoutError::Timeout) => say(": still here\n\n"),
            Err(RecvTimeoutError::Disconnected) => return,
        };
    }
}
