//! Verdicts from one session to the next, in a JSON file of the state folder.
//!
//! A verdict holds for one content of one file and one build of the program; that of a trial, for one adapter and
//! driver too. Anything else is examined anew. A damaged file is set aside, and a folder that cannot be written only
//! costs the next start some time.

use super::verdict::{Verdict, VerdictClass};
use serde::{Deserialize, Serialize};
use std::io::Write as _;
use std::path::{Path, PathBuf};

const FILE_NAME: &str = "plugin-verdicts.json";
const FORMAT: u32 = 1;
/// Entries of each list that are kept; the oldest go first.
const MOST_ENTRIES: usize = 500;

/// What a verdict on a file holds for.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct FileKey {
    /// The file.
    pub path: PathBuf,
    /// Its length, bytes.
    pub size: u64,
    /// Its time of change, ns since 1970.
    pub modified_ns: u64,
    /// Hash of its content, hexadecimal.
    pub hash: String,
    /// The program: version, and its own file's size and time.
    pub host: String,
}

/// What a verdict on a trial holds for.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct TrialKey {
    /// Hash of the library's content, hexadecimal.
    pub hash: String,
    /// The plugin's id.
    pub plugin: String,
    /// The program, as in [`FileKey`].
    pub host: String,
    /// Adapter and driver.
    pub adapter: String,
}

#[derive(Serialize, Deserialize)]
struct Content {
    format: u32,
    files: Vec<(FileKey, Verdict)>,
    trials: Vec<(TrialKey, Verdict)>,
}

/// The verdicts known so far.
#[derive(Clone, Debug, Default)]
pub struct VerdictCache {
    path: Option<PathBuf>,
    files: Vec<(FileKey, Verdict)>,
    trials: Vec<(TrialKey, Verdict)>,
    changed: bool,
}

impl VerdictCache {
    /// Reads the cache in `folder`; without a folder nothing is kept.
    pub fn open(folder: Option<&Path>) -> Self {
        let Some(path) = folder.map(|folder| folder.join(FILE_NAME)) else {
            return Self::default();
        };
        let mut cache = Self {
            path: Some(path.clone()),
            ..Self::default()
        };
        let Ok(bytes) = std::fs::read(&path) else {
            return cache;
        };
        match serde_json::from_slice::<Content>(&bytes) {
            Ok(Content {
                format: FORMAT,
                files,
                trials,
            }) => {
                cache.files = files;
                cache.trials = trials;
            }
            // Another version's cache: start anew, and write ours over it.
            Ok(_) => {}
            Err(error) => {
                let aside = path.with_extension("damaged");
                tracing::warn!(
                    "{}: damaged ({error}); set aside as {}, plugins are examined anew",
                    path.display(),
                    aside.display()
                );
                let _ = std::fs::rename(&path, aside);
            }
        }
        cache
    }

    /// The verdict on a file, if it is known.
    pub fn file(&self, key: &FileKey) -> Option<&Verdict> {
        self.files
            .iter()
            .rev()
            .find(|(known, _)| known == key)
            .map(|(_, verdict)| verdict)
    }

    /// The verdict on a trial, if it is known.
    pub fn trial(&self, key: &TrialKey) -> Option<&Verdict> {
        self.trials
            .iter()
            .rev()
            .find(|(known, _)| known == key)
            .map(|(_, verdict)| verdict)
    }

    /// Whether the user set a file with this content aside. That holds for every copy and every build of the program.
    pub fn is_set_aside(&self, hash: &str) -> bool {
        self.files
            .iter()
            .any(|(key, verdict)| key.hash == hash && verdict.class == VerdictClass::SetAside)
    }

    /// Keeps a verdict on a file.
    pub fn set_file(&mut self, key: FileKey, verdict: Verdict) {
        self.files.retain(|(known, _)| known.path != key.path);
        self.files.push((key, verdict));
        self.changed = true;
    }

    /// Keeps a verdict on a trial.
    pub fn set_trial(&mut self, key: TrialKey, verdict: Verdict) {
        self.trials.retain(|(known, _)| *known != key);
        self.trials.push((key, verdict));
        self.changed = true;
    }

    /// Forgets all verdicts on the content `hash`, so that it is examined again.
    pub fn forget(&mut self, hash: &str) {
        self.files.retain(|(known, _)| known.hash != hash);
        self.trials.retain(|(known, _)| known.hash != hash);
        self.changed = true;
    }

