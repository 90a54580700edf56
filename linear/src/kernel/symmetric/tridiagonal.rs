//! Reduction of a symmetric matrix to tridiagonal form by reflections, Q^T A Q = T, and application of Q to vectors.
//!
//! A reflection is 1 - tau v v^T. Those of a panel of columns are collected, so that half of the work is products of
//! matrices (Dongarra, Hammarling and Sorensen, J. Comput. Appl. Math. 27 (1989) 215; LAPACK's `dsytrd`), and a panel's
//! product is 1 - V T V^T (Schreiber and Van Loan, SIAM J. Sci. Stat. Comput. 10 (1989) 53). Only the lower triangle is
//! read.

use crate::kernel::dense::Matrix;
use crate::kernel::dense::product::{View, add_product, product};
use crate::kernel::simd::{Eight, LANES, each, simd};

/// Number of columns in a panel.
pub const PANEL: usize = 64;
/// Columns of the lower triangle that are updated at once; above the diagonal that is wasted work.
const STRIP: usize = 256;

/// T and the reflections of Q.
pub struct Reduced {
    pub diagonal: Vec<f64>,
    /// The entries beside the diagonal.
    pub beside: Vec<f64>,
    /// v of reflection j, zero up to row j and one in the next, in column j.
    reflections: Matrix<f64>,
    factors: Vec<f64>,
}

/// Reduces the matrix to T and Q.
pub fn reduce(mut a: Matrix<f64>) -> Reduced {
    let n = a.columns();
    let (mut beside, mut factors) = (vec![0.0; n.saturating_sub(1)], vec![0.0; n.saturating_sub(1)]);
    let mut diagonal = vec![0.0; n];
    let mut start = 0;
    while start + 1 < n {
        let end = (start + PANEL).min(n - 1);
        let panel = reduce_panel(&mut a, start..end, &mut beside, &mut factors, &mut diagonal);
        panel.subtract_from(&mut a, end);
        start = end;
    }
    if n > 0 {
        diagonal[n - 1] = a[(n - 1, n - 1)];
    }
    Reduced { diagonal, beside, reflections: a, factors }
}

/// The reflections of a panel so far. V W^T + W V^T, whose rows begin at the panel's first, is still to be subtracted from the
/// matrix.
pub struct Panel {
    pub v: Matrix<f64>,
    pub w: Matrix<f64>,
    /// The number of reflections.
    done: usize,
}

impl Panel {
    /// An empty panel for a matrix of so many rows.
    pub fn new(rows: usize, columns: usize) -> Panel {
        let empty = || Matrix::fill_with(rows, columns, 0.0);
        Panel { v: empty(), w: empty(), done: 0 }
    }

    /// Subtracts what is still to be subtracted from the next column, whose entries begin at the diagonal.
    pub fn bring_up_to_date(&self, column: &mut [f64]) {
        let Panel { v, w, done } = self;
        for p in 0..*done {
            add_scaled(column, -w[(*done, p)], &v.column(p)[*done..]);
            add_scaled(column, -v[(*done, p)], &w.column(p)[*done..]);
        }
    }

    /// Takes in the reflection 1 - factor J x x^T from the left and from the right, with J x in `signed`. The matrix has n
    /// columns, and those of the reflection begin at `first`.
    pub fn reflect(&mut self, a: &[f64], (n, first): (usize, usize), x: &[f64], signed: &[f64], factor: f64) {
        let Panel { v, w, done } = self;
        let mut image = vec![0.0; x.len()];
        multiply_lower(a, (n, first), signed, &mut image);
        for p in 0..*done {
            let (v, w) = (&v.column(p)[*done + 1..], &w.column(p)[*done + 1..]);
            let (along_w, along_v) = (dot(w, signed), dot(v, signed));
            add_scaled(&mut image, -along_w, v);
            add_scaled(&mut image, -along_v, w);
        }
        image.iter_mut().for_each(|x| *x *= factor);
        let along = -0.5 * factor * dot(&image, signed);
        add_scaled(&mut image, along, x);
        v.column_mut(*done)[*done + 1..].copy_from_slice(x);
        w.column_mut(*done)[*done + 1..].copy_from_slice(&image);
        *done += 1;
    }

