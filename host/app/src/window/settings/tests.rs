//! The settings panel, driven by a schema with every kind of setting, through the labels that people see.

use egui::accesskit::{Role, Toggled};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use pointstage_engine::plugins::Remedy;
use pointstage_plugin_api::manifest::Manifest;
use pointstage_plugin_api::settings_schema::{SettingSchema, SettingValue, SettingValues};

use super::renderer::{RendererTab, renderer_ui};
use super::schema::schema_ui;
use crate::window::intent::{Intent, Intents, RendererIntent, SceneIntent};
use crate::window::rows::{Obstacle, RendererRow};

/// A schema with every kind of setting.
fn schema() -> Vec<SettingSchema> {
    let manifest = br#"{
        "format": 1, "vendor": "Test", "licence": "MIT", "api": "1.0",
        "plugins": [{
            "kind": "renderer", "id": "org.example.all", "version": "1.0.0",
            "needs": {}, "gives": { "targets": ["colour"] },
            "settings": [
                { "id": "cull", "kind": "bool", "default": true, "label": "Cull back faces", "help": "Hides what faces away" },
                { "id": "passes", "kind": "int", "default": 2, "min": 1, "max": 64, "soft_max": 8, "label": "Passes", "group": "Quality" },
                { "id": "scale", "kind": "float", "default": 1, "min": 0.01, "max": 100, "soft_min": 0.1, "soft_max": 10, "scale": "logarithmic", "unit": "px", "label": "Splat scale", "group": "Quality" },
                { "id": "offset", "kind": "float", "default": 0, "label": "Offset" },
                { "id": "mode", "kind": "choice", "default": "round", "label": "Shape",
                  "options": [{ "id": "round", "label": "Round" }, { "id": "square", "label": "Square" }] },
                { "id": "tint", "kind": "colour", "default": [1, 1, 1, 1], "label": "Tint" },
                { "id": "note", "kind": "text", "default": "hello", "label": "Note" },
                { "id": "rebuild", "kind": "action", "label": "Rebuild tree" },
                { "id": "corner", "kind": "float", "default": 0.5, "min": 0, "max": 1, "label": "Corner",
                  "visible_if": { "id": "mode", "equals": "square" } }
            ]
        }]
    }"#;
    let manifest = Manifest::parse(manifest).expect("the test's manifest is right");
    manifest.plugins[0].settings.clone()
}

/// The panel's values and what it asked for.
#[derive(Default)]
struct Panel {
    values: SettingValues,
    asked: Intents,
}

impl Panel {
    /// Values change as the session would change them.
    fn carry_out(&mut self) {
        for intent in &*self.asked {
            match intent {
                Intent::Renderer(RendererIntent::Set(id, value)) => {
                    self.values.insert(id.clone(), value.clone());
                }
                Intent::Renderer(RendererIntent::Reset(id)) => {
                    self.values.remove(id);
                }
                _ => {}
            }
        }
    }
}

fn harness() -> Harness<'static, Panel> {
    let schema = schema();
    let app = move |ui: &mut egui::Ui, panel: &mut Panel| {
        schema_ui(ui, &schema, &panel.values, &mut panel.asked);
        panel.carry_out();
    };
    Harness::builder()
        .with_size([420.0, 600.0])
        .build_ui_state(app, Panel::default())
}

#[test]
fn every_kind_has_a_widget_under_its_label() {
    let harness = harness();
    let roles = [
        ("Cull back faces", Role::CheckBox),
        ("Passes", Role::Slider),
        ("Splat scale", Role::Slider),
        ("Offset", Role::SpinButton),
        ("Shape", Role::ComboBox),
        ("Note", Role::TextInput),
        ("Rebuild tree", Role::Button),
    ];
    for (label, role) in roles {
        let found = harness.query_all_by_label(label);
        let roles: Vec<Role> = found.map(|node| node.accesskit_node().role()).collect();
        assert!(
            roles.contains(&role),
            "'{label}' names {roles:?}, not {role:?}"
        );
    }
    for heading in ["Quality", "Tint"] {
        assert!(harness.query_by_label(heading).is_some(), "no '{heading}'");
    }
}

#[test]
fn a_checkbox_sets_and_its_reset_takes_back() {
    let mut harness = harness();
    let checkbox = harness.get_by_role_and_label(Role::CheckBox, "Cull back faces");
    assert_eq!(checkbox.accesskit_node().toggled(), Some(Toggled::True));
    checkbox.click();
    harness.run();
    assert_eq!(
        harness.state().values.get("cull"),
        Some(&SettingValue::Bool(false))
    );
    harness.get_by_label("Reset Cull back faces").click();
    harness.run();
    assert!(
        harness.state().values.is_empty(),
        "{:?}",
        harness.state().values
    );
    assert!(harness.query_by_label("Reset Cull back faces").is_none());
}

