//! Four numbers at once: what the CPU's splats are computed in.

use core::ops::{Add, Mul, Neg, Sub};
use pointstage_plugin_api::glam::{BVec4A, Vec3, Vec4};

/// Numbers that are computed at once.
pub const LANES: usize = 4;

/// Four vectors: all first components, all second ones, all third ones.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Vec3x4 {
    /// First components.
    pub x: Vec4,
    /// Second components.
    pub y: Vec4,
    /// Third components.
    pub z: Vec4,
}

impl Vec3x4 {
    /// From the components.
    #[inline]
    pub const fn new(x: Vec4, y: Vec4, z: Vec4) -> Self {
        Self { x, y, z }
    }

    /// The same vector four times.
    #[inline]
    pub const fn splat(vector: Vec3) -> Self {
        Self::new(
            Vec4::splat(vector.x),
            Vec4::splat(vector.y),
            Vec4::splat(vector.z),
        )
    }

    /// From four vectors.
    #[inline]
    pub fn from_vectors(vectors: [Vec3; LANES]) -> Self {
        Self::new(
            Vec4::from_array(vectors.map(|vector| vector.x)),
            Vec4::from_array(vectors.map(|vector| vector.y)),
            Vec4::from_array(vectors.map(|vector| vector.z)),
        )
    }

    /// The vector of a lane.
    #[inline]
    pub fn lane(&self, lane: usize) -> Vec3 {
        Vec3::new(self.x[lane], self.y[lane], self.z[lane])
    }

    /// Dot products.
    #[inline]
    pub fn dot(self, other: Self) -> Vec4 {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    /// Cross products.
    #[inline]
    #[must_use]
    pub fn cross(self, other: Self) -> Self {
        Self::new(
            self.y * other.z - self.z * other.y,
            self.z * other.x - self.x * other.z,
            self.x * other.y - self.y * other.x,
        )
    }

    /// Squares of the lengths.
    #[inline]
    pub fn length_squared(self) -> Vec4 {
        self.dot(self)
    }

    /// The vectors with length 1; not finite where they have none.
    #[inline]
    #[must_use]
    pub fn normalize(self) -> Self {
        self * (Vec4::ONE / sqrt(self.length_squared()))
    }

    /// `if_true` where the mask holds, else `if_false`.
    #[inline]
    pub fn select(mask: BVec4A, if_true: Self, if_false: Self) -> Self {
        Self::new(
            Vec4::select(mask, if_true.x, if_false.x),
            Vec4::select(mask, if_true.y, if_false.y),
            Vec4::select(mask, if_true.z, if_false.z),
        )
    }
}

impl Add for Vec3x4 {
    type Output = Self;

    #[inline]
    fn add(self, other: Self) -> Self {
        Self::new(self.x + other.x, self.y + other.y, self.z + other.z)
    }
}

impl Sub for Vec3x4 {
    type Output = Self;

    #[inline]
    fn sub(self, other: Self) -> Self {
        Self::new(self.x - other.x, self.y - other.y, self.z - other.z)
    }
}

impl Mul<Vec4> for Vec3x4 {
    type Output = Self;

    #[inline]
    fn mul(self, factor: Vec4) -> Self {
        Self::new(self.x * factor, self.y * factor, self.z * factor)
    }
}

impl Neg for Vec3x4 {
    type Output = Self;

    #[inline]
    fn neg(self) -> Self {
        Self::new(-self.x, -self.y, -self.z)
    }
}

/// Square roots; NaN of what is negative.
#[inline]
pub fn sqrt(values: Vec4) -> Vec4 {
    // The compiler makes one instruction of it.
    Vec4::from_array(values.to_array().map(f32::sqrt))
}

/// The exponentials of numbers from -6 to 0, with a relative error below 4e-6; of what is less, exp(-6).
#[inline]
pub fn exp_near_zero(values: Vec4) -> Vec4 {
    // exp(x) = exp(x/8)^8; of y = x/8 + 3/8, within 3/8 of zero, the series up to y^6 is exact to 2e-7, and
    // exp(-3) comes back as a factor.
    let y = values.max(Vec4::splat(-6.0)) * 0.125 + Vec4::splat(0.375);
    let mut sum = Vec4::splat(1.0 / 720.0);
    for factor in [1.0 / 120.0, 1.0 / 24.0, 1.0 / 6.0, 0.5, 1.0, 1.0] {
        sum = sum * y + Vec4::splat(factor);
    }
    let square = sum * sum;
    let fourth = square * square;
    fourth * fourth * 0.049_787_07
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_exponential_is_exact_to_four_millionths() {
        for step in 0..=6_000 {
            let x = -step as f32 / 1_000.0;
            let found = exp_near_zero(Vec4::splat(x)).x;
            let expected = f64::from(x).exp();
            let error = (f64::from(found) / expected - 1.0).abs();
            assert!(error < 4e-6, "{found} of {expected}, at {x}");
        }
    }

    #[test]
    fn what_is_too_little_gives_the_least_value() {
        let least = exp_near_zero(Vec4::new(-1e8, f32::NEG_INFINITY, -7.0, -6.0));
        assert!((least - Vec4::splat((-6.0_f32).exp())).abs().max_element() < 1e-7);
    }

    #[test]
    fn products_are_those_of_single_vectors() {
        let [first, second] = [Vec3::new(1.0, 2.0, 3.0), Vec3::new(-2.0, 0.5, 4.0)];
        let lanes = Vec3x4::from_vectors([first, second, first, second]);
        let cross = lanes.cross(Vec3x4::splat(second));
        assert_eq!(cross.lane(2), first.cross(second));
        assert_eq!(lanes.dot(Vec3x4::splat(first)).y, first.dot(second));
        assert_eq!(lanes.normalize().lane(1), second.normalize());
    }
}
