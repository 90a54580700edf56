//! Exact polynomials with integer coefficients: products, division, greatest common divisors, and the factors in which
//! every root is simple. See docs/method/poles.md#exact-arithmetic.

use crate::kernel::residues::{Field, primes};
use num_bigint::{BigInt, Sign};
use num_integer::Integer;
use num_traits::{One, Signed, ToPrimitive, Zero};

/// Limit of primes: coefficients of greatest common divisors may have 61 bits for each.
const MOST_PRIMES: usize = 400;

/// a_0 + a_1 s + ... + a_d s^d, a_d not zero; empty for the zero polynomial.
#[derive(Clone, Debug, PartialEq)]
pub struct Polynomial {
    coefficients: Vec<BigInt>,
}

impl Polynomial {
    pub fn new(mut coefficients: Vec<BigInt>) -> Polynomial {
        while coefficients.last().is_some_and(Zero::is_zero) {
            coefficients.pop();
        }
        Polynomial { coefficients }
    }

    pub fn coefficients(&self) -> &[BigInt] {
        &self.coefficients
    }

    pub fn is_zero(&self) -> bool {
        self.coefficients.is_empty()
    }

    /// The degree; also zero for the zero polynomial.
    pub fn degree(&self) -> usize {
        self.coefficients.len().saturating_sub(1)
    }

    /// The polynomial through the integer values at 0, 1, ..., d, up to a positive factor.
    pub fn through(values: &[BigInt]) -> Polynomial {
        Polynomial::of_values(values).primitive()
    }

    /// d! times the polynomial through the integer values at 0, 1, ..., d: Newton's divided differences, all multiplied by d!.
    pub fn of_values(values: &[BigInt]) -> Polynomial {
        let d = values.len().saturating_sub(1);
        let mut differences = values.to_vec();
        let mut newton: Vec<BigInt> = Vec::with_capacity(values.len());
        // d! / k! times the k-th forward difference at 0.
        let mut weight: BigInt = (1..=d).map(BigInt::from).product();
        for k in 0..values.len() {
            newton.push(&differences[0] * &weight);
            weight /= k + 1;
            differences = differences.windows(2).map(|pair| &pair[1] - &pair[0]).collect();
        }
        // Horner's scheme in s - k.
        let mut sum = vec![BigInt::zero(); values.len()];
        for (k, value) in newton.iter().enumerate().rev() {
            for i in (1..sum.len()).rev() {
                let shifted = &sum[i - 1] - &sum[i] * k;
                sum[i] = shifted;
            }
            if let Some(first) = sum.first_mut() {
                *first = value - &*first * k;
            }
        }
        Polynomial::new(sum)
    }

    /// The polynomial divided by the greatest common divisor of its coefficients, with a positive leading coefficient.
    pub fn primitive(&self) -> Polynomial {
        let content = self.coefficients.iter().fold(BigInt::zero(), |gcd, a| gcd.gcd(a));
        if content.is_zero() {
            return self.clone();
        }
        let content = if self.coefficients.last().is_some_and(Signed::is_negative) { -content } else { content };
        Polynomial::new(self.coefficients.iter().map(|a| a / &content).collect())
    }

    /// f(-s^2)
    pub fn of_minus_square(&self) -> Polynomial {
        let signed = |(k, a): (usize, &BigInt)| [if k % 2 == 0 { a.clone() } else { -a }, BigInt::zero()];
        Polynomial::new(self.coefficients.iter().enumerate().flat_map(signed).collect())
    }

    pub fn derivative(&self) -> Polynomial {
        Polynomial::new(self.coefficients.iter().enumerate().skip(1).map(|(k, a)| a * k).collect())
    }

    /// The multiplicity of the root 0, and the quotient without it.
    pub fn without_zero_roots(&self) -> (usize, Polynomial) {
        let zeros = self.coefficients.iter().take_while(|a| a.is_zero()).count();
        (zeros, Polynomial::new(self.coefficients[zeros..].to_vec()))
    }

    /// self / divisor, if that is a polynomial with integer coefficients.
    pub fn divided_by(&self, divisor: &Polynomial) -> Option<Polynomial> {
        let lead = divisor.coefficients.last()?;
        let shift = self.coefficients.len().checked_sub(divisor.coefficients.len())?;
        let mut rest = self.coefficients.clone();
        let mut quotient = vec![BigInt::zero(); shift + 1];
        for k in (0..=shift).rev() {
            let (factor, remainder) = rest[k + divisor.degree()].div_rem(lead);
            if !remainder.is_zero() {
                return None;
            }
            for (i, a) in divisor.coefficients.iter().enumerate() {
                rest[k + i] -= a * &factor;
            }
            quotient[k] = factor;
        }
        rest.iter().all(Zero::is_zero).then(|| Polynomial::new(quotient))
    }

