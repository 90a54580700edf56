//! The position of the rest, and the motion after a disturbance.

use super::modes::mode_named;
use super::table::{Align, Table};
use super::{Block, Figure, Line, Options, Section, Value, coordinate, count_of, line, unit};
use crate::analysis::derived::{degrees, doubling_time};
use crate::analysis::{Mode, ModeKind, PoleKind, Stability};
use crate::answers::ModalAnswer;
use crate::base::{Ball, Bound, Number, Unproven, first_by};
use crate::lower::Tension;
use crate::system::{Coordinate, CoordinateKind};

/// Number of displaced coordinates that are listed: the largest.
const MOST: usize = 12;
const DIGITS: usize = 6;
const DISTANCE: usize = 3;

pub fn section(answer: &ModalAnswer, options: &Options) -> Section {
    let mut blocks = displacement(answer);
    blocks.extend(laws(answer));
    blocks.extend(unstable(answer));
    blocks.extend(undetermined_blocks(answer));
    blocks.extend(neutral(answer));
    blocks.extend(buckling(answer, options).map(Block::from));
    Section::new("Rest", blocks)
}

fn displacement(answer: &ModalAnswer) -> Vec<Block> {
    let all: Vec<(&Coordinate, &Number)> = answer.displacements().collect();
    let moving = || (0..all.len()).filter(|i| !all[*i].1.is_zero());
    let size = |i: &usize| all[*i].1.to_f64().abs();
    let mut moved = first_by(moving(), MOST, |a, b| size(b).total_cmp(&size(a)));
    if moved.is_empty() {
        return as_drawn(answer);
    }
    let left = moving().count() - moved.len();
    moved.sort_unstable();
    let mut table = Table::of([("coordinate", Align::Left), ("moved by", Align::Point), ("", Align::Left)]);
    for i in moved {
        let (of, value) = all[i];
        let in_unit = match of.kind {
            CoordinateKind::Translation => line![unit(of.kind)],
            CoordinateKind::Rotation => {
                line![unit(of.kind), " = ", Figure::ball(degrees(value.to_ball()), DIGITS), "°"]
            }
        };
        let value = Figure::number(value.clone(), DIGITS);
        table.row(vec![coordinate(&answer.system, of).into(), value.into(), in_unit.into()]);
    }
    let mut blocks =
        vec![line!["rest: displaced from the drawing by up to ", farthest(answer), proof_status(answer)].into()];
    if !answer.rest.is_proven() {
        let caution = "no number below has a bound: all refer to the scene linearised here, and it may rest elsewhere";
        blocks.push(Block::Item(caution.into()));
    }
    blocks.push(table.into());
    blocks.extend(smaller(left).map(Block::from));
    blocks
}

fn smaller(count: usize) -> Option<Line> {
    (count > 0).then(|| line!["... and ", count, " smaller ones (--format json has all)"])
}

/// The largest translation and the largest rotation: `0.0245 m and 1.4°`.
fn farthest(answer: &ModalAnswer) -> Line {
    let largest = |kind: CoordinateKind| {
        let values = answer.displacements().filter(|(coordinate, _)| coordinate.kind == kind).map(|(_, value)| value);
        let moved = values.filter(|value| !value.is_zero());
        moved.max_by(|a, b| a.to_f64().abs().total_cmp(&b.to_f64().abs())).map(Number::abs)
    };
    let moved = largest(CoordinateKind::Translation).map(|x| line![Figure::number(x, DISTANCE).unit("m")]);
    let turned = largest(CoordinateKind::Rotation).map(|x| line![Figure::ball(degrees(x.to_ball()), DISTANCE), "°"]);
    match (moved, turned) {
        (Some(moved), Some(turned)) => line![moved, " and ", turned],
        (moved, turned) => moved.or(turned).unwrap_or_default(),
    }
}

