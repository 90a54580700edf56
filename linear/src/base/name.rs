//! Names: a word, its indices if it was declared in a `repeat`, and the name of the place if it is in a placed component.
//! `m[3]`, `net[2][7]`, `front.wheel`, `mount[3].s`.

use std::collections::HashMap;
use std::fmt::{self, Write};
use std::hash::{BuildHasher, RandomState};
use std::sync::Arc;

/// An interned word.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Symbol(u32);

impl Symbol {
    /// Its number among the words of the model, in the order in which they were met.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// The space of a name: the scene, or a component at one of its places.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Place(u32);

impl Place {
    /// Outside of every component.
    pub const SCENE: Place = Place(0);

    /// The number of a place of a component, from 0 on; `None` for the scene.
    pub fn index(self) -> Option<usize> {
        (self.0 as usize).checked_sub(1)
    }
}

/// At most this many indices follow a word.
pub const MAX_INDICES: usize = 3;

/// A word with its indices and its space.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Name {
    pub place: Place,
    pub symbol: Symbol,
    count: u8,
    indices: [i32; MAX_INDICES],
}

impl Name {
    /// A word of the scene without indices.
    pub fn plain(symbol: Symbol) -> Name {
        Name { place: Place::SCENE, symbol, count: 0, indices: [0; MAX_INDICES] }
    }

    /// This word with its indices, in another place.
    pub fn in_place(self, place: Place) -> Name {
        Name { place, ..self }
    }

    /// `None` for more than [`MAX_INDICES`] indices.
    pub fn with_indices(symbol: Symbol, given: &[i32]) -> Option<Name> {
        let mut name = Name::plain(symbol);
        name.indices.get_mut(..given.len())?.copy_from_slice(given);
        name.count = given.len() as u8;
        Some(name)
    }

    /// Whether it is a word of the scene without indices.
    pub fn is_plain(&self) -> bool {
        self.place == Place::SCENE && self.count == 0
    }

    pub fn indices(&self) -> &[i32] {
        &self.indices[..self.count as usize]
    }
}

/// The words of a model. They are looked up by text and never iterated over, so their order cannot affect a result.
///
/// Copies share their contents until one of them learns a word: the scene and its linear system have the same words.
#[derive(Clone, Default)]
pub struct Words {
    shared: Arc<Vocabulary>,
}

impl fmt::Debug for Words {
    /// The words and the places, without the table, whose order is drawn at random.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Vocabulary { ends, places, .. } = &*self.shared;
        let texts = (0..ends.len() as u32).map(|symbol| self.text(Symbol(symbol)));
        f.debug_struct("Words").field("texts", &texts.collect::<Vec<_>>()).field("places", places).finish()
    }
}

/// The contents of [`Words`]. A file with a million words has no allocation for any of them: the texts stand one behind
/// the other, and the table that finds them holds their numbers.
#[derive(Clone, Default)]
struct Vocabulary {
    texts: String,
    /// The end of each text in `texts`; it starts where the one before ends.
    ends: Vec<u32>,
    /// Open addressing: a symbol plus one, or 0; as long as a power of two, and never more than half full.
    table: Vec<u32>,
    /// The start of the table is drawn at random, so that no file can be made to collide.
    hasher: RandomState,
    /// Places that were named before they were declared.
    mentioned: HashMap<Name, Place>,
    /// The names of the places.
    places: Vec<Name>,
}

impl Vocabulary {
    fn text(&self, symbol: Symbol) -> &str {
        let at = symbol.0 as usize;
        let start = at.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.texts[start as usize..self.ends[at] as usize]
    }

    /// The slot of the table that holds the text, or would hold it. The table has an empty slot.
    fn slot(&self, text: &str) -> usize {
        let mask = self.table.len() - 1;
        let mut slot = self.hasher.hash_one(text) as usize & mask;
        while let Some(known) = self.table[slot].checked_sub(1)
            && self.text(Symbol(known)) != text
        {
            slot = (slot + 1) & mask;
        }
        slot
    }

