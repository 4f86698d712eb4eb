//! How fast `points`, `surfel` and `hqss` draw a scan through the whole engine, beside VTK's mappers on the same machine.
//!
//! ```text
//! cargo xtask bench draw                                  the brain of the shared test data folder
//! cargo xtask bench draw -- FILE.ply                      another file
//! cargo xtask bench draw -- 10000000                      a sphere of so many surfels
//! cargo xtask bench draw -- surfel                        the cases whose names contain a word
//! POINTSTAGE_PEERS_PYTHON=venv/bin/python cargo xtask …   beside VTK, which runs on a virtual display
//! ```
//!
//! VTK comes from PyPI, in an environment outside the repository: `python3 -m venv venv` and `venv/bin/pip install vtk`.
//! `tests/peers/vtk_points.py` draws with it, on Mesa's software OpenGL.
//!
//! Both sides draw 800x580 pixels and turn the camera by a quarter degree a frame. Our frame is the engine's: from the
//! request to the composed picture in memory. VTK's ends with one pixel in memory. Loading, upload and pipelines come
//! before the clock starts. Rounds alternate between us and the peer, so that a busy moment meets both; the figures are
//! medians over all frames of all rounds. 'colour, depth' are the targets of every picture; 'all targets' asks for
//! every one that the renderer gives and reads them back, too.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Arc;
use std::time::Duration;

use anyhow::{Context as _, Result, ensure};
use glam::DQuat;
use pointstage_engine::stage::{FrameRequest, FrameStats, SettingValue, Stage};
use pointstage_scene::{Camera, Scene, orbit_cameras};
use pointstage_tests::{data, program, scenes, stages};

const SIZE_PX: [u32; 2] = [800, 580];
/// Turn of the camera from frame to frame.
const TURN_RAD: f64 = 0.25 * std::f64::consts::PI / 180.0;
/// Times that both sides take turns.
const ROUNDS: usize = 3;
/// Frames that count, of each case in each round.
const FRAMES: usize = 10;
/// Frames drawn first in each round: upload, pipelines, caches.
const WARM_UP: usize = 3;

/// One way to draw, and the peer's mapper that it is held against.
struct Case {
    name: &'static str,
    renderer: &'static str,
    settings: &'static [(&'static str, Value)],
    read_back: &'static [&'static str],
    mapper: Option<&'static str>,
}

