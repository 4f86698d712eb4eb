//! The *Window* menu: panels and what they look like.

use egui::{Key, Modifiers};

use super::{Action, Menu, Place};
use crate::window::app::App;
use crate::window::intent::{Part, WindowIntent};

/// Keys of the toolkit.
pub(super) const GESTURES: &[(&str, &str)] = &[
    ("Tab, Shift+Tab", "next and previous control"),
    ("Space, Enter", "press the control"),
];

pub(super) fn actions(app: &App) -> Vec<Action> {
    let place = Place::new(Menu::Window, 0);
    let toggle = |id, title, part| Action::new(id, title, place, WindowIntent::Toggle(part));
    vec![
        toggle("window.settings", "Settings panel", Part::Settings)
            .on(app.panels.settings)
            .keys(Modifiers::COMMAND, Key::Comma),
        toggle("window.log", "Log", Part::Log)
            .on(app.panels.log)
            .keys(Modifiers::COMMAND, Key::L),
        toggle("window.inspector", "Inspector", Part::Inspector)
            .on(app.panels.inspector)
            .keys(Modifiers::NONE, Key::I),
        toggle("window.palette", "Find an action…", Part::Palette)
            .keys(Modifiers::COMMAND, Key::P)
            .keys(Modifiers::COMMAND, Key::K),
    ]
}
