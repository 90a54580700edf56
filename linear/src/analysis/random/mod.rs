//! Stationary response to noise: mean squares with bounds, densities, crossings. In: a linear system with all its
//! modes, the noises of its inputs. Out: for each output a number, a proof that it is infinite, or the reason why there
//! is none. See docs/method/random.md.

mod argument;
mod bands;
mod basis;
mod blocks;
mod channel;
mod coherent;
mod density;
mod driven;
mod effort;
mod gauss;
mod gramian;
mod harmonic;
mod lossy;
mod maxima;
mod peaks;
mod quotient;
mod reach;
mod realisation;
mod resolvent;
mod several;
mod source;
mod tail;
mod undamped;
mod weight;

use crate::analysis::answer::{Modes, Poles};
use crate::analysis::poles::companion::StateForm;
use crate::analysis::transfer::Transfer;
use crate::base::{Ball, Number, Unproven};
use crate::system::{LinearSystem, Noise, Output};
use basis::Basis;
use driven::Driven;
use effort::Effort;
use gramian::Obstacle;
use lossy::Lossy;
use std::borrow::Cow;
use std::cell::OnceCell;

pub use density::density;
pub use peaks::Peak;
pub use reach::Reach;
pub use realisation::realisation;

/// A mean square, or a number derived from it.
#[derive(Clone, Debug, PartialEq)]
pub enum Spread {
    Finite(Ball),
    /// Proved, with its reason.
    Infinite(Cow<'static, str>),
    /// Nothing is proved, for this reason.
    Unknown(&'static str),
}

const OPEN_DIGITS: &str = "the bound leaves no digit";
const OPEN_RATE: &str = "the zero crossings of an acceleration need its derivative, which is not computed";
/// The relative bound of a mean square beyond which there is no number.
const LEAST: f64 = 0.1;

/// A system under noise. Each output is computed from those independent parts only that noise moves and that the output
/// shows.
pub struct Random<'a> {
    system: &'a LinearSystem,
    modes: &'a Modes,
    noises: &'a [Noise],
    /// A Schur form that may be that of the whole system.
    known: Option<&'a StateForm>,
    reach: Reach,
    driven: Vec<bool>,
    whole: OnceCell<Driven<'a>>,
    some: Vec<Subset<'a>>,
    /// Replaces the other one if there are loss factors, and for peaks if zeros and poles are not known.
    lossy: OnceCell<Lossy<'a>>,
    /// Effort of the searches for peaks by elimination.
    effort: Effort,
}

/// Some parts of the system, but not all of them.
struct Subset<'a> {
    parts: Vec<bool>,
    basis: Basis,
    /// `None` if a mode moves other parts too.
    driven: OnceCell<Option<Driven<'a>>>,
    lossy: OnceCell<Lossy<'a>>,
}

