//! Normals and radii of a mesh from its faces, and what tells which way it is wound.
//!
//! Threads share the vertices out, not the faces: each runs through all triangles and adds up what falls to its own range,
//! always in file order. So no two write to one place, and the sums do not depend on the number of threads.

use glam::Vec3;
use pointstage_plugin_api::columns::MAX_BLOCK_SURFELS;
use rayon::prelude::*;

use super::sums::{Sum, write};
use super::winding::{Totals, orientation};
use super::{Orientation, Polygons};
use crate::geometry::Geometry;
use crate::job::{Cancelled, Job};
use crate::load::FaceRadius;

/// Triangles between two looks at the cancel flag.
const TRIANGLES_A_PIECE: usize = 1 << 18;

/// The most ranges that vertices are shared out to: each costs a pass over the corners.
const MAX_RANGES: usize = 8;

/// Centres by index over all blocks, and what edges are multiplied by so that f32 squares of small ones do not vanish.
struct Centres<'a> {
    blocks: Vec<&'a [[f32; 4]]>,
    middle: Vec3,
    scale: f32,
}

impl Centres<'_> {
    /// As the column has it.
    #[inline]
    fn get(&self, vertex: u32) -> Vec3 {
        // Nearly every mesh is one block.
        let [x, y, z, _] = match self.blocks[..] {
            [only] => only[vertex as usize],
            _ => {
                self.blocks[vertex as usize / MAX_BLOCK_SURFELS]
                    [vertex as usize % MAX_BLOCK_SURFELS]
            }
        };
        Vec3::new(x, y, z)
    }
}

/// Fills in missing normals and radii of vertices that have faces.
pub(super) fn complete(
    geometry: &mut Geometry,
    triangles: &[[u32; 3]],
    polygons: Option<&Polygons>,
    rule: FaceRadius,
    job: &Job,
) -> Result<Orientation, Cancelled> {
    let size = geometry.bounds.size().max_element();
    if size <= 0.0 || !size.is_finite() {
        return Ok(Orientation::Unknown);
    }
    let centres = Centres {
        blocks: geometry
            .blocks
            .iter()
            .map(|block| &*block.position_radius)
            .collect(),
        middle: geometry.bounds.centre().as_vec3(),
        // A power of two: scaling rounds nothing. f32 goes up to 2¹²⁷.
        scale: (-size.log2().floor()).min(126.0).exp2() as f32,
    };
    let mut sums: Vec<Sum> = vec![[0.0; 4]; geometry.surfel_count];
    let range_length = geometry
        .surfel_count
        .div_ceil(rayon::current_num_threads().clamp(1, MAX_RANGES))
        .max(1);
    let ranges = sums.par_chunks_mut(range_length).enumerate();
    let totals: Vec<Totals> = ranges
        .map(|(range, sums)| {
            let start = (range * range_length) as u32;
            let mut totals = Totals::default();
            for piece in triangles.chunks(TRIANGLES_A_PIECE) {
                job.check()?;
                match rule {
                    FaceRadius::EnclosingCircle => {
                        add_triangles(piece, &centres, start, sums, &mut totals, enclosing_squared);
                    }
                    FaceRadius::EdgeTouch => {
                        add_triangles(
                            piece,
                            &centres,
                            start,
                            sums,
                            &mut totals,
                            half_longest_squared,
                        );
                    }
                }
            }
            if let Some(polygons) = polygons {
                replace_normals(polygons, &centres, start, sums);
            }
            Ok(totals)
        })
        .collect::<Result<_, Cancelled>>()?;
    let unscale = 1.0 / centres.scale;
    drop(centres);
    write(geometry, &sums, unscale);
    Ok(orientation(&totals))
}

