//! The settings panel of a renderer with a setting of every kind: each is changed as a person would, and all is undone.

use anyhow::{Result, ensure};
use image::RgbaImage;
use pointstage_tests::plugins;
use pointstage_tests::program::Program;
use pointstage_tests::window::State;
use serde_json::{Value, json};

use super::desk::{Desk, sphere};

const EVERYTHING: &str = "org.pointstage.test.everything";

/// Tall enough for all settings without scrolling, px.
const SIZE: (u16, u16) = (1100, 1200);

/// Settings of the plugin, in the order of its bars.
const BARS: [&str; 11] = [
    "switch", "count", "amount", "scale", "offset", "form", "corner", "tint", "note", "thorough",
    "again",
];

/// The colour of a setting's bar, at the picture's left edge, where nothing lies over it.
fn bar(picture: &RgbaImage, setting: &str) -> [u8; 3] {
    let index = BARS.iter().position(|id| *id == setting).unwrap_or(0) as u32;
    let y = (2 * index + 1) * picture.height() / (2 * BARS.len() as u32);
    let [red, green, blue, _] = picture.get_pixel(4, y).0;
    [red, green, blue]
}

fn setting<'a>(state: &'a State, id: &str) -> &'a Value {
    &state.session("settings")[id]
}

/// The desk, and what its picture showed last.
struct Bench {
    desk: Desk,
    picture: RgbaImage,
}

impl Bench {
    fn open() -> Result<Option<Self>> {
        let program = Program::find()?;
        let sphere = sphere(program.home())?;
        let plugin = plugins::everything()?;
        let arguments = ["--plugin".as_ref(), plugin.as_os_str(), sphere.as_os_str()];
        let Some(mut desk) = Desk::open_at(program, &arguments, SIZE)? else {
            return Ok(None);
        };
        desk.window.settle("the bars", |state| {
            state.objects() == ["sphere"] && state.session("drawn_by") == EVERYTHING
        })?;
        // The display may still show the window in the size that it opened with.
        let picture =
            desk.wait_for_picture("all bars", |picture| bar(picture, "tint") != [0, 0, 0])?;
        Ok(Some(Self { desk, picture }))
    }

    /// Waits until the setting has a value that `accept` says yes to, and its bar another colour. No other bar may change.
    fn changed(&mut self, id: &str, accept: impl Fn(&Value) -> bool) -> Result<()> {
        self.desk
            .window
            .settle(id, |state| accept(setting(state, id)))?;
        let before = bar(&self.picture, id);
        let after = self
            .desk
            .wait_for_picture(id, |picture| bar(picture, id) != before)?;
        for other in BARS.iter().filter(|other| **other != id) {
            ensure!(
                bar(&after, other) == bar(&self.picture, other),
                "{id} changed the bar of {other} from {:?} to {:?}",
                bar(&self.picture, other),
                bar(&after, other)
            );
        }
        self.picture = after;
        Ok(())
    }

    /// Drags a slider towards its right end, until its value is above `least`.
    fn drag(&mut self, name: &str, id: &str, least: f64) -> Result<()> {
        self.desk.window.drag_slider(name, 1.0, |state| {
            let value = setting(state, id).as_f64();
            value.is_some_and(|value| value > least)
        })
    }
}

#[test]
fn every_kind_of_setting_is_changed_by_hand_and_all_is_undone() -> Result<()> {
    let Some(mut bench) = Bench::open()? else {
        return Ok(());
    };
    let first = bench.picture.clone();

    bench.desk.window.click_on("CheckBox", "Switch")?;
    bench.changed("switch", |value| *value == true)?;

    bench.drag("Count", "count", 2.0)?;
    bench.changed("count", |value| {
        value.as_i64().is_some_and(|count| count > 2)
    })?;
    bench.drag("Amount", "amount", 0.5)?;
    bench.changed("amount", |value| {
        value.as_f64().is_some_and(|part| part > 0.5)
    })?;
    bench.drag("Scale", "scale", 1.0)?;
    bench.changed("scale", |value| {
        value.as_f64().is_some_and(|scale| scale > 1.0)
    })?;

    bench.desk.window.type_into("SpinButton", "Offset", "3")?;
    bench.desk.window.press_keys("Return")?;
    bench.changed("offset", |value| *value == 3.0)?;

    bench.desk.window.click_on("ComboBox", "Form")?;
    bench.desk.window.click_on("Button", "Square")?;
    bench.changed("form", |value| *value == "square")?;
    // It was not there before.
    bench.drag("Corner", "corner", 0.5)?;
    bench.changed("corner", |value| {
        value.as_f64().is_some_and(|part| part > 0.5)
    })?;

    bench.desk.window.type_into("TextInput", "Note", "hello!")?;
    bench.desk.window.press_keys("Return")?;
    bench.changed("note", |value| *value == "hello!")?;

    bench.desk.window.click_on("CheckBox", "Thorough")?;
    bench.changed("thorough", |value| *value == true)?;

    bench.desk.window.click_on("Button", "Again")?;
    bench.changed("again", Value::is_null)?;

    // An action has no value; everything else is taken back, one gesture a step.
    for _ in 0..9 {
        let before = bench
            .desk
            .window
            .wait_for_state("the step", |state| Some(state.session("redo").clone()))?;
        bench.desk.window.press_keys("ctrl+z")?;
        bench.desk.window.wait_for_state("a step back", |state| {
            let is_next = *state.session("redo") != before;
            is_next.then_some(())
        })?;
    }
    bench.desk.window.settle("the first values", |state| {
        *state.session("settings") == json!({}) && state.session("undo").is_null()
    })?;
    bench.desk.wait_for_picture("the first bars", |picture| {
        BARS[..10]
            .iter()
            .all(|id| bar(picture, id) == bar(&first, id))
    })?;
    bench.desk.window.press_keys("ctrl+shift+z")?;
    bench
        .desk
        .window
        .settle("a step again", |state| *setting(state, "switch") == true)?;
    bench.desk.close()
}
