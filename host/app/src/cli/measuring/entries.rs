//! Who is compared: renderers with their settings, looked up and checked.

use std::sync::Arc;

use pointstage_engine::plugins::{PluginInfo, suitability};
use pointstage_engine::stage::{FALLBACK_ID, FrameError, SettingValues, Stage};
use pointstage_plugin_api::settings_schema::{SettingSchema, snapshot};
use pointstage_scene::Scene;

use crate::cli::{Failure, Outcome, drawing, values};

/// The longest name that settings give a file, in characters: what follows fits into every file system's limit.
const LONGEST_LABEL: usize = 100;

/// Stands for every renderer there is.
const ALL: &str = "all";

/// `NAME:SETTING=VALUE:…`, split.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct EntryText {
    /// As it was written.
    text: String,
    name: String,
    settings: Vec<(String, String)>,
}

/// Splits `NAME:SETTING=VALUE:…`.
pub(crate) fn entry_text(text: &str) -> Result<EntryText, String> {
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

impl EntryText {
    /// A renderer with no settings given.
    fn named(name: &str) -> Self {
        Self {
            text: name.to_owned(),
            name: name.to_owned(),
            settings: Vec::new(),
        }
    }

    /// The same with one more setting given.
    pub(crate) fn with(&self, id: &str, value: &str) -> Self {
        let mut with = self.clone();
        with.text = format!("{}:{id}={value}", self.text);
        with.settings.push((id.to_owned(), value.to_owned()));
        with
    }
}

/// A renderer with settings.
#[derive(Debug)]
pub(crate) struct Entry {
    /// Names it in files, the table and the report; no other entry has it.
    pub(crate) label: String,
    /// The renderer's id.
    pub(crate) id: String,
    /// The renderer's version; the program's for the built-in one.
    pub(crate) version: String,
    /// Content hash of the library; none for the built-in one.
    pub(crate) hash: Option<String>,
    /// The values that were given.
    pub(crate) settings: SettingValues,
    /// It was not named, but stands for one of 'all'.
    is_one_of_all: bool,
    /// None for the built-in one.
    info: Option<Arc<PluginInfo>>,
}

impl Entry {
    /// Looks up a renderer and checks its settings.
    pub(crate) fn find(
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
            hash: info.as_ref().map(|info| info.hash.clone()),
            settings: values,
            is_one_of_all: false,
            info,
        })
    }

    /// The settings that it has.
    pub(crate) fn schema(&self) -> &[SettingSchema] {
        drawing::schema(self.info.as_deref())
    }

    /// Every setting's value, given or not.
    pub(crate) fn all_settings(&self) -> Outcome<SettingValues> {
        let schema = drawing::schema(self.info.as_deref());
        snapshot(schema, &self.settings).map_err(Failure::usage_from)
    }

    /// What the scene or the device lacks that the renderer needs; none if it can draw.
    pub(crate) fn reason_against(&self, stage: &Stage, scene: &Scene) -> Option<String> {
        let info = self.info.as_ref()?;
        let device = stage.device().map(|device| &**device);
        suitability(&info.entry.needs, scene, device).reason()
    }

    /// Fails if the scene or the device lacks what the renderer needs.
    pub(crate) fn check_scene(&self, stage: &Stage, scene: &Scene) -> Outcome {
        match (&self.info, self.reason_against(stage, scene)) {
            (Some(info), Some(reason)) => Err(FrameError::Unsuitable {
                renderer: info.entry.alias.clone(),
                reason,
            }
            .into()),
            _ => Ok(()),
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

/// Whether every renderer is asked for.
pub(crate) fn is_all(texts: &[EntryText]) -> bool {
    matches!(texts, [text] if text.text == ALL)
}

/// Looks up all renderers; 'all' stands for every one that is a plugin. Entries that would draw the same are refused.
pub(crate) fn find_all(stage: &Stage, texts: &[EntryText]) -> Outcome<Vec<Entry>> {
    if is_all(texts) {
        let renderers = stage.registry().renderers();
        let entries = renderers.iter().map(|info| {
            let entry = Entry::find(stage, &EntryText::named(&info.entry.alias))?;
            Ok(Entry {
                is_one_of_all: true,
                ..entry
            })
        });
        return entries.collect();
    }
    let mut found: Vec<Entry> = Vec::new();
    for text in texts {
        let mut entry = Entry::find(stage, text)?;
        let settings = entry.all_settings()?;
        for (other, EntryText { text: before, .. }) in found.iter().zip(texts) {
            if other.id == entry.id && other.all_settings()? == settings {
                return Err(Failure::usage(format!(
                    "--renderers: '{before}' and '{}' are one renderer with the same settings; name it once",
                    text.text
                )));
            }
        }
        entry.label = free_label(entry.label, &found);
        found.push(entry);
    }
    Ok(found)
}

/// Nobody can draw what is asked for.
pub(crate) fn nobody_draws() -> Failure {
    Failure::Failed(anyhow::anyhow!(
        "no renderer can draw the scene; 'pointstage plugins list' says which there are and what they need"
    ))
}

/// The renderers that draw the scene. One that was named must be able to; of 'all', those that can are taken.
///
/// * `reference`: is not compared with itself when all are asked for.
pub(crate) fn those_that_draw(
    stage: &Stage,
    entries: Vec<Entry>,
    scene: &Scene,
    reference: Option<&Entry>,
) -> Outcome<Vec<Entry>> {
    let mut drawing = Vec::new();
    for entry in entries {
        let is_reference = reference.is_some_and(|reference| reference.id == entry.id);
        match entry.check_scene(stage, scene) {
            Ok(()) if !(entry.is_one_of_all && is_reference) => drawing.push(entry),
            Err(failure) if !entry.is_one_of_all => return Err(failure),
            _ => {}
        }
    }
    if drawing.is_empty() {
        return Err(nobody_draws());
    }
    Ok(drawing)
}

/// `label`, with a number behind it if another entry has it.
fn free_label(label: String, others: &[Entry]) -> String {
    let is_taken = |label: &str| {
        let same = |other: &Entry| other.label.eq_ignore_ascii_case(label);
        // The reference's files are called so.
        label.eq_ignore_ascii_case("reference") || others.iter().any(same)
    };
    if !is_taken(&label) {
        return label;
    }
    // One number more than there are names that can be taken: the others', and the reference's.
    let mut numbered = (2..=others.len() + 3).map(|number| format!("{label}-{number}"));
    numbered
        .find(|label| !is_taken(label))
        .expect("more numbers than labels are taken")
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
    fn a_label_that_is_taken_gets_a_number() {
        let entry = |label: &str| Entry {
            label: label.to_owned(),
            id: String::new(),
            version: String::new(),
            hash: None,
            settings: SettingValues::new(),
            is_one_of_all: false,
            info: None,
        };
        let others = [entry("a"), entry("A-2"), entry("b")];
        let free = |label: &str| free_label(label.to_owned(), &others);
        assert_eq!(free("c"), "c");
        assert_eq!(free("a"), "a-3");
        assert_eq!(free("Reference"), "Reference-2");
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
