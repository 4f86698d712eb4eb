//! Surfels with clip lines end at sharp edges: a cube and a plate with an inner corner, of large disks that stick out without their
//! lines, against rays cast on the shapes themselves.

use std::fmt::Write as _;
use std::sync::Arc;

use glam::{DAffine3, DQuat, DVec3, Vec3};
use pointstage_engine::stage::{FrameResult, SettingValue, Stage};
use pointstage_scene::{Camera, Projection, Scene};
use pointstage_tests::models::{ball, object};
use pointstage_tests::shots::{
    SIZE_PX, Setting, all_paths, blended, choice, floats, loaded, orthographic, perspective, psnr,
    request, scene_of, stage, uints,
};

/// A surfel of a file with clip columns.
struct Sharp {
    centre: Vec3,
    axes: [Vec3; 2],
    colour: [u8; 3],
    lines: [[f32; 3]; 2],
    is_union: bool,
}

/// A shape of flat faces.
struct Shape {
    name: &'static str,
    surfels: Vec<Sharp>,
    /// So many surfels lie in each face.
    surfels_a_face: u32,
    /// The face that a ray (origin, direction) meets.
    face_met: fn(DVec3, DVec3) -> Option<u32>,
}

/// Linear red, green and blue are 0 or 1, so that packing loses nothing.
const COLOURS: [[u8; 3]; 6] = [
    [255, 0, 0],
    [0, 255, 0],
    [0, 0, 255],
    [255, 255, 0],
    [0, 255, 255],
    [255, 0, 255],
];

/// Pixels no nearer to an edge show what is on their side of it. Half a pixel from a single edge; two that meet at an acute corner
/// cover a little beyond it.
const EDGE_PX: f64 = 1.5;

/// The line that leaves what lies on the side of `edge` (in the plane's coordinate `axis`) towards which `sign` is negative.
fn line_at(axis: usize, sign: f32, edge: f32, centre: f32, half_axis: f32) -> [f32; 3] {
    let mut line = [0.0, 0.0, sign * (edge - centre)];
    line[axis] = -sign * half_axis;
    line
}

/// Lines at those edges of the square -1..1 that an ellipse round `centre` reaches.
fn square_lines(centre: [f32; 2], half_axes: [f32; 2]) -> Vec<[f32; 3]> {
    let mut lines = Vec::new();
    for axis in [0, 1] {
        for sign in [-1.0, 1.0] {
            if 1.0 - sign * centre[axis] < half_axes[axis] {
                lines.push(line_at(axis, sign, sign, centre[axis], half_axes[axis]));
            }
        }
    }
    lines
}

fn both(lines: &[[f32; 3]]) -> [[f32; 3]; 2] {
    assert!(lines.len() <= 2, "a surfel has two lines at most");
    [0, 1].map(|place| lines.get(place).copied().unwrap_or_default())
}

/// The cube -1..1 of sixteen ellipses a face.
fn cube() -> Shape {
    let mut surfels = Vec::new();
    for face in 0..6 {
        let axis = face / 2;
        let normal = Vec3::AXES[axis] * if face % 2 == 0 { 1.0 } else { -1.0 };
        let u = Vec3::AXES[(axis + 1) % 3];
        let v = normal.cross(u);
        let half_axes = [0.5, 0.42];
        for cell in 0..16_u8 {
            let at = [cell % 4, cell / 4].map(|cell| f32::from(cell) * 0.5 - 0.75);
            surfels.push(Sharp {
                centre: normal + u * at[0] + v * at[1],
                axes: [u * half_axes[0], v * half_axes[1]],
                colour: COLOURS[face],
                lines: both(&square_lines(at, half_axes)),
                is_union: false,
            });
        }
    }
    Shape {
        name: "cube",
        surfels,
        surfels_a_face: 16,
        face_met: |origin, direction| {
            let [low, high] = [-1.0, 1.0].map(|side| (DVec3::splat(side) - origin) / direction);
            let (enter, leave) = (low.min(high).max_element(), low.max(high).min_element());
            let axis = low.min(high).max_position();
            let is_lower = direction[axis] > 0.0;
            (enter <= leave).then_some(2 * axis as u32 + u32::from(is_lower))
        },
    }
}

