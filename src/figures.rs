//! The figure of a model that is read: as drawn, at rest, or in a mode.

use crate::analysis::{self, Request, Which};
use crate::base::{Diagnostics, Number};
use crate::lower::Lowered;
use crate::reading::Reading;
use crate::{FigureOptions, backend, dynamics, picture, push_error};

/// Digits of values in figures.
const FIGURE_DIGITS: usize = 4;

/// The figure; the inner error says why there is none.
pub fn figure(
    reading: &Reading,
    drawn: &FigureOptions,
    diagnostics: &mut Diagnostics,
) -> Option<Result<picture::Figure, String>> {
    let figure = |shown| {
        let digits = |number: &Number| backend::decimal::certain_whole(number, FIGURE_DIGITS);
        let request = picture::Request { digits: &digits, values: drawn.values, shown };
        picture::figure(reading.scene.scene(), &request).map_err(|refusal| refusal.to_string())
    };
    if !drawn.rest && drawn.mode.is_none() {
        return Some(figure(picture::Shown::AsDrawn));
    }
    let Lowered { system, mechanism, rest } = dynamics::lower_undamped(&reading.scene, diagnostics)?;
    let Some(wanted) = drawn.mode else {
        return Some(figure(picture::Shown::AtRest(&mechanism.poses())));
    };
    let request = Request { which: Which::Lowest(wanted as usize), ..Request::default() };
    let modes =
        analysis::modes_as(&system, &request).or_else(|error| push_error(&error, diagnostics).ok_or(())).ok()?;
    let Some((_, mode)) = modes.with_numbers().find(|(number, _)| *number == wanted as usize) else {
        return Some(Err(format!("the model has no mode {wanted}; it has {}", modes.list.len())));
    };
    let shape = analysis::normalise(mode, analysis::Normalise::Translation);
    let shape: Vec<f64> = shape.iter().map(|displacement| displacement.0).collect();
    let at_rest = mechanism.poses();
    let poses = at_rest.displace(&mechanism.displacements(&at_rest, &shape));
    let caption = backend::draw::mode_caption(wanted, mode, rest.is_proven());
    let does = |name| backend::draw::energy_of(mode, name);
    Some(figure(picture::Shown::Mode(picture::ModeShown { poses: &poses, caption, does: &does })))
}
