//! Surfels that what is drawn already hides: they are left out before their images are computed.

use super::bins::Candidate;
use super::nearest::{NearestBand, depth_of};

impl NearestBand<'_> {
    /// Puts the numbers of those surfels into `left` that may be seen in the band, or blend with what is, over what is drawn so far;
    /// in their order. Never too few.
    #[inline]
    pub fn leave_out_hidden(&self, candidates: &[Candidate], left: &mut Vec<u32>) {
        left.clear();
        for candidate in candidates {
            if !self.hides(candidate) {
                left.push(candidate.number);
            }
        }
    }

    /// Whether all pixels of the band that a surfel can reach are nearer than it; false if there are many.
    #[inline]
    fn hides(&self, candidate: &Candidate) -> bool {
        let Candidate { area, depth, .. } = candidate;
        // Of a large one the depth is infinite, so one look is enough.
        let columns = area.columns();
        area.rows_within(&self.rows).all(|row| {
            let pixels = self.row(row, columns.clone());
            pixels.iter().all(|pixel| depth_of(*pixel) > *depth)
        })
    }
}
