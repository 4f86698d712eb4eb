//! SFL files made up here: what a file can say, and what becomes of it.

use crate::sfl::{Set, be, file, floats, u32s};
use crate::support::load_bytes;
use glam::{DAffine3, DVec3, Vec3};
use pointstage_plugin_api::columns::TangentAxes;
use pointstage_plugin_api::settings_schema::{SettingValue, SettingValues};
use pointstage_scene::{
    Block, Estimation, LoadOptions, Loaded, LoaderChoice, Provenance, WarningKind,
};

const RGB: u32 = 0x0007_0000;

fn read(bytes: &[u8]) -> Loaded {
    let options = LoadOptions {
        estimation: Estimation::FileOnly,
        ..LoadOptions::default()
    };
    load_bytes(bytes, &options).unwrap_or_else(|error| panic!("{error}"))
}

fn message(bytes: &[u8]) -> String {
    match load_bytes(bytes, &LoadOptions::default()) {
        Ok(loaded) => panic!("loaded: {:?}", loaded.warnings),
        Err(error) => error.to_string(),
    }
}

fn block(loaded: &Loaded) -> &Block {
    &loaded.object.geometry.blocks[0]
}

fn named(loaded: &Loaded, name: &str) -> Vec<f64> {
    let column = block(loaded)
        .named
        .iter()
        .find(|column| *column.name == *name)
        .unwrap_or_else(|| panic!("no column {name}"));
    let values = 0..loaded.object.geometry.surfel_count;
    values
        .flat_map(|surfel| (0..column.components).map(move |component| (surfel, component)))
        .map(|(surfel, component)| column.value(surfel, component).unwrap())
        .collect()
}

/// Centre in the world, and radius.
fn disk(loaded: &Loaded, index: usize) -> [f64; 4] {
    let local = loaded.object.geometry.centre(index).expect("a surfel");
    let [x, y, z] = loaded
        .object
        .world_from_local()
        .transform_point3(local)
        .to_array();
    [x, y, z, f64::from(block(loaded).position_radius[index][3])]
}

fn texts(loaded: &Loaded) -> String {
    let lines: Vec<String> = loaded.warnings.iter().map(ToString::to_string).collect();
    lines.join("\n")
}

/// Positions and radii.
fn disks(positions: &[[f32; 4]]) -> Set {
    Set {
        mask: vec![0b1_0001],
        layout: vec![(0, 0), (4, 12)],
        record_bytes: 16,
        levels: vec![be(positions.as_flattened())],
        entries: Vec::new(),
    }
}

#[test]
fn records_lie_as_their_tables_say() {
    // Radius, an unknown property, position, diffuse colour, weight, flags, in 33 bytes.
    let mut record = be(&[0.5]);
    record.extend([9; 4]);
    record.extend(be(&[1.0, 2.0, 3.0]));
    record.extend([10, 20, 30, 0, 0]);
    record.extend(be(&[0.75]));
    record.extend(0x400_u32.to_be_bytes());
    let set = Set {
        mask: vec![1 | 1 << 4 | 1 << 5 | 1 << 10 | 1 << 27 | RGB, 1 << 8],
        layout: vec![(4, 0), (40, 4), (0, 8), (10, 20), (5, 25), (27, 29)],
        record_bytes: 33,
        levels: vec![record.repeat(3)],
        entries: Vec::new(),
    };
    let loaded = read(&file(&[], &[set]));
    assert_eq!(loaded.loader.alias, "sfl");
    assert_eq!(disk(&loaded, 2), [1.0, 2.0, 3.0, 0.5]);
    let colours = block(&loaded).colour.as_ref().unwrap();
    assert_eq!(colours[2].to_le_bytes(), [10, 20, 30, 255]);
    assert_eq!(named(&loaded, "weight"), [0.75; 3]);
    assert_eq!(named(&loaded, "flags"), [1024.0; 3]);
    assert!(
        texts(&loaded).contains("flagged as invisible"),
        "{}",
        texts(&loaded)
    );
    assert_eq!(loaded.object.geometry.origins.normals, Provenance::Missing);
}

