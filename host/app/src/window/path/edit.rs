//! Changes of a path by the user: its times rise whatever is asked for.

use pointstage_engine::stage::SettingValue;
use pointstage_scene::{Easing, ViewRecord};

use crate::camera_path::{MOST_SECS, MotionPath, SettingTrack, TrackKey, ViewKey};
use crate::window::views::ListWay;

/// How long after the last view a new one comes, seconds.
const STEP_SECS: f64 = 2.0;

/// The least time between two keys, seconds.
const LEAST_SECS: f64 = 0.01;

impl MotionPath {
    /// Puts a view behind the last one.
    pub(crate) fn append(&mut self, name: &str, view: ViewRecord) {
        let last = self.keys.last();
        let time = last.map_or(0.0, |key| key.time + STEP_SECS);
        if time <= MOST_SECS {
            let name = self.name_or_number(name);
            self.keys.push(ViewKey {
                time,
                name,
                easing: Easing::Smooth,
                view,
            });
        }
    }

    /// Puts a view at a time, in the place of the one that is there.
    pub(crate) fn set_view_at(&mut self, time: f64, view: ViewRecord) {
        let time = time.clamp(0.0, MOST_SECS);
        let near = |key: &&mut ViewKey| (key.time - time).abs() < LEAST_SECS;
        if let Some(key) = self.keys.iter_mut().find(near) {
            key.view = view;
            return;
        }
        let name = self.name_or_number("");
        let at = self.keys.partition_point(|key| key.time < time);
        self.keys.insert(
            at,
            ViewKey {
                time,
                name,
                easing: Easing::Smooth,
                view,
            },
        );
    }

    /// Lets a view be reached at another time, between those of its neighbours.
    pub(crate) fn set_time(&mut self, index: usize, time: f64) {
        let times: Vec<f64> = self.keys.iter().map(|key| key.time).collect();
        if let Some(key) = self.keys.get_mut(index) {
            key.time = between_neighbours(&times, index, time);
        }
    }

    /// Lets a view and its neighbour change places.
    pub(crate) fn shift(&mut self, index: usize, way: ListWay) {
        let other = match way {
            ListWay::Up => index.checked_sub(1),
            ListWay::Down => index.checked_add(1),
        };
        let Some(other) = other.filter(|&other| other.max(index) < self.keys.len()) else {
            return;
        };
        self.keys.swap(index, other);
        let (time, other_time) = (self.keys[index].time, self.keys[other].time);
        (self.keys[index].time, self.keys[other].time) = (other_time, time);
    }

    /// Gives a setting a value at a time.
    pub(crate) fn set_value(&mut self, owner: &str, setting: &str, time: f64, value: SettingValue) {
        let time = time.clamp(0.0, MOST_SECS);
        let is_meant = |track: &SettingTrack| track.owner == owner && track.setting == setting;
        let key = TrackKey { time, value };
        let Some(track) = self.tracks.iter_mut().find(|track| is_meant(track)) else {
            self.tracks.push(SettingTrack {
                owner: owner.to_owned(),
                setting: setting.to_owned(),
                keys: vec![key],
            });
            return;
        };
        let near = |other: &&mut TrackKey| (other.time - time).abs() < LEAST_SECS;
        if let Some(there) = track.keys.iter_mut().find(near) {
            there.value = key.value;
            return;
        }
        let at = track.keys.partition_point(|other| other.time < time);
        track.keys.insert(at, key);
    }

    /// Lets a value of a track be reached at another time, between those of its neighbours.
    pub(crate) fn set_value_time(&mut self, track: usize, index: usize, time: f64) {
        let Some(track) = self.tracks.get_mut(track) else {
            return;
        };
        let times: Vec<f64> = track.keys.iter().map(|key| key.time).collect();
        if let Some(key) = track.keys.get_mut(index) {
            key.time = between_neighbours(&times, index, time);
        }
    }

    /// Takes a value out of a track, and the track with its last one.
    pub(crate) fn delete_value(&mut self, track: usize, index: usize) {
        let Some(keys) = self.tracks.get_mut(track).map(|track| &mut track.keys) else {
            return;
        };
        if index < keys.len() {
            keys.remove(index);
        }
        if keys.is_empty() {
            self.tracks.remove(track);
        }
    }

