//! An independent way from a scene to M, C, K, B and P: absolute coordinates, multipliers, numerical derivatives.
//!
//! Written without looking at `src/lower`. Every part (body or support) has three absolute coordinates: the
//! displacement of its centre in x and y, and its angle. Energies, stretches, constraints, the work of loads and
//! outputs are plain functions of the displaced parts. Derivatives that lowering forms by hand are computed here by
//! eighth-order central differences in double-double arithmetic; joints and freedom clauses are constraints g = 0 with
//! multipliers:
//!
//! rest: grad V + G^T lambda = 0, g = 0 (Newton);
//! K = N^T (Hess V + sum lambda Hess g) N with G N = 0 and S N = 1, where S picks the coordinates by their names.
//!
//! At a rest the gradient of V + lambda g vanishes, so K does not depend on the second order of the coordinates.
//!
//! Errors: with a step h of 2^-14 and features (spring lengths, lever arms) no smaller than a tenth, the truncation
//! error is below 600 (h / 0.1)^8 = 1e-22 and the rounding error some 1e-31 / h^2 = 3e-23, both relative to the scale
//! of the energy.

use super::extended::{Matrix, sin_cos, solve};
use vibc::base::number::Dd;
use vibc::base::{Number, Vec3};
use vibc::kinds::motions::ReactionComponent;
use vibc::model::scene::{
    Attachment, BodyId, Element, Freedom, Geometry, Holder, InputKind, Joint, JointId, Law, Motion, MotionTerm, Part,
    Reaction, Scene, Signal, SpringRest,
};

/// Step of the differences, m and rad.
const STEP: f64 = 1.0 / 16384.0;

/// A displaced part.
#[derive(Clone, Copy, Debug)]
struct Pose {
    x: Dd,
    y: Dd,
    angle: Dd,
    cos: Dd,
    sin: Dd,
}

impl Pose {
    fn drawn() -> Pose {
        Pose { x: Dd::ZERO, y: Dd::ZERO, angle: Dd::ZERO, cos: Dd::ONE, sin: Dd::ZERO }
    }

    fn turned(&mut self, by: Dd, (sine, cosine): (Dd, Dd)) {
        let (cos, sin) = (self.cos, self.sin);
        self.cos = cos * cosine - sin * sine;
        self.sin = sin * cosine + cos * sine;
        self.angle += by;
    }
}

/// A point of a part, or a fixed one.
#[derive(Clone, Copy, Debug)]
struct Spot {
    part: Option<usize>,
    drawn: [Dd; 2],
    /// Position relative to the part's centre, as drawn.
    arm: [Dd; 2],
}

impl Spot {
    fn now(&self, poses: &[Pose]) -> [Dd; 2] {
        let Some(part) = self.part else { return self.drawn };
        let p = &poses[part];
        let centre = [self.drawn[0] - self.arm[0], self.drawn[1] - self.arm[1]];
        let [u, v] = self.arm;
        [centre[0] + p.x + p.cos * u - p.sin * v, centre[1] + p.y + p.sin * u + p.cos * v]
    }
}

/// Entries of a vector over the variables of all parts.
type Sparse = Vec<(usize, Dd)>;

type Value<'a> = Box<dyn Fn(&[Pose]) -> Dd + 'a>;

/// A scalar function of the poses of a few parts.
struct Quantity<'a> {
    parts: Vec<usize>,
    value: Value<'a>,
}

impl<'a> Quantity<'a> {
    fn new(parts: impl IntoIterator<Item = Option<usize>>, value: impl Fn(&[Pose]) -> Dd + 'a) -> Quantity<'a> {
        let mut parts: Vec<usize> = parts.into_iter().flatten().collect();
        parts.sort_unstable();
        parts.dedup();
        Quantity { parts, value: Box::new(value) }
    }

    /// Indices of its variables among those of all parts: three for each part.
    fn variables(&self) -> Vec<usize> {
        self.parts.iter().flat_map(|part| [3 * part, 3 * part + 1, 3 * part + 2]).collect()
    }
}

/// First derivative along a direction: weights of f(k h) - f(-k h), k = 1..4, of order eight.
const FIRST: [(f64, f64); 4] = [(4.0, 5.0), (-1.0, 5.0), (4.0, 105.0), (-1.0, 280.0)];
/// Second derivative: weights of f(k h) + f(-k h) - 2 f(0).
const SECOND: [(f64, f64); 4] = [(8.0, 5.0), (-1.0, 5.0), (8.0, 315.0), (-1.0, 560.0)];

/// The eight displaced copies of some poses, with rotations of known sine and cosine.
struct Differences {
    /// Sine and cosine of k h for k = -4..4.
    turns: Vec<(Dd, Dd)>,
}

impl Differences {
    fn new() -> Differences {
        Differences { turns: (-4..=4).map(|k| sin_cos(Dd::from(f64::from(k) * STEP))).collect() }
    }

    fn displaced(&self, poses: &mut [Pose], variable: usize, k: i32) {
        let by = Dd::from(f64::from(k) * STEP);
        let pose = &mut poses[variable / 3];
        match variable % 3 {
            0 => pose.x += by,
            1 => pose.y += by,
            _ => pose.turned(by, self.turns[(k + 4) as usize]),
        }
    }

    /// f at k steps along the sum of the given axes.
    fn sample(&self, quantity: &Quantity, poses: &[Pose], axes: &[usize], k: i32) -> Dd {
        let mut moved = poses.to_vec();
        for &axis in axes {
            self.displaced(&mut moved, axis, k);
        }
        (quantity.value)(&moved)
    }

    /// First and second derivative along the sum of the given axes.
    fn along(&self, quantity: &Quantity, poses: &[Pose], axes: &[usize]) -> (Dd, Dd) {
        let middle = (quantity.value)(poses);
        let (mut first, mut second) = (Dd::ZERO, Dd::ZERO);
        for k in 1..=4 {
            let ahead = self.sample(quantity, poses, axes, k);
            let behind = self.sample(quantity, poses, axes, -k);
            let (a, b) = FIRST[k as usize - 1];
            first += (ahead - behind) * Dd::from(a) / Dd::from(b);
            let (a, b) = SECOND[k as usize - 1];
            second += (ahead + behind - middle * 2.0) * Dd::from(a) / Dd::from(b);
        }
        (first * (1.0 / STEP), second * (1.0 / (STEP * STEP)))
    }

