use glam::DQuat;
use pointstage_plugin_api::columns::decode_colour;
use proptest::prelude::*;

use super::*;
use crate::geometry::ScalarType;

fn points(centres: &[[f32; 3]], radius: f32) -> Block {
    Block {
        position_radius: centres.iter().map(|&[x, y, z]| [x, y, z, radius]).collect(),
        ..Block::default()
    }
}

fn object(block: Block) -> Object {
    Object::new(
        "object",
        DVec3::ZERO,
        Geometry::new(vec![block], None, Origins::default()),
    )
}

fn named(name: &str, values: &[f32]) -> NamedColumn {
    NamedColumn {
        name: name.into(),
        scalar: ScalarType::F32,
        components: 1,
        bytes: values
            .iter()
            .flat_map(|value| value.to_ne_bytes())
            .collect(),
    }
}

fn merged(objects: &[&Object]) -> (Object, Block) {
    let merged = merge(objects, "both").expect("they can be merged");
    let block = merged.geometry.blocks[0].clone();
    (merged, block)
}

#[test]
fn nothing_and_one_are_not_merged() {
    let one = object(points(&[[0.0; 3]], 1.0));
    assert_eq!(merge(&[], "none").err(), Some(MergeError::TooFew(0)));
    assert_eq!(merge(&[&one], "one").err(), Some(MergeError::TooFew(1)));
}

#[test]
fn objects_in_one_place_keep_it_and_their_positions_to_the_last_bit() {
    let mut first = object(points(&[[0.1, 0.2, 0.3]], 0.7));
    first.origin = DVec3::new(500_000.5, 0.0, 0.0);
    first.world_from_object = DAffine3::from_rotation_x(0.3);
    let mut second = object(points(&[[0.4, 0.5, 0.6]], 0.9));
    second.origin = first.origin;
    second.world_from_object = first.world_from_object;
    let (merged, block) = merged(&[&first, &second]);
    assert_eq!(merged.origin, first.origin);
    assert_eq!(merged.world_from_object, first.world_from_object);
    assert_eq!(
        *block.position_radius,
        [[0.1, 0.2, 0.3, 0.7], [0.4, 0.5, 0.6, 0.9]]
    );
}

#[test]
fn transforms_origins_and_radius_scales_are_applied() {
    let mut first = object(points(&[[1.0, 0.0, 0.0]], 0.5));
    first.geometry = Arc::new(Geometry::new(
        vec![Block {
            normal: Some(Arc::from([encode_normal(Vec3::X)])),
            axes: Some(Arc::from([[0.0, 0.5, 0.0, 0.0, 0.0, 0.0, 0.25, 0.0]])),
            ..points(&[[1.0, 0.0, 0.0]], 0.5)
        }],
        None,
        Origins::default(),
    ));
    // x to y, and twice as large.
    let turn = DQuat::from_rotation_z(std::f64::consts::FRAC_PI_2);
    first.world_from_object = DAffine3::from_scale_rotation_translation(
        DVec3::splat(2.0),
        turn,
        DVec3::new(0.0, 0.0, 3.0),
    );
    first.radius_scale = 3.0;
    let mut second = object(points(&[[0.0; 3]], 1.0));
    second.origin = DVec3::new(-4.0, 0.0, 0.0);
    let (merged, block) = merged(&[&first, &second]);
    let origin = merged.origin.as_vec3();
    assert!((block.centre(0) + origin).distance(Vec3::new(0.0, 2.0, 3.0)) < 1e-5);
    assert!((block.centre(1) + origin).distance(Vec3::new(-4.0, 0.0, 0.0)) < 1e-5);
    assert!(
        (block.position_radius[0][3] - 3.0).abs() < 1e-6,
        "0.5 · 2 · 3"
    );
    assert_eq!(block.position_radius[1][3], 1.0);
    assert!(block.normal_at(0).expect("normals").distance(Vec3::Y) < 1e-4);
    let axes = block.axes.expect("axes")[0];
    let expected = [-3.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.5, 0.0];
    for (found, expected) in axes.iter().zip(expected) {
        assert!((found - expected).abs() < 1e-5, "{axes:?}");
    }
}

