//! The chosen renderer's own keys: what its settings suggest, with Alt held.

use egui::{Key, Modifiers};
use pointstage_plugin_api::settings_schema::{
    SettingKind, SettingSchema, SettingValue, SettingValues,
};

use super::{Action, Menu, Place};
use crate::window::intent::{Intent, RendererIntent, WindowIntent};
use crate::window::rows::RendererRow;

/// A suggestion of a schema: a key, what it would do, and what asks for that.
struct Suggestion {
    key: String,
    id: String,
    title: String,
    intent: Intent,
}

/// Actions for the renderer's suggestions. Of two that want the same key, the first in the schema gets it.
pub(super) fn actions(row: &RendererRow, values: &SettingValues) -> Vec<Action> {
    let place = Place::new(Menu::Renderer, 1).within("The renderer's own keys");
    let mut taken: Vec<Key> = Vec::new();
    let mut actions = Vec::new();
    for suggestion in suggestions(row, values) {
        let Some(key) = key_of(&suggestion.key).filter(|key| !taken.contains(key)) else {
            continue;
        };
        taken.push(key);
        let Suggestion {
            id, title, intent, ..
        } = suggestion;
        actions.push(Action::new(id, title, place, intent).keys(Modifiers::ALT, key));
    }
    actions
}

/// What is wrong with the renderer's suggestions, a sentence each: a key wanted twice, or one that no keyboard has.
pub(crate) fn conflicts(row: &RendererRow) -> Vec<String> {
    let suggestions = suggestions(row, &SettingValues::new());
    let mut sentences = Vec::new();
    for (index, suggestion) in suggestions.iter().enumerate() {
        let Suggestion { key, title, .. } = suggestion;
        let Some(code) = key_of(key) else {
            sentences.push(format!(
                "{}: '{title}' asks for the key '{key}', which is none; it has no key.",
                row.title
            ));
            continue;
        };
        let earlier = suggestions[..index]
            .iter()
            .find(|other| key_of(&other.key) == Some(code));
        if let Some(earlier) = earlier {
            sentences.push(format!(
                "{}: Alt+{key} is wanted by '{}' and by '{title}'; the first gets it.",
                row.title, earlier.title
            ));
        }
    }
    sentences
}

fn suggestions(row: &RendererRow, values: &SettingValues) -> Vec<Suggestion> {
    let mut suggestions = Vec::new();
    for setting in &row.settings {
        if let Some(key) = &setting.shortcut {
            suggestions.push(Suggestion {
                key: key.clone(),
                id: format!("setting.{}", setting.id),
                title: setting.label.clone(),
                intent: on_key(setting, values),
            });
        }
        for shortcut in &setting.value_shortcuts {
            let value = &shortcut.value;
            suggestions.push(Suggestion {
                key: shortcut.key.clone(),
                id: format!("setting.{}.{value}", setting.id),
                title: format!("{}: {}", setting.label, value_title(setting, value)),
                intent: RendererIntent::Set(setting.id.clone(), value.clone()).into(),
            });
        }
    }
    suggestions
}

/// What a setting's single key does.
fn on_key(setting: &SettingSchema, values: &SettingValues) -> Intent {
    let now = values
        .get(&setting.id)
        .cloned()
        .or_else(|| setting.default_value());
    let set = |value| RendererIntent::Set(setting.id.clone(), value).into();
    match (&setting.kind, now) {
        (SettingKind::Action, _) => RendererIntent::Press(setting.id.clone()).into(),
        (SettingKind::Bool { .. }, Some(SettingValue::Bool(on))) => set(SettingValue::Bool(!on)),
        (SettingKind::Choice { options, .. }, Some(SettingValue::Choice(now))) => {
            let at = options.iter().position(|option| option.id == now);
            let next = at.map_or(0, |at| (at + 1) % options.len());
            let next = options.get(next).map_or(now, |option| option.id.clone());
            set(SettingValue::Choice(next))
        }
        _ => WindowIntent::FocusSetting(setting.id.clone()).into(),
    }
}

/// A value as the panel shows it.
fn value_title(setting: &SettingSchema, value: &SettingValue) -> String {
    if let (SettingKind::Choice { options, .. }, SettingValue::Choice(id)) = (&setting.kind, value)
        && let Some(option) = options.iter().find(|option| option.id == *id)
    {
        return option.label.clone();
    }
    value.to_string()
}

fn key_of(name: &str) -> Option<Key> {
    Key::from_name(&name.to_uppercase()).or_else(|| Key::from_name(name))
}

#[cfg(test)]
mod tests {
    use super::*;
    use pointstage_plugin_api::manifest::Manifest;
    use serde_json::json;

    /// A renderer with these settings.
    fn row(settings: &serde_json::Value) -> RendererRow {
        let manifest = json!({
            "format": 1, "vendor": "Test", "licence": "MIT", "api": "1.0",
            "plugins": [{
                "kind": "renderer", "id": "org.example.test", "alias": "test", "version": "1.0.0", "title": "Test",
                "needs": {}, "gives": { "targets": ["colour"] }, "settings": settings,
            }],
        });
        let manifest = Manifest::parse(manifest.to_string().as_bytes()).expect("a good manifest");
        RendererRow::of(&manifest.plugins[0])
    }

    fn pop() -> RendererRow {
        row(&json!([
            { "id": "cull", "kind": "bool", "default": true, "label": "Cull backs", "shortcut": "B" },
            { "id": "method", "kind": "choice", "default": "pop", "label": "Method", "shortcut": "M",
              "options": [{ "id": "classic", "label": "Classic" }, { "id": "pop", "label": "POP" }],
              "value_shortcuts": [{ "key": "A", "value": "classic" }, { "key": "d", "value": "pop" }] },
            { "id": "threshold", "kind": "float", "default": 2.0, "label": "Threshold", "shortcut": "T" },
            { "id": "rebuild", "kind": "action", "label": "Rebuild", "shortcut": "B" },
            { "id": "odd", "kind": "bool", "default": true, "label": "Odd", "shortcut": "Banana" },
        ]))
    }

    #[test]
    fn keys_switch_step_set_press_and_focus() {
        let actions = actions(&pop(), &SettingValues::new());
        let asked = |key| {
            let has_key = |action: &&Action| action.keys[0].shortcut.logical_key == key;
            actions
                .iter()
                .find(has_key)
                .map(|action| action.intent.clone())
        };
        let set = |id: &str, value| Some(RendererIntent::Set(id.into(), value).into());
        let choice = |id: &str| SettingValue::Choice(id.into());
        assert_eq!(asked(Key::B), set("cull", SettingValue::Bool(false)));
        assert_eq!(
            asked(Key::M),
            set("method", choice("classic")),
            "the next one"
        );
        assert_eq!(asked(Key::A), set("method", choice("classic")));
        assert_eq!(asked(Key::D), set("method", choice("pop")));
        let focus = WindowIntent::FocusSetting("threshold".into());
        assert_eq!(asked(Key::T), Some(focus.into()));
        let all_with_alt = actions
            .iter()
            .all(|action| action.keys[0].shortcut.modifiers == Modifiers::ALT);
        assert!(all_with_alt, "{actions:?}");
    }

    #[test]
    fn conflicts_are_named() {
        let said = conflicts(&pop());
        assert_eq!(said.len(), 2, "{said:?}");
        assert!(
            said[0].contains("'Cull backs' and by 'Rebuild'"),
            "{said:?}"
        );
        assert!(said[1].contains("'Banana'"), "{said:?}");
    }
}
