//! Carries out intents about the history of changes.

use std::time::Instant;

use egui::Context;

use crate::window::app::App;
use crate::window::intent::EditIntent;

impl App {
    pub(super) fn apply_edit(&mut self, ctx: &Context, intent: EditIntent) {
        // What else this pass changed is a step of its own.
        self.note_history(ctx);
        let title = match intent {
            EditIntent::Undo => self.history.undo(&mut self.session),
            EditIntent::Redo => self.history.redo(&mut self.session),
        };
        self.match_screens();
        if let Some(title) = title {
            tracing::info!("{intent:?}: {title}");
        }
    }

    /// Looks whether this pass changed something that can be undone.
    pub(in crate::window) fn note_history(&mut self, ctx: &Context) {
        let is_held = ctx.input(|input| input.pointer.any_down());
        let (session, rows) = (&self.session, &self.rows);
        self.history.note(session, rows, is_held, Instant::now());
    }
}
