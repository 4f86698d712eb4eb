//! The journal: names the plugin that is about to do something for the first time, so that a crash is pinned to it.
//!
//! Each session has a file of its own in the state folder and holds a lock on it. A file without a lock at the next
//! start belongs to a session that is gone; if it still names an act, that session ended within it.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{Read, Seek as _, Write as _};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

const PREFIX: &str = "journal-";
/// A journal is a few lines; more is not ours.
const LONGEST_JOURNAL: u64 = 1 << 20;

/// What a plugin was about to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Act {
    /// Its library is loaded.
    Load,
    /// It prepares and draws for the first time.
    FirstUse,
    /// It looks at a file, or reads it.
    ReadFile,
}

impl Act {
    fn in_words(self) -> &'static str {
        match self {
            Self::Load => "while its library was loaded",
            Self::FirstUse => "while it prepared and drew for the first time",
            Self::ReadFile => "while it read a file",
        }
    }
}

/// A plugin in whose act the last session ended.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Culprit {
    /// Its id.
    pub plugin: String,
    /// Its library.
    pub file: PathBuf,
    /// Content hash of the library, hexadecimal.
    pub hash: String,
    /// What it was about to do.
    pub act: Act,
}

impl std::fmt::Display for Culprit {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "the last session ended in '{}' {}",
            self.plugin,
            self.act.in_words()
        )
    }
}

/// The session's journal. Thread: any. Without a writable state folder it notes nothing.
#[derive(Debug, Default)]
pub struct Journal {
    state: Mutex<State>,
}

#[derive(Debug, Default)]
struct State {
    file: Option<(File, PathBuf)>,
    acts: BTreeMap<u64, Culprit>,
    next: u64,
}

/// An act under way. Dropping it notes that the act is over.
#[derive(Debug)]
pub struct Watch {
    journal: Arc<Journal>,
    number: u64,
}

impl Journal {
    /// Opens a journal in `folder` and tells in whose acts earlier sessions ended.
    ///
    /// A folder that cannot be written is a warning, not an error: the session then has no journal.
    pub fn open(folder: &Path) -> (Arc<Self>, Vec<Culprit>) {
        let culprits = collect(folder);
        let mut state = State::default();
        match create(folder) {
            Ok(file) => state.file = Some(file),
            Err(error) => tracing::warn!(
                "no crash journal in {}: {error}; a crash will not be pinned to its plugin",
                folder.display()
            ),
        }
        (
            Arc::new(Self {
                state: Mutex::new(state),
            }),
            culprits,
        )
    }

    /// Notes that `culprit` is about to act, until the returned value is dropped.
    pub fn begin(self: &Arc<Self>, culprit: Culprit) -> Watch {
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        let number = state.next;
        state.next += 1;
        state.acts.insert(number, culprit);
        state.write();
        Watch {
            journal: Arc::clone(self),
            number,
        }
    }
}

impl State {
    /// Writes all acts under way. The system keeps what a process wrote when that process dies, so no sync is needed.
    fn write(&mut self) {
        let Self {
            file: Some((file, path)),
            acts,
            ..
        } = self
        else {
            return;
        };
        let acts: Vec<&Culprit> = acts.values().collect();
        let written = serde_json::to_vec(&acts)
            .map_err(std::io::Error::from)
            .and_then(|bytes| {
                file.set_len(0)?;
                file.rewind()?;
                file.write_all(&bytes)
            });
        if let Err(error) = written {
            tracing::warn!(
                "{}: the crash journal cannot be written: {error}",
                path.display()
            );
            self.file = None;
        }
    }
}

impl Drop for State {
    fn drop(&mut self) {
        // A clean end leaves nothing.
        if let Some((file, path)) = self.file.take() {
            drop(file);
            let _ = std::fs::remove_file(path);
        }
    }
}

impl Drop for Watch {
    fn drop(&mut self) {
        let mut state = self
            .journal
            .state
            .lock()
            .unwrap_or_else(PoisonError::into_inner);
        state.acts.remove(&self.number);
        state.write();
    }
}

