//! How points move with the coordinates, and their exact first and second derivatives. See docs/method/kinematics.md.
//!
//! Parts without relative rotation (connected by welds and slides) share one angle: a *group*. The coordinate of a group
//! is its absolute angle, so the displacement of a point from the drawing is a sum over the groups g on the path from the
//! ground,
//!
//! ```text
//! u(q) = sum_g (R_g - 1) v_g + sum_k s_k R_g(k) d_k
//! ```
//!
//! with v_g the section of the path that lies in group g as drawn and s_k the slides on the path. Hence, with
//! w_g = R_g (v_g + sum of s_k d_k in g) and the axis a_g,
//!
//! ```text
//! du/dtheta_g = a_g x w_g          d2u/dtheta_g^2 = a_g x (a_g x w_g)
//! du/ds_k     = R_g d_k            d2u/dtheta_g ds_k = a_g x R_g d_k          all others zero.
//! ```
//!
//! The ground is the group without an angle. Prescribed motions of bases are coordinates too; they come after the free
//! ones.

mod numbering;
mod path;
mod release;

pub use path::{Path, PathEvaluation, State};
pub use release::{Released, Unreleased, axis_of};

use numbering::Numbering;
use path::{Run, Turn};

use super::error::LowerError;
use super::tree::{GROUND, PieceId, Tree};
use crate::base::{FileId, Number, OrderBy, Span, Vec3};
use crate::elements::{Scalar, Vector};
use crate::model::scene::{Attachment, BodyId, Freedom, Geometry, Input, InputKind, Motion, MotionTerm, Part, Scene};
use crate::system::CoordinateKind;

/// Index of a coordinate, free or prescribed.
pub type Index = u32;

/// The group of the ground.
const NO_TURN: u32 = 0;

#[derive(Clone, Debug)]
pub struct Kinematics {
    pub tree: Tree,
    carriages: Vec<Carriage>,
    groups: Vec<Group>,
    slides: Vec<Slide>,
    directions: Vec<Vec3>,
    /// The group of each coordinate that is an angle; the ground's group for slides.
    group_of: Vec<u32>,
    /// The body of each free coordinate, in order.
    pub free: Vec<BodyId>,
    /// Number of motions of bases, which follow the free coordinates.
    pub prescribed: usize,
    /// The index of the input for each of them.
    pub prescribed_inputs: Vec<u32>,
    /// Squared lengths of the directions of oblique slides whose length is irrational. The coordinate is measured in
    /// units of that length until it leaves this module, so that rows stay exact. Ascending by coordinate.
    lengths_squared: Vec<(Index, Number)>,
    /// Angles that are sums of other angles, in a mechanism with released joints: each with its terms, ascending.
    followers: Vec<(Index, Vec<(Index, Number)>)>,
}

/// Limit on the entries of all rows together: 800 MB.
const MAX_ENTRIES: u64 = 20_000_000;
/// Limit on the entries when chained rows are written out for analyses: 200 MB, a pendulum of 2,000 links.
pub const MAX_WRITTEN_OUT: u64 = 5_000_000;
/// Rows of masses with up to this many entries in total are written out: some hundred links, which dense methods handle
/// quickly.
const FLAT_ENTRIES: u64 = 20_000;
/// Rows that are shorter than this on average gain nothing from being chained.
const FLAT_ROW: u64 = 32;

/// The group and the slides of a piece.
#[derive(Clone, Copy, Debug)]
struct Carriage {
    depth: u32,
    group: u32,
    first_slide: u32,
    slides: u8,
}

#[derive(Clone, Debug)]
struct Group {
    /// Meaningless for the ground.
    coordinate: Index,
    axis: Vec3,
}

#[derive(Clone, Copy, Debug)]
struct Slide {
    coordinate: Index,
    direction: u32,
    /// The group with which the direction turns; the carrier's if `None`.
    group: Option<u32>,
}

/// An end of an element: a point of a piece, or the point that holds the piece.
#[derive(Clone, Copy, Debug)]
pub struct End<'a> {
    pub piece: PieceId,
    pub at: Option<&'a Vec3>,
}

impl End<'_> {
    pub const GROUND: End<'static> = End { piece: GROUND, at: None };
}

impl Kinematics {
    pub fn new(scene: &Scene, tree: Tree) -> Kinematics {
        Numbering::new(scene, tree).finish()
    }

    /// Number of free coordinates.
    pub fn n(&self) -> usize {
        self.free.len()
    }

    /// Free and prescribed coordinates.
    pub fn total(&self) -> usize {
        self.free.len() + self.prescribed
    }

