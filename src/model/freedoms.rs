//! Which parts can turn, and the line along which a part moves: from freedom clauses and joints, before any coordinate
//! is chosen. In: bodies, bases, joints. Out: both properties for each part. See docs/method/kinematics.md.
//!
//! Slides and welds prevent relative rotation, so the parts they connect turn together or not at all. A part's line
//! follows from the part it is welded to, or from the slide that holds it.

use super::Check;
use super::bodies::Directions;
use super::scene::{BodyId, Freedom, Joint, Part, Scene};
use crate::base::Vec3;
use std::sync::Arc;

/// The line along which a part moves.
#[derive(Clone, Debug, PartialEq)]
pub enum Line {
    /// The part does not move.
    Fixed,
    /// The part moves along this direction only.
    Along(Arc<Vec3>),
    /// The part has several degrees of freedom, or moves along no straight line.
    Other,
}

/// The degrees of freedom that joints give to bodies without a freedom clause; empty without joints.
#[derive(Debug, Default)]
pub struct Freedoms {
    /// For each body, the number of its joints.
    joints_of: Vec<u32>,
    /// For each body, whether it can turn.
    turns: Vec<bool>,
    /// For each body, its line.
    lines: Vec<Line>,
}

impl<'a> Check<'a> {
    pub fn freedoms(&mut self) {
        self.freedoms = Freedoms::of(&self.scene, &self.directions);
        self.jointless_bodies();
    }

    /// Whether a part can turn.
    pub fn can_turn(&self, part: Part) -> bool {
        can_turn(&self.scene, &self.freedoms, part)
    }

    pub fn line(&self, part: Part) -> Line {
        match part {
            Part::Body(id) if self.scene.bodies[id.index()].freedom == Freedom::FromJoints => {
                self.freedoms.lines.get(id.index()).cloned().unwrap_or(Line::Other)
            }
            part => own_line(&self.scene, &self.directions, part),
        }
    }
}

fn can_turn(scene: &Scene, freedoms: &Freedoms, part: Part) -> bool {
    match part {
        Part::Ground => false,
        Part::Base(id) => scene.bases[id.index()].turns,
        Part::Body(id) => match scene.bodies[id.index()].freedom {
            Freedom::OnGround { turns, .. } => turns,
            Freedom::FromJoints => freedoms.turns.get(id.index()).copied().unwrap_or(false),
        },
    }
}

/// The line of a part that is attached to the ground by its own freedom clause.
fn own_line(scene: &Scene, directions: &Directions, part: Part) -> Line {
    let translations = match part {
        Part::Ground => return Line::Fixed,
        Part::Base(id) => &scene.bases[id.index()].translations,
        Part::Body(id) => match &scene.bodies[id.index()].freedom {
            Freedom::OnGround { translations, .. } => translations,
            Freedom::FromJoints => return Line::Other,
        },
    };
    match &translations[..] {
        [] => Line::Fixed,
        [one] => Line::Along(directions.share(&one.direction)),
        _ => Line::Other,
    }
}

impl Freedoms {
    pub fn of(scene: &Scene, directions: &Directions) -> Freedoms {
        let mut freedoms = Freedoms::default();
        if scene.joints.is_empty() {
            return freedoms;
        }
        freedoms.joints_of = vec![0; scene.bodies.len()];
        for part in scene.joints.iter().flat_map(|joint| joint.ends.iter().map(|end| end.part)) {
            if let Part::Body(id) = part {
                freedoms.joints_of[id.index()] += 1;
            }
        }
        freedoms.turns = turning(scene);
        freedoms.lines = lines(scene, directions, &freedoms);
        freedoms
    }

    /// Bodies that have neither a freedom clause nor a joint.
    pub fn without_joint(&self, scene: &Scene) -> Vec<usize> {
        let bodies = scene.bodies.iter().enumerate();
        bodies
            .filter(|(_, body)| body.freedom == Freedom::FromJoints)
            .map(|(index, _)| index)
            .filter(|&index| self.joints_of.get(index).is_none_or(|&count| count == 0))
            .collect()
    }
}

/// The index of a part in a list of the bodies, the ground, and the bases.
fn node(scene: &Scene, part: Part) -> usize {
    match part {
        Part::Body(id) => id.index(),
        Part::Ground => scene.bodies.len(),
        Part::Base(id) => scene.bodies.len() + 1 + id.index(),
    }
}

