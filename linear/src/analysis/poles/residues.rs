//! Transfer functions as sums over poles, with a bound of the error of these sums. In: the columns in which the poles
//! are certified, and the bounds of that proof. Out: for each pole its excitation by each input and its share in each
//! output. docs/method/transfer.md#sum-over-poles derives it:
//!
//! With Z^T L(s) Z = B (s - D + T), B = Lambda (1 + F), and b, p an input and an output in the columns of Z,
//!   p^T Q^-1 b = p^T (s - D)^-1 (1 + T (s - D)^-1)^-1 (1 + F)^-1 Lambda^-1 b.
//! T and F are as small as the residuals of the pairs, so Lambda^-1 b is the excitation by the input except for a
//! remainder w, and the sum over p_j b_j / (Lambda_j (s - s_j)) differs from H by at most sum |p_j| w_j / |s - s_j|.
//! The s_j are exact numbers here, not enclosures.

use crate::analysis::poles::disc_columns::{Columns, UP};
use crate::analysis::poles::discs::{Deviation, Perturbation};
use crate::analysis::poles::pencil::{Application, Pencil};
use crate::analysis::poles::refinement::Pair;
use crate::base::{Ball, Dd, Number, larger};
use crate::kernel::complex::Complex;
use crate::kernel::squares::Squares;
use crate::kernel::triple::Precise;
use crate::system::{CoordinateId, LinearSystem};

/// The excitation of each pole by inputs, and its share in outputs. The poles are approximate; one of each conjugate
/// pair.
#[derive(Clone, Debug)]
pub struct Residues {
    pub(in crate::analysis) poles: Vec<Complex<Dd>>,
    /// For each input, one entry per power of s.
    pub(in crate::analysis) inputs: Vec<[Option<Excited>; 3]>,
    /// For each output, one entry per power of s: p . x_j.
    pub(in crate::analysis) outputs: Vec<[Option<Vec<Complex<Ball>>>; 3]>,
}

/// The excitation of each pole by a power of an input.
#[derive(Clone, Debug)]
pub struct Excited {
    /// x_j . b / Lambda_j
    pub(in crate::analysis) amplitudes: Vec<Complex<Ball>>,
    /// A bound of the rest of x_j's amplitude at every frequency, and in a disc about each that reaches half way to the
    /// nearest pole. It holds for the conjugate as well.
    pub(in crate::analysis) rest: Vec<f64>,
}

/// The bounds of a proof of poles.
pub struct Proof<'a> {
    pub pencil: &'a Pencil<Precise>,
    pub pairs: &'a [Pair],
    pub applied: &'a [Application<Precise>],
    pub columns: &'a Columns,
    pub b: &'a Deviation,
    pub t: &'a Perturbation,
}

