//! The velocity or the acceleration of a base as an input of its own. In: a linear system whose input u is the displacement of
//! a base. Out: the system with one input more, u' or u''. See docs/method/transfer.md#velocities-and-accelerations-of-bases.
//!
//! The motion is measured from what follows the base, and nothing is divided by the frequency: an output that sees only the rest of
//! it (a stretch, an absolute acceleration) is finite at 0 Hz. An output that sees the displacement
//! of the base itself gets it from one more coordinate, a free mass under the force u'' or a damper under u', which nothing
//! else touches.

use super::following::{Following, Known, less};
use super::forms::{apply, dense, dot};
use crate::base::{FileId, Number, Span};
use crate::system::{
    ByRate, Coordinate, CoordinateId, CoordinateKind, Input, Label, LinearSystem, Losses, Nature, Output,
};

/// The static response to the base is not found.
pub const NOT_FOLLOWED: &str = "it is not known what follows the base when it moves slowly: no spring holds some motion, or the scene is too large";
/// The force of a loss factor does not vanish in what follows the base: there is no limit at 0 Hz.
pub const LOST: &str =
    "a spring with a loss factor is stretched however slowly the base moves, so its loss has no limit at 0 Hz";

/// The rate of an input.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rate {
    /// Index of the input that is the displacement.
    pub input: usize,
    /// 1 for the velocity, 2 for the acceleration.
    pub derivative: u8,
    /// `ax` of `quake.ax`.
    pub word: &'static str,
}

/// The system with the rate as its last input, or the reason why there is none.
pub fn with_rate(system: &LinearSystem, rate: Rate) -> Result<LinearSystem, &'static str> {
    if !system.chain.is_empty() {
        return Err(NOT_FOLLOWED);
    }
    let derivative = usize::from(rate.derivative);
    let of = &system.inputs[rate.input];
    let following = Following::of(system, &[rate.input], derivative, Known::Enclosed).ok_or(NOT_FOLLOWED)?;
    let mut driven = system.clone();
    if let Some(losses) = &mut driven.losses {
        lose(losses, rate, system.inputs.len(), &following);
    }
    let mut left = following.forces.iter().skip(derivative).map(|force| sparse(force));
    let b = std::array::from_fn(|_| left.next().unwrap_or_default());
    let unit = unit_of(of.unit, rate.derivative);
    let name = Label { name: of.name.name, motion: rate.word };
    driven.inputs.push(Input { name, span: of.span, unit, b, undamped: None });
    see(&mut driven, rate, &following);
    Ok(driven)
}

/// The system with one output alone, and the rate as its last input: a coordinate is added only if this output needs it.
pub fn from_rate(system: &LinearSystem, rate: Rate, output: usize) -> Result<LinearSystem, &'static str> {
    let mut alone = system.clone();
    alone.outputs = vec![system.outputs[output].clone()];
    if let Some(losses) = &mut alone.losses {
        losses.p = vec![losses.p[output].clone()];
        losses.d = vec![losses.d[output].clone()];
    }
    with_rate(&alone, rate)
}

/// [`from_rate`] for the limit at 0 Hz, which is refused where loss factors leave none.
pub fn from_rate_at_rest(system: &LinearSystem, rate: Rate, output: usize) -> Result<LinearSystem, &'static str> {
    let driven = from_rate(system, rate, output)?;
    let is_lost = driven.losses.as_ref().is_some_and(|losses| losses.has_no_limit(driven.inputs.len() - 1));
    if is_lost { Err(LOST) } else { Ok(driven) }
}

/// Gives every output what it sees of the base: s^k e_k u for k = 0 .. 3, as multiples of the rate where k is large enough.
fn see(driven: &mut LinearSystem, rate: Rate, following: &Following) {
    let (derivative, new) = (usize::from(rate.derivative), driven.inputs.len() as u32 - 1);
    let mut base = None;
    for index in 0..driven.outputs.len() {
        let seen: [Number; 4] = std::array::from_fn(|k| coefficient(&driven.outputs[index], k, rate.input, following));
        for (k, value) in seen.into_iter().enumerate().filter(|(_, value)| !value.is_zero()) {
            if k < derivative {
                let base = *base.get_or_insert_with(|| base_itself(driven, rate.derivative));
                driven.outputs[index].p[k].push((base, value));
            } else {
                driven.outputs[index].d[k - derivative].push((new, value));
            }
        }
    }
}

