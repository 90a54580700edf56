//! The poles of M s^2 + C s + K: all 2n of them, each with a proven bound. In: the linear system and its undamped
//! modes. Out: poles, ascending in |s|. See docs/method/poles.md.
//!
//! Independent parts are treated one by one. Without damping the poles are +-i omega; one coordinate is a quadratic;
//! damping C = alpha M + beta K makes a quadratic of each mode; otherwise eigenvalues of the companion matrix are
//! refined. If poles are not separated, or motions have no inertia, the polynomial det Q decides exactly.

pub(in crate::analysis) mod aberth;
pub(in crate::analysis) mod batch;
pub(in crate::analysis) mod cluster;
pub(in crate::analysis) mod companion;
pub mod coordinates;
pub mod count;
pub(in crate::analysis) mod disc_columns;
pub(in crate::analysis) mod discs;
pub(in crate::analysis) mod exact;
pub mod feedback;
pub(in crate::analysis) mod list;
mod lossy;
pub(in crate::analysis) mod passive;
pub(in crate::analysis) mod pencil;
pub(in crate::analysis) mod proportional;
pub(in crate::analysis) mod quadratic;
pub(in crate::analysis) mod refinement;
pub mod residues;
pub(in crate::analysis) mod rigid;
pub(in crate::analysis) mod scaling;
pub(in crate::analysis) mod schur;
pub(in crate::analysis) mod targeted;
pub(in crate::analysis) mod together;

use crate::analysis::answer::{Mode, ModeKind, Modes, Pole, Poles};
use crate::analysis::error::{AnalysisError, place};
use crate::analysis::modes::certificate::ball;
use crate::analysis::modes::eigen::eigenpairs;
use crate::analysis::modes::pair::Eigenvalue;
use crate::analysis::modes::parts::{Part, as_system, choose_terms, independent};
use crate::analysis::modes::request::{DEFAULT_TOLERANCE, Request};
use crate::analysis::poles::aberth::aberth;
use crate::analysis::poles::batch::refine_all;
use crate::analysis::poles::cluster::separate;
use crate::analysis::poles::companion::Basis;
use crate::analysis::poles::coordinates::PoleCoordinates;
use crate::analysis::poles::discs::{PoleEnclosure, discs};
use crate::analysis::poles::exact::{Exact, ExactPoles, exact_poles};
use crate::analysis::poles::list::PoleList;
use crate::analysis::poles::passive::{Passive, is_semidefinite, takes_energy};
use crate::analysis::poles::pencil::Pencil;
use crate::analysis::poles::proportional::{Proportional, proportional};
use crate::analysis::poles::quadratic::{Roots, real_root, roots};
use crate::analysis::poles::refinement::{Pair, refine};
use crate::analysis::poles::residues::{Proof, Residues};
use crate::analysis::poles::rigid::{RigidMotions, rigid_motions};
use crate::analysis::poles::scaling::scale;
use crate::analysis::poles::targeted::lowest_poles;
use crate::analysis::poles::together::refine_together;
use crate::base::{Number, runs};
use crate::kernel::complex::Complex;
use crate::system::{Form, LinearSystem, Losses};
use std::sync::Arc;

/// Up to this many coupled coordinates, all poles are computed if all modes are requested; without a request, up to
/// `MAX_UNASKED`.
pub const MAX_DAMPED: usize = 1_000;
/// Up to this many coordinates, the Schur form is kept for other computations.
const MOST_KEPT: usize = 150;
/// In larger scenes no pole is looked for where springs have loss factors: the parts with them are small in any case.
const MOST_BESIDE_LOSSES: usize = 400;
/// Up to this many coordinates, poles that the state matrix has lost are looked for once more, by steps with a factorisation for each
/// pole: a few seconds at the most, growing with the fourth power.
const MOST_ANEW: usize = 40;
/// From this many coordinates on, all pairs are first refined at once.
const TOGETHER: usize = 24;

