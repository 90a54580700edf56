//! Forms in coordinates of given vectors, and what follows for eigenvalues. In: a form, whose numbers may be known over a range alone,
//! and vectors, exactly as they are. Out: V^T F V in balls; enclosures of the eigenvalues of a pencil that is nearly diagonal. See
//! docs/method/studies.md#one-weight.

use crate::base::{Ball, Dd};
use crate::system::Form;

/// Covers the rounding of a few sums of numbers that are not negative.
pub const ABOVE: f64 = 1.0 + 1e-9;

/// V^T F V, row by row; a jet is taken as its enclosure.
pub fn project(form: &Form, vectors: &[Vec<Dd>]) -> Vec<Ball> {
    let n = vectors.len();
    let mut product = vec![Ball::ZERO; n * n];
    for term in form.terms() {
        let (row, weight) = (form.row(term), term.weight.enclosure());
        let row: Vec<(usize, Ball)> = row.iter().map(|(at, a)| (at.index(), a.enclosure())).collect();
        let along = |vector: &Vec<Dd>| row.iter().fold(Ball::ZERO, |sum, (at, a)| sum + *a * Ball::exact(vector[*at]));
        let felt: Vec<Ball> = vectors.iter().map(along).collect();
        for i in 0..n {
            let weighted = weight * felt[i];
            for (sum, felt) in product[i * n..=i * n + i].iter_mut().zip(&felt) {
                *sum = *sum + weighted * *felt;
            }
        }
    }
    for i in 0..n {
        for j in 0..i {
            product[j * n + i] = product[i * n + j];
        }
    }
    product
}

/// A bound of the norm of a matrix less a diagonal one.
pub fn off_diagonal_norm(matrix: &[Ball], diagonal: &[Dd]) -> f64 {
    let n = diagonal.len();
    let squares = distances(matrix, diagonal).map(|(_, _, x)| x * x);
    debug_assert_eq!(matrix.len(), n * n);
    squares.sum::<f64>().sqrt() * ABOVE
}

/// Bounds of the entries of a matrix less a diagonal one, with their places.
fn distances(matrix: &[Ball], diagonal: &[Dd]) -> impl Iterator<Item = (usize, usize, f64)> {
    let n = diagonal.len();
    (0..n * n).map(move |at| {
        let (i, j) = (at / n, at % n);
        let entry = if i == j { matrix[at] - Ball::exact(diagonal[i]) } else { matrix[at] };
        (i, j, entry.magnitude())
    })
}

/// Ends of the i-th smallest eigenvalue of all pencils T - x S in enclosures of symmetric matrices, ascending: T is nearly diagonal,
/// S nearly the unit matrix. `None` if S may be far from it.
pub fn eigenvalues(t: &[Ball], s: &[Ball], n: usize) -> Option<Vec<[f64; 2]>> {
    let d: Vec<Dd> = (0..n).map(|i| Dd::from(t[i * n + i].to_f64())).collect();
    let (of_t, of_s) = (off_diagonal_norm(t, &d), off_diagonal_norm(s, &vec![Dd::from(1.0); n]));
    // NaN fails too.
    if !(of_s < 0.5 && of_t.is_finite()) {
        return None;
    }
    // T = sqrt(D) (I + E) sqrt(D), so that x^T T x is within the norm of E of x^T D x, as a part of it.
    let are_positive = d.iter().all(|d| d.hi > 0.0);
    let squares = distances(t, &d).map(|(i, j, x)| x * x / (d[i].hi * d[j].hi));
    let relative = if are_positive { squares.sum::<f64>().sqrt() * ABOVE } else { f64::INFINITY };
    let mut values: Vec<f64> = d.iter().map(|d| d.hi).collect();
    values.sort_by(f64::total_cmp);
    let ends = |d: &f64| {
        let off = (of_t + d.abs() * of_s) / (1.0 - of_s) * ABOVE;
        let [mut low, mut high] = [d - off, d + off];
        if relative < 1.0 {
            low = low.max(d * (1.0 - relative) / (1.0 + of_s) / ABOVE);
            high = high.min(d * (1.0 + relative) / (1.0 - of_s) * ABOVE);
        }
        let rounding = 4.0 * f64::EPSILON * d.abs();
        [low - rounding, high + rounding]
    };
    Some(values.iter().map(ends).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// T = 1 to 1.1 and S = 0.6 to 1.4: t / s from 1 / 1.4 to 1.1 / 0.6; and -1 and -1.1 to -0.9 for T, where nothing is relative.
    #[test]
    fn eigenvalues_of_one_coordinate_are_quotients() {
        let s = Ball::from(1.0).widen(0.4);
        for (t, [least, largest]) in [
            (Ball::from(1.05).widen(0.05), [1.0 / 1.4, 1.1 / 0.6]),
            (Ball::from(-1.0).widen(0.0), [-1.0 / 0.6, -1.0 / 1.4]),
            (Ball::from(-1.0).widen(0.1), [-1.1 / 0.6, -0.9 / 1.4]),
        ] {
            let [low, high] = eigenvalues(&[t], &[s], 1).expect("near one")[0];
            assert!(low <= least && largest <= high, "{low} {high}");
        }
    }

    /// T = (10^-3, t; t, -10^-3) with t from -1 to 1 and the unit matrix: eigenvalues of up to 1 and at least -1.
    #[test]
    fn couplings_larger_than_the_diagonal_are_in_the_ends() {
        let (one, coupled) = (Ball::from(1.0), Ball::ZERO.widen(1.0));
        let t = [Ball::from(1e-3), coupled, coupled, Ball::from(-1e-3)];
        let ends = eigenvalues(&t, &[one, Ball::ZERO, Ball::ZERO, one], 2).expect("the unit matrix");
        let largest = f64::hypot(1.0, 1e-3);
        assert!(ends[0][0] <= -largest && ends[1][1] >= largest, "{ends:?}");
        assert!(ends[0][1] >= -1e-3 && ends[1][0] <= 1e-3, "{ends:?}");
    }
}
