//! The *View* menu: what is shown.

use egui::{Key, Modifiers};
use pointstage_engine::stage::Show;

use super::{Action, Menu, Place, Scope};
use crate::window::app::App;
use crate::window::intent::{InspectIntent, Tab, ViewIntent, WindowIntent};
use crate::window::legend;

/// What clicks do.
pub(super) const GESTURES: &[(&str, &str)] = &[
    (
        "Click on a surface",
        "keep the surfel and list all that is known of it",
    ),
    ("Double click on a surface", "turn around it from now on"),
];

pub(super) fn actions(app: &App) -> Vec<Action> {
    let mut actions = show_actions(app);
    actions.extend(inspect_actions(app));
    actions.push(Action::new(
        "view.settings",
        "Background, exposure, radius…",
        Place::new(Menu::View, 3),
        WindowIntent::ChooseTab(Tab::View),
    ));
    actions
}

/// What the mouse does by clicks, for the keyboard: at the picture's middle.
fn inspect_actions(app: &App) -> Vec<Action> {
    let place = Place::new(Menu::View, 4);
    let middle = app
        .screens
        .active
        .viewport
        .map_or([0; 2], |viewport| viewport.size_px.map(|side| side / 2));
    let nothing_kept = (!app.inspector.is_pinned()).then(|| "nothing is kept".to_owned());
    vec![
        Action::new(
            "inspect.middle",
            "Inspect the middle of the picture",
            place,
            InspectIntent::Pin(middle),
        )
        .keys(Modifiers::SHIFT, Key::I),
        Action::new(
            "inspect.unpin",
            "Let go of the inspected surfel",
            place,
            InspectIntent::Unpin,
        )
        .keys_in(Scope::OnPicture, Modifiers::NONE, Key::Escape)
        .unless(nothing_kept),
        Action::new(
            "camera.pivot_middle",
            "Turn around the surface in the middle",
            place,
            InspectIntent::PivotOn(middle),
        )
        .keys(Modifiers::NONE, Key::P),
        Action::new("view.draw_now", "Draw now", place, ViewIntent::DrawNow)
            .keys(Modifiers::NONE, Key::F5),
    ]
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
            let is_on = app.session.panes.active.view.show == show;
            let (id, title) = (format!("view.show.{key}"), legend::title_of(&show));
            Action::new(id, title, place, ViewIntent::Show(show)).on(is_on)
        })
        .collect()
}
