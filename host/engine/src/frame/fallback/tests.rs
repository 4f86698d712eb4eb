//! The fallback against closed forms, and against itself under other orders and thread counts.

use abi_stable::std_types::RSlice;
use glam::{Mat4, Vec3};
use pointstage_plugin_api::abi::{
    BlockRecord, ColumnRecord, DrawFlags, DrawRecord, DrawUniform, FrameUniform, Handle, ScalarType,
};
use pointstage_plugin_api::columns::{self, encode_normal};
use pointstage_scene::{Camera, Projection};

use super::super::cpu_targets::CpuTargets;
use super::super::targets::{COLOUR, DEPTH, HOST_TARGETS, ID, KIND, LOD, NO_LEVEL, NORMAL};
use super::*;
use crate::frame::eye_distance;

/// Surfels as columns.
#[derive(Clone, Default)]
struct Surfels {
    centres: Vec<[f32; 4]>,
    normals: Vec<u32>,
    colours: Vec<u32>,
}

/// Evenly spread over a sphere: a Fibonacci spiral.
fn sphere(count: u32, centre: Vec3, sphere_radius: f32) -> Surfels {
    let mut surfels = Surfels::default();
    // Some overlap, so that the sphere is closed.
    let radius = sphere_radius * (16.0 / count as f32).sqrt();
    for index in 0..count {
        let z = 1.0 - (2.0 * index as f32 + 1.0) / count as f32;
        let turn = index as f32 * 2.399_963; // golden angle
        let ring = (1.0 - z * z).sqrt();
        let normal = Vec3::new(ring * turn.cos(), ring * turn.sin(), z);
        let [x, y, z] = (centre + sphere_radius * normal).to_array();
        surfels.centres.push([x, y, z, radius]);
        surfels.normals.push(encode_normal(normal));
        surfels
            .colours
            .push(0xff00_0000 | index.wrapping_mul(2_654_435_761) >> 8);
    }
    surfels
}

