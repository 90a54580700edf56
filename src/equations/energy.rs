//! Kinetic energy, potential, dissipation and generalised forces, before anything is linearised. In: the scene's motion; out: sums over
//! coordinates and velocities.
//!
//! - body: m v^2/2 of its centre, I omega^2/2 of its angle; -m g . r for its weight
//! - spring: k (stretch)^2/2 and its tension as drawn times its stretch; the length of a line stays a name with its square beside it
//! - damper: c (rate of stretch)^2/2
//! - belt: k e^2 and k a^2 of the mean stretch e of its spans and half their difference a, see [`belts`](super::belts)
//! - law: an element for each of its powers; k (stretch)^n adds k (stretch)^(n+1)/(n+1), and so does c (rate)^n
//! - force: the work on the displacement of its point; so is an unbalance, whose force has a form of its own

use super::belts::Belt;
use super::lines::is_short;
use super::motion::Motion;
use super::names::{Label, Names, class, without_motion};
use super::unbalance::Unbalance;
use crate::base::{Number, Span, Vec3};
use crate::elements::Order;
use crate::model::scene::{Attachment, BodyId, Geometry, InputKind, Part, Scene, SpringRest};
use crate::model::written::{Pair, Written, WrittenElement, WrittenInput, difference, dot};
use crate::symbols::{Dependence, Lengths, Power, Powers, Sum, Symbol};

/// The stretch of a spring or damper.
#[derive(Clone, Debug, PartialEq)]
pub enum Stretch {
    /// A linear combination of motions, zero as drawn.
    Plain(Sum),
    /// The length of a line, with its square and its length as drawn.
    Line { length: Symbol, square: Sum, drawn: Sum },
}

/// A spring, a damper or an inerter.
#[derive(Clone, Debug)]
pub struct Element {
    /// Its place among the elements of the scene.
    pub number: usize,
    pub name: String,
    pub span: Span,
    /// The derivative of the stretch that its force depends on.
    pub order: Order,
    /// k, c or b.
    pub coefficient: Sum,
    /// The power of that derivative in the force: the first, except in a law.
    pub power: Power,
    pub stretch: Stretch,
    /// The value from which the stretch is measured, so that k times the difference is the tension: the free length of
    /// a line, or the term added to a plain stretch.
    pub free: Sum,
    /// Tension in addition to that.
    pub tension: Sum,
}

/// The energies of a scene.
#[derive(Clone, Debug, Default)]
pub struct Energies {
    pub kinetic: Sum,
    /// Inerters whose energy is part of the kinetic energy; inerters along a line that turns are among `elements`.
    pub inerters: Vec<Element>,
    /// The potential of weights and constant loads, up to a constant.
    pub weights: Sum,
    pub elements: Vec<Element>,
    pub lengths: Lengths,
    /// From end to end of each of `lengths` that is the length of something, in their order.
    pub spans: Vec<Pair>,
    /// Lengths as drawn that have a name, which are the free lengths of springs along a line; each with its square and
    /// its vector.
    pub free_lengths: Vec<(Symbol, Sum, Pair)>,
    pub belts: Vec<Belt>,
    /// For each input that is a force or torque: its name and the displacement that it does work on.
    pub works: Vec<Work>,
    /// The kinetic energy of each body, for messages.
    pub of_bodies: Vec<OfBody>,
}

/// A body's share of the kinetic energy.
#[derive(Clone, Debug)]
pub struct OfBody {
    pub name: String,
    pub span: Span,
    pub kinetic: Sum,
}

/// A force and the displacement on which it does work.
#[derive(Clone, Debug)]
pub struct Work {
    pub input: usize,
    pub force: Symbol,
    pub displacement: Sum,
    /// The force in symbols, for an unbalance.
    pub unbalance: Option<Unbalance>,
}

