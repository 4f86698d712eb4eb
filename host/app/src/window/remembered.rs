//! What the window remembers: between its passes about files, and from one start to the next about everything.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use egui::{Context, ThemePreference};
use pointstage_engine::plugins::standard_folders;
use pointstage_engine::stage::Severity;
use pointstage_scene::Loaded;

use super::app::App;
use super::errands::{Done, Errands};
use super::intent::Tab;
use super::loading::Place;
use super::pacing::Pacing;
use super::session::ViewOptions;
use super::theme;
use super::views::{NamedView, StoredViews, slot_key, slot_of_key};
use crate::preferences::{self, Keeper, Layout, Opened, Preferences, Recent, Theme};
use crate::session_file::{OwnFiles, Renderers, SceneFile};
use crate::toml_form::{Look, NumberOrigin, StoredView};

/// What is remembered beside the session.
pub(crate) struct Remembered {
    /// The settings file.
    keeper: Keeper,
    /// Work with files.
    pub(super) errands: Errands,
    /// Files that were opened.
    pub(super) recent: Recent,
    /// Those of them that were not there when somebody looked last.
    pub(super) missing: BTreeSet<PathBuf>,
    /// The session file that *Save again* writes to.
    pub(super) session_path: Option<PathBuf>,
    /// Objects of that session whose files could not be loaded: they are saved with it again.
    pub(super) absent: Vec<SceneFile>,
    /// Which surfels the files hold that were written for objects of sessions.
    pub(super) own_files: OwnFiles,
    /// Folders that the user added, as the settings file had them.
    plugin_folders: Vec<PathBuf>,
    /// Folders that are searched for plugins without being added.
    usual_folders: Vec<PathBuf>,
    /// Theme and text scale that the toolkit has still to be told.
    to_tell: Option<(Theme, f32)>,
    /// Theme and text scale in the last pass.
    appearance: (Theme, f32),
    /// Whether the window had the keyboard in the last pass.
    had_keyboard: bool,
}

impl Remembered {
    /// Nothing to remember yet, and no file to remember it in.
    ///
    /// # Errors
    /// Never without a file; the settings' writer needs a thread.
    pub(super) fn without_file(wake: Arc<dyn Fn() + Send + Sync>) -> std::io::Result<Self> {
        Ok(Self {
            keeper: Keeper::new(None)?,
            errands: Errands::new(wake),
            recent: Recent::default(),
            missing: BTreeSet::new(),
            session_path: None,
            absent: Vec::new(),
            own_files: OwnFiles::default(),
            plugin_folders: Vec::new(),
            usual_folders: standard_folders(),
            to_tell: None,
            appearance: (Theme::System, 1.0),
            had_keyboard: false,
        })
    }

    /// Theme and text scale, as the last pass left them.
    pub(super) fn appearance(&self) -> (Theme, f32) {
        self.appearance
    }

    /// Notes that a file was opened or saved.
    pub(super) fn note(&mut self, path: &Path) {
        self.recent.note(path);
        self.look_for_recent();
    }

    /// Notes the file of an object that was loaded for the first time.
    pub(super) fn note_loaded(&mut self, loaded: &Loaded, place: Place) {
        if let (Place::New(..), Some(path)) = (place, &loaded.object.source) {
            self.note(path);
        }
    }

    /// The scene was replaced by another than the session file's.
    pub(super) fn leave_session(&mut self) {
        self.session_path = None;
        self.absent.clear();
    }

    /// Has somebody look which recent files are there: the menu must not wait for a disk.
    pub(super) fn look_for_recent(&mut self) {
        if !self.recent.paths().is_empty() {
            self.errands.look_for(self.recent.paths().to_vec());
        }
    }
}

impl App {
    /// Takes over what the settings file remembers, and keeps it from now on.
    ///
    /// # Errors
    /// The settings' writer gets no thread.
    pub(super) fn remember(&mut self, opened: Opened) -> std::io::Result<()> {
        if let Some(complaint) = &opened.complaint {
            self.log.error(complaint, Instant::now());
        }
        let preferences = opened.preferences.clone();
        self.remembered.keeper = Keeper::new(Some(opened))?;
        let Preferences {
            theme,
            text_scale,
            recent,
            plugin_folders,
            window,
            renderers,
            look,
            lights,
            material,
            settings,
            presets,
            active_presets,
            navigation,
            pacing,
            views,
            ..
        } = preferences;
        self.remembered.to_tell = Some((theme, text_scale));
        self.remembered.recent = recent;
        self.remembered.plugin_folders = plugin_folders;
        self.remembered.look_for_recent();
        self.panels.settings = window.settings;
        self.panels.log = window.log;
        self.panels.inspector = window.inspector;
        self.panels.tab = tab_from_key(&window.tab);
        let session = &mut self.session;
        session.panes.active.renderer = renderers.main.unwrap_or_default();
        session.panes.active.preview = renderers.preview;
        session.panes.active.structure = renderers.structure;
        session.panes.active.view = look.into();
        session.panes.active.lights = lights;
        session.material = material;
        session.panes.active.settings = settings;
        session.presets = presets;
        session.panes.active.active_presets = active_presets;
        session.navigation = navigation;
        session.pacing = pacing.into();
        session.views = stored_views(views);
        Ok(())
    }