/// The square -1..1 of the plane z = 0 without the quarter where x and y are positive.
fn plate() -> Shape {
    let mut surfels = Vec::new();
    let half_axes = [0.21, 0.19];
    for cell in 0..64_u8 {
        let at = [cell % 8, cell / 8].map(|cell| f32::from(cell) * 0.25 - 0.875);
        let [x, y] = at;
        if x > 0.0 && y > 0.0 {
            continue;
        }
        let inner = |axis: usize| line_at(axis, 1.0, 0.0, at[axis], half_axes[axis]);
        let reaches = |axis: usize| at[axis] < 0.0 && -at[axis] < half_axes[axis];
        let mut lines = square_lines(at, half_axes);
        let is_union = reaches(0) && reaches(1);
        if is_union {
            lines.extend([inner(0), inner(1)]);
        } else if y > 0.0 && reaches(0) {
            lines.push(inner(0));
        } else if x > 0.0 && reaches(1) {
            lines.push(inner(1));
        }
        surfels.push(Sharp {
            centre: Vec3::new(x, y, 0.0),
            axes: [Vec3::X * half_axes[0], Vec3::Y * half_axes[1]],
            colour: COLOURS[0],
            lines: both(&lines),
            is_union,
        });
    }
    Shape {
        name: "plate",
        surfels,
        surfels_a_face: 64,
        face_met: |origin, direction| {
            let hit = origin - direction * (origin.z / direction.z);
            let is_within = hit.x.abs() <= 1.0 && hit.y.abs() <= 1.0;
            (is_within && !(hit.x > 0.0 && hit.y > 0.0)).then_some(0)
        },
    }
}

/// The shape through a PLY file, with or without its clip columns.
fn scene(shape: &Shape, has_lines: bool) -> Arc<Scene> {
    let mut names = "x y z nx ny nz radius ux uy uz vx vy vz".to_owned();
    if has_lines {
        names += " clip_a0 clip_b0 clip_c0 clip_a1 clip_b1 clip_c1";
    }
    let mut text = format!(
        "ply\nformat ascii 1.0\nelement vertex {}\n",
        shape.surfels.len()
    );
    for name in names.split(' ') {
        writeln!(text, "property float {name}").expect("a string takes it");
    }
    text += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
    text += "property uchar clip_union\nend_header\n";
    for surfel in &shape.surfels {
        let [u, v] = surfel.axes;
        let normal = u.cross(v).normalize();
        let radius = u.length().max(v.length());
        let vectors = [surfel.centre, normal].map(|vector| vector.to_array());
        let mut numbers = vectors.concat();
        numbers.push(radius);
        numbers.extend([u, v].map(|vector| vector.to_array()).concat());
        if has_lines {
            numbers.extend(surfel.lines.concat());
        }
        for number in numbers {
            write!(text, "{number} ").expect("a string takes it");
        }
        let [red, green, blue] = surfel.colour;
        let union = u8::from(surfel.is_union);
        writeln!(text, "{red} {green} {blue} {union}").expect("a string takes it");
    }
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join(format!("{}.ply", shape.name));
    std::fs::write(&path, text).expect("it is written");
    scene_of(loaded(&path))
}

