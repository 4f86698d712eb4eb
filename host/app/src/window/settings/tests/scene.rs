use std::collections::BTreeMap;
use std::sync::Arc;

use egui::accesskit::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use glam::DVec3;
use pointstage_scene::{Block, Geometry, Object, ObjectId, Origins, Scene};

use super::super::scene::scene_ui;
use super::{asking, assert_asked};
use crate::window::intent::{Intents, SceneIntent};

fn scene() -> (Scene, [ObjectId; 2]) {
    let mut scene = Scene::new();
    let ids = ["bust", "floor"].map(|name| {
        let block = Block {
            position_radius: Arc::from([[0.0, 0.0, 0.0, 1.0]]),
            ..Block::default()
        };
        let geometry = Geometry::new(vec![block], None, Origins::default());
        scene.add(Object::new(name, DVec3::ZERO, geometry))
    });
    (scene, ids)
}

fn tab(scene: Scene) -> Harness<'static, Intents> {
    asking(move |ui, asked| scene_ui(ui, &scene, &BTreeMap::new(), asked))
}

#[test]
fn a_click_on_the_name_selects_and_with_ctrl_it_adds() {
    let (scene, [bust, _]) = scene();
    let mut harness = tab(scene.clone());
    harness.get_by_label("bust").click();
    harness.run();
    assert_asked(&harness, SceneIntent::Select(bust));
    let mut harness = tab(scene);
    harness
        .get_by_label("bust")
        .click_modifiers(egui::Modifiers::COMMAND);
    harness.run();
    assert_asked(&harness, SceneIntent::ToggleSelected(bust));
}

#[test]
fn the_selection_is_counted_and_left() {
    let (mut scene, [bust, _]) = scene();
    scene.edit(bust, |object| object.selected = true);
    let mut harness = tab(scene);
    harness.get_by_label("1 object selected.");
    harness.get_by_label("Select none").click();
    harness.run();
    assert_asked(&harness, SceneIntent::SelectNone);
}

#[test]
fn an_object_is_hidden_and_removed() {
    let (scene, [bust, floor]) = scene();
    let mut harness = tab(scene.clone());
    harness
        .get_by_role_and_label(Role::CheckBox, "Show bust")
        .click();
    harness.run();
    assert_asked(&harness, SceneIntent::SetVisible(bust, false));
    let mut harness = tab(scene);
    harness.get_by_label("Remove floor").click();
    harness.run();
    assert_asked(&harness, SceneIntent::Remove(floor));
}
