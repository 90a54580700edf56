//! Cases of a study that differ in one parameter. If it only weighs terms of M, C and K, these matrices are linear in it,
//! and the frequencies and poles of many cases are computed side by side. In: numbers of cases. Out: their rows. See
//! docs/method/studies.md#lines.

mod changing;
mod drawn;
mod pieces;
mod poles;
mod steps;

use super::answer::Entry;
use super::cases::{Study, Varied};
use super::rows::{Enclosures, Rows};
use super::updates::{Part, Updates};
use crate::analysis::undamped_block;
use crate::base::number::jet;
use crate::base::{Ball, Dd, Diagnostics, Jet, Number};
use crate::dynamics;
use crate::kernel::bounded::Bounded;
use crate::kernel::pencils::{self, Eigenvalues};
use crate::lower::Lowered;
use crate::model::CheckedScene;
use crate::model::scene::Damping;
use crate::system::{Form, LinearSystem};
use changing::{changing, slopes};
use drawn::Drawn;
use pieces::Pieces;
use poles::OfPoles;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use steps::{Range, Steps};

/// A line pays off from this number of values on.
const FEW: u64 = 16;

impl Study<'_> {
    /// The rows of these cases, which are in ascending order, in place of others. A row depends only on the number of its case.
    pub fn rows(&self, numbers: &[u64], rows: &mut Rows) {
        let Some(followed) = &self.followed else { return self.numbered_rows(numbers, rows) };
        let mut numbered = Rows::default();
        self.numbered_rows(numbers, &mut numbered);
        followed.rows(&numbered, self.sizes.0, rows);
    }

    fn numbered_rows(&self, numbers: &[u64], rows: &mut Rows) {
        let inner = match &self.varied {
            Varied::Over(swept) => swept.last().map_or(1, |swept| swept.points.count()),
            Varied::Drawn(samples) => return self.drawn_rows(samples, numbers, rows),
        };
        if inner < FEW || !self.asks_modes_alone() {
            rows.clear(0);
            return self.one_by_one(numbers, rows);
        }
        rows.clear(self.width);
        for numbers in numbers.chunk_by(|a, b| a / inner == b / inner) {
            self.of_line(numbers, numbers[0] / inner * inner, rows);
        }
    }

    /// Adds the rows of cases on the line that begins with the case `first`.
    fn of_line(&self, numbers: &[u64], first: u64, rows: &mut Rows) {
        let line = self.lines.get(first, || self.line(first, self.sizes.0));
        let Some(line) = &*line else { return self.one_by_one(numbers, rows) };
        let given = self.parameter_entries(&self.values(first));
        let places: Vec<u64> = numbers.iter().map(|number| number - first).collect();
        let eigenvalues = self.eigenvalues(line, &places);
        let at = rows.extend(numbers);
        let (parameters, answers) = rows.columns_mut().split_at_mut(given.len());
        for (entry, column) in given.iter().zip(parameters.iter_mut()) {
            if let Entry::Enclosed(value) = entry {
                (at..at + places.len()).for_each(|place| column.set(place, *value));
            }
        }
        if let Some(last) = parameters.last_mut() {
            line.steps.values_in_unit(&places, at, last);
        }
        // Zero, and NaN where something is not known.
        let mut known = vec![0.0; places.len()];
        let (frequencies, poles) = answers.split_at_mut(self.sizes.0);
        self.put_frequencies(&eigenvalues, at, frequencies, &mut known);
        match &line.poles {
            None => {}
            Some(OfPoles::Frequencies(_)) => self.undamped_poles(&eigenvalues, at, poles, &mut known),
            Some(OfPoles::Stretches(list)) => self.poles_of(&poles::poles(list, &places), at, poles, &mut known),
        }
        let count = if line.squares.is_some() { eigenvalues.count() } else { self.sizes.0 };
        self.complete_rows(numbers, at, [given.len(), count], &known, rows);
    }

    /// Sets columns of frequencies from `at` on; what is known becomes NaN for a case of which one is not.
    fn put_frequencies(&self, eigenvalues: &Bounded, at: usize, columns: &mut [Enclosures], known: &mut [f64]) {
        for (i, column) in columns.iter_mut().enumerate().take(eigenvalues.count()) {
            eigenvalues.roots(i, PER_TURN, self.accuracy(), (&mut column.high[at..], &mut column.radius[at..]));
            column.low[at..].fill(0.0);
            known.iter_mut().zip(&column.high[at..]).for_each(|(known, x)| *known += 0.0 * x);
        }
    }

    /// Computes the cases one by one of which not all is known, and leaves columns of frequencies empty if there are fewer modes (`count`
    /// of them, behind the columns of the parameters).
    fn complete_rows(&self, numbers: &[u64], at: usize, [given, count]: [usize; 2], known: &[f64], rows: &mut Rows) {
        let is_narrow = count < self.sizes.0;
        for (i, number) in numbers.iter().enumerate().filter(|(i, _)| is_narrow || known[*i].is_nan()) {
            let case = match known[i].is_nan() {
                true => self.case(*number),
                false => {
                    let mut case = rows.case_at(at + i);
                    case.entries[given + count..given + self.sizes.0].fill(Entry::None(None));
                    case
                }
            };
            rows.replace(at + i, case);
        }
    }

    /// The line of a class of coordinates of a study over one parameter, for so many lowest frequencies. That of all coordinates serves
    /// the rows of the study, too.
    pub(super) fn line_of_class(&self, coordinates: &[u32], is_all: bool, count: usize) -> Arc<Option<Line>> {
        match is_all {
            _ if self.count() < FEW => Arc::default(),
            true => self.lines.get(0, || self.line(0, count)),
            false => Arc::new(
                self.line_for(0, Of { class: Some(coordinates), lowest: count.min(coordinates.len()), poles: 0 }),
            ),
        }
    }

    /// Puts the lowest `count` frequencies, Hz, of these cases of a line where they are wanted: by the place of a case in the list, and
    /// the number of the frequency. There is no proof of their order where they are close. Nothing is put for what is not known.
    pub(super) fn side_by_side(
        &self,
        line: &Option<Line>,
        numbers: &[u64],
        count: usize,
        put: &mut dyn FnMut(usize, usize, Ball),
    ) {
        let Some(line) = line else { return };
        let found = self.eigenvalues(line, numbers);
        let (mut roots, mut errors) = (vec![0.0; numbers.len()], vec![0.0; numbers.len()]);
        for i in 0..count.min(found.count()) {
            found.roots(i, PER_TURN, self.accuracy(), (&mut roots, &mut errors));
            for (case, (root, error)) in roots.iter().zip(&errors).enumerate().filter(|(_, (root, _))| !root.is_nan()) {
                put(case, i, Ball::new(Dd::from(*root), *error));
            }
        }
    }

    /// All frequencies at any value of the parameter on a piece of a line, Hz, without proof of their order where they are close.
    pub(super) fn frequencies_at(&self, line: &Option<Line>, at: &Number) -> Option<Vec<Ball>> {
        let found = line.as_ref()?.eigenvalues_over([at, at])?;
        found.list.iter().zip(&found.bounds).map(|(square, bound)| self.root([*square, *bound], PER_TURN)).collect()
    }

    /// Eigenvalues of the cases at these places of a line; unknown for one before its first.
    fn eigenvalues(&self, line: &Line, places: &[u64]) -> Bounded {
        let Some((way, steps)) = &line.squares else { return Bounded::unknown(0, places.len()) };
        let mut found = match way {
            Way::Pencils(pencils) => pencils.side_by_side(&steps.values(places), &vec![0.0; places.len()]),
            Way::Pieces(pieces) => pieces.eigenvalues(places),
            Way::Updates(updates) => updates.lowest(&steps.changes(places)),
        };
        found.forget(0..places.iter().take_while(|place| **place < line.first).count());
        found
    }

    fn one_by_one(&self, numbers: &[u64], rows: &mut Rows) {
        numbers.iter().for_each(|&number| rows.push(self.case(number)));
    }

    /// The largest relative error bound of a number that is taken from a line.
    fn accuracy(&self) -> f64 {
        self.asked.tolerance.min(1e-4)
    }

    /// The root of an eigenvalue times a factor that is known to a rounding, with its bound, if it is accurate enough.
    fn root(&self, [square, bound]: [f64; 2], factor: f64) -> Option<Ball> {
        if square == 0.0 && bound == 0.0 {
            return Some(Ball::ZERO);
        }
        // The square root halves a small relative change; three roundings and that of the factor are added.
        let relative = 0.51 * (bound / square) + 4.0 * f64::EPSILON;
        // This comparison fails for NaN, too.
        let is_accurate = square > 0.0 && relative <= self.accuracy();
        let root = square.sqrt() * factor;
        is_accurate.then(|| Ball::from(root).widen(root * relative))
    }

    /// Whether the root of an eigenvalue is known to enough digits.
    fn is_accurate(&self, pair: [f64; 2]) -> bool {
        self.root(pair, PER_TURN).is_some()
    }

    /// The system of a case without the damping that is declared for all of it, with another value of its last parameter.
    pub(super) fn undamped_system(&self, case: u64, si: Number) -> Option<LinearSystem> {
        self.system(case, si, false)
    }

    /// The system is the same with or without that damping.
    pub(super) fn system(&self, case: u64, si: Number, is_damped: bool) -> Option<LinearSystem> {
        let Lowered { system, rest, .. } = self.lower_case(case, si, is_damped)?;
        (!rest.may_be_elsewhere()).then_some(system)
    }

    /// The same with its rest, which is proven.
    pub(super) fn lower_case(&self, case: u64, si: Number, is_damped: bool) -> Option<Lowered> {
        let mut values = self.values(case);
        values.last_mut()?.1.si = si;
        let scene = self.scene_at(&values)?;
        // Of damping by modes C is no sum of squares that a parameter weighs.
        if is_damped && matches!(scene.scene().damping, Some(Damping::Modal { .. })) {
            return None;
        }
        lower_proven(if is_damped { scene } else { scene.without_damping() })
    }

    /// The line of cases from `first` on, for so many lowest frequencies and for the poles of the study, if its matrices are certainly
    /// linear in the last parameter, or nearly polynomials on a few pieces.
    fn line(&self, first: u64, lowest: usize) -> Option<Line> {
        self.line_for(first, Of { class: None, lowest, poles: self.sizes.1 })
    }

    fn line_for(&self, first: u64, of: Of) -> Option<Line> {
        let Varied::Over(swept) = &self.varied else { return None };
        let swept = swept.last()?;
        let whole = self.line_of(first, of, &Range::of(swept));
        if whole.is_some() || swept.points.count() <= FEW {
            return whole;
        }
        let without_first = Range::without_first(swept).and_then(|range| self.line_of(first, of, &range));
        without_first.or_else(|| self.line_in_pieces(first, of, &Range::of(swept)))
    }

    fn line_in_pieces(&self, first: u64, of: Of, range: &Range) -> Option<Line> {
        let pieces = self.pieces_of_line(first, range, Of { lowest: of.lowest.max(of.poles / 2), ..of })?;
        let poles = (of.poles > 0).then_some(OfPoles::Frequencies(pieces.n));
        let (way, steps) = (Way::Pieces(pieces), range.steps_from_end(0));
        Some(Line { squares: Some((way, steps.clone())), poles, steps, first: range.first })
    }

    fn line_of(&self, first: u64, of: Of, range: &Range) -> Option<Line> {
        let poles = if of.poles > 0 { Some(self.poles_of_line(first, range)?) } else { None };
        let lowest = match &poles {
            Some(OfPoles::Frequencies(n)) => of.lowest.max(*n),
            _ => of.lowest,
        };
        let squares = if lowest > 0 { Some(self.squares_of_line(first, range, Of { lowest, ..of })?) } else { None };
        Some(Line { squares, poles, steps: range.steps_from_end(0), first: range.first })
    }

    /// The systems of a line with the parameter anywhere in its range.
    fn over(&self, first: u64, range: &Range, is_damped: bool) -> Option<LinearSystem> {
        // The check and the lowering take the same branches for every value in the range, so none of them would fail.
        let all = Jet::of_parameter(range.all);
        let over = jet::without_division(|| self.system(first, all.clone(), is_damped))??;
        (!over.is_chained()).then_some(over)
    }

    /// What changes the eigenvalues of a line.
    fn squares_of_line(&self, first: u64, range: &Range, of: Of) -> Option<(Way, Steps)> {
        let lowest = of.lowest;
        let at = |si: &Number| of.part(self.undamped_system(first, si.clone())?);
        let over = of.part(self.over(first, range, false)?)?;
        // Starts at the end from which eigenvalues rise, if there are enough cases to make the modes in double-double
        // worthwhile.
        let are_enough = range.swept.points.count() >= (over.n() / 25).pow(2) as u64;
        for from in (0..2).take_while(|_| are_enough) {
            let base = at(&range.ends[from])?;
            let Some(changing) = changing(&over, &base, &[Part::Stiffness, Part::Mass]) else { break };
            if let Some(updates) = Updates::of(&base, &changing, range.reach_from(from), lowest) {
                return Some((Way::Updates(updates), range.steps_from_end(from)));
            }
        }
        let centre = range.centre();
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
        let pencils = pencils::Line::new(n, &[of_k, k], &[of_m, m], range.all.magnitude())?;
        // Weights that are not linear make it too wide.
        let is_accurate = |found: &Eigenvalues| {
            let mut pairs = found.list.iter().zip(&found.bounds).take(lowest);
            pairs.all(|(square, bound)| self.root([*square, *bound], PER_TURN).is_some())
        };
        let ends = pencils.eigenvalues(&range.ends.each_ref().map(place), &[0.0; 2]);
        if !ends.iter().flatten().any(is_accurate) {
            return None;
        }
        Some((Way::Pencils(pencils), range.steps_from(&centre, None)))
    }
}

