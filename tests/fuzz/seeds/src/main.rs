//! Writes the seeds that fuzzing begins with: `seeds CORPUS [SHARED_DATA]`, a folder a reader in CORPUS.
//!
//! They are the small files that the tests make up, and those real files of the shared test data folder that are small enough
//! for a fuzzer to try thousands of changes a second; of larger ones their beginning, which has the header.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

#[allow(dead_code, reason = "shared with tests that use all of it")]
#[path = "../../../tests/formats/small.rs"]
mod small;

/// Larger files seed with their beginning.
const MOST_BYTES: usize = 64 * 1024;

/// Endings, and the reader that they seed.
const READERS: [(&str, &str); 16] = [
    ("ply", "ply"),
    ("sfl", "sfl"),
    ("tri", "tri"),
    ("qs", "qs"),
    ("obj", "obj"),
    ("stl", "stl"),
    ("off", "off"),
    ("gltf", "gltf"),
    ("glb", "gltf"),
    ("las", "las"),
    ("laz", "las"),
    ("e57", "e57"),
    ("pcd", "pcd"),
    ("xyz", "xyz"),
    ("csv", "xyz"),
    ("pts", "xyz"),
];

/// A mesh as the text format in sections, of which no file is at hand.
const TRI: &str = "Vertices 4\n0 0 0\n1 0 0\n0 1 0\n0 0 1\nTriangles 2\n0 1 2\n0 2 3\n";

fn main() -> std::io::Result<()> {
    let arguments: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let Some((corpus, rest)) = arguments.split_first() else {
        eprintln!("usage: seeds CORPUS [SHARED_DATA]");
        std::process::exit(2);
    };
    for (name, content) in small::all() {
        write(corpus, Path::new(name), &content)?;
    }
    write(corpus, Path::new("sections.tri"), TRI.as_bytes())?;
    if let Some(shared) = rest.first() {
        real_files(corpus, shared)?;
    }
    Ok(())
}

/// The files below `folder`, all the way down.
fn real_files(corpus: &Path, folder: &Path) -> std::io::Result<()> {
    for entry in std::fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            real_files(corpus, &path)?;
        } else if reader_of(&path).is_some() {
            let mut content = std::fs::read(&path)?;
            content.truncate(MOST_BYTES);
            write(corpus, &path, &content)?;
        }
    }
    Ok(())
}

fn reader_of(path: &Path) -> Option<&'static str> {
    let ending = path.extension().and_then(OsStr::to_str)?;
    READERS
        .iter()
        .find(|(known, _)| *known == ending)
        .map(|(_, reader)| *reader)
}

fn write(corpus: &Path, name: &Path, content: &[u8]) -> std::io::Result<()> {
    let (Some(reader), Some(file)) = (reader_of(name), name.file_name()) else {
        return Ok(());
    };
    let folder = corpus.join(reader);
    std::fs::create_dir_all(&folder)?;
    std::fs::write(folder.join(file), content)
}
