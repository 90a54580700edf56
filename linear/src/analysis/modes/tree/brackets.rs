//! Brackets of the eigenvalues of a tree, by counting the eigenvalues below many shifts at once, in binary64.
//!
//! A count at s is exact for some shift s (1 +- eta): each number of an elimination takes part in at most breadth + 12
//! roundings, and those of a branch are relative changes of all its numbers. See docs/method/modes.md#large-trees.

use crate::analysis::modes::request::Band;
use crate::analysis::modes::tree::bounds::Frame;
use crate::analysis::modes::tree::forest::{Forest, Node};
use crate::analysis::modes::tree::impedance::{LANES, counts};
use crate::base::{OrderBy, Power};
use crate::kernel::real::Float;
use std::ops::Range;

/// An interval with one eigenvalue.
#[derive(Clone, Copy, Debug)]
pub struct Bracket {
    pub low: f64,
    pub high: f64,
}

impl Bracket {
    pub fn middle(&self) -> f64 {
        0.5 * (self.low + self.high)
    }

    pub fn contains(&self, s: f64) -> bool {
        (self.low..=self.high).contains(&s)
    }
}

const MAX_PASSES: usize = 400;
/// Shifts in one pass for each eigenvalue that is sought in an interval.
const SHIFTS: usize = 3;
/// Intervals whose ends have at least this ratio are divided geometrically, others evenly in the square roots of their
/// ends: that is how the eigenvalues of long chains are distributed.
const FAR: f64 = 16.0;
/// Eigenvalues smaller than this part of the largest are not sought (see [`LARGEST`](super::forest::LARGEST)).
const LEAST: f64 = 1e-150;

/// The state of separating eigenvalues.
pub struct Brackets<'a> {
    nodes: &'a [Node<f64>],
    /// Relative change of the shift for which a count is exact.
    pub eta: f64,
    /// An upper bound of all eigenvalues.
    highest: f64,
    /// 1 if there is a rigid motion.
    rigid: i64,
    /// Shifts with the number of eigenvalues below them, ascending.
    points: Vec<(f64, i64)>,
}

