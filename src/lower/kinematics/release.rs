//! A mechanism with some of its joints, couplings or supports released. In: the kinematics of a scene and reactions.
//! Out: kinematics with a further prescribed motion for each reaction: the motion that the joint, coupling or support
//! prevents, on which the reaction does work. It is zero in every motion of the scene. See
//! docs/method/linearisation.md#reactions.
//!
//! A released force displaces everything that the joint carries along an axis of the scene. A released moment turns,
//! about the place of the joint, those parts that have no angle of their own against the joint: they become a group
//! whose angle is the sum of the carrier's angle and the released turn. Joints that close loops and couplings stay
//! equations, in which the released motion is a further term ([`Released::in_equation`]).

use super::{Carriage, End, Group, Index, Kinematics, NO_TURN, Path, PieceId, Run, Slide, State};
use crate::base::{Number, Span, Vec3};
use crate::elements::Vector;
use crate::kinds::motions::ReactionComponent;
use crate::lower::error::LowerError;
use crate::lower::tree::{Owner, Piece};
use crate::model::scene::{
    Attachment, BodyId, Geometry, Holder, Input, InputKind, Joint, JointId, Part, Reaction, Scene,
};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Kinematics with released motions.
#[derive(Clone, Debug)]
pub struct Released {
    pub kinematics: Kinematics,
    /// The coordinate of the motion released for the first reaction; the others follow.
    pub first: Index,
    /// For each reaction, whether it acts on the parts that its released motion displaces; if not, its sign is
    /// reversed.
    pub acts_on_moved: Vec<bool>,
    /// The reactions whose motion appears in equations only.
    pub in_equation: Vec<bool>,
}

/// The reason why a reaction has no released motion.
#[derive(Clone, Debug, PartialEq)]
pub enum Unreleased {
    /// Other joints hold the same parts in the same way.
    Redundant,
    /// The position of something that the moment depends on is not known.
    NoPlace { span: Span },
    /// A body of unknown mass is carried.
    NoMass { span: Span },
    /// A limit of room or time.
    Limit(Box<LowerError>),
    /// The known digits do not decide which coordinates the released motion depends on.
    Unclear,
}

/// The way in which the motion of a reaction enters the tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Way {
    /// Through the piece that moves, and whether that piece is on the side of the joint's second end.
    Piece {
        piece: PieceId,
        is_second: bool,
    },
    Equation,
}

impl Kinematics {
    /// Releases the motions on which some reactions do work; an error names the reaction for which that is impossible.
    pub fn release_motions(&self, scene: &Scene, reactions: &[Reaction]) -> Result<Released, (usize, Unreleased)> {
        let mut builder = Builder::new(self, scene);
        for (number, reaction) in reactions.iter().enumerate() {
            if let Some(joint) = builder.rigid_in_tree(reaction.holder) {
                builder.split(joint).map_err(|why| (number, why))?;
            }
        }
        builder.sort();
        let ways: Vec<Way> = reactions.iter().map(|reaction| builder.way(reaction.holder)).collect();
        let released = builder.finish(reactions, &ways)?;
        released.masses_known(scene)?;
        released
            .kinematics
            .limit_entries(scene)
            .map_err(|mut errors| (0, Unreleased::Limit(Box::new(errors.remove(0)))))?;
        Ok(released)
    }

    /// Replaces angles that follow other angles by the sums that define them.
    pub fn unfold(&self, row: &mut Vec<(Index, Number)>) {
        let of = |coordinate: &Index| self.followers.binary_search_by_key(coordinate, |(angle, _)| *angle).ok();
        if self.followers.is_empty() || !row.iter().any(|(coordinate, _)| of(coordinate).is_some()) {
            return;
        }
        let mut unfolded = Vec::with_capacity(row.len() + 1);
        for (coordinate, value) in row.drain(..) {
            match of(&coordinate) {
                Some(place) => {
                    unfolded.extend(self.followers[place].1.iter().map(|(i, entry)| (*i, entry * &value)));
                }
                None => unfolded.push((coordinate, value)),
            }
        }
        *row = crate::lower::constraints::equation::merge_entries(unfolded);
    }
}

