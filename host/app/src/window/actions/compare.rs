//! The *Compare* menu: views beside each other.

use egui::{Key, Modifiers};

use super::{Action, COMMAND_SHIFT, Menu, Place, Scope};
use crate::window::app::App;
use crate::window::comparison::{Measure, Way};
use crate::window::intent::{CompareIntent, ComparePart};
use crate::window::several::MOST_VIEWS;

/// What the mouse does to the pictures themselves.
pub(super) const GESTURES: &[(&str, &str)] = &[
    (
        "Alt + wheel",
        "enlarge the pixels under the pointer, in every view",
    ),
    ("Alt + drag", "move the enlarged part"),
    ("Click into a view", "let panels, keys and menus act on it"),
];

pub(super) fn actions(app: &App) -> Vec<Action> {
    let mut actions = counts(app);
    let single = (app.session.panes.count() < 2).then(|| "there is only one view".to_owned());
    actions.extend(
        ways(app)
            .into_iter()
            .map(|action| action.unless(single.clone())),
    );
    actions.extend(
        shared(app)
            .into_iter()
            .map(|action| action.unless(single.clone())),
    );
    actions.extend(panels(app));
    actions
}

fn counts(app: &App) -> Vec<Action> {
    let place = Place::new(Menu::Compare, 0);
    let keys = [Key::Num1, Key::Num2, Key::Num3, Key::Num4];
    let titles = ["One view", "Two views", "Three views", "Four views"];
    let counts = (1..=MOST_VIEWS).zip(titles).zip(keys);
    counts
        .map(|((count, title), key)| {
            let id = format!("compare.views.{count}");
            Action::new(id, title, place, CompareIntent::Count(count))
                .on(app.session.panes.count() == count)
                .keys(Modifiers::ALT, key)
        })
        .collect()
}

fn ways(app: &App) -> Vec<Action> {
    let place = Place::new(Menu::Compare, 1);
    let ways = Way::ALL.into_iter().map(|(way, name)| {
        let id = format!("compare.way.{}", way.key());
        let action =
            Action::new(id, name, place, CompareIntent::Way(way))
                .on(app.session.comparison.way == way);
        let key = match way {
            Way::Grid => Key::G,
            Way::Wipe => Key::W,
            Way::Flicker => Key::F,
            Way::Difference(Measure::Absolute) => Key::D,
            Way::Difference(_) => return action,
        };
        action.keys(COMMAND_SHIFT, key)
    });
    ways.collect()
}

fn shared(app: &App) -> Vec<Action> {
    let comparison = &app.session.comparison;
    let place = Place::new(Menu::Compare, 2);
    let against = CompareIntent::Against(app.session.panes.active_index());
    vec![
        Action::new(
            "compare.next",
            "Next view",
            place,
            CompareIntent::ActivateNext,
        )
        .keys(Modifiers::NONE, Key::F6),
        Action::new(
            "compare.against",
            "Measure against this view",
            place,
            against,
        )
        .on(app.session.panes.active_index() == comparison.against),
        Action::new(
            "compare.link",
            "Linked cameras",
            place,
            CompareIntent::Link(!comparison.is_linked),
        )
        .on(comparison.is_linked)
        .keys(COMMAND_SHIFT, Key::K),
        Action::new(
            "compare.lock",
            "Fair comparison",
            place,
            CompareIntent::Lock(!comparison.is_locked),
        )
        .on(comparison.is_locked)
        .keys(COMMAND_SHIFT, Key::L),
        Action::new(
            "compare.measure",
            "Measure when still",
            place,
            CompareIntent::Measure(!comparison.measures),
        )
        .on(comparison.measures),
    ]
}

fn panels(app: &App) -> Vec<Action> {
    let place = Place::new(Menu::Compare, 3);
    let open = app.comparing.panels;
    let toggle = |id, title, part, is_open| {
        Action::new(id, title, place, CompareIntent::Toggle(part)).on(is_open)
    };
    let not_zoomed = app.comparing.zoom.is_none();
    vec![
        toggle("compare.pixels", "Pixels", ComparePart::Pixels, open.pixels),
        toggle(
            "compare.times",
            "Frame times and memory",
            ComparePart::Times,
            open.times,
        ),
        toggle(
            "compare.why",
            "Why do they differ?",
            ComparePart::Why,
            open.why,
        ),
        Action::new(
            "compare.zoom_in",
            "Enlarge the pixels in the middle",
            place,
            CompareIntent::Zoom(2.0, [0.5; 2]),
        )
        .keys_in(Scope::OnPicture, Modifiers::ALT, Key::Plus),
        Action::new(
            "compare.zoom_out",
            "Pictures in their own size",
            place,
            CompareIntent::ZoomOut,
        )
        .keys_in(Scope::OnPicture, Modifiers::ALT, Key::Num0)
        .unless(not_zoomed.then(|| "no pixels are enlarged".to_owned())),
    ]
}
