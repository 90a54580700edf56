//! The joint tree: which part carries which. Its roots are the ground and the bases; it is built breadth first, without
//! recursion.
//! See docs/method/kinematics.md.
//!
//! Welded parts form one piece. A body with a freedom clause is carried by the ground; every other piece is carried
//! through the first joint by which the search reaches it. Joints that the search does not use close loops.

use super::error::LowerError;
use crate::base::Vec3;
use crate::model::scene::{BaseId, BodyId, Freedom, JointId, Part, Scene};
use std::sync::Arc;

/// Index of a piece: a set of welded parts. Piece 0 is the ground, and carriers come before the pieces they carry.
pub type PieceId = u32;

pub const GROUND: PieceId = 0;

/// The part that a piece is named after, and whose degrees of freedom it has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Owner {
    Ground,
    Base(BaseId),
    Body(BodyId),
}

/// A set of welded parts and its carrier.
#[derive(Clone, Debug)]
pub struct Piece {
    pub owner: Owner,
    pub carrier: PieceId,
    /// The joint to the carrier; `None` for bodies with a freedom clause and for roots.
    pub joint: Option<JointId>,
    /// The drawn point that holds it, if one is known.
    pub anchor: Option<Arc<Vec3>>,
    pub turns: bool,
}

#[derive(Clone, Debug)]
pub struct Tree {
    pub pieces: Vec<Piece>,
    /// The piece of each base and of each body.
    pub bases: Vec<PieceId>,
    pub bodies: Vec<PieceId>,
    /// Joints that the tree does not use: they close loops.
    pub closing: Vec<JointId>,
}

impl Tree {
    pub fn piece(&self, part: Part) -> PieceId {
        match part {
            Part::Ground => GROUND,
            Part::Base(base) => self.bases[base.index()],
            Part::Body(body) => self.bodies[body.index()],
        }
    }
}

impl Tree {
    /// The joints of the loop that a joint closes: itself first, then those on the path from one of its ends to the
    /// other.
    pub fn closed_by(&self, scene: &Scene, joint: JointId) -> Vec<JointId> {
        let mut joints = vec![joint];
        let [mut a, mut b] = [0, 1].map(|end| self.piece(scene.joints[joint.index()].ends[end].part));
        while a != b {
            // Carriers come first, so the later of the two is not the common carrier.
            let later = if a > b { &mut a } else { &mut b };
            let piece = &self.pieces[*later as usize];
            joints.extend(piece.joint);
            *later = piece.carrier;
        }
        joints
    }
}

/// Ground, bases and bodies with consecutive numbers.
struct Parts<'a> {
    scene: &'a Scene,
}

impl Parts<'_> {
    fn count(&self) -> usize {
        1 + self.scene.bases.len() + self.scene.bodies.len()
    }

    fn number(&self, part: Part) -> usize {
        match part {
            Part::Ground => 0,
            Part::Base(base) => 1 + base.index(),
            Part::Body(body) => 1 + self.scene.bases.len() + body.index(),
        }
    }

    fn owner(&self, number: usize) -> Owner {
        let bases = self.scene.bases.len();
        match number {
            0 => Owner::Ground,
            n if n <= bases => Owner::Base(BaseId((n - 1) as u32)),
            n => Owner::Body(BodyId((n - 1 - bases) as u32)),
        }
    }

    /// Whether the part is carried by the ground without a joint.
    fn is_held(&self, number: usize) -> bool {
        match self.owner(number) {
            Owner::Body(body) => self.scene.bodies[body.index()].freedom != Freedom::FromJoints,
            Owner::Ground | Owner::Base(_) => true,
        }
    }
}

