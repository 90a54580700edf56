//! Reduction of a symmetric matrix S to tridiagonal form by transformations that keep a diagonal matrix of signs J:
//! G^T S G = T, G^T J G = J'. Then G^-1 (J S) G = J' T.
//!
//! A hyperbolic reflection is G = 1 - tau J v v^T (Rader and Steinhardt, IEEE Trans. ASSP 34 (1986) 1589); pairs of rows
//! and columns are exchanged first where the sign of the pivot has to agree with that of x^T J x (Bunse-Gerstner, Linear
//! Algebra Appl. 35 (1981) 155; Brebner and Grad, 43 (1982) 99). Panels are collected as in [`symmetric::tridiagonal`].
//!
//! [`symmetric::tridiagonal`]: crate::kernel::symmetric::tridiagonal

use crate::kernel::dense::Matrix;
use crate::kernel::dense::product::{View, add_product, product};
use crate::kernel::pseudosymmetric::Tridiagonal;
use crate::kernel::symmetric::tridiagonal::{PANEL, Panel};

/// Where |x^T J x| is less than this part of |x|^2, the largest possible pivot is taken.
const CANCELS: f64 = 0.1;
/// If it is less than this, the reduction has broken down: no digits would be left.
const BREAKDOWN: f64 = 1e-12;

/// T, J' and the transformation G.
pub struct Reduced {
    pub pencil: Tridiagonal,
    /// v of reflection j, zero up to row j and one in the next, in column j. The first row and column stand for the
    /// starting vector.
    reflections: Matrix<f64>,
    factors: Vec<f64>,
    /// J', with the sign of the first row in front.
    signs: Vec<f64>,
    /// The exchanges of rows, in the order in which they were made.
    exchanges: Vec<(usize, usize)>,
}

/// The state of a reduction.
struct Work {
    a: Matrix<f64>,
    signs: Vec<f64>,
    diagonal: Vec<f64>,
    beside: Vec<f64>,
    factors: Vec<f64>,
    exchanges: Vec<(usize, usize)>,
}

/// Reduces the pencil; the first transformation takes the vector `start` to the first axis. Only the lower triangle of
/// `s` is read. `None` if the reduction breaks down.
pub fn reduce(s: &Matrix<f64>, signs: &[f64], start: &[f64]) -> Option<Reduced> {
    let n = signs.len() + 1;
    // The starting vector is a row and a column in front of the others.
    let a = Matrix::from_fn(n, n, |i, j| match (i, j) {
        (0, 0) => 0.0,
        (i, 0) => start[i - 1],
        (0, _) => 0.0,
        (i, j) => s[(i - 1, j - 1)],
    });
    let mut work = Work {
        a,
        signs: std::iter::once(1.0).chain(signs.iter().copied()).collect(),
        diagonal: vec![0.0; n],
        beside: vec![0.0; n - 1],
        factors: vec![0.0; n - 1],
        exchanges: Vec::new(),
    };
    let mut first = 0;
    while first + 1 < n {
        let end = (first + PANEL).min(n - 1);
        let panel = work.reduce_panel(first..end)?;
        panel.subtract_from(&mut work.a, end);
        first = end;
    }
    work.diagonal[n - 1] = work.a[(n - 1, n - 1)];
    let pencil = Tridiagonal {
        diagonal: work.diagonal[1..].to_vec(),
        beside: work.beside.get(1..).unwrap_or_default().to_vec(),
        signs: work.signs[1..].to_vec(),
    };
    let Work { a: reflections, factors, signs, exchanges, .. } = work;
    Some(Reduced { pencil, reflections, factors, signs, exchanges })
}

