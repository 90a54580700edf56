//! The deviation of nonlinear laws from their tangents in a motion. In: a scene, its linear system, signals, a time.
//! Out: for each law the largest stretch or rate that the linear motion reaches, and the difference between law and
//! tangent up to there: a note, or a warning above one percent. See docs/method/response.md#laws.

use crate::analysis::{Measurement, peak};
use crate::base::{Code, Diagnostic, Number};
use crate::lower::{LawAtRest, Lowered, Readout};
use crate::model::CheckedScene;
use crate::model::scene::{Motion, MotionTerm};
use crate::system::Signal;

const TANGENT: Code = Code::model("vib::law::tangent");

/// Maximum number of laws that are followed in one motion; each takes as long as a `peak`.
const MOST: usize = 32;
/// The largest relative difference that is only a note.
const SMALL: f64 = 0.01;

/// A finding for each law of the scene. The rows of `lowered` are written out.
pub fn beyond_tangents(
    scene: &CheckedScene,
    lowered: &Lowered,
    drives: &[Vec<Signal>],
    until: &Number,
) -> Vec<Diagnostic> {
    let scene = scene.scene();
    let laws = &lowered.rest.laws;
    if laws.is_empty() || !lowered.rest.is_proven() {
        return Vec::new();
    }
    let mut watched = lowered.clone();
    let first = watched.system.outputs.len();
    let readout = |law: &LawAtRest| {
        let motion = Motion::Stretch { element: law.element };
        Readout {
            terms: vec![MotionTerm { motion, coefficient: Number::ONE }],
            span: scene.elements[law.element.index()].span,
        }
    };
    if watched.add_readouts(scene, laws.iter().take(MOST).map(readout).collect()).is_err() {
        return Vec::new();
    }
    for (output, _) in watched.system.outputs[first..].iter_mut().zip(laws).filter(|(_, law)| law.is_of_rate()) {
        output.p.rotate_right(1);
        output.d.rotate_right(1);
    }
    let follow = |(place, law)| {
        let reached = peak::peak(&watched.system, drives, first + place, until);
        finding(scene, law, &reached)
    };
    let mut findings: Vec<Diagnostic> = laws.iter().take(MOST).enumerate().map(follow).collect();
    if let Some(next) = laws.get(MOST) {
        let span = scene.elements[next.element.index()].span;
        let message = format!("of {} laws, only the first {MOST} are compared with their tangents", laws.len());
        findings.push(Diagnostic::warning(TANGENT, span, message).label("this law and those after it are not"));
    }
    findings
}

/// The elements whose force is a law.
pub fn names_of_laws(scene: &CheckedScene) -> Vec<String> {
    let scene = scene.scene();
    let laws = scene.elements.iter().filter(|element| element.law.curve.is_some());
    laws.map(|element| scene.words.display(element.name)).collect()
}

/// A warning at the first law of a scene, in which all are named.
fn of_all(scene: &CheckedScene, message: impl Fn(&str) -> String) -> Option<Diagnostic> {
    const NAMED: usize = 5;
    let first = scene.scene().elements.iter().find(|element| element.law.curve.is_some())?;
    let names = names_of_laws(scene);
    let named: Vec<String> = names.iter().take(NAMED).map(|name| format!("`{name}`")).collect();
    let more = names.len().saturating_sub(NAMED);
    let more = if more > 0 { format!(" and {more} more") } else { String::new() };
    Some(Diagnostic::warning(TANGENT, first.span, message(&format!("{}{more}", named.join(", ")))))
}

/// The warning that emitted code uses the tangents instead of the laws.
pub fn laws_in_code(scene: &CheckedScene) -> Option<Diagnostic> {
    let warned =
        of_all(scene, |names| format!("this code follows the tangents at rest in place of the laws of {names}"))?;
    Some(warned.help("`vibc simulate` reports how far a motion leaves them"))
}

/// The warning that the deviation from the tangents is unbounded under noise.
pub fn laws_under_noise(scene: &CheckedScene) -> Option<Diagnostic> {
    let warned = of_all(scene, |names| {
        format!("how far the motion leaves the tangents of the laws of {names} is not known: noise acts")
    })?;
    Some(
        warned.help(
            "results are those of the tangents at rest; leave out `--seed` to compare them under the signals alone",
        ),
    )
}

fn finding(scene: &crate::model::scene::Scene, law: &LawAtRest, reached: &Measurement) -> Diagnostic {
    let element = &scene.elements[law.element.index()];
    let (name, keyword) = (scene.words.display(element.name), element.law.kind.keyword);
    let (variable, unit) = law.variable();
    let warned = |message: String| {
        Diagnostic::warning(TANGENT, element.span, message).help(
            "results are those of the tangents at rest; choose a smaller motion, or read them as a first estimate",
        )
    };
    let Measurement::Value(largest) = reached else {
        return warned(format!(
            "how far the motion of the {keyword} `{name}` leaves the tangent of its law is not known: its {variable} has no bound"
        ));
    };
    let size = largest.magnitude();
    if size == 0.0 {
        return Diagnostic::note(
            TANGENT,
            element.span,
            format!("the {keyword} `{name}` stays at rest, where its law and its tangent agree"),
        );
    }
    let reach =
        format!("the {variable} of the {keyword} `{name}` goes up to about {} {unit} from its rest", short(size));
    let Some(difference) = law.difference(size) else {
        return warned(format!("{reach}, where its law may have no value"));
    };
    let tangent = law.slope.to_ball().mignitude() * size;
    let share = difference / tangent;
    if share <= SMALL {
        let message =
            format!("{reach}, where its law and its tangent differ by up to about {} %", short(100.0 * share));
        return Diagnostic::note(TANGENT, element.span, message);
    }
    warned(match share.is_finite() {
        true => format!("{reach}, where its law and its tangent differ by up to about {} %", short(100.0 * share)),
        false => format!(
            "{reach}, where the tangent at rest has no force and the law {} {}",
            short(difference),
            law.force_unit()
        ),
    })
}

/// Two digits.
pub(super) fn short(value: f64) -> String {
    let rounded: f64 = format!("{value:.1e}").parse().unwrap_or(value);
    if (1e-3..1e5).contains(&rounded) { rounded.to_string() } else { format!("{value:.1e}") }
}
