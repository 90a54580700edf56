//! What rounding in the target can do to the outputs at most. In: the cells. Out: a bound that grows with the number of
//! steps, relative to the sum of the largest contributions of the cells to an output. Clause: spec.md, "Simulation code".
//!
//! A step of a cell computes F w + G u with an error e, |e| <= rho unit max(|w|, |w'|), in a norm in which |F^j| <= r^j; so after N
//! steps the error is at most rho unit (1 + r + ... + r^(N-1)) max |w|. A pair of complex poles has such a norm, the modulus of
//! its modal coordinate; for other cells the powers of F are bounded by squaring.

use crate::analysis::discrete::cell::{Cell, Form};
use crate::analysis::discrete::lift::{Decay, Lift};
use crate::analysis::discrete::precision::Precision;
use crate::analysis::numeric::dense::Matrix;
use crate::analysis::numeric::enclosure::norm_bound;
use crate::base::Dd;

/// A bound of the relative error of any output after N steps.
#[derive(Clone, Debug, PartialEq)]
pub struct Rounding {
    /// Of one sum of an output.
    output: f64,
    /// For each cell: what one step adds, and the bounds of sum |F^j| over 2^i steps.
    cells: Vec<(f64, Vec<f64>)>,
}

/// Bounds are kept up to 2^40 steps.
const DOUBLINGS: usize = 40;

impl Rounding {
    /// After so many steps: |emitted - exact| <= this times the sum of the largest sizes that the cells' and the inputs'
    /// contributions to the output have had.
    pub fn after(&self, steps: u64) -> f64 {
        let doublings = (64 - steps.leading_zeros()) as usize;
        let worst = self.cells.iter().map(|(step, sums)| step * sums[doublings.min(DOUBLINGS)]);
        self.output + worst.fold(0.0, f64::max)
    }
}

/// The bound for these cells.
pub fn rounding(cells: &[Cell], precision: Precision) -> Rounding {
    let unit = precision.unit();
    let inputs = |cell: &Cell| cell.input.iter().map(Vec::len).max().unwrap_or(0) as f64;
    let bounds = cells.iter().map(|cell| {
        let (step, sums) = match &cell.form {
            // Coefficient, product and sums of each term.
            Form::Keep(r) => (2.0 * (3.0 + inputs(cell)), powers(&Matrix::filled(1, 1, *r))),
            Form::Lose(d) => (2.0 * (3.0 + inputs(cell)), powers(&Matrix::filled(1, 1, 1.0 - d))),
            Form::Pair(lift) => pair(lift, inputs(cell)),
            Form::Dense(e) => {
                let n = e.len();
                let f = Matrix::from_fn(n, n, |i, j| e[i][j] + if i == j { 1.0 } else { 0.0 });
                let size = norm_bound(n, n, |i, j| e[i][j].abs());
                (2.0 * (n as f64 + 3.0 + inputs(cell)) * (1.0 + size), powers(&f))
            }
        };
        (step * unit, sums)
    });
    let terms = cells.iter().map(|cell| cell.size()).sum::<usize>();
    Rounding { output: (terms as f64 + 4.0) * unit, cells: bounds.collect() }
}

/// In the modulus of the modal coordinate zeta = k x + mu v, where its poles are complex and apart; in the plain norm else.
fn pair(lift: &Lift, inputs: f64) -> (f64, Vec<f64>) {
    let keep = match lift.decay {
        Decay::Lose(c) => 1.0 - c,
        Decay::Keep(r) => r,
    };
    let (k, p) = (lift.k.abs(), lift.p.abs());
    // L = [1 - p k, p keep; -k, keep]: mu = 1 - p k - lambda.
    let half = (1.0 - k * p + keep) / 2.0;
    let imaginary = (keep - half * half).max(0.0).sqrt();
    let real = 1.0 - p * k - half;
    let mu = (real * real + imaginary * imaginary).sqrt();
    let counted = 4.0 + inputs;
    if imaginary > 0.05 * mu && k > 0.0 {
        // Of |zeta| = 1: the largest v and x.
        let (v, x) = (1.0 / imaginary, mu / imaginary / k);
        let in_v = counted * (3.0 * v + 2.0 * k * x);
        let in_x = 2.0 * p * v + 2.0 * x;
        let step = k * in_x + mu * in_v;
        let r = keep.sqrt();
        let sums = (0..=DOUBLINGS).map(|i| geometric(r, 2f64.powi(i as i32)));
        return (step, sums.collect());
    }
    let f = lift.matrix().map(|x: Dd| x.hi.abs() * x.hi.signum());
    let size = norm_bound(2, 2, |i, j| f[(i, j)].abs());
    (counted * 4.0 * (1.0 + size + p + k), powers(&f))
}

/// 1 + r + ... + r^(n-1)
fn geometric(r: f64, n: f64) -> f64 {
    if r >= 1.0 { n } else { n.min(1.0 / (1.0 - r)) }
}

/// Bounds of sum |F^j| over 2^i steps: S(2 m) <= S(m) (1 + |F^m|).
fn powers(f: &Matrix<f64>) -> Vec<f64> {
    let n = f.rows();
    let mut power = f.clone();
    let mut sums = vec![1.0f64.max(norm_bound(n, n, |i, j| if i == j { 1.0 } else { 0.0 }))];
    for i in 0..DOUBLINGS {
        // The norm is rounded up by what squaring has lost.
        let norm = norm_bound(n, n, |i, j| power[(i, j)].abs()) * (1.0 + 1e-12 * (i + 1) as f64);
        sums.push(sums[i] * (1.0 + norm));
        power = Matrix::from_fn(n, n, |i, j| (0..n).map(|k| power[(i, k)] * power[(k, j)]).sum());
    }
    sums
}
