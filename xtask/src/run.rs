//! `cargo xtask run`: from a clone to a picture.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::json::Value;
use crate::{Outcome, build, paths, process, setup};

/// Sets the machine up, builds, and shows the sample or the files named in `arguments`.
pub(crate) fn run(arguments: &[String]) -> Outcome {
    let (files, passed_on) = split(arguments)?;
    let needs = setup::Needs {
        window: has_display(),
        tests: false,
    };
    if let Err(message) = setup::set_up(needs) {
        // The program has a renderer that needs no device, and says itself what a missing library costs.
        process::say(&format!("going on without: {message}"));
    }
    let program = build::release()?;
    if has_display() {
        open_window(&program, &files, passed_on)
    } else {
        draw_pictures(&program, &files, passed_on)
    }
}

/// Splits the arguments at `--` into files (the sample where there is none) and what goes to the program.
fn split(arguments: &[String]) -> Outcome<(Vec<PathBuf>, &[String])> {
    let end = arguments
        .iter()
        .position(|argument| argument == "--")
        .unwrap_or(arguments.len());
    let passed_on = arguments.get(end + 1..).unwrap_or_default();
    let mut files = Vec::new();
    for argument in &arguments[..end] {
        if argument.starts_with('-') {
            return Err(format!(
                "'{argument}' was not expected; arguments for the program go after `--`"
            ));
        }
        let file = PathBuf::from(argument);
        if !file.exists() {
            return Err(format!("{argument}: there is no such file"));
        }
        files.push(file);
    }
    if files.is_empty() {
        files.push(paths::sample());
    }
    Ok((files, passed_on))
}

fn has_display() -> bool {
    ["DISPLAY", "WAYLAND_DISPLAY"]
        .iter()
        .any(|name| std::env::var_os(name).is_some_and(|value| !value.is_empty()))
}

fn open_window(program: &Path, files: &[PathBuf], passed_on: &[String]) -> Outcome {
    let names: Vec<_> = files.iter().map(|file| paths::shown(file)).collect();
    process::say(&format!("opening {} in the window", names.join(", ")));
    let mut command = Command::new(program);
    command.args(files).args(passed_on);
    setup::prepare_environment(&mut command)?;
    process::run("the window", &mut command)
}

/// Draws every file with every renderer into `target/pictures/`; one line of standard output a picture.
fn draw_pictures(program: &Path, files: &[PathBuf], passed_on: &[String]) -> Outcome {
    let renderers = renderers(program)?;
    let names: Vec<&str> = renderers.iter().map(|renderer| &*renderer.name).collect();
    process::say(&format!(
        "no display here, so drawing pictures instead, with {}",
        names.join(", ")
    ));
    let folder = paths::target().join("pictures");
    std::fs::create_dir_all(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let mut failures = Vec::new();
    for file in files {
        let stem = file.file_stem().unwrap_or_default().to_string_lossy();
        let has_mesh = has_mesh(program, file)?;
        for Renderer { name, needs_mesh } in &renderers {
            if *needs_mesh && !has_mesh {
                process::say(&format!(
                    "{name} draws meshes, which {} is not",
                    paths::shown(file)
                ));
                continue;
            }
            let picture = folder.join(format!("{stem}_{name}.png"));
            let mut command = Command::new(program);
            command
                .arg("render")
                .arg(file)
                .args(["--renderer", name, "--size", "1280x720", "--out"])
                .arg(&picture);
            command.args(passed_on);
            setup::prepare_environment(&mut command)?;
            match process::run(&format!("drawing with {name}"), &mut command) {
                Ok(()) => println!("{}", paths::shown(&picture)),
                Err(message) => failures.push(message),
            }
        }
    }
    if failures.is_empty() {
        Ok(())
    } else {
        Err(failures.join("\n"))
    }
}

/// Whether a file holds triangles.
fn has_mesh(program: &Path, file: &Path) -> Outcome<bool> {
    let mut command = Command::new(program);
    command.args(["info", "--json"]).arg(file);
    setup::prepare_environment(&mut command)?;
    let json = process::output(&mut command)
        .ok_or_else(|| format!("{} failed", process::line(&command)))?;
    let objects = Value::parse(&json);
    let objects = objects.iter().flat_map(Value::items);
    let counts: Vec<_> = objects.map(|object| object.number("triangles")).collect();
    Ok(!counts.is_empty() && counts.iter().all(|count| *count > Some(0.0)))
}

/// A renderer of the program's list.
#[derive(Debug, PartialEq)]
struct Renderer {
    /// Its alias, or its id where there is none.
    name: String,
    needs_mesh: bool,
}

/// The renderers that the program found and can use.
fn renderers(program: &Path) -> Outcome<Vec<Renderer>> {
    let mut command = Command::new(program);
    command.args(["plugins", "list", "--json"]);
    setup::prepare_environment(&mut command)?;
    let json = process::output(&mut command)
        .ok_or_else(|| format!("{} failed", process::line(&command)))?;
    let renderers = renderers_of(&json);
    if renderers.is_empty() {
        return Err(format!("{} named no renderer", process::line(&command)));
    }
    Ok(renderers)
}

/// The renderers in the program's list that it found fit for use.
fn renderers_of(json: &str) -> Vec<Renderer> {
    let Some(list) = Value::parse(json) else {
        return Vec::new();
    };
    let usable = |plugin: &&Value| {
        plugin.text("kind") == Some("renderer")
            && plugin.text("verdict").is_none_or(|verdict| verdict == "ok")
    };
    let mut renderers: Vec<Renderer> = Vec::new();
    for plugin in list.all().into_iter().filter(usable) {
        let Some(name) = plugin.text("alias").or_else(|| plugin.text("id")) else {
            continue;
        };
        if renderers.iter().all(|known| known.name != name) {
            renderers.push(Renderer {
                name: name.to_owned(),
                needs_mesh: plugin
                    .get("needs")
                    .is_some_and(|needs| needs.is_true("mesh")),
            });
        }
    }
    renderers
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn renderers_that_are_fit_for_use_are_named_with_what_they_need() {
        let json = r#"[
            {"file": "a.so", "plugins": [
                {"kind": "renderer", "alias": "dots", "id": "org.a", "verdict": "ok", "needs": {"mesh": false}},
                {"kind": "structure", "alias": "tree", "verdict": "ok"}
            ]},
            {"file": "b.so", "plugins": [
                {"kind": "renderer", "id": "org.b", "needs": {"mesh": true}},
                {"kind": "renderer", "alias": "bad", "verdict": "crashed"},
                {"kind": "renderer", "alias": "dots"}
            ]}
        ]"#;
        let renderer = |name: &str, needs_mesh| Renderer {
            name: name.to_owned(),
            needs_mesh,
        };
        assert_eq!(
            renderers_of(json),
            [renderer("dots", false), renderer("org.b", true)]
        );
        assert_eq!(renderers_of("not JSON"), []);
    }
}
