//! The *View* menu: what is shown.

use pointstage_engine::stage::Show;

use super::{Action, Menu, Place};
use crate::window::app::App;
use crate::window::intent::{Tab, ViewIntent, WindowIntent};
use crate::window::legend;

pub(super) fn actions(app: &App) -> Vec<Action> {
    let mut actions = show_actions(app);
    actions.push(Action::new(
        "view.settings",
        "Background, exposure, radius…",
        Place::new(Menu::View, 3),
        WindowIntent::ChooseTab(Tab::View),
    ));
    actions
}

/// Colours and every target of the renderer.
fn show_actions(app: &App) -> Vec<Action> {
    let place = Place::new(Menu::View, 2).within("Show");
    let targets = app.targets().iter().filter(|key| *key != "colour");
    let shows = std::iter::once(Show::Colours).chain(targets.cloned().map(Show::Target));
    shows
        .map(|show| {
            let key = match &show {
                Show::Colours => "colours",
                Show::Target(key) => key,
            };
            let is_on = app.session.view.show == show;
            let (id, title) = (format!("view.show.{key}"), legend::title_of(&show));
            Action::new(id, title, place, ViewIntent::Show(show)).on(is_on)
        })
        .collect()
}
