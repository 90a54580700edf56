//! The modal report as text: what the scene does first, then the numbers, each with its unit, its settled digits and the
//! bound of its error. About a hundred columns wide; plain characters and no colour, so that a file holds what a screen
//! shows. See docs/method/report.md.

mod matrices;
mod modes;
mod parts;
mod poles;
pub(super) mod questions;
mod rest;
mod sensitivities;
pub(super) mod table;

use super::ReportOptions;
use super::diagnostics::readable;
use crate::analysis::{ModeKind, Share, Stability};
use crate::answers::ModalAnswer;
use crate::lower::Account;
use crate::questions::answer::Requirement;
use crate::system::{CoordinateKind, LinearSystem};

/// Columns that a report fills at most, long names aside.
const WIDTH: usize = 100;
/// Space before each line below the title.
const INDENT: usize = 2;

/// The report, ending in a line feed.
pub fn text(answer: &ModalAnswer, options: &ReportOptions) -> String {
    let sections = [
        questions::solved(&answer.solved),
        questions::requirements(&answer.requirements),
        rest::text(answer, options),
        matrices::text(answer, options),
        modes::table(answer, options),
        modes::shares(answer),
        poles::text(answer, options),
        sensitivities::text(answer),
        parts::parts(answer),
        answer.account.as_ref().map_or_else(String::new, |account| parts::explained(account, &answer.system)),
    ];
    let mut text = title(answer) + "\n";
    for section in sections.iter().filter(|section| !section.is_empty()) {
        text.push('\n');
        text += section;
    }
    text
}

/// How the requirements of a file stand, below its name; nothing where it has none.
pub fn requirements(file: &str, list: &[Requirement]) -> String {
    questions::checked(&readable(file), list)
}

/// What was kept of a model and what was left out, where there is no more to report.
pub fn explanation(model: &str, account: &Account, system: &LinearSystem) -> String {
    format!("{}\n\n{}", readable(model), parts::explanation(account, system))
}

/// `cart · 2 freedoms, linearised about a stable rest`
fn title(answer: &ModalAnswer) -> String {
    let n = answer.system.n();
    let freedoms = if n == 1 { "1 freedom".to_string() } else { format!("{n} freedoms") };
    let verdict = match answer.stability.kind() {
        Stability::Stable => "a stable rest",
        Stability::Neutral => "a neutral rest",
        Stability::Unstable => "an UNSTABLE rest",
        Stability::Undetermined => "a rest of UNDETERMINED stability",
    };
    let rigid =
        answer.modes.list.iter().filter(|mode| mode.kind == ModeKind::Rigid).count() + answer.modes.before.rigid;
    let left = match rigid {
        0 => String::new(),
        1 => " · 1 rigid motion".to_string(),
        _ => format!(" · {rigid} rigid motions"),
    };
    format!("{} · {freedoms}, linearised about {verdict}{left}", readable(&answer.model))
}

/// `1 mode`, `3 modes`
fn counted(count: usize, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
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
    /// Named until the shares cover this much.
    const COVERED: f64 = 0.98;
    /// ... or until there is no room for more.
    const ROOM: usize = 32;
    /// Where no share reaches this much, naming a few of them says nothing.
    const WORTH_NAMING: f64 = 0.05;
    let told = |share: &Share<T>| format!("{} {}", name(share.of), percent(share.part.0));
    if let Some(largest) = shares.first().filter(|share| share.part.0.abs() < WORTH_NAMING) {
        return format!("spread over {}, most on {}", shares.len(), told(largest));
    }
    let mut text = String::new();
    let mut covered = 0.0;
    let mut rest = shares;
    while let Some((share, others)) = rest.split_first()
        && covered < COVERED
        && (text.is_empty() || table::characters(&text) + table::characters(&told(share)) <= ROOM)
    {
        text += &format!("{}{}", if text.is_empty() { "" } else { ", " }, told(share));
        covered += share.part.0;
        rest = others;
    }
    match rest.len() {
        0 => text,
        _ if (1.0 - covered).abs() < 0.005 => text,
        left => format!("{text}, {left} more {}", percent(1.0 - covered)),
    }
}

fn percent(part: f64) -> String {
    format!("{:.0} %", 100.0 * part)
}

/// The bodies that carry a mode's kinetic energy.
fn carried_by(system: &LinearSystem, mode: &crate::analysis::Mode) -> String {
    largest_shares(&mode.kinetic, |of| system.display(of))
}

#[cfg(test)]
mod tests {
    use super::super::ReportOptions;
    use super::text;
    use crate::analysis::Normalise;
    use crate::answers::samples;

    #[test]
    fn a_stable_scene() {
        insta::assert_snapshot!(text(&samples::cart(), &ReportOptions::default()));
    }

    #[test]
    fn a_rigid_motion_is_named() {
        let options = ReportOptions { normalise: Normalise::Mass, ..ReportOptions::default() };
        insta::assert_snapshot!(text(&samples::free_pair(), &options));
    }

    #[test]
    fn an_unstable_rest_is_said_loudly() {
        insta::assert_snapshot!(text(&samples::upright_rod(), &ReportOptions::default()));
    }
}
