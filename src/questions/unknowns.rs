//! The lines `solve`: finds every unknown, on its own if possible, otherwise in a group. In: the text and its scene.
//! Out: a value for each unknown, or an error. See docs/method/measures.md.

use super::answer::{Derivative, Optimised, Others, Shown, Solved, shown_in, shown_text};
use super::derivative::{slope, step};
use super::error::{AskedError, Phrase, ReachedRange};
use super::newton;
use super::one_unknown::extremes;
use super::range_enclosure::{Centre, QuestionOverRange, RangeEnclosure};
use super::search::{Difference, Evaluation, Root, SearchResult};
use super::trial::{Facts, Text};
use crate::analysis::Measurement;
use crate::analysis::derived::hertz;
use crate::base::{Ball, Dd, Jet, Number, Quantity, Rational, Unproven, up};
use crate::model::scene::{Measure, Question, Solve};
use crate::model::{CheckedScene, Setting};

/// A scene with its unknowns at the values that were found.
#[derive(Clone, Debug)]
pub struct Settled {
    pub scene: CheckedScene,
    /// The values as settings, for trials with other values of other parameters.
    pub settings: Vec<Setting>,
    pub solved: Vec<Solved>,
    pub optimised: Vec<Optimised>,
    /// Parts of ranges that were not settled, and optima at ends of ranges.
    pub unsettled: Vec<AskedError>,
}

/// Finds every unknown.
pub fn solve(text: &Text, scene: &CheckedScene) -> Result<Settled, Vec<AskedError>> {
    let solves = &scene.scene().solves;
    let twice = duplicate_unknowns(solves);
    if !twice.is_empty() {
        return Err(twice);
    }
    let mut unknowns = Unknowns::of(*text, solves, scene.scene().bodies.len());
    for group in unknowns.groups()? {
        match group[..] {
            [(equation, unknown)] => unknowns.solve_one(equation, unknown)?,
            _ => newton::solve_group(&mut unknowns, &group)?,
        }
    }
    let solved = (0..solves.len()).map(|i| unknowns.report(i)).collect();
    let unsettled = (0..solves.len()).filter_map(|i| unknowns.unsettled_part(i)).collect();
    let settings = unknowns.settings();
    match text.scene(&settings) {
        Ok(scene) => Ok(Settled { scene, settings, solved, optimised: Vec::new(), unsettled }),
        Err(why) => Err(vec![unknowns.refused_error(why)]),
    }
}

/// Errors for parameters that are solved for more than once.
fn duplicate_unknowns(solves: &[Solve]) -> Vec<AskedError> {
    let again = solves.iter().enumerate().filter_map(|(i, solve)| {
        let first = solves[..i].iter().find(|first| first.parameter.name == solve.parameter.name)?;
        Some(AskedError::Twice { span: solve.span, name: solve.parameter.name.clone(), first: first.span })
    });
    again.collect()
}

/// The unknowns and their present values.
pub struct Unknowns<'a> {
    text: Text<'a>,
    pub solves: &'a [Solve],
    /// SI.
    pub values: Vec<Number>,
    /// Bounds of the distances from the roots, SI; `None` if none is proven.
    pub within: Vec<Option<f64>>,
    /// Whether other values in the ranges are excluded.
    pub others: Vec<Others>,
    /// Number of values at which each was evaluated.
    pub evaluations: Vec<usize>,
    /// The equation that was solved for each unknown.
    equation: Vec<usize>,
    /// Bodies of the scene.
    parts: usize,
}

/// An equation and the unknown that it is solved for.
pub type Pairing = (usize, usize);