/// e_k = d_k + p_k r + p_(k-1) r'
fn coefficient(output: &Output, k: usize, input: usize, following: &Following) -> Number {
    let [follows, late] = &following.followed;
    let own = output.d.get(k).into_iter().flatten().filter(|(of, _)| *of as usize == input);
    let through = |power: usize, followed: &[Number]| output.p.get(power).map_or(Number::ZERO, |p| dot(p, followed));
    let at_once = own.fold(through(k, follows), |sum, (_, value)| &sum + value);
    k.checked_sub(1).map_or(at_once.clone(), |before| &at_once + &through(before, late))
}

/// Adds a coordinate that moves as the base does.
fn base_itself(driven: &mut LinearSystem, derivative: u8) -> CoordinateId {
    let base = CoordinateId(driven.coordinates.len() as u32);
    let Some(Input { name, unit, b, .. }) = driven.inputs.last_mut() else { return base };
    b[0].push((base, Number::ONE));
    let kind = if unit.starts_with("rad") { CoordinateKind::Rotation } else { CoordinateKind::Translation };
    driven.coordinates.push(Coordinate { name: *name, kind, span: Span::new(FileId(0), 0, 0) });
    let form = if derivative == 1 { &mut driven.c } else { &mut driven.m };
    let source = form.source(*name);
    form.push(source, Nature::Property, Number::ONE, [(base, Number::ONE)]);
    base
}

/// Adds what loss factors do in what follows the base, r u + r' u': by u' with its velocity given and by u'' with its acceleration
/// given they act at once, by a lower derivative of u over a power of s.
fn lose(losses: &mut Losses, rate: Rate, new: usize, following: &Following) {
    let [follows, late] = &following.followed;
    let n = follows.len();
    let own = dense(n, &losses.b[rate.input]);
    let by = [less(&own, &apply(&losses.h, follows)), less(&vec![Number::ZERO; n], &apply(&losses.h, late))];
    let seen = |p: &[(CoordinateId, Number)], d: &[(u32, Number)]| {
        let fed = d.iter().filter(|(input, _)| *input as usize == rate.input);
        [fed.fold(dot(p, follows), |sum, (_, value)| &sum + value), dot(p, late)]
    };
    let outputs: Vec<[Number; 2]> = losses.p.iter().zip(&losses.d).map(|(p, d)| seen(p, d)).collect();
    losses.b.push(Vec::new());
    for (order, forces) in by.iter().enumerate() {
        let b = sparse(forces);
        let d = (0..).zip(&outputs).map(|(output, seen)| (output, seen[order].clone()));
        let d: Vec<(u32, Number)> = d.filter(|(_, value)| !value.is_zero()).collect();
        let power = rate.derivative.saturating_sub(order as u8);
        if power > 0 && !(b.is_empty() && d.is_empty()) {
            losses.by_rate.push(ByRate { input: new as u32, power, b, d });
        } else if power == 0 {
            losses.b[new] = b;
            d.into_iter().for_each(|(output, value)| losses.d[output as usize].push((new as u32, value)));
        }
    }
}

fn sparse(dense: &[Number]) -> Vec<(CoordinateId, Number)> {
    let entries = dense.iter().enumerate().filter(|(_, value)| !value.is_zero());
    entries.map(|(i, value)| (CoordinateId(i as u32), value.clone())).collect()
}

/// `m/s^2` of `m`.
fn unit_of(displacement: &str, derivative: u8) -> &'static str {
    match (displacement, derivative) {
        ("rad", 1) => "rad/s",
        ("rad", _) => "rad/s^2",
        (_, 1) => "m/s",
        _ => "m/s^2",
    }
}
