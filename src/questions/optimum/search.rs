//! The search for an optimum without a proof: places over all ranges, then the simplex method of Nelder and Mead from
//! the best of them. In: the varied parameters, and a function that evaluates the measure. Out: the best place that was
//! found.

use super::Trial;
use crate::analysis::Measurement;
use crate::base::{Ball, Dd, Number, OrderBy, Rational};
use crate::model::scene::{Optimum, Varied};
use crate::questions::search::to_fraction;
use crate::questions::unknowns::interpolate;

/// If the ratio of the range's ends exceeds this, the places are spaced logarithmically.
const DECADES: f64 = 20.0;
/// Places along each range, for this number of parameters.
const PLACES: [usize; 4] = [33, 9, 5, 3];
/// Number of places if there are more parameters.
const MANY: usize = 96;
/// Descents that are begun.
const STARTS: usize = 3;

/// A place and its measure.
#[derive(Clone, Debug)]
pub(super) struct Seen {
    pub values: Vec<Number>,
    pub value: Ball,
    /// Positions in the ranges, each from 0 to 1.
    at: Vec<f64>,
}

/// The reason why no place was found.
pub(super) enum Nothing {
    NoValue(String),
    /// The measure is infinite at these values.
    Unbounded(Vec<Number>),
    /// The conditions did not hold at any of the values tried: their number, and whether a free motion grew at some.
    Broken {
        tried: usize,
        grows: bool,
    },
}

/// The merit of a place: first the conditions, then the measure, with the sign that makes the smallest one the best.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
struct Merit {
    broken: f64,
    value: Dd,
}

#[derive(Clone, Debug)]
struct Vertex {
    at: Vec<f64>,
    merit: Merit,
    value: Option<Ball>,
}

/// The measure in binary64, without a bound; `None` where it has no finite value.
pub(super) type Rough<'a> = dyn Fn(&[Number]) -> Option<f64> + 'a;

/// A search for the optimum of one line.
pub(super) struct Search<'a> {
    optimum: &'a Optimum,
    trial: &'a dyn Fn(&[Number]) -> Trial,
    /// Stands in for `trial` while a place is looked for.
    rough: Option<&'a Rough<'a>>,
    count: usize,
    /// Whether a trial takes so long that only few are made.
    few: bool,
    unbounded: Option<Vec<Number>>,
    /// Whether a free motion grew at a place, where none may.
    grew: bool,
    why: String,
}

/// The relative difference between a rough value and the measure up to which a place is accepted.
const ROUGH: f64 = 1e-6;

const WORST: Merit = Merit { broken: f64::INFINITY, value: Dd::ZERO };

