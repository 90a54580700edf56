//! Names: a word and, where it was declared in a `repeat`, its indices. `m[3]`, `net[2][7]`.

use std::collections::HashMap;
use std::fmt::Write;

/// An interned word.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Symbol(u32);

/// At most this many indices follow a word.
pub const MAX_INDICES: usize = 3;

/// A word with its indices.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Name {
    pub symbol: Symbol,
    count: u8,
    indices: [i32; MAX_INDICES],
}

impl Name {
    pub fn plain(symbol: Symbol) -> Name {
        Name { symbol, count: 0, indices: [0; MAX_INDICES] }
    }

    /// `None` for more than [`MAX_INDICES`] indices.
    pub fn indexed(symbol: Symbol, given: &[i32]) -> Option<Name> {
        let mut name = Name::plain(symbol);
        name.indices.get_mut(..given.len())?.copy_from_slice(given);
        name.count = given.len() as u8;
        Some(name)
    }

    pub fn indices(&self) -> &[i32] {
        &self.indices[..self.count as usize]
    }
}

/// The words of a model. Looked up by text, never walked through, so its order cannot reach a result.
#[derive(Clone, Debug, Default)]
pub struct Words {
    by_text: HashMap<Box<str>, Symbol>,
    texts: Vec<Box<str>>,
}

impl Words {
    pub fn new() -> Words {
        Words::default()
    }

    pub fn intern(&mut self, text: &str) -> Symbol {
        if let Some(&symbol) = self.by_text.get(text) {
            return symbol;
        }
        let symbol = Symbol(u32::try_from(self.texts.len()).expect("a file is smaller than 4 GiB"));
        self.texts.push(text.into());
        self.by_text.insert(text.into(), symbol);
        symbol
    }

    pub fn get(&self, text: &str) -> Option<Symbol> {
        self.by_text.get(text).copied()
    }

    pub fn text(&self, symbol: Symbol) -> &str {
        &self.texts[symbol.0 as usize]
    }

    /// As written in a model: `m[3]`, `net[2][7]`.
    pub fn display(&self, name: Name) -> String {
        let mut text = self.text(name.symbol).to_string();
        for index in name.indices() {
            // Writing to a string cannot fail.
            let _ = write!(text, "[{index}]");
        }
        text
    }
}