impl Energies {
    pub fn new(scene: &Scene, whole: &Written, motion: &Motion, names: &mut Names) -> Option<Energies> {
        let mut energies = Energies::default();
        energies.bodies(scene, whole, motion)?;
        for (number, written) in whole.elements.iter().enumerate() {
            match &scene.elements.get(number)?.law.geometry {
                Geometry::Span(span) => energies.spans_of_belt(scene, whole, (number, span), motion, names)?,
                _ => energies.element(scene, written, motion, number, names)?,
            }
        }
        energies.inputs(scene, whole, motion, names)?;
        Some(energies)
    }

    fn bodies(&mut self, scene: &Scene, written: &Written, motion: &Motion) -> Option<()> {
        for index in 0..scene.bodies.len() {
            let (part, body) = (Part::Body(BodyId(index as u32)), written.bodies.get(index)?);
            let mut own = Sum::ZERO;
            if let Some(mass) = &body.mass {
                let place = motion.place(part, body.centre.as_ref());
                let velocity = place.each_ref().map(|part| motion.rate(part, &Lengths::default()));
                own = &own + &(mass * &dot(&velocity, &velocity)).halve();
                if let Some(gravity) = &written.gravity {
                    self.weights = &self.weights - &(mass * &dot(gravity, &place));
                }
            }
            if let (Some(inertia), Some(angle)) = (&body.inertia, motion.angle_coordinate(part)) {
                let rate = Sum::name(motion.coordinates[angle].symbols[1]);
                own = &own + &(inertia * &rate.square()).halve();
            }
            self.kinetic = &self.kinetic + &own;
            let (name, span) = (scene.words.display(scene.bodies[index].name), scene.bodies[index].span);
            self.of_bodies.push(OfBody { name, span, kinetic: own });
        }
        self.weights = without_constants(&self.weights);
        Some(())
    }

    fn element(
        &mut self,
        scene: &Scene,
        written: &WrittenElement,
        motion: &Motion,
        number: usize,
        names: &mut Names,
    ) -> Option<()> {
        let element = scene.elements.get(number)?;
        let name = scene.words.display(element.name);
        let stretch = self.stretch(
            &element.ends,
            &written.ends,
            &element.law.geometry,
            motion,
            written.along.as_ref(),
            &name,
            names,
        )?;
        let (mut free, mut tension) = (Sum::ZERO, Sum::ZERO);
        if let Stretch::Line { drawn, .. } = &stretch {
            free = drawn.clone();
        }
        if let Some((_, rest)) = element.law.spring() {
            match rest {
                SpringRest::FreeLength(_) => {
                    let given = written.free_length.clone()?;
                    free = match (&stretch, &element.law.geometry) {
                        (Stretch::Line { .. }, _) => given,
                        (Stretch::Plain(_), Geometry::Torsion) => given,
                        // The length as drawn along its direction is part of the stretch.
                        (Stretch::Plain(_), _) => &given - &drawn_length(written, &element.law.geometry, names)?,
                    };
                }
                SpringRest::Preload(_) => {
                    tension = written.preload.clone()?;
                    free = self.named_length(written, free, &name, names);
                }
                SpringRest::AsDrawn if scene.rest_as_drawn.is_some() => {
                    let symbol = Symbol::new(class::TENSION, number);
                    names.set(symbol, Label::new("T", name.clone()), None);
                    tension = Sum::name(symbol);
                    free = self.named_length(written, free, &name, names);
                }
                SpringRest::AsDrawn => free = self.named_length(written, free, &name, names),
            }
        }
        let idle = matches!(&stretch, Stretch::Plain(plain) if plain.is_zero());
        if idle {
            return Some(());
        }
        let (span, order) = (element.span, element.law.kind.order);
        let coefficient = written.coefficient.clone();
        let element = Element { number, name, span, order, coefficient, power: Power::FIRST, stretch, free, tension };
        match (order, &element.stretch, &written.law) {
            (.., Some(law)) => self.law(law, element),
            (Order::Acceleration, Stretch::Plain(_), _) => self.inerter(element, motion),
            _ => self.elements.push(element),
        }
        Some(())
    }

