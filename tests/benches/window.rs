//! What the window costs beside its renderer, from a gesture to the picture of it: the scene is turned by the pointer in the
//! real window on a virtual display, and each picture's times are read from the window's state. Medians and 95th
//! percentiles, ms.
//!
//! `cargo xtask bench window`, or `cargo bench -p pointstage-tests --bench window -- [surfels]` after a release build.

use anyhow::Result;
use pointstage_tests::program::Program;
use pointstage_tests::scenes;
use pointstage_tests::window::{Display, State, Window};

/// Pictures that are looked at.
const PICTURES: usize = 60;

/// Parts of a picture's way through the host.
const PARTS: [&str; 3] = ["ask", "engine", "show"];

fn main() -> Result<()> {
    let number = std::env::args().find_map(|argument| argument.parse().ok());
    let count = number.unwrap_or(100_000);
    let program = Program::find()?;
    let scene = scenes::write(program.home(), "sphere", &scenes::sphere(count, 1.0))?;
    let Some(display) = Display::start(1100, 720)? else {
        return Ok(());
    };
    let mut window = Window::open(&display, &program, [scene.as_os_str()])?;
    window.resize(1100, 720)?;
    let state = window.settle("the sphere", |state| !state.objects().is_empty())?;
    println!("{count} surfels, {}; times in ms", state.session("adapter"));
    for renderer in ["Points", "Surfels"] {
        window.click_on("RadioButton", renderer)?;
        window.settle(renderer, |_| true)?;
        report(renderer, &times_of_a_turn(&mut window)?);
    }
    Ok(())
}

/// Turns the scene, and collects each picture's times.
fn times_of_a_turn(window: &mut Window) -> Result<Vec<[f64; 3]>> {
    let mut times: Vec<[f64; 3]> = Vec::new();
    let (left, right) = ((250, 360), (450, 400));
    while times.len() < PICTURES {
        let (from, to) = if times.len().is_multiple_of(2) {
            (left, right)
        } else {
            (right, left)
        };
        let mut before: Option<[f64; 3]> = None;
        window.drag_until(from, to, 1, |state| {
            let now = host_times(state);
            if now.is_some() && now != before {
                times.extend(now);
                before = now;
            }
            times.len() % 10 == 9 || times.len() >= PICTURES
        })?;
        let last = window.settle("a still picture", |_| true)?;
        times.extend(host_times(&last));
    }
    Ok(times)
}

fn host_times(state: &State) -> Option<[f64; 3]> {
    let times = state.session("host_ms");
    let [ask, engine, show] = PARTS.map(|part| times[part].as_f64());
    Some([ask?, engine?, show?])
}

fn report(renderer: &str, times: &[[f64; 3]]) {
    let line = |name: &str, mut values: Vec<f64>| {
        values.sort_by(f64::total_cmp);
        let at = |part: f64| values[((values.len() - 1) as f64 * part) as usize];
        println!(
            "{renderer:>8} {name:>8}  median {:6.2}  p95 {:6.2}",
            at(0.5),
            at(0.95)
        );
    };
    for (index, part) in PARTS.iter().enumerate() {
        line(part, times.iter().map(|times| times[index]).collect());
    }
    line(
        "sum",
        times.iter().map(|times| times.iter().sum()).collect(),
    );
}
