//! Small files made for one question each: what the loader must read, drop, count or refuse.

use crate::support::load_bytes;
use crate::texts::{FILE_ONLY, XYZ, text, world};
use glam::{DVec3, Vec3};
use pointstage_scene::{LoadOptions, Loaded, Provenance, WarningKind, Winding};

fn binary(elements: &str, body: &[u8]) -> Result<Loaded, String> {
    let mut file =
        format!("ply\nformat binary_little_endian 1.0\n{elements}\nend_header\n").into_bytes();
    file.extend_from_slice(body);
    load_bytes(&file, &FILE_ONLY).map_err(|error| error.to_string())
}

#[test]
fn headers_that_lie_are_refused_with_place_and_counts() {
    let faces = "element face 4000000000\nproperty list uchar int vertex_indices";
    let one = format!("element vertex 1\n{XYZ}");
    for (result, parts) in [
        (
            binary(&format!("element vertex 4000000000\n{XYZ}"), &[0; 24]),
            ["4000000000 rows", "48000000000 bytes", "24 bytes"],
        ),
        (
            binary(&format!("{one}\n{faces}"), &[0; 40]),
            ["'face'", "4000000000", "28 bytes"],
        ),
        (
            binary(
                &format!("element vertex 18446744073709551615\n{XYZ}"),
                &[0; 24],
            ),
            ["at most 4294967280", "vertex", "split"],
        ),
        (
            text(&format!("element vertex 1000000000\n{XYZ}"), "1 2 3\n"),
            ["expected row 2 of 1000000000", "line 8", "truncated"],
        ),
        (
            text(&format!("{one}\n{faces}"), "0 0 0\n3 0 0 0\n"),
            ["expected row 2 of 4000000000", "'face'", "line 11"],
        ),
        (
            binary(&format!("element vertex 3\n{XYZ}"), &[0; 30]),
            ["row 3 of 3", "inside property 'y'", "6 bytes short"],
        ),
    ] {
        let error = result.expect_err("refused");
        assert!(parts.iter().all(|part| error.contains(part)), "{error}");
    }
}

#[test]
fn lists_with_impossible_lengths_are_refused() {
    let elements =
        format!("element vertex 1\n{XYZ}\nelement face 1\nproperty list int int vertex_indices");
    for (length, part) in [(-5_i32, "length -5"), (i32::MAX, "length 2147483647")] {
        let body = [[0; 12].as_slice(), &length.to_le_bytes(), &[0; 12]].concat();
        let error = binary(&elements, &body).expect_err("refused");
        assert!(
            error.contains(part) && error.contains("byte ") && error.contains("'face'"),
            "{error}"
        );
        let error = text(&elements, &format!("0 0 0\n{length} 0 0 0\n")).expect_err("refused");
        assert!(error.contains(part) && error.contains("line 11"), "{error}");
    }
}

#[test]
fn every_truncation_of_a_binary_mesh_is_refused() {
    let elements =
        format!("element vertex 3\n{XYZ}\nelement face 2\nproperty list uchar int vertex_indices");
    let row =
        |corners: [i32; 3]| [[3_u8].as_slice(), &corners.map(i32::to_le_bytes).concat()].concat();
    let positions: Vec<u8> = [0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]
        .iter()
        .flat_map(|v| v.to_le_bytes())
        .collect();
    let body = [positions, row([0, 1, 2]), row([2, 1, 0])].concat();
    assert_eq!(
        binary(&elements, &body)
            .expect("whole")
            .object
            .geometry
            .triangle_count(),
        2
    );
    for length in 0..body.len() {
        let error = binary(&elements, &body[..length]).expect_err("refused");
        assert!(error.contains("byte"), "{length} bytes gave: {error}");
    }
}

#[test]
fn points_that_are_not_finite_are_dropped_and_faces_follow() {
    let elements = format!(
        "element vertex 5\n{XYZ}\nproperty uchar tag\nelement face 3\nproperty list uchar int vertex_indices"
    );
    let body = "0 0 0 10\nnan 0 0 11\n1 0 0 12\n0 1 0 13\n0 0 inf 14\n3 0 1 2\n3 0 2 3\n3 3 2 4\n";
    let loaded = text(&elements, body).expect("loaded");
    let geometry = &loaded.object.geometry;
    assert_eq!(geometry.surfel_count, 3);
    assert_eq!(geometry.triangles.as_deref(), Some([[0, 1, 2]].as_slice()));
    assert_eq!(geometry.blocks[0].named[0].bytes[..], [10, 12, 13]);
    assert_eq!(
        loaded
            .warnings
            .count(&WarningKind::NonFinitePositionsDropped),
        2
    );
    assert_eq!(
        loaded.warnings.count(&WarningKind::FacesOutOfRangeDropped),
        2
    );
    let error = text(&format!("element vertex 1\n{XYZ}"), "nan 0 0\n").expect_err("nothing left");
    assert!(error.contains("all 1 vertices"), "{error}");
}

