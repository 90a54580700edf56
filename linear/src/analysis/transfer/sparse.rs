//! Q x = b by sparse elimination in discs: Q = L D L^T, complex symmetric, without pivoting. Every operation encloses
//! the true value, so the result is valid whatever the pivots are; if one is too small, the discs get wide and another
//! method is used. On chains and trees no number is used twice, so the discs stay as narrow as the conditioning allows
//! (rectangles would not: each product rotates and widens them). In: the pattern of M, C and K, then the entries of Q
//! at a frequency. Out: x as discs. See docs/method/transfer.md.
//!
//! The elimination order is approximate minimum degree (Amestoy, Davis, Duff 1996), for trees from the leaves inwards;
//! the elimination is up-looking, along the [elimination tree](crate::kernel::sparse::tree).

use crate::analysis::transfer::inverse::Entry;
use crate::base::{Ball, down};
use crate::kernel::complex::Complex;
use crate::kernel::disc::Disc;
use crate::kernel::simd::simd;
use crate::kernel::sparse::order::least_fill;
use crate::kernel::sparse::tree::EliminationTree;

/// The order and the pattern of L.
#[derive(Clone, Debug)]
pub struct Pattern {
    n: usize,
    /// Position of each coordinate in the elimination.
    place: Vec<usize>,
    /// The entries of each column on or above the diagonal, as (row, index of the entry), in the order of elimination.
    columns: Vec<Vec<(usize, usize)>>,
    tree: EliminationTree,
}

/// The arithmetic of an elimination: [`Disc`] proves, binary64 steers.
pub trait Scalar: Copy {
    const ZERO: Self;
    fn of(z: Complex<Ball>) -> Self;
    fn is_zero(&self) -> bool;
    fn times(self, other: Self) -> Self;
    fn minus(self, other: Self) -> Self;
    /// `None` if the number may be zero.
    fn reciprocal(self) -> Option<Self>;
    /// See [`Pattern::factor`] and [`Factors::solve`].
    fn eliminate(pattern: &Pattern, entries: &[Entry]) -> Option<Lower<Self>>;
    fn substitute(pattern: &Pattern, lower: &Lower<Self>, x: &mut [Self]);
}

/// L and D at a frequency.
#[derive(Clone, Debug)]
pub struct Factors<'a, T> {
    pattern: &'a Pattern,
    lower: Lower<T>,
}

/// The entries of L by columns, each with its row, and 1 / D.
#[derive(Clone, Debug)]
pub struct Lower<T> {
    rows: Vec<u32>,
    l: Vec<T>,
    reciprocal: Vec<T>,
}

/// The symbolic steps of an elimination.
pub struct Symbolic {
    /// For each position the columns of L that it needs, in order, and the index of its own entry in them.
    pub touched: Vec<Vec<(u32, u32)>>,
    /// Index at which each column of L begins, and the row of each entry.
    pub starts: Vec<u32>,
    pub below: Vec<u32>,
}

const NONE: usize = usize::MAX;
/// With more entries of L than this, the other methods are faster.
const MOST_ENTRIES: usize = 4_000_000;

impl Pattern {
    /// `None` if L would have too many entries.
    pub fn of(n: usize, entries: &[(u32, u32)]) -> Option<Pattern> {
        let place = order(n, entries);
        let mut columns: Vec<Vec<(usize, usize)>> = vec![Vec::new(); n];
        for (index, &(i, j)) in entries.iter().enumerate() {
            let (i, j) = (place[i as usize], place[j as usize]);
            if i <= j {
                columns[j].push((i, index));
            }
        }
        let tree = EliminationTree::of(n, |k| rows_of(&columns[k]), MOST_ENTRIES)?;
        Some(Pattern { n, place, columns, tree })
    }

    /// The position of a coordinate in the elimination.
    pub fn place(&self, coordinate: usize) -> usize {
        self.place[coordinate]
    }

