//! The order of the coordinates of a scene. See docs/method/kinematics.md.

use super::{Carriage, Group, Index, Kinematics, NO_TURN, Slide};
use crate::base::{Number, Vec3};
use crate::lower::tree::{Owner, PieceId, Tree};
use crate::model::scene::{BodyId, Freedom, Input, InputKind, Scene};

/// Assigns the order of the coordinates: that of the declarations of the bodies, and x, y, along, slide, angle within a
/// body; then the motions of the bases, in the order of the inputs.
pub(super) struct Numbering<'a> {
    scene: &'a Scene,
    kinematics: Kinematics,
}

impl<'a> Numbering<'a> {
    pub(super) fn new(scene: &'a Scene, tree: Tree) -> Numbering<'a> {
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

    pub(super) fn finish(mut self) -> Kinematics {
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
                    let coordinate = self.free(body);
                    self.slide(piece, coordinate, &translation.direction);
                }
            }
            return self.free_turn(piece, body);
        };
        if let Some(along) = &self.scene.joints[joint.index()].along {
            let coordinate = self.free(body);
            self.slide(piece, coordinate, along);
        }
        self.free_turn(piece, body);
    }

    fn free_turn(&mut self, piece: PieceId, body: BodyId) {
        if self.kinematics.tree.pieces[piece as usize].turns {
            let coordinate = self.free(body);
            self.turn(piece, coordinate);
        }
    }

    fn free(&mut self, body: BodyId) -> Index {
        self.kinematics.free.push(body);
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
