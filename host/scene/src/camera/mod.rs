//! The camera: where the eye is, how it projects, how it moves, and how a view is written down.
//!
//! [`Camera`] holds the state and gives the matrices; `navigate` moves it around its pivot, `walk` from the eye, and `between`
//! finds the way to another view; [`CameraPath`] goes through several at their times; [`NearClipping`] places the near plane. [`ViewRecord`] is a camera with a picture size in a
//! file; [`ViewSource`] is what a user may write where a command takes views.

mod between;
mod navigate;
mod near;
mod orbit;
mod path;
mod record;
mod source;
mod walk;

pub use near::NearClipping;
pub use orbit::orbit_cameras;
pub use path::{CameraKey, CameraPath, CameraPathError, Easing};
pub use record::{VIEW_RECORD_FORMAT, ViewRecord, ViewRecordError};
pub use source::{ViewSource, ViewSourceError};

use glam::{DMat4, DVec3, DVec4};
use serde::{Deserialize, Serialize};

/// A camera in the world, f64. Right-handed; the eye looks down −z of view space, y is up, x right.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Where the eye is, world space.
    pub eye: DVec3,
    /// What it looks at and turns around, world space; different from `eye`.
    pub pivot: DVec3,
    /// The direction that appears upwards, world space; not along the line of sight. The axis of the turntable.
    pub up: DVec3,
    /// How depth is turned into size.
    pub projection: Projection,
    /// Distance of the near plane from the eye, scene units, above 0.
    pub near: f64,
    /// Distance of the far plane from the eye, scene units; only orthographic views have one.
    pub far: f64,
}

/// How the camera projects.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", tag = "kind")]
pub enum Projection {
    /// Far things look smaller.
    Perspective {
        /// Full vertical angle of view, radians, between 0 and π.
        fov_y_rad: f64,
    },
    /// Distance does not matter.
    Orthographic {
        /// Height of the picture, scene units.
        height: f64,
    },
}

impl Default for Camera {
    /// At (0, 0, 3), looking at the origin, 40° high.
    fn default() -> Self {
        Self {
            eye: DVec3::new(0.0, 0.0, 3.0),
            pivot: DVec3::ZERO,
            up: DVec3::Y,
            projection: Projection::Perspective {
                fov_y_rad: 40_f64.to_radians(),
            },
            near: 0.003,
            far: 1000.0,
        }
    }
}

impl Camera {
    /// Distance from the eye to the pivot, scene units.
    pub fn distance(&self) -> f64 {
        self.eye.distance(self.pivot)
    }

    /// The view space's axes in the world: right, up, backwards (from the pivot to the eye); orthonormal.
    ///
    /// A camera whose `up` lies along the line of sight gets some axes that fit.
    pub fn axes_world(&self) -> [DVec3; 3] {
        let back = (self.eye - self.pivot).try_normalize().unwrap_or(DVec3::Z);
        // 1e-9 rad from the line of sight, rounding alone would choose the right axis.
        let sideways = self.up.normalize_or_zero().cross(back);
        let right = if sideways.length() > 1e-9 {
            sideways.normalize()
        } else {
            back.any_orthonormal_vector()
        };
        [right, back.cross(right), back]
    }

    /// Moves points from the world into view space.
    pub fn view_from_world(&self) -> DMat4 {
        let [right, up, back] = self.axes_world();
        DMat4::from_cols(
            DVec4::new(right.x, up.x, back.x, 0.0),
            DVec4::new(right.y, up.y, back.y, 0.0),
            DVec4::new(right.z, up.z, back.z, 0.0),
            DVec4::new(
                -right.dot(self.eye),
                -up.dot(self.eye),
                -back.dot(self.eye),
                1.0,
            ),
        )
    }

