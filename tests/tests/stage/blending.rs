//! What blended splats owe, by `hqss` and by `ewa-reference`: means that stay means however many splats meet, one picture in any order, weights by their closed
//! form, surfaces without holes, and numbers that are numbers whatever comes in.

use std::collections::VecDeque;
use std::f64::consts::PI;
use std::sync::Arc;

use glam::{DVec3, Vec3};
use pointstage_engine::stage::{FrameRequest, FrameResult, Plane, SettingValue, Stage};
use pointstage_plugin_api::columns::TangentAxes;
use pointstage_scene::{Camera, Headlight, Material, Scene};
use pointstage_tests::models::{Random, Surfel, ball, coloured, object};
use pointstage_tests::shots::{
    NEAR, SIZE_PX, Setting, blended, both_paths, choice, draw, floats, orthographic, perspective,
    psnr, request, scene_of, stage,
};

fn hqss(scene: &Arc<Scene>, camera: Camera, settings: &[Setting]) -> FrameRequest {
    request(scene, camera, "hqss", settings)
}

/// Surfels all over the square -0.5..0.5 of the plane z = 0, facing +z.
fn square(count: usize, radius: f32) -> Vec<Surfel> {
    let mut random = Random(11);
    let surfel = |_| Surfel {
        centre: Vec3::new(random.signed() as f32, random.signed() as f32, 0.0) * 0.5,
        radius,
        normal: Vec3::Z,
        axes: None,
    };
    (0..count).map(surfel).collect()
}

/// Sum of red and of coverage over the picture.
fn red_and_coverage(result: &FrameResult) -> [f64; 2] {
    let colours = floats(result, "colour");
    let sum = |channel: usize| {
        let values = colours
            .chunks_exact(4)
            .map(|pixel| f64::from(pixel[channel]));
        values.sum::<f64>()
    };
    [sum(0), sum(3)]
}

#[test]
fn a_mean_of_random_colours_stays_their_mean_up_to_fifty_thousand_splats_a_pixel() {
    let Some(mut stage) = stage() else { return };
    let surfels = square(100_000, 0.004);
    let mut random = Random(5);
    let mut white = 0;
    let object = coloured("noise", &surfels, |_| {
        let is_white = random.signed() > 0.2;
        white += usize::from(is_white);
        Vec3::splat(f32::from(u8::from(is_white)))
    });
    let mean = white as f64 / surfels.len() as f64;
    let scene = scene_of(object);
    let settings = [("shows", choice("colours"))];
    // The square's height, px: at the end two pixels share 100,000 splats.
    for height_px in [200.0, 40.0, 8.0, 1.4] {
        let height = f64::from(SIZE_PX[1]) / height_px;
        let camera = orthographic(DVec3::new(0.001, 0.002, 3.0), height);
        for result in blended(&mut stage, &hqss(&scene, camera, &settings)) {
            let [red, coverage] = red_and_coverage(&result);
            assert!(coverage > 0.0, "nothing at {height_px} px");
            let found = red / coverage;
            assert!(
                (found / mean - 1.0).abs() < 0.01,
                "{found} of {mean} at {height_px} px"
            );
        }
    }
}

#[test]
fn the_order_of_the_surfels_changes_nothing() {
    let Some(mut stage) = stage() else { return };
    let surfels = ball(20_000, 0.04, 7);
    let mut shuffled = surfels.clone();
    let mut random = Random(9);
    for last in (1..shuffled.len()).rev() {
        let other = ((random.signed() * 0.5 + 0.5) * last as f64) as usize;
        shuffled.swap(last, other);
    }
    let camera = perspective(DVec3::new(0.5, 0.7, 3.0));
    let [first, second] =
        [surfels, shuffled].map(|surfels| hqss(&scene_of(object("ball", &surfels)), camera, &[]));
    let (first, second) = (blended(&mut stage, &first), blended(&mut stage, &second));
    for (first, second) in first.iter().zip(&second) {
        let pairs = first.picture.rgba.iter().zip(second.picture.rgba.iter());
        let most = pairs.map(|(a, b)| a.abs_diff(*b)).max();
        assert!(most <= Some(1), "{most:?} of 255");
    }
}