    /// The greatest common divisor, primitive; `None` if there are not enough primes for its coefficients.
    ///
    /// Its images modulo primes are combined by the Chinese remainder theorem until it divides both (Brown, JACM 18
    /// (1971) 478). The image's degree is never too small, so an image of degree 0 is a proof, and a candidate that
    /// divides both is the greatest.
    pub fn gcd(&self, other: &Polynomial) -> Option<Polynomial> {
        let (f, g) = (self.primitive(), other.primitive());
        if f.is_zero() || g.is_zero() {
            return Some(if f.is_zero() { g } else { f });
        }
        let lead = f.coefficients[f.degree()].gcd(&g.coefficients[g.degree()]);
        let mut combined: Option<(BigInt, Vec<BigInt>)> = None;
        for field in primes().take(MOST_PRIMES) {
            let Some(image) = image_of_gcd(&f, &g, &lead, field) else { continue };
            if image.len() == 1 {
                return Some(Polynomial::new(vec![BigInt::one()]));
            }
            let next = match combined.take() {
                Some((modulus, known)) if known.len() < image.len() => (modulus, known),
                Some((modulus, known)) if known.len() == image.len() => join_images(modulus, known, &image, field),
                _ => (field.prime().into(), image.iter().map(|&a| BigInt::from(a)).collect()),
            };
            let candidate = Polynomial::new(symmetric(&next)).primitive();
            if f.divided_by(&candidate).is_some() && g.divided_by(&candidate).is_some() {
                return Some(candidate);
            }
            combined = Some(next);
        }
        None
    }

    /// Factors f_1, f_2, ... without common or repeated roots: the roots of f_i are those of multiplicity i (Yun 1976).
    pub fn by_multiplicity(&self) -> Option<Vec<Polynomial>> {
        let derivative = self.derivative();
        let common = self.gcd(&derivative)?;
        let mut b = self.primitive().divided_by(&common)?;
        let mut rest = common;
        let mut factors = Vec::new();
        while b.degree() > 0 {
            let next = b.gcd(&rest)?;
            factors.push(b.divided_by(&next)?);
            rest = rest.divided_by(&next)?;
            b = next;
        }
        Some(factors)
    }
}

/// lead times the monic greatest common divisor modulo the prime; `None` if the prime divides the leading coefficients.
fn image_of_gcd(f: &Polynomial, g: &Polynomial, lead: &BigInt, field: Field) -> Option<Vec<u64>> {
    let (mut a, mut b) = (residues(f, field), residues(g, field));
    if a.len() != f.coefficients.len() || b.len() != g.coefficients.len() {
        return None;
    }
    while !b.is_empty() {
        reduce(&mut a, &b, field);
        std::mem::swap(&mut a, &mut b);
    }
    let scale = field.multiply(field.inverse(*a.last()?), residue(lead, field));
    Some(a.iter().map(|&x| field.multiply(x, scale)).collect())
}

/// a <- a modulo b.
fn reduce(a: &mut Vec<u64>, b: &[u64], field: Field) {
    let Some(&lead) = b.last() else { return };
    let inverse = field.inverse(lead);
    while a.len() >= b.len() {
        let shift = a.len() - b.len();
        let factor = field.negate(field.multiply(a[a.len() - 1], inverse));
        for (i, &x) in b.iter().enumerate() {
            a[shift + i] = field.add(a[shift + i], field.multiply(factor, x));
        }
        trim(a);
    }
}

fn trim(a: &mut Vec<u64>) {
    while a.last() == Some(&0) {
        a.pop();
    }
}

fn residues(f: &Polynomial, field: Field) -> Vec<u64> {
    let mut list: Vec<u64> = f.coefficients.iter().map(|a| residue(a, field)).collect();
    trim(&mut list);
    list
}

fn residue(a: &BigInt, field: Field) -> u64 {
    a.mod_floor(&field.prime().into()).to_u64().expect("a residue is below the prime")
}

