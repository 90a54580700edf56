//! What a figure needs to move: which part rides on which piece, how the pieces carry each other, and how each coordinate of the
//! system moves them. It is what [`super::stage`] computes with, as plain data: the script of a page does the same with it.

use super::geometry::Point;
use super::layout::{Layout, Parts};
use super::stage;
use crate::lower::Poses;

/// A scene at rest that may be moved.
#[derive(Clone, Debug)]
pub struct Moving {
    layout: Layout,
    numbers: Parts,
    /// By the number of a part, the ground first.
    pub parts: Vec<MovingPart>,
    pub poses: Poses,
}

/// A part on the page.
#[derive(Clone, Copy, Debug)]
pub struct MovingPart {
    pub piece: usize,
    /// The page's point of it that its piece carries: where the anchor of the piece is drawn, or its own place.
    pub from: Point,
    /// A metre along the scene's x and y, px.
    pub axes: [Point; 2],
}

impl Moving {
    pub(super) fn of(numbers: Parts, layout: Layout, poses: &Poses, shift: Point) -> Moving {
        let part = |number: usize| {
            let (piece, placed) = (poses.piece(numbers.part(number)), &layout.parts[number]);
            let from = poses.pieces[piece].anchor.map_or(placed.at, |anchor| placed.point(anchor));
            MovingPart { piece, from: from.plus(shift), axes: placed.axes }
        };
        let parts = (0..numbers.count()).map(part).collect();
        Moving { layout, numbers, parts, poses: poses.clone() }
    }

    /// How many times a shape is shown so that it is seen well, and what that is said to be.
    pub fn amount(&self, shape: &Poses) -> f64 {
        stage::amount(self.numbers, &self.layout, shape)
    }

    /// Displacements are drawn to scale.
    pub fn is_to_scale(&self) -> bool {
        self.layout.scale.is_some()
    }
}
