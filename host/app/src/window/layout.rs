//! Where the parts of the window stand, and what each of them shows of the session.

use std::time::Instant;

use egui::{CentralPanel, Context, Frame, Panel, Ui};
use pointstage_engine::stage::{SettingValues, Show};

use super::actions::Action;
use super::app::App;
use super::comparison::{Way, difference_legend};
use super::facts::facts_at;
use super::gizmo::Gizmo;
use super::inspector::{self, pixel_at};
use super::intent::{InspectIntent, Intents, Tab};
use super::log::log_ui;
use super::menu::menu_ui;
use super::path::{FilmFacts, PathPanel, path_ui};
use super::save_image::{SaveFacts, SaveImage};
use super::selecting::{Tool, bar_ui, crop_ui};
use super::settings::{self, camera, compare, lighting, plugins, renderer, scene, view};
use super::stage_link::legend_of;
use super::status::{Numbers, Status, status_ui};
use super::viewport::{Clicks, ViewportAnswer};
use super::{help, legend, presets, progress, theme, toasts, welcome};

impl App {
    /// All parts around the picture, the picture, and what lies over it.
    pub(super) fn show(&mut self, ui: &mut Ui, actions: &[Action], out: &mut Intents) {
        Panel::top("menu").show(ui, |ui| menu_ui(ui, actions, out));
        let (adapter, no_device) = (self.stage.adapter(), self.stage.no_device());
        let numbers = self.numbers();
        Panel::bottom("status").show(ui, |ui| {
            status_ui(
                ui,
                &self.status(&adapter, no_device.as_deref(), numbers),
                out,
            );
        });
        if self.panels.log {
            Panel::bottom("log")
                .resizable(true)
                .default_size(180.0)
                .show(ui, |ui| log_ui(ui, &self.log, out));
        }
        if self.panels.path {
            Panel::bottom("path")
                .resizable(true)
                .default_size(200.0)
                .min_size(90.0)
                .show(ui, |ui| self.path_ui(ui, out));
        }
        if self.panels.settings {
            Panel::right("settings")
                .resizable(true)
                .default_size(360.0)
                .min_size(240.0)
                .show(ui, |ui| self.settings_ui(ui, out));
        }
        CentralPanel::default()
            .frame(Frame::NONE)
            .show(ui, |ui| self.views_ui(ui, out));
        let Some(answer) = self.screens.active.viewport else {
            return;
        };
        self.inspect_ui(ui.ctx(), answer, out);
        let [marked, _] = self.marked_counts();
        bar_ui(ui.ctx(), answer.rect, &self.selecting, marked, out);
        if let Some(crop_box) = self.selecting.crop_box {
            let bounds = self.scene_bounds();
            crop_ui(ui.ctx(), answer.rect, crop_box, bounds, out);
        }
        self.show_over(ui.ctx(), answer.rect, actions, out);
    }

