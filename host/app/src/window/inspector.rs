//! What is under the pointer: hover says it in a line, a click keeps the surfel and lists all that is known of it.

use egui::{Align2, Area, Context, Frame, Grid, Id, Order, Rect, ScrollArea, Window, pos2, vec2};
use pointstage_engine::stage::FrameResult;
use pointstage_scene::Scene;

use super::facts::{Facts, facts_at, target_values};
use super::intent::{InspectIntent, Intents, Part, WindowIntent};

/// Targets without which nothing is known of a pixel.
const NEEDED: [&str; 2] = ["id", "depth"];

/// A click may miss a small splat by this much, px.
pub(crate) const REACH_PX: u32 = 4;

/// What is inspected.
#[derive(Debug, Default)]
pub(crate) struct Inspector {
    pinned: Option<Pinned>,
}

/// A surfel that a click keeps.
#[derive(Clone, Debug, PartialEq)]
struct Pinned {
    pixel: [u32; 2],
    facts: Facts,
    /// Values of every target at the pixel, once a picture with them has come.
    targets: Option<Vec<(String, String)>>,
}

impl Inspector {
    /// Targets to read back with a still picture: those that picking needs, or all while something is inspected.
    pub(crate) fn read_back(&self, is_open: bool, available: &[String]) -> Vec<String> {
        if is_open || self.pinned.is_some() {
            return available.to_vec();
        }
        let needed = NEEDED.map(str::to_owned);
        needed
            .into_iter()
            .filter(|key| available.contains(key))
            .collect()
    }

    /// Keeps what is at a pixel of the picture, or lets go if nothing is. True if something is kept.
    pub(crate) fn pin(&mut self, pixel: [u32; 2], shown: &FrameResult, scene: &Scene) -> bool {
        let facts = facts_at(shown, scene, pixel, REACH_PX);
        self.pinned = facts.map(|facts| Pinned {
            pixel: facts.pixel,
            facts,
            targets: None,
        });
        self.learn(shown);
        self.pinned.is_some()
    }

    /// Lets go of what is kept.
    pub(crate) fn unpin(&mut self) {
        self.pinned = None;
    }

    /// Whether a surfel is kept.
    pub(crate) fn is_pinned(&self) -> bool {
        self.pinned.is_some()
    }

    /// Name of the object and number of the surfel that is kept.
    pub(crate) fn pinned_surfel(&self) -> Option<(&str, Option<u64>)> {
        let facts = &self.pinned.as_ref()?.facts;
        Some((&facts.object, facts.surfel))
    }

    /// Takes the targets' values at the kept pixel from a picture, the first time that it brings them all.
    pub(crate) fn learn(&mut self, shown: &FrameResult) {
        let Some(pinned) = self
            .pinned
            .as_mut()
            .filter(|pinned| pinned.targets.is_none())
        else {
            return;
        };
        let has_all = shown
            .available_targets
            .iter()
            .all(|key| shown.planes.contains_key(key));
        // The camera may have moved on: then the pixel shows something else.
        let is_same = shown
            .pick(pinned.pixel.map(i64::from), 0)
            .is_some_and(|pick| pick.id == pinned.facts.id);
        if has_all && is_same {
            pinned.targets = Some(target_values(shown, pinned.pixel));
        }
    }
}

/// The pixel of the picture under a place of the window; `None` outside, or while the picture has another size.
pub(crate) fn pixel_at(
    at: egui::Pos2,
    rect: Rect,
    size_px: [u32; 2],
    shown: &FrameResult,
) -> Option<[u32; 2]> {
    if shown.picture.size_px != size_px || !rect.contains(at) {
        return None;
    }
    let part = (at - rect.min) / rect.size();
    let pixel = |part: f32, size: u32| ((part * size as f32) as u32).min(size.saturating_sub(1));
    Some([pixel(part.x, size_px[0]), pixel(part.y, size_px[1])])
}

/// One line about what is under the pointer, at the upper edge of `over`.
pub(crate) fn hover_ui(ctx: &Context, over: Rect, facts: &Facts) {
    Area::new(Id::unique("hover"))
        .order(Order::Middle)
        .pivot(Align2::CENTER_TOP)
        .fixed_pos(pos2(over.center().x, over.top() + 8.0))
        .interactable(false)
        .show(ctx, |ui| {
            Frame::popup(ui.style()).show(ui, |ui| {
                ui.set_max_width(over.width() - 24.0);
                let line = ui.label(facts.line());
                ui.ctx().accesskit_node_builder(line.id, |node| {
                    node.set_description("Under the pointer");
                });
            });
        });
}

