//! Largest motions under response spectra: the modes' largest contributions to each output, combined by SRSS and CQC
//! for each direction. In: a system with its modes, the spectra of its bases. Out: for each base and output enclosures,
//! or the reason why there are none. See docs/method/response_spectra.md.

use super::answer::Modes;
use super::excitation::{Excitation, Excitations};
use super::transfer::modal::ModalSum;
use crate::base::{Ball, Number, ResponseSpectrum};
use crate::system::{CoordinateId, LinearSystem, Origin, Output};

/// Contributions that are added on request.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Additions {
    /// The motion of the modes above the highest point, which follow the base without an oscillation of their own.
    pub missing_mass: bool,
    /// The square root of the sum of squares over all directions.
    pub across: bool,
    /// The correction of a spectrum for modes with another damping ratio.
    pub other_damping: bool,
}

/// The maxima under the spectrum of one base.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Direction {
    /// Index of the input.
    pub input: usize,
    pub damping: Number,
    /// The highest frequency of the spectrum, Hz, and the pseudo-acceleration from there on.
    pub rigid_from: Number,
    pub rigid: Ball,
    /// Effective mass of all modes and of those above the highest point: kg, or kg m^2 for a base that turns.
    pub total: Ball,
    pub missing: Ball,
    /// The modes whose damping ratio is not that of the spectrum.
    pub corrected: Vec<Corrected>,
    pub outputs: Vec<(usize, Result<Maximum, &'static str>)>,
}

/// A mode for whose damping the spectrum is corrected.
#[derive(Clone, Copy, Debug)]
pub struct Corrected {
    /// The number of the mode, from 1.
    pub mode: usize,
    pub damping: Ball,
    /// The factor of its value in the spectrum.
    pub factor: Ball,
}

/// The largest magnitude of an output, as combined.
#[derive(Clone, Copy, Debug)]
pub struct Maximum {
    pub of: Measured,
    pub srss: Ball,
    pub cqc: Ball,
    /// The part of the modes above the highest point, in phase with each other.
    pub missing: Ball,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measured {
    /// A motion relative to the base.
    Relative,
    /// An absolute acceleration.
    Absolute,
}

impl Measured {
    pub fn name(self) -> &'static str {
        match self {
            Measured::Relative => "relative",
            Measured::Absolute => "absolute",
        }
    }
}

/// Why a direction has no maxima, or the maxima of all its outputs.
pub type Found = (usize, Result<Direction, String>);

/// The maxima of all directions, with the input of each.
#[derive(Clone, Debug, Default)]
pub struct Spectral {
    pub directions: Vec<Found>,
    /// The maxima over all directions for each output, by SRSS and CQC, if requested and if each direction has a value.
    pub across: Vec<(usize, [Ball; 2])>,
    pub added: Additions,
}

/// Relative error of a damping ratio beside that of a spectrum that still counts as the same.
const SAME: f64 = 1e-9;

/// The maxima of all outputs under each spectrum.
pub fn maxima(
    system: &LinearSystem,
    modes: &Modes,
    spectra: &[(usize, ResponseSpectrum)],
    added: Additions,
) -> Spectral {
    if spectra.is_empty() {
        return Spectral::default();
    }
    let excitations = Excitations::of(system, modes);
    let sum = ModalSum::of(system, modes);
    let direction = |(input, spectrum): &(usize, ResponseSpectrum)| -> Result<Direction, String> {
        let excitations = excitations.as_ref().map_err(|why| why.to_string())?;
        let sum = sum.as_ref().ok_or("the dampers couple the modes, so that no mode is an oscillator of its own")?;
        let inputs: Vec<usize> = spectra.iter().map(|(input, _)| *input).collect();
        in_direction(system, excitations, sum, (*input, spectrum), &inputs, added)
    };
    let directions: Vec<Found> = spectra.iter().map(|spectrum| (spectrum.0, direction(spectrum))).collect();
    let across = if added.across { over_directions(&directions, system.outputs.len()) } else { Vec::new() };
    Spectral { directions, across, added }
}

