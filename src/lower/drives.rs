//! The signals of a scene's inputs as data of the linear system. In: a scene. Out: a sum of signals for each input, in
//! the order of the system's inputs. If the rate or acceleration of a base is given, the sum holds its integrals: the
//! base starts at rest. See docs/method/response.md.

use super::error::LowerError;
use crate::base::{Ball, Number, ResponseSpectrum};
use crate::model::CheckedScene;
use crate::model::scene::{self, Input, InputKind};
use crate::system::{Course, Noise, Signal, Table};

/// The rows of the tables of all inputs together: in a motion each takes some 350 bytes, so these some 1.4 GB. A delayed input
/// has rows of its own, since they come at other times.
const MOST_ROWS: usize = 4_000_000;

/// The signals that drive each input. A constant load is part of the rest and drives nothing.
pub fn drives(scene: &CheckedScene) -> Result<Vec<Vec<Signal>>, LowerError> {
    let inputs = &scene.scene().inputs;
    let rows: usize = inputs.iter().map(rows_of).sum();
    if rows > MOST_ROWS
        && let Some(longest) = inputs.iter().max_by_key(|input| rows_of(input))
    {
        return Err(LowerError::TooManyRows { span: longest.span, rows, limit: MOST_ROWS });
    }
    scene.scene().inputs.iter().map(of_input).collect()
}

/// Every noise with the inputs that it drives: the input that declares it, and the inputs whose signals are delays of
/// that input's signal.
pub fn noises(scene: &CheckedScene) -> Vec<Noise> {
    let inputs = &scene.scene().inputs;
    let mut driven: Vec<Vec<(usize, Number)>> = (0..inputs.len()).map(|index| vec![(index, Number::ZERO)]).collect();
    for (index, input) in inputs.iter().enumerate() {
        for signal in &input.signal {
            if let scene::Signal::Delayed { by, of, .. } = signal {
                driven[*of].push((index, by.clone()));
            }
        }
    }
    let mut list = Vec::new();
    for (input, driven) in inputs.iter().zip(driven) {
        for signal in &input.signal {
            if let scene::Signal::Noise(density) = signal {
                list.push(Noise { inputs: driven.clone(), derivative: input.derivative, density: density.clone() });
            }
        }
    }
    list
}

/// The response spectra, each with the index of its input.
pub fn spectra(scene: &CheckedScene) -> Vec<(usize, ResponseSpectrum)> {
    let of = |(index, input): (usize, &Input)| {
        let spectra = input.signal.iter().filter_map(|signal| match signal {
            scene::Signal::Spectrum(spectrum) => Some((index, spectrum.clone())),
            _ => None,
        });
        spectra.collect::<Vec<_>>()
    };
    scene.scene().inputs.iter().enumerate().flat_map(of).collect()
}

/// The signals of an input as declared; for a base, they may be signals of its displacement, its rate or its
/// acceleration.
pub fn declared_signals(input: &Input) -> Result<Vec<Signal>, LowerError> {
    Ok(undelayed_of(input)?.into_iter().map(|(signal, by)| delay(signal, by)).collect())
}

fn of_input(input: &Input) -> Result<Vec<Signal>, LowerError> {
    if let InputKind::Unbalance { needs_speed: true, .. } = input.kind {
        return Err(LowerError::SpeedMissing { span: input.span });
    }
    let each = undelayed_of(input)?.into_iter().flat_map(|(signal, by)| {
        let integrals = integral(signal, input.derivative);
        integrals.into_iter().map(move |signal| delay(signal, by))
    });
    Ok(each.collect())
}

/// The signals of an input, each with its delay.
fn undelayed_of(input: &Input) -> Result<Vec<(Signal, Option<&Number>)>, LowerError> {
    let course = match (&input.kind, input.derivative) {
        (InputKind::Base { .. }, 0) => Course::Spline,
        (InputKind::Base { .. }, _) => Course::LinesToZero,
        _ => Course::Lines,
    };
    let mut list = Vec::new();
    for signal in &input.signal {
        for (signal, delay) in without_delay(signal) {
            if let Some(signal) = of_signal(signal, course)? {
                list.push((signal, delay));
            }
        }
    }
    Ok(list)
}

