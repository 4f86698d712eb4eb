//! Which way a mesh is wound: by the sign of its volume, if it has one.

use glam::DVec3;

use super::Orientation;

/// A mesh is taken for closed when its area vectors add up to less than this part of its area. They add up to nothing in a
/// closed mesh, and to all of it in a flat one.
const OPEN_PART: f64 = 0.1;

/// Volume below which a mesh has no inside, as a part of that of a ball of the same area, squared.
const FLAT_PART: f64 = 1e-6;

/// What the triangles add up to as a whole; in scaled units.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Totals {
    /// Six times the signed volume around the box's centre.
    pub(super) volume: f64,
    /// Twice the area.
    pub(super) area: f64,
    /// Twice the sum of area vectors.
    pub(super) area_vector: DVec3,
}

/// The orientation of a mesh by the totals of its parts.
pub(super) fn orientation(parts: &[Totals]) -> Orientation {
    let volume: f64 = parts.iter().map(|part| part.volume / 6.0).sum();
    let area: f64 = parts.iter().map(|part| part.area / 2.0).sum();
    let area_vector: DVec3 = parts.iter().map(|part| part.area_vector / 2.0).sum();
    let is_closed = area_vector.length() < OPEN_PART * area;
    // A ball has 36 π V² = A³.
    let is_thick = 36.0 * std::f64::consts::PI * volume * volume > FLAT_PART * area.powi(3);
    match (is_closed && is_thick, volume < 0.0) {
        (false, _) => Orientation::Unknown,
        (true, true) => Orientation::Inward,
        (true, false) => Orientation::Outward,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Totals of a ball of radius 1, of which `part` of the area is there.
    fn ball(part: f64, sign: f64) -> Totals {
        let area = 4.0 * std::f64::consts::PI * part;
        Totals {
            volume: sign * 2.0 * area,
            area: 2.0 * area,
            area_vector: DVec3::X * 2.0 * area * (1.0 - part),
        }
    }

    #[test]
    fn the_sign_of_the_volume_decides_for_closed_meshes() {
        assert_eq!(orientation(&[ball(1.0, 1.0)]), Orientation::Outward);
        assert_eq!(orientation(&[ball(1.0, -1.0)]), Orientation::Inward);
        assert_eq!(
            orientation(&[ball(1.0, 1.0), ball(1.0, -3.0)]),
            Orientation::Inward
        );
    }

    #[test]
    fn open_and_flat_meshes_have_no_inside() {
        assert_eq!(orientation(&[ball(0.5, -1.0)]), Orientation::Unknown);
        let flat = Totals {
            volume: -1e-4,
            ..ball(1.0, -1.0)
        };
        assert_eq!(orientation(&[flat]), Orientation::Unknown);
        assert_eq!(orientation(&[]), Orientation::Unknown);
    }
}
