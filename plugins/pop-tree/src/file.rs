//! Trees on disk: `.pop` files.
//!
//! All numbers are little-endian.
//!
//! | byte | what |
//! |---|---|
//! | 0 | `POPTREE`, a zero byte |
//! | 8 | version, u32 |
//! | 12 | fingerprint of the mesh, 32 bytes; see [`crate::fingerprint()`] |
//! | 44 | grid: origin, 3 f32; step, f32 |
//! | 60 | number of levels L, u32 |
//! | 64 | number of nodes N, u32 |
//! | 68 | number of the first node of each level, from the root's; L u32 |
//! | 68 + 4 L | nodes, 20 bytes each; see [`Node`] |
//! | 68 + 4 L + 20 N | BLAKE3 hash of all bytes before, 32 bytes |
//!
//! The version changes with the form of the file, and with anything in [`crate::build()`] that makes another tree of the same
//! mesh.

use crate::node::{Grid, Node};
use crate::structure::{self, Place};
use crate::tree::Tree;
use bytemuck::zeroed_vec;
use std::ffi::OsString;
use std::fs::File;
use std::io::{self, ErrorKind, Read, Write as _};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

const MAGIC: [u8; 8] = *b"POPTREE\0";
/// 2: colours of nodes are means of linear light.
const VERSION: u32 = 2;

const GRID_AT: usize = 44;
const COUNTS_AT: usize = 60;
const HEADER_BYTES: usize = 68;
const NODE_BYTES: usize = size_of::<Node>();
const CHECKSUM_BYTES: usize = 32;

/// A tree of 2³⁰ nodes has 16 levels.
const MOST_LEVELS: u32 = 32;

/// Bytes that are read or written, and hashed, at a time.
const STRETCH: usize = 1 << 18;

/// Why a `.pop` file was not written or not read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FileError {
    /// There is none of this name.
    #[error("{}: there is no such file; build the tree", path.display())]
    Missing {
        /// The file.
        path: PathBuf,
    },
    /// The system failed to read or write.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// The file is not what was written.
    #[error("{}, byte {offset}: {what}; delete the file and build the tree again", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What was found and what should be there.
        what: String,
        /// Where.
        offset: u64,
    },
    /// Another Pointstage wrote the file.
    #[error("{}: version {found} of .pop files, but this Pointstage reads version {VERSION}; build the tree again", path.display())]
    OtherVersion {
        /// The file.
        path: PathBuf,
        /// Its version.
        found: u32,
    },
    /// The tree is of another mesh, or the mesh has changed.
    #[error("{}: this is the tree of another mesh, or the mesh has changed; build the tree again", path.display())]
    Stale {
        /// The file.
        path: PathBuf,
    },
}

/// Writes a tree; a file that is there is replaced in one step, or kept on failure.
pub fn write(path: &Path, tree: &Tree, fingerprint: &[u8; 32]) -> Result<(), FileError> {
    let part = part_beside(path);
    let written = write_part(&part, tree, fingerprint).and_then(|()| std::fs::rename(&part, path));
    written.map_err(|source| {
        // The first failure is the one to tell of; a part that cannot be removed does no harm.
        let _ = std::fs::remove_file(&part);
        FileError::Io {
            path: path.to_owned(),
            source,
        }
    })
}

/// Reads a tree that was built over the mesh of this fingerprint.
pub fn read(path: &Path, fingerprint: &[u8; 32]) -> Result<Tree, FileError> {
    Reader::open(path)?.read(fingerprint)
}

/// A name of its own in the same folder, so that threads and processes do not write to the same.
fn part_beside(path: &Path) -> PathBuf {
    static WRITTEN: AtomicU32 = AtomicU32::new(0);
    let number = WRITTEN.fetch_add(1, Ordering::Relaxed);
    let mut name: OsString = path.file_name().unwrap_or_default().to_owned();
    name.push(format!(".{}-{number}.part", std::process::id()));
    path.with_file_name(name)
}

fn write_part(part: &Path, tree: &Tree, fingerprint: &[u8; 32]) -> io::Result<()> {
    let mut file = File::create_new(part)?;
    let mut hasher = blake3::Hasher::new();
    let mut put = |bytes: &[u8]| {
        hasher.update(bytes);
        file.write_all(bytes)
    };
    let Grid {
        origin: [x, y, z],
        step,
    } = tree.grid;
    let mut header = Vec::with_capacity(HEADER_BYTES);
    header.extend(MAGIC);
    header.extend(VERSION.to_le_bytes());
    header.extend(fingerprint);
    header.extend([x, y, z, step].map(f32::to_le_bytes).as_flattened());
    // Both are less than 2³⁰.
    header.extend((tree.level_starts.len() as u32).to_le_bytes());
    header.extend((tree.nodes.len() as u32).to_le_bytes());
    header.extend(
        tree.level_starts
            .iter()
            .flat_map(|start| start.to_le_bytes()),
    );
    put(&header)?;
    let mut words = Vec::with_capacity(STRETCH / size_of::<u32>());
    for stretch in bytemuck::cast_slice::<Node, u32>(&tree.nodes).chunks(STRETCH / size_of::<u32>())
    {
        words.clear();
        words.extend(stretch.iter().copied().map(u32::to_le));
        put(bytemuck::cast_slice(&words))?;
    }
    let checksum = hasher.finalize();
    file.write_all(checksum.as_bytes())
}

