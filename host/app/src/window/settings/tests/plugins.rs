use std::time::Duration;

use egui::accesskit::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use pointstage_engine::stage::{PluginHoldings, Severity};

use super::super::plugins::{PluginsTab, plugins_ui};
use super::{asking, assert_asked};
use crate::window::intent::{Intent, Intents, PluginsIntent, WindowIntent};
use crate::window::rows::{FolderRow, PluginRow, Rows};

fn splats() -> PluginRow {
    PluginRow {
        path: "/plugins/libsplats.so".into(),
        title: "Splats".into(),
        verdict: "accepted".into(),
        severity: Severity::Info,
        message: String::new(),
        detail: String::new(),
        facts: vec![("Vendor".into(), "Somebody".into())],
        versions: "1.2.0, API 1.0".into(),
        found_in: "folder added by you".into(),
        load_time: Some(Duration::from_millis(12)),
        ids: vec!["org.example.splats".into()],
        can_retry: false,
    }
}

fn tab(plugin: PluginRow) -> Harness<'static, Intents> {
    let rows = Rows {
        plugins: vec![plugin],
        folders: vec![
            FolderRow {
                path: "/usr/lib/pointstage".into(),
                origin: "beside the program".into(),
                is_removable: false,
            },
            FolderRow {
                path: "/plugins".into(),
                origin: "folder added by you".into(),
                is_removable: true,
            },
        ],
        ..Rows::default()
    };
    let holdings = [PluginHoldings {
        id: "org.example.splats".into(),
        handle_count: 7,
        bytes: 3_400_000,
        load_time: None,
    }];
    asking(move |ui, asked| {
        let tab = PluginsTab {
            rows: &rows,
            holdings: &holdings,
        };
        plugins_ui(ui, &tab, asked);
    })
}

#[test]
fn a_plugin_tells_version_origin_time_and_memory() {
    let harness = tab(splats());
    harness.get_by_label("Splats");
    harness.get_by_label("accepted");
    harness.get_by_label(
        "1.2.0, API 1.0, folder added by you, loaded in 12 ms, holds 3.4 MB in 7 objects on the device",
    );
}

#[test]
fn a_good_plugin_is_set_aside_and_a_bad_one_tried_again() {
    let mut harness = tab(splats());
    assert!(harness.query_by_label("Try again").is_none());
    harness.get_by_label("Set Splats aside").click();
    harness.run();
    assert_asked(
        &harness,
        PluginsIntent::SetAside("/plugins/libsplats.so".into()),
    );

    let mut harness = tab(PluginRow {
        verdict: "quarantined by you".into(),
        severity: Severity::Warning,
        message: "libsplats.so: set aside by you".into(),
        load_time: None,
        can_retry: true,
        ..splats()
    });
    harness.get_by_label("libsplats.so: set aside by you");
    harness.get_by_label("Try again").click();
    harness.run();
    assert_asked(
        &harness,
        PluginsIntent::Retry("/plugins/libsplats.so".into()),
    );
}

#[test]
fn folders_are_added_and_only_added_ones_removed() {
    let mut harness = tab(splats());
    assert!(
        harness
            .query_by_label("Remove folder /usr/lib/pointstage")
            .is_none()
    );
    harness.get_by_label("Remove folder /plugins").click();
    harness.run();
    assert_asked(&harness, PluginsIntent::RemoveFolder("/plugins".into()));

    let mut harness = tab(splats());
    let field = harness.get_by_role_and_label(Role::TextInput, "Folder to look for plugins in");
    field.focus();
    harness.run();
    let field = harness.get_by_role_and_label(Role::TextInput, "Folder to look for plugins in");
    field.type_text("/more");
    harness.run();
    harness.get_by_label("Add folder").click();
    harness.run();
    assert_asked(&harness, PluginsIntent::AddFolder("/more".into()));
}

#[test]
fn all_is_reloaded_and_copied() {
    let mut harness = tab(splats());
    harness.get_by_label("Reload plugins").click();
    harness.run();
    assert_asked(&harness, PluginsIntent::Reload);
    let mut harness = tab(splats());
    harness.get_by_label("Copy all").click();
    harness.run();
    let Some(Intent::Window(WindowIntent::Copy(text))) = harness.state().first() else {
        panic!("{:?}", harness.state())
    };
    for part in [
        "Splats: accepted",
        "/plugins/libsplats.so",
        "Vendor: Somebody",
        "API 1.0",
    ] {
        assert!(text.contains(part), "no '{part}' in\n{text}");
    }
}
