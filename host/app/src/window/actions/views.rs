//! The *View* menu's second part: stored views.

use egui::{Key, Modifiers};

use super::{Action, COMMAND_SHIFT, Menu, Place};
use crate::window::app::App;
use crate::window::intent::ViewsIntent;
use crate::window::views::slot_key;

/// The keys of the slots, in order.
const SLOT_KEYS: [Key; 10] = [
    Key::Num1,
    Key::Num2,
    Key::Num3,
    Key::Num4,
    Key::Num5,
    Key::Num6,
    Key::Num7,
    Key::Num8,
    Key::Num9,
    Key::Num0,
];

pub(super) fn actions(app: &App) -> Vec<Action> {
    let place = Place::new(Menu::View, 1);
    let (views, recall, store) = (
        place.within("Views"),
        place.within("Go to view"),
        place.within("Store view"),
    );
    let stored = &app.session.views;
    let mut actions = vec![
        Action::new("views.add", "Keep this view", views, ViewsIntent::Add),
        Action::new("views.copy", "Copy view", views, ViewsIntent::Copy)
            .keys(COMMAND_SHIFT, Key::C),
        Action::new("views.paste", "Paste view", views, ViewsIntent::AskPaste)
            .keys(COMMAND_SHIFT, Key::V),
    ];
    let named = stored.named.iter().enumerate().map(|(index, view)| {
        let id = format!("views.named.{index}");
        Action::new(id, &view.name, recall, ViewsIntent::RecallNamed(index))
    });
    let slots = SLOT_KEYS.into_iter().enumerate();
    // An empty slot says how it is filled: its key must not be grey.
    actions.extend(slots.clone().map(|(slot, key)| {
        let number = slot_key(slot);
        let id = format!("views.recall.{number}");
        let title = match &stored.slots[slot] {
            Some(_) => number.to_string(),
            None => format!("{number} (empty)"),
        };
        Action::new(id, title, recall, ViewsIntent::Recall(slot)).keys(Modifiers::NONE, key)
    }));
    actions.extend(named);
    actions.extend(slots.map(|(slot, key)| {
        let number = slot_key(slot);
        let id = format!("views.store.{number}");
        let intent = ViewsIntent::Store(slot);
        Action::new(id, number.to_string(), store, intent).keys(Modifiers::COMMAND, key)
    }));
    actions
}
