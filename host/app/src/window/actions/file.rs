//! The *File* menu: files, sessions, pictures.

use std::path::Path;

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
    let mut actions = open_actions();
    actions.extend(recent_actions(app));
    actions.extend(session_actions(app));
    actions.push(save_image_action(app));
    let end = Place::new(Menu::File, 9);
    actions.push(
        Action::new("file.quit", "Quit", end, WindowIntent::Quit).keys(Modifiers::COMMAND, Key::Q),
    );
    actions
}

fn open_actions() -> Vec<Action> {
    let open = Place::new(Menu::File, 0);
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
    ]
}

/// Files that were opened, newest first; those that are gone are there too, and say so.
fn recent_actions(app: &App) -> Vec<Action> {
    let place = Place::new(Menu::File, 0).within("Open recent");
    let paths = app.remembered.recent.paths();
    let mut actions: Vec<Action> = paths
        .iter()
        .enumerate()
        .map(|(number, path)| {
            let open = FileIntent::Open(vec![path.clone()], OpenMode::Replace);
            let is_missing = app.remembered.missing.contains(path);
            Action::new(
                format!("file.recent.{number}"),
                title_of_recent(path),
                place,
                open,
            )
            .unless(is_missing.then(|| format!("{} is not there any more", path.display())))
        })
        .collect();
    let nothing = paths
        .is_empty()
        .then(|| "no file has been opened yet".to_owned());
    let clear = Action::new(
        "file.clear_recent",
        "Clear list",
        place,
        FileIntent::ClearRecent,
    );
    actions.push(clear.unless(nothing));
    actions
}

/// A file with its folder, as it stands in a list: its name comes first.
pub(crate) fn title_of_recent(path: &Path) -> String {
    let name = path
        .file_name()
        .unwrap_or(path.as_os_str())
        .to_string_lossy();
    let folder = path.parent().unwrap_or(Path::new(""));
    let home = etcetera::home_dir().ok();
    let below_home = home
        .as_deref()
        .and_then(|home| folder.strip_prefix(home).ok());
    match below_home {
        Some(below) => format!("{name} – {}", Path::new("~").join(below).display()),
        None => format!("{name} – {}", folder.display()),
    }
}

fn save_image_action(app: &App) -> Action {
    let nothing = app.session.scene.objects().is_empty();
    let nothing = nothing.then(|| "there is nothing to see yet; open a file first".to_owned());
    let place = Place::new(Menu::File, 5);
    Action::new(
        "file.save_image",
        "Save image…",
        place,
        ExportIntent::ShowDialog,
    )
    .keys(Modifiers::COMMAND, Key::S)
    .unless(nothing)
}

fn session_actions(app: &App) -> Vec<Action> {
    let place = Place::new(Menu::File, 1);
    let objects = app.session.scene.objects();
    let nothing = objects.is_empty().then(|| "the scene is empty".to_owned());
    let path = app.remembered.session_path.as_ref();
    let unsaved = path
        .is_none()
        .then(|| "the session has no file yet: save it first".to_owned());
    vec![
        Action::new(
            "file.save_object",
            "Save object as…",
            place,
            FileIntent::SaveObjectAs,
        )
        .unless(nothing.clone()),
        Action::new("file.reload", "Reload", place, FileIntent::Reload)
            .keys(Modifiers::COMMAND, Key::R)
            .unless(nothing),
        Action::new(
            "file.save_session",
            "Save session…",
            place,
            FileIntent::SaveSessionAs,
        )
        .keys(COMMAND_SHIFT, Key::S),
        Action::new(
            "file.save_session_again",
            "Save session again",
            place,
            FileIntent::SaveSessionAgain,
        )
        .unless(unsaved),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_recent_file_is_told_by_its_name_and_its_folder() {
        assert_eq!(
            title_of_recent(Path::new("/no/scans/a.ply")),
            "a.ply – /no/scans"
        );
        let home = etcetera::home_dir().expect("a home folder");
        assert_eq!(
            title_of_recent(&home.join("scans/a.ply")),
            "a.ply – ~/scans"
        );
    }
}
