//! The values of the last parameter of a study: their range, and their distances from a base.

use super::place;
use crate::base::{Ball, Dd, Number};
use crate::kernel::bounded::{load, store};
use crate::kernel::pencils;
use crate::kernel::simd::simd;
use crate::model::scene::Written;
use crate::model::{Points, Swept, in_integers};
use crate::questions::answer::shown_in;
use crate::questions::rows::Enclosures;

/// The values of the last parameter of a study, or all but the first.
pub struct Range<'a> {
    pub swept: &'a Swept,
    /// The place of the first value on the line.
    pub first: u64,
    pub ends: [Number; 2],
    /// All values between the ends.
    pub all: Ball,
}

impl Range<'_> {
    pub fn of(swept: &Swept) -> Range<'_> {
        Range::between(swept, 0, ends(&swept.points))
    }

    /// Equally spaced values without the first, which may be a zero at which the model is another one.
    pub fn without_first(swept: &Swept) -> Option<Range<'_>> {
        let Points::Even { high, .. } = &swept.points else { return None };
        Some(Range::between(swept, 1, [swept.points.value(1), high.clone()]))
    }

    fn between(swept: &Swept, first: u64, ends: [Number; 2]) -> Range<'_> {
        let mut range = Range { swept, first, ends, all: Ball::ZERO };
        let centre = range.centre();
        let reach = (&range.ends[1] - &centre).to_ball().magnitude();
        range.all = centre.to_ball().widen(reach * (1.0 + 4.0 * f64::EPSILON));
        range
    }

    pub fn centre(&self) -> Number {
        &(&self.ends[0] + &self.ends[1]) / &Number::from(2)
    }

    /// The change to the other end, no smaller than the true one.
    pub fn reach_from(&self, end: usize) -> f64 {
        let width = (&self.ends[1 - end] - &self.ends[end]).to_ball();
        width.magnitude() * (1.0 + 4.0 * f64::EPSILON) * width.mid.hi.signum()
    }

    /// `at`: the place of the base on the line, if it is one of the values.
    pub fn steps_from(&self, base: &Number, at: Option<u64>) -> Steps {
        Steps::new(&self.swept.points, (base, at), &self.swept.parameter.unit)
    }

    /// Steps from the first or the last value.
    pub fn steps_from_end(&self, end: usize) -> Steps {
        self.steps_from(&self.ends[end], Some([self.first, self.count() - 1][end]))
    }

    pub fn count(&self) -> u64 {
        self.swept.points.count()
    }

    /// The value at a place, as a base of those behind it; of listed values, which have no order, the least one alone is a base.
    pub fn base(&self, place: u64) -> Option<(Number, Steps)> {
        let points = &self.swept.points;
        let base = match points {
            Points::Even { .. } => points.value(place),
            Points::Listed(_) if place == self.first => self.ends[0].clone(),
            Points::Listed(_) => return None,
        };
        let steps = self.steps_from(&base, Some(place));
        Some((base, steps))
    }

    /// The largest change from a base, no smaller than the true one.
    pub fn end_from(&self, steps: &Steps) -> f64 {
        (&self.ends[1] - &steps.base).to_ball().magnitude() * (1.0 + 4.0 * f64::EPSILON)
    }
}

/// The values of the last parameter along a line.
#[derive(Clone, Debug)]
pub struct Steps {
    pub points: Points,
    unit: Written,
    base: Number,
    /// The place of the base, and the distance between neighbours, SI, if values are equally spaced and it is one of them.
    even: Option<(u64, f64)>,
    /// Integers a, b and c such that the value with number i is (a + i b) / c in its unit, and such integers in SI.
    fraction: Option<[i64; 3]>,
    fraction_in_si: Option<[i64; 3]>,
}

impl Steps {
    /// `at`: the place of the base on the line, if it is one of the values.
    fn new(points: &Points, (base, at): (&Number, Option<u64>), unit: &Written) -> Steps {
        let (points, unit, base) = (points.clone(), unit.clone(), base.clone());
        let mut steps = Steps { points, unit, base, even: None, fraction: None, fraction_in_si: None };
        if let Points::Even { low, high, count, fraction } = &steps.points {
            let between = &(high - low) / &Number::from(*count as i64 - 1);
            steps.even = at.filter(|_| is_known(between.to_ball())).map(|at| (at, between.to_f64()));
            steps.fraction =
                in_integers([low, &between].map(|si| steps.unit.factor.as_ref().map(|factor| si / factor)), *count);
            steps.fraction_in_si = *fraction;
        }
        steps
    }

    /// A value of the parameter less the base, SI.
    pub fn distance_of(&self, si: &Number) -> Ball {
        (si - &self.base).to_ball()
    }

    /// The value with this number less the base, SI; NaN if it is not known to a few roundings.
    fn change(&self, index: u64) -> f64 {
        let change = (&self.points.value(index) - &self.base).to_ball();
        if is_known(change) { change.to_f64() } else { f64::NAN }
    }

    /// The changes of the cases at these places of the line.
    pub fn changes(&self, places: &[u64]) -> Vec<f64> {
        match self.even {
            Some((at, between)) => places.iter().map(|place| (*place as f64 - at as f64) * between).collect(),
            None => places.iter().map(|place| self.change(*place)).collect(),
        }
    }

    /// The values at these places of the line, SI, nearest to the true ones; NaN where a value is not known that well or of no usual size.
    pub fn values(&self, places: &[u64]) -> Vec<f64> {
        let is_usual = |x: &f64| *x == 0.0 || pencils::is_usual(x.abs());
        match self.fraction_in_si {
            Some([a, b, c]) => {
                let value = |place: &u64| (a + b * *place as i64) as f64 / c as f64;
                places.iter().map(|place| Some(value(place)).filter(is_usual).unwrap_or(f64::NAN)).collect()
            }
            None => places.iter().map(|at| place(&self.points.value(*at))).collect(),
        }
    }

    /// The values at these places of the line in their unit, set in a column from `at` on.
    pub fn values_in_unit(&self, places: &[u64], at: usize, column: &mut Enclosures) {
        let Some([a, b, c]) = self.fraction else {
            for (place, row) in places.iter().zip(at..) {
                column.set(row, shown_in(&self.points.value(*place), &self.unit, false).number);
            }
            return;
        };
        let to = [&mut column.high, &mut column.low, &mut column.radius].map(|list| &mut list[at..]);
        let numbers: Vec<f64> = places.iter().map(|place| (a + b * *place as i64) as f64).collect();
        quotients(&numbers, c as f64, to);
    }
}

simd! {
    /// Integers over one: quotients in two words, and bounds of their errors.
    fn quotients<V: Vector>(numbers: &[f64], divisor: f64, to: [&mut [f64]; 3]) {
        let [high, low, radius] = to.map(|list| list.chunks_mut(V::WIDTH));
        let (divisor, zero) = (V::splat(divisor), V::splat(0.0));
        for (((x, high), low), radius) in numbers.chunks(V::WIDTH).zip(high).zip(low).zip(radius) {
            let x = load::<V>(x);
            let quotient = x / divisor;
            // The remainder is exact in binary64, and its quotient is half a unit of the other one at most.
            let left = (-quotient).mul_add(divisor, x);
            let rest = left / divisor;
            store(quotient, high);
            store(rest, low);
            store(left.abs().if_exceeds(zero, quotient.abs() * V::splat(Dd::EPSILON), zero), radius);
        }
    }
}

/// Whether the relative error of a number is negligible in binary64.
fn is_known(x: Ball) -> bool {
    x.relative_error() <= f64::EPSILON / 8.0
}

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
