//! The contents of a figure: glyphs with their strokes, labels, notes. Plain data in page coordinates.

use super::geometry::{Bounds, Point};
use super::text;
use crate::base::Span;

/// A figure, ready to be written. Its page starts at the origin; y runs downwards.
#[derive(Clone, Debug)]
pub struct Figure {
    /// The model's name.
    pub name: String,
    pub width: f64,
    pub height: f64,
    /// The glyphs in drawing order.
    pub glyphs: Vec<Glyph>,
    pub labels: Vec<Label>,
    /// Lines below the figure.
    pub notes: Vec<Note>,
    /// The displacement from the layout to the page.
    pub shift: Point,
}

/// The drawing of one thing of the model.
#[derive(Clone, Debug)]
pub struct Glyph {
    pub kind: Kind,
    /// Text that a viewer shows on hover: name, value, and motion in a mode.
    pub title: String,
    /// The declaration that the glyph represents.
    pub span: Option<Span>,
    pub strokes: Vec<Stroke>,
    /// The motions of the strokes, each from the stroke with the given number on. Strokes before the first one do not
    /// move.
    pub rides: Vec<(usize, Ride)>,
    /// The item whose share of a mode's energy the glyph can show.
    pub item: Option<Item>,
    /// Part of the rest behind a mode.
    pub ghost: bool,
}

/// A body or an element, by its place in the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Item {
    Body(usize),
    Element(usize),
}

/// The motion of a stroke when the scene moves. Parts have the numbers of the layout.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Ride {
    Still,
    /// Moves and turns with a part, as if drawn on it.
    With(usize),
    /// Moves with a point of a part, but does not turn.
    At(Hold),
    /// Stretched between two.
    Between([Hold; 2]),
}

/// A point that moves with a point of a part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hold {
    pub part: usize,
    /// The point of the part.
    pub of: Point,
    pub at: Point,
}

impl Hold {
    /// A point of a part itself.
    pub fn at_part(part: usize, at: Point) -> Hold {
        Hold { part, of: at, at }
    }

    fn shift(&mut self, by: Point) {
        (self.of, self.at) = (self.of.plus(by), self.at.plus(by));
    }
}

impl Ride {
    pub fn shift(&mut self, by: Point) {
        match self {
            Ride::Still | Ride::With(_) => {}
            Ride::At(hold) => hold.shift(by),
            Ride::Between(holds) => holds.iter_mut().for_each(|hold| hold.shift(by)),
        }
    }
}

/// The kind of item that a glyph represents.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    Rod,
    Disk,
    Ring,
    Box,
    /// A body without a shape.
    Block,
    /// A body without a mass, or with all of its mass in one point.
    Point,
    Base,
    Ground,
    Spring,
    Damper,
    TorsionSpring,
    TorsionDamper,
    Inerter,
    Belt,
    TorsionInerter,
    Pivot,
    Slide,
    Weld,
    Couple,
    Gear,
    Force,
    Torque,
    Unbalance,
    Output,
    Initial,
    Gravity,
    ScaleBar,
    Leader,
}

impl Kind {
    /// The class of the glyph in a written figure.
    pub fn class(self) -> &'static str {
        match self {
            Kind::Rod => "body rod",
            Kind::Disk => "body disk",
            Kind::Ring => "body ring",
            Kind::Box => "body box",
            Kind::Block => "body block",
            Kind::Point => "body point",
            Kind::Base => "base",
            Kind::Ground => "ground",
            Kind::Spring => "spring",
            Kind::Damper => "damper",
            Kind::TorsionSpring => "spring torsion",
            Kind::TorsionDamper => "damper torsion",
            Kind::Inerter => "inerter",
            Kind::Belt => "belt",
            Kind::TorsionInerter => "inerter torsion",
            Kind::Pivot => "joint pivot",
            Kind::Slide => "joint slide",
            Kind::Weld => "joint weld",
            Kind::Couple => "couple",
            Kind::Gear => "couple gear",
            Kind::Force => "input force",
            Kind::Torque => "input torque",
            Kind::Unbalance => "input unbalance",
            Kind::Output => "output",
            Kind::Initial => "initial",
            Kind::Gravity => "gravity",
            Kind::ScaleBar => "scale-bar",
            Kind::Leader => "leader",
        }
    }
}

/// A line or a circle.
#[derive(Clone, Debug)]
pub enum Stroke {
    Line { points: Vec<Point>, closed: bool, pen: Pen },
    Circle { centre: Point, radius: f64, pen: Pen },
}

/// The style of a stroke.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Pen {
    /// The outline of a body, filled with a light tone.
    Body,
    /// The outline of a shape that covers everything behind it.
    Paper,
    /// A springy line.
    Normal,
    Thin,
    Dashed,
    /// Faint: initial motions.
    Faint,
    /// Filled.
    Solid,
}

impl Pen {
    pub fn class(self) -> &'static str {
        match self {
            Pen::Body => "b",
            Pen::Paper => "p",
            Pen::Normal => "n",
            Pen::Thin => "t",
            Pen::Dashed => "d",
            Pen::Faint => "f",
            Pen::Solid => "s",
        }
    }

    pub fn fills(self) -> bool {
        matches!(self, Pen::Body | Pen::Paper | Pen::Solid)
    }
}

/// A name next to the glyph that it belongs to.
#[derive(Clone, Debug)]
pub struct Label {
    pub text: String,
    /// The middle of its line.
    pub at: Point,
    pub span: Option<Span>,
    /// The point that it moves with, without turning.
    pub ride: Ride,
}

/// A line of text below the figure.
#[derive(Clone, Debug)]
pub struct Note {
    /// Its left end, at middle height.
    pub at: Point,
    pub text: String,
}

impl Label {
    /// The width at which it is set, px.
    pub fn width(&self) -> f64 {
        text::width(&self.text)
    }

    /// The room that is kept for it: wider than it is set, for viewers that do not mind `textLength`.
    pub fn reserved_bounds(&self) -> Bounds {
        Bounds::around(self.at, Point::new(self.width() * text::SPARE / 2.0 + 1.0, text::HEIGHT / 2.0))
    }
}

impl Stroke {
    pub fn line(points: impl Into<Vec<Point>>, pen: Pen) -> Stroke {
        Stroke::Line { points: points.into(), closed: false, pen }
    }

    pub fn area(points: impl Into<Vec<Point>>, pen: Pen) -> Stroke {
        Stroke::Line { points: points.into(), closed: true, pen }
    }

    pub fn circle(centre: Point, radius: f64, pen: Pen) -> Stroke {
        Stroke::Circle { centre, radius, pen }
    }

    pub fn bounds(&self) -> Bounds {
        match self {
            Stroke::Line { points, .. } => Bounds::of(points),
            Stroke::Circle { centre, radius, .. } => Bounds::around(*centre, Point::new(*radius, *radius)),
        }
    }
}

impl Glyph {
    pub fn bounds(&self) -> Bounds {
        self.strokes.iter().fold(Bounds::EMPTY, |bounds, stroke| bounds.and(stroke.bounds()))
    }

    pub fn shift(&mut self, by: Point) {
        self.rides.iter_mut().for_each(|(_, ride)| ride.shift(by));
        for stroke in &mut self.strokes {
            match stroke {
                Stroke::Line { points, .. } => points.iter_mut().for_each(|point| *point = point.plus(by)),
                Stroke::Circle { centre, .. } => *centre = centre.plus(by),
            }
        }
    }
}
