//! Saving an image from the whole window, without a display or a device.

use egui::accesskit::Role;
use egui_kittest::kittest::Queryable as _;

use super::app_tests::{wait_until, window, window_with_square};

#[test]
fn ctrl_s_saves_what_is_shown_and_says_where() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let image = folder.path().join("saved.png");
    let mut harness = window_with_square(folder.path());
    for round in ["first", "again"] {
        harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::S);
        harness.run_steps(3);
        let field = harness.get_by_role_and_label(Role::TextInput, "File:");
        field.focus();
        harness.run_steps(1);
        harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::A);
        harness.run_steps(1);
        harness
            .get_by_role_and_label(Role::TextInput, "File:")
            .type_text(&image.display().to_string());
        harness.run_steps(2);
        harness.get_by_label("Save").click();
        harness.run_steps(3);
        if round == "again" {
            harness.get_by_label("There is such a file already.");
            harness.get_by_label("Replace").click();
            harness.run_steps(3);
        }
        assert!(harness.query_by_label("Save image").is_none(), "it closed");
        wait_until(&mut harness, |harness| {
            harness.query_by_label("Copy path").is_some()
        });
        // Until it stands where it will stay.
        harness.run_steps(3);
        let saved = format!("Saved {}", image.display());
        harness.get_by_label_contains(&saved);
        assert!(
            std::fs::read(&image)
                .expect("an image")
                .starts_with(b"\x89PNG")
        );
        harness.get_by_label("Copy path").click();
        harness.run_steps(3);
        assert!(harness.query_by_label("Copy path").is_none(), "answered");
    }
    let files = std::fs::read_dir(folder.path()).expect("listable").count();
    assert_eq!(files, 2, "nothing else is left");
}

#[test]
fn an_image_that_cannot_be_written_is_an_error_with_its_path() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut harness = window_with_square(folder.path());
    let image = super::intent::ImageFile {
        path: folder.path().join("missing").join("a.png"),
        size_px: [64, 48],
        backdrop: super::intent::Backdrop::AsShown,
        replace: super::intent::Replace::Ask,
    };
    let intent = super::intent::ExportIntent::Save(image);
    let ctx = harness.ctx.clone();
    harness.state_mut().apply(&ctx, intent.into());
    wait_until(&mut harness, |harness| {
        harness
            .query_by_label_contains("missing/a.png: cannot be written")
            .is_some()
    });
}

#[test]
fn the_structure_of_a_saved_image_has_its_settings() {
    use pointstage_engine::stage::SettingValue;
    let mut harness = window();
    harness.run_steps(2);
    let app = harness.state_mut();
    let pane = &mut app.session.panes.active;
    pane.structure = Some("org.example.tree".to_owned());
    let values = [("depth".to_owned(), SettingValue::Int(7))];
    let values = std::collections::BTreeMap::from(values);
    pane.settings
        .insert("org.example.tree".to_owned(), values.clone());
    let image = super::intent::ImageFile {
        path: "a.png".into(),
        size_px: [64, 48],
        backdrop: super::intent::Backdrop::AsShown,
        replace: super::intent::Replace::Ask,
    };
    assert_eq!(app.frame_to_save(&image).structure_settings, values);
}