    /// A law: its linear part, which its constant part is a tension of, and its other powers.
    fn law(&mut self, law: &Powers, element: Element) {
        let (coefficient, tension) = (law.coefficient(Power::FIRST), law.coefficient(Power::ZEROTH));
        let others = law.terms().filter(|(power, _)| ![Power::ZEROTH, Power::FIRST].contains(power));
        let others = others.map(|(power, coefficient)| Element {
            coefficient: coefficient.clone(),
            power,
            tension: Sum::ZERO,
            ..element.clone()
        });
        let others: Vec<Element> = others.collect();
        if others.is_empty() || !(coefficient.is_zero() && tension.is_zero()) {
            self.elements.push(Element { coefficient, tension, ..element });
        }
        self.elements.extend(others);
    }

    /// A length as drawn that is long to write gets a name.
    pub fn named_length(&mut self, written: &WrittenElement, length: Sum, name: &str, names: &mut Names) -> Sum {
        let [Some(a), Some(b)] = &written.ends else { return length };
        if is_short(&length) {
            return length;
        }
        let drawn = difference(b, a);
        let square = dot(&drawn, &drawn);
        if let Some((known, ..)) = self.free_lengths.iter().find(|(_, known, _)| *known == square) {
            return Sum::name(*known);
        }
        let symbol = Symbol::new(class::FREE_LENGTH, self.free_lengths.len());
        let value = names.value_of(&length);
        names.set(symbol, names.fresh("l", format!("{name},free")), value);
        self.free_lengths.push((symbol, square, drawn));
        Sum::name(symbol)
    }

    /// b (de/dt)^2 / 2.
    fn inerter(&mut self, element: Element, motion: &Motion) {
        self.kinetic = &self.kinetic + &element.rate_energy(motion);
        self.inerters.push(element);
    }

    #[allow(clippy::too_many_arguments)]
    pub fn stretch(
        &mut self,
        ends: &[Attachment; 2],
        places: &[Option<Pair>; 2],
        geometry: &Geometry,
        motion: &Motion,
        along: Option<&Pair>,
        name: &str,
        names: &mut Names,
    ) -> Option<Stretch> {
        if *geometry == Geometry::Torsion {
            let angle = |end: usize| motion.angle(ends[end].part).unwrap_or_default();
            return Some(Stretch::Plain(&angle(1) - &angle(0)));
        }
        let [a, b] = [0, 1].map(|end| motion.place(ends[end].part, places[end].as_ref()));
        let apart = difference(&b, &a);
        let drawn = match (&places[0], &places[1]) {
            (Some(first), Some(second)) => Some(difference(second, first)),
            _ => None,
        };
        if let Geometry::Along(direction) = geometry {
            let direction = match along {
                Some(along) => along.clone(),
                None => exact_pair(direction)?,
            };
            let mut direction = names.unit(&direction);
            let against = drawn.as_ref().and_then(|drawn| names.value_of(&dot(drawn, &direction)));
            if against.is_some_and(|value| value.is_negative()) {
                direction = direction.map(|part| -&part);
            }
            let displaced = dot(&direction, &apart);
            // Places as drawn are no motion.
            let still = drawn_part(&displaced, motion);
            return Some(Stretch::Plain(&displaced - &still));
        }
        let drawn = drawn?;
        let moved = difference(&apart, &drawn);
        let across = &(&drawn[0] * &moved[1]) - &(&drawn[1] * &moved[0]);
        if across.is_zero() {
            return Some(Stretch::Plain(dot(&names.unit(&drawn), &moved)));
        }
        let square = dot(&apart, &apart);
        // A bead on a rod: its distance from the pivot is the square root of a square, whatever the angle.
        if let Some(root) = square.exact_root() {
            let at_rest = names.value_of(&without_motion(&root));
            let root = if at_rest.as_ref().is_some_and(|value| value.is_negative()) { -&root } else { root };
            if at_rest.is_some_and(|value| !value.may_be_zero()) {
                return Some(Stretch::Plain(&root - &names.length(&dot(&drawn, &drawn))));
            }
        }
        let known = self.lengths.roots().find(|(_, known)| **known == square).map(|(length, _)| length);
        let length = known.unwrap_or_else(|| {
            let length = Symbol::new(class::LENGTH, self.lengths.0.len());
            names.set(length, names.fresh("l", name.to_string()), None);
            self.lengths.0.push((length, Dependence::Root(square.clone())));
            self.spans.push(apart.clone());
            length
        });
        Some(Stretch::Line { length, square, drawn: names.length(&dot(&drawn, &drawn)) })
    }

