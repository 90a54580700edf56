//! Cases of a study that differ in one parameter. If it only weighs terms of M and K, these matrices are linear in it,
//! and the frequencies of many cases are computed side by side. In: numbers of cases. Out: their rows. See
//! docs/method/studies.md#lines.

use super::answer::{Case, Entry, shown_in};
use super::cases::{Study, Varied};
use super::updates::{Changing, Part, Updates};
use crate::base::number::jet;
use crate::base::{Ball, Dd, Diagnostics, Jet, Number};
use crate::dynamics;
use crate::kernel::pencils::{self, Eigenvalues};
use crate::lower::Lowered;
use crate::model::scene::{Damping, Written};
use crate::model::{self, Points};
use crate::system::{CoordinateId, Form, LinearSystem};
use num_integer::Integer;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

/// A line pays off from this number of values on.
const FEW: u64 = 16;

impl Study<'_> {
    /// The rows of these cases, which are in ascending order. A row depends only on the number of its case.
    pub fn cases(&self, numbers: &[u64]) -> Vec<Case> {
        let Some(followed) = &self.followed else { return self.numbered_cases(numbers) };
        self.numbered_cases(numbers).into_iter().map(|case| followed.row(case, self.sizes.0)).collect()
    }

    fn numbered_cases(&self, numbers: &[u64]) -> Vec<Case> {
        let inner = match &self.varied {
            Varied::Over(swept) => swept.last().map_or(1, |swept| swept.points.count()),
            Varied::Drawn(_) => 1,
        };
        if inner < FEW || !self.asks_frequencies_alone() {
            return numbers.iter().map(|&number| self.case(number)).collect();
        }
        let lines = numbers.chunk_by(|a, b| a / inner == b / inner);
        lines.flat_map(|numbers| self.of_line(numbers, numbers[0] / inner * inner)).collect()
    }

    /// The rows of cases on the line that begins with the case `first`.
    fn of_line(&self, numbers: &[u64], first: u64) -> Vec<Case> {
        let line = self.lines.get(first, || self.line(first, self.sizes.0));
        let Some(line) = &*line else { return self.one_by_one(numbers) };
        let found = self.eigenvalues(line, numbers, first);
        let width = found.len() / numbers.len();
        let mut given = self.parameter_entries(&self.values(first));
        let row = |(&number, found): (&u64, &[f64])| {
            let mut entries = Vec::with_capacity(self.columns.len());
            if !self.frequencies(found, given.len(), &mut entries) {
                return self.case(number);
            }
            if let Some(last) = given.last_mut() {
                *last = Entry::Enclosed(line.steps.value_in_unit(number - first));
            }
            entries[..given.len()].copy_from_slice(&given);
            Case { number, entries, code: None }
        };
        numbers.iter().zip(found.chunks(width)).map(row).collect()
    }

    /// The lowest `count` frequencies of these cases of a study over one parameter, Hz, without proof of their order where they are close;
    /// `None` for a case that is not computed side by side with others. A line that is made here serves the rows of the study, too.
    pub(super) fn side_by_side(&self, numbers: &[u64], count: usize) -> Vec<Option<Vec<Ball>>> {
        let line = if self.count() < FEW { Arc::default() } else { self.lines.get(0, || self.line(0, count)) };
        let Some(line) = &*line else { return vec![None; numbers.len()] };
        let found = self.eigenvalues(line, numbers, 0);
        let of_case = |found: &[f64]| {
            let pairs = found.chunks_exact(2).take(count);
            pairs.map(|pair| self.frequency([pair[0], pair[1]])).collect::<Option<Vec<Ball>>>()
        };
        found.chunks(found.len() / numbers.len()).map(|found| of_case(found).filter(|own| own.len() == count)).collect()
    }

    /// Eigenvalues of these cases of a line, each before its bound, as many for each case.
    fn eigenvalues(&self, line: &Line, numbers: &[u64], first: u64) -> Vec<f64> {
        match &line.way {
            Way::Pencils(pencils) => {
                let points = &line.steps.points;
                let places: Vec<f64> = numbers.iter().map(|number| place(&points.value(number - first))).collect();
                pencils.eigenvalues(&places).into_iter().flat_map(|found| in_pairs(found, pencils.n)).collect()
            }
            Way::Updates(updates) => {
                let changes: Vec<f64> = numbers.iter().map(|number| line.steps.change(number - first)).collect();
                updates.lowest(&changes)
            }
        }
    }

    fn one_by_one(&self, numbers: &[u64]) -> Vec<Case> {
        numbers.iter().map(|&number| self.case(number)).collect()
    }

    /// Adds the lowest frequencies after the columns of this many parameters, if all of them are accurate enough.
    /// Eigenvalues alternate with their bounds.
    fn frequencies(&self, found: &[f64], parameters: usize, entries: &mut Vec<Entry>) -> bool {
        entries.resize(parameters, Entry::None(None));
        for pair in found.chunks_exact(2).take(self.sizes.0) {
            let Some(frequency) = self.frequency([pair[0], pair[1]]) else { return false };
            entries.push(Entry::Enclosed(frequency));
        }
        entries.resize(parameters + self.sizes.0, Entry::None(None));
        true
    }

    /// The frequency of an eigenvalue with its bound, Hz, if it is accurate enough.
    fn frequency(&self, [square, bound]: [f64; 2]) -> Option<Ball> {
        if square == 0.0 && bound == 0.0 {
            return Some(Ball::ZERO);
        }
        // The square root halves a small relative change; three roundings and that of 1 / (2 pi) are added.
        let relative = 0.51 * (bound / square) + 4.0 * f64::EPSILON;
        // This comparison fails for NaN, too.
        let is_accurate = square > 0.0 && relative <= self.asked.tolerance.min(1e-4);
        let hertz = square.sqrt() * PER_TURN;
        is_accurate.then(|| Ball::from(hertz).widen(hertz * relative))
    }

    /// The system of a case without the damping that is declared for all of it, with another value of its last parameter.
    pub(super) fn undamped_system(&self, case: u64, si: Number) -> Option<LinearSystem> {
        self.system(case, si, false)
    }

    /// The system is the same with or without that damping.
    pub(super) fn system(&self, case: u64, si: Number, is_damped: bool) -> Option<LinearSystem> {
        let Lowered { system, rest, .. } = self.lower_case(case, si, is_damped)?;
        // Over a range another rest may be found at some of the values.
        (!rest.moves_terms || !rest.is_ranged()).then_some(system)
    }

    /// The same with its rest, which is proven.
    pub(super) fn lower_case(&self, case: u64, si: Number, is_damped: bool) -> Option<Lowered> {
        let mut values = [&self.held[..], &self.values(case)].concat();
        values.last_mut()?.1.si = si;
        let scene = model::check_with(self.sources, &self.tree, self.overrides, &values).scene?;
        if matches!(scene.scene().damping, Some(Damping::Modal { .. })) {
            return None;
        }
        let scene = if is_damped { scene } else { scene.without_damping() };
        let lowered = dynamics::lower_written_out(&scene, &mut Diagnostics::new())?.lowered;
        lowered.rest.is_proven().then_some(lowered)
    }

    /// The line of cases from `first` on, for so many lowest eigenvalues, if its matrices are certainly linear in the last parameter.
    fn line(&self, first: u64, lowest: usize) -> Option<Line> {
        let Varied::Over(swept) = &self.varied else { return None };
        let swept = swept.last()?;
        let ends = ends(&swept.points);
        let centre = &(&ends[0] + &ends[1]) / &Number::from(2);
        let reach = (&ends[1] - &centre).to_ball().magnitude();
        let range = centre.to_ball().widen(reach * (1.0 + 4.0 * f64::EPSILON));
        let at = |si: &Number| self.undamped_system(first, si.clone());
        // The check and the lowering take the same branches for every value in the range, so none of them would fail.
        let over = jet::without_division(|| at(&Jet::of_parameter(range)))??;
        if over.is_chained() {
            return None;
        }
        // Starts at the end from which eigenvalues rise, if there are enough cases to make the modes in double-double
        // worthwhile.
        let are_enough = swept.points.count() >= (over.n() / 25).pow(2) as u64;
        for from in (0..2).take_while(|_| are_enough) {
            let base = at(&ends[from])?;
            let width = (&ends[1 - from] - &ends[from]).to_ball();
            let Some(changing) = changing(&over, &base) else { break };
            let reach = width.magnitude() * (1.0 + 4.0 * f64::EPSILON) * width.mid.hi.signum();
            if let Some(updates) = Updates::of(&base, &changing, reach, lowest) {
                let steps = Steps::new(&swept.points, &ends[from], &swept.parameter.unit);
                return Some(Line { way: Way::Updates(updates), steps });
            }
        }
        let centred = at(&centre)?;
        let n = centred.n();
        let fits = (1..=pencils::MOST).contains(&n) && !centred.is_chained() && over.n() == n;
        let slopes = |form: fn(&LinearSystem) -> &Form| slopes(form(&over), form(&centred), n);
        let (k, m) = if fits { (slopes(|system| &system.k)?, slopes(|system| &system.m)?) } else { return None };
        // By the mean value theorem, K at p is K at the centre plus (p - centre) times a derivative in the range.
        let first = |at_centre: Vec<Vec<Ball>>, slopes: &[Vec<Ball>]| {
            let entry = |(a, b): (&Ball, &Ball)| *a - *b * centre.to_ball();
            let row = |(a, b): (&Vec<Ball>, &Vec<Ball>)| a.iter().zip(b).map(entry).collect();
            at_centre.iter().zip(slopes).map(row).collect::<Vec<Vec<Ball>>>()
        };
        let (of_k, of_m) = (first(centred.k.assemble(n), &k), first(centred.m.assemble(n), &m));
        let pencils = pencils::Line::new(n, [&of_k, &k], [&of_m, &m], range.magnitude())?;
        Some(Line { way: Way::Pencils(pencils), steps: Steps::new(&swept.points, &centre, &swept.parameter.unit) })
    }
}

