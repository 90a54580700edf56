//! Springs, dampers and inerters at rest: what each adds to an entry of the linearised equations.
//!
//! A spring along a line pulls with P = k (l - l_0) + T; with g = (l^2)'/2 at rest it adds k g_i g_j/l^2 + P/l (g_ij - g_i g_j/l^2).
//! Where that is long, the lever arms r_i = g_i/l and the tension by length q = P/l get names, and it adds k r_i r_j + q (g_ij - r_i r_j).

use super::energy::{Element, Energies, Stretch};
use super::lagrange::{Equation, Line};
use super::motion::Motion;
use super::names::{Label, Names, class, without_motion};
use crate::symbols::{Factor, Lengths, Sum, Symbol};
use std::collections::BTreeMap;

/// Terms that one line adds to an entry without names for its parts.
const MOST_TERMS: usize = 6;

/// Everything at rest.
pub struct AtRest {
    lengths: Vec<(Symbol, Sum)>,
    /// Lengths that have a name, each with its square.
    pub named: Vec<(Symbol, Sum)>,
    /// Lever arms and tensions by length that have a name.
    pub parts: Vec<(Symbol, Sum)>,
    /// By their places among the elements of the energies.
    lines: BTreeMap<usize, Parts>,
}

/// A line whose contributions are long.
struct Parts {
    /// By the displacement of the coordinate.
    levers: BTreeMap<Symbol, Sum>,
    /// The tension by length; zero of what is no spring.
    density: Sum,
    /// k, or the tangent of a law.
    tangent: Sum,
}

impl AtRest {
    pub fn new(motion: &Motion, energies: &Energies, names: &mut Names) -> AtRest {
        let mut at_rest = AtRest { lengths: Vec::new(), named: Vec::new(), parts: Vec::new(), lines: BTreeMap::new() };
        for (symbol, square) in &energies.lengths.0 {
            let square = without_motion(square);
            let free = energies.free_lengths.iter().find(|(_, known, _)| *known == square);
            let length = match (names.length(&square), free) {
                (_, Some((free, ..))) => Sum::name(*free),
                (length, None) if is_short(&length) => length,
                _ => {
                    let rest = Symbol::new(class::REST_LENGTH, symbol.place());
                    let label = names.label(*symbol);
                    let value = names.value_of(&square).and_then(|value| value.sqrt());
                    names.set(rest, Label::new(label.word, format!("{},0", label.index)), value);
                    at_rest.named.push((rest, square));
                    Sum::name(rest)
                }
            };
            at_rest.lengths.push((*symbol, length));
        }
        // The powers of a law follow each other, and act together.
        let numbers: Vec<usize> = (0..energies.elements.len()).collect();
        for shares in numbers.chunk_by(|a, b| energies.elements[*a].number == energies.elements[*b].number) {
            at_rest.name_parts(shares, energies, motion, names);
        }
        at_rest
    }

    pub fn of(&self, sum: &Sum) -> Sum {
        let length = |symbol: Symbol| self.lengths.iter().find(|(name, _)| *name == symbol).map(|(_, at)| at.clone());
        without_motion(&sum.replaced(&length))
    }

    fn length(&self, symbol: Symbol) -> Sum {
        self.of(&Sum::name(symbol))
    }

    fn pull(&self, element: &Element) -> Sum {
        if element.is_spring() { element.pull_at(&self.of(&element.stretched())) } else { Sum::ZERO }
    }

    /// The coefficient of an element in the linearised equations.
    pub fn tangent(&self, element: &Element) -> Sum {
        match element.is_linear() {
            true => element.coefficient.clone(),
            false => element.tangent(&self.of(&element.stretched())),
        }
    }

