//! The plane that fits points best.
//!
//! Its normal is the eigenvector of the smallest eigenvalue of the points' covariance (Hoppe et al., *Surface
//! Reconstruction from Unorganized Points*, SIGGRAPH 1992, section 3.2).

use glam::DVec3;

/// Unit normal of the plane through `points`; +z if they fit any plane.
pub(super) fn plane_normal(points: impl Iterator<Item = DVec3> + Clone) -> DVec3 {
    let count = points.clone().count().max(1) as f64;
    let mean = points.clone().sum::<DVec3>() / count;
    // Of the symmetric covariance: xx, yy, zz and xy, xz, yz.
    let (mut square, mut mixed) = (DVec3::ZERO, DVec3::ZERO);
    for point in points {
        let d = point - mean;
        square += d * d;
        mixed += DVec3::new(d.x * d.y, d.x * d.z, d.y * d.z);
    }
    smallest_eigenvector(square, mixed)
}

/// Unit eigenvector of the smallest eigenvalue of the symmetric matrix with diagonal `d` and off-diagonals `o` (xy, xz, yz).
///
/// Eigenvalues by the trigonometric formula (Smith, *Eigenvalues of a symmetric 3 × 3 matrix*, CACM 1961); the vector is
/// the largest cross product of two rows of the matrix less the eigenvalue.
fn smallest_eigenvector(d: DVec3, o: DVec3) -> DVec3 {
    let scale = d.max_element();
    if !(scale > 0.0 && scale.is_finite()) {
        return DVec3::Z;
    }
    let (d, o) = (d / scale, o / scale);
    let mean = d.element_sum() / 3.0;
    let spread = ((d - mean).length_squared() + 2.0 * o.length_squared()) / 6.0;
    let p = spread.sqrt();
    if p < 1e-12 {
        return DVec3::Z;
    }
    let e = (d - mean) / p;
    let f = o / p;
    let half_determinant = 0.5
        * (e.x * (e.y * e.z - f.z * f.z) - f.x * (f.x * e.z - f.z * f.y)
            + f.y * (f.x * f.z - e.y * f.y));
    let angle = half_determinant.clamp(-1.0, 1.0).acos() / 3.0;
    let smallest = mean + 2.0 * p * (angle + std::f64::consts::TAU / 3.0).cos();
    let rows = [
        DVec3::new(d.x - smallest, o.x, o.y),
        DVec3::new(o.x, d.y - smallest, o.z),
        DVec3::new(o.y, o.z, d.z - smallest),
    ];
    let crosses = [
        rows[0].cross(rows[1]),
        rows[0].cross(rows[2]),
        rows[1].cross(rows[2]),
    ];
    let largest = crosses
        .into_iter()
        .max_by(|a, b| a.length_squared().total_cmp(&b.length_squared()))
        .unwrap_or(DVec3::Z);
    // Points on one line: any direction across it.
    let vector = largest
        .try_normalize()
        .filter(|_| largest.length() > 1e-14)
        .unwrap_or_else(|| {
            let along = rows
                .into_iter()
                .max_by(|a, b| a.length_squared().total_cmp(&b.length_squared()))
                .unwrap_or(DVec3::X);
            along
                .try_normalize()
                .map_or(DVec3::Z, |along| along.any_orthonormal_vector())
        });
    // The largest component is positive.
    let sign = if vector
        .to_array()
        .into_iter()
        .max_by(|a, b| a.abs().total_cmp(&b.abs()))
        .unwrap_or(1.0)
        < 0.0
    {
        -1.0
    } else {
        1.0
    };
    vector * sign
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DQuat;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_normal_is_across_a_turned_slab(angle in 0.0..3.0f64, tilt in 0.0..3.0f64, thin in 0.0..0.05f64) {
            let turn = DQuat::from_rotation_x(angle) * DQuat::from_rotation_y(tilt);
            let slab = (0..27).map(|index| {
                let part = |divisor: i32| f64::from(index / divisor % 3) - 1.0;
                turn * DVec3::new(part(1) * 2.0, part(3), part(9) * thin)
            });
            let cosine = plane_normal(slab).dot(turn * DVec3::Z).abs();
            prop_assert!(cosine > 0.9999, "cosine {cosine}");
        }

        #[test]
        fn any_matrix_gives_a_unit_vector(d in proptest::array::uniform3(0.0..1e9f64), o in proptest::array::uniform3(-1e9..1e9f64)) {
            prop_assert!(smallest_eigenvector(d.into(), o.into()).is_normalized());
        }
    }
}