impl<'a> Unknowns<'a> {
    fn of(text: Text<'a>, solves: &'a [Solve], parts: usize) -> Unknowns<'a> {
        let start = |solve: &Solve| {
            let declared = &solve.parameter.value.si;
            let inside = !(declared - &solve.low).is_negative() && !(&solve.high - declared).is_negative();
            if inside { declared.clone() } else { interpolate(&solve.low, &solve.high, 1, 2) }
        };
        Unknowns {
            text,
            solves,
            values: solves.iter().map(start).collect(),
            within: vec![None; solves.len()],
            others: vec![Others::Unknown; solves.len()],
            evaluations: vec![0; solves.len()],
            equation: (0..solves.len()).collect(),
            parts,
        }
    }

    fn settings_at(&self, values: &[Number]) -> Vec<Setting> {
        let setting = |(solve, value): (&Solve, &Number)| {
            let quantity = Quantity { si: value.clone(), ..solve.parameter.value.clone() };
            (solve.parameter.name.clone(), quantity)
        };
        self.solves.iter().zip(values).map(setting).collect()
    }

    pub fn settings(&self) -> Vec<Setting> {
        self.settings_at(&self.values)
    }

    /// The measures of some equations minus their targets, at the given values of all unknowns.
    pub fn differences(&self, equations: &[usize], values: &[Number]) -> Vec<Difference> {
        let questions = |scene: &CheckedScene| -> Vec<Question> {
            equations.iter().map(|&i| scene.scene().solves[i].question.clone()).collect()
        };
        match self.text.crossings(&self.settings_at(values), questions) {
            Err(why) => vec![Difference::None(why); equations.len()],
            Ok(measured) => {
                let questions = equations.iter().map(|&i| &self.solves[i].question);
                questions.zip(measured).map(|(question, measured)| crossing(question, measured)).collect()
            }
        }
    }

    /// The difference of one equation, with one unknown at another value.
    pub fn difference(&self, equation: usize, unknown: usize, value: &Number) -> Difference {
        let mut values = self.values.clone();
        values[unknown] = value.clone();
        self.differences(&[equation], &values).pop().unwrap_or(Difference::None(String::new()))
    }

    /// Encloses an equation's measure while one unknown lies in a range.
    pub fn enclose_over(&self, equation: usize, unknown: usize, range: Ball) -> RangeEnclosure {
        let mut values = self.values.clone();
        values[unknown] = Jet::of_parameter(range);
        self.ask(equation, &values, |asked| asked.enclose_measure()).unwrap_or_else(RangeEnclosure::silent)
    }

    /// Applies `tell` to an equation's measure with some of the values being ranges.
    pub fn ask<T>(&self, equation: usize, values: &[Number], tell: impl FnOnce(&QuestionOverRange) -> T) -> Option<T> {
        let choose = |scene: &CheckedScene| scene.scene().solves.get(equation).map(|solve| solve.question.clone());
        self.text.enclose_over(&self.settings_at(values), choose, tell)
    }

    /// The eigenvalue or the pole that an equation's measure depends on.
    pub fn centre(&self, equation: usize, values: &[Number]) -> Option<Centre> {
        let choose = |scene: &CheckedScene| scene.scene().solves.get(equation).map(|solve| solve.question.clone());
        self.text.centre(&self.settings_at(values), choose)
    }

    /// Whether the measure is exactly at its target at a value.
    pub fn meets(&self, equation: usize, unknown: usize, value: &Number) -> bool {
        let mut values = self.values.clone();
        values[unknown] = value.clone();
        let Ok(scene) = self.text.scene(&self.settings_at(&values)) else { return false };
        let Some(solve) = scene.scene().solves.get(equation) else { return false };
        self.text.compare(&scene, &solve.question, Facts::default()) == Some(std::cmp::Ordering::Equal)
    }

    /// Limit on the evaluations over parts of a range, for a scene of this size.
    pub fn effort(&self) -> usize {
        (60_000 / (self.parts + 7).pow(2)).clamp(60, 1200)
    }

    /// Equations and unknowns in the order in which they can be solved; those that depend on each other form a group.
    fn groups(&self) -> Result<Vec<Vec<Pairing>>, Vec<AskedError>> {
        let count = self.solves.len();
        if count == 1 {
            return Ok(vec![vec![(0, 0)]]);
        }
        let depends = self.dependence();
        let Some(paired) = pairing(&depends) else { return Err(vec![self.unsettled_error(&depends)]) };
        Ok(order_groups(&depends, &paired))
    }

    /// Whether each equation depends on each unknown, found by evaluating its measure at several values of the unknown.
    fn dependence(&self) -> Vec<Vec<bool>> {
        let count = self.solves.len();
        let all: Vec<usize> = (0..count).collect();
        let mut depends = vec![vec![false; count]; count];
        for places in [[1, 3], [2, 5]] {
            let start: Vec<Number> =
                self.solves.iter().map(|solve| interpolate(&solve.low, &solve.high, places[0], places[1])).collect();
            let here = self.differences(&all, &start);
            for unknown in 0..count {
                let mut values = start.clone();
                values[unknown] = interpolate(&self.solves[unknown].low, &self.solves[unknown].high, 3, 4);
                let there = self.differences(&all, &values);
                for equation in 0..count {
                    let known = |d: &Difference| matches!(d, Difference::Known(_));
                    let same = known(&here[equation]) && here[equation] == there[equation];
                    depends[equation][unknown] |= !same;
                }
            }
        }
        depends
    }

    /// The error if some equation depends on no unknown, or several depend on too few.
    fn unsettled_error(&self, depends: &[Vec<bool>]) -> AskedError {
        let idle = depends.iter().position(|row| !row.contains(&true));
        match idle {
            Some(equation) => {
                let Solve { parameter, span, question, .. } = &self.solves[equation];
                let (measure, name) = (self.measure(question), parameter.name.clone());
                AskedError::Independent { span: *span, measure, at: question.span, name }
            }
            None => self.singular(&(0..self.solves.len()).collect::<Vec<_>>()),
        }
    }

    pub fn singular(&self, unknowns: &[usize]) -> AskedError {
        let (span, others) = self.spans(unknowns);
        AskedError::Singular { span, names: self.names(unknowns), others }
    }

    pub fn spans(&self, unknowns: &[usize]) -> (crate::base::Span, Vec<crate::base::Span>) {
        let mut lines: Vec<usize> = unknowns.to_vec();
        lines.sort_unstable();
        let others = lines[1..].iter().map(|&i| self.solves[i].span).collect();
        (self.solves[lines[0]].span, others)
    }

    pub fn names(&self, unknowns: &[usize]) -> Vec<String> {
        unknowns.iter().map(|&i| self.solves[i].parameter.name.clone()).collect()
    }

    /// Sets an unknown to the shortest number in its own unit that the bound allows.
    pub fn take(&mut self, equation: usize, unknown: usize, root: &Root, evaluations: usize, others: Others) {
        let solve = &self.solves[unknown];
        let value = shortest(root, solve.parameter.unit.factor.as_ref());
        let away = (value.to_ball() - Ball::exact(root.near)).magnitude();
        self.within[unknown] = root.proof.map(|_| (root.within + away) * up::THOUSANDS);
        self.others[unknown] = others;
        self.values[unknown] = value;
        self.evaluations[unknown] = evaluations;
        self.equation[unknown] = equation;
    }

    fn independent(&self, equation: usize, unknown: usize) -> AskedError {
        let question = &self.solves[equation].question;
        AskedError::Independent {
            span: self.solves[unknown].span,
            measure: self.measure(question),
            at: question.span,
            name: self.solves[unknown].parameter.name.clone(),
        }
    }

    /// The error if parts of an unknown's range were not settled.
    fn unsettled_part(&self, unknown: usize) -> Option<AskedError> {
        let Others::Unsettled(parts) = &self.others[unknown] else { return None };
        let solve = &self.solves[unknown];
        let (name, value) = (solve.parameter.name.clone(), self.value_text(unknown, &self.values[unknown]));
        Some(AskedError::Unsettled { span: solve.span, name, value, parts: parts.clone() })
    }

    /// The error if the model is refused with the values that were found.
    fn refused_error(&self, why: String) -> AskedError {
        let Solve { parameter, span, question, low, high } = &self.solves[0];
        let range = (self.value_text(0, low), self.value_text(0, high));
        let (measure, name) = (self.measure(question), parameter.name.clone());
        AskedError::NoValue { span: *span, measure, name, range, why }
    }

    /// The error for a measure that never reaches its target, as far as is known.
    pub fn no_root(&self, equation: usize, unknown: usize, seen: &SearchResult, proven: bool) -> AskedError {
        let solve = &self.solves[unknown];
        let question = &self.solves[equation].question;
        let (measure, name) = (self.measure(question), solve.parameter.name.clone());
        let range = (self.value_text(unknown, &solve.low), self.value_text(unknown, &solve.high));
        let gap = seen.evaluations.iter().find_map(|evaluation| match &evaluation.difference {
            Difference::None(why) => Some(why.clone()),
            _ => None,
        });
        let Some((least, largest)) = extremes(&seen.evaluations) else {
            return AskedError::NoValue { span: solve.span, measure, name, range, why: gap.unwrap_or_default() };
        };
        if constant(&seen.evaluations) {
            return self.independent(equation, unknown);
        }
        let at = |evaluation: &Evaluation| {
            (self.reached_value(equation, &evaluation.difference), self.value_text(unknown, &evaluation.at))
        };
        let jump = seen.jumps.first();
        let reach = ReachedRange {
            least: at(least),
            largest: at(largest),
            jump: jump.and_then(|&x| Rational::from_f64(x)).map(|x| self.value_text(unknown, &Number::from(x))),
            gap,
            proven,
            evaluations: seen.count,
        };
        // An overdamped motion has the ratio 1 too.
        let target = self.target(equation) + if is_of_critical(&solve.question) { " (critical damping)" } else { "" };
        AskedError::NoRoot { span: solve.span, measure, target, name, range, reach }
    }

    /// A value of an unknown as text, in its own unit.
    pub fn value_text(&self, unknown: usize, value: &Number) -> Phrase {
        shown_text(&shown_in(value, &self.solves[unknown].parameter.unit, false))
    }

    /// The measure as it is written.
    pub fn measure(&self, question: &Question) -> String {
        question.name(self.text.sources.slice(question.span))
    }

    /// The target of a measure as text.
    pub fn target(&self, equation: usize) -> Phrase {
        shown_text(&self.in_unit(equation, &self.solves[equation].question.value))
    }

    /// The value of a measure that differs from its target by this much, as text.
    pub fn reached_value(&self, equation: usize, difference: &Difference) -> Phrase {
        let question = &self.solves[equation].question;
        match difference {
            // The difference is of a quantity that changes sign in place of the measure.
            Difference::Known(ball) if is_of_critical(question) => {
                if ball.is_negative() { "below 1" } else { "1 (overdamped)" }.to_string()
            }
            Difference::Known(ball)
                if question.value.is_zero() && matches!(question.measure, Measure::Frequency { .. }) =>
            {
                let text = shown_text(&self.in_unit(equation, &Number::Ball(hertz(ball.abs().sqrt()))));
                if ball.is_negative() { format!("diverging (growth rate {text})") } else { text }
            }
            Difference::Known(ball) => {
                let value = self.solves[equation].question.value.to_ball() + *ball;
                shown_text(&self.in_unit(equation, &Number::Ball(value)))
            }
            Difference::Infinite => "infinity".to_string(),
            Difference::None(why) => why.clone(),
        }
    }

    fn in_unit(&self, equation: usize, value: &Number) -> Shown<'_> {
        let question = &self.solves[equation].question;
        shown_in(value, &question.unit, question.radians.is_some())
    }

    /// The report on an unknown, once all of them are found.
    fn report(&self, unknown: usize) -> Solved {
        let equation = self.equation[unknown];
        let (solve, question) = (&self.solves[unknown], &self.solves[equation].question);
        let value = &self.values[unknown];
        let residual = self.residual(equation, value);
        let slope = self.slope(equation, unknown, value, residual);
        Solved {
            parameter: solve.parameter.name.clone(),
            span: solve.span,
            value: value.clone(),
            unit: solve.parameter.unit.clone(),
            bound: self.within[unknown],
            others: self.others[unknown].clone(),
            measure: self.measure(question),
            target: question.value.clone(),
            target_unit: question.unit.clone(),
            in_radians: question.radians.is_some(),
            residual: residual.unwrap_or(Ball::new(Dd::ZERO, f64::INFINITY)),
            slope,
            evaluations: self.evaluations[unknown],
            until: self.text.simulated_time(&question.measure),
        }
    }
}

