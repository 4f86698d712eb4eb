//! Paths of every kind, for property tests, and scenes to turn around.

use glam::DVec3;
use pointstage_engine::stage::SettingValue;
use pointstage_scene::{Block, Easing, Geometry, Object, Origins, Scene};
use proptest::prelude::*;

use super::{Around, MotionPath, SettingTrack, TrackKey, Turntable, ViewKey};
use crate::session_file::testing::{any_view, number};

/// A scene of points at these places.
pub(crate) fn scene_of_points(places: impl IntoIterator<Item = [f32; 3]>) -> Scene {
    let slots = places.into_iter().map(|[x, y, z]| [x, y, z, 0.1]);
    let block = Block {
        position_radius: slots.collect(),
        ..Block::default()
    };
    let geometry = Geometry::new(vec![block], None, Origins::default());
    let mut scene = Scene::new();
    scene.add(Object::new("points", DVec3::ZERO, geometry));
    scene
}

/// Times that rise.
fn times(most: usize) -> impl Strategy<Value = Vec<f64>> {
    proptest::collection::vec(0.001..20.0f64, 0..most).prop_map(|steps| {
        let mut time = -0.001;
        let times = steps.into_iter().map(|step| {
            time += step;
            time.max(0.0)
        });
        times.collect()
    })
}

fn any_track() -> impl Strategy<Value = SettingTrack> {
    let value = prop_oneof![
        any::<bool>().prop_map(SettingValue::Bool),
        any::<i64>().prop_map(SettingValue::Int),
        number().prop_map(SettingValue::Float),
        "\\PC{0,9}".prop_map(SettingValue::Choice),
    ];
    let times = times(4).prop_filter("at least one", |times| !times.is_empty());
    ("[a-z.]{0,9}", "[a-z_]{1,6}", times, value).prop_map(|(owner, setting, times, value)| {
        let keys = times.into_iter().map(|time| TrackKey {
            time,
            value: value.clone(),
        });
        SettingTrack {
            owner,
            setting,
            keys: keys.collect(),
        }
    })
}

fn any_turntable() -> impl Strategy<Value = Turntable> {
    let axis = proptest::option::of([0.1..9.0f64, -9.0..9.0f64, -9.0..9.0f64]);
    (0.001..900.0f64, -1e4..1e4f64, any::<bool>(), axis).prop_map(
        |(seconds, degrees, is_around_pivot, axis)| Turntable {
            seconds,
            degrees,
            around: if is_around_pivot {
                Around::Pivot
            } else {
                Around::Scene
            },
            axis: axis.map(Into::into),
        },
    )
}

/// Any path.
pub(crate) fn any_path() -> impl Strategy<Value = MotionPath> {
    let view = ("\\PC{0,9}", any::<bool>(), any_view());
    (
        times(4),
        proptest::collection::vec(view, 4),
        proptest::collection::vec(any_track(), 0..3),
        proptest::option::of(any_turntable()),
        proptest::option::of(0.001..900.0f64),
        0.01..1000.0f64,
        any::<bool>(),
    )
        .prop_map(
            |(times, views, tracks, turntable, duration, fps, loops)| MotionPath {
                duration,
                fps,
                loops,
                turntable,
                keys: times
                    .into_iter()
                    .zip(views)
                    .map(|(time, (name, is_linear, view))| ViewKey {
                        time,
                        name,
                        easing: if is_linear {
                            Easing::Linear
                        } else {
                            Easing::Smooth
                        },
                        view,
                    })
                    .collect(),
                tracks,
                ..MotionPath::default()
            },
        )
}
