//! The static rest: the equilibrium of the scene. See docs/method/rest.md.
//!
//! # Steps
//! 1. the forces as drawn, exactly: if they are all zero, the drawing is the rest
//! 2. [`survey`]: which coordinates are coupled and loaded
//! 3. [`newton`]: the descent to a minimum of the energy of each such part
//! 4. [`enclosure`]: refinement and proof
//! 5. [`linear`]: large parts whose energy is quadratic, from the assembled terms

mod constrained;
pub mod convex;
pub mod definite;
pub mod drawn;
pub mod enclosure;
pub mod exact;
mod krawczyk;
pub mod linear;
pub mod newton;
pub mod potential;
pub mod proof;
mod reactions;
mod refinement;
mod slack;
pub mod survey;
mod trust;

use super::constraints::equation::Equation;
use super::constraints::{Constraints, Reduction};
use super::error::{LowerError, NoRestReason, Unbalanced};
use super::kinematics::{Index, Kinematics, State};
use super::law::LawAtRest;
use super::{assembly, law, loads};
use crate::base::number::jet;
use crate::base::{Ball, Number, OrderBy};
use crate::elements::Scalar;
use crate::model::scene::{Attachment, BodyId, ElementId, Part as ScenePart, Scene};
use crate::system::{Coordinate, Label, LinearSystem};
pub use drawn::Held;
use enclosure::{MAX_DENSE, Refined};
use newton::{Descent, DescentResult};
pub use proof::{Proven, Reached};
use refinement::Refinement;
pub use slack::Slack;
use survey::{Part, Survey};

/// The rest that lowering found, measured from the drawing.
#[derive(Clone, Debug)]
pub struct Rest {
    /// Displacement of each coordinate from the drawing, m or rad, in the order of the system's coordinates. An
    /// enclosure: the true rest lies in these balls (exact zeros if the drawing is the rest).
    pub displacement: Vec<Number>,
    /// The coordinates that depend on those of the system through joints and couplings.
    pub dependent: Vec<Dependent>,
    /// Largest unbalanced generalised force, relative to the largest that acts in its part; exactly 0 if the rest is
    /// known exactly.
    pub residual: f64,
    /// The proof that the rest is in its enclosure; `None` if there is none (see docs/method/rest.md).
    pub proven: Option<Proven>,
    /// The proof that the search from the drawing ends here for all values of parameters that are ranges.
    pub reached: Option<Reached>,
    /// Whether terms of the system depend on the position of the rest: some loaded part is not linear, or tensions were
    /// found that hold the drawing. Relative changes of the model's numbers may cause larger relative changes of these
    /// terms.
    pub moves_terms: bool,
    /// Number of Newton steps; 0 if the drawing is the rest.
    pub steps: u32,
    /// The springs whose tension `rest as drawn` found, in order of declaration.
    pub tensions: Vec<Tension>,
    /// The elements with laws, and their tangents, in order of declaration.
    pub laws: Vec<LawAtRest>,
}

/// A tension that holds the drawing.
#[derive(Clone, Debug)]
pub struct Tension {
    pub element: ElementId,
    /// The name of that element.
    pub spring: Label,
    /// N, pull is positive; for a torsion spring, the torque in N m.
    pub tension: Number,
    pub turns: bool,
}

/// A coordinate that depends on others, and its position at rest, measured from the drawing.
#[derive(Clone, Debug)]
pub struct Dependent {
    pub coordinate: Coordinate,
    pub displacement: Number,
}

/// A rest whose large linear parts have not been solved yet.
#[derive(Clone, Debug)]
pub struct PartialRest {
    rest: Rest,
    /// All coordinates at rest. Those of large linear parts are as drawn, since no term depends on them.
    pub state: State<Number>,
    survey: Option<Survey>,
    /// The tensions that hold the drawing, if it is declared to be the rest.
    pub held: Option<Held>,
    /// The parts in which no spring has any tension.
    pub slack: Slack,
}

