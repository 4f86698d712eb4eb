//! What `pop` draws: the mesh itself where it is large, splats without holes where it is small, the same by every path.

use std::collections::BTreeSet;
use std::sync::Arc;

use glam::{DAffine3, DQuat, DVec3, Vec3};
use image::RgbImage;
use pointstage_engine::metrics::{Regions, measure};
use pointstage_engine::stage::{FrameResult, SettingValue, Stage, ViewportId};
use pointstage_scene::{Camera, Scene};
use pointstage_tests::data;
use pointstage_tests::models::{Random, Surfel, dented_mesh, meshed};
use pointstage_tests::shots::{
    NEAR, PATHS, SIZE_PX, Setting, both_paths, choice, draw, floats, in_tiles, loaded,
    orthographic, perspective, psnr, request, scene_of, stage, uints,
};

/// Where the eye stands in most of these pictures.
const EYE: DVec3 = DVec3::new(0.5, 0.7, 3.0);

fn threshold(px: f64) -> Setting {
    ("threshold", SettingValue::Float(px))
}

const fn on(id: &'static str, value: bool) -> Setting {
    (id, SettingValue::Bool(value))
}

/// A dented ball of 2 · 80 · 160 triangles, some 2 px wide from [`EYE`].
fn ball() -> Arc<Scene> {
    let (vertices, triangles) = dented_mesh(80, 160);
    scene_of(meshed("ball", &vertices, &triangles))
}

/// A fine ball, and in front of it a coarse one, squeezed and mirrored.
fn two_balls() -> Arc<Scene> {
    let mut scene = Scene::new();
    let (vertices, triangles) = dented_mesh(160, 320);
    scene.add(meshed("fine", &vertices, &triangles));
    let (vertices, triangles) = dented_mesh(12, 20);
    let mut coarse = meshed("coarse", &vertices, &triangles);
    coarse.world_from_object = DAffine3::from_scale_rotation_translation(
        DVec3::new(-0.3, 0.2, 0.35),
        DQuat::from_rotation_y(0.7),
        DVec3::new(0.4, 0.3, 2.0),
    );
    scene.add(coarse);
    Arc::new(scene)
}

fn drawn(
    stage: &mut Stage,
    scene: &Arc<Scene>,
    camera: Camera,
    settings: &[Setting],
) -> FrameResult {
    draw(stage, &request(scene, camera, "pop", settings))
}

fn reported(result: &FrameResult, key: &str) -> f64 {
    let found = result.stats.reported.get(key).copied();
    found.unwrap_or_else(|| panic!("{key} is reported"))
}

#[test]
fn both_paths_agree() {
    let Some(mut stage) = stage() else { return };
    let variants: [&[Setting]; 9] = [
        &[threshold(1.0)],
        &[threshold(3.0), ("splat", choice("disk"))],
        &[
            threshold(5.0),
            ("shading", choice("gouraud")),
            ("cull_backs", choice("off")),
        ],
        &[("method", choice("classic"))],
        &[("method", choice("points")), ("splat", choice("disk"))],
        &[threshold(2.0), on("pop_colours", true)],
        &[threshold(3.0), ("splat", choice("blended"))],
        &[("method", choice("points")), ("splat", choice("blended"))],
        &[
            threshold(4.0),
            ("splat", choice("blended")),
            ("shading", choice("gouraud")),
            on("pop_colours", true),
        ],
    ];
    let scene = two_balls();
    for settings in variants {
        for camera in [perspective(EYE), orthographic(EYE, 2.5)] {
            let [raster, compute] =
                both_paths(&mut stage, &request(&scene, camera, "pop", settings));
            let covered = uints(&raster, "kind")
                .iter()
                .filter(|kind| **kind != 0)
                .count();
            assert!(covered > 10_000, "{covered} pixels, {settings:?}");
            let db = psnr(&raster, &compute);
            assert!(db >= 45.0, "{db:.1} dB, {settings:?}");
        }
    }
}

#[test]
fn the_cpu_draws_the_splats_that_the_device_draws() {
    let Some(mut stage) = stage() else { return };
    let scene = two_balls();
    for camera in [
        perspective(EYE),
        perspective(2.5 * EYE),
        orthographic(EYE, 2.5),
    ] {
        let shapes = [
            (2.5, "disk"),
            (4.0, "square"),
            (6.0, "disk"),
            (3.0, "blended"),
            (6.0, "blended"),
        ];
        for (width, shape) in shapes {
            let mut by = |path| {
                let settings = [
                    threshold(width),
                    ("splat", choice(shape)),
                    ("path", choice(path)),
                ];
                drawn(&mut stage, &scene, camera, &settings)
            };
            let (device, cpu) = (by("compute"), by("cpu"));
            let kinds = [&device, &cpu].map(|result| uints(result, "kind"));
            assert!(kinds[0].contains(&1), "splats are drawn");
            let apart = kinds[0]
                .iter()
                .zip(&kinds[1])
                .filter(|(a, b)| a != b)
                .count();
            assert!(
                apart * 2_000 <= kinds[0].len(),
                "{apart} pixels differ, {width} px"
            );
            let db = psnr(&device, &cpu);
            assert!(db >= 45.0, "{db:.1} dB, {width} px, {shape}");
        }
    }
}

