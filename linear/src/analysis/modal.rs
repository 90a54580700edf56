//! The requested modes, their poles, and the stability of the rest. In: a linear system and a request. Out: all three.
//!
//! If all modes are cheap, or if damping that couples the modes needs them all, everything is computed and the
//! requested part is returned. Otherwise only the requested modes are computed, and the poles are those of these modes,
//! or are followed from them one by one. See docs/method/modes.md#some-of-the-modes and
//! docs/method/poles.md#some-of-the-poles.

use crate::analysis::answer::{Before, Mode, ModeKind, Modes, Pole, Poles};
use crate::analysis::error::AnalysisError;
use crate::analysis::modes::linkage::{self, Linkage};
use crate::analysis::modes::parts::{Part, independent, independent_chained};
use crate::analysis::modes::request::{Band, Request, Which};
use crate::analysis::modes::{MAX_ALL, MAX_UNASKED, MIN_SPARSE, modes_as, resolve};
use crate::analysis::poles::{MAX_DAMPED, are_of_modes, poles, poles_by_ratio, poles_followed, poles_of};
use crate::analysis::stability::{Verdict, stability, stability_by_ratio};
use crate::base::{Ball, Number};
use crate::system::LinearSystem;

/// Modes and poles with the verdict on the rest.
#[derive(Clone, Debug)]
pub struct Modal {
    pub modes: Modes,
    pub poles: Poles,
    pub stability: Verdict,
}

/// Whether the request can be answered with the chained rows of M (docs/method/system.md#deep-trees): for some of the
/// modes, and at most their poles.
pub fn takes_chained(system: &LinearSystem, request: &Request) -> bool {
    let few = match request.which {
        Which::All => false,
        Which::Usual => system.n() > MAX_UNASKED,
        Which::Lowest(count) => count < system.n() / 4,
        Which::Within(_) => true,
    };
    few && !needs_all(system, &whole(system))
}

/// The requested modes, their poles and the verdict.
pub fn modal(system: &LinearSystem, request: &Request) -> Result<Modal, AnalysisError> {
    modal_from(system, None, request)
}

/// Like [`modal`], if [`crate::analysis::modes`] of the system, or of one with the same M and K, may be known already.
pub fn modal_from(system: &LinearSystem, known: Option<&Modes>, request: &Request) -> Result<Modal, AnalysisError> {
    if system.is_chained() {
        return of_chained(system, request);
    }
    if system.losses.is_some() {
        let modes = modes_as(system, request)?;
        let poles = poles(system, &modes)?;
        let stability = stability(system, &modes, &poles);
        return Ok(Modal { modes, poles, stability });
    }
    let whole = whole(system);
    if !needs_all(system, &whole)
        && let Some((modes, poles)) = requested_modal(system, &whole, request)?
    {
        let stability = stability(system, &modes, &poles);
        return Ok(Modal { modes, poles, stability });
    }
    let modes = all_modes(system, known, request)?;
    let poles = poles(system, &modes)?;
    let stability = stability(system, &modes, &poles);
    Ok(Modal { modes, poles, stability }.cut(request.which))
}

/// All modes to the requested accuracy: the known ones if they are accurate enough.
fn all_modes(system: &LinearSystem, known: Option<&Modes>, request: &Request) -> Result<Modes, AnalysisError> {
    let all = Request { which: Which::All, ..*request };
    let plain = Request { asked: None, ..all } == Request::default();
    match known.filter(|_| plain) {
        Some(modes) => Ok(modes.clone()),
        None => modes_as(system, &all),
    }
}

impl Modal {
    /// Keeps what was requested, and counts the rest.
    fn cut(self, which: Which) -> Modal {
        Modal { modes: self.modes.cut(which), poles: self.poles.cut(which), ..self }
    }
}

/// Analyses a linkage in other coordinates, in which the poles are the same.
fn of_chained(system: &LinearSystem, request: &Request) -> Result<Modal, AnalysisError> {
    let Some(linkage) = Linkage::of(system) else { return modal(&linkage::write_out_rows(system)?, request) };
    let found = modal(&linkage.system, request)?;
    Ok(Modal { modes: linkage.in_angles(system, found.modes), ..found })
}

/// The requested modes and their poles; `None` if these are all modes and all poles can be computed.
fn requested_modal(
    system: &LinearSystem,
    whole: &Part,
    request: &Request,
) -> Result<Option<(Modes, Poles)>, AnalysisError> {
    let asked = |which| modes_as(system, &Request { which, ..*request });
    if are_of_modes(system, whole) {
        let modes = asked(request.which)?;
        let poles = poles_of(system, whole, &modes);
        let reported = !modes.is_complete() || largest(system) > MAX_UNASKED;
        return Ok(reported.then_some((modes, poles)));
    }
    let which = resolve(system, request.which);
    // Modes beyond the requested ones serve to prove poles.
    let (modes, further) = match which {
        Which::Lowest(count) => match asked(Which::Lowest(count + FURTHER)) {
            Ok(further) => (further.clone().cut(which), further),
            Err(_) => (asked(which)?, Modes::default()),
        },
        which => {
            let modes = asked(which)?;
            let lowest = modes.before.count() == 0 && !modes.list.is_empty() && modes.after > 0;
            let further = if lowest { asked(Which::Lowest(modes.list.len() + FURTHER)).ok() } else { None };
            (modes, further.unwrap_or_default())
        }
    };
    if modes.is_complete() && largest(system) <= MAX_DAMPED {
        return Ok(None);
    }
    if modes.list.len() > MAX_UNASKED {
        let poles = poles_of(system, whole, &modes);
        return Ok(Some((modes, poles)));
    }
    let poles = poles_followed(system, whole, &further, modes.list.len(), request.tolerance);
    Ok(Some((modes.clone(), poles.unwrap_or_else(|| poles_of(system, whole, &modes)))))
}

