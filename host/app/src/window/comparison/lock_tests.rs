use pointstage_engine::stage::{Background, Show};
use pointstage_plugin_api::manifest::Manifest;

use super::*;

/// Rows of three renderers: `plain` follows everything, `fixed` no radii and no lights, `fine` chooses its samples.
fn rows() -> Rows {
    let manifest = r#"{ "format": 1, "vendor": "x", "licence": "x", "api": "1.0", "plugins": [
        { "kind": "renderer", "id": "x.plain", "version": "1.0.0" },
        { "kind": "renderer", "id": "x.fixed", "version": "1.0.0",
          "gives": { "own_level_of_detail": true, "ignores": ["lights", { "what": "radius_scale",
                     "when": { "id": "mode", "equals": "fixed" } }] },
          "settings": [{ "id": "mode", "kind": "choice", "default": "fixed", "label": "Mode",
                         "options": [{ "id": "fixed", "label": "f" }, { "id": "free", "label": "g" }] }] },
        { "kind": "renderer", "id": "x.fine", "version": "1.0.0",
          "settings": [{ "id": "samples", "kind": "int", "default": 1, "min": 1, "max": 16, "label": "Samples" }] }
    ] }"#;
    let manifest = Manifest::parse(manifest.as_bytes()).expect("a manifest");
    Rows {
        renderers: manifest.plugins.iter().map(RendererRow::of).collect(),
        ..Rows::default()
    }
}

fn session(renderers: &[&str]) -> Session {
    let mut session = Session::new(renderers[0].to_owned());
    for renderer in &renderers[1..] {
        session.panes.push(Pane::new((*renderer).to_owned()));
    }
    session
}

/// What `change` does to the active view reaches the other one under the lock, and only then.
fn is_shared_by_lock_alone(change: impl Fn(&mut Session), seen: impl Fn(&Pane) -> String) {
    for is_locked in [false, true] {
        let mut session = session(&["x.plain", "x.fine"]);
        session.comparison.is_locked = is_locked;
        let before = session.panes.get(1).map(&seen);
        change(&mut session);
        share(&mut session, &rows());
        let active = seen(&session.panes.active);
        let other = session.panes.get(1).map(&seen);
        if is_locked {
            assert_eq!(other, Some(active));
        } else {
            assert_eq!(other, before);
            assert_ne!(other, Some(active));
        }
    }
}

#[test]
fn every_locked_quantity_follows_the_active_view() {
    is_shared_by_lock_alone(
        |session| session.panes.active.view.background = Background::Solid([0.1, 0.2, 0.3]),
        |pane| format!("{:?}", pane.view.background),
    );
    is_shared_by_lock_alone(
        |session| session.panes.active.view.exposure = 2.0,
        |pane| pane.view.exposure.to_string(),
    );
    is_shared_by_lock_alone(
        |session| session.panes.active.view.radius_scale = 0.5,
        |pane| pane.view.radius_scale.to_string(),
    );
    is_shared_by_lock_alone(
        |session| session.panes.active.view.show = Show::Target("depth".to_owned()),
        |pane| format!("{:?}", pane.view.show),
    );
    is_shared_by_lock_alone(
        |session| session.panes.active.lights.ambient *= 0.5,
        |pane| format!("{:?}", pane.lights),
    );
    is_shared_by_lock_alone(
        |session| {
            let pane = &mut session.panes.active;
            pane.structure = Some("x.tree".to_owned());
            let values = pane.settings.entry("x.tree".to_owned()).or_default();
            values.insert("error".to_owned(), SettingValue::Float(2.0));
        },
        |pane| format!("{:?} {:?}", pane.structure, pane.settings.get("x.tree")),
    );
}

#[test]
fn the_lock_makes_views_of_one_size() {
    let mut session = session(&["x.plain", "x.fine"]);
    session.comparison.split = [0.3, 0.8];
    share(&mut session, &rows());
    assert_eq!(session.comparison.split, [0.3, 0.8]);
    session.comparison.is_locked = true;
    share(&mut session, &rows());
    assert_eq!(session.comparison.split, [0.5, 0.5]);
}

#[test]
fn samples_are_those_of_whoever_can_choose() {
    let mut session = session(&["x.plain", "x.fine", "x.fine"]);
    session.comparison.is_locked = true;
    let samples = |session: &Session, index: usize| {
        let pane = session.panes.get(index).expect("a view");
        samples_of(pane, &rows())
    };
    let fine = session.panes.get_mut(1).expect("a view");
    let values = fine.settings.entry("x.fine".to_owned()).or_default();
    values.insert(SAMPLES.to_owned(), SettingValue::Int(8));
    share(&mut session, &rows());
    assert_eq!(
        [0, 1, 2].map(|view| samples(&session, view)),
        [None, Some(8), Some(8)]
    );
    let sentences = unmet(&session, &rows(), 0);
    assert_eq!(
        sentences,
        [Unmet("takes 1 sample a pixel, not 8".to_owned())]
    );
    assert_eq!(unmet(&session, &rows(), 1), []);
}

#[test]
fn what_a_renderer_does_not_follow_is_told_while_it_matters() {
    let mut session = session(&["x.fixed", "x.plain"]);
    let told = |session: &Session| -> Vec<String> {
        let unmet = unmet(session, &rows(), 0);
        unmet.into_iter().map(|Unmet(text)| text).collect()
    };
    assert_eq!(
        told(&session),
        [""; 0],
        "without the lock everybody is free"
    );
    session.comparison.is_locked = true;
    assert_eq!(told(&session), ["shades without the lights"]);
    session.panes.active.view.radius_scale = 2.0;
    assert_eq!(told(&session).len(), 2);
    let values = session.panes.active.settings.entry("x.fixed".to_owned());
    let free = SettingValue::Choice("free".to_owned());
    values.or_default().insert("mode".to_owned(), free);
    assert_eq!(
        told(&session),
        ["shades without the lights"],
        "in this mode it follows"
    );
    session.panes.active.structure = Some("x.tree".to_owned());
    assert!(told(&session).iter().any(|text| text.contains("structure")));
    assert_eq!(unmet(&session, &rows(), 1), []);
}

#[test]
fn linked_cameras_are_one_and_free_ones_are_not() {
    let mut session = session(&["x.plain", "x.fine"]);
    session.panes.active.camera.dolly(0.5);
    session.comparison.is_linked = false;
    share(&mut session, &rows());
    let cameras =
        |session: &Session| -> Vec<_> { session.panes.iter().map(|pane| pane.camera).collect() };
    let [own, other] = cameras(&session)[..] else {
        panic!("two views")
    };
    assert_ne!(own, other);
    session.comparison.is_linked = true;
    share(&mut session, &rows());
    let [own, other] = cameras(&session)[..] else {
        panic!("two views")
    };
    assert_eq!(own, other);
}
