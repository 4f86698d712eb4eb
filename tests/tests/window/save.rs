//! Saving images from the window. Sizes, tiles and cancelling are tried in the program's own tests.

use anyhow::{Context as _, Result};

use super::desk::{Desk, coloured};

#[test]
fn ctrl_s_saves_what_the_window_shows() -> Result<()> {
    let Some(mut desk) = Desk::with_sphere()? else {
        return Ok(());
    };
    let path = desk.program.home().join("sphere.png");
    let text = path
        .to_str()
        .context("temporary folders have plain names")?;
    desk.window.press_keys("ctrl+s")?;
    desk.window.click_on("TextInput", "File:")?;
    desk.window.press_keys("ctrl+a")?;
    desk.window.type_text(text)?;
    desk.window.wait_for_state("the typed path", |state| {
        (state.widget("TextInput", "File:")?.value == text).then_some(())
    })?;
    desk.window.click_on("Button", "Save")?;
    desk.window
        .wait_for_state("the image", |state| state.shows("Saved ").then_some(()))?;
    let image = image::open(&path)?.to_rgba8();
    assert!(coloured(&image) > 2000, "the sphere is in it");
    desk.close()
}
