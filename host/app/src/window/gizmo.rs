//! The axes and the lights as the eye sees them, small in a corner of the picture.
//!
//! The sphere stands for all directions: x, y and z of the world are drawn from its middle, and each light is a dot where its
//! light comes from. What lies behind the sphere is dimmed. A click on an axis' end looks from there.

use egui::{Align2, Color32, FontId, Painter, Pos2, Rect, Sense, Stroke, Ui, Vec2, vec2};
use glam::{DVec3, Vec3};
use pointstage_scene::{Camera, Light, LightKind, Lights};

use super::intent::{CameraIntent, Intents};
use super::navigation::{Axis, CameraMove, UpAxis};

/// Side of the square that the gizmo takes, points.
const SIDE: f32 = 96.0;

/// Radius of the sphere, points: the axes' ends have room around it.
const RADIUS: f32 = 32.0;

/// Radius of an axis' end, points: large enough to be hit.
const END_RADIUS: f32 = 8.0;

/// Distance from the picture's edge, points.
const MARGIN: f32 = 10.0;

/// A picture that is narrower or lower than this has no room for it, points.
const LEAST_PICTURE: f32 = 2.5 * SIDE;

/// Opacity of what is behind the sphere.
const BEHIND: f32 = 0.35;

/// The axes of the world with their letters and colours.
const AXES: [(DVec3, &str, Color32); 3] = [
    (DVec3::X, "x", Color32::from_rgb(0xe0, 0x5a, 0x4e)),
    (DVec3::Y, "y", Color32::from_rgb(0x6c, 0xb2, 0x4a)),
    (DVec3::Z, "z", Color32::from_rgb(0x4f, 0x8f, 0xe6)),
];

/// What the gizmo shows.
pub(crate) struct Gizmo<'a> {
    /// The eye.
    pub(crate) camera: &'a Camera,
    /// The lights.
    pub(crate) lights: &'a Lights,
    /// The axis that points upwards.
    pub(crate) up: UpAxis,
}

/// A thing on the sphere, to be drawn from back to front.
struct Mark<'a> {
    /// View space, within the unit sphere; z towards the eye.
    place: DVec3,
    kind: MarkKind<'a>,
}

enum MarkKind<'a> {
    /// An axis' positive end, with its letter.
    Letter(&'a str, Color32, Axis),
    /// An axis' negative end.
    Ring(Color32, Axis),
    /// A light, with its number.
    Light(usize, Color32),
}

/// Paints the gizmo in the upper right corner of `picture`, and answers clicks on it.
pub(crate) fn gizmo_ui(ui: &mut Ui, picture: Rect, gizmo: &Gizmo<'_>, out: &mut Intents) {
    if picture.width() < LEAST_PICTURE || picture.height() < LEAST_PICTURE {
        return;
    }
    let corner = picture.right_top() + vec2(-MARGIN - SIDE, MARGIN);
    let rect = Rect::from_min_size(corner, Vec2::splat(SIDE));
    let middle = rect.center();
    let painter = ui.painter_at(rect);
    painter.circle(
        middle,
        RADIUS,
        Color32::from_black_alpha(70),
        Stroke::new(1.0, Color32::from_white_alpha(70)),
    );
    let mut marks = marks(gizmo);
    marks.sort_by(|a, b| a.place.z.total_cmp(&b.place.z));
    for mark in &marks {
        mark_ui(ui, &painter, middle, mark, out);
    }
}

/// Everything on the sphere, in no order.
fn marks<'a>(gizmo: &Gizmo<'_>) -> Vec<Mark<'a>> {
    let view_from_world = gizmo.camera.view_from_world();
    let mut marks = Vec::new();
    for (axis, letter, colour) in AXES {
        let place = view_from_world.transform_vector3(axis);
        marks.push(Mark {
            place,
            kind: MarkKind::Letter(letter, colour, end_of(axis, gizmo.up)),
        });
        marks.push(Mark {
            place: -place,
            kind: MarkKind::Ring(colour, end_of(-axis, gizmo.up)),
        });
    }
    for (index, light) in gizmo.lights.enabled().iter().enumerate() {
        if let Some(place) = light_place(light, gizmo.camera) {
            marks.push(Mark {
                place,
                kind: MarkKind::Light(index + 1, light_colour(light.colour)),
            });
        }
    }
    marks
}

/// The end of an axis, to look from, that lies in this direction of the world.
fn end_of(direction: DVec3, up: UpAxis) -> Axis {
    let nearness = |axis: Axis| axis.direction(up).dot(direction);
    let ends = Axis::ALL.map(|(axis, _)| axis);
    let nearest = ends
        .into_iter()
        .max_by(|a, b| nearness(*a).total_cmp(&nearness(*b)));
    nearest.unwrap_or(Axis::Front)
}

/// Where a light comes from, seen from the pivot: view space, unit. `None` for one at the pivot.
pub(crate) fn light_place(light: &Light, camera: &Camera) -> Option<DVec3> {
    let view_from_world = camera.view_from_world();
    match light.kind_view(&view_from_world) {
        LightKind::Directional { towards } => towards.try_normalize(),
        LightKind::Point { position } => {
            (position - view_from_world.transform_point3(camera.pivot)).try_normalize()
        }
    }
}

/// Linear light as a colour of the screen, as bright as can be: a weak light is still to be seen.
fn light_colour(linear: Vec3) -> Color32 {
    let greatest = linear.max_element();
    if !(greatest > 0.0 && linear.is_finite()) {
        return Color32::GRAY;
    }
    let [red, green, blue] = (linear / greatest).max(Vec3::ZERO).to_array();
    egui::Rgba::from_rgb(red, green, blue).into()
}

