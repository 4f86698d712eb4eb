//! What views share: cameras while they are linked, and under the fair-compare lock everything that is not the renderer's own.

use pointstage_engine::stage::{FALLBACK_ID, SettingValue, SettingValues};
use pointstage_plugin_api::settings_schema::{SettingSchema, snapshot};

use super::super::rows::{RendererRow, Rows};
use super::super::session::{Pane, Session};

/// The setting that says how many samples a pixel a renderer takes, by convention.
const SAMPLES: &str = "samples";

/// Something that the lock asks for and a view's renderer does not follow.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Unmet(pub(crate) String);

/// Gives the other views what they share with the active one.
pub(crate) fn share(session: &mut Session, rows: &Rows) {
    let (is_linked, is_locked) = (session.comparison.is_linked, session.comparison.is_locked);
    if is_locked {
        session.comparison.split = [0.5; 2];
    }
    let samples = is_locked.then(|| shared_samples(session, rows)).flatten();
    let (active, others) = session.panes.others_beside_active();
    for pane in others {
        if is_linked {
            pane.camera = active.camera;
            pane.near = active.near;
        }
        if is_locked {
            pane.lights.clone_from(&active.lights);
            pane.view.clone_from(&active.view);
            share_structure(pane, active);
        }
    }
    let Some(samples) = samples else { return };
    for pane in session.panes.iter_mut() {
        set_samples(pane, rows, samples);
    }
}

/// The structure decides which surfels are drawn: under the lock all draw the same ones.
fn share_structure(pane: &mut Pane, active: &Pane) {
    pane.structure.clone_from(&active.structure);
    if let Some(structure) = &active.structure {
        match active.settings.get(structure) {
            Some(values) => pane.settings.insert(structure.clone(), values.clone()),
            None => pane.settings.remove(structure),
        };
    }
}

/// The number that all take: that of the active view if its renderer can choose, else that of the first that can.
fn shared_samples(session: &Session, rows: &Rows) -> Option<i64> {
    let own = samples_of(&session.panes.active, rows);
    own.or_else(|| {
        let mut panes = session.panes.iter();
        panes.find_map(|pane| samples_of(pane, rows))
    })
}

/// How many samples a pixel a view takes, if its renderer can choose.
fn samples_of(pane: &Pane, rows: &Rows) -> Option<i64> {
    let schema = samples_schema(pane, rows)?;
    let value = pane
        .settings
        .get(&pane.renderer)
        .and_then(|values| values.get(SAMPLES).cloned())
        .or_else(|| schema.default_value());
    match value {
        Some(SettingValue::Int(samples)) => Some(samples),
        _ => None,
    }
}

fn samples_schema<'a>(pane: &Pane, rows: &'a Rows) -> Option<&'a SettingSchema> {
    let row = rows.renderer(&pane.renderer)?;
    row.settings.iter().find(|setting| setting.id == SAMPLES)
}

fn set_samples(pane: &mut Pane, rows: &Rows, samples: i64) {
    let Some(schema) = samples_schema(pane, rows) else {
        return;
    };
    // One whose range ends before takes what it has; what it draws with is told below the view.
    let Ok(value) = schema.check(&SettingValue::Int(samples)) else {
        return;
    };
    let is_default = schema.default_value().as_ref() == Some(&value);
    let values = pane.settings.entry(pane.renderer.clone()).or_default();
    if is_default {
        values.remove(SAMPLES);
    } else {
        values.insert(SAMPLES.to_owned(), value);
    }
}

/// What of the lock the renderer of a view does not follow.
pub(crate) fn unmet(session: &Session, rows: &Rows, index: usize) -> Vec<Unmet> {
    let Some(pane) = session.panes.get(index) else {
        return Vec::new();
    };
    if !session.comparison.is_locked {
        return Vec::new();
    }
    let Some(row) = rows.renderer(&pane.renderer) else {
        return Vec::new();
    };
    let mut unmet = Vec::new();
    let mut note = |is_unmet: bool, text: String| {
        if is_unmet {
            unmet.push(Unmet(text));
        }
    };
    let values = complete(row, &pane.settings_of(&pane.renderer));
    note(
        row.gives.ignores("lights", &values),
        "shades without the lights".to_owned(),
    );
    note(
        row.gives.ignores("radius_scale", &values) && pane.view.radius_scale != 1.0,
        format!(
            "does not follow the radius scale of {}",
            pane.view.radius_scale
        ),
    );
    note(
        (row.gives.own_level_of_detail || row.id == FALLBACK_ID) && pane.structure.is_some(),
        "draws a choice of its own, not the structure's".to_owned(),
    );
    let wanted = shared_samples(session, rows).unwrap_or(1);
    let taken = samples_of(pane, rows).unwrap_or(1);
    note(
        taken != wanted,
        format!(
            "takes {taken} sample{} a pixel, not {wanted}",
            if taken == 1 { "" } else { "s" }
        ),
    );
    unmet
}

/// Values with defaults for those that are absent.
fn complete(row: &RendererRow, values: &SettingValues) -> SettingValues {
    // Values that a build does not know any more are refused as a whole; its pictures are drawn with defaults then.
    snapshot(&row.settings, values)
        .or_else(|_| snapshot(&row.settings, &SettingValues::new()))
        .unwrap_or_default()
}

#[cfg(test)]
#[path = "lock_tests.rs"]
mod tests;
