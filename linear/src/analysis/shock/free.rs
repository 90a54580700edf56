//! The free motion after the last event, in closed form: the largest values of an oscillator that decays about its rest.
//! See docs/method/shock.md#residual.

use super::Sides;
use super::sweep::State;
use crate::base::{Ball, Number};

/// A damping ratio zeta, and 1 - zeta^2, which is exactly zero at critical damping.
#[derive(Clone, Copy, Debug)]
pub struct Damping {
    pub ratio: Ball,
    pub gap: Ball,
}

impl From<&Number> for Damping {
    fn from(ratio: &Number) -> Damping {
        Damping { ratio: ratio.to_ball(), gap: (&Number::ONE - &ratio.square()).to_ball() }
    }
}

/// The largest values of x to both sides from the last event on, about the rest a / omega.
pub fn residual(state: &State, acceleration: Ball, damping: Damping, omega: Ball) -> Sides {
    let rest = acceleration / omega;
    let (x, v) = (state.x - rest, state.v);
    // One is the negative of the other: both have the same first extremum.
    let first = match () {
        () if damping.ratio.is_zero() => None,
        () if v.is_positive() || !v.is_negative() && x.is_positive() => first_extremum(x, v, damping),
        () => first_extremum(-x, -v, damping),
    };
    let side = |x: Ball, v: Ball, rest: Ball| cut(rest + highest(x, v, damping, first));
    Sides { positive: side(x, v, rest), negative: side(-x, -v, -rest) }
}

/// A number that is at least zero.
fn cut(x: Ball) -> Ball {
    if x.is_positive() {
        return x;
    }
    if x.is_negative() { Ball::ZERO } else { between(0.0, (x.mid.hi + x.rad).next_up().max(0.0)) }
}

/// The supremum of x(t), t >= 0, for x'' + 2 zeta x' + x = 0 with x' = v at t = 0. It is not negative: x decays to zero, or
/// swings. `first`: its first extremum, or that of the motion to the other side, whichever rises.
///
/// q = x^2 + 2 zeta x v + v^2 is q_0 exp(-2 zeta t), and v = 0 in an extremum: its value is sqrt(q_0) exp(-zeta t).
fn highest(x: Ball, v: Ball, damping: Damping, first: Option<Option<Ball>>) -> Ball {
    let whole = (x.square() + v.square()).sqrt();
    if damping.ratio.is_zero() {
        return whole;
    }
    let found = if v.is_positive() {
        first.map(|extremum| extremum.unwrap_or(Ball::ZERO))
    } else if v.is_negative() || x.is_negative() {
        // Through its lowest point first.
        swing_after(first, damping)
    } else {
        None
    };
    // An undecided value lies between the start and the bound by the energy.
    let low = if x.is_positive() { x.mignitude() } else { 0.0 };
    let within = between(low, whole.magnitude());
    found.map(|found| super::larger(found, x)).filter(|found| found.rad <= within.rad).unwrap_or(within)
}

fn between(low: f64, high: f64) -> Ball {
    let middle = 0.5 * (low + high);
    Ball::from(middle).widen((high - middle).max(middle - low).next_up())
}

/// The first extremum of a motion that rises now; `Some(None)` if it rises for ever, and `None` where that is open.
fn first_extremum(x: Ball, v: Ball, damping: Damping) -> Option<Option<Ball>> {
    let Damping { ratio: damping, gap } = damping;
    let square = x.square() + damping * Ball::from(2.0) * x * v + v.square();
    let size = |time: Ball| -> Option<Ball> {
        let decay = Number::Ball(-(damping * time)).exp()?.to_ball();
        Some(square.sqrt() * decay)
    };
    let leans = damping * v + x;
    if gap.is_positive() {
        let root = gap.sqrt();
        let angle = Number::atan2(&Number::Ball(root * v), &Number::Ball(leans))?.to_ball();
        return size(angle / root).map(Some);
    }
    if gap.is_zero() {
        // v(t) = exp(-t) (v - (v + x) t)
        let sum = v + x;
        if sum.is_negative() {
            return Some(None);
        }
        return if sum.is_positive() { size(v / sum).map(Some) } else { None };
    }
    if gap.is_negative() {
        // tanh(root t) = root v / leans
        let root = (-gap).sqrt();
        let (above, below) = (leans + root * v, leans - root * v);
        if below.is_negative() {
            return Some(None);
        }
        if !below.is_positive() {
            return None;
        }
        let time = Number::Ball(above / below).ln()?.to_ball() / (root * Ball::from(2.0));
        return size(time).map(Some);
    }
    None
}

/// The highest point of a motion after its lowest one, which is next: half a period later; zero where it does not swing.
fn swing_after(lowest: Option<Option<Ball>>, damping: Damping) -> Option<Ball> {
    let Damping { ratio, gap } = damping;
    if gap.is_negative() || gap.is_zero() {
        return Some(Ball::ZERO);
    }
    let lowest = lowest??;
    let half_turn = -(ratio * Ball::PI / gap.sqrt());
    Some(lowest * Number::Ball(half_turn).exp()?.to_ball())
}
