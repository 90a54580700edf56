//! A symmetric matrix as a sum of signed squares `weight row row^T`, in the model's numbers.
//!
//! There may be millions of squares, with few different numbers: weights and entries are places in a list of
//! [`Numbers`].

use crate::base::{Ball, Number, OrderBy, Rational};
use crate::system::numbers::{Numbers, Place};
use crate::system::{CoordinateId, Source};
use std::iter::Zip;
use std::ops::Range;
use std::slice;

/// A symmetric matrix as a sum of signed squares `weight row row^T`.
#[derive(Clone, Debug, Default)]
pub struct Form {
    squares: Vec<Square>,
    coordinates: Vec<CoordinateId>,
    entries: Vec<Place>,
    numbers: Numbers,
    sources: Vec<Source>,
    damping_ratio: Option<Number>,
}

/// A term as it is kept: its row starts where the one before ends.
#[derive(Clone, Copy, Debug)]
struct Square {
    weight: Place,
    source: u32,
    end: u32,
    nature: Nature,
}

/// One square of a [`Form`].
#[derive(Clone, Copy, Debug)]
pub struct Term<'a> {
    pub weight: &'a Number,
    pub nature: Nature,
    /// Index into the form's sources; terms of one element share it.
    pub source: u32,
    row: Row<'a>,
}

/// The terms of a form, in order.
#[derive(Clone, Debug)]
pub struct Terms<'a> {
    form: &'a Form,
    left: Range<usize>,
}

/// The row of a term: ascending by coordinate, without zeros.
#[derive(Clone, Copy, Debug)]
pub struct Row<'a> {
    coordinates: &'a [CoordinateId],
    entries: &'a [Place],
    numbers: &'a Numbers,
}

/// The entries of a row.
#[derive(Clone, Debug)]
pub struct Entries<'a> {
    left: Zip<slice::Iter<'a, CoordinateId>, slice::Iter<'a, Place>>,
    numbers: &'a Numbers,
}

/// The origin of a term.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Nature {
    /// Inertia, elasticity, dissipation: the weight, including its sign, is a property given by the model.
    Property,
    /// Stiffness due to gravity, tensions or joint reactions, of either sign.
    Geometric,
}

impl Form {
    pub fn new() -> Form {
        Form::default()
    }

    /// Without terms, with the sources of another form.
    pub fn with_sources_of(form: &Form) -> Form {
        Form { sources: form.sources.clone(), ..Form::new() }
    }

    /// Reserves room for `terms` more terms with `entries` entries in total.
    pub fn reserve(&mut self, terms: usize, entries: usize) {
        self.sources.reserve(terms);
        self.squares.reserve(terms);
        self.coordinates.reserve(entries);
        self.entries.reserve(entries);
    }

    /// Removes all terms and sources; their memory stays for others.
    pub fn clear(&mut self) {
        self.squares.clear();
        self.coordinates.clear();
        self.entries.clear();
        self.numbers.clear();
        self.sources.clear();
        self.damping_ratio = None;
    }

    /// Registers a source of terms; returns the index for [`Form::push`].
    pub fn source(&mut self, source: impl Into<Source>) -> u32 {
        self.sources.push(source.into());
        u32::try_from(self.sources.len() - 1).expect("the number of parts is limited far below")
    }

    /// Adds `weight row row^T`. Entries that are exactly zero are dropped, and so is a term without entries or weight.
    /// The row's coordinates must be distinct.
    pub fn push(
        &mut self,
        source: u32,
        nature: Nature,
        weight: Number,
        row: impl IntoIterator<Item = (CoordinateId, Number)>,
    ) {
        if weight.vanishes() {
            return;
        }
        let start = self.coordinates.len();
        for (coordinate, value) in row.into_iter().filter(|(_, value)| !value.vanishes()) {
            self.coordinates.push(coordinate);
            self.entries.push(self.numbers.put(value));
        }
        self.order_from(start);
        let end = self.coordinates.len();
        if end > start {
            let weight = self.numbers.put(weight);
            self.squares.push(Square { weight, source, end: end as u32, nature });
            self.damping_ratio = None;
        }
    }

    /// Orders the entries from here on by their coordinates.
    fn order_from(&mut self, start: usize) {
        let row = &mut self.coordinates[start..];
        if row.is_sorted() {
            return;
        }
        if let [first, second] = row {
            std::mem::swap(first, second);
            self.entries.swap(start, start + 1);
            return;
        }
        let mut pairs: Vec<_> = row.iter().copied().zip(self.entries[start..].iter().copied()).collect();
        pairs.order_by_key(|(coordinate, _)| *coordinate);
        self.coordinates.truncate(start);
        self.entries.truncate(start);
        for (coordinate, place) in pairs {
            self.coordinates.push(coordinate);
            self.entries.push(place);
        }
    }

