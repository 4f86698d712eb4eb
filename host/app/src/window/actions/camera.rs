//! The *View* menu's first part: the camera.

use egui::{Key, Modifiers};
use pointstage_scene::NearClipping;

use super::{Action, Menu, Place};
use crate::window::app::App;
use crate::window::intent::CameraIntent;
use crate::window::navigation::{Axis, CameraMove, NavigationOptions, UpAxis};

/// Gestures over the picture.
pub(super) const GESTURES: &[(&str, &str)] = &[
    ("Drag", "turn around the pivot"),
    ("Shift+drag, middle drag", "shift the scene"),
    ("Ctrl+drag", "roll, without the turntable lock"),
    ("Wheel, pinch, Ctrl+scroll", "zoom to the pointer"),
    ("Tilted wheel, Shift+wheel", "shift sideways"),
    ("Right button", "look around from the eye"),
    ("Right button + W, S", "fly forward, back"),
    ("Right button + A, D", "fly left, right"),
    ("Right button + Q, E", "fly down, up"),
    ("Right button + Shift", "fly faster"),
    ("Right button + wheel", "change the speed of flying"),
    ("L+drag, L+wheel", "move the first light"),
    ("Arrow keys", "turn, after a click on the picture"),
    ("Shift+arrow keys", "shift, after a click on the picture"),
    ("+, −", "zoom, after a click on the picture"),
];

pub(super) fn actions(app: &App) -> Vec<Action> {
    let place = Place::new(Menu::View, 0);
    let mut actions = vec![
        moves("camera.frame", "Frame scene", place, CameraMove::Frame)
            .keys(Modifiers::NONE, Key::Home)
            .keys(Modifiers::SHIFT, Key::F),
        moves(
            "camera.frame_selection",
            "Frame selection",
            place,
            CameraMove::FrameSelection,
        )
        .keys(Modifiers::NONE, Key::F),
    ];
    actions.extend(Axis::ALL.map(|(axis, name)| {
        let id = format!("camera.look_from.{}", name.to_lowercase());
        let (modifiers, key) = axis_keys(axis);
        let place = place.within("Look from");
        moves(id, name, place, CameraMove::Axis(axis)).keys(modifiers, key)
    }));
    let up_now = UpAxis::exactly(&app.session.panes.active.camera);
    actions.extend([(UpAxis::Y, "Y"), (UpAxis::Z, "Z")].map(|(axis, name)| {
        let id = format!("camera.up.{}", name.to_lowercase());
        let place = place.within("Up axis");
        moves(id, name, place, CameraMove::Upwards(axis)).on(up_now == Some(axis))
    }));
    actions.push(
        moves(
            "camera.projection",
            "Perspective or orthographic",
            place,
            CameraMove::SwitchProjection,
        )
        .keys(Modifiers::NONE, Key::O),
    );
    actions.extend(habits(app));
    actions
}

fn moves(id: impl Into<String>, title: &str, place: Place, camera_move: CameraMove) -> Action {
    Action::new(id, title, place, CameraIntent::Move(camera_move))
}

fn axis_keys(axis: Axis) -> (Modifiers, Key) {
    match axis {
        Axis::Front => (Modifiers::NONE, Key::Z),
        Axis::Back => (Modifiers::SHIFT, Key::Z),
        Axis::Left => (Modifiers::SHIFT, Key::X),
        Axis::Right => (Modifiers::NONE, Key::X),
        Axis::Top => (Modifiers::NONE, Key::Y),
        Axis::Bottom => (Modifiers::SHIFT, Key::Y),
    }
}

/// What can be switched.
fn habits(app: &App) -> Vec<Action> {
    let place = Place::new(Menu::View, 0).within("Camera");
    let now = app.session.navigation;
    let switch = |id, title, is_on, options| {
        Action::new(id, title, place, CameraIntent::Options(options)).on(is_on)
    };
    let is_near_automatic = app.session.panes.active.near == NearClipping::Automatic;
    let near = if is_near_automatic {
        NearClipping::Distance(0.5 * app.session.panes.active.camera.distance())
    } else {
        NearClipping::Automatic
    };
    vec![
        Action::new(
            "camera.turntable",
            "Turntable lock",
            place,
            CameraIntent::ToggleTurntable,
        )
        .on(now.turntable)
        .keys(Modifiers::NONE, Key::T),
        switch(
            "camera.inertia",
            "Inertia",
            now.inertia,
            NavigationOptions {
                inertia: !now.inertia,
                ..now
            },
        ),
        switch(
            "camera.flights",
            "Smooth flights",
            now.flights,
            NavigationOptions {
                flights: !now.flights,
                ..now
            },
        ),
        Action::new(
            "camera.near",
            "Automatic near clipping",
            place,
            CameraIntent::Near(near),
        )
        .on(is_near_automatic),
        switch(
            "camera.gizmo",
            "Axes and lights in the corner",
            now.gizmo,
            NavigationOptions {
                gizmo: !now.gizmo,
                ..now
            },
        ),
    ]
}
