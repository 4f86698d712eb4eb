//! `.pop` files come back as they were written, or not at all.

mod meshes;

use meshes::{any_mesh, sheet};
use pointstage_pop_tree::Tree;
use pointstage_pop_tree::file::{FileError, read, write};
use proptest::prelude::*;
use std::path::PathBuf;

const FINGERPRINT: [u8; 32] = [0xa5; 32];

/// A folder, a file's path in it, and the bytes of a small tree's file.
fn small_file() -> (tempfile::TempDir, PathBuf, Tree, Vec<u8>) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("small.pop");
    let tree = sheet(3, 3).tree();
    write(&path, &tree, &FINGERPRINT).expect("a folder to write to");
    let bytes = std::fs::read(&path).expect("the file just written");
    (folder, path, tree, bytes)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    #[test]
    fn what_is_written_is_read(mesh in any_mesh(), fingerprint: [u8; 32]) {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("any.pop");
        let tree = mesh.tree();
        write(&path, &tree, &fingerprint).expect("a folder to write to");
        prop_assert_eq!(read(&path, &fingerprint).expect("the file just written"), tree);
    }
}

#[test]
fn a_larger_file_is_replaced_and_no_part_is_left() {
    let (folder, path, small, _) = small_file();
    let large = sheet(150, 150).tree();
    for tree in [&large, &small, &large] {
        write(&path, tree, &FINGERPRINT).expect("a folder to write to");
        assert!(read(&path, &FINGERPRINT).expect("the file just written") == *tree);
    }
    assert_eq!(
        std::fs::read_dir(folder.path())
            .expect("the folder")
            .count(),
        1
    );
    let bytes = std::fs::metadata(&path).expect("the file").len() as usize;
    assert_eq!(
        bytes,
        68 + 4 * large.level_starts.len() + 20 * large.nodes.len() + 32
    );
}

#[test]
fn every_truncation_is_noticed() {
    let (_folder, path, _, bytes) = small_file();
    for length in 0..bytes.len() {
        std::fs::write(&path, &bytes[..length]).expect("a folder to write to");
        let error = read(&path, &FINGERPRINT).expect_err("a truncated file");
        assert!(
            matches!(&error, FileError::Damaged { offset, .. } if *offset == length as u64 || length < 12 && *offset == 0),
            "{length}: {error}"
        );
    }
    std::fs::write(&path, [bytes.as_slice(), &[0]].concat()).expect("a folder to write to");
    assert!(matches!(
        read(&path, &FINGERPRINT),
        Err(FileError::Damaged { .. })
    ));
}

#[test]
fn every_changed_byte_is_noticed() {
    let (_folder, path, tree, bytes) = small_file();
    for place in 0..bytes.len() {
        for change in [1, 0x80, 0xff] {
            let mut changed = bytes.clone();
            changed[place] ^= change;
            std::fs::write(&path, &changed).expect("a folder to write to");
            let error = read(&path, &FINGERPRINT).expect_err("a changed file");
            let as_expected = match place {
                8..12 => matches!(error, FileError::OtherVersion { .. }),
                12..44 => matches!(error, FileError::Stale { .. }),
                _ => matches!(error, FileError::Damaged { .. }),
            };
            assert!(as_expected, "{place}: {error}");
        }
    }
    std::fs::write(&path, &bytes).expect("a folder to write to");
    assert_eq!(
        read(&path, &FINGERPRINT).expect("the file as written"),
        tree
    );
}

/// Someone may compute the checksum anew: what a traversal relies on is checked all the same.
#[test]
fn made_up_files_with_a_right_checksum_are_noticed() {
    let (_folder, path, tree, bytes) = small_file();
    let nodes_at = 68 + 4 * tree.level_starts.len();
    let with_word = |at: usize, word: u32| {
        let mut bytes = bytes[..bytes.len() - 32].to_vec();
        bytes[at..at + 4].copy_from_slice(&word.to_le_bytes());
        let checksum = blake3::hash(&bytes);
        bytes.extend(checksum.as_bytes());
        std::fs::write(&path, &bytes).expect("a folder to write to");
        read(&path, &FINGERPRINT)
    };
    let leaf = nodes_at + 20 * tree.first_leaf() as usize;
    let [.., above_leaves, _] = tree.level_starts.as_slice() else {
        panic!("few levels")
    };
    let parent = nodes_at + 20 * *above_leaves as usize;
    for (at, word, offset) in [
        (nodes_at + 16, 0, nodes_at),
        (nodes_at + 16, u32::MAX, nodes_at),
        (leaf + 16, 18, leaf),
        (leaf + 8, 0xffff, parent),
        (68, 1, 68),
        (72, u32::MAX, 72),
        (56, 0, 44),
        (64, u32::MAX, bytes.len()),
        (60, u32::MAX, 60),
    ] {
        let error = with_word(at, word).expect_err("a made-up file");
        let FileError::Damaged { offset: found, .. } = &error else {
            panic!("{error}")
        };
        assert_eq!(*found, offset as u64, "{error}");
    }
}

#[test]
fn errors_name_the_file_and_what_to_do() {
    let (folder, path, tree, bytes) = small_file();
    let message = |bytes: &[u8], fingerprint: &[u8; 32]| {
        std::fs::write(&path, bytes).expect("a folder to write to");
        read(&path, fingerprint)
            .expect_err("an unsound file")
            .to_string()
    };
    let name = path.display().to_string();
    assert_eq!(
        message(&bytes, &[1; 32]),
        format!(
            "{name}: this is the tree of another mesh, or the mesh has changed; build the tree again"
        )
    );
    // One of a later program, and one whose nodes have other means.
    for version in [3, 1] {
        let mut other = bytes.clone();
        other[8] = version;
        assert_eq!(
            message(&other, &FINGERPRINT),
            format!(
                "{name}: version {version} of .pop files, but this Pointstage reads version 2; build the tree again"
            )
        );
    }
    assert_eq!(
        message(&bytes[..66], &FINGERPRINT),
        format!(
            "{name}, byte 66: ends within the header of 68 bytes; delete the file and build the tree again"
        )
    );
    let none = folder.path().join("none.pop");
    assert!(matches!(read(&none, &FINGERPRINT), Err(FileError::Missing { path }) if path == none));
    assert!(matches!(
        read(folder.path(), &FINGERPRINT),
        Err(FileError::Io { .. } | FileError::Damaged { .. })
    ));
    let nowhere = folder.path().join("nowhere/tree.pop");
    assert!(
        matches!(write(&nowhere, &tree, &FINGERPRINT), Err(FileError::Io { path, .. }) if path == nowhere)
    );
}
