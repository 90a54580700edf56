//! Linear equations over a range of a parameter. In: matrices whose entries are enclosed with their derivatives. Out:
//! the solution and its derivative, enclosed over the whole range, and a number that is zero exactly if a symmetric
//! matrix is singular. See docs/method/measures.md.
//!
//! The equations are multiplied by an approximate inverse of the midpoint, so that elimination in balls is applied to a
//! matrix near the identity. The derivative solves A x' = b' - A' x. A matrix A is bordered by a vector v:
//!
//! | A   v |   | x |   | 0 |
//! | v^T 0 | * | s | = | 1 |
//!
//! If the bordered matrix is regular, A is singular exactly where s is zero (W. Govaerts, *Numerical Methods for
//! Bifurcations of Dynamical Equilibria*, SIAM 2000, chapter 3); x is then its null vector with v . x = 1.

use crate::base::{Ball, Dd, Jet, Number, OrderBy, two_to};
use crate::kernel::dense::Matrix;
use crate::kernel::dense::enclosure::{product, solve as eliminated};
use nalgebra::{DMatrix, SymmetricEigen};

/// Entries enclosed over a range, and their derivatives.
#[derive(Clone, Debug)]
pub struct JetMatrix {
    pub value: Matrix<Ball>,
    pub slope: Matrix<Ball>,
}

impl JetMatrix {
    pub fn from_fn(rows: usize, columns: usize, entry: impl Fn(usize, usize) -> Number) -> JetMatrix {
        let (mut value, mut slope) = (Matrix::none(rows, columns), Matrix::none(rows, columns));
        for j in 0..columns {
            for i in 0..rows {
                let jet = Jet::of(&entry(i, j));
                (value[(i, j)], slope[(i, j)]) = (jet.value, jet.slope);
            }
        }
        JetMatrix { value, slope }
    }

    pub fn entry(&self, i: usize, j: usize) -> Jet {
        Jet { value: self.value[(i, j)], slope: self.slope[(i, j)] }
    }

    fn rows(&self) -> usize {
        self.value.rows()
    }
}

/// A^-1 B and its derivative; `None` if A may be singular somewhere in the range.
pub fn solve(a: &JetMatrix, b: &JetMatrix) -> Option<JetMatrix> {
    if !a.value.is_finite() || !b.value.is_finite() {
        return None;
    }
    let inverse = middle_inverse(&a.value)?;
    let near_one = product(&inverse, &a.value);
    let value = eliminated(&near_one, &product(&inverse, &b.value))?;
    let is_still = |matrix: &JetMatrix| matrix.slope.data().iter().all(Ball::is_zero);
    if is_still(a) && is_still(b) {
        let slope = Matrix::none(value.rows(), value.columns());
        return value.is_finite().then_some(JetMatrix { value, slope });
    }
    let moved = product(&a.slope, &value);
    let left = Matrix::from_fn(b.value.rows(), b.value.columns(), |i, j| b.slope[(i, j)] - moved[(i, j)]);
    let slope = if left.is_finite() {
        eliminated(&near_one, &product(&inverse, &left))?
    } else {
        Matrix::fill_with(value.rows(), value.columns(), Ball::new(Dd::ZERO, f64::INFINITY))
    };
    value.is_finite().then_some(JetMatrix { value, slope })
}

/// An approximate inverse of the midpoint; any regular matrix would be valid.
pub(super) fn middle_inverse(a: &Matrix<Ball>) -> Option<Matrix<Ball>> {
    let n = a.rows();
    let middle = a.map(|ball| Ball::exact(ball.mid));
    let one = Matrix::from_fn(n, n, |i, j| if i == j { Ball::ONE } else { Ball::ZERO });
    let inverse = eliminated(&middle, &one).or_else(|| {
        // Singular to its own rounding errors: binary64 may still give an approximation.
        DMatrix::from_fn(n, n, |i, j| a[(i, j)].to_f64())
            .try_inverse()
            .map(|inverse| Matrix::from_fn(n, n, |i, j| Ball::from(inverse[(i, j)])))
    })?;
    inverse.is_finite().then(|| inverse.map(|ball| Ball::exact(ball.mid)))
}

/// The matrix bordered by directions that make it regular, as columns: X and S with A X + V S = 0, V^T X = 1.
pub struct Bordered {
    /// Null vectors, if S is zero.
    pub x: JetMatrix,
    /// S; singular exactly where the matrix is.
    pub s: JetMatrix,
}

