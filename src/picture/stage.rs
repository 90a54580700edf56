//! The positions of everything in a figure: as drawn, at rest, or moved by a mode. Bodies stay rigid: they turn by
//! their angle and are not sheared, so a mode of a scene to scale is shown small enough for the difference not to
//! matter. If joints close loops, the dependent coordinates move to second order, so that the joints stay closed.

use super::geometry::{Point, Turn};
use super::layout::{Layout, Outline, Parts};
use crate::lower::Poses;

/// Largest displacement of a point in a mode, px (not to scale and to scale), and largest rotation of a part, rad.
const FAR: [f64; 2] = [22.0, 46.0];
const TURNED: f64 = 0.4;

/// The parts of a layout, moved.
pub struct Stage<'a> {
    pub layout: &'a Layout,
    /// For each part; empty if all parts are as drawn.
    moved: Vec<Moved>,
    /// The factor by which the shape is multiplied.
    pub amount: f64,
}

/// A point that moves with a part: from the page as drawn to the page as shown.
#[derive(Clone, Copy, Debug)]
struct Moved {
    from: Point,
    to: Point,
    turn: Turn,
}

/// A piece of welded parts, m.
#[derive(Clone, Copy, Debug)]
struct Piece {
    anchor: Option<Point>,
    /// The present position of its anchor.
    at: Point,
    turn: Turn,
}

impl<'a> Stage<'a> {
    pub fn as_drawn(layout: &'a Layout) -> Stage<'a> {
        Stage { layout, moved: Vec::new(), amount: 0.0 }
    }

    /// The stage at rest, displaced by a multiple of the shape.
    pub fn at(parts: Parts, layout: &'a Layout, poses: &Poses, amount: f64) -> Stage<'a> {
        let pieces = pieces(poses, amount);
        let moved = (0..parts.count()).map(|number| {
            let (piece, placed) = (pieces[poses.piece(parts.part(number))], &layout.parts[number]);
            let vector = |v: Point| placed.axes[0].times(v.x).plus(placed.axes[1].times(v.y));
            match piece.anchor {
                Some(anchor) => {
                    let from = placed.point([anchor.x, anchor.y]);
                    Moved { from, to: from.plus(vector(piece.at.minus(anchor))), turn: piece.turn }
                }
                None => Moved { from: placed.at, to: placed.at.plus(vector(piece.at)), turn: piece.turn },
            }
        });
        Stage { layout, moved: moved.collect(), amount }
    }

    /// The position on the page of a drawn point that moves with a part.
    pub fn point(&self, part: usize, drawn: Point) -> Point {
        match self.moved.get(part) {
            None => drawn,
            Some(Moved { from, to, turn }) => to.plus(drawn.minus(*from).rotate(*turn)),
        }
    }

    /// The position of a point that moves with a part but does not turn with it, such as the end of a shaft.
    pub fn carry(&self, part: usize, drawn: Point) -> Point {
        let at = self.layout.parts[part].at;
        drawn.plus(self.point(part, at)).minus(at)
    }

    /// A vector that turns with a part.
    pub fn vector(&self, part: usize, drawn: Point) -> Point {
        self.moved.get(part).map_or(drawn, |moved| drawn.rotate(moved.turn))
    }

    /// The position of a part.
    pub fn place(&self, part: usize) -> Point {
        self.point(part, self.layout.parts[part].at)
    }
}

fn pieces(poses: &Poses, amount: f64) -> Vec<Piece> {
    let mut pieces: Vec<Piece> = Vec::with_capacity(poses.pieces.len());
    for (index, of) in poses.pieces.iter().enumerate() {
        let carrier = match index {
            0 => Piece { anchor: None, at: Point::default(), turn: Turn::NONE },
            _ => pieces[of.carrier as usize],
        };
        let slid = of
            .slides
            .iter()
            .fold(Point::default(), |sum, ([x, y], value)| sum.towards(Point::new(*x, *y), value.at(amount)));
        // The scene's y runs upwards, which `turned` takes for downwards.
        let turned = |v: Point, turn: Turn| v.rotate(Turn { sine: -turn.sine, ..turn });
        let slid = turned(slid, carrier.turn);
        let turn = Turn::from_angle(of.angle.at(amount));
        let anchor = of.anchor.map(|[x, y]| Point::new(x, y));
        let at = match (anchor, carrier.anchor) {
            (Some(anchor), Some(held)) => carrier.at.plus(turned(anchor.minus(held), carrier.turn)).plus(slid),
            // The carrier has no place, or is the ground: it does not turn about any.
            (Some(anchor), None) => anchor.plus(carrier.at).plus(slid),
            (None, _) => carrier.at.plus(slid),
        };
        pieces.push(Piece { anchor, at, turn });
    }
    pieces
}

/// The factor at which the second-order motion of loops is half of the shape: beyond it, the shape would look
/// different.
fn by_bend(poses: &Poses) -> f64 {
    const SHARE: f64 = 0.5;
    let angles = poses.pieces.iter().map(|piece| (piece.angle.shape, piece.angle.bend));
    let slides = poses.pieces.iter().flat_map(|piece| piece.slides.iter().map(|(_, value)| (value.shape, value.bend)));
    let largest = |(shape, bend): (f64, f64), (own, more): (f64, f64)| (shape.max(own.abs()), bend.max(more.abs()));
    let until = |(shape, bend)| if shape > 0.0 && bend > 0.0 { SHARE * shape / bend } else { f64::INFINITY };
    until(angles.fold((0.0, 0.0), largest)).min(until(slides.fold((0.0, 0.0), largest)))
}

/// The factor by which a shape is multiplied so that it is clearly visible.
pub fn amount(parts: Parts, layout: &Layout, poses: &Poses) -> f64 {
    let largest = poses.values().map(|value| value.shape.abs()).fold(0.0, f64::max);
    if largest == 0.0 {
        return 0.0;
    }
    // Displacements are as good as linear over such a way.
    let little = 1e-4 / largest;
    let (rest, moved) = (Stage::at(parts, layout, poses, 0.0), Stage::at(parts, layout, poses, little));
    let mut way: f64 = 0.0;
    for (number, placed) in layout.parts.iter().enumerate() {
        let ends = match &placed.outline {
            Outline::Rod { arm } => [placed.at.plus(*arm), placed.at.minus(*arm)],
            _ => [placed.at; 2],
        };
        for point in ends.iter().chain(&placed.arms) {
            way = way.max(moved.point(number, *point).distance(rest.point(number, *point)));
        }
    }
    let far = if layout.scale.is_some() { FAR[1] } else { FAR[0] };
    let by_way = if way > 0.0 { far * little / way } else { f64::INFINITY };
    let turned = poses.pieces.iter().map(|piece| piece.angle.shape.abs()).fold(0.0, f64::max);
    let by_turn = if turned > 0.0 { TURNED / turned } else { f64::INFINITY };
    by_way.min(by_turn).min(by_bend(poses))
}
