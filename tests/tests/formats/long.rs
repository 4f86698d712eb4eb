//! Files that are longer than what one thread reads at a time: they hold the same as short ones, in the same order.

use std::fmt::Write as _;

use anyhow::{Context as _, Result};
use glam::{DVec3, Vec3};
use pointstage_scene::Loaded;
use pointstage_tests::loaders::{first_party, load_as_it_is, load_bytes};
use pointstage_tests::mesh_files::{Mesh, write_all};

/// Digits behind the point in the files of text.
const STEP: f64 = 1e-6;

/// Places of the corners of all triangles.
fn corners(loaded: &Loaded) -> Vec<[DVec3; 3]> {
    let geometry = &loaded.object.geometry;
    let place = |corner: u32| geometry.centre(corner as usize).unwrap_or(DVec3::NAN);
    let triangles = geometry.triangles.iter().flat_map(|all| all.iter());
    triangles.map(|corners| corners.map(place)).collect()
}

#[test]
fn every_format_gives_the_triangles_of_one_long_mesh() -> Result<()> {
    let folder = tempfile::tempdir()?;
    let loaders = first_party()?;
    let ball = Mesh::ball(100);
    let files = write_all(&ball, folder.path(), "ball")?;
    let named = |ending: &str| {
        let file = files
            .iter()
            .find(|file| file.to_string_lossy().ends_with(ending));
        file.with_context(|| format!("no file ends in {ending}"))
    };
    let whole = load_as_it_is(&loaders, named(".glb")?)?;
    let expected = corners(&whole);
    assert_eq!(expected.len(), 2 * 99 * 200);
    for ending in ["text.ply", ".obj", ".off", ".tri", "stl.stl", "text.stl"] {
        let file = named(ending)?;
        let length = std::fs::metadata(file)?.len();
        assert!(length > 3 * (256 << 10), "{ending} has {length} bytes only");
        let loaded = load_as_it_is(&loaders, file)?;
        let count = loaded.object.geometry.surfel_count;
        assert_eq!(count, whole.object.geometry.surfel_count, "{ending}");
        let found = corners(&loaded);
        assert_eq!(found.len(), expected.len(), "{ending}");
        for (index, (found, expected)) in found.iter().zip(&expected).enumerate() {
            let farthest = (0..3).map(|corner| found[corner].distance(expected[corner]));
            let farthest = farthest.fold(0.0, f64::max);
            assert!(
                farthest < 2.0 * STEP,
                "{ending}, triangle {index}: {farthest}"
            );
        }
    }
    for ending in [".xyz", ".pts", ".pcd"] {
        let loaded = load_as_it_is(&loaders, named(ending)?)?;
        let geometry = &loaded.object.geometry;
        assert_eq!(geometry.surfel_count, 20_000, "{ending}");
        for index in 0..geometry.surfel_count {
            let places = [geometry, &whole.object.geometry].map(|all| all.centre(index));
            let [Some(found), Some(expected)] = places else {
                panic!("{ending}: no surfel {index}");
            };
            assert!(found.distance(expected) < 2.0 * STEP, "{ending}, {index}");
        }
    }
    Ok(())
}

#[test]
fn corners_of_obj_that_count_from_the_end_do_so_in_the_whole_file() -> Result<()> {
    const TRIANGLES: u32 = 30_000;
    let folder = tempfile::tempdir()?;
    let mut text = String::from("vn 0 0 1\nvn 0 1 0\n");
    for x in 0..TRIANGLES {
        let normal = if x % 2 == 0 { "-1" } else { "1" };
        write!(
            text,
            "v {x} 0 0\nv {x} 1 0\nv {x} 0 1\nf -3//{normal} \\\n-2//{normal} -1//{normal}\n"
        )?;
    }
    assert!(text.len() > 4 * (256 << 10), "{} bytes", text.len());
    let loaded = load_bytes(&first_party()?, folder.path(), "a.obj", text.as_bytes())?;
    let geometry = &loaded.object.geometry;
    let triangles = geometry.triangles.as_deref().context("a mesh")?;
    let expected = (0..TRIANGLES).map(|x| [3 * x, 3 * x + 1, 3 * x + 2]);
    assert!(triangles.iter().copied().eq(expected));
    for index in 0..3 * TRIANGLES as usize {
        let normal = geometry.blocks[0].normal_at(index).unwrap_or(Vec3::NAN);
        let expected = if index / 3 % 2 == 0 { Vec3::Y } else { Vec3::Z };
        assert!(normal.distance(expected) < 1e-3, "{index}: {normal}");
    }
    Ok(())
}

