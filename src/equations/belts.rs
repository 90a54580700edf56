//! Belts: the energy of both spans together. In: where the centres are, the radii, and what turns; out: the names that the stretch of a span
//! is written in, and an element for the mean stretch of the spans and one for what they differ by.
//!
//! With d between the centres, g = r1 - r2 (crossed r1 + r2) and sin(beta) = g/d, a span is d cos(beta) long and touches the disks
//! at normals that turn by psi, as the line of centres does, and by -beta or beta. So the spans stretch by e + a and e - a, with
//!
//!   e = d cos(beta) + g beta, less its value as drawn, and a = r1 theta1 - r2 theta2 - g psi (crossed: + r2 theta2),
//!
//! and k (e + a)^2/2 + k (e - a)^2/2 = k e^2 + k a^2. Derivatives: de = cos(beta) dd and d psi = (x dy - y dx)/d^2.

use super::energy::{Element, Energies, Stretch, is_motion};
use super::motion::Motion;
use super::names::{Label, Names, class, without_motion};
use crate::base::{Dimension, Number, Rational};
use crate::model::scene::{self, BeltSpan, Geometry, Part, Scene, SpringRest};
use crate::model::written::{Named, Pair, Written, WrittenElement, class_of, difference, dot};
use crate::symbols::{Dependence, Factor, Function, Lengths, Power, Product, Sum, Symbol};

/// The names of a belt whose centres move against each other.
#[derive(Clone, Debug, Default)]
pub struct Belt {
    pub name: String,
    /// The distance of the centres.
    pub distance: Option<Symbol>,
    /// beta, and its cosine.
    pub slant: Option<[Symbol; 2]>,
    /// The mean stretch of the spans.
    pub mean: Option<Symbol>,
    /// psi.
    pub turn: Option<Turn>,
    /// From centre to centre.
    pub apart: Pair,
    /// g, with its sign in the stretch of the first span.
    pub gap: Sum,
    /// Whether the centres rest as drawn.
    pub rests_as_drawn: bool,
    /// The places of e and a among the elements of the energies, where they are written in these names.
    pub elements: [Option<usize>; 2],
}

/// psi = atan(over/under) - drawn, or the opposite of this.
#[derive(Clone, Debug)]
pub struct Turn {
    pub name: Symbol,
    pub over: Sum,
    pub under: Sum,
    /// atan(over/under) as drawn.
    pub drawn: Sum,
    pub is_opposite: bool,
}

impl Belt {
    pub fn slant_name(&self) -> Option<Symbol> {
        self.slant.map(|[slant, _]| slant)
    }

    pub fn turn_name(&self) -> Option<Symbol> {
        self.turn.as_ref().map(|turn| turn.name)
    }
}

/// Two disks and how they move.
struct Disks {
    radii: [Sum; 2],
    /// From centre to centre.
    apart: Pair,
    drawn: Pair,
    gap: Sum,
    /// The magnitude of g, by its name if it has one.
    size: Sum,
    is_negative: bool,
}

impl Disks {
    /// g by its name.
    fn named_gap(&self) -> Sum {
        if self.is_negative { -&self.size } else { self.size.clone() }
    }
}

/// Differences and sums of radii get names, where spans turn: g_belt = r2 - r1.
pub fn name_gaps(scene: &Scene, written: &mut Written) -> Vec<(Symbol, Label)> {
    let mut made: Vec<(Named, Label)> = Vec::new();
    let names = Names::new(written);
    for (element, _) in scene.elements.iter().zip(&written.elements) {
        let Geometry::Span(span) = &element.law.geometry else { continue };
        let Some([first, second]) = radii(element, span, written) else { continue };
        let gap = &first - &second;
        let Some(value) = names.value_of(&gap) else { continue };
        let (gap, value) = if value.is_negative() { (-&gap, -&value) } else { (gap, value) };
        let is_known = |named: &Named| named.definition.as_ref() == Some(&gap);
        if gap.terms().len() < 2 || written.names.iter().chain(made.iter().map(|(named, _)| named)).any(is_known) {
            continue;
        }
        let label = names.fresh("g", scene.words.display(element.name));
        // Behind every name of the model.
        let symbol = Symbol::new(class_of(Dimension::LENGTH), Symbol::LAST - made.len());
        let (text, definition) = (label.plain(), Some(gap));
        made.push((Named { symbol, text, value, dimension: Dimension::LENGTH, definition, source: None }, label));
    }
    let labels = made.iter().map(|(named, label)| (named.symbol, label.clone())).collect();
    written.names.extend(made.into_iter().map(|(named, _)| named));
    labels
}