    /// Says that these terms are together exactly the C that gives every oscillation of the system this damping ratio, and all other
    /// motions no damping. True until another term is added.
    pub fn gives_damping_ratio(&mut self, ratio: Number) {
        self.damping_ratio = Some(ratio);
    }

    /// The damping ratio of every oscillation if [`Form::gives_damping_ratio`] has said so of these terms.
    pub fn damping_ratio(&self) -> Option<&Number> {
        self.damping_ratio.as_ref()
    }

    pub fn terms(&self) -> Terms<'_> {
        Terms { form: self, left: 0..self.squares.len() }
    }

    /// The term with this number, counted from 0.
    pub fn term(&self, index: usize) -> Term<'_> {
        let Square { weight, source, nature, .. } = self.squares[index];
        Term { weight: self.numbers.at(weight), nature, source, row: self.row_at(index) }
    }

    /// The form with other weights on its rows.
    pub fn with_weights(mut self, of: impl Fn(&Number) -> Number) -> Form {
        self.damping_ratio = None;
        let before = std::mem::take(&mut self.numbers);
        for square in &mut self.squares {
            square.weight = self.numbers.put(of(before.at(square.weight)));
        }
        for entry in &mut self.entries {
            *entry = self.numbers.put(before.at(*entry).clone());
        }
        self
    }

    /// The row of a term, ascending by coordinate, without zeros.
    #[inline]
    pub fn row<'a>(&self, term: Term<'a>) -> Row<'a> {
        term.row
    }

    #[inline]
    fn row_at(&self, index: usize) -> Row<'_> {
        let start = index.checked_sub(1).map_or(0, |before| self.squares[before].end as usize);
        let range = start..self.squares[index].end as usize;
        Row { coordinates: &self.coordinates[range.clone()], entries: &self.entries[range], numbers: &self.numbers }
    }

    /// The numbers of all weights and rows.
    pub fn numbers(&self) -> &[Number] {
        self.numbers.all()
    }

    /// The number of terms.
    #[inline]
    pub fn len(&self) -> usize {
        self.squares.len()
    }

    /// The number of entries of all rows.
    #[inline]
    pub fn entry_count(&self) -> usize {
        self.entries.len()
    }

    /// The coordinates of all entries, term by term.
    pub fn coordinates(&self) -> &[CoordinateId] {
        &self.coordinates
    }

    /// The place of a term's weight among the [numbers](Form::numbers).
    #[inline]
    pub fn weight(&self, index: usize) -> Place {
        self.squares[index].weight
    }

    /// The row of a term: its coordinates, and the places of its entries among the [numbers](Form::numbers).
    #[inline]
    pub fn places(&self, index: usize) -> (&[CoordinateId], &[Place]) {
        let Row { coordinates, entries, .. } = self.row_at(index);
        (coordinates, entries)
    }

    pub fn source_of(&self, source: u32) -> Source {
        self.sources[source as usize]
    }

    pub fn source_count(&self) -> usize {
        self.sources.len()
    }

    pub fn is_empty(&self) -> bool {
        self.squares.is_empty()
    }

    /// The assembled matrix, row by row: n x n numbers, exact if the terms are. For small n; analyses that need all
    /// digits use the terms.
    pub fn entries(&self, n: usize) -> Vec<Vec<Number>> {
        let mut entries: Vec<Vec<Number>> = vec![vec![Number::ZERO; n]; n];
        for term in self.terms() {
            let row = self.row(term);
            for (i, a) in row {
                let weighted = term.weight * a;
                for (j, b) in row {
                    let entry = &mut entries[i.index()][j.index()];
                    *entry = &*entry + &(&weighted * b);
                }
            }
        }
        entries
    }

    /// [`Form::entries`], if all of them are rational.
    pub fn rational_entries(&self, n: usize) -> Option<Vec<Vec<Rational>>> {
        let rational = |row: &Vec<Number>| row.iter().map(|entry| entry.exact().cloned()).collect();
        self.entries(n).iter().map(rational).collect()
    }

    /// [`Form::entries`] as balls.
    pub fn assemble(&self, n: usize) -> Vec<Vec<Ball>> {
        self.entries(n).iter().map(|row| row.iter().map(Number::to_ball).collect()).collect()
    }
}

impl<'a> Iterator for Terms<'a> {
    type Item = Term<'a>;

    #[inline]
    fn next(&mut self) -> Option<Term<'a>> {
        self.left.next().map(|index| self.form.term(index))
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        self.left.size_hint()
    }
}

impl ExactSizeIterator for Terms<'_> {}

