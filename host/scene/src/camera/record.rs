//! A view written down: camera, projection and picture size, as JSON.

use std::path::{Path, PathBuf};

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::{Camera, Projection};

/// The format number that this program writes and reads.
pub const VIEW_RECORD_FORMAT: u32 = 1;

/// Largest width and height of a recorded picture, pixels.
const MAX_SIDE_PX: u32 = 65_536;

/// A camera and a picture size; the same fields in files, sessions and the clipboard.
///
/// ```
/// use pointstage_scene::{Camera, ViewRecord};
/// let record = ViewRecord::new(Camera::default(), 800, 600);
/// assert_eq!(ViewRecord::from_json(&record.to_json()).unwrap(), record);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ViewRecord {
    /// Always [`VIEW_RECORD_FORMAT`].
    pub format: u32,
    /// Where the eye is, world space.
    pub eye: DVec3,
    /// What it looks at, world space.
    pub pivot: DVec3,
    /// What appears upwards, world space.
    pub up: DVec3,
    /// How it projects.
    pub projection: Projection,
    /// Distance of the near plane, scene units.
    pub near: f64,
    /// Distance of the far plane, scene units; matters to orthographic views only.
    pub far: f64,
    /// Width of the picture, pixels.
    pub width: u32,
    /// Height of the picture, pixels.
    pub height: u32,
}

/// A view record that cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum ViewRecordError {
    /// The file cannot be read at all.
    #[error("{}: the view file cannot be read: {source}; check the path and its permissions", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// Why.
        #[source]
        source: std::io::Error,
    },
    /// Not JSON, or a field is missing or of the wrong type.
    #[error(
        "line {line}, column {column}: not a view record: {message}; expected an object with \"format\": 1, eye, pivot, up, projection, near, far, width and height"
    )]
    Syntax {
        /// Line, from 1.
        line: usize,
        /// Column, from 1.
        column: usize,
        /// What the parser says.
        message: String,
    },
    /// Written by another version of the program.
    #[error(
        "view record has format {found}, this program reads format {VIEW_RECORD_FORMAT}; save the view again, or take a program that knows format {found}"
    )]
    Format {
        /// The record's number.
        found: u64,
    },
    /// A field holds a value with which nothing can be seen.
    #[error("view record: {field} is {found}, expected {expected}; correct that field")]
    Field {
        /// The field's name.
        field: &'static str,
        /// Its value.
        found: String,
        /// What would do.
        expected: &'static str,
    },
}

impl ViewRecord {
    /// Records a camera and a picture size.
    pub fn new(camera: Camera, width: u32, height: u32) -> Self {
        let Camera {
            eye,
            pivot,
            up,
            projection,
            near,
            far,
        } = camera;
        Self {
            format: VIEW_RECORD_FORMAT,
            eye,
            pivot,
            up,
            projection,
            near,
            far,
            width,
            height,
        }
    }

    /// The recorded camera.
    pub fn camera(&self) -> Camera {
        let Self {
            eye,
            pivot,
            up,
            projection,
            near,
            far,
            ..
        } = *self;
        Camera {
            eye,
            pivot,
            up,
            projection,
            near,
            far,
        }
    }

    /// Width over height.
    pub fn aspect(&self) -> f64 {
        f64::from(self.width) / f64::from(self.height)
    }

    /// The record as JSON, readable by people.
    ///
    /// # Panics
    /// Never: numbers and strings alone are always representable.
    pub fn to_json(&self) -> String {
        serde_json::to_string_pretty(self).expect("numbers and strings alone: always representable")
    }

    /// Reads and checks a record.
    ///
    /// # Errors
    /// Not JSON; a missing field; another format; NaN, infinite or useless values.
    pub fn from_json(text: &str) -> Result<Self, ViewRecordError> {
        #[derive(Deserialize)]
        struct FormatOnly {
            format: u64,
        }
        let syntax = |error: &serde_json::Error| {
            let (line, column) = (error.line(), error.column());
            let place = format!(" at line {line} column {column}");
            let text = error.to_string();
            ViewRecordError::Syntax {
                line,
                column,
                message: text.strip_suffix(&place).unwrap_or(&text).to_owned(),
            }
        };
        // The number first: another format may lack every other field.
        let FormatOnly { format } = serde_json::from_str(text).map_err(|error| syntax(&error))?;
        if format != u64::from(VIEW_RECORD_FORMAT) {
            return Err(ViewRecordError::Format { found: format });
        }
        let record: Self = serde_json::from_str(text).map_err(|error| syntax(&error))?;
        record.checked()
    }

    /// Reads and checks a file of JSON.
    ///
    /// # Errors
    /// As [`from_json`](Self::from_json), and when the file cannot be read.
    pub fn from_file(path: &Path) -> Result<Self, ViewRecordError> {
        let text = std::fs::read_to_string(path).map_err(|source| ViewRecordError::Io {
            path: path.to_path_buf(),
            source,
        })?;
        Self::from_json(&text)
    }

