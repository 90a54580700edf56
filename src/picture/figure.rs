//! What a figure is made of: glyphs with their strokes, labels, notes. Plain data in page coordinates.

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
    /// In the order of drawing.
    pub glyphs: Vec<Glyph>,
    pub labels: Vec<Label>,
    /// Lines below the figure.
    pub notes: Vec<Note>,
}

/// The drawing of one thing of the model.
#[derive(Clone, Debug)]
pub struct Glyph {
    pub kind: Kind,
    /// What a viewer shows when pointed at: name, value, what it does in a mode.
    pub title: String,
    /// The declaration that made it.
    pub span: Option<Span>,
    pub strokes: Vec<Stroke>,
    /// Part of the rest behind a mode.
    pub ghost: bool,
}

/// What a glyph stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    Rod,
    Disk,
    Ring,
    Box,
    /// A body without a shape.
    Block,
    /// A body without a mass, or all of whose mass is in one point.
    Point,
    Base,
    Ground,
    Spring,
    Damper,
    TorsionSpring,
    TorsionDamper,
    Inerter,
    TorsionInerter,
    Pivot,
    Slide,
    Weld,
    Couple,
    Gear,
    Force,
    Torque,
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
            Kind::TorsionInerter => "inerter torsion",
            Kind::Pivot => "joint pivot",
            Kind::Slide => "joint slide",
            Kind::Weld => "joint weld",
            Kind::Couple => "couple",
            Kind::Gear => "couple gear",
            Kind::Force => "input force",
            Kind::Torque => "input torque",
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

/// How a stroke is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Pen {
    /// The outline of a body, filled with a light tone.
    Body,
    /// The outline of something that covers what is behind it.
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

/// A name beside what it belongs to.
#[derive(Clone, Debug)]
pub struct Label {
    pub text: String,
    /// The middle of its line.
    pub at: Point,
    pub span: Option<Span>,
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
    pub fn room(&self) -> Bounds {
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
        for stroke in &mut self.strokes {
            match stroke {
                Stroke::Line { points, .. } => points.iter_mut().for_each(|point| *point = point.plus(by)),
                Stroke::Circle { centre, .. } => *centre = centre.plus(by),
            }
        }
    }
}
