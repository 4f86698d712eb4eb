//! The menu bar, made from the table of actions.

use egui::{Button, MenuBar, Ui};
use pointstage_engine::stage::Show;

use super::actions::{Action, Menu, shortcut_text};
use super::intent::{Intents, ViewIntent};
use super::legend;

/// The bar with all menus.
pub(crate) fn menu_ui(ui: &mut Ui, actions: &[Action], out: &mut Intents) {
    MenuBar::new().ui(ui, |ui| {
        for (menu, name) in Menu::ALL {
            let of_menu: Vec<&Action> = actions
                .iter()
                .filter(|action| action.place.menu == menu)
                .collect();
            if !of_menu.is_empty() {
                ui.menu_button(name, |ui| items_ui(ui, &of_menu, out));
            }
        }
    });
}

/// The items of one menu; those of one submenu stand where its first one does.
fn items_ui(ui: &mut Ui, actions: &[&Action], out: &mut Intents) {
    let mut shown_submenus: Vec<&str> = Vec::new();
    let mut group = None;
    for action in actions {
        let place = action.place;
        if shown_submenus.contains(&place.submenu) {
            continue;
        }
        if group.is_some_and(|group| group != place.group) {
            ui.separator();
        }
        group = Some(place.group);
        if place.submenu.is_empty() {
            item_ui(ui, action, out);
            continue;
        }
        shown_submenus.push(place.submenu);
        let of_submenu = actions
            .iter()
            .filter(|other| other.place.submenu == place.submenu);
        ui.menu_button(place.submenu, |ui| {
            for action in of_submenu {
                item_ui(ui, action, out);
            }
        });
    }
}

fn item_ui(ui: &mut Ui, action: &Action, out: &mut Intents) {
    let mut button = Button::selectable(action.is_on == Some(true), &action.title);
    if let Some(keys) = action.keys.first() {
        button = button.shortcut_text(shortcut_text(ui.ctx(), keys.shortcut));
    }
    let mut response = ui.add_enabled(action.obstacle.is_none(), button);
    if let Some(reason) = &action.obstacle {
        response = response.on_disabled_hover_text(reason);
    }
    if response.clicked() {
        out.push(action.intent.clone());
        ui.close();
    }
}

/// Colours and every target, to choose one.
pub(crate) fn show_choices_ui(ui: &mut Ui, shown: &Show, targets: &[String], out: &mut Intents) {
    let colours = std::iter::once(Show::Colours);
    let others = targets
        .iter()
        .filter(|key| *key != "colour")
        .map(|key| Show::Target(key.clone()));
    for show in colours.chain(others) {
        if ui.radio(*shown == show, legend::title_of(&show)).clicked() {
            out.push(ViewIntent::Show(show));
            ui.close();
        }
    }
}
