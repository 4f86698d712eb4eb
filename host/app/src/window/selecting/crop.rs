//! The crop box: its panel, and its edges over the picture.

use egui::{Color32, Context, DragValue, Grid, Painter, Pos2, Rect, Window, vec2};
use glam::{DMat4, DVec3, DVec4};
use pointstage_scene::{Bounds, Camera, MarkMode};

use crate::window::comparison::Zoom;
use crate::window::intent::{Intents, SelectIntent};

/// The panel.
///
/// * `scene`: the box around all that is drawn.
pub(crate) fn crop_ui(
    ctx: &Context,
    over: Rect,
    crop_box: Bounds,
    scene: Bounds,
    out: &mut Intents,
) {
    let mut is_open = true;
    Window::new("Crop box")
        .open(&mut is_open)
        .default_pos(over.left_top() + vec2(12.0, 44.0))
        .resizable(false)
        .show(ctx, |ui| {
            let mut changed = crop_box;
            // A drag over 300 points goes through the scene.
            let speed = (scene.size().max_element() / 300.0).max(f64::MIN_POSITIVE);
            Grid::new("crop box").num_columns(3).show(ui, |ui| {
                ui.label("");
                ui.label("Least");
                ui.label("Greatest");
                ui.end_row();
                for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
                    ui.label(name);
                    let fields = [(&mut changed.min, "Least"), (&mut changed.max, "Greatest")];
                    for (corner, end) in fields {
                        ui.add(DragValue::new(&mut corner[axis]).speed(speed).max_decimals(6))
                            .accessible_name(format!("{end} {name}"));
                    }
                    ui.end_row();
                }
            });
            if ui.button("Around everything").clicked() && !scene.is_empty() {
                changed = scene;
            }
            if changed != crop_box {
                out.push(SelectIntent::SetCropBox(changed));
            }
            ui.horizontal(|ui| {
                if ui.button("Select inside").clicked() {
                    out.push(SelectIntent::SelectInCropBox(MarkMode::Replace));
                }
                let keep = ui.button("Keep inside").on_hover_text(
                    "Delete the surfels of all objects that are drawn, where they lie outside the box",
                );
                if keep.clicked() {
                    out.push(SelectIntent::KeepInCropBox);
                }
            });
            if crop_box.is_empty() {
                ui.weak("A least value is above its greatest: the box is empty.");
            }
        });
    if !is_open {
        out.push(SelectIntent::ToggleCropBox);
    }
}

/// The edges of a box of the world over a view.
pub(crate) fn paint_box(
    painter: &Painter,
    rect: Rect,
    zoom: Option<Zoom>,
    camera: &Camera,
    crop_box: Bounds,
) {
    let whole = zoom.map_or(rect, |zoom| zoom.rect(rect));
    let aspect = f64::from(rect.width()) / f64::from(rect.height().max(1.0));
    let clip_from_world = camera.clip_from_view(aspect) * camera.view_from_world();
    let corners = crop_box.corners();
    for (from, to) in edges() {
        if let Some(ends) = edge_on_screen(&clip_from_world, [corners[from], corners[to]]) {
            let place = |part: [f64; 2]| -> Pos2 {
                whole.min + vec2(part[0] as f32, part[1] as f32) * whole.size()
            };
            let line = ends.map(place);
            painter.line_segment(line, (3.0, Color32::from_black_alpha(130)));
            painter.line_segment(line, (1.2, Color32::from_rgb(255, 190, 60)));
        }
    }
}

/// Numbers of the corners that edges join: those that differ in one bit.
fn edges() -> impl Iterator<Item = (usize, usize)> {
    let bits = [1, 2, 4];
    (0..8).flat_map(move |from| {
        let others = bits.into_iter().filter(move |bit| from & bit == 0);
        others.map(move |bit| (from, from | bit))
    })
}

/// The part of an edge that lies beyond the near plane, as parts of the picture's width and height.
fn edge_on_screen(clip_from_world: &DMat4, ends: [DVec3; 2]) -> Option<[[f64; 2]; 2]> {
    let [from, to] = ends.map(|end| *clip_from_world * end.extend(1.0));
    // Reversed depth: beyond the near plane, z is at most w.
    let beyond = |clip: DVec4| clip.w - clip.z;
    let [a, b] = [beyond(from), beyond(to)];
    if !(a > 0.0 || b > 0.0) {
        return None;
    }
    let cut = |near: f64, far: f64, start: DVec4, end: DVec4| {
        if near >= 0.0 {
            start
        } else {
            start.lerp(end, near / (near - far))
        }
    };
    let clipped = [cut(a, b, from, to), cut(b, a, to, from)];
    let part = |clip: DVec4| [(clip.x / clip.w + 1.0) * 0.5, (1.0 - clip.y / clip.w) * 0.5];
    let parts = clipped.map(part);
    parts
        .iter()
        .flatten()
        .all(|part| part.is_finite())
        .then_some(parts)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_has_twelve_edges_along_the_axes() {
        let corners = Bounds::new(DVec3::ZERO, DVec3::ONE).corners();
        let lengths: Vec<f64> = edges()
            .map(|(from, to)| corners[from].distance(corners[to]))
            .collect();
        assert_eq!(lengths, [1.0; 12]);
    }

    #[test]
    fn edges_end_where_the_eye_no_longer_sees_them() {
        let camera = Camera {
            near: 0.5,
            ..Camera::default()
        };
        let clip_from_world = camera.clip_from_view(1.0) * camera.view_from_world();
        let x = DVec3::new(0.1, 0.0, 0.0);
        let behind = edge_on_screen(&clip_from_world, [x + DVec3::Z * 4.0, x + DVec3::Z * 9.0]);
        assert_eq!(behind, None);
        let through =
            edge_on_screen(&clip_from_world, [x, x + DVec3::Z * 9.0]).expect("a part is seen");
        let at_near =
            edge_on_screen(&clip_from_world, [x, x + DVec3::Z * 2.5]).expect("it is seen");
        for (one, other) in through.iter().flatten().zip(at_near.iter().flatten()) {
            assert!((one - other).abs() < 1e-9, "{through:?} {at_near:?}");
        }
        assert!((through[0][0] - 0.5) > 0.0 && (through[0][1] - 0.5).abs() < 1e-12);
    }
}
