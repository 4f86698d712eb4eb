//! What outlives the window: session files, settings, recent files, the bug report's place in the menu.

use std::ffi::OsStr;
use std::path::Path;

use anyhow::{Context as _, Result};
use pointstage_tests::program::Program;
use pointstage_tests::scenes;

use super::desk::{Desk, POINTS, coloured, same};

impl Desk {
    /// Saves the session by a typed path.
    pub(super) fn save_session(&mut self, path: &Path) -> Result<()> {
        self.window.press_keys("ctrl+shift+s")?;
        self.window.find("TextInput", "Path of the session file:")?;
        self.window.press_keys("ctrl+a")?;
        let text = path
            .to_str()
            .context("temporary folders have plain names")?;
        self.window.type_text(text)?;
        self.window.wait_for_state("the typed path", |state| {
            let field = state.widget("TextInput", "Path of the session file:")?;
            (field.value == text).then_some(())
        })?;
        self.window.press_keys("Return")?;
        self.window.settle("the saved session", |state| {
            state.session("session_path") == text
                && state
                    .messages()
                    .iter()
                    .any(|said| said.starts_with("Session saved"))
        })?;
        Ok(())
    }

    /// Opens the window of the same program again.
    pub(super) fn again(program: Program, arguments: &[&OsStr]) -> Result<Self> {
        // What the last window showed must not be taken for what this one does.
        std::fs::remove_file(program.home().join("ui_state.json"))?;
        Self::open(program, arguments)?.context("there was a display before")
    }
}

#[test]
fn a_session_saved_in_the_window_shows_the_same_when_it_is_opened_again() -> Result<()> {
    let Some(mut desk) = Desk::with_sphere()? else {
        return Ok(());
    };
    desk.turn()?;
    desk.window.click_on("CheckBox", "Hide backs")?;
    let before = desk.window.settle("no backs", |state| {
        state.session("settings")["cull_backs"] == true
    })?;
    let session = desk.program.home().join("ball.pointstage.toml");
    desk.save_session(&session)?;
    desk.window.click_on("Button", "Dismiss")?;
    let picture = desk.wait_for_picture("before", |picture| coloured(picture) > 1000)?;
    let program = desk.close_and_keep()?;

    // Without a window it draws the same scene in the window's size.
    let out = program.home().join("ball.png");
    program.succeed([
        "render".as_ref(),
        "--session".as_ref(),
        session.as_os_str(),
        "--out".as_ref(),
        out.as_os_str(),
    ])?;
    let drawn = image::open(&out)?.to_rgba8();
    let view = before.session("view");
    assert_eq!(
        (view["width"].as_u64(), view["height"].as_u64()),
        (Some(drawn.width().into()), Some(drawn.height().into()))
    );
    assert!(coloured(&drawn) > 1000);

    std::fs::remove_dir_all(program.home().join("state"))?;
    let mut desk = Desk::again(program, &[session.as_os_str()])?;
    let after = desk.window.settle("the session", |state| {
        state.objects() == ["sphere"] && state.session("drawn_by") == POINTS
    })?;
    for key in ["view", "lights", "settings", "renderer", "show"] {
        assert_eq!(after.session(key), before.session(key), "{key}");
    }
    desk.wait_for_picture("after", |shown| same(shown, &picture))?;
    desk.close()
}

#[test]
fn a_window_goes_on_with_the_theme_the_scale_and_the_recent_files_of_the_last() -> Result<()> {
    let Some(mut desk) = Desk::with_sphere()? else {
        return Ok(());
    };
    let planes = scenes::write(desk.program.home(), "planes", &scenes::crossing_planes(60))?;
    desk.type_path(&planes)?;
    desk.window
        .settle("the planes", |state| state.objects() == ["planes"])?;
    desk.window.click_on("Button", "Window")?;
    desk.window.click_on("Button", "Theme")?;
    desk.window.click_on("Button", "Light")?;
    desk.window
        .settle("the light theme", |state| state.session("theme") == "light")?;
    desk.window.press_keys("ctrl+=")?;
    desk.window
        .settle("larger texts", |state| state.session("text_scale") == 1.25)?;
    let program = desk.close_and_keep()?;

    let mut desk = Desk::again(program, &[])?;
    let state = desk.window.settle("the welcome", |state| {
        state.shows("Go on with a recent file")
            && state.session("theme") == "light"
            && state.session("text_scale") == 1.25
    })?;
    let recent = state.session("recent").as_array().map(Vec::len);
    assert_eq!(recent, Some(2), "{}", state.session("recent"));
    desk.window.press_keys("ctrl+shift+0")?;
    desk.window
        .settle("the usual size", |state| state.session("text_scale") == 1.0)?;
    desk.close()
}

#[test]
fn damaged_settings_are_set_aside_and_the_window_says_so() -> Result<()> {
    let program = Program::find()?;
    let folder = program.home().join("state").join("pointstage");
    std::fs::create_dir_all(&folder)?;
    std::fs::write(
        folder.join("settings.toml"),
        "format = 1\ntheme = \"pink\"\n",
    )?;
    let Some(mut desk) = Desk::open(program, &[])? else {
        return Ok(());
    };
    let state = desk.window.settle("the message", |state| {
        state.shows("settings.damaged-1.toml")
    })?;
    let messages = state.messages();
    assert!(
        messages.len() == 1 && messages[0].contains("line 2, column 9"),
        "{messages:?}"
    );
    let aside = std::fs::read_to_string(folder.join("settings.damaged-1.toml"))?;
    assert!(aside.contains("pink"), "nothing is lost");
    desk.close()
}
