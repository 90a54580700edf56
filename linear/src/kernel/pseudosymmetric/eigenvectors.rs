//! The eigenvectors of a tridiagonal pencil T - s J for known eigenvalues: elimination from both ends up to the row
//! where the two pivots agree best, and the vector with a one in that row (Dhillon and Parlett, SIAM J. Matrix Anal. 25
//! (2004) 858, for J = 1).

use crate::kernel::complex::Complex;
use crate::kernel::dense::Matrix;
use crate::kernel::lanes::Pair;
use crate::kernel::pseudosymmetric::Tridiagonal;
use crate::kernel::simd::{MOST, Vector, each, simd};

/// Real and imaginary parts of the vectors, a column for each eigenvalue.
pub fn eigenvectors(pencil: &Tridiagonal, values: &[Complex<f64>]) -> (Matrix<f64>, Matrix<f64>) {
    let n = pencil.diagonal.len();
    let (mut re, mut im) = (Matrix::fill_with(n, values.len(), 0.0), Matrix::fill_with(n, values.len(), 0.0));
    side_by_side(pencil, values, &mut re, &mut im);
    (re, im)
}

simd! {
    fn side_by_side<V: Vector>(
        pencil: &Tridiagonal,
        values: &[Complex<f64>],
        re: &mut Matrix<f64>,
        im: &mut Matrix<f64>
    ) {
        let mut down = Vec::new();
        for (block, chunk) in values.chunks(V::WIDTH).enumerate() {
            let lane = |i: usize| chunk[i.min(chunk.len() - 1)];
            let s = Pair {
                re: V::load(&each::<f64, MOST>(|i| lane(i).re)),
                im: V::load(&each::<f64, MOST>(|i| lane(i).im)),
            };
            let up = pivots(pencil, s, &mut down);
            for (l, value) in chunk.iter().enumerate() {
                let at = |list: &[Pair<[f64; MOST]>], i: usize| Complex::new(list[i].re[l], list[i].im[l]);
                let column = block * V::WIDTH + l;
                twisted_vector(pencil, *value, |i| at(&down, i), |i| at(&up, i), re.column_mut(column), im.column_mut(column));
            }
        }
    }
}

/// The reciprocals of the pivots of T - s J from the first row on (into `down`), and from the last row on.
#[inline(always)]
fn pivots<V: Vector>(pencil: &Tridiagonal, s: Pair<V>, down: &mut Vec<Pair<[f64; MOST]>>) -> Vec<Pair<[f64; MOST]>> {
    let n = pencil.diagonal.len();
    let step = |i: usize, beside: f64, inverse: Pair<V>| {
        let (d, sign, square) = (V::splat(pencil.diagonal[i]), V::splat(pencil.signs[i]), V::splat(beside * beside));
        let pivot = Pair { re: d - sign * s.re - square * inverse.re, im: -(sign * s.im) - square * inverse.im };
        Pair { re: pivot.re + V::splat(f64::MIN_POSITIVE), im: pivot.im }.recip()
    };
    let stored = |inverse: Pair<V>| Pair { re: inverse.re.to_array(), im: inverse.im.to_array() };
    down.clear();
    let mut inverse = Pair::zero();
    for i in 0..n {
        inverse = step(i, if i > 0 { pencil.beside[i - 1] } else { 0.0 }, inverse);
        down.push(stored(inverse));
    }
    let mut up = vec![stored(Pair::zero()); n];
    let mut inverse = Pair::zero();
    for i in (0..n).rev() {
        inverse = step(i, if i + 1 < n { pencil.beside[i] } else { 0.0 }, inverse);
        up[i] = stored(inverse);
    }
    up
}

/// The vector of one eigenvalue from the reciprocals of both lists of pivots.
#[inline(always)]
fn twisted_vector(
    pencil: &Tridiagonal,
    s: Complex<f64>,
    down: impl Fn(usize) -> Complex<f64>,
    up: impl Fn(usize) -> Complex<f64>,
    re: &mut [f64],
    im: &mut [f64],
) {
    let n = pencil.diagonal.len();
    // The pivot of the row that is eliminated last.
    let last = |i: usize| {
        let above = if i > 0 { down(i - 1).scale(pencil.beside[i - 1] * pencil.beside[i - 1]) } else { Complex::ZERO };
        let below = if i + 1 < n { up(i + 1).scale(pencil.beside[i] * pencil.beside[i]) } else { Complex::ZERO };
        Complex::real(pencil.diagonal[i]) - s.scale(pencil.signs[i]) - above - below
    };
    let (mut twist, mut least) = (0, f64::INFINITY);
    for i in 0..n {
        let size = last(i).one_norm();
        if size < least {
            (twist, least) = (i, size);
        }
    }
    let mut set = |i: usize, z: Complex<f64>| (re[i], im[i]) = (z.re, z.im);
    set(twist, Complex::real(1.0));
    let mut y = Complex::real(1.0);
    for i in (0..twist).rev() {
        y = (down(i) * y).scale(-pencil.beside[i]);
        set(i, y);
    }
    let mut y = Complex::real(1.0);
    for i in twist + 1..n {
        y = (up(i) * y).scale(-pencil.beside[i - 1]);
        set(i, y);
    }
}
