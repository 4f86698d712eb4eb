//! The built-in renderer and the composition, on the CPU and on the device.
//!
//! Times depend on the machine; compare runs on one machine only.

use std::hint::black_box;
use std::sync::Arc;
use std::time::Duration;

use abi_stable::std_types::RSlice;
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use glam::{DVec3, Mat4, Vec3};
use pointstage_engine::device::{DeviceOptions, GpuDevice};
use pointstage_engine::frame::compose::Composer;
use pointstage_engine::frame::fallback::Fallback;
use pointstage_engine::frame::targets::HOST_TARGETS;
use pointstage_engine::frame::{Background, Composition, CpuTargets, TargetSet, compose_cpu};
use pointstage_plugin_api::abi::{
    BlockRecord, ColumnRecord, DrawFlags, DrawRecord, DrawUniform, FrameUniform, Handle,
    LightUniform, ScalarType,
};
use pointstage_plugin_api::columns::{self, encode_normal};
use pointstage_scene::Camera;

const SIZE_PX: [u32; 2] = [800, 600];

/// A bumpy sphere with shuffled surfels of 1.25 times their distance.
struct Sphere {
    centres: Vec<[f32; 4]>,
    normals: Vec<u32>,
    colours: Vec<u32>,
}

impl Sphere {
    fn new(count: u32) -> Self {
        let radius = 1.25 * (4.0 * std::f32::consts::PI / count as f32).sqrt();
        let mut sphere = Self {
            centres: Vec::new(),
            normals: Vec::new(),
            colours: Vec::new(),
        };
        for place in 0..count {
            // A multiplication by an odd number, modulo a power of two, shuffles.
            let shuffled = place.wrapping_mul(0x9e37_79b1) >> (32 - count.ilog2());
            let z = 1.0 - (2.0 * shuffled as f32 + 1.0) / count as f32;
            let turn = shuffled as f32 * 2.399_963; // golden angle
            let ring = (1.0 - z * z).max(0.0).sqrt();
            let normal = Vec3::new(ring * turn.cos(), ring * turn.sin(), z);
            let bump = 1.0 + 0.05 * (9.0 * normal.x).sin() * (7.0 * normal.y).cos();
            let [x, y, z] = (normal * bump).to_array();
            sphere.centres.push([x, y, z, radius]);
            sphere.normals.push(encode_normal(normal));
            sphere.colours.push(0xff00_0000 | shuffled);
        }
        sphere
    }

    fn columns(&self) -> [ColumnRecord<'_>; 3] {
        [
            ColumnRecord::new(
                columns::POSITION_RADIUS,
                ScalarType::F32,
                4,
                1,
                &self.centres,
            ),
            ColumnRecord::new(columns::NORMAL, ScalarType::U32, 1, 1, &self.normals),
            ColumnRecord::new(columns::COLOUR, ScalarType::U32, 1, 1, &self.colours),
        ]
    }
}

fn frame(camera: &Camera) -> FrameUniform {
    let clip_from_view = camera.clip_from_view(f64::from(SIZE_PX[0]) / f64::from(SIZE_PX[1]));
    let mut frame = FrameUniform {
        clip_from_view: clip_from_view.as_mat4().to_cols_array_2d(),
        view_from_clip: clip_from_view.inverse().as_mat4().to_cols_array_2d(),
        image_size_px: SIZE_PX.map(|size| size as f32),
        tile_size_px: SIZE_PX.map(|size| size as f32),
        radius_scale: 1.0,
        ambient: [0.1; 4],
        light_count: 1,
        ..FrameUniform::default()
    };
    frame.lights[0] = LightUniform {
        position_view: [0.0, 0.6, 0.8, 0.0],
        colour: [1.0; 4],
    };
    frame
}

fn draw_record<'a>(columns: &'a [ColumnRecord<'a>], count: u32, camera: &Camera) -> DrawRecord<'a> {
    let view_from_object = camera.view_from_world().as_mat4();
    DrawRecord {
        object: 0,
        block: BlockRecord {
            first_surfel: 0,
            surfel_count: count,
            columns: RSlice::from_slice(columns),
        },
        uniform: DrawUniform {
            view_from_object: view_from_object.to_cols_array_2d(),
            object_from_view: view_from_object.inverse().to_cols_array_2d(),
            view_from_object_normal: view_from_object.to_cols_array_2d(),
            material: [1.0, 0.8, 0.2, 20.0],
            radius_factor: 1.0,
            count,
            id_base: 1,
            flags: DrawFlags::HAS_NORMAL.0 | DrawFlags::HAS_COLOUR.0,
            ..DrawUniform::default()
        },
        uniform_offset: 0,
        columns_group: Handle::NONE,
        indices: RSlice::EMPTY,
        indirect_buffer: Handle::NONE,
    }
}

fn fallback(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("fallback");
    group.sample_size(20);
    for log_count in [17, 20] {
        let count = 1 << log_count;
        let sphere = Sphere::new(count);
        let columns = sphere.columns();
        group.throughput(Throughput::Elements(u64::from(count)));
        // The whole sphere, and a part that is twice as large.
        for (what, distance) in [("full", 3.5), ("close", 1.8)] {
            let camera = Camera {
                eye: DVec3::new(0.0, 0.0, distance),
                ..Camera::default()
            };
            let frame = frame(&camera);
            let draws = [draw_record(&columns, count, &camera)];
            let mut targets = CpuTargets::new(SIZE_PX, &HOST_TARGETS[..2]);
            let mut renderer = Fallback::default();
            group.bench_function(format!("{count} surfels, {what}"), |bencher| {
                bencher.iter(|| {
                    targets.clear();
                    black_box(renderer.draw(&frame, &draws, &mut targets, &|| false));
                });
            });
        }
    }
}

fn composition(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("compose");
    group.throughput(Throughput::Elements(u64::from(SIZE_PX[0] * SIZE_PX[1])));
    let mut planes = CpuTargets::new(SIZE_PX, &HOST_TARGETS);
    for record in planes.records() {
        // Some value that is finite in every format: 0x3e3e3e3e is 0.186.
        record.bytes.into_mut_slice().fill(0x3e);
    }
    let gpu = GpuDevice::open(&DeviceOptions::default())
        .inspect_err(|error| eprintln!("skipped: {error}"))
        .ok();
    let mut device = gpu.and_then(|gpu| {
        let mut targets = TargetSet::default();
        targets.fit(&gpu, SIZE_PX, &HOST_TARGETS).ok()?;
        Some((Composer::new(Arc::clone(&gpu)).ok()?, targets))
    });
    for shown in &HOST_TARGETS[..4] {
        let composition = Composition {
            shown: shown.clone(),
            background: Background::Gradient([0.2; 3], [0.4; 3]),
            exposure: 1.0,
            clip_from_view: Mat4::from_cols_array_2d(&frame(&Camera::default()).clip_from_view),
            tile_origin_y_px: 0.0,
            image_height_px: SIZE_PX[1] as f32,
            ramp_range: None,
        };
        group.bench_function(format!("{} on the CPU", shown.key), |bencher| {
            bencher.iter(|| black_box(compose_cpu::compose(&planes, &composition)));
        });
        if let Some((composer, targets)) = &mut device {
            group.bench_function(format!("{} on the device", shown.key), |bencher| {
                bencher.iter(|| {
                    black_box(composer.compose(targets, &composition, &[], Duration::from_mins(1)))
                });
            });
        }
    }
}

criterion_group!(benches, fallback, composition);
criterion_main!(benches);