    pub fn end<'a>(&self, attachment: &'a Attachment) -> End<'a> {
        End { piece: self.tree.piece(attachment.part), at: attachment.at.as_deref() }
    }

    pub fn point<'a>(&self, part: Part, at: Option<&'a Vec3>) -> End<'a> {
        End { piece: self.tree.piece(part), at }
    }

    /// The angle coordinate of a piece; `None` if it does not turn.
    pub fn angle(&self, piece: PieceId) -> Option<Index> {
        let group = self.carriages[piece as usize].group;
        (group != NO_TURN).then(|| self.groups[group as usize].coordinate)
    }

    /// The slides by which a piece moves relative to its carrier: coordinate, and direction as drawn.
    pub fn slides_of(&self, piece: PieceId) -> impl Iterator<Item = (Index, &Vec3)> {
        self.own_slides(piece).iter().map(|slide| (slide.coordinate, &self.directions[slide.direction as usize]))
    }

    /// Squared length of the direction that is the unit of a coordinate; `None` if the length is one.
    pub fn length_squared(&self, coordinate: Index) -> Option<&Number> {
        let found = self.lengths_squared.binary_search_by_key(&coordinate, |(index, _)| *index).ok()?;
        Some(&self.lengths_squared[found].1)
    }

    /// The axis about which a coordinate turns; z for one that does not.
    pub fn axis<S: Scalar>(&self, coordinate: Index) -> Vector<S> {
        Vector::of(&self.groups[self.group_of[coordinate as usize] as usize].axis)
    }

    pub fn is_angle(&self, coordinate: Index) -> bool {
        self.group_of[coordinate as usize] != NO_TURN
    }

    pub fn kind(&self, coordinate: Index) -> CoordinateKind {
        if self.is_angle(coordinate) { CoordinateKind::Rotation } else { CoordinateKind::Translation }
    }

    /// The word for the motion of a free coordinate: `x`, `y`, `along`, `slide`, `angle`.
    pub fn motion(&self, scene: &Scene, coordinate: Index) -> &'static str {
        if self.is_angle(coordinate) {
            return "angle";
        }
        let body = self.free[coordinate as usize];
        match &scene.bodies[body.index()].freedom {
            Freedom::FromJoints => "slide",
            Freedom::OnGround { translations, .. } => {
                let first = self.own_slides(self.tree.bodies[body.index()])[0].coordinate;
                translations[(coordinate - first) as usize].motion
            }
        }
    }

    pub fn has_oblique(&self) -> bool {
        !self.lengths_squared.is_empty()
    }

    /// Whether the piece turns about a point whose place is unknown.
    pub fn turns_about_nowhere(&self, piece: PieceId) -> bool {
        self.carriages[piece as usize].group != NO_TURN && self.tree.pieces[piece as usize].anchor.is_none()
    }

    /// Checks the conditions for any evaluation.
    pub fn check(&self, scene: &Scene) -> Result<(), Vec<LowerError>> {
        if self.free.is_empty() {
            let span = scene.bodies.first().map_or_else(|| Span::new(FileId(0), 0, 0), |body| body.span);
            return Err(vec![LowerError::NoFreedom { span }]);
        }
        let nowhere = self.used_without_place(scene);
        if !nowhere.is_empty() {
            return Err(nowhere);
        }
        self.limit_entries(scene)
    }

    /// Errors for points of parts that turn about an unknown place.
    fn used_without_place(&self, scene: &Scene) -> Vec<LowerError> {
        if !(0..self.carriages.len()).any(|piece| self.turns_about_nowhere(piece as PieceId)) {
            return Vec::new();
        }
        let elements = scene.elements.iter().filter(|element| element.law.geometry != Geometry::Torsion);
        let is_torque = |input: &&Input| matches!(input.kind, InputKind::Torque { .. });
        let inputs = scene.inputs.iter().filter(|input| !is_torque(input)).flat_map(|input| input.kind.ends());
        let joints = scene.joints.iter().filter(|joint| !joint.kind.is_rigid());
        let ends = joints.flat_map(|joint| &joint.ends).chain(elements.flat_map(|element| &element.ends)).chain(inputs);
        let ends = ends.filter(|end| end.at.is_some()).map(|end| (end.part, end.span));
        let nowhere = |(part, _): &(Part, Span)| self.turns_about_nowhere(self.tree.piece(*part));
        let ends = ends.filter(nowhere).filter_map(|(part, span)| unknown_place(scene, part, span));
        ends.chain(scene.outputs.iter().flat_map(|output| self.read_without_place(scene, &output.terms, output.span)))
            .collect()
    }

    /// Errors for outputs at points of parts that turn about an unknown place.
    pub fn read_without_place(&self, scene: &Scene, terms: &[MotionTerm], span: Span) -> Vec<LowerError> {
        let point = |term: &MotionTerm| match &term.motion {
            Motion::Point { part, at: Some(_), .. } if self.turns_about_nowhere(self.tree.piece(*part)) => {
                unknown_place(scene, *part, span)
            }
            _ => None,
        };
        terms.iter().filter_map(point).collect()
    }

    /// Whether the rows of the masses are chained (docs/method/system.md#deep-trees): they would be long if written out,
    /// and every coordinate is free and measured in its own unit.
    pub fn hangs_deep(&self, scene: &Scene) -> bool {
        if self.prescribed > 0 || self.has_oblique() || !self.tree.closing.is_empty() || !scene.couples.is_empty() {
            return false;
        }
        let widths = self.widths();
        let entries: u64 = self.tree.bodies.iter().map(|piece| 2 * widths[*piece as usize]).sum();
        entries > FLAT_ENTRIES && entries > FLAT_ROW * scene.bodies.len() as u64
    }

    /// Rows are as long as their path to the ground, so their total length is limited before they are made.
    fn limit_entries(&self, scene: &Scene) -> Result<(), Vec<LowerError>> {
        let widths = self.widths();
        let width = |part| widths[self.tree.piece(part) as usize];
        let flat = if self.hangs_deep(scene) { 0 } else { scene.bodies.len() };
        let bodies = (0..flat).map(|body| 2 * width(Part::Body(BodyId(body as u32))));
        let elements = scene.elements.iter().map(|element| self.coordinate_bound_between(&element.ends, &widths));
        let entries = bodies.chain(elements).fold(0u64, u64::saturating_add);
        if entries <= MAX_ENTRIES {
            return Ok(());
        }
        let deepest = (0..scene.bodies.len()).max_by_key(|&body| width(Part::Body(BodyId(body as u32))));
        let span = scene.bodies[deepest.unwrap_or(0)].span;
        Err(vec![LowerError::TooDeep { entries, span }])
    }

    /// Upper bound on the number of coordinates that move two ends relative to each other.
    fn coordinate_bound_between(&self, ends: &[Attachment; 2], widths: &[u64]) -> u64 {
        let [mut a, mut b] = [0, 1].map(|end| self.tree.piece(ends[end].part));
        let sum = widths[a as usize] + widths[b as usize];
        // Most ends are on neighbouring pieces: a few steps find their common carrier.
        for _ in 0..8 {
            if a == b {
                return sum - 2 * widths[a as usize] + 1;
            }
            let later = if a > b { &mut a } else { &mut b };
            *later = self.tree.pieces[*later as usize].carrier;
        }
        sum
    }

    /// The number of coordinates on the path from the ground to each piece, including the piece's own.
    fn widths(&self) -> Vec<u64> {
        let mut widths = vec![0u64; self.carriages.len()];
        for (index, carriage) in self.carriages.iter().enumerate().skip(1) {
            let carrier = self.tree.pieces[index].carrier as usize;
            let own_turn = u64::from(self.tree.pieces[index].turns);
            widths[index] = widths[carrier] + own_turn + u64::from(carriage.slides);
        }
        widths
    }

    /// The path from one end to the other: the coordinates that move the second relative to the first.
    pub fn path_between(&self, from: End, to: End, path: &mut Path<Number>) {
        path.clear();
        let mut walk = Walk { kinematics: self, path, last: [usize::MAX; 2] };
        let mut ends = [from, to];
        while ends[0].piece != ends[1].piece {
            let deeper = usize::from(self.depth(ends[1].piece) >= self.depth(ends[0].piece));
            ends[deeper] = walk.step(ends[deeper], deeper);
        }
        for (side, end) in ends.into_iter().enumerate() {
            walk.arm(end, side);
        }
    }

    fn depth(&self, piece: PieceId) -> u32 {
        self.carriages[piece as usize].depth
    }

    fn own_slides(&self, piece: PieceId) -> &[Slide] {
        let carriage = &self.carriages[piece as usize];
        &self.slides[carriage.first_slide as usize..carriage.first_slide as usize + carriage.slides as usize]
    }

    /// The mass-weighted sum of the paths to all centres of mass, for a uniform field of gravity. Takes time linear in
    /// the number of pieces. Slides on the ground perpendicular to the field are left out, since it does no work on them.
    pub fn mass_weighted_path(&self, scene: &Scene, field: &Vec3) -> Path<Number> {
        let mut carried = vec![Number::ZERO; self.carriages.len()];
        let mut arms: Vec<Option<Vector<Number>>> = vec![None; self.groups.len()];
        for (index, body) in scene.bodies.iter().enumerate() {
            let piece = self.tree.bodies[index] as usize;
            if let Some(mass) = &body.mass {
                carried[piece] = &carried[piece] + mass;
                self.add_moment(&mut arms, piece, body.centre.as_deref(), mass);
            }
        }
        let mut path = Path::default();
        for piece in (1..self.carriages.len()).rev() {
            let mass = std::mem::replace(&mut carried[piece], Number::ZERO);
            if mass.is_zero() {
                continue;
            }
            let carrier = self.tree.pieces[piece].carrier as usize;
            for slide in self.own_slides(piece as PieceId) {
                let group = slide.group.unwrap_or(self.carriages[carrier].group);
                let direction = &self.directions[slide.direction as usize];
                if group != NO_TURN || !direction.dot(field).is_zero() {
                    let direction = Vector::of(direction).scale(&mass);
                    path.runs.push(Run { coordinate: slide.coordinate, group, direction });
                }
            }
            self.add_moment(&mut arms, carrier, self.tree.pieces[piece].anchor.as_deref(), &mass);
            carried[carrier] = &carried[carrier] + &mass;
        }
        path.turns =
            arms.into_iter().enumerate().filter_map(|(g, arm)| Some(Turn { group: g as u32, arm: arm? })).collect();
        path.runs.order_by_key(|run| run.coordinate);
        path
    }

    /// First moment of a mass at `at`, carried by `piece`, about the piece's anchor.
    fn add_moment(&self, arms: &mut [Option<Vector<Number>>], piece: usize, at: Option<&Vec3>, mass: &Number) {
        let group = self.carriages[piece].group as usize;
        let Some(arm) = self.arm(piece as PieceId, at) else { return };
        let moment = arm.scale(mass);
        let sum = arms[group].take().map_or_else(|| moment.clone(), |sum| sum.plus(&moment));
        arms[group] = Some(sum);
    }

    /// The vector from a turning piece's anchor to a point of it. `None` if there is none: the piece does not turn, a
    /// place is unknown, or both are the same place (even if its coordinates are known only as balls).
    fn arm(&self, piece: PieceId, at: Option<&Vec3>) -> Option<Vector<Number>> {
        let anchor = self.tree.pieces[piece as usize].anchor.as_deref()?;
        let at = at.filter(|at| !std::ptr::eq(*at, anchor))?;
        (self.carriages[piece as usize].group != NO_TURN).then(|| Vector::of(&at.sub(anchor)))
    }
}