/// Number of modes that are computed beyond the requested ones, so that there is a gap somewhere among them.
const FURTHER: usize = 5;

/// Like [`modal`], with a uniform damping ratio added to each oscillation, in closed form. `None` if the dampers couple
/// the modes, so that the ratio has to be spread over all coordinates first ([`crate::analysis::damping::modal`]).
pub fn modal_by_ratio(
    system: &LinearSystem,
    ratio: &Number,
    known: Option<&Modes>,
    request: &Request,
) -> Result<Option<Modal>, AnalysisError> {
    let whole = whole(system);
    if system.losses.is_some() || !are_of_modes(system, &whole) {
        return Ok(None);
    }
    // An overdamped mode may have the slowest pole of all.
    let all = system.n() <= MAX_ALL && largest(system) <= MAX_UNASKED;
    let modes = if all { all_modes(system, known, request)? } else { modes_as(system, request)? };
    let poles = poles_by_ratio(system, &whole, &modes, ratio);
    Ok(poles.map(|poles| {
        let stability = stability_by_ratio(system, &modes, &poles, ratio);
        let found = Modal { modes, poles, stability };
        if all { found.cut(request.which) } else { found }
    }))
}

/// Whether all modes are cheap, or the poles need all of them.
fn needs_all(system: &LinearSystem, whole: &Part) -> bool {
    let n = system.n();
    if n <= MIN_SPARSE {
        return true;
    }
    n <= MAX_ALL && !are_of_modes(system, whole) && largest(system) <= MAX_UNASKED
}

/// Number of coordinates of the largest independent part.
fn largest(system: &LinearSystem) -> usize {
    let parts = if system.is_chained() { independent_chained(system) } else { independent(system) };
    parts.iter().map(|part| part.coordinates.len()).max().unwrap_or(0)
}

/// The system as one part.
fn whole(system: &LinearSystem) -> Part {
    let all = |count: usize| (0..count as u32).collect();
    Part {
        coordinates: all(system.n()),
        m: all(system.m.terms().len()),
        c: all(system.c.terms().len()),
        k: all(system.k.terms().len()),
    }
}

impl Modes {
    /// Keeps the requested modes, and counts the others.
    pub(in crate::analysis) fn cut(mut self, which: Which) -> Modes {
        if let Which::Within(band) = which {
            let (low, high) = self.range(band);
            for mode in &self.list[..low] {
                *self.before.of(mode.kind) += 1;
            }
            self.after += self.list.len() - high;
            self.list.truncate(high);
            self.list.drain(..low);
        } else if let Which::Lowest(count) = which {
            self.after += self.list.len().saturating_sub(count);
            self.list.truncate(count);
        }
        self
    }

    /// The range of the modes that may lie in the band.
    fn range(&self, band: Band) -> (usize, usize) {
        let square = |mode: &Mode| (mode.omega_squared.mid.hi, mode.omega_squared.rad);
        let inside = |mode: &Mode| band.may_hold(square(mode).0, square(mode).1);
        let low = self.list.iter().position(|mode| inside(mode) || square(mode).0 > band.to * band.to);
        let low = low.unwrap_or(self.list.len());
        (low, self.list.iter().rposition(inside).map_or(low, |last| last + 1))
    }
}

impl Poles {
    /// Keeps as many pairs of least |s| as modes were requested; or those with |s| in the band.
    fn cut(mut self, which: Which) -> Poles {
        let all = self.list.len();
        match which {
            Which::All | Which::Usual => {}
            Which::Lowest(count) => {
                let mut end = (2 * count).min(all);
                let conjugate = |a: &Pole, b: &Pole| a.re.mid == b.re.mid && a.im.mid == -b.im.mid;
                if end > 0 && end < all && conjugate(&self.list[end - 1], &self.list[end]) {
                    end += 1;
                }
                self.list.truncate(end);
            }
            Which::Within(band) => self.list.retain(|pole| {
                let square: Ball = pole.re.square() + pole.im.square();
                band.may_hold(square.mid.hi, square.rad)
            }),
        }
        self.left_out += all - self.list.len();
        self
    }
}

impl Before {
    /// Whether any mode below is of this kind.
    pub(in crate::analysis) fn contains_kind(mut self, kind: ModeKind) -> bool {
        *self.of(kind) > 0
    }

    fn of(&mut self, kind: ModeKind) -> &mut usize {
        match kind {
            ModeKind::Divergence => &mut self.divergences,
            ModeKind::Undetermined => &mut self.undetermined,
            ModeKind::Rigid => &mut self.rigid,
            ModeKind::Oscillation => &mut self.oscillations,
        }
    }
}
