//! Small dense matrices of balls: products, solutions and triangular factors with error bounds.

use crate::base::rounding::UNIT_SQUARED;
use crate::base::{Ball, Dd, Power, larger, two_to, up};
use crate::kernel::dense::Matrix;
use crate::kernel::dense::lu::inverse;
use crate::kernel::lanes::{Double, Lanes};
use crate::kernel::simd::{LANES, simd};

/// A bound of the 2-norm of |A|: the smaller of the Frobenius norm and sqrt(norm_1 norm_inf).
pub fn norm_bound(rows: usize, columns: usize, size: impl Fn(usize, usize) -> f64) -> f64 {
    let (mut squares, mut row_sums, mut largest_column) = (0.0, vec![0.0; rows], 0.0f64);
    for j in 0..columns {
        let mut column = 0.0;
        for (i, row) in row_sums.iter_mut().enumerate() {
            let x = size(i, j);
            squares += x * x;
            *row += x;
            column += x;
        }
        largest_column = larger(largest_column, column);
    }
    let largest_row = row_sums.iter().copied().fold(0.0, larger);
    // A thousand rows of sums in binary64 lose less than 1e-12.
    squares.sqrt().min((largest_row * largest_column).sqrt()) * up::THOUSANDS
}

impl Matrix<Ball> {
    pub fn none(rows: usize, columns: usize) -> Matrix<Ball> {
        Matrix::fill_with(rows, columns, Ball::ZERO)
    }

    pub fn mid(&self) -> Matrix<Dd> {
        self.map(|ball| ball.mid)
    }

    pub fn is_finite(&self) -> bool {
        (0..self.columns()).all(|j| self.column(j).iter().all(Ball::is_finite))
    }

    /// A bound of the 2-norm of the error of the midpoints.
    pub fn radius(&self) -> f64 {
        norm_bound(self.rows(), self.columns(), |i, j| self[(i, j)].rad)
    }
}

simd! {
    /// A B
    pub fn product(a: &Matrix<Ball>, b: &Matrix<Ball>) -> Matrix<Ball> {
        let mut c = Matrix::none(a.rows(), b.columns());
        for j in 0..b.columns() {
            for (k, &factor) in b.column(j).iter().enumerate() {
                if factor.is_zero() {
                    continue;
                }
                for (c, &a) in c.column_mut(j).iter_mut().zip(a.column(k)) {
                    *c = *c + a * factor;
                }
            }
        }
        c
    }
}

/// Balls in parallel lanes, column by column, each padded to whole vectors: the left factor of several products.
pub struct Panel {
    rows: usize,
    columns: usize,
    mid: Lanes,
    /// Bounds of the error of an entry, and of what its product with a number loses besides, over the magnitude of that number.
    off: Vec<f64>,
}

/// Bound of underflow in sums of products.
const TINY: f64 = 1e-290;

impl Panel {
    pub fn of(a: &Matrix<Ball>) -> Panel {
        let (rows, columns) = (a.rows(), a.columns());
        let room = rows.next_multiple_of(LANES);
        // See [`Double::plus_product`].
        let lost = (columns as f64 + 3.0).power(2) * UNIT_SQUARED;
        let (mut mid, mut off) = (Lanes::zeros(room * columns), vec![0.0; room * columns]);
        for j in 0..columns {
            for (i, entry) in a.column(j).iter().enumerate() {
                mid.set(j * room + i, entry.mid);
                off[j * room + i] = (entry.rad + entry.magnitude() * lost) * up::FEW;
            }
        }
        Panel { rows, columns, mid, off }
    }

    /// A B, where the numbers of B are exact.
    pub fn times(&self, b: &Matrix<f64>) -> Matrix<Ball> {
        let mut product = Matrix::none(self.rows, b.columns());
        times(self, b, &mut product);
        product
    }
}

simd! {
    fn times<V: Eight>(a: &Panel, b: &Matrix<f64>, product: &mut Matrix<Ball>) {
        let room = a.rows.next_multiple_of(LANES);
        for j in 0..b.columns() {
            for first in (0..a.rows).step_by(LANES) {
                let (mut sum, mut off) = (Double::<V>::zero(), V::splat(TINY));
                for (k, factor) in b.column(j).iter().enumerate().take(a.columns) {
                    let at = k * room + first;
                    sum = sum.plus_product(a.mid.at(at), V::splat(*factor));
                    off = V::load(&a.off[at..]).mul_add(V::splat(factor.abs()), off);
                }
                let sum = sum.normalise();
                let (hi, lo, off) = (sum.hi.to_array(), sum.lo.to_array(), (off * V::splat(up::THOUSANDS)).to_array());
                for (i, entry) in product.column_mut(j)[first..].iter_mut().enumerate().take(LANES) {
                    *entry = Ball::exact(Dd { hi: hi[i], lo: lo[i] }).widen(off[i]);
                }
            }
        }
    }
}

