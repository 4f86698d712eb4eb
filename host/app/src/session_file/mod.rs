//! Session files (`NAME.pointstage.toml`): a scene and all that its picture depends on, to open in the window or to draw
//! without one.
//!
//! [`SessionFile`] is the content; [`paths`] keeps scene files relative to the session file, so that a folder with both can
//! be moved; [`scene`] turns entries into objects, [`own_objects`] writes those that no file holds; [`panes`] holds several views beside each other; [`request`] makes the session of one picture; [`picture`] finds the session inside a picture that Pointstage wrote;
//! [`error`] says what is wrong with a file. Absent fields take defaults, unknown ones are ignored.

mod error;
mod own_objects;
mod panes;
mod paths;
mod picture;
mod request;
mod scene;
#[cfg(test)]
pub(crate) mod testing;
#[cfg(test)]
mod tests;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use pointstage_engine::stage::SettingValues;
use pointstage_scene::{Lights, ViewRecord};
use serde::{Deserialize, Serialize};

pub(crate) use error::SessionFileError;
pub(crate) use own_objects::{OwnFiles, OwnObject};
pub(crate) use panes::{ComparisonFile, PaneFile};
pub(crate) use paths::{absolute, folder_of};
pub(crate) use scene::SceneFile;

use crate::camera_path::MotionPath;
use crate::output::whole_file;
use crate::toml_form::{self, Flaw, Look, NumberOrigin, StoredView};

/// The format that this program writes and reads.
const FORMAT: u32 = 1;

/// How the names of session files end.
pub(crate) const SUFFIX: &str = ".pointstage.toml";

/// A session.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct SessionFile {
    /// Always [`FORMAT`].
    format: u32,
    /// The program that wrote it, for people.
    #[serde(default)]
    program: String,
    /// The camera and the picture's size.
    #[serde(deserialize_with = "toml_form::view")]
    pub(crate) view: ViewRecord,
    /// Who draws.
    #[serde(default)]
    pub(crate) renderers: Renderers,
    /// How the picture is shown.
    #[serde(default)]
    pub(crate) look: Look,
    /// The lights.
    #[serde(default, deserialize_with = "toml_form::lights")]
    pub(crate) lights: Lights,
    /// The objects.
    #[serde(default)]
    pub(crate) scene: Vec<SceneFile>,
    /// Values that differ from the default, by the id of the renderer or structure.
    #[serde(default)]
    pub(crate) settings: BTreeMap<String, SettingValues>,
    /// The preset that a renderer's values come from, by renderer id.
    #[serde(default)]
    pub(crate) presets: BTreeMap<String, String>,
    /// Views to go back to.
    #[serde(default)]
    pub(crate) views: Vec<StoredView>,
    /// How camera and settings change over time.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) path: Option<MotionPath>,
    /// All views beside each other, in order, where there are several; the fields above are those of the active one.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(crate) panes: Vec<PaneFile>,
    /// How they are compared, where there are several.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) comparison: Option<ComparisonFile>,
}

/// Ids of the plugins that draw. They may be of plugins that are not there.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub(crate) struct Renderers {
    /// Draws the picture that stays.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) main: Option<String>,
    /// Stands in while the camera moves.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) preview: Option<String>,
    /// Selects levels of detail.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) structure: Option<String>,
}

impl SessionFile {
    /// An empty scene seen in `view`, everything else as in a new window.
    pub(crate) fn new(view: ViewRecord) -> Self {
        Self {
            format: FORMAT,
            program: concat!("Pointstage ", env!("CARGO_PKG_VERSION")).to_owned(),
            view,
            renderers: Renderers::default(),
            look: Look::default(),
            lights: Lights::default(),
            scene: Vec::new(),
            settings: BTreeMap::new(),
            presets: BTreeMap::new(),
            views: Vec::new(),
            path: None,
            panes: Vec::new(),
            comparison: None,
        }
    }

    /// Whether a path's name says that it may hold a session: `.toml`, or a picture that may carry one.
    pub(crate) fn is_named_like_one(path: &Path) -> bool {
        let extension = path
            .extension()
            .map(|extension| extension.to_string_lossy().to_lowercase());
        matches!(extension.as_deref(), Some("toml" | "png" | "exr"))
    }

