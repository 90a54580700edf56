//! Random cases whose parameters only weigh terms of M and K: about the declared values both matrices are linear in them, and the frequencies
//! of many cases are computed side by side, with the requirements and measures that are about frequencies. In: numbers of cases. Out: their
//! rows. See docs/method/studies.md#random-cases.

use super::{PER_TURN, Study, lower_proven, slopes};
use crate::base::number::jet;
use crate::base::{Ball, Dd, Jet, Number, Rational};
use crate::kernel::pencils::{self, Plane};
use crate::model::scene::{Comparison, Measure, Question, Written};
use crate::model::{CheckedScene, Setting};
use crate::questions::answer::{Column, Holds, shown_in};
use crate::questions::require;
use crate::questions::rows::Rows;
use crate::questions::samples::Samples;
use crate::questions::tolerated::hull;
use crate::system::LinearSystem;

/// The matrices of all cases whose values lie in these ranges.
#[derive(Debug)]
pub(super) struct Drawn {
    plane: Plane,
    n: usize,
    /// For each parameter the declared value, at which the coefficients were taken, and the least and largest one.
    ranges: Vec<[f64; 3]>,
    /// What the columns behind those of the frequencies hold.
    asked: Vec<Asked>,
}

/// A column about a frequency.
#[derive(Debug)]
enum Asked {
    Value { mode: usize, unit: Written, in_radians: bool },
    Verdict { mode: usize, comparison: Comparison, limit: Number },
}

impl Asked {
    /// The mode, counted from 0.
    fn mode(&self) -> usize {
        match self {
            Asked::Value { mode, .. } | Asked::Verdict { mode, .. } => *mode,
        }
    }
}

/// Deviations of values without a tolerance that are tried: beyond the last, one case in 16,000 is computed by itself.
const DEVIATIONS: [f64; 2] = [8.0, 4.0];

/// Limit on the parameters, for each of which the model is checked and lowered once.
const MOST_PARAMETERS: usize = 64;

