//! The image of one ellipse, and its pixels.

use super::clip::clip_keeps;
use super::ellipse::Ellipses4;
use super::lanes::{LANES, Vec3x4};
use super::nearest::{NearestBand, packed};
use crate::rectangle::PixelRectangle;
use core::ops::Range;
use pointstage_plugin_api::clip::ClipLines;
use pointstage_plugin_api::glam::{BVec4A, Vec3, Vec4};

/// Pixels from a first column and row up to those before the last ones.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Rectangle {
    /// First column and row.
    pub first: [u16; 2],
    /// One past the last column and row.
    pub end: [u16; 2],
}

/// The image of one ellipse: planes over the screen, by offsets from the centre of the first pixel of `area`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Image {
    /// The pixels that it can reach.
    pub area: Rectangle,
    /// (u, v, 1) / w of the plane's point that a pixel sees.
    pub uv1_constant: Vec3,
    /// Its change with x.
    pub uv1_x: Vec3,
    /// Its change with y.
    pub uv1_y: Vec3,
    /// Depth: constant, change with x, change with y.
    pub depth: Vec3,
}

/// One of an image's planes in a row: what four neighbours have.
#[derive(Clone, Copy, Debug)]
pub struct RowPlane {
    start: f32,
    step: Vec4,
}

/// 0, 1, 2, 3.
const STEPS: Vec4 = Vec4::new(0.0, 1.0, 2.0, 3.0);

impl Rectangle {
    /// Pixels whose centres lie between two pixel positions, for four pairs; edges that are negative or no numbers count as 0.
    #[inline]
    pub fn within_four(lower_px: [Vec4; 2], upper_px: [Vec4; 2]) -> [Self; LANES] {
        let [left, top] = [lower_px[0].to_array(), lower_px[1].to_array()];
        let [right, bottom] = [upper_px[0].to_array(), upper_px[1].to_array()];
        let mut areas = [Self::default(); LANES];
        for (lane, area) in areas.iter_mut().enumerate() {
            *area = Self {
                first: [first_pixel(left[lane]), first_pixel(top[lane])],
                end: [past_last_pixel(right[lane]), past_last_pixel(bottom[lane])],
            };
        }
        areas
    }

    /// Whether it has no pixel.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.first[0] >= self.end[0] || self.first[1] >= self.end[1]
    }

    /// The same as a corner and a size, with `more` rows and columns after the last ones, within a picture.
    pub fn pixels(&self, more: u32, size_px: [u32; 2]) -> PixelRectangle {
        if self.is_empty() {
            return PixelRectangle {
                origin: [0, 0],
                size: [0, 0],
            };
        }
        let origin = self.first.map(u32::from);
        let size = [0, 1].map(|axis| {
            let end = (u32::from(self.end[axis]) + more).min(size_px[axis]);
            end.saturating_sub(origin[axis])
        });
        PixelRectangle { origin, size }
    }

    /// Its columns.
    #[inline]
    pub fn columns(&self) -> Range<u32> {
        self.first[0].into()..self.end[0].into()
    }

    /// Its rows.
    #[inline]
    pub fn rows(&self) -> Range<u32> {
        self.first[1].into()..self.end[1].into()
    }

    /// Its rows among some.
    #[inline]
    pub fn rows_within(&self, rows: &Range<u32>) -> Range<u32> {
        u32::from(self.first[1]).max(rows.start)..u32::from(self.end[1]).min(rows.end)
    }

    /// The least rectangle that holds both; one that is empty does not count.
    #[inline]
    #[must_use]
    pub fn joined(self, other: Self) -> Self {
        if self.is_empty() {
            return other;
        }
        if other.is_empty() {
            return self;
        }
        Self {
            first: [0, 1].map(|axis| self.first[axis].min(other.first[axis])),
            end: [0, 1].map(|axis| self.end[axis].max(other.end[axis])),
        }
    }
}

impl Ellipses4 {
    /// The pixels that the visible parts can reach, without meaning for what is not seen.
    #[inline]
    pub fn areas(&self) -> [Rectangle; LANES] {
        Rectangle::within_four(self.lower_px, self.upper_px)
    }

    /// The four images, over these areas.
    #[inline]
    pub fn images(&self, areas: [Rectangle; LANES]) -> [Image; LANES] {
        let offset = |axis: usize| {
            let corner = Vec4::from_array(areas.map(|area| f32::from(area.first[axis])));
            corner + Vec4::splat(0.5) - self.origin_px[axis]
        };
        let [x, y] = [offset(0), offset(1)];
        let constant = self.uv1_constant + self.uv1_x * x + self.uv1_y * y;
        let depth = self.depth;
        let depth = Vec3x4::new(depth.x + depth.y * x + depth.z * y, depth.y, depth.z);
        let mut images = [Image::default(); LANES];
        for (lane, (image, area)) in images.iter_mut().zip(areas).enumerate() {
            *image = Image {
                area,
                uv1_constant: constant.lane(lane),
                uv1_x: self.uv1_x.lane(lane),
                uv1_y: self.uv1_y.lane(lane),
                depth: depth.lane(lane),
            };
        }
        images
    }
}

