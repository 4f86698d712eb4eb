//! The window's program: what it holds, and one pass over it.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

use egui::{CentralPanel, Context, Frame, Panel, Ui};
use pointstage_engine::stage::{FrameResult, Severity, Show};
use pointstage_plugin_api::abi::Interaction;
use pointstage_scene::{ObjectId, Provenance, Revision};

use super::asking::Asking;
use super::dialogs::{FileDialog, PathField};
use super::intent::{Intent, Intents, OpenMode, Tab};
use super::loading::{Arrival, Batch, Finished, arrive};
use super::log::{Log, log_ui};
use super::menu::{Menu, menu_ui};
use super::navigation::CameraMove;
use super::picture::PictureTexture;
use super::rows::Rows;
use super::session::Session;
use super::settings::{self, lighting, plugins, renderer, scene, view};
use super::stage_link::{StageLink, legend_of};
use super::status::{Status, status_ui};
use super::tasks::Tasks;
use super::viewport::{Viewport, ViewportAnswer, viewport_ui};
use super::{help, legend, progress, shortcuts, toasts, welcome};

/// How often progress is shown while a task runs or a renderer is prepared.
const PROGRESS_PERIOD: Duration = Duration::from_millis(100);

/// Everything that the window holds.
pub(crate) struct App {
    pub(super) session: Session,
    pub(super) stage: StageLink,
    pub(super) rows: Rows,
    pub(super) tasks: Tasks<Finished>,
    pub(super) log: Log,
    pub(super) asking: Asking,
    pub(super) panels: Panels,
    pub(super) path_field: Option<PathField>,
    pub(super) dialog: Option<FileDialog>,
    pub(super) wake: Arc<dyn Fn() + Send + Sync>,
    /// The batch whose objects the scene holds.
    pub(super) shown_batch: Option<Batch>,
    pub(super) next_batch: u64,
    viewport: Option<ViewportAnswer>,
    picture: PictureTexture,
    shown: Option<Arc<FrameResult>>,
    samples: Vec<PathBuf>,
    rows_of: Option<Revision>,
    /// When a picture last came or was asked for.
    last_turn: Instant,
}

/// Which parts of the window are open.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Panels {
    pub(super) settings: bool,
    pub(super) log: bool,
    pub(super) keys: bool,
    pub(super) about: bool,
    pub(super) tab: Tab,
}

impl Default for Panels {
    fn default() -> Self {
        Self {
            settings: true,
            log: false,
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
            stage,
            rows: Rows::default(),
            tasks: Tasks::new(wake.clone())?,
            log: Log::default(),
            asking: Asking::default(),
            panels: Panels::default(),
            path_field: None,
            dialog: None,
            wake,
            shown_batch: None,
            next_batch: 0,
            viewport: None,
            picture: PictureTexture::default(),
            shown: None,
            samples,
            rows_of: None,
            last_turn: Instant::now(),
        };
        app.open(files, OpenMode::Replace);
        Ok(app)
    }

    /// One pass: what workers finished, the interface, what the user asked for, the next picture.
    pub(crate) fn pass(&mut self, ui: &mut Ui) {
        let ctx = ui.ctx().clone();
        self.take_finished_tasks();
        self.refresh_rows();
        let refine = self.take_new_picture(&ctx);
        let mut intents = Intents::new();
        shortcuts::read(&ctx, &mut intents);
        self.take_dropped_files(&ctx, &mut intents);
        self.show(ui, &mut intents);
        let is_idle = intents.is_empty();
        for intent in intents {
            self.apply(&ctx, intent);
        }
        self.ask_for_picture(&ctx, refine);
        self.schedule(&ctx, is_idle);
    }

    fn take_finished_tasks(&mut self) {
        let now = Instant::now();
        for finished in self.tasks.take_finished() {
            match finished {
                Finished::Loaded(loaded, place) => {
                    let arrival = arrive(
                        &mut self.session,
                        &mut self.shown_batch,
                        *loaded,
                        place,
                        &mut self.log,
                    );
                    if arrival == Arrival::First {
                        self.move_camera(CameraMove::Frame);
                    }
                }
                Finished::Cancelled(name) => {
                    tracing::info!("cancelled: {name}");
                    let text = format!("{name}: loading cancelled");
                    self.log.say(Severity::Info, text, now);
                }
                Finished::Failed(text) => self.log.error(text, now),
            }
        }
    }