impl Unknowns<'_> {
    /// The measure minus its target, at the values that were found; for a target frequency of zero, by its square.
    fn residual(&self, equation: usize, value: &Number) -> Option<Ball> {
        let unknown = self.equation.iter().position(|&known| known == equation)?;
        let question = &self.solves[equation].question;
        let crossing = finite_value(self.difference(equation, unknown, value));
        match &question.measure {
            Measure::Frequency { .. } if question.value.is_zero() => {
                let square = crossing?;
                let largest = hertz(Ball::from(square.magnitude()).sqrt());
                Some(if square.is_zero() { Ball::ZERO } else { Ball::ZERO.widen(largest.magnitude()) })
            }
            Measure::DampingRatio { .. } if question.value.is_one() => {
                let settings = self.settings();
                let measured = self.text.measure(&settings, |_| vec![question.clone()]).ok()?.pop()?;
                finite_value(difference(question, measured))
            }
            _ => crossing,
        }
    }

    /// The derivative of the measure with respect to its unknown: enclosed if the numbers of the system are, otherwise by
    /// differences.
    fn slope(&self, equation: usize, unknown: usize, value: &Number, residual: Option<Ball>) -> Option<Derivative> {
        let question = &self.solves[equation].question;
        if question.value.is_zero() && matches!(question.measure, Measure::Frequency { .. })
            || question.value.is_one() && matches!(question.measure, Measure::DampingRatio { .. })
        {
            // The measure is the square root of a quantity that changes sign here, so it has no derivative.
            return None;
        }
        let mut values = self.values.clone();
        values[unknown] = value.clone();
        let centre = self.centre(equation, &values);
        values[unknown] = Jet::of_parameter(value.enclosure());
        if let Some(slope) = centre.and_then(|centre| self.ask(equation, &values, |asked| asked.slope(&centre))?) {
            return Some(Derivative::Enclosed(slope));
        }
        let relative = residual.map_or(1.0, |ball| ball.rad / question.value.to_f64().abs().max(f64::MIN_POSITIVE));
        let h = step(value, &Number::ONE, relative);
        let at = |x: Number| finite_value(self.difference(equation, unknown, &x));
        let seen = slope(at(value - &h), residual, at(value + &h), &h).ok()?;
        Some(Derivative::Estimated(Unproven(seen.to_f64())))
    }
}

