//! The *File* menu: files, sessions, pictures.

use egui::{Key, Modifiers};

use super::{Action, COMMAND_SHIFT, Menu, Place};
use crate::window::app::App;
use crate::window::intent::{ExportIntent, FileIntent, OpenMode, WindowIntent};

/// Gestures that open files.
pub(super) const GESTURES: &[(&str, &str)] = &[
    ("Drop files", "open them"),
    ("Shift+drop files", "add them to the scene"),
];

pub(super) fn actions(app: &App) -> Vec<Action> {
    let open = Place::new(Menu::File, 0);
    let save = Place::new(Menu::File, 5);
    let nothing = app.session.scene.objects().is_empty();
    let nothing = nothing.then(|| "there is nothing to see yet; open a file first".to_owned());
    let end = Place::new(Menu::File, 9);
    vec![
        Action::new(
            "file.open",
            "Open…",
            open,
            FileIntent::Choose(OpenMode::Replace),
        )
        .keys(Modifiers::COMMAND, Key::O),
        Action::new(
            "file.open_path",
            "Open path…",
            open,
            FileIntent::TypePath(OpenMode::Replace),
        )
        .keys(COMMAND_SHIFT, Key::O),
        Action::new(
            "file.add",
            "Add to scene…",
            open,
            FileIntent::Choose(OpenMode::Add),
        ),
        Action::new(
            "file.add_path",
            "Add path to scene…",
            open,
            FileIntent::TypePath(OpenMode::Add),
        ),
        Action::new(
            "file.save_image",
            "Save image…",
            save,
            ExportIntent::ShowDialog,
        )
        .keys(Modifiers::COMMAND, Key::S)
        .unless(nothing),
        Action::new("file.quit", "Quit", end, WindowIntent::Quit).keys(Modifiers::COMMAND, Key::Q),
    ]
}
