//! The same picture by every path, of every tile, by whoever chooses the nodes, and of a mesh alone the reference's.

use glam::DQuat;
use pointstage_engine::stage::{FrameResult, SettingValue, ViewportId};
use pointstage_tests::shots::{
    PATHS, SIZE_PX, Setting, both_paths, choice, draw, floats, in_tiles, orthographic, perspective,
    psnr, request, stage, uints,
};

use super::{EYE, ball, drawn, on, reported, threshold, two_balls};

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
            let difference = |(a, b): (&[u8], &[u8])| {
                let channels = a.iter().zip(b).map(|(a, b)| a.abs_diff(*b));
                channels.max().unwrap_or_default()
            };
            let count = pairs.len();
            let differences = pairs.map(difference).filter(|difference| *difference > 1);
            let differences: Vec<u8> = differences.collect();
            // A tile's projection has other numbers: at edges of splats rounding decides for one neighbour or the other, whose
            // colours are close on this scene. A hole or a seam would be far from them.
            assert!(
                differences.len() * 4_000 <= count
                    && differences.iter().all(|difference| *difference <= 16),
                "{path}, {shape}: of {count} pixels these differ, by so much: {differences:?}"
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