#[test]
fn colours_of_faces_of_a_long_off_file_stay_with_them() -> Result<()> {
    const FACES: u32 = 40_000;
    let folder = tempfile::tempdir()?;
    let mut text = format!("OFF\n# a comment\n{} {FACES} 0\n", 3 * FACES);
    for x in 0..FACES {
        write!(text, "{x} 0 0 # first\n{x} 1 0\n\n{x} 0 1\n")?;
    }
    for face in 0..FACES {
        let corner = 3 * face;
        // The first third of the faces has no colour.
        let colour = match face {
            0..13_000 => "",
            _ if face % 2 == 0 => " 255 0 0",
            _ => " 0 0 255",
        };
        writeln!(text, "3 {corner} {} {}{colour}", corner + 1, corner + 2)?;
    }
    let loaded = load_bytes(&first_party()?, folder.path(), "a.off", text.as_bytes())?;
    let colours = crate::meshes::colours(&loaded);
    assert_eq!(colours.len(), 3 * FACES as usize);
    for (vertex, colour) in colours.iter().enumerate() {
        let expected = match vertex / 3 {
            0..13_000 => [255; 3],
            face if face % 2 == 0 => [255, 0, 0],
            _ => [0, 0, 255],
        };
        assert_eq!(*colour, expected, "vertex {vertex}");
    }
    Ok(())
}

#[test]
fn a_wrong_line_far_in_is_named() -> Result<()> {
    let folder = tempfile::tempdir()?;
    let loaders = first_party()?;
    let rows = |row: &str| format!("{row}\n").repeat(60_000);
    let facet = "facet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n";
    let facets = facet.repeat(20_000);
    for (name, text, part) in [
        (
            "a.obj",
            rows("v 1.25 2.5 3") + "v 1 x 0\n",
            "line 60001: expected 3 to 7 numbers",
        ),
        (
            "a.xyz",
            rows("1.25 2.5 3") + "1 2\n" + &rows("1 2 3"),
            "line 60001: expected 3 numbers",
        ),
        (
            "a.off",
            format!("OFF\n60001 0 0\n{}1 2 y\n", rows("1.25 2.5 3")),
            "line 60003: expected 3 numbers of a vertex",
        ),
        (
            "b.off",
            format!("OFF\n60000 3 0\n{}3 0 1 2\n3 0 1\n", rows("1.25 2.5 3")),
            "line 60004: expected 3 corners",
        ),
        (
            "c.off",
            format!("OFF\n60000 3 0\n{}3 0 1 2\n\n", rows("1.25 2.5 3")),
            "line 60004: expected face 2 of 3",
        ),
        (
            "a.stl",
            format!("solid a\n{facets}facet\nouter loop\nvertex 1 2\n"),
            "line 140004: expected three numbers",
        ),
        (
            "b.stl",
            format!(
                "solid a\n{facets}facet\nouter loop\nvertex 1 2 3\nendfacet\n{facets}endsolid\n"
            ),
            "line 140005: expected three vertices",
        ),
        (
            "c.stl",
            format!("solid a\n{facets}\n"),
            "line 140001: expected 'endsolid'",
        ),
    ] {
        let error = load_bytes(&loaders, folder.path(), name, text.as_bytes());
        let error = error.err().with_context(|| format!("{name} was taken"))?;
        let said = error.to_string();
        assert!(said.contains(part), "{name}: {said}");
    }
    Ok(())
}