impl Study<'_> {
    /// The rows of random cases.
    pub(super) fn drawn_rows(&self, samples: &Samples, numbers: &[u64], rows: &mut Rows) {
        // For any number of cases: what a case answers depends on its number alone.
        let Some(drawn) = self.lines.drawn.get_or_init(|| self.linear_matrices(samples)) else {
            rows.clear(0);
            return self.one_by_one(numbers, rows);
        };
        rows.clear(self.width);
        let at = rows.extend(numbers);
        let values: Vec<Vec<f64>> = numbers.iter().map(|number| samples.numbers(*number)).collect();
        let (parameters, answers) = rows.columns_mut().split_at_mut(samples.tolerances.len());
        let (frequencies, asked) = answers.split_at_mut(self.sizes.0);
        for ((i, tolerance), column) in samples.tolerances.iter().enumerate().zip(parameters) {
            for (row, values) in (at..).zip(&values) {
                let si = Rational::from_f64(values[i]).map_or(tolerance.parameter.value.si.clone(), Number::from);
                column.set(row, shown_in(&si, &tolerance.parameter.unit, false).number);
            }
        }
        // Zero, and NaN where something is not known.
        let mut known = vec![0.0; numbers.len()];
        let found = drawn.plane.side_by_side(&drawn.changes(&values));
        self.put_frequencies(&found, at, frequencies, &mut known);
        let (mut roots, mut errors) = (vec![0.0; numbers.len()], vec![0.0; numbers.len()]);
        for (asked, column) in drawn.asked.iter().zip(asked) {
            column.are_verdicts = matches!(asked, Asked::Verdict { .. });
            found.roots(asked.mode(), PER_TURN, self.accuracy(), (&mut roots, &mut errors));
            for (case, known) in known.iter_mut().enumerate().filter(|(case, _)| !roots[*case].is_nan()) {
                let value = Ball::new(Dd::from(roots[case]), errors[case]);
                match asked {
                    Asked::Value { unit, in_radians, .. } => {
                        column.set(at + case, shown_in(&Number::Ball(value), unit, *in_radians).number);
                    }
                    Asked::Verdict { comparison, limit, .. } => match require::holds(&value, *comparison, limit) {
                        Some(holds) => column.high[at + case] = if holds { 1.0 } else { 0.0 },
                        None => *known = f64::NAN,
                    },
                }
            }
            known.iter_mut().zip(&roots).for_each(|(known, root)| *known += 0.0 * root);
        }
        self.complete_rows(numbers, at, [samples.tolerances.len(), drawn.n], &known, rows);
    }

    fn linear_matrices(&self, samples: &Samples) -> Option<Drawn> {
        use Holds::{Frequency, Measure, Parameter, Required, Verdict};
        let holds = |column: &Column| matches!(column.holds, Parameter | Frequency | Required | Verdict | Measure);
        let fits = self.sizes.1 == 0 && self.columns.iter().all(holds);
        if !fits || samples.tolerances.is_empty() || samples.tolerances.len() > MOST_PARAMETERS {
            return None;
        }
        DEVIATIONS.iter().find_map(|deviations| self.linear_matrices_within(samples, samples.ranges(*deviations)))
    }

    fn linear_matrices_within(&self, samples: &Samples, ranges: Vec<[f64; 3]>) -> Option<Drawn> {
        let declared = samples.values(0);
        let lower = |si: &dyn Fn(usize) -> Number| {
            let mut values: Vec<Setting> = declared.clone();
            values.iter_mut().enumerate().for_each(|(i, value)| value.1.si = si(i));
            let scene = self.scene_at(&values)?;
            let asked = self.asked_of_frequencies(&scene)?;
            let lowered = lower_proven(scene.without_damping())?;
            let stands = !lowered.rest.may_be_elsewhere() && !lowered.system.is_chained();
            stands.then_some((lowered.system, asked))
        };
        let centre: Vec<Number> =
            ranges.iter().map(|range| Rational::from_f64(range[0]).map(Number::from)).collect::<Option<_>>()?;
        let (centred, asked) = lower(&|i| centre[i].clone())?;
        let n = centred.n();
        let exist = asked.iter().all(|asked| asked.mode() < n);
        if !exist || !(1..=pencils::MOST).contains(&n) {
            return None;
        }
        // By the mean value theorem the matrices at any values are those at the centre plus the changes of the values times derivatives
        // somewhere between: each by its parameter, while all may be anywhere in their ranges. The check and the lowering take the same
        // branches for all of them.
        let [mut k, mut m] = [&centred.k, &centred.m].map(|form| vec![form.assemble(n)]);
        for own in 0..ranges.len() {
            let over = |i: usize| {
                let [_, low, high] = ranges[i].map(Ball::from);
                let slope = if i == own { Ball::ONE } else { Ball::ZERO };
                Number::from(Jet { value: hull(low, high), slope })
            };
            let (over, _): (LinearSystem, _) = jet::without_division(|| lower(&over))??;
            if over.n() != n {
                return None;
            }
            k.push(slopes(&over.k, &centred.k, n)?);
            m.push(slopes(&over.m, &centred.m, n)?);
        }
        let most: Vec<f64> =
            ranges.iter().map(|[centre, low, high]| (high - centre).max(centre - low) * (1.0 + f64::EPSILON)).collect();
        let drawn = Drawn { plane: Plane::new(n, &k, &m, &most)?, n, ranges, asked };
        // Weights that are not linear make the bounds too wide.
        let at_end = |end: usize| drawn.ranges.iter().map(|range| range[end]).collect::<Vec<f64>>();
        let found = drawn.plane.side_by_side(&drawn.changes(&[0, 1, 2].map(at_end)));
        let count = drawn.asked.iter().map(|asked| asked.mode() + 1).max().unwrap_or(0).max(self.sizes.0.min(n));
        let is_accurate = |case: usize| (0..count).all(|i| self.is_accurate(found.pair(i, case)));
        (0..3).any(is_accurate).then_some(drawn)
    }

    /// The columns of requirements and measures, if all are about frequencies and compare these with limits that are not varied.
    fn asked_of_frequencies(&self, scene: &CheckedScene) -> Option<Vec<Asked>> {
        let mode = |question: &Question| match question.measure {
            Measure::Frequency { mode } => (mode as usize).checked_sub(1),
            _ => None,
        };
        let value = |mode: usize, question: &Question| {
            let (unit, in_radians) = (question.unit.clone(), question.radians.is_some());
            Asked::Value { mode, unit, in_radians }
        };
        let mut asked = Vec::new();
        for (require, has_column) in scene.scene().requires.iter().zip(&self.measured) {
            let (question, mode) = (&require.question, mode(&require.question)?);
            if matches!(question.value, Number::Jet(_)) {
                return None;
            }
            asked.extend(has_column.then(|| value(mode, question)));
            asked.push(Asked::Verdict { mode, comparison: require.comparison?, limit: question.value.clone() });
        }
        for question in &scene.scene().asked {
            asked.push(value(mode(question)?, question));
        }
        Some(asked)
    }
}

impl Drawn {
    /// The changes from the declared values, parameter by parameter; NaN for a case that lies outside the ranges.
    fn changes(&self, cases: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let is_inside = |values: &Vec<f64>| {
            values.iter().zip(&self.ranges).all(|(value, [_, low, high])| (*low..=*high).contains(value))
        };
        let inside: Vec<bool> = cases.iter().map(is_inside).collect();
        let change = |i: usize| {
            let own =
                |(values, inside): (&Vec<f64>, &bool)| if *inside { values[i] - self.ranges[i][0] } else { f64::NAN };
            cases.iter().zip(&inside).map(own).collect()
        };
        (0..self.ranges.len()).map(change).collect()
    }
}
