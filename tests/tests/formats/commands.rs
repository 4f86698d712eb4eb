//! The command line with files of other formats: info names format and loader, and the choice can be overridden.

use anyhow::{Context as _, Result};
use pointstage_tests::program::Program;
use serde_json::Value;

use crate::small;

#[test]
fn info_names_the_format_and_the_loader() -> Result<()> {
    let program = Program::find()?;
    let path = program.home().join("square.dat");
    std::fs::write(&path, small::OFF)?;
    let text = program.succeed(["info".as_ref(), path.as_os_str()])?;
    assert!(
        text.contains("Object file format (OFF) (loader org.pointstage.off)"),
        "{text}"
    );
    let text = program.succeed(["info".as_ref(), "--json".as_ref(), path.as_os_str()])?;
    let facts: Value = serde_json::from_str(&text)?;
    assert_eq!(facts[0]["loader"], "org.pointstage.off");
    assert_eq!(
        (&facts[0]["surfels"], &facts[0]["triangles"]),
        (&5.into(), &6.into())
    );
    Ok(())
}

#[test]
fn the_loader_and_its_options_can_be_named() -> Result<()> {
    let program = Program::find()?;
    let path = program.home().join("points.ply");
    std::fs::write(&path, "ply\n1 2 3 4\n5 6 7 8\n9 1 2 3\n")?;
    let named = |more: &[&str]| {
        let mut words = vec!["info", "--json", path.to_str().unwrap_or_default()];
        words.extend(more);
        program.run(words)
    };
    let plain = named(&[])?;
    assert_eq!(plain.code(), Some(1), "{}", plain.stderr);
    let told = named(&["--loader", "xyz", "--set-loader", "columns=heat z y x"])?;
    let facts: Value = serde_json::from_str(&told.stdout).with_context(|| told.stderr.clone())?;
    assert_eq!(
        facts[0]["bounds"]["min"],
        serde_json::json!([3.0, 2.0, 1.0]).clone()
    );
    assert_eq!(facts[0]["columns"][0]["name"], "heat");
    for (words, part) in [
        (&["--loader", "xzy"][..], "no loader 'xzy'; did you mean"),
        (
            &["--loader", "xyz", "--set-loader", "colums=x"][..],
            "columns",
        ),
        (&["--set-loader", "columns=x"][..], "--loader"),
    ] {
        let failed = named(words)?;
        assert!(
            failed.code() != Some(0) && failed.stderr.contains(part),
            "{words:?}: {}",
            failed.stderr
        );
    }
    Ok(())
}

#[test]
fn a_picture_is_drawn_from_a_mesh_that_a_plugin_reads() -> Result<()> {
    let program = Program::find()?;
    let path = program.home().join("pyramid.off");
    let picture = program.home().join("pyramid.png");
    std::fs::write(&path, small::OFF)?;
    let words = [
        "render",
        "--no-device",
        "--background",
        "#000000",
        "--size",
        "64x48",
        "--out",
    ];
    let mut words: Vec<&std::ffi::OsStr> = words.iter().map(AsRef::as_ref).collect();
    words.extend([picture.as_os_str(), path.as_os_str()]);
    program.succeed(words)?;
    let drawn = image::open(&picture)?.to_rgb8();
    let lit = drawn.pixels().filter(|pixel| pixel.0 != [0; 3]).count();
    assert!(
        lit > 200,
        "{lit} of {} pixels are lit",
        drawn.pixels().len()
    );
    Ok(())
}

#[test]
fn the_list_of_plugins_has_the_loaders() -> Result<()> {
    let program = Program::find()?;
    let text = program.succeed(["plugins", "list"])?;
    for part in [
        "loader obj (org.pointstage.obj 0.1.0): Wavefront OBJ [.obj]",
        "loader las (org.pointstage.las 0.1.0): LAS and LAZ, COPC included [.las .laz]",
        "loader ply (org.pointstage.ply): Polygon file format (PLY) [.ply]",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
    let facts: Value = serde_json::from_str(&program.succeed(["plugins", "list", "--json"])?)?;
    let files = facts.as_array().context("a list")?;
    let plugins = files
        .iter()
        .flat_map(|file| file["plugins"].as_array().into_iter().flatten());
    let stl = plugins.clone().find(|plugin| plugin["alias"] == "stl");
    assert_eq!(
        stl.context("the loader of STL")?["extensions"],
        serde_json::json!(["stl"])
    );
    Ok(())
}
