//! Rows of the table of a study, column by column: those of cases that were computed side by side hold nothing but numbers with their
//! bounds, which stand next to each other; other rows stand beside them. In: cases in order. Out: their rows, or what a whole column has
//! in common.

use super::answer::{Case, Entry};
use crate::base::{Ball, Bound, Dd};
use crate::kernel::bounded::load;
use crate::kernel::simd::simd;

/// Rows in the order of the numbers of their cases.
#[derive(Clone, Debug, Default)]
pub struct Rows {
    numbers: Vec<u64>,
    columns: Vec<Enclosures>,
    /// The rows that have no place in the columns, with their places, ascending.
    others: Vec<(usize, Case)>,
}

/// Enclosures one by one: midpoints in two words, and radii. NaN where there is none.
#[derive(Clone, Debug, Default)]
pub struct Enclosures {
    pub high: Vec<f64>,
    pub low: Vec<f64>,
    pub radius: Vec<f64>,
    /// Whether they stand for verdicts: 1 for what certainly holds, and 0.
    pub are_verdicts: bool,
}

/// What the enclosures of a column have in common.
#[derive(Clone, Copy, Debug)]
pub struct Summary {
    /// The first places of the least and of the largest midpoint.
    pub ends: [usize; 2],
    /// The largest bound of a relative error.
    pub bound: Bound,
}

impl Enclosures {
    pub fn get(&self, at: usize) -> Ball {
        Ball::new(Dd { hi: self.high[at], lo: self.low[at] }, self.radius[at])
    }

    pub fn set(&mut self, at: usize, ball: Ball) {
        (self.high[at], self.low[at], self.radius[at]) = (ball.mid.hi, ball.mid.lo, ball.rad);
    }

    fn entry(&self, at: usize) -> Entry {
        if self.are_verdicts { Entry::Verdict(self.high[at] == 1.0) } else { Entry::Enclosed(self.get(at)) }
    }

    fn resize(&mut self, count: usize) {
        for list in [&mut self.high, &mut self.low, &mut self.radius] {
            list.resize(count, f64::NAN);
        }
    }

    fn summary(&self) -> Option<Summary> {
        let [least, largest, bound] = extremes(&self.high, &self.radius);
        // The first of those with this high word whose low word is least, or largest.
        let place = |end: f64, sign: f64| {
            let mut found: Option<usize> = None;
            for (block, high) in self.high.chunks(BLOCK).enumerate() {
                if !holds(high, end) {
                    continue;
                }
                for at in (block * BLOCK..block * BLOCK + high.len()).filter(|at| self.high[*at] == end) {
                    if found.is_none_or(|best| sign * self.low[at] < sign * self.low[best]) {
                        found = Some(at);
                    }
                }
            }
            found
        };
        Some(Summary { ends: [place(least, 1.0)?, place(largest, -1.0)?], bound: Bound::by_proof(bound) })
    }
}

impl Rows {
    /// No rows, of a table with so many columns.
    pub fn clear(&mut self, columns: usize) {
        self.numbers.clear();
        self.others.clear();
        self.columns.resize_with(columns, Enclosures::default);
        for column in &mut self.columns {
            column.resize(0);
            column.are_verdicts = false;
        }
    }

    pub fn len(&self) -> usize {
        self.numbers.len()
    }

    pub fn is_empty(&self) -> bool {
        self.numbers.is_empty()
    }

    /// Adds a row of any entries.
    pub fn push(&mut self, case: Case) {
        let at = self.extend(&[case.number]);
        self.others.push((at, case));
    }

    /// Adds rows in which nothing is known so far; the place of the first of them.
    pub fn extend(&mut self, numbers: &[u64]) -> usize {
        let first = self.numbers.len();
        self.numbers.extend_from_slice(numbers);
        let count = self.numbers.len();
        self.columns.iter_mut().for_each(|column| column.resize(count));
        first
    }

    pub fn columns(&self) -> &[Enclosures] {
        &self.columns
    }