impl<'a> Row<'a> {
    pub fn iter(self) -> Entries<'a> {
        Entries { left: self.coordinates.iter().zip(self.entries), numbers: self.numbers }
    }

    /// Copies of the entries.
    pub fn copies(self) -> impl ExactSizeIterator<Item = (CoordinateId, Number)> + Clone + 'a {
        self.iter().map(|(coordinate, value)| (*coordinate, value.clone()))
    }

    pub fn to_vec(self) -> Vec<(CoordinateId, Number)> {
        self.copies().collect()
    }

    pub fn len(self) -> usize {
        self.coordinates.len()
    }

    /// Never: a term has entries.
    pub fn is_empty(self) -> bool {
        self.coordinates.is_empty()
    }

    /// The coordinates of the entries.
    pub fn coordinates(self) -> &'a [CoordinateId] {
        self.coordinates
    }

    /// The entry of the first coordinate.
    pub fn first(self) -> Option<(&'a CoordinateId, &'a Number)> {
        self.iter().next()
    }
}

impl PartialEq for Row<'_> {
    fn eq(&self, other: &Self) -> bool {
        self.iter().eq(other.iter())
    }
}

impl PartialEq<Vec<(CoordinateId, Number)>> for Row<'_> {
    fn eq(&self, other: &Vec<(CoordinateId, Number)>) -> bool {
        self.iter().eq(other.iter().map(|(coordinate, value)| (coordinate, value)))
    }
}

impl<'a> IntoIterator for Row<'a> {
    type Item = (&'a CoordinateId, &'a Number);
    type IntoIter = Entries<'a>;

    fn into_iter(self) -> Entries<'a> {
        self.iter()
    }
}

impl<'a> Iterator for Entries<'a> {
    type Item = (&'a CoordinateId, &'a Number);

    #[inline]
    fn next(&mut self) -> Option<Self::Item> {
        let (coordinate, place) = self.left.next()?;
        Some((coordinate, self.numbers.at(*place)))
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        self.left.size_hint()
    }
}

impl DoubleEndedIterator for Entries<'_> {
    fn next_back(&mut self) -> Option<Self::Item> {
        let (coordinate, place) = self.left.next_back()?;
        Some((coordinate, self.numbers.at(*place)))
    }
}

impl ExactSizeIterator for Entries<'_> {}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::{Name, Words};
    use crate::system::Label;

    /// What is said of all terms together is not said of others.
    #[test]
    fn a_damping_ratio_is_forgotten_with_any_change() {
        let label = Label { name: Name::plain(Words::new().intern("d")), motion: "" };
        let term = |form: &mut Form| {
            let source = form.source(label);
            form.push(source, Nature::Property, Number::ONE, [(CoordinateId(0), Number::ONE)]);
        };
        let mut form = Form::new();
        term(&mut form);
        form.gives_damping_ratio(Number::from("0.02"));
        assert_eq!(form.clone().damping_ratio(), Some(&Number::from("0.02")));
        assert_eq!(form.clone().with_weights(|weight| weight + weight).damping_ratio(), None);
        let mut more = form.clone();
        term(&mut more);
        form.clear();
        assert_eq!([more, form].map(|form| form.damping_ratio().cloned()), [None, None]);
    }

    /// Whatever the order in which entries are given, and whichever numbers are the same.
    #[test]
    fn terms_come_back_as_they_were_added() {
        let number = |i: usize| match i % 5 {
            0 => Number::ONE,
            1 => -&Number::ONE,
            2 => Number::from("0.3"),
            3 => Number::from(i as i64),
            _ => Number::from(Ball::from(i as f64)),
        };
        let row = |i: usize| {
            let at = move |j: usize| CoordinateId(((i * 7 + j * 11) % 13) as u32);
            (0..i % 6).map(move |j| (at(j), number(i + j)))
        };
        let mut form = Form::new();
        let mut kept = Vec::new();
        for i in 0..40 {
            let source = form.source(Label { name: Name::plain(Words::new().intern("s")), motion: "" });
            form.push(source, Nature::Property, number(i + 1), row(i));
            // A zero leaves no trace.
            form.push(source, Nature::Geometric, Number::ZERO, row(i));
            form.push(source, Nature::Geometric, number(i), [(CoordinateId(1), Number::ZERO)]);
            if row(i).len() > 0 {
                kept.push((source, i));
            }
        }
        assert_eq!(form.terms().len(), kept.len());
        for (term, (source, i)) in form.terms().zip(kept) {
            let mut expected: Vec<_> = row(i).collect();
            expected.sort_by_key(|(coordinate, _)| *coordinate);
            assert_eq!((term.source, term.nature, term.weight), (source, Nature::Property, &number(i + 1)));
            assert_eq!(form.row(term).to_vec(), expected, "{i}");
        }
        let doubled = form.clone().with_weights(|weight| weight + weight);
        for (term, twice) in form.terms().zip(doubled.terms()) {
            assert_eq!((twice.weight, doubled.row(twice)), (&(term.weight + term.weight), form.row(term)));
        }
    }
}
