//! Where the poles are, roughly: eigenvalues of the state matrix in the coordinates of the undamped modes. In: modes and
//! terms of an independent part. Out: starting values in binary64, and the basis in which they were found. Nothing here
//! is printed: refinement and discs do not care how they were started. Clause: spec.md 11.5.
//!
//! With q = Phi y, energies e_j = |omega_j| y_j and velocities v: e' = |omega| v, v' = -sgn(omega^2) |omega| e - C~ v,
//! C~ = Phi^T C Phi. Without damping that matrix is skew and perfectly scaled, whatever the stiffness ratios; this is what
//! the scaling of Fan, Lin and Van Dooren (SIMAX 26 (2004) 252) aims at, mode by mode.

use crate::analysis::answer::{ModeKind, Modes};
use crate::analysis::numeric::complex::Complex;
use crate::analysis::numeric::dense::Matrix;
use crate::analysis::poles::pencil::{Pencil, Squares};
use crate::analysis::poles::rigid::RigidMotions;
use crate::base::Dd;
use nalgebra::{DMatrix, Schur};

/// Modes as a basis: binary64 columns, and C~ in it.
#[derive(Clone, Debug)]
pub struct Basis {
    /// Free rigid motions, then dragged ones, then the others.
    pub shapes: Matrix<f64>,
    pub free: usize,
    pub dragged: usize,
    /// w (a . N) of the terms of M, and of C, for each rigid motion N: the forces on it without those of springs, which do
    /// not feel it.
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

    /// The eigenvalues that are not exactly zero, one of each conjugate pair (im > 0) and the real ones.
    ///
    /// The QR method leaves errors of about 1e-16 of the largest eigenvalue, so the fast ones are taken from the state
    /// matrix and the slow ones, as reciprocals, from its inverse. Empty if an iteration does not end.
    pub fn starts(&self) -> Vec<Complex<f64>> {
        let fast = eigenvalues(self.state_matrix());
        let slow = self.inverse_state_matrix().and_then(eigenvalues);
        let slow = slow.map(|list| list.into_iter().map(Complex::recip).filter(|z| z.is_finite()).collect());
        match (fast, slow) {
            (Some(fast), Some(slow)) => joined(fast, slow),
            (Some(list), None) | (None, Some(list)) => list,
            (None, None) => Vec::new(),
        }
        .into_iter()
        .filter(|z| z.im >= 0.0)
        .collect()
    }

    /// The number of rigid motions.
    pub fn rigid(&self) -> usize {
        self.free + self.dragged
    }

    /// |omega| and the sign of omega^2 of mode j beyond the rigid ones.
    fn rate(&self, j: usize) -> (f64, f64) {
        let omega_squared = self.omega_squared[self.rigid() + j];
        (omega_squared.abs().sqrt(), omega_squared.signum())
    }