impl Released {
    pub fn coordinate(&self, number: usize) -> Index {
        self.first + number as Index
    }

    /// The reaction whose released motion has this coordinate.
    pub fn number(&self, coordinate: Index) -> Option<usize> {
        let number = coordinate.checked_sub(self.first)? as usize;
        (number < self.in_equation.len()).then_some(number)
    }

    /// An error for a body without a mass whose weight or inertia a released motion would have to move.
    fn masses_known(&self, scene: &Scene) -> Result<(), (usize, Unreleased)> {
        let mut path = Path::default();
        for (index, body) in scene.bodies.iter().enumerate().filter(|(_, body)| body.mass.is_none()) {
            let piece = self.kinematics.tree.piece(Part::Body(BodyId(index as u32)));
            let end = End { piece, at: body.centre.as_deref() };
            self.kinematics.path_between(End::GROUND, end, &mut path);
            let mut coordinates: Vec<(Index, Number)> =
                path.coordinates(&self.kinematics).map(|(coordinate, _)| (coordinate, Number::ONE)).collect();
            self.kinematics.unfold(&mut coordinates);
            let number = coordinates.iter().find_map(|(coordinate, _)| self.number(*coordinate));
            let moves = coordinates.iter().any(|(coordinate, _)| self.number(*coordinate).is_none());
            let may_move = moves || body.centre.is_none() && self.kinematics.angle(piece).is_some();
            if let Some(number) = number.filter(|_| may_move || !scene.gravity.is_zero()) {
                return Err((number, Unreleased::NoMass { span: body.span }));
            }
        }
        Ok(())
    }

    /// A generic state: an expression that vanishes in it vanishes in all states.
    pub fn generic(&self) -> State<Number> {
        let mut state = State::as_drawn();
        let mut value = &Number::from(37) / &Number::from(101);
        for coordinate in 0..self.first {
            value = &(&value + &(&Number::from(7919) / &Number::from(10007))) / &(&value + &Number::ONE);
            value = Number::Ball(value.to_ball());
            state.set(&self.kinematics, coordinate, value.clone());
        }
        let original = state.clone();
        self.follow(&original, &mut state);
        state
    }

    /// Sets the angles that follow other angles.
    fn follow(&self, original: &State<Number>, state: &mut State<Number>) {
        for (angle, follows) in &self.kinematics.followers {
            let value = follows.iter().fold(Number::ZERO, |sum, (i, entry)| &sum + &(entry * original.value(*i)));
            if !value.is_zero() {
                state.set(&self.kinematics, *angle, value);
            }
        }
    }

    /// The state of the original mechanism, with every released motion at zero.
    pub fn state(&self, original: &State<Number>) -> State<Number> {
        let mut state = State::as_drawn();
        if original.is_drawn() {
            return state;
        }
        let values = original.values.iter().enumerate().filter(|(_, value)| !value.is_zero());
        for (coordinate, value) in values {
            state.set(&self.kinematics, coordinate as Index, value.clone());
        }
        self.follow(original, &mut state);
        state
    }
}

impl Path<Number> {
    /// Takes a released displacement off the path.
    pub fn release(&mut self, coordinate: Index, axis: &Vec3) {
        self.runs.push(Run { coordinate, group: NO_TURN, direction: Vector::of(axis).negate() });
    }
}

/// The axis of a force; `None` for a moment or a coupling.
pub fn axis_of(component: ReactionComponent) -> Option<&'static Vec3> {
    match component {
        ReactionComponent::X => Some(&Vec3::X),
        ReactionComponent::Y => Some(&Vec3::Y),
        ReactionComponent::Moment | ReactionComponent::Coupling => None,
    }
}

/// The place of a joint: where it is drawn, or the first known place of its ends.
fn place_of(joint: &Joint) -> Option<Vec3> {
    let given = |end: usize| joint.ends[end].at.as_deref().cloned();
    joint.at.clone().or_else(|| given(0)).or_else(|| given(1))
}

/// The tree of a scene with welds undone, while it is built.
struct Builder<'a> {
    scene: &'a Scene,
    old: &'a Kinematics,
    new: Kinematics,
    /// For each piece, the piece of the original tree that it came from; `None` for a piece that a weld held.
    origin: Vec<Option<PieceId>>,
}

