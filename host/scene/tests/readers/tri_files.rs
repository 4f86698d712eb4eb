//! TRI files made up here, after the guess that `load/tri` describes: no file of the format's own program is known.

use std::io::Write as _;

use pointstage_scene::{
    Estimation, Job, LoadError, LoadOptions, Loaded, Provenance, Winding, load,
};

fn load_text(text: &str, options: &LoadOptions) -> Result<Loaded, LoadError> {
    let mut file = tempfile::Builder::new()
        .prefix("guessed")
        .suffix(".tri")
        .tempfile()
        .expect("a temporary file");
    file.write_all(text.as_bytes()).expect("written");
    load(file.path(), options, &Job::new())
}

fn file_only() -> LoadOptions {
    LoadOptions {
        estimation: Estimation::FileOnly,
        ..LoadOptions::default()
    }
}

fn read(text: &str) -> Loaded {
    load_text(text, &file_only()).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

fn message(text: &str) -> String {
    match load_text(text, &file_only()) {
        Ok(loaded) => panic!("loaded: {:?}\n{text}", loaded.warnings),
        Err(error) => error.to_string(),
    }
}

fn triangles(loaded: &Loaded) -> Vec<[u32; 3]> {
    loaded
        .object
        .geometry
        .triangles
        .as_ref()
        .map_or(Vec::new(), |triangles| triangles.to_vec())
}

fn normal(loaded: &Loaded, index: usize) -> glam::Vec3 {
    let block = &loaded.object.geometry.blocks[0];
    block.normal_at(index).expect("normals")
}

const SQUARE: &str = "TRI 1.0\n\
    [Vertices] 4\n0 0 0\n1 0 0\n1 1 0 # a corner\n0, 1, 0\n\n\
    [Triangles]\n2\n0 1 2\n0 2 3\n";

#[test]
fn a_mesh_in_sections_becomes_a_mesh() {
    let loaded = read(SQUARE);
    assert_eq!(loaded.loader.alias, "tri");
    assert_eq!(loaded.object.geometry.surfel_count, 4);
    assert_eq!(triangles(&loaded), [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(loaded.object.geometry.origins.normals, Provenance::Missing);
    let full = load_text(SQUARE, &LoadOptions::default()).expect("loads");
    assert_eq!(full.object.geometry.origins.normals, Provenance::FromFaces);
    assert_eq!(normal(&full, 0), glam::Vec3::Z);
    let flipped = LoadOptions {
        winding: Winding::Flipped,
        ..LoadOptions::default()
    };
    let full = load_text(SQUARE, &flipped).expect("loads");
    assert_eq!(normal(&full, 0), glam::Vec3::NEG_Z);
}

#[test]
fn spellings_do_not_matter() {
    for text in [
        SQUARE.replace('\n', "\r\n"),
        SQUARE.replace('\n', "\r"),
        SQUARE
            .replace("[Vertices] 4", "VERTICES:\n4")
            .replace("[Triangles]", "<triangles>"),
        SQUARE.replace("[Triangles]\n2", "Triangles = 2"),
        // Corners from 1, and rows that count themselves.
        SQUARE.replace("0 1 2\n0 2 3", "1 2 3\n1 3 4"),
        SQUARE.replace("0 1 2\n0 2 3", "1 0 1 2\n2 0 2 3"),
        SQUARE.replace("[Triangles]", "Colours\nred 1\ngreen 2\n[Triangles]"),
        SQUARE.replace("0 1 2\n0 2 3", "0 1 2 red\n0 2 3 blue"),
        "Triangles\n0 1 2\n0 2 3\nVertices\n0 0 0\n1 0 0\n1 1 0\n0 1 0".to_owned(),
    ] {
        let loaded = read(&text);
        assert_eq!(triangles(&loaded), [[0, 1, 2], [0, 2, 3]], "{text}");
        let block = &loaded.object.geometry.blocks[0];
        assert_eq!(block.centre(3), glam::Vec3::Y, "{text}");
    }
}

#[test]
fn normals_come_from_vertices_then_from_triangles() {
    let of_triangles = format!("{SQUARE}Triangles' Normals\n0 0 1\n0 1 0\n");
    let loaded = read(&of_triangles);
    assert_eq!(normal(&loaded, 1), glam::Vec3::Z);
    let mean = normal(&loaded, 0);
    assert!(
        mean.distance(glam::Vec3::new(0.0, 0.5, 0.5).normalize()) < 1e-4,
        "{mean}"
    );

    let both = format!("{of_triangles}Vertices’ Normals\n1 0 0\n0 2 0\n0 0 0\n0 0 -1\n");
    let loaded = read(&both);
    assert_eq!(normal(&loaded, 1), glam::Vec3::Y);
    let texts: Vec<String> = loaded.warnings.iter().map(ToString::to_string).collect();
    assert!(
        texts
            .iter()
            .any(|text| text.contains("1 surfel with NaN or zero")),
        "{texts:?}"
    );

    let short = format!("{SQUARE}Vertices' Normals\n1 0 0\n");
    let loaded = read(&short);
    assert_eq!(loaded.object.geometry.origins.normals, Provenance::Missing);
    let text = loaded
        .warnings
        .iter()
        .next()
        .expect("a warning")
        .to_string();
    assert!(text.contains("1 rows, not 4"), "{text}");
}

#[test]
fn damage_is_told_with_its_line() {
    for (text, parts) in [
        (
            SQUARE.replace("1 1 0 #", "1 1 #"),
            ["line 5", "has 2 numbers"],
        ),
        (
            SQUARE.replace("1 1 0 #", "1 x 0 #"),
            ["line 5", "found 'x'"],
        ),
        (
            SQUARE.replace("1 1 0 #", "nan 1 0 #"),
            ["line 5", "found 'nan'"],
        ),
        (
            SQUARE.replace("1 1 0 #", "1 1e30 0 #"),
            ["line 5", "found '1e30'"],
        ),
        (
            SQUARE.replace("1 1 0 #", "1.1.1 0 0 #"),
            ["line 5", "found '1.1.1'"],
        ),
        (SQUARE.replace("] 4", "] 5"), ["line 8", "expected 5 rows"]),
        (SQUARE.replace("] 4", "] 3"), ["line 6", "found 4"]),
        (
            SQUARE.replace("]\n2", "]\n3"),
            ["line 11", "expected 3 rows"],
        ),
        (SQUARE.replace("0 2 3", "0 2 5"), ["row 2", "found 5"]),
        (SQUARE.replace("0 2 3", "0 2 1.5"), ["row 2", "found 1.5"]),
        (SQUARE.replace("0 2 3", "0 2 -1"), ["row 2", "found -1"]),
        (
            format!("{SQUARE}Vertices\n0 0 0\n"),
            ["line 12", "second time"],
        ),
        (
            "Triangles\n0 1 2\n".to_owned(),
            ["line 2", "section 'Vertices'"],
        ),
        (
            "Vertices\n99999999999\n0 0 0\n".to_owned(),
            ["line 3", "expected 99999999999"],
        ),
    ] {
        let error = message(&text);
        assert!(
            parts.iter().all(|part| error.contains(part)),
            "{error}\n{text}"
        );
    }
}

#[test]
fn files_cut_anywhere_are_refused_or_warned_of() {
    let text = format!(
        "{}Triangles' Normals 2\n0 0 1\n0 1 0\n",
        SQUARE.replace("]\n2", "] 2")
    );
    for length in 0..text.len() {
        // A text that is cut between its sections is a whole file of fewer; one cut in a row is not.
        if let Ok(loaded) = load_text(&text[..length], &file_only()) {
            assert_eq!(loaded.object.geometry.surfel_count, 4, "{length}");
            let triangles = triangles(&loaded).len();
            assert!(triangles == 0 || triangles == 2, "{length}");
        }
    }
}

#[test]
fn other_files_of_the_suffix_are_not_taken_for_it() {
    let error = message("3\n0 0 0\n1 0 0\n0 1 0\n1\n0 1 2\n");
    assert!(error.contains("no loader knows"), "{error}");
}
