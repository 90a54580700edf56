//! H of one input and one output as a sum over poles, with a bound of the error of the sum:
//!
//! ```text
//! H(s) = sum r_j / (s - s_j) + e_0 + e_1 s + e_2 s^2 + e_3 s^3 + rest,
//! |rest| <= sum_j sum_m q_jm |s|^m / |s - s_j|
//! ```
//!
//! at every frequency, and within half the distance from it to the nearest pole, so that Cauchy's formula bounds the
//! derivatives of the rest. In: a system and the residues of its poles. Out: H and its derivative with respect to omega
//! at a frequency in double-double, and Taylor polynomials about one in binary64. See
//! docs/method/transfer.md#sum-over-poles.

use crate::analysis::poles::residues::Residues;
use crate::analysis::transfer::{Disc, Frequency, Gain, feed_through};
use crate::base::{Ball, Dd, Power, up};
use crate::kernel::complex::Complex;
use crate::kernel::simd::simd;
use crate::system::LinearSystem;

/// H of one input and one output.
#[derive(Clone, Debug)]
pub struct PartialFractions {
    terms: Vec<Term>,
    /// The coefficients of powers of s.
    polynomial: [Ball; 4],
}

/// r / (s - s_j), of a pole or of its conjugate.
#[derive(Clone, Copy, Debug)]
struct Term {
    s: Complex<Dd>,
    r: Complex<Dd>,
    /// A bound of |r|, and one of the error of r.
    size: f64,
    doubt: f64,
    /// The bounds q of the rest.
    rest: [f64; 5],
}

/// H and dH/domega at a frequency.
#[derive(Clone, Copy, Debug)]
pub struct Local {
    pub h: Complex<Dd>,
    pub slope: Complex<Dd>,
    /// Bounds of the errors of both.
    pub errors: [f64; 2],
}

/// The degree of Taylor polynomials.
pub const DEGREE: usize = 16;

/// A Taylor polynomial of H about a frequency, in (omega - middle) / half.
#[derive(Clone, Debug)]
pub struct Expansion {
    pub coefficients: [Complex<f64>; DEGREE + 1],
    /// Bounds of the errors of H and of its first two derivatives over |omega - middle| <= half.
    pub errors: [f64; 3],
    /// The part of these errors that a smaller interval reduces: the error of the omitted terms.
    pub cut: [f64; 3],
}

impl PartialFractions {
    /// `None` if a bound is not finite.
    pub fn of(system: &LinearSystem, residues: &Residues, input: usize, output: usize) -> Option<PartialFractions> {
        let through = feed_through(&system.outputs[output], input);
        let mut polynomial = [through[0], through[1], through[2], Ball::ZERO];
        let (excited, seen) = (residues.inputs.get(input)?, residues.outputs.get(output)?);
        let mut terms = Vec::with_capacity(2 * residues.poles.len());
        for (j, &s) in residues.poles.iter().enumerate() {
            let is_real = s.im.is_zero();
            let mut products = [Complex::<Ball>::ZERO; 5];
            let mut rest = [0.0; 5];
            for (a, seen) in seen.iter().enumerate() {
                for (b, excited) in excited.iter().enumerate() {
                    let (Some(seen), Some(excited)) = (seen, excited) else { continue };
                    products[a + b] = products[a + b] + seen[j] * excited.amplitudes[j];
                    rest[a + b] += seen[j].magnitude() * excited.rest[j] * up::FEW;
                }
            }
            // s^m / (s - s_j) = s_j^m / (s - s_j) + s_j^(m - 1) + s_j^(m - 2) s + .. + s^(m - 1)
            let mut r = Complex::<Ball>::ZERO;
            for (m, &product) in products.iter().enumerate() {
                let mut scaled = product;
                for power in (0..m).rev() {
                    let both = if is_real { scaled.re } else { scaled.re * Ball::from(2.0) };
                    polynomial[power] = polynomial[power] + both;
                    scaled = scaled * s.to_ball();
                }
                r = r + scaled;
            }
            let term = Term { s, r: r.mid(), size: r.magnitude(), doubt: r.radius(), rest };
            terms.push(term);
            if !is_real {
                terms.push(Term { s: s.conj(), r: r.mid().conj(), ..term });
            }
        }
        let finite = |term: &Term| term.size.is_finite() && term.rest.iter().all(|x| x.is_finite());
        let known = terms.iter().all(finite) && polynomial.iter().all(Ball::is_finite);
        known.then_some(PartialFractions { terms, polynomial })
    }