    /// Renderers and plugins are listed anew when the stage opens and when the scene changes.
    fn refresh_rows(&mut self) {
        let revision = self.session.scene.revision();
        if self.rows_of != Some(revision) && self.stage.is_ready() {
            self.rows_of = Some(revision);
            self.stage.ask_for_rows(self.session.scene.clone());
        }
        let Some(rows) = self.stage.take_rows() else {
            return;
        };
        if self.rows.culprits != rows.culprits {
            for text in &rows.culprits {
                let text =
                    format!("{text}. It is in quarantine; the Plugins tab can try it again.");
                self.log.error(text, Instant::now());
            }
        }
        self.rows = rows;
        if self.rows.renderer(&self.session.renderer).is_none()
            && let Some(first) = self.rows.first_suitable()
        {
            self.session.renderer = first.id.clone();
        }
        self.asking.invalidate();
    }

    /// Takes over the newest picture. True if another one of the same look is due: the picture refines, or its renderer is
    /// still being prepared and it is time to look again.
    fn take_new_picture(&mut self, ctx: &Context) -> bool {
        let now = Instant::now();
        for notice in self.stage.take_notices() {
            self.log.add(notice, now);
        }
        let Some(result) = self.stage.take_new_picture() else {
            return self.is_preparing() && self.last_turn.elapsed() >= PROGRESS_PERIOD;
        };
        self.last_turn = Instant::now();
        let was = self.shown.as_ref().map(|shown| shown.drawn_by.clone());
        if was.as_ref() != Some(&result.drawn_by) {
            tracing::info!("drawn by {}", result.drawn_by);
        }
        self.picture.set(ctx, &result.picture);
        let refine = result.progress < 1.0 && result.preparing.is_none();
        self.shown = Some(result);
        refine
    }

    fn is_preparing(&self) -> bool {
        self.shown
            .as_ref()
            .is_some_and(|shown| shown.preparing.is_some())
    }

