//! What is written is read again: what the formats hold and what not, and files of the shared test data folder.
//!
//! The folder lies beside the checkout, or where `POINTSTAGE_TEST_DATA` says; without it those tests skip and say so.

use std::sync::Arc;

use crate::data::{REFUSED, data_folder, facts, load_file};
use crate::support::load_bytes;
use glam::{DAffine3, DVec3, Vec3};
use pointstage_plugin_api::columns::{NO_NORMAL, TangentAxes, decode_normal, encode_normal};
use pointstage_scene::{
    Block, Cancelled, Estimation, Geometry, Job, LoadOptions, Loaded, NamedColumn, Object, Origins,
    PlyEncoding, Provenance, SaveError, SaveFormat, ScalarType, Warnings, save, write_ply,
    write_sfl,
};

pub(crate) fn read(bytes: &[u8]) -> Loaded {
    let options = LoadOptions {
        estimation: Estimation::FileOnly,
        ..LoadOptions::default()
    };
    load_bytes(bytes, &options).unwrap_or_else(|error| panic!("{error}"))
}

fn as_ply(object: &Object) -> (Vec<u8>, Warnings) {
    as_ply_in(object, PlyEncoding::LittleEndian)
}

pub(crate) fn as_ply_in(object: &Object, encoding: PlyEncoding) -> (Vec<u8>, Warnings) {
    let mut bytes = Vec::new();
    let warnings =
        write_ply(object, encoding, &Job::new(), &mut bytes).expect("memory takes everything");
    (bytes, warnings)
}

pub(crate) fn as_sfl(object: &Object) -> (Vec<u8>, Warnings) {
    let mut bytes = Vec::new();
    let warnings = write_sfl(object, &Job::new(), &mut bytes).expect("memory takes everything");
    (bytes, warnings)
}

/// Compares all but where columns came from.
pub(crate) fn assert_same(what: &str, found: &Object, expected: &Object) {
    assert_eq!(found.origin, expected.origin, "{what}");
    assert_eq!(
        found.world_from_object, expected.world_from_object,
        "{what}"
    );
    let (found, expected) = (&found.geometry, &expected.geometry);
    assert_eq!(found.bounds, expected.bounds, "{what}");
    assert_eq!(found.triangles, expected.triangles, "{what}");
    assert_eq!(found.blocks.len(), expected.blocks.len(), "{what}");
    for (found, expected) in found.blocks.iter().zip(&expected.blocks) {
        assert_eq!(found.position_radius, expected.position_radius, "{what}");
        assert_eq!(found.colour, expected.colour, "{what}");
        assert_eq!(found.axes, expected.axes, "{what}");
        assert_eq!(found.named, expected.named, "{what}");
        let normals = |block: &Block| -> Option<Vec<Option<Vec3>>> {
            // On the seam of the octahedral map two codes stand for one direction.
            let direction = |code: &u32| (*code != NO_NORMAL).then(|| decode_normal(*code));
            Some(block.normal.as_ref()?.iter().map(direction).collect())
        };
        assert_eq!(normals(found), normals(expected), "{what}");
    }
}

pub(crate) fn named(
    name: &str,
    scalar: ScalarType,
    components: u32,
    count: usize,
    seed: u8,
) -> NamedColumn {
    let width = scalar.size() * components as usize;
    let bytes = (0..count * width).map(|index| (index * 37) as u8 ^ seed);
    NamedColumn {
        name: name.into(),
        scalar,
        components,
        bytes: bytes.collect(),
    }
}

/// An object with these columns; everything else follows from `seed`.
pub(crate) fn made_up(
    positions: &[[f32; 3]],
    has: [bool; 4],
    origin: DVec3,
    named: Vec<NamedColumn>,
    triangles: Option<Vec<[u32; 3]>>,
    seed: u8,
) -> Object {
    let count = positions.len();
    let [normals, radii, colours, axes] = has;
    let direction = |index: usize| {
        let angle = (index * 7 + usize::from(seed)) as f32;
        Vec3::new(angle.sin(), angle.cos(), (angle * 0.7).sin())
    };
    let block = Block {
        position_radius: positions
            .iter()
            .enumerate()
            .map(|(index, &[x, y, z])| [x, y, z, if radii { 0.1 + index as f32 } else { 0.0 }])
            .collect(),
        normal: normals.then(|| {
            let normal = |index: usize| match index {
                2 => NO_NORMAL,
                _ => encode_normal(direction(index)),
            };
            (0..count).map(normal).collect()
        }),
        colour: colours.then(|| {
            (0..count as u32)
                .map(|index| index.wrapping_mul(0x9E37_79B9))
                .collect()
        }),
        axes: axes.then(|| {
            let axes = |index: usize| {
                let u = direction(index);
                TangentAxes::new(u, u.any_orthogonal_vector()).0
            };
            (0..count).map(axes).collect()
        }),
        named,
    };
    let from_file = |is_there: bool| {
        if is_there {
            Provenance::FromFile
        } else {
            Provenance::Missing
        }
    };
    let origins = Origins {
        normals: from_file(normals),
        radii: from_file(radii),
        colours: from_file(colours),
        axes: from_file(axes),
    };
    let triangles: Option<Arc<[[u32; 3]]>> = triangles.map(Into::into);
    Object::new(
        "made up",
        origin,
        Geometry::new(vec![block], triangles, origins),
    )
}

