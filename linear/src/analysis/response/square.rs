//! The mean square of one output, without following its course: between two events the integral of y^2 is z^T Q z with
//! Q(t) = int_0^t exp(A s)^T c^T c exp(A s) ds, and Q doubles its time as exp(A t) does: Q(2 t) = Q(t) + exp(A t)^T
//! Q(t) exp(A t). In: a run, an output, a time. Out: a ball. See docs/method/measures.md#peak-and-rms.

use super::course::{Outcome, stretches};
use super::exponential::{Exponential, Generator, growth};
use super::{Run, UNIT, UP, length};
use crate::analysis::error::AnalysisError;
use crate::base::{Ball, Dd, Number};
use crate::kernel::dense::enclosure::norm_bound;
use crate::kernel::dense::{Matrix, add_scaled};
use crate::system::{LinearSystem, Signal};
use std::rc::Rc;

/// Number of integrals that are cached: tables and chirps are divided into equal pieces.
const KEPT: usize = 8;
/// Terms of the output's row at the start, for |A h| <= 1/2: the remainder is (1/2)^26 / 26! < 1e-34.
const TERMS: usize = 26;

/// The integral of y^2 over a time as a quadratic form of the state at its beginning.
struct Square {
    time: Number,
    states: Vec<usize>,
    q: Matrix<Dd>,
    /// Bounds of the error of q, and of its magnitude.
    error: f64,
    size: f64,
    /// Bounds of the output's row, and of the growth of a state, anywhere in the time.
    row: f64,
    growth: f64,
}

/// The mean square of an output from 0 to `until`; `None` if numbers leave their range.
pub fn mean_square(
    system: &LinearSystem,
    drives: &[Vec<Signal>],
    output: usize,
    until: &Number,
) -> Result<(Outcome, Option<Ball>), AnalysisError> {
    let mut known: Vec<Rc<Square>> = Vec::new();
    let mut sum = Ball::ZERO;
    // The integral of the square of the error that the sources' approximations cause in the output.
    let mut apart = 0.0;
    let followed = stretches(system, drives, output, until, &mut |run, to| {
        let square = ready(&mut known, run, output, to)?;
        sum = sum + square.of(run);
        let time = (to - &run.now).to_f64() * UP;
        let late = square.row * run.approximation_errors() * time * square.growth + run.feed_through_error(output);
        apart += late * late * time * UP;
        run.advance(to)?;
        Ok(Outcome::ToTheEnd)
    })?;
    if followed != Outcome::ToTheEnd || !sum.is_finite() {
        return Ok((followed, None));
    }
    // | |y| - |y~| | <= |y - y~| in the mean, so the squares differ by at most 2 |y~| d + d^2.
    let off = if apart > 0.0 { (2.0 * (sum.magnitude() * apart).sqrt() + apart) * UP } else { 0.0 };
    let mean = sum.widen(off) / until.to_ball();
    // A square is not negative.
    let mean = if mean.mid.hi < 0.0 { Ball::new(Dd::ZERO, mean.rad) } else { mean };
    Ok((followed, Some(mean)))
}

fn ready(known: &mut Vec<Rc<Square>>, run: &Run, output: usize, to: &Number) -> Result<Rc<Square>, AnalysisError> {
    let (time, states) = (to - &run.now, run.states_on());
    if let Some(square) = known.iter().find(|square| square.time == time && square.states == states) {
        return Ok(square.clone());
    }
    let square =
        Square::enclose_over(run, output, time, states).ok_or_else(|| AnalysisError::out_of_range(run.system))?;
    if known.len() == KEPT {
        known.remove(0);
    }
    let square = Rc::new(square);
    known.push(square.clone());
    Ok(square)
}

impl Square {
    fn enclose_over(run: &Run, output: usize, time: Number, states: Vec<usize>) -> Option<Square> {
        let generator = run.space.generator(&states);
        let row: Vec<Ball> = states.iter().map(|&i| run.outputs[(output, i)]).collect();
        let t = time.to_ball();
        let parts = generator.parts(t)?;
        let (mut q, mut error) = start(&generator, &row, parts.first);
        let mut power = parts.power;
        for k in 1..=parts.squarings {
            error = double(&mut q, error, &power);
            power = generator.square_of(&power, t, parts.squarings - k);
        }
        let size = (size_of(&q) + error) * UP;
        let row =
            (length(&row.iter().map(|c| c.mid).collect::<Vec<Dd>>()) + row.iter().map(|c| c.rad).sum::<f64>()) * UP;
        let growth = growth(generator.rate.max(0.0) * t.magnitude());
        size.is_finite().then_some(Square { time, states, q, error, size, row, growth })
    }

    /// z^T Q z of the present state.
    fn of(&self, run: &Run) -> Ball {
        let z: Vec<Dd> = self.states.iter().map(|&i| run.z[i]).collect();
        self.of_state(&z, (run.trail.error + run.source_error) * UP)
    }

    /// z^T Q z of a state known to within `off` in the 2-norm.
    fn of_state(&self, z: &[Dd], off: f64) -> Ball {
        let n = z.len();
        let mut image = vec![Dd::ZERO; n];
        for (column, &x) in z.iter().enumerate() {
            add_scaled(&mut image, x, self.q.column(column));
        }
        let sum = z.iter().zip(&image).fold(Dd::ZERO, |sum, (&a, &b)| sum + a * b);
        let long = length(z);
        let rounding = (2.0 * n as f64 + 8.0) * UNIT * self.size_of_sums() * long * long;
        let state = (2.0 * length(&image) + 2.0 * self.error * long + self.size * off) * off;
        Ball::new(sum, (self.error * long * long + rounding + state) * UP)
    }

