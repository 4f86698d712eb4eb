//! A triangle on the screen, perspective-correct, by homogeneous edge functions: also one that crosses the eye's plane needs no
//! clipping.
//!
//! source  M. Olano, T. Greer, Triangle Scan Conversion using 2D Homogeneous Coordinates, Graphics Hardware 1997

use pointstage_plugin_api::glam::{DMat3, DVec2, DVec3, DVec4, Vec4Swizzles as _};
use pointstage_plugin_api::twin::camera::Camera;

/// One corner.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Corner {
    /// View space.
    pub(crate) position: DVec3,
    /// View space, unit; zero if it is not known.
    pub(crate) normal: DVec3,
    /// Linear.
    pub(crate) colour: DVec3,
}

/// One triangle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Triangle {
    /// Least sample position that it may reach.
    pub(crate) lower: DVec2,
    /// Greatest sample position that it may reach.
    pub(crate) upper: DVec2,
    origin: DVec2,
    /// Maps (x, y, 1), offset from the origin, to the corners' shares over w.
    shares_over_w: DMat3,
    clip_z: DVec3,
    clip_w: DVec3,
    corners: [Corner; 3],
}

/// A point of the triangle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hit {
    /// Reversed.
    pub(crate) depth: f64,
    /// Of the corners; they sum to 1.
    pub(crate) shares: DVec3,
}

impl Triangle {
    /// None if nothing of it can be seen: behind the eye, without an area on the screen, or not finite.
    pub(crate) fn new(camera: &Camera, corners: [Corner; 3]) -> Option<Self> {
        let clips = corners.map(|corner| camera.clip_from_view(corner.position));
        let is_in_front = |clip: &DVec4| clip.z <= clip.w;
        if !clips.iter().any(is_in_front) {
            return None;
        }
        let size = camera.tile_size_px;
        let (mut lower, mut upper) = (DVec2::ZERO, size);
        if clips.iter().all(is_in_front) {
            let places = clips.map(|clip| camera.pixel_from_clip(clip));
            lower = places[0].min(places[1]).min(places[2]);
            upper = places[0].max(places[1]).max(places[2]);
        }
        let origin = (0.5 * (lower + upper)).clamp(DVec2::ZERO, size);
        // Sample position times w, relative to the origin.
        let row = |clip: DVec4| {
            let place = (0.5 * clip.w + DVec2::new(0.5, -0.5) * clip.xy()) * size;
            (place - origin * clip.w).extend(clip.w)
        };
        let matrix = DMat3::from_cols(row(clips[0]), row(clips[1]), row(clips[2]));
        let is_flat = matrix.determinant() == 0.0;
        let shares_over_w = matrix.inverse();
        let is_usable = !is_flat && shares_over_w.is_finite() && origin.is_finite();
        is_usable.then_some(Self {
            lower,
            upper,
            origin,
            shares_over_w,
            clip_z: DVec3::new(clips[0].z, clips[1].z, clips[2].z),
            clip_w: DVec3::new(clips[0].w, clips[1].w, clips[2].w),
            corners,
        })
    }

    /// The point that the sample position sees, if it does.
    pub(crate) fn hit(&self, position: DVec2) -> Option<Hit> {
        let over_w = self.shares_over_w * (position - self.origin).extend(1.0);
        let sum = over_w.element_sum();
        let is_inside = over_w.min_element() >= 0.0 && sum > 0.0;
        if !is_inside {
            return None;
        }
        let shares = over_w / sum;
        let depth = shares.dot(self.clip_z) / shares.dot(self.clip_w);
        (depth > 0.0 && depth <= 1.0).then_some(Hit { depth, shares })
    }

    /// Linear colour at a point.
    pub(crate) fn colour(&self, hit: &Hit) -> DVec3 {
        self.mean(hit, |corner| corner.colour)
    }

    /// Unit normal at a point, view space: of the corners, else of the plane by the winding.
    pub(crate) fn normal(&self, hit: &Hit) -> DVec3 {
        let [a, b, c] = self.corners.map(|corner| corner.position);
        let plane = (b - a).cross(c - a);
        let mean = self.mean(hit, |corner| corner.normal);
        mean.try_normalize()
            .or_else(|| plane.try_normalize())
            .unwrap_or(DVec3::Z)
    }

    fn mean(&self, hit: &Hit, of: impl Fn(&Corner) -> DVec3) -> DVec3 {
        let [a, b, c] = &self.corners;
        hit.shares.x * of(a) + hit.shares.y * of(b) + hit.shares.z * of(c)
    }
}

impl Hit {
    /// The corner with the greatest share.
    pub(crate) fn nearest_corner(&self) -> usize {
        let [a, b, c] = self.shares.to_array();
        if a >= b && a >= c {
            0
        } else if b >= c {
            1
        } else {
            2
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_camera::perspective;

    fn corner(position: DVec3) -> Corner {
        Corner {
            position,
            normal: DVec3::ZERO,
            colour: position,
        }
    }

    #[test]
    fn a_hit_is_the_point_where_the_ray_meets_the_plane() {
        let camera = perspective();
        let corners = [
            DVec3::new(-1.0, -1.0, -2.0),
            DVec3::new(2.0, -1.0, -6.0),
            DVec3::new(0.0, 2.0, -3.0),
        ];
        let triangle = Triangle::new(&camera, corners.map(corner)).expect("it is in view");
        let position = DVec2::new(48.3, 51.1);
        let hit = triangle.hit(position).expect("inside");
        let (origin, direction) = camera.ray(position);
        let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        let t = (corners[0] - origin).dot(normal) / direction.dot(normal);
        let expected = origin + t * direction;
        assert!(triangle.colour(&hit).abs_diff_eq(expected, 1e-9));
        assert!(triangle.normal(&hit).abs_diff_eq(normal.normalize(), 1e-12));
        let clip = camera.clip_from_view(expected);
        assert!((hit.depth - clip.z / clip.w).abs() < 1e-12);
    }

    #[test]
    fn a_corner_behind_the_eye_leaves_the_rest_in_place() {
        let camera = perspective();
        // A floor that runs under the eye to behind it.
        let corners = [
            DVec3::new(-50.0, -1.0, 5.0),
            DVec3::new(50.0, -1.0, 5.0),
            DVec3::new(0.0, -1.0, -100.0),
        ];
        let triangle = Triangle::new(&camera, corners.map(corner)).expect("it is in view");
        let size = camera.tile_size_px;
        let below = triangle
            .hit(DVec2::new(0.5, 0.9) * size)
            .expect("the floor");
        let (_, direction) = camera.ray(DVec2::new(0.5, 0.9) * size);
        let expected = direction / -direction.y;
        assert!(triangle.colour(&below).abs_diff_eq(expected, 1e-9));
        assert!(triangle.hit(DVec2::new(0.5, 0.2) * size).is_none(), "sky");
    }
}