    /// Collects what errands brought, and looks after recent files when the window gets the keyboard.
    pub(super) fn take_errands(&mut self, ctx: &Context) {
        if let Some((theme, scale)) = self.remembered.to_tell {
            ctx.set_theme(theme_preference(theme));
            theme::set_text_scale(ctx, scale);
            // The toolkit takes the scale over in its next pass.
            if theme::text_scale(ctx) == scale {
                self.remembered.to_tell = None;
            }
        }
        let has_keyboard = ctx.input(|input| input.focused);
        if has_keyboard && !self.remembered.had_keyboard {
            self.remembered.look_for_recent();
        }
        self.remembered.had_keyboard = has_keyboard;
        let now = Instant::now();
        for done in self.remembered.errands.take() {
            match done {
                Done::Missing(paths) => self.remembered.missing = paths.into_iter().collect(),
                Done::Saved(path, Ok(())) => {
                    let text = format!("Session saved: {}", path.display());
                    self.log.say(Severity::Info, text, now);
                    self.remembered.note(&path);
                    self.remembered.session_path = Some(path);
                }
                Done::Saved(_, Err(reason)) => self.log.error(reason, now),
            }
        }
    }

    /// Has changes written when it is time; returns when to look again.
    pub(super) fn keep_preferences(&mut self, ctx: &Context) -> Option<Duration> {
        let now = Instant::now();
        for reason in self.remembered.keeper.take_failures() {
            self.log.error(reason, now);
        }
        // Until the toolkit has been told, it would be asked for what it does not know.
        if self.remembered.to_tell.is_some() {
            return None;
        }
        self.remembered.appearance = (theme_of(ctx), theme::text_scale(ctx));
        let preferences = self.preferences();
        self.remembered.keeper.keep(preferences, now)
    }

    /// All that is remembered, as it is now.
    fn preferences(&self) -> Preferences {
        let Self {
            session,
            panels,
            remembered,
            ..
        } = self;
        let main = (!session.panes.active.renderer.is_empty())
            .then(|| session.panes.active.renderer.clone());
        Preferences {
            theme: remembered.appearance.0,
            text_scale: remembered.appearance.1,
            recent: remembered.recent.clone(),
            plugin_folders: self.added_plugin_folders(),
            window: Layout {
                settings: panels.settings,
                log: panels.log,
                inspector: panels.inspector,
                tab: tab_key(panels.tab).to_owned(),
            },
            renderers: Renderers {
                // Before plugins are known, none is chosen: what was remembered stays.
                main: main.or_else(|| remembered.keeper.preferences().renderers.main.clone()),
                preview: session.panes.active.preview.clone(),
                structure: session.panes.active.structure.clone(),
            },
            look: Look::from(&session.panes.active.view),
            lights: session.panes.active.lights.clone(),
            material: session.material,
            settings: session.panes.active.settings.clone(),
            presets: session.presets.clone(),
            active_presets: session.panes.active.active_presets.clone(),
            navigation: session.navigation,
            pacing: session.pacing.into(),
            views: views_to_store(&session.views),
            ..Preferences::default()
        }
    }

    /// Folders that are searched for plugins beside the usual ones.
    fn added_plugin_folders(&self) -> Vec<PathBuf> {
        // Before plugins are known, what was remembered stays.
        if self.rows.folders.is_empty() {
            return self.remembered.plugin_folders.clone();
        }
        let folders = self.rows.folders.iter().map(|row| &row.path);
        folders
            .filter(|path| !self.remembered.usual_folders.contains(path) && path.to_str().is_some())
            .cloned()
            .collect()
    }
}

/// The theme that the user chose.
fn theme_of(ctx: &Context) -> Theme {
    match ctx.options(|options| options.theme_preference) {
        ThemePreference::System => Theme::System,
        ThemePreference::Light => Theme::Light,
        ThemePreference::Dark => Theme::Dark,
    }
}

fn theme_preference(theme: Theme) -> ThemePreference {
    match theme {
        Theme::System => ThemePreference::System,
        Theme::Light => ThemePreference::Light,
        Theme::Dark => ThemePreference::Dark,
    }
}

