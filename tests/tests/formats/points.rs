//! Point clouds made up here: positions, colours and named columns are those of the file.

use anyhow::{Context as _, Result};
use pointstage_plugin_api::settings_schema::{SettingValue, SettingValues};
use pointstage_scene::{Estimation, Job, LoadOptions, Loaded, LoaderChoice, load_with};
use pointstage_tests::loaders::{first_party, load_bytes};

use crate::meshes::colours;
use crate::small;

/// A point in the world.
pub(crate) fn at(loaded: &Loaded, point: usize) -> [f64; 3] {
    let centre = loaded
        .object
        .geometry
        .centre(point)
        .unwrap_or(glam::DVec3::NAN);
    (loaded.object.origin + centre).to_array()
}

/// A value of a named column of the first block.
pub(crate) fn value(loaded: &Loaded, name: &str, point: usize, component: u32) -> Option<f64> {
    let named = &loaded.object.geometry.blocks.first()?.named;
    named
        .iter()
        .find(|column| &*column.name == name)?
        .value(point, component)
}

#[test]
fn pcd_of_all_three_kinds_is_the_same() -> Result<()> {
    let folder = tempfile::tempdir()?;
    let loaders = first_party()?;
    for (name, content) in [
        ("a.pcd", small::pcd_text().into_bytes()),
        ("b.pcd", small::pcd_binary()),
        ("c.pcd", small::pcd_compressed()),
    ] {
        let loaded = load_bytes(&loaders, folder.path(), name, &content)?;
        assert_eq!(loaded.object.geometry.surfel_count, 3, "{name}");
        assert_eq!(at(&loaded, 2), [2.0, 2.25, -2.0], "{name}");
        assert_eq!(
            colours(&loaded),
            [[200, 0, 7], [201, 1, 7], [202, 2, 7]],
            "{name}"
        );
        assert_eq!(value(&loaded, "label", 1, 0), Some(101.0), "{name}");
        assert_eq!(value(&loaded, "d", 2, 1), Some(2.75), "{name}");
        assert_eq!(
            value(&loaded, "_", 0, 0),
            None,
            "{name}: padding is no column"
        );
    }
    Ok(())
}

#[test]
fn las_keeps_map_coordinates_and_tells_bytes_from_words() -> Result<()> {
    let folder = tempfile::tempdir()?;
    let loaders = first_party()?;
    for (brightest, expected) in [(65535, [255, 128, 0]), (200, [200, 100, 0])] {
        let colour = [brightest, brightest / 2 + u16::from(brightest > 255), 0];
        let points = [([1, 2, 3], colour), ([25, -7, 4], [0; 3])];
        let loaded = load_bytes(&loaders, folder.path(), "a.las", &small::las(&points))?;
        let [x, y, z] = at(&loaded, 1);
        let off = (x - 500_000.25)
            .abs()
            .max((y - 3_999_999.93).abs())
            .max((z - 0.04).abs());
        assert!(off < 1e-6, "{x} {y} {z}");
        assert_eq!(colours(&loaded)[0], expected);
        assert_eq!(value(&loaded, "intensity", 1, 0), Some(1001.0));
        assert_eq!(value(&loaded, "classification", 1, 0), Some(2.0));
        assert_eq!(value(&loaded, "gps_time", 1, 0), Some(1.125));
    }
    let black = load_bytes(
        &loaders,
        folder.path(),
        "a.las",
        &small::las(&[([0; 3], [0; 3])]),
    )?;
    assert!(black.object.geometry.blocks[0].colour.is_none());
    let said: Vec<String> = black.warnings.iter().map(ToString::to_string).collect();
    assert!(said.join(" ").contains("all are black"), "{said:?}");
    Ok(())
}

#[test]
fn text_is_read_by_its_heading_or_by_its_numbers_or_as_told() -> Result<()> {
    let folder = tempfile::tempdir()?;
    let loaders = first_party()?;
    let csv = load_bytes(&loaders, folder.path(), "a.csv", small::CSV.as_bytes())?;
    assert_eq!(at(&csv, 1), [4.0, 5.0, 6.5]);
    assert_eq!(colours(&csv), [[255, 0, 0], [0, 128, 255]]);
    assert_eq!(value(&csv, "time", 1, 0), Some(0.5));
    let pts = load_bytes(&loaders, folder.path(), "a.pts", small::PTS.as_bytes())?;
    assert_eq!(pts.object.geometry.surfel_count, 3);
    assert_eq!(at(&pts, 0)[0], 4_500_000.125);
    assert_eq!(colours(&pts)[2], [70, 80, 90]);
    assert_eq!(value(&pts, "intensity", 1, 0), Some(-800.0));
    // What the file calls colours is told to be something else.
    let told = |setting: &str, value: SettingValue| {
        let choice = LoaderChoice {
            loader: "xyz".to_owned(),
            settings: SettingValues::from([(setting.to_owned(), value)]),
        };
        let options = LoadOptions {
            loader: Some(choice),
            estimation: Estimation::FileOnly,
            ..LoadOptions::default()
        };
        load_with(
            &loaders,
            &folder.path().join("a.pts"),
            &options,
            &Job::new(),
        )
    };
    let columns = SettingValue::Text("z y x _ _ heat depth".to_owned());
    let turned = told("columns", columns)?;
    assert_eq!(at(&turned, 0)[2], 4_500_000.125);
    assert_eq!(value(&turned, "depth", 2, 0), Some(90.0));
    let error = told("colums", SettingValue::Bool(true));
    let error = error.err().context("there is no such option")?.to_string();
    assert!(
        error.contains("colums") && error.contains("columns"),
        "{error}"
    );
    Ok(())
}

#[test]
fn errors_of_text_name_the_line() -> Result<()> {
    let folder = tempfile::tempdir()?;
    let loaders = first_party()?;
    for (name, text, part) in [
        (
            "a.xyz",
            "1 2 3\n4 5 6\n7 8\n",
            "line 3: expected 3 numbers as in the lines before, found 2",
        ),
        ("a.xyz", "# nothing\n", "three numbers or more"),
        (
            "a.pcd",
            "VERSION 0.7\nFIELDS a b\nSIZE 4 4\nTYPE F F\nWIDTH 1\nDATA ascii\n1 2\n",
            "x, y and z",
        ),
        (
            "a.pcd",
            "VERSION 0.7\nFIELDS x y z\nSIZE 4 4\nTYPE F F F\nWIDTH 1\nDATA ascii\n",
            "3 FIELDS, 2 SIZE",
        ),
        (
            "a.pcd",
            "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 3\n",
            "line 3: expected sizes",
        ),
        ("a.pcd", "VERSION 0.7\n", "expected 'DATA'"),
    ] {
        let error = load_bytes(&loaders, folder.path(), name, text.as_bytes());
        let error = error
            .err()
            .with_context(|| format!("{text} was taken"))?
            .to_string();
        assert!(error.contains(part), "{text}: {error}");
    }
    Ok(())
}
