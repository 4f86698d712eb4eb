//! The *Scene* tab: the objects, what is in them, what loading them gave to say, and what can be done with them.

use std::collections::BTreeMap;

use egui::Ui;
use pointstage_engine::stage::Severity;
use pointstage_scene::{Material, Object, ObjectId, Scene, WarningKind, Warnings};

use super::estimate::estimate_ui;
use super::material::material_ui;
use super::objects;
use crate::window::intent::{Intents, SceneIntent};
use crate::window::status::grouped;
use crate::window::theme;

/// What the tab shows.
pub(crate) struct SceneTab<'a> {
    /// The objects.
    pub(crate) scene: &'a Scene,
    /// What loading each gave to say.
    pub(crate) warnings: &'a BTreeMap<ObjectId, Warnings>,
    /// The one that the form is about.
    pub(crate) active: Option<&'a Object>,
    /// The material of objects to come.
    pub(crate) material: Material,
    /// Neighbours that a point is compared with where columns are estimated anew.
    pub(crate) neighbours: usize,
}

/// The tab.
pub(crate) fn scene_ui(ui: &mut Ui, tab: &SceneTab<'_>, out: &mut Intents) {
    let SceneTab {
        scene, warnings, ..
    } = tab;
    super::tab_ui(ui, |ui| {
        objects::buttons_ui(ui, scene, out);
        if scene.objects().is_empty() {
            ui.weak("The scene is empty.");
        } else {
            selection_ui(ui, scene, out);
            estimate_ui(ui, tab.neighbours, out);
        }
        for object in scene.objects() {
            ui.push_id(object.id.0, |ui| {
                object_ui(ui, object, warnings.get(&object.id), out);
                ui.separator();
            });
        }
        if let Some(active) = tab.active {
            objects::active_ui(ui, active, out);
            ui.separator();
            material_ui(ui, scene, tab.material, out);
        }
    });
}

/// How many objects are selected, and a way out of it.
fn selection_ui(ui: &mut Ui, scene: &Scene, out: &mut Intents) {
    let selected = scene.objects().iter().filter(|object| object.selected);
    ui.horizontal_wrapped(|ui| match selected.count() {
        0 => {
            ui.weak("A click on a name selects the object and makes it the active one: F frames it, and the material applies to it. Ctrl+click adds.");
        }
        count => {
            let objects = if count == 1 { "object" } else { "objects" };
            ui.weak(format!("{count} {objects} selected."));
            if ui.small_button("Select none").clicked() {
                out.push(SceneIntent::SelectNone);
            }
        }
    });
}

fn object_ui(ui: &mut Ui, object: &Object, warnings: Option<&Warnings>, out: &mut Intents) {
    ui.horizontal(|ui| {
        let mut visible = object.visible;
        let shown = ui
            .checkbox(&mut visible, "")
            .on_hover_text("Whether it is drawn");
        if shown
            .accessible_name(format!("Show {}", object.name))
            .changed()
        {
            out.push(SceneIntent::SetVisible(object.id, visible));
        }
        let name = egui::RichText::new(&object.name).strong();
        let hint = object
            .source
            .as_ref()
            .map_or_else(String::new, |path| path.display().to_string());
        let label = ui.selectable_label(object.selected, name);
        if label.on_hover_text(hint).clicked() {
            let adds = ui.input(|input| input.modifiers.command || input.modifiers.shift);
            out.push(if adds {
                SceneIntent::ToggleSelected(object.id)
            } else {
                SceneIntent::Select(object.id)
            });
        }
        let remove = ui.small_button("Remove");
        if remove
            .accessible_name(format!("Remove {}", object.name))
            .clicked()
        {
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
    if let Some(textures) = &geometry.textures {
        let names = textures
            .pictures
            .iter()
            .map(|picture| match &*picture.name {
                "" => "inside the file",
                name => name,
            });
        lines.push(format!(
            "textures: {}",
            names.collect::<Vec<_>>().join(", ")
        ));
    }
    lines
}
