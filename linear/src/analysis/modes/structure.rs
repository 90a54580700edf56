//! Exact decisions about K, without any threshold: how many independent motions cause no force (the rigid motions), and
//! which they are.
//!
//! Elimination modulo a prime near 2^61 finds a rank that is never above the true one; rational vectors that are
//! recovered from the residues (of more primes if one is not enough) and verified term by term show that it is not
//! below. For the elimination, positive terms get random weights (their null space does not depend on the weights) and
//! others keep theirs. A square root is represented by a root modulo the prime, so primes that have the roots of the
//! form are used. Numbers known only as enclosures become independent unknowns, equal ones the same unknown.
//! See docs/method/modes.md#rigid-body-modes.

use super::image::{Image, identity};
use crate::base::{Ball, Number, Rational};
use crate::kernel::dense::echelon::reduce;
use crate::kernel::dense::{Matrix, enclosure};
use crate::kernel::residues::Field;
use crate::system::{Form, Term};
use num_bigint::BigInt;
use num_integer::Integer;
use num_rational::BigRational;
use num_traits::{One, Signed, Zero};

/// The motions on which a form is zero.
#[derive(Clone, Debug)]
pub struct NullSpace {
    /// Independent vectors, each verified exactly.
    pub vectors: Vec<Vec<Rational>>,
    /// The dimension for unknowns in general position. It is larger than the number of vectors only if some of the
    /// form's numbers are not rational, so that no rational vector can be given.
    pub dimension: usize,
    /// Whether no number is known only by its enclosure: then the dimension is at least the true one, whatever the
    /// numbers are.
    pub exact: bool,
    /// The coordinates that can be chosen freely: in the j-th vector of the reduced basis the j-th of them is 1, the
    /// others are 0.
    pub free: Vec<usize>,
}

/// The exact null space of `form` on n coordinates.
pub fn null_space(form: &Form, n: usize) -> NullSpace {
    let positive = form.terms().all(|term| term.weight.is_positive());
    let images = Image::all_of(form);
    let rational = relevant_numbers(form, positive).all(|number| number.exact().is_some());
    let exact =
        rational || relevant_numbers(form, positive).all(|number| images.iter().all(|image| image.preserves(number)));
    let most = if rational { images.len() } else { 2 };
    let mut best: Option<Echelon> = None;
    let mut space = NullSpace { vectors: Vec::new(), dimension: n, exact, free: (0..n).collect() };
    for image in images.iter().take(most) {
        let Some(next) = Echelon::of(form, n, positive, image) else { continue };
        let combined = match best.take() {
            Some(known) => known.combined_with(next),
            None => next,
        };
        space = NullSpace { exact, ..combined.null_space(form, n, positive) };
        if space.vectors.len() == space.dimension {
            break;
        }
        best = Some(combined);
    }
    space
}

/// The numbers that determine the null space: without the weights if all are positive.
fn relevant_numbers(form: &Form, positive: bool) -> impl Iterator<Item = &Number> {
    form.terms().flat_map(move |term| {
        let weight = (!positive).then_some(term.weight);
        weight.into_iter().chain(form.row(term).iter().map(|(_, a)| a))
    })
}

/// The reduced row echelon form of a form's matrix modulo one prime or a product of primes, stored by its columns
/// without a pivot: the null vector of each has a one there and these residues in the columns with pivots.
struct Echelon {
    modulus: BigInt,
    free: Vec<usize>,
    vectors: Vec<Vec<BigInt>>,
}

impl Echelon {
    /// `None` if a denominator is a multiple of the prime.
    fn of(form: &Form, n: usize, positive: bool, image: &Image) -> Option<Echelon> {
        let field = image.field;
        let mut matrix = residue_matrix(form, n, positive, image)?;
        let pivots = reduce(&field, &mut matrix, n);
        let free: Vec<usize> = (0..n).filter(|j| pivots.binary_search(j).is_err()).collect();
        let vectors = free.iter().map(|&column| null_vector(&matrix, &pivots, column, field)).collect();
        Some(Echelon { modulus: field.prime().into(), free, vectors })
    }

