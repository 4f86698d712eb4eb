//! What happens when a file is no plugin, a spoiled one, an older or newer one, or one that ends the process.
//!
//! Every case ends in a verdict with a message, and the test's own process is still there.

use anyhow::{Context as _, Result};
use pointstage_engine::plugins::{
    ChildProgram, DiscoverOptions, Examination, PluginFile, Registry, VerdictClass,
};
use pointstage_plugin_api::abi::ROOT_MODULE_LOADER_NAME_WITH_NUL;
use pointstage_tests::plugins::{self, Variant, replace_all, spoiled};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// The registry of these files, each examined in a child.
fn examined(files: &[PathBuf], state_folder: Option<&Path>) -> Registry {
    let mut child = ChildProgram::new(env!("CARGO_BIN_EXE_examiner").into());
    // A hang has to be waited for; loading takes milliseconds, on a loaded machine perhaps a second.
    child.check_limit = Duration::from_secs(5);
    Registry::discover(&DiscoverOptions {
        files: files.to_vec(),
        examination: Examination::Child(child),
        state_folder: state_folder.map(Path::to_owned),
        ..DiscoverOptions::default()
    })
}

/// The verdict on one file.
fn verdict(file: PathBuf) -> Result<PluginFile> {
    let registry = examined(&[file], None);
    registry
        .files()
        .first()
        .cloned()
        .context("a named file always has a verdict")
}

/// Asserts that `file` is refused as `class` with a message that holds `expected`.
fn assert_refused(file: PathBuf, class: VerdictClass, expected: &str) -> Result<()> {
    let name = file.display().to_string();
    let found = verdict(file)?;
    let message = &found.verdict.message;
    assert_eq!(found.verdict.class, class, "{name}: {message}");
    assert!(
        message.contains(expected),
        "{name}: expected '{expected}' in '{message}'"
    );
    assert!(message.len() < 400, "one sentence, not a report: {message}");
    Ok(())
}

#[test]
fn a_good_library_of_many_renderers_is_accepted() -> Result<()> {
    let registry = examined(&[plugins::misbehaving()?], None);
    let file = &registry.files()[0];
    assert_eq!(
        file.verdict.class,
        VerdictClass::Ok,
        "{}",
        file.verdict.message
    );
    assert_eq!(file.api.as_deref(), Some("1.2.0"));
    assert!(
        registry.renderers().len() >= 20,
        "{}",
        registry.renderers().len()
    );
    registry.load(&*registry.find_renderer("good")?)?;
    Ok(())
}

#[test]
fn a_truncated_library_is_refused_at_every_length() -> Result<()> {
    let folder = tempfile::tempdir()?;
    let library = plugins::misbehaving()?;
    let length = std::fs::metadata(&library)?.len() as usize;
    for part in [
        1,
        4,
        63,
        64,
        1_000,
        4_096,
        65_536,
        300_000,
        length / 2,
        length * 3 / 4,
    ] {
        let cut = spoiled(&library, folder.path(), &format!("cut-{part}"), |bytes| {
            bytes.truncate(part);
        })?;
        let found = verdict(cut)?;
        assert_eq!(
            found.verdict.class,
            VerdictClass::Rejected,
            "{part} bytes: {}",
            found.verdict.message
        );
    }
    Ok(())
}

#[test]
fn what_is_no_library_is_refused() -> Result<()> {
    let folder = tempfile::tempdir()?;
    let write = |name: &str, content: &[u8]| -> Result<PathBuf> {
        let path = folder.path().join(name);
        std::fs::write(&path, content)?;
        Ok(path)
    };
    assert_refused(
        write("empty.so", b"")?,
        VerdictClass::Rejected,
        "the file is empty",
    )?;
    assert_refused(
        write("text.so", b"I am a plugin")?,
        VerdictClass::Rejected,
        "no shared library",
    )?;
    assert_refused(
        folder.path().join("missing.so"),
        VerdictClass::Rejected,
        "cannot be read",
    )?;
    assert_refused(
        folder.path().to_owned(),
        VerdictClass::Rejected,
        "cannot be read",
    )
}

#[test]
fn a_library_of_somebody_else_is_refused_when_named() -> Result<()> {
    let folder = tempfile::tempdir()?;
    let spoil = |bytes: &mut Vec<u8>| assert!(replace_all(bytes, b".ptstage", b".nothing") > 0);
    let other = spoiled(&plugins::misbehaving()?, folder.path(), "other", spoil)?;
    assert_refused(other, VerdictClass::Rejected, "no Pointstage manifest")
}

