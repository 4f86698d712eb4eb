//! Axis-aligned boxes.

use glam::{DAffine3, DVec3};

/// Axis-aligned box, f64; empty until something is added.
///
/// Local bounds (of a [`Geometry`](crate::Geometry)) hold f32 values exactly and are relative to the object's origin;
/// world bounds are absolute.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Smallest corner; +∞ when empty.
    pub min: DVec3,
    /// Largest corner; −∞ when empty.
    pub max: DVec3,
}

impl Bounds {
    /// The box of nothing.
    pub const EMPTY: Self = Self {
        min: DVec3::INFINITY,
        max: DVec3::NEG_INFINITY,
    };

    /// The box between two corners.
    pub const fn new(min: DVec3, max: DVec3) -> Self {
        Self { min, max }
    }

    /// True when nothing was added, or only NaN.
    pub fn is_empty(&self) -> bool {
        !self.min.cmple(self.max).all()
    }

    /// The smallest box that holds this one and `point`; components that are NaN are ignored.
    #[must_use]
    pub fn with_point(self, point: DVec3) -> Self {
        Self {
            min: point.min(self.min),
            max: point.max(self.max),
        }
    }

    /// The smallest box that holds both.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
        }
    }

    /// Centre; the origin when empty.
    pub fn centre(&self) -> DVec3 {
        if self.is_empty() {
            DVec3::ZERO
        } else {
            self.min * 0.5 + self.max * 0.5
        }
    }

    /// Edge lengths; zero when empty.
    pub fn size(&self) -> DVec3 {
        if self.is_empty() {
            DVec3::ZERO
        } else {
            self.max - self.min
        }
    }

    /// Radius of the sphere around [`centre`](Self::centre) through the corners.
    pub fn sphere_radius(&self) -> f64 {
        self.size().length() * 0.5
    }

    /// The eight corners, x fastest.
    pub fn corners(&self) -> [DVec3; 8] {
        std::array::from_fn(|corner| {
            let pick = |bit: usize, low: f64, high: f64| if corner & bit == 0 { low } else { high };
            DVec3::new(
                pick(1, self.min.x, self.max.x),
                pick(2, self.min.y, self.max.y),
                pick(4, self.min.z, self.max.z),
            )
        })
    }

    /// The axis-aligned box of this box moved by `transform`; empty stays empty.
    #[must_use]
    pub fn transformed(&self, transform: &DAffine3) -> Self {
        if self.is_empty() {
            return Self::EMPTY;
        }
        self.corners()
            .into_iter()
            .fold(Self::EMPTY, |bounds, corner| {
                bounds.with_point(transform.transform_point3(corner))
            })
    }

    /// This box moved by `offset`; empty stays empty.
    #[must_use]
    pub fn translated(&self, offset: DVec3) -> Self {
        Self {
            min: self.min + offset,
            max: self.max + offset,
        }
    }
}

impl Default for Bounds {
    fn default() -> Self {
        Self::EMPTY
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn empty_stays_empty_under_transforms() {
        assert!(
            Bounds::EMPTY
                .transformed(&DAffine3::from_scale(DVec3::splat(-2.0)))
                .is_empty()
        );
        assert!(Bounds::EMPTY.translated(DVec3::ONE).is_empty());
        assert_eq!(Bounds::EMPTY.size(), DVec3::ZERO);
    }

    #[test]
    fn nan_points_do_not_spoil_a_box() {
        let bounds = Bounds::EMPTY
            .with_point(DVec3::NAN)
            .with_point(DVec3::ONE)
            .with_point(DVec3::NAN);
        assert_eq!(bounds, Bounds::new(DVec3::ONE, DVec3::ONE));
    }

    #[test]
    fn transformed_box_holds_the_rotated_corners() {
        let turned = Bounds::new(DVec3::ZERO, DVec3::ONE)
            .transformed(&DAffine3::from_rotation_z(std::f64::consts::FRAC_PI_2));
        assert!(
            (turned.min - DVec3::new(-1.0, 0.0, 0.0)).length() < 1e-12,
            "{turned:?}"
        );
        assert!(
            (turned.max - DVec3::new(0.0, 1.0, 1.0)).length() < 1e-12,
            "{turned:?}"
        );
    }
}
