//! What the panels show about renderers and plugins: made from the engine's registry, read by the UI functions.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use pointstage_engine::plugins::{
    FoundIn, PluginFile, PluginInfo, Remedy, Suitability, VerdictClass, suitability,
};
use pointstage_engine::stage::{FALLBACK_ID, Notice, PluginHoldings, Severity, Stage};
use pointstage_plugin_api::manifest::{DeviceKind, Gives, Needs, PluginEntry};
use pointstage_plugin_api::settings_schema::SettingSchema;
use pointstage_scene::Scene;

use super::recommend::{self, Candidate, Has, Recommendation};

/// All rows.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Rows {
    /// Every renderer found.
    pub(crate) renderers: Vec<RendererRow>,
    /// Every structure found.
    pub(crate) structures: Vec<RendererRow>,
    /// Every plugin file found.
    pub(crate) plugins: Vec<PluginRow>,
    /// Every folder that is searched for plugins.
    pub(crate) folders: Vec<FolderRow>,
    /// Plugins in which earlier sessions ended, as sentences.
    pub(crate) culprits: Vec<String>,
    /// The renderer that suits the scene best, if there is a scene.
    pub(crate) recommended: Option<Recommendation>,
    /// The renderer that suits moving pictures of the scene best.
    pub(crate) recommended_preview: Option<Recommendation>,
}

impl Rows {
    /// The renderer of this id.
    pub(crate) fn renderer(&self, id: &str) -> Option<&RendererRow> {
        self.renderers.iter().find(|row| row.id == id)
    }

    /// The structure of this id.
    pub(crate) fn structure(&self, id: &str) -> Option<&RendererRow> {
        self.structures.iter().find(|row| row.id == id)
    }

    /// The name for people of a renderer or structure; its id if it is not there.
    pub(crate) fn title<'a>(&'a self, id: &'a str) -> &'a str {
        let mut rows = self.renderers.iter().chain(&self.structures);
        rows.find(|row| row.id == id)
            .map_or(id, |row| row.title.as_str())
    }

    /// The renderer that a new window chooses: the first that can draw, and has its picture at once.
    pub(crate) fn first_suitable(&self) -> Option<&RendererRow> {
        let mut suitable = self.renderers.iter().filter(|row| row.obstacle.is_none());
        suitable.find(|row| !row.refines)
    }
}

/// A renderer or structure in a list.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct RendererRow {
    /// What a request names.
    pub(crate) id: String,
    /// The short name that command lines take.
    pub(crate) alias: String,
    /// For people.
    pub(crate) title: String,
    /// Of the plugin; empty for what is built in.
    pub(crate) version: String,
    /// Version, citation, what it gives: the tooltip.
    pub(crate) about: String,
    /// Why it cannot draw this scene on this device, if so.
    pub(crate) obstacle: Option<Obstacle>,
    /// Whether its picture comes bit by bit.
    pub(crate) refines: bool,
    /// What it needs of a scene and draws with, in words.
    pub(crate) needs: String,
    /// What it offers.
    pub(crate) gives: Gives,
    /// Its settings.
    pub(crate) settings: Vec<SettingSchema>,
}

/// Why a renderer cannot draw.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Obstacle {
    /// One sentence.
    pub(crate) reason: String,
    /// What the host can do about it.
    pub(crate) remedy: Option<Remedy>,
}

/// A plugin file in a list.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct PluginRow {
    /// The file.
    pub(crate) path: PathBuf,
    /// What it brings, or the file's name.
    pub(crate) title: String,
    /// `accepted`, `refused`, `quarantined`, …
    pub(crate) verdict: String,
    /// How serious the verdict is.
    pub(crate) severity: Severity,
    /// Why, in a sentence; empty when all is well.
    pub(crate) message: String,
    /// The long form.
    pub(crate) detail: String,
    /// Facts by name: API, hash, time to examine.
    pub(crate) facts: Vec<(String, String)>,
    /// Versions of the plugins in it, and of the border.
    pub(crate) versions: String,
    /// Where it was found, in a few words.
    pub(crate) found_in: String,
    /// How long it took to load; none if it is not loaded.
    pub(crate) load_time: Option<Duration>,
    /// Ids of the plugins in it.
    pub(crate) ids: Vec<String>,
    /// Whether trying again makes sense.
    pub(crate) can_retry: bool,
}

/// A folder that is searched for plugins.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct FolderRow {
    /// The folder.
    pub(crate) path: PathBuf,
    /// Why it is searched.
    pub(crate) origin: String,
    /// Whether the user added it.
    pub(crate) is_removable: bool,
}

