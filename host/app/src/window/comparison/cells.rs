//! Where views stand in the window.

use egui::{Rect, pos2};

/// Height of the line above a view, points.
const HEAD: f32 = 26.0;

/// Width of the border between views, points.
const GAP: f32 = 4.0;

/// The least part of the width or height that a view keeps.
const LEAST_PART: f32 = 0.15;

/// Where one view stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Cell {
    /// The line with its renderer and numbers.
    pub(crate) head: Rect,
    /// Its picture.
    pub(crate) picture: Rect,
}

/// The cells of `count` views in `whole`: two beside each other, three and four in two rows. Cells have one size where the
/// split is in the middle. The fourth place of three views is left free.
pub(crate) fn cells(whole: Rect, count: usize, split: [f32; 2]) -> Vec<Cell> {
    let [columns, rows] = [2.min(count), if count > 2 { 2 } else { 1 }];
    let lefts = parts(whole.left(), whole.width(), columns, split[0]);
    let tops = parts(whole.top(), whole.height(), rows, split[1]);
    (0..count)
        .map(|index| {
            let (left, right) = lefts[index % columns];
            let (top, bottom) = tops[index / columns];
            let below = (top + HEAD).min(bottom);
            Cell {
                head: Rect::from_min_max(pos2(left, top), pos2(right, below)),
                picture: Rect::from_min_max(pos2(left, below), pos2(right, bottom)),
            }
        })
        .collect()
}

/// Start and end of one or two parts with a gap between them, on whole points: two halves have one length.
fn parts(start: f32, length: f32, count: usize, split: f32) -> Vec<(f32, f32)> {
    if count < 2 {
        return vec![(start, start + length)];
    }
    let room = (length - GAP).max(2.0);
    let first = (room * split.clamp(LEAST_PART, 1.0 - LEAST_PART)).floor();
    let second = if split == 0.5 {
        first
    } else {
        (room - first).floor()
    };
    let middle = start + first + GAP;
    vec![(start, start + first), (middle, middle + second)]
}

/// The borders that can be dragged, as the axis that they split (0: width, 1: height) and where they are.
pub(crate) fn borders(whole: Rect, count: usize, split: [f32; 2]) -> Vec<(usize, Rect)> {
    let cells = cells(whole, count, split);
    let mut borders = Vec::new();
    if let (Some(first), Some(second)) = (cells.first(), cells.get(1)) {
        let (left, right) = (first.picture.right(), second.picture.left());
        let border = Rect::from_min_max(pos2(left, whole.top()), pos2(right, whole.bottom()));
        borders.push((0, border));
    }
    if let (Some(first), Some(third)) = (cells.first(), cells.get(2)) {
        let (top, bottom) = (first.picture.bottom(), third.head.top());
        let border = Rect::from_min_max(pos2(whole.left(), top), pos2(whole.right(), bottom));
        borders.push((1, border));
    }
    borders
}

/// The split that puts a border at a place.
pub(crate) fn split_at(whole: Rect, axis: usize, at: egui::Pos2) -> f32 {
    let part = (at - whole.min) / whole.size();
    part[axis].clamp(LEAST_PART, 1.0 - LEAST_PART)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn whole() -> Rect {
        Rect::from_min_size(pos2(3.0, 30.0), egui::vec2(903.0, 601.0))
    }

    #[test]
    fn with_the_border_in_the_middle_all_have_one_size() {
        for count in 1..=4 {
            let cells = cells(whole(), count, [0.5; 2]);
            assert_eq!(cells.len(), count);
            for cell in &cells {
                assert_eq!(cell.picture.size(), cells[0].picture.size(), "{count}");
                assert!(whole().expand(0.01).contains_rect(cell.picture));
            }
            for (index, cell) in cells.iter().enumerate() {
                let mut others = cells[..index].iter();
                assert!(others.all(|other| !other.picture.intersects(cell.picture)));
            }
        }
    }

    #[test]
    fn a_border_that_is_dragged_is_where_the_pointer_is() {
        let whole = whole();
        let at = pos2(whole.left() + 300.0, whole.top() + 400.0);
        let split = [0, 1].map(|axis| split_at(whole, axis, at));
        for (axis, border) in borders(whole, 4, split) {
            let middle = [border.center().x, border.center().y][axis];
            assert!(
                (middle - [at.x, at.y][axis]).abs() < GAP,
                "{axis}: {border}"
            );
        }
        assert!(borders(whole, 1, split).is_empty());
        assert!(split_at(whole, 0, whole.min) > 0.1, "no view vanishes");
    }
}