/// The face that each pixel shows, none for the background; nothing near edges.
fn truth(shape: &Shape, camera: &Camera) -> Vec<Option<Option<u32>>> {
    let forward = (camera.pivot - camera.eye).normalize();
    let right = forward.cross(camera.up).normalize();
    let up = right.cross(forward);
    let [width, height] = SIZE_PX.map(f64::from);
    let met = |x: f64, y: f64| {
        let across = right * (x - 0.5 * width) / (0.5 * height);
        let offset = across - up * (y - 0.5 * height) / (0.5 * height);
        match camera.projection {
            Projection::Perspective { fov_y_rad } => {
                (shape.face_met)(camera.eye, forward + offset * (0.5 * fov_y_rad).tan())
            }
            Projection::Orthographic { height } => {
                (shape.face_met)(camera.eye + offset * 0.5 * height, forward)
            }
        }
    };
    let pixel = |place: u32| {
        let [x, y] = [place % SIZE_PX[0], place / SIZE_PX[0]].map(|at| f64::from(at) + 0.5);
        let here = met(x, y);
        let mut round =
            (0..16).map(|step| (f64::from(step) * 0.125 * core::f64::consts::PI).sin_cos());
        round
            .all(|(dy, dx)| met(x + EDGE_PX * dx, y + EDGE_PX * dy) == here)
            .then_some(here)
    };
    (0..SIZE_PX[0] * SIZE_PX[1]).map(pixel).collect()
}

/// Pixels away from edges: the place, the face that it should show, and the one that it shows; none is the background.
fn faces<'a>(
    shape: &Shape,
    truth: &'a [Option<Option<u32>>],
    result: &FrameResult,
) -> impl Iterator<Item = (usize, Option<u32>, Option<u32>)> + use<'a> {
    let surfels_a_face = shape.surfels_a_face;
    let shown = uints(result, "id")
        .into_iter()
        .map(move |id| Some(id.checked_sub(1)? / surfels_a_face));
    let pixels = truth.iter().zip(shown).enumerate();
    pixels.filter_map(|(place, (truth, shown))| Some((place, (*truth)?, shown)))
}

/// How many pixels away from edges show another face than they should.
fn elsewhere(shape: &Shape, truth: &[Option<Option<u32>>], result: &FrameResult) -> usize {
    let pixels = faces(shape, truth, result);
    pixels.filter(|(_, face, shown)| face != shown).count()
}

/// How many show another face than they should, or its colour mixed with another's.
fn wrong(shape: &Shape, truth: &[Option<Option<u32>>], result: &FrameResult) -> usize {
    let colours = floats(result, "colour");
    let is_wrong = |(place, face, shown): &(usize, Option<u32>, Option<u32>)| {
        let expected = face.map_or([0; 3], |face| COLOURS[face as usize]);
        let found = &colours[4 * place..4 * place + 3];
        let mut pairs = expected.iter().zip(found);
        let is_right =
            pairs.all(|(expected, found)| (f32::from(*expected) / 255.0 - found).abs() < 0.01);
        face != shown || !is_right
    };
    faces(shape, truth, result).filter(is_wrong).count()
}

/// By all paths of `hqss`, and by the reference; unlit. Large disks of one side blend with backs beside an outline, so those are hidden.
fn unlit(
    stage: &mut Stage,
    scene: &Arc<Scene>,
    camera: Camera,
    more: &[Setting],
) -> [FrameResult; 4] {
    let own: [Setting; 2] = [
        ("shows", choice("colours")),
        ("cull_backs", SettingValue::Bool(true)),
    ];
    blended(
        stage,
        &request(scene, camera, "hqss", &[&own[..], more].concat()),
    )
}

fn assert_paths_agree(what: &str, paths: &[FrameResult]) {
    for (number, first) in paths.iter().enumerate() {
        for second in &paths[number + 1..] {
            let db = psnr(first, second);
            assert!(db >= 50.0, "{db:.1} dB, {what}");
        }
    }
}

fn cameras() -> [Camera; 2] {
    let eye = DVec3::new(2.6, 2.1, 3.5);
    // Off the middle: an edge that lies half way between pixel centres covers them by nothing or by as good as nothing.
    let pivot = DVec3::new(0.03, -0.02, 0.01);
    [perspective(eye), orthographic(eye, 4.2)].map(|camera| Camera { pivot, ..camera })
}

