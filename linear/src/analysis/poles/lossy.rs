//! Poles of a part whose springs have loss factors: the zeros of det(M s^2 + C s + K + i H) in the upper half plane, and their
//! mirror images, since the sign of the loss is that of the frequency. In: the terms of a small independent part, all
//! rational. Out: all of these poles. See docs/method/poles.md#loss-factors.

use super::exact::{
    self, ExactPoles, ExactRoot, FIRST_BITS, Holomorphic, MOST_BITS, MOST_COORDINATES, Rooted, assemble, circles,
    iterate, radius, roots_of_factor,
};
use crate::analysis::modes::parts::Part;
use crate::base::Rational;
use crate::kernel::big_float::ComplexFloat;
use crate::kernel::polynomial::{Polynomial, determinant};
use crate::system::{LinearSystem, Losses};
use num_bigint::{BigInt, Sign};
use num_integer::Integer;
use num_traits::One;

/// The terms of the loss factors, by the parts that they are of.
pub fn terms_by_part(losses: &Losses, parts: &[Part], n: usize) -> Vec<Vec<u32>> {
    let mut part_of = vec![0; n];
    for (number, part) in parts.iter().enumerate() {
        part.coordinates.iter().for_each(|&c| part_of[c as usize] = number);
    }
    let mut terms = vec![Vec::new(); parts.len()];
    for (index, term) in (0..).zip(losses.h.terms()) {
        if let Some((i, _)) = losses.h.row(term).first() {
            terms[part_of[i.index()]].push(index);
        }
    }
    terms
}

/// The poles of a part with these terms of loss factors; `None` if it is too large, a term is not rational, roots cannot be
/// separated, or not every other root is in the upper half plane.
pub fn lossy_poles(
    system: &LinearSystem,
    (losses, terms): (&Losses, &[u32]),
    part: &Part,
    local: &[u32],
) -> Option<ExactPoles> {
    let n = part.coordinates.len();
    if n > MOST_COORDINATES {
        return None;
    }
    let forms = [(&system.k, &part.k[..]), (&system.c, &part.c), (&system.m, &part.m), (&losses.h, terms)];
    let mut matrices = Vec::with_capacity(forms.len());
    for (form, terms) in forms {
        matrices.push(assemble(form, terms, local, n)?);
    }
    let Gaussian { re, im } = characteristic(&clear_denominators(&matrices), n);
    // The common factor of both parts has the poles of motions without losses, with their conjugates.
    let common = re.gcd(&im)?;
    let lossy = Gaussian { re: re.divided_by(&common)?, im: im.divided_by(&common)? };
    let (zeros, rest) = common.without_zero_roots();
    let mut roots = Vec::new();
    for (index, factor) in rest.by_multiplicity()?.iter().enumerate().filter(|(_, factor)| factor.degree() > 0) {
        roots.extend(roots_of_factor(factor, index + 1, false)?);
    }
    let upper = lossy.upper_roots()?;
    if 2 * upper.len() != lossy.degree() {
        return None;
    }
    roots.extend(upper);
    ExactPoles::with_count(zeros, roots, common.degree() + lossy.degree())
}

/// Matrices of fractions, multiplied by one integer that clears all denominators.
fn clear_denominators(matrices: &[Vec<Vec<Rational>>]) -> Vec<Vec<Vec<BigInt>>> {
    let entries = matrices.iter().flatten().flatten();
    let common = entries.map(|x| x.to_big().denom().clone()).fold(BigInt::one(), |lcm, d| lcm.lcm(&d));
    let whole = |x: &Rational| x.to_big().numer() * (&common / x.to_big().denom());
    let matrix = |rows: &Vec<Vec<Rational>>| rows.iter().map(|row| row.iter().map(whole).collect()).collect();
    matrices.iter().map(matrix).collect()
}

