//! The motion of a base as its acceleration between events: polynomials in time, with jumps of displacement and velocity at
//! the events. In: signals of its displacement, velocity or acceleration. Out: one segment after another.

use super::Refusal;
use crate::analysis::response::signal::{Piece, Source, order};
use crate::base::{Ball, Number};
use crate::system::Signal;
use std::cmp::Ordering;

/// The acceleration from one event to the next.
#[derive(Clone, Debug)]
pub struct Segment {
    pub length: Number,
    /// a, a', a'', ... at its start.
    pub derivatives: Vec<Ball>,
}

/// Jumps of the displacement and the velocity at the start of a segment.
#[derive(Clone, Copy, Debug)]
pub struct Jump {
    pub segment: usize,
    pub displacement: Ball,
    pub velocity: Ball,
}

#[derive(Clone, Debug)]
pub struct BaseMotion {
    /// At rest before the first one.
    pub segments: Vec<Segment>,
    /// By ascending segment; one may be at the end, with the number of segments.
    pub jumps: Vec<Jump>,
    /// The acceleration after the last event, which does not change.
    pub last: Ball,
    /// A bound of the error of every acceleration, of a chirp's polynomials.
    pub error: f64,
    /// The time of the last event.
    pub end: Number,
}

impl BaseMotion {
    pub fn of(signals: &[Signal], derivative: u8) -> Result<BaseMotion, Refusal> {
        let felt: Vec<&Signal> = signals.iter().filter(|signal| signal.is_felt()).collect();
        if felt.is_empty() {
            return Err(Refusal::NoSignal);
        }
        let mut sources = Vec::new();
        for signal in felt {
            match Source::of(signal, None).map_err(|_| Refusal::TooLong { steps: f64::INFINITY })? {
                Source::Harmonic { .. } => return Err(Refusal::Endless),
                Source::Impulse { .. } if derivative == 0 => return Err(Refusal::Impulse),
                // Signals are zero before t = 0.
                Source::Impulse { at, .. } if at.is_negative() => {}
                source => sources.push(source),
            }
        }
        let mut times: Vec<Number> = sources.iter().flat_map(Source::events).collect();
        if sources.len() > 1 {
            times.sort_by(order);
        }
        times.dedup_by(|later, earlier| order(later, earlier) == Ordering::Equal);
        let (Some(first), Some(end)) = (times.first().cloned(), times.last().cloned()) else {
            return Err(Refusal::NoSignal);
        };
        let own = usize::from(derivative);
        let error = sources.iter().map(|source| source.approximation(2 - own)).sum::<f64>().next_up();
        let mut course = Course { sources: &sources, places: vec![0; sources.len()], derivative: own };
        let (mut segments, mut jumps) = (Vec::with_capacity(times.len()), Vec::new());
        let mut now = first;
        let mut ahead = times.iter().skip(1);
        let last = loop {
            let [displacement, velocity] = course.jumps(&now);
            if !(displacement.is_zero() && velocity.is_zero()) {
                jumps.push(Jump { segment: segments.len(), displacement, velocity });
            }
            let derivatives = course.acceleration(&now);
            let Some(next) = ahead.next() else { break derivatives };
            segments.push(Segment { length: next - &now, derivatives });
            now = next.clone();
        };
        if last.len() > 1 {
            return Err(Refusal::Endless);
        }
        Ok(BaseMotion { segments, jumps, last: last.first().copied().unwrap_or(Ball::ZERO), error, end })
    }
}

/// A walk through the pieces of all sources.
struct Course<'a> {
    sources: &'a [Source],
    /// For each source the number of its pieces that have begun.
    places: Vec<usize>,
    /// Which derivative of the displacement the sources are.
    derivative: usize,
}

impl Course<'_> {
    /// Goes on to an event; returns what the displacement and the velocity jump by.
    fn jumps(&mut self, now: &Number) -> [Ball; 2] {
        let mut sum = [Ball::ZERO; 2];
        let mut add = |of: usize, value: Ball| {
            if of < 2 {
                sum[of] = sum[of] + value;
            }
        };
        for (source, place) in self.sources.iter().zip(&mut self.places) {
            match source {
                Source::Impulse { value, at } if order(at, now) == Ordering::Equal => add(self.derivative - 1, *value),
                Source::Pieces { pieces, .. } => {
                    // Pieces that begin at the same time replace one another.
                    let from = *place;
                    while pieces.get(*place).is_some_and(|piece| order(&piece.at, now) != Ordering::Greater) {
                        *place += 1;
                    }
                    let begun = &pieces[from..*place];
                    if self.derivative == 2 || !begun.iter().any(|piece| piece.jump) {
                        continue;
                    }
                    let before = from.checked_sub(1).map(|last| pieces[last].at_time(now)).unwrap_or_default();
                    let after = begun.last().map(|piece| piece.at_time(now)).unwrap_or_default();
                    let part = |all: &[Ball], k: usize| all.get(k).copied().unwrap_or(Ball::ZERO);
                    for k in 0..2 - self.derivative {
                        add(self.derivative + k, part(&after, k) - part(&before, k));
                    }
                }
                _ => {}
            }
        }
        sum
    }

    /// The acceleration and its derivatives from now on.
    fn acceleration(&self, now: &Number) -> Vec<Ball> {
        let mut sum: Vec<Ball> = Vec::new();
        for (source, place) in self.sources.iter().zip(&self.places) {
            let Source::Pieces { pieces, .. } = source else { continue };
            let Some(piece) = place.checked_sub(1).map(|last| &pieces[last]) else { continue };
            let mut all = here(piece, now);
            if sum.is_empty() {
                all.drain(..all.len().min(2 - self.derivative));
                sum = all;
                continue;
            }
            for (k, value) in all.into_iter().skip(2 - self.derivative).enumerate() {
                match sum.get_mut(k) {
                    Some(known) => *known = *known + value,
                    None => sum.push(value),
                }
            }
        }
        while sum.last().is_some_and(Ball::is_zero) {
            sum.pop();
        }
        sum
    }
}

/// All derivatives of a piece at a time.
fn here(piece: &Piece, now: &Number) -> Vec<Ball> {
    if piece.at == *now {
        return piece.derivatives.iter().map(Number::to_ball).collect();
    }
    piece.at_time(now)
}
