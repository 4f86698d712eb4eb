//! How the camera moves: gestures and keys as moves, and moves as changes of the camera.

use pointstage_scene::{Bounds, Camera, Projection};

/// A turn of this many radians goes with a drag across the picture's height: half a turn.
const RADIANS_PER_HEIGHT: f64 = std::f64::consts::PI;

/// One arrow key turns by 5°.
pub(crate) const KEY_TURN_RAD: f64 = 0.087_266;

/// Height of the picture at the pivot below which zooming in stops, as a part of the scene's radius: at a hundred
/// thousandth f32 positions have no finer detail to show.
const CLOSEST: f64 = 1e-5;

/// Height beyond which zooming out stops, as a multiple of the scene's radius.
const FARTHEST: f64 = 1e3;

/// Angle of view for scenes seen in perspective again, radians: 40°.
const DEFAULT_FOV_RAD: f64 = 0.698_132;

/// One move of the camera. Lengths are picture heights, x right and y up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum CameraMove {
    /// Turn around the pivot as if the scene were dragged this far.
    Drag {
        /// To the right, picture heights.
        right: f64,
        /// Upwards, picture heights.
        up: f64,
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
    /// Show the whole scene.
    Frame,
    /// Look at the scene from an axis' end.
    Axis(Axis),
    /// Let another axis point upwards.
    Upwards(UpAxis),
    /// Perspective becomes orthographic and the reverse.
    SwitchProjection,
}

/// An end of an axis, to look from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Axis {
    /// From the scene's right, +x of a scene with y up.
    Right,
    /// From its left.
    Left,
    /// From above.
    Top,
    /// From below.
    Bottom,
    /// From the front.
    Front,
    /// From behind.
    Back,
}

/// The axis that points upwards.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum UpAxis {
    /// Models.
    Y,
    /// Maps and many scanners.
    Z,
}

