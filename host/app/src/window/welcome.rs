//! What an empty window says.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use egui::{Align2, Area, Button, Context, Frame, Id, Order, Rect, ScrollArea, Ui};

use super::actions::title_of_recent;
use super::intent::{FileIntent, Intents, OpenMode};

/// The most recent files that are offered; the File menu has the others.
const MOST_RECENT: usize = 5;

/// Width of the text, points.
const WIDTH: f32 = 400.0;

/// What an empty window has to offer.
pub(crate) struct Welcome<'a> {
    /// Models that came with the program.
    pub(crate) samples: &'a [PathBuf],
    /// Files that were opened, newest first.
    pub(crate) recent: &'a [PathBuf],
    /// Those of them that are not there.
    pub(crate) missing: &'a BTreeSet<PathBuf>,
}

/// Shows, over the empty picture, how to get something onto the stage.
pub(crate) fn welcome_ui(ctx: &Context, over: Rect, welcome: &Welcome<'_>, out: &mut Intents) {
    Area::new(Id::unique("welcome"))
        .order(Order::Middle)
        .pivot(Align2::CENTER_CENTER)
        .fixed_pos(over.center())
        .show(ctx, |ui| {
            Frame::popup(ui.style()).inner_margin(20.0).show(ui, |ui| {
                ui.set_width(WIDTH.min(over.width() - 60.0));
                // In a low window or with large texts, the offers scroll.
                ScrollArea::vertical()
                    .max_height((over.height() - 60.0).max(80.0))
                    .show(ui, |ui| offers_ui(ui, welcome, out));
            });
        });
}

fn offers_ui(ui: &mut Ui, welcome: &Welcome<'_>, out: &mut Intents) {
    ui.heading("Nothing on the stage yet");
    ui.label("Drop a scan, a mesh or a session here, or open one:");
    ui.horizontal_wrapped(|ui| {
        if ui.button("Open…").clicked() {
            out.push(FileIntent::Choose(OpenMode::Replace));
        }
        if ui.button("Type a path…").clicked() {
            out.push(FileIntent::TypePath(OpenMode::Replace));
        }
    });
    if !welcome.recent.is_empty() {
        ui.add_space(8.0);
        ui.label("Go on with a recent file:");
        for path in welcome.recent.iter().take(MOST_RECENT) {
            recent_ui(ui, path, welcome.missing.contains(path), out);
        }
    }
    if !welcome.samples.is_empty() {
        ui.add_space(8.0);
        ui.label("Or look at a sample:");
        ui.horizontal_wrapped(|ui| {
            for sample in welcome.samples {
                let name = sample.file_stem().unwrap_or_default().to_string_lossy();
                if ui.button(name.replace('_', " ")).clicked() {
                    out.push(FileIntent::Open(vec![sample.clone()], OpenMode::Replace));
                }
            }
        });
    }
    ui.add_space(8.0);
    ui.weak("Then choose a renderer in the settings panel. F1 lists all keys.");
}

fn recent_ui(ui: &mut Ui, path: &Path, is_missing: bool, out: &mut Intents) {
    // In one line, cut where it does not fit; the tooltip has all of it.
    let button = Button::new(title_of_recent(path)).truncate();
    let response = ui.add_enabled(!is_missing, button);
    let response = response
        .on_hover_text(path.display().to_string())
        .on_disabled_hover_text(format!("{} is not there any more", path.display()));
    if response.clicked() {
        out.push(FileIntent::Open(
            vec![path.to_path_buf()],
            OpenMode::Replace,
        ));
    }
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
