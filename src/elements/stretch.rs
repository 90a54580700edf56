//! The stretch e of an element between two ends, as a function of their relative displacement delta (second end minus
//! first) or of their relative rotation. See docs/method/linearisation.md.
//!
//! - line: e = |d| - |D|, d = D + delta, D the line as drawn; grad e = d / |d|, grad^2 e = (1 - d d^T / |d|^2) / |d|
//! - along a fixed direction a: e = a . delta / |a|; grad^2 e = 0
//! - torsion: e = the relative rotation; grad^2 e = 0
//! - span of a belt: e = l - l0 -+ gap (phi - phi0) + turn, with l the length and phi the angle of the tangent s, and `turn` what
//!   the disks wind up; grad e = s / |s| for the centres, and for them grad^2 e = (1 - s s^T / |s|^2) / |s|, as of a line
//!
//! Directions are not normalised; their squared length is kept beside them, so that the squares
//! `(k / |d|^2) (d . delta)^2` are rational if the scene is. Over a range they are divided by their largest component, whose share of the
//! direction then is known without the range.

use super::{Scalar, Square, Vector};

/// The geometry of an element.
#[derive(Clone, Debug)]
pub enum Stretch<S> {
    /// The distance between two points; `drawn` is the vector from the first to the second as drawn.
    Line { drawn: Vector<S> },
    /// The displacement along a fixed direction.
    Along { direction: Vector<S> },
    /// The relative rotation.
    Torsion,
    /// A span of a belt between two disks: `drawn` is the vector between their centres as drawn, `gap` how far their
    /// tangent points are apart along the normal of the span, on the `left` or right side of the way.
    Span { drawn: Vector<S>, gap: S, left: bool },
}

/// A stretch at a state of its ends.
#[derive(Clone, Debug)]
pub enum Stretched<S> {
    /// grad e = direction / sqrt(length_squared); d is the direction times `unit`, or the direction itself. `curved` if grad^2 e is not
    /// zero.
    Displacement { change: S, direction: Vector<S>, length_squared: S, unit: Option<S>, curved: bool },
    /// e is the relative rotation itself.
    Turn { change: S },
}

impl<S: Scalar> Stretch<S> {
    /// The stretch at a relative displacement `delta` and a relative rotation `turn`.
    pub fn at(&self, delta: &Vector<S>, turn: &S) -> Stretched<S> {
        match self {
            Stretch::Line { drawn } => line(drawn, delta),
            Stretch::Along { direction } => {
                let length_squared = direction.norm_squared();
                let change = over_length(direction.dot(delta), &length_squared);
                Stretched::Displacement {
                    change,
                    direction: direction.clone(),
                    length_squared,
                    unit: None,
                    curved: false,
                }
            }
            Stretch::Torsion => Stretched::Turn { change: turn.clone() },
            Stretch::Span { drawn, gap, left } => span(drawn, gap, *left, delta, turn),
        }
    }
}

/// |d| - |D| = (2 D + delta) . delta / (|d| + |D|): no cancellation, and exactly zero as drawn.
fn line<S: Scalar>(drawn: &Vector<S>, delta: &Vector<S>) -> Stretched<S> {
    let direction = drawn.plus(delta);
    let length_squared = direction.norm_squared();
    let gain = drawn.plus(&direction).dot(delta);
    let change =
        if gain.is_zero() { S::zero() } else { gain.over(&length_squared.root().plus(&drawn.norm_squared().root())) };
    stretched_along(change, direction, length_squared)
}

/// A stretch along d, whose squared length is given too.
fn stretched_along<S: Scalar>(change: S, d: Vector<S>, length_squared: S) -> Stretched<S> {
    let Some((direction, unit)) = d.by_largest() else {
        return Stretched::Displacement { change, direction: d, length_squared, unit: None, curved: true };
    };
    let length_squared = direction.norm_squared();
    Stretched::Displacement { change, direction, length_squared, unit: Some(unit), curved: true }
}

fn span<S: Scalar>(drawn: &Vector<S>, gap: &S, left: bool, delta: &Vector<S>, turn: &S) -> Stretched<S> {
    let gap = if left { gap.clone() } else { gap.negate() };
    let tangent = |apart: &Vector<S>| {
        let square = apart.norm_squared();
        let length_squared = square.minus(&gap.times(&gap));
        let length = length_squared.root();
        // The centres' line, turned until it is along the tangent.
        let across = Vector { x: apart.y.negate(), y: apart.x.clone(), z: S::zero() };
        let along = apart.scale(&length_squared.over(&square));
        (along.minus(&across.scale(&length.times(&gap).over(&square))), length, length_squared)
    };
    if delta.is_zero() {
        let (direction, _, length_squared) = tangent(drawn);
        return stretched_along(turn.clone(), direction, length_squared);
    }
    let apart = drawn.plus(delta);
    let ((before, length, _), (direction, now, length_squared)) = (tangent(drawn), tangent(&apart));
    let longer = drawn.plus(&apart).dot(delta).over(&length.plus(&now));
    let turned = S::atan2(&before.cross(&direction).z, &before.dot(&direction));
    let change = longer.minus(&gap.times(&turned)).plus(turn);
    stretched_along(change, direction, length_squared)
}

