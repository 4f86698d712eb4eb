//! The window's program: what it holds, and one pass over it.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use egui::{Context, Ui, ViewportCommand};
use pointstage_engine::stage::{Severity, ViewportId};
use pointstage_scene::{Camera, Loaders, Revision, Scene};

use super::actions::{self, Action, read_keys};
use super::apply::take_pasted;
use super::comparison::Comparing;
use super::dialogs::{FileDialog, PathField};
use super::folder_dialog::FolderDialog;
use super::history::History;
use super::host_times::HostTimes;
use super::inspector::Inspector;
use super::intent::{FileIntent, Intents, OpenMode, Tab};
use super::loading::{Arrival, Batch, Finished, Place, arrive};
use super::log::Log;
use super::memory::Memory;
use super::navigation::{Navigator, take_flying_keys};
use super::palette::Palette;
use super::path::{FilmDialog, Player};
use super::progress::Progress;
use super::remembered::Remembered;
use super::rows::Rows;
use super::save_image::SaveImage;
use super::screen::{PROGRESS_PERIOD, Screen};
use super::selecting::Selecting;
use super::session::Session;
use super::several::Several;
use super::stage_link::{DrawnWith, StageLink};
use super::tasks::Tasks;

/// Everything that the window holds.
pub(crate) struct App {
    pub(super) session: Session,
    /// What each view has on the screen, in the session's order.
    pub(super) screens: Several<Screen>,
    /// What comparing has on the screen.
    pub(super) comparing: Comparing,
    pub(super) stage: StageLink,
    pub(super) rows: Rows,
    pub(super) tasks: Tasks<Finished>,
    /// What reads files.
    pub(super) loaders: Loaders,
    pub(super) log: Log,
    pub(super) remembered: Remembered,
    /// What the camera does by itself.
    pub(super) navigator: Navigator,
    pub(super) host_times: HostTimes,
    pub(super) memory: Memory,
    pub(super) panels: Panels,
    pub(super) palette: Palette,
    pub(super) inspector: Inspector,
    /// Tools that select surfels, and what was copied.
    pub(super) selecting: Selecting,
    pub(super) progress: Progress,
    /// The renderer of whose keys was told.
    told_keys_of: Option<String>,
    /// The setting that the keyboard is to be put on.
    pub(super) focus_setting: Option<String>,
    pub(super) path_field: Option<PathField>,
    pub(super) dialog: Option<FileDialog>,
    pub(super) folder_dialog: Option<FolderDialog>,
    pub(super) history: History,
    /// What plays the camera path.
    pub(super) player: Player,
    pub(super) film_dialog: Option<FilmDialog>,
    pub(super) save_image: Option<SaveImage>,
    /// What it was like when it was last used.
    pub(super) last_save_image: Option<SaveImage>,
    pub(super) wake: Arc<dyn Fn() + Send + Sync>,
    /// The batch whose objects the scene holds.
    pub(super) shown_batch: Option<Batch>,
    /// The camera that showed the whole of a scene that had just come.
    pub(super) framed: Option<Camera>,
    pub(super) next_batch: u64,
    pub(super) samples: Vec<PathBuf>,
    /// The scene and the device that `rows` were asked for.
    rows_of: Option<(Revision, DrawnWith)>,
    title: String,
}

/// Which parts of the window are open.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Panels {
    pub(super) settings: bool,
    pub(super) log: bool,
    pub(super) inspector: bool,
    pub(super) path: bool,
    pub(super) keys: bool,
    pub(super) about: bool,
    pub(super) tab: Tab,
}

impl Default for Panels {
    fn default() -> Self {
        Self {
            settings: true,
            log: false,
            inspector: false,
            path: false,
            keys: false,
            about: false,
            tab: Tab::Renderer,
        }
    }
}

/// What a new window starts with.
pub(crate) struct Start {
    /// Draws.
    pub(crate) stage: StageLink,
    /// Called from workers when the window should look.
    pub(crate) wake: Arc<dyn Fn() + Send + Sync>,
    /// Files to open.
    pub(crate) files: Vec<PathBuf>,
    /// Files that the empty window offers.
    pub(crate) samples: Vec<PathBuf>,
}

impl App {
    /// A window with an empty scene that begins to load `files`.
    pub(crate) fn new(start: Start) -> std::io::Result<Self> {
        let Start {
            stage,
            wake,
            files,
            samples,
        } = start;
        let mut app = Self {
            session: Session::new(String::new()),
            screens: Several::one(Screen::new(ViewportId(0))),
            comparing: Comparing::new(&wake)?,
            loaders: stage.loaders(),
            stage,
            rows: Rows::default(),
            tasks: Tasks::new(wake.clone())?,
            log: Log::default(),
            remembered: Remembered::without_file(wake.clone())?,
            navigator: Navigator::default(),
            host_times: HostTimes::default(),
            memory: Memory::default(),
            panels: Panels::default(),
            palette: Palette::default(),
            inspector: Inspector::default(),
            selecting: Selecting::default(),
            progress: Progress::default(),
            told_keys_of: None,
            focus_setting: None,
            path_field: None,
            dialog: None,
            folder_dialog: None,
            history: History::default(),
            player: Player::default(),
            film_dialog: None,
            save_image: None,
            last_save_image: None,
            wake,
            shown_batch: None,
            framed: None,
            next_batch: 0,
            samples,
            rows_of: None,
            title: String::new(),
        };
        app.open(files, OpenMode::Replace);
        Ok(app)
    }

