use egui::accesskit::{Role, Toggled};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use pointstage_plugin_api::settings_schema::{SettingSchema, SettingValue, SettingValues};

use super::super::schema::{Owner, SchemaPanel, schema_ui};
use super::super::tab_ui;
use super::{choose, every_kind, schema_of};
use crate::window::intent::{Intent, Intents, RendererIntent};

/// The panel's values and what it asked for.
#[derive(Default)]
pub(super) struct Panel {
    pub(super) values: SettingValues,
    pub(super) asked: Intents,
    focus: Option<String>,
}

impl Panel {
    /// Values change as the session would change them.
    fn carry_out(&mut self, from: usize) {
        for intent in self.asked.iter().skip(from) {
            match intent {
                Intent::Renderer(
                    RendererIntent::Set(id, value) | RendererIntent::SetOfStructure(id, value),
                ) => {
                    self.values.insert(id.clone(), value.clone());
                }
                Intent::Renderer(RendererIntent::ResetSome(ids)) => {
                    self.values.retain(|id, _| !ids.contains(id));
                }
                _ => {}
            }
        }
    }

    pub(super) fn value(&self, id: &str) -> Option<&SettingValue> {
        self.values.get(id)
    }
}

fn harness_of(schema: Vec<SettingSchema>, owner: Owner) -> Harness<'static, Panel> {
    let app = move |ui: &mut egui::Ui, panel: &mut Panel| {
        let before = panel.asked.len();
        let shown = SchemaPanel {
            owner,
            schema: &schema,
            values: &panel.values,
            focus: panel.focus.as_deref(),
        };
        schema_ui(ui, &shown, &mut panel.asked);
        panel.focus = None;
        panel.carry_out(before);
    };
    Harness::builder()
        .with_size([420.0, 700.0])
        .build_ui_state(app, Panel::default())
}

pub(super) fn harness() -> Harness<'static, Panel> {
    harness_of(every_kind(), Owner::Renderer)
}

#[test]
fn every_kind_has_a_widget_under_its_label() {
    let harness = harness();
    let roles = [
        ("Cull back faces", Role::CheckBox),
        ("Passes", Role::Slider),
        ("Splat scale", Role::Slider),
        ("Amount", Role::Slider),
        ("Seed", Role::SpinButton),
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
    assert!(harness.query_all_by_label("Tint").next().is_some());
}

#[test]
fn a_checkbox_sets_and_its_reset_takes_back() {
    let mut harness = harness();
    let checkbox = harness.get_by_role_and_label(Role::CheckBox, "Cull back faces");
    assert_eq!(checkbox.accesskit_node().toggled(), Some(Toggled::True));
    checkbox.click();
    harness.run();
    assert_eq!(
        harness.state().value("cull"),
        Some(&SettingValue::Bool(false))
    );
    harness.get_by_label("Reset Cull back faces").click();
    harness.run();
    assert_eq!(harness.state().values, SettingValues::new());
    assert!(harness.query_by_label("Reset Cull back faces").is_none());
}

#[test]
fn a_typed_value_reaches_the_hard_range_and_beyond_it_the_field_says_why_not() {
    let mut harness = harness();
    let set = |harness: &mut Harness<'static, Panel>, value| {
        let slider = harness.get_by_role_and_label(Role::Slider, "Splat scale");
        slider.set_value_accesskit(value);
        harness.run();
    };
    set(&mut harness, 50.0);
    assert_eq!(
        harness.state().value("scale"),
        Some(&SettingValue::Float(50.0)),
        "beyond the slider's end, inside the hard range"
    );
    assert!(harness.query_by_label_contains("is outside").is_none());
    set(&mut harness, 1e6);
    assert_eq!(
        harness.state().value("scale"),
        Some(&SettingValue::Float(100.0))
    );
    harness.get_by_label("1000000 is outside 0.01 … 100 px; 100 was taken.");
    set(&mut harness, 10.0);
    assert!(
        harness.query_by_label_contains("is outside").is_none(),
        "it is about a value that is no more"
    );
}

#[test]
fn a_number_with_one_open_end_has_a_hard_range_too() {
    let mut harness = harness();
    let field = harness.get_by_role_and_label(Role::SpinButton, "Offset");
    field.set_value_accesskit(7.0);
    harness.run();
    assert_eq!(
        harness.state().value("offset"),
        Some(&SettingValue::Float(5.0))
    );
    harness.get_by_label("7 is outside −∞ … 5; 5 was taken.");
}

#[test]
fn whole_numbers_stay_whole() {
    let mut harness = harness();
    let slider = harness.get_by_role_and_label(Role::Slider, "Passes");
    slider.set_value_accesskit(5.4);
    harness.run();
    assert_eq!(harness.state().value("passes"), Some(&SettingValue::Int(5)));
}