    fn inputs(&mut self, scene: &Scene, whole: &Written, motion: &Motion, names: &mut Names) -> Option<()> {
        for (number, (input, written)) in scene.inputs.iter().zip(&whole.inputs).enumerate() {
            let name = scene.words.display(input.name);
            let displacement = match &input.kind {
                InputKind::Force { ends, direction } => {
                    let direction = match &written.along {
                        Some(along) => along.clone(),
                        None => exact_pair(direction)?,
                    };
                    let direction = names.unit(&direction);
                    let mut work = Sum::ZERO;
                    for (place, end) in ends.iter().enumerate() {
                        // Along a common line the ends are kept in the order in which they are pushed.
                        let at = written_place(written, ends.len(), place);
                        let place_of = dot(&direction, &motion.place(end.part, at.as_ref()));
                        work = if place == 0 { &work + &place_of } else { &work - &place_of };
                    }
                    without_constants(&work)
                }
                InputKind::ForceBetween { ends } => {
                    let places = [written.ends.first()?.clone(), written.ends.get(1)?.clone()];
                    match self.stretch(ends, &places, &Geometry::Line, motion, None, &name, names)? {
                        Stretch::Plain(stretch) => stretch,
                        Stretch::Line { length, .. } => Sum::name(length),
                    }
                }
                InputKind::Torque { ends } => {
                    let angle = |end: &Attachment| motion.angle(end.part).unwrap_or_default();
                    match &ends[..] {
                        [one] => angle(one),
                        [one, other, ..] => &angle(one) - &angle(other),
                        [] => Sum::ZERO,
                    }
                }
                InputKind::Unbalance { end: [end], .. } => {
                    let place = motion.place(end.part, written.ends.first()?.as_ref());
                    without_constants(&dot(written.along.as_ref()?, &place))
                }
                InputKind::Base { .. } => continue,
            };
            if !written.constant.is_zero() {
                self.weights = &self.weights - &(&written.constant * &displacement);
            }
            let force = Symbol::new(class::FORCE, number);
            names.set(force, Label::new(name, ""), None);
            let unbalance = Unbalance::new(scene, whole, number, names);
            self.works.push(Work { input: number, force, displacement, unbalance });
        }
        self.weights = without_constants(&self.weights);
        Some(())
    }

    /// A sum with the forces of unbalances written out.
    pub fn with_forces(&self, sum: &Sum) -> Sum {
        sum.replace(&|symbol| {
            let work = self.works.iter().find(|work| work.force == symbol)?;
            work.unbalance.as_ref().map(|unbalance| unbalance.force.clone())
        })
    }

    /// The elements that an element of the scene became, by its place there: none if nothing stretches it, several for a law or a belt.
    pub fn elements_of(&self, number: usize) -> impl Iterator<Item = &Element> {
        self.elements.iter().chain(&self.inerters).filter(move |known| known.number == number)
    }
}

impl Stretch {
    /// The stretch up to a constant.
    pub fn sum(&self) -> Sum {
        match self {
            Stretch::Plain(sum) => sum.clone(),
            Stretch::Line { length, .. } => Sum::name(*length),
        }
    }
}

