//! How an output reaches its final value: the time after which it stays within a band, and how far it goes beyond. In: a
//! system, signals that end or last, an output and its final value. Out: a ball, proved for all times. See
//! docs/method/measures.md#settling-and-overshoot.
//!
//! Once the sources are constant, z - z_end obeys z' = A z alone, and |exp(A t)| <= G for all t >= 0 bounds everything
//! that is still to come by |c| G |z - z_end|. The course is followed until that is small enough.

use super::Run;
use super::course::{Block, MOST_PIECES, Next, Outcome, is_hopeless, stretch, stretches};
use crate::analysis::error::AnalysisError;
use crate::analysis::largest::{About, Largest};
use crate::base::{Ball, Dd, Number, Power, up};
use crate::system::{LinearSystem, Signal};

const UP: f64 = up::THOUSANDS;
const UNIT: f64 = 2.0 * Dd::EPSILON;
/// Motion still to come below this share of the final value is ignored.
const NEGLIGIBLE: f64 = 1e-20;
/// Maximum number of blocks that may hold the last crossing.
const MOST_CANDIDATES: usize = 256;
/// Maximum number of pieces that are evaluated in two words for the largest value.
const MOST_FINE: usize = 50_000;
/// Halvings of a piece, and intervals of one that are examined: a touch of the border at which the curve is flat.
const DEEPEST: usize = 100;
const MOST_INTERVALS: usize = 20_000;

/// The motion that is followed.
pub struct Approach<'a> {
    pub system: &'a LinearSystem,
    pub drives: &'a [Vec<Signal>],
    pub output: usize,
    /// The final value, which is not zero.
    pub end: Ball,
    /// A time by which everything should have decayed.
    pub until: &'a Number,
}

/// The result of following an output to its end.
#[derive(Clone, Copy, Debug)]
pub enum Found {
    Value(Ball),
    /// The output has an infinite value on its way.
    Infinite,
    /// It is not decided whether it has.
    Open,
    /// There are too many pieces.
    TooLong,
    /// It is not proved that the motion decays.
    Lasting,
}

impl Approach<'_> {
    /// The time after which |output - end| stays within `band` |end|, s from t = 0.
    pub fn settling(&self, band: &Number) -> Result<Found, AnalysisError> {
        let mut last = LastOutside { end: self.end, level: self.end.abs() * band.to_ball(), candidates: Vec::new() };
        let followed = self.follow(&mut |step| match step {
            Step::Block(block) => {
                last.examine(block);
                false
            }
            Step::ToCome(most) => most <= last.level.mignitude(),
        })?;
        Ok(followed.unwrap_or_else(|| Found::Value(last.time())))
    }

    /// The largest (output - end) / end, or zero if the output never goes beyond its end.
    pub fn overshoot(&self) -> Result<Found, AnalysisError> {
        let about = About::new(self.end);
        let (mut largest, mut fine) = (Largest::default(), MOST_FINE);
        let negligible = self.end.mignitude() * NEGLIGIBLE;
        let followed = self.follow(&mut |step| match step {
            Step::Block(block) => {
                block.bound(Some(&about), &mut largest, &mut fine);
                false
            }
            Step::ToCome(most) if largest.reaches(most) => true,
            Step::ToCome(most) if most <= negligible => {
                largest.at_most(most);
                true
            }
            Step::ToCome(_) => false,
        })?;
        Ok(followed.unwrap_or_else(|| Found::Value(largest.ball() / self.end.abs())))
    }

    /// Follows the course until `visit` returns true for the motion still to come; `None` if it did.
    fn follow(&self, visit: &mut dyn FnMut(Step) -> bool) -> Result<Option<Found>, AnalysisError> {
        let mut known = Vec::new();
        let (mut pieces, mut is_done, mut is_open) = (0.0, false, false);
        let outcome = stretches(self.system, self.drives, self.output, self.until, &mut |run, to| {
            let ahead = if to == self.until { Ahead::of(run, self.output) } else { None };
            is_open |= to == self.until && ahead.is_none();
            if is_open || is_hopeless(run, to) {
                return Ok(Outcome::TooLong);
            }
            let stretch = stretch(&mut known, run, self.output, to)?;
            stretch.follow(run, self.output, to, &mut |run, block| {
                is_done = ahead.as_ref().is_some_and(|ahead| visit(Step::ToCome(ahead.most(run))));
                pieces += block.pieces() as f64;
                if is_done || pieces > MOST_PIECES {
                    return Next::Nothing;
                }
                visit(Step::Block(block));
                Next::Block
            })?;
            let is_short = is_done || pieces <= MOST_PIECES;
            is_done = is_done || ahead.is_some_and(|ahead| visit(Step::ToCome(ahead.most(run))));
            Ok(if is_short { Outcome::ToTheEnd } else { Outcome::TooLong })
        })?;
        Ok(match outcome {
            _ if is_open => Some(Found::Lasting),
            Outcome::Infinite => Some(Found::Infinite),
            Outcome::Open => Some(Found::Open),
            Outcome::TooLong => Some(Found::TooLong),
            Outcome::ToTheEnd if is_done => None,
            Outcome::ToTheEnd => Some(Found::Lasting),
        })
    }
}

