//! Loaders at the border: a good one, and one for each fault. The host goes on after each.

use std::path::Path;
use std::time::Duration;

use anyhow::{Context as _, Result};
use pointstage_engine::plugins::{
    ChildProgram, DiscoverOptions, Examination, Registry, VerdictClass,
};
use pointstage_plugin_api::settings_schema::{SettingValue, SettingValues};
use pointstage_scene::{
    Job, LoadOptions, LoaderChoice, Loaders, Provenance, WarningKind, load_with,
};
use pointstage_tests::loaders::{assert_cancelled_soon, load_bytes, with_libraries};
use pointstage_tests::plugins;

fn readers() -> Result<Loaders> {
    with_libraries(&[plugins::readers()?])
}

/// The error of loading `content`.
fn error_of(folder: &Path, content: &str) -> Result<String> {
    let loaded = load_bytes(&readers()?, folder, "file", content.as_bytes());
    Ok(loaded.err().context("it was taken")?.to_string())
}

#[test]
fn a_strangers_loader_makes_an_object_as_any_other() -> Result<()> {
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("a.ply");
    std::fs::write(&path, "good!")?;
    let job = Job::new();
    let choice = LoaderChoice {
        loader: "good".to_owned(),
        settings: SettingValues::from([("scale".to_owned(), SettingValue::Int(4))]),
    };
    let options = LoadOptions {
        loader: Some(choice.clone()),
        ..LoadOptions::default()
    };
    let loaded = load_with(&readers()?, &path, &options, &job)?;
    let geometry = &loaded.object.geometry;
    assert_eq!(loaded.loader.id, "org.pointstage.test.good");
    assert_eq!(loaded.object.loader, Some(choice));
    assert_eq!((geometry.surfel_count, geometry.triangle_count()), (3, 1));
    assert_eq!(geometry.bounds.size().x, 4.0);
    assert_eq!(geometry.origins.normals, Provenance::FromFaces);
    let kind = WarningKind::Other("a letter is ignored".to_owned());
    assert_eq!(loaded.warnings.count(&kind), 1);
    assert_eq!(job.progress(), 1.0);
    // By content alone, whatever the name.
    let chosen = load_with(&readers()?, &path, &LoadOptions::default(), &Job::new())?;
    assert_eq!(
        (chosen.loader.alias.as_str(), chosen.object.loader),
        ("good", None)
    );
    Ok(())
}

#[test]
fn faults_of_a_loader_are_errors_that_name_file_and_fault() -> Result<()> {
    let folder = tempfile::tempdir()?;
    for (content, part) in [
        ("good", "byte 4: expected a letter"),
        ("panics", "the plugin panicked in load: what a pity"),
        (
            "careless",
            "broke its own rules: 3 surfels of column 0 take 36 bytes, got 35",
        ),
        ("empty", "ended without declaring columns"),
        // It panics at the look at the file: nobody else knows that either.
        ("moody", "which no loader knows"),
    ] {
        let error = error_of(folder.path(), content)?;
        assert!(
            error.contains(part) && error.contains("file"),
            "{content}: {error}"
        );
    }
    Ok(())
}

#[test]
fn a_cancel_reaches_a_loader_that_asks() -> Result<()> {
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("file");
    std::fs::write(&path, "slow")?;
    let job = Job::new();
    let worker = {
        let (job, loaders) = (job.clone(), readers()?);
        std::thread::spawn(move || load_with(&loaders, &path, &LoadOptions::default(), &job))
    };
    while job.stage() != "sleeping" && !worker.is_finished() {
        std::thread::sleep(Duration::from_millis(1));
    }
    assert_cancelled_soon(&job, worker);
    Ok(())
}

#[test]
fn a_loader_that_fails_at_the_first_look_is_refused_before_any_file_is_opened() -> Result<()> {
    let child = ChildProgram::new(env!("CARGO_BIN_EXE_examiner").into());
    let registry = Registry::discover(&DiscoverOptions {
        files: vec![plugins::panicky_reader()?, plugins::readers()?],
        examination: Examination::Child(child),
        ..DiscoverOptions::default()
    });
    let [panicky, readers] = registry.files() else {
        anyhow::bail!("two files have two verdicts");
    };
    assert_eq!(panicky.verdict.class, VerdictClass::Rejected);
    let message = &panicky.verdict.message;
    assert!(
        message.contains("first look at a file") && message.contains("index out of bounds"),
        "{message}"
    );
    assert_eq!(
        readers.verdict.class,
        VerdictClass::Ok,
        "{}",
        readers.verdict.message
    );
    assert_eq!(registry.loaders().len(), 6);
    Ok(())
}
