//! `vibc lsp` as a process: frames on standard input and output, and the exit status.

use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Read, Write};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

/// The program, with its standard input and output.
fn started() -> (Child, ChildStdin, BufReader<ChildStdout>) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_vibc"));
    let mut child =
        command.args(["lsp", "--stdio"]).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().expect("it starts");
    let (input, output) = (child.stdin.take().expect("a pipe"), child.stdout.take().expect("a pipe"));
    (child, input, BufReader::new(output))
}

pub fn write(to: &mut ChildStdin, message: Value) {
    let body = message.to_string();
    write!(to, "Content-Length: {}\r\n\r\n{body}", body.len()).expect("the program reads");
    to.flush().expect("the program reads");
}

pub fn read(from: &mut BufReader<ChildStdout>) -> Value {
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
    // A table next to the model is read from the disk, or reported as missing.
    let folder = tempfile::tempdir().expect("a temporary folder");
    std::fs::write(folder.path().join("push.csv"), "0, 0\n1, 2\n").expect("a table");
    let text = |file: &str| {
        format!(
            "body b {{ mass = 1 kg, moves x }}\nspring s: ground -- b {{ k = 1 N/m }}\nforce F: b = table(\"{file}\", 1 N)\n"
        )
    };
    let uri = format!("file://{}/m%6Fdel.vib", folder.path().display());
    for (version, file, codes) in [(1, "push.csv", vec![]), (2, "pull.csv", vec!["vib::table::unreadable"])] {
        let document = json!({ "uri": uri, "languageId": "vib", "version": version, "text": text(file) });
        let method = "textDocument/didOpen";
        write(&mut input, json!({ "jsonrpc": "2.0", "method": method, "params": { "textDocument": document } }));
        let reported = read(&mut output);
        let found = reported["params"]["diagnostics"].as_array().expect("findings").iter();
        assert_eq!(
            found.map(|finding| finding["code"].as_str().unwrap_or("")).collect::<Vec<_>>(),
            codes,
            "{reported}"
        );
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

/// An initialised server, with the client's open folders.
pub fn greeted(params: Value) -> (Child, ChildStdin, BufReader<ChildStdout>) {
    let (child, mut input, mut output) = started();
    write(&mut input, json!({ "jsonrpc": "2.0", "id": 1, "method": "initialize", "params": params }));
    assert_eq!(read(&mut output)["id"], 1);
    write(&mut input, json!({ "jsonrpc": "2.0", "method": "initialized", "params": {} }));
    (child, input, output)
}

pub fn opened(uri: &str, version: i32, text: &str) -> Value {
    let document = json!({ "uri": uri, "languageId": "vib", "version": version, "text": text });
    json!({ "jsonrpc": "2.0", "method": "textDocument/didOpen", "params": { "textDocument": document } })
}

#[test]
fn a_server_outlives_whatever_it_is_sent() {
    let (mut child, mut input, mut output) = greeted(json!({ "capabilities": {} }));
    let framed = |body: &[u8]| [format!("Content-Length: {}\r\n\r\n", body.len()).as_bytes(), body].concat();
    let parse = -32700;
    let request = -32600;
    for (bytes, code) in [
        (framed(b"{ no json"), parse),
        (framed(b"\xc3\x28"), parse),
        (framed(br#"[{"jsonrpc":"2.0","id":2,"method":"shutdown"}]"#), request),
        (framed(br#"{"jsonrpc":"2.0"}"#), request),
        (b"Content-Length: 99999999999999999\r\n\r\n".to_vec(), request),
        (b"Content-Length: none\r\n\r\n".to_vec(), request),
    ] {
        input.write_all(&bytes).and_then(|()| input.flush()).expect("the program reads");
        let answer = read(&mut output);
        assert_eq!((&answer["id"], &answer["error"]["code"]), (&Value::Null, &json!(code)), "{answer}");
    }
    // A blank line before the header, and half an emoji in the text.
    let text = r#"body b { mass = 1 kg, moves x } // \ud83d"#;
    let body = opened("untitled:1", 1, "@").to_string().replace('@', text);
    input.write_all(b"\r\n").expect("the program reads");
    input.write_all(&framed(body.as_bytes())).and_then(|()| input.flush()).expect("the program reads");
    let reported = read(&mut output);
    assert_eq!(
        (&reported["method"], &reported["params"]["version"]),
        (&json!("textDocument/publishDiagnostics"), &json!(1))
    );
    // Requests in the wrong order are refused, each with its own id.
    write(&mut input, json!({ "jsonrpc": "2.0", "id": 7, "method": "initialize", "params": {} }));
    assert_eq!(read(&mut output)["error"]["code"], request);
    write(&mut input, json!({ "jsonrpc": "2.0", "id": 8, "method": "shutdown" }));
    let answer = read(&mut output);
    assert!(answer["id"] == 8 && answer.get("error").is_none(), "{answer}");
    write(&mut input, json!({ "jsonrpc": "2.0", "id": 9, "method": "textDocument/hover", "params": {} }));
    let answer = read(&mut output);
    assert_eq!((&answer["id"], &answer["error"]["code"]), (&json!(9), &json!(request)), "{answer}");
    write(&mut input, json!({ "jsonrpc": "2.0", "method": "exit" }));
    assert_eq!(child.wait().expect("it ends").code(), Some(0));
}

#[test]
fn a_client_that_disconnects_without_exit_is_a_failure() {
    let (mut child, mut input, mut output) = started();
    write(&mut input, json!({ "jsonrpc": "2.0", "id": 4, "method": "textDocument/hover", "params": {} }));
    assert_eq!(read(&mut output)["error"]["code"], -32002, "nobody has introduced himself");
    write(&mut input, json!({ "jsonrpc": "2.0", "method": "exit" }));
    assert_eq!(child.wait().expect("it ends").code(), Some(1));
    let (mut child, mut input, _output) = greeted(json!({ "capabilities": {} }));
    write(&mut input, json!({ "jsonrpc": "2.0", "method": "exit" }));
    assert_eq!(child.wait().expect("it ends").code(), Some(1));
}

#[test]
fn tables_are_read_only_below_the_open_folder() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let at = |name: &str| folder.path().join(name);
    std::fs::create_dir_all(at("open/models")).expect("a folder");
    for name in ["outside.csv", "open/beside.csv", "open/models/own.csv"] {
        std::fs::write(at(name), "0, 0\n1, 2\n").expect("a table");
    }
    let uri = |name: &str| format!("file://{}", at(name).display());
    let text = |file: &str| {
        format!(
            "body b {{ mass = 1 kg, moves x }}\nspring s: ground -- b {{ k = 1 N/m }}\nforce F: b = table(\"{file}\", 1 N)\n"
        )
    };
    let open = json!({ "capabilities": {}, "workspaceFolders": [{ "uri": uri("open"), "name": "open" }] });
    let alone = json!({ "capabilities": {} });
    for (params, reads) in [
        (open, [("own.csv", true), ("../beside.csv", true), ("../../outside.csv", false), ("/dev/stdin", false)]),
        (alone, [("own.csv", true), ("../beside.csv", false), ("../../outside.csv", false), ("/dev/stdin", false)]),
    ] {
        let (mut child, mut input, mut output) = greeted(params);
        for (version, (file, is_read)) in (1..).zip(reads) {
            write(&mut input, opened(&uri("open/models/m.vib"), version, &text(file)));
            let reported = read(&mut output);
            let found = reported["params"]["diagnostics"].as_array().expect("findings");
            assert_eq!(found.is_empty(), is_read, "{file}: {reported}");
        }
        drop(input);
        assert_eq!(child.wait().expect("it ends").code(), Some(1));
    }
}
