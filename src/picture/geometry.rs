//! Points of the page and the computations on them, in plain binary64. Only operations that every machine rounds in the
//! same way are used, so that the same scene gives the same figure to the last byte.

use crate::base::{Ball, Number};

/// A point or a vector of the page: x to the right, y downwards, in the figure's own unit (a CSS pixel).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Point {
    pub x: f64,
    pub y: f64,
}

/// Shorter vectors have no direction.
const TINY: f64 = 1e-9;

impl Point {
    pub const fn new(x: f64, y: f64) -> Point {
        Point { x, y }
    }

    pub fn plus(self, o: Point) -> Point {
        Point { x: self.x + o.x, y: self.y + o.y }
    }

    pub fn minus(self, o: Point) -> Point {
        Point { x: self.x - o.x, y: self.y - o.y }
    }

    pub fn times(self, s: f64) -> Point {
        Point { x: self.x * s, y: self.y * s }
    }

    /// `self + direction * length`.
    pub fn towards(self, direction: Point, length: f64) -> Point {
        self.plus(direction.times(length))
    }

    pub fn dot(self, o: Point) -> f64 {
        self.x * o.x + self.y * o.y
    }

    pub fn length(self) -> f64 {
        self.dot(self).sqrt()
    }

    pub fn distance(self, o: Point) -> f64 {
        self.minus(o).length()
    }

    /// The vector of length one in this direction; `None` for the zero vector.
    pub fn unit(self) -> Option<Point> {
        let length = self.length();
        (length > TINY && length.is_finite()).then(|| self.times(1.0 / length))
    }

    /// A quarter turn clockwise as seen on the page.
    pub fn perpendicular(self) -> Point {
        Point { x: -self.y, y: self.x }
    }

    pub fn middle(self, o: Point) -> Point {
        self.plus(o).times(0.5)
    }

    /// Turned by an angle, counter-clockwise as seen on the page.
    pub fn rotate(self, turn: Turn) -> Point {
        Point { x: self.x * turn.cosine + self.y * turn.sine, y: self.y * turn.cosine - self.x * turn.sine }
    }

    pub fn is_finite(self) -> bool {
        self.x.is_finite() && self.y.is_finite()
    }
}

/// Sine and cosine of an angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turn {
    pub sine: f64,
    pub cosine: f64,
}

impl Turn {
    pub const NONE: Turn = Turn { sine: 0.0, cosine: 1.0 };

    /// The turn by an angle in radians. The standard library's functions are not the same on all machines.
    pub fn from_angle(angle: f64) -> Turn {
        if angle == 0.0 {
            return Turn::NONE;
        }
        let found = Number::Ball(Ball::from(angle)).sin_cos();
        let (sine, cosine) = found.unwrap_or((Number::ZERO, Number::ONE));
        Turn { sine: sine.to_f64(), cosine: cosine.to_f64() }
    }
}

/// Points on a circle from one angle to another (radians, counter-clockwise from the right), the ends included.
pub fn arc(centre: Point, radius: f64, from: f64, to: f64, steps: usize) -> Vec<Point> {
    spiral(centre, (radius, radius), (from, to), steps)
}

/// Points on a spiral: an arc whose radius changes linearly with the angle.
pub fn spiral(centre: Point, radii: (f64, f64), angles: (f64, f64), steps: usize) -> Vec<Point> {
    // One exact step, applied repeatedly: the error is a few last bits over some dozen steps.
    let step = Turn::from_angle((angles.1 - angles.0) / steps as f64);
    let mut arm = Point::new(1.0, 0.0).rotate(Turn::from_angle(angles.0));
    let mut points = Vec::with_capacity(steps + 1);
    for k in 0..=steps {
        let share = k as f64 / steps as f64;
        points.push(centre.towards(arm, radii.0 + (radii.1 - radii.0) * share));
        arm = arm.rotate(step);
    }
    points
}

/// An upright rectangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    pub low: Point,
    pub high: Point,
}

impl Bounds {
    pub const EMPTY: Bounds = Bounds {
        low: Point::new(f64::INFINITY, f64::INFINITY),
        high: Point::new(f64::NEG_INFINITY, f64::NEG_INFINITY),
    };

    pub fn around(centre: Point, half: Point) -> Bounds {
        Bounds { low: centre.minus(half), high: centre.plus(half) }
    }

    pub fn of(points: &[Point]) -> Bounds {
        points.iter().fold(Bounds::EMPTY, |bounds, point| bounds.with(*point))
    }

    pub fn is_empty(&self) -> bool {
        self.low.x > self.high.x
    }

    pub fn with(self, point: Point) -> Bounds {
        Bounds {
            low: Point::new(self.low.x.min(point.x), self.low.y.min(point.y)),
            high: Point::new(self.high.x.max(point.x), self.high.y.max(point.y)),
        }
    }

    pub fn and(self, other: Bounds) -> Bounds {
        if other.is_empty() { self } else { self.with(other.low).with(other.high) }
    }

    pub fn shift(self, by: Point) -> Bounds {
        Bounds { low: self.low.plus(by), high: self.high.plus(by) }
    }

    pub fn grow(self, by: f64) -> Bounds {
        let by = Point::new(by, by);
        Bounds { low: self.low.minus(by), high: self.high.plus(by) }
    }

    pub fn width(&self) -> f64 {
        self.high.x - self.low.x
    }

    pub fn height(&self) -> f64 {
        self.high.y - self.low.y
    }

    pub fn centre(&self) -> Point {
        self.low.middle(self.high)
    }

    pub fn overlaps(&self, o: &Bounds) -> bool {
        self.low.x < o.high.x && o.low.x < self.high.x && self.low.y < o.high.y && o.low.y < self.high.y
    }

    pub fn holds(&self, point: Point) -> bool {
        self.low.x <= point.x && point.x <= self.high.x && self.low.y <= point.y && point.y <= self.high.y
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_circle_closes() {
        let points = arc(Point::new(3.0, 4.0), 10.0, 0.0, 2.0 * std::f64::consts::PI, 48);
        assert!(points[0].distance(points[48]) < 1e-10);
        assert!(points.iter().all(|point| (point.distance(Point::new(3.0, 4.0)) - 10.0).abs() < 1e-10));
        // Counter-clockwise on a page whose y runs downwards: after a quarter turn, the point is above the centre.
        assert!(points[12].distance(Point::new(3.0, -6.0)) < 1e-10);
    }
}
