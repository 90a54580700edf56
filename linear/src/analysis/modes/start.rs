//! Approximate starting modes, by the cheapest method that suits the terms.
//!
//! In: M and K as terms, M's factor, the rigid motions. Out: a basis X whose first columns are the rigid motions and
//! whose others are approximate modes. Nothing here needs a bound: the certificate judges the result.
//!
//! - A network of positive springs on single masses: star-mesh elimination, then one-sided Jacobi in binary64.
//! - Positive terms of any kind: pivoted QR of sqrt(k) A L^-T, then one-sided Jacobi.
//! - Negative terms: the modes of the positive terms, then Jacobi on K in that basis, where a graded matrix is scaled
//!   by energies (K = D (1 - S) D).
//! - All of these again in double-double, on sqrt(k) A L^-T or on the matrix, if binary64 was not enough.
//!
//! See docs/method/modes.md#starting-modes.

use crate::analysis::answer::Route;
use crate::analysis::modes::gram::Gram;
use crate::analysis::modes::mass;
use crate::analysis::modes::star_mesh::Network;
use crate::analysis::modes::structure::NullSpace;
use crate::analysis::modes::terms::Terms;
use crate::base::{Dd, OrderBy};
use crate::kernel::dense::{Matrix, add_scaled, dot};
use crate::kernel::dense::{cholesky, jacobi, pivoted_qr};
use crate::kernel::real::Float;
use crate::kernel::triple::Triple;

/// A basis to start from.
pub struct Start {
    pub x: Matrix<Triple>,
    /// Eigenvalues better than the basis' own quotients, if the method gives them.
    pub estimates: Option<Vec<f64>>,
    pub route: Route,
}

/// M in the representations that the methods need.
pub struct Inertia {
    pub matrix: Matrix<Dd>,
    /// L of M = L L^T.
    pub lower: Matrix<Dd>,
}

impl Inertia {
    fn n(&self) -> usize {
        self.matrix.columns()
    }

    fn masses(&self) -> Option<Vec<f64>> {
        mass::is_diagonal(&self.matrix).then(|| (0..self.n()).map(|i| self.matrix[(i, i)].hi).collect())
    }
}

/// Starts from positive terms, in binary64.
pub fn positive(terms: &Terms, inertia: &Inertia, rigid: &NullSpace) -> Start {
    let network = inertia.masses().and_then(|masses| Some((Network::of(terms, inertia.n())?, masses)));
    let (mut c, elastic, route) = match network {
        Some((network, masses)) => {
            let scale: Vec<f64> = masses.iter().map(|m| 1.0 / m.sqrt()).collect();
            (network.factor(&masses), Basis::Diagonal(scale), Route::StarMesh)
        }
        None => {
            let basis = cholesky::inverse_transpose(&inertia.lower);
            let g = factor_columns(terms, &basis).map(|x| x.hi);
            (pivoted_qr::factor(g, inertia.n() - rigid.vectors.len()), Basis::Full(basis), Route::Factored)
        }
    };
    jacobi::orthogonalise_columns(&mut c, None);
    let mut columns = rigid_basis(inertia, rigid);
    let mut estimates = vec![0.0; columns.len()];
    for j in 0..c.columns() {
        let square = f64::dot(c.column(j), c.column(j));
        let length = square.sqrt();
        columns.push(elastic.image(&c.column(j).iter().map(|x| x / length).collect::<Vec<_>>()));
        estimates.push(square);
    }
    let x = Matrix::from_fn(inertia.n(), columns.len(), |i, j| Triple::from(columns[j][i]));
    Start { x, estimates: Some(estimates), route }
}

/// Starts from positive terms, in double-double.
pub fn positive_in_double_double(terms: &Terms, inertia: &Inertia, rigid: &NullSpace) -> Start {
    let (mut x, rigid) = deflated_basis(inertia, rigid);
    let mut elastic = x.select_columns(&(rigid..inertia.n()).collect::<Vec<_>>());
    let mut g = factor_columns(terms, &elastic);
    jacobi::orthogonalise_columns(&mut g, Some(&mut elastic));
    for j in rigid..inertia.n() {
        x.column_mut(j).copy_from_slice(elastic.column(j - rigid));
    }
    Start { x: x.map(Triple::from), estimates: None, route: Route::FactoredDoubleDouble }
}

