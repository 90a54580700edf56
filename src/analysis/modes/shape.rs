//! How a mode's shape is scaled and signed, and where its energy is. Clauses: spec.md 12.4 to 12.7.

use crate::analysis::answer::{Mode, Share};
use crate::analysis::modes::terms::Terms;
use crate::system::{CoordinateId, CoordinateKind, Form, Label, LinearSystem};

/// What is made 1 in a shape.
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

/// Entries this close to the largest count as equally large, and ones this far below it as not moving: many times the
/// error of a shape, far less than anyone tells apart. So the choice does not hang on a last bit.
const TIE: f64 = 1e-9;
/// Translations with less than this share of the kinetic energy are rounding errors of a mode that turns.
const LEAST_SHARE: f64 = 1e-12;

/// The shape of a mode, scaled as asked; the entry that was made 1 is exactly 1.
pub fn normalise(mode: &Mode, system: &LinearSystem, how: Normalise) -> Vec<f64> {
    let shape = &mode.shape;
    let unit = match how {
        Normalise::Mass => None,
        Normalise::Translation => leading(shape, &mode.kinetic, system),
        Normalise::Max => first_largest(shape, |_| true),
        Normalise::First => first_moving(shape),
    };
    let Some(unit) = unit.map(|i| shape[i]) else { return shape.clone() };
    shape.iter().map(|&x| if x == 0.0 { 0.0 } else { x / unit }).collect()
}

/// Whether the shape has to be turned round so that its leading entry is positive.
pub(in crate::analysis) fn is_reversed(shape: &[f64], kinetic: &[Share<CoordinateId>], system: &LinearSystem) -> bool {
    leading(shape, kinetic, system).is_some_and(|i| shape[i] < 0.0)
}

/// The leading entry: the first that is as large as the largest translation, or rotation where the translations carry
/// nothing.
fn leading(shape: &[f64], kinetic: &[Share<CoordinateId>], system: &LinearSystem) -> Option<usize> {
    let translates = |i: usize| system.coordinates[i].kind == CoordinateKind::Translation;
    let carried: f64 = kinetic.iter().filter(|share| translates(share.of.index())).map(|share| share.part.abs()).sum();
    first_largest(shape, |i| translates(i) == (carried >= LEAST_SHARE))
}

fn first_largest(shape: &[f64], admitted: impl Fn(usize) -> bool) -> Option<usize> {
    let size = |i: usize| if admitted(i) { shape[i].abs() } else { 0.0 };
    let largest = (0..shape.len()).map(size).fold(0.0, f64::max);
    (0..shape.len()).find(|&i| largest > 0.0 && size(i) >= largest * (1.0 - TIE))
}

fn first_moving(shape: &[f64]) -> Option<usize> {
    let largest = shape.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    shape.iter().position(|x| x.abs() > TIE * largest)
}

/// The shape with its largest entry made 1.
pub(in crate::analysis) fn with_largest_one(shape: &[f64]) -> Vec<f64> {
    let unit = first_largest(shape, |_| true).map_or(1.0, |i| shape[i]);
    shape.iter().map(|&x| if x == 0.0 { 0.0 } else { x / unit }).collect()
}

/// Up to this many shares are told completely, of more the largest.
const COMPLETE: usize = 1000;
const LARGEST: usize = 10;

/// Shares x_i (M x)_i / x^T M x of the kinetic energy, largest first.
pub(in crate::analysis) fn kinetic_shares(masses: &Terms, shape: &[f64]) -> Vec<Share<CoordinateId>> {
    let mut energy = vec![0.0; shape.len()];
    for t in 0..masses.len() {
        // The root of the mass on both sides: masses may be as small as shapes are large.
        let weight = masses.weights[t].value.hi();
        let root = weight.abs().sqrt();
        let momentum = weight.signum() * (root * masses.stretch_f64(t, shape));
        let (indices, factors) = masses.row(t);
        for (&i, factor) in indices.iter().zip(factors) {
            energy[i as usize] += root * shape[i as usize] * factor.to_f64() * momentum;
        }
    }
    shares_of(&energy)
}