#[test]
fn normals_are_unpacked() {
    for (form, code, size) in [
        (2, 0x0808_u32.to_be_bytes()[2..].to_vec(), 2),
        (3, 0x0800_0800_u32.to_be_bytes().to_vec(), 4),
        (0, be(&[-1.2, 0.0, 1.6]), 12),
    ] {
        let mut record = be(&[0.0; 3]);
        record.extend(&code);
        let set = Set {
            mask: vec![0b11 | form << 2],
            layout: vec![(0, 0), (1, 12)],
            record_bytes: 12 + size,
            levels: vec![record],
            entries: Vec::new(),
        };
        let loaded = read(&file(&[], &[set]));
        let normal = block(&loaded).normal_at(0).unwrap();
        assert!(
            normal.distance(Vec3::new(-0.6, 0.0, 0.8)) < 0.032,
            "{normal}"
        );
    }
}

#[test]
fn the_resolution_that_the_file_names_is_shown() {
    let level = |count: usize| be(&vec![[1.0, 0.0, 0.0, 1.0]; count].concat());
    let mut set = disks(&[]);
    set.levels = vec![level(5), level(2), level(1)];
    let loaded = read(&file(&[], &[set.clone()]));
    assert_eq!(loaded.object.geometry.surfel_count, 1, "the last one");
    assert!(
        texts(&loaded).contains("another one of its set is loaded (2 times)"),
        "{}",
        texts(&loaded)
    );
    set.entries = vec![u32s(0x141, &[0])];
    assert_eq!(
        read(&file(&[], &[set.clone()]))
            .object
            .geometry
            .surfel_count,
        5
    );
    for (choice, count) in [("finest", 5), ("coarsest", 1)] {
        let value = SettingValue::Choice(choice.to_owned());
        let options = LoadOptions {
            loader: Some(LoaderChoice {
                loader: "sfl".to_owned(),
                settings: SettingValues::from([("resolution".to_owned(), value)]),
            }),
            ..LoadOptions::default()
        };
        let bytes = file(&[], std::slice::from_ref(&set));
        let loaded = load_bytes(&bytes, &options).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(loaded.object.geometry.surfel_count, count, "{choice}");
    }
    set.entries = vec![u32s(0x141, &[3])];
    let error = message(&file(&[], &[set]));
    assert!(
        error.contains("one below the 3 resolutions, found 3"),
        "{error}"
    );
}

#[test]
fn axes_of_the_file_become_ours() {
    // z up, y to the back: x, z, −y. Half-axes along the file's x and z: the normal is −y, ours z.
    let root = [
        floats(0x110, &[1.0, 0.0, 0.0]),
        floats(0x111, &[0.0, 0.0, 1.0]),
        floats(0x112, &[0.0, -1.0, 0.0]),
    ];
    let set = Set {
        mask: vec![1 | 1 << 24],
        layout: vec![(0, 0), (24, 12)],
        record_bytes: 36,
        levels: vec![be(&[1.0, 2.0, 3.0, 0.5, 0.0, 0.0, 0.0, 0.0, 0.25])],
        entries: Vec::new(),
    };
    let loaded = read(&file(&root, std::slice::from_ref(&set)));
    assert_eq!(disk(&loaded, 0), [1.0, 3.0, -2.0, 0.5]);
    assert_eq!(block(&loaded).normal_at(0), Some(Vec3::Z));
    let axes = TangentAxes(block(&loaded).axes.as_ref().unwrap()[0]);
    assert_eq!((axes.u(), axes.v()), (Vec3::X * 0.5, Vec3::Y * 0.25));
    // A mirror turns one axis, so that the normal is mirrored and no more.
    let mirrored = read(&file(
        &[floats(0x112, &[0.0, 0.0, -1.0])],
        std::slice::from_ref(&set),
    ));
    assert_eq!(block(&mirrored).normal_at(0), Some(Vec3::NEG_Y));
    let flat = read(&file(&[floats(0x112, &[1.0, 1.0, 0.0])], &[set]));
    assert!(texts(&flat).contains("span no space"), "{}", texts(&flat));
    assert_eq!(disk(&flat, 0), [1.0, 2.0, 3.0, 0.5]);
}

