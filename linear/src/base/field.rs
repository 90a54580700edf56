//! The description of a field: its name, its value, an example to type, and its documentation.

use super::Dimension;

/// A number that a place of the model expects.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Expected {
    /// The noun with its article: "a mass".
    pub noun: &'static str,
    pub dimension: Dimension,
    /// An example to type, such as `mass = 1 kg`.
    pub example: &'static str,
    of: Of,
}

/// Whether the noun says all about a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Of {
    Noun,
    /// As [`Of::Noun`], of the motion of an angle.
    Angle,
    /// The number is known by its unit.
    Unit,
    /// The number is a ratio of an output to an input, of these dimensions.
    Gain {
        input: Dimension,
        output: Dimension,
    },
}

impl Expected {
    pub const fn new(noun: &'static str, dimension: Dimension, example: &'static str) -> Expected {
        Expected { noun, dimension, example, of: Of::Noun }
    }

    /// A motion of an angle, whose unit is one of an angle.
    pub const fn angular(noun: &'static str, dimension: Dimension, example: &'static str) -> Expected {
        Expected { noun, dimension, example, of: Of::Angle }
    }

    /// A number that has no name.
    pub const fn without_name(dimension: Dimension) -> Expected {
        Expected { noun: "a quantity", dimension, example: "", of: Of::Unit }
    }

    /// A ratio of an output to an input.
    pub const fn gain(dimension: Dimension, input: Dimension, output: Dimension) -> Expected {
        Expected { noun: "a gain", dimension, example: "", of: Of::Gain { input, output } }
    }

    /// The number in words: `a mass`, `a quantity in m^2/s^2`, `a gain from m to m/s^2`.
    pub fn phrase(&self) -> String {
        match self.of {
            Of::Noun | Of::Angle => self.noun.to_string(),
            Of::Unit => match self.unit() {
                unit if unit.starts_with('/') => format!("{} in 1{unit}", self.noun),
                unit => format!("{} in {unit}", self.noun),
            },
            Of::Gain { input, output } => {
                format!("{} from {} to {}", self.noun, motion_unit(input), motion_unit(output))
            }
        }
    }

    /// The usual unit. That of a ratio is not an angular one, unless its parts are.
    pub fn unit(&self) -> String {
        match (self.of, self.dimension) {
            (Of::Gain { input: Dimension::NONE, output }, _) => motion_unit(output),
            (Of::Unit | Of::Gain { .. }, Dimension::FREQUENCY | Dimension::ANGULAR_ACCELERATION) => {
                self.dimension.to_string()
            }
            (Of::Angle, _) => motion_unit(self.dimension),
            _ => self.dimension.usual_unit(),
        }
    }

    /// A number to type.
    pub fn example_text(&self) -> String {
        match (self.example, self.unit()) {
            ("", unit) if unit.is_empty() => "3".to_string(),
            ("", unit) => format!("3 {unit}"),
            (example, _) => example.to_string(),
        }
    }

    /// The motion of the input that is meant, if that is not obvious.
    pub fn remark(&self) -> Option<&'static str> {
        let turning = "the input of a base that turns is its angle";
        match self.of {
            Of::Gain { input: Dimension::LENGTH, output: Dimension::LENGTH } => None,
            Of::Gain { input: Dimension::LENGTH, .. } => Some("the input of a base is its displacement"),
            Of::Gain { input: Dimension::NONE, output } if !output.is_none() => Some(turning),
            _ => None,
        }
    }
}

/// The usual unit of an input or output.
fn motion_unit(dimension: Dimension) -> String {
    match dimension {
        Dimension::NONE => "rad".to_string(),
        Dimension::ANGULAR_VELOCITY => "rad/s".to_string(),
        _ => dimension.usual_unit(),
    }
}

/// A field in the braces of a declaration.
#[derive(Clone, Copy, Debug)]
pub struct Field {
    pub name: &'static str,
    pub takes: Takes,
    /// An example to type, such as `mass = 1 kg`.
    pub example: &'static str,
    /// One or two sentences for editors.
    pub meaning: &'static str,
}

/// The value of a field.
#[derive(Clone, Copy, Debug)]
pub enum Takes {
    Number(Expected),
    /// A number of an element: for a translation, or for a rotation if the element is torsional.
    Either {
        line: Expected,
        turn: Expected,
    },
    /// A point of the drawing.
    Position,
    /// `x`, `y` or a vector.
    Direction,
    /// `rod(A, B)`, `disk(r)`, ...
    Shape,
    /// The motions that follow `moves`.
    Motions,
    /// A force over this word, `stretch` or `rate`.
    Law(&'static str),
    /// No value: the word alone.
    Nothing,
}

impl Field {
    pub const fn number(name: &'static str, expected: Expected, meaning: &'static str) -> Field {
        Field { name, takes: Takes::Number(expected), example: expected.example, meaning }
    }

    pub const fn by_motion(name: &'static str, line: Expected, turn: Expected, meaning: &'static str) -> Field {
        Field { name, takes: Takes::Either { line, turn }, example: line.example, meaning }
    }

    pub const fn new(name: &'static str, takes: Takes, example: &'static str, meaning: &'static str) -> Field {
        Field { name, takes, example, meaning }
    }

    /// The number that the field takes; of an element, the translational or, if `turns`, the torsional one.
    pub const fn expected_number(&self, turns: bool) -> Expected {
        match self.takes {
            Takes::Number(expected) => expected,
            Takes::Either { turn, .. } if turns => turn,
            Takes::Either { line, .. } => line,
            _ => panic!("this field takes no number"),
        }
    }

    /// Whether the word may appear without `=`.
    pub fn stands_alone(&self) -> bool {
        matches!(self.takes, Takes::Motions | Takes::Nothing)
    }
}

/// The index of a field in a table, for constants: a name that is not in the table does not compile.
pub const fn place(fields: &[Field], name: &str) -> usize {
    let mut place = 0;
    while place < fields.len() {
        if is_same(fields[place].name, name) {
            return place;
        }
        place += 1;
    }
    panic!("no field has this name")
}

const fn is_same(a: &str, b: &str) -> bool {
    let (a, b) = (a.as_bytes(), b.as_bytes());
    if a.len() != b.len() {
        return false;
    }
    let mut at = 0;
    while at < a.len() {
        if a[at] != b[at] {
            return false;
        }
        at += 1;
    }
    true
}