impl Work {
    /// Reduces the columns of a panel.
    fn reduce_panel(&mut self, columns: std::ops::Range<usize>) -> Option<Panel> {
        let (n, first) = (self.a.columns(), columns.start);
        let mut panel = Panel::new(n - first, columns.len());
        for j in columns {
            let column = &mut self.a.column_mut(j)[j..];
            panel.bring_up_to_date(column);
            self.diagonal[j] = column[0];
            let pivot = j + 1 + pivot(&column[1..], &self.signs[j + 1..])?;
            if pivot > j + 1 {
                self.exchange(j + 1, pivot);
                panel.v.swap_rows(j + 1 - first, pivot - first);
                panel.w.swap_rows(j + 1 - first, pivot - first);
            }
            let signs = &self.signs[j + 1..];
            let (factor, value) = reflection(&mut self.a.column_mut(j)[j + 1..], signs);
            (self.factors[j], self.beside[j]) = (factor, value);
            let normal = self.a.column(j)[j + 1..].to_vec();
            let signed: Vec<f64> = normal.iter().zip(signs).map(|(x, sign)| x * sign).collect();
            panel.reflect(self.a.data(), (n, j + 1), &normal, &signed, factor);
        }
        Some(panel)
    }

    /// Exchanges two rows and columns, p < q, in the lower triangle, and the same rows of all reflections so far.
    fn exchange(&mut self, p: usize, q: usize) {
        let n = self.a.columns();
        for c in 0..p {
            self.a.column_mut(c).swap(p, q);
        }
        let a = self.a.data_mut();
        a.swap(p * n + p, q * n + q);
        for i in p + 1..q {
            a.swap(p * n + i, i * n + q);
        }
        let (head, tail) = a.split_at_mut(q * n);
        head[p * n + q + 1..(p + 1) * n].swap_with_slice(&mut tail[q + 1..n]);
        self.signs.swap(p, q);
        self.exchanges.push((p, q));
    }
}

/// The index of the entry to which x is reduced: its sign in J is that of x^T J x, and it is a large entry if that sum
/// cancels. `None` if it cancels altogether.
fn pivot(x: &[f64], signs: &[f64]) -> Option<usize> {
    let largest = x.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    if x[1..].iter().all(|&x| x == 0.0) {
        return Some(0);
    }
    let (mut square, mut length) = (0.0, 0.0);
    for (x, sign) in x.iter().zip(signs) {
        let x = x / largest;
        square = (x * sign).mul_add(x, square);
        length = x.mul_add(x, length);
    }
    let has_length = square.abs() > BREAKDOWN * length;
    if !has_length {
        return None;
    }
    let sign = square.signum();
    if signs[0] == sign && square.abs() > CANCELS * length {
        return Some(0);
    }
    let mut best = None;
    for (i, (x, own)) in x.iter().zip(signs).enumerate() {
        if *own == sign && best.is_none_or(|(_, size)| x.abs() > size) {
            best = Some((i, x.abs()));
        }
    }
    best.map(|(i, _)| i)
}

/// Reflects x onto its first axis: replaces x by v with v_0 = 1; returns tau and the first entry of the image. The sign of
/// x^T J x is that of the first axis.
fn reflection(x: &mut [f64], signs: &[f64]) -> (f64, f64) {
    let largest = x.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    if x[1..].iter().all(|&x| x == 0.0) || !largest.is_finite() {
        let value = x[0];
        x[0] = 1.0;
        return (0.0, value);
    }
    // A power of two, so that squares stay within range without rounding.
    let scale = f64::from_bits(largest.to_bits() & f64::INFINITY.to_bits());
    x.iter_mut().for_each(|x| *x /= scale);
    let square: f64 = x.iter().zip(signs).fold(0.0, |sum, (x, sign)| (x * sign).mul_add(*x, sum));
    let length = square.abs().sqrt();
    let image = if x[0] > 0.0 { -length } else { length };
    let (factor, divisor) = (signs[0] * (image - x[0]) / image, x[0] - image);
    x.iter_mut().for_each(|x| *x /= divisor);
    x[0] = 1.0;
    (factor, image * scale)
}