impl PluginRow {
    /// Version, interface, origin, time to load and memory: the line below the title.
    pub(crate) fn in_short(&self, holdings: &[PluginHoldings]) -> String {
        let mut parts = Vec::new();
        if !self.versions.is_empty() {
            parts.push(self.versions.clone());
        }
        parts.push(self.found_in.clone());
        let own = holdings.iter().filter(|held| self.ids.contains(&held.id));
        // It may have been loaded since this row was made.
        let loaded_since = own.clone().find_map(|held| held.load_time);
        if let Some(time) = self.load_time.or(loaded_since) {
            parts.push(format!("loaded in {:.0} ms", time.as_secs_f64() * 1e3));
        } else {
            parts.push("not loaded".to_owned());
        }
        let (handles, bytes) = own.fold((0, 0), |(handles, bytes), held| {
            (handles + held.handle_count, bytes + held.bytes)
        });
        if handles > 0 {
            let megabytes = bytes as f64 / 1e6;
            parts.push(format!(
                "holds {megabytes:.1} MB in {handles} objects on the device"
            ));
        }
        parts.join(", ")
    }

    /// The verdict as a message: the program goes on without the plugin.
    pub(crate) fn notice(&self) -> Notice {
        Notice {
            severity: Severity::Warning,
            plugin: self.title.clone(),
            text: format!("{}: {}", self.verdict, self.message),
            detail: self.detail.clone(),
        }
    }
}

/// Lists what the stage has, and what of it fits `scene`. Thread: the stage's.
pub(crate) fn of(stage: &Stage, scene: &Scene) -> Rows {
    let registry = stage.registry();
    let device = stage.device().map(|device| &**device);
    let row = |info: &PluginInfo| RendererRow {
        about: about(info),
        obstacle: obstacle(&suitability(&info.entry.needs, scene, device)),
        ..RendererRow::of(&info.entry)
    };
    let found = registry.renderers();
    let mut renderers: Vec<RendererRow> = found.iter().map(|info| row(info)).collect();
    name_builds(&mut renderers, &found);
    let candidates: Vec<Candidate<'_>> = found
        .iter()
        .zip(&renderers)
        .map(|(info, row)| Candidate {
            id: &row.id,
            needs: &info.entry.needs,
            gives: &info.entry.gives,
            is_suitable: row.obstacle.is_none(),
        })
        .collect();
    let has = Has::of(scene);
    let recommended = recommend::main(&candidates, has);
    let recommended_preview = recommend::preview(&candidates, has);
    renderers.push(RendererRow {
        id: FALLBACK_ID.to_owned(),
        alias: "fallback".to_owned(),
        version: String::new(),
        needs: "CPU".to_owned(),
        gives: Gives::default(),
        title: "Built-in fallback (CPU)".to_owned(),
        about: "Opaque disks drawn on the CPU; always there.".to_owned(),
        obstacle: None,
        refines: false,
        settings: Vec::new(),
    });
    Rows {
        renderers,
        structures: registry.structures().iter().map(|info| row(info)).collect(),
        plugins: registry.files().iter().map(plugin_row).collect(),
        folders: stage
            .plugin_folders()
            .iter()
            .map(|path| folder_row(path))
            .collect(),
        culprits: registry
            .culprits()
            .iter()
            .map(ToString::to_string)
            .collect(),
        recommended,
        recommended_preview,
    }
}

impl RendererRow {
    /// What the manifest says, as if nothing stood in its way.
    pub(crate) fn of(entry: &PluginEntry) -> Self {
        Self {
            id: entry.id.clone(),
            alias: entry.alias.clone(),
            title: entry.title.clone(),
            version: entry.version.clone(),
            about: String::new(),
            obstacle: None,
            refines: entry.gives.progressive,
            needs: needs_in_words(&entry.needs),
            gives: entry.gives.clone(),
            settings: entry.settings.clone(),
        }
    }
}

/// Gives builds of one plugin names of their own: the first keeps the plugin's, each further one is named by its hash.
fn name_builds(rows: &mut [RendererRow], found: &[Arc<PluginInfo>]) {
    for (index, info) in found.iter().enumerate() {
        let is_further = found[..index].iter().any(|other| other.id == info.id);
        if is_further && let Some(row) = rows.get_mut(index) {
            let hash: String = info.hash.chars().take(8).collect();
            row.id = format!("{}#{hash}", info.id);
            row.title = format!(
                "{} ({}, build {hash})",
                info.entry.title, info.entry.version
            );
        }
    }
}

