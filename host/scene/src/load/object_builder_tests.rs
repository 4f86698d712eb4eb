use super::*;
use crate::geometry::ScalarType;
use crate::load::Estimation;
use bytemuck::cast_slice;

const POSITION: ColumnSpec = ColumnSpec {
    role: ColumnRole::Position,
    name: String::new(),
    scalar: ScalarType::F64,
    components: 3,
};

const SQUARE: [[f64; 3]; 4] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [1.0, 1.0, 0.0],
    [0.0, 1.0, 0.0],
];

fn file_only() -> LoadOptions {
    LoadOptions {
        estimation: Estimation::FileOnly,
        ..LoadOptions::default()
    }
}

#[test]
fn columns_of_map_coordinates_keep_their_digits_and_their_types() {
    let colour = ColumnSpec::new(ColumnRole::Colour, ScalarType::U16, 3);
    let time = ColumnSpec::named("time", ScalarType::F64, 1);
    let mut builder = ObjectBuilder::new(vec![POSITION, colour, time]).expect("sound columns");
    for row in 0..4_u16 {
        let at = 4_900_000.0 + f64::from(row) * 0.001;
        let positions = [600_000.0, at, 1.0];
        let colours = [row * 257, 0, 65535];
        builder
            .add_rows(
                1,
                &[
                    cast_slice(&positions),
                    cast_slice(&colours),
                    cast_slice(&[at]),
                ],
            )
            .expect("of the right length");
    }
    let Contents {
        origin, geometry, ..
    } = builder
        .finish(&file_only(), &Job::new())
        .expect("an object");
    let at = |row: usize| origin + geometry.blocks[0].centre(row).as_dvec3();
    assert!((at(3).y - 4_900_000.003).abs() < 1e-9, "{}", at(3));
    assert_eq!(
        geometry.blocks[0].colour.as_deref().map(|colour| colour[2]),
        Some(0xffff_0002)
    );
    assert_eq!(geometry.blocks[0].named[0].value(1, 0), Some(4_900_000.001));
}

#[test]
fn scaled_numbers_and_their_values_give_the_same_object() {
    let by = PositionScale {
        scale: glam::DVec3::new(0.001, -0.01, 0.25),
        offset: glam::DVec3::new(4_900_000.0, 12.5, -3.0),
    };
    for components in [3, 2] {
        let (mut numbers, mut values) = (Vec::new(), Vec::new());
        for row in 0..5000_i32 {
            let of_row = [row * 7919 % 100_003, 7 - row, row % 13];
            let value = by.scale * glam::IVec3::from_array(of_row).as_dvec3() + by.offset;
            numbers.extend_from_slice(&of_row[..components]);
            values.extend_from_slice(&value.to_array()[..components]);
        }
        let builder = |scalar: ScalarType| {
            let components = components as u32;
            let spec = ColumnSpec::new(ColumnRole::Position, scalar, components);
            ObjectBuilder::new(vec![spec]).expect("sound")
        };
        let mut scaled = builder(ScalarType::I32);
        scaled.scale_positions(by).expect("whole numbers");
        scaled
            .add_rows(5000, &[cast_slice(&numbers)])
            .expect("of the right length");
        let mut plain = builder(ScalarType::F64);
        let refused = plain
            .scale_positions(by)
            .expect_err("only whole numbers are");
        assert!(refused.to_string().contains("F64"), "{refused}");
        plain
            .add_rows(5000, &[cast_slice(&values)])
            .expect("of the right length");
        let [scaled, plain] = [scaled, plain].map(|builder| {
            builder
                .finish(&file_only(), &Job::new())
                .expect("an object")
        });
        assert_ne!(plain.origin, glam::DVec3::ZERO, "{components}");
        assert_eq!(scaled.origin, plain.origin, "{components}");
        assert_eq!(
            scaled.geometry.bounds, plain.geometry.bounds,
            "{components}"
        );
        assert_eq!(
            scaled.geometry.blocks[0].position_radius, plain.geometry.blocks[0].position_radius,
            "{components}"
        );
    }
}

#[test]
fn lengths_that_do_not_fit_are_refused_and_add_nothing() {
    let mut builder = ObjectBuilder::new(vec![POSITION]).expect("sound");
    for columns in [&[][..], &[&[0_u8; 23][..]], &[&[0_u8; 24][..], &[0][..]]] {
        assert!(
            matches!(builder.add_rows(1, columns), Err(BuildError::Length { .. })),
            "{columns:?}"
        );
    }
    assert!(builder.add_polygons(&[3, 4], &[0; 6]).is_err());
    assert_eq!(builder.rows(), 0);
    let error = builder
        .finish(&file_only(), &Job::new())
        .expect_err("nothing in it");
    assert!(format!("{error:?}").contains("Nothing"), "{error:?}");
    for specs in [
        vec![],
        vec![POSITION, POSITION],
        vec![ColumnSpec {
            components: 4,
            ..POSITION
        }],
    ] {
        assert!(ObjectBuilder::new(specs.clone()).is_err(), "{specs:?}");
    }
}

