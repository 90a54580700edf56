//! One scalar constraint g(q) = 0 and its exact first and second derivatives. See docs/method/kinematics.md#constraints.
//!
//! g is a sum of components of displacements and of angles,
//!
//! ```text
//! g = sum_k (R_k n_k) . u_k(q) + sum_i c_i theta_i
//! ```
//!
//! with u_k the displacement along a path and R_k the rotation of the part that carries the direction n_k (of a slide);
//! R_k = 1 for fixed directions. A rotation t of the carrier adds a x R n to the direction, so
//!
//! ```text
//! dg/dt += (a x R n) . u      d2g/dt dq_j += (a x R n) . du/dq_j      d2g/dt2 += -(R n) . u.
//! ```

use crate::base::{Number, OrderBy};
use crate::elements::{Scalar, Vector};
use crate::lower::kinematics::{Index, Kinematics, Path, PathEvaluation, State};

/// A constraint, in the number type in which it is evaluated.
#[derive(Clone, Debug)]
pub struct Equation<S> {
    pub components: Vec<Component<S>>,
    /// Angles with their factors.
    pub turns: Vec<(Index, S)>,
}

/// A component of the displacement along a path.
#[derive(Clone, Debug)]
pub struct Component<S> {
    pub path: Path<S>,
    pub direction: Vector<S>,
    /// The angle of the part to which the direction is fixed; `None` if that part does not turn.
    pub carrier: Option<Index>,
}

impl Equation<Number> {
    pub fn convert<S: Scalar>(&self) -> Equation<S> {
        let vector = |v: &Vector<Number>| Vector { x: S::of(&v.x), y: S::of(&v.y), z: S::of(&v.z) };
        let component = |component: &Component<Number>| Component {
            path: component.path.convert(),
            direction: vector(&component.direction),
            carrier: component.carrier,
        };
        Equation {
            components: self.components.iter().map(component).collect(),
            turns: self.turns.iter().map(|(angle, factor)| (*angle, S::of(factor))).collect(),
        }
    }

    /// Whether g is linear in the coordinates.
    pub fn is_linear(&self) -> bool {
        self.components.iter().all(|component| component.path.is_straight() && component.carrier.is_none())
    }

    /// Every coordinate that g may depend on; some appear more than once.
    pub fn coordinates<'a>(&'a self, kinematics: &'a Kinematics) -> impl Iterator<Item = Index> + 'a {
        let way = |component: &'a Component<Number>| {
            let way = component.path.coordinates(kinematics).flat_map(|(coordinate, angle)| [Some(coordinate), angle]);
            way.chain([component.carrier]).flatten()
        };
        self.components.iter().flat_map(way).chain(self.turns.iter().map(|(angle, _)| *angle))
    }

    /// The longest arm, m; for a relation between displacements and angles, the length that converts one into the other.
    pub fn length(&self) -> f64 {
        let arm = self.components.iter().map(|component| component.path.longest_arm()).fold(0.0, f64::max);
        let sizes = self.components.iter().map(|component| component.direction.norm_squared().to_f64().sqrt());
        let displacement = sizes.fold(0.0, f64::max);
        let turn = self.turns.iter().map(|(_, factor)| factor.to_f64().abs()).fold(0.0, f64::max);
        if displacement > 0.0 { arm.max(turn / displacement) } else { arm }
    }
}

impl<S: Scalar> Equation<S> {
    /// g and its gradient: one entry per coordinate, ascending, without zeros.
    pub fn measure(
        &self,
        kinematics: &Kinematics,
        state: &State<S>,
        reach: &mut PathEvaluation<S>,
    ) -> (S, Vec<(Index, S)>) {
        let mut value = S::zero();
        let mut row: Vec<(Index, S)> = Vec::new();
        let mut part = Vec::new();
        for component in &self.components {
            reach.measure(kinematics, state, &component.path);
            let direction = component.rotate(kinematics, state);
            value = value.plus(&direction.dot(&reach.displacement));
            reach.row(&direction, &mut part);
            row.append(&mut part);
            if let Some(carrier) = component.carrier {
                let turning = kinematics.axis(carrier).cross(&direction);
                row.push((carrier, turning.dot(&reach.displacement)));
            }
        }
        for (angle, factor) in &self.turns {
            value = value.plus(&factor.times(state.value(*angle)));
            row.push((*angle, factor.clone()));
        }
        (value, merge_entries(row))
    }

    /// `multiplier` times the second derivative. Each pair of coordinates is visited in one order only, but possibly more
    /// than once.
    pub fn curvature(
        &self,
        kinematics: &Kinematics,
        state: &State<S>,
        multiplier: &S,
        reach: &mut PathEvaluation<S>,
        mut visit: impl FnMut(Index, Index, S),
    ) {
        for component in &self.components {
            reach.measure(kinematics, state, &component.path);
            let direction = component.rotate(kinematics, state).scale(multiplier);
            reach.curvature(&direction, &mut visit);
            let Some(carrier) = component.carrier else { continue };
            let turning = kinematics.axis(carrier).cross(&direction);
            for (coordinate, column) in &reach.columns {
                let mixed = turning.dot(column);
                let both = if *coordinate == carrier { mixed.plus(&mixed) } else { mixed };
                if !both.is_zero() {
                    visit(carrier, *coordinate, both);
                }
            }
            let own = direction.dot(&reach.displacement).negate();
            if !own.is_zero() {
                visit(carrier, carrier, own);
            }
        }
    }
}

impl<S: Scalar> Component<S> {
    /// R n.
    fn rotate(&self, kinematics: &Kinematics, state: &State<S>) -> Vector<S> {
        match self.carrier {
            Some(carrier) => state.rotate_by(kinematics, carrier, &self.direction),
            None => self.direction.clone(),
        }
    }
}

/// Sums the entries of each coordinate: one per coordinate, ascending, without zeros.
pub fn merge_entries<S: Scalar>(mut row: Vec<(Index, S)>) -> Vec<(Index, S)> {
    row.order_by_key(|(coordinate, _)| *coordinate);
    let mut sums: Vec<(Index, S)> = Vec::with_capacity(row.len());
    for (coordinate, value) in row {
        match sums.last_mut() {
            Some((last, sum)) if *last == coordinate => *sum = sum.plus(&value),
            _ => sums.push((coordinate, value)),
        }
    }
    sums.retain(|(_, value)| !value.is_zero());
    sums
}
