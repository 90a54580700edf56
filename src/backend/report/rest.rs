//! Where the rest is, and what it does when disturbed.

use super::super::ReportOptions;
use super::super::decimal::{certain, certain_number, upper};
use super::table::{Align, Table};
use super::{INDENT, carried_by, counted, line, unit};
use crate::analysis::derived::{degrees, doubling_time};
use crate::analysis::{Mode, ModeKind, PoleKind, Stability};
use crate::answers::ModalAnswer;
use crate::base::{Ball, Number, Rounded};
use crate::lower::Tension;
use crate::system::{Coordinate, CoordinateKind};

/// Displaced coordinates that are listed; the largest ones.
const MOST: usize = 12;
const DIGITS: usize = 6;
const DISTANCE: usize = 3;

pub fn text(answer: &ModalAnswer, options: &ReportOptions) -> String {
    displacement(answer) + &unstable(answer) + &undetermined(answer) + &neutral(answer) + &buckling(answer, options)
}

fn displacement(answer: &ModalAnswer) -> String {
    let all: Vec<(&Coordinate, &Number)> = answer.displacements().collect();
    let mut moved: Vec<usize> = (0..all.len()).filter(|i| !all[*i].1.is_zero()).collect();
    if moved.is_empty() {
        return as_drawn(answer);
    }
    let size = |i: &usize| all[*i].1.to_f64().abs();
    moved.sort_by(|a, b| size(b).total_cmp(&size(a)).then(a.cmp(b)));
    let left = moved.len().saturating_sub(MOST);
    moved.truncate(MOST);
    moved.sort_unstable();
    let mut table = Table::new().column("coordinate", "", Align::Left).column("moved by", "", Align::Point).column(
        "",
        "",
        Align::Left,
    );
    for i in moved {
        let (coordinate, value) = all[i];
        let unit = unit(coordinate.kind);
        let degrees = match coordinate.kind {
            CoordinateKind::Translation => String::new(),
            CoordinateKind::Rotation => format!("= {}°", certain(&degrees(value.to_ball()), DIGITS)),
        };
        let unit = format!("{unit} {degrees}");
        table.row(vec![answer.system.display(coordinate.name), certain_number(value, DIGITS), unit]);
    }
    let far = farthest(answer);
    let mut text = line(format!("rest: displaced from the drawing by up to {far}{}", trust(answer)));
    if !answer.rest.is_proven() {
        text +=
            &line("  no number below has a bound: all are about the scene linearised here, and it may rest elsewhere");
    }
    text += &table.text(INDENT);
    if left > 0 {
        text += &line(format!("... and {left} smaller ones (--format json has all)"));
    }
    text
}

/// The largest translation and the largest turn: `0.0245 m and 1.4°`.
fn farthest(answer: &ModalAnswer) -> String {
    let largest = |kind: CoordinateKind| {
        let values = answer.displacements().filter(|(coordinate, _)| coordinate.kind == kind).map(|(_, value)| value);
        values.filter(|value| !value.is_zero()).max_by(|a, b| a.to_f64().abs().total_cmp(&b.to_f64().abs()))
    };
    let moved = largest(CoordinateKind::Translation).map(|x| format!("{} m", certain_number(&x.abs(), DISTANCE)));
    let turned =
        largest(CoordinateKind::Rotation).map(|x| format!("{}°", certain(&degrees(x.abs().to_ball()), DISTANCE)));
    [moved, turned].into_iter().flatten().collect::<Vec<_>>().join(" and ")
}

/// The drawing is the rest: what holds it there, where that was found.
fn as_drawn(answer: &ModalAnswer) -> String {
    let rest = &answer.rest;
    let trust = if rest.is_proven() && rest.residual == 0.0 { String::new() } else { trust(answer) };
    let mut pulling: Vec<&Tension> = rest.tensions.iter().filter(|found| !found.tension.is_zero()).collect();
    if pulling.is_empty() {
        return line(format!("rest: as drawn{trust}"));
    }
    let size = |found: &&Tension| found.tension.to_f64().abs();
    let all = pulling.len();
    let mut largest = pulling.clone();
    largest.sort_by(|a, b| size(b).total_cmp(&size(a)));
    if let Some(least) = largest.get(MOST - 1) {
        let least = size(least);
        pulling.retain(|found| size(found) >= least);
        pulling.truncate(MOST);
    }
    let columns = [("spring", Align::Left), ("tension", Align::Point), ("", Align::Left)];
    let mut table = columns.into_iter().fold(Table::new(), |table, (name, align)| table.column(name, "", align));
    for found in &pulling {
        let unit = if found.turns { "N*m" } else { "N" };
        table.row(vec![answer.system.display(found.spring), certain_number(&found.tension, DIGITS), unit.into()]);
    }
    let mut text = line(format!("rest: as drawn, held by the tensions below{trust}")) + &table.text(INDENT);
    if all > pulling.len() {
        text += &line(format!("... and {} smaller ones (--format json has all)", all - pulling.len()));
    }
    text
}

