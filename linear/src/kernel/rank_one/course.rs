//! How eigenvalues move while the factor grows: where they are looked for. In: F. Out: stretches of the factor, on each of
//! which a cubic polynomial follows each eigenvalue. Nothing here is proved, and no bound depends on it.

use super::{Differences, Equation, Look};
use crate::base::Dd;
use crate::kernel::complex::Complex;
use crate::kernel::simd::Vector;

/// The factors from one to another, both of one sign, in the direction from zero.
#[derive(Clone, Debug)]
pub struct Stretch {
    from: f64,
    pub to: f64,
    /// One of each conjugate pair.
    pub roots: Vec<Root>,
}

/// An eigenvalue along a stretch.
#[derive(Clone, Debug)]
pub struct Root {
    pub origin: Complex<Dd>,
    /// The place of the origin among the poles.
    pub pole: usize,
    pub is_real: bool,
    /// Whether it is taken for its origin.
    pub stays: bool,
    /// Its distance from the origin: coefficients of a polynomial, 0 at the beginning of the stretch and 1 at its end.
    course: [Complex<f64>; 4],
}

impl Root {
    /// The distances of the poles from its origin, as its proof takes them.
    pub fn differences(&self, poles: &[Complex<Dd>]) -> Differences {
        let all = Differences::of(poles, self.origin);
        if self.stays { all.without_origin() } else { all }
    }

    #[cfg(test)]
    pub fn conj(&self) -> Root {
        Root { origin: self.origin.conj(), course: self.course.map(Complex::conj), ..self.clone() }
    }

    /// The distance from the origin, nearly.
    #[inline(always)]
    pub fn start<V: Vector>(&self, rho: V, stretch: &Stretch) -> [V; 2] {
        let t = (rho - V::splat(stretch.from)) * V::splat(1.0 / (stretch.to - stretch.from));
        let [a, b, c, d] = self.course;
        let of = |a: f64, b: f64, c: f64, d: f64| {
            let inner = V::splat(d).mul_add(t, V::splat(c));
            inner.mul_add(t, V::splat(b)).mul_add(t, V::splat(a))
        };
        [of(a.re, b.re, c.re, d.re), of(a.im, b.im, c.im, d.im)]
    }
}

/// The courses of the eigenvalues.
pub struct Course<'a, E> {
    pub equation: &'a E,
}

/// All eigenvalues at one factor, one of each conjugate pair.
#[derive(Clone, Debug)]
struct State {
    rho: f64,
    list: Vec<Place>,
}

#[derive(Clone, Copy, Debug)]
struct Place {
    origin: Complex<Dd>,
    pole: usize,
    is_real: bool,
    stays: bool,
    tau: Complex<f64>,
    /// The derivative by the factor.
    slope: Complex<f64>,
    /// The distance from the nearest pole.
    room: f64,
}

/// Shortest stretch, as a share of all.
const SHORTEST: f64 = 1.0 / 4096.0;
const MOST_STRETCHES: usize = 400;
/// What a cubic polynomial may be off in its middle, as a share of the distance from other eigenvalues and from poles: two steps
/// of Newton's leave less than a rounding error.
const ENOUGH: f64 = 1e-5;
/// An eigenvalue that moves by less than this share of its size is taken for its pole.
const STAYING: f64 = 1e-19;
/// Two eigenvalues closer than this share of their size are taken for one that was found twice.
const TWICE: f64 = 1e-9;

