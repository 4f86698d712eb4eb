use super::*;
use crate::settings_schema::{SettingCost, SettingKind, SettingValue};
use serde_json::{Value, json};

/// A manifest of one renderer with `settings`.
fn with_settings(settings: Value) -> Vec<u8> {
    let mut manifest = minimal();
    manifest["plugins"][0]["settings"] = settings;
    manifest.to_string().into_bytes()
}

fn minimal() -> Value {
    json!({ "format": 1, "api": "1.0",
            "plugins": [{ "kind": "renderer", "id": "org.example.dots", "version": "1.0.0" }] })
}

fn message(bytes: &[u8]) -> String {
    Manifest::parse(bytes)
        .expect_err("the manifest is faulty")
        .to_string()
}

#[test]
fn names_fall_back_to_the_id() {
    let manifest = Manifest::parse(minimal().to_string().as_bytes()).expect("minimal");
    let [plugin] = &manifest.plugins[..] else {
        panic!("one plugin")
    };
    assert_eq!(
        (plugin.alias.as_str(), plugin.title.as_str()),
        ("dots", "dots")
    );
    assert_eq!(manifest.api.to_string(), "1.0");
    assert_eq!(plugin.needs, Needs::default());
}

#[test]
fn extensions_of_a_loader_lose_their_dot_and_their_case() {
    let mut manifest = minimal();
    manifest["plugins"][0]["kind"] = json!("loader");
    manifest["plugins"][0]["extensions"] = json!([".PLY", "xyz"]);
    let read = Manifest::parse(manifest.to_string().as_bytes()).expect("a loader");
    assert_eq!(read.plugins[0].extensions, ["ply", "xyz"]);
    for bad in ["", "tar/gz", "*.x"] {
        manifest["plugins"][0]["extensions"] = json!([bad]);
        let said = message(manifest.to_string().as_bytes());
        assert!(
            said.contains("extension") && said.contains("org.example.dots"),
            "{said}"
        );
    }
}

#[test]
fn unknown_fields_kinds_and_setting_kinds_are_ignored() {
    let mut manifest = minimal();
    manifest["colour_of_the_box"] = json!("blue");
    manifest["plugins"][0]["needs"] = json!({ "quantum": true, "normals": true });
    manifest["plugins"][0]["settings"] = json!([
        { "id": "curve", "kind": "spline", "default": { "knots": [] } },
        { "id": "on", "kind": "bool", "default": true, "visible_if": { "id": "curve", "equals": 1 } },
    ]);
    manifest["plugins"]
        .as_array_mut()
        .expect("a list")
        .push(json!({ "kind": "teapot", "id": "org.example.tea", "version": "1" }));
    let manifest = Manifest::parse(manifest.to_string().as_bytes()).expect("newer, but readable");
    assert_eq!(manifest.plugins[1].kind, "teapot");
    assert!(manifest.plugins[0].needs.normals);
    let ids: Vec<_> = manifest.plugins[0]
        .settings
        .iter()
        .map(|s| s.id.as_str())
        .collect();
    assert_eq!(ids, ["on"]);
}

#[test]
fn padding_after_the_json_is_ignored() {
    let mut bytes = minimal().to_string().into_bytes();
    bytes.extend([0; 7]);
    assert!(Manifest::parse(&bytes).is_ok());
    assert!(message(&[0; 4]).contains("not readable"));
}

#[test]
fn targets_are_keys_or_records() {
    let mut manifest = minimal();
    manifest["plugins"][0]["gives"] = json!({ "targets": ["colour",
        { "key": "depth-complexity", "format": "r16float", "clear": [0, 0, 0, 0], "meaning": "layers" }] });
    let manifest = Manifest::parse(manifest.to_string().as_bytes()).expect("both forms");
    let targets = &manifest.plugins[0].gives.targets;
    assert_eq!(targets[0].key, "colour");
    assert_eq!(targets[1].format.as_deref(), Some("r16float"));
}

#[test]
fn every_kind_of_setting_is_read_and_written_back() {
    let settings = json!([
        { "id": "path", "kind": "choice", "default": "auto", "cost": "prepare", "shortcut": "P",
          "options": [{ "id": "auto", "label": "Automatic" }, { "id": "raster" }] },
        { "id": "size", "kind": "float", "default": 2, "min": 0.5, "max": 64, "soft_max": 16, "step": 0.5,
          "unit": "px", "scale": "logarithmic", "group": "Splats",
          "visible_if": { "id": "path", "equals": "raster" } },
        { "id": "levels", "kind": "int", "default": 3, "min": 0,
          "value_shortcuts": [{ "key": "1", "value": 1 }, { "key": "5", "value": 5 }] },
        { "id": "lit", "kind": "bool", "default": false },
        { "id": "tint", "kind": "colour", "default": [1, 0.5, 0] },
        { "id": "note", "kind": "text" },
        { "id": "reset", "kind": "action", "label": "Reset" },
    ]);
    let manifest = Manifest::parse(&with_settings(settings)).expect("all kinds");
    let plugin = &manifest.plugins[0];
    assert_eq!(
        plugin.setting("path").map(|s| s.cost),
        Some(SettingCost::Prepare)
    );
    assert_eq!(
        plugin
            .setting("size")
            .and_then(|s| s.visible_if.clone())
            .map(|v| v.equals),
        Some(SettingValue::Choice("raster".into())),
        "the condition takes the other setting's kind"
    );
    assert_eq!(
        plugin
            .setting("tint")
            .and_then(SettingSchema::default_value),
        Some(SettingValue::Colour([1.0, 0.5, 0.0, 1.0]))
    );
    let keys = plugin.setting("levels").map(|s| &*s.value_shortcuts);
    let five = keys.and_then(|keys| keys.last());
    assert_eq!(
        five.map(|five| (five.key.as_str(), &five.value)),
        Some(("5", &SettingValue::Int(5)))
    );
    assert!(matches!(
        plugin.setting("reset").map(|s| &s.kind),
        Some(SettingKind::Action)
    ));

    let written = serde_json::to_vec(&manifest).expect("plain data");
    assert_eq!(Manifest::parse(&written).expect("its own output"), manifest);
}