    /// Subtracts V W^T + W V^T of all reflections from the rest of the matrix, from row and column `end` on.
    pub fn subtract_from(&self, a: &mut Matrix<f64>, end: usize) {
        let Panel { v, w, done } = self;
        let (n, width) = (a.columns(), v.columns());
        let joined = |a: &Matrix<f64>, b: &Matrix<f64>| {
            let column = |j: usize| if j < width { a.column(j) } else { b.column(j - width) };
            Matrix::from_fn(n - end, 2 * width, |i, j| column(j)[done + i])
        };
        let (left, right) = (joined(v, w), joined(w, v));
        for strip in (end..n).step_by(STRIP) {
            let (rows, columns, from) = (n - strip, STRIP.min(n - strip), strip - end);
            let left = View::of(&left).part((from, 0), (rows, 2 * width));
            let right = View::of(&right).part((from, 0), (columns, 2 * width));
            add_product(&mut a.data_mut()[strip * n + strip..], n, -1.0, left, right.transpose());
        }
    }
}

/// Reduces the columns of a panel.
fn reduce_panel(
    a: &mut Matrix<f64>,
    columns: std::ops::Range<usize>,
    beside: &mut [f64],
    factors: &mut [f64],
    diagonal: &mut [f64],
) -> Panel {
    let n = a.columns();
    let mut panel = Panel::new(n - columns.start, columns.len());
    for j in columns {
        let column = &mut a.column_mut(j)[j..];
        panel.bring_up_to_date(column);
        diagonal[j] = column[0];
        let (factor, value) = reflection(&mut column[1..]);
        (factors[j], beside[j]) = (factor, value);
        let normal = column[1..].to_vec();
        panel.reflect(a.data(), (n, j + 1), &normal, &normal, factor);
    }
    panel
}

/// Reflects x onto its first axis: replaces x by v with v_0 = 1; returns tau and the first entry of the image.
fn reflection(x: &mut [f64]) -> (f64, f64) {
    let largest = x.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    if x[1..].iter().all(|&x| x == 0.0) || !largest.is_finite() {
        let value = x[0];
        x[0] = 1.0;
        return (0.0, value);
    }
    // A power of two, so that squares stay within range without rounding.
    let scale = f64::from_bits(largest.to_bits() & f64::INFINITY.to_bits());
    x.iter_mut().for_each(|x| *x /= scale);
    let length = dot(x, x).sqrt();
    let image = if x[0] > 0.0 { -length } else { length };
    let (factor, divisor) = ((image - x[0]) / image, x[0] - image);
    x.iter_mut().for_each(|x| *x /= divisor);
    x[0] = 1.0;
    (factor, image * scale)
}

impl Reduced {
    /// Z <- Q Z
    pub fn turn(&self, z: &mut Matrix<f64>) {
        let n = self.diagonal.len();
        let panels = (0..self.factors.len()).step_by(PANEL).rev();
        for start in panels {
            let end = (start + PANEL).min(self.factors.len());
            let v = Matrix::from_fn(n - start - 1, end - start, |i, j| match i < j {
                true => 0.0,
                false => self.reflections[(start + 1 + i, start + j)],
            });
            let t = self.triangle(&v, start);
            let rows = View::of(z).part((start + 1, 0), (n - start - 1, z.columns()));
            let along = product(View::of(&v).transpose(), rows);
            let along = product(View::of(&t), View::of(&along));
            add_product(&mut z.data_mut()[start + 1..], n, -1.0, View::of(&v), View::of(&along));
        }
    }