fn create(folder: &Path) -> std::io::Result<(File, PathBuf)> {
    std::fs::create_dir_all(folder)?;
    let path = tempfile::Builder::new()
        .prefix(PREFIX)
        .suffix(".json")
        .tempfile_in(folder)?;
    let (file, path) = path.keep().map_err(|error| error.error)?;
    file.lock()?;
    Ok((file, path))
}

/// Reads and removes the journals of sessions that are gone.
fn collect(folder: &Path) -> Vec<Culprit> {
    let Ok(entries) = std::fs::read_dir(folder) else {
        return Vec::new();
    };
    let mut paths: Vec<PathBuf> = entries
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| {
            let name = path
                .file_name()
                .and_then(|name| name.to_str())
                .unwrap_or_default();
            name.starts_with(PREFIX)
        })
        .collect();
    paths.sort();
    let mut culprits = Vec::new();
    for path in paths {
        let Ok(mut file) = OpenOptions::new().read(true).write(true).open(&path) else {
            continue;
        };
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock | TryLockError::Error(_)) => continue,
        }
        let mut bytes = Vec::new();
        let read = Read::by_ref(&mut file)
            .take(LONGEST_JOURNAL)
            .read_to_end(&mut bytes);
        if read.is_ok() && !bytes.is_empty() {
            match serde_json::from_slice::<Vec<Culprit>>(&bytes) {
                Ok(found) => culprits.extend(found),
                // Half written when the process died, or not ours: nobody can be named.
                Err(error) => {
                    tracing::warn!("{}: a damaged crash journal: {error}", path.display());
                }
            }
        }
        drop(file);
        let _ = std::fs::remove_file(&path);
    }
    culprits.dedup();
    culprits
}

#[cfg(test)]
mod tests {
    use super::*;

    fn culprit(plugin: &str) -> Culprit {
        Culprit {
            plugin: plugin.into(),
            file: "/plugins/lib.so".into(),
            hash: "00".into(),
            act: Act::FirstUse,
        }
    }

    /// What a session that dies leaves: its file without the lock.
    fn leave_behind(folder: &Path, content: &[u8]) {
        std::fs::write(folder.join("journal-gone.json"), content).expect("a writable folder");
    }

    #[test]
    fn a_session_that_ended_in_an_act_names_the_plugin_once() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let left = serde_json::to_vec(&[culprit("org.example.bad")]).expect("plain data");
        leave_behind(folder.path(), &left);
        let (_journal, culprits) = Journal::open(folder.path());
        assert_eq!(culprits, [culprit("org.example.bad")]);
        assert!(culprits[0].to_string().contains("for the first time"));
        let (_second, again) = Journal::open(folder.path());
        assert_eq!(again, [], "told once");
    }

    #[test]
    fn a_running_session_is_not_blamed_and_a_clean_end_leaves_nothing() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let (journal, _) = Journal::open(folder.path());
        let watch = journal.begin(culprit("org.example.busy"));
        let (other, culprits) = Journal::open(folder.path());
        assert_eq!(culprits, [], "its session is alive");
        drop((watch, journal, other));
        let left = std::fs::read_dir(folder.path())
            .expect("the folder")
            .count();
        assert_eq!(left, 0);
    }

    #[test]
    fn only_acts_under_way_are_on_record() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let (journal, _) = Journal::open(folder.path());
        let first = journal.begin(culprit("a.first"));
        let second = journal.begin(culprit("a.second"));
        drop(first);
        let path = journal
            .state
            .lock()
            .expect("not poisoned")
            .file
            .as_ref()
            .expect("a file")
            .1
            .clone();
        let on_record = || -> Vec<Culprit> {
            serde_json::from_slice(&std::fs::read(&path).expect("readable")).expect("whole")
        };
        assert_eq!(on_record(), [culprit("a.second")]);
        drop(second);
        assert_eq!(on_record(), []);
    }

    #[test]
    fn damaged_journals_and_bad_folders_are_no_error() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        leave_behind(folder.path(), b"[{\"plugin\":");
        assert_eq!(Journal::open(folder.path()).1, []);
        let file = folder.path().join("file");
        std::fs::write(&file, b"").expect("writable");
        let (journal, _) = Journal::open(&file.join("below"));
        drop(journal.begin(culprit("a.b")));
    }
}
