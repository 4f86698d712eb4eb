//! Small scenes with known shapes, written as binary PLY into a folder of the test.

use std::f32::consts::PI;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result};
use glam::Vec3;

use crate::models;

/// One surfel of a made scene; scene units, sRGB.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surfel {
    /// Centre.
    pub centre: Vec3,
    /// Unit, outward.
    pub normal: Vec3,
    /// Radius of the disk; with axes, the longer half-axis.
    pub radius: f32,
    /// Colour.
    pub colour: [u8; 3],
    /// Tangent half-axes u and v of an elliptical surfel.
    pub axes: Option<[Vec3; 2]>,
}

/// A sphere of `count` disks on a Fibonacci spiral around the origin, coloured by normal.
///
/// The disks' radius is 1.3 times the spacing that evenly spread disks would have, so that they cover the sphere.
pub fn sphere(count: u32, radius: f32) -> Vec<Surfel> {
    let golden_angle = PI * (3.0 - 5.0_f32.sqrt());
    let disk = 1.3 * radius * (4.0 / count as f32).sqrt();
    let surfel = |index: u32| {
        let y = 1.0 - 2.0 * (index as f32 + 0.5) / count as f32;
        let (sin, cos) = (index as f32 * golden_angle).sin_cos();
        let ring = (1.0 - y * y).sqrt();
        let normal = Vec3::new(ring * cos, y, ring * sin);
        let colour = ((normal * 0.5 + 0.5) * 255.0)
            .to_array()
            .map(|channel| channel.round() as u8);
        Surfel {
            centre: normal * radius,
            normal,
            radius: disk,
            colour,
            axes: None,
        }
    };
    (0..count).map(surfel).collect()
}

/// Two square planes of `side`² disks each that cross in the y axis: red faces +z turned by 30°, blue by −30°.
///
/// Each spans −1..1 along y and across. Their line of intersection is a known straight edge.
pub fn crossing_planes(side: u32) -> Vec<Surfel> {
    let plane = |angle: f32, colour: [u8; 3]| {
        let (sin, cos) = angle.sin_cos();
        let (across, normal) = (Vec3::new(cos, 0.0, -sin), Vec3::new(sin, 0.0, cos));
        grid_points(side).map(move |(s, t)| {
            let centre = across * s + Vec3::Y * t;
            Surfel {
                centre,
                normal,
                radius: grid_radius(side),
                colour,
                axes: None,
            }
        })
    };
    plane(PI / 6.0, [200, 60, 40])
        .chain(plane(-PI / 6.0, [40, 80, 200]))
        .collect()
}

/// A flat square in the x-y plane, −1..1, of `side`² disks, in two alternating colours; it faces +z.
///
/// The light disks lie 0.01 in front of the dark ones: where disks of two colours lie in one plane, rounding alone
/// decides which is seen.
pub fn grid(side: u32) -> Vec<Surfel> {
    let surfel = |(index, (x, y)): (usize, (f32, f32))| {
        let odd = (index as u32 / side + index as u32 % side) % 2 == 1;
        let colour = if odd { [230, 230, 230] } else { [60, 120, 60] };
        Surfel {
            centre: Vec3::new(x, y, if odd { 0.01 } else { 0.0 }),
            normal: Vec3::Z,
            radius: grid_radius(side),
            colour,
            axes: None,
        }
    };
    grid_points(side).enumerate().map(surfel).collect()
}

/// One big ellipse at the origin, half-axes 1 and 0.4, that faces +z and is tilted by 40° about its longer axis, which
/// is the direction (1, 1, 0).
pub fn ellipse() -> Vec<Surfel> {
    let along = Vec3::new(1.0, 1.0, 0.0).normalize();
    let (sin, cos) = (40.0_f32).to_radians().sin_cos();
    let across = Vec3::new(-1.0, 1.0, 0.0).normalize() * cos + Vec3::Z * sin;
    let normal = along.cross(across);
    vec![Surfel {
        centre: Vec3::ZERO,
        normal,
        radius: 1.0,
        colour: [220, 160, 40],
        axes: Some([along, across * 0.4]),
    }]
}

/// Writes `surfels` to `<folder>/<name>.ply`, binary little endian, and returns the path.
///
/// The axes' properties `ux uy uz vx vy vz` are written when the first surfel has axes.
///
/// # Errors
/// When the file cannot be written.
pub fn write(folder: &Path, name: &str, surfels: &[Surfel]) -> Result<PathBuf> {
    let path = folder.join(format!("{name}.ply"));
    std::fs::write(&path, encode(surfels))
        .with_context(|| format!("writing {}", path.display()))?;
    Ok(path)
}