    /// T of the panel's product 1 - V T V^T.
    fn triangle(&self, v: &Matrix<f64>, start: usize) -> Matrix<f64> {
        let width = v.columns();
        let mut t = Matrix::fill_with(width, width, 0.0);
        let squares = product(View::of(v).transpose(), View::of(v));
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

simd! {
    /// a . b, in four times eight lanes.
    pub fn dot<V: Eight>(a: &[f64], b: &[f64]) -> f64 {
        let mut sums = [V::splat(0.0); 4];
        let length = a.len().min(b.len());
        let whole = length / (4 * LANES) * (4 * LANES);
        let mut rest = 0.0_f64;
        for i in whole..length {
            rest = a[i].mul_add(b[i], rest);
        }
        for i in (0..whole).step_by(4 * LANES) {
            let (a, b) = (&a[i..i + 4 * LANES], &b[i..i + 4 * LANES]);
            for l in 0..4 {
                sums[l] = V::load(&a[l * LANES..]).mul_add(V::load(&b[l * LANES..]), sums[l]);
            }
        }
        (sums[0] + sums[1] + (sums[2] + sums[3])).sum() + rest
    }
}

simd! {
    /// y <- y + f x
    pub fn add_scaled<V: Eight>(y: &mut [f64], f: f64, x: &[f64]) {
        let length = y.len().min(x.len());
        let (y, x) = (&mut y[..length], &x[..length]);
        let whole = length / LANES * LANES;
        for i in (0..whole).step_by(LANES) {
            V::splat(f).mul_add(V::load(&x[i..]), V::load(&y[i..])).store(&mut y[i..]);
        }
        for i in whole..length {
            y[i] = f.mul_add(x[i], y[i]);
        }
    }
}

simd! {
    /// y = A x for the symmetric matrix whose lower triangle starts at row and column `from` of the n x n numbers.
    pub fn multiply_lower<V: Eight>(a: &[f64], at: (usize, usize), x: &[f64], y: &mut [f64]) {
        multiply_lower_as::<V>(a, at, x, y);
    }
}

/// Number of columns that are read in parallel.
const ABREAST: usize = 4;

#[inline(always)]
fn multiply_lower_as<V: Eight>(a: &[f64], (n, from): (usize, usize), x: &[f64], y: &mut [f64]) {
    let m = n - from;
    for j in (0..m).step_by(ABREAST) {
        let width = ABREAST.min(m - j);
        let columns: [&[f64]; ABREAST] = each(|c| match c < width {
            true => &a[(from + j + c) * n + from + j..(from + j + c + 1) * n],
            false => &[],
        });
        // The square block on the diagonal.
        for c in 0..width {
            y[j + c] = columns[c][c].mul_add(x[j + c], y[j + c]);
            for r in c + 1..width {
                y[j + r] = columns[c][r].mul_add(x[j + c], y[j + r]);
                y[j + c] = columns[c][r].mul_add(x[j + r], y[j + c]);
            }
        }
        if width == ABREAST && j + width < m {
            let below = each(|c| &columns[c][ABREAST..]);
            let factors = each(|c| x[j + c]);
            let sums = multiply_strip::<V>(below, factors, &x[j + width..], &mut y[j + width..]);
            (0..ABREAST).for_each(|c| y[j + c] += sums[c]);
        }
    }
}

/// y <- y + columns f; columns^T x.
#[inline(always)]
fn multiply_strip<V: Eight>(columns: [&[f64]; ABREAST], f: [f64; ABREAST], x: &[f64], y: &mut [f64]) -> [f64; ABREAST] {
    let rows = y.len();
    let (x, columns): (_, [&[f64]; ABREAST]) = (&x[..rows], each(|c| &columns[c][..rows]));
    let wide: [V; ABREAST] = each(|c| V::splat(f[c]));
    let mut sums = [V::splat(0.0); ABREAST];
    let whole = rows / LANES * LANES;
    for i in (0..whole).step_by(LANES) {
        let (input, mut output) = (V::load(&x[i..i + LANES]), V::load(&y[i..i + LANES]));
        for c in 0..ABREAST {
            let entry = V::load(&columns[c][i..i + LANES]);
            output = entry.mul_add(wide[c], output);
            sums[c] = entry.mul_add(input, sums[c]);
        }
        output.store(&mut y[i..i + LANES]);
    }
    let mut sums = sums.map(Eight::sum);
    for i in whole..rows {
        for c in 0..ABREAST {
            y[i] = columns[c][i].mul_add(f[c], y[i]);
            sums[c] = columns[c][i].mul_add(x[i], sums[c]);
        }
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_reflections_bring_the_matrix_back() {
        for n in [1, 2, 3, 9, 150] {
            let entry = |i: usize, j: usize| (((i * j + 3 * (i + j)) * 53) % 101) as f64 - 50.0;
            let a = Matrix::from_fn(n, n, entry);
            let reduced = reduce(a.clone());
            let t = |i: usize, j: usize| match i.abs_diff(j) {
                0 => reduced.diagonal[i],
                1 => reduced.beside[i.min(j)],
                _ => 0.0,
            };
            // A = Q T Q^T = Q (Q T)^T.
            let mut half = Matrix::from_fn(n, n, t);
            reduced.turn(&mut half);
            let mut whole = Matrix::from_fn(n, n, |i, j| half[(j, i)]);
            reduced.turn(&mut whole);
            for i in 0..n {
                for j in 0..n {
                    let error = (whole[(i, j)] - a[(i, j)]).abs();
                    assert!(error <= 50.0 * n as f64 * 8.0 * f64::EPSILON, "{n}: {i} {j} {error}");
                }
            }
        }
    }
}
