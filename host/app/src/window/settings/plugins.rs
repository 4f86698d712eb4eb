//! The *Plugins* tab: every plugin file found, what came of it and what it holds; setting aside, another try, folders.

use egui::{Button, Id, TextEdit, Ui};
use pointstage_engine::stage::{PluginHoldings, Severity};

use crate::window::dialogs::typed_path;
use crate::window::intent::{Intents, PluginsIntent, WindowIntent};
use crate::window::rows::{FolderRow, PluginRow, Rows};
use crate::window::theme;

/// What the tab shows.
pub(crate) struct PluginsTab<'a> {
    /// Every plugin file and folder.
    pub(crate) rows: &'a Rows,
    /// What plugins in use hold on the device.
    pub(crate) holdings: &'a [PluginHoldings],
}

/// The tab.
pub(crate) fn plugins_ui(ui: &mut Ui, tab: &PluginsTab<'_>, out: &mut Intents) {
    super::tab_ui(ui, |ui| {
        let plugins = &tab.rows.plugins;
        ui.horizontal(|ui| {
            let reload = ui.button("Reload");
            let reload = reload.on_hover_text(
                "Looks at all plugin files again: new ones are examined, and what was built anew is loaded anew",
            );
            if reload.accessible_name("Reload plugins").clicked() {
                out.push(PluginsIntent::Reload);
            }
            if ui.button("Copy all").clicked() {
                let texts: Vec<String> = plugins
                    .iter()
                    .map(|plugin| as_text(plugin, tab.holdings))
                    .collect();
                out.push(WindowIntent::Copy(texts.join("\n")));
            }
        });
        if plugins.is_empty() {
            ui.label("No plugin files were found. Plugins stand beside the program, in the user's plugin folder, in the folders of POINTSTAGE_PLUGIN_PATH, in folders that you add below, or are named with --plugin FILE.");
        }
        for plugin in plugins {
            ui.separator();
            ui.push_id(&plugin.path, |ui| plugin_ui(ui, plugin, tab.holdings, out));
        }
        ui.separator();
        folders_ui(ui, &tab.rows.folders, out);
    });
}

fn plugin_ui(ui: &mut Ui, plugin: &PluginRow, holdings: &[PluginHoldings], out: &mut Intents) {
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
        } else {
            let aside = ui.small_button("Set aside");
            let aside = aside
                .on_hover_text("Do without it, now and in later sessions, until it is tried again");
            if aside
                .accessible_name(format!("Set {} aside", plugin.title))
                .clicked()
            {
                out.push(PluginsIntent::SetAside(plugin.path.clone()));
            }
        }
    });
    if !plugin.message.is_empty() {
        ui.label(&plugin.message);
    }
    ui.weak(plugin.in_short(holdings));
    ui.collapsing("Details", |ui| {
        ui.label(plugin.path.display().to_string());
        for (name, value) in &plugin.facts {
            ui.label(format!("{name}: {value}"));
        }
        if !plugin.detail.is_empty() {
            ui.monospace(&plugin.detail);
        }
        if ui.small_button("Copy").clicked() {
            out.push(WindowIntent::Copy(as_text(plugin, holdings)));
        }
    });
}

/// Folders that are searched, and two ways to add one.
fn folders_ui(ui: &mut Ui, folders: &[FolderRow], out: &mut Intents) {
    ui.strong("Folders");
    for folder in folders {
        ui.horizontal_wrapped(|ui| {
            ui.label(folder.path.display().to_string());
            ui.weak(&folder.origin);
            if folder.is_removable {
                let remove = ui.small_button("Remove");
                let name = format!("Remove folder {}", folder.path.display());
                if remove.accessible_name(name).clicked() {
                    out.push(PluginsIntent::RemoveFolder(folder.path.clone()));
                }
            }
        });
    }
    let id: Id = ui.scope_id().with("folder");
    let mut typed = ui.data(|data| data.get_temp::<String>(id).unwrap_or_default());
    ui.horizontal_wrapped(|ui| {
        let field = TextEdit::singleline(&mut typed)
            .hint_text("/home/me/plugins")
            .desired_width(f32::INFINITY);
        let field = ui.add(field);
        let is_entered =
            field.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter));
        field.accessible_name("Folder to look for plugins in");
        let has_text = !typed.trim().is_empty();
        let add = ui.add_enabled(has_text, Button::new("Add folder"));
        if has_text && (is_entered || add.clicked()) {
            out.push(PluginsIntent::AddFolder(typed_path(&typed)));
            typed.clear();
        }
        let choose = ui.button("Choose…");
        if choose
            .accessible_name("Choose a folder of plugins")
            .clicked()
        {
            out.push(PluginsIntent::ChooseFolder);
        }
    });
    ui.data_mut(|data| data.insert_temp(id, typed));
}

fn as_text(plugin: &PluginRow, holdings: &[PluginHoldings]) -> String {
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
    text.push_str(&plugin.in_short(holdings));
    text.push('\n');
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