#[test]
fn missing_columns_take_the_defaults_that_are_stated() {
    let full = object(Block {
        normal: Some(Arc::from([encode_normal(Vec3::Y)])),
        colour: Some(Arc::from([0xff00_00ff])),
        axes: Some(Arc::from([[2.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0]])),
        named: vec![named("intensity", &[7.5])],
        ..points(&[[0.0; 3]], 2.0)
    });
    let bare = object(points(&[[1.0; 3]], 0.5));
    let (_, block) = merged(&[&full, &bare]);
    assert_eq!(block.normal.expect("normals")[1], NO_NORMAL);
    let colour = block.colour.expect("colours");
    assert_eq!(colour[0], 0xff00_00ff);
    let grey = decode_colour(colour[1]);
    assert!((grey.x - 0.7354).abs() < 0.003 && grey.w == 1.0, "{grey}");
    assert_eq!(
        block.axes.expect("axes")[1].map(f32::abs),
        [0.5, 0.0, 0.0, 0.0, 0.0, 0.5, 0.0, 0.0],
        "a disk in the plane of x and y"
    );
    let intensity = &block.named[0];
    assert_eq!(
        (intensity.value(0, 0), intensity.value(1, 0)),
        (Some(7.5), Some(0.0))
    );
}

#[test]
fn named_columns_of_one_name_are_one_and_of_other_types_f64() {
    let class = |scalar: ScalarType, bytes: Vec<u8>, components| NamedColumn {
        name: "class".into(),
        scalar,
        components,
        bytes: bytes.into(),
    };
    let first = object(Block {
        named: vec![class(ScalarType::U8, vec![200], 1)],
        ..points(&[[0.0; 3]], 1.0)
    });
    let second = object(Block {
        named: vec![
            class(ScalarType::I16, (-300_i16).to_ne_bytes().into(), 1),
            named("time", &[1.5]),
        ],
        ..points(&[[1.0; 3]], 1.0)
    });
    let third = object(Block {
        named: vec![class(ScalarType::U8, vec![1, 2], 2)],
        ..points(&[[2.0; 3]], 1.0)
    });
    let (_, block) = merged(&[&first, &second, &third]);
    let names: Vec<_> = block.named.iter().map(|column| &*column.name).collect();
    assert_eq!(names, ["class", "time", "class_2"]);
    let values = |column: usize, component| {
        [0, 1, 2].map(|surfel| block.named[column].value(surfel, component))
    };
    assert_eq!(values(0, 0), [Some(200.0), Some(-300.0), Some(0.0)]);
    assert_eq!(values(1, 0), [Some(0.0), Some(1.5), Some(0.0)]);
    assert_eq!(values(2, 1), [Some(0.0), Some(0.0), Some(2.0)]);
}

#[test]
fn triangles_name_the_surfels_that_they_did_and_keep_their_outside() {
    let mesh = || {
        let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let triangles = Some(Arc::from([[0, 1, 2]]));
        let geometry = Geometry::new(vec![points(&corners, 1.0)], triangles, Origins::default());
        Object::new("mesh", DVec3::ZERO, geometry)
    };
    let cloud = object(points(&[[5.0; 3]], 1.0));
    let mut mirrored = mesh();
    mirrored.world_from_object = DAffine3::from_scale(DVec3::new(-1.0, 1.0, 1.0));
    let (merged, _) = merged(&[&mesh(), &cloud, &mirrored]);
    let triangles = merged.geometry.triangles.as_ref().expect("triangles");
    assert_eq!(**triangles, [[0, 1, 2], [4, 6, 5]]);
}

