//! The transfer function at a frequency at which Q(s) is exactly singular, in rational arithmetic: at rest (s = 0) with
//! rigid motions, and at an undamped natural frequency that is a rational number of rad/s.
//!
//! With N the null vectors of Q and G = N^T M N, the input b excites the share N G^-1 N^T b: if an output sees it, H is
//! infinite; if it does not (a pole cancelled by a zero), H is the sum of the other motions, the solution of Q x = b -
//! M N G^-1 N^T b with N^T M x = 0. See docs/method/transfer.md.

use crate::analysis::transfer::{Disc, Frequency, Gain};
use crate::base::{Number, Rational};
use crate::kernel::dense::echelon::{null_vectors, solution};
use crate::system::{CoordinateId, LinearSystem};

/// For more coordinates than this, exact elimination takes too long.
const MOST_COORDINATES: usize = 40;

type Matrix = Vec<Vec<Rational>>;

/// Replaces unknown gains by exact ones if all numbers needed are rational.
pub(in crate::analysis) fn solve(
    system: &LinearSystem,
    frequency: &Frequency,
    inputs: &[usize],
    outputs: &[usize],
    gains: &mut [Vec<Gain>],
) {
    let Some(singular) = Singular::of(system, frequency) else { return };
    for (&input, gains) in inputs.iter().zip(gains) {
        let Some(b) = column(&system.inputs[input].b, &singular.square, system.n()) else { continue };
        let Some((share, x)) = singular.answer(&b) else { continue };
        for (&output, gain) in outputs.iter().zip(gains) {
            let output = &system.outputs[output];
            let Some(p) = column(&output.p, &singular.square, system.n()) else { continue };
            let Some(d) = feed_through(output, input, &singular.square) else { continue };
            *gain = if dot(&p, &share).is_zero() {
                let value = &dot(&p, &x) + &d;
                Gain::Finite(Disc::of(crate::kernel::complex::Complex::real(value.to_ball())))
            } else {
                Gain::Infinite
            };
        }
    }
}

/// Q at a frequency, with its null vectors.
struct Singular {
    /// s^2
    square: Rational,
    q: Matrix,
    m: Matrix,
    null: Matrix,
}

impl Singular {
    /// `None` unless Q is real, rational and singular.
    fn of(system: &LinearSystem, frequency: &Frequency) -> Option<Singular> {
        let n = system.n();
        let omega = frequency.exact()?.exact()?.clone();
        if n > MOST_COORDINATES || !(omega.is_zero() || system.c.is_empty()) {
            return None;
        }
        let square = -&(&omega * &omega);
        let (m, mut q) = (system.m.rational_entries(n)?, system.k.rational_entries(n)?);
        for (q, m) in q.iter_mut().flatten().zip(m.iter().flatten()) {
            *q = &*q + &(&square * m);
        }
        let null = null_vectors(&q);
        (!null.is_empty()).then_some(Singular { square, q, m, null })
    }

    /// The share N G^-1 N^T b of the null motions, and the solution for the rest of b.
    fn answer(&self, b: &[Rational]) -> Option<(Vec<Rational>, Vec<Rational>)> {
        let n = b.len();
        let forces: Matrix = self.null.iter().map(|v| multiply(&self.m, v)).collect();
        let amplitudes = |b: &[Rational], along: &Matrix| -> Option<Vec<Rational>> {
            let g: Matrix = self.null.iter().map(|v| forces.iter().map(|f| dot(v, f)).collect()).collect();
            let (amplitudes, only) = solution(&g, &along.iter().map(|v| dot(v, b)).collect::<Vec<_>>())?;
            only.then_some(amplitudes)
        };
        let share = combine(&self.null, &amplitudes(b, &self.null)?, n);
        let pushed = multiply(&self.m, &share);
        let rest: Vec<Rational> = b.iter().zip(&pushed).map(|(b, f)| b - f).collect();
        let (x, _) = solution(&self.q, &rest)?;
        let along = combine(&self.null, &amplitudes(&x, &forces)?, n);
        Some((share, x.iter().zip(&along).map(|(x, v)| x - v).collect()))
    }
}

/// b0 + s^2 b2 as a dense vector; `None` if it is not real and rational (s b1 is imaginary unless s = 0).
fn column(b: &[Vec<(CoordinateId, Number)>; 3], square: &Rational, n: usize) -> Option<Vec<Rational>> {
    if !(square.is_zero() || b[1].is_empty()) {
        return None;
    }
    let mut dense = vec![Rational::ZERO; n];
    for (i, value) in &b[0] {
        dense[i.index()] = value.exact()?.clone();
    }
    for (i, value) in &b[2] {
        dense[i.index()] = &dense[i.index()] + &(square * value.exact()?);
    }
    Some(dense)
}

fn feed_through(output: &crate::system::Output, input: usize, square: &Rational) -> Option<Rational> {
    let of = |power: usize| -> Option<Rational> {
        let mut sum = Rational::ZERO;
        for (_, value) in output.d[power].iter().filter(|(u, _)| *u as usize == input) {
            sum = &sum + value.exact()?;
        }
        Some(sum)
    };
    if !(square.is_zero() || of(1)?.is_zero()) {
        return None;
    }
    Some(&of(0)? + &(square * &of(2)?))
}

fn dot(a: &[Rational], b: &[Rational]) -> Rational {
    a.iter().zip(b).fold(Rational::ZERO, |sum, (a, b)| &sum + &(a * b))
}

fn multiply(matrix: &Matrix, x: &[Rational]) -> Vec<Rational> {
    matrix.iter().map(|row| dot(row, x)).collect()
}

fn combine(vectors: &Matrix, amplitudes: &[Rational], n: usize) -> Vec<Rational> {
    (0..n).map(|i| vectors.iter().zip(amplitudes).fold(Rational::ZERO, |sum, (v, a)| &sum + &(&v[i] * a))).collect()
}
