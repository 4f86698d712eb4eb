//! The window's session as a session file, and back: what the worker loads, and how it takes the window's place.

use std::path::{Path, PathBuf};
use std::time::Instant;

use pointstage_engine::stage::Severity;
use pointstage_scene::{
    Job, LoadError, Loaded, Loaders, NearClipping, ObjectId, Scene, ViewRecord, load_with,
};

use super::app::App;
use super::comparison::{Comparison, FLICKER_HZ, Way};
use super::history::History;
use super::intent::OpenMode;
use super::loading::{Arrival, Batch, Finished, Place, arrive};
use super::path::Player;
use super::remembered::{stored_views, views_to_store};
use super::session::Pane;
use super::several::{MOST_VIEWS, Several};
use super::tasks::guarded;
use crate::session_file::{ComparisonFile, OwnObject, PaneFile, Renderers, SceneFile, SessionFile};
use crate::toml_form::Look;

/// A session with all of its objects that could be loaded.
#[derive(Debug)]
pub(crate) struct OpenedSession {
    /// Where it was read.
    pub(crate) path: PathBuf,
    /// What it says.
    pub(crate) file: SessionFile,
    /// Its objects, in order.
    pub(crate) objects: Vec<Loaded>,
    /// The active one.
    pub(crate) active: Option<ObjectId>,
    /// Entries without an object.
    pub(crate) absent: Vec<SceneFile>,
    /// Why each of those has none.
    pub(crate) complaints: Vec<String>,
}

/// Reads a session and loads its scene; runs on the worker. The window stays as it is until all is there.
pub(crate) fn load_session(path: &Path, loaders: &Loaders, job: &Job) -> Finished {
    let name = path.display();
    guarded(
        || read_and_load(path, loaders, job),
        |panic| {
            Finished::Failed(format!(
                "{name}: loading the session stopped by a defect ({panic}); please report it with the file"
            ))
        },
    )
}

fn read_and_load(path: &Path, loaders: &Loaders, job: &Job) -> Finished {
    let file = match SessionFile::read(path) {
        Ok(file) => file,
        Err(error) => return Finished::Failed(error.to_string()),
    };
    let mut opened = OpenedSession {
        path: std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf()),
        objects: Vec::new(),
        active: None,
        absent: Vec::new(),
        complaints: Vec::new(),
        file,
    };
    let missing = opened.file.missing_files();
    if !missing.is_empty() {
        let error = crate::session_file::SessionFileError::Missing {
            session: path.to_path_buf(),
            files: missing.clone(),
        };
        opened.complaints.push(error.to_string());
    }
    for entry in &opened.file.scene {
        if missing.contains(&entry.file) {
            opened.absent.push(entry.clone());
            continue;
        }
        match load_with(loaders, &entry.file, &entry.load_options(), job) {
            Ok(mut loaded) => {
                entry.dress(&mut loaded.object);
                if entry.active {
                    opened.active = Some(loaded.object.id);
                }
                opened.objects.push(loaded);
            }
            Err(LoadError::Cancelled(_)) => return Finished::Cancelled(path.display().to_string()),
            Err(error) => {
                opened.complaints.push(error.to_string());
                opened.absent.push(entry.clone());
            }
        }
    }
    Finished::Session(Box::new(opened))
}

