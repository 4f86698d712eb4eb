//! `pointstage convert`: what is written holds what was read, and nothing is replaced or left out in silence.

use std::fmt::Write as _;
use std::path::Path;

use anyhow::{Context as _, Result};
use pointstage_scene::{Estimation, Job, LoadOptions, Loaded, Object, Provenance, load};
use pointstage_tests::data::shared;
use pointstage_tests::program::{Finished, Program};

use crate::small;

/// A file as it is, with nothing estimated.
fn read(path: &Path) -> Result<Loaded> {
    let options = LoadOptions {
        estimation: Estimation::FileOnly,
        ..LoadOptions::default()
    };
    Ok(load(path, &options, &Job::new())?)
}

fn convert(program: &Program, from: &Path, to: &Path, more: &[&str]) -> Result<Finished> {
    let from = from.to_str().context("a name")?;
    let to = to.to_str().context("a name")?;
    let mut words = vec!["convert", from, "--out", to];
    words.extend(more);
    program.run(words)
}

fn converted(program: &Program, from: &Path, to: &Path, more: &[&str]) -> Result<String> {
    let finished = convert(program, from, to, more)?;
    anyhow::ensure!(finished.status.success(), "{}", finished.stderr);
    Ok(finished.stderr)
}

fn assert_same_columns(found: &Loaded, expected: &Loaded, what: &str) {
    let (found, expected) = (&found.object.geometry, &expected.object.geometry);
    assert_eq!(found.triangles, expected.triangles, "{what}");
    for (found, expected) in found.blocks.iter().zip(&expected.blocks) {
        assert_eq!(found.position_radius, expected.position_radius, "{what}");
        assert_eq!(found.normal, expected.normal, "{what}");
        assert_eq!(found.colour, expected.colour, "{what}");
        assert_eq!(found.axes, expected.axes, "{what}");
        assert_eq!(found.named, expected.named, "{what}");
    }
}

const COLOURED: &str = "ply
format ascii 1.0
element vertex 4
property float x
property float y
property float z
property uchar red
property uchar green
property uchar blue
property float heat
property short class
element face 2
property list uchar int vertex_indices
end_header
0 0 0.1 255 0 0 0.25 -3
1 0 0 0 255 0 1e-20 4
1 1.3333333 0 0 0 255 3e20 5
0 1 0 9 8 7 -0.5 6
3 0 1 2
3 0 2 3
";

#[test]
fn ply_keeps_every_column_in_every_encoding() -> Result<()> {
    let program = Program::find()?;
    let from = program.home().join("from.ply");
    std::fs::write(&from, COLOURED)?;
    let expected = read(&from)?;
    for (name, option, start) in [
        (
            "little.ply",
            "--binary",
            "ply\nformat binary_little_endian 1.0\n",
        ),
        (
            "big.ply",
            "--big-endian",
            "ply\nformat binary_big_endian 1.0\n",
        ),
        ("text.ply", "--ascii", "ply\nformat ascii 1.0\n"),
    ] {
        let to = program.home().join(name);
        converted(&program, &from, &to, &[option])?;
        assert!(std::fs::read(&to)?.starts_with(start.as_bytes()), "{name}");
        let found = read(&to)?;
        assert_same_columns(&found, &expected, name);
        assert_eq!(
            found.object.geometry.origins,
            expected.object.geometry.origins
        );
    }
    Ok(())
}

#[test]
fn a_mesh_of_a_plugin_s_format_becomes_surfels_and_says_what_is_left_out() -> Result<()> {
    let program = Program::find()?;
    let from = program.home().join("pyramid.off");
    std::fs::write(&from, small::OFF)?;
    let bare = program.home().join("bare.sfl");
    let said = converted(&program, &from, &bare, &[])?;
    assert!(
        said.contains("SFL files hold no triangles: left out"),
        "{said}"
    );
    assert!(said.contains("--estimate radii makes them"), "{said}");
    let to = program.home().join("pyramid.sfl");
    let said = converted(&program, &from, &to, &["--estimate", "normals,radii"])?;
    assert!(!said.contains("makes them"), "{said}");
    let loaded = read(&to)?;
    assert_eq!(loaded.object.geometry.surfel_count, 5);
    let origins = loaded.object.geometry.origins;
    assert_eq!(
        (origins.normals, origins.radii),
        (Provenance::FromFile, Provenance::FromFile)
    );
    // What SFL cannot hold by name.
    let coloured = program.home().join("coloured.ply");
    std::fs::write(&coloured, COLOURED)?;
    let said = converted(&program, &coloured, &program.home().join("c.sfl"), &[])?;
    for column in ["'heat'", "'class'"] {
        assert!(
            said.contains(&format!("no place for column {column}")),
            "{said}"
        );
    }
    Ok(())
}

