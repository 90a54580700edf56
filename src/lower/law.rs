//! The laws of springs at rest and during the search for it. In: a spring and its stretch. Out: an error if the law has
//! no value or no tangent there; otherwise its tangent, for the motions about the rest. See docs/method/rest.md#laws.

use super::error::LowerError;
use super::kinematics::{Kinematics, PathEvaluation, State};
use super::loads;
use super::mechanism::Mechanism;
use super::rest::survey::Part;
use crate::base::{Ball, Number, up};
use crate::elements::curve::Undefined;
use crate::elements::{Curve, Response, Scalar, Spring, Stretched};
use crate::model::scene::{Element, ElementId, Geometry, Scene};
use crate::system::Label;
use std::sync::Arc;

/// A law that is not defined at rest, or has a kink there.
pub fn fault(scene: &Scene, element: &Element, spring: &Spring<Number>, at: &Stretched<Number>) -> Option<LowerError> {
    let Response::Curve { curve, offset } = &spring.response else { return None };
    let stretch = offset + at.change();
    match curve.at(&stretch) {
        Err(undefined) => Some(not_defined(scene, element, undefined, stretch.to_f64())),
        Ok(_) => curve.kink(&stretch).map(|span| LowerError::LawKink {
            span,
            element: scene.words.display(element.name),
            stretch: stretch.to_f64(),
            turns: element.law.geometry == Geometry::Torsion,
        }),
    }
}

fn not_defined(scene: &Scene, element: &Element, undefined: Undefined, stretch: f64) -> LowerError {
    LowerError::LawUndefined {
        span: undefined.span,
        why: undefined.why,
        element: scene.words.display(element.name),
        stretch,
        turns: element.law.geometry == Geometry::Torsion,
    }
}

/// A law of a spring or damper at rest.
#[derive(Clone, Debug)]
pub struct LawAtRest {
    pub element: ElementId,
    pub name: Label,
    pub curve: Arc<Curve>,
    /// m, rad or their rates.
    pub at: Number,
    /// N or N m.
    pub force: Number,
    /// The tangent.
    pub slope: Number,
    turns: bool,
    of_rate: bool,
}

/// An interval of distances from the rest, with a difference between law and tangent that occurs in it and an upper
/// bound of that difference.
#[derive(Clone, Copy)]
struct Cell {
    low: f64,
    high: f64,
    reached: f64,
    bound: f64,
}

impl LawAtRest {
    /// Whether a force over the stretch has the tangent zero here.
    pub fn is_flat(&self) -> bool {
        !self.of_rate && self.slope.is_zero()
    }

    /// Whether the law is a function of a rate.
    pub fn is_of_rate(&self) -> bool {
        self.of_rate
    }

    /// The word for the law's variable, and its unit.
    pub fn variable(&self) -> (&'static str, &'static str) {
        match (self.of_rate, self.turns) {
            (false, false) => ("stretch", "m"),
            (false, true) => ("stretch", "rad"),
            (true, false) => ("rate", "m/s"),
            (true, true) => ("rate", "rad/s"),
        }
    }

    pub fn force_unit(&self) -> &'static str {
        if self.turns { "N*m" } else { "N" }
    }

    pub fn slope_unit(&self) -> &'static str {
        match (self.of_rate, self.turns) {
            (false, false) => "N/m",
            (false, true) => "N*m/rad",
            (true, false) => "N*s/m",
            (true, true) => "N*m*s/rad",
        }
    }

    /// An upper bound of the difference between the law and its tangent, up to the distance `size` on either side of
    /// the rest. Computed by enclosures over intervals: the interval with the largest bound is halved until that bound
    /// is close to a difference that occurs. `None` if the law may have no value somewhere.
    pub fn difference(&self, size: f64) -> Option<f64> {
        const MOST: usize = 1_000;
        const NEAR: f64 = 1.01;
        let mut cells = vec![self.over(-size, 0.0), self.over(0.0, size)];
        let mut reached: f64 = 0.0;
        for _ in 0..MOST {
            let widest = (0..cells.len()).max_by(|&a, &b| cells[a].bound.total_cmp(&cells[b].bound))?;
            let Cell { low, high, reached: here, bound } = cells[widest];
            reached = reached.max(here);
            let middle = 0.5 * (low + high);
            if bound <= NEAR * reached || !(low < middle && middle < high) {
                break;
            }
            cells[widest] = self.over(low, middle);
            cells.push(self.over(middle, high));
        }
        let bound = cells.iter().map(|cell| cell.bound).fold(0.0, f64::max);
        bound.is_finite().then_some(bound)
    }

    /// The difference over an interval of distances from the rest: by the mean value form about the middle, or
    /// directly.
    fn over(&self, low: f64, high: f64) -> Cell {
        let middle = 0.5 * (low + high);
        let half = 0.5 * (high - low) * up::FEW + middle.abs() * f64::EPSILON;
        let from_tangent = |away: &Number| {
            let law = self.curve.value(&(&self.at + away)).ok()?;
            Some((&law - &(&self.force + &(&self.slope * away))).to_ball())
        };
        let wide = Ball::from(middle).widen(half);
        let turned = self.curve.at(&(&self.at + &Number::Ball(wide))).map(|dual| (&dual.slope - &self.slope).to_ball());
        let here = from_tangent(&Number::Ball(Ball::from(middle)));
        let by_slope =
            here.zip(turned.ok()).map(|(here, turned)| (here.magnitude() + turned.magnitude() * half) * up::FEW);
        let plain = from_tangent(&Number::Ball(wide)).map(|ball| ball.magnitude());
        let bound =
            [by_slope, plain].into_iter().flatten().filter(|bound| !bound.is_nan()).fold(f64::INFINITY, f64::min);
        let reached = here.map_or(0.0, |ball| ball.mignitude());
        Cell { low, high, reached, bound }
    }
}

