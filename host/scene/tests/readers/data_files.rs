//! Every PLY file of the shared test data folder, against the facts in its manifest.
//!
//! The folder lies beside the checkout, or where `POINTSTAGE_TEST_DATA` says; without it these tests skip and say so.

use crate::data::{Fact, REFUSED, data_folder, facts, load_file};
use glam::DVec3;
use pointstage_scene::{Estimation, Job, LoadOptions, Loaded, Provenance, WarningKind, load};

#[test]
fn what_cannot_be_shown_is_refused_with_the_reason() {
    let Some(folder) = data_folder() else { return };
    for (name, part) in REFUSED {
        let error = load_file(&folder, name, Estimation::Automatic).expect_err(name);
        assert!(
            error.contains(part) && error.contains(name),
            "{name} gave: {error}"
        );
    }
}

#[test]
fn every_other_file_has_the_surfels_box_and_triangles_of_the_manifest() {
    let Some(folder) = data_folder() else { return };
    let facts = facts(
        &folder,
        &["mesh/", "points/", "ply-odd/", "ply-bad/", "gsplat/"],
    );
    let mut checked = 0;
    for fact in facts
        .iter()
        .filter(|fact| REFUSED.iter().all(|(name, _)| *name != fact.path))
    {
        let loaded = load_file(&folder, &fact.path, Estimation::FileOnly)
            .unwrap_or_else(|error| panic!("{error}"));
        check_surfels(fact, &loaded);
        check_box(fact, &loaded);
        check_triangles(fact, &loaded);
        checked += 1;
    }
    assert!(checked > 70, "only {checked} files checked");
}

fn check_surfels(fact: &Fact, loaded: &Loaded) {
    let vertices = ["vertex", "vertex_position", "point"];
    let element = fact
        .elements
        .iter()
        .find(|element| vertices.contains(&element.name.as_str()));
    let geometry = &loaded.object.geometry;
    // A few files have no facts, since the reader that made the manifest refused them.
    if let Some(element) = element {
        assert_eq!(
            geometry.surfel_count as u64,
            element.count - fact.vertices_not_finite,
            "{}",
            fact.path
        );
    }
    assert_eq!(
        loaded
            .warnings
            .count(&WarningKind::NonFinitePositionsDropped),
        fact.vertices_not_finite,
        "{}",
        fact.path
    );
    for block in &geometry.blocks {
        let lengths = [&block.normal, &block.colour]
            .map(|column| column.as_ref().map_or(block.len(), |column| column.len()));
        assert_eq!(lengths, [block.len(); 2], "{}", fact.path);
        for column in &block.named {
            let size = column.scalar.size() * column.components as usize;
            assert_eq!(
                column.bytes.len(),
                block.len() * size,
                "{}: {}",
                fact.path,
                column.name
            );
        }
    }
}

fn check_box(fact: &Fact, loaded: &Loaded) {
    let Some([min, max]) = fact.bbox else { return };
    let found = loaded
        .object
        .geometry
        .bounds
        .translated(loaded.object.origin);
    let (min, max) = (DVec3::from(min), DVec3::from(max));
    // The loader promises a millionth of the box; the manifest rounded text to the type it declares, f32 for the most.
    let tolerance =
        1e-6 * (max - min).max_element() + 6e-8 * min.abs().max(max.abs()).max_element();
    let error = (found.min - min)
        .abs()
        .max((found.max - max).abs())
        .max_element();
    assert!(
        error <= tolerance,
        "{}: {found:?}, expected {min} to {max}",
        fact.path
    );
}