#[test]
fn blended_surfels_with_clip_lines_end_where_the_shape_does() {
    let Some(mut stage) = stage() else { return };
    let variants: [&[Setting]; 3] = [
        &[],
        &[("filter", SettingValue::Bool(false))],
        // Lines stay where they are.
        &[("splat_scale", SettingValue::Float(1.3))],
    ];
    for shape in [cube(), plate()] {
        let [ragged, sharp] = [false, true].map(|has_lines| scene(&shape, has_lines));
        for camera in cameras() {
            let truth = truth(&shape, &camera);
            for settings in variants {
                let what = format!("{}, {:?}, {settings:?}", shape.name, camera.projection);
                let without = unlit(&mut stage, &ragged, camera, settings);
                let with = unlit(&mut stage, &sharp, camera, settings);
                for (without, with) in without.iter().zip(&with) {
                    let [before, after] = [without, with].map(|it| wrong(&shape, &truth, it));
                    assert!(before > 500, "{before} wrong pixels without lines, {what}");
                    assert_eq!(after, 0, "wrong pixels, {what}");
                }
                assert_paths_agree(&what, &with[..3]);
            }
        }
    }
}

#[test]
fn opaque_surfels_with_clip_lines_end_where_the_shape_does() {
    let Some(mut stage) = stage() else { return };
    for shape in [cube(), plate()] {
        let [ragged, sharp] = [false, true].map(|has_lines| scene(&shape, has_lines));
        for camera in cameras() {
            let truth = truth(&shape, &camera);
            let mut draw = |scene: &Arc<Scene>| {
                let request = request(scene, camera, "surfel", &[]);
                all_paths(&mut stage, &request)
            };
            let what = format!("{}, {:?}", shape.name, camera.projection);
            let (without, with) = (draw(&ragged), draw(&sharp));
            for (without, with) in without.iter().zip(&with) {
                let [before, after] = [without, with].map(|it| elsewhere(&shape, &truth, it));
                assert!(before > 500, "{before} wrong pixels without lines, {what}");
                assert_eq!(after, 0, "wrong pixels, {what}");
            }
            assert_paths_agree(&what, &with);
        }
    }
}

#[test]
fn objects_without_lines_stay_whole_beside_one_with() {
    let Some(mut stage) = stage() else { return };
    let [camera, _] = cameras();
    // In front of the cube, on both sides of it in the list of objects.
    let ball = |name: &str, seed: u64, shift: DVec3| {
        let mut object = object(name, &ball(3_000, 0.08, seed));
        object.world_from_object =
            DAffine3::from_scale_rotation_translation(DVec3::splat(0.25), DQuat::IDENTITY, shift);
        object
    };
    let balls = [
        ball("first", 1, DVec3::new(1.6, 1.2, 1.4)),
        ball("last", 2, DVec3::new(1.1, 1.3, 2.0)),
    ];
    let cube = scene(&cube(), true).objects()[0].clone();
    let [first, last] = balls.clone();
    let [alone, beside] = [
        [first.clone(), last.clone()].to_vec(),
        vec![first, cube, last],
    ]
    .map(|objects| {
        let mut scene = Scene::new();
        for object in objects {
            scene.add(object);
        }
        Arc::new(scene)
    });
    for renderer in ["hqss", "surfel"] {
        let mut draw = |scene| {
            let request = request(scene, camera, renderer, &[]);
            all_paths(&mut stage, &request)
        };
        let (alone, beside) = (draw(&alone), draw(&beside));
        assert_paths_agree(renderer, &beside);
        for (alone, beside) in alone.iter().zip(&beside) {
            let [alone, beside] = [alone, beside].map(|result| floats(result, "depth"));
            let pixels = alone.iter().zip(&beside);
            let of_balls: Vec<_> = pixels.filter(|(depth, _)| **depth > 0.0).collect();
            assert!(of_balls.len() > 1_000, "{} pixels", of_balls.len());
            let apart = of_balls
                .iter()
                .filter(|(alone, beside)| alone != beside)
                .count();
            assert_eq!(
                apart, 0,
                "pixels of the balls have another depth, {renderer}"
            );
        }
    }
}