    /// Writes what changed. A failure is a warning: the next start examines again.
    pub fn save(&mut self) {
        let Self {
            path: Some(path),
            files,
            trials,
            changed: changed @ true,
        } = self
        else {
            return;
        };
        *changed = false;
        files.drain(..files.len().saturating_sub(MOST_ENTRIES));
        trials.drain(..trials.len().saturating_sub(MOST_ENTRIES));
        let content = Content {
            format: FORMAT,
            files: std::mem::take(files),
            trials: std::mem::take(trials),
        };
        let written = write(path, &content);
        (*files, *trials) = (content.files, content.trials);
        if let Err(error) = written {
            tracing::warn!(
                "{}: verdicts on plugins cannot be kept: {error}; the next start examines them again",
                path.display()
            );
        }
    }
}

/// Whole or not at all: another session may read at the same time.
fn write(path: &Path, content: &Content) -> std::io::Result<()> {
    let folder = path.parent().unwrap_or(Path::new("."));
    std::fs::create_dir_all(folder)?;
    let mut file = tempfile::NamedTempFile::new_in(folder)?;
    file.write_all(&serde_json::to_vec_pretty(content)?)?;
    file.persist(path).map_err(|error| error.error)?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn key() -> FileKey {
        FileKey {
            path: "/plugins/libdots.so".into(),
            size: 3,
            modified_ns: 4,
            hash: "ab".into(),
            host: "0.1.0".into(),
        }
    }

    fn trial() -> TrialKey {
        TrialKey {
            hash: "ab".into(),
            plugin: "a.b".into(),
            host: "0.1.0".into(),
            adapter: "llvmpipe, Mesa 22.3.6".into(),
        }
    }

    fn filled(folder: &Path) -> VerdictCache {
        let mut cache = VerdictCache::open(Some(folder));
        cache.set_file(key(), Verdict::ok());
        let crash = Verdict::new(VerdictClass::Crashed, "signal 11".into());
        cache.set_trial(trial(), crash);
        cache.save();
        VerdictCache::open(Some(folder))
    }

    #[test]
    fn verdicts_survive_the_session() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let cache = filled(folder.path());
        assert_eq!(cache.file(&key()), Some(&Verdict::ok()));
        assert!(cache.trial(&trial()).is_some_and(Verdict::is_quarantined));
    }

    #[test]
    fn any_part_of_the_key_invalidates() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let cache = filled(folder.path());
        let changes: [fn(&mut FileKey); 5] = [
            |key| key.path = "/elsewhere/libdots.so".into(),
            |key| key.size = 4,
            |key| key.modified_ns = 5,
            |key| key.hash = "cd".into(),
            |key| key.host = "0.2.0".into(),
        ];
        for change in changes {
            let mut other = key();
            change(&mut other);
            assert_eq!(cache.file(&other), None, "{other:?}");
        }
        let driver = TrialKey {
            adapter: "llvmpipe, Mesa 23".into(),
            ..trial()
        };
        assert_eq!(cache.trial(&driver), None);
    }

    #[test]
    fn forgetting_a_hash_forgets_file_and_trials() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let mut cache = filled(folder.path());
        cache.forget("ab");
        assert_eq!((cache.file(&key()), cache.trial(&trial())), (None, None));
    }

    #[test]
    fn what_the_user_set_aside_stays_so_under_any_name_until_it_is_forgotten() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let mut cache = filled(folder.path());
        assert!(!cache.is_set_aside("ab"));
        cache.set_file(key(), Verdict::set_aside("libdots.so"));
        cache.save();
        let mut cache = VerdictCache::open(Some(folder.path()));
        assert!(cache.is_set_aside("ab"), "in the next session too");
        cache.forget("ab");
        assert!(!cache.is_set_aside("ab"));
    }

    #[test]
    fn a_damaged_cache_is_set_aside() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        drop(filled(folder.path()));
        let path = folder.path().join(FILE_NAME);
        let bytes = std::fs::read(&path).expect("readable");
        std::fs::write(&path, &bytes[..bytes.len() / 2]).expect("writable");
        assert_eq!(VerdictCache::open(Some(folder.path())).file(&key()), None);
        assert!(path.with_extension("damaged").exists());
        assert!(filled(folder.path()).file(&key()).is_some(), "works again");
    }

    #[test]
    fn an_unwritable_folder_costs_only_the_memory() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let file = folder.path().join("file");
        std::fs::write(&file, b"").expect("writable");
        let mut cache = VerdictCache::open(Some(&file.join("below")));
        cache.set_file(key(), Verdict::ok());
        cache.save();
        assert_eq!(cache.file(&key()), Some(&Verdict::ok()));
    }
}
