//! The *Help* menu: keys, versions, what plugin authors need.

use egui::{Key, Modifiers};

use super::{Action, Menu, Place};
use crate::window::app::App;
use crate::window::intent::{FileIntent, Part, PluginsIntent, WindowIntent};

pub(super) fn actions(_app: &App) -> Vec<Action> {
    let place = Place::new(Menu::Help, 0);
    let authors = Place::new(Menu::Help, 1).within("For plugin authors");
    vec![
        Action::new(
            "help.keys",
            "Keys and mouse",
            place,
            WindowIntent::Toggle(Part::Keys),
        )
        .keys(Modifiers::NONE, Key::F1),
        Action::new(
            "help.about",
            "About",
            place,
            WindowIntent::Toggle(Part::About),
        ),
        Action::new(
            "help.bug_report",
            "Copy bug report",
            place,
            FileIntent::CopyBugReport,
        ),
        Action::new(
            "help.lose_device",
            "Lose the graphics device",
            authors,
            PluginsIntent::LoseDevice,
        ),
    ]
}