/// All poles; none where springs have loss factors with which they are not found.
pub fn poles(system: &LinearSystem, modes: &Modes) -> Result<Poles, AnalysisError> {
    runs::begins("poles");
    if system.losses.is_some() {
        let is_small = system.n() <= MOST_BESIDE_LOSSES;
        let found = is_small
            .then(|| poles_without_scaling(system, modes, Also::Nothing).and_then(|found| in_range(system, found)));
        return Ok(found.and_then(Result::ok).unwrap_or_default());
    }
    if system.c.is_empty() {
        let mut found = PoleList::default();
        found.add_undamped(modes);
        found.infinite(2 * modes.infinite);
        found.end_part(system.n());
        return Ok(found.into_sorted(system.n()));
    }
    if let Some(near_one) = scale(system)
        && let Ok(modes) = all_modes(&near_one.system)
    {
        return in_range(system, near_one.unscale(poles_without_scaling(&near_one.system, &modes, Also::Nothing)?));
    }
    in_range(system, poles_without_scaling(system, modes, Also::Nothing)?)
}

/// All poles, and transfer functions as sums over them if the proof bounds the error of such sums: for a system that is
/// one part with general damping and has no pole on the imaginary axis.
pub fn poles_and_residues(system: &LinearSystem, modes: &Modes) -> Result<Poles, AnalysisError> {
    if system.losses.is_some() || system.c.is_empty() || scale(system).is_some() || !is_one_part(system) {
        return poles(system, modes);
    }
    poles_and(Also::Residues, system, modes)
}

/// The motion in coordinates of the poles: of a system that is one part of up to `MAX_DAMPED` coordinates with any damping, without
/// rigid motions.
pub fn pole_coordinates(system: &LinearSystem, modes: &Modes) -> Option<Arc<PoleCoordinates>> {
    let swings = |mode: &Mode| matches!(mode.kind, ModeKind::Oscillation | ModeKind::Divergence);
    let suits = system.n() <= MAX_DAMPED && modes.list.len() == system.n() && modes.list.iter().all(swings);
    if !suits || system.losses.is_some() || scale(system).is_some() || !is_one_part(system) {
        return None;
    }
    poles_and(Also::Coordinates, system, modes).ok()?.coordinates
}

fn is_one_part(system: &LinearSystem) -> bool {
    matches!(&independent(system)[..], [part] if part.coordinates.iter().map(|&c| c as usize).eq(0..system.n()))
}

fn poles_and(also: Also, system: &LinearSystem, modes: &Modes) -> Result<Poles, AnalysisError> {
    runs::begins("poles");
    in_range(system, poles_without_scaling(system, modes, also)?)
}

/// A result of the poles' proof that is wanted besides their discs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Also {
    Nothing,
    Residues,
    Coordinates,
}

/// That result.
#[derive(Default)]
struct FromProof {
    residues: Option<Residues>,
    coordinates: Option<PoleCoordinates>,
}

/// All modes, whatever their number: the request for all poles implies it.
fn all_modes(system: &LinearSystem) -> Result<Modes, AnalysisError> {
    crate::analysis::modes_as(system, &Request::default().without_shares())
}

/// Poles outside the range of binary64 could not be printed.
fn in_range(system: &LinearSystem, poles: Poles) -> Result<Poles, AnalysisError> {
    let is_finite = |pole: &Pole| pole.re.mid.is_finite() && pole.im.mid.is_finite();
    if poles.list.iter().all(is_finite) { Ok(poles) } else { Err(AnalysisError::OutOfRange { at: place(system, 0) }) }
}

/// All poles of a damped system whose numbers are not rescaled, with what else is wanted of their proof.
fn poles_without_scaling(system: &LinearSystem, modes: &Modes, also: Also) -> Result<Poles, AnalysisError> {
    let mut found = PoleList::default();
    let parts = independent(system);
    let mut local = vec![0u32; system.n()];
    for part in &parts {
        part.coordinates.iter().enumerate().for_each(|(i, &c)| local[c as usize] = i as u32);
    }
    let losses = system.losses.as_deref();
    let lossy = losses.map(|losses| (losses, lossy::terms_by_part(losses, &parts, system.n())));
    for (number, coordinates) in parts.iter().enumerate() {
        let part = Portion { system, part: coordinates, local: &local, also };
        let own = lossy.as_ref().map(|(losses, terms)| (*losses, &terms[number][..]));
        if let Some(lossy) = own.filter(|(_, terms)| !terms.is_empty()) {
            match lossy::lossy_poles(system, lossy, coordinates, &local) {
                Some(poles) => part.take_lossy(&poles, lossy, &mut found),
                None => return Ok(Poles::default()),
            }
        } else if coordinates.coordinates.len() == 1 && also != Also::Coordinates {
            part.single(&mut found)?;
        } else if parts.len() == 1 {
            part.solve(modes, &mut found)?;
        } else {
            // Modes of the whole system may mix equal frequencies of different parts.
            part.solve(&all_modes(&as_system(system, coordinates, &local))?, &mut found)?;
        }
        found.end_part(coordinates.coordinates.len());
    }
    Ok(found.into_sorted(system.n()))
}

