//! Visibility pass: which surfel is nearest at each pixel.

use core::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use glam::{Vec2, Vec3};
use pointstage_plugin_api::abi::FrameUniform;
use pointstage_plugin_api::columns::decode_normal;
use rayon::prelude::*;

use super::super::cpu_targets::pixel_count;
use super::Drawn;
use super::draws::{Draws, Span};
use super::splat::{Screen, Splat};

/// Surfels that a thread takes at a time: some 100 µs of work.
const CHUNK_SURFELS: u32 = 8192;

/// One word a pixel: the bits of the depth above ordinal + 1; 0 where nothing is. Bits of positive floats sort as the
/// floats do, so the greatest word is the nearest surfel, and of equally near ones the last.
#[derive(Debug, Default)]
pub(super) struct VisibilityBuffer {
    size_px: [u32; 2],
    words: Vec<AtomicU64>,
}

/// A surfel in view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Visible {
    pub(super) ordinal: u32,
    /// Reversed z.
    pub(super) depth: f32,
}

impl VisibilityBuffer {
    /// Takes the size and forgets the last frame.
    pub(super) fn fit(&mut self, size_px: [u32; 2]) {
        self.size_px = size_px;
        self.words
            .resize_with(pixel_count(size_px), AtomicU64::default);
        self.words
            .par_iter_mut()
            .for_each(|word| *word.get_mut() = 0);
    }

    /// What is visible in a row, from the left.
    pub(super) fn row(&self, y: usize) -> impl Iterator<Item = Option<Visible>> {
        let width = self.size_px[0] as usize;
        self.words[y * width..][..width].iter().map(|word| {
            let word = word.load(Ordering::Relaxed);
            let ordinal = (word as u32).checked_sub(1)?;
            let depth = f32::from_bits((word >> 32) as u32);
            Some(Visible { ordinal, depth })
        })
    }

    pub(super) fn size_px(&self) -> [u32; 2] {
        self.size_px
    }

    /// Splats all surfels of the draws.
    pub(super) fn splat_all(
        &self,
        frame: &FrameUniform,
        draws: &Draws<'_>,
        should_stop: &(dyn Fn() -> bool + Sync),
    ) -> Drawn {
        let screen = Screen::new(frame, self.size_px);
        let surfel_count = draws.surfel_count();
        let stopped = AtomicBool::new(false);
        let counted = (0..surfel_count.div_ceil(CHUNK_SURFELS))
            .into_par_iter()
            .map(|chunk| {
                if stopped.load(Ordering::Relaxed) || should_stop() {
                    stopped.store(true, Ordering::Relaxed);
                    return (0, 0);
                }
                let start = chunk * CHUNK_SURFELS;
                let end = start.saturating_add(CHUNK_SURFELS).min(surfel_count);
                let spans = draws.spans(start..end);
                let broken: u64 = spans
                    .map(|span| self.splat_span(&screen, frame, &span))
                    .sum();
                (u64::from(end - start) - broken, broken)
            })
            .reduce(|| (0, 0), |a, b| (a.0 + b.0, a.1 + b.1));
        Drawn {
            surfel_count: counted.0,
            broken_surfel_count: counted.1,
            unreadable_draw_count: 0,
            stopped: stopped.into_inner(),
        }
    }

    /// Splats neighbouring surfels of one draw; returns how many are broken.
    fn splat_span(&self, screen: &Screen, frame: &FrameUniform, span: &Span<'_, '_>) -> u64 {
        let Span { draw, range, .. } = span;
        let radius_factor = draw.radius_factor * frame.radius_scale;
        let mut broken = 0;
        for index in range.clone() {
            let number = draw.number(index) as usize;
            let Some(&[x, y, z, radius]) = draw.centres.get(number) else {
                broken += 1;
                continue;
            };
            let centre_view = draw.view_from_object.transform_point3(Vec3::new(x, y, z));
            let radius = radius * radius_factor;
            if !(centre_view.is_finite() && radius.is_finite()) {
                broken += 1;
                continue;
            }
            let normal_view = || {
                let packed = draw.normals?.get(number)?;
                Some(draw.normal_matrix * decode_normal(*packed))
            };
            if let Some(splat) = screen.splat(centre_view, radius, normal_view) {
                let ordinal = span.first_ordinal + (index - range.start);
                self.cover(&splat, screen.size_px, ordinal);
            }
        }
        broken
    }

    /// Writes a splat's pixels.
    #[inline]
    fn cover(&self, splat: &Splat, size_px: Vec2, ordinal: u32) {
        let ([left, right], [top, bottom]) = splat.pixel_box(size_px);
        let centre_pixel = splat.centre.floor();
        for y in top..bottom {
            let row = y as usize * self.size_px[0] as usize;
            for x in left..right {
                let pixel = Vec2::new(x as f32, y as f32);
                let offset = pixel + 0.5 - splat.centre;
                let depth = match splat.depth_at(offset) {
                    Some(depth) => depth,
                    // Thin and tiny discs may miss every pixel centre; each surfel has at least one pixel.
                    None if pixel == centre_pixel => splat.nearest_depth(offset),
                    None => continue,
                };
                let word = (u64::from(depth.to_bits()) << 32) | u64::from(ordinal + 1);
                let held = &self.words[row + x as usize];
                // Reading first is cheaper by far where the surfel is hidden, and as right: words only grow.
                if held.load(Ordering::Relaxed) < word {
                    held.fetch_max(word, Ordering::Relaxed);
                }
            }
        }
    }
}
