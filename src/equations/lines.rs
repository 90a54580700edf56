//! Springs, dampers and inerters at rest: their contributions to the entries of the linearised equations.
//!
//! A spring along a line pulls with P = k (l - l_0) + T; with g = (l^2)'/2 at rest it adds k g_i g_j/l^2 + P/l (g_ij - g_i g_j/l^2).
//! Where that is long, the lever arms r_i = g_i/l and the tension by length q = P/l get names, and it adds k r_i r_j + q (g_ij - r_i r_j).
//! With the distance d of a belt's centres, r_i = d_i and w_i = -g psi_i, its spans add 2 k cos(beta)^2 r_i r_j + q (g_ij - r_i r_j) + q tan(beta)^2 r_i r_j,
//! q = P cos(beta)/d of the tension P of both, and 2 k w_i w_j - n (w_i r_j + w_j r_i),
//! n = S/d of the difference S of their tensions.

use super::belts::Belt;
use super::energy::{Element, Energies, Stretch};
use super::lagrange::{Equation, Line};
use super::motion::Motion;
use super::names::{Label, Names, class, without_motion};
use crate::base::Rational;
use crate::symbols::{Dependence, Factor, Function, Lengths, Product, Sum, Symbol};
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
    /// Named parts, by the index of the element in the energies.
    lines: BTreeMap<usize, Parts>,
    belts: Vec<Spans>,
}

/// A belt at rest.
struct Spans {
    belt: Belt,
    /// d_i, and w_i = -g psi_i, by the displacement of the coordinate.
    levers: BTreeMap<Symbol, Sum>,
    turns: BTreeMap<Symbol, Sum>,
    /// q = P cos(beta)/d, and q tan(beta)^2.
    density: Sum,
    along: Sum,
    /// S, the tension of the first span less that of the second, and n = S/d.
    difference: Sum,
    twist: Sum,
}

/// The named parts of a line whose contributions are long.
struct Parts {
    /// The lever arms, by the displacement of the coordinate.
    levers: BTreeMap<Symbol, Sum>,
    /// The tension by length; zero for an element that is not a spring.
    density: Sum,
    /// k, or the tangent of a law.
    tangent: Sum,
}

impl AtRest {
    pub fn new(motion: &Motion, energies: &Energies, names: &mut Names) -> AtRest {
        let (lines, belts) = Default::default();
        let mut at_rest = AtRest { lengths: Vec::new(), named: Vec::new(), parts: Vec::new(), lines, belts };
        for (symbol, dependence) in &energies.lengths.0 {
            let square = match dependence {
                Dependence::Root(square) => at_rest.of(square),
                Dependence::Form { form, .. } => {
                    let form = at_rest.form(*symbol, form, energies, names);
                    at_rest.lengths.push((*symbol, form));
                    continue;
                }
            };
            let free = energies.free_lengths.iter().find(|(_, known, _)| *known == square);
            // Cosines of angles that are named are written so.
            let is_cosine = names.angle_of_cosine(*symbol).is_some();
            let is_written = |length: &Sum| is_short(length) && !(is_cosine && length.mentions(&|_| true));
            let length = match (names.length(&square), free) {
                (_, Some((free, ..))) => Sum::name(*free),
                (length, None) if is_written(&length) => length,
                _ => {
                    let rest = Symbol::new(class::REST_LENGTH, symbol.place());
                    let label = names.label(*symbol);
                    let value = names.value_of(&square).and_then(|value| value.sqrt());
                    names.set(rest, Label::new(label.word, format!("{},0", label.index)), value);
                    match names.angle_of_cosine(*symbol) {
                        Some(angle) => names.set_cosine(rest, Symbol::new(class::REST_LENGTH, angle.place())),
                        None => at_rest.named.push((rest, square)),
                    }
                    Sum::name(rest)
                }
            };
            at_rest.lengths.push((*symbol, length));
        }
        // The powers of a law follow each other, and act together.
        let numbers: Vec<usize> = (0..energies.elements.len()).collect();
        let is_shared = |a: &usize, b: &usize| {
            let [a, b] = [a, b].map(|number| &energies.elements[*number]);
            a.number == b.number && a.stretch == b.stretch
        };
        for shares in numbers.chunk_by(is_shared) {
            at_rest.name_parts(shares, energies, motion, names);
        }
        energies.belts.iter().for_each(|belt| at_rest.name_spans(belt, energies, motion, names));
        at_rest
    }

