//! All sign changes of g: the frequencies from zero up are cut into intervals, each seen from its nearest anchor, until
//! in each either g has no root, or g' has none and the signs of g at the ends decide whether g has one. Intervals that
//! stay open are reported. In: anchors. Out: brackets with one extremum each. See docs/method/transfer.md#extrema.

use super::slope::Anchor;
use crate::base::up;

/// A range of frequencies, as distances from an anchor, rad/s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    pub anchor: usize,
    pub low: f64,
    pub high: f64,
}

/// An extremum of |H|.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Found {
    /// The only extremum in an interval over which g is monotone; `rising` if it is a minimum.
    Bracket { within: Interval, rising: bool },
    /// A zero or a pole on the imaginary axis, at the anchor: |H| is zero (`rising`) or infinite.
    Singular { anchor: usize, rising: bool },
}

/// Everything that was found, ascending, and the intervals in which nothing is proved.
#[derive(Clone, Debug, Default)]
pub struct Search {
    pub segments: Vec<Interval>,
    pub found: Vec<Found>,
    pub open: Vec<Interval>,
    range: (f64, f64),
    cells: usize,
    beyond: usize,
}

/// The most intervals that are examined; a few dozen for each root are usual.
const MOST_CELLS: usize = 200_000;
/// Limit of intervals outside the range, where only half-power points may lie.
const MOST_BEYOND: usize = 5_000;
/// The position at which an interval is cut: not the middle, where models with round numbers have their extrema.
const CUT: f64 = 0.4871;

/// Searches from zero to `top`, rad/s; outside `range` fewer intervals are allowed.
pub fn search(anchors: &[Anchor], top: f64, range: (f64, f64)) -> Search {
    let mut search = Search { segments: segments(anchors, top), range, ..Search::default() };
    for segment in search.segments.clone() {
        search.segment(&anchors[segment.anchor], segment);
    }
    search
}

/// The frequencies nearest to each anchor; neighbours overlap by a rounding error.
fn segments(anchors: &[Anchor], top: f64) -> Vec<Interval> {
    let mut low = 0.0;
    let mut list = Vec::with_capacity(anchors.len());
    for (i, anchor) in anchors.iter().enumerate() {
        let Some(next) = anchors.get(i + 1) else {
            list.push(Interval { anchor: i, low, high: (top - anchor.approximate(0.0)).max(1e-3 * top) });
            break;
        };
        let gap = anchor.distance_to(next);
        let high = (1.0 - CUT) * gap.to_f64();
        list.push(Interval { anchor: i, low, high });
        low = (crate::base::Dd::from(high) - gap.mid).to_f64().next_down() - gap.rad;
    }
    list
}