impl Energies {
    /// Both spans, of which the first is the element of this number. `None` where a radius or a place has no form.
    pub fn spans_of_belt(
        &mut self,
        scene: &Scene,
        whole: &Written,
        (number, span): (usize, &BeltSpan),
        motion: &Motion,
        names: &mut Names,
    ) -> Option<()> {
        let (element, written) = (scene.elements.get(number)?, whole.elements.get(number)?);
        let name = scene.words.display(element.name);
        let [first, second] = tensions(scene, written, number, &name, names)?;
        let disks = disks(element, span, whole, motion, names)?;
        let moved = difference(&disks.apart, &disks.drawn);
        let rests_as_drawn = moved.iter().all(|part| without_motion(part).is_zero());
        let apart = disks.apart.clone();
        let mut belt = Belt { name: name.clone(), apart, rests_as_drawn, ..Belt::default() };
        let is_rigid = !dot(&disks.apart, &disks.apart).mentions(&is_motion);
        let distance = self.distance(&disks, &mut belt, names);
        let mean = match (is_rigid, disks.gap.is_zero()) {
            (true, _) => Stretch::Plain(Sum::ZERO),
            (false, true) => self.stretch(&element.ends, &written.ends, &Geometry::Line, motion, None, &name, names)?,
            (false, false) => self.mean(&disks, &distance, &mut belt, names),
        };
        let angle = |end: usize| motion.angle(element.ends[end].part).unwrap_or_default();
        let turns = &(&disks.radii[0] * &angle(0)) - &(&disks.radii[1] * &angle(1));
        let centres = match disks.gap.is_zero() {
            true => Sum::ZERO,
            false => self.turn(&disks, &distance, motion, &mut belt, names),
        };
        let half = &turns - &centres;
        let half = Stretch::Plain(if span.left { half } else { -&half });
        belt.gap = if span.left { disks.named_gap() } else { -&disks.named_gap() };
        let free = match &mean {
            Stretch::Line { drawn, .. } => self.named_length(written, drawn.clone(), &name, names),
            Stretch::Plain(_) => Sum::ZERO,
        };
        let is_named = [belt.mean.is_some(), belt.turn.is_some()];
        let both = [(mean, free, &first + &second), (half, Sum::ZERO, &first - &second)];
        for (place, (stretch, free, tension)) in both.into_iter().enumerate() {
            if matches!(&stretch, Stretch::Plain(plain) if plain.is_zero()) {
                continue;
            }
            belt.elements[place] = is_named[place].then_some(self.elements.len());
            let (name, span, order) = (name.clone(), element.span, element.law.kind.order);
            // k e^2 = (2 k) e^2/2
            let coefficient = written.coefficient.scale(&Rational::from(2));
            let power = Power::FIRST;
            self.elements.push(Element { number, name, span, order, coefficient, power, stretch, free, tension });
        }
        self.belts.push(belt);
        Some(())
    }

    /// A name for what depends on coordinates, that of another belt where it is the same.
    fn define(&mut self, label: Label, dependence: Dependence, names: &mut Names) -> Symbol {
        if let Some((known, _)) = self.lengths.0.iter().find(|(_, known)| *known == dependence) {
            return *known;
        }
        let symbol = Symbol::new(class::LENGTH, self.lengths.0.len());
        names.set(symbol, label, None);
        self.lengths.0.push((symbol, dependence));
        self.spans.push(Pair::default());
        symbol
    }