/// A step along the course: the next pieces, or a bound of |output - end| from now on.
enum Step<'a> {
    Block(&'a Block),
    ToCome(f64),
}

/// The free motion towards the end, once the sources are constant.
struct Ahead {
    end: Vec<Ball>,
    /// A bound of |c exp(A t)| for all t >= 0.
    factor: f64,
}

impl Ahead {
    /// `None` if a source is not constant, or if it is not proved that the motion decays.
    fn of(run: &mut Run, output: usize) -> Option<Ahead> {
        run.set_sources();
        if run.channels.iter().any(|channel| channel.states_on() > 1) || run.approximation_errors() != 0.0 {
            return None;
        }
        let mechanical = run.space.mechanical;
        let sources: Vec<Ball> = run.z[mechanical..].iter().map(|&w| Ball::new(w, run.source_error)).collect();
        let row = (0..mechanical).map(|i| run.outputs[(output, i)].magnitude().power(2)).sum::<f64>().sqrt() * UP;
        let states: Vec<usize> = (0..mechanical).collect();
        let growth = if mechanical == 0 { 0.0 } else { run.space.generator(&states).bound_for_all_times()? };
        Some(Ahead { end: run.space.equilibrium(&sources)?, factor: row * growth * UP })
    }

    /// A bound of |output - end| from now on.
    fn most(&self, run: &Run) -> f64 {
        let apart = run.z.iter().zip(&self.end).map(|(&z, &end)| (Ball::exact(z) - end).magnitude().power(2));
        self.factor * (apart.sum::<f64>().sqrt() * UP + run.trail.error) * UP
    }
}

/// The search for the last time at which |output - end| is at least `level`.
struct LastOutside {
    end: Ball,
    level: Ball,
    /// Blocks that may hold it, ascending in time: of those with a place that is certainly outside the last one, and
    /// later ones.
    candidates: Vec<Block>,
}

impl LastOutside {
    fn examine(&mut self, block: &Block) {
        let (mut may_be, mut is_certain) = (false, false);
        block.rough(&mut |_, terms, error| {
            let terms: Vec<Dd> = terms.iter().map(|&x| Dd::from(x)).collect();
            let last = self.in_piece(terms, error);
            may_be |= last.is_some();
            is_certain |= last.is_some_and(|last| last.certain.is_some());
        });
        if is_certain {
            self.candidates.clear();
        }
        if may_be {
            if self.candidates.len() == MOST_CANDIDATES {
                self.candidates.remove(0);
            }
            self.candidates.push(block.clone());
        }
    }

    fn in_piece(&self, mut terms: Vec<Dd>, error: f64) -> Option<Last> {
        let rounding = (terms[0].hi.abs() + self.end.magnitude()) * UNIT;
        terms[0] -= self.end.mid;
        last_above(&terms, (error + self.end.rad + rounding) * UP, self.level)
    }

    fn time(&self) -> Ball {
        let mut latest: Option<Ball> = None;
        for block in self.candidates.iter().rev() {
            let mut fine = block.fine();
            let pieces: Vec<(Vec<Dd>, f64)> = (0..block.pieces()).map(|piece| fine.piece(piece)).collect();
            for (piece, (terms, error)) in pieces.into_iter().enumerate().rev() {
                let Some(last) = self.in_piece(terms, error) else { continue };
                let high = *latest.get_or_insert_with(|| block.time(piece, last.latest));
                if let Some(certain) = last.certain {
                    return hull(block.time(piece, certain), high);
                }
            }
        }
        // Nothing is certainly outside: the beginning is not excluded.
        latest.map_or(Ball::ZERO, |high| hull(Ball::ZERO, high))
    }
}

/// A ball of everything between two numbers.
fn hull(low: Ball, high: Ball) -> Ball {
    let half = (high.mid - low.mid).scale(0.5);
    let rounding = high.magnitude() * UNIT;
    Ball::new(low.mid + half, (half.hi.abs() + low.rad + high.rad + rounding) * UP)
}

/// The last place of a piece at which its curve is at or above a level.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Last {
    /// Beyond it the curve is certainly below.
    latest: Dd,
    /// A place at which it is certainly not below.
    certain: Option<Dd>,
}

