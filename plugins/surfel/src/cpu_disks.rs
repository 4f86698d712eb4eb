//! Disks drawn on the CPU: the twin of `shaders/surfel/disk.wesl`.

use pointstage_plugin_api::glam::{BVec4A, Vec4};
use pointstage_visibility::cpu::{
    Axes4, Bins, LANES, Nearest, NearestBand, Reach, Rectangle, Splats, Stage, Surfels, share_out,
};

/// How disks are drawn.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Disks {
    /// Factor on the half-axes.
    pub(crate) scale: f32,
    /// Leaves out what shows its back.
    pub(crate) culls_backs: bool,
}

/// Surfels that are held against the picture so far at a time.
const SHARE: usize = 64;

impl Splats for Disks {
    fn draw(
        &self,
        stage: &Stage<'_>,
        thread_count: usize,
        bins: &mut Bins,
        nearest: &mut Nearest,
    ) -> Rectangle {
        let reach = Reach {
            scale: self.scale,
            pad_px: 0.0,
        };
        bins.fill(stage, reach, thread_count);
        let mut benches = vec![(Rectangle::default(), Vec::new()); thread_count.max(1)];
        share_out(
            nearest.bands(),
            &mut benches,
            |(reached, left), mut band| {
                band.clear();
                for (draw, candidates) in bins.of_band(band.number) {
                    let Some(surfels) = stage.draws.get(draw) else {
                        continue;
                    };
                    for candidates in candidates.chunks(SHARE) {
                        band.leave_out_hidden(candidates, left);
                        for numbers in left.chunks(LANES) {
                            let drawn = self.draw_four(stage, surfels, numbers, &mut band);
                            *reached = reached.joined(drawn);
                        }
                    }
                }
            },
        );
        let reached = benches.into_iter().map(|(reached, _)| reached);
        reached.fold(Rectangle::default(), Rectangle::joined)
    }
}

impl Disks {
    /// Draws up to four surfels into a band; the pixels that they can reach.
    #[inline]
    fn draw_four(
        self,
        stage: &Stage<'_>,
        surfels: &Surfels<'_>,
        numbers: &[u32],
        band: &mut NearestBand<'_>,
    ) -> Rectangle {
        let four = surfels.load(numbers);
        let hidden = if self.culls_backs {
            surfels.are_back_facing(&four)
        } else {
            BVec4A::FALSE
        };
        let mut reached = Rectangle::default();
        if hidden.all() {
            return reached;
        }
        let axes = surfels.load_axes_view(&four, &stage.camera);
        let scale = Vec4::splat(self.scale);
        let axes = Axes4 {
            u: axes.u * scale,
            v: axes.v * scale,
        };
        let ellipses = stage.camera.project_ellipses(four.centre_view, &axes);
        let seen = (ellipses.is_seen & !hidden).bitmask();
        let images = ellipses.images(ellipses.areas());
        for (lane, (image, number)) in images.iter().zip(numbers).enumerate() {
            if seen & 1 << lane != 0 && !image.area.is_empty() {
                let id = surfels.surfel_id(*number);
                let lines = surfels.clip_lines(*number, self.scale);
                image.offer(image.area, 1.0, [1.0, 0.0], lines.as_ref(), id, band);
                reached = reached.joined(image.area);
            }
        }
        reached
    }
}
