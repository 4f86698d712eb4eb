//! Building the program and its plugins.
//!
//! Cargo builds a cdylib of another package for nobody: neither for the program nor for its tests. So the packages
//! under `plugins/` are named to cargo here. Their libraries land beside the program, where it looks for them.

use std::path::PathBuf;

use crate::{Outcome, paths, process};

/// The names of the packages under `plugins/` that are plugins, with a manifest, and not what plugins share; sorted.
pub(crate) fn plugin_packages() -> Outcome<Vec<String>> {
    let folder = paths::root().join("plugins");
    let entries =
        std::fs::read_dir(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let mut names = Vec::new();
    for entry in entries.filter_map(Result::ok) {
        let Ok(manifest) = std::fs::read_to_string(entry.path().join("Cargo.toml")) else {
            continue;
        };
        if !entry.path().join("plugin.json").exists() {
            continue;
        }
        let name = manifest
            .lines()
            .find_map(|line| line.trim().strip_prefix("name = \"")?.strip_suffix('"'));
        names.extend(name.map(String::from));
    }
    names.sort();
    Ok(names)
}

/// Builds the program and every plugin in release; returns the program's path.
pub(crate) fn release() -> Outcome<PathBuf> {
    let plugins = plugin_packages()?;
    process::say(&format!(
        "building the program and {} plugins in release (the first time takes minutes)",
        plugins.len()
    ));
    let mut command = process::cargo(&["build", "--release", "--package", "pointstage"]);
    for plugin in &plugins {
        command.args(["--package", plugin]);
    }
    process::run("the release build", &mut command)?;
    let name = format!("pointstage{}", std::env::consts::EXE_SUFFIX);
    Ok(paths::target().join("release").join(name))
}
