//! Equations of motion in the model's own symbols: from the checked scene, by the energies. Clause: docs/equations.md.
//!
//! # Steps
//! 1. [`motion`]: where every point is, by an independent joint tree
//! 2. [`energy`], [`belts`], [`constraint`]: kinetic energy, potential, dissipation, forces, constraint equations
//! 3. [`lagrange`]: the equations of motion, nothing approximated
//! 4. [`rest`]: what the rest has to fulfil, and its closed form where there is one
//! 5. [`loops`]: the same without multipliers, over the independent coordinates
//! 6. [`linear`], [`lines`], [`reduce`]: the linearised equations, entry by entry
//! 7. [`closed`], [`transfer`]: natural frequencies, poles, outputs and transfer functions
//! 8. [`verify`]: each of them against the lowered system, the equations of motion against derivatives of the energies
//!
//! Nothing is taken from the lowering but the values of rest and which coordinates are independent; what is found is compared with it.

pub mod belts;
mod carried;
pub mod closed;
pub mod constraint;
pub mod coordinate;
pub mod elimination;
pub mod energy;
pub mod error;
pub mod lagrange;
pub mod linear;
pub mod lines;
pub mod loops;
pub mod motion;
pub mod names;
pub mod polynomial;
pub mod reduce;
pub mod rest;
pub mod transfer;
pub mod unbalance;
pub mod verify;
mod zeros;

use crate::base::{Dimension, Number, Rational, Span};
use crate::elements::Order;
use crate::lower::Lowered;
use crate::model::scene::{Damping, Geometry, Scene};
use crate::model::written::{Named, Written, class_of};
use crate::symbols::{Powers, Sum, Symbol};
use constraint::Constraint;
use coordinate::Coordinate;
use energy::Energies;
pub use error::EquationsError;
use lagrange::Equation;
use linear::Column;
use lines::AtRest;
use motion::Motion;
use names::{Label, Names, class};
use rest::Rest;

/// The equations of a scene.
#[derive(Clone, Debug)]
pub struct Equations {
    pub model: String,
    pub names: Names,
    pub motion: Motion,
    pub energies: Energies,
    pub constraints: Vec<Constraint>,
    pub nonlinear: Vec<Equation>,
    /// The equations without multipliers, if there are constraints; or the reason why there are none.
    pub reduced: Option<Result<loops::Reduced, loops::Kept>>,
    pub rest: Rest,
    pub linear: Linearised,
    /// Names of the inputs and outputs of the scene.
    pub inputs: Vec<String>,
    pub outputs: Vec<transfer::Output>,
    /// The names of outputs of what joints, couplings and rails carry, which these equations do not contain.
    pub carried: Vec<String>,
    /// Natural frequencies and poles, and transfer functions.
    pub parts: Vec<closed::Part>,
    pub transfers: Vec<transfer::Transfer>,
    /// alpha and beta of Rayleigh damping.
    pub rayleigh: Option<(Sum, Sum)>,
    /// The ratio of modal damping, which has no symbols.
    pub modal_damping: Option<Number>,
    /// The description of each coordinate: its body.
    pub bodies: Vec<String>,
}

/// The linearised equations over the independent coordinates, with values.
#[derive(Clone, Debug)]
pub struct Linearised {
    /// The indices of the motion's coordinates, in the order of the lowered system.
    pub coordinates: Vec<usize>,
    pub mass: Vec<Vec<Entry>>,
    pub damping: Vec<Vec<Entry>>,
    pub stiffness: Vec<Vec<Entry>>,
    pub inputs: Vec<Column>,
    /// Where damping acts relative to bases: what follows each input statically.
    pub carried: Vec<(usize, Vec<Sum>)>,
    /// The dependent coordinates in terms of the independent ones and the prescribed motions, to first order.
    pub dependent: Vec<(usize, Sum)>,
    /// Velocity ratios that have a name, each with its value in symbols.
    pub ratios: Vec<(Symbol, Sum)>,
    /// Lengths at rest that have a name, each with its square.
    pub lengths: Vec<(Symbol, Sum)>,
    /// Lever arms and tensions by length at rest that have a name.
    pub parts: Vec<(Symbol, Sum)>,
}