/// A setting, before it is a value of the engine's.
#[derive(Clone, Copy)]
enum Value {
    Choice(&'static str),
    Float(f64),
}

const ALL_TARGETS: &[&str] = &["normal", "id", "kind", "lod"];
const ONE_PIXEL: &[(&str, Value)] = &[("size", Value::Float(1.0))];

const CASES: &[Case] = &[
    Case {
        name: "points, 1 px",
        renderer: "points",
        settings: ONE_PIXEL,
        read_back: &[],
        mapper: Some("points"),
    },
    Case {
        name: "points, 1 px, all targets",
        renderer: "points",
        settings: ONE_PIXEL,
        read_back: ALL_TARGETS,
        mapper: Some("points"),
    },
    Case {
        name: "points, 2 px",
        renderer: "points",
        settings: &[],
        read_back: &[],
        mapper: None,
    },
    Case {
        name: "points, from radius",
        renderer: "points",
        settings: &[("size_mode", Value::Choice("attenuated"))],
        read_back: &[],
        mapper: None,
    },
    Case {
        name: "points, 1 px, raster",
        renderer: "points",
        settings: &[
            ("size", Value::Float(1.0)),
            ("path", Value::Choice("raster")),
        ],
        read_back: &[],
        mapper: None,
    },
    Case {
        name: "surfel",
        renderer: "surfel",
        settings: &[],
        read_back: &[],
        mapper: Some("gaussian"),
    },
    Case {
        name: "surfel, all targets",
        renderer: "surfel",
        settings: &[],
        read_back: ALL_TARGETS,
        mapper: Some("gaussian"),
    },
    Case {
        name: "surfel, compute",
        renderer: "surfel",
        settings: &[("path", Value::Choice("compute"))],
        read_back: &[],
        mapper: None,
    },
    Case {
        name: "surfel, raster",
        renderer: "surfel",
        settings: &[("path", Value::Choice("raster"))],
        read_back: &[],
        mapper: None,
    },
    Case {
        name: "hqss",
        renderer: "hqss",
        settings: &[],
        read_back: &[],
        mapper: Some("gaussian"),
    },
    Case {
        name: "hqss, all targets",
        renderer: "hqss",
        settings: &[],
        read_back: ALL_TARGETS,
        mapper: Some("gaussian"),
    },
    Case {
        name: "hqss, compute",
        renderer: "hqss",
        settings: &[("path", Value::Choice("compute"))],
        read_back: &[],
        mapper: None,
    },
    Case {
        name: "hqss, raster",
        renderer: "hqss",
        settings: &[("path", Value::Choice("raster"))],
        read_back: &[],
        mapper: None,
    },
];

fn main() -> Result<()> {
    // `cargo bench` adds --bench.
    let arguments = std::env::args().skip(1);
    let (files, words): (Vec<String>, Vec<String>) = arguments
        .filter(|argument| !argument.starts_with('-'))
        .partition(|argument| Path::new(argument).extension().is_some());
    let (counts, words): (Vec<String>, Vec<String>) = words
        .into_iter()
        .partition(|word| word.parse::<u32>().is_ok());
    let cases: Vec<&Case> = CASES
        .iter()
        .filter(|case| words.iter().all(|word| case.name.contains(word.as_str())))
        .collect();
    let folder = tempfile::tempdir()?;
    let spheres = counts.iter().filter_map(|count| count.parse().ok());
    let spheres = spheres.map(|count: u32| {
        let sphere = scenes::sphere(count, 1.0);
        scenes::write(folder.path(), &format!("sphere_{count}"), &sphere)
    });
    let spheres: Vec<PathBuf> = spheres.collect::<Result<_>>()?;
    let files: Vec<PathBuf> = if !spheres.is_empty() {
        spheres
    } else if files.is_empty() {
        let Some(brain) = data::shared("mesh/brain_ch2better_1092k_le.ply") else {
            return Ok(());
        };
        vec![brain]
    } else {
        files.into_iter().map(PathBuf::from).collect()
    };
    files.iter().try_for_each(|file| compare(file, &cases))
}

/// Draws one file by the cases and by the peer, and prints a table.
fn compare(file: &Path, cases: &[&Case]) -> Result<()> {
    let scene = stages::scene_of_file(file)?;
    let surfel_count = scene.surfel_count();
    let mut stage = stages::stage(&["points", "surfel", "hqss"])?;
    let mut ours: Vec<Vec<FrameStats>> = cases.iter().map(|_| Vec::new()).collect();
    let mut peer: BTreeMap<String, Vec<f64>> = BTreeMap::new();
    let mut peer_name = None;
    for _ in 0..ROUNDS {
        for (case, frames) in cases.iter().zip(&mut ours) {
            frames.extend(draw(&mut stage, &scene, case)?);
        }
        if let Some(drawn) = draw_with_vtk(file)? {
            for (mapper, times) in drawn.times {
                peer.entry(mapper).or_default().extend(times);
            }
            peer_name = Some(drawn.name);
        }
    }
    let adapter = stage.adapter().context("the stage has no device")?;
    println!(
        "\n{}: {surfel_count} surfels, {}x{} pixels\nours: {} ({}, {})",
        file.display(),
        SIZE_PX[0],
        SIZE_PX[1],
        adapter.name,
        adapter.backend,
        adapter.driver
    );
    match &peer_name {
        Some(name) => println!("peer: {name}"),
        None => println!("peer: none; POINTSTAGE_PEERS_PYTHON names a python with vtk"),
    }
    let million = surfel_count as f64 / 1e6;
    for (mapper, times) in &peer {
        let time = median(times.clone());
        println!(
            "  {:<26} {time:>7.1} ms  {:>6.1} M/s",
            format!("VTK {mapper}"),
            million / time * 1e3
        );
    }
    for (case, frames) in cases.iter().zip(&ours) {
        let time = median_of(frames, |stats| stats.total);
        let ratio = case
            .mapper
            .and_then(|mapper| peer.get(mapper))
            .map(|times| format!("  {:>5.2} times the peer", median(times.clone()) / time))
            .unwrap_or_default();
        println!(
            "  {:<26} {time:>7.1} ms  {:>6.1} M/s{ratio}\n      {}",
            case.name,
            million / time * 1e3,
            parts(frames)
        );
    }
    Ok(())
}

/// The frames of one round that count.
fn draw(stage: &mut Stage, scene: &Arc<Scene>, case: &Case) -> Result<Vec<FrameStats>> {
    let aspect = f64::from(SIZE_PX[0]) / f64::from(SIZE_PX[1]);
    let first = orbit_cameras(&scene.bounds_world(), 1, aspect)
        .pop()
        .context("one camera was asked for")?;
    let mut drawn = Vec::new();
    for frame in 0..WARM_UP + FRAMES {
        let turn = DQuat::from_axis_angle(first.up, TURN_RAD * frame as f64);
        let camera = Camera {
            eye: first.pivot + turn * (first.eye - first.pivot),
            ..first
        };
        let mut request = FrameRequest::still(Arc::clone(scene), camera, SIZE_PX, case.renderer);
        request.read_back = case.read_back.iter().map(|key| (*key).to_owned()).collect();
        for (id, value) in case.settings {
            let value = match value {
                Value::Choice(id) => SettingValue::Choice((*id).to_owned()),
                Value::Float(value) => SettingValue::Float(*value),
            };
            request.settings.insert((*id).to_owned(), value);
        }
        let result = stage
            .frame(&request)
            .with_context(|| format!("drawing by '{}'", case.name))?;
        if frame >= WARM_UP {
            drawn.push(result.stats);
        }
    }
    Ok(drawn)
}

/// Where a frame's time goes: the plugin, the device, each pass, and the rest, which is composition and read-back.
fn parts(frames: &[FrameStats]) -> String {
    let device = median_of(frames, |stats| stats.device_wall);
    let rest = median_of(frames, |stats| {
        let drawing = stats.device_wall + stats.plugin_cpu;
        stats.total.saturating_sub(drawing)
    });
    let passes: Vec<_> = frames[0]
        .passes
        .iter()
        .enumerate()
        .map(|(index, pass)| {
            let time = median_of(frames, |stats| {
                stats.passes.get(index).map_or(Duration::ZERO, |p| p.time)
            });
            format!("{} {time:.1}", pass.label)
        })
        .collect();
    let plugin = median_of(frames, |stats| stats.plugin_cpu);
    format!(
        "plugin {plugin:.2}, device {device:.1} ({}), composition and the rest {rest:.1} ms",
        passes.join(", ")
    )
}

/// What VTK did in one round.
struct PeerFrames {
    name: String,
    /// Milliseconds of each frame, by mapper.
    times: BTreeMap<String, Vec<f64>>,
}

/// A round of VTK's; none without `POINTSTAGE_PEERS_PYTHON`.
fn draw_with_vtk(file: &Path) -> Result<Option<PeerFrames>> {
    let Some(python) = std::env::var_os("POINTSTAGE_PEERS_PYTHON") else {
        return Ok(None);
    };
    let script = data::repository().join("tests/peers/vtk_points.py");
    let mut command = Command::new("xvfb-run");
    command
        .args(["-a", "-s", "-screen 0 1280x1024x24"])
        .arg(python)
        .arg(script)
        .arg(file)
        .args(["--frames", &FRAMES.to_string()])
        .args(["--warm-up", &WARM_UP.to_string()])
        .args(["--size", &format!("{}x{}", SIZE_PX[0], SIZE_PX[1])])
        .env("LIBGL_ALWAYS_SOFTWARE", "1");
    let finished = program::finish(command, program::TIME_LIMIT)?;
    ensure!(finished.status.success(), "VTK failed: {}", finished.stderr);
    let report: serde_json::Value =
        serde_json::from_str(&finished.stdout).context("vtk_points.py prints JSON")?;
    let text = |key: &str| report[key].as_str().unwrap_or("unknown").to_owned();
    let mappers = report["mappers"].as_object().into_iter().flatten();
    let times = mappers.map(|(mapper, result)| {
        let times = result["times_ms"].as_array().into_iter().flatten();
        (
            mapper.clone(),
            times.filter_map(serde_json::Value::as_f64).collect(),
        )
    });
    Ok(Some(PeerFrames {
        times: times.collect(),
        name: format!("{} ({})", text("peer"), text("driver")),
    }))
}

fn median_of(frames: &[FrameStats], time: impl Fn(&FrameStats) -> Duration) -> f64 {
    median(
        frames
            .iter()
            .map(|stats| time(stats).as_secs_f64() * 1e3)
            .collect(),
    )
}

/// NaN of nothing.
fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}