#[test]
fn a_library_without_the_entry_symbol_is_refused() -> Result<()> {
    let folder = tempfile::tempdir()?;
    let symbol = ROOT_MODULE_LOADER_NAME_WITH_NUL
        .trim_end_matches('\0')
        .as_bytes();
    let mut other = symbol.to_vec();
    other[symbol.len() - 1] ^= 1;
    let spoil = |bytes: &mut Vec<u8>| assert!(replace_all(bytes, symbol, &other) > 0);
    let nameless = spoiled(&plugins::misbehaving()?, folder.path(), "nameless", spoil)?;
    assert_refused(nameless, VerdictClass::Rejected, "does not export a plugin")
}

#[test]
fn a_damaged_manifest_is_refused_with_its_place() -> Result<()> {
    let folder = tempfile::tempdir()?;
    let spoil =
        |bytes: &mut Vec<u8>| assert!(replace_all(bytes, b"\"format\": 1", b"\"format\": x") > 0);
    let damaged = spoiled(&plugins::misbehaving()?, folder.path(), "damaged", spoil)?;
    assert_refused(
        damaged,
        VerdictClass::Rejected,
        "the manifest is not readable",
    )
}

#[test]
fn another_major_version_is_refused_with_both_versions_and_advice() -> Result<()> {
    let folder = tempfile::tempdir()?;
    let spoil = |bytes: &mut Vec<u8>| {
        assert!(replace_all(bytes, b"\"api\": \"1.0\"", b"\"api\": \"2.0\"") > 0);
    };
    let later = spoiled(&plugins::misbehaving()?, folder.path(), "later", spoil)?;
    assert_refused(
        later,
        VerdictClass::Rejected,
        "built for plugin interface 2.0, this program has 1.2.0; update",
    )
}

#[test]
fn a_changed_record_is_refused_in_one_sentence_with_the_report_folded_away() -> Result<()> {
    let library = plugins::variant(Variant::Changed)?;
    let found = verdict(library.clone())?;
    assert_refused(library, VerdictClass::Rejected, "differ in layout")?;
    assert!(!found.verdict.detail.is_empty(), "the places that differ");
    assert!(
        found.verdict.detail.len() < 4_000,
        "{} bytes",
        found.verdict.detail.len()
    );
    Ok(())
}

#[test]
fn a_newer_minor_version_loads() -> Result<()> {
    let registry = examined(
        &[plugins::variant(Variant::Newer)?, plugins::misbehaving()?],
        None,
    );
    for file in registry.files() {
        assert_eq!(
            file.verdict.class,
            VerdictClass::Ok,
            "{}",
            file.verdict.message
        );
    }
    assert_eq!(registry.files()[0].api.as_deref(), Some("1.3.0"));
    // Newer and current in one process, in this order: the outcome must not depend on what was loaded before.
    registry.load(&*registry.find_renderer("variant")?)?;
    registry.load(&*registry.find_renderer("good")?)?;
    Ok(())
}

#[test]
#[cfg(target_os = "linux")]
fn a_crash_an_abort_an_exit_and_a_hang_on_load_are_quarantined() -> Result<()> {
    let folder = tempfile::tempdir()?;
    let cases = [
        ("segfault", VerdictClass::Crashed, "SIGSEGV"),
        ("abort", VerdictClass::Crashed, "SIGABRT"),
        ("exit", VerdictClass::OddExit, "without an answer"),
        ("hang", VerdictClass::Hung, "no answer within"),
    ];
    for (fault, class, expected) in cases {
        assert_refused(plugins::on_load(fault, folder.path())?, class, expected)?;
    }
    Ok(())
}

#[test]
#[cfg(target_os = "linux")]
fn a_quarantined_file_is_not_loaded_again_until_the_user_says_so() -> Result<()> {
    let (folder, state) = (tempfile::tempdir()?, tempfile::tempdir()?);
    let file = plugins::on_load("segfault", folder.path())?;
    let first = examined(std::slice::from_ref(&file), Some(state.path()));
    assert!(!first.files()[0].from_cache);
    let error = first
        .find_renderer("onload")
        .expect_err("quarantined")
        .to_string();
    assert!(error.contains("SIGSEGV"), "{error}");
    let second = examined(std::slice::from_ref(&file), Some(state.path()));
    assert!(second.files()[0].from_cache, "the verdict is remembered");
    assert!(second.files()[0].verdict.is_quarantined());
    second.retry(&second.files()[0].path);
    let third = examined(&[file], Some(state.path()));
    assert!(
        !third.files()[0].from_cache,
        "tried again, as the user asked"
    );
    Ok(())
}

#[test]
fn a_plugin_with_panic_abort_does_not_compile_and_the_message_says_why() -> Result<()> {
    let message = plugins::compile_aborting()?;
    assert!(
        message.contains("Pointstage plugins need unwinding panics"),
        "{message}"
    );
    Ok(())
}
