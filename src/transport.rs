//! The language server's messages from and to a stream, whatever the stream contains: bytes that are not a message are
//! reported to the client, and the next message is read. See docs/editors.md.
//!
//! A message is a header with the line `Content-Length: N`, an empty line, and N bytes of JSON. If a header makes no
//! sense, the length of its message is unknown, so the next such line is searched for.

use crossbeam_channel::{Receiver, Sender};
use lsp_server::{ErrorCode, Message, RequestId};
use serde_json::Value;
use std::io::{self, BufRead, Read, Write};
use vibc::syntax::limits;

/// Limit on the bytes of a message: a text of the largest size with half of its bytes escaped.
const MESSAGE: u64 = 2 * limits::FILE as u64;

/// Bytes of a header that are read at once.
const LINE: u64 = 1 << 16;

const LENGTH: &[u8] = b"content-length:";

/// An item received from a stream.
#[derive(Debug)]
enum Received {
    Message(Message),
    Refused(Refused),
}

/// Bytes that are not a message.
#[derive(Debug)]
struct Refused {
    /// The id of the request that was meant, if it can be recognised.
    id: Option<RequestId>,
    code: ErrorCode,
    why: String,
}

/// Forwards the messages of a stream until the client leaves or is gone; errors are sent to `answers`, which the client
/// reads.
pub fn receive_all<W: Write>(stream: &mut impl BufRead, to: &Sender<Message>, answers: impl Fn() -> W) {
    // A stream that cannot be read counts as ended.
    while let Ok(Some(received)) = receive(stream) {
        let message = match received {
            Received::Message(message) => message,
            Received::Refused(refused) => {
                if refuse(&mut answers(), refused).is_err() {
                    return;
                }
                continue;
            }
        };
        let is_last = matches!(&message, Message::Notification(notification) if notification.method == "exit");
        if to.send(message).is_err() || is_last {
            return;
        }
    }
}

/// Writes messages to a stream until there are no more.
pub fn send_all<W: Write>(messages: &Receiver<Message>, stream: impl Fn() -> W) -> io::Result<()> {
    messages.iter().try_for_each(|message| message.write(&mut stream()))
}

/// The next message, or the error in its place; `None` at the end.
fn receive(stream: &mut impl BufRead) -> io::Result<Option<Received>> {
    let length = match length(stream)? {
        None => return Ok(None),
        Some(Err(why)) => return Ok(Some(refusal(None, ErrorCode::InvalidRequest, why))),
        Some(Ok(length)) => length,
    };
    // The buffer grows with the bytes received, not with the length announced.
    let mut body = Vec::new();
    stream.take(length).read_to_end(&mut body)?;
    let is_whole = body.len() as u64 == length;
    Ok(is_whole.then(|| message(&body)))
}

fn refusal(id: Option<RequestId>, code: ErrorCode, why: impl Into<String>) -> Received {
    Received::Refused(Refused { id, code, why: why.into() })
}

/// The length given by the next header, or the reason why it is not valid; `None` at the end of the stream.
fn length(stream: &mut impl BufRead) -> io::Result<Option<Result<u64, String>>> {
    let mut found = None;
    let mut line = Vec::new();
    loop {
        line.clear();
        if stream.by_ref().take(LINE).read_until(b'\n', &mut line)? == 0 {
            return Ok(None);
        }
        match found {
            Some(length) if line.trim_ascii().is_empty() => return Ok(Some(length)),
            // Other fields, a surplus empty line, or the remains of a message that was refused.
            _ => found = length_of(&line).or(found),
        }
    }
}

/// The number after the last `Content-Length:` of a line, which may begin with the end of a message that was refused.
fn length_of(line: &[u8]) -> Option<Result<u64, String>> {
    let at = line.windows(LENGTH.len()).rposition(|word| word.eq_ignore_ascii_case(LENGTH))?;
    let number = line[at + LENGTH.len()..].trim_ascii();
    let length = std::str::from_utf8(number).ok().and_then(|number| number.parse::<u64>().ok());
    Some(match length {
        Some(length) if length <= MESSAGE => Ok(length),
        Some(_) => Err(format!("a message has at most {MESSAGE} bytes")),
        None => Err("`Content-Length` is a number of bytes".into()),
    })
}

fn message(body: &[u8]) -> Received {
    let Ok(text) = std::str::from_utf8(body) else {
        return refusal(None, ErrorCode::ParseError, "the message is not UTF-8");
    };
    let read = serde_json::from_str(text).or_else(|error| serde_json::from_str(&whole(text)).map_err(|_| error));
    let value: Value = match read {
        Ok(value) => value,
        Err(error) => return refusal(None, ErrorCode::ParseError, format!("the message is not JSON: {error}")),
    };
    if value.is_array() {
        let why = "batches of messages are not part of the protocol";
        return refusal(None, ErrorCode::InvalidRequest, why);
    }
    let id = value.get("id").and_then(|id| serde_json::from_value(id.clone()).ok());
    match serde_json::from_value(value) {
        Ok(message) => Received::Message(message),
        Err(_) => refusal(id, ErrorCode::InvalidRequest, "this is neither a request nor a notification nor an answer"),
    }
}