/// Sum of the `weight` target.
fn weight_of(stage: &mut Stage, surfels: &[Surfel], settings: &[Setting]) -> [f64; 4] {
    let scene = scene_of(object("splats", surfels));
    let camera = orthographic(DVec3::new(0.0, 0.0, 3.0), 2.0);
    let mut request = hqss(&scene, camera, settings);
    request.read_back.push("weight".to_owned());
    blended(stage, &request).map(|result| {
        floats(&result, "weight")
            .iter()
            .copied()
            .map(f64::from)
            .sum()
    })
}

#[test]
fn weights_are_those_of_the_gaussian() {
    let Some(mut stage) = stage() else { return };
    let radius = 0.4;
    let disk = Surfel {
        centre: Vec3::ZERO,
        radius,
        normal: Vec3::Z,
        axes: None,
    };
    // Behind the first by less than the blending depth.
    let behind = Surfel {
        centre: Vec3::new(0.0, 0.0, -0.5 * radius),
        ..disk
    };
    let radius_px = f64::from(radius) * f64::from(SIZE_PX[1]) / 2.0;
    // The integral of exp(-2 (r/R)²) over the disk of radius R.
    let one = PI * radius_px.powi(2) * (1.0 - (-2.0_f64).exp()) / 2.0;
    let unfiltered = [("filter", SettingValue::Bool(false))];
    let shallow = [
        ("filter", SettingValue::Bool(false)),
        ("epsilon", SettingValue::Float(0.25)),
    ];
    for (surfels, settings, expected) in [
        (&[disk][..], &unfiltered[..], one),
        (&[disk, behind], &unfiltered, 2.0 * one),
        (&[disk, behind], &shallow, one),
    ] {
        for found in weight_of(&mut stage, surfels, settings) {
            assert!(
                (found / expected - 1.0).abs() < 0.01,
                "{found} instead of {expected}, {} splats, {settings:?}",
                surfels.len()
            );
        }
    }
}

#[test]
fn a_plane_of_splats_has_the_weight_of_all_of_them() {
    let Some(mut stage) = stage() else { return };
    let (count, radius) = (2_000, 0.02_f32);
    let radius_px = f64::from(radius) * f64::from(SIZE_PX[1]) / 2.0;
    let one = PI * radius_px.powi(2) * (1.0 - (-2.0_f64).exp()) / 2.0;
    let expected = one * f64::from(count);
    let surfels = square(count as usize, radius);
    let unfiltered = [("filter", SettingValue::Bool(false))];
    for found in weight_of(&mut stage, &surfels, &unfiltered) {
        assert!(
            (found / expected - 1.0).abs() < 0.01,
            "{found} instead of {expected}"
        );
    }
}

/// Pixels that are not covered whole though no path of such pixels leads to the picture's edge.
fn holes(result: &FrameResult) -> usize {
    let [width, height] = result.picture.size_px.map(|side| side as usize);
    let colours = floats(result, "colour");
    let is_open = |place: usize| colours[4 * place + 3] < 0.999;
    let mut is_reached = vec![false; width * height];
    let edge = (0..width * height).filter(|place| {
        let (x, y) = (place % width, place / width);
        x == 0 || y == 0 || x + 1 == width || y + 1 == height
    });
    let mut next: VecDeque<usize> = edge.filter(|place| is_open(*place)).collect();
    for place in &next {
        is_reached[*place] = true;
    }
    while let Some(place) = next.pop_front() {
        let (x, y) = (place % width, place / width);
        let beside = [
            (x > 0).then(|| place - 1),
            (x + 1 < width).then_some(place + 1),
            (y > 0).then(|| place.wrapping_sub(width)),
            (y + 1 < height).then_some(place + width),
        ];
        for other in beside.into_iter().flatten() {
            if is_open(other) && !is_reached[other] {
                is_reached[other] = true;
                next.push_back(other);
            }
        }
    }
    (0..width * height)
        .filter(|place| is_open(*place) && !is_reached[*place])
        .count()
}

