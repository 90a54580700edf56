//! All extrema of |H| where H is a sum over poles. The frequencies are cut into intervals, each small beside the distance of
//! all poles but the nearest one, over which H is a Taylor polynomial, or one over the distance of that pole, with a bound of its
//! error. So is F = re(conj H dH/domega), whose changes of sign are the extrema: over each piece of an interval either its
//! numerator has no root, or its derivative has none and the signs at both ends decide. A pole on the axis is an infinite peak.
//! Pieces that stay open are reported. In: H, a range. Out: its extrema, with half-power widths. See
//! docs/method/transfer.md#extrema-from-sums-over-poles.

mod product;
mod widths;

use super::{Complete, Extrema, Extremum, FeatureKind};
use crate::analysis::derived::hertz;
use crate::analysis::transfer::partial_fractions::{Expander, Expansion, Local, Obstacle, PartialFractions};
use crate::analysis::transfer::{Disc, Gain};
use crate::base::{Ball, Dd, OrderBy, down, up};
use product::{CUT, Piece, Product};
use widths::Widths;

/// A range of frequencies, rad/s.
#[derive(Clone, Copy, Debug)]
struct Interval {
    low: Dd,
    high: Dd,
    /// The number of times that a piece stayed open and was expanded anew, in more digits.
    renewed: u32,
}

/// A root of F: an extremum and what is known about it.
#[derive(Clone, Copy, Debug)]
struct Located {
    omega: Ball,
    kind: FeatureKind,
    gain: Gain,
    /// An approximation of F' there.
    bend: f64,
}

/// The most intervals for each pole, and the least limit of all; a few are usual, some dozens next to an undamped pole.
const MOST_INTERVALS: [usize; 2] = [100, 20_000];
/// The most outside of the range, where only half-power points may lie.
const MOST_BEYOND: usize = 2_000;
/// Part of a frequency below which an interval is not cut next to a pole whose residue may be zero.
const LEAST_UNCERTAIN: f64 = 1e-9;
/// Number of times that a piece may be expanded anew.
const MOST_RENEWALS: u32 = 12;
/// Number of times that it may be for sharper bounds of a root alone.
const MOST_SHARPER: u32 = 3;
/// The most steps towards a root in binary64.
const MOST_STEPS: usize = 80;
/// The most steps in double-double.
const REFINEMENTS: usize = 6;

/// Every extremum between two frequencies, rad/s.
pub fn by_expansion(h: &PartialFractions, low: Ball, high: Ball) -> Extrema {
    if h.is_nothing() {
        return Extrema { list: Vec::new(), complete: Some(Complete(())), open: Vec::new() };
    }
    let (from, to) = ((low.to_f64() * down::FEW).max(0.0), high.to_f64() * up::FEW);
    let mut inside = Search::new(h, MOST_INTERVALS[1].max(MOST_INTERVALS[0] * h.count()));
    inside.search(from, to);
    // A half-power width may extend beyond the range.
    let mut below = Search::new(h, MOST_BEYOND);
    below.search(0.0, from);
    let mut above = Search::new(h, MOST_BEYOND);
    let top = (2.0 * to.max(2.0 * h.largest())).min(h.reach());
    above.search(to, top);
    let (located, gaps) = distinct([below.found, inside.found, above.found].concat());
    inside.open.extend(&gaps);
    let open = [&below.open[..], &inside.open, &above.open].concat();
    let within = |omega: Ball| !(omega - low).is_negative() && !(high - omega).is_negative();
    let widths = Widths { h, located: &located, open: &open, top };
    let list = (0..located.len())
        .filter(|&i| within(located[i].omega))
        .map(|i| Extremum {
            kind: located[i].kind,
            frequency: hertz(located[i].omega),
            gain: located[i].gain,
            width: if located[i].kind == FeatureKind::Peak { widths.of(i).map(hertz) } else { None },
        })
        .collect();
    let open = merge(inside.open);
    Extrema { list, complete: open.is_empty().then_some(Complete(())), open }
}

/// Intervals overlap by a rounding error, and a root there is found twice. Maxima and minima alternate: of two of a kind in a
/// row that are certainly apart one is missing between them: such gaps, rad/s.
fn distinct(found: Vec<Located>) -> (Vec<Located>, Vec<(f64, f64)>) {
    let (mut list, mut gaps): (Vec<Located>, Vec<(f64, f64)>) = (Vec::with_capacity(found.len()), Vec::new());
    for next in found {
        match list.last().filter(|last| last.kind == next.kind) {
            Some(last) if (next.omega - last.omega).contains_zero() => {}
            Some(last) => {
                gaps.push((last.omega.to_f64(), next.omega.to_f64()));
                list.push(next);
            }
            None => list.push(next),
        }
    }
    (list, gaps)
}