impl Mechanism {
    /// Every law of the scene that this was lowered from, in order of declaration.
    pub fn laws_at_rest(&self, scene: &Scene) -> Vec<LawAtRest> {
        let (mut between, mut reach) = (loads::EndPath::default(), PathEvaluation::default());
        let mut list = Vec::new();
        for (index, element) in (0..).zip(&scene.elements) {
            let (Some(curve), id) = (&element.law.curve, ElementId(index)) else { continue };
            let turns = element.law.geometry == Geometry::Torsion;
            let (mut at, mut force, mut slope) = (Number::ZERO, Number::ZERO, element.law.coefficient.clone());
            let of_rate = !element.law.kind.is_elastic();
            if !of_rate {
                let spring = loads::spring(&self.kinematics, &element.ends, &element.law, &mut between);
                reach.measure(&self.kinematics, &self.state, &between.path);
                let stretched = spring.stretch.at(&reach.displacement, &between.turn(&self.state));
                let Response::Curve { offset, .. } = &spring.response else { continue };
                (at, force, slope) =
                    (offset + stretched.change(), spring.tension(&stretched), spring.stiffness(&stretched));
            }
            let name = Label { name: element.name, motion: "" };
            list.push(LawAtRest { element: id, name, curve: curve.clone(), at, force, slope, turns, of_rate });
        }
        list
    }
}

/// An error for each law that is not defined as drawn, where the search for the rest begins.
pub fn as_drawn(scene: &Scene, kinematics: &Kinematics, state: &State<Number>) -> Vec<LowerError> {
    let (mut between, mut reach) = (loads::EndPath::default(), PathEvaluation::default());
    let mut faults = Vec::new();
    for element in scene.elements.iter().filter(|element| element.law.kind.is_elastic()) {
        let Some(curve) = &element.law.curve else { continue };
        let spring = loads::spring(kinematics, &element.ends, &element.law, &mut between);
        reach.measure(kinematics, state, &between.path);
        let stretched = spring.stretch.at(&reach.displacement, &between.turn(state));
        let Response::Curve { offset, .. } = &spring.response else { continue };
        let stretch = offset + stretched.change();
        // A slope that has no limit does not matter before the rest.
        if let Err(undefined) = curve.value(&stretch) {
            faults.push(not_defined(scene, element, undefined, stretch.to_f64()));
        }
    }
    faults
}

/// Distance beyond the place where a search stopped at which a law is tried, relative to its stretch and the part's
/// length.
const BEYOND: f64 = 1e-9;

/// The error for the law that stopped a search for the rest: it is not defined next to the place where the search
/// ended.
pub fn undefined_law(scene: &Scene, kinematics: &Kinematics, part: &Part, state: &State<f64>) -> Option<LowerError> {
    let mut reach = PathEvaluation::default();
    for (spring, between) in &part.potential.convert::<f64>().springs {
        let Response::Curve { curve, offset } = &spring.response else { continue };
        reach.measure(kinematics, state, &between.path);
        let stretched = spring.stretch.at(&reach.displacement, &between.turn(state));
        let stretch = offset + stretched.change();
        let step = BEYOND * (stretch.abs() + part.length());
        for there in [stretch, stretch - step, stretch + step] {
            if let Err(undefined) = curve.value(&there.number()) {
                return Some(not_defined(scene, owner(scene, curve)?, undefined, stretch));
            }
        }
    }
    None
}

/// The element that a law belongs to; the first of those that share it.
fn owner<'a>(scene: &'a Scene, curve: &Arc<Curve>) -> Option<&'a Element> {
    let is_its = |element: &&Element| element.law.curve.as_ref().is_some_and(|own| Arc::ptr_eq(own, curve));
    scene.elements.iter().find(is_its)
}
