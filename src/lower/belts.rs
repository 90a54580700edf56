//! Belts of which a span pushes at rest. In: a mechanism at its rest. Out: a warning for each such belt, because results
//! take both spans to be tight. See spec.md#belts.

use super::error::four_digits;
use super::mechanism::Mechanism;
use super::rest::Rest;
use crate::base::{Code, Diagnostic, Name, Span};
use crate::elements::Acts;
use crate::model::scene::Scene;

const SLACK: Code = Code::model("vib::belt::slack");

/// Limit on the declarations that are reported one by one, as for parts without effect.
const SHOWN: usize = 100;

/// A declaration, and the span of its belts that pushes most.
struct Slack {
    span: Span,
    name: Name,
    /// N
    force: f64,
}

/// One finding for each place in the text. A span counts if it certainly pushes.
pub fn findings(scene: &Scene, mechanism: &Mechanism, rest: &Rest) -> Vec<Diagnostic> {
    if !scene.elements.iter().any(|element| element.law.kind.acts == Acts::RoundDisks) {
        return Vec::new();
    }
    let mut list: Vec<Slack> = Vec::new();
    for spring in mechanism.springs_at_rest(scene, rest) {
        let element = &scene.elements[spring.element.index()];
        if element.law.kind.acts != Acts::RoundDisks || !spring.tension.is_negative() {
            continue;
        }
        let found = Slack { span: element.span, name: element.name, force: -spring.tension.to_f64() };
        match list.iter().position(|known| known.span == found.span) {
            Some(place) if list[place].force < found.force => list[place] = found,
            None if list.len() < SHOWN => list.push(found),
            _ => {}
        }
    }
    let finding = |Slack { span, name, force }: &Slack| {
        let (name, force) = (scene.words.display(*name), four_digits(*force));
        let message = format!("the belt `{name}` is slack at rest: one of its spans pushes with {force} N");
        let help = "results are for spans that are tight: give the belt a `preload` that keeps both so";
        Diagnostic::warning(SLACK, *span, message).help(help)
    };
    list.iter().map(finding).collect()
}
