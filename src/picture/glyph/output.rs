//! An output: a thin coordinate arrow with its name. Outputs of one motion share an arrow, whatever derivative they are of.

use super::couple::direction;
use super::{Sheet, Subject, arrow};
use crate::base::Span;
use crate::model::scene::{Holder, Motion, Part, Reaction, ReactionComponent};
use crate::picture::figure::{Kind, Pen, Stroke};
use crate::picture::geometry::Point;
use crate::picture::occupied::Occupied;
use crate::picture::stage::Stage;

const LENGTH: f64 = 28.0;
/// Length of an arrow if there is little room.
const SHORT: f64 = 19.0;

/// The item that an arrow represents.
#[derive(Clone, Debug, PartialEq)]
enum Shown {
    /// The motion of a point of a part along a direction.
    Moves {
        part: usize,
        at: Point,
        direction: Point,
    },
    Turns {
        part: usize,
    },
    /// The change of an element's length or force.
    Element {
        index: usize,
    },
    /// A component of what a joint or the rails of a freedom clause exert on a part, at a place; `None` for the moment.
    Carries {
        part: usize,
        at: Point,
        direction: Option<Point>,
    },
}

struct Entry {
    shown: Shown,
    names: Vec<String>,
    span: Span,
}

/// Terms of one output that are drawn.
const MOST_TERMS: usize = 4;

pub fn draw_all(sheet: &mut Sheet, stage: &Stage, room: &mut Occupied) {
    let mut entries: Vec<Entry> = Vec::new();
    let scene = sheet.scene;
    for output in &scene.outputs {
        let name = sheet.says.display(output.name);
        for term in output.terms.iter().take(MOST_TERMS) {
            let Some(shown) = shown_motion(sheet, stage, &term.motion) else { continue };
            match entries.iter_mut().find(|entry| entry.shown == shown) {
                // Two terms of one output; those of other outputs have other names.
                Some(entry) if entry.names.last() == Some(&name) => {}
                Some(entry) => entry.names.push(name.clone()),
                None => entries.push(Entry { shown, names: vec![name.clone()], span: output.span }),
            }
        }
    }
    for entry in entries {
        let names = entry.names.join(", ");
        let of = Subject { title: format!("output {names}"), span: Some(entry.span) };
        let (tries, best) = match entry.shown {
            Shown::Moves { part, at, direction } => (straight(stage, part, at, direction), direction),
            Shown::Turns { part } => {
                let half = stage.layout.parts[part].outline.half();
                let own = half.x.max(half.y).min(40.0);
                let at = stage.place(part);
                let tries = arrow::offsets(own + 7.0).flat_map(|radius| arrow::arcs(at, radius, Pen::Thin, false));
                (tries.collect(), Point::new(0.0, -1.0))
            }
            Shown::Element { index } => (beside_element(stage, index), Point::new(0.0, -1.0)),
            // Like a force, which pulls at the part in its positive direction.
            Shown::Carries { at, direction: Some(direction), .. } => (pulling(at, direction), direction),
            Shown::Carries { at, direction: None, .. } => {
                let tries = arrow::offsets(12.0).flat_map(|radius| arrow::arcs(at, radius, Pen::Thin, false));
                (tries.collect(), Point::new(0.0, -1.0))
            }
        };
        if let Some(bounds) = sheet.choose(Kind::Output, of, tries, room) {
            sheet.label_beside(names, Some(entry.span), bounds, &[best]);
        }
    }
}

fn shown_motion(sheet: &Sheet, stage: &Stage, motion: &Motion) -> Option<Shown> {
    let parts = sheet.parts_of();
    match motion {
        Motion::Point { part: Part::Ground, .. } | Motion::Turn { part: Part::Ground, .. } => None,
        Motion::Point { part, at, .. } => {
            let part = parts.number(*part);
            let placed = &stage.layout.parts[part];
            let drawn = match (at, stage.layout.scale) {
                (Some(at), Some(_)) => placed.point([at.x.to_f64(), at.y.to_f64()]),
                _ => placed.at,
            };
            let direction = direction(stage, part, motion)?;
            Some(Shown::Moves { part, at: stage.point(part, drawn), direction })
        }
        Motion::Turn { part, .. } => Some(Shown::Turns { part: parts.number(*part) }),
        Motion::Reaction(reaction) => shown_reaction(sheet, stage, *reaction),
        Motion::Force { element } | Motion::Stretch { element } => Some(Shown::Element { index: element.index() }),
    }
}

