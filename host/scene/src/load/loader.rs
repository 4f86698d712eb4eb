//! What a loader is: a format's name, its look, and how to read it.

use std::fmt::Debug;
use std::ops::Range;
use std::path::{Path, PathBuf};

use glam::{DAffine3, DVec3};
pub use pointstage_plugin_api::loading::{Claim, FileStart, START_BYTES};

use pointstage_plugin_api::settings_schema::SettingSchema;

use super::LoadOptions;
use super::error::LoadStop;
use super::source::Source;
use crate::geometry::Geometry;
use crate::job::Job;
use crate::warnings::Warnings;

/// A loader of one file format: built in, or a plugin's.
pub trait Loader: Send + Sync + Debug {
    /// Its names and options.
    fn info(&self) -> &LoaderInfo;

    /// How sure it is that the file is its own. Cheap: it is asked about every file.
    fn claims(&self, start: &FileStart<'_>) -> Claim;

    /// Reads the file. Thread: any; reports to `job` and stops within 200 ms once that is cancelled.
    ///
    /// # Errors
    /// The file says something that cannot be, with the place in the file; or the job was cancelled.
    fn load(
        &self,
        file: &SourceFile,
        options: &LoadOptions,
        job: &Job,
    ) -> Result<Contents, LoadStop>;
}

/// Names and options of a loader.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LoaderInfo {
    /// Reverse-domain name: `org.pointstage.ply`.
    pub id: String,
    /// Short name for command lines: `ply`.
    pub alias: String,
    /// The format's name for people.
    pub title: String,
    /// Extensions of its files, lower case, without the dot.
    pub extensions: Vec<String>,
    /// Its own options, for [`LoaderChoice::settings`](super::LoaderChoice::settings).
    pub settings: Vec<SettingSchema>,
}

impl LoaderInfo {
    /// That of a loader that comes with the program.
    pub(super) fn built_in(alias: &str, title: &str, extensions: &[&str]) -> Self {
        Self {
            id: format!("org.pointstage.{alias}"),
            alias: alias.to_owned(),
            title: title.to_owned(),
            extensions: extensions.iter().map(ToString::to_string).collect(),
            settings: Vec::new(),
        }
    }

    /// Whether its files have this extension; lower case, without the dot.
    pub fn has_extension(&self, extension: &str) -> bool {
        self.extensions.iter().any(|own| own == extension)
    }
}

/// A file that is being loaded: its path and its bytes, mapped into memory.
#[derive(Debug)]
pub struct SourceFile {
    path: PathBuf,
    source: Source,
}

impl SourceFile {
    /// Maps a regular file.
    ///
    /// # Errors
    /// It is not there, may not be read, or is no regular file.
    pub fn open(path: &Path) -> std::io::Result<Self> {
        Ok(Self {
            path: path.to_path_buf(),
            source: Source::open(path)?,
        })
    }

    /// Where it is, for files that it names beside itself.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Its bytes. They may change under the reader if somebody writes the file meanwhile; their number does not.
    pub fn bytes(&self) -> &[u8] {
        &self.source
    }

    /// The map itself, which can be told what has been read.
    pub(super) fn source(&self) -> &Source {
        &self.source
    }

    /// Its name, without the folder.
    pub(super) fn name(&self) -> String {
        let name = self.path.file_name().unwrap_or_default();
        name.to_string_lossy().into_owned()
    }

    /// Tells the system that the bytes have been read, so that they no longer count as our memory.
    pub fn release(&self) {
        self.release_range(0..self.source.len());
    }

    /// The same of some of the bytes. They can be read again; a range beyond the end is without effect.
    pub fn release_range(&self, range: Range<usize>) {
        self.source.release(range);
    }
}

/// What a loader made of a file.
#[derive(Debug)]
pub struct Contents {
    /// What the columns' positions are relative to.
    pub origin: DVec3,
    /// Where the object stands, if the file says so: `world = world_from_object · (origin + local)`.
    pub world_from_object: DAffine3,
    /// The surfels, and triangles if it is a mesh.
    pub geometry: Geometry,
    /// What was done, but not as asked.
    pub warnings: Warnings,
}