/// A scene, lowered about a rest that is proven.
fn lower_proven(scene: CheckedScene) -> Option<Lowered> {
    let lowered = dynamics::lower_written_out(&scene, &mut Diagnostics::new())?.lowered;
    lowered.rest.is_proven().then_some(lowered)
}

/// What a line is made for.
#[derive(Clone, Copy)]
struct Of<'a> {
    /// The coordinates of a class, or all.
    class: Option<&'a [u32]>,
    lowest: usize,
    /// The number of poles.
    poles: usize,
}

impl Of<'_> {
    /// The class of a system.
    fn part(&self, system: LinearSystem) -> Option<LinearSystem> {
        match self.class {
            Some(coordinates) => undamped_block(&system, coordinates),
            None => Some(system),
        }
    }
}

/// Cases that differ in the last parameter only.
#[derive(Clone, Debug)]
pub(super) struct Line {
    squares: Option<(Way, Steps)>,
    poles: Option<OfPoles>,
    steps: Steps,
    /// The place of the first case that is on it.
    first: u64,
}

/// The method for their frequencies.
#[derive(Clone, Debug)]
enum Way {
    Updates(Updates),
    Pencils(pencils::Line),
    Pieces(Pieces),
}

/// The most recent lines: the cases of one line arrive in many pieces.
#[derive(Debug, Default)]
pub(super) struct Lines {
    recent: Mutex<Vec<Kept>>,
    /// Of random cases, once computed.
    drawn: OnceLock<Option<Drawn>>,
}

