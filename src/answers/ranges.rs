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
    /// The moments of each sequence of a replicated drawing, and the numbers of its cases that hold and that fail.
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

    /// Adds cases, which are in the order of their numbers.
    pub fn add(&mut self, cases: &[Case]) {
        let kept = match self.drawing {
            Drawing::Independent => {
                (MOST_KEPT / (self.columns.len() as u64).max(1)).saturating_sub(self.cases).min(cases.len() as u64)
            }
            Drawing::Given | Drawing::Replicated => 0,
        };
        self.cases += cases.len() as u64;
        for (column, range) in self.columns.iter_mut().enumerate() {
            range.add(cases, column, kept as usize);
        }
        for case in cases {
            let Some(code) = case.code else { continue };
            match self.codes.iter_mut().find(|(known, ..)| *known == code) {
                Some((_, count, _)) => *count += 1,
                None => self.codes.push((code, 1, case.clone())),
            }
        }
    }
}

impl Range {
    /// Adds the entries of a column; the values of the first `kept` cases are kept.
    fn add(&mut self, cases: &[Case], column: usize, kept: usize) {
        let (mut ends, mut found) =
            (self.ends.as_ref().map(|ends| ends.each_ref().map(|(value, _)| *value)), [None; 2]);
        for (i, case) in cases.iter().enumerate() {
            let Some(entry) = case.entries.get(column) else { continue };
            self.count(*entry, case.number);
            let Entry::Enclosed(value) = *entry else { continue };
            if i < kept {
                self.values.push(value.to_f64());
            }
            match &mut ends {
                None => (ends, found) = (Some([value; 2]), [Some(i); 2]),
                Some([least, largest]) => {
                    if value.mid < least.mid {
                        (*least, found[0]) = (value, Some(i));
                    }
                    if value.mid > largest.mid {
                        (*largest, found[1]) = (value, Some(i));
                    }
                }
            }
        }
        // Cases are kept at the end alone: of a curve that rises, each is the last.
        match (&mut self.ends, ends, found) {
            (Some(own), Some(ends), found) => {
                for ((own, value), found) in own.iter_mut().zip(ends).zip(found) {
                    if let Some(i) = found {
                        *own = (value, cases[i].clone());
                    }
                }
            }
            (none, Some(ends), [Some(i), Some(j)]) => {
                *none = Some([(ends[0], cases[i].clone()), (ends[1], cases[j].clone())]);
            }
            _ => {}
        }
    }

    fn count(&mut self, entry: Entry, number: u64) {
        if let Some((moments, verdicts)) = self.replicates.get_mut((number % REPLICATES) as usize) {
            match entry {
                Entry::Enclosed(value) => moments.add(value.to_f64()),
                Entry::Verdict(holds) => verdicts[usize::from(!holds)] += 1,
                _ => {}
            }
        }
        match entry {
            Entry::Enclosed(value) => self.enclose(value),
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

    fn enclose(&mut self, value: Ball) {
        let bound = Bound::of_midpoint(value);
        self.bound =
            Some(self.bound.map_or(bound, |largest| if largest.value() < bound.value() { bound } else { largest }));
        self.moments.add(value.to_f64());
    }
}
