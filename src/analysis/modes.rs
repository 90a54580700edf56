//! The undamped modes of M q'' + K q = 0: a linear system in, modes with certified frequencies out.
//!
//! 1. What is rigid is decided exactly ([`structure`]).
//! 2. A mass-orthonormal basis from M = L L^T, its first columns spanning the rigid motions.
//! 3. Jacobi's method in that basis: on the columns of sqrt(k) A X where all terms of K are positive, so that nothing is
//!    assembled; on X^T K X otherwise.
//! 4. Rayleigh quotients from the terms, and their certificate ([`certificate`]).
//!
//! Clause: spec.md, "Modes".

use super::answer::{Mode, ModeKind, Modes, Route};
use super::certificate::{Enclosure, enclose};
use super::dense::{Matrix, add_scaled, dot};
use super::error::{AnalysisError, place};
use super::gram::Gram;
use super::squares::Squares;
use super::structure::{self, NullSpace};
use super::{jacobi, shape};
use crate::base::{Ball, Dd};
use crate::system::{CoordinateId, LinearSystem};

/// Dense matrices of more coordinates than this would take minutes.
pub const MAX_DENSE: usize = 400;

/// The undamped modes, ascending in omega^2.
pub fn modes(system: &LinearSystem) -> Result<Modes, AnalysisError> {
    let n = system.n();
    if n == 0 {
        return Ok(Modes { list: Vec::new() });
    }
    if n > MAX_DENSE {
        return Err(AnalysisError::TooManyCoordinates { count: n, limit: MAX_DENSE, at: place(system, 0) });
    }
    let (inertia, stiffness) = (Squares::of(&system.m), Squares::of(&system.k));
    if !(inertia.is_finite() && stiffness.is_finite()) {
        return Err(AnalysisError::OutOfRange { at: place(system, 0) });
    }
    let rigid = structure::null_space(&system.k, n);
    let basis = mass_orthonormal_basis(system, &inertia, &rigid)?;
    let (x, route) = approximate_modes(&stiffness, basis, rigid.vectors.len());
    let (k, m) = (Gram::of(&stiffness, &x), Gram::of(&inertia, &x));
    if !(k.is_finite() && m.is_finite()) {
        return Err(AnalysisError::OutOfRange { at: place(system, 0) });
    }
    let found = Found { system, inertia: &inertia, stiffness: &stiffness, x: &x, k: &k, m: &m, route };
    Ok(found.modes(&rigid))
}

/// X with X^T M X = 1 to working accuracy, whose first columns span the rigid motions.
fn mass_orthonormal_basis(
    system: &LinearSystem,
    inertia: &Squares,
    rigid: &NullSpace,
) -> Result<Matrix<Dd>, AnalysisError> {
    let n = system.n();
    let lower = factor_mass(system, inertia)?;
    let mut x = inverse_transpose(&lower);
    // In coordinates y = L^T q the rigid motions are L^T v; reflections that turn them onto the first axes, applied to
    // X = L^-T from the right, leave an orthonormal basis of their complement in the other columns.
    let mut images: Vec<Vec<Dd>> = (rigid.vectors.iter())
        .map(|v| {
            let v: Vec<Dd> = v.iter().map(|value| value.to_ball().mid).collect();
            (0..n).map(|j| dot(&lower.column(j)[j..], &v[j..])).collect()
        })
        .collect();
    for axis in 0..images.len() {
        let normal = reflection_normal(&images[axis], axis);
        for image in &mut images[axis..] {
            let factor = -dot(&normal, image).scale(2.0);
            add_scaled(image, factor, &normal);
        }
        reflect_columns(&mut x, &normal, axis);
    }
    Ok(x)
}

/// The unit normal of the mirror that turns `image`, from entry `axis` on, onto that axis.
fn reflection_normal(image: &[Dd], axis: usize) -> Vec<Dd> {
    let mut normal = image.to_vec();
    normal[..axis].fill(Dd::ZERO);
    let length = dot(&normal, &normal).sqrt();
    let away = if normal[axis].hi < 0.0 { -length } else { length };
    normal[axis] += away;
    let scale = dot(&normal, &normal).sqrt().recip();
    for entry in &mut normal {
        *entry = *entry * scale;
    }
    normal
}

