//! Plugin files that the command line names with `--plugin`.

use pointstage_engine::plugins::Registry;

use super::Globals;

/// Says on standard error which of them cannot be used, and why: a file that was named must not vanish without a word.
pub(crate) fn warn_of_unusable(registry: &Registry, globals: &Globals) {
    let named: Vec<_> = globals
        .plugins
        .iter()
        .map(|path| std::fs::canonicalize(path).unwrap_or_else(|_| path.clone()))
        .collect();
    let unusable = registry
        .files()
        .iter()
        .filter(|file| named.contains(&file.path) && !file.verdict.is_usable());
    for file in unusable {
        let verdict = &file.verdict;
        eprintln!(
            "warning: plugin {}: {}: {}",
            file.path.display(),
            verdict.in_words(),
            verdict.message
        );
    }
}