fn in_direction(
    system: &LinearSystem,
    excitations: &Excitations,
    sum: &ModalSum,
    (input, spectrum): (usize, &ResponseSpectrum),
    inputs: &[usize],
    added: Additions,
) -> Result<Direction, String> {
    let excitation = excitations.by(input)?;
    if !is_damped_relative_to_the_base(system, input, &excitation) {
        return Err("dampers hold against what does not move with this base, so that its velocity acts as well".into());
    }
    let modes: Vec<Mode> =
        (0..system.n()).map(|i| mode(excitations, sum, spectrum, &excitation, added, i)).collect::<Result<_, _>>()?;
    let corrected = (1..)
        .zip(&modes)
        .filter_map(|(number, mode)| Some(Corrected { mode: number, damping: mode.damping, factor: mode.correction? }));
    let (Some((_, rigid_from)), Some(rigid)) = (spectrum.ends(), spectrum.rigid()) else {
        return Err("its table was not read".into());
    };
    let masses = excitation.modes.iter().zip(&modes).filter(|(_, mode)| mode.is_rigid);
    let mut masses = masses.map(|(excited, _)| excited.mass);
    let missing = masses.try_fold(Ball::ZERO, |sum, mass| Some(sum + mass?)).ok_or(NO_SHAPE)?;
    let outputs = (0..system.outputs.len()).map(|output| {
        let of = &system.outputs[output];
        let found = measured_quantity(of, &excitation, inputs);
        let (of, row) = match found {
            Ok(found) => found,
            Err(why) => return (output, Err(why)),
        };
        let factors = excitations.along(row);
        let contributions: Option<Vec<Ball>> = (modes.iter().zip(&excitation.modes).zip(factors))
            .map(|((mode, excited), factor)| {
                let size = factor? * excited.participation? * mode.acceleration;
                Some(if of == Measured::Relative { size / mode.omega.square() } else { size })
            })
            .collect();
        let found = contributions.ok_or(NO_SHAPE).and_then(|parts| combine(of, &modes, &parts, added));
        (output, found)
    });
    Ok(Direction {
        input,
        damping: spectrum.damping.clone(),
        rigid_from: rigid_from.clone(),
        rigid,
        total: excitation.total,
        missing,
        corrected: corrected.collect(),
        outputs: outputs.collect(),
    })
}

const NO_SHAPE: &str = "modes of the same frequency have no shapes of their own";

/// An oscillator of the system.
struct Mode {
    omega: Ball,
    damping: Ball,
    /// Its largest pseudo-acceleration.
    acceleration: Ball,
    /// The factor of the spectrum's value in it, if the mode has another damping.
    correction: Option<Ball>,
    /// Whether its frequency lies above the highest point.
    is_rigid: bool,
}

fn mode(
    excitations: &Excitations,
    sum: &ModalSum,
    spectrum: &ResponseSpectrum,
    excitation: &Excitation,
    added: Additions,
    i: usize,
) -> Result<Mode, String> {
    let omega = excitations.omega(i);
    let hertz = omega / (Ball::PI * Ball::from(2.0));
    // The off-diagonal part of the damping is below epsilon of the diagonal one.
    let rate = Ball::exact(sum.c[i]).widen(sum.epsilon * sum.c_size[i] * 4.0);
    let damping = rate / (omega * Ball::from(2.0));
    // However little, if it is certain: stiff springs show what hardly moves.
    let excited = &excitation.modes[i];
    let is_excited = excited.participation.is_none_or(|factor| !factor.contains_zero())
        || excited.mass.is_none_or(|mass| mass.magnitude() > 1e-20 * excitation.total.magnitude());
    let own = spectrum.damping.to_ball();
    let is_rigid = spectrum.ends().is_some_and(|(_, last)| (hertz - last.to_ball()).is_positive());
    // If an oscillator follows its base, its maximum is the same with any damping; if it is not excited, its maximum is zero.
    let is_other = !is_rigid && (damping - own).magnitude() > SAME * own.magnitude();
    let correction = (is_other && added.other_damping).then(|| reduction(damping) / reduction(own));
    if is_other && is_excited && correction.is_none() {
        let percent = |ratio: Ball| format!("{:.3} %", ratio.to_f64() * 100.0);
        return Err(format!(
            "mode {} has a damping ratio of {}, and the spectrum is for {}: give the spectrum of that damping, or all modes this one, or \
             have it corrected by --other-damping",
            i + 1,
            percent(damping),
            percent(own)
        ));
    }
    let Some(acceleration) = spectrum.at(hertz) else {
        if !is_excited {
            return Ok(Mode { omega, damping, acceleration: Ball::ZERO, correction, is_rigid });
        }
        return Err(format!("mode {} lies below the lowest frequency of the spectrum", i + 1));
    };
    let acceleration = correction.map_or(acceleration, |factor| acceleration * factor);
    Ok(Mode { omega, damping, acceleration, correction, is_rigid })
}

