//! The *Edit* menu's part about surfels: tools that select them, and what becomes of the selected ones.

use egui::{Key, Modifiers};

use super::{Action, Menu, Place, Scope};
use crate::window::app::App;
use crate::window::intent::SelectIntent;
use crate::window::selecting::Tool;

/// What drags do while a tool selects.
pub(super) const GESTURES: &[(&str, &str)] = &[
    ("Drag with a selection tool", "select surfels"),
    (
        "Shift+drag, Ctrl+drag with a selection tool",
        "add to the selection, take out of it",
    ),
];

pub(super) fn actions(app: &App) -> Vec<Action> {
    let mut actions = clipboard(app);
    actions.extend(tools(app));
    actions.extend(sets(app));
    actions
}

fn no_surfels(app: &App) -> Option<String> {
    let is_empty = app.session.scene.surfel_count() == 0;
    is_empty.then(|| "The scene is empty.".to_owned())
}

fn none_selected(app: &App) -> Option<String> {
    let is_any = app.session.scene.marked_count() > 0;
    (!is_any).then(|| "No surfel is selected.".to_owned())
}

/// Keys of texts belong to the text while one is typed.
fn clipboard(app: &App) -> Vec<Action> {
    let place = Place::new(Menu::Edit, 3);
    let none = none_selected(app);
    let is_empty = app.selecting.clipboard.pieces.is_empty();
    let nothing_copied = is_empty.then(|| "No surfel was copied.".to_owned());
    let act = |id: &str, title: &str, intent| Action::new(id, title, place, intent);
    vec![
        act("surfels.cut", "Cut surfels", SelectIntent::Cut)
            .keys_in(Scope::NotTyping, Modifiers::COMMAND, Key::X)
            .unless(none.clone()),
        act("surfels.copy", "Copy surfels", SelectIntent::Copy)
            .keys_in(Scope::NotTyping, Modifiers::COMMAND, Key::C)
            .unless(none.clone()),
        act("surfels.paste", "Paste surfels", SelectIntent::Paste)
            .keys_in(Scope::NotTyping, Modifiers::COMMAND, Key::V)
            .unless(nothing_copied),
        act("surfels.delete", "Delete surfels", SelectIntent::Delete)
            .keys_in(Scope::NotTyping, Modifiers::NONE, Key::Delete)
            .unless(none),
    ]
}

fn tools(app: &App) -> Vec<Action> {
    let place = Place::new(Menu::Edit, 4).within("Select surfels by");
    let keys = [Key::R, Key::G, Key::B];
    let tools = Tool::SELECTING.into_iter().zip(keys);
    let mut actions: Vec<Action> = tools
        .map(|((tool, name, key), shortcut)| {
            Action::new(
                format!("surfels.by_{key}"),
                name,
                place,
                SelectIntent::Tool(tool),
            )
            .keys(Modifiers::NONE, shortcut)
            .on(app.selecting.tool == tool)
            .unless(no_surfels(app))
        })
        .collect();
    let no_tool = app.selecting.tool == Tool::Navigate;
    let reason = no_tool.then(|| "Drags move the camera.".to_owned());
    actions.push(
        Action::new(
            "surfels.navigate",
            "No tool: drags move the camera",
            place,
            SelectIntent::Tool(Tool::Navigate),
        )
        .keys_in(Scope::OnPicture, Modifiers::NONE, Key::Escape)
        .unless(reason),
    );
    actions
}

fn sets(app: &App) -> Vec<Action> {
    let place = Place::new(Menu::Edit, 4);
    vec![
        Action::new(
            "surfels.invert",
            "Invert selected surfels",
            place,
            SelectIntent::Invert,
        )
        .keys(Modifiers::COMMAND, Key::I)
        .unless(no_surfels(app)),
        Action::new(
            "surfels.clear",
            "Select no surfels",
            place,
            SelectIntent::Clear,
        )
        .keys(Modifiers::COMMAND, Key::D)
        .unless(none_selected(app)),
        Action::new(
            "surfels.crop_box",
            "Crop box…",
            place,
            SelectIntent::ToggleCropBox,
        )
        .on(app.selecting.crop_box.is_some())
        .unless(no_surfels(app)),
    ]
}
