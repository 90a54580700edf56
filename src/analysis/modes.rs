//! The undamped modes of M q'' + K q = 0: a linear system in, modes with certified frequencies out.
//!
//! The system is taken apart into independent parts; motions without inertia are eliminated exactly ([`condense`]); each part
//! is an eigenproblem ([`eigen`]); the modes of all parts, over all coordinates, are put in order, scaled and signed.
//!
//! Clause: spec.md 10.

use super::answer::{Mode, ModeKind, Modes, Route};
use super::certificate;
use super::condense::{Condensed, condense};
use super::eigen::{Eigenvalue, Failure, Pair, eigenpairs};
use super::error::{AnalysisError, place};
use super::parts::{Part, chosen, independent_undamped};
use super::terms::Terms;
use super::triple::Triple;
use super::{shape, structure};
use crate::base::{Ball, Dd, Number};
use crate::system::{CoordinateId, Form, LinearSystem};
use std::cmp::Ordering;

/// Dense matrices of more coordinates than this would take minutes.
pub const MAX_DENSE: usize = 400;

/// Every mode holds a shape and shares over all coordinates, of every part: 24 bytes a pair of mode and coordinate.
const MAX_COORDINATES: usize = 4000;

/// The undamped modes, ascending in omega^2.
pub fn modes(system: &LinearSystem) -> Result<Modes, AnalysisError> {
    if system.n() > MAX_COORDINATES {
        let (count, limit) = (system.n(), MAX_COORDINATES);
        return Err(AnalysisError::TooManyCoordinates { count, limit, at: place(system, 0) });
    }
    let parts = independent_undamped(system);
    let mut local = vec![0u32; system.n()];
    let (mut pairs, mut infinite) = (Vec::new(), 0);
    for part in &parts {
        let count = part.coordinates.len();
        if count > MAX_DENSE {
            return Err(AnalysisError::TooManyCoordinates { count, limit: MAX_DENSE, at: place(system, 0) });
        }
        let found = if parts.len() == 1 {
            part_pairs(system, part, &system.k, &system.m)?
        } else {
            part.coordinates.iter().enumerate().for_each(|(i, &c)| local[c as usize] = i as u32);
            part_pairs(system, part, &chosen(&system.k, &part.k, &local), &chosen(&system.m, &part.m, &local))?
        };
        infinite += count - found.len();
        pairs.extend(found.into_iter().map(|pair| spread(pair, part, system.n())));
    }
    if parts.len() > 1 {
        pairs.sort_by(|a, b| ascending(&a.value, &b.value));
    }
    let report = Report { system, masses: Terms::of(&system.m), stiffness: Terms::of(&system.k) };
    let list = pairs.iter().zip(cluster_numbers(&pairs)).map(|(pair, cluster)| report.mode(pair, cluster)).collect();
    Ok(Modes { list, infinite })
}

/// The eigenpairs of a part, whose own forms these are.
fn part_pairs(system: &LinearSystem, part: &Part, k: &Form, m: &Form) -> Result<Vec<Pair>, AnalysisError> {
    let n = part.coordinates.len();
    match eigenpairs(k, m, n) {
        Ok(pairs) => Ok(pairs),
        Err(Failure::Range) => Err(AnalysisError::OutOfRange { at: place(system, part.coordinates[0] as usize) }),
        Err(Failure::Mass(at)) => without_massless_motions(system, part, k, m, at),
    }
}

/// The same if M is singular: exactly, or not at all.
fn without_massless_motions(
    system: &LinearSystem,
    part: &Part,
    k: &Form,
    m: &Form,
    at: usize,
) -> Result<Vec<Pair>, AnalysisError> {
    let n = part.coordinates.len();
    let global = |local: usize| part.coordinates[local] as usize;
    let space = structure::null_space(m, n);
    if space.dimension == 0 {
        return Err(AnalysisError::indefinite_mass(system, CoordinateId(global(at) as u32)));
    }
    let singular = |coordinates: Vec<usize>| AnalysisError::singular_mass(system, &coordinates);
    if space.vectors.len() < space.dimension {
        return Err(singular(vec![global(at)]));
    }
    let condensed = condense(m, k, n, &space.vectors).map_err(|undetermined| singular(vec![global(undetermined.0)]))?;
    for motion in condensed.loose_motions(n) {
        let moving: Vec<usize> = (0..n).filter(|&i| !motion[i].is_zero()).map(global).collect();
        if !is_damped(system, part, &motion) {
            return Err(singular(moving));
        }
    }
    let pairs = eigenpairs(&condensed.k, &condensed.m, condensed.kept.len()).map_err(|failure| match failure {
        Failure::Mass(at) => AnalysisError::indefinite_mass(system, CoordinateId(global(condensed.kept[at]) as u32)),
        Failure::Range => AnalysisError::OutOfRange { at: place(system, global(0)) },
    })?;
    Ok(pairs.into_iter().map(|pair| expanded(pair, &condensed, n)).collect())
}

