//! Images that are saved by the built-in renderer, without a device.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use exr::prelude::{FlatSamples, ReadChannels as _, ReadLayers as _};
use glam::{DVec3, Vec3};
use pointstage_engine::stage::{
    Background, FALLBACK_ID, FrameRequest, Plane, Show, Stage, StageOptions,
};
use pointstage_plugin_api::columns::encode_normal;
use pointstage_scene::{Block, Camera, Geometry, Job, Object, Origins, Scene, ViewRecord};

use super::{Export, ExportError, Exporting, Format, Saved};
use crate::output::{file_values, record};

/// Not a multiple of any tile.
const SIZE_PX: [u32; 2] = [300, 170];

fn stage() -> Stage {
    let options = StageOptions {
        use_device: false,
        ..StageOptions::default()
    };
    Stage::new(options).expect("a stage without a device")
}

/// A wavy sheet of surfels before a gradient.
fn frame() -> FrameRequest {
    let places = (0..2500).map(|index| {
        let (x, y) = (
            (index % 50) as f32 * 0.04 - 1.0,
            (index / 50) as f32 * 0.04 - 1.0,
        );
        [x, y, 0.3 * (4.0 * x).sin(), 0.05]
    });
    let position_radius: Arc<[[f32; 4]]> = places.collect();
    let normals = position_radius.iter().map(|_| encode_normal(Vec3::Z));
    let block = Block {
        normal: Some(normals.collect()),
        position_radius,
        ..Block::default()
    };
    let mut scene = Scene::new();
    let geometry = Geometry::new(vec![block], None, Origins::default());
    scene.add(Object::new("sheet", DVec3::ZERO, geometry));
    FrameRequest {
        background: Background::Gradient([0.8, 0.1, 0.2], [0.1, 0.3, 0.9]),
        ..FrameRequest::still(Arc::new(scene), Camera::default(), SIZE_PX, FALLBACK_ID)
    }
}

fn export(path: &Path, frame: FrameRequest, most_tile_px: u32) -> Export {
    Export {
        path: path.to_owned(),
        format: Format::of(path).expect("png or exr"),
        record: record::of_frame(&frame, &BTreeMap::new(), path),
        frame,
        targets: Vec::new(),
        most_tile_px,
    }
}

fn save(stage: &mut Stage, export: Export, job: &Job) -> Result<Saved, ExportError> {
    let mut exporting = Exporting::begin(export, job.clone())?;
    loop {
        if let Some(saved) = exporting.step(stage)? {
            return Ok(saved);
        }
    }
}

/// Channels of a pixel, all bytes, and the record.
fn read_png(path: &Path) -> (usize, Vec<u8>, serde_json::Value) {
    let file = std::io::BufReader::new(std::fs::File::open(path).expect("readable"));
    let mut reader = png::Decoder::new(file).read_info().expect("a PNG");
    let mut pixels = vec![0; reader.output_buffer_size().expect("small")];
    reader.next_frame(&mut pixels).expect("one frame");
    let text = reader.info().utf8_text[0].get_text().expect("UTF-8");
    (
        reader.info().color_type.samples(),
        pixels,
        serde_json::from_str(&text).expect("JSON"),
    )
}

fn files_in(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).expect("listable");
    entries
        .map(|entry| {
            let name = entry.expect("an entry").file_name();
            name.to_string_lossy().into_owned()
        })
        .collect()
}

#[test]
fn a_png_of_tiles_is_the_png_drawn_at_once() {
    let (folder, mut stage) = (tempfile::tempdir().expect("a folder"), stage());
    for background in [
        Background::Transparent,
        Background::Gradient([0.8, 0.1, 0.2], [0.1, 0.3, 0.9]),
    ] {
        for show in [Show::Colours, Show::Target("depth".into())] {
            let frame = FrameRequest {
                background,
                show,
                ..frame()
            };
            let (whole, tiled) = (folder.path().join("w.png"), folder.path().join("t.png"));
            let job = Job::new();
            let once = export(&whole, frame.clone(), 4096);
            let saved = save(&mut stage, once, &job).expect("saved");
            assert_eq!(saved.tile_count, 1);
            let saved = save(&mut stage, export(&tiled, frame.clone(), 64), &job).expect("saved");
            assert_eq!(saved.tile_count, 5 * 3);
            assert_eq!(job.progress(), 1.0);
            let (channels, expected, _) = read_png(&whole);
            assert_eq!(
                channels,
                if background == Background::Transparent {
                    4
                } else {
                    3
                }
            );
            let (_, found, record) = read_png(&tiled);
            // Rounding at the edges of splats may differ: a tile's projection has other numbers.
            let pixels = expected.chunks(channels).zip(found.chunks(channels));
            let differs =
                |(a, b): &(&[u8], &[u8])| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > 1);
            let apart = pixels.filter(differs).count();
            assert_eq!(expected.len(), found.len());
            assert!(apart < 10, "{:?}: {apart} pixels differ", frame.show);
            assert_eq!(record["renderer"], FALLBACK_ID);
            assert_eq!(record["view"]["width"], SIZE_PX[0]);
        }
    }
}