/// From this many rows on, the balls of an elimination may grow, since each step may double an entry's error.
const MANY_ROWS: usize = 12;
/// Error relative to the solution with which elimination in balls counts as successful.
const SHARP: f64 = 1e-24;

/// A^-1 B; `None` if A may be singular.
pub fn solve(a: &Matrix<Ball>, b: &Matrix<Ball>) -> Option<Matrix<Ball>> {
    let eliminated = eliminate(a, b);
    let is_sharp = |x: &Matrix<Ball>| {
        let size = norm_bound(x.rows(), x.columns(), |i, j| x[(i, j)].mid.hi.abs());
        x.radius() <= SHARP * size
    };
    if a.rows() < MANY_ROWS || eliminated.as_ref().is_some_and(is_sharp) {
        return eliminated;
    }
    match (eliminated, solve_verified(a, b)) {
        (Some(x), Some(y)) => Some(Matrix::from_fn(x.rows(), x.columns(), |i, j| {
            if x[(i, j)].rad <= y[(i, j)].rad { x[(i, j)] } else { y[(i, j)] }
        })),
        (one, other) => one.or(other),
    }
}

/// Gaussian elimination with partial pivoting, in balls.
fn eliminate(a: &Matrix<Ball>, b: &Matrix<Ball>) -> Option<Matrix<Ball>> {
    let n = a.rows();
    let mut rows: Vec<Vec<Ball>> =
        (0..n).map(|i| (0..n).map(|j| a[(i, j)]).chain((0..b.columns()).map(|j| b[(i, j)])).collect()).collect();
    for step in 0..n {
        let pivot = (step..n)
            .fold(step, |best, i| if rows[i][step].mignitude() > rows[best][step].mignitude() { i } else { best });
        if rows[pivot][step].contains_zero() || !rows[pivot][step].is_finite() {
            return None;
        }
        rows.swap(pivot, step);
        let (top, below) = rows.split_at_mut(step + 1);
        for row in below {
            subtract_multiple(row, &top[step], step);
        }
    }
    for step in (0..n).rev() {
        let (above, rest) = rows.split_at_mut(step);
        let pivot = rest[0][step];
        for x in &mut rest[0][n..] {
            *x = *x / pivot;
        }
        for row in above {
            let factor = row[step];
            for (x, &y) in row[n..].iter_mut().zip(&rest[0][n..]) {
                *x = *x - factor * y;
            }
        }
    }
    Some(Matrix::from_fn(n, b.columns(), |i, j| rows[i][n + j]))
}

/// A^-1 B from an approximate inverse R: with |1 - R A| <= gamma < 1 row by row, A is regular, and an approximation X
/// of the solution has an error e with e <= |R (B - A X)| + |1 - R A| e (Rump, Acta Numerica 19 (2010) 287, section
/// 10).
fn solve_verified(a: &Matrix<Ball>, b: &Matrix<Ball>) -> Option<Matrix<Ball>> {
    let n = a.rows();
    let (by_rows, by_columns) = balance(a)?;
    let a = Matrix::from_fn(n, n, |i, j| a[(i, j)] * Ball::from(by_rows[i]) * Ball::from(by_columns[j]));
    let b = Matrix::from_fn(n, b.columns(), |i, j| b[(i, j)] * Ball::from(by_rows[i]));
    let inverse = inverse(a.mid())?.map(Ball::exact);
    let nearly_one = product(&inverse, &a);
    let lacks = |i: usize| (0..n).map(|j| (nearly_one[(i, j)] - unit(i, j)).magnitude()).sum::<f64>() * UP;
    let lacks: Vec<f64> = (0..n).map(lacks).collect();
    let gamma = lacks.iter().copied().fold(0.0, larger);
    // Also false if gamma is NaN.
    let is_regular = gamma < 0.5;
    if !is_regular {
        return None;
    }
    let mut x = product(&inverse, &b).mid();
    let left = |x: &Matrix<Dd>| {
        let image = product(&a, &x.map(Ball::exact));
        Matrix::from_fn(n, b.columns(), |i, j| b[(i, j)] - image[(i, j)])
    };
    for _ in 0..2 {
        let step = product(&inverse, &left(&x).mid().map(Ball::exact));
        x = Matrix::from_fn(n, b.columns(), |i, j| x[(i, j)] + step[(i, j)].mid);
    }
    let off = product(&inverse, &left(&x));
    let mut solution = Matrix::none(n, b.columns());
    for j in 0..b.columns() {
        let largest = off.column(j).iter().map(Ball::magnitude).fold(0.0, larger) / (1.0 - gamma) * UP;
        for i in 0..n {
            let error = (off[(i, j)].magnitude() + lacks[i] * largest) * UP;
            solution[(i, j)] = Ball::new(x[(i, j)], error) * Ball::from(by_columns[i]);
        }
    }
    solution.is_finite().then_some(solution)
}

