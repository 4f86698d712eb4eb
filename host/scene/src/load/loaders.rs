//! The table of loaders, and which of them gets a file.

use std::fmt;
use std::path::Path;
use std::sync::Arc;

use pointstage_plugin_api::lines::excerpt;
use pointstage_plugin_api::nearest::{did_you_mean, nearest_names};

use super::error::LoadError;
use super::loader::{Claim, FileStart, Loader, LoaderInfo, START_BYTES, SourceFile};
use super::not_read::not_read;
use super::ply::PlyLoader;
use super::qs::QsLoader;
use super::sfl::SflLoader;
use super::tri::TriLoader;

/// Loaders, in the order in which they are asked: those that come with the program first.
///
/// Those that somebody else brings are fetched when they are first needed: finding plugins takes time, and a file with the
/// signature of a built-in format needs none of them.
#[derive(Clone)]
pub struct Loaders {
    built_in: Vec<Arc<dyn Loader>>,
    others: Option<Fetch>,
}

/// Fetches the loaders of plugins; they are fetched as often as they are needed, so it keeps them itself.
type Fetch = Arc<dyn Fn() -> Vec<Arc<dyn Loader>> + Send + Sync>;

impl fmt::Debug for Loaders {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Loaders")
            .field("built_in", &self.built_in)
            .field("has_others", &self.others.is_some())
            .finish()
    }
}

impl Default for Loaders {
    fn default() -> Self {
        Self::built_in()
    }
}

impl Loaders {
    /// Those that come with the program.
    pub fn built_in() -> Self {
        Self {
            built_in: vec![
                Arc::new(PlyLoader::new()),
                Arc::new(SflLoader::new()),
                Arc::new(QsLoader::new()),
                Arc::new(TriLoader::new()),
            ],
            others: None,
        }
    }

    /// These, and those that `fetch` gives once a file needs them.
    #[must_use]
    pub fn with_others(
        mut self,
        fetch: impl Fn() -> Vec<Arc<dyn Loader>> + Send + Sync + 'static,
    ) -> Self {
        self.others = Some(Arc::new(fetch));
        self
    }

    /// All of them.
    pub fn all(&self) -> Vec<Arc<dyn Loader>> {
        let others = self.others.as_ref().map(|fetch| fetch());
        let built_in = self.built_in.iter().cloned();
        built_in.chain(others.unwrap_or_default()).collect()
    }

    /// Names and options of the loader of this id or alias.
    ///
    /// # Errors
    /// There is none.
    pub fn named(&self, key: &str) -> Result<LoaderInfo, UnknownLoader> {
        let loader = find(&self.all(), key)?;
        Ok(loader.info().clone())
    }

    /// The loader for a file: the one of this id or alias, or the one that claims it most.
    ///
    /// The content decides first, then the extension, then the order of the table.
    ///
    /// # Errors
    /// There is no such loader, or none claims the file.
    pub(super) fn choose(
        &self,
        file: &SourceFile,
        wanted: Option<&str>,
    ) -> Result<Arc<dyn Loader>, LoadError> {
        if let Some(key) = wanted {
            return find(&self.all(), key).map_err(|source| LoadError::NoLoader {
                path: file.path().to_path_buf(),
                source,
            });
        }
        let name = file.name();
        let start = FileStart {
            bytes: &file.bytes()[..file.bytes().len().min(START_BYTES)],
            name: &name,
            length: file.bytes().len() as u64,
        };
        // A signature of a built-in format needs no other opinion.
        let built_in = most_claiming(&self.built_in, &start);
        if let Some((loader, Claim::Certain)) = built_in {
            return Ok(loader);
        }
        let all = self.all();
        if let Some((loader, _)) = most_claiming(&all, &start) {
            return Ok(loader);
        }
        Err(unknown(file.path(), &start, &all))
    }
}

/// No loader of this name.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("no loader '{loader}'{hint}")]
pub struct UnknownLoader {
    /// What was asked for.
    pub loader: String,
    /// The nearest names, or all of them.
    pub hint: String,
}

/// The loader of this id or alias.
fn find(loaders: &[Arc<dyn Loader>], key: &str) -> Result<Arc<dyn Loader>, UnknownLoader> {
    // An id is more precise than an alias: somebody else's loader may have that alias.
    let by_id = loaders.iter().find(|loader| loader.info().id == key);
    let by_any = || loaders.iter().find(|loader| loader.info().alias == key);
    if let Some(loader) = by_id.or_else(by_any) {
        return Ok(Arc::clone(loader));
    }
    let aliases: Vec<&str> = loaders
        .iter()
        .map(|loader| loader.info().alias.as_str())
        .collect();
    let near = nearest_names(key, aliases.iter().copied());
    Err(UnknownLoader {
        loader: key.to_owned(),
        hint: if near.is_empty() {
            format!("; there are {}", aliases.join(", "))
        } else {
            did_you_mean(&near)
        },
    })
}

/// The loader that claims the file most; none if no one does.
fn most_claiming(
    loaders: &[Arc<dyn Loader>],
    start: &FileStart<'_>,
) -> Option<(Arc<dyn Loader>, Claim)> {
    let extension = start.extension();
    let mut best = None;
    let mut most = (Claim::No, false);
    for loader in loaders {
        let has_extension = loader.info().has_extension(&extension);
        let claim = loader.claims(start);
        let is_claimed = claim >= Claim::Likely || (claim == Claim::Possible && has_extension);
        // Any claim of these is more than none, and of equal ones the first stays.
        if is_claimed && (claim, has_extension) > most {
            most = (claim, has_extension);
            best = Some(loader);
        }
    }
    best.map(|loader| (Arc::clone(loader), most.0))
}

