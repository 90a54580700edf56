//! Residuals K x - theta M x in double-double from the terms, with bounds of their norms.
//!
//! Each term first computes its stretch, so a stiff spring that hardly stretches has hardly any error.
//! See docs/method/modes.md#sparse-parts.

use crate::analysis::modes::mesh::network::UP;
use crate::analysis::modes::terms::{Factor, Factors, Terms};
use crate::base::{Dd, up};
use crate::kernel::simd::simd;
use crate::system::CoordinateId;

/// A x of a form, and a bound of each entry's error.
#[derive(Clone, Debug)]
pub struct Image {
    pub value: Vec<Dd>,
    pub error: Vec<f64>,
    /// x^T A x
    pub energy: Dd,
}

/// A form ready for multiplication in double-double.
pub struct Multiplier<'a> {
    terms: &'a Terms<'a>,
    weights: Vec<Dd>,
    /// The most terms that act on one coordinate.
    most: f64,
}

impl<'a> Multiplier<'a> {
    pub fn of(terms: &'a Terms<'a>, n: usize) -> Multiplier<'a> {
        let mut counts = vec![0u32; n];
        for t in 0..terms.len() {
            terms.row(t).0.iter().for_each(|&i| counts[i.index()] += 1);
        }
        let weights = terms.weights().map(|weight| weight.value.dd()).collect();
        Multiplier { terms, weights, most: f64::from(counts.into_iter().max().unwrap_or(0)) }
    }

    /// A x.
    pub fn apply(&self, x: &[Dd]) -> Image {
        image(self, x)
    }

    #[inline(always)]
    fn image(&self, x: &[Dd]) -> Image {
        let mut value = vec![Dd::ZERO; x.len()];
        let mut error = vec![0.0; x.len()];
        let mut energy = Dd::ZERO;
        // A sum of up to `most` numbers, each with its own rounding error.
        let sums = (self.most + 2.0) * Dd::EPSILON;
        for t in 0..self.terms.len() {
            let (indices, factors) = self.terms.row(t);
            let (stretch, slip) = stretch(indices, factors, x);
            let weight = self.weights[t];
            let force = weight * stretch;
            energy += force * stretch;
            let size = force.hi.abs();
            let doubt = self.terms.weight(t).radius + 2.0 * Dd::EPSILON * weight.hi.abs();
            let force_error = (weight.hi.abs() + doubt) * slip + doubt * stretch.hi.abs() + Dd::EPSILON * size;
            for (&i, factor) in indices.iter().zip(factors.iter()) {
                let i = i.index();
                match factor {
                    Factor::Plus => value[i] += force,
                    Factor::Minus => value[i] -= force,
                    Factor::Other(a) => value[i] += a.value.dd() * force,
                }
                let a = factor.to_f64().abs();
                error[i] += a * (force_error + sums * size) + radius(&factor) * (size + force_error);
            }
        }
        error.iter_mut().for_each(|error| *error *= UP);
        Image { value, error, energy }
    }
}

simd! {
    fn image(form: &Multiplier, x: &[Dd]) -> Image {
        form.image(x)
    }
}

#[inline(always)]
fn radius(factor: &Factor) -> f64 {
    match factor {
        Factor::Other(a) => a.radius + 2.0 * Dd::EPSILON * a.value.hi().abs(),
        _ => 0.0,
    }
}

/// a . x and a bound of its error.
#[inline(always)]
fn stretch(indices: &[CoordinateId], factors: Factors, x: &[Dd]) -> (Dd, f64) {
    let (mut sum, mut slip) = (Dd::ZERO, 0.0);
    for (at, (&i, factor)) in indices.iter().zip(factors.iter()).enumerate() {
        let x = x[i.index()];
        let part = match factor {
            Factor::Plus => x,
            Factor::Minus => -x,
            Factor::Other(a) => {
                slip += (radius(&factor) + Dd::EPSILON * a.value.hi().abs()) * x.hi.abs() * UP;
                a.value.dd() * x
            }
        };
        sum += part;
        if at > 0 {
            // The rounding error of a sum is relative to it.
            slip += Dd::EPSILON * sum.hi.abs();
        }
    }
    (sum, slip * UP)
}

/// K x - theta M x.
pub struct Residual {
    pub value: Vec<f64>,
    /// Bound of its norm in the inverse of diag(scale).
    pub norm: f64,
    /// x^T K x / x^T M x, not certified.
    pub quotient: Dd,
}

/// The residual of x at theta.
pub fn residual(k: &Multiplier, m: &Multiplier, x: &[Dd], theta: Dd, scale: &[f64]) -> Residual {
    let (forces, momenta) = (k.apply(x), m.apply(x));
    let size = theta.hi.abs() * up::FEW;
    let mut value = Vec::with_capacity(x.len());
    let mut sum = 0.0;
    for (i, &scale) in scale.iter().enumerate() {
        let inertia = theta * momenta.value[i];
        let rest = forces.value[i] - inertia;
        let rounding = 2.0 * Dd::EPSILON * (rest.hi.abs() + inertia.hi.abs());
        let most = rest.hi.abs() * up::FEW + forces.error[i] + size * momenta.error[i] + rounding;
        sum += most * most / scale;
        value.push(rest.hi);
    }
    Residual { value, norm: (sum * UP).sqrt() * UP, quotient: forces.energy / momenta.energy }
}
