//! The undamped frequencies of a study at a value of its parameter, and their enclosures between two values, by
//! classes. A class is a block of coordinates that no value of the parameter couples to others. In: values, SI. Out:
//! frequencies in Hz, ascending in each class.

use super::by_class::{Between, ByClass, Frequencies, Layout};
use crate::analysis::projection::{eigenvalues, project};
use crate::analysis::range::{Course, Family, outer};
use crate::analysis::{self, ModeKind, Modes, Request, joined_by, undamped_block};
use crate::base::number::jet;
use crate::base::{Ball, Dd, Jet, Number, Rational};
use crate::kernel::cores;
use crate::kernel::pencils::Eigenvalues;
use crate::questions::cases::Study;
use crate::questions::lines::{Line, PER_TURN};
use crate::questions::tolerated::hull;
use crate::system::{Form, LinearSystem};
use std::sync::Arc;

/// The frequencies at a value of the parameter.
#[derive(Clone, Debug)]
pub struct Place {
    /// SI
    pub at: Number,
    /// The value in binary64.
    pub x: f64,
    frequencies: ByClass,
}

/// The classes of a study, and the data needed to evaluate them.
#[derive(Clone, Copy, Debug)]
pub struct Field<'a> {
    pub study: &'a Study<'a>,
    /// The coordinates of each class.
    pub classes: &'a [Vec<u32>],
    /// The direction in which all eigenvalues move with the parameter over the whole range, if there is one.
    pub course: Option<Course>,
    /// The line of each class.
    pub lines: &'a [Arc<Option<Line>>],
    /// Whether both matrices are polynomials over steps at all: for choices that prove nothing.
    pub has_polynomials: bool,
}

impl Place {
    /// With the frequencies of each class, which has none if they are not known.
    fn of(at: &Number, classes: &[Frequencies]) -> Place {
        Place { at: at.clone(), x: at.to_f64(), frequencies: ByClass::of(classes) }
    }

    /// The frequencies of a class; empty if they are not known.
    pub fn class(&self, class: usize) -> &[Option<Ball>] {
        self.frequencies.class(class)
    }

    /// Those of each class.
    pub fn classes(&self) -> impl Iterator<Item = &[Option<Ball>]> {
        (0..self.frequencies.count()).map(|class| self.class(class))
    }

    pub fn frequency(&self, class: usize, index: usize) -> Option<Ball> {
        *self.class(class).get(index)?
    }

    /// Whether all frequencies are known.
    fn is_known(&self) -> bool {
        self.frequencies.is_known() && self.classes().all(|class| !class.is_empty())
    }

    /// Whether all modes certainly oscillate: the lowest of each class do.
    pub fn oscillates(&self) -> bool {
        let is_positive = |frequency: &Option<Ball>| frequency.is_some_and(|frequency| frequency.is_positive());
        self.frequencies.count() > 0 && self.classes().all(|class| !class.is_empty() && class.iter().all(is_positive))
    }

    /// The distance from a mode to the next one of its class.
    pub fn distance(&self, class: usize, index: usize) -> Option<Ball> {
        match self.class(class).get(index..index + 2)? {
            [Some(own), Some(next)] => Some(*next - *own),
            _ => None,
        }
    }

    /// An estimate of the distance from a mode to the next one of its class, without a bound: for choices that prove nothing.
    pub fn approximate_distance(&self, class: usize, index: usize) -> Option<f64> {
        match self.class(class).get(index..index + 2)? {
            [Some(own), Some(next)] => Some((next.mid.hi - own.mid.hi) + (next.mid.lo - own.mid.lo)),
            _ => None,
        }
    }
}

/// Limit on the pieces of the range, each of which has one form.
const MOST_PIECES: usize = 64;

/// The classes over the whole range of the parameter, and the direction of the eigenvalues. All coordinates form one class if it is not
/// proved that the model has the same form for every value. Pieces with a common end have the model's form there.
pub fn classes(study: &Study, [low, high]: [&Number; 2], n: usize) -> (Vec<Vec<u32>>, Option<Course>) {
    let (mut left, mut systems) = (vec![[low.clone(), high.clone()]], Vec::new());
    while let Some([low, high]) = left.pop() {
        match enclosing_system(study, [&low, &high], false).filter(|system| system.n() == n) {
            Some(system) => systems.push(system),
            None if left.len() + systems.len() < MOST_PIECES => {
                let middle = &(&low + &high) * &Number::from(Rational::new(1, 2));
                left.extend([[middle.clone(), high], [low, middle]]);
            }
            None => return (vec![(0..n as u32).collect()], None),
        }
    }
    let forms: Vec<&Form> = systems.iter().flat_map(|system| [&system.m, &system.k]).collect();
    let courses = systems.iter().map(|system| Family::course(system, false));
    let course = courses.reduce(|a, b| a.filter(|_| a == b)).flatten();
    (joined_by(n, &forms).into_iter().map(|part| part.coordinates).collect(), course)
}

