//! How fast trees are built over synthetic meshes, written and read.
//!
//! ```text
//! cargo bench -p pointstage-pop-tree --bench build                 all of it
//! cargo bench -p pointstage-pop-tree --bench build -- 100000 …     squares of about so many triangles only
//! ```
//!
//! For each mesh the median of [`RUNS`] builds on all threads and on one, milliseconds and nanoseconds a triangle, and the
//! medians of hashing the mesh, writing the file (to the temporary folder) and reading it, with the file in the cache. The
//! calibration line is a fixed run of arithmetic and of memory traffic, so that figures from different days can be told
//! apart from different machines.

use pointstage_plugin_api::columns;
use pointstage_plugin_api::glam::{Vec3, Vec4};
use pointstage_pop_tree::{Mesh, VertexBlock, build, file, fingerprint};
use std::f32::consts::{PI, TAU};
use std::time::Instant;

#[path = "../../../host/scene/benches/shared/calibration.rs"]
mod calibration;

use calibration::calibrate;

/// Acts timed for each median.
const RUNS: usize = 5;

/// Triangles of the squares, in thousands.
const SQUARES: [u32; 12] = [
    100, 200, 300, 400, 500, 600, 700, 800, 900, 1000, 2000, 4000,
];

fn main() {
    // `cargo bench` adds --bench, `cargo test --benches` adds nothing: then one small run shows that it works.
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let sizes: Vec<u32> = arguments
        .iter()
        .filter_map(|argument| argument.parse().ok())
        .collect();
    let bench = arguments.iter().any(|argument| argument == "--bench");
    calibrate(std::thread::available_parallelism().map_or(1, usize::from));
    println!(
        "{:<8} {:>9} {:>9}  {:>17}  {:>17}  {:>8} {:>8} {:>8}",
        "mesh", "triangles", "nodes", "all threads", "one thread", "hash", "write", "read"
    );
    if bench && sizes.is_empty() {
        for thousands in SQUARES {
            measure("square", &square(thousands * 1000));
        }
        measure("sphere", &sphere(1_000_000));
        measure("torus", &torus(4_000_000));
    }
    for triangles in if bench { sizes } else { vec![2000] } {
        measure("square", &square(triangles));
    }
}

/// Columns of a mesh.
struct Surface {
    positions: Vec<[f32; 4]>,
    normals: Vec<u32>,
    colours: Vec<u32>,
    triangles: Vec<[u32; 3]>,
}

/// A patch of `columns` by `rows` squares, two triangles each; `at` gives position and normal at 0..1 in both directions.
fn patch(columns: u32, rows: u32, at: impl Fn(f32, f32) -> (Vec3, Vec3)) -> Surface {
    let (mut positions, mut normals, mut colours) = (Vec::new(), Vec::new(), Vec::new());
    for row in 0..=rows {
        for column in 0..=columns {
            let (u, v) = (column as f32 / columns as f32, row as f32 / rows as f32);
            let (position, normal) = at(u, v);
            positions.push(position.extend(1.0).to_array());
            normals.push(columns::encode_normal(normal));
            colours.push(columns::encode_colour(Vec4::new(u, v, 0.5, 1.0)));
        }
    }
    let corner = |column: u32, row: u32| row * (columns + 1) + column;
    let triangles = (0..rows)
        .flat_map(|row| (0..columns).map(move |column| (column, row)))
        .flat_map(|(column, row)| {
            let [a, b] = [corner(column, row), corner(column + 1, row)];
            let [c, d] = [corner(column, row + 1), corner(column + 1, row + 1)];
            [[a, b, d], [a, d, c]]
        })
        .collect();
    Surface {
        positions,
        normals,
        colours,
        triangles,
    }
}

fn square(triangles: u32) -> Surface {
    let rows = (triangles / 2).isqrt();
    patch(triangles / 2 / rows, rows, |u, v| {
        (Vec3::new(u, v, 0.0), Vec3::Z)
    })
}

fn sphere(triangles: u32) -> Surface {
    patch(1000, triangles / 2000, |u, v| {
        let (longitude, latitude) = (TAU * u, PI * (v - 0.5));
        let normal = Vec3::new(
            latitude.cos() * longitude.cos(),
            latitude.cos() * longitude.sin(),
            latitude.sin(),
        );
        (normal, normal)
    })
}

fn torus(triangles: u32) -> Surface {
    patch(2000, triangles / 4000, |u, v| {
        let outward = Vec3::new((TAU * u).cos(), (TAU * u).sin(), 0.0);
        let normal = outward * (TAU * v).cos() + Vec3::Z * (TAU * v).sin();
        (outward + normal * 0.4, normal)
    })
}

/// Times one mesh and prints its line.
fn measure(name: &str, surface: &Surface) {
    let block = VertexBlock {
        position_radius: &surface.positions,
        normals: Some(&surface.normals),
        colours: Some(&surface.colours),
    };
    let mesh = Mesh {
        block_size: surface.positions.len() as u32,
        blocks: &[block],
        triangles: &surface.triangles,
    };
    let built = |threads: usize| {
        build(&mesh, threads, &mut |_, _| true).unwrap_or_else(|error| panic!("{error}"))
    };
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("bench.pop");
    let tree = built(threads);
    let hash = fingerprint(&mesh, threads);
    let on_all = median(|| drop(built(threads)));
    let on_one = median(|| drop(built(1)));
    let hashing = median(|| assert_eq!(fingerprint(&mesh, threads), hash));
    let writing =
        median(|| file::write(&path, &tree, &hash).unwrap_or_else(|error| panic!("{error}")));
    let reading =
        median(|| drop(file::read(&path, &hash).unwrap_or_else(|error| panic!("{error}"))));
    let triangles = surface.triangles.len();
    let per_triangle = |seconds: f64| {
        format!(
            "{:.1} ms {:>4.0} ns",
            seconds * 1e3,
            seconds * 1e9 / triangles as f64
        )
    };
    println!(
        "{name:<8} {triangles:>9} {:>9}  {:>17}  {:>17}  {:>5.1} ms {:>5.1} ms {:>5.1} ms",
        tree.nodes.len(),
        per_triangle(on_all),
        per_triangle(on_one),
        hashing * 1e3,
        writing * 1e3,
        reading * 1e3,
    );
}

/// Median time of an act, seconds.
fn median(act: impl Fn()) -> f64 {
    let mut seconds: Vec<f64> = (0..RUNS)
        .map(|_| {
            let start = Instant::now();
            act();
            start.elapsed().as_secs_f64()
        })
        .collect();
    seconds.sort_by(f64::total_cmp);
    seconds[RUNS / 2]
}