    /// The steps of [`Pattern::factor`], without numbers.
    pub fn symbolic(&self) -> Symbolic {
        let n = self.n;
        let starts = self.tree.starts();
        let mut filled = starts[..n].to_vec();
        let mut below = vec![0u32; starts[n]];
        let mut walk = self.tree.walk();
        let mut plan = Vec::with_capacity(n);
        for k in 0..n {
            let mut needs = Vec::new();
            for &i in walk.row(k, rows_of(&self.columns[k])) {
                let at = i as usize;
                needs.push((i, filled[at] as u32));
                below[filled[at]] = k as u32;
                filled[at] += 1;
            }
            plan.push(needs);
        }
        Symbolic { touched: plan, starts: starts.iter().map(|&start| start as u32).collect(), below }
    }

    /// `None` if a pivot may be zero.
    pub fn factor<T: Scalar>(&self, entries: &[Entry]) -> Option<Factors<'_, T>> {
        Some(Factors { pattern: self, lower: T::eliminate(self, entries)? })
    }
}

/// The rows of a column of Q.
fn rows_of(column: &[(usize, usize)]) -> impl Iterator<Item = u32> + use<'_> {
    column.iter().map(|&(row, _)| row as u32)
}

#[inline(always)]
fn eliminate_entries<T: Scalar>(pattern: &Pattern, entries: &[Entry]) -> Option<Lower<T>> {
    let (n, starts) = (pattern.n, pattern.tree.starts());
    let mut filled = starts[..n].to_vec();
    let (mut rows, mut l) = (vec![0u32; starts[n]], vec![T::ZERO; starts[n]]);
    let mut y = vec![T::ZERO; n];
    let mut reciprocal: Vec<T> = Vec::with_capacity(n);
    let mut walk = pattern.tree.walk();
    for k in 0..n {
        for &(row, index) in &pattern.columns[k] {
            y[row] = T::of(entries[index].value);
        }
        let mut pivot = std::mem::replace(&mut y[k], T::ZERO);
        for &i in walk.row(k, rows_of(&pattern.columns[k])) {
            let i = i as usize;
            let value = std::mem::replace(&mut y[i], T::ZERO);
            for p in starts[i]..filled[i] {
                let at = rows[p] as usize;
                y[at] = y[at].minus(l[p].times(value));
            }
            let factor = value.times(reciprocal[i]);
            pivot = pivot.minus(factor.times(value));
            (rows[filled[i]], l[filled[i]]) = (k as u32, factor);
            filled[i] += 1;
        }
        reciprocal.push(pivot.reciprocal()?);
    }
    Some(Lower { rows, l, reciprocal })
}

/// x <- (L D L^T)^-1 x, in the order of elimination.
#[inline(always)]
fn substitute_one<T: Scalar>(pattern: &Pattern, lower: &Lower<T>, x: &mut [T]) {
    let starts = pattern.tree.starts();
    for j in 0..pattern.n {
        if x[j].is_zero() {
            continue;
        }
        for p in starts[j]..starts[j + 1] {
            let at = lower.rows[p] as usize;
            x[at] = x[at].minus(lower.l[p].times(x[j]));
        }
    }
    for j in (0..pattern.n).rev() {
        let mut value = x[j].times(lower.reciprocal[j]);
        for p in starts[j]..starts[j + 1] {
            value = value.minus(lower.l[p].times(x[lower.rows[p] as usize]));
        }
        x[j] = value;
    }
}

simd! {
    fn eliminate_discs(pattern: &Pattern, entries: &[Entry]) -> Option<Lower<Disc>> {
        eliminate_entries(pattern, entries)
    }
}

simd! {
    fn substitute_discs(pattern: &Pattern, lower: &Lower<Disc>, x: &mut [Disc]) {
        substitute_one(pattern, lower, x)
    }
}

impl Factors<'_, Disc> {
    /// Whether D, and so the factored matrix, is certainly positive definite; for real matrices.
    pub fn is_positive(&self) -> bool {
        self.lower.reciprocal.iter().all(|d| d.value.re.hi * down::FEW > d.radius)
    }
}

