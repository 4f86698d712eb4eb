//! The camera's part of the *View* tab: projection, near clipping, and the habits of moving.

use egui::{Button, Checkbox, ComboBox, DragValue, Slider, SliderClamping, Ui};
use pointstage_scene::{Bounds, Camera, NearClipping, Projection};

use crate::window::intent::{CameraIntent, Intents};
use crate::window::navigation::{
    Axis, CameraMove, FLY_SPEEDS, NavigationOptions, ScrollAction, UpAxis, fov_degrees,
};

/// The nearest end of the near plane's slider, as a part of the distance to the pivot.
const NEAREST: f64 = 1e-3;

/// What this part shows.
pub(crate) struct CameraTab<'a> {
    /// The eye.
    pub(crate) camera: &'a Camera,
    /// What decides where the near plane stands.
    pub(crate) near: NearClipping,
    /// The scene's box in the world.
    pub(crate) bounds: Bounds,
    /// The user's habits.
    pub(crate) options: &'a NavigationOptions,
}

/// The camera's part.
pub(crate) fn camera_ui(ui: &mut Ui, tab: &CameraTab<'_>, out: &mut Intents) {
    ui.strong("Camera");
    projection_ui(ui, tab.camera, out);
    near_ui(ui, tab, out);
    up_ui(ui, tab.camera, out);
    ui.horizontal_wrapped(|ui| {
        let frames = [
            ("Frame scene", "Home", CameraMove::Frame),
            ("Frame selection", "F", CameraMove::FrameSelection),
        ];
        for (name, key, camera_move) in frames {
            if ui.button(name).on_hover_text(key).clicked() {
                push_move(out, camera_move);
            }
        }
        for (axis, name) in Axis::ALL {
            if ui.button(name).clicked() {
                push_move(out, CameraMove::Axis(axis));
            }
        }
    });
    ui.separator();
    ui.strong("Moving");
    habits_ui(ui, tab.options, out);
}

fn push_move(out: &mut Intents, camera_move: CameraMove) {
    out.push(CameraIntent::Move(camera_move));
}

fn projection_ui(ui: &mut Ui, camera: &Camera, out: &mut Intents) {
    super::row(ui, "Projection", "O switches", |ui| {
        let is_perspective = fov_degrees(camera).is_some();
        let perspective = ui.selectable_label(is_perspective, "perspective");
        let orthographic = ui.selectable_label(!is_perspective, "orthographic");
        if (perspective.clicked() && !is_perspective) || (orthographic.clicked() && is_perspective)
        {
            push_move(out, CameraMove::SwitchProjection);
        }
    });
    let mut project = |projection| out.push(CameraIntent::Project(projection));
    match camera.projection {
        Projection::Perspective { fov_y_rad } => {
            super::row(ui, "Field of view", "Full vertical angle", |ui| {
                let mut degrees = fov_y_rad.to_degrees();
                let slider = Slider::new(&mut degrees, 5.0..=120.0)
                    .suffix("°")
                    .max_decimals(1);
                if ui.add(slider).changed() {
                    let fov_y_rad = degrees.to_radians();
                    project(Projection::Perspective { fov_y_rad });
                }
            });
        }
        Projection::Orthographic { height } => {
            super::row(ui, "Height", "Of the picture, scene units", |ui| {
                let mut edited = height;
                let drag = DragValue::new(&mut edited)
                    .speed(height * 0.01)
                    .max_decimals(6);
                if ui.add(drag).changed() && edited > 0.0 && edited.is_finite() {
                    project(Projection::Orthographic { height: edited });
                }
            });
        }
    }
}

/// Automatic, or a distance: a slider from the eye to the scene's far side, and a number that takes any.
fn near_ui(ui: &mut Ui, tab: &CameraTab<'_>, out: &mut Intents) {
    let help = "What is nearer to the eye is cut away. Automatic: a thousandth of the distance to the pivot";
    super::row(ui, "Near clipping", help, |ui| {
        let mut is_automatic = tab.near == NearClipping::Automatic;
        if ui
            .add(Checkbox::new(&mut is_automatic, "automatic"))
            .changed()
        {
            let near = if is_automatic {
                NearClipping::Automatic
            } else {
                // Half way to the pivot: it is seen at once what the plane does.
                NearClipping::Distance(0.5 * tab.camera.distance())
            };
            out.push(CameraIntent::Near(near));
        }
    });
    let NearClipping::Distance(distance) = tab.near else {
        return;
    };
    super::row(
        ui,
        "Near plane",
        "Distance from the eye, scene units",
        |ui| {
            let mut edited = distance;
            let range = NEAREST * tab.camera.distance()..=tab.camera.farthest_near(&tab.bounds);
            let slider = Slider::new(&mut edited, range)
                .logarithmic(true)
                .clamping(SliderClamping::Never)
                .max_decimals(6);
            if ui.add(slider).changed() && edited > 0.0 && edited.is_finite() {
                let near = NearClipping::Distance(edited);
                out.push(CameraIntent::Near(near));
            }
        },
    );
}

fn up_ui(ui: &mut Ui, camera: &Camera, out: &mut Intents) {
    let help = "The axis that points upwards: Y for models, Z for maps and many scanners";
    super::row(ui, "Up", help, |ui| {
        let now = UpAxis::exactly(camera);
        for (axis, name) in [(UpAxis::Y, "Y"), (UpAxis::Z, "Z")] {
            let is_now = now == Some(axis);
            if ui.selectable_label(is_now, name).clicked() && !is_now {
                push_move(out, CameraMove::Upwards(axis));
            }
        }
    });
}

