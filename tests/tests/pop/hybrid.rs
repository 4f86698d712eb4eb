//! What the hybrid shows: no holes, splats of what is small, and nearly the mesh's picture.

use std::collections::BTreeSet;

use glam::DVec3;
use image::RgbImage;
use pointstage_engine::metrics::{Regions, measure};
use pointstage_engine::stage::{FrameResult, Stage};
use pointstage_scene::Camera;
use pointstage_tests::data;
use pointstage_tests::shots::{
    SIZE_PX, Setting, choice, draw, loaded, perspective, psnr, request, scene_of, stage, uints,
};

use super::{EYE, ball, drawn, on, reported, threshold, two_balls};

#[test]
fn the_hybrid_covers_all_that_the_mesh_covers() {
    let Some(mut stage) = stage() else { return };
    for scene in [ball(), two_balls()] {
        for distance in [1.4, 3.0, 7.0, 40.0] {
            let camera = perspective(EYE.normalize() * distance);
            let whole = drawn(&mut stage, &scene, camera, &[("method", choice("classic"))]);
            assert!(uints(&whole, "kind").contains(&2));
            for width in [0.5, 1.0, 1.7, 3.0, 5.0] {
                for (shape, path) in [("square", "compute"), ("disk", "compute"), ("disk", "cpu")] {
                    let settings = [
                        threshold(width),
                        ("splat", choice(shape)),
                        ("path", choice(path)),
                    ];
                    let hybrid = drawn(&mut stage, &scene, camera, &settings);
                    let holes = holes(&whole, &hybrid);
                    assert_eq!(
                        holes, 0,
                        "from {distance}, {shape} splats of {width} px, {path}"
                    );
                }
            }
        }
    }
}

#[test]
fn what_is_small_is_a_splat_and_what_is_large_a_triangle() {
    let Some(mut stage) = stage() else { return };
    let kinds = |stage: &mut Stage, distance: f64| {
        let camera = perspective(EYE.normalize() * distance);
        let result = drawn(stage, &ball(), camera, &[threshold(2.0)]);
        let counts = [
            reported(&result, "splats_drawn"),
            reported(&result, "triangles_drawn"),
        ];
        let kinds: BTreeSet<u32> = uints(&result, "kind")
            .into_iter()
            .filter(|kind| *kind != 0)
            .collect();
        (counts, kinds)
    };
    let (near, kinds_near) = kinds(&mut stage, 1.3);
    assert!(
        near[1] > 100.0 && kinds_near.contains(&2),
        "{near:?} {kinds_near:?}"
    );
    let (far, kinds_far) = kinds(&mut stage, 30.0);
    assert!(
        far[0] > 20.0 && far[0] < 5_000.0 && far[1] == 0.0,
        "{far:?}"
    );
    assert_eq!(kinds_far, BTreeSet::from([1]));
}

#[test]
fn the_level_falls_with_the_distance() {
    let Some(mut stage) = stage() else { return };
    let scene = ball();
    let mut greatest = u32::MAX;
    for distance in [1.5, 4.0, 12.0, 50.0] {
        let camera = perspective(EYE.normalize() * distance);
        let mut request = request(&scene, camera, "pop", &[threshold(2.0)]);
        request.read_back.push("lod".to_owned());
        let result = draw(&mut stage, &request);
        let levels = uints(&result, "lod")
            .into_iter()
            .zip(uints(&result, "kind"));
        let seen: BTreeSet<u32> = levels
            .filter(|(_, kind)| *kind != 0)
            .map(|(level, _)| level)
            .collect();
        let deepest = *seen.last().expect("the ball is seen");
        let leaves = reported(&result, "tree_levels") as u32 - 1;
        assert!(
            deepest <= leaves && (distance > 2.0 || deepest == leaves),
            "{seen:?} of {leaves}"
        );
        assert!(deepest <= greatest, "{seen:?} from {distance}");
        greatest = deepest;
    }
    assert!(greatest < 8, "{greatest}");
}

#[test]
fn at_one_pixel_the_hybrid_looks_like_the_mesh() {
    let Some(mut stage) = stage() else { return };
    for distance in [2.0, 3.0, 5.0] {
        let camera = perspective(EYE.normalize() * distance);
        let scene = ball();
        let classic = drawn(&mut stage, &scene, camera, &[("method", choice("classic"))]);
        let hybrid = drawn(&mut stage, &scene, camera, &[threshold(1.0)]);
        let db = psnr(&classic, &hybrid);
        assert!(db >= 33.0, "{db:.1} dB from {distance}");
    }
}