    pub fn columns_mut(&mut self) -> &mut [Enclosures] {
        &mut self.columns
    }

    /// The row at a place behind those of all others becomes one of these.
    pub fn replace(&mut self, at: usize, case: Case) {
        self.columns
            .iter_mut()
            .for_each(|column| column.set(at, Ball::new(Dd { hi: f64::NAN, lo: f64::NAN }, f64::NAN)));
        self.others.push((at, case));
    }

    /// The rows that are not columns of enclosures.
    pub fn others(&self) -> impl Iterator<Item = &Case> {
        self.others.iter().map(|(_, case)| case)
    }

    /// The places of the rows that are not columns of enclosures, ascending.
    pub fn places_of_others(&self) -> impl Iterator<Item = usize> {
        self.others.iter().map(|(at, _)| *at)
    }

    /// What the enclosures of a column have in common, those of the other rows aside; `None` if there are none.
    pub fn summary(&self, column: usize) -> Option<Summary> {
        let column = self.columns.get(column).filter(|column| !column.are_verdicts)?;
        if self.others.len() == self.len() { None } else { column.summary() }
    }

    /// How many of a column's verdicts, those of the other rows aside, hold and how many fail; `None` if it has none.
    pub fn verdicts(&self, column: usize) -> Option<[u64; 2]> {
        let column = self.columns.get(column).filter(|column| column.are_verdicts)?;
        Some([1.0, 0.0].map(|verdict| column.high.iter().filter(|x| **x == verdict).count() as u64))
    }

    pub fn number(&self, at: usize) -> u64 {
        self.numbers[at]
    }

    /// The entry of a row that is none of the others.
    pub fn enclosed_in(&self, column: usize, at: usize) -> Ball {
        self.columns[column].get(at)
    }

    /// The row at a place.
    pub fn case_at(&self, at: usize) -> Case {
        if let Ok(place) = self.others.binary_search_by_key(&at, |(at, _)| *at) {
            return self.others[place].1.clone();
        }
        let entries = self.columns.iter().map(|column| column.entry(at)).collect();
        Case { number: self.numbers[at], entries, code: None }
    }

    /// All rows in their order.
    pub fn for_each(&self, mut take: impl FnMut(&Case)) {
        let mut others = self.others.iter().peekable();
        let mut row = Case { number: 0, entries: Vec::with_capacity(self.columns.len()), code: None };
        for (at, &number) in self.numbers.iter().enumerate() {
            if let Some((_, case)) = others.next_if(|(place, _)| *place == at) {
                take(case);
                continue;
            }
            row.number = number;
            row.entries.clear();
            row.entries.extend(self.columns.iter().map(|column| column.entry(at)));
            take(&row);
        }
    }
}

/// Numbers that are looked through at once.
const BLOCK: usize = 64;

simd! {
    /// The least and the largest number, NaN aside, and the largest bound of a relative error.
    fn extremes<V: Vector>(numbers: &[f64], radii: &[f64]) -> [f64; 3] {
        let [mut least, mut largest] = [f64::INFINITY, f64::NEG_INFINITY].map(V::splat);
        let (mut bound, zero) = (V::splat(0.0), V::splat(0.0));
        for (x, radius) in numbers.chunks(V::WIDTH).zip(radii.chunks(V::WIDTH)) {
            let (x, radius) = (load::<V>(x), load::<V>(radius));
            // No comparison with NaN holds.
            least = least.if_exceeds(x, x, least);
            largest = x.if_exceeds(largest, x, largest);
            // As `Ball::relative_error`.
            let smallest = ((x.abs() - radius) * V::splat(1.0 - 8.0 * f64::EPSILON)).max(zero);
            let relative = radius / smallest * V::splat(1.0 + 8.0 * f64::EPSILON);
            bound = relative.if_exceeds(bound, relative, bound);
        }
        let (least, largest, bound) = (least.to_array(), largest.to_array(), bound.to_array());
        let mut ends = [least[0], largest[0], bound[0]];
        for lane in 1..V::WIDTH {
            ends = [ends[0].min(least[lane]), ends[1].max(largest[lane]), ends[2].max(bound[lane])];
        }
        ends
    }
}

