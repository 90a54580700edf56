//! Gaussian elimination with partial pivoting, P A = L U, in binary64 and double-double, real and complex: for solutions,
//! determinants and inverses without error bounds (for solutions with bounds see [`enclosure`](super::enclosure)).

use crate::base::larger;
use crate::kernel::dense::Matrix;
use crate::kernel::real::Scalar;

/// The triangular factors of a square matrix whose rows were exchanged.
#[derive(Clone, Debug)]
pub struct Lu<T> {
    lu: Matrix<T>,
    /// Row i of L U is row `order[i]` of A.
    order: Vec<usize>,
    /// An odd number of rows was exchanged.
    odd: bool,
}

impl<T: Scalar> Lu<T> {
    /// Factors a matrix; `None` if it is not finite, or singular (a pivot is exactly zero).
    pub fn of(a: Matrix<T>) -> Option<Lu<T>> {
        Lu::with_pivots(a, |pivot, _| (pivot != T::ZERO).then_some(pivot))
    }

    /// Factors a nearly singular matrix, as inverse iteration needs: a zero pivot is replaced by a very small number.
    /// `None` if the matrix is not finite.
    pub fn nearly_singular(a: Matrix<T>) -> Option<Lu<T>> {
        let small = |largest: f64| T::of_f64((largest * f64::EPSILON).max(f64::MIN_POSITIVE));
        Lu::with_pivots(a, |pivot, largest| Some(if pivot.size() <= largest * 1e-300 { small(largest) } else { pivot }))
    }

    /// `accepted` turns an entry into the pivot that is used, given the size of the largest entry.
    fn with_pivots(mut lu: Matrix<T>, accepted: impl Fn(T, f64) -> Option<T>) -> Option<Lu<T>> {
        let n = lu.rows();
        let largest = lu.data().iter().map(|x| x.size()).fold(0.0, larger);
        if !largest.is_finite() {
            return None;
        }
        let mut order: Vec<usize> = (0..n).collect();
        let mut odd = false;
        for p in 0..n {
            let best = largest_below(lu.column(p), p);
            if best != p {
                odd = !odd;
                order.swap(p, best);
                lu.swap_rows(p, best);
            }
            lu[(p, p)] = accepted(lu[(p, p)], largest)?;
            eliminate_below(&mut lu, p);
        }
        Some(Lu { lu, order, odd })
    }

    /// b <- A^-1 b
    pub fn solve(&self, b: &mut [T]) {
        let n = self.order.len();
        let mut x: Vec<T> = self.order.iter().map(|&i| b[i]).collect();
        for j in 0..n {
            let (head, rest) = x[j..].split_first_mut().expect("j is below n");
            T::subtract_products(rest, &self.lu.column(j)[j + 1..], *head);
        }
        for j in (0..n).rev() {
            let head = x[j] * self.lu[(j, j)].recip();
            x[j] = head;
            T::subtract_products(&mut x[..j], &self.lu.column(j)[..j], head);
        }
        b.copy_from_slice(&x);
    }

    pub fn determinant(&self) -> T {
        let product = (0..self.order.len()).fold(T::ONE, |product, i| product * self.lu[(i, i)]);
        if self.odd { T::ZERO - product } else { product }
    }
}

/// The row of the largest entry of a column from row p on, the first of several.
fn largest_below<T: Scalar>(column: &[T], p: usize) -> usize {
    (p + 1..column.len()).fold(p, |best, i| if column[i].size() > column[best].size() { i } else { best })
}

/// One step of elimination below pivot p, column by column.
fn eliminate_below<T: Scalar>(lu: &mut Matrix<T>, p: usize) {
    let n = lu.rows();
    let inverse = lu[(p, p)].recip();
    for l in &mut lu.column_mut(p)[p + 1..] {
        *l = *l * inverse;
    }
    for j in p + 1..n {
        let (source, target) = lu.column_pair(p, j);
        let head = target[p];
        if head != T::ZERO {
            T::subtract_products(&mut target[p + 1..], &source[p + 1..], head);
        }
    }
}