/// An entry of a matrix, with an enclosure of its value.
#[derive(Clone, Debug)]
pub struct Entry {
    pub sum: Sum,
    pub value: Number,
}

/// Coordinates that are written out in symbols at most, and products that kinetic energy is summed from.
pub const MOST_COORDINATES: usize = 200;
pub const MOST_PRODUCTS: usize = 60_000;

/// The quantities derived in one pass over the scene.
struct Derived {
    motion: Motion,
    energies: Energies,
    constraints: Vec<Constraint>,
    equations: Vec<Equation>,
}

/// The equations of a checked scene, compared with its lowering.
pub fn derive(scene: &Scene, written: &Written, lowered: &Lowered) -> Result<Equations, EquationsError> {
    refuse_large(scene, lowered)?;
    let mut written = written.clone();
    name_gravity(&mut written);
    name_quotients(scene, &mut written);
    let mut made = unbalance::name_speeds(scene, &mut written);
    made.extend(belts::name_gaps(scene, &mut written));
    let mut names = Names::new(&written);
    made.into_iter().for_each(|(symbol, label)| names.set(symbol, label, None));
    let numbers = rest::numbers(lowered);
    let mut derived = derive_equations(scene, &written, &mut names, &|names, coordinate, index| {
        rest::symbol(names, coordinate, index, &numbers)
    })?;
    let mut rest = Rest::new(&derived.motion, &derived.energies, &derived.equations, &mut names, &numbers);
    tensions(scene, lowered, &mut names);
    let closed = rest.closed_forms(&names);
    // Angles are substituted, so that they are measured from their values at rest; lengths at rest stay names.
    let angles: Vec<(usize, Sum)> =
        closed.iter().filter(|(index, _)| derived.motion.coordinates[*index].turns).cloned().collect();
    rest.closed = closed;
    if !angles.is_empty() {
        derived = self::derive_equations(scene, &written, &mut names, &|names, coordinate, index| {
            let found = angles.iter().find(|(place, _)| *place == index);
            found.map_or_else(|| rest::symbol(names, coordinate, index, &numbers), |(_, form)| form.clone())
        })?;
    }
    let Derived { motion, energies, constraints, equations } = derived;
    let at_rest = AtRest::new(&motion, &energies, &mut names);
    rest.settle(&at_rest, &names, |equation| at_rest.condition(&equations[equation], &motion, &energies));
    let full = linear::linear(&motion, &energies, &equations, &at_rest);
    let independent = reduce::independent(lowered, &motion)?;
    let follows = match constraints.is_empty() {
        true => None,
        false => Some(loops::follows(&motion, &constraints, &independent, &mut names)),
    };
    let in_motion = follows.as_ref().and_then(|follows| follows.as_ref().ok()).map(|(follows, _)| &follows[..]);
    let mut linear = reduce::reduce(
        independent.clone(),
        &motion,
        &constraints,
        &equations,
        &full,
        &mut names,
        &mut rest,
        &at_rest,
        in_motion,
    )?;
    let reduced =
        follows.map(|follows| follows.map(|follows| loops::reduce(&motion, &equations, &independent, follows)));
    let rayleigh = written.rayleigh.clone();
    if let Some((alpha, beta)) = &rayleigh {
        linear.add_rayleigh(alpha, beta, &names)?;
        let is_base = |input: usize| scene.inputs.get(input).is_some_and(|input| input.kind.base().is_some());
        if !linear.relative_to_bases(alpha, beta, &names, is_base) {
            let span = match &scene.damping {
                Some(Damping::Rayleigh { span, .. }) => *span,
                _ => no_span(),
            };
            return Err(EquationsError::Carried { span });
        }
    }
    let modal_damping = match &scene.damping {
        Some(Damping::Modal { ratio, .. }) => Some(ratio.clone()),
        _ => None,
    };
    let words = |owner: &Coordinate| scene.words.display(owner.owner_name);
    let bodies = motion.coordinates.iter().map(words).collect();
    let inputs = lowered.system.inputs.iter().map(|input| lowered.system.display(input.name)).collect();
    let mut equations = Equations {
        model: scene.name.clone(),
        names,
        motion,
        energies,
        constraints,
        nonlinear: equations,
        reduced,
        rest,
        linear,
        inputs,
        outputs: Vec::new(),
        carried: transfer::reaction_outputs(scene),
        parts: Vec::new(),
        transfers: Vec::new(),
        rayleigh,
        modal_damping,
        bodies,
    };
    equations.outputs = transfer::outputs(scene, &written, &equations, &at_rest);
    equations.parts = closed::parts(&equations);
    equations.transfers = transfer::transfers(&equations, &equations.parts);
    verify::verify(&equations, scene, lowered)?;
    Ok(equations)
}

