use egui::accesskit::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT as _, Queryable as _};

use super::super::presets::{copy_ui, presets_ui};
use super::{asking, assert_asked, choose};
use crate::window::intent::{Intents, RendererIntent};
use crate::window::presets::{DEFAULTS, PresetList};

fn tab(active: &str, differs: bool) -> Harness<'static, Intents> {
    let list = PresetList {
        names: vec!["Sharp".into(), "Soft".into()],
        active: active.into(),
        differs,
    };
    asking(move |ui, asked| presets_ui(ui, &list, asked))
}

fn type_name(harness: &mut Harness<'static, Intents>, name: &str) {
    let field = harness.get_by_role_and_label(Role::TextInput, "Name of the preset");
    field.type_text(name);
    harness.run();
}

#[test]
fn the_active_preset_is_named_and_another_one_chosen() {
    let mut harness = tab("Soft", true);
    let list = harness.get_by_role_and_label(Role::ComboBox, "Preset");
    assert_eq!(
        list.accesskit_node().value().as_deref(),
        Some("Soft (changed)")
    );
    choose(&mut harness, "Preset", "Sharp");
    assert_asked(&harness, RendererIntent::ChoosePreset("Sharp".into()));
}

#[test]
fn the_defaults_are_always_there_and_cannot_be_overwritten() {
    let mut harness = tab(DEFAULTS, true);
    let save = harness.get_by_label("Save preset");
    assert!(save.accesskit_node().is_disabled());
    assert!(harness.query_by_label("Delete preset").is_none());
    choose(&mut harness, "Preset", "Soft");
    assert_asked(&harness, RendererIntent::ChoosePreset("Soft".into()));
}

#[test]
fn values_are_saved_under_a_typed_name() {
    let mut harness = tab(DEFAULTS, true);
    harness.get_by_label("Save as…").click();
    harness.run();
    type_name(&mut harness, "Wet");
    harness.key_press(egui::Key::Enter);
    harness.run();
    assert_asked(&harness, RendererIntent::SavePreset("Wet".into()));
    assert!(harness.query_by_label("Name of the preset").is_none());
}

#[test]
fn overwriting_is_said_before_and_the_built_in_name_is_refused() {
    let mut harness = tab("Sharp", true);
    harness.get_by_label("Save as…").click();
    harness.run();
    type_name(&mut harness, "Soft");
    harness.get_by_label("This overwrites the preset 'Soft'.");
    harness.get_by_label("Cancel").click();
    harness.run();
    harness.get_by_label("Save as…").click();
    harness.run();
    type_name(&mut harness, "defaults");
    harness.get_by_label_contains("is built in");
    harness.get_by_label("OK").click();
    harness.run();
    assert!(harness.state().is_empty(), "{:?}", harness.state());
}

#[test]
fn a_preset_is_saved_renamed_and_deleted() {
    let mut harness = tab("Soft", true);
    harness.get_by_label("Save preset").click();
    harness.run();
    assert_asked(&harness, RendererIntent::SavePreset("Soft".into()));

    let mut harness = tab("Soft", false);
    harness.get_by_label("Rename…").click();
    harness.run();
    type_name(&mut harness, "er");
    harness.get_by_label("OK").click();
    harness.run();
    let asked = format!("{:?}", harness.state());
    assert!(
        asked.contains("RenamePreset") && asked.contains("from: \"Soft\""),
        "{asked}"
    );

    let mut harness = tab("Soft", false);
    harness.get_by_label("Delete preset").click();
    harness.run();
    assert_asked(&harness, RendererIntent::DeletePreset("Soft".into()));
}

#[test]
fn renaming_to_a_name_that_is_taken_is_refused_at_the_field() {
    let mut harness = tab("Soft", false);
    harness.get_by_label("Rename…").click();
    harness.run();
    let field = harness.get_by_role_and_label(Role::TextInput, "Name of the preset");
    field.focus();
    harness.run();
    harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::A);
    harness.run();
    type_name(&mut harness, "Sharp");
    harness.get_by_label("There is a preset 'Sharp' already.");
    harness.key_press(egui::Key::Enter);
    harness.run();
    assert!(harness.state().is_empty(), "{:?}", harness.state());
}

#[test]
fn values_are_copied_from_another_renderer() {
    let sources = vec![("org.example.dots".to_owned(), "Dots".to_owned())];
    let mut harness = asking(move |ui, asked| copy_ui(ui, &sources, asked));
    harness.get_by_label("Copy from…").click();
    harness.run();
    harness.get_by_label("Dots").click();
    harness.run();
    assert_asked(
        &harness,
        RendererIntent::CopyFrom("org.example.dots".into()),
    );
}
