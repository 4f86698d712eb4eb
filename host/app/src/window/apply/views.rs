//! Carries out intents about stored views.

use std::time::Instant;

use egui::{Context, Event, ViewportCommand};
use pointstage_engine::stage::Severity;
use pointstage_scene::{NearClipping, ViewRecord};

use crate::window::app::App;
use crate::window::intent::{Intents, SelectIntent, ViewsIntent};
use crate::window::thumbnail;
use crate::window::views::slot_key;

impl App {
    pub(super) fn apply_views(&mut self, ctx: &Context, intent: ViewsIntent) {
        match intent {
            ViewsIntent::Store(slot) => self.store(slot),
            ViewsIntent::Recall(slot) => self.recall(slot),
            ViewsIntent::Add => {
                let (record, thumbnail) = (self.view_record(), self.thumbnail());
                self.session.views.add(record, thumbnail);
            }
            ViewsIntent::RecallNamed(index) => {
                if let Some(view) = self.session.views.named.get(index) {
                    self.go_to(&view.record.clone());
                }
            }
            ViewsIntent::Rename(index, name) => self.session.views.rename(index, &name),
            ViewsIntent::Overwrite(index) => {
                let (record, thumbnail) = (self.view_record(), self.thumbnail());
                if let Some(view) = self.session.views.named.get_mut(index) {
                    (view.record, view.thumbnail) = (record, thumbnail);
                }
            }
            ViewsIntent::Delete(index) => {
                if index < self.session.views.named.len() {
                    self.session.views.named.remove(index);
                }
            }
            ViewsIntent::Shift(index, way) => self.session.views.shift(index, way),
            ViewsIntent::Copy => {
                ctx.copy_text(self.view_record().to_json());
                self.say("View copied: paste it into a file, a message or another window.");
            }
            ViewsIntent::AskPaste => ctx.send_viewport_cmd(ViewportCommand::RequestPaste),
            ViewsIntent::Paste(text) => match ViewRecord::from_json(&text) {
                Ok(record) => self.go_to(&record),
                Err(error) => {
                    let text = format!("The text on the clipboard is no view: {error}.");
                    self.log.error(text, Instant::now());
                }
            },
        }
    }

    fn store(&mut self, slot: usize) {
        let record = self.view_record();
        if let Some(kept) = self.session.views.slots.get_mut(slot) {
            *kept = Some(record);
            let key = slot_key(slot);
            self.say(format!("View {key} stored; {key} goes back to it."));
        }
    }

    fn recall(&mut self, slot: usize) {
        if let Some(Some(record)) = self.session.views.slots.get(slot).copied() {
            self.go_to(&record);
        } else {
            let key = slot_key(slot);
            self.say(format!("There is no view {key}; Ctrl+{key} stores one."));
        }
    }

    fn say(&mut self, text: impl Into<String>) {
        self.log.say(Severity::Info, text, Instant::now());
    }

    /// Flies to a view; its near plane stands where it did.
    pub(in crate::window) fn go_to(&mut self, record: &ViewRecord) {
        // A record out of a file was read field by field only.
        let record = match record.checked() {
            Ok(record) => record,
            Err(error) => {
                self.log.error(error.to_string(), Instant::now());
                return;
            }
        };
        let camera = record.camera();
        self.session.panes.active.near = NearClipping::of(&camera);
        let around = self.surroundings();
        self.navigator
            .fly_to(&mut self.session.panes.active.camera, camera, &around);
    }

    /// The present view.
    pub(in crate::window) fn view_record(&self) -> ViewRecord {
        let [width, height] = self
            .screens
            .active
            .viewport
            .map_or([1280, 720], |viewport| viewport.size_px);
        ViewRecord::new(self.session.panes.active.camera, width, height)
    }

    /// The picture on the screen, small; empty if there is none.
    fn thumbnail(&self) -> Vec<u8> {
        let shown = self.screens.active.shown.as_deref();
        shown.map_or_else(Vec::new, |shown| thumbnail::encode(&shown.picture))
    }
}

/// A text that is pasted while none is typed is taken for a view, but for the one that stands for copied surfels.
pub(in crate::window) fn take_pasted(ctx: &Context, surfels: &str, out: &mut Intents) {
    if ctx.text_edit_focused() {
        return;
    }
    let pasted = ctx.input(|input| {
        let mut texts = input.events.iter().filter_map(|event| match event {
            Event::Paste(text) => Some(text.clone()),
            _ => None,
        });
        texts.next_back()
    });
    if let Some(text) = pasted {
        if text == surfels {
            out.push(SelectIntent::Paste);
        } else {
            out.push(ViewsIntent::Paste(text));
        }
    }
}
