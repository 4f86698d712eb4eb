//! The way of the eye.

use std::convert::Infallible;
use std::f64::consts::TAU;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use anyhow::Context as _;
use pointstage_scene::{Camera, Scene, ViewRecord, orbit_cameras};

use crate::cli::{Failure, Outcome};

/// Where the way comes from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum PathSource {
    /// Once around the scene.
    Orbit,
    /// Through or around the views of a file.
    File(PathBuf),
}

impl FromStr for PathSource {
    type Err = Infallible;

    fn from_str(text: &str) -> Result<Self, Infallible> {
        Ok(match text {
            "orbit" => Self::Orbit,
            file => Self::File(file.into()),
        })
    }
}

impl PathSource {
    /// So many cameras along the way, evenly.
    pub(super) fn cameras(
        &self,
        scene: &Scene,
        [width, height]: [u32; 2],
        count: u32,
    ) -> Outcome<Vec<Camera>> {
        let aspect = f64::from(width) / f64::from(height);
        match self {
            Self::Orbit => Ok(orbit_cameras(&scene.bounds_world(), count as usize, aspect)),
            Self::File(path) => Ok(along(&read(path)?, count)),
        }
    }

    /// As the command line has it.
    pub(super) fn text(&self) -> String {
        match self {
            Self::Orbit => "orbit".to_owned(),
            Self::File(path) => path.to_string_lossy().into_owned(),
        }
    }
}

/// The views of a file: one record, or a list of them.
fn read(path: &Path) -> Outcome<Vec<Camera>> {
    let text = std::fs::read_to_string(path).with_context(|| {
        format!(
            "{}: the path cannot be read; expected 'orbit', or a file with view records",
            path.display()
        )
    })?;
    let records = if text.trim_start().starts_with('[') {
        serde_json::from_str::<Vec<ViewRecord>>(&text)
            .map_err(|error| anyhow::anyhow!("not a list of view records: {error}"))
            .and_then(|records| {
                let checked = records.into_iter().map(ViewRecord::checked);
                Ok(checked.collect::<Result<Vec<_>, _>>()?)
            })
    } else {
        ViewRecord::from_json(&text)
            .map(|record| vec![record])
            .map_err(Into::into)
    };
    let records = records.with_context(|| path.display().to_string())?;
    if records.is_empty() {
        return Err(Failure::Failed(anyhow::anyhow!(
            "{}: the list has no views; expected at least one",
            path.display()
        )));
    }
    Ok(records.iter().map(ViewRecord::camera).collect())
}

/// Around the pivot of one view, or from the first view of several to the last.
fn along(views: &[Camera], count: u32) -> Vec<Camera> {
    let at = |index: u32| {
        if let [view] = views {
            let mut camera = *view;
            camera.orbit_turntable(TAU * f64::from(index) / f64::from(count), 0.0);
            return camera;
        }
        // At the last view with the last picture.
        let part = f64::from(index) / f64::from(count.saturating_sub(1).max(1));
        let place = part * (views.len() - 1) as f64;
        let before = (place as usize).min(views.len() - 2);
        views[before].between(&views[before + 1], place - before as f64)
    };
    (0..count).map(at).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_view_is_turned_around_and_several_are_flown_through() {
        let first = Camera::default();
        let mut last = first;
        last.orbit_turntable(1.0, 0.2);
        let around = along(&[first], 4);
        assert_eq!(around.len(), 4);
        assert!(around[0].eye.distance(first.eye) < 1e-9);
        let across = first.pivot - (first.eye - first.pivot);
        assert!(around[2].eye.distance(across).abs() < 2.0 * first.eye.distance(first.pivot));
        let flown = along(&[first, last, first], 5);
        for (index, view) in [(0, first), (2, last), (4, first)] {
            assert!(flown[index].eye.distance(view.eye) < 1e-9, "{index}");
        }
        assert_eq!(along(&[first, last], 1).len(), 1);
    }

    #[test]
    fn what_is_no_path_is_named() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        for (text, expected) in [
            ("[]", "no views"),
            ("[1]", "not a list of view records"),
            ("{}", "not a view record"),
        ] {
            let path = folder.path().join("way.json");
            std::fs::write(&path, text).expect("written");
            match read(&path) {
                Err(Failure::Failed(error)) => {
                    let said = format!("{error:#}");
                    assert!(
                        said.contains("way.json") && said.contains(expected),
                        "{said}"
                    );
                }
                other => panic!("{text}: {other:?}"),
            }
        }
    }
}
