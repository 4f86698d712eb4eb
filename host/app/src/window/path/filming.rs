//! Renders the pictures of a path one after the other, step by step between the window's own pictures.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use pointstage_engine::stage::{FrameRequest, Stage};
use pointstage_scene::{Job, ObjectId, Warnings};

use crate::camera_path::{FrameTimes, Track, Way, values_at};
use crate::output::export::{Export, ExportError, Exporting, Format};
use crate::output::{names, record};

/// What is filmed. Plain data.
pub(crate) struct Film {
    /// The picture as it is now, in the film's size.
    pub(crate) frame: FrameRequest,
    /// Where the camera is at each time; none if it stays.
    pub(crate) way: Option<Way>,
    /// What settings are at each time.
    pub(crate) tracks: Vec<Track>,
    /// When pictures are taken.
    pub(crate) times: FrameTimes,
    /// Where they go.
    pub(crate) path: PathBuf,
    /// In which form.
    pub(crate) format: Format,
    /// What loading each object gave to say.
    pub(crate) warnings: BTreeMap<ObjectId, Warnings>,
    /// The greatest side of a tile, px.
    pub(crate) most_tile_px: u32,
}

/// A film that is being rendered.
pub(crate) struct Filming {
    film: Film,
    /// How many pictures are there.
    done: u32,
    /// The one that is drawn, and its own progress.
    current: Option<(Exporting, Job)>,
}

impl Film {
    /// The file of a picture, from 0.
    pub(crate) fn file(&self, index: u32) -> PathBuf {
        file_of(&self.path, index, self.times.count)
    }

    fn export(&self, index: u32) -> Export {
        let time = self.times.at(index);
        let values = values_at(&self.tracks, time);
        let mut frame = self.frame.clone();
        if let Some(way) = &self.way {
            frame.camera = way.at(time);
        }
        frame.settings.extend(values.renderer);
        frame.structure_settings.extend(values.structure);
        let path = self.file(index);
        Export {
            record: record::of_frame(&frame, &self.warnings, &path),
            path,
            format: self.format,
            frame,
            targets: Vec::new(),
            most_tile_px: self.most_tile_px,
        }
    }
}

/// The file of picture `index` of a film of `count`.
pub(crate) fn file_of(path: &Path, index: u32, count: u32) -> PathBuf {
    names::for_frame(path, index as usize, count as usize)
}

impl Filming {
    /// Begins.
    pub(crate) fn new(film: Film) -> Self {
        Self {
            film,
            done: 0,
            current: None,
        }
    }

    /// How many pictures are there.
    pub(crate) fn done(&self) -> u32 {
        self.done
    }

    /// Lets go of a picture that is not whole.
    pub(crate) fn forget(&mut self) {
        self.current = None;
    }

    /// Does the next step, at most one frame. True when all pictures are there. After an error there is nothing more to do; what
    /// was rendered before it stays.
    pub(crate) fn step(&mut self, stage: &mut Stage, job: &Job) -> Result<bool, ExportError> {
        let count = self.film.times.count;
        let Some((exporting, own)) = &mut self.current else {
            job.check()?;
            let own = Job::new();
            let export = self.film.export(self.done);
            self.current = Some((Exporting::begin(export, own.clone())?, own));
            return Ok(false);
        };
        // One that is drawn is written to its end, so that what is counted is what is there.
        if job.is_cancelled() && !exporting.is_being_written() {
            own.cancel();
        }
        let saved = exporting.step(stage)?;
        let part = f64::from(self.done) + f64::from(own.progress());
        job.set_progress((part / f64::from(count)) as f32);
        job.set_stage(format!("picture {} of {count}", self.done + 1));
        if saved.is_some() {
            self.done += 1;
            self.current = None;
        }
        Ok(self.done == count)
    }
}
