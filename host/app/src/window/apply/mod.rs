//! Carries out what the user asked for: one file an area, as the intents are.

mod camera;
mod compare;
mod edit;
mod estimate;
mod export;
mod file;
mod inspect;
mod light;
mod objects;
mod path;
mod plugins;
mod renderer;
mod save_object;
mod scene;
mod select;
mod view;
mod views;
mod window;

use egui::Context;

use super::app::App;
use super::intent::Intent;

pub(super) use estimate::Estimated;
pub(super) use save_object::ObjectSaved;
pub(super) use views::take_pasted;

impl App {
    /// Carries out one intent.
    pub(super) fn apply(&mut self, ctx: &Context, intent: Intent) {
        tracing::debug!(?intent);
        match intent {
            Intent::File(intent) => self.apply_file(ctx, intent),
            Intent::Edit(intent) => self.apply_edit(ctx, intent),
            Intent::Renderer(intent) => self.apply_renderer(intent),
            Intent::Camera(intent) => self.apply_camera(intent),
            Intent::Path(intent) => self.apply_path(ctx, intent),
            Intent::Compare(intent) => self.apply_compare(intent),
            Intent::Views(intent) => self.apply_views(ctx, intent),
            Intent::Light(intent) => self.apply_light(intent),
            Intent::View(intent) => self.apply_view(intent),
            Intent::Scene(intent) => self.apply_scene(intent),
            Intent::Select(intent) => self.apply_select(intent),
            Intent::Plugins(intent) => self.apply_plugins(intent),
            Intent::Export(intent) => self.apply_export(intent),
            Intent::Inspect(intent) => self.apply_inspect(intent),
            Intent::Window(intent) => self.apply_window(ctx, intent),
        }
    }
}