fn needs_in_words(needs: &Needs) -> String {
    let mut words: Vec<&str> = [
        (needs.normals, "normals"),
        (needs.radii, "radii"),
        (needs.axes, "axes"),
        (needs.colours, "colours"),
        (needs.mesh, "triangles"),
    ]
    .into_iter()
    .filter_map(|(is_needed, word)| is_needed.then_some(word))
    .collect();
    words.extend(needs.columns.iter().map(String::as_str));
    words.push(match needs.device {
        DeviceKind::Gpu => "a device",
        DeviceKind::Cpu => "CPU",
    });
    words.join(", ")
}

fn about(info: &PluginInfo) -> String {
    let PluginEntry {
        id,
        version,
        description,
        gives,
        ..
    } = &info.entry;
    let targets: Vec<&str> = gives
        .targets
        .iter()
        .map(|target| target.key.as_str())
        .collect();
    let mut lines = Vec::new();
    if !description.is_empty() {
        lines.push(description.clone());
    }
    lines.push(format!("{id} {version}"));
    if !targets.is_empty() {
        lines.push(format!("Writes {}.", targets.join(", ")));
    }
    lines.join("\n")
}

fn obstacle(suitability: &Suitability) -> Option<Obstacle> {
    match suitability {
        Suitability::Suitable => None,
        Suitability::Unsuitable { reason, remedy } => Some(Obstacle {
            reason: reason.clone(),
            remedy: *remedy,
        }),
    }
}

fn plugin_row(file: &PluginFile) -> PluginRow {
    let PluginFile {
        path,
        manifest,
        verdict,
        ..
    } = file;
    let manifests = manifest.iter();
    let plugins: Vec<&PluginEntry> = manifests.flat_map(|manifest| &manifest.plugins).collect();
    let titles: Vec<&str> = plugins.iter().map(|plugin| plugin.title.as_str()).collect();
    let title = if titles.is_empty() {
        path.file_name()
            .unwrap_or(path.as_os_str())
            .to_string_lossy()
            .into_owned()
    } else {
        titles.join(", ")
    };
    PluginRow {
        path: path.clone(),
        title,
        verdict: verdict.in_words().to_owned(),
        severity: match verdict.class {
            VerdictClass::Ok => Severity::Info,
            VerdictClass::NotExamined => Severity::Warning,
            _ => Severity::Error,
        },
        message: verdict.message.clone(),
        detail: verdict.detail.clone(),
        facts: facts(file),
        versions: versions(file),
        found_in: file.found_in.in_words().to_owned(),
        load_time: file.load_time(),
        ids: plugins.iter().map(|plugin| plugin.id.clone()).collect(),
        can_retry: !verdict.is_usable(),
    }
}

/// `0.1.0, API 1.0`; each version once.
fn versions(file: &PluginFile) -> String {
    let plugins = file.manifest.iter().flat_map(|manifest| &manifest.plugins);
    let mut versions: Vec<String> = plugins.map(|plugin| plugin.version.clone()).collect();
    versions.dedup();
    versions.extend(file.api.as_ref().map(|api| format!("API {api}")));
    versions.join(", ")
}

fn folder_row(path: &Path) -> FolderRow {
    let origin = FoundIn::folder(path);
    FolderRow {
        path: path.to_owned(),
        origin: origin.in_words().to_owned(),
        is_removable: matches!(origin, FoundIn::Folder(_)),
    }
}

fn facts(file: &PluginFile) -> Vec<(String, String)> {
    let mut facts = Vec::new();
    let mut add = |name: &str, value: String| facts.push((name.to_owned(), value));
    if let Some(manifest) = &file.manifest {
        for plugin in &manifest.plugins {
            add(&plugin.kind, format!("{} {}", plugin.id, plugin.version));
        }
        add("Vendor", manifest.vendor.clone());
        add("Licence", manifest.licence.clone());
        if !manifest.citation.is_empty() {
            add("Citation", manifest.citation.clone());
        }
    }
    if let Some(folder) = file.found_in.path() {
        add("Found in", folder.display().to_string());
    }
    if let Some(api) = &file.api {
        add("API", api.clone());
    }
    add("Hash", file.hash.chars().take(16).collect());
    add("Size", format!("{} kB", file.size / 1000));
    if file.from_cache {
        add("Examined", "in an earlier session".to_owned());
    } else if !file.examination_time.is_zero() {
        add(
            "Examined",
            format!("in {:.0} ms", file.examination_time.as_secs_f64() * 1e3),
        );
    }
    facts
}