pub fn finite_value(difference: Difference) -> Option<Ball> {
    match difference {
        Difference::Known(ball) if ball.is_finite() => Some(ball),
        _ => None,
    }
}

/// Whether a question is for critical damping, which poles that meet tell, and not the ratio.
fn is_of_critical(question: &Question) -> bool {
    question.value.is_one() && matches!(question.measure, Measure::DampingRatio { .. })
}

/// The difference for a quantity that changes sign where the measure's range ends (see
/// [`super::probe::prepare_crossings`]).
fn crossing(question: &Question, measured: Measurement) -> Difference {
    let ends = matches!(question.measure, Measure::DampingRatio { .. }) && question.value.is_one();
    let asked = if ends { &Question { value: Number::ZERO, ..question.clone() } } else { question };
    difference(asked, measured)
}

/// The measure minus its target; for an angle, the shorter way round.
pub fn difference(question: &Question, measured: Measurement) -> Difference {
    let value = match measured {
        Measurement::Value(value) => value,
        Measurement::Infinite => return Difference::Infinite,
        Measurement::None(why) => return Difference::None(why.to_string()),
        Measurement::Failed(why) => return Difference::None(why),
    };
    let difference = value - question.value.to_ball();
    let turn = Ball::from(2.0) * Ball::PI;
    Difference::Known(match question.measure {
        Measure::Phase { .. } if difference.to_f64() > std::f64::consts::PI => difference - turn,
        Measure::Phase { .. } if difference.to_f64() < -std::f64::consts::PI => difference + turn,
        _ => difference,
    })
}

