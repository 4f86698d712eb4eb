//! Two renderers take turns, the rate is limited, and surfels are inspected, as a person would have it.

use std::time::{Duration, Instant};

use anyhow::{Context as _, Result};
use pointstage_tests::plugins;
use pointstage_tests::program::Program;
use pointstage_tests::window::State;
use serde_json::json;

use super::desk::{Desk, POINTS, coloured, same, sphere};
use super::{FALLBACK, SURFEL};

/// Chooses the surfels as main renderer, and points as the preview.
fn with_preview() -> Result<Option<Desk>> {
    let Some(mut desk) = Desk::with_sphere()? else {
        return Ok(None);
    };
    let window = &mut desk.window;
    window.click_on("RadioButton", "Surfels")?;
    window.settle("surfels", |state| state.session("drawn_by") == SURFEL)?;
    window.click_on("ComboBox", "Preview")?;
    window.click_on("Button", "Points")?;
    window.settle("the preview", |state| state.session("preview") == POINTS)?;
    Ok(Some(desk))
}

#[test]
fn the_preview_draws_while_the_camera_moves_and_the_main_renderer_takes_over() -> Result<()> {
    let Some(mut desk) = with_preview()? else {
        return Ok(());
    };
    desk.wait_for_picture("surfels", |picture| coloured(picture) > 40_000)?;
    desk.window.drag_until((370, 360), (470, 420), 1, |state| {
        state.session("drawn_by") == POINTS && state.session("role") == "preview"
    })?;
    desk.window.settle("the main renderer", |state| {
        state.session("drawn_by") == SURFEL && state.session("hand_over_ms").is_number()
    })?;
    desk.wait_for_picture("surfels again", |picture| coloured(picture) > 40_000)?;
    let shows_time = |state: &State| state.shows("took over in");
    desk.window.settle("the time it took", shows_time)?;
    desk.close()
}

#[test]
fn space_calls_the_preview_and_sends_it_away() -> Result<()> {
    let Some(mut desk) = with_preview()? else {
        return Ok(());
    };
    // The keyboard belongs to the picture after a click beside the sphere.
    desk.window.click(20, 100, 1)?;
    desk.window.press_keys("space")?;
    desk.window
        .settle("the preview", |state| state.session("drawn_by") == POINTS)?;
    desk.window.press_keys("space")?;
    desk.window
        .settle("the main one", |state| state.session("drawn_by") == SURFEL)?;
    desk.close()
}

#[test]
fn a_slider_that_moves_calls_the_preview() -> Result<()> {
    let Some(mut desk) = with_preview()? else {
        return Ok(());
    };
    desk.window.click_on("Tab", "View")?;
    desk.window
        .drag_slider("Exposure", 0.0, |state| state.session("drawn_by") == POINTS)?;
    desk.window
        .settle("the main one", |state| state.session("drawn_by") == SURFEL)?;
    desk.close()
}

#[test]
fn at_a_limit_of_none_a_second_pictures_come_when_they_are_asked_for() -> Result<()> {
    let Some(mut desk) = Desk::with_sphere()? else {
        return Ok(());
    };
    let before = desk.wait_for_picture("the sphere", |picture| coloured(picture) > 2000)?;
    desk.window.click_on("Tab", "View")?;
    desk.scroll_settings_to("CheckBox", "Rate limit")?;
    desk.window.click_on("CheckBox", "Rate limit")?;
    let none = |state: &State| state.session("pacing")["rate_limit"] == 0;
    desk.window
        .drag_slider("Rate limit, pictures a second", 0.0, none)?;
    desk.window.press_keys("y")?;
    desk.window.wait_for_state("the camera above", |state| {
        let eye = &state.session("view")["eye"];
        (eye[1].as_f64()? > 1.0).then_some(())
    })?;
    let shown = desk.window.capture_picture()?;
    assert!(
        same(&shown, &before),
        "a picture came that nobody asked for"
    );
    desk.window.press_keys("F5")?;
    desk.wait_for_picture("from above", |picture| !same(picture, &before))?;
    desk.close()
}

#[test]
fn moving_pictures_of_a_slow_renderer_get_smaller_until_they_are_fast_enough() -> Result<()> {
    let Some(mut desk) = Desk::with_sphere()? else {
        return Ok(());
    };
    // Pixel by pixel on the CPU: the built-in renderer with sixty pictures a second asked of it.
    desk.window
        .click_on("RadioButton", "Built-in fallback (CPU)")?;
    desk.window.settle("the fallback", |state| {
        state.session("drawn_by") == FALLBACK
    })?;
    desk.window.click_on("Tab", "View")?;
    desk.scroll_settings_to("CheckBox", "Target rate")?;
    desk.window.click_on("CheckBox", "Target rate")?;
    let name = "Target rate, pictures a second";
    let fast = |state: &State| state.session("pacing")["target_rate"].as_u64() > Some(45);
    desk.window.drag_slider(name, 1.0, fast)?;
    let full = desk.window.settle("a still picture", |state| {
        state.session("picture_px").is_array()
    })?;
    let full = full.session("picture_px").clone();
    desk.window.drag_until((370, 360), (470, 420), 1, |state| {
        let height = |size: &serde_json::Value| size[1].as_u64().unwrap_or_default();
        height(state.session("picture_px")) < height(&full)
    })?;
    desk.window.settle("every pixel again", |state| {
        *state.session("picture_px") == full
    })?;
    desk.close()
}

