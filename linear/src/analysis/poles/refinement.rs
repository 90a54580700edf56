//! Refinement of a pole and its vector from a rough start: Newton's method for Q(s) x = 0, b^H x = const, with
//! residuals of the terms in double-double and corrections from one binary64 factorisation in the coordinates of the
//! undamped modes (extra-precise refinement: Demmel et al., ACM TOMS 32 (2006) 325; bordering: Keller 1977). In:
//! pencil, basis, start. Out: s and x in double-double; the discs determine how accurate they are. See
//! docs/method/poles.md#general-systems.

use crate::analysis::poles::companion::Basis;
use crate::analysis::poles::pencil::{Application, Pencil, Vector};
use crate::base::Dd;
use crate::kernel::complex::Complex;
use crate::kernel::dense::Matrix;
use crate::kernel::dense::lu::Lu;

/// An approximate pole and its vector, taken as exact numbers.
#[derive(Clone, Debug)]
pub struct Pair {
    pub s: Complex<Dd>,
    pub x: Vector,
}

impl Pair {
    pub fn is_real(&self) -> bool {
        self.x.is_real()
    }
}

/// A smaller correction is rounding error: 2^-103.
pub const SETTLED: f64 = 1e-31;
/// From a good start each step gains at least ten digits; the limit allows for bad starts.
const MOST_STEPS: usize = 24;

/// Refines one start; `seed` selects a pseudo-random first vector, so that equal starts find different vectors. `None`
/// if the result is not finite.
pub fn refine(pencil: &Pencil<Dd>, basis: &Basis, start: Complex<f64>, seed: usize) -> Option<Pair> {
    let real = start.im == 0.0;
    let mut y = inverse_iteration(basis, start, seed)?;
    let mut pair = Pair { s: start.into(), x: expand(basis, &y, real) };
    let mut newton = Newton::at(basis, start, &y)?;
    let mut last = f64::INFINITY;
    for _ in 0..MOST_STEPS {
        let (dy, ds) = newton.step(residual(pencil, basis, &pair))?;
        apply_step(basis, &mut pair, &mut y, &dy, ds);
        let s = pair.s.to_f64();
        let size = (ds.abs() / s.abs()).max(norm(&dy) / norm(&y));
        if !size.is_finite() {
            return None;
        }
        if size < SETTLED || (size < 1e-20 && size > 0.25 * last) {
            break;
        }
        // A start with few digits is worth a new factorisation; a good one converges without it.
        if size > 1e-6 {
            newton = Newton::at(basis, s, &y)?;
        }
        last = size;
    }
    // Rounding leaves a real pole slightly off the axis if the iteration came from beside it.
    let off_axis = pair.s.im.to_f64().abs();
    if !real && off_axis < 1e-18 * pair.s.to_f64().abs() {
        return refine(pencil, basis, Complex::real(pair.s.re.to_f64()), seed);
    }
    balance_energies(pencil, &mut pair);
    Some(pair)
}

/// s <- s - x^T Q(s) x / x^T Q'(s) x, the Rayleigh quotient. The energies of stiff springs that hardly stretch are
/// small of second order, so a slow pole among fast ones gets all its digits; with the forces of those springs, they
/// would be lost.
pub fn balance_energies(pencil: &Pencil<Dd>, pair: &mut Pair) {
    let applied = pencil.apply(pair.s, &pair.x);
    let slope = pencil.slope(pair.s.to_f64(), &applied);
    let step = -(applied.energy.to_f64() * slope.recip());
    // Near a double pole the slope vanishes and the quotient is meaningless.
    if step.one_norm() < 1e-10 * pair.s.to_f64().one_norm() {
        pair.s = pair.s + step.into();
    }
}

/// x = Phi y, in double-double.
fn expand(basis: &Basis, y: &[Complex<f64>], real: bool) -> Vector {
    let mut x = Vector::zeros(basis.shapes.rows(), real);
    for (j, y) in y.iter().enumerate() {
        for (i, &entry) in basis.shapes.column(j).iter().enumerate() {
            x.re[i] += Dd::product(entry, y.re);
            if !real {
                x.im[i] += Dd::product(entry, y.im);
            }
        }
    }
    x
}

fn apply_step(basis: &Basis, pair: &mut Pair, y: &mut [Complex<f64>], dy: &[Complex<f64>], ds: Complex<f64>) {
    for i in 0..pair.x.re.len() {
        let step = (0..dy.len()).fold(Complex::ZERO, |sum, j| sum + dy[j].scale(basis.shapes[(i, j)]));
        pair.x.add(i, step);
    }
    y.iter_mut().zip(dy).for_each(|(y, d)| *y = *y + *d);
    pair.s = pair.s + ds.into();
    if pair.is_real() {
        pair.s.im = Dd::ZERO;
    }
}

pub fn norm(y: &[Complex<f64>]) -> f64 {
    y.iter().map(|z| z.one_norm()).fold(0.0, f64::max)
}

