//! The *View* tab: how the picture is shown, the camera, and stored views.

use egui::{DragValue, Slider, SliderClamping, Ui};
use pointstage_engine::frame::legend::Legend;
use pointstage_engine::stage::Background;

use super::camera::{CameraTab, camera_ui};
use super::pacing::pacing_ui;
use super::view_list::view_list_ui;
use crate::toml_form::DEFAULT_BACKGROUND;
use crate::window::intent::{Intents, ViewIntent};
use crate::window::menu::show_choices_ui;
use crate::window::pacing::Pacing;
use crate::window::session::ViewOptions;
use crate::window::views::StoredViews;

/// The first colour of a background of one colour.
const WHITE: Background = Background::Solid([1.0; 3]);

/// Backgrounds at a click.
const BACKGROUNDS: [(&str, Background); 4] = [
    ("Default", DEFAULT_BACKGROUND),
    ("White", WHITE),
    ("Grey", Background::Solid([0.5; 3])),
    ("Black", Background::Solid([0.0; 3])),
];

/// As far as the exposure goes in stops: a factor of about a thousand either way.
const MOST_STOPS: f32 = 10.0;

/// What the tab shows.
pub(crate) struct ViewTab<'a> {
    /// How the picture is shown.
    pub(crate) view: &'a ViewOptions,
    /// How often it is drawn.
    pub(crate) pacing: Pacing,
    /// The camera's part.
    pub(crate) camera: CameraTab<'a>,
    /// Views that were kept.
    pub(crate) views: &'a StoredViews,
    /// Targets that the renderer gives.
    pub(crate) targets: &'a [String],
    /// What the colours of the shown target mean.
    pub(crate) legend: Option<&'a Legend>,
}

/// The tab.
pub(crate) fn view_ui(ui: &mut Ui, tab: &ViewTab<'_>, out: &mut Intents) {
    super::tab_ui(ui, |ui| {
        ui.strong("Picture");
        super::row(
            ui,
            "Shows",
            "Colours, or one of the targets that the renderer writes",
            |ui| {
                egui::ComboBox::from_id_salt("shows")
                    .selected_text(crate::window::legend::title_of(&tab.view.show))
                    .show_ui(ui, |ui| {
                        show_choices_ui(ui, &tab.view.show, tab.targets, out);
                    });
            },
        );
        if let Some(legend) = tab.legend {
            ui.indent("legend", |ui| crate::window::legend::content_ui(ui, legend));
        }
        factor_ui(
            ui,
            "Exposure",
            "Factor on the colours",
            tab.view.exposure,
            ViewIntent::Exposure,
            out,
        );
        stops_ui(ui, tab.view.exposure, out);
        factor_ui(
            ui,
            "Radius scale",
            "Factor on every surfel's radius",
            tab.view.radius_scale,
            ViewIntent::RadiusScale,
            out,
        );
        background_ui(ui, tab.view.background, out);
        ui.separator();
        ui.strong("Pace");
        pacing_ui(ui, tab.pacing, out);
        ui.separator();
        camera_ui(ui, &tab.camera, out);
        ui.separator();
        view_list_ui(ui, tab.views, out);
    });
}

/// A factor around 1, logarithmic, with a reset.
fn factor_ui(
    ui: &mut Ui,
    label: &str,
    help: &str,
    value: f32,
    intent: impl Fn(f32) -> ViewIntent,
    out: &mut Intents,
) {
    super::row(ui, label, help, |ui| {
        let mut edited = value;
        let slider = Slider::new(&mut edited, 0.1..=10.0)
            .logarithmic(true)
            .clamping(SliderClamping::Never)
            .max_decimals(3);
        if ui.add(slider).changed() && edited > 0.0 && edited.is_finite() {
            out.push(intent(edited));
        }
        if value != 1.0 {
            let name = format!("Reset {label}");
            let reset = ui.small_button("reset").on_hover_text(&name);
            let reset = reset.accessible_name(name);
            if reset.clicked() {
                out.push(intent(1.0));
            }
        }
    });
}

/// The exposure again, as photographers count it: one stop more is twice as bright.
fn stops_ui(ui: &mut Ui, exposure: f32, out: &mut Intents) {
    let help = "The exposure in stops: one more is twice as bright";
    super::row(ui, "in stops", help, |ui| {
        let stops = exposure.log2();
        let mut edited = stops;
        let drag = DragValue::new(&mut edited)
            .speed(0.02)
            .range(-MOST_STOPS..=MOST_STOPS)
            .max_decimals(2)
            .custom_formatter(|stops, _| format!("{stops:+.2}"));
        if ui.add(drag).changed() && edited != stops {
            out.push(ViewIntent::Exposure(edited.exp2()));
        }
    });
}

fn background_ui(ui: &mut Ui, background: Background, out: &mut Intents) {
    let mut edited = background;
    super::row(ui, "Background", "What lies behind the scene", |ui| {
        egui::ComboBox::from_id_salt("background")
            .selected_text(kind_of(background))
            .show_ui(ui, |ui| {
                for kind in [DEFAULT_BACKGROUND, WHITE, Background::Transparent] {
                    let is_now = kind_of(kind) == kind_of(background);
                    if ui.selectable_label(is_now, kind_of(kind)).clicked() && !is_now {
                        edited = kind;
                    }
                }
            });
    });
    match &mut edited {
        Background::Transparent => {}
        Background::Solid(colour) => {
            super::row(ui, "Colour", "", |ui| srgb_ui(ui, colour));
        }
        Background::Gradient(top, bottom) => {
            super::row(ui, "Top", "", |ui| srgb_ui(ui, top));
            super::row(ui, "Bottom", "", |ui| srgb_ui(ui, bottom));
        }
    }
    super::row(ui, "", "", |ui| {
        for (name, preset) in BACKGROUNDS {
            let is_now = preset == background;
            let button = ui.selectable_label(is_now, name);
            let button = button.accessible_name(format!("{name} background"));
            if button.clicked() && !is_now {
                edited = preset;
            }
        }
    });
    if edited != background {
        out.push(ViewIntent::Background(edited));
    }
}

fn kind_of(background: Background) -> &'static str {
    match background {
        Background::Transparent => "transparent",
        Background::Solid(_) => "one colour",
        Background::Gradient(..) => "gradient",
    }
}

/// A colour of sRGB values, 0..1.
fn srgb_ui(ui: &mut Ui, colour: &mut [f32; 3]) {
    let mut bytes = colour.map(|channel| (channel.clamp(0.0, 1.0) * 255.0).round() as u8);
    if ui.color_edit_button_srgb(&mut bytes).changed() {
        *colour = bytes.map(|byte| f32::from(byte) / 255.0);
    }
}
