//! The part of the *View* tab that says how often pictures are drawn, and how long moving ones may take.

use egui::{Slider, Ui};

use crate::window::intent::{Intents, ViewIntent};
use crate::window::pacing::{FASTEST_RATE, Pacing};

/// The rate that a switched-on limit or target begins with, pictures a second.
const FIRST_RATE: u32 = 30;

/// Limit, target and fade.
pub(crate) fn pacing_ui(ui: &mut Ui, pacing: Pacing, out: &mut Intents) {
    let mut edited = pacing;
    rate_ui(
        ui,
        "Rate limit",
        "Most pictures a second; at 0 a picture is drawn only when you ask for it (F5)",
        &mut edited.rate_limit,
        0,
    );
    rate_ui(
        ui,
        "Target rate",
        "Pictures a second while something moves: if the renderer is slower, moving pictures are drawn with fewer pixels",
        &mut edited.target_rate,
        1,
    );
    super::row(
        ui,
        "Cross-fade",
        "Whether the main renderer's picture fades in when it takes over from the preview",
        |ui| {
            ui.checkbox(&mut edited.cross_fade, "");
        },
    );
    if edited != pacing {
        out.push(ViewIntent::Pace(edited));
    }
}

/// A rate that can be switched off.
fn rate_ui(ui: &mut Ui, label: &str, help: &str, rate: &mut Option<u32>, least: u32) {
    super::row(ui, label, help, |ui| {
        let mut is_on = rate.is_some();
        let before = ui.available_width();
        if ui.checkbox(&mut is_on, "").changed() {
            *rate = is_on.then_some(FIRST_RATE);
        }
        let taken = before - ui.available_width();
        super::set_slider_width(ui, ui.spacing().slider_width - taken);
        match rate {
            Some(rate) => {
                let slider = Slider::new(rate, least..=FASTEST_RATE).suffix("/s");
                ui.add(slider)
                    .accessible_name(format!("{label}, pictures a second"));
            }
            None => {
                ui.weak("off");
            }
        }
    });
}
