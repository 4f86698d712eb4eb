//! Bands of rows become a PNG file on a thread of its own, while the next tiles are drawn.

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::JoinHandle;

use pointstage_engine::stage::Picture;
use pointstage_scene::Cancelled;

use super::ExportError;
use super::tiling::Place;
use super::writer;
use crate::output::png_file::{self, Alpha, PngError};
use crate::output::whole_file::{PartFile, WriteError};

/// What the writer gets.
enum Message {
    /// The next rows, as in the file.
    Rows(Vec<u8>),
    /// All rows have come.
    End,
}

/// A PNG file in the making.
pub(super) struct PngRows {
    image_width: usize,
    alpha: Alpha,
    band: Vec<u8>,
    shared: Arc<Shared>,
    /// None after the end.
    rows: Option<Sender<Message>>,
    writer: Option<JoinHandle<Result<(), ExportError>>>,
}

#[derive(Default)]
struct Shared {
    /// Bands that are not written yet.
    waiting: AtomicUsize,
    /// Whether nobody wants the file any more.
    given_up: AtomicBool,
}

/// What the writer works on.
struct Writer {
    part: PartFile,
    path: PathBuf,
    size_px: [u32; 2],
    alpha: Alpha,
    record: serde_json::Value,
    shared: Arc<Shared>,
}

impl PngRows {
    /// Begins the file. `part` is it; `path` is for messages.
    pub(super) fn begin(
        part: PartFile,
        path: &Path,
        size_px: [u32; 2],
        alpha: Alpha,
        record: serde_json::Value,
    ) -> Result<Self, ExportError> {
        let shared = Arc::new(Shared::default());
        let (rows, messages) = channel();
        let writer = Writer {
            part,
            path: path.to_owned(),
            size_px,
            alpha,
            record,
            shared: Arc::clone(&shared),
        };
        let writer = std::thread::Builder::new()
            .name("save image".into())
            .spawn(move || writer.write(&messages))
            .map_err(|error| ExportError::Writer(format!("no thread: {error}")))?;
        Ok(Self {
            image_width: size_px[0] as usize,
            alpha,
            band: Vec::new(),
            shared,
            rows: Some(rows),
            writer: Some(writer),
        })
    }

    /// Whether the writer has enough to do: another band would only fill the memory.
    pub(super) fn is_behind(&self) -> bool {
        let is_alive = self
            .writer
            .as_ref()
            .is_some_and(|writer| !writer.is_finished());
        is_alive && self.shared.waiting.load(Ordering::Relaxed) > 1
    }

    /// Puts a tile into its band, and sends the band off with its last tile.
    pub(super) fn take_tile(&mut self, place: &Place, picture: &Picture) {
        let channels = self.alpha.channels();
        let row_bytes = self.image_width * channels;
        let [width, height] = place.size_px.map(|side| side as usize);
        // All tiles of a band have the same height.
        self.band.resize(row_bytes * height, 0);
        let left = place.origin_px[0] as usize * channels;
        let rows = picture.rgba.chunks_exact(width * 4);
        for (into, from) in self.band.chunks_exact_mut(row_bytes).zip(rows) {
            let into = into[left..left + width * channels].chunks_exact_mut(channels);
            for (into, from) in into.zip(from.chunks_exact(4)) {
                into.copy_from_slice(&from[..channels]);
            }
        }
        if place.ends_band {
            let rows = std::mem::take(&mut self.band);
            self.send(Message::Rows(rows));
        }
    }

    /// Says that all tiles have come.
    pub(super) fn end(&mut self) {
        self.send(Message::End);
        self.rows = None;
    }

    /// Whether the file is in its place; an error if it cannot be.
    pub(super) fn poll(&mut self) -> Result<bool, ExportError> {
        writer::poll(&mut self.writer)
    }

    fn send(&self, message: Message) {
        self.shared.waiting.fetch_add(1, Ordering::Relaxed);
        if let Some(rows) = &self.rows {
            // A writer that has failed tells so through `poll`.
            let _ = rows.send(message);
        }
    }
}

impl Drop for PngRows {
    /// Gives the file up unless it is in its place, and waits until nothing is left of it.
    fn drop(&mut self) {
        self.shared.given_up.store(true, Ordering::Relaxed);
        self.rows = None;
        if let Some(writer) = self.writer.take() {
            // Whatever it came to, nobody wants it any more.
            let _ = writer.join();
        }
    }
}

impl Writer {
    fn write(self, messages: &Receiver<Message>) -> Result<(), ExportError> {
        let Self {
            part,
            path,
            size_px,
            alpha,
            record,
            shared,
        } = self;
        let at = |error: PngError| match error.into_io() {
            Ok(source) => WriteError::new(&path, source).into(),
            Err(error) => ExportError::from(error),
        };
        let encoding = |error: png::EncodingError| at(error.into());
        let row_bytes = size_px[0] as usize * alpha.channels();
        let mut file = png_file::begin(&part.file, size_px, alpha, &record).map_err(at)?;
        let mut stream = file.stream_writer().map_err(encoding)?;
        let mut has_ended = false;
        for message in messages {
            let Message::Rows(rows) = message else {
                has_ended = true;
                break;
            };
            for row in rows.chunks(row_bytes) {
                if shared.given_up.load(Ordering::Relaxed) {
                    return Err(Cancelled.into());
                }
                stream
                    .write_all(row)
                    .map_err(|source| WriteError::new(&path, source))?;
            }
            shared.waiting.fetch_sub(1, Ordering::Relaxed);
        }
        if !has_ended || shared.given_up.load(Ordering::Relaxed) {
            return Err(Cancelled.into());
        }
        stream.finish().map_err(encoding)?;
        file.finish().map_err(encoding)?;
        Ok(part.commit()?)
    }
}