    /// The largest |s_j|, rad/s.
    pub fn largest(&self) -> f64 {
        self.terms.iter().map(|term| term.s.to_f64().abs()).fold(0.0, f64::max)
    }

    /// Whether H is zero as far as the sum shows: the output sees no motion that the input drives.
    pub fn is_nothing(&self) -> bool {
        self.terms.iter().all(|term| term.r == Complex::ZERO) && self.polynomial.iter().all(Ball::is_zero)
    }

    /// A lower bound of the distance of a frequency from the nearest pole, rad/s.
    pub fn clearance(&self, omega: Dd) -> f64 {
        let distance = |term: &Term| {
            let d = offset(omega, term.s);
            d.re * d.re + d.im * d.im
        };
        self.terms.iter().map(distance).fold(f64::INFINITY, f64::min).sqrt() * (1.0 - 1e-12)
    }

    /// Bounds of the rest and of its first two derivatives at frequencies between `omega` - `half` and `omega` + `half`, given
    /// the sums over `terms` of q_m / |i omega - s_j| at `omega`, where every pole is at least twice as far as `half`.
    fn rest(&self, sums: [f64; 5], omega: f64, half: f64, clearance: f64) -> [f64; 3] {
        // Distances of poles are at least half as large anywhere in the interval, and half of that in the disc of Cauchy's
        // formula about a point in it.
        let radius = 0.25 * clearance;
        let reach = omega.abs() + half + radius;
        let most = 4.0 * sums.iter().rev().fold(0.0, |sum, &q| sum * reach + q);
        [most, most / radius, 2.0 * most / (radius * radius)].map(|bound| bound * up::MILLIONS)
    }

    /// H and dH/domega at a frequency, rad/s.
    pub fn at(&self, omega: Dd) -> Local {
        let sums = sums(&self.terms, omega);
        let count = (4 * self.terms.len() + 64) as f64 * Dd::EPSILON;
        let w = omega.to_f64().abs() * up::FEW;
        let mut errors = [0, 1].map(|k| (sums.sizes[k] * count + sums.doubts[k]) * up::MILLIONS);
        let rest = self.rest(sums.rests, w, 0.0, self.clearance(omega));
        // d/domega of 1 / (i omega - s) is -i / (i omega - s)^2.
        let mut h = sums.first;
        let mut slope = Complex::new(sums.second.im, -sums.second.re);
        let [e0, e1, e2, e3] = self.polynomial.map(|e| e.mid);
        let square = omega * omega;
        h = h + Complex::new(e0 - e2 * square, (e1 - e3 * square) * omega);
        slope = slope + Complex::new(-(e2 * omega).scale(2.0), e1 - e3 * square * Dd::from(3.0));
        let loose = self.polynomial.map(|e| e.rad + 64.0 * Dd::EPSILON * e.magnitude());
        let powers = [1.0, w, w * w, w * w * w];
        for power in 0..4 {
            errors[0] += loose[power] * powers[power];
            if power > 0 {
                errors[1] += power as f64 * loose[power] * powers[power - 1];
            }
        }
        let errors = [0, 1].map(|k| (errors[k] + rest[k]) * up::DOZENS + f64::MIN_POSITIVE);
        Local { h, slope, errors }
    }

    /// Approximations of H and dH/domega in binary64, to steer a search.
    pub fn near(&self, omega: Dd) -> [Complex<f64>; 2] {
        let [mut h, mut slope] = near_sums(&self.terms, omega);
        let w = omega.to_f64();
        let [e0, e1, e2, e3] = self.polynomial.map(|e| e.to_f64());
        h = h + Complex::new(e0 - e2 * w * w, (e1 - e3 * w * w) * w);
        slope = slope + Complex::new(-2.0 * e2 * w, e1 - 3.0 * e3 * w * w);
        [h, slope]
    }

