//! From an undamped mode to the pole that it becomes: residual inverse iteration, x <- x - Q(sigma)^-1 Q(s) x with s from
//! Rayleigh's quotient (Neumaier, SIAM J. Numer. Anal. 22 (1985) 914), residuals of the terms in double-double. In: networks,
//! terms, a mode. Out: s and x; how good they are is the discs' business. Clause: spec.md 11.11.

use crate::analysis::numeric::complex::Complex;
use crate::analysis::poles::pencil::{Pencil, Vector};
use crate::analysis::poles::refinement::Pair;
use crate::analysis::poles::targeted::elimination::Networks;
use crate::base::Dd;
use std::cmp::Ordering;

/// A good start takes five.
const MOST_STEPS: usize = 16;
/// After such a correction the vector's error is its square, about.
const SETTLED: f64 = 1e-10;
/// A change of the vector above this deserves a new factorisation.
const ROUGH: f64 = 1e-6;

/// A pole farther than this part of omega from i omega belongs to no mode in particular.
const FAR: f64 = 0.7;

/// The pole near i omega of the mode x (x^T M x = 1); `None` where nothing settles near it.
pub fn follow(networks: &Networks, pencil: &Pencil<Dd>, omega: f64, x: &[f64]) -> Option<Pair> {
    let re = x.iter().map(|&x| Dd::from(x)).collect();
    let start = Complex::new(0.0, omega);
    let mut pair = Pair { s: start.into(), x: Vector { re, im: vec![Dd::ZERO; x.len()] } };
    let mut factors = None;
    for _ in 0..MOST_STEPS {
        let mut applied = pencil.apply(pair.s, &pair.x);
        let slope = pencil.slope(pair.s.to_f64(), &applied);
        let s = pair.s + (-(applied.energy.to_f64() * slope.recip())).into();
        pencil.shift(&mut applied, pair.s, s);
        pair.s = s;
        if (s.to_f64() - start).abs().partial_cmp(&(FAR * omega)) != Some(Ordering::Less) {
            return None;
        }
        let Some(factors) = &factors else {
            // Inverse iteration with a factorisation of its own; the vector keeps its product with the slope.
            let new = networks.factor(s.to_f64())?;
            let momentum = pencil.slope_force(s, &applied);
            let found = new.solve(&momentum);
            let product =
                |y: &dyn Fn(usize) -> Complex<f64>| (0..x.len()).fold(Complex::ZERO, |sum, i| sum + momentum[i] * y(i));
            let before = product(&|i| pair.x.entry(i).to_f64());
            let scale = before * product(&|i| found[i]).recip();
            let next: Vec<Complex<f64>> = found.iter().map(|&y| y * scale).collect();
            let size = (0..x.len()).map(|i| (next[i] - pair.x.entry(i).to_f64()).one_norm()).fold(0.0, f64::max);
            let rough = size > ROUGH * norm(&next);
            let words = |of: fn(&Complex<f64>) -> f64| next.iter().map(|z| Dd::from(of(z))).collect();
            pair.x = Vector { re: words(|z| z.re), im: words(|z| z.im) };
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

fn norm(x: &[Complex<f64>]) -> f64 {
    x.iter().map(|z| z.one_norm()).fold(0.0, f64::max)
}
