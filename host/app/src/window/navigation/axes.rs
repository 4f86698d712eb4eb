//! The axes to look from, and the one that points upwards.

use glam::DVec3;
use pointstage_scene::Camera;

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
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum UpAxis {
    /// Models.
    #[default]
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

    /// The name in menus.
    pub(crate) fn name(self) -> &'static str {
        let mut named = Self::ALL.into_iter();
        named
            .find(|(axis, _)| *axis == self)
            .map_or("", |(_, name)| name)
    }

    /// From the pivot towards this end, in a scene with `up` upwards; unit.
    pub(crate) fn direction(self, up: UpAxis) -> DVec3 {
        let [front, right, top] = up.scene_axes();
        match self {
            Self::Front => front,
            Self::Back => -front,
            Self::Right => right,
            Self::Left => -right,
            Self::Top => top,
            Self::Bottom => -top,
        }
    }
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

    /// The axis that is the camera's up; `None` for a tilted horizon.
    pub(crate) fn exactly(camera: &Camera) -> Option<Self> {
        let axis = Self::of(camera);
        // 1e-6 rad: what rounding leaves of a way back to level.
        (camera.up.angle_between(axis.direction()) < 1e-6).then_some(axis)
    }

    /// Upwards.
    pub(crate) fn direction(self) -> DVec3 {
        let [_, _, up] = self.scene_axes();
        up
    }

    /// Front, right and up.
    pub(super) fn scene_axes(self) -> [DVec3; 3] {
        match self {
            Self::Y => [DVec3::Z, DVec3::X, DVec3::Y],
            Self::Z => [DVec3::NEG_Y, DVec3::X, DVec3::Z],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_end_has_a_name_and_a_direction_of_its_own() {
        for up in [UpAxis::Y, UpAxis::Z] {
            let sum: DVec3 = Axis::ALL.iter().map(|(axis, _)| axis.direction(up)).sum();
            assert_eq!(sum, DVec3::ZERO);
            assert_eq!(Axis::Top.direction(up), up.direction());
        }
        assert_eq!(Axis::Bottom.name(), "Bottom");
    }

    #[test]
    fn a_tilted_horizon_has_no_axis() {
        let mut camera = Camera::default();
        assert_eq!(UpAxis::exactly(&camera), Some(UpAxis::Y));
        camera.orbit_free(0.0, 0.0, 0.1);
        assert_eq!(UpAxis::exactly(&camera), None);
        assert_eq!(UpAxis::of(&camera), UpAxis::Y);
    }
}