/// The system for every value between two, if the check and the lowering take the same branches for all of them.
fn enclosing_system(study: &Study, [low, high]: [&Number; 2], is_damped: bool) -> Option<LinearSystem> {
    let range = hull(low.to_ball(), high.to_ball());
    // Ends that are not binary64 numbers were rounded, and so was the middle.
    let range = range.widen(4.0 * f64::EPSILON * range.rad);
    let over = jet::without_division(|| study.lower_case(0, Jet::of_parameter(range), is_damped))??;
    // Where another rest might be found, it has to be the one that is found at both ends.
    let rests_at =
        |end: &Number| study.lower_case(0, end.clone(), is_damped).is_some_and(|at| over.rest.holds(&at.rest));
    let is_followed = !over.rest.may_be_elsewhere() || rests_at(low) && rests_at(high);
    (is_followed && !over.system.is_chained()).then_some(over.system)
}

impl Field<'_> {
    /// The frequencies at a value; with `precisely`, to as many digits as possible.
    pub fn place(&self, at: &Number, precisely: bool) -> Place {
        let quick = |line: &Arc<Option<Line>>| {
            let list = self.study.frequencies_at(line, at)?;
            Some(list.into_iter().map(Some).collect::<Frequencies>())
        };
        if !precisely && let Some(classes) = self.lines.iter().map(quick).collect::<Option<Vec<Frequencies>>>() {
            return Place::of(at, &classes);
        }
        let request = if precisely { Request::default().to_digits(28) } else { Request::default() };
        let system = self.study.undamped_system(0, at.clone()).filter(|system| !system.is_chained());
        let of_class = |coordinates: &Vec<u32>| {
            let modes = system.as_ref().and_then(|system| all_modes(system, coordinates, &request));
            modes.map_or(Vec::new(), |modes| separate(&modes, frequency))
        };
        Place::of(at, &self.classes.iter().map(of_class).collect::<Vec<Frequencies>>())
    }

    /// The places of all cases: the lowest `count` frequencies of each, or all.
    pub fn places(&self, values: &[Number], count: usize) -> Vec<Place> {
        let all: Vec<(u64, &Number)> = (0..).zip(values).collect();
        let layout = Layout::of(self.classes.iter().map(|class| count.min(class.len())));
        let of_cases = |some: &[(u64, &Number)]| {
            let numbers: Vec<u64> = some.iter().map(|(number, _)| *number).collect();
            let mut found = layout.room(some.len());
            for (class, line) in self.lines.iter().enumerate() {
                let [first, count] = layout.class(class);
                self.study.side_by_side(line, &numbers, count, &mut |case, i, frequency| {
                    found[case * layout.whole() + first + i] = Some(frequency);
                });
            }
            let of_case = layout.of_each(found, some.len());
            let place = |(frequencies, &(_, at)): (ByClass, &(u64, &Number))| match frequencies.is_known() {
                true => Place { at: at.clone(), x: at.to_f64(), frequencies },
                false => self.place(at, false),
            };
            of_case.zip(some).map(place).collect()
        };
        cores::in_pieces(&all, 1, 1, of_cases)
    }

    /// Bounds over the steps from these cases to the next ones, for the lowest `count` frequencies of each class, as far as lines know them.
    pub fn over_steps(&self, cases: &[u64], count: usize) -> Vec<Option<[ByClass; 2]>> {
        if self.course.is_some() || self.lines.iter().any(|line| !line.as_ref().as_ref().is_some_and(Line::has_pieces))
        {
            return vec![None; cases.len()];
        }
        let layout = Layout::of(self.classes.iter().map(|class| count.min(class.len())));
        let mut found = [layout.room(cases.len()), layout.room(cases.len())];
        for (class, line) in self.lines.iter().enumerate() {
            let [first, count] = layout.class(class);
            let Some(line) = line.as_ref() else { continue };
            line.over_steps(cases, count, &mut |step, i, pair| {
                let [lower, upper] = bounds_of(pair);
                let at = step * layout.whole() + first + i;
                (found[0][at], found[1][at]) = (lower, upper);
            });
        }
        let [lower, upper] = found.map(|list| layout.of_each(list, cases.len()));
        lower.zip(upper).map(|(lower, upper)| upper.is_known().then_some([lower, upper])).collect()
    }

    /// Bounds for all values between two places. Where all eigenvalues move in one direction, these are the frequencies at the places
    /// themselves.
    pub fn bounds_between<'b>(&self, [first, last]: [&'b Place; 2]) -> Between<'b> {
        match self.course {
            Some(course) if first.is_known() && last.is_known() => {
                let rises = (course == Course::Rises) == (first.x <= last.x);
                let [first, last] = [first, last].map(|place| &place.frequencies);
                Between::Known(if rises { [first, last] } else { [last, first] })
            }
            _ => self.bounds([&first.at, &last.at]),
        }
    }

    /// The system for every value between two, if the model certainly has one form there.
    pub fn system_over(&self, ends: [&Number; 2], is_damped: bool) -> Option<LinearSystem> {
        enclosing_system(self.study, ends, is_damped)
    }

    /// Whether the model certainly has one form for all values between two, so that its matrices depend continuously on the parameter.
    pub fn has_one_form(&self, ends: [&Number; 2], is_damped: bool) -> bool {
        enclosing_system(self.study, ends, is_damped).is_some()
    }

    /// Bounds for all values between two, for each class; by Weyl's inequality as in `outer`, or by the modes in the
    /// middle if rows change. `None` if nothing is proved.
    pub fn bounds(&self, ends: [&Number; 2]) -> Between<'static> {
        let quick = |line: &Arc<Option<Line>>| bounds_of_all(&(**line).as_ref()?.eigenvalues_over(ends)?);
        if let Some(list) = self.lines.iter().map(quick).collect::<Option<Vec<[Frequencies; 2]>>>() {
            return Between::Found(list.into_iter().map(Some).collect());
        }
        let over = enclosing_system(self.study, ends, false);
        let sides = over.as_ref().and_then(outer);
        // If rows change, both matrices as polynomials over this step alone.
        let is_one = self.classes.len() == 1;
        let by_polynomials = |coordinates: &Vec<u32>| {
            let class = Some(&coordinates[..]).filter(|_| !is_one);
            let found = bounds_of_all(&self.study.eigenvalues_between(ends, class)?)?;
            // Whether a mode is rigid is decided by the other methods.
            found[0].iter().all(Option::is_some).then_some(found)
        };
        if self.has_polynomials
            && over.is_some()
            && sides.is_none()
            && let Some(list) = self.classes.iter().map(by_polynomials).collect::<Option<Vec<[Frequencies; 2]>>>()
        {
            return Between::Found(list.into_iter().map(Some).collect());
        }
        let middle = match (&over, &sides) {
            (Some(_), None) => {
                let [low, high] = ends.map(Number::to_f64);
                binary(low + (high - low) / 2.0).and_then(|at| self.study.undamped_system(0, at))
            }
            _ => None,
        };
        let of_class = |coordinates: &Vec<u32>| {
            if let (Some(over), Some(middle)) = (&over, &middle) {
                return bounds_around(over, middle, coordinates);
            }
            let [low, high] =
                sides.as_ref()?.each_ref().map(|system| all_modes(system, coordinates, &Request::default()));
            let upper = separate(&high?, |modes, i| Some(from_above(modes, i)));
            Some([separate(&low?, frequency), upper])
        };
        Between::Found(self.classes.iter().map(of_class).collect())
    }
}