    /// Reads a session file, or a picture with a session in it. Scene files get absolute paths.
    ///
    /// # Errors
    /// The file cannot be read, is of another format, says something that cannot be, or holds no session.
    pub(crate) fn read(path: &Path) -> Result<Self, SessionFileError> {
        let at_read = |source| SessionFileError::Read {
            path: path.to_path_buf(),
            source,
        };
        let folder = folder_of(path);
        if let Some(record) = picture::record_in(path)? {
            return picture::session_of(&record, &folder, path);
        }
        let bytes = toml_form::read_small(path).map_err(at_read)?;
        Flaw::text_of(&bytes)
            .map_err(Problem::Flaw)
            .and_then(|text| Self::parse(text, &folder))
            .map_err(|problem| problem.at(path))
    }

    /// Writes the session to `path`, with scene files relative to its folder where both have a folder in common.
    ///
    /// # Errors
    /// A scene file's name is not Unicode; the file cannot be written.
    pub(crate) fn write(&self, path: &Path) -> Result<(), SessionFileError> {
        let text = self.to_toml_string(&folder_of(path))?;
        Ok(whole_file::write(path, text.as_bytes())?)
    }

    /// The session as the text of a file in `folder`.
    ///
    /// # Errors
    /// A scene file's name is not Unicode.
    pub(crate) fn to_toml_string(&self, folder: &Path) -> Result<String, SessionFileError> {
        if let Some(entry) = self
            .scene
            .iter()
            .find(|entry| entry.file.to_str().is_none())
        {
            let path = entry.file.clone();
            return Err(SessionFileError::NotUnicode { path });
        }
        let mut relative = self.clone();
        for entry in &mut relative.scene {
            entry.file = paths::relative(&entry.file, folder);
        }
        toml::to_string(&relative).map_err(SessionFileError::Encode)
    }

    /// Reads the text of a file in `folder`; scene files get absolute paths.
    ///
    /// # Errors
    /// The text is of another format, or says something that cannot be.
    pub(crate) fn parse(text: &str, folder: &Path) -> Result<Self, Problem> {
        #[derive(Deserialize)]
        struct Head {
            format: u32,
        }
        let flaw = |error: &toml::de::Error| Problem::Flaw(Flaw::of(error, text));
        // The number first: another format may lack every other field.
        let Head { format } = toml::from_str(text).map_err(|error| flaw(&error))?;
        if format != FORMAT {
            return Err(Problem::Format(format));
        }
        let mut session: Self = toml::from_str(text).map_err(|error| flaw(&error))?;
        for entry in &mut session.scene {
            entry.file = absolute(&entry.file, folder);
        }
        // Sessions that people write say no program; those of older windows count the keys from 0.
        let origin = if session.program.is_empty() {
            NumberOrigin::Key
        } else {
            NumberOrigin::Place
        };
        for stored in &mut session.views {
            stored.take_number(origin);
        }
        Ok(session)
    }

    /// Scene files that are not there.
    pub(crate) fn missing_files(&self) -> Vec<PathBuf> {
        let files = self.scene.iter().map(|entry| &entry.file);
        files.filter(|file| !file.is_file()).cloned().collect()
    }

    /// The views by the names that a command line takes: numbers first, then names.
    pub(crate) fn command_views(&self) -> Vec<(String, ViewRecord)> {
        let mut named: Vec<(String, ViewRecord)> = Vec::new();
        for stored in &self.views {
            let names = stored.command_names();
            named.extend(names.map(|name| (name, stored.view)));
        }
        named
    }
}

/// What is wrong with a text that should be a session.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Problem {
    /// It says something that cannot be.
    Flaw(Flaw),
    /// It has this format's number.
    Format(u32),
}

impl Problem {
    /// The problem as that of a file.
    fn at(self, path: &Path) -> SessionFileError {
        let path = path.to_path_buf();
        match self {
            Self::Flaw(flaw) => SessionFileError::Flaw { path, flaw },
            Self::Format(found) => SessionFileError::Format { path, found },
        }
    }
}