    /// Combines the residues of both (Chinese remainder theorem). A prime that divides a minor finds a smaller rank or
    /// later pivots: then only the other one is used.
    fn combined_with(self, other: Echelon) -> Echelon {
        if self.free != other.free {
            let smaller = (self.free.len(), &other.free) < (other.free.len(), &self.free);
            return if smaller { self } else { other };
        }
        let modulus = &self.modulus * &other.modulus;
        // inverse x self.modulus = 1 modulo the other, by Euclid.
        let inverse = self.modulus.extended_gcd(&other.modulus).x;
        let join = |a: &BigInt, b: &BigInt| {
            let step = ((b - a) * &inverse).mod_floor(&other.modulus);
            a + step * &self.modulus
        };
        let vectors = (self.vectors.iter().zip(&other.vectors))
            .map(|(a, b)| a.iter().zip(b).map(|(a, b)| join(a, b)).collect())
            .collect();
        Echelon { modulus, free: self.free, vectors }
    }

    /// The null vectors that can be recovered and verified.
    fn null_space(&self, form: &Form, n: usize, positive: bool) -> NullSpace {
        let recovered = self.vectors.iter().filter_map(|vector| {
            let vector: Option<Vec<Rational>> = vector.iter().map(|x| recover_rational(x, &self.modulus)).collect();
            vector.filter(|v| is_null(form, n, positive, v))
        });
        NullSpace { vectors: recovered.collect(), dimension: self.free.len(), exact: false, free: self.free.clone() }
    }
}

/// The reduced basis of the null space of positive terms as enclosures, for vectors that are not rational: with the
/// free coordinates given, the others solve a positive definite system, which is eliminated in balls. `None` if the
/// elimination does not prove it regular.
pub fn enclosed_vectors(form: &Form, n: usize, free: &[usize]) -> Option<Vec<Vec<Number>>> {
    let bound: Vec<usize> = (0..n).filter(|i| !free.contains(i)).collect();
    let mut matrix = vec![vec![Ball::ZERO; n]; n];
    for term in form.terms() {
        // The null space does not depend on the weights: rows of length one make the system well conditioned.
        let row: Vec<(usize, Ball)> = form.row(term).iter().map(|(i, a)| (i.index(), a.to_ball())).collect();
        let square: f64 = row.iter().map(|(_, a)| a.to_f64() * a.to_f64()).sum();
        let weight = Ball::from(1.0 / square);
        for &(i, a) in &row {
            for &(j, b) in &row {
                matrix[i][j] = matrix[i][j] + weight * a * b;
            }
        }
    }
    // The effect of the free coordinates is to be balanced.
    let of = |columns: &[usize]| Matrix::from_fn(bound.len(), columns.len(), |i, j| matrix[bound[i]][columns[j]]);
    let solved = enclosure::solve(&of(&bound), &of(free))?;
    let vector = |column: usize| {
        let mut vector = vec![Number::ZERO; n];
        vector[free[column]] = Number::ONE;
        for (&x, &i) in solved.column(column).iter().zip(&bound) {
            vector[i] = Number::from(-x);
        }
        vector
    };
    Some((0..free.len()).map(vector).collect())
}

/// sum w a a^T modulo the prime, row by row.
fn residue_matrix(form: &Form, n: usize, positive: bool, image: &Image) -> Option<Vec<Vec<u64>>> {
    let field = image.field;
    let mut matrix = vec![vec![0; n]; n];
    for (t, term) in form.terms().enumerate() {
        let weight = if positive { field.random(t as u64) } else { image.of(term.weight)? };
        let row = form.row(term);
        for (i, a) in row {
            let weighted = field.multiply(weight, image.of(a)?);
            for (j, b) in row {
                let entry = &mut matrix[i.index()][j.index()];
                *entry = field.add(*entry, field.multiply(weighted, image.of(b)?));
            }
        }
    }
    Some(matrix)
}

fn null_vector(matrix: &[Vec<u64>], pivots: &[usize], free: usize, field: Field) -> Vec<BigInt> {
    let mut vector = vec![BigInt::zero(); matrix.len()];
    vector[free] = BigInt::one();
    for (row, &pivot) in matrix.iter().zip(pivots) {
        vector[pivot] = field.negate(row[free]).into();
    }
    vector
}

