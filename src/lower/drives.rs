//! The signals of a scene's inputs as data of the linear system. In: a scene; out: a sum of signals for each input, in the
//! order of the system's inputs. Clause: spec.md, "Response".

use super::error::LowerError;
use crate::model::CheckedScene;
use crate::model::scene::{self, Input};
use crate::system::Signal;

/// What drives each input. A constant load is part of the rest and drives nothing.
pub fn drives(scene: &CheckedScene) -> Result<Vec<Vec<Signal>>, LowerError> {
    scene.scene().inputs.iter().map(of_input).collect()
}

fn of_input(input: &Input) -> Result<Vec<Signal>, LowerError> {
    input.signal.iter().filter_map(|signal| of_signal(signal).transpose()).collect()
}

fn of_signal(signal: &scene::Signal) -> Result<Option<Signal>, LowerError> {
    let signal = signal.clone();
    Ok(Some(match signal {
        scene::Signal::Constant { .. } => return Ok(None),
        scene::Signal::Step { value, at } => Signal::Step { value, at },
        scene::Signal::Impulse { value, at } => Signal::Impulse { value, at },
        scene::Signal::Ramp { value, from, to } => Signal::Ramp { value, from, to },
        scene::Signal::Pulse { value, from, to } => Signal::Pulse { value, from, to },
        scene::Signal::Harmonic { value, frequency, phase } => Signal::Harmonic { value, frequency, phase },
        scene::Signal::Chirp { value, from, to, duration } => Signal::Chirp { value, from, to, duration },
        scene::Signal::Table { span, .. } => {
            return Err(LowerError::NotAvailable { what: "a table as a signal", span });
        }
    }))
}