/// The inverse by Gauss-Jordan elimination with partial pivoting, in place; `None` if the matrix is singular or not
/// finite.
pub fn inverse<T: Scalar>(mut a: Matrix<T>) -> Option<Matrix<T>> {
    let n = a.rows();
    let mut order: Vec<usize> = (0..n).collect();
    for p in 0..n {
        let best = largest_below(a.column(p), p);
        let size = a[(best, p)].size();
        if !(size > 0.0 && size.is_finite()) {
            return None;
        }
        if best != p {
            order.swap(p, best);
            a.swap_rows(p, best);
        }
        let reciprocal = a[(p, p)].recip();
        // The pivot's column becomes that of the inverse.
        let mut factors = a.column(p).to_vec();
        factors[p] = T::ZERO;
        a.column_mut(p).fill(T::ZERO);
        a[(p, p)] = T::ONE;
        for j in 0..n {
            let column = a.column_mut(j);
            let head = column[p] * reciprocal;
            if head != T::ZERO {
                T::subtract_products(column, &factors, head);
                column[p] = head;
            }
        }
    }
    // The columns of the inverse come out in the order of the pivots.
    let mut place = vec![0; n];
    order.iter().enumerate().for_each(|(j, &original)| place[original] = j);
    Some(a.select_columns(&place))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::Dd;
    use crate::kernel::complex::Complex;

    /// Zeros on the diagonal: rows have to be exchanged.
    fn entry(i: usize, j: usize) -> f64 {
        if i == j { 0.0 } else { 1.0 / (1.0 + (3 * i + 5 * j) as f64) }
    }

    fn product<T: Scalar>(a: &Matrix<T>, b: &Matrix<T>) -> Matrix<T> {
        Matrix::from_fn(a.rows(), b.columns(), |i, j| {
            (0..a.columns()).fold(T::ZERO, |sum, k| sum + a[(i, k)] * b[(k, j)])
        })
    }

    /// A x = b and A A^-1 = 1 within some units of the number's roundoff times the condition, which is some 1e5.
    fn check<T: Scalar>(a: Matrix<T>, roundoff: f64) {
        let n = a.rows();
        let b: Vec<T> = (0..n).map(|i| T::of_f64(1.0 + i as f64)).collect();
        let mut x = b.clone();
        Lu::of(a.clone()).expect("regular").solve(&mut x);
        let image = product(&a, &Matrix::from_fn(n, 1, |i, _| x[i]));
        assert!((0..n).all(|i| (image[(i, 0)] - b[i]).size() <= 1e3 * n as f64 * roundoff * n as f64));
        let unit = product(&a, &inverse(a.clone()).expect("regular"));
        let off = |i: usize, j: usize| (unit[(i, j)] - if i == j { T::ONE } else { T::ZERO }).size();
        assert!((0..n * n).all(|at| off(at / n, at % n) <= 1e7 * roundoff));
    }

    #[test]
    fn solutions_and_inverses_have_the_digits_of_their_numbers() {
        let turned = |i: usize, j: usize| Complex::new(entry(i, j), 0.3 * entry(j + 1, i));
        check(Matrix::from_fn(40, 40, entry), f64::EPSILON);
        check(Matrix::from_fn(40, 40, |i, j| Dd::from(entry(i, j))), Dd::EPSILON);
        check(Matrix::from_fn(40, 40, turned), f64::EPSILON);
        check(Matrix::from_fn(40, 40, |i, j| Complex::<Dd>::from(turned(i, j))), Dd::EPSILON);
    }

    /// 2 * 3 - 1 * 4 with rows as they are and exchanged.
    #[test]
    fn a_determinant_has_its_sign() {
        let determinant =
            |rows: [[f64; 2]; 2]| Lu::of(Matrix::from_fn(2, 2, |i, j| rows[i][j])).map(|lu| lu.determinant());
        assert_eq!(determinant([[4.0, 3.0], [2.0, 1.0]]), Some(-2.0));
        assert_eq!(determinant([[2.0, 1.0], [4.0, 3.0]]), Some(2.0));
        assert_eq!(determinant([[2.0, 1.0], [4.0, 2.0]]), None);
    }

    #[test]
    fn singular_and_infinite_matrices_are_refused() {
        let singular = Matrix::from_fn(3, 3, |i, j| Dd::from((i + j) as f64));
        assert!(Lu::of(singular.clone()).is_none() && inverse(singular).is_none());
        for bad in [f64::NAN, f64::INFINITY] {
            let a = Matrix::from_fn(2, 2, |i, j| if i + j == 2 { bad } else { 1.0 + i as f64 });
            assert!(Lu::of(a.clone()).is_none() && Lu::nearly_singular(a).is_none());
        }
    }

    /// Inverse iteration finds the null vector of a singular matrix.
    #[test]
    fn a_singular_matrix_gives_its_null_vector() {
        let a = Matrix::from_fn(3, 3, |i, j| {
            Complex::real([[2.0, -1.0, -1.0], [-1.0, 2.0, -1.0], [-1.0, -1.0, 2.0]][i][j])
        });
        let mut x = vec![Complex::real(1.0), Complex::real(0.5), Complex::real(0.25)];
        Lu::nearly_singular(a).expect("finite").solve(&mut x);
        assert!(x.iter().all(|z| (*z * x[0].recip() - Complex::real(1.0)).abs() < 1e-12), "{x:?}");
    }
}
