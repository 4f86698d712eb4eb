//! How long `pop` builds its tree and draws its frames on a slow orbit, as a plan says.
//!
//! `cargo xtask pop` writes the plans, runs this for each model, and makes tables of what it prints; by hand:
//!
//! ```text
//! cargo xtask bench pop -- PLAN.json FILE.ply
//! ```
//!
//! Each line that it prints is JSON: of the `model`, of each `tree` that was built, and of the `frames` of each case
//! (medians). Trees are built anew by the first frame of a new session. The last session draws all cases. A frame is the
//! engine's: from the request to the composed picture in memory.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use anyhow::{Context as _, Result, bail, ensure};
use glam::{DQuat, DVec3};
use pointstage_engine::stage::{
    FrameRequest, FrameResult, FrameStats, SettingValue, SettingValues, Stage,
};
use pointstage_scene::{Camera, Job, LoadOptions, Projection, Scene, Winding, load, orbit_cameras};
use pointstage_tests::stages;
use serde_json::{Map, Value, json};

const RENDERER: &str = "pop";

/// The vertical field of view of all pictures.
const FOV_Y_RAD: f64 = 40.0 * std::f64::consts::PI / 180.0;

fn main() -> Result<()> {
    // `cargo bench` adds --bench.
    let arguments = std::env::args_os().skip(1);
    let files: Vec<PathBuf> = arguments
        .map(PathBuf::from)
        .filter(|argument| !argument.to_string_lossy().starts_with('-'))
        .collect();
    match files.as_slice() {
        // All benchmarks are run.
        [] => {
            println!("pop: nothing to measure without a plan; `cargo xtask pop` makes them");
            Ok(())
        }
        [plan, file] => measure(&Plan::read(plan)?, file),
        _ => bail!("pop takes PLAN.json FILE.ply"),
    }
}

/// What is measured.
struct Plan {
    /// Faces of the file are wound inward.
    flip: bool,
    size_px: [u32; 2],
    /// Turn of the eye from frame to frame.
    turn_rad: f64,
    /// Sessions in which the tree is built.
    builds: usize,
    /// Frames drawn first in each case.
    warm_up: usize,
    /// Frames of each case that count.
    frames: usize,
    /// Settings of all frames.
    settings: SettingValues,
    cases: Vec<Case>,
}

/// One way to draw, from one place.
struct Case {
    name: String,
    eye: Eye,
    /// Beside the plan's.
    settings: SettingValues,
}

/// Where the eye is.
#[derive(Clone, Copy)]
enum Eye {
    /// So far from the model's centre, in distances at which the sphere around the model fills the picture's height.
    Distance(f64),
    /// Where the model covers this part of the picture's height.
    Height(f64),
}

impl Plan {
    fn read(path: &Path) -> Result<Self> {
        let text = std::fs::read_to_string(path)
            .with_context(|| format!("reading the plan {}", path.display()))?;
        let plan: Value = serde_json::from_str(&text)
            .with_context(|| format!("{} is no JSON", path.display()))?;
        Self::of(&plan).with_context(|| format!("reading the plan {}", path.display()))
    }

    fn of(plan: &Value) -> Result<Self> {
        let whole = |value: &Value, what: &str| {
            let number = value.as_u64();
            number.with_context(|| format!("'{what}' is not a whole number"))
        };
        let count = |key: &str| anyhow::Ok(usize::try_from(whole(&plan[key], key)?)?);
        let side = |index: usize| anyhow::Ok(u32::try_from(whole(&plan["size"][index], "size")?)?);
        let cases = plan["cases"].as_array().context("there are no 'cases'")?;
        let plan = Self {
            flip: plan["flip"].as_bool().unwrap_or(false),
            size_px: [side(0)?, side(1)?],
            turn_rad: number(plan, "turn_deg")?.to_radians(),
            builds: count("builds")?,
            warm_up: count("warm_up")?,
            frames: count("frames")?,
            settings: settings(&plan["settings"])?,
            cases: cases.iter().map(Case::of).collect::<Result<_>>()?,
        };
        ensure!(plan.builds > 0, "'builds' is 0, but one session must draw");
        ensure!(plan.frames > 0, "'frames' is 0, but medians need one");
        Ok(plan)
    }
}

impl Case {
    fn of(case: &Value) -> Result<Self> {
        let name = case["name"].as_str().context("a case has no 'name'")?;
        let eye = if case["height"].is_null() {
            Eye::Distance(number(case, "distance")?)
        } else {
            Eye::Height(number(case, "height")?)
        };
        Ok(Self {
            name: name.to_owned(),
            eye,
            settings: settings(&case["settings"])?,
        })
    }
}

