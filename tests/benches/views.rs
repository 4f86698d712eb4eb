//! Four linked views of one scene against the same four alone: what a picture of all takes, and what the device holds.
//!
//! ```text
//! cargo xtask bench views                the brain of the shared test data folder, 1.09 M surfels
//! cargo xtask bench views -- FILE.ply    another file
//! ```
//!
//! Four viewports of 400x290 pixels, as a window of 800x580 divides into, draw the scene with one camera that turns by a
//! quarter degree a frame: `points`, `surfel`, `hqss`, and `hqss` without its filter. 'Alone' is a session with that viewport
//! only. Sessions take turns, so that a busy moment meets all; the figures are medians.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use anyhow::{Context as _, Result};
use glam::DQuat;
use pointstage_engine::stage::{FrameRequest, SettingValue, SettingValues, Stage, ViewportId};
use pointstage_scene::{Camera, Scene};
use pointstage_tests::{data, stages};

const SIZE_PX: [u32; 2] = [400, 290];
const TURN_RAD: f64 = 0.25 * std::f64::consts::PI / 180.0;
/// Times that all sessions take turns.
const ROUNDS: usize = 8;
/// Frames of each view that count, in each round.
const FRAMES: usize = 8;
/// Frames of each view drawn first in each round.
const WARM_UP: usize = 2;

const PLUGINS: [&str; 3] = ["points", "surfel", "hqss"];

/// A session with some of the four viewports.
struct Session {
    name: String,
    stage: Stage,
    requests: Vec<FrameRequest>,
    times: Vec<Duration>,
    scene_bytes: u64,
    device_bytes: u64,
}

fn main() -> Result<()> {
    // `cargo bench` adds --bench.
    let file = std::env::args().skip(1).find(|word| !word.starts_with('-'));
    let Some(file) = file
        .map(PathBuf::from)
        .or_else(|| data::shared("mesh/brain_ch2better_1092k_le.ply"))
    else {
        return Ok(());
    };
    let scene = stages::scene_of_file(&file)?;
    println!("{}: {} surfels", file.display(), scene.surfel_count());
    let views = views(&scene);
    let mut sessions: Vec<Session> = views
        .iter()
        .map(|(name, request)| Session::new(name, vec![request.clone()]))
        .collect::<Result<_>>()?;
    let all = views.into_iter().map(|(_, request)| request).collect();
    sessions.push(Session::new("all four", all)?);
    for _ in 0..ROUNDS {
        for session in &mut sessions {
            session.draw_round()?;
        }
    }
    println!(
        "| views | ms | scene on the device, MB | with targets and renderers, MB |\n|---|---|---|---|"
    );
    for session in &mut sessions {
        let median = session.median();
        println!(
            "| {} | {:.1} | {:.1} | {:.1} |",
            session.name,
            median.as_secs_f64() * 1e3,
            session.scene_bytes as f64 / 1e6,
            session.device_bytes as f64 / 1e6
        );
    }
    let together = sessions.pop().context("there are five")?.median();
    let alone: Duration = sessions.iter_mut().map(Session::median).sum();
    let ratio = together.as_secs_f64() / alone.as_secs_f64();
    println!(
        "four linked views: {:.1} ms, the sum of the four alone: {:.1} ms, ratio {ratio:.3}",
        together.as_secs_f64() * 1e3,
        alone.as_secs_f64() * 1e3
    );
    Ok(())
}

/// The four views, each with a name.
fn views(scene: &Arc<Scene>) -> Vec<(&'static str, FrameRequest)> {
    let of = |viewport: u32, renderer: &str, settings: SettingValues| FrameRequest {
        viewport: ViewportId(viewport),
        settings,
        ..stages::window_frame(scene, SIZE_PX, renderer)
    };
    let unfiltered = [("filter".to_owned(), SettingValue::Bool(false))];
    vec![
        ("points", of(0, "points", SettingValues::new())),
        ("surfel", of(1, "surfel", SettingValues::new())),
        ("hqss", of(2, "hqss", SettingValues::new())),
        (
            "hqss, no filter",
            of(3, "hqss", SettingValues::from(unfiltered)),
        ),
    ]
}

impl Session {
    fn new(name: &str, requests: Vec<FrameRequest>) -> Result<Self> {
        Ok(Self {
            name: name.to_owned(),
            stage: stages::stage(&PLUGINS)?,
            requests,
            times: Vec::new(),
            scene_bytes: 0,
            device_bytes: 0,
        })
    }

    /// Draws all views of one camera after another, frame by frame.
    fn draw_round(&mut self) -> Result<()> {
        for number in 0..WARM_UP + FRAMES {
            let mut time = Duration::ZERO;
            let mut bytes = 0;
            for request in &mut self.requests {
                turn(&mut request.camera);
                let stats = self.stage.frame(request)?.stats;
                time += stats.total;
                self.scene_bytes = stats.scene_bytes;
                bytes += stats.target_bytes;
            }
            if number >= WARM_UP {
                self.times.push(time);
            }
            let holdings = self.stage.all_holdings();
            let held: u64 = holdings.iter().map(|held| held.bytes).sum();
            self.device_bytes = self.scene_bytes + bytes + held;
        }
        Ok(())
    }

    fn median(&mut self) -> Duration {
        self.times.sort_unstable();
        self.times[self.times.len() / 2]
    }
}

fn turn(camera: &mut Camera) {
    let turn = DQuat::from_axis_angle(camera.up, TURN_RAD);
    camera.eye = camera.pivot + turn * (camera.eye - camera.pivot);
}