const UP: f64 = up::THOUSANDS;

fn unit(i: usize, j: usize) -> Ball {
    if i == j { Ball::ONE } else { Ball::ZERO }
}

/// Powers of two that bring the largest entry of each row, and then of each column, near one.
fn balance(a: &Matrix<Ball>) -> Option<(Vec<f64>, Vec<f64>)> {
    let n = a.rows();
    let of = |largest: f64| {
        let exponent = ((largest.to_bits() >> 52) & 0x7ff) as i32 - 1023;
        (largest.is_finite() && (-500..500).contains(&exponent)).then(|| two_to(-exponent))
    };
    let size = |i: usize, j: usize| a[(i, j)].mid.hi.abs();
    let rows = (0..n).map(|i| of((0..n).map(|j| size(i, j)).fold(0.0, f64::max))).collect::<Option<Vec<f64>>>()?;
    let column = |j: usize| of((0..n).map(|i| size(i, j) * rows[i]).fold(0.0, f64::max));
    let columns = (0..n).map(column).collect::<Option<Vec<f64>>>()?;
    Some((rows, columns))
}

fn subtract_multiple(row: &mut [Ball], pivot_row: &[Ball], step: usize) {
    if row[step].is_zero() {
        return;
    }
    let factor = row[step] / pivot_row[step];
    for (x, &y) in row.iter_mut().zip(pivot_row).skip(step) {
        *x = *x - factor * y;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::{Number, Rational};

    #[test]
    fn a_solution_encloses_the_true_one() {
        // The Hilbert matrix of order 5; the solution for the sums of its rows is all ones.
        let n = 5;
        let a = Matrix::from_fn(n, n, |i, j| Ball::ONE / Ball::from((i + j + 1) as f64));
        let b = product(&a, &Matrix::fill_with(n, 1, Ball::ONE));
        let x = solve(&a, &b).expect("regular");
        for i in 0..n {
            assert!((x[(i, 0)] - Ball::ONE).contains_zero());
            assert!(x[(i, 0)].rad < 1e-20);
        }
    }

    /// A row of a hundred links: M_ij = (n - max(i, j)) / 7; the solution for the sums of its rows is all ones.
    #[test]
    fn a_hundred_rows_keep_their_digits() {
        let n = 100;
        let a = Matrix::from_fn(n, n, |i, j| Ball::from((n - i.max(j)) as f64) / Ball::from(7.0));
        let b = product(&a, &Matrix::fill_with(n, 1, Ball::ONE));
        for x in [solve_verified(&a, &b).expect("regular"), solve(&a, &b).expect("regular")] {
            for i in 0..n {
                assert!((x[(i, 0)] - Ball::ONE).contains_zero(), "{i}: {:?}", x[(i, 0)]);
                assert!(x[(i, 0)].rad < 1e-22, "{i}: {:?}", x[(i, 0)]);
            }
        }
        let singular = Matrix::from_fn(n, n, |i, j| if i + 1 < n { a[(i, j)] } else { a[(0, j)] });
        assert!(solve_verified(&singular, &b).is_none() && solve(&singular, &b).is_none());
        // Numbers of very different magnitude: rows of 1e-9 kg beside rows of 1e9 kg.
        let graded = |i: usize| 10f64.powi((i % 19) as i32 - 9);
        let graded = Matrix::from_fn(n, n, |i, j| a[(i, j)] * Ball::from(graded(i)) * Ball::from(graded(j)));
        let b = product(&graded, &Matrix::fill_with(n, 1, Ball::ONE));
        let x = solve_verified(&graded, &b).expect("regular");
        assert!((0..n).all(|i| (x[(i, 0)] - Ball::ONE).contains_zero()));
    }

    /// Beside fractions: entries with low words and radii, in numbers that are not multiples of the lanes.
    #[test]
    fn a_panel_times_exact_numbers_encloses_the_product() {
        let entry = |i: usize, j: usize| Ball::from((3 * i + 7 * j) as f64 - 20.0) / Ball::from((i + j + 1) as f64);
        for (rows, depth, columns) in [(1, 1, 1), (8, 3, 2), (13, 21, 9)] {
            let a = Matrix::from_fn(rows, depth, entry);
            let b = Matrix::from_fn(depth, columns, |i, j| ((i * 5 + j * 11) % 13) as f64 * 0.1 - 0.7);
            let found = Panel::of(&a).times(&b);
            let fraction = |x: f64| Number::from(Rational::from_f64(x).expect("finite"));
            for i in 0..rows {
                for j in 0..columns {
                    let terms = (0..depth).map(|k| {
                        let exact = &Number::from((3 * i + 7 * k) as i64 - 20) / &Number::from((i + k + 1) as i64);
                        &exact * &fraction(b[(k, j)])
                    });
                    let sum = terms.fold(Number::ZERO, |sum, term| &sum + &term);
                    let Ball { mid, rad } = found[(i, j)];
                    let off = (&sum - &(&fraction(mid.hi) + &fraction(mid.lo))).abs();
                    assert!(!(&off - &fraction(rad)).is_positive(), "{rows} {i} {j}: {off:?} {rad}");
                    assert!(rad < 1e-26, "{rows} {i} {j}: {rad}");
                }
            }
        }
    }

    /// Exact entries of two words: the only error is that of the sums.
    #[test]
    fn a_panel_counts_what_its_sums_lose() {
        let word = |i: usize, j: usize| ((i * 7 + j * 13 + 3) % 29) as f64 / 29.0 - 0.4;
        let (rows, depth) = (9, 24);
        let a = Matrix::from_fn(rows, depth, |i, j| Dd::new(word(i, j), word(j, i) * 1e-17));
        let b = Matrix::from_fn(depth, 1, |k, _| word(k, 2 * k + 1));
        let found = Panel::of(&a.map(Ball::exact)).times(&b);
        let fraction = |x: f64| Rational::from_f64(x).expect("finite");
        let value = |x: Dd| &fraction(x.hi) + &fraction(x.lo);
        for i in 0..rows {
            let terms = (0..depth).map(|k| &value(a[(i, k)]) * &fraction(b[(k, 0)]));
            let sum = terms.fold(Rational::ZERO, |sum, term| &sum + &term);
            let off = (&sum - &value(found[(i, 0)].mid)).to_f64().abs();
            assert!(off <= found[(i, 0)].rad && found[(i, 0)].rad < 1e-27, "{i}: {off:e} {:?}", found[(i, 0)]);
        }
    }

    #[test]
    fn the_norm_is_not_below_the_true_one() {
        // [3 4; 0 0] has the 2-norm 5.
        let bound = norm_bound(2, 2, |i, j| if i == 0 { [3.0, 4.0][j] } else { 0.0 });
        assert!((5.0..5.3).contains(&bound));
    }

    /// (1 +- 0.3) x = 1 and a row beside it: x up to 1 / 0.7, more than the residual says. With 1 +- 0.6 the approximate
    /// inverse proves nothing.
    #[test]
    fn solutions_of_all_matrices_in_the_balls_are_enclosed() {
        let of = |radius: f64| {
            let entry = |i: usize, j: usize| if i == j { Ball::ONE.widen(radius) } else { Ball::ZERO };
            solve_verified(&Matrix::from_fn(2, 2, entry), &Matrix::fill_with(2, 1, Ball::ONE))
        };
        let x = of(0.3).expect("regular");
        for truth in [1.0 / 0.7, 1.0 / 1.3] {
            assert!((x[(0, 0)] - Ball::from(truth)).contains_zero(), "{:?}", x[(0, 0)]);
        }
        assert!(x[(0, 0)].rad < 0.6 && of(0.6).is_none());
    }
}
