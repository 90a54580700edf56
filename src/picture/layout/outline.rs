//! The outline of a part on the page, at which its elements end.

use crate::picture::geometry::{Bounds, Point};

#[derive(Clone, Debug, PartialEq)]
pub enum Outline {
    /// The ground, which is drawn only where it holds something.
    Nowhere,
    /// A body without a shape.
    Block {
        half: Point,
    },
    /// A box to scale; its width runs along a direction of length one.
    Box {
        half: Point,
        along: Point,
    },
    Disk {
        radius: f64,
    },
    Ring {
        radius: f64,
    },
    /// A body that turns and has no shape: a disk of a common size.
    Wheel {
        radius: f64,
    },
    /// Between two points, relative to the middle.
    Rod {
        arm: Point,
    },
    /// A mass in one point, or a body without any mass.
    Dot {
        radius: f64,
    },
    /// A base: the direction of its motion, and half of its width.
    Plate {
        along: Point,
        half: f64,
    },
    /// A part of a scene of a hundred thousand.
    Speck {
        half: f64,
    },
}

impl Outline {
    /// The distance from `inside` (relative to the middle) to the outline in a direction; 0 if the point is not inside.
    pub fn reach(&self, inside: Point, direction: Point) -> f64 {
        match self {
            Outline::Block { half } => box_reach(*half, inside, direction),
            Outline::Box { half, along } => box_reach(*half, own_axes(*along, inside), own_axes(*along, direction)),
            Outline::Speck { half } => box_reach(Point::new(*half, *half), inside, direction),
            Outline::Disk { radius }
            | Outline::Ring { radius }
            | Outline::Wheel { radius }
            | Outline::Dot { radius } => {
                let (b, c) = (inside.dot(direction), inside.dot(inside) - radius * radius);
                // A point on the rim counts as outside, whatever its last bits are.
                if c >= -1e-6 * radius * radius { 0.0 } else { (b * b - c).sqrt() - b }
            }
            Outline::Nowhere | Outline::Rod { .. } | Outline::Plate { .. } => 0.0,
        }
    }

    /// Half of its size.
    pub fn half(&self) -> Point {
        match self {
            Outline::Nowhere => Point::default(),
            Outline::Block { half } => *half,
            Outline::Box { half, along } => {
                let across = along.perpendicular();
                Point::new(
                    (half.x * along.x).abs() + (half.y * across.x).abs(),
                    (half.x * along.y).abs() + (half.y * across.y).abs(),
                )
            }
            Outline::Disk { radius }
            | Outline::Ring { radius }
            | Outline::Wheel { radius }
            | Outline::Dot { radius } => Point::new(*radius, *radius),
            Outline::Rod { arm } => Point::new(arm.x.abs() + 5.0, arm.y.abs() + 5.0),
            Outline::Plate { along, half } => {
                let side = along.perpendicular();
                Point::new(side.x.abs() * half + along.x.abs() * 8.0, side.y.abs() * half + along.y.abs() * 8.0)
            }
            Outline::Speck { half } => Point::new(*half, *half),
        }
    }

    /// Whether the outline is wide enough for elements side by side.
    pub fn is_wide(&self) -> bool {
        !matches!(self, Outline::Rod { .. } | Outline::Dot { .. })
    }
}

/// The coordinates of a point in axes whose first one is a direction of length one.
pub fn own_axes(along: Point, point: Point) -> Point {
    Point::new(point.dot(along), point.dot(along.perpendicular()))
}

fn box_reach(half: Point, inside: Point, direction: Point) -> f64 {
    if !Bounds::around(Point::default(), half).grow(-1e-6).holds(inside) {
        return 0.0;
    }
    let side = |half: f64, at: f64, d: f64| if d.abs() < 1e-9 { f64::INFINITY } else { (half * d.signum() - at) / d };
    side(half.x, inside.x, direction.x).min(side(half.y, inside.y, direction.y)).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elements_end_at_the_outline() {
        let block = Outline::Block { half: Point::new(22.0, 16.0) };
        assert_eq!(block.reach(Point::default(), Point::new(-1.0, 0.0)), 22.0);
        assert_eq!(block.reach(Point::new(0.0, 6.0), Point::new(0.0, 1.0)), 10.0);
        assert_eq!(block.reach(Point::new(30.0, 0.0), Point::new(1.0, 0.0)), 0.0);
        // A box of a component that is placed with a quarter turn: its width runs upwards.
        let upright = Outline::Box { half: Point::new(20.0, 10.0), along: Point::new(0.0, -1.0) };
        assert_eq!(upright.reach(Point::default(), Point::new(1.0, 0.0)), 10.0);
        assert_eq!(upright.reach(Point::default(), Point::new(0.0, 1.0)), 20.0);
        assert_eq!(upright.half(), Point::new(10.0, 20.0));
        let disk = Outline::Disk { radius: 10.0 };
        assert_eq!(disk.reach(Point::new(6.0, 0.0), Point::new(0.0, 1.0)), 8.0);
        assert_eq!(disk.reach(Point::new(10.0, 0.0), Point::new(-1.0, 0.0)), 0.0);
    }
}
