//! The constraints of a scene: joints that close loops, and couplings. In: scene and kinematics. Out: equations g(q) =
//! 0 that are independent in the drawing, and a classification of the dependent ones. See
//! docs/method/kinematics.md#constraints and docs/method/kinematics.md#dependent-constraints.
//!
//! # Steps
//! 1. [`equation`]: joints and couplings as scalar equations
//! 2. [`elimination`]: which coordinates depend on which
//! 3. [`rank`]: the consequences of equations that depend on each other
//! 4. [`elsewhere`]: whether those that follow from others as drawn do so in other positions
//! 5. [`reduction`]: rows over all coordinates become rows over the independent ones

mod closures;
pub mod elimination;
mod elsewhere;
pub mod equation;
mod rank;
pub mod reduction;

pub use elsewhere::Elsewhere;
pub use rank::Why;
pub use reduction::Reduction;

use super::error::LowerError;
use super::kinematics::{Index, Kinematics, PathEvaluation, Released, State, Unreleased};
use crate::base::{Diagnostic, Name, Number, Span};
use crate::model::scene::{Holder, JointId, Reaction, Scene};
use elimination::Elimination;
use equation::Equation;
use std::collections::BTreeSet;

/// A violation of a constraint up to this many lengths of its loop counts as rounding, where a state is not known exactly.
const NOTHING: f64 = 1e-10;

/// The item that an equation comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Source {
    Joint(JointId),
    /// Index into the scene's couplings.
    Couple(u32),
}

/// An equation and its source.
#[derive(Clone, Debug)]
pub struct Constraint {
    pub source: Source,
    /// The number of this equation among those of its source: 0 and 1 for displacements, 2 for angles.
    pub part: u8,
    pub equation: Equation<Number>,
}

/// The independent constraints of a scene; none in a scene that is a tree.
#[derive(Clone, Debug, Default)]
pub struct Constraints {
    pub list: Vec<Constraint>,
    /// Equations that follow from the others.
    pub redundant: Vec<Constraint>,
    /// The longest arm of a loop or a coupling, m, used as the unit of length; 1 m if nothing turns.
    pub length: f64,
}

/// The constraints of a scene, with notes on redundant ones.
pub fn build(scene: &Scene, kinematics: &Kinematics) -> Result<(Constraints, Vec<Diagnostic>), Vec<LowerError>> {
    let list = closures::constraint_equations(scene, kinematics);
    if list.is_empty() {
        return Ok((Constraints::default(), Vec::new()));
    }
    let longest = list.iter().map(|constraint| constraint.equation.length()).fold(0.0, f64::max);
    let length = if longest > 0.0 { longest } else { 1.0 };
    let all = Constraints { list, redundant: Vec::new(), length };
    rank::classify(scene, kinematics, all)
}

impl Source {
    pub fn name(self, scene: &Scene) -> Name {
        match self {
            Source::Joint(joint) => scene.joints[joint.index()].name,
            Source::Couple(couple) => scene.couples[couple as usize].name,
        }
    }

    pub fn span(self, scene: &Scene) -> Span {
        match self {
            Source::Joint(joint) => scene.joints[joint.index()].span,
            Source::Couple(couple) => scene.couples[couple as usize].span,
        }
    }
}

impl Constraint {
    /// The gradient over coordinates that follow no others.
    fn row(
        &self,
        kinematics: &Kinematics,
        state: &State<Number>,
        reach: &mut PathEvaluation<Number>,
    ) -> elimination::Row {
        let (_, mut row) = self.equation.measure(kinematics, state, reach);
        kinematics.unfold(&mut row);
        row
    }
}

impl Constraints {
    /// The constraints together with those of released motions. An error if one of these motions follows from the others:
    /// then several joints hold the same parts, and the load on each of them is not determined.
    pub fn with_released(
        &self,
        scene: &Scene,
        released: &Released,
        (reactions, reduction): (&[Reaction], &Reduction),
        state: &State<Number>,
    ) -> Result<(Constraints, Reduction), (usize, Unreleased)> {
        let kinematics = &released.kinematics;
        let mut all = closures::constraint_equations(scene, kinematics);
        for (number, reaction) in reactions.iter().enumerate().filter(|(number, _)| released.in_equation[*number]) {
            let source = match reaction.holder {
                Holder::Joint(joint) => Source::Joint(joint),
                Holder::Couple(couple) => Source::Couple(couple),
                Holder::Support(_) => continue,
            };
            let mut is_held = false;
            for constraint in all.iter_mut().filter(|constraint| constraint.source == source) {
                is_held |= constraint.release(reaction.component, released.coordinate(number));
            }
            if !is_held {
                return Err((number, Unreleased::Redundant));
            }
        }
        let kept: BTreeSet<(Source, u8)> = self.list.iter().map(|own| (own.source, own.part)).collect();
        let (list, redundant): (Vec<_>, Vec<_>) =
            all.into_iter().partition(|constraint| kept.contains(&(constraint.source, constraint.part)));
        let all = Constraints { list, redundant, length: self.length };
        let new = match all.is_empty() {
            true => Reduction::identity(kinematics.n()),
            false => {
                let elimination = all.eliminate(scene, kinematics, state);
                let elimination =
                    elimination.map_err(|mut errors| (0, Unreleased::Limit(Box::new(errors.remove(0)))))?;
                Reduction::new(kinematics.n(), elimination)
            }
        };
        if !new.dependent().eq(reduction.dependent()) {
            return Err((0, Unreleased::Unclear));
        }
        match all.left_open(scene, released)? {
            Some(number) => Err((number, Unreleased::Redundant)),
            None => Ok((all, new)),
        }
    }

