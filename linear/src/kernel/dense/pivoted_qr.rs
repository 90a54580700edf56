//! Factors of M^(-1/2) K M^(-1/2) = G^T G for positive terms of any kind, from G P = Q R: R^T R without its
//! permutation.
//!
//! Householder's QR with column pivoting and rows sorted by magnitude: for rows and columns of very different
//! magnitudes it is stable row by row (Powell and Reid 1969; Cox and Higham 1998), and the rows of R are graded, as
//! one-sided Jacobi on R^T requires (Drmac and Veselic 2008). See docs/method/modes.md#starting-modes.

use crate::base::OrderBy;
use crate::kernel::dense::Matrix;

/// C with C C^T = G^T G and `rank` columns.
pub fn factor(mut g: Matrix<f64>, rank: usize) -> Matrix<f64> {
    g = with_sorted_rows(&g);
    let (rows, n) = (g.rows(), g.columns());
    let mut order: Vec<usize> = (0..n).collect();
    let rank = rank.min(rows);
    for step in 0..rank {
        let square = |j: usize| g.column(j)[step..].iter().map(|x| x * x).sum::<f64>();
        let squares: Vec<f64> = (step..n).map(square).collect();
        let best = (0..squares.len()).fold(0, |best, j| if squares[j] > squares[best] { j } else { best });
        g.swap_columns(step, step + best);
        order.swap(step, step + best);
        reflect(&mut g, step);
    }
    let mut c = Matrix::fill_with(n, rank, 0.0);
    for (j, &original) in order.iter().enumerate() {
        for i in 0..rank.min(j + 1) {
            c[(original, i)] = g[(i, j)];
        }
    }
    c
}

/// The rows in descending order of their largest entry.
fn with_sorted_rows(g: &Matrix<f64>) -> Matrix<f64> {
    let size = |i: usize| (0..g.columns()).fold(0.0, |m: f64, j| m.max(g[(i, j)].abs()));
    let sizes: Vec<f64> = (0..g.rows()).map(size).collect();
    let mut order: Vec<usize> = (0..g.rows()).collect();
    order.order_by(|&a, &b| sizes[b].total_cmp(&sizes[a]));
    Matrix::from_fn(g.rows(), g.columns(), |i, j| g[(order[i], j)])
}

/// Applies the reflection that clears column `step` below its diagonal to the columns from `step` on.
fn reflect(g: &mut Matrix<f64>, step: usize) {
    let (rows, n) = (g.rows(), g.columns());
    let mut normal: Vec<f64> = g.column(step)[step..].to_vec();
    let largest = normal.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    if largest == 0.0 {
        return;
    }
    normal.iter_mut().for_each(|x| *x /= largest);
    let length = normal.iter().map(|x| x * x).sum::<f64>().sqrt();
    let turned = if normal[0] > 0.0 { -length } else { length };
    normal[0] -= turned;
    let half_square = length * (length + (normal[0] + turned).abs());
    for j in step + 1..n {
        let column = &mut g.column_mut(j)[step..];
        let factor = normal.iter().zip(&*column).map(|(v, x)| v * x).sum::<f64>() / half_square;
        column.iter_mut().zip(&normal).for_each(|(x, v)| *x -= factor * v);
    }
    g.column_mut(step)[step] = turned * largest;
    g.column_mut(step)[step + 1..rows].fill(0.0);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_factor_has_the_same_square() {
        let g = Matrix::from_fn(5, 3, |i, j| {
            [[3.0, 1e-3, 2.0], [1e6, -1e6, 0.0], [0.0, 4.0, 1e-5], [1.0, 1.0, 1.0], [0.0, 0.0, 2.0]][i][j]
        });
        let c = factor(g.clone(), 3);
        for i in 0..3 {
            for j in 0..3 {
                let square: f64 = (0..5).map(|r| g[(r, i)] * g[(r, j)]).sum();
                let found: f64 = (0..3).map(|r| c[(i, r)] * c[(j, r)]).sum();
                assert!((square - found).abs() <= 1e-15 * 1e12, "{i} {j}: {square} {found}");
            }
        }
    }
}