fn habits_ui(ui: &mut Ui, options: &NavigationOptions, out: &mut Intents) {
    let mut edited = *options;
    let switches = [
        (
            &mut edited.turntable,
            "Turntable lock",
            "The horizon stays level; without it the scene turns freely, and Ctrl+drag rolls it",
        ),
        (
            &mut edited.inertia,
            "Inertia",
            "A drag that is let go of in motion glides on for a moment",
        ),
        (
            &mut edited.flights,
            "Smooth flights",
            "The camera flies to another view; without this it is there at once",
        ),
        (
            &mut edited.gizmo,
            "Axes and lights in the corner",
            "A small ball in the picture; a click on an axis looks from there",
        ),
    ];
    for (is_on, name, help) in switches {
        ui.checkbox(is_on, name).on_hover_text(help);
    }
    let help = "What two fingers on a trackpad do; a wheel zooms, and so do Ctrl and the pinch";
    super::row(ui, "Two fingers", help, |ui| {
        let mut names = ScrollAction::ALL.into_iter();
        let now = names.find(|(action, _)| *action == edited.scroll);
        ComboBox::from_id_salt("two fingers")
            .selected_text(now.map_or("", |(_, name)| name))
            .show_ui(ui, |ui| {
                for (action, name) in ScrollAction::ALL {
                    ui.selectable_value(&mut edited.scroll, action, name);
                }
            });
    });
    super::row(
        ui,
        "Flying speed",
        "With the right button and W A S D; the wheel changes it while flying",
        |ui| {
            let slider = Slider::new(&mut edited.fly_speed, FLY_SPEEDS)
                .logarithmic(true)
                .suffix("×")
                .max_decimals(2);
            ui.add(slider);
        },
    );
    let is_default = *options == NavigationOptions::default();
    if ui
        .add_enabled(!is_default, Button::new("Reset moving"))
        .clicked()
    {
        edited = NavigationOptions::default();
    }
    if edited != *options {
        out.push(CameraIntent::Options(edited));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::window::intent::Intent;
    use egui::accesskit::Role;
    use egui_kittest::Harness;
    use egui_kittest::kittest::Queryable as _;
    use glam::DVec3;

    fn harness(near: NearClipping) -> Harness<'static, Intents> {
        let app = move |ui: &mut Ui, asked: &mut Intents| {
            let tab = CameraTab {
                camera: &Camera::default(),
                near,
                bounds: Bounds::new(DVec3::splat(-1.0), DVec3::splat(1.0)),
                options: &NavigationOptions::default(),
            };
            camera_ui(ui, &tab, asked);
        };
        Harness::builder()
            .with_size([360.0, 500.0])
            .build_ui_state(app, Intents::new())
    }

    #[test]
    fn each_habit_has_a_switch() {
        let usual = NavigationOptions::default();
        let switches = [
            (
                "Turntable lock",
                NavigationOptions {
                    turntable: false,
                    ..usual
                },
            ),
            (
                "Inertia",
                NavigationOptions {
                    inertia: true,
                    ..usual
                },
            ),
            (
                "Smooth flights",
                NavigationOptions {
                    flights: false,
                    ..usual
                },
            ),
            (
                "Axes and lights in the corner",
                NavigationOptions {
                    gizmo: false,
                    ..usual
                },
            ),
        ];
        for (name, expected) in switches {
            let mut harness = harness(NearClipping::Automatic);
            harness.get_by_role_and_label(Role::CheckBox, name).click();
            harness.run();
            let asked = Intent::Camera(CameraIntent::Options(expected));
            assert_eq!(harness.state()[..1], [asked], "'{name}'");
        }
    }

    #[test]
    fn two_fingers_can_turn() {
        let mut harness = harness(NearClipping::Automatic);
        let box_of_two = harness.get_by_role_and_label(Role::ComboBox, "Two fingers");
        box_of_two.click();
        harness.run();
        harness.get_by_label("turn").click();
        harness.run();
        let turns = |intent: &Intent| matches!(intent, Intent::Camera(CameraIntent::Options(options)) if options.scroll == ScrollAction::Turn);
        assert!(harness.state().iter().any(turns), "{:?}", harness.state());
    }

    #[test]
    fn near_clipping_is_automatic_or_a_distance() {
        let mut automatic = harness(NearClipping::Automatic);
        assert!(
            automatic
                .query_by_role_and_label(Role::Slider, "Near plane")
                .is_none()
        );
        automatic
            .get_by_role_and_label(Role::CheckBox, "automatic")
            .click();
        automatic.run();
        let near = NearClipping::Distance(1.5);
        assert_eq!(
            automatic.state()[..1],
            [Intent::Camera(CameraIntent::Near(near))]
        );

        let mut by_hand = harness(near);
        let slider = by_hand.get_by_role_and_label(Role::Slider, "Near plane");
        slider.set_value_accesskit(2.5);
        by_hand.run();
        let near = NearClipping::Distance(2.5);
        let asked = Intent::Camera(CameraIntent::Near(near));
        assert!(by_hand.state().contains(&asked), "{:?}", by_hand.state());
    }

    #[test]
    fn the_scene_and_the_selection_are_framed() {
        for (name, camera_move) in [
            ("Frame scene", CameraMove::Frame),
            ("Frame selection", CameraMove::FrameSelection),
        ] {
            let mut harness = harness(NearClipping::Automatic);
            harness.get_by_label(name).click();
            harness.run();
            let asked = Intent::Camera(CameraIntent::Move(camera_move));
            assert_eq!(**harness.state(), [asked]);
        }
    }
}