/// The tabs' words in the settings file.
const TABS: [(Tab, &str); 6] = [
    (Tab::Renderer, "renderer"),
    (Tab::Lighting, "lighting"),
    (Tab::View, "view"),
    (Tab::Compare, "compare"),
    (Tab::Scene, "scene"),
    (Tab::Plugins, "plugins"),
];

fn tab_key(tab: Tab) -> &'static str {
    let found = TABS.iter().find(|(other, _)| *other == tab);
    found.map_or("renderer", |(_, key)| key)
}

fn tab_from_key(key: &str) -> Tab {
    let found = TABS.iter().find(|(_, other)| *other == key);
    found.map_or(Tab::Renderer, |(tab, _)| *tab)
}

/// Views as a file holds them: by number first.
pub(super) fn views_to_store(views: &StoredViews) -> Vec<StoredView> {
    let numbered = views.slots.iter().enumerate();
    let numbered = numbered.filter_map(|(slot, view)| {
        Some(StoredView {
            key: u8::try_from(slot_key(slot).to_digit(10)?).ok(),
            number: None,
            name: String::new(),
            view: (*view)?,
            thumbnail: Vec::new(),
        })
    });
    let named = views.named.iter().map(|named| StoredView {
        key: None,
        number: None,
        name: named.name.clone(),
        view: named.record,
        thumbnail: named.thumbnail.clone(),
    });
    numbered.chain(named).collect()
}

/// Views from a file, whose older numbers count places. Names that come twice are left out.
pub(super) fn stored_views(stored: Vec<StoredView>) -> StoredViews {
    let mut views = StoredViews::default();
    for mut stored in stored {
        stored.take_number(NumberOrigin::Place);
        let StoredView {
            key,
            name,
            view,
            thumbnail,
            ..
        } = stored;
        if let Some(slot) = key.and_then(|key| views.slots.get_mut(slot_of_key(key))) {
            *slot = Some(view);
        }
        let is_taken = views.named.iter().any(|other| other.name == name);
        if !name.is_empty() && !is_taken {
            views.named.push(NamedView {
                name,
                record: view,
                thumbnail,
            });
        }
    }
    views
}

impl From<&ViewOptions> for Look {
    fn from(view: &ViewOptions) -> Self {
        Self {
            show: view.show.clone(),
            background: view.background,
            exposure: view.exposure,
            radius_scale: view.radius_scale,
        }
    }
}

impl From<Look> for ViewOptions {
    fn from(look: Look) -> Self {
        Self {
            show: look.show,
            background: look.background,
            exposure: look.exposure,
            radius_scale: look.radius_scale,
        }
    }
}

impl From<Pacing> for preferences::Pacing {
    fn from(pacing: Pacing) -> Self {
        Self {
            rate_limit: pacing.rate_limit,
            target_rate: pacing.target_rate,
            cross_fade: pacing.cross_fade,
        }
    }
}

impl From<preferences::Pacing> for Pacing {
    fn from(pacing: preferences::Pacing) -> Self {
        Self {
            rate_limit: pacing.rate_limit,
            target_rate: pacing.target_rate,
            cross_fade: pacing.cross_fade,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pointstage_scene::{Camera, ViewRecord};

    #[test]
    fn views_come_back_under_their_numbers_and_names() {
        let view = ViewRecord::new(Camera::default(), 8, 6);
        let mut views = StoredViews::default();
        views.slots[0] = Some(view);
        views.slots[9] = Some(ViewRecord::new(Camera::default(), 9, 9));
        views.named.push(NamedView {
            name: "front".to_owned(),
            record: view,
            thumbnail: vec![1, 2],
        });
        assert_eq!(stored_views(views_to_store(&views)), views);
        let keys: Vec<_> = views_to_store(&views).iter().map(|view| view.key).collect();
        assert_eq!(keys, [Some(1), Some(0), None], "files name the keys");
    }

    #[test]
    fn the_settings_of_an_older_window_count_places() {
        let old = |number| StoredView {
            key: None,
            number: Some(number),
            name: String::new(),
            view: ViewRecord::new(Camera::default(), 8, 6),
            thumbnail: Vec::new(),
        };
        let views = stored_views(vec![old(2), old(9), old(200)]);
        let filled: Vec<usize> = (0..views.slots.len())
            .filter(|slot| views.slots[*slot].is_some())
            .collect();
        assert_eq!(filled, [2, 9]);
    }

    #[test]
    fn every_tab_has_a_word() {
        for (tab, key) in TABS {
            assert_eq!((tab_key(tab), tab_from_key(key)), (key, tab));
        }
        assert_eq!(tab_from_key("attic"), Tab::Renderer);
    }
}