/// X <- X (1 - 2 v v^T), v zero before `axis`.
fn reflect_columns(x: &mut Matrix<Dd>, normal: &[Dd], axis: usize) {
    let mut image = vec![Dd::ZERO; x.rows()];
    for (j, &v) in normal.iter().enumerate().skip(axis) {
        add_scaled(&mut image, v, x.column(j));
    }
    for (j, &v) in normal.iter().enumerate().skip(axis) {
        add_scaled(x.column_mut(j), -v.scale(2.0), &image);
    }
}

/// Cholesky's factor of M, assembled in double-double.
fn factor_mass(system: &LinearSystem, inertia: &Squares) -> Result<Matrix<Dd>, AnalysisError> {
    let n = system.n();
    let mut l = assembled(inertia, n);
    let scale: Vec<f64> = (0..n).map(|j| l[(j, j)].hi).collect();
    for j in 0..n {
        let pivot = l[(j, j)];
        // What is left of a diagonal entry after cancelling to its last bits is no number to go on with.
        if pivot.hi.is_nan() || pivot.hi <= scale[j].abs() * (n as f64 * 16.0 * Dd::EPSILON) {
            return Err(improper_mass(system, j));
        }
        let root = pivot.sqrt();
        for entry in &mut l.column_mut(j)[j..] {
            *entry = *entry / root;
        }
        for i in j + 1..n {
            let factor = l[(i, j)];
            if !factor.is_zero() {
                let (done, rest) = l.column_pair(j, i);
                add_scaled(&mut rest[i..], -factor, &done[i..]);
            }
        }
    }
    Ok(l)
}

/// Why M has no Cholesky factor: motions without inertia, found exactly, or negative ones at this coordinate.
fn improper_mass(system: &LinearSystem, at: usize) -> AnalysisError {
    let space = structure::null_space(&system.m, system.n());
    let mut massless: Vec<usize> = (0..system.n()).filter(|&i| space.vectors.iter().any(|v| !v[i].is_zero())).collect();
    if massless.is_empty() && space.dimension == 0 {
        return AnalysisError::indefinite_mass(system, CoordinateId(at as u32));
    }
    if massless.is_empty() {
        massless.push(at);
    }
    AnalysisError::singular_mass(system, &massless)
}

/// The lower triangle (and the rest) of sum w a a^T in double-double.
fn assembled(squares: &Squares, n: usize) -> Matrix<Dd> {
    let mut matrix = Matrix::zeros(n, n);
    for t in 0..squares.len() {
        let (indices, values) = squares.row(t);
        for (&j, b) in indices.iter().zip(values) {
            let weighted = squares.weights[t].mid * b.mid;
            for (&i, a) in indices.iter().zip(values) {
                matrix[(i as usize, j as usize)] += weighted * a.mid;
            }
        }
    }
    matrix
}

/// L^-T, upper triangular, column by column: L^T x = e_j.
fn inverse_transpose(lower: &Matrix<Dd>) -> Matrix<Dd> {
    let n = lower.columns();
    let mut x = Matrix::zeros(n, n);
    for j in 0..n {
        x[(j, j)] = lower[(j, j)].recip();
        for i in (0..j).rev() {
            let sum = dot(&lower.column(i)[i + 1..=j], &x.column(j)[i + 1..=j]);
            if !sum.is_zero() {
                x[(i, j)] = -sum / lower[(i, i)];
            }
        }
    }
    x
}

/// Turns the basis, beyond its rigid columns, into approximate modes.
fn approximate_modes(stiffness: &Squares, basis: Matrix<Dd>, rigid: usize) -> (Matrix<Dd>, Route) {
    let n = basis.columns();
    let mut elastic = basis.select_columns(&(rigid..n).collect::<Vec<_>>());
    let route = if stiffness.all_positive() {
        let mut g = Matrix::from_fn(stiffness.len(), n - rigid, |t, j| {
            stiffness.weights[t].mid.sqrt() * stiffness.stretch(t, elastic.column(j)).mid
        });
        jacobi::orthogonalise_columns(&mut g, &mut elastic);
        Route::FactoredDoubleDouble
    } else {
        let mut k = Gram::of(stiffness, &elastic).mid;
        jacobi::diagonalise(&mut k, &mut elastic);
        Route::Assembled
    };
    let mut x = basis;
    for j in rigid..n {
        x.column_mut(j).copy_from_slice(elastic.column(j - rigid));
    }
    (x, route)
}