/// Points of a sphere around (5, 0, 0), evenly wound from pole to pole.
fn sphere() -> String {
    let mut text = String::new();
    for number in 0..1500 {
        let (height, turn) = (
            1.0 - f64::from(number) / 749.5,
            f64::from(number) * 2.399_963,
        );
        let level = (1.0 - height * height).max(0.0).sqrt();
        let (x, z) = (5.0 + level * turn.cos(), level * turn.sin());
        let _ = writeln!(text, "{x} {height} {z}");
    }
    text
}

#[test]
fn points_get_oriented_normals_radii_and_axes() -> Result<()> {
    let program = Program::find()?;
    let from = program.home().join("sphere.xyz");
    std::fs::write(&from, sphere())?;
    let to = program.home().join("sphere.ply");
    let options = ["--estimate", "normals,radii,axes", "--orient", "--k", "12"];
    let said = converted(&program, &from, &to, &options)?;
    for note in [
        "1500 normals oriented",
        "1500 radii",
        "1500 pairs of tangent axes",
    ] {
        assert!(said.contains(&format!("sphere.xyz: {note}")), "{said}");
    }
    let loaded = read(&to)?;
    let block = &loaded.object.geometry.blocks[0];
    for surfel in 0..block.len() {
        let out = block.centre(surfel) - glam::Vec3::X * 5.0;
        let normal = block.normal_at(surfel).context("a normal")?;
        assert!(normal.dot(out) > 0.98, "surfel {surfel}: {normal} at {out}");
        let radius = block.position_radius[surfel][3];
        // 1500 disks over 4π, each a few times what it has for itself.
        assert!((0.04..0.2).contains(&radius), "surfel {surfel}: {radius}");
    }
    assert!(block.axes.is_some());
    let flipped = program.home().join("flipped.ply");
    converted(&program, &to, &flipped, &["--flip"])?;
    let flipped = read(&flipped)?;
    let normal = |loaded: &Loaded| loaded.object.geometry.blocks[0].normal_at(7);
    let (before, after) = (
        normal(&loaded).context("one")?,
        normal(&flipped).context("one")?,
    );
    assert!(before.dot(after) < -0.99, "{before} became {after}");
    Ok(())
}

#[test]
fn surfels_go_to_ply_and_back() -> Result<()> {
    let program = Program::find()?;
    for name in ["bunny_ps3d", "mask_pnrt", "mask_misc", "all_properties"] {
        let Some(from) = shared(&format!("sfl/{name}.sfl")) else {
            continue;
        };
        let ply = program.home().join(format!("{name}.ply"));
        let back = program.home().join(format!("{name}.sfl"));
        converted(&program, &from, &ply, &[])?;
        converted(&program, &ply, &back, &[])?;
        let (before, after) = (read(&from)?, read(&back)?);
        if before.object.world_from_object == glam::DAffine3::IDENTITY {
            assert_same_columns(&after, &before, name);
            continue;
        }
        // The transform has become part of the columns.
        assert_eq!(after.object.world_from_object, glam::DAffine3::IDENTITY);
        let (before, after) = (&before.object, &after.object);
        for surfel in 0..before.geometry.surfel_count {
            let world = |object: &Object| {
                let local = object.geometry.centre(surfel).context("a surfel")?;
                anyhow::Ok(object.world_from_local().transform_point3(local))
            };
            let (before, after) = (world(before)?, world(after)?);
            assert!(
                before.distance(after) <= 1e-6 * before.length(),
                "{before} became {after}"
            );
        }
    }
    Ok(())
}