impl<E: Equation> Course<'_, E> {
    /// Stretches from zero towards `end`, up to where two eigenvalues meet.
    pub fn stretches(&self, end: f64) -> Vec<Stretch> {
        let (mut list, mut state, mut step) = (Vec::new(), self.at_zero(end), end);
        while state.rho != end && list.len() < MOST_STRETCHES {
            let ahead = state.rho + step;
            let to = if ahead.abs() < end.abs() { ahead } else { end };
            match self.across(&state, to) {
                Some((stretch, last)) => {
                    list.push(stretch);
                    (state, step) = (last, 2.0 * step);
                }
                None if step.abs() > SHORTEST * end.abs() => step *= 0.5,
                None => break,
            }
        }
        list
    }

    fn at_zero(&self, end: f64) -> State {
        let of = |(pole, s): (usize, &Complex<Dd>)| Place {
            origin: *s,
            pole,
            is_real: s.im.is_zero(),
            stays: self.equation.pull(pole) * end.abs() <= STAYING * s.to_f64().abs(),
            tau: Complex::ZERO,
            slope: self.equation.departure(pole),
            room: 0.0,
        };
        let upper = self.equation.poles().iter().enumerate().filter(|(_, s)| s.im.is_zero() || s.im.hi > 0.0);
        State { rho: 0.0, list: upper.map(of).collect() }
    }

    /// The polynomials from a state to another factor, and the state there; `None` if they do not follow the eigenvalues.
    fn across(&self, from: &State, to: f64) -> Option<(Stretch, State)> {
        let middle = self.advance(from, 0.5 * (from.rho + to))?;
        let last = self.advance(&middle, to)?;
        let mut stretch = Stretch { from: from.rho, to, roots: Vec::with_capacity(from.list.len()) };
        let (gaps, width) = (middle.gaps(), to - from.rho);
        for (i, (a, b)) in from.list.iter().zip(&last.list).enumerate() {
            let Place { origin, pole, is_real, stays, .. } = *a;
            let (p, q, change) = (a.slope.scale(width), b.slope.scale(width), b.tau - a.tau);
            // Hermite's polynomial.
            let course = [a.tau, p, change.scale(3.0) - p.scale(2.0) - q, p + q - change.scale(2.0)];
            let root = Root { origin, pole, is_real, stays, course };
            let [re, im] = root.start(middle.rho, &stretch);
            let off = (Complex::new(re, im) - middle.list[i].tau).abs();
            let fits = stays || off <= ENOUGH * gaps[i].min(middle.list[i].room);
            fits.then(|| stretch.roots.push(root))?;
        }
        Some((stretch, last))
    }

    /// The state at another factor, by Newton's steps from the tangents.
    fn advance(&self, from: &State, rho: f64) -> Option<State> {
        let of = |place: &Place| {
            let tau = place.tau + place.slope.scale(rho - from.rho);
            self.settle(Place { tau, ..*place }, rho)
        };
        let state = State { rho, list: from.list.iter().map(of).collect::<Option<_>>()? };
        let gaps = state.gaps();
        let is_apart = |(place, gap): (&Place, &f64)| *gap > TWICE * place.at().abs();
        state.list.iter().zip(&gaps).all(is_apart).then_some(state)
    }

    fn settle(&self, mut place: Place, rho: f64) -> Option<Place> {
        if place.stays {
            return Some(Place { tau: Complex::ZERO, ..place });
        }
        let from = Differences::of(self.equation.poles(), place.origin);
        for _ in 0..8 {
            let Look { step, slope, nearest } = self.equation.look(&from, [place.tau.re, place.tau.im], rho);
            // Roundings of conjugates need not cancel in a determinant.
            let [step, slope] = [step, slope].map(|z| if place.is_real { Complex::new(z.re, 0.0) } else { z });
            place.tau = place.tau - step;
            place.room = 1.0 / nearest.sqrt();
            place.slope = slope;
            if !step.is_finite() {
                return None;
            }
            if step.abs() <= 1e-10 * place.room {
                return (place.is_real || place.at().im > 0.0).then_some(place);
            }
        }
        None
    }
}

impl State {
    /// The distance of each from the nearest other one, its own conjugate among them.
    fn gaps(&self) -> Vec<f64> {
        let at: Vec<Complex<f64>> = self.list.iter().map(Place::at).collect();
        let nearest = |i: usize| {
            let own = if self.list[i].is_real { f64::INFINITY } else { 2.0 * at[i].im };
            (0..at.len()).filter(|&j| j != i).fold(own, |least, j| least.min((at[i] - at[j]).abs()))
        };
        (0..at.len()).map(nearest).collect()
    }
}

impl Place {
    fn at(&self) -> Complex<f64> {
        (self.origin + self.tau.into()).to_f64()
    }
}