impl Element {
    /// Half the coefficient times the square of the rate of stretch: the energy of an inerter, half the power of a damper.
    pub fn rate_energy(&self, motion: &Motion) -> Sum {
        let rate = match &self.stretch {
            Stretch::Plain(stretch) => motion.rate(stretch, &Lengths::default()),
            Stretch::Line { length, square, .. } => {
                let inverse = Sum::name(*length).inverse().unwrap_or_default();
                &motion.rate(square, &Lengths::default()).halve() * &inverse
            }
        };
        (&self.coefficient * &rate.square()).halve()
    }

    pub fn is_spring(&self) -> bool {
        self.order == Order::Displacement
    }

    /// e - e_free, which the force of a spring is a power of.
    pub fn elongation(&self) -> Sum {
        &self.stretch.sum() - &self.free
    }

    /// k (e - e_free)^n + T.
    pub fn pull(&self) -> Sum {
        self.pull_at(&self.elongation())
    }

    /// The tension of a spring that is stretched so far.
    pub fn pull_at(&self, stretched: &Sum) -> Sum {
        &(&self.coefficient * &self.power.of(stretched)) + &self.tension
    }

    /// The coefficient of the linearised equations, at rest: n k (e - e_free)^(n-1) of a spring.
    pub fn tangent(&self, stretched_at_rest: &Sum) -> Sum {
        let at = if self.is_spring() { stretched_at_rest } else { &Sum::ZERO };
        &self.coefficient * &self.power.slope(at)
    }

    /// Whether its force is proportional to the stretch, or to the derivative that it depends on.
    pub fn is_linear(&self) -> bool {
        self.power == Power::FIRST
    }
}

/// The length as drawn, along the direction of the element.
fn drawn_length(written: &WrittenElement, geometry: &Geometry, names: &Names) -> Option<Sum> {
    let drawn = difference(written.ends[1].as_ref()?, written.ends[0].as_ref()?);
    let along = match (geometry, &written.along) {
        (Geometry::Along(_), Some(along)) => names.unit(along),
        (Geometry::Along(direction), None) => names.unit(&exact_pair(direction)?),
        _ => return Some(names.length(&dot(&drawn, &drawn))),
    };
    let length = dot(&drawn, &along);
    Some(if names.value_of(&length).is_some_and(|value| value.is_negative()) { -&length } else { length })
}

/// The written position of an end of a force.
fn written_place(written: &WrittenInput, ends: usize, place: usize) -> Option<Pair> {
    // `force F: a -- b` without a direction keeps its second end first.
    let swapped = ends == 2 && written.along.is_none();
    written.ends.get(if swapped { 1 - place } else { place }).cloned().flatten()
}

/// A direction without a name in it.
fn exact_pair(direction: &Vec3) -> Option<Pair> {
    let part = |number: &Number| number.exact().map(|exact| Sum::number(exact.clone()));
    Some([part(&direction.x)?, part(&direction.y)?])
}

/// The energy without constant terms, which do no work.
pub fn without_constants(energy: &Sum) -> Sum {
    let moves = |symbol: Symbol| is_motion(symbol);
    Sum::of_terms(energy.terms().iter().filter(|(product, _)| product.mentions(&moves)).cloned().collect())
}

/// Whether a name is a coordinate, a prescribed motion, one of their derivatives, or a length that depends on them.
pub fn is_motion(symbol: Symbol) -> bool {
    (class::COORDINATE..=class::PRESCRIBED_ACCELERATION).contains(&symbol.class()) || symbol.class() == class::LENGTH
}

/// The part of a displaced place that is there with every coordinate as drawn.
fn drawn_part(place: &Sum, motion: &Motion) -> Sum {
    place.replace(&|symbol| {
        let coordinate = motion.coordinates.iter().find(|coordinate| coordinate.symbols[0] == symbol)?;
        Some(-&coordinate.rest)
    })
}
