//! Values over time, and tracks that do not fit.

use super::*;
use pointstage_plugin_api::manifest::Manifest;
use proptest::prelude::*;

fn schema() -> Vec<SettingSchema> {
    let manifest = r#"{ "format": 1, "vendor": "Test", "licence": "MIT", "api": "1.0", "plugins": [{
        "kind": "renderer", "id": "org.example.dots", "version": "1.0.0",
        "needs": {}, "gives": { "targets": ["colour"] }, "settings": [
        { "id": "size", "kind": "float", "default": 1, "min": 0, "max": 100 },
        { "id": "scale", "kind": "float", "default": 1, "min": 0.01, "max": 100, "scale": "logarithmic" },
        { "id": "passes", "kind": "int", "default": 2, "min": 1, "max": 64 },
        { "id": "cull", "kind": "bool", "default": true },
        { "id": "tint", "kind": "colour", "default": [1, 1, 1, 1] },
        { "id": "mode", "kind": "choice", "default": "round", "options": [{ "id": "round" }, { "id": "square" }] },
        { "id": "rebuild", "kind": "action" } ] }] }"#;
    let manifest = Manifest::parse(manifest.as_bytes()).expect("the test's manifest is right");
    manifest.plugins[0].settings.clone()
}

fn track(setting: &str, keys: &[(f64, SettingValue)]) -> SettingTrack {
    let keys = keys.iter().map(|(time, value)| TrackKey {
        time: *time,
        value: value.clone(),
    });
    SettingTrack {
        owner: String::new(),
        setting: setting.to_owned(),
        keys: keys.collect(),
    }
}

fn resolved(tracks: &[SettingTrack]) -> Result<(Vec<Track>, Vec<String>), TrackError> {
    let schema = schema();
    let dots = Drawer {
        id: "org.example.dots",
        alias: "dots",
        schema: &schema,
        is_structure: false,
    };
    let structure = Drawer {
        id: "org.example.tree",
        alias: "tree",
        schema: &schema[..1],
        is_structure: true,
    };
    resolve(tracks, &[dots, structure])
}

fn value(setting: &str, keys: &[(f64, SettingValue)], time: f64) -> SettingValue {
    let (tracks, _) = resolved(&[track(setting, keys)]).expect("fits");
    values_at(&tracks, time).renderer[setting].clone()
}

#[test]
fn numbers_go_evenly_and_what_has_no_values_between_changes_at_its_key() {
    use SettingValue::{Bool, Choice, Colour, Float, Int};
    let cases = [
        ("size", Float(1.0), Float(3.0), Float(1.5), Float(2.0)),
        // A file does not tell whole floats from integers.
        ("size", Int(1), Int(3), Float(1.5), Float(2.0)),
        ("scale", Float(1.0), Float(16.0), Float(2.0), Float(4.0)),
        ("passes", Int(1), Int(4), Int(2), Int(3)),
        ("cull", Bool(true), Bool(false), Bool(true), Bool(true)),
        (
            "mode",
            Choice("square".into()),
            Choice("round".into()),
            Choice("square".into()),
            Choice("square".into()),
        ),
        (
            "tint",
            Colour([0.0, 1.0, 0.0, 1.0]),
            Colour([1.0, 0.0, 0.0, 1.0]),
            Colour([0.25, 0.75, 0.0, 1.0]),
            Colour([0.5, 0.5, 0.0, 1.0]),
        ),
    ];
    for (setting, from, to, quarter, half) in cases {
        let keys = [(1.0, from.clone()), (5.0, to.clone())];
        assert_eq!(value(setting, &keys, 2.0), quarter, "{setting}");
        assert_eq!(value(setting, &keys, 3.0), half, "{setting}");
        let same = |a: SettingValue, b: &SettingValue| a.to_string() == b.to_string();
        assert!(same(value(setting, &keys, 0.0), &from), "{setting} before");
        assert!(
            same(value(setting, &keys, 1.0), &from),
            "{setting} at the key"
        );
        assert!(
            same(value(setting, &keys, 5.0), &to),
            "{setting} at the key"
        );
        assert!(same(value(setting, &keys, 9.0), &to), "{setting} behind");
    }
}

#[test]
fn what_does_not_fit_names_track_setting_and_value() {
    use SettingValue::Float;
    let good = track("size", &[(0.0, Float(1.0))]);
    for (bad, expected) in [
        (
            track("siez", &[(0.0, Float(1.0))]),
            "track 2 ('siez'): no setting 'siez'; did you mean 'size'?",
        ),
        (
            track("size", &[(0.0, Float(1.0)), (1.0, Float(200.0))]),
            "track 2 ('size'), value 2: setting 'size': 200 is outside",
        ),
        (
            track("mode", &[(0.0, SettingValue::Text("rund".into()))]),
            "no option 'rund'; did you mean 'round'?",
        ),
        (track("rebuild", &[(0.0, Float(1.0))]), "is an action"),
    ] {
        let error = resolved(&[good.clone(), bad])
            .expect_err(expected)
            .to_string();
        assert!(error.contains(expected), "{error}");
    }
}

#[test]
fn tracks_go_to_their_owners() {
    let of = |owner: &str| SettingTrack {
        owner: owner.to_owned(),
        ..track("size", &[(0.0, SettingValue::Float(7.0))])
    };
    let tracks = [of("tree"), of("org.example.gone"), of("org.example.gone")];
    let (found, strangers) = resolved(&tracks).expect("fits");
    let values = values_at(&found, 0.0);
    assert!(values.renderer.is_empty(), "{values:?}");
    assert_eq!(values.structure["size"], SettingValue::Float(7.0));
    assert_eq!(strangers, ["org.example.gone"]);
}

proptest! {
    #[test]
    fn a_value_is_always_one_that_the_setting_takes(
        from in 0.01..100.0f64, to in 0.01..100.0f64, whole in [1i64..65, 1i64..65], part in -0.5..1.5f64,
    ) {
        let schema = schema();
        for (setting, keys) in [
            ("scale", [(0.0, SettingValue::Float(from)), (1.0, SettingValue::Float(to))]),
            ("size", [(0.0, SettingValue::Float(from)), (1.0, SettingValue::Float(to))]),
            ("passes", [(0.0, SettingValue::Int(whole[0])), (1.0, SettingValue::Int(whole[1]))]),
        ] {
            let value = value(setting, &keys, part);
            let schema = schema.iter().find(|other| other.id == setting).expect("there");
            prop_assert_eq!(schema.check(&value), Ok(value));
        }
    }
}
