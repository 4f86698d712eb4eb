//! The same pixels of every view, enlarged, with their values.

use egui::{Align2, Color32, FontId, Painter, Pos2, Rect, Vec2, vec2};
use pointstage_engine::stage::Picture;

/// The greatest factor.
const MOST: f32 = 128.0;

/// From this size of a pixel on its values are written into it, points.
const VALUES_FROM: f32 = 44.0;

/// A part of the pictures that is shown enlarged: the same part in every view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Zoom {
    /// How much larger than in its own size.
    pub(crate) factor: f32,
    /// The part's middle, as parts of width and height.
    pub(crate) middle: [f32; 2],
}

impl Zoom {
    /// `zoom`, changed by a factor around a place of the pictures (parts of width and height), which stays where it is. `None`
    /// when all is seen again.
    pub(crate) fn changed(zoom: Option<Self>, by: f32, around: [f32; 2]) -> Option<Self> {
        let was = zoom.unwrap_or(Self {
            factor: 1.0,
            middle: [0.5; 2],
        });
        let factor = (was.factor * by).clamp(1.0, MOST);
        if factor <= 1.01 {
            return None;
        }
        let seen = was.part_at(around);
        let middle = std::array::from_fn(|axis| seen[axis] - (around[axis] - 0.5) / factor);
        Some(Self { factor, middle }.within())
    }

    /// Moved by parts of the view's width and height.
    pub(crate) fn moved(self, by: [f32; 2]) -> Self {
        let middle = std::array::from_fn(|axis| self.middle[axis] - by[axis] / self.factor);
        Self { middle, ..self }.within()
    }

    /// The place of the picture that is seen at a place of the view, both as parts of width and height.
    pub(crate) fn part_at(self, at: [f32; 2]) -> [f32; 2] {
        std::array::from_fn(|axis| self.middle[axis] + (at[axis] - 0.5) / self.factor)
    }

    /// The place of the view where a place of the picture is seen.
    fn place_of(self, part: [f32; 2]) -> [f32; 2] {
        std::array::from_fn(|axis| (part[axis] - self.middle[axis]) * self.factor + 0.5)
    }

    /// Where the whole picture lies so that the part fills `view`.
    pub(crate) fn rect(self, view: Rect) -> Rect {
        let [left, top] = self.place_of([0.0; 2]);
        let corner = view.min + vec2(left, top) * view.size();
        Rect::from_min_size(corner, view.size() * self.factor)
    }

    /// Never shows what is beside the picture.
    fn within(self) -> Self {
        let half = 0.5 / self.factor;
        let middle = self.middle.map(|middle| middle.clamp(half, 1.0 - half));
        Self { middle, ..self }
    }
}

/// Writes the values of the pixels into them, where they are large enough.
pub(crate) fn paint_values(painter: &Painter, view: Rect, zoom: Zoom, picture: &Picture) {
    let [width, height] = picture.size_px;
    let whole = zoom.rect(view);
    let pixel = vec2(whole.width() / width as f32, whole.height() / height as f32);
    if pixel.x < VALUES_FROM || pixel.y < VALUES_FROM {
        return;
    }
    let first = (view.min - whole.min) / pixel;
    let last = (view.max - whole.min) / pixel;
    let range = |first: f32, last: f32, count: u32| {
        let last = (last.ceil().max(0.0) as u32).min(count);
        (first.floor().max(0.0) as u32).min(last)..last
    };
    let font = FontId::monospace((pixel.y / 4.6).clamp(8.0, 15.0));
    for y in range(first.y, last.y, height) {
        for x in range(first.x, last.x, width) {
            let at = (y as usize * width as usize + x as usize) * 4;
            let Some(values) = picture.rgba.get(at..at + 3) else {
                continue;
            };
            let middle: Pos2 = whole.min + pixel * (vec2(x as f32, y as f32) + Vec2::splat(0.5));
            let text = format!("{}\n{}\n{}", values[0], values[1], values[2]);
            painter.text(
                middle,
                Align2::CENTER_CENTER,
                text,
                font.clone(),
                readable_on(values),
            );
        }
    }
}

/// Black on bright pixels, white on dark ones, by their luma (Rec. 709).
fn readable_on(values: &[u8]) -> Color32 {
    let weights = [0.2126, 0.7152, 0.0722];
    let luma: f32 = values
        .iter()
        .zip(weights)
        .map(|(value, weight)| f32::from(*value) * weight)
        .sum();
    if luma > 115.0 {
        Color32::BLACK
    } else {
        Color32::WHITE
    }
}

/// A cross over one place of a view, given as parts of its width and height.
pub(crate) fn paint_cross(painter: &Painter, view: Rect, at: [f32; 2]) {
    let middle = view.min + vec2(at[0], at[1]) * view.size();
    for (colour, width) in [(Color32::BLACK, 3.0), (Color32::WHITE, 1.0)] {
        for axis in [vec2(1.0, 0.0), vec2(0.0, 1.0)] {
            for side in [-1.0, 1.0] {
                let arm = axis * side;
                let ends = [middle + arm * 4.0, middle + arm * 11.0];
                painter.line_segment(ends, (width, colour));
            }
        }
    }
}

/// The place under the pointer, as parts of the view's width and height.
pub(crate) fn part_of(view: Rect, at: Pos2) -> [f32; 2] {
    let part = (at - view.min) / view.size();
    [part.x, part.y]
}

#[cfg(test)]
mod tests {
    use egui::pos2;

    use super::*;

    #[test]
    fn the_place_under_the_pointer_stays_while_the_zoom_changes() {
        let around = [0.3, 0.6];
        let mut zoom = None;
        for _ in 0..20 {
            zoom = Zoom::changed(zoom, 1.3, around);
            let seen = zoom.expect("it grows").part_at(around);
            assert!((seen[0] - 0.3).abs() < 1e-4 && (seen[1] - 0.6).abs() < 1e-4);
        }
        assert!(zoom.is_some_and(|zoom| zoom.factor <= MOST));
        for _ in 0..40 {
            zoom = Zoom::changed(zoom, 1.0 / 1.3, [0.9, 0.1]);
        }
        assert_eq!(zoom, None, "all is seen again");
    }

    #[test]
    fn nothing_beside_the_picture_is_ever_shown() {
        let view = Rect::from_min_size(pos2(5.0, 7.0), vec2(400.0, 300.0));
        let mut zoom = Zoom::changed(None, 5.0, [0.0, 1.0]).expect("it grew");
        for by in [[3.0, 0.0], [-9.0, 2.0], [0.0, -9.0]] {
            zoom = zoom.moved(by);
            let whole = zoom.rect(view);
            assert!(whole.expand(0.01).contains_rect(view), "{whole}");
        }
    }

    #[test]
    fn what_is_moved_follows_the_pointer() {
        let zoom = Zoom::changed(None, 8.0, [0.5; 2]).expect("it grew");
        let moved = zoom.moved([0.1, -0.2]);
        let (before, after) = (zoom.part_at([0.4, 0.5]), moved.part_at([0.5, 0.3]));
        assert!((before[0] - after[0]).abs() < 1e-5 && (before[1] - after[1]).abs() < 1e-5);
    }
}