/// What is known about a rest that was computed.
fn trust(answer: &ModalAnswer) -> String {
    let rest = &answer.rest;
    let proven = if rest.is_proven() { "proven" } else { "NOT proven" };
    let left = match rest.residual {
        0.0 => "balanced exactly".to_string(),
        residual => format!("unbalanced ≤ {} of the largest force", upper(residual)),
    };
    format!(", {proven}, {left}")
}

/// Each way in which the scene leaves its rest: the modes, and how fast. Damping changes that, so the poles tell it then.
fn unstable(answer: &ModalAnswer) -> String {
    let damped = !answer.system.c.is_empty();
    let mut text = String::new();
    for (number, mode) in answer.modes.numbered().filter(|(_, mode)| mode.kind == ModeKind::Divergence) {
        let how_fast = if damped { String::new() } else { format!(": {}", growth(mode.omega)) };
        text += &line(format!("  mode {number} ({}) runs away{how_fast}", carried_by(&answer.system, mode)));
    }
    for (number, pole) in answer.motions().filter(|_| damped) {
        match pole.kind {
            PoleKind::Flutter => {
                text += &line(format!("  pole {number} swings ever wider (flutter): {}", growth(pole.re)))
            }
            PoleKind::Divergence => text += &line(format!("  pole {number} runs away: {}", growth(pole.re))),
            _ => {}
        }
    }
    if answer.modes.before.divergences > 0 {
        text += &line(format!("  {} below those listed run away", counted(answer.modes.before.divergences, "mode")));
    }
    if text.is_empty() { text } else { line("UNSTABLE: the scene does not stay at this rest") + &text }
}

/// What may grow or not: what was certified does not tell.
fn undetermined(answer: &ModalAnswer) -> String {
    let (mut text, proven) = (String::new(), answer.rest.is_proven());
    for (number, mode) in answer.modes.numbered().filter(|(_, mode)| mode.kind == ModeKind::Undetermined) {
        let carried = carried_by(&answer.system, mode);
        let bound = if proven {
            format!(": |ω| or its growth is {} rad/s", certain(&mode.omega, DIGITS))
        } else {
            String::new()
        };
        text += &line(format!("  mode {number} ({carried}) may hold or run away{bound}"));
    }
    for (number, pole) in answer.motions().filter(|_| !answer.system.c.is_empty()) {
        if pole.kind == PoleKind::Undetermined {
            let bound = if proven { format!(": |re s| is {} 1/s", certain(&pole.re, DIGITS)) } else { String::new() };
            text += &line(format!("  pole {number} may decay or grow{bound}"));
        }
    }
    if answer.stability == Stability::Undetermined && (text.is_empty() || !proven) {
        text += &line(format!("  {}", answer.stability.reason().not_proved()));
    }
    if text.is_empty() {
        text
    } else {
        line("UNDETERMINED: whether the scene stays at this rest could not be certified") + &text
    }
}

/// How far gravity, tensions and reactions are from taking all stiffness away, or by how much they have.
fn buckling(answer: &ModalAnswer, options: &ReportOptions) -> String {
    let Some(found) = &answer.buckling else { return String::new() };
    let digits = options.digits(DIGITS);
    let factor = found.load_factor;
    let margin = found.margin();
    let bound = if options.digits.is_some() { factor.relative_error() } else { Rounded::relative_bound_of(factor) };
    let bound = if answer.rest.is_proven() { format!("≤ {}", upper(bound)) } else { "?".into() };
    let told = format!("{} (error {bound})", certain(&factor, digits));
    let meaning = match (margin.contains_zero(), margin.mid.hi > 0.0) {
        (true, _) => "at the buckling load, as far as can be told".to_string(),
        (false, true) => {
            format!("loads may grow by {} of themselves before the rest loses its stiffness", certain(&margin, digits))
        }
        (false, false) => {
            format!("the loads are too large by {} of themselves", certain(&margin.abs(), digits))
        }
    };
    line(format!("load factor to buckling {told}: {meaning}"))
}

fn growth(rate: Ball) -> String {
    format!("grows at {} 1/s, doubles in {} s", certain(&rate, DIGITS), certain(&doubling_time(rate), 4))
}

/// The motions that nothing holds back.
fn neutral(answer: &ModalAnswer) -> String {
    let rigid: Vec<(usize, &Mode)> = answer.modes.numbered().filter(|(_, mode)| mode.kind == ModeKind::Rigid).collect();
    let below = answer.modes.before.rigid;
    if rigid.is_empty() && below == 0 {
        return String::new();
    }
    let mut text = line("NEUTRAL: nothing holds these motions back");
    if below > 0 {
        text += &line(format!("  {} below those listed", counted(below, "rigid motion")));
    }
    for (number, mode) in rigid {
        text += &line(format!("  mode {number}: {}", carried_by(&answer.system, mode)));
    }
    text
}
