//! What lies before the near plane is not there: `hqss` pushes splats away from the eye to find the front surface, and what that brings
//! behind the near plane stays hidden all the same.

use glam::{DVec3, Vec3};
use pointstage_engine::stage::{FrameResult, SettingValue};
use pointstage_tests::models::{Surfel, ball, object};
use pointstage_tests::shots::{
    NEAR, blended, floats, orthographic, perspective, psnr, request, scene_of, stage, uints,
};

/// What draws each of the pictures of `blended`; the last one pushes no depth that it holds against the near plane.
const WHO: [&str; 4] = ["raster", "compute", "CPU", "reference"];
const EYE: DVec3 = DVec3::new(0.0, 0.0, 3.5);
/// Surfels of the ball behind the disks.
const BALL: usize = 10_000;

/// A disk round a point of the near plane.
fn disk_across(normal: Vec3, radius: f32) -> Surfel {
    Surfel {
        centre: (EYE - DVec3::Z * NEAR).as_vec3(),
        radius,
        normal: normal.normalize(),
        axes: None,
    }
}

/// What is wrong with a picture, if anything; `truth` is the reference's.
fn fault(result: &FrameResult, truth: &FrameResult) -> Option<String> {
    let [ids, true_ids] = [result, truth].map(|result| uints(result, "id"));
    let weights = floats(result, "weight");
    let pairs = || ids.iter().zip(&weights);
    let holes = pairs()
        .filter(|(id, weight)| **id != 0 && **weight <= 0.0)
        .count();
    if holes != 0 {
        return Some(format!("{holes} pixels show a surfel without weight"));
    }
    // Reversed: 1 is the near plane. Depth goes through the push and back.
    let most = floats(result, "depth").into_iter().fold(0.0, f32::max);
    if !(0.9..=1.0 + 1e-5).contains(&most) {
        return Some(format!("the nearest depth is {most}"));
    }
    let is_disk = |id: u32| id as usize > BALL;
    let pairs = ids.iter().zip(&true_ids);
    let apart = pairs.filter(|(a, b)| is_disk(**a) != is_disk(**b)).count();
    // Rounding decides at the disks' edges.
    let is_like_the_truth = apart * 1_000 <= ids.len();
    (!is_like_the_truth).then(|| format!("{apart} pixels show a disk here or there alone"))
}

#[test]
fn a_splat_across_the_near_plane_ends_there() {
    let Some(mut stage) = stage() else { return };
    // The second one shows its back, which lies twice as far behind its place.
    let normals = [Vec3::new(0.6, 0.3, 1.0), Vec3::new(-0.8, 0.2, -1.0)];
    let mut faults = Vec::new();
    for (camera, radius) in [
        (perspective(EYE), 0.03),
        // With parallel rays depth falls evenly up to the far plane, so the disk is larger.
        (orthographic(EYE, 2.5), 0.6),
    ] {
        let mut surfels = ball(BALL, 0.05, 12);
        surfels.extend(normals.map(|normal| disk_across(normal, radius)));
        let scene = scene_of(object("ball and disks", &surfels));
        for filter in [true, false] {
            let settings = [("filter", SettingValue::Bool(filter))];
            let mut request = request(&scene, camera, "hqss", &settings);
            request.read_back.push("weight".to_owned());
            let what = format!("{:?}, filter {filter}", camera.projection);
            let results = blended(&mut stage, &request);
            let [paths @ .., truth] = &results;
            for (result, who) in paths.iter().zip(WHO) {
                let found = fault(result, truth);
                faults.extend(found.map(|fault| format!("{who}, {what}: {fault}")));
            }
            for (number, first) in paths.iter().enumerate() {
                for second in &paths[number + 1..] {
                    let db = psnr(first, second);
                    faults.extend((db < 50.0).then(|| format!("{db:.1} dB, {what}")));
                }
            }
        }
    }
    assert!(faults.is_empty(), "{faults:#?}");
}
