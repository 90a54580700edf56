//! The nodes of a mode shape on rigid bodies: the points that stay where they are while the body turns about them. See
//! docs/method/report.md#nodes.

use super::mechanism::Mechanism;
use super::poses::Poses;
use crate::base::{Name, Unproven};
use crate::elements::{Scalar, Vector};
use crate::model::scene::{BodyId, Part, Scene};

/// The point of a turning body that stays in place in a shape. It may lie outside the body.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct ShapeNode {
    pub body: Name,
    /// x and y of its position at rest, m; if the body has no position, of the arm from the body's centre.
    pub at: [Unproven; 2],
    pub from_centre: bool,
}

/// A body turns if its rotation, in rad, is more than this share of the shape's largest entry, in m or rad. Entries have
/// errors of some 1e-15 of the largest, so a quotient by the rotation keeps six digits.
const TURNS: f64 = 1e-9;
/// A coordinate below this share of the lengths that it is made of is a rounding error.
const NOTHING: f64 = 1e-12;

/// How a piece of welded parts moves in a shape.
#[derive(Clone)]
struct Moving {
    /// The drawn point that is followed; `None` if the piece has no known position.
    anchor: Option<Vector<f64>>,
    /// Where it is at rest, m, and how the shape moves it.
    at: Vector<f64>,
    shift: Vector<f64>,
    /// The piece's angle at rest, and how the shape turns it, rad.
    angle: f64,
    turn: f64,
}

/// The node of a shape (m, rad) on each turning body, in order of the bodies; where several are welded to each other, on
/// the first.
pub fn nodes(scene: &Scene, mechanism: &Mechanism, shape: &[Unproven]) -> Vec<ShapeNode> {
    let entries: Vec<f64> = shape.iter().map(|entry| entry.0).collect();
    let largest = entries.iter().fold(0.0, |largest: f64, entry| largest.max(entry.abs()));
    let at_rest = mechanism.poses();
    let poses = at_rest.displace(&mechanism.displacements(&at_rest, &entries));
    let moving = moving(&poses);
    let mut seen = vec![false; moving.len()];
    let node = |(body, name): (u32, Name)| {
        let piece = poses.piece(Part::Body(BodyId(body)));
        let Moving { anchor, at, shift, turn, .. } = &moving[piece];
        if std::mem::replace(&mut seen[piece], true) || turn.abs() <= TURNS * largest {
            return None;
        }
        // shift + turn z × (node - at) = 0
        let arm = [-shift.y / turn, shift.x / turn];
        let scale = [at.x, at.y, arm[0], arm[1], largest / turn].into_iter().map(f64::abs).fold(0.0, f64::max);
        let place = |sum: f64| Unproven(if sum.abs() <= NOTHING * scale { 0.0 } else { sum });
        let at = [place(at.x + arm[0]), place(at.y + arm[1])];
        Some(ShapeNode { body: name, at, from_centre: anchor.is_none() })
    };
    (0..).zip(scene.bodies.iter().map(|body| body.name)).filter_map(node).collect()
}

/// The motion of each piece, carriers first.
fn moving(poses: &Poses) -> Vec<Moving> {
    let [_, _, z] = Vector::axes();
    let planar = |[x, y]: [f64; 2]| Vector { x, y, z: 0.0 };
    let mut pieces: Vec<Moving> = Vec::with_capacity(poses.pieces.len());
    for of in &poses.pieces {
        let ground = Moving { anchor: None, at: Vector::zero(), shift: Vector::zero(), angle: 0.0, turn: 0.0 };
        // The ground comes first and carries itself.
        let carrier = pieces.get(of.carrier as usize).unwrap_or(&ground);
        let (sine, cosine) = Scalar::sin_cos(&carrier.angle);
        let as_carried = |drawn: Vector<f64>| drawn.rotate(&z, &sine, &cosine);
        let (mut slid, mut shift) = (Vector::zero(), carrier.shift.clone());
        for (direction, value) in &of.slides {
            let direction = as_carried(planar(*direction));
            slid = slid.plus(&direction.scale(&value.rest));
            shift = shift.plus(&direction.scale(&value.shape));
        }
        let anchor = of.anchor.map(planar);
        let arm = match (&anchor, &carrier.anchor) {
            (Some(anchor), Some(held)) => as_carried(anchor.minus(held)).plus(&slid),
            // The carrier has no place, or is the ground: it does not turn about any.
            (Some(anchor), None) => anchor.plus(&slid),
            (None, _) => slid,
        };
        if carrier.anchor.is_some() {
            shift = shift.plus(&z.scale(&carrier.turn).cross(&arm));
        }
        let at = carrier.at.plus(&arm);
        pieces.push(Moving { anchor, at, shift, angle: of.angle.rest, turn: of.angle.shape });
    }
    pieces
}
