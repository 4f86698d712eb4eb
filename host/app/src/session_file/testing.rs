//! Values of every kind that session files and settings hold, for property tests.

use std::collections::BTreeMap;

use pointstage_engine::stage::{Background, SettingValue, SettingValues, Show};
use pointstage_scene::{
    Camera, Headlight, Light, LightKind, LightSpace, Lights, Material, Projection, ViewRecord,
};
use proptest::prelude::*;

use super::Renderers;
use crate::toml_form::{Look, StoredView};

/// Any number that is finite.
pub(crate) fn number() -> impl Strategy<Value = f64> {
    prop_oneof![-1e7..1e7f64, -1e-300..1e-300f64, Just(-0.0), Just(f64::MAX)]
}

fn channel() -> impl Strategy<Value = f32> {
    0.0..=1.0f32
}

fn colour() -> impl Strategy<Value = [f32; 3]> {
    [channel(), channel(), channel()]
}

/// Any look.
pub(crate) fn any_look() -> impl Strategy<Value = Look> {
    let background = prop_oneof![
        Just(Background::Transparent),
        colour().prop_map(Background::Solid),
        (colour(), colour()).prop_map(|(top, bottom)| Background::Gradient(top, bottom)),
    ];
    let show = prop_oneof![
        Just(Show::Colours),
        "[a-z]{1,8}\\.[a-z\"\\\\]{1,8}".prop_map(Show::Target)
    ];
    (show, background, 1e-30..1e30f32, 0.001..100.0f32).prop_map(
        |(show, background, exposure, radius_scale)| Look {
            show,
            background,
            exposure,
            radius_scale,
        },
    )
}

/// Any view that shows something.
pub(crate) fn any_view() -> impl Strategy<Value = ViewRecord> {
    let projection = prop_oneof![
        (0.01..3.0f64).prop_map(|fov_y_rad| Projection::Perspective { fov_y_rad }),
        (1e-3..1e6f64).prop_map(|height| Projection::Orthographic { height }),
    ];
    let place = || [-1e7..1e7f64, -1e7..1e7f64, -1e7..1e7f64];
    (
        place(),
        place(),
        projection,
        1e-9..1.0f64,
        1u32..4000,
        1u32..4000,
    )
        .prop_map(|(eye, pivot, projection, near, width, height)| {
            let camera = Camera {
                eye: eye.into(),
                pivot: pivot.into(),
                projection,
                near,
                ..Camera::default()
            };
            ViewRecord::new(camera, width, height)
        })
        .prop_filter("a useful view", |view| view.checked().is_ok())
}

/// Any lights.
pub(crate) fn any_lights() -> impl Strategy<Value = Lights> {
    let light = (
        any::<[bool; 3]>(),
        (number(), number(), 1.0..2.0f64),
        colour(),
    );
    let light = light.prop_map(|([is_point, is_world, enabled], (x, y, z), colour)| Light {
        kind: if is_point {
            LightKind::Point {
                position: glam::DVec3::new(x, y, z),
            }
        } else {
            LightKind::Directional {
                towards: glam::DVec3::new(x, y, z)
                    .clamp(glam::DVec3::splat(-1e9), glam::DVec3::splat(1e9)),
            }
        },
        space: if is_world {
            LightSpace::World
        } else {
            LightSpace::View
        },
        colour: colour.into(),
        enabled,
    });
    let headlight = (any::<bool>(), 0.0..9.0f32);
    let headlight = headlight.prop_map(|(enabled, strength)| Headlight { enabled, strength });
    let lights = proptest::collection::vec(light, 0..=4);
    (colour(), lights, headlight).prop_map(|(ambient, lights, headlight)| Lights {
        ambient: ambient.into(),
        lights,
        headlight,
    })
}

/// Any material.
pub(crate) fn any_material() -> impl Strategy<Value = Material> {
    (0.0..9.0f32, 0.0..9.0f32, 0.0..9.0f32, 0.0..1e6f32).prop_map(|(ka, kd, ks, shininess)| {
        Material {
            ka,
            kd,
            ks,
            shininess,
        }
    })
}

/// Values in the kinds that a file tells apart.
pub(crate) fn any_settings() -> impl Strategy<Value = BTreeMap<String, SettingValues>> {
    let value = prop_oneof![
        any::<bool>().prop_map(SettingValue::Bool),
        any::<i64>().prop_map(SettingValue::Int),
        number().prop_map(SettingValue::Float),
        "\\PC{0,12}".prop_map(SettingValue::Choice),
        [number(), number(), number(), number()].prop_map(SettingValue::Colour),
    ];
    let values = proptest::collection::btree_map("[a-z_.]{1,6}", value, 0..4);
    proptest::collection::btree_map("\\PC{1,12}", values, 0..4)
}

/// Any list of views.
pub(crate) fn any_stored_views() -> impl Strategy<Value = Vec<StoredView>> {
    let key = proptest::option::of(0u8..10);
    let thumbnail = proptest::collection::vec(any::<u8>(), 0..40);
    let stored = (key, "\\PC{0,12}", any_view(), thumbnail);
    let stored = stored.prop_map(|(key, name, view, thumbnail)| StoredView {
        key,
        number: None,
        name,
        view,
        thumbnail,
    });
    proptest::collection::vec(stored, 0..4)
}

/// Any choice of renderers.
pub(crate) fn any_renderers() -> impl Strategy<Value = Renderers> {
    let id = || proptest::option::of("[a-z.]{1,12}");
    (id(), id(), id()).prop_map(|(main, preview, structure)| Renderers {
        main,
        preview,
        structure,
    })
}

/// Any names of presets by renderer id.
pub(crate) fn any_active_presets() -> impl Strategy<Value = BTreeMap<String, String>> {
    proptest::collection::btree_map("[a-z.]{1,9}", "\\PC{0,9}", 0..3)
}
