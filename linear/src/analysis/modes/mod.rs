//! The undamped modes of M q'' + K q = 0. In: a linear system. Out: modes with certified frequencies.
//!
//! The system is split into independent parts; motions without inertia are eliminated exactly ([`condense`]); each part
//! is an eigenproblem ([`eigen`]); the modes of all parts, over all coordinates, are sorted, scaled and signed.
//!
//! See docs/method/modes.md.

pub mod buckling;
pub(in crate::analysis) mod certificate;
pub(in crate::analysis) mod condense;
pub(in crate::analysis) mod correction;
mod counted;
pub(in crate::analysis) mod dense;
pub(in crate::analysis) mod eigen;
mod exact;
pub(in crate::analysis) mod form;
pub(in crate::analysis) mod gram;
mod image;
pub(in crate::analysis) mod linkage;
pub(in crate::analysis) mod mass;
pub(in crate::analysis) mod mesh;
pub(in crate::analysis) mod pair;
pub(in crate::analysis) mod parts;
pub mod request;
pub(in crate::analysis) mod scale;
pub mod shape;
pub(in crate::analysis) mod sparse;
pub mod splits;
pub mod squares;
pub(in crate::analysis) mod star_mesh;
pub(in crate::analysis) mod start;
pub(in crate::analysis) mod structure;
pub(in crate::analysis) mod terms;
pub(in crate::analysis) mod tree;

use crate::analysis::answer::{Before, Mode, ModeKind, Modes, PRECISE, Share};
use crate::analysis::error::{AnalysisError, place};
use crate::analysis::modes::condense::{Condensed, Stuck, condense};
use crate::analysis::modes::eigen::{Failure, eigenpairs, eigenpairs_of};
use crate::analysis::modes::pair::Found;
use crate::analysis::modes::pair::{Displacements, Eigenvalue, Pair, ascending};
use crate::analysis::modes::parts::{Part, choose_terms, independent_chained, independent_undamped};
use crate::analysis::modes::request::{FEW, Request, Which};
use crate::analysis::modes::scale::Scale;
use crate::analysis::modes::shape::Roots;
use crate::analysis::modes::terms::Terms;
use crate::base::{Ball, Number, OrderBy, Unproven, runs};
use crate::kernel::cores;
use crate::kernel::triple::Triple;
use crate::system::{CoordinateId, Form, LinearSystem, Source};

/// Dense matrices of more coordinates than this would take minutes and gigabytes.
pub const MAX_DENSE: usize = 2000;
/// All modes of larger parts are computed only on request, and so is everything that needs all modes.
pub const MAX_UNASKED: usize = 400;
/// Larger parts use sparse methods if only their lowest modes are requested.
pub(in crate::analysis) const MIN_SPARSE: usize = 100;

/// The most coordinates for all modes: each mode stores a shape and shares over all coordinates of every part, 24 bytes
/// for each pair of mode and coordinate.
pub(in crate::analysis) const MAX_ALL: usize = 4000;

/// Coordinates in all modes whose reports take a core about a millisecond.
const PER_CORE: usize = 1 << 16;

/// All undamped modes, ascending in omega^2, for analyses that need all of them: for up to [`MAX_UNASKED`] coupled
/// coordinates.
pub fn modes(system: &LinearSystem) -> Result<Modes, AnalysisError> {
    all_modes(system, &Request::default())
}

/// All undamped modes to the requested accuracy.
pub fn all_modes(system: &LinearSystem, request: &Request) -> Result<Modes, AnalysisError> {
    let parts = if system.is_chained() { independent_chained(system) } else { independent_undamped(system) };
    match parts.iter().find(|part| part.coordinates.len() > MAX_UNASKED) {
        Some(part) => Err(too_many(system, part.coordinates[0] as usize, part.coordinates.len())),
        None => modes_as(system, &Request { which: Which::All, ..*request }),
    }
}

