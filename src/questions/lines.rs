//! Cases of a study that differ in one parameter alone: where it only weighs terms of M and K, these depend linearly on it, and the
//! frequencies of many cases are computed side by side. In: numbers of cases. Out: their rows. See docs/method/studies.md#lines.

use super::answer::{Case, Entry};
use super::cases::{Study, Varied};
use crate::base::number::jet;
use crate::base::{Ball, Diagnostics, Jet, Number};
use crate::dynamics;
use crate::kernel::pencils::{self, Eigenvalues};
use crate::model::scene::Damping;
use crate::model::{self, Points, Setting};
use crate::system::{Form, LinearSystem};

/// Fewer values of a parameter are not worth a line.
const FEW: u64 = 16;

impl Study<'_> {
    /// The rows of these cases, which are in ascending order. A row depends on the number of its case alone, not on the others.
    pub fn cases(&self, numbers: &[u64]) -> Vec<Case> {
        let Some(followed) = &self.followed else { return self.numbered(numbers) };
        self.numbered(numbers).into_iter().map(|case| followed.row(case, self.sizes.0)).collect()
    }

    fn numbered(&self, numbers: &[u64]) -> Vec<Case> {
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
        let Some(line) = self.line(first) else { return numbers.iter().map(|&number| self.case(number)).collect() };
        let given: Vec<Vec<Setting>> = numbers.iter().map(|&number| self.values(number)).collect();
        let places: Vec<f64> = given.iter().map(|values| place(values)).collect();
        let found = line.eigenvalues(&places);
        let row = |((&number, values), found): ((&u64, &Vec<Setting>), Option<Eigenvalues>)| {
            let found = found.and_then(|found| self.frequencies(&found));
            let Some(frequencies) = found else { return self.case(number) };
            Case { number, entries: [self.given(values), frequencies].concat(), code: None }
        };
        numbers.iter().zip(&given).zip(found).map(row).collect()
    }

    /// The lowest frequencies, if all of them are as accurate as is asked for.
    fn frequencies(&self, found: &Eigenvalues) -> Option<Vec<Entry>> {
        let frequency = |(square, bound): (&f64, &f64)| {
            // sqrt changes by half of a small relative change; three roundings and that of 1 / (2 pi) come on top.
            let relative = 0.51 * (bound / square) + 4.0 * f64::EPSILON;
            let is_small = *square > 0.0 && relative <= self.asked.tolerance.min(1e-4);
            let hertz = square.sqrt() * PER_TURN;
            is_small.then(|| Entry::Enclosed(Ball::from(hertz).widen(hertz * relative)))
        };
        let lowest = found.list.iter().zip(&found.bounds).take(self.sizes.0);
        let mut list: Vec<Entry> = lowest.map(frequency).collect::<Option<_>>()?;
        list.resize(self.sizes.0, Entry::None(None));
        Some(list)
    }

    /// The system of a case without the damping that is declared for all of it, with another value of its last parameter.
    pub(super) fn undamped(&self, case: u64, si: Number) -> Option<LinearSystem> {
        self.system(case, si, false)
    }

    /// The same with or without that damping.
    pub(super) fn system(&self, case: u64, si: Number, is_damped: bool) -> Option<LinearSystem> {
        let mut values = [&self.held[..], &self.values(case)].concat();
        values.last_mut()?.1.si = si;
        let scene = model::check_with(self.sources, &self.tree, self.overrides, &values).scene?;
        if matches!(scene.scene().damping, Some(Damping::Modal { .. })) {
            return None;
        }
        let scene = if is_damped { scene } else { scene.without_damping() };
        let lowered = dynamics::lower_written_out(&scene, &mut Diagnostics::new())?.lowered;
        lowered.rest.is_proven().then_some(lowered.system)
    }

    /// The line of cases from `first` on, if its matrices are certainly linear in the last parameter.
    fn line(&self, first: u64) -> Option<pencils::Line> {
        let Varied::Over(swept) = &self.varied else { return None };
        let swept = swept.last()?;
        let (low, high) = ends(&swept.points);
        let centre = &(&low + &high) / &Number::from(2);
        let reach = (&high - &centre).to_ball().magnitude();
        let range = centre.to_ball().widen(reach * (1.0 + 4.0 * f64::EPSILON));
        let at = |si: Number| self.undamped(first, si);
        // The check and the lowering take the same way for every value of the range: none of them would stop.
        let over = jet::undivided(|| at(Jet::of_parameter(range)))??;
        let centred = at(centre.clone())?;
        let n = centred.n();
        let fits = (1..=pencils::MOST).contains(&n) && !centred.is_chained() && !over.is_chained() && over.n() == n;
        let slopes = |form: fn(&LinearSystem) -> &Form| slopes(form(&over), form(&centred), n);
        let (k, m) = if fits { (slopes(|system| &system.k)?, slopes(|system| &system.m)?) } else { return None };
        // Mean value theorem: K at p is K at the centre, and p less the centre times a derivative in the range.
        let first = |at_centre: Vec<Vec<Ball>>, slopes: &[Vec<Ball>]| {
            let entry = |(a, b): (&Ball, &Ball)| *a - *b * centre.to_ball();
            let row = |(a, b): (&Vec<Ball>, &Vec<Ball>)| a.iter().zip(b).map(entry).collect();
            at_centre.iter().zip(slopes).map(row).collect::<Vec<Vec<Ball>>>()
        };
        let (of_k, of_m) = (first(centred.k.assemble(n), &k), first(centred.m.assemble(n), &m));
        pencils::Line::new(n, [&of_k, &k], [&of_m, &m], range.magnitude())
    }
}

