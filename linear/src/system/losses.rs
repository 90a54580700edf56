//! Loss factors: in harmonic motion at the angular frequency omega > 0 a spring has the stiffness k (1 + i loss). At one
//! frequency it acts as a damper of k loss / omega beside it, so a system with loss factors is, at each frequency, one
//! without them. See docs/method/system.md#loss-factors.

use super::{CoordinateId, Form, LinearSystem};
use crate::base::Number;

/// Contributions of loss factors to a system: i H to K, i b to the columns of inputs, i p and i d to outputs.
#[derive(Clone, Debug, Default)]
pub struct Losses {
    pub h: Form,
    /// For each input.
    pub b: Vec<Vec<(CoordinateId, Number)>>,
    /// For each output.
    pub p: Vec<Vec<(CoordinateId, Number)>>,
    /// For each output, the inputs that it sees.
    pub d: Vec<Vec<(u32, Number)>>,
    /// What inputs that are velocities or accelerations do by what they are the rates of.
    pub by_rate: Vec<ByRate>,
}

/// The loss of the motion that a rate drives, i b and i d times the rate over a power of s: at 0 Hz it has no limit.
#[derive(Clone, Debug)]
pub struct ByRate {
    /// Index of the input that is the rate.
    pub input: u32,
    /// 1 or 2.
    pub power: u8,
    pub b: Vec<(CoordinateId, Number)>,
    /// Outputs that see it.
    pub d: Vec<(u32, Number)>,
}

impl Losses {
    /// Whether an input has no limit at 0 Hz.
    pub fn has_no_limit(&self, input: usize) -> bool {
        self.by_rate.iter().any(|part| part.input as usize == input)
    }
}

impl LinearSystem {
    /// The system without loss factors that has the same transfer functions at this angular frequency, rad/s.
    pub fn at_frequency(&self, omega: &Number) -> LinearSystem {
        let mut system = LinearSystem { losses: None, ..self.clone() };
        let (Some(losses), Some(factor)) = (&self.losses, omega.recip()) else { return system };
        for term in losses.h.terms() {
            let source = system.c.source(losses.h.source_of(term.source));
            system.c.push(source, term.nature, term.weight * &factor, losses.h.row(term).copies());
        }
        for (input, b) in system.inputs.iter_mut().zip(&losses.b) {
            input.undamped = None;
            add(&mut input.b[1], b, &factor);
        }
        for (output, (p, d)) in system.outputs.iter_mut().zip(losses.p.iter().zip(&losses.d)) {
            add(&mut output.p[1], p, &factor);
            add(&mut output.d[1], d, &factor);
        }
        for ByRate { input, power, b, d } in &losses.by_rate {
            // With s = i omega, i / s is 1 / omega, and i / s^2 is -s / omega^3.
            let (order, factor) = match power {
                1 => (0, factor.clone()),
                _ => (1, -&(&factor * &factor.square())),
            };
            add(&mut system.inputs[*input as usize].b[order], b, &factor);
            for (output, value) in d {
                add(&mut system.outputs[*output as usize].d[order], &[(*input, value.clone())], &factor);
            }
        }
        system
    }
}

/// Adds a factor times sparse entries; each index is there once.
fn add<Index: PartialEq + Copy>(row: &mut Vec<(Index, Number)>, entries: &[(Index, Number)], factor: &Number) {
    for (index, value) in entries {
        let value = value * factor;
        match row.iter_mut().find(|(known, _)| known == index) {
            Some((_, known)) => *known = &*known + &value,
            None => row.push((*index, value)),
        }
    }
}