#[test]
fn map_coordinates_keep_a_tenth_of_a_millimetre() {
    let positions = [
        DVec3::new(500_000.123_4, 4_900_000.567_8, 312.001_2),
        DVec3::new(500_080.000_1, 4_900_033.333_3, 300.0),
    ];
    for scalar in ["double", "float"] {
        let elements = format!(
            "element vertex 2\nproperty {scalar} x\nproperty {scalar} y\nproperty {scalar} z"
        );
        let line = |p: &DVec3| format!("{} {} {}\n", p.x, p.y, p.z);
        let loaded =
            text(&elements, &positions.iter().map(line).collect::<String>()).expect("loaded");
        for (index, position) in positions.iter().enumerate() {
            let error = (world(&loaded, index) - *position).abs().max_element();
            assert!(error < 1e-5, "{scalar}: {error} off");
        }
    }
    let bytes: Vec<u8> = positions
        .iter()
        .flat_map(DVec3::to_array)
        .flat_map(f64::to_le_bytes)
        .collect();
    let loaded = binary(
        "element vertex 2\nproperty double x\nproperty double y\nproperty double z",
        &bytes,
    )
    .expect("loaded");
    assert!((world(&loaded, 0) - positions[0]).abs().max_element() < 1e-5);
}

#[test]
fn normals_and_radii_are_the_same_in_map_coordinates_as_near_the_origin() {
    let far = DVec3::new(500_000.0, 4_900_000.0, 312.0);
    let point = |index: u32| {
        let (u, v) = (f64::from(index % 40) * 0.05, f64::from(index / 40) * 0.05);
        DVec3::new(u, v, 0.3 * u.sin() + 0.01 * v)
    };
    let cloud = |origin: DVec3| {
        let line = |index| {
            let p = origin + point(index);
            format!("{:.4} {:.4} {:.4}\n", p.x, p.y, p.z)
        };
        let body: String = (0..1600).map(line).collect();
        let header = "element vertex 1600\nproperty double x\nproperty double y\nproperty double z";
        let file = format!("ply\nformat ascii 1.0\n{header}\nend_header\n{body}");
        load_bytes(file.as_bytes(), &LoadOptions::default()).expect("loaded")
    };
    let (near, far) = (cloud(DVec3::ZERO), cloud(far));
    assert_ne!(far.object.origin, DVec3::ZERO);
    let [near, far] = [&near, &far].map(|loaded| &loaded.object.geometry.blocks[0]);
    for surfel in 0..1600 {
        let radii = [near, far].map(|block| block.position_radius[surfel][3]);
        assert!(
            (radii[0] / radii[1] - 1.0).abs() < 1e-4,
            "surfel {surfel}: {radii:?}"
        );
        let normals = [near, far].map(|block| block.normal_at(surfel).expect("normals"));
        assert!(
            normals[0].dot(normals[1]).abs() > 0.999_99,
            "surfel {surfel}: {normals:?}"
        );
    }
}

#[test]
fn colours_of_every_type_become_bytes() {
    for (scalar, values, expected) in [
        ("uchar", "255 128 0", [255, 128, 0, 255]),
        ("char", "-1 127 0", [255, 127, 0, 255]),
        ("ushort", "65535 32896 0", [255, 128, 0, 255]),
        ("float", "1.0 0.5 -3", [255, 128, 0, 255]),
        ("double", "255 128 nan", [255, 128, 0, 255]),
        ("int", "300 128 -7", [255, 128, 0, 255]),
    ] {
        let colours = ["red", "green", "blue"]
            .map(|name| format!("\nproperty {scalar} {name}"))
            .concat();
        let loaded = text(
            &format!("element vertex 1\n{XYZ}{colours}"),
            &format!("0 0 0 {values}\n"),
        )
        .expect(scalar);
        let colour = loaded.object.geometry.blocks[0]
            .colour
            .as_ref()
            .map(|column| column[0].to_le_bytes());
        assert_eq!(colour, Some(expected), "{scalar}");
        assert_eq!(loaded.object.geometry.origins.colours, Provenance::FromFile);
    }
}

#[test]
fn axes_give_normal_and_radius_when_the_file_has_none() {
    let axes = ["ux", "uy", "uz", "vx", "vy", "vz"]
        .map(|name| format!("\nproperty float {name}"))
        .concat();
    let loaded = text(
        &format!("element vertex 1\n{XYZ}{axes}"),
        "0 0 0 2 0 0 0 0.5 0\n",
    )
    .expect("loaded");
    let block = &loaded.object.geometry.blocks[0];
    assert_eq!(
        (block.position_radius[0][3], block.normal_at(0)),
        (2.0, Some(Vec3::Z))
    );
    assert_eq!(
        block.axes.as_deref(),
        Some([[2.0, 0.0, 0.0, 0.0, 0.0, 0.5, 0.0, 0.0]].as_slice())
    );
    let ignored = text(
        &format!("element vertex 1\n{XYZ}{axes}"),
        "0 0 0 2 0 0 4 0 0\n",
    )
    .expect("loaded");
    assert!(ignored.object.geometry.blocks[0].axes.is_none());
    assert_eq!(ignored.warnings.count(&WarningKind::UnusableAxesIgnored), 1);
}

