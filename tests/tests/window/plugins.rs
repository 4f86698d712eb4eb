//! Plugins by hand: set aside and taken back, a folder added, looked through again and removed.

use anyhow::{Context as _, Result};
use pointstage_tests::plugins;
use pointstage_tests::program::Program;
use pointstage_tests::window::State;

use super::SURFEL;
use super::desk::{Desk, POINTS, sphere};

const EVERYTHING: &str = "org.pointstage.test.everything";

/// Whether the renderer of this name can be chosen.
fn offers(state: &State, name: &str) -> bool {
    state
        .widget("RadioButton", name)
        .is_some_and(|radio| radio.is_enabled)
}

#[test]
fn a_renderer_set_aside_is_gone_until_it_is_tried_again() -> Result<()> {
    let Some(mut desk) = Desk::with_sphere()? else {
        return Ok(());
    };
    let window = &mut desk.window;
    window.click_on("Tab", "Plugins")?;
    window.wait_for_state("the time to load", |state| {
        state.shows("beside the program, loaded in ").then_some(())
    })?;
    window.click_on("Button", "Set Points aside")?;
    window.settle("another renderer", |state| {
        *state.session("drawn_by") != POINTS && state.shows("set aside by you")
    })?;
    window.click_on("Tab", "Renderer")?;
    window.settle("no points", |state| {
        !offers(state, "Points") && offers(state, "Surfels")
    })?;
    window.click_on("RadioButton", "Surfels")?;
    window.settle("surfels", |state| state.session("drawn_by") == SURFEL)?;

    window.click_on("Tab", "Plugins")?;
    window.click_on("Button", "Try again")?;
    window.find("Button", "Set Points aside")?;
    window.click_on("Tab", "Renderer")?;
    window.click_on("RadioButton", "Points")?;
    window.settle("points again", |state| state.session("drawn_by") == POINTS)?;
    desk.close()
}

#[test]
fn a_renderer_in_an_added_folder_is_found_and_goes_with_it() -> Result<()> {
    let program = Program::find()?;
    let sphere = sphere(program.home())?;
    let folder = program.home().join("more");
    std::fs::create_dir(&folder)?;
    let Some(mut desk) = Desk::open(program, &[sphere.as_os_str()])? else {
        return Ok(());
    };
    let window = &mut desk.window;
    window.settle("the sphere", |state| state.objects() == ["sphere"])?;
    window.click_on("Tab", "Plugins")?;
    desk.scroll_settings_to("Button", "Choose a folder of plugins")?;
    let window = &mut desk.window;
    let typed = folder.to_str().context("it has a plain name")?;
    window.type_into("TextInput", "Folder to look for plugins in", typed)?;
    window.click_on("Button", "Add folder")?;
    let remove = format!("Remove folder {typed}");
    window.find("Button", &remove)?;

    // It comes when all is looked at again, without a new start.
    let plugin = plugins::everything()?;
    let name = plugin.file_name().context("a file")?;
    std::fs::copy(&plugin, folder.join(name))?;
    desk.scroll_settings_to("Button", "Reload plugins")?;
    let window = &mut desk.window;
    window.click_on("Button", "Reload plugins")?;
    window.find("Button", "Set Everything aside")?;
    window.click_on("Tab", "Renderer")?;
    window.click_on("RadioButton", "Everything")?;
    window.settle("its picture", |state| {
        state.session("drawn_by") == EVERYTHING
    })?;

    window.click_on("Tab", "Plugins")?;
    desk.scroll_settings_to("Button", &remove)?;
    let window = &mut desk.window;
    window.click_on("Button", &remove)?;
    window.settle("another renderer", |state| {
        *state.session("drawn_by") != EVERYTHING
            && state.widget("Button", "Set Everything aside").is_none()
    })?;
    window.click_on("Tab", "Renderer")?;
    window.settle("it is not offered", |state| {
        !offers(state, "Everything") && offers(state, "Points")
    })?;
    desk.close()
}
