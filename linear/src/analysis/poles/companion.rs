//! Rough positions of the poles: eigenvalues of the state matrix in the coordinates of the undamped modes. In: modes
//! and terms of an independent part. Out: starting values in binary64, and the basis in which they were found. Nothing
//! here is printed: refinement and discs do not depend on how they were started. See
//! docs/method/poles.md#general-systems.
//!
//! With q = Phi y, energies e_j = |omega_j| y_j and velocities v: e' = |omega| v, v' = -sgn(omega^2) |omega| e - C~ v,
//! C~ = Phi^T C Phi. Without damping that matrix is skew and perfectly scaled, whatever the stiffness ratios; the
//! scaling of Fan, Lin and Van Dooren (SIMAX 26 (2004) 252) aims at this, mode by mode.

use crate::analysis::answer::{ModeKind, Modes};
use crate::analysis::poles::pencil::Pencil;
use crate::analysis::poles::refinement::scrambled_number;
use crate::analysis::poles::rigid::RigidMotions;
use crate::analysis::poles::schur::{ComplexColumns, Eigenvalue, SchurForm};
use crate::base::{Dd, OrderBy};
use crate::kernel::complex::Complex;
use crate::kernel::dense::Matrix;
use crate::kernel::dense::product::{View, product};
use crate::kernel::pseudosymmetric;
use crate::kernel::squares::Squares;
use nalgebra::DMatrix;

/// Modes as a basis: binary64 columns, and C~ in it.
#[derive(Clone, Debug)]
pub struct Basis {
    /// Free rigid motions, then dragged ones, then the other modes.
    pub shapes: Matrix<f64>,
    pub free: usize,
    pub dragged: usize,
    /// w (a . N) of the terms of M, and of C, for each rigid motion N: the forces on it, without those of springs,
    /// which are zero.
    pub rigid_inertia: Vec<Vec<Dd>>,
    pub rigid_drag: Vec<Vec<Dd>>,
    /// omega^2, zero for rigid motions.
    pub omega_squared: Vec<f64>,
    /// Phi^T C Phi; rows of free motions are zero.
    pub damping: Matrix<f64>,
}

impl Basis {
    /// `modes` are all n modes of the part.
    pub fn of(pencil: &Pencil<Dd>, modes: &Modes, rigid: &RigidMotions) -> Basis {
        let rigid_columns = rigid_columns(pencil, rigid);
        let mut columns: Vec<Vec<f64>> =
            rigid_columns.iter().map(|column| column.iter().map(|x| x.to_f64()).collect()).collect();
        let mut omega_squared = vec![0.0; columns.len()];
        for mode in modes.list.iter().filter(|mode| mode.kind != ModeKind::Rigid) {
            columns.push(mode.shape.clone());
            omega_squared.push(mode.omega_squared.to_f64());
        }
        let shapes = Matrix::from_fn(pencil.n, columns.len(), |i, j| columns[j][i]);
        let damping = damping(pencil, &shapes, rigid.free.len());
        Basis {
            shapes,
            free: rigid.free.len(),
            dragged: rigid.dragged.len(),
            rigid_inertia: rigid_columns.iter().map(|x| forces(&pencil.m, x)).collect(),
            rigid_drag: rigid_columns.iter().map(|x| forces(&pencil.c, x)).collect(),
            omega_squared,
            damping,
        }
    }

    pub fn n(&self) -> usize {
        self.omega_squared.len()
    }

    /// The number of poles that are exactly zero.
    pub fn zeros(&self) -> usize {
        2 * self.free + self.dragged
    }

    /// The eigenvalues that are not exactly zero (one of each conjugate pair, im > 0, and the real ones), with the
    /// Schur forms from which they come.
    ///
    /// The QR method leaves errors of about 1e-16 of the largest eigenvalue. So if some are much slower than others,
    /// the slow ones are taken, as reciprocals, from the inverse of the state matrix.
    pub fn spectrum(&self) -> Spectrum {
        let fast = SchurForm::of(self.state_matrix()).map(|form| Family::of(form, None));
        let is_wide = fast.as_ref().is_none_or(Family::is_wide);
        let slow = is_wide.then(|| self.inverse_state_matrix()).flatten().and_then(|inverse| {
            let dense = Matrix::from_fn(inverse.nrows(), inverse.ncols(), |i, j| inverse[(i, j)]);
            Some(Family::of(SchurForm::of(inverse)?, Some(dense)))
        });
        match (fast, slow) {
            (Some(fast), Some(slow)) => merge_families(fast, slow),
            (Some(family), None) | (None, Some(family)) => Spectrum { families: vec![family] },
            (None, None) => Spectrum { families: Vec::new() },
        }
    }