/// Builds the tree, or reports the bodies that nothing holds.
pub fn build(scene: &Scene) -> Result<Tree, Vec<LowerError>> {
    let parts = Parts { scene };
    let mut welded = Welded::new(&parts);
    let mut closing = weld_all(&parts, &mut welded);
    let classes = welded.classes();
    let mut growth = Growth::new(&parts, &classes);
    growth.grow(&parts, &classes, &mut closing);
    let loose = growth.loose(&parts, &classes);
    if !loose.is_empty() {
        return Err(loose);
    }
    closing.sort_unstable();
    let piece_of = |number: usize| growth.piece_of_class[classes[number] as usize];
    let bases = (0..scene.bases.len()).map(|base| piece_of(1 + base)).collect();
    let bodies = (0..scene.bodies.len()).map(|body| piece_of(1 + scene.bases.len() + body)).collect();
    Ok(Tree { pieces: growth.pieces, bases, bodies, closing })
}

/// Sets of welded parts (union-find). The representative is the part that is held without a joint: the ground, a base, or
/// a body with a freedom clause; otherwise the body that is declared first.
struct Welded {
    parent: Vec<u32>,
    held: Vec<bool>,
}

impl Welded {
    fn new(parts: &Parts) -> Welded {
        let count = parts.count();
        Welded { parent: (0..count as u32).collect(), held: (0..count).map(|number| parts.is_held(number)).collect() }
    }

    fn find(&mut self, number: usize) -> usize {
        let mut at = number;
        while self.parent[at] as usize != at {
            self.parent[at] = self.parent[self.parent[at] as usize];
            at = self.parent[at] as usize;
        }
        at
    }

    /// Unites two sets; `false` if they are one already or both are held.
    fn unite(&mut self, a: usize, b: usize) -> bool {
        let (a, b) = (self.find(a), self.find(b));
        if a == b || (self.held[a] && self.held[b]) {
            return false;
        }
        let (first, second) = (a.min(b), a.max(b));
        let (keeps, joins) = if self.held[second] { (second, first) } else { (first, second) };
        self.parent[joins] = keeps as u32;
        true
    }

    /// The representative of every part.
    fn classes(&mut self) -> Vec<u32> {
        (0..self.parent.len()).map(|number| self.find(number) as u32).collect()
    }
}

/// Unites welded parts; returns the welds that could not be used.
fn weld_all(parts: &Parts, welded: &mut Welded) -> Vec<JointId> {
    let mut closing = Vec::new();
    for (index, joint) in parts.scene.joints.iter().enumerate() {
        if joint.kind.is_rigid() {
            let [a, b] = [0, 1].map(|end| parts.number(joint.ends[end].part));
            if !welded.unite(a, b) {
                closing.push(JointId(index as u32));
            }
        }
    }
    closing
}

const NONE: u32 = u32::MAX;

/// The tree during its construction.
struct Growth {
    pieces: Vec<Piece>,
    piece_of_class: Vec<PieceId>,
    /// For each piece, the class that it represents.
    class_of_piece: Vec<u32>,
}

impl Growth {
    /// The roots and the bodies with a freedom clause.
    fn new(parts: &Parts, classes: &[u32]) -> Growth {
        let mut growth =
            Growth { pieces: Vec::new(), piece_of_class: vec![NONE; parts.count()], class_of_piece: Vec::new() };
        for number in (0..parts.count()).filter(|&number| classes[number] as usize == number && parts.is_held(number)) {
            let owner = parts.owner(number);
            let (anchor, turns) = match owner {
                Owner::Ground => (None, false),
                Owner::Base(base) => {
                    (parts.scene.bases[base.index()].at.clone(), parts.scene.bases[base.index()].turns)
                }
                Owner::Body(body) => {
                    let body = &parts.scene.bodies[body.index()];
                    let turns = matches!(body.freedom, Freedom::OnGround { turns: true, .. });
                    (if turns { body.centre.clone() } else { None }, turns)
                }
            };
            growth.add(number as u32, Piece { owner, carrier: GROUND, joint: None, anchor, turns });
        }
        growth
    }

    fn add(&mut self, class: u32, piece: Piece) {
        self.piece_of_class[class as usize] = self.pieces.len() as PieceId;
        self.class_of_piece.push(class);
        self.pieces.push(piece);
    }

