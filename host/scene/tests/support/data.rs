//! The shared test data folder and the facts in its manifest.

#![allow(
    dead_code,
    reason = "each test program reads the facts that it is about"
)]

use std::collections::BTreeMap;
use std::path::PathBuf;

use pointstage_scene::{Estimation, Job, LoadOptions, Loaded, load};
use serde::Deserialize;

/// Facts about one file.
#[derive(Debug, Deserialize)]
pub(crate) struct Fact {
    pub(crate) path: String,
    #[serde(default)]
    pub(crate) elements: Vec<ElementFact>,
    pub(crate) bbox: Option<[[f64; 3]; 2]>,
    #[serde(default)]
    pub(crate) corners_per_face: BTreeMap<String, u64>,
    /// Smallest and largest corner.
    pub(crate) index_range: Option<[i64; 2]>,
    #[serde(default)]
    pub(crate) vertices_not_finite: u64,
}

#[derive(Debug, Deserialize)]
pub(crate) struct ElementFact {
    pub(crate) name: String,
    pub(crate) count: u64,
    /// 'TYPE NAME', or 'list TYPE TYPE NAME'.
    pub(crate) properties: Vec<String>,
}

pub(crate) fn data_folder() -> Option<PathBuf> {
    let folder = std::env::var_os("POINTSTAGE_TEST_DATA").map_or_else(
        || PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data")),
        PathBuf::from,
    );
    if !folder.join("manifest.json").is_file() {
        println!(
            "skipped: the shared test data folder is not at {}",
            folder.display()
        );
        return None;
    }
    Some(folder)
}

/// Facts of the PLY files whose path starts with one of `starts`.
pub(crate) fn facts(folder: &std::path::Path, starts: &[&str]) -> Vec<Fact> {
    let text =
        std::fs::read_to_string(folder.join("manifest.json")).expect("the manifest is readable");
    let all: Vec<serde_json::Value> = serde_json::from_str(&text).expect("the manifest is JSON");
    let is_wanted =
        |path: &str| path.ends_with("ply") && starts.iter().any(|start| path.starts_with(start));
    let wanted = all
        .into_iter()
        .filter(|fact| fact["path"].as_str().is_some_and(is_wanted));
    wanted
        .map(|fact| serde_json::from_value(fact).expect("a fact has the known form"))
        .collect()
}

pub(crate) fn load_file(
    folder: &std::path::Path,
    name: &str,
    estimation: Estimation,
) -> Result<Loaded, String> {
    let options = LoadOptions {
        estimation,
        ..LoadOptions::default()
    };
    load(&folder.join(name), &options, &Job::new()).map_err(|error| error.to_string())
}

/// Files without anything to show, and a part of the message that says so.
pub(crate) const REFUSED: [(&str, &str); 14] = [
    ("ply-bad/assimp_empty_file.ply", "the file is empty"),
    ("ply-bad/assimp_fuzz_crash_header_le.ply", "line 7"),
    ("ply-bad/pdal_no_vertex_ascii.ply", "found no elements"),
    (
        "ply-bad/plyrs_single_elements_err_ascii.ply",
        "expected row 2 of 2",
    ),
    (
        "ply-odd/plyrs_all_atomic_types_ascii.ply",
        "found 'point' with a",
    ),
    ("ply-odd/plyrs_empty_2_ascii.ply", "0 rows"),
    ("ply-odd/plyrs_empty_2_le.ply", "0 rows"),
    ("ply-odd/plyrs_empty_objinfo_ascii.ply", "0 rows"),
    ("ply-odd/plyrs_header_min_ascii.ply", "found no elements"),
    ("ply-odd/trimesh_zero_vertices_ascii.ply", "0 rows"),
    ("ply-odd/trimesh_zero_vertices_le.ply", "0 rows"),
    (
        "gsplat/guitar_91k.compressed.ply",
        "compressed Gaussian splat",
    ),
    ("mesh", "folder"),
    ("mesh/no_such_file.ply", "check the path"),
];
