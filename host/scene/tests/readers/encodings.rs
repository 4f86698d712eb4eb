//! Tables of random types, written in all three encodings: the loader must make the same of each.
//! And a second opinion: what the library ply-rs-bw reads from the small files of the shared test data folder.

use std::fmt::Write as _;
use std::path::PathBuf;

use crate::support::load_bytes;
use glam::DVec3;
use ply_rs_bw::parser::Parser;
use ply_rs_bw::ply::{DefaultElement, Property};
use pointstage_scene::{Estimation, Job, LoadOptions, Loaded, load};
use proptest::prelude::*;

const TYPES: [&str; 8] = [
    "char", "uint8", "short", "uint16", "int32", "uint", "float32", "double",
];

const FILE_ONLY: LoadOptions = LoadOptions {
    loader: None,
    estimation: Estimation::FileOnly,
    face_radius: pointstage_scene::FaceRadius::EnclosingCircle,
    winding: pointstage_scene::Winding::AsInFile,
};

#[derive(Clone, Copy, Debug, PartialEq)]
enum Encoding {
    Text,
    Little,
    Big,
}

/// A file of small whole numbers, which every type holds.
#[derive(Clone, Debug)]
struct MadeUp {
    /// Types of x, y, z and two more columns.
    types: [usize; 5],
    /// Order of the five.
    order: Vec<usize>,
    length_type: usize,
    index_type: usize,
    faces_first: bool,
    rows: Vec<[u8; 5]>,
    faces: Vec<Vec<u8>>,
}

impl MadeUp {
    fn write(&self, encoding: Encoding) -> Vec<u8> {
        let format = match encoding {
            Encoding::Text => "ascii",
            Encoding::Little => "binary_little_endian",
            Encoding::Big => "binary_big_endian",
        };
        let names = ["x", "y", "z", "extra", "more"];
        let mut vertex = format!("element vertex {}\n", self.rows.len());
        for column in &self.order {
            let _ = writeln!(
                vertex,
                "property {} {}",
                TYPES[self.types[*column]], names[*column]
            );
        }
        let face = format!(
            "element face {}\nproperty list {} {} vertex_indices\n",
            self.faces.len(),
            TYPES[self.length_type],
            TYPES[self.index_type]
        );
        let mut vertex_body = Vec::new();
        for row in &self.rows {
            for column in &self.order {
                put(
                    &mut vertex_body,
                    encoding,
                    self.types[*column],
                    row[*column],
                );
            }
            end_row(&mut vertex_body, encoding);
        }
        let mut face_body = Vec::new();
        for corners in &self.faces {
            put(
                &mut face_body,
                encoding,
                self.length_type,
                corners.len() as u8,
            );
            for corner in corners {
                put(&mut face_body, encoding, self.index_type, *corner);
            }
            end_row(&mut face_body, encoding);
        }
        let parts = if self.faces_first {
            [face, vertex]
        } else {
            [vertex, face]
        };
        let bodies = if self.faces_first {
            [face_body, vertex_body]
        } else {
            [vertex_body, face_body]
        };
        [
            format!(
                "ply\nformat {format} 1.0\n{}{}end_header\n",
                parts[0], parts[1]
            )
            .into_bytes(),
            bodies.concat(),
        ]
        .concat()
    }
}

fn put(out: &mut Vec<u8>, encoding: Encoding, scalar: usize, value: u8) {
    let mut bytes = match TYPES[scalar] {
        "char" | "uint8" => vec![value],
        "short" | "uint16" => u16::from(value).to_le_bytes().to_vec(),
        "int32" | "uint" => u32::from(value).to_le_bytes().to_vec(),
        "float32" => f32::from(value).to_le_bytes().to_vec(),
        _ => f64::from(value).to_le_bytes().to_vec(),
    };
    match encoding {
        Encoding::Text => bytes = format!("{value} ").into_bytes(),
        Encoding::Little => {}
        Encoding::Big => bytes.reverse(),
    }
    out.extend(bytes);
}

fn end_row(out: &mut Vec<u8>, encoding: Encoding) {
    if encoding == Encoding::Text {
        out.push(b'\n');
    }
}

fn made_up() -> impl Strategy<Value = MadeUp> {
    let types = proptest::array::uniform5(0..8usize);
    let order = Just(vec![0, 1, 2, 3, 4]).prop_shuffle();
    let rows = proptest::collection::vec(proptest::array::uniform5(0..100u8), 1..40);
    // Types of integers only, for lists.
    (types, order, 0..6usize, 0..6usize, any::<bool>(), rows).prop_flat_map(
        |(types, order, length_type, index_type, faces_first, rows)| {
            let corner = 0..rows.len() as u8 + 1;
            let length = prop_oneof![4 => Just(3usize), 1 => 0..6usize];
            let face = length
                .prop_flat_map(move |length| proptest::collection::vec(corner.clone(), length));
            proptest::collection::vec(face, 0..30).prop_map(move |faces| MadeUp {
                types,
                order: order.clone(),
                length_type,
                index_type,
                faces_first,
                rows: rows.clone(),
                faces,
            })
        },
    )
}

