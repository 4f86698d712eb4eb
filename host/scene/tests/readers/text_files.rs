//! Bodies of text: where rows and words end, over the borders of the pieces that threads share too.

use std::fmt::Write as _;

use crate::support::load_bytes;
use crate::texts::{FILE_ONLY, XYZ, text, world};
use glam::DVec3;

#[test]
fn words_that_are_no_numbers_are_placed() {
    let error =
        text(&format!("element vertex 2\n{XYZ}"), "1 2 3\n\n4 five 6\n").expect_err("refused");
    assert!(
        error.contains("line 10")
            && error.contains("row 2")
            && error.contains("'y'")
            && error.contains("five"),
        "{error}"
    );
    let error = text(&format!("element vertex 1\n{XYZ}"), "1 2\n").expect_err("refused");
    assert!(error.contains("ends before 'z'"), "{error}");
}

#[test]
fn rows_end_at_line_ends_of_every_kind_and_at_the_end_of_the_file() {
    for line_end in ["\n", "\r\n", " \n", "\t\r\n", "\n\n", "\n  \n"] {
        for last in [line_end, "", " "] {
            let header_end = if line_end.contains('\r') {
                "\r\n"
            } else {
                "\n"
            };
            let elements = format!(
                "element vertex 3\n{XYZ}\nelement face 1\nproperty list uchar int vertex_indices"
            );
            let header = format!("ply\nformat ascii 1.0\n{elements}\nend_header\n")
                .replace('\n', header_end);
            let body = ["0 0 0", " 1 0 0 spare", "0\t1 0", "3 0 1 2"].join(line_end);
            let file = format!("{header}{body}{last}");
            let loaded = load_bytes(file.as_bytes(), &FILE_ONLY)
                .unwrap_or_else(|error| panic!("{line_end:?} {last:?}: {error}"));
            let geometry = &loaded.object.geometry;
            assert_eq!(
                geometry.triangles.as_deref(),
                Some([[0, 1, 2]].as_slice()),
                "{line_end:?} {last:?}"
            );
            assert_eq!(world(&loaded, 1), DVec3::X, "{line_end:?} {last:?}");
            assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
        }
    }
}

#[test]
fn a_text_of_many_pieces_is_read_like_one() {
    // 40,000 rows of about 40 bytes are several of the pieces that threads share; numbers of many widths move their borders.
    let count = 40_000_u32;
    let value = |index: u32| f64::from(index) * 1.25e-3;
    let mut body = String::new();
    for index in 0..count {
        let spaces = " ".repeat(index as usize % 7);
        let _ = writeln!(
            body,
            "{spaces}{} {index} {:e} -0.5",
            value(index),
            value(index)
        );
        if index % 1000 == 17 {
            body.push_str(" \n\n");
        }
    }
    for index in 0..count - 2 {
        let _ = writeln!(body, "3 {} {} {}", index, index + 1, index + 2);
    }
    let elements = format!(
        "element vertex {count}\n{XYZ}\nproperty float w\nelement face {}\nproperty list uchar int vertex_indices",
        count - 2
    );
    let loaded = text(&elements, &body).expect("loaded");
    let geometry = &loaded.object.geometry;
    for index in (0..count).step_by(37) {
        let expected = DVec3::new(value(index), f64::from(index), value(index));
        let found = world(&loaded, index as usize);
        assert!(
            (found - expected).abs().max_element() <= 1e-7 * f64::from(count),
            "row {index}: {found}, expected {expected}"
        );
    }
    let triangles = geometry.triangles.as_deref().expect("triangles");
    assert!(
        (0..count - 2)
            .zip(triangles)
            .all(|(index, triangle)| *triangle == [index, index + 1, index + 2])
    );
    // The line of an error in a late piece counts all lines before, blank ones too.
    let broken = body.replace(&format!("3 {} ", count - 3), "3 many ");
    let error = text(&elements, &broken).expect_err("refused");
    let line = 10 + broken.lines().count();
    assert!(
        error.contains(&format!("line {line}")) && error.contains("many"),
        "{error}"
    );
    // And one more corner in the last row makes the faces a list.
    let fan = format!(
        "{}4 0 1 2 3\n",
        &body[..=body.trim_end().rfind('\n').expect("lines")]
    );
    let loaded = text(&elements, &fan).expect("loaded");
    assert_eq!(loaded.object.geometry.triangle_count(), count as usize - 1);
}