    /// A form at rest: nothing of an angle or a stretch that is counted from the drawing if the centres rest as drawn, a name if it is long.
    fn form(&mut self, symbol: Symbol, form: &Sum, energies: &Energies, names: &mut Names) -> Sum {
        let is = |own: Option<Symbol>| own == Some(symbol);
        let own = energies.belts.iter().find(|belt| is(belt.mean) || is(belt.turn_name()) || is(belt.slant_name()));
        let Some(belt) = own else { return self.named_form(symbol, self.of(form), names, true) };
        if belt.rests_as_drawn && !is(belt.slant_name()) {
            return Sum::ZERO;
        }
        let is_shown = match belt.slant {
            // Its cosine stands for it, unless that is written out.
            Some([slant, cosine]) if slant == symbol && belt.rests_as_drawn => self
                .length(cosine)
                .mentions(&|symbol| symbol.class() == class::REST_LENGTH && symbol.place() == cosine.place()),
            _ => true,
        };
        self.named_form(symbol, self.of(form), names, is_shown)
    }

    fn named_form(&mut self, symbol: Symbol, form: Sum, names: &mut Names, is_shown: bool) -> Sum {
        let is_single = form.terms().len() < 2;
        if is_single && is_short(&form) {
            return form;
        }
        let rest = Symbol::new(class::REST_LENGTH, symbol.place());
        let (label, value) = (names.label(symbol), names.value_of(&form));
        names.set(rest, Label::new(label.word, format!("{},0", label.index)), value);
        if is_shown {
            self.parts.push((rest, form));
        }
        Sum::name(rest)
    }

    /// Names for what the spans of a belt add.
    fn name_spans(&mut self, belt: &Belt, energies: &Energies, motion: &Motion, names: &mut Names) {
        let lengths = &energies.lengths;
        let symbols: Vec<Symbol> = motion.coordinates.iter().map(|coordinate| coordinate.symbols[0]).collect();
        let mut slopes = |of: Option<Symbol>, letter: &str, factor: &Sum| -> BTreeMap<Symbol, Sum> {
            let Some(of) = of else { return BTreeMap::new() };
            let slope = |symbol: &Symbol| (*symbol, self.of(&(factor * &Sum::name(of).derivative(*symbol, lengths))));
            let slopes: Vec<(Symbol, Sum)> = symbols.iter().map(slope).filter(|(_, slope)| !slope.is_zero()).collect();
            let is_alone = slopes.iter().filter(|(_, slope)| slope.terms().len() > 1).count() == 1;
            let named = slopes.into_iter().map(|(symbol, slope)| {
                let of = names.label(symbol).plain();
                let index = if is_alone { belt.name.clone() } else { format!("{},{of}", belt.name) };
                (symbol, self.named_part(slope, names, names.fresh(letter, index)))
            });
            named.collect()
        };
        let levers = slopes(belt.distance, "r", &Sum::one());
        let turns = slopes(belt.turn_name(), "w", &-&belt.gap);
        let pull = |element: Option<usize>| element.map_or(Sum::ZERO, |number| self.pull(&energies.elements[number]));
        let [pull, difference] = belt.elements.map(pull);
        let (mut density, mut along) = (Sum::ZERO, Sum::ZERO);
        if let (false, Some([slant, cosine]), Some(distance)) = (pull.is_zero(), belt.slant, belt.distance) {
            let cosine = self.length(cosine);
            let form = &(&pull * &cosine) * &self.length(distance).inverse().unwrap_or_default();
            density = self.part(form, names, names.fresh("q", belt.name.clone()));
            let squared = &cosine.square().inverse().unwrap_or_default() - &Sum::one();
            along = match squared.as_number() {
                Some(_) => &density * &squared,
                None => &density * &tangent(&self.length(slant)).square(),
            };
        }
        let difference = self.named_part(difference, names, names.fresh("S", belt.name.clone()));
        let per_distance = belt.distance.and_then(|distance| self.length(distance).inverse()).unwrap_or_default();
        let mut twist = &difference * &per_distance;
        if twist.mentions(&|symbol| symbol.class() == class::REST_LENGTH) {
            twist = self.part(twist, names, names.fresh("n", belt.name.clone()));
        }
        self.belts.push(Spans { belt: belt.clone(), levers, turns, density, along, difference, twist });
    }

