//! The consequences of constraints that depend on each other in the drawing.
//! See docs/method/kinematics.md#dependent-constraints.
//!
//! Rows that add up to zero, sum mu_i grad g_i = 0, leave the second derivative Q = sum mu_i grad^2 g_i, taken along the
//! motions that the rows allow. If Q is zero, the last of them follows from the others, unless it does not where the parts
//! have moved ([`elsewhere`]). If Q has one sign only, no motion is left: the joints lock each other (conflict). If it has both signs, several motions branch off here
//! (the rank drops), as with all links in line.

use super::elimination::{DependentRow, Elimination, Row};
use super::elsewhere::{self, Elsewhere};
use super::{Constraints, Reduction, Source};
use crate::base::{Diagnostic, Number, Span, Vec3};
use crate::lower::error::{self, LowerError};
use crate::lower::kinematics::{Index, Kinematics, PathEvaluation, State};
use crate::model::scene::Scene;
use nalgebra::DMatrix;
use std::collections::{BTreeMap, BTreeSet};

/// Second derivatives below this share of the terms they are sums of are rounding errors.
const NOTHING: f64 = 1e-15;

/// Limit on the factors that are multiplied out to find couplings that oppose each other: a coordinate at the end of a
/// chain of couplings has one for each of them.
const MOST_FACTORS: usize = 1_000_000;

/// Separates the constraints into independent and redundant ones, with a note for each source of the latter.
pub fn classify(
    scene: &Scene,
    kinematics: &Kinematics,
    mut all: Constraints,
) -> Result<(Constraints, Vec<Diagnostic>), Vec<LowerError>> {
    let elimination = all.eliminate(scene, kinematics, &State::as_drawn())?;
    let mut errors: BTreeMap<Source, LowerError> = BTreeMap::new();
    let mut following: Vec<&DependentRow> = Vec::new();
    let source_of = |left: &DependentRow| all.list[left.row as usize].source;
    let sources_of = |left: &DependentRow| sources(&all, left.combination.iter().map(|(number, _)| number));
    let mut refuse = |left: &DependentRow, why: Why| {
        let source = source_of(left);
        errors.entry(source).or_insert_with(|| loops(scene, kinematics, source, &sources_of(left), why));
    };
    for left in &elimination.left {
        match meaning(scene, kinematics, &all, &elimination, left) {
            Meaning::Redundant => following.push(left),
            Meaning::Wrong(why) => refuse(left, why),
        }
    }
    let mut redundant: BTreeMap<Source, (Vec<Source>, Elsewhere)> = BTreeMap::new();
    for (left, said) in following.iter().zip(elsewhere::compare(kinematics, &all, &elimination, &following)) {
        if said == Elsewhere::Broken {
            refuse(left, Why::AsDrawn);
            continue;
        }
        let (others, worst) = redundant.entry(source_of(left)).or_insert((Vec::new(), said));
        others.extend(sources_of(left));
        *worst = said.max(*worst);
    }
    errors.extend(opposing_couplings(scene, kinematics, &all, &elimination));
    if !errors.is_empty() {
        return Err(errors.into_values().collect());
    }
    let note = |(source, (others, said)): (&Source, &(Vec<Source>, Elsewhere))| {
        error::redundant(&name_of(scene, kinematics, *source, others), *said)
    };
    let notes = redundant.iter().map(note).collect();
    // In the order of the rows.
    let is_left = |number: usize| elimination.left.binary_search_by_key(&(number as u32), |left| left.row).is_ok();
    let (left, kept): (Vec<_>, Vec<_>) =
        std::mem::take(&mut all.list).into_iter().enumerate().partition(|(number, _)| is_left(*number));
    let plain = |list: Vec<(usize, super::Constraint)>| list.into_iter().map(|(_, constraint)| constraint).collect();
    (all.list, all.redundant) = (plain(kept), plain(left));
    Ok((all, notes))
}

enum Meaning {
    Redundant,
    Wrong(Why),
}

/// The ways in which joints or couplings overconstrain parts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Why {
    /// The constraints lock each other.
    Locked,
    /// The constraints fit each other as drawn, and in no other position.
    AsDrawn,
    /// Couplings that only zero motion satisfies.
    Opposed,
    /// No position near the drawing satisfies the constraints.
    Open,
    /// The constraints hold a base whose motion is prescribed.
    Driven,
    /// Several motions branch off from this position.
    Branching,
    /// All pivots of the loop are on one line.
    InLine,
    /// The remainder cannot be distinguished from zero.
    Unclear,
}

