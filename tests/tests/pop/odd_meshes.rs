//! Meshes that nobody would model, and triangles around the eye.

use std::sync::Arc;

use glam::{DVec3, Vec3};
use pointstage_scene::{Camera, Scene};
use pointstage_tests::models::{Random, Surfel, meshed};
use pointstage_tests::shots::{
    NEAR, PATHS, SIZE_PX, both_paths, choice, floats, perspective, request, scene_of, stage, uints,
};

use super::drawn;

/// A mesh of these triangles over vertices at these places.
fn mesh_of(places: &[Vec3], triangles: &[[u32; 3]]) -> Arc<Scene> {
    let vertices: Vec<Surfel> = places
        .iter()
        .map(|&centre| Surfel {
            centre,
            radius: 0.1,
            normal: Vec3::Z,
            axes: None,
        })
        .collect();
    scene_of(meshed("made", &vertices, triangles))
}

#[test]
fn odd_meshes_are_drawn() {
    let Some(mut stage) = stage() else { return };
    let square = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::new(1.0, 1.0, 0.0)];
    let one: &[[u32; 3]] = &[[0, 1, 2]];
    let meshes: [(&str, &[[u32; 3]], bool); 5] = [
        ("one triangle", one, true),
        (
            "a point, a line and a triangle",
            &[[0, 0, 0], [0, 1, 1], [0, 1, 2]],
            true,
        ),
        (
            "three at an edge, one twice",
            &[[0, 1, 2], [0, 1, 2], [1, 0, 3], [0, 1, 3]],
            true,
        ),
        ("without area", &[[1, 1, 1], [0, 1, 0]], false),
        ("both sides", &[[0, 1, 2], [2, 1, 0]], true),
    ];
    for (what, triangles, is_seen) in meshes {
        let scene = mesh_of(&square, triangles);
        for method in ["classic", "points", "pop"] {
            for (path, _) in PATHS {
                let settings = [("method", choice(method)), ("path", choice(path))];
                let result = drawn(
                    &mut stage,
                    &scene,
                    perspective(DVec3::new(0.3, 0.3, 2.0)),
                    &settings,
                );
                let covered = uints(&result, "kind")
                    .iter()
                    .filter(|kind| **kind != 0)
                    .count();
                if is_seen && method != "points" {
                    assert!(
                        covered > 1_000,
                        "{what}, {method}, {path}: {covered} pixels"
                    );
                }
            }
        }
    }
}

#[test]
fn triangles_through_the_eyes_plane_are_cut_and_not_lost() {
    let Some(mut stage) = stage() else { return };
    // A floor from far before the eye to far behind it, as two triangles, and splinters round the eye.
    let mut random = Random(5);
    let floor = [(-50.0, 50.0), (50.0, 50.0), (-50.0, -50.0), (50.0, -50.0)]
        .map(|(x, z)| Vec3::new(x, -1.0, z));
    let mut places = floor.to_vec();
    let mut triangles = vec![[0, 1, 2], [2, 1, 3]];
    for splinter in 0..30 {
        let middle = random.vector();
        places.extend((0..3).map(|_| (middle + 0.4 * random.vector()).as_vec3()));
        triangles.push([4, 5, 6].map(|corner: u32| corner + 3 * splinter));
    }
    let scene = mesh_of(&places, &triangles);
    let camera = Camera {
        pivot: DVec3::new(0.0, -0.3, -1.0),
        ..perspective(DVec3::ZERO)
    };
    for method in ["classic", "pop"] {
        let settings = [("method", choice(method)), ("cull_backs", choice("off"))];
        let [raster, compute] = both_paths(&mut stage, &request(&scene, camera, "pop", &settings));
        let (kind, other) = (uints(&raster, "kind"), uints(&compute, "kind"));
        let below = &kind[kind.len() * 3 / 4..];
        assert!(
            below.iter().all(|kind| *kind == 2),
            "the floor fills the lower quarter"
        );
        let apart = kind.iter().zip(&other).filter(|(a, b)| a != b).count();
        assert!(
            apart * 1_000 <= kind.len(),
            "{apart} pixels differ, {method}"
        );
        let depths = floats(&compute, "depth");
        let floor_depth = f64::from(depths[depths.len() - SIZE_PX[0] as usize / 2]);
        assert!(
            floor_depth > 0.0 && NEAR / floor_depth < 5.0,
            "{floor_depth}"
        );
    }
}