/// Cases that differ in the last parameter only.
#[derive(Clone, Debug)]
struct Line {
    way: Way,
    steps: Steps,
}

/// The method for their frequencies.
#[derive(Clone, Debug)]
enum Way {
    Updates(Updates),
    Pencils(pencils::Line),
}

/// The most recent lines: the cases of one line arrive in many pieces.
#[derive(Debug, Default)]
pub(super) struct Lines(Mutex<Vec<Kept>>);

/// The first case of a line and, once computed, the line; the inner `None` if there is none.
type Kept = (u64, Arc<OnceLock<Arc<Option<Line>>>>);

/// Number of lines kept: more than the pieces in progress on a few cores.
const MOST_KEPT: usize = 16;

impl Lines {
    fn get(&self, first: u64, make: impl FnOnce() -> Option<Line>) -> Arc<Option<Line>> {
        let place = {
            let mut kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
            match kept.iter().find(|(of, _)| *of == first) {
                Some((_, place)) => place.clone(),
                None => {
                    if kept.len() == MOST_KEPT {
                        kept.remove(0);
                    }
                    kept.push((first, Arc::default()));
                    kept.last().map(|(_, place)| place.clone()).unwrap_or_default()
                }
            }
        };
        place.get_or_init(|| Arc::new(make())).clone()
    }
}