/// The rest of a scene.
pub fn find(scene: &Scene, kinematics: &Kinematics, constraints: &Constraints) -> Result<PartialRest, Vec<LowerError>> {
    let state = loads::state_as_drawn(scene, kinematics);
    let mut found =
        PartialRest { rest: Rest::without_loads(), state, survey: None, held: None, slack: Slack::default() };
    if scene.rest_as_drawn.is_some() {
        return found.hold_drawing(scene, kinematics, constraints);
    }
    if !is_loaded(scene) {
        return Ok(found);
    }
    let undefined = law::as_drawn(scene, kinematics, &found.state);
    if !undefined.is_empty() {
        return Err(undefined);
    }
    let drawn = constraints.reduction(scene, kinematics, &found.state)?;
    if !found.state.is_drawn() && constraints.are_linear() {
        drawn.follow(kinematics, &mut found.state);
    }
    let forces = survey::forces(scene, kinematics, &found.state, found.state.is_drawn());
    let left = if drawn.is_trivial() { forces } else { drawn.left_of(&forces) };
    if Proven::prove_balance(&left).is_some() && constraints.hold_exactly(kinematics, &found.state) {
        return Ok(found);
    }
    let forces = left;
    let mut survey = survey::survey(scene, kinematics, constraints, &found.state, forces);
    found.search(scene, kinematics, constraints, &mut survey)?;
    found.rest.moves_terms = survey.parts.iter().any(|part| !part.linear);
    found.survey = Some(survey);
    Ok(found)
}

/// Limit on the coordinates of a part with closed loops: dense matrices of this size take seconds.
const MAX_ALONG: usize = 2000;

/// Whether anything could act as a load on the drawing.
fn is_loaded(scene: &Scene) -> bool {
    !scene.gravity.is_zero()
        || scene.elements.iter().any(|element| element.law.may_be_loaded())
        || scene.inputs.iter().any(|input| loads::constant(input).is_some())
}

impl PartialRest {
    /// The drawing is declared to be the rest: only the tensions that hold it are searched for.
    fn hold_drawing(
        mut self,
        scene: &Scene,
        kinematics: &Kinematics,
        constraints: &Constraints,
    ) -> Result<PartialRest, Vec<LowerError>> {
        let reduction = constraints.reduction(scene, kinematics, &self.state)?;
        if !constraints.hold_exactly(kinematics, &self.state) {
            let all: Vec<u32> = (0..constraints.list.len() as u32).collect();
            return Err(vec![constraints.open(scene, kinematics, &all)]);
        }
        let held = drawn::hold(scene, kinematics, &reduction, &self.state)?;
        (self.rest.residual, self.rest.proven) = (held.residual, held.proven);
        self.rest.tensions.clone_from(&held.tensions);
        self.rest.moves_terms = self.rest.tensions.iter().any(|found| !found.tension.is_zero());
        self.held = Some(held);
        Ok(self)
    }

    /// Searches for the rest of every part except the large linear ones.
    fn search(
        &mut self,
        scene: &Scene,
        kinematics: &Kinematics,
        constraints: &Constraints,
        survey: &mut Survey,
    ) -> Result<(), Vec<LowerError>> {
        let mut steering: State<f64> = jet::in_the_middle(|| self.state.convert(kinematics));
        // Bases that a parameter displaces act on all parts.
        let is_displaced = self.state.is_ranged();
        let mut lost = Vec::new();
        let Survey { parts, local, forces } = survey;
        for part in parts.iter().filter(|part| !part.is_large_and_linear()) {
            if !part.constraints.is_empty() {
                if let Err(error) =
                    self.search_along(scene, kinematics, constraints, part, local, (&mut steering, is_displaced))
                {
                    lost.push(error);
                }
                continue;
            }
            let descended = jet::in_the_middle(|| {
                let drawn = part.coordinates.iter().map(|i| forces[*i as usize].to_f64()).collect();
                descend(kinematics, part, local, drawn, &mut steering)
            });
            if !descended.settled {
                let stopped = law::undefined_law(scene, kinematics, part, &steering);
                lost.push(stopped.unwrap_or_else(|| no_rest(scene, kinematics, part, &descended)));
                continue;
            }
            let values: Vec<f64> = part.coordinates.iter().map(|i| *steering.value(*i)).collect();
            let length = jet::in_the_middle(|| part.length());
            let refinement = Refinement::new(kinematics, part, length, &mut self.state);
            let mut refined = refinement.run(local, &values);
            if refined.proven.is_none()
                && let Some(proven) = slack::prove(kinematics, part, local, &values, &mut self.state)
            {
                refined = Refined { residual: 0.0, proven: Some(proven), reached: None };
                self.slack.add(kinematics, part);
            }
            self.rest.steps += descended.steps;
            self.rest.residual = self.rest.residual.max(refined.residual);
            self.rest.proven = Proven::and(self.rest.proven, refined.proven);
            let reached = match part.linear {
                true => Reached::of_linear(refined.proven),
                false if !is_displaced && !part.potential.is_ranged() => Some(Reached::by_one_search()),
                false => refined.reached,
            };
            self.rest.reached = Reached::and(self.rest.reached, reached);
        }
        if lost.is_empty() { Ok(()) } else { Err(lost) }
    }