/// Refuses scenes whose equations would be too long to read.
fn refuse_large(scene: &Scene, lowered: &Lowered) -> Result<(), EquationsError> {
    let span = scene.bodies.first().map_or_else(no_span, |body| body.span);
    let coordinates = lowered.system.n() + lowered.rest.dependent.len();
    if coordinates > MOST_COORDINATES {
        return Err(EquationsError::TooManyCoordinates { span, coordinates, most: MOST_COORDINATES });
    }
    // Each body's velocity is a sum over the coordinates that move it, and is squared.
    let products = lowered.system.m.terms().map(|term| lowered.system.m.row(term).len().pow(2)).sum::<usize>();
    if products > MOST_PRODUCTS {
        return Err(EquationsError::TooManyProducts { span, products, most: MOST_PRODUCTS });
    }
    Ok(())
}

fn no_span() -> Span {
    Span::new(crate::base::FileId(0), 0, 0)
}

fn derive_equations(
    scene: &Scene,
    written: &Written,
    names: &mut Names,
    rests: &impl Fn(&mut Names, &Coordinate, usize) -> Sum,
) -> Result<Derived, EquationsError> {
    let mut elements = scene.elements.iter().zip(&written.elements);
    if let Some((element, _)) = elements.find(|(element, own)| element.law.curve.is_some() && own.law.is_none()) {
        return Err(EquationsError::Law { span: element.span, most: Powers::MOST });
    }
    let without = || EquationsError::NoForm { span: scene.bodies.first().map_or_else(no_span, |body| body.span) };
    let motion = Motion::new(scene, written, names, rests).ok_or_else(without)?;
    let energies = Energies::new(scene, written, &motion, names).ok_or_else(without)?;
    let constraints = constraint::constraints(scene, written, &motion, names).ok_or_else(without)?;
    let equations = lagrange::equations(&motion, &energies, &constraints);
    Ok(Derived { motion, energies, constraints, equations })
}

/// A gravity that is a bare number is called g, unless the model uses that name.
fn name_gravity(written: &mut Written) {
    let Some(fall) = &written.free_fall else { return };
    let Some(value) = fall.as_number() else { return };
    if value.is_zero() || written.names.iter().any(|named| named.text == "g") {
        return;
    }
    let dimension = Dimension::ACCELERATION;
    // Behind every name of the model.
    let symbol = Symbol::new(class_of(dimension), Symbol::LAST);
    let (text, value) = ("g".to_string(), Number::from(value));
    written.names.push(Named { symbol, text, value, dimension, definition: None, source: None });
    written.gravity = Some([Sum::ZERO, -&Sum::name(symbol)]);
    written.free_fall = Some(Sum::name(symbol));
}

