//! Taylor polynomials of H over intervals of frequencies, or of P = (s - p) H / half where a pole p is so near that no polynomial
//! is as good as H itself. In: the terms of H, an interval. Out: the polynomial, with bounds of what it and its derivatives are
//! off by.

use super::sums::{Lined, TaylorSums, nearest, taylor};
use super::{DEGREE, MOST_BLUR, PartialFractions, Term};
use crate::base::{Ball, Dd, Power, up};
use crate::kernel::complex::Complex;

/// A Taylor polynomial about a frequency, in t = (omega - middle) / half: of H, or beside a pole of P.
#[derive(Clone, Debug)]
pub struct Expansion {
    pub coefficients: [Complex<f64>; DEGREE + 2],
    /// Bounds of the errors of the polynomial and of its first two derivatives for |t| <= 1.
    pub errors: [f64; 3],
    /// The part of these errors that a smaller interval reduces: the error of the omitted terms.
    pub cut: [f64; 3],
    half: f64,
    pub pole: Option<Beside>,
}

/// A pole p next to an interval: H = P / delta, delta = (s - p) / half = i t + offset.
#[derive(Clone, Copy, Debug)]
pub struct Beside {
    p: Complex<Dd>,
    /// A bound of the distance of the pole from p, along the imaginary axis, rad/s.
    loose: f64,
    pub offset: Complex<f64>,
    /// The same bound beside `half`.
    pub blur: f64,
    /// A bound of |delta|.
    pub reach: f64,
}

/// Why there is no polynomial.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Obstacle {
    /// More than one pole is near.
    Near,
    /// A pole on the imaginary axis is near whose residue may be zero.
    Uncertain,
}

/// Expands H about one frequency after another.
pub struct Expander<'a> {
    h: &'a PartialFractions,
    /// The terms without the hidden one.
    others: Lined,
    hidden: Option<usize>,
}

/// An interval is expanded if its half is at most the distance from the nearest pole over this.
const CLEAR: f64 = 3.0;

impl Expander<'_> {
    pub fn of(h: &PartialFractions) -> Expander<'_> {
        Expander { h, others: h.lined.clone(), hidden: None }
    }

    /// For |omega - middle| <= half. With `precise`, sums are taken in double-double, for frequencies at which most of H
    /// cancels.
    pub fn expansion(&mut self, middle: Dd, half: f64, precise: bool) -> Result<Expansion, Obstacle> {
        let (index, mut distances) = nearest(&self.h.lined, middle);
        distances = distances.map(|square| square.sqrt() * (1.0 - 1e-12));
        if !self.h.at_zero.is_none() {
            // It is in none of the terms: beside it no other pole may be near.
            distances = distances.map(|distance| distance.min(middle.to_f64().abs()));
        }
        let [first, second] = distances;
        let least = CLEAR * half;
        let beside = match (first >= least, second >= least) {
            (true, _) => None,
            (false, true) => Some((self.beside(index, middle, half)?, self.h.terms[index])),
            _ => return Err(Obstacle::Near),
        };
        self.hide(beside.map(|_| index));
        let clearance = if beside.is_some() { second } else { first };
        let mut sums = taylor(&self.others, middle, half, precise);
        self.h.add_polynomial(&mut sums, middle, half);
        self.h.at_zero.add_to(&mut sums, middle, half);
        let unit = if precise { Dd::EPSILON } else { f64::EPSILON };
        let count = (2 * self.h.terms.len() + 32 * DEGREE) as f64 * unit;
        let [h0, h1, h2] = self.h.flat;
        let flat = [h0, h1 * half, h2 * half * half];
        let known = [0, 1, 2].map(|k| (sums.cut[k] + count * sums.sizes[k] + sums.doubts[k] + flat[k]) * up::MILLIONS);
        let mut found = match beside {
            None => {
                let mut coefficients = [Complex::<f64>::ZERO; DEGREE + 2];
                coefficients.iter_mut().zip(&sums.coefficients).for_each(|(to, from)| *to = from.to_f64());
                let rest = self.h.rest(sums.rests, middle.to_f64().abs() * up::FEW, half, clearance);
                let scale = [1.0, half, half * half];
                let errors = [0, 1, 2].map(|k| known[k] + rest[k] * scale[k]);
                Expansion { coefficients, errors, cut: sums.cut.map(|x| x * up::MILLIONS), half, pole: None }
            }
            Some((pole, term)) => times_distance(pole, &term, (&sums, known), (middle, half), clearance, unit),
        };
        // Coefficients are rounded to binary64 once more, beside their own size.
        for k in 0..3 {
            let own = f64::EPSILON * size(&found.coefficients, k);
            found.errors[k] = (found.errors[k] + own) * up::MILLIONS + f64::MIN_POSITIVE;
        }
        let finite = found.errors.iter().all(|x| x.is_finite()) && found.coefficients.iter().all(|c| c.is_finite());
        if finite { Ok(found) } else { Err(Obstacle::Near) }
    }

    /// The pole of a term beside an interval, if its place and its residue are known well enough.
    fn beside(&self, index: usize, middle: Dd, half: f64) -> Result<Beside, Obstacle> {
        let Term { s: p, r, doubt, loose, .. } = self.h.terms[index];
        let is_on_axis = p.re.is_zero();
        let blur = loose / half * up::FEW;
        if is_on_axis {
            let is_alone = p.im.hi > 0.0 && !self.h.lined.has_rest() && blur <= MOST_BLUR;
            if !is_alone {
                return Err(Obstacle::Near);
            }
            let certain = r.to_f64().abs() * (1.0 - 1e-12) - doubt;
            if certain.is_nan() || certain <= 0.0 {
                return Err(Obstacle::Uncertain);
            }
        } else if loose != 0.0 {
            return Err(Obstacle::Near);
        }
        let half = Dd::from(half);
        let offset = Complex::new(-p.re / half, (middle - p.im) / half).to_f64();
        Ok(Beside { p, loose, offset, blur, reach: (offset.abs() + 1.0 + blur) * up::FEW })
    }

    fn hide(&mut self, index: Option<usize>) {
        if let Some(shown) = self.hidden.filter(|_| self.hidden != index) {
            self.others.set(shown, &self.h.terms[shown]);
        }
        if let Some(hidden) = index {
            self.others.set(hidden, &Term::FAR);
        }
        self.hidden = index;
    }
}