impl<'a> Search<'a> {
    pub fn new(optimum: &'a Optimum, trial: &'a dyn Fn(&[Number]) -> Trial, few: bool) -> Search<'a> {
        Search { optimum, trial, rough: None, count: 0, few, unbounded: None, grew: false, why: String::new() }
    }

    /// Number of places that were measured.
    pub fn count(&self) -> usize {
        self.count
    }

    /// The measure at some values, if the conditions hold there.
    pub fn measure(&mut self, values: &[Number]) -> Option<Ball> {
        self.count += 1;
        match (self.trial)(values) {
            Trial { value: Measurement::Value(value), broken: 0.0, .. } if value.is_finite() => Some(value),
            _ => None,
        }
    }

    /// The best place, roughly. If a quick rough measure is given, the search uses it, and falls back to trials only if
    /// they disagree with it at the place found.
    pub fn run(&mut self, rough: Option<&'a Rough<'a>>) -> Result<Seen, Nothing> {
        let guided = rough.and_then(|rough| self.guided_search(rough));
        guided.map_or_else(|| self.over_all(), Ok)
    }

    fn guided_search(&mut self, rough: &'a Rough<'a>) -> Option<Seen> {
        self.rough = Some(rough);
        let found = self.over_all();
        self.rough = None;
        let Seen { at, value, .. } = found.ok()?;
        let vertex = self.vertex(at);
        let exact = vertex.value.filter(|exact| (*exact - value).magnitude() <= ROUGH * exact.magnitude())?;
        (vertex.merit.broken == 0.0).then(|| Seen { values: self.values(&vertex.at), value: exact, at: vertex.at })
    }

    fn over_all(&mut self) -> Result<Seen, Nothing> {
        let count = self.optimum.varied.len();
        let mut places: Vec<Vertex> = self.places().into_iter().map(|at| self.vertex(at)).collect();
        if let Some(values) = self.unbounded.take().filter(|_| self.optimum.highest) {
            return Err(Nothing::Unbounded(values));
        }
        places.order_by(|a, b| order(&a.merit, &b.merit));
        let mut starts: Vec<Vertex> = Vec::new();
        for place in &places {
            let apart = |other: &Vertex| place.at.iter().zip(&other.at).any(|(a, b)| (a - b).abs() > 0.2);
            if starts.len() < (if self.few { 1 } else { STARTS }) && starts.iter().all(apart) {
                starts.push(place.clone());
            }
        }
        let ended: Vec<Vertex> = starts.into_iter().map(|start| self.descend(start, 0.08, 1e-4, 60 * count)).collect();
        let best = ended.into_iter().min_by(|a, b| order(&a.merit, &b.merit));
        match best {
            Some(Vertex { at, value: Some(value), merit: Merit { broken: 0.0, .. } }) => {
                Ok(Seen { values: self.values(&at), value, at })
            }
            Some(Vertex { value: Some(_), .. }) => Err(Nothing::Broken { tried: self.count, grows: self.grew }),
            _ => Err(Nothing::NoValue(std::mem::take(&mut self.why))),
        }
    }

    /// Continues the search from a place to its end, for measures that no better method applies to.
    pub fn finish(&mut self, seen: Seen) -> Seen {
        let merit = self.merit(0.0, seen.value);
        let mut best = Vertex { at: seen.at.clone(), merit, value: Some(seen.value) };
        let count = self.optimum.varied.len();
        let widths: &[f64] = if self.few { &[1e-4] } else { &[1e-3, 1e-5, 1e-7] };
        for &width in widths {
            best = self.descend(best, width, width * 1e-4, 100 * count);
        }
        // An end is exact.
        let ended: Vec<f64> = best
            .at
            .iter()
            .map(|x| {
                if *x < 1e-9 {
                    0.0
                } else if *x > 1.0 - 1e-9 {
                    1.0
                } else {
                    *x
                }
            })
            .collect();
        let at_end = self.vertex(ended);
        if order(&at_end.merit, &best.merit).is_le() {
            best = at_end;
        }
        match best.value {
            Some(value) => Seen { values: self.values(&best.at), value, at: best.at },
            None => seen,
        }
    }

    /// Whether a parameter has no effect on either side of a place.
    pub fn is_flat(&mut self, seen: &Seen, i: usize) -> bool {
        [-1e-3, 1e-3].into_iter().all(|step| {
            let mut at = seen.at.clone();
            at[i] += step;
            if !(0.0..=1.0).contains(&at[i]) {
                at[i] = seen.at[i] - 2.0 * step;
            }
            let vertex = self.vertex(at);
            vertex.value.is_some_and(|value| {
                let difference = value - seen.value;
                difference.contains_zero() && difference.rad <= 1e-9 * seen.value.magnitude()
            })
        })
    }

    /// Places over all ranges.
    fn places(&self) -> Vec<Vec<f64>> {
        let count = self.optimum.varied.len();
        let known = PLACES.get(count - 1).map(|each| if self.few { (each / 3).max(2) } else { *each });
        let Some(each) = known else {
            // Halton's points, by the digits of a number in a prime base for each parameter.
            const PRIMES: [usize; 8] = [2, 3, 5, 7, 11, 13, 17, 19];
            let point = |k: usize| (0..count).map(|i| reverse_digits(k + 1, PRIMES[i % PRIMES.len()])).collect();
            return (0..if self.few { MANY / 4 } else { MANY }).map(point).collect();
        };
        let along = |i: usize| if each > 3 { i as f64 / (each - 1) as f64 } else { (i as f64 + 0.5) / each as f64 };
        let mut list = vec![Vec::new()];
        for _ in 0..count {
            let longer =
                |place: &Vec<f64>| (0..each).map(|i| [place.clone(), vec![along(i)]].concat()).collect::<Vec<_>>();
            list = list.iter().flat_map(longer).collect();
        }
        list
    }

    fn vertex(&mut self, at: Vec<f64>) -> Vertex {
        self.count += 1;
        let values = self.values(&at);
        if let Some(rough) = self.rough {
            let value = rough(&values).map(Ball::from);
            return Vertex { at, merit: value.map_or(WORST, |value| self.merit(0.0, value)), value };
        }
        let Trial { value, broken, grows } = (self.trial)(&values);
        self.grew |= grows;
        match value {
            Measurement::Value(value) if value.is_finite() => {
                Vertex { at, merit: self.merit(broken, value), value: Some(value) }
            }
            Measurement::Infinite => {
                self.unbounded.get_or_insert(values);
                self.why = "it is infinite at all values tried".into();
                Vertex { at, merit: WORST, value: None }
            }
            Measurement::Value(_) => Vertex { at, merit: WORST, value: None },
            Measurement::None(why) => {
                self.why = why.into();
                Vertex { at, merit: WORST, value: None }
            }
            Measurement::Failed(why) => {
                self.why = why;
                Vertex { at, merit: WORST, value: None }
            }
        }
    }

    fn merit(&self, broken: f64, value: Ball) -> Merit {
        Merit { broken, value: if self.optimum.highest { -value.mid } else { value.mid } }
    }

    fn values(&self, at: &[f64]) -> Vec<Number> {
        self.optimum.varied.iter().zip(at).map(|(varied, x)| value_at(varied, *x)).collect()
    }

    /// Nelder and Mead's simplex, until it is this small.
    fn descend(&mut self, start: Vertex, width: f64, until: f64, most: usize) -> Vertex {
        let n = start.at.len();
        let mut simplex = vec![start.clone()];
        for i in 0..n {
            let mut at = start.at.clone();
            at[i] += if at[i] + width <= 1.0 { width } else { -width };
            let vertex = self.vertex(at);
            simplex.push(vertex);
        }
        let limit = self.count + most;
        while self.count < limit {
            simplex.order_by(|a, b| order(&a.merit, &b.merit));
            let size = |i: usize| simplex.iter().map(|v| (v.at[i] - simplex[0].at[i]).abs()).fold(0.0, f64::max);
            if (0..n).map(size).fold(0.0, f64::max) <= until {
                break;
            }
            let centre: Vec<f64> =
                (0..n).map(|i| simplex[..n].iter().map(|v| v.at[i]).sum::<f64>() / n as f64).collect();
            let worst = simplex[n].clone();
            let toward = |times: f64| -> Vec<f64> {
                (0..n).map(|i| (centre[i] + times * (worst.at[i] - centre[i])).clamp(0.0, 1.0)).collect()
            };
            let reflected = self.vertex(toward(-1.0));
            let better = |a: &Vertex, b: &Vertex| order(&a.merit, &b.merit).is_lt();
            if better(&reflected, &simplex[0]) {
                let expanded = self.vertex(toward(-2.0));
                simplex[n] = if better(&expanded, &reflected) { expanded } else { reflected };
            } else if better(&reflected, &simplex[n - 1]) {
                simplex[n] = reflected;
            } else {
                let inside = !better(&reflected, &worst);
                let contracted = self.vertex(toward(if inside { 0.5 } else { -0.5 }));
                if better(&contracted, if inside { &worst } else { &reflected }) {
                    simplex[n] = contracted;
                } else {
                    let best = simplex[0].at.clone();
                    for vertex in &mut simplex[1..] {
                        let at = vertex.at.iter().zip(&best).map(|(x, b)| 0.5 * (x + b)).collect();
                        *vertex = self.vertex(at);
                    }
                }
            }
        }
        simplex.into_iter().min_by(|a, b| order(&a.merit, &b.merit)).unwrap_or(start)
    }
}

