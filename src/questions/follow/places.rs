//! The undamped frequencies of a study at a value of its parameter, and their enclosures between two values, by
//! classes. A class is a block of coordinates that no value of the parameter couples to others. In: values, SI. Out:
//! frequencies in Hz, ascending in each class.

use crate::analysis::projection::{eigenvalues, project};
use crate::analysis::range::{Course, Family, outer};
use crate::analysis::{self, ModeKind, Modes, Request, joined_by, undamped_block};
use crate::base::number::jet;
use crate::base::{Ball, Dd, Jet, Number, Rational};
use crate::kernel::cores;
use crate::kernel::pencils::Eigenvalues;
use crate::questions::cases::Study;
use crate::questions::lines::Line;
use crate::questions::tolerated::hull;
use crate::system::{Form, LinearSystem};
use std::borrow::Cow;
use std::sync::Arc;

/// The frequency of a mode that oscillates or is rigid.
pub type Frequencies = Vec<Option<Ball>>;

/// The frequencies at a value of the parameter.
#[derive(Clone, Debug)]
pub struct Place {
    /// SI
    pub at: Number,
    /// For each class; empty if they are not known.
    pub classes: Vec<Frequencies>,
}

/// Bounds of the frequencies of a class for all values between two: the i-th frequency lies between the i-th bounds. A
/// lower bound is `None` if the mode may not oscillate.
#[derive(Clone, Debug)]
pub struct Bounds<'a> {
    pub lower: Cow<'a, [Option<Ball>]>,
    pub upper: Cow<'a, [Option<Ball>]>,
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
}

impl Place {
    pub fn frequency(&self, class: usize, index: usize) -> Option<Ball> {
        *self.classes.get(class)?.get(index)?
    }

    /// Whether all modes certainly oscillate: the lowest of each class do.
    pub fn oscillates(&self) -> bool {
        let is_positive = |frequency: &Option<Ball>| frequency.is_some_and(|frequency| frequency.is_positive());
        let oscillate = |class: &Frequencies| !class.is_empty() && class.iter().all(is_positive);
        !self.classes.is_empty() && self.classes.iter().all(oscillate)
    }

    /// The distance from a mode to the next one of its class.
    pub fn distance(&self, class: usize, index: usize) -> Option<Ball> {
        Some(self.frequency(class, index + 1)? - self.frequency(class, index)?)
    }
}