    /// A released motion that a redundant constraint depends on in some state, even if not at rest: the rest may hold any
    /// share of its force, which turns as the parts move.
    fn left_open(&self, scene: &Scene, released: &Released) -> Result<Option<usize>, (usize, Unreleased)> {
        if self.redundant.is_empty() {
            return Ok(None);
        }
        let (kinematics, state) = (&released.kinematics, &released.generic());
        let elimination = self.eliminate(scene, kinematics, state);
        let elimination = elimination.map_err(|mut errors| (0, Unreleased::Limit(Box::new(errors.remove(0)))))?;
        let number = |(coordinate, _): &(Index, Number)| released.number(*coordinate);
        let among_left = elimination.left.iter().flat_map(|left| &left.driven).find_map(number);
        let reduction = Reduction::new(kinematics.n(), elimination);
        let mut reach = PathEvaluation::default();
        let mut open = self.redundant.iter().filter_map(|constraint| {
            let mut row = constraint.row(kinematics, state, &mut reach);
            reduction.reduce(&mut row);
            row.iter().find_map(number)
        });
        Ok(among_left.or_else(|| open.next()))
    }

    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// Solves the equations at a state, if there is room for the solution.
    pub fn eliminate(
        &self,
        scene: &Scene,
        kinematics: &Kinematics,
        state: &State<Number>,
    ) -> Result<Elimination, Vec<LowerError>> {
        let mut reach = PathEvaluation::default();
        let rows = self.list.iter().map(|c| c.row(kinematics, state, &mut reach)).collect();
        let elimination =
            elimination::eliminate(rows, kinematics.n(), |coordinate| unit(kinematics, coordinate, self.length));
        let span = |row: u32| self.list[row as usize].source.span(scene);
        match elimination.full {
            None => Ok(elimination),
            Some(row) => Err(vec![LowerError::TangledLoops { limit: elimination::MAX_ENTRIES, span: span(row) }]),
        }
    }

    /// The independent coordinates at a state; an error if the constraints are not independent there.
    pub fn reduction(
        &self,
        scene: &Scene,
        kinematics: &Kinematics,
        state: &State<Number>,
    ) -> Result<Reduction, Vec<LowerError>> {
        if self.is_empty() {
            return Ok(Reduction::identity(kinematics.n()));
        }
        let elimination = self.eliminate(scene, kinematics, state)?;
        if let Some(left) = elimination.left.first() {
            return Err(vec![rank::singular_error(scene, kinematics, self, left)]);
        }
        Ok(Reduction::new(kinematics.n(), elimination))
    }

    /// Whether every equation, including redundant ones, holds exactly at a state.
    pub fn hold_exactly(&self, kinematics: &Kinematics, state: &State<Number>) -> bool {
        let mut reach = PathEvaluation::default();
        let mut all = self.list.iter().chain(&self.redundant);
        state.is_drawn() || all.all(|c| c.equation.measure(kinematics, state, &mut reach).0.is_zero())
    }

    /// The error for constraints that cannot be satisfied near the drawing with the bases at their prescribed
    /// positions.
    pub fn open(&self, scene: &Scene, kinematics: &Kinematics, numbers: &[u32]) -> LowerError {
        rank::conflict_error(scene, kinematics, self, numbers, Why::Open)
    }

    pub fn are_linear(&self) -> bool {
        self.list.iter().all(|constraint| constraint.equation.is_linear())
    }

    /// An error if a constraint that follows from the others as drawn does not follow from them at rest.
    pub fn check_redundant(
        &self,
        scene: &Scene,
        kinematics: &Kinematics,
        state: &State<Number>,
    ) -> Result<(), Vec<LowerError>> {
        let mut reach = PathEvaluation::default();
        let broken = self.redundant.iter().find(|constraint| {
            let left = constraint.equation.measure(kinematics, state, &mut reach).0;
            !left.may_be_zero() && left.to_f64().abs() > NOTHING * self.length
        });
        match broken {
            None => Ok(()),
            Some(constraint) => Err(vec![rank::broken_error(scene, kinematics, self, constraint.source)]),
        }
    }
}

/// The unit in which a coordinate is measured: rad, or the length of the loops.
fn unit(kinematics: &Kinematics, coordinate: Index, length: f64) -> f64 {
    if kinematics.is_angle(coordinate) {
        return 1.0;
    }
    length / kinematics.length_squared(coordinate).map_or(1.0, |squared| squared.to_f64().sqrt())
}