impl App {
    /// Puts a session in the place of all that the window shows.
    pub(super) fn take_over(&mut self, opened: OpenedSession) {
        let now = Instant::now();
        let OpenedSession {
            path,
            mut file,
            objects,
            active,
            absent,
            complaints,
        } = opened;
        for complaint in complaints {
            self.log.error(complaint, now);
        }
        let batch = Batch(self.next_batch);
        self.next_batch += 1;
        self.session.clear_scene();
        self.shown_batch = None;
        for loaded in objects {
            let place = Place::New(batch, OpenMode::Replace);
            let session = &mut self.session;
            let _: Arrival = arrive(session, &mut self.shown_batch, loaded, place, &mut self.log);
        }
        self.session.active = active;
        let pane = file.take_pane();
        let SessionFile {
            views,
            path: motion,
            panes,
            comparison,
            ..
        } = file;
        // A view that the camera flies to must not carry it away from the session's.
        let around = self.surroundings();
        self.navigator
            .stop(&mut self.session.panes.active.camera, &around);
        // Of several views, the active one is among them.
        self.session.panes.truncate(1);
        let session = &mut self.session;
        let mut pane = Pane::from_file(pane);
        if pane.renderer.is_empty() {
            pane.renderer = std::mem::take(&mut session.panes.active.renderer);
        }
        session.panes.active = pane;
        session.views = stored_views(views);
        session.path = motion.unwrap_or_default();
        if panes.len() > 1 {
            self.take_over_panes(panes, &comparison.unwrap_or_default());
        }
        self.match_screens();
        self.player = Player::default();
        // What was undone led to another session.
        self.history = History::default();
        tracing::info!("session opened: {}", path.display());
        self.remembered.note(&path);
        self.remembered.absent = absent;
        // A picture holds a session, but is no place to save one.
        let is_session_file = path
            .extension()
            .is_some_and(|extension| extension == "toml");
        self.remembered.session_path = is_session_file.then_some(path);
        self.tell_of_missing_renderers();
    }

    /// Warns of renderers that the session names and that are not there, once plugins are known.
    pub(super) fn tell_of_missing_renderers(&mut self) {
        if self.rows.renderers.is_empty() {
            return;
        }
        let now = Instant::now();
        let main = Some(&self.session.panes.active.renderer).filter(|id| !id.is_empty());
        let named = main.into_iter().chain(&self.session.panes.active.preview);
        let missing: Vec<String> = named
            .filter(|id| self.rows.renderer(id).is_none())
            .cloned()
            .collect();
        for id in missing {
            let text = format!(
                "The renderer '{id}' is not there; another one draws. Its settings are kept: install its plugin to have it back."
            );
            self.log.say(Severity::Warning, text, now);
        }
    }

    /// The session as a file at `path` holds it, and the objects whose surfels are to be written beside it.
    pub(super) fn session_to_save(&self, path: &Path) -> (SessionFile, Vec<OwnObject>) {
        let mut file = self.session_file();
        let objects = self.session.scene.objects();
        let places = self.remembered.own_files.places(objects, path);
        let active = self.session.active_object().map(|object| object.id);
        let entries = objects.iter().filter_map(|object| {
            let entry = match places.get(&object.id.0) {
                Some(file) => SceneFile::of_own(object, file.clone()),
                None => SceneFile::of(object, self.session.warnings.get(&object.id))?,
            };
            Some(SceneFile {
                active: active == Some(object.id),
                ..entry
            })
        });
        file.scene = entries.collect();
        file.scene.extend(self.remembered.absent.iter().cloned());
        let own = objects.iter().filter_map(|object| {
            Some(OwnObject {
                object: object.clone(),
                file: places.get(&object.id.0)?.clone(),
            })
        });
        (file, own.collect())
    }

    /// The session as a file holds it, without objects that no file holds.
    pub(super) fn session_file(&self) -> SessionFile {
        let Self {
            session,
            remembered,
            ..
        } = self;
        let ViewRecord { width, height, .. } = self.view_record();
        let mut file = SessionFile::of_pane(session.panes.active.to_file(width, height));
        file.scene = entries_of(&session.scene, |id| session.warnings.get(&id));
        file.scene.extend(remembered.absent.iter().cloned());
        file.views = views_to_store(&session.views);
        file.path = (!session.path.is_empty()).then(|| session.path.clone());
        if session.panes.count() > 1 {
            file.panes = self.panes_to_store();
            file.comparison = Some(session.comparison.to_file(session.panes.active_index()));
        }
        file
    }

    /// All views, as a file holds them.
    fn panes_to_store(&self) -> Vec<PaneFile> {
        let views = self.session.panes.iter().zip(self.screens.iter());
        let stored = views.map(|(pane, screen)| {
            let [width, height] = screen
                .viewport
                .or(self.screens.active.viewport)
                .map_or([1280, 720], |viewport| viewport.size_px);
            pane.to_file(width, height)
        });
        stored.collect()
    }