    fn take_dropped_files(&self, ctx: &Context, out: &mut Intents) {
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
            out.push(Intent::Open(files, mode));
        }
        if let Some(dialog) = &self.dialog {
            dialog.poll(out);
        }
    }

    fn show(&mut self, ui: &mut Ui, out: &mut Intents) {
        Panel::top("menu").show(ui, |ui| menu_ui(ui, &self.menu(), out));
        let adapter = self.stage.adapter();
        Panel::bottom("status").show(ui, |ui| status_ui(ui, &self.status(&adapter), out));
        if self.panels.log {
            Panel::bottom("log")
                .resizable(true)
                .default_size(180.0)
                .show(ui, |ui| log_ui(ui, &self.log, out));
        }
        if self.panels.settings {
            Panel::right("settings")
                .resizable(true)
                .default_size(360.0)
                .min_size(240.0)
                .show(ui, |ui| self.settings_ui(ui, out));
        }
        let viewport = Viewport {
            picture: self.picture.id(),
            is_transparent: self.picture.is_transparent(),
        };
        let answer = CentralPanel::default()
            .frame(Frame::NONE)
            .show(ui, |ui| viewport_ui(ui, &viewport, out))
            .inner;
        self.viewport = Some(answer);
        self.show_over(ui.ctx(), answer.rect, out);
    }

    /// What lies over the picture: legend, welcome, toasts, dialogs.
    fn show_over(&mut self, ctx: &Context, over: egui::Rect, out: &mut Intents) {
        let is_empty = self.session.scene.objects().is_empty();
        if is_empty && self.tasks.open().is_empty() {
            welcome::welcome_ui(ctx, over, &self.samples, out);
        }
        if self.session.view.show != Show::Colours
            && !is_empty
            && let Some(range) = self.shown.as_ref().map(|shown| shown.shown_range)
            && let Some(legend) = legend_of(&self.session.view.show, range)
        {
            legend::legend_ui(ctx, over, &legend);
        }
        progress::progress_ui(ctx, over, self.tasks.open(), out);
        toasts::toasts_ui(ctx, over, &self.log, out);
        welcome::drop_ui(ctx, over);
        if self.panels.keys {
            help::keys_ui(ctx, out);
        }
        if self.panels.about {
            help::about_ui(ctx, &self.stage.facts(), out);
        }
        if let Some(field) = &mut self.path_field
            && !field.ui(ctx, out)
        {
            self.path_field = None;
        }
    }

    fn menu(&self) -> Menu<'_> {
        Menu {
            renderers: &self.rows.renderers,
            chosen: &self.session.renderer,
            view: &self.session.view,
            camera: &self.session.camera,
            targets: self.targets(),
            is_settings_open: self.panels.settings,
            is_log_open: self.panels.log,
        }
    }

    fn status<'a>(&'a self, adapter: &'a str) -> Status<'a> {
        let shown = self.shown.as_deref();
        let drawn_by = shown.map(|shown| {
            let row = self.rows.renderer(&shown.drawn_by);
            row.map_or(shown.drawn_by.as_str(), |row| row.title.as_str())
        });
        Status {
            stats: shown.map(|shown| &shown.stats),
            drawn_by,
            preparing: shown.and_then(|shown| shown.preparing.as_ref()),
            refining: shown
                .map(|shown| shown.progress)
                .filter(|&progress| progress < 1.0),
            adapter,
            log: &self.log,
        }
    }

    fn settings_ui(&self, ui: &mut Ui, out: &mut Intents) {
        let session = &self.session;
        settings::tabs_ui(ui, self.panels.tab, out);
        match self.panels.tab {
            Tab::Renderer => {
                let tab = renderer::RendererTab {
                    renderers: &self.rows.renderers,
                    structures: &self.rows.structures,
                    chosen: &session.renderer,
                    chosen_structure: session.structure.as_deref(),
                    drawn_by: self.shown.as_ref().map(|shown| shown.drawn_by.as_str()),
                    values: &session.chosen_settings(),
                };
                renderer::renderer_ui(ui, &tab, out);
            }
            Tab::Lighting => lighting::lighting_ui(ui, &session.lights, out),
            Tab::View => {
                let tab = view::ViewTab {
                    view: &session.view,
                    camera: &session.camera,
                    targets: self.targets(),
                };
                view::view_ui(ui, &tab, out);
            }
            Tab::Scene => scene::scene_ui(ui, &session.scene, &session.warnings, out),
            Tab::Plugins => plugins::plugins_ui(ui, &self.rows.plugins, out),
        }
    }

    fn targets(&self) -> &[String] {
        let shown = self.shown.as_ref();
        shown.map_or(&[], |shown| shown.available_targets.as_slice())
    }

    fn ask_for_picture(&mut self, ctx: &Context, refine: bool) {
        let Some(ViewportAnswer {
            size_px,
            interaction,
            ..
        }) = self.viewport
        else {
            return;
        };
        if interaction == Interaction::MOVING {
            // The pass after the last move asks for the still picture.
            ctx.request_repaint();
        }
        // A renderer that cannot draw this scene stays chosen, and another one stands in; its row says why.
        let chosen = self.rows.renderer(&self.session.renderer);
        let drawing = chosen
            .filter(|row| row.obstacle.is_none())
            .or_else(|| self.rows.first_suitable());
        let Some(drawing) = drawing else { return };
        let request = self
            .asking
            .next(&self.session, &drawing.id, size_px, interaction, refine);
        if let Some(request) = request {
            self.last_turn = Instant::now();
            self.stage.submit(request);
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
        if let Some(time) = self.log.next_change(Instant::now()) {
            ctx.request_repaint_after(time);
        }
    }

    /// Moves the camera in the scene and viewport that are shown.
    pub(super) fn move_camera(&mut self, camera_move: CameraMove) {
        let bounds = self.session.scene.bounds_world();
        let aspect = self.viewport.map_or(1.5, |viewport| {
            f64::from(viewport.size_px[0]) / f64::from(viewport.size_px[1])
        });
        camera_move.apply(&mut self.session.camera, &bounds, aspect);
    }

    /// Objects that lack normals or radii, with the files to read them from again.
    pub(super) fn without_estimates(&self) -> Vec<(ObjectId, PathBuf)> {
        let objects = self.session.scene.objects().iter();
        objects
            .filter(|object| {
                let origins = &object.geometry.origins;
                origins.normals == Provenance::Missing || origins.radii == Provenance::Missing
            })
            .filter_map(|object| Some((object.id, object.source.clone()?)))
            .collect()
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
