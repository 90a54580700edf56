//! Coordinates that move together, and paths from a noise to an output. In: a system. Out: its independent parts.

use crate::analysis::modes::parts::independent;
use crate::base::Number;
use crate::system::{CoordinateId, LinearSystem, Noise, Output};

/// The independent parts of a system: coordinates that move together.
pub struct Reach {
    /// The number of the part of each coordinate.
    pub part: Vec<usize>,
    pub count: usize,
}

impl Reach {
    pub fn of(system: &LinearSystem) -> Reach {
        let (mut part, parts) = (vec![0; system.n()], independent(system));
        for (number, found) in parts.iter().enumerate() {
            found.coordinates.iter().for_each(|&i| part[i as usize] = number);
        }
        Reach { part, count: parts.len() }
    }

    /// Whether terms or a direct path lead from an input that a noise drives to an output.
    pub fn from_noise(&self, system: &LinearSystem, noise: &Noise, output: &Output) -> bool {
        noise.inputs.iter().any(|(input, _)| self.from_input(system, *input, output))
    }

    /// Whether terms or a direct path lead from an input to an output.
    pub fn from_input(&self, system: &LinearSystem, input: usize, output: &Output) -> bool {
        let is_fed = output.d.iter().flatten().any(|(fed, factor)| *fed as usize == input && !factor.is_zero());
        is_fed || self.from_coordinates(system.inputs[input].b.iter().flatten(), output)
    }

    pub fn from_coordinates<'r>(
        &self,
        row: impl Iterator<Item = &'r (CoordinateId, Number)> + Clone,
        output: &Output,
    ) -> bool {
        let mut seen = output.p.iter().flatten().filter(|(_, factor)| !factor.is_zero());
        seen.any(|(i, _)| row.clone().any(|(j, _)| self.part[i.index()] == self.part[j.index()]))
    }

    /// The parts that inputs with noise move.
    pub fn driven(&self, system: &LinearSystem, noises: &[Noise]) -> Vec<bool> {
        let mut is_driven = vec![false; self.count];
        let inputs = noises.iter().flat_map(|noise| &noise.inputs);
        let moved = inputs.flat_map(|(input, _)| system.inputs[*input].b.iter().flatten());
        moved.for_each(|(i, _)| is_driven[self.part[i.index()]] = true);
        is_driven
    }

    /// Which of the given parts an output shows.
    pub fn shown_parts(&self, output: &Output, parts: &[bool]) -> Vec<bool> {
        let mut is_shown = vec![false; self.count];
        for (i, _) in output.p.iter().flatten().filter(|(_, factor)| !factor.is_zero()) {
            let part = self.part[i.index()];
            is_shown[part] = parts[part];
        }
        is_shown
    }

    /// Whether the initial state moves an output.
    pub fn from_start(&self, system: &LinearSystem, output: &Output) -> bool {
        let mut seen = output.p.iter().flatten();
        seen.any(|(i, _)| system.initial.iter().any(|(j, ..)| self.part[i.index()] == self.part[j.index()]))
    }
}