impl<'a> Random<'a> {
    pub fn of(system: &'a LinearSystem, modes: &'a Modes, noises: &'a [Noise]) -> Random<'a> {
        let reach = Reach::of(system);
        let driven = reach.driven(system, noises);
        let mut some: Vec<Subset> = Vec::new();
        let is_divided = reach.count > 1 && !system.is_chained();
        for output in system.outputs.iter().filter(|_| is_divided) {
            let parts = reach.shown_parts(output, &driven);
            let is_new =
                parts.contains(&true) && parts.contains(&false) && some.iter().all(|known| known.parts != parts);
            if is_new {
                let kept: Vec<usize> = (0..system.n()).filter(|&i| parts[reach.part[i]]).collect();
                let (basis, driven, lossy) =
                    (Basis::of_coordinates(system.n(), &kept), OnceCell::new(), OnceCell::new());
                some.push(Subset { parts, basis, driven, lossy });
            }
        }
        let (whole, lossy) = Default::default();
        let effort = Effort::of(maxima::MOST_TERMS);
        Random { system, modes, noises, known: None, reach, driven, whole, some, lossy, effort }
    }

    /// Uses the results of an earlier search for the poles of the system.
    pub fn with(self, poles: &'a Poles) -> Random<'a> {
        Random { known: poles.state.as_deref(), ..self }
    }

    /// The system that determines an output, and the output there.
    fn place<'o>(&self, output: &'o Output) -> (&Driven<'a>, Cow<'o, Output>) {
        let parts = self.reach.shown_parts(output, &self.driven);
        let found = self.some.iter().find(|some| some.parts == parts).and_then(|some| {
            let of = || {
                let (numbers, modes) = self.modes_of(&some.parts)?;
                let system = Cow::Owned(some.basis.system(self.system));
                Some(Driven::of(system, Cow::Owned(modes), self.noises, numbers, None))
            };
            let driven = some.driven.get_or_init(of).as_ref()?;
            Some((driven, Cow::Owned(some.basis.output(output))))
        });
        let (driven, output) = found.unwrap_or_else(|| {
            let numbers = (1..=self.modes.list.len()).collect();
            let of = || {
                let (system, modes) = (Cow::Borrowed(self.system), Cow::Borrowed(self.modes));
                Driven::of(system, modes, self.noises, numbers, self.known)
            };
            (self.whole.get_or_init(of), Cow::Borrowed(output))
        });
        match driven.without_undamped(&output) {
            Some((driven, output)) => (driven, Cow::Owned(output)),
            None => (driven, output),
        }
    }

    /// The modes of some parts with their numbers from 1; `None` if a mode moves other parts too.
    fn modes_of(&self, parts: &[bool]) -> Option<(Vec<usize>, Modes)> {
        let kept: Vec<usize> = (0..self.system.n()).filter(|&i| parts[self.reach.part[i]]).collect();
        let (mut numbers, mut list) = (Vec::new(), Vec::new());
        for (number, mode) in (1..).zip(&self.modes.list) {
            let is_moved = |i: &usize| mode.shape[*i] != 0.0 || mode.precise.as_ref().is_some_and(|x| !x[*i].is_zero());
            let moved: Vec<usize> = (0..mode.shape.len()).filter(is_moved).collect();
            match moved.iter().filter(|&&i| parts[self.reach.part[i]]).count() {
                0 => continue,
                count if count < moved.len() => return None,
                _ => {}
            }
            let mut own = mode.clone();
            own.shape = kept.iter().map(|&i| mode.shape[i]).collect();
            own.precise = mode.precise.as_ref().map(|x| kept.iter().map(|&i| x[i]).collect());
            numbers.push(number);
            list.push(own);
        }
        (list.len() == kept.len()).then(|| (numbers, Modes { list, ..Modes::default() }))
    }

    /// Whether noise reaches an output.
    pub fn reaches(&self, output: &Output) -> bool {
        self.noises.iter().any(|noise| self.reach.from_noise(self.system, noise, output))
    }

    /// The mean square of an output, or of its rate, with loss factors; `None` if no relevant spring has one.
    fn lossy(&self, output: &Output, is_rate: bool, within: Option<[&Number; 2]>) -> Option<Spread> {
        Some(self.lossy_with_modes(output, is_rate, within)?.0)
    }

    /// That mean square, and the contribution of each mode to it.
    fn lossy_with_modes(
        &self,
        output: &Output,
        is_rate: bool,
        within: Option<[&Number; 2]>,
    ) -> Option<(Spread, Vec<(usize, f64)>)> {
        self.system.losses.as_deref()?;
        let lossy = self.modal(output);
        if !lossy.has_losses() {
            return None;
        }
        let Some(index) = self.index(output) else { return Some((Spread::Unknown(OPEN_DIGITS), Vec::new())) };
        Some(lossy.mean_square(&lossy.seen_output(index), is_rate, within))
    }

    fn index(&self, output: &Output) -> Option<usize> {
        self.system.outputs.iter().position(|known| std::ptr::eq(known, output))
    }

    /// The parts that an output shows, or the whole system if they cannot be separated.
    fn modal(&self, output: &Output) -> &Lossy<'a> {
        let parts = self.reach.shown_parts(output, &self.driven);
        let found = self.some.iter().find(|some| some.parts == parts);
        if let Some((some, (numbers, modes))) = found.and_then(|some| Some((some, self.modes_of(&some.parts)?))) {
            let of = || Lossy::of(Cow::Owned(some.basis.system(self.system)), &modes, self.noises, numbers);
            return some.lossy.get_or_init(of);
        }
        let numbers = || (1..=self.modes.list.len()).collect();
        self.lossy.get_or_init(|| Lossy::of(Cow::Borrowed(self.system), self.modes, self.noises, numbers()))
    }

    /// The frequencies in Hz of the maxima of the density of an output, by elimination in modal coordinates.
    fn maxima(&self, output: usize) -> Result<Vec<Ball>, &'static str> {
        let modal = self.modal(&self.system.outputs[output]);
        match modal.shares(&modal.seen_output(output)) {
            Ok(shares) => maxima::maxima(&shares, Some(&self.effort)),
            Err(Spread::Unknown(why)) => Err(why),
            Err(Spread::Finite(_) | Spread::Infinite(_)) => Err(OPEN_DIGITS),
        }
    }

    /// The root mean square, in the SI unit of the output.
    pub fn rms(&self, output: &Output) -> Spread {
        if let Some(square) = self.lossy(output, false, None) {
            return square.root();
        }
        let (driven, output) = self.place(output);
        driven.mean_square(&output).root()
    }

    /// The root mean square of the part of an output between two frequencies, Hz.
    pub fn rms_within(&self, output: &Output, within: [&Number; 2]) -> Spread {
        if let Some(square) = self.lossy(output, false, Some(within)) {
            return square.root();
        }
        let (driven, output) = self.place(output);
        driven.mean_square_within(&output, within).root()
    }

    /// The expected number of upward zero crossings per second.
    pub fn crossings(&self, output: &Output) -> Spread {
        if let (Some(square), Some(rate)) = (self.lossy(output, false, None), self.lossy(output, true, None)) {
            return rate.crossings(square);
        }
        let (driven, output) = self.place(output);
        driven.crossings(&output, driven.mean_square(&output))
    }

    /// The root mean square, the crossings, and the contribution of each mode to the mean square, with modes numbered from 1.
    fn measures(&self, output: &Output) -> ([Spread; 2], Vec<(usize, Unproven)>) {
        if let (Some((square, by_modes)), Some(rate)) =
            (self.lossy_with_modes(output, false, None), self.lossy(output, true, None))
        {
            let shares = match square {
                Spread::Finite(whole) => driven::shares(by_modes.into_iter(), whole),
                _ => Vec::new(),
            };
            return ([square.clone().root(), rate.crossings(square)], shares);
        }
        let (driven, output) = self.place(output);
        let mean_square = driven.mean_square(&output);
        let shares = match &mean_square {
            Spread::Finite(whole) => driven.shares(&output, *whole),
            _ => Vec::new(),
        };
        ([mean_square.clone().root(), driven.crossings(&output, mean_square)], shares)
    }
}