    fn name_or_number(&self, name: &str) -> String {
        if !name.is_empty() {
            return name.to_owned();
        }
        let numbers = (1..).map(|number: usize| format!("View {number}"));
        let is_free = |name: &String| self.keys.iter().all(|key| key.name != *name);
        let mut names = numbers.take(self.keys.len() + 1);
        names.find(is_free).unwrap_or_default()
    }
}

/// `time`, or the nearest one that lies between those before and behind.
fn between_neighbours(times: &[f64], index: usize, time: f64) -> f64 {
    let before = index.checked_sub(1).and_then(|before| times.get(before));
    let least = before.map_or(0.0, |before| before + LEAST_SECS);
    let most = times
        .get(index + 1)
        .map_or(MOST_SECS, |after| after - LEAST_SECS);
    let own = times.get(index).copied().unwrap_or_default();
    // Two that are nearer to each other than that stay where they are.
    if time.is_finite() && least <= most {
        time.clamp(least, most)
    } else {
        own
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pointstage_scene::Camera;
    use proptest::prelude::*;

    fn view(width: u32) -> ViewRecord {
        ViewRecord::new(Camera::default(), width, 6)
    }

    fn path(count: u32) -> MotionPath {
        let mut path = MotionPath::default();
        for width in 1..=count {
            path.append("", view(width));
        }
        path
    }

    fn rise(path: &MotionPath) -> bool {
        let rise = |times: Vec<f64>| times.windows(2).all(|pair| pair[0] < pair[1]);
        let tracks = path.tracks.iter();
        let mut tracks = tracks.map(|track| track.keys.iter().map(|key| key.time).collect());
        rise(path.keys.iter().map(|key| key.time).collect()) && tracks.all(rise)
    }

    proptest! {
        #[test]
        fn times_rise_whatever_is_asked_for(
            asked in proptest::collection::vec((0..5usize, 0..6usize, -1.0..12.0f64), 0..30),
        ) {
            let mut path = path(3);
            for (kind, index, time) in asked {
                match kind {
                    0 => path.set_view_at(time, view(9)),
                    1 => path.set_time(index, time),
                    2 => path.shift(index, ListWay::Down),
                    3 => path.set_value("", "size", time, SettingValue::Float(time)),
                    _ => path.set_value_time(0, index, time),
                }
                prop_assert!(rise(&path), "{path:?}");
                let text = toml::to_string(&path).expect("plain values");
                let read: Result<MotionPath, _> = toml::from_str(&text);
                prop_assert_eq!(read.as_ref(), Ok(&path));
            }
        }
    }

    #[test]
    fn views_change_places_and_times_stay() {
        let mut path = path(3);
        path.shift(0, ListWay::Down);
        path.shift(0, ListWay::Up);
        path.shift(2, ListWay::Down);
        let found: Vec<(f64, &str)> = path.keys.iter().map(|key| (key.time, &*key.name)).collect();
        assert_eq!(found, [(0.0, "View 2"), (2.0, "View 1"), (4.0, "View 3")]);
    }

    #[test]
    fn a_view_at_a_time_that_is_taken_is_replaced() {
        let mut path = path(2);
        path.set_view_at(2.0, view(7));
        assert_eq!((path.keys.len(), path.keys[1].view.width), (2, 7));
        path.set_view_at(1.0, view(8));
        let widths: Vec<u32> = path.keys.iter().map(|key| key.view.width).collect();
        assert_eq!(widths, [1, 8, 7]);
    }

    #[test]
    fn a_track_goes_with_its_last_value() {
        let mut path = MotionPath::default();
        path.set_value("a", "size", 1.0, SettingValue::Int(1));
        path.set_value("a", "size", 0.0, SettingValue::Int(2));
        assert_eq!(path.tracks[0].keys[0].value, SettingValue::Int(2));
        path.delete_value(0, 0);
        path.delete_value(0, 7);
        assert_eq!(path.tracks[0].keys.len(), 1);
        path.delete_value(0, 0);
        assert!(path.is_empty());
    }
}
