//! The views in the middle of the window: one alone, up to four beside each other, or two in one place.

use std::time::Instant;

use egui::{Color32, ComboBox, Rect, Sense, StrokeKind, Ui, UiBuilder, vec2};
use pointstage_engine::stage::Background;

use super::app::App;
use super::canvas;
use super::comparison::zoom::{paint_cross, paint_values, part_of};
use super::comparison::{
    Cell, Measure, Numbers, Way, borders, cells, split_at, unmet, wipe_handle_ui,
};
use super::gizmo::gizmo_ui;
use super::intent::{CompareIntent, Intents};
use super::picture::Layer;
use super::screen::Screen;
use super::selecting::paint_box;
use super::theme;
use super::viewport::{Viewport, ViewportAnswer, viewport_ui};

impl App {
    /// Shows the views on all that is left of `ui`.
    pub(super) fn views_ui(&mut self, ui: &mut Ui, out: &mut Intents) {
        self.match_zoom(ui.ctx());
        self.hide_unseen();
        let count = self.session.panes.count();
        let whole = ui.available_rect_before_wrap();
        ui.allocate_rect(whole, Sense::hover());
        let pair = self
            .session
            .comparison
            .pair(count, self.session.panes.active_index());
        match pair {
            Some(pair) if self.session.comparison.way.is_of_pair() => {
                self.pair_ui(ui, whole, pair, out);
            }
            Some(_) => self.grid_ui(ui, whole, count, out),
            None => {
                self.view_ui(ui, whole, 0, out);
            }
        }
        self.note_pointer();
    }

    /// Views that are not on the screen hold nothing there nor on the device.
    fn hide_unseen(&mut self) {
        let visible = self.visible_views();
        for (index, screen) in self.screens.iter_mut().enumerate() {
            if !visible.contains(&index) && screen.viewport.take().is_some() {
                screen.asking.invalidate();
                self.stage.close(screen.id);
            }
        }
    }

    /// Pixels are squares while they are enlarged, and smooth otherwise.
    fn match_zoom(&mut self, ctx: &egui::Context) {
        let is_zoomed = self.comparing.zoom.is_some();
        for screen in self.screens.iter_mut() {
            if let Some(shown) = &screen.shown {
                screen.picture.match_zoom(ctx, &shown.picture, is_zoomed);
            }
        }
    }

    /// Remembers over which place of its picture the pointer is; where it was last, while it is elsewhere.
    fn note_pointer(&mut self) {
        let zoom = self.comparing.zoom;
        let hovered = self.screens.iter().find_map(|screen| {
            let viewport = screen.viewport?;
            let part = part_of(viewport.rect, viewport.hovered_at?);
            Some(zoom.map_or(part, |zoom| zoom.part_at(part)))
        });
        if hovered.is_some() {
            self.comparing.pointer = hovered;
        }
    }

    /// Several views, each below its head; the borders between them can be dragged.
    fn grid_ui(&mut self, ui: &mut Ui, whole: Rect, count: usize, out: &mut Intents) {
        let split = self.session.comparison.split;
        ui.painter()
            .rect_filled(whole, 0.0, ui.visuals().panel_fill);
        let places = cells(whole, count, split);
        for (index, cell) in places.iter().enumerate() {
            self.cell_ui(ui, *cell, index, out);
        }
        if count == 3
            && let (Some(second), Some(third)) = (places.get(1), places.get(2))
        {
            let free = Rect::from_min_max(
                egui::pos2(second.picture.left(), third.head.top()),
                whole.max,
            );
            let mut ui = ui.new_child(UiBuilder::new().max_rect(free.shrink(8.0)).id_salt("free"));
            egui::ScrollArea::both().show(&mut ui, |ui| self.why_ui(ui));
        }
        if self.session.comparison.is_locked {
            return;
        }
        for (axis, border) in borders(whole, count, split) {
            let id = ui.scope_id().with(("border", axis));
            let cursor = [
                egui::CursorIcon::ResizeHorizontal,
                egui::CursorIcon::ResizeVertical,
            ][axis];
            let response = ui
                .interact(border.expand(2.0), id, Sense::drag())
                .on_hover_cursor(cursor);
            if let Some(at) = response
                .interact_pointer_pos()
                .filter(|_| response.dragged())
            {
                out.push(CompareIntent::Split(axis, split_at(whole, axis, at)));
            }
        }
    }

