//! Paths in files: a path of its own, one in a session, or views as JSON.

use std::path::{Path, PathBuf};

use pointstage_scene::{Easing, ViewRecord};
use serde::Deserialize;
use toml::Spanned;

use super::{Around, MotionPath, TrackError, Turntable, ViewKey};
use crate::session_file::{SessionFile, SessionFileError};
use crate::toml_form::{self, Flaw};

/// How long the turn around a single view takes, and how far apart several views are, seconds.
const TURN_SECS: f64 = 4.0;
const STEP_SECS: f64 = 1.0;

/// A path, and where it comes from.
#[derive(Clone, Debug, Default)]
pub(crate) struct LoadedPath {
    /// The path.
    pub(crate) path: MotionPath,
    /// Its file; none for one that the command line describes.
    file: Option<PathBuf>,
    /// Where its tracks stand, as far as that is known.
    lines: Vec<TrackLines>,
}

/// The lines of one track, from 1.
#[derive(Clone, Debug, PartialEq, Eq)]
struct TrackLines {
    setting: usize,
    values: Vec<usize>,
}

/// A file that holds no path.
#[derive(Debug, thiserror::Error)]
pub(crate) enum PathFileError {
    /// It cannot be read.
    #[error("{}: the path cannot be read: {source}; expected a path (.toml), a session with one, or views (JSON)", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        #[source]
        source: std::io::Error,
    },
    /// It says something that cannot be.
    #[error("{}, {flaw}; correct that place", path.display())]
    Flaw {
        /// The file.
        path: PathBuf,
        /// What and where.
        flaw: Flaw,
    },
    /// It is a path along which nothing moves.
    #[error("{}: the path is empty; expected [[keys]], a [turntable], or [[tracks]]", path.display())]
    Empty {
        /// The file.
        path: PathBuf,
    },
    /// It is a session without a path.
    #[error("{}: the session has no path; make one in the window (Window, Camera path), or name another file", path.display())]
    NoPath {
        /// The file.
        path: PathBuf,
    },
    /// It holds no views.
    #[error("{}: {message}", path.display())]
    Views {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        message: String,
    },
    /// It is a session with a flaw.
    #[error(transparent)]
    Session(#[from] SessionFileError),
}

impl LoadedPath {
    /// A path that no file holds.
    pub(crate) fn described(path: MotionPath) -> Self {
        Self {
            path,
            ..Self::default()
        }
    }

    /// The path of a session that has been read.
    ///
    /// # Errors
    /// It has none.
    pub(crate) fn of_session(session: &SessionFile, file: &Path) -> Result<Self, PathFileError> {
        let path = session.path.clone().filter(|path| !path.is_empty());
        let path = path.ok_or_else(|| PathFileError::NoPath {
            path: file.to_path_buf(),
        })?;
        // Of a picture there are no lines to tell.
        let text = toml_form::read_small(file).ok();
        let text = text
            .as_deref()
            .and_then(|bytes| std::str::from_utf8(bytes).ok());
        Ok(Self {
            path,
            file: Some(file.to_path_buf()),
            lines: text.map_or_else(Vec::new, lines_of_session),
        })
    }

    /// Reads a file: TOML with a path or a session, a picture with a session in it, or views as JSON.
    ///
    /// # Errors
    /// It cannot be read, says something that cannot be, or nothing moves along it.
    pub(crate) fn read(file: &Path) -> Result<Self, PathFileError> {
        let extension = file
            .extension()
            .map(|extension| extension.to_string_lossy().to_lowercase());
        if matches!(extension.as_deref(), Some("png" | "exr")) {
            return Self::of_session(&SessionFile::read(file)?, file);
        }
        let at = |path: &Path| path.to_path_buf();
        let bytes = toml_form::read_small(file).map_err(|source| PathFileError::Read {
            path: at(file),
            source,
        })?;
        let flawed = |flaw| PathFileError::Flaw {
            path: at(file),
            flaw,
        };
        let text = Flaw::text_of(&bytes).map_err(flawed)?;
        if extension.as_deref() != Some("toml") {
            let path = views(text).map_err(|message| PathFileError::Views {
                path: at(file),
                message,
            })?;
            return Ok(Self {
                path,
                file: Some(at(file)),
                lines: Vec::new(),
            });
        }
        let table: toml::Table =
            toml::from_str(text).map_err(|error| flawed(Flaw::of(&error, text)))?;
        // What a session cannot lack, and a path does not have.
        if table.contains_key("view") {
            return Self::of_session(&SessionFile::read(file)?, file);
        }
        let path: MotionPath =
            toml::from_str(text).map_err(|error| flawed(Flaw::of(&error, text)))?;
        if path.is_empty() {
            return Err(PathFileError::Empty { path: at(file) });
        }
        Ok(Self {
            path,
            file: Some(at(file)),
            lines: lines_of_path(text),
        })
    }