    /// A bound of the 2-norm of |Q|.
    fn size_of_sums(&self) -> f64 {
        size_of(&self.q)
    }
}

fn size_of(q: &Matrix<Dd>) -> f64 {
    norm_bound(q.rows(), q.columns(), |i, j| q[(i, j)].hi.abs() * UP)
}

/// Q(h) = h sum r_j^T r_k / (j + k + 1), r_j = c A^j h^j / j!, and a bound of its error, for |A h| <= 1/2.
fn start(generator: &Generator, row: &[Ball], h: Ball) -> (Matrix<Dd>, f64) {
    let n = row.len();
    let mut rows: Vec<Vec<Dd>> = vec![row.iter().map(|c| c.mid).collect()];
    for j in 1..TERMS {
        let share = h.mid / Dd::from(j as f64);
        let next = (0..n).map(|k| {
            let products = rows[j - 1].iter().zip(generator.a.column(k));
            products.fold(Dd::ZERO, |sum, (&c, &a)| sum + c * a) * share
        });
        let next = next.collect();
        rows.push(next);
    }
    let mut q = Matrix::zeros(n, n);
    for (k, right) in rows.iter().enumerate() {
        let mut left = vec![Dd::ZERO; n];
        for (j, row) in rows.iter().enumerate() {
            add_scaled(&mut left, h.mid / Dd::from((j + k + 1) as f64), row);
        }
        for (column, &factor) in right.iter().enumerate() {
            add_scaled(q.column_mut(column), factor, &left);
        }
    }
    // All rows together, anywhere in the time: |c| e^(1/2), with errors from the radius of c, rounding (the j-th row is
    // rounded n + 6 times more than the one before, and sum j (1/2)^j / j! < 1), the uncertainty of A and h, and the
    // remainder.
    let long = length(&rows[0]) * UP;
    let radius = row.iter().map(|c| c.rad).sum::<f64>();
    let uncertain = 2.0 * (generator.error * h.magnitude() + generator.norm * h.rad);
    let off = (1.65 * radius + (long + radius) * ((n as f64 + 6.0) * UNIT + uncertain + 1e-34)) * UP;
    let most = 1.65 * (long + radius);
    // The time itself is uncertain by its radius.
    let sums = 2.8 * long * long * (2.0 * TERMS as f64 + 8.0) * UNIT;
    let error = h.magnitude() * (2.0 * most * off + off * off + sums) + h.rad * most * most;
    (q, error * UP)
}

/// Replaces Q by Q + F^T Q F; returns a bound of its error.
fn double(q: &mut Matrix<Dd>, error: f64, power: &Exponential) -> f64 {
    let n = q.rows();
    let image = power.f.transposed_times(&q.times(&power.f));
    let before = size_of(q);
    let rounding = (2.0 * n as f64 + 10.0) * UNIT * before * (1.0 + power.absolute_norm * power.absolute_norm);
    let computed = (power.norm + power.error) * UP;
    let carried = computed * computed * error;
    let applied = (before + error) * (2.0 * power.norm * power.error + power.error * power.error);
    *q = Matrix::from_fn(n, n, |i, j| q[(i, j)] + image[(i, j)]);
    (error + carried + applied + rounding) * UP
}

#[cfg(test)]
mod tests {
    use super::*;

    /// z^T Q z = 2 x^2 + 2 x y + 3 y^2 at (1, -2) is 10, and for states 1e-6 away in any direction it is in the ball, which is at most
    /// three times wider than that: the gradient is (0, -10).
    #[test]
    fn an_uncertain_state_is_in_the_square() {
        let q = Matrix::from_fn(2, 2, |i, j| Dd::from([[2.0, 1.0], [1.0, 3.0]][i][j]));
        let size = size_of(&q);
        let (time, states) = (Number::ONE, vec![0, 1]);
        let square = Square { time, states, q, error: 0.0, size, row: 1.0, growth: 1.0 };
        let of = |x: f64, y: f64, off: f64| square.of_state(&[Dd::from(x), Dd::from(y)], off);
        let wide = of(1.0, -2.0, 1e-6);
        assert!((wide.to_f64() - 10.0).abs() < 1e-14 && wide.rad < 3e-5, "{wide:?}");
        for (x, y) in [(0.0, 1e-6), (0.0, -1e-6), (1e-6, 0.0), (-1e-6, 0.0), (6e-7, -8e-7)] {
            let near = of(1.0 + x, -2.0 + y, 0.0);
            assert!((near - wide).mid.hi.abs() <= wide.rad, "{x} {y}: {near:?} {wide:?}");
        }
    }

    /// y = c e^(-2 t): Q(1/5) = c^2 (1 - e^(-4/5)) / 4. A row that is off by 1e-6 shows in the bound, which is at most
    /// ten times as large as necessary.
    #[test]
    fn an_uncertain_row_is_in_the_bound() {
        let generator = Generator { a: Matrix::fill_with(1, 1, Dd::from(-2.0)), error: 0.0, rate: -2.0, norm: 2.0 };
        let decay = Number::from(-4).checked_div(&Number::from(5)).and_then(|x| x.exp()).expect("a number");
        let truth = |c: f64| {
            let square = &Number::from(Ball::from(c * c)) * &(&Number::ONE - &decay);
            (&square / &Number::from(4)).to_ball()
        };
        for radius in [0.0, 1e-6] {
            let row = [Ball::new(Dd::ONE, radius)];
            let h = Ball::ONE / Ball::from(5.0);
            let (q, error) = start(&generator, &row, h);
            for c in [1.0 - radius, 1.0 + radius] {
                let off = (truth(c) - Ball::exact(q[(0, 0)])).mid.hi.abs();
                assert!(off <= error && error <= 10.0 * off.max(1e-28), "{radius}: {off:e} {error:e}");
            }
        }
    }
}