impl Spread {
    /// The upward zero crossings per second, if this is the mean square of the rate: its root over 2 pi times the rms
    /// (Rice 1945).
    fn crossings(self, mean_square: Spread) -> Spread {
        match (self, mean_square) {
            (Spread::Finite(_), Spread::Finite(square)) if square.is_zero() => Spread::Unknown("no noise moves it"),
            (Spread::Finite(rate), Spread::Finite(square)) => {
                Spread::Finite((rate / square).sqrt() / (Ball::PI * Ball::from(2.0)))
            }
            // A motion that drifts crosses zero ever more rarely, one that nothing damps as often as it oscillates.
            (_, Spread::Infinite(_)) => {
                Spread::Unknown("its mean square is infinite, so that no rate of zero crossings follows from it")
            }
            (Spread::Infinite(why), _) => Spread::Infinite(why),
            (Spread::Unknown(why), _) | (_, Spread::Unknown(why)) => Spread::Unknown(why),
        }
    }

    fn root(self) -> Spread {
        match self {
            Spread::Finite(square) => Spread::Finite(square.sqrt()),
            other => other,
        }
    }

    /// The sum of mean squares of independent noises.
    fn plus(self, other: Spread) -> Spread {
        match (self, other) {
            (Spread::Finite(a), Spread::Finite(b)) => Spread::Finite(a + b),
            (Spread::Infinite(why), _) | (_, Spread::Infinite(why)) => Spread::Infinite(why),
            (Spread::Unknown(why), _) | (_, Spread::Unknown(why)) => Spread::Unknown(why),
        }
    }
}

/// A mean square, if its bound is small enough to give a number.
fn finite(value: Option<Ball>) -> Spread {
    match value {
        Some(value) if value.is_zero() || value.relative_error() < LEAST => Spread::Finite(value),
        _ => Spread::Unknown(OPEN_DIGITS),
    }
}

/// An output under noise.
#[derive(Clone, Debug)]
pub struct Noisy {
    /// Index of the output.
    pub output: usize,
    /// In the output's unit.
    pub rms: Spread,
    /// Upward zero crossings, Hz.
    pub crossings: Spread,
    /// The modes that contribute, numbered from 1, in descending order of their shares; without bounds.
    pub shares: Vec<(usize, Unproven)>,
    /// Every peak of its density, ascending, or the reason why they are not known.
    pub peaks: Result<Vec<Peak>, Cow<'static, str>>,
}

/// The results for every output that noise reaches.
pub fn outputs(system: &LinearSystem, modes: &Modes, poles: &Poles, noises: &[Noise]) -> Vec<Noisy> {
    if noises.is_empty() {
        return Vec::new();
    }
    let random = Random::of(system, modes, noises).with(poles);
    let transfer = Transfer::of(system);
    let reached = system.outputs.iter().enumerate().filter(|(_, output)| random.reaches(output));
    let of = |(index, output): (usize, &Output)| {
        let ([rms, crossings], shares) = random.measures(output);
        let peaks = match &rms {
            Spread::Finite(_) => {
                let by_modes = || random.maxima(index);
                peaks::peaks(&transfer, system, noises, &random.reach, index, by_modes).map_err(Cow::from)
            }
            Spread::Infinite(why) => Err(why.clone()),
            Spread::Unknown(why) => Err((*why).into()),
        };
        Noisy { output: index, rms, crossings, shares, peaks }
    };
    reached.map(of).collect()
}

fn why(obstacle: Obstacle) -> &'static str {
    match obstacle {
        Obstacle::Empty => "the scene has no motion",
        Obstacle::Large => "the scene has more than 150 coordinates: mean squares are computed up to there",
        Obstacle::Modes => "a motion has no inertia, or not all modes are known: mean squares need them",
        Obstacle::Rigid => "a motion is not held by springs: what it does to this output is not proved",
        Obstacle::NotStable => "it is not proved that every motion decays",
    }
}
