//! What a run of the tests printed: kept in a file, and counted.

use std::fs::File;
use std::io::{BufWriter, Write as _};
use std::path::{Path, PathBuf};

use crate::Outcome;

/// What begins a test's line when it could not run and says why.
const SKIPPED: &str = "skipped: ";

/// The log of one run.
pub(crate) struct TestLog {
    path: PathBuf,
    file: BufWriter<File>,
    counts: Counts,
}

/// The tests by their end.
#[derive(Default)]
struct Counts {
    passed: u32,
    failed: u32,
    ignored: u32,
    /// Why tests were skipped; a skipped test also counts as passed.
    skips: Vec<String>,
    failures: Vec<String>,
}

impl TestLog {
    /// An empty log, `tests.log` in `folder`.
    pub(crate) fn create(folder: &Path) -> Outcome<Self> {
        let path = folder.join("tests.log");
        let cannot = |error: std::io::Error| format!("{}: {error}", path.display());
        std::fs::create_dir_all(folder).map_err(cannot)?;
        let file = BufWriter::new(File::create(&path).map_err(cannot)?);
        Ok(Self {
            path,
            file,
            counts: Counts::default(),
        })
    }

    /// Takes the next line.
    pub(crate) fn take(&mut self, line: &str) {
        // A full disk must not hide the tests' own verdict.
        let _ = writeln!(self.file, "{line}");
        self.counts.take(line);
    }

    /// One paragraph: how many passed, failed and were skipped, and why.
    pub(crate) fn summary(&self) -> String {
        let Counts {
            passed,
            failed,
            ignored,
            skips,
            failures,
        } = &self.counts;
        let mut text = format!(
            "tests: {passed} passed, {failed} failed, {ignored} ignored, {} skipped",
            skips.len()
        );
        for line in failures
            .iter()
            .map(|name| format!("failed: {name}"))
            .chain(skips.iter().map(|why| format!("{SKIPPED}{why}")))
        {
            text.push_str("\n      ");
            text.push_str(&line);
        }
        text
    }

    /// Where the log is.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }
}

impl Counts {
    fn take(&mut self, line: &str) {
        if let Some(result) = line.strip_prefix("test result: ") {
            self.passed += count(result, "passed");
            self.failed += count(result, "failed");
            self.ignored += count(result, "ignored");
        } else if let Some(name) = line
            .strip_prefix("test ")
            .and_then(|rest| rest.strip_suffix(" ... FAILED"))
        {
            self.failures.push(name.to_owned());
        } else if let Some((before, why)) = line.split_once(SKIPPED) {
            // With one thread the test's name stands before what it prints: 'test name ... skipped: why'.
            if before.is_empty() || before.ends_with("... ") {
                self.skips.push(why.to_owned());
            }
        }
    }
}

/// The number before `word` in 'ok. 12 passed; 0 failed; …'.
fn count(result: &str, word: &str) -> u32 {
    let part = result
        .split([';', '.'])
        .find_map(|part| part.trim().strip_suffix(word));
    part.and_then(|number| number.trim().parse().ok())
        .unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::Counts;

    #[test]
    fn results_of_several_binaries_add_up() {
        let mut counts = Counts::default();
        counts.take("test result: ok. 12 passed; 0 failed; 1 ignored; 0 measured; 0 filtered out; finished in 0.00s");
        counts.take("test a::b ... FAILED");
        counts.take("test result: FAILED. 3 passed; 1 failed; 0 ignored; 0 measured; 0 filtered out; finished in 1.20s");
        assert_eq!((counts.passed, counts.failed, counts.ignored), (15, 1, 1));
        assert_eq!(counts.failures, ["a::b"]);
    }

    #[test]
    fn a_skip_counts_alone_and_after_a_test_name_but_not_inside_prose() {
        let mut counts = Counts::default();
        counts.take("skipped: no data folder");
        counts.take("test brain ... skipped: no display");
        counts.take("3 files were skipped: too large");
        assert_eq!(counts.skips, ["no data folder", "no display"]);
    }
}
