use std::collections::BTreeMap;
use std::sync::Arc;

use egui::accesskit::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use glam::{DAffine3, DVec3};
use pointstage_scene::estimate::Steps;
use pointstage_scene::{Block, Geometry, Material, Object, ObjectId, Origins, Scene};

use super::super::scene::{SceneTab, scene_ui};
use super::{asking, assert_asked};
use crate::window::intent::{Intent, Intents, SceneIntent};

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
    tab_of(scene, None)
}

/// The tab with an active object.
fn tab_of(scene: Scene, active: Option<ObjectId>) -> Harness<'static, Intents> {
    asking(move |ui, asked| {
        let tab = SceneTab {
            scene: &scene,
            warnings: &BTreeMap::new(),
            active: active.and_then(|id| scene.object(id)),
            material: Material::default(),
            neighbours: 12,
        };
        scene_ui(ui, &tab, asked);
    })
}

#[test]
fn what_can_be_done_depends_on_how_many_are_selected() {
    let (mut scene, [bust, floor]) = scene();
    for (selected, enabled) in [
        (vec![], [false, false, false]),
        (vec![bust], [true, false, true]),
        (vec![bust, floor], [true, true, true]),
    ] {
        for id in selected {
            scene.edit(id, |object| object.selected = true);
        }
        let harness = tab(scene.clone());
        let is_enabled = |name: &str| {
            let button = harness.get_by_role_and_label(Role::Button, name);
            !button.accesskit_node().is_disabled()
        };
        let found = ["Duplicate", "Merge", "Remove selected"].map(is_enabled);
        assert_eq!(found, enabled);
    }
    let mut harness = tab(scene);
    harness.get_by_role_and_label(Role::Button, "Merge").click();
    harness.run();
    assert_asked(&harness, SceneIntent::Merge);
}

#[test]
fn the_active_object_s_name_is_typed() {
    let (scene, [bust, _]) = scene();
    let mut harness = tab_of(scene, Some(bust));
    harness
        .get_by_role_and_label(Role::TextInput, "Name")
        .focus();
    harness.run();
    harness
        .get_by_role_and_label(Role::TextInput, "Name")
        .type_text(" of Ada");
    harness.run();
    harness.key_press(egui::Key::Enter);
    harness.run();
    assert_asked(
        &harness,
        SceneIntent::Rename(bust, "bust of Ada".to_owned()),
    );
}

#[test]
fn the_active_object_is_turned_by_a_typed_angle_and_reset() {
    let (mut scene, [bust, _]) = scene();
    let mut harness = tab_of(scene.clone(), Some(bust));
    harness
        .get_by_role_and_label(Role::SpinButton, "Turn z")
        .set_value_accesskit(90.0);
    harness.run();
    let expected = DAffine3::from_rotation_z(std::f64::consts::FRAC_PI_2);
    let asked: &[Intent] = harness.state();
    let [Intent::Scene(SceneIntent::SetTransform(id, map))] = asked else {
        panic!("{asked:?}")
    };
    assert!(*id == bust && map.abs_diff_eq(expected, 1e-12), "{map:?}");

    scene.edit(bust, |object| object.world_from_object = expected);
    let mut harness = tab_of(scene, Some(bust));
    harness.get_by_label("Reset place").click();
    harness.run();
    assert_asked(
        &harness,
        SceneIntent::SetTransform(bust, DAffine3::IDENTITY),
    );
}

#[test]
fn a_stretched_object_has_no_numbers_but_can_be_reset() {
    let (mut scene, [bust, _]) = scene();
    scene.edit(bust, |object| {
        object.world_from_object = DAffine3::from_scale(DVec3::new(1.0, 2.0, 1.0));
    });
    let harness = tab_of(scene, Some(bust));
    assert!(harness.query_by_label("Turn z").is_none());
    harness.get_by_label("Reset place");
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

#[test]
fn columns_are_estimated_with_the_neighbours_shown() {
    let (scene, _) = scene();
    let mut harness = tab(scene);
    harness.get_by_label("Orient normals").click();
    harness.run();
    let steps = Steps {
        orientation: true,
        neighbours: 12,
        ..Steps::default()
    };
    assert_asked(&harness, SceneIntent::EstimateAnew(steps));
}
