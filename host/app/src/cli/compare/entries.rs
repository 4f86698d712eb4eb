//! Who is compared: renderers with their settings, looked up and checked.

use std::sync::Arc;

use pointstage_engine::plugins::{PluginInfo, suitability};
use pointstage_engine::stage::{FALLBACK_ID, FrameError, SettingValues, Stage};
use pointstage_plugin_api::settings_schema::snapshot;
use pointstage_plugin_api::targets;
use pointstage_scene::Scene;

use crate::cli::{Failure, Outcome, drawing, values};

/// The longest name that settings give a file, in characters: what follows fits into every file system's limit.
const LONGEST_LABEL: usize = 100;

/// `NAME:SETTING=VALUE:…`, split.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct EntryText {
    /// As it was written.
    text: String,
    name: String,
    settings: Vec<(String, String)>,
}

/// Splits `NAME:SETTING=VALUE:…`.
pub(super) fn entry_text(text: &str) -> Result<EntryText, String> {
    let mut parts = text.trim().split(':');
    let name = parts.next().unwrap_or_default().trim();
    if name.is_empty() {
        return Err(
            "expected a renderer's name, or NAME:SETTING=VALUE, such as hqss:filter=false"
                .to_owned(),
        );
    }
    Ok(EntryText {
        text: text.trim().to_owned(),
        name: name.to_owned(),
        settings: parts
            .map(values::assignment)
            .collect::<Result<Vec<_>, _>>()?,
    })
}

/// A renderer with settings.
#[derive(Debug)]
pub(super) struct Entry {
    /// Names it in files, the table and the report; no other entry has it.
    pub(super) label: String,
    /// The renderer's id.
    pub(super) id: String,
    /// The renderer's version; the program's for the built-in one.
    pub(super) version: String,
    /// The values that were given.
    pub(super) settings: SettingValues,
    /// None for the built-in one.
    info: Option<Arc<PluginInfo>>,
}

impl Entry {
    /// Looks up a renderer and checks its settings.
    fn find(
        stage: &Stage,
        EntryText {
            text,
            name,
            settings,
        }: &EntryText,
    ) -> Outcome<Self> {
        let info = drawing::find_renderer(&stage.registry(), name)?;
        let schema = drawing::schema(info.as_deref());
        let mut values = SettingValues::new();
        drawing::set_values(&mut values, schema, settings).map_err(|error| {
            Failure::Usage(anyhow::Error::new(error).context(format!("renderer '{text}'")))
        })?;
        let (alias, id, version) = match &info {
            Some(info) => (&*info.entry.alias, &*info.id, &*info.entry.version),
            None => ("fallback", FALLBACK_ID, env!("CARGO_PKG_VERSION")),
        };
        Ok(Self {
            label: label(alias, &values),
            id: id.to_owned(),
            version: version.to_owned(),
            settings: values,
            info,
        })
    }

    /// Every setting's value, given or not.
    fn all_settings(&self) -> Outcome<SettingValues> {
        let schema = drawing::schema(self.info.as_deref());
        snapshot(schema, &self.settings).map_err(Failure::usage_from)
    }

    /// Fails if the scene or the device lacks what the renderer needs.
    fn check_scene(&self, stage: &Stage, scene: &Scene) -> Outcome {
        let Some(info) = &self.info else {
            return Ok(());
        };
        let device = stage.device().map(|device| &**device);
        match suitability(&info.entry.needs, scene, device).reason() {
            Some(reason) => Err(FrameError::Unsuitable {
                renderer: info.entry.alias.clone(),
                reason,
            }
            .into()),
            None => Ok(()),
        }
    }
}

/// A label that any file system takes: the alias, then the settings.
fn label(alias: &str, settings: &SettingValues) -> String {
    let settings = settings.iter().map(|(id, value)| format!("-{id}-{value}"));
    let parts: Vec<String> = std::iter::once(alias.to_owned()).chain(settings).collect();
    let safe = parts
        .iter()
        .flat_map(|part| part.chars())
        .map(|letter| match letter {
            'a'..='z' | 'A'..='Z' | '0'..='9' | '.' | '_' => letter,
            _ => '-',
        });
    safe.take(LONGEST_LABEL).collect()
}

