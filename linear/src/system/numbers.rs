//! A list of numbers that holds each once, as far as that is cheap to see: a scene of a million springs has few different
//! stiffnesses, and nearly all entries of its rows are 1 or -1. What refers to a number has its place in the list, in a
//! quarter of a number's memory, and what is derived from a number can be computed once for all that have it.

use crate::base::{Ball, Dd, Number};

/// Places in the list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place(pub u32);

impl Place {
    /// 1 in every list that is not empty.
    pub const ONE: Place = Place(0);
    /// -1 in every list that is not empty.
    pub const MINUS_ONE: Place = Place(1);

    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// See the module.
#[derive(Clone, Debug, Default)]
pub struct Numbers {
    list: Vec<Number>,
}

/// Numbers met before this many others are not looked for: they would be in the list twice, which costs memory alone.
const RECENT: usize = 8;

impl Numbers {
    /// The place of a number, which is put into the list unless it is one of the last.
    pub fn put(&mut self, number: Number) -> Place {
        if self.list.is_empty() {
            self.list.extend([Number::ONE, -&Number::ONE]);
        }
        let signs = &self.list[..2];
        let last = self.list.iter().enumerate().skip(2).rev().take(RECENT);
        match signs.iter().enumerate().chain(last).find(|(_, known)| are_the_same(known, &number)) {
            Some((place, _)) => Place(place as u32),
            None => {
                self.list.push(number);
                Place(u32::try_from(self.list.len() - 1).expect("the number of entries is limited far below"))
            }
        }
    }

    #[inline]
    pub fn at(&self, place: Place) -> &Number {
        &self.list[place.index()]
    }

    /// All numbers, in the order of their places.
    pub fn all(&self) -> &[Number] {
        &self.list
    }

    pub fn clear(&mut self) {
        self.list.clear();
    }
}

/// Whether two numbers are the same to the last bit. Numbers over a range are told apart: each follows its own derivative.
#[inline]
fn are_the_same(a: &Number, b: &Number) -> bool {
    let bits = |ball: &Ball| {
        let Dd { hi, lo } = ball.mid;
        [hi, lo, ball.rad].map(f64::to_bits)
    };
    match (a, b) {
        (Number::Exact(a), Number::Exact(b)) => a == b,
        (Number::Ball(a), Number::Ball(b)) => bits(a) == bits(b),
        (Number::Surd(a), Number::Surd(b)) => a == b,
        (Number::Pi(a), Number::Pi(b)) => are_the_same(a.factor(), b.factor()) && a.power() == b.power(),
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::{Jet, Rational};

    fn ball(hi: f64, lo: f64, rad: f64) -> Number {
        Number::Ball(Ball { mid: Dd { hi, lo }, rad })
    }

    /// Every number comes back as it was put in, to the sign of a zero, and equal ones have one place.
    #[test]
    fn each_number_is_kept_once_and_as_it_was() {
        let root = |factor: i64| &Number::from(2).sqrt().expect("a root") * &Number::from(factor);
        let different = [
            Number::ONE,
            -&Number::ONE,
            Number::from("0.1"),
            ball(1.0, 0.0, 0.0),
            ball(1.0, -0.0, 0.0),
            ball(1.0, 0.0, 1e-40),
            root(1),
            root(3),
            Number::pi(),
            Number::of_pi(Rational::from(2)),
        ];
        let mut numbers = Numbers::default();
        for (i, number) in different.iter().enumerate() {
            for _ in 0..3 {
                assert_eq!(numbers.put(number.clone()).index(), i, "{number:?}");
            }
        }
        assert_eq!((numbers.put(Number::ONE), numbers.put(-&Number::ONE)), (Place::ONE, Place::MINUS_ONE));
        for (number, kept) in different.iter().zip(numbers.all()) {
            assert_eq!(format!("{number:?}"), format!("{kept:?}"));
        }
        assert_eq!(numbers.all().len(), different.len());
    }

    #[test]
    fn what_was_met_long_ago_is_kept_again() {
        let mut numbers = Numbers::default();
        let places: Vec<Place> = (2..100).chain(2..100).map(|i| numbers.put(Number::from(i))).collect();
        for (i, place) in (2..100).chain(2..100).zip(places) {
            assert_eq!(numbers.at(place), &Number::from(i));
        }
    }

    /// Over a range, what is asked of one number says nothing of another with the same enclosure.
    #[test]
    fn numbers_over_a_range_are_told_apart() {
        let jet = || Number::from(Jet { value: Ball::ONE, slope: Ball::ONE });
        let mut numbers = Numbers::default();
        assert_ne!(numbers.put(jet()), numbers.put(jet()));
    }
}