/// Bounds of all frequencies, if they are known.
fn bounds_of_all(Eigenvalues { list, bounds }: &Eigenvalues) -> Option<[Frequencies; 2]> {
    let pairs = list.iter().zip(bounds).map(|(x, bound)| bounds_of([*x, *bound]));
    let (lower, upper): (Frequencies, Frequencies) = pairs.map(|[lower, upper]| (lower, upper)).unzip();
    upper.iter().all(Option::is_some).then_some([lower, upper])
}

/// Bounds of the frequency of an eigenvalue that is this far from the number at most: no upper one if they are not known.
fn bounds_of([square, bound]: [f64; 2]) -> [Option<Ball>; 2] {
    // Two roundings of the end, three of the root, and that of the factor.
    let slack = 2.0 * f64::EPSILON * (square.abs() + bound);
    let root = |square: f64, sign: f64| Ball::from(square.sqrt() * PER_TURN * (1.0 + sign * 4.0 * f64::EPSILON));
    let [low, high] = [square - bound - slack, square + bound + slack];
    let lower = (low > 0.0).then(|| root(low, -1.0));
    let upper = if high > 0.0 { root(high, 1.0) } else { Ball::ZERO };
    [lower, (low.is_finite() && high.is_finite()).then_some(upper)]
}

/// Bounds for a system over a range in coordinates of the modes of one in its middle: both matrices are nearly diagonal there.
fn bounds_around(over: &LinearSystem, middle: &LinearSystem, coordinates: &[u32]) -> Option<[Frequencies; 2]> {
    if middle.is_chained() || middle.n() != over.n() {
        return None;
    }
    let modes = all_modes(middle, coordinates, &Request::default())?;
    let vectors: Vec<Vec<Dd>> =
        modes.list.iter().map(|mode| mode.shape.iter().map(|x| Dd::from(*x)).collect()).collect();
    let block = undamped_block(over, coordinates)?;
    let [k, m] = [&block.k, &block.m].map(|form| project(form, &vectors));
    let ends = eigenvalues(&k, &m, coordinates.len())?;
    let root = |square: f64| analysis::derived::hertz(Ball::from(square).sqrt());
    Some([
        ends.iter().map(|[low, _]| (*low > 0.0).then(|| root(*low))).collect(),
        ends.iter().map(|[_, high]| Some(if *high > 0.0 { root(*high) } else { Ball::ZERO })).collect(),
    ])
}

