//! The *Compare* tab: how many views there are, what they share, and how they are laid over each other.

use egui::{ComboBox, Slider, SliderClamping, Ui};

use crate::window::comparison::{ComparePanels, Comparison, FLICKER_HZ, Way};
use crate::window::intent::{CompareIntent, ComparePart, Intents};
use crate::window::several::MOST_VIEWS;

/// What the tab shows.
pub(crate) struct CompareTab<'a> {
    /// What was chosen.
    pub(crate) comparison: &'a Comparison,
    /// How many views there are.
    pub(crate) count: usize,
    /// The view that panels act on, from 0.
    pub(crate) active: usize,
    /// Which panels are open.
    pub(crate) panels: ComparePanels,
    /// Whether pixels are enlarged.
    pub(crate) is_zoomed: bool,
}

/// The tab.
pub(crate) fn compare_ui(ui: &mut Ui, tab: &CompareTab<'_>, out: &mut Intents) {
    super::tab_ui(ui, |ui| {
        ui.strong("Views");
        super::row(
            ui,
            "How many",
            "Each view has a renderer and settings of its own",
            |ui| {
                for count in 1..=MOST_VIEWS {
                    let choice = ui.selectable_label(tab.count == count, count.to_string());
                    ui.ctx().accesskit_node_builder(choice.id, |node| {
                        node.set_label(format!(
                            "{count} view{}",
                            if count == 1 { "" } else { "s" }
                        ));
                    });
                    if choice.clicked() {
                        out.push(CompareIntent::Count(count));
                    }
                }
            },
        );
        if tab.count < 2 {
            ui.weak("With two or more views, renderers or settings stand side by side: wipe, flicker, differences and numbers come with them.");
        } else {
            several_ui(ui, tab, out);
        }
        ui.add_space(6.0);
        ui.strong("Panels");
        panel_ui(
            ui,
            tab.panels.pixels,
            "Pixels: one line of sight in every view",
            ComparePart::Pixels,
            out,
        );
        panel_ui(
            ui,
            tab.panels.times,
            "Frame times and memory",
            ComparePart::Times,
            out,
        );
        panel_ui(
            ui,
            tab.panels.why,
            "Why do they differ?",
            ComparePart::Why,
            out,
        );
        ui.add_space(6.0);
        ui.weak("Alt and the wheel enlarge the pixels under the pointer, in all views alike; Alt and a drag move them.");
        if tab.is_zoomed && ui.button("Pictures in their own size").clicked() {
            out.push(CompareIntent::ZoomOut);
        }
    });
}

/// What only two or more views have.
fn several_ui(ui: &mut Ui, tab: &CompareTab<'_>, out: &mut Intents) {
    let comparison = tab.comparison;
    ui.label(format!(
        "Panels, keys and menus act on view {}; a click into another one makes it the active one.",
        tab.active + 1
    ));
    let mut is_linked = comparison.is_linked;
    if ui.checkbox(&mut is_linked, "Linked cameras").changed() {
        out.push(CompareIntent::Link(is_linked));
    }
    let mut is_locked = comparison.is_locked;
    let lock = ui
        .checkbox(&mut is_locked, "Fair comparison")
        .on_hover_text("All views share size, background, exposure, lights, radius scale, structure and samples a pixel; what a renderer does not follow stands above its view");
    if lock.changed() {
        out.push(CompareIntent::Lock(is_locked));
    }
    ui.add_space(6.0);
    ui.strong("Comparison");
    super::row(
        ui,
        "Layout",
        "Beside each other, or two in one place",
        |ui| {
            ComboBox::from_id_salt("way")
                .selected_text(comparison.way.name())
                .show_ui(ui, |ui| {
                    for (way, name) in Way::ALL {
                        if ui.selectable_label(comparison.way == way, name).clicked() {
                            out.push(CompareIntent::Way(way));
                            ui.close();
                        }
                    }
                });
        },
    );
    if comparison.way == Way::Flicker {
        super::row(
            ui,
            "Flicker",
            "Changes a second; more than three are dangerous to some people",
            |ui| {
                let mut rate = comparison.flicker_hz;
                let slider = Slider::new(&mut rate, FLICKER_HZ)
                    .suffix(" Hz")
                    .clamping(SliderClamping::Always);
                if ui.add(slider).changed() {
                    out.push(CompareIntent::Flicker(rate));
                }
            },
        );
    }
    super::row(
        ui,
        "Against",
        "The view that the others are measured against",
        |ui| {
            for index in 0..tab.count {
                let is_chosen = comparison.against == index;
                let choice = ui.selectable_label(is_chosen, (index + 1).to_string());
                ui.ctx().accesskit_node_builder(choice.id, |node| {
                    node.set_label(format!("Against view {}", index + 1));
                });
                if choice.clicked() {
                    out.push(CompareIntent::Against(index));
                }
            }
        },
    );
    let mut measures = comparison.measures;
    let box_ = ui
        .checkbox(&mut measures, "Measure when still")
        .on_hover_text(
            "PSNR, SSIM and FLIP of each view against that one, as soon as all pictures rest",
        );
    if box_.changed() {
        out.push(CompareIntent::Measure(measures));
    }
}

fn panel_ui(ui: &mut Ui, is_open: bool, title: &str, part: ComparePart, out: &mut Intents) {
    let mut shows = is_open;
    if ui.checkbox(&mut shows, title).changed() {
        out.push(CompareIntent::Toggle(part));
    }
}