fn expanded(pair: Pair, condensed: &Condensed, n: usize) -> Pair {
    Pair { x: condensed.expanded(n, &pair.x), ..pair }
}

/// Some damper may act on the motion of the part.
fn is_damped(system: &LinearSystem, part: &Part, motion: &[Number]) -> bool {
    system.c.terms().iter().any(|term| {
        let stretch =
            system.c.row(term).iter().fold(Number::ZERO, |sum, (i, a)| match part.coordinates.binary_search(&i.0) {
                Ok(local) => &sum + &(a * &motion[local]),
                Err(_) => sum,
            });
        !stretch.is_zero()
    })
}

/// The vector over all coordinates.
fn spread(pair: Pair, part: &Part, n: usize) -> Pair {
    if pair.x.len() == n {
        return pair;
    }
    let mut x = vec![Triple::ZERO; n];
    part.coordinates.iter().zip(&pair.x).for_each(|(&i, &value)| x[i as usize] = value);
    Pair { x, ..pair }
}

fn ascending(a: &Eigenvalue, b: &Eigenvalue) -> Ordering {
    let value = |e: &Eigenvalue| match e {
        Eigenvalue::Zero => Triple::ZERO,
        Eigenvalue::Near { value, .. } => *value,
    };
    let difference = (value(a) - value(b)).hi();
    a.sign().cmp(&b.sign()).then(difference.partial_cmp(&0.0).unwrap_or(Ordering::Equal))
}

/// Numbers the modes whose enclosures overlap.
fn cluster_numbers(pairs: &[Pair]) -> Vec<Option<u32>> {
    let mut numbers = vec![None; pairs.len()];
    let mut next = 0;
    for i in 1..pairs.len() {
        if !overlap(&pairs[i - 1].value, &pairs[i].value) {
            continue;
        }
        if numbers[i - 1].is_none() {
            (numbers[i - 1], next) = (Some(next), next + 1);
        }
        numbers[i] = numbers[i - 1];
    }
    numbers
}

fn overlap(a: &Eigenvalue, b: &Eigenvalue) -> bool {
    match (a, b) {
        (Eigenvalue::Near { value: a, radius: r, .. }, Eigenvalue::Near { value: b, radius: s, .. }) => {
            (*b - *a).hi().abs() <= r + s
        }
        _ => false,
    }
}

/// What a mode is told with.
struct Report<'a> {
    system: &'a LinearSystem,
    masses: Terms,
    stiffness: Terms,
}

impl Report<'_> {
    fn mode(&self, pair: &Pair, cluster: Option<u32>) -> Mode {
        let mut shape: Vec<f64> = pair.x.iter().map(|x| x.hi()).collect();
        let kinetic = shape::kinetic_shares(&self.masses, &shape);
        if shape::is_reversed(&shape, &kinetic, self.system) {
            shape.iter_mut().for_each(|x| *x = -*x);
        }
        let rigid = Mode {
            kind: ModeKind::Rigid,
            omega_squared: Ball::ZERO,
            omega: Ball::ZERO,
            cluster,
            shape,
            input_condition: None,
            kinetic,
            strain: Vec::new(),
            route: pair.route,
        };
        match pair.value {
            Eigenvalue::Zero => rigid,
            // Not to be told from a rigid motion, nor from one that is nearly so.
            Eigenvalue::Near { value, radius, .. } if pair.route == Route::Exact || value.hi() == 0.0 => {
                let unknown = Ball::new(Dd::ZERO, radius);
                Mode { omega_squared: unknown, omega: Ball::new(Dd::ZERO, f64::INFINITY), ..rigid }
            }
            Eigenvalue::Near { value, radius, positive } => self.elastic(rigid, pair, value, radius, positive),
        }
    }

    fn elastic(&self, mode: Mode, pair: &Pair, lambda: Triple, radius: f64, positive: bool) -> Mode {
        let negative = lambda.hi() < 0.0;
        let mut omega = certificate::root(if negative { -lambda } else { lambda }, radius);
        if !positive && lambda.hi().abs() <= radius {
            omega = Ball::new(omega.mid, f64::INFINITY);
        }
        let energies: Vec<f64> = (0..self.stiffness.len())
            .map(|t| {
                let stretch = self.stiffness.stretch(t, &pair.x).value.hi();
                self.stiffness.weights[t].value.hi() * stretch * stretch
            })
            .collect();
        let whole: f64 = energies.iter().map(|energy| energy.abs()).sum();
        Mode {
            kind: if negative { ModeKind::Divergence } else { ModeKind::Oscillation },
            omega_squared: certificate::ball(lambda, radius),
            omega,
            input_condition: Some(whole / lambda.hi().abs() + 1.0),
            strain: shape::strain_shares(&self.system.k, energies.into_iter()),
            ..mode
        }
    }
}
