//! The modal report of a model that is read, with what was asked of it besides.

use crate::Study;
use crate::analysis::{self, Mode, ModeKind, Modes, Request};
use crate::answers::ModalAnswer;
use crate::base::Diagnostics;
use crate::dynamics::{self, Damped, WrittenOut};
use crate::lower::{self, Lowered, Mechanism, ShapeNode};
use crate::model::scene::{Input, InputKind, Scene};
use crate::questions;
use crate::reading::Reading;
use crate::system::LinearSystem;

/// The modal report of a model. If there is none, its system is returned.
pub fn modal_answer(
    reading: &mut Reading,
    mut damped: Damped,
    request: &Request,
    study: &Study,
    diagnostics: &mut Diagnostics,
) -> Result<ModalAnswer, Box<Damped>> {
    let Some(analysis::Modal { modes, poles, stability }) = damped.modal(request, diagnostics) else {
        return Err(Box::new(damped));
    };
    let known = WrittenOut { lowered: damped.lowered, modes: None };
    let requirements = match known.lowered.system.is_chained() && !reading.scene.scene().requires.is_empty() {
        false => reading.requirements(Some(&known), Some((&modes, &poles)), diagnostics),
        true => {
            // Requirements are measured over the coordinates alone.
            let mut flat = known.clone();
            let flat = flat.lowered.flatten().is_ok().then_some(&flat);
            reading.requirements(flat, Some((&modes, &poles)), diagnostics)
        }
    };
    let Lowered { system, rest, mechanism } = known.lowered;
    // About a rest that is not proven no number would have a bound.
    let noises = if rest.is_proven() { dynamics::noises(&reading.scene) } else { Vec::new() };
    let noisy = analysis::random::outputs(&system, &modes, &poles, &noises);
    let spectra = if rest.is_proven() { dynamics::spectra(&reading.scene) } else { Vec::new() };
    let spectral = analysis::response_spectrum::maxima(&system, &modes, &spectra, study.spectra);
    let sensitivities = match study.sensitivity {
        true => questions::sensitivities(&reading.text(), &reading.settings, request, (&system, &rest), &modes, &poles),
        false => Vec::new(),
    };
    let tolerated = match study.tolerances {
        true => {
            let of = (&reading.scene, system.n());
            questions::tolerated::within_tolerances(&reading.text(), of, &reading.settings, study.robust)
        }
        false => None,
    };
    let excitations = match study.participation {
        true => excitations(reading.scene.scene(), &system, &modes, rest.is_proven()),
        false => Vec::new(),
    };
    // About a rest that is not proven no shape would have a bound.
    let damped_shapes = match study.damped_shapes && rest.is_proven() {
        true => analysis::damped_shapes(&system, &poles),
        false => Vec::new(),
    };
    let nodes = match study.nodes {
        true => modes.list.iter().map(|mode| nodes(reading.scene.scene(), &mechanism, mode)).collect(),
        false => Vec::new(),
    };
    if let Some(shortfall) = analysis::shortfall(&system, &modes, &poles, request) {
        diagnostics.push(shortfall.to_diagnostic());
    }
    let (model, buckling) = (reading.name(), analysis::buckling(&system));
    Ok(ModalAnswer {
        model,
        system,
        rest,
        modes,
        poles,
        stability,
        buckling,
        solved: reading.solved.clone(),
        optimised: reading.optimised.clone(),
        requirements,
        noisy,
        spectral,
        sensitivities,
        tolerated,
        excitations,
        damped_shapes,
        nodes,
        account: None,
    })
}

/// The points of turning bodies that stay in place in a mode; none if its shape is not determined by itself.
fn nodes(scene: &Scene, mechanism: &Mechanism, mode: &Mode) -> Vec<ShapeNode> {
    let has_shape = matches!(mode.kind, ModeKind::Oscillation | ModeKind::Divergence) && mode.cluster.is_none();
    match has_shape {
        true => lower::nodes(scene, mechanism, &analysis::normalise(mode, analysis::Normalise::Max)),
        false => Vec::new(),
    }
}

/// The modes that each motion of a base excites, or the reason why they are not known.
fn excitations(
    scene: &Scene,
    system: &LinearSystem,
    modes: &Modes,
    proven: bool,
) -> Vec<(usize, Result<analysis::Excitation, &'static str>)> {
    let is_base = |input: &Input| matches!(input.kind, InputKind::Base { .. });
    let bases: Vec<usize> = (0..scene.inputs.len()).filter(|input| is_base(&scene.inputs[*input])).collect();
    let all = match (bases.is_empty(), proven) {
        (true, _) => return Vec::new(),
        (_, false) => Err("the rest about which they would be measured is not proven"),
        (_, true) => analysis::Excitations::of(system, modes),
    };
    let by = |input: &usize| (*input, all.as_ref().map_err(|why| *why).and_then(|all| all.by(*input)));
    bases.iter().map(by).collect()
}
