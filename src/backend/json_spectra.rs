//! Maxima under response spectra as JSON. See docs/method/response_spectra.md.

use super::json_number::{Bounds, JsonNumber};
use crate::analysis::response_spectrum::{Direction, Maximum};
use crate::answers::ModalAnswer;
use crate::base::Ball;

#[derive(serde::Serialize)]
pub(super) struct JsonSpectral {
    missing_mass_added: bool,
    damping_corrected: bool,
    directions: Vec<JsonDirection>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    across_directions: Vec<JsonAcross>,
}

/// A direction without maxima has a reason alone.
#[derive(serde::Serialize)]
struct JsonDirection {
    input: String,
    reason: Option<String>,
    damping_ratio: JsonNumber,
    rigid_from_hz: JsonNumber,
    rigid_acceleration: JsonNumber,
    total_mass: JsonNumber,
    missing_mass: JsonNumber,
    missing_mass_error_bound: JsonNumber,
    corrected_modes: Vec<JsonCorrected>,
    outputs: Vec<JsonMaximum>,
}

/// A mode with another damping ratio than the spectrum; bounds are relative.
#[derive(serde::Serialize)]
struct JsonCorrected {
    mode: usize,
    damping_ratio: JsonNumber,
    damping_ratio_error_bound: JsonNumber,
    factor: JsonNumber,
    factor_error_bound: JsonNumber,
}

/// Bounds are relative, but for `missing_error_bound`.
#[derive(serde::Serialize)]
struct JsonMaximum {
    output: String,
    unit: String,
    of: Option<&'static str>,
    reason: Option<&'static str>,
    srss: JsonNumber,
    srss_error_bound: JsonNumber,
    cqc: JsonNumber,
    cqc_error_bound: JsonNumber,
    missing: JsonNumber,
    missing_error_bound: JsonNumber,
}

#[derive(serde::Serialize)]
struct JsonAcross {
    output: String,
    unit: String,
    srss: JsonNumber,
    srss_error_bound: JsonNumber,
    cqc: JsonNumber,
    cqc_error_bound: JsonNumber,
}

impl JsonSpectral {
    /// The answer as JSON; `None` for a model without spectra.
    pub fn of(answer: &ModalAnswer, bounds: Bounds) -> Option<JsonSpectral> {
        let spectral = &answer.spectral;
        let directions = spectral.directions.iter().map(|(input, found)| {
            let input = answer.system.display(answer.system.inputs[*input].name);
            match found {
                Ok(found) => direction(answer, input, found, bounds),
                Err(reason) => JsonDirection {
                    input,
                    reason: Some(reason.clone()),
                    damping_ratio: JsonNumber::NULL,
                    rigid_from_hz: JsonNumber::NULL,
                    rigid_acceleration: JsonNumber::NULL,
                    total_mass: JsonNumber::NULL,
                    missing_mass: JsonNumber::NULL,
                    missing_mass_error_bound: JsonNumber::NULL,
                    corrected_modes: Vec::new(),
                    outputs: Vec::new(),
                },
            }
        });
        let across = spectral.across.iter().map(|(output, [srss, cqc])| {
            let output = &answer.system.outputs[*output];
            JsonAcross {
                output: answer.system.display(output.name),
                unit: output.unit.clone(),
                srss: JsonNumber::from_enclosure(*srss),
                srss_error_bound: bounds.relative(*srss),
                cqc: JsonNumber::from_enclosure(*cqc),
                cqc_error_bound: bounds.relative(*cqc),
            }
        });
        (!spectral.directions.is_empty()).then(|| JsonSpectral {
            missing_mass_added: spectral.added.missing_mass,
            damping_corrected: spectral.added.other_damping,
            directions: directions.collect(),
            across_directions: across.collect(),
        })
    }
}

fn direction(answer: &ModalAnswer, input: String, direction: &Direction, bounds: Bounds) -> JsonDirection {
    let outputs = direction.outputs.iter().map(|(output, found)| {
        let output = &answer.system.outputs[*output];
        let value = |of: fn(&Maximum) -> Ball| found.as_ref().ok().map(of);
        let enclosed = |of: fn(&Maximum) -> Ball| JsonNumber::of(value(of));
        let relative = |of: fn(&Maximum) -> Ball| value(of).map_or(JsonNumber::NULL, |value| bounds.relative(value));
        JsonMaximum {
            output: answer.system.display(output.name),
            unit: output.unit.clone(),
            of: found.as_ref().ok().map(|maximum| maximum.of.name()),
            reason: found.as_ref().err().copied(),
            srss: enclosed(|maximum| maximum.srss),
            srss_error_bound: relative(|maximum| maximum.srss),
            cqc: enclosed(|maximum| maximum.cqc),
            cqc_error_bound: relative(|maximum| maximum.cqc),
            missing: enclosed(|maximum| maximum.missing),
            missing_error_bound: value(|maximum| maximum.missing)
                .map_or(JsonNumber::NULL, |value| bounds.absolute(value)),
        }
    });
    let corrected = direction.corrected.iter().map(|corrected| JsonCorrected {
        mode: corrected.mode,
        damping_ratio: JsonNumber::from_enclosure(corrected.damping),
        damping_ratio_error_bound: bounds.relative(corrected.damping),
        factor: JsonNumber::from_enclosure(corrected.factor),
        factor_error_bound: bounds.relative(corrected.factor),
    });
    JsonDirection {
        input,
        reason: None,
        damping_ratio: JsonNumber::number(&direction.damping),
        rigid_from_hz: JsonNumber::number(&direction.rigid_from),
        rigid_acceleration: JsonNumber::from_enclosure(direction.rigid),
        total_mass: JsonNumber::from_enclosure(direction.total),
        missing_mass: JsonNumber::from_enclosure(direction.missing),
        missing_mass_error_bound: bounds.absolute(direction.missing),
        corrected_modes: corrected.collect(),
        outputs: outputs.collect(),
    }
}
