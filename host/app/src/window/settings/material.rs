//! How objects take light: ka, kd, ks and n of Blinn and Phong, of the selected objects or of all.

use egui::{Slider, SliderClamping, Ui};
use pointstage_scene::{Material, Object, Scene};

use crate::window::intent::{Intents, LightIntent};

/// The greatest exponent of the slider; a typed one may be greater.
const SHARPEST: f32 = 256.0;

/// The material of the selected objects, or of all and those to come if none is selected.
pub(super) fn material_ui(ui: &mut Ui, scene: &Scene, to_come: Material, out: &mut Intents) {
    let selected: Vec<&Object> = scene
        .objects()
        .iter()
        .filter(|object| object.selected)
        .collect();
    let shown = selected.first().map_or(to_come, |object| object.material);
    ui.horizontal(|ui| {
        ui.strong("Material");
        if shown != Material::default() {
            let reset = ui.small_button("reset").on_hover_text("Reset the material");
            if reset.accessible_name("Reset material").clicked() {
                out.push(LightIntent::Material(Material::default()));
            }
        }
    });
    ui.weak(applies_to(&selected));
    if differs(scene, &selected, shown) {
        ui.weak("Their materials differ; a change gives all of them the same.");
    }
    let mut edited = shown;
    let parts = [
        (
            "Ambient ka",
            "Part of the ambient light reflected",
            &mut edited.ka,
        ),
        (
            "Diffuse kd",
            "Part of the light reflected in all directions",
            &mut edited.kd,
        ),
        (
            "Specular ks",
            "Part of the light reflected as a white highlight",
            &mut edited.ks,
        ),
    ];
    for (name, help, value) in parts {
        super::row(ui, name, help, |ui| {
            // Showing a value must not round it.
            let slider = Slider::new(value, 0.0..=1.0).clamping(SliderClamping::Edits);
            ui.add(slider.max_decimals(3));
        });
    }
    super::row(
        ui,
        "Shininess n",
        "Exponent of the highlight; greater is smaller and sharper",
        |ui| {
            let slider = Slider::new(&mut edited.shininess, 1.0..=SHARPEST)
                .logarithmic(true)
                .clamping(SliderClamping::Never)
                .max_decimals(1);
            ui.add(slider);
        },
    );
    let values = [edited.ka, edited.kd, edited.ks, edited.shininess];
    if edited != shown
        && values
            .iter()
            .all(|value| value.is_finite() && *value >= 0.0)
    {
        out.push(LightIntent::Material(edited));
    }
}

/// Says whose material it is.
fn applies_to(selected: &[&Object]) -> String {
    match selected {
        [] => "Of all objects. Select some in the Scene tab to change theirs alone.".to_owned(),
        [object] => format!("Of '{}', which is selected.", object.name),
        objects => format!("Of the {} selected objects.", objects.len()),
    }
}

fn differs(scene: &Scene, selected: &[&Object], shown: Material) -> bool {
    let differs = |object: &Object| object.material != shown;
    if selected.is_empty() {
        scene.objects().iter().any(differs)
    } else {
        selected.iter().any(|object| differs(object))
    }
}
