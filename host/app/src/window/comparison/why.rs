//! Why views differ, in one glance: what their renderers, values and looks do not have in common.

use pointstage_engine::stage::SettingValues;
use pointstage_plugin_api::settings_schema::SettingSchema;

use super::super::legend::title_of;
use super::super::rows::{RendererRow, Rows};
use super::super::session::{Pane, Session};

/// One thing that is not the same in all views.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Row {
    /// What.
    pub(crate) name: String,
    /// How it is in each view; none where there is no such thing.
    pub(crate) values: Vec<Option<String>>,
}

/// Everything that the views do not have in common: renderer and version first, then settings by their names, then what
/// renderers need and give, then the look, the structure and the camera.
pub(crate) fn rows(session: &Session, rows: &Rows) -> Vec<Row> {
    let panes: Vec<&Pane> = session.panes.iter().collect();
    let found: Vec<Option<&RendererRow>> = panes
        .iter()
        .map(|pane| rows.renderer(&pane.renderer))
        .collect();
    let mut all = vec![
        row(
            "Renderer",
            panes
                .iter()
                .map(|pane| Some(rows.title(&pane.renderer).to_owned())),
        ),
        row(
            "Version",
            found.iter().map(|row| Some(row.as_ref()?.version.clone())),
        ),
    ];
    all.extend(settings(&panes, &found));
    all.extend(capabilities(&found));
    let structure = |pane: &&Pane| {
        pane.structure
            .as_deref()
            .map(|id| rows.title(id).to_owned())
    };
    all.push(row("Structure", panes.iter().map(structure)));
    all.extend(structure_settings(&panes, rows));
    all.extend(looks(&panes));
    all.retain(|row| row.values.windows(2).any(|pair| pair[0] != pair[1]));
    all
}

fn row(name: &str, values: impl Iterator<Item = Option<String>>) -> Row {
    Row {
        name: name.to_owned(),
        values: values.collect(),
    }
}

/// Settings of one id, in the order in which the views' renderers have them.
fn settings(panes: &[&Pane], found: &[Option<&RendererRow>]) -> Vec<Row> {
    let schemas: Vec<&[SettingSchema]> = found
        .iter()
        .map(|row| row.map_or(&[][..], |row| row.settings.as_slice()))
        .collect();
    let values: Vec<SettingValues> = panes
        .iter()
        .map(|pane| pane.settings_of(&pane.renderer))
        .collect();
    of_schemas(&schemas, &values)
}

/// The chosen structures' settings.
fn structure_settings(panes: &[&Pane], rows: &Rows) -> Vec<Row> {
    let of_pane = |pane: &&Pane| {
        let id = pane.structure.as_deref()?;
        Some((
            rows.structure(id)?.settings.as_slice(),
            pane.settings_of(id),
        ))
    };
    let found: Vec<(&[SettingSchema], SettingValues)> = panes
        .iter()
        .map(|pane| of_pane(pane).unwrap_or_default())
        .collect();
    let schemas: Vec<&[SettingSchema]> = found.iter().map(|(schema, _)| *schema).collect();
    let values: Vec<SettingValues> = found.iter().map(|(_, values)| values.clone()).collect();
    of_schemas(&schemas, &values)
}

fn of_schemas(schemas: &[&[SettingSchema]], values: &[SettingValues]) -> Vec<Row> {
    let mut known: Vec<&SettingSchema> = Vec::new();
    for setting in schemas.iter().copied().flatten() {
        let is_action = setting.default_value().is_none();
        if !is_action && known.iter().all(|other| other.id != setting.id) {
            known.push(setting);
        }
    }
    let value = |id: &str, index: usize| {
        let schema = schemas[index].iter().find(|setting| setting.id == id)?;
        let value = values[index].get(id).cloned();
        Some(value.or_else(|| schema.default_value())?.to_string())
    };
    let rows = known.into_iter().map(|setting| Row {
        name: setting.label.clone(),
        values: (0..schemas.len())
            .map(|index| value(&setting.id, index))
            .collect(),
    });
    rows.collect()
}

