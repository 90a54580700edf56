//! The equations about rest, to first order: each entry of M, C and K and of the columns of the inputs as a sum.
//!
//! A spring along a line pulls with P = k (l - l_0) + T; with g = (l^2)'/2 at rest it adds k g_i g_j/l^2 + P/l (g_ij - g_i g_j/l^2).

use super::energy::{Energies, Stretch};
use super::lagrange::Equation;
use super::motion::Motion;
use super::names::{Label, Names, class, without_motion};
use crate::elements::Order;
use crate::symbols::{Lengths, Sum, Symbol};

/// A square matrix of sums, row by row.
pub type Matrix = Vec<Vec<Sum>>;

/// M q'' + C q' + K q = sum (B0 u + B1 u' + B2 u'').
#[derive(Clone, Debug, Default)]
pub struct Linear {
    pub mass: Matrix,
    pub damping: Matrix,
    pub stiffness: Matrix,
    pub inputs: Vec<Column>,
    /// Lengths at rest that have a name, each with its square.
    pub lengths: Vec<(Symbol, Sum)>,
}

/// The column of an input.
#[derive(Clone, Debug)]
pub struct Column {
    /// Among the inputs of the scene.
    pub input: usize,
    /// The symbols of u, u', u''; a force has the first alone.
    pub symbols: Vec<Symbol>,
    /// By the order of the derivative, a sum for each equation.
    pub parts: Vec<Vec<Sum>>,
}

/// Everything at rest.
pub struct AtRest {
    lengths: Vec<(Symbol, Sum)>,
    pub named: Vec<(Symbol, Sum)>,
}

impl AtRest {
    pub fn new(energies: &Energies, names: &mut Names) -> AtRest {
        let (mut lengths, mut named) = (Vec::new(), Vec::new());
        for (symbol, square) in &energies.lengths.0 {
            let square = without_motion(square);
            let length = match names.length(&square) {
                length if is_short(&length) => length,
                _ => {
                    let rest = Symbol::new(class::REST_LENGTH, symbol.place());
                    let label = names.label(*symbol);
                    let value = names.value_of(&square).and_then(|value| value.sqrt());
                    names.set(rest, Label::new(label.word, format!("{},0", label.index)), value);
                    named.push((rest, square));
                    Sum::name(rest)
                }
            };
            lengths.push((*symbol, length));
        }
        AtRest { lengths, named }
    }

    pub fn of(&self, sum: &Sum) -> Sum {
        let length = |symbol: Symbol| self.lengths.iter().find(|(name, _)| *name == symbol).map(|(_, at)| at.clone());
        without_motion(&sum.replaced(&length))
    }

    pub fn length(&self, symbol: Symbol) -> Sum {
        self.of(&Sum::name(symbol))
    }
}

/// A length that is written out: a number, a name, or a root of few terms without angles.
fn is_short(length: &Sum) -> bool {
    use crate::symbols::Factor;
    let short = |factor: &Factor| match factor {
        Factor::Name(_) | Factor::Pi => true,
        Factor::Root(inside) => inside.terms().len() <= 2,
        _ => false,
    };
    length.terms().len() <= 2
        && length.terms().iter().all(|(product, _)| product.factors().iter().all(|(f, _)| short(f)))
}

/// The linear equations over all free coordinates; constraints add the curvature under their multipliers elsewhere.
pub fn linear(motion: &Motion, energies: &Energies, equations: &[Equation], at_rest: &AtRest) -> Linear {
    let n = motion.free;
    let none = Lengths::default();
    let zero = || vec![vec![Sum::ZERO; n]; n];
    let mut linear =
        Linear { mass: zero(), damping: zero(), stiffness: zero(), inputs: Vec::new(), lengths: at_rest.named.clone() };
    for (i, equation) in equations.iter().enumerate() {
        for j in 0..n {
            let [q, v, a] = motion.coordinates[j].symbols;
            linear.mass[i][j] = without_motion(&equation.plain.derivative(a, &none));
            linear.damping[i][j] = without_motion(&equation.plain.derivative(v, &none));
            linear.stiffness[i][j] = at_rest.of(&equation.plain.derivative(q, &energies.lengths));
        }
    }
    lines(motion, energies, equations, at_rest, &mut linear);
    columns(motion, energies, equations, at_rest, &mut linear);
    linear
}

