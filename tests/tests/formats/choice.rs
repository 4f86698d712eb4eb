//! Which loader gets a file: by its content before its name, unless the user says otherwise.

use anyhow::{Context as _, Result};
use pointstage_scene::{Estimation, Job, LoadOptions, LoaderChoice, load_with};
use pointstage_tests::loaders::{first_party, load_bytes};

use crate::small;

#[test]
fn every_small_file_is_known_by_its_content_whatever_its_name() -> Result<()> {
    let folder = tempfile::tempdir()?;
    let loaders = first_party()?;
    for (name, content) in small::all() {
        let loaded = load_bytes(&loaders, folder.path(), name, &content)?;
        let by_name = loaded.loader.alias;
        // CSV and PTS are one loader's.
        for other in ["renamed", "renamed.ply", "renamed.dat", "renamed.stl"] {
            let loaded = load_bytes(&loaders, folder.path(), other, &content)
                .with_context(|| format!("{name} as {other}"))?;
            assert_eq!(loaded.loader.alias, by_name, "{name} as {other}");
        }
    }
    Ok(())
}

#[test]
fn the_user_may_name_another_loader() -> Result<()> {
    let folder = tempfile::tempdir()?;
    let loaders = first_party()?;
    let path = folder.path().join("a.ply");
    // A PLY file without its first lines is points as text.
    std::fs::write(&path, "ply\n1 2 3\n4 5 6\n")?;
    let load = |loader: &str| {
        let options = LoadOptions {
            loader: Some(LoaderChoice {
                loader: loader.to_owned(),
                ..LoaderChoice::default()
            }),
            estimation: Estimation::FileOnly,
            ..LoadOptions::default()
        };
        load_with(&loaders, &path, &options, &Job::new())
    };
    assert_eq!(load("xyz")?.object.geometry.surfel_count, 2);
    assert_eq!(load("org.pointstage.xyz")?.loader.alias, "xyz");
    let error = load("ply").err().context("it is no PLY file")?.to_string();
    assert!(error.contains("a.ply, line 2"), "{error}");
    let error = load("lsa").err().context("there is none")?.to_string();
    assert!(
        error.contains("no loader 'lsa'") && error.contains("las"),
        "{error}"
    );
    Ok(())
}

#[test]
fn a_file_that_nobody_knows_tells_what_can_be_read() -> Result<()> {
    let folder = tempfile::tempdir()?;
    let error = load_bytes(&first_party()?, folder.path(), "a.bin", b"\x01\x02\x03\x04");
    let error = error.err().context("nobody's")?.to_string();
    for part in [
        "\\x01\\x02\\x03\\x04",
        "PLY",
        ".obj",
        ".laz",
        ".e57",
        ".glb",
    ] {
        assert!(error.contains(part), "{part}: {error}");
    }
    Ok(())
}
