//! What a picture is made of: a session, and the options that override it.

use std::path::PathBuf;

use pointstage_engine::stage::{SettingValue, SettingValues};
use pointstage_scene::{Lights, Scene, ViewRecord, ViewSource};

use super::RenderArguments;
use super::film::Film;
use crate::cli::{Outcome, views};
use crate::session_file::{Renderers, SceneFile, SessionFile, SessionFileError};
use crate::toml_form::{Look, show_from_key};

/// Size of a picture when neither `--size`, the view nor a session says one, px.
const DEFAULT_SIZE: [u32; 2] = [1280, 720];

/// All that does not depend on which plugins there are.
pub(super) struct Plan {
    /// The objects.
    pub(super) files: Vec<SceneFile>,
    /// How the picture is shown.
    pub(super) look: Look,
    /// The lights.
    pub(super) lights: Lights,
    /// Whom the session names.
    pub(super) renderers: Renderers,
    settings: std::collections::BTreeMap<String, SettingValues>,
    view: Sight,
    stored: Vec<(String, ViewRecord)>,
    /// The session's size.
    size: Option<[u32; 2]>,
    session: Option<PathBuf>,
    /// What moves, if anything does.
    pub(super) film: Option<Film>,
}

/// Where the picture is seen from.
enum Sight {
    /// As the command line says.
    Named(ViewSource),
    /// As in the session.
    Session(ViewRecord),
}

impl Plan {
    /// Reads the session, if one is named, and puts the options in its place.
    pub(super) fn new(arguments: &RenderArguments) -> Outcome<Self> {
        let session = match &arguments.session {
            Some(path) => Some(SessionFile::read(path)?),
            None => None,
        };
        let stored = session
            .as_ref()
            .map_or_else(Vec::new, SessionFile::command_views);
        let named = match (&arguments.view, &session) {
            (Some(text), _) => Some(views::parse(text, &stored)?),
            (None, Some(_)) => None,
            (None, None) => Some(ViewSource::Orbit(1)),
        };
        let film = match &arguments.path {
            Some(source) => Some(Film::new(source, arguments, session.as_ref())?),
            None => None,
        };
        let session = session.unwrap_or_else(|| {
            SessionFile::new(ViewRecord::new(
                pointstage_scene::Camera::default(),
                DEFAULT_SIZE[0],
                DEFAULT_SIZE[1],
            ))
        });
        let is_session = arguments.session.is_some();
        let files = if arguments.files.is_empty() {
            check_presence(arguments, &session)?;
            session.scene
        } else {
            arguments
                .files
                .iter()
                .cloned()
                .map(SceneFile::new)
                .collect()
        };
        Ok(Self {
            files,
            look: look_of(session.look, arguments),
            lights: session.lights,
            renderers: session.renderers,
            settings: session.settings,
            view: named.map_or(Sight::Session(session.view), Sight::Named),
            stored,
            size: is_session.then_some([session.view.width, session.view.height]),
            session: arguments.session.clone(),
            film,
        })
    }

    /// The session's values for a plugin.
    pub(super) fn settings_of(&self, id: &str) -> impl Iterator<Item = (&String, &SettingValue)> {
        self.settings.get(id).into_iter().flatten()
    }

    /// The views, in the size that was asked for.
    pub(super) fn views(&self, scene: &Scene, size: Option<[u32; 2]>) -> Outcome<Vec<ViewRecord>> {
        let mut views = match &self.view {
            Sight::Session(view) => vec![*view],
            Sight::Named(source) => {
                let size_px = size.or(self.size).unwrap_or(DEFAULT_SIZE);
                views::resolve(source, scene, size_px, &self.stored)?
            }
        };
        if let Some([width, height]) = size {
            for view in &mut views {
                (view.width, view.height) = (width, height);
            }
        }
        Ok(views)
    }

    /// Says on standard error what of the session cannot be as it says.
    pub(super) fn warn(&self, text: &str) {
        match &self.session {
            Some(path) => eprintln!("warning: {}: {text}", path.display()),
            None => eprintln!("warning: {text}"),
        }
    }
}

/// A picture without some of its objects would not be what the window showed.
fn check_presence(arguments: &RenderArguments, session: &SessionFile) -> Outcome {
    let Some(path) = &arguments.session else {
        return Ok(());
    };
    let files = session.missing_files();
    if files.is_empty() {
        return Ok(());
    }
    let session = path.clone();
    Err(SessionFileError::Missing { session, files }.into())
}

/// The session's look with what the options say in its place.
fn look_of(session: Look, arguments: &RenderArguments) -> Look {
    let show = arguments.show.as_deref().map(show_from_key);
    Look {
        show: show.unwrap_or(session.show),
        background: arguments.background.unwrap_or(session.background),
        exposure: arguments.exposure.unwrap_or(session.exposure),
        radius_scale: arguments.radius_scale.unwrap_or(session.radius_scale),
    }
}