/// The last place in [0, 1] at which |sum terms[j] x^j|, known to within `error`, is at least `level`; `None` if it is
/// certainly below everywhere.
fn last_above(terms: &[Dd], error: f64, level: Ball) -> Option<Last> {
    let rough: Vec<f64> = terms.iter().map(|term| term.hi).collect();
    let size = rough.iter().map(|term| term.abs()).sum::<f64>() * UP;
    if size + error < level.mignitude() {
        return None;
    }
    let count = terms.len() as f64;
    let bend = rough.iter().enumerate().map(|(j, term)| (j * j.saturating_sub(1)) as f64 * term.abs()).sum::<f64>();
    let curve = Curve {
        terms,
        level: level.mid,
        unsure: (error + level.rad + (size + level.magnitude()) * (2.0 * count + 8.0) * UNIT) * UP,
        slope_unsure: size * count * (2.0 * count + 8.0) * f64::EPSILON,
        bend: bend * UP,
        rough,
    };
    let mut left = MOST_INTERVALS;
    curve.last(Dd::ZERO, 1.0, 0, &mut left)
}

struct Curve<'a> {
    terms: &'a [Dd],
    rough: Vec<f64>,
    level: Dd,
    /// A bound of the error of |curve| - level, and of the slope in binary64.
    unsure: f64,
    slope_unsure: f64,
    /// A bound of the second derivative.
    bend: f64,
}

impl Curve<'_> {
    /// |curve| - level
    fn excess(&self, x: Dd) -> f64 {
        let value = self.terms.iter().rev().fold(Dd::ZERO, |sum, &term| sum * x + term);
        (value.abs() - self.level).hi
    }

    /// The last place in [from, from + width].
    fn last(&self, from: Dd, width: f64, depth: usize, left: &mut usize) -> Option<Last> {
        let (middle, end) = (from + Dd::from(0.5 * width), from + Dd::from(width));
        if self.excess(end) > self.unsure {
            return Some(Last { latest: end, certain: Some(end) });
        }
        let slope = |x: f64| {
            let terms = self.rough.iter().enumerate().skip(1).rev();
            terms.fold(0.0, |sum, (j, term)| sum * x + j as f64 * term).abs() + self.slope_unsure
        };
        let above = self.excess(middle);
        let spread = (0.5 * slope(middle.hi) * width + self.bend * width * width / 8.0) * UP;
        if above + spread + self.unsure < 0.0 {
            return None;
        }
        *left = left.saturating_sub(1);
        if depth == DEEPEST || *left == 0 || spread <= 0.1 * self.unsure {
            return Some(Last { latest: end, certain: (above > self.unsure).then_some(middle) });
        }
        let right = self.last(middle, 0.5 * width, depth + 1, left);
        if right.is_some_and(|last| last.certain.is_some()) {
            return right;
        }
        let before = self.last(from, 0.5 * width, depth + 1, left);
        match (before, right) {
            (Some(before), Some(right)) => Some(Last { latest: right.latest, ..before }),
            (one, other) => one.or(other),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn terms(values: &[f64]) -> Vec<Dd> {
        values.iter().map(|&x| Dd::from(x)).collect()
    }

    /// 1 - x falls to a third at two thirds, 1e-29 exactly; with an error of a thousandth, that is known to a thousandth.
    #[test]
    fn the_last_place_is_enclosed() {
        let third = Ball::ONE / Ball::from(3.0);
        let truth = Ball::from(2.0) / Ball::from(3.0);
        let last = last_above(&terms(&[1.0, -1.0]), 0.0, third).expect("above a third at zero");
        let certain = last.certain.expect("above");
        assert!((last.latest - truth.mid).hi >= 0.0 && (truth.mid - certain).hi >= 0.0);
        assert!((last.latest - certain).hi < 1e-28);
        let rough = last_above(&terms(&[1.0, -1.0]), 1e-3, third).expect("above a third at zero");
        let certain = rough.certain.expect("above");
        assert!((rough.latest - truth.mid).hi >= 1e-3 && (truth.mid - certain).hi >= 1e-3);
        assert!((rough.latest - certain).hi < 4e-3);
        assert_eq!(last_above(&terms(&[0.2, 0.1]), 0.0, third), None);
        // The magnitude counts, and a curve that is above at its end is so up to there.
        let below = last_above(&terms(&[0.0, -1.0]), 0.0, third).expect("magnitude");
        assert_eq!(below, Last { latest: Dd::ONE, certain: Some(Dd::ONE) });
    }

    /// 1 - 4 (x - 1/2)^2 touches 1 at a half: neither is claimed, and the place is known to the root of the rounding.
    #[test]
    fn a_touch_is_not_decided() {
        let last = last_above(&terms(&[0.0, 4.0, -4.0]), 0.0, Ball::ONE).expect("may be reached");
        assert_eq!(last.certain, None);
        assert!(last.latest.hi >= 0.5 && last.latest.hi < 0.5 + 1e-13);
        assert_eq!(last_above(&terms(&[0.0, 4.0, -4.0]), 0.0, Ball::from(1.000001)), None);
        let clear = last_above(&terms(&[0.0, 4.0, -4.0]), 0.0, Ball::from(0.75)).expect("reached");
        assert!((clear.latest.hi - 0.75).abs() < 1e-15 && clear.certain.is_some());
    }
}