/// Writes a mesh as `<name>.ply` in `folder`, with normals and the colours that they stand for.
///
/// # Errors
/// When the file cannot be written.
pub fn write_mesh(
    folder: &Path,
    name: &str,
    vertices: &[models::Surfel],
    triangles: &[[u32; 3]],
) -> Result<PathBuf> {
    let mut bytes = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
         property float nx\nproperty float ny\nproperty float nz\n\
         property uchar red\nproperty uchar green\nproperty uchar blue\n\
         element face {}\nproperty list uchar uint vertex_indices\nend_header\n",
        vertices.len(),
        triangles.len()
    )
    .into_bytes();
    for vertex in vertices {
        bytes.extend(floats(vertex.centre));
        bytes.extend(floats(vertex.normal));
        bytes.extend(
            (vertex.normal.abs() * 255.0)
                .to_array()
                .map(|level| level as u8),
        );
    }
    for triangle in triangles {
        bytes.push(3);
        bytes.extend(triangle.iter().flat_map(|vertex| vertex.to_le_bytes()));
    }
    let path = folder.join(format!("{name}.ply"));
    std::fs::write(&path, bytes).with_context(|| format!("writing {}", path.display()))?;
    Ok(path)
}

fn encode(surfels: &[Surfel]) -> Vec<u8> {
    let with_axes = surfels.first().is_some_and(|surfel| surfel.axes.is_some());
    let mut properties = vec![
        ("float", "x y z nx ny nz radius"),
        ("uchar", "red green blue"),
    ];
    if with_axes {
        properties.push(("float", "ux uy uz vx vy vz"));
    }
    let lines = properties.iter().flat_map(|(kind, names)| {
        names
            .split(' ')
            .map(move |name| format!("property {kind} {name}\n"))
    });
    let count = surfels.len();
    let mut header = format!("ply\nformat binary_little_endian 1.0\nelement vertex {count}\n");
    header.extend(lines);
    header.push_str("end_header\n");

    let mut bytes = header.into_bytes();
    for surfel in surfels {
        bytes.extend(floats(surfel.centre));
        bytes.extend(floats(surfel.normal));
        bytes.extend(surfel.radius.to_le_bytes());
        bytes.extend(surfel.colour);
        if with_axes {
            bytes.extend(surfel.axes.unwrap_or_default().into_iter().flat_map(floats));
        }
    }
    bytes
}

fn floats(vector: Vec3) -> impl Iterator<Item = u8> {
    vector.to_array().into_iter().flat_map(f32::to_le_bytes)
}

/// The middles of `side`² cells of the square −1..1, row by row.
fn grid_points(side: u32) -> impl Iterator<Item = (f32, f32)> {
    let at = move |index: u32| (index as f32 + 0.5) * 2.0 / side as f32 - 1.0;
    (0..side * side).map(move |index| (at(index % side), at(index / side)))
}

/// Half the diagonal of a cell and a little, so that disks cover the square.
fn grid_radius(side: u32) -> f32 {
    1.05 * 2.0_f32.sqrt() / side as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_file_is_as_long_as_its_header_says() {
        for (surfels, size) in [
            (sphere(50, 2.0), 31),
            (crossing_planes(4), 31),
            (grid(3), 31),
            (ellipse(), 55),
        ] {
            let bytes = encode(&surfels);
            let end = b"end_header\n";
            let body = bytes
                .windows(end.len())
                .position(|part| part == end)
                .unwrap()
                + end.len();
            assert_eq!(bytes.len() - body, surfels.len() * size);
        }
    }

    #[test]
    fn axes_are_orthogonal_to_the_normal() {
        let ellipse = ellipse()[0];
        let [u, v] = ellipse.axes.unwrap();
        assert!(
            u.dot(v).abs() < 1e-6
                && u.dot(ellipse.normal).abs() < 1e-6
                && v.dot(ellipse.normal).abs() < 1e-6
        );
        assert!(ellipse.normal.z > 0.0, "it must face +z");
    }

    #[test]
    fn disks_cover_the_sphere() {
        let surfels = sphere(500, 3.0);
        for probe in sphere(4000, 3.0) {
            let nearest = surfels
                .iter()
                .map(|surfel| surfel.centre.distance(probe.centre))
                .fold(f32::MAX, f32::min);
            assert!(
                nearest <= surfels[0].radius,
                "{} lies {nearest} from the nearest disk",
                probe.centre
            );
        }
    }
}
