//! Converts bytes to positions of the protocol and back: lines from 0, columns in the units that client and server
//! agreed on.

use crate::editor::lexed::Lexed;
use gen_lsp_types::{Position, PositionEncodingKind, Range};

/// The unit of columns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    Utf8,
    Utf16,
}

impl Encoding {
    /// UTF-8 if the client offers it, otherwise UTF-16, which every client supports.
    pub fn negotiate(offered: Option<&[PositionEncodingKind]>) -> Encoding {
        match offered.is_some_and(|list| list.contains(&PositionEncodingKind::UTF8)) {
            true => Encoding::Utf8,
            false => Encoding::Utf16,
        }
    }

    pub fn kind(self) -> PositionEncodingKind {
        match self {
            Encoding::Utf8 => PositionEncodingKind::UTF8,
            Encoding::Utf16 => PositionEncodingKind::UTF16,
        }
    }

    /// Number of units in a text.
    pub fn count(self, text: &str) -> u32 {
        let count = match self {
            Encoding::Utf8 => text.len(),
            Encoding::Utf16 => text.chars().map(char::len_utf16).sum(),
        };
        count as u32
    }

    fn of(self, character: char) -> u32 {
        self.count(character.encode_utf8(&mut [0; 4]))
    }

    pub fn position(self, lexed: &Lexed, offset: usize) -> Position {
        let text = lexed.text();
        let line = lexed.lines.line(offset);
        let start = lexed.lines.line_range(text, line).start;
        Position { line: line as u32, character: self.count(text.get(start..offset).unwrap_or("")) }
    }

    pub fn range(self, lexed: &Lexed, range: std::ops::Range<usize>) -> Range {
        Range { start: self.position(lexed, range.start), end: self.position(lexed, range.end) }
    }

    /// The byte of a position; a position beyond the end of a line or of the text is moved to that end.
    pub fn offset(self, lexed: &Lexed, position: Position) -> usize {
        let text = lexed.text();
        let line = lexed.lines.line_range(text, position.line as usize);
        let mut left = position.character;
        let mut offset = line.start;
        for character in text[line].chars() {
            let units = self.of(character);
            if left < units {
                break;
            }
            left -= units;
            offset += character.len_utf8();
        }
        offset
    }
}
