//! The ranges that the columns of a study take over its cases, gathered case by case. In: rows in order. Out: for each column its least
//! and its largest value with the case that has it.

use crate::base::{Ball, Bound};
use crate::questions::answer::{Case, Column, Entry, REPLICATES};
use crate::questions::rows::Rows;

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
    /// Of a random drawing.
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

    /// Adds rows, whose cases are behind those before.
    pub fn add(&mut self, rows: &Rows) {
        if self.is_random() {
            return rows.for_each(|case| self.add_case(case));
        }
        self.add_cases(rows.others());
        self.cases += (rows.len() - rows.others().count()) as u64;
        for (column, range) in self.columns.iter_mut().enumerate() {
            let [holds, fails] = rows.verdicts(column).unwrap_or_default();
            (range.holds, range.fails) = (range.holds + holds, range.fails + fails);
            let Some(summary) = rows.summary(column) else { continue };
            for (end, at) in summary.ends.into_iter().enumerate() {
                range.reach(end, rows.enclosed_in(column, at), rows.number(at), || rows.case_at(at));
            }
            range.bound = larger(range.bound, summary.bound);
        }
    }

    fn add_case(&mut self, case: &Case) {
        self.count_case(case);
        for (range, value) in self.columns.iter_mut().zip(&case.entries).filter_map(value_of) {
            for end in 0..2 {
                range.reach(end, value, case.number, || case.clone());
            }
        }
    }

    /// Adds cases in order. Of a column that rises each case is the largest so far, so that only the last one is copied.
    fn add_cases<'c>(&mut self, cases: impl Iterator<Item = &'c Case>) {
        let mut ends: Vec<[Option<(Ball, &Case)>; 2]> = vec![[None; 2]; self.columns.len()];
        for case in cases {
            self.count_case(case);
            for (ends, value) in ends.iter_mut().zip(&case.entries).filter_map(value_of) {
                for (end, known) in ends.iter_mut().enumerate() {
                    if known.is_none_or(|(known, _)| is_beyond(end, value, known)) {
                        *known = Some((value, case));
                    }
                }
            }
        }
        for (range, ends) in self.columns.iter_mut().zip(ends) {
            for (end, (value, case)) in ends.into_iter().enumerate().filter_map(|(end, found)| Some((end, found?))) {
                range.reach(end, value, case.number, || case.clone());
            }
        }
    }

    /// Adds all of a case but the ends of the ranges.
    fn count_case(&mut self, case: &Case) {
        self.cases += 1;
        let is_kept = self.keeps_values();
        for (entry, range) in case.entries.iter().zip(&mut self.columns) {
            range.count(*entry, case.number, self.drawing);
            if let (Entry::Enclosed(value), true) = (*entry, is_kept) {
                range.values.push(value.to_f64());
            }
        }
        if let Some(code) = case.code {
            self.add_code((code, 1, case.clone()));
        }
    }

    fn add_code(&mut self, (code, count, first): (&'static str, u64, Case)) {
        match self.codes.iter_mut().find(|(known, ..)| *known == code) {
            Some((_, number, _)) => *number += count,
            None => self.codes.push((code, count, first)),
        }
    }

    /// Adds what was gathered about cases behind these, which are not random ones.
    pub fn join(&mut self, other: Ranges) {
        self.cases += other.cases;
        for (range, own) in self.columns.iter_mut().zip(other.columns) {
            if let Some(ends) = own.ends {
                for (end, (value, case)) in ends.into_iter().enumerate() {
                    range.reach(end, value, case.number, || case.clone());
                }
            }
            if let Some(bound) = own.bound {
                range.bound = larger(range.bound, bound);
            }
            range.infinite += own.infinite;
            range.unproven += own.unproven;
            range.holds += own.holds;
            range.fails += own.fails;
            range.none += own.none;
            range.reason = range.reason.or(own.reason);
        }
        other.codes.into_iter().for_each(|code| self.add_code(code));
    }
}

/// The larger of two bounds, of which the first may not be there.
fn larger(known: Option<Bound>, bound: Bound) -> Option<Bound> {
    Some(known.map_or(bound, |largest| if largest.value() < bound.value() { bound } else { largest }))
}

/// The value of a column, if it is a number with a bound.
fn value_of<R>((of, entry): (R, &Entry)) -> Option<(R, Ball)> {
    match entry {
        Entry::Enclosed(value) => Some((of, *value)),
        _ => None,
    }
}

/// Whether a value is less than another one (`end` 0), or larger (1), by the midpoints.
fn is_beyond(end: usize, value: Ball, other: Ball) -> bool {
    if end == 0 { value.mid < other.mid } else { value.mid > other.mid }
}

impl Range {
    /// Takes a value for the least (`end` 0) or the largest one (1), if it is, of equal ones that of the first case.
    fn reach(&mut self, end: usize, value: Ball, number: u64, case: impl Fn() -> Case) {
        match &mut self.ends {
            None => self.ends = Some([(value, case()), (value, case())]),
            Some(ends) => {
                let (best, of) = &mut ends[end];
                if is_beyond(end, value, *best) || value.mid == best.mid && number < of.number {
                    ends[end] = (value, case());
                }
            }
        }
    }

    fn count(&mut self, entry: Entry, number: u64, drawing: Drawing) {
        if let Some((moments, verdicts)) = self.replicates.get_mut((number % REPLICATES) as usize) {
            match entry {
                Entry::Enclosed(value) => moments.add(value.to_f64()),
                Entry::Verdict(holds) => verdicts[usize::from(!holds)] += 1,
                _ => {}
            }
        }
        match entry {
            Entry::Enclosed(value) => self.enclose(value, drawing),
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

    fn enclose(&mut self, value: Ball, drawing: Drawing) {
        self.bound = larger(self.bound, Bound::of_midpoint(value));
        if drawing != Drawing::Given {
            self.moments.add(value.to_f64());
        }
    }
}
