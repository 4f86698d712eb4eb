//! The linked pixel inspector: what one line of sight meets in every view, side by side.

use std::sync::Arc;

use egui::{Color32, Grid, Sense, Ui, vec2};
use pointstage_engine::stage::FrameResult;
use pointstage_scene::Scene;

use super::super::facts::{facts_at, target_values};

/// One view at the place.
pub(crate) struct Place<'a> {
    /// Its number and its renderer's name.
    pub(crate) title: String,
    /// Its picture.
    pub(crate) shown: Option<&'a Arc<FrameResult>>,
}

/// What is found in one view.
#[derive(Clone, Debug, PartialEq)]
struct Found {
    pixel: [u32; 2],
    rgba: [u8; 4],
    rows: Vec<(String, String)>,
}

/// Lists what is at a place of every view, given as parts of width and height.
pub(crate) fn pixels_ui(
    ui: &mut Ui,
    at: Option<[f32; 2]>,
    places: &[Place<'_>],
    scene: &Scene,
    is_linked: bool,
) {
    let Some(at) = at else {
        ui.weak(
            "Point into a view: what the same line of sight meets in all of them is listed here.",
        );
        return;
    };
    if !is_linked {
        ui.weak(
            "The cameras are free: the same place of each picture, along different lines of sight.",
        );
    }
    let found: Vec<Option<Found>> = places
        .iter()
        .map(|place| found(place.shown?, scene, at))
        .collect();
    let names = names(&found);
    let columns = places.len() + 1;
    let grid = Grid::new("pixels").num_columns(columns).striped(true);
    grid.show(ui, |ui| {
        ui.label("");
        for place in places {
            ui.strong(&place.title);
        }
        ui.end_row();
        ui.label("pixel");
        for found in &found {
            let text = found
                .as_ref()
                .map(|found| format!("{}, {}", found.pixel[0], found.pixel[1]));
            ui.monospace(text.unwrap_or_default());
        }
        ui.end_row();
        ui.label("colour");
        for found in &found {
            match found {
                Some(found) => colour_ui(ui, found.rgba),
                None => {
                    ui.weak("no picture yet");
                }
            }
        }
        ui.end_row();
        for name in names {
            ui.label(&name);
            let values: Vec<Option<&str>> = found
                .iter()
                .map(|found| found.as_ref().and_then(|found| value_of(found, &name)))
                .collect();
            let differ = values.windows(2).any(|pair| pair[0] != pair[1]);
            for value in values {
                let text = egui::RichText::new(value.unwrap_or("–")).monospace();
                ui.label(if differ { text.strong() } else { text });
            }
            ui.end_row();
        }
    });
}

fn colour_ui(ui: &mut Ui, [red, green, blue, alpha]: [u8; 4]) {
    ui.horizontal(|ui| {
        let (rect, _) = ui.allocate_exact_size(vec2(14.0, 14.0), Sense::hover());
        let colour = Color32::from_rgba_unmultiplied(red, green, blue, alpha);
        ui.painter().rect_filled(rect, 2.0, colour);
        ui.monospace(format!("{red} {green} {blue} {alpha}"));
    });
}

fn value_of<'a>(found: &'a Found, name: &str) -> Option<&'a str> {
    let mut rows = found.rows.iter();
    rows.find(|(key, _)| key == name)
        .map(|(_, value)| value.as_str())
}

/// All names, in the order in which they first come.
fn names(found: &[Option<Found>]) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for (name, _) in found.iter().flatten().flat_map(|found| &found.rows) {
        if !names.contains(name) {
            names.push(name.clone());
        }
    }
    names
}

fn found(shown: &FrameResult, scene: &Scene, at: [f32; 2]) -> Option<Found> {
    let size_px = shown.picture.size_px;
    let pixel: [u32; 2] = std::array::from_fn(|axis| {
        let place = at[axis].clamp(0.0, 1.0) * size_px[axis] as f32;
        (place as u32).min(size_px[axis].saturating_sub(1))
    });
    let first = (pixel[1] as usize * size_px[0] as usize + pixel[0] as usize) * 4;
    let rgba = shown.picture.rgba.get(first..first + 4)?;
    // What the renderer wrote, then what the scene has of the surfel.
    let mut rows: Vec<(String, String)> = target_values(shown, pixel)
        .into_iter()
        .map(|(key, value)| (format!("target {key}"), value))
        .collect();
    match facts_at(shown, scene, pixel, 0) {
        Some(facts) => {
            rows.push(("surfel".to_owned(), facts.title()));
            rows.extend(facts.columns);
        }
        None => rows.push(("surfel".to_owned(), "nothing, or not told".to_owned())),
    }
    Some(Found {
        pixel,
        rgba: [rgba[0], rgba[1], rgba[2], rgba[3]],
        rows,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::window::test_frames::frame_of_square;

    #[test]
    fn one_place_is_one_surfel_in_pictures_of_any_size() {
        let (scene, shown) = frame_of_square(&["id", "depth"]);
        let here = found(&shown, &scene, [0.5, 0.5]).expect("a picture");
        assert_eq!(here.pixel, shown.picture.size_px.map(|side| side / 2));
        let surfel = value_of(&here, "surfel").expect("named");
        assert!(surfel.starts_with("square, surfel "), "{surfel}");
        assert!(value_of(&here, "target id").is_some());
        let beside = found(&shown, &scene, [0.0, 0.0]).expect("a picture");
        assert_eq!(value_of(&beside, "surfel"), Some("nothing, or not told"));
        let corner = found(&shown, &scene, [1.0, 1.0]).expect("a picture");
        assert_eq!(corner.pixel, shown.picture.size_px.map(|side| side - 1));
    }
}
