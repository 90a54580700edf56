//! The positions of parts and of the ends of elements on the page. In: a scene; out: a [`Layout`].
//!
//! A scene with coordinates is drawn to scale ([`scaled`]). A part of it that has none is placed next to the part to which
//! it is attached; several connected ones are laid out as a separate scene next to or below the others. A scene without any
//! is laid out in rows along its motion ([`rows`]); a large one on a grid ([`grid`]).

mod grid;
mod links;
mod outline;
mod parts;
mod rows;
mod scaled;

pub use outline::Outline;
pub use parts::{GROUND, Parts, straight};

use super::geometry::Point;
use super::glyph::values::Says;
use super::{Detail, Refusal};
use crate::model::scene::Scene;

/// Length of an element that is not determined by anything else, px.
pub const REACH: f64 = 64.0;
/// Between the axes of elements side by side, px.
pub const SIDE: f64 = 21.0;
/// Length of a torsional element that is not determined by anything else, px.
pub const TWISTED: f64 = 31.0;

/// A scene on the page.
#[derive(Clone, Debug)]
pub struct Layout {
    pub parts: Vec<Placed>,
    /// The ends of each element.
    pub links: Vec<Link>,
    /// The position of each joint.
    pub joints: Vec<Point>,
    /// Pixels per metre, if the scene has coordinates.
    pub scale: Option<f64>,
}

/// A part, by its number in [`Parts`].
#[derive(Clone, Debug)]
pub struct Placed {
    pub at: Point,
    /// The point of the scene that is drawn there, m.
    pub origin: [f64; 2],
    pub outline: Outline,
    /// Points that a thin line connects to the part: where joints and elements hold a body without a shape.
    pub arms: Vec<Point>,
    /// A metre along the scene's x and y, px.
    pub axes: [Point; 2],
    /// Preferred directions of its name; empty for any direction.
    pub name_at: Vec<Point>,
}

/// The two ends of an element.
#[derive(Clone, Debug)]
pub struct Link {
    pub feet: [Foot; 2],
    /// For a torsional element that is drawn round one point: its number among several there, from the inside.
    pub round: Option<usize>,
}

/// One end of an element.
#[derive(Clone, Debug)]
pub struct Foot {
    /// The number of the part in [`Parts`].
    pub part: usize,
    /// The end of the glyph.
    pub at: Point,
    /// The line from there to the part, if the glyph does not end at the part.
    pub lead: Vec<Point>,
    /// If the element ends at the ground, the direction of the ground as seen from the element.
    pub wall: Option<Point>,
}

impl Placed {
    /// A point of the scene that moves with the part, on the page.
    pub fn point(&self, scene: [f64; 2]) -> Point {
        let [dx, dy] = [scene[0] - self.origin[0], scene[1] - self.origin[1]];
        self.at.plus(self.axes[0].times(dx)).plus(self.axes[1].times(dy))
    }

    /// A direction of the scene, on the page.
    pub fn direction(&self, scene: [f64; 2]) -> Option<Point> {
        let [x, y] = self.axes.map(|axis| axis.unit().unwrap_or_default());
        x.times(scene[0]).plus(y.times(scene[1])).unit()
    }
}

/// The layout of a scene.
pub fn layout(scene: &Scene, detail: Detail, says: &Says) -> Result<Layout, Refusal> {
    let parts = Parts::new(scene);
    let known = parts.known_points(scene)?;
    if known.iter().any(|points| !points.is_empty()) {
        scaled::layout(scene, &parts, &known, detail, says)
    } else if detail == Detail::Full {
        Ok(rows::layout(scene, &parts, says))
    } else {
        Ok(grid::layout(scene, &parts))
    }
}