    /// Names for the parts of a line that would be long in an entry.
    fn name_parts(&mut self, shares: &[usize], energies: &Energies, motion: &Motion, names: &mut Names) {
        let (element, others) = (&energies.elements[shares[0]], &shares[1..]);
        let Stretch::Line { length, square, .. } = &element.stretch else { return };
        let none = Lengths::default();
        let Some(inverse) = self.length(*length).inverse() else { return };
        let (mut pull, mut tangent) = (Sum::ZERO, Sum::ZERO);
        for share in shares.iter().map(|share| &energies.elements[*share]) {
            pull = &pull + &self.pull(share);
            tangent = &tangent + &self.tangent(share);
        }
        let density = &pull * &inverse;
        let slope = |symbol: Symbol| square.derivative(symbol, &none).halved();
        let moved: Vec<(Symbol, Sum)> = motion
            .coordinates
            .iter()
            .map(|coordinate| (coordinate.symbols[0], slope(coordinate.symbols[0])))
            .filter(|(_, slope)| !slope.is_zero())
            .collect();
        let levers: Vec<Sum> = moved.iter().map(|(_, slope)| &without_motion(slope) * &inverse).collect();
        let terms = |i: usize, j: usize| {
            let both = &levers[i] * &levers[j];
            let bend = &without_motion(&moved[i].1.derivative(moved[j].0, &none)) - &both;
            (&(&tangent * &both) + &(&density * &bend)).terms().len()
        };
        if (0..moved.len()).all(|i| (i..moved.len()).all(|j| terms(i, j) <= MOST_TERMS)) {
            return;
        }
        if !(others.is_empty() && element.is_linear()) {
            let letter = if element.is_spring() { "k" } else { "c" };
            tangent = self.named_part(tangent, names, names.fresh(letter, element.name.clone()));
        }
        let density = self.named_part(density, names, names.fresh("q", element.name.clone()));
        let is_alone = moved.len() == 1;
        let levers = moved.iter().zip(levers).map(|((symbol, _), lever)| {
            let of = names.label(*symbol).plain();
            let index = if is_alone { element.name.clone() } else { format!("{},{of}", element.name) };
            (*symbol, self.named_part(lever, names, names.fresh("r", index)))
        });
        let levers: BTreeMap<Symbol, Sum> = levers.collect();
        // The first of them stands for all.
        for other in others {
            let (density, tangent) = (Sum::ZERO, Sum::ZERO);
            self.lines.insert(*other, Parts { levers: levers.clone(), density, tangent });
        }
        self.lines.insert(shares[0], Parts { levers, density, tangent });
    }

    /// A form of several terms gets a name.
    fn named_part(&mut self, form: Sum, names: &mut Names, label: Label) -> Sum {
        if form.terms().len() < 2 {
            return form;
        }
        let symbol = Symbol::new(class::LINE, self.parts.len());
        let value = names.value_of(&form);
        names.set(symbol, label, value);
        self.parts.push((symbol, form));
        Sum::name(symbol)
    }

    /// The forces of an equation at rest: what has to vanish there; `None` if none of its lines has parts with names.
    pub fn condition(&self, equation: &Equation, energies: &Energies) -> Option<Sum> {
        if !equation.lines.iter().any(|line| self.lines.contains_key(&line.element)) {
            return None;
        }
        let mut sum = self.of(&(&equation.plain - &equation.forces));
        for line in &equation.lines {
            let force = match self.lines.get(&line.element) {
                Some(parts) => &parts.density * &without_motion(&line.slope),
                None => self.of(&line.force_at_rest(energies)),
            };
            sum = &sum + &force;
        }
        for (multiplier, slope) in &equation.reactions {
            sum = &sum + &(&Sum::name(*multiplier) * &without_motion(slope));
        }
        Some(sum)
    }
}

/// A length that is written out: a number, a name, or a root of few terms without angles.
pub fn is_short(length: &Sum) -> bool {
    let short = |factor: &Factor| match factor {
        Factor::Name(_) | Factor::Pi => true,
        Factor::Root(inside) => inside.terms().len() <= 2,
        _ => false,
    };
    length.terms().len() <= 2
        && length.terms().iter().all(|(product, _)| product.factors().iter().all(|(f, _)| short(f)))
}

/// What a line adds to an entry, its row and column by their displacements: k r_i r_j and q (g_ij - r_i r_j).
pub fn entry(energies: &Energies, line: &Line, [row, column]: [Symbol; 2], at_rest: &AtRest) -> (Sum, Sum) {
    let element = &energies.elements[line.element];
    let tangent = at_rest.tangent(element);
    let none = Lengths::default();
    let (length, square) = match &element.stretch {
        Stretch::Line { length, square, .. } => (length, square),
        Stretch::Plain(stretch) => {
            let own = &without_motion(&line.slope) * &without_motion(&stretch.derivative(column, &none));
            let pull = at_rest.pull(element);
            return (&tangent * &own, &pull * &without_motion(&line.slope.derivative(column, &none)));
        }
    };
    let bend = without_motion(&line.slope.derivative(column, &none));
    if let Some(parts) = at_rest.lines.get(&line.element) {
        let lever = |symbol: Symbol| parts.levers.get(&symbol).cloned().unwrap_or_default();
        let both = &lever(row) * &lever(column);
        return (&parts.tangent * &both, &parts.density * &(&bend - &both));
    }
    let length = at_rest.length(*length);
    let Some(per_square) = length.square().inverse() else { return Default::default() };
    let (own, other) = (without_motion(&line.slope), without_motion(&square.derivative(column, &none).halved()));
    let both = &(&own * &other) * &per_square;
    let elastic = &tangent * &both;
    let pull = at_rest.pull(element);
    if pull.is_zero() {
        return (elastic, Sum::ZERO);
    }
    let geometric = &(&pull * &length.inverse().unwrap_or_default()) * &(&bend - &both);
    (elastic, geometric)
}