impl Axis {
    /// All, with their names in menus.
    pub(crate) const ALL: [(Self, &'static str); 6] = [
        (Self::Front, "Front"),
        (Self::Back, "Back"),
        (Self::Left, "Left"),
        (Self::Right, "Right"),
        (Self::Top, "Top"),
        (Self::Bottom, "Bottom"),
    ];
}

impl UpAxis {
    /// The axis that is nearest to the camera's up.
    pub(crate) fn of(camera: &Camera) -> Self {
        if camera.up.z.abs() > camera.up.y.abs() {
            Self::Z
        } else {
            Self::Y
        }
    }
}

impl CameraMove {
    /// Carries the move out. `bounds` is the scene's box in the world, `aspect` the picture's width over its height.
    pub(crate) fn apply(self, camera: &mut Camera, bounds: &Bounds, aspect: f64) {
        match self {
            Self::Drag { right, up } => {
                camera.orbit_turntable(-right * RADIANS_PER_HEIGHT, -up * RADIANS_PER_HEIGHT);
            }
            Self::Turn { yaw_rad, pitch_rad } => camera.orbit_turntable(yaw_rad, pitch_rad),
            Self::Pan { right, up } => camera.pan(-right, -up),
            Self::Zoom { factor, right, up } => zoom_to(camera, bounds, factor, [right, up]),
            Self::Frame => camera.frame(bounds, aspect),
            Self::Axis(axis) => look_from(camera, axis),
            Self::Upwards(axis) => set_up(camera, axis),
            Self::SwitchProjection => {
                *camera = camera.with_projection_switched(DEFAULT_FOV_RAD);
            }
        }
        camera.fit_depth(bounds);
    }
}

/// The plane through the pivot keeps its point under the pointer:
/// pivot' + pointer·height' = pivot + pointer·height, with height' = factor·height.
fn zoom_to(camera: &mut Camera, bounds: &Bounds, factor: f64, pointer_heights: [f64; 2]) {
    let radius = bounds.sphere_radius();
    let height = camera.height_at_pivot();
    let limits = if bounds.is_empty() || radius <= 0.0 {
        [0.0, f64::INFINITY]
    } else {
        [CLOSEST * radius, FARTHEST * radius]
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
fn look_from(camera: &mut Camera, axis: Axis) {
    let [front, right, up] = scene_axes(UpAxis::of(camera));
    let distance = camera.distance();
    let towards_eye = match axis {
        Axis::Front | Axis::Top | Axis::Bottom => front,
        Axis::Back => -front,
        Axis::Right => right,
        Axis::Left => -right,
    };
    camera.up = up;
    camera.eye = camera.pivot + towards_eye * distance;
    let quarter_turn = std::f64::consts::FRAC_PI_2;
    match axis {
        Axis::Top => camera.orbit_turntable(0.0, quarter_turn),
        Axis::Bottom => camera.orbit_turntable(0.0, -quarter_turn),
        _ => {}
    }
}

fn set_up(camera: &mut Camera, axis: UpAxis) {
    let before = scene_axes(UpAxis::of(camera));
    let after = scene_axes(axis);
    let offset = camera.eye - camera.pivot;
    // The eye keeps its place relative to front, right and up, so the view stays as it was, of a scene that stands up.
    camera.eye = camera.pivot
        + (0..3)
            .map(|axis| after[axis] * offset.dot(before[axis]))
            .sum::<glam::DVec3>();
    camera.up = after[2];
}

/// Front, right and up.
fn scene_axes(up: UpAxis) -> [glam::DVec3; 3] {
    use glam::DVec3;
    match up {
        UpAxis::Y => [DVec3::Z, DVec3::X, DVec3::Y],
        UpAxis::Z => [DVec3::NEG_Y, DVec3::X, DVec3::Z],
    }
}

/// The angle of view in degrees, if the camera has one.
pub(crate) fn fov_degrees(camera: &Camera) -> Option<f64> {
    match camera.projection {
        Projection::Perspective { fov_y_rad } => Some(fov_y_rad.to_degrees()),
        Projection::Orthographic { .. } => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DVec2, DVec3};

    const ASPECT: f64 = 1.5;

    fn bounds() -> Bounds {
        Bounds::new(DVec3::splat(-1.0), DVec3::splat(1.0))
    }

    fn framed() -> Camera {
        let mut camera = Camera::default();
        CameraMove::Frame.apply(&mut camera, &bounds(), ASPECT);
        camera
    }

    /// Where a world point appears, picture heights from the middle.
    fn seen_at(camera: &Camera, world: DVec3) -> DVec2 {
        let clip_from_world = camera.clip_from_view(ASPECT) * camera.view_from_world();
        let ndc = clip_from_world.project_point3(world);
        DVec2::new(ndc.x * ASPECT, ndc.y) * 0.5
    }

    #[test]
    fn zooming_keeps_what_is_under_the_pointer() {
        let mut camera = framed();
        let [right, up, _] = camera.axes_world();
        let point = camera.pivot + right * 0.4 + up * 0.3;
        let before = seen_at(&camera, point);
        let zoom = CameraMove::Zoom {
            factor: 0.5,
            right: before.x,
            up: before.y,
        };
        zoom.apply(&mut camera, &bounds(), ASPECT);
        let after = seen_at(&camera, point);
        assert!((after - before).length() < 1e-9, "{before} became {after}");
    }

    #[test]
    fn zooming_stops_before_the_numbers_do() {
        let mut camera = framed();
        let zoom = |factor| CameraMove::Zoom {
            factor,
            right: 0.2,
            up: 0.1,
        };
        for _ in 0..2000 {
            zoom(0.8).apply(&mut camera, &bounds(), ASPECT);
        }
        assert!(camera.height_at_pivot() > 1e-6, "{camera:?}");
        for _ in 0..2000 {
            zoom(1.25).apply(&mut camera, &bounds(), ASPECT);
        }
        assert!(
            camera.height_at_pivot() < 1e4 && camera.eye.is_finite(),
            "{camera:?}"
        );
    }

    #[test]
    fn the_scene_follows_a_pan() {
        let mut camera = framed();
        let pan = CameraMove::Pan {
            right: 0.25,
            up: -0.125,
        };
        pan.apply(&mut camera, &bounds(), ASPECT);
        let seen = seen_at(&camera, DVec3::ZERO);
        assert!((seen - DVec2::new(0.25, -0.125)).length() < 1e-9, "{seen}");
    }

    #[test]
    fn what_is_in_front_follows_a_drag() {
        let mut camera = framed();
        let front = camera.pivot + camera.axes_world()[2];
        CameraMove::Drag {
            right: 0.05,
            up: 0.05,
        }
        .apply(&mut camera, &bounds(), ASPECT);
        let seen = seen_at(&camera, front);
        assert!(seen.x > 0.0 && seen.y > 0.0, "{seen}");
    }

    #[test]
    fn axis_views_look_from_where_they_say() {
        let cases = [
            (Axis::Right, DVec3::X),
            (Axis::Left, DVec3::NEG_X),
            (Axis::Top, DVec3::Y),
            (Axis::Bottom, DVec3::NEG_Y),
            (Axis::Front, DVec3::Z),
            (Axis::Back, DVec3::NEG_Z),
        ];
        for (axis, towards_eye) in cases {
            let mut camera = framed();
            CameraMove::Axis(axis).apply(&mut camera, &bounds(), ASPECT);
            let found = (camera.eye - camera.pivot).normalize();
            // The turntable stops 0.1° before the poles.
            assert!(
                found.angle_between(towards_eye) < 0.002,
                "{axis:?}: {found}"
            );
        }
    }

    #[test]
    fn a_map_stands_up_when_z_points_upwards() {
        let mut camera = framed();
        CameraMove::Upwards(UpAxis::Z).apply(&mut camera, &bounds(), ASPECT);
        assert_eq!(UpAxis::of(&camera), UpAxis::Z);
        let seen = seen_at(&camera, camera.pivot + DVec3::Z);
        assert!(seen.y > 0.0 && seen.x.abs() < 1e-9, "{seen}");
        CameraMove::Axis(Axis::Top).apply(&mut camera, &bounds(), ASPECT);
        let from = (camera.eye - camera.pivot).normalize();
        assert!(from.z > 0.99, "{from}");
    }
}