/// P = r / half + delta G from the polynomial of G, the sum over the other poles, and bounds of its errors.
///
/// A pole on the axis that is off by e, |e| <= `loose`, changes delta by e / half. The rest of H is times delta at most what its
/// bound leaves of the pole's own summand and delta times the others; in a disc about a point of the axis that reaches half as far
/// as to the nearest pole, another pole is at least a third as far as from the middle, so that Cauchy's formula bounds its
/// derivatives.
fn times_distance(
    pole: Beside,
    term: &Term,
    (sums, known): (&TaylorSums, [f64; 3]),
    (middle, half): (Dd, f64),
    clearance: f64,
    unit: f64,
) -> Expansion {
    let whole = Dd::from(half);
    let delta = Complex::new(-pole.p.re / whole, (middle - pole.p.im) / whole);
    let own = Complex::new(term.r.re / whole, term.r.im / whole);
    let mut coefficients = [Complex::<f64>::ZERO; DEGREE + 2];
    for (k, to) in coefficients.iter_mut().enumerate() {
        let of = |k: usize| sums.coefficients.get(k).copied().unwrap_or(Complex::ZERO);
        let before = k.checked_sub(1).map_or(own, |k| Complex::new(-of(k).im, of(k).re));
        *to = (delta * of(k) + before).to_f64();
    }
    let Beside { blur, reach, .. } = pole;
    let times = |of: [f64; 3]| [reach * of[0], of[0] + reach * of[1], 2.0 * of[1] + reach * of[2]];
    let mut errors = times(known);
    for k in 0..3 {
        errors[k] += blur * (sums.sizes[k] + known[k]) + 64.0 * unit * times(sums.sizes)[k];
    }
    errors[0] += (term.doubt + 64.0 * Dd::EPSILON * term.size) / half;
    // Of a pole on the axis there is no rest.
    let least = pole.p.re.to_f64().abs().min(clearance - half) * (1.0 - 1e-12);
    if term.rest != [0.0; 5] || sums.rests != [0.0; 5] {
        let radius = 0.5 * least;
        let most = middle.to_f64().abs() * up::FEW + half + radius;
        let rest = (0..5)
            .rev()
            .fold(0.0, |sum, m| sum * most + 4.0 * (reach + radius / half) * sums.rests[m] + term.rest[m] / half);
        let steeper = half / radius;
        let rests = [rest, rest * steeper, 2.0 * rest * steeper * steeper];
        errors.iter_mut().zip(rests).for_each(|(error, rest)| *error += rest * up::MILLIONS);
    }
    let cut = times(sums.cut).map(|x| x * up::MILLIONS);
    Expansion { coefficients, errors, cut, half, pole: Some(pole) }
}

impl Expansion {
    /// The pole's frequency, rad/s, where it is on the imaginary axis.
    pub fn infinite_at(&self) -> Option<Ball> {
        self.pole.filter(Beside::is_on_axis).map(|pole| Ball::new(pole.p.im, pole.loose))
    }

    /// What re(conj H dH/dt) is multiplied by to be a polynomial: 1, |delta|^4, or the third power of delta / i beside a pole on
    /// the axis; and a bound of its relative error.
    pub fn weight(&self, omega: Dd) -> (Dd, f64) {
        let Some(pole) = self.pole else { return (Dd::ONE, 0.0) };
        let [x, a] = [omega - pole.p.im, pole.p.re].map(|x| x / Dd::from(self.half));
        if pole.is_on_axis() {
            let blur = pole.blur / x.hi.abs();
            let error = if blur < MOST_BLUR { 4.0 * blur + 16.0 * Dd::EPSILON } else { f64::INFINITY };
            return (x * x * x, error);
        }
        let square = x * x + a * a;
        (square * square, 32.0 * Dd::EPSILON)
    }