    /// Searches for the rest of a part with constraints. `is_displaced`: a parameter that is a range displaces a base.
    fn search_along(
        &mut self,
        scene: &Scene,
        kinematics: &Kinematics,
        constraints: &Constraints,
        part: &Part,
        local: &[u32],
        (steering, is_displaced): (&mut State<f64>, bool),
    ) -> Result<(), LowerError> {
        if part.coordinates.len() > MAX_ALONG {
            let source = constraints.list[part.constraints[0] as usize].source;
            return Err(LowerError::LargeLoop { coordinates: part.coordinates.len(), span: source.span(scene) });
        }
        let equations = || part.constraints.iter().map(|number| &constraints.list[*number as usize].equation);
        let coordinates = &part.coordinates[..];
        let length = part.length().max(constraints.length);
        let descent = constrained::Descent {
            kinematics,
            coordinates,
            local,
            potential: part.potential.convert(),
            equations: equations().map(Equation::convert).collect(),
            length,
            state: &mut *steering,
        };
        let descended = match descent.run(part.unbalanced) {
            constrained::ConstrainedResult::Open => return Err(constraints.open(scene, kinematics, &part.constraints)),
            constrained::ConstrainedResult::Settled(descended) if !descended.settled => {
                let stopped = law::undefined_law(scene, kinematics, part, steering);
                return Err(stopped.unwrap_or_else(|| no_rest(scene, kinematics, part, &descended)));
            }
            constrained::ConstrainedResult::Settled(descended) => descended,
        };
        let values: Vec<f64> = coordinates.iter().map(|i| *steering.value(*i)).collect();
        let is_ranged = is_displaced
            || part.potential.is_ranged()
            || jet::without_division(|| equations().map(Equation::convert::<f64>).count()).is_none();
        let (potential, equations) = (&part.potential, equations().collect());
        let state = &mut self.state;
        let multipliers = Vec::new();
        let balance =
            reactions::Balance { kinematics, coordinates, local, potential, equations, state, multipliers, length };
        let refined = balance.run(&values);
        self.rest.steps += descended.steps;
        self.rest.residual = self.rest.residual.max(refined.residual);
        self.rest.proven = Proven::and(self.rest.proven, refined.proven);
        let reached = if is_ranged { refined.reached } else { Some(Reached::by_one_search()) };
        self.rest.reached = Reached::and(self.rest.reached, reached);
        Ok(())
    }

    /// Whether it is proven as it is: no part is left to be solved with the assembled stiffness.
    pub fn is_complete(&self) -> bool {
        self.survey.is_none() && self.rest.is_proven()
    }

    /// The rest without the displacements of its coordinates, and their state.
    pub fn as_found(self) -> (Rest, State<Number>) {
        (self.rest, self.state)
    }

