//! C <- C + f A B of dense matrices in binary64, at the full multiplication rate of the processor, with the same result
//! on every processor.
//!
//! Panels of A and B are packed so that the innermost loop reads memory sequentially (Goto and van de Geijn, ACM Trans.
//! Math. Softw. 34 (2008) 12). However the work is divided, an entry of C is the sum over blocks of [`DEPTH`] products,
//! each block one chain of fused multiply-adds from zero, in the order of the products: so |computed - true| <=
//! [`error`] |A| |B| for f = 1 and C = 0.

use crate::kernel::cores;
use crate::kernel::dense::Matrix;
use crate::kernel::simd::{Eight, LANES, each, simd};

/// Number of products in one chain.
const DEPTH: usize = 256;
/// Rows of A that fit into the second-level cache when packed; a multiple of every [`Eight::ROWS`].
const HEIGHT: usize = 24 * 8;
/// Columns of B that are packed at once.
const WIDTH: usize = 1024;
/// Columns of C that a kernel keeps in registers.
const COLUMNS_WIDE: usize = 8;
const COLUMNS: usize = 6;

/// So few products take less time than packing for them.
const FEW: usize = 64;

/// Products that one core does in about a millisecond.
const MOST_OF_ONE: usize = 1 << 23;
const LEAST_COLUMNS: usize = 48;

/// Bound of |computed - true| of an entry of A B, relative to the sum of its products' magnitudes, for `depth`
/// products.
pub fn error(depth: usize) -> f64 {
    let blocks = depth.div_ceil(DEPTH);
    (depth.min(DEPTH) + blocks + 2) as f64 * (1.01 * f64::EPSILON / 2.0)
}

/// A view of a matrix in a slice: entry (i, j) is at i `down` + j `across`.
#[derive(Clone, Copy)]
pub struct View<'a> {
    data: &'a [f64],
    rows: usize,
    columns: usize,
    down: usize,
    across: usize,
}

impl<'a> View<'a> {
    /// A view of columns stored `stride` numbers apart, of which the first `rows` are used.
    pub fn columns(data: &'a [f64], rows: usize, columns: usize, stride: usize) -> View<'a> {
        View { data, rows, columns, down: 1, across: stride }
    }

    pub fn of(matrix: &'a Matrix<f64>) -> View<'a> {
        View::columns(matrix.data(), matrix.rows(), matrix.columns(), matrix.rows())
    }

    /// The submatrix that begins at this row and column, with this many rows and columns.
    pub fn part(self, (row, column): (usize, usize), (rows, columns): (usize, usize)) -> View<'a> {
        if rows == 0 || columns == 0 {
            return View { rows, columns, ..self };
        }
        View { data: &self.data[row * self.down + column * self.across..], rows, columns, ..self }
    }

    pub fn transpose(self) -> View<'a> {
        View { rows: self.columns, columns: self.rows, down: self.across, across: self.down, ..self }
    }

    #[inline]
    fn at(&self, i: usize, j: usize) -> f64 {
        self.data[i * self.down + j * self.across]
    }
}

/// C <- C + f A B; C's columns are `stride` apart in `c`.
pub fn add_product(c: &mut [f64], stride: usize, f: f64, a: View, b: View) {
    debug_assert_eq!(a.columns, b.rows);
    if a.rows == 0 || b.columns == 0 || a.columns == 0 {
        return;
    }
    if a.rows * b.columns * a.columns <= FEW {
        return add_unpacked(c, stride, f, a, b);
    }
    // Fewer columns than this take less time than starting a thread does, or leave the packed rows of A unused.
    let least = MOST_OF_ONE.div_ceil(a.rows * a.columns).max(LEAST_COLUMNS);
    cores::in_columns(c, (stride, b.columns, least), |c, first, columns| {
        add_packed(c, stride, f, a, b.part((0, first), (b.rows, columns)));
    });
}