/// The poles of the listed modes; none if damping couples the modes. `whole` is the system as one part.
pub fn poles_of(system: &LinearSystem, whole: &Part, modes: &Modes) -> Poles {
    let mut found = PoleList::default();
    if system.c.is_empty() {
        found.add_undamped(modes);
        found.infinite(2 * modes.infinite);
    } else if let Some(damping) = proportional(system, whole) {
        let passive = Passive::of(system, whole, modes);
        decoupled_roots(modes, &damping).into_iter().for_each(|roots| found.quadratic(roots, passive));
        without_inertia(modes, &damping, passive, &mut found);
    }
    finish_partial(found, system, modes)
}

/// The poles of the listed modes with this damping ratio for each oscillation, added to the effect of dampers; `None`
/// if the dampers couple the modes.
pub fn poles_by_ratio(system: &LinearSystem, whole: &Part, modes: &Modes, ratio: &Number) -> Option<Poles> {
    let base = if system.c.is_empty() { Proportional::NONE } else { proportional(system, whole)? };
    let mut found = PoleList::default();
    let passive = Passive::of(system, whole, modes);
    let passive = Passive { damped: passive.damped && takes_energy(ratio), ..passive };
    add_by_ratio(modes, ratio, &base, passive, &mut found);
    without_inertia(modes, &base, passive, &mut found);
    Some(finish_partial(found, system, modes))
}

/// The poles of modes of which each oscillation has this damping ratio, added to the damping `base`.
fn add_by_ratio(modes: &Modes, ratio: &Number, base: &Proportional, passive: Passive, found: &mut PoleList) {
    let twice = ratio * &Number::from(2);
    // s = omega z, with z^2 + 2 zeta z + 1 = 0 exactly.
    let unit = roots(&Number::ONE, &twice, &Number::ONE);
    for mode in &modes.list {
        let omega_squared = Number::Ball(mode.omega_squared);
        let own = base.of_mode(&omega_squared);
        match mode.kind {
            ModeKind::Oscillation if own.is_zero() => found.quadratic(unit.times(mode.omega), passive),
            ModeKind::Oscillation => {
                let damping = &own + &(&twice * &Number::Ball(mode.omega));
                found.quadratic(roots(&Number::ONE, &damping, &omega_squared), passive);
            }
            ModeKind::Rigid if own.is_zero() => found.zeros(2),
            _ => found.quadratic(roots(&Number::ONE, &own, &omega_squared), passive),
        }
    }
}

/// Poles of motions without inertia for C = alpha M + beta K: det Q = (1 + beta s)^n det(sigma M + K), sigma = (s² +
/// alpha s) / (1 + beta s), so each of these motions has one pole at -1 / beta and an infinite one, or two infinite
/// ones if beta = 0.
fn without_inertia(modes: &Modes, damping: &Proportional, passive: Passive, found: &mut PoleList) {
    if damping.beta.is_zero() || modes.infinite == 0 {
        return found.infinite(2 * modes.infinite);
    }
    let root = real_root((-&(&Number::ONE / &damping.beta)).to_ball());
    found.add_repeated(root, modes.infinite, passive);
    found.infinite(modes.infinite);
}

/// The list of the poles that were found, and the number of those that were not.
fn finish_partial(mut found: PoleList, system: &LinearSystem, modes: &Modes) -> Poles {
    let left_out = found.missing(2 * system.n());
    if modes.is_complete() {
        found.end_part(system.n());
    }
    Poles { left_out, ..found.into_sorted(system.n()) }
}

