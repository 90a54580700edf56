//! Measures of a scene as measures of its linear system. In: questions. Out: an output for each combination of motions
//! that a question names, and a probe for each measure; then, for a system, the numbers.

use super::combined::value_of;
use super::trial::Context;
use crate::analysis::measures::{self, Loads};
use crate::analysis::random::{self, Random, Reach, Spread};
use crate::analysis::rates::{Rate, from_rate, from_rate_at_rest};
use crate::analysis::settling::Settling;
use crate::analysis::{Measurement, Modes, Poles, Stability, Transfer, is_passive, peak, stability};
use crate::base::{Ball, Number, Span};
use crate::lower::{Lowered, Readout};
use crate::model::scene::{Cause, Combined, Drive, Measure, MotionTerm, Question, Scene, Signal};
use crate::system::{LinearSystem, Signal as DrivenBy};

/// The measure to be computed from the system.
#[derive(Clone, Debug)]
pub enum Probe {
    Frequency(usize),
    Damping(usize),
    Gain(usize, usize, Number),
    Phase(usize, usize, Number),
    Amplitude(usize),
    Static(usize),
    Peak(usize),
    Settling(usize, Number),
    Overshoot(usize),
    Rms(usize, Cause),
    RmsWithin(usize, [Number; 2]),
    Psd(usize, Number),
    Crossings(usize),
    PeakGain(usize, usize, Option<[Number; 2]>),
    /// The indices of an input and a mode.
    EffectiveMass(usize, usize),
    Rest(Vec<MotionTerm>, Span),
    LoadFactor,
    Combined(Box<Combined<Probe>>),
    /// A gain or a phase whose input is the velocity (1) or the acceleration (2) of a base, not its displacement.
    ByRate(u8, Box<Probe>),
    Stable,
    /// omega^2 of a mode, for a target frequency of zero: it changes sign there.
    Square(usize),
    /// ((s1 - s2) / 2)^2 of the two poles of a motion, for critical damping as the target: it changes sign there.
    Critical(usize),
    /// How fast the fastest growing free motion grows, relative to its pole; zero if none is proved to grow.
    Growth,
}

/// One probe for each question, and the outputs that the probes read.
pub struct Plan {
    pub probes: Vec<Probe>,
    /// Outputs in addition to those that the scene declares, numbered after them.
    pub readouts: Vec<Readout>,
}

/// The probes that answer the questions.
pub fn prepare(scene: &Scene, questions: &[Question]) -> Plan {
    let mut outputs = Outputs::new(scene);
    let probes = questions.iter().map(|question| outputs.probe(question)).collect();
    Plan { probes, readouts: outputs.added }
}

/// The probes that answer the questions, and last of them [`Probe::Growth`].
pub fn prepare_with_growth(scene: &Scene, questions: &[Question]) -> Plan {
    let Plan { probes, readouts } = prepare(scene, questions);
    Plan { probes: probes.into_iter().chain([Probe::Growth]).collect(), readouts }
}

/// The probes that find the parameter values at which the measures reach their targets. A measure whose range ends at
/// its target, as a frequency's does at zero and a damping ratio's at one, is replaced by a quantity that changes sign
/// there.
pub fn prepare_crossings(scene: &Scene, questions: &[Question]) -> Plan {
    let mut outputs = Outputs::new(scene);
    let crossing = |question: &Question| match &question.measure {
        Measure::Frequency { mode } if question.value.is_zero() => Some(Probe::Square(*mode as usize)),
        Measure::DampingRatio { mode } if question.value.is_one() => Some(Probe::Critical(*mode as usize)),
        _ => None,
    };
    let probe = |question: &Question| crossing(question).unwrap_or_else(|| outputs.probe(question));
    let probes = questions.iter().map(probe).collect();
    Plan { probes, readouts: outputs.added }
}

/// Outputs in addition to those of a scene.
struct Outputs {
    declared: usize,
    added: Vec<Readout>,
}

impl Outputs {
    fn new(scene: &Scene) -> Outputs {
        Outputs { declared: scene.outputs.len(), added: Vec::new() }
    }

    fn probe(&mut self, question: &Question) -> Probe {
        self.probe_of(&question.measure, question.span)
    }

