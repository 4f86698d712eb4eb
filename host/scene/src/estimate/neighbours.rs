//! Normals and radii of points from their nearest neighbours.
//!
//! The normal is that of the plane fitted to the point and its neighbours (see `plane`). Its sign is arbitrary; here it has
//! a fixed one so that runs agree.
//!
//! The radius is the distance to the farthest corner of the point's Voronoi cell among its neighbours (`cell`) and a tenth
//! more, since neighbouring disks lie in different planes (`local`); at most 0.89 d₈, with d₈ the distance of the 8th neighbour. On
//! a square grid of step h it is 0.78 h; disks of 0.71 h already cover the grid.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use pointstage_plugin_api::columns::{MAX_BLOCK_SURFELS, NO_NORMAL, encode_normal};
use rayon::prelude::*;

use super::DEFAULT_NEIGHBOURS;
use super::local::{Local, MARGIN};
use super::tree::{Tree, TreePoint};
use crate::geometry::{Geometry, Provenance};
use crate::job::{Cancelled, Job};
use crate::warnings::{WarningKind, Warnings};

/// Points asked for: the point itself and its neighbours.
const ASKED: usize = DEFAULT_NEIGHBOURS + 1;

/// Lone points would get disks as wide as their distance from everything: no radius exceeds this many times the median.
pub(super) const MOST_MEDIANS: f32 = 10.0;

/// Points between two looks at the cancel flag.
const POINTS_A_PIECE: usize = 1 << 12;

/// Part of the load's progress in which the tree is built.
const TREE_PART: std::ops::Range<f32> = 0.5..0.6;

/// Part of the load's progress in which neighbours are looked for.
const SEARCH_PART: std::ops::Range<f32> = 0.6..1.0;

/// What is known of one surfel: its number over all blocks, packed normal, and radius (0 if all neighbours are in one place).
struct Estimate {
    surfel: u32,
    normal: u32,
    radius: f32,
}

/// Fills in normals and radii that are missing.
pub(super) fn complete(
    geometry: &mut Geometry,
    job: &Job,
    warnings: &mut Warnings,
) -> Result<(), Cancelled> {
    let tree = tree_of(geometry, &TREE_PART, job)?;
    job.set_stage("estimating normals and radii from neighbours");
    let done = AtomicUsize::new(0);
    // In the order of the tree, where the neighbours of one point are mostly those of the one before.
    let mut estimates: Vec<Vec<Estimate>> = tree
        .points()
        .par_chunks(POINTS_A_PIECE)
        .map(|points| {
            job.check()?;
            let wanted = points.iter().filter(|point| lacks(geometry, point.index));
            let estimates = wanted.map(|point| estimate(&tree, point)).collect();
            let done = done.fetch_add(points.len(), Ordering::Relaxed) + points.len();
            job.set_progress_within(&SEARCH_PART, done, geometry.surfel_count);
            Ok(estimates)
        })
        .collect::<Result<_, Cancelled>>()?;
    drop(tree);
    job.check()?;
    bound_radii(&mut estimates, geometry, warnings);
    write(geometry, &estimates, warnings);
    Ok(())
}

/// The tree over all surfels.
pub(super) fn tree_of(
    geometry: &Geometry,
    part: &std::ops::Range<f32>,
    job: &Job,
) -> Result<Tree, Cancelled> {
    job.set_stage("sorting points to find neighbours");
    let centres = geometry
        .blocks
        .iter()
        .flat_map(|block| block.position_radius.iter());
    let points = (0..).zip(centres).map(|(index, &[x, y, z, _])| TreePoint {
        centre: [x, y, z],
        index,
    });
    Tree::build(points.collect(), part, job)
}

/// True if a surfel has no normal or no radius.
fn lacks(geometry: &Geometry, surfel: u32) -> bool {
    let (block, inside) = place_of(surfel);
    let block = &geometry.blocks[block];
    let no_normal = block
        .normal
        .as_ref()
        .is_none_or(|normals| normals[inside] == NO_NORMAL);
    no_normal || block.position_radius[inside][3] <= 0.0
}

/// Block of a surfel, and its place in there.
pub(super) fn place_of(surfel: u32) -> (usize, usize) {
    let surfel = surfel as usize;
    (surfel / MAX_BLOCK_SURFELS, surfel % MAX_BLOCK_SURFELS)
}