/// The nearest binary64 number, exactly.
pub fn binary(x: f64) -> Option<Number> {
    Rational::from_f64(x).map(Number::from)
}

/// The modes of a class, if there is one for each coordinate: M is then positive definite.
fn all_modes(system: &LinearSystem, coordinates: &[u32], request: &Request) -> Option<Modes> {
    let block = undamped_block(system, coordinates)?;
    let modes = analysis::modes_as(&block, request).ok()?;
    (modes.infinite == 0 && modes.is_complete() && modes.list.len() == coordinates.len()).then_some(modes)
}

fn frequency(modes: &Modes, i: usize) -> Option<Ball> {
    let mode = &modes.list[i];
    match mode.kind {
        ModeKind::Rigid => Some(Ball::ZERO),
        _ => mode.frequency().filter(|frequency| frequency.is_finite()),
    }
}

/// The square root of an upper bound of omega^2, in Hz: zero for a divergence.
fn from_above(modes: &Modes, i: usize) -> Ball {
    let mode = &modes.list[i];
    match mode.kind {
        ModeKind::Divergence | ModeKind::Rigid => Ball::ZERO,
        _ => analysis::derived::hertz(mode.omega),
    }
}

/// The i-th frequency in the order of the true values. Modes with overlapping enclosures may be in another order, so
/// each gets the hull of theirs.
fn separate(modes: &Modes, of: impl Fn(&Modes, usize) -> Option<Ball>) -> Frequencies {
    let mut list: Frequencies = (0..modes.list.len()).map(|i| of(modes, i)).collect();
    let mut first = 0;
    while first < list.len() {
        let (mut last, mut whole) = (first, list[first]);
        while let (Some(known), Some(Some(next))) = (whole, list.get(last + 1))
            && !(*next - known).is_positive()
            && !(next.is_zero() && known.is_zero())
        {
            whole = Some(hull(known, *next));
            last += 1;
        }
        list[first..=last].fill(whole);
        first = last + 1;
    }
    list
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Squares within 3 of 4, and within 3 of 1.
    #[test]
    fn bounds_hold_both_ends() {
        let found = [[1.0, 3.0], [4.0, 3.0]].map(bounds_of);
        let hertz = |omega: f64| omega / (2.0 * std::f64::consts::PI);
        let [lower, upper] = [0, 1].map(|end| found.map(|pair| pair[end].map(|x| x.to_f64())));
        assert_eq!(lower[0], None);
        for (found, truth) in [(lower[1], 1.0), (upper[0], 2.0), (upper[1], f64::sqrt(7.0))] {
            assert!((found.expect("a frequency") / hertz(truth) - 1.0).abs() < 1e-14, "{found:?} {truth}");
        }
    }
}
