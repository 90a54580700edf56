//! Vectors of three components of any [`Scalar`], and rotations about an axis.

use super::Scalar;
use crate::base::Vec3;

#[derive(Clone, Debug, PartialEq)]
pub struct Vector<S> {
    pub x: S,
    pub y: S,
    pub z: S,
}

impl<S: Scalar> Vector<S> {
    pub fn zero() -> Vector<S> {
        Vector { x: S::zero(), y: S::zero(), z: S::zero() }
    }

    /// x, y and z.
    pub fn axes() -> [Vector<S>; 3] {
        let axis = |i: usize| {
            let component = |j: usize| if i == j { S::one() } else { S::zero() };
            Vector { x: component(0), y: component(1), z: component(2) }
        };
        [axis(0), axis(1), axis(2)]
    }

    pub fn of(v: &Vec3) -> Vector<S> {
        Vector { x: S::of(&v.x), y: S::of(&v.y), z: S::of(&v.z) }
    }

    fn map(&self, f: impl Fn(&S) -> S) -> Vector<S> {
        Vector { x: f(&self.x), y: f(&self.y), z: f(&self.z) }
    }

    pub fn plus(&self, o: &Vector<S>) -> Vector<S> {
        Vector { x: self.x.plus(&o.x), y: self.y.plus(&o.y), z: self.z.plus(&o.z) }
    }

    pub fn minus(&self, o: &Vector<S>) -> Vector<S> {
        Vector { x: self.x.minus(&o.x), y: self.y.minus(&o.y), z: self.z.minus(&o.z) }
    }

    pub fn negate(&self) -> Vector<S> {
        self.map(S::negate)
    }

    pub fn scale(&self, s: &S) -> Vector<S> {
        self.map(|component| component.times(s))
    }

    pub fn dot(&self, o: &Vector<S>) -> S {
        S::dot([&self.x, &self.y, &self.z], [&o.x, &o.y, &o.z])
    }

    pub fn cross(&self, o: &Vector<S>) -> Vector<S> {
        Vector {
            x: self.y.times(&o.z).minus(&self.z.times(&o.y)),
            y: self.z.times(&o.x).minus(&self.x.times(&o.z)),
            z: self.x.times(&o.y).minus(&self.y.times(&o.x)),
        }
    }

    pub fn norm_squared(&self) -> S {
        self.dot(self)
    }

    /// The vector over the size of its largest component, and that; `None` if it takes one value only, or that component may be zero.
    pub fn by_largest(&self) -> Option<(Vector<S>, S)> {
        let components = [&self.x, &self.y, &self.z];
        if components.iter().all(|component| component.middle_and_change().is_none()) {
            return None;
        }
        let size = |place: usize| components[place].to_f64().abs();
        let largest = (1..3).fold(0, |largest, place| if size(place) > size(largest) { place } else { largest });
        let number = components[largest].number().enclosure();
        if number.contains_zero() || !number.is_finite() {
            return None;
        }
        let sign = if number.is_positive() { S::one() } else { S::one().negate() };
        let unit = sign.times(components[largest]);
        let component = |place: usize| if place == largest { sign.clone() } else { components[place].over(&unit) };
        Some((Vector { x: component(0), y: component(1), z: component(2) }, unit))
    }

    /// Whether it is certainly zero.
    pub fn is_zero(&self) -> bool {
        self.x.is_zero() && self.y.is_zero() && self.z.is_zero()
    }

    /// The rows of the matrix of `delta -> self x delta`.
    pub fn cross_rows(&self) -> [Vector<S>; 3] {
        [
            Vector { x: S::zero(), y: self.z.negate(), z: self.y.clone() },
            Vector { x: self.z.clone(), y: S::zero(), z: self.x.negate() },
            Vector { x: self.y.negate(), y: self.x.clone(), z: S::zero() },
        ]
    }

    /// Rotated about the unit vector `axis` by the angle with this sine and cosine (Rodrigues):
    /// v cos + (a x v) sin + a (a . v) (1 - cos).
    pub fn rotate(&self, axis: &Vector<S>, sine: &S, cosine: &S) -> Vector<S> {
        let along = axis.scale(&axis.dot(self).times(&S::one().minus(cosine)));
        self.scale(cosine).plus(&axis.cross(self).scale(sine)).plus(&along)
    }
}
