//! An object into a file, on the worker.

use std::path::{Path, PathBuf};
use std::time::Instant;

use pointstage_engine::stage::Severity;
use pointstage_scene::{ObjectId, SaveError, SaveFormat, Saved, save};

use crate::window::app::App;
use crate::window::dialogs::{PathField, object_path};
use crate::window::intent::Overwrite;
use crate::window::loading::Finished;
use crate::window::tasks::guarded;

/// A file that an object was written to.
#[derive(Debug)]
pub(crate) struct ObjectSaved {
    path: PathBuf,
    saved: Saved,
}

impl App {
    /// Asks where the active object goes.
    pub(super) fn ask_for_object_file(&mut self) {
        let Some(object) = self.session.active_object() else {
            let text = "No object is selected: click on its name in the Scene tab.";
            self.log.say(Severity::Info, text, Instant::now());
            return;
        };
        let folder = object.source.as_deref().and_then(Path::parent);
        let folder = folder
            .map(Path::to_path_buf)
            .or_else(|| etcetera::home_dir().ok())
            .unwrap_or_default();
        let path = folder.join(format!("{}.ply", object.name.replace(['/', '\\'], "_")));
        let path = std::path::absolute(&path).unwrap_or(path);
        self.path_field = Some(PathField::save_object(object.id, &path));
    }

    /// Has an object written, unless that would replace a file without the user's word.
    pub(super) fn save_object(&mut self, id: ObjectId, path: PathBuf, overwrite: Overwrite) {
        let path = object_path(path);
        let Some(object) = self.session.scene.object(id).cloned() else {
            let text = "The object is not there any more: nothing was saved.";
            self.log.say(Severity::Warning, text, Instant::now());
            return;
        };
        if overwrite == Overwrite::Ask && path.exists() {
            self.path_field = Some(PathField::replace_object(id, &path));
            return;
        }
        let Some(format) = SaveFormat::of_name(&path) else {
            let text = format!(
                "{}: expected a name that ends in .ply or .sfl",
                path.display()
            );
            self.log.error(text, Instant::now());
            return;
        };
        let title = format!("Save {}", object.name);
        self.tasks.push(title, move |job| {
            guarded(
                || match save(&object, &path, format, job) {
                    Ok(saved) => Finished::ObjectSaved(Box::new(ObjectSaved {
                        path: path.clone(),
                        saved,
                    })),
                    Err(SaveError::Cancelled(_)) => {
                        Finished::Stopped(format!("{}: saving cancelled", path.display()))
                    }
                    Err(error) => Finished::Failed(error.to_string()),
                },
                |panic| {
                    Finished::Failed(format!(
                        "{}: saving has a defect and stopped ({panic}); please report it",
                        path.display()
                    ))
                },
            )
        });
    }

    /// Says where the object is, and what its file does not hold.
    pub(in crate::window) fn tell_of_saved_object(&mut self, saved: &ObjectSaved) {
        let (now, path) = (Instant::now(), saved.path.display());
        for warning in saved.saved.warnings.iter() {
            self.log
                .say(Severity::Warning, format!("{path}: {warning}"), now);
        }
        let names = saved
            .saved
            .pictures
            .iter()
            .filter_map(|file| file.file_name());
        let names: Vec<_> = names.map(|name| name.to_string_lossy()).collect();
        let text = if names.is_empty() {
            format!("{path} is saved")
        } else {
            format!(
                "{path} is saved, and its textures beside it: {}",
                names.join(", ")
            )
        };
        self.log.say(Severity::Info, text, now);
    }
}
