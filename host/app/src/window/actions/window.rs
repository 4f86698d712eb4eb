//! The *Window* menu: panels and what they look like.

use egui::{Key, Modifiers, ThemePreference};

use super::{Action, COMMAND_SHIFT, Menu, Place};
use crate::preferences::Theme;
use crate::window::app::App;
use crate::window::intent::{Part, PathIntent, WindowIntent};
use crate::window::theme::{LARGEST, SMALLEST, TEXT_SCALES, larger, smaller};

/// Keys of the toolkit.
pub(super) const GESTURES: &[(&str, &str)] = &[
    ("Tab, Shift+Tab", "next and previous control"),
    ("Space, Enter", "press the control"),
];

pub(super) fn actions(app: &App) -> Vec<Action> {
    let place = Place::new(Menu::Window, 0);
    let toggle = |id, title, part| Action::new(id, title, place, WindowIntent::Toggle(part));
    let mut actions = vec![
        toggle("window.settings", "Settings panel", Part::Settings)
            .on(app.panels.settings)
            .keys(Modifiers::COMMAND, Key::Comma),
        toggle("window.log", "Log", Part::Log)
            .on(app.panels.log)
            .keys(Modifiers::COMMAND, Key::L),
        toggle("window.inspector", "Inspector", Part::Inspector)
            .on(app.panels.inspector)
            .keys(Modifiers::NONE, Key::I),
        toggle("window.path", "Camera path", Part::Path).on(app.panels.path),
        toggle("window.palette", "Find an action…", Part::Palette)
            .keys(Modifiers::COMMAND, Key::P)
            .keys(Modifiers::COMMAND, Key::K),
    ];
    actions.extend(path_actions(app));
    actions.extend(theme_actions(app));
    actions.extend(text_scale_actions(app));
    actions
}

/// What the strip of the camera path does, by name.
fn path_actions(app: &App) -> Vec<Action> {
    let place = Place::new(Menu::Window, 0).within("Path");
    let nothing = (app.session.path.duration_s() <= 0.0)
        .then(|| "nothing moves along the path yet".to_owned());
    let title = if app.player.is_playing() {
        "Pause path"
    } else {
        "Play path"
    };
    vec![
        Action::new("path.play", title, place, PathIntent::TogglePlay)
            .keys(Modifiers::SHIFT, Key::Space)
            .unless(nothing),
        Action::new(
            "path.add",
            "Add this view to the path",
            place,
            PathIntent::Append,
        ),
        Action::new(
            "path.render",
            "Render frames…",
            place,
            PathIntent::ShowDialog,
        )
        .unless(app.film_obstacle()),
    ]
}

fn theme_actions(app: &App) -> Vec<Action> {
    let place = Place::new(Menu::Window, 1).within("Theme");
    let chosen = app.remembered.appearance().0;
    let themes = [
        (
            "system",
            "As the system",
            Theme::System,
            ThemePreference::System,
        ),
        ("light", "Light", Theme::Light, ThemePreference::Light),
        ("dark", "Dark", Theme::Dark, ThemePreference::Dark),
    ];
    let themes = themes.map(|(id, title, theme, preference)| {
        let id = format!("window.theme.{id}");
        Action::new(id, title, place, WindowIntent::Theme(preference)).on(theme == chosen)
    });
    themes.into()
}

fn text_scale_actions(app: &App) -> Vec<Action> {
    let place = Place::new(Menu::Window, 1).within("Text scale");
    let chosen = app.remembered.appearance().1;
    let to = |id: &str, title: &str, scale| {
        Action::new(id, title, place, WindowIntent::TextScale(scale))
    };
    let ends = |is_end: bool, text: &str| is_end.then(|| text.to_owned());
    let mut actions = vec![
        to("window.text.larger", "Larger", larger(chosen))
            .keys(Modifiers::COMMAND, Key::Equals)
            .keys(Modifiers::COMMAND, Key::Plus)
            .keys(COMMAND_SHIFT, Key::Plus)
            .unless(ends(chosen >= LARGEST, "texts are as large as they get")),
        to("window.text.smaller", "Smaller", smaller(chosen))
            .keys(Modifiers::COMMAND, Key::Minus)
            .unless(ends(chosen <= SMALLEST, "texts are as small as they get")),
        to("window.text.usual", "Usual size", 1.0).keys(COMMAND_SHIFT, Key::Num0),
    ];
    actions.extend(TEXT_SCALES.map(|scale| {
        let percent = (scale * 100.0).round();
        let id = format!("window.text.{percent}");
        to(&id, &format!("{percent} %"), scale).on(scale == chosen)
    }));
    actions
}
