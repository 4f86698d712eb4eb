//! Builds the misbehaving plugins of `tests/plugins/` into a folder of their own, and spoils copies of them.

use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Mutex;

use anyhow::{Context as _, Result, bail, ensure};

use crate::data::repository;

/// A changed copy of `plugin-api` that a plugin is built against.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Variant {
    /// Version 1.3: with one more root field, methods and command. Has to load.
    Newer,
    /// Still called 1.2.0, but with two fields of a record swapped. Has to be refused.
    Changed,
}

/// One edit of a copied file: the file, the text to find, and what stands there instead.
type Edit = (&'static str, &'static str, &'static str);

const NEWER: &[Edit] = &[
    (
        "plugin-api/Cargo.toml",
        "version = \"1.2.0\"",
        "version = \"1.3.0\"",
    ),
    (
        "plugin-api/src/abi/root.rs",
        "    pub factories: extern \"C\" fn() -> RResult<RVec<FactoryBox>, ErrorRecord>,\n",
        "    pub factories: extern \"C\" fn() -> RResult<RVec<FactoryBox>, ErrorRecord>,\n    \
         pub novelty: extern \"C\" fn() -> u32,\n",
    ),
    (
        "plugin-api/src/abi/export_parts.rs",
        "        factories,\n    }\n",
        "        factories,\n        novelty,\n    }\n",
    ),
    (
        "plugin-api/src/abi/export_parts.rs",
        "/// Runs `make`",
        "extern \"C\" fn novelty() -> u32 {\n    11\n}\n\n/// Runs `make`",
    ),
    (
        "plugin-api/src/abi/objects.rs",
        "}\npub type FactoryBox",
        "    fn novelty(&self) -> u32 {\n        0\n    }\n}\npub type FactoryBox",
    ),
    (
        "plugin-api/src/abi/objects.rs",
        "}\npub type ViewBox",
        "    fn novelty(&self) -> u32 {\n        0\n    }\n}\npub type ViewBox",
    ),
    (
        "plugin-api/src/abi/objects.rs",
        "}\npub type HostRef",
        "    fn novelty(&self) -> u32 {\n        0\n    }\n}\npub type HostRef",
    ),
    (
        "plugin-api/src/abi/loading.rs",
        "}\npub type LoadSinkRef",
        "    fn novelty(&self) -> u32 {\n        0\n    }\n}\npub type LoadSinkRef",
    ),
    (
        "plugin-api/src/abi/loading.rs",
        "}\npub type LoaderBox",
        "    fn novelty(&self) -> u32 {\n        0\n    }\n}\npub type LoaderBox",
    ),
    (
        "plugin-api/src/abi/commands.rs",
        "    26 PopDebugGroup {}\n",
        "    26 PopDebugGroup {}\n    9999 Novelty { value: u32 }\n",
    ),
];

const CHANGED: &[Edit] = &[(
    "plugin-api/src/abi/values.rs",
    "    pub message: RString,\n    /// The long form (a shader's full diagnosis, a backtrace); may be empty.\n    \
     pub detail: RString,\n",
    "    pub detail: RString,\n    pub message: RString,\n",
)];

/// The library with one renderer per fault.
///
/// # Errors
/// When it cannot be built.
pub fn misbehaving() -> Result<PathBuf> {
    once("misbehave", || {
        build(&repository().join("tests/plugins"), "misbehave", &[])
    })
}

/// The library of well-behaved plugins: renderers `dots` and `lit-points`, structure `halves`.
///
/// # Errors
/// When it cannot be built.
pub fn sound() -> Result<PathBuf> {
    once("sound", || {
        build(&repository().join("tests/plugins"), "sound", &[])
    })
}

/// The library of a CPU renderer with a setting of every kind.
///
/// # Errors
/// When it cannot be built.
pub fn everything() -> Result<PathBuf> {
    once("everything", || {
        build(&repository().join("tests/plugins"), "everything", &[])
    })
}

/// The library of a CPU renderer that takes as long as it is told, `sleeper`.
///
/// # Errors
/// When it cannot be built.
pub fn sleeper() -> Result<PathBuf> {
    once("sleeper", || {
        build(&repository().join("tests/plugins"), "sleeper", &[])
    })
}

/// The library of loaders: `good`, and one for each fault.
///
/// # Errors
/// When it cannot be built.
pub fn readers() -> Result<PathBuf> {
    once("readers", || {
        build(&repository().join("tests/plugins"), "readers", &[])
    })
}

/// The library of a loader that panics at the first look at a short file.
///
/// # Errors
/// When it cannot be built.
pub fn panicky_reader() -> Result<PathBuf> {
    once("panicky-reader", || {
        build(&repository().join("tests/plugins"), "panicky-reader", &[])
    })
}

/// The library that misbehaves while it is loaded, under a file name that asks for `fault`.
///
/// # Errors
/// When it cannot be built or copied.
pub fn on_load(fault: &str, folder: &Path) -> Result<PathBuf> {
    let library = once("onload", || {
        build(&repository().join("tests/plugins"), "onload", &[])
    })?;
    let copy = library_path(folder, &format!("on-load-{fault}"));
    std::fs::copy(&library, &copy).with_context(|| format!("copying {}", library.display()))?;
    Ok(copy)
}

/// A good plugin, built against a changed copy of `plugin-api`.
///
/// # Errors
/// When the copy cannot be made or built.
pub fn variant(variant: Variant) -> Result<PathBuf> {
    let (name, edits, arguments): (_, _, &[&str]) = match variant {
        Variant::Newer => ("variant_newer", NEWER, &["--features", "newer"]),
        Variant::Changed => ("variant_changed", CHANGED, &[]),
    };
    once(name, || {
        let workspace = copy_workspace(name, edits)?;
        build(&workspace, name, arguments)
    })
}

/// What the compiler says of a plugin that is built with `panic = "abort"`.
///
/// # Errors
/// When it compiles, or the compiler does not run.
pub fn compile_aborting() -> Result<String> {
    let mut command = cargo(&repository().join("tests/plugins"), "rustc");
    command.args(["-p", "misbehave", "--lib", "--", "-C", "panic=abort"]);
    let output = command.output().context("running cargo")?;
    ensure!(
        !output.status.success(),
        "the plugin compiled with panic = \"abort\""
    );
    Ok(String::from_utf8_lossy(&output.stderr).into_owned())
}

/// A copy of `library` in `folder` whose bytes went through `spoil`.
///
/// # Errors
/// When the library cannot be read or the copy not be written.
pub fn spoiled(
    library: &Path,
    folder: &Path,
    name: &str,
    spoil: impl FnOnce(&mut Vec<u8>),
) -> Result<PathBuf> {
    let mut bytes =
        std::fs::read(library).with_context(|| format!("reading {}", library.display()))?;
    spoil(&mut bytes);
    let copy = library_path(folder, name);
    std::fs::write(&copy, bytes).with_context(|| format!("writing {}", copy.display()))?;
    Ok(copy)
}

/// Puts `new` wherever `old`, of the same length, is in `bytes`; returns how often.
///
/// # Panics
/// When the lengths differ: the file's layout has to stay.
pub fn replace_all(bytes: &mut [u8], old: &[u8], new: &[u8]) -> usize {
    assert_eq!(old.len(), new.len(), "the file's layout has to stay");
    let places: Vec<usize> = bytes
        .windows(old.len())
        .enumerate()
        .filter(|(_, window)| *window == old)
        .map(|(at, _)| at)
        .collect();
    for at in &places {
        bytes[*at..at + new.len()].copy_from_slice(new);
    }
    places.len()
}

fn library_path(folder: &Path, name: &str) -> PathBuf {
    let file = format!(
        "{}{name}{}",
        std::env::consts::DLL_PREFIX,
        std::env::consts::DLL_SUFFIX
    );
    folder.join(file)
}

/// Runs `make` once per process and name.
fn once(name: &'static str, make: impl FnOnce() -> Result<PathBuf>) -> Result<PathBuf> {
    static MADE: Mutex<BTreeMap<&'static str, PathBuf>> = Mutex::new(BTreeMap::new());
    let mut made = MADE
        .lock()
        .unwrap_or_else(std::sync::PoisonError::into_inner);
    if let Some(path) = made.get(name) {
        return Ok(path.clone());
    }
    let path = make()?;
    made.insert(name, path.clone());
    Ok(path)
}

/// The folder that all of them are built in, beside the tests' own.
fn target_folder() -> PathBuf {
    let target = std::env::var_os("CARGO_TARGET_DIR")
        .map_or_else(|| repository().join("target"), PathBuf::from);
    target.join("test-plugins")
}

/// Cargo without what this very build sets.
fn cargo(workspace: &Path, what: &str) -> Command {
    let program = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut command = Command::new(program);
    command
        .arg(what)
        .arg("--quiet")
        .current_dir(workspace)
        .env("CARGO_TARGET_DIR", target_folder())
        .env_remove("RUSTFLAGS")
        .env_remove("CARGO_ENCODED_RUSTFLAGS");
    command
}

fn build(workspace: &Path, package: &str, arguments: &[&str]) -> Result<PathBuf> {
    let mut command = cargo(workspace, "build");
    let output = command
        .args(["-p", package])
        .args(arguments)
        .output()
        .context("running cargo")?;
    if !output.status.success() {
        bail!(
            "building the test plugin {package}: {}",
            String::from_utf8_lossy(&output.stderr)
        );
    }
    let library = library_path(&target_folder().join("debug"), &package.replace('-', "_"));
    ensure!(library.is_file(), "cargo built no {}", library.display());
    Ok(library)
}

/// A workspace with an edited copy of `plugin-api`, and the plugin `variant` under the name `name`.
fn copy_workspace(name: &str, edits: &[Edit]) -> Result<PathBuf> {
    let workspace = target_folder().join("workspaces").join(name);
    let mut files = BTreeMap::new();
    collect(
        &repository().join("plugin-api"),
        Path::new("plugin-api"),
        &mut files,
    )?;
    collect(
        &repository().join("tests/plugins/variant"),
        Path::new("variant"),
        &mut files,
    )?;
    let root = read(&repository().join("Cargo.toml"))?;
    let rest = root
        .find("[workspace.package]")
        .context("the root manifest has no [workspace.package]")?;
    // The profile of the other misbehaving plugins, so that all dependencies are built once.
    let profile = root.find("[profile.").unwrap_or(root.len());
    let own_profile = "[profile.dev]\nopt-level = 1\ndebug = false\n";
    let members = "[workspace]\nresolver = \"3\"\nmembers = [\"plugin-api\", \"variant\"]\n\n";
    files.insert(
        "Cargo.toml".into(),
        format!("{members}{}{own_profile}", &root[rest..profile.max(rest)]),
    );
    files.insert(
        "variant/Cargo.toml".into(),
        format!(
            "[package]\nname = \"{name}\"\nversion = \"1.0.0\"\nedition = \"2024\"\npublish = false\n\n[features]\n\
             newer = []\n\n[lib]\ncrate-type = [\"cdylib\"]\n\n[dependencies]\n\
             pointstage-plugin-api = {{ path = \"../plugin-api\" }}\n"
        ),
    );
    for (file, old, new) in edits {
        let text = files
            .get_mut(Path::new(file))
            .with_context(|| format!("no file {file}"))?;
        ensure!(
            text.contains(old),
            "{file} no longer contains {old:?}: the edits of the test harness need an update"
        );
        *text = text.replacen(old, new, 1);
    }
    let lock = workspace.join("Cargo.lock");
    if !lock.exists() {
        files.insert("Cargo.lock".into(), read(&repository().join("Cargo.lock"))?);
    }
    for (file, text) in &files {
        write_if_new(&workspace.join(file), text)?;
    }
    Ok(workspace)
}

fn collect(folder: &Path, under: &Path, files: &mut BTreeMap<PathBuf, String>) -> Result<()> {
    let entries =
        std::fs::read_dir(folder).with_context(|| format!("listing {}", folder.display()))?;
    for entry in entries {
        let path = entry.context("listing a folder")?.path();
        let name = path.file_name().unwrap_or(OsStr::new(""));
        let relative = under.join(name);
        if path.is_dir() {
            collect(&path, &relative, files)?;
        } else {
            files.insert(relative, read(&path)?);
        }
    }
    Ok(())
}

fn read(path: &Path) -> Result<String> {
    std::fs::read_to_string(path).with_context(|| format!("reading {}", path.display()))
}

/// Leaves an equal file alone: cargo builds what has a new time.
fn write_if_new(path: &Path, text: &str) -> Result<()> {
    if std::fs::read_to_string(path).is_ok_and(|old| old == text) {
        return Ok(());
    }
    let folder = path.parent().unwrap_or(Path::new(""));
    std::fs::create_dir_all(folder).with_context(|| format!("making {}", folder.display()))?;
    std::fs::write(path, text).with_context(|| format!("writing {}", path.display()))
}