#[test]
fn a_closed_surface_has_no_holes_at_any_distance_and_size() {
    let Some(mut stage) = stage() else { return };
    // Evenly spread, so that the disks close the surface: spacing 0.02, radius 1.3 of it.
    let count = 30_000;
    let surfel = |index: usize| {
        let z = 1.0 - (2.0 * index as f64 + 1.0) / f64::from(count);
        let turn = index as f64 * PI * (3.0 - 5.0_f64.sqrt());
        let ring = (1.0 - z * z).sqrt();
        let normal = DVec3::new(ring * turn.cos(), ring * turn.sin(), z).as_vec3();
        Surfel {
            centre: normal,
            radius: 1.3 * (4.0 * PI / f64::from(count)).sqrt() as f32,
            normal,
            axes: None,
        }
    };
    let surfels: Vec<_> = (0..count as usize).map(surfel).collect();
    let scene = scene_of(object("sphere", &surfels));
    for (number, distance) in [1.5, 2.0, 3.0, 5.0, 9.0, 17.0, 40.0, 90.0]
        .into_iter()
        .enumerate()
    {
        let turn = number as f64 * 0.8;
        let eye = DVec3::new(turn.cos(), 0.3 * turn.sin(), turn.sin()).normalize() * distance;
        let mut request = hqss(&scene, perspective(eye), &[]);
        for size_px in [SIZE_PX, [157, 121]] {
            request.size_px = size_px;
            for result in blended(&mut stage, &request) {
                assert_eq!(holes(&result), 0, "from {distance} at {size_px:?}");
            }
        }
    }
}

/// Surfels that no scan should have.
fn bad_surfels(eye: DVec3) -> Vec<Surfel> {
    let good = ball(2_000, 0.1, 3);
    let change = |index: usize, surfel: &Surfel| match index % 8 {
        0 => Surfel {
            radius: 0.0,
            ..*surfel
        },
        1 => Surfel {
            radius: 1e6,
            ..*surfel
        },
        2 => Surfel {
            normal: Vec3::ZERO,
            ..*surfel
        },
        3 => Surfel {
            centre: eye.as_vec3(),
            ..*surfel
        },
        4 => Surfel {
            centre: (eye * 1.1).as_vec3(),
            radius: 1.0,
            ..*surfel
        },
        5 => Surfel {
            centre: surfel.centre * 1e7,
            ..*surfel
        },
        6 => Surfel {
            normal: eye.cross(DVec3::Y).normalize().as_vec3(),
            ..*surfel
        },
        _ => *surfel,
    };
    (0..)
        .zip(&good)
        .map(|(index, surfel)| change(index, surfel))
        .collect()
}

fn assert_numbers(what: &str, result: &FrameResult) {
    for (key, plane) in &result.planes {
        if let Plane::Float { values, .. } = plane {
            let bad = values.iter().filter(|value| !value.is_finite()).count();
            assert_eq!(bad, 0, "{what}: {bad} values of '{key}' are no numbers");
        }
    }
}

#[test]
fn no_target_ever_holds_what_is_no_number() {
    let Some(mut stage) = stage() else { return };
    let eye = DVec3::new(0.4, 0.5, 2.0);
    let surfels = bad_surfels(eye);
    let flat: Vec<_> = surfels
        .iter()
        .map(|surfel| Surfel {
            axes: Some(TangentAxes::new(Vec3::X * surfel.radius, Vec3::ZERO)),
            ..*surfel
        })
        .collect();
    for (name, surfels) in [("bad", &surfels), ("flat", &flat)] {
        let scene = scene_of(object(name, surfels));
        for camera in [perspective(eye), orthographic(eye, 3.0)] {
            for size_px in [SIZE_PX, [1, 1]] {
                for filter in [true, false] {
                    let settings = [("filter", SettingValue::Bool(filter))];
                    let mut request = hqss(&scene, camera, &settings);
                    request.size_px = size_px;
                    request.read_back.push("weight".to_owned());
                    for result in blended(&mut stage, &request) {
                        assert_numbers(&format!("{name}, {size_px:?}, filter {filter}"), &result);
                    }
                }
            }
        }
    }
}

#[test]
fn depth_is_that_of_the_surface_and_not_pushed() {
    let Some(mut stage) = stage() else { return };
    let surfels = square(5_000, 0.03);
    let scene = scene_of(object("square", &surfels));
    let distance = 2.5;
    let request = hqss(&scene, perspective(DVec3::new(0.0, 0.0, distance)), &[]);
    for result in blended(&mut stage, &request) {
        let depths = floats(&result, "depth");
        let middle = depths[depths.len() / 2 + SIZE_PX[0] as usize / 2];
        let found = NEAR / f64::from(middle);
        assert!(
            (found - distance).abs() < 1e-3,
            "{found} instead of {distance}"
        );
    }
}

