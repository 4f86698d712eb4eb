//! The *View* menu: camera, views, what is shown.

use egui::{Key, Modifiers};
use pointstage_engine::stage::Show;

use super::{Action, Menu, Place, Scope};
use crate::window::app::App;
use crate::window::intent::{CameraIntent, InspectIntent, Tab, ViewIntent, WindowIntent};
use crate::window::legend;
use crate::window::navigation::{Axis, CameraMove, UpAxis};

/// Gestures over the picture.
pub(super) const GESTURES: &[(&str, &str)] = &[
    ("Drag", "turn around the scene"),
    ("Shift+drag, middle drag", "shift the scene"),
    ("Wheel, pinch", "zoom to the pointer"),
    ("Arrow keys", "turn, after a click on the picture"),
    ("Shift+arrow keys", "shift, after a click on the picture"),
    (
        "Click on a surface",
        "keep the surfel and list all that is known of it",
    ),
    ("Double click on a surface", "turn around it from now on"),
    ("+, −", "zoom, after a click on the picture"),
];

pub(super) fn actions(app: &App) -> Vec<Action> {
    let mut actions = camera_actions(app);
    actions.extend(show_actions(app));
    actions.extend(inspect_actions(app));
    actions.push(Action::new(
        "view.settings",
        "Background, exposure, radius…",
        Place::new(Menu::View, 3),
        WindowIntent::ChooseTab(Tab::View),
    ));
    actions
}

fn camera_actions(app: &App) -> Vec<Action> {
    let place = Place::new(Menu::View, 0);
    let camera = |camera_move| CameraIntent::Move(camera_move);
    let mut actions = vec![
        Action::new(
            "camera.frame",
            "Frame scene",
            place,
            camera(CameraMove::Frame),
        )
        .keys(Modifiers::NONE, Key::F)
        .keys(Modifiers::NONE, Key::Home),
    ];
    let keys = |axis| match axis {
        Axis::Front => (Modifiers::NONE, Key::Z),
        Axis::Back => (Modifiers::SHIFT, Key::Z),
        Axis::Left => (Modifiers::SHIFT, Key::X),
        Axis::Right => (Modifiers::NONE, Key::X),
        Axis::Top => (Modifiers::NONE, Key::Y),
        Axis::Bottom => (Modifiers::SHIFT, Key::Y),
    };
    actions.extend(Axis::ALL.map(|(axis, name)| {
        let id = format!("camera.look_from.{}", name.to_lowercase());
        let (modifiers, key) = keys(axis);
        let place = place.within("Look from");
        Action::new(id, name, place, camera(CameraMove::Axis(axis))).keys(modifiers, key)
    }));
    let up_now = UpAxis::of(&app.session.camera);
    for (axis, name) in [(UpAxis::Y, "Y"), (UpAxis::Z, "Z")] {
        let id = format!("camera.up.{}", name.to_lowercase());
        let place = place.within("Up axis");
        let action = Action::new(id, name, place, camera(CameraMove::Upwards(axis)));
        actions.push(action.on(up_now == axis));
    }
    actions.push(
        Action::new(
            "camera.projection",
            "Perspective or orthographic",
            place,
            camera(CameraMove::SwitchProjection),
        )
        .keys(Modifiers::NONE, Key::O),
    );
    actions
}

/// What the mouse does by clicks, for the keyboard: at the picture's middle.
fn inspect_actions(app: &App) -> Vec<Action> {
    let place = Place::new(Menu::View, 4);
    let middle = app
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
            let is_on = app.session.view.show == show;
            let (id, title) = (format!("view.show.{key}"), legend::title_of(&show));
            Action::new(id, title, place, ViewIntent::Show(show)).on(is_on)
        })
        .collect()
}
