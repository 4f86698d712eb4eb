//! The settings file: read at start, set aside when it cannot be used.

use std::path::{Path, PathBuf};

use serde::Deserialize;

use super::{FORMAT, Preferences};
use crate::output::whole_file;
use crate::toml_form::{self, Flaw};

/// The file's name in the state folder.
const NAME: &str = "settings.toml";

/// The most files set aside that get a number of their own.
const MOST_SET_ASIDE: usize = 1000;

/// What came of opening the settings.
#[derive(Debug)]
pub(crate) struct Opened {
    /// Where they are kept.
    pub(crate) path: PathBuf,
    /// What the file holds, or the defaults.
    pub(crate) preferences: Preferences,
    /// What went wrong, for the user.
    pub(crate) complaint: Option<String>,
    /// False if the file could neither be read nor set aside: it must not be written over.
    pub(crate) may_write: bool,
}

/// Reads the settings in `state_folder`. A file that cannot be used is renamed, never deleted.
pub(crate) fn open(state_folder: &Path) -> Opened {
    let path = state_folder.join(NAME);
    let (preferences, trouble) = match read(&path) {
        Ok(preferences) => (preferences, None),
        Err(trouble) => (Preferences::default(), Some(trouble)),
    };
    let mut opened = Opened {
        path,
        preferences,
        complaint: None,
        may_write: true,
    };
    if let Some(trouble) = trouble {
        match set_aside(&opened.path) {
            Ok(aside) => opened.complaint = Some(trouble.set_aside_text(&opened.path, &aside)),
            Err(error) => {
                opened.may_write = false;
                opened.complaint = Some(trouble.kept_text(&opened.path, &error));
            }
        }
    }
    opened
}

/// The folders that the settings add for plugins. Commands without a window look there too; what is wrong with the file, the
/// window says.
pub(crate) fn plugin_folders(state_folder: &Path) -> Vec<PathBuf> {
    let preferences = read(&state_folder.join(NAME)).unwrap_or_default();
    preferences.plugin_folders
}

/// Writes the settings, whole.
pub(super) fn write(path: &Path, preferences: &Preferences) -> Result<(), String> {
    let text = toml::to_string(preferences).map_err(|error| {
        format!("the settings cannot be written as TOML: {error}; please report this")
    })?;
    if let Some(folder) = path.parent() {
        // If it cannot be made, writing says so.
        let _ = std::fs::create_dir_all(folder);
    }
    whole_file::write(path, text.as_bytes()).map_err(|error| error.to_string())
}

/// Why a settings file cannot be used.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Trouble {
    /// It cannot be read.
    Unreadable(String),
    /// It says something that cannot be.
    Flaw(Flaw),
    /// Another program's format.
    Format(u32),
}

impl Trouble {
    fn in_words(&self) -> String {
        match self {
            Self::Unreadable(reason) => format!("cannot be read ({reason})"),
            Self::Flaw(flaw) => format!("is damaged, {flaw}"),
            Self::Format(found) => format!(
                "has format {found}, written by another version of Pointstage; this one reads format {FORMAT}"
            ),
        }
    }

    fn set_aside_text(&self, path: &Path, aside: &Path) -> String {
        format!(
            "The settings file {} {}. It was kept as {}, and the window starts with default settings; correct that file and rename it back to have yours again.",
            path.display(),
            self.in_words(),
            aside.display()
        )
    }

    fn kept_text(&self, path: &Path, error: &std::io::Error) -> String {
        format!(
            "The settings file {} {}, and it cannot be set aside ({error}). The window starts with default settings and saves none; correct or remove that file.",
            path.display(),
            self.in_words()
        )
    }
}

/// The settings in a file; the defaults if there is none.
fn read(path: &Path) -> Result<Preferences, Trouble> {
    match toml_form::read_small(path) {
        Ok(bytes) => Flaw::text_of(&bytes).map_err(Trouble::Flaw).and_then(parse),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(Preferences::default()),
        Err(error) => Err(Trouble::Unreadable(error.to_string())),
    }
}

/// The settings in a text.
pub(super) fn parse(text: &str) -> Result<Preferences, Trouble> {
    #[derive(Deserialize)]
    struct Head {
        format: u32,
    }
    let flaw = |error: &toml::de::Error| Trouble::Flaw(Flaw::of(error, text));
    // The number first: another format may hold anything else.
    let Head { format } = toml::from_str(text).map_err(|error| flaw(&error))?;
    if format != FORMAT {
        return Err(Trouble::Format(format));
    }
    toml::from_str(text).map_err(|error| flaw(&error))
}

/// Renames the file to the first free name, and returns that.
fn set_aside(path: &Path) -> std::io::Result<PathBuf> {
    for number in 1..=MOST_SET_ASIDE {
        let aside = path.with_file_name(format!("settings.damaged-{number}.toml"));
        // A link that leads nowhere takes the name too.
        if aside.symlink_metadata().is_err() {
            std::fs::rename(path, &aside)?;
            return Ok(aside);
        }
    }
    Err(std::io::Error::other(format!(
        "{MOST_SET_ASIDE} damaged files are kept already"
    )))
}