fn estimate(tree: &Tree, point: &TreePoint) -> Estimate {
    let near = tree.nearest::<ASKED>(point.centre);
    let local = Local::new(tree, point, &near, DEFAULT_NEIGHBOURS);
    let normal = local.normal();
    let greatest = local.greatest();
    let radius = (MARGIN * local.cell(normal).radius()).min(greatest);
    Estimate {
        surfel: point.index,
        normal: encode_normal(normal.as_vec3()),
        radius: radius as f32,
    }
}

/// Gives radii to points whose neighbours all coincide with them, and bounds those of lone points.
fn bound_radii(estimates: &mut [Vec<Estimate>], geometry: &Geometry, warnings: &mut Warnings) {
    let known = geometry
        .blocks
        .iter()
        .flat_map(|block| block.position_radius.iter())
        .map(|surfel| surfel[3]);
    let mut radii: Vec<f32> = estimates
        .iter()
        .flatten()
        .map(|estimate| estimate.radius)
        .chain(known)
        .filter(|radius| *radius > 0.0)
        .collect();
    let median = if radii.is_empty() {
        warnings.add(WarningKind::AllAtOnePlace, geometry.surfel_count as u64);
        1.0
    } else {
        let middle = radii.len() / 2;
        *radii.select_nth_unstable_by(middle, f32::total_cmp).1
    };
    for estimate in estimates.iter_mut().flatten() {
        estimate.radius = if estimate.radius > 0.0 {
            estimate.radius.min(MOST_MEDIANS * median)
        } else {
            median
        };
    }
}

