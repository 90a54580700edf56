//! Q in the span of the lowest undamped modes: a small dense problem whose eigenvalues are starts. In: the frame of the
//! modes. Out: rough poles. Nothing here is printed. See docs/method/poles.md#poles-followed-from-modes.

use crate::analysis::poles::targeted::frame::Frame;
use crate::analysis::poles::targeted::iteration::Start;
use crate::base::OrderBy;
use crate::kernel::complex::Complex;
use crate::kernel::dense::Matrix;
use crate::kernel::dense::lu::Lu;
use nalgebra::{DMatrix, Schur};

/// A relative imaginary part below this is rounding error.
const REAL: f64 = 1e-9;

/// The `wanted` starts of least |s| in the upper half plane; `None` if the QR method does not converge.
pub fn project(frame: &Frame, wanted: usize) -> Option<Vec<Start>> {
    let count = frame.x.len();
    // Modes are orthonormal to binary64, so M^ is the identity. Energies as in `companion`, for omega^2 > 0.
    let omega = |i: usize| frame.k[(i, i)].value.max(0.0).sqrt();
    let matrix = DMatrix::from_fn(2 * count, 2 * count, |i, j| match (i < count, j < count) {
        (true, false) if i == j - count => omega(i),
        (false, true) if i - count == j => -omega(j),
        (false, false) => -frame.c[(i - count, j - count)].value,
        _ => 0.0,
    });
    if matrix.iter().any(|x| !x.is_finite()) {
        return None;
    }
    let values = Schur::try_new(matrix, f64::EPSILON, 100 * count)?.complex_eigenvalues();
    let mut values: Vec<Complex<f64>> =
        values.iter().map(|z| Complex::new(z.re, z.im)).filter(|z| z.im > REAL * z.abs()).collect();
    values.order_by(|a, b| a.abs().total_cmp(&b.abs()).then(a.im.total_cmp(&b.im)));
    let starts = values.into_iter().take(wanted).enumerate().map(|(seed, s)| start(frame, s, seed));
    starts.collect()
}

/// The vector of an eigenvalue by two steps of inverse iteration from a pseudo-random vector.
fn start(frame: &Frame, s: Complex<f64>, seed: usize) -> Option<Start> {
    let count = frame.x.len();
    let entry = |i: usize, j: usize| {
        let inertia = if i == j { s * s + Complex::real(frame.k[(i, i)].value) } else { Complex::ZERO };
        inertia + s.scale(frame.c[(i, j)].value)
    };
    let factors = Lu::nearly_singular(Matrix::from_fn(count, count, entry))?;
    let golden = |i: usize| ((i + 1 + 977 * seed) as f64 * 0.618_033_988_749_894_9).fract() + 0.5;
    let mut y: Vec<Complex<f64>> = (0..count).map(|i| Complex::real(golden(i))).collect();
    for _ in 0..2 {
        factors.solve(&mut y);
        let largest = largest(&y);
        let scale = y[largest].recip();
        y.iter_mut().for_each(|z| *z = *z * scale);
    }
    let mut x = vec![Complex::ZERO; frame.x[0].len()];
    for (shape, &y) in frame.x.iter().zip(&y) {
        x.iter_mut().zip(shape).for_each(|(x, &shape)| *x = *x + y.scale(shape));
    }
    Some(Start { s, x, mode: largest(&y) })
}

fn largest(y: &[Complex<f64>]) -> usize {
    (1..y.len()).fold(0, |best, i| if y[i].one_norm() > y[best].one_norm() { i } else { best })
}