    fn gradient(&self, quantity: &Quantity, poses: &[Pose]) -> Sparse {
        quantity.variables().into_iter().map(|v| (v, self.along(quantity, poses, &[v]).0)).collect()
    }

    /// Gradient and Hessian: f_ij = (f_(i+j)(i+j) - f_ii - f_jj) / 2.
    fn hessian(&self, quantity: &Quantity, poses: &[Pose]) -> (Sparse, Vec<(usize, usize, Dd)>) {
        let variables = quantity.variables();
        let single: Vec<(Dd, Dd)> = variables.iter().map(|&v| self.along(quantity, poses, &[v])).collect();
        let mut entries = Vec::new();
        for (i, &a) in variables.iter().enumerate() {
            entries.push((a, a, single[i].1));
            for (j, &b) in variables.iter().enumerate().take(i) {
                let both = self.along(quantity, poses, &[a, b]).1;
                let mixed = (both - single[i].1 - single[j].1).scale(0.5);
                entries.push((a, b, mixed));
                entries.push((b, a, mixed));
            }
        }
        (variables.into_iter().zip(single.into_iter().map(|s| s.0)).collect(), entries)
    }
}

/// The identity of a generalised coordinate: a motion of a body.
#[derive(Clone, Debug, PartialEq)]
pub struct Chosen {
    /// Index into the scene's bodies.
    pub body: usize,
    /// `x`, `y`, `angle`, `along`.
    pub motion: String,
}

/// The linear system of the second formulation; rows and columns in the order of the chosen coordinates.
pub struct Linearised {
    pub m: Matrix,
    pub c: Matrix,
    pub k: Matrix,
    /// One column for each input: b0, b1, b2.
    pub b: [Matrix; 3],
    /// One row for each output: p0, p1, p2.
    pub p: [Matrix; 3],
    /// Feed-through: one row for each output, one column for each input.
    pub d: [Matrix; 3],
    /// The distance of Newton's iteration from its start, largest component.
    pub distance: f64,
    /// The rest in the chosen coordinates, measured from the drawing.
    pub rest: Vec<Dd>,
}

/// The motion that a constraint keeps at zero.
#[derive(Clone, Copy, Debug)]
enum Holds {
    /// A displacement along a direction that turns with a part.
    Along([Dd; 2], Option<usize>),
    Turn,
    /// The sum of a coupling.
    Sum,
}

/// A reaction by the multipliers: at rest, and for each input its amplitude over that of the input at a real s.
pub struct Reacted {
    pub at_rest: Dd,
    pub gains: Vec<Dd>,
}

pub struct Formulation<'a> {
    scene: &'a Scene,
    differences: Differences,
    energies: Vec<Quantity<'a>>,
    constraints: Vec<Quantity<'a>>,
    /// What each constraint holds.
    held: Vec<(Holder, Holds)>,
    dampers: Vec<(Dd, Quantity<'a>)>,
    inerters: Vec<(Dd, Quantity<'a>)>,
}

fn dd(number: &Number) -> Dd {
    number.to_ball().mid
}

fn planar(v: &Vec3) -> [Dd; 2] {
    [dd(&v.x), dd(&v.y)]
}

fn dot(a: [Dd; 2], b: [Dd; 2]) -> Dd {
    a[0] * b[0] + a[1] * b[1]
}

fn minus(a: [Dd; 2], b: [Dd; 2]) -> [Dd; 2] {
    [a[0] - b[0], a[1] - b[1]]
}

fn length(a: [Dd; 2]) -> Dd {
    dot(a, a).sqrt()
}

fn unit(v: &Vec3) -> [Dd; 2] {
    let v = planar(v);
    let l = length(v);
    [v[0] / l, v[1] / l]
}

impl<'a> Formulation<'a> {
    pub fn new(scene: &'a Scene) -> Formulation<'a> {
        Formulation::bare(scene).completed()
    }

    /// With every constraint, and without forces.
    fn bare(scene: &'a Scene) -> Formulation<'a> {
        let mut it = Formulation {
            scene,
            differences: Differences::new(),
            energies: Vec::new(),
            constraints: Vec::new(),
            held: Vec::new(),
            dampers: Vec::new(),
            inerters: Vec::new(),
        };
        it.clauses();
        it.joints();
        it.couples();
        it
    }

    fn completed(mut self) -> Formulation<'a> {
        self.drop_redundant_constraints();
        self.weights();
        self.elements();
        self.constant_loads();
        self
    }

    fn part_count(&self) -> usize {
        self.scene.bodies.len() + self.scene.bases.len()
    }

    /// Unknowns of a rest: three for each body (supports do not move by themselves).
    fn unknowns(&self) -> usize {
        3 * self.scene.bodies.len()
    }

    fn part(&self, part: Part) -> Option<usize> {
        match part {
            Part::Ground => None,
            Part::Body(id) => Some(id.index()),
            Part::Base(id) => Some(self.scene.bodies.len() + id.index()),
        }
    }

    fn centre(&self, part: Option<usize>) -> [Dd; 2] {
        let drawn = part.and_then(|i| match i.checked_sub(self.scene.bodies.len()) {
            None => self.scene.bodies[i].centre.as_deref(),
            Some(base) => self.scene.bases[base].at.as_deref(),
        });
        drawn.map_or([Dd::ZERO; 2], planar)
    }

    fn spot(&self, part: Part, at: Option<&Vec3>) -> Spot {
        let part = self.part(part);
        let centre = self.centre(part);
        let drawn = at.map_or(centre, planar);
        Spot { part, drawn, arm: minus(drawn, centre) }
    }

    fn end(&self, end: &Attachment) -> Spot {
        self.spot(end.part, end.at.as_deref())
    }

    /// Constraints of freedom clauses: `turns` alone fixes the centre, `moves x` fixes y and the angle, and so on.
    fn clauses(&mut self) {
        for (i, body) in self.scene.bodies.iter().enumerate() {
            let Freedom::OnGround { translations, turns } = &body.freedom else { continue };
            let mut fixed: Vec<[Dd; 2]> = Vec::new();
            match &translations[..] {
                [] => fixed.extend([[Dd::ONE, Dd::ZERO], [Dd::ZERO, Dd::ONE]]),
                [one] => {
                    let [x, y] = unit(&one.direction);
                    fixed.push([-y, x]);
                }
                _ => {}
            }
            for n in fixed {
                self.constraints.push(Quantity::new([Some(i)], move |p| dot(n, [p[i].x, p[i].y])));
                self.held.push((support(i), Holds::Along(n, None)));
            }
            if !turns {
                self.constraints.push(Quantity::new([Some(i)], move |p| p[i].angle));
                self.held.push((support(i), Holds::Turn));
            }
        }
    }

    fn joints(&mut self) {
        for (number, joint) in (0..).zip(&self.scene.joints) {
            let holder = Holder::Joint(JointId(number));
            let [a, b] = [self.end(&joint.ends[0]), self.end(&joint.ends[1])];
            match joint.kind.keyword {
                "pivot" => {
                    let at = joint.at.as_ref();
                    self.coincide(holder, self.spot(joint.ends[0].part, at), self.spot(joint.ends[1].part, at));
                }
                "weld" => {
                    // Any point is suitable if the parts turn together.
                    let at = Some(Vec3::ZERO);
                    self.coincide(
                        holder,
                        self.spot(joint.ends[0].part, at.as_ref()),
                        self.spot(joint.ends[1].part, at.as_ref()),
                    );
                    self.turn_together(holder, a.part, b.part);
                }
                "slide" => {
                    let [x, y] = unit(joint.along.as_ref().expect("a slide has a direction"));
                    let origin = Vec3::ZERO;
                    let [a, b] = [0, 1].map(|end| self.spot(joint.ends[end].part, Some(&origin)));
                    self.turn_together(holder, a.part, b.part);
                    self.held.push((holder, Holds::Along([-y, x], a.part)));
                    self.constraints.push(Quantity::new([a.part, b.part], move |p| {
                        let normal = match a.part {
                            None => [-y, x],
                            Some(i) => [-(p[i].cos * y) - p[i].sin * x, p[i].cos * x - p[i].sin * y],
                        };
                        dot(normal, minus(b.now(p), a.now(p)))
                    }));
                }
                other => panic!("no equation for a {other}"),
            }
        }
    }

    fn coincide(&mut self, holder: Holder, a: Spot, b: Spot) {
        for axis in 0..2 {
            let direction = [0, 1].map(|i| if i == axis { Dd::ONE } else { Dd::ZERO });
            self.held.push((holder, Holds::Along(direction, None)));
            self.constraints.push(Quantity::new([a.part, b.part], move |p| b.now(p)[axis] - a.now(p)[axis]));
        }
    }

    fn turn_together(&mut self, holder: Holder, a: Option<usize>, b: Option<usize>) {
        self.held.push((holder, Holds::Turn));
        self.constraints.push(Quantity::new([a, b], move |p| angle(p, b) - angle(p, a)));
    }

    /// Constraints of couplings: the sum of coefficient times motion is zero.
    fn couples(&mut self) {
        for (number, couple) in (0..).zip(&self.scene.couples) {
            self.held.push((Holder::Couple(number), Holds::Sum));
            let terms: Vec<(Dd, Quantity<'a>)> =
                couple.terms.iter().map(|term| (dd(&term.coefficient), self.motion(&term.motion))).collect();
            let parts: Vec<Option<usize>> = terms.iter().flat_map(|(_, q)| q.parts.iter().copied().map(Some)).collect();
            self.constraints.push(Quantity::new(parts, move |p| {
                terms.iter().fold(Dd::ZERO, |sum, (factor, q)| sum + *factor * (q.value)(p))
            }));
        }
    }

    /// Keeps constraints whose gradients are independent in the drawing (Gram-Schmidt): the others follow from them as
    /// long as the drawing can move at all.
    fn drop_redundant_constraints(&mut self) {
        let drawn = vec![Pose::drawn(); self.part_count()];
        let mut basis: Vec<Vec<Dd>> = Vec::new();
        let mut kept = Vec::new();
        let held = std::mem::take(&mut self.held);
        for (constraint, held) in std::mem::take(&mut self.constraints).into_iter().zip(held) {
            let rows = self.gradients(&drawn, &[&constraint]);
            let mut row: Vec<Dd> = (0..self.unknowns()).map(|j| rows.at(0, j)).collect();
            let before = norm(&row);
            for other in &basis {
                let share = row.iter().zip(other).fold(Dd::ZERO, |sum, (a, b)| sum + *a * *b);
                row.iter_mut().zip(other).for_each(|(a, b)| *a -= share * *b);
            }
            let size = norm(&row);
            // Dependent rows leave only the differences' error of 1e-22, independent ones their true distance.
            if size.to_f64() > 1e-15 * before.to_f64() {
                basis.push(row.into_iter().map(|a| a / size).collect());
                kept.push(constraint);
                self.held.push(held);
            }
        }
        self.constraints = kept;
    }

    fn weights(&mut self) {
        let g = planar(&self.scene.gravity);
        for (i, body) in self.scene.bodies.iter().enumerate() {
            let mass = body.mass.as_ref().map_or(Dd::ZERO, dd);
            self.energies.push(Quantity::new([Some(i)], move |p| -(mass * dot(g, [p[i].x, p[i].y]))));
        }
    }

    /// The stretch of an element from the drawing.
    fn stretch(&self, element: &Element) -> Quantity<'a> {
        let [a, b] = [self.end(&element.ends[0]), self.end(&element.ends[1])];
        match &element.law.geometry {
            // By the lengths of the tangent and of what lies on the disks, the angle of the span's normal between them.
            Geometry::Span(span) => {
                let (gap, turns) = (dd(&span.gap), span.turns.each_ref().map(dd));
                let side = if span.left { Dd::ONE } else { -Dd::ONE };
                let tangent = move |d: [Dd; 2]| (dot(d, d) - gap * gap).sqrt();
                let apart = minus(b.drawn, a.drawn);
                let drawn = tangent(apart);
                Quantity::new([a.part, b.part], move |p| {
                    let d = minus(b.now(p), a.now(p));
                    let turned = angle_of([dot(apart, d), apart[0] * d[1] - apart[1] * d[0]]);
                    let normal = turned + side * (angle_of([gap, tangent(d)]) - angle_of([gap, drawn]));
                    let wound = turns[0] * (angle(p, a.part) - normal) + turns[1] * (angle(p, b.part) - normal);
                    tangent(d) - drawn + wound
                })
            }
            Geometry::Line => {
                let drawn = length(minus(b.drawn, a.drawn));
                Quantity::new([a.part, b.part], move |p| length(minus(b.now(p), a.now(p))) - drawn)
            }
            Geometry::Along(direction) => {
                let (d, drawn) = (self.first_to_second(element, direction), minus(b.drawn, a.drawn));
                Quantity::new([a.part, b.part], move |p| dot(d, minus(minus(b.now(p), a.now(p)), drawn)))
            }
            Geometry::Torsion => Quantity::new([a.part, b.part], move |p| angle(p, b.part) - angle(p, a.part)),
        }
    }

    /// The length (or angle) as drawn, with which a `free_length` is compared.
    fn drawn_length(&self, element: &Element) -> Dd {
        let [a, b] = [self.end(&element.ends[0]), self.end(&element.ends[1])];
        match &element.law.geometry {
            // A belt has no free length.
            Geometry::Span(_) | Geometry::Torsion => Dd::ZERO,
            Geometry::Line => length(minus(b.drawn, a.drawn)),
            Geometry::Along(direction) => dot(self.first_to_second(element, direction), minus(b.drawn, a.drawn)),
        }
    }

    /// A fixed direction, reversed if the drawing is opposite to it: a positive stretch moves the ends apart.
    fn first_to_second(&self, element: &Element, direction: &Vec3) -> [Dd; 2] {
        let d = unit(direction);
        let against = match (&element.ends[0].at, &element.ends[1].at) {
            (Some(a), Some(b)) => dot(d, planar(&b.sub(a))).hi < 0.0,
            _ => false,
        };
        if against { [-d[0], -d[1]] } else { d }
    }

    /// Spring: T0 s + k s^2 / 2. Damper: c s' against s'. Inerter: b s'^2 / 2 of kinetic energy.
    fn elements(&mut self) {
        for element in &self.scene.elements {
            let stretch = self.stretch(element);
            let Law { kind, coefficient, rest, .. } = &*element.law;
            let coefficient = dd(coefficient);
            match kind.keyword {
                "spring" | "belt" => {
                    let k = coefficient;
                    let tension = match rest {
                        SpringRest::AsDrawn => Dd::ZERO,
                        SpringRest::Preload(tension) => dd(tension),
                        SpringRest::FreeLength(free) => k * (self.drawn_length(element) - dd(free)),
                    };
                    let parts: Vec<Option<usize>> = stretch.parts.iter().copied().map(Some).collect();
                    self.energies.push(Quantity::new(parts, move |p| {
                        let s = (stretch.value)(p);
                        tension * s + (k * s * s).scale(0.5)
                    }));
                }
                "damper" => self.dampers.push((coefficient, stretch)),
                "inerter" => self.inerters.push((coefficient, stretch)),
                other => panic!("no law for a {other}"),
            }
        }
    }

    /// The displacement on which a unit of an input does work.
    fn work(&self, kind: &InputKind) -> Quantity<'a> {
        match kind {
            InputKind::Force { ends, direction } => {
                let d = unit(direction);
                let spots: Vec<Spot> = ends.iter().map(|end| self.end(end)).collect();
                let parts: Vec<Option<usize>> = spots.iter().map(|spot| spot.part).collect();
                Quantity::new(parts, move |p| {
                    let moved = |spot: &Spot| dot(d, minus(spot.now(p), spot.drawn));
                    moved(&spots[0]) - spots.get(1).map_or(Dd::ZERO, moved)
                })
            }
            InputKind::ForceBetween { ends } => {
                let [a, b] = [self.end(&ends[0]), self.end(&ends[1])];
                Quantity::new([a.part, b.part], move |p| length(minus(b.now(p), a.now(p))))
            }
            InputKind::Torque { ends } => {
                let parts: Vec<Option<usize>> = ends.iter().map(|end| self.part(end.part)).collect();
                Quantity::new(parts.clone(), move |p| {
                    angle(p, parts[0]) - parts.get(1).map_or(Dd::ZERO, |&part| angle(p, part))
                })
            }
            InputKind::Base { .. } => Quantity::new([], |_| Dd::ZERO),
            InputKind::Unbalance { .. } => panic!("compared with forces, which are compared with this formulation"),
        }
    }

    fn constant_loads(&mut self) {
        for input in &self.scene.inputs {
            for signal in &input.signal {
                let Signal::Constant { value } = signal else { continue };
                let (load, work) = (dd(value), self.work(&input.kind));
                let parts: Vec<Option<usize>> = work.parts.iter().copied().map(Some).collect();
                self.energies.push(Quantity::new(parts, move |p| -(load * (work.value)(p))));
            }
        }
    }

    /// A motion as a function of the poses; for a force, the stretch to which it belongs.
    fn motion(&self, motion: &Motion) -> Quantity<'a> {
        match motion {
            Motion::Point { part, at, direction, .. } => {
                let (spot, d) = (self.spot(*part, at.as_deref()), planar(direction));
                Quantity::new([spot.part], move |p| dot(d, minus(spot.now(p), spot.drawn)))
            }
            Motion::Turn { part, .. } => {
                let part = self.part(*part);
                Quantity::new([part], move |p| angle(p, part))
            }
            Motion::Force { element } | Motion::Stretch { element } => {
                self.stretch(&self.scene.elements[element.index()])
            }
            Motion::Reaction(_) => panic!("a reaction is no motion of the parts"),
        }
    }

    /// Factor and derivative order of a term of an output, in addition to [`Formulation::motion`].
    fn factor(&self, term: &MotionTerm) -> (Dd, usize) {
        let coefficient = dd(&term.coefficient);
        match &term.motion {
            Motion::Point { derivative, .. } | Motion::Turn { derivative, .. } => {
                (coefficient, usize::from(*derivative))
            }
            Motion::Stretch { .. } | Motion::Reaction(_) => (coefficient, 0),
            Motion::Force { element } => {
                let Law { kind, coefficient: own, .. } = &*self.scene.elements[element.index()].law;
                let order = match kind.keyword {
                    "spring" | "belt" => 0,
                    "damper" => 1,
                    "inerter" => 2,
                    other => panic!("no law for a {other}"),
                };
                (coefficient * dd(own), order)
            }
        }
    }

    /// A generalised coordinate as a function of the poses.
    fn coordinate(&self, chosen: &Chosen) -> Quantity<'a> {
        let i = chosen.body;
        match chosen.motion.as_str() {
            "x" => Quantity::new([Some(i)], move |p| p[i].x),
            "y" => Quantity::new([Some(i)], move |p| p[i].y),
            "angle" => Quantity::new([Some(i)], move |p| p[i].angle),
            _ => self.oblique(i),
        }
    }