/// A file being read.
struct Reader<'p> {
    path: &'p Path,
    file: File,
    /// Bytes of the file when it was opened.
    length: u64,
    /// Of all bytes read so far.
    hasher: blake3::Hasher,
}

impl<'p> Reader<'p> {
    fn open(path: &'p Path) -> Result<Self, FileError> {
        let opened = File::open(path).and_then(|file| Ok((file.metadata()?.len(), file)));
        match opened {
            Ok((length, file)) => Ok(Self {
                path,
                file,
                length,
                hasher: blake3::Hasher::new(),
            }),
            Err(error) if error.kind() == ErrorKind::NotFound => Err(FileError::Missing {
                path: path.to_owned(),
            }),
            Err(source) => Err(FileError::Io {
                path: path.to_owned(),
                source,
            }),
        }
    }

    fn read(mut self, fingerprint: &[u8; 32]) -> Result<Tree, FileError> {
        let (grid, level_count, node_count) = self.header(fingerprint)?;
        let level_starts = self.words(level_count)?;
        let mut nodes: Vec<Node> = zeroed_vec(node_count);
        self.fill(bytemuck::cast_slice_mut::<Node, u32>(&mut nodes))?;
        self.checksum()?;
        let tree = Tree {
            grid,
            nodes,
            level_starts,
        };
        structure::check(&tree).map_err(|fault| {
            let offset = match fault.place {
                Place::Grid => GRID_AT,
                Place::Level(level) => HEADER_BYTES + 4 * level,
                Place::Node(node) => HEADER_BYTES + 4 * level_count + NODE_BYTES * node,
            };
            self.damaged(fault.what, offset as u64)
        })?;
        Ok(tree)
    }

    /// The grid, and the numbers of levels and of nodes, for which the file has the right length.
    fn header(&mut self, fingerprint: &[u8; 32]) -> Result<(Grid, usize, usize), FileError> {
        let mut header = [0_u8; HEADER_BYTES];
        let in_file = self.length.min(HEADER_BYTES as u64) as usize;
        self.bytes(&mut header[..in_file])?;
        let word =
            |at: usize| -> u32 { bytemuck::pod_read_unaligned::<u32>(&header[at..at + 4]).to_le() };
        if header[..8] != MAGIC {
            return Err(self.damaged(
                "does not begin like a .pop file, with POPTREE".to_owned(),
                0,
            ));
        }
        if in_file >= 12 && word(8) != VERSION {
            return Err(FileError::OtherVersion {
                path: self.path.to_owned(),
                found: word(8),
            });
        }
        if in_file < HEADER_BYTES {
            return Err(self.damaged(
                format!("ends within the header of {HEADER_BYTES} bytes"),
                self.length,
            ));
        }
        if header[12..GRID_AT] != *fingerprint {
            return Err(FileError::Stale {
                path: self.path.to_owned(),
            });
        }
        let [x, y, z, step] = [0, 4, 8, 12].map(|at| f32::from_bits(word(GRID_AT + at)));
        let (level_count, node_count) = (word(COUNTS_AT), word(COUNTS_AT + 4));
        if level_count > MOST_LEVELS {
            let what = format!("has {level_count} levels, of at most {MOST_LEVELS}");
            return Err(self.damaged(what, COUNTS_AT as u64));
        }
        let expected = (HEADER_BYTES + CHECKSUM_BYTES) as u64
            + 4 * u64::from(level_count)
            + NODE_BYTES as u64 * u64::from(node_count);
        if self.length != expected {
            let what = format!(
                "{level_count} levels and {node_count} nodes take {expected} bytes, but the file has {}",
                self.length
            );
            return Err(self.damaged(what, self.length.min(expected)));
        }
        Ok((
            Grid {
                origin: [x, y, z],
                step,
            },
            level_count as usize,
            node_count as usize,
        ))
    }

    /// The hash at the end is that of all before.
    fn checksum(&mut self) -> Result<(), FileError> {
        let computed = self.hasher.finalize();
        let mut stored = [0; CHECKSUM_BYTES];
        self.bytes(&mut stored)?;
        if computed == blake3::Hash::from_bytes(stored) {
            return Ok(());
        }
        let what = "the checksum is not that of the bytes before it".to_owned();
        Err(self.damaged(what, self.length - CHECKSUM_BYTES as u64))
    }

    fn words(&mut self, count: usize) -> Result<Vec<u32>, FileError> {
        let mut words = vec![0; count];
        self.fill(&mut words)?;
        Ok(words)
    }

    fn fill(&mut self, words: &mut [u32]) -> Result<(), FileError> {
        for stretch in words.chunks_mut(STRETCH / size_of::<u32>()) {
            self.bytes(bytemuck::cast_slice_mut(stretch))?;
            for word in stretch {
                *word = u32::from_le(*word);
            }
        }
        Ok(())
    }

    fn bytes(&mut self, bytes: &mut [u8]) -> Result<(), FileError> {
        let read = self.file.read_exact(bytes);
        read.map_err(|source| FileError::Io {
            path: self.path.to_owned(),
            source,
        })?;
        self.hasher.update(bytes);
        Ok(())
    }

    fn damaged(&self, what: String, offset: u64) -> FileError {
        FileError::Damaged {
            path: self.path.to_owned(),
            what,
            offset,
        }
    }
}