impl<'a> Builder<'a> {
    fn new(old: &'a Kinematics, scene: &'a Scene) -> Builder<'a> {
        let origin = (0..old.tree.pieces.len() as PieceId).map(Some).collect();
        Builder { scene, old, new: old.clone(), origin }
    }

    /// The joint of a reaction, if it makes one piece of two.
    fn rigid_in_tree(&self, holder: Holder) -> Option<JointId> {
        let Holder::Joint(joint) = holder else { return None };
        let closes = self.old.tree.closing.contains(&joint);
        (self.scene.joints[joint.index()].kind.is_rigid() && !closes).then_some(joint)
    }

    /// Undoes a weld: the parts beyond it become a piece of their own.
    fn split(&mut self, weld: JointId) -> Result<(), Unreleased> {
        let tree = &self.new.tree;
        if tree.pieces.iter().any(|piece| piece.joint == Some(weld)) {
            return Ok(());
        }
        let joint = &self.scene.joints[weld.index()];
        let piece = tree.piece(joint.ends[0].part);
        let held = self.welded_to(self.holder_of(piece), piece, weld);
        let is_held = |end: usize| held.contains(&joint.ends[end].part);
        let moving = match (is_held(0), is_held(1)) {
            (true, false) => joint.ends[1].part,
            (false, true) => joint.ends[0].part,
            _ => return Err(Unreleased::Redundant),
        };
        let Part::Body(owner) = moving else { return Err(Unreleased::Redundant) };
        let anchor = place_of(joint).map(Arc::new);
        let beyond = self.new.tree.pieces.len() as PieceId;
        let is_beyond = |part: Part| self.new.tree.piece(part) == piece && !held.contains(&part);
        let carried: Vec<usize> = (1..self.new.tree.pieces.len())
            .filter(|&child| {
                let Piece { carrier, joint, .. } = &self.new.tree.pieces[child];
                let ends = joint.map(|joint| &self.scene.joints[joint.index()].ends);
                *carrier == piece && ends.is_some_and(|ends| ends.iter().any(|end| is_beyond(end.part)))
            })
            .collect();
        let bodies: Vec<usize> =
            (0..self.scene.bodies.len()).filter(|body| is_beyond(Part::Body(BodyId(*body as u32)))).collect();
        carried.into_iter().for_each(|child| self.new.tree.pieces[child].carrier = beyond);
        bodies.into_iter().for_each(|body| self.new.tree.bodies[body] = beyond);
        let owner = Owner::Body(owner);
        self.new.tree.pieces.push(Piece { owner, carrier: piece, joint: Some(weld), anchor, turns: false });
        self.origin.push(None);
        Ok(())
    }

    /// The part that holds a piece.
    fn holder_of(&self, piece: PieceId) -> Part {
        let tree = &self.new.tree;
        let own = &tree.pieces[piece as usize];
        match (own.joint, own.owner) {
            (Some(joint), _) => {
                let ends = &self.scene.joints[joint.index()].ends;
                let end = ends.iter().find(|end| tree.piece(end.part) == piece);
                end.map_or(Part::Ground, |end| end.part)
            }
            (None, Owner::Ground) => Part::Ground,
            (None, Owner::Base(base)) => Part::Base(base),
            (None, Owner::Body(body)) => Part::Body(body),
        }
    }

    /// The parts of a piece that remain connected to one of them by welds if one weld is removed.
    fn welded_to(&self, first: Part, piece: PieceId, without: JointId) -> Vec<Part> {
        let tree = &self.new.tree;
        let mut neighbours: BTreeMap<Part, Vec<Part>> = BTreeMap::new();
        for (index, joint) in self.scene.joints.iter().enumerate() {
            let [a, b] = [0, 1].map(|end| joint.ends[end].part);
            let is_here = joint.kind.is_rigid() && index != without.index();
            if is_here && tree.piece(a) == piece && tree.piece(b) == piece {
                neighbours.entry(a).or_default().push(b);
                neighbours.entry(b).or_default().push(a);
            }
        }
        let (mut reached, mut open) = (vec![first], vec![first]);
        while let Some(part) = open.pop() {
            for next in neighbours.remove(&part).unwrap_or_default() {
                if !reached.contains(&next) {
                    reached.push(next);
                    open.push(next);
                }
            }
        }
        reached
    }

    /// Sorts the pieces so that carriers come before the pieces that they carry.
    fn sort(&mut self) {
        let tree = &mut self.new.tree;
        let count = tree.pieces.len();
        if count == self.old.tree.pieces.len() {
            return;
        }
        let mut children: Vec<Vec<usize>> = vec![Vec::new(); count];
        (1..count).for_each(|piece| children[tree.pieces[piece].carrier as usize].push(piece));
        let mut order = vec![0];
        let mut next = 0;
        while next < order.len() {
            order.extend_from_slice(&children[order[next]]);
            next += 1;
        }
        let mut place = vec![0 as PieceId; count];
        order.iter().enumerate().for_each(|(at, piece)| place[*piece] = at as PieceId);
        let moved = |piece: &usize| {
            let piece = &tree.pieces[*piece];
            Piece { carrier: place[piece.carrier as usize], ..piece.clone() }
        };
        let pieces = order.iter().map(moved).collect();
        self.origin = order.iter().map(|piece| self.origin[*piece]).collect();
        tree.pieces = pieces;
        for piece in tree.bodies.iter_mut().chain(&mut tree.bases) {
            *piece = place[*piece as usize];
        }
    }

    fn way(&self, holder: Holder) -> Way {
        let tree = &self.new.tree;
        match holder {
            Holder::Couple(_) => Way::Equation,
            Holder::Support(body) => Way::Piece { piece: tree.piece(Part::Body(body)), is_second: true },
            Holder::Joint(joint) => match tree.pieces.iter().position(|piece| piece.joint == Some(joint)) {
                Some(piece) => {
                    let second = tree.piece(self.scene.joints[joint.index()].ends[1].part);
                    Way::Piece { piece: piece as PieceId, is_second: second as usize == piece }
                }
                None => Way::Equation,
            },
        }
    }

    fn finish(mut self, reactions: &[Reaction], ways: &[Way]) -> Result<Released, (usize, Unreleased)> {
        let first = self.new.total() as Index;
        self.new.prescribed += reactions.len();
        self.new.group_of.resize(self.new.total(), NO_TURN);
        let mut turned = Vec::new();
        self.carriages(first, reactions, ways, &mut turned);
        for (number, piece) in turned {
            self.places_known(piece, reactions[number].holder).map_err(|why| (number, why))?;
        }
        let acts_on_moved = ways.iter().map(|way| !matches!(way, Way::Piece { is_second: false, .. })).collect();
        let in_equation = ways.iter().map(|way| *way == Way::Equation).collect();
        Ok(Released { kinematics: self.new, first, acts_on_moved, in_equation })
    }

    /// The group and the slides of every piece, in the order of the pieces; `turned` takes the pieces that a moment turns.
    fn carriages(&mut self, first: Index, reactions: &[Reaction], ways: &[Way], turned: &mut Vec<(usize, PieceId)>) {
        let mut released: BTreeMap<PieceId, Vec<(usize, ReactionComponent, bool)>> = BTreeMap::new();
        for (number, (reaction, way)) in reactions.iter().zip(ways).enumerate() {
            if let Way::Piece { piece, is_second } = way {
                released.entry(*piece).or_default().push((number, reaction.component, *is_second));
            }
        }
        let mut carriages: Vec<Carriage> = Vec::with_capacity(self.origin.len());
        for piece in 0..self.origin.len() as PieceId {
            let (carrier, turns) = {
                let piece = &self.new.tree.pieces[piece as usize];
                (piece.carrier, piece.turns)
            };
            let before = self.origin[piece as usize].map(|origin| self.old.carriages[origin as usize]);
            let above = if piece == 0 {
                (0, NO_TURN)
            } else {
                (carriages[carrier as usize].depth + 1, carriages[carrier as usize].group)
            };
            let mut group = before.filter(|_| turns).map_or(above.1, |before| before.group);
            let mut slides: Vec<Slide> =
                self.origin[piece as usize].map_or(Vec::new(), |origin| self.old.own_slides(origin).to_vec());
            for &(number, component, is_second) in released.get(&piece).into_iter().flatten() {
                let coordinate = first + number as Index;
                match component {
                    // The first two directions are the axes.
                    ReactionComponent::X => slides.push(Slide { coordinate, direction: 0, group: Some(NO_TURN) }),
                    ReactionComponent::Y => slides.push(Slide { coordinate, direction: 1, group: Some(NO_TURN) }),
                    ReactionComponent::Moment => {
                        group = self.follower(group, coordinate);
                        // About a point of the first part, the way that the second has slid turns as well.
                        if !is_second {
                            slides
                                .iter_mut()
                                .filter(|slide| slide.group.is_none())
                                .for_each(|slide| slide.group = Some(group));
                        }
                        turned.push((number, piece));
                    }
                    ReactionComponent::Coupling => {}
                }
            }
            let (first_slide, count) = (self.new.slides.len() as u32, slides.len() as u8);
            self.new.slides.extend(slides);
            carriages.push(Carriage { depth: above.0, group, first_slide, slides: count });
        }
        self.new.carriages = carriages;
    }

    /// Adds a group whose angle is the sum of another group's angle and a released turn.
    fn follower(&mut self, group: u32, turn: Index) -> u32 {
        let coordinate = self.new.total() as Index;
        self.new.prescribed += 1;
        let mut follows = Vec::new();
        if group != NO_TURN {
            follows.push((self.new.groups[group as usize].coordinate, Number::ONE));
        }
        follows.push((turn, Number::ONE));
        self.new.unfold(&mut follows);
        self.new.followers.push((coordinate, follows));
        self.new.groups.push(Group { coordinate, axis: Vec3::Z });
        let number = (self.new.groups.len() - 1) as u32;
        self.new.group_of.push(number);
        number
    }

    /// Gives a piece that a moment turns the place of its joint, and looks for parts of its group without a place.
    fn places_known(&mut self, piece: PieceId, holder: Holder) -> Result<(), Unreleased> {
        let scene = self.scene;
        let nowhere = || Unreleased::NoPlace { span: holder.span(scene) };
        let place = match holder {
            Holder::Joint(joint) => place_of(&scene.joints[joint.index()]).map(Arc::new),
            Holder::Support(body) => scene.bodies[body.index()].centre.clone(),
            Holder::Couple(_) => None,
        };
        let place = place.ok_or_else(nowhere)?;
        self.new.tree.pieces[piece as usize].anchor = Some(place.clone());
        let group = self.new.carriages[piece as usize].group;
        // Pieces that turned about no known point have one now; within one group, any point will do.
        for (other, carriage) in self.new.tree.pieces.iter_mut().zip(&self.new.carriages) {
            if carriage.group == group && other.anchor.is_none() {
                other.anchor = Some(place.clone());
            }
        }
        let turns = |part: Part| self.new.carriages[self.new.tree.piece(part) as usize].group == group;
        let lost_body = (0..).map(BodyId).zip(&scene.bodies).find(|(id, body)| {
            body.centre.is_none() && body.mass.as_ref().is_some_and(|mass| !mass.is_zero()) && turns(Part::Body(*id))
        });
        let elements = scene.elements.iter().filter(|element| element.law.geometry != Geometry::Torsion);
        let is_torque = |input: &&Input| matches!(input.kind, InputKind::Torque { .. });
        let inputs = scene.inputs.iter().filter(|input| !is_torque(input)).flat_map(|input| input.kind.ends());
        let mut ends = elements.flat_map(|element| &element.ends).chain(inputs);
        let lost_end = ends.find(|end: &&Attachment| end.at.is_none() && turns(end.part));
        match (lost_body, lost_end) {
            (Some((_, body)), _) => Err(Unreleased::NoPlace { span: body.span }),
            (None, Some(end)) => Err(Unreleased::NoPlace { span: end.span }),
            (None, None) => Ok(()),
        }
    }
}
