//! Integrals over a band of frequencies of a power of the frequency, alone and divided by i w - s. In: a power law
//! between two frequencies, a delay, a pole. Out: enclosures. See docs/method/random.md#integrals-over-a-band.
//!
//! A band is cut into panels w = m + h x, -1 <= x <= 1, in which the power, times the phase e^(-i w t) of a delay t, is a series
//! in x with a bounded rest. Near a pole the series is divided by x - z, which leaves a logarithm; far from it 1 / (x - z) is a
//! geometric series.

use super::argument::{Argument, Point};
use crate::base::{Ball, Number, Power, down, up};
use crate::kernel::complex::Complex;
use std::cell::OnceCell;

/// size (w / reference)^slope between two angular frequencies, rad/s.
#[derive(Clone, Debug)]
pub struct Piece {
    pub from: Ball,
    pub to: Ball,
    pub size: Ball,
    pub reference: Ball,
    pub slope: Slope,
}

#[derive(Clone, Copy, Debug)]
pub enum Slope {
    Whole(i32),
    Real(Ball),
}

/// h / m of a panel whose series does not end.
const NARROW: f64 = 0.2;
/// The same ratio times the slope.
const STEEP: f64 = 2.0;
const MOST_PANELS: f64 = 10_000.0;
/// Limit on the phase turned in half a panel, rad: its series is e^4 times as large for |x| = 2 as for |x| = 0.
const TURN: f64 = 2.0;
/// Bound of the remainder of a series, relative to its first term.
const LEFT: f64 = 1e-34;
const MOST_TERMS: usize = 600;
/// The series is divided by poles nearer than this, in half widths; the others are expanded.
const NEAR: f64 = 2.0;
/// The inverse of any pole that is not certainly near is smaller than this.
const FAR: f64 = 1.0 / 1.8;
/// 1.8^-130 is 6e-34.
const MOMENTS: usize = 130;

/// A panel: the power law, and its phase, as a polynomial in x.
struct Panel {
    mid: Ball,
    half: Ball,
    coefficients: Vec<Point>,
    /// A bound of sum (k + 1) |a_k| 2^k over the omitted terms: of the remainder and its derivative for |x| <= 2.
    rest: f64,
    /// The integrals of x^k times the polynomial, computed on demand.
    moments: OnceCell<Vec<Point>>,
}

/// A power law over a band, cut into panels.
pub struct Panels {
    list: Vec<Panel>,
}

impl Piece {
    /// The density at an angular frequency.
    pub fn at(&self, omega: Ball) -> Option<Ball> {
        Some(self.size * power(omega / self.reference, self.slope)?)
    }

    /// The power law times w^more e^(-i w delay).
    pub fn panels(&self, more: i32, delay: Ball) -> Option<Panels> {
        let slope = match self.slope {
            Slope::Whole(slope) => Slope::Whole(slope + more),
            Slope::Real(slope) => Slope::Real(slope + Ball::from(f64::from(more))),
        };
        // w^more = reference^more (w / reference)^more
        let size = self.size * power(self.reference, Slope::Whole(more))?;
        let mut list = Vec::new();
        for edges in self.edges(slope)? {
            for [from, to] in turning(edges, delay)? {
                let panel = Panel::of([from, to], self.reference, size, slope)?;
                list.push(if delay.is_zero() { panel } else { panel.delay(delay)? });
            }
            let is_much = list.len() as f64 > MOST_PANELS;
            if is_much {
                return None;
            }
        }
        Some(Panels { list })
    }

    fn edges(&self, slope: Slope) -> Option<Vec<[Ball; 2]>> {
        let steepness = match slope {
            Slope::Whole(slope @ 0..) => return (slope < 40).then(|| vec![[self.from, self.to]]),
            Slope::Whole(slope) => f64::from(slope).abs(),
            Slope::Real(slope) => slope.magnitude(),
        };
        if !(self.from.is_positive() && self.to.is_positive()) {
            return None;
        }
        let part = NARROW.min(STEEP / steepness);
        let (low, high) = (libm::log(self.from.to_f64()), libm::log(self.to.to_f64()));
        let count = ((high - low) / (2.0 * part * down::FEW)).ceil().max(1.0);
        // Nor for a count that is NaN.
        if count.is_nan() || count > MOST_PANELS {
            return None;
        }
        let inner = (1..count as usize).map(|k| Ball::from(libm::exp(low + (high - low) * k as f64 / count)));
        let edges: Vec<Ball> = std::iter::once(self.from).chain(inner).chain([self.to]).collect();
        Some(edges.windows(2).map(|pair| [pair[0], pair[1]]).collect())
    }
}

