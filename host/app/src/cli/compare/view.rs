//! One view: drawn by everybody, measured, written.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use image::{DynamicImage, RgbImage};
use pointstage_engine::metrics::{Measured, Regions, measure, silhouette};
use pointstage_engine::stage::{FrameRequest, FrameResult, Picture, Show, Stage, ViewportId};
use pointstage_plugin_api::abi::Purpose;
use pointstage_scene::{ObjectId, Scene, ViewRecord, Warnings};
use serde_json::Value;

use super::arguments::ComparisonArguments;
use super::reference::{self, Reference};
use super::report::{DrawnReference, Files, Found, FoundView, MeasuredBy};
use super::targets::Targets;
use crate::cli::drawing::Cost;
use crate::cli::measuring::entries::Entry;
use crate::cli::measuring::times::{draw, millis};
use crate::cli::{Failure, Outcome};
use crate::output::{names, png_file, record, whole_file};

/// Viewport of the reference.
const REFERENCE: ViewportId = ViewportId(0);

/// Viewport of the others. It is another one, so that a renderer that is its own reference starts anew, too.
const RENDERERS: ViewportId = ViewportId(1);

/// Side of the picture that is drawn before the one that counts, px: enough to make a renderer do all that it does once.
const FIRST_PX: u32 = 16;

/// A renderer whose picture takes longer is timed by that picture alone, ms.
const SLOW_MS: f64 = 2000.0;

/// Turn of the eye from one timed picture to the next, radians: a pixel or less, so that each costs the same.
const TURN_RAD: f64 = 1e-3;

/// Values at the dark and the bright end of targets, by key.
type Ranges = BTreeMap<String, [f32; 2]>;

/// What is the same for all views.
pub(super) struct Comparison<'a> {
    /// The command line.
    pub(super) arguments: &'a ComparisonArguments,
    /// What they are measured by.
    pub(super) reference: &'a Reference,
    /// Who is measured.
    pub(super) renderers: &'a [Entry],
    /// What is drawn beside pictures.
    pub(super) targets: &'a Targets,
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
        let mut found = Vec::new();
        for entry in self.renderers {
            let request = self.request(entry, view);
            let (drawn, cost) = draw_warm(stage, &request)?;
            let picture = rgb_of(&drawn.picture)?;
            let measured = measure(&measure_by.picture, &picture, &measure_by.regions)?;
            let record = |name: &str| self.record(stage, &request, name);
            let mut files = self.write_files(index, entry, &picture, &measured, record)?;
            let ranges = &reference.ranges;
            let label = &entry.label;
            files.targets = self
                .write_targets(stage, index, (label, entry), &request, ranges)?
                .0;
            found.push(Found {
                ms: millis(cost.wall),
                costs: vec![cost],
                files,
                whole: measured.whole,
                interior: measured.interior,
                edge: measured.edge,
            });
        }
        self.time(stage, view, &mut found)?;
        Ok(FoundView {
            view: *view,
            found,
            reference,
        })
    }

    /// Times every renderer in turns, so that a machine that slows down is fair to all. The eye is turned a little from
    /// picture to picture, so that nobody can show the last one again.
    fn time(&self, stage: &mut Stage, view: &ViewRecord, found: &mut [Found]) -> Outcome {
        let mut timed: Vec<Vec<Cost>> = vec![Vec::new(); found.len()];
        let mut turns = 0_u32;
        for _ in 0..self.arguments.frames {
            for ((entry, found), timed) in self.renderers.iter().zip(&*found).zip(&mut timed) {
                if found.ms > SLOW_MS {
                    continue;
                }
                let mut request = self.request(entry, view);
                // The first one pays for the change of renderers.
                let mut cost = Cost::default();
                for _ in 0..2 {
                    turns += 1;
                    let yaw_rad = f64::from(turns) * TURN_RAD;
                    request.camera = view.camera();
                    request.camera.orbit_turntable(yaw_rad, 0.0);
                    cost = draw(stage, &request)?.1;
                }
                timed.push(cost);
            }
        }
        for (found, timed) in found.iter_mut().zip(timed) {
            if !timed.is_empty() {
                found.costs = timed;
            }
        }
        Ok(())
    }

    /// Draws and writes the targets of one of them; the files by key, and the ranges of values that they show.
    ///
    /// * `who`: the name for files, and who draws.
    /// * `ranges`: those that the reference showed, so that the same colour means the same.
    fn write_targets(
        &self,
        stage: &mut Stage,
        index: usize,
        (label, entry): (&str, &Entry),
        request: &FrameRequest,
        ranges: &Ranges,
    ) -> Outcome<(BTreeMap<String, String>, Ranges)> {
        let (mut files, mut shown) = (BTreeMap::new(), BTreeMap::new());
        for key in self.targets.of(entry) {
            let request = FrameRequest {
                show: Show::Target(key.to_owned()),
                shown_range: ranges.get(key).copied(),
                read_back: Vec::new(),
                ..request.clone()
            };
            let (drawn, _) = draw(stage, &request)?;
            let name = self.name(label, index, &format!("_{}", safe(key)));
            let record = self.record(stage, &request, &name);
            self.write(&name, &rgb_of(&drawn.picture)?, &record)?;
            files.insert(key.to_owned(), name);
            if let Some(range) = drawn.shown_range {
                shown.insert(key.to_owned(), range);
            }
        }
        Ok((files, shown))
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
                    targets: BTreeMap::new(),
                    ranges: BTreeMap::new(),
                };
                return Ok((MeasureBy::new(picture, covered)?, drawn));
            }
        };
        let request = FrameRequest {
            viewport: REFERENCE,
            read_back: vec![key.to_owned()],
            ..self.request(entry, view)
        };
        let (drawn, cost) = draw_warm(stage, &request)?;
        let covered = drawn.planes.get(key).map(silhouette);
        let measure_by = MeasureBy::new(rgb_of(&drawn.picture)?, covered)?;
        let name = self.name("reference", index, "");
        let record = self.record(stage, &request, &name);
        self.write(&name, &measure_by.picture, &record)?;
        let none = BTreeMap::new();
        let (targets, ranges) =
            self.write_targets(stage, index, ("reference", entry), &request, &none)?;
        let drawn = DrawnReference {
            ms: Some(millis(cost.wall)),
            picture: name,
            targets,
            ranges,
        };
        Ok((measure_by, drawn))
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
            targets: BTreeMap::new(),
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
            background: self.arguments.look.background,
            exposure: self.arguments.look.exposure,
            radius_scale: self.arguments.look.radius_scale,
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
        record["reference"] = serde_json::to_value(MeasuredBy::of(self.reference)?)?;
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

/// Draws as one of them, with what all frames until the picture was finished cost.
///
/// A small picture is drawn first: what is prepared for a scene, compiled or uploaded at first use is no part of that cost.
/// Drawing the picture itself twice would not do, since a renderer that refines has the second one finished already.
fn draw_warm(stage: &mut Stage, request: &FrameRequest) -> Outcome<(FrameResult, Cost)> {
    let first = FrameRequest {
        size_px: [FIRST_PX; 2],
        read_back: Vec::new(),
        ..request.clone()
    };
    draw(stage, &first)?;
    draw(stage, request)
}

/// A target's key as a part of a file's name, other than those of maps.
fn safe(key: &str) -> String {
    let letters = key.chars().map(|letter| match letter {
        'a'..='z' | 'A'..='Z' | '0'..='9' | '_' | '.' => letter,
        _ => '-',
    });
    let name: String = letters.take(40).collect();
    match name.as_str() {
        "flip" | "difference" => format!("{name}-target"),
        _ => name,
    }
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
