//! One move of the camera, and how it changes the camera.

use glam::DVec3;
use pointstage_scene::{Bounds, Camera, NearClipping, Projection};

use super::{Axis, NavigationOptions, UpAxis};

/// A turn of this many radians goes with a drag across the picture's height: half a turn.
const RADIANS_PER_HEIGHT: f64 = std::f64::consts::PI;

/// Looking around while flying turns by this much a picture height, radians: a quarter turn, since the whole picture moves.
const LOOK_RADIANS_PER_HEIGHT: f64 = std::f64::consts::FRAC_PI_2;

/// Height of the picture at the pivot below which zooming in stops, as a part of the scene's radius: at a hundred
/// thousandth f32 positions have no finer detail to show.
const CLOSEST: f64 = 1e-5;

/// Height beyond which zooming out stops, as a multiple of the scene's radius.
const FARTHEST: f64 = 1e3;

/// Angle of view for scenes seen in perspective again, radians: 40°.
const DEFAULT_FOV_RAD: f64 = 0.698_132;

/// One move of the camera. Lengths are picture heights unless said otherwise, x right and y up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum CameraMove {
    /// Turn around the pivot as if the scene were dragged this far.
    Drag {
        /// To the right, picture heights.
        right: f64,
        /// Upwards, picture heights.
        up: f64,
    },
    /// Turn the picture, in a scene that turns freely.
    Roll {
        /// Clockwise, radians.
        roll_rad: f64,
    },
    /// Turn the eye around the pivot.
    Turn {
        /// To its right, radians.
        yaw_rad: f64,
        /// Upwards, radians.
        pitch_rad: f64,
    },
    /// Shift the scene in the picture's plane.
    Pan {
        /// To the right, picture heights.
        right: f64,
        /// Upwards, picture heights.
        up: f64,
    },
    /// See `factor` times as much, keeping what is under the pointer there.
    Zoom {
        /// Below 1 comes closer.
        factor: f64,
        /// The pointer right of the picture's middle, picture heights.
        right: f64,
        /// The pointer above the picture's middle, picture heights.
        up: f64,
    },
    /// Look around from the eye as the pointer goes.
    Look {
        /// To the right, picture heights.
        right: f64,
        /// Upwards, picture heights.
        up: f64,
    },
    /// Move the eye along the picture's axes; radii of the scene.
    Fly {
        /// To the right.
        right: f64,
        /// Upwards.
        up: f64,
        /// Into the picture.
        forward: f64,
    },
    /// Show the whole scene.
    Frame,
    /// Show what is selected, or the whole scene if nothing is.
    FrameSelection,
    /// Look at the scene from an axis' end.
    Axis(Axis),
    /// Let another axis point upwards; the scene stands up.
    Upwards(UpAxis),
    /// Let the horizon be level, without moving the eye.
    Level(UpAxis),
    /// Look at a point of the world, and turn around it from then on.
    PivotAt(DVec3),
    /// Perspective becomes orthographic and the reverse.
    SwitchProjection,
}

/// What a move depends on beside the camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Surroundings {
    /// The scene's box in the world.
    pub(crate) bounds: Bounds,
    /// The part of it that a view of the whole shows: without points that stray far from all others.
    pub(crate) framed: Bounds,
    /// The box to show of what is selected; empty if nothing is.
    pub(crate) selection: Bounds,
    /// The picture's width over its height.
    pub(crate) aspect: f64,
    /// Whether the horizon stays level.
    pub(crate) turntable: bool,
    /// Whether the camera flies to other views.
    pub(crate) flights: bool,
    /// The axis that points upwards where the camera's own horizon is tilted.
    pub(crate) up_axis: UpAxis,
    /// What decides where the near plane stands.
    pub(crate) near: NearClipping,
}

impl Default for Surroundings {
    /// No scene, the default habits; without flights.
    fn default() -> Self {
        Self {
            bounds: Bounds::EMPTY,
            framed: Bounds::EMPTY,
            selection: Bounds::EMPTY,
            aspect: 1.5,
            turntable: NavigationOptions::default().turntable,
            flights: false,
            up_axis: UpAxis::default(),
            near: NearClipping::Automatic,
        }
    }
}

impl Surroundings {
    /// A scene from −1 to 1, for tests.
    #[cfg(test)]
    pub(crate) fn of_unit_scene() -> Self {
        Self {
            bounds: Bounds::new(DVec3::splat(-1.0), DVec3::splat(1.0)),
            framed: Bounds::new(DVec3::splat(-1.0), DVec3::splat(1.0)),
            ..Self::default()
        }
    }

    /// The radius of what a view of the whole shows; 1 if there is none.
    fn radius(&self) -> f64 {
        let radius = self.framed.sphere_radius();
        if radius > 0.0 { radius } else { 1.0 }
    }

    /// The axis that points upwards.
    fn up_of(&self, camera: &Camera) -> UpAxis {
        UpAxis::exactly(camera).unwrap_or(self.up_axis)
    }
}

impl CameraMove {
    /// Whether the move leads to a view of its own, which the camera may fly to; the others follow the hand.
    pub(crate) fn is_journey(self) -> bool {
        matches!(
            self,
            Self::Frame
                | Self::FrameSelection
                | Self::Axis(_)
                | Self::Upwards(_)
                | Self::Level(_)
                | Self::PivotAt(_)
                | Self::SwitchProjection
        )
    }

