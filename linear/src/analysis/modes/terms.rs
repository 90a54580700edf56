//! A form of the system with its numbers in triple words: the weights and sparse rows of `sum w a a^T`.
//!
//! The computation of undamped modes starts from these. Any uncertainty in the model (a root, a sine, the part of a
//! decimal that does not fit into three words) is in the radii and so in every bound.

use crate::base::Dd;
use crate::kernel::triple::{Precise, Triple};
use crate::system::numbers::Place;
use crate::system::{CoordinateId, Form};

/// The squares `w a a^T` of a form, each of whose different numbers is converted once.
#[derive(Clone, Debug)]
pub struct Terms<'a> {
    form: &'a Form,
    /// In the order of their places.
    numbers: Vec<Precise>,
}

/// An entry of a row. Most are signs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Factor {
    Plus,
    Minus,
    Other(Precise),
}

/// The entries of a row.
#[derive(Clone, Copy, Debug)]
pub struct Factors<'a> {
    places: &'a [Place],
    numbers: &'a [Precise],
}

impl<'a> Terms<'a> {
    pub fn of(form: &'a Form) -> Terms<'a> {
        Terms { form, numbers: form.numbers().iter().map(Precise::of).collect() }
    }

    /// The number of terms.
    #[inline]
    pub fn len(&self) -> usize {
        self.form.len()
    }

    /// The number of entries of all rows.
    #[inline]
    pub fn entry_count(&self) -> usize {
        self.form.entry_count()
    }

    #[inline]
    pub fn weight(&self, t: usize) -> Precise {
        self.numbers[self.form.weight(t).index()]
    }

    #[inline]
    pub fn weights(&self) -> impl ExactSizeIterator<Item = Precise> {
        (0..self.len()).map(|t| self.weight(t))
    }

    /// The row of term `t`: its coordinates and their factors.
    #[inline]
    pub fn row(&self, t: usize) -> (&'a [CoordinateId], Factors<'_>) {
        let (coordinates, places) = self.form.places(t);
        (coordinates, Factors { places, numbers: &self.numbers })
    }

    /// a . x of term `t`, for an exactly known x.
    #[inline]
    pub fn stretch(&self, t: usize, x: &[Triple]) -> Precise {
        let (indices, factors) = self.row(t);
        let (mut sum, mut radius) = (Triple::ZERO, 0.0);
        for (&i, factor) in indices.iter().zip(factors.iter()) {
            let x = x[i.index()];
            let part = match factor {
                Factor::Plus => x,
                Factor::Minus => -x,
                Factor::Other(a) => {
                    let part = a.value * x;
                    radius += part.hi().abs() * (2.0 * Triple::ERROR) + a.radius * x.hi().abs() * 2.0;
                    part
                }
            };
            if sum.is_zero() {
                sum = part;
            } else {
                radius += sum.hi().abs().max(part.hi().abs()) * (2.0 * Triple::ERROR);
                sum = sum + part;
            }
        }
        Precise { value: sum, radius }
    }

    /// a . x in binary64.
    #[inline]
    pub fn stretch_f64(&self, t: usize, x: &[f64]) -> f64 {
        let (indices, factors) = self.row(t);
        indices.iter().zip(factors.iter()).map(|(&i, factor)| factor.to_f64() * x[i.index()]).sum()
    }

    /// Whether all weights are certainly positive.
    pub fn all_positive(&self) -> bool {
        self.weights().all(|w| w.value.hi() > 2.0 * w.radius)
    }

    /// Whether all weights and factors are of known size.
    pub fn is_finite(&self) -> bool {
        self.numbers.iter().all(|Precise { value, radius }| value.is_finite() && radius.is_finite())
    }
}

impl<'a> Factors<'a> {
    #[inline]
    pub fn len(self) -> usize {
        self.places.len()
    }

    #[inline]
    pub fn at(self, k: usize) -> Factor {
        factor(self.places[k], self.numbers)
    }

    /// The factors from number `k` on.
    #[inline]
    pub fn from(self, k: usize) -> Factors<'a> {
        Factors { places: &self.places[k..], ..self }
    }

    #[inline]
    pub fn iter(self) -> impl ExactSizeIterator<Item = Factor> + Clone + 'a {
        self.places.iter().map(move |place| factor(*place, self.numbers))
    }
}

#[inline]
fn factor(place: Place, numbers: &[Precise]) -> Factor {
    match place {
        Place::ONE => Factor::Plus,
        Place::MINUS_ONE => Factor::Minus,
        place => Factor::of(numbers[place.index()]),
    }
}

impl Factor {
    fn of(value: Precise) -> Factor {
        if value.radius > 0.0 {
            Factor::Other(value)
        } else if value.value == Triple::ONE {
            Factor::Plus
        } else if value.value == -Triple::ONE {
            Factor::Minus
        } else {
            Factor::Other(value)
        }
    }

    /// The uncertainty beyond the stored words.
    #[inline]
    pub fn radius(self) -> f64 {
        match self {
            Factor::Other(x) => x.radius,
            Factor::Plus | Factor::Minus => 0.0,
        }
    }

    #[inline]
    pub fn to_triple(self) -> Triple {
        match self {
            Factor::Plus => Triple::ONE,
            Factor::Minus => -Triple::ONE,
            Factor::Other(x) => x.value,
        }
    }

    #[inline]
    pub fn to_dd(self) -> Dd {
        self.to_triple().dd()
    }

    #[inline]
    pub fn to_f64(self) -> f64 {
        self.to_triple().hi()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::test_systems::blank;
    use crate::base::{Ball, Number};
    use crate::system::Nature;

    /// Signs are told from other numbers by their value, also where an enclosure without a radius has one.
    #[test]
    fn terms_have_the_numbers_of_their_form() {
        let mut system = blank(9);
        let source = system.k.source(system.coordinates[0].name);
        let near = |mid: f64, radius: f64| Number::Ball(Ball::new(Dd::from(mid), radius));
        let entries = [
            Number::ONE,
            -&Number::ONE,
            Number::from("0.1"),
            near(1.0, 0.0),
            near(-1.0, 0.0),
            near(1.0, 1e-40),
            near(2.5, 0.0),
            Number::pi(),
            Number::from("0.1"),
        ];
        for (t, weight) in entries.iter().enumerate() {
            let row = entries.iter().enumerate().skip(t).map(|(i, entry)| (CoordinateId(i as u32), entry.clone()));
            system.k.push(source, Nature::Property, weight.clone(), row);
        }
        let terms = Terms::of(&system.k);
        assert_eq!((terms.len(), terms.weights().len(), terms.entry_count()), (9, 9, 45));
        for (t, weight) in entries.iter().enumerate() {
            assert_eq!(terms.weight(t), Precise::of(weight));
            let (indices, factors) = terms.row(t);
            assert_eq!(indices, (t as u32..9).map(CoordinateId).collect::<Vec<_>>());
            let expected: Vec<Factor> = entries[t..].iter().map(|entry| Factor::of(Precise::of(entry))).collect();
            assert_eq!(factors.iter().collect::<Vec<Factor>>(), expected);
            assert_eq!(factors.from(factors.len() - 1).at(0), expected[expected.len() - 1]);
        }
        assert_eq!(terms.row(0).1.at(3), Factor::Plus);
        assert_eq!(terms.row(0).1.at(4), Factor::Minus);
        assert!(matches!(terms.row(0).1.at(5), Factor::Other(_)));
    }
}
