//! Panels about views beside each other: why they differ, what they cost, what is at one pixel, a sweep's curve.

use std::time::Instant;

use egui::{Rect, Ui, vec2};

use super::app::App;
use super::comparison::{Place, pixels_ui, sweep_ui, times_ui, why_rows};
use super::intent::{CompareIntent, ComparePart, Intents};

impl App {
    /// What the views do not have in common.
    pub(super) fn why_ui(&self, ui: &mut Ui) {
        let rows = why_rows(&self.session, &self.rows);
        ui.strong("Why do they differ?");
        if rows.is_empty() {
            ui.label("Renderers, values, look and camera are the same.");
            return;
        }
        let count = self.session.panes.count();
        let grid = egui::Grid::new("why").num_columns(count + 1).striped(true);
        grid.show(ui, |ui| {
            ui.label("");
            for number in 1..=count {
                ui.strong(number.to_string());
            }
            ui.end_row();
            for row in &rows {
                ui.label(&row.name);
                for value in &row.values {
                    match value {
                        Some(value) => ui.label(value),
                        None => ui.weak("–"),
                    };
                }
                ui.end_row();
            }
        });
    }

    /// Panels about the views, over them.
    pub(super) fn compare_panels_ui(&mut self, ctx: &egui::Context, over: Rect, out: &mut Intents) {
        let panels = self.comparing.panels;
        let count = self.visible_views().len() as f32;
        let panel = |title: &str,
                     part: ComparePart,
                     column_width: f32,
                     out: &mut Intents,
                     add: &mut dyn FnMut(&mut Ui)| {
            let mut is_open = true;
            let width = (110.0 + count * column_width).min(over.width() - 40.0);
            egui::Window::new(title)
                .open(&mut is_open)
                .default_pos(over.left_top() + vec2(16.0, 40.0))
                .default_width(width)
                .constrain_to(ctx.content_rect())
                .collapsible(false)
                .show(ctx, |ui| {
                    egui::ScrollArea::both()
                        .auto_shrink([false, true])
                        .max_height((over.height() - 120.0).max(120.0))
                        .show(ui, |ui| add(ui));
                });
            if !is_open {
                out.push(CompareIntent::Toggle(part));
            }
        };
        let visible = self.visible_views();
        if panels.why {
            panel(
                "Why do they differ",
                ComparePart::Why,
                0.0,
                out,
                &mut |ui| {
                    self.why_ui(ui);
                },
            );
        }
        if panels.times {
            panel("Frame times", ComparePart::Times, 300.0, out, &mut |ui| {
                let now = Instant::now();
                ui.horizontal_top(|ui| {
                    for index in &visible {
                        let Some(screen) = self.screens.get(*index) else {
                            continue;
                        };
                        ui.vertical(|ui| {
                            times_ui(ui, &self.title_of_view(*index), &screen.frame_log, now);
                        });
                    }
                });
            });
        }
        if panels.pixels {
            panel("Pixels", ComparePart::Pixels, 190.0, out, &mut |ui| {
                let places: Vec<_> = visible
                    .iter()
                    .filter_map(|index| {
                        Some(Place {
                            title: self.title_of_view(*index),
                            shown: self.screens.get(*index)?.shown.as_ref(),
                        })
                    })
                    .collect();
                let is_linked = self.session.comparison.is_linked;
                pixels_ui(
                    ui,
                    self.comparing.pointer,
                    &places,
                    &self.session.scene,
                    is_linked,
                );
            });
        }
        if let Some(sweep) = &self.comparing.sweep {
            let mut is_open = true;
            let applied = sweep.applied(&self.session, &self.rows);
            egui::Window::new("Sweep")
                .open(&mut is_open)
                .default_pos(over.left_top() + vec2(16.0, 48.0))
                .collapsible(false)
                .show(ctx, |ui| {
                    sweep_ui(ui, sweep, &self.rows, applied.as_deref(), out);
                });
            if !is_open {
                out.push(CompareIntent::CloseSweep);
            }
        }
    }

    /// A view's number and renderer.
    fn title_of_view(&self, index: usize) -> String {
        let renderer = self.session.panes.get(index);
        let title = renderer.map_or("", |pane| self.rows.title(&pane.renderer));
        format!("{}  {title}", index + 1)
    }
}