    fn cell_ui(&mut self, ui: &mut Ui, cell: Cell, index: usize, out: &mut Intents) {
        self.head_ui(ui, cell.head, index, out);
        self.view_ui(ui, cell.picture, index, out);
        if index == self.session.panes.active_index() {
            let colour = ui.visuals().selection.bg_fill;
            let all = cell.head.union(cell.picture);
            ui.painter()
                .rect_stroke(all, 0.0, (2.0, colour), StrokeKind::Inside);
        }
    }

    /// One view; what is asked for over it makes it the active one first.
    fn view_ui(&mut self, ui: &mut Ui, rect: Rect, index: usize, out: &mut Intents) {
        let now = Instant::now();
        let (zoom, cross) = (self.comparing.zoom, self.cross_for(index));
        let Some((pane, screen)) = self
            .session
            .panes
            .get(index)
            .zip(self.screens.get_mut(index))
        else {
            return;
        };
        let layers = screen.picture.layers(now);
        let viewport = Viewport {
            layers: &layers,
            background: seen_background(screen, pane.view.background),
            navigation: &self.session.navigation,
            is_moving: (self.navigator.is_moving() || self.player.is_playing())
                && index == self.session.panes.active_index(),
            zoom,
            tool: self.selecting.tool,
        };
        let mut ui = ui.new_child(UiBuilder::new().max_rect(rect).id_salt(("view", index)));
        let asked_before = out.len();
        let answer = viewport_ui(&mut ui, &viewport, out);
        let is_touched = out.len() > asked_before || answer.clicked_at.is_some();
        if is_touched && index != self.session.panes.active_index() {
            out.insert(asked_before, CompareIntent::Activate(index));
        }
        if let Some((zoom, shown)) = zoom.zip(screen.shown.as_deref()) {
            paint_values(&ui.painter_at(rect), rect, zoom, &shown.picture);
        }
        if let Some(at) = cross {
            paint_cross(&ui.painter_at(rect), rect, at);
        }
        screen.viewport = Some(answer);
        self.select_ui(&ui, answer, index, out);
        if self.session.navigation.gizmo && index == self.session.panes.active_index() {
            gizmo_ui(&mut ui, rect, &self.gizmo(), out);
        }
    }

    /// The crop box over a view, and what a tool draws there.
    fn select_ui(&mut self, ui: &Ui, answer: ViewportAnswer, index: usize, out: &mut Intents) {
        let (rect, zoom) = (answer.rect, self.comparing.zoom);
        let pane = self.session.panes.get(index);
        if let Some((crop_box, pane)) = self.selecting.crop_box.zip(pane) {
            paint_box(&ui.painter_at(rect), rect, zoom, &pane.camera, crop_box);
        }
        if let Some(response) = ui.ctx().read_response(answer.id) {
            self.selecting.follow(ui, rect, index, &response, zoom, out);
        }
    }

    /// Where the cross of the linked pointer goes in a view: in all but the one under the pointer.
    fn cross_for(&self, index: usize) -> Option<[f32; 2]> {
        let own = self.screens.get(index)?.viewport?;
        let is_elsewhere = self.screens.iter().enumerate().any(|(other, screen)| {
            let hovered = screen.viewport.and_then(|viewport| viewport.hovered_at);
            other != index && hovered.is_some()
        });
        let at = self.comparing.pointer.filter(|_| is_elsewhere)?;
        let seen = self.comparing.zoom.map_or(at, |zoom| {
            let whole = zoom.rect(own.rect);
            part_of(own.rect, whole.min + vec2(at[0], at[1]) * whole.size())
        });
        seen.iter()
            .all(|part| (0.0..=1.0).contains(part))
            .then_some(seen)
    }

