//! Camera, stored views and light by hand, by pointer and keys over the picture.

use anyhow::{Context as _, Result, bail};
use glam::DVec3;
use pointstage_tests::window::State;
use serde_json::Value;

use super::desk::{Desk, coloured, same};

/// The middle of the picture, px.
const MIDDLE: (i16, i16) = (370, 360);

/// A place to drag to.
const ASIDE: (i16, i16) = (460, 410);

/// A vector of the view that the state holds.
fn vector(state: &State, field: &str) -> Result<DVec3> {
    let value = &state.session("view")[field];
    let numbers: [f64; 3] = serde_json::from_value(value.clone())
        .with_context(|| format!("{field} of the view is {value}"))?;
    Ok(numbers.into())
}

fn view(state: &State) -> Value {
    state.session("view").clone()
}

/// The state once nothing moves.
fn at_rest(desk: &mut Desk) -> Result<State> {
    desk.window.settle("the camera to rest", |_| true)
}

#[test]
fn a_stored_view_comes_back_by_its_number() -> Result<()> {
    let Some(mut desk) = Desk::with_sphere()? else {
        return Ok(());
    };
    desk.turn()?;
    let stored = view(&at_rest(&mut desk)?);
    let picture = desk.wait_for_picture("to store", |picture| coloured(picture) > 2000)?;
    desk.window.press_keys("ctrl+1")?;
    desk.window.settle("the slot", |state| {
        state.session("views")["slots"][0] == true
    })?;
    desk.turn()?;
    let elsewhere = view(&at_rest(&mut desk)?);
    assert_ne!(elsewhere, stored);
    desk.window.press_keys("1")?;
    desk.window.settle("the stored view", |state| {
        *state.session("view") == stored && state.session("flight") == false
    })?;
    desk.wait_for_picture("recalled", |shown| same(shown, &picture))?;
    desk.close()
}

#[test]
fn a_view_is_kept_in_the_list_renamed_and_recalled() -> Result<()> {
    let Some(mut desk) = Desk::with_sphere()? else {
        return Ok(());
    };
    desk.turn()?;
    let kept = view(&at_rest(&mut desk)?);
    desk.window.click_on("Tab", "View")?;
    desk.scroll_settings_to("Button", "Keep this view")?;
    desk.window.click_on("Button", "Keep this view")?;
    desk.window.settle("the list", |state| {
        state.session("views")["named"] == serde_json::json!(["View 1"])
    })?;
    desk.window.press_keys("x")?;
    desk.window
        .settle("another view", |state| *state.session("view") != kept)?;
    desk.scroll_settings_to("Button", "Recall View 1")?;
    desk.window.click_on("Button", "Recall View 1")?;
    desk.window
        .settle("the kept view", |state| *state.session("view") == kept)?;
    desk.window.click_on("TextInput", "Name of View 1")?;
    desk.window.press_keys("ctrl+a")?;
    desk.window.type_text("Nose")?;
    desk.window.press_keys("Return")?;
    desk.window.settle("the new name", |state| {
        state.session("views")["named"] == serde_json::json!(["Nose"])
    })?;
    desk.close()
}

#[test]
fn a_view_goes_over_the_clipboard_as_text() -> Result<()> {
    let Some(mut desk) = Desk::with_sphere()? else {
        return Ok(());
    };
    desk.turn()?;
    let copied = view(&at_rest(&mut desk)?);
    desk.window.press_keys("ctrl+shift+C")?;
    desk.window
        .settle("the message", |state| state.shows("View copied"))?;
    desk.turn()?;
    desk.window.press_keys("ctrl+shift+V")?;
    desk.window
        .settle("the pasted view", |state| *state.session("view") == copied)?;
    desk.close()
}

#[test]
fn with_inertia_the_camera_glides_on_when_the_button_is_up() -> Result<()> {
    let Some(mut desk) = Desk::with_sphere()? else {
        return Ok(());
    };
    let (from, to) = ((120, 220), (620, 480));
    let released = view(&desk.window.throw(from, to)?);
    assert_eq!(view(&at_rest(&mut desk)?), released, "without inertia");
    desk.window.click_on("Tab", "View")?;
    desk.scroll_settings_to("CheckBox", "Inertia")?;
    desk.window.click_on("CheckBox", "Inertia")?;
    // A slow machine may take a whole throw for one movement, which has no speed.
    for _ in 0..10 {
        let released = view(&desk.window.throw(from, to)?);
        if view(&at_rest(&mut desk)?) != released {
            return desk.close();
        }
    }
    bail!("the camera stopped with the pointer, ten times")
}

#[test]
fn dragging_with_l_moves_the_first_light_and_not_the_camera() -> Result<()> {
    let Some(mut desk) = Desk::with_sphere()? else {
        return Ok(());
    };
    let before = at_rest(&mut desk)?;
    let lights = before.session("lights").clone();
    desk.window.while_holding("l", |window| {
        window.drag_until(MIDDLE, ASIDE, 1, |state| *state.session("lights") != lights)
    })?;
    let after = at_rest(&mut desk)?;
    assert_eq!(view(&after), view(&before), "the camera moved too");
    let [old, new] = [&before, &after].map(|state| state.session("lights")["lights"].clone());
    assert_ne!(new[0], old[0]);
    assert_eq!(new[1], old[1], "the second light moved too");
    desk.close()
}

