//! The velocity or acceleration of a base as the input of transfer tables. In: a model with its modes, and names such as
//! `quake.ax`. Out: the model with these inputs, and the poles for a table of it.

use crate::Dynamics;
use crate::analysis::rates::{LOST, Rate, with_rate};
use crate::analysis::{self, AnalysisError, Modes, Poles, Request, Sweep, Table};
use crate::base::Diagnostic;
use crate::kinds::motions::rate_of;
use crate::system::LinearSystem;

/// A rate that cannot be an input, and why.
#[derive(Clone, Debug)]
pub enum NotDriven {
    /// The rate, as in a sentence, and the reason.
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
            self.system = with_rate(&self.system, *rate).map_err(|why| NotDriven::Because(format!("`{name}`"), why))?;
        }
        if self.system.n() > n && self.modes.is_some() {
            self.modes =
                modes(&self.system, None).map_err(|error| NotDriven::Failed(Box::new(error.to_diagnostic())))?;
        }
        Ok(self)
    }

    /// Why a table of these inputs has no values at 0 Hz, if it asks for them.
    pub fn without_limit(&self, sweep: &Sweep) -> Option<NotDriven> {
        let asks = sweep.at.iter().any(|at| at.hertz.is_zero())
            || sweep.range.as_ref().is_some_and(|(low, _)| low.is_zero() && sweep.at.is_empty());
        let losses = self.system.losses.as_ref().filter(|_| asks)?;
        let lost = sweep.inputs.iter().find(|&&input| losses.has_no_limit(input))?;
        Some(NotDriven::Because(format!("`{}` at 0 Hz", self.system.display(self.system.inputs[*lost].name)), LOST))
    }

    /// Warnings about values of a table that are not known to all digits.
    pub fn findings(&self, table: &Table, sweep: &Sweep) -> Vec<Diagnostic> {
        analysis::table_findings(&self.system, table, sweep.tolerance, &self.places)
    }

    /// The poles for a table, which are not computed where it has no use for them. `None` if there are too many coordinates, or the
    /// poles with loss factors are not found.
    pub fn poles_for(&self, sweep: &Sweep) -> Result<Option<Poles>, AnalysisError> {
        if !sweep.needs_poles() {
            return Ok(Some(Poles::default()));
        }
        let Some(modes) = &self.modes else { return Ok(None) };
        match analysis::poles_for_table(&self.system, modes) {
            Ok(poles) => Ok((self.system.losses.is_none() || poles.is_complete()).then_some(poles)),
            Err(AnalysisError::TooManyCoordinates { .. } | AnalysisError::MasslessPoles { .. }) => Ok(None),
            Err(error) => Err(error),
        }
    }
}

/// The modes of a table; `None` if there are too many coordinates.
pub(crate) fn modes(system: &LinearSystem, known: Option<Modes>) -> Result<Option<Modes>, AnalysisError> {
    match known.map_or_else(|| analysis::all_modes(system, &Request::default().without_shares()), Ok) {
        Ok(modes) => Ok(Some(modes)),
        Err(AnalysisError::TooManyCoordinates { .. }) => Ok(None),
        Err(error) => Err(error),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Overrides;
    use crate::analysis::{Frequency, Methods};
    use crate::base::{Number, SourceFile, Sources, runs};

    /// Poles are computed where a table needs them, once, and nowhere else.
    #[test]
    fn tables_at_given_frequencies_compute_no_poles() {
        let text = "body a { mass = 1 kg, moves x }\nspring s: ground -- a { k = 100 N/m }\ndamper d: ground -- a { c = 2 N*s/m }\n\
                    force F: a along x\noutput y = a.x";
        let hertz = |text: &str| Number::from(text);
        let range = Some((hertz("0.1"), hertz("10")));
        let every = Sweep { inputs: vec![0], outputs: vec![0], ..Sweep::default() };
        let at = Sweep { at: vec![Frequency::hertz(&hertz("1.5"))], ..every.clone() };
        let points = Sweep { range: range.clone(), points: Some(12), ..every.clone() };
        let without = Sweep { range, ..every.clone() };
        let grid = Sweep { points: Some(12), ..every.clone() };
        for (sweep, expected) in [(at, 0), (points, 0), (every, 1), (without, 1), (grid, 1)] {
            let stages = runs::stages_of(|| {
                let mut sources = Sources::new();
                let model = sources.add(SourceFile::model("one.vib", text));
                let dynamics = crate::dynamics(&sources, model, &Overrides::default()).answer.expect("a model");
                let poles = dynamics.poles_for(&sweep).expect("no error").expect("few coordinates");
                let methods = Methods::of(&dynamics.system, dynamics.modes.as_ref().expect("modes"));
                for row in analysis::table(&methods, &poles, &sweep).expect("a small table").rows {
                    let omega = 2.0 * std::f64::consts::PI * row.frequency.to_f64();
                    let gain = row.gains[0][0].disc().expect("finite").gain().to_f64();
                    let truth = 1.0 / ((100.0 - omega * omega).powi(2) + (2.0 * omega).powi(2)).sqrt();
                    assert!((gain / truth - 1.0).abs() < 1e-13, "{gain} {truth}");
                }
            });
            assert_eq!(stages.iter().filter(|stage| **stage == "poles").count(), expected, "{sweep:?}");
        }
    }
}