    /// Two views in one place. Gestures turn the active one's camera.
    fn pair_ui(&mut self, ui: &mut Ui, whole: Rect, pair: [usize; 2], out: &mut Intents) {
        ui.painter()
            .rect_filled(whole, 0.0, ui.visuals().panel_fill);
        let heads = pair_heads(whole);
        for (head, index) in heads.into_iter().zip(pair) {
            self.head_ui(ui, head, index, out);
        }
        let top = heads[0].bottom();
        let view = Rect::from_min_max(egui::pos2(whole.left(), top), whole.max);
        let lead = self.lead_of(pair);
        let now = Instant::now();
        let (zoom, way) = (self.comparing.zoom, self.session.comparison.way);
        let viewport = Viewport {
            layers: &[],
            background: self.background_of(lead),
            navigation: &self.session.navigation,
            is_moving: self.navigator.is_moving() || self.player.is_playing(),
            zoom,
            tool: self.selecting.tool,
        };
        let mut ui = ui.new_child(UiBuilder::new().max_rect(view).id_salt("pair"));
        // The handle lies over the picture, so it is asked for the pointer before the picture is.
        let answer = viewport_ui(&mut ui, &viewport, out);
        for index in pair {
            let own = if index == lead {
                answer
            } else {
                answer.still()
            };
            if let Some(screen) = self.screens.get_mut(index) {
                screen.viewport = Some(own);
            }
        }
        match way {
            Way::Grid => {}
            Way::Wipe => {
                let x = view.left() + view.width() * self.comparing.wipe;
                let (left, right) = view.split_left_right_at_x(x);
                self.paint_view(&ui, view, left, pair[0], now);
                self.paint_view(&ui, view, right, pair[1], now);
                if let Some(to) = wipe_handle_ui(&mut ui, view, self.comparing.wipe) {
                    out.push(CompareIntent::Wipe(to));
                }
            }
            Way::Flicker => {
                let period = 1.0 / f64::from(self.session.comparison.flicker_hz.max(0.05));
                let time = ui.input(|input| input.time);
                let turn = (time / period).floor();
                self.paint_view(&ui, view, view, pair[turn as usize % 2], now);
                let rest = (turn + 1.0) * period - time;
                ui.ctx().request_repaint_after_secs(rest.max(0.001) as f32);
            }
            Way::Difference(measure) => self.difference_ui(&ui, view, pair, measure, now),
        }
        self.select_ui(&ui, answer, lead, out);
        if self.session.navigation.gizmo {
            gizmo_ui(&mut ui, view, &self.gizmo(), out);
        }
    }

    /// The view of a pair whose camera gestures turn.
    fn lead_of(&self, pair: [usize; 2]) -> usize {
        let active = self.session.panes.active_index();
        if pair.contains(&active) {
            active
        } else {
            pair[1]
        }
    }

    /// The difference, or why there is none yet.
    fn difference_ui(
        &mut self,
        ui: &Ui,
        view: Rect,
        pair: [usize; 2],
        measure: Measure,
        now: Instant,
    ) {
        let of = |index: usize| self.screens.get(index)?.shown.as_ref();
        let is_of_these = self.comparing.answer.as_ref().is_some_and(|answer| {
            let shown = pair.map(of);
            answer.is_of(measure, shown[0], shown[1])
        });
        let difference = self.comparing.difference.as_ref();
        if let Some(texture) = difference.filter(|_| is_of_these) {
            let layer = Layer {
                texture: texture.id(),
                size_px: texture.size().map(|side| side as u32),
                opacity: 1.0,
            };
            let painter = ui.painter_at(view);
            let black = Background::Solid([0.0; 3]);
            canvas::paint(&painter, view, black, &[layer], self.comparing.zoom);
            return;
        }
        self.paint_view(ui, view, view, pair[1], now);
        let text = if self.is_resting() && !self.comparing.is_measuring() {
            "Pictures of different sizes have no difference to show."
        } else {
            "The difference comes when both pictures rest."
        };
        paint_note(ui, view, text);
    }

    /// A view's picture, of which only `part` is seen.
    fn paint_view(&mut self, ui: &Ui, view: Rect, part: Rect, index: usize, now: Instant) {
        let (zoom, background) = (self.comparing.zoom, self.background_of(index));
        let Some(screen) = self.screens.get_mut(index) else {
            return;
        };
        let painter = ui.painter_at(view).with_clip_rect(part);
        let layers = screen.picture.layers(now);
        canvas::paint(&painter, view, background, &layers, zoom);
        if let Some((zoom, shown)) = zoom.zip(screen.shown.as_deref()) {
            paint_values(&painter, view, zoom, &shown.picture);
        }
    }

    /// What shows where a view's picture does not reach or is see-through.
    fn background_of(&self, index: usize) -> Background {
        let found = self.session.panes.get(index).zip(self.screens.get(index));
        found.map_or(Background::Transparent, |(pane, screen)| {
            seen_background(screen, pane.view.background)
        })
    }

