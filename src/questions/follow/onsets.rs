//! Onsets of instability: places where the number of growing motions changes along the parameter because an eigenvalue
//! of K or the real part of a pole passes zero. In: the model at all places in order. Out: each onset with its enclosed
//! place. See docs/method/studies.md#onsets.

use super::places::{Field, Place, binary};
use crate::analysis::{self, ModeKind, PoleKind, Request};
use crate::base::Number;
use crate::kernel::cores;
use crate::questions::answer::{Grows, Onset, Onsets, Proved};
use crate::system::LinearSystem;

/// Limit on the changes between two neighbouring values that are enclosed individually.
const MOST_ONSETS: usize = 20;

/// The onsets between neighbouring values.
pub fn onsets(field: &Field, places: &[Place], of: Grows) -> Onsets {
    let count = |place: &Place| match of {
        Grows::Modes if place.oscillates() => Some(0),
        _ => growing(field, &place.at, of),
    };
    let counts = match of {
        Grows::Modes if field.course.is_some() => counts_by_halving(field, places),
        _ => cores::in_pieces(places, 1, 1, |some| some.iter().map(count).collect()),
    };
    let certain: Vec<(f64, usize)> =
        places.iter().zip(&counts).filter_map(|(place, count)| Some((place.x, (*count)?))).collect();
    let changes: Vec<[(f64, usize); 2]> =
        certain.windows(2).filter(|two| two[0].1 != two[1].1).map(|two| [two[0], two[1]]).collect();
    let list: Vec<Vec<Onset>> =
        cores::in_pieces(&changes, 1, 1, |some| some.iter().map(|ends| onset(field, of, *ends)).collect());
    Onsets { of, list: list.concat(), undecided: counts.len() - certain.len() }
}

/// The number of growing modes at each value, where all eigenvalues of K move in one direction: what is the same at two values is the same
/// between them.
fn counts_by_halving(field: &Field, places: &[Place]) -> Vec<Option<usize>> {
    let mut counts = vec![None; places.len()];
    let last = places.len() - 1;
    for end in [0, last] {
        counts[end] = growing(field, &places[end].at, Grows::Modes);
    }
    let mut left = vec![[0, last]];
    while let Some([low, high]) = left.pop() {
        if counts[low].is_some() && counts[low] == counts[high] {
            let known = counts[low];
            counts[low..high].fill(known);
        } else if high - low > 1 {
            let middle = low + (high - low) / 2;
            counts[middle] = growing(field, &places[middle].at, Grows::Modes);
            left.extend([[low, middle], [middle, high]]);
        }
    }
    counts
}

/// Encloses the changes between two places.
fn onset(field: &Field, of: Grows, [(mut first, mut before), (last, after)]: [(f64, usize); 2]) -> Vec<Onset> {
    let count = |x: f64| growing(field, &binary(x)?, of);
    let mut list = Vec::new();
    // The values of cases need not be binary64 numbers.
    if count(first) == Some(before) && count(last) == Some(after) {
        while before != after && list.len() < MOST_ONSETS {
            let place = super::narrow([first, last], |x| Some(count(x)? == before));
            let Some(next) = count(place[1]) else { break };
            let ends = [binary(place[0]), binary(place[1])];
            let is_proved = matches!(&ends, [Some(low), Some(high)] if is_continuous(field, [low, high], of));
            list.push(Onset { place, growing: [before, next], proof: is_proved.then_some(Proved(())) });
            (first, before) = (place[1], next);
        }
    }
    if before != after {
        list.push(Onset { place: [first, last], growing: [before, after], proof: None });
    }
    list
}

/// Whether K, and for poles C and a regular M, depend continuously on the parameter between two values. Then the roots
/// do too, and their number on each side of zero (or of the imaginary axis) changes only where a root lies on it.
fn is_continuous(field: &Field, ends: [&Number; 2], of: Grows) -> bool {
    match of {
        Grows::Modes => field.has_one_form(ends, false),
        Grows::Poles => field.has_one_form(ends, true) && field.bounds(ends).unknown().next().is_none(),
    }
}

/// The number of motions that certainly grow, provided that all others certainly do not.
fn growing(field: &Field, at: &Number, of: Grows) -> Option<usize> {
    let system = field.study.system(0, at.clone(), of == Grows::Poles)?;
    match of {
        Grows::Modes => growing_modes(&system),
        Grows::Poles => growing_poles(&system),
    }
}

/// A pole with real part zero does not grow.
fn growing_poles(system: &LinearSystem) -> Option<usize> {
    let poles = analysis::modal(system, &Request::default()).ok()?.poles;
    let list = &poles.list;
    let is_known = poles.is_complete() && list.len() == 2 * system.n();
    let grows = |kind| matches!(kind, PoleKind::Divergence | PoleKind::Flutter);
    let is_certain = list.iter().all(|pole| pole.kind != PoleKind::Undetermined);
    (is_known && is_certain).then(|| list.iter().filter(|pole| grows(pole.kind)).count())
}

fn growing_modes(system: &LinearSystem) -> Option<usize> {
    let modes = analysis::modes_as(system, &Request::default().to_digits(28)).ok()?;
    let is_known = modes.is_complete() && modes.infinite == 0;
    let is_certain = modes.list.iter().all(|mode| mode.kind != ModeKind::Undetermined);
    (is_known && is_certain).then(|| modes.list.iter().filter(|mode| mode.kind == ModeKind::Divergence).count())
}
