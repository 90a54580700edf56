//! From a rough start to a pole: residual inverse iteration, x <- x - Q(sigma)^-1 Q(s) x with s from the Rayleigh
//! quotient (Neumaier, SIAM J. Numer. Anal. 22 (1985) 914), residuals of the terms in double-double. In: networks,
//! terms, a start. Out: s and x; the discs determine how accurate they are.
//! See docs/method/poles.md#poles-followed-from-modes.

use crate::analysis::poles::pencil::{Pencil, Vector};
use crate::analysis::poles::refinement::Pair;
use crate::analysis::poles::targeted::elimination::Networks;
use crate::base::Dd;
use crate::kernel::complex::Complex;
use std::cmp::Ordering;

/// A good start takes five steps.
const MOST_STEPS: usize = 16;
/// After such a correction the vector's error is about its square.
const SETTLED: f64 = 1e-10;
/// A larger change of the vector is worth a new factorisation.
const ROUGH: f64 = 1e-6;

/// A pole at a relative distance above this from the start is a different one.
const FAR: f64 = 0.5;

/// A rough pole and its vector.
pub struct Start {
    pub s: Complex<f64>,
    pub x: Vec<Complex<f64>>,
    /// The mode with the largest contribution to it.
    pub mode: usize,
}

/// The pole near a start (with x scaled to about x^T M x = 1); `None` if the iteration does not converge near it.
pub fn follow(networks: &Networks, pencil: &Pencil<Dd>, start: &Start) -> Option<Pair> {
    let n = start.x.len();
    let mut pair = Pair { s: start.s.into(), x: words(&start.x) };
    let mut factors = None;
    for _ in 0..MOST_STEPS {
        let mut applied = pencil.apply(pair.s, &pair.x);
        let slope = pencil.slope(pair.s.to_f64(), &applied);
        let s = pair.s + (-(applied.energy.to_f64() * slope.recip())).into();
        pencil.shift(&mut applied, pair.s, s);
        pair.s = s;
        if (s.to_f64() - start.s).abs().partial_cmp(&(FAR * start.s.abs())) != Some(Ordering::Less) {
            return None;
        }
        let Some(factors) = &factors else {
            // Inverse iteration with a new factorisation; the vector keeps its product with the slope.
            let new = networks.factor(s.to_f64())?;
            let momentum = pencil.slope_force(s, &applied);
            let found = new.solve(&momentum);
            let product =
                |y: &dyn Fn(usize) -> Complex<f64>| (0..n).fold(Complex::ZERO, |sum, i| sum + momentum[i] * y(i));
            let before = product(&|i| pair.x.entry(i).to_f64());
            let scale = before * product(&|i| found[i]).recip();
            let next: Vec<Complex<f64>> = found.iter().map(|&y| y * scale).collect();
            let size = (0..n).map(|i| (next[i] - pair.x.entry(i).to_f64()).one_norm()).fold(0.0, f64::max);
            let rough = size > ROUGH * norm(&next);
            pair.x = words(&next);
            factors = (!rough).then_some(new);
            continue;
        };
        let force: Vec<Complex<f64>> = applied.force.iter().map(|f| f.to_f64()).collect();
        let step = factors.solve(&force);
        let size = norm(&step) / pair.x.re.iter().map(|x| x.hi.abs()).fold(0.0, f64::max);
        if !size.is_finite() {
            return None;
        }
        step.iter().enumerate().for_each(|(i, &step)| pair.x.add(i, -step));
        if size < SETTLED {
            return Some(pair);
        }
    }
    None
}

fn words(x: &[Complex<f64>]) -> Vector {
    let of = |part: fn(&Complex<f64>) -> f64| x.iter().map(|z| Dd::from(part(z))).collect();
    Vector { re: of(|z| z.re), im: of(|z| z.im) }
}

fn norm(x: &[Complex<f64>]) -> f64 {
    x.iter().map(|z| z.one_norm()).fold(0.0, f64::max)
}
