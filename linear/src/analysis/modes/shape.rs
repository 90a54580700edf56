//! The scaling and sign of a mode's shape, and the distribution of its energy.
//! See docs/method/report.md#normalisation and docs/method/report.md#shares.

use crate::analysis::answer::{Mode, Share};
use crate::analysis::modes::pair::Displacements;
use crate::analysis::modes::terms::Terms;
use crate::base::{OrderBy, Unproven};
use crate::system::{CoordinateId, CoordinateKind, Form, LinearSystem, Source};

/// The part of a shape that is scaled to 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Normalise {
    /// The largest translation; the largest rotation in a mode that only turns.
    #[default]
    Translation,
    /// The largest entry, metres and radians alike.
    Max,
    /// The first coordinate that moves.
    First,
    /// shape^T M shape.
    Mass,
}

/// Entries this close to the largest count as equally large, and entries this far below it as not moving: many times
/// the error of a shape, far less than anyone can distinguish. So the choice does not depend on a last bit.
const TIE: f64 = 1e-9;
/// Translations with less than this share of the kinetic energy are rounding errors of a purely rotating mode.
const LEAST_SHARE: f64 = 1e-12;

/// The shape of a mode, scaled as requested; the entry that is scaled to 1 is exactly 1.
pub fn normalise(mode: &Mode, how: Normalise) -> Vec<Unproven> {
    let shape = &mode.shape;
    let unit = match how {
        Normalise::Mass => None,
        Normalise::Translation => mode.leading.map(CoordinateId::index),
        Normalise::Max => first_largest(shape, |_| true),
        Normalise::First => first_moving(shape),
    };
    let unit = unit.map_or(1.0, |i| shape[i]);
    shape.iter().map(|&x| Unproven(if x == 0.0 { 0.0 } else { x / unit })).collect()
}

/// Reverses the shape if its leading entry is negative, and returns the coordinate of that entry: the first of the
/// largest translations, or of the largest rotations if the translations by themselves have none of the kinetic energy.
/// `carried`: the translations' share.
pub(in crate::analysis) fn lead(
    shape: &mut [f64],
    carried: f64,
    translates: impl Fn(usize) -> bool,
) -> Option<CoordinateId> {
    let leading = first_largest(shape, |i| translates(i) == (carried >= LEAST_SHARE))?;
    if shape[leading] < 0.0 {
        shape.iter_mut().for_each(|x| *x = -*x);
    }
    Some(CoordinateId(leading as u32))
}

/// Whether a coordinate is a translation.
pub(in crate::analysis) fn translates(system: &LinearSystem) -> impl Fn(usize) -> bool {
    |i| system.coordinates[i].kind == CoordinateKind::Translation
}

/// The first of the largest admitted entries.
pub(in crate::analysis) fn first_largest(shape: &[f64], admitted: impl Fn(usize) -> bool) -> Option<usize> {
    let size = |i: usize| if admitted(i) { shape[i].abs() } else { 0.0 };
    let largest = (0..shape.len()).map(size).fold(0.0, f64::max);
    (0..shape.len()).find(|&i| largest > 0.0 && size(i) >= largest * (1.0 - TIE))
}

fn first_moving(shape: &[f64]) -> Option<usize> {
    let largest = shape.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    shape.iter().position(|x| x.abs() > TIE * largest)
}

/// The shape scaled so that its largest entry is 1.
pub(in crate::analysis) fn with_largest_one(shape: &[f64]) -> Vec<Unproven> {
    let unit = first_largest(shape, |_| true).map_or(1.0, |i| shape[i]);
    shape.iter().map(|&x| Unproven(if x == 0.0 { 0.0 } else { x / unit })).collect()
}

/// Up to this many shares are reported completely; of more, only the largest.
const COMPLETE: usize = 1000;
const LARGEST: usize = 10;

/// A form in binary64, for computing energies: there may be millions of terms, for each of many modes.
pub(in crate::analysis) struct Roots {
    /// The root of each weight, with its sign.
    roots: Vec<f64>,
    starts: Vec<u32>,
    indices: Vec<u32>,
    factors: Vec<f64>,
    sources: Vec<u32>,
}

impl Roots {
    pub fn of(form: &Form, terms: &Terms) -> Roots {
        let mut result = Roots {
            roots: Vec::with_capacity(terms.len()),
            starts: Vec::with_capacity(terms.len() + 1),
            indices: Vec::with_capacity(terms.entry_count()),
            factors: Vec::with_capacity(terms.entry_count()),
            sources: form.terms().map(|term| term.source).collect(),
        };
        result.starts.push(0);
        for t in 0..terms.len() {
            let (indices, factors) = terms.row(t);
            let weight = terms.weight(t).value.hi();
            result.roots.push(weight.signum() * weight.abs().sqrt());
            result.indices.extend(indices.iter().map(|i| i.0));
            result.factors.extend(factors.iter().map(|factor| factor.to_f64()));
            result.starts.push(result.indices.len() as u32);
        }
        result
    }