/// Cuts a panel so that the phase of a delay turns little in each piece.
fn turning([from, to]: [Ball; 2], delay: Ball) -> Option<Vec<[Ball; 2]>> {
    let (low, high) = (from.to_f64(), to.to_f64());
    let count = (0.5 * (high - low) * delay.magnitude() / (TURN * down::FEW)).ceil().max(1.0);
    if count.is_nan() || count > MOST_PANELS {
        return None;
    }
    let inner = (1..count as usize).map(|k| Ball::from(low + (high - low) * k as f64 / count));
    let edges: Vec<Ball> = std::iter::once(from).chain(inner).chain([to]).collect();
    Some(edges.windows(2).map(|pair| [pair[0], pair[1]]).collect())
}

impl Panels {
    /// The integral of the power law.
    pub fn integral(&self) -> Point {
        self.list.iter().fold(Complex::ZERO, |sum, panel| sum + panel.integral())
    }

    /// The integral of the power law over i w - s.
    pub fn over<A: Argument>(&self, s: A) -> A {
        self.list.iter().fold(A::of(Complex::ZERO), |sum, panel| sum.plus(panel.over(s)))
    }
}

impl Panel {
    fn of([from, to]: [Ball; 2], reference: Ball, size: Ball, slope: Slope) -> Option<Panel> {
        let (mid, half) = ((from + to) * Ball::from(0.5), (to - from) * Ball::from(0.5));
        let ratio = half / mid;
        let mut coefficients = vec![size * power(mid / reference, slope)?];
        let exponent = match slope {
            Slope::Whole(slope) => Ball::from(f64::from(slope)),
            Slope::Real(slope) => slope,
        };
        let least = LEFT * coefficients[0].magnitude();
        let growth = |k: f64| NEAR * ratio.magnitude() * (1.0 + exponent.magnitude() / k) * (k + 1.0) / k;
        let mut rest = 0.0;
        for k in 1..MOST_TERMS {
            let count = k as f64;
            let factor = (exponent - Ball::from(count - 1.0)) / Ball::from(count);
            let next = coefficients[k - 1] * factor * ratio;
            if next.is_zero() {
                rest = 0.0;
                break;
            }
            // Each of the following terms is smaller at least by this factor.
            let factor = growth(count) * up::DOZENS;
            if factor < 0.9 {
                let first = (count + 1.0) * next.magnitude() * NEAR.power(k as i32) * up::DOZENS;
                rest = first / (1.0 - factor) * up::DOZENS;
                if rest <= least {
                    break;
                }
            }
            coefficients.push(next);
            rest = f64::INFINITY;
        }
        if !rest.is_finite() {
            return None;
        }
        let coefficients = coefficients.into_iter().map(Complex::real).collect();
        Some(Panel { mid, half, coefficients, rest, moments: OnceCell::new() })
    }

    /// The panel times e^(-i w delay), a power series too. The norm sum (k + 1) |a_k| 2^k of a product of series is at most the
    /// product of their norms, so the rests multiply as their bounds do.
    fn delay(self, delay: Ball) -> Option<Panel> {
        let (sine, cosine) = Number::Ball(self.mid * delay).sin_cos()?;
        let step = -(self.half * delay);
        let mut series = vec![Complex::new(cosine.to_ball(), -sine.to_ball())];
        let (size, mut rest) = (2.0 * step.magnitude() * up::FEW, f64::INFINITY);
        for k in 1..MOST_TERMS {
            let count = k as f64;
            let next = series[k - 1] * Complex::new(Ball::ZERO, step / Ball::from(count));
            // Each of the following terms of the norm is smaller at least by this factor.
            let factor = size * (count + 2.0) / ((count + 1.0) * (count + 1.0)) * up::DOZENS;
            if factor < 0.5 {
                rest = 2.0 * (count + 1.0) * next.magnitude() * NEAR.power(k as i32) * up::DOZENS;
                if rest <= LEFT {
                    break;
                }
            }
            series.push(next);
        }
        let norm = |list: &[Point]| {
            let of = |(k, a): (usize, &Point)| (k as f64 + 1.0) * a.magnitude() * NEAR.power(k as i32);
            list.iter().enumerate().map(of).sum::<f64>() * up::THOUSANDS
        };
        let (own, phase) = (norm(&self.coefficients), norm(&series));
        let rest = (self.rest * (phase + rest) + own * rest) * up::DOZENS;
        let mut coefficients = vec![Complex::ZERO; self.coefficients.len() + series.len() - 1];
        for (i, a) in self.coefficients.iter().enumerate() {
            for (j, b) in series.iter().enumerate() {
                coefficients[i + j] = coefficients[i + j] + *a * *b;
            }
        }
        rest.is_finite().then_some(Panel { coefficients, rest, ..self })
    }

