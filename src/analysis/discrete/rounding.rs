//! A bound of the effect of the target's rounding on the outputs. In: the cells. Out: a bound that grows with the
//! number of steps, relative to the sum of the largest contributions of the cells to an output. See
//! docs/method/emit.md.
//!
//! A step of a cell computes F w + G u with an error e, |e| <= rho unit max(|w|, |w'|), in a norm in which |F^j| <= r^j; so after N
//! steps the error is at most rho unit (1 + r + ... + r^(N-1)) max |w|. A pair of complex poles has such a norm, the modulus of
//! its modal coordinate; for other cells the powers of F are bounded by squaring.

use crate::analysis::discrete::cell::{Cell, Form, Operand};
use crate::analysis::discrete::lift::{Decay, Lift};
use crate::analysis::discrete::pieces::Spread;
use crate::analysis::discrete::precision::Precision;
use crate::base::{Dd, larger};
use crate::kernel::dense::Matrix;
use crate::kernel::dense::enclosure::norm_bound;

/// A bound of the relative error of any output after N steps.
#[derive(Clone, Debug, PartialEq)]
pub struct Rounding {
    /// Rounding error of one sum of an output.
    output: f64,
    /// For each cell the error of one step, and bounds of sum |F^j| over 2^i steps.
    cells: Vec<(f64, Vec<f64>)>,
}

/// Bounds are stored for up to 2^40 steps.
const DOUBLINGS: usize = 40;

impl Rounding {
    /// The bound after `steps` steps: |emitted - exact| is at most this times the sum of the largest contributions that
    /// the cells and the inputs have made to the output.
    pub fn error_after(&self, steps: u64) -> f64 {
        let doublings = (64 - steps.leading_zeros()) as usize;
        let worst = self.cells.iter().map(|(step, sums)| step * sums[doublings.min(DOUBLINGS)]);
        self.output + worst.fold(0.0, larger)
    }
}

/// The bound for these cells. `spreads`: the pieces of the polynomials, which are the first of the cells.
pub fn rounding(cells: &[Cell], spreads: &[Vec<Spread>], precision: Precision) -> Rounding {
    let unit = precision.unit();
    // Coefficient, product and sum for each input; a factor of one causes no rounding.
    let term = |&(_, g): &(Operand, f64)| if g.abs() == 1.0 { 1.0 } else { 3.0 };
    let of_state = |terms: &Vec<(Operand, f64)>| terms.iter().map(term).sum::<f64>();
    let inputs = |cell: &Cell| cell.input.iter().map(of_state).fold(0.0, f64::max);
    let bounds = cells.iter().enumerate().map(|(i, cell)| {
        if let Some(spread) = spreads.get(i).filter(|spread| !spread.is_empty()) {
            return ((cell.size() as f64 + 2.0) * unit, polynomial(spread));
        }
        let (step, sums) = match &cell.form {
            // Coefficient and product of the state's own term, and its sum.
            Form::Keep(r) => (3.0 + inputs(cell), powers(&Matrix::filled(1, 1, *r))),
            Form::Lose(d) => (1.0 + 3.0 * d.abs() + inputs(cell), powers(&Matrix::filled(1, 1, 1.0 - d))),
            Form::Pair(lift) => pair(lift, [0, 1].map(|i| cell.input.get(i).map_or(0.0, of_state))),
            Form::Dense { turned, rows: e } => {
                let n = e.len();
                let own = if *turned { -1.0 } else { 1.0 };
                let f = Matrix::from_fn(n, n, |i, j| e[i][j] + if i == j { own } else { 0.0 });
                let size = norm_bound(n, n, |i, j| e[i][j].abs());
                (1.0 + (n as f64 + 2.0) * size + inputs(cell), powers(&f))
            }
        };
        (step * unit * 1.001, sums)
    });
    let terms = cells.iter().map(|cell| cell.size()).sum::<usize>();
    Rounding { output: (terms as f64 + 4.0) * unit, cells: bounds.collect() }
}