/// The poles that the first `wanted` modes (the lowest of all) become with damping: computed one by one, each with its
/// own proof. `None` if no sparse method suits the system.
pub fn poles_followed(
    system: &LinearSystem,
    whole: &Part,
    modes: &Modes,
    wanted: usize,
    tolerance: f64,
) -> Option<Poles> {
    let Some(near_one) = scale(system) else { return follow(system, whole, modes, wanted, tolerance) };
    let poles = follow(&near_one.system, whole, &near_one.modes(modes), wanted, tolerance)?;
    Some(near_one.unscale(poles))
}

fn follow(system: &LinearSystem, whole: &Part, modes: &Modes, wanted: usize, tolerance: f64) -> Option<Poles> {
    let mut found = PoleList::default();
    let discs = lowest_poles(system, whole, &modes.list, wanted, tolerance)?;
    let rigid = modes.list.iter().take(wanted).filter(|mode| mode.kind == ModeKind::Rigid).count();
    // K N = 0 means a pole at zero, and C N = 0 in addition a double one.
    let free = rigid == 1 && [&system.k, &system.c].iter().all(|form| ignores_translation(form));
    found.zeros(if free { 2 } else { rigid });
    found.add_refined(discs.into_iter().map(|disc| (false, disc)), Passive::of(system, whole, modes));
    Some(Poles { followed: true, ..finish_partial(found, system, modes) })
}

/// Whether an equal displacement of all coordinates stretches no term, decided exactly.
fn ignores_translation(form: &Form) -> bool {
    form.terms().all(|term| form.row(term).iter().fold(Number::ZERO, |sum, (_, a)| &sum + a).is_zero())
}

/// Whether each mode has separate poles: there is no damping, or damping is proportional.
pub fn are_of_modes(system: &LinearSystem, whole: &Part) -> bool {
    system.c.is_empty() || proportional(system, whole).is_some()
}

/// s^2 + (alpha + beta omega^2) s + omega^2 for each mode.
fn decoupled_roots(modes: &Modes, damping: &Proportional) -> Vec<Roots> {
    let quadratic = |omega_squared: Number| roots(&Number::ONE, &damping.of_mode(&omega_squared), &omega_squared);
    modes.list.iter().map(|mode| quadratic(Number::Ball(mode.omega_squared))).collect()
}

/// An independent part of a system; `local` numbers the coordinates within their parts.
struct Portion<'a> {
    system: &'a LinearSystem,
    part: &'a Part,
    local: &'a [u32],
    also: Also,
}