    /// H at a frequency; unknown if it is too close to a pole.
    pub fn gain(&self, frequency: &Frequency) -> Gain {
        let omega = frequency.omega;
        let (clearance, reach) = (self.clearance(omega.mid), omega.rad);
        let is_clear = 2.0 * reach <= clearance;
        if !is_clear {
            return Gain::Unknown;
        }
        let local = self.at(omega.mid);
        // Over the ball |dH/domega| is at most 4 sum |r| / |i omega - s|^2, and that of the polynomial, and of the rest.
        let steepest = 4.0 * sums(&self.terms, omega.mid).sizes[1]
            + (1..4)
                .map(|l| l as f64 * self.polynomial[l].magnitude() * omega.magnitude().power(l as i32 - 1))
                .sum::<f64>();
        let radius = (local.errors[0] + reach * (steepest * up::MILLIONS + local.errors[1])) * up::MILLIONS;
        let disc = Disc { value: local.h, radius };
        let finite = radius.is_finite() && local.h.re.is_finite() && local.h.im.is_finite();
        if finite { Gain::Finite(disc) } else { Gain::Unknown }
    }

    /// The Taylor polynomial about `middle`, for |omega - middle| <= half; `None` if a pole is less than twice as far as
    /// `half`. With `precise`, sums are taken in double-double, for frequencies at which most of H cancels.
    pub fn expansion(&self, middle: Dd, half: f64, precise: bool) -> Option<Expansion> {
        let clearance = self.clearance(middle);
        let is_clear = 2.0 * half <= clearance;
        if !is_clear {
            return None;
        }
        let mut sums = taylor(&self.terms, middle, half, precise);
        self.add_polynomial(&mut sums, middle, half);
        let unit = if precise { Dd::EPSILON } else { f64::EPSILON };
        let count = (2 * self.terms.len() + 32 * DEGREE) as f64 * unit;
        let rest = self.rest(sums.rests, middle.to_f64().abs() * up::FEW, half, clearance);
        let scale = [1.0, half, half * half];
        let cut = [0, 1, 2].map(|k| sums.cut[k] * up::MILLIONS);
        // Coefficients are rounded to binary64 once more, beside their own size.
        let own = [0, 1, 2].map(|k| f64::EPSILON * size(&sums.coefficients, k));
        let errors = [0, 1, 2].map(|k| {
            (cut[k] + count * sums.sizes[k] + sums.doubts[k] + rest[k] * scale[k] + own[k]) * up::MILLIONS
                + f64::MIN_POSITIVE
        });
        let finite = errors.iter().all(|x| x.is_finite()) && sums.coefficients.iter().all(|c| c.is_finite());
        finite.then_some(Expansion { coefficients: sums.coefficients, errors, cut })
    }

