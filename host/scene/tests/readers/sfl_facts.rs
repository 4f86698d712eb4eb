//! What the reference library reads from the SFL files of the shared test data folder: each file has its facts beside it.
//!
//! The folder lies beside the checkout, or where `POINTSTAGE_TEST_DATA` says; without it these tests skip and say so.

use std::path::{Path, PathBuf};

use crate::data::data_folder;
use crate::support::load_bytes;
use glam::{DVec3, Vec3};
use pointstage_plugin_api::columns::TangentAxes;
use pointstage_scene::{
    Block, Estimation, Job, LoadOptions, Loaded, Origins, Provenance, WarningKind, load,
};
use serde_json::Value;

/// Columns whose name here differs from that in the facts.
const NAMES: [(&str, &str); 14] = [
    ("weight", "weight"),
    ("sampling_density", "sampling_density"),
    ("texture_uv", "texture_uv"),
    ("ambient_coeff", "ambient_coefficient"),
    ("diffuse_coeff", "diffuse_coefficient"),
    ("specular_coeff", "specular_coefficient"),
    ("shininess", "shininess"),
    ("flags", "flags"),
    ("isovalue", "isovalue"),
    ("origin_cell", "origin_cell"),
    ("camera_depth", "camera_depth"),
    ("camera_id", "camera_id"),
    ("camera_xy", "camera_xy"),
    ("normal_info_theta_phi", "phi_theta"),
];

fn file_only() -> LoadOptions {
    LoadOptions {
        estimation: Estimation::FileOnly,
        ..LoadOptions::default()
    }
}

fn read(path: &Path) -> Result<Loaded, String> {
    load(path, &file_only(), &Job::new()).map_err(|error| error.to_string())
}

fn json(path: &Path) -> Value {
    let text =
        std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    serde_json::from_str(&text).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// The SFL files of a folder.
fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).expect("the folder can be listed");
    let mut files: Vec<PathBuf> = entries
        .map(|entry| entry.expect("an entry").path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "sfl"))
        .collect();
    files.sort();
    files
}

fn vector(value: &Value) -> DVec3 {
    let number = |index: usize| value[index].as_f64().unwrap_or_else(|| panic!("{value}"));
    DVec3::new(number(0), number(1), number(2))
}

/// One surfel of a loaded file.
struct Surfel<'a> {
    loaded: &'a Loaded,
    block: &'a Block,
    index: usize,
}

impl Surfel<'_> {
    fn local(&self) -> DVec3 {
        self.block.centre(self.index).as_dvec3() + self.loaded.object.origin
    }

    fn named(&self, name: &str) -> Option<Vec<f64>> {
        let column = self
            .block
            .named
            .iter()
            .find(|column| *column.name == *name)?;
        let value = |component| column.value(self.index, component);
        (0..column.components).map(value).collect()
    }

    fn rgba(&self) -> Option<[u8; 4]> {
        let colours = self.block.colour.as_ref()?;
        Some(colours[self.index].to_le_bytes())
    }

    fn axes(&self) -> Option<[Vec3; 2]> {
        let axes = TangentAxes(self.block.axes.as_ref()?[self.index]);
        Some([axes.u(), axes.v()])
    }

    fn radius(&self) -> f64 {
        f64::from(self.block.position_radius[self.index][3])
    }
}

fn surfel(loaded: &Loaded, index: usize) -> Surfel<'_> {
    let (block, index) = loaded
        .object
        .geometry
        .locate(index)
        .expect("the surfel exists");
    Surfel {
        loaded,
        block,
        index,
    }
}

/// The resolution that is shown of each set.
fn shown(facts: &Value) -> Vec<&Value> {
    let sets = facts["surfel_sets"].as_array().expect("sets");
    let level = |set: &'_ Value| set["res0_index"].as_u64().expect("an index") as usize;
    sets.iter()
        .map(|set| &set["resolutions"][level(set)])
        .collect()
}

