//! While the window changes its size, the picture is neither stretched nor gone.

use std::time::{Duration, Instant};

use anyhow::{Result, ensure};
use image::RgbaImage;
use pointstage_tests::window::State;

use super::SURFEL;
use super::desk::Desk;

/// Sizes that the window takes, px: wider, narrower, higher, lower, and both.
const SIZES: [(u32, u32); 6] = [
    (700, 720),
    (1100, 720),
    (1100, 420),
    (1100, 720),
    (640, 440),
    (1100, 720),
];

/// How long the window is watched after each change.
const WATCHED: Duration = Duration::from_millis(700);

/// Width over height of what is coloured in the part of the display that the window has; none where there is nothing.
fn shape(display: &RgbaImage, (width, height): (u32, u32)) -> Option<f64> {
    let is_coloured = |x: u32, y: u32| {
        let [red, green, blue, _] = display.get_pixel(x, y).0;
        red.max(green).max(blue) - red.min(green).min(blue) > 40
    };
    let mut least = [u32::MAX; 2];
    let mut greatest = [0; 2];
    for y in 0..height {
        for x in (0..width).filter(|&x| is_coloured(x, y)) {
            for (axis, at) in [x, y].into_iter().enumerate() {
                least[axis] = least[axis].min(at);
                greatest[axis] = greatest[axis].max(at);
            }
        }
    }
    // Less than this is no sphere.
    const LEAST: u32 = 60;
    let side = |axis: usize| {
        let side = greatest[axis].checked_sub(least[axis])? + 1;
        (side > LEAST).then_some(f64::from(side))
    };
    Some(side(0)? / side(1)?)
}

#[test]
fn a_window_that_is_resized_shows_the_sphere_round_at_all_times() -> Result<()> {
    let Some(mut desk) = Desk::with_sphere()? else {
        return Ok(());
    };
    let window = &mut desk.window;
    window.click_on("RadioButton", "Surfels")?;
    window.settle("surfels", |state| state.session("drawn_by") == SURFEL)?;
    // So that nothing but the sphere is coloured.
    window.click_on("Tab", "View")?;
    desk.scroll_settings_to("CheckBox", "Axes and lights in the corner")?;
    let window = &mut desk.window;
    window.click_on("CheckBox", "Axes and lights in the corner")?;
    window.press_keys("ctrl+,")?;
    window.settle("the picture alone", |state| {
        state.widget("Tab", "View").is_none()
    })?;
    for size in SIZES {
        window.resize(size.0, size.1)?;
        let start = Instant::now();
        let mut since = None;
        while start.elapsed() < WATCHED {
            let passes = window.wait_for_state("a pass", State::passes)?;
            let shape = shape(&window.capture()?, size);
            if shape.is_some_and(|shape| (shape - 1.0).abs() < 0.05) {
                since = None;
                continue;
            }
            let since = *since.get_or_insert(passes);
            // One frame may be on its way, and one more may have begun since.
            ensure!(
                passes <= since + 2,
                "at {size:?} the sphere was {shape:?} times as wide as high from pass {since} to {passes}"
            );
        }
        window.settle("the picture of this size", |_| true)?;
    }
    desk.close()
}