    /// Adds e_0 + e_1 s + .. at s = i (middle + half t). Its sizes count as those of the terms.
    fn add_polynomial(&self, sums: &mut TaylorSums, middle: Dd, half: f64) {
        let w = middle.abs();
        for (power, e) in self.polynomial.iter().enumerate().filter(|(_, e)| !e.is_zero()) {
            let turn = [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)][power];
            let mut binomial = 1.0;
            for k in 0..=power {
                // e i^l C(l, k) middle^(l - k) half^k
                let powers =
                    (0..power - k).fold(e.mid * Dd::from(binomial), |x, _| x * middle).to_f64() * half.power(k as i32);
                let sum = &mut sums.coefficients[k];
                *sum = *sum + Complex::new(turn.0 * powers, turn.1 * powers);
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

/// i omega - s in binary64, to a few roundings: both are subtracted in double-double.
#[inline(always)]
fn offset(omega: Dd, s: Complex<Dd>) -> Complex<f64> {
    Complex::new(-s.re.hi, (omega - s.im).hi)
}

/// Sums over all terms at a frequency.
struct Sums {
    /// sum r / d and sum r / d^2, d = i omega - s_j
    first: Complex<Dd>,
    second: Complex<Dd>,
    /// The two sums with |r|, and with the errors of r, in place of r.
    sizes: [f64; 2],
    doubts: [f64; 2],
    /// sum q_m / |d|
    rests: [f64; 5],
}

simd! {
    fn sums(terms: &[Term], omega: Dd) -> Sums {
        let zero = Complex::<Dd>::ZERO;
        let mut sums = Sums { first: zero, second: zero, sizes: [0.0; 2], doubts: [0.0; 2], rests: [0.0; 5] };
        for term in terms {
            let d = Complex::new(-term.s.re, omega - term.s.im);
            let square = d.re * d.re + d.im * d.im;
            let scale = Dd::ONE / square;
            let inverse = Complex::new(d.re * scale, -(d.im * scale));
            let quotient = term.r * inverse;
            sums.first = sums.first + quotient;
            sums.second = sums.second + quotient * inverse;
            let near = scale.hi.sqrt();
            sums.sizes[0] += term.size * near;
            sums.sizes[1] += term.size * near * near;
            sums.doubts[0] += term.doubt * near;
            sums.doubts[1] += term.doubt * near * near;
            for (sum, q) in sums.rests.iter_mut().zip(term.rest) {
                *sum += q * near;
            }
        }
        sums
    }
}

simd! {
    fn near_sums(terms: &[Term], omega: Dd) -> [Complex<f64>; 2] {
        let (mut first, mut second) = (Complex::<f64>::ZERO, Complex::<f64>::ZERO);
        for term in terms {
            let d = offset(omega, term.s);
            let scale = 1.0 / (d.re * d.re + d.im * d.im);
            let inverse = Complex::new(d.re * scale, -(d.im * scale));
            let quotient = Complex::new(term.r.re.hi, term.r.im.hi) * inverse;
            first = first + quotient;
            second = second + quotient * inverse;
        }
        [first, Complex::new(second.im, -second.re)]
    }
}

/// Sums over all terms of a Taylor polynomial.
struct TaylorSums {
    coefficients: [Complex<f64>; DEGREE + 1],
    /// Bounds of H and of its derivatives, term by term, to which rounding errors are relative.
    sizes: [f64; 3],
    doubts: [f64; 3],
    /// Bounds of the terms after the polynomial.
    cut: [f64; 3],
    rests: [f64; 5],
}

fn taylor(terms: &[Term], middle: Dd, half: f64, precise: bool) -> TaylorSums {
    let mut sums = bounds(terms, middle, half);
    sums.coefficients =
        if precise { precise_coefficients(terms, middle, half) } else { coefficients(terms, middle, half) };
    sums
}

simd! {
    /// With x = r / d and q = -i half / d the coefficients are sums of x q^k. For |q| <= 1/2,
    /// sum over k > K of |q|^k, k |q|^k, k (k - 1) |q|^k is at most |q|^(K + 1) times 1 / (1 - |q|), (K + 1) / (1 - |q|)^2 and
    /// 2 K (K + 1) / (1 - |q|)^3.
    fn bounds(terms: &[Term], middle: Dd, half: f64) -> TaylorSums {
        let (none, k) = ([0.0; 3], DEGREE as f64);
        let mut sums = TaylorSums {
            coefficients: [Complex::ZERO; DEGREE + 1], sizes: none, doubts: none, cut: none, rests: [0.0; 5],
        };
        for term in terms {
            let d = offset(middle, term.s);
            let near = 1.0 / (d.re * d.re + d.im * d.im).sqrt();
            let q = half * near * up::DOZENS;
            let sum = 1.0 / (1.0 - q);
            let (x, doubt) = (term.size * near, term.doubt * near);
            let weights = [sum, q * sum * sum, 2.0 * q * q * sum * sum * sum];
            let power = (0..=DEGREE).fold(1.0, |power, _| power * q);
            let tails = [sum, (k + 1.0) * sum * sum, 2.0 * k * (k + 1.0) * sum * sum * sum];
            for i in 0..3 {
                sums.sizes[i] += x * weights[i];
                sums.doubts[i] += doubt * weights[i];
                sums.cut[i] += x * power * tails[i];
            }
            for (sum, rest) in sums.rests.iter_mut().zip(term.rest) {
                *sum += rest * near;
            }
        }
        sums
    }
}

simd! {
    fn coefficients(terms: &[Term], middle: Dd, half: f64) -> [Complex<f64>; DEGREE + 1] {
        let mut all = [Complex::<f64>::ZERO; DEGREE + 1];
        for term in terms {
            let d = offset(middle, term.s);
            let scale = 1.0 / (d.re * d.re + d.im * d.im);
            let inverse = Complex::new(d.re * scale, -(d.im * scale));
            let mut x = Complex::new(term.r.re.hi, term.r.im.hi) * inverse;
            // -i half / d
            let q = Complex::new(half * inverse.im, -(half * inverse.re));
            for sum in &mut all {
                *sum = *sum + x;
                x = x * q;
            }
        }
        all
    }
}

simd! {
    fn precise_coefficients(terms: &[Term], middle: Dd, half: f64) -> [Complex<f64>; DEGREE + 1] {
        let mut all = [Complex::<Dd>::ZERO; DEGREE + 1];
        for term in terms {
            let d = Complex::new(-term.s.re, middle - term.s.im);
            let scale = Dd::ONE / (d.re * d.re + d.im * d.im);
            let inverse = Complex::new(d.re * scale, -(d.im * scale));
            let mut x = term.r * inverse;
            let half = Dd::from(half);
            let q = Complex::new(half * inverse.im, -(half * inverse.re));
            for sum in &mut all {
                *sum = *sum + x;
                x = x * q;
            }
        }
        all.map(Complex::to_f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 1 / (s - p) + 1 / (s - p*) with p = -0.1 + i, and a Taylor polynomial about 1.3 that reaches half way to the pole:
    /// its terms fall by no more than that, so those after the last are far larger than any rounding.
    #[test]
    fn a_polynomial_is_as_near_as_it_says() {
        let term = |im: f64| Term {
            s: Complex::new(Dd::from(-0.1), Dd::from(im)),
            r: Complex::new(Dd::ONE, Dd::ZERO),
            size: 1.0,
            doubt: 0.0,
            rest: [0.0; 5],
        };
        let sum = PartialFractions { terms: vec![term(1.0), term(-1.0)], polynomial: [Ball::ZERO; 4] };
        let (middle, half) = (1.3, 0.15);
        for precise in [false, true] {
            let expansion = sum.expansion(Dd::from(middle), half, precise).expect("clear");
            let mut most = [0.0f64; 2];
            for step in -20..=20 {
                let t = f64::from(step) / 20.0;
                let zero = Complex::<f64>::ZERO;
                let value = expansion.coefficients.iter().rev().fold(zero, |sum, &c| sum.scale(t) + c);
                let slope = (expansion.coefficients.iter().enumerate().skip(1).rev())
                    .fold(zero, |sum, (k, &c)| sum.scale(t) + c.scale(k as f64));
                let truth = sum.at(Dd::from(middle) + Dd::from(half * t));
                let off = [(value, truth.h), (slope.scale(1.0 / half), truth.slope)].map(|(a, b)| {
                    Complex::new((b.re - Dd::from(a.re)).to_f64(), (b.im - Dd::from(a.im)).to_f64()).abs()
                });
                let bounds = [expansion.errors[0], expansion.errors[1] / half];
                assert!(off[0] <= bounds[0] && off[1] <= bounds[1], "{t}: {off:?} {bounds:?}");
                most = [most[0].max(off[0]), most[1].max(off[1])];
            }
            assert!(most[0] > 1e-3 * expansion.errors[0] && most[0] > 1e-9, "{most:?} {:?}", expansion.errors);
        }
        assert!(sum.expansion(Dd::from(middle), 0.17, false).is_none());
    }
}
