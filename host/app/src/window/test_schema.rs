//! Schemas of settings for tests.

use pointstage_plugin_api::manifest::Manifest;
use pointstage_plugin_api::settings_schema::SettingSchema;

/// A schema of these settings, as a manifest gives it; JSON.
pub(crate) fn schema_of(settings: &str) -> Vec<SettingSchema> {
    let manifest = format!(
        r#"{{ "format": 1, "vendor": "Test", "licence": "MIT", "api": "1.0", "plugins": [{{
            "kind": "renderer", "id": "org.example.all", "version": "1.0.0",
            "needs": {{}}, "gives": {{ "targets": ["colour"] }}, "settings": [{settings}] }}] }}"#
    );
    let manifest = Manifest::parse(manifest.as_bytes()).expect("the test's manifest is right");
    manifest.plugins[0].settings.clone()
}
