//! Ground, bodies and bases in one row of numbers, with the points that the scene gives of each.

use super::Outline;
use crate::base::{Name, Vec3};
use crate::model::scene::{Attachment, BaseId, BodyId, Freedom, Motion, Part, Scene, Shape, Translation};
use crate::picture::Refusal;
use crate::picture::geometry::Point;

/// Numbers of parts: the ground is 0, then bodies, then bases.
#[derive(Clone, Copy, Debug)]
pub struct Parts {
    pub bodies: usize,
    pub bases: usize,
}

pub const GROUND: usize = 0;

/// Half of a body without a shape, px.
pub const BLOCK: Point = Point::new(23.0, 17.0);
/// Radius of a body that only turns.
pub const WHEEL: f64 = 22.0;
/// Radius of a mass in one point.
pub const BOB: f64 = 10.0;
pub const DOT: f64 = 4.0;

impl Parts {
    pub fn new(scene: &Scene) -> Parts {
        Parts { bodies: scene.bodies.len(), bases: scene.bases.len() }
    }

    pub fn count(&self) -> usize {
        1 + self.bodies + self.bases
    }

    pub fn number(&self, part: Part) -> usize {
        match part {
            Part::Ground => GROUND,
            Part::Body(BodyId(body)) => 1 + body as usize,
            Part::Base(BaseId(base)) => 1 + self.bodies + base as usize,
        }
    }

    pub fn part(&self, number: usize) -> Part {
        match number {
            GROUND => Part::Ground,
            n if n <= self.bodies => Part::Body(BodyId((n - 1) as u32)),
            n => Part::Base(BaseId((n - 1 - self.bodies) as u32)),
        }
    }

    pub fn name(&self, scene: &Scene, number: usize) -> Option<Name> {
        match self.part(number) {
            Part::Ground => None,
            Part::Body(body) => Some(scene.bodies[body.index()].name),
            Part::Base(base) => Some(scene.bases[base.index()].name),
        }
    }

    /// The motions along fixed directions that a part has by itself.
    pub fn translations<'a>(&self, scene: &'a Scene, number: usize) -> &'a [Translation] {
        match self.part(number) {
            Part::Ground => &[],
            Part::Base(base) => &scene.bases[base.index()].translations,
            Part::Body(body) => match &scene.bodies[body.index()].freedom {
                Freedom::OnGround { translations, .. } => translations,
                Freedom::FromJoints => &[],
            },
        }
    }

    /// Whether a part turns about its own place and does not move otherwise.
    pub fn only_turns(&self, scene: &Scene, number: usize) -> bool {
        match self.part(number) {
            Part::Ground => false,
            Part::Base(base) => {
                let base = &scene.bases[base.index()];
                base.turns && base.translations.is_empty()
            }
            Part::Body(body) => match &scene.bodies[body.index()].freedom {
                Freedom::OnGround { translations, turns } => *turns && translations.is_empty(),
                Freedom::FromJoints => false,
            },
        }
    }

    /// The outline of a part without a place in the scene.
    pub fn common_outline(&self, scene: &Scene, number: usize, along: Point) -> Outline {
        match self.part(number) {
            Part::Ground => Outline::Nowhere,
            Part::Base(_) => Outline::Plate { along, half: 26.0 },
            Part::Body(body) => {
                let body = &scene.bodies[body.index()];
                let shape = body.shape.as_deref();
                let mass = |number: Option<&crate::base::Number>| number.is_some_and(|n| !n.is_zero());
                match shape {
                    Some(Shape::Disk { .. }) => Outline::Disk { radius: WHEEL },
                    Some(Shape::Ring { .. }) => Outline::Ring { radius: WHEEL },
                    _ if self.only_turns(scene, number) => Outline::Wheel { radius: WHEEL },
                    None if !mass(body.mass.as_ref()) && !mass(body.inertia.as_deref()) => Outline::Dot { radius: DOT },
                    _ => Outline::Block { half: BLOCK },
                }
            }
        }
    }

    /// The points of the scene that belong to each part, its own place first. Points of the ground are left out.
    pub fn known_points(&self, scene: &Scene) -> Result<Vec<Vec<[f64; 2]>>, Refusal> {
        let mut known = PlacedParts { parts: *self, scene, points: vec![Vec::new(); self.count()] };
        for (index, body) in scene.bodies.iter().enumerate() {
            if let Some(centre) = body.centre.as_deref() {
                known.add(1 + index, centre)?;
            }
            if let Some(Shape::Rod { ends }) = body.shape.as_deref() {
                known.add(1 + index, &ends[0])?;
                known.add(1 + index, &ends[1])?;
            }
        }
        for (index, base) in scene.bases.iter().enumerate() {
            if let Some(at) = base.at.as_deref() {
                known.add(1 + self.bodies + index, at)?;
            }
        }
        let inputs = scene.inputs.iter().flat_map(|input| input.kind.ends());
        let joints = scene.joints.iter().flat_map(|joint| &joint.ends);
        let elements = scene.elements.iter().flat_map(|element| &element.ends);
        for end in joints.chain(elements).chain(inputs) {
            known.attach(end)?;
        }
        for term in scene.outputs.iter().flat_map(|output| &output.terms) {
            if let Motion::Point { part, at: Some(at), .. } = &term.motion {
                known.add(self.number(*part), at)?;
            }
        }
        Ok(known.points)
    }
}

struct PlacedParts<'a> {
    parts: Parts,
    scene: &'a Scene,
    points: Vec<Vec<[f64; 2]>>,
}

/// The number of different points of a part that are searched for a known one. For a part with more, some points are
/// stored twice.
const MOST_COMPARED: usize = 64;

impl PlacedParts<'_> {
    fn attach(&mut self, end: &Attachment) -> Result<(), Refusal> {
        match end.at.as_deref() {
            Some(at) => self.add(self.parts.number(end.part), at),
            None => Ok(()),
        }
    }

    fn add(&mut self, number: usize, at: &Vec3) -> Result<(), Refusal> {
        let name = || {
            let name = self.parts.name(self.scene, number);
            name.map_or_else(|| "ground".into(), |name| self.scene.words.display(name))
        };
        if !at.z.is_zero() {
            return Err(Refusal::Spatial(name()));
        }
        let point = [at.x.to_f64(), at.y.to_f64()];
        /// Differences and squares of larger ones leave the range.
        const LARGEST: f64 = 1e150;
        if point.iter().any(|x| x.is_nan() || x.abs() > LARGEST) {
            return Err(Refusal::OutOfRange(name()));
        }
        let points = &mut self.points[number];
        if !points.iter().take(MOST_COMPARED).any(|known| *known == point) {
            points.push(point);
        }
        Ok(())
    }
}

/// A direction of the scene in binary64, of length one; y upwards.
pub fn straight(direction: &Vec3) -> [f64; 2] {
    let unit = Point::new(direction.x.to_f64(), direction.y.to_f64()).unit().unwrap_or(Point::new(1.0, 0.0));
    [unit.x, unit.y]
}