impl Clone for Lines {
    /// A study that is changed starts with an empty list.
    fn clone(&self) -> Lines {
        Lines::default()
    }
}

/// The values of the last parameter along a line.
#[derive(Clone, Debug)]
struct Steps {
    points: Points,
    unit: Written,
    base: Number,
    /// The number of the case at `base`, and the distance between neighbours, SI, if values are equally spaced from an
    /// end.
    even: Option<(u64, f64)>,
    /// Integers a, b and c such that the value with number i is (a + i b) / c in its unit.
    fraction: Option<[i64; 3]>,
}

/// Integers up to this size are exact in binary64.
const EXACT: u64 = 1 << 53;

impl Steps {
    fn new(points: &Points, base: &Number, unit: &Written) -> Steps {
        let mut steps =
            Steps { points: points.clone(), unit: unit.clone(), base: base.clone(), even: None, fraction: None };
        if let Points::Even { low, high, count } = points {
            let between = &(high - low) / &Number::from(*count as i64 - 1);
            let at = [(low, 0), (high, count - 1)].into_iter().find(|(end, _)| *end == base).map(|(_, at)| at);
            steps.even = at.filter(|_| is_known(between.to_ball())).map(|at| (at, between.to_f64()));
            steps.fraction =
                in_integers([low, &between].map(|si| unit.factor.as_ref().map(|factor| si / factor)), *count);
        }
        steps
    }

    /// The value with this number less the base, SI, with a relative error of a few roundings; NaN if it is not known
    /// that accurately.
    fn change(&self, index: u64) -> f64 {
        if let Some((at, between)) = self.even {
            return (index as f64 - at as f64) * between;
        }
        let change = (&self.points.value(index) - &self.base).to_ball();
        if is_known(change) { change.to_f64() } else { f64::NAN }
    }

    /// The value with this number in its unit.
    fn value_in_unit(&self, index: u64) -> Ball {
        let Some([a, b, c]) = self.fraction else {
            return shown_in(&self.points.value(index), &self.unit, false).number;
        };
        let (number, divisor) = ((a + b * index as i64) as f64, c as f64);
        let quotient = number / divisor;
        // The remainder is exact in binary64.
        match (-quotient).mul_add(divisor, number) {
            0.0 => Ball::from(quotient),
            left => Ball::new(Dd::new(quotient, left / divisor), quotient.abs() * Dd::EPSILON),
        }
    }
}