#[test]
fn estimated_normals_make_all_of_them_estimated() {
    let with = |normals| {
        let mut object = object(points(&[[0.0; 3]], 1.0));
        let origins = Origins {
            normals,
            ..Origins::default()
        };
        object.geometry = Arc::new(Geometry::new(object.geometry.blocks.clone(), None, origins));
        object
    };
    let of = |one, other| {
        let (merged, _) = merged(&[&with(one), &with(other)]);
        merged.geometry.origins.normals
    };
    assert_eq!(
        of(Provenance::FromFile, Provenance::Estimated),
        Provenance::Estimated
    );
    assert_eq!(
        of(Provenance::FromFile, Provenance::Missing),
        Provenance::FromFile
    );
    assert_eq!(
        of(Provenance::Missing, Provenance::Missing),
        Provenance::Missing
    );
}

#[test]
fn blocks_are_full_but_for_the_last() {
    let half = MAX_BLOCK_SURFELS / 2 + 1;
    let large = || {
        let block = Block {
            position_radius: vec![[1.0, 2.0, 3.0, 4.0]; half].into(),
            ..Block::default()
        };
        object(block)
    };
    let merged = merge(&[&large(), &large()], "both").expect("they can be merged");
    let lengths: Vec<_> = merged.geometry.blocks.iter().map(Block::len).collect();
    assert_eq!(lengths, [MAX_BLOCK_SURFELS, 2]);
}

fn any_object() -> impl Strategy<Value = Object> {
    let centre = [-10.0..10.0f32, -10.0..10.0, -10.0..10.0];
    let centres = proptest::collection::vec(centre, 1..20);
    let origin = [-1e5..1e5f64, -1e5..1e5, -1e5..1e5];
    let shift = [-50.0..50.0f64, -50.0..50.0, -50.0..50.0];
    (centres, origin, shift, 0.1..10.0f64, any::<bool>()).prop_map(
        |(centres, origin, shift, scale, is_coloured)| {
            let mut block = points(&centres, 1.0);
            block.colour = is_coloured.then(|| vec![9; centres.len()].into());
            let mut object = object(block);
            object.origin = origin.into();
            let [x, y, z] = shift;
            object.world_from_object = DAffine3::from_translation(DVec3::new(x, y, z))
                * DAffine3::from_scale(DVec3::splat(scale));
            object
        },
    )
}

proptest! {
    #[test]
    fn the_union_has_all_surfels_in_the_box_around_all_boxes(
        objects in proptest::collection::vec(any_object(), 2..5)
    ) {
        let all: Vec<&Object> = objects.iter().collect();
        let merged = merge(&all, "all").expect("they can be merged");
        let count: usize = objects.iter().map(|object| object.geometry.surfel_count).sum();
        prop_assert_eq!(merged.geometry.surfel_count, count);
        let expected = objects.iter().fold(Bounds::EMPTY, |bounds, object| bounds.union(object.bounds_world()));
        let found = merged.bounds_world();
        // Positions of the union are f32 relative to its origin: a part of 2⁻²³ of the box and of its distance from 0.
        let tolerance = (expected.size().length() + 1e5) * 2e-7 * 16.0;
        prop_assert!(found.min.distance(expected.min) <= tolerance, "{found:?}, not {expected:?}");
        prop_assert!(found.max.distance(expected.max) <= tolerance, "{found:?}, not {expected:?}");
    }

    #[test]
    fn turned_objects_stay_inside_the_box_of_their_turned_boxes(
        objects in proptest::collection::vec(any_object(), 2..4), angle in -3.0..3.0f64,
    ) {
        let mut objects = objects;
        for object in &mut objects {
            object.world_from_object *= DAffine3::from_rotation_y(angle);
        }
        let all: Vec<&Object> = objects.iter().collect();
        let found = merge(&all, "all").expect("they can be merged").bounds_world();
        let box_of_boxes = objects.iter().fold(Bounds::EMPTY, |bounds, object| bounds.union(object.bounds_world()));
        let slack = DVec3::splat((box_of_boxes.size().length() + 1e6) * 2e-7 * 16.0);
        prop_assert!((box_of_boxes.min - slack).cmple(found.min).all(), "{found:?} in {box_of_boxes:?}");
        prop_assert!(found.max.cmple(box_of_boxes.max + slack).all(), "{found:?} in {box_of_boxes:?}");
    }
}