fn square(named: Vec<NamedColumn>) -> Object {
    let corners = [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    made_up(&corners, [false; 4], DVec3::ZERO, named, None, 1)
}

fn texts(warnings: &Warnings) -> String {
    let lines: Vec<String> = warnings.iter().map(ToString::to_string).collect();
    lines.join("\n")
}

#[test]
fn names_that_ply_would_misread_are_changed() {
    let column = |name: &str| named(name, ScalarType::F32, 1, 4, 3);
    let object = square(vec![
        column("radius"),
        column("Red"),
        column("green"),
        column("blue"),
        column("nx"),
        column("two words"),
    ]);
    let (bytes, warnings) = as_ply(&object);
    assert_eq!(warnings.iter().count(), 5, "{}", texts(&warnings));
    let loaded = read(&bytes);
    let names: Vec<&str> = loaded.object.geometry.blocks[0]
        .named
        .iter()
        .map(|column| &*column.name)
        .collect();
    assert_eq!(
        names,
        [
            "named_radius",
            "named_Red",
            "named_green",
            "named_blue",
            "nx",
            "two_words"
        ]
    );
    assert!(loaded.object.geometry.blocks[0].colour.is_none());
}

#[test]
fn sfl_leaves_out_what_it_has_no_place_for_and_says_so() {
    let mut columns = vec![
        named("intensity", ScalarType::F32, 1, 4, 3),
        named("weight", ScalarType::F64, 1, 4, 3),
        named("surfel_set", ScalarType::U32, 1, 4, 3),
        named("flags", ScalarType::U32, 1, 4, 3),
    ];
    let object = made_up(
        &[[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]],
        [false; 4],
        DVec3::ZERO,
        columns.clone(),
        Some(vec![[0, 1, 2]]),
        1,
    );
    let (bytes, warnings) = as_sfl(&object);
    let text = texts(&warnings);
    assert_eq!(warnings.iter().count(), 4, "{text}");
    for part in ["no triangles", "'intensity'", "'weight'", "'surfel_set'"] {
        assert!(text.contains(part), "{text}");
    }
    let loaded = read(&bytes);
    let kept = columns.pop().expect("the last one");
    assert_eq!(loaded.object.geometry.blocks[0].named, [kept]);
}

#[test]
fn transforms_are_kept_in_sfl_and_applied_in_ply() {
    let mut object = made_up(
        &[[1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 3.0], [-8.0; 3]],
        [true; 4],
        DVec3::ZERO,
        Vec::new(),
        None,
        5,
    );
    // Doubled and turned about z, in numbers that floats hold.
    object.world_from_object = DAffine3::from_cols(
        DVec3::new(0.0, 2.0, 0.0),
        DVec3::new(-2.0, 0.0, 0.0),
        DVec3::new(0.0, 0.0, 2.0),
        DVec3::new(4.0, 5.0, 6.0),
    );
    assert_same("sfl", &read(&as_sfl(&object).0).object, &object);
    let placed = read(&as_ply(&object).0).object;
    let world = |object: &Object, index: usize| {
        let local = object.geometry.centre(index).expect("a surfel");
        object.world_from_local().transform_point3(local)
    };
    for index in 0..4 {
        let (block, before) = (&placed.geometry.blocks[0], &object.geometry.blocks[0]);
        assert_eq!(world(&placed, index), world(&object, index));
        assert_eq!(
            block.position_radius[index][3],
            2.0 * before.position_radius[index][3]
        );
        let turned = |v: Vec3| Vec3::new(-v.y, v.x, v.z);
        if index != 2 {
            let normal = block.normal_at(index).expect("normals");
            let expected = turned(before.normal_at(index).expect("normals"));
            assert!(normal.distance(expected) < 1e-4, "{normal}");
        }
        let axes = TangentAxes(block.axes.as_ref().expect("axes")[index]);
        let expected = TangentAxes(before.axes.as_ref().expect("axes")[index]);
        assert!(axes.u().distance(turned(expected.u()) * 2.0) < 1e-5);
    }
    assert_eq!(placed.world_from_object, DAffine3::IDENTITY);
}

#[test]
fn the_radius_scale_is_applied() {
    let corners = [[1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 3.0], [-8.0; 3]];
    let mut object = made_up(&corners, [true; 4], DVec3::ZERO, Vec::new(), None, 5);
    object.radius_scale = 2.0;
    for bytes in [as_ply(&object).0, as_sfl(&object).0] {
        let saved = read(&bytes).object;
        let (found, expected) = (&saved.geometry.blocks[0], &object.geometry.blocks[0]);
        for index in 0..corners.len() {
            let radius = |block: &Block| block.position_radius[index][3];
            assert_eq!(radius(found), 2.0 * radius(expected));
            let axes = |block: &Block| TangentAxes(block.axes.as_ref().expect("axes")[index]);
            assert_eq!(axes(found).v(), 2.0 * axes(expected).v());
        }
    }
}

#[test]
fn a_mirror_turns_triangles_over() {
    let mut object = square(Vec::new());
    let geometry = Arc::make_mut(&mut object.geometry);
    geometry.triangles = Some(Arc::from([[0, 1, 2]]));
    object.world_from_object = DAffine3::from_scale(DVec3::new(1.0, 1.0, -1.0));
    let loaded = read(&as_ply(&object).0);
    assert_eq!(
        loaded.object.geometry.triangles.as_deref(),
        Some(&[[0, 2, 1]][..])
    );
}

#[test]
fn files_appear_whole() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let object = square(Vec::new());
    for name in ["a.ply", "a.sfl"] {
        let path = folder.path().join(name);
        let format = SaveFormat::of_name(&path).expect("a format");
        save(&object, &path, format, &Job::new()).unwrap_or_else(|error| panic!("{error}"));
        let bytes = std::fs::read(&path).expect("the file is there");
        assert_same(name, &read(&bytes).object, &object);
        let nowhere = folder.path().join("no such folder").join(name);
        let error = save(&object, &nowhere, format, &Job::new())
            .expect_err("no folder")
            .to_string();
        assert!(error.contains("cannot be written"), "{error}");
        let job = Job::new();
        job.cancel();
        let stopped = save(&object, &folder.path().join("other"), format, &job);
        assert!(
            matches!(stopped, Err(SaveError::Cancelled(Cancelled))),
            "{stopped:?}"
        );
        let left = std::fs::read_dir(folder.path()).expect("a folder").count();
        assert!(left <= 2, "{left} files are there");
    }
}