impl Search {
    fn segment(&mut self, anchor: &Anchor, whole: Interval) {
        let Some(weight) = anchor.singular() else { return self.intervals(anchor, whole) };
        // With another root about the same place, all but a neighbourhood of it may be settled.
        let Some(reach) = dominated_radius(anchor, weight, whole) else { return self.intervals(anchor, whole) };
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

    /// Counts an interval that is cut, and returns whether the limit is exceeded.
    fn is_spent(&mut self, anchor: &Anchor, interval: Interval) -> bool {
        let inside =
            anchor.approximate(interval.high) >= self.range.0 && anchor.approximate(interval.low) <= self.range.1;
        let (count, most) = if inside { (&mut self.cells, MOST_CELLS) } else { (&mut self.beyond, MOST_BEYOND) };
        *count += 1;
        *count > most
    }

    /// Records the extremum, if any, of an interval in which g is monotone; `false` if the sign at an end is not
    /// certain.
    fn decide(&mut self, anchor: &Anchor, within: Interval) -> bool {
        if within.anchor == 0 && within.low == 0.0 && anchor.is_odd {
            return true;
        }
        let (low, high) = (anchor.sign(within.low), anchor.sign(within.high));
        if low != 0 && high != 0 && low != high {
            self.found.push(Found::Bracket { within, rising: low < 0 });
        }
        low != 0 && high != 0
    }
}

/// The distance from a singular root within which its term w / t outweighs all others of g, so that g has no root
/// there.
fn dominated_radius(anchor: &Anchor, weight: f64, whole: Interval) -> Option<f64> {
    let mut reach = if whole.low < 0.0 { whole.high.min(-whole.low) } else { whole.high };
    while reach > f64::MIN_POSITIVE {
        let rest = anchor.cell(0.0, reach, false).magnitude_bound();
        if rest * reach * up::THOUSANDS < weight.abs() {
            return Some(reach);
        }
        reach *= 0.25;
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    use crate::analysis::transfer::extrema::Factored;
    use crate::analysis::transfer::extrema::far::Far;
    use crate::analysis::transfer::extrema::roots::{Place, Root};
    use crate::analysis::transfer::extrema::slope::anchors;
    use crate::base::Ball;
    use crate::kernel::big_float::{ComplexFloat, Float};

    fn root(re: f64, im: f64, radius: f64, multiplicity: usize, place: Place) -> Root {
        let centre = ComplexFloat::new(Float::from(re), Float::from(im));
        Root { centre, radius: Float::from(radius), multiplicity, place }
    }

    fn start_search(zeros: Vec<Root>, poles: Vec<Root>) -> (Vec<Anchor>, Search) {
        let anchors = anchors(&Factored { lead: Ball::ONE, unit: 1.0, zeros, poles, far: Far::NONE });
        let search = search(&anchors, 10.0, (0.0, 10.0));
        (anchors, search)
    }

    /// Whether a frequency is in a bracket or in an open interval.
    fn is_held(anchors: &[Anchor], search: &Search, omega: f64) -> bool {
        let brackets = search.found.iter().filter_map(|found| match found {
            Found::Bracket { within, .. } => Some(within),
            Found::Singular { .. } => None,
        });
        brackets.chain(&search.open).any(|interval| {
            let [low, high] = [interval.low, interval.high].map(|t| anchors[interval.anchor].approximate(t));
            (low..=high).contains(&omega)
        })
    }

    /// Poles at -1 +- 2i have their peak at sqrt 3. Whatever their uncertainty, it is found or left open.
    #[test]
    fn a_peak_is_found_or_left_open() {
        for radius in [0.0, 1e-12, 1e-6, 1e-3, 0.1, 0.5] {
            let (anchors, search) = start_search(Vec::new(), vec![root(-1.0, 2.0, radius, 1, Place::Pair)]);
            assert!(is_held(&anchors, &search, 3f64.sqrt()), "{radius} {search:?}");
            assert!(radius > 0.0 || search.open.is_empty(), "{search:?}");
        }
    }

    /// 1 / ((s^2 + 1)(s - p)^2 (s - p*)^2 ...) with p = -1e-4 + 1.1i: |H| is infinite at 1 and has a valley near 1.033,
    /// at a third of the distance to 1.1.
    #[test]
    fn a_minimum_next_to_an_undamped_pole_is_found() {
        let poles = vec![root(0.0, 1.0, 0.0, 1, Place::Axis), root(-1e-4, 1.1, 0.0, 2, Place::Pair)];
        let (anchors, search) = start_search(Vec::new(), poles);
        assert!(search.open.is_empty(), "{search:?}");
        let (mut low, mut high) = (1.0, 1.1);
        // The derivative of ln |H| over omega.
        let slope = |w: f64| {
            let of =
                |re: f64, im: f64| -(w - im) / ((w - im).powi(2) + re * re) - (w + im) / ((w + im).powi(2) + re * re);
            of(0.0, 1.0) + 2.0 * of(1e-4, 1.1)
        };
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if slope(middle) < 0.0 { low = middle } else { high = middle }
        }
        assert!((low - 1.033).abs() < 2e-3 && is_held(&anchors, &search, low), "{low} {search:?}");
    }

    /// A zero that may coincide with an undamped pole leaves its whole neighbourhood open.
    #[test]
    fn a_pole_that_a_zero_may_cancel_is_left_open() {
        let zero = root(-1e-3, 1.0, 1e-3, 1, Place::Pair);
        let (_, search) = start_search(vec![zero], vec![root(0.0, 1.0, 0.0, 1, Place::Axis)]);
        let about_the_pole = |open: &Interval| open.anchor == 1 && open.low < 0.0 && open.high > 0.0;
        assert!(search.found.is_empty() && search.open.iter().any(about_the_pole), "{search:?}");
    }
}