    /// Carries the move out.
    pub(crate) fn apply(self, camera: &mut Camera, around: &Surroundings) {
        match self {
            Self::Drag { right, up } => {
                let [yaw_rad, pitch_rad] = [right, up].map(|way| -way * RADIANS_PER_HEIGHT);
                turn(camera, around, yaw_rad, pitch_rad);
            }
            Self::Turn { yaw_rad, pitch_rad } => turn(camera, around, yaw_rad, pitch_rad),
            Self::Roll { roll_rad } if !around.turntable => camera.orbit_free(0.0, 0.0, roll_rad),
            Self::Roll { .. } => {}
            Self::Pan { right, up } => camera.pan(-right, -up),
            Self::Zoom { factor, right, up } => zoom_to(camera, around, factor, [right, up]),
            Self::Look { right, up } => look(camera, around, right, up),
            Self::Fly { right, up, forward } => {
                let radius = around.radius();
                camera.fly(right * radius, up * radius, forward * radius);
            }
            Self::Frame => camera.frame(&around.framed, around.aspect),
            Self::FrameSelection if around.selection.is_empty() => {
                camera.frame(&around.framed, around.aspect);
            }
            Self::FrameSelection => camera.frame(&around.selection, around.aspect),
            Self::Axis(axis) => look_from(camera, around, axis),
            Self::Upwards(axis) => set_up(camera, around, axis),
            Self::Level(axis) => camera.level(axis.direction()),
            Self::PivotAt(point) => camera.look_at(point),
            Self::SwitchProjection => {
                *camera = camera.with_projection_switched(DEFAULT_FOV_RAD);
            }
        }
        camera.fit_depth_clipped(&around.bounds, around.near);
    }
}

fn turn(camera: &mut Camera, around: &Surroundings, yaw_rad: f64, pitch_rad: f64) {
    if around.turntable {
        camera.orbit_turntable(yaw_rad, pitch_rad);
    } else {
        camera.orbit_free(yaw_rad, pitch_rad, 0.0);
    }
}

/// The line of sight follows the pointer. An orthographic eye, which is nowhere in particular, goes around the pivot.
fn look(camera: &mut Camera, around: &Surroundings, right: f64, up: f64) {
    let [yaw_rad, pitch_rad] = [right, up].map(|way| way * LOOK_RADIANS_PER_HEIGHT);
    match (camera.projection, around.turntable) {
        (Projection::Orthographic { .. }, _) => turn(camera, around, -yaw_rad, -pitch_rad),
        (Projection::Perspective { .. }, true) => camera.look_level(yaw_rad, pitch_rad),
        (Projection::Perspective { .. }, false) => camera.look_free(yaw_rad, pitch_rad),
    }
}

/// The plane through the pivot keeps its point under the pointer:
/// pivot' + pointer·height' = pivot + pointer·height, with height' = factor·height.
fn zoom_to(camera: &mut Camera, around: &Surroundings, factor: f64, pointer_heights: [f64; 2]) {
    let radius = around.bounds.sphere_radius();
    let height = camera.height_at_pivot();
    let limits = if around.bounds.is_empty() || radius <= 0.0 {
        [0.0, f64::INFINITY]
    } else {
        [CLOSEST * around.radius(), FARTHEST * radius]
    };
    // A camera that stands outside the limits already may come back, but not go on.
    let wanted = (height * factor).clamp(limits[0].min(height), limits[1].max(height));
    let factor = wanted / height;
    if !(factor.is_finite() && factor > 0.0) {
        return;
    }
    camera.dolly(factor);
    let shift = 1.0 / factor - 1.0;
    camera.pan(pointer_heights[0] * shift, pointer_heights[1] * shift);
}

/// The camera turns around its pivot to an axis' end, as far as the turntable goes.
fn look_from(camera: &mut Camera, around: &Surroundings, axis: Axis) {
    let up_axis = around.up_of(camera);
    let [front, _, up] = up_axis.scene_axes();
    let towards_eye = match axis {
        Axis::Top | Axis::Bottom => front,
        _ => axis.direction(up_axis),
    };
    let distance = camera.distance();
    camera.up = up;
    camera.eye = camera.pivot + towards_eye * distance;
    let quarter_turn = std::f64::consts::FRAC_PI_2;
    match axis {
        Axis::Top => camera.orbit_turntable(0.0, quarter_turn),
        Axis::Bottom => camera.orbit_turntable(0.0, -quarter_turn),
        _ => {}
    }
}

fn set_up(camera: &mut Camera, around: &Surroundings, axis: UpAxis) {
    let before = around.up_of(camera).scene_axes();
    let after = axis.scene_axes();
    let offset = camera.eye - camera.pivot;
    // The eye keeps its place relative to front, right and up, so the view stays as it was, of a scene that stands up.
    camera.eye = camera.pivot
        + (0..3)
            .map(|axis| after[axis] * offset.dot(before[axis]))
            .sum::<DVec3>();
    camera.level(after[2]);
}

/// The angle of view in degrees, if the camera has one.
pub(crate) fn fov_degrees(camera: &Camera) -> Option<f64> {
    match camera.projection {
        Projection::Perspective { fov_y_rad } => Some(fov_y_rad.to_degrees()),
        Projection::Orthographic { .. } => None,
    }
}

#[cfg(test)]
#[path = "moves_tests.rs"]
mod tests;