impl<T: Scalar> Factors<'_, T> {
    /// x from b, both in the order of the coordinates.
    pub fn solve(&self, b: &[Complex<Ball>]) -> Vec<T> {
        let pattern = self.pattern;
        let mut x = vec![T::ZERO; pattern.n];
        for (i, &value) in b.iter().enumerate() {
            x[pattern.place[i]] = T::of(value);
        }
        T::substitute(pattern, &self.lower, &mut x);
        pattern.place.iter().map(|&place| x[place]).collect()
    }
}

impl Scalar for Disc {
    const ZERO: Disc = Disc::ZERO;

    fn of(z: Complex<Ball>) -> Disc {
        Disc::of(z)
    }

    #[inline(always)]
    fn is_zero(&self) -> bool {
        Disc::is_zero(self)
    }

    #[inline(always)]
    fn times(self, b: Disc) -> Disc {
        self * b
    }

    #[inline(always)]
    fn minus(self, b: Disc) -> Disc {
        self - b
    }

    #[inline(always)]
    fn reciprocal(self) -> Option<Disc> {
        self.recip()
    }

    fn eliminate(pattern: &Pattern, entries: &[Entry]) -> Option<Lower<Disc>> {
        eliminate_discs(pattern, entries)
    }

    fn substitute(pattern: &Pattern, lower: &Lower<Disc>, x: &mut [Disc]) {
        substitute_discs(pattern, lower, x);
    }
}

impl Scalar for Complex<f64> {
    const ZERO: Complex<f64> = Complex { re: 0.0, im: 0.0 };

    fn of(z: Complex<Ball>) -> Complex<f64> {
        z.to_f64()
    }

    fn is_zero(&self) -> bool {
        *self == Complex::ZERO
    }

    #[inline(always)]
    fn times(self, other: Complex<f64>) -> Complex<f64> {
        self * other
    }

    #[inline(always)]
    fn minus(self, other: Complex<f64>) -> Complex<f64> {
        self - other
    }

    fn reciprocal(self) -> Option<Complex<f64>> {
        let inverse = self.recip();
        inverse.is_finite().then_some(inverse)
    }

    fn eliminate(pattern: &Pattern, entries: &[Entry]) -> Option<Lower<Complex<f64>>> {
        eliminate_entries(pattern, entries)
    }

    fn substitute(pattern: &Pattern, lower: &Lower<Complex<f64>>, x: &mut [Complex<f64>]) {
        substitute_one(pattern, lower, x);
    }
}

/// The position of each coordinate; the original order if the ordering fails.
fn order(n: usize, entries: &[(u32, u32)]) -> Vec<usize> {
    let some = || least_fill(n, entries.iter().copied()).map(|place| place.into_iter().map(|i| i as usize).collect());
    leaves_first(n, entries).or_else(some).unwrap_or_else(|| (0..n).collect())
}

