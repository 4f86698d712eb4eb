//! LAS of all kinds and E57 with all that it can hold, written by the libraries that know them best.

use std::path::Path;

use anyhow::{Context as _, Result};
use e57::{
    E57Writer, Extension, Quaternion, Record, RecordDataType, RecordName, RecordValue, Transform,
    Translation,
};
use glam::Vec3;
use las::point::{Classification, Format};
use las::raw::point::Waveform;
use las::{Builder, Color, Point, Vlr, Writer};
use laz::las::Point0;
use laz::record::{RecordCompressor, SequentialPointRecordCompressor};
use laz::{LazItemRecordBuilder, LazVlr};
use pointstage_plugin_api::columns::NO_NORMAL;
use pointstage_scene::{Loaded, ScalarType};
use pointstage_tests::loaders::{first_party, load_as_it_is};

use crate::meshes::{colours, lines};
use crate::points::{at, value};

/// Points of the files here: some pieces of the compressed ones.
const POINTS: u32 = 1000;

/// A description of extra bytes, as LAS 1.4 has it.
fn description(number: u8, name: &str, measure: Option<[f64; 2]>) -> Vec<u8> {
    let mut record = vec![0; 192];
    record[2] = number;
    record[4..4 + name.len()].copy_from_slice(name.as_bytes());
    if let Some([scale, offset]) = measure {
        record[3] = 8 | 16;
        record[112..120].copy_from_slice(&scale.to_le_bytes());
        record[136..144].copy_from_slice(&offset.to_le_bytes());
    }
    record
}

/// A file of one point format, with four extra bytes a point of which two values of two bytes are described.
fn write_las(path: &Path, format: u8, version: (u8, u8), is_compressed: bool) -> Result<()> {
    let mut builder = Builder::from(version);
    let mut point_format = Format::new(format)?;
    point_format.is_compressed = is_compressed;
    point_format.extra_bytes = 5;
    builder.point_format = point_format;
    builder.has_wkt_crs = format > 5;
    let data = [
        description(3, "amplitude", None),
        description(4, "height", Some([0.5, 100.0])),
        description(1, "intensity", None),
    ];
    builder.vlrs.push(Vlr {
        user_id: "LASF_Spec".to_owned(),
        record_id: 4,
        description: String::new(),
        data: data.concat(),
    });
    let mut writer = Writer::from_path(path, builder.into_header()?)?;
    for index in 0..POINTS {
        let small = (index % 200) as u8;
        writer.write_point(Point {
            x: f64::from(index) * 0.25,
            y: -f64::from(index),
            z: 7.0,
            intensity: index as u16 * 3,
            return_number: 2,
            number_of_returns: 3,
            classification: Classification::new(5)?,
            scan_angle: -12.0,
            user_data: small,
            point_source_id: index as u16 + 1,
            gps_time: point_format.has_gps_time.then(|| f64::from(index) * 0.125),
            color: point_format
                .has_color
                .then(|| Color::new(65535, index as u16, 0)),
            nir: point_format.has_nir.then_some(index as u16 + 7),
            waveform: point_format.has_waveform.then(Waveform::default),
            extra_bytes: [
                &(index as u16).to_le_bytes()[..],
                &(-(index as i16)).to_le_bytes(),
                &[small],
            ]
            .concat(),
            ..Point::default()
        })?;
    }
    writer.close()?;
    Ok(())
}

#[test]
fn las_of_every_point_format_has_its_columns_compressed_or_not() -> Result<()> {
    let folder = tempfile::tempdir()?;
    let loaders = first_party()?;
    for format in 0..=10_u8 {
        let version = match format {
            0 | 1 => (1, 0),
            2 | 3 => (1, 2),
            4 | 5 => (1, 3),
            _ => (1, 4),
        };
        for is_compressed in [false, true] {
            let what = format!("format {format}, compressed: {is_compressed}");
            let path = folder.path().join(format!("{format}{is_compressed}.las"));
            write_las(&path, format, version, is_compressed).with_context(|| what.clone())?;
            let loaded = load_as_it_is(&loaders, &path).with_context(|| what.clone())?;
            assert_eq!(loaded.loader.alias, "las");
            assert_eq!(
                loaded.object.geometry.surfel_count, POINTS as usize,
                "{what}"
            );
            check_las(&loaded, Format::new(format)?, &what);
        }
    }
    Ok(())
}