/// A signal without its delay, or the signals that it delays, each with that delay.
fn without_delay(signal: &scene::Signal) -> Vec<(&scene::Signal, Option<&Number>)> {
    match signal {
        scene::Signal::Delayed { by, signals, .. } => signals.iter().map(|signal| (signal, Some(by))).collect(),
        signal => vec![(signal, None)],
    }
}

/// The rows of the tables of an input.
fn rows_of(input: &Input) -> usize {
    let of = |signal: &scene::Signal| match signal {
        scene::Signal::Table { rows, .. } => rows.as_ref().map_or(0, |rows| rows.times.len()),
        _ => 0,
    };
    input.signal.iter().flat_map(without_delay).map(|(signal, _)| of(signal)).sum()
}

fn of_signal(signal: &scene::Signal, course: Course) -> Result<Option<Signal>, LowerError> {
    Ok(Some(match signal.clone() {
        // The check adds up delays of delays, so there is one delay. Noise and response spectra are no functions of
        // time.
        scene::Signal::Constant { .. }
        | scene::Signal::Delayed { .. }
        | scene::Signal::Noise(_)
        | scene::Signal::Spectrum(_) => return Ok(None),
        scene::Signal::Function(function) => function,
        scene::Signal::Table { span, rows, period, .. } => match rows {
            Some(rows) => {
                let (times, values) = (rows.times.clone(), rows.values.clone());
                Signal::Table(Table { times, values, course, period })
            }
            None => return Err(LowerError::TableUnread { span }),
        },
    }))
}

/// The repeated integral of a signal, from zero at t = 0, as a sum of signals.
fn integral(signal: Signal, times: u8) -> Vec<Signal> {
    match (signal, times) {
        (signal, 0) => vec![signal],
        (Signal::Harmonic { value, frequency, phase, at }, times) => {
            integral_of_harmonic(value, frequency, phase, at, times)
        }
        (Signal::Impulse { value, at }, times) => integral(Signal::Step { value, at }, times - 1),
        (of, times) => vec![Signal::Integral { of: Box::new(of), times }],
    }
}

/// The integral of a harmonic is one a quarter of a turn back, and a step that takes its first value away.
fn integral_of_harmonic(value: Number, frequency: Number, phase: Number, at: Number, times: u8) -> Vec<Signal> {
    let omega = &(&Number::pi() * &Number::from(2)) * &frequency;
    // A phase without digits left is one of an unknown sine.
    let sine = |angle: &Number| angle.sin_cos().map_or(Number::Ball(Ball::ZERO.widen(1.0)), |(sine, _)| sine);
    let Some(size) = value.checked_div(&omega) else {
        // The signal keeps its first value.
        return integral(Signal::Step { value: &value * &sine(&phase), at }, times);
    };
    let phase = &phase - &(&Number::pi() / &Number::from(2));
    let start = Signal::Step { value: -&(&size * &sine(&phase)), at: at.clone() };
    let swing = Signal::Harmonic { value: size, frequency, phase, at };
    integral(start, times - 1).into_iter().chain(integral(swing, times - 1)).collect()
}

/// A signal that comes so much later; of a harmonic, its phase at t = 0.
fn delay(signal: Signal, by: Option<&Number>) -> Signal {
    let Some(by) = by.filter(|by| !by.is_zero()) else { return signal };
    match signal {
        Signal::Harmonic { value, frequency, phase, at } => {
            let turned = &(&(&Number::pi() * &Number::from(2)) * &frequency) * by;
            Signal::Harmonic { value, frequency, phase: &phase - &turned, at: &at + by }
        }
        of => Signal::Delayed { of: Box::new(of), by: by.clone() },
    }
}
