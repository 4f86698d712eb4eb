//! The files that were opened last.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

/// The most files that are remembered: what a menu shows at a glance.
const MOST: usize = 12;

/// Absolute paths, newest first, each once.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(transparent)]
pub(crate) struct Recent(Vec<PathBuf>);

impl Recent {
    /// Notes that a file was opened just now.
    ///
    /// A path that is not Unicode is left out: the settings file cannot hold it.
    pub(crate) fn note(&mut self, path: &Path) {
        let path = std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf());
        if path.to_str().is_none() {
            return;
        }
        self.0.retain(|other| *other != path);
        self.0.insert(0, path);
        self.0.truncate(MOST);
    }

    /// Newest first.
    pub(crate) fn paths(&self) -> &[PathBuf] {
        &self.0[..self.0.len().min(MOST)]
    }

    /// Forgets all.
    pub(crate) fn clear(&mut self) {
        self.0.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_newest_of_twelve_comes_first_and_none_comes_twice() {
        let mut recent = Recent::default();
        for number in 0..20 {
            recent.note(Path::new(&format!("/{number}.ply")));
        }
        recent.note(Path::new("/10.ply"));
        assert_eq!(recent.paths().len(), MOST);
        assert_eq!(recent.paths()[0], Path::new("/10.ply"));
        assert_eq!(recent.paths()[1], Path::new("/19.ply"));
        let tens = recent
            .paths()
            .iter()
            .filter(|path| path.ends_with("10.ply"));
        assert_eq!(tens.count(), 1);
        recent.clear();
        assert!(recent.paths().is_empty());
    }
}