impl Portion<'_> {
    /// Finds the poles of the part; `modes` are those of the part.
    fn solve(&self, modes: &Modes, found: &mut PoleList) -> Result<(), AnalysisError> {
        if self.also == Also::Coordinates {
            self.general(modes, found)?;
        } else if self.part.c.is_empty() {
            found.add_undamped(modes);
            found.infinite(2 * modes.infinite);
        } else if self.part.k.is_empty() && modes.list.len() == self.part.coordinates.len() {
            self.dampers_alone(found)?;
        } else if let Some(ratio) = self.ratio_of_all(modes).filter(|_| modes.is_complete()) {
            // Motions without inertia, if there are any, are not damped.
            add_by_ratio(modes, ratio, &Proportional::NONE, self.passive(modes), found);
            found.infinite(2 * modes.infinite);
        } else if modes.list.len() != self.part.coordinates.len() {
            // Motions without inertia have finite poles if dampers hold them.
            match exact_poles(self.system, self.part, self.local) {
                Some(Exact::Poles(poles)) => self.take(&poles, modes, found),
                Some(Exact::Singular) => return Err(self.massless()),
                None => {
                    return Err(AnalysisError::massless_poles(
                        self.system,
                        &self.part.coordinates,
                        exact::MOST_COORDINATES,
                    ));
                }
            }
        } else if let Some(damping) = proportional(self.system, self.part) {
            self.add_decoupled(modes, &damping, found);
        } else {
            self.general(modes, found)?;
        }
        Ok(())
    }

    /// The damping ratio that all oscillations of the system have, while nothing else is damped, unless it may be critical.
    fn ratio_of_all(&self, modes: &Modes) -> Option<&Number> {
        let ratio = self.system.c.damping_ratio().filter(|ratio| !(*ratio - &Number::ONE).may_be_zero())?;
        modes.list.iter().all(|mode| mode.kind != ModeKind::Undetermined).then_some(ratio)
    }

    /// Takes the poles of a part with loss factors. A pole s with Re s > 0 and Im s > 0 would need more energy than M, C, K and H,
    /// none of them negative, leave to it.
    fn take_lossy(&self, poles: &ExactPoles, (losses, terms): (&Losses, &[u32]), found: &mut PoleList) {
        let passive = Passive::of_springs(self.system, self.part);
        let grows_nowhere = passive.nothing_grows() && is_semidefinite(&losses.h, terms);
        found.exact(poles, Passive { damped: grows_nowhere, held: grows_nowhere });
        found.infinite((2 * self.part.coordinates.len()).saturating_sub(poles.degree()));
    }

    /// Error: some motion has neither inertia nor a force against it.
    fn massless(&self) -> AnalysisError {
        let coordinates: Vec<usize> = self.part.coordinates.iter().map(|&c| c as usize).collect();
        AnalysisError::singular_mass(self.system, &coordinates)
    }

    /// One coordinate: a quadratic with the sums of its terms, exact if they are.
    fn single(&self, found: &mut PoleList) -> Result<(), AnalysisError> {
        let [m, c, k] =
            [(&self.system.m, &self.part.m), (&self.system.c, &self.part.c), (&self.system.k, &self.part.k)]
                .map(|(form, terms)| diagonal(form, terms));
        let passive = Passive::of_springs(self.system, self.part);
        let passive = Passive { held: passive.held || k.is_positive(), ..passive };
        if m.is_positive() {
            found.quadratic(roots(&m, &c, &k), passive);
        } else if !m.is_zero() || c.may_be_zero() && !c.is_zero() || c.is_zero() && k.may_be_zero() {
            return Err(self.massless());
        } else if !c.is_zero() {
            found.root(real_root((-&(&k / &c)).to_ball()), None, false, passive);
            found.infinite(1);
        } else {
            found.infinite(2);
        }
        Ok(())
    }

    /// Without springs Q(s) = s (s M + C): a zero for each coordinate, and s = -mu for the eigenvalues of C x = mu M x.
    fn dampers_alone(&self, found: &mut PoleList) -> Result<(), AnalysisError> {
        let n = self.part.coordinates.len();
        let [c, m] = [(&self.system.c, &self.part.c), (&self.system.m, &self.part.m)]
            .map(|(form, terms)| choose_terms(form, terms, self.local));
        let pairs = eigenpairs(&c, &m, n, DEFAULT_TOLERANCE);
        let out_of_range = |_| AnalysisError::OutOfRange { at: place(self.system, self.part.coordinates[0] as usize) };
        let passive = Passive::of_springs(self.system, self.part);
        found.zeros(n);
        for pair in pairs.map_err(out_of_range)? {
            match pair.value {
                Eigenvalue::Zero => found.zeros(1),
                Eigenvalue::Near { value, radius, .. } => {
                    found.add_repeated(real_root(-ball(value, radius)), 1, passive);
                }
            }
        }
        Ok(())
    }

    fn add_decoupled(&self, modes: &Modes, damping: &Proportional, found: &mut PoleList) {
        let list = decoupled_roots(modes, damping);
        // With omega^2 known only as a ball it may be open whether the damping is critical.
        if list.iter().any(|roots| matches!(roots, Roots::Unseparated(_))) && self.exact(modes, found) {
            return;
        }
        let passive = self.passive(modes);
        list.into_iter().for_each(|roots| found.quadratic(roots, passive));
    }

    /// Companion, refinement, discs.
    fn general(&self, modes: &Modes, found: &mut PoleList) -> Result<(), AnalysisError> {
        let pencil = Pencil::of(self.system, self.part, self.local);
        let rigid = if modes.list.iter().any(|mode| mode.kind == ModeKind::Rigid) {
            rigid_motions(&as_system(self.system, self.part, self.local))
        } else {
            RigidMotions::default()
        };
        let working = pencil.to_dd();
        let basis = Basis::of(&working, modes, &rigid);
        let certified = |mut pairs: Vec<Pair>| {
            separate(&working, &mut pairs);
            let more = |proof: &Proof| match self.also {
                Also::Nothing => FromProof::default(),
                Also::Residues => {
                    FromProof { residues: proof.residues(self.system, self.local), ..FromProof::default() }
                }
                Also::Coordinates => FromProof { coordinates: proof.coordinates(self.system), ..FromProof::default() },
            };
            let (discs, more) = discs(&pencil, &rigid, &pairs, 2 * pencil.n, more);
            (pairs, discs, more.unwrap_or_default())
        };
        let one_by_one = |starts: &[Complex<f64>]| {
            starts.iter().enumerate().filter_map(|(seed, &start)| refine(&working, &basis, start, seed)).collect()
        };
        let together = || refine_together(&working, &basis, &basis.starts()?).map(certified);
        let mut state = None;
        let (mut pairs, mut discs, mut more): (_, _, FromProof) = if pencil.n >= TOGETHER { together() } else { None }
            .filter(|(_, discs, _)| all_apart(discs))
            .unwrap_or_default();
        if !all_apart(&discs) {
            let spectrum = basis.spectrum();
            (pairs, discs, more) = certified(refine_all(&working, &basis, &spectrum));
            if !all_apart(&discs) && pencil.n <= MOST_ANEW {
                (pairs, discs, more) = certified(one_by_one(&aberth(&basis, &spectrum.values())));
            }
            state = basis.state_form(spectrum).filter(|_| pencil.n == self.system.n() && pencil.n <= MOST_KEPT);
        }
        if !all_apart(&discs) && self.exact(modes, found) {
            return Ok(());
        }
        let count: usize = pairs.iter().map(|pair| if pair.is_real() { 1 } else { 2 }).sum();
        let rigid_modes = modes.list.iter().filter(|mode| mode.kind == ModeKind::Rigid).count();
        // Each rigid motion has a pole at zero; it may be undecided whether a damper acts on it, and so where its other
        // pole is.
        let decided = rigid.free.len() + rigid.dragged.len() == rigid_modes;
        let zeros = if decided { basis.zeros() } else { rigid_modes };
        let Some(lost) = (2 * pencil.n).checked_sub(zeros + count) else {
            // Approximations of a pole that is repeated within its uncertainty may outnumber the poles, as real and
            // complex ones. Then nothing is known about any of them.
            found.unknown((2 * pencil.n).saturating_sub(zeros));
            found.zeros(zeros.min(2 * pencil.n));
            return Ok(());
        };
        // Poles that were not found are listed nevertheless, as unknown, and no other pole is certified.
        found.unknown(lost);
        found.zeros(zeros);
        found.add_refined(pairs.iter().map(Pair::is_real).zip(discs), self.passive(modes));
        (found.residues, found.coordinates, found.state) = (more.residues, more.coordinates, state);
        Ok(())
    }

    /// Adds the roots of det Q; `false` if that is beyond exact arithmetic.
    fn exact(&self, modes: &Modes, found: &mut PoleList) -> bool {
        match exact_poles(self.system, self.part, self.local) {
            Some(Exact::Poles(poles)) => self.take(&poles, modes, found),
            Some(Exact::Singular) | None => return false,
        }
        true
    }

    fn take(&self, poles: &ExactPoles, modes: &Modes, found: &mut PoleList) {
        found.infinite((2 * self.part.coordinates.len()).saturating_sub(poles.degree()));
        found.exact(poles, self.passive(modes));
    }

    fn passive(&self, modes: &Modes) -> Passive {
        Passive::of(self.system, self.part, modes)
    }
}

/// Whether every disc is certified and overlaps no other.
fn all_apart(discs: &[PoleEnclosure]) -> bool {
    !discs.is_empty() && discs.iter().all(|disc| disc.is_certified() && disc.clusters == [None; 2])
}

/// sum w a^2 of terms on one coordinate.
fn diagonal(form: &Form, terms: &[u32]) -> Number {
    terms.iter().fold(Number::ZERO, |sum, &index| {
        let term = form.term(index as usize);
        let square = form.row(term).iter().fold(Number::ZERO, |sum, (_, a)| &sum + &a.square());
        &sum + &(term.weight * &square)
    })
}
