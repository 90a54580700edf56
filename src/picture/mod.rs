//! The scene as a textbook figure: the layout of the page, the glyphs, and the places of the names. In: a checked
//! scene, and the poses of its parts at rest or in a mode. Out: a [`Figure`], a plain value that a backend writes. See
//! docs/draw.md.
//!
//! # Steps
//! 1. [`layout`]: the positions of parts and of the ends of elements; from the scene's coordinates if it has any
//! 2. [`stage`]: the same at rest, or moved by a mode
//! 3. [`glyph`]: lines and circles, one file per kind
//! 4. [`labels`]: names, where nothing else is
//!
//! A page with an animation also needs [`Moving`], which says how the parts move.

pub mod figure;
pub mod geometry;
pub mod glyph;
pub mod labels;
pub mod layout;
pub mod moving;
pub mod occupied;
pub mod stage;
pub mod text;

pub use figure::{Figure, Glyph, Item, Kind, Label, Note, Pen, Ride, Stroke};
pub use moving::Moving;

use crate::base::{Name, Number};
use crate::lower::Poses;
use crate::model::scene::Scene;
use geometry::{Bounds, Point};
use glyph::Sheet;
use glyph::values::Says;
use layout::{Layout, Parts};
use stage::Stage;

/// The content of a figure in addition to the scene as drawn.
pub struct Request<'a> {
    /// A value in few digits, for labels and titles.
    pub digits: &'a dyn Fn(&Number) -> String,
    /// Write values beside names.
    pub values: bool,
    pub shown: Shown<'a>,
}

impl Request<'_> {
    /// The motion of a part in the displayed mode.
    pub fn mode_motion(&self, name: Name) -> Option<String> {
        match &self.shown {
            Shown::Mode(mode) => (mode.does)(name),
            Shown::AsDrawn | Shown::AtRest(_) => None,
        }
    }
}

/// The state in which the parts are shown.
pub enum Shown<'a> {
    AsDrawn,
    AtRest(&'a Poses),
    Mode(ModeShown<'a>),
}

/// A mode over the rest.
pub struct ModeShown<'a> {
    pub poses: &'a Poses,
    /// `mode 2: 3.747 rad/s`
    pub caption: String,
    /// The motion of a part in the mode, by the part's name, such as its share of an energy.
    pub does: &'a dyn Fn(Name) -> Option<String>,
}

/// Why a scene has no figure.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// A point of this part lies outside the plane z = 0.
    Spatial(String),
    /// A coordinate of this part is not in the range of binary64.
    OutOfRange(String),
}

impl std::fmt::Display for Refusal {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        match self {
            Refusal::Spatial(part) => {
                write!(f, "`{part}` has a point outside the plane z = 0, and only planar scenes are drawn")
            }
            Refusal::OutOfRange(part) => write!(f, "a coordinate of `{part}` is too large to be drawn"),
        }
    }
}

/// The level of detail of a figure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Detail {
    /// Everything.
    Full,
    /// Everything except names.
    Unnamed,
    /// Lines for springs and dampers.
    Plain,
    /// One path for all springs and one for all bodies, without titles.
    Bare,
}

/// More parts than this are not named, have no springs, share one path.
const NAMED: usize = 2_000;
const COILED: usize = 5_000;
const TITLED: usize = 20_000;

impl Detail {
    pub fn of(scene: &Scene) -> Detail {
        match scene.bodies.len() + scene.bases.len() + scene.joints.len() + scene.elements.len() + scene.couples.len() {
            parts if parts <= NAMED => Detail::Full,
            parts if parts <= COILED => Detail::Unnamed,
            parts if parts <= TITLED => Detail::Plain,
            _ => Detail::Bare,
        }
    }

    fn note(self, scene: &Scene) -> Option<String> {
        let parts = scene.bodies.len() + scene.bases.len() + scene.joints.len() + scene.elements.len();
        Some(match self {
            Detail::Full => return None,
            Detail::Unnamed => format!("{parts} parts: names are left out"),
            Detail::Plain => format!("{parts} parts: names are left out, springs and dampers are lines"),
            Detail::Bare => format!("{parts} parts: bodies are squares, springs and dampers lines, without names"),
        })
    }
}

/// The figure of a scene.
pub fn figure(scene: &Scene, request: &Request) -> Result<Figure, Refusal> {
    let says = Says { scene, request };
    let layout = layout::layout(scene, Detail::of(scene), &says)?;
    Ok(of_layout(scene, &layout, request))
}

/// The figure at rest, and the data that move it.
pub fn animated_figure(
    scene: &Scene,
    poses: Poses,
    digits: &dyn Fn(&Number) -> String,
) -> Result<(Figure, Moving), Refusal> {
    let request = Request { digits, values: false, shown: Shown::AtRest(&poses) };
    let says = Says { scene, request: &request };
    let layout = layout::layout(scene, Detail::of(scene), &says)?;
    let figure = of_layout(scene, &layout, &request);
    let moving = Moving::of(Parts::new(scene), layout, poses, figure.shift);
    Ok((figure, moving))
}

