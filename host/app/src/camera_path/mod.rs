//! Camera paths: how the camera, and settings of what draws, change over time.
//!
//! [`MotionPath`] is what a file or a session holds: views at their times, a turntable, and [`tracks`] of settings. A [`Way`]
//! is where its camera is at each time, for one scene and one view to begin with. [`frames`] says which pictures a film of it
//! has, [`mod@file`] reads paths from files, and [`source`] is what a user may write where a command takes a path.

mod file;
mod frames;
mod source;
#[cfg(test)]
pub(crate) mod testing;
mod tracks;

use glam::DVec3;
use pointstage_scene::{Camera, CameraKey, CameraPath, CameraPathError, Easing, Scene, ViewRecord};
use serde::{Deserialize, Deserializer, Serialize};

pub(crate) use file::LoadedPath;
pub(crate) use frames::{DEFAULT_FPS, FPS, FrameTimes, frame_times};
pub(crate) use source::PathSource;
pub(crate) use tracks::{
    Drawer, SettingTrack, Track, TrackError, TrackKey, ValuesAt, resolve, values_at,
};

use crate::toml_form;

/// The format that this program writes and reads.
pub(crate) const FORMAT: u32 = 1;

/// The longest path, seconds: a day.
pub(crate) const MOST_SECS: f64 = 86_400.0;

/// How the camera, and settings of what draws, change over time. Times are seconds from the beginning.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct MotionPath {
    /// Always [`FORMAT`].
    #[serde(deserialize_with = "format")]
    format: u32,
    /// How long it takes; until the last of its parts ends if it is not said.
    #[serde(
        default,
        skip_serializing_if = "Option::is_none",
        deserialize_with = "duration"
    )]
    pub(crate) duration: Option<f64>,
    /// Pictures a second in a film of it.
    #[serde(default = "default_fps", deserialize_with = "fps")]
    pub(crate) fps: f64,
    /// Whether it begins again at its end when it is played.
    #[serde(default, rename = "loop")]
    pub(crate) loops: bool,
    /// Turns the camera around the scene, besides what the views say.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) turntable: Option<Turntable>,
    /// Views, in order.
    #[serde(
        default,
        skip_serializing_if = "Vec::is_empty",
        deserialize_with = "keys"
    )]
    pub(crate) keys: Vec<ViewKey>,
    /// Settings.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(crate) tracks: Vec<SettingTrack>,
}

/// A view at its time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct ViewKey {
    /// When it is reached.
    pub(crate) time: f64,
    /// For people.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub(crate) name: String,
    /// How the camera goes on from it.
    #[serde(default)]
    pub(crate) easing: Easing,
    /// The camera, and a picture's size.
    #[serde(deserialize_with = "toml_form::view")]
    pub(crate) view: ViewRecord,
}

/// A turn around the scene.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Turntable {
    /// How long it takes; it rests then.
    #[serde(deserialize_with = "seconds")]
    pub(crate) seconds: f64,
    /// How far it turns: positive to the eye's right.
    #[serde(default = "whole_turn", deserialize_with = "degrees")]
    pub(crate) degrees: f64,
    /// What it turns around.
    #[serde(default)]
    pub(crate) around: Around,
    /// The axis, world space; the world's axis that is nearest to the view's `up` if none is given.
    #[serde(
        default,
        skip_serializing_if = "Option::is_none",
        deserialize_with = "axis"
    )]
    pub(crate) axis: Option<DVec3>,
}

/// What a turntable turns around.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Around {
    /// The middle of the scene's box.
    #[default]
    Scene,
    /// What the camera looks at.
    Pivot,
}

impl Default for MotionPath {
    fn default() -> Self {
        Self {
            format: FORMAT,
            duration: None,
            fps: DEFAULT_FPS,
            loops: false,
            turntable: None,
            keys: Vec::new(),
            tracks: Vec::new(),
        }
    }
}

impl Turntable {
    /// A turn around the scene.
    pub(crate) fn new(seconds: f64, degrees: f64) -> Self {
        Self {
            seconds,
            degrees,
            around: Around::Scene,
            axis: None,
        }
    }
}

impl MotionPath {
    /// A path that only turns around the scene.
    pub(crate) fn of_turntable(turntable: Turntable) -> Self {
        Self {
            turntable: Some(turntable),
            ..Self::default()
        }
    }

    /// Whether nothing moves along it.
    pub(crate) fn is_empty(&self) -> bool {
        self.turntable.is_none() && self.keys.is_empty() && self.tracks.is_empty()
    }

    /// Whether it has the views, tracks and values of another path, whatever their times and numbers are.
    pub(crate) fn has_parts_of(&self, other: &Self) -> bool {
        let name = |key: &ViewKey| key.name.clone();
        let values =
            |track: &SettingTrack| (track.owner.clone(), track.setting.clone(), track.keys.len());
        self.keys.iter().map(name).eq(other.keys.iter().map(name))
            && self
                .tracks
                .iter()
                .map(values)
                .eq(other.tracks.iter().map(values))
            && self.turntable.is_some() == other.turntable.is_some()
    }