#[test]
fn a_whole_number_that_no_double_holds_is_a_warning() -> Result<()> {
    let folder = tempfile::tempdir()?;
    let loaders = first_party()?;
    for is_compressed in [false, true] {
        let path = folder.path().join("numbers.las");
        let mut builder = Builder::from((1, 4));
        let mut format = Format::new(6)?;
        format.is_compressed = is_compressed;
        format.extra_bytes = 16;
        builder.point_format = format;
        builder.vlrs.push(Vlr {
            user_id: "LASF_Spec".to_owned(),
            record_id: 4,
            description: String::new(),
            data: [description(7, "id", None), description(8, "count", None)].concat(),
        });
        let mut writer = Writer::from_path(&path, builder.into_header()?)?;
        for id in [1_u64 << 53, (1 << 53) + 1, u64::MAX] {
            let extra_bytes = [id.to_le_bytes(), (-5_i64).to_le_bytes()].concat();
            writer.write_point(Point {
                extra_bytes,
                return_number: 1,
                number_of_returns: 1,
                gps_time: Some(0.0),
                ..Point::default()
            })?;
        }
        writer.close()?;
        let loaded = load_as_it_is(&loaders, &path)?;
        let said = lines(&loaded.warnings);
        let expected =
            "a 64-bit whole number of column 'id' is rounded to the nearest of 53 bits (2 times)";
        assert_eq!(said, expected, "compressed: {is_compressed}");
        assert_eq!(value(&loaded, "id", 1, 0), Some(9_007_199_254_740_992.0));
        assert_eq!(value(&loaded, "count", 2, 0), Some(-5.0));
    }
    Ok(())
}

/// Colours by the number of a point.
type ColourOf = fn(u32) -> u16;

/// What a file's colours are is known from all of them only, and by then most have been handed over.
#[test]
fn colours_of_compressed_points_are_those_of_plain_ones_however_late_they_are_known() -> Result<()>
{
    /// Three chunks, the last of which is short.
    const COUNT: u32 = 110_000;
    let folder = tempfile::tempdir()?;
    let loaders = first_party()?;
    let cases: [(&str, ColourOf, Option<[u8; 3]>); 6] = [
        ("black", |_| 0, None),
        ("bytes", |_| 200, Some([200, 0, 0])),
        (
            "black, then bytes",
            |index| u16::from(index > 60_000) * 200,
            Some([200, 0, 0]),
        ),
        (
            "black, then words",
            |index| u16::from(index > 60_000) * 51_400,
            Some([200, 0, 0]),
        ),
        (
            "dark words, then light ones",
            |index| if index > 60_000 { 51_400 } else { 200 },
            Some([200, 0, 0]),
        ),
        (
            "black, then dark words, then light ones",
            |index| [0, 200, 51_400][index as usize / 50_000],
            Some([200, 0, 0]),
        ),
    ];
    for (what, colour, last) in cases {
        let mut both = Vec::new();
        for is_compressed in [false, true] {
            let path = folder.path().join("colours.las");
            let mut builder = Builder::from((1, 2));
            builder.point_format = Format::new(2)?;
            builder.point_format.is_compressed = is_compressed;
            let mut writer = Writer::from_path(&path, builder.into_header()?)?;
            for index in 0..COUNT {
                writer.write_point(Point {
                    x: f64::from(index),
                    color: Some(Color::new(colour(index), 0, 0)),
                    ..Point::default()
                })?;
            }
            writer.close()?;
            let loaded = load_as_it_is(&loaders, &path)?;
            assert_eq!(
                loaded.object.geometry.surfel_count, COUNT as usize,
                "{what}"
            );
            assert_eq!(
                at(&loaded, COUNT as usize - 1),
                [f64::from(COUNT) - 1.0, 0.0, 0.0],
                "{what}"
            );
            let colours = colours(&loaded);
            assert_eq!(colours.last().copied(), last, "{what}");
            both.push((colours, lines(&loaded.warnings)));
        }
        assert!(
            both[0] == both[1],
            "{what}: {} and {}",
            both[0].1,
            both[1].1
        );
        assert_eq!(
            last.is_none(),
            both[0].1.contains("black"),
            "{what}: {}",
            both[0].1
        );
    }
    Ok(())
}