    fn integral(&self) -> Point {
        let even = self.coefficients.iter().enumerate().step_by(2);
        let sum: Point = even
            .fold(Complex::ZERO, |sum, (k, a)| sum + Complex::scale(*a, Ball::from(2.0) / Ball::from(k as f64 + 1.0)));
        Complex::scale(Argument::widen(sum, 2.0 * self.rest), self.half)
    }

    /// The integral of Q(x) / (i (x - z)) dx, z = -(m + i s) / h.
    fn over<A: Argument>(&self, s: A) -> A {
        // i s + m, times -1 / h
        let z = s.times_minus_i().scale(-Ball::ONE).plus_number(self.mid).scale(-Ball::ONE / self.half);
        let value = if z.size() <= NEAR { self.integral_by_division(z) } else { self.integral_by_expansion(z) };
        value.times_minus_i()
    }

    /// Q(x) = Q(z) + (x - z) B(x): Q(z) ln((1 - z) / (-1 - z)) and the integral of B.
    fn integral_by_division<A: Argument>(&self, z: A) -> A {
        let (mut value, mut integral) = (A::of(Complex::ZERO), A::of(Complex::ZERO));
        for (k, &coefficient) in self.coefficients.iter().enumerate().rev() {
            // `value` is the coefficient of x^k in B, known from those above it.
            if k % 2 == 0 {
                integral = integral.plus(value.scale(Ball::from(2.0) / Ball::from(k as f64 + 1.0)));
            }
            value = value.times(z).plus(A::of(coefficient));
        }
        let logarithm = z.logarithm();
        let rest = self.rest * (logarithm.size() + 2.0) * up::FEW;
        value.times(logarithm).plus(integral).widen(rest)
    }

    /// - sum z^(-k-1) times the integral of x^k Q
    fn integral_by_expansion<A: Argument>(&self, z: A) -> A {
        let inverse = z.inverse();
        let ratio = inverse.size();
        let is_far = ratio < FAR;
        if !is_far {
            return inverse.widen(f64::INFINITY);
        }
        let size = self.coefficients.iter().map(|a| a.magnitude()).sum::<f64>() * up::THOUSANDS;
        let moments = self.moments.get_or_init(|| moments(&self.coefficients));
        let terms = ((-78.0 / libm::log(ratio)).ceil().max(2.0) as usize).min(MOMENTS);
        // Horner's scheme from the last term.
        let all = moments[..terms].iter().rev();
        let sum = all.fold(A::of(Complex::ZERO), |sum, &moment| sum.plus(A::of(moment)).times(inverse));
        let beyond = 2.0 * size * ratio.power(terms as i32 + 1) / (1.0 - ratio);
        let left = (beyond + 2.0 * self.rest * ratio / (1.0 - ratio)) * up::THOUSANDS;
        sum.scale(-Ball::ONE).widen(left)
    }
}

/// The integrals of x^k Q(x) over -1 .. 1.
fn moments(coefficients: &[Point]) -> Vec<Point> {
    let inverse: Vec<Ball> =
        (0..MOMENTS + coefficients.len()).map(|k| Ball::from(2.0) / Ball::from(k as f64 + 1.0)).collect();
    let of = |k: usize, list: &[Ball]| {
        let even = list.iter().enumerate().skip(k % 2).step_by(2);
        even.fold(Ball::ZERO, |sum, (l, &a)| sum + a * inverse[k + l])
    };
    let re: Vec<Ball> = coefficients.iter().map(|a| a.re).collect();
    let im: Vec<Ball> = coefficients.iter().map(|a| a.im).collect();
    let is_real = im.iter().all(Ball::is_zero);
    (0..MOMENTS).map(|k| Complex::new(of(k, &re), if is_real { Ball::ZERO } else { of(k, &im) })).collect()
}

/// x^slope; `None` if the number leaves the range.
fn power(x: Ball, slope: Slope) -> Option<Ball> {
    let power = match slope {
        Slope::Whole(0) => return Some(Ball::ONE),
        Slope::Whole(slope) => Number::Ball(x).powi(slope)?.to_ball(),
        Slope::Real(slope) => (&Number::Ball(slope) * &Number::Ball(x).ln()?).exp()?.to_ball(),
    };
    power.is_finite().then_some(power)
}