/// What renderers draw with, need and give.
fn capabilities(found: &[Option<&RendererRow>]) -> Vec<Row> {
    let of = |name: &str, text: &dyn Fn(&RendererRow) -> String| {
        row(name, found.iter().map(|row| Some(text(row.as_ref()?))))
    };
    let yes_no = |yes: bool| if yes { "yes" } else { "no" }.to_owned();
    vec![
        of("Writes", &|row| {
            let targets = row.gives.targets.iter();
            let keys: Vec<&str> = targets.map(|target| target.key.as_str()).collect();
            keys.join(", ")
        }),
        of("Refines while still", &|row| yes_no(row.gives.progressive)),
        of("Partly covers pixels", &|row| {
            yes_no(row.gives.transparency)
        }),
        of("Own level of detail", &|row| {
            yes_no(row.gives.own_level_of_detail)
        }),
        of("Needs", &|row| row.needs.clone()),
    ]
}

/// How the pictures are shown.
fn looks(panes: &[&Pane]) -> Vec<Row> {
    let of = |name: &str, text: &dyn Fn(&Pane) -> String| {
        row(name, panes.iter().map(|pane| Some(text(pane))))
    };
    let mut rows = vec![
        of("Shows", &|pane| title_of(&pane.view.show)),
        of("Background", &|pane| format!("{:?}", pane.view.background)),
        of("Exposure", &|pane| pane.view.exposure.to_string()),
        of("Radius scale", &|pane| pane.view.radius_scale.to_string()),
    ];
    // Numbers would say little here; that they differ is what counts.
    let word = |is_same: bool| if is_same { "as in view 1" } else { "its own" }.to_owned();
    if let Some(first) = panes.first() {
        rows.push(of("Lights", &|pane| word(pane.lights == first.lights)));
        rows.push(of("Camera", &|pane| word(pane.camera == first.camera)));
    }
    rows
}

#[cfg(test)]
mod tests {
    use pointstage_engine::stage::SettingValue;
    use pointstage_plugin_api::manifest::Manifest;

    use super::*;

    fn rows_of(manifest: &str) -> Rows {
        let manifest = Manifest::parse(manifest.as_bytes()).expect("a manifest");
        let entries = manifest.plugins.iter();
        Rows {
            renderers: entries.map(RendererRow::of).collect(),
            ..Rows::default()
        }
    }

    #[test]
    fn only_what_differs_is_listed_with_defaults_and_gaps() {
        let found = rows_of(
            r#"{ "format": 1, "vendor": "x", "licence": "x", "api": "1.0", "plugins": [
            { "kind": "renderer", "id": "x.a", "title": "A", "version": "1.0.0",
              "settings": [{ "id": "scale", "kind": "float", "default": 1.0, "min": 0.0, "max": 4.0, "label": "Scale" }] },
            { "kind": "renderer", "id": "x.b", "title": "B", "version": "1.0.0", "gives": { "progressive": true },
              "settings": [{ "id": "scale", "kind": "float", "default": 1.0, "min": 0.0, "max": 4.0, "label": "Scale" },
                           { "id": "soft", "kind": "bool", "default": true, "label": "Soft" }] }
        ] }"#,
        );
        let mut session = Session::new("x.a".to_owned());
        session.panes.push(Pane::new("x.a".to_owned()));
        assert_eq!(rows(&session, &found), [], "the same renderer twice");
        let second = session.panes.get_mut(1).expect("it is there");
        let values = second.settings.entry("x.a".to_owned()).or_default();
        values.insert("scale".to_owned(), SettingValue::Float(2.0));
        let listed = rows(&session, &found);
        assert_eq!(listed.len(), 1, "{listed:?}");
        assert_eq!(listed[0].name, "Scale");
        assert_eq!(
            listed[0].values,
            [Some("1".to_owned()), Some("2".to_owned())]
        );
        let second = session.panes.get_mut(1).expect("it is there");
        second.renderer = "x.b".to_owned();
        second.view.exposure = 2.0;
        second.camera.dolly(0.3);
        let listed = rows(&session, &found);
        let names: Vec<&str> = listed.iter().map(|row| row.name.as_str()).collect();
        let expected = [
            "Renderer",
            "Soft",
            "Refines while still",
            "Exposure",
            "Camera",
        ];
        assert_eq!(names, expected);
        assert_eq!(listed[1].values, [None, Some("true".to_owned())]);
    }
}
