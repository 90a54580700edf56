//! Glyphs: one file per kind. Each defines the strokes for an item of the scene and the places where its name may be
//! written. A kind of element, joint, shape or input without a glyph does not compile: every `match` here names all of
//! them.

mod arrow;
mod base;
mod belt;
mod block;
mod couple;
mod damper;
mod disk;
mod force;
mod gear;
mod gravity;
mod ground;
mod inerter;
mod initial;
mod output;
mod pivot;
mod rod;
mod rotary_dashpot;
mod scale_bar;
mod slide;
mod spiral;
mod spring;
mod torque;
mod unbalance;
pub mod values;
mod weld;

use super::figure::{Glyph, Hold, Item, Kind, Pen, Ride, Stroke};
use super::geometry::{Bounds, Point};
use super::labels::Wanted;
use super::layout::{Foot, GROUND, Layout, Link, Outline, Parts};
use super::occupied::Occupied;
use super::stage::Stage;
use super::{Detail, Request, text};
use crate::base::Span;
use crate::elements::Order;
use crate::model::scene::{Axis, BeltSpan, Element, Geometry, InputKind, Scene};
use values::Says;

/// A figure while it is drawn.
pub struct Sheet<'a> {
    pub scene: &'a Scene,
    pub layout: &'a Layout,
    pub request: &'a Request<'a>,
    pub says: &'a Says<'a>,
    pub detail: Detail,
    pub glyphs: Vec<Glyph>,
    pub wanted: Vec<Wanted>,
}

/// The item that a glyph represents.
#[derive(Clone, Debug)]
pub struct Subject {
    pub title: String,
    pub span: Option<Span>,
}

impl<'a> Sheet<'a> {
    pub fn parts_of(&self) -> Parts {
        Parts::new(self.scene)
    }

    /// Adds a glyph that does not move.
    pub fn push(&mut self, kind: Kind, of: Subject, strokes: Vec<Stroke>) {
        self.push_riding(kind, of, vec![(Ride::Still, strokes)]);
    }

    /// Adds a glyph with the motion of each group of strokes.
    pub fn push_riding(&mut self, kind: Kind, of: Subject, list: Vec<(Ride, Vec<Stroke>)>) {
        let (mut strokes, mut rides) = (Vec::new(), Vec::new());
        for (ride, own) in list.into_iter().filter(|(_, own)| !own.is_empty()) {
            if ride != Ride::Still || !rides.is_empty() {
                rides.push((strokes.len(), ride));
            }
            strokes.extend(own);
        }
        self.glyphs.push(Glyph { kind, title: of.title, span: of.span, strokes, rides, item: None, ghost: false });
    }

    /// Sets the item that the last glyph represents.
    fn name_item(&mut self, item: Item) {
        if let Some(glyph) = self.glyphs.last_mut() {
            glyph.item = Some(item);
        }
    }

    /// The name that was asked for last moves so.
    pub fn rides(&mut self, ride: Ride) {
        if self.detail == Detail::Full
            && let Some(wanted) = self.wanted.last_mut()
        {
            wanted.ride = ride;
        }
    }

    /// Asks for a name beside a place.
    pub fn label(&mut self, text: String, span: Option<Span>, at: Point, half: Point, best: &[Point]) {
        if self.detail == Detail::Full {
            let (text, best) = (text::clip(&text), best.to_vec());
            self.wanted.push(Wanted { text, span, at, half, best, ride: Ride::Still, is_of_tie: false });
        }
    }

    /// Asks for the name of an item that ties others together. It is placed before theirs.
    pub fn label_tie(&mut self, text: String, span: Option<Span>, at: Point, half: Point, best: &[Point]) {
        self.label(text, span, at, half, best);
        if let Some(wanted) = self.wanted.last_mut() {
            wanted.is_of_tie = true;
        }
    }