#[test]
fn typing_reaches_the_hard_range_and_not_beyond() {
    let mut harness = harness();
    let slider = harness.get_by_role_and_label(Role::Slider, "Splat scale");
    slider.set_value_accesskit(50.0);
    harness.run();
    assert_eq!(
        harness.state().values.get("scale"),
        Some(&SettingValue::Float(50.0)),
        "beyond the slider's end, inside the hard range"
    );
    let slider = harness.get_by_role_and_label(Role::Slider, "Splat scale");
    slider.set_value_accesskit(1e6);
    harness.run();
    assert_eq!(
        harness.state().values.get("scale"),
        Some(&SettingValue::Float(100.0))
    );
}

#[test]
fn a_choice_shows_what_depends_on_it() {
    let mut harness = harness();
    assert!(harness.query_by_label("Corner").is_none());
    harness
        .get_by_role_and_label(Role::ComboBox, "Shape")
        .click();
    harness.run();
    harness.get_by_label("Square").click();
    harness.run();
    assert_eq!(
        harness.state().values.get("mode"),
        Some(&SettingValue::Choice("square".into()))
    );
    assert!(harness.query_all_by_label("Corner").next().is_some());
}

#[test]
fn a_text_is_taken_when_it_is_entered() {
    let mut harness = harness();
    let field = harness.get_by_role_and_label(Role::TextInput, "Note");
    field.focus();
    harness.run();
    let field = harness.get_by_role_and_label(Role::TextInput, "Note");
    field.type_text("!");
    harness.run();
    assert!(harness.state().values.is_empty(), "not at every letter");
    harness.key_press(egui::Key::Enter);
    harness.run();
    let Some(SettingValue::Text(text)) = harness.state().values.get("note") else {
        panic!("nothing was entered: {:?}", harness.state().values)
    };
    assert!(text.contains('!') && text.contains("hello"), "{text}");
}

#[test]
fn an_action_is_pressed() {
    let mut harness = harness();
    harness.get_by_label("Rebuild tree").click();
    harness.run();
    assert!(
        harness
            .state()
            .asked
            .contains(&RendererIntent::Press("rebuild".into()).into()),
        "{:?}",
        harness.state().asked
    );
}

fn renderer(id: &str, title: &str, obstacle: Option<Obstacle>) -> RendererRow {
    RendererRow {
        id: id.into(),
        title: title.into(),
        about: String::new(),
        obstacle,
        settings: Vec::new(),
    }
}

fn renderer_tab(renderers: Vec<RendererRow>, chosen: &'static str) -> Harness<'static, Intents> {
    let app = move |ui: &mut egui::Ui, asked: &mut Intents| {
        let tab = RendererTab {
            renderers: &renderers,
            structures: &[],
            chosen,
            chosen_structure: None,
            drawn_by: Some(chosen),
            values: &SettingValues::new(),
        };
        renderer_ui(ui, &tab, asked);
    };
    Harness::builder()
        .with_size([420.0, 600.0])
        .build_ui_state(app, Intents::new())
}

fn lit_needs_normals() -> RendererRow {
    let obstacle = Obstacle {
        reason: "It needs normals, and 'scan' has none.".into(),
        remedy: Some(Remedy::EstimateNormals),
    };
    renderer("b", "Lit splats", Some(obstacle))
}

#[test]
fn a_renderer_is_chosen_by_a_click() {
    let rows = vec![
        renderer("a", "Points", None),
        renderer("b", "Lit splats", None),
    ];
    let mut harness = renderer_tab(rows, "a");
    harness
        .get_by_role_and_label(Role::RadioButton, "Lit splats")
        .click();
    harness.run();
    assert_eq!(
        **harness.state(),
        [RendererIntent::Choose("b".into()).into()]
    );
}

#[test]
fn an_unsuitable_renderer_is_grey_with_reason_and_remedy() {
    let rows = vec![renderer("a", "Points", None), lit_needs_normals()];
    let mut harness = renderer_tab(rows, "a");
    let radio = harness.get_by_role_and_label(Role::RadioButton, "Lit splats");
    assert!(radio.accesskit_node().is_disabled());
    radio.click();
    harness.run();
    assert!(harness.state().is_empty(), "a grey renderer was chosen");
    harness.get_by_label("It needs normals, and 'scan' has none.");
    harness.get_by_label("Estimate normals").click();
    harness.run();
    assert_eq!(**harness.state(), [SceneIntent::Estimate.into()]);
}

#[test]
fn the_keyboard_reaches_and_presses_a_renderer() {
    let rows = vec![
        renderer("a", "Points", None),
        renderer("b", "Lit splats", None),
    ];
    let mut harness = renderer_tab(rows, "a");
    for _ in 0..2 {
        harness.key_press(egui::Key::Tab);
        harness.run();
    }
    harness.key_press(egui::Key::Space);
    harness.run();
    assert_eq!(
        **harness.state(),
        [RendererIntent::Choose("b".into()).into()]
    );
}
