//! What the README and the manifest of the shared test data folder say of single files: columns, colours, edges, elements.
//!
//! The folder lies beside the checkout, or where `POINTSTAGE_TEST_DATA` says; without it these tests skip and say so.

use std::collections::HashSet;

use crate::data::{ElementFact, Fact, REFUSED, data_folder, facts, load_file};
use pointstage_scene::{
    Estimation, Geometry, Job, LoadOptions, Loaded, Provenance, ScalarType, WarningKind, Winding,
    load,
};

/// Names that become positions, normals, colours or radii, and no columns of their own.
const WITH_A_ROLE: [&str; 21] = [
    "x",
    "y",
    "z",
    "nx",
    "ny",
    "nz",
    "red",
    "green",
    "blue",
    "alpha",
    "r",
    "g",
    "b",
    "diffuse_red",
    "diffuse_green",
    "diffuse_blue",
    "psz",
    "radius",
    "a[1]", // a component of a
    "0",
    "1",
];

#[test]
fn every_property_becomes_a_column_and_every_other_element_is_named() {
    let Some(folder) = data_folder() else { return };
    let all = facts(
        &folder,
        &["mesh/", "points/", "ply-odd/", "ply-bad/", "gsplat/"],
    );
    for fact in all
        .iter()
        .filter(|fact| REFUSED.iter().all(|(name, _)| *name != fact.path))
    {
        let loaded = load_file(&folder, &fact.path, Estimation::FileOnly)
            .unwrap_or_else(|error| panic!("{error}"));
        check_columns(fact, &loaded);
        check_corners(fact, &loaded);
        check_skipped(fact, &loaded);
    }
}

#[test]
fn a_vertex_without_colour_has_the_mean_of_its_faces() {
    let Some(folder) = data_folder() else { return };
    let path = "ply-odd/plyfile_comment_in_element_ascii.ply";
    let loaded = load_file(&folder, path, Estimation::FileOnly).expect("a sound file");
    let colours = loaded.object.geometry.blocks[0].colour.as_ref();
    let found: Vec<[u8; 4]> = colours
        .expect("colours")
        .iter()
        .map(|packed| packed.to_le_bytes())
        .collect();
    // Each vertex has three of four faces of one area, in white, red, green and blue: one or two thirds of the light.
    let of_faces = |own: [[u8; 3]; 3]| {
        let channel = |index: usize| own.iter().filter(|face| face[index] == 255).count();
        let byte = |count: usize| [0, 156, 213, 255][count];
        [byte(channel(0)), byte(channel(1)), byte(channel(2)), 255]
    };
    let (white, red, green, blue) = ([255; 3], [255, 0, 0], [0, 255, 0], [0, 0, 255]);
    assert_eq!(
        found,
        [
            of_faces([white, red, green]),
            of_faces([white, green, blue]),
            of_faces([white, red, blue]),
            of_faces([red, green, blue]),
        ]
    );
}

fn check_columns(fact: &Fact, loaded: &Loaded) {
    let Some(element) = fact
        .elements
        .iter()
        .find(|element| ["vertex", "point"].contains(&element.name.as_str()))
    else {
        return;
    };
    let has = |name: &str| {
        element
            .properties
            .iter()
            .any(|property| property.ends_with(&format!(" {name}")))
    };
    let geometry = &loaded.object.geometry;
    let found = [&geometry.origins.normals, &geometry.origins.colours]
        .map(|provenance| *provenance == Provenance::FromFile);
    // Vertices without colours take those of their faces.
    let of_faces = |element: &ElementFact| {
        let has_red = |property: &String| property.ends_with(" red");
        element.name == "face" && element.properties.iter().any(has_red)
    };
    let has_colours = ["red", "r", "diffuse_red"].into_iter().any(has)
        || fact
            .elements
            .iter()
            .any(|element| element.name == "color" || of_faces(element));
    // Some programs write normals of zeros, which are none.
    let useless = loaded.warnings.count(&WarningKind::UnusableNormalsReplaced);
    let has_normals = has("nx") && useless < geometry.surfel_count as u64;
    assert_eq!(found, [has_normals, has_colours], "{}", fact.path);
    for property in element
        .properties
        .iter()
        .filter(|property| !property.starts_with("list"))
    {
        let (scalar, name) = property.split_once(' ').expect("type and name");
        // Alone they mean nothing.
        let is_word = ["r", "g", "b"].contains(&name) && !has("r");
        if WITH_A_ROLE.contains(&name) && !is_word {
            continue;
        }
        let name = name.trim_end_matches("[0]");
        let column = geometry.blocks[0]
            .named
            .iter()
            .find(|column| &*column.name == name)
            .unwrap_or_else(|| panic!("{}: no column {name}", fact.path));
        let expected = match scalar {
            "char" => ScalarType::I8,
            "uchar" => ScalarType::U8,
            "short" => ScalarType::I16,
            "ushort" => ScalarType::U16,
            "int" => ScalarType::I32,
            "uint" => ScalarType::U32,
            "float" => ScalarType::F32,
            _ => ScalarType::F64,
        };
        assert_eq!(column.scalar, expected, "{}: {name}", fact.path);
    }
}

fn check_corners(fact: &Fact, loaded: &Loaded) {
    let dropped = loaded.warnings.count(&WarningKind::FacesOutOfRangeDropped)
        + loaded.warnings.count(&WarningKind::DegenerateFacesDropped)
        + fact.vertices_not_finite;
    let (Some([smallest, largest]), Some(triangles)) =
        (fact.index_range, &loaded.object.geometry.triangles)
    else {
        return;
    };
    if dropped == 0 {
        let corners = || triangles.iter().flatten().map(|corner| i64::from(*corner));
        assert_eq!(corners().max(), Some(largest), "{}", fact.path);
        // -1 ends a strip.
        assert_eq!(corners().min(), Some(smallest.max(0)), "{}", fact.path);
    }
}