/// det(K + C s + M s^2 + i H), times a whole number. For each s, det(.. + t H) is a polynomial in t with the value wanted at t = i.
fn characteristic(matrices: &[Vec<Vec<BigInt>>], n: usize) -> Gaussian {
    let [k, c, m, h] = matrices else {
        return Gaussian { re: Polynomial::new(Vec::new()), im: Polynomial::new(Vec::new()) };
    };
    let at = |s: i64, t: i64| {
        let entry = |i: usize, j: usize| (&m[i][j] * s + &c[i][j]) * s + &k[i][j] + &h[i][j] * t;
        determinant((0..n).map(|i| (0..n).map(|j| entry(i, j)).collect()).collect())
    };
    let at_i = |s: i64| {
        let of_t = Polynomial::of_values(&(0..=n as i64).map(|t| at(s, t)).collect::<Vec<_>>());
        let mut parts = [BigInt::default(), BigInt::default()];
        for (power, a) in of_t.coefficients().iter().enumerate() {
            let signed = if power % 4 < 2 { a.clone() } else { -a };
            parts[power % 2] += signed;
        }
        parts
    };
    let (re, im): (Vec<BigInt>, Vec<BigInt>) = (0..=2 * n as i64).map(|s| at_i(s).into()).unzip();
    Gaussian { re: Polynomial::of_values(&re), im: Polynomial::of_values(&im) }
}

/// A polynomial whose coefficients are Gaussian integers: re + i im.
struct Gaussian {
    re: Polynomial,
    im: Polynomial,
}

impl Holomorphic for Gaussian {
    fn at(&self, z: &ComplexFloat, bits: Option<u64>) -> ComplexFloat {
        let (re, im) = (exact::value(&self.re, z, bits), exact::value(&self.im, z, bits));
        ComplexFloat::new(&re.re - &im.im, &re.im + &im.re)
    }
}

impl Gaussian {
    fn degree(&self) -> usize {
        self.re.degree().max(self.im.degree())
    }

    /// Coefficients as large as these, for where to look for roots.
    fn sizes(&self) -> Polynomial {
        let of = |f: &Polynomial, i: usize| f.coefficients().get(i).map_or(BigInt::default(), abs);
        Polynomial::new((0..=self.degree()).map(|i| of(&self.re, i) + of(&self.im, i)).collect())
    }

    /// The roots above the real axis; `None` if there are others than simple ones that are clear of it. The proof is that of
    /// real polynomials: as many disjoint discs as the degree, each of which contains a root.
    fn upper_roots(&self) -> Option<Vec<ExactRoot>> {
        if self.degree() == 0 {
            return Some(Vec::new());
        }
        let slope = Gaussian { re: self.re.derivative(), im: self.im.derivative() };
        let mut values = circles(&self.sizes());
        let mut bits = FIRST_BITS;
        while bits <= MOST_BITS {
            iterate(self, &slope, &mut values, bits);
            if let Some(discs) = self.discs(&slope, &values) {
                let above = discs.iter().filter(|disc| !disc.z.im.is_negative());
                let root =
                    |disc: &Rooted| ExactRoot { s: disc.enclosure(), multiplicity: 1, real: false, defective: false };
                return Some(above.map(root).collect());
            }
            bits *= 2;
        }
        None
    }

    fn discs(&self, slope: &Gaussian, values: &[ComplexFloat]) -> Option<Vec<Rooted>> {
        let disc = |z: &ComplexFloat| Some(Rooted { z: z.clone(), radius: radius(self, slope, z, self.degree())? });
        let discs: Vec<Rooted> = values.iter().map(disc).collect::<Option<_>>()?;
        let is_apart = |(i, a): (usize, &Rooted)| discs[..i].iter().all(|b| a.is_apart_from(b));
        let is_whole = discs.len() == self.degree() && discs.iter().enumerate().all(is_apart);
        let is_clear = |disc: &Rooted| disc.is_sharp() && disc.is_clear_of_the_axis();
        (is_whole && discs.iter().all(is_clear)).then_some(discs)
    }
}

fn abs(x: &BigInt) -> BigInt {
    if x.sign() == Sign::Minus { -x } else { x.clone() }
}
