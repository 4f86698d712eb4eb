//! The bar over the picture while a tool selects.

use egui::{Align2, Area, Context, DragValue, Frame, Id, Order, Rect, vec2};

use super::{BRUSH_RADII, Reach, Selecting, Tool};
use crate::window::intent::{Intents, SelectIntent};

/// The tools, what they do, and how much is selected, at the lower edge of `over`. Nothing while drags move the camera.
///
/// * `marked_count`: selected surfels; the status bar says how many they are.
pub(crate) fn bar_ui(
    ctx: &Context,
    over: Rect,
    selecting: &Selecting,
    marked_count: usize,
    out: &mut Intents,
) {
    if selecting.tool == Tool::Navigate {
        return;
    }
    Area::new(Id::unique("selecting"))
        .order(Order::Middle)
        .pivot(Align2::CENTER_BOTTOM)
        .fixed_pos(over.center_bottom() - vec2(0.0, 10.0))
        .show(ctx, |ui| {
            Frame::popup(ui.style()).show(ui, |ui| {
                ui.horizontal(|ui| {
                    for (tool, name, _) in Tool::SELECTING {
                        let is_on = selecting.tool == tool;
                        let choice = ui.selectable_label(is_on, name).on_hover_text(
                            "A drag selects; with Shift it adds, with Ctrl it takes away",
                        );
                        if choice.clicked() && !is_on {
                            out.push(SelectIntent::Tool(tool));
                        }
                    }
                    ui.separator();
                    if selecting.tool == Tool::Brush {
                        let mut radius = selecting.brush_radius;
                        let label = ui.label("Radius");
                        let field = DragValue::new(&mut radius).range(BRUSH_RADII).speed(0.5);
                        if ui.add(field).labelled_by(label.id).changed() {
                            out.push(SelectIntent::BrushRadius(radius));
                        }
                        ui.separator();
                    }
                    let mut visible_only = selecting.reach == Reach::Visible;
                    let choice = ui
                        .checkbox(&mut visible_only, "Visible only")
                        .on_hover_text(
                            "Leave out what lies behind the surface that the picture shows",
                        );
                    if choice.changed() {
                        out.push(SelectIntent::Reach(if visible_only {
                            Reach::Visible
                        } else {
                            Reach::Through
                        }));
                    }
                    ui.separator();
                    if ui.button("Invert").clicked() {
                        out.push(SelectIntent::Invert);
                    }
                    if ui
                        .add_enabled(marked_count > 0, egui::Button::new("Clear"))
                        .clicked()
                    {
                        out.push(SelectIntent::Clear);
                    }
                    if ui.button("Done").clicked() {
                        out.push(SelectIntent::Tool(Tool::Navigate));
                    }
                });
            });
        });
}