/// In Hz, with neighbours joined.
fn merge(mut open: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    open.order_by(|a, b| a.0.total_cmp(&b.0));
    let mut list: Vec<(f64, f64)> = Vec::new();
    for (from, to) in open {
        match list.last_mut().filter(|last| last.1 >= from * (1.0 - 1e-12)) {
            Some(last) => last.1 = last.1.max(to),
            None => list.push((from, to)),
        }
    }
    let hertz = |omega: f64| omega / (2.0 * std::f64::consts::PI);
    list.into_iter().map(|(from, to)| (hertz(from), hertz(to))).collect()
}

struct Search<'a> {
    h: &'a PartialFractions,
    expander: Expander<'a>,
    found: Vec<Located>,
    /// rad/s
    open: Vec<(f64, f64)>,
    left: usize,
}

impl Search<'_> {
    fn new(h: &PartialFractions, most: usize) -> Search<'_> {
        Search { h, expander: Expander::of(h), found: Vec::new(), open: Vec::new(), left: most }
    }

    fn search(&mut self, low: f64, high: f64) {
        let has_width = low < high;
        if !has_width {
            return;
        }
        let mut stack = vec![Interval { low: low.into(), high: high.into(), renewed: 0 }];
        while let Some(interval) = stack.pop() {
            let width = (interval.high - interval.low).to_f64();
            let is_divisible = width > interval.high.to_f64() * 1e-28;
            if self.left == 0 || !is_divisible || interval.renewed > MOST_RENEWALS {
                self.open.push((interval.low.to_f64().next_down(), interval.high.to_f64().next_up()));
                continue;
            }
            // An expansion in double-double takes some ten times as long.
            self.left = self.left.saturating_sub(if interval.renewed > 0 { 10 } else { 1 });
            // From zero on, |H| is even and F odd: the interval is taken on both sides of it.
            let from_zero = interval.low.is_zero();
            let (middle, half) = match from_zero {
                true => (Dd::ZERO, width),
                false => ((interval.low + interval.high).scale(0.5), 0.5 * width),
            };
            // Covers the rounding of both.
            let half = half * up::DOZENS + middle.hi * 4.0 * Dd::EPSILON;
            let expansion = match self.expander.expansion(middle, half, interval.renewed > 0) {
                Ok(expansion) => expansion,
                Err(obstacle) => {
                    let high = interval.high.to_f64();
                    let is_uncertain = obstacle == Obstacle::Uncertain && width < high * LEAST_UNCERTAIN;
                    let is_at_zero = from_zero && self.h.is_infinite_at_zero();
                    if is_uncertain || (is_at_zero && width < self.h.largest() * LEAST_UNCERTAIN) {
                        self.open.push((interval.low.to_f64().next_down().max(0.0), high.next_up()));
                    } else {
                        stack.extend(cut(interval));
                    }
                    continue;
                }
            };
            let product = Product::of(&expansion);
            if from_zero {
                if !product.piece(0.0, 1.0).is_monotone() {
                    stack.extend(cut(Interval { renewed: interval.renewed + 1, ..interval }));
                }
                continue;
            }
            if let Some(omega) = expansion.infinite_at()
                && !(omega - Ball::exact(interval.low)).is_negative()
                && !(omega - Ball::exact(interval.high)).is_positive()
            {
                // Its numerator is not zero there, so that F has no root next to it.
                self.found.push(Located { omega, kind: FeatureKind::Peak, gain: Gain::Infinite, bend: 0.0 });
            }
            let (roots, left) = product.roots();
            let at = Cell { h: self.h, middle, half, expansion: &expansion, product: &product };
            let renewed = interval.renewed + 1;
            let again = |piece: &Piece| Interval { low: at.omega(piece.low()), high: at.omega(piece.high()), renewed };
            for root in roots {
                match at.locate(&root, interval.renewed < MOST_SHARPER) {
                    Ok(located) => self.found.push(located),
                    Err(part) => stack.push(again(&part)),
                }
            }
            for piece in left.iter().rev().map(|piece| (piece, again(piece))) {
                // In double-double and in a smaller interval, F would drown in the same error.
                if interval.renewed > 0 && piece.0.value.abs() + piece.0.swing < product.noise {
                    self.open.push((piece.1.low.to_f64(), piece.1.high.to_f64()));
                } else {
                    stack.push(piece.1);
                }
            }
        }
        self.found.order_by(|a, b| a.omega.to_f64().total_cmp(&b.omega.to_f64()));
    }
}

/// Both parts, the lower one last.
fn cut(interval: Interval) -> [Interval; 2] {
    let at = interval.low + (interval.high - interval.low) * Dd::from(CUT);
    [Interval { low: at, ..interval }, Interval { high: at, ..interval }]
}

