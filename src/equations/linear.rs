//! The equations about rest, to first order: each entry of M, C and K and of the columns of the inputs as a sum.

use super::energy::Energies;
use super::lagrange::Equation;
use super::lines::{AtRest, entry};
use super::motion::Motion;
use super::names::without_motion;
use crate::base::OrderBy;
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
    /// Lever arms and tensions by length at rest that have a name.
    pub parts: Vec<(Symbol, Sum)>,
}

/// The column of an input.
#[derive(Clone, Debug)]
pub struct Column {
    /// Index of the input of the scene.
    pub input: usize,
    /// The symbols of u, u', u''; a force has only the first one, an unbalance none.
    pub symbols: Vec<Symbol>,
    /// The force of an unbalance, -u''.
    pub force: Option<Sum>,
    /// For each order of the derivative, a sum for each equation.
    pub parts: Vec<Vec<Sum>>,
}

/// The linear equations over all free coordinates; constraints add the curvature under their multipliers elsewhere.
pub fn linear(motion: &Motion, energies: &Energies, equations: &[Equation], at_rest: &AtRest) -> Linear {
    let n = motion.free;
    let none = Lengths::default();
    let zero = || vec![vec![Sum::ZERO; n]; n];
    let (lengths, parts) = (at_rest.named.clone(), at_rest.parts.clone());
    let mut linear = Linear { mass: zero(), damping: zero(), stiffness: zero(), inputs: Vec::new(), lengths, parts };
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
                let row = motion.coordinates[i].symbols[0];
                let (own, geometric) = entry(energies, line, [row, q], at_rest);
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

/// The contributions of bases and forces to each equation, on the right side.
fn columns(motion: &Motion, energies: &Energies, equations: &[Equation], at_rest: &AtRest, linear: &mut Linear) {
    let none = Lengths::default();
    for coordinate in motion.coordinates.iter().skip(motion.free) {
        let Some(input) = coordinate.input else { continue };
        let mut parts = vec![Vec::new(); 3];
        for (i, equation) in equations.iter().enumerate() {
            let row = motion.coordinates[i].symbols[0];
            for (order, symbol) in coordinate.symbols.iter().enumerate() {
                let lengths = if order == 0 { &energies.lengths } else { &none };
                let mut sum = at_rest.of(&equation.plain.derivative(*symbol, lengths));
                for line in &equation.lines {
                    let (own, geometric) = entry(energies, line, [row, coordinate.symbols[0]], at_rest);
                    if energies.elements[line.element].order as usize == order {
                        sum = &(&sum + &own) + &geometric;
                    }
                }
                parts[order].push(-&sum);
            }
        }
        linear.inputs.push(Column { input, symbols: coordinate.symbols.to_vec(), force: None, parts });
    }
    for work in &energies.works {
        let slopes = equations.iter().map(|equation| at_rest.of(&equation.forces.derivative(work.force, &none)));
        linear.inputs.push(match &work.unbalance {
            None => {
                let parts = vec![slopes.collect()];
                Column { input: work.input, symbols: vec![work.force], force: None, parts }
            }
            Some(unbalance) => {
                let zero = || vec![Sum::ZERO; equations.len()];
                let parts = vec![zero(), zero(), slopes.map(|slope| -&slope).collect()];
                Column { input: work.input, symbols: Vec::new(), force: Some(unbalance.force.clone()), parts }
            }
        });
    }
    linear.inputs.order_by_key(|column| column.input);
}