/// The first case of a line and, once computed, the line; the inner `None` if there is none.
type Kept = (u64, Arc<OnceLock<Arc<Option<Line>>>>);

/// Number of lines kept: more than the pieces in progress on a few cores.
const MOST_KEPT: usize = 16;

impl Lines {
    fn get(&self, first: u64, make: impl FnOnce() -> Option<Line>) -> Arc<Option<Line>> {
        let place = {
            let mut kept = self.recent.lock().unwrap_or_else(PoisonError::into_inner);
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

impl Line {
    /// Enclosures of the lowest eigenvalues for all values between two, ascending, if the line is one of pieces.
    pub fn eigenvalues_over(&self, ends: [&Number; 2]) -> Option<Eigenvalues> {
        match &self.squares {
            Some((Way::Pieces(pieces), _)) => pieces.eigenvalues_over(ends),
            _ => None,
        }
    }

    /// Whether eigenvalues are known over steps.
    pub fn has_pieces(&self) -> bool {
        matches!(&self.squares, Some((Way::Pieces(_), _)))
    }

    /// Puts enclosures of the lowest `count` eigenvalues over the steps from these cases to the next ones where they are wanted: by the place
    /// of a step in the list, and the number of the eigenvalue; each with the largest distance from it. Nothing is put for what is not known.
    pub fn over_steps(&self, cases: &[u64], count: usize, put: &mut dyn FnMut(usize, usize, [f64; 2])) {
        let Some((Way::Pieces(pieces), _)) = &self.squares else { return };
        let found = pieces.over_steps(cases);
        for i in 0..count.min(found.count()) {
            (0..cases.len()).for_each(|step| put(step, i, found.pair(i, step)));
        }
    }
}

impl Clone for Lines {
    /// A study that is changed starts with an empty list.
    fn clone(&self) -> Lines {
        Lines::default()
    }
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
pub const PER_TURN: f64 = 0.159_154_943_091_895_35;
