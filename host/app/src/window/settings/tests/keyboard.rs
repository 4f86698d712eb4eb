//! Everything is reached by Tab, pressed by Space or Enter, moved by arrow keys.

use egui::Key;
use egui::accesskit::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use pointstage_plugin_api::settings_schema::SettingValue;

use super::renderer;
use super::schema::{Panel, harness};
use crate::window::intent::RendererIntent;

/// Presses Tab until the widget of this role and name has the keyboard.
fn tab_to(harness: &mut Harness<'static, Panel>, role: Role, name: &str) {
    for _ in 0..60 {
        harness.key_press(Key::Tab);
        harness.run();
        let found = harness.query_by_role_and_label(role, name);
        if found.is_some_and(|node| node.accesskit_node().is_focused()) {
            return;
        }
    }
    panic!("Tab never reaches the {role:?} '{name}'");
}

#[test]
fn tab_reaches_every_control_of_the_schema() {
    let mut harness = harness();
    for (role, name) in [
        (Role::TextInput, "Search the settings"),
        (Role::CheckBox, "Cull back faces"),
        (Role::SpinButton, "Offset"),
        (Role::ComboBox, "Shape"),
        (Role::TextInput, "Note"),
        (Role::Button, "Rebuild tree"),
        (Role::Button, "Quality"),
        (Role::Slider, "Passes"),
        (Role::Slider, "Splat scale"),
        (Role::Slider, "Amount"),
    ] {
        tab_to(&mut harness, role, name);
    }
}

#[test]
fn space_switches_and_enter_presses() {
    let mut harness = harness();
    tab_to(&mut harness, Role::CheckBox, "Cull back faces");
    harness.key_press(Key::Space);
    harness.run();
    assert_eq!(
        harness.state().value("cull"),
        Some(&SettingValue::Bool(false))
    );
    tab_to(&mut harness, Role::Button, "Rebuild tree");
    harness.key_press(Key::Enter);
    harness.run();
    let asked = &harness.state().asked;
    assert!(
        asked.contains(&RendererIntent::Press("rebuild".into()).into()),
        "{asked:?}"
    );
}

#[test]
fn arrow_keys_move_sliders() {
    let mut harness = harness();
    tab_to(&mut harness, Role::Slider, "Amount");
    harness.key_press(Key::ArrowRight);
    harness.run();
    let Some(SettingValue::Float(amount)) = harness.state().value("amount") else {
        panic!("{:?}", harness.state().values)
    };
    assert!(
        (amount - 0.6).abs() < 1e-9,
        "a step of 0.1 from 0.5: {amount}"
    );
    tab_to(&mut harness, Role::Slider, "Passes");
    harness.key_press(Key::ArrowLeft);
    harness.run();
    assert_eq!(harness.state().value("passes"), Some(&SettingValue::Int(1)));
}

#[test]
fn a_renderer_is_reached_and_chosen() {
    let mut harness = renderer::points_and_splats_tab();
    for _ in 0..2 {
        harness.key_press(Key::Tab);
        harness.run();
    }
    harness.key_press(Key::Space);
    harness.run();
    super::assert_asked(&harness, RendererIntent::Choose("b".into()));
}
