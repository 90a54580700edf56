//! The poses of parts at rest and in a shape, for pictures. In: a mechanism at rest and displacements of its coordinates.
//! Out: rotation and slides of each piece of welded parts. Lowering itself does not need this. See docs/draw.md.

use super::constraints::Constraint;
use super::kinematics::{Index, Kinematics, PathEvaluation};
use super::mechanism::Mechanism;
use super::tree::Piece;
use crate::base::{Number, Vec3};
use crate::model::scene::{BaseId, BodyId, Part};
use std::collections::BTreeMap;

/// A value at rest (measured from the drawing) and in the shape (measured from rest): at `a` times the shape it is
/// `rest + a shape + a^2 bend`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RestAndShape {
    pub rest: f64,
    pub shape: f64,
    /// The second-order displacement that joints closing loops require, so that they stay closed in a visibly large
    /// motion.
    pub bend: f64,
}

impl RestAndShape {
    /// The value at a multiple of the shape.
    pub fn at(&self, amount: f64) -> f64 {
        self.rest + amount * (self.shape + amount * self.bend)
    }
}

/// The pose of a piece relative to the piece that carries it. Carriers come first; piece 0 is the ground.
#[derive(Clone, Debug, PartialEq)]
pub struct Carried {
    pub carrier: u32,
    /// The drawn point at which the carrier holds the piece, m; `None` if it has no known position.
    pub anchor: Option<[f64; 2]>,
    /// Its absolute angle, rad.
    pub angle: RestAndShape,
    /// Its slides, m, along directions that turn with the carrier.
    pub slides: Vec<([f64; 2], RestAndShape)>,
}

/// The poses of all pieces, and the piece that each part belongs to.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Poses {
    pub pieces: Vec<Carried>,
    bodies: Vec<u32>,
    bases: Vec<u32>,
    /// The coordinate behind each value.
    coordinates: Vec<Option<Index>>,
}

impl Poses {
    pub fn piece(&self, part: Part) -> usize {
        let found = match part {
            Part::Ground => None,
            Part::Body(BodyId(body)) => self.bodies.get(body as usize),
            Part::Base(BaseId(base)) => self.bases.get(base as usize),
        };
        found.map_or(0, |piece| *piece as usize)
    }

    /// All values, piece by piece: the angle, then the slides.
    pub fn values(&self) -> impl Iterator<Item = &RestAndShape> {
        self.pieces
            .iter()
            .flat_map(|piece| std::iter::once(&piece.angle).chain(piece.slides.iter().map(|(_, value)| value)))
    }

    /// The same poses, displaced: one displacement for each of [`Poses::values`].
    pub fn displace(&self, by: &[Displacement]) -> Poses {
        let mut poses = self.clone();
        let values = poses
            .pieces
            .iter_mut()
            .flat_map(|piece| std::iter::once(&mut piece.angle).chain(piece.slides.iter_mut().map(|(_, value)| value)));
        for (value, by) in values.zip(by) {
            (value.shape, value.bend) = (by.shape, by.bend);
        }
        poses
    }
}

/// The part of a value that a shape adds; see [`RestAndShape`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Displacement {
    pub shape: f64,
    pub bend: f64,
}

impl Mechanism {
    /// The poses at rest.
    pub fn poses(&self) -> Poses {
        let Mechanism { kinematics, state, .. } = self;
        let at_rest = |i: Index| RestAndShape { rest: state.value(i).to_f64(), ..RestAndShape::default() };
        let carried = |(piece, of): (u32, &Piece)| Carried {
            carrier: of.carrier,
            anchor: of.anchor.as_deref().map(planar),
            angle: kinematics.angle(piece).map_or(RestAndShape::default(), at_rest),
            slides: kinematics.slides_of(piece).map(|(i, direction)| (planar(direction), at_rest(i))).collect(),
        };
        let tree = &kinematics.tree;
        let of_piece = |(piece, _)| {
            std::iter::once(kinematics.angle(piece)).chain(kinematics.slides_of(piece).map(|(i, _)| Some(i)))
        };
        Poses {
            pieces: (0..).zip(&tree.pieces).map(carried).collect(),
            bodies: tree.bodies.clone(),
            bases: tree.bases.clone(),
            coordinates: (0..).zip(&tree.pieces).flat_map(of_piece).collect(),
        }
    }

    /// What a shape of the system's coordinates (m, rad) adds to each of [`Poses::values`] of this mechanism.
    pub fn displacements(&self, poses: &Poses, shape: &[f64]) -> Vec<Displacement> {
        let Mechanism { kinematics, reduction, .. } = self;
        let mut moved = vec![0.0; kinematics.total()];
        for (place, value) in shape.iter().enumerate().take(reduction.n()) {
            let coordinate = reduction.at(place);
            moved[coordinate as usize] = value / unit(kinematics, coordinate);
        }
        for dependent in reduction.dependent() {
            let Some((_, row)) = reduction.equation(dependent) else { continue };
            let sum: f64 = row.iter().map(|(i, entry)| entry.to_f64() * moved[*i as usize]).sum();
            moved[dependent as usize] = -sum;
        }
        let bends = self.bends(&moved);
        let of = |coordinate: &Option<Index>| {
            coordinate.map_or(Displacement::default(), |i| Displacement {
                shape: moved[i as usize],
                bend: bends.get(&i).copied().unwrap_or_default(),
            })
        };
        poses.coordinates.iter().map(of).collect()
    }

    /// Whether some joint or coupling relates coordinates nonlinearly, as joints that close loops of turning parts do.
    pub fn closes_loops(&self) -> bool {
        self.holding.constraints.list.iter().any(|constraint| !constraint.equation.is_linear())
    }

    /// Half the second derivatives of the dependent coordinates along a motion in which the others move evenly. A constraint
    /// g(q) = 0 holds to second order if G q2 = -g''(q1, q1)/2; the combination of constraints for a dependent coordinate
    /// has its own entry of q2 alone on the left.
    fn bends(&self, moved: &[f64]) -> BTreeMap<Index, f64> {
        let mut path = PathEvaluation::default();
        let curved = |constraint: &Constraint| {
            let mut sum = 0.0;
            let Mechanism { kinematics, state, .. } = self;
            constraint.equation.curvature(kinematics, state, &Number::ONE, &mut path, |i, j, value| {
                let times = if i == j { 1.0 } else { 2.0 };
                sum += times * value.to_f64() * moved[i as usize] * moved[j as usize];
            });
            sum
        };
        let curved: Vec<f64> = self.holding.constraints.list.iter().map(curved).collect();
        if curved.iter().all(|value| *value == 0.0) {
            return BTreeMap::new();
        }
        let bend = |dependent: Index| {
            let factors = self.reduction.combination(dependent);
            let sum: f64 = factors.iter().map(|(number, factor)| factor.to_f64() * curved[*number as usize]).sum();
            (dependent, -0.5 * sum)
        };
        self.reduction.dependent().map(bend).collect()
    }
}

fn planar(v: &Vec3) -> [f64; 2] {
    [v.x.to_f64(), v.y.to_f64()]
}

/// The length that is the unit of a coordinate: one, except for oblique directions of irrational length.
fn unit(kinematics: &Kinematics, coordinate: Index) -> f64 {
    kinematics.length_squared(coordinate).map_or(1.0, |square| square.to_f64().sqrt())
}