simd! {
    /// Whether a number is among others, or one of them is NaN.
    fn holds<V: Vector>(numbers: &[f64], wanted: f64) -> bool {
        let wanted = V::splat(wanted);
        let mut all = u32::MAX;
        for x in numbers.chunks(V::WIDTH) {
            let x = load::<V>(x);
            all &= x.exceeds(wanted) | wanted.exceeds(x);
        }
        all.count_ones() as usize != V::WIDTH
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn case(number: u64, x: Ball) -> Case {
        Case { number, entries: vec![Entry::Enclosed(x), Entry::None(None)], code: Some("one") }
    }

    /// Two hundred enclosures with others between them: the summary is that of one after the other.
    #[test]
    fn columns_are_summed_up_as_one_by_one() {
        let mut rows = Rows::default();
        rows.clear(2);
        let numbers: Vec<u64> = (7..207).collect();
        let first = rows.extend(&numbers);
        let x = |at: usize| {
            let high = [3.0, -1.0, 2.5, 3.0, -1.0][at % 5];
            Ball::new(Dd { hi: high, lo: [0.0, 1e-17, -1e-17][at % 3] }, 1e-14 * (at % 19) as f64)
        };
        for at in 0..numbers.len() {
            rows.columns_mut()[0].set(first + at, x(at));
            rows.columns_mut()[1].set(first + at, Ball::ZERO);
        }
        // What a row held before does not count.
        rows.columns_mut()[0].set(first + 5, Ball::from(99.0).widen(1.0));
        rows.replace(5, case(12, Ball::from(1e9)));
        rows.push(case(207, Ball::ONE));
        let own = || (0..numbers.len()).filter(|at| *at != 5);
        let summary = rows.summary(0).expect("enclosures");
        for (found, sign) in summary.ends.into_iter().zip([1.0, -1.0]) {
            let key = |at: usize| (sign * x(at).mid.hi, sign * x(at).mid.lo);
            let best = own().reduce(|a, b| if key(b) < key(a) { b } else { a });
            assert_eq!(Some(found), best);
        }
        let largest = own().map(|at| x(at).relative_error()).fold(0.0, f64::max);
        assert_eq!(summary.bound.value(), largest);
        assert_eq!(rows.summary(1).expect("enclosures").bound, Bound::ZERO);
        let mut seen = Vec::new();
        rows.for_each(|case| seen.push(case.clone()));
        assert_eq!(seen.len(), 201);
        assert!(seen.iter().zip(7..).all(|(case, number)| case.number == number));
        assert_eq!((&seen[5], &seen[200]), (&case(12, Ball::from(1e9)), &case(207, Ball::ONE)));
        assert_eq!(seen[8], rows.case_at(8));
        assert_eq!(seen[8].entries[0], Entry::Enclosed(x(8)));
        // Two verdicts beside a row that has its own.
        rows.columns_mut()[1].are_verdicts = true;
        rows.columns_mut()[1].set(8, Ball::ONE);
        assert_eq!((rows.verdicts(0), rows.verdicts(1)), (None, Some([1, 198])));
        assert_eq!(rows.case_at(8).entries[1], Entry::Verdict(true));
        assert_eq!(rows.case_at(9).entries[1], Entry::Verdict(false));
        assert!(rows.summary(1).is_none());
        rows.clear(2);
        rows.push(case(3, Ball::ONE));
        assert!(rows.summary(0).is_none() && rows.len() == 1 && !rows.is_empty());
        // An enclosure that may be zero has no relative bound.
        rows.clear(1);
        rows.extend(&[0]);
        rows.columns_mut()[0].set(0, Ball::ZERO.widen(1.0));
        assert_eq!(rows.summary(0).expect("one").bound, Bound::UNKNOWN);
    }
}