#[test]
fn with_the_right_button_w_flies_forward_and_d_to_the_right() -> Result<()> {
    let Some(mut desk) = Desk::with_sphere()? else {
        return Ok(());
    };
    let before = at_rest(&mut desk)?;
    let eye = vector(&before, "eye")?;
    let forward = (vector(&before, "pivot")? - eye).normalize();
    let right = forward.cross(vector(&before, "up")?).normalize();
    for (key, direction) in [("w", forward), ("d", right)] {
        let start = vector(&at_rest(&mut desk)?, "eye")?;
        let way = |state: &State| Some(vector(state, "eye").ok()? - start);
        desk.window.while_pressing(MIDDLE, 3, |window| {
            window.wait_for_state("flying", |state| {
                (state.session("flying") == true).then_some(())
            })?;
            window.while_holding(key, |window| {
                window.wait_for_state("the eye to move", |state| {
                    way(state).filter(|way| way.dot(direction) > 0.05)
                })
            })
        })?;
        let way = vector(&at_rest(&mut desk)?, "eye")? - start;
        assert!(way.normalize().dot(direction) > 0.99, "{key} went {way}");
    }
    let still = at_rest(&mut desk)?;
    assert_eq!(still.session("flying"), false);
    desk.close()
}

#[test]
fn f_frames_the_scene_again() -> Result<()> {
    let Some(mut desk) = Desk::with_sphere()? else {
        return Ok(());
    };
    let framed = vector(&at_rest(&mut desk)?, "eye")?;
    for key in ["f", "Home"] {
        desk.window.scroll(MIDDLE.0 + 80, MIDDLE.1, -4)?;
        desk.window.settle("farther away", |state| {
            vector(state, "eye").is_ok_and(|eye| eye.distance(framed) > 0.5)
        })?;
        desk.window.press_keys(key)?;
        desk.window.settle("the scene framed", |state| {
            vector(state, "eye").is_ok_and(|eye| eye.distance(framed) < 1e-6)
        })?;
    }
    desk.close()
}

#[test]
fn without_the_turntable_lock_the_scene_rolls_and_with_it_the_horizon_levels() -> Result<()> {
    let Some(mut desk) = Desk::with_sphere()? else {
        return Ok(());
    };
    desk.window.press_keys("t")?;
    desk.window.settle("the lock to open", |state| {
        state.session("turntable") == false
    })?;
    let is_tilted =
        |state: &State| vector(state, "up").is_ok_and(|up| up.angle_between(DVec3::Y) > 0.1);
    desk.window.while_holding("ctrl", |window| {
        window.drag_until((470, 300), (470, 450), 1, is_tilted)
    })?;
    at_rest(&mut desk)?;
    desk.window.press_keys("t")?;
    desk.window.settle("the horizon to level", |state| {
        let up = vector(state, "up");
        state.session("turntable") == true && up.is_ok_and(|up| up == DVec3::Y)
    })?;
    desk.close()
}

#[test]
fn near_clipping_by_hand_cuts_the_sphere_open() -> Result<()> {
    let Some(mut desk) = Desk::with_sphere()? else {
        return Ok(());
    };
    desk.window.click_on("RadioButton", "Surfels")?;
    let whole = desk.wait_for_picture("whole", |picture| coloured(picture) > 40_000)?;
    desk.window.click_on("Tab", "View")?;
    desk.scroll_settings_to("CheckBox", "automatic")?;
    desk.window.click_on("CheckBox", "automatic")?;
    desk.scroll_settings_to("Slider", "Near plane")?;
    // Up to the far side: the near half is gone on the way, and what is left is less of the picture.
    desk.window.drag_slider("Near plane", 1.0, |state| {
        state.session("view")["near"].as_f64() > Some(3.0)
    })?;
    desk.wait_for_picture("cut", |picture| {
        !same(picture, &whole) && coloured(picture) < coloured(&whole) / 2
    })?;
    desk.scroll_settings_to("CheckBox", "automatic")?;
    desk.window.click_on("CheckBox", "automatic")?;
    desk.wait_for_picture("whole again", |picture| same(picture, &whole))?;
    desk.close()
}

#[test]
fn a_click_on_an_axis_in_the_corner_looks_from_there() -> Result<()> {
    let Some(mut desk) = Desk::with_sphere()? else {
        return Ok(());
    };
    desk.turn()?;
    at_rest(&mut desk)?;
    desk.window.click_on("Button", "Look from right")?;
    desk.window.settle("the view from the right", |state| {
        let [eye, pivot] = ["eye", "pivot"].map(|field| vector(state, field));
        let (Ok(eye), Ok(pivot)) = (eye, pivot) else {
            return false;
        };
        (eye - pivot).normalize().distance(DVec3::X) < 1e-6
    })?;
    desk.close()
}