    /// Whether the camera moves along it, not settings alone.
    pub(crate) fn moves_camera(&self) -> bool {
        self.turntable.is_some() || !self.keys.is_empty()
    }

    /// How long it takes, seconds.
    pub(crate) fn duration_s(&self) -> f64 {
        self.duration.unwrap_or_else(|| self.natural_duration_s())
    }

    /// When the last of its parts ends, seconds.
    pub(crate) fn natural_duration_s(&self) -> f64 {
        let keys = self.keys.iter().map(|key| key.time);
        let turntable = self.turntable.iter().map(|turntable| turntable.seconds);
        let tracks = self.tracks.iter().flat_map(|track| &track.keys);
        let tracks = tracks.map(|key| key.time);
        keys.chain(turntable).chain(tracks).fold(0.0, f64::max)
    }

    /// Where the camera is along it. `base` is the view that a path without views begins with. A turntable turns around the
    /// middle of what a picture of the whole shows: points that stray far from all others have no part in it.
    ///
    /// # Errors
    /// Times of the views do not rise.
    pub(crate) fn way(&self, base: Camera, scene: &Scene) -> Result<Way, CameraPathError> {
        let framed = scene.framed_world();
        let keys = self.keys.iter().map(|key| CameraKey {
            time_s: key.time,
            camera: key.view.camera(),
            easing: key.easing,
        });
        let views = if self.keys.is_empty() {
            None
        } else {
            Some(CameraPath::new(keys.collect())?)
        };
        Ok(Way {
            views,
            base,
            turntable: self.turntable,
            centre: (!framed.is_empty()).then(|| framed.centre()),
        })
    }
}

/// Where the camera is at each time.
#[derive(Clone, Debug)]
pub(crate) struct Way {
    views: Option<CameraPath>,
    base: Camera,
    turntable: Option<Turntable>,
    /// The middle of what is framed of the scene; none for an empty one.
    centre: Option<DVec3>,
}

impl Way {
    /// The view at a time, seconds.
    pub(crate) fn at(&self, time: f64) -> Camera {
        let views = self.views.as_ref();
        let camera = views.map_or(self.base, |views| views.at(time));
        let Some(turntable) = self.turntable else {
            return camera;
        };
        let start = views.map_or(self.base, |views| views.at(0.0));
        let axis = turntable.axis.unwrap_or_else(|| nearest_axis(start.up));
        let centre = match turntable.around {
            Around::Scene => self.centre.unwrap_or(camera.pivot),
            Around::Pivot => camera.pivot,
        };
        let part = if turntable.seconds > 0.0 {
            (time / turntable.seconds).clamp(0.0, 1.0)
        } else {
            1.0
        };
        camera.turned_around(centre, axis, turntable.degrees * part)
    }
}

/// The axis of the world that is nearest to a direction.
fn nearest_axis(direction: DVec3) -> DVec3 {
    let size = direction.abs();
    if size.x > size.y && size.x > size.z {
        DVec3::new(1.0_f64.copysign(direction.x), 0.0, 0.0)
    } else if size.z > size.y {
        DVec3::new(0.0, 0.0, 1.0_f64.copysign(direction.z))
    } else {
        DVec3::new(0.0, 1.0_f64.copysign(direction.y), 0.0)
    }
}

fn default_fps() -> f64 {
    DEFAULT_FPS
}

fn whole_turn() -> f64 {
    360.0
}

fn refused<E: serde::de::Error>(expected: &str, found: impl std::fmt::Display) -> E {
    E::custom(format!("expected {expected}, found {found}"))
}

fn format<'de, D: Deserializer<'de>>(deserializer: D) -> Result<u32, D::Error> {
    match u32::deserialize(deserializer)? {
        FORMAT => Ok(FORMAT),
        found => Err(refused(
            &format!("a path of format {FORMAT}, which is what this program reads"),
            format_args!("format {found}; open it with a program that knows it"),
        )),
    }
}

/// A time on the path.
fn time<E: serde::de::Error>(time: f64) -> Result<f64, E> {
    if (0.0..=MOST_SECS).contains(&time) {
        return Ok(time);
    }
    Err(refused(&format!("a time from 0 to {MOST_SECS} s"), time))
}

fn seconds<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    let found = f64::deserialize(deserializer)?;
    if found > 0.0 && found <= MOST_SECS {
        return Ok(found);
    }
    Err(refused(
        &format!("seconds above 0, up to {MOST_SECS}"),
        found,
    ))
}

fn duration<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<f64>, D::Error> {
    seconds(deserializer).map(Some)
}

fn fps<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    let found = f64::deserialize(deserializer)?;
    if FPS.contains(&found) {
        return Ok(found);
    }
    Err(refused(
        &format!("pictures a second from {} to {}", FPS.start(), FPS.end()),
        found,
    ))
}

fn degrees<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    let found = f64::deserialize(deserializer)?;
    if found.is_finite() {
        return Ok(found);
    }
    Err(refused("a finite number of degrees", found))
}

