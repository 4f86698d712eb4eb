//! Surfels that what is drawn already hides: they are left out before their images are computed.

use super::bins::Reach;
use super::lanes::LANES;
use super::nearest::{NearestBand, depth_of};
use super::surfels::{Stage, Surfels};
use pointstage_plugin_api::glam::Vec4;

/// Up to so many columns and rows of pixels are looked at; for larger splats it would not pay.
const MOST_PIXELS: u32 = 6;

impl Stage<'_> {
    /// Puts those of a draw's surfels into `left` that may be seen in a band, or blend with what is, over what is drawn so far; in
    /// their order. Never too few.
    ///
    /// * `reach`: how far splats reach beyond the surfels' spheres. If that is more than nothing on the screen, depth is taken to
    ///   change by no more than a radius' worth within it.
    #[inline]
    pub fn leave_out_hidden(
        &self,
        surfels: &Surfels<'_>,
        numbers: &[u32],
        reach: Reach,
        band: &NearestBand<'_>,
        left: &mut Vec<u32>,
    ) {
        left.clear();
        let camera = &self.camera;
        for numbers in numbers.chunks(LANES) {
            let (centre_view, radius) = surfels.spheres(numbers);
            let radius = radius * reach.scale;
            let clip = camera.clip_from_view(centre_view);
            let [x, y] = camera.pixel_from_clip(&clip);
            let sphere_px = camera.reach_of_spheres(centre_view, radius);
            let half_px = sphere_px + Vec4::splat(reach.pad_px + 0.02);
            let distance = -centre_view.z;
            let mut nearest = camera.depth_from_eye_distance(distance - radius);
            if reach.pad_px > 0.0 {
                let depth = clip.z / clip.w;
                let change = depth - camera.depth_from_eye_distance(distance + radius);
                // 1.42: to the corners.
                let farthest = half_px * (1.42 / reach.pad_px);
                nearest = nearest.max(depth + change * farthest);
            }
            // Rounding of single precision.
            let nearest = (nearest * 1.000_01).to_array();
            let [x, y, half_px] = [x, y, half_px].map(|lanes| lanes.to_array());
            for (lane, number) in numbers.iter().enumerate().take(LANES) {
                if !band.hides([x[lane], y[lane]], half_px[lane], nearest[lane]) {
                    left.push(*number);
                }
            }
        }
    }
}

impl NearestBand<'_> {
    /// Whether all pixels of the band within a square round a pixel position are nearer than a depth; false if there are many.
    #[inline]
    fn hides(&self, [x, y]: [f32; 2], half_px: f32, depth: f32) -> bool {
        let edge = |edge: f32| (edge + 0.5) as u32;
        let [left, top] = [edge(x - half_px), edge(y - half_px).max(self.rows.start)];
        let [right, bottom] = [
            edge(x + half_px).min(self.width()),
            edge(y + half_px).min(self.rows.end),
        ];
        let is_small = right.saturating_sub(left) <= MOST_PIXELS
            && bottom.saturating_sub(top) <= MOST_PIXELS
            && half_px <= MOST_PIXELS as f32;
        is_small
            && (top..bottom).all(|row| {
                self.row(row, left..right.max(left))
                    .iter()
                    .all(|pixel| depth_of(*pixel) > depth)
            })
    }
}