/// The drawing is the rest, with the tensions that hold it if these were found.
fn as_drawn(answer: &ModalAnswer) -> Vec<Block> {
    let rest = &answer.rest;
    let trust = if rest.is_proven() && rest.residual == 0.0 { Line::default() } else { proof_status(answer) };
    let mut pulling: Vec<&Tension> = rest.tensions.iter().filter(|found| !found.tension.is_zero()).collect();
    if pulling.is_empty() {
        return vec![line!["rest: as drawn", trust].into()];
    }
    let size = |found: &&Tension| found.tension.to_f64().abs();
    let all = pulling.len();
    let largest = first_by(pulling.iter().copied(), MOST, |a, b| size(b).total_cmp(&size(a)));
    if let Some(least) = largest.get(MOST - 1) {
        let least = size(least);
        pulling.retain(|found| size(found) >= least);
        pulling.truncate(MOST);
    }
    let mut table = Table::of([("spring", Align::Left), ("tension", Align::Point), ("", Align::Left)]);
    for found in &pulling {
        let unit = if found.turns { "N*m" } else { "N" };
        let tension = Figure::number(found.tension.clone(), DIGITS);
        table.row(vec![answer.system.display(found.spring).into(), tension.into(), unit.into()]);
    }
    let mut blocks = vec![line!["rest: as drawn, held by the tensions below", trust].into(), table.into()];
    blocks.extend(smaller(all - pulling.len()).map(Block::from));
    blocks
}

/// The elements with laws: their states at rest, and the tangents that replace the laws in the linear system.
fn laws(answer: &ModalAnswer) -> Vec<Block> {
    let all = &answer.rest.laws;
    if all.is_empty() {
        return Vec::new();
    }
    let mut table = Table::of([
        ("law of", Align::Left),
        ("at", Align::Point),
        ("", Align::Left),
        ("force", Align::Point),
        ("", Align::Left),
        ("tangent", Align::Point),
        ("", Align::Left),
    ]);
    for law in all.iter().take(MOST) {
        let number = |value: &Number| Figure::number(value.clone(), DIGITS).into();
        table.row(vec![
            answer.system.display(law.name).into(),
            number(&law.at),
            law.variable().1.into(),
            number(&law.force),
            law.force_unit().into(),
            number(&law.slope),
            law.slope_unit().into(),
        ]);
    }
    let mut blocks = vec![line!["laws at rest; everything below is for their tangents there"].into(), table.into()];
    blocks.extend(smaller(all.len().saturating_sub(MOST)).map(Block::from));
    blocks
}

/// The proof status of a computed rest.
fn proof_status(answer: &ModalAnswer) -> Line {
    let rest = &answer.rest;
    let proven = if rest.is_proven() { ", proven, " } else { ", NOT proven, " };
    let left = match rest.residual {
        0.0 => "balanced exactly".into(),
        residual => {
            let number = Unproven(residual);
            line!["unbalanced by ", Figure::of(Value::Unproven { number, digits: 1 }), " of the largest force"]
        }
    };
    line![proven, left]
}

/// A line followed by items; empty if there are no items.
fn with_items(line: &'static str, items: Vec<Line>) -> Vec<Block> {
    let line = (!items.is_empty()).then(|| Block::Line(line.into()));
    line.into_iter().chain(items.into_iter().map(Block::Item)).collect()
}

/// Each way in which the scene leaves its rest: the modes, and their growth. Damping changes the growth, so a damped
/// scene's growth is given by its poles.
fn unstable(answer: &ModalAnswer) -> Vec<Block> {
    let damped = !answer.system.c.is_empty();
    let mut items = Vec::new();
    for (number, mode) in of_kind(answer, ModeKind::Divergence) {
        let how_fast = if damped { Line::default() } else { line![": ", growth(mode.omega)] };
        items.push(line![mode_named(&answer.system, number, mode), " diverges", how_fast]);
    }
    for (number, pole) in answer.motions().filter(|_| damped) {
        let how = match pole.kind {
            PoleKind::Flutter => " oscillates with growing amplitude (flutter): ",
            PoleKind::Divergence => " diverges: ",
            _ => continue,
        };
        items.push(line!["pole ", number, how, growth(pole.re)]);
    }
    if answer.modes.before.divergences > 0 {
        let modes = count_of(answer.modes.before.divergences, "mode", "modes");
        items.push(line![modes, " below those listed diverge"]);
    }
    with_items("UNSTABLE: the scene does not stay at this rest", items)
}