    /// The rest of all coordinates, and their full state; large linear parts are solved with the assembled stiffness.
    pub fn finish(
        self,
        scene: &Scene,
        kinematics: &Kinematics,
        reduction: &Reduction,
        system: &LinearSystem,
    ) -> Result<(Rest, State<Number>), Vec<LowerError>> {
        let PartialRest { mut rest, mut state, survey, .. } = self;
        let moved = |coordinate: Index| to_metres(kinematics, coordinate, state.value(coordinate));
        rest.displacement = (0..reduction.n()).map(|place| moved(reduction.at(place))).collect();
        rest.dependent = reduction
            .dependent()
            .map(|i| Dependent { coordinate: assembly::coordinate(scene, kinematics, i), displacement: moved(i) })
            .collect();
        let Some(survey) = survey else { return Ok((rest, state)) };
        let large: Vec<&Part> = survey.parts.iter().filter(|part| part.is_large_and_linear()).collect();
        for solved in linear::solve(kinematics, reduction, system, &survey, &large) {
            let solved = solved.map_err(|left| vec![falls_error(scene, kinematics, &left)])?;
            for (coordinate, value) in solved.displacement {
                if let Some(place) = reduction.place(coordinate) {
                    state.set(kinematics, coordinate, to_coordinate_units(kinematics, coordinate, &value));
                    rest.displacement[place.index()] = value;
                }
            }
            rest.steps += 1;
            rest.residual = rest.residual.max(solved.residual);
            rest.proven = Proven::and(rest.proven, solved.proven);
        }
        let held = large.iter().filter(|part| !part.constraints.is_empty()).flat_map(|part| &part.coordinates);
        rest.place_dependent(kinematics, reduction, &mut state, held.copied());
        Ok((rest, state))
    }
}

impl Rest {
    /// Whether a law of `stretch` has the tangent zero here.
    pub fn has_flat_law(&self) -> bool {
        self.laws.iter().any(LawAtRest::is_flat)
    }

    /// The rest of a scene without loads: its drawing.
    pub fn without_loads() -> Rest {
        Rest {
            displacement: Vec::new(),
            dependent: Vec::new(),
            residual: 0.0,
            proven: Proven::prove_balance(&[]),
            reached: Some(Reached::as_drawn()),
            moves_terms: false,
            steps: 0,
            tensions: Vec::new(),
            laws: Vec::new(),
        }
    }

    /// Whether it is proven that the rest is in its enclosure.
    pub fn is_proven(&self) -> bool {
        self.proven.is_some()
    }

    /// Whether it moves with a parameter that is a range.
    pub fn is_ranged(&self) -> bool {
        self.displacement.iter().any(Number::is_range)
    }

    /// Whether terms depend on a rest that is looked for among forces that a parameter which is a range has a part in, and the search might
    /// find another one at some of its values.
    pub fn may_be_elsewhere(&self) -> bool {
        self.moves_terms && self.reached.is_none()
    }

    /// Whether a rest that was found for some values in the ranges of this one is this one there. It is so then for all of them: in each
    /// enclosure there is exactly one, which depends continuously on the values.
    pub fn holds(&self, found: &Rest) -> bool {
        let is_inside = |inner: &Rest, outer: &Rest| {
            let inside = |(inner, outer): (&Number, &Number)| {
                let (inner, outer) = (inner.enclosure(), outer.enclosure());
                (Ball::exact(outer.mid) - Ball::exact(inner.mid)).magnitude() + inner.rad <= outer.rad
            };
            inner.displacement.iter().zip(&outer.displacement).all(inside)
        };
        let is_alike = self.displacement.len() == found.displacement.len() && found.is_proven();
        !self.is_ranged() || is_alike && (is_inside(found, self) || is_inside(self, found))
    }

    /// Moves the dependent coordinates of linear parts to where the independent ones and the bases put them.
    fn place_dependent(
        &mut self,
        kinematics: &Kinematics,
        reduction: &Reduction,
        state: &mut State<Number>,
        coordinates: impl Iterator<Item = Index>,
    ) {
        for coordinate in coordinates {
            let Some((number, row)) = reduction.equation(coordinate) else { continue };
            let value = |(i, entry): &(Index, Number)| match reduction.place(*i) {
                Some(place) => entry * &to_coordinate_units(kinematics, *i, &self.displacement[place.index()]),
                None => entry * state.value(*i),
            };
            let sum = row.iter().map(value).fold(Number::ZERO, |sum, value| &sum - &value);
            self.dependent[number].displacement = to_metres(kinematics, coordinate, &sum);
            state.set(kinematics, coordinate, sum);
        }
    }
}