/// Masses and coefficients that are quotients without a short decimal get a name: m_chassis for 16975/9.81.
fn name_quotients(scene: &Scene, written: &mut Written) {
    let mut made = Vec::new();
    let taken: Vec<String> = written.names.iter().map(|named| named.text.clone()).collect();
    let mut name = |sum: &mut Sum, letter: &str, of: String, dimension: Dimension| {
        let text = format!("{letter}_{of}");
        let Some(number) = sum.as_number().filter(is_unreadable) else { return };
        if taken.contains(&text) {
            return;
        }
        // Sorted before g, after all names of the model.
        let symbol = Symbol::new(class_of(dimension), Symbol::LAST - 1 - made.len());
        let (value, definition) = (Number::from(number), Some(sum.clone()));
        made.push(Named { symbol, text, value, dimension, definition, source: None });
        *sum = Sum::name(symbol);
    };
    for (body, own) in scene.bodies.iter().zip(&mut written.bodies) {
        let of = || scene.words.display(body.name);
        own.mass.iter_mut().for_each(|mass| name(mass, "m", of(), Dimension::MASS));
        own.inertia.iter_mut().for_each(|inertia| name(inertia, "J", of(), Dimension::INERTIA));
    }
    for (element, own) in scene.elements.iter().zip(&mut written.elements) {
        let (kind, turns) = (element.law.kind, element.law.geometry == Geometry::Torsion);
        let dimension = match (kind.order, turns) {
            (Order::Displacement, false) => Dimension::STIFFNESS,
            (Order::Displacement, true) => Dimension::TORQUE,
            (Order::Velocity, false) => Dimension::DAMPING,
            (Order::Velocity, true) => Dimension::TORSIONAL_DAMPING,
            (Order::Acceleration, false) => Dimension::MASS,
            (Order::Acceleration, true) => Dimension::INERTIA,
        };
        name(&mut own.coefficient, kind.coefficient().name, scene.words.display(element.name), dimension);
    }
    written.names.extend(made);
}

/// A fraction without a short decimal that is not one of those that people write.
fn is_unreadable(number: &Rational) -> bool {
    /// Denominators of fractions that are read at a glance.
    const MOST: i64 = 60;
    let Some((_, mut denominator)) = number.to_fraction() else { return true };
    if denominator <= MOST {
        return false;
    }
    for prime in [2, 5] {
        while denominator % prime == 0 {
            denominator /= prime;
        }
    }
    denominator > 1
}

/// The tensions that hold a drawing have their values from the lowering.
fn tensions(scene: &Scene, lowered: &Lowered, names: &mut Names) {
    for number in 0..scene.elements.len() {
        let found = lowered.rest.tensions.iter().find(|tension| tension.element.index() == number);
        let value = found.map_or(Number::ZERO, |found| found.tension.clone());
        names.set_value(Symbol::new(class::TENSION, number), value);
    }
}

impl Linearised {
    /// C = C + alpha M + beta K.
    fn add_rayleigh(&mut self, alpha: &Sum, beta: &Sum, names: &Names) -> Result<(), EquationsError> {
        let others = self.mass.iter().flatten().zip(self.stiffness.iter().flatten());
        for (entry, (mass, stiffness)) in self.damping.iter_mut().flatten().zip(others) {
            entry.sum = &(&entry.sum + &(alpha * &mass.sum)) + &(beta * &stiffness.sum);
            entry.value = names.value_of(&entry.sum).ok_or_else(|| EquationsError::NoForm { span: no_span() })?;
        }
        Ok(())
    }
}

impl Linearised {
    /// Lets the damping alpha M + beta K act on motion relative to what follows the bases; false if that has no form.
    fn relative_to_bases(&mut self, alpha: &Sum, beta: &Sum, names: &Names, is_base: impl Fn(usize) -> bool) -> bool {
        let mut found = Vec::new();
        for column in self.inputs.iter_mut().filter(|column| is_base(column.input) && column.parts.len() > 1) {
            let pushed = column.parts[0].clone();
            for (entry, pushed) in column.parts[1].iter_mut().zip(&pushed) {
                *entry = &*entry + &(beta * pushed);
            }
            if alpha.is_zero() || pushed.iter().all(Sum::is_zero) {
                continue;
            }
            let Some(follows) = carried::follows(&self.stiffness, &pushed, names) else { return false };
            for (entry, masses) in column.parts[1].iter_mut().zip(&self.mass) {
                let momentum = masses.iter().zip(&follows).fold(Sum::ZERO, |sum, (mass, r)| &sum + &(&mass.sum * r));
                *entry = (&*entry + &(alpha * &momentum)).simplify();
            }
            found.push((column.input, follows));
        }
        self.carried = found;
        true
    }
}

impl Equations {
    /// The form without multipliers, if it was found.
    pub fn reduced_form(&self) -> Option<&loops::Reduced> {
        self.reduced.as_ref().and_then(|reduced| reduced.as_ref().ok())
    }

    /// The label of an independent coordinate.
    pub fn label(&self, place: usize) -> Label {
        self.names.label(self.motion.coordinates[self.linear.coordinates[place]].symbols[0])
    }
}