    /// The file and the line of a track that does not fit, as far as they are known, then the error.
    pub(crate) fn tell(&self, error: &TrackError) -> String {
        let lines = self.lines.get(error.track);
        let line = lines.and_then(|lines| match error.key {
            Some(key) => lines.values.get(key).copied(),
            None => Some(lines.setting),
        });
        match (&self.file, line) {
            (Some(file), Some(line)) => format!("{}, line {line}: {error}", file.display()),
            (Some(file), None) => format!("{}: {error}", file.display()),
            (None, _) => error.to_string(),
        }
    }

    /// How the path is called in messages.
    pub(crate) fn name(&self) -> String {
        self.file
            .as_ref()
            .map_or_else(|| "the path".to_owned(), |file| file.display().to_string())
    }
}

/// One view, to turn around; or several, to fly through at an even pace.
fn views(text: &str) -> Result<MotionPath, String> {
    let is_list = text.trim_start().starts_with('[');
    let records: Vec<ViewRecord> = if is_list {
        let records: Vec<ViewRecord> = serde_json::from_str(text)
            .map_err(|error| format!("not a list of view records: {error}"))?;
        let checked = records.into_iter().enumerate().map(|(index, record)| {
            record
                .checked()
                .map_err(|error| format!("view {}: {error}", index + 1))
        });
        checked.collect::<Result<_, _>>()?
    } else {
        vec![ViewRecord::from_json(text).map_err(|error| error.to_string())?]
    };
    let turntable = match records.as_slice() {
        [] => return Err("the list has no views; expected at least one".to_owned()),
        [view] => Some(Turntable {
            around: Around::Pivot,
            axis: Some(view.up),
            ..Turntable::new(TURN_SECS, 360.0)
        }),
        _ => None,
    };
    let keys = records
        .into_iter()
        .enumerate()
        .map(|(index, view)| ViewKey {
            time: STEP_SECS * index as f64,
            name: String::new(),
            easing: Easing::Linear,
            view,
        });
    Ok(MotionPath {
        turntable,
        keys: keys.collect(),
        ..MotionPath::default()
    })
}

#[derive(Deserialize)]
struct SessionPlaces {
    path: PathPlaces,
}

#[derive(Deserialize)]
struct PathPlaces {
    #[serde(default)]
    tracks: Vec<TrackPlaces>,
}

#[derive(Deserialize)]
struct TrackPlaces {
    setting: Spanned<String>,
    keys: Vec<KeyPlaces>,
}

#[derive(Deserialize)]
struct KeyPlaces {
    value: Spanned<toml::Value>,
}

fn lines_of_path(text: &str) -> Vec<TrackLines> {
    let places = toml::from_str::<PathPlaces>(text);
    places.map_or_else(|_| Vec::new(), |places| places.lines(text))
}

fn lines_of_session(text: &str) -> Vec<TrackLines> {
    let places = toml::from_str::<SessionPlaces>(text);
    places.map_or_else(|_| Vec::new(), |session| session.path.lines(text))
}