    /// Draws everything that moves or holds: the ground first and joints last, so that each covers what is behind it.
    pub fn parts(&mut self, stage: &Stage) {
        if self.detail == Detail::Bare {
            return self.bare(stage);
        }
        ground::walls(self, stage);
        for index in 0..self.scene.bases.len() {
            base::draw(self, stage, index);
        }
        for index in 0..self.scene.couples.len() {
            couple::draw(self, stage, index);
        }
        // Elements round a pivot are drawn on top of the bodies that it joins.
        let (round, between): (Vec<usize>, Vec<usize>) =
            (0..self.scene.elements.len()).partition(|index| self.layout.links[*index].round.is_some());
        for index in between {
            self.element(stage, index);
        }
        for index in 0..self.scene.joints.len() {
            if let Some(along) = &self.scene.joints[index].along {
                slide::draw(self, stage, index, along);
            }
        }
        for index in 0..self.scene.bodies.len() {
            self.body(stage, index);
        }
        for index in round {
            self.element(stage, index);
        }
        for index in 0..self.scene.joints.len() {
            // Slides are drawn behind the bodies.
            match self.scene.joints[index].kind {
                kind if kind.turns => pivot::draw(self, stage, index),
                kind if kind.is_rigid() => weld::draw(self, stage, index),
                _ => {}
            }
        }
    }

    fn body(&mut self, stage: &Stage, index: usize) {
        let number = 1 + index;
        let placed = &self.layout.parts[number];
        let at = stage.place(number);
        let body = &self.scene.bodies[index];
        let of = Subject { title: values::body_title(self.says, body), span: Some(body.span) };
        let arms = placed.arms.iter().map(|arm| rod::link(at, stage.point(number, *arm)));
        let mut strokes: Vec<Stroke> = arms.collect();
        let turned = |v: Point| stage.vector(number, v);
        let (kind, own) = match &placed.outline {
            Outline::Rod { arm } => (Kind::Rod, rod::strokes(at, turned(*arm))),
            Outline::Disk { radius } => (Kind::Disk, disk::strokes(at, *radius, turned(Point::new(0.0, -1.0)))),
            Outline::Wheel { radius } => (Kind::Disk, disk::strokes(at, *radius, turned(Point::new(0.0, -1.0)))),
            Outline::Ring { radius } => (Kind::Ring, disk::ring(at, *radius, turned(Point::new(0.0, -1.0)))),
            Outline::Box { half, along } => {
                let own = |v: Point| turned(along.times(v.x).plus(along.perpendicular().times(v.y)));
                (Kind::Box, block::strokes(at, *half, own))
            }
            Outline::Block { half } => (Kind::Block, block::strokes(at, *half, turned)),
            Outline::Dot { radius } => (Kind::Point, block::dot(at, *radius)),
            Outline::Speck { half } => (Kind::Block, block::strokes(at, Point::new(*half, *half), turned)),
            // The ground, and bases.
            Outline::Plate { .. } | Outline::Nowhere => (Kind::Block, Vec::new()),
        };
        strokes.extend(own);
        self.push_riding(kind, of, vec![(Ride::With(number), strokes)]);
        self.name_item(Item::Body(index));
        let (half, best) = match &placed.outline {
            Outline::Rod { arm } => {
                let side = turned(*arm).perpendicular().unit().unwrap_or_default();
                (Point::new(7.0, 7.0), vec![side, side.times(-1.0)])
            }
            outline => (outline.half(), placed.name_at.clone()),
        };
        let text = values::body_label(self.says, body);
        self.label(text, Some(body.span), at, half, &best);
        self.rides(Ride::At(Hold::at_part(number, at)));
    }

