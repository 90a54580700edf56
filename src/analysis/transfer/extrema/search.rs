//! Where g changes its sign, all of it: the frequencies from zero up are cut into intervals, each seen from the anchor next to it,
//! until in each g has no root, or g' has none and the signs of g at the ends tell whether g has one. What stays open is told.
//! In: anchors. Out: brackets with one extremum each. Clause: spec.md 11a.6a.

use super::slope::Anchor;

/// A part of the frequencies, by distances from an anchor, rad/s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    pub anchor: usize,
    pub low: f64,
    pub high: f64,
}

/// An extremum of |H|.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Found {
    /// Alone in an interval over which g is monotone; `rising` where it is a minimum.
    Bracket { within: Interval, rising: bool },
    /// A zero or a pole on the imaginary axis, at the anchor: |H| is zero (`rising`) or infinite.
    Singular { anchor: usize, rising: bool },
}

/// All that was found, ascending, and where nothing is proved.
#[derive(Clone, Debug, Default)]
pub struct Search {
    pub segments: Vec<Interval>,
    pub found: Vec<Found>,
    pub open: Vec<Interval>,
    range: (f64, f64),
    cells: usize,
    beyond: usize,
}

/// More intervals than this are not looked at: a few dozen for each root are usual.
const MOST_CELLS: usize = 200_000;
/// The same outside the range, where only half-power widths may lie.
const MOST_BEYOND: usize = 5_000;
/// Where an interval is cut: not in the middle, where models with round numbers have their extrema.
const CUT: f64 = 0.4871;

/// From zero to `top`, rad/s; most care is taken within the range.
pub fn search(anchors: &[Anchor], top: f64, range: (f64, f64)) -> Search {
    let mut search = Search { segments: segments(anchors, top), range, ..Search::default() };
    for segment in search.segments.clone() {
        search.segment(&anchors[segment.anchor], segment);
    }
    search
}

/// The frequencies nearest to each anchor; neighbours overlap by a rounding.
fn segments(anchors: &[Anchor], top: f64) -> Vec<Interval> {
    let mut low = 0.0;
    let mut list = Vec::with_capacity(anchors.len());
    for (i, anchor) in anchors.iter().enumerate() {
        let Some(next) = anchors.get(i + 1) else {
            list.push(Interval { anchor: i, low, high: (top - anchor.near(0.0)).max(1e-3 * top) });
            break;
        };
        let gap = anchor.to(next);
        let high = (1.0 - CUT) * gap.to_f64();
        list.push(Interval { anchor: i, low, high });
        low = (crate::base::Dd::from(high) - gap.mid).to_f64().next_down() - gap.rad;
    }
    list
}

impl Search {
    fn segment(&mut self, anchor: &Anchor, whole: Interval) {
        let Some(weight) = anchor.singular() else { return self.intervals(anchor, whole) };
        let Some(reach) = alone_within(anchor, weight, whole) else {
            self.open.push(whole);
            return;
        };
        if whole.low < -reach {
            self.intervals(anchor, Interval { high: -reach, ..whole });
        }
        self.found.push(Found::Singular { anchor: whole.anchor, rising: weight > 0.0 });
        if whole.high > reach {
            self.intervals(anchor, Interval { low: reach, ..whole });
        }
    }

    fn intervals(&mut self, anchor: &Anchor, whole: Interval) {
        let mut left = vec![whole];
        while let Some(interval) = left.pop() {
            let Interval { low, high, .. } = interval;
            let half = 0.5 * (high - low) * (1.0 + f64::EPSILON);
            let cell = anchor.cell(0.5 * low + 0.5 * high, half, true);
            if cell.has_no_root() {
                continue;
            }
            if cell.is_monotone() && self.decide(anchor, interval) {
                continue;
            }
            let cut = low + CUT * (high - low);
            let fine = !(low < cut && cut < high) || cell.is_noise() || anchor.is_too_fine(0.5 * (low + high), half);
            if fine || self.is_spent(anchor, interval) {
                self.open.push(interval);
                continue;
            }
            left.push(Interval { low: cut, ..interval });
            left.push(Interval { high: cut, ..interval });
        }
    }

    /// Counts an interval that is cut, and tells whether it was one too many.
    fn is_spent(&mut self, anchor: &Anchor, interval: Interval) -> bool {
        let inside = anchor.near(interval.high) >= self.range.0 && anchor.near(interval.low) <= self.range.1;
        let (count, most) = if inside { (&mut self.cells, MOST_CELLS) } else { (&mut self.beyond, MOST_BEYOND) };
        *count += 1;
        *count > most
    }

    /// What an interval holds in which g is monotone; false where the sign at an end is not certain.
    fn decide(&mut self, anchor: &Anchor, within: Interval) -> bool {
        // g is odd: at zero it is zero.
        if within.anchor == 0 && within.low == 0.0 {
            return true;
        }
        let (low, high) = (anchor.sign(within.low), anchor.sign(within.high));
        if low != 0 && high != 0 && low != high {
            self.found.push(Found::Bracket { within, rising: low < 0 });
        }
        low != 0 && high != 0
    }
}

/// How far about a singular root w / t outweighs all the rest of g, which then has no root there.
fn alone_within(anchor: &Anchor, weight: f64, whole: Interval) -> Option<f64> {
    let mut reach = if whole.low < 0.0 { whole.high.min(-whole.low) } else { whole.high };
    while reach > f64::MIN_POSITIVE {
        let rest = anchor.cell(0.0, reach, false).most();
        if rest * reach * (1.0 + 1e-12) < weight.abs() {
            return Some(reach);
        }
        reach *= 0.25;
    }
    None
}
