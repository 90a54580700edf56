//! The numbers of a form modulo a prime: a rational number is mapped exactly, a square root to a root modulo the prime,
//! and a number known only by its enclosure to an independent unknown (equal ones to the same unknown).
//! See docs/method/modes.md#rigid-body-modes.

use crate::base::{Ball, Number, Rational};
use crate::kernel::residues::{Field, PRIMES, scramble};
use crate::system::Form;

/// One way to read a form's numbers modulo a prime.
#[derive(Clone, Debug)]
pub struct Image {
    pub field: Field,
    /// The integers under the square roots of the form, with their roots modulo the prime.
    roots: Vec<(u32, u64)>,
}

impl Image {
    /// The images of a form modulo the primes that have all of its roots. If no prime has them, roots become unknowns
    /// like any other number.
    pub fn all_of(form: &Form) -> Vec<Image> {
        let below = radicands(form);
        let with_roots = |field: &Field| {
            let roots: Option<Vec<(u32, u64)>> = below.iter().map(|&d| Some((d, root(d, *field)?))).collect();
            Some(Image { field: *field, roots: roots? })
        };
        let images: Vec<Image> = PRIMES.iter().filter_map(with_roots).collect();
        if images.is_empty() { PRIMES.iter().map(|field| Image::rational(*field)).collect() } else { images }
    }

    /// An image for forms without square roots.
    pub fn rational(field: Field) -> Image {
        Image { field, roots: Vec::new() }
    }

    /// Whether the image of a number preserves the relations that it has with others.
    pub fn preserves(&self, number: &Number) -> bool {
        match number {
            Number::Exact(_) => true,
            Number::Surd(surd) => self.roots.iter().any(|(d, _)| *d == surd.root),
            Number::Pi(_) | Number::Ball(_) | Number::Jet(_) => false,
        }
    }

    /// `None` if a denominator is a multiple of the prime.
    pub fn of(&self, number: &Number) -> Option<u64> {
        let field = self.field;
        match number {
            Number::Exact(value) => self.of_rational(value),
            Number::Pi(pi) => match pi.factor().exact() {
                Some(fraction) => Some(field.multiply(self.of_rational(fraction)?, self.of_unknown(&pi.power_of_pi()))),
                None => Some(self.of_unknown(&number.to_ball())),
            },
            Number::Surd(surd) => {
                let known = self.roots.iter().find(|(d, _)| *d == surd.root).map(|(_, root)| *root);
                let root = known.unwrap_or_else(|| self.of_unknown(&surd.root_ball()));
                let product = field.multiply(self.of_rational(&surd.factor)?, root);
                Some(field.add(self.of_rational(&surd.rational)?, product))
            }
            Number::Ball(_) | Number::Jet(_) => Some(self.of_unknown(&number.to_ball())),
        }
    }

    fn of_rational(&self, value: &Rational) -> Option<u64> {
        match value.residues(self.field.prime()) {
            (_, 0) => None,
            (numerator, 1) => Some(numerator),
            (numerator, denominator) => Some(self.field.multiply(numerator, self.field.inverse(denominator))),
        }
    }

    fn of_unknown(&self, ball: &Ball) -> u64 {
        let (key, negative) = identity(ball);
        let x = self.field.random(key.iter().fold(0, |hash, &bits| scramble(hash ^ bits)));
        if negative { self.field.negate(x) } else { x }
    }
}

/// The bits of an enclosure up to its sign: they distinguish one enclosed number from another.
pub fn identity(ball: &Ball) -> ([u64; 3], bool) {
    let magnitude = ball.mid.abs();
    ([magnitude.hi.to_bits(), magnitude.lo.to_bits(), ball.rad.to_bits()], ball.mid.hi < 0.0)
}

/// The integers under the square roots of a form, ascending.
fn radicands(form: &Form) -> Vec<u32> {
    let numbers =
        form.terms().flat_map(|term| std::iter::once(term.weight).chain(form.row(term).iter().map(|(_, a)| a)));
    let surds = numbers.filter_map(|number| if let Number::Surd(surd) = number { Some(surd.root) } else { None });
    let mut list: Vec<u32> = surds.collect();
    list.sort_unstable();
    list.dedup();
    list
}

/// A root of d as the product of those of its prime factors, so that sqrt(2) sqrt(3) = sqrt(6) holds modulo the prime too.
fn root(mut d: u32, field: Field) -> Option<u64> {
    let (mut product, mut p) = (1, 2);
    while d > 1 {
        if p * p > d {
            p = d;
        }
        if d.is_multiple_of(p) {
            product = field.multiply(product, field.sqrt(u64::from(p))?);
            d /= p;
        }
        p += 1;
    }
    Some(product)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roots_are_roots_and_agree_with_one_another() {
        let mut found = 0;
        for field in PRIMES {
            for d in [2u32, 3, 5, 6, 30, 61, 1_000_003] {
                let Some(x) = root(d, field) else { continue };
                assert_eq!(field.multiply(x, x), u64::from(d));
                found += 1;
            }
            if let (Some(two), Some(three)) = (root(2, field), root(3, field)) {
                assert_eq!(root(6, field), Some(field.multiply(two, three)));
            }
        }
        assert!(found >= PRIMES.len(), "{found}");
    }

    #[test]
    fn half_of_all_residues_have_a_root() {
        for field in PRIMES {
            let squares = (0..200).filter(|&seed| {
                let x = field.random(seed);
                let root = field.sqrt(x);
                assert!(root.is_none_or(|root| field.multiply(root, root) == x));
                root.is_some()
            });
            assert!((70..=130).contains(&squares.count()));
        }
    }
}