fn of_layout(scene: &Scene, layout: &Layout, request: &Request) -> Figure {
    let detail = Detail::of(scene);
    let says = Says { scene, request };
    let (front, ghost) = match &request.shown {
        Shown::AsDrawn => (Stage::as_drawn(layout), None),
        Shown::AtRest(poses) => (Stage::at(Parts::new(scene), layout, poses, 0.0), None),
        Shown::Mode(mode) => {
            let amount = stage::amount(Parts::new(scene), layout, mode.poses);
            (
                Stage::at(Parts::new(scene), layout, mode.poses, amount),
                Some(Stage::at(Parts::new(scene), layout, mode.poses, 0.0)),
            )
        }
    };
    let mut sheet = Sheet { scene, layout, request, says: &says, detail, glyphs: Vec::new(), wanted: Vec::new() };
    let mut behind = Vec::new();
    if let Some(ghost) = &ghost {
        sheet.parts(ghost);
        behind = std::mem::take(&mut sheet.glyphs);
        sheet.wanted.clear();
        for glyph in &mut behind {
            glyph.ghost = true;
        }
    }
    sheet.parts(&front);
    let mut room = occupied::Occupied::of(behind.iter().chain(&sheet.glyphs));
    // Names of elements and joints have the choice of places; then arrows; then the names of bodies and of arrows.
    let mut names = labels::Placing::new(&mut room);
    let (first, others) = std::mem::take(&mut sheet.wanted).into_iter().partition(|wanted| wanted.is_of_tie);
    names.place(first);
    sheet.wanted = others;
    sheet.arrows(&front, ghost.is_some(), names.room);
    sheet.corner(names.room);
    let Sheet { glyphs, wanted, .. } = sheet;
    names.place(wanted);
    let labels::Placing { labels, leaders, left_out, .. } = names;
    let mut notes = notes(scene, layout, request, detail, front.amount);
    if left_out > 0 {
        notes.push(format!("names without room that are left out: {left_out}"));
    }
    let glyphs: Vec<Glyph> = behind.into_iter().chain(glyphs).chain(leaders).collect();
    frame(scene, glyphs, labels, notes)
}

/// The lines below the figure.
fn notes(scene: &Scene, layout: &Layout, request: &Request, detail: Detail, amount: f64) -> Vec<String> {
    let mut notes = Vec::new();
    match &request.shown {
        Shown::AsDrawn => {}
        Shown::AtRest(_) if layout.scale.is_none() => {
            notes.push("at rest; the scene has no coordinates, so displacements are not shown".into());
        }
        Shown::AtRest(_) => notes.push("at rest, displacements to scale".into()),
        Shown::Mode(mode) => {
            let times = text::few_digits(amount);
            let size = if layout.scale.is_some() {
                format!("shape magnified {times} times")
            } else {
                "shape not to scale".into()
            };
            notes.push(mode.caption.clone());
            notes.push(format!("{size}; grey: rest"));
        }
    }
    notes.extend(detail.note(scene));
    notes
}

const MARGIN: f64 = 14.0;
const LINE: f64 = 17.0;
/// Narrower figures look lost on a page.
const LEAST_WIDTH: f64 = 180.0;

/// Moves everything into a frame that starts at the origin, with notes below.
fn frame(scene: &Scene, mut glyphs: Vec<Glyph>, mut labels: Vec<Label>, notes: Vec<String>) -> Figure {
    let mut bounds = glyphs.iter().fold(Bounds::EMPTY, |bounds, glyph| bounds.and(glyph.bounds()));
    bounds = labels.iter().fold(bounds, |bounds, label| bounds.and(label.reserved_bounds()));
    if bounds.is_empty() {
        bounds = Bounds::around(Point::default(), Point::new(20.0, 20.0));
    }
    let bounds = bounds.grow(MARGIN);
    let widest = notes.iter().map(|note| text::width(note) * text::SPARE + 2.0 * MARGIN).fold(LEAST_WIDTH, f64::max);
    let width = bounds.width().max(widest).ceil();
    let shift = Point::new((width - bounds.width()) / 2.0, 0.0).minus(bounds.low);
    for glyph in &mut glyphs {
        glyph.shift(shift);
    }
    for label in &mut labels {
        label.at = label.at.plus(shift);
        label.ride.shift(shift);
    }
    let top = bounds.height();
    let line =
        |(number, text): (usize, String)| Note { at: Point::new(MARGIN, top + LINE * number as f64 + 4.0), text };
    let height = (top + LINE * notes.len() as f64 + if notes.is_empty() { 0.0 } else { 4.0 }).ceil();
    let notes = notes.into_iter().enumerate().map(line).collect();
    Figure { name: scene.name.clone(), width, height, glyphs, labels, notes, shift }
}
