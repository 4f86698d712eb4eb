//! One view: drawn by everybody, measured, written.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use image::{DynamicImage, RgbImage};
use pointstage_engine::metrics::{Measured, Regions, measure, silhouette};
use pointstage_engine::stage::{FrameRequest, FrameResult, Notice, Picture, Stage, ViewportId};
use pointstage_plugin_api::abi::Purpose;
use pointstage_scene::{ObjectId, Scene, ViewRecord, Warnings};
use serde_json::Value;

use super::CompareArguments;
use super::entries::Entry;
use super::reference::{self, Reference};
use super::report::{DrawnReference, Files, Found, FoundView, MeasuredBy, millis};
use crate::cli::{Failure, Outcome, drawing};
use crate::output::{names, png_file, record, whole_file};

/// Viewport of the reference.
const REFERENCE: ViewportId = ViewportId(0);

/// Viewport of the others. It is another one, so that a renderer that is its own reference starts anew, too.
const RENDERERS: ViewportId = ViewportId(1);

/// Side of the picture that is drawn before the one that counts, px: enough to make a renderer do all that it does once.
const FIRST_PX: u32 = 16;

/// What is the same for all views.
pub(super) struct Comparison<'a> {
    /// The command line.
    pub(super) arguments: &'a CompareArguments,
    /// What they are measured by.
    pub(super) reference: &'a Reference,
    /// Who is measured.
    pub(super) renderers: &'a [Entry],
    /// What is drawn.
    pub(super) scene: &'a Arc<Scene>,
    /// What loading each object gave to say.
    pub(super) warnings: &'a BTreeMap<ObjectId, Warnings>,
    /// Of the views.
    pub(super) count: usize,
}

impl Comparison<'_> {
    /// Draws, measures and writes view `index`.
    pub(super) fn view(
        &self,
        stage: &mut Stage,
        index: usize,
        view: &ViewRecord,
    ) -> Outcome<FoundView> {
        let (measure_by, reference) = self.measure_by(stage, index, view)?;
        let found = self.renderers.iter().map(|entry| {
            let request = self.request(entry, view);
            let (drawn, time) = draw(stage, entry, &request)?;
            let picture = rgb_of(&drawn.picture)?;
            let measured = measure(&measure_by.picture, &picture, &measure_by.regions)?;
            let record = |name: &str| self.record(stage, &request, name);
            let files = self.write_files(index, entry, &picture, &measured, record)?;
            Ok(Found {
                ms: millis(time),
                files,
                whole: measured.whole,
                interior: measured.interior,
                edge: measured.edge,
            })
        });
        Ok(FoundView {
            view: *view,
            found: found.collect::<Outcome<_>>()?,
            reference,
        })
    }

    /// What the renderers are measured by in view `index`.
    fn measure_by(
        &self,
        stage: &mut Stage,
        index: usize,
        view: &ViewRecord,
    ) -> Outcome<(MeasureBy, DrawnReference)> {
        let (entry, key) = match self.reference {
            Reference::Renderer { entry, silhouette } => (entry, *silhouette),
            Reference::Images { folder, background } => {
                let path = reference::image_path(folder, index, self.count);
                let picture = reference::read_image(&path)?;
                let covered = Some(reference::covered(&picture, *background));
                let drawn = DrawnReference {
                    ms: None,
                    picture: path.to_string_lossy().into_owned(),
                };
                return Ok((MeasureBy::new(picture, covered)?, drawn));
            }
        };
        let request = FrameRequest {
            viewport: REFERENCE,
            read_back: vec![key.to_owned()],
            ..self.request(entry, view)
        };
        let (drawn, time) = draw(stage, entry, &request)?;
        let covered = drawn.planes.get(key).map(silhouette);
        let measure_by = MeasureBy::new(rgb_of(&drawn.picture)?, covered)?;
        let name = self.name("reference", index, "");
        let record = self.record(stage, &request, &name);
        self.write(&name, &measure_by.picture, &record)?;
        let ms = Some(millis(time));
        Ok((measure_by, DrawnReference { ms, picture: name }))
    }

    /// Writes a renderer's picture and its maps. `record` says what the picture of a name is made from.
    fn write_files(
        &self,
        index: usize,
        entry: &Entry,
        picture: &RgbImage,
        measured: &Measured,
        record: impl Fn(&str) -> Value,
    ) -> Outcome<Files> {
        let name = |what: &str| self.name(&entry.label, index, what);
        let files = Files {
            picture: name(""),
            flip: measured.flip_map.as_ref().map(|_| name("_flip")),
            difference: name("_difference"),
        };
        let record = record(&files.picture);
        self.write(&files.picture, picture, &record)?;
        let of_map = self.record_of_map(&record, "difference")?;
        self.write(&files.difference, &measured.difference_map, &of_map)?;
        if let (Some(name), Some(map)) = (&files.flip, &measured.flip_map) {
            self.write(name, map, &self.record_of_map(&record, "flip")?)?;
        }
        Ok(files)
    }

    /// Name of a file of view `index`.
    fn name(&self, label: &str, index: usize, what: &str) -> String {
        format!("{label}_{}{what}.png", names::number(index, self.count))
    }

    /// What one of them is asked for; all else is the same for everybody.
    fn request(&self, entry: &Entry, view: &ViewRecord) -> FrameRequest {
        FrameRequest {
            viewport: RENDERERS,
            settings: entry.settings.clone(),
            background: self.arguments.background,
            exposure: self.arguments.exposure,
            radius_scale: self.arguments.radius_scale,
            purpose: Purpose::COMPARE,
            ..FrameRequest::still(
                Arc::clone(self.scene),
                view.camera(),
                [view.width, view.height],
                entry.id.clone(),
            )
        }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.arguments.out.join(name)
    }

    /// What a picture is made from, so that it can be made again.
    fn record(&self, stage: &Stage, request: &FrameRequest, name: &str) -> Value {
        let mut record = record::of_frame(request, self.warnings, &self.path(name));
        record::add_drawer(&mut record, stage, &request.renderer);
        record
    }

    /// The same for a map: what the picture is made from that it belongs to, and what it was measured by.
    fn record_of_map(&self, record: &Value, map: &str) -> Outcome<Value> {
        let mut record = record.clone();
        record["map"] = map.into();
        record["reference"] = serde_json::to_value(MeasuredBy::of(self.reference))?;
        Ok(record)
    }

    fn write(&self, name: &str, picture: &RgbImage, record: &Value) -> Outcome {
        let size_px = picture.dimensions().into();
        let rgba = DynamicImage::ImageRgb8(picture.clone()).into_rgba8();
        let bytes = png_file::encode(size_px, &rgba, record)?;
        let path = self.path(name);
        whole_file::write(&path, &bytes)?;
        tracing::info!("written {}", path.display());
        Ok(())
    }
}

