//! The modal report as text: what the scene does first, then the numbers, each with its unit, its settled digits and the
//! bound of its error. About a hundred columns wide; plain characters and no colour, so that a file holds what a screen
//! shows. Clause: spec.md, "Report".

mod matrices;
mod modes;
mod poles;
mod rest;
pub(super) mod table;

use super::{ModalAnswer, ReportOptions};
use crate::analysis::{ModeKind, Share, Stability};
use crate::system::{CoordinateKind, LinearSystem};

/// Columns that a report fills at most, long names aside.
const WIDTH: usize = 100;
/// Space before each line below the title.
const INDENT: usize = 2;

/// The report, ending in a line feed.
pub fn text(answer: &ModalAnswer, options: &ReportOptions) -> String {
    let sections = [
        rest::text(answer),
        matrices::text(answer, options),
        modes::table(answer, options),
        modes::shares(answer),
        poles::text(answer),
    ];
    let mut text = title(answer) + "\n";
    for section in sections.iter().filter(|section| !section.is_empty()) {
        text.push('\n');
        text += section;
    }
    text
}

/// `cart · 2 freedoms, linearised about a stable rest`
fn title(answer: &ModalAnswer) -> String {
    let n = answer.system.n();
    let freedoms = if n == 1 { "1 freedom".to_string() } else { format!("{n} freedoms") };
    let verdict = match answer.stability {
        Stability::Stable => "a stable rest",
        Stability::Neutral => "a neutral rest",
        Stability::Unstable => "an UNSTABLE rest",
    };
    let rigid = answer.modes.list.iter().filter(|mode| mode.kind == ModeKind::Rigid).count();
    let left = match rigid {
        0 => String::new(),
        1 => " · 1 rigid motion".to_string(),
        _ => format!(" · {rigid} rigid motions"),
    };
    format!("{} · {freedoms}, linearised about {verdict}{left}", answer.model)
}

/// A line of text of a section.
fn line(text: impl AsRef<str>) -> String {
    format!("{:INDENT$}{}\n", "", text.as_ref())
}

fn unit(kind: CoordinateKind) -> &'static str {
    match kind {
        CoordinateKind::Translation => "m",
        CoordinateKind::Rotation => "rad",
    }
}

/// The largest shares, by name: `block.x 61 %, rod.angle 39 %`, and what is left of them.
fn largest_shares<T: Copy>(shares: &[Share<T>], name: impl Fn(T) -> String) -> String {
    /// What is shown until the shares cover this much, or until there are so many.
    const COVERED: f64 = 0.98;
    const MOST: usize = 4;
    let mut shown = Vec::new();
    let mut covered = 0.0;
    for share in shares.iter().take(MOST).take_while(|share| share.part.abs() >= 0.005) {
        if covered >= COVERED {
            break;
        }
        covered += share.part;
        shown.push(format!("{} {:.0} %", name(share.of), 100.0 * share.part));
    }
    let left = shares.len() - shown.len();
    if left > 0 && (1.0 - covered).abs() >= 0.005 {
        shown.push(format!("{left} more {:.0} %", 100.0 * (1.0 - covered)));
    }
    shown.join(", ")
}

/// The coordinates that carry a mode.
fn carried_by(system: &LinearSystem, mode: &crate::analysis::Mode) -> String {
    largest_shares(&mode.kinetic, |of| system.display(system.coordinates[of.index()].name))
}

#[cfg(test)]
mod tests {
    use super::super::{ReportOptions, samples};
    use super::text;
    use crate::analysis::Normalise;

    #[test]
    fn a_stable_scene() {
        insta::assert_snapshot!(text(&samples::cart(), &ReportOptions::default()));
    }

    #[test]
    fn a_rigid_motion_is_named() {
        let options = ReportOptions { normalise: Normalise::Mass, matrices: false };
        insta::assert_snapshot!(text(&samples::free_pair(), &options));
    }

    #[test]
    fn an_unstable_rest_is_said_loudly() {
        insta::assert_snapshot!(text(&samples::upright_rod(), &ReportOptions::default()));
    }
}
