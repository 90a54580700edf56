//! The velocity or acceleration of a base as the input of transfer tables. In: a model with its poles, and names such as
//! `quake.ax`. Out: the model with these inputs.

use crate::Dynamics;
use crate::analysis::rates::{Rate, with_rate};
use crate::analysis::{self, AnalysisError, Modes, Poles};
use crate::base::Diagnostic;
use crate::kinds::motions::rate_of;
use crate::system::LinearSystem;

/// A rate that cannot be an input, and why.
#[derive(Clone, Debug)]
pub enum NotDriven {
    /// The name of the rate, and the reason.
    Because(String, &'static str),
    Failed(Box<Diagnostic>),
}

impl Dynamics {
    /// The names of the velocities and accelerations of bases, and what they are.
    pub fn rates(&self) -> impl Iterator<Item = (String, Rate)> + '_ {
        self.bases.iter().flat_map(move |&(input, motion)| {
            [1, 2].into_iter().filter_map(move |derivative| {
                let word = rate_of(motion, derivative)?;
                let base = self.system.words.display(self.system.inputs[input].name.name);
                Some((format!("{base}.{word}"), Rate { input, derivative, word }))
            })
        })
    }

    /// The model with these rates as inputs behind its own.
    pub fn with_rates(mut self, rates: &[(String, Rate)]) -> Result<Dynamics, NotDriven> {
        let n = self.system.n();
        for (name, rate) in rates {
            self.system = with_rate(&self.system, *rate).map_err(|why| NotDriven::Because(name.clone(), why))?;
        }
        if self.system.n() > n && self.spectrum.is_some() {
            self.spectrum =
                spectrum(&self.system, None).map_err(|error| NotDriven::Failed(Box::new(error.to_diagnostic())))?;
        }
        Ok(self)
    }
}

/// The modes and poles that a table needs; `None` if there are too many coordinates, or the poles with
/// loss factors are not found.
pub(crate) fn spectrum(system: &LinearSystem, modes: Option<Modes>) -> Result<Option<(Modes, Poles)>, AnalysisError> {
    let both = modes.map_or_else(|| analysis::modes(system), Ok).and_then(|modes| {
        let poles = analysis::poles_for_table(system, &modes)?;
        Ok((modes, poles))
    });
    match both {
        Ok((_, poles)) if system.losses.is_some() && !poles.is_complete() => Ok(None),
        Ok(spectrum) => Ok(Some(spectrum)),
        Err(AnalysisError::TooManyCoordinates { .. } | AnalysisError::MasslessPoles { .. }) => Ok(None),
        Err(error) => Err(error),
    }
}
