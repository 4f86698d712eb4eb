//! The steps of the user guide, one after the other, and the pictures in it.
//!
//! At the gate this is a test that each step leads where the guide says. With `POINTSTAGE_PICTURES=1`, as `cargo xtask
//! pictures` sets it, what the display shows after each step is written to `docs/pictures/`.

use std::path::PathBuf;

use anyhow::{Context as _, Result};
use image::RgbaImage;
use pointstage_tests::data::repository;
use pointstage_tests::golden;
use pointstage_tests::program::Program;
use pointstage_tests::window::State;

use super::SURFEL;
use super::desk::{Desk, POINTS};

/// The sample that the pictures show.
const SAMPLE: &str = "knotted_snake";

/// Where the snake's body is, px.
const ON_THE_SNAKE: (i16, i16) = (300, 330);

#[test]
fn each_step_of_the_guide_leads_where_it_says() -> Result<()> {
    let Some(mut desk) = Desk::open(Program::find()?, &[])? else {
        return Ok(());
    };
    welcome(&mut desk)?;
    renderer(&mut desk)?;
    inspector(&mut desk)?;
    selecting(&mut desk)?;
    tabs(&mut desk)?;
    views(&mut desk)?;
    targets(&mut desk)?;
    dialogs(&mut desk)?;
    side_by_side(&mut desk)?;
    desk.close()
}

/// Writes what the display shows, if pictures are wanted.
fn picture(desk: &Desk, name: &str) -> Result<()> {
    picture_down_to(desk, name, i16::MAX)
}

/// The same, of the rows above `end`.
fn picture_down_to(desk: &Desk, name: &str, end: i16) -> Result<()> {
    if std::env::var_os("POINTSTAGE_PICTURES").is_none() {
        return Ok(());
    }
    // The state is told when a pass ends; the display shows it a little later.
    std::thread::sleep(std::time::Duration::from_secs(2));
    let path: PathBuf = repository().join("docs/pictures").join(name);
    let shown = without_noise(&desk.window.capture()?);
    let height = shown.height().min(u32::try_from(end)?);
    let part = image::imageops::crop_imm(&shown, 0, 0, shown.width(), height).to_image();
    golden::write(&part, &path.with_extension("png"))
}

/// Five bits a channel: texts and colours look the same, and the file has half the size.
fn without_noise(picture: &RgbaImage) -> RgbaImage {
    let mut picture = picture.clone();
    for pixel in picture.pixels_mut() {
        for channel in &mut pixel.0[..3] {
            *channel = (*channel & 0xf8) | (*channel >> 5);
        }
    }
    picture
}

/// Waits until all is quiet and the pointer's tooltip is gone.
fn rest(desk: &mut Desk, what: &str, accept: impl Fn(&State) -> bool) -> Result<()> {
    desk.window.point_at(8, 712)?;
    desk.window.settle(what, accept).map(drop)
}

fn welcome(desk: &mut Desk) -> Result<()> {
    rest(desk, "the welcome", |state| {
        state.shows("Nothing on the stage yet")
    })?;
    picture(desk, "welcome")?;
    desk.window.click_on("Button", "knotted snake")?;
    rest(desk, "the sample", |state| {
        state.objects() == [SAMPLE] && state.session("drawn_by") == POINTS
    })
}

fn renderer(desk: &mut Desk) -> Result<()> {
    desk.window.click_on("RadioButton", "Surfels")?;
    desk.window
        .settle("surfels", |state| state.session("drawn_by") == SURFEL)?;
    let before = desk
        .window
        .wait_for_state("a view", |state| Some(state.session("view").clone()))?;
    desk.window.drag_until((370, 360), (430, 400), 1, |state| {
        *state.session("view") != before
    })?;
    rest(desk, "the turned snake", |_| true)?;
    picture(desk, "window")
}

fn side_by_side(desk: &mut Desk) -> Result<()> {
    desk.window.press_keys("F1")?;
    rest(desk, "no keys", |state| {
        !state.shows("turn around the pivot")
    })?;
    desk.window.press_keys("ctrl+p")?;
    desk.window
        .type_into("TextInput", "Find", "show: real colours")?;
    desk.window.press_keys("Return")?;
    rest(desk, "colours", |state| {
        state.session("show") == "Real colours"
    })?;
    desk.show_views(4)?;
    for (number, title, id) in [
        (1, "Points", POINTS),
        (2, "Surfels", SURFEL),
        (3, "HQSS", "org.pointstage.hqss"),
        (4, "EWA reference", "org.pointstage.ewa-reference"),
    ] {
        desk.choose_in_view(number, title, id)?;
    }
    desk.window.click_on("CheckBox", "Fair comparison")?;
    desk.window.click_on("Button", "Against view 4")?;
    rest(desk, "the numbers of three views", |state| {
        let panes = state.session("panes").as_array();
        let numbers = panes.into_iter().flatten().take(3);
        numbers.into_iter().all(|pane| {
            pane["numbers"]
                .as_str()
                .is_some_and(|text| text.starts_with("PSNR "))
        })
    })?;
    picture(desk, "side-by-side")
}

