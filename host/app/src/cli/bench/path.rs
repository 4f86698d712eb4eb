//! The way of the eye.

use pointstage_scene::{Camera, Scene, orbit_cameras};

use crate::camera_path::{LoadedPath, MotionPath, PathSource};
use crate::cli::{Failure, Outcome};

/// `count` cameras along the way, evenly.
pub(super) fn cameras(
    source: &PathSource,
    scene: &Scene,
    [width, height]: [u32; 2],
    count: u32,
) -> Outcome<Vec<Camera>> {
    let aspect = f64::from(width) / f64::from(height);
    let ring = |views: u32| orbit_cameras(&scene.framed_world(), views as usize, aspect);
    let path = match source {
        PathSource::Orbit => return Ok(ring(count)),
        PathSource::OrbitOf(views) => {
            let places = ring(*views);
            return Ok(places.into_iter().cycle().take(count as usize).collect());
        }
        PathSource::Turntable(turntable) => MotionPath::of_turntable(*turntable),
        PathSource::Session => {
            return Err(Failure::usage(
                "--path session: bench takes no session; name its FILE",
            ));
        }
        PathSource::File(file) => {
            let loaded = LoadedPath::read(file)?;
            if !loaded.path.tracks.is_empty() {
                eprintln!(
                    "warning: {}: all pictures are drawn with the same settings, so the path's tracks are left out",
                    loaded.name()
                );
            }
            loaded.path
        }
    };
    let base = ring(1).first().copied().unwrap_or_default();
    let way = path.way(base, scene)?;
    Ok(along(&path, |time| way.at(time), count))
}

/// Evenly over the path's time. At its end with the last picture, unless it ends where it began.
fn along(path: &MotionPath, at: impl Fn(f64) -> Camera, count: u32) -> Vec<Camera> {
    let end = path.duration_s();
    let turns_round = path.keys.len() < 2 && at(0.0) == at(end);
    let steps = if turns_round {
        count
    } else {
        count.saturating_sub(1)
    };
    let time = |index: u32| end * f64::from(index) / f64::from(steps.max(1));
    (0..count).map(|index| at(time(index))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera_path::Turntable;
    use pointstage_scene::ViewRecord;

    fn cameras_of(source: &str, count: u32) -> Outcome<Vec<Camera>> {
        cameras(&source.parse().expect(source), &Scene::new(), [8, 6], count)
    }

    #[test]
    fn one_view_is_turned_around_and_several_are_flown_through() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let file = folder.path().join("way.json");
        let along = |text: String, count| {
            std::fs::write(&file, text).expect("written");
            cameras_of(&file.display().to_string(), count).expect("views")
        };
        let first = Camera::default();
        let mut last = first;
        last.orbit_turntable(1.0, 0.2);
        let json = |camera: Camera| ViewRecord::new(camera, 8, 6).to_json();
        let around = along(json(first), 4);
        assert_eq!((around.len(), around[0]), (4, first));
        let across = first.pivot - (first.eye - first.pivot);
        assert!(around[2].eye.distance(across) < 1e-9);
        let list = format!("[{},{},{}]", json(first), json(last), json(first));
        let flown = along(list, 5);
        for (index, view) in [(0, first), (2, last), (4, first)] {
            assert!(flown[index].eye.distance(view.eye) < 1e-9, "{index}");
        }
        assert_eq!(
            along(format!("[{},{}]", json(first), json(last)), 1).len(),
            1
        );
    }

    #[test]
    fn turns_around_the_scene_are_even() {
        let four = cameras_of("orbit:4", 6).expect("a ring");
        assert_eq!((four.len(), four[4]), (6, four[0]));
        let turned = cameras_of("turntable:3", 4).expect("a turn");
        assert_eq!(turned[0], four[0]);
        assert!(turned[1].eye.distance(four[1].eye) < 1e-9, "a quarter");
        let half = MotionPath::of_turntable(Turntable::new(2.0, 180.0));
        let way = half.way(four[0], &Scene::new()).expect("a way");
        let ends = along(&half, |time| way.at(time), 3);
        assert!(ends[2].eye.distance(four[2].eye) < 1e-9, "it shows its end");
        assert!(cameras_of("session", 3).is_err());
    }
}
