//! What a user may write where a command takes views: a stored name, a FILE, or `orbit:N`.

use std::path::{Path, PathBuf};

use super::{ViewRecord, ViewRecordError, orbit_cameras};
use crate::bounds::Bounds;

/// The most views that `orbit:N` may ask for.
const MAX_ORBIT_VIEWS: usize = 10_000;

/// Where views come from.
#[derive(Clone, Debug, PartialEq)]
pub enum ViewSource {
    /// One stored under this name.
    Stored(String),
    /// One in this file, JSON.
    File(PathBuf),
    /// This many around the scene.
    Orbit(usize),
}

/// Text that names no views, or views that cannot be had.
#[derive(Debug, thiserror::Error)]
pub enum ViewSourceError {
    /// The text is empty.
    #[error("no view given; expected a stored name, a FILE, or orbit:N")]
    Empty,
    /// What follows `orbit:` is no count.
    #[error("'{text}': expected orbit:N with N from 1 to {MAX_ORBIT_VIEWS}, such as orbit:8")]
    OrbitCount {
        /// What was given.
        text: String,
    },
    /// No view is stored under the name.
    #[error("no view is stored under '{name}', and no file is called so; expected a FILE, orbit:N, or a stored name ({})", if stored.is_empty() { "none".to_owned() } else { stored.join(", ") })]
    NotStored {
        /// The name.
        name: String,
        /// The names that there are.
        stored: Vec<String>,
    },
    /// The view's file cannot be read.
    #[error("{}", record_text(path, source))]
    Record {
        /// The file.
        path: PathBuf,
        /// Why.
        source: ViewRecordError,
    },
}

/// The record's error with its file, named once.
fn record_text(path: &Path, source: &ViewRecordError) -> String {
    match source {
        ViewRecordError::Io { .. } => source.to_string(),
        other => format!("{}: {other}", path.display()),
    }
}

impl ViewSource {
    /// Reads `text`: `orbit:N` first, then one of the `stored` names, else a file's path.
    ///
    /// A word without a dot or a separator that is neither stored nor an existing file is taken for a name, so that a
    /// misspelt name gets the list of names and not a missing file.
    ///
    /// # Errors
    /// Empty text; `orbit:` without a count from 1 to 10,000.
    pub fn parse<'a>(
        text: &str,
        stored: impl IntoIterator<Item = &'a str>,
    ) -> Result<Self, ViewSourceError> {
        let text = text.trim();
        if text.is_empty() {
            return Err(ViewSourceError::Empty);
        }
        if let Some(count) = text.strip_prefix("orbit:") {
            return match count.parse() {
                Ok(count @ 1..=MAX_ORBIT_VIEWS) => Ok(Self::Orbit(count)),
                _ => Err(ViewSourceError::OrbitCount {
                    text: text.to_owned(),
                }),
            };
        }
        let path = PathBuf::from(text);
        let is_stored = stored.into_iter().any(|name| name == text);
        let looks_like_name = !text.contains(['.', '/', '\\']) && !path.exists();
        Ok(if is_stored || looks_like_name {
            Self::Stored(text.to_owned())
        } else {
            Self::File(path)
        })
    }

    /// The views themselves; `bounds` is the scene's box in the world, `width` and `height` the size for views that have
    /// none of their own, `stored` the views that have names.
    ///
    /// # Errors
    /// The name is not stored; the file cannot be read.
    pub fn resolve(
        &self,
        bounds: &Bounds,
        [width, height]: [u32; 2],
        stored: &[(String, ViewRecord)],
    ) -> Result<Vec<ViewRecord>, ViewSourceError> {
        match self {
            Self::Stored(name) => {
                let found = stored.iter().find(|(stored_name, _)| stored_name == name);
                let not_stored = || ViewSourceError::NotStored {
                    name: name.clone(),
                    stored: stored
                        .iter()
                        .map(|(stored_name, _)| stored_name.clone())
                        .collect(),
                };
                found
                    .map(|(_, record)| vec![*record])
                    .ok_or_else(not_stored)
            }
            Self::File(path) => match ViewRecord::from_file(path) {
                Ok(record) => Ok(vec![record]),
                Err(source) => Err(ViewSourceError::Record {
                    path: path.clone(),
                    source,
                }),
            },
            Self::Orbit(count) => {
                let aspect = f64::from(width.max(1)) / f64::from(height.max(1));
                let cameras = orbit_cameras(bounds, *count, aspect);
                Ok(cameras
                    .into_iter()
                    .map(|camera| ViewRecord::new(camera, width, height))
                    .collect())
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<ViewSource, ViewSourceError> {
        ViewSource::parse(text, ["front", "my view.1"])
    }

    #[test]
    fn the_grammar_is_name_file_or_orbit() {
        assert_eq!(parse("orbit:12").unwrap(), ViewSource::Orbit(12));
        assert_eq!(parse("front").unwrap(), ViewSource::Stored("front".into()));
        assert_eq!(
            parse("my view.1").unwrap(),
            ViewSource::Stored("my view.1".into())
        );
        assert_eq!(
            parse("a/view.json").unwrap(),
            ViewSource::File("a/view.json".into())
        );
        assert_eq!(parse("fornt").unwrap(), ViewSource::Stored("fornt".into()));
    }

    #[test]
    fn a_bad_orbit_count_is_shown_with_an_example() {
        for text in [
            "orbit:",
            "orbit:0",
            "orbit:-3",
            "orbit:ten",
            "orbit:99999999",
        ] {
            let error = parse(text).expect_err(text).to_string();
            assert!(error.contains(text) && error.contains("orbit:8"), "{error}");
        }
    }

    #[test]
    fn a_name_that_is_not_stored_lists_those_that_are() {
        let view = ViewRecord::new(crate::Camera::default(), 8, 8);
        let stored = [("front".to_owned(), view)];
        let error = parse("fornt")
            .unwrap()
            .resolve(&Bounds::EMPTY, [8, 8], &stored)
            .expect_err("not stored");
        assert!(
            error.to_string().contains("a stored name (front)"),
            "{error}"
        );
    }

    #[test]
    fn orbit_views_have_the_asked_size() {
        let views = ViewSource::Orbit(3)
            .resolve(&Bounds::EMPTY, [320, 200], &[])
            .unwrap();
        assert_eq!(
            (views.len(), views[2].width, views[2].height),
            (3, 320, 200)
        );
        assert!(views.iter().all(|view| view.checked().is_ok()));
    }
}
