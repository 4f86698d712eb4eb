//! Views beside each other: renderers of their own, one camera, the lock, wipe and differences, pixels, numbers, a sweep.

use anyhow::{Context as _, Result, ensure};
use pointstage_tests::window::State;
use serde_json::Value;

use super::SURFEL;
use super::desk::{Desk, POINTS};

/// The field `key` of each view.
fn of_views(state: &State, key: &str) -> Vec<Value> {
    let panes = state.session("panes").as_array();
    let panes = panes.into_iter().flatten();
    panes.map(|pane| pane[key].clone()).collect()
}

/// The middle of a view's picture, pixels of the window.
fn middle_of(state: &State, index: usize) -> Option<(i16, i16)> {
    let rect = &state.session("panes")[index]["rect"];
    let edge = |side: usize| Some(rect[side].as_f64()? as i16);
    Some((edge(0)?.midpoint(edge(2)?), edge(1)?.midpoint(edge(3)?)))
}

impl Desk {
    /// Shows so many views, and the tab about them.
    pub(super) fn show_views(&mut self, count: usize) -> Result<()> {
        self.window.click_on("Tab", "Compare")?;
        self.window.click_on("Button", &format!("{count} views"))?;
        self.window.settle("the views", |state| {
            of_views(state, "drawn_by").len() == count
        })?;
        Ok(())
    }

    /// Draws a view with the renderer of this title.
    pub(super) fn choose_in_view(&mut self, number: usize, title: &str, id: &str) -> Result<()> {
        let combo = format!("Renderer of view {number}");
        let is_there = self.window.wait_for_state("the views", |state| {
            of_views(state, "renderer")
                .get(number - 1)
                .map(|chosen| chosen == id)
        })?;
        if is_there {
            return Ok(());
        }
        self.window.click_on("ComboBox", &combo)?;
        self.window.click_on("Button", title)?;
        self.window.settle("the view's renderer", |state| {
            of_views(state, "drawn_by")
                .get(number - 1)
                .is_some_and(|drawn| drawn == id)
        })?;
        Ok(())
    }

    /// Lays two views in one place.
    fn lay_out(&mut self, name: &str, key: &str) -> Result<()> {
        self.window.click_on("ComboBox", "Layout")?;
        self.window.click_on("Button", name)?;
        self.window.settle("the layout", |state| {
            state.session("comparison")["layout"] == key
        })?;
        Ok(())
    }
}

#[test]
fn two_views_by_one_renderer_differ_by_nothing_and_by_two_they_do() -> Result<()> {
    let Some(mut desk) = Desk::with_sphere()? else {
        return Ok(());
    };
    desk.show_views(2)?;
    desk.window.click_on("CheckBox", "Fair comparison")?;
    let state = desk.window.settle("equal views", |state| {
        of_views(state, "numbers")
            .get(1)
            .is_some_and(|numbers| numbers == "identical")
    })?;
    let sizes = of_views(&state, "picture_px");
    assert_eq!(sizes[0], sizes[1]);
    let bytes = of_views(&state, "scene_bytes");
    assert_eq!(bytes[0], bytes[1], "the scene is on the device once");
    desk.choose_in_view(2, "Surfels", SURFEL)?;
    let state = desk.window.settle("numbers", |state| {
        let numbers = of_views(state, "numbers");
        numbers.get(1).is_some_and(|numbers| {
            numbers
                .as_str()
                .is_some_and(|text| text.starts_with("PSNR "))
        })
    })?;
    assert_eq!(of_views(&state, "renderer"), [POINTS, SURFEL]);
    assert_eq!(state.session("comparison")["active"], 1);
    desk.close()
}

#[test]
fn linked_cameras_turn_together_and_free_ones_alone() -> Result<()> {
    let Some(mut desk) = Desk::with_sphere()? else {
        return Ok(());
    };
    desk.show_views(2)?;
    let state = desk.window.settle("two views", |_| true)?;
    let (x, y) = middle_of(&state, 1).context("view 2 has a place")?;
    let before = of_views(&state, "view");
    let eyes = |state: &State| -> Vec<Value> {
        let views = of_views(state, "view");
        views.iter().map(|view| view["eye"].clone()).collect()
    };
    desk.window
        .drag_until((x, y), (x + 60, y + 20), 1, |state| {
            of_views(state, "view") != before
        })?;
    let state = desk
        .window
        .settle("turned", |state| state.session("comparison")["active"] == 1)?;
    let turned = eyes(&state);
    assert_eq!(turned[0], turned[1], "linked");
    desk.window.click_on("CheckBox", "Linked cameras")?;
    desk.window
        .drag_until((x, y), (x + 60, y + 20), 1, |state| {
            eyes(state)[1] != turned[1]
        })?;
    let state = desk.window.settle("turned alone", |_| true)?;
    assert_eq!(eyes(&state)[0], turned[0], "view 1 stays");
    desk.close()
}

#[test]
fn the_lock_holds_views_to_one_radius_scale_and_says_who_does_not_follow() -> Result<()> {
    let Some(mut desk) = Desk::with_sphere()? else {
        return Ok(());
    };
    desk.show_views(2)?;
    desk.choose_in_view(2, "Surfels", SURFEL)?;
    desk.window.click_on("CheckBox", "Fair comparison")?;
    desk.window.click_on("Tab", "View")?;
    desk.window.drag_slider("Radius scale", 0.9, |state| {
        let unmet = of_views(state, "unmet");
        unmet
            .first()
            .is_some_and(|unmet| unmet.to_string().contains("radius scale"))
    })?;
    let state = desk.window.settle("the lock", |state| {
        let unmet = of_views(state, "unmet");
        unmet
            .first()
            .is_some_and(|unmet| unmet.to_string().contains("radius scale"))
    })?;
    assert_eq!(of_views(&state, "unmet")[1], serde_json::json!([]));
    ensure!(
        state.shows("⚠ does not follow the radius scale"),
        "it stands above the view"
    );
    desk.close()
}