    /// Projects view space into clip space with reversed depth; `aspect` is width over height.
    ///
    /// ```text
    /// perspective   depth_ndc = near / distance                       1 at the near plane, 0 infinitely far
    /// orthographic  depth_ndc = (far − distance) / (far − near)       1 at the near plane, 0 at the far plane
    /// ```
    pub fn clip_from_view(&self, aspect: f64) -> DMat4 {
        match self.projection {
            Projection::Perspective { fov_y_rad } => {
                let focal = 1.0 / (0.5 * fov_y_rad).tan();
                DMat4::from_cols(
                    DVec4::new(focal / aspect, 0.0, 0.0, 0.0),
                    DVec4::new(0.0, focal, 0.0, 0.0),
                    DVec4::new(0.0, 0.0, 0.0, -1.0),
                    DVec4::new(0.0, 0.0, self.near, 0.0),
                )
            }
            Projection::Orthographic { height } => {
                let depth = self.far - self.near;
                DMat4::from_cols(
                    DVec4::new(2.0 / (height * aspect), 0.0, 0.0, 0.0),
                    DVec4::new(0.0, 2.0 / height, 0.0, 0.0),
                    DVec4::new(0.0, 0.0, 1.0 / depth, 0.0),
                    DVec4::new(0.0, 0.0, self.far / depth, 1.0),
                )
            }
        }
    }

    /// Height of the picture in the plane through the pivot, scene units.
    pub fn height_at_pivot(&self) -> f64 {
        match self.projection {
            Projection::Perspective { fov_y_rad } => {
                2.0 * self.distance() * (0.5 * fov_y_rad).tan()
            }
            Projection::Orthographic { height } => height,
        }
    }

    /// The same picture, at the pivot, with the other projection.
    ///
    /// `fov_y_rad` is the angle that a perspective view gets; the eye moves to where the pivot's plane keeps its size.
    #[must_use]
    pub fn with_projection_switched(mut self, fov_y_rad: f64) -> Self {
        let height = self.height_at_pivot();
        self.projection = match self.projection {
            Projection::Perspective { .. } => Projection::Orthographic { height },
            Projection::Orthographic { .. } => {
                let [_, _, back] = self.axes_world();
                self.eye = self.pivot + back * (height / (2.0 * (0.5 * fov_y_rad).tan()));
                Projection::Perspective { fov_y_rad }
            }
        };
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn project(camera: &Camera, world: DVec3) -> DVec3 {
        (camera.clip_from_view(2.0) * camera.view_from_world()).project_point3(world)
    }

    #[test]
    fn the_pivot_is_in_the_middle_and_up_is_up() {
        let camera = Camera {
            eye: DVec3::new(3.0, 2.0, 1.0),
            ..Camera::default()
        };
        let middle = project(&camera, camera.pivot);
        assert!(middle.truncate().length() < 1e-12, "{middle}");
        assert!(project(&camera, camera.pivot + DVec3::Y * 0.1).y > 0.0);
    }

    #[test]
    fn perspective_depth_is_near_over_distance() {
        let camera = Camera {
            near: 0.5,
            ..Camera::default()
        };
        for (z, expected) in [(2.5, 1.0), (1.0, 0.25), (-997.0, 0.0005)] {
            let depth = project(&camera, DVec3::new(0.0, 0.0, z)).z;
            assert!((depth - expected).abs() < 1e-12, "depth {depth} at z {z}");
        }
    }

    #[test]
    fn orthographic_depth_falls_from_one_to_zero() {
        let projection = Projection::Orthographic { height: 2.0 };
        let camera = Camera {
            near: 1.0,
            far: 5.0,
            projection,
            ..Camera::default()
        };
        for (z, expected) in [(2.0, 1.0), (0.0, 0.5), (-2.0, 0.0)] {
            let depth = project(&camera, DVec3::new(0.0, 0.0, z)).z;
            assert!((depth - expected).abs() < 1e-12, "depth {depth} at z {z}");
        }
        let corner = project(&camera, DVec3::new(2.0, 1.0, 0.0));
        assert!(
            (corner.truncate() - glam::DVec2::ONE).length() < 1e-12,
            "{corner}"
        );
    }

    #[test]
    fn switching_the_projection_keeps_the_size_at_the_pivot() {
        let camera = Camera::default();
        let there = camera.with_projection_switched(0.5);
        let back = there.with_projection_switched(0.3);
        assert!((there.height_at_pivot() - camera.height_at_pivot()).abs() < 1e-12);
        assert!((back.height_at_pivot() - camera.height_at_pivot()).abs() < 1e-12);
        assert_eq!(back.projection, Projection::Perspective { fov_y_rad: 0.3 });
    }

    #[test]
    fn looking_along_up_still_gives_orthonormal_axes() {
        let camera = Camera {
            eye: DVec3::Y,
            ..Camera::default()
        };
        let [right, up, back] = camera.axes_world();
        assert!((right.cross(up) - back).length() < 1e-12 && right.is_normalized());
    }
}