#[test]
fn triangles_and_polygons_may_come_in_any_order() {
    let mut builder = ObjectBuilder::new(vec![POSITION]).expect("sound");
    builder.add_rows(4, &[cast_slice(&SQUARE)]).expect("four");
    builder.add_triangles(&[[0, 1, 2]]);
    builder
        .add_polygons(&[4, 3], &[0, 1, 2, 3, 0, 2, 9])
        .expect("seven corners");
    builder.add_triangles(&[[0, 2, 3]]);
    let contents = builder
        .finish(&file_only(), &Job::new())
        .expect("an object");
    let triangles = contents.geometry.triangles.expect("a mesh");
    assert_eq!(*triangles, [[0, 1, 2], [0, 1, 2], [0, 2, 3], [0, 2, 3]]);
    assert_eq!(
        contents
            .warnings
            .count(&WarningKind::FacesOutOfRangeDropped),
        1
    );
}

#[test]
fn pictures_are_of_the_polygons_that_came_first() {
    let mut builder = ObjectBuilder::new(vec![POSITION]).expect("sound");
    let uv = |corner: usize| [SQUARE[corner][0] as f32, SQUARE[corner][1] as f32];
    builder.add_rows(4, &[cast_slice(&SQUARE)]).expect("four");
    builder.add_triangles(&[[0, 1, 2]]);
    let picture = builder.add_picture("wood", b"\x89PNG\r\n\x1a\n");
    let problem = |outcome: Result<(), BuildError>| outcome.expect_err("wrong").to_string();
    let wrong = builder.add_polygon_pictures(&[picture, picture], &[[0.0; 2]; 6]);
    assert!(problem(wrong).contains("no 2 more"));
    let wrong = builder.add_polygon_pictures(&[picture], &[[0.0; 2]; 4]);
    assert!(problem(wrong).contains("3 corners came with 4"));
    let wrong = builder.add_polygon_pictures(&[1], &[[0.0; 2]; 3]);
    assert!(problem(wrong).contains("no texture 1"));
    builder
        .add_polygon_pictures(&[NO_PICTURE], &[[0.0; 2]; 3])
        .expect("one triangle");
    // A corner twice is dropped, and its coordinates with it; a surfel that never comes drops the face.
    builder
        .add_polygons(&[5, 3, 3], &[3, 3, 0, 1, 2, 0, 1, 9, 0, 2, 3])
        .expect("eleven corners");
    let own = [[9.0; 2], uv(3), uv(0), uv(1), uv(2), uv(0), uv(1), [0.5; 2]];
    builder
        .add_polygon_pictures(&[picture, picture], &own)
        .expect("two polygons");
    let contents = builder
        .finish(&file_only(), &Job::new())
        .expect("an object");
    let geometry = contents.geometry;
    let triangles = geometry.triangles.as_ref().expect("a mesh");
    assert_eq!(triangles.len(), 4);
    let textures = geometry.textures.as_ref().expect("textures");
    assert_eq!(*textures.of_triangle, [NO_PICTURE, 0, 0, NO_PICTURE]);
    for triangle in 1..3 {
        let corners = triangles[triangle].map(|corner| match corner {
            // The first of the two.
            3 => [9.0; 2],
            corner => uv(corner as usize),
        });
        assert_eq!(textures.uvs[triangle], corners);
    }
    assert!(
        textures.uvs[3]
            .as_flattened()
            .iter()
            .all(|value| value.is_nan())
    );
    assert_eq!(textures.pictures[0].extension(), "png");
    assert!(geometry.byte_count() > 4 * 16 + 4 * 12 + 4 * 28);
}

#[test]
fn triangles_alone_keep_their_order_and_bad_ones_are_counted() {
    for parts in [1, 2] {
        let mut builder = ObjectBuilder::new(vec![POSITION]).expect("sound");
        let places: Vec<[f64; 3]> = (0..40_000).map(|x| [f64::from(x), 0.0, 1.0]).collect();
        builder
            .add_rows(places.len(), &[cast_slice(&places)])
            .expect("of the right length");
        let mut triangles: Vec<[u32; 3]> = (2..40_000).map(|x| [x, x - 1, x - 2]).collect();
        triangles.extend([[0, 1, 40_000], [5, 6, 5]]);
        for part in triangles.chunks(triangles.len().div_ceil(parts)) {
            builder.add_triangles(part);
        }
        let contents = builder
            .finish(&file_only(), &Job::new())
            .expect("an object");
        let found = contents.geometry.triangles.expect("a mesh");
        assert_eq!(*found, triangles[..39_998], "in {parts} parts");
        for kind in [
            WarningKind::FacesOutOfRangeDropped,
            WarningKind::DegenerateFacesDropped,
        ] {
            assert_eq!(contents.warnings.count(&kind), 1, "in {parts} parts");
        }
    }
}