impl PathPlaces {
    fn lines(&self, text: &str) -> Vec<TrackLines> {
        let line = |byte: usize| text[..byte.min(text.len())].matches('\n').count() + 1;
        let tracks = self.tracks.iter().map(|track| TrackLines {
            setting: line(track.setting.span().start),
            values: track
                .keys
                .iter()
                .map(|key| line(key.value.span().start))
                .collect(),
        });
        tracks.collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::scene_of_points;
    use super::*;
    use pointstage_engine::stage::SettingValue;
    use pointstage_plugin_api::settings_schema::ValueError;
    use pointstage_scene::Camera;

    /// Writes a file and reads it as a path.
    fn read(name: &str, text: &str) -> Result<LoadedPath, String> {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let file = folder.path().join(name);
        std::fs::write(&file, text).expect("written");
        LoadedPath::read(&file).map_err(|error| error.to_string())
    }

    const FILM: &str = "format = 1
fps = 25
loop = true

[turntable]
seconds = 2

[[tracks]]
setting = \"size\"
keys = [
  { time = 0, value = 1 },
  { time = 2, value = 400.5 },
]
";

    #[test]
    fn a_path_is_read_with_defaults_for_what_it_leaves_out() {
        let loaded = read("a.toml", FILM).expect("right");
        let path = &loaded.path;
        assert_eq!((path.fps, path.loops, path.duration_s()), (25.0, true, 2.0));
        assert_eq!(path.turntable, Some(Turntable::new(2.0, 360.0)));
        assert_eq!(path.tracks[0].keys[1].value, SettingValue::Float(400.5));
        assert!(path.keys.is_empty());
    }

    #[test]
    fn a_track_that_does_not_fit_is_told_by_file_and_line() {
        let loaded = read("a.toml", FILM).expect("right");
        let error = |key| TrackError {
            track: 0,
            setting: "size".to_owned(),
            key,
            source: ValueError::Action {
                id: "size".to_owned(),
            },
        };
        for (key, line) in [(None, 9), (Some(0), 11), (Some(1), 12)] {
            let told = loaded.tell(&error(key));
            assert!(
                told.contains(&format!("a.toml, line {line}: track 1 ('size')")),
                "{told}"
            );
        }
    }

    #[test]
    fn a_flaw_is_told_by_file_and_line() {
        for (from, to, expected) in [
            (
                "fps = 25",
                "fps = 0",
                "line 2, column 7: expected pictures a second from 0.01 to 1000, found 0",
            ),
            (
                "seconds = 2",
                "seconds = -1",
                "line 6, column 11: expected seconds above 0",
            ),
            (
                "format = 1",
                "format = 7",
                "line 1, column 10: expected a path of format 1",
            ),
            (
                "time = 2",
                "time = 0",
                "value 2 is at 0 s, the one before it at 0 s; expected times that rise",
            ),
            ("setting = \"size\"", "", "missing field `setting`"),
            ("loop = true", "loop = maybe", "line 3"),
        ] {
            let error = read("a.toml", &FILM.replacen(from, to, 1)).expect_err(expected);
            assert!(
                error.contains("a.toml, ") && error.contains(expected),
                "{error}"
            );
        }
        let error = read("a.toml", "format = 1\n").expect_err("nothing moves");
        assert!(error.contains("a.toml: the path is empty"), "{error}");
    }

    #[test]
    fn what_is_no_list_of_views_is_named() {
        for (text, expected) in [
            ("[]", "no views"),
            ("[1]", "not a list of view records"),
            ("{}", "not a view record"),
        ] {
            let error = read("way.json", text).expect_err(expected);
            assert!(
                error.contains("way.json") && error.contains(expected),
                "{error}"
            );
        }
    }

    #[test]
    fn one_view_is_turned_around_and_several_are_flown_through() {
        let first = Camera::default();
        let mut last = first;
        last.orbit_turntable(1.0, 0.2);
        let json = |camera: Camera| ViewRecord::new(camera, 8, 6).to_json();
        let scene = scene_of_points([[2.0; 3], [3.0; 3]]);
        let way = |text: &str| {
            let path = read("way.json", text).expect("views").path;
            (
                path.duration_s(),
                path.way(Camera::default(), &scene).expect("a way"),
            )
        };
        let (secs, around) = way(&json(first));
        assert_eq!((around.at(0.0), around.at(secs)), (first, first));
        let across = first.pivot - (first.eye - first.pivot);
        assert!(
            around.at(0.5 * secs).eye.distance(across) < 1e-9,
            "around its pivot"
        );
        let (secs, flown) = way(&format!("[{},{},{}]", json(first), json(last), json(first)));
        assert_eq!(
            (flown.at(0.0), flown.at(0.5 * secs), flown.at(secs)),
            (first, last, first)
        );
        assert_eq!(flown.at(0.25 * secs), first.between(&last, 0.5));
    }
}
