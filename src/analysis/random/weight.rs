//! Integrals over a band of frequencies of a power of the frequency, alone and divided by i w - s. In: a power law between two
//! frequencies, a pole. Out: enclosures. See docs/method/random.md#integrals-over-a-band.
//!
//! A band is cut into panels w = m + h x, -1 <= x <= 1, in which the power is a binomial series in x with a bounded rest. Near a
//! pole the series is divided by x - z, which leaves a logarithm; far from it 1 / (x - z) is a geometric series.

use crate::base::{Ball, Number, down, up};
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
/// And h / m times the slope.
const STEEP: f64 = 2.0;
const MOST_PANELS: f64 = 10_000.0;
/// What the rest of a series may be, relative to its first term.
const LEFT: f64 = 1e-34;
const MOST_TERMS: usize = 600;
/// Poles nearer than this, in half widths, are divided by; the others are expanded.
const NEAR: f64 = 2.0;
/// Any pole that is not certainly near is certainly beyond.
const FAR: f64 = 1.9;
/// 1.9^-120 is 3e-34.
const MOMENTS: usize = 120;

/// A panel: the power law as a polynomial in x.
struct Panel {
    mid: Ball,
    half: Ball,
    coefficients: Vec<Ball>,
    /// A bound of sum (k + 1) |a_k| 2^k over the terms that are left out: of the rest and its derivative for |x| <= 2.
    rest: f64,
    /// The integrals of x^k times the polynomial, once a pole needs them.
    moments: OnceCell<Vec<Ball>>,
}

/// A power law over a band, cut into panels.
pub struct Panels {
    list: Vec<Panel>,
}

impl Piece {
    /// The power law times w^more.
    pub fn panels(&self, more: i32) -> Option<Panels> {
        let slope = match self.slope {
            Slope::Whole(slope) => Slope::Whole(slope + more),
            Slope::Real(slope) => Slope::Real(slope + Ball::from(f64::from(more))),
        };
        // w^more = reference^more (w / reference)^more
        let size = self.size * power(self.reference, Slope::Whole(more))?;
        let mut list = Vec::new();
        for [from, to] in self.edges(slope)? {
            list.push(Panel::of([from, to], self.reference, size, slope)?);
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
        // Nor of a count that is no number.
        if count.is_nan() || count > MOST_PANELS {
            return None;
        }
        let inner = (1..count as usize).map(|k| Ball::from(libm::exp(low + (high - low) * k as f64 / count)));
        let edges: Vec<Ball> = std::iter::once(self.from).chain(inner).chain([self.to]).collect();
        Some(edges.windows(2).map(|pair| [pair[0], pair[1]]).collect())
    }
}

impl Panels {
    /// The integral of the power law.
    pub fn integral(&self) -> Ball {
        self.list.iter().fold(Ball::ZERO, |sum, panel| sum + panel.integral())
    }

