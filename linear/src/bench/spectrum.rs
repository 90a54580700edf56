//! Methods for the frequencies and the poles.

use super::ordinary::{Matrices, singular_values};
use super::{Call, Clock, Entry, MOST_DENSE, Question, Reference, time_best};
use crate::analysis::{self, Mode, ModeKind, Modes, Request, Which};
use crate::base::{Ball, Dd};
use crate::system::LinearSystem;

/// Number of modes that are requested alone.
const FEW: usize = 4;
/// For fewer coordinates, requesting only some modes saves nothing.
const LARGE: usize = 16;

/// omega, negative for a divergence.
fn signed_frequency(mode: &Mode) -> Ball {
    if mode.kind == ModeKind::Divergence { -mode.omega } else { mode.omega }
}

/// The least nonzero frequency, relative to which a spurious one is measured.
fn least(reference: &Modes) -> f64 {
    let sizes = reference.list.iter().map(|mode| mode.omega.to_f64()).filter(|omega| *omega > 0.0);
    let least = sizes.fold(f64::INFINITY, f64::min);
    if least.is_finite() { least } else { 1.0 }
}

pub fn frequencies(system: &LinearSystem, reference: &Reference, clock: &mut Clock) -> Vec<Entry> {
    let question = Question::Frequencies;
    let truth: Vec<Ball> = reference.modes.list.iter().map(signed_frequency).collect();
    let floor = least(&reference.modes);
    let mut entries = Vec::new();
    let mut ours = |method: &str, request: &Request, chosen: bool| {
        let (modes, seconds) = time_best(clock, || analysis::modes_as(system, request));
        let Ok(modes) = modes else { return };
        let error = modes
            .list
            .iter()
            .zip(&truth)
            .map(|(mode, &truth)| relative_error(signed_frequency(mode).to_f64(), truth, floor));
        let bound = modes.list.iter().map(|mode| printed_bound(mode.omega)).fold(0.0, f64::max);
        let entry = Entry::of_vibc(question, method, seconds, error.fold(0.0, f64::max), bound);
        entries.push(if chosen { entry.choose() } else { entry });
    };
    ours("vibc", &Request::default(), true);
    ours("vibc --digits 28", &Request::default().to_digits(28), false);
    if system.n() >= LARGE {
        let few = Request { which: Which::Lowest(FEW), ..Request::default() };
        ours("vibc --modes 4, only the lowest", &few, false);
    }
    if system.n() > MOST_DENSE {
        return entries;
    }
    let matrices = Matrices::of(system);
    let worst = |squares: Option<Vec<f64>>| {
        let squares = squares.filter(|list| list.len() >= truth.len())?;
        // Motions without inertia have the largest values.
        let signed = squares.iter().map(|square| square.abs().sqrt().copysign(*square));
        Some(signed.zip(&truth).map(|(omega, &truth)| relative_error(omega, truth, floor)).fold(0.0, f64::max))
    };
    let methods: [(&str, Call<Vec<f64>>); 3] = [
        ("symmetric eigenvalues of assembled M, K", &|| matrices.symmetric()),
        ("eigenvalues of M⁻¹K", &|| matrices.unsymmetric()),
        ("singular values of the factored K", &|| singular_values(system, &matrices)),
    ];
    for (method, call) in methods {
        let (squares, seconds) = time_best(clock, call);
        entries.push(Entry::ordinary(question, method, seconds, worst(squares)));
    }
    entries
}

/// |value - truth| over |truth|, or over the least frequency if that is zero.
fn relative_error(value: f64, truth: Ball, floor: f64) -> f64 {
    let difference = (Dd::from(value) - truth.mid).abs().to_f64();
    difference / if truth.is_zero() { floor } else { truth.to_f64().abs() }
}