    /// Starting values for all pairs that are not exactly zero, from the symmetry of the state matrix: with the signs J =
    /// (sgn omega^2, -1, -1) of energies and velocities, J A and J A^-1 are symmetric. `None` if the reduction breaks
    /// down.
    pub fn starts(&self) -> Option<Starts> {
        let fast = Starts::of(self.eigen(&self.state_matrix())?, false);
        if !fast.is_wide() {
            return Some(fast);
        }
        let slow = Starts::of(self.eigen(&self.inverse_state_matrix()?)?, true);
        let (taken, left) = cut(&slow.values, &fast.values)?;
        Some(slow.followed_by(taken, &fast, left))
    }

    /// The state matrix with the Schur form of it that a spectrum came from.
    pub fn state_form(&self, spectrum: Spectrum) -> Option<StateForm> {
        let family = spectrum.families.into_iter().find(|family| family.inverse.is_none())?;
        Some(StateForm { matrix: self.state_matrix(), form: family.form })
    }

    fn eigen(&self, matrix: &DMatrix<f64>) -> Option<pseudosymmetric::Eigen> {
        let n = matrix.nrows();
        let moving = self.n() - self.rigid();
        let signs: Vec<f64> = (0..n).map(|i| if i < moving { self.signed_rate(i).1 } else { -1.0 }).collect();
        let s = Matrix::from_fn(n, n, |i, j| signs[i] * matrix[(i, j)]);
        // Velocities alone, so that the vector has a length; pseudo-random, so that it has a part along each motion.
        let start: Vec<f64> = (0..n).map(|i| if i < moving { 0.0 } else { scrambled_number(i) }).collect();
        pseudosymmetric::eigen(&s, &signs, &start)
    }

    /// The number of rigid motions.
    pub fn rigid(&self) -> usize {
        self.free + self.dragged
    }

    /// |omega| of the j-th elastic mode.
    pub fn rate(&self, j: usize) -> f64 {
        self.omega_squared[self.rigid() + j].abs().sqrt()
    }

    /// |omega| and the sign of omega^2 of the j-th elastic mode.
    fn signed_rate(&self, j: usize) -> (f64, f64) {
        (self.rate(j), self.omega_squared[self.rigid() + j].signum())
    }

    /// Rows and columns: energies of the elastic modes, velocities of the dragged and of the elastic ones.
    fn state_matrix(&self) -> DMatrix<f64> {
        let (moving, velocities) = (self.n() - self.rigid(), self.n() - self.free);
        let mut matrix = DMatrix::zeros(moving + velocities, moving + velocities);
        for j in 0..moving {
            let (rate, sign) = self.signed_rate(j);
            matrix[(j, moving + self.dragged + j)] = rate;
            matrix[(moving + self.dragged + j, j)] = -sign * rate;
        }
        for i in 0..velocities {
            for j in 0..velocities {
                matrix[(moving + i, moving + j)] = -self.damping[(self.free + i, self.free + j)];
            }
        }
        matrix
    }