/// The requested undamped modes, ascending in omega^2. Rows may be chained.
pub fn modes_as(system: &LinearSystem, request: &Request) -> Result<Modes, AnalysisError> {
    runs::begins("modes");
    if system.is_chained() {
        return linkage::modes(system, request);
    }
    let parts = if request.together { vec![Part::whole(system)] } else { independent_undamped(system) };
    let request = &Request { which: resolve_usual(request.which, system.n(), &parts), ..*request };
    if system.n() > MAX_ALL && request.which == Which::All {
        let (count, limit) = (system.n(), MAX_ALL);
        return Err(AnalysisError::TooManyCoordinates { count, limit, at: place(system, 0) });
    }
    let (stiffness, masses) = (Terms::of(&system.k), Terms::of(&system.m));
    let mut local = vec![0u32; system.n()];
    let (mut pairs, mut infinite, mut before) = (Vec::new(), 0, Before::default());
    for (index, part) in parts.iter().enumerate() {
        let found = if parts.len() == 1 {
            let whole = Forms { k: &system.k, m: &system.m, stiffness: &stiffness, masses: &masses };
            part_pairs(system, part, &whole, request)?
        } else {
            part.coordinates.iter().enumerate().for_each(|(i, &c)| local[c as usize] = i as u32);
            let (k, m) = (choose_terms(&system.k, &part.k, &local), choose_terms(&system.m, &part.m, &local));
            let own = Forms { k: &k, m: &m, stiffness: &Terms::of(&k), masses: &Terms::of(&m) };
            part_pairs(system, part, &own, request)?
        };
        infinite += found.infinite;
        before = before.plus(found.before);
        pairs.extend(found.pairs.into_iter().map(|pair| (pair, index)));
    }
    if parts.len() > 1 {
        pairs.order_by(|a, b| ascending(&a.0.value, &b.0.value));
    }
    // A cluster that continues beyond the last requested mode is still a cluster.
    let numbers = cluster_numbers(&pairs);
    pairs.truncate(request.which.limit());
    let after = system.n() - infinite - before.count() - pairs.len();
    let report = Report::of(system, stiffness, masses, request.shares);
    let list: Vec<_> = pairs.into_iter().zip(numbers).collect();
    let list = cores::one_by_one(list, PER_CORE / system.n().max(1), |((pair, part), cluster)| {
        let x = pair.x.spread(&parts[part].coordinates, system.n());
        report.mode(Pair { x, ..pair }, cluster)
    });
    Ok(Modes { list, infinite, before, after }.cut(request.which))
}

/// The request with [`Which::Usual`] resolved for this system.
pub(in crate::analysis) fn resolve(system: &LinearSystem, which: Which) -> Which {
    match which {
        Which::Usual => resolve_usual(which, system.n(), &independent_undamped(system)),
        which => which,
    }
}

/// Resolves [`Which::Usual`] by the size of the system.
fn resolve_usual(which: Which, n: usize, parts: &[Part]) -> Which {
    let largest = parts.iter().map(|part| part.coordinates.len()).max().unwrap_or(0);
    match which {
        Which::Usual if n <= MAX_ALL && largest <= MAX_UNASKED => Which::All,
        Which::Usual => Which::Lowest(FEW),
        which => which,
    }
}

/// M and K of a part, as the model's numbers and as terms.
struct Forms<'a> {
    k: &'a Form,
    m: &'a Form,
    stiffness: &'a Terms<'a>,
    masses: &'a Terms<'a>,
}

/// The eigenpairs of a part (at least the requested ones), how many come before them, and how many of its motions have
/// no inertia.
struct PartPairs {
    pairs: Vec<Pair>,
    before: Before,
    infinite: usize,
}

/// The requested eigenpairs of a part, computed from numbers scaled to ordinary size.
fn part_pairs(
    system: &LinearSystem,
    part: &Part,
    forms: &Forms,
    request: &Request,
) -> Result<PartPairs, AnalysisError> {
    let Some(scale) = Scale::of(forms.stiffness, forms.masses) else {
        return ordinary_pairs(system, part, forms, request);
    };
    let out_of_range = || AnalysisError::OutOfRange { at: place(system, part.coordinates[0] as usize) };
    let (k, m) = scale.forms(forms.k, forms.m).ok_or_else(out_of_range)?;
    let scaled = Forms { k: &k, m: &m, stiffness: &Terms::of(&k), masses: &Terms::of(&m) };
    let found = ordinary_pairs(system, part, &scaled, &scale.request(request))?;
    let pairs: Option<Vec<Pair>> = found.pairs.into_iter().map(|pair| scale.unscale(pair)).collect();
    Ok(PartPairs { pairs: pairs.ok_or_else(out_of_range)?, ..found })
}