impl Part {
    pub fn is_large_and_linear(&self) -> bool {
        self.linear && self.coordinates.len() > MAX_DENSE
    }
}

/// A value of a coordinate in metres or radians.
fn to_metres(kinematics: &Kinematics, coordinate: Index, value: &Number) -> Number {
    match kinematics.length_squared(coordinate) {
        Some(length_squared) if !value.is_zero() => value * &length_squared.root(),
        _ => value.clone(),
    }
}

/// A value of a coordinate in units of its direction's length.
fn to_coordinate_units(kinematics: &Kinematics, coordinate: Index, value: &Number) -> Number {
    match kinematics.length_squared(coordinate) {
        Some(length_squared) if !value.is_zero() => value / &length_squared.root(),
        _ => value.clone(),
    }
}

/// The descent from the drawing; the part stays as drawn if no force is certainly unbalanced.
fn descend(
    kinematics: &Kinematics,
    part: &Part,
    local: &[u32],
    drawn: Vec<f64>,
    state: &mut State<f64>,
) -> DescentResult {
    let potential = part.potential.convert();
    let length = part.length();
    let (coordinates, linear) = (&part.coordinates[..], part.linear);
    let descent = Descent { kinematics, coordinates, local, potential, state, drawn, length, linear };
    if part.unbalanced { descent.run() } else { descent.remain_as_drawn() }
}

fn no_rest(scene: &Scene, kinematics: &Kinematics, part: &Part, descended: &DescentResult) -> LowerError {
    let energy = &descended.energy;
    let relative = |place: usize| energy.gradient[place].abs() / energy.forces[place].max(f64::MIN_POSITIVE);
    // Forces that remain unbalanced after many steps are far above their rounding errors.
    let mut places: Vec<usize> = (0..energy.gradient.len()).filter(|&place| relative(place) > 1e-9).collect();
    places.order_by(|&a, &b| relative(b).total_cmp(&relative(a)).then(a.cmp(&b)));
    let left: Vec<(Index, f64)> =
        places.iter().map(|&place| (part.coordinates[place], -energy.gradient[place])).collect();
    // No force acts in the opposite direction: it falls.
    let falling: Vec<(Index, f64)> =
        places.iter().zip(&left).filter(|(place, _)| relative(**place) > 0.99).map(|(_, left)| *left).collect();
    if falling.is_empty() {
        return unbalanced_error(scene, kinematics, &left, NoRestReason::NotSettled);
    }
    falls_error(scene, kinematics, &falling)
}

fn falls_error(scene: &Scene, kinematics: &Kinematics, left: &[(Index, f64)]) -> LowerError {
    unbalanced_error(scene, kinematics, left, NoRestReason::Falls)
}

fn unbalanced_error(scene: &Scene, kinematics: &Kinematics, left: &[(Index, f64)], reason: NoRestReason) -> LowerError {
    let named = |(coordinate, force): &(Index, f64)| {
        let body = &scene.bodies[kinematics.free[*coordinate as usize].index()];
        Unbalanced {
            coordinate: format!("{}.{}", scene.words.display(body.name), kinematics.motion(scene, *coordinate)),
            span: body.span,
            force: *force,
            turns: kinematics.is_angle(*coordinate),
        }
    };
    let laws = laws_on(scene, kinematics, left);
    LowerError::NoRest { span: scene.bodies[0].span, left: left.iter().map(named).collect(), reason, laws }
}

/// The springs with laws on the bodies of some coordinates; none if another spring acts on one of these, too.
fn laws_on(scene: &Scene, kinematics: &Kinematics, left: &[(Index, f64)]) -> Vec<String> {
    let bodies: Vec<BodyId> = left.iter().map(|(coordinate, _)| kinematics.free[*coordinate as usize]).collect();
    let is_on = |attachment: &Attachment| matches!(attachment.part, ScenePart::Body(body) if bodies.contains(&body));
    let springs =
        scene.elements.iter().filter(|element| element.law.kind.is_elastic() && element.ends.iter().any(is_on));
    let names = springs.map(|spring| spring.law.curve.is_some().then(|| scene.words.display(spring.name)));
    names.collect::<Option<Vec<String>>>().unwrap_or_default()
}