fn of_kind(answer: &ModalAnswer, kind: ModeKind) -> impl Iterator<Item = (usize, &Mode)> {
    answer.modes.with_numbers().filter(move |(_, mode)| mode.kind == kind)
}

/// Modes and poles that may or may not grow: the certified bounds do not decide it.
fn undetermined_blocks(answer: &ModalAnswer) -> Vec<Block> {
    let (mut items, proven) = (Vec::new(), answer.rest.is_proven());
    let bound = |words: &'static str, bound: Figure| if proven { line![words, bound] } else { Line::default() };
    for (number, mode) in of_kind(answer, ModeKind::Undetermined) {
        let bound = bound(": |ω| or its growth is ", Figure::ball(mode.omega, DIGITS).unit("rad/s"));
        let mode = mode_named(&answer.system, number, mode);
        items.push(line![mode, " may be stable or diverge", bound]);
    }
    for (number, pole) in answer.motions().filter(|_| !answer.system.c.is_empty()) {
        if pole.kind == PoleKind::Undetermined {
            let bound = bound(": |re s| is ", Figure::ball(pole.re, DIGITS).unit("1/s"));
            items.push(line!["pole ", number, " may decay or grow", bound]);
        }
    }
    if answer.stability == Stability::Undetermined && (items.is_empty() || !proven) {
        items.push(answer.stability.reason().not_proved().into());
    }
    with_items("UNDETERMINED: whether the scene stays at this rest could not be certified", items)
}

/// The factor by which the loads may grow before gravity, tensions and reactions remove all stiffness, or by which they
/// exceed that.
fn buckling(answer: &ModalAnswer, options: &Options) -> Option<Line> {
    let found = answer.buckling.as_ref()?;
    let digits = options.digits(DIGITS);
    let (factor, margin) = (found.load_factor, found.margin());
    let bound = if options.digits.is_some() { Bound::of_midpoint(factor) } else { Bound::relative(factor) };
    let meaning = match (margin.contains_zero(), margin.mid.hi > 0.0) {
        (true, _) => "at the buckling load, as far as the bounds decide".into(),
        (false, true) => {
            let margin = Figure::ball(margin, digits);
            line!["loads may grow by ", margin, " times their size before the rest loses its stiffness"]
        }
        (false, false) => {
            line!["the loads are too large by ", Figure::ball(margin.abs(), digits), " times their size"]
        }
    };
    let (factor, bound) = (Figure::ball(factor, digits), super::error(bound));
    Some(line!["load factor to buckling ", factor, " (error ", bound, "): ", meaning])
}

fn growth(rate: Ball) -> Line {
    let (grows, doubles) = (Figure::ball(rate, DIGITS).unit("1/s"), Figure::ball(doubling_time(rate), 4).unit("s"));
    line!["grows at ", grows, ", doubles in ", doubles]
}

/// The motions that nothing restrains.
fn neutral(answer: &ModalAnswer) -> Vec<Block> {
    let below = answer.modes.before.rigid;
    let below =
        (below > 0).then(|| line![count_of(below, "rigid-body mode", "rigid-body modes"), " below those listed"]);
    let listed = of_kind(answer, ModeKind::Rigid)
        .map(|(number, mode)| line!["mode ", number, ": ", super::carried_by(&answer.system, mode)]);
    with_items("NEUTRAL: no stiffness restrains these motions", below.into_iter().chain(listed).collect())
}
