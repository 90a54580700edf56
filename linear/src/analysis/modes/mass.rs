//! The mass matrix in double-double, and coordinates whose inertia is doubtful.

use crate::analysis::modes::terms::Terms;
use crate::base::Dd;
use crate::kernel::dense::Matrix;

/// sum w a a^T in double-double.
pub fn assemble(terms: &Terms, n: usize) -> Matrix<Dd> {
    let mut matrix = Matrix::zeros(n, n);
    for t in 0..terms.len() {
        let (indices, factors) = terms.row(t);
        for (&j, b) in indices.iter().zip(factors.iter()) {
            let weighted = terms.weight(t).value.dd() * b.to_dd();
            for (&i, a) in indices.iter().zip(factors.iter()) {
                matrix[(i.index(), j.index())] += weighted * a.to_dd();
            }
        }
    }
    matrix
}

/// A coordinate whose inertia has no certain digit, because the uncertainty of weights and factors is as large as their
/// sum.
pub fn doubtful(terms: &Terms, n: usize) -> Option<usize> {
    let (mut size, mut doubt) = (vec![0.0; n], vec![0.0; n]);
    for t in 0..terms.len() {
        let (indices, factors) = terms.row(t);
        let weight = terms.weight(t);
        for (&i, factor) in indices.iter().zip(factors.iter()) {
            let (a, slip) = (factor.to_f64().abs(), factor.radius());
            size[i.index()] += weight.value.hi() * a * a;
            doubt[i.index()] +=
                weight.radius * (a + slip) * (a + slip) + weight.value.hi().abs() * slip * (2.0 * a + slip);
        }
    }
    // Entries without any inertia are left to the factorisation, which detects them.
    (0..n).find(|&i| doubt[i] > 0.0 && doubt[i] >= size[i].abs())
}

/// Whether all off-diagonal entries are zero.
pub fn is_diagonal(matrix: &Matrix<Dd>) -> bool {
    (0..matrix.columns()).all(|j| matrix.column(j).iter().enumerate().all(|(i, x)| i == j || x.is_zero()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::test_systems::{blank, push};
    use crate::base::{Ball, Number};
    use crate::system::{CoordinateId, Nature};

    #[test]
    fn off_diagonal_entries_are_seen() {
        assert!(!is_diagonal(&Matrix::fill_with(2, 2, Dd::ONE)) && is_diagonal(&Matrix::identity(2)));
    }

    /// It is found wherever the midpoint of its enclosure happens to be.
    #[test]
    fn a_mass_that_may_be_zero_is_found() {
        for (mid, found) in [(1e-32, Some(1)), (-1e-32, Some(1)), (0.0, Some(1)), (1e-20, None)] {
            let mut system = blank(2);
            push(&mut system.m, "1", 0, None);
            let source = system.m.source(system.coordinates[0].name);
            let mass = Number::Ball(Ball::new(Dd::from(mid), 1e-31));
            system.m.push(source, Nature::Property, mass, [(CoordinateId(1), Number::ONE)]);
            assert_eq!(doubtful(&Terms::of(&system.m), 2), found, "{mid:e}");
        }
    }
}