    /// The inverse without a general inversion: velocities v_m = |omega|^-1 f, v_d = -C_dd^-1 (g_d + C_dm v_m),
    /// energies e = -sgn |omega|^-1 (g_m + C_md v_d + C_mm v_m) for a right-hand side (f, g_d, g_m). `None` if C_dd is
    /// singular.
    fn inverse_state_matrix(&self) -> Option<DMatrix<f64>> {
        let (moving, dragged) = (self.n() - self.rigid(), self.dragged);
        let c = |i: usize, j: usize| self.damping[(self.free + i, self.free + j)];
        let c_dd = DMatrix::from_fn(dragged, dragged, c).try_inverse()?;
        let c_dm = DMatrix::from_fn(dragged, moving, |i, j| c(i, dragged + j) / self.rate(j));
        let c_mm = DMatrix::from_fn(moving, moving, |i, j| c(dragged + i, dragged + j) / self.rate(j));
        let drag = &c_dd * &c_dm;
        let mut inverse = DMatrix::zeros(2 * moving + dragged, 2 * moving + dragged);
        for i in 0..moving {
            let (rate, sign) = self.signed_rate(i);
            // C_md v_d is the transpose of C_dm, with the factor of the column undone.
            let c_md = |d: usize| c_dm[(d, i)] * rate;
            for j in 0..moving {
                let through: f64 = (0..dragged).map(|d| c_md(d) * drag[(d, j)]).sum();
                inverse[(i, j)] = -sign / rate * (c_mm[(i, j)] - through);
            }
            for j in 0..dragged {
                let through: f64 = (0..dragged).map(|d| c_md(d) * c_dd[(d, j)]).sum();
                inverse[(i, moving + j)] = sign / rate * through;
            }
            inverse[(i, moving + dragged + i)] = -sign / rate;
            inverse[(moving + dragged + i, i)] = 1.0 / rate;
        }
        for i in 0..dragged {
            for j in 0..moving {
                inverse[(moving + i, j)] = -drag[(i, j)];
            }
            for j in 0..dragged {
                inverse[(moving + i, moving + j)] = -c_dd[(i, j)];
            }
        }
        Some(inverse)
    }
}

/// The state matrix of the modes of a system, and its Schur form: a start for other computations as well.
#[derive(Clone, Debug)]
pub struct StateForm {
    matrix: DMatrix<f64>,
    form: SchurForm,
}

impl StateForm {
    /// The Schur form of a matrix that is this one but for rounding.
    pub fn of(&self, matrix: &DMatrix<f64>) -> Option<&SchurForm> {
        const ROUNDING: f64 = 1e-13;
        let largest = self.matrix.iter().fold(0.0f64, |largest, x| largest.max(x.abs()));
        let is_near = |(x, y): (&f64, &f64)| (x - y).abs() <= ROUNDING * largest;
        let is_same = self.matrix.shape() == matrix.shape() && self.matrix.iter().zip(matrix.iter()).all(is_near);
        is_same.then_some(&self.form)
    }
}

/// Eigenvalues of the state matrix in order of magnitude, in one or two families.
pub struct Spectrum {
    pub families: Vec<Family>,
}

/// Eigenvalues that come from one Schur form.
pub struct Family {
    pub form: SchurForm,
    /// The inverse of the state matrix, if the Schur form is of the inverse; its eigenvalues are then reciprocals.
    pub inverse: Option<Matrix<f64>>,
    /// Eigenvalues of the state matrix, ascending in magnitude, each with the eigenvalue of the Schur form that it
    /// comes from.
    pub list: Vec<(Complex<f64>, Eigenvalue)>,
}

/// From this ratio of rates on, the slow eigenvalues have fewer than eight digits in those of the state matrix.
const WIDE: f64 = 1e8;

/// Starting values: poles, ascending in magnitude (one of each conjugate pair, im > 0, and the real ones), and states (e,
/// v), a column for each.
pub struct Starts {
    pub values: Vec<Complex<f64>>,
    pub states: ComplexColumns,
}

/// From this ratio of rates on, hyperbolic reflections leave too few digits in the slow eigenvalues.
const STARTS_WIDE: f64 = 1e4;

impl Starts {
    /// Eigenvalues of the state matrix, or of its inverse.
    fn of(eigen: pseudosymmetric::Eigen, inverse: bool) -> Starts {
        let mut list: Vec<(Complex<f64>, usize)> = eigen.values.iter().copied().zip(0..).collect();
        if inverse {
            list.iter_mut().for_each(|(s, _)| *s = upper(s.recip()));
        }
        list.order_by(|(a, _), (b, _)| a.abs().total_cmp(&b.abs()).then(a.im.total_cmp(&b.im)));
        let order: Vec<usize> = list.iter().map(|&(_, j)| j).collect();
        let (re, mut im) = (eigen.re.select_columns(&order), eigen.im.select_columns(&order));
        if inverse {
            // The reciprocal with im > 0 belongs to the conjugate vector.
            im.data_mut().iter_mut().for_each(|x| *x = -*x);
        }
        Starts { values: list.into_iter().map(|(s, _)| s).collect(), states: ComplexColumns { re, im } }
    }