    /// Whether the weight is positive between two t; `None` if it changes its sign.
    pub fn is_weight_positive(&self, low: f64, high: f64) -> Option<bool> {
        let Some(pole) = self.pole.filter(Beside::is_on_axis) else { return Some(true) };
        let margin = pole.blur + 8.0 * f64::EPSILON * pole.reach;
        let [low, high] = [low, high].map(|t| t + pole.offset.im);
        if low > margin { Some(true) } else { (high < -margin).then_some(false) }
    }

    /// H at t, and a bound of its error.
    pub fn value(&self, t: f64) -> (Complex<f64>, f64) {
        let c = &self.coefficients;
        let value = c.iter().rev().fold(Complex::<f64>::ZERO, |sum, &c| sum.scale(t) + c);
        let error = (self.errors[0] + 100.0 * f64::EPSILON * size(c, 0)) * up::THOUSANDS;
        let Some(pole) = self.pole else { return (value, error) };
        let delta = Complex::new(pole.offset.re, pole.offset.im + t);
        let least = delta.abs() - pole.blur - 8.0 * f64::EPSILON * pole.reach;
        let by_delta = (2.0 * (pole.blur + 16.0 * f64::EPSILON * pole.reach) / least * value.abs() + error) / least;
        let error = if least > 0.0 { by_delta * up::THOUSANDS } else { f64::INFINITY };
        (value * delta.recip(), error)
    }

    /// A bound of |d^2H/domega^2| within `reach` of a frequency at which |H| is at most `size`: of P / delta it is |P''| / |delta| +
    /// 2 |P'| / |delta|^2 + 2 |P| / |delta|^3.
    pub fn most_bend(&self, omega: Dd, reach: f64, size_of_h: f64) -> f64 {
        let [p1, p2] = [1, 2].map(|k| size(&self.coefficients, k) + self.errors[k]);
        let most = match self.pole {
            None => p2,
            Some(pole) => {
                let [x, a] = [omega - pole.p.im, pole.p.re].map(|x| x.to_f64() / self.half);
                let (delta, reach) = (Complex::new(x, a).abs(), reach / self.half * up::FEW);
                let p0 = (delta * up::DOZENS + pole.blur) * size_of_h + reach * p1;
                let least = delta * (1.0 - 1e-12) - pole.blur - reach;
                let inverse = if least > 0.0 { 1.0 / least } else { f64::INFINITY };
                (p2 + (2.0 * p1 + 2.0 * p0 * inverse) * inverse) * inverse
            }
        };
        most / (self.half * self.half) * up::DOZENS
    }
}

#[cfg(test)]
impl Expansion {
    /// Over |omega| <= 1; beside a pole at i omega + offset = 0 that is known to `blur`.
    pub fn sample(coefficients: &[Complex<f64>], errors: [f64; 3], pole: Option<(Complex<f64>, f64)>) -> Expansion {
        let mut all = [Complex::<f64>::ZERO; DEGREE + 2];
        all[..coefficients.len()].copy_from_slice(coefficients);
        let pole = pole.map(|(offset, blur)| {
            let p = Complex::new(-Dd::from(offset.re), -Dd::from(offset.im));
            Beside { p, loose: blur, offset, blur, reach: (offset.abs() + 1.0 + blur) * up::FEW }
        });
        Expansion { coefficients: all, errors, cut: [0.0; 3], half: 1.0, pole }
    }
}

impl Beside {
    pub fn is_on_axis(&self) -> bool {
        self.p.re.is_zero()
    }
}

impl PartialFractions {
    /// Adds e_0 + e_1 s + .. at s = i (middle + half t). Its sizes count as those of the terms.
    fn add_polynomial(&self, sums: &mut TaylorSums, middle: Dd, half: f64) {
        let w = middle.abs();
        for (power, e) in self.polynomial.iter().enumerate().filter(|(_, e)| !e.is_zero()) {
            let turn = [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)][power];
            let mut binomial = 1.0;
            for k in 0..=power {
                // e i^l C(l, k) middle^(l - k) half^k
                let powers = (0..power - k).fold(e.mid * Dd::from(binomial), |x, _| x * middle);
                let powers = (0..k).fold(powers, |x, _| x * Dd::from(half));
                let sum = &mut sums.coefficients[k];
                *sum = *sum + Complex::new(powers * Dd::from(turn.0), powers * Dd::from(turn.1));
                binomial *= (power - k) as f64 / (k + 1) as f64;
            }
            let most = (w.to_f64() + half).power(power as i32) * up::DOZENS;
            for k in 0..3 {
                sums.sizes[k] += 9.0 * e.magnitude() * most;
                sums.doubts[k] += 9.0 * e.rad * most;
            }
        }
    }
}

/// sum_k k^(0, 1, 2) |c_k|, the last with k (k - 1): bounds of a polynomial and its derivatives for |t| <= 1.
pub fn size(coefficients: &[Complex<f64>], derivative: usize) -> f64 {
    let factor = |k: usize| match derivative {
        0 => 1.0,
        1 => k as f64,
        _ => (k * k.saturating_sub(1)) as f64,
    };
    coefficients.iter().enumerate().map(|(k, c)| factor(k) * c.one_norm()).sum::<f64>() * up::DOZENS
}