    /// One pass: what workers finished, the interface, what the user asked for, the next picture.
    pub(crate) fn pass(&mut self, ui: &mut Ui) {
        self.host_times.pass_begins();
        let ctx = ui.ctx().clone();
        // Asked before the answers are taken: one that comes in between is taken by the next pass.
        let was_stage_idle = self.stage.is_idle();
        self.take_finished_tasks(&ctx);
        self.take_errands(&ctx);
        self.refresh_rows();
        self.tell_of_conflicting_keys();
        self.take_new_pictures(&ctx);
        let mut intents = Intents::new();
        self.advance_camera(&ctx);
        self.advance_path(&ctx);
        let actions: Vec<Action> = actions::all(self);
        let picture = self.screens.active.viewport.map(|viewport| viewport.id);
        if self.is_flying() {
            take_flying_keys(&ctx);
        }
        read_keys(&ctx, &actions, picture, &mut intents);
        take_pasted(&ctx, &self.selecting.clipboard.token, &mut intents);
        take_dropped_files(&ctx, &mut intents);
        self.dialog.take_if(|dialog| !dialog.poll(&mut intents));
        self.folder_dialog
            .take_if(|dialog| !dialog.poll(&mut intents));
        self.show(ui, &actions, &mut intents);
        let is_idle = intents.is_empty();
        for intent in intents {
            self.apply(&ctx, intent);
        }
        self.note_history(&ctx);
        self.follow_active();
        let asked = self.ask_for_pictures(&ctx);
        self.compare(&ctx);
        self.schedule(&ctx, is_idle);
        if let Some(time) = self.keep_preferences(&ctx) {
            ctx.request_repaint_after(time);
        }
        self.set_title(&ctx);
        let is_settled = was_stage_idle && is_idle && !asked && self.is_at_rest();
        self.report_state(&ctx, is_settled);
    }

    fn take_finished_tasks(&mut self, ctx: &Context) {
        let now = Instant::now();
        let finished = self.tasks.take_finished();
        if adds_to(self.shown_batch, &finished) {
            self.history.join_next();
        }
        for finished in finished {
            match finished {
                Finished::Loaded(loaded, place) => {
                    self.remembered.note_loaded(&loaded, place);
                    let arrival = arrive(
                        &mut self.session,
                        &mut self.shown_batch,
                        *loaded,
                        place,
                        &mut self.log,
                    );
                    match arrival {
                        Arrival::First => {
                            self.remembered.leave_session();
                            self.frame_new_scene();
                        }
                        Arrival::WithFirst if self.is_framed() => self.frame_new_scene(),
                        Arrival::WithFirst | Arrival::Joined => {}
                    }
                }
                Finished::Merged(merged) => self.take_merged(*merged),
                Finished::Estimated(estimated) => self.take_estimated(*estimated),
                Finished::ObjectSaved(saved) => self.tell_of_saved_object(&saved),
                Finished::Stopped(text) => self.log.say(Severity::Info, text, now),
                Finished::Session(opened) => self.take_over(*opened),
                Finished::Cancelled(name) => {
                    tracing::info!("cancelled: {name}");
                    let text = format!("{name}: loading cancelled");
                    self.log.say(Severity::Info, text, now);
                }
                Finished::Found(found) => self.take_found(*found),
                Finished::Pieces(pieces) => self.take_over_pieces(ctx, *pieces),
                Finished::Unchanged(what) => {
                    let text = format!("{what}: cancelled; nothing was changed");
                    self.log.say(Severity::Info, text, now);
                }
                Finished::ImageSaved(saved, size_px) => self.tell_of_saved_image(*saved, size_px),
                Finished::ImageCancelled(name) => {
                    let text = format!("{name}: saving cancelled; there is no such file");
                    self.log.say(Severity::Info, text, now);
                }
                Finished::Filmed(first, count) => self.tell_of_film(&first, count),
                Finished::FilmCancelled(count) => {
                    let text = format!("Rendering was cancelled; {count} pictures are there");
                    self.log.say(Severity::Info, text, now);
                }
                Finished::Failed(text) => self.log.error(text, now),
            }
        }
    }