#[test]
fn every_file_has_the_surfels_that_the_reference_library_finds() {
    let Some(folder) = data_folder() else { return };
    let all = files(&folder.join("sfl"));
    assert!(all.len() >= 40, "{} files", all.len());
    for path in all {
        let loaded = read(&path).unwrap_or_else(|error| panic!("{error}"));
        let facts = json(&path.with_extension("json"));
        let name = path.file_stem().unwrap().to_string_lossy().into_owned();
        let levels = shown(&facts);
        let count: u64 = levels
            .iter()
            .map(|level| level["num_surfels"].as_u64().unwrap())
            .sum();
        assert_eq!(loaded.object.geometry.surfel_count as u64, count, "{name}");
        let sets = facts["surfel_sets"].as_array().unwrap();
        let mut next = 0;
        for (set_index, (level, set)) in levels.iter().zip(sets).enumerate() {
            let Some(derived) = level["derived"].as_array() else {
                check_large(&name, &loaded, level);
                continue;
            };
            let stored = level["surfels"].as_array().unwrap();
            for (row, (derived, stored)) in derived.iter().zip(stored).enumerate() {
                let found = surfel(&loaded, next);
                let at = format!("{name}, surfel {next}");
                if sets.len() == 1 {
                    check_columns(&at, &found, derived);
                } else {
                    let set = found.named("surfel_set");
                    assert_eq!(set, Some(vec![set_index as f64]), "{at}");
                }
                // With turned axes the reference library does the two maps in the wrong order.
                let is_standard = facts["header"]["back"] == serde_json::json!([0, 0, 1]);
                if let (Some(world), true) = (level["world"].get(row), is_standard) {
                    let affine = loaded.object.world_from_object;
                    let position = affine.transform_point3(found.local());
                    let expected = vector(&world["position"]);
                    let error = position.distance(expected) / (1.0 + expected.length());
                    assert!(error < 1e-7, "{at}: {position}, expected {expected}");
                }
                check_stored(&at, &found, stored, set);
                next += 1;
            }
        }
    }
}

/// Positions, normals, radii and axes, of a file with one set.
fn check_columns(at: &str, found: &Surfel<'_>, derived: &Value) {
    let expected = vector(&derived["position"]);
    let is_moved = found.loaded.object.origin != DVec3::ZERO;
    if !is_moved {
        assert_eq!(found.local(), expected.as_vec3().as_dvec3(), "{at}");
    }
    if let Some(normal) = derived.get("normal").filter(|normal| normal.is_array()) {
        let normal = vector(normal).normalize_or_zero();
        let is_null = normal == DVec3::ZERO;
        let decoded = found.block.normal_at(found.index).expect("normals");
        // A step of the packed column is 0.004 degrees.
        assert!(
            is_null || decoded.as_dvec3().distance(normal) < 1e-4,
            "{at}: {decoded}"
        );
    }
    if let Some(radius) = derived.get("radius").and_then(Value::as_f64) {
        let relative = (found.radius() - radius).abs() / radius;
        assert!(relative < 1e-6, "{at}: radius {}", found.radius());
    }
    if let Some([u, v]) = found.axes() {
        let expected = [0, 1].map(|index| vector(&derived["tangent_axes"][index]));
        for (found, expected) in [u, v].into_iter().zip(expected) {
            let error = found.as_dvec3().distance(expected);
            assert!(error < 1e-6, "{at}: axis {found}, expected {expected}");
        }
    }
}