/// Which bodies turn: a group connected by slides and welds turns unless one of its parts cannot.
fn turning(scene: &Scene) -> Vec<bool> {
    let mut groups = Groups::new(scene.bodies.len() + 1 + scene.bases.len());
    for joint in scene.joints.iter().filter(|joint| !joint.kind.turns) {
        groups.join(node(scene, joint.ends[0].part), node(scene, joint.ends[1].part));
    }
    let mut held = vec![false; groups.parents.len()];
    let fixed = |part| !can_turn(scene, &Freedoms::default(), part);
    for (index, body) in scene.bodies.iter().enumerate() {
        if body.freedom != Freedom::FromJoints && fixed(Part::Body(BodyId(index as u32))) {
            held[groups.find(index)] = true;
        }
    }
    held[groups.find(node(scene, Part::Ground))] = true;
    for index in 0..scene.bases.len() {
        let part = Part::Base(super::scene::BaseId(index as u32));
        if fixed(part) {
            held[groups.find(node(scene, part))] = true;
        }
    }
    (0..scene.bodies.len()).map(|index| !held[groups.find(index)]).collect()
}

/// Disjoint sets that can be joined (union-find with path halving).
struct Groups {
    parents: Vec<u32>,
}

impl Groups {
    fn new(count: usize) -> Groups {
        Groups { parents: (0..count as u32).collect() }
    }

    fn find(&mut self, mut node: usize) -> usize {
        while self.parents[node] as usize != node {
            self.parents[node] = self.parents[self.parents[node] as usize];
            node = self.parents[node] as usize;
        }
        node
    }

    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.find(a), self.find(b));
        self.parents[a.max(b)] = a.min(b) as u32;
    }
}

/// The lines of the bodies without a freedom clause, propagated from part to part along slides and welds.
fn lines(scene: &Scene, directions: &Directions, freedoms: &Freedoms) -> Vec<Line> {
    let neighbours = Neighbours::of(scene);
    let mut lines: Vec<Option<Line>> = vec![None; scene.bodies.len() + 1 + scene.bases.len()];
    let mut queue = Vec::new();
    let grounded = |body: &super::scene::Body| body.freedom != Freedom::FromJoints;
    let bodies = (0..scene.bodies.len()).filter(|&index| grounded(&scene.bodies[index]));
    let bodies = bodies.map(|index| Part::Body(BodyId(index as u32)));
    let bases = (0..scene.bases.len()).map(|index| Part::Base(super::scene::BaseId(index as u32)));
    for part in bodies.chain([Part::Ground]).chain(bases) {
        let line = if can_turn(scene, freedoms, part) { Line::Other } else { own_line(scene, directions, part) };
        lines[node(scene, part)] = Some(line);
        queue.push(node(scene, part));
    }
    while let Some(from) = queue.pop() {
        for &joint in neighbours.of_node(from) {
            let joint = &scene.joints[joint as usize];
            let ends = [node(scene, joint.ends[0].part), node(scene, joint.ends[1].part)];
            let to = if ends[0] == from { ends[1] } else { ends[0] };
            if lines[to].is_none() {
                lines[to] = lines[from].as_ref().map(|line| passed_on(line, joint));
                queue.push(to);
            }
        }
    }
    lines.truncate(scene.bodies.len());
    lines.into_iter().map(|line| line.unwrap_or(Line::Other)).collect()
}

/// The line of the part at the other end of a joint.
fn passed_on(line: &Line, joint: &Joint) -> Line {
    match (line, &joint.along) {
        _ if joint.kind.turns => Line::Other,
        (line, None) => line.clone(),
        (Line::Fixed, Some(along)) => Line::Along(Arc::new(along.clone())),
        (Line::Along(line), Some(along)) if are_parallel(line, along) => Line::Along(line.clone()),
        _ => Line::Other,
    }
}

/// Whether two directions are not certainly different.
pub fn are_parallel(a: &Vec3, b: &Vec3) -> bool {
    std::ptr::eq(a, b) || a.cross(b).may_be_zero()
}

/// The joints of each node.
struct Neighbours {
    starts: Vec<u32>,
    joints: Vec<u32>,
}

impl Neighbours {
    fn of(scene: &Scene) -> Neighbours {
        let count = scene.bodies.len() + 1 + scene.bases.len();
        let mut starts = vec![0u32; count + 1];
        let ends = || {
            let joints = scene.joints.iter().enumerate();
            joints.flat_map(|(index, joint)| joint.ends.iter().map(move |end| (node(scene, end.part), index as u32)))
        };
        for (node, _) in ends() {
            starts[node + 1] += 1;
        }
        for node in 0..count {
            starts[node + 1] += starts[node];
        }
        let mut next = starts.clone();
        let mut joints = vec![0; 2 * scene.joints.len()];
        for (node, joint) in ends() {
            joints[next[node] as usize] = joint;
            next[node] += 1;
        }
        Neighbours { starts, joints }
    }

    fn of_node(&self, node: usize) -> &[u32] {
        &self.joints[self.starts[node] as usize..self.starts[node + 1] as usize]
    }
}