/// Whether all evaluations gave the same enclosure.
pub fn constant(evaluations: &[Evaluation]) -> bool {
    evaluations.len() > 1 && evaluations.windows(2).all(|pair| pair[0].difference == pair[1].difference)
}

/// low + (high - low) part / whole
pub fn interpolate(low: &Number, high: &Number, part: i64, whole: i64) -> Number {
    low + &(&(high - low) * &Number::from(Rational::new(part, whole)))
}

/// The number with the fewest digits, in the unit with this factor, that lies within the bound.
pub fn shortest(root: &Root, factor: Option<&Number>) -> Number {
    let one = Number::ONE;
    let factor = factor.unwrap_or(&one);
    let target = Ball::exact(root.near) / factor.to_ball();
    let decimals = (1..=MOST_DIGITS).filter_map(|digits| decimal(target.mid, digits)).map(|d| &d * factor);
    let candidates = std::iter::once(Number::ZERO).chain(decimals);
    let mut near = candidates.filter(|value| (value.to_ball() - Ball::exact(root.near)).magnitude() <= root.within);
    near.next().unwrap_or_else(|| super::search::to_fraction(root.near))
}

const MOST_DIGITS: i32 = 33;

/// A double-double rounded to this number of significant digits.
fn decimal(x: Dd, digits: i32) -> Option<Number> {
    let text = format!("{:e}", x.hi);
    let exponent: i32 = text.split_once('e')?.1.parse().ok()?;
    let shift = digits - 1 - exponent;
    let Number::Exact(exact) = super::search::to_fraction(x) else { return None };
    let power = Rational::from_decimal(&format!("1e{shift}"))?;
    let whole = (&exact * &power).to_big().round().to_integer();
    Rational::from_decimal(&format!("{whole}e{}", -shift)).map(Number::from)
}

