//! The signals of a scene's inputs as data of the linear system. In: a scene. Out: a sum of signals for each input, in
//! the order of the system's inputs. A table is interpolated linearly for a force, by a cubic spline for a base.
//! See docs/method/response.md.

use super::error::LowerError;
use crate::model::CheckedScene;
use crate::model::scene::{self, Input, InputKind};
use crate::system::Signal;

/// The signals that drive each input. A constant load is part of the rest and drives nothing.
pub fn drives(scene: &CheckedScene) -> Result<Vec<Vec<Signal>>, LowerError> {
    scene.scene().inputs.iter().map(of_input).collect()
}

fn of_input(input: &Input) -> Result<Vec<Signal>, LowerError> {
    let spline = matches!(input.kind, InputKind::Base { .. });
    input.signal.iter().filter_map(|signal| of_signal(signal, spline).transpose()).collect()
}

fn of_signal(signal: &scene::Signal, spline: bool) -> Result<Option<Signal>, LowerError> {
    let signal = signal.clone();
    Ok(Some(match signal {
        scene::Signal::Constant { .. } => return Ok(None),
        scene::Signal::Step { value, at } => Signal::Step { value, at },
        scene::Signal::Impulse { value, at } => Signal::Impulse { value, at },
        scene::Signal::Ramp { value, from, to } => Signal::Ramp { value, from, to },
        scene::Signal::Pulse { value, from, to } => Signal::Pulse { value, from, to },
        scene::Signal::Harmonic { value, frequency, phase } => Signal::Harmonic { value, frequency, phase },
        scene::Signal::Chirp { value, from, to, duration } => Signal::Chirp { value, from, to, duration },
        scene::Signal::Table { span, rows, .. } => match rows {
            Some(rows) => Signal::Table { times: rows.times.clone(), values: rows.values.clone(), spline },
            None => return Err(LowerError::TableUnread { span }),
        },
    }))
}