#[test]
fn shared_files_come_back_from_both_formats() {
    let Some(folder) = data_folder() else { return };
    let entries = std::fs::read_dir(folder.join("sfl")).expect("the folder can be listed");
    for entry in entries {
        let path = entry.expect("an entry").path();
        if path.extension().is_none_or(|extension| extension != "sfl") {
            continue;
        }
        let name = format!("sfl/{}", path.file_name().unwrap().to_string_lossy());
        let mut object = load_file(&folder, &name, Estimation::FileOnly)
            .unwrap_or_else(|error| panic!("{error}"))
            .object;
        // YUV files have a column besides that only they can hold.
        let geometry = Arc::make_mut(&mut object.geometry);
        for block in &mut geometry.blocks {
            block.named.retain(|column| !column.name.ends_with("_yuv"));
        }
        let (bytes, warnings) = as_sfl(&object);
        assert!(warnings.is_empty(), "{name}: {}", texts(&warnings));
        assert_same(&name, &read(&bytes).object, &object);
        if object.geometry.surfel_count > 0 && object.world_from_local() == DAffine3::IDENTITY {
            let (bytes, warnings) = as_ply(&object);
            assert!(warnings.is_empty(), "{name}: {}", texts(&warnings));
            assert_same(&name, &read(&bytes).object, &object);
        }
    }
    for fact in facts(&folder, &["mesh/", "points/", "ply-odd/", "gsplat/"]) {
        if REFUSED.iter().any(|(name, _)| *name == fact.path) {
            continue;
        }
        let object = load_file(&folder, &fact.path, Estimation::FileOnly)
            .unwrap_or_else(|error| panic!("{error}"))
            .object;
        let (bytes, _) = as_ply(&object);
        assert_same(&fact.path, &read(&bytes).object, &object);
    }
}

#[test]
fn records_are_laid_out_as_by_the_reference_writer() {
    let Some(folder) = data_folder() else { return };
    let object = load_file(&folder, "sfl/all_properties.sfl", Estimation::FileOnly)
        .unwrap_or_else(|error| panic!("{error}"))
        .object;
    let (bytes, _) = as_sfl(&object);
    let facts = std::fs::read_to_string(folder.join("sfl/all_properties.json")).unwrap();
    let facts: serde_json::Value = serde_json::from_str(&facts).unwrap();
    let set = &facts["surfel_sets"][0];
    let numbers = |key: &str| -> Vec<u32> {
        let values = set[key].as_array().expect("numbers").iter();
        values
            .map(|value| value.as_u64().expect("a number") as u32)
            .collect()
    };
    let big_endian =
        |values: &[u32]| -> Vec<u8> { values.iter().flat_map(|v| v.to_be_bytes()).collect() };
    let holds = |part: &[u8]| bytes.windows(part.len()).any(|window| window == part);
    assert!(holds(&big_endian(&numbers("property_offsets"))));
    assert!(holds(&big_endian(&numbers("properties"))));
    let indices = numbers("property_indices");
    let indices: Vec<u8> = indices
        .iter()
        .flat_map(|v| (*v as u16).to_be_bytes())
        .collect();
    assert!(holds(&indices));
    let size = [&[0x01, 0x51, 0, 4, 0, 0, 0, 1, 0, 0, 0, 121][..]].concat();
    assert!(holds(&size));
}