    /// The distance of the centres: a name where it changes, and is needed.
    fn distance(&mut self, disks: &Disks, belt: &mut Belt, names: &mut Names) -> Sum {
        let square = dot(&disks.apart, &disks.apart);
        if disks.gap.is_zero() || !square.mentions(&is_motion) {
            return names.length(&square);
        }
        let label = names.fresh("d", belt.name.clone());
        let symbol = match along_a_line(disks, &square, names) {
            Some(form) => {
                let gradient = vec![(Sum::one(), form.clone())];
                self.define(label, Dependence::Form { form, gradient }, names)
            }
            None => {
                let symbol = self.define(label, Dependence::Root(square), names);
                self.spans[symbol.place()] = disks.apart.clone();
                symbol
            }
        };
        belt.distance = Some(symbol);
        Sum::name(symbol)
    }

    /// e.
    fn mean(&mut self, disks: &Disks, distance: &Sum, belt: &mut Belt, names: &mut Names) -> Stretch {
        let drawn_square = dot(&disks.drawn, &disks.drawn);
        let sine = &disks.size * &distance.inverse().unwrap_or_default();
        let cosine = self.define(Label::new("cos", ""), Dependence::Root(&Sum::one() - &sine.square()), names);
        let label = names.fresh("beta", belt.name.clone());
        let tangent = &sine * &Sum::name(cosine).inverse().unwrap_or_default();
        let per_distance = -&(&tangent * &distance.inverse().unwrap_or_default());
        let dependence =
            Dependence::Form { form: call(Function::Asin, sine), gradient: vec![(per_distance, distance.clone())] };
        let slant = self.define(label, dependence, names);
        names.set_cosine(cosine, slant);
        let (length, drawn) = (names.length(&drawn_square), names.length(&(&drawn_square - &disks.size.square())));
        let wound = call(Function::Asin, &disks.size * &length.inverse().unwrap_or_default());
        let now = &(distance * &Sum::name(cosine)) + &(&disks.size * &Sum::name(slant));
        let form = &(&now - &drawn) - &(&disks.size * &wound);
        let label = names.fresh("e", belt.name.clone());
        let gradient = vec![(Sum::name(cosine), distance.clone())];
        let mean = self.define(label, Dependence::Form { form, gradient }, names);
        (belt.slant, belt.mean) = (Some([slant, cosine]), Some(mean));
        Stretch::Plain(Sum::name(mean))
    }

    /// g psi, with psi the angle by which the line of centres has turned from the drawing: a name where no coordinate says it.
    fn turn(&mut self, disks: &Disks, distance: &Sum, motion: &Motion, belt: &mut Belt, names: &mut Names) -> Sum {
        let [x, y] = &disks.apart;
        let per_square = dot(&disks.apart, &disks.apart).inverse().unwrap_or_default();
        let none = Lengths::default();
        let mut turned = Sum::ZERO;
        let mut is_said = true;
        for coordinate in &motion.coordinates {
            let [dx, dy] = [x, y].map(|part| part.derivative(coordinate.symbols[0], &none));
            let across = &(x * &dy) - &(y * &dx);
            if across.is_zero() {
                continue;
            }
            let slope = (&across * &per_square).simplify();
            is_said &= !slope.mentions(&is_motion);
            turned = &turned + &(&slope * &(&Sum::name(coordinate.symbols[0]) + &coordinate.rest));
        }
        if is_said {
            return &disks.gap * &turned;
        }
        let per_square = distance.square().inverse().unwrap_or_default();
        let gradient = vec![(x * &per_square, y.clone()), (-&(y * &per_square), x.clone())];
        let label = names.fresh("psi", belt.name.clone());
        let drawn = disks.drawn.each_ref().map(|part| size(part, names));
        // Of atan(y/x) and -atan(x/y) the one that has no jump near the drawing.
        let is_opposite = (&drawn[0] - &drawn[1]).is_negative();
        let order = if is_opposite { [0, 1] } else { [1, 0] };
        let angle = |pair: &Pair| {
            let [over, under] = order.map(|place| &pair[place]);
            call(Function::Atan, over * &under.inverse().unwrap_or_default())
        };
        let (now, drawn) = (angle(&disks.apart), angle(&disks.drawn));
        let form = if is_opposite { &drawn - &now } else { &now - &drawn };
        let name = self.define(label, Dependence::Form { form, gradient }, names);
        let [over, under] = order.map(|place| disks.apart[place].clone());
        belt.turn = Some(Turn { name, over, under, drawn, is_opposite });
        &disks.named_gap() * &Sum::name(name)
    }
}

