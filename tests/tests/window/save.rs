//! Saving images from the window.

use std::path::Path;

use anyhow::{Context as _, Result};
use serde_json::Value;

use super::desk::{Desk, coloured};

/// Opens the dialog and types where the image goes, and how wide and high it is if that is given.
fn fill_in(desk: &mut Desk, path: &Path, size: Option<[&str; 2]>) -> Result<()> {
    let window = &mut desk.window;
    window.press_keys("ctrl+s")?;
    let text = path
        .to_str()
        .context("temporary folders have plain names")?;
    window.type_into("TextInput", "File:", text)?;
    window.wait_for_state("the typed path", |state| {
        (state.widget("TextInput", "File:")?.value == text).then_some(())
    })?;
    for (name, value) in ["Width", "Height"]
        .into_iter()
        .zip(size.into_iter().flatten())
    {
        window.type_into("SpinButton", name, value)?;
        window.press_keys("Return")?;
        window.wait_for_state(name, |state| {
            let field = state.widget("SpinButton", name)?;
            let is_taken = !field.is_focused && number(&field.value) == value;
            is_taken.then_some(())
        })?;
    }
    Ok(())
}

/// The digits of a number, which may be a text with a unit.
fn number(value: &Value) -> String {
    let text = match value {
        Value::String(text) => text.clone(),
        other => other.as_f64().unwrap_or_default().to_string(),
    };
    text.chars().filter(char::is_ascii_digit).collect()
}

#[test]
fn ctrl_s_saves_what_the_window_shows_and_larger() -> Result<()> {
    let Some(mut desk) = Desk::with_sphere()? else {
        return Ok(());
    };
    let path = desk.program.home().join("sphere.png");
    for (size, expected) in [(None, None), (Some(["2500", "2100"]), Some((2500, 2100)))] {
        fill_in(&mut desk, &path, size)?;
        desk.window.click_on("Button", "Save")?;
        if size.is_some() {
            desk.window.click_on("Button", "Replace")?;
        }
        desk.window
            .wait_for_state("the image", |state| state.shows("Saved ").then_some(()))?;
        let image = image::open(&path)?.to_rgba8();
        assert!(coloured(&image) > 2000, "the sphere is in it");
        if let Some(expected) = expected {
            assert_eq!(image.dimensions(), expected);
        }
        desk.window.click_on("Button", "Copy path")?;
    }
    desk.close()
}

#[test]
fn a_large_image_is_cancelled_from_the_list_and_leaves_no_file() -> Result<()> {
    let Some(mut desk) = Desk::with_sphere()? else {
        return Ok(());
    };
    let path = desk.program.home().join("huge.png");
    fill_in(&mut desk, &path, Some(["60000", "60000"]))?;
    desk.window.click_on("Button", "Save")?;
    desk.window
        .wait_for_state("a tile", |state| state.shows("tile ").then_some(()))?;
    // The window goes on meanwhile.
    desk.turn()?;
    desk.window.click_on("Button", "Cancel Save huge.png")?;
    desk.window.wait_for_state("the end", |state| {
        state.shows("saving cancelled").then_some(())
    })?;
    let home = desk.program.home();
    let left = std::fs::read_dir(home)?.filter_map(|entry| Some(entry.ok()?.file_name()));
    let left: Vec<_> = left
        .filter(|name| name.to_string_lossy().contains("huge"))
        .collect();
    assert!(left.is_empty(), "{left:?}");
    desk.close()
}
