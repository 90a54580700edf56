//! Springs, dampers and inputs without effect. In: the items that contribute nothing to the assembled system. Out: a
//! warning for each declaration, which says how it was read. See spec.md#springs-and-dampers.

use super::assembly::Idle;
use super::kinematics::Kinematics;
use crate::base::{Code, Diagnostic, Span, Vec3};
use crate::model::scene::{Element, Geometry, Input, InputKind, Scene};
use std::collections::HashSet;

const ELEMENT: Code = Code::model("vib::unused::element");
const NO_TANGENT: Code = Code::model("vib::law::no_tangent");
const INPUT: Code = Code::model("vib::unused::input");

/// Limit on the declarations that are reported one by one: a `repeat` may make a million without effect, and one of
/// them represents all.
const SHOWN: usize = 100;

/// One finding for each place in the text.
pub fn findings(scene: &Scene, kinematics: &Kinematics, idle: &[Idle]) -> Vec<Diagnostic> {
    let mut reported: HashSet<Span> = HashSet::new();
    let mut findings = Vec::new();
    for idle in idle {
        let span = match idle {
            Idle::Element(number) | Idle::Flat(number) => scene.elements[*number].span,
            Idle::Input(number) => scene.inputs[*number].span,
        };
        if findings.len() == SHOWN || !reported.insert(span) {
            continue;
        }
        findings.extend(match idle {
            Idle::Element(number) => Some(element(scene, kinematics, &scene.elements[*number])),
            Idle::Input(number) => input(scene, &scene.inputs[*number]),
            Idle::Flat(number) => Some(flat(scene, &scene.elements[*number])),
        });
    }
    findings
}

fn flat(scene: &Scene, element: &Element) -> Diagnostic {
    let name = scene.words.display(element.name);
    let message =
        format!("the tangent of the law of `{name}` is zero at rest: linear motions about the rest do not feel it");
    Diagnostic::warning(NO_TANGENT, element.span, message)
        .help("results are for small motions; preload the spring, or give its law a part in proportion to `stretch`")
}

fn element(scene: &Scene, kinematics: &Kinematics, element: &Element) -> Diagnostic {
    let kind = element.law.kind;
    let [a, b] = [0, 1].map(|end| kinematics.end(&element.ends[end]).piece);
    let turns = [a, b].iter().any(|piece| kinematics.angle(*piece).is_some());
    let on_turning = format!(
        "name the points at its ends, as in `wheel@(0, 0.1 m)`; {} in {} acts on rotation",
        kind.coefficient().expected_number(true).noun,
        kind.unit(true)
    );
    let (read, help) = match &element.law.geometry {
        _ if a == b => ("between two points of one rigid body".into(), "attach one end to another part"),
        Geometry::Along(direction) => (
            format!(
                "along {}, but no motion moves its ends relative to each other in that direction",
                direction_text(direction)
            ),
            "let it act along a motion of its ends: `along = x`",
        ),
        Geometry::Torsion => ("on rotation, but no motion rotates its ends relative to each other".into(), "remove it"),
        Geometry::Line | Geometry::Span(_) => (
            "along the line between its ends, but no small motion changes their distance".into(),
            match (turns, kind.is_elastic()) {
                (true, _) => on_turning.as_str(),
                (false, true) => "a `preload` lets it restrain motions across it, `along = y` lets it act along them",
                (false, false) => "let it act along a motion of its ends: `along = y`",
            },
        ),
    };
    let message = format!("the {} `{}` has no effect: it acts {read}", kind.keyword, scene.words.display(element.name));
    Diagnostic::warning(ELEMENT, element.span, message).help(help)
}

fn input(scene: &Scene, input: &Input) -> Option<Diagnostic> {
    let (what, read, help) = match &input.kind {
        InputKind::Force { direction, .. } => (
            "force",
            format!("it acts along {}, but no motion moves its ends in that direction", direction_text(direction)),
            "let it act along a motion of its body: `along x`",
        ),
        InputKind::ForceBetween { .. } => (
            "force",
            "it acts along the line between its ends, but no small motion changes their distance".into(),
            "name points that move relative to each other",
        ),
        // A part often moves along one of both axes alone.
        InputKind::Unbalance { .. } => return None,
        InputKind::Torque { .. } => ("torque", "no motion turns its body".into(), "let it act on a body that turns"),
        // A base motion that nothing is attached to is a support that is not used yet, unless a signal moves it.
        InputKind::Base { .. } if input.signal.is_empty() => return None,
        InputKind::Base { .. } => (
            "motion of the base",
            "no element with a coefficient other than zero attaches a moving part to it in this direction".into(),
            "attach a spring or damper that acts along the motion of the base",
        ),
    };
    let message = format!("the {what} `{}` has no effect: {read}", scene.words.display(input.name));
    Some(Diagnostic::warning(INPUT, input.span, message).help(help))
}

/// `x`, `y` or the components of a direction, to three digits.
fn direction_text(direction: &Vec3) -> String {
    let (x, y) = (direction.x.to_f64(), direction.y.to_f64());
    let digits = |value: f64| format!("{value:.2e}").parse::<f64>().unwrap_or(value).to_string();
    match (x, y) {
        (_, 0.0) => "x".into(),
        (0.0, _) => "y".into(),
        _ => format!("({}, {})", digits(x), digits(y)),
    }
}