/// What a joint exerts on its second part, or rails on the body that they guide; a coupling has no place.
fn shown_reaction(sheet: &Sheet, stage: &Stage, reaction: Reaction) -> Option<Shown> {
    let parts = sheet.parts_of();
    let (part, at) = match reaction.holder {
        Holder::Couple(_) => return None,
        Holder::Support(body) => {
            let part = parts.number(Part::Body(body));
            (part, stage.place(part))
        }
        Holder::Joint(joint) => {
            let part = parts.number(sheet.scene.joints[joint.index()].ends[1].part);
            (part, stage.point(part, stage.layout.joints[joint.index()]))
        }
    };
    // Up is negative on the page.
    let direction = match reaction.component {
        ReactionComponent::X => Some(Point::new(1.0, 0.0)),
        ReactionComponent::Y => Some(Point::new(0.0, -1.0)),
        ReactionComponent::Moment | ReactionComponent::Coupling => None,
    };
    Some(Shown::Carries { part, at, direction })
}

/// An arrow of a force that begins or ends near a place.
fn pulling(at: Point, direction: Point) -> Vec<Vec<Stroke>> {
    let single = |from: Point| arrow::single(from, from.towards(direction, LENGTH), Pen::Thin);
    let away = arrow::offsets(8.0).flat_map(|off| {
        let beside = [0.0, 9.0, -9.0].map(|aside| at.towards(direction.perpendicular(), aside));
        let from = beside.map(|place| single(place.towards(direction, off)));
        let to = beside.map(|place| single(place.towards(direction, -off - LENGTH)));
        from.into_iter().chain(to)
    });
    away.collect()
}

/// Beside the body first, then further off.
fn straight(stage: &Stage, part: usize, at: Point, direction: Point) -> Vec<Vec<Stroke>> {
    let outline = &stage.layout.parts[part].outline;
    let inside = at.minus(stage.place(part));
    let mut tries = Vec::new();
    let up = if direction.perpendicular().y <= 0.0 {
        direction.perpendicular()
    } else {
        direction.perpendicular().times(-1.0)
    };
    for off in arrow::offsets(7.0) {
        for side in [up, up.times(-1.0)] {
            let from = at.towards(side, outline.reach(inside, side) + off);
            tries.push(arrow::coordinate(from, from.towards(direction, LENGTH), Pen::Thin));
        }
        // Next to the body first, then far away from it.
        let from = at.towards(direction, outline.reach(inside, direction) + off - 2.0);
        tries.push(arrow::coordinate(from, from.towards(direction, LENGTH), Pen::Thin));
    }
    tries
}

fn beside_element(stage: &Stage, index: usize) -> Vec<Vec<Stroke>> {
    let link = &stage.layout.links[index];
    let [a, b] = [0, 1].map(|end| stage.point(link.feet[end].part, link.feet[end].at));
    let Some(along) = b.minus(a).unit() else { return arrow::arcs(a, 24.0, Pen::Thin, false) };
    let mut tries = Vec::new();
    let arrow = |at: Point, length: f64| {
        arrow::double(at.towards(along, -length / 2.0), at.towards(along, length / 2.0), Pen::Thin)
    };
    for off in arrow::offsets(13.0).flat_map(|off| [off, -off]) {
        let beside = a.middle(b).towards(along.perpendicular(), off);
        tries.push(arrow(beside, LENGTH));
        // Next to its ends if its name is at its middle.
        let aside = a.distance(b) * 0.3;
        tries.extend([aside, -aside].map(|aside| arrow(beside.towards(along, aside), SHORT)));
    }
    tries
}