/// The fraction n/d with |n|, d below sqrt(modulus / 2) and n = x d modulo it, by Euclid's algorithm stopped half-way
/// (Wang 1981; unique because 2 |n| d < modulus).
fn recover_rational(x: &BigInt, modulus: &BigInt) -> Option<Rational> {
    if x.is_zero() || x.is_one() {
        return Some(if x.is_zero() { Rational::ZERO } else { Rational::ONE });
    }
    let limit = (modulus >> 1u32).sqrt();
    let (mut a, mut b) = (modulus.clone(), x.clone());
    let (mut s, mut t) = (BigInt::zero(), BigInt::one());
    while b >= limit {
        let q = &a / &b;
        (a, b) = (b.clone(), a - &q * b);
        (s, t) = (t.clone(), s - q * t);
    }
    (!t.is_zero() && t.abs() < limit).then(|| Rational::from(BigRational::new(b, t)))
}

/// Whether the motion v is exactly rigid: the form is zero on it.
pub fn is_rigid(form: &Form, v: &[Rational]) -> bool {
    is_null(form, v.len(), form.terms().all(|term| term.weight.is_positive()), v)
}

/// Whether the form times v is exactly zero: for positive weights every row is orthogonal to v, otherwise the sum of
/// all terms vanishes.
fn is_null(form: &Form, n: usize, positive: bool, v: &[Rational]) -> bool {
    let mut force = vec![Unknowns::default(); if positive { 0 } else { n }];
    for term in form.terms() {
        let mut stretch = Unknowns::default();
        for (i, a) in form.row(term) {
            stretch.add(a, &v[i.index()]);
        }
        if stretch.vanishes() {
            continue;
        }
        if positive || !add_force(form, term, stretch, &mut force) {
            return false;
        }
    }
    force.iter().all(Unknowns::vanishes)
}

/// Adds w a (a . v); returns `false` if the sum is no longer linear in unknowns.
fn add_force(form: &Form, term: Term, stretch: Unknowns, force: &mut [Unknowns]) -> bool {
    let Some(stretch) = stretch.rational() else { return false };
    for (i, a) in form.row(term) {
        match (term.weight.exact(), a.exact()) {
            (_, Some(a)) => force[i.index()].add(term.weight, &(a * &stretch)),
            (Some(weight), None) => force[i.index()].add(a, &(weight * &stretch)),
            (None, None) => match term.weight * a {
                // The product is no longer one of the form's own numbers.
                Number::Ball(_) | Number::Jet(_) => return false,
                product => force[i.index()].add(&product, &stretch),
            },
        }
    }
    true
}

/// A rational plus rational multiples of unknown numbers, each identified by its enclosure.
#[derive(Clone, Debug)]
struct Unknowns {
    exact: Rational,
    others: Vec<([u64; 3], Rational)>,
}

impl Default for Unknowns {
    fn default() -> Unknowns {
        Unknowns { exact: Rational::ZERO, others: Vec::new() }
    }
}

impl Unknowns {
    fn add(&mut self, number: &Number, factor: &Rational) {
        if factor.is_zero() {
            return;
        }
        match number {
            Number::Exact(value) => self.exact = &self.exact + &(value * factor),
            Number::Pi(pi) => match pi.factor().exact() {
                Some(fraction) => self.add_unknown(&pi.power_of_pi(), fraction * factor),
                None => self.add_unknown(&number.to_ball(), factor.clone()),
            },
            Number::Surd(surd) => {
                self.exact = &self.exact + &(&surd.rational * factor);
                self.add_unknown(&surd.root_ball(), &surd.factor * factor);
            }
            Number::Ball(_) | Number::Jet(_) => self.add_unknown(&number.to_ball(), factor.clone()),
        }
    }

    fn add_unknown(&mut self, unknown: &Ball, factor: Rational) {
        let (key, negative) = identity(unknown);
        let factor = if negative { -&factor } else { factor };
        match self.others.iter_mut().find(|(other, _)| *other == key) {
            Some((_, sum)) => *sum = &*sum + &factor,
            None => self.others.push((key, factor)),
        }
    }

