//! What fuzzing found, and what was mended since: `tests/fuzz/found/READER/` has the files.

use std::fs;

use anyhow::{Context as _, Result};
use pointstage_scene::{Estimation, Job, LoadOptions, LoaderChoice, load_with};
use pointstage_tests::data::repository;
use pointstage_tests::loaders::first_party;

#[test]
fn files_that_fuzzing_found_are_errors_or_objects() -> Result<()> {
    let folder = repository().join("tests/fuzz/found");
    let loaders = first_party()?;
    let mut read = 0;
    for reader in fs::read_dir(&folder).with_context(|| folder.display().to_string())? {
        let reader = reader?.path();
        let alias = reader.file_name().unwrap_or_default().to_string_lossy();
        for file in fs::read_dir(&reader)? {
            let file = file?.path();
            let options = LoadOptions {
                loader: Some(LoaderChoice {
                    loader: alias.clone().into_owned(),
                    ..LoaderChoice::default()
                }),
                estimation: Estimation::FileOnly,
                ..LoadOptions::default()
            };
            read += 1;
            let Err(error) = load_with(&loaders, &file, &options, &Job::new()) else {
                continue;
            };
            let text = error.to_string();
            assert!(!text.contains("panicked"), "{}: {text}", file.display());
        }
    }
    assert!(read > 0, "{} has no files", folder.display());
    Ok(())
}
