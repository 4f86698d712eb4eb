//! The *Scene* tab: the objects, what is in them, and what loading them gave to say.

use std::collections::BTreeMap;

use egui::{ScrollArea, Ui};
use pointstage_engine::stage::Severity;
use pointstage_scene::{Object, ObjectId, Scene, WarningKind, Warnings};

use crate::window::intent::{Intents, SceneIntent};
use crate::window::status::grouped;
use crate::window::theme;

/// The tab.
pub(crate) fn scene_ui(
    ui: &mut Ui,
    scene: &Scene,
    warnings: &BTreeMap<ObjectId, Warnings>,
    out: &mut Intents,
) {
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        if scene.objects().is_empty() {
            ui.weak("The scene is empty.");
        }
        for object in scene.objects() {
            ui.push_id(object.id.0, |ui| {
                object_ui(ui, object, warnings.get(&object.id), out);
                ui.separator();
            });
        }
    });
}

fn object_ui(ui: &mut Ui, object: &Object, warnings: Option<&Warnings>, out: &mut Intents) {
    ui.horizontal(|ui| {
        let mut visible = object.visible;
        let response = ui.checkbox(&mut visible, egui::RichText::new(&object.name).strong());
        let hint = object
            .source
            .as_ref()
            .map_or_else(String::new, |path| path.display().to_string());
        if response.on_hover_text(hint).changed() {
            out.push(SceneIntent::SetVisible(object.id, visible));
        }
        if ui.small_button("Remove").clicked() {
            out.push(SceneIntent::Remove(object.id));
        }
    });
    for line in describe(object) {
        ui.weak(line);
    }
    for warning in warnings.into_iter().flat_map(Warnings::iter) {
        ui.horizontal_wrapped(|ui| {
            theme::severity_label(ui, Severity::Warning);
            ui.label(warning.to_string());
            if warning.kind == WarningKind::WoundInward && ui.small_button("Flip").clicked() {
                out.push(SceneIntent::Flip(object.id));
            }
        });
    }
}

/// What an object is made of, in lines.
pub(crate) fn describe(object: &Object) -> Vec<String> {
    let geometry = &object.geometry;
    let mut counts = vec![format!("{} surfels", grouped(geometry.surfel_count as u64))];
    if let Some(triangles) = &geometry.triangles {
        counts.push(format!("{} triangles", grouped(triangles.len() as u64)));
    }
    let mut lines = vec![counts.join(", ")];
    if let Some(block) = geometry.blocks.first() {
        let mut columns = Vec::new();
        if block.normal.is_some() {
            columns.push("normals".to_owned());
        }
        if block.colour.is_some() {
            columns.push("colours".to_owned());
        }
        if block.axes.is_some() {
            columns.push("axes".to_owned());
        }
        columns.extend(block.named.iter().map(|column| column.name.to_string()));
        lines.push(if columns.is_empty() {
            "positions only".to_owned()
        } else {
            columns.join(", ")
        });
    }
    lines
}