impl Bounds<'_> {
    /// A lower bound of the distance between a mode and the next.
    pub fn distance(&self, index: usize) -> Option<Ball> {
        Some((*self.lower.get(index + 1)?)? - (*self.upper.get(index)?)?)
    }

    /// Whether the i-th mode and the next are certainly separate curves: apart, or both rigid for every value.
    pub fn are_apart(&self, index: usize) -> bool {
        let is_rigid = |index: usize| {
            let rigid = |list: &[Option<Ball>]| matches!(list.get(index), Some(Some(frequency)) if frequency.is_zero());
            rigid(&self.lower) && rigid(&self.upper)
        };
        self.distance(index).is_some_and(|least| least.is_positive()) || is_rigid(index) && is_rigid(index + 1)
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
        if !precisely && let Some(classes) = self.lines.iter().map(quick).collect() {
            return Place { at: at.clone(), classes };
        }
        let request = if precisely { Request::default().to_digits(28) } else { Request::default() };
        let system = self.study.undamped_system(0, at.clone()).filter(|system| !system.is_chained());
        let of_class = |coordinates: &Vec<u32>| {
            let modes = system.as_ref().and_then(|system| all_modes(system, coordinates, &request));
            modes.map_or(Vec::new(), |modes| separate(&modes, frequency))
        };
        Place { at: at.clone(), classes: self.classes.iter().map(of_class).collect() }
    }

    /// The places of all cases: the lowest `count` frequencies of each, or all.
    pub fn places(&self, values: &[Number], count: usize) -> Vec<Place> {
        let all: Vec<(u64, &Number)> = (0..).zip(values).collect();
        let of_cases = |some: &[(u64, &Number)]| {
            let numbers: Vec<u64> = some.iter().map(|(number, _)| *number).collect();
            let of_class = |(line, coordinates): (&Arc<Option<Line>>, &Vec<u32>)| {
                self.study.side_by_side(line, &numbers, count.min(coordinates.len()))
            };
            let quick: Vec<Vec<Option<Vec<Ball>>>> = self.lines.iter().zip(self.classes).map(of_class).collect();
            let place = |(case, &(_, at)): (usize, &(u64, &Number))| {
                let list = |of: &Vec<Option<Vec<Ball>>>| Some(of[case].as_ref()?.iter().copied().map(Some).collect());
                match quick.iter().map(list).collect::<Option<Vec<Frequencies>>>() {
                    Some(classes) => Place { at: at.clone(), classes },
                    None => self.place(at, false),
                }
            };
            some.iter().enumerate().map(place).collect()
        };
        cores::in_pieces(&all, 1, 1, of_cases)
    }

    /// Bounds for all values between two places, for each class. Where all eigenvalues move in one direction, these are the frequencies at
    /// the places themselves.
    pub fn bounds_between<'b>(&self, ends: [&'b Place; 2]) -> Vec<Option<Bounds<'b>>> {
        let [first, last] = ends;
        let along = first.at.to_f64() <= last.at.to_f64();
        let [lower, upper] = match self.course {
            Some(course) if (course == Course::Rises) == along => [first, last],
            Some(_) => [last, first],
            None => return self.bounds(ends.map(|place| &place.at)),
        };
        let known = |frequencies: &Frequencies| !frequencies.is_empty() && frequencies.iter().all(Option::is_some);
        if !lower.classes.iter().chain(&upper.classes).all(known) {
            return self.bounds(ends.map(|place| &place.at));
        }
        let of_class = |(lower, upper): (&'b Frequencies, &'b Frequencies)| {
            Some(Bounds { lower: lower.into(), upper: upper.into() })
        };
        lower.classes.iter().zip(&upper.classes).map(of_class).collect()
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
    pub fn bounds(&self, ends: [&Number; 2]) -> Vec<Option<Bounds<'static>>> {
        let quick = |line: &Arc<Option<Line>>| bounds_of(&(**line).as_ref()?.eigenvalues_over(ends)?);
        if let Some(list) = self.lines.iter().map(quick).collect::<Option<Vec<Bounds<'static>>>>() {
            return list.into_iter().map(Some).collect();
        }
        let over = enclosing_system(self.study, ends, false);
        let sides = over.as_ref().and_then(outer);
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
            Some(Bounds { lower: separate(&low?, frequency).into(), upper: upper.into() })
        };
        self.classes.iter().map(of_class).collect()
    }
}

/// Bounds from those of the eigenvalues.
fn bounds_of(found: &Eigenvalues) -> Option<Bounds<'static>> {
    let pairs = || found.list.iter().zip(&found.bounds);
    let root = |square: f64| analysis::derived::hertz(Ball::from(square).sqrt());
    let lower = pairs().map(|(x, bound)| (x - bound) - 2.0 * f64::EPSILON * (x.abs() + bound));
    let upper = pairs().map(|(x, bound)| (x + bound) + 2.0 * f64::EPSILON * (x.abs() + bound));
    let (lower, upper): (Vec<f64>, Vec<f64>) = (lower.collect(), upper.collect());
    let is_known = lower.iter().chain(&upper).all(|x| x.is_finite());
    is_known.then(|| Bounds {
        lower: lower.iter().map(|square| (*square > 0.0).then(|| root(*square))).collect(),
        upper: upper.iter().map(|square| Some(if *square > 0.0 { root(*square) } else { Ball::ZERO })).collect(),
    })
}

/// Bounds for a system over a range in coordinates of the modes of one in its middle: both matrices are nearly diagonal there.
fn bounds_around(over: &LinearSystem, middle: &LinearSystem, coordinates: &[u32]) -> Option<Bounds<'static>> {
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
    Some(Bounds {
        lower: ends.iter().map(|[low, _]| (*low > 0.0).then(|| root(*low))).collect(),
        upper: ends.iter().map(|[_, high]| Some(if *high > 0.0 { root(*high) } else { Ball::ZERO })).collect(),
    })
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
        let found = bounds_of(&Eigenvalues { list: vec![1.0, 4.0], bounds: vec![3.0, 3.0] }).expect("known");
        let hertz = |omega: f64| omega / (2.0 * std::f64::consts::PI);
        let ends = |list: &[Option<Ball>]| list.iter().map(|x| x.map(|x| x.to_f64())).collect::<Vec<_>>();
        let (lower, upper) = (ends(&found.lower), ends(&found.upper));
        assert_eq!(lower[0], None);
        for (found, truth) in [(lower[1], 1.0), (upper[0], 2.0), (upper[1], f64::sqrt(7.0))] {
            assert!((found.expect("a frequency") / hertz(truth) - 1.0).abs() < 1e-14, "{found:?} {truth}");
        }
    }
}
