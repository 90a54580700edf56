//! Cases of a study that differ in one parameter. If it only weighs terms of M, C and K, these matrices are linear in it,
//! and the frequencies and poles of many cases are computed side by side. In: numbers of cases. Out: their rows. See
//! docs/method/studies.md#lines.

mod changing;
mod pieces;
mod poles;
mod steps;

use super::answer::{Case, Entry};
use super::cases::{Study, Varied};
use super::updates::{Part, Updates};
use crate::analysis::undamped_block;
use crate::base::number::jet;
use crate::base::{Ball, Diagnostics, Jet, Number};
use crate::dynamics;
use crate::kernel::pencils::{self, Eigenvalues};
use crate::lower::Lowered;
use crate::model;
use crate::model::scene::Damping;
use crate::system::{Form, LinearSystem};
use changing::{changing, slopes};
use pieces::Pieces;
use poles::OfPoles;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use steps::{Range, Steps};

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
        if inner < FEW || !self.asks_modes_alone() {
            return numbers.iter().map(|&number| self.case(number)).collect();
        }
        let lines = numbers.chunk_by(|a, b| a / inner == b / inner);
        lines.flat_map(|numbers| self.of_line(numbers, numbers[0] / inner * inner)).collect()
    }

    /// The rows of cases on the line that begins with the case `first`.
    fn of_line(&self, numbers: &[u64], first: u64) -> Vec<Case> {
        let line = self.lines.get(first, || self.line(first, self.sizes.0));
        let Some(line) = &*line else { return self.one_by_one(numbers) };
        let eigenvalues = self.eigenvalues(line, numbers, first);
        let width = eigenvalues.len() / numbers.len();
        let places: Vec<u64> = numbers.iter().map(|number| number - first).collect();
        let poles = match &line.poles {
            Some(OfPoles::Stretches(list)) => poles::poles(list, &places),
            _ => Vec::new(),
        };
        let mut given = self.parameter_entries(&self.values(first));
        let row = |(at, &number): (usize, &u64)| {
            let mut entries = Vec::with_capacity(self.columns.len());
            entries.resize(given.len(), Entry::None(None));
            let eigenvalues = &eigenvalues[at * width..][..width];
            let are_known = self.add_frequencies(eigenvalues, &mut entries)
                && match &line.poles {
                    None => true,
                    Some(OfPoles::Frequencies(_)) => self.add_undamped_poles(eigenvalues, &mut entries),
                    Some(OfPoles::Stretches(_)) => {
                        self.add_poles(poles[at].as_deref().unwrap_or_default(), &mut entries)
                    }
                };
            if !are_known {
                return self.case(number);
            }
            if let Some(last) = given.last_mut() {
                *last = Entry::Enclosed(line.steps.value_in_unit(number - first));
            }
            entries[..given.len()].copy_from_slice(&given);
            Case { number, entries, code: None }
        };
        numbers.iter().enumerate().map(row).collect()
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

    /// The lowest `count` frequencies of these cases of a line, Hz, without proof of their order where they are close; `None` for a case that
    /// is not on it.
    pub(super) fn side_by_side(&self, line: &Option<Line>, numbers: &[u64], count: usize) -> Vec<Option<Vec<Ball>>> {
        let Some(line) = line else { return vec![None; numbers.len()] };
        let found = self.eigenvalues(line, numbers, 0);
        let of_case = |found: &[f64]| {
            let pairs = found.chunks_exact(2).take(count);
            pairs.map(|pair| self.root([pair[0], pair[1]], PER_TURN)).collect::<Option<Vec<Ball>>>()
        };
        found.chunks(found.len() / numbers.len()).map(|found| of_case(found).filter(|own| own.len() == count)).collect()
    }

    /// All frequencies at any value of the parameter on a piece of a line, Hz, without proof of their order where they are close.
    pub(super) fn frequencies_at(&self, line: &Option<Line>, at: &Number) -> Option<Vec<Ball>> {
        let found = line.as_ref()?.eigenvalues_over([at, at])?;
        found.list.iter().zip(&found.bounds).map(|(square, bound)| self.root([*square, *bound], PER_TURN)).collect()
    }

    /// Eigenvalues of these cases of a line, each before its bound, as many for each case; NaN for one before its first.
    fn eigenvalues(&self, line: &Line, numbers: &[u64], first: u64) -> Vec<f64> {
        let Some((way, steps)) = &line.squares else { return Vec::new() };
        let mut found = match way {
            Way::Pencils(pencils) => {
                let places: Vec<f64> =
                    numbers.iter().map(|number| place(&steps.points.value(number - first))).collect();
                pencils
                    .eigenvalues(&places, &vec![0.0; places.len()])
                    .into_iter()
                    .flat_map(|found| in_pairs(found, pencils.n))
                    .collect()
            }
            Way::Pieces(pieces) => {
                let places: Vec<u64> = numbers.iter().map(|number| number - first).collect();
                pieces.eigenvalues(&places).into_iter().flat_map(|found| in_pairs(found, pieces.n)).collect()
            }
            Way::Updates(updates) => updates.lowest(&steps.changes(numbers, first)),
        };
        let width = found.len() / numbers.len();
        let before = numbers.iter().take_while(|number| **number - first < line.first).count();
        found[..before * width].fill(f64::NAN);
        found
    }

    fn one_by_one(&self, numbers: &[u64]) -> Vec<Case> {
        numbers.iter().map(|&number| self.case(number)).collect()
    }

    /// Adds the lowest frequencies, if all of them are accurate enough. Eigenvalues alternate with their bounds.
    fn add_frequencies(&self, found: &[f64], entries: &mut Vec<Entry>) -> bool {
        let end = entries.len() + self.sizes.0;
        for pair in found.chunks_exact(2).take(self.sizes.0) {
            let Some(frequency) = self.root([pair[0], pair[1]], PER_TURN) else { return false };
            entries.push(Entry::Enclosed(frequency));
        }
        entries.resize(end, Entry::None(None));
        true
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
        let mut values = [&self.held[..], &self.values(case)].concat();
        values.last_mut()?.1.si = si;
        let scene = model::check_with(self.sources, &self.tree, self.overrides, &values).scene?;
        // Of damping by modes C is no sum of squares that a parameter weighs.
        if is_damped && matches!(scene.scene().damping, Some(Damping::Modal { .. })) {
            return None;
        }
        let scene = if is_damped { scene } else { scene.without_damping() };
        let lowered = dynamics::lower_written_out(&scene, &mut Diagnostics::new())?.lowered;
        lowered.rest.is_proven().then_some(lowered)
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

impl Line {
    /// Enclosures of the lowest eigenvalues for all values between two, ascending, if the line is one of pieces.
    pub fn eigenvalues_over(&self, ends: [&Number; 2]) -> Option<Eigenvalues> {
        match &self.squares {
            Some((Way::Pieces(pieces), _)) => pieces.eigenvalues_over(ends),
            _ => None,
        }
    }
}

impl Clone for Lines {
    /// A study that is changed starts with an empty list.
    fn clone(&self) -> Lines {
        Lines::default()
    }
}

/// Eigenvalues alternating with their bounds; NaN where there are none.
fn in_pairs(found: Option<Eigenvalues>, n: usize) -> Vec<f64> {
    let pairs = found.map(|found| found.list.into_iter().zip(found.bounds).flat_map(|(x, bound)| [x, bound]).collect());
    pairs.unwrap_or_else(|| vec![f64::NAN; 2 * n])
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
