//! Normals that are estimated and oriented, against those that real scans have.
//!
//! The folder lies beside the checkout, or where `POINTSTAGE_TEST_DATA` says; without it these tests skip and say so.

use glam::Vec3;
use pointstage_scene::estimate::{Steps, estimate};
use pointstage_scene::{Block, Estimation, Geometry, Job, Loaded};

use crate::data::{data_folder, load_file};

fn loaded(name: &str, estimation: Estimation) -> Option<Loaded> {
    let folder = data_folder()?;
    if !folder.join(name).is_file() {
        println!("skipped: {name} is not in the shared test data folder");
        return None;
    }
    Some(load_file(&folder, name, estimation).unwrap_or_else(|error| panic!("{error}")))
}

/// The points alone.
fn bare(geometry: &Geometry) -> Geometry {
    let blocks = geometry.blocks.iter().map(|block| Block {
        position_radius: block.position_radius.clone(),
        ..Block::default()
    });
    Geometry::new(blocks.collect(), None, pointstage_scene::Origins::default())
}

/// The part of the normals that lie on the side of those expected, estimated anew.
fn agreement(geometry: &Geometry) -> f64 {
    let steps = Steps {
        normals: true,
        orientation: true,
        ..Steps::default()
    };
    let (found, _) = estimate(&bare(geometry), &steps, &Job::new()).expect("not cancelled");
    let (mut agreeing, mut all) = (0_usize, 0_usize);
    for (found, expected) in found.blocks.iter().zip(&geometry.blocks) {
        for surfel in 0..found.len() {
            let normal = |block: &Block| block.normal_at(surfel).unwrap_or(Vec3::ZERO);
            agreeing += usize::from(normal(found).dot(normal(expected)) > 0.0);
            all += 1;
        }
    }
    agreeing as f64 / all as f64
}

#[test]
fn closed_scans_get_normals_on_the_outside() {
    // Measured: the vertices alone, against the means of the faces' normals, or the file's own (nefertiti). What is left
    // over are thin walls and folds: the bunny's and lucy's base, the screwdriver's tip.
    for (name, measured) in [
        ("mesh/bunny_zipper_ascii.ply", 0.9827),
        ("mesh/lucy_50k_le.ply", 0.9811),
        ("mesh/igea_tristrips_le.ply", 1.0),
        ("mesh/nefertiti_normals_be.ply", 0.9978),
        ("mesh/screwdriver_be.ply", 0.9931),
    ] {
        let Some(loaded) = loaded(name, Estimation::Never) else {
            continue;
        };
        let share = agreement(&loaded.object.geometry);
        println!("{name}: {share:.4}");
        assert!(share > measured - 0.005, "{name}: {share}");
    }
    // Its file is wound inward, so that all but 0.0010 are against it.
    if let Some(loaded) = loaded("mesh/horse_rgb_be.ply", Estimation::Never) {
        let share = agreement(&loaded.object.geometry);
        assert!(share < 0.005, "horse: {share}");
    }
}

#[test]
fn open_scans_get_normals_on_one_side() {
    // Measured, against the files' own normals. Nothing says which side of an open scan is outside: those of the pond all
    // look the other way.
    for (name, measured) in [
        ("points/pond_70k_normals_rgb_le.ply", 0.9666),
        ("points/lion_normals_rgb_le.ply", 0.9433),
    ] {
        let Some(loaded) = loaded(name, Estimation::Never) else {
            continue;
        };
        let share = agreement(&loaded.object.geometry);
        println!("{name}: {share:.4}");
        assert!(share.max(1.0 - share) > measured - 0.01, "{name}: {share}");
    }
}
