//! The proof that a range holds no other root. In: the roots that were found, each between two numbers on different sides, and
//! what is known of the measure over parts of the range. Out: a proof, or the parts that could not be settled, and parts where
//! roots were missed. Clause: spec.md, "Measures, `solve`, `require`".
//!
//! A part is settled where an enclosure of the measure does not hold what is asked, or where the measure only rises or only
//! falls and lies on one side at both ends. Other parts are halved, as long as the effort allows.

use super::over::Over;
use crate::base::{Ball, Dd};
use std::cmp::Ordering;

/// A part of a range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Part {
    pub low: Dd,
    pub high: Dd,
}

/// What is known of the rest of a range besides the roots that were found.
#[derive(Clone, Debug, PartialEq)]
pub enum Rest {
    /// There is no other root in it.
    Empty(Proof),
    /// These parts were not settled; elsewhere there is none.
    Open(Vec<Part>),
    /// The measure is not enclosed over ranges: nothing is known beside the values that were tried.
    Unknown,
}

/// Made by [`cover`] alone, where all of a range was settled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Proof(());

/// Looks that say nothing at all, after which the measure counts as one that is not enclosed.
const SILENT: usize = 48;
/// Parts that are told.
const MOST_PARTS: usize = 8;

/// What settling parts of a range needs.
pub struct Cover<'a> {
    /// The measure over a part.
    pub over: &'a dyn Fn(Ball) -> Over,
    /// On which side the measure lies at a number, for certain; equal where that is not certain.
    pub side: &'a dyn Fn(Dd) -> Option<Ordering>,
    /// Parts that are looked at, at most.
    pub most: usize,
}

/// What became of the parts.
pub struct Covered {
    pub rest: Rest,
    /// Parts at whose ends the measure lies on different sides: they hold roots that were not known.
    pub missed: Vec<Part>,
    pub looks: usize,
}

impl Rest {
    /// A proof, where no part is left open.
    pub fn emptied(self) -> Rest {
        match self {
            Rest::Open(parts) if parts.is_empty() => Rest::Empty(Proof(())),
            rest => rest,
        }
    }
}

impl Cover<'_> {
    /// Settles these parts: what lies between the brackets of the known roots.
    pub fn settle(&self, parts: Vec<Part>) -> Covered {
        let (mut open, mut missed) = (Vec::new(), Vec::new());
        let (mut looks, mut silent, mut heard) = (0, 0, false);
        // Breadth first, so that what is left is small everywhere.
        let mut waiting = std::collections::VecDeque::from(parts);
        while let Some(part) = waiting.pop_front() {
            if looks >= self.most || !heard && silent >= SILENT {
                open.push(part);
                continue;
            }
            looks += 1;
            let over = (self.over)(part.ball());
            if over.is_silent() {
                // Measures that are never enclosed need no second look.
                silent += if over.is_hopeless() { SILENT } else { 1 };
            } else {
                heard = true;
            }
            if over.excludes() {
                continue;
            }
            if over.is_monotone() {
                match ((self.side)(part.low), (self.side)(part.high)) {
                    (Some(a), Some(b)) if a == b && a != Ordering::Equal => continue,
                    (Some(a), Some(b)) if a == b.reverse() && a != Ordering::Equal => {
                        missed.push(part);
                        continue;
                    }
                    _ => {}
                }
            }
            match part.halves() {
                Some(halves) => waiting.extend(halves),
                None => open.push(part),
            }
        }
        let rest = match (heard, open.is_empty()) {
            (_, true) => Rest::Empty(Proof(())),
            (true, false) => Rest::Open(joined(open)),
            (false, false) => Rest::Unknown,
        };
        Covered { rest, missed, looks }
    }
}

impl Part {
    /// A ball that holds the part.
    pub fn ball(&self) -> Ball {
        let middle = (self.low + self.high).scale(0.5);
        let radius = (self.high - middle).hi.abs().max((middle - self.low).hi.abs());
        Ball::exact(middle).widen(radius * (1.0 + 1e-15) + middle.hi.abs() * 2f64.powi(-100))
    }

    /// The distance from a number to the part's far end.
    pub fn reach(&self, from: Dd) -> f64 {
        (self.low - from).abs().to_f64().max((self.high - from).abs().to_f64()) * (1.0 + 1e-15)
    }

    /// `None` where nothing lies between the ends.
    fn halves(&self) -> Option<[Part; 2]> {
        let middle = (self.low + self.high).scale(0.5);
        let width = (self.high - self.low).to_f64();
        let size = self.low.hi.abs().max(self.high.hi.abs());
        let between = middle > self.low && middle < self.high && width > size * 2f64.powi(-96);
        between.then_some([Part { low: self.low, high: middle }, Part { low: middle, high: self.high }])
    }
}

/// Ascending, neighbours as one; the narrowest gaps are closed where there are too many to tell.
fn joined(mut parts: Vec<Part>) -> Vec<Part> {
    parts.sort_by(|a, b| a.low.hi.total_cmp(&b.low.hi).then(a.low.lo.total_cmp(&b.low.lo)));
    let mut list: Vec<Part> = Vec::new();
    for part in parts {
        match list.last_mut() {
            Some(last) if last.high >= part.low => last.high = part.high,
            _ => list.push(part),
        }
    }
    while list.len() > MOST_PARTS {
        let gap = |i: usize| (list[i + 1].low - list[i].high).to_f64();
        let closest = (0..list.len() - 1).fold(0, |best, i| if gap(i) < gap(best) { i } else { best });
        list[closest].high = list[closest + 1].high;
        list.remove(closest + 1);
    }
    list
}