#[test]
fn transforms_place_objects_and_sets() {
    let mut moved = disks(&[[1.0, 0.0, 0.0, 0.5], [2.0, 0.0, 0.0, 0.5]]);
    #[rustfmt::skip]
    let by_5_in_y = [1.0, 0.0, 0.0, 0.0,  0.0, 1.0, 0.0, 5.0,  0.0, 0.0, 1.0, 0.0,  0.0, 0.0, 0.0, 1.0];
    moved.entries = vec![floats(0x161, &by_5_in_y)];
    let loaded = read(&file(&[], &[moved.clone()]));
    assert_eq!(loaded.object.origin, DVec3::new(0.0, 5.0, 0.0));
    assert_eq!(loaded.object.world_from_object, DAffine3::IDENTITY);

    #[rustfmt::skip]
    let doubled_and_turned = [0.0, -2.0, 0.0, 0.0,  2.0, 0.0, 0.0, 0.0,  0.0, 0.0, 2.0, 7.0,  0.0, 0.0, 0.0, 1.0];
    let mut turned = moved.clone();
    turned.entries = vec![floats(0x161, &doubled_and_turned)];
    let loaded = read(&file(&[], &[turned.clone()]));
    assert_eq!(block(&loaded).position_radius[0], [1.0, 0.0, 0.0, 0.5]);
    let world = loaded.object.world_from_local();
    assert_eq!(world.transform_point3(DVec3::X), DVec3::new(0.0, 2.0, 7.0));

    let loaded = read(&file(&[], &[moved.clone(), disks(&[]), turned]));
    assert_eq!(
        *block(&loaded).position_radius,
        [
            [1.0, 5.0, 0.0, 0.5],
            [2.0, 5.0, 0.0, 0.5],
            [0.0, 2.0, 7.0, 1.0],
            [0.0, 4.0, 7.0, 1.0]
        ]
    );
    assert_eq!(named(&loaded, "surfel_set"), [0.0, 0.0, 2.0, 2.0]);

    moved.entries = vec![floats(0x161, &[0.0; 16])];
    let loaded = read(&file(&[], &[moved]));
    assert!(
        texts(&loaded).contains("cannot be inverted"),
        "{}",
        texts(&loaded)
    );
}

#[test]
fn sets_with_other_properties_get_defaults() {
    let mut record = be(&[0.0, 1.0, 0.0]);
    record.extend([1, 2, 3]);
    record.extend(be(&[0.5]));
    let coloured = Set {
        mask: vec![1 | 1 << 5 | 1 << 10 | RGB],
        layout: vec![(0, 0), (10, 12), (5, 15)],
        record_bytes: 19,
        levels: vec![record],
        entries: Vec::new(),
    };
    let loaded = read(&file(&[], &[disks(&[[1.0, 0.0, 0.0, 0.25]]), coloured]));
    let colours = block(&loaded).colour.as_ref().unwrap();
    assert_eq!(**colours, [u32::MAX, u32::from_le_bytes([1, 2, 3, 255])]);
    assert_eq!(named(&loaded, "weight"), [1.0, 0.5]);
    let radii: Vec<f32> = block(&loaded)
        .position_radius
        .iter()
        .map(|surfel| surfel[3])
        .collect();
    assert_eq!(radii, [0.25, 0.0]);
}

#[test]
fn what_is_not_stored_follows_from_what_is() {
    let density = Set {
        mask: vec![1 | 1 << 6],
        layout: vec![(0, 0), (6, 12)],
        record_bytes: 24,
        levels: vec![be(&[0.0, 0.0, 0.0, 0.0, 0.0, 4.0])],
        entries: Vec::new(),
    };
    let loaded = read(&file(&[], &[density]));
    assert!((block(&loaded).position_radius[0][3] - 0.338_513_76).abs() < 1e-7);
    // Version 0 has neither normal nor radius beside axes, whatever its tables say.
    let mut old = Set {
        mask: vec![0b1_0011 | 1 << 24],
        layout: vec![(0, 0), (1, 0), (4, 0), (24, 12)],
        record_bytes: 36,
        levels: vec![be(&[9.0, 8.0, 7.0, 0.0, 3.0, 0.0, 0.0, 0.0, 2.0])],
        entries: vec![u32s(0x150, &[0])],
    };
    let loaded = read(&file(&[], std::slice::from_ref(&old)));
    assert_eq!(disk(&loaded, 0), [9.0, 8.0, 7.0, 3.0]);
    assert_eq!(block(&loaded).normal_at(0), Some(Vec3::X));
    old.entries = vec![u32s(0x150, &[1])];
    let loaded = read(&file(&[], &[old]));
    assert_eq!(block(&loaded).position_radius[0][3], 9.0);
}