#[test]
fn a_click_keeps_a_surfel_and_a_double_click_turns_around_it() -> Result<()> {
    let Some(mut desk) = Desk::with_sphere()? else {
        return Ok(());
    };
    desk.window.click_on("RadioButton", "Surfels")?;
    desk.window
        .settle("surfels", |state| state.session("drawn_by") == SURFEL)?;
    desk.window.point_at(370, 360)?;
    desk.window.wait_for_state("the line about it", |state| {
        state.shows("sphere, surfel ").then_some(())
    })?;
    desk.window.click(370, 360, 1)?;
    let kept = desk.window.settle("the surfel", |state| {
        state.session("pinned")["object"] == "sphere" && state.shows("Targets at pixel")
    })?;
    for text in ["radius", "normal", "colour", "centre", "depth", "id"] {
        assert!(kept.shows(text), "no {text}:\n{}", kept.describe());
    }
    desk.window.press_keys("Escape")?;
    desk.window
        .settle("nothing kept", |state| state.session("pinned").is_null())?;

    let pivot = |state: &State| state.session("view")["pivot"].clone();
    let before = desk
        .window
        .settle("a pivot", |state| state.session("view").is_object())?;
    desk.window.double_click(420, 330)?;
    let after = desk
        .window
        .settle("another pivot", |state| pivot(state) != pivot(&before))?;
    let length = {
        let pivot = pivot(&after);
        let axes = pivot.as_array().context("three numbers")?.iter();
        let square: f64 = axes.filter_map(|axis| Some(axis.as_f64()?.powi(2))).sum();
        square.sqrt()
    };
    // The sphere's radius is 1, and its disks lie close to it.
    assert!((0.9..1.1).contains(&length), "{length} from the middle");
    desk.close()
}

#[test]
fn the_palette_finds_actions_and_settings_by_keyboard_alone() -> Result<()> {
    let Some(mut desk) = Desk::with_sphere()? else {
        return Ok(());
    };
    let window = &mut desk.window;
    window.press_keys("ctrl+p")?;
    window.find("TextInput", "Find")?;
    window.type_text("from top")?;
    window.wait_for_state("the text", |state| {
        (state.widget("TextInput", "Find")?.value == "from top").then_some(())
    })?;
    window.press_keys("Return")?;
    window.settle("the view from above", |state| {
        let eye = &state.session("view")["eye"];
        eye[1].as_f64().is_some_and(|y| y > 1.0) && !state.shows("Find an action or a setting")
    })?;
    window.click_on("Tab", "Lighting")?;
    window.press_keys("ctrl+k")?;
    window.find("TextInput", "Find")?;
    window.type_text("hide backs")?;
    window.wait_for_state("the text", |state| {
        (state.widget("TextInput", "Find")?.value == "hide backs").then_some(())
    })?;
    window.press_keys("Return")?;
    // The setting's tab is shown, and the keyboard is on its check box.
    window.find("CheckBox", "Hide backs")?;
    window.press_keys("space")?;
    window.settle("the setting", |state| {
        state.session("settings")["cull_backs"] == true
    })?;
    desk.close()
}

#[test]
fn a_renderer_s_own_keys_work_with_alt_and_its_conflicts_are_named() -> Result<()> {
    let program = Program::find()?;
    let sphere = sphere(program.home())?;
    let plugin = plugins::everything()?;
    let arguments = ["--plugin".as_ref(), plugin.as_os_str(), sphere.as_os_str()];
    let Some(mut desk) = Desk::open(program, &arguments)? else {
        return Ok(());
    };
    let window = &mut desk.window;
    window.click_on("RadioButton", "Everything")?;
    window.settle("its message", |state| {
        let messages = state.messages();
        messages.iter().any(|text| text.contains("is wanted by"))
    })?;
    window.press_keys("alt+k")?;
    window.settle("the bool", |state| {
        state.session("settings")["switch"] == json!(true)
    })?;
    window.press_keys("alt+3")?;
    window.settle("the number", |state| {
        state.session("settings")["count"] == json!(3)
    })?;
    desk.close()
}

#[test]
fn nothing_is_redrawn_while_nothing_changes() -> Result<()> {
    let Some(mut desk) = Desk::with_sphere()? else {
        return Ok(());
    };
    desk.window
        .settle("the sphere", |state| !state.shows("p95"))?;
    let passes = |desk: &mut Desk| desk.window.wait_for_state("the passes", State::passes);
    let wait = |desk: &mut Desk, what: &str, secs: u64| {
        let start = Instant::now();
        desk.window.wait_for_state(what, |_| {
            (start.elapsed() > Duration::from_secs(secs)).then_some(())
        })
    };
    // Three things happen once: a fade ends, preferences are kept, and the last picture leaves the summary of times.
    wait(&mut desk, "what ends by itself", 3)?;
    let before = passes(&mut desk)?;
    // What would be redrawn sixty times a second has every chance to.
    wait(&mut desk, "two seconds", 2)?;
    let after = passes(&mut desk)?;
    assert_eq!(after - before, 0, "passes in 2 s");
    desk.close()
}