    fn is_wide(&self) -> bool {
        let size = |s: Option<&Complex<f64>>| s.map_or(1.0, |s| s.abs());
        size(self.values.last()) >= STARTS_WIDE * size(self.values.first())
    }

    /// The first `taken` of these, then those of `others` from `left` on.
    fn followed_by(&self, taken: usize, others: &Starts, left: usize) -> Starts {
        let joined = |a: &Matrix<f64>, b: &Matrix<f64>| {
            let columns = taken + b.columns() - left;
            Matrix::from_fn(a.rows(), columns, |i, j| if j < taken { a[(i, j)] } else { b[(i, left + j - taken)] })
        };
        let states = ComplexColumns {
            re: joined(&self.states.re, &others.states.re),
            im: joined(&self.states.im, &others.states.im),
        };
        Starts { values: self.values[..taken].iter().chain(&others.values[left..]).copied().collect(), states }
    }
}

impl Spectrum {
    pub fn values(&self) -> Vec<Complex<f64>> {
        self.families.iter().flat_map(|family| family.list.iter().map(|&(s, _)| s)).collect()
    }
}

impl Family {
    fn of(form: SchurForm, inverse: Option<Matrix<f64>>) -> Family {
        let own = |z: Complex<f64>| if inverse.is_some() { upper(z.recip()) } else { z };
        let mut list: Vec<_> = form.eigenvalues().into_iter().map(|found| (own(found.value), found)).collect();
        list.retain(|(s, _)| s.is_finite());
        list.order_by(|(a, _), (b, _)| a.abs().total_cmp(&b.abs()).then(a.im.total_cmp(&b.im)));
        Family { form, inverse, list }
    }

    fn is_wide(&self) -> bool {
        let size = |entry: Option<&(Complex<f64>, Eigenvalue)>| entry.map_or(1.0, |(s, _)| s.abs());
        size(self.list.last()) >= WIDE * size(self.list.first())
    }

    /// Approximate solutions z of (s_j - A) z_j = b_j, where A is the state matrix; with its inverse, (A^-1 - 1/s) z =
    /// A^-1 b / s.
    pub fn solve(&self, shifts: &[Complex<f64>], mut b: ComplexColumns) -> ComplexColumns {
        let Some(inverse) = &self.inverse else {
            let mut z = self.form.solve(shifts, &b);
            z.scale(|_| Complex::real(-1.0));
            return z;
        };
        let reciprocals: Vec<Complex<f64>> = shifts.iter().map(|s| s.recip()).collect();
        b = b.times(View::of(inverse));
        let mut z = self.form.solve(&reciprocals, &b);
        z.scale(|j| reciprocals[j]);
        z
    }

    /// A column (e, v) for each eigenvalue of the list.
    pub fn vectors(&self) -> ComplexColumns {
        let found: Vec<Eigenvalue> = self.list.iter().map(|&(_, found)| found).collect();
        let mut vectors = self.form.eigenvectors(&found);
        if self.inverse.is_some() {
            // The reciprocal with im > 0 belongs to the conjugate vector.
            vectors.im.data_mut().iter_mut().for_each(|x| *x = -*x);
        }
        vectors
    }
}

/// The one of a conjugate pair with im > 0.
fn upper(z: Complex<f64>) -> Complex<f64> {
    if z.im < 0.0 { z.conj() } else { z }
}

/// The slow eigenvalues of one list followed by the fast ones of the other, cut where the two agree best.
fn merge_families(mut fast: Family, mut slow: Family) -> Spectrum {
    let values = |family: &Family| family.list.iter().map(|&(s, _)| s).collect::<Vec<_>>();
    let Some((taken, left)) = cut(&values(&slow), &values(&fast)) else { return Spectrum { families: vec![fast] } };
    slow.list.truncate(taken);
    fast.list.drain(..left);
    Spectrum { families: vec![slow, fast] }
}

