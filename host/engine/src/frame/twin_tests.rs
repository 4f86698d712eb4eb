//! The passes on the device against their CPU twin, on random targets.

use std::sync::Arc;
use std::time::Duration;

use glam::Mat4;
use pointstage_plugin_api::abi::Format;
use pointstage_scene::{Camera, Projection};

use super::compose::{ComposeError, Composer};
use super::cpu_targets::CpuTargets;
use super::targets::{Appearance, DEPTH, HOST_TARGETS, ID, PlaneFormat};
use super::twin_planes::{random_planes, specs, upload};
use super::{Background, Composition, Fit, TargetSet, TargetSpec, compose_cpu};
use crate::device::{Backend, DeviceOptions, GpuDevice};

const TIMEOUT: Duration = Duration::from_mins(1);

/// The devices of this machine, one an interface; a line for each that is missing.
fn devices() -> Vec<Arc<GpuDevice>> {
    let open = |backend| {
        let options = DeviceOptions {
            backend: Some(backend),
            adapter: None,
        };
        GpuDevice::open(&options)
            .inspect_err(|error| eprintln!("skipped: {error}"))
            .ok()
    };
    [Backend::Vulkan, Backend::Gl]
        .into_iter()
        .filter_map(open)
        .collect()
}

fn composition(shown: &TargetSpec, background: Background, clip_from_view: Mat4) -> Composition {
    Composition {
        shown: shown.clone(),
        background,
        exposure: 1.25,
        clip_from_view,
        tile_origin_y_px: 3.0,
        image_height_px: 50.0,
        ramp_range: None,
    }
}

/// Both projections; the near plane is far enough for depths of 0..1 to spread over the ramp.
fn projections() -> [Mat4; 2] {
    let perspective = Projection::Perspective { fov_y_rad: 0.7 };
    [perspective, Projection::Orthographic { height: 2.0 }].map(|projection| {
        let camera = Camera {
            projection,
            near: 0.5,
            far: 8.0,
            ..Camera::default()
        };
        camera.clip_from_view(1.0).as_mat4()
    })
}

#[test]
fn every_target_looks_the_same_on_the_device_and_on_the_cpu() {
    let backgrounds = [
        Background::Transparent,
        Background::Solid([0.2, 0.4, 0.9]),
        Background::Gradient([0.0, 0.1, 0.2], [1.0, 0.9, 0.8]),
    ];
    for gpu in devices() {
        let mut composer = Composer::new(Arc::clone(&gpu)).unwrap();
        let shown = specs(&gpu);
        for (seed, size_px) in [(1, [1, 1]), (2, [63, 5]), (3, [65, 33])] {
            let planes = random_planes(&gpu, size_px, seed);
            let targets = upload(&gpu, &planes);
            for shown in &shown {
                for (background, clip_from_view) in
                    backgrounds.iter().zip(projections().iter().cycle())
                {
                    let composition = Composition {
                        // One background of the three goes with given ends.
                        ramp_range: matches!(background, Background::Solid(_))
                            .then_some([0.75, 0.125]),
                        ..composition(shown, *background, *clip_from_view)
                    };
                    let cpu = compose_cpu::compose(&planes, &composition).unwrap();
                    let what = format!("{} {size_px:?} {background:?}", shown.key);
                    composer.copy(true);
                    let copied = composer.compose(&targets, &composition, &[], TIMEOUT);
                    let copied = copied.unwrap().composed;
                    if shown.format == Format::RGBA16_FLOAT
                        && shown.appearance == Appearance::Colours
                    {
                        assert!(copied.picture == cpu.picture, "{what}, copied");
                    }
                    composer.copy(false);
                    let device = composer.compose(&targets, &composition, &[], TIMEOUT);
                    let device = device.unwrap().composed;
                    let pairs = core::iter::zip(&*cpu.picture.rgba, &*device.picture.rgba);
                    let worst = pairs.map(|(cpu, device)| cpu.abs_diff(*device)).max();
                    assert_eq!(cpu.picture.rgba.len(), device.picture.rgba.len());
                    assert!(worst <= Some(1), "{what}: off by {worst:?} of 255");
                    match (cpu.range, device.range) {
                        (None, None) => {}
                        (Some(cpu), Some(device)) => {
                            let close = |(cpu, device): (f32, f32)| {
                                (cpu - device).abs() <= 1e-5 * cpu.abs()
                            };
                            assert!(
                                cpu.into_iter().zip(device).all(close),
                                "{what}: {cpu:?} {device:?}"
                            );
                        }
                        ranges => panic!("{what}: {ranges:?}"),
                    }
                }
            }
        }
    }
}

#[test]
fn targets_come_back_as_they_are_in_bands_too() {
    for gpu in devices() {
        let size_px = [37, 29];
        let planes = random_planes(&gpu, size_px, 4);
        let targets = upload(&gpu, &planes);
        let keys: Vec<String> = specs(&gpu)
            .iter()
            .map(|spec| spec.key.to_string())
            .collect();
        let keys: Vec<&str> = keys.iter().map(String::as_str).collect();
        let composition = composition(&HOST_TARGETS[0], Background::Transparent, Mat4::IDENTITY);
        let mut composer = Composer::new(Arc::clone(&gpu)).unwrap();
        let mut whole = |copies| {
            composer.copy(copies);
            let whole = composer
                .compose(&targets, &composition, &keys, TIMEOUT)
                .unwrap();
            for key in keys.iter().copied() {
                let [expected, found] = [planes.read(key).unwrap(), whole.planes[key].clone()];
                // Bits, since NaN is equal to nothing; but bytes where a driver divides by 255 in its own way.
                let [expected, found] = match key {
                    "mask" => [bytes(&expected), bytes(&found)],
                    _ => [bits(&expected), bits(&found)],
                };
                assert!(expected == found, "{key}, copied: {copies}");
            }
            whole
        };
        whole(true);
        let whole = whole(false);
        // Three rows of four floats at once.
        composer.limit_bands(37 * 16 * 3);
        let banded = composer
            .compose(&targets, &composition, &keys, TIMEOUT)
            .unwrap();
        assert!(banded.composed == whole.composed, "the picture differs");
        for key in keys {
            assert!(
                bits(&banded.planes[key]) == bits(&whole.planes[key]),
                "{key}"
            );
        }
    }
}

