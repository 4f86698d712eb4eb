//! Carries out intents about views beside each other.

use std::path::Path;
use std::time::Instant;

use pointstage_engine::stage::Severity;

use crate::window::app::App;
use crate::window::comparison::{SweepPanel, Zoom};
use crate::window::intent::{CompareIntent, ComparePart, RendererIntent};
use crate::window::screen::Screen;
use crate::window::several::MOST_VIEWS;

impl App {
    pub(super) fn apply_compare(&mut self, intent: CompareIntent) {
        let comparison = &mut self.session.comparison;
        match intent {
            CompareIntent::Count(count) => self.set_view_count(count),
            CompareIntent::Activate(index) => self.activate(index),
            CompareIntent::ActivateNext => {
                let next = (self.session.panes.active_index() + 1) % self.session.panes.count();
                self.activate(next);
            }
            CompareIntent::ChooseRenderer(index, id) => {
                self.activate(index);
                self.apply_renderer(RendererIntent::Choose(id));
            }
            CompareIntent::Link(is_linked) => comparison.is_linked = is_linked,
            CompareIntent::Lock(is_locked) => comparison.is_locked = is_locked,
            CompareIntent::Way(way) => comparison.way = way,
            CompareIntent::Against(index) => comparison.against = index,
            CompareIntent::Measure(measures) => comparison.measures = measures,
            CompareIntent::Flicker(rate) => comparison.flicker_hz = rate,
            CompareIntent::Split(axis, part) => {
                // Under the lock all views have one size.
                if let Some(split) = comparison
                    .split
                    .get_mut(axis)
                    .filter(|_| !comparison.is_locked)
                {
                    *split = part;
                }
            }
            CompareIntent::Wipe(wipe) => self.comparing.wipe = wipe,
            CompareIntent::Zoom(by, around) => {
                self.zoom_pixels(|zoom| Zoom::changed(zoom, by, around));
            }
            CompareIntent::ShiftZoom(by) => self.zoom_pixels(|zoom| Some(zoom?.moved(by))),
            CompareIntent::ZoomOut => self.zoom_pixels(|_| None),
            CompareIntent::Toggle(part) => {
                let panels = &mut self.comparing.panels;
                let is_open = match part {
                    ComparePart::Times => &mut panels.times,
                    ComparePart::Why => &mut panels.why,
                    ComparePart::Pixels => &mut panels.pixels,
                };
                *is_open = !*is_open;
            }
            CompareIntent::CloseSweep => self.comparing.sweep = None,
            CompareIntent::ApplySweep {
                renderer,
                setting,
                value,
            } => self.apply_sweep(renderer, setting, &value),
        }
    }

    /// Shows the curve of a `sweep.json`.
    pub(in crate::window) fn open_sweep(&mut self, path: &Path) {
        match SweepPanel::read(path) {
            Ok(panel) => self.comparing.sweep = Some(panel),
            Err(error) => self.log.error(error, Instant::now()),
        }
    }

    /// Makes a view the active one. What its camera does by itself ends with the change.
    pub(in crate::window) fn activate(&mut self, index: usize) {
        if index == self.session.panes.active_index() || index >= self.session.panes.count() {
            return;
        }
        let around = self.surroundings();
        self.navigator
            .stop(&mut self.session.panes.active.camera, &around);
        self.inspector.unpin();
        // The camera that all views share has to be the one where the stop left it.
        self.follow_active();
        self.session.panes.activate(index);
        self.screens.activate(index);
    }

    /// New views begin as the active one is; of fewer the first stay.
    pub(in crate::window) fn set_view_count(&mut self, count: usize) {
        let count = count.clamp(1, MOST_VIEWS);
        while self.session.panes.count() < count {
            let pane = self.session.panes.active.clone();
            self.session.panes.push(pane);
        }
        self.session.panes.truncate(count);
        self.match_screens();
    }

    /// Gives every view of the session its place on the screen.
    pub(in crate::window) fn match_screens(&mut self) {
        let count = self.session.panes.count();
        while self.screens.count() < count {
            let name = self.comparing.name_screen();
            self.screens.push(Screen::new(name));
        }
        self.screens.activate(self.session.panes.active_index());
        for gone in self.screens.truncate(count) {
            self.stage.close(gone.id);
        }
        let comparison = &mut self.session.comparison;
        comparison.against = comparison.against.min(count - 1);
    }

    /// Changes what part of the pictures is enlarged, and shows pixels as squares while any is.
    fn zoom_pixels(&mut self, change: impl FnOnce(Option<Zoom>) -> Option<Zoom>) {
        self.comparing.zoom = change(self.comparing.zoom);
    }

    fn apply_sweep(&mut self, renderer: String, setting: String, value: &str) {
        let row = self.rows.renderer(&renderer);
        let schema = row.and_then(|row| row.settings.iter().find(|schema| schema.id == setting));
        let Some(schema) = schema else {
            let text = format!(
                "{renderer} has no setting '{setting}' any more; sweep again with this build."
            );
            return self.log.say(Severity::Warning, text, Instant::now());
        };
        match schema.parse_text(value) {
            Ok(value) => {
                self.apply_renderer(RendererIntent::Choose(renderer));
                self.apply_renderer(RendererIntent::Set(setting, value));
            }
            Err(error) => self.log.error(error.to_string(), Instant::now()),
        }
    }
}
