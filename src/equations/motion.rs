//! Where every point is, in the coordinates of the scene: its own joint tree, made from the scene as docs/method/kinematics.md#the-tree says and not
//! from the lowering. In: the scene and what its numbers were written as; out: places of points and angles of parts as sums.
//!
//! A coordinate is measured from rest: at a rest away from the drawing it means `q_0 + q`.

use super::coordinate::{self, Coordinate};
use super::names::Names;
use crate::base::OrderBy;
use crate::model::scene::{BaseId, BodyId, Freedom, InputKind, Joint, Part, Scene};
use crate::model::written::{Pair, Written};
use crate::symbols::{Lengths, Sum};

/// Parts that are welded together, and how they are carried.
#[derive(Clone, Debug)]
struct Piece {
    /// Place of the anchor; of a piece that turns with the ground the displacement.
    base: Pair,
    /// The drawn point that `base` is the place of.
    anchor: Option<Pair>,
    /// The coordinate of its absolute angle.
    angle: Option<usize>,
}

/// The motion of a scene.
#[derive(Clone, Debug)]
pub struct Motion {
    pub coordinates: Vec<Coordinate>,
    /// Number of coordinates that no base prescribes; they come first.
    pub free: usize,
    pieces: Vec<Piece>,
    /// The piece of ground, bases and bodies.
    piece_of: Vec<usize>,
    bases: usize,
    /// Joints that close loops.
    pub closing: Vec<usize>,
}

impl Motion {
    /// `rests` gives the value of a coordinate at rest.
    pub fn new(
        scene: &Scene,
        written: &Written,
        names: &mut Names,
        rests: &impl Fn(&mut Names, &Coordinate, usize) -> Sum,
    ) -> Option<Motion> {
        Growth::new(scene, written).grow(names, rests)
    }

    fn piece(&self, part: Part) -> &Piece {
        let number = match part {
            Part::Ground => 0,
            Part::Base(base) => 1 + base.index(),
            Part::Body(body) => 1 + self.bases + body.index(),
        };
        &self.pieces[self.piece_of[number]]
    }

    /// The place of a drawn point of a part; without a point its displacement.
    pub fn place(&self, part: Part, at: Option<&Pair>) -> Pair {
        place(&self.coordinates, self.piece(part), at)
    }

    /// The angle by which a part has turned from the drawing.
    pub fn angle(&self, part: Part) -> Option<Sum> {
        self.piece(part).angle.map(|angle| angle_of(&self.coordinates[angle]))
    }

    /// The coordinate of a part's angle.
    pub fn angle_coordinate(&self, part: Part) -> Option<usize> {
        self.piece(part).angle
    }

    /// A direction that turns with a part.
    pub fn rotate(&self, part: Part, direction: &Pair) -> Pair {
        match self.angle(part) {
            Some(angle) => turn(direction, &angle),
            None => direction.clone(),
        }
    }

    /// The time derivative of an expression in coordinates and velocities.
    pub fn rate(&self, of: &Sum, lengths: &Lengths) -> Sum {
        let mut rate = Sum::ZERO;
        for coordinate in &self.coordinates {
            for order in 0..2 {
                let by = of.derivative(coordinate.symbols[order], lengths);
                if !by.is_zero() {
                    rate = &rate + &(&by * &Sum::name(coordinate.symbols[order + 1]));
                }
            }
        }
        rate
    }
}

fn angle_of(coordinate: &Coordinate) -> Sum {
    &Sum::name(coordinate.symbols[0]) + &coordinate.rest
}

fn turn(arm: &Pair, angle: &Sum) -> Pair {
    let (sine, cosine) = (angle.sine(), angle.cosine());
    [&(&arm[0] * &cosine) - &(&arm[1] * &sine), &(&arm[0] * &sine) + &(&arm[1] * &cosine)]
}

fn place(coordinates: &[Coordinate], piece: &Piece, at: Option<&Pair>) -> Pair {
    match (piece.angle, at, &piece.anchor) {
        (Some(angle), Some(at), Some(anchor)) => {
            let arm = crate::model::written::difference(at, anchor);
            crate::model::written::sum(&piece.base, &turn(&arm, &angle_of(&coordinates[angle])))
        }
        (None, Some(at), _) => crate::model::written::sum(&piece.base, at),
        _ => piece.base.clone(),
    }
}

/// The tree while it grows, breadth first.
struct Growth<'a> {
    scene: &'a Scene,
    written: &'a Written,
    bases: usize,
    /// The representative of the welded parts of each part.
    class: Vec<usize>,
    piece_of_class: Vec<Option<usize>>,
    class_of_piece: Vec<usize>,
    carriers: Vec<Option<(usize, usize)>>,
    closing: Vec<usize>,
}

