//! The tabs of the settings panel, through the labels that people and screen readers see.

mod keyboard;
mod lighting;
mod plugins;
mod presets;
mod renderer;
mod scene;
mod schema;
mod view;

use egui::Ui;
use egui::accesskit::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use pointstage_plugin_api::settings_schema::SettingSchema;

use crate::window::intent::{Intent, Intents};
use crate::window::rows::RendererRow;
use crate::window::test_schema::schema_of;

/// A schema with every kind of setting: in groups, with ranges of every kind, a condition, a shortcut.
fn every_kind() -> Vec<SettingSchema> {
    schema_of(
        r#"{ "id": "cull", "kind": "bool", "default": true, "label": "Cull back faces", "help": "Hides what faces away", "shortcut": "C" },
           { "id": "passes", "kind": "int", "default": 2, "min": 1, "max": 64, "soft_max": 8, "label": "Passes", "group": "Quality" },
           { "id": "scale", "kind": "float", "default": 1, "min": 0.01, "max": 100, "soft_min": 0.1, "soft_max": 10, "scale": "logarithmic", "unit": "px", "label": "Splat scale", "group": "Quality" },
           { "id": "amount", "kind": "float", "default": 0.5, "min": 0, "max": 1, "step": 0.1, "label": "Amount", "group": "Quality" },
           { "id": "seed", "kind": "int", "default": 0, "label": "Seed" },
           { "id": "offset", "kind": "float", "default": 0, "max": 5, "label": "Offset" },
           { "id": "mode", "kind": "choice", "default": "round", "label": "Shape",
             "options": [{ "id": "round", "label": "Round" }, { "id": "square", "label": "Square" }] },
           { "id": "tint", "kind": "colour", "default": [1, 1, 1, 1], "label": "Tint" },
           { "id": "note", "kind": "text", "default": "hello", "label": "Note" },
           { "id": "rebuild", "kind": "action", "label": "Rebuild tree", "cost": "prepare" },
           { "id": "corner", "kind": "float", "default": 0.5, "min": 0, "max": 1, "label": "Corner",
             "visible_if": { "id": "mode", "equals": "square" } }"#,
    )
}

/// A renderer's row without anything to remark.
fn renderer(id: &str, title: &str) -> RendererRow {
    RendererRow {
        id: id.into(),
        alias: id.into(),
        title: title.into(),
        version: "1.0.0".into(),
        about: String::new(),
        needs: String::new(),
        gives: pointstage_plugin_api::manifest::Gives::default(),
        obstacle: None,
        refines: false,
        settings: Vec::new(),
    }
}

/// A tab that only asks: what it pushes stays in the state.
fn asking(mut tab: impl FnMut(&mut Ui, &mut Intents) + 'static) -> Harness<'static, Intents> {
    Harness::builder()
        .with_size([420.0, 900.0])
        .build_ui_state(move |ui, asked| tab(ui, asked), Intents::new())
}

/// Asserts that just this was asked for.
fn assert_asked(harness: &Harness<'_, Intents>, expected: impl Into<Intent>) {
    let asked: &[Intent] = harness.state();
    assert_eq!(asked, [expected.into()]);
}

/// Opens the list of this name and chooses from it.
fn choose<State>(harness: &mut Harness<'_, State>, list: &str, option: &str) {
    harness.get_by_role_and_label(Role::ComboBox, list).click();
    harness.run();
    harness.get_by_label(option).click();
    harness.run();
}