    fn get(&self, text: &str) -> Option<Symbol> {
        if self.table.is_empty() {
            return None;
        }
        self.table[self.slot(text)].checked_sub(1).map(Symbol)
    }

    fn add(&mut self, text: &str) -> Symbol {
        if self.table.len() <= 2 * self.ends.len() {
            self.grow();
        }
        let fits = "a file is smaller than 4 GiB";
        let symbol = Symbol(u32::try_from(self.ends.len()).expect(fits));
        let slot = self.slot(text);
        self.texts.push_str(text);
        self.ends.push(u32::try_from(self.texts.len()).expect(fits));
        self.table[slot] = symbol.0 + 1;
        symbol
    }

    fn grow(&mut self) {
        self.table = vec![0; (2 * self.table.len()).max(16)];
        for symbol in (0..self.ends.len() as u32).map(Symbol) {
            let slot = self.slot(self.text(symbol));
            self.table[slot] = symbol.0 + 1;
        }
    }

    fn add_place(&mut self, name: Name) -> Place {
        self.places.push(name);
        Place(u32::try_from(self.places.len()).expect("the number of places is limited far below"))
    }
}

impl Words {
    pub fn new() -> Words {
        Words::default()
    }

    pub fn intern(&mut self, text: &str) -> Symbol {
        self.get(text).unwrap_or_else(|| Arc::make_mut(&mut self.shared).add(text))
    }

    pub fn get(&self, text: &str) -> Option<Symbol> {
        self.shared.get(text)
    }

    pub fn text(&self, symbol: Symbol) -> &str {
        self.shared.text(symbol)
    }

    /// The space of the names in a component that is placed under this name, which is declared once.
    pub fn declare_place(&mut self, name: Name) -> Place {
        let contents = Arc::make_mut(&mut self.shared);
        let mentioned = if contents.mentioned.is_empty() { None } else { contents.mentioned.get(&name).copied() };
        mentioned.unwrap_or_else(|| contents.add_place(name))
    }

    /// The space of the names in a component that will be placed under this name.
    pub fn mention_place(&mut self, name: Name) -> Place {
        let contents = Arc::make_mut(&mut self.shared);
        if let Some(&place) = contents.mentioned.get(&name) {
            return place;
        }
        let place = contents.add_place(name);
        contents.mentioned.insert(name, place);
        place
    }

    /// The name of a place; `None` for the scene.
    pub fn place_name(&self, place: Place) -> Option<Name> {
        self.shared.places.get(place.index()?).copied()
    }

    /// The word after the names of its places: `mount[3].s`.
    pub fn without_indices(&self, name: Name) -> String {
        // From the outermost place inwards; each name knows the place around it.
        match self.place_name(name.place) {
            Some(place) => format!("{}.{}", self.display(place), self.text(name.symbol)),
            None => self.text(name.symbol).to_string(),
        }
    }

    /// As written in a model: `m[3]`, `net[2][7]`, `front.wheel`.
    pub fn display(&self, name: Name) -> String {
        let mut text = self.without_indices(name);
        for index in name.indices() {
            // Writing to a string cannot fail.
            let _ = write!(text, "[{index}]");
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_found_and_copies_do_not_see_new_ones() {
        let mut words = Words::new();
        assert_eq!(words.get("m"), None);
        let text = |i: usize| format!("m{i}");
        let symbols: Vec<Symbol> = (0..1000).map(|i| words.intern(&text(i))).collect();
        for (i, symbol) in symbols.iter().enumerate() {
            assert_eq!((words.intern(&text(i)), words.get(&text(i))), (*symbol, Some(*symbol)));
            assert_eq!(words.text(*symbol), text(i));
        }
        let empty = words.intern("");
        assert_eq!((words.text(empty), words.get("")), ("", Some(empty)));
        let copy = words.clone();
        let new = words.intern("new");
        assert_eq!((words.text(new), copy.get("new")), ("new", None));
        assert_eq!(copy.text(symbols[7]), "m7");
    }
}
