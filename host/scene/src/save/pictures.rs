//! The pictures of a textured mesh, as files beside the one that names them.

use std::io::Write as _;
use std::path::{Path, PathBuf};

use pointstage_texels::PictureFile;

use super::{SaveError, whole_file};
use crate::job::Job;

/// Pictures that are there for a file to name. Those that were not there before go away with this, unless they are kept.
#[derive(Debug, Default)]
pub(super) struct Beside {
    files: Vec<PathBuf>,
    new: Vec<PathBuf>,
}

impl Beside {
    /// Writes pictures beside `path`, named after it: `NAME.png`, `NAME_2.png` and so on, each the first that is free or holds
    /// that very picture already. Nothing that is there is replaced.
    ///
    /// # Errors
    /// A file cannot be written, or the job was cancelled; none is left then.
    pub(super) fn write(
        path: &Path,
        pictures: &[PictureFile],
        job: &Job,
    ) -> Result<Self, SaveError> {
        let stem = stem(path);
        let mut beside = Self::default();
        for picture in pictures {
            job.check()?;
            let (file, is_there) = beside.place(path, &stem, picture);
            if !is_there {
                whole_file::write(&file, |out| Ok(out.write_all(&picture.bytes)?))?;
                beside.new.push(file.clone());
            }
            beside.files.push(file);
        }
        Ok(beside)
    }

    /// Where a picture goes, and whether it is there.
    fn place(&self, path: &Path, stem: &str, picture: &PictureFile) -> (PathBuf, bool) {
        let extension = picture.extension();
        let name = |number: u64| match number {
            1 => format!("{stem}.{extension}"),
            _ => format!("{stem}_{number}.{extension}"),
        };
        let mut number = 0;
        loop {
            number += 1;
            let file = path.with_file_name(name(number));
            if self.files.contains(&file) || is_one(&file, path) {
                continue;
            }
            // A link that leads nowhere is somebody's too.
            if std::fs::symlink_metadata(&file).is_err() {
                return (file, false);
            }
            if holds(&file, &picture.bytes) {
                return (file, true);
            }
        }
    }

    /// The names, as the file beside them says them.
    pub(super) fn names(&self) -> Vec<String> {
        let names = self.files.iter().filter_map(|file| file.file_name());
        names
            .map(|name| name.to_string_lossy().into_owned())
            .collect()
    }

    /// Keeps the pictures; all their files.
    pub(super) fn keep(mut self) -> Vec<PathBuf> {
        self.new.clear();
        std::mem::take(&mut self.files)
    }
}

impl Drop for Beside {
    fn drop(&mut self) {
        for file in &self.new {
            // Why the file beside them is not there matters more than that one of them stays.
            let _ = std::fs::remove_file(file);
        }
    }
}

/// What pictures are called after a file: its name, with `_` for what readers of headers and paths would take for something else.
fn stem(path: &Path) -> String {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let is_plain = |c: char| {
        !c.is_control()
            && !matches!(
                c,
                '\\' | '/' | ':' | '"' | '<' | '>' | char::REPLACEMENT_CHARACTER
            )
    };
    let mut name: String = stem
        .chars()
        .map(|c| if is_plain(c) { c } else { '_' })
        .collect();
    if name.starts_with(char::is_whitespace) {
        name.insert(0, '_');
    }
    name
}

/// Whether two paths of one folder are one file's, or may be: some systems take no notice of case.
fn is_one(a: &Path, b: &Path) -> bool {
    let name = |path: &Path| {
        let name = path.file_name().unwrap_or_default();
        name.to_string_lossy().to_lowercase()
    };
    name(a) == name(b)
}

fn holds(file: &Path, bytes: &[u8]) -> bool {
    let length = std::fs::metadata(file).map(|about| about.len());
    length.is_ok_and(|length| length == bytes.len() as u64)
        && std::fs::read(file).is_ok_and(|found| found == bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    const PNG: &[u8] = b"\x89PNG\r\n\x1a\n";

    fn picture(more: &str) -> PictureFile {
        PictureFile {
            name: "wood".into(),
            bytes: [PNG, more.as_bytes()].concat().into(),
        }
    }

    #[test]
    fn names_are_free_or_hold_the_picture_already() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        std::fs::write(at("head_2.png"), b"of somebody else").unwrap();
        let pictures = [picture("a"), picture("b"), picture("a")];
        let write = |path: &str| Beside::write(&at(path), &pictures, &Job::new()).unwrap();
        let names = ["head.png", "head_3.png", "head_4.png"];
        assert_eq!(write("head.ply").names(), names);
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
        assert_eq!(write("head.ply").keep(), names.map(at));
        // The same again takes what is there, and leaves it.
        let again = write("head.ply");
        assert_eq!(again.names(), names);
        drop(again);
        assert_eq!(std::fs::read(at("head_3.png")).unwrap(), *pictures[1].bytes);
        assert_eq!(
            std::fs::read(at("head_2.png")).unwrap(),
            b"of somebody else"
        );
        // Another picture does not take the place of the first.
        let other = Beside::write(&at("head.ply"), &[picture("c")], &Job::new()).unwrap();
        assert_eq!(other.names(), ["head_5.png"]);
    }

    #[test]
    fn the_file_itself_is_not_taken_and_odd_names_are_plain() {
        let folder = tempfile::tempdir().unwrap();
        let names = |name: &str| {
            let path = folder.path().join(name);
            Beside::write(&path, &[picture("")], &Job::new())
                .unwrap()
                .names()
        };
        assert_eq!(names("head.PNG"), ["head_2.png"]);
        assert_eq!(names(" a\\b\n\"c\".ply"), ["_ a_b__c_.png"]);
        let job = Job::new();
        job.cancel();
        let path = folder.path().join("head.ply");
        Beside::write(&path, &[picture("")], &job).expect_err("cancelled");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}
