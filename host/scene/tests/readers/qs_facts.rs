//! QSplat files: those of the shared test data folder with the facts beside them, and small ones made here.
//!
//! The folder lies beside the checkout, or where `POINTSTAGE_TEST_DATA` says; without it those tests skip and say so.

use crate::data::{data_folder, load_file};
use crate::support::load_bytes;
use glam::DVec3;
use pointstage_scene::{Estimation, LoadOptions, Loaded, Provenance};
use serde_json::Value;

fn vector(value: &Value) -> DVec3 {
    let number = |index: usize| value[index].as_f64().unwrap_or_else(|| panic!("{value}"));
    DVec3::new(number(0), number(1), number(2))
}

fn file_only() -> LoadOptions {
    LoadOptions {
        estimation: Estimation::FileOnly,
        ..LoadOptions::default()
    }
}

/// Centre, radius, normal and colour of every surfel.
fn surfels(loaded: &Loaded) -> Vec<(DVec3, f64, DVec3, Option<[u8; 4]>)> {
    let geometry = &loaded.object.geometry;
    let surfel = |index: usize| {
        let (block, inside) = geometry.locate(index).expect("the surfel exists");
        let normal = block.normal_at(inside).expect("normals");
        let colour = block
            .colour
            .as_ref()
            .map(|colours| colours[inside].to_le_bytes());
        (
            block.centre(inside).as_dvec3() + loaded.object.origin,
            f64::from(block.position_radius[inside][3]),
            normal.as_dvec3(),
            colour,
        )
    };
    (0..geometry.surfel_count).map(surfel).collect()
}

#[test]
fn every_file_has_the_leaves_of_its_facts() {
    let Some(folder) = data_folder() else { return };
    for name in ["small", "small_nocol", "tetra", "bunny", "bunny_nocol"] {
        let loaded = load_file(&folder, &format!("qs/{name}.qs"), Estimation::FileOnly)
            .unwrap_or_else(|error| panic!("{error}"));
        assert!(loaded.warnings.is_empty(), "{name}: {:?}", loaded.warnings);
        let text = std::fs::read_to_string(folder.join(format!("qs/{name}.json"))).unwrap();
        let facts: Value = serde_json::from_str(&text).unwrap();
        let mut models = facts["fragments"].as_array().unwrap().iter();
        let model = models
            .rfind(|fragment| fragment["kind"] == "model")
            .unwrap();
        let found = surfels(&loaded);
        assert_eq!(
            found.len() as u64,
            model["leaf_count"].as_u64().unwrap(),
            "{name}"
        );
        let has_colours = model["has_colour"].as_bool().unwrap();
        let origins = loaded.object.geometry.origins;
        assert_eq!(
            origins.colours == Provenance::FromFile,
            has_colours,
            "{name}"
        );
        check_sums(name, &found, model);
        let bounds = loaded.object.bounds_world();
        for (corner, index) in [bounds.min, bounds.max].into_iter().zip(0..) {
            let expected = vector(&model["leaf_centre_bbox"][index]);
            assert!(
                corner.distance(expected) < 1e-6 * expected.length(),
                "{name}: {corner}"
            );
        }
        let nodes = model["nodes_depth_first"].as_array();
        let leaves = nodes
            .into_iter()
            .flatten()
            .filter(|node| node["children"] == 0);
        for (found, node) in found.iter().zip(leaves) {
            let (centre, radius, normal, rgba) = *found;
            assert!(
                centre.distance(vector(&node["centre"])) < 1e-6,
                "{name}: {node}"
            );
            assert!(
                (radius - node["radius"].as_f64().unwrap()).abs() < 1e-6,
                "{name}: {node}"
            );
            assert!(
                normal.distance(vector(&node["normal"])) < 1e-4,
                "{name}: {node}"
            );
            if let Some(rgb) = node.get("rgb") {
                let [red, green, blue, alpha] = rgba.unwrap();
                assert_eq!(
                    serde_json::json!([red, green, blue]),
                    *rgb,
                    "{name}: {node}"
                );
                assert_eq!(alpha, 255);
            }
        }
    }
}

