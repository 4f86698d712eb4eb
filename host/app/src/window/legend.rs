//! The legend of a shown target, over the picture.

use egui::{Align2, Area, Color32, Context, Frame, Id, Order, Rect, Sense, Ui, vec2};
use pointstage_engine::frame::legend::{Category, Legend, Scale, Stop};
use pointstage_engine::stage::Show;

/// Width of a ramp, points.
const RAMP_WIDTH: f32 = 260.0;

/// What is shown, for menus.
pub(crate) fn title_of(show: &Show) -> String {
    let Show::Target(key) = show else {
        return "Real colours".to_owned();
    };
    let known = match key.as_str() {
        "depth" => "Depth",
        "normal" => "Normals",
        "id" => "Surfel ids",
        "weight" => "Weights",
        "lod" => "Level of detail",
        "kind" => "Surfels against polygons",
        "overdraw" => "Overdraw",
        other => other,
    };
    known.to_owned()
}

/// Shows the legend in the lower left corner of `over`.
pub(crate) fn legend_ui(ctx: &Context, over: Rect, legend: &Legend) {
    Area::new(Id::unique("legend"))
        .order(Order::Middle)
        .pivot(Align2::LEFT_BOTTOM)
        .fixed_pos(over.left_bottom() + vec2(10.0, -10.0))
        .interactable(false)
        .show(ctx, |ui| {
            Frame::popup(ui.style()).show(ui, |ui| {
                ui.set_max_width(RAMP_WIDTH.max(over.width() * 0.5));
                content_ui(ui, legend);
            });
        });
}

/// The legend's title and colours, wherever they are shown.
pub(crate) fn content_ui(ui: &mut Ui, legend: &Legend) {
    ui.label(&legend.title);
    match &legend.scale {
        Scale::Ramp(stops) => ramp_ui(ui, stops),
        Scale::Categories(categories) => categories_ui(ui, categories),
        Scale::None => {}
    }
}

fn ramp_ui(ui: &mut Ui, stops: &[Stop]) {
    let width = RAMP_WIDTH.min(ui.available_width());
    let (rect, _) = ui.allocate_exact_size(vec2(width, 14.0), Sense::hover());
    let mut mesh = egui::Mesh::default();
    for stop in stops {
        let x = rect.left() + rect.width() * stop.position;
        mesh.colored_vertex(egui::pos2(x, rect.top()), color(stop.colour));
        mesh.colored_vertex(egui::pos2(x, rect.bottom()), color(stop.colour));
    }
    for pair in 0..stops.len().saturating_sub(1) as u32 {
        mesh.add_triangle(2 * pair, 2 * pair + 1, 2 * pair + 2);
        mesh.add_triangle(2 * pair + 1, 2 * pair + 3, 2 * pair + 2);
    }
    ui.painter().add(mesh);
    let (labels, _) = ui.allocate_exact_size(vec2(width, 14.0), Sense::hover());
    for stop in stops.iter().filter(|stop| !stop.label.is_empty()) {
        let x = labels.left() + labels.width() * stop.position;
        let align = if stop.position < 0.25 {
            Align2::LEFT_TOP
        } else if stop.position > 0.75 {
            Align2::RIGHT_TOP
        } else {
            Align2::CENTER_TOP
        };
        ui.painter().text(
            egui::pos2(x, labels.top()),
            align,
            &stop.label,
            egui::TextStyle::Small.resolve(ui.style()),
            ui.visuals().text_color(),
        );
    }
}

fn categories_ui(ui: &mut Ui, categories: &[Category]) {
    ui.horizontal_wrapped(|ui| {
        for category in categories {
            let (rect, _) = ui.allocate_exact_size(vec2(12.0, 12.0), Sense::hover());
            ui.painter().rect_filled(rect, 2.0, color(category.colour));
            ui.label(&category.label);
        }
    });
}

fn color([r, g, b]: [u8; 3]) -> Color32 {
    Color32::from_rgb(r, g, b)
}