/// Adds the triangles that touch vertices `start` … of `sums`. `radius_squared` gets the squared edges, largest first, and
/// the squared length of the cross product of two edges.
#[inline]
fn add_triangles(
    triangles: &[[u32; 3]],
    centres: &Centres<'_>,
    start: u32,
    sums: &mut [Sum],
    totals: &mut Totals,
    radius_squared: impl Fn([f32; 3], f32) -> f32,
) {
    let length = sums.len() as u32;
    for &[a, b, c] in triangles {
        let inside = [a, b, c].map(|corner| corner.wrapping_sub(start));
        if inside[0] >= length && inside[1] >= length && inside[2] >= length {
            continue;
        }
        let (pa, pb, pc) = (centres.get(a), centres.get(b), centres.get(c));
        let ab = (pb - pa) * centres.scale;
        let ac = (pc - pa) * centres.scale;
        let bc = (pc - pb) * centres.scale;
        let cross = ab.cross(ac);
        let cross_squared = cross.length_squared();
        let cross_length = cross_squared.sqrt();
        let radius_squared = radius_squared(
            sort3(
                ab.length_squared(),
                ac.length_squared(),
                bc.length_squared(),
            ),
            cross_squared,
        );
        // A triangle without area has no normal; its longest edge still counts for the radius.
        let normal = cross
            * if cross_length > 0.0 {
                cross_length.recip()
            } else {
                0.0
            };
        for corner in inside {
            if let Some(sum) = sums.get_mut(corner as usize) {
                *sum = [
                    sum[0] + normal.x,
                    sum[1] + normal.y,
                    sum[2] + normal.z,
                    sum[3].max(radius_squared),
                ];
            }
        }
        // Each triangle belongs to the range of its first corner.
        if inside[0] < length {
            totals.volume += f64::from(((pa - centres.middle) * centres.scale).dot(cross));
            totals.area += f64::from(cross_length);
            totals.area_vector += cross.as_dvec3();
        }
    }
}

/// Squares of three lengths, the largest first.
#[inline]
fn sort3(a: f32, b: f32, c: f32) -> [f32; 3] {
    let (low, high) = (a.min(b), a.max(b));
    [high.max(c), low.max(high.min(c)), low.min(c)]
}

/// Squared radius of the smallest circle that encloses a triangle: half the longest edge if the angle across it is not
/// acute, the circumcircle `abc / (4 · area)` otherwise.
#[inline]
fn enclosing_squared([a, b, c]: [f32; 3], cross_squared: f32) -> f32 {
    if a >= b + c {
        0.25 * a
    } else {
        a * b * c / (4.0 * cross_squared)
    }
}

/// Squared half of the longest edge.
#[inline]
fn half_longest_squared([a, ..]: [f32; 3], _: f32) -> f32 {
    0.25 * a
}