#[test]
fn nothing_is_replaced_unasked_and_wrong_words_are_refused() -> Result<()> {
    let program = Program::find()?;
    let from = program.home().join("from.ply");
    std::fs::write(&from, COLOURED)?;
    let to = program.home().join("to.ply");
    std::fs::write(&to, "precious")?;
    let failed = convert(&program, &from, &to, &[])?;
    assert_eq!(failed.code(), Some(1));
    assert!(failed.stderr.contains("there already") && failed.stderr.contains("--force"));
    assert_eq!(std::fs::read_to_string(&to)?, "precious");
    let failed = convert(&program, &from, &from, &[])?;
    assert!(
        failed.stderr.contains("the file that is read"),
        "{}",
        failed.stderr
    );
    converted(&program, &from, &to, &["--force"])?;
    assert_eq!(read(&to)?.object.geometry.surfel_count, 4);
    let home = program.home().to_path_buf();
    for (to, more, part) in [
        (home.join("a.obj"), &[][..], "--format"),
        (
            home.join("a.sfl"),
            &["--ascii"][..],
            "SFL files have one form",
        ),
        (
            home.join("a.ply"),
            &["--ascii", "--big-endian"][..],
            "cannot be used with",
        ),
        (home.join("a.ply"), &["--k", "2"][..], "from 3 to 64"),
        (home.join("a.ply"), &["--loader", "pyl"][..], "did you mean"),
        (
            home.join("a.ply"),
            &[to.to_str().context("a name")?][..],
            "is no folder",
        ),
    ] {
        let failed = convert(&program, &from, &to, more)?;
        assert!(failed.code() != Some(0), "{more:?}");
        assert!(failed.stderr.contains(part), "{more:?}: {}", failed.stderr);
        assert!(!to.exists(), "{more:?}");
    }
    Ok(())
}

#[test]
fn several_files_go_into_a_folder_each_under_its_name() -> Result<()> {
    let program = Program::find()?;
    let folder = program.home().join("converted");
    std::fs::create_dir(&folder)?;
    let (a, b) = (program.home().join("a.off"), program.home().join("b.ply"));
    std::fs::write(&a, small::OFF)?;
    std::fs::write(&b, COLOURED)?;
    let b_name = b.to_str().context("a name")?;
    converted(&program, &a, &folder, &[b_name, "--format", "ply"])?;
    assert_eq!(
        read(&folder.join("a.ply"))?
            .object
            .geometry
            .triangle_count(),
        6
    );
    assert_eq!(
        read(&folder.join("b.ply"))?
            .object
            .geometry
            .triangle_count(),
        2
    );
    Ok(())
}

#[test]
fn several_files_become_one_where_they_are_merged() -> Result<()> {
    let program = Program::find()?;
    let home = program.home();
    let [coloured, points, to] = ["a.ply", "b.xyz", "both.ply"].map(|name| home.join(name));
    std::fs::write(&coloured, COLOURED)?;
    std::fs::write(&points, "10 0 0\n11 0.5 0\n")?;
    let points_name = points.to_str().context("a name")?;
    let said = converted(&program, &coloured, &to, &["--merge", points_name])?;
    assert!(said.contains("6 surfels"), "{said}");
    let both = read(&to)?.object.geometry;
    let block = &both.blocks[0];
    let places: Vec<[f32; 3]> = block
        .position_radius
        .iter()
        .map(|[x, y, z, _]| [*x, *y, *z])
        .collect();
    assert_eq!(places[4..], [[10.0, 0.0, 0.0], [11.0, 0.5, 0.0]]);
    assert!(block.colour.is_some() && both.triangle_count() == 2);
    // A folder is not one file; one file alone stays what it is.
    let folder = home.join("folder");
    std::fs::create_dir(&folder)?;
    let refused = convert(&program, &coloured, &folder, &["--merge", points_name])?;
    assert_eq!(refused.status.code(), Some(2), "{}", refused.stderr);
    let alone = convert(&program, &coloured, &to, &["--merge", "--force"])?;
    assert!(alone.status.success(), "{}", alone.stderr);
    Ok(())
}

#[test]
fn textures_go_beside_a_ply_file_and_replace_nothing() -> Result<()> {
    let program = Program::find()?;
    let at = |name: &str| program.home().join(name);
    std::fs::write(at("corners.ply"), crate::kept_textures::CORNERS)?;
    let wood = crate::textures::encoded(&crate::textures::halves(64), image::ImageFormat::Png)?;
    std::fs::write(at("wood.png"), &wood)?;
    std::fs::write(at("new.png"), "mine")?;
    let said = converted(&program, &at("corners.ply"), &at("new.ply"), &[])?;
    assert!(said.contains("new_2.png: picture of its texture"), "{said}");
    assert!(!said.contains("left out: the surfels"), "{said}");
    assert_eq!(std::fs::read(at("new_2.png"))?, wood);
    assert_eq!(std::fs::read(at("new.png"))?, b"mine");
    let back = read(&at("new.ply"))?;
    let textures = crate::kept_textures::textures(&back.object.geometry)?;
    assert_eq!(*textures.pictures[0].bytes, *wood);
    let said = converted(&program, &at("corners.ply"), &at("new.sfl"), &[])?;
    assert!(
        said.contains("warning") && said.contains("SFL files hold no textures"),
        "{said}"
    );
    Ok(())
}