/// The same chains, one after the other.
fn add_unpacked(c: &mut [f64], stride: usize, f: f64, a: View, b: View) {
    for j in 0..b.columns {
        for i in 0..a.rows {
            let sum = (0..a.columns).fold(0.0, |sum, k| a.at(i, k).mul_add(b.at(k, j), sum));
            let c = &mut c[j * stride + i];
            *c = f.mul_add(sum, *c);
        }
    }
}

/// A B
pub fn product(a: View, b: View) -> Matrix<f64> {
    let mut c = Matrix::fill_with(a.rows, b.columns, 0.0);
    add_product(c.data_mut(), a.rows, 1.0, a, b);
    c
}

simd! {
    fn add_packed<V: Eight>(c: &mut [f64], stride: usize, f: f64, a: View, b: View) {
        add_packed_as::<V>(c, stride, f, a, b);
    }
}

#[inline(always)]
fn add_packed_as<V: Eight>(c: &mut [f64], stride: usize, f: f64, a: View, b: View) {
    let (rows, width) = (V::ROWS * LANES, if V::ROWS > 1 { COLUMNS_WIDE } else { COLUMNS });
    let (mut left, mut right) = (Vec::new(), Vec::new());
    for column in (0..b.columns).step_by(WIDTH) {
        let columns = WIDTH.min(b.columns - column);
        for depth in (0..a.columns).step_by(DEPTH) {
            let deep = DEPTH.min(a.columns - depth);
            pack(b.part((depth, column), (deep, columns)).transpose(), width, &mut right);
            for row in (0..a.rows).step_by(HEIGHT) {
                let high = HEIGHT.min(a.rows - row);
                pack(a.part((row, depth), (high, deep)), rows, &mut left);
                let c = &mut c[column * stride + row..];
                if V::ROWS > 1 {
                    add_panels::<V, 3, COLUMNS_WIDE>(c, stride, f, (high, columns, deep), &left, &right);
                } else {
                    add_panels::<V, 1, COLUMNS>(c, stride, f, (high, columns, deep), &left, &right);
                }
            }
        }
    }
}

/// Packs strips of `height` rows, one column after the other; the last strip is padded with zeros.
#[inline(always)]
fn pack(a: View, height: usize, packed: &mut Vec<f64>) {
    packed.clear();
    packed.resize(a.rows.div_ceil(height) * height * a.columns, 0.0);
    for (strip, out) in packed.chunks_exact_mut(height * a.columns).enumerate() {
        let first = strip * height;
        let rows = height.min(a.rows - first);
        if a.down == 1 {
            for (j, out) in out.chunks_exact_mut(height).enumerate() {
                let start = first + j * a.across;
                out[..rows].copy_from_slice(&a.data[start..start + rows]);
            }
        } else {
            for i in 0..rows {
                for j in 0..a.columns {
                    out[j * height + i] = a.at(first + i, j);
                }
            }
        }
    }
}

#[inline(always)]
fn add_panels<V: Eight, const R: usize, const N: usize>(
    c: &mut [f64],
    stride: usize,
    f: f64,
    (rows, columns, depth): (usize, usize, usize),
    left: &[f64],
    right: &[f64],
) {
    let high = R * LANES;
    let mut corner = [0.0; 24 * 8];
    for (j, b) in right.chunks_exact(N * depth).enumerate() {
        let width = N.min(columns - j * N);
        for (i, a) in left.chunks_exact(high * depth).enumerate() {
            let height = high.min(rows - i * high);
            let at = j * N * stride + i * high;
            let sums = chains::<V, R, N>(a, b);
            if height == high && width == N {
                for (l, sums) in sums.iter().enumerate() {
                    for (r, &sum) in sums.iter().enumerate() {
                        let c = &mut c[at + l * stride + r * LANES..][..LANES];
                        V::splat(f).mul_add(sum, V::load(c)).store(c);
                    }
                }
            } else {
                for (l, sums) in sums.iter().enumerate() {
                    for (r, &sum) in sums.iter().enumerate() {
                        sum.store(&mut corner[(l * R + r) * LANES..]);
                    }
                }
                for l in 0..width {
                    for r in 0..height {
                        let c = &mut c[at + l * stride + r];
                        *c = f.mul_add(corner[l * high + r], *c);
                    }
                }
            }
        }
    }
}