/// The coefficients modulo modulus times prime.
fn join_images(modulus: BigInt, known: Vec<BigInt>, image: &[u64], field: Field) -> (BigInt, Vec<BigInt>) {
    let inverse = field.inverse(residue(&modulus, field));
    let join = |(x, &y): (BigInt, &u64)| {
        let difference = field.add(y, field.negate(residue(&x, field)));
        x + &modulus * field.multiply(difference, inverse)
    };
    let list = known.into_iter().zip(image).map(join).collect();
    (modulus * field.prime(), list)
}

/// Residues reduced to between plus and minus half the modulus.
fn symmetric((modulus, list): &(BigInt, Vec<BigInt>)) -> Vec<BigInt> {
    let fold = |x: &BigInt| if x + x > *modulus { x - modulus } else { x.clone() };
    list.iter().map(fold).collect()
}

/// The determinant of a square matrix of integers by fraction-free elimination (Bareiss, Math. Comp. 22 (1968) 565).
pub fn determinant(mut a: Vec<Vec<BigInt>>) -> BigInt {
    let n = a.len();
    let (mut last, mut sign) = (BigInt::one(), Sign::Plus);
    for p in 0..n {
        let Some(found) = (p..n).find(|&i| !a[i][p].is_zero()) else { return BigInt::zero() };
        if found != p {
            a.swap(p, found);
            sign = -sign;
        }
        let (head, below) = a.split_at_mut(p + 1);
        let pivot_row = &head[p];
        for row in below {
            for j in p + 1..n {
                row[j] = (&row[j] * &pivot_row[p] - &row[p] * &pivot_row[j]) / &last;
            }
        }
        last = pivot_row[p].clone();
    }
    if sign == Sign::Minus { -last } else { last }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn polynomial(coefficients: &[i64]) -> Polynomial {
        Polynomial::new(coefficients.iter().map(|&a| a.into()).collect())
    }

    fn product(f: &Polynomial, g: &Polynomial) -> Polynomial {
        let mut sum = vec![BigInt::zero(); f.coefficients.len() + g.coefficients.len() - 1];
        for (i, a) in f.coefficients.iter().enumerate() {
            for (j, b) in g.coefficients.iter().enumerate() {
                sum[i + j] += a * b;
            }
        }
        Polynomial::new(sum)
    }

    #[test]
    fn values_give_their_polynomial() {
        let f = polynomial(&[-7, 0, 3, 2]);
        let value = |s: i64| BigInt::from(-7 + 3 * s * s + 2 * s * s * s);
        assert_eq!(Polynomial::through(&(0..5).map(value).collect::<Vec<_>>()), f);
    }

    #[test]
    fn roots_are_sorted_by_their_multiplicity() {
        let (simple, double, triple) =
            (polynomial(&[5, 1, 3]), polynomial(&[-2, 7]), polynomial(&[123_456_789_123, 1_000_000_007]));
        let squared = product(&double, &double);
        let cubed = product(&product(&triple, &triple), &triple);
        let f = product(&product(&simple, &squared), &cubed);
        assert_eq!(f.by_multiplicity(), Some(vec![simple, double, triple]));
        assert_eq!(polynomial(&[1, 3, 1]).by_multiplicity(), Some(vec![polynomial(&[1, 3, 1])]));
    }

    /// Two near-critical pairs, each twice: the common divisor has coefficients of a thousand bits.
    #[test]
    fn long_coefficients_have_common_divisors_too() {
        let big = BigInt::from(10).pow(150u32);
        let pair = |c: i64| Polynomial::new(vec![big.clone(), &big * 2 + c, big.clone()]);
        let both = product(&pair(1), &pair(-1));
        let squared = product(&both, &both);
        assert_eq!(squared.by_multiplicity(), Some(vec![polynomial(&[1]), both]));
    }

    #[test]
    fn a_non_divisor_is_rejected() {
        assert_eq!(polynomial(&[1, 2, 1]).divided_by(&polynomial(&[1, 1])), Some(polynomial(&[1, 1])));
        assert_eq!(polynomial(&[1, 2, 2]).divided_by(&polynomial(&[1, 1])), None);
    }

    #[test]
    fn zero_roots_are_split_off() {
        assert_eq!(polynomial(&[0, 0, 4, 2]).without_zero_roots(), (2, polynomial(&[4, 2])));
    }

    #[test]
    fn a_determinant_with_a_zero_pivot() {
        let rows = [[0, 2, 1], [3, 0, 4], [1, 5, 0]].map(|row| row.map(BigInt::from).to_vec()).to_vec();
        assert_eq!(determinant(rows), BigInt::from(23));
    }
}