/// The tensions of the spans as drawn.
fn tensions(scene: &Scene, written: &WrittenElement, number: usize, name: &str, names: &mut Names) -> Option<[Sum; 2]> {
    let element = scene.elements.get(number)?;
    Some(match element.law.spring()?.1 {
        SpringRest::Preload(_) => [written.preload.clone()?, written.preload.clone()?],
        SpringRest::AsDrawn if scene.rest_as_drawn.is_some() => {
            let is_other = |(other, known): &(usize, &scene::Element)| *other != number && known.name == element.name;
            let (other, _) = scene.elements.iter().enumerate().find(is_other)?;
            [(number, "left"), (other, "right")].map(|(place, side)| {
                let symbol = Symbol::new(class::TENSION, place);
                names.set(symbol, Label::new("T", format!("{name},{side}")), None);
                Sum::name(symbol)
            })
        }
        _ => [Sum::ZERO, Sum::ZERO],
    })
}

/// The radii, that of the second disk with the sign of its turns.
fn radii(element: &scene::Element, span: &BeltSpan, written: &Written) -> Option<[Sum; 2]> {
    let radius = |part: Part| match part {
        Part::Body(body) => written.bodies.get(body.index())?.radius.clone(),
        _ => None,
    };
    let [first, second] = element.ends.each_ref().map(|end| radius(end.part));
    let (first, second) = (first?, second?);
    Some([first, if span.is_crossed() { -&second } else { second }])
}

fn disks(
    element: &scene::Element,
    span: &BeltSpan,
    written: &Written,
    motion: &Motion,
    names: &Names,
) -> Option<Disks> {
    let parts = element.ends.each_ref().map(|end| end.part);
    let [first, second] = radii(element, span, written)?;
    let drawn = parts.map(|part| written.own_place(part));
    let [a, b] = [0, 1].map(|end| motion.place(parts[end], drawn[end].as_ref()));
    let drawn = difference(drawn[1].as_ref()?, drawn[0].as_ref()?);
    let gap = &first - &second;
    let is_negative = names.value_of(&gap)?.is_negative();
    let size = if is_negative { -&gap } else { gap.clone() };
    let known = written.names.iter().find(|named| named.definition.as_ref() == Some(&size));
    let size = known.map_or(size, |known| Sum::name(known.symbol));
    Some(Disks { radii: [first, second], apart: difference(&b, &a), drawn, gap, size, is_negative })
}

/// The distance of centres that stay on one line, or on one that turns with a part.
fn along_a_line(disks: &Disks, square: &Sum, names: &Names) -> Option<Sum> {
    let moved = difference(&disks.apart, &disks.drawn);
    let across = &(&disks.drawn[0] * &moved[1]) - &(&disks.drawn[1] * &moved[0]);
    if across.is_zero() {
        return Some(dot(&names.unit(&disks.drawn), &disks.apart));
    }
    let root = square.exact_root()?;
    let at_rest = names.value_of(&without_motion(&root))?;
    match (at_rest.may_be_zero(), at_rest.is_negative()) {
        (true, _) => None,
        (false, true) => Some(-&root),
        (false, false) => Some(root),
    }
}

fn size(of: &Sum, names: &Names) -> Number {
    names.value_of(of).map_or(Number::ZERO, |value| value.abs())
}

/// An odd function of a sum.
fn call(function: Function, of: Sum) -> Sum {
    match of.terms() {
        [] => Sum::ZERO,
        terms if terms.iter().all(|(_, number)| number.signum() < 0) => -&call(function, -&of),
        _ => Sum::term(Product::of(Factor::Call(function, [of].into()), 1), Rational::ONE),
    }
}
