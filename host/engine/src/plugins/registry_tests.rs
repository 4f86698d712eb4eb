use super::*;
use crate::plugins::FoundIn;
use pointstage_plugin_api::manifest::Manifest;

/// A made-up renderer in the folder `/plugins`.
pub(crate) fn info(id: &str, version: &str) -> PluginInfo {
    let json = serde_json::json!({ "format": 1, "api": "1.0",
        "plugins": [{ "kind": "renderer", "id": id, "version": version }] });
    let manifest = Manifest::parse(json.to_string().as_bytes()).expect("a good manifest");
    PluginInfo {
        id: id.to_owned(),
        entry: manifest.plugins[0].clone(),
        path: format!("/plugins/{id}-{version}.so").into(),
        hash: blake3::hash(version.as_bytes()).to_hex().to_string(),
    }
}

fn infos() -> Vec<Arc<PluginInfo>> {
    let made = [
        info("org.example.dots", "1.0.0"),
        info("org.example.dots", "2.0.0"),
        info("org.example.disks", "1.0.0"),
    ];
    made.into_iter().map(Arc::new).collect()
}

fn found(key: &str) -> Result<Arc<PluginInfo>, String> {
    find("renderer", key, &infos(), &[]).map_err(|error| error.to_string())
}

#[test]
fn a_renderer_is_found_by_id_alias_version_and_hash() {
    let version = |key: &str| found(key).map(|info| info.entry.version.clone());
    assert_eq!(
        version("org.example.dots"),
        Ok("1.0.0".into()),
        "the first of two"
    );
    assert_eq!(version("dots"), Ok("1.0.0".into()));
    assert_eq!(version("dots@2.0.0"), Ok("2.0.0".into()));
    assert_eq!(version("org.example.dots@2.0.0"), Ok("2.0.0".into()));
    let hash = &infos()[1].hash[..8];
    assert_eq!(version(&format!("dots#{hash}")), Ok("2.0.0".into()));
}

#[test]
fn a_miss_names_the_nearest() {
    assert_eq!(
        found("dotz").expect_err("unknown"),
        "no renderer 'dotz'; did you mean 'dots'?"
    );
    assert_eq!(
        found("dots@3.0.0").expect_err("unknown"),
        "no renderer 'dots@3.0.0'; there is org.example.dots@1.0.0 and org.example.dots@2.0.0"
    );
    assert_eq!(
        found("qsplat").expect_err("unknown"),
        "no renderer 'qsplat'; there are dots, dots, disks"
    );
}

#[test]
fn a_renderer_of_a_refused_file_says_why() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = PluginFile {
        manifest: Some(Manifest::parse(
            br#"{"format":1,"api":"1.0","plugins":[{"kind":"renderer","id":"a.bad","version":"1"}]}"#,
        ).expect("a good manifest")),
        verdict: Verdict::new(VerdictClass::Crashed, "libbad.so: crashed (SIGSEGV)".into()),
        ..look_at(&Candidate { path: folder.path().join("libbad.so"), found_in: FoundIn::Named }).expect("named")
    };
    let error = find("renderer", "bad", &infos(), &[file]).expect_err("refused");
    assert_eq!(
        error.to_string(),
        "no renderer 'bad': libbad.so: crashed (SIGSEGV)"
    );
}

#[test]
fn bad_files_have_a_verdict_and_never_an_entry() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let write = |name: &str, content: &[u8]| {
        let path = folder
            .path()
            .join(name)
            .with_extension(std::env::consts::DLL_EXTENSION);
        std::fs::write(&path, content).expect("writable");
        path
    };
    let program = std::fs::read(std::env::current_exe().expect("running")).expect("readable");
    let cases = [
        (write("empty", b""), "the file is empty"),
        (write("script", b"#!/bin/sh\nexit 1\n"), "no shared library"),
        (write("cut", &program[..1_000]), "truncated"),
        (folder.path().join("missing"), "cannot be read"),
        (folder.path().to_owned(), "cannot be read"),
    ];
    let options = DiscoverOptions {
        files: cases.iter().map(|(path, _)| path.clone()).collect(),
        ..DiscoverOptions::default()
    };
    let registry = Registry::discover(&options);
    assert!(registry.renderers().is_empty());
    for ((path, expected), file) in cases.iter().zip(registry.files()) {
        assert_eq!(
            file.verdict.class,
            VerdictClass::Rejected,
            "{}",
            path.display()
        );
        assert!(
            file.verdict.message.contains(expected),
            "{}",
            file.verdict.message
        );
    }
    assert_eq!(registry.files().len(), cases.len());
}

#[test]
fn a_file_that_changed_after_the_check_is_not_loaded() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("lib.so");
    std::fs::write(&path, b"other content").expect("writable");
    let registry = Registry::discover(&DiscoverOptions::default());
    let changed = PluginInfo {
        path,
        ..info("a.b", "1")
    };
    let error = registry.load(&changed).expect_err("another hash");
    assert!(matches!(error, LoadPluginError::Changed { .. }), "{error}");
}
