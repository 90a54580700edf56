//! The motion of a system in coordinates of its poles. In: the columns in which the poles are certified, and the bounds of that
//! proof. Out: what inputs and the initial state excite of each pole, and a bound of what couples the poles.
//! docs/method/response.md#pole-steps derives it:
//!
//! With (q, q') = sum of (x_j, s_j x_j) eta_j over all pairs and their conjugates, and Z^T L(s) Z = B (s - D + T),
//! B = Lambda (1 + F),
//!   eta' = (D - T) eta + (1 + F)^-1 Lambda^-1 Z^T (f, 0).
//! The s_j and x_j are exact numbers here, so D is known exactly, and T and F are as small as the residuals of the pairs.

use crate::analysis::poles::disc_columns::UP;
use crate::analysis::poles::refinement::Pair;
use crate::analysis::poles::residues::{Proof, norm, row_product};
use crate::base::{Ball, Number, larger};
use crate::kernel::complex::Complex;
use crate::kernel::real::Real;
use crate::kernel::squares::Squares;
use crate::kernel::triple::Precise;
use crate::system::{CoordinateId, LinearSystem};

/// Coordinates zeta_j = eta_j / g_j of one pole of each conjugate pair; the g_j are powers of two that bring them to like sizes.
#[derive(Clone, Debug)]
pub struct PoleCoordinates {
    /// s_j and x_j
    pub(in crate::analysis) pairs: Vec<Pair>,
    /// Lambda_j = x_j^T (2 s_j M + C) x_j
    pub(in crate::analysis) norms: Vec<Complex<Ball>>,
    /// The largest energy of a vector over |s_j Lambda_j|: near 1 where the motions are apart, large where they nearly coincide, so
    /// that what is excited of them cancels.
    pub(in crate::analysis) cancellation: f64,
    /// g_j
    pub(in crate::analysis) scale: Vec<f64>,
    /// For each input its powers of s: what the input adds to zeta'.
    pub(in crate::analysis) inputs: Vec<[Option<Vec<Complex<Ball>>>; 3]>,
    /// The initial state.
    pub(in crate::analysis) start: Vec<Complex<Ball>>,
    /// A bound of the 2-norm of T over the parts of all zeta_j.
    pub(in crate::analysis) coupling: f64,
}

impl PoleCoordinates {
    /// row . x_j of each pole.
    pub(in crate::analysis) fn sees(&self, row: &[(usize, Ball)]) -> Vec<Complex<Ball>> {
        self.pairs.iter().map(|pair| row_product(pair, row)).collect()
    }
}