    /// Rows and columns: energies of the moving modes, velocities of the dragged and of the moving ones.
    fn state_matrix(&self) -> DMatrix<f64> {
        let (moving, velocities) = (self.n() - self.rigid(), self.n() - self.free);
        let mut matrix = DMatrix::zeros(moving + velocities, moving + velocities);
        for j in 0..moving {
            let (rate, sign) = self.rate(j);
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

    /// The inverse without a general inversion: velocities v_m = |omega|^-1 f, v_d = -C_dd^-1 (g_d + C_dm v_m), energies
    /// e = -sgn |omega|^-1 (g_m + C_md v_d + C_mm v_m) for a right-hand side (f, g_d, g_m). `None` if C_dd is singular.
    fn inverse_state_matrix(&self) -> Option<DMatrix<f64>> {
        let (moving, dragged) = (self.n() - self.rigid(), self.dragged);
        let c = |i: usize, j: usize| self.damping[(self.free + i, self.free + j)];
        let c_dd = DMatrix::from_fn(dragged, dragged, c).try_inverse()?;
        let c_dm = DMatrix::from_fn(dragged, moving, |i, j| c(i, dragged + j) / self.rate(j).0);
        let c_mm = DMatrix::from_fn(moving, moving, |i, j| c(dragged + i, dragged + j) / self.rate(j).0);
        let drag = &c_dd * &c_dm;
        let mut inverse = DMatrix::zeros(2 * moving + dragged, 2 * moving + dragged);
        for i in 0..moving {
            let (rate, sign) = self.rate(i);
            // C_md v_d is the transpose of C_dm, with the factor of the column taken back.
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

/// All eigenvalues, ascending in size; `None` if the iteration does not end or overflows.
fn eigenvalues(matrix: DMatrix<f64>) -> Option<Vec<Complex<f64>>> {
    if matrix.iter().any(|x| !x.is_finite()) {
        return None;
    }
    if matrix.is_empty() {
        // All motions of the part are rigid, as far as binary64 can tell: nalgebra's Schur form has no case for it.
        return Some(Vec::new());
    }
    let sweeps = 100 * matrix.nrows();
    let values = Schur::try_new(matrix, f64::EPSILON, sweeps)?.complex_eigenvalues();
    let mut list: Vec<Complex<f64>> = values.iter().map(|z| Complex::new(z.re, z.im)).collect();
    list.sort_by(|a, b| a.abs().total_cmp(&b.abs()).then(a.im.total_cmp(&b.im)));
    Some(list)
}

/// The slow ones of one list before the fast ones of the other, cut where the two agree best.
fn joined(fast: Vec<Complex<f64>>, mut slow: Vec<Complex<f64>>) -> Vec<Complex<f64>> {
    slow.sort_by(|a, b| a.abs().total_cmp(&b.abs()).then(a.im.total_cmp(&b.im)));
    if slow.len() != fast.len() {
        return fast;
    }
    let apart = |i: usize| slow.get(i).zip(fast.get(i)).map_or(0.0, |(a, b)| (*a - *b).one_norm() / b.one_norm());
    // Before a conjugate (im > 0, sorted last) there is no cut.
    let whole = |i: usize| slow.get(i).is_none_or(|z| z.im <= 0.0) && fast.get(i).is_none_or(|z| z.im <= 0.0);
    let cost = |i: usize| if i == 0 { apart(0) } else { apart(i - 1).max(apart(i)) };
    let cut = (0..=fast.len()).filter(|&i| whole(i)).min_by(|&i, &j| cost(i).total_cmp(&cost(j))).unwrap_or(0);
    slow[..cut].iter().chain(&fast[cut..]).copied().collect()
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
    (0..forces.len()).fold(Dd::ZERO, |sum, t| sum + forces[t] * pencil.m.stretch(t, y))
}

/// w (a . x) of each term.
fn forces(squares: &Squares<Dd>, x: &[Dd]) -> Vec<Dd> {
    (0..squares.len()).map(|t| squares.weights[t] * squares.stretch(t, x)).collect()
}

fn dot(indices: &[u32], values: &[Dd], x: &[f64]) -> f64 {
    indices.iter().zip(values).map(|(&i, a)| a.hi * x[i as usize]).sum()
}

/// sum c (d Phi)^T (d Phi), zero where a motion is free.
fn damping(pencil: &Pencil<Dd>, shapes: &Matrix<f64>, free: usize) -> Matrix<f64> {
    let n = shapes.columns();
    let mut damping = Matrix::filled(n, n, 0.0);
    for t in 0..pencil.c.len() {
        let (indices, values) = pencil.c.row(t);
        let stretch: Vec<f64> = (0..n).map(|j| dot(indices, values, shapes.column(j))).collect();
        for j in free..n {
            let weighted = pencil.c.weights[t].to_f64() * stretch[j];
            for i in free..n {
                damping[(i, j)] += stretch[i] * weighted;
            }
        }
    }
    damping
}
