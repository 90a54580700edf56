//! Vectors of three components. Planar scenes have z = 0 and joint axes along z; the kinematics do not know that.

use super::number::Number;

/// A position, a displacement, a direction or an axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Vec3 {
    pub x: Number,
    pub y: Number,
    pub z: Number,
}

impl Vec3 {
    pub const ZERO: Vec3 = Vec3 { x: Number::ZERO, y: Number::ZERO, z: Number::ZERO };
    pub const X: Vec3 = Vec3 { x: Number::ONE, y: Number::ZERO, z: Number::ZERO };
    pub const Y: Vec3 = Vec3 { x: Number::ZERO, y: Number::ONE, z: Number::ZERO };
    pub const Z: Vec3 = Vec3 { x: Number::ZERO, y: Number::ZERO, z: Number::ONE };

    pub fn planar(x: Number, y: Number) -> Vec3 {
        Vec3 { x, y, z: Number::ZERO }
    }

    pub fn add(&self, o: &Vec3) -> Vec3 {
        Vec3 { x: &self.x + &o.x, y: &self.y + &o.y, z: &self.z + &o.z }
    }

    pub fn sub(&self, o: &Vec3) -> Vec3 {
        Vec3 { x: &self.x - &o.x, y: &self.y - &o.y, z: &self.z - &o.z }
    }

    pub fn scale(&self, s: &Number) -> Vec3 {
        Vec3 { x: &self.x * s, y: &self.y * s, z: &self.z * s }
    }

    pub fn dot(&self, o: &Vec3) -> Number {
        &(&(&self.x * &o.x) + &(&self.y * &o.y)) + &(&self.z * &o.z)
    }

    pub fn cross(&self, o: &Vec3) -> Vec3 {
        Vec3 {
            x: &(&self.y * &o.z) - &(&self.z * &o.y),
            y: &(&self.z * &o.x) - &(&self.x * &o.z),
            z: &(&self.x * &o.y) - &(&self.y * &o.x),
        }
    }

    pub fn is_zero(&self) -> bool {
        self.x.is_zero() && self.y.is_zero() && self.z.is_zero()
    }

    /// Whether the vector is zero, or cannot be distinguished from zero with the known digits.
    pub fn may_be_zero(&self) -> bool {
        self.x.may_be_zero() && self.y.may_be_zero() && self.z.may_be_zero()
    }
}