fn axis<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<DVec3>, D::Error> {
    let found = DVec3::deserialize(deserializer)?;
    if found.is_finite() && found.try_normalize().is_some() {
        return Ok(Some(found));
    }
    Err(refused(
        "a direction of three finite numbers, not all 0",
        found,
    ))
}

fn keys<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<ViewKey>, D::Error> {
    let keys = Vec::<ViewKey>::deserialize(deserializer)?;
    check_times(keys.iter().map(|key| key.time), "view")?;
    Ok(keys)
}

/// Refuses times that are none, or that do not rise.
fn check_times<E: serde::de::Error>(times: impl Iterator<Item = f64>, what: &str) -> Result<(), E> {
    let mut before: Option<f64> = None;
    for (index, found) in times.enumerate() {
        let number = index + 1;
        time::<E>(found).map_err(|error| E::custom(format!("{what} {number}: {error}")))?;
        if let Some(before) = before.filter(|before| found <= *before) {
            return Err(E::custom(format!(
                "{what} {number} is at {found} s, the one before it at {before} s; expected times that rise"
            )));
        }
        before = Some(found);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::testing::{any_path, scene_of_points};
    use super::*;
    use proptest::prelude::*;

    /// Two points, around whose middle it is turned.
    fn scene() -> Scene {
        scene_of_points([[-1.0; 3], [1.0, 2.0, 3.0]])
    }

    const CENTRE: DVec3 = DVec3::new(0.0, 0.5, 1.0);

    proptest! {
        #[test]
        fn a_path_comes_back_from_its_text_to_the_last_bit(path in any_path()) {
            let text = toml::to_string(&path).expect("plain values");
            let read: MotionPath = toml::from_str(&text).map_err(|error| TestCaseError::fail(error.to_string()))?;
            prop_assert_eq!(read, path, "{}", text);
        }

        #[test]
        fn a_turntable_returns_to_its_start(seconds in 0.1..100.0f64, turns in 1i32..4) {
            let degrees = 360.0 * f64::from(turns);
            let path = MotionPath::of_turntable(Turntable::new(seconds, degrees));
            let base = Camera::default();
            let way = path.way(base, &scene()).expect("no views");
            prop_assert_eq!(way.at(0.0), base);
            prop_assert_eq!(way.at(path.duration_s()), base);
            prop_assert_eq!(way.at(2.0 * seconds), base);
            let there = way.at(0.3 * seconds);
            prop_assert!((there.eye.distance(CENTRE) - base.eye.distance(CENTRE)).abs() < 1e-9);
        }
    }

    #[test]
    fn half_a_turn_is_on_the_other_side_of_the_scene() {
        let path = MotionPath::of_turntable(Turntable::new(4.0, 180.0));
        let way = path.way(Camera::default(), &scene()).expect("no views");
        let (centre, eye) = (CENTRE, Camera::default().eye);
        let across = DVec3::new(2.0 * centre.x - eye.x, eye.y, 2.0 * centre.z - eye.z);
        assert!(way.at(4.0).eye.distance(across) < 1e-9, "{:?}", way.at(4.0));
        assert_eq!(way.at(4.0).up, DVec3::Y);
        let quarter = way.at(2.0).eye - centre;
        assert!(quarter.x > 0.0, "it begins to the right: {quarter}");
    }

    #[test]
    fn points_that_stray_do_not_move_what_is_turned_around() {
        let spiral = |count: u16| {
            (0..count).map(|number| {
                let turn = 0.1 * f32::from(number);
                [turn.cos(), 0.001 * f32::from(number), turn.sin()]
            })
        };
        let path = MotionPath::of_turntable(Turntable::new(4.0, 360.0));
        let way = |scene: &Scene| path.way(Camera::default(), scene).expect("no views");
        let clean = way(&scene_of_points(spiral(2000)));
        let strayed = scene_of_points(spiral(2000).chain([[1e5, 0.0, -3e4]]));
        assert!(
            strayed.bounds_world().centre().x > 1e4,
            "the box reaches there"
        );
        for time in [0.0, 1.0, 3.0] {
            assert_eq!(way(&strayed).at(time), clean.at(time), "{time} s");
        }
    }

    #[test]
    fn the_axis_is_the_nearest_one_of_the_world() {
        for (up, expected) in [
            (DVec3::Y, DVec3::Y),
            (DVec3::new(0.1, 0.2, -0.9), -DVec3::Z),
            (DVec3::new(-3.0, 2.0, 1.0), -DVec3::X),
        ] {
            assert_eq!(nearest_axis(up), expected);
        }
    }

    #[test]
    fn it_takes_as_long_as_its_longest_part() {
        let mut path = MotionPath::of_turntable(Turntable::new(4.0, 360.0));
        assert_eq!(path.duration_s(), 4.0);
        path.tracks.push(SettingTrack {
            owner: String::new(),
            setting: "size".to_owned(),
            keys: vec![TrackKey {
                time: 6.0,
                value: pointstage_engine::stage::SettingValue::Int(1),
            }],
        });
        assert_eq!(path.duration_s(), 6.0);
        path.duration = Some(1.5);
        assert_eq!((path.duration_s(), path.natural_duration_s()), (1.5, 6.0));
    }
}
