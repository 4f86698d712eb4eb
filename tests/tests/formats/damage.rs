//! Files that end too early, or whose bytes are wrong: an error, or a part with a warning, never a panic.

use std::fmt::Write as _;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use anyhow::{Context as _, Result};
use pointstage_scene::{Estimation, Job, LoadOptions, LoaderChoice, Loaders, load_with};
use pointstage_tests::data::shared;
use pointstage_tests::loaders::{assert_cancelled_soon, first_party};

use crate::small;

/// Parts of its length at which a file is cut off.
const CUTS: usize = 200;

fn options(loader: &str) -> LoadOptions {
    LoadOptions {
        loader: Some(LoaderChoice {
            loader: loader.to_owned(),
            ..LoaderChoice::default()
        }),
        estimation: Estimation::FileOnly,
        ..LoadOptions::default()
    }
}

/// Loads `content` with the loader of its whole form; the message of an error.
fn outcome(loaders: &Loaders, path: &PathBuf, content: &[u8], loader: &str) -> Result<(), String> {
    std::fs::write(path, content).expect("the folder takes files");
    let loaded = load_with(loaders, path, &options(loader), &Job::new());
    loaded.map(|_| ()).map_err(|error| error.to_string())
}

/// Cuts a file at every part of its length. Returns how many cuts gave an error.
fn cut(loaders: &Loaders, name: &str, content: &[u8]) -> Result<usize> {
    let folder = tempfile::tempdir()?;
    let path = folder.path().join(name);
    std::fs::write(&path, content)?;
    let whole = load_with(loaders, &path, &LoadOptions::default(), &Job::new());
    let loader = whole.with_context(|| name.to_owned())?.loader.id;
    let mut errors = 0;
    for part in 0..CUTS {
        let length = content.len() * part / CUTS;
        if let Err(error) = outcome(loaders, &path, &content[..length], &loader) {
            assert!(
                !error.contains("panicked"),
                "{name} cut at {length}: {error}"
            );
            errors += 1;
        }
    }
    Ok(errors)
}

#[test]
fn small_files_cut_anywhere_are_errors_or_parts() -> Result<()> {
    let loaders = first_party()?;
    for (name, content) in small::all() {
        let errors = cut(&loaders, name, &content)?;
        let is_text = [".obj", ".csv", ".pts"]
            .iter()
            .any(|ending| name.ends_with(ending));
        // Text without counts may end at any line.
        let least = if is_text { 1 } else { CUTS * 9 / 10 };
        assert!(errors >= least, "{name}: {errors} errors of {CUTS}");
    }
    Ok(())
}

#[test]
fn real_files_cut_anywhere_are_errors() -> Result<()> {
    let loaders = first_party()?;
    for name in [
        "lone-star.copc.laz",
        "vol_total_rgb_499k.laz",
        "bunnyDouble.e57",
        "tiny_spherical.e57",
    ] {
        let Some(path) = shared(&format!("points/{name}")) else {
            return Ok(());
        };
        let errors = cut(&loaders, name, &std::fs::read(path)?)?;
        assert!(errors >= CUTS - 2, "{name}: {errors} errors of {CUTS}");
    }
    Ok(())
}

#[test]
fn real_files_with_a_wrong_byte_in_their_headers_are_errors_or_objects() -> Result<()> {
    let loaders = first_party()?;
    let folder = tempfile::tempdir()?;
    for (name, loader, step) in [
        ("lone-star.copc.laz", "las", 41),
        ("tiny_spherical.e57", "e57", 13),
    ] {
        let Some(shared) = shared(&format!("points/{name}")) else {
            return Ok(());
        };
        let content = std::fs::read(shared)?;
        let path = folder.path().join(name);
        // The counts, offsets and lengths that everything else hangs on; E57 has them as checked bytes.
        for at in (24..700).step_by(step) {
            let mut wrong = content.clone();
            wrong[at] ^= 0xff;
            // Whether it is an object still, or an error, the byte decides; it ends, and the program goes on.
            if let Err(error) = outcome(&loaders, &path, &wrong, loader) {
                assert!(error.contains(name), "byte {at}: {error}");
            }
        }
    }
    Ok(())
}

#[test]
fn small_files_with_any_byte_wrong_do_not_panic() -> Result<()> {
    let loaders = first_party()?;
    let folder = tempfile::tempdir()?;
    for (name, content) in small::all() {
        let path = folder.path().join(name);
        std::fs::write(&path, &content)?;
        let loader = load_with(&loaders, &path, &LoadOptions::default(), &Job::new())?
            .loader
            .id;
        for at in 0..content.len() {
            for wrong in [0, b'9', 0x7f, 0xff] {
                let mut content = content.clone();
                content[at] = wrong;
                if let Err(error) = outcome(&loaders, &path, &content, &loader) {
                    assert!(
                        !error.contains("panicked"),
                        "{name}, byte {at} as {wrong}: {error}"
                    );
                }
            }
        }
    }
    Ok(())
}

#[test]
fn a_cancel_ends_a_load_soon() -> Result<()> {
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("long.xyz");
    // Some seconds of reading in a build for debugging.
    let mut text = String::new();
    for row in 0..40_000 {
        let _ = writeln!(text, "{row}.25 {} 7.125 {row}", row % 77);
    }
    std::fs::write(&path, text.repeat(60))?;
    let job = Job::new();
    let worker = {
        let (job, path, loaders) = (job.clone(), path.clone(), first_party()?);
        std::thread::spawn(move || load_with(&loaders, &path, &options("xyz"), &job))
    };
    let began = Instant::now();
    while job.progress() == 0.0 && !worker.is_finished() && began.elapsed() < Duration::from_mins(1)
    {
        std::thread::yield_now();
    }
    assert!(
        job.progress() > 0.0 && job.progress() < 0.4,
        "progress {}",
        job.progress()
    );
    assert_cancelled_soon(&job, worker);
    Ok(())
}