/// The requested eigenpairs of a part whose numbers are of ordinary size.
fn ordinary_pairs(
    system: &LinearSystem,
    part: &Part,
    forms: &Forms,
    request: &Request,
) -> Result<PartPairs, AnalysisError> {
    let n = part.coordinates.len();
    let in_part = match request.which {
        Which::All => false,
        Which::Within(_) => true,
        which => n > MAX_DENSE || which.limit() < n / 4,
    };
    if n > MIN_SPARSE
        && in_part
        && let Some(Found { pairs, before }) = sparse::requested_pairs(forms.stiffness, forms.masses, n, request)
        // Whether an eigenvalue is exactly zero is decided by the other methods.
        && (n > MAX_DENSE || !pairs.iter().any(|pair| may_be_zero(&pair.value)))
    {
        let pairs = match before.count() {
            0 => counted::sharpen(pairs, forms.k, forms.m, n, request),
            _ => pairs,
        };
        return Ok(PartPairs { pairs, before, infinite: 0 });
    }
    let first = part.coordinates[0] as usize;
    if n > MAX_DENSE {
        let (count, limit, at) = (n, MAX_DENSE, place(system, first));
        return Err(match request.which {
            Which::All => AnalysisError::TooManyCoordinates { count, limit, at },
            _ => AnalysisError::NotSparse { count, limit, at },
        });
    }
    let (pairs, infinite) = match eigenpairs_of(forms.k, forms.stiffness, forms.masses, n, request.tolerance) {
        Ok(pairs) => {
            let pairs = exact::sharpen(pairs, forms.k, forms.m, request.tolerance);
            (counted::sharpen(pairs, forms.k, forms.m, n, request), 0)
        }
        Err(Failure::Range) => return Err(AnalysisError::OutOfRange { at: place(system, first) }),
        Err(Failure::Size) => return Err(too_many(system, first, n)),
        Err(Failure::Mass(at)) => without_massless_motions(system, part, forms.k, forms.m, at, request)?,
    };
    Ok(PartPairs { pairs, before: Before::default(), infinite })
}

/// Error: this part, whose first coordinate is `first`, has too many coordinates for all modes.
pub(in crate::analysis) fn too_many(system: &LinearSystem, first: usize, count: usize) -> AnalysisError {
    AnalysisError::TooManyCoordinates { count, limit: MAX_UNASKED, at: place(system, first) }
}

fn may_be_zero(value: &Eigenvalue) -> bool {
    matches!(value, Eigenvalue::Near { value, radius, positive: false } if value.hi().abs() <= *radius)
}

/// Eliminates the motions without inertia if M is singular: exactly, or not at all. Returns the modes and how many such motions there
/// are.
fn without_massless_motions(
    system: &LinearSystem,
    part: &Part,
    k: &Form,
    m: &Form,
    at: usize,
    request: &Request,
) -> Result<(Vec<Pair>, usize), AnalysisError> {
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
    let condensed = condense(m, k, n, &space.vectors).map_err(|stuck| match stuck {
        Stuck::Undetermined(at) => singular(vec![global(at)]),
        Stuck::TooManyTerms(at) => AnalysisError::massless_net(system, global(at), condense::MOST_SQUARES),
    })?;
    for motion in condensed.loose_motions(n) {
        let moving: Vec<usize> = (0..n).filter(|&i| !motion[i].is_zero()).map(global).collect();
        if !is_damped(system, part, &motion) {
            return Err(singular(moving));
        }
    }
    let rest = condensed.kept.len();
    let pairs = eigenpairs(&condensed.k, &condensed.m, rest, request.tolerance);
    let pairs = pairs.map_err(|failure| match failure {
        Failure::Mass(at) => AnalysisError::indefinite_mass(system, CoordinateId(global(condensed.kept[at]) as u32)),
        Failure::Range => AnalysisError::OutOfRange { at: place(system, global(0)) },
        Failure::Size => too_many(system, global(0), n),
    })?;
    let pairs = counted::sharpen(pairs, &condensed.k, &condensed.m, rest, request);
    Ok((pairs.into_iter().map(|pair| expand(pair, &condensed, n)).collect(), n - rest))
}

fn expand(pair: Pair, condensed: &Condensed, n: usize) -> Pair {
    Pair { x: Displacements::Precise(condensed.expand(n, &pair.x.to_triple())), ..pair }
}

