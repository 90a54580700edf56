//! The undamped modes of M q'' + K q = 0: a linear system in, modes with certified frequencies out.
//!
//! 1. What is rigid is decided exactly ([`structure`]).
//! 2. Approximate modes by the cheapest method that suits the terms ([`start`]).
//! 3. Newton steps for all of them at once, with K and M from the terms in double-double ([`correction`]).
//! 4. Rayleigh quotients in triple words, and their certificate ([`certificate`]). If it is not good enough, again from 2 with
//!    the next precision.
//!
//! Clause: spec.md, "Modes".

use super::answer::{Mode, ModeKind, Modes};
use super::certificate::{self, Enclosure, enclose};
use super::correction;
use super::dense::Matrix;
use super::error::{AnalysisError, place};
use super::gram::Gram;
use super::start::{self, Inertia, Start};
use super::structure::{self, NullSpace};
use super::terms::Terms;
use super::triple::Triple;
use super::{mass, shape};
use crate::base::{Ball, Dd};
use crate::system::{CoordinateId, Form, LinearSystem};

/// Dense matrices of more coordinates than this would take minutes.
pub const MAX_DENSE: usize = 400;
/// Up to this many coordinates all digits of double-double are computed; beyond, what the tolerance asks.
const ALL_DIGITS: usize = 30;
/// Relative accuracy asked of omega^2.
const TOLERANCE: f64 = 1e-12;
/// A change that triple words do not show any more.
const NEGLIGIBLE: f64 = Dd::EPSILON / 256.0;
const MAX_STEPS: usize = 8;

/// The undamped modes, ascending in omega^2.
pub fn modes(system: &LinearSystem) -> Result<Modes, AnalysisError> {
    let n = system.n();
    if n == 0 {
        return Ok(Modes { list: Vec::new() });
    }
    if n > MAX_DENSE {
        return Err(AnalysisError::TooManyCoordinates { count: n, limit: MAX_DENSE, at: place(system, 0) });
    }
    let (masses, stiffness) = (Terms::of(&system.m), Terms::of(&system.k));
    if !(masses.is_finite() && stiffness.is_finite()) {
        return Err(AnalysisError::OutOfRange { at: place(system, 0) });
    }
    let matrix = mass::assembled(&masses, n);
    let lower = mass::factor(matrix.clone()).map_err(|at| improper_mass(system, at))?;
    let problem = Problem {
        system,
        masses: &masses,
        stiffness: &stiffness,
        inertia: Inertia { matrix, lower },
        rigid: structure::null_space(&system.k, n),
    };
    problem.solved().ok_or(AnalysisError::OutOfRange { at: place(system, 0) })
}

/// Why M has no Cholesky factor: motions without inertia, found exactly, or negative ones at this coordinate.
fn improper_mass(system: &LinearSystem, at: usize) -> AnalysisError {
    let space = structure::null_space(&system.m, system.n());
    let mut massless: Vec<usize> = (0..system.n()).filter(|&i| space.vectors.iter().any(|v| !v[i].is_zero())).collect();
    if massless.is_empty() && space.dimension == 0 {
        return AnalysisError::indefinite_mass(system, CoordinateId(at as u32));
    }
    if massless.is_empty() {
        massless.push(at);
    }
    AnalysisError::singular_mass(system, &massless)
}

/// What the modes are computed from.
struct Problem<'a> {
    system: &'a LinearSystem,
    masses: &'a Terms,
    stiffness: &'a Terms,
    inertia: Inertia,
    rigid: NullSpace,
}

/// Approximate modes with their pencil and its certificate.
struct Candidate<'a> {
    start: Start,
    k: Gram<'a>,
    m: Gram<'a>,
    list: Vec<Enclosure>,
}

impl<'a> Problem<'a> {
    fn n(&self) -> usize {
        self.system.n()
    }