/// value / sqrt(length_squared), exactly zero if the value is.
pub fn over_length<S: Scalar>(value: S, length_squared: &S) -> S {
    if value.is_zero() { value } else { value.over(&length_squared.root()) }
}

impl<S: Scalar> Stretched<S> {
    pub fn change(&self) -> &S {
        match self {
            Stretched::Displacement { change, .. } | Stretched::Turn { change } => change,
        }
    }

    /// Whether it is linear in the displacement of its ends: then no tension adds to the stiffness.
    pub fn is_linear(&self) -> bool {
        matches!(self, Stretched::Displacement { curved: false, .. })
    }

    /// tension / |direction|: the tension per metre of the element, or of its largest component's share; for a torsion, the tension itself.
    ///
    /// In a rational drawing it is rational even if the tension that holds the drawing is not.
    pub fn rate(&self, tension: &S) -> S {
        match self {
            Stretched::Displacement { length_squared, .. } => over_length(tension.clone(), length_squared),
            Stretched::Turn { .. } => tension.clone(),
        }
    }

    /// The tension that has this rate.
    pub fn tension_of(&self, rate: &S) -> S {
        match self {
            Stretched::Displacement { length_squared, .. } if !rate.is_zero() => rate.times(&length_squared.root()),
            _ => rate.clone(),
        }
    }

    /// The squares of `tension grad^2 e`: tension / |d|^3 (d x delta)^2. `None` if the tension is zero.
    pub fn tension_squares(&self, rate: &S) -> Option<[Square<S>; 3]> {
        match self {
            Stretched::Displacement { direction, length_squared, unit, curved: true, .. } if !rate.is_zero() => {
                let weight = rate.over(length_squared);
                let weight = unit.iter().fold(weight, |weight, unit| weight.over(unit));
                Some(direction.cross_rows().map(|direction| Square { weight: weight.clone(), direction }))
            }
            _ => None,
        }
    }

    /// tension grad e: minus the force on the second end, which acts against the stretch. `None` for a torsion.
    pub fn force(&self, rate: &S) -> Option<Vector<S>> {
        match self {
            Stretched::Displacement { direction, .. } => Some(direction.scale(rate)),
            Stretched::Turn { .. } => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::Number;

    fn vector(x: f64, y: f64) -> Vector<f64> {
        Vector { x, y, z: 0.0 }
    }

    #[test]
    fn a_line_stretches_as_its_length_does() {
        let stretch = Stretch::Line { drawn: vector(3.0, 4.0) };
        let Stretched::Displacement { change, direction, length_squared, .. } = stretch.at(&vector(2.0, 8.0), &0.0)
        else {
            panic!("a line is a displacement");
        };
        assert_eq!((change, direction, length_squared), (8.0, vector(5.0, 12.0), 169.0));
    }

    #[test]
    fn the_gradient_and_curvature_of_a_line_are_those_of_its_length() {
        // Central differences of |d| with a step of 1e-5: error h^2/6 |d'''| + eps/h, about 1e-10, for the first.
        let stretch = Stretch::Line { drawn: vector(0.3, -1.1) };
        let at = |x: f64, y: f64| *stretch.at(&vector(x, y), &0.0).change();
        let (x, y, h) = (0.2, 0.4, 1e-5);
        let state = stretch.at(&vector(x, y), &0.0);
        let rate = state.rate(&1.0);
        let force = state.force(&rate).expect("a line pulls");
        assert!((force.x - (at(x + h, y) - at(x - h, y)) / (2.0 * h)).abs() < 1e-9);
        assert!((force.y - (at(x, y + h) - at(x, y - h)) / (2.0 * h)).abs() < 1e-9);
        let squares = state.tension_squares(&rate).expect("a line is curved");
        let curvature: f64 = squares.iter().map(|s| s.weight * s.direction.x * s.direction.x).sum();
        // The second difference: eps/h^2 is 1e-6.
        assert!((curvature - (at(x + h, y) - 2.0 * at(x, y) + at(x - h, y)) / (h * h)).abs() < 1e-5);
    }

    #[test]
    fn in_the_drawing_all_values_are_rational() {
        let drawn = Vector { x: Number::ONE, y: Number::ONE, z: Number::ZERO };
        let state = Stretch::Line { drawn }.at(&Vector::zero(), &Number::ZERO);
        assert_eq!(state.change(), &Number::ZERO);
        assert!(state.tension_squares(&Number::ZERO).is_none());
    }
}