    fn probe_of(&mut self, measure: &Measure, span: Span) -> Probe {
        if let Measure::Combined(combined) = measure {
            return Probe::Combined(Box::new(combined.map(&mut |measure| self.probe_of(measure, span))));
        }
        let mut add = |terms: &[MotionTerm]| self.add(span, terms);
        match measure {
            Measure::Frequency { mode } => Probe::Frequency(*mode as usize),
            Measure::DampingRatio { mode } => Probe::Damping(*mode as usize),
            Measure::Gain { input, output, frequency } => {
                let output = add(output);
                by_rate(*input, |input| Probe::Gain(input, output, frequency.clone()))
            }
            Measure::Phase { input, output, frequency } => {
                let output = add(output);
                by_rate(*input, |input| Probe::Phase(input, output, frequency.clone()))
            }
            Measure::Amplitude { output } => Probe::Amplitude(add(output)),
            Measure::Static { output } => Probe::Static(add(output)),
            Measure::Peak { output } => Probe::Peak(add(output)),
            Measure::Settling { output, band } => Probe::Settling(add(output), band.clone()),
            Measure::Overshoot { output } => Probe::Overshoot(add(output)),
            Measure::Rms { output, of } => Probe::Rms(add(output), *of),
            Measure::RmsWithin { output, range } => Probe::RmsWithin(add(output), range.clone()),
            Measure::Psd { output, frequency } => Probe::Psd(add(output), frequency.clone()),
            Measure::Crossings { output } => Probe::Crossings(add(output)),
            Measure::PeakGain { input, output, range } => {
                let output = add(output);
                by_rate(*input, |input| Probe::PeakGain(input, output, range.clone()))
            }
            Measure::EffectiveMass { input, mode } => Probe::EffectiveMass(input.index(), *mode as usize),
            Measure::Rest { terms } => Probe::Rest(terms.clone(), span),
            Measure::LoadFactor => Probe::LoadFactor,
            Measure::Stable | Measure::Combined(_) => Probe::Stable,
        }
    }

    /// Adds an output and returns its number.
    fn add(&mut self, span: Span, terms: &[MotionTerm]) -> usize {
        self.added.push(Readout { terms: terms.to_vec(), span });
        self.declared + self.added.len() - 1
    }
}

/// A probe of an input, or of its velocity or acceleration.
fn by_rate(Drive { input, derivative }: Drive, probe: impl Fn(usize) -> Probe) -> Probe {
    let probe = probe(input.index());
    if derivative == 0 { probe } else { Probe::ByRate(derivative, Box::new(probe)) }
}

impl Probe {
    /// Whether the probe, or a part of one that combines several, satisfies a condition.
    fn any(&self, of: fn(&Probe) -> bool) -> bool {
        match self {
            Probe::Combined(combined) => combined.any(&|part| part.any(of)),
            Probe::ByRate(_, probe) => probe.any(of),
            probe => of(probe),
        }
    }

    /// The probe as one of the input itself, and which derivative of that it is of.
    pub fn without_rate(&self) -> (&Probe, u8) {
        match self {
            Probe::ByRate(derivative, probe) => (probe, *derivative),
            probe => (probe, 0),
        }
    }

    /// The highest mode whose frequency is needed.
    pub fn highest_mode(&self) -> usize {
        match self {
            Probe::Frequency(mode) | Probe::Square(mode) => *mode,
            Probe::Combined(combined) => {
                let mut highest = 0;
                combined.map(&mut |part| highest = highest.max(part.highest_mode()));
                highest
            }
            _ => 0,
        }
    }

    /// Whether modes are needed.
    pub fn of_modes(&self) -> bool {
        self.of_poles()
            || self.any(|probe| matches!(probe, Probe::Frequency(_) | Probe::Square(_)) || probe.takes_all_modes())
    }

    /// Whether poles are needed.
    pub fn of_poles(&self) -> bool {
        self.any(|probe| {
            let is_of_poles =
                matches!(probe, Probe::Damping(_) | Probe::Critical(_) | Probe::Stable | Probe::PeakGain(..));
            is_of_poles || probe.is_of_approach()
        })
    }

    /// Whether it concerns the approach to the final value.
    fn is_of_approach(&self) -> bool {
        matches!(self, Probe::Settling(..) | Probe::Overshoot(_))
    }

    /// Whether every mode is needed.
    pub fn takes_all_modes(&self) -> bool {
        self.any(|probe| {
            let is_of_noise = matches!(probe, Probe::Crossings(_) | Probe::RmsWithin(..));
            let is_of_modes = matches!(probe, Probe::EffectiveMass(..));
            is_of_noise || is_of_modes || matches!(probe, Probe::Rms(_, Cause::Noise | Cause::Either))
        })
    }

