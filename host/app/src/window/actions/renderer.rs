//! The *Renderer* menu: which renderer draws.

use egui::{Key, Modifiers};

use super::{Action, Menu, Place, Scope, own_keys};
use crate::window::app::App;
use crate::window::intent::{RendererIntent, Tab, WindowIntent};

pub(super) fn actions(app: &App) -> Vec<Action> {
    let (choose, more) = (Place::new(Menu::Renderer, 0), Place::new(Menu::Renderer, 2));
    let mut actions: Vec<Action> = app
        .rows
        .renderers
        .iter()
        .map(|row| {
            let intent = RendererIntent::Choose(row.id.clone());
            let reason = row
                .obstacle
                .as_ref()
                .map(|obstacle| obstacle.reason.clone());
            Action::new(
                format!("renderer.choose.{}", row.id),
                &row.title,
                choose,
                intent,
            )
            .on(row.id == app.session.panes.active.renderer)
            .unless(reason)
        })
        .collect();
    let no_preview = app.session.panes.active.preview.is_none();
    actions.push(
        Action::new(
            "renderer.toggle_preview",
            "Show the preview renderer",
            more,
            RendererIntent::TogglePreview,
        )
        .keys_in(Scope::OnPicture, Modifiers::NONE, Key::Space)
        .on(app.screens.active.roles.is_held())
        .unless(no_preview.then(|| "no preview renderer is chosen".to_owned())),
    );
    if let Some(row) = app.rows.renderer(&app.session.panes.active.renderer) {
        actions.extend(own_keys::actions(row, &app.session.chosen_settings()));
    }
    actions.push(Action::new(
        "renderer.settings",
        "Settings…",
        more,
        WindowIntent::ChooseTab(Tab::Renderer),
    ));
    actions.push(Action::new(
        "renderer.plugins",
        "Plugins…",
        more,
        WindowIntent::ChooseTab(Tab::Plugins),
    ));
    actions
}