    /// The belt whose stretch an element is, and whether that is their mean.
    fn spans(&self, element: usize) -> Option<(&Spans, bool)> {
        let found = self.belts.iter().find(|spans| spans.belt.elements.contains(&Some(element)))?;
        Some((found, found.belt.elements[0] == Some(element)))
    }

    /// The contribution of a belt's element to an entry.
    fn entry_of_spans(
        &self,
        energies: &Energies,
        line: &Line,
        [row, column]: [Symbol; 2],
        tangent: &Sum,
    ) -> Option<(Sum, Sum)> {
        let (spans, is_mean) = self.spans(line.element)?;
        let by = |slopes: &BTreeMap<Symbol, Sum>, symbol: Symbol| slopes.get(&symbol).cloned().unwrap_or_default();
        let both = &by(&spans.levers, row) * &by(&spans.levers, column);
        if is_mean {
            let cosine = self.length(spans.belt.slant?[1]);
            let own = &(tangent * &cosine.square()) * &both;
            let half_square = Sum::name(spans.belt.distance?).square().halve();
            let second = half_square.derivative(row, &energies.lengths).derivative(column, &energies.lengths);
            let across = &spans.density * &(&self.of(&second) - &both);
            return Some((own, &across + &(&spans.along * &both)));
        }
        let stretch = energies.elements[line.element].stretch.sum();
        let lever = |symbol: Symbol| {
            let of_disks = stretch.derivative(symbol, &Lengths::default());
            &without_motion(&of_disks) + &by(&spans.turns, symbol)
        };
        let own = tangent * &(&lever(row) * &lever(column));
        if spans.difference.is_zero() {
            return Some((own, Sum::ZERO));
        }
        // -S g (x y_ij - y x_ij)/d^2 - n (w_i d_j + w_j d_i)
        let [x, y] = &spans.belt.apart;
        let none = Lengths::default();
        let second = |part: &Sum| part.derivative(row, &none).derivative(column, &none);
        let bent = without_motion(&(&(x * &second(y)) - &(y * &second(x))));
        let per_distance =
            spans.belt.distance.map_or(Sum::ZERO, |distance| self.length(distance).inverse().unwrap_or_default());
        let crossed = &(&by(&spans.turns, row) * &by(&spans.levers, column))
            + &(&by(&spans.turns, column) * &by(&spans.levers, row));
        let bend = &(&(&spans.belt.gap * &bent) * &per_distance) * &spans.twist;
        Some((own, -&(&bend + &(&crossed * &spans.twist))))
    }

    /// The force of an element of a belt on a coordinate at rest.
    fn force_of_spans(&self, energies: &Energies, element: usize, row: Symbol) -> Option<Sum> {
        let (spans, is_mean) = self.spans(element)?;
        if is_mean {
            let half_square = Sum::name(spans.belt.distance?).square().halve();
            return Some(&spans.density * &self.of(&half_square.derivative(row, &energies.lengths)));
        }
        let of_disks = energies.elements[element].stretch.sum().derivative(row, &Lengths::default());
        let turn = spans.turns.get(&row).cloned().unwrap_or_default();
        Some(&spans.difference * &(&without_motion(&of_disks) + &turn))
    }

    pub fn of(&self, sum: &Sum) -> Sum {
        let length = |symbol: Symbol| self.lengths.iter().find(|(name, _)| *name == symbol).map(|(_, at)| at.clone());
        without_motion(&sum.replace(&length))
    }

    fn length(&self, symbol: Symbol) -> Sum {
        self.of(&Sum::name(symbol))
    }

    fn pull(&self, element: &Element) -> Sum {
        if element.is_spring() { element.pull_at(&self.of(&element.elongation())) } else { Sum::ZERO }
    }