    /// Whether the signals or noises are needed.
    pub fn of_signals(&self) -> bool {
        self.any(|probe| {
            let is_of_time = matches!(probe, Probe::Amplitude(_) | Probe::Static(_) | Probe::Peak(_));
            is_of_time
                || probe.is_of_approach()
                || matches!(probe, Probe::Rms(..) | Probe::RmsWithin(..) | Probe::Psd(..) | Probe::Crossings(_))
        })
    }

    /// Whether it concerns the motion that remains when every free motion has decayed.
    fn of_settled_motion(&self) -> bool {
        self.any(|probe| {
            probe.is_of_approach() || matches!(probe, Probe::Amplitude(_) | Probe::Static(_) | Probe::Psd(..))
        })
    }

    /// Whether it matters if some free motion grows.
    pub fn of_growth(&self) -> bool {
        self.of_settled_motion() || matches!(self, Probe::Growth)
    }

    /// Whether the motion in time is needed.
    pub fn of_time(&self) -> bool {
        self.any(|probe| matches!(probe, Probe::Peak(_) | Probe::Rms(_, Cause::Time | Cause::Either)))
    }

    /// Whether it is computed if springs have loss factors: measures of harmonic motion, noise, rest, and undamped
    /// motion are.
    fn takes_losses(&self) -> bool {
        matches!(
            self,
            Probe::Combined(_)
                | Probe::ByRate(..)
                | Probe::Gain(..)
                | Probe::Phase(..)
                | Probe::Amplitude(_)
                | Probe::Static(_)
                | Probe::Frequency(_)
                | Probe::Square(_)
                | Probe::EffectiveMass(..)
                | Probe::Damping(_)
                | Probe::Stable
                | Probe::Rest(..)
                | Probe::LoadFactor
                | Probe::Rms(_, Cause::Noise | Cause::Either)
                | Probe::RmsWithin(..)
                | Probe::Psd(..)
                | Probe::Crossings(_)
        )
    }

    fn of_transfer(&self) -> bool {
        self.any(|probe| {
            let is_gain = matches!(probe, Probe::Gain(..) | Probe::Phase(..) | Probe::PeakGain(..));
            is_gain
                || probe.is_of_approach()
                || matches!(probe, Probe::Amplitude(_) | Probe::Static(_) | Probe::Psd(..))
        })
    }
}

/// No simulation time: the motion grows, or nothing moves.
const NO_TIME: Measurement = Measurement::None("the simulated time is not known: give it with `--until`");

/// The scene and the results that the probes are applied to.
pub struct Measured<'a> {
    pub scene: &'a Scene,
    pub lowered: &'a Lowered,
    /// Set if the probes need them.
    pub modes: Option<&'a Modes>,
    pub poles: Option<&'a Poles>,
    pub context: &'a Context,
}

