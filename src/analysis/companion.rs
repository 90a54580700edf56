//! Where the poles are, roughly: eigenvalues of the state matrix in the coordinates of the undamped modes. In: modes and
//! terms of an independent part. Out: starting values in binary64, and the basis in which they were found. Nothing here
//! is printed: refinement and discs do not care how they were started. Clause: spec.md 11.5.
//!
//! With q = Phi y, energies e_j = |omega_j| y_j and velocities v: e' = |omega| v, v' = -sgn(omega^2) |omega| e - C~ v,
//! C~ = Phi^T C Phi. Without damping that matrix is skew and perfectly scaled, whatever the stiffness ratios; this is what
//! the scaling of Fan, Lin and Van Dooren (SIMAX 26 (2004) 252) aims at, mode by mode.

use super::answer::{ModeKind, Modes};
use super::complex::Complex;
use super::dense::Matrix;
use super::pencil::Pencil;
use super::pole_rigid::RigidMotions;
use crate::base::Number;
use nalgebra::{DMatrix, Schur};

/// Modes as a basis: binary64 columns, and C~ in it.
#[derive(Clone, Debug)]
pub struct Basis {
    /// Free rigid motions, then dragged ones, then the others.
    pub shapes: Matrix<f64>,
    pub free: usize,
    pub dragged: usize,
    /// omega^2, zero for rigid motions.
    pub omega_squared: Vec<f64>,
    /// Phi^T C Phi; rows of free motions are zero.
    pub damping: Matrix<f64>,
}

impl Basis {
    /// `modes` are all n modes of the part.
    pub fn of(pencil: &Pencil, modes: &Modes, rigid: &RigidMotions) -> Basis {
        let mut columns = rigid_columns(pencil, rigid);
        let mut omega_squared = vec![0.0; columns.len()];
        for mode in modes.list.iter().filter(|mode| mode.kind != ModeKind::Rigid) {
            columns.push(mode.shape.clone());
            omega_squared.push(mode.omega_squared.to_f64());
        }
        let shapes = Matrix::from_fn(pencil.n, columns.len(), |i, j| columns[j][i]);
        let damping = damping(pencil, &shapes, rigid.free.len());
        Basis { shapes, free: rigid.free.len(), dragged: rigid.dragged.len(), omega_squared, damping }
    }

    pub fn n(&self) -> usize {
        self.omega_squared.len()
    }

    /// The number of poles that are exactly zero.
    pub fn zeros(&self) -> usize {
        2 * self.free + self.dragged
    }

    /// The eigenvalues that are not exactly zero, one of each conjugate pair (im > 0) and the real ones.
    /// `None` if the iteration does not end.
    pub fn starts(&self) -> Option<Vec<Complex<f64>>> {
        let matrix = self.state_matrix();
        let sweeps = 100 * matrix.nrows();
        let eigenvalues = Schur::try_new(matrix, f64::EPSILON, sweeps)?.complex_eigenvalues();
        Some(eigenvalues.iter().filter(|z| z.im >= 0.0).map(|z| Complex::new(z.re, z.im)).collect())
    }

    /// Rows and columns: energies of the moving modes, then velocities of all that damping or stiffness acts on.
    fn state_matrix(&self) -> DMatrix<f64> {
        let rigid = self.free + self.dragged;
        let (moving, velocities) = (self.n() - rigid, self.n() - self.free);
        let mut matrix = DMatrix::zeros(moving + velocities, moving + velocities);
        for j in 0..moving {
            let omega_squared = self.omega_squared[rigid + j];
            let rate = omega_squared.abs().sqrt();
            matrix[(j, moving + self.dragged + j)] = rate;
            matrix[(moving + self.dragged + j, j)] = -omega_squared.signum() * rate;
        }
        for i in 0..velocities {
            for j in 0..velocities {
                matrix[(moving + i, moving + j)] = -self.damping[(self.free + i, self.free + j)];
            }
        }
        matrix
    }
}

/// The rigid motions made orthonormal with respect to M (Gram-Schmidt, free ones first).
fn rigid_columns(pencil: &Pencil, rigid: &RigidMotions) -> Vec<Vec<f64>> {
    let mut columns: Vec<Vec<f64>> = Vec::new();
    for motion in rigid.free.iter().chain(&rigid.dragged) {
        let mut x: Vec<f64> = motion.iter().map(Number::to_f64).collect();
        // Twice is enough (Kahan; Parlett, The Symmetric Eigenvalue Problem, 6.9).
        for _ in 0..2 {
            for column in &columns {
                let part = inertia(pencil, column, &x);
                x.iter_mut().zip(column).for_each(|(x, c)| *x -= part * c);
            }
        }
        let length = inertia(pencil, &x, &x).sqrt();
        x.iter_mut().for_each(|x| *x /= length);
        columns.push(x);
    }
    columns
}

/// x^T M y
fn inertia(pencil: &Pencil, x: &[f64], y: &[f64]) -> f64 {
    (0..pencil.m.len())
        .map(|t| {
            let (indices, values) = pencil.m.row(t);
            pencil.m.weights[t].to_f64() * dot(indices, values, x) * dot(indices, values, y)
        })
        .sum()
}

fn dot(indices: &[u32], values: &[crate::base::Ball], x: &[f64]) -> f64 {
    indices.iter().zip(values).map(|(&i, a)| a.mid.hi * x[i as usize]).sum()
}

/// sum c (d Phi)^T (d Phi), zero where a motion is free.
fn damping(pencil: &Pencil, shapes: &Matrix<f64>, free: usize) -> Matrix<f64> {
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
