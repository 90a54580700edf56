//! Unbalances: each force against the second derivative of the place of its heavy spot, against the signal that drives the input, and the
//! sense of the rotation against that of the scene.

use super::jets::{Jet, Point};
use super::{Fractions, agree, defect};
use crate::base::{Ball, Number};
use crate::equations::energy::Work;
use crate::equations::unbalance::{Turns, Unbalance, time};
use crate::equations::{Equations, EquationsError};
use crate::model::scene::{Input, InputKind, Scene, Signal};
use crate::symbols::Sum;
use crate::system::Signal as Function;
use std::collections::BTreeMap;

/// Number of times at which every force is evaluated.
const MOMENTS: u64 = 3;

pub fn verify(equations: &Equations, scene: &Scene) -> Result<(), EquationsError> {
    let works = equations.energies.works.iter();
    let unbalances: Vec<(&Work, &Unbalance)> =
        works.filter_map(|work| Some((work, work.unbalance.as_ref()?))).collect();
    for (work, unbalance) in &unbalances {
        let Some(input) = scene.inputs.get(work.input) else { continue };
        let name = &equations.inputs[work.input];
        let is_of = |force: &Sum| *force == unbalance.force;
        let column = equations.linear.inputs.iter().find(|column| column.input == work.input);
        if !column.is_some_and(|column| column.force.as_ref().is_some_and(is_of)) {
            return Err(defect(input.span, format!("the linearised force of {name}"), &Number::ONE, &Number::ZERO));
        }
        for seed in 0..MOMENTS {
            let Some(Moment { time, point, .. }) = Moment::new(equations, unbalance, seed) else { continue };
            let value = |sum: &Sum| point.sum(sum);
            let (Some(force), Some(place)) = (value(&unbalance.force), value(&unbalance.place)) else { continue };
            let (force, derived) = (Number::Ball(force.value), Number::Ball(-place.ab));
            if !agree(&force, &derived) {
                return Err(defect(input.span, format!("the force of {name}"), &force, &derived));
            }
            if let Some(driven) = time.and_then(|time| driven(input, &time))
                && !agree(&force, &driven)
            {
                return Err(defect(input.span, format!("the force of {name} in time"), &force, &driven));
            }
        }
    }
    for pair in unbalances.windows(2).filter(|pair| pair[0].1.is_along_x()) {
        sense(equations, scene, [pair[0], pair[1]])?;
    }
    Ok(())
}

/// The heavy spot at a moment.
struct Moment<'a> {
    /// The time in s, if the speed is given.
    time: Option<Number>,
    /// The rate of its angle.
    rate: Number,
    /// Its angle moves with a + b, to second order.
    point: Point<'a>,
}

impl<'a> Moment<'a> {
    fn new(equations: &'a Equations, unbalance: &Unbalance, seed: u64) -> Option<Moment<'a>> {
        let mut fractions = Fractions::new(seed);
        let (zero, one) = (Ball::from(0.0), Ball::from(1.0));
        let mut motions = BTreeMap::new();
        let (time, rate) = match &unbalance.turns {
            Turns::Steadily(speed) => {
                let speed = equations.names.value_of(speed)?;
                // Within a radian, however fast it is.
                let instant = Number::from(fractions.next()).checked_div(&speed)?;
                motions.insert(time(), Jet { value: instant.to_ball(), a: one, b: one, ab: zero });
                (Some(instant), speed)
            }
            Turns::Freely([angle, rate, acceleration]) => {
                let [value, speed, more] = [0, 1, 2].map(|_| fractions.next().to_ball());
                motions.insert(*angle, Jet { value, a: speed, b: speed, ab: more });
                motions.insert(*rate, Jet::constant(speed));
                motions.insert(*acceleration, Jet::constant(more));
                (None, Number::Ball(speed))
            }
        };
        Some(Moment { time, rate, point: Point { motions, equations } })
    }
}

/// The opposite of the signal, which is the second derivative of the input.
fn driven(input: &Input, at: &Number) -> Option<Number> {
    input.signal.iter().try_fold(Number::ZERO, |sum, signal| {
        let Signal::Function(Function::Harmonic { value, frequency, phase, .. }) = signal else { return None };
        let angle = &(&(&(&Number::pi() * &Number::from(2)) * frequency) * at) + phase;
        let (sine, _) = angle.sin_cos()?;
        Some(&sum - &(value * &sine))
    })
}

/// The cross product of the place and its rate, in the scene, has the sign of the rotation.
fn sense(equations: &Equations, scene: &Scene, pair: [(&Work, &Unbalance); 2]) -> Result<(), EquationsError> {
    let Some(Moment { rate, point, .. }) = Moment::new(equations, pair[0].1, 0) else { return Ok(()) };
    let of = |(work, unbalance): (&Work, &Unbalance)| {
        let input = scene.inputs.get(work.input)?;
        let InputKind::Unbalance { direction, clockwise, .. } = &input.kind else { return None };
        let place = point.sum(&unbalance.place)?;
        Some(([place.value, place.a].map(Number::Ball), [&direction.x, &direction.y], *clockwise, input.span))
    };
    let [Some((x, along, clockwise, span)), Some((y, across, ..))] = pair.map(of) else { return Ok(()) };
    let cross = |a: [&Number; 2], b: [&Number; 2]| &(a[0] * b[1]) - &(a[1] * b[0]);
    let turned = &(&cross([&x[0], &y[0]], [&x[1], &y[1]]) * &cross(along, across)) * &rate;
    let is_wrong = if clockwise { turned.is_positive() } else { turned.is_negative() };
    if is_wrong {
        return Err(defect(span, "the sense of the rotation".to_string(), &turned, &-&turned));
    }
    Ok(())
}