/// The contributions of springs, dampers and inerters along lines.
fn lines(motion: &Motion, energies: &Energies, equations: &[Equation], at_rest: &AtRest, linear: &mut Linear) {
    for (i, equation) in equations.iter().enumerate() {
        for line in &equation.lines {
            for j in 0..motion.free {
                let [q, ..] = motion.coordinates[j].symbols;
                let (own, geometric) = line_entry(energies, line, q, at_rest);
                let element = &energies.elements[line.element];
                let matrix = match element.order {
                    Order::Displacement => &mut linear.stiffness,
                    Order::Velocity => &mut linear.damping,
                    Order::Acceleration => &mut linear.mass,
                };
                matrix[i][j] = &(&matrix[i][j] + &own) + &geometric;
            }
        }
    }
}

/// k g_i g_j / l^2 and P/l (g_ij - g_i g_j/l^2) of a line for another coordinate.
fn line_entry(energies: &Energies, line: &super::lagrange::Line, by: Symbol, at_rest: &AtRest) -> (Sum, Sum) {
    let element = &energies.elements[line.element];
    let none = Lengths::default();
    let (length, square) = match &element.stretch {
        Stretch::Line { length, square, .. } => (length, square),
        Stretch::Plain(stretch) => {
            let own = &without_motion(&line.slope) * &without_motion(&stretch.derivative(by, &none));
            let pull = if element.is_spring() { at_rest.of(&element.pull()) } else { Sum::ZERO };
            return (&element.coefficient * &own, &pull * &without_motion(&line.slope.derivative(by, &none)));
        }
    };
    let length = at_rest.length(*length);
    let Some(per_square) = length.square().inverse() else { return Default::default() };
    let (own, other) = (without_motion(&line.slope), without_motion(&square.derivative(by, &none).halved()));
    let both = &(&own * &other) * &per_square;
    let elastic = &element.coefficient * &both;
    let pull = at_rest.of(&element.pull());
    if pull.is_zero() || !element.is_spring() {
        return (elastic, Sum::ZERO);
    }
    let bend = &without_motion(&line.slope.derivative(by, &none)) - &both;
    let geometric = &(&pull * &length.inverse().unwrap_or_default()) * &bend;
    (elastic, geometric)
}

/// The contributions of bases and forces to each equation, on the right side.
fn columns(motion: &Motion, energies: &Energies, equations: &[Equation], at_rest: &AtRest, linear: &mut Linear) {
    let none = Lengths::default();
    for coordinate in motion.coordinates.iter().skip(motion.free) {
        let Some(input) = coordinate.input else { continue };
        let mut parts = vec![Vec::new(); 3];
        for equation in equations {
            for (order, symbol) in coordinate.symbols.iter().enumerate() {
                let lengths = if order == 0 { &energies.lengths } else { &none };
                let mut entry = at_rest.of(&equation.plain.derivative(*symbol, lengths));
                for line in &equation.lines {
                    let (own, geometric) = line_entry(energies, line, coordinate.symbols[0], at_rest);
                    if energies.elements[line.element].order as usize == order {
                        entry = &(&entry + &own) + &geometric;
                    }
                }
                parts[order].push(-&entry);
            }
        }
        linear.inputs.push(Column { input, symbols: coordinate.symbols.to_vec(), parts });
    }
    for work in &energies.works {
        let part =
            equations.iter().map(|equation| at_rest.of(&equation.forces.derivative(work.force, &none))).collect();
        linear.inputs.push(Column { input: work.input, symbols: vec![work.force], parts: vec![part] });
    }
    linear.inputs.sort_by_key(|column| column.input);
}
