//! The motion of a base as its acceleration between events: polynomials in time, with jumps of displacement and velocity at
//! the events. In: signals of its displacement, velocity or acceleration. Out: one segment after another.

use super::Refusal;
use crate::analysis::response::signal::{Source, chronological, order};
use crate::base::{Ball, Number, OrderBy};
use crate::system::Signal;
use std::cmp::Ordering;

/// The acceleration from one event to the next.
#[derive(Clone, Copy, Debug)]
pub struct Segment {
    /// The index of its length.
    pub class: u32,
    /// Where its derivatives begin.
    first: usize,
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
    /// The different lengths of segments; some may be there more than once.
    pub lengths: Vec<Ball>,
    /// By ascending segment; one may be at the end, with the number of segments.
    pub jumps: Vec<Jump>,
    /// a, a', a'', ... at the starts of the segments.
    derivatives: Vec<Ball>,
    /// The acceleration after the last event, which does not change.
    pub last: Ball,
    /// A bound of the error of every acceleration, of a chirp's polynomials.
    pub error: f64,
    /// The time of the last event.
    pub end: Number,
}

/// Lengths with which the next one is compared.
const RECENT: usize = 8;

impl BaseMotion {
    pub fn of(signals: &[Signal], derivative: u8) -> Result<BaseMotion, Refusal> {
        let felt: Vec<&Signal> = signals.iter().filter(|signal| signal.is_felt()).collect();
        if felt.is_empty() {
            return Err(Refusal::NoSignal);
        }
        let mut sources = Vec::new();
        for signal in felt {
            if signal.comes_again() {
                return Err(Refusal::Endless);
            }
            match Source::of(signal, None, None).map_err(|_| Refusal::TooLong { steps: f64::INFINITY })? {
                Source::Harmonic { .. } => return Err(Refusal::Endless),
                Source::Impulse { .. } if derivative == 0 => return Err(Refusal::Impulse),
                source => sources.push(source),
            }
        }
        let mut times: Vec<&Number> = sources.iter().flat_map(Source::events).collect();
        if sources.len() > 1 {
            times.order_by(|a, b| chronological(a, b));
        }
        times.dedup_by(|later, earlier| order(later, earlier) == Ordering::Equal);
        let [first, others @ ..] = &times[..] else { return Err(Refusal::NoSignal) };
        let own = usize::from(derivative);
        let error = sources.iter().map(|source| source.approximation(2 - own)).sum::<f64>().next_up();
        let mut course = Course { sources: &sources, places: vec![0; sources.len()], derivative: own };
        let mut motion = BaseMotion {
            segments: Vec::with_capacity(others.len()),
            lengths: Vec::new(),
            jumps: Vec::new(),
            derivatives: Vec::with_capacity(2 * times.len()),
            last: Ball::ZERO,
            error,
            end: (*others.last().unwrap_or(first)).clone(),
        };
        let mut lengths: Vec<Number> = Vec::new();
        for (i, now) in times.iter().enumerate() {
            let [displacement, velocity] = course.jumps(now);
            if !(displacement.is_zero() && velocity.is_zero()) {
                motion.jumps.push(Jump { segment: i, displacement, velocity });
            }
            let first = motion.derivatives.len();
            course.acceleration(now, &mut motion.derivatives);
            let Some(next) = times.get(i + 1) else {
                let last = &motion.derivatives[first..];
                if last.len() > 1 {
                    return Err(Refusal::Endless);
                }
                motion.last = last.first().copied().unwrap_or(Ball::ZERO);
                motion.derivatives.truncate(first);
                continue;
            };
            let class = index(&mut lengths, *next - *now);
            motion.segments.push(Segment { class: class as u32, first });
        }
        motion.lengths = lengths.iter().map(Number::to_ball).collect();
        Ok(motion)
    }

    /// a, a', a'', ... at the start of a segment.
    pub fn derivatives(&self, segment: usize) -> &[Ball] {
        let end = self.segments.get(segment + 1).map_or(self.derivatives.len(), |next| next.first);
        &self.derivatives[self.segments[segment].first..end]
    }
}

/// The index of a length among the known ones, the last of which are compared with it.
fn index(known: &mut Vec<Number>, length: Number) -> usize {
    let recent = known.len().saturating_sub(RECENT);
    if let Some(place) = known[recent..].iter().rposition(|other| *other == length) {
        return recent + place;
    }
    known.push(length);
    known.len() - 1
}

/// A walk through the pieces of all sources.
struct Course<'a> {
    sources: &'a [Source],
    /// For each source the number of its pieces that have begun.
    places: Vec<usize>,
    /// Order of the derivative of the displacement that the sources are.
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

    /// Adds the acceleration and its derivatives from now on to a list.
    fn acceleration(&self, now: &Number, list: &mut Vec<Ball>) {
        let (first, lower) = (list.len(), 2 - self.derivative);
        for (source, place) in self.sources.iter().zip(&self.places) {
            let Source::Pieces { pieces, .. } = source else { continue };
            let Some(piece) = place.checked_sub(1).map(|last| &pieces[last]) else { continue };
            let mut add = |k: usize, value: Ball| match list.get_mut(first + k) {
                Some(known) => *known = *known + value,
                None => list.push(value),
            };
            if piece.at == *now {
                let all = piece.derivatives.iter().skip(lower).enumerate();
                all.for_each(|(k, value)| add(k, value.to_ball()));
            } else {
                piece.at_time(now).into_iter().skip(lower).enumerate().for_each(|(k, value)| add(k, value));
            }
        }
        while list.len() > first && list.last().is_some_and(Ball::is_zero) {
            list.pop();
        }
    }
}
