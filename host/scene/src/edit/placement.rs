//! Where an object stands, in numbers that people edit.

use glam::{DAffine3, DMat3, DQuat, DVec3, EulerRot};

/// How far a matrix may be from a rotation times a scale to count as one, as a part of the scale.
const TOLERANCE: f64 = 1e-6;

/// A turn and a scale about a pivot, then a move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// How far the pivot is moved, scene units.
    pub translation: DVec3,
    /// Turns about the x, y and z axis of the object, degrees: first z, then y, then x.
    pub rotation_degrees: DVec3,
    /// Factor on all lengths, above 0.
    pub scale: f64,
}

impl Default for Placement {
    /// As in the file.
    fn default() -> Self {
        Self {
            translation: DVec3::ZERO,
            rotation_degrees: DVec3::ZERO,
            scale: 1.0,
        }
    }
}

impl Placement {
    /// The placement that a map makes, about `pivot` in the object's coordinates; `None` for maps that shear, mirror, flatten
    /// or stretch in one direction more than in another.
    pub fn of(world_from_object: &DAffine3, pivot: DVec3) -> Option<Self> {
        let matrix = world_from_object.matrix3;
        let scale = matrix.determinant().cbrt();
        if !(scale > 0.0 && scale.is_finite()) {
            return None;
        }
        let rotation = matrix * scale.recip();
        let off = rotation * rotation.transpose() - DMat3::IDENTITY;
        if !off.to_cols_array().iter().all(|off| off.abs() < TOLERANCE) {
            return None;
        }
        let (x, y, z) = DQuat::from_mat3(&rotation)
            .normalize()
            .to_euler(EulerRot::XYZ);
        Some(Self {
            translation: world_from_object.transform_point3(pivot) - pivot,
            // Adding 0 leaves no −0, which people would see.
            rotation_degrees: DVec3::new(x, y, z).map(f64::to_degrees) + 0.0,
            scale,
        })
    }

    /// The map that it makes.
    pub fn world_from_object(&self, pivot: DVec3) -> DAffine3 {
        if *self == Self::default() {
            return DAffine3::IDENTITY;
        }
        let turns = self.rotation_degrees.map(f64::to_radians);
        let rotation = DQuat::from_euler(EulerRot::XYZ, turns.x, turns.y, turns.z);
        let matrix3 = DMat3::from_quat(rotation) * self.scale;
        DAffine3 {
            matrix3,
            translation: pivot + self.translation - matrix3 * pivot,
        }
    }

    /// Whether it makes a map: all numbers are finite and the scale is above 0.
    pub fn is_valid(&self) -> bool {
        self.translation.is_finite()
            && self.rotation_degrees.is_finite()
            && self.scale.is_finite()
            && self.scale > 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn the_pivot_stays_where_it_is_turned_and_scaled_about() {
        let pivot = DVec3::new(500_000.0, 4_900_000.0, 12.0);
        let placement = Placement {
            translation: DVec3::new(1.0, 2.0, 3.0),
            rotation_degrees: DVec3::new(0.0, 0.0, 90.0),
            scale: 2.0,
        };
        let map = placement.world_from_object(pivot);
        let moved = map.transform_point3(pivot) - pivot;
        assert!(moved.distance(placement.translation) < 1e-8, "{moved}");
        let beside = map.transform_point3(pivot + DVec3::X) - map.transform_point3(pivot);
        assert!(
            beside.distance(DVec3::Y * 2.0) < 1e-8,
            "a turn about z takes x to y: {beside}"
        );
    }

    #[test]
    fn shears_mirrors_and_flat_maps_are_no_placements() {
        for diagonal in [
            DVec3::new(1.0, 2.0, 1.0),
            DVec3::new(-1.0, 1.0, 1.0),
            DVec3::new(0.0, 1.0, 1.0),
            DVec3::NAN,
        ] {
            let map = DAffine3::from_scale(diagonal);
            assert_eq!(Placement::of(&map, DVec3::ZERO), None, "{diagonal}");
        }
    }

    #[test]
    fn the_file_s_own_place_is_the_identity_to_the_last_bit() {
        let pivot = DVec3::new(0.1, 0.2, 0.3);
        let map = Placement::default().world_from_object(pivot);
        assert_eq!(map, DAffine3::IDENTITY);
        assert_eq!(Placement::of(&map, pivot), Some(Placement::default()));
    }

    proptest! {
        #[test]
        fn a_placement_and_its_map_are_the_same(
            translation in [-1e4..1e4f64, -1e4..1e4, -1e4..1e4], turns in [-180.0..180.0f64, -90.0..90.0, -180.0..180.0],
            scale in 1e-3..1e3f64, pivot in [-1e3..1e3f64, -1e3..1e3, -1e3..1e3],
        ) {
            let (translation, pivot) = (DVec3::from(translation), DVec3::from(pivot));
            let placement = Placement { translation, rotation_degrees: turns.into(), scale };
            let map = placement.world_from_object(pivot);
            let back = Placement::of(&map, pivot).expect("a turn and a scale");
            let again = back.world_from_object(pivot);
            // Angles may be other ones for the same turn; the map is what counts. 1e-6 of lengths up to 1e6.
            let corner = pivot + DVec3::ONE;
            let distance = map.transform_point3(corner).distance(again.transform_point3(corner));
            prop_assert!(distance < 1e-6 * scale.max(1.0), "{distance}: {placement:?} became {back:?}");
            prop_assert!((back.scale / scale - 1.0).abs() < 1e-9);
        }
    }
}
