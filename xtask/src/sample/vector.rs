//! The few vector operations that the model needs.

use std::ops::{Add, Mul, Neg, Sub};

/// A vector or point, scene units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Vector(pub(super) f64, pub(super) f64, pub(super) f64);

impl Vector {
    pub(super) fn dot(self, other: Self) -> f64 {
        self.0 * other.0 + self.1 * other.1 + self.2 * other.2
    }

    pub(super) fn cross(self, other: Self) -> Self {
        let Self(x, y, z) = self;
        let Self(a, b, c) = other;
        Self(y * c - z * b, z * a - x * c, x * b - y * a)
    }

    pub(super) fn length(self) -> f64 {
        self.dot(self).sqrt()
    }

    pub(super) fn normalized(self) -> Self {
        self * self.length().recip()
    }
}

impl Add for Vector {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self(self.0 + other.0, self.1 + other.1, self.2 + other.2)
    }
}

impl Sub for Vector {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Neg for Vector {
    type Output = Self;
    fn neg(self) -> Self {
        self * -1.0
    }
}

impl Mul<f64> for Vector {
    type Output = Self;
    fn mul(self, factor: f64) -> Self {
        Self(self.0 * factor, self.1 * factor, self.2 * factor)
    }
}