impl Proof<'_> {
    /// The residues of a system that is one part; `local` are its coordinates in the part. `None` if a pole may lie on
    /// the imaginary axis, or if a motion is free.
    pub fn residues(&self, system: &LinearSystem, local: &[u32]) -> Option<Residues> {
        let norms: Vec<Complex<Ball>> =
            self.pairs.iter().zip(self.applied).map(|(pair, applied)| norm(self.pencil, pair.s, applied)).collect();
        let sees = |list: &Vec<(CoordinateId, Number)>| {
            (!list.is_empty()).then(|| {
                let row: Vec<(usize, Ball)> =
                    list.iter().map(|(i, value)| (local[i.index()] as usize, value.to_ball())).collect();
                self.pairs.iter().map(|pair| row_product(pair, &row)).collect::<Vec<_>>()
            })
        };
        let outputs = system.outputs.iter().map(|output| [0, 1, 2].map(|power| sees(&output.p[power]))).collect();
        let slowest = self.near_axis()?;
        let mut inputs = Vec::with_capacity(system.inputs.len());
        for input in &system.inputs {
            let mut powers = [None, None, None];
            for (power, excited) in powers.iter_mut().enumerate() {
                let Some(seen) = sees(&input.b[power]) else { continue };
                *excited = Some(self.excitation(&seen, &norms, &slowest)?);
            }
            inputs.push(powers);
        }
        Some(Residues { poles: self.pairs.iter().map(|pair| pair.s).collect(), inputs, outputs })
    }

    /// For each column 2 / |re s_j|, which is at least 1 / |s - s_j| for s on the imaginary axis or half way from it to
    /// the nearest pole, and the largest row sum of |T_ij| times this.
    fn near_axis(&self) -> Option<(Vec<f64>, f64)> {
        if !self.columns.rigid.is_empty() {
            return None;
        }
        let n = self.columns.list.len();
        let mut nearness = vec![0.0; n];
        for (pair, &(at, conj)) in self.pairs.iter().zip(&self.columns.of_pair) {
            let bound = 2.0 / pair.s.re.to_f64().abs() * UP;
            (nearness[at], nearness[conj]) = (bound, bound);
        }
        let rows = self.t.times(&nearness);
        let largest = rows.iter().copied().fold(0.0, larger) * UP;
        (largest < 0.5).then_some((nearness, largest))
    }

    fn excitation(
        &self,
        seen: &[Complex<Ball>],
        norms: &[Complex<Ball>],
        (nearness, sigma): &(Vec<f64>, f64),
    ) -> Option<Excited> {
        let amplitudes: Vec<Complex<Ball>> = seen.iter().zip(norms).map(|(&b, &norm)| b / norm).collect();
        let (sizes, by_f) = self.by_f(&amplitudes);
        let near: Vec<f64> = (0..sizes.len()).map(|j| (sizes[j] + by_f[j]) * nearness[j] * UP).collect();
        let by_t = with_tail(self.t.times(&near), *sigma);
        let rest: Vec<f64> = (self.columns.of_pair.iter().zip(&self.columns.factors))
            .map(|(&(at, _), factor)| (by_f[at] + by_t[at]) * factor.abs() * UP + f64::MIN_POSITIVE)
            .collect();
        let known = rest.iter().all(|x| x.is_finite()) && amplitudes.iter().all(|z| z.magnitude().is_finite());
        known.then_some(Excited { amplitudes, rest })
    }

    /// Bounds of the amplitudes of all columns, and of what (1 + F)^-1 = 1 - F + F^2 - .. adds to them.
    fn by_f(&self, amplitudes: &[Complex<Ball>]) -> (Vec<f64>, Vec<f64>) {
        let mut sizes = vec![0.0; self.columns.list.len()];
        for (p, &(at, conj)) in self.columns.of_pair.iter().enumerate() {
            let size = amplitudes[p].magnitude() / self.columns.factors[p].abs() * UP;
            (sizes[at], sizes[conj]) = (size, size);
        }
        let by_f = with_tail(self.b.times(&sizes), self.b.theta);
        (sizes, by_f)
    }

    /// Bounds of what (1 + F)^-1 adds to the amplitude of each pair.
    pub(in crate::analysis::poles) fn rest_by_f(&self, amplitudes: &[Complex<Ball>]) -> Vec<f64> {
        let (_, by_f) = self.by_f(amplitudes);
        let of_pair = self.columns.of_pair.iter().zip(&self.columns.factors);
        of_pair.map(|(&(at, _), factor)| by_f[at] * factor.abs() * UP + f64::MIN_POSITIVE).collect()
    }
}

/// A bound of x + A x + A^2 x + .. from that of x, if the row sums of |A| are at most theta.
fn with_tail(first: Vec<f64>, theta: f64) -> Vec<f64> {
    let tail = first.iter().copied().fold(0.0, larger) * (theta / (1.0 - theta)) * UP;
    first.into_iter().map(|x| (x + tail) * UP).collect()
}

/// row . x
pub(in crate::analysis::poles) fn row_product(pair: &Pair, row: &[(usize, Ball)]) -> Complex<Ball> {
    row.iter().fold(Complex::ZERO, |sum, (i, a)| sum + pair.x.entry(*i).to_ball().scale(*a))
}

/// Lambda = x^T (2 s M + C) x.
pub(in crate::analysis::poles) fn norm(
    pencil: &Pencil<Precise>,
    s: Complex<Dd>,
    applied: &Application<Precise>,
) -> Complex<Ball> {
    let twice = s.to_ball().scale(Ball::from(2.0));
    twice * energy(&pencil.m, &applied.m_stretch) + energy(&pencil.c, &applied.c_stretch)
}

