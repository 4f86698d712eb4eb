//! The *Lighting* tab: ambient light and up to four sources.

use egui::{DragValue, ScrollArea, Slider, Ui};
use glam::{DVec3, Vec3};
use pointstage_scene::{Light, LightKind, LightSpace, Lights, MAX_LIGHTS};

use crate::window::intent::{Intents, LightIntent};

/// The tab. Edits come out as [`LightIntent::Set`] with all lights.
pub(crate) fn lighting_ui(ui: &mut Ui, lights: &Lights, out: &mut Intents) {
    let mut edited = lights.clone();
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        super::row(ui, "Ambient", "Light from everywhere", |ui| {
            colour_and_strength_ui(ui, &mut edited.ambient);
        });
        let mut removed = None;
        for (index, light) in edited.lights.iter_mut().enumerate().take(MAX_LIGHTS) {
            ui.push_id(index, |ui| {
                ui.separator();
                ui.horizontal(|ui| {
                    ui.strong(format!("Light {}", index + 1));
                    if ui.small_button("Remove").clicked() {
                        removed = Some(index);
                    }
                });
                light_ui(ui, light);
            });
        }
        if let Some(index) = removed {
            edited.lights.remove(index);
        }
        ui.separator();
        ui.horizontal(|ui| {
            let has_room = edited.lights.len() < MAX_LIGHTS;
            let add = ui
                .add_enabled(has_room, egui::Button::new("Add light"))
                .on_disabled_hover_text(format!("A view has at most {MAX_LIGHTS} lights."));
            if add.clicked() {
                edited.lights.push(headlight());
            }
            if ui.button("Reset lights").clicked() {
                edited = Lights::default();
            }
        });
    });
    if edited != *lights {
        out.push(LightIntent::Set(edited));
    }
}

/// A light from the eye.
fn headlight() -> Light {
    Light {
        kind: LightKind::Directional { towards: DVec3::Z },
        space: LightSpace::View,
        colour: Vec3::splat(0.5),
    }
}

fn light_ui(ui: &mut Ui, light: &mut Light) {
    super::row(ui, "Kind", "", |ui| {
        let is_point = matches!(light.kind, LightKind::Point { .. });
        if ui.selectable_label(!is_point, "directional").clicked() && is_point {
            let LightKind::Point { position } = light.kind else {
                return;
            };
            light.kind = LightKind::Directional {
                towards: position.try_normalize().unwrap_or(DVec3::Z),
            };
        }
        if ui.selectable_label(is_point, "point").clicked() && !is_point {
            let LightKind::Directional { towards } = light.kind else {
                return;
            };
            light.kind = LightKind::Point { position: towards };
        }
    });
    super::row(
        ui,
        "Moves with",
        "The eye: a headlight. The scene: it stays where it is.",
        |ui| {
            ui.selectable_value(&mut light.space, LightSpace::View, "the eye");
            ui.selectable_value(&mut light.space, LightSpace::World, "the scene");
        },
    );
    super::row(ui, "Colour", "", |ui| {
        colour_and_strength_ui(ui, &mut light.colour);
    });
    match &mut light.kind {
        LightKind::Directional { towards } => direction_ui(ui, towards),
        LightKind::Point { position } => position_ui(ui, position),
    }
}

/// A direction as two angles: azimuth from the front to the right, elevation above the horizon.
fn direction_ui(ui: &mut Ui, towards: &mut DVec3) {
    let unit = towards.try_normalize().unwrap_or(DVec3::Z);
    let mut azimuth = unit.x.atan2(unit.z).to_degrees();
    let mut elevation = unit.y.clamp(-1.0, 1.0).asin().to_degrees();
    let mut changed = false;
    super::row(
        ui,
        "Azimuth",
        "0° from the front, 90° from the right",
        |ui| {
            let slider = Slider::new(&mut azimuth, -180.0..=180.0)
                .suffix("°")
                .max_decimals(1);
            changed |= ui.add(slider).changed();
        },
    );
    super::row(ui, "Elevation", "90° from above", |ui| {
        let slider = Slider::new(&mut elevation, -90.0..=90.0)
            .suffix("°")
            .max_decimals(1);
        changed |= ui.add(slider).changed();
    });
    if changed {
        let (sin_azimuth, cos_azimuth) = azimuth.to_radians().sin_cos();
        let (sin_elevation, cos_elevation) = elevation.to_radians().sin_cos();
        *towards = DVec3::new(
            cos_elevation * sin_azimuth,
            sin_elevation,
            cos_elevation * cos_azimuth,
        );
    }
}

fn position_ui(ui: &mut Ui, position: &mut DVec3) {
    for (name, value) in ["x", "y", "z"].into_iter().zip(position.as_mut()) {
        super::row(ui, &format!("Position {name}"), "Scene units", |ui| {
            let speed = (value.abs() * 0.01).max(0.01);
            ui.add(DragValue::new(value).speed(speed).max_decimals(4));
        });
    }
}

/// Linear colour as a hue with the greatest channel 1, and a strength.
fn colour_and_strength_ui(ui: &mut Ui, colour: &mut Vec3) {
    let strength_now = colour.max_element();
    let mut strength = strength_now;
    let mut hue = if strength_now > 0.0 {
        (*colour / strength_now).to_array()
    } else {
        [1.0; 3]
    };
    let before = ui.available_width();
    let picked = ui.color_edit_button_rgb(&mut hue).changed();
    let taken = before - ui.available_width();
    super::set_slider_width(ui, ui.spacing().slider_width - taken);
    let slid = ui
        .add(Slider::new(&mut strength, 0.0..=2.0).max_decimals(2))
        .on_hover_text("Strength")
        .changed();
    if picked || slid {
        *colour = Vec3::from_array(hue) * strength.max(0.0);
    }
}
