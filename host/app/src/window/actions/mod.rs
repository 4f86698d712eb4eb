//! Every action of the window in one table: menus, the command palette, the key reader and Help are made from it.
//!
//! [`all`] asks the providers, one file a menu, for their rows; a row's order in the table is its order in the menu. What
//! cannot be done now is there too, with the reason.

mod camera;
mod compare;
mod edit;
mod file;
mod help;
mod keys;
mod own_keys;
mod renderer;
mod select;
mod view;
mod views;
mod window;

use egui::{Key, KeyboardShortcut, Modifiers};

use super::app::App;
use super::intent::Intent;

pub(crate) use edit::ESTIMATES;
pub(crate) use file::title_of_recent;
pub(crate) use keys::{read_keys, shortcut_text};
pub(crate) use own_keys::conflicts;

/// Ctrl (⌘ on a Mac) with Shift.
const COMMAND_SHIFT: Modifiers = Modifiers::COMMAND.plus(Modifiers::SHIFT);

/// One thing that the user can ask for by name.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Action {
    /// Stable, `area.act`.
    pub(crate) id: String,
    /// As menus and the palette show it.
    pub(crate) title: String,
    /// Where it stands in the menus.
    pub(crate) place: Place,
    /// Keys that do it; menus show the first.
    pub(crate) keys: Vec<Keys>,
    /// Why it cannot be done now, if so.
    pub(crate) obstacle: Option<String>,
    /// On or off, for what can be switched.
    pub(crate) is_on: Option<bool>,
    /// What it asks for.
    pub(crate) intent: Intent,
}

/// A place in the menus.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Place {
    /// The menu.
    pub(crate) menu: Menu,
    /// The menu within it; empty for none.
    pub(crate) submenu: &'static str,
    /// A line separates groups.
    pub(crate) group: u8,
}

/// A menu of the bar.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Menu {
    /// Files, sessions, pictures.
    File,
    /// Undo and redo.
    Edit,
    /// Camera, views, what is shown.
    View,
    /// Which renderer.
    Renderer,
    /// Views beside each other.
    Compare,
    /// Panels, theme.
    Window,
    /// Keys, versions.
    Help,
}

impl Menu {
    /// All menus with their names, from left to right.
    pub(crate) const ALL: [(Self, &'static str); 7] = [
        (Self::File, "File"),
        (Self::Edit, "Edit"),
        (Self::View, "View"),
        (Self::Renderer, "Renderer"),
        (Self::Compare, "Compare"),
        (Self::Window, "Window"),
        (Self::Help, "Help"),
    ];

    /// Its name in the bar.
    pub(crate) fn name(self) -> &'static str {
        let found = Self::ALL.iter().find(|(menu, _)| *menu == self);
        found.map_or("", |(_, name)| name)
    }
}

/// Keys that are pressed together, and where they count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Keys {
    /// The keys.
    pub(crate) shortcut: KeyboardShortcut,
    /// Where they count.
    pub(crate) scope: Scope,
}

/// Where keys count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Scope {
    /// Always.
    Everywhere,
    /// Unless a text is typed.
    NotTyping,
    /// While the picture has the keyboard, or nothing has.
    OnPicture,
}

impl Action {
    /// An action that can be done now.
    pub(crate) fn new(
        id: impl Into<String>,
        title: impl Into<String>,
        place: Place,
        intent: impl Into<Intent>,
    ) -> Self {
        Self {
            id: id.into(),
            title: title.into(),
            place,
            keys: Vec::new(),
            obstacle: None,
            is_on: None,
            intent: intent.into(),
        }
    }

    /// With keys more. Those with Ctrl or Alt and function keys count everywhere, others while no text is typed.
    pub(crate) fn keys(self, modifiers: Modifiers, key: Key) -> Self {
        let is_function_key = (Key::F1..=Key::F35).contains(&key);
        let scope = if modifiers.command || modifiers.ctrl || modifiers.alt || is_function_key {
            Scope::Everywhere
        } else {
            Scope::NotTyping
        };
        self.keys_in(scope, modifiers, key)
    }

    /// With keys more that count in `scope`.
    pub(crate) fn keys_in(mut self, scope: Scope, modifiers: Modifiers, key: Key) -> Self {
        let shortcut = KeyboardShortcut::new(modifiers, key);
        self.keys.push(Keys { shortcut, scope });
        self
    }

    /// Something that is on or off.
    pub(crate) fn on(mut self, is_on: bool) -> Self {
        self.is_on = Some(is_on);
        self
    }

    /// Cannot be done now, if there is a reason.
    pub(crate) fn unless(mut self, obstacle: Option<String>) -> Self {
        self.obstacle = obstacle;
        self
    }
}

impl Place {
    /// A place in a menu.
    pub(crate) const fn new(menu: Menu, group: u8) -> Self {
        Self {
            menu,
            submenu: "",
            group,
        }
    }

    /// A place in a menu within a menu.
    pub(crate) const fn within(self, submenu: &'static str) -> Self {
        Self { submenu, ..self }
    }
}

/// All actions, in the order of the menus.
pub(crate) fn all(app: &App) -> Vec<Action> {
    let mut actions = file::actions(app);
    actions.extend(edit::actions(app));
    actions.extend(select::actions(app));
    actions.extend(camera::actions(app));
    actions.extend(views::actions(app));
    actions.extend(view::actions(app));
    actions.extend(renderer::actions(app));
    actions.extend(compare::actions(app));
    actions.extend(window::actions(app));
    actions.extend(help::actions(app));
    actions
}

/// Gestures with the mouse and keys that are held, with what they do, for Help.
pub(crate) fn gestures() -> Vec<(&'static str, &'static str)> {
    [
        camera::GESTURES,
        select::GESTURES,
        view::GESTURES,
        compare::GESTURES,
        file::GESTURES,
        window::GESTURES,
    ]
    .concat()
}