fn check_triangles(fact: &Fact, loaded: &Loaded) {
    let dropped = loaded.warnings.count(&WarningKind::FacesOutOfRangeDropped)
        + loaded.warnings.count(&WarningKind::DegenerateFacesDropped);
    let found = loaded.object.geometry.triangle_count() as u64;
    let triangles_of = |(corners, count): (&String, &u64)| {
        count * corners.parse::<u64>().map_or(0, |c| c.saturating_sub(2))
    };
    let of_polygons: u64 = fact.corners_per_face.iter().map(triangles_of).sum();
    let expected = match fact.path.as_str() {
        // 35,048 strips by the README.
        "mesh/igea_tristrips_le.ply" => 268_686,
        // Two of the three are out of range.
        "ply-bad/displaz_bad_mesh_indices_ascii.ply" => 2,
        _ => of_polygons - dropped,
    };
    if !fact.elements.is_empty() {
        assert_eq!(found, expected, "{}: {:?}", fact.path, loaded.warnings);
    }
    let count = loaded.object.geometry.surfel_count;
    let mut corners = loaded
        .object
        .geometry
        .triangles
        .iter()
        .flat_map(|triangles| triangles.iter().flatten());
    assert!(
        corners.all(|corner| (*corner as usize) < count),
        "{}",
        fact.path
    );
}

#[test]
fn completed_files_have_a_radius_and_a_normal_everywhere() {
    let Some(folder) = data_folder() else { return };
    for fact in facts(
        &folder,
        &["ply-odd/", "mesh/nef", "mesh/laur", "points/pond"],
    ) {
        if REFUSED.iter().any(|(name, _)| *name == fact.path) {
            continue;
        }
        let loaded = load_file(&folder, &fact.path, Estimation::Always)
            .unwrap_or_else(|error| panic!("{error}"));
        let geometry = &loaded.object.geometry;
        assert_ne!(
            geometry.origins.normals,
            Provenance::Missing,
            "{}",
            fact.path
        );
        for block in &geometry.blocks {
            let bad = block
                .position_radius
                .iter()
                .filter(|surfel| !(surfel[3] > 0.0 && surfel[3].is_finite()))
                .count();
            assert_eq!(bad, 0, "{}: surfels without radius", fact.path);
            assert!(
                (0..block.len()).all(|surfel| block.normal_at(surfel).is_some()),
                "{}",
                fact.path
            );
        }
    }
}

#[test]
fn the_brain_is_found_to_be_inward_and_the_bunny_outward() {
    use pointstage_scene::Winding::{AsInFile, Flipped};
    let Some(folder) = data_folder() else { return };
    let wound_inward = |name: &str, winding| {
        let options = LoadOptions {
            winding,
            ..LoadOptions::default()
        };
        let loaded = load(&folder.join(name), &options, &Job::new())
            .unwrap_or_else(|error| panic!("{error}"));
        loaded.warnings.count(&WarningKind::WoundInward) > 0
    };
    assert!(wound_inward("mesh/brain_ch2better_1092k_le.ply", AsInFile));
    assert!(!wound_inward("mesh/brain_ch2better_1092k_le.ply", Flipped));
    assert!(!wound_inward("mesh/bunny_zipper_ascii.ply", AsInFile));
    assert!(wound_inward("mesh/bunny_zipper_ascii.ply", Flipped));
}

#[test]
fn colours_normals_and_named_columns_come_from_the_file() {
    let Some(folder) = data_folder() else { return };
    let pond = load_file(
        &folder,
        "points/pond_70k_normals_rgb_le.ply",
        Estimation::FileOnly,
    )
    .expect("pond");
    let block = &pond.object.geometry.blocks[0];
    // The first vertex of the file, read with Python's struct module.
    assert_eq!(
        block
            .colour
            .as_ref()
            .map(|colours| colours[0].to_le_bytes()),
        Some([57, 59, 19, 255])
    );
    let normal = block.normal_at(0).expect("normals");
    assert!(
        (normal - glam::Vec3::new(-0.697_39, -0.538_86, -0.472_52)).length() < 1e-4,
        "{normal}"
    );
    let bunny =
        load_file(&folder, "mesh/bunny_zipper_ascii.ply", Estimation::FileOnly).expect("bunny");
    let names: Vec<&str> = bunny.object.geometry.blocks[0]
        .named
        .iter()
        .map(|column| &*column.name)
        .collect();
    assert_eq!(names, ["confidence", "intensity"]);
    let split = load_file(
        &folder,
        "ply-odd/displaz_split_vertex_elements_ascii.ply",
        Estimation::FileOnly,
    )
    .expect("split");
    let block = &split.object.geometry.blocks[0];
    assert!(block.normal.is_some() && block.colour.is_some());
    assert_eq!((&*block.named[0].name, block.named[0].components), ("a", 2));
}
