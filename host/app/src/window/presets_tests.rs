use super::*;
use crate::window::test_schema::schema_of;

const OWNER: &str = "org.example.splats";

fn values(scale: f64) -> SettingValues {
    SettingValues::from([("scale".to_owned(), SettingValue::Float(scale))])
}

fn session(values: SettingValues) -> Session {
    let mut session = Session::new(OWNER.to_owned());
    session
        .panes
        .active
        .settings
        .insert(OWNER.to_owned(), values);
    session
}

/// Active preset, and whether the values differ from it.
fn active(session: &Session) -> (String, bool) {
    let list = list(session, OWNER);
    (list.active, list.differs)
}

#[test]
fn a_saved_preset_is_active_until_values_differ_from_it() {
    let mut session = session(values(2.0));
    assert_eq!(active(&session), (DEFAULTS.into(), true));
    save(&mut session, OWNER, " Soft ").expect("a name");
    assert_eq!(active(&session), ("Soft".into(), false));
    session
        .panes
        .active
        .settings
        .insert(OWNER.into(), values(3.0));
    assert_eq!(active(&session), ("Soft".into(), true));
    save(&mut session, OWNER, "Soft").expect("a name");
    assert_eq!(active(&session), ("Soft".into(), false), "overwritten");
    assert_eq!(list(&session, OWNER).names, ["Soft"]);
    choose(&mut session, OWNER, DEFAULTS, &[]);
    assert_eq!(active(&session), (DEFAULTS.into(), false));
    assert_eq!(session.settings_of(OWNER), SettingValues::new());
}

#[test]
fn a_chosen_preset_brings_what_the_schema_still_takes() {
    let mut session = session(values(2.0));
    let old = [("gone".to_owned(), SettingValue::Bool(true))];
    session
        .panes
        .active
        .settings
        .entry(OWNER.into())
        .or_default()
        .extend(old);
    save(&mut session, OWNER, "Old").expect("a name");
    let schema = schema_of(
        r#"{ "id": "scale", "kind": "float", "default": 1, "max": 1.5, "label": "Scale" }"#,
    );
    let refused = choose(&mut session, OWNER, "Old", &schema);
    assert_eq!(refused.len(), 1, "{refused:?}");
    assert_eq!(session.settings_of(OWNER), SettingValues::new());
    assert_eq!(active(&session), ("Old".into(), true));
}

#[test]
fn after_a_start_the_preset_with_the_present_values_is_active() {
    let mut session = session(values(2.0));
    save(&mut session, OWNER, "Soft").expect("a name");
    session.panes.active.active_presets.clear();
    assert_eq!(active(&session), ("Soft".into(), false));
}

#[test]
fn names_that_are_none_are_refused_with_the_reason() {
    let mut session = session(values(1.5));
    let mut save = |name: &str| save(&mut session, OWNER, name);
    assert_eq!(save("  "), Err(PresetNameError::Empty));
    assert_eq!(save("defaults"), Err(PresetNameError::BuiltIn));
    assert_eq!(save(&"é".repeat(61)), Err(PresetNameError::Long(61)));
    assert_eq!(save(&"é".repeat(60)), Ok(()));
}

#[test]
fn a_renamed_preset_stays_active_and_takes_no_other_away() {
    let mut session = session(values(1.0));
    save(&mut session, OWNER, "a").expect("a name");
    session
        .panes
        .active
        .settings
        .insert(OWNER.into(), values(2.0));
    save(&mut session, OWNER, "b").expect("a name");
    assert_eq!(
        rename(&mut session, OWNER, "b", "a"),
        Err(PresetNameError::Taken("a".into()))
    );
    assert_eq!(rename(&mut session, OWNER, "b", "c"), Ok(()));
    assert_eq!(active(&session), ("c".into(), false));
    delete(&mut session, OWNER, "c");
    assert_eq!(active(&session), (DEFAULTS.into(), true));
    delete(&mut session, OWNER, "a");
    assert_eq!(session.presets, Presets::new(), "nothing is left behind");
}

#[test]
fn copying_takes_what_fits_and_says_what_does_not() {
    let from = schema_of(
        r#"{ "id": "scale", "kind": "float", "default": 5, "label": "Scale" },
           { "id": "passes", "kind": "float", "default": 2.5, "label": "Passes" },
           { "id": "shape", "kind": "choice", "default": "hexagon", "options": [{ "id": "hexagon" }] },
           { "id": "cull", "kind": "bool", "default": true, "label": "Hide backs" },
           { "id": "alone", "kind": "bool", "default": true }"#,
    );
    let to = schema_of(
        r#"{ "id": "scale", "kind": "float", "default": 1, "max": 10, "label": "Splat scale" },
           { "id": "passes", "kind": "int", "default": 1, "label": "Passes" },
           { "id": "shape", "kind": "choice", "default": "round", "options": [{ "id": "round" }] },
           { "id": "cull", "kind": "bool", "default": true, "label": "Hide backs" }"#,
    );
    let fitted = fit(&shared_values(&from, &SettingValues::new(), &to), &to);
    assert_eq!(fitted.values, values(5.0), "a default needs no entry");
    assert_eq!(fitted.taken, ["scale", "cull"]);
    assert_eq!(fitted.refused.len(), 2, "{:?}", fitted.refused);
    assert!(
        fitted.refused[1].contains("no option 'hexagon'"),
        "{:?}",
        fitted.refused
    );
}
