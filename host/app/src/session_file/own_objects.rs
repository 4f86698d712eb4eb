//! Objects that no file of the user's holds: copies with other surfels, unions. Their surfels stand beside the session, in
//! PLY files of the folder `NAME.objects`, so that nothing is lost.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use glam::DAffine3;
use pointstage_scene::{Job, Object, PlyEncoding, Revision, SaveFormat, save};

use super::SUFFIX;

/// How the folder's name ends.
const FOLDER_SUFFIX: &str = ".objects";

/// An object and the file that its surfels go to.
#[derive(Clone, Debug)]
pub(crate) struct OwnObject {
    /// The object.
    pub(crate) object: Object,
    /// The file.
    pub(crate) file: PathBuf,
}

/// Which surfels the files hold that this process wrote. Clones share what is known.
#[derive(Clone, Debug, Default)]
pub(crate) struct OwnFiles(Arc<Mutex<BTreeMap<PathBuf, Revision>>>);

impl OwnFiles {
    /// Whether the object's file holds its surfels.
    pub(crate) fn hold(&self, object: &Object) -> bool {
        // A file may have been written since the object came from it.
        let is_file_of_another = object.source.as_ref().is_some_and(|file| {
            let known = self.lock().get(file).copied();
            known.is_some_and(|revision| revision != object.geometry.revision)
        });
        object.is_as_in_file() && !is_file_of_another
    }

    /// The file of `folder` that these surfels were written to.
    fn file_in(&self, folder: &Path, revision: Revision) -> Option<PathBuf> {
        let known = self.lock();
        let mut files = known.iter().filter(|(_, held)| **held == revision);
        files
            .find(|(file, _)| file.parent() == Some(folder) && file.is_file())
            .map(|(file, _)| file.clone())
    }

    /// Where each object goes that no file holds, for a session in the file `session`; those come first that are there
    /// already, and none takes a file that another object of the scene came from.
    pub(crate) fn places(&self, objects: &[Object], session: &Path) -> BTreeMap<u64, PathBuf> {
        let folder = objects_folder(session);
        let held = objects.iter().filter(|object| self.hold(object));
        let mut taken: BTreeSet<PathBuf> =
            held.filter_map(|object| object.source.clone()).collect();
        let own = || objects.iter().filter(|object| !self.hold(object));
        let mut places = BTreeMap::new();
        for object in own() {
            if let Some(file) = self.file_in(&folder, object.geometry.revision) {
                taken.insert(file.clone());
                places.insert(object.id.0, file);
            }
        }
        for object in own() {
            places.entry(object.id.0).or_insert_with(|| {
                let file = free_file(&folder, &object.name, &taken);
                taken.insert(file.clone());
                file
            });
        }
        places
    }

    /// Writes the surfels of an object, unless the file holds them.
    ///
    /// # Errors
    /// The folder or the file cannot be written; says which and why.
    pub(crate) fn write(&self, own: &OwnObject) -> Result<(), String> {
        let OwnObject { object, file } = own;
        let revision = object.geometry.revision;
        if self.lock().get(file) == Some(&revision) && file.is_file() {
            return Ok(());
        }
        if let Some(folder) = file.parent() {
            std::fs::create_dir_all(folder).map_err(|error| {
                format!(
                    "{}: the folder of the session's objects cannot be made: {error}; check its permissions",
                    folder.display()
                )
            })?;
        }
        // The session holds where it stands, and its radius scale.
        let in_place = Object {
            world_from_object: DAffine3::IDENTITY,
            radius_scale: 1.0,
            ..object.clone()
        };
        let format = SaveFormat::Ply(PlyEncoding::default());
        save(&in_place, file, format, &Job::new()).map_err(|error| error.to_string())?;
        self.lock().insert(file.clone(), revision);
        Ok(())
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, BTreeMap<PathBuf, Revision>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Whether a session wrote this file for an object.
pub(crate) fn is_own(file: &Path) -> bool {
    let folder = file.parent().and_then(Path::file_name);
    folder.is_some_and(|folder| folder.to_string_lossy().ends_with(FOLDER_SUFFIX))
}

/// The folder of the objects of a session file.
fn objects_folder(session: &Path) -> PathBuf {
    let name = session.file_name().unwrap_or_default().to_string_lossy();
    let stem = name.strip_suffix(SUFFIX).or(name.strip_suffix(".toml"));
    let folder = super::folder_of(session);
    folder.join(format!("{}{FOLDER_SUFFIX}", stem.unwrap_or(&name)))
}

/// A file of the folder, named after the object, that is not taken.
fn free_file(folder: &Path, name: &str, taken: &BTreeSet<PathBuf>) -> PathBuf {
    let is_plain = |c: char| c.is_alphanumeric() || matches!(c, '-' | '_' | ' ');
    let stem: String = name
        .chars()
        .map(|c| if is_plain(c) { c } else { '_' })
        .take(60)
        .collect();
    let stem = if stem.trim().is_empty() {
        "object"
    } else {
        stem.trim()
    };
    let first = folder.join(format!("{stem}.ply"));
    let others = (2..).map(|number: u64| folder.join(format!("{stem} {number}.ply")));
    let mut files = std::iter::once(first.clone()).chain(others);
    // As many names as numbers: one is free.
    files.find(|file| !taken.contains(file)).unwrap_or(first)
}

#[cfg(test)]
#[path = "own_objects_tests.rs"]
mod tests;