/// A walk towards the ground from both sides: side 1 counts as positive, side 0 as negative.
struct Walk<'k, 'p> {
    kinematics: &'k Kinematics,
    path: &'p mut Path<Number>,
    /// Index in the path's turns of the last entry of each side.
    last: [usize; 2],
}

impl<'k> Walk<'k, '_> {
    /// Moves one piece towards the ground: adds its own arm and slides, and continues at the point by which the carrier
    /// holds it.
    fn step<'e>(&mut self, end: End<'e>, side: usize) -> End<'e>
    where
        'k: 'e,
    {
        let kinematics = self.kinematics;
        let piece = &kinematics.tree.pieces[end.piece as usize];
        self.arm(end, side);
        let group = kinematics.carriages[piece.carrier as usize].group;
        for slide in kinematics.own_slides(end.piece) {
            let direction = Vector::of(&kinematics.directions[slide.direction as usize]);
            let direction = if side == 1 { direction } else { direction.negate() };
            let group = slide.group.unwrap_or(group);
            self.path.runs.push(Run { coordinate: slide.coordinate, group, direction });
        }
        // A point without a place remains one only in groups that do not turn.
        End { piece: piece.carrier, at: piece.anchor.as_deref().or(end.at) }
    }

    /// Adds the arm from a piece's anchor to a point of it to the entry of the same group on either side.
    fn arm(&mut self, end: End, side: usize) {
        let Some(arm) = self.kinematics.arm(end.piece, end.at) else { return };
        let arm = if side == 1 { arm } else { arm.negate() };
        let group = self.kinematics.carriages[end.piece as usize].group;
        let turns = &mut self.path.turns;
        let known = self.last.iter().find(|&&at| turns.get(at).is_some_and(|turn| turn.group == group));
        match known {
            Some(&at) => turns[at].arm = turns[at].arm.plus(&arm),
            None => {
                self.last[side] = turns.len();
                turns.push(Turn { group, arm });
            }
        }
    }
}

fn unknown_place(scene: &Scene, part: Part, used: Span) -> Option<LowerError> {
    let (name, span) = match part {
        Part::Ground => return None,
        Part::Body(body) => (scene.bodies[body.index()].name, scene.bodies[body.index()].span),
        Part::Base(base) => (scene.bases[base.index()].name, scene.bases[base.index()].span),
    };
    Some(LowerError::UnknownPlace { body: scene.words.display(name), span, used })
}