/// Inside the silhouette: outlines are the spheres', whatever the shape.
#[test]
fn blended_splats_look_more_like_the_mesh_than_disks_and_show_the_same_primitives() {
    let Some(mut stage) = stage() else { return };
    let scene = ball();
    let camera = perspective(EYE);
    let classic = drawn(&mut stage, &scene, camera, &[("method", choice("classic"))]);
    for (width, more_db) in [(3.0, 2.0), (6.0, 1.5)] {
        let mut with = |shape| {
            let settings = [threshold(width), ("splat", choice(shape))];
            drawn(&mut stage, &scene, camera, &settings)
        };
        let (disks, blended) = (with("disk"), with("blended"));
        for target in ["kind", "id"] {
            assert_eq!(uints(&disks, target), uints(&blended, target), "{target}");
        }
        let [disks, again] =
            [&disks, &blended].map(|hybrid| interior_db(&classic, hybrid, SIZE_PX));
        assert!(
            again >= disks + more_db,
            "{again:.1} dB, disks {disks:.1} dB, {width} px"
        );
        assert_eq!(
            with("blended").picture.rgba,
            blended.picture.rgba,
            "not the same again"
        );
    }
}

#[test]
fn scans_at_one_pixel_look_like_their_meshes() {
    let Some(mut stage) = stage() else { return };
    let size_px = [800, 580];
    for file in [
        "mesh/bunny_zipper_ascii.ply",
        "mesh/dragon_vrip_437k_le.ply",
    ] {
        let Some(path) = data::shared(file) else {
            continue;
        };
        let scene = scene_of(loaded(&path));
        let mut camera = Camera::default();
        camera.frame(&scene.bounds_world(), 800.0 / 580.0);
        let mut drawn = |setting: Setting| {
            let mut request = request(&scene, camera, "pop", &[on("cache", false), setting]);
            request.size_px = size_px;
            draw(&mut stage, &request)
        };
        let classic = drawn(("method", choice("classic")));
        let hybrid = drawn(threshold(1.0));
        assert_eq!(holes(&classic, &hybrid), 0, "{file}");
        let db = interior_db(&classic, &hybrid, size_px);
        assert!(db >= 35.0, "{file}: {db:.1} dB");
    }
}

#[test]
fn a_picked_vertex_is_near_what_is_seen_there() {
    let Some(mut stage) = stage() else { return };
    let scene = ball();
    for (distance, settings) in [
        (1.5, vec![]),
        (3.0, vec![threshold(4.0)]),
        (3.0, vec![("method", choice("points"))]),
    ] {
        let result = drawn(
            &mut stage,
            &scene,
            perspective(EYE.normalize() * distance),
            &settings,
        );
        let pick = result
            .pick(SIZE_PX.map(|size| i64::from(size / 2)), 2)
            .expect("the ball is in the middle");
        let Some(found) = result.ids.resolve(pick.id) else {
            panic!("no surfel of id {}", pick.id)
        };
        let vertex = found.surfel;
        let geometry = &scene.objects()[0].geometry;
        let [x, y, z, _] = geometry.blocks[0].position_radius[vertex as usize];
        let apart = pick
            .position_world
            .distance(DVec3::new(x.into(), y.into(), z.into()));
        assert!(apart < 0.1, "{apart} from the vertex, {settings:?}");
    }
}

/// Pixels that the whole mesh covers and the hybrid does not.
fn holes(whole: &FrameResult, hybrid: &FrameResult) -> usize {
    let (whole, hybrid) = (uints(whole, "kind"), uints(hybrid, "kind"));
    let holes = whole
        .iter()
        .zip(&hybrid)
        .filter(|(whole, hybrid)| **whole != 0 && **hybrid == 0);
    holes.count()
}

/// PSNR over the interior of what the whole mesh covers; dB.
fn interior_db(whole: &FrameResult, hybrid: &FrameResult, size_px: [u32; 2]) -> f64 {
    let covered: Vec<bool> = uints(whole, "kind").iter().map(|kind| *kind != 0).collect();
    let regions = Regions::new(size_px, &covered).expect("a mask of the picture's size");
    let [whole, hybrid] = [whole, hybrid].map(|result| {
        let rgb = result
            .picture
            .rgba
            .chunks_exact(4)
            .flat_map(|pixel| [pixel[0], pixel[1], pixel[2]]);
        RgbImage::from_raw(size_px[0], size_px[1], rgb.collect()).expect("a picture of its size")
    });
    let measured = measure(&whole, &hybrid, &regions).expect("pictures of one size");
    measured.interior.psnr_db.expect("an interior")
}