/// Starts from terms of both signs: the modes of all terms in the basis of the positive terms' modes.
pub fn of_both_signs(terms: &Terms, positive: Start, rigid: usize) -> Start {
    let x = positive.x.map(Triple::dd);
    let n = x.columns();
    let mut k = Gram::of(terms, &positive.x).mid;
    let mut z = Matrix::identity(n);
    jacobi::diagonalise(&mut k, &mut z);
    let mut result = Matrix::fill_with(n, n, Dd::ZERO);
    for j in 0..n {
        for i in 0..n {
            add_scaled(result.column_mut(j), z[(i, j)], x.column(i));
        }
    }
    Start { x: rigid_first(result, &k, rigid).map(Triple::from), estimates: None, route: Route::Energy }
}

/// Starts from terms of both signs, directly in double-double.
pub fn assemble(terms: &Terms, inertia: &Inertia, rigid: &NullSpace) -> Start {
    let (x, count) = deflated_basis(inertia, rigid);
    let n = inertia.n();
    let mut elastic = x.select_columns(&(count..n).collect::<Vec<_>>());
    let mut k = Gram::of(terms, &elastic.map(Triple::from)).mid;
    jacobi::diagonalise(&mut k, &mut elastic);
    let mut x = x;
    for j in count..n {
        x.column_mut(j).copy_from_slice(elastic.column(j - count));
    }
    Start { x: x.map(Triple::from), estimates: None, route: Route::Assembled }
}

/// Moves the `rigid` columns of least |K_ii| to the front.
fn rigid_first(x: Matrix<Dd>, k: &Matrix<Dd>, rigid: usize) -> Matrix<Dd> {
    if rigid == 0 {
        return x;
    }
    let mut order: Vec<usize> = (0..x.columns()).collect();
    order.order_by(|&a, &b| k[(a, a)].hi.abs().total_cmp(&k[(b, b)].hi.abs()));
    x.select_columns(&order)
}

/// sqrt(w) a . x for each term and column.
fn factor_columns(terms: &Terms, x: &Matrix<Dd>) -> Matrix<Dd> {
    let x = x.map(Triple::from);
    let roots: Vec<Dd> = terms.weights().map(|w| w.value.dd().abs().sqrt()).collect();
    Matrix::from_fn(terms.len(), x.columns(), |t, j| roots[t] * terms.stretch(t, x.column(j)).value.dd())
}

/// L^-T of the mass matrix, applied to vectors in binary64.
enum Basis {
    Diagonal(Vec<f64>),
    Full(Matrix<Dd>),
}

impl Basis {
    fn image(&self, v: &[f64]) -> Vec<Dd> {
        match self {
            Basis::Diagonal(scale) => v.iter().zip(scale).map(|(v, s)| Dd::from(v * s)).collect(),
            Basis::Full(basis) => {
                let mut image = vec![Dd::ZERO; basis.rows()];
                for (j, &v) in v.iter().enumerate() {
                    add_scaled(&mut image, Dd::from(v), basis.column(j));
                }
                image
            }
        }
    }
}

/// M-orthonormal vectors that span the rigid motions.
fn rigid_basis(inertia: &Inertia, rigid: &NullSpace) -> Vec<Vec<Dd>> {
    if rigid.vectors.is_empty() {
        return Vec::new();
    }
    let (x, count) = deflated_basis(inertia, rigid);
    (0..count).map(|j| x.column(j).to_vec()).collect()
}

/// X with X^T M X = 1 to working accuracy, and the number of its leading columns that span the known rigid motions.
fn deflated_basis(inertia: &Inertia, rigid: &NullSpace) -> (Matrix<Dd>, usize) {
    let lower = &inertia.lower;
    let mut x = cholesky::inverse_transpose(lower);
    // In coordinates y = L^T q the rigid motions are L^T v; reflections that turn them onto the first axes, applied to
    // X = L^-T from the right, leave an orthonormal basis of their complement in the other columns.
    let mut images: Vec<Vec<Dd>> = (rigid.vectors.iter())
        .map(|v| {
            let v: Vec<Dd> = v.iter().map(|value| value.to_ball().mid).collect();
            (0..v.len()).map(|j| dot(&lower.column(j)[j..], &v[j..])).collect()
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
    (x, images.len())
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