/// Values as the records have them: colours and named columns.
fn check_stored(at: &str, found: &Surfel<'_>, stored: &Value, set: &Value) {
    for (fact, name) in NAMES {
        let Some(value) = stored.get(fact) else {
            continue;
        };
        let expected: Vec<f64> = match value.as_array() {
            Some(values) => values.iter().map(|value| value.as_f64().unwrap()).collect(),
            None => vec![value.as_f64().unwrap()],
        };
        assert_eq!(found.named(name), Some(expected), "{at}: {name}");
    }
    let model = set["properties"][0].as_u64().unwrap() >> 16 & 0x1f;
    let mut shown = None;
    for colour in ["diffuse", "ambient", "specular"] {
        let Some(bytes) = stored
            .get(format!("{colour}_color"))
            .and_then(Value::as_array)
        else {
            continue;
        };
        let bytes: Vec<f64> = bytes.iter().map(|byte| byte.as_f64().unwrap()).collect();
        let expected = match (model, bytes.as_slice()) {
            (1, &[l]) => vec![l, l, l, 255.0],
            (9, &[l, a]) => vec![l, l, l, a],
            (7 | 16, &[r, g, b]) => vec![r, g, b, 255.0],
            (15 | 24, rgba) => rgba.to_vec(),
            _ => panic!("{at}: colour model {model:#x} with {} bytes", bytes.len()),
        };
        let is_yuv = model >= 16;
        if is_yuv {
            assert_eq!(
                found.named(&format!("{colour}_yuv")),
                Some(expected),
                "{at}"
            );
        } else if shown.is_none() {
            let rgba = found.rgba().expect("colours").map(f64::from);
            assert_eq!(rgba.to_vec(), expected, "{at}: {colour}");
        } else {
            assert_eq!(
                found.named(&format!("{colour}_colour")),
                Some(expected),
                "{at}"
            );
        }
        shown = shown.or(Some(colour));
    }
    if shown.is_none() {
        assert_eq!(found.rgba(), None, "{at}");
    }
}

/// Box, sums, and the first and last three surfels.
fn check_large(name: &str, loaded: &Loaded, level: &Value) {
    let geometry = &loaded.object.geometry;
    let bounds = loaded.object.bounds_world();
    for (found, expected) in [bounds.min, bounds.max].into_iter().zip(0..) {
        let expected = vector(&level["position_bbox"][expected]);
        assert!(
            found.distance(expected) < 1e-7 * expected.length(),
            "{name}: {found}"
        );
    }
    let count = geometry.surfel_count;
    let all = || (0..count).map(|index| surfel(loaded, index));
    let close = |what: &str, found: f64, expected: &Value, tolerance: f64| {
        let expected = expected
            .as_f64()
            .unwrap_or_else(|| panic!("{name}: no {what}"));
        let error = (found - expected).abs() / expected.abs();
        assert!(
            error < tolerance,
            "{name}: {what} {found}, expected {expected}"
        );
    };
    let positions: DVec3 = all().map(|surfel| surfel.local()).sum();
    let radii: f64 = all().map(|surfel| surfel.radius()).sum();
    close("x", positions.x, &level["position_sum"][0], 1e-9);
    close("y", positions.y, &level["position_sum"][1], 1e-9);
    close("z", positions.z, &level["position_sum"][2], 1e-9);
    close("radii", radii, &level["radius_sum"], 1e-9);
    let normals: DVec3 = all()
        .map(|surfel| surfel.block.normal_at(surfel.index).unwrap().as_dvec3())
        .sum();
    let error = (normals - vector(&level["normal_sum"])).length() / count as f64;
    assert!(error < 1e-6, "{name}: normals {normals}");
    if let Some(sums) = level.get("diffuse_color_sum").and_then(Value::as_array) {
        for (component, expected) in sums.iter().enumerate() {
            let found: f64 = all()
                .map(|surfel| f64::from(surfel.rgba().unwrap()[component]))
                .sum();
            close("colours", found, expected, 1e-12);
        }
    }
    let ends = [("first", 0), ("last", count - 3)];
    for (end, start) in ends {
        for index in 0..3 {
            let expected = &level[end][index];
            let found = surfel(loaded, start + index);
            assert_eq!(
                found.local(),
                vector(&expected["position"]),
                "{name} {end} {index}"
            );
            assert_eq!(Some(found.radius()), expected["radius"].as_f64());
            let normal = found.block.normal_at(found.index).unwrap().as_dvec3();
            assert!(
                normal.distance(vector(&expected["normal"])) < 1e-4,
                "{name} {end} {index}"
            );
        }
    }
}