/// What is known when the modes are put together.
struct Found<'a> {
    system: &'a LinearSystem,
    inertia: &'a Squares,
    stiffness: &'a Squares,
    x: &'a Matrix<Dd>,
    k: &'a Gram,
    m: &'a Gram,
    route: Route,
}

impl Found<'_> {
    /// All modes. The first columns of X are rigid motions. If the other eigenvalues that may be zero are no more than the
    /// dimension of the null space leaves, then all of those are exactly zero.
    fn modes(&self, rigid: &NullSpace) -> Modes {
        let list = enclose(self.k, self.m).list;
        let known = rigid.vectors.len();
        let positive = self.stiffness.all_positive() && rigid.dimension == known;
        let may_be_zero = |e: &Enclosure| e.column >= known && !positive && e.lambda.contains_zero();
        let certain = list.iter().filter(|e| may_be_zero(e)).count() <= rigid.dimension - known;
        let mut modes: Vec<Mode> = (list.iter().zip(cluster_numbers(&list)))
            .map(|(e, cluster)| {
                let rigid = e.column < known || (certain && may_be_zero(e));
                if rigid { self.rigid_mode(e.column, certain) } else { self.elastic_mode(e, cluster) }
            })
            .collect();
        modes.sort_by_key(|mode| match mode.kind {
            ModeKind::Divergence => 0,
            ModeKind::Rigid => 1,
            ModeKind::Oscillation => 2,
        });
        Modes { list: modes }
    }

    fn rigid_mode(&self, column: usize, certain: bool) -> Mode {
        let unknown = Ball::new(Dd::ZERO, f64::INFINITY);
        let zero = if certain { Ball::ZERO } else { unknown };
        let mode = Mode {
            kind: ModeKind::Rigid,
            omega_squared: zero,
            omega: zero,
            cluster: None,
            shape: Vec::new(),
            input_condition: None,
            kinetic: Vec::new(),
            strain: Vec::new(),
            route: Route::Exact,
        };
        self.with_shape(mode, column)
    }

    fn elastic_mode(&self, enclosure: &Enclosure, cluster: Option<u32>) -> Mode {
        let column = enclosure.column;
        let lambda = enclosure.lambda;
        let known = lambda.rad.is_finite() && (!lambda.contains_zero() || self.stiffness.all_positive());
        let omega = if known { lambda.abs().sqrt() } else { unknown_root(lambda) };
        let shape: Vec<Dd> = self.x.column(column).to_vec();
        let energies = (0..self.stiffness.len()).map(|t| {
            let stretch = self.stiffness.stretch(t, &shape).mid.hi;
            self.stiffness.weights[t].mid.hi * stretch * stretch
        });
        let mode = Mode {
            kind: if lambda.mid.hi < 0.0 { ModeKind::Divergence } else { ModeKind::Oscillation },
            omega_squared: lambda,
            omega,
            cluster,
            shape: Vec::new(),
            input_condition: Some(self.k.absolute_energy(column) / lambda.mid.hi.abs() + 1.0),
            kinetic: Vec::new(),
            strain: shape::strain_shares(&self.system.k, energies),
            route: self.route,
        };
        self.with_shape(mode, column)
    }

    /// Adds the shape, mass-normalised and signed, and its kinetic energy.
    fn with_shape(&self, mut mode: Mode, column: usize) -> Mode {
        let scale = self.m.mid[(column, column)].hi.sqrt();
        mode.shape = self.x.column(column).iter().map(|x| x.to_f64() / scale).collect();
        mode.kinetic = shape::kinetic_shares(self.inertia, &mode.shape);
        if shape::is_reversed(&mode.shape, &mode.kinetic, self.system) {
            mode.shape.iter_mut().for_each(|x| *x = -*x);
        }
        mode
    }
}

fn unknown_root(lambda: Ball) -> Ball {
    Ball::new(lambda.mid.abs().sqrt(), f64::INFINITY)
}

/// Numbers the groups of more than one mode.
fn cluster_numbers(list: &[Enclosure]) -> Vec<Option<u32>> {
    let (mut next, mut numbers) = (0, vec![None; list.len()]);
    for i in 0..list.len() {
        let first = list[i].group;
        if first < i && numbers[first].is_none() {
            (numbers[first], next) = (Some(next), next + 1);
        }
        if first < i {
            numbers[i] = numbers[first];
        }
    }
    numbers
}