    /// The motion of a body along the direction of its clause, or along its slide relative to the other part.
    fn oblique(&self, i: usize) -> Quantity<'a> {
        if let Freedom::OnGround { translations, .. } = &self.scene.bodies[i].freedom {
            let d = unit(&translations[0].direction);
            return Quantity::new([Some(i)], move |p| dot(d, [p[i].x, p[i].y]));
        }
        let (joint, along) = self.slide_of(i);
        let [x, y] = unit(along);
        let origin = Vec3::ZERO;
        let [a, b] = [0, 1].map(|end| self.spot(joint.ends[end].part, Some(&origin)));
        let classes = self.welded();
        let is_carried = b.part.is_some_and(|part| classes[part] == classes[i]);
        let sign = if is_carried { Dd::ONE } else { -Dd::ONE };
        Quantity::new([a.part, b.part], move |p| {
            let d = match a.part {
                None => [x, y],
                Some(i) => [p[i].cos * x - p[i].sin * y, p[i].sin * x + p[i].cos * y],
            };
            sign * dot(d, minus(b.now(p), a.now(p)))
        })
    }

    /// The slide over which the ground is reached from a body: breadth first, with the joints in order of declaration.
    fn slide_of(&self, body: usize) -> (&'a Joint, &'a Vec3) {
        let classes = self.welded();
        let class = |end: &Attachment| self.part(end.part).map_or(0, |part| classes[part]);
        let bodies = &self.scene.bodies;
        // The ground, the bases, then the bodies that stand on the ground.
        let bases = (0..self.scene.bases.len()).map(|base| classes[bodies.len() + base]);
        let standing = (0..bodies.len()).filter(|i| bodies[*i].freedom != Freedom::FromJoints).map(|i| classes[i]);
        let mut reached: Vec<usize> = [0].into_iter().chain(bases).chain(standing).collect();
        let mut next = 0;
        while let Some(&from) = reached.get(next) {
            for joint in self.scene.joints.iter().filter(|joint| joint.kind.keyword != "weld") {
                let ends = [class(&joint.ends[0]), class(&joint.ends[1])];
                let to = if ends[0] == from { ends[1] } else { ends[0] };
                if !ends.contains(&from) || reached.contains(&to) {
                    continue;
                }
                reached.push(to);
                if let (true, Some(along)) = (to == classes[body], &joint.along) {
                    return (joint, along);
                }
            }
            next += 1;
        }
        panic!("no slide carries body {body}");
    }

    /// For each part the number of its welded group; 0 is the ground.
    fn welded(&self) -> Vec<usize> {
        let mut classes: Vec<usize> = (1..=self.part_count()).collect();
        for joint in self.scene.joints.iter().filter(|joint| joint.kind.keyword == "weld") {
            let [a, b] = [0, 1].map(|end| self.part(joint.ends[end].part).map_or(0, |part| classes[part]));
            classes.iter_mut().filter(|class| **class == a.max(b)).for_each(|class| *class = a.min(b));
        }
        classes
    }

    fn assembled(&self, size: usize, poses: &[Pose], weighted: &[(Dd, &Quantity)]) -> (Vec<Dd>, Matrix) {
        let mut gradient = vec![Dd::ZERO; size];
        let mut hessian = Matrix::zero(size, size);
        for (weight, quantity) in weighted {
            let (first, second) = self.differences.hessian(quantity, poses);
            for (i, value) in first {
                gradient[i] += *weight * value;
            }
            for (i, j, value) in second {
                *hessian.at_mut(i, j) += *weight * value;
            }
        }
        (gradient, hessian)
    }

    /// Rows of gradients over the variables of all parts.
    fn gradients(&self, poses: &[Pose], quantities: &[&Quantity]) -> Matrix {
        let mut rows = Matrix::zero(quantities.len(), 3 * self.part_count());
        for (row, quantity) in quantities.iter().enumerate() {
            for (variable, value) in self.differences.gradient(quantity, poses) {
                *rows.at_mut(row, variable) = value;
            }
        }
        rows
    }

    fn moved(&self, poses: &mut [Pose], step: &Matrix) {
        for (i, pose) in poses.iter_mut().enumerate().take(self.scene.bodies.len()) {
            pose.x += step.at(3 * i, 0);
            pose.y += step.at(3 * i + 1, 0);
            let turn = step.at(3 * i + 2, 0);
            pose.turned(turn, sin_cos(turn));
        }
    }

    /// Poses in which the chosen coordinates have the given values, by Newton's iteration on the constraints.
    fn posed(&self, chosen: &[Chosen], values: &[Dd]) -> Option<Vec<Pose>> {
        let coordinates: Vec<Quantity> = chosen.iter().map(|c| self.coordinate(c)).collect();
        let all: Vec<&Quantity> = self.constraints.iter().chain(&coordinates).collect();
        let mut poses = vec![Pose::drawn(); self.part_count()];
        for _ in 0..30 {
            let rows = self.gradients(&poses, &all);
            let mut missing = Matrix::zero(all.len(), 1);
            for (i, quantity) in all.iter().enumerate() {
                let target = i.checked_sub(self.constraints.len()).map_or(Dd::ZERO, |c| values[c]);
                *missing.at_mut(i, 0) = target - (quantity.value)(&poses);
            }
            let step = solve(columns(&rows, 0, self.unknowns()), missing)?;
            self.moved(&mut poses, &step);
            if step.largest() < 1e-24 {
                return Some(poses);
            }
        }
        None
    }

    /// The multipliers that leave the least unbalanced force: G G^T lambda = -G grad V. Without them a body that hangs
    /// on a pivot has no stiffness in the first step.
    fn balancing(&self, poses: &[Pose], energies: &[(Dd, &Quantity)], constraints: &[&Quantity]) -> Option<Vec<Dd>> {
        let (gradient, _) = self.assembled(3 * self.part_count(), poses, energies);
        let rows = columns(&self.gradients(poses, constraints), 0, self.unknowns());
        let mut right = Matrix::zero(constraints.len(), 1);
        for i in 0..constraints.len() {
            let along = (0..self.unknowns()).fold(Dd::ZERO, |sum, j| sum + rows.at(i, j) * gradient[j]);
            *right.at_mut(i, 0) = -along;
        }
        let solved = solve(rows.times(&rows.transposed()), right)?;
        Some((0..constraints.len()).map(|i| solved.at(i, 0)).collect())
    }

    /// Newton's iteration on grad V + G^T lambda = 0, g = 0; returns the poses, the multipliers and the distance from
    /// the start.
    fn rest(&self, mut poses: Vec<Pose>) -> Option<(Vec<Pose>, Vec<Dd>, f64)> {
        let (n, m) = (self.unknowns(), self.constraints.len());
        let energies: Vec<(Dd, &Quantity)> = self.energies.iter().map(|e| (Dd::ONE, e)).collect();
        let constraints: Vec<&Quantity> = self.constraints.iter().collect();
        let size = 3 * self.part_count();
        let mut multipliers = self.balancing(&poses, &energies, &constraints)?;
        let mut distance = 0.0;
        for _ in 0..60 {
            let weighted: Vec<(Dd, &Quantity)> = multipliers.iter().copied().zip(constraints.iter().copied()).collect();
            let (gradient, hessian) = self.assembled(size, &poses, &energies);
            let (_, curvature) = self.assembled(size, &poses, &weighted);
            let rows = self.gradients(&poses, &constraints);
            let mut left = Matrix::zero(n + m, n + m);
            let mut right = Matrix::zero(n + m, 1);
            for (i, force) in gradient.iter().enumerate().take(n) {
                *right.at_mut(i, 0) = -*force;
                for j in 0..n {
                    *left.at_mut(i, j) = hessian.at(i, j) + curvature.at(i, j);
                }
                for row in 0..m {
                    *left.at_mut(i, n + row) = rows.at(row, i);
                    *left.at_mut(n + row, i) = rows.at(row, i);
                }
            }
            for (row, constraint) in constraints.iter().enumerate() {
                *right.at_mut(n + row, 0) = -(constraint.value)(&poses);
            }
            let step = solve(left, right)?;
            multipliers = (0..m).map(|row| step.at(n + row, 0)).collect();
            let moves = columns(&step.transposed(), 0, n).transposed();
            self.moved(&mut poses, &moves);
            distance += moves.largest();
            if moves.largest() < 1e-21 {
                return Some((poses, multipliers, distance));
            }
        }
        None
    }

    /// The linear system about the rest that Newton's iteration finds from the given one (all zeros: from the drawing).
    pub fn linearised(&self, chosen: &[Chosen], start: &[Dd]) -> Option<Linearised> {
        let (poses, multipliers, distance) = self.rest(self.posed(chosen, start)?)?;
        let size = 3 * self.part_count();
        let (n, coordinates) = (chosen.len(), chosen.iter().map(|c| self.coordinate(c)).collect::<Vec<_>>());

        // Motions of all parts for unit motions of the coordinates, then of the inputs that are supports.
        let supports = self.supports();
        let tangent = self.tangent(&poses, &coordinates, &supports)?;
        let own = columns(&tangent, 0, n);
        let carried = columns(&tangent, n, n + supports.len());

        let weighted: Vec<(Dd, &Quantity)> = (self.energies.iter().map(|e| (Dd::ONE, e)))
            .chain(multipliers.iter().copied().zip(&self.constraints))
            .collect();
        let (_, stiffness) = self.assembled(size, &poses, &weighted);
        let inertia = self.inertia(&poses);
        let damping = self.damping(&poses);
        let forces = [&stiffness, &damping, &inertia].map(|matrix| own.transposed().times(&matrix.times(&carried)));
        let (p, d) = self.outputs(&poses, &own, &carried, &supports);
        Some(Linearised {
            m: own.congruence(&inertia),
            c: own.congruence(&damping),
            k: own.congruence(&stiffness),
            b: self.inputs(&poses, &own, &forces, &supports),
            p,
            d,
            distance,
            rest: coordinates.iter().map(|c| (c.value)(&poses)).collect(),
        })
    }

    /// The inputs that are motions of supports: input, part and direction (`None`: it turns).
    fn supports(&self) -> Vec<(usize, usize, Option<[Dd; 2]>)> {
        let scene = self.scene;
        let of_input = |(i, input): (usize, &vibc::model::scene::Input)| match &input.kind {
            InputKind::Base { base, translation } => {
                let direction = translation.map(|t| unit(&scene.bases[base.index()].translations[t].direction));
                Some((i, scene.bodies.len() + base.index(), direction))
            }
            _ => None,
        };
        scene.inputs.iter().enumerate().filter_map(of_input).collect()
    }

    /// G N = 0 and S N = 1, one column for each coordinate and one for each support's motion (with the coordinates
    /// held).
    fn tangent(
        &self,
        poses: &[Pose],
        coordinates: &[Quantity],
        supports: &[(usize, usize, Option<[Dd; 2]>)],
    ) -> Option<Matrix> {
        let (unknowns, n) = (self.unknowns(), coordinates.len());
        let size = 3 * self.part_count();
        let all: Vec<&Quantity> = self.constraints.iter().chain(coordinates).collect();
        let rows = self.gradients(poses, &all);
        let mut given = Matrix::zero(size, supports.len());
        for (column, (_, part, direction)) in supports.iter().enumerate() {
            match direction {
                Some([x, y]) => {
                    *given.at_mut(3 * part, column) = *x;
                    *given.at_mut(3 * part + 1, column) = *y;
                }
                None => *given.at_mut(3 * part + 2, column) = Dd::ONE,
            }
        }
        let driven = rows.times(&given);
        let mut right = Matrix::zero(all.len(), n + supports.len());
        for i in 0..n {
            *right.at_mut(self.constraints.len() + i, i) = Dd::ONE;
        }
        for i in 0..all.len() {
            for column in 0..supports.len() {
                *right.at_mut(i, n + column) = -driven.at(i, column);
            }
        }
        let solved = solve(columns(&rows, 0, unknowns), right)?;
        let mut tangent = Matrix::zero(size, n + supports.len());
        for i in 0..size {
            for j in 0..n + supports.len() {
                *tangent.at_mut(i, j) = if i < unknowns {
                    solved.at(i, j)
                } else {
                    j.checked_sub(n).map_or(Dd::ZERO, |column| given.at(i, column))
                };
            }
        }
        Some(tangent)
    }

    fn inertia(&self, poses: &[Pose]) -> Matrix {
        let mut inertia = Matrix::zero(3 * self.part_count(), 3 * self.part_count());
        for (i, body) in self.scene.bodies.iter().enumerate() {
            let mass = body.mass.as_ref().map_or(Dd::ZERO, dd);
            *inertia.at_mut(3 * i, 3 * i) = mass;
            *inertia.at_mut(3 * i + 1, 3 * i + 1) = mass;
            *inertia.at_mut(3 * i + 2, 3 * i + 2) = body.inertia.as_deref().map_or(Dd::ZERO, dd);
        }
        self.add_squares(&mut inertia, &self.inerters, poses);
        inertia
    }

    fn damping(&self, poses: &[Pose]) -> Matrix {
        let mut damping = Matrix::zero(3 * self.part_count(), 3 * self.part_count());
        self.add_squares(&mut damping, &self.dampers, poses);
        damping
    }

    /// Adds coefficient (grad s)(grad s)^T of each element.
    fn add_squares(&self, matrix: &mut Matrix, elements: &[(Dd, Quantity)], poses: &[Pose]) {
        for (coefficient, stretch) in elements {
            let gradient = self.differences.gradient(stretch, poses);
            for (i, a) in &gradient {
                for (j, b) in &gradient {
                    *matrix.at_mut(*i, *j) += *coefficient * *a * *b;
                }
            }
        }
    }

    /// b0, b1, b2: the work of loads, and minus stiffness, damping and inertia between the coordinates and a support.
    fn inputs(
        &self,
        poses: &[Pose],
        own: &Matrix,
        forces: &[Matrix; 3],
        supports: &[(usize, usize, Option<[Dd; 2]>)],
    ) -> [Matrix; 3] {
        let works: Vec<Quantity> = self.scene.inputs.iter().map(|input| self.work(&input.kind)).collect();
        let works: Vec<&Quantity> = works.iter().collect();
        let mut b = [0, 1, 2].map(|_| Matrix::zero(own.columns, works.len()));
        b[0] = self.gradients(poses, &works).times(own).transposed();
        for (column, (input, _, _)) in supports.iter().enumerate() {
            for order in 0..3 {
                for i in 0..own.columns {
                    *b[order].at_mut(i, *input) = -forces[order].at(i, column);
                }
            }
        }
        b
    }

    fn outputs(
        &self,
        poses: &[Pose],
        own: &Matrix,
        carried: &Matrix,
        supports: &[(usize, usize, Option<[Dd; 2]>)],
    ) -> ([Matrix; 3], [Matrix; 3]) {
        let outputs = &self.scene.outputs;
        let size = 3 * self.part_count();
        let mut rows = [0, 1, 2].map(|_| Matrix::zero(outputs.len(), size));
        for (row, output) in outputs.iter().enumerate() {
            for term in &output.terms {
                let (factor, order) = self.factor(term);
                for (variable, value) in self.differences.gradient(&self.motion(&term.motion), poses) {
                    *rows[order].at_mut(row, variable) += factor * value;
                }
            }
        }
        let through = rows.clone().map(|rows| {
            let driven = rows.times(carried);
            let mut d = Matrix::zero(outputs.len(), self.scene.inputs.len());
            for (column, (input, _, _)) in supports.iter().enumerate() {
                for row in 0..outputs.len() {
                    *d.at_mut(row, *input) = driven.at(row, column);
                }
            }
            d
        });
        (rows.map(|rows| rows.times(own)), through)
    }
}