/// The factor of a spectrum for 5 % that makes it one for another damping ratio: eta of EN 1998-1:2004, 3.2.2.2 (3).
fn reduction(damping: Ball) -> Ball {
    let [tenth, half, least] = ["0.1", "0.05", "0.55"].map(|text| Number::from(text).to_ball());
    let eta = (tenth / (half + damping)).sqrt();
    let above = eta - least;
    if above.is_positive() {
        eta
    } else if above.is_negative() {
        least
    } else {
        least.widen(above.magnitude())
    }
}

/// Whether the dampers move with the base: C r = b_1 for the static response r to the base. Damping that is declared
/// for the whole scene counts as relative to the base.
fn is_damped_relative_to_the_base(system: &LinearSystem, input: usize, excitation: &Excitation) -> bool {
    let balance = |all: bool| {
        let mut force = vec![Ball::ZERO; system.n()];
        let mut size = 0.0f64;
        system.inputs[input].b[1].iter().for_each(|(i, b)| force[i.index()] = force[i.index()] - b.to_ball());
        for term in system.c.terms() {
            if !all && system.c.source_of(term.source).origin == Origin::Damping {
                continue;
            }
            let row = system.c.row(term);
            let rate = row.iter().fold(Ball::ZERO, |sum, (i, a)| sum + a.to_ball() * excitation.carried[i.index()]);
            for (i, a) in row {
                let part = term.weight.to_ball() * a.to_ball() * rate;
                size = size.max((term.weight.to_ball() * a.to_ball()).magnitude());
                force[i.index()] = force[i.index()] + part;
            }
        }
        force.iter().all(|force| force.magnitude() <= 1e-12 * size)
    };
    balance(true) || balance(false)
}

type Row = [(CoordinateId, Number)];