    /// The coefficient of an element in the linearised equations.
    pub fn tangent(&self, element: &Element) -> Sum {
        match element.is_linear() {
            true => element.coefficient.clone(),
            false => element.tangent(&self.of(&element.elongation())),
        }
    }

    /// Names the parts of a line that would be long in an entry.
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
        let slope = |symbol: Symbol| square.derivative(symbol, &none).halve();
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
        // The first of them represents all of them.
        for other in others {
            let (density, tangent) = (Sum::ZERO, Sum::ZERO);
            self.lines.insert(*other, Parts { levers: levers.clone(), density, tangent });
        }
        self.lines.insert(shares[0], Parts { levers, density, tangent });
    }

    /// A form of several terms gets a name.
    fn named_part(&mut self, form: Sum, names: &mut Names, label: Label) -> Sum {
        if form.terms().len() < 2 { form } else { self.part(form, names, label) }
    }

    /// A name for a form.
    fn part(&mut self, form: Sum, names: &mut Names, label: Label) -> Sum {
        let symbol = Symbol::new(class::LINE, self.parts.len());
        let value = names.value_of(&form);
        names.set(symbol, label, value);
        self.parts.push((symbol, form));
        Sum::name(symbol)
    }

    /// The forces of an equation at rest: what has to vanish there; `None` if none of its lines has parts with names.
    pub fn condition(&self, equation: &Equation, motion: &Motion, energies: &Energies) -> Option<Sum> {
        let is_named = |line: &Line| {
            let belt = energies.belts.iter().find(|belt| belt.elements.contains(&Some(line.element)));
            // A belt that rests as drawn has short forces.
            self.lines.contains_key(&line.element) || belt.is_some_and(|belt| !belt.rests_as_drawn)
        };
        if !equation.lines.iter().any(is_named) {
            return None;
        }
        let mut sum = self.of(&(&equation.plain - &equation.forces));
        let row = motion.coordinates[equation.coordinate].symbols[0];
        for line in &equation.lines {
            let force = match self.lines.get(&line.element) {
                Some(parts) => &parts.density * &without_motion(&line.slope),
                None => {
                    let of_spans = self.force_of_spans(energies, line.element, row);
                    of_spans.unwrap_or_else(|| self.of(&line.force_at_rest(energies)))
                }
            };
            sum = &sum + &force;
        }
        for (multiplier, slope) in &equation.reactions {
            sum = &sum + &(&Sum::name(*multiplier) * &without_motion(slope));
        }
        Some(sum)
    }
}

/// The tangent of an angle.
fn tangent(of: &Sum) -> Sum {
    Sum::term(Product::of(Factor::Call(Function::Tan, [of.clone()].into()), 1), Rational::ONE)
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

/// The contribution of a line to an entry, whose row and column are given by their displacements: k r_i r_j and
/// q (g_ij - r_i r_j).
pub fn entry(energies: &Energies, line: &Line, [row, column]: [Symbol; 2], at_rest: &AtRest) -> (Sum, Sum) {
    let element = &energies.elements[line.element];
    let tangent = at_rest.tangent(element);
    if let Some(both) = at_rest.entry_of_spans(energies, line, [row, column], &tangent) {
        return both;
    }
    let none = Lengths::default();
    let (length, square) = match &element.stretch {
        Stretch::Line { length, square, .. } => (length, square),
        Stretch::Plain(stretch) => {
            let lengths = &energies.lengths;
            let own = &at_rest.of(&line.slope) * &at_rest.of(&stretch.derivative(column, lengths));
            let pull = at_rest.pull(element);
            return (&tangent * &own, &pull * &at_rest.of(&line.slope.derivative(column, lengths)));
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
    let (own, other) = (without_motion(&line.slope), without_motion(&square.derivative(column, &none).halve()));
    let both = &(&own * &other) * &per_square;
    let elastic = &tangent * &both;
    let pull = at_rest.pull(element);
    if pull.is_zero() {
        return (elastic, Sum::ZERO);
    }
    let geometric = &(&pull * &length.inverse().unwrap_or_default()) * &(&bend - &both);
    (elastic, geometric)
}