fn write(geometry: &mut Geometry, estimates: &[Vec<Estimate>], warnings: &mut Warnings) {
    let is_mesh = geometry.triangles.is_some();
    let Geometry {
        blocks, origins, ..
    } = geometry;
    let (mut normal_count, mut radius_count) = (0, 0);
    let mut columns: Vec<(&mut [u32], &mut [[f32; 4]])> = blocks
        .iter_mut()
        .map(|block| {
            let count = block.len();
            let normals = block
                .normal
                .get_or_insert_with(|| std::iter::repeat_n(NO_NORMAL, count).collect());
            let surfels = Arc::make_mut(&mut block.position_radius);
            (Arc::make_mut(normals), surfels)
        })
        .collect();
    for estimate in estimates.iter().flatten() {
        let (block, inside) = place_of(estimate.surfel);
        let (normals, surfels) = &mut columns[block];
        if normals[inside] == NO_NORMAL {
            normals[inside] = estimate.normal;
            normal_count += 1;
        }
        if surfels[inside][3] <= 0.0 {
            surfels[inside][3] = estimate.radius;
            radius_count += 1;
        }
    }
    if is_mesh {
        let count: usize = estimates.iter().map(Vec::len).sum();
        warnings.add(WarningKind::IsolatedVertices, count as u64);
    }
    for (provenance, kind, count) in [
        (
            &mut origins.normals,
            WarningKind::NormalsEstimated,
            normal_count,
        ),
        (
            &mut origins.radii,
            WarningKind::RadiiEstimated,
            radius_count,
        ),
    ] {
        if *provenance == Provenance::Missing {
            *provenance = Provenance::Estimated;
            warnings.add(kind, count);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Block, Origins};

    fn points(centres: impl IntoIterator<Item = [f32; 3]>) -> Geometry {
        let position_radius = centres
            .into_iter()
            .map(|[x, y, z]| [x, y, z, 0.0])
            .collect();
        Geometry::new(
            vec![Block {
                position_radius,
                ..Block::default()
            }],
            None,
            Origins::default(),
        )
    }

    fn completed(mut geometry: Geometry) -> (Geometry, Warnings) {
        let mut warnings = Warnings::new();
        complete(&mut geometry, &Job::new(), &mut warnings).unwrap();
        (geometry, warnings)
    }

    #[test]
    fn disks_of_a_regular_grid_cover_it() {
        let step = 0.01_f32;
        let grid = (0..900_u16).map(|index| {
            [
                f32::from(index % 30) * step,
                f32::from(index / 30) * step,
                0.0,
            ]
        });
        let (geometry, warnings) = completed(points(grid));
        for (surfel, [.., radius]) in geometry.blocks[0].position_radius.iter().enumerate() {
            assert!(*radius > 0.7072 * step, "surfel {surfel}: {radius}");
            assert!(*radius < 3.0 * step, "surfel {surfel}: {radius}");
            let normal = geometry.blocks[0].normal_at(surfel).unwrap();
            assert!(normal.z.abs() > 0.9999, "surfel {surfel}: {normal}");
        }
        assert_eq!(geometry.origins.normals, Provenance::Estimated);
        assert_eq!(warnings.count(&WarningKind::NormalsEstimated), 900);
    }

    #[test]
    fn disks_of_strewn_points_leave_no_holes() {
        // Random, unlike a grid: gaps several times the mean distance. Fixed, so that runs agree (splitmix64).
        let mut state = 7_u64;
        let mut random = || {
            state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
            let mut bits = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
            (bits >> 40) as f32 / (1_u32 << 24) as f32
        };
        let strewn: Vec<[f32; 3]> = (0..4000).map(|_| [random(), random(), 0.0]).collect();
        let (geometry, _) = completed(points(strewn));
        let surfels = &geometry.blocks[0].position_radius;
        let probes = 2000;
        let open = (0..probes).filter(|_| {
            let [x, y] = [random() * 0.9 + 0.05, random() * 0.9 + 0.05];
            !surfels
                .iter()
                .any(|[a, b, _, radius]| (a - x).hypot(b - y) <= *radius)
        });
        let open = open.count();
        assert!(open * 1000 <= probes, "{open} of {probes} places are open");
        let area: f32 = surfels
            .iter()
            .map(|surfel| std::f32::consts::PI * surfel[3].powi(2))
            .sum();
        assert!(area < 7.0, "{area} disks lie over each place");
    }

    #[test]
    fn points_at_one_place_get_some_disk() {
        let (geometry, warnings) = completed(points(std::iter::repeat_n([3.0, 4.0, 5.0], 40)));
        assert!(
            geometry.blocks[0]
                .position_radius
                .iter()
                .all(|surfel| surfel[3] == 1.0)
        );
        assert_eq!(warnings.count(&WarningKind::AllAtOnePlace), 40);
    }

    #[test]
    fn one_point_and_two_points_are_enough() {
        for count in 1..4_u8 {
            let (geometry, _) =
                completed(points((0..count).map(|index| [f32::from(index), 0.0, 0.0])));
            assert!(
                geometry.blocks[0]
                    .position_radius
                    .iter()
                    .all(|surfel| surfel[3] > 0.0),
                "{count} points"
            );
        }
    }

    #[test]
    fn a_lone_point_does_not_cover_the_scene() {
        let grid = (0..400_u16).map(|index| [f32::from(index % 20), f32::from(index / 20), 0.0]);
        let (geometry, _) = completed(points(grid.chain([[1e4, 0.0, 0.0]])));
        let lone = geometry.blocks[0].position_radius[400][3];
        assert!(lone < 20.0, "radius {lone}");
    }

    #[test]
    fn a_cancel_at_any_check_leaves_the_geometry_as_it_was() {
        let spiral = (0..40_000_u32).map(|index| {
            let turn = index as f32 * 0.01;
            [turn.sin(), turn.cos(), index as f32 * 1e-4]
        });
        let geometry = points(spiral);
        let (mut in_tree, mut in_search) = (0, 0);
        for check in 0.. {
            let job = Job::cancelled_at_check(check);
            let mut cancelled = geometry.clone();
            let result = complete(&mut cancelled, &job, &mut Warnings::new());
            if result.is_ok() {
                break;
            }
            assert_eq!(cancelled.origins.normals, Provenance::Missing);
            assert!(cancelled.blocks[0].normal.is_none(), "check {check}");
            if job.stage().starts_with("sorting") {
                in_tree += 1;
                assert!(job.progress() <= TREE_PART.end, "check {check}");
            } else {
                in_search += 1;
            }
        }
        // 40,000 points are cut twice, which makes four runs; three cuts and four runs each look at the flag.
        assert!(in_tree >= 7, "{in_tree} looks at the flag while sorting");
        assert!(in_search >= 10, "{in_search} while searching");
    }
}