/// What one view's pictures are measured by.
struct MeasureBy {
    picture: RgbImage,
    regions: Regions,
}

impl MeasureBy {
    fn new(picture: RgbImage, covered: Option<Vec<bool>>) -> Outcome<Self> {
        let size_px = picture.dimensions().into();
        let regions = covered.and_then(|covered| Regions::new(size_px, &covered));
        let regions = regions.ok_or_else(|| {
            Failure::Failed(anyhow::anyhow!(
                "the reference did not say which pixels it covers; choose another reference"
            ))
        })?;
        Ok(Self { picture, regions })
    }
}

/// Draws as one of them, with the wall time of all frames until the picture was finished.
///
/// A small picture is drawn first: what is prepared for a scene, compiled or uploaded at first use is no part of that time.
/// Drawing the picture itself twice would not do, since a renderer that refines has the second one finished already.
fn draw(
    stage: &mut Stage,
    entry: &Entry,
    request: &FrameRequest,
) -> Outcome<(FrameResult, Duration)> {
    let first = FrameRequest {
        size_px: [FIRST_PX; 2],
        ..request.clone()
    };
    let mut draw = |request| -> Outcome<_> {
        let (result, time) = drawing::draw_in_silence(stage, request)?;
        check_drawer(&entry.id, &result.drawn_by, &result.notices)?;
        result.notices.iter().for_each(drawing::say);
        Ok((result, time))
    };
    draw(&first)?;
    draw(request)
}

/// Fails if another renderer stood in: its picture would be measured under a wrong name.
fn check_drawer(asked: &str, drawn_by: &str, notices: &[Notice]) -> Outcome {
    if drawn_by == asked {
        return Ok(());
    }
    let said: Vec<&str> = notices.iter().map(|notice| notice.text.as_str()).collect();
    Err(Failure::Failed(anyhow::anyhow!(
        "renderer '{asked}' did not draw, '{drawn_by}' stood in for it, so nothing is compared: {}",
        said.join("; ")
    )))
}

/// A picture without its alpha: over an opaque background there is nothing in it.
fn rgb_of(picture: &Picture) -> Outcome<RgbImage> {
    let [width, height] = picture.size_px;
    let rgb = picture.rgba.chunks_exact(4).flat_map(|pixel| &pixel[..3]);
    RgbImage::from_raw(width, height, rgb.copied().collect()).ok_or_else(|| {
        Failure::Failed(anyhow::anyhow!(
            "a picture of {width}×{height} pixels has only {} bytes; please report this",
            picture.rgba.len()
        ))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use pointstage_engine::stage::Severity;

    #[test]
    fn a_stand_in_is_a_failure_with_the_reason() {
        let notice = Notice {
            severity: Severity::Error,
            plugin: "a".to_owned(),
            text: "out of memory".to_owned(),
            detail: String::new(),
        };
        check_drawer("a", "a", std::slice::from_ref(&notice)).expect("it drew itself");
        match check_drawer("a", "b", &[notice]) {
            Err(Failure::Failed(error)) => {
                let text = error.to_string();
                assert!(text.contains("'a' did not draw, 'b' stood in"), "{text}");
                assert!(text.contains("out of memory"), "{text}");
            }
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn a_picture_loses_its_alpha_and_keeps_its_colours() {
        let picture = |bytes: &[u8]| Picture {
            size_px: [1, 2],
            rgba: bytes.into(),
        };
        let rgb = rgb_of(&picture(&[1, 2, 3, 255, 4, 5, 6, 255])).expect("whole");
        assert_eq!(rgb.into_raw(), [1, 2, 3, 4, 5, 6]);
        rgb_of(&picture(&[1, 2, 3, 255])).expect_err("one pixel is missing");
    }
}
