//! The names of the equations: parameters as in the model, coordinates as in a textbook, each with its value if it has
//! one.

use crate::base::{Number, Rational};
use crate::model::written::{Named, Pair, Written, dot};
use crate::symbols::{Factor, Product, Sum, Symbol, common_factors};
use std::collections::BTreeMap;

/// Classes of names other than those of the model's parameters, in the order of factors.
pub mod class {
    /// Tensions that hold a drawing.
    pub const TENSION: u8 = 32;
    /// Lengths of springs and dampers, distances, angles and stretches of belts: what depends on coordinates.
    pub const LENGTH: u8 = 33;
    /// One of these at rest.
    pub const REST_LENGTH: u8 = 34;
    /// The value of a coordinate at rest, measured from the drawing.
    pub const REST: u8 = 35;
    /// Multipliers of constraints.
    pub const MULTIPLIER: u8 = 36;
    /// Lengths as drawn at which springs are free.
    pub const FREE_LENGTH: u8 = 30;
    /// Lever arms and tensions by length of lines at rest.
    pub const LINE: u8 = 37;
    /// Velocity ratios that change with the motion.
    pub const RATIO: u8 = 38;
    /// A ratio at rest, or one that is constant.
    pub const REST_RATIO: u8 = 39;
    pub const COORDINATE: u8 = 40;
    pub const VELOCITY: u8 = 41;
    pub const ACCELERATION: u8 = 42;
    /// The angles of heavy spots, their rates and their second derivatives.
    pub const HEAVY_SPOT: u8 = 43;
    pub const PRESCRIBED: u8 = 44;
    pub const PRESCRIBED_VELOCITY: u8 = 45;
    pub const PRESCRIBED_ACCELERATION: u8 = 46;
    pub const TIME: u8 = 47;
    /// Forces and torques.
    pub const FORCE: u8 = 48;
    /// Rates of lengths.
    pub const LENGTH_RATE: u8 = 49;
    /// The variable of Laplace's transform.
    pub const LAPLACE: u8 = 50;
}

/// The notation of a name: a word, an index below it, and the number of differentiations.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Label {
    pub word: String,
    pub index: String,
    pub dots: u8,
}

impl Label {
    pub fn new(word: impl Into<String>, index: impl Into<String>) -> Label {
        Label { word: word.into(), index: index.into(), dots: 0 }
    }

    /// The name as the model or a plain text would write it: `x_block`.
    pub fn plain(&self) -> String {
        match &self.index {
            index if index.is_empty() => self.word.clone(),
            // A running index: `y_(i-1)`.
            index if index.contains(['+', '-']) => format!("{}_({index})", self.word),
            index => format!("{}_{index}", self.word),
        }
    }
}

/// Every name that may occur.
#[derive(Clone, Debug, Default)]
pub struct Names {
    labels: BTreeMap<Symbol, Label>,
    values: BTreeMap<Symbol, Number>,
    /// Names that are written as the cosine of an angle.
    cosines: BTreeMap<Symbol, Symbol>,
    /// The parameters, `let`s and made-up names of the model.
    pub given: Vec<Named>,
}

impl Names {
    pub fn new(written: &Written) -> Names {
        let mut names = Names { given: written.names.clone(), ..Names::default() };
        for named in &written.names {
            names.labels.insert(named.symbol, Label::new(named.text.clone(), ""));
            names.values.insert(named.symbol, named.value.clone());
        }
        names
    }

    pub fn label(&self, symbol: Symbol) -> Label {
        self.labels.get(&symbol).cloned().unwrap_or_else(|| Label::new("?", ""))
    }

    pub fn set(&mut self, symbol: Symbol, label: Label, value: Option<Number>) {
        self.labels.insert(symbol, label);
        if let Some(value) = value {
            self.values.insert(symbol, value);
        }
    }

    pub fn set_value(&mut self, symbol: Symbol, value: Number) {
        self.values.insert(symbol, value);
    }

    pub fn set_cosine(&mut self, symbol: Symbol, angle: Symbol) {
        self.cosines.insert(symbol, angle);
    }

    /// The angle that a name is the cosine of.
    pub fn angle_of_cosine(&self, symbol: Symbol) -> Option<Symbol> {
        self.cosines.get(&symbol).copied()
    }

    pub fn value(&self, symbol: Symbol) -> Option<&Number> {
        self.values.get(&symbol)
    }

    /// The value of a sum of names that have values.
    pub fn value_of(&self, sum: &Sum) -> Option<Number> {
        sum.value(&|symbol| self.values.get(&symbol).cloned())
    }

    /// A label that no parameter has.
    pub fn fresh(&self, word: &str, index: String) -> Label {
        let label = Label::new(word, index);
        match self.is_taken(&label.plain()) {
            true => Label::new(word, format!("{},line", label.index)),
            false => label,
        }
    }

    /// Whether a word is taken by a parameter.
    pub fn is_taken(&self, word: &str) -> bool {
        self.given.iter().any(|named| named.text == word)
    }

    /// Displacement, velocity and acceleration of a coordinate; labels follow.
    pub fn coordinate(&self, index: usize, prescribed: bool) -> [Symbol; 3] {
        let classes = if prescribed {
            [class::PRESCRIBED, class::PRESCRIBED_VELOCITY, class::PRESCRIBED_ACCELERATION]
        } else {
            [class::COORDINATE, class::VELOCITY, class::ACCELERATION]
        };
        classes.map(|class| Symbol::new(class, index))
    }

    /// The positive root of a square of lengths.
    pub fn length(&self, square: &Sum) -> Sum {
        match square.exact_root() {
            Some(root) if self.value_of(&root).is_some_and(|value| value.is_negative()) => -&root,
            Some(root) if self.value_of(&root).is_some() => root,
            _ => self.square_root(square),
        }
    }

    /// The root, with squares of positive names taken out that all terms share.
    fn square_root(&self, square: &Sum) -> Sum {
        let shared = common_factors(square).product;
        let is_positive = |factor: &Factor| {
            let value = self.value_of(&Sum::term(Product::of(factor.clone(), 1), Rational::ONE));
            value.is_some_and(|value| value.is_positive())
        };
        let even = shared.factors().iter().filter(|(factor, exponent)| {
            let is_plain = matches!(factor, Factor::Name(_) | Factor::Pi);
            is_plain && exponent % 2 == 0 && is_positive(factor)
        });
        let outside = even.fold(Sum::one(), |product, (factor, exponent)| {
            &product * &Sum::term(Product::of(factor.clone(), exponent / 2), Rational::ONE)
        });
        match outside.inverse() {
            Some(inverse) => &outside * &(square * &inverse.square()).root(),
            None => square.root(),
        }
    }

    /// A direction with the length one.
    pub fn unit(&self, direction: &Pair) -> Pair {
        let length = self.length(&dot(direction, direction));
        match length.inverse() {
            Some(inverse) => direction.each_ref().map(|part| (part * &inverse).simplify()),
            None => direction.clone(),
        }
    }
}

/// The sum with every motion and force at zero.
pub fn without_motion(sum: &Sum) -> Sum {
    sum.replace(&|symbol| {
        let moves = (class::COORDINATE..=class::FORCE).contains(&symbol.class());
        moves.then_some(Sum::ZERO)
    })
}