/// The last value in binary64; NaN if that is not accurate enough.
fn place(values: &[Setting]) -> f64 {
    let Some((_, quantity)) = values.last() else { return f64::NAN };
    let value = quantity.si.to_ball();
    let rounded = value.to_f64();
    let off = (value - Ball::from(rounded)).magnitude();
    let fits = off <= pencils::ROUNDING_OF_D * rounded.abs() && (rounded == 0.0 || pencils::is_usual(rounded.abs()));
    if fits { rounded } else { f64::NAN }
}

/// 1 / (2 pi)
const PER_TURN: f64 = 0.159_154_943_091_895_35;

/// The least and the largest value.
fn ends(points: &Points) -> (Number, Number) {
    match points {
        Points::Even { low, high, .. } => (low.clone(), high.clone()),
        Points::Listed(list) => {
            let less = |a: &Number, b: &Number| (a - b).is_negative();
            let pick = |rising: bool| list.iter().reduce(|a, b| if less(b, a) == rising { b } else { a });
            let end = |rising| pick(rising).cloned().unwrap_or(Number::ZERO);
            (end(true), end(false))
        }
    }
}

/// The derivative of the matrix of a form, if its rows are the same everywhere and only weights change. `over` holds over the range,
/// `centred` in its middle.
fn slopes(over: &Form, centred: &Form, n: usize) -> Option<Vec<Vec<Ball>>> {
    let mut matrix = vec![vec![Ball::ZERO; n]; n];
    if over.terms().len() != centred.terms().len() {
        return None;
    }
    for (term, middle) in over.terms().iter().zip(centred.terms()) {
        let row = over.row(term);
        let is_fixed = row.iter().all(|(_, entry)| !matches!(entry, Number::Jet(_)));
        if !is_fixed || row != centred.row(middle) {
            return None;
        }
        let slope = match &term.weight {
            Number::Jet(jet) => jet.slope,
            weight if *weight == middle.weight => continue,
            _ => return None,
        };
        for (i, a) in row {
            for (j, b) in row {
                let entry = &mut matrix[i.index()][j.index()];
                *entry = *entry + slope * a.to_ball() * b.to_ball();
            }
        }
    }
    Some(matrix)
}