/// Phi^T Q(s) Phi = s^2 + C~ s + Omega^2, with the rows of free motions, which are just s^2, divided by s^2 and those
/// of dragged ones by s: the equations become N^T M x = 0 and N^T (s M + C) x = 0, without the forces of springs.
fn modal(basis: &Basis, s: Complex<f64>, i: usize, j: usize) -> Complex<f64> {
    let (unit, damping) = (if i == j { 1.0 } else { 0.0 }, basis.damping[(i, j)]);
    if i < basis.free {
        return Complex::real(unit);
    }
    if i < basis.rigid() {
        return s.scale(unit) + Complex::real(damping);
    }
    (s * s + Complex::real(basis.omega_squared[i])).scale(unit) + s.scale(damping)
}

/// The derivative of `modal` with respect to s, times y.
fn modal_slope(basis: &Basis, s: Complex<f64>, y: &[Complex<f64>], i: usize) -> Complex<f64> {
    if i < basis.free {
        return Complex::ZERO;
    }
    if i < basis.rigid() {
        return y[i];
    }
    let damped = y.iter().enumerate().fold(Complex::ZERO, |sum, (j, y)| sum + y.scale(basis.damping[(i, j)]));
    s.scale(2.0) * y[i] + damped
}

/// Phi^T Q(s) x, rows divided as in `modal`.
fn residual(pencil: &Pencil<Dd>, basis: &Basis, pair: &Pair) -> Vec<Complex<f64>> {
    let applied = pencil.apply(pair.s, &pair.x);
    let force: Vec<Complex<f64>> = applied.force.iter().map(|z| z.to_f64()).collect();
    let of_row = |j: usize| match rigid_residual(basis, pair.s, &applied, j) {
        Some(residual) => residual,
        None => basis.shapes.column(j).iter().zip(&force).fold(Complex::ZERO, |sum, (&a, &f)| sum + f.scale(a)),
    };
    (0..basis.n()).map(of_row).collect()
}

/// The row of a rigid motion, from inertia and dampers only; `None` for the other modes.
pub fn rigid_residual(basis: &Basis, s: Complex<Dd>, applied: &Application<Dd>, row: usize) -> Option<Complex<f64>> {
    if row < basis.free {
        return Some(weighted_sum(&basis.rigid_inertia[row], &applied.m_stretch).to_f64());
    }
    let drag = basis.rigid_drag.get(row)?;
    let inertia = weighted_sum(&basis.rigid_inertia[row], &applied.m_stretch);
    Some((s * inertia + weighted_sum(drag, &applied.c_stretch)).to_f64())
}

/// sum factor_t stretch_t
fn weighted_sum(factors: &[Dd], stretches: &[Complex<Dd>]) -> Complex<Dd> {
    factors.iter().zip(stretches).fold(Complex::ZERO, |sum, (&f, t)| sum + t.scale(f))
}

/// Two steps of inverse iteration from a pseudo-random vector (a smooth one may be orthogonal to the wanted one). No
/// pole except zero moves a free motion.
fn inverse_iteration(basis: &Basis, s: Complex<f64>, seed: usize) -> Option<Vec<Complex<f64>>> {
    let n = basis.n();
    let factors = Lu::nearly_singular(Matrix::from_fn(n, n, |i, j| modal(basis, s, i, j)))?;
    let mut y: Vec<Complex<f64>> = (0..n).map(|i| Complex::real(scrambled_number(i + 977 * seed))).collect();
    for _ in 0..2 {
        y[..basis.free].fill(Complex::ZERO);
        factors.solve(&mut y);
        let size = norm(&y);
        if !(size.is_finite() && size > 0.0) {
            return None;
        }
        y.iter_mut().for_each(|z| *z = z.scale(1.0 / size));
    }
    Some(y)
}

/// Pseudo-random numbers between 1/2 and 3/2: the fractional parts of multiples of the golden ratio.
pub fn scrambled_number(i: usize) -> f64 {
    let x = (i + 1) as f64 * 0.618_033_988_749_894_9;
    0.5 + (x - x.floor())
}

/// The factored bordered matrix [Q(s), Q'(s) y; y^H, 0].
struct Newton {
    factors: Lu<Complex<f64>>,
}

impl Newton {
    fn at(basis: &Basis, s: Complex<f64>, y: &[Complex<f64>]) -> Option<Newton> {
        let n = basis.n();
        let matrix = Matrix::from_fn(n + 1, n + 1, |i, j| match (i == n, j == n) {
            (false, false) => modal(basis, s, i, j),
            (false, true) => modal_slope(basis, s, y, i),
            (true, false) => y[j].conj(),
            (true, true) => Complex::ZERO,
        });
        Some(Newton { factors: Lu::nearly_singular(matrix)? })
    }

    /// The corrections of y and s for a residual Phi^T Q(s) x.
    fn step(&self, mut residual: Vec<Complex<f64>>) -> Option<(Vec<Complex<f64>>, Complex<f64>)> {
        residual.iter_mut().for_each(|r| *r = -*r);
        residual.push(Complex::ZERO);
        self.factors.solve(&mut residual);
        let ds = residual.pop()?;
        Some((residual, ds))
    }
}
