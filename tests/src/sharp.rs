//! Shapes of flat faces with sharp edges, of surfels that stick out of them without their clip lines; and as PLY files.

use std::fmt::Write as _;
use std::sync::Arc;

use glam::{DVec3, Vec3};
use pointstage_scene::Scene;

use crate::shots::{loaded, scene_of};

/// A surfel of a file with clip columns.
#[derive(Clone, Copy, Debug)]
pub struct Sharp {
    /// Centre.
    pub centre: Vec3,
    /// Tangent half-axes.
    pub axes: [Vec3; 2],
    /// sRGB.
    pub colour: [u8; 3],
    /// Clip lines: a, b, c of each.
    pub lines: [[f32; 3]; 2],
    /// Whether what either line leaves stays.
    pub is_union: bool,
}

/// A shape of flat faces.
#[derive(Clone, Debug)]
pub struct Shape {
    /// Its name.
    pub name: &'static str,
    /// Its surfels, face by face.
    pub surfels: Vec<Sharp>,
    /// So many surfels lie in each face.
    pub surfels_a_face: u32,
    /// The face that a ray (origin, direction) meets.
    pub face_met: fn(DVec3, DVec3) -> Option<u32>,
}

/// Of the faces. Linear red, green and blue are 0 or 1, so that packing loses nothing.
pub const COLOURS: [[u8; 3]; 6] = [
    [255, 0, 0],
    [0, 255, 0],
    [0, 0, 255],
    [255, 255, 0],
    [0, 255, 255],
    [255, 0, 255],
];

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

/// The cube -1..1 of `side`² ellipses a face.
pub fn cube(side: u8) -> Shape {
    let spacing = 2.0 / f32::from(side);
    let mut surfels = Vec::new();
    for (face, colour) in COLOURS.into_iter().enumerate() {
        let axis = face / 2;
        let normal = Vec3::AXES[axis] * if face % 2 == 0 { 1.0 } else { -1.0 };
        let u = Vec3::AXES[(axis + 1) % 3];
        let v = normal.cross(u);
        let half_axes = [spacing, 0.84 * spacing];
        for cell in 0..u16::from(side).pow(2) {
            let cell = [cell % u16::from(side), cell / u16::from(side)];
            let at = cell.map(|cell| (f32::from(cell) + 0.5) * spacing - 1.0);
            surfels.push(Sharp {
                centre: normal + u * at[0] + v * at[1],
                axes: [u * half_axes[0], v * half_axes[1]],
                colour,
                lines: both(&square_lines(at, half_axes)),
                is_union: false,
            });
        }
    }
    Shape {
        name: "cube",
        surfels,
        surfels_a_face: u32::from(side).pow(2),
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
pub fn plate() -> Shape {
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
///
/// # Panics
/// When the file cannot be written or does not load.
pub fn scene(shape: &Shape, has_lines: bool) -> Arc<Scene> {
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
