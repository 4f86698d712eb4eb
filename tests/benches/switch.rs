//! What a switch of renderers costs beyond the frame itself, at 5 M surfels: to one that is prepared, and to one that
//! is not. The frames before and after are the baseline, in the same run. Medians.
//!
//! `cargo xtask bench switch`, or `cargo bench -p pointstage-tests --bench switch -- [surfels]` after a release build.

use std::sync::Arc;
use std::time::{Duration, Instant};

use anyhow::{Context as _, Result, ensure};
use pointstage_engine::stage::{FrameRequest, Stage};
use pointstage_scene::Scene;
use pointstage_tests::{scenes, stages};

const RENDERERS: [&str; 2] = ["points", "surfel"];
const SIZE_PX: [u32; 2] = [800, 580];
/// Switches between prepared renderers; every other one is to the same renderer.
const SWITCHES: usize = 20;
/// Sessions in which a renderer is switched to for the first time.
const SESSIONS: usize = 5;
/// Frames after which a renderer's own cost is taken as steady.
const STEADY: usize = 3;

fn main() -> Result<()> {
    let number = std::env::args().find_map(|argument| argument.parse().ok());
    let count = number.unwrap_or(5_000_000);
    let folder = tempfile::tempdir()?;
    let scene = stages::scene(folder.path(), "sphere", &scenes::sphere(count, 1.0))?;
    println!(
        "{count} surfels at {}x{}; times in ms, medians",
        SIZE_PX[0], SIZE_PX[1]
    );
    prepared(&scene)?;
    unprepared(&scene)
}

fn frames(scene: &Arc<Scene>) -> [FrameRequest; 2] {
    RENDERERS.map(|renderer| stages::window_frame(scene, SIZE_PX, renderer))
}

fn timed(stage: &mut Stage, request: &FrameRequest) -> Result<Duration> {
    let start = Instant::now();
    let result = stage.frame(request)?;
    let time = start.elapsed();
    ensure!(
        result.drawn_by.ends_with(&request.renderer),
        "{} drew instead",
        result.drawn_by
    );
    Ok(time)
}

/// Back and forth within one session: the frame after a switch, less the one that follows it.
fn prepared(scene: &Arc<Scene>) -> Result<()> {
    let frames = frames(scene);
    let mut stage = stages::stage(&RENDERERS)?;
    let adapter = stage.adapter().context("no device")?;
    println!("{} ({})", adapter.name, adapter.backend);
    for frame in &frames {
        timed(&mut stage, frame)?;
    }
    let mut times = [(); 2].map(|()| (Vec::new(), Vec::new()));
    for switch in 0..SWITCHES {
        let (first, next) = &mut times[switch % 2];
        first.push(timed(&mut stage, &frames[switch % 2])?);
        next.push(timed(&mut stage, &frames[switch % 2])?);
    }
    for (renderer, (first, next)) in RENDERERS.iter().zip(times) {
        tell(&format!("to {renderer}, prepared"), first, next);
    }
    Ok(())
}

/// In new sessions, where the other renderer has drawn: library, preparation and first frame, less a steady frame.
fn unprepared(scene: &Arc<Scene>) -> Result<()> {
    let frames = frames(scene);
    for (to, renderer) in RENDERERS.iter().enumerate() {
        let (mut firsts, mut steadies) = (Vec::new(), Vec::new());
        for _ in 0..SESSIONS {
            let mut stage = stages::stage(&RENDERERS)?;
            for _ in 0..STEADY {
                timed(&mut stage, &frames[1 - to])?;
            }
            firsts.push(timed(&mut stage, &frames[to])?);
            for _ in 0..STEADY {
                steadies.push(timed(&mut stage, &frames[to])?);
            }
        }
        tell(&format!("to {renderer}, not prepared"), firsts, steadies);
    }
    Ok(())
}

fn tell(what: &str, first: Vec<Duration>, steady: Vec<Duration>) {
    let [first, steady] = [first, steady].map(median_ms);
    println!(
        "{what:28} first {first:8.1}   steady {steady:8.1}   beyond {:8.1}",
        first - steady
    );
}

fn median_ms(mut times: Vec<Duration>) -> f64 {
    times.sort();
    let median = times.get(times.len() / 2).copied().unwrap_or_default();
    median.as_secs_f64() * 1e3
}