/// As LASzip's first version made files: without chunks.
#[test]
fn points_in_one_piece_are_those_of_the_plain_file() -> Result<()> {
    let folder = tempfile::tempdir()?;
    let loaders = first_party()?;
    let path = folder.path().join("plain.las");
    let mut builder = Builder::from((1, 2));
    builder.point_format = Format::new(0)?;
    let mut writer = Writer::from_path(&path, builder.into_header()?)?;
    for index in 0..POINTS {
        writer.write_point(Point {
            x: f64::from(index) * 0.25,
            y: -f64::from(index),
            intensity: index as u16 * 3,
            ..Point::default()
        })?;
    }
    writer.close()?;
    let plain = std::fs::read(&path)?;
    let (header, records) = plain.split_at(plain.len() - POINTS as usize * 20);

    // What LASzip says of itself: the point's ten fields, version 1, without chunks.
    let mut description = vec![0; 54];
    description[2..16].copy_from_slice(b"laszip encoded");
    description[18..20].copy_from_slice(&22204_u16.to_le_bytes());
    description[20..22].copy_from_slice(&40_u16.to_le_bytes());
    let chunked = LazVlr::from_laz_items(LazItemRecordBuilder::version_1_of::<Point0>(0));
    chunked.write_to(&mut description)?;
    description[54..56].copy_from_slice(&1_u16.to_le_bytes());

    let mut packed = header.to_vec();
    packed[96..100].copy_from_slice(&((header.len() + description.len()) as u32).to_le_bytes());
    packed[100] += 1;
    packed[104] |= 128;
    packed.extend(description);
    let mut compressor = SequentialPointRecordCompressor::new(&mut packed);
    compressor.set_fields_from(chunked.items())?;
    compressor.compress_many(records)?;
    compressor.done()?;
    drop(compressor);
    assert!(packed.len() < plain.len() / 2);
    let compressed = folder.path().join("compressed.laz");
    std::fs::write(&compressed, packed)?;

    let [plain, compressed] = [path, compressed].map(|path| load_as_it_is(&loaders, &path));
    let (plain, compressed) = (plain?, compressed?);
    for point in 0..POINTS as usize {
        assert_eq!(at(&compressed, point), at(&plain, point));
        let intensity = |loaded| value(loaded, "intensity", point, 0);
        assert_eq!(intensity(&compressed), intensity(&plain));
    }
    assert_eq!(at(&compressed, 777), [194.25, -777.0, 0.0]);
    Ok(())
}

fn check_las(loaded: &Loaded, format: Format, what: &str) {
    const POINT: usize = 777;
    let index = POINT as f64;
    assert_eq!(at(loaded, POINT), [index * 0.25, -index, 7.0], "{what}");
    let of = |name: &str| value(loaded, name, POINT, 0);
    for (name, expected) in [
        ("intensity", index * 3.0),
        ("classification", 5.0),
        ("return_number", 2.0),
        ("number_of_returns", 3.0),
        ("point_source_id", index + 1.0),
        ("user_data", 177.0),
        ("amplitude", index),
        ("height", 100.0 - 0.5 * index),
        ("extra_intensity", 177.0),
    ] {
        assert_eq!(of(name), Some(expected), "{what}: {name}");
    }
    // Steps of 0.006 degrees in the later formats.
    let angle = of("scan_angle").unwrap_or(f64::NAN);
    assert!((angle + 12.0).abs() < 0.004, "{what}: {angle}");
    let time = format.has_gps_time.then_some(index * 0.125);
    assert_eq!(of("gps_time"), time, "{what}");
    let infrared = format.has_nir.then_some(index + 7.0);
    assert_eq!(of("near_infrared"), infrared, "{what}");
    if format.has_color {
        assert_eq!(colours(loaded)[POINT], [255, 3, 0], "{what}");
    }
    let named = &loaded.object.geometry.blocks[0].named;
    let height = named.iter().find(|column| &*column.name == "height");
    assert_eq!(
        height.map(|column| column.scalar),
        Some(ScalarType::F64),
        "{what}"
    );
    assert!(
        loaded.warnings.is_empty(),
        "{what}: {}",
        lines(&loaded.warnings)
    );
}