    /// The rows of the terms: indices and factors.
    #[inline]
    fn rows(&self) -> impl Iterator<Item = (&[u32], &[f64])> {
        let row = |ends: &[u32]| {
            let range = ends[0] as usize..ends[1] as usize;
            (&self.indices[range.clone()], &self.factors[range])
        };
        self.starts.windows(2).map(row)
    }

    /// w (a . x)^2 of a term from its stretch, multiplied in an order that stays within the range of binary64 whenever
    /// the energy does.
    #[inline]
    fn energy(&self, t: usize, stretch: f64) -> f64 {
        let root = self.roots[t].abs() * stretch;
        root * root * self.roots[t].signum()
    }

    /// The sum of all |w (a . x)^2|, and the sum of w (a . x)^2 for each of the `sources` sources.
    pub fn energies(&self, sources: usize, terms: &Terms, x: &Displacements) -> (f64, Vec<f64>) {
        match x {
            Displacements::Precise(x) => {
                self.by_source(sources, (0..terms.len()).map(|t| terms.stretch(t, x).value.hi()))
            }
            Displacements::Plain(x) => self.energies_in_binary64(sources, x),
        }
    }

    /// Like [`Self::energies`], for displacements in binary64: accurate enough if no energy is negative.
    pub fn energies_in_binary64(&self, sources: usize, x: &[f64]) -> (f64, Vec<f64>) {
        self.by_source(sources, self.rows().map(|row| stretch(row, x)))
    }

    /// The kinetic energy of the translations by themselves, with the rotations held.
    pub fn carried_by_translations(&self, x: &[f64], translates: &[bool]) -> f64 {
        let held = |(indices, factors): (&[u32], &[f64])| -> f64 {
            let moving = indices.iter().zip(factors).filter(|(i, _)| translates[**i as usize]);
            moving.map(|(&i, a)| a * x[i as usize]).sum()
        };
        self.rows().enumerate().map(|(t, row)| self.energy(t, held(row))).sum()
    }

    fn by_source(&self, sources: usize, stretches: impl Iterator<Item = f64>) -> (f64, Vec<f64>) {
        let (mut whole, mut by_source) = (0.0, vec![0.0; sources]);
        for (t, (&source, stretch)) in self.sources.iter().zip(stretches).enumerate() {
            let energy = self.energy(t, stretch);
            whole += energy.abs();
            by_source[source as usize] += energy;
        }
        (whole, by_source)
    }
}

/// a . x; most rows have one entry or two.
#[inline]
fn stretch(row: (&[u32], &[f64]), x: &[f64]) -> f64 {
    match row {
        ([i], [a]) => a * x[*i as usize],
        ([i, j], [a, b]) => a * x[*i as usize] + b * x[*j as usize],
        (indices, factors) => indices.iter().zip(factors).map(|(&i, a)| a * x[i as usize]).sum(),
    }
}

/// Shares w (a . x)^2 / x^T A x of an energy by its source (a body for the kinetic energy, a spring or gravity for the
/// strain energy), largest first, from the energy of each source of the form A.
pub(in crate::analysis) fn shares(form: &Form, by_source: &[f64]) -> Vec<Share<Source>> {
    largest_first(by_source, |part| part != 0.0, |i| form.source_of(i as u32))
}