fn bytes(plane: &super::Plane) -> Vec<u32> {
    match plane {
        super::Plane::Float { values, .. } => values
            .iter()
            .map(|value| (value * 255.0).round() as u32)
            .collect(),
        super::Plane::Uint(values) => values.to_vec(),
    }
}

fn bits(plane: &super::Plane) -> Vec<u32> {
    match plane {
        super::Plane::Float { values, .. } => values
            .iter()
            .map(|value| {
                if value.is_nan() {
                    u32::MAX
                } else {
                    value.to_bits()
                }
            })
            .collect(),
        super::Plane::Uint(values) => values.to_vec(),
    }
}

#[test]
fn cleared_targets_hold_their_clear_values() {
    for gpu in devices() {
        let size_px = [5, 3];
        let mut targets = upload(&gpu, &random_planes(&gpu, size_px, 5));
        assert_eq!(targets.fit(&gpu, size_px, &specs(&gpu)), Ok(Fit::Kept));
        let mut encoder = gpu
            .device
            .create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        targets.clear(&gpu, &mut encoder);
        gpu.queue.submit([encoder.finish()]);
        let expected = CpuTargets::new(size_px, &specs(&gpu));
        let mut composer = Composer::new(Arc::clone(&gpu)).unwrap();
        for spec in &specs(&gpu) {
            let composition = composition(spec, Background::Solid([0.0; 3]), Mat4::IDENTITY);
            let frame = composer
                .compose(&targets, &composition, &[&spec.key], TIMEOUT)
                .unwrap();
            let plane = &frame.planes[&*spec.key];
            match (expected.floats(&spec.key), plane) {
                (Some(expected), super::Plane::Float { values, .. }) => {
                    let close = |(a, b): (&f32, &f32)| (a - b).abs() <= 1.0 / 255.0;
                    assert!(expected.iter().zip(&**values).all(close), "{}", spec.key);
                }
                _ => assert_eq!(
                    Some(plane),
                    expected.read(&spec.key).as_ref(),
                    "{}",
                    spec.key
                ),
            }
            // Nothing is drawn, so that ramps have no ends, whatever the format rounded.
            assert_eq!(frame.composed.range, None, "{}", spec.key);
        }
    }
}

#[test]
fn fitting_keeps_what_fits_and_refuses_what_no_device_can() {
    for gpu in devices() {
        let mut targets = TargetSet::default();
        targets.fit(&gpu, [8, 4], &HOST_TARGETS[..3]).unwrap();
        let texture = |targets: &TargetSet, key| targets.get(key).unwrap().texture.clone();
        let depth = texture(&targets, DEPTH);
        assert_eq!(targets.bytes(), 8 * 4 * (8 + 4 + 8));
        assert_eq!(
            targets.fit(&gpu, [8, 4], &HOST_TARGETS[..4]),
            Ok(Fit::Changed)
        );
        assert_eq!(
            texture(&targets, DEPTH),
            depth,
            "another target came, depth stays"
        );
        assert_eq!(
            targets.fit(&gpu, [9, 4], &HOST_TARGETS[..4]),
            Ok(Fit::Changed)
        );
        assert_ne!(texture(&targets, DEPTH), depth, "another size");
        for size_px in [[0, 4], [4, 0], [1 << 20, 4]] {
            let error = targets.fit(&gpu, size_px, &HOST_TARGETS[..4]).unwrap_err();
            assert!(error.to_string().contains("px a side"), "{error}");
        }
        assert_eq!(targets.size_px(), [9, 4], "an error changes nothing");
    }
}

#[test]
fn a_target_that_is_not_there_is_named_with_those_that_are() {
    let Some(gpu) = devices().pop() else { return };
    let mut targets = TargetSet::default();
    targets.fit(&gpu, [4, 4], &HOST_TARGETS[..2]).unwrap();
    let mut composer = Composer::new(Arc::clone(&gpu)).unwrap();
    let composition = composition(&HOST_TARGETS[0], Background::Transparent, Mat4::IDENTITY);
    let error = composer
        .compose(&targets, &composition, &[ID], TIMEOUT)
        .unwrap_err();
    assert!(matches!(&error, ComposeError::NoTarget { key, .. } if key == ID));
    assert!(error.to_string().contains("colour, depth"), "{error}");
}

#[test]
fn plane_formats_are_those_that_the_passes_read() {
    let Some(gpu) = devices().pop() else { return };
    for spec in specs(&gpu) {
        let format = crate::gpu::texture_format(spec.format).unwrap();
        let sample_type = format.sample_type(None, None);
        let reads_numbers = matches!(sample_type, Some(wgpu::TextureSampleType::Uint));
        assert_eq!(
            spec.plane_format() == PlaneFormat::Uint,
            reads_numbers,
            "{}",
            spec.key
        );
    }
}