fn check_skipped(fact: &Fact, loaded: &Loaded) {
    const USED: [&str; 6] = ["vertex", "point", "face", "polygon", "tristrips", "color"];
    for element in &fact.elements {
        let is_used = USED.contains(&element.name.as_str()) || element.name.starts_with("vertex_");
        let expected = if is_used { 0 } else { element.count };
        let kind = WarningKind::ElementSkipped(element.name.clone());
        assert_eq!(
            loaded.warnings.count(&kind),
            expected,
            "{}: {}",
            fact.path,
            element.name
        );
    }
}

#[test]
fn colours_and_confidences_are_those_of_the_readme() {
    let Some(folder) = data_folder() else { return };
    for (name, expected) in [
        ("mesh/horse_rgb_be.ply", 1),
        ("mesh/laurana_rgba_le.ply", 154),
        ("mesh/sofa_textured_le.ply", 1),
    ] {
        let loaded = load_file(&folder, name, Estimation::FileOnly).expect(name);
        let colours: HashSet<u32> = loaded
            .object
            .geometry
            .blocks
            .iter()
            .filter_map(|block| block.colour.as_deref())
            .flatten()
            .copied()
            .collect();
        assert_eq!(colours.len(), expected, "{name}");
    }
    let horse = load_file(&folder, "mesh/horse_rgb_be.ply", Estimation::FileOnly).expect("horse");
    let geometry = &horse.object.geometry;
    let confidence = &geometry.blocks[0].named[0];
    assert_eq!(&*confidence.name, "confidence");
    assert!((0..geometry.surfel_count).all(|surfel| confidence.value(surfel, 0) == Some(1.0)));
    let pond = "points/pond_70k_normals_rgb_le.ply";
    let pond = load_file(&folder, pond, Estimation::FileOnly).expect(pond);
    let radii = pond.object.geometry.blocks[0].position_radius.iter();
    let largest = radii.map(|surfel| surfel[3]).fold(0.0, f32::max);
    assert!((largest - 0.0088).abs() < 0.00005, "psz up to {largest}");
}

/// Edges that one face has.
fn boundary_edges(geometry: &Geometry) -> usize {
    let mut edges: Vec<[u32; 2]> = geometry
        .triangles
        .iter()
        .flat_map(|triangles| triangles.iter())
        .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
        .map(|[a, b]| [a.min(b), a.max(b)])
        .collect();
    edges.sort_unstable();
    edges
        .chunk_by(|a, b| a == b)
        .filter(|same| same.len() == 1)
        .count()
}

#[test]
fn the_dragon_has_the_boundary_of_the_readme_and_the_brain_has_none() {
    let Some(folder) = data_folder() else { return };
    for (name, expected) in [
        ("mesh/dragon_vrip_437k_le.ply", 4270),
        ("mesh/brain_ch2better_1092k_le.ply", 0),
    ] {
        let loaded = load_file(&folder, name, Estimation::FileOnly).expect(name);
        assert_eq!(boundary_edges(&loaded.object.geometry), expected, "{name}");
    }
}

#[test]
fn the_inward_brain_comes_with_the_offer_to_flip_and_flipping_turns_its_normals() {
    let Some(folder) = data_folder() else { return };
    let loaded_as = |winding| {
        let options = LoadOptions {
            winding,
            ..LoadOptions::default()
        };
        let path = folder.join("mesh/brain_ch2better_1092k_le.ply");
        load(&path, &options, &Job::new()).unwrap_or_else(|error| panic!("{error}"))
    };
    let (inward, flipped) = (loaded_as(Winding::AsInFile), loaded_as(Winding::Flipped));
    let offer = |loaded: &Loaded| {
        loaded
            .warnings
            .iter()
            .any(|warning| warning.to_string().contains("flip it"))
    };
    assert!(offer(&inward) && !offer(&flipped));
    let normals = |loaded: &Loaded, surfel| {
        loaded.object.geometry.blocks[0]
            .normal_at(surfel)
            .expect("normals")
    };
    for surfel in (0..1_000_000).step_by(1009) {
        let cosine = normals(&inward, surfel).dot(normals(&flipped, surfel));
        assert!(cosine < -0.999, "surfel {surfel}: cosine {cosine}");
    }
}

#[test]
fn files_that_the_manifest_does_not_describe_are_as_the_readme_says() {
    let Some(folder) = data_folder() else { return };
    let counts = |name: &str| {
        let loaded = load_file(&folder, name, Estimation::FileOnly).expect(name);
        let geometry = &loaded.object.geometry;
        (geometry.surfel_count, geometry.triangle_count())
    };
    assert_eq!(counts("ply-odd/assimp_crlf_header_binary_le.ply"), (8, 12));
    assert_eq!(
        counts("ply-odd/displaz_split_vertex_elements_ascii.ply"),
        (20, 0)
    );
    assert_eq!(counts("ply-odd/plyrs_leading_spaces_ascii.ply"), (4, 0));
    for (name, kind, expected) in [
        (
            "displaz_polygon_complex_double_rgb",
            WarningKind::NonConvexPolygonsCut,
            3,
        ),
        ("displaz_polygon_closed", WarningKind::PolygonHolesFilled, 1),
        ("displaz_polygon_2d_no_z", WarningKind::NoZ, 1),
        ("draco_float_inf", WarningKind::NonFinitePositionsDropped, 3),
    ] {
        let path = format!("ply-odd/{name}_ascii.ply");
        let loaded = load_file(&folder, &path, Estimation::FileOnly).expect(name);
        assert_eq!(loaded.warnings.count(&kind), expected, "{name}");
    }
}
