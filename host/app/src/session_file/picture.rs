//! The session inside a picture that Pointstage wrote.
//!
//! Pictures carry a record of what made them, as JSON: a PNG in the text chunk `Pointstage`, an EXR in the text attribute of
//! that name. If the record has a field `session`, that is the session (its TOML as a string, or the same fields as an
//! object). Records without one, as older programs wrote, name files, renderer, settings and view, which are a session too.

use std::io::Read as _;
use std::path::{Path, PathBuf};

use pointstage_engine::stage::SettingValues;
use pointstage_scene::{Lights, ViewRecord};
use serde::Deserialize;
use serde_json::Value;

use super::paths::absolute;
use super::{SceneFile, SessionFile, SessionFileError};
use crate::cli::values::background;
use crate::toml_form::{Look, show_from_key};

/// The name of the text chunk and of the attribute.
const KEY: &str = "Pointstage";

/// First bytes of a PNG.
const PNG_MAGIC: [u8; 4] = [0x89, b'P', b'N', b'G'];

/// First bytes of an EXR.
const EXR_MAGIC: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];

/// The record in a picture; `None` for a file that is no picture, as its first bytes tell.
pub(super) fn record_in(path: &Path) -> Result<Option<Value>, SessionFileError> {
    let at_read = |source| SessionFileError::Read {
        path: path.to_path_buf(),
        source,
    };
    let mut start = Vec::new();
    std::fs::File::open(path)
        .and_then(|file| file.take(4).read_to_end(&mut start))
        .map_err(at_read)?;
    let text = if start == PNG_MAGIC {
        png_text(path)
    } else if start == EXR_MAGIC {
        exr_text(path)
    } else {
        return Ok(None);
    };
    let lacks = |lacks: String| no_session(path, lacks);
    let text = text.map_err(lacks)?;
    let record = serde_json::from_str(&text);
    record
        .map(Some)
        .map_err(|error| lacks(format!("its text '{KEY}' is no JSON: {error}")))
}

fn no_session(path: &Path, lacks: String) -> SessionFileError {
    SessionFileError::NoSession {
        path: path.to_path_buf(),
        lacks,
    }
}

/// The text chunk of a PNG, or what is amiss.
fn png_text(path: &Path) -> Result<String, String> {
    let file = std::fs::File::open(path).map_err(|error| error.to_string())?;
    let decoder = png::Decoder::new(std::io::BufReader::new(file));
    let reader = decoder.read_info().map_err(|error| error.to_string())?;
    let info = reader.info();
    let long = info.utf8_text.iter().find(|chunk| chunk.keyword == KEY);
    let short = info.uncompressed_latin1_text.iter();
    if let Some(chunk) = long {
        return chunk.get_text().map_err(|error| error.to_string());
    }
    short
        .filter(|chunk| chunk.keyword == KEY)
        .map(|chunk| chunk.text.clone())
        .next()
        .ok_or_else(|| format!("it has no text '{KEY}'"))
}

/// The text attribute of an EXR, or what is amiss.
fn exr_text(path: &Path) -> Result<String, String> {
    let pedantic = false;
    let meta =
        exr::meta::MetaData::read_from_file(path, pedantic).map_err(|error| error.to_string())?;
    let attributes = meta.headers.iter().flat_map(|header| {
        let shared = &header.shared_attributes.other;
        shared.iter().chain(&header.own_attributes.other)
    });
    let mut texts = attributes
        .filter(|(name, _)| name.as_slice() == KEY.as_bytes())
        .filter_map(|(_, value)| value.to_text().ok());
    texts
        .next()
        .map(ToString::to_string)
        .ok_or_else(|| format!("it has no attribute '{KEY}'"))
}

/// The session of a record; `folder` is the picture's.
pub(super) fn session_of(
    record: &Value,
    folder: &Path,
    path: &Path,
) -> Result<SessionFile, SessionFileError> {
    let lacks = |what: &dyn std::fmt::Display| no_session(path, format!("its record: {what}"));
    match record.get("session").filter(|session| !session.is_null()) {
        Some(Value::String(text)) => {
            SessionFile::parse(text, folder).map_err(|problem| problem.at(path))
        }
        Some(fields) => {
            // The same fields in another notation: by way of the text they are checked once, in one place.
            let text = toml::to_string(fields).map_err(|error| lacks(&error))?;
            SessionFile::parse(&text, folder).map_err(|problem| problem.at(path))
        }
        None => {
            let record = Record::deserialize(record).map_err(|error| lacks(&error))?;
            record.session(folder).map_err(|flaw| lacks(&flaw))
        }
    }
}

/// What pictures carry beside or instead of a session.
#[derive(Deserialize)]
struct Record {
    files: Vec<PathBuf>,
    renderer: String,
    #[serde(default)]
    settings: SettingValues,
    structure: Option<String>,
    #[serde(default)]
    structure_settings: SettingValues,
    view: ViewRecord,
    #[serde(default)]
    lights: Lights,
    show: Option<String>,
    background: Option<String>,
    exposure: Option<f32>,
    radius_scale: Option<f32>,
}

impl Record {
    fn session(self, folder: &Path) -> Result<SessionFile, String> {
        let view = self.view.checked().map_err(|error| error.to_string())?;
        let default = Look::default();
        let look = Look {
            show: self.show.as_deref().map_or(default.show, show_from_key),
            background: match &self.background {
                Some(text) => background(text)?,
                None => default.background,
            },
            exposure: self.exposure.unwrap_or(default.exposure),
            radius_scale: self.radius_scale.unwrap_or(default.radius_scale),
        };
        let mut session = SessionFile::new(view);
        session.look = look;
        session.lights = self.lights;
        session.scene = self
            .files
            .iter()
            .map(|file| SceneFile::new(found(file, folder)))
            .collect();
        if let Some(structure) = self.structure.clone() {
            session.settings.insert(structure, self.structure_settings);
        }
        if !self.settings.is_empty() {
            session
                .settings
                .insert(self.renderer.clone(), self.settings);
        }
        session.renderers.main = Some(self.renderer);
        session.renderers.structure = self.structure;
        Ok(session)
    }
}

/// A file that a record names as it was named on the command line: beside the picture, else from here.
fn found(file: &Path, folder: &Path) -> PathBuf {
    let beside = absolute(file, folder);
    if beside.is_file() {
        return beside;
    }
    std::path::absolute(file).unwrap_or(beside)
}
