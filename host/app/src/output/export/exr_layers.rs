//! Targets gathered tile by tile, and then written as the layers of one EXR file, on a thread of its own.

use std::fs::File;
use std::io::{Seek, SeekFrom, Write};
use std::path::PathBuf;
use std::thread::JoinHandle;

use exr::prelude::FlatSamples;
use pointstage_engine::stage::Plane;
use pointstage_scene::{Job, ViewRecord};

use super::ExportError;
use super::tiling::Place;
use super::writer;
use crate::output::exr_file::{self, ExrError, LayerSamples};
use crate::output::file_values;
use crate::output::whole_file::{PartFile, WriteError};

/// Bytes that the values of one file may take in memory.
pub(super) const MOST_BYTES: u64 = 4 << 30;

/// An EXR file in the making.
pub(super) struct ExrLayers {
    size_px: [u32; 2],
    layers: Vec<LayerSamples>,
    file: Option<(PartFile, PathBuf, serde_json::Value)>,
    writer: Option<JoinHandle<Result<(), ExportError>>>,
    job: Job,
}

impl ExrLayers {
    /// Begins the file. `part` is it; `path` is for messages.
    pub(super) fn begin(
        part: PartFile,
        path: PathBuf,
        size_px: [u32; 2],
        record: serde_json::Value,
        job: Job,
    ) -> Self {
        Self {
            size_px,
            layers: Vec::new(),
            file: Some((part, path, record)),
            writer: None,
            job,
        }
    }

    /// Puts a tile of the target `key` into its layer.
    pub(super) fn take_plane(
        &mut self,
        place: &Place,
        key: &str,
        plane: &Plane,
        view: &ViewRecord,
    ) {
        let plane = file_values::for_file(key, plane, view);
        let [image_width, image_height] = self.size_px.map(|side| side as usize);
        let pixel_count = image_width * image_height;
        let known = self.layers.iter().position(|layer| layer.key == key);
        let index = known.unwrap_or_else(|| {
            self.layers.push(LayerSamples {
                key: key.to_owned(),
                channels: match &plane {
                    Plane::Uint(_) => vec![FlatSamples::U32(vec![0; pixel_count])],
                    Plane::Float { channels, .. } => (0..*channels)
                        .map(|_| FlatSamples::F32(vec![0.0; pixel_count]))
                        .collect(),
                },
            });
            self.layers.len() - 1
        });
        let [left, top] = place.origin_px.map(|at| at as usize);
        let [width, height] = place.size_px.map(|side| side as usize);
        let count = self.layers[index].channels.len();
        for (channel, samples) in self.layers[index].channels.iter_mut().enumerate() {
            for row in 0..height {
                let start = (top + row) * image_width + left;
                let span = start..start + width;
                match (&mut *samples, &plane) {
                    (FlatSamples::U32(into), Plane::Uint(from)) => {
                        into[span].copy_from_slice(&from[row * width..][..width]);
                    }
                    (FlatSamples::F32(into), Plane::Float { values, .. }) => {
                        let from = values[row * width * count..].iter();
                        let from = from.skip(channel).step_by(count);
                        into[span]
                            .iter_mut()
                            .zip(from)
                            .for_each(|(into, from)| *into = *from);
                    }
                    // A target does not change its kind from tile to tile.
                    _ => {}
                }
            }
        }
    }

    /// Says that all tiles have come, and begins to write.
    pub(super) fn end(&mut self) -> Result<(), ExportError> {
        let Some((part, path, record)) = self.file.take() else {
            return Ok(());
        };
        let (layers, size_px) = (std::mem::take(&mut self.layers), self.size_px);
        let job = self.job.clone();
        let write = move || {
            let file = Watched {
                file: &part.file,
                job: &job,
            };
            let written = exr_file::write_layers(file, size_px, layers, Some(&record), |_| ());
            // Whatever the library makes of the error that stopped it.
            job.check()?;
            match written {
                Ok(()) => Ok(part.commit()?),
                Err(ExrError::Encode(exr::error::Error::Io(source))) => {
                    Err(WriteError::new(&path, source).into())
                }
                Err(error) => Err(error.into()),
            }
        };
        let writer = std::thread::Builder::new()
            .name("save image".into())
            .spawn(write)
            .map_err(|error| ExportError::Writer(format!("no thread: {error}")))?;
        self.writer = Some(writer);
        Ok(())
    }

    /// Whether the file is in its place; an error if it cannot be.
    pub(super) fn poll(&mut self) -> Result<bool, ExportError> {
        writer::poll(&mut self.writer)
    }
}

impl Drop for ExrLayers {
    /// Waits until nothing is left of a file that nobody wants any more.
    fn drop(&mut self) {
        if let Some(writer) = self.writer.take() {
            self.job.cancel();
            // Whatever it came to, nobody wants it any more.
            let _ = writer.join();
        }
    }
}

/// A file that takes no more once its job is cancelled.
struct Watched<'a> {
    file: &'a File,
    job: &'a Job,
}

impl Write for Watched<'_> {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.job.check().map_err(std::io::Error::other)?;
        self.file.write(bytes)
    }

    fn flush(&mut self) -> std::io::Result<()> {
        self.file.flush()
    }
}

impl Seek for Watched<'_> {
    fn seek(&mut self, position: SeekFrom) -> std::io::Result<u64> {
        self.file.seek(position)
    }
}