#[test]
fn useless_normals_and_radii_are_computed_and_counted() {
    let elements = format!(
        "element vertex 4\n{XYZ}\nproperty float nx\nproperty float ny\nproperty float nz\nproperty float radius\n\
         element face 2\nproperty list uchar int vertex_indices"
    );
    let body = "0 0 0 0 0 1 5\n1 0 0 nan 0 1 5\n1 1 0 0 0 0 -1\n0 1 0 1 0 0 5\n3 0 1 2\n3 0 2 3\n";
    let file = format!("ply\nformat ascii 1.0\n{elements}\nend_header\n{body}");
    let loaded = load_bytes(file.as_bytes(), &LoadOptions::default()).expect("loaded");
    let block = &loaded.object.geometry.blocks[0];
    let normals: Vec<Vec3> = (0..4)
        .filter_map(|surfel| block.normal_at(surfel))
        .collect();
    assert_eq!(
        normals,
        [Vec3::Z, Vec3::Z, Vec3::Z, Vec3::X],
        "the file's own are kept"
    );
    let radii: Vec<f32> = block
        .position_radius
        .iter()
        .map(|surfel| surfel[3])
        .collect();
    assert!((radii[2] - 0.5_f32.sqrt()).abs() < 1e-6, "{radii:?}");
    assert_eq!([radii[0], radii[1], radii[3]], [5.0; 3]);
    assert_eq!(
        loaded.warnings.count(&WarningKind::UnusableNormalsReplaced),
        2
    );
    assert_eq!(
        loaded.warnings.count(&WarningKind::UnusableRadiiReplaced),
        1
    );
}

#[test]
fn vertices_without_a_face_get_their_radius_from_neighbours() {
    let elements =
        format!("element vertex 4\n{XYZ}\nelement face 1\nproperty list uchar int vertex_indices");
    let file = format!(
        "ply\nformat ascii 1.0\n{elements}\nend_header\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n3 0 1 2\n"
    );
    let loaded = load_bytes(file.as_bytes(), &LoadOptions::default()).expect("loaded");
    let geometry = &loaded.object.geometry;
    assert!(geometry.blocks[0].position_radius[3][3] > 0.0);
    assert_eq!(geometry.origins.normals, Provenance::FromFaces);
    assert_eq!(loaded.warnings.count(&WarningKind::IsolatedVertices), 1);
}

#[test]
fn flipping_turns_faces_and_normals() {
    let elements =
        format!("element vertex 3\n{XYZ}\nelement face 1\nproperty list uchar int vertex_indices");
    let file =
        format!("ply\nformat ascii 1.0\n{elements}\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
    for (winding, triangle, normal) in [
        (Winding::AsInFile, [0, 1, 2], Vec3::Z),
        (Winding::Flipped, [0, 2, 1], Vec3::NEG_Z),
    ] {
        let loaded = load_bytes(
            file.as_bytes(),
            &LoadOptions {
                winding,
                ..LoadOptions::default()
            },
        )
        .expect("loaded");
        let geometry = &loaded.object.geometry;
        assert_eq!(geometry.triangles.as_deref(), Some([triangle].as_slice()));
        assert_eq!(geometry.blocks[0].normal_at(0), Some(normal));
    }
}

#[test]
fn points_at_one_place_load_with_a_warning() {
    let file = format!(
        "ply\nformat ascii 1.0\nelement vertex 3\n{XYZ}\nend_header\n{}",
        "7 8 9\n".repeat(3)
    );
    let loaded = load_bytes(file.as_bytes(), &LoadOptions::default()).expect("loaded");
    assert_eq!(world(&loaded, 2), DVec3::new(7.0, 8.0, 9.0));
    assert_eq!(loaded.warnings.count(&WarningKind::AllAtOnePlace), 3);
}

#[test]
fn a_list_among_the_scalars_of_vertices_is_passed_over() {
    let elements = "element vertex 2\nproperty float x\nproperty list uchar short marks\nproperty float y\nproperty uchar tag";
    let row = |x: f32, marks: &[i16], y: f32, tag: u8| {
        let marks_bytes: Vec<u8> = marks.iter().flat_map(|mark| mark.to_le_bytes()).collect();
        [
            x.to_le_bytes().as_slice(),
            &[marks.len() as u8],
            &marks_bytes,
            &y.to_le_bytes(),
            &[tag],
        ]
        .concat()
    };
    let body = [row(1.0, &[5, 6], 2.0, 3), row(4.0, &[], 5.0, 6)].concat();
    let from_text = text(elements, "1 2 5 6 2 3\n4 0 5 6\n").expect("text");
    let from_binary = binary(elements, &body).expect("binary");
    for loaded in [from_text, from_binary] {
        assert_eq!(world(&loaded, 1), DVec3::new(4.0, 5.0, 0.0));
        assert_eq!(loaded.object.geometry.blocks[0].named[0].bytes[..], [3, 6]);
        assert_eq!(
            loaded
                .warnings
                .count(&WarningKind::ListPropertySkipped("marks".into())),
            2
        );
        assert_eq!(loaded.warnings.count(&WarningKind::NoZ), 1);
    }
}