/// Sums the normals once a polygon instead of once a triangle: a quad cut in two would count twice at two of its corners.
fn replace_normals(polygons: &Polygons, centres: &Centres<'_>, start: u32, sums: &mut [Sum]) {
    for sum in &mut *sums {
        *sum = [0.0, 0.0, 0.0, sum[3]];
    }
    for corners in polygons.iter() {
        let [first, rest @ ..] = corners else {
            continue;
        };
        let origin = centres.get(*first);
        let from_origin = |corner: u32| (centres.get(corner) - origin) * centres.scale;
        let around = rest
            .windows(2)
            .map(|pair| from_origin(pair[0]).cross(from_origin(pair[1])));
        let normal = around.sum::<Vec3>().normalize_or_zero();
        for corner in corners {
            if let Some(sum) = sums.get_mut(corner.wrapping_sub(start) as usize) {
                *sum = [
                    sum[0] + normal.x,
                    sum[1] + normal.y,
                    sum[2] + normal.z,
                    sum[3],
                ];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Block, Origins};
    use pointstage_plugin_api::columns::decode_normal;

    fn mesh(centres: &[[f32; 3]], triangles: &[[u32; 3]]) -> Geometry {
        let position_radius = centres.iter().map(|&[x, y, z]| [x, y, z, 0.0]).collect();
        let block = Block {
            position_radius,
            ..Block::default()
        };
        Geometry::new(vec![block], Some(triangles.into()), Origins::default())
    }

    fn completed(geometry: &Geometry, rule: FaceRadius) -> (Geometry, Orientation) {
        let mut geometry = geometry.clone();
        let triangles = geometry.triangles.clone().unwrap();
        let orientation = complete(&mut geometry, &triangles, None, rule, &Job::new()).unwrap();
        (geometry, orientation)
    }

    const TETRAHEDRON: [[f32; 3]; 4] = [
        [1.0, 1.0, 1.0],
        [1.0, -1.0, -1.0],
        [-1.0, 1.0, -1.0],
        [-1.0, -1.0, 1.0],
    ];
    const OUTWARD: [[u32; 3]; 4] = [[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]];

    #[test]
    fn normals_of_a_tetrahedron_point_along_its_corners() {
        let (geometry, orientation) =
            completed(&mesh(&TETRAHEDRON, &OUTWARD), FaceRadius::default());
        assert_eq!(orientation, Orientation::Outward);
        for (corner, normal) in TETRAHEDRON
            .iter()
            .zip(geometry.blocks[0].normal.as_deref().unwrap())
        {
            let cosine = decode_normal(*normal).dot(Vec3::from(*corner).normalize());
            assert!(cosine > 0.9999, "{corner:?} gave cosine {cosine}");
        }
    }

    #[test]
    fn turned_faces_are_inward_and_open_ones_unknown() {
        let inward = OUTWARD.map(|[a, b, c]| [a, c, b]);
        assert_eq!(
            completed(&mesh(&TETRAHEDRON, &inward), FaceRadius::default()).1,
            Orientation::Inward
        );
        assert_eq!(
            completed(&mesh(&TETRAHEDRON, &inward[..1]), FaceRadius::default()).1,
            Orientation::Unknown
        );
    }

    #[test]
    fn radii_follow_the_chosen_rule() {
        let equilateral = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [1.0, 3.0_f32.sqrt(), 0.0]];
        let obtuse = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [2.0, 0.5, 0.0]];
        for (corners, rule, expected) in [
            (
                equilateral,
                FaceRadius::EnclosingCircle,
                2.0 / 3.0_f32.sqrt(),
            ),
            (equilateral, FaceRadius::EdgeTouch, 1.0),
            (obtuse, FaceRadius::EnclosingCircle, 2.0),
        ] {
            let (geometry, _) = completed(&mesh(&corners, &[[0, 1, 2]]), rule);
            let radius = geometry.blocks[0].position_radius[1][3];
            assert!(
                (radius / expected - 1.0).abs() < 1e-5,
                "{rule:?}: {radius}, expected {expected}"
            );
        }
    }

    #[test]
    fn tiny_and_huge_meshes_have_the_same_shape() {
        for size in [1e-40_f32, 1e-15, 1e-6, 1e6, 1e15] {
            let corners = TETRAHEDRON.map(|corner| corner.map(|value| value * size));
            let (geometry, orientation) =
                completed(&mesh(&corners, &OUTWARD), FaceRadius::default());
            let radius = geometry.blocks[0].position_radius[0][3] / size;
            assert!(
                (radius - 1.632_993).abs() < 1e-4,
                "size {size:e}: radius {radius}"
            );
            assert_eq!(orientation, Orientation::Outward, "size {size:e}");
        }
    }

    #[test]
    fn quads_count_once_at_each_corner() {
        let mut polygons = Polygons::default();
        polygons.push(&[0, 1, 3, 2]);
        polygons.push(&[0, 4, 5, 1]);
        polygons.push(&[0, 2, 6, 4]);
        let corner = |index: u8| {
            [
                f32::from(index & 1),
                f32::from(index >> 1 & 1),
                f32::from(index >> 2 & 1),
            ]
        };
        let corners: Vec<[f32; 3]> = (0..8).map(corner).collect();
        let triangles = [
            [0, 1, 3],
            [0, 3, 2],
            [0, 4, 5],
            [0, 5, 1],
            [0, 2, 6],
            [0, 6, 4],
        ];
        let mut geometry = mesh(&corners, &triangles);
        complete(
            &mut geometry,
            &triangles,
            Some(&polygons),
            FaceRadius::default(),
            &Job::new(),
        )
        .unwrap();
        let normal = geometry.blocks[0].normal_at(0).unwrap();
        assert!(
            (normal.abs() - Vec3::splat(1.0 / 3.0_f32.sqrt())).length() < 1e-4,
            "{normal}"
        );
    }

    #[test]
    fn the_number_of_threads_changes_nothing() {
        let count = 2000_u32;
        let corners: Vec<[f32; 3]> = (0..count)
            .map(|index| {
                [
                    (index as f32).sin(),
                    (index as f32).cos(),
                    index as f32 * 0.001,
                ]
            })
            .collect();
        let triangles: Vec<[u32; 3]> = (0..count - 2)
            .map(|index| [index, index + 1, (index * 7 + 5) % count])
            .filter(|[a, b, c]| a != c && b != c)
            .collect();
        let with_threads = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .unwrap();
            pool.install(|| completed(&mesh(&corners, &triangles), FaceRadius::default()).0)
        };
        let (one, many) = (with_threads(1), with_threads(5));
        assert_eq!(one.blocks[0].normal, many.blocks[0].normal);
        assert_eq!(
            one.blocks[0].position_radius,
            many.blocks[0].position_radius
        );
    }
}