#[test]
fn surfels_that_cannot_be_used_are_dropped_or_repaired() {
    let set = disks(&[
        [f32::NAN, 0.0, 0.0, 1.0],
        [1.0, 0.0, 0.0, -1.0],
        [2.0, 0.0, 0.0, 1.0],
        [3.0, f32::INFINITY, 0.0, 1.0],
    ]);
    let loaded = read(&file(&[], &[set]));
    assert_eq!(
        *block(&loaded).position_radius,
        [[1.0, 0.0, 0.0, 0.0], [2.0, 0.0, 0.0, 1.0]]
    );
    let count = |kind| loaded.warnings.count(&kind);
    assert_eq!(count(WarningKind::NonFinitePositionsDropped), 2);
    assert_eq!(count(WarningKind::UnusableRadiiReplaced), 1);
    let nothing = message(&file(&[], &[disks(&[[f32::NAN; 4]])]));
    assert!(nothing.contains("all 1 surfels"), "{nothing}");
}

#[test]
fn files_without_surfels_open_with_a_warning() {
    for sets in [vec![], vec![disks(&[])]] {
        let loaded = read(&file(&[], &sets));
        assert_eq!(loaded.object.geometry.surfel_count, 0);
        assert!(texts(&loaded).contains("no surfels"), "{}", texts(&loaded));
    }
}

#[test]
fn damage_is_told_with_its_place() {
    let good = disks(&[[1.0, 0.0, 0.0, 1.0]]);
    let with = |change: fn(&mut Set)| {
        let mut set = good.clone();
        change(&mut set);
        message(&file(&[], &[set]))
    };
    for (error, part) in [
        (
            with(|set| set.record_bytes = 15),
            "within the record of 15 bytes",
        ),
        (with(|set| set.mask = vec![0b1_0000]), "'position'"),
        (with(|set| set.mask = vec![]), "property mask (0x0152)"),
        (
            with(|set| set.entries = vec![u32s(0x150, &[1 << 16])]),
            "major number of 0",
        ),
        (
            with(|set| {
                set.mask = vec![0b1_0111];
                set.layout.push((1, 0));
            }),
            "8 bits",
        ),
        (
            with(|set| {
                set.mask = vec![1 << 10 | 0b1_0001 | 3 << 16];
                set.layout.push((10, 0));
            }),
            "0x00030000",
        ),
    ] {
        assert!(error.contains(part), "{error}, expected '{part}'");
    }
}

#[test]
fn sets_that_share_their_records_are_refused() {
    let large = disks(&[[1.0, 0.0, 0.0, 1.0]; 100]);
    let small = disks(&[[1.0, 0.0, 0.0, 1.0]]);
    let mut bytes = file(&[], &[large, small.clone(), small]);
    // Number of surfels and block of each resolution; the last set's come first.
    let starts: Vec<usize> = (0..bytes.len() - 24)
        .filter(|at| {
            let is_tag = |at: usize, tag: u8| bytes[at..at + 2] == [1, tag];
            at % 4 == 0 && is_tag(*at, 0x70) && is_tag(at + 12, 0x71)
        })
        .collect();
    let [first, second, of_large] = starts[..] else {
        panic!("{starts:?}");
    };
    for start in [first, second] {
        bytes.copy_within(of_large..of_large + 24, start);
    }
    let error = message(&bytes);
    assert!(error.contains("overlap"), "{error}");
}