#[test]
fn a_choice_shows_what_depends_on_it() {
    let mut harness = harness();
    assert!(harness.query_by_label("Corner").is_none());
    choose(&mut harness, "Shape", "Square");
    assert_eq!(
        harness.state().value("mode"),
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
    let Some(SettingValue::Text(text)) = harness.state().value("note") else {
        panic!("nothing was entered: {:?}", harness.state().values)
    };
    assert!(text.contains('!') && text.contains("hello"), "{text}");
}

#[test]
fn an_action_is_pressed() {
    let mut harness = harness();
    harness.get_by_label("Rebuild tree").click();
    harness.run();
    let asked = &harness.state().asked;
    assert!(
        asked.contains(&RendererIntent::Press("rebuild".into()).into()),
        "{asked:?}"
    );
}

#[test]
fn a_group_folds_and_resets_its_settings() {
    let mut harness = harness();
    let slider = harness.get_by_role_and_label(Role::Slider, "Passes");
    slider.set_value_accesskit(5.0);
    harness
        .get_by_role_and_label(Role::CheckBox, "Cull back faces")
        .click();
    harness.run();
    let slider = harness.get_by_role_and_label(Role::Slider, "Amount");
    slider.set_value_accesskit(0.9);
    harness.run();
    assert_eq!(harness.state().values.len(), 3);
    harness.get_by_label("Reset Quality").click();
    harness.run();
    let left: Vec<&String> = harness.state().values.keys().collect();
    assert_eq!(left, ["cull"], "what is not of the group stays");

    harness
        .get_by_role_and_label(Role::Button, "Quality")
        .click();
    harness.run();
    assert!(harness.query_by_label("Passes").is_none(), "folded");
    harness
        .get_by_role_and_label(Role::Button, "Quality")
        .click();
    harness.run();
    assert!(harness.query_all_by_label("Passes").next().is_some());
}

#[test]
fn a_search_leaves_what_is_meant_and_unfolds_it() {
    let mut harness = harness();
    harness
        .get_by_role_and_label(Role::Button, "Quality")
        .click();
    harness.run();
    let search = harness.get_by_role_and_label(Role::TextInput, "Search the settings");
    search.focus();
    harness.run();
    let search = harness.get_by_role_and_label(Role::TextInput, "Search the settings");
    search.type_text("PASS");
    harness.run();
    assert!(
        harness.query_all_by_label("Passes").next().is_some(),
        "in a folded group"
    );
    assert!(harness.query_by_label("Offset").is_none());
    harness.get_by_label("clear").click();
    harness.run();
    assert!(harness.query_all_by_label("Offset").next().is_some());
}

#[test]
fn few_settings_need_no_search() {
    let schema = schema_of(r#"{ "id": "a", "kind": "bool", "default": true }"#);
    let harness = harness_of(schema, Owner::Renderer);
    assert!(harness.query_by_label("Search the settings").is_none());
}

#[test]
fn a_sought_setting_gets_the_keyboard_though_its_group_is_folded() {
    let mut harness = harness();
    harness
        .get_by_role_and_label(Role::Button, "Quality")
        .click();
    harness.run();
    harness.state_mut().focus = Some("passes".to_owned());
    harness.run();
    let slider = harness.get_by_role_and_label(Role::Slider, "Passes");
    assert!(slider.accesskit_node().is_focused());
}

#[test]
fn a_structure_s_settings_are_its_own_and_it_has_no_actions() {
    let mut harness = harness_of(every_kind(), Owner::Structure);
    assert!(harness.query_by_label("Rebuild tree").is_none());
    harness
        .get_by_role_and_label(Role::CheckBox, "Cull back faces")
        .click();
    harness.run();
    let asked: &[Intent] = &harness.state().asked;
    let set = RendererIntent::SetOfStructure("cull".into(), SettingValue::Bool(false));
    assert_eq!(asked, [set.into()]);
}

#[test]
fn numbers_of_many_digits_leave_the_panel_its_width() {
    let schema = every_kind();
    let mut values = SettingValues::new();
    for (id, value) in [("scale", 12.345_678), ("amount", 0.523_409)] {
        values.insert(id.to_owned(), SettingValue::Float(value));
    }
    // The panel's width in each pass.
    let app = move |ui: &mut egui::Ui, widths: &mut Vec<f32>| {
        let shown = egui::Panel::right("settings")
            .resizable(true)
            .default_size(360.0)
            .show(ui, |ui| {
                tab_ui(ui, |ui| {
                    let panel = SchemaPanel {
                        owner: Owner::Renderer,
                        schema: &schema,
                        values: &values,
                        focus: None,
                    };
                    schema_ui(ui, &panel, &mut Intents::new());
                });
            });
        widths.push(shown.response.rect.width());
    };
    let mut harness = Harness::builder()
        .with_size([1000.0, 700.0])
        .build_ui_state(app, Vec::new());
    harness.run_steps(30);
    let widths = harness.state();
    assert!(
        widths.iter().all(|width| (width - widths[0]).abs() < 0.5),
        "{widths:?}"
    );
}