/// The chosen parts, divided by the sum of all and sorted, largest first; equal ones keep their order. Empty if parts
/// of both signs cancel so far that the rest cannot be distinguished from rounding errors: there is no total to take
/// shares of.
fn largest_first<T>(parts: &[f64], chosen: impl Fn(f64) -> bool, of: impl Fn(usize) -> T) -> Vec<Share<T>> {
    // The total is negative if the motion has negative stiffness: then the most negative part is the largest share.
    // Scaled by a power of two near the largest part, so that the sum stays within range.
    let largest = parts.iter().fold(0.0, |largest: f64, part| largest.max(part.abs()));
    let power = f64::from_bits(largest.to_bits() & f64::INFINITY.to_bits());
    let scale = if power.is_normal() { 1.0 / power } else { 1.0 };
    let (whole, sizes) = sums(parts, scale);
    if whole.abs() <= parts.len() as f64 * f64::EPSILON * sizes {
        return Vec::new();
    }
    let share = |i: u32| (parts[i as usize] * scale / whole, i);
    let order = |a: &(f64, u32), b: &(f64, u32)| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1));
    let all = || (0u32..).zip(parts).filter(|(_, part)| chosen(**part)).map(|(i, _)| i);
    let many = parts.len() > COMPLETE && all().count() > COMPLETE;
    let mut list: Vec<(f64, u32)> =
        if many { first(&chosen, parts, whole).into_iter().map(share).collect() } else { all().map(share).collect() };
    if many && list.len() > LARGEST {
        list.select_nth_unstable_by(LARGEST, order);
        list.truncate(LARGEST);
    }
    list.sort_unstable_by(order);
    // Shares that a symmetry makes equal are listed in their original order, not in the order of their last bits.
    let tied = list.iter().take_while(|(share, _)| *share >= list[0].0 * (1.0 - TIE)).count();
    list[..tied].order_by_key(|(_, i)| *i);
    list.into_iter().map(|(share, i)| Share { of: of(i as usize), part: Unproven(share) }).collect()
}

/// The sum of the parts and of their magnitudes; many parts are summed in parallel lanes, in an order that is the same
/// on every machine.
fn sums(parts: &[f64], scale: f64) -> (f64, f64) {
    let few = if parts.len() > COMPLETE { parts.len() % 8 } else { parts.len() };
    let (few, many) = parts.split_at(few);
    let add = |(whole, sizes): (f64, f64), part: f64| (whole + part, sizes + part.abs());
    let start = few.iter().fold((0.0, 0.0), |sums, part| add(sums, part * scale));
    let mut lanes = [(0.0, 0.0); 8];
    for chunk in many.chunks_exact(8) {
        for (lane, part) in lanes.iter_mut().zip(chunk) {
            *lane = add(*lane, part * scale);
        }
    }
    lanes.iter().fold(start, |sums, lane| (sums.0 + lane.0, sums.1 + lane.1))
}

/// Candidates for the largest parts (the most negative ones if the total is negative): all parts at least as large as
/// the [`LARGEST`]-th largest of the blocks' maxima.
fn first(chosen: impl Fn(f64) -> bool, parts: &[f64], whole: f64) -> Vec<u32> {
    const BLOCK: usize = 512;
    let size = |part: f64| if chosen(part) { part * whole.signum() } else { f64::NEG_INFINITY };
    let largest_of = |block: &[f64]| block.iter().fold(f64::NEG_INFINITY, |largest, &part| largest.max(size(part)));
    let largest: Vec<f64> = parts.chunks(BLOCK).map(largest_of).collect();
    let mut descending = largest.clone();
    descending.sort_unstable_by(|a, b| b.total_cmp(a));
    let least = descending.get(LARGEST - 1).copied().unwrap_or(f64::NEG_INFINITY);
    let mut list = Vec::new();
    for (at, block) in parts.chunks(BLOCK).enumerate().filter(|(at, _)| largest[*at] >= least) {
        let of_block = block.iter().enumerate().filter(|(_, part)| size(**part) >= least && chosen(**part));
        list.extend(of_block.map(|(i, _)| (at * BLOCK + i) as u32));
    }
    list
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn near_ties_go_to_the_first() {
        assert_eq!(first_largest(&[0.5, -0.7, 0.7 + 1e-14], |_| true), Some(1));
        assert_eq!(first_largest(&[0.0, 3.0], |i| i == 0), None);
        assert_eq!(first_moving(&[1e-17, -0.2, 0.4]), Some(1));
    }

    #[test]
    fn only_the_largest_of_many_shares_are_reported() {
        let parts: Vec<f64> = (0..2000).map(|i| f64::from(i % 100)).collect();
        let shares = largest_first(&parts, |_| true, |i| i);
        let expected: Vec<usize> = (0..10).map(|i| 99 + 100 * i).collect();
        assert_eq!(shares.iter().map(|share| share.of).collect::<Vec<_>>(), expected);
    }

    #[test]
    fn shares_sum_to_one() {
        let tied = largest_first(&[1.0, 4.0, 4.0 + 1e-12, 2.0], |_| true, |i| i);
        assert_eq!(tied.iter().map(|share| share.of).collect::<Vec<_>>(), [1, 2, 3, 0]);
        let shares = largest_first(&[3.0, 5.0], |_| true, |i| i);
        assert_eq!((shares[0].of, shares[0].part.0, shares[1].part.0), (1, 0.625, 0.375));
        let negative = largest_first(&[1.0, -5.0], |_| true, |i| i);
        assert_eq!((negative[0].of, negative[0].part.0, negative[1].part.0), (1, 1.25, -0.25));
    }
}