/// An unknown for each equation such that each equation depends on its own; `None` if there is no such choice.
fn pairing(depends: &[Vec<bool>]) -> Option<Vec<usize>> {
    let count = depends.len();
    let mut owner: Vec<Option<usize>> = vec![None; count];
    // The unknown in the equation's own line is tried first.
    for equation in 0..count {
        let mut tried = vec![false; count];
        if !assign_unknown(depends, equation, &mut owner, &mut tried) {
            return None;
        }
    }
    let mut unknown_of = vec![0; count];
    owner.iter().enumerate().for_each(|(unknown, equation)| {
        if let Some(equation) = equation {
            unknown_of[*equation] = unknown;
        }
    });
    Some(unknown_of)
}

/// Gives an equation an unknown, reassigning others if necessary (Kuhn's augmenting paths; recurses at most once per
/// line).
fn assign_unknown(depends: &[Vec<bool>], equation: usize, owner: &mut [Option<usize>], tried: &mut [bool]) -> bool {
    let own_first = std::iter::once(equation).chain((0..depends.len()).filter(|&unknown| unknown != equation));
    for unknown in own_first.collect::<Vec<_>>() {
        if !depends[equation][unknown] || tried[unknown] {
            continue;
        }
        tried[unknown] = true;
        let free = match owner[unknown] {
            None => true,
            Some(other) => assign_unknown(depends, other, owner, tried),
        };
        if free {
            owner[unknown] = Some(equation);
            return true;
        }
    }
    false
}

/// Groups of equations that depend on each other's unknowns; each group comes after those that it depends on.
fn order_groups(depends: &[Vec<bool>], unknown_of: &[usize]) -> Vec<Vec<Pairing>> {
    let count = depends.len();
    // reaches[i][j]: equation i needs the unknown of equation j, directly or not (Warshall).
    let mut reaches: Vec<Vec<bool>> =
        (0..count).map(|i| (0..count).map(|j| i == j || depends[i][unknown_of[j]]).collect()).collect();
    for through in 0..count {
        for i in 0..count {
            for j in 0..count {
                reaches[i][j] |= reaches[i][through] && reaches[through][j];
            }
        }
    }
    let mut groups: Vec<Vec<Pairing>> = Vec::new();
    let mut left: Vec<usize> = (0..count).collect();
    while let Some(&first) = left.iter().find(|&&i| left.iter().all(|&j| !reaches[i][j] || reaches[j][i])) {
        let group: Vec<usize> = left.iter().copied().filter(|&j| reaches[first][j] && reaches[j][first]).collect();
        left.retain(|equation| !group.contains(equation));
        groups.push(group.into_iter().map(|equation| (equation, unknown_of[equation])).collect());
    }
    groups
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shortest_number_within_the_bound_is_printed() {
        let root = Root::seen_root(Dd::from(800.0) + Dd::from(1e-26), 1e-25);
        assert_eq!(shortest(&root, None), Number::from(800));
        let third = Root::seen_root(Dd::ONE / Dd::from(3.0), 1e-6);
        assert_eq!(shortest(&third, None), Number::from(Rational::from_decimal("0.333333").unwrap()));
    }

    #[test]
    fn equations_are_solved_in_an_order_that_works() {
        // The second depends on both unknowns, the first on the second alone.
        let depends = vec![vec![false, true], vec![true, true]];
        let paired = pairing(&depends).expect("a pairing");
        assert_eq!(order_groups(&depends, &paired), [vec![(0, 1)], vec![(1, 0)]]);
        assert_eq!(pairing(&[vec![true, false], vec![true, false]]), None);
        let both = vec![vec![true, true], vec![true, true]];
        assert_eq!(order_groups(&both, &pairing(&both).unwrap()).len(), 1);
    }
}