    /// The line above a view: its number, its renderer, and how far it is from the reference.
    fn head_ui(&self, ui: &mut Ui, rect: Rect, index: usize, out: &mut Intents) {
        let Some((pane, screen)) = self.session.panes.get(index).zip(self.screens.get(index))
        else {
            return;
        };
        let comparison = &self.session.comparison;
        let is_reference = index == comparison.against;
        let builder = UiBuilder::new()
            .max_rect(rect.shrink2(vec2(6.0, 2.0)))
            .layout(egui::Layout::left_to_right(egui::Align::Center))
            .id_salt(("head", index));
        let mut ui = ui.new_child(builder);
        let ui = &mut ui;
        ui.set_clip_rect(rect);
        let number = ui
            .selectable_label(is_reference, format!("{}", index + 1))
            .on_hover_text(if is_reference {
                "The reference: the other views are measured against this one"
            } else {
                "Measure the other views against this one"
            });
        if number.clicked() {
            out.push(CompareIntent::Against(index));
        }
        let label = format!("Renderer of view {}", index + 1);
        let combo = ComboBox::from_id_salt(("renderer of view", index))
            .selected_text(self.rows.title(&pane.renderer))
            .show_ui(ui, |ui| {
                for row in &self.rows.renderers {
                    let is_chosen = row.id == pane.renderer;
                    let can = row.obstacle.is_none();
                    let choice =
                        ui.add_enabled(can, egui::Button::selectable(is_chosen, &row.title));
                    if choice.clicked() && !is_chosen {
                        out.push(CompareIntent::ChooseRenderer(index, row.id.clone()));
                        ui.close();
                    }
                }
            });
        ui.ctx()
            .accesskit_node_builder(combo.response.id, |node| node.set_label(label));
        let unmet = unmet(&self.session, &self.rows, index);
        if !unmet.is_empty() {
            let texts: Vec<&str> = unmet.iter().map(|unmet| unmet.0.as_str()).collect();
            let colour = theme::severity_color(ui, pointstage_engine::stage::Severity::Warning);
            let text = format!("⚠ {}", texts.join("; "));
            let label = egui::Label::new(egui::RichText::new(&text).color(colour)).truncate();
            ui.add(label)
                .on_hover_text("What of the fair comparison this renderer does not follow");
        }
        if let Some(shown) = &screen.shown {
            ui.weak(format!("{:.1} ms", shown.stats.total.as_secs_f64() * 1e3));
        }
        let numbers = self.comparing.numbers(screen.shown.as_ref());
        let text = if is_reference && comparison.measures {
            "reference".to_owned()
        } else {
            numbers.map(Numbers::in_words).unwrap_or_default()
        };
        let label = ui.add(egui::Label::new(text).truncate());
        ui.ctx().accesskit_node_builder(label.id, |node| {
            node.set_description(format!("Metrics of view {}", index + 1));
        });
    }

    /// Whether every view on the screen shows its final picture.
    pub(super) fn is_resting(&self) -> bool {
        let visible = self.visible_views();
        let mut screens = visible.iter().filter_map(|index| self.screens.get(*index));
        screens.all(Screen::is_at_rest)
    }
}

/// What shows where a picture does not reach or is see-through.
fn seen_background(screen: &Screen, background: Background) -> Background {
    if screen.picture.is_transparent() {
        Background::Transparent
    } else {
        background
    }
}

/// A sentence over the upper edge of a picture.
fn paint_note(ui: &Ui, view: Rect, text: &str) {
    let font = egui::TextStyle::Body.resolve(ui.style());
    let painter = ui.painter_at(view);
    let galley = painter.layout_no_wrap(text.to_owned(), font, Color32::WHITE);
    let middle = view.center_top() + vec2(0.0, 14.0 + galley.size().y / 2.0);
    let place = Rect::from_center_size(middle, galley.size() + vec2(16.0, 8.0));
    painter.rect_filled(place, 4.0, Color32::from_black_alpha(190));
    painter.galley(place.min + vec2(8.0, 4.0), galley, Color32::WHITE);
}

/// The heads of two views in one place: one half of the width each.
fn pair_heads(whole: Rect) -> [Rect; 2] {
    let places = cells(whole, 2, [0.5; 2]);
    [places[0].head, places[1].head]
}