/// Whether some damper may act on this motion of the part.
fn is_damped(system: &LinearSystem, part: &Part, motion: &[Number]) -> bool {
    system.c.terms().any(|term| {
        let stretch =
            system.c.row(term).iter().fold(Number::ZERO, |sum, (i, a)| match part.coordinates.binary_search(&i.0) {
                Ok(local) => &sum + &(a * &motion[local]),
                Err(_) => sum,
            });
        !stretch.is_zero()
    })
}

/// Numbers the clusters of modes whose enclosures overlap.
fn cluster_numbers(pairs: &[(Pair, usize)]) -> Vec<Option<u32>> {
    let mut numbers = vec![None; pairs.len()];
    let mut next = 0;
    for i in 1..pairs.len() {
        if !overlap(&pairs[i - 1].0.value, &pairs[i].0.value) {
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

/// Inputs shared by the reports of all modes: M and K, and which coordinates are translations.
struct Report<'a> {
    system: &'a LinearSystem,
    stiffness: Terms<'a>,
    /// M and K in binary64.
    light: [Roots; 2],
    /// For each coordinate, whether it is a displacement.
    translates: Vec<bool>,
    /// Whether shares of energies are asked for.
    shares: bool,
}

impl<'a> Report<'a> {
    fn of(system: &'a LinearSystem, stiffness: Terms<'a>, masses: Terms<'a>, shares: bool) -> Report<'a> {
        let light = [Roots::of(&system.m, &masses), Roots::of(&system.k, &stiffness)];
        let translates = (0..system.n()).map(shape::translates(system)).collect();
        Report { system, stiffness, light, translates, shares }
    }

    fn mode(&self, pair: Pair, cluster: Option<u32>) -> Mode {
        let Pair { value, x, route } = pair;
        let energies = match value {
            Eigenvalue::Zero => (0.0, Vec::new()),
            Eigenvalue::Near { .. } => self.light[1].energies(self.system.k.source_count(), &self.stiffness, &x),
        };
        let mut precise = if self.system.n() <= PRECISE { x.precise() } else { None };
        let mut shape = x.into_f64();
        let (whole, by_body) = self.light[0].energies_in_binary64(self.system.m.source_count(), &shape);
        let carried = self.light[0].carried_by_translations(&shape, &self.translates) / whole;
        let leading = shape::lead(&mut shape, carried, |i| self.translates[i]);
        if let (Some(leading), Some(precise)) = (leading, &mut precise)
            && precise[leading.index()].hi < 0.0
        {
            precise.iter_mut().for_each(|x| *x = -*x);
        }
        let kinetic = self.shares_of(&self.system.m, &by_body);
        let rigid = Mode {
            kind: ModeKind::Rigid,
            omega_squared: Ball::ZERO,
            omega: Ball::ZERO,
            cluster,
            shape,
            precise,
            input_condition: None,
            leading,
            kinetic,
            strain: Vec::new(),
            route,
        };
        match value {
            Eigenvalue::Zero => rigid,
            Eigenvalue::Near { value, radius, positive } => self.elastic(rigid, energies, value, radius, positive),
        }
    }

    /// The shares of the sources of a form in its energy, if they are asked for.
    fn shares_of(&self, form: &Form, by_source: &[f64]) -> Vec<Share<Source>> {
        if self.shares { shape::shares(form, by_source) } else { Vec::new() }
    }

    /// `energies`: the sum of the magnitudes of all terms' energies, and the energy of each source.
    fn elastic(&self, mode: Mode, energies: (f64, Vec<f64>), lambda: Triple, radius: f64, positive: bool) -> Mode {
        let omega_squared = certificate::ball(lambda, radius);
        let certain = if positive { lambda.hi() > 0.0 } else { !omega_squared.contains_zero() };
        let (kind, omega) = match lambda.hi() < 0.0 {
            _ if !certain => (ModeKind::Undetermined, certificate::unknown_root(omega_squared)),
            true => (ModeKind::Divergence, certificate::root(-lambda, radius)),
            false => (ModeKind::Oscillation, certificate::root(lambda, radius)),
        };
        let (whole, by_source) = energies;
        Mode {
            kind,
            omega_squared,
            omega,
            input_condition: certain.then(|| Unproven(whole / lambda.hi().abs() + 1.0)),
            strain: self.shares_of(&self.system.k, &by_source),
            ..mode
        }
    }
}
