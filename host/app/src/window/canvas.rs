//! Paints the picture into the viewport, whatever size it was drawn in: never stretched, never with black beside it.

use egui::{Color32, Mesh, Painter, Pos2, Rect, Vec2, pos2, vec2};
use pointstage_engine::stage::Background;

use super::comparison::Zoom;
use super::picture::Layer;

/// Side of the squares behind a transparent picture, points.
const CHECKER: f32 = 12.0;

/// Paints the background and over it the layers.
/// `zoom`: the part of them that is seen.
pub(crate) fn paint(
    painter: &Painter,
    rect: Rect,
    background: Background,
    layers: &[Layer],
    zoom: Option<Zoom>,
) {
    paint_background(painter, rect, background);
    let whole = Rect::from_min_max(Pos2::ZERO, pos2(1.0, 1.0));
    for layer in layers {
        let place = place_of(zoom.map_or(rect, |zoom| zoom.rect(rect)), layer.size_px);
        let tint = Color32::WHITE.gamma_multiply(layer.opacity);
        painter.image(layer.texture, place, whole, tint);
    }
}

/// Where a picture of this size goes: as high as the viewport and in its middle, since the camera's angle of view is that
/// of the height. What is too wide is cut off; beside what is too narrow the background shows.
fn place_of(rect: Rect, [width, height]: [u32; 2]) -> Rect {
    let aspect = width as f32 / height.max(1) as f32;
    let place = Rect::from_center_size(rect.center(), vec2(rect.height() * aspect, rect.height()));
    // A picture of the viewport's own size fills it to the pixel.
    let is_own_size = (place.width() - rect.width()).abs() < 1.0;
    if is_own_size { rect } else { place }
}

fn paint_background(painter: &Painter, rect: Rect, background: Background) {
    match background {
        Background::Transparent => paint_checkers(painter, rect),
        Background::Solid(colour) => {
            painter.rect_filled(rect, 0.0, color(colour));
        }
        Background::Gradient(top, bottom) => {
            let mut mesh = Mesh::default();
            mesh.colored_vertex(rect.left_top(), color(top));
            mesh.colored_vertex(rect.right_top(), color(top));
            mesh.colored_vertex(rect.left_bottom(), color(bottom));
            mesh.colored_vertex(rect.right_bottom(), color(bottom));
            mesh.add_triangle(0, 1, 2);
            mesh.add_triangle(2, 1, 3);
            painter.add(mesh);
        }
    }
}

/// The squares that stand for transparency.
fn paint_checkers(painter: &Painter, rect: Rect) {
    painter.rect_filled(rect, 0.0, Color32::from_gray(110));
    let columns = (rect.width() / CHECKER).ceil() as usize;
    let rows = (rect.height() / CHECKER).ceil() as usize;
    for row in 0..rows {
        for column in (row % 2..columns).step_by(2) {
            let corner = rect.min + vec2(column as f32, row as f32) * CHECKER;
            let square = Rect::from_min_size(corner, Vec2::splat(CHECKER));
            painter.rect_filled(square, 0.0, Color32::from_gray(140));
        }
    }
}

/// A colour of sRGB values, 0..1.
fn color(srgb: [f32; 3]) -> Color32 {
    let [red, green, blue] = srgb.map(|channel| (channel.clamp(0.0, 1.0) * 255.0).round() as u8);
    Color32::from_rgb(red, green, blue)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn viewport(width: f32, height: f32) -> Rect {
        Rect::from_min_size(pos2(10.0, 20.0), vec2(width, height))
    }

    #[test]
    fn a_picture_of_another_size_keeps_its_shape() {
        for size_px in [[400, 300], [300, 400], [1, 1], [740, 671]] {
            let rect = viewport(600.0, 300.0);
            let place = place_of(rect, size_px);
            let (drawn, shown) = (
                size_px[0] as f32 / size_px[1] as f32,
                place.width() / place.height(),
            );
            assert!((drawn / shown - 1.0).abs() < 1e-4, "{size_px:?}: {place}");
            assert!((place.center() - rect.center()).length() < 1e-3);
            assert!((place.height() - rect.height()).abs() < 1e-3);
        }
    }

    #[test]
    fn a_picture_of_the_viewport_s_size_fills_it() {
        let rect = viewport(600.4, 300.0);
        assert_eq!(place_of(rect, [600, 300]), rect);
        assert_eq!(place_of(rect, [300, 150]), rect, "half as many pixels");
    }
}
