//! Where the parts of the window stand, and what each of them shows of the session.

use egui::{CentralPanel, Context, Frame, Panel, Ui};
use pointstage_engine::stage::Show;

use super::actions::Action;
use super::app::App;
use super::intent::{Intents, Tab};
use super::log::log_ui;
use super::menu::menu_ui;
use super::save_image::{SaveFacts, SaveImage};
use super::settings::{self, lighting, plugins, renderer, scene, view};
use super::stage_link::legend_of;
use super::status::{Status, status_ui};
use super::viewport::{Viewport, viewport_ui};
use super::{help, legend, progress, toasts, welcome};

impl App {
    /// All parts around the picture, the picture, and what lies over it.
    pub(super) fn show(&mut self, ui: &mut Ui, actions: &[Action], out: &mut Intents) {
        Panel::top("menu").show(ui, |ui| menu_ui(ui, actions, out));
        let (adapter, no_device) = (self.stage.adapter(), self.stage.no_device());
        Panel::bottom("status").show(ui, |ui| {
            status_ui(ui, &self.status(&adapter, no_device.as_deref()), out);
        });
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
        self.show_over(ui.ctx(), answer.rect, actions, out);
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
            help::keys_ui(ctx, actions, out);
        }
        if self.panels.about {
            help::about_ui(ctx, &self.stage.facts(), out);
        }
        if let Some(dialog) = &mut self.save_image {
            let facts = SaveFacts {
                view_px: self
                    .viewport
                    .map_or([1280, 720], |viewport| viewport.size_px),
                targets: self
                    .shown
                    .as_ref()
                    .map_or(&[], |shown| shown.available_targets.as_slice()),
            };
            if !dialog.ui(ctx, &facts, out) {
                self.last_save_image = self.save_image.take().map(SaveImage::for_next_time);
            }
        }
        if let Some(field) = &mut self.path_field
            && !field.ui(ctx, out)
        {
            self.path_field = None;
        }
    }

    fn status<'a>(&'a self, adapter: &'a str, no_device: Option<&'a str>) -> Status<'a> {
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
            no_device,
            log: &self.log,
        }
    }

    /// The settings panel with its chosen tab.
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

    /// Targets that the renderer of the picture writes.
    pub(super) fn targets(&self) -> &[String] {
        let shown = self.shown.as_ref();
        shown.map_or(&[], |shown| shown.available_targets.as_slice())
    }
}