#[test]
fn tiles_make_up_the_picture() {
    let Some(mut stage) = stage() else { return };
    let scene = two_balls();
    for camera in [perspective(EYE), orthographic(EYE, 2.5)] {
        let paths = ["raster", "compute", "cpu"];
        for (path, shape) in paths
            .into_iter()
            .flat_map(|path| [(path, "disk"), (path, "blended")])
        {
            let settings = [
                threshold(3.0),
                ("path", choice(path)),
                ("splat", choice(shape)),
            ];
            let request = request(&scene, camera, "pop", &settings);
            let whole = draw(&mut stage, &request);
            let tiles = in_tiles(&mut stage, &request, [117, 239]);
            let pairs = whole
                .picture
                .rgba
                .chunks_exact(4)
                .zip(tiles.chunks_exact(4));
            let differs =
                |(a, b): &(&[u8], &[u8])| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > 1);
            let (count, apart) = (pairs.len(), pairs.filter(differs).count());
            // Rounding at edges, since a tile's projection has other numbers.
            assert!(
                apart * 5_000 <= count,
                "{path}, {shape}: {apart} of {count} pixels differ"
            );
        }
    }
}

#[test]
fn the_whole_mesh_is_what_the_reference_draws() {
    let Some(mut stage) = stage() else { return };
    let reference = [
        ("surface", choice("triangles")),
        ("samples", SettingValue::Int(1)),
    ];
    for scene in [ball(), two_balls()] {
        for camera in [perspective(EYE), orthographic(EYE, 2.5)] {
            let classic = drawn(&mut stage, &scene, camera, &[("method", choice("classic"))]);
            let truth = draw(
                &mut stage,
                &request(&scene, camera, "ewa-reference", &reference),
            );
            let (kind, true_kind) = (uints(&classic, "kind"), uints(&truth, "kind"));
            let apart = kind.iter().zip(&true_kind).filter(|(a, b)| a != b).count();
            assert!(
                apart * 2_000 <= kind.len(),
                "{apart} pixels of the silhouette differ"
            );
            let (depth, true_depth) = (floats(&classic, "depth"), floats(&truth, "depth"));
            let far = |(a, b): &(&f32, &f32)| (**a - **b).abs() > 1e-3 * b.abs();
            let far = depth.iter().zip(&true_depth).filter(far).count();
            assert!(far * 500 <= depth.len(), "{far} depths differ");
            let db = psnr(&classic, &truth);
            assert!(db >= 30.0, "{db:.1} dB");
        }
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
fn coherence_changes_no_picture_and_asks_less() {
    let Some(mut stage) = stage() else { return };
    let scene = two_balls();
    let (mut all, mut asked) = (0.0, 0.0);
    for step in 0..12 {
        let turn = DQuat::from_rotation_y(0.01 * f64::from(step));
        let camera = perspective(turn * EYE);
        let full = drawn(&mut stage, &scene, camera, &[("coherence", choice("off"))]);
        let mut request = request(&scene, camera, "pop", &[("coherence", choice("on"))]);
        // A view of its own, so that the last cut is of the camera before.
        request.viewport = ViewportId(7);
        let coherent = draw(&mut stage, &request);
        assert!(full.picture.rgba == coherent.picture.rgba, "step {step}");
        for key in ["splats_drawn", "triangles_drawn", "nodes_culled"] {
            assert_eq!(
                reported(&full, key),
                reported(&coherent, key),
                "{key}, step {step}"
            );
        }
        if step > 0 {
            all += reported(&full, "nodes_visited");
            asked += reported(&coherent, "nodes_visited");
        }
    }
    assert!(asked <= 0.5 * all, "{asked} of {all} nodes asked");
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
fn the_device_chooses_what_the_cpu_chooses() {
    let Some(mut stage) = stage() else { return };
    let scene = two_balls();
    let cameras =
        [1.4, 2.2, 3.0, 7.0, 40.0].map(|distance| perspective(EYE.normalize() * distance));
    for camera in cameras
        .into_iter()
        .chain([orthographic(EYE, 2.5), orthographic(EYE, 0.4)])
    {
        for (width, culling) in [(0.7, "on"), (1.5, "off"), (3.0, "auto")] {
            for (path, _) in PATHS {
                let settings = [
                    threshold(width),
                    ("cull_backs", choice(culling)),
                    ("path", choice(path)),
                    ("coherence", choice("off")),
                ];
                let on_cpu = [&settings[..], &[("selection", choice("cpu"))]].concat();
                let on_device = [&settings[..], &[("selection", choice("gpu"))]].concat();
                let cpu = drawn(&mut stage, &scene, camera, &on_cpu);
                let what = format!("{width} px, {culling}, {path}, {:?}", camera.eye);
                // Counts come a frame later.
                let device = drawn(&mut stage, &scene, camera, &on_device);
                assert!(
                    uints(&cpu, "kind").iter().any(|kind| *kind != 0),
                    "empty, {what}"
                );
                assert!(
                    uints(&cpu, "kind") == uints(&device, "kind"),
                    "kinds differ, {what}"
                );
                // Of splats at one depth the raster path keeps the last of a list, and the device's has no order.
                let pixels = |result: &FrameResult| {
                    result
                        .picture
                        .rgba
                        .chunks_exact(4)
                        .map(<[u8]>::to_vec)
                        .collect::<Vec<_>>()
                };
                let apart = pixels(&cpu)
                    .iter()
                    .zip(pixels(&device))
                    .filter(|(a, b)| **a != *b)
                    .count();
                let most = if path == "raster" {
                    SIZE_PX[0] as usize * SIZE_PX[1] as usize / 400
                } else {
                    0
                };
                assert!(apart <= most, "{apart} pixels differ, {what}");
                let again = drawn(&mut stage, &scene, camera, &on_device);
                for key in [
                    "splats_drawn",
                    "triangles_drawn",
                    "nodes_visited",
                    "nodes_culled",
                ] {
                    assert_eq!(reported(&cpu, key), reported(&again, key), "{key}, {what}");
                }
            }
        }
    }
}