/// The panel with everything: of the kept surfel, or of what is under the pointer.
pub(crate) fn inspector_ui(
    ctx: &Context,
    over: Rect,
    inspector: &Inspector,
    hovered: Option<&Facts>,
    out: &mut Intents,
) {
    let mut is_open = true;
    let pinned = inspector.pinned.as_ref();
    Window::new("Inspector")
        .open(&mut is_open)
        .default_pos(over.left_top() + vec2(12.0, 44.0))
        .default_width(300.0)
        .collapsible(false)
        .show(ctx, |ui| {
            let Some(facts) = pinned.map(|pinned| &pinned.facts).or(hovered) else {
                ui.weak("Point at a surface; a click keeps what is there.");
                return;
            };
            ui.horizontal(|ui| {
                ui.strong(facts.title());
                if pinned.is_some() && ui.small_button("Let go").clicked() {
                    out.push(InspectIntent::Unpin);
                }
                let targets = pinned.and_then(|pinned| pinned.targets.as_deref());
                if ui.small_button("Copy").clicked() {
                    out.push(WindowIntent::Copy(as_text(
                        facts,
                        targets.unwrap_or_default(),
                    )));
                }
            });
            let height = (over.height() - 140.0).max(80.0);
            ScrollArea::vertical().max_height(height).show(ui, |ui| {
                rows_ui(ui, "columns", &facts.columns);
                let Some(pinned) = pinned else { return };
                ui.add_space(6.0);
                let [x, y] = pinned.pixel;
                ui.strong(format!("Targets at pixel {x}, {y}"));
                match &pinned.targets {
                    Some(targets) => rows_ui(ui, "targets", targets),
                    None => {
                        ui.weak("They come with the next still picture from here.");
                    }
                }
            });
        });
    if !is_open {
        out.push(InspectIntent::Unpin);
        out.push(WindowIntent::Toggle(Part::Inspector));
    }
}

fn rows_ui(ui: &mut egui::Ui, id: &str, rows: &[(String, String)]) {
    Grid::new(id).num_columns(2).striped(true).show(ui, |ui| {
        for (name, value) in rows {
            ui.label(name);
            ui.monospace(value);
            ui.end_row();
        }
    });
}

fn as_text(facts: &Facts, targets: &[(String, String)]) -> String {
    let rows = facts.columns.iter().chain(targets);
    let lines = rows.map(|(name, value)| format!("{name}: {value}\n"));
    let mut text = facts.title() + "\n";
    text.extend(lines);
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::window::test_frames::frame_of_square;

    #[test]
    fn a_click_keeps_the_surfel_and_lists_its_columns() {
        let (scene, shown) = frame_of_square(&["id", "depth"]);
        let mut inspector = Inspector::default();
        let [width, height] = shown.picture.size_px;
        assert!(inspector.pin([width / 2, height / 2], &shown, &scene));
        let (object, surfel) = inspector.pinned_surfel().expect("it is kept");
        assert_eq!(object, "square");
        assert!(surfel.is_some_and(|surfel| surfel < 4), "{surfel:?}");
        assert!(!inspector.pin([0, 0], &shown, &scene), "the background");
        assert!(!inspector.is_pinned());
    }

    #[test]
    fn every_target_is_read_back_while_something_is_kept_and_its_values_stay() {
        let (scene, shown) = frame_of_square(&["id", "depth"]);
        let mut inspector = Inspector::default();
        let available = &shown.available_targets;
        assert_eq!(inspector.read_back(false, available), ["id", "depth"]);
        let [width, height] = shown.picture.size_px;
        inspector.pin([width / 2, height / 2], &shown, &scene);
        assert_eq!(inspector.read_back(false, available), *available);
        let targets = |inspector: &Inspector| {
            let pinned = inspector.pinned.as_ref();
            pinned.and_then(|pinned| pinned.targets.clone())
        };
        assert_eq!(targets(&inspector), None);
        let keys: Vec<&str> = available.iter().map(String::as_str).collect();
        let (_, with_all) = frame_of_square(&keys);
        inspector.learn(&with_all);
        let names: Vec<String> = targets(&inspector)
            .expect("all came")
            .into_iter()
            .map(|(name, _)| name)
            .collect();
        assert_eq!(names.len(), available.len(), "{names:?}");
    }

    #[test]
    fn the_pixel_under_the_pointer_is_found_at_every_scale() {
        let (_, shown) = frame_of_square(&[]);
        let size_px = shown.picture.size_px;
        let [width, height] = size_px.map(|side| side as f32);
        for scale in [1.0, 2.0] {
            let size = vec2(width, height) / scale;
            let rect = Rect::from_min_size(pos2(30.0, 40.0), size);
            let at = |x: f32, y: f32| {
                pixel_at(pos2(30.0, 40.0) + vec2(x, y) / scale, rect, size_px, &shown)
            };
            assert_eq!(at(0.5, 0.5), Some([0, 0]));
            assert_eq!(at(7.5, 3.5), Some([7, 3]));
            assert_eq!(at(-1.0, 3.5), None);
        }
        let rect = Rect::from_min_size(pos2(0.0, 0.0), vec2(10.0, 10.0));
        assert_eq!(pixel_at(pos2(1.0, 1.0), rect, [10, 10], &shown), None);
    }
}