    fn vanishes(&self) -> bool {
        self.exact.is_zero() && self.others.iter().all(|(_, factor)| factor.is_zero())
    }

    fn rational(self) -> Option<Rational> {
        self.others.iter().all(|(_, factor)| factor.is_zero()).then_some(self.exact)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::{Name, Words};
    use crate::kernel::residues::PRIMES;
    use crate::system::{CoordinateId, Label, Nature};

    fn form(terms: &[(Number, &[(u32, Number)])]) -> Form {
        let mut words = Words::new();
        let mut form = Form::new();
        let source = form.source(Label { name: Name::plain(words.intern("s")), motion: "" });
        for (weight, row) in terms {
            let row = row.iter().map(|(i, a)| (CoordinateId(*i), a.clone()));
            form.push(source, Nature::Property, weight.clone(), row);
        }
        form
    }

    fn n(text: &str) -> Number {
        match text.strip_prefix('-') {
            Some(digits) => -&Number::from(digits),
            None => Number::from(text),
        }
    }

    #[test]
    fn a_free_chain_moves_as_a_whole() {
        let rows = [[(0, n("1")), (1, n("-1"))], [(1, n("1")), (2, n("-1"))]];
        let space = null_space(&form(&[(n("1e12"), &rows[0]), (n("1e-12"), &rows[1])]), 3);
        assert_eq!(space.dimension, 1);
        assert_eq!(space.vectors, vec![vec![Rational::ONE; 3]]);
    }

    #[test]
    fn decimal_lever_arms_are_exact() {
        // Two bodies 1.3 m apart, springs at 0.3 and 0.9: they heave together, and they turn together.
        let rows = [
            [(0, n("-1")), (1, n("-0.3")), (2, n("1")), (3, n("-1"))],
            [(0, n("-1")), (1, n("-0.9")), (2, n("1")), (3, n("-0.4"))],
        ];
        let space = null_space(&form(&[(n("1"), &rows[0]), (n("3"), &rows[1])]), 4);
        assert_eq!((space.vectors.len(), space.dimension), (2, 2));
    }

    #[test]
    fn exact_buckling_is_a_null_vector_of_the_sum() {
        let row = [(0, n("1"))];
        let space = null_space(&form(&[(n("9.81"), &row), (n("-9.81"), &row)]), 1);
        assert_eq!(space.vectors.len(), 1);
        assert!(null_space(&form(&[(n("9.81"), &row), (n("-9.8100000000001"), &row)]), 1).vectors.is_empty());
    }

    #[test]
    fn equal_enclosures_cancel() {
        let third = n("3").sqrt().expect("positive");
        let row = [(0, third.clone()), (1, -&third)];
        let space = null_space(&form(&[(n("5"), &row)]), 2);
        assert_eq!(space.vectors, vec![vec![Rational::ONE; 2]]);
    }

    #[test]
    fn vectors_of_many_digits_take_more_primes() {
        // (x + a y) = 0 with a of 40 digits: the null vector is (-a, 1), or (1, -1/a).
        let row = [(0, n("1")), (1, n("0.9000000000000000222044604925031308084726"))];
        let space = null_space(&form(&[(n("7"), &row)]), 2);
        assert_eq!((space.vectors.len(), space.dimension), (1, 1));
    }

    #[test]
    fn an_irrational_motion_is_counted_but_not_given() {
        let row = [(0, n("3").sqrt().expect("positive")), (1, n("1"))];
        let space = null_space(&form(&[(n("7"), &row)]), 2);
        assert_eq!((space.vectors.len(), space.dimension), (0, 1));
    }

    #[test]
    fn fractions_come_back_from_their_residues() {
        let field = PRIMES[0];
        for (p, q) in [(13, 10), (-7, 3), (123_456, 789_101), (1, 1)] {
            let value = Rational::new(p, q);
            let found = Image::rational(field).of(&Number::from(value.clone())).map(BigInt::from);
            assert_eq!(found.and_then(|x| recover_rational(&x, &field.prime().into())), Some(value));
        }
    }
}