fn order(a: &Merit, b: &Merit) -> std::cmp::Ordering {
    a.broken.total_cmp(&b.broken).then(a.value.hi.total_cmp(&b.value.hi)).then(a.value.lo.total_cmp(&b.value.lo))
}

/// The number at a fraction of a range; along the ratio of its ends if it covers decades.
fn value_at(varied: &Varied, x: f64) -> Number {
    let Varied { low, high, .. } = varied;
    if x <= 0.0 || x >= 1.0 {
        return if x <= 0.0 { low.clone() } else { high.clone() };
    }
    let (a, b) = (low.to_f64(), high.to_f64());
    let Some(part) = Rational::from_f64(x) else { return low.clone() };
    if a > 0.0 && b > DECADES * a {
        let ratio = (high / low).pow(&Number::from(part.clone()));
        if let Some(value) = ratio.map(|ratio| (low * &ratio).to_ball().mid) {
            return to_fraction(Dd::from(value.hi));
        }
    }
    let width = high - low;
    let exact = low + &(&width * &Number::from(part));
    // A number with few digits, if that is enough.
    let short = Dd::from(exact.to_f64());
    if short.hi > a && short.hi < b { to_fraction(short) } else { interpolate(low, high, 1, 2) }
}

/// The digits of a number behind the point, in reverse order.
fn reverse_digits(mut k: usize, base: usize) -> f64 {
    let (mut value, mut unit) = (0.0, 1.0);
    while k > 0 {
        unit /= base as f64;
        value += unit * (k % base) as f64;
        k /= base;
    }
    value
}
