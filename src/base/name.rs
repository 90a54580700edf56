//! Names: a word, its indices if it was declared in a `repeat`, and the name of the place if it is in a placed component.
//! `m[3]`, `net[2][7]`, `front.wheel`, `mount[3].s`.

use std::collections::HashMap;
use std::fmt::Write;

/// An interned word.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Symbol(u32);

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
    pub fn within(self, place: Place) -> Name {
        Name { place, ..self }
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

/// The words of a model. They are looked up by text and never iterated over, so their order cannot affect a result.
#[derive(Clone, Debug, Default)]
pub struct Words {
    by_text: HashMap<Box<str>, Symbol>,
    texts: Vec<Box<str>>,
    /// Places that were named before they were declared.
    mentioned: HashMap<Name, Place>,
    /// The names of the places.
    places: Vec<Name>,
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

    /// The space of the names in a component that is placed under this name, which is declared once.
    pub fn declare_place(&mut self, name: Name) -> Place {
        if self.mentioned.is_empty() {
            return self.add_place(name);
        }
        self.mentioned.get(&name).copied().unwrap_or_else(|| self.add_place(name))
    }

    /// The space of the names in a component that will be placed under this name.
    pub fn mention_place(&mut self, name: Name) -> Place {
        if let Some(&place) = self.mentioned.get(&name) {
            return place;
        }
        let place = self.add_place(name);
        self.mentioned.insert(name, place);
        place
    }

    fn add_place(&mut self, name: Name) -> Place {
        self.places.push(name);
        Place(u32::try_from(self.places.len()).expect("the number of places is limited far below"))
    }

    /// The name of a place; `None` for the scene.
    pub fn place_name(&self, place: Place) -> Option<Name> {
        self.places.get(place.index()?).copied()
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