fn mark_ui(ui: &Ui, painter: &Painter, middle: Pos2, mark: &Mark<'_>, out: &mut Intents) {
    let on_sphere = vec2(mark.place.x as f32, -mark.place.y as f32) * RADIUS;
    let opacity = if mark.place.z < -1e-6 { BEHIND } else { 1.0 };
    let dimmed = |colour: Color32| colour.gamma_multiply(opacity);
    match mark.kind {
        MarkKind::Letter(letter, colour, axis) => {
            let end = middle + on_sphere;
            let is_hovered = end_ui(ui, end, axis, out);
            painter.line_segment([middle, end], Stroke::new(2.0, dimmed(colour)));
            let edge = if is_hovered {
                Color32::WHITE
            } else {
                dimmed(colour)
            };
            painter.circle(end, END_RADIUS, dimmed(colour), Stroke::new(1.5, edge));
            let font = FontId::proportional(12.0);
            painter.text(
                end,
                Align2::CENTER_CENTER,
                letter,
                font,
                dimmed(Color32::BLACK),
            );
        }
        MarkKind::Ring(colour, axis) => {
            let end = middle + on_sphere;
            let is_hovered = end_ui(ui, end, axis, out);
            let colour = if is_hovered {
                Color32::WHITE
            } else {
                dimmed(colour)
            };
            painter.circle_stroke(end, END_RADIUS * 0.7, Stroke::new(1.5, colour));
        }
        MarkKind::Light(number, colour) => {
            let dot = middle + on_sphere * 1.2;
            painter.line_segment(
                [middle + on_sphere * 0.8, dot],
                Stroke::new(2.0, dimmed(colour)),
            );
            let edge = Stroke::new(1.0, dimmed(Color32::BLACK));
            painter.circle(dot, 4.5, dimmed(colour), edge);
            let font = FontId::proportional(9.0);
            let beside = dot + vec2(7.0, 0.0);
            let text = number.to_string();
            painter.text(
                beside,
                Align2::LEFT_CENTER,
                text,
                font,
                dimmed(Color32::WHITE),
            );
        }
    }
}

/// The place of an axis' end that answers to clicks. True while the pointer is there. The keyboard has keys for these views.
fn end_ui(ui: &Ui, at: Pos2, axis: Axis, out: &mut Intents) -> bool {
    let rect = Rect::from_center_size(at, Vec2::splat(2.0 * END_RADIUS));
    let id = ui.scope_id().with(("gizmo", axis.name()));
    let response = ui.interact(rect, id, Sense::CLICK);
    let name = format!("Look from {}", axis.name().to_lowercase());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &name));
    let response = response.on_hover_text(name.as_str());
    if response.clicked() {
        out.push(CameraIntent::Move(CameraMove::Axis(axis)));
    }
    response.hovered()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::window::intent::Intent;
    use egui_kittest::Harness;
    use egui_kittest::kittest::Queryable as _;
    use pointstage_scene::LightSpace;

    fn harness(side: f32) -> Harness<'static, Intents> {
        let app = move |ui: &mut Ui, asked: &mut Intents| {
            let gizmo = Gizmo {
                camera: &Camera::default(),
                lights: &Lights::default(),
                up: UpAxis::Y,
            };
            let picture = Rect::from_min_size(Pos2::ZERO, Vec2::splat(side));
            gizmo_ui(ui, picture, &gizmo, asked);
        };
        Harness::builder()
            .with_size([side, side])
            .build_ui_state(app, Intents::new())
    }

    #[test]
    fn a_click_on_an_axis_looks_from_its_end() {
        for (axis, name) in [
            (Axis::Right, "Look from right"),
            (Axis::Top, "Look from top"),
        ] {
            let mut harness = harness(400.0);
            harness.get_by_label(name).click();
            harness.run();
            let expected = Intent::Camera(CameraIntent::Move(CameraMove::Axis(axis)));
            assert_eq!(**harness.state(), [expected]);
        }
    }

    #[test]
    fn a_small_picture_has_no_gizmo() {
        assert!(harness(200.0).query_by_label("Look from top").is_none());
    }

    #[test]
    fn axes_are_named_as_the_scene_stands() {
        assert_eq!(end_of(DVec3::Y, UpAxis::Y), Axis::Top);
        assert_eq!(end_of(DVec3::Z, UpAxis::Y), Axis::Front);
        assert_eq!(end_of(DVec3::Z, UpAxis::Z), Axis::Top);
        assert_eq!(end_of(DVec3::Y, UpAxis::Z), Axis::Back);
        assert_eq!(end_of(DVec3::NEG_X, UpAxis::Z), Axis::Left);
    }

    #[test]
    fn a_light_is_where_it_comes_from() {
        let mut camera = Camera::default();
        camera.orbit_turntable(std::f64::consts::FRAC_PI_2, 0.0);
        let mut light = Light {
            kind: LightKind::Directional { towards: DVec3::X },
            space: LightSpace::World,
            colour: Vec3::ONE,
            enabled: true,
        };
        // The eye has gone to +x, so a light from there is behind it.
        let place = light_place(&light, &camera).expect("a direction");
        assert!(place.distance(DVec3::Z) < 1e-9, "{place}");
        light.space = LightSpace::View;
        let place = light_place(&light, &camera).expect("a direction");
        assert!(place.distance(DVec3::X) < 1e-9, "{place}");
        light.kind = LightKind::Point {
            position: camera.pivot,
        };
        light.space = LightSpace::World;
        assert_eq!(light_place(&light, &camera), None);
    }

    #[test]
    fn weak_lights_are_shown_in_their_full_colour() {
        assert_eq!(
            light_colour(Vec3::new(0.01, 0.0, 0.0)),
            Color32::from_rgb(255, 0, 0)
        );
        assert_eq!(light_colour(Vec3::ZERO), Color32::GRAY);
    }
}