    fn element(&mut self, stage: &Stage, index: usize) {
        let element = &self.scene.elements[index];
        let link = &self.layout.links[index];
        let of = Subject { title: values::element_title(self.says, element), span: Some(element.span) };
        let turns = element.law.geometry == Geometry::Torsion;
        if let Geometry::Span(span) = &element.law.geometry {
            return self.belt(stage, index, span, of);
        }
        let [a, b] = [&link.feet[0], &link.feet[1]]
            .map(|foot| if turns { stage.carry(foot.part, foot.at) } else { stage.point(foot.part, foot.at) });
        let hold = |foot: &Foot, at: Point| {
            let of = if turns { stage.place(foot.part) } else { at };
            Hold { part: foot.part, of, at }
        };
        let between = Ride::Between([hold(&link.feet[0], a), hold(&link.feet[1], b)]);
        if self.detail >= Detail::Plain {
            self.push_riding(kind(element), of, vec![(between, vec![Stroke::line([a, b], Pen::Thin)])]);
            return self.name_item(Item::Element(index));
        }
        let mut strokes: Vec<(Ride, Vec<Stroke>)> = leads(stage, link).collect();
        if let Some(place) = link.round {
            let own = match element.law.kind.order {
                Order::Displacement => spiral::round(a, place),
                Order::Velocity => rotary_dashpot::round(a, place),
                Order::Acceleration => inerter::round(a, place),
            };
            let reach = own.iter().fold(Bounds::EMPTY, |bounds, stroke| bounds.and(stroke.bounds()));
            // An element round a pivot; the pivot is a point of each of its parts.
            let held = if link.feet[0].part == GROUND { &link.feet[1] } else { &link.feet[0] };
            let ride = Ride::At(Hold::at_part(held.part, a));
            strokes.push((ride, own));
            self.push_riding(kind(element), of, strokes);
            self.name_item(Item::Element(index));
            let text = values::element_label(self.says, element);
            self.label_tie(
                text,
                Some(element.span),
                reach.centre(),
                Point::new(reach.width() / 2.0, reach.height() / 2.0),
                &[],
            );
            return self.rides(ride);
        }
        let (own, half) = match (element.law.kind.order, turns) {
            (Order::Displacement, false) => (spring::strokes(a, b), spring::HALF),
            (Order::Displacement, true) => (spiral::strokes(a, b), spiral::HALF),
            (Order::Velocity, false) => (damper::strokes(a, b), damper::HALF),
            (Order::Velocity, true) => (rotary_dashpot::strokes(a, b), rotary_dashpot::HALF),
            (Order::Acceleration, _) => (inerter::strokes(a, b), inerter::HALF),
        };
        strokes.push((between, own));
        self.push_riding(kind(element), of, strokes);
        self.name_item(Item::Element(index));
        let along = b.minus(a).unit().unwrap_or(Point::new(1.0, 0.0));
        let side =
            if along.perpendicular().y <= 0.0 { along.perpendicular() } else { along.perpendicular().times(-1.0) };
        let (reach, half) = (b.distance(a) * 0.25, half + 1.0);
        let half = Point::new(along.x.abs() * reach + side.x.abs() * half, along.y.abs() * reach + side.y.abs() * half);
        // Beside a slanting element the box of its middle is enough.
        let half =
            if along.x.abs() > 0.1 && along.y.abs() > 0.1 { Point::new(spring::HALF, spring::HALF) } else { half };
        let text = values::element_label(self.says, element);
        self.label_tie(text, Some(element.span), a.middle(b), half, &[side, side.times(-1.0)]);
        self.rides(between);
    }

    /// A span of a belt; the first has its name.
    fn belt(&mut self, stage: &Stage, index: usize, span: &BeltSpan, of: Subject) {
        let element = &self.scene.elements[index];
        let (ride, [a, b], strokes) = belt::span(self, stage, element, span);
        self.push_riding(Kind::Belt, of, vec![(ride, strokes)]);
        self.name_item(Item::Element(index));
        if !span.left || self.detail >= Detail::Plain {
            return;
        }
        let text = values::element_label(self.says, element);
        let side = b.minus(a).unit().unwrap_or_default().perpendicular();
        let out = if side.y <= 0.0 { side } else { side.times(-1.0) };
        self.label_tie(text, Some(element.span), a.middle(b), Point::new(3.0, 3.0), &[out, out.times(-1.0)]);
        self.rides(ride);
    }

    /// Draws arrows for inputs, outputs and initial motions, if there is room for them.
    pub fn arrows(&mut self, stage: &Stage, is_mode: bool, room: &mut Occupied) {
        if self.detail >= Detail::Plain {
            return;
        }
        let scene = self.scene;
        for input in &scene.inputs {
            match &input.kind {
                InputKind::Base { base, translation } => base::arrow(self, stage, base.index(), *translation, room),
                // A mode is the motion without any load.
                _ if is_mode => {}
                InputKind::Force { ends, direction } => {
                    force::fixed_direction(self, stage, input, ends, direction, room)
                }
                InputKind::ForceBetween { ends } => force::draw_between(self, stage, input, ends, room),
                InputKind::Torque { ends } => torque::draw(self, stage, input, ends, room),
                // One glyph represents both components.
                InputKind::Unbalance { axis: Axis::Y, .. } => {}
                InputKind::Unbalance { end, clockwise, .. } => {
                    unbalance::draw(self, stage, input, &end[0], *clockwise, room);
                }
            }
        }
        if is_mode {
            return;
        }
        output::draw_all(self, stage, room);
        for initial in &scene.initial {
            initial::draw(self, stage, initial, room);
        }
    }

