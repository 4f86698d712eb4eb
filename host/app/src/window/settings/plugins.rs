//! The *Plugins* tab: every plugin file found, what came of it, and another try for the quarantined.

use egui::{ScrollArea, Ui};
use pointstage_engine::stage::Severity;

use crate::window::intent::{Intents, PluginsIntent, WindowIntent};
use crate::window::rows::PluginRow;
use crate::window::theme;

/// The tab.
pub(crate) fn plugins_ui(ui: &mut Ui, plugins: &[PluginRow], out: &mut Intents) {
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        if plugins.is_empty() {
            ui.label("No plugin files were found. Plugins stand beside the program, in the user's plugin folder, in the folders of POINTSTAGE_PLUGIN_PATH, or are named with --plugin FILE.");
        }
        for plugin in plugins {
            ui.push_id(&plugin.path, |ui| plugin_ui(ui, plugin, out));
            ui.separator();
        }
    });
}

fn plugin_ui(ui: &mut Ui, plugin: &PluginRow, out: &mut Intents) {
    ui.horizontal_wrapped(|ui| {
        ui.strong(&plugin.title);
        if plugin.severity == Severity::Info {
            ui.weak(&plugin.verdict);
        } else {
            ui.colored_label(theme::severity_color(ui, plugin.severity), &plugin.verdict);
        }
        if plugin.can_retry {
            let retry = ui.small_button("Try again");
            if retry
                .on_hover_text("Examine it anew in a child process")
                .clicked()
            {
                out.push(PluginsIntent::Retry(plugin.path.clone()));
            }
        }
    });
    if !plugin.message.is_empty() {
        ui.label(&plugin.message);
    }
    ui.collapsing("Details", |ui| {
        ui.label(plugin.path.display().to_string());
        for (name, value) in &plugin.facts {
            ui.label(format!("{name}: {value}"));
        }
        if !plugin.detail.is_empty() {
            ui.monospace(&plugin.detail);
        }
        if ui.small_button("Copy").clicked() {
            out.push(WindowIntent::Copy(as_text(plugin)));
        }
    });
}

fn as_text(plugin: &PluginRow) -> String {
    let PluginRow {
        path,
        title,
        verdict,
        message,
        detail,
        facts,
        ..
    } = plugin;
    let mut text = format!("{title}: {verdict}\n{}\n", path.display());
    text.extend(
        facts
            .iter()
            .map(|(name, value)| format!("{name}: {value}\n")),
    );
    for part in [message, detail] {
        if !part.is_empty() {
            text.push_str(part);
            text.push('\n');
        }
    }
    text
}