    /// The integral of the power law over i w - s.
    pub fn over(&self, s: Complex<Ball>) -> Complex<Ball> {
        self.list.iter().fold(Complex::ZERO, |sum, panel| sum + panel.over(s))
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
            // The terms that follow shrink at least by this factor.
            let factor = growth(count) * up::DOZENS;
            if factor < 0.9 {
                let first = (count + 1.0) * next.magnitude() * NEAR.powi(k as i32) * up::DOZENS;
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
        Some(Panel { mid, half, coefficients, rest, moments: OnceCell::new() })
    }

    fn integral(&self) -> Ball {
        let even = self.coefficients.iter().enumerate().step_by(2);
        let sum = even.fold(Ball::ZERO, |sum, (k, &a)| sum + a * Ball::from(2.0) / Ball::from(k as f64 + 1.0));
        self.half * sum.widen(2.0 * self.rest)
    }

    /// The integral of Q(x) / (i (x - z)) dx, z = -(m + i s) / h.
    fn over(&self, s: Complex<Ball>) -> Complex<Ball> {
        let z = Complex::new((s.im - self.mid) / self.half, -s.re / self.half);
        let least = (z.re.mignitude().powi(2) + z.im.mignitude().powi(2)).sqrt() * down::DOZENS;
        let value = if z.magnitude() <= NEAR {
            self.divided(z)
        } else if least >= FAR {
            self.expanded(z, least)
        } else {
            let unknown = Ball::ZERO.widen(f64::INFINITY);
            Complex::new(unknown, unknown)
        };
        Complex::new(value.im, -value.re)
    }

    /// Q(x) = Q(z) + (x - z) B(x): Q(z) ln((1 - z) / (-1 - z)) and the integral of B.
    fn divided(&self, z: Complex<Ball>) -> Complex<Ball> {
        let (mut value, mut integral) = (Complex::ZERO, Complex::ZERO);
        for (k, &coefficient) in self.coefficients.iter().enumerate().rev() {
            // `value` is the coefficient of x^k in B, known from those above it.
            if k % 2 == 0 {
                integral = integral + value.scale(Ball::from(2.0) / Ball::from(k as f64 + 1.0));
            }
            value = value * z + Complex::real(coefficient);
        }
        let logarithm = logarithm(z);
        let rest = self.rest * (logarithm.magnitude() + 2.0) * up::FEW;
        let sum = value * logarithm + integral;
        Complex::new(sum.re.widen(rest), sum.im.widen(rest))
    }

    /// - sum z^(-k-1) times the integral of x^k Q
    fn expanded(&self, z: Complex<Ball>, least: f64) -> Complex<Ball> {
        let inverse = Complex::real(Ball::ONE) / z;
        let size = self.coefficients.iter().map(Ball::magnitude).sum::<f64>() * up::THOUSANDS;
        let moments = self.moments.get_or_init(|| moments(&self.coefficients));
        let terms = ((78.0 / libm::log(least)).ceil().max(2.0) as usize).min(MOMENTS);
        // Horner's scheme from the last term.
        let sum = moments[..terms]
            .iter()
            .rev()
            .fold(Complex::ZERO, |sum: Complex<Ball>, &moment| (sum + Complex::real(moment)) * inverse);
        let beyond = 2.0 * size * least.powi(-(terms as i32)) / (least - 1.0);
        let left = (beyond + 2.0 * self.rest / (least - 1.0)) * up::THOUSANDS;
        Complex::new((-sum.re).widen(left), (-sum.im).widen(left))
    }
}

/// The integrals of x^k Q(x) over -1 .. 1.
fn moments(coefficients: &[Ball]) -> Vec<Ball> {
    let inverse: Vec<Ball> =
        (0..MOMENTS + coefficients.len()).map(|k| Ball::from(2.0) / Ball::from(k as f64 + 1.0)).collect();
    let moment = |k: usize| {
        let even = coefficients.iter().enumerate().skip(k % 2).step_by(2);
        even.fold(Ball::ZERO, |sum, (l, &a)| sum + a * inverse[k + l])
    };
    (0..MOMENTS).map(moment).collect()
}

/// The integral of 1 / (x - z) over -1 .. 1: x - z stays on one side of the real axis.
fn logarithm(z: Complex<Ball>) -> Complex<Ball> {
    let unknown = Ball::ZERO.widen(f64::INFINITY);
    let ends = [Ball::ONE - z.re, -Ball::ONE - z.re];
    let [after, before] = ends.map(|re| re * re + z.im * z.im);
    let angle =
        |re: Ball| Number::atan2(&Number::Ball(-z.im), &Number::Ball(re)).map_or(unknown, |angle| angle.to_ball());
    let size = Number::Ball(after / before).ln().map_or(unknown, |ln| ln.to_ball() * Ball::from(0.5));
    if z.im.contains_zero() {
        return Complex::new(unknown, unknown);
    }
    Complex::new(size, angle(ends[0]) - angle(ends[1]))
}

/// x^slope; `None` where the number leaves the range.
fn power(x: Ball, slope: Slope) -> Option<Ball> {
    let power = match slope {
        Slope::Whole(0) => return Some(Ball::ONE),
        Slope::Whole(slope) => Number::Ball(x).powi(slope)?.to_ball(),
        Slope::Real(slope) => (&Number::Ball(slope) * &Number::Ball(x).ln()?).exp()?.to_ball(),
    };
    power.is_finite().then_some(power)
}