#[test]
fn faults_of_the_whole_are_named() {
    let faulty = |field: &str, value: Value| {
        let mut manifest = minimal();
        manifest[field] = value;
        message(manifest.to_string().as_bytes())
    };
    assert!(message(b"{").contains("line 1"), "{}", message(b"{"));
    assert!(faulty("format", json!(2)).contains("update the program"));
    assert!(faulty("format", json!("x")).contains("'format' is missing"));
    assert!(faulty("api", json!("one")).contains("found \"one\""));
    assert!(faulty("plugins", json!([])).contains("no plugins"));
}

#[test]
fn faults_of_a_plugin_name_it() {
    let faulty = |field: &str, value: Value| {
        let mut manifest = minimal();
        manifest["plugins"][0][field] = value;
        message(manifest.to_string().as_bytes())
    };
    assert!(
        faulty("id", json!("dots")).contains("plugin 'dots': the id should be a reverse-domain")
    );
    assert!(faulty("alias", json!("a b")).contains("alias \"a b\""));
    assert!(faulty("version", json!("")).contains("version"));
    assert!(faulty("needs", json!({ "device": "tpu" })).contains("tpu"));
    assert!(faulty("kind", json!(3)).starts_with("manifest, plugin 'org.example.dots'"));
    assert!(faulty("gives", json!({ "targets": ["id", "id"] })).contains("'id' is listed twice"));
    let mut twice = minimal();
    let entry = twice["plugins"][0].clone();
    twice["plugins"].as_array_mut().expect("a list").push(entry);
    assert!(message(twice.to_string().as_bytes()).contains("the id is used twice"));
}

#[test]
fn faults_of_a_setting_name_plugin_setting_and_fault() {
    let cases = [
        (
            json!([{ "id": "a", "kind": "float", "default": 9, "max": 1 }]),
            "9 is outside −∞ … 1",
        ),
        (
            json!([{ "id": "a", "kind": "float" }]),
            "kind 'float' needs 'default'",
        ),
        (
            json!([{ "id": "a", "kind": "int", "default": 1.5 }]),
            "should be a whole number, found 1.5",
        ),
        (
            json!([{ "id": "a", "kind": "int", "default": 1, "min": 3, "max": 2 }]),
            "'min' 3 is above 'max' 2",
        ),
        (
            json!([{ "id": "a", "kind": "int", "default": 1, "step": 0 }]),
            "'step' must be above 0",
        ),
        (
            json!([{ "id": "a", "kind": "float", "default": 1, "scale": "logarithmic" }]),
            "logarithmic",
        ),
        (
            json!([{ "id": "a", "kind": "choice", "default": "x" }]),
            "needs 'options'",
        ),
        (
            json!([{ "id": "a", "kind": "choice", "default": "autp", "options": [{ "id": "auto" }] }]),
            "no option 'autp'; did you mean 'auto'?",
        ),
        (
            json!([{ "id": "a", "kind": "choice", "default": "x", "options": [{ "id": "x" }, { "id": "x" }] }]),
            "option 'x' appears twice",
        ),
        (
            json!([{ "id": "a", "kind": "bool", "default": true }, { "id": "a", "kind": "bool", "default": true }]),
            "used twice",
        ),
        (
            json!([{ "id": "a", "kind": "bool", "default": true, "visible_if": { "id": "aa", "equals": 1 } }]),
            "unknown setting 'aa'; did you mean 'a'?",
        ),
        (
            json!([{ "id": "a", "kind": "bool", "default": true, "visible_if": { "id": "a", "equals": 1 } }]),
            "can never hold",
        ),
        (
            json!([{ "id": "a", "kind": "bool", "default": true, "value_shortcuts": [{ "key": "B", "value": 2 }] }]),
            "'value_shortcuts' gives with 'B' what is not allowed",
        ),
        (
            json!([{ "id": "a b", "kind": "bool", "default": true }]),
            "the id may have only",
        ),
        (
            json!([{ "id": "a", "kind": "colour", "default": [1, 2] }]),
            "3 or 4 numbers",
        ),
        (json!([{ "kind": "bool", "default": true }]), "setting '#1'"),
        (json!([{ "id": "a" }]), "missing field `kind`"),
    ];
    for (settings, expected) in cases {
        let message = message(&with_settings(settings.clone()));
        assert!(
            message.contains("plugin 'org.example.dots', setting '"),
            "{message}"
        );
        assert!(
            message.contains(expected),
            "{settings}: expected '{expected}' in '{message}'"
        );
    }
}