#[test]
fn wipe_difference_pixels_and_zoom_work_by_pointer_and_keys() -> Result<()> {
    let Some(mut desk) = Desk::with_sphere()? else {
        return Ok(());
    };
    desk.show_views(2)?;
    desk.choose_in_view(2, "Surfels", SURFEL)?;
    desk.lay_out("Wipe", "wipe")?;
    let handle = desk.window.find("Slider", "Wipe")?;
    let from = handle.middle();
    desk.window.point_at(from.0, from.1)?;
    desk.window.settle("the pointer", |_| true)?;
    desk.window.while_pressing(from, 1, |window| {
        // What the button goes down on is what lies under the pointer then.
        window.wait_for_state("the handle to be taken", |state| {
            state.widget("Slider", "Wipe")?.is_focused.then_some(())
        })?;
        window.point_at(from.0 - 120, from.1)?;
        window.wait_for_state("the handle to follow", |state| {
            let wipe = state.session("comparison")["wipe"].as_f64()?;
            (wipe < 0.45).then_some(())
        })
    })?;
    let before = desk.window.settle("the handle", |_| true)?;
    let wipe = |state: &State| state.session("comparison")["wipe"].as_f64();
    desk.window.press_keys("Right")?;
    desk.window
        .settle("the handle by keys", |state| wipe(state) > wipe(&before))?;
    for (name, key) in [
        ("Absolute difference", "absolute"),
        ("Signed difference", "signed"),
        ("FLIP difference", "flip"),
    ] {
        desk.lay_out(name, key)?;
        desk.window.settle("the difference", |state| {
            state.session("comparison")["difference"] == true
        })?;
    }
    desk.lay_out("Grid", "grid")?;
    desk.window
        .click_on("CheckBox", "Pixels: one line of sight in every view")?;
    let state = desk.window.settle("the grid", |state| {
        state.session("comparison")["layout"] == "grid"
    })?;
    // The panel lies over the active view, which is the other one.
    let (x, y) = middle_of(&state, 0).context("view 1 has a place")?;
    desk.window.point_at(x, y)?;
    desk.window.wait_for_state("both surfels", |state| {
        let is_there = state.shows("target depth") && state.shows("sphere, surfel ");
        is_there.then_some(())
    })?;
    desk.window.while_holding("alt", |window| {
        window.scroll(x, y, 3)?;
        window.wait_for_state("the pixels", |state| {
            let zoom = state.session("comparison")["zoom"].as_f64()?;
            (zoom > 1.2).then_some(())
        })
    })?;
    desk.window
        .click_on("Button", "Pictures in their own size")?;
    desk.window.settle("all of it", |state| {
        state.session("comparison")["zoom"].is_null()
    })?;
    desk.close()
}

#[test]
fn a_sweep_is_shown_and_a_click_applies_a_value() -> Result<()> {
    let Some(mut desk) = Desk::with_sphere()? else {
        return Ok(());
    };
    let sweep = desk.program.home().join("sweep.json");
    let value = |value: &str, error: f64, time: f64| {
        serde_json::json!({
            "value": value, "label": value,
            "whole": { "pixels": 4, "identical": false, "ssim": 1.0 - error, "flip_mean": error },
            "times": { "frame_ms": { "median": time } },
        })
    };
    let text = serde_json::json!({
        "format": 1, "size": [8, 8], "renderer": "surfel", "setting": "splat_scale", "unit": "",
        "values": [value("0.5", 0.2, 10.0), value("1.5", 0.1, 20.0)],
    });
    std::fs::write(&sweep, text.to_string())?;
    desk.window.drop_files(&[&sweep], 300, 300)?;
    desk.window.find("Image", "Curve of the sweep")?;
    desk.window.click_on("Button", "1.5")?;
    desk.window.settle("the value", |state| {
        state.session("drawn_by") == SURFEL && state.session("settings")["splat_scale"] == 1.5
    })?;
    desk.close()
}

#[test]
fn a_session_keeps_all_views_and_undo_brings_them_back() -> Result<()> {
    let Some(mut desk) = Desk::with_sphere()? else {
        return Ok(());
    };
    desk.show_views(3)?;
    desk.choose_in_view(3, "Surfels", SURFEL)?;
    let session = desk.program.home().join("three.pointstage.toml");
    desk.save_session(&session)?;
    desk.window.click_on("Button", "1 view")?;
    desk.window
        .settle("one view", |state| of_views(state, "renderer").len() == 1)?;
    desk.window.press_keys("ctrl+z")?;
    desk.window.settle("three again", |state| {
        of_views(state, "renderer") == [POINTS, POINTS, SURFEL]
    })?;
    let program = desk.close_and_keep()?;
    let mut desk = Desk::again(program, &[session.as_os_str()])?;
    let state = desk.window.settle("the session", |state| {
        of_views(state, "drawn_by") == [POINTS, POINTS, SURFEL]
    })?;
    assert_eq!(state.session("comparison")["active"], 2);
    desk.close()
}
