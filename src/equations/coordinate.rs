//! Coordinates: the body and its motion, the letter that a textbook gives it, and the name of its value at rest.

use super::names::{Label, Names};
use crate::base::{Name, Span, Words};
use crate::model::scene::Part;
use crate::symbols::{Sum, Symbol};

/// A coordinate of the tree, or a motion that a base prescribes.
#[derive(Clone, Debug)]
pub struct Coordinate {
    pub owner: Part,
    pub owner_name: Name,
    /// The place where its body or base is declared.
    pub span: Span,
    /// `x`, `y`, `along`, `slide`, `angle`.
    pub motion: &'static str,
    pub turns: bool,
    /// Displacement, velocity, acceleration.
    pub symbols: [Symbol; 3],
    /// Its value at rest.
    pub rest: Sum,
    /// The input of a prescribed motion.
    pub input: Option<usize>,
}

/// Labels of coordinates: `x` and `theta` if there is one of its kind, otherwise with the name of the body.
pub fn label(names: &mut Names, coordinates: &[Coordinate], words: &Words) {
    for coordinate in coordinates {
        let word = letter(coordinate);
        let alone = coordinates.iter().filter(|other| letter(other) == word).count() == 1;
        let label = if alone && !names.is_taken(word) {
            Label::new(word, "")
        } else {
            let whose = |coordinate: &Coordinate| (coordinate.owner_name.place, coordinate.owner_name.symbol);
            let mut name = words.without_indices(coordinate.owner_name);
            let same_word =
                coordinates.iter().filter(|other| letter(other) == word).all(|other| whose(other) == whose(coordinate));
            let indices: Vec<String> = coordinate.owner_name.indices().iter().map(i32::to_string).collect();
            if same_word && !indices.is_empty() && !names.is_taken(word) {
                name.clear();
            } else if !indices.is_empty() {
                name.push(',');
            }
            Label::new(word, name + &indices.join(","))
        };
        for (dots, symbol) in coordinate.symbols.iter().enumerate() {
            names.set(*symbol, Label { dots: dots as u8, ..label.clone() }, None);
        }
    }
}

/// The symbol of a coordinate in textbooks.
fn letter(coordinate: &Coordinate) -> &'static str {
    let prescribed = matches!(coordinate.owner, Part::Base(_));
    match (coordinate.motion, prescribed) {
        ("angle", false) => "theta",
        ("angle", true) => "phi",
        ("x", true) => "u",
        ("y", true) => "v",
        (_, true) => "w",
        ("x", false) => "x",
        ("y", false) => "y",
        _ => "s",
    }
}