#[test]
fn lights_and_normals_blend_between_splats() {
    let Some(mut stage) = stage() else { return };
    let scene = scene_of(object("ball", &ball(1_500, 0.15, 6)));
    let camera = perspective(DVec3::new(0.0, 0.5, 3.0));
    let smooth = draw(&mut stage, &hqss(&scene, camera, &[]));
    let flat = [("shading", choice("flat"))];
    let flat = draw(&mut stage, &hqss(&scene, camera, &flat));
    // Steps between neighbours: blended normals have far smaller ones.
    let steps = |result: &FrameResult| {
        let normals = floats(result, "normal");
        let pixels: Vec<_> = normals
            .chunks_exact(4)
            .map(|n| Vec3::new(n[0], n[1], n[2]))
            .collect();
        let inside = pixels
            .windows(2)
            .filter(|pair| pair.iter().all(|n| *n != Vec3::ZERO));
        inside
            .map(|pair| f64::from(pair[0].distance_squared(pair[1])))
            .sum::<f64>()
    };
    assert!(
        steps(&smooth) < 0.5 * steps(&flat),
        "{} {}",
        steps(&smooth),
        steps(&flat)
    );
    assert!(
        psnr(&smooth, &flat) < 45.0,
        "the shading model changes the picture"
    );
}

/// A roof of slopes finer than pixels, under a light from above: its mean light is that of the slopes, which their mean normal does
/// not tell.
#[test]
fn splats_lit_one_by_one_have_the_mean_light_of_their_normals() {
    let Some(mut stage) = stage() else { return };
    let (kd, slope) = (0.8, 60_f32.to_radians());
    let mut surfels = square(100_000, 0.004);
    for (number, surfel) in surfels.iter_mut().enumerate() {
        let side = if number % 2 == 0 { slope } else { -slope };
        surfel.normal = Vec3::new(side.sin(), 0.0, side.cos());
    }
    let mut object = coloured("roof", &surfels, |_| Vec3::ONE);
    object.material = Material {
        ka: 0.0,
        kd,
        ks: 0.0,
        ..Material::default()
    };
    let scene = scene_of(object);
    // Some sixty splats a pixel: their mean normal faces the eye.
    let camera = orthographic(DVec3::new(0.0, 0.0, 3.0), 6.0);
    // A pixel's mean normal leans by chance, a few degrees; light of each splat does not.
    let cases = [("phong", kd, 0.03), ("splats", kd * slope.cos(), 0.005)];
    for (shading, expected, most) in cases {
        let mut request = hqss(&scene, camera, &[("shading", choice(shading))]);
        request.lights.headlight = Headlight {
            enabled: true,
            strength: 1.0,
        };
        for result in blended(&mut stage, &request) {
            let [red, coverage] = red_and_coverage(&result);
            let found = red / coverage;
            let error = (found / f64::from(expected) - 1.0).abs();
            assert!(error < most, "{shading}: {found} instead of {expected}");
        }
    }
}

#[test]
fn forty_bytes_a_pixel_are_all_that_hqss_holds_beyond_scene_and_targets() {
    let Some(mut stage) = stage() else { return };
    let scene = scene_of(object("ball", &ball(5_000, 0.1, 4)));
    let mut request = hqss(&scene, perspective(DVec3::new(0.5, 0.7, 3.0)), &[]);
    request.size_px = [800, 580];
    let bytes = both_paths(&mut stage, &request).map(|result| result.stats.plugin_bytes);
    // Uniforms, the quads' indices and the lists of large surfels do not grow with the picture. Both paths' buffers stay.
    let fixed = 3 << 20;
    let most = 2 * 40 * 800 * 580 + fixed;
    assert!(bytes[0] > 0 && bytes[1] <= most, "{bytes:?}, {most}");
    let alone = 40 * 800 * 580 + fixed;
    assert!(bytes[0] <= alone, "{} of {alone}", bytes[0]);
}
