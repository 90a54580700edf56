//! The ranges that the columns of a study take over its cases, gathered case by case. In: rows in order. Out: for each column its least
//! and its largest value with the case that has it.

use crate::base::{Ball, Bound};
use crate::questions::answer::{Case, Column, Entry};

/// Ranges over the cases so far.
#[derive(Clone, Debug, Default)]
pub struct Ranges {
    pub cases: u64,
    /// Whether the cases are random, so that means estimate those of the distribution.
    pub random: bool,
    /// In the order of the columns.
    pub columns: Vec<Range>,
    /// Each code with the number of its cases and the first of these, in order of appearance.
    pub codes: Vec<(&'static str, u64, Case)>,
}

/// The range of a column.
#[derive(Clone, Debug, Default)]
pub struct Range {
    /// The least and the largest value, each with the first case that has it, by the midpoints of the enclosures.
    pub ends: Option<[(Ball, Case); 2]>,
    /// The largest absolute error bound.
    pub bound: Option<Bound>,
    /// The number of finite values, their mean, and the sum of the squares of their distances from it.
    pub moments: (u64, f64, f64),
    pub infinite: u64,
    pub unproven: u64,
    pub holds: u64,
    pub fails: u64,
    /// Cases without a value.
    pub none: u64,
    /// Why the first of these that has a reason is one.
    pub reason: Option<&'static str>,
}

impl Ranges {
    pub fn new(columns: &[Column], random: bool) -> Ranges {
        Ranges { random, columns: vec![Range::default(); columns.len()], ..Ranges::default() }
    }

    /// Adds a case.
    pub fn add(&mut self, case: &Case) {
        self.cases += 1;
        for (range, entry) in self.columns.iter_mut().zip(&case.entries) {
            range.add(*entry, case);
        }
        if let Some(code) = case.code {
            match self.codes.iter_mut().find(|(known, ..)| *known == code) {
                Some((_, count, _)) => *count += 1,
                None => self.codes.push((code, 1, case.clone())),
            }
        }
    }
}

impl Range {
    fn add(&mut self, entry: Entry, case: &Case) {
        match entry {
            Entry::Enclosed(value) => self.enclose(value, case),
            Entry::Infinite => self.infinite += 1,
            Entry::Unproven(_) => self.unproven += 1,
            Entry::Verdict(true) => self.holds += 1,
            Entry::Verdict(false) => self.fails += 1,
            Entry::None(reason) => {
                self.none += 1;
                self.reason = self.reason.or(reason);
            }
        }
    }

    fn enclose(&mut self, value: Ball, case: &Case) {
        let bound = Bound::of_midpoint(value);
        self.bound =
            Some(self.bound.map_or(bound, |largest| if largest.value() < bound.value() { bound } else { largest }));
        // Updated as B. P. Welford does (Technometrics 4, 1962, 419-420).
        let (count, mean, squares) = &mut self.moments;
        *count += 1;
        let (x, old) = (value.to_f64(), *mean);
        *mean += (x - old) / *count as f64;
        *squares += (x - old) * (x - *mean);
        match &mut self.ends {
            None => self.ends = Some([(value, case.clone()), (value, case.clone())]),
            Some([least, largest]) => {
                let above = |a: Ball, b: Ball| (a - b).mid.hi > 0.0;
                if above(least.0, value) {
                    *least = (value, case.clone());
                }
                if above(value, largest.0) {
                    *largest = (value, case.clone());
                }
            }
        }
    }
}
