//! `vibc lsp` as a process: frames on standard input and output, and the exit status.

use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Read, Write};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

/// The program, and both ends of what editors write to it and read from it.
fn started() -> (Child, ChildStdin, BufReader<ChildStdout>) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_vibc"));
    let mut child =
        command.args(["lsp", "--stdio"]).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().expect("it starts");
    let (input, output) = (child.stdin.take().expect("a pipe"), child.stdout.take().expect("a pipe"));
    (child, input, BufReader::new(output))
}

fn write(to: &mut ChildStdin, message: Value) {
    let body = message.to_string();
    write!(to, "Content-Length: {}\r\n\r\n{body}", body.len()).expect("the program reads");
    to.flush().expect("the program reads");
}

fn read(from: &mut BufReader<ChildStdout>) -> Value {
    let mut length = 0;
    loop {
        let mut line = String::new();
        from.read_line(&mut line).expect("the program writes");
        match line.trim_end().split_once(": ") {
            Some(("Content-Length", number)) => length = number.parse().expect("a number"),
            Some(_) => {}
            None => break,
        }
    }
    let mut body = vec![0; length];
    from.read_exact(&mut body).expect("as much as was promised");
    serde_json::from_slice(&body).expect("JSON")
}

#[test]
fn an_editor_starts_asks_and_says_goodbye() {
    let (mut child, mut input, mut output) = started();
    write(&mut input, json!({ "jsonrpc": "2.0", "id": 1, "method": "initialize", "params": { "capabilities": {} } }));
    assert_eq!(read(&mut output)["result"]["serverInfo"]["name"], "vibc");
    write(&mut input, json!({ "jsonrpc": "2.0", "method": "initialized", "params": {} }));
    // A table beside the model is read from the disk, or told to be missing.
    let folder = tempfile::tempdir().expect("a temporary folder");
    std::fs::write(folder.path().join("push.csv"), "0, 0\n1, 2\n").expect("a table");
    let text = |file: &str| {
        format!(
            "body b {{ mass = 1 kg, moves x }}\nspring s: ground -- b {{ k = 1 N/m }}\nforce F: b = table(\"{file}\")\n"
        )
    };
    let uri = format!("file://{}/m%6Fdel.vib", folder.path().display());
    for (version, file, codes) in [(1, "push.csv", vec![]), (2, "pull.csv", vec!["vib::table::unreadable"])] {
        let document = json!({ "uri": uri, "languageId": "vib", "version": version, "text": text(file) });
        let method = "textDocument/didOpen";
        write(&mut input, json!({ "jsonrpc": "2.0", "method": method, "params": { "textDocument": document } }));
        let told = read(&mut output);
        let found = told["params"]["diagnostics"].as_array().expect("findings").iter();
        assert_eq!(found.map(|finding| finding["code"].as_str().unwrap_or("")).collect::<Vec<_>>(), codes, "{told}");
    }
    write(&mut input, json!({ "jsonrpc": "2.0", "id": 2, "method": "shutdown" }));
    assert_eq!(read(&mut output)["id"], 2);
    write(&mut input, json!({ "jsonrpc": "2.0", "method": "exit" }));
    assert_eq!(child.wait().expect("it ends").code(), Some(0));
}

#[test]
fn an_editor_that_is_gone_ends_the_server() {
    let (mut child, input, _output) = started();
    drop(input);
    assert!(child.wait().expect("it ends").code().is_some());
}