impl Reduced {
    /// Z <- G Z
    pub fn turn(&self, z: &mut Matrix<f64>) {
        let n = self.signs.len();
        debug_assert_eq!(z.rows() + 1, n);
        let rows = z.rows();
        for start in (0..self.factors.len()).step_by(PANEL).rev() {
            let end = (start + PANEL).min(self.factors.len());
            let v = Matrix::from_fn(n - start - 1, end - start, |i, j| match i < j {
                true => 0.0,
                false => self.reflections[(start + 1 + i, start + j)],
            });
            let signed = Matrix::from_fn(v.rows(), v.columns(), |i, j| v[(i, j)] * self.signs[start + 1 + i]);
            let t = self.triangle(&v, &signed, start);
            // Row i of the reduction is row i - 1 of Z.
            let below = View::of(z).part((start, 0), (rows - start, z.columns()));
            let along = product(View::of(&v).transpose(), below);
            let along = product(View::of(&t), View::of(&along));
            add_product(&mut z.data_mut()[start..], rows, -1.0, View::of(&signed), View::of(&along));
        }
        for j in 0..z.columns() {
            let column = z.column_mut(j);
            self.exchanges.iter().rev().for_each(|&(p, q)| column.swap(p - 1, q - 1));
        }
    }

    /// T of the panel's product 1 - J V T V^T (Schreiber and Van Loan, SIAM J. Sci. Stat. Comput. 10 (1989) 53).
    fn triangle(&self, v: &Matrix<f64>, signed: &Matrix<f64>, start: usize) -> Matrix<f64> {
        let width = v.columns();
        let mut t = Matrix::fill_with(width, width, 0.0);
        let squares = product(View::of(v).transpose(), View::of(signed));
        for j in 0..width {
            let factor = self.factors[start + j];
            for i in 0..j {
                let sum: f64 = (i..j).map(|l| t[(i, l)] * squares[(l, j)]).sum();
                t[(i, j)] = -factor * sum;
            }
            t[(j, j)] = factor;
        }
        t
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// G^-1 (J S) G = J' T, seen as J S G = G J' T.
    #[test]
    fn the_transformation_brings_the_matrix_back() {
        for n in [1, 2, 3, 9, 150] {
            let entry = |i: usize, j: usize| (((i * j + 3 * (i + j)) * 53) % 101) as f64 - 50.0;
            let s = Matrix::from_fn(n, n, entry);
            let signs: Vec<f64> = (0..n).map(|i| if i % 3 == 0 { 1.0 } else { -1.0 }).collect();
            let start: Vec<f64> = (0..n).map(|i| if signs[i] > 0.0 { 1.0 + i as f64 } else { 0.25 }).collect();
            let reduced = reduce(&s, &signs, &start).expect("no breakdown");
            let Tridiagonal { diagonal, beside, signs: own } = &reduced.pencil;
            let t = |i: usize, j: usize| match i.abs_diff(j) {
                0 => diagonal[i],
                1 => beside[i.min(j)],
                _ => 0.0,
            };
            let mut g = Matrix::from_fn(n, n, |i, j| if i == j { 1.0 } else { 0.0 });
            reduced.turn(&mut g);
            let mut gt = Matrix::from_fn(n, n, |i, j| own[i] * t(i, j));
            reduced.turn(&mut gt);
            let sg = product(View::of(&s), View::of(&g));
            let size = gt.data().iter().fold(0.0, |m: f64, x| m.max(x.abs()));
            for (i, (sign, own)) in signs.iter().zip(own).enumerate() {
                for j in 0..n {
                    let error = (sign * sg[(i, j)] - gt[(i, j)]).abs();
                    assert!(error <= 1e-9 * size, "{n}: {i} {j} {error} of {size}");
                    // G^T J G = J'.
                    let form: f64 = (0..n).map(|l| g[(l, i)] * signs[l] * g[(l, j)]).sum();
                    let expected = if i == j { *own } else { 0.0 };
                    let size: f64 = (0..n).map(|l| (g[(l, i)] * g[(l, j)]).abs()).sum();
                    assert!((form - expected).abs() <= 1e-9 * (1.0 + size), "{n}: {i} {j} {form}");
                }
            }
        }
    }

    /// A vector with x^T J x = 0 is not on the way to any axis.
    #[test]
    fn a_vector_without_length_is_refused() {
        let s = Matrix::from_fn(2, 2, |i, j| (i + j) as f64);
        assert!(reduce(&s, &[1.0, -1.0], &[1.0, 1.0]).is_none());
    }
}