    /// Gravity and the scale, beside and below everything else.
    pub fn corner(&mut self, room: &mut Occupied) {
        let bounds = self.glyphs.iter().fold(Bounds::EMPTY, |bounds, glyph| bounds.and(glyph.bounds()));
        if bounds.is_empty() {
            return;
        }
        gravity::draw(self, bounds, room);
        scale_bar::draw(self, bounds, room);
    }

    /// One path for all elements and one for all bodies.
    fn bare(&mut self, stage: &Stage) {
        let title = |what: &str, count: usize| Subject { title: format!("{count} {what}"), span: None };
        let lines = self.layout.links.iter().map(|link| {
            let [a, b] = [0, 1].map(|end| stage.point(link.feet[end].part, link.feet[end].at));
            Stroke::line([a, b], Pen::Thin)
        });
        let lines: Vec<Stroke> = lines.collect();
        self.push(Kind::Spring, title("springs and dampers", lines.len()), lines);
        let specks = (1..self.layout.parts.len()).map(|number| {
            let (at, half) = (stage.place(number), self.layout.parts[number].outline.half());
            let half = Point::new(half.x.clamp(1.0, 4.0), half.y.clamp(1.0, 4.0));
            let corners = [half, Point::new(-half.x, half.y), half.times(-1.0), Point::new(half.x, -half.y)];
            Stroke::area(corners.map(|corner| at.plus(corner)), Pen::Solid)
        });
        let specks: Vec<Stroke> = specks.collect();
        self.push(Kind::Block, title("bodies", specks.len()), specks);
    }

    /// Draws a glyph in the first of several ways in which it touches nothing, or in the first one if all of them do.
    pub fn choose(&mut self, kind: Kind, of: Subject, tries: Vec<Vec<Stroke>>, room: &mut Occupied) -> Option<Bounds> {
        let is_free = |strokes: &Vec<Stroke>| {
            let bounds = strokes.iter().fold(Bounds::EMPTY, |bounds, stroke| bounds.and(stroke.bounds()));
            room.is_free(&bounds.grow(2.0))
        };
        let place = tries.iter().position(is_free).unwrap_or(0);
        let strokes = tries.into_iter().nth(place)?;
        let glyph =
            Glyph { kind, title: of.title, span: of.span, strokes, rides: Vec::new(), item: None, ghost: false };
        room.take(&glyph);
        let bounds = glyph.bounds();
        self.glyphs.push(glyph);
        Some(bounds)
    }

    /// A name beside a glyph that was chosen.
    pub fn label_beside(&mut self, text: String, span: Option<Span>, bounds: Bounds, best: &[Point]) {
        let half = Point::new(bounds.width() / 2.0, bounds.height() / 2.0);
        self.label(text, span, bounds.centre(), half, best);
    }
}

/// The kind of glyph that represents an element.
fn kind(element: &Element) -> Kind {
    match (element.law.kind.order, &element.law.geometry) {
        (_, Geometry::Span(_)) => Kind::Belt,
        (Order::Displacement, Geometry::Torsion) => Kind::TorsionSpring,
        (Order::Displacement, Geometry::Line | Geometry::Along(_)) => Kind::Spring,
        (Order::Velocity, Geometry::Torsion) => Kind::TorsionDamper,
        (Order::Velocity, Geometry::Line | Geometry::Along(_)) => Kind::Damper,
        (Order::Acceleration, Geometry::Torsion) => Kind::TorsionInerter,
        (Order::Acceleration, Geometry::Line | Geometry::Along(_)) => Kind::Inerter,
    }
}

/// The lines from the ends of a glyph to the parts that it ties.
fn leads<'a>(stage: &'a Stage, link: &'a Link) -> impl Iterator<Item = (Ride, Vec<Stroke>)> + 'a {
    link.feet.iter().filter(|foot| !foot.lead.is_empty()).map(|foot| {
        let points = std::iter::once(&foot.at).chain(&foot.lead).map(|point| stage.point(foot.part, *point));
        (Ride::With(foot.part), vec![Stroke::line(points.collect::<Vec<_>>(), Pen::Normal)])
    })
}