    /// Renderers and plugins are listed anew when the stage opens, and when the scene or the device changes.
    fn refresh_rows(&mut self) {
        if self.stage.is_ready() {
            let now = (self.session.scene.revision(), self.stage.drawn_with());
            if self.rows_of.as_ref() != Some(&now) {
                self.rows_of = Some(now);
                self.stage.ask_for_rows(self.session.scene.clone());
            }
        }
        let Some(rows) = self.stage.take_rows() else {
            return;
        };
        self.tell_of_bad_plugins(&rows);
        let are_first = self.rows.renderers.is_empty();
        self.rows = rows;
        self.told_keys_of = None;
        if are_first {
            self.tell_of_missing_renderers();
        }
        if self
            .rows
            .renderer(&self.session.panes.active.renderer)
            .is_none()
            && let Some(first) = self.rows.first_suitable()
        {
            self.session.panes.active.renderer = first.id.clone();
        }
        self.screens.active.asking.invalidate();
    }

    /// Says once, when a renderer is chosen, which of the keys that it suggests it does not get.
    fn tell_of_conflicting_keys(&mut self) {
        if self.told_keys_of.as_ref() == Some(&self.session.panes.active.renderer) {
            return;
        }
        let Some(row) = self.rows.renderer(&self.session.panes.active.renderer) else {
            return;
        };
        let now = Instant::now();
        for sentence in actions::conflicts(row) {
            self.log.say(Severity::Warning, sentence, now);
        }
        self.told_keys_of = Some(self.session.panes.active.renderer.clone());
    }

    /// Says once which plugins the program goes without, and why.
    fn tell_of_bad_plugins(&mut self, rows: &Rows) {
        let now = Instant::now();
        if self.rows.culprits != rows.culprits {
            for text in &rows.culprits {
                let text =
                    format!("{text}. It is in quarantine; the Plugins tab can try it again.");
                self.log.error(text, now);
            }
        }
        // A culprit has been told of just now.
        let bad = rows
            .plugins
            .iter()
            .filter(|row| row.severity == Severity::Error && rows.culprits.is_empty());
        for row in bad.filter(|row| !self.rows.plugins.contains(row)) {
            self.log.add(row.notice(), now);
        }
    }

    /// Asks for the next pass only where something will have changed by then.
    fn schedule(&self, ctx: &Context, is_idle: bool) {
        if !is_idle {
            // What was applied after the interface was shown has to show.
            ctx.request_repaint();
        }
        if !self.tasks.open().is_empty() || self.is_preparing() {
            ctx.request_repaint_after(PROGRESS_PERIOD);
        }
        let now = Instant::now();
        let of_views = self
            .screens
            .iter()
            .filter_map(|screen| screen.next_change(now));
        if let Some(time) = self.log.next_change(now).into_iter().chain(of_views).min() {
            ctx.request_repaint_after(time);
        }
        if self.screens.iter().any(|screen| screen.picture.is_fading()) {
            ctx.request_repaint();
        }
    }

    /// Whether the pictures on the screen are the final ones of their looks, nothing is being loaded, moved or measured.
    fn is_at_rest(&self) -> bool {
        self.is_resting()
            && !self.navigator.is_moving()
            && !self.player.is_playing()
            && self.tasks.open().is_empty()
            && !self.comparing.is_measuring()
    }

    /// Names the scene in the window's title, as the system's list of windows shows it.
    fn set_title(&mut self, ctx: &Context) {
        let title = title_of(&self.session.scene);
        if self.title != title {
            ctx.send_viewport_cmd(ViewportCommand::Title(title.clone()));
            self.title = title;
        }
    }
}

/// Whether all objects that came are of files that were opened with those of `batch`, which the scene shows.
fn adds_to(batch: Option<Batch>, finished: &[Finished]) -> bool {
    let places = finished.iter().filter_map(|finished| match finished {
        Finished::Loaded(_, Place::New(batch, _)) => Some(*batch),
        _ => None,
    });
    let places: Vec<Batch> = places.collect();
    !places.is_empty() && places.iter().all(|of| Some(*of) == batch)
}

/// Files dropped since the last pass are opened, with Shift added.
fn take_dropped_files(ctx: &Context, out: &mut Intents) {
    let (files, adds): (Vec<PathBuf>, bool) = ctx.input(|input| {
        let files = input.raw.dropped_files.iter();
        let paths = files.map(|file| file.path().to_path_buf()).collect();
        (paths, input.modifiers.shift)
    });
    if !files.is_empty() {
        let mode = if adds {
            OpenMode::Add
        } else {
            OpenMode::Replace
        };
        out.push(FileIntent::Open(files, mode));
    }
}

/// The window's title: what is on the stage, then the program.
fn title_of(scene: &Scene) -> String {
    match scene.objects() {
        [] => "Pointstage".to_owned(),
        [object] => format!("{} – Pointstage", object.name),
        [first, others @ ..] => format!("{} and {} more – Pointstage", first.name, others.len()),
    }
}

impl eframe::App for App {
    fn ui(&mut self, ui: &mut Ui, _frame: &mut eframe::Frame) {
        self.pass(ui);
    }

    fn clear_color(&self, _visuals: &egui::Visuals) -> [f32; 4] {
        [0.0, 0.0, 0.0, 1.0]
    }
}