/// sum w t^2 in double-double, with a bound of the error: a few roundings for each term, and one rounding of the whole
/// for each sum.
fn energy(squares: &Squares<Precise>, stretches: &[Complex<Precise>]) -> Complex<Ball> {
    let (mut sum, mut size, mut doubt) = (Complex::<Dd>::ZERO, 0.0, f64::MIN_POSITIVE);
    for (w, t) in squares.weights.iter().zip(stretches) {
        let short = Complex::new(t.re.value.dd(), t.im.value.dd());
        sum = sum + (short * short).scale(w.value.dd());
        let (weight, length) = (w.value.hi().abs(), short.to_f64().abs());
        size += weight * length * length;
        let radius = t.re.radius + t.im.radius;
        doubt += w.radius * (length + radius) * (length + radius) + 2.0 * weight * (length + radius) * radius;
    }
    let lost = (2 * squares.len() + 32) as f64 * Dd::EPSILON * size;
    let around = |x: Dd| Ball::new(x, (lost + doubt) * UP);
    Complex::new(around(sum.re), around(sum.im))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::modes;
    use crate::analysis::modes::parts::Part;
    use crate::analysis::poles::companion::Basis;
    use crate::analysis::poles::discs::discs;
    use crate::analysis::poles::refinement::refine;
    use crate::analysis::poles::rigid::RigidMotions;
    use crate::analysis::test_systems::{blank, push};
    use crate::analysis::transfer::partial_fractions::PartialFractions;
    use crate::analysis::transfer::{Frequency, Transfer};

    /// Vectors and poles with errors of 1e-12 to 1e-6, each in its own way: the errors of their sums are within the
    /// bounds, which are as small as the errors of the pairs.
    #[test]
    fn sums_over_wrong_pairs_are_within_their_bounds() {
        let mut system = blank(4);
        for (i, k) in ["3.1", "1.7", "2.3", "0.9"].into_iter().enumerate() {
            push(&mut system.m, "1.3", i, None);
            push(&mut system.k, k, i, i.checked_sub(1));
        }
        push(&mut system.c, "0.37", 1, None);
        let local = [0, 1, 2, 3];
        let pencil = Pencil::of(&system, &Part::whole(&system), &local);
        let working = pencil.to_dd();
        let basis = Basis::of(&working, &modes(&system).expect("modes"), &RigidMotions::default());
        let starts = basis.spectrum().values();
        let right: Vec<Pair> =
            (0..).zip(&starts).map(|(seed, &start)| refine(&working, &basis, start, seed).expect("a pole")).collect();
        let transfer = Transfer::of(&system);
        let mut largest: f64 = 0.0;
        // With correct vectors and wrong poles, F stays small, and only T shows the error.
        for (slip, of_vectors) in [(0.0, 0.0), (1e-12, 1.0), (1e-9, 1.0), (1e-9, 0.0), (1e-6, 1.0)] {
            let mut pairs = right.clone();
            for (j, pair) in pairs.iter_mut().enumerate() {
                for i in 0..4 {
                    let by = Complex::new(i as f64 - 1.7 * j as f64, 0.3 + (i * j) as f64);
                    pair.x.add(i, by.scale(slip * of_vectors));
                }
                pair.s = pair.s + Complex::new(slip * 0.01, slip * 0.02 * j as f64).into();
            }
            let residues =
                discs(&pencil, &RigidMotions::default(), &pairs, 8, |proof| proof.residues(&system, &local)).1;
            // Nothing is proved about poles whose distance from the axis is comparable to the error.
            let Some(residues) = residues.flatten() else {
                assert!(slip > 1e-9, "{slip}");
                continue;
            };
            for (input, output) in [(0, 0), (0, 3), (2, 1)] {
                let sum = PartialFractions::of(&system, &residues, input, output).expect("finite");
                for omega in ["0.1", "0.6", "1.4", "2.1", "9"] {
                    let frequency = Frequency::radians(&Number::from(omega));
                    let truth = transfer.between(&frequency, &[input], &[output])[0][0].disc().expect("finite");
                    let found = sum.gain(&frequency).disc().expect("no pole is near");
                    let off = (found.value - truth.value).to_f64().abs();
                    assert!(off <= found.radius + truth.radius, "{slip} {input} {output} {omega}: {off:e} {found:?}");
                    assert!(found.radius < 1e5 * slip + 1e-25, "{slip} {input} {output} {omega}: {found:?}");
                    largest = largest.max(off / found.radius);
                }
            }
        }
        // Otherwise the test would compare nothing.
        assert!(largest > 1e-3, "{largest}");
    }
}