    /// The methods one after the other until one is certified to the tolerance; else the best of them. `None` if numbers ran
    /// out of range.
    fn solved(&self) -> Option<Modes> {
        let mut best: Option<(f64, Candidate)> = None;
        for method in [Problem::first, Problem::second] {
            let candidate = self.refined(method(self));
            let worst = self.worst_bound(&candidate);
            if best.as_ref().is_none_or(|(other, _)| worst < *other) {
                best = Some((worst, candidate));
            }
            if worst <= TOLERANCE {
                break;
            }
        }
        let (_, candidate) = best.filter(|(_, candidate)| candidate.k.is_finite() && candidate.m.is_finite())?;
        Some(self.modes(&candidate))
    }

    /// In binary64.
    fn first(&self) -> Start {
        if self.stiffness.all_positive() {
            return match self.all_rigid_vectors_known() {
                true => start::positive(self.stiffness, &self.inertia, &self.rigid),
                false => self.second(),
            };
        }
        let form = positive_part(&self.system.k);
        let rigid = structure::null_space(&form, self.n());
        if rigid.dimension > rigid.vectors.len() {
            return self.second();
        }
        let positive = start::positive(&Terms::of(&form), &self.inertia, &rigid);
        start::mixed(self.stiffness, positive, self.rigid.vectors.len())
    }

    /// In double-double.
    fn second(&self) -> Start {
        if self.stiffness.all_positive() {
            start::positive_in_double_double(self.stiffness, &self.inertia, &self.rigid)
        } else {
            start::assembled(self.stiffness, &self.inertia, &self.rigid)
        }
    }

    fn all_rigid_vectors_known(&self) -> bool {
        self.rigid.dimension == self.rigid.vectors.len()
    }

