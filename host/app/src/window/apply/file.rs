//! Carries out intents about files.

use std::path::PathBuf;
use std::time::Instant;

use egui::Context;
use pointstage_engine::stage::Severity;
use pointstage_scene::{LoadOptions, ObjectId};

use crate::host_log;
use crate::session_file::{SceneFile, SessionFile};
use crate::window::app::App;
use crate::window::bug_report::{Private, Report, bug_report};
use crate::window::comparison::SweepPanel;
use crate::window::dialogs::{Asked, FileDialog, PathField};
use crate::window::intent::{FileIntent, OpenMode, Overwrite};
use crate::window::loading::{Batch, Place, load_file};
use crate::window::session_link::load_session;

impl App {
    pub(super) fn apply_file(&mut self, ctx: &Context, intent: FileIntent) {
        match intent {
            FileIntent::Choose(mode) => self.choose_files(Asked::Open(mode)),
            FileIntent::TypePath(mode) => self.path_field = Some(PathField::open(mode)),
            FileIntent::Open(files, mode) => {
                self.dialog = None;
                self.open(files, mode);
            }
            FileIntent::Reload => self.reload(),
            FileIntent::ClearRecent => self.remembered.recent.clear(),
            FileIntent::SaveSessionAs => {
                self.path_field = Some(PathField::save(&self.suggested_session_path()));
            }
            FileIntent::ChooseSessionFile(path) => self.choose_files(Asked::Save(path)),
            FileIntent::SaveSession(path, overwrite) => self.save_session(path, overwrite),
            FileIntent::SaveSessionAgain => match self.remembered.session_path.clone() {
                Some(path) => self.save_session(path, Overwrite::Agreed),
                None => self.path_field = Some(PathField::save(&self.suggested_session_path())),
            },
            FileIntent::SaveObjectAs => self.ask_for_object_file(),
            FileIntent::ChooseObjectFile(id, path) => {
                self.choose_files(Asked::SaveObject(id, path));
            }
            FileIntent::SaveObject(id, path, overwrite) => self.save_object(id, path, overwrite),
            FileIntent::CopyBugReport => {
                ctx.copy_text(self.bug_report());
                let text = "The bug report is on the clipboard. Read it through, and add what happened, before you send it.";
                self.log.say(Severity::Info, text, Instant::now());
            }
            FileIntent::Cancel(task) => self.tasks.cancel(task),
        }
    }

    /// Puts the loading of files into the queue: sessions first, scans beside them then.
    pub(in crate::window) fn open(&mut self, files: Vec<PathBuf>, mode: OpenMode) {
        let (sessions, scans): (Vec<_>, Vec<_>) = files
            .into_iter()
            .partition(|path| SessionFile::is_named_like_one(path));
        let (sweeps, scans): (Vec<_>, Vec<_>) = scans
            .into_iter()
            .partition(|path| SweepPanel::is_named_like_one(path));
        for path in sweeps {
            self.open_sweep(&path);
        }
        if sessions.is_empty() && scans.is_empty() {
            return;
        }
        let mode = if sessions.is_empty() {
            mode
        } else {
            OpenMode::Add
        };
        for path in sessions {
            self.push_session(path);
        }
        let batch = Batch(self.next_batch);
        self.next_batch += 1;
        for path in scans {
            self.push_load(
                path,
                LoadOptions::default(),
                Place::New(batch, mode),
                "Load",
            );
        }
    }

    fn push_session(&mut self, path: PathBuf) {
        let name = path.file_name().unwrap_or(path.as_os_str());
        let title = format!("Open {}", name.to_string_lossy());
        tracing::info!("{title}");
        let loaders = self.loaders.clone();
        self.tasks
            .push(title, move |job| load_session(&path, &loaders, job));
    }

    pub(super) fn push_load(
        &mut self,
        path: PathBuf,
        options: LoadOptions,
        place: Place,
        verb: &str,
    ) {
        let name = path.file_name().unwrap_or(path.as_os_str());
        let title = format!("{verb} {}", name.to_string_lossy());
        tracing::info!("{title}");
        let loaders = self.loaders.clone();
        self.tasks.push(title, move |job| {
            load_file(&path, &loaders, &options, place, job)
        });
    }

    /// Reads every object's file again, as it was read before.
    fn reload(&mut self) {
        let objects = self.session.scene.objects().iter();
        let entries: Vec<(ObjectId, SceneFile)> = objects
            .filter_map(|object| {
                let warnings = self.session.warnings.get(&object.id);
                Some((object.id, SceneFile::of(object, warnings)?))
            })
            .collect();
        for (id, entry) in entries {
            let options = entry.load_options();
            self.push_load(entry.file, options, Place::InsteadOf(id), "Reload");
        }
    }

    pub(super) fn choose_files(&mut self, asked: Asked) {
        match FileDialog::open(asked, &self.loaders, self.wake.clone()) {
            Ok(dialog) => self.dialog = Some(dialog),
            Err(error) => self.log.error(
                format!("No file dialog can be opened ({error}); type the path instead."),
                Instant::now(),
            ),
        }
    }

    /// Has the session written, unless that would replace a file without the user's word.
    fn save_session(&mut self, path: PathBuf, overwrite: Overwrite) {
        let is_own = self.remembered.session_path.as_ref() == Some(&path);
        if overwrite == Overwrite::Ask && !is_own && path.exists() {
            self.path_field = Some(PathField::replace(&path));
            return;
        }
        let (session, own) = self.session_to_save(&path);
        let files = self.remembered.own_files.clone();
        self.remembered.errands.save(path, move |path| {
            // First what the session names.
            own.iter().try_for_each(|own| files.write(own))?;
            session.write(path).map_err(|error| error.to_string())
        });
    }

    /// The bug report, as Markdown.
    pub(in crate::window) fn bug_report(&self) -> String {
        let mut session = self.session_file();
        for view in &mut session.views {
            view.thumbnail.clear();
        }
        // As seen from no folder, so that paths are whole.
        let session = session
            .to_toml_string(std::path::Path::new(""))
            .unwrap_or_else(|error| error.to_string());
        let report = Report {
            facts: &self.stage.facts(),
            plugins: &self.rows.plugins,
            session: &session,
            messages: &self.log.as_text(),
            log: &host_log::lines(),
        };
        bug_report(&report, &Private::of_this_user())
    }
}
