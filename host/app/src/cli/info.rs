//! `pointstage info`: what is in files.

use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

use clap::Args;
use pointstage_engine::plugins::Registry;
use pointstage_scene::{Loaded, Provenance};
use serde_json::{Value, json};

use super::load::LoadArguments;
use super::{Globals, Outcome, write_out};
use crate::file_loaders::loaders;

/// Arguments of `info`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  pointstage info scan.ply
  pointstage info --json a.ply b.laz
  pointstage info --loader xyz --set-loader columns='x y z _ r g b' points.dat

With --json, standard output holds one JSON array with an object a file.")]
pub(crate) struct InfoArguments {
    /// Files of points or meshes
    #[arg(value_name = "FILE", required = true)]
    files: Vec<PathBuf>,
    /// Write JSON
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    load: LoadArguments,
}

/// Prints the facts of each file.
pub(crate) fn run(globals: &Globals, arguments: &InfoArguments) -> Outcome {
    let registry = OnceLock::new();
    let options = globals.discover_options();
    let discover = move || Arc::new(Registry::discover(&options));
    let loaders = loaders(move || Some(Arc::clone(registry.get_or_init(&discover))));
    let mut all = Vec::new();
    for path in &arguments.files {
        let facts = facts(path, &arguments.load.load(path, &loaders)?);
        if !arguments.json {
            write_out(&lines(&facts).join("\n"))?;
        }
        all.push(facts);
    }
    if arguments.json {
        write_out(&serde_json::to_string_pretty(&Value::Array(all))?)?;
    }
    Ok(())
}

fn facts(path: &Path, loaded: &Loaded) -> Value {
    let Loaded {
        object,
        loader,
        warnings,
    } = loaded;
    let geometry = &object.geometry;
    let block = geometry.blocks.first();
    let columns: Vec<Value> = block
        .into_iter()
        .flat_map(|block| &block.named)
        .map(|column| {
            json!({
                "name": &*column.name,
                "type": column.scalar.name(),
                "components": column.components,
            })
        })
        .collect();
    let textures: Vec<Value> = geometry
        .textures
        .iter()
        .flat_map(|textures| &textures.pictures)
        .map(|picture| json!({ "name": &*picture.name, "bytes": picture.bytes.len() }))
        .collect();
    let bounds = object.bounds_world();
    let bounds = (!bounds.is_empty()).then(|| {
        json!({
            "min": bounds.min.to_array(),
            "max": bounds.max.to_array(),
            "size": bounds.size().to_array(),
        })
    });
    json!({
        "file": path.display().to_string(),
        "name": object.name,
        "loader": loader.id,
        "format": loader.title,
        "surfels": geometry.surfel_count,
        "triangles": geometry.triangles.as_ref().map_or(0, |triangles| triangles.len()),
        "textures": textures,
        "blocks": geometry.blocks.len(),
        "normals": provenance(geometry.origins.normals),
        "radii": provenance(geometry.origins.radii),
        "colours": provenance(geometry.origins.colours),
        "axes": provenance(geometry.origins.axes),
        "columns": columns,
        "origin": object.origin.to_array(),
        "bounds": bounds,
        "warnings": warnings.iter().map(ToString::to_string).collect::<Vec<_>>(),
    })
}

fn provenance(provenance: Provenance) -> &'static str {
    match provenance {
        Provenance::Missing => "none",
        Provenance::FromFile => "file",
        Provenance::FromFaces => "faces",
        Provenance::Estimated => "neighbours",
        Provenance::Oriented => "neighbours, oriented",
    }
}

/// The facts as lines, aligned.
fn lines(facts: &Value) -> Vec<String> {
    let mut lines = Vec::new();
    let text = |key: &str| match &facts[key] {
        Value::String(text) => text.clone(),
        other => other.to_string(),
    };
    lines.push(text("file"));
    let mut line = |name: &str, value: String| lines.push(format!("{name:<12}{value}"));
    line(
        "  format",
        format!("{} (loader {})", text("format"), text("loader")),
    );
    line("  surfels", text("surfels"));
    line("  triangles", text("triangles"));
    for column in ["normals", "radii", "colours", "axes"] {
        let from = match facts[column].as_str() {
            Some("none") | None => "none",
            Some("file") => "from the file",
            Some("faces") => "computed from faces",
            Some(_) => "estimated from neighbours",
        };
        line(&format!("  {column}"), from.to_owned());
    }
    let columns: Vec<String> = facts["columns"]
        .as_array()
        .into_iter()
        .flatten()
        .map(|column| {
            let name = column["name"].as_str().unwrap_or_default();
            let scalar = column["type"].as_str().unwrap_or_default();
            format!("{name} ({scalar}×{})", column["components"])
        })
        .collect();
    if !columns.is_empty() {
        line("  columns", columns.join(", "));
    }
    let textures: Vec<String> = facts["textures"]
        .as_array()
        .into_iter()
        .flatten()
        .map(|picture| {
            let name = picture["name"].as_str().filter(|name| !name.is_empty());
            let name = name.unwrap_or("inside the file");
            format!("{name} ({} bytes)", picture["bytes"])
        })
        .collect();
    if !textures.is_empty() {
        line("  textures", textures.join(", "));
    }
    let vector = |value: &Value| {
        let numbers = value.as_array().into_iter().flatten();
        let texts: Vec<String> = numbers.map(ToString::to_string).collect();
        texts.join(" ")
    };
    if facts["bounds"].is_object() {
        line("  from", vector(&facts["bounds"]["min"]));
        line("  to", vector(&facts["bounds"]["max"]));
        line("  size", vector(&facts["bounds"]["size"]));
    }
    lines
}
