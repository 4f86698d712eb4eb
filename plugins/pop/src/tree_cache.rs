//! Trees kept on disk: `.pop` files in the user's cache folder, named by what the mesh holds.

use pointstage_plugin_api::{Host, Result};
use pointstage_pop_tree::file::{self, FileError};
use pointstage_pop_tree::{Mesh, Tree, fingerprint};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// Below this many triangles a tree is built faster than anybody waits.
const FEWEST_TRIANGLES: usize = 200_000;
/// All files of the folder together, above which the oldest go.
const MOST_BYTES: u64 = 4 << 30;

/// The mesh's tree from its file, or made and written to it. A file that does not serve is told of and replaced; one that
/// cannot be written is told of and left.
///
/// # Errors
/// What `make` says.
pub(crate) fn tree_of(
    host: &Host,
    name: &str,
    mesh: &Mesh<'_>,
    make: impl FnOnce() -> Result<Tree>,
) -> Result<Tree> {
    if mesh.triangles.len() < FEWEST_TRIANGLES {
        return make();
    }
    let Some(folder) = folder(|name| std::env::var_os(name).map(PathBuf::from)) else {
        return make();
    };
    let fingerprint = fingerprint(mesh, host.thread_count());
    let path = folder.join(file_name(&fingerprint));
    match file::read(&path, &fingerprint) {
        Ok(tree) => return Ok(tree),
        Err(FileError::Missing { .. }) => {}
        Err(error) => host.warn(&format!("the tree of '{name}' is built anew: {error}")),
    }
    let tree = make()?;
    let written = std::fs::create_dir_all(&folder)
        .map_err(|error| format!("{}: {error}", folder.display()))
        .and_then(|()| file::write(&path, &tree, &fingerprint).map_err(|error| error.to_string()));
    match written {
        Ok(()) => forget_oldest(&folder, &path, MOST_BYTES),
        Err(error) => host.warn(&format!("the tree of '{name}' is not kept: {error}")),
    }
    Ok(tree)
}

/// Where the platform keeps what can be made again.
fn folder(variable: impl Fn(&str) -> Option<PathBuf>) -> Option<PathBuf> {
    let set = |name| variable(name).filter(|path| path.is_absolute());
    let home = || set("HOME");
    let base = if cfg!(target_os = "windows") {
        set("LOCALAPPDATA")
    } else if cfg!(target_os = "macos") {
        home().map(|home| home.join("Library/Caches"))
    } else {
        set("XDG_CACHE_HOME").or_else(|| home().map(|home| home.join(".cache")))
    };
    base.map(|base| base.join("pointstage").join("pop"))
}

/// By the first half of the fingerprint; the file itself holds all of it.
fn file_name(fingerprint: &[u8; 32]) -> String {
    let mut name = String::new();
    for byte in &fingerprint[..16] {
        // Writing to a string does not fail.
        let _ = write!(name, "{byte:02x}");
    }
    name + ".pop"
}

/// Removes the files that were written longest ago until the folder's are below the limit; never `kept`.
fn forget_oldest(folder: &Path, kept: &Path, most_bytes: u64) {
    let Ok(entries) = std::fs::read_dir(folder) else {
        return;
    };
    let mut files: Vec<(SystemTime, u64, PathBuf)> = entries
        .flatten()
        .map(|entry| entry.path())
        .filter(|path| path.extension().is_some_and(|ending| ending == "pop"))
        .filter_map(|path| {
            let facts = path.metadata().ok()?;
            Some((facts.modified().ok()?, facts.len(), path))
        })
        .collect();
    files.sort();
    let mut bytes: u64 = files.iter().map(|(_, length, _)| length).sum();
    for (_, length, path) in files {
        if bytes <= most_bytes {
            return;
        }
        // Another program may have been faster.
        if path != kept && std::fs::remove_file(&path).is_ok() {
            bytes -= length;
        }
    }
}

#[cfg(test)]
#[path = "tree_cache_tests.rs"]
mod tests;