/// Where to go from the slow list to the fast one: the number of poles taken from the first, and the index of the first one
/// taken from the second, where the two agree best. `None` if their dimensions differ.
fn cut(slow: &[Complex<f64>], fast: &[Complex<f64>]) -> Option<(usize, usize)> {
    let dimension = |list: &[Complex<f64>]| list.iter().map(|&s| width(s)).sum::<usize>();
    if dimension(slow) != dimension(fast) {
        return None;
    }
    // Real eigenvalues and pairs may be distributed differently in the two lists, so positions are counted in
    // dimensions.
    let places = |list: &[Complex<f64>]| {
        let mut end = 0;
        let ends = list.iter().map(|&s| {
            end += width(s);
            end
        });
        ends.collect::<Vec<usize>>()
    };
    let (fast_ends, slow_ends) = (places(fast), places(slow));
    let apart = |i: usize, j: usize| (slow[i] - fast[j]).one_norm() / fast[j].one_norm();
    // A cut is possible where both lists have an end: after the slow eigenvalue i and the fast one j.
    let mut best = (f64::INFINITY, 0, 0);
    let mut consider = |cost: f64, taken: usize, left: usize| {
        if cost < best.0 {
            best = (cost, taken, left);
        }
    };
    if !slow.is_empty() {
        consider(apart(0, 0), 0, 0);
    }
    for (i, end) in slow_ends.iter().enumerate() {
        let Ok(j) = fast_ends.binary_search(end) else { continue };
        let next = if i + 1 < slow_ends.len() && j + 1 < fast_ends.len() { apart(i + 1, j + 1) } else { 0.0 };
        consider(apart(i, j).max(next), i + 1, j + 1);
    }
    Some((best.1, best.2))
}

/// Number of state dimensions that a list entry represents.
fn width(s: Complex<f64>) -> usize {
    if s.im == 0.0 { 1 } else { 2 }
}

/// The rigid motions made orthonormal with respect to M (Gram-Schmidt, free ones first).
fn rigid_columns(pencil: &Pencil<Dd>, rigid: &RigidMotions) -> Vec<Vec<Dd>> {
    let mut columns: Vec<Vec<Dd>> = Vec::new();
    for motion in rigid.free.iter().chain(&rigid.dragged) {
        let mut x: Vec<Dd> = motion.iter().map(|number| number.to_ball().mid).collect();
        // Twice is enough (Kahan; Parlett, The Symmetric Eigenvalue Problem, 6.9).
        for _ in 0..2 {
            for column in &columns {
                let part = inertia(pencil, column, &x);
                x.iter_mut().zip(column).for_each(|(x, &c)| *x -= part * c);
            }
        }
        let scale = inertia(pencil, &x, &x).sqrt().recip();
        x.iter_mut().for_each(|x| *x = *x * scale);
        columns.push(x);
    }
    columns
}

/// x^T M y
fn inertia(pencil: &Pencil<Dd>, x: &[Dd], y: &[Dd]) -> Dd {
    let forces = forces(&pencil.m, x);
    (0..forces.len()).fold(Dd::ZERO, |sum, t| sum + forces[t] * pencil.m.stretch_of(t, y))
}

/// w (a . x) for each term.
fn forces(squares: &Squares<Dd>, x: &[Dd]) -> Vec<Dd> {
    (0..squares.len()).map(|t| squares.weights[t] * squares.stretch_of(t, x)).collect()
}

fn dot(indices: &[u32], values: &[Dd], x: &[f64]) -> f64 {
    indices.iter().zip(values).map(|(&i, a)| a.hi * x[i as usize]).sum()
}

/// sum c (d Phi)^T (d Phi), zero where a motion is free.
fn damping(pencil: &Pencil<Dd>, shapes: &Matrix<f64>, free: usize) -> Matrix<f64> {
    let (n, terms) = (shapes.columns(), pencil.c.len());
    let stretch = |t: usize, j: usize| {
        let (indices, values) = pencil.c.row(t);
        dot(indices, values, shapes.column(free + j))
    };
    let stretches = Matrix::from_fn(terms, n - free, stretch);
    let tensions = Matrix::from_fn(terms, n - free, |t, j| pencil.c.weights[t].to_f64() * stretches[(t, j)]);
    let moving = product(View::of(&stretches).transpose(), View::of(&tensions));
    // Exactly symmetric, whatever the order of the sums.
    Matrix::from_fn(n, n, |i, j| match i.min(j).checked_sub(free) {
        Some(least) => moving[(least, i.max(j) - free)],
        None => 0.0,
    })
}