/// Whether the relative error of a number is negligible in binary64.
fn is_known(x: Ball) -> bool {
    x.relative_error() <= f64::EPSILON / 8.0
}

/// First value and distance as integers over one divisor, if all values are exact in binary64.
fn in_integers(of: [Option<Number>; 2], count: u64) -> Option<[i64; 3]> {
    let [first, between] = of.map(|number| number.and_then(|number| number.exact()?.to_fraction()));
    let ((a, c), (b, d)) = (first?, between?);
    let over = i128::from(c).lcm(&i128::from(d));
    let [a, b] = [(a, c), (b, d)].map(|(number, divisor)| i128::from(number) * (over / i128::from(divisor)));
    let most = a.abs().checked_add(b.abs().checked_mul(i128::from(count))?)?.max(over);
    let fits = most < i128::from(EXACT);
    fits.then_some([a as i64, b as i64, over as i64])
}

/// Eigenvalues alternating with their bounds; NaN where there are none.
fn in_pairs(found: Option<Eigenvalues>, n: usize) -> Vec<f64> {
    let pairs = found.map(|found| found.list.into_iter().zip(found.bounds).flat_map(|(x, bound)| [x, bound]).collect());
    pairs.unwrap_or_else(|| vec![f64::NAN; 2 * n])
}

/// The squares whose weights change, if all rows are the same everywhere. `over` holds over the range, `base` at one of its ends.
fn changing(over: &LinearSystem, base: &LinearSystem) -> Option<Vec<Changing>> {
    let mut list: Vec<(Row, Changing)> = Vec::new();
    for (part, over, base) in [(Part::Stiffness, &over.k, &base.k), (Part::Mass, &over.m, &base.m)] {
        for (row, slope) in moving(over, base)? {
            match list.iter_mut().find(|(other, of)| of.part == part && *other == row) {
                Some((_, of)) => of.slope = of.slope + slope,
                None => {
                    let entries = row.iter().map(|(at, a)| (at.index(), a.to_ball())).collect();
                    list.push((row, Changing { part, row: entries, slope }));
                }
            }
        }
    }
    Some(list.into_iter().map(|(_, changing)| changing).collect())
}

/// Coordinates and entries of a row.
type Row<'a> = &'a [(CoordinateId, Number)];

/// The rows whose weights change, with the derivatives of these; `None` if a row changes.
fn moving<'a>(over: &'a Form, base: &Form) -> Option<Vec<(Row<'a>, Ball)>> {
    if over.terms().len() != base.terms().len() {
        return None;
    }
    let mut list = Vec::new();
    for (term, other) in over.terms().iter().zip(base.terms()) {
        let row = over.row(term);
        let is_fixed = row.iter().all(|(_, entry)| !matches!(entry, Number::Jet(_)));
        if !is_fixed || row != base.row(other) {
            return None;
        }
        match &term.weight {
            Number::Jet(jet) => list.push((row, jet.slope)),
            weight if *weight == other.weight => {}
            _ => return None,
        }
    }
    Some(list)
}

/// A value in binary64; NaN if that is not accurate enough.
fn place(si: &Number) -> f64 {
    let value = si.to_ball();
    let rounded = value.to_f64();
    let off = (value - Ball::from(rounded)).magnitude();
    let fits = off <= pencils::ROUNDING_OF_D * rounded.abs() && (rounded == 0.0 || pencils::is_usual(rounded.abs()));
    if fits { rounded } else { f64::NAN }
}

/// 1 / (2 pi)
const PER_TURN: f64 = 0.159_154_943_091_895_35;

/// The least and the largest value.
fn ends(points: &Points) -> [Number; 2] {
    match points {
        Points::Even { low, high, .. } => [low.clone(), high.clone()],
        Points::Listed(list) => {
            let less = |a: &Number, b: &Number| (a - b).is_negative();
            let pick = |rising: bool| list.iter().reduce(|a, b| if less(b, a) == rising { b } else { a });
            [true, false].map(|rising| pick(rising).cloned().unwrap_or(Number::ZERO))
        }
    }
}

/// The derivative of the matrix of a form, if its rows are the same everywhere and only weights change. `over` holds over the range,
/// `centred` in its middle.
fn slopes(over: &Form, centred: &Form, n: usize) -> Option<Vec<Vec<Ball>>> {
    let mut matrix = vec![vec![Ball::ZERO; n]; n];
    for (row, slope) in moving(over, centred)? {
        for (i, a) in row {
            for (j, b) in row {
                let entry = &mut matrix[i.index()][j.index()];
                *entry = *entry + slope * a.to_ball() * b.to_ball();
            }
        }
    }
    Some(matrix)
}