fn number(value: &Value, key: &str) -> Result<f64> {
    let number = value[key].as_f64();
    number.with_context(|| format!("'{key}' is not a number"))
}

/// Values of settings: truth values, numbers, and options by their ids.
fn settings(values: &Value) -> Result<SettingValues> {
    let mut settings = SettingValues::new();
    for (id, value) in values.as_object().into_iter().flatten() {
        let value = match value {
            Value::Bool(value) => SettingValue::Bool(*value),
            Value::String(option) => SettingValue::Choice(option.clone()),
            Value::Number(number) => SettingValue::Float(number.as_f64().unwrap_or(f64::NAN)),
            _ => bail!("'{id}' is neither a truth value nor a number nor an option"),
        };
        settings.insert(id.clone(), value);
    }
    Ok(settings)
}

/// Builds the trees, draws the cases, and prints what it finds.
fn measure(plan: &Plan, file: &Path) -> Result<()> {
    let scene = scene_of(file, plan.flip)?;
    let model = Model::of(&scene)?;
    let mut session = None;
    for _ in 0..plan.builds {
        // The one before goes first: two trees of a large model may not fit.
        drop(session.take());
        let mut stage = stages::stage(&[RENDERER])?;
        if let Some(tree) = build(&mut stage, plan, &scene, &model)? {
            print(&tree);
        }
        session = Some(stage);
    }
    let mut stage = session.context("a plan has at least one build")?;
    let adapter = stage.adapter().context("the stage has no device")?;
    let triangles = scene.objects().iter();
    let triangles = triangles.filter_map(|object| object.geometry.triangles.as_ref());
    print(&json!({
        "kind": "model",
        "device": format!("{} ({}, {})", adapter.name, adapter.backend, adapter.driver),
        "surfels": scene.surfel_count(),
        "triangles": triangles.map(|triangles| triangles.len()).sum::<usize>(),
    }));
    let mut failed = Vec::new();
    for case in &plan.cases {
        let distance = match case.eye {
            Eye::Distance(distance) => distance,
            Eye::Height(part) => model.distance_of_height(part),
        };
        match draw(&mut stage, plan, &scene, &model, case, distance) {
            Ok(frames) => print(&report(case, distance, &frames)),
            // The others may be well.
            Err(error) => failed.push(format!("'{}': {error}", case.name)),
        }
    }
    ensure!(failed.is_empty(), "not drawn: {}", failed.join("; "));
    Ok(())
}

fn scene_of(file: &Path, flip: bool) -> Result<Arc<Scene>> {
    let options = LoadOptions {
        winding: if flip {
            Winding::Flipped
        } else {
            Winding::AsInFile
        },
        ..LoadOptions::default()
    };
    let loaded =
        load(file, &options, &Job::new()).with_context(|| format!("loading {}", file.display()))?;
    let mut scene = Scene::new();
    scene.add(loaded.object);
    Ok(Arc::new(scene))
}

/// Draws the first frame of a session, which builds the tree; what it says of it.
fn build(
    stage: &mut Stage,
    plan: &Plan,
    scene: &Arc<Scene>,
    model: &Model,
) -> Result<Option<Value>> {
    let request = FrameRequest {
        camera: model.camera(1.0, 0.0),
        settings: plan.settings.clone(),
        ..stages::window_frame(scene, plan.size_px, RENDERER)
    };
    let reported = frame(stage, &request)
        .context("building the tree")?
        .stats
        .reported;
    let of_tree = reported.iter().filter(|(key, _)| key.starts_with("tree_"));
    let mut line: Map<String, Value> = of_tree
        .map(|(key, value)| (key.clone(), json!(value)))
        .collect();
    if line.is_empty() {
        return Ok(None);
    }
    line.insert("kind".to_owned(), json!("tree"));
    Ok(Some(Value::Object(line)))
}

/// The frames of a case that count.
fn draw(
    stage: &mut Stage,
    plan: &Plan,
    scene: &Arc<Scene>,
    model: &Model,
    case: &Case,
    distance: f64,
) -> Result<Vec<FrameStats>> {
    let mut settings = plan.settings.clone();
    settings.extend(case.settings.clone());
    let mut drawn = Vec::new();
    for index in 0..plan.warm_up + plan.frames {
        let request = FrameRequest {
            camera: model.camera(distance, plan.turn_rad * index as f64),
            settings: settings.clone(),
            ..stages::window_frame(scene, plan.size_px, RENDERER)
        };
        let stats = frame(stage, &request)?.stats;
        if index >= plan.warm_up {
            drawn.push(stats);
        }
    }
    Ok(drawn)
}

