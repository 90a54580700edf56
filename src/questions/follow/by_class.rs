//! Frequencies, and bounds of them, by classes. A class is a block of coordinates that no value of the parameter couples to others. In:
//! lists of all classes. Out: those of one class.

use crate::base::Ball;
use std::sync::Arc;

/// The frequency of a mode that oscillates or is rigid.
pub type Frequencies = Vec<Option<Ball>>;

/// Frequencies, or bounds of them, of all classes, one after the other. There are ten thousands of places and steps, so that those which are
/// computed together share one list: the part of this one begins at `start`.
#[derive(Clone, Debug)]
pub struct ByClass {
    list: Arc<Vec<Option<Ball>>>,
    start: usize,
    /// The end of each class in that part.
    ends: Arc<[usize]>,
}

/// Bounds of the frequencies of a class for all values between two: the i-th frequency lies between the i-th bounds. A
/// lower bound is `None` if the mode may not oscillate.
#[derive(Clone, Copy, Debug)]
pub struct Bounds<'a> {
    pub lower: &'a [Option<Ball>],
    pub upper: &'a [Option<Ball>],
}

/// Bounds of the frequencies for all values between two.
#[derive(Clone, Debug)]
pub enum Between<'a> {
    /// Lower and upper bounds.
    Known([&'a ByClass; 2]),
    /// Those of each class; `None` if nothing is proved.
    Found(Vec<Option<[Frequencies; 2]>>),
}

impl ByClass {
    /// Of lists of all classes.
    pub fn of(classes: &[Frequencies]) -> ByClass {
        let ends = Layout::of(classes.iter().map(Vec::len)).ends;
        ByClass { list: Arc::new(classes.concat()), start: 0, ends }
    }

    /// The number of classes.
    pub fn count(&self) -> usize {
        self.ends.len()
    }

    pub fn class(&self, class: usize) -> &[Option<Ball>] {
        let first = if class == 0 { 0 } else { self.ends[class - 1] };
        &self.list[self.start + first..self.start + self.ends[class]]
    }

    /// Whether each of them is known.
    pub fn is_known(&self) -> bool {
        let whole = self.ends.last().copied().unwrap_or(0);
        self.list[self.start..self.start + whole].iter().all(Option::is_some)
    }
}

/// The places of the frequencies of each class in a list that several cases share.
pub struct Layout {
    ends: Arc<[usize]>,
}

impl Layout {
    /// For so many frequencies of each class.
    pub fn of(counts: impl Iterator<Item = usize>) -> Layout {
        let ends = counts.scan(0, |end, count| {
            *end += count;
            Some(*end)
        });
        Layout { ends: ends.collect() }
    }

    /// The frequencies of one case.
    pub fn whole(&self) -> usize {
        self.ends.last().copied().unwrap_or(0)
    }

    /// The first place and the number of those of a class.
    pub fn class(&self, class: usize) -> [usize; 2] {
        let first = if class == 0 { 0 } else { self.ends[class - 1] };
        [first, self.ends[class] - first]
    }

    pub fn room(&self, cases: usize) -> Vec<Option<Ball>> {
        vec![None; self.whole() * cases]
    }

    /// The parts of a list.
    pub fn of_each(&self, list: Vec<Option<Ball>>, cases: usize) -> impl Iterator<Item = ByClass> {
        let list = Arc::new(list);
        let (whole, ends) = (self.whole(), self.ends.clone());
        (0..cases).map(move |case| ByClass { list: list.clone(), start: case * whole, ends: ends.clone() })
    }
}

impl Between<'_> {
    /// The classes of which nothing is proved.
    pub fn unknown(&self) -> impl Iterator<Item = usize> {
        let list: &[_] = if let Between::Found(list) = self { list } else { &[] };
        (0..list.len()).filter(|class| list[*class].is_none())
    }

    /// Whether nothing is proved of any class.
    pub fn is_unknown(&self) -> bool {
        matches!(self, Between::Found(list) if list.iter().all(Option::is_none))
    }

    /// The bounds of a class; `None` if nothing is proved.
    pub fn class(&self, class: usize) -> Option<Bounds<'_>> {
        match self {
            Between::Known([lower, upper]) => Some(Bounds { lower: lower.class(class), upper: upper.class(class) }),
            Between::Found(list) => list[class].as_ref().map(|[lower, upper]| Bounds { lower, upper }),
        }
    }
}

impl Bounds<'_> {
    /// A lower bound of the distance between a mode and the next.
    pub fn distance(&self, index: usize) -> Option<Ball> {
        Some((*self.lower.get(index + 1)?)? - (*self.upper.get(index)?)?)
    }

    /// Whether the i-th mode and the next are certainly separate curves: apart, or both rigid for every value.
    pub fn are_apart(&self, index: usize) -> bool {
        let is_rigid = |index: usize| {
            let rigid = |list: &[Option<Ball>]| matches!(list.get(index), Some(Some(frequency)) if frequency.is_zero());
            rigid(self.lower) && rigid(self.upper)
        };
        self.distance(index).is_some_and(|least| least.is_positive()) || is_rigid(index) && is_rigid(index + 1)
    }
}