    pub(super) fn gizmo(&self) -> Gizmo<'_> {
        Gizmo {
            camera: &self.session.panes.active.camera,
            lights: &self.session.panes.active.lights,
            up: self.navigator.level_axis(),
        }
    }

    /// What lies over the picture: legend, welcome, toasts, dialogs.
    fn show_over(
        &mut self,
        ctx: &Context,
        over: egui::Rect,
        actions: &[Action],
        out: &mut Intents,
    ) {
        let is_empty = self.session.scene.objects().is_empty();
        if is_empty && self.tasks.open().is_empty() {
            let welcome = welcome::Welcome {
                samples: &self.samples,
                recent: self.remembered.recent.paths(),
                missing: &self.remembered.missing,
            };
            welcome::welcome_ui(ctx, over, &welcome, out);
        }
        let is_difference = matches!(self.session.comparison.way, Way::Difference(_))
            && self.session.panes.count() > 1;
        if self.session.panes.active.view.show != Show::Colours
            && !is_difference
            && !is_empty
            && let Some(range) = self
                .screens
                .active
                .shown
                .as_ref()
                .map(|shown| shown.shown_range)
            && let Some(legend) = legend_of(&self.session.panes.active.view.show, range)
        {
            legend::legend_ui(ctx, over, &legend);
        }
        if let Some(legend) = difference_legend(self.session.comparison.way)
            .filter(|_| self.session.panes.count() > 1)
        {
            legend::legend_ui(ctx, over, &legend);
        }
        self.compare_panels_ui(ctx, over, out);
        let rows = self.long_work();
        progress::progress_ui(ctx, over, &rows, out);
        toasts::toasts_ui(ctx, over, &self.log, out);
        welcome::drop_ui(ctx, over);
        let renderer = self.rows.renderer(&self.session.panes.active.renderer);
        self.palette.ui(ctx, actions, renderer, out);
        if self.panels.keys {
            help::keys_ui(ctx, actions, out);
        }
        if self.panels.about {
            help::about_ui(ctx, &self.stage.facts(), out);
        }
        if let Some(dialog) = &mut self.save_image {
            let facts = SaveFacts {
                view_px: self
                    .screens
                    .active
                    .viewport
                    .map_or([1280, 720], |viewport| viewport.size_px),
                targets: self
                    .screens
                    .active
                    .shown
                    .as_ref()
                    .map_or(&[], |shown| shown.available_targets.as_slice()),
            };
            if !dialog.ui(ctx, &facts, out) {
                self.last_save_image = self.save_image.take().map(SaveImage::for_next_time);
            }
        }
        if let Some(mut dialog) = self.film_dialog.take() {
            let facts = FilmFacts {
                count: self.film_count(dialog.fps()),
            };
            if dialog.ui(ctx, &facts, out) {
                self.film_dialog = Some(dialog);
            }
        }
        if let Some(field) = &mut self.path_field
            && !field.ui(ctx, out)
        {
            self.path_field = None;
        }
        theme::focus_frame_ui(
            ctx,
            self.screens.active.viewport.map(|viewport| viewport.id),
        );
    }

    /// The strip of the camera path.
    fn path_ui(&self, ui: &mut Ui, out: &mut Intents) {
        let session = &self.session;
        let pane = &session.panes.active;
        let obstacle = self.film_obstacle();
        let panel = PathPanel {
            path: &session.path,
            time: self.player.time(),
            is_playing: self.player.is_playing(),
            views: &session.views,
            rows: &self.rows,
            renderer: &pane.renderer,
            structure: pane.structure.as_deref(),
            obstacle: obstacle.as_deref(),
        };
        path_ui(ui, &panel, out);
    }

    /// Why no pictures of the path can be rendered.
    pub(super) fn film_obstacle(&self) -> Option<String> {
        if self.session.scene.objects().is_empty() {
            return Some("there is nothing to see yet; open a file first".to_owned());
        }
        let is_empty = self.session.path.is_empty();
        is_empty.then(|| "the path is empty: add views, a turntable or settings".to_owned())
    }

    /// What is under the pointer, and what a click asks about it.
    fn inspect_ui(&mut self, ctx: &Context, answer: ViewportAnswer, out: &mut Intents) {
        let Some(shown) = self.screens.active.shown.clone() else {
            return;
        };
        let pixel = |at| {
            let rect = self
                .comparing
                .zoom
                .map_or(answer.rect, |zoom| zoom.rect(answer.rect));
            pixel_at(at, rect, answer.size_px, &shown)
        };
        // A click with the brush is a dab.
        if let Some((at, clicks)) = answer
            .clicked_at
            .filter(|_| self.selecting.tool != Tool::Brush)
            && let Some(pixel) = pixel(at)
        {
            out.push(match clicks {
                Clicks::One => InspectIntent::Pin(pixel),
                Clicks::Two => InspectIntent::PivotOn(pixel),
            });
        }
        let hovered = answer.hovered_at.and_then(pixel);
        let facts = hovered.and_then(|pixel| facts_at(&shown, &self.session.scene, pixel, 0));
        if let Some(facts) = &facts
            && !self.inspector.is_pinned()
        {
            inspector::hover_ui(ctx, answer.rect, facts);
        }
        if self.panels.inspector {
            let inspector = &self.inspector;
            inspector::inspector_ui(ctx, answer.rect, inspector, facts.as_ref(), out);
        }
    }

    /// What runs or waits.
    fn long_work(&mut self) -> Vec<progress::Row> {
        let preparing = self
            .screens
            .active
            .shown
            .as_ref()
            .and_then(|shown| shown.preparing.as_ref());
        let preparing = preparing.map(|preparing| (preparing, self.rows.title(&preparing.id)));
        self.progress
            .rows(self.tasks.open(), preparing, Instant::now())
    }

    /// What the status bar measures over some time.
    fn numbers(&mut self) -> Numbers {
        let now = Instant::now();
        Numbers {
            frames: self.screens.active.frame_times.summary(now),
            resident_bytes: self.memory.resident_bytes(now),
        }
    }

    fn status<'a>(
        &'a self,
        adapter: &'a str,
        no_device: Option<&'a str>,
        numbers: Numbers,
    ) -> Status<'a> {
        let shown = self.screens.active.shown.as_deref();
        let drawn_by = shown.map(|shown| {
            let row = self.rows.renderer(&shown.drawn_by);
            row.map_or(shown.drawn_by.as_str(), |row| row.title.as_str())
        });
        Status {
            marked: self.marked_counts(),
            stats: shown.map(|shown| &shown.stats),
            numbers,
            hand_over: self.screens.active.roles.hand_over(),
            preview_held: self.screens.active.roles.is_held()
                && self.session.panes.active.preview.is_some(),
            drawn_by,
            preparing: shown.and_then(|shown| shown.preparing.as_ref()),
            refining: shown
                .map(|shown| shown.progress)
                .filter(|&progress| progress < 1.0),
            adapter,
            no_device,
            log: &self.log,
        }
    }

    /// The settings panel with its chosen tab.
    fn settings_ui(&mut self, ui: &mut Ui, out: &mut Intents) {
        let focus = self.focus_setting.take();
        let session = &self.session;
        settings::tabs_ui(ui, self.panels.tab, out);
        match self.panels.tab {
            Tab::Renderer => {
                let structure = session.panes.active.structure.as_deref();
                let tab = renderer::RendererTab {
                    rows: &self.rows,
                    chosen: &session.panes.active.renderer,
                    preview: session.panes.active.preview.as_deref(),
                    chosen_structure: session.panes.active.structure.as_deref(),
                    drawn_by: self
                        .screens
                        .active
                        .shown
                        .as_ref()
                        .map(|shown| shown.drawn_by.as_str()),
                    values: &session.chosen_settings(),
                    structure_values: &structure
                        .map_or_else(SettingValues::new, |id| session.settings_of(id)),
                    presets: &presets::list(session, &session.panes.active.renderer),
                    focus: focus.as_deref(),
                };
                renderer::renderer_ui(ui, &tab, out);
            }
            Tab::Lighting => {
                let tab = lighting::LightingTab {
                    lights: &session.panes.active.lights,
                    scene: &session.scene,
                    material: session.material,
                };
                lighting::lighting_ui(ui, &tab, out);
            }
            Tab::View => {
                let range = self
                    .screens
                    .active
                    .shown
                    .as_ref()
                    .and_then(|shown| shown.shown_range);
                let legend = legend_of(&session.panes.active.view.show, range);
                let tab = view::ViewTab {
                    view: &session.panes.active.view,
                    pacing: session.pacing,
                    camera: camera::CameraTab {
                        camera: &session.panes.active.camera,
                        near: session.panes.active.near,
                        bounds: session.scene.bounds_world(),
                        options: &session.navigation,
                    },
                    views: &session.views,
                    targets: self.targets(),
                    legend: legend.as_ref(),
                };
                view::view_ui(ui, &tab, out);
            }
            Tab::Compare => {
                let tab = compare::CompareTab {
                    comparison: &session.comparison,
                    count: session.panes.count(),
                    active: session.panes.active_index(),
                    panels: self.comparing.panels,
                    is_zoomed: self.comparing.zoom.is_some(),
                };
                compare::compare_ui(ui, &tab, out);
            }
            Tab::Scene => {
                let tab = scene::SceneTab {
                    scene: &session.scene,
                    warnings: &session.warnings,
                    active: session.active_object(),
                    material: session.material,
                    neighbours: session.neighbours,
                };
                scene::scene_ui(ui, &tab, out);
            }
            Tab::Plugins => {
                let tab = plugins::PluginsTab {
                    rows: &self.rows,
                    holdings: &self.stage.holdings(),
                };
                plugins::plugins_ui(ui, &tab, out);
            }
        }
    }

    /// Targets that the renderer of the picture writes.
    pub(super) fn targets(&self) -> &[String] {
        let shown = self.screens.active.shown.as_ref();
        shown.map_or(&[], |shown| shown.available_targets.as_slice())
    }
}
