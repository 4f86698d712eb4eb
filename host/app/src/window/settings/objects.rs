//! What is done with objects in the *Scene* tab: the row of buttons, and the form of the active one.

use egui::{DragValue, Slider, SliderClamping, TextEdit, Ui};
use glam::DVec3;
use pointstage_scene::{Object, Placement, Scene};

use crate::window::intent::{FileIntent, Intents, OpenMode, SceneIntent};

/// What the sliders of factors reach; typed ones may lie beyond.
const FACTORS: std::ops::RangeInclusive<f64> = 0.1..=10.0;

/// Degrees that a drag of one point turns.
const DEGREES_A_POINT: f64 = 0.5;

/// A drag of so many points moves an object by its own size.
const POINTS_A_SIZE: f64 = 300.0;

/// Adds, copies, unites and removes.
pub(super) fn buttons_ui(ui: &mut Ui, scene: &Scene, out: &mut Intents) {
    let selected = scene.objects().iter().filter(|object| object.selected);
    let selected = selected.count();
    let button = |ui: &mut Ui, name: &str, help: &str, is_enabled: bool| {
        let button = ui.add_enabled(is_enabled, egui::Button::new(name).small());
        button
            .on_hover_text(help)
            .on_disabled_hover_text(help)
            .clicked()
    };
    ui.horizontal_wrapped(|ui| {
        if button(ui, "Add…", "Adds files to the scene", true) {
            out.push(FileIntent::Choose(OpenMode::Add));
        }
        let help = "Copies the selected objects; a copy shares their surfels";
        if button(ui, "Duplicate", help, selected > 0) {
            out.push(SceneIntent::Duplicate);
        }
        let help = "Makes the selected objects one: two or more";
        if button(ui, "Merge", help, selected > 1) {
            out.push(SceneIntent::Merge);
        }
        let help = "Takes the selected objects out of the scene";
        if button(ui, "Remove selected", help, selected > 0) {
            out.push(SceneIntent::RemoveSelected);
        }
    });
}

/// Name, place and radius scale of the active object.
pub(super) fn active_ui(ui: &mut Ui, object: &Object, out: &mut Intents) {
    ui.push_id(("active object", object.id.0), |ui| {
        ui.horizontal(|ui| {
            ui.strong("Active object");
            placement_reset_ui(ui, object, out);
        });
        name_ui(ui, object, out);
        placement_ui(ui, object, out);
        super::row(
            ui,
            "Radius scale",
            "Factor on the radii of this object's surfels, besides that of the view",
            |ui| {
                let mut scale = f64::from(object.radius_scale);
                if factor_ui(ui, &mut scale) {
                    out.push(SceneIntent::SetRadiusScale(object.id, scale as f32));
                }
                if object.radius_scale != 1.0 && reset_ui(ui, "Reset radius scale") {
                    out.push(SceneIntent::SetRadiusScale(object.id, 1.0));
                }
            },
        );
    });
}

/// The name is taken with Enter, or when the field is left.
fn name_ui(ui: &mut Ui, object: &Object, out: &mut Intents) {
    super::row(
        ui,
        "Name",
        "Enter takes what was typed, Escape does not",
        |ui| {
            let id = egui::Id::unique(("name of object", object.id.0));
            let typed: Option<String> = ui.data(|data| data.get_temp(id));
            let mut name = typed.unwrap_or_else(|| object.name.clone());
            let field = ui.add(TextEdit::singleline(&mut name));
            if field.lost_focus() {
                ui.data_mut(|data| data.remove::<String>(id));
                let is_given_up = ui.input(|input| input.key_pressed(egui::Key::Escape));
                let name = name.trim();
                if !is_given_up && !name.is_empty() && name != object.name {
                    out.push(SceneIntent::Rename(object.id, name.to_owned()));
                }
            } else if field.has_focus() {
                ui.data_mut(|data| data.insert_temp(id, name));
            }
        },
    );
}

/// Where the object stands. Angles stay as they were typed: many angles make the same turn.
fn placement_ui(ui: &mut Ui, object: &Object, out: &mut Intents) {
    let pivot = object.pivot();
    let id = egui::Id::unique(("placement of object", object.id.0));
    let typed: Option<Placement> = ui.data(|data| data.get_temp(id));
    let typed = typed.filter(|typed| typed.world_from_object(pivot) == object.world_from_object);
    let shown = typed.or_else(|| Placement::of(&object.world_from_object, pivot));
    let Some(shown) = shown else {
        ui.weak("Its transform shears, mirrors or stretches it; 'reset place' takes it back to where its file puts it.");
        return;
    };
    let mut edited = shown;
    let size = object.geometry.bounds.size().max_element() * shown.scale;
    let move_speed = if size > 0.0 {
        size / POINTS_A_SIZE
    } else {
        0.01
    };
    super::row(
        ui,
        "Move",
        "How far it is from where its file puts it: x, y and z, scene units",
        |ui| three_ui(ui, "Move", &mut edited.translation, move_speed, ""),
    );
    super::row(
        ui,
        "Turn",
        "Turns about x, y and z through the middle of its box: first z, then y, then x",
        |ui| {
            three_ui(
                ui,
                "Turn",
                &mut edited.rotation_degrees,
                DEGREES_A_POINT,
                "°",
            );
        },
    );
    super::row(
        ui,
        "Scale",
        "Factor on all its lengths, about the middle of its box",
        |ui| {
            factor_ui(ui, &mut edited.scale);
        },
    );
    if edited != shown && edited.is_valid() {
        ui.data_mut(|data| data.insert_temp(id, edited));
        let map = edited.world_from_object(pivot);
        out.push(SceneIntent::SetTransform(object.id, map));
    }
}

fn placement_reset_ui(ui: &mut Ui, object: &Object, out: &mut Intents) {
    if object.world_from_object == object.placed {
        return;
    }
    let reset = ui.small_button("reset place");
    let reset = reset.on_hover_text("Takes it back to where its file puts it");
    if reset.accessible_name("Reset place").clicked() {
        out.push(SceneIntent::SetTransform(object.id, object.placed));
    }
}

fn reset_ui(ui: &mut Ui, name: &str) -> bool {
    let reset = ui.small_button("reset").on_hover_text(name);
    reset.accessible_name(name).clicked()
}

/// Three numbers, each with a name of its own for screen readers.
fn three_ui(ui: &mut Ui, name: &str, values: &mut DVec3, speed: f64, suffix: &str) {
    ui.spacing_mut().item_spacing.x = 3.0;
    for (axis, value) in ["x", "y", "z"].into_iter().zip(values.as_mut()) {
        let field = DragValue::new(value)
            .speed(speed)
            .max_decimals(4)
            .suffix(suffix);
        let field = ui.add(field).on_hover_text(axis);
        field.accessible_name(format!("{name} {axis}"));
    }
}

/// A factor above 0; whether it was edited.
fn factor_ui(ui: &mut Ui, factor: &mut f64) -> bool {
    let before = *factor;
    let slider = Slider::new(factor, FACTORS)
        .logarithmic(true)
        .clamping(SliderClamping::Never)
        .max_decimals(3);
    ui.add(slider);
    if !(factor.is_finite() && *factor > 0.0) {
        *factor = before;
    }
    *factor != before
}