/// Eliminates a tree from all of its leaves inwards, without fill: neighbours in this order are on different branches,
/// so the processor can work on them in parallel. `None` if there is a cycle.
fn leaves_first(n: usize, entries: &[(u32, u32)]) -> Option<Vec<usize>> {
    let mut neighbours: Vec<Vec<u32>> = vec![Vec::new(); n];
    for &(i, j) in entries.iter().filter(|(i, j)| i != j) {
        neighbours[i as usize].push(j);
    }
    let mut degree: Vec<usize> = neighbours.iter().map(Vec::len).collect();
    let mut place = vec![NONE; n];
    let mut leaves: std::collections::VecDeque<usize> = (0..n).filter(|&i| degree[i] <= 1).collect();
    let mut count = 0;
    while let Some(leaf) = leaves.pop_front() {
        place[leaf] = count;
        count += 1;
        for &next in neighbours[leaf].iter().filter(|&&next| place[next as usize] == NONE) {
            degree[next as usize] = degree[next as usize].saturating_sub(1);
            if degree[next as usize] == 1 {
                leaves.push_back(next as usize);
            }
        }
    }
    (count == n).then_some(place)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A chain is eliminated from both ends, a star from its rays; a ring has no end.
    #[test]
    fn a_tree_is_eliminated_from_its_leaves() {
        let both =
            |pairs: &[(u32, u32)]| -> Vec<(u32, u32)> { pairs.iter().flat_map(|&(i, j)| [(i, j), (j, i)]).collect() };
        assert_eq!(leaves_first(4, &both(&[(0, 1), (1, 2), (2, 3)])), Some(vec![0, 2, 3, 1]));
        assert_eq!(leaves_first(4, &both(&[(0, 1), (0, 2), (0, 3)])), Some(vec![3, 0, 1, 2]));
        assert_eq!(leaves_first(3, &both(&[(0, 1), (1, 2), (2, 0)])), None);
        assert_eq!(leaves_first(2, &[(0, 0), (1, 1)]), Some(vec![0, 1]));
    }

    fn entries(n: usize, value: impl Fn(usize, usize) -> Option<(f64, f64)>) -> Vec<Entry> {
        let at = |at: usize| {
            let (i, j) = (at / n, at % n);
            let (re, im) = value(i.min(j), i.max(j))?;
            let value = Complex::new(Ball::from(re), Ball::from(im));
            Some(Entry { i: i as u32, j: j as u32, value })
        };
        (0..n * n).filter_map(at).collect()
    }

    /// Solving for Q times a known vector encloses that vector, for an arrow and for a ring.
    #[test]
    fn the_solution_is_enclosed() {
        let n = 7;
        let arrow = entries(n, |i, j| match (i, j) {
            (i, j) if i == j => Some((3.0 + i as f64, 0.5)),
            (0, j) => Some((-1.0, -0.1 * j as f64)),
            _ => None,
        });
        let ring = entries(n, |i, j| match j - i {
            0 => Some((0.5, 0.25)),
            1 => Some((-1.0, 0.0)),
            d if d == n - 1 => Some((-1.0, 0.125)),
            _ => None,
        });
        for entries in [arrow, ring] {
            let pattern = Pattern::of(n, &entries.iter().map(|e| (e.i, e.j)).collect::<Vec<_>>()).expect("small");
            let factors = pattern.factor::<Disc>(&entries).expect("regular");
            let truth: Vec<Complex<Ball>> =
                (0..n).map(|i| Complex::new(Ball::from(1.0 + i as f64), Ball::from(-(i as f64)))).collect();
            let mut b = vec![Complex::<Ball>::ZERO; n];
            for e in &entries {
                b[e.i as usize] = b[e.i as usize] + e.value * truth[e.j as usize];
            }
            for (x, truth) in factors.solve(&b).iter().zip(&truth) {
                assert!((x.value - truth.mid()).to_f64().abs() <= x.radius, "{x:?}");
                // Without pivoting the ring loses some of its 30 digits.
                assert!(x.radius < 1e-20, "{x:?}");
            }
        }
    }

    /// Fewer entries than rows.
    #[test]
    fn a_pattern_of_few_entries_is_factored_or_refused() {
        let one = Complex::new(Ball::from(1.0), Ball::ZERO);
        let entries = [(3, 3), (3, 7), (7, 3)].map(|(i, j)| Entry { i, j, value: one });
        let pattern = Pattern::of(12, &entries.map(|e| (e.i, e.j))).expect("small");
        assert!(pattern.factor::<Disc>(&entries).is_none(), "most rows are zero");
    }

    #[test]
    fn a_zero_pivot_is_refused() {
        let entries = entries(2, |i, j| Some((if i == j { 0.0 } else { 1.0 }, 0.0)));
        let pattern = Pattern::of(2, &entries.iter().map(|e| (e.i, e.j)).collect::<Vec<_>>()).expect("small");
        assert!(pattern.factor::<Disc>(&entries).is_none());
    }
}
