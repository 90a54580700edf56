//! The action of a noise on the coordinates, by one input or by several at different times. In: a system, a noise. Out:
//! channels, and whether the direct path to an output leaves its variance finite. See
//! docs/method/random.md#direct-paths.

use super::Spread;
use super::bands::Bands;
use super::channel::{Channel, Feed};
use crate::analysis::forms::is_certain;
use crate::base::{Ball, Density, Number};
use crate::system::{LinearSystem, Noise, Output};
use std::cell::OnceCell;

const DIRECT: &str = "infinite: white noise reaches it without any inertia between";
const BASE_RATE: &str = "infinite: white noise is the rate of a base that moves it through a damper";
const DRIFT: &str = "infinite: the base itself drifts, and the output with it";

const OPEN_FEED: &str = "whether white noise reaches it directly is not decided: the numbers are not exact";
pub const OPEN_BASE: &str = "what the coordinates follow of the base is not found exactly";
const OPEN_DELAYS: &str = "whether two delays are equal is not decided: the numbers are not exact";
const OPEN_FREE: &str =
    "a motion is not held by springs: whether it takes the drift of the base from this output is not proved";
const OPEN_TOGETHER: &str = "each base drifts, and whether the output does when one follows the other is not proved";

/// A noise and its action on the coordinates.
pub struct Source<'a> {
    pub noise: &'a Noise,
    /// One for each delay; or the reason why the action is not known.
    pub arms: Result<Vec<Arm>, &'static str>,
    /// The derivatives of its inputs that the channels do not use.
    pub left: i32,
    /// Its integrals over the bands, and those times w^2.
    pub bands: [OnceCell<Option<Bands>>; 2],
}

/// Inputs that a noise drives at once.
pub struct Arm {
    pub channel: Channel,
    /// The delay after the noise, s.
    pub delay: Number,
}

impl<'a> Source<'a> {
    /// If the static response to a base is not found, noise in bands acts by the base's own motion.
    pub fn of(system: &LinearSystem, noise: &'a Noise) -> Source<'a> {
        let of = |derivative: u8| Arm::all(system, noise, derivative);
        let (mut arms, mut left) = (of(noise.derivative), 0);
        if matches!(arms, Err(OPEN_BASE)) && matches!(noise.density, Density::Bands(_)) {
            (arms, left) = (of(0), i32::from(noise.derivative));
        }
        Source { noise, arms, left, bands: Default::default() }
    }

    pub fn is_white(&self) -> bool {
        matches!(self.noise.density, Density::White(_))
    }
}

impl Arm {
    fn all(system: &LinearSystem, noise: &Noise, derivative: u8) -> Result<Vec<Arm>, &'static str> {
        let mut together: Vec<(&Number, Vec<usize>)> = Vec::new();
        for (input, delay) in &noise.inputs {
            let apart = |known: &Number| delay - known;
            if together.iter().any(|(known, _)| !apart(known).is_zero() && apart(known).may_be_zero()) {
                return Err(OPEN_DELAYS);
            }
            match together.iter_mut().find(|(known, _)| apart(known).is_zero()) {
                Some((_, inputs)) => inputs.push(*input),
                None => together.push((delay, vec![*input])),
            }
        }
        let arm = |(delay, inputs): (&Number, Vec<usize>)| {
            let channel = Channel::of(system, &inputs, derivative).ok_or(OPEN_BASE)?;
            Ok(Arm { channel, delay: delay.clone() })
        };
        together.into_iter().map(arm).collect()
    }
}

/// The motions that the springs of a system do not hold.
pub enum Springs {
    /// None: K is regular.
    Hold,
    /// The multiples of one motion.
    One(Rigid),
    /// Not known.
    Open,
}

/// A motion r without stiffness.
pub struct Rigid {
    pub motion: Vec<Number>,
    /// C r, and r . C r
    pub drag: Vec<Number>,
    pub resistance: Number,
}