/// R vectors of eight rows times N columns: one chain of fused multiply-adds for each entry.
#[inline(always)]
fn chains<V: Eight, const R: usize, const N: usize>(a: &[f64], b: &[f64]) -> [[V; R]; N] {
    let mut sums = [[V::splat(0.0); R]; N];
    for step in 0..b.len() / N {
        let (a, b) = (&a[step * R * LANES..][..R * LANES], &b[step * N..][..N]);
        let a: [V; R] = each(|r| V::load(&a[r * LANES..]));
        for l in 0..N {
            let b = V::splat(b[l]);
            for r in 0..R {
                sums[l][r] = a[r].mul_add(b, sums[l][r]);
            }
        }
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::simd::Plain;

    fn scrambled_matrix(rows: usize, columns: usize) -> Matrix<f64> {
        Matrix::from_fn(rows, columns, |i, j| ((i * 37 + j * 101 + 7) % 97) as f64 / 48.0 - 1.0)
    }

    #[test]
    fn products_of_all_shapes_are_within_their_bound() {
        for (m, k, n) in [(1, 1, 1), (7, 300, 5), (24, 8, 8), (25, 257, 9), (200, 3, 50), (50, 600, 70)] {
            let (a, b) = (scrambled_matrix(m, k), scrambled_matrix(k, n));
            let c = product(View::of(&a), View::of(&b));
            for i in 0..m {
                for j in 0..n {
                    let terms = (0..k).map(|l| a[(i, l)] * b[(l, j)]);
                    let size: f64 = terms.clone().map(f64::abs).sum();
                    // Entries are multiples of 1/48, so sums of products in binary64 have errors of the same order.
                    assert!((c[(i, j)] - terms.sum::<f64>()).abs() <= (error(k) + k as f64 * f64::EPSILON) * size);
                }
            }
        }
    }

    #[test]
    fn transposed_parts_multiply_in_place() {
        let (a, b) = (scrambled_matrix(9, 12), scrambled_matrix(9, 7));
        let whole = product(View::of(&a).transpose(), View::of(&b));
        let mut c = Matrix::fill_with(12, 7, 1.0);
        add_product(&mut c.data_mut()[3..], 12, -2.0, View::of(&a).part((0, 3), (9, 4)).transpose(), View::of(&b));
        assert_eq!((c[(2, 3)], c[(7, 3)]), (1.0, 1.0));
        for i in 3..7 {
            assert_eq!(c[(i, 6)], (-2.0f64).mul_add(whole[(i, 6)], 1.0));
        }
    }

    /// A product that is divided among cores has the bits of its columns computed by themselves.
    #[test]
    fn the_division_among_cores_changes_no_bit() {
        let (a, b) = (scrambled_matrix(60, 600), scrambled_matrix(600, 500));
        let whole = product(View::of(&a), View::of(&b));
        for first in (0..500).step_by(125) {
            let part = product(View::of(&a), View::of(&b).part((0, first), (600, 125)));
            for j in 0..125 {
                assert_eq!(part.column(j), whole.column(first + j), "{j} after {first}");
            }
        }
    }

    #[test]
    fn every_processor_finds_the_same_bits() {
        for (m, k, n) in [(61, 531, 43), (3, 4, 5), (1, 64, 1)] {
            let (a, b) = (scrambled_matrix(m, k), scrambled_matrix(k, n));
            let here = product(View::of(&a), View::of(&b));
            let mut plain = Matrix::fill_with(m, n, 0.0);
            add_packed_as::<Plain>(plain.data_mut(), m, 1.0, View::of(&a), View::of(&b));
            assert_eq!(here, plain);
        }
    }
}