fn meaning(
    scene: &Scene,
    kinematics: &Kinematics,
    all: &Constraints,
    elimination: &Elimination,
    left: &DependentRow,
) -> Meaning {
    if left.unclear {
        return Meaning::Wrong(Why::Unclear);
    }
    if left.driven.iter().any(|(_, entry)| !entry.may_be_zero()) {
        return Meaning::Wrong(Why::Driven);
    }
    let form = second_derivative(kinematics, all, elimination, left);
    if form.is_empty() {
        return Meaning::Redundant;
    }
    if in_line(scene, kinematics, &sources(all, left.combination.iter().map(|(number, _)| number))) {
        return Meaning::Wrong(Why::InLine);
    }
    Meaning::Wrong(if has_both_signs(&form) { Why::Branching } else { Why::Locked })
}

/// Q over independent and prescribed coordinates: entries of one triangle, without rounding errors.
fn second_derivative(
    kinematics: &Kinematics,
    all: &Constraints,
    elimination: &Elimination,
    left: &DependentRow,
) -> BTreeMap<(Index, Index), Number> {
    let mut form: BTreeMap<(Index, Index), (Number, f64)> = BTreeMap::new();
    let mut add = |a: Index, b: Index, value: Number, most: f64| {
        let (sum, size) = form.entry((a.min(b), a.max(b))).or_insert((Number::ZERO, 0.0));
        *size += most;
        *sum = &*sum + &value;
    };
    // How far one unit of motion of `a` moves `i`, or one unit of `i` if that is more: what is rounding alone is small beside this,
    // though not beside itself.
    let unit = |coordinate: Index| super::unit(kinematics, coordinate, all.length);
    let most = |i: Index, a: Index, entry: &Number| entry.to_f64().abs().max(unit(i) / unit(a));
    let moved = |coordinate: Index| match elimination.solved.get(&coordinate) {
        Some(row) => row.iter().map(|(i, entry)| (*i, -entry)).collect(),
        None => Row::from([(coordinate, Number::ONE)]),
    };
    let (state, mut reach) = (State::as_drawn(), PathEvaluation::default());
    for (constraint, factor) in &left.combination {
        let equation = &all.list[*constraint as usize].equation;
        equation.curvature(kinematics, &state, factor, &mut reach, |i, j, value| {
            let (first, second) = (moved(i), moved(j));
            for (a, left) in &first {
                for (b, right) in &second {
                    let product = &(&value * left) * right;
                    let most = value.to_f64().abs() * most(i, *a, left) * most(j, *b, right);
                    // A pair of two coordinates represents both places; a diagonal entry reached from both sides counts
                    // twice.
                    match (i == j, a == b) {
                        (true, false) if a > b => {}
                        (false, true) => add(*a, *b, &product + &product, most),
                        _ => add(*a, *b, product, most),
                    }
                }
            }
        });
    }
    let is_something = |(_, (sum, size)): &(_, (Number, f64))| {
        !(sum.is_zero() || sum.may_be_zero() && sum.to_ball().magnitude() <= NOTHING * size)
    };
    form.into_iter().filter(is_something).map(|(place, (sum, _))| (place, sum)).collect()
}

fn has_both_signs(form: &BTreeMap<(Index, Index), Number>) -> bool {
    let mut coordinates: Vec<Index> = form.keys().flat_map(|(a, b)| [*a, *b]).collect();
    coordinates.sort_unstable();
    coordinates.dedup();
    let place = |coordinate: Index| coordinates.binary_search(&coordinate).unwrap_or(0);
    let mut matrix = DMatrix::zeros(coordinates.len(), coordinates.len());
    for ((a, b), value) in form {
        matrix[(place(*a), place(*b))] = value.to_f64();
        matrix[(place(*b), place(*a))] = value.to_f64();
    }
    let values = matrix.symmetric_eigenvalues();
    let least = 1e-9 * values.amax();
    values.iter().any(|value| *value > least) && values.iter().any(|value| *value < -least)
}