impl Proof<'_> {
    /// The coordinates of a system that is one part, whose coordinates keep their numbers in it. `None` where motions are free
    /// or dragged: their columns are no eigenvectors.
    pub fn coordinates(&self, system: &LinearSystem) -> Option<PoleCoordinates> {
        if !self.columns.rigid.is_empty() {
            return None;
        }
        let norms: Vec<Complex<Ball>> =
            self.pairs.iter().zip(self.applied).map(|(pair, applied)| norm(self.pencil, pair.s, applied)).collect();
        let scale: Vec<f64> = self.columns.factors.iter().map(|factor| power_of_two_below(factor.abs())).collect();
        let excited = |seen: &[Complex<Ball>]| self.coordinates_of(seen, &norms, &scale);
        let sees = |list: &Vec<(CoordinateId, Number)>| {
            let row: Vec<(usize, Ball)> = list.iter().map(|(i, value)| (i.index(), value.to_ball())).collect();
            (!row.is_empty()).then(|| self.pairs.iter().map(|pair| row_product(pair, &row)).collect::<Vec<_>>())
        };
        let powers = |b: &[Vec<(CoordinateId, Number)>; 3]| {
            [0, 1, 2].map(|power: usize| sees(&b[power]).map(|seen| excited(&seen)))
        };
        let inputs: Vec<_> = system.inputs.iter().map(|input| powers(&input.b)).collect();
        let start = excited(&self.seen_of_start(system));
        let coupling = self.coupling(&scale);
        let known = |list: &[Complex<Ball>]| list.iter().all(|z| z.re.is_finite() && z.im.is_finite());
        let is_known = inputs.iter().flatten().flatten().all(|list| known(list)) && known(&start);
        (is_known && coupling.is_finite()).then(|| PoleCoordinates {
            pairs: self.pairs.to_vec(),
            cancellation: self.cancellation(&norms),
            norms,
            scale,
            inputs,
            start,
            coupling,
        })
    }

    /// (1 + F)^-1 Lambda^-1 of what the columns see, in scaled coordinates.
    fn coordinates_of(&self, seen: &[Complex<Ball>], norms: &[Complex<Ball>], scale: &[f64]) -> Vec<Complex<Ball>> {
        let amplitudes: Vec<Complex<Ball>> = seen.iter().zip(norms).map(|(&b, &norm)| b / norm).collect();
        let rest = self.rest_by_f(&amplitudes);
        let place = |(j, amplitude): (usize, &Complex<Ball>)| {
            let inverse = 1.0 / scale[j];
            let scaled = |x: Ball| Ball::new(x.mid.scale(inverse), (x.rad + rest[j]) * inverse * UP);
            // Of a real pole everything is real.
            let im = if self.pairs[j].is_real() { Ball::ZERO } else { scaled(amplitude.im) };
            Complex::new(scaled(amplitude.re), im)
        };
        amplitudes.iter().enumerate().map(place).collect()
    }

    /// The products of the columns with C q + M q' and M q at the start, x_j . (C q + M q') + s_j x_j . M q.
    fn seen_of_start(&self, system: &LinearSystem) -> Vec<Complex<Ball>> {
        if system.initial.is_empty() {
            return vec![Complex::ZERO; self.pairs.len()];
        }
        let n = system.n();
        let (mut q, mut v) = (vec![Ball::ZERO; n], vec![Ball::ZERO; n]);
        for (i, displacement, velocity) in &system.initial {
            q[i.index()] = displacement.to_ball();
            v[i.index()] = velocity.to_ball();
        }
        let (m, c) = (Squares::of_form(&system.m), Squares::of_form(&system.c));
        let momentum: Vec<Ball> = c.image(&q).into_iter().zip(m.image(&v)).map(|(a, b)| a + b).collect();
        let (row, of_rates) = (sparse(&momentum), sparse(&m.image(&q)));
        let of = |pair: &Pair| row_product(pair, &row) + pair.s.to_ball() * row_product(pair, &of_rates);
        self.pairs.iter().map(of).collect()
    }

    /// The largest (x* |K| x + |s|^2 x* M x) / |s Lambda|, in binary64.
    fn cancellation(&self, norms: &[Complex<Ball>]) -> f64 {
        let energy = |squares: &Squares<Precise>, x: &dyn Fn(usize) -> Complex<f64>| -> f64 {
            let of = |t: usize| {
                let (indices, factors) = squares.row(t);
                let stretch = indices
                    .iter()
                    .zip(factors)
                    .fold(Complex::ZERO, |sum: Complex<f64>, (&i, a)| sum + x(i as usize).scale(a.to_f64()));
                squares.weights[t].to_f64().abs() * (stretch.re * stretch.re + stretch.im * stretch.im)
            };
            (0..squares.len()).map(of).sum()
        };
        let of = |(pair, norm): (&Pair, &Complex<Ball>)| {
            let size = pair.s.to_f64().abs();
            let x = |i: usize| pair.x.entry(i).to_f64();
            let energy = energy(&self.pencil.k, &x) + size * size * energy(&self.pencil.m, &x);
            energy / (size * Complex::new(norm.re.to_f64(), norm.im.to_f64()).abs())
        };
        self.pairs.iter().zip(norms).map(of).fold(0.0, larger)
    }

    /// The 2-norm is at most the geometric mean of the largest row sum and the largest column sum. T couples a coordinate with
    /// the others and with their conjugates: by |T_ij| + |T_ij'|, the latter of which is |T_i'j|, so that a real i counts twice
    /// in a column. The scales g_j differ from the columns' own factors by less than two.
    fn coupling(&self, scale: &[f64]) -> f64 {
        let rows = self.t.times(&vec![1.0; self.columns.list.len()]);
        let largest_row = rows.iter().copied().fold(0.0, larger);
        let ratios = || self.columns.factors.iter().zip(scale).map(|(factor, g)| factor.abs() / g);
        let spread = ratios().fold(0.0, larger) / ratios().fold(f64::INFINITY, f64::min);
        (2.0 * largest_row * self.t.largest_column()).sqrt() * spread * UP * UP
    }
}

fn sparse(x: &[Ball]) -> Vec<(usize, Ball)> {
    x.iter().copied().enumerate().filter(|(_, x)| !x.is_zero()).collect()
}

/// The sign and the exponent of a normal number alone; 1 of any other.
pub(in crate::analysis) fn power_of_two_below(x: f64) -> f64 {
    // The exponent alone; the factors of columns are normal numbers.
    let power = f64::from_bits(x.to_bits() & f64::INFINITY.to_bits());
    if power.is_normal() { power } else { 1.0 }
}
