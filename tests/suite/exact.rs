//! An independent method: eigenvalues are counted, and errors of poles are measured, in exact arithmetic.

use num_bigint::{BigInt, Sign};
use num_integer::Integer;
use num_rational::BigRational;
use num_traits::{One, ToPrimitive, Zero};
use vibc::base::{Dd, Rational};
use vibc::system::{Form, LinearSystem};

/// K and M with a common denominator taken out.
pub struct ExactPencil {
    k: Vec<Vec<BigInt>>,
    m: Vec<Vec<BigInt>>,
}

impl ExactPencil {
    /// The pencil of a system whose numbers are all rational.
    pub fn of(system: &LinearSystem) -> ExactPencil {
        let n = system.n();
        ExactPencil::new(&assembled(&system.k, n), &assembled(&system.m, n))
    }

    pub fn new(k: &[Vec<BigRational>], m: &[Vec<BigRational>]) -> ExactPencil {
        let entries = || k.iter().chain(m).flatten();
        let common = entries().fold(BigInt::one(), |lcm, x| lcm.lcm(x.denom()));
        let integers = |matrix: &[Vec<BigRational>]| {
            matrix.iter().map(|row| row.iter().map(|x| x.numer() * (&common / x.denom())).collect()).collect()
        };
        ExactPencil { k: integers(k), m: integers(m) }
    }

    /// The number of eigenvalues below s: the negative ones of K - s M (Sylvester), as the sign changes in the sequence
    /// of its leading minors, which Bareiss' elimination yields. `None` if one of them is zero.
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
                matrix[i.index()][j.index()] += exact(term.weight) * exact(a) * exact(b);
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

/// x + i y
#[derive(Clone)]
pub struct Gauss(BigInt, BigInt);

impl Gauss {
    fn times(&self, z: &Gauss) -> Gauss {
        Gauss(&self.0 * &z.0 - &self.1 * &z.1, &self.0 * &z.1 + &self.1 * &z.0)
    }

    fn minus(&self, z: &Gauss) -> Gauss {
        Gauss(&self.0 - &z.0, &self.1 - &z.1)
    }

    fn norm(&self) -> BigInt {
        &self.0 * &self.0 + &self.1 * &self.1
    }

    /// An exact quotient.
    fn over(&self, z: &Gauss) -> Gauss {
        let product = self.times(&Gauss(z.0.clone(), -&z.1));
        Gauss(product.0 / z.norm(), product.1 / z.norm())
    }
}

/// M, C, K times a common denominator.
pub struct Quadratic {
    forms: [Vec<Vec<BigInt>>; 3],
}

impl Quadratic {
    pub fn of(system: &LinearSystem) -> Quadratic {
        let n = system.n();
        let forms = [&system.m, &system.c, &system.k].map(|form| assembled(form, n));
        let denominators = forms.iter().flatten().flatten().map(|x| x.denom().clone());
        let common = denominators.fold(BigInt::one(), num_integer::lcm);
        let cleared = |x: &BigRational| x.numer() * (&common / x.denom());
        Quadratic { forms: forms.map(|form| form.iter().map(|row| row.iter().map(cleared).collect()).collect()) }
    }

    /// det(M s^2 + C s 2^k + K 4^k) for s 2^-k, by Bareiss' elimination.
    fn determinant(&self, s: &Gauss, k: u64) -> Gauss {
        let n = self.forms[0].len();
        let square = s.times(s);
        let entry = |i: usize, j: usize| {
            let [m, c, stiffness] = self.forms.each_ref().map(|form| &form[i][j]);
            let c = c << k;
            Gauss(m * &square.0 + &c * &s.0 + (stiffness << (2 * k)), m * &square.1 + c * &s.1)
        };
        let mut a: Vec<Vec<Gauss>> = (0..n).map(|i| (0..n).map(|j| entry(i, j)).collect()).collect();
        let mut last = Gauss(BigInt::one(), BigInt::zero());
        for p in 0..n {
            let row = a[p].clone();
            for r in a.iter_mut().skip(p + 1) {
                let factor = r[p].clone();
                for j in p + 1..n {
                    r[j] = r[j].times(&row[p]).minus(&factor.times(&row[j])).over(&last);
                }
            }
            last = row[p].clone();
        }
        last
    }

    /// |p / p'| at a pole's midpoint: its error, to as many digits as the difference quotient has.
    pub fn error(&self, re: Dd, im: Dd) -> f64 {
        let size = re.to_f64().hypot(im.to_f64());
        // A step between the error (1e-30) and the distance to the next pole.
        let step = binary(2f64.powi((size * 1e-20).log2() as i32));
        let (re, im) = (value(re), value(im));
        let k = [&re, &im, &step].iter().map(|x| x.denom().bits() - 1).max().expect("three");
        let scaled = |x: &BigRational| (x.numer() << k) / x.denom();
        let s = Gauss(scaled(&re), scaled(&im));
        let beyond = Gauss(&s.0 + scaled(&step), s.1.clone());
        let (p, q) = (self.determinant(&s, k), self.determinant(&beyond, k));
        let ratio = BigRational::new(p.norm(), q.minus(&p).norm()).to_f64().expect("a number");
        ratio.sqrt() * step.to_f64().expect("a number")
    }
}