/// Two or more couplings that together prevent all motion of a coordinate, although none of them does so alone.
/// Coordinates of couplings that already have an error are skipped.
fn opposing_couplings(
    scene: &Scene,
    kinematics: &Kinematics,
    all: &Constraints,
    elimination: &Elimination,
) -> Vec<(Source, LowerError)> {
    let (mut errors, mut named, mut left) = (Vec::new(), BTreeSet::new(), MOST_FACTORS);
    let (mut reach, state) = (PathEvaluation::default(), State::as_drawn());
    for (coordinate, _) in elimination.solved.iter().filter(|(_, row)| row.is_empty()) {
        if named.contains(coordinate) || left == 0 {
            continue;
        }
        let combination = elimination.combination(&[(*coordinate, Number::ONE)]);
        left = left.saturating_sub(combination.len());
        let sources = sources(all, combination.iter().map(|(number, _)| number));
        let says_more = |source: &Source| match source {
            Source::Couple(couple) => scene.couples[*couple as usize].terms.len() > 1,
            Source::Joint(_) => false,
        };
        if let [.., _, last] = sources[..]
            && sources.iter().all(says_more)
        {
            errors.push((last, loops(scene, kinematics, last, &sources, Why::Opposed)));
            for (number, _) in &combination {
                let (_, row) = all.list[*number as usize].equation.measure(kinematics, &state, &mut reach);
                named.extend(row.into_iter().map(|(coordinate, _)| coordinate));
            }
        }
    }
    errors
}

/// The error for some constraints.
pub fn conflict_error(
    scene: &Scene,
    kinematics: &Kinematics,
    all: &Constraints,
    numbers: &[u32],
    why: Why,
) -> LowerError {
    let sources = sources(all, numbers.iter());
    loops(scene, kinematics, sources[0], &sources, why)
}

/// The error for a constraint that follows from the others as drawn, but not at rest.
pub fn broken_error(scene: &Scene, kinematics: &Kinematics, all: &Constraints, source: Source) -> LowerError {
    let numbers: Vec<u32> = (0..all.list.len() as u32).collect();
    loops(scene, kinematics, source, &sources(all, numbers.iter()), Why::Locked)
}

/// The error for a rest at which constraints that are independent in the drawing are dependent.
pub fn singular_error(scene: &Scene, kinematics: &Kinematics, all: &Constraints, left: &DependentRow) -> LowerError {
    let source = all.list[left.row as usize].source;
    loops(scene, kinematics, source, &sources(all, left.combination.iter().map(|(number, _)| number)), Why::Branching)
}

/// The sources of constraints, each once.
fn sources<'a>(all: &Constraints, numbers: impl Iterator<Item = &'a u32>) -> Vec<Source> {
    let mut sources: Vec<Source> = numbers.map(|number| all.list[*number as usize].source).collect();
    sources.sort_unstable();
    sources.dedup();
    sources
}

/// Names and places of the members of the loops of some constraints: those of `first` before the others.
fn name_of(scene: &Scene, kinematics: &Kinematics, first: Source, sources: &[Source]) -> Vec<(String, Span)> {
    let mut all: Vec<Source> = vec![first];
    for source in [first].iter().chain(sources) {
        let members = match source {
            Source::Joint(joint) => kinematics.tree.closed_by(scene, *joint).into_iter().map(Source::Joint).collect(),
            couple @ Source::Couple(_) => vec![*couple],
        };
        for member in members {
            if !all.contains(&member) {
                all.push(member);
            }
        }
    }
    all.into_iter().map(|source| (scene.words.display(source.name(scene)), source.span(scene))).collect()
}

fn loops(scene: &Scene, kinematics: &Kinematics, first: Source, sources: &[Source], why: Why) -> LowerError {
    LowerError::Loop { joints: name_of(scene, kinematics, first, sources), why }
}

/// Whether the loops have at least three pivots and all of them are on one line as drawn.
fn in_line(scene: &Scene, kinematics: &Kinematics, sources: &[Source]) -> bool {
    let joints = sources.iter().flat_map(|source| match source {
        Source::Joint(joint) => kinematics.tree.closed_by(scene, *joint),
        Source::Couple(_) => Vec::new(),
    });
    let pivots: Vec<&Vec3> = joints.filter_map(|joint| scene.joints[joint.index()].at.as_ref()).collect();
    let Some(far) = pivots.iter().map(|at| at.sub(pivots[0])).find(|way| !way.may_be_zero()) else { return false };
    pivots.len() >= 3 && pivots.iter().all(|at| at.sub(pivots[0]).cross(&far).may_be_zero())
}

impl Constraints {
    /// An error if the constraints leave no motion.
    pub fn check_freedom(
        &self,
        scene: &Scene,
        kinematics: &Kinematics,
        reduction: &Reduction,
    ) -> Result<(), Vec<LowerError>> {
        if reduction.n() > 0 {
            return Ok(());
        }
        let all: Vec<u32> = (0..self.list.len() as u32).collect();
        Err(vec![conflict_error(scene, kinematics, self, &all, Why::Locked)])
    }
}
