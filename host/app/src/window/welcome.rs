//! What an empty window says.

use egui::{Align2, Area, Context, Frame, Id, Order, Rect};

use super::intent::{FileIntent, Intents, OpenMode};

/// Shows, over the empty picture, how to get something onto the stage.
pub(crate) fn welcome_ui(
    ctx: &Context,
    over: Rect,
    samples: &[std::path::PathBuf],
    out: &mut Intents,
) {
    Area::new(Id::unique("welcome"))
        .order(Order::Middle)
        .pivot(Align2::CENTER_CENTER)
        .fixed_pos(over.center())
        .show(ctx, |ui| {
            Frame::popup(ui.style()).inner_margin(20.0).show(ui, |ui| {
                ui.set_width(380.0_f32.min(over.width() - 60.0));
                ui.heading("Nothing on the stage yet");
                ui.label("Drop a PLY file here, or open one:");
                ui.horizontal_wrapped(|ui| {
                    if ui.button("Open…").clicked() {
                        out.push(FileIntent::Choose(OpenMode::Replace));
                    }
                    if ui.button("Type a path…").clicked() {
                        out.push(FileIntent::TypePath(OpenMode::Replace));
                    }
                });
                if !samples.is_empty() {
                    ui.add_space(6.0);
                    ui.label("Or look at a sample:");
                    ui.horizontal_wrapped(|ui| {
                        for sample in samples {
                            let name = sample.file_stem().unwrap_or_default().to_string_lossy();
                            if ui.button(name.replace('_', " ")).clicked() {
                                out.push(FileIntent::Open(vec![sample.clone()], OpenMode::Replace));
                            }
                        }
                    });
                }
                ui.add_space(6.0);
                ui.weak("Then choose a renderer in the settings panel. F1 lists all keys.");
            });
        });
}

/// Says what dropping would do, while files hang over the window.
pub(crate) fn drop_ui(ctx: &Context, over: Rect) {
    let (count, adds) = ctx.input(|input| (input.raw.hovered_files.len(), input.modifiers.shift));
    if count == 0 {
        return;
    }
    let files = if count == 1 {
        "the file".to_owned()
    } else {
        format!("{count} files")
    };
    let text = if adds {
        format!("Drop to add {files} to the scene")
    } else {
        format!("Drop to open {files}; with Shift, to add")
    };
    let painter = ctx.layer_painter(egui::LayerId::new(Order::Foreground, Id::unique("drop")));
    painter.rect_filled(over, 0.0, egui::Color32::from_black_alpha(160));
    painter.text(
        over.center(),
        Align2::CENTER_CENTER,
        text,
        egui::FontId::proportional(20.0),
        egui::Color32::WHITE,
    );
}
