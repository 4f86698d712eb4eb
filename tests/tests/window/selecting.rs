//! Surfels are selected by hand, shown by several renderers, cut, pasted, and come back.

use anyhow::{Context as _, Result, ensure};
use image::RgbaImage;
use pointstage_tests::window::State;

use super::SURFEL;
use super::desk::Desk;

/// Where the sphere's left half ends, px.
const LEFT_HALF_PX: u32 = 350;

const HQSS: &str = "org.pointstage.hqss";

/// Pixels in the tint of selected surfels on the sphere's left half, where none is magenta by itself.
fn tinted(picture: &RgbaImage) -> usize {
    let is_tinted = |(x, _, pixel): &(u32, u32, &image::Rgba<u8>)| {
        let [red, green, blue, _] = pixel.0.map(i16::from);
        *x < LEFT_HALF_PX && red > 140 && red - green > 40 && blue - green > 20
    };
    picture.enumerate_pixels().filter(is_tinted).count()
}

fn selected(state: &State) -> u64 {
    state.session("surfels_selected").as_u64().unwrap_or(0)
}

fn surfels(state: &State) -> Vec<u64> {
    let objects = state.session("objects").as_array();
    let counts = objects.into_iter().flatten();
    counts
        .filter_map(|object| object["surfels"].as_u64())
        .collect()
}

#[test]
fn surfels_are_selected_shown_cut_and_pasted() -> Result<()> {
    let Some(mut desk) = Desk::with_sphere()? else {
        return Ok(());
    };
    let plain = tinted(&desk.window.capture_picture()?);
    desk.window.press_keys("r")?;
    desk.window
        .settle("the tool", |state| state.session("tool") == "rectangle")?;
    let view = desk
        .window
        .wait_for_state("a view", |state| Some(state.session("view").clone()))?;
    desk.window.throw((60, 100), (370, 560))?;
    let state = desk
        .window
        .settle("a selection", |state| selected(state) > 500)?;
    ensure!(*state.session("view") == view, "the drag moved the camera");
    let count = selected(&state);
    ensure!(count < 2500, "{count} of 3000 are half");
    // Each renderer in turn shows them, without a word of it in any of them.
    for renderer in [desk_renderer(&state)?, SURFEL.to_owned(), HQSS.to_owned()] {
        choose(&mut desk, &renderer)?;
        let picture = desk.wait_for_picture(&format!("marks drawn by {renderer}"), |picture| {
            tinted(picture) > plain + 2000
        })?;
        desk.window.settle("the picture", |_| true)?;
        ensure!(tinted(&picture) < 100_000, "{renderer} tints all of it");
    }
    desk.window.press_keys("ctrl+x")?;
    desk.window.settle("the rest", |state| {
        surfels(state) == [3000 - count] && selected(state) == 0
    })?;
    desk.wait_for_picture("nothing selected", |picture| tinted(picture) < plain + 500)?;
    desk.window.press_keys("ctrl+v")?;
    desk.window.settle("the piece", |state| {
        surfels(state) == [3000 - count, count] && selected(state) == count
    })?;
    desk.window.press_keys("ctrl+z")?;
    desk.window
        .settle("no piece", |state| surfels(state) == [3000 - count])?;
    desk.window.press_keys("ctrl+z")?;
    desk.window.settle("all again, and selected", |state| {
        surfels(state) == [3000] && selected(state) == count
    })?;
    desk.close()
}

/// The renderer that draws.
fn desk_renderer(state: &State) -> Result<String> {
    let drawn_by = state.session("drawn_by").as_str();
    Ok(drawn_by.context("something draws")?.to_owned())
}

fn choose(desk: &mut Desk, renderer: &str) -> Result<()> {
    let state = desk.window.settle("a picture", |_| true)?;
    if desk_renderer(&state)? == renderer {
        return Ok(());
    }
    let title = match renderer {
        SURFEL => "Surfels",
        _ => "HQSS",
    };
    desk.window.click_on("RadioButton", title)?;
    desk.window
        .settle(renderer, |state| state.session("drawn_by") == renderer)?;
    Ok(())
}