/// The bound of the binary64 number.
fn printed_bound(value: Ball) -> f64 {
    if value.is_zero() {
        return 0.0;
    }
    let lost = (value.mid - Dd::from(value.to_f64())).abs().to_f64();
    (value.rad + lost) / (value.to_f64().abs() - value.rad).max(0.0)
}

/// Ratio of bound to true error of our default frequencies, if the reference is accurate enough.
pub fn bound_quality(system: &LinearSystem, reference: &Reference) -> Option<(f64, f64)> {
    let modes = analysis::modes(system).ok()?;
    let ratio = |(mode, truth): (&Mode, &Mode)| {
        let error = (mode.omega.mid - truth.omega.mid).abs().to_f64();
        // An error below the reference's own bound is unknown.
        (error > 2.0 * truth.omega.rad).then(|| mode.omega.rad / error)
    };
    let mut ratios: Vec<f64> = modes.list.iter().zip(&reference.modes.list).filter_map(ratio).collect();
    ratios.sort_by(f64::total_cmp);
    Some((*ratios.get(ratios.len() / 2)?, *ratios.last()?))
}

/// The largest relative change of a frequency from one system to another.
pub fn distance(reference: &Reference, other: &LinearSystem) -> Option<f64> {
    let other = analysis::modes(other).ok()?;
    let floor = least(&reference.modes);
    let change = |(a, b): (&Mode, &Mode)| {
        let difference = (a.omega.mid - b.omega.mid).abs().to_f64();
        difference / if a.omega.is_zero() { floor } else { a.omega.to_f64() }
    };
    Some(reference.modes.list.iter().zip(&other.list).map(change).fold(0.0, f64::max))
}

pub fn poles(system: &LinearSystem, reference: &Reference, clock: &mut Clock) -> Vec<Entry> {
    let question = Question::Poles;
    let truth: Vec<(Dd, Dd)> = reference.poles.list.iter().map(|pole| (pole.re.mid, pole.im.mid)).collect();
    let size = |&(re, im): &(Dd, Dd)| libm::hypot(re.to_f64(), im.to_f64());
    let floor = truth.iter().map(size).filter(|size| *size > 0.0).fold(f64::INFINITY, f64::min);
    let floor = if floor.is_finite() { floor } else { 1.0 };
    let relative = |(re, im): (f64, f64), truth: &(Dd, Dd)| {
        let (re, im) = ((Dd::from(re) - truth.0).to_f64(), (Dd::from(im) - truth.1).to_f64());
        libm::hypot(re, im) / size(truth).max(if size(truth) == 0.0 { floor } else { 0.0 })
    };
    let (poles, seconds) = time_best(clock, || {
        let modes = analysis::modes(system).ok()?;
        analysis::poles(system, &modes).ok()
    });
    let mut entries = Vec::new();
    if let Some(poles) = poles {
        let values = poles.list.iter().map(|pole| (pole.re.to_f64(), pole.im.to_f64()));
        let error = values.zip(&truth).map(|(value, truth)| relative(value, truth)).fold(0.0, f64::max);
        let bound = poles
            .list
            .iter()
            .zip(&truth)
            .map(|(pole, truth)| pole.relative_error + relative((pole.re.to_f64(), pole.im.to_f64()), truth));
        entries.push(Entry::of_vibc(question, "vibc", seconds, error, bound.fold(0.0, f64::max)).choose());
    }
    if system.n() > MOST_DENSE {
        return entries;
    }
    let matrices = Matrices::of(system);
    let (values, seconds) = time_best(clock, || matrices.companion());
    let nearest = |values: &Vec<nalgebra::Complex<f64>>, truth: &(Dd, Dd)| {
        values.iter().map(|z| relative((z.re, z.im), truth)).fold(f64::INFINITY, f64::min)
    };
    let error = values.map(|values| truth.iter().map(|truth| nearest(&values, truth)).fold(0.0, f64::max));
    entries.push(Entry::ordinary(question, "eigenvalues of the companion matrix", seconds, error));
    entries
}
