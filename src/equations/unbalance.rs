//! Rotating unbalances: the force of a heavy spot through the motion of that spot. In: the declaration. Out: for each
//! axis the position of the spot times its mass, and the force, which is the opposite of the second derivative of that.
//!
//! With a speed, the spot is at the angle omega t and the force along x is m e omega^2 cos(omega t); without one, its
//! angle is a name, and the force is m e (phi'^2 cos(phi) + phi'' sin(phi)).

use super::names::{Label, Names, class};
use crate::base::Dimension;
use crate::model::scene::{Axis, InputKind, Scene};
use crate::model::written::{Named, Pair, Written, WrittenRotation, class_of};
use crate::symbols::{Factor, Sum, Symbol};

/// A component of an unbalance.
#[derive(Clone, Debug)]
pub struct Unbalance {
    pub axis: Axis,
    /// The position of the heavy spot along the axis, times its mass.
    pub place: Sum,
    pub force: Sum,
    pub turns: Turns,
    /// The axis in the scene.
    pub along: Pair,
    /// The sense in the scene; in a mirrored component, the model states the opposite.
    pub clockwise: bool,
}

/// The angle of a heavy spot.
#[derive(Clone, Debug, PartialEq)]
pub enum Turns {
    /// omega t, with omega in rad/s.
    Steadily(Sum),
    /// An angle with its derivatives.
    Freely([Symbol; 3]),
}

/// The time.
pub fn time() -> Symbol {
    Symbol::new(class::TIME, 0)
}

/// Angular frequencies that the model does not name itself are called omega, with the unbalance that is first to turn so fast.
pub fn name_speeds(scene: &Scene, written: &mut Written) -> Vec<(Symbol, Label)> {
    let mut made: Vec<(Named, Label)> = Vec::new();
    let taken: Vec<String> = written.names.iter().map(|named| named.text.clone()).collect();
    let values = Names::new(written);
    for (input, own) in scene.inputs.iter().zip(&mut written.inputs) {
        let Some(WrittenRotation { speed: Some(speed), .. }) = &mut own.rotation else { continue };
        if is_name(speed) {
            continue;
        }
        if let Some((known, _)) = made.iter().find(|(known, _)| known.definition.as_ref() == Some(speed)) {
            *speed = Sum::name(known.symbol);
            continue;
        }
        let Some(value) = values.value_of(speed) else { continue };
        let index = scene.words.display(input.name);
        let free = ["omega", "Omega", "w"].into_iter().find(|word| !taken.contains(&format!("{word}_{index}")));
        let label = Label::new(free.unwrap_or("omega"), index);
        let dimension = Dimension::FREQUENCY;
        // Behind every name of the model.
        let symbol = Symbol::new(class_of(dimension), Symbol::LAST - made.len());
        let (text, definition) = (label.plain(), Some(speed.clone()));
        made.push((Named { symbol, text, value, dimension, definition, source: None }, label));
        *speed = Sum::name(symbol);
    }
    let labels = made.iter().map(|(named, label)| (named.symbol, label.clone())).collect();
    written.names.extend(made.into_iter().map(|(named, _)| named));
    labels
}

fn is_name(sum: &Sum) -> bool {
    match sum.terms() {
        [(product, coefficient)] => coefficient.is_one() && matches!(product.factors(), [(Factor::Name(_), 1)]),
        _ => false,
    }
}

impl Unbalance {
    /// The first of the two components.
    pub fn is_along_x(&self) -> bool {
        self.axis == Axis::X
    }

    /// The unbalance of an input; `None` for any other kind of input.
    pub fn new(scene: &Scene, written: &Written, input: usize, names: &mut Names) -> Option<Unbalance> {
        let InputKind::Unbalance { axis, clockwise, .. } = scene.inputs.get(input)?.kind else { return None };
        let along = written.inputs.get(input)?.along.clone()?;
        let WrittenRotation { unbalance, speed, clockwise: reverses } = written.inputs.get(input)?.rotation.as_ref()?;
        let turns = turns(scene, (input, axis), speed.as_ref(), names);
        let [angle, rate, acceleration] = match &turns {
            Turns::Steadily(omega) => [omega * &Sum::name(time()), omega.clone(), Sum::ZERO],
            Turns::Freely(symbols) => symbols.map(Sum::name),
        };
        let (cosine, sine) = (angle.cosine(), angle.sine());
        let towards = |along: &Sum, across: &Sum| &(&rate.square() * along) - &(&acceleration * across);
        let (place, force) = match axis {
            Axis::X => (cosine.clone(), towards(&cosine, &-&sine)),
            Axis::Y => (sine.clone(), towards(&sine, &cosine)),
        };
        let signed = if *reverses && axis == Axis::Y { -unbalance } else { unbalance.clone() };
        Some(Unbalance { axis, place: &signed * &place, force: &signed * &force, turns, along, clockwise })
    }
}

fn turns(scene: &Scene, (input, axis): (usize, Axis), speed: Option<&Sum>, names: &mut Names) -> Turns {
    if let Some(speed) = speed {
        let word = if names.is_taken("t") { "tau" } else { "t" };
        names.set(time(), Label::new(word, ""), None);
        return Turns::Steadily(speed.clone());
    }
    // The component along x comes first; both have one angle.
    let first = if axis == Axis::X { input } else { input.saturating_sub(1) };
    let index = scene.words.display(scene.inputs[input].name);
    let label = names.fresh("phi", index);
    Turns::Freely([0, 1, 2].map(|order: u8| {
        let symbol = Symbol::new(class::HEAVY_SPOT, 3 * first + usize::from(order));
        names.set(symbol, Label { dots: order, ..label.clone() }, None);
        symbol
    }))
}
