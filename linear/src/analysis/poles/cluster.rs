//! Equal poles need separate vectors. In: refined pairs, where those of one multiple pole have arbitrary vectors of its
//! eigenspace. Out: the same pairs, with vectors that are orthogonal in the form that diagonalises the pencil, B(x, y)
//! = x^T ((s_x + s_y) M + C) y, as those of different poles already are.
//! See docs/method/poles.md#general-systems.
//!
//! Gram-Schmidt, applied twice, with the products in double-double and the factors in binary64. If B(x, x) vanishes,
//! the pole is defective or the vector depends on those before it: then it is left unchanged, and the discs show it.

use crate::analysis::poles::pencil::{Application, Pencil, Vector};
use crate::analysis::poles::refinement::Pair;
use crate::base::Dd;
use crate::kernel::complex::Complex;

/// Poles whose relative difference is at most this are treated as equal; if they are not, the process changes nothing.
const CLOSE: f64 = 1e-8;
/// If less than this is left of a vector, it depends on the others to working precision.
const DEPENDENT: f64 = 1e-10;

/// Makes the vectors of each group of close poles orthogonal.
pub fn separate(pencil: &Pencil<Dd>, pairs: &mut [Pair]) {
    for i in 1..pairs.len() {
        let (before, rest) = pairs.split_at_mut(i);
        let pair = &mut rest[0];
        let near: Vec<&Pair> = before.iter().filter(|other| are_close(other, pair)).collect();
        if !near.is_empty() {
            orthogonalise(pencil, pair, &near);
        }
    }
}

fn are_close(a: &Pair, b: &Pair) -> bool {
    a.is_real() == b.is_real() && (a.s - b.s).to_f64().one_norm() <= CLOSE * b.s.to_f64().one_norm()
}

fn orthogonalise(pencil: &Pencil<Dd>, pair: &mut Pair, others: &[&Pair]) {
    let known: Vec<Application<Dd>> = others.iter().map(|other| pencil.apply(other.s, &other.x)).collect();
    let mut x = pair.x.clone();
    let first = size(pencil, &pencil.apply(pair.s, &x));
    for _ in 0..2 {
        for (other, applied) in others.iter().zip(&known) {
            let own = pencil.apply(pair.s, &x);
            let square = product(pencil, other.s + other.s, applied, applied);
            let factor = -(product(pencil, pair.s + other.s, applied, &own) * square.recip());
            if !factor.is_finite() {
                return;
            }
            add(&mut x, factor, &other.x);
        }
    }
    if size(pencil, &pencil.apply(pair.s, &x)) > DEPENDENT * first {
        pair.x = x;
    }
}

/// x_a^T (z M + C) x_b from the stretches.
fn product(pencil: &Pencil<Dd>, z: Complex<Dd>, a: &Application<Dd>, b: &Application<Dd>) -> Complex<f64> {
    let sum = |weights: &[Dd], a: &[Complex<Dd>], b: &[Complex<Dd>]| {
        let parts = weights.iter().zip(a.iter().zip(b)).map(|(&w, (&a, &b))| (a * b).scale(w));
        parts.fold(Complex::ZERO, |sum, part| sum + part)
    };
    let inertia = z * sum(&pencil.m.weights, &a.m_stretch, &b.m_stretch);
    (inertia + sum(&pencil.c.weights, &a.c_stretch, &b.c_stretch)).to_f64()
}

/// x^H M x
fn size(pencil: &Pencil<Dd>, applied: &Application<Dd>) -> f64 {
    let parts = pencil.m.weights.iter().zip(&applied.m_stretch);
    parts.map(|(w, t)| w.hi * (t.re.hi * t.re.hi + t.im.hi * t.im.hi)).sum()
}

/// x <- x + factor y
fn add(x: &mut Vector, factor: Complex<f64>, y: &Vector) {
    let factor: Complex<Dd> = factor.into();
    for i in 0..x.re.len() {
        let part = factor * y.entry(i);
        x.re[i] += part.re;
        if let Some(im) = x.im.get_mut(i) {
            *im += part.im;
        }
    }
}