impl<'a> Growth<'a> {
    fn new(scene: &'a Scene, written: &'a Written) -> Growth<'a> {
        let bases = scene.bases.len();
        let count = 1 + bases + scene.bodies.len();
        let (class_of_piece, carriers, closing) = Default::default();
        let (class, piece_of_class) = ((0..count).collect(), vec![None; count]);
        Growth { scene, written, bases, class, piece_of_class, class_of_piece, carriers, closing }
    }

    fn number(&self, part: Part) -> usize {
        match part {
            Part::Ground => 0,
            Part::Base(base) => 1 + base.index(),
            Part::Body(body) => 1 + self.bases + body.index(),
        }
    }

    fn part(&self, number: usize) -> Part {
        match number {
            0 => Part::Ground,
            n if n <= self.bases => Part::Base(BaseId((n - 1) as u32)),
            n => Part::Body(BodyId((n - 1 - self.bases) as u32)),
        }
    }

    /// Whether the part is held without a joint.
    fn has_no_joint(&self, number: usize) -> bool {
        match self.part(number) {
            Part::Body(body) => self.scene.bodies[body.index()].freedom != Freedom::FromJoints,
            Part::Ground | Part::Base(_) => true,
        }
    }

    /// Joins welded parts. A part that is held represents the others, otherwise the one declared first.
    fn weld(&mut self) {
        for (index, joint) in self.scene.joints.iter().enumerate() {
            if !joint.kind.is_rigid() {
                continue;
            }
            let [a, b] = [0, 1].map(|end| self.class[self.number(joint.ends[end].part)]);
            if a == b || self.has_no_joint(a) && self.has_no_joint(b) {
                self.closing.push(index);
                continue;
            }
            let (first, second) = (a.min(b), a.max(b));
            let (keeps, joins) = if self.has_no_joint(second) { (second, first) } else { (first, second) };
            self.class.iter_mut().filter(|class| **class == joins).for_each(|class| *class = keeps);
        }
    }

    fn add(&mut self, class: usize, carrier: Option<(usize, usize)>) {
        self.piece_of_class[class] = Some(self.class_of_piece.len());
        self.class_of_piece.push(class);
        self.carriers.push(carrier);
    }

    fn grow(mut self, names: &mut Names, rests: &impl Fn(&mut Names, &Coordinate, usize) -> Sum) -> Option<Motion> {
        self.weld();
        for number in 0..self.class.len() {
            if self.class[number] == number && self.has_no_joint(number) {
                self.add(number, None);
            }
        }
        let mut joints_of: Vec<Vec<usize>> = vec![Vec::new(); self.class.len()];
        for (index, joint) in self.scene.joints.iter().enumerate().filter(|(_, joint)| !joint.kind.is_rigid()) {
            for end in &joint.ends {
                joints_of[self.class[self.number(end.part)]].push(index);
            }
        }
        let mut used = vec![false; self.scene.joints.len()];
        let mut next = 0;
        while next < self.class_of_piece.len() {
            let class = self.class_of_piece[next];
            for &joint in &joints_of[class] {
                if std::mem::replace(&mut used[joint], true) {
                    continue;
                }
                let ends = [0, 1].map(|end| self.class[self.number(self.scene.joints[joint].ends[end].part)]);
                let other = if ends[0] == class { ends[1] } else { ends[0] };
                match self.piece_of_class[other] {
                    None => self.add(other, Some((next, joint))),
                    Some(_) => self.closing.push(joint),
                }
            }
            next += 1;
        }
        self.closing.sort_unstable();
        self.finish(names, rests)
    }

    /// Numbers the coordinates in the order of the declarations, and places the pieces.
    fn finish(self, names: &mut Names, rests: &impl Fn(&mut Names, &Coordinate, usize) -> Sum) -> Option<Motion> {
        let mut coordinates = Vec::new();
        let mut own: Vec<Vec<usize>> = vec![Vec::new(); self.class_of_piece.len()];
        for number in 1 + self.bases..self.class.len() {
            if self.class[number] != number {
                continue;
            }
            let piece = self.piece_of_class[number]?;
            for motion in self.motions(number, piece) {
                own[piece].push(coordinates.len());
                coordinates.push(self.coordinate(number, motion, None, coordinates.len(), names));
            }
        }
        let free = coordinates.len();
        let mut prescribed: Vec<(BaseId, Option<usize>, usize)> = Vec::new();
        for (index, input) in self.scene.inputs.iter().enumerate() {
            if let InputKind::Base { base, translation } = input.kind {
                prescribed.push((base, translation, index));
            }
        }
        prescribed.order_by_key(|(base, ..)| *base);
        for (base, translation, input) in prescribed {
            let translations = &self.scene.bases[base.index()].translations;
            let motion = translation.and_then(|which| translations.get(which)).map_or("angle", |t| t.motion);
            let number = 1 + base.index();
            let piece = self.piece_of_class[self.class[number]]?;
            own[piece].push(coordinates.len());
            let mut coordinate = self.coordinate(number, motion, Some(input), coordinates.len(), names);
            coordinate.rest = self.written.inputs.get(input)?.constant.clone();
            coordinates.push(coordinate);
        }
        coordinate::label(names, &coordinates, &self.scene.words);
        for (index, coordinate) in coordinates.iter_mut().enumerate().take(free) {
            coordinate.rest = rests(names, coordinate, index);
        }
        let pieces = self.pieces(&coordinates, &own, names)?;
        let piece_of: Option<Vec<usize>> = self.class.iter().map(|class| self.piece_of_class[*class]).collect();
        Some(Motion { coordinates, free, pieces, piece_of: piece_of?, bases: self.bases, closing: self.closing })
    }

    fn coordinate(
        &self,
        number: usize,
        motion: &'static str,
        input: Option<usize>,
        index: usize,
        names: &mut Names,
    ) -> Coordinate {
        let owner = self.part(number);
        let (owner_name, span) = match owner {
            Part::Base(base) => (self.scene.bases[base.index()].name, self.scene.bases[base.index()].span),
            // The ground has no coordinates.
            Part::Body(BodyId(body)) => (self.scene.bodies[body as usize].name, self.scene.bodies[body as usize].span),
            Part::Ground => (self.scene.bodies[0].name, self.scene.bodies[0].span),
        };
        let symbols = names.coordinate(index, input.is_some());
        Coordinate { owner, owner_name, span, motion, turns: motion == "angle", symbols, rest: Sum::ZERO, input }
    }

    /// The words of a body's freedoms, in order.
    fn motions(&self, number: usize, piece: usize) -> Vec<&'static str> {
        let Part::Body(body) = self.part(number) else { return Vec::new() };
        match (self.carriers[piece], &self.scene.bodies[body.index()].freedom) {
            (Some((_, joint)), _) => {
                let kind = self.scene.joints[joint].kind;
                kind.slides.then_some("slide").into_iter().chain(kind.turns.then_some("angle")).collect()
            }
            (None, Freedom::OnGround { translations, turns }) => {
                let turn = turns.then_some("angle");
                translations.iter().map(|translation| translation.motion).chain(turn).collect()
            }
            (None, Freedom::FromJoints) => Vec::new(),
        }
    }

    fn pieces(&self, coordinates: &[Coordinate], own: &[Vec<usize>], names: &Names) -> Option<Vec<Piece>> {
        let mut pieces: Vec<Piece> = Vec::with_capacity(own.len());
        for (piece, own) in own.iter().enumerate() {
            let placed = match self.carriers[piece] {
                None => self.placed_piece(self.class_of_piece[piece], coordinates, own, names)?,
                Some((carrier, joint)) => self.carry_part(&pieces[carrier], joint, (coordinates, own), names)?,
            };
            pieces.push(placed);
        }
        Some(pieces)
    }

    /// A part on the ground, or a base.
    fn placed_piece(&self, number: usize, coordinates: &[Coordinate], own: &[usize], names: &Names) -> Option<Piece> {
        let (translations, centre) = match self.part(number) {
            Part::Ground => (&[][..], None),
            Part::Base(base) => {
                let base = self.written.bases.get(base.index())?;
                (&base.translations[..], base.at.clone())
            }
            Part::Body(body) => {
                let body = self.written.bodies.get(body.index())?;
                (&body.translations[..], body.centre.clone())
            }
        };
        let mut shift = [Sum::ZERO, Sum::ZERO];
        let slides = own.iter().filter(|index| !coordinates[**index].turns);
        for (index, direction) in slides.zip(translations) {
            shift = along(&shift, &names.unit(direction), &coordinates[*index]);
        }
        let angle = own.iter().copied().find(|index| coordinates[*index].turns);
        Some(match (angle, centre) {
            (Some(_), Some(centre)) => {
                let base = crate::model::written::sum(&shift, &centre);
                Piece { base, anchor: Some(centre), angle }
            }
            _ => Piece { base: shift, anchor: None, angle },
        })
    }

    /// A part that a joint ties to its carrier.
    fn carry_part(
        &self,
        carrier: &Piece,
        joint: usize,
        (coordinates, own): (&[Coordinate], &[usize]),
        names: &Names,
    ) -> Option<Piece> {
        let written = self.written.joints.get(joint)?;
        let first: &Joint = self.scene.joints.get(joint)?;
        match (first.kind.turns, first.kind.slides) {
            (true, false) => {
                let at = written.at.clone()?;
                let base = place(coordinates, carrier, Some(&at));
                Some(Piece { base, anchor: Some(at), angle: own.first().copied() })
            }
            (false, true) => {
                let direction = names.unit(written.along.as_ref()?);
                let direction = match carrier.angle {
                    Some(angle) => turn(&direction, &angle_of(&coordinates[angle])),
                    None => direction,
                };
                let base = along(&carrier.base, &direction, &coordinates[*own.first()?]);
                Some(Piece { base, anchor: carrier.anchor.clone(), angle: carrier.angle })
            }
            _ => None,
        }
    }
}

/// A place moved along a direction by a coordinate.
fn along(from: &Pair, direction: &Pair, coordinate: &Coordinate) -> Pair {
    let way = angle_of(coordinate);
    [&from[0] + &(&direction[0] * &way), &from[1] + &(&direction[1] * &way)]
}
