//! The second road: eigenvalues counted in exact arithmetic.

use num_bigint::{BigInt, Sign};
use num_integer::Integer;
use num_rational::BigRational;
use num_traits::{One, Zero};
use vibc::base::{Dd, Rational};
use vibc::system::{Form, LinearSystem};

/// K and M with a common denominator taken out.
pub struct ExactPencil {
    k: Vec<Vec<BigInt>>,
    m: Vec<Vec<BigInt>>,
}

impl ExactPencil {
    /// Of a system all of whose numbers are rational.
    pub fn of(system: &LinearSystem) -> ExactPencil {
        let n = system.n();
        let (k, m) = (assembled(&system.k, n), assembled(&system.m, n));
        let entries = || k.iter().chain(&m).flatten();
        let common = entries().fold(BigInt::one(), |lcm, x| lcm.lcm(x.denom()));
        let integers = |matrix: &[Vec<BigRational>]| {
            matrix.iter().map(|row| row.iter().map(|x| x.numer() * (&common / x.denom())).collect()).collect()
        };
        ExactPencil { k: integers(&k), m: integers(&m) }
    }

    /// How many eigenvalues are below s: the negative ones of K - s M (Sylvester), as the changes of sign in the sequence of
    /// its leading minors, which Bareiss' elimination yields. `None` if one of them is zero.
    pub fn below(&self, s: &BigRational) -> Option<usize> {
        let n = self.k.len();
        let mut t: Vec<Vec<BigInt>> =
            (0..n).map(|i| (0..n).map(|j| &self.k[i][j] * s.denom() - &self.m[i][j] * s.numer()).collect()).collect();
        let (mut previous, mut changes) = (BigInt::one(), 0);
        for p in 0..n {
            let pivot = t[p][p].clone();
            if pivot.is_zero() {
                return None;
            }
            changes += usize::from((pivot.sign() == Sign::Minus) != (previous.sign() == Sign::Minus));
            let row = t[p].clone();
            for r in t.iter_mut().skip(p + 1) {
                let factor = r[p].clone();
                for j in p + 1..n {
                    r[j] = (&r[j] * &pivot - &factor * &row[j]) / &previous;
                }
            }
            previous = pivot;
        }
        Some(changes)
    }
}

fn assembled(form: &Form, n: usize) -> Vec<Vec<BigRational>> {
    let mut matrix = vec![vec![BigRational::zero(); n]; n];
    let exact = |x: &vibc::base::Number| x.exact().expect("rational").to_big();
    for term in form.terms() {
        for (i, a) in form.row(term) {
            for (j, b) in form.row(term) {
                matrix[i.index()][j.index()] += exact(&term.weight) * exact(a) * exact(b);
            }
        }
    }
    matrix
}

/// The value of a double-double.
pub fn value(x: Dd) -> BigRational {
    binary(x.hi) + binary(x.lo)
}

pub fn binary(x: f64) -> BigRational {
    Rational::from_f64(x).expect("a finite number").to_big()
}