fn inspector(desk: &mut Desk) -> Result<()> {
    let (x, y) = ON_THE_SNAKE;
    desk.window.press_keys("shift+i")?;
    let kept = desk
        .window
        .settle("a surfel in the middle, or none", |_| true)?;
    if kept.session("pinned").is_null() {
        desk.window.click(x, y, 1)?;
    }
    rest(desk, "the surfel", |state| {
        state.session("pinned")["object"] == SAMPLE && state.shows("Targets at pixel")
    })?;
    picture(desk, "inspector")?;
    desk.window.press_keys("Escape")?;
    desk.window.press_keys("i")?;
    rest(desk, "no inspector", |state| {
        state.session("pinned").is_null() && !state.shows("Point at a surface")
    })
}

fn selecting(desk: &mut Desk) -> Result<()> {
    let selected = |state: &State| state.session("surfels_selected").as_u64();
    desk.window.press_keys("r")?;
    rest(desk, "the tool", |state| {
        state.session("tool") == "rectangle"
    })?;
    let (x, y) = ON_THE_SNAKE;
    desk.window.throw((x - 150, y - 130), (x + 60, y + 80))?;
    rest(desk, "selected surfels", |state| selected(state) > Some(0))?;
    picture(desk, "selecting")?;
    desk.window.press_keys("ctrl+d")?;
    rest(desk, "none selected", |state| selected(state) == Some(0))?;
    desk.window.press_keys("Escape")?;
    rest(desk, "no tool", |state| state.session("tool") == "navigate")
}

fn tabs(desk: &mut Desk) -> Result<()> {
    for (tab, text, name) in [
        ("Lighting", "Material", "lighting"),
        ("Plugins", "Add folder", "plugins"),
        ("Scene", "95\u{2009}904 surfels", "scene"),
    ] {
        desk.window.click_on("Tab", tab)?;
        rest(desk, tab, |state| state.shows(text))?;
        if tab == "Plugins" {
            // Below are folders of the machine that this runs on.
            let end = desk.window.wait_for_state("folders", |state| {
                state.label("Folders").map(|label| label.rect[1])
            })?;
            picture_down_to(desk, name, end)?;
        } else {
            picture(desk, name)?;
        }
    }
    Ok(())
}

fn views(desk: &mut Desk) -> Result<()> {
    desk.window.click_on("Tab", "View")?;
    for keys in ["z", "x"] {
        desk.window.press_keys(keys)?;
        rest(desk, "the camera to rest", |_| true)?;
        desk.scroll_settings_to("Button", "Keep this view")?;
        desk.window.click_on("Button", "Keep this view")?;
    }
    rest(desk, "two views", |state| {
        let named = state.session("views")["named"].as_array();
        named.is_some_and(|named| named.len() == 2)
    })?;
    picture(desk, "views")
}

fn targets(desk: &mut Desk) -> Result<()> {
    desk.window.press_keys("ctrl+p")?;
    desk.window.find("TextInput", "Find")?;
    desk.window.type_text("show: normals")?;
    desk.window.wait_for_state("the text", |state| {
        (state.widget("TextInput", "Find")?.value == "show: normals").then_some(())
    })?;
    picture(desk, "palette")?;
    desk.window.press_keys("Return")?;
    rest(desk, "normals", |state| {
        state.session("show") == "Normals" && state.shows("towards the eye")
    })?;
    picture(desk, "normals")
}

fn dialogs(desk: &mut Desk) -> Result<()> {
    desk.window.press_keys("ctrl+s")?;
    // No folder of the machine that this runs on.
    desk.window
        .type_into("TextInput", "File:", "/home/me/snake.png")?;
    rest(desk, "the dialog", |state| {
        state.shows("/home/me/snake.png")
    })?;
    picture(desk, "save_image")?;
    desk.window.press_keys("Escape")?;
    rest(desk, "the end of the dialog", |state| {
        state.widget("CheckBox", "Transparent background").is_none()
    })?;
    desk.window.press_keys("F1")?;
    rest(desk, "the keys", |state| {
        state.shows("turn around the pivot")
    })
    .context("Help lists the keys")?;
    picture(desk, "keys")
}