#[test]
fn sets_are_placed_by_their_transforms() {
    let Some(folder) = data_folder() else { return };
    let loaded = read(&folder.join("sfl/two_sets.sfl")).unwrap();
    // The second set is scaled by 3 and turned: (1, 2, 3) with radius 0.25 and normal (1, 1, 1)/√3.
    let found = surfel(&loaded, 4);
    assert!((found.radius() - 0.75).abs() < 1e-6, "{}", found.radius());
    let expected = DVec3::new(2.4 + 1.8, 3.0, 2.4 - 1.8).normalize();
    let normal = found.block.normal_at(found.index).unwrap().as_dvec3();
    assert!(normal.distance(expected) < 1e-3, "{normal}");
    let moved = read(&folder.join("sfl/all_properties.sfl")).unwrap();
    assert_eq!(
        moved.object.world_from_object.translation,
        DVec3::new(1.0, 2.0, 3.0)
    );
}

#[test]
fn malformed_files_are_refused_or_read_as_their_list_says() {
    let Some(folder) = data_folder() else { return };
    let folder = folder.join("sfl/malformed");
    let list = json(&folder.join("manifest.json"));
    let list = list.as_array().unwrap();
    assert_eq!(list.len(), 41);
    for entry in list {
        let file = entry["file"].as_str().unwrap();
        let result = read(&folder.join(file));
        match entry["expect"].as_str() {
            Some("reject") => {
                let error = result.map(|_| ()).expect_err(file);
                let says_why = ["expected", "is not read", "starts with"]
                    .iter()
                    .any(|part| error.contains(part));
                assert!(
                    error.contains(file) && (says_why || error.contains("found")),
                    "{error}"
                );
            }
            Some("accept") => {
                result.unwrap_or_else(|error| panic!("{}: {error}", entry["why"]));
            }
            other => panic!("{file}: {other:?}"),
        }
    }
    let dropped = read(&folder.join("nan_position.sfl")).unwrap();
    assert_eq!(
        dropped
            .warnings
            .count(&WarningKind::NonFinitePositionsDropped),
        1
    );
    for file in ["infinite_radius.sfl", "negative_radius.sfl"] {
        let repaired = read(&folder.join(file)).unwrap();
        assert_eq!(
            repaired.warnings.count(&WarningKind::UnusableRadiiReplaced),
            1
        );
        assert_eq!(surfel(&repaired, 0).radius(), 0.0, "to be estimated");
    }
    let followed = read(&folder.join("bits_n_r_without_index.sfl")).unwrap();
    let facts = json(&folder.join("../mask_pt.json"));
    for (index, derived) in shown(&facts)[0]["derived"]
        .as_array()
        .unwrap()
        .iter()
        .enumerate()
    {
        check_columns("bits_n_r_without_index", &surfel(&followed, index), derived);
    }
    let origins = followed.object.geometry.origins;
    assert_eq!(
        origins,
        Origins {
            normals: Provenance::FromFile,
            radii: Provenance::FromFile,
            colours: Provenance::Missing,
            axes: Provenance::FromFile
        }
    );
}

#[test]
fn files_cut_anywhere_are_refused_or_whole() {
    let Some(folder) = data_folder() else { return };
    for path in files(&folder.join("sfl")) {
        let bytes = std::fs::read(&path).unwrap();
        let whole = read(&path).unwrap().object.geometry.surfel_count;
        for part in 0..200 {
            let cut = &bytes[..bytes.len() * part / 200];
            // What comes after the last record only closes directories.
            if let Ok(loaded) = load_bytes(cut, &file_only()) {
                let count = loaded.object.geometry.surfel_count;
                assert!(
                    count == whole || !loaded.warnings.is_empty(),
                    "{} cut to {}: {count} surfels of {whole} without a word",
                    path.display(),
                    cut.len()
                );
            }
        }
    }
}
