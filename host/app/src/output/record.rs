//! What an image was made from, as JSON in its metadata, so that it can be made again.
//!
//! The names of the fields are those of the command line's options where there is one.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use pointstage_engine::stage::{Background, FrameRequest, Stage};
use pointstage_scene::{ObjectId, Scene, ViewRecord, Warnings};
use serde_json::{Value, json};

use crate::session_file::{SessionFile, folder_of};
use crate::toml_form::show_key;

/// All that a frame was asked for, without who drew it, for the image at `out`. `warnings` tell how objects were loaded.
pub(crate) fn of_frame(
    request: &FrameRequest,
    warnings: &BTreeMap<ObjectId, Warnings>,
    out: &Path,
) -> Value {
    let [width, height] = request.image_size_px();
    let session = SessionFile::of_request(request, warnings);
    json!({
        "version": env!("CARGO_PKG_VERSION"),
        // The other fields are for people and for programs that know no sessions.
        "session": session.to_toml_string(&folder_of(out)).ok(),
        "files": files(&request.scene),
        "objects": objects(&request.scene),
        "renderer": request.renderer,
        "settings": request.settings,
        "structure": request.structure,
        "structure_settings": request.structure_settings,
        "view": ViewRecord::new(request.camera, width, height),
        "lights": request.lights,
        "show": show_key(&request.show),
        "shown_range": request.shown_range,
        "background": background_text(request.background),
        "exposure": request.exposure,
        "radius_scale": request.radius_scale,
        "seed": request.seed,
    })
}

/// Adds to the record who drew: id, version and content hash of the renderer, and the adapter.
pub(crate) fn add_drawer(record: &mut Value, stage: &Stage, drawn_by: &str) {
    let Some(fields) = record.as_object_mut() else {
        return;
    };
    fields.insert("renderer".to_owned(), drawn_by.into());
    if let Ok(info) = stage.registry().find_renderer(drawn_by) {
        fields.insert(
            "renderer_version".to_owned(),
            info.entry.version.clone().into(),
        );
        fields.insert("renderer_hash".to_owned(), info.hash.clone().into());
    }
    let adapter = stage.adapter().map(|adapter| adapter.name);
    fields.insert("adapter".to_owned(), adapter.into());
}

/// The files that the objects came from, each once.
fn files(scene: &Scene) -> Vec<PathBuf> {
    let mut files: Vec<PathBuf> = Vec::new();
    for source in scene
        .objects()
        .iter()
        .filter_map(|object| object.source.as_ref())
    {
        if !files.contains(source) {
            files.push(source.clone());
        }
    }
    files
}

/// How each object stands, looks, and came by its columns.
fn objects(scene: &Scene) -> Vec<Value> {
    let objects = scene.objects().iter().map(|object| {
        let origins = &object.geometry.origins;
        json!({
            "name": object.name,
            "file": object.source,
            "surfels": object.geometry.surfel_count,
            "visible": object.visible,
            "world_from_object": object.world_from_object.to_cols_array(),
            "material": object.material,
            "normals": format!("{:?}", origins.normals),
            "radii": format!("{:?}", origins.radii),
        })
    });
    objects.collect()
}

/// A background as the command line writes it.
pub(crate) fn background_text(background: Background) -> String {
    let hex = |colour: [f32; 3]| {
        let [r, g, b] = colour.map(|channel| (channel * 255.0).round() as u8);
        format!("#{r:02x}{g:02x}{b:02x}")
    };
    match background {
        Background::Transparent => "transparent".to_owned(),
        Background::Solid(colour) => hex(colour),
        Background::Gradient(top, bottom) => format!("{},{}", hex(top), hex(bottom)),
    }
}