/// Why no loader takes the file.
fn unknown(path: &Path, start: &FileStart<'_>, loaders: &[Arc<dyn Loader>]) -> LoadError {
    let path = path.to_path_buf();
    if let Some((format, advice)) = not_read(start) {
        return LoadError::NotRead {
            path,
            format,
            advice,
        };
    }
    let found = if start.bytes.is_empty() {
        "nothing (the file is empty)".to_owned()
    } else {
        format!("'{}'", excerpt(&start.bytes[..start.bytes.len().min(16)]))
    };
    let names: Vec<String> = loaders.iter().map(|loader| listed(loader.info())).collect();
    LoadError::UnknownFormat {
        path,
        found,
        readable: names.join(", "),
    }
}

/// A loader in a list: title and extensions.
fn listed(info: &LoaderInfo) -> String {
    let extensions: Vec<String> = info
        .extensions
        .iter()
        .map(|extension| format!(".{extension}"))
        .collect();
    if extensions.is_empty() {
        return info.title.clone();
    }
    format!("{} [{}]", info.title, extensions.join(" "))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::Job;
    use crate::load::{Contents, FormatError, LoadOptions, LoadStop};

    /// Claims what starts with its mark.
    #[derive(Debug)]
    struct Marked {
        info: LoaderInfo,
        mark: &'static [u8],
        claim: Claim,
    }

    impl Loader for Marked {
        fn info(&self) -> &LoaderInfo {
            &self.info
        }

        fn claims(&self, start: &FileStart<'_>) -> Claim {
            if start.bytes.starts_with(self.mark) {
                self.claim
            } else {
                Claim::No
            }
        }

        fn load(&self, _: &SourceFile, _: &LoadOptions, _: &Job) -> Result<Contents, LoadStop> {
            Err(FormatError::new("only claims").into())
        }
    }

    fn loaders() -> Loaders {
        let marked = |alias, extension, mark, claim| -> Arc<dyn Loader> {
            let info = LoaderInfo::built_in(alias, alias, &[extension]);
            Arc::new(Marked { info, mark, claim })
        };
        Loaders::built_in().with_others(move || {
            vec![
                marked("sure", "xyz", b"MARK", Claim::Certain),
                marked("words", "txt", b"M", Claim::Likely),
                marked("numbers", "xyz", b"", Claim::Possible),
                marked("rival", "ply", b"ply", Claim::Certain),
            ]
        })
    }

    fn chosen(name: &str, content: &[u8], wanted: Option<&str>) -> Result<String, String> {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join(name);
        std::fs::write(&path, content).expect("written");
        let file = SourceFile::open(&path).expect("just written");
        let loader = loaders().choose(&file, wanted);
        loader
            .map(|loader| loader.info().alias.clone())
            .map_err(|error| error.to_string())
    }

    #[test]
    fn content_decides_before_the_extension_and_the_extension_before_the_order() {
        for (name, content, expected) in [
            // A signature, whatever the name.
            ("a.txt", &b"MARK"[..], "sure"),
            ("a.ply", b"MARK", "sure"),
            // It looks like words, and no extension of a loader that only might read it outweighs that.
            ("a.xyz", b"Mine", "words"),
            // Nothing speaks but the extension.
            ("a.XYZ", b"1 2 3", "numbers"),
            // Two signatures: the loader that comes with the program.
            ("a.ply", b"ply\n", "ply"),
        ] {
            assert_eq!(
                chosen(name, content, None).as_deref(),
                Ok(expected),
                "{name}"
            );
        }
    }

    #[test]
    fn the_choice_can_be_overridden_by_id_and_by_alias() {
        let by = |key| chosen("a.ply", b"ply\n", Some(key));
        assert_eq!(by("rival").as_deref(), Ok("rival"));
        assert_eq!(by("org.pointstage.numbers").as_deref(), Ok("numbers"));
        let error = by("rivla").expect_err("no such loader");
        assert!(
            error.contains("no loader 'rivla'") && error.contains("rival"),
            "{error}"
        );
    }

    #[test]
    fn a_file_that_nobody_claims_tells_what_can_be_read() {
        let error = chosen("a.doc", b"\x00\x01binary", None).expect_err("nobody's");
        for part in [
            "\\x00\\x01binary",
            "Polygon file format (PLY) [.ply]",
            "numbers [.xyz]",
        ] {
            assert!(error.contains(part), "{error}");
        }
        let empty = chosen("a.doc", b"", None).expect_err("nobody's");
        assert!(empty.contains("the file is empty"), "{empty}");
    }

    #[test]
    fn formats_that_nobody_reads_are_called_by_their_name() {
        for (name, content, part) in [
            ("a.stp", &b"ISO-10303-21;\nHEADER;"[..], "a STEP file"),
            ("a.txt", b"  ISO-10303-21;\n", "a STEP file"),
            ("a.spz", b"\x1f\x8b\x08\x00rest", "an SPZ file"),
            ("a.bin", b"NGSP\x02\x00\x00\x00", "an SPZ file"),
            ("a.splat", b"\x00\x00\x80\x3f", "a SPLAT file"),
        ] {
            let error = chosen(name, content, None).expect_err(name);
            assert!(error.contains(part), "{name}: {error}");
        }
    }
}