/// The bound for a polynomial whose states are set at every knot: m steps after a knot, a state has an error of m
/// rounding errors of the sum of its terms' magnitudes, and the resulting error at the end of the piece is at most m
/// rounding errors of the sum of all terms there.
fn polynomial(spread: &[Spread]) -> Vec<f64> {
    let after = |steps: f64| spread.iter().map(|s| (1.0 + s.steps.min(steps)) * s.terms).fold(0.0, f64::max);
    (0..=DOUBLINGS).map(|i| after(2f64.powi(i as i32))).collect()
}

/// Bounds in the modulus of the modal coordinate zeta = k x + mu v if the poles are complex and well separated,
/// otherwise in the Euclidean norm.
fn pair(lift: &Lift, inputs: [f64; 2]) -> (f64, Vec<f64>) {
    let (keep, damped) = match lift.decay {
        Decay::Lose(c) => (1.0 - c, if c == 0.0 { 0.0 } else { 1.0 + 2.0 * c.abs() }),
        Decay::Keep(r) => (r, 2.0 * r.abs()),
    };
    let (k, p) = (lift.k.abs(), lift.p.abs());
    // L = [1 - p k, p keep; -k, keep]: mu = 1 - p k - lambda.
    let half = (1.0 - k * p + keep) / 2.0;
    let imaginary = (keep - half * half).max(0.0).sqrt();
    let real = 1.0 - p * k - half;
    let mu = (real * real + imaginary * imaginary).sqrt();
    // For v: the damped term, the sums with inputs and with k x, and that coefficient and product; for x: coefficient,
    // product and sum, and inputs.
    let of_x = k * (1.0 + inputs[0]) + 2.0 * mu * k;
    let of_v = 2.0 * k * p + mu * (damped + 1.0 + inputs[1]);
    if imaginary > 0.05 * mu && k > 0.0 {
        // The largest x and v for |zeta| = 1, as if inputs kept both that large.
        let step = of_x * mu / (imaginary * k) + of_v / imaginary;
        let r = keep.sqrt();
        let sums = (0..=DOUBLINGS).map(|i| geometric(r, 2f64.powi(i as i32)));
        return (step, sums.collect());
    }
    let f = lift.matrix().map(|x: Dd| x.hi.abs() * x.hi.signum());
    (2.0 * p + 1.0 + inputs[0] + damped + 1.0 + inputs[1] + 2.0 * k, powers(&f))
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
        // The norm is rounded up by the rounding errors of squaring.
        let norm = norm_bound(n, n, |i, j| power[(i, j)].abs()) * (1.0 + 1e-12 * (i + 1) as f64);
        sums.push(sums[i] * (1.0 + norm));
        power = Matrix::from_fn(n, n, |i, j| (0..n).map(|k| power[(i, k)] * power[(k, j)]).sum());
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::discrete::lift::lift;
    use crate::analysis::discrete::turn::turn;

    fn cell(form: Form, size: usize) -> Cell {
        let none = || vec![Vec::new(); size];
        let (input, output) = (none(), vec![Vec::new(); size]);
        Cell { name: String::new(), form, input, output, to: vec![], back: vec![], start: vec![1.0; size] }
    }

    /// One step with errors in units of the roundoff: the states after it, and the largest error of each, from
    /// coefficients, products and sums.
    fn step(form: &Form, w: &[f64]) -> (Vec<f64>, Vec<f64>) {
        match form {
            Form::Keep(r) => (vec![r * w[0]], vec![2.0 * (r * w[0]).abs()]),
            Form::Lose(d) => (vec![w[0] - d * w[0]], vec![2.0 * (d * w[0]).abs() + (w[0] - d * w[0]).abs()]),
            Form::Dense { rows, .. } => {
                let size = |row: &Vec<f64>| row.iter().zip(w).map(|(e, w)| (e * w).abs()).sum::<f64>();
                let change = |row: &Vec<f64>| row.iter().zip(w).map(|(e, w)| e * w).sum::<f64>();
                let next: Vec<f64> = rows.iter().zip(w).map(|(row, w)| w + change(row)).collect();
                let of = |(row, next): (&Vec<f64>, &f64)| (1.0 + w.len() as f64) * size(row) + next.abs();
                (next.clone(), rows.iter().zip(&next).map(of).collect())
            }
            Form::Pair(lift) => {
                let (x, v) = (w[0], w[1]);
                let (kept, lost) = match lift.decay {
                    Decay::Lose(c) => (v - c * v, 2.0 * (c * v).abs() + (v - c * v).abs()),
                    Decay::Keep(r) => (r * v, 2.0 * (r * v).abs()),
                };
                let sign = if lift.turned { -1.0 } else { 1.0 };
                let next = kept - lift.k * x;
                let in_v = lost + 2.0 * (lift.k * x).abs() + next.abs();
                let moved = x + lift.p * next;
                let in_x = 2.0 * (lift.p * next).abs() + moved.abs();
                // The error of v reaches x in the same step.
                (vec![sign * moved, sign * next], vec![in_x + lift.p * in_v, in_v])
            }
        }
    }

    /// The error of the first state after `steps` steps if all rounding errors conspire, in units of the roundoff and
    /// of the largest magnitude of the state.
    fn worst_case(form: &Form, start: &[f64], steps: usize) -> f64 {
        let n = start.len();
        let unit = |j: usize| (0..n).map(|i| f64::from(u8::from(i == j))).collect::<Vec<f64>>();
        let columns: Vec<Vec<f64>> = (0..n).map(|j| step(form, &unit(j)).0).collect();
        let mut states = vec![start.to_vec()];
        let mut errors = Vec::new();
        for _ in 0..steps {
            let (next, error) = step(form, &states[states.len() - 1]);
            states.push(next);
            errors.push(error);
        }
        // As if an input kept the motion at its largest magnitude.
        let error: Vec<f64> = (0..n).map(|i| errors.iter().map(|error| error[i]).fold(0.0, f64::max)).collect();
        // The effect of a change of the states before the last steps on the first state at the end.
        let mut felt = unit(0);
        let mut total = 0.0;
        for _ in 0..steps {
            total += felt.iter().zip(&error).map(|(a, b)| (a * b).abs()).sum::<f64>();
            felt = columns.iter().map(|column| column.iter().zip(&felt).map(|(f, g)| f * g).sum()).collect();
        }
        total / states.iter().map(|w| w[0].abs()).fold(0.0, f64::max)
    }

    /// Conspiring rounding errors stay below the bound, and come near it: oscillators without and with damping, turning
    /// by little and by more than a quarter, critical ones, single states, a dense step.
    #[test]
    fn the_bound_exceeds_the_worst_roundings_but_not_by_far() {
        let mut forms: Vec<(Form, Vec<f64>)> = Vec::new();
        let oscillators = [(400.0, 0.0), (400.0, 2.0), (1e4, 0.0), (4e4, 3.0), (9e4, 0.0), (1.0, 0.0), (4e4, 100.0)];
        for (k, c) in oscillators.into_iter().chain([(1e4, 200.0), (100.0, 20.0)]) {
            let a = Matrix::from_fn(2, 2, |i, j| Dd::from([[0.0, 1.0], [-k, -c]][i][j]));
            let turn = turn(&a.map(|x| x * 0.01), None).expect("in range");
            let lifted = lift(&turn, None, Precision::Double).expect("a form");
            forms.push((Form::Pair(lifted.lift), vec![1.0, 0.3]));
        }
        forms.extend([(Form::Keep(0.3), vec![1.0]), (Form::Lose(1e-4), vec![1.0]), (Form::Lose(0.0), vec![1.0])]);
        let turn = vec![vec![0.1f64.cos() - 1.0, 0.1f64.sin()], vec![-0.1f64.sin(), 0.1f64.cos() - 1.0]];
        forms.push((Form::Dense { turned: false, rows: turn }, vec![1.0, 0.0]));
        let mut ratios = Vec::new();
        for (form, start) in &forms {
            for steps in [1023, 65535] {
                let bound = rounding(&[cell(form.clone(), start.len())], &[], Precision::Double);
                let bound = (bound.error_after(steps) - bound.output) / Precision::Double.unit();
                let worst = worst_case(form, start, steps as usize);
                let over = bound / worst;
                assert!((1.0..100.0).contains(&over), "{form:?}, {steps}: {bound:e} for {worst:e}");
                ratios.push(over);
            }
        }
        ratios.sort_by(f64::total_cmp);
        assert!(ratios[ratios.len() / 2] < 15.0, "{ratios:?}");
    }
}
