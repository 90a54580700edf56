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

mod release;

pub use release::{Released, Unreleased, axis_of};

use super::error::LowerError;
use super::tree::{GROUND, Owner, PieceId, Tree};
use crate::base::{FileId, Number, Span, Vec3};
use crate::elements::{Scalar, Vector};
use crate::model::scene::{Attachment, BodyId, Freedom, Geometry, Input, InputKind, Motion, MotionTerm, Part, Scene};
use crate::system::CoordinateKind;
use std::collections::BTreeMap;

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
    /// Free coordinates in order.
    pub free: Vec<FreeCoordinate>,
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

/// A free coordinate.
#[derive(Clone, Copy, Debug)]
pub struct FreeCoordinate {
    pub body: BodyId,
    pub motion: &'static str,
    pub kind: CoordinateKind,
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
        let elements = scene.elements.iter().filter(|element| element.geometry != Geometry::Torsion);
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
                    let direction = Vector::of(direction).scaled(&mass);
                    path.runs.push(Run { coordinate: slide.coordinate, group, direction });
                }
            }
            self.add_moment(&mut arms, carrier, self.tree.pieces[piece].anchor.as_deref(), &mass);
            carried[carrier] = &carried[carrier] + &mass;
        }
        path.turns =
            arms.into_iter().enumerate().filter_map(|(g, arm)| Some(Turn { group: g as u32, arm: arm? })).collect();
        path.runs.sort_by_key(|run| run.coordinate);
        path
    }

    /// First moment of a mass at `at`, carried by `piece`, about the piece's anchor.
    fn add_moment(&self, arms: &mut [Option<Vector<Number>>], piece: usize, at: Option<&Vec3>, mass: &Number) {
        let group = self.carriages[piece].group as usize;
        let Some(arm) = self.arm(piece as PieceId, at) else { return };
        let moment = arm.scaled(mass);
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
            let direction = if side == 1 { direction } else { direction.negated() };
            let group = slide.group.unwrap_or(group);
            self.path.runs.push(Run { coordinate: slide.coordinate, group, direction });
        }
        // A point without a place remains one only in groups that do not turn.
        End { piece: piece.carrier, at: piece.anchor.as_deref().or(end.at) }
    }

    /// Adds the arm from a piece's anchor to a point of it to the entry of the same group on either side.
    fn arm(&mut self, end: End, side: usize) {
        let Some(arm) = self.kinematics.arm(end.piece, end.at) else { return };
        let arm = if side == 1 { arm } else { arm.negated() };
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

/// The coordinates that move one point relative to another: arms of groups and slides, as drawn.
#[derive(Clone, Debug)]
pub struct Path<S> {
    turns: Vec<Turn<S>>,
    runs: Vec<Run<S>>,
}

#[derive(Clone, Debug)]
struct Turn<S> {
    group: u32,
    arm: Vector<S>,
}

#[derive(Clone, Debug)]
struct Run<S> {
    coordinate: Index,
    group: u32,
    direction: Vector<S>,
}

impl<S> Default for Path<S> {
    fn default() -> Path<S> {
        Path { turns: Vec::new(), runs: Vec::new() }
    }
}

impl<S> Path<S> {
    fn clear(&mut self) {
        self.turns.clear();
        self.runs.clear();
    }

    pub fn is_empty(&self) -> bool {
        self.turns.is_empty() && self.runs.is_empty()
    }

    /// Frees memory reserved for longer paths, which a stored path does not need.
    pub fn shrink_to_fit(&mut self) {
        self.turns.shrink_to_fit();
        self.runs.shrink_to_fit();
    }
}

impl<S> Path<S> {
    /// Whether all motion along this path is in fixed directions.
    pub fn is_straight(&self) -> bool {
        self.turns.is_empty() && self.runs.iter().all(|run| run.group == NO_TURN)
    }

    /// The coordinates of the path one by one; a slide in a turning group comes with the angle of that group.
    pub fn coordinates<'a>(&'a self, kinematics: &'a Kinematics) -> impl Iterator<Item = (Index, Option<Index>)> + 'a {
        let angle = |group: u32| kinematics.groups[group as usize].coordinate;
        let turns = self.turns.iter().map(move |turn| (angle(turn.group), None));
        let carried = move |group: u32| (group != NO_TURN).then(|| angle(group));
        turns.chain(self.runs.iter().map(move |run| (run.coordinate, carried(run.group))))
    }
}

impl Path<Number> {
    /// Whether all motion along this path is in one fixed direction.
    pub fn keeps_to(&self, direction: &Vector<Number>) -> bool {
        self.is_straight() && self.runs.iter().all(|run| run.direction.cross(direction).is_zero())
    }

    /// The longest arm, m.
    pub fn longest_arm(&self) -> f64 {
        self.turns.iter().map(|turn| turn.arm.norm_squared().to_f64().sqrt()).fold(0.0, f64::max)
    }

    /// The sections of a path that carries a fixed force, by the part of the scene they belong to; this is possible
    /// because such a path is a sum.
    pub fn split(
        self,
        kinematics: &Kinematics,
        part_of: impl Fn(Index) -> Option<usize>,
    ) -> BTreeMap<usize, Path<Number>> {
        let mut parts: BTreeMap<usize, Path<Number>> = BTreeMap::new();
        for turn in self.turns {
            if let Some(part) = part_of(kinematics.groups[turn.group as usize].coordinate) {
                parts.entry(part).or_default().turns.push(turn);
            }
        }
        for run in self.runs {
            if let Some(part) = part_of(run.coordinate) {
                parts.entry(part).or_default().runs.push(run);
            }
        }
        parts
    }

    pub fn converted<S: Scalar>(&self) -> Path<S> {
        let vector = |v: &Vector<Number>| Vector { x: S::of(&v.x), y: S::of(&v.y), z: S::of(&v.z) };
        let turn = |turn: &Turn<Number>| Turn { group: turn.group, arm: vector(&turn.arm) };
        let run =
            |run: &Run<Number>| Run { coordinate: run.coordinate, group: run.group, direction: vector(&run.direction) };
        Path { turns: self.turns.iter().map(turn).collect(), runs: self.runs.iter().map(run).collect() }
    }
}

/// Values of the coordinates, with the rotations of the groups evaluated.
#[derive(Clone, Debug)]
pub struct State<S> {
    /// Empty if all are as drawn.
    values: Vec<S>,
    /// Sine and cosine of each group's angle; `None` if it has not turned.
    turned: Vec<Option<(S, S)>>,
    zero: S,
}

impl<S: Scalar> State<S> {
    /// Everything as drawn.
    pub fn as_drawn() -> State<S> {
        State { values: Vec::new(), turned: Vec::new(), zero: S::zero() }
    }

    pub fn is_drawn(&self) -> bool {
        self.values.is_empty()
    }

    pub fn value(&self, coordinate: Index) -> &S {
        self.values.get(coordinate as usize).unwrap_or(&self.zero)
    }

    /// A vector rotated by an angle coordinate.
    pub fn turned(&self, kinematics: &Kinematics, angle: Index, v: &Vector<S>) -> Vector<S> {
        match self.turned.get(kinematics.group_of[angle as usize] as usize) {
            Some(Some((sine, cosine))) => v.turned(&kinematics.axis(angle), sine, cosine),
            _ => v.clone(),
        }
    }

    /// Moves one coordinate.
    pub fn set(&mut self, kinematics: &Kinematics, coordinate: Index, value: S) {
        if self.values.is_empty() {
            self.values = vec![S::zero(); kinematics.total()];
            self.turned = vec![None; kinematics.groups.len()];
        }
        let group = kinematics.group_of[coordinate as usize];
        if group != NO_TURN {
            self.turned[group as usize] = (!value.is_zero()).then(|| value.sin_cos());
        }
        self.values[coordinate as usize] = value;
    }
}

impl State<Number> {
    pub fn converted<S: Scalar>(&self, kinematics: &Kinematics) -> State<S> {
        let mut state = State::as_drawn();
        for (coordinate, value) in self.values.iter().enumerate().filter(|(_, value)| !value.is_zero()) {
            state.set(kinematics, coordinate as Index, S::of(value));
        }
        state
    }
}

/// A path at a state: displacement of its far end relative to the near end, and the derivatives.
#[derive(Clone, Debug)]
pub struct PathEvaluation<S> {
    pub displacement: Vector<S>,
    /// d(displacement)/dq; coordinates are distinct.
    pub columns: Vec<(Index, Vector<S>)>,
    /// w_g of each group on the way, with its axis and coordinate.
    swept: Vec<Swept<S>>,
    /// Coordinate, index of its group in `swept`, and direction of each slide.
    runs: Vec<(Index, Option<usize>, Vector<S>)>,
}

#[derive(Clone, Debug)]
struct Swept<S> {
    group: u32,
    coordinate: Index,
    axis: Vector<S>,
    arm: Vector<S>,
}

impl<S: Scalar> Default for PathEvaluation<S> {
    fn default() -> PathEvaluation<S> {
        PathEvaluation { displacement: Vector::zero(), columns: Vec::new(), swept: Vec::new(), runs: Vec::new() }
    }
}

impl<S: Scalar> PathEvaluation<S> {
    /// Evaluates a path at a state.
    pub fn measure(&mut self, kinematics: &Kinematics, state: &State<S>, path: &Path<S>) {
        self.displacement = Vector::zero();
        self.columns.clear();
        self.swept.clear();
        self.runs.clear();
        for turn in &path.turns {
            let arm = self.rotate(kinematics, state, turn.group, &turn.arm);
            if let Some(arm) = &arm {
                self.displacement = self.displacement.plus(&arm.minus(&turn.arm));
            }
            self.push_swept(kinematics, turn.group, arm.unwrap_or_else(|| turn.arm.clone()));
        }
        // Indices in `swept` of the groups of slides; empty if none of them turns.
        let mut places: BTreeMap<u32, usize> = BTreeMap::new();
        if path.runs.iter().any(|run| run.group != NO_TURN) {
            places.extend(self.swept.iter().enumerate().map(|(place, swept)| (swept.group, place)));
        }
        for run in &path.runs {
            let rotated = self.rotate(kinematics, state, run.group, &run.direction);
            let direction = rotated.unwrap_or_else(|| run.direction.clone());
            let value = state.value(run.coordinate);
            let way = if value.is_zero() { Vector::zero() } else { direction.scaled(value) };
            self.displacement = self.displacement.plus(&way);
            let place = (run.group != NO_TURN).then(|| self.sweep(kinematics, run.group, way, &mut places));
            self.runs.push((run.coordinate, place, direction));
        }
        for swept in &self.swept {
            self.columns.push((swept.coordinate, swept.axis.cross(&swept.arm)));
        }
        for (coordinate, _, direction) in &self.runs {
            self.columns.push((*coordinate, direction.clone()));
        }
    }

    /// R_g v; `None` if the group has not turned.
    fn rotate(&self, kinematics: &Kinematics, state: &State<S>, group: u32, v: &Vector<S>) -> Option<Vector<S>> {
        let (sine, cosine) = state.turned.get(group as usize)?.as_ref()?;
        Some(v.turned(&Vector::of(&kinematics.groups[group as usize].axis), sine, cosine))
    }

    /// Adds an arm to the entry of its group in `swept`, and returns the index of that entry.
    fn sweep(
        &mut self,
        kinematics: &Kinematics,
        group: u32,
        arm: Vector<S>,
        places: &mut BTreeMap<u32, usize>,
    ) -> usize {
        let place = *places.entry(group).or_insert(self.swept.len());
        match self.swept.get_mut(place) {
            Some(swept) => swept.arm = swept.arm.plus(&arm),
            None => self.push_swept(kinematics, group, arm),
        }
        place
    }

    /// Adds an entry for a group; a path has each group once.
    fn push_swept(&mut self, kinematics: &Kinematics, group: u32, arm: Vector<S>) {
        let Group { coordinate, axis } = &kinematics.groups[group as usize];
        self.swept.push(Swept { group, coordinate: *coordinate, axis: Vector::of(axis), arm });
    }

    /// direction . d(displacement)/dq, without zeros.
    pub fn row(&self, direction: &Vector<S>, row: &mut Vec<(Index, S)>) {
        row.clear();
        row.extend(self.columns.iter().filter_map(|(coordinate, column)| {
            let entry = direction.dot(column);
            (!entry.is_zero()).then_some((*coordinate, entry))
        }));
    }

    /// d2(force . displacement)/dq_i dq_j for a fixed force, without zeros, each pair once.
    pub fn curvature(&self, force: &Vector<S>, mut visit: impl FnMut(Index, Index, S)) {
        for swept in &self.swept {
            let second = swept.axis.cross(&swept.axis.cross(&swept.arm));
            let entry = force.dot(&second);
            if !entry.is_zero() {
                visit(swept.coordinate, swept.coordinate, entry);
            }
        }
        for (coordinate, place, direction) in &self.runs {
            // A slide in a turning group has an entry in `swept`, even if its arm is zero.
            let Some(swept) = place.map(|place| &self.swept[place]) else { continue };
            let entry = force.dot(&swept.axis.cross(direction));
            if !entry.is_zero() {
                visit(swept.coordinate, *coordinate, entry);
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

/// Assigns the order of the coordinates: that of the declarations of the bodies, and x, y, along, slide, angle within a
/// body; then the motions of the bases, in the order of the inputs.
struct Numbering<'a> {
    scene: &'a Scene,
    kinematics: Kinematics,
}

impl<'a> Numbering<'a> {
    fn new(scene: &'a Scene, tree: Tree) -> Numbering<'a> {
        let carriage = Carriage { depth: 0, group: NO_TURN, first_slide: 0, slides: 0 };
        let ground = Group { coordinate: Index::MAX, axis: Vec3::Z };
        let kinematics = Kinematics {
            carriages: vec![carriage; tree.pieces.len()],
            tree,
            groups: vec![ground],
            slides: Vec::new(),
            directions: vec![Vec3::X, Vec3::Y],
            group_of: Vec::new(),
            free: Vec::new(),
            prescribed: 0,
            prescribed_inputs: Vec::new(),
            lengths_squared: Vec::new(),
            followers: Vec::new(),
        };
        Numbering { scene, kinematics }
    }

    fn finish(mut self) -> Kinematics {
        for index in 0..self.scene.bodies.len() {
            let piece = self.kinematics.tree.bodies[index];
            if self.kinematics.tree.pieces[piece as usize].owner == Owner::Body(BodyId(index as u32)) {
                self.free_piece(piece, BodyId(index as u32));
            }
        }
        let motion = |(number, input): (usize, &Input)| match input.kind {
            InputKind::Base { base, translation } => Some((base, translation, number as u32)),
            _ => None,
        };
        let mut motions: Vec<_> = self.scene.inputs.iter().enumerate().filter_map(motion).collect();
        motions.sort_by_key(|(base, ..)| *base);
        for (base, translation, number) in motions {
            self.prescribe(self.kinematics.tree.bases[base.index()], translation, number);
        }
        self.inherit();
        let mut group_of = vec![NO_TURN; self.kinematics.total()];
        for (group, at) in self.kinematics.groups.iter().enumerate().skip(1) {
            group_of[at.coordinate as usize] = group as u32;
        }
        self.kinematics.group_of = group_of;
        self.kinematics
    }

    /// The free coordinates of a piece.
    fn free_piece(&mut self, piece: PieceId, body: BodyId) {
        let Some(joint) = self.kinematics.tree.pieces[piece as usize].joint else {
            if let Freedom::OnGround { translations, .. } = &self.scene.bodies[body.index()].freedom {
                for translation in translations.iter() {
                    let coordinate = self.free(body, translation.motion, CoordinateKind::Translation);
                    self.slide(piece, coordinate, &translation.direction);
                }
            }
            return self.free_turn(piece, body);
        };
        if let Some(along) = &self.scene.joints[joint.index()].along {
            let coordinate = self.free(body, "slide", CoordinateKind::Translation);
            self.slide(piece, coordinate, along);
        }
        self.free_turn(piece, body);
    }

    fn free_turn(&mut self, piece: PieceId, body: BodyId) {
        if self.kinematics.tree.pieces[piece as usize].turns {
            let coordinate = self.free(body, "angle", CoordinateKind::Rotation);
            self.turn(piece, coordinate);
        }
    }

    fn free(&mut self, body: BodyId, motion: &'static str, kind: CoordinateKind) -> Index {
        self.kinematics.free.push(FreeCoordinate { body, motion, kind });
        (self.kinematics.free.len() - 1) as Index
    }

    /// A motion of a base. Called after all free coordinates are numbered.
    fn prescribe(&mut self, piece: PieceId, translation: Option<usize>, input: u32) {
        let coordinate = self.kinematics.total() as Index;
        self.kinematics.prescribed += 1;
        self.kinematics.prescribed_inputs.push(input);
        let Owner::Base(base) = self.kinematics.tree.pieces[piece as usize].owner else { return };
        match translation.and_then(|which| self.scene.bases[base.index()].translations.get(which)) {
            Some(translation) => self.slide(piece, coordinate, &translation.direction),
            None => self.turn(piece, coordinate),
        }
    }

    /// The slides of one piece must be added one after the other.
    fn slide(&mut self, piece: PieceId, coordinate: Index, direction: &Vec3) {
        let direction = self.direction(coordinate, direction);
        let carriage = &mut self.kinematics.carriages[piece as usize];
        if carriage.slides == 0 {
            carriage.first_slide = self.kinematics.slides.len() as u32;
        }
        carriage.slides += 1;
        self.kinematics.slides.push(Slide { coordinate, direction, group: None });
    }

    /// Normalises a direction if its length is rational; otherwise keeps it as written and its length separately.
    fn direction(&mut self, coordinate: Index, direction: &Vec3) -> u32 {
        if let Some(known) = self.kinematics.directions[..2].iter().position(|axis| axis == direction) {
            return known as u32;
        }
        let length_squared = direction.dot(direction);
        let scaled = match length_squared.sqrt() {
            Some(length @ Number::Exact(_)) => direction.scale(&(&Number::ONE / &length)),
            _ => {
                self.kinematics.lengths_squared.push((coordinate, length_squared));
                direction.clone()
            }
        };
        self.kinematics.directions.push(scaled);
        (self.kinematics.directions.len() - 1) as u32
    }

    fn turn(&mut self, piece: PieceId, coordinate: Index) {
        self.kinematics.carriages[piece as usize].group = self.kinematics.groups.len() as u32;
        self.kinematics.groups.push(Group { coordinate, axis: Vec3::Z });
    }

    /// Pieces that do not turn relative to their carrier turn with it. Carriers come first.
    fn inherit(&mut self) {
        for piece in 1..self.kinematics.carriages.len() {
            let carrier = self.kinematics.carriages[self.kinematics.tree.pieces[piece].carrier as usize];
            let carriage = &mut self.kinematics.carriages[piece];
            carriage.depth = carrier.depth + 1;
            if carriage.group == NO_TURN {
                carriage.group = carrier.group;
            }
        }
    }
}