    /// Breadth first: each piece in turn carries the pieces that its joints connect to it and that have no carrier yet.
    fn grow(&mut self, parts: &Parts, classes: &[u32], closing: &mut Vec<JointId>) {
        let joints = &parts.scene.joints;
        let class_at = |joint: u32, end: usize| classes[parts.number(joints[joint as usize].ends[end].part)];
        let table = Incidence::new(parts, class_at);
        let mut used = vec![false; joints.len()];
        let mut next = 0;
        while next < self.pieces.len() {
            let class = self.class_of_piece[next];
            for &joint in table.of(class) {
                if std::mem::replace(&mut used[joint as usize], true) {
                    continue;
                }
                let ends = [class_at(joint, 0), class_at(joint, 1)];
                let other = if ends[0] == class { ends[1] } else { ends[0] };
                if self.piece_of_class[other as usize] == NONE {
                    let piece = carried_piece(parts, next as PieceId, other, joint, &self.pieces[next]);
                    self.add(other, piece);
                } else {
                    closing.push(JointId(joint));
                }
            }
            next += 1;
        }
    }

    /// Errors for bodies that the search did not reach: one for each connected set.
    fn loose(&self, parts: &Parts, classes: &[u32]) -> Vec<LowerError> {
        let mut islands = Welded { parent: classes.to_vec(), held: vec![false; classes.len()] };
        for joint in &parts.scene.joints {
            let [a, b] = [0, 1].map(|end| parts.number(joint.ends[end].part));
            islands.unite(a, b);
        }
        let mut members: Vec<(usize, Vec<BodyId>)> = Vec::new();
        let mut place = vec![usize::MAX; classes.len()];
        for number in (0..classes.len()).filter(|&n| self.piece_of_class[classes[n] as usize] == NONE) {
            let island = islands.find(number);
            if place[island] == usize::MAX {
                place[island] = members.len();
                members.push((island, Vec::new()));
            }
            if let Owner::Body(body) = parts.owner(number) {
                members[place[island]].1.push(body);
            }
        }
        members.into_iter().map(|(_, bodies)| LowerError::loose_bodies(parts.scene, &bodies)).collect()
    }
}

/// The piece that `joint` connects to its carrier.
fn carried_piece(parts: &Parts, carrier: PieceId, class: u32, joint: u32, carried_by: &Piece) -> Piece {
    let joint_of = &parts.scene.joints[joint as usize];
    let relative = joint_of.freedoms();
    // If the joint holds no point, any will do: parts without relative rotation share the carrier's.
    let held = relative.holds_point.then(|| joint_of.ends[0].at.clone()).flatten();
    let anchor = held.or_else(|| carried_by.anchor.clone());
    let owner = parts.owner(class as usize);
    Piece { owner, carrier, joint: Some(JointId(joint)), anchor, turns: relative.turns }
}

/// The joints of each class, in order of declaration, as compressed rows.
struct Incidence {
    starts: Vec<u32>,
    joints: Vec<u32>,
}

impl Incidence {
    fn new(parts: &Parts, class_at: impl Fn(u32, usize) -> u32) -> Incidence {
        let ends = || {
            let ties = parts.scene.joints.iter().enumerate().filter(|(_, joint)| !joint.kind.is_rigid());
            ties.flat_map(|(index, _)| [(index as u32, 0), (index as u32, 1)])
        };
        let mut starts = vec![0u32; parts.count() + 1];
        for (joint, end) in ends() {
            starts[class_at(joint, end) as usize + 1] += 1;
        }
        for class in 0..parts.count() {
            starts[class + 1] += starts[class];
        }
        let mut filled = starts.clone();
        let mut joints = vec![0; starts[parts.count()] as usize];
        for (joint, end) in ends() {
            let place = &mut filled[class_at(joint, end) as usize];
            joints[*place as usize] = joint;
            *place += 1;
        }
        Incidence { starts, joints }
    }

    fn of(&self, class: u32) -> &[u32] {
        &self.joints[self.starts[class as usize] as usize..self.starts[class as usize + 1] as usize]
    }
}
