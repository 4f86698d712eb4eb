//! The *Lighting* tab: headlight, ambient light, up to four sources, and how objects take light.

use egui::{DragValue, Slider, SliderClamping, Ui};
use glam::{DVec3, Vec3};
use pointstage_scene::{Headlight, Light, LightKind, LightSpace, Lights, MAX_LIGHTS, Scene};

use super::material::material_ui;
use crate::window::intent::{Intents, LightIntent};
use crate::window::light_presets::{LIGHT_PRESETS, preset_of};

/// Showing a value must not round it: only what is edited is brought into the slider's range and digits.
const UNTOUCHED: SliderClamping = SliderClamping::Edits;

/// What the tab shows.
pub(crate) struct LightingTab<'a> {
    /// All lights.
    pub(crate) lights: &'a Lights,
    /// Whose material is shown.
    pub(crate) scene: &'a Scene,
    /// The material of objects to come.
    pub(crate) material: pointstage_scene::Material,
}

/// The tab. Edits come out as [`LightIntent::Set`] with all lights, and as [`LightIntent::Material`].
pub(crate) fn lighting_ui(ui: &mut Ui, tab: &LightingTab<'_>, out: &mut Intents) {
    let mut edited = tab.lights.clone();
    super::tab_ui(ui, |ui| {
        presets_ui(ui, &mut edited);
        headlight_ui(ui, &mut edited.headlight);
        super::row(ui, "Ambient", "Light from everywhere", |ui| {
            colour_and_strength_ui(ui, &mut edited.ambient);
        });
        lights_ui(ui, &mut edited);
        ui.separator();
        material_ui(ui, tab.scene, tab.material, out);
    });
    if edited != *tab.lights {
        out.push(LightIntent::Set(edited));
    }
}

fn presets_ui(ui: &mut Ui, lights: &mut Lights) {
    ui.horizontal_wrapped(|ui| {
        ui.label("Presets");
        let now = preset_of(lights);
        for preset in &LIGHT_PRESETS {
            let is_now = now == Some(preset.name);
            let button = ui.selectable_label(is_now, preset.name);
            if button.on_hover_text(preset.help).clicked() && !is_now {
                *lights = (preset.lights)();
            }
        }
    });
}

fn headlight_ui(ui: &mut Ui, headlight: &mut Headlight) {
    super::row(
        ui,
        "Headlight",
        "One white light at the eye, instead of all lights below; they stay as they are",
        |ui| {
            ui.checkbox(&mut headlight.enabled, "");
        },
    );
    if headlight.enabled {
        super::row(ui, "Its strength", "", |ui| {
            let slider = Slider::new(&mut headlight.strength, 0.0..=2.0);
            ui.add(slider.clamping(UNTOUCHED).max_decimals(2));
        });
    }
}

fn lights_ui(ui: &mut Ui, edited: &mut Lights) {
    if edited.headlight.enabled && !edited.lights.is_empty() {
        ui.weak("These are off while the headlight is on.");
    }
    let mut removed = None;
    for (index, light) in edited.lights.iter_mut().enumerate().take(MAX_LIGHTS) {
        ui.push_id(index, |ui| {
            ui.separator();
            ui.horizontal(|ui| {
                let name = format!("Light {}", index + 1);
                ui.checkbox(&mut light.enabled, egui::RichText::new(&name).strong())
                    .on_hover_text("Whether it shines");
                let remove = ui.small_button("Remove");
                if remove.accessible_name(format!("Remove {name}")).clicked() {
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
            edited.lights.push(new_light());
        }
        if ui.button("Reset lights").clicked() {
            *edited = Lights::default();
        }
    });
}

/// A light from the eye, weak enough to join others.
fn new_light() -> Light {
    let half = Headlight {
        enabled: true,
        strength: 0.5,
    };
    half.as_light()
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
                .clamping(UNTOUCHED)
                .suffix("°")
                .max_decimals(1);
            changed |= ui.add(slider).changed();
        },
    );
    super::row(ui, "Elevation", "90° from above", |ui| {
        let slider = Slider::new(&mut elevation, -90.0..=90.0)
            .clamping(UNTOUCHED)
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
        .add(
            Slider::new(&mut strength, 0.0..=2.0)
                .clamping(UNTOUCHED)
                .max_decimals(2),
        )
        .on_hover_text("Strength")
        .changed();
    if picked || slid {
        *colour = Vec3::from_array(hue) * strength.max(0.0);
    }
}