/// Positions in the world, triangles, named columns and warnings.
type Summary = (Vec<DVec3>, Vec<[u32; 3]>, Vec<(String, Vec<f64>)>, String);

/// Everything that must agree.
fn summary(loaded: &Loaded) -> Summary {
    let geometry = &loaded.object.geometry;
    let positions = (0..geometry.surfel_count)
        .filter_map(|s| Some(loaded.object.origin + geometry.centre(s)?))
        .collect();
    let triangles = geometry.triangles.as_deref().unwrap_or_default().to_vec();
    let values = |column: &pointstage_scene::NamedColumn| {
        let all = (0..geometry.surfel_count)
            .filter_map(|surfel| column.value(surfel, 0))
            .collect();
        (column.name.to_string(), all)
    };
    let named = geometry.blocks[0].named.iter().map(values).collect();
    (
        positions,
        triangles,
        named,
        format!("{:?}", loaded.warnings),
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn all_encodings_of_a_file_give_the_same_object(file in made_up()) {
        let [text, little, big] = [Encoding::Text, Encoding::Little, Encoding::Big]
            .map(|encoding| load_bytes(&file.write(encoding), &FILE_ONLY).map(|loaded| summary(&loaded)).map_err(|e| e.to_string()));
        let text = text.expect("the text is well formed");
        prop_assert_eq!(&text.0.len(), &file.rows.len());
        for (position, row) in text.0.iter().zip(&file.rows) {
            prop_assert_eq!(*position, DVec3::new(row[0].into(), row[1].into(), row[2].into()));
        }
        prop_assert_eq!(&text, &little.expect("little endian"));
        prop_assert_eq!(&text, &big.expect("big endian"));
    }
}

#[test]
fn a_second_reader_finds_the_same_positions_and_corners() {
    let folder = std::env::var_os("POINTSTAGE_TEST_DATA").map_or_else(
        || PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data")),
        PathBuf::from,
    );
    let Ok(entries) = std::fs::read_dir(folder.join("ply-odd")) else {
        println!(
            "skipped: the shared test data folder is not at {}",
            folder.display()
        );
        return;
    };
    let mut compared = 0;
    for path in entries.filter_map(|entry| Some(entry.ok()?.path())) {
        let small = std::fs::metadata(&path).is_ok_and(|metadata| metadata.len() < 200_000);
        let Ok(loaded) = load(&path, &FILE_ONLY, &Job::new()) else {
            continue;
        };
        if !small {
            continue;
        }
        let mut file = std::fs::File::open(&path).expect("readable");
        // It refuses some files that we read; the manifest test covers those.
        let Ok(other) = Parser::<DefaultElement>::new().read_ply(&mut file) else {
            continue;
        };
        let Some(vertices) = other.payload.get("vertex") else {
            continue;
        };
        let theirs: Vec<DVec3> = vertices
            .iter()
            .map(|vertex| DVec3::from(["x", "y", "z"].map(|name| number(vertex.get(name)))))
            .collect();
        let finite: Vec<DVec3> = theirs
            .into_iter()
            .filter(|position| position.is_finite())
            .collect();
        let (ours, triangles, ..) = summary(&loaded);
        assert_eq!(ours.len(), finite.len(), "{}", path.display());
        let size = loaded.object.geometry.bounds.size().max_element();
        for (mine, their) in ours.iter().zip(&finite) {
            // They round text to the declared type, we to a millionth of the box.
            let tolerance = 1e-6 * size + 6e-8 * their.abs().max_element();
            assert!(
                (*mine - *their).abs().max_element() <= tolerance,
                "{}: {mine}, they {their}",
                path.display()
            );
        }
        let faces: Vec<Vec<f64>> = other
            .payload
            .get("face")
            .into_iter()
            .flatten()
            .map(corners)
            .collect();
        if !faces.is_empty()
            && faces.iter().all(|face| face.len() == 3)
            && loaded.warnings.is_empty()
        {
            let ours: Vec<Vec<f64>> = triangles
                .iter()
                .map(|triangle| triangle.map(f64::from).to_vec())
                .collect();
            assert_eq!(ours, faces, "{}", path.display());
        }
        compared += 1;
    }
    assert!(compared > 25, "only {compared} files compared");
}

fn number(property: Option<&Property>) -> f64 {
    match property {
        Some(Property::Char(value)) => f64::from(*value),
        Some(Property::UChar(value)) => f64::from(*value),
        Some(Property::Short(value)) => f64::from(*value),
        Some(Property::UShort(value)) => f64::from(*value),
        Some(Property::Int(value)) => f64::from(*value),
        Some(Property::UInt(value)) => f64::from(*value),
        Some(Property::Float(value)) => f64::from(*value),
        Some(Property::Double(value)) => *value,
        _ => 0.0,
    }
}

fn corners(face: &DefaultElement) -> Vec<f64> {
    match face
        .get("vertex_indices")
        .or_else(|| face.get("vertex_index"))
    {
        Some(Property::ListInt(values)) => values.iter().map(|value| f64::from(*value)).collect(),
        Some(Property::ListUInt(values)) => values.iter().map(|value| f64::from(*value)).collect(),
        _ => Vec::new(),
    }
}
