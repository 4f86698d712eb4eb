//! The part of the picture that an object's splats can reach: shading goes over it, not over the whole picture.

use pointstage_plugin_api::glam::{DVec2, DVec3, Mat4};
use pointstage_plugin_api::twin::camera::Camera;
use pointstage_plugin_api::{Draw, DrawFlags, Frame};

/// Whole pixels: a corner and a size.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PixelRectangle {
    /// First column and row.
    pub origin: [u32; 2],
    /// Columns and rows.
    pub size: [u32; 2],
}

impl PixelRectangle {
    /// What both hold.
    #[must_use]
    pub fn common(self, other: Self) -> Self {
        let end = |rectangle: Self, axis: usize| rectangle.origin[axis] + rectangle.size[axis];
        let origin = [0, 1].map(|axis| self.origin[axis].max(other.origin[axis]));
        let size = [0, 1].map(|axis| {
            let end = end(self, axis).min(end(other, axis));
            end.saturating_sub(origin[axis])
        });
        Self { origin, size }
    }
}

/// Where the splats of a draw's object can be; the whole picture if that is not known.
pub(crate) fn rectangle_of(
    frame: &Frame<'_>,
    draw: &Draw<'_>,
    reach_px: Option<f32>,
) -> PixelRectangle {
    let size_px = frame.size_px();
    let whole = PixelRectangle {
        origin: [0, 0],
        size: size_px,
    };
    // A structure's nodes may lie outside the object's bounds.
    let is_own = draw.flags().contains(DrawFlags::NODES);
    match (reach_px, draw.object()) {
        (Some(reach_px), Some(object)) if !is_own => {
            let view_from_object = Mat4::from_cols_array_2d(&draw.uniform().view_from_object);
            let bounds = object.bounds();
            let corners = (0..8).map(|corner| {
                let pick = |axis: usize| bounds[corner >> axis & 1][axis];
                let corner = pointstage_plugin_api::glam::Vec3::new(pick(0), pick(1), pick(2));
                view_from_object.transform_point3(corner).as_dvec3()
            });
            let camera = Camera::from(frame.uniform());
            rectangle_round(&camera, corners, f64::from(reach_px), size_px).unwrap_or(whole)
        }
        _ => whole,
    }
}

/// The rectangle of the projected corners (view space), widened by `reach_px`; none if one is not in front of the eye, or
/// not finite.
fn rectangle_round(
    camera: &Camera,
    corners: impl Iterator<Item = DVec3>,
    reach_px: f64,
    size_px: [u32; 2],
) -> Option<PixelRectangle> {
    let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    for corner in corners {
        let clip = camera.clip_from_view(corner);
        let in_front = clip.w > 0.0 && clip.z <= clip.w;
        let pixel = camera.pixel_from_clip(clip);
        if !in_front || !pixel.is_finite() {
            return None;
        }
        low = low.min(pixel);
        high = high.max(pixel);
    }
    // A pixel more on each side for what is rounded in single precision.
    let size = DVec2::new(f64::from(size_px[0]), f64::from(size_px[1]));
    let low = (low - reach_px - 1.0).floor().clamp(DVec2::ZERO, size);
    let high = (high + reach_px + 1.0).ceil().clamp(DVec2::ZERO, size);
    let (origin, size) = (low.as_uvec2(), (high - low).as_uvec2());
    Some(PixelRectangle {
        origin: origin.to_array(),
        size: size.to_array(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use pointstage_plugin_api::glam::{DMat4, DVec4};

    /// 90 degrees high and wide; near plane at 0.1.
    const CAMERA: Camera = Camera {
        clip_from_view: DMat4::from_cols(
            DVec4::X,
            DVec4::Y,
            DVec4::new(0.0, 0.0, 0.0, -1.0),
            DVec4::new(0.0, 0.0, 0.1, 0.0),
        ),
        tile_size_px: DVec2::new(100.0, 100.0),
        pixels_per_unit: 50.0,
        is_orthographic: false,
    };

    #[test]
    fn corners_in_view_give_their_rectangle_with_the_reach_and_a_pixel() {
        let corners = [DVec3::new(-0.5, 0.0, -1.0), DVec3::new(0.0, 0.5, -1.0)];
        let rectangle = rectangle_round(&CAMERA, corners.into_iter(), 2.0, [100, 100]);
        let expected = PixelRectangle {
            origin: [22, 22],
            size: [31, 31],
        };
        assert_eq!(rectangle, Some(expected));
    }

    #[test]
    fn rectangles_have_in_common_what_both_hold() {
        let of = |origin, size| PixelRectangle { origin, size };
        let common = of([2, 3], [10, 10]).common(of([5, 0], [20, 6]));
        assert_eq!(common, of([5, 3], [7, 3]));
        assert_eq!(of([0, 0], [2, 2]).common(of([5, 0], [2, 2])).size, [0, 2]);
    }

    #[test]
    fn what_is_outside_the_view_leaves_nothing() {
        let corners = [DVec3::new(-9.0, 0.0, -1.0), DVec3::new(-8.0, 0.5, -1.0)];
        let rectangle = rectangle_round(&CAMERA, corners.into_iter(), 2.0, [100, 100]);
        assert_eq!(rectangle.map(|rectangle| rectangle.size[0]), Some(0));
    }

    #[test]
    fn a_corner_behind_the_near_plane_gives_no_rectangle() {
        for z in [0.0, 1.0, -0.05, f64::NAN] {
            let corners = [DVec3::new(0.0, 0.0, -1.0), DVec3::new(0.1, 0.1, z)];
            assert_eq!(
                rectangle_round(&CAMERA, corners.into_iter(), 2.0, [100, 100]),
                None
            );
        }
    }
}