fn normal_record(name: &str) -> Record {
    Record {
        name: RecordName::Unknown {
            namespace: "nor".to_owned(),
            name: name.to_owned(),
        },
        data_type: RecordDataType::F32,
    }
}

/// Two scans: one turned a quarter round z and moved, with normals, intensities and a point that is marked invalid; one
/// with colours.
fn write_e57(path: &Path) -> Result<()> {
    let mut writer = E57Writer::from_file(path, "file")?;
    writer.register_extension(Extension::new(
        "nor",
        "http://www.libe57.org/E57_NOR_surface_normals.txt",
    ))?;
    let place = [
        Record::CARTESIAN_X_F64,
        Record::CARTESIAN_Y_F64,
        Record::CARTESIAN_Z_F64,
    ];
    let mut prototype = place.to_vec();
    prototype.push(Record::CARTESIAN_INVALID_STATE);
    prototype.push(Record {
        name: RecordName::Intensity,
        data_type: RecordDataType::UNIT_F32,
    });
    prototype.extend(["normalX", "normalY", "normalZ"].map(normal_record));
    let mut scan = writer.add_pointcloud("first", prototype)?;
    let half = std::f64::consts::FRAC_1_SQRT_2;
    scan.set_transform(Some(Transform {
        rotation: Quaternion {
            w: half,
            x: 0.0,
            y: 0.0,
            z: half,
        },
        translation: Translation {
            x: 100.0,
            y: 0.0,
            z: 0.0,
        },
    }));
    for (x, state) in [(1.0, 0), (2.0, 2), (3.0, 0)] {
        let mut values = [x, 0.0, 5.0].map(RecordValue::Double).to_vec();
        values.push(RecordValue::Integer(state));
        values.push(RecordValue::Single(x as f32 / 4.0));
        values.extend([1.0, 0.0, 0.0].map(RecordValue::Single));
        scan.add_point(values)?;
    }
    scan.finalize()?;
    let mut prototype = place.to_vec();
    prototype.extend([
        Record::COLOR_RED_U8,
        Record::COLOR_GREEN_U8,
        Record::COLOR_BLUE_U8,
    ]);
    let mut scan = writer.add_pointcloud("second", prototype)?;
    let mut values = [7.0, 8.0, 9.0].map(RecordValue::Double).to_vec();
    values.extend([200, 100, 0].map(RecordValue::Integer));
    scan.add_point(values)?;
    scan.finalize()?;
    writer.finalize()?;
    Ok(())
}

#[test]
fn e57_puts_scans_where_their_poses_do_with_normals_turned_and_invalid_points_left_out()
-> Result<()> {
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("a.e57");
    write_e57(&path)?;
    let loaded = load_as_it_is(&first_party()?, &path)?;
    let geometry = &loaded.object.geometry;
    assert_eq!(geometry.surfel_count, 3);
    for (point, expected) in [[100.0, 1.0, 5.0], [100.0, 3.0, 5.0], [7.0, 8.0, 9.0]]
        .iter()
        .enumerate()
    {
        let found = at(&loaded, point);
        let off = glam::DVec3::from(found).distance(glam::DVec3::from(*expected));
        assert!(off < 1e-5, "{found:?}, expected {expected:?}");
    }
    let normal = |point| geometry.blocks[0].normal_at(point);
    assert!(
        normal(1).is_some_and(|normal| normal.distance(Vec3::Y) < 1e-3),
        "{:?}",
        normal(1)
    );
    let packed = geometry.blocks[0].normal.as_ref().map(|normals| normals[2]);
    assert_eq!(packed, Some(NO_NORMAL), "the second scan has none");
    assert_eq!(value(&loaded, "intensity", 1, 0), Some(0.75));
    assert!(value(&loaded, "intensity", 2, 0).is_some_and(f64::is_nan));
    assert_eq!(
        (value(&loaded, "scan", 1, 0), value(&loaded, "scan", 2, 0)),
        (Some(0.0), Some(1.0))
    );
    assert_eq!(colours(&loaded), [[255; 3], [255; 3], [200, 100, 0]]);
    let said = lines(&loaded.warnings);
    assert!(
        said.contains("a point of which the file gives no place"),
        "{said}"
    );
    Ok(())
}
