//! The page beside a text: the moving figure, rest, modes and poles of the last version without errors, and the
//! findings in the present one.

use super::document::{Document, request};
use crate::analysis::{self, Modal, Poles};
use crate::lower;
use crate::overview::{self, Lowered, Overview, Shown};

/// The page; `None` if the scene is too large to compute modes between two keystrokes.
pub fn page(document: &Document) -> Option<String> {
    let newer = (&document.sources, document.file);
    let shown = Shown { newer: Some(newer), findings: &document.findings, without_text: true, ..Shown::default() };
    let Some(known) = &document.known else {
        return Some(overview::page_of_errors("no figure yet", newer, &shown));
    };
    let motions = known.motions.as_ref()?;
    let computed;
    let modal = match &motions.modal {
        Some(modal) => modal,
        None if motions.system.c.is_empty() => {
            computed = analysis::modal_from(&motions.system, Some(&motions.modes), &request()).ok()?;
            &computed
        }
        // The figure moves at once; the poles come with the results of the second thread.
        None => {
            let poles = Poles { left_out: 2 * motions.system.n(), ..Poles::default() };
            let stability = analysis::stability(&motions.system, &motions.modes, &poles);
            computed = Modal { modes: motions.modes.clone(), poles, stability };
            &computed
        }
    };
    let (noises, spectra) = match motions.rest.is_proven() {
        true => (lower::noises(&known.scene), lower::spectra(&known.scene)),
        false => Default::default(),
    };
    let noisy = analysis::random::outputs(&motions.system, &modal.modes, &modal.poles, &noises);
    let added = analysis::response_spectrum::Additions::default();
    let spectral = analysis::response_spectrum::maxima(&motions.system, &modal.modes, &spectra, added);
    let overview = Overview::of_lowered(Lowered {
        scene: known.scene.scene(),
        system: &motions.system,
        rest: &motions.rest,
        mechanism: &motions.mechanism,
        modal,
        solved: if document.is_current { &document.solved } else { &[] },
        optimised: if document.is_current { &document.optimised } else { &[] },
        noisy,
        spectral,
        requirements: if document.is_current { &document.requirements } else { &[] },
    });
    Some(overview.page((&known.sources, document.file), &shown))
}