    /// Newton steps until the couplings do not matter or do not shrink any more, then the certificate.
    fn refined(&self, mut start: Start) -> Candidate<'a> {
        let target = if self.n() <= ALL_DIGITS { NEGLIGIBLE } else { TOLERANCE * 1e-3 };
        let (mut k, mut m) = self.pencil(&start.x);
        let mut distance = self.distance(&k, &m);
        for _ in 0..MAX_STEPS {
            if distance <= target {
                break;
            }
            let x = correction::improved(&start.x, &k, &m, start.estimates.as_deref());
            let (next_k, next_m) = self.pencil(&x);
            let next = self.distance(&next_k, &next_m);
            // A first step from estimates may have to bring the quotients into order before they improve.
            let stuck = next.is_nan() || (next > 0.25 * distance && start.estimates.is_none());
            if stuck {
                break;
            }
            (k, m, distance) = (next_k, next_m, next);
            start = Start { x, estimates: None, ..start };
        }
        let list = enclose(&k, &m);
        Candidate { start, k, m, list }
    }

    fn pencil(&self, x: &Matrix<Triple>) -> (Gram<'a>, Gram<'a>) {
        (Gram::of(self.stiffness, x), Gram::of(self.masses, x))
    }

    fn distance(&self, k: &Gram, m: &Gram) -> f64 {
        correction::distance_from_diagonal(k, m, self.rigid.vectors.len())
    }

    /// The largest relative bound of an eigenvalue that is not known to be zero.
    fn worst_bound(&self, candidate: &Candidate) -> f64 {
        let known = self.rigid.vectors.len();
        let elastic = candidate.list.iter().filter(|e| e.column >= known);
        elastic
            .map(|e| e.radius / e.lambda.hi().abs())
            .fold(0.0, |worst, x| if x.is_nan() { f64::INFINITY } else { worst.max(x) })
    }

    /// All modes. The first columns of X are rigid motions. If the other eigenvalues that may be zero are no more than the
    /// dimension of the null space leaves, then all of those are exactly zero.
    fn modes(&self, candidate: &Candidate) -> Modes {
        let known = self.rigid.vectors.len();
        let positive = self.stiffness.all_positive() && self.all_rigid_vectors_known();
        let may_be_zero = |e: &Enclosure| e.column >= known && !positive && e.lambda.hi().abs() <= e.radius;
        let certain = candidate.list.iter().filter(|e| may_be_zero(e)).count() <= self.rigid.dimension - known;
        let mut modes: Vec<Mode> = (candidate.list.iter().zip(cluster_numbers(&candidate.list)))
            .map(|(e, cluster)| {
                let rigid = e.column < known || (certain && may_be_zero(e));
                let mode = if rigid { rigid_mode(certain) } else { self.elastic_mode(candidate, e, cluster) };
                self.with_shape(mode, candidate, e.column)
            })
            .collect();
        modes.sort_by_key(|mode| match mode.kind {
            ModeKind::Divergence => 0,
            ModeKind::Rigid => 1,
            ModeKind::Oscillation => 2,
        });
        Modes { list: modes }
    }

    fn elastic_mode(&self, candidate: &Candidate, enclosure: &Enclosure, cluster: Option<u32>) -> Mode {
        let Enclosure { column, lambda, radius } = *enclosure;
        let negative = lambda.hi() < 0.0;
        let mut omega = certificate::root(if negative { -lambda } else { lambda }, radius);
        if !self.stiffness.all_positive() && lambda.hi().abs() <= radius {
            omega = Ball::new(omega.mid, f64::INFINITY);
        }
        Mode {
            kind: if negative { ModeKind::Divergence } else { ModeKind::Oscillation },
            omega_squared: certificate::ball(lambda, radius),
            omega,
            cluster,
            shape: Vec::new(),
            input_condition: Some(candidate.k.absolute_energy(column) / lambda.hi().abs() + 1.0),
            kinetic: Vec::new(),
            strain: shape::strain_shares(&self.system.k, candidate.k.energies(column)),
            route: candidate.start.route,
        }
    }

    /// Adds the shape, mass-normalised and signed, and its kinetic energy.
    fn with_shape(&self, mut mode: Mode, candidate: &Candidate, column: usize) -> Mode {
        let scale = candidate.m.mid[(column, column)].hi.sqrt();
        mode.shape = candidate.start.x.column(column).iter().map(|x| x.hi() / scale).collect();
        mode.kinetic = shape::kinetic_shares(self.masses, &mode.shape);
        if shape::is_reversed(&mode.shape, &mode.kinetic, self.system) {
            mode.shape.iter_mut().for_each(|x| *x = -*x);
        }
        mode
    }
}

fn rigid_mode(certain: bool) -> Mode {
    let zero = if certain { Ball::ZERO } else { Ball::new(Dd::ZERO, f64::INFINITY) };
    Mode {
        kind: ModeKind::Rigid,
        omega_squared: zero,
        omega: zero,
        cluster: None,
        shape: Vec::new(),
        input_condition: None,
        kinetic: Vec::new(),
        strain: Vec::new(),
        route: super::answer::Route::Exact,
    }
}

/// The terms of positive weight.
fn positive_part(form: &Form) -> Form {
    let mut part = Form::new();
    for term in form.terms().iter().filter(|term| term.weight.is_positive()) {
        let source = part.source(form.source_name(term.source));
        part.push(source, term.nature, term.weight.clone(), form.row(term).iter().cloned());
    }
    part
}

/// Numbers the modes whose enclosures overlap.
fn cluster_numbers(list: &[Enclosure]) -> Vec<Option<u32>> {
    let mut numbers = vec![None; list.len()];
    let mut next = 0;
    for i in 1..list.len() {
        let (a, b) = (&list[i - 1], &list[i]);
        if (b.lambda - a.lambda).hi() > a.radius + b.radius {
            continue;
        }
        if numbers[i - 1].is_none() {
            (numbers[i - 1], next) = (Some(next), next + 1);
        }
        numbers[i] = numbers[i - 1];
    }
    numbers
}
