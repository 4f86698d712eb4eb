use std::sync::Arc;

use egui::accesskit::{Role, Toggled};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use pointstage_scene::{Block, Geometry, Lights, Material, Object, Origins, Scene};

use super::super::lighting::{LightingTab, lighting_ui};
use crate::window::intent::{Intent, Intents, LightIntent};

struct Panel {
    lights: Lights,
    scene: Scene,
    material: Material,
}

fn tab(scene: Scene) -> Harness<'static, Panel> {
    let panel = Panel {
        lights: Lights::default(),
        scene,
        material: Material::default(),
    };
    let app = move |ui: &mut egui::Ui, panel: &mut Panel| {
        let mut asked = Intents::new();
        let tab = LightingTab {
            lights: &panel.lights,
            scene: &panel.scene,
            material: panel.material,
        };
        lighting_ui(ui, &tab, &mut asked);
        for intent in asked {
            match intent {
                Intent::Light(LightIntent::Set(lights)) => panel.lights = lights,
                Intent::Light(LightIntent::Material(material)) => panel.material = material,
                other => panic!("{other:?}"),
            }
        }
    };
    Harness::builder()
        .with_size([420.0, 1200.0])
        .build_ui_state(app, panel)
}

fn object(name: &str, selected: bool, ks: f32) -> Object {
    let block = Block {
        position_radius: Arc::from([[0.0, 0.0, 0.0, 1.0]]),
        ..Block::default()
    };
    let geometry = Geometry::new(vec![block], None, Origins::default());
    let mut object = Object::new(name, glam::DVec3::ZERO, geometry);
    object.selected = selected;
    object.material.ks = ks;
    object
}

#[test]
fn the_headlight_is_switched_and_the_lights_stay_as_they_are() {
    let mut harness = tab(Scene::new());
    harness
        .get_by_role_and_label(Role::CheckBox, "Headlight")
        .click();
    harness.run();
    let lights = &harness.state().lights;
    assert!(lights.headlight.enabled && lights.lights == Lights::default().lights);
    harness.get_by_label("These are off while the headlight is on.");
    let slider = harness.get_by_role_and_label(Role::Slider, "Its strength");
    slider.set_value_accesskit(0.5);
    harness.run();
    assert_eq!(harness.state().lights.headlight.strength, 0.5);
    harness
        .get_by_role_and_label(Role::CheckBox, "Headlight")
        .click();
    harness.run();
    assert_eq!(harness.state().lights.lights, Lights::default().lights);
}

#[test]
fn a_light_is_switched_off_without_losing_it() {
    let mut harness = tab(Scene::new());
    let switch = harness.get_by_role_and_label(Role::CheckBox, "Light 1");
    assert_eq!(switch.accesskit_node().toggled(), Some(Toggled::True));
    switch.click();
    harness.run();
    let lights = &harness.state().lights;
    assert_eq!((lights.lights.len(), lights.enabled().len()), (2, 1));
}

#[test]
fn no_more_than_four_lights_are_added_and_one_is_removed() {
    let mut harness = tab(Scene::new());
    for _ in 0..4 {
        harness.get_by_label("Add light").click();
        harness.run();
    }
    assert_eq!(harness.state().lights.lights.len(), 4);
    assert!(
        harness
            .get_by_label("Add light")
            .accesskit_node()
            .is_disabled()
    );
    harness.get_by_label("Remove Light 2").click();
    harness.run();
    assert_eq!(harness.state().lights.lights.len(), 3);
    harness.get_by_label("Reset lights").click();
    harness.run();
    assert_eq!(harness.state().lights, Lights::default());
}

#[test]
fn presets_are_chosen_by_a_click() {
    let mut harness = tab(Scene::new());
    harness.get_by_label("Three-point").click();
    harness.run();
    assert_eq!(harness.state().lights.lights.len(), 3);
    harness.get_by_label("Flat").click();
    harness.run();
    assert!(harness.state().lights.enabled().is_empty());
    harness.get_by_label("Default").click();
    harness.run();
    assert_eq!(harness.state().lights, Lights::default());
}

#[test]
fn the_material_says_whose_it_is() {
    let mut harness = tab(Scene::new());
    harness.get_by_label("Of all objects. Select some in the Scene tab to change theirs alone.");
    let slider = harness.get_by_role_and_label(Role::Slider, "Specular ks");
    slider.set_value_accesskit(0.75);
    harness.run();
    assert_eq!(harness.state().material.ks, 0.75);
    harness.get_by_label("Reset material").click();
    harness.run();
    assert_eq!(harness.state().material, Material::default());

    let mut scene = Scene::new();
    scene.add(object("bust", true, 0.3));
    scene.add(object("floor", false, 0.1));
    let harness = tab(scene.clone());
    harness.get_by_label("Of 'bust', which is selected.");
    let slider = harness.get_by_role_and_label(Role::Slider, "Specular ks");
    let shown = slider.accesskit_node().numeric_value().unwrap_or_default();
    assert!((shown - 0.3).abs() < 1e-6, "the selected object's: {shown}");

    scene.add(object("table", true, 0.9));
    let harness = tab(scene);
    harness.get_by_label("Of the 2 selected objects.");
    harness.get_by_label_contains("Their materials differ");
}

#[test]
fn a_sharper_highlight_than_the_slider_s_may_be_typed() {
    let mut harness = tab(Scene::new());
    let slider = harness.get_by_role_and_label(Role::Slider, "Shininess n");
    slider.set_value_accesskit(1000.0);
    harness.run();
    assert_eq!(harness.state().material.shininess, 1000.0);
}