fn check_sums(name: &str, found: &[(DVec3, f64, DVec3, Option<[u8; 4]>)], model: &Value) {
    let count = found.len() as f64;
    let centres: DVec3 = found.iter().map(|surfel| surfel.0).sum();
    let normals: DVec3 = found.iter().map(|surfel| surfel.2).sum();
    let radii: f64 = found.iter().map(|surfel| surfel.1).sum();
    // The facts were summed up from floats.
    let scale = model["root_radius"].as_f64().unwrap();
    let centre_error = centres.distance(vector(&model["leaf_centre_sum"])) / count;
    assert!(centre_error < 2e-7 * scale, "{name}: {centre_error}");
    let normal_error = normals.distance(vector(&model["leaf_normal_sum"])) / count;
    assert!(normal_error < 2e-5, "{name}: {normal_error}");
    let radius_sum = model["leaf_radius_sum"].as_f64().unwrap();
    assert!(
        (radii - radius_sum).abs() < 1e-6 * radius_sum,
        "{name}: {radii}"
    );
    if let Some(sums) = model.get("leaf_rgb_sum").and_then(Value::as_array) {
        for (component, sum) in sums.iter().enumerate() {
            let component = |surfel: &(DVec3, f64, DVec3, Option<[u8; 4]>)| {
                u64::from(surfel.3.unwrap()[component])
            };
            let found: u64 = found.iter().map(component).sum();
            assert_eq!(Some(found), sum.as_u64(), "{name}");
        }
    }
}

#[test]
fn files_cut_anywhere_are_refused() {
    let Some(folder) = data_folder() else { return };
    for name in ["small", "small_nocol", "tetra", "bunny", "bunny_nocol"] {
        let bytes = std::fs::read(folder.join(format!("qs/{name}.qs"))).unwrap();
        for part in 0..200 {
            let cut = &bytes[..bytes.len() * part / 200];
            let error = load_bytes(cut, &file_only()).map(|_| ()).expect_err("cut");
            assert!(!error.to_string().is_empty());
        }
    }
}

/// A fragment with a model: root at (1, 2, 3) of radius 13.
fn model(leaves: u32, options: u32, children: u32, groups: &[u8]) -> Vec<u8> {
    let mut bytes = b"QSplat11".to_vec();
    bytes.extend((40 + groups.len() as u32).to_be_bytes());
    bytes.extend(leaves.to_be_bytes());
    bytes.extend(options.to_be_bytes());
    for value in [1.0_f32, 2.0, 3.0, 13.0] {
        bytes.extend(value.to_be_bytes());
    }
    bytes.extend(children.to_be_bytes());
    bytes.extend(groups);
    bytes
}

fn node(sphere: u16, children: u16, has_grandchildren: bool, normal: u16) -> [u8; 4] {
    let code = if children == 0 { 0 } else { children - 1 };
    let first = sphere << 3 | u16::from(has_grandchildren) << 2 | code;
    let [a, b] = first.to_be_bytes();
    let [c, d] = (normal << 2).to_be_bytes();
    [a, b, c, d]
}

/// The sphere that fills its parent.
const WHOLE: u16 = 7620;

fn message(bytes: &[u8]) -> String {
    match load_bytes(bytes, &file_only()) {
        Ok(loaded) => panic!("loaded: {:?}", loaded.warnings),
        Err(error) => error.to_string(),
    }
}