/// An interval with its polynomials.
struct Cell<'a> {
    h: &'a PartialFractions,
    middle: Dd,
    half: f64,
    expansion: &'a Expansion,
    product: &'a Product,
}

impl Cell<'_> {
    fn omega(&self, t: f64) -> Dd {
        self.middle + Dd::product(self.half, t)
    }

    /// The only root in a piece, with H there; the part of the piece that it is in if there is no bound of its distance, or,
    /// where `may_renew`, if one in more digits would be far sharper.
    fn locate(&self, piece: &Piece, may_renew: bool) -> Result<Located, Piece> {
        let start = self.product.bisect(piece, piece.slope > 0.0);
        // Close to the root the derivative varies less, and the bound of the root's distance is sharper.
        let half = piece.half * (1.0 / 64.0);
        let near = self.product.piece(start.clamp(piece.low() + half, piece.high() - half), half);
        let certain = near.is_monotone() && self.product.sign(near.low()) * self.product.sign(near.high()) < 0;
        let piece = if certain { &near } else { piece };
        // Beside a pole of small residue most of the slope may be uncertain.
        if may_renew && piece.least_slope() < 0.5 * piece.slope.abs() {
            return Err(*piece);
        }
        // Not if the pole is in it.
        let is_positive = self.expansion.is_weight_positive(piece.low(), piece.high()).ok_or(*piece)?;
        let rising = (piece.slope > 0.0) == is_positive;
        // The polynomial's own root is good to what it leaves out: the secant through two points makes the rest fast.
        let mut bend = near.slope / self.half;
        let mut omega = self.omega(start);
        let mut local = self.h.at(omega);
        let (mut f, mut error) = self.value(&local, omega);
        for _ in 0..REFINEMENTS {
            let next = omega - f / Dd::from(bend);
            let inside = next > self.omega(piece.low()) && next < self.omega(piece.high());
            let step = (next - omega).to_f64();
            if !inside || f.to_f64().abs() <= 2.0 * error || step == 0.0 {
                break;
            }
            let before = f;
            (omega, local) = (next, self.h.at(next));
            (f, error) = self.value(&local, omega);
            let secant = (f - before).to_f64() / step;
            if (secant / bend - 1.0).abs() < 0.5 {
                bend = secant;
            }
        }
        // By the mean value theorem.
        let reach = (f.to_f64().abs() + error) / (piece.least_slope() / self.half) * up::FEW;
        let reach = reach + omega.hi * 4.0 * Dd::EPSILON;
        if !reach.is_finite() {
            return Err(*piece);
        }
        let size = local.h.to_f64().abs() * up::FEW + local.errors[0];
        let steeper = self.expansion.most_bend(omega, reach, size);
        let steepest = local.slope.to_f64().abs() + local.errors[1] + reach * steeper;
        let radius = (local.errors[0] + reach * steepest) * up::DOZENS;
        let kind = if rising { FeatureKind::Antiresonance } else { FeatureKind::Peak };
        let disc = if self.is_zero_in(piece) { Disc::ZERO } else { Disc { value: local.h, radius } };
        let bend = bend / (self.half * self.expansion.weight(omega).0.to_f64());
        Ok(Located { omega: Ball::new(omega, reach), kind, gain: Gain::Finite(disc), bend })
    }

    /// The polynomial's value from H and its slope, and a bound of its error.
    fn value(&self, local: &Local, omega: Dd) -> (Dd, f64) {
        let ((f, error), (weight, doubt)) = (slope_of(local), self.expansion.weight(omega));
        let size = weight.to_f64().abs() * self.half * up::FEW;
        (f * weight * Dd::from(self.half), (error + f.to_f64().abs() * (doubt + 8.0 * Dd::EPSILON)) * size * up::FEW)
    }

    /// Whether H itself is zero somewhere in a piece: real or imaginary, and of different signs at both ends.
    fn is_zero_in(&self, piece: &Piece) -> bool {
        let sign = |t: f64| {
            let (value, error) = self.expansion.value(t);
            let value = self.h.only_part(value)?;
            (value.abs() > error).then_some(value > 0.0)
        };
        matches!((sign(piece.low()), sign(piece.high())), (Some(low), Some(high)) if low != high)
    }
}

/// F and a bound of its error.
fn slope_of(local: &Local) -> (Dd, f64) {
    let Local { h, slope, errors } = local;
    let [h0, h1] = [h, slope].map(|z| z.to_f64().abs() * up::FEW);
    let error = h0 * errors[1] + h1 * errors[0] + errors[0] * errors[1] + 8.0 * Dd::EPSILON * h0 * h1;
    (h.re * slope.re + h.im * slope.im, error * up::DOZENS + f64::MIN_POSITIVE)
}

#[cfg(test)]
mod tests;