    /// Puts several views in the place of the one that there is.
    fn take_over_panes(&mut self, panes: Vec<PaneFile>, comparison: &ComparisonFile) {
        let mut taken = panes.into_iter().take(MOST_VIEWS).map(Pane::from_file);
        if let Some(first) = taken.next() {
            self.session.panes = Several::one(first);
        }
        taken.for_each(|pane| self.session.panes.push(pane));
        self.session.panes.activate(comparison.active);
        self.session.comparison = Comparison::from_file(comparison);
    }

    /// A name for the session's file: beside the first object, called like it.
    pub(super) fn suggested_session_path(&self) -> PathBuf {
        if let Some(path) = &self.remembered.session_path {
            return path.clone();
        }
        let mut objects = self.session.scene.objects().iter();
        let first = objects.find_map(|object| object.source.as_deref());
        let name = first.and_then(Path::file_stem);
        let name = name.map_or_else(|| "session".into(), |stem| stem.to_string_lossy());
        let name = format!("{name}{}", crate::session_file::SUFFIX);
        let folder = first
            .and_then(Path::parent)
            .map(Path::to_path_buf)
            .or_else(|| etcetera::home_dir().ok())
            .unwrap_or_default();
        let path = folder.join(name);
        std::path::absolute(&path).unwrap_or(path)
    }
}

fn entries_of<'a>(
    scene: &Scene,
    warnings: impl Fn(pointstage_scene::ObjectId) -> Option<&'a pointstage_scene::Warnings>,
) -> Vec<SceneFile> {
    let objects = scene.objects().iter();
    objects
        .filter_map(|object| SceneFile::of(object, warnings(object.id)))
        .collect()
}

impl Pane {
    /// The view as a file holds it, with its picture's size, px.
    fn to_file(&self, width: u32, height: u32) -> PaneFile {
        let main = Some(&self.renderer).filter(|id| !id.is_empty());
        PaneFile {
            view: ViewRecord::new(self.camera, width, height),
            renderers: Renderers {
                main: main.cloned(),
                preview: self.preview.clone(),
                structure: self.structure.clone(),
            },
            look: Look::from(&self.view),
            lights: self.lights.clone(),
            settings: self.settings.clone(),
            presets: self.active_presets.clone(),
        }
    }

    /// The view that a file holds.
    fn from_file(file: PaneFile) -> Self {
        let PaneFile {
            view,
            renderers,
            look,
            lights,
            settings,
            presets,
        } = file;
        let camera = view.camera();
        Self {
            near: NearClipping::of(&camera),
            camera,
            lights,
            renderer: renderers.main.unwrap_or_default(),
            preview: renderers.preview,
            structure: renderers.structure,
            settings,
            active_presets: presets,
            view: look.into(),
        }
    }
}

impl Comparison {
    /// How views are compared, as a file holds it.
    fn to_file(&self, active: usize) -> ComparisonFile {
        ComparisonFile {
            active,
            linked: self.is_linked,
            fair: self.is_locked,
            layout: self.way.key().to_owned(),
            flicker_hz: self.flicker_hz,
            against: self.against,
            measure: self.measures,
            split: self.split,
        }
    }

    /// What a file holds, within what there is.
    fn from_file(file: &ComparisonFile) -> Self {
        let usual = Self::default();
        let number = |value: f32, usual: f32| if value.is_finite() { value } else { usual };
        let mut ways = Way::ALL.into_iter().map(|(way, _)| way);
        let [column, row] = file.split;
        Self {
            is_linked: file.linked,
            is_locked: file.fair,
            way: ways
                .find(|way| way.key() == file.layout)
                .unwrap_or(usual.way),
            flicker_hz: number(file.flicker_hz, usual.flicker_hz)
                .clamp(*FLICKER_HZ.start(), *FLICKER_HZ.end()),
            against: file.against,
            measures: file.measure,
            split: [number(column, 0.5), number(row, 0.5)].map(|part| part.clamp(0.0, 1.0)),
        }
    }
}