/// A symmetric matrix bordered by approximations of its last null vectors; `None` if the result cannot be shown to be
/// regular. `sizes` gives the magnitude of the parts of each row, which may cancel.
pub fn border(a: &JetMatrix, sizes: &[f64], count: usize) -> Option<Bordered> {
    let n = a.rows();
    if count == 0 || count > n || !a.value.is_finite() {
        return None;
    }
    let scale = scales(sizes);
    let scaled = scale_both_sides(a, &scale);
    let v = null_directions(&scaled.value, count)?;
    let border = |i: usize, j: usize| match (i < n, j < n) {
        (true, true) => scaled.entry(i, j),
        (true, false) => Jet { value: v[(i, j - n)], slope: Ball::ZERO },
        (false, true) => Jet { value: v[(j, i - n)], slope: Ball::ZERO },
        (false, false) => Jet { value: Ball::ZERO, slope: Ball::ZERO },
    };
    let all = of_jets(n + count, n + count, border);
    let right = JetMatrix {
        value: Matrix::from_fn(n + count, count, |i, j| if i == n + j { Ball::ONE } else { Ball::ZERO }),
        slope: Matrix::none(n + count, count),
    };
    let found = solve(&all, &right)?;
    // D A D (D^-1 x) = ..., so x is D times the computed solution.
    let unscaled = |i: usize, jet: Jet| Jet { value: jet.value * scale[i], slope: jet.slope * scale[i] };
    let x = of_jets(n, count, |i, j| unscaled(i, found.entry(i, j)));
    let s = of_jets(count, count, |i, j| found.entry(n + i, j));
    Some(Bordered { x, s })
}

fn of_jets(rows: usize, columns: usize, entry: impl Fn(usize, usize) -> Jet) -> JetMatrix {
    let value = Matrix::from_fn(rows, columns, |i, j| entry(i, j).value);
    let slope = Matrix::from_fn(rows, columns, |i, j| entry(i, j).slope);
    JetMatrix { value, slope }
}

/// Powers of two that make rows of metres and of radians comparable.
fn scales(sizes: &[f64]) -> Vec<Ball> {
    let exponent = |size: f64| ((size.to_bits() >> 52) & 0x7ff) as i32 - 1023;
    let power = |size: f64| if size >= f64::MIN_POSITIVE && size.is_finite() { -exponent(size) / 2 } else { 0 };
    sizes.iter().map(|size| Ball::from(two_to(power(*size)))).collect()
}

fn scale_both_sides(a: &JetMatrix, scale: &[Ball]) -> JetMatrix {
    of_jets(a.rows(), a.rows(), |i, j| {
        let factor = scale[i] * scale[j];
        Jet { value: a.value[(i, j)] * factor, slope: a.slope[(i, j)] * factor }
    })
}

/// Eigenvectors of the eigenvalues nearest to zero, in binary64: any vectors that make the bordered matrix regular are
/// valid.
fn null_directions(a: &Matrix<Ball>, count: usize) -> Option<Matrix<Ball>> {
    let n = a.rows();
    let middle = DMatrix::from_fn(n, n, |i, j| a[(i.max(j), i.min(j))].to_f64());
    if !middle.iter().all(|entry| entry.is_finite()) {
        return None;
    }
    let eigen = SymmetricEigen::try_new(middle, f64::EPSILON, 1000)?;
    let mut order: Vec<usize> = (0..n).collect();
    order.order_by(|&i, &j| eigen.eigenvalues[i].abs().total_cmp(&eigen.eigenvalues[j].abs()));
    Some(Matrix::from_fn(n, count, |i, j| Ball::from(eigen.eigenvectors[(i, order[j])])))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ball(mid: f64, rad: f64) -> Number {
        Jet::of_parameter(Ball::new(Dd::from(mid), rad))
    }

    /// (p 1; 1 2) x = (1, 0): x = (2, -1) / (2p - 1), x' = -2 (2, -1) / (2p - 1)^2.
    #[test]
    fn a_solution_and_its_derivative_hold_over_the_range() {
        let p = ball(2.0, 0.1);
        let entries = [[p.clone(), Number::ONE], [Number::ONE, Number::from(2)]];
        let a = JetMatrix::from_fn(2, 2, |i, j| entries[i][j].clone());
        let b = JetMatrix::from_fn(2, 1, |i, _| if i == 0 { Number::ONE } else { Number::ZERO });
        let x = solve(&a, &b).expect("regular");
        for p in [1.9, 1.95, 2.0, 2.1] {
            let under = 2.0 * p - 1.0;
            for (i, part) in [2.0, -1.0].into_iter().enumerate() {
                let holds = |ball: Ball, truth: f64| (ball.to_f64() - truth).abs() <= ball.rad + 1e-15;
                assert!(holds(x.value[(i, 0)], part / under));
                assert!(holds(x.slope[(i, 0)], -2.0 * part / (under * under)));
            }
        }
        assert!(x.value[(0, 0)].rad < 0.1);
        let singular =
            JetMatrix::from_fn(2, 2, |i, j| if i == 0 && j == 0 { ball(0.5, 0.1) } else { entries[i][j].clone() });
        assert!(solve(&singular, &b).is_none());
    }

    /// diag(p - 3, 5): s changes its sign at 3, and nowhere else.
    #[test]
    fn a_bordered_matrix_says_where_one_is_singular() {
        let s = |mid: f64, rad: f64| {
            let p = &ball(mid, rad) - &Number::from(3);
            let entries = [[p, Number::ZERO], [Number::ZERO, Number::from(5)]];
            border(&JetMatrix::from_fn(2, 2, |i, j| entries[i][j].clone()), &[3.0, 5.0], 1)
                .expect("regular")
                .s
                .entry(0, 0)
        };
        assert!(!s(2.5, 0.4).value.contains_zero());
        assert!(!s(3.5, 0.4).value.contains_zero());
        assert!(s(3.1, 0.4).value.contains_zero());
        assert!(!s(3.1, 0.4).slope.contains_zero());
    }
}