impl Measured<'_> {
    /// The numbers, in the order of the probes.
    pub fn measure(&self, probes: &[Probe]) -> Vec<Measurement> {
        let system = &self.lowered.system;
        let transfer = probes.iter().any(Probe::of_transfer).then(|| Transfer::of(system));
        probes.iter().map(|probe| self.one(system, transfer.as_ref(), probe)).collect()
    }

    fn one(&self, system: &LinearSystem, transfer: Option<&Transfer>, probe: &Probe) -> Measurement {
        const NONE: Measurement = Measurement::None("it could not be computed");
        if !self.lowered.rest.is_proven() {
            return Measurement::None("the rest about which it would be measured is not proven");
        }
        if let (false, true, Some(why)) =
            (matches!(probe, Probe::Combined(_)), probe.of_settled_motion(), self.growth())
        {
            return Measurement::None(why);
        }
        if system.losses.is_some() && !probe.takes_losses() {
            return Measurement::None("a spring has a loss factor, with which only harmonic motion is computed");
        }
        let drives = &self.context.drives;
        match probe {
            Probe::Frequency(mode) => self.modes.map_or(NONE, |modes| measures::frequency(modes, *mode)),
            Probe::Square(mode) => self.modes.map_or(NONE, |modes| measures::square(modes, *mode)),
            Probe::Critical(1) if system.n() == 1 => measures::discriminant(system),
            Probe::Critical(motion) => self.poles.map_or(NONE, |poles| measures::critical(poles, *motion)),
            Probe::Damping(_) if system.losses.is_some() && !self.poles.is_some_and(Poles::is_complete) => {
                Measurement::None("the poles with these loss factors are not found")
            }
            Probe::Damping(motion) => self.poles.map_or(NONE, |poles| measures::damping_ratio(poles, *motion)),
            Probe::Stable => match (self.modes, self.poles) {
                (Some(modes), Some(poles)) => {
                    let found = stability(system, modes, poles);
                    let is_flat = self.lowered.rest.has_flat_law();
                    verdict(if is_flat { found.with_flat_law() } else { found }.kind())
                }
                _ => NONE,
            },
            Probe::Gain(input, output, at) => {
                transfer.map_or(NONE, |transfer| measures::gain(transfer, *input, *output, at))
            }
            Probe::PeakGain(input, output, range) => {
                let range = range.as_ref().map(|[low, high]| (low, high));
                transfer.map_or(NONE, |transfer| measures::peak_gain(transfer, self.poles, *input, *output, range))
            }
            Probe::ByRate(derivative, probe) => self.by_rate(system, *derivative, probe),
            Probe::EffectiveMass(input, mode) => {
                self.modes.map_or(NONE, |modes| measures::effective_mass(system, modes, *input, *mode))
            }
            Probe::Rest(terms, span) => {
                let Lowered { mechanism, rest, .. } = self.lowered;
                match mechanism.at_rest(self.scene, rest, terms, *span) {
                    Ok(value) => Measurement::Value(value.to_ball()),
                    Err(_) => Measurement::None(
                        "joints hold the same parts twice: what each of them carries is not determined",
                    ),
                }
            }
            Probe::LoadFactor => measures::load_factor(system),
            Probe::Growth => Measurement::Value(Ball::from(self.rate_of_growth())),
            Probe::Combined(combined) => value_of(&combined.map(&mut |part| self.one(system, transfer, part))),
            Probe::Phase(input, output, at) => {
                transfer.map_or(NONE, |transfer| measures::phase(transfer, *input, *output, at))
            }
            Probe::Amplitude(_) if !drives.iter().flatten().any(|s| matches!(s, DrivenBy::Harmonic { .. })) => {
                Measurement::None("no input has a harmonic signal: there is no steady motion")
            }
            Probe::Amplitude(_) if drives.iter().flatten().any(DrivenBy::comes_again) => {
                Measurement::None("a table that comes again has many harmonics: `peak` and `rms` take it as it is")
            }
            Probe::Amplitude(output) => {
                transfer.map_or(NONE, |transfer| measures::amplitude(transfer, drives, *output))
            }
            Probe::Static(output) if drives.iter().any(|signals| measures::lasting_value(signals).is_none()) => {
                match (transfer, self.ends()) {
                    (Some(transfer), Some(ends)) => measures::final_value(transfer, &ends, *output),
                    _ => Measurement::None(measures::MOVES_BY_RATE),
                }
            }
            Probe::Static(_) if self.loads().iter().all(|(_, load)| load.is_zero()) => {
                let is_constant = |signal: &Signal| matches!(signal, Signal::Constant { value } if !value.is_zero());
                Measurement::None(match self.scene.inputs.iter().flat_map(|input| &input.signal).any(is_constant) {
                    true => {
                        "constant loads are part of the rest, from which motion is measured; ask for the rest, as in `rest(block.x)`"
                    }
                    false => "no input has a lasting signal: nothing moves",
                })
            }
            Probe::Static(output) => {
                let loads = self.loads();
                transfer.map_or(NONE, |transfer| measures::static_value(transfer, &loads, *output))
            }
            Probe::Psd(..) | Probe::Crossings(_) | Probe::RmsWithin(..) | Probe::Rms(_, Cause::Noise)
                if self.context.noises.is_empty() =>
            {
                Measurement::None("no input has noise")
            }
            Probe::RmsWithin(output, [low, high]) => {
                self.under_noise(system, |random| random.rms_within(&system.outputs[*output], [low, high]))
            }
            Probe::Psd(output, at) => transfer.map_or(NONE, |transfer| {
                spread_measurement(random::density(transfer, system, &self.context.noises, *output, at))
            }),
            Probe::Crossings(output) => self.under_noise(system, |random| random.crossings(&system.outputs[*output])),
            Probe::Rms(output, Cause::Noise) => self.under_noise(system, |random| random.rms(&system.outputs[*output])),
            Probe::Rms(output, Cause::Either) => {
                let reach = Reach::of(system);
                let output_of = &system.outputs[*output];
                let reaches = |input: usize| reach.from_input(system, input, output_of);
                let by_noise = self.context.noises.iter().any(|noise| reach.from_noise(system, noise, output_of));
                let in_time = (0..drives.len()).any(|input| !drives[input].is_empty() && reaches(input))
                    || reach.from_start(system, output_of);
                match (by_noise, in_time) {
                    (true, true) => Measurement::None(
                        "noise and other motion both reach it: write `rms(..., noise)` or `rms(..., time)`",
                    ),
                    (true, false) => self.one(system, transfer, &Probe::Rms(*output, Cause::Noise)),
                    (false, _) => self.one(system, transfer, &Probe::Rms(*output, Cause::Time)),
                }
            }
            Probe::Peak(_) | Probe::Rms(..) if drives.iter().all(Vec::is_empty) && system.initial.is_empty() => {
                Measurement::None("there is no signal and no initial state: nothing moves")
            }
            Probe::Peak(_) | Probe::Rms(..) if self.is_still(probe) => Measurement::Value(Ball::ZERO),
            Probe::Peak(output) => match &self.context.until {
                Some(until) => peak::peak(system, drives, *output, until),
                None => NO_TIME,
            },
            Probe::Settling(output, _) | Probe::Overshoot(output) if self.is_noisy(*output) => {
                Measurement::None("noise reaches it: it never settles")
            }
            Probe::Settling(output, band) => self.settling(transfer).map_or(NONE, |found| found.time(*output, band)),
            Probe::Overshoot(output) => self.settling(transfer).map_or(NONE, |found| found.overshoot(*output)),
            Probe::Rms(output, _) => match &self.context.until {
                Some(until) => peak::rms(system, drives, *output, until),
                None => NO_TIME,
            },
        }
    }

    fn has_spectrum(&self, input: usize) -> bool {
        let signals = self.scene.inputs.get(input).map_or(&[][..], |input| &input.signal);
        signals.iter().any(|signal| matches!(signal, Signal::Spectrum(_)))
    }

    /// Whether nothing that drives the scene reaches what is measured: no signal and no initial state, or not the input of a gain.
    pub fn is_still(&self, probe: &Probe) -> bool {
        let (system, drives) = (&self.lowered.system, &self.context.drives);
        let reach = Reach::of(system);
        let is_driven = |output: usize| {
            let output = &system.outputs[output];
            (0..drives.len()).any(|input| !drives[input].is_empty() && reach.from_input(system, input, output))
                || reach.from_start(system, output)
                || self.context.noises.iter().any(|noise| reach.from_noise(system, noise, output))
                // What a response spectrum moves is not known in time.
                || (0..system.inputs.len()).any(|input| self.has_spectrum(input) && reach.from_input(system, input, output))
        };
        match probe {
            Probe::Peak(output) | Probe::Rms(output, _) | Probe::Static(output) | Probe::Amplitude(output) => {
                !is_driven(*output)
            }
            Probe::Gain(input, output, _) | Probe::PeakGain(input, output, _) => {
                !reach.from_input(system, *input, &system.outputs[*output])
            }
            Probe::ByRate(_, probe) => self.is_still(probe),
            _ => false,
        }
    }

    /// A gain or a phase from the velocity or the acceleration of a base, in the system that has it as its last input.
    fn by_rate(&self, system: &LinearSystem, derivative: u8, probe: &Probe) -> Measurement {
        let (Probe::Gain(input, output, _) | Probe::Phase(input, output, _) | Probe::PeakGain(input, output, _)) =
            probe
        else {
            return self.one(system, None, probe);
        };
        let is_at_rest = matches!(probe, Probe::Gain(.., at) | Probe::Phase(.., at) if at.is_zero());
        let from = if is_at_rest { from_rate_at_rest } else { from_rate };
        let driven = match from(system, Rate { input: *input, derivative, word: "" }, *output) {
            Ok(driven) => driven,
            Err(why) => return Measurement::None(why),
        };
        let (transfer, last) = (Transfer::of(&driven), driven.inputs.len() - 1);
        match probe {
            Probe::Gain(.., at) => measures::gain(&transfer, last, 0, at),
            Probe::Phase(.., at) => measures::phase(&transfer, last, 0, at),
            Probe::PeakGain(.., range) => {
                // A further coordinate would change the poles.
                let poles = self.poles.filter(|_| driven.n() == system.n());
                measures::peak_gain(&transfer, poles, last, 0, range.as_ref().map(|[low, high]| (low, high)))
            }
            other => self.one(system, None, other),
        }
    }

    fn settling<'a>(&'a self, transfer: Option<&'a Transfer<'a>>) -> Option<Settling<'a>> {
        let (system, drives) = (&self.lowered.system, &self.context.drives[..]);
        Some(Settling { system, transfer: transfer?, poles: self.poles?, drives })
    }

    /// Whether noise reaches an output.
    fn is_noisy(&self, output: usize) -> bool {
        let system = &self.lowered.system;
        let reach = Reach::of(system);
        self.context.noises.iter().any(|noise| reach.from_noise(system, noise, &system.outputs[output]))
    }

    /// The reason why nothing settles, or may not settle.
    fn growth(&self) -> Option<&'static str> {
        match self.stability() {
            Stability::Stable | Stability::Neutral => None,
            Stability::Unstable => Some("a free motion grows: nothing settles"),
            Stability::Undetermined => Some("it is not proved that no free motion grows"),
        }
    }

    /// The verdict about free motions. Terms that supply no energy need no poles.
    pub fn stability(&self) -> Stability {
        let system = &self.lowered.system;
        match (self.modes, self.poles) {
            _ if is_passive(system) => Stability::Stable,
            (Some(modes), Some(poles)) => stability(system, modes, poles).kind(),
            _ => Stability::Undetermined,
        }
    }

    /// The largest of the ratios of a pole's real part and modulus if a free motion grows, and zero otherwise.
    fn rate_of_growth(&self) -> f64 {
        if self.stability() != Stability::Unstable {
            return 0.0;
        }
        let poles = self.poles.map_or(&[][..], |poles| &poles.list);
        let rates = poles.iter().map(|pole| pole.re.to_f64() / pole.modulus().to_f64());
        rates.filter(|rate| rate.is_finite()).fold(f64::MIN_POSITIVE, f64::max)
    }

    fn under_noise(&self, system: &LinearSystem, of: impl Fn(&Random) -> Spread) -> Measurement {
        match self.modes {
            Some(modes) => spread_measurement(of(&Random::of(system, modes, &self.context.noises))),
            None => Measurement::None("it could not be computed"),
        }
    }

    /// The final course of each input, c0 + c1 t + c2 t^2 / 2; `None` if that is not computed for one of them.
    fn ends(&self) -> Option<Vec<(usize, [Number; 3])>> {
        let swings = |signal: &DrivenBy| matches!(signal, DrivenBy::Harmonic { .. });
        let of_input = |signals: &Vec<DrivenBy>| {
            // A base that swings by its acceleration keeps its initial drift, so nothing settles.
            if signals.iter().any(swings) && signals.iter().any(|signal| signal.final_value().is_none()) {
                return None;
            }
            let start = [Number::ZERO, Number::ZERO, Number::ZERO];
            let add = |sum: [Number; 3], end: [Number; 3]| std::array::from_fn(|k| &sum[k] + &end[k]);
            signals.iter().try_fold(start, |sum, signal| Some(add(sum, signal.in_the_end()?)))
        };
        let ends: Option<Vec<_>> = self.context.drives.iter().map(of_input).collect();
        Some(ends?.into_iter().enumerate().collect())
    }

    /// The final value of each input's signals. Constant ones are part of the rest, from which motion is measured.
    pub fn loads(&self) -> Loads {
        // The final value of a signal that does not settle is unknown.
        let unknown = || Number::Ball(Ball::ZERO.widen(f64::INFINITY));
        let last = |signals: &Vec<DrivenBy>| measures::lasting_value(signals).unwrap_or_else(unknown);
        self.context.drives.iter().map(last).enumerate().collect()
    }
}

fn spread_measurement(found: Spread) -> Measurement {
    match found {
        Spread::Finite(value) => Measurement::Value(value),
        Spread::Infinite(_) => Measurement::Infinite,
        Spread::Unknown(why) => Measurement::None(why),
    }
}

/// 1 if the rest is stable, 0 if it is neutral, -1 if a motion grows, and anything in between if that is not certain.
fn verdict(stability: Stability) -> Measurement {
    Measurement::Value(match stability {
        Stability::Stable => Ball::ONE,
        Stability::Neutral => Ball::ZERO,
        Stability::Unstable => -Ball::ONE,
        Stability::Undetermined => Ball::ZERO.widen(1.0),
    })
}