impl Image {
    /// (u, v, 1) / w in a row.
    #[inline]
    pub fn uv1_in_row(&self, row: u32) -> [RowPlane; 3] {
        let down = self.down(row);
        let start = self.uv1_constant + self.uv1_y * down;
        [0, 1, 2].map(|part| RowPlane::new(start[part], self.uv1_x[part]))
    }

    /// Depth in a row.
    #[inline]
    pub fn depth_in_row(&self, row: u32) -> RowPlane {
        let down = self.down(row);
        RowPlane::new(self.depth.x + self.depth.z * down, self.depth.y)
    }

    /// Rows from the first one.
    #[inline]
    fn down(&self, row: u32) -> f32 {
        (row as i32 - i32::from(self.area.first[1])) as f32
    }

    /// Offers the ellipse's pixels in an area to a band.
    ///
    /// * `seen_squared`: up to this |uv|² it is seen.
    /// * `push`: a factor on depth, and what is taken from it then; what lies before the near plane stays hidden all the same.
    /// * `lines`: where it is cut off, in units of the image's half-axes.
    #[inline]
    pub fn offer(
        &self,
        area: Rectangle,
        seen_squared: f32,
        push: [f32; 2],
        lines: Option<&ClipLines>,
        id: u32,
        band: &mut NearestBand<'_>,
    ) {
        match lines {
            None => self.offer_where(area, seen_squared, push, |_| BVec4A::TRUE, id, band),
            Some(lines) => {
                let keeps = |uv1| clip_keeps(lines, uv1);
                self.offer_where(area, seen_squared, push, keeps, id, band);
            }
        }
    }

    /// The same where `keeps` holds of (u, v, 1) / w.
    #[inline]
    fn offer_where(
        &self,
        area: Rectangle,
        seen_squared: f32,
        push: [f32; 2],
        keeps: impl Fn([Vec4; 3]) -> BVec4A,
        id: u32,
        band: &mut NearestBand<'_>,
    ) {
        let columns = area.columns();
        let first = (columns.start as i32 - i32::from(self.area.first[0])) as f32;
        let [factor, less] = push.map(Vec4::splat);
        let seen_squared = Vec4::splat(seen_squared);
        for row in area.rows_within(&band.rows) {
            let [u, v, one] = self.uv1_in_row(row);
            let depth = self.depth_in_row(row);
            let Some(pixels) = band.pixels(row, columns.clone()) else {
                return;
            };
            let mut across = first;
            for pixels in pixels.chunks_mut(LANES) {
                let [u, v, one] = [u.at(across), v.at(across), one.at(across)];
                let own_depth = depth.at(across);
                let depth = own_depth * factor - less;
                across += LANES as f32;
                let is_covered = one.cmpgt(Vec4::ZERO)
                    & (u * u + v * v).cmple(seen_squared * one * one)
                    & depth.cmpgt(Vec4::ZERO)
                    & own_depth.cmple(Vec4::ONE)
                    & keeps([u, v, one]);
                let covered = is_covered.bitmask();
                if covered == 0 {
                    continue;
                }
                let depths = depth.to_array();
                for (lane, (pixel, depth)) in pixels.iter_mut().zip(depths).enumerate() {
                    if covered & 1 << lane != 0 {
                        *pixel = (*pixel).max(packed(depth, id));
                    }
                }
            }
        }
    }
}

impl RowPlane {
    #[inline]
    fn new(start: f32, step: f32) -> Self {
        Self {
            start,
            step: STEPS * step,
        }
    }

    /// Four values, from `across` columns after the area's first.
    #[inline]
    pub fn at(&self, across: f32) -> Vec4 {
        Vec4::splat(self.start + across * self.step.y) + self.step
    }
}

/// First pixel whose centre does not lie before `edge_px`; 0 for what is negative or no number.
#[inline]
fn first_pixel(edge_px: f32) -> u16 {
    let edge = edge_px - 0.5;
    let whole = edge as u16;
    whole.saturating_add(u16::from(edge > f32::from(whole)))
}

/// One past the last pixel whose centre does not lie beyond `edge_px`; 0 for what is negative or no number.
#[inline]
fn past_last_pixel(edge_px: f32) -> u16 {
    let edge = edge_px - 0.5;
    if edge >= 0.0 {
        (edge as u16).saturating_add(1)
    } else {
        0
    }
}