/// A whole frame by the renderer that was asked for.
fn frame(stage: &mut Stage, request: &FrameRequest) -> Result<FrameResult> {
    let result = stage.frame(request)?;
    ensure!(
        result.drawn_by.ends_with(&request.renderer),
        "{} drew instead: {}",
        result.drawn_by,
        result
            .notices
            .iter()
            .map(|notice| notice.text.as_str())
            .collect::<Vec<_>>()
            .join("; ")
    );
    Ok(result)
}

/// Medians over the frames of a case.
fn report(case: &Case, distance: f64, frames: &[FrameStats]) -> Value {
    let millis = |time: fn(&FrameStats) -> Duration| {
        median(frames.iter().map(|stats| time(stats).as_secs_f64() * 1e3))
    };
    let keys = frames.iter().flat_map(|stats| stats.reported.keys());
    let reported: Map<String, Value> = keys
        .map(|key| {
            let values = frames.iter().filter_map(|stats| stats.reported.get(key));
            (key.clone(), json!(median(values.copied())))
        })
        .collect();
    json!({
        "kind": "frames",
        "case": case.name,
        "distance": distance,
        "frame_ms": millis(|stats| stats.total),
        "drawing_ms": millis(|stats| stats.plugin_cpu + stats.device_wall),
        "reported": reported,
    })
}

/// Prints a line.
fn print(line: &Value) {
    println!("{line}");
}

/// NaN, which JSON calls null, of nothing.
fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}

/// Where a model is, and how large.
struct Model {
    /// Of all surfels, in the world.
    positions: Vec<DVec3>,
    /// Looks at the model's centre, from its distance 1.
    first: Camera,
}

impl Model {
    fn of(scene: &Scene) -> Result<Self> {
        let mut positions = Vec::with_capacity(scene.surfel_count());
        for object in scene.objects() {
            let world_from_local = object.world_from_local();
            let blocks = object.geometry.blocks.iter();
            let surfels = blocks.flat_map(|block| block.position_radius.iter());
            positions.extend(surfels.map(|[x, y, z, _]| {
                world_from_local.transform_point3(DVec3::new(
                    f64::from(*x),
                    f64::from(*y),
                    f64::from(*z),
                ))
            }));
        }
        let mut first = orbit_cameras(&scene.bounds_world(), 1, 1.0)
            .pop()
            .context("one camera was asked for")?;
        let radii = positions
            .iter()
            .map(|position| position.distance(first.pivot));
        let radius = radii.fold(0.0, f64::max);
        ensure!(radius > 0.0, "the model is not larger than a point");
        let towards_eye = (first.eye - first.pivot).normalize();
        // The lines of sight at the picture's upper and lower border touch the sphere.
        first.eye = first.pivot + towards_eye * (radius / (FOV_Y_RAD / 2.0).sin());
        first.projection = Projection::Perspective {
            fov_y_rad: FOV_Y_RAD,
        };
        Ok(Self { positions, first })
    }

    /// The camera at a distance, turned around the model.
    fn camera(&self, distance: f64, turn_rad: f64) -> Camera {
        let Camera { eye, pivot, up, .. } = self.first;
        let turn = DQuat::from_axis_angle(up, turn_rad);
        Camera {
            eye: pivot + turn * (eye - pivot) * distance,
            ..self.first
        }
    }

    /// The distance at which the model covers this part of the picture's height.
    fn distance_of_height(&self, part: f64) -> f64 {
        // The nearest, where the eye is just outside the sphere, fills more than any picture.
        let (mut near, mut far) = (0.4, 1.0);
        while self.height(far) > part {
            far *= 2.0;
        }
        // 2⁻²⁰ of the way between them is less than a pixel.
        for _ in 0..20 {
            let middle = f64::midpoint(near, far);
            if self.height(middle) > part {
                near = middle;
            } else {
                far = middle;
            }
        }
        far
    }

    /// The part of the picture's height that the model covers from a distance.
    fn height(&self, distance: f64) -> f64 {
        let camera = self.camera(distance, 0.0);
        let [_, up, back] = camera.axes_world();
        let tangents = self.positions.iter().map(|position| {
            let from_eye = *position - camera.eye;
            from_eye.dot(up) / -from_eye.dot(back)
        });
        let (lowest, highest) = tangents
            .fold((f64::INFINITY, f64::NEG_INFINITY), |range, tangent| {
                (range.0.min(tangent), range.1.max(tangent))
            });
        (highest - lowest) / (2.0 * (FOV_Y_RAD / 2.0).tan())
    }
}