/// Replaces half of a surrogate pair, as JavaScript writes it for a character that was cut in the middle (`\ud83d`), by
/// `\ufffd`.
fn whole(text: &str) -> String {
    let unit = |at: usize| {
        let digits = text.get(at..)?.strip_prefix("\\u")?.get(..4)?;
        u16::from_str_radix(digits, 16).ok()
    };
    let (mut whole, mut done, mut at) = (String::with_capacity(text.len()), 0, 0);
    while let Some(found) = text[at..].find('\\') {
        at += found;
        at += match unit(at) {
            Some(0xd800..=0xdbff) if matches!(unit(at + 6), Some(0xdc00..=0xdfff)) => 12,
            Some(0xd800..=0xdfff) => {
                whole += &text[done..at];
                whole += "\\ufffd";
                done = at + 6;
                6
            }
            Some(_) => 6,
            // The backslash and the character it escapes.
            None => 1 + text[at + 1..].chars().next().map_or(0, char::len_utf8),
        };
    }
    whole + &text[done..]
}

/// Reports an error to the client, as an answer to the request that was meant, or to none.
fn refuse(stream: &mut impl Write, Refused { id, code, why }: Refused) -> io::Result<()> {
    let error = serde_json::json!({ "code": code as i32, "message": why });
    let answer = serde_json::json!({ "jsonrpc": "2.0", "id": id, "error": error }).to_string();
    write!(stream, "Content-Length: {}\r\n\r\n{answer}", answer.len())?;
    stream.flush()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The results of reading a stream: the methods of its messages, and the codes of what was refused.
    fn received_results(stream: &[u8]) -> Vec<String> {
        let mut stream = stream;
        let mut heard = Vec::new();
        while let Some(received) = receive(&mut stream).expect("memory can be read") {
            heard.push(match received {
                Received::Message(Message::Notification(notification)) => notification.method,
                Received::Message(Message::Request(asked)) => asked.method,
                Received::Message(Message::Response(_)) => "answer".into(),
                Received::Refused(refused) => (refused.code as i32).to_string(),
            });
        }
        heard
    }

    fn frame(body: &[u8]) -> Vec<u8> {
        [format!("Content-Length: {}\r\n\r\n", body.len()).as_bytes(), body].concat()
    }

    const NEXT: &[u8] = br#"{"jsonrpc":"2.0","method":"next"}"#;

    #[test]
    fn the_next_message_is_received_after_any_input() {
        let two_of_one = br#"[{"jsonrpc":"2.0","method":"a"},{"jsonrpc":"2.0","method":"b"}]"#;
        for (wrong, code) in [
            (frame(b"{"), "-32700"),
            (frame(b""), "-32700"),
            (frame(b"\xff\xfe"), "-32700"),
            (frame(&[b'['; 100_000]), "-32700"),
            (frame(two_of_one), "-32600"),
            (frame(b"{}"), "-32600"),
            (frame(b"17"), "-32600"),
            (frame(br#"{"jsonrpc":"2.0","id":7,"method":8}"#), "-32600"),
            (b"Content-Length: 99999999999999999\r\n\r\n{}".to_vec(), "-32600"),
            (b"Content-Length: 99999999999999999999999\r\n\r\n".to_vec(), "-32600"),
            (b"Content-Length: -1\r\n\r\n".to_vec(), "-32600"),
            (b"Content-Length: many\r\n\r\nmore of it".to_vec(), "-32600"),
        ] {
            let stream = [wrong.clone(), frame(NEXT)].concat();
            assert_eq!(received_results(&stream), [code, "next"], "{}", String::from_utf8_lossy(&wrong));
        }
    }

    #[test]
    fn a_header_is_read_with_surrounding_blanks() {
        let fields = [b"\r\n\ncontent-type: x\r\nCONTENT-LENGTH:33 \r\nOther: 1\r\n\r\n", NEXT].concat();
        assert_eq!(received_results(&fields), ["next"]);
        // The stream ends in a header, and in a message.
        assert!(received_results(b"Content-Length: 12\r\n").is_empty());
        assert!(received_results(b"Content-Length: 1200\r\n\r\n{}").is_empty());
    }

    #[test]
    fn half_a_character_is_read_as_one_that_is_unknown() {
        assert_eq!(whole(r#""\ud83d""#), r#""\ufffd""#);
        assert_eq!(whole(r#""\ude00 \ud83dx\ud83d\ud83d\ude00""#), r#""\ufffd \ufffdx\ufffd\ud83d\ude00""#);
        assert_eq!(whole(r#""\\ud83d \n \u00e9 \"#), r#""\\ud83d \n \u00e9 \"#);
        let body = br#"{"jsonrpc":"2.0","method":"\ud800"}"#;
        assert_eq!(received_results(&frame(body)), ["\u{fffd}"]);
    }
}
