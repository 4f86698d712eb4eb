use egui::accesskit::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use pointstage_engine::plugins::Remedy;
use pointstage_plugin_api::settings_schema::SettingValues;

use super::super::renderer::{RendererTab, renderer_ui};
use super::{asking, assert_asked, renderer, schema_of};
use crate::window::intent::{Intents, RendererIntent, SceneIntent};
use crate::window::presets::PresetList;
use crate::window::recommend::Recommendation;
use crate::window::rows::{Obstacle, RendererRow, Rows};

/// The tab with these rows, of which `chosen` is the main renderer.
fn tab(
    rows: Rows,
    chosen: &'static str,
    preview: Option<&'static str>,
    drawn_by: &'static str,
) -> Harness<'static, Intents> {
    asking(move |ui, asked| {
        let tab = RendererTab {
            rows: &rows,
            chosen,
            preview,
            chosen_structure: Some("tree"),
            drawn_by: Some(drawn_by),
            values: &SettingValues::new(),
            structure_values: &SettingValues::new(),
            presets: &PresetList {
                names: Vec::new(),
                active: "Defaults".into(),
                differs: false,
            },
            focus: None,
        };
        renderer_ui(ui, &tab, asked);
    })
}

fn rows(renderers: Vec<RendererRow>) -> Rows {
    Rows {
        renderers,
        ..Rows::default()
    }
}

fn points_and_splats() -> Rows {
    rows(vec![renderer("a", "Points"), renderer("b", "Lit splats")])
}

fn splats_need_normals() -> Rows {
    let mut rows = points_and_splats();
    rows.renderers[1].obstacle = Some(Obstacle {
        reason: "It needs normals, and 'scan' has none.".into(),
        remedy: Some(Remedy::EstimateNormals),
    });
    rows
}

#[test]
fn a_renderer_is_chosen_by_a_click() {
    let mut harness = tab(points_and_splats(), "a", None, "a");
    harness
        .get_by_role_and_label(Role::RadioButton, "Lit splats")
        .click();
    harness.run();
    assert_asked(&harness, RendererIntent::Choose("b".into()));
}

#[test]
fn an_unsuitable_renderer_is_grey_with_reason_and_remedy() {
    let mut harness = tab(splats_need_normals(), "a", None, "a");
    let radio = harness.get_by_role_and_label(Role::RadioButton, "Lit splats");
    assert!(radio.accesskit_node().is_disabled());
    radio.click();
    harness.run();
    assert!(harness.state().is_empty(), "a grey renderer was chosen");
    harness.get_by_label("It needs normals, and 'scan' has none.");
    harness.get_by_label("Estimate normals").click();
    harness.run();
    assert_asked(&harness, SceneIntent::Estimate);
}

#[test]
fn the_recommended_renderer_says_why() {
    let mut rows = points_and_splats();
    rows.recommended = Some(Recommendation {
        id: "b".into(),
        why: "uses the normals that this scene has".into(),
    });
    let harness = tab(rows, "a", None, "a");
    harness.get_by_label("Recommended: uses the normals that this scene has.");
}

#[test]
fn a_preview_is_chosen_from_a_list_where_the_main_renderer_is_none() {
    let mut rows = points_and_splats();
    rows.recommended_preview = Some(Recommendation {
        id: "a".into(),
        why: "fastest: needs positions only".into(),
    });
    let mut harness = tab(rows, "b", None, "b");
    harness
        .get_by_role_and_label(Role::ComboBox, "Preview")
        .click();
    harness.run();
    assert_eq!(
        harness.query_all_by_label("Lit splats").count(),
        2,
        "radio and heading alone"
    );
    harness.get_by_label("Recommended: fastest: needs positions only.");
    harness
        .get_by_role_and_label(Role::Button, "Points")
        .click();
    harness.run();
    assert_asked(&harness, RendererIntent::ChoosePreview(Some("a".into())));
}

#[test]
fn an_unsuitable_preview_is_grey_and_one_that_became_so_says_why() {
    let mut harness = tab(splats_need_normals(), "a", None, "a");
    harness
        .get_by_role_and_label(Role::ComboBox, "Preview")
        .click();
    harness.run();
    let button = harness.get_by_role_and_label(Role::Button, "Lit splats");
    assert!(button.accesskit_node().is_disabled());
    let harness = tab(splats_need_normals(), "a", Some("b"), "a");
    let reason = "It needs normals, and 'scan' has none.";
    assert_eq!(
        harness.query_all_by_label(reason).count(),
        2,
        "in the list and below the preview"
    );
}

#[test]
fn a_stranger_s_picture_is_named_and_the_preview_s_is_not() {
    let harness = tab(points_and_splats(), "a", None, "b");
    harness.get_by_label("The picture is by Lit splats meanwhile.");
    let harness = tab(points_and_splats(), "a", Some("b"), "b");
    assert!(harness.query_by_label_contains("meanwhile").is_none());
}

#[test]
fn the_structure_s_settings_stand_below() {
    let mut rows = points_and_splats();
    let mut tree = renderer("tree", "Sequential point tree");
    tree.settings = schema_of(
        r#"{ "id": "fan", "kind": "int", "default": 8, "min": 2, "max": 64, "label": "Fan-out" }"#,
    );
    rows.structures = vec![tree];
    let mut harness = tab(rows, "a", None, "a");
    let slider = harness.get_by_role_and_label(Role::Slider, "Fan-out");
    slider.set_value_accesskit(16.0);
    harness.run();
    let expected = RendererIntent::SetOfStructure(
        "fan".into(),
        pointstage_plugin_api::settings_schema::SettingValue::Int(16),
    );
    assert_eq!(harness.state().first(), Some(&expected.into()));
}

#[test]
fn only_renderers_with_settings_of_the_same_id_can_be_copied_from() {
    let scale = || schema_of(r#"{ "id": "scale", "kind": "float", "default": 1 }"#);
    let other = || schema_of(r#"{ "id": "other", "kind": "float", "default": 1 }"#);
    let mut all = points_and_splats();
    all.renderers.push(renderer("c", "Dots"));
    for (row, settings) in all.renderers.iter_mut().zip([scale(), scale(), other()]) {
        row.settings = settings;
    }
    let mut harness = tab(all, "a", None, "a");
    harness.get_by_label("Copy from…").click();
    harness.run();
    assert!(
        harness
            .query_by_role_and_label(Role::Button, "Dots")
            .is_none()
    );
    harness
        .get_by_role_and_label(Role::Button, "Lit splats")
        .click();
    harness.run();
    assert_asked(&harness, RendererIntent::CopyFrom("b".into()));
}

/// The tab with two renderers, for other tests.
pub(super) fn points_and_splats_tab() -> Harness<'static, Intents> {
    tab(points_and_splats(), "a", None, "a")
}