impl<'a> Brackets<'a> {
    pub fn new(forest: &Forest, nodes: &'a [Node<f64>]) -> Brackets<'a> {
        let (depth, breadth) = forest.depth_and_breadth();
        let rounding = (depth as f64 + 1.0) * (breadth as f64 + 12.0) * f64::ERROR;
        let eta = forest.eigenvalue_sensitivity(rounding + forest.uncertainty);
        let highest = highest(nodes) * forest.coupled;
        Brackets { nodes, eta, highest, rigid: i64::from(forest.floats), points: Vec::new() }
    }

    /// The numbers, counted from the first elastic mode, of the modes that may lie in the band.
    pub fn numbers(&mut self, band: Band) -> Option<Range<usize>> {
        let slack = 8.0 * self.eta + 16.0 * f64::EPSILON;
        let least = self.highest * LEAST;
        let low = (band.from * band.from * (1.0 - slack)).max(least);
        let high = (band.to * band.to * (1.0 + slack)).max(least);
        self.count(&[low, high])?;
        let below = |s: f64| self.points.iter().find(|point| point.0 == s).map_or(0, |point| point.1);
        let number = |s: f64| (below(s) - self.rigid).max(0) as usize;
        Some(number(low)..number(high).max(number(low)))
    }

    /// Brackets of the eigenvalues with these numbers, as narrow as `narrow` relative to the distance of their
    /// neighbours. The first eigenvalue of all is also enclosed within a factor. `None` if eigenvalues are too close
    /// together.
    pub fn narrow(&mut self, wanted: &Range<usize>, narrow: f64) -> Option<Vec<Bracket>> {
        let (from, to) = (self.rigid + wanted.start as i64, self.rigid + wanted.end as i64);
        if self.points.len() < LANES {
            let (low, high) = (self.highest * LEAST, self.highest);
            let places: Vec<f64> =
                (0..LANES).map(|at| interpolate(low, high, at as f64 / (LANES - 1) as f64)).collect();
            self.count(&places)?;
        }
        if self.points[0].1 != self.rigid {
            return None;
        }
        for _ in 0..MAX_PASSES {
            let open = self.open_intervals(from, to, narrow)?;
            if open.is_empty() {
                break;
            }
            let places = self.places(&open);
            self.count(&places)?;
        }
        let single =
            self.points.windows(2).filter(|pair| pair[1].1 == pair[0].1 + 1 && (from..to).contains(&pair[0].1));
        let brackets: Vec<Bracket> = single.map(|pair| Bracket { low: pair[0].0, high: pair[1].0 }).collect();
        (brackets.len() == wanted.len()).then_some(brackets)
    }

    /// The bounds of the other eigenvalues that Kato and Temple's bounds of the k-th bracket need.
    pub fn frame(&self, brackets: &[Bracket], k: usize) -> Frame {
        let above = |b: &Bracket| b.low * (1.0 - 2.0 * self.eta);
        let below = |b: &Bracket| b.high * (1.0 + 2.0 * self.eta);
        let first = self.below_all() * (1.0 - 2.0 * self.eta);
        let floats = self.rigid > 0;
        let previous = if k > 0 { Some(below(&brackets[k - 1])) } else { floats.then_some(0.0) };
        let holding = if floats { first } else { 0.0 };
        Frame { previous, next: brackets.get(k + 1).map(above), holding, least: first }
    }

    /// A shift below all elastic eigenvalues, and close to the first one.
    fn below_all(&self) -> f64 {
        let without = self.points.iter().take_while(|point| point.1 <= self.rigid);
        without.last().map_or(0.0, |point| point.0)
    }

    fn count(&mut self, places: &[f64]) -> Option<()> {
        for chunk in places.chunks(LANES) {
            let mut lanes = [chunk[0]; LANES];
            lanes[..chunk.len()].copy_from_slice(chunk);
            let counted = counts(self.nodes, lanes)?;
            self.points.extend(chunk.iter().copied().zip(counted));
        }
        self.points.order_by(|a, b| a.0.total_cmp(&b.0));
        self.points.dedup();
        Some(())
    }

    /// Intervals between points that contain wanted eigenvalues and are not narrow, with the number of these
    /// eigenvalues; `None` if some cannot be separated.
    fn open_intervals(&self, from: i64, to: i64, narrow: f64) -> Option<Vec<(usize, usize)>> {
        let mut open = Vec::new();
        for i in 0..self.points.len() - 1 {
            let ((low, below), (high, above)) = (self.points[i], self.points[i + 1]);
            let first = below <= self.rigid && above > self.rigid;
            if first && high > 1.2 * low {
                open.push((i, 1.max(above.min(to) - self.rigid) as usize));
                continue;
            }
            if above <= from || below >= to || above <= below {
                continue;
            }
            if above > below + 1 && high - low <= 8.0 * self.eta * high {
                return None;
            }
            // A bracket of half this width could be wrong by eta at either end.
            let least = 4.0 * self.eta * high;
            if above > below + 1 || high - low > (narrow * self.gap_around(i).min(low)).max(least) {
                open.push((i, (above.min(to) - below.max(from)) as usize));
            }
        }
        Some(open)
    }

    /// The distance from interval i to the neighbouring eigenvalues: at least one interval without any lies between.
    fn gap_around(&self, i: usize) -> f64 {
        let points = &self.points;
        let below = (0..i).rev().find(|&j| points[j].1 < points[i].1).map(|j| points[i].0 - points[j + 1].0);
        let above =
            (i + 2..points.len()).find(|&j| points[j].1 > points[i + 1].1).map(|j| points[j - 1].0 - points[i + 1].0);
        below.unwrap_or(f64::INFINITY).min(above.unwrap_or(f64::INFINITY))
    }

    /// Shifts within the intervals, filling all lanes.
    fn places(&self, open: &[(usize, usize)]) -> Vec<f64> {
        let share = |&(i, count): &(usize, usize)| match self.points[i + 1].0 > FAR * self.points[i].0 {
            // Nothing is known about their positions yet.
            true => (SHIFTS * count).min(LANES),
            false => SHIFTS * count,
        };
        let wanted: usize = open.iter().map(share).sum();
        let lanes = wanted.next_multiple_of(LANES);
        let mut places = Vec::with_capacity(lanes + open.len());
        let (mut seen, mut given) = (0, 0);
        for interval in open {
            seen += share(interval);
            let share = (lanes * seen / wanted - given).max(1);
            given += share;
            let i = interval.0;
            let (low, high) = (self.points[i].0, self.points[i + 1].0);
            places.extend((1..=share).map(|part| interpolate(low, high, part as f64 / (share + 1) as f64)));
        }
        places
    }
}

/// A point between two shifts.
fn interpolate(low: f64, high: f64, part: f64) -> f64 {
    let place = match high > FAR * low {
        // The bits of positive numbers grow like their logarithms, and are the same on every machine.
        true => f64::from_bits(low.to_bits() + (part * (high.to_bits() - low.to_bits()) as f64) as u64),
        false => {
            let (from, to) = (low.sqrt(), high.sqrt());
            (from + part * (to - from)).power(2)
        }
    };
    place.clamp(low, high)
}

/// An upper bound of all eigenvalues if inertia is not coupled: max (g + 2 sum k) / r by Gershgorin's theorem on M^-1
/// K.
fn highest(nodes: &[Node<f64>]) -> f64 {
    let mut row: Vec<f64> = nodes.iter().map(|node| node.ground).collect();
    for (i, node) in nodes.iter().enumerate() {
        row[i] += 2.0 * node.stiffness;
        row[node.parent as usize] += 2.0 * node.stiffness;
    }
    row.iter().zip(nodes).map(|(row, node)| row / node.mass).fold(0.0, f64::max) * 1.02
}
