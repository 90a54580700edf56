//! Shock response spectra of the bases of a model that is read.

use crate::analysis;
use crate::answers::{Shock, ShockOf};
use crate::base::Diagnostics;
use crate::dynamics;
use crate::model::scene::{Input, InputKind, Signal};
use crate::reading::Reading;
use std::fmt::Display;

/// The spectra of the bases with these names, or of all that have a signal; the inner error says why there is none.
pub fn of_bases(
    reading: &Reading,
    from: &[String],
    request: &analysis::shock::Request,
    diagnostics: &mut Diagnostics,
) -> Option<Result<Shock, String>> {
    let scene = reading.scene.scene();
    let bases: Vec<(String, &Input)> = (scene.inputs.iter())
        .filter(|input| matches!(input.kind, InputKind::Base { .. }))
        .map(|input| (scene.words.display(input.name), input))
        .collect();
    let chosen: Vec<&(String, &Input)> = match from {
        [] => bases.iter().filter(|(_, input)| !input.signal.is_empty()).collect(),
        names => {
            let found = names.iter().map(|name| bases.iter().find(|(base, _)| base == name).ok_or(name));
            match found.collect() {
                Ok(found) => found,
                Err(name) => return Some(Err(no_base(name, &bases))),
            }
        }
    };
    if chosen.is_empty() {
        return Some(Err("no base of the model has a signal, whose shock response spectrum it would be".into()));
    }
    let mut list = Vec::new();
    for (name, input) in chosen {
        let refused = |why: &dyn Display| Some(Err(format!("no shock response spectrum of `{name}`: {why}")));
        if input.signal.iter().any(Signal::has_noise) {
            return refused(&"noise has no time history");
        }
        if input.signal.iter().any(|signal| matches!(signal, Signal::Spectrum(_))) {
            return refused(&"its signal is a response spectrum already");
        }
        let signals = dynamics::declared_signals(input, diagnostics)?;
        let turns = matches!(input.kind, InputKind::Base { translation: None, .. });
        match analysis::shock::shock(&signals, input.derivative, request) {
            Ok(spectrum) => list.push(ShockOf::new(name.clone(), turns, spectrum)),
            Err(why) => return refused(&why),
        }
    }
    Some(Ok(Shock::new(reading.name(), list)))
}

/// That no base has this name, and which there are.
fn no_base(name: &str, bases: &[(String, &Input)]) -> String {
    const MOST: usize = 8;
    let known: Vec<String> = bases.iter().take(MOST).map(|(base, _)| format!("`{base}`")).collect();
    let more = if bases.len() > MOST { ", ..." } else { "" };
    match known.is_empty() {
        true => format!("`{name}` is not a base of the model; it has none"),
        false => format!("`{name}` is not a base of the model; it has {}{more}", known.join(", ")),
    }
}
