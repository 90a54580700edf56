//! The data that move a figure: the piece that each part belongs to, how the pieces carry each other, and how each
//! coordinate of the system moves them. [`super::stage`] computes with the same data; the script of a page repeats that
//! computation.

use super::geometry::Point;
use super::layout::{Layout, Parts};
use super::stage;
use crate::lower::{Displacement, Poses};

/// A scene at rest that may be moved.
#[derive(Clone, Debug)]
pub struct Moving {
    layout: Layout,
    numbers: Parts,
    /// The parts by number, the ground first.
    pub parts: Vec<MovingPart>,
    pub poses: Poses,
}

/// A part on the page.
#[derive(Clone, Copy, Debug)]
pub struct MovingPart {
    pub piece: usize,
    /// The point of the page that its piece carries: the drawn anchor of the piece, or the part's own place.
    pub from: Point,
    /// A metre along the scene's x and y, px.
    pub axes: [Point; 2],
}

impl Moving {
    pub(super) fn of(numbers: Parts, layout: Layout, poses: Poses, shift: Point) -> Moving {
        let part = |number: usize| {
            let (piece, placed) = (poses.piece(numbers.part(number)), &layout.parts[number]);
            let from = poses.pieces[piece].anchor.map_or(placed.at, |anchor| placed.point(anchor));
            MovingPart { piece, from: from.plus(shift), axes: placed.axes }
        };
        let parts = (0..numbers.count()).map(part).collect();
        Moving { layout, numbers, parts, poses }
    }

    /// The factor by which a shape is multiplied so that it is clearly visible.
    pub fn amount(&self, shape: &[Displacement]) -> f64 {
        stage::amount(self.numbers, &self.layout, &self.poses.displace(shape))
    }

    /// Displacements are drawn to scale.
    pub fn is_to_scale(&self) -> bool {
        self.layout.scale.is_some()
    }
}
