//! `cargo xtask fuzz`: every reader of files against wrong ones.

use std::path::Path;
use std::process::Command;

use crate::{Outcome, paths, process};

/// The readers, which are the fuzz targets.
const READERS: [&str; 12] = [
    "ply", "sfl", "tri", "qs", "obj", "stl", "off", "gltf", "las", "e57", "pcd", "xyz",
];

/// Seconds for each reader unless told otherwise.
const SECONDS: u32 = 60;

/// Of an input: one that takes longer is reported, and so is one for which the process grows beyond.
const LIMITS: [&str; 3] = ["-timeout=20", "-rss_limit_mb=2048", "-max_len=262144"];

/// Fuzzes these readers, all of them when none is named, for `--seconds N` each. What is found is written into
/// `tests/fuzz/artifacts/READER/`, and the next readers have their turn all the same.
pub(crate) fn fuzz(arguments: &[String]) -> Outcome {
    let (readers, seconds) = parse(arguments)?;
    let folder = paths::root().join("tests").join("fuzz");
    if process::output(Command::new("cargo").args(["fuzz", "--version"])).is_none() {
        return Err(
            "fuzzing takes cargo-fuzz; install it by `cargo install cargo-fuzz --locked`"
                .to_owned(),
        );
    }
    let seeds = folder.join("corpus");
    write_seeds(&folder, &seeds)?;
    let mut failed = Vec::new();
    for reader in readers {
        let corpus = seeds.join(reader);
        std::fs::create_dir_all(&corpus)
            .map_err(|error| format!("{}: {error}", paths::shown(&corpus)))?;
        let mut command = cargo_fuzz(&folder, "run");
        command.arg(reader).arg(&corpus);
        // What was found before comes first again.
        let found = folder.join("found").join(reader);
        if found.is_dir() {
            command.arg(found);
        }
        command.arg("--").arg(format!("-max_total_time={seconds}"));
        command.args(LIMITS);
        if process::run(&format!("{reader}, {seconds} s"), &mut command).is_err() {
            failed.push(reader);
        }
    }
    if failed.is_empty() {
        Ok(())
    } else {
        Err(format!(
            "found something in: {}; see tests/fuzz/artifacts, mend it, and keep the file in tests/fuzz/found/READER",
            failed.join(", ")
        ))
    }
}

fn parse(arguments: &[String]) -> Outcome<(Vec<&'static str>, u32)> {
    let (mut readers, mut seconds) = (Vec::new(), SECONDS);
    let mut words = arguments.iter();
    while let Some(word) = words.next() {
        if word == "--seconds" {
            seconds = words
                .next()
                .and_then(|text| text.parse().ok())
                .ok_or("--seconds takes a whole number")?;
            continue;
        }
        let known = READERS.iter().find(|reader| *reader == word);
        readers.push(*known.ok_or_else(|| {
            format!(
                "there is no reader '{word}'; there are {}",
                READERS.join(", ")
            )
        })?);
    }
    if readers.is_empty() {
        readers = READERS.to_vec();
    }
    Ok((readers, seconds))
}

/// Small files and real ones, a folder a reader.
fn write_seeds(folder: &Path, seeds: &Path) -> Outcome {
    let mut command = process::cargo(&["run", "--release", "--quiet", "--manifest-path"]);
    let manifest = folder.join("seeds").join("Cargo.toml");
    command.arg(manifest).arg("--").arg(seeds);
    let facts = paths::shared_data("manifest.json");
    match facts.as_deref().and_then(Path::parent) {
        Some(shared) => {
            command.arg(shared);
        }
        None => process::say(&paths::no_shared_data("manifest.json")),
    }
    process::run("the seeds", &mut command)
}

/// cargo-fuzz without a sanitizer, which a toolchain of the stable channel does not have; everything read is safe Rust.
fn cargo_fuzz(folder: &Path, what: &str) -> Command {
    let mut command = process::cargo(&["fuzz", what]);
    command.arg("--fuzz-dir").arg(folder);
    command.args(["--sanitizer", "none"]);
    command
}