    /// The record itself, if something can be seen with it.
    ///
    /// # Errors
    /// The first field that is NaN, infinite, out of range, or degenerate together with others.
    pub fn checked(self) -> Result<Self, ViewRecordError> {
        let require = |holds: bool, field, found: String, expected| {
            if holds {
                Ok(())
            } else {
                Err(ViewRecordError::Field {
                    field,
                    found,
                    expected,
                })
            }
        };
        for (field, vector) in [("eye", self.eye), ("pivot", self.pivot), ("up", self.up)] {
            require(
                vector.is_finite(),
                field,
                vector.to_string(),
                "three finite numbers",
            )?;
        }
        let back = self.eye - self.pivot;
        require(
            back.length() > 0.0,
            "eye",
            self.eye.to_string(),
            "a place other than the pivot",
        )?;
        let sine = self.up.normalize_or_zero().cross(back.normalize()).length();
        require(
            sine > 1e-9,
            "up",
            self.up.to_string(),
            "a direction, not along the line of sight",
        )?;
        match self.projection {
            Projection::Perspective { fov_y_rad } => require(
                fov_y_rad > 1e-6 && fov_y_rad < std::f64::consts::PI - 1e-6,
                "fov_y_rad",
                fov_y_rad.to_string(),
                "an angle between 0 and π radians",
            )?,
            Projection::Orthographic { height } => {
                require(
                    height.is_finite() && height > 0.0,
                    "height of the projection",
                    height.to_string(),
                    "a length above 0",
                )?;
                require(
                    self.far.is_finite() && self.far > self.near,
                    "far",
                    self.far.to_string(),
                    "a distance above near",
                )?;
            }
        }
        require(
            self.near.is_finite() && self.near > 0.0,
            "near",
            self.near.to_string(),
            "a distance above 0",
        )?;
        for (field, side) in [("width", self.width), ("height", self.height)] {
            require(
                (1..=MAX_SIDE_PX).contains(&side),
                field,
                side.to_string(),
                "1 to 65536 pixels",
            )?;
        }
        Ok(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn default_json_with(from: &str, to: &str) -> String {
        let json = ViewRecord::new(Camera::default(), 800, 600).to_json();
        let compact: String = json.split_whitespace().collect();
        assert!(compact.contains(from), "{from} is not in {compact}");
        compact.replace(from, to)
    }

    fn error_of(text: &str) -> String {
        ViewRecord::from_json(text).expect_err(text).to_string()
    }

    #[test]
    fn another_format_is_named() {
        let error = error_of("{\"format\": 7}");
        assert!(
            error.contains("format 7") && error.contains("format 1"),
            "{error}"
        );
    }

    #[test]
    fn each_useless_field_is_named() {
        for (from, to, expected) in [
            ("\"eye\":[0.0,0.0,3.0]", "\"eye\":[0.0,0.0,0.0]", "eye is"),
            (
                "\"eye\":[0.0,0.0,3.0]",
                "\"eye\":[0.0,0.0,1e999]",
                "out of range",
            ),
            ("\"eye\":[0.0,0.0,3.0]", "\"eye\":[null,0.0,1.0]", "null"),
            ("\"up\":[0.0,1.0,0.0]", "\"up\":[0.0,0.0,-2.0]", "up is"),
            ("\"near\":0.003", "\"near\":-1", "near is -1"),
            ("\"width\":800", "\"width\":0", "width is 0"),
            ("\"width\":800", "\"width\":-5", "-5"),
            ("\"width\":800,", "", "width"),
            ("\"fov_y_rad\":0.698", "\"fov_y_rad\":4.698", "fov_y_rad is"),
        ] {
            let error = error_of(&default_json_with(from, to));
            assert!(error.contains(expected), "{to} gave: {error}");
        }
    }

    #[test]
    fn what_is_not_json_is_placed() {
        let error = error_of("{\n  \"format\": 1,\n  oops");
        assert!(error.starts_with("line 3"), "{error}");
    }

    #[test]
    fn unknown_fields_are_ignored() {
        let text = default_json_with("\"near\"", "\"note\":\"mine\",\"near\"");
        assert!(ViewRecord::from_json(&text).is_ok());
    }

    proptest! {
        #[test]
        fn json_round_trips(
            eye in proptest::array::uniform3(-1e7..1e7f64),
            pivot in proptest::array::uniform3(-1e7..1e7f64),
            fov in 0.01..3.0f64,
            flat in proptest::option::of(1e-6..1e7f64),
            size in (1u32..4000, 1u32..4000),
        ) {
            let projection = flat.map_or(
                Projection::Perspective { fov_y_rad: fov },
                |height| Projection::Orthographic { height },
            );
            let camera = Camera { eye: eye.into(), pivot: pivot.into(), projection, ..Camera::default() };
            let record = ViewRecord::new(camera, size.0, size.1);
            prop_assume!(record.checked().is_ok());
            let read = ViewRecord::from_json(&record.to_json()).unwrap();
            // To the last bit: a view that is stored and drawn again must give the same picture.
            prop_assert_eq!((read.eye, read.pivot), (camera.eye, camera.pivot));
            prop_assert_eq!((read.width, read.height, read.up, read.near), (size.0, size.1, camera.up, camera.near));
            prop_assert_eq!(read.camera().projection, projection);
        }
    }
}