impl Rigid {
    /// p r: how much of the motion an output shows.
    fn shown_motion(&self, output: &Output) -> Number {
        output.p[0].iter().fold(Number::ZERO, |sum, (i, a)| &sum + &(a * &self.motion[i.index()]))
    }

    /// The part of the motion that an output shows times the force along it at 0 Hz, from all inputs of a noise. Delays
    /// make no difference there.
    pub fn excitation_shown(&self, arms: &[&Arm], output: &Output) -> Number {
        let force = |arm: &&Arm| arm.channel.force_along(&self.motion, &self.drag);
        let driven = arms.iter().map(force).fold(Number::ZERO, |sum, force| &sum + &force);
        &driven * &self.shown_motion(output)
    }
}

impl Springs {
    /// The factor of 1 / s with which motions without stiffness appear in an output; `None` if it is not found.
    fn residue(&self, arms: &[&Arm], output: &Output) -> Option<Number> {
        match self {
            Springs::Hold => Some(Number::ZERO),
            // Near 0 Hz (M s^2 + C s + K)^-1 is r r^T / (s r.C r) plus a finite part.
            Springs::One(rigid) if is_certain(&rigid.resistance) => {
                rigid.excitation_shown(arms, output).checked_div(&rigid.resistance)
            }
            Springs::One(_) | Springs::Open => None,
        }
    }
}

/// Whether white noise reaches an output without delay, and if so, why its variance is not finite. Direct paths at
/// different times cancel only at 0 Hz.
pub fn direct(arms: &[&Arm], output: &Output, springs: &Springs) -> Result<(), Spread> {
    let mut open = false;
    for Arm { channel, .. } in arms {
        let feed = channel.feed(output);
        let [_, _, at_once @ ..] = &feed;
        if at_once.iter().any(is_certain) {
            let is_rate = channel.jumps() && output.p[2].is_empty() && !channel.is_fed(output);
            // A drift, if there is one, is reported first.
            drift(arms, output, springs).map_err(|drift| {
                if matches!(drift, Spread::Infinite(_)) { drift } else { Spread::Infinite(DIRECT.into()) }
            })?;
            return Err(Spread::Infinite(if is_rate { BASE_RATE } else { DIRECT }.into()));
        }
        open |= at_once.iter().any(|part| !part.is_zero());
    }
    drift(arms, output, springs)?;
    if open { Err(Spread::Unknown(OPEN_FEED)) } else { Ok(()) }
}

/// Whether an output drifts with what drives it: sum (a_j / s^2 + b_j / s) e^(-s t_j) is, near 0 Hz,
/// sum a_j / s^2 + sum (b_j - a_j t_j) / s, and motions that no spring holds add to it.
pub fn drift(arms: &[&Arm], output: &Output, springs: &Springs) -> Result<(), Spread> {
    let feeds: Vec<Feed> = arms.iter().map(|arm| arm.channel.feed(output)).collect();
    if feeds.iter().all(|feed| feed[..2].iter().all(Number::is_zero)) {
        return Ok(());
    }
    let twice = feeds.iter().fold(Number::ZERO, |sum, feed| &sum + &feed[0]);
    let once = feeds.iter().zip(arms).fold(Number::ZERO, |sum, (feed, arm)| {
        let later = &feed[0] * &arm.delay;
        &sum + &(&feed[1] - &later)
    });
    let Some(free) = springs.residue(arms, output) else { return Err(Spread::Unknown(OPEN_FREE)) };
    let once = &once + &free;
    Err(match arms {
        _ if is_certain(&twice) || is_certain(&once) => Spread::Infinite(DRIFT.into()),
        _ if !matches!(springs, Springs::Hold) => Spread::Unknown(OPEN_FREE),
        [_] => Spread::Unknown(OPEN_FEED),
        _ => Spread::Unknown(OPEN_TOGETHER),
    })
}

/// The two-sided intensity of white noise: half of its one-sided density.
pub fn intensity(noise: &Noise) -> Option<Ball> {
    match &noise.density {
        Density::White(value) => Some(value.to_ball() * Ball::from(0.5)),
        Density::Bands(_) => None,
    }
}
