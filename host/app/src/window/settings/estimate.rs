//! Buttons that estimate columns anew, in the *Scene* tab.

use std::ops::RangeInclusive;

use egui::{DragValue, Ui};
use pointstage_scene::estimate::{NEIGHBOURS_RANGE, Steps};

use crate::window::actions::ESTIMATES;
use crate::window::intent::{Intents, SceneIntent};

const RANGE: RangeInclusive<usize> = NEIGHBOURS_RANGE;

/// One button a column, and how many neighbours they look at.
pub(super) fn estimate_ui(ui: &mut Ui, neighbours: usize, out: &mut Intents) {
    ui.horizontal_wrapped(|ui| {
        for (_, title, steps) in ESTIMATES {
            let hint = "Of the selected objects, or of all if none is selected; what they have is replaced";
            if ui.button(title).on_hover_text(hint).clicked() {
                out.push(SceneIntent::EstimateAnew(Steps {
                    neighbours,
                    ..steps
                }));
            }
        }
        let label = ui.label("with neighbours");
        let mut count = neighbours;
        let field = ui.add(DragValue::new(&mut count).range(RANGE));
        if field.labelled_by(label.id).changed() {
            out.push(SceneIntent::SetNeighbours(count));
        }
    });
}