fn support(body: usize) -> Holder {
    Holder::Support(BodyId(body as u32))
}

/// Reactions by the multipliers of all constraints at once, in absolute coordinates: nothing is eliminated and no joint is
/// released.
impl Formulation<'_> {
    /// The part that a reaction acts on, the point in which its force acts as drawn, and the place of its moment.
    fn acted(&self, holder: Holder) -> (Option<usize>, [Dd; 2], [Dd; 2]) {
        match holder {
            Holder::Joint(id) => {
                let joint = &self.scene.joints[id.index()];
                let place = joint.at.as_ref().or(joint.ends[0].at.as_deref()).or(joint.ends[1].at.as_deref());
                let place = place.map_or([Dd::ZERO; 2], planar);
                let acting = if joint.kind.keyword == "pivot" { place } else { [Dd::ZERO; 2] };
                (self.part(joint.ends[1].part), acting, place)
            }
            Holder::Support(body) => {
                let centre = self.centre(Some(body.index()));
                (Some(body.index()), centre, centre)
            }
            Holder::Couple(_) => (None, [Dd::ZERO; 2], [Dd::ZERO; 2]),
        }
    }

    /// A reaction of given multipliers in some poses: minus the multipliers times what the constraints hold.
    fn reaction_of(&self, reaction: &Reaction, multipliers: &[Dd], poses: &[Pose]) -> Dd {
        let (part, acting, place) = self.acted(reaction.holder);
        let (mut force, mut moment, mut sum) = ([Dd::ZERO; 2], Dd::ZERO, Dd::ZERO);
        for ((holder, holds), multiplier) in self.held.iter().zip(multipliers) {
            match holds {
                _ if *holder != reaction.holder => {}
                Holds::Along([x, y], carrier) => {
                    let turned = match carrier.map(|carrier| &poses[carrier]) {
                        Some(p) => [p.cos * *x - p.sin * *y, p.sin * *x + p.cos * *y],
                        None => [*x, *y],
                    };
                    force = [force[0] - *multiplier * turned[0], force[1] - *multiplier * turned[1]];
                }
                Holds::Turn => moment -= *multiplier,
                Holds::Sum => sum -= *multiplier,
            }
        }
        let centre = self.centre(part);
        let spot = |drawn: [Dd; 2]| Spot { part, drawn, arm: minus(drawn, centre) }.now(poses);
        let arm = minus(spot(acting), spot(place));
        match reaction.component {
            ReactionComponent::X => force[0],
            ReactionComponent::Y => force[1],
            ReactionComponent::Moment => moment + arm[0] * force[1] - arm[1] * force[0],
            ReactionComponent::Coupling => sum,
        }
    }

    /// Z(s) z + G^T l = f, G z = 0 for the motions and the multipliers under a unit of each input, at a real s.
    pub fn reactions(&self, chosen: &[Chosen], start: &[Dd], s: f64, reactions: &[Reaction]) -> Option<Vec<Reacted>> {
        let (poses, multipliers, _) = self.rest(self.posed(chosen, start)?)?;
        let (n, m, size) = (self.unknowns(), self.constraints.len(), 3 * self.part_count());
        let weighted: Vec<(Dd, &Quantity)> = (self.energies.iter().map(|e| (Dd::ONE, e)))
            .chain(multipliers.iter().copied().zip(&self.constraints))
            .collect();
        let (_, stiffness) = self.assembled(size, &poses, &weighted);
        let (damping, inertia) = (self.damping(&poses), self.inertia(&poses));
        let s = Dd::from(s);
        let impedance = |i: usize, j: usize| stiffness.at(i, j) + s * (damping.at(i, j) + s * inertia.at(i, j));
        let rows = self.gradients(&poses, &self.constraints.iter().collect::<Vec<_>>());
        let works: Vec<Quantity> = self.scene.inputs.iter().map(|input| self.work(&input.kind)).collect();
        let works = self.gradients(&poses, &works.iter().collect::<Vec<_>>());
        // The motions of supports, which are given.
        let mut given = Matrix::zero(size, self.scene.inputs.len());
        for (input, part, direction) in self.supports() {
            match direction {
                Some([x, y]) => (*given.at_mut(3 * part, input), *given.at_mut(3 * part + 1, input)) = (x, y),
                None => *given.at_mut(3 * part + 2, input) = Dd::ONE,
            }
        }
        let mut left = Matrix::zero(n + m, n + m);
        let mut right = Matrix::zero(n + m, self.scene.inputs.len());
        for i in 0..n {
            (0..n).for_each(|j| *left.at_mut(i, j) = impedance(i, j));
            for row in 0..m {
                *left.at_mut(i, n + row) = rows.at(row, i);
                *left.at_mut(n + row, i) = rows.at(row, i);
            }
        }
        for input in 0..self.scene.inputs.len() {
            for i in 0..n {
                let driven = (n..size).fold(Dd::ZERO, |sum, j| sum + impedance(i, j) * given.at(j, input));
                *right.at_mut(i, input) = works.at(input, i) - driven;
            }
            for row in 0..m {
                let driven = (n..size).fold(Dd::ZERO, |sum, j| sum + rows.at(row, j) * given.at(j, input));
                *right.at_mut(n + row, input) = -driven;
            }
        }
        let solved = solve(left, right)?;
        let every: Vec<Option<usize>> = (0..self.part_count()).map(Some).collect();
        let reacted = |reaction: &Reaction| {
            let at = |multipliers: &[Dd], poses: &[Pose]| self.reaction_of(reaction, multipliers, poses);
            let quantity = Quantity::new(every.iter().copied(), |poses: &[Pose]| at(&multipliers, poses));
            let turning = self.differences.gradient(&quantity, &poses);
            let gain = |input: usize| {
                let change: Vec<Dd> = (0..m).map(|row| solved.at(n + row, input)).collect();
                let moved = |j: usize| if j < n { solved.at(j, input) } else { given.at(j, input) };
                turning.iter().fold(at(&change, &poses), |sum, (j, slope)| sum + *slope * moved(*j))
            };
            Reacted { at_rest: at(&multipliers, &poses), gains: (0..self.scene.inputs.len()).map(gain).collect() }
        };
        Some(reactions.iter().map(reacted).collect())
    }

    /// Puts the last constraints first: of several that hold the same, others are kept then.
    pub fn reversed(scene: &Scene) -> Formulation<'_> {
        let mut it = Formulation::bare(scene);
        it.constraints.reverse();
        it.held.reverse();
        it.completed()
    }
}

/// Columns `from..to`.
fn columns(matrix: &Matrix, from: usize, to: usize) -> Matrix {
    let mut part = Matrix::zero(matrix.rows, to - from);
    for i in 0..matrix.rows {
        for j in from..to {
            *part.at_mut(i, j - from) = matrix.at(i, j);
        }
    }
    part
}

fn norm(row: &[Dd]) -> Dd {
    row.iter().fold(Dd::ZERO, |sum, a| sum + *a * *a).sqrt()
}

/// The angle of a direction: that of binary64, and what is left of it.
fn angle_of([x, y]: [Dd; 2]) -> Dd {
    let near = Dd::from(y.hi.atan2(x.hi));
    let (sine, cosine) = sin_cos(near);
    near + (y * cosine - x * sine) / (x * cosine + y * sine)
}

fn angle(poses: &[Pose], part: Option<usize>) -> Dd {
    part.map_or(Dd::ZERO, |i| poses[i].angle)
}
