//! Carries out intents about files.

use std::path::PathBuf;
use std::time::Instant;

use pointstage_scene::LoadOptions;

use crate::window::app::App;
use crate::window::dialogs::{FileDialog, PathField};
use crate::window::intent::{FileIntent, OpenMode};
use crate::window::loading::{Batch, Place, load_file};

impl App {
    pub(super) fn apply_file(&mut self, intent: FileIntent) {
        match intent {
            FileIntent::Choose(mode) => self.choose_files(mode),
            FileIntent::TypePath(mode) => self.path_field = Some(PathField::new(mode)),
            FileIntent::Open(files, mode) => {
                self.dialog = None;
                self.open(files, mode);
            }
            FileIntent::Cancel(task) => self.tasks.cancel(task),
        }
    }

    /// Puts the loading of files into the queue.
    pub(in crate::window) fn open(&mut self, files: Vec<PathBuf>, mode: OpenMode) {
        let batch = Batch(self.next_batch);
        self.next_batch += 1;
        for path in files {
            self.push_load(
                path,
                LoadOptions::default(),
                Place::New(batch, mode),
                "Load",
            );
        }
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
        self.tasks
            .push(title, move |job| load_file(&path, options, place, job));
    }

    fn choose_files(&mut self, mode: OpenMode) {
        match FileDialog::open(mode, self.wake.clone()) {
            Ok(dialog) => self.dialog = Some(dialog),
            Err(error) => self.log.error(
                format!("No file dialog can be opened ({error}); use File, Open path… instead."),
                Instant::now(),
            ),
        }
    }
}
