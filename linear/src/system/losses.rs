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
}

impl LinearSystem {
    /// The system without loss factors that has the same transfer functions at this angular frequency, rad/s.
    pub fn at_frequency(&self, omega: &Number) -> LinearSystem {
        let mut system = LinearSystem { losses: None, ..self.clone() };
        let (Some(losses), Some(factor)) = (&self.losses, omega.recip()) else { return system };
        for term in losses.h.terms() {
            let source = system.c.source(losses.h.source_of(term.source));
            system.c.push(source, term.nature, &term.weight * &factor, losses.h.row(term).iter().cloned());
        }
        for (input, b) in system.inputs.iter_mut().zip(&losses.b) {
            input.undamped = None;
            add(&mut input.b[1], b, &factor);
        }
        for (output, (p, d)) in system.outputs.iter_mut().zip(losses.p.iter().zip(&losses.d)) {
            add(&mut output.p[1], p, &factor);
            add(&mut output.d[1], d, &factor);
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