/// Everybody who draws.
#[derive(Debug)]
pub(super) struct Entries {
    /// Whom the others are measured by.
    pub(super) reference: Entry,
    /// Key of the reference's target that says what it covers.
    pub(super) silhouette: &'static str,
    /// The others.
    pub(super) renderers: Vec<Entry>,
}

impl Entries {
    /// Looks all of them up. Entries that would draw the same are refused.
    pub(super) fn find(
        stage: &Stage,
        reference: &EntryText,
        renderers: &[EntryText],
    ) -> Outcome<Self> {
        let reference = Entry::find(stage, reference)?;
        let silhouette = silhouette_target(stage, &reference)?;
        let mut found: Vec<Entry> = Vec::new();
        for (index, text) in renderers.iter().enumerate() {
            let mut entry = Entry::find(stage, text)?;
            let settings = entry.all_settings()?;
            for (other, EntryText { text: before, .. }) in found.iter().zip(renderers) {
                if other.id == entry.id && other.all_settings()? == settings {
                    return Err(Failure::usage(format!(
                        "--renderers: '{before}' and '{}' are one renderer with the same settings; name it once",
                        text.text
                    )));
                }
            }
            let taken = |label: &str| {
                let same = |other: &Entry| other.label.eq_ignore_ascii_case(label);
                // The reference's files are called so.
                label.eq_ignore_ascii_case("reference") || found.iter().any(same)
            };
            if taken(&entry.label) {
                // As many as there are entries before, and one for the word above.
                let numbered = (2..=index + 3).map(|number| format!("{}-{number}", entry.label));
                entry.label = numbered
                    .into_iter()
                    .find(|label| !taken(label))
                    .expect("more numbers than labels are taken");
            }
            found.push(entry);
        }
        Ok(Self {
            reference,
            silhouette,
            renderers: found,
        })
    }

    /// Fails if one of them cannot draw the scene.
    pub(super) fn check_scene(&self, stage: &Stage, scene: &Scene) -> Outcome {
        let mut all = std::iter::once(&self.reference).chain(&self.renderers);
        all.try_for_each(|entry| entry.check_scene(stage, scene))
    }
}

/// The target that says which pixels the reference covers.
fn silhouette_target(stage: &Stage, reference: &Entry) -> Outcome<&'static str> {
    let given = stage
        .given_targets(&reference.id)
        .map_err(Failure::usage_from)?;
    let is_given = |key: &&str| given.iter().any(|spec| spec.key == *key);
    let found = [targets::ID, targets::DEPTH].into_iter().find(is_given);
    found.ok_or_else(|| {
        Failure::usage(format!(
            "renderer '{}' writes neither '{}' nor '{}', which say what a reference covers; choose another reference",
            reference.label,
            targets::ID,
            targets::DEPTH
        ))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use pointstage_engine::stage::SettingValue;

    #[test]
    fn an_entry_is_a_name_and_settings() {
        let entry = entry_text(" hqss:filter=false:sigma=0.5 ").expect("well formed");
        assert_eq!(entry.name, "hqss");
        let pairs = [("filter", "false"), ("sigma", "0.5")];
        assert_eq!(
            entry.settings,
            pairs.map(|(id, value)| (id.to_owned(), value.to_owned()))
        );
        for (bad, expected) in [
            ("", "expected a renderer's name"),
            (":a=b", "expected a renderer's name"),
            ("hqss:filter", "expected id=value"),
        ] {
            let error = entry_text(bad).expect_err(bad);
            assert!(error.contains(expected), "{bad}: {error}");
        }
    }

    #[test]
    fn labels_are_safe_in_file_names() {
        let settings = SettingValues::from([
            ("a".to_owned(), SettingValue::Text("../b c/ü".to_owned())),
            ("size".to_owned(), SettingValue::Float(1.5)),
        ]);
        assert_eq!(label("hqss", &settings), "hqss-a-..-b-c---size-1.5");
        let long = SettingValues::from([("t".to_owned(), SettingValue::Text("x".repeat(999)))]);
        assert_eq!(label("hqss", &long).len(), LONGEST_LABEL);
    }
}
