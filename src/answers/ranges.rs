//! The ranges that the columns of a study take over its cases, gathered case by case. In: rows in order. Out: for each column its least
//! and its largest value with the case that has it.

use crate::base::{Ball, Bound};
use crate::questions::answer::{Case, Column, Entry, REPLICATES};

/// How the cases of a study were chosen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Drawing {
    #[default]
    Given,
    /// Random and independent.
    Independent,
    /// Random, in [`REPLICATES`] sequences in turn that are independent of each other.
    Replicated,
}

/// Ranges over the cases so far.
#[derive(Clone, Debug, Default)]
pub struct Ranges {
    pub cases: u64,
    pub drawing: Drawing,
    /// In the order of the columns.
    pub columns: Vec<Range>,
    /// Each code with the number of its cases and the first of these, in order of appearance.
    pub codes: Vec<(&'static str, u64, Case)>,
}

/// The values of all columns that are kept for quantiles, at most: 80 MB.
pub const MOST_KEPT: u64 = 10_000_000;

/// The range of a column.
#[derive(Clone, Debug, Default)]
pub struct Range {
    /// The least and the largest value, each with the first case that has it, by the midpoints of the enclosures.
    pub ends: Option<[(Ball, Case); 2]>,
    /// The largest absolute error bound.
    pub bound: Option<Bound>,
    pub moments: Moments,
    /// The values of an independent drawing in the order of the cases, while [`Ranges::keeps_values`].
    pub values: Vec<f64>,
    /// The same for each sequence of a replicated drawing, and the numbers of cases that hold and that fail.
    pub replicates: Vec<(Moments, [u64; 2])>,
    pub infinite: u64,
    pub unproven: u64,
    pub holds: u64,
    pub fails: u64,
    /// Cases without a value.
    pub none: u64,
    /// Why the first of these that has a reason is one.
    pub reason: Option<&'static str>,
}

/// A mean and a variance, updated as B. P. Welford does (Technometrics 4, 1962, 419-420).
#[derive(Clone, Copy, Debug, Default)]
pub struct Moments {
    /// The number of finite values.
    pub number: u64,
    pub mean: f64,
    /// The sum of the squares of the distances from the mean.
    squares: f64,
}

impl Moments {
    fn add(&mut self, x: f64) {
        let old = self.mean;
        self.number += 1;
        self.mean += (x - old) / self.number as f64;
        self.squares += (x - old) * (x - self.mean);
    }

    pub fn of(values: impl IntoIterator<Item = f64>) -> Moments {
        let mut moments = Moments::default();
        values.into_iter().for_each(|x| moments.add(x));
        moments
    }

    /// The estimate of the standard deviation; not a number of fewer than two values.
    pub fn deviation(&self) -> f64 {
        (self.squares / (self.number as f64 - 1.0)).sqrt()
    }
}

impl Ranges {
    pub fn new(columns: &[Column], drawing: Drawing) -> Ranges {
        let replicates = match drawing {
            Drawing::Replicated => vec![Default::default(); REPLICATES as usize],
            Drawing::Given | Drawing::Independent => Vec::new(),
        };
        let range = Range { replicates, ..Range::default() };
        Ranges { drawing, columns: vec![range; columns.len()], ..Ranges::default() }
    }

    /// Whether means estimate those of a distribution.
    pub fn is_random(&self) -> bool {
        self.drawing != Drawing::Given
    }

    /// Whether every value is kept: not those of other drawings, or of more cases and columns than there is room for.
    pub fn keeps_values(&self) -> bool {
        let values = self.cases.saturating_mul(self.columns.len() as u64);
        self.drawing == Drawing::Independent && values <= MOST_KEPT
    }

    /// Adds a case.
    pub fn add(&mut self, case: &Case) {
        self.cases += 1;
        let is_kept = self.keeps_values();
        for (range, entry) in self.columns.iter_mut().zip(&case.entries) {
            range.add(*entry, case);
            match entry {
                Entry::Enclosed(value) if is_kept => range.values.push(value.to_f64()),
                _ => {}
            }
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
        if let Some((moments, verdicts)) = self.replicates.get_mut((case.number % REPLICATES) as usize) {
            match entry {
                Entry::Enclosed(value) => moments.add(value.to_f64()),
                Entry::Verdict(holds) => verdicts[usize::from(!holds)] += 1,
                _ => {}
            }
        }
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
        self.moments.add(value.to_f64());
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