/// Shares of all coordinates, largest first, from what each has.
pub(in crate::analysis) fn shares_of(energies: &[f64]) -> Vec<Share<CoordinateId>> {
    largest_first(energies, (0..energies.len() as u32).collect(), |i| CoordinateId(i as u32))
}

/// Shares w (a . x)^2 / x^T K x of the strain energy by what holds it, largest first, from the energies of the terms.
pub(in crate::analysis) fn strain_shares(form: &Form, energies: &[f64]) -> Vec<Share<Label>> {
    let mut by_source = vec![0.0; form.source_count()];
    for (term, energy) in form.terms().iter().zip(energies) {
        by_source[term.source as usize] += energy;
    }
    let holding = (0..by_source.len() as u32).filter(|&i| by_source[i as usize] != 0.0).collect();
    largest_first(&by_source, holding, |i| form.source_name(i as u32))
}

/// The parts chosen, divided by the sum of all and sorted, largest first; equal ones keep their order. None where parts of
/// both signs cancel to nothing that their rounding could be told from: there is no whole to have a share of.
fn largest_first<T>(parts: &[f64], mut chosen: Vec<u32>, of: impl Fn(usize) -> T) -> Vec<Share<T>> {
    // Negative where the motion has negative stiffness: then the most negative part is the largest share.
    // Scaled by the largest part's power of two, so that the sum stays within range.
    let largest = parts.iter().fold(0.0, |largest: f64, part| largest.max(part.abs()));
    let power = f64::from_bits(largest.to_bits() & f64::INFINITY.to_bits());
    let scale = if power.is_normal() { 1.0 / power } else { 1.0 };
    let whole: f64 = parts.iter().map(|part| part * scale).sum();
    let sizes: f64 = parts.iter().map(|part| (part * scale).abs()).sum();
    if whole.abs() <= parts.len() as f64 * f64::EPSILON * sizes {
        return Vec::new();
    }
    let share = |i: u32| parts[i as usize] * scale / whole;
    let order = |a: &u32, b: &u32| share(*b).total_cmp(&share(*a)).then(a.cmp(b));
    if chosen.len() > COMPLETE {
        chosen.select_nth_unstable_by(LARGEST, order);
        chosen.truncate(LARGEST);
    }
    chosen.sort_unstable_by(order);
    // What a symmetry makes equal leads in its order, not in that of last bits.
    let tied = chosen.iter().take_while(|&&i| share(i) >= share(chosen[0]) * (1.0 - TIE)).count();
    chosen[..tied].sort_unstable();
    chosen.into_iter().map(|i| Share { of: of(i as usize), part: share(i) }).collect()
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
    fn of_many_shares_the_largest_are_told() {
        let parts: Vec<f64> = (0..2000).map(|i| f64::from(i % 100)).collect();
        let shares = largest_first(&parts, (0..2000).collect(), |i| i);
        let expected: Vec<usize> = (0..10).map(|i| 99 + 100 * i).collect();
        assert_eq!(shares.iter().map(|share| share.of).collect::<Vec<_>>(), expected);
    }

    #[test]
    fn shares_sum_to_one() {
        let tied = largest_first(&[1.0, 4.0, 4.0 + 1e-12, 2.0], vec![0, 1, 2, 3], |i| i);
        assert_eq!(tied.iter().map(|share| share.of).collect::<Vec<_>>(), [1, 2, 3, 0]);
        let shares = largest_first(&[3.0, 5.0], vec![0, 1], |i| i);
        assert_eq!((shares[0].of, shares[0].part, shares[1].part), (1, 0.625, 0.375));
        let negative = largest_first(&[1.0, -5.0], vec![0, 1], |i| i);
        assert_eq!((negative[0].of, negative[0].part, negative[1].part), (1, 1.25, -0.25));
    }
}