#[test]
fn the_layers_of_an_exr_are_the_targets() {
    let (folder, mut stage) = (tempfile::tempdir().expect("a folder"), stage());
    let path = folder.path().join("all.exr");
    let saved = save(&mut stage, export(&path, frame(), 128), &Job::new()).expect("saved");
    assert!(saved.tile_count > 1);
    let image = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .all_layers()
        .all_attributes()
        .from_file(&path)
        .expect("an EXR file");
    let mut request = frame();
    request.background = Background::Transparent;
    request.read_back = stage
        .given_targets(FALLBACK_ID)
        .expect("built in")
        .iter()
        .map(|spec| spec.key.to_string())
        .collect();
    let result = stage.frame(&request).expect("drawn");
    let view = ViewRecord::new(request.camera, SIZE_PX[0], SIZE_PX[1]);
    assert_eq!(image.layer_data.len(), request.read_back.len());
    for layer in image.layer_data {
        let key = layer.attributes.layer_name.expect("a name").to_string();
        let plane = file_values::for_file(&key, &result.planes[&key], &view);
        let channels: BTreeMap<String, FlatSamples> = layer
            .channel_data
            .list
            .into_iter()
            .map(|channel| (channel.name.to_string(), channel.sample_data))
            .collect();
        match &plane {
            Plane::Uint(values) => {
                let FlatSamples::U32(found) = &channels[&key] else {
                    panic!("{key} are whole numbers")
                };
                let apart = values.iter().zip(found).filter(|(a, b)| a != b).count();
                assert!(apart < 10, "{key}: {apart} pixels differ");
            }
            Plane::Float {
                channels: count,
                values,
            } => {
                let names: &[&str] = if *count == 1 {
                    &["Z"]
                } else {
                    &["R", "G", "B", "A"]
                };
                for (number, name) in names.iter().enumerate() {
                    let FlatSamples::F32(found) = &channels[*name] else {
                        panic!("{key} are floats")
                    };
                    let expected = values.iter().skip(number).step_by(names.len());
                    let differs = |(a, b): &(&f32, &f32)| {
                        a != b && (a.is_nan() || b.is_nan() || (*a - *b).abs() >= 1e-3)
                    };
                    let apart = expected.zip(found).filter(differs).count();
                    assert!(apart < 10, "{key} {name}: {apart} pixels differ");
                }
            }
        }
    }
}

#[test]
fn a_cancelled_image_leaves_no_file_and_the_old_one_stays() {
    let (folder, mut stage) = (tempfile::tempdir().expect("a folder"), stage());
    for name in ["a.png", "a.exr"] {
        let path = folder.path().join(name);
        std::fs::write(&path, b"old").expect("writable");
        let job = Job::new();
        let begun = Exporting::begin(export(&path, frame(), 64), job.clone());
        let mut exporting = begun.expect("begun");
        for _ in 0..5 {
            assert!(exporting.step(&mut stage).expect("a step").is_none());
        }
        assert!(job.progress() > 0.0, "some tiles are there");
        job.cancel();
        let error = exporting.step(&mut stage).expect_err("cancelled");
        assert!(matches!(error, ExportError::Cancelled(_)), "{error}");
        drop(exporting);
        assert_eq!(std::fs::read(&path).expect("readable"), b"old");
    }
    assert_eq!(
        files_in(folder.path()).len(),
        2,
        "{:?}",
        files_in(folder.path())
    );
}

#[test]
fn a_folder_that_is_not_there_is_told_by_name_before_anything_is_drawn() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("missing").join("a.png");
    let begun = Exporting::begin(export(&path, frame(), 64), Job::new());
    let error = begun.map(|_| ()).expect_err("no folder").to_string();
    assert!(error.contains(&*path.to_string_lossy()), "{error}");
    assert!(error.contains("check that the folder exists"), "{error}");
}

#[test]
fn an_exr_beyond_memory_is_refused_with_its_need() {
    let (folder, mut stage) = (tempfile::tempdir().expect("a folder"), stage());
    let huge = FrameRequest {
        size_px: [30_000, 30_000],
        ..frame()
    };
    let path = folder.path().join("huge.exr");
    let error = save(&mut stage, export(&path, huge, 64), &Job::new()).expect_err("too large");
    let text = error.to_string();
    assert!(
        text.contains("6 layers needs") && text.contains("save PNG"),
        "{text}"
    );
    assert!(files_in(folder.path()).is_empty());
}

#[test]
fn an_unknown_renderer_or_target_is_an_error_by_name() {
    let (folder, mut stage) = (tempfile::tempdir().expect("a folder"), stage());
    let path = folder.path().join("a.exr");
    let mut unknown = export(&path, frame(), 64);
    unknown.frame.renderer = "no-such".into();
    let error = save(&mut stage, unknown, &Job::new()).expect_err("unknown");
    assert!(error.to_string().contains("no-such"), "{error}");
    let mut lacking = export(&path, frame(), 64);
    lacking.targets = vec!["heat".into()];
    let error = save(&mut stage, lacking, &Job::new()).expect_err("no such target");
    assert!(error.to_string().contains("no target 'heat'"), "{error}");
    assert!(files_in(folder.path()).is_empty());
}