/// The quantity that a spectrum gives for an output, and the output's row over the coordinates.
fn measured_quantity<'a>(
    output: &'a Output,
    excitation: &Excitation,
    inputs: &[usize],
) -> Result<(Measured, &'a Row), &'static str> {
    let feeds = |order: usize| -> Ball {
        let own = output.d[order].iter().filter(|(input, _)| *input as usize == excitation.input);
        own.fold(Ball::ZERO, |sum, (_, value)| sum + value.to_ball())
    };
    let others = |order: usize| output.d[order].iter().any(|(input, _)| inputs.contains(&(*input as usize)));
    if !output.p[1].is_empty() || others(1) {
        return Err("a velocity, which a response spectrum does not have");
    }
    match (output.p[0].is_empty() && !others(0), output.p[2].is_empty() && !others(2)) {
        (false, true) => {
            let row = &output.p[0];
            let along = |(i, p): &(CoordinateId, Number)| p.to_ball() * excitation.carried[i.index()];
            let follows = row.iter().fold(feeds(0), |sum, entry| sum + along(entry));
            let size = row.iter().map(|entry| along(entry).magnitude()).fold(0.0, f64::max);
            if follows.magnitude() > 1e-12 * size.max(feeds(0).magnitude()) {
                return Err(
                    "an absolute displacement, which a response spectrum does not have: subtract that of the base",
                );
            }
            Ok((Measured::Relative, row))
        }
        (true, false) if !others(2) => Ok((Measured::Absolute, &output.p[2])),
        (true, false) => Err("an acceleration relative to the base, which a response spectrum does not have"),
        (false, false) => Err("a displacement and an acceleration at once, whose maxima are not simultaneous"),
        (true, true) => Err("nothing of the scene's coordinates"),
    }
}

fn combine(of: Measured, modes: &[Mode], parts: &[Ball], added: Additions) -> Result<Maximum, &'static str> {
    let swing: Vec<usize> = (0..modes.len()).filter(|i| !modes[*i].is_rigid && !parts[*i].is_zero()).collect();
    let missing = (0..modes.len()).filter(|i| modes[*i].is_rigid).fold(Ball::ZERO, |sum, i| sum + parts[i]);
    let sum = |list: &[usize]| list.iter().fold(Ball::ZERO, |sum, i| sum + parts[*i]);
    let squares = as_one(modes, &swing).iter().fold(Ball::ZERO, |squares, list| squares + sum(list).square());
    let mut crossed = swing.iter().fold(Ball::ZERO, |squares, i| squares + parts[*i].square());
    for (place, &i) in swing.iter().enumerate() {
        for &j in &swing[..place] {
            let both = parts[i] * parts[j] * Ball::from(2.0);
            crossed = crossed + both * correlation(&modes[i], &modes[j]).ok_or(NO_SHAPE)?;
        }
    }
    let whole = |square: Ball| if added.missing_mass { square + missing.square() } else { square };
    // A sum of squares, for the correlations are a positive semidefinite matrix.
    let root =
        |square: Ball| if square.mid.hi < 0.0 { Ball::ZERO.widen(square.magnitude().sqrt()) } else { square.sqrt() };
    Ok(Maximum { of, srss: root(whole(squares)), cqc: root(whole(crossed)), missing: missing.abs() })
}

/// Lists of modes whose frequencies and damping ratios are not apart. They swing in phase, as one oscillator does, so that the
/// sum of their contributions, unlike the sum of their squares, is the same for all vectors that span them.
fn as_one(modes: &[Mode], of: &[usize]) -> Vec<Vec<usize>> {
    let is_alike = |a: &Mode, b: &Mode| {
        let apart = a.damping - b.damping;
        (a.omega - b.omega).contains_zero()
            && (apart.contains_zero() || apart.magnitude() <= SAME * b.damping.magnitude())
    };
    let mut lists: Vec<Vec<usize>> = Vec::new();
    for &i in of {
        let (alike, mut others): (Vec<_>, Vec<_>) =
            lists.into_iter().partition(|list| list.iter().any(|&j| is_alike(&modes[i], &modes[j])));
        others.push(alike.concat().into_iter().chain([i]).collect());
        lists = others;
    }
    lists
}

/// The correlation of two oscillators under white noise (A. Der Kiureghian, Earthquake Engineering and Structural
/// Dynamics 9 (1981) 419-435). `None` if two undamped ones have frequencies that are not certainly different.
fn correlation(a: &Mode, b: &Mode) -> Option<Ball> {
    let r = b.omega / a.omega;
    let (x, y) = (a.damping, b.damping);
    let [four, eight] = [4.0, 8.0].map(Ball::from);
    let product = x * y;
    if product.is_zero() || !product.is_positive() {
        return (!(r - Ball::ONE).contains_zero()).then_some(Ball::ZERO);
    }
    let top = eight * product.sqrt() * (x + r * y) * r * r.sqrt();
    let square = r.square();
    let apart = Ball::ONE - square;
    let below = apart.square() + four * product * r * (Ball::ONE + square) + four * (x.square() + y.square()) * square;
    Some(top / below)
}

fn over_directions(directions: &[Found], outputs: usize) -> Vec<(usize, [Ball; 2])> {
    let of = |output: usize| {
        let mut sums = [Ball::ZERO; 2];
        for (_, found) in directions {
            let (_, maximum) = found.as_ref().ok()?.outputs.iter().find(|(known, _)| *known == output)?;
            let maximum = maximum.as_ref().ok()?;
            sums = [sums[0] + maximum.srss.square(), sums[1] + maximum.cqc.square()];
        }
        Some((output, sums.map(Ball::sqrt)))
    };
    (0..outputs).filter_map(of).collect()
}
