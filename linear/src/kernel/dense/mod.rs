//! Dense matrices stored by columns, and the few kernels that all dense computations use, in binary64 and in
//! double-double.
//!
//! The algorithms here work on columns (rotations of pairs, Gram products, modes), so a column is a slice.

pub mod cholesky;
pub mod echelon;
pub mod enclosure;
pub mod inverse_factor;
pub mod jacobi;
pub mod lu;
pub mod pivoted_qr;
pub mod product;

use crate::base::Dd;
use crate::kernel::real::Float;
pub use crate::kernel::real::dot;
use crate::kernel::simd::simd;
use std::ops::{Index, IndexMut};

/// A matrix whose columns are contiguous; `m[(row, column)]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Matrix<T> {
    rows: usize,
    columns: usize,
    data: Vec<T>,
}

impl<T: Copy> Matrix<T> {
    pub fn fill_with(rows: usize, columns: usize, value: T) -> Matrix<T> {
        Matrix { rows, columns, data: vec![value; rows * columns] }
    }

    /// The matrix of `entry(row, column)`.
    pub fn from_fn(rows: usize, columns: usize, mut entry: impl FnMut(usize, usize) -> T) -> Matrix<T> {
        let mut data = Vec::with_capacity(rows * columns);
        for j in 0..columns {
            data.extend((0..rows).map(|i| entry(i, j)));
        }
        Matrix { rows, columns, data }
    }

    #[inline]
    pub fn rows(&self) -> usize {
        self.rows
    }

    #[inline]
    pub fn columns(&self) -> usize {
        self.columns
    }

    #[inline]
    pub fn column(&self, j: usize) -> &[T] {
        &self.data[j * self.rows..(j + 1) * self.rows]
    }

    #[inline]
    pub fn column_mut(&mut self, j: usize) -> &mut [T] {
        &mut self.data[j * self.rows..(j + 1) * self.rows]
    }

    /// All columns, one after the other.
    #[inline]
    pub fn data(&self) -> &[T] {
        &self.data
    }

    #[inline]
    pub fn data_mut(&mut self) -> &mut [T] {
        &mut self.data
    }

    /// Two different columns at once, p < q.
    #[inline]
    pub fn column_pair(&mut self, p: usize, q: usize) -> (&mut [T], &mut [T]) {
        let (head, tail) = self.data.split_at_mut(q * self.rows);
        (&mut head[p * self.rows..(p + 1) * self.rows], &mut tail[..self.rows])
    }

    pub fn swap_columns(&mut self, p: usize, q: usize) {
        if p != q {
            let (a, b) = self.column_pair(p.min(q), p.max(q));
            a.swap_with_slice(b);
        }
    }

    pub fn swap_rows(&mut self, p: usize, q: usize) {
        self.data.chunks_exact_mut(self.rows).for_each(|column| column.swap(p, q));
    }

    /// The columns in the order given.
    pub fn select_columns(&self, order: &[usize]) -> Matrix<T> {
        let mut data = Vec::with_capacity(self.rows * order.len());
        for &j in order {
            data.extend_from_slice(self.column(j));
        }
        Matrix { rows: self.rows, columns: order.len(), data }
    }

    /// The rows in the order given.
    pub fn select_rows(&self, order: &[usize]) -> Matrix<T> {
        Matrix::from_fn(order.len(), self.columns, |i, j| self[(order[i], j)])
    }

    /// Each entry through `f`.
    pub fn map<U: Copy>(&self, f: impl FnMut(T) -> U) -> Matrix<U> {
        Matrix { rows: self.rows, columns: self.columns, data: self.data.iter().copied().map(f).collect() }
    }
}

impl<T: Copy> Index<(usize, usize)> for Matrix<T> {
    type Output = T;
    #[inline]
    fn index(&self, (i, j): (usize, usize)) -> &T {
        &self.data[j * self.rows + i]
    }
}

impl<T: Copy> IndexMut<(usize, usize)> for Matrix<T> {
    #[inline]
    fn index_mut(&mut self, (i, j): (usize, usize)) -> &mut T {
        &mut self.data[j * self.rows + i]
    }
}

impl Matrix<Dd> {
    pub fn zeros(rows: usize, columns: usize) -> Matrix<Dd> {
        Matrix::fill_with(rows, columns, Dd::ZERO)
    }

    pub fn identity(n: usize) -> Matrix<Dd> {
        Matrix::from_fn(n, n, |i, j| if i == j { Dd::ONE } else { Dd::ZERO })
    }
}

simd! {
    /// y <- y + factor x
    pub fn add_scaled(y: &mut [Dd], factor: Dd, x: &[Dd]) {
        for (y, &x) in y.iter_mut().zip(x) {
            *y += factor * x;
        }
    }
}

/// (x, y) <- (c x - s y, s x + c y)
#[inline]
pub fn rotate<T: Float>(x: &mut [T], y: &mut [T], c: T, s: T) {
    for (x, y) in x.iter_mut().zip(y) {
        let (a, b) = (*x, *y);
        *x = c * a - s * b;
        *y = s * a + c * b;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_where_the_indices_say() {
        let mut m = Matrix::from_fn(2, 3, |i, j| (10 * i + j) as f64);
        assert_eq!(m.column(2), &[2.0, 12.0]);
        m.swap_columns(2, 0);
        assert_eq!((m[(1, 0)], m[(1, 2)]), (12.0, 10.0));
        assert_eq!(m.select_columns(&[1]).column(0), &[1.0, 11.0]);
    }

    #[test]
    fn a_rotation_keeps_lengths() {
        let (mut x, mut y) = ([Dd::from(3.0)], [Dd::from(4.0)]);
        let (c, s) = (Dd::from(3.0) / Dd::from(5.0), Dd::from(4.0) / Dd::from(5.0));
        rotate(&mut x, &mut y, c, s);
        assert!((dot(&x, &x) + dot(&y, &y) - Dd::from(25.0)).abs().to_f64() < 1e-29);
    }
}