impl Surfels {
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

fn frame(projection: Projection, size_px: [u32; 2]) -> FrameUniform {
    let camera = Camera {
        projection,
        near: 0.1,
        far: 100.0,
        ..Camera::default()
    };
    let aspect = f64::from(size_px[0]) / f64::from(size_px[1]);
    let clip_from_view = camera.clip_from_view(aspect);
    FrameUniform {
        clip_from_view: clip_from_view.as_mat4().to_cols_array_2d(),
        view_from_clip: clip_from_view.inverse().as_mat4().to_cols_array_2d(),
        tile_size_px: size_px.map(|size| size as f32),
        is_orthographic: u32::from(matches!(projection, Projection::Orthographic { .. })),
        radius_scale: 1.0,
        ambient: [1.0; 4],
        ..FrameUniform::default()
    }
}

const PERSPECTIVE: Projection = Projection::Perspective { fov_y_rad: 0.7 };

fn draw_record<'a>(columns: &'a [ColumnRecord<'a>], count: u32) -> DrawRecord<'a> {
    let identity = Mat4::IDENTITY.to_cols_array_2d();
    DrawRecord {
        object: 0,
        block: BlockRecord {
            first_surfel: 0,
            surfel_count: count,
            columns: RSlice::from_slice(columns),
        },
        uniform: DrawUniform {
            view_from_object: identity,
            object_from_view: identity,
            view_from_object_normal: identity,
            material: [1.0, 0.0, 0.0, 1.0],
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

fn render(frame: &FrameUniform, draws: &[DrawRecord<'_>]) -> (CpuTargets, Drawn) {
    let size_px = frame.tile_size_px.map(|size| size as u32);
    let mut targets = CpuTargets::new(size_px, &HOST_TARGETS);
    let drawn = Fallback::default().draw(frame, draws, &mut targets, &|| false);
    (targets, drawn)
}

fn render_surfels(frame: &FrameUniform, surfels: &Surfels) -> (CpuTargets, Drawn) {
    let columns = surfels.columns();
    render(
        frame,
        &[draw_record(&columns, surfels.centres.len() as u32)],
    )
}

#[test]
fn a_sphere_is_as_far_as_its_closed_form_says() {
    let centre = Vec3::new(0.1, -0.2, -4.0);
    let surfels = sphere(12_000, centre, 1.0);
    for projection in [PERSPECTIVE, Projection::Orthographic { height: 2.6 }] {
        let frame = frame(projection, [321, 241]);
        let (targets, drawn) = render_surfels(&frame, &surfels);
        assert_eq!(drawn.surfel_count, 12_000);
        let clip_from_view = Mat4::from_cols_array_2d(&frame.clip_from_view);
        let view_from_clip = Mat4::from_cols_array_2d(&frame.view_from_clip);
        let (mut checked, mut worst) = (0, 0.0_f32);
        for (index, depth) in targets.floats(DEPTH).unwrap().iter().enumerate() {
            let ndc = |pixel: usize, size: f32| (pixel as f32 + 0.5) / size * 2.0 - 1.0;
            let [x, y] = [ndc(index % 321, 321.0), -ndc(index / 321, 241.0)];
            // The pixel's ray through the two ends of the view volume.
            let [start, end] =
                [0.9, 0.1].map(|z| view_from_clip.project_point3(Vec3::new(x, y, z)));
            let ray = (end - start).normalize();
            let along = (centre - start).dot(ray);
            let beside = (centre - start).distance(along * ray);
            if beside > 1.05 {
                assert_eq!(
                    *depth, 0.0,
                    "{projection:?}: pixel {index} beside the sphere"
                );
            }
            // At the silhouette discs stick out over the sphere.
            if beside < 0.95 {
                let expected = -(start + (along - (1.0 - beside * beside).sqrt()) * ray).z;
                worst = worst.max((eye_distance(*depth, &clip_from_view) - expected).abs());
                checked += 1;
            }
        }
        // A disc of radius 0.037 stands out over the sphere by r²/2 = 0.0007 at its edge, which is 0.0022 along a ray that
        // is 72° from the normal (0.95 = sin 72°).
        assert!(
            checked > 20_000 && worst < 3e-3,
            "{projection:?}: {checked} px, worst {worst}"
        );
    }
}

#[test]
fn the_order_of_the_surfels_does_not_matter() {
    let mut surfels = sphere(20_000, Vec3::new(0.0, 0.0, -3.0), 1.0);
    let frame = frame(PERSPECTIVE, [200, 150]);
    let (before, _) = render_surfels(&frame, &surfels);
    // A permutation: 7919 is prime and no divisor of the count.
    let order: Vec<usize> = (0..20_000).map(|index| index * 7919 % 20_000).collect();
    surfels = Surfels {
        centres: order.iter().map(|index| surfels.centres[*index]).collect(),
        normals: order.iter().map(|index| surfels.normals[*index]).collect(),
        colours: order.iter().map(|index| surfels.colours[*index]).collect(),
    };
    let (after, _) = render_surfels(&frame, &surfels);
    assert!(before.floats(DEPTH) == after.floats(DEPTH), "depths differ");
    for key in [COLOUR, NORMAL] {
        let pixels =
            |targets: &CpuTargets| targets.floats(key).unwrap().as_chunks::<4>().0.to_vec();
        let pairs = core::iter::zip(pixels(&before), pixels(&after));
        let different = pairs.filter(|(before, after)| before != after).count();
        // Of equal depths the last wins: a few of 30,000 pixels, where depth has steps of 2⁻²⁹.
        assert!(different <= 15, "{key} differs in {different} px");
    }
}

#[test]
fn the_number_of_threads_does_not_matter() {
    let surfels = sphere(50_000, Vec3::new(0.0, 0.0, -3.0), 1.0);
    let frame = frame(PERSPECTIVE, [200, 150]);
    let with_threads = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.unwrap().install(|| render_surfels(&frame, &surfels).0)
    };
    let one = with_threads(1);
    for threads in [2, 3, 8] {
        assert!(with_threads(threads) == one, "{threads} threads");
    }
}

#[test]
fn ids_levels_and_kinds_name_what_is_seen() {
    let mut surfels = Surfels::default();
    for x in [-0.5, 0.0, 0.5] {
        surfels.centres.push([x, 0.0, -3.0, 0.1]);
        surfels.normals.push(encode_normal(Vec3::Z));
        surfels.colours.push(0xffff_ffff);
    }
    let columns = surfels.columns();
    let numbers = [2];
    let mut range = draw_record(&columns, 2);
    range.uniform.id_base = 10;
    let mut indexed = draw_record(&columns, 1);
    indexed.uniform.id_base = 100;
    indexed.uniform.level = 3.0;
    indexed.uniform.flags |= DrawFlags::INDEXED.0;
    indexed.indices = RSlice::from_slice(&numbers);
    let frame = frame(PERSPECTIVE, [120, 80]);
    let (targets, drawn) = render(&frame, &[range, indexed]);
    assert_eq!(drawn.surfel_count, 3);

    let (ids, lods) = (targets.numbers(ID).unwrap(), targets.numbers(LOD).unwrap());
    let kinds = targets.numbers(KIND).unwrap();
    for (x, id, level) in [(-0.5, 10, 0), (0.0, 11, 0), (0.5, 102, 3)] {
        let clip_from_view = Mat4::from_cols_array_2d(&frame.clip_from_view);
        let ndc = clip_from_view.project_point3(Vec3::new(x, 0.0, -3.0));
        let pixel = 40 * 120 + ((ndc.x + 1.0) * 60.0) as usize;
        assert_eq!(
            (ids[pixel], lods[pixel], kinds[pixel]),
            (id, level, 1),
            "x = {x}"
        );
    }
    let mut seen: Vec<u32> = ids.to_vec();
    seen.sort_unstable();
    seen.dedup();
    assert_eq!(seen, [0, 10, 11, 102]);
    assert_eq!((ids[0], lods[0], kinds[0]), (0, NO_LEVEL, 0));
}

#[test]
fn surfels_that_are_not_finite_are_counted_and_leave_no_trace() {
    let good = sphere(5_000, Vec3::new(0.0, 0.0, -3.0), 1.0);
    let mut mixed = good.clone();
    for broken in [
        [f32::NAN, 0.0, -1.0, 0.1],
        [0.0, f32::INFINITY, -1.0, 0.1],
        [0.0, 0.0, -1.0, f32::NAN],
        [0.0, 0.0, -1.0, f32::INFINITY],
        [f32::MAX, f32::MAX, f32::MAX, f32::MAX],
    ] {
        mixed.centres.push(broken);
        mixed.normals.push(0);
        mixed.colours.push(0);
    }
    let frame = frame(PERSPECTIVE, [100, 80]);
    let (expected, _) = render_surfels(&frame, &good);
    let (targets, drawn) = render_surfels(&frame, &mixed);
    // The last one is finite, and behind the eye.
    assert_eq!(drawn.broken_surfel_count, 4);
    assert!(targets == expected);
}

#[test]
fn any_place_and_radius_is_drawn_without_harm() {
    let mut surfels = Surfels::default();
    for z in [
        -1e30, -50.0, -1.0, -0.11, -0.1, -0.05, -1e-38, 0.0, 1.0, 1e30_f32,
    ] {
        for x in [-1e30, -1.0, 0.0, 1e-40, 3.0, 1e30_f32] {
            for radius in [-1.0, 0.0, 1e-40, 1e-3, 1.0, 1e20, f32::MAX] {
                for normal in [Vec3::X, Vec3::Z, Vec3::new(1.0, 0.0, 1e-4)] {
                    surfels.centres.push([x, -x, z, radius]);
                    surfels.normals.push(encode_normal(normal));
                    surfels.colours.push(0xffff_ffff);
                }
            }
        }
    }
    for projection in [PERSPECTIVE, Projection::Orthographic { height: 2.0 }] {
        for size_px in [[1, 1], [64, 3], [3, 64]] {
            let (targets, _) = render_surfels(&frame(projection, size_px), &surfels);
            let depth = targets.floats(DEPTH).unwrap();
            let in_range = depth.iter().all(|depth| (0.0..=1.0).contains(depth));
            assert!(in_range, "{projection:?} {size_px:?}");
            let colour = targets.floats(COLOUR).unwrap();
            assert!(colour.iter().all(|value| value.is_finite()));
        }
    }
}

#[test]
fn a_surfel_without_a_radius_still_has_its_pixel() {
    let surfels = Surfels {
        centres: vec![[0.0, 0.0, -3.0, 0.0]],
        normals: vec![encode_normal(Vec3::X)],
        colours: vec![0xff00_00ff],
    };
    let (targets, _) = render_surfels(&frame(PERSPECTIVE, [9, 9]), &surfels);
    let ids = targets.numbers(ID).unwrap();
    assert_eq!(ids.iter().filter(|id| **id != 0).count(), 1);
    assert_eq!(ids[4 * 9 + 4], 1);
}

#[test]
fn two_sided_surfels_are_lit_from_behind_too() {
    let surfels = Surfels {
        centres: vec![[0.0, 0.0, -2.0, 1.0]],
        normals: vec![encode_normal(Vec3::NEG_Z)],
        colours: vec![0xffff_ffff],
    };
    let columns = surfels.columns();
    let mut frame = frame(PERSPECTIVE, [5, 5]);
    frame.light_count = 1;
    frame.lights[0].position_view = [0.0, 0.0, 1.0, 0.0];
    frame.lights[0].colour = [1.0; 4];
    let lit = |flags| {
        let mut record = draw_record(&columns, 1);
        record.uniform.material = [0.0, 1.0, 0.0, 1.0];
        record.uniform.flags |= flags;
        let (targets, _) = render(&frame, &[record]);
        targets.floats(COLOUR).unwrap()[12 * 4]
    };
    assert_eq!(lit(0), 0.0);
    assert!((lit(DrawFlags::TWO_SIDED.0) - 1.0).abs() < 1e-3);
}

#[test]
fn missing_columns_take_the_defaults() {
    let surfels = sphere(1, Vec3::new(0.0, 0.0, -3.0), 1.0);
    let columns = surfels.columns();
    let mut record = draw_record(&columns[..1], 1);
    record.uniform.default_colour = [0.25, 0.5, 0.75, 1.0];
    let (targets, drawn) = render(&frame(PERSPECTIVE, [11, 11]), &[record]);
    assert_eq!(drawn.unreadable_draw_count, 0);
    let id = targets
        .numbers(ID)
        .unwrap()
        .iter()
        .position(|id| *id == 1)
        .unwrap();
    assert_eq!(
        targets.floats(COLOUR).unwrap()[id * 4..][..4],
        [0.25, 0.5, 0.75, 1.0]
    );
    assert_eq!(targets.floats(NORMAL).unwrap()[id * 4..][..3], [0.0; 3]);
}

#[test]
fn draws_that_only_the_device_can_read_are_counted() {
    let surfels = sphere(100, Vec3::new(0.0, 0.0, -3.0), 1.0);
    let columns = surfels.columns();
    let mut record = draw_record(&columns, 100);
    record.uniform.flags |= DrawFlags::INDEXED.0;
    let nowhere = draw_record(&columns[1..], 100);
    let (targets, drawn) = render(&frame(PERSPECTIVE, [20, 20]), &[record, nowhere]);
    assert_eq!(drawn.unreadable_draw_count, 2);
    assert!(targets == CpuTargets::new([20, 20], &HOST_TARGETS));
}

#[test]
fn numbers_outside_the_block_are_left_out() {
    let surfels = sphere(100, Vec3::new(0.0, 0.0, -3.0), 1.0);
    let columns = surfels.columns();
    let mut record = draw_record(&columns, 1);
    let numbers = [5, 100, u32::MAX];
    record.indices = RSlice::from_slice(&numbers);
    let mut late = draw_record(&columns, 50);
    late.uniform.first = 90;
    let (_, drawn) = render(&frame(PERSPECTIVE, [20, 20]), &[record, late]);
    assert_eq!((drawn.surfel_count, drawn.broken_surfel_count), (11, 2));
}

#[test]
fn a_stopped_frame_says_so() {
    let surfels = sphere(100, Vec3::new(0.0, 0.0, -3.0), 1.0);
    let columns = surfels.columns();
    let mut targets = CpuTargets::new([20, 20], &HOST_TARGETS);
    let record = draw_record(&columns, 100);
    let frame = frame(PERSPECTIVE, [20, 20]);
    let drawn = Fallback::default().draw(&frame, &[record], &mut targets, &|| true);
    assert!(drawn.stopped);
}