#[test]
fn a_made_up_tree_gives_its_leaves() {
    // Two children: a leaf, and a node with two leaves behind a pointer of 12 bytes.
    let mut groups = 12_u32.to_be_bytes().to_vec();
    groups.extend(node(WHOLE, 0, false, 26 * 52 + 26));
    groups.extend(node(WHOLE, 2, false, 0));
    groups.extend(node(WHOLE, 0, false, 2704 + 26 * 52 + 26));
    groups.extend(node(0, 0, false, 16_224));
    let mut bytes = b"QSplat11\0\0\0\x1c\0\0\0\0\0\0\0\x02hello\0\0\0".to_vec();
    bytes.extend(model(3, 0, 2, &groups));
    let loaded = load_bytes(&bytes, &file_only()).unwrap_or_else(|error| panic!("{error}"));
    assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
    let found = surfels(&loaded);
    let radii: Vec<f64> = found.iter().map(|surfel| surfel.1).collect();
    assert_eq!(radii, [13.0, 13.0, 1.0]);
    assert_eq!(found[0].0, DVec3::new(1.0, 2.0, 3.0));
    assert!(found[0].2.x > 0.99 && found[1].2.x < -0.99, "{found:?}");
    assert_eq!(found[2].2, DVec3::Z);
    assert_eq!(found[0].3, None);

    let fewer = load_bytes(&model(4, 0, 2, &groups), &file_only()).expect("the header may lie");
    let warning = fewer.warnings.iter().next().expect("a warning").to_string();
    assert!(warning.contains("another number of points"), "{warning}");
}

#[test]
fn damage_is_told_with_its_place() {
    let leaf = node(WHOLE, 0, false, 0);
    let two = [leaf, leaf].concat();
    let pair = |pointer: u32, second: [u8; 4]| {
        let mut groups = pointer.to_be_bytes().to_vec();
        groups.extend(leaf);
        groups.extend(second);
        groups.extend(&two);
        model(3, 0, 2, &groups)
    };
    let inner = node(WHOLE, 2, false, 0);
    for (bytes, part) in [
        (b"QSplat10\0\0\0\0".to_vec(), "byte 0: expected 'QSplat11'"),
        (model(2, 0, 5, &two), "children of the root"),
        (
            model(2, 0, 2, &node(7621, 0, false, 0).repeat(2)),
            "byte 40: code of a sphere",
        ),
        (model(2, 0, 3, &two), "a group of nodes takes 12 bytes"),
        (model(0, 0, 0, &[]), "no points"),
        (model(2, 0, 2, &[inner, leaf].concat()), "no pointer to any"),
        (pair(3, inner), "pointer to the groups"),
        (pair(4, inner), "pointer to the groups"),
        (pair(4000, inner), "pointer to the groups"),
        (pair(16, inner), "a group of nodes takes 8 bytes"),
    ] {
        let error = message(&bytes);
        assert!(error.contains(part), "{error}, expected '{part}'");
    }
    let mut not_finite = model(2, 0, 2, &two);
    not_finite[32..36].copy_from_slice(&f32::NAN.to_be_bytes());
    assert!(message(&not_finite).contains("centre and radius of the root"));
    let mut long = model(2, 0, 2, &two);
    long[11] += 4;
    assert!(message(&long).contains("a fragment takes 52 bytes"));
}

#[test]
fn a_deep_chain_and_shared_groups_end() {
    // Each group: pointer, a leaf, and a node with two children in the next group.
    let mut chain = Vec::new();
    for _ in 0..100 {
        chain.extend(12_u32.to_be_bytes());
        chain.extend(node(WHOLE, 0, false, 0));
        chain.extend(node(WHOLE, 2, true, 0));
    }
    assert!(message(&model(1000, 0, 2, &chain)).contains("64 levels"));
    // Groups that share their children's groups: every node leads to the next two, a tree of thousands of millions.
    let mut shared = Vec::new();
    for group in 0..64 {
        let children = if group < 58 { 2 } else { 0 };
        shared.extend(12_u32.to_be_bytes());
        shared.extend(node(WHOLE, children, true, 0).repeat(2));
    }
    let error = message(&model(1000, 0, 2, &shared));
    assert!(error.contains("room for"), "{error}");
}
