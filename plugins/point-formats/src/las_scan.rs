//! LAS, its compressed form LAZ, and COPC, which is a LAZ file with an index that is not needed to read all of it.

use std::fs::File;
use std::io::BufReader;

use las::{PointData, Reader};
use pointstage_plugin_api::abi::ScalarType;
use pointstage_plugin_api::loading::{
    Claim, Column, FileStart, Loader, Output, SourceFile, bytes_of,
};
use pointstage_plugin_api::{Error, Host, Progress, Result, Settings};

use crate::las_extra::{Extra, described};

/// Names of columns.
const INTENSITY: &str = "intensity";
const CLASSIFICATION: &str = "classification";
const RETURN_NUMBER: &str = "return_number";
const NUMBER_OF_RETURNS: &str = "number_of_returns";
const POINT_SOURCE_ID: &str = "point_source_id";
const USER_DATA: &str = "user_data";
const SCAN_ANGLE: &str = "scan_angle";
const GPS_TIME: &str = "gps_time";
const NEAR_INFRARED: &str = "near_infrared";
const NAMES: [&str; 9] = [
    INTENSITY,
    CLASSIFICATION,
    RETURN_NUMBER,
    NUMBER_OF_RETURNS,
    POINT_SOURCE_ID,
    USER_DATA,
    SCAN_ANGLE,
    GPS_TIME,
    NEAR_INFRARED,
];

/// Points decompressed at once: several chunks of a usual file, so that all cores have work, in some 100 ms on one core.
const POINTS_A_PIECE: u64 = 200_000;

/// Bytes of points decompressed at once: a header may claim 64 KB a point, and the memory is taken before the first is read.
const BYTES_A_PIECE: u64 = 1 << 24;

/// Bytes read from the file at once.
const READ_AHEAD: usize = 1 << 20;

/// The loader of LAS and LAZ files.
pub struct LasLoader;

impl Loader for LasLoader {
    fn claims(start: &FileStart<'_>) -> Claim {
        if start.bytes.starts_with(b"LASF") {
            Claim::Certain
        } else {
            Claim::No
        }
    }

    fn load(
        _host: &Host,
        file: &SourceFile<'_>,
        _settings: Settings<'_>,
        out: &mut Output<'_>,
        progress: &Progress<'_>,
    ) -> Result<()> {
        progress.set(0.0, "reading points");
        check_size(file.bytes)?;
        // The library keeps what it reads from for as long as it likes, which borrowed bytes do not allow.
        let opened = File::open(file.path)
            .map_err(|error| Error::failed(format!("cannot be read any more: {error}")))?;
        let mut reader =
            Reader::new(BufReader::with_capacity(READ_AHEAD, opened)).map_err(|error| {
                Error::failed(format!(
                    "the header cannot be read: {error}; the file is damaged, copy it again"
                ))
            })?;
        let header = reader.header();
        let (expected, format) = (header.number_of_points(), *header.point_format());
        if expected == 0 {
            return Err(Error::failed(
                "the file has 0 points; there is nothing to show",
            ));
        }
        let point_bytes = u64::from(format.len()).max(1);
        let piece_points = POINTS_A_PIECE.min((BYTES_A_PIECE / point_bytes).max(1));
        let mut pieces: Vec<PointData> = Vec::new();
        let mut read = 0;
        let mut largest_colour = 0;
        while read < expected {
            progress.check()?;
            progress.set(
                (0.8 * read as f64 / expected as f64) as f32,
                "reading points",
            );
            let piece = reader.read_points(piece_points).map_err(|error| {
                Error::failed(format!(
                    "expected {expected} points, but behind point {read} comes what cannot be read: {error}; the file is damaged or truncated, copy it again"
                ))
            })?;
            if piece.is_empty() {
                return Err(Error::failed(format!(
                    "expected {expected} points, found {read}; the file is truncated, copy it again"
                )));
            }
            read += piece.len() as u64;
            let colours = piece.rgb().into_iter().flatten();
            largest_colour = colours.fold(largest_colour, |most, (red, green, blue)| {
                most.max(red).max(green).max(blue)
            });
            pieces.push(piece);
        }
        let mut names: Vec<String> = NAMES.map(str::to_owned).to_vec();
        let (mut extras, undescribed) = described(reader.header());
        // Two columns cannot have one name.
        for extra in &mut extras {
            while names.contains(&extra.name) {
                extra.name.insert_str(0, "extra_");
            }
            names.push(extra.name.clone());
        }
        let plan = Plan {
            colours: match largest_colour {
                0 => Colours::None,
                // Some programs keep bytes where 16 bits are due.
                1..=255 => Colours::Bytes,
                _ => Colours::Words,
            },
            has_time: format.has_gps_time,
            has_infrared: format.has_nir,
            extras,
        };
        if format.has_color && largest_colour == 0 {
            out.warn(
                "the file has colours, but all are black: they are left out",
                1,
            );
        }
        if undescribed > 0 {
            out.warn(
                &format!("{undescribed} extra bytes a point, which the file does not describe, are left out"),
                1,
            );
        }
        plan.declare(out, expected)?;
        for (index, piece) in pieces.drain(..).enumerate() {
            progress.check()?;
            let done = index as f64 * piece_points as f64 / expected as f64;
            progress.set((0.8 + 0.2 * done) as f32, "building columns");
            plan.write(out, &piece)?;
        }
        Ok(())
    }
}

/// Refuses a header whose points no file could hold: the library multiplies without a look.
fn check_size(mut file: &[u8]) -> Result<()> {
    let Ok(header) = las::raw::Header::read_from(&mut file) else {
        // What is wrong with it, the reader says better.
        return Ok(());
    };
    let large = header
        .large_file
        .map_or(0, |large| large.number_of_point_records);
    let points = large.max(u64::from(header.number_of_point_records));
    let bytes = header.point_data_record_length;
    let start = u64::from(header.offset_to_point_data);
    points
        .checked_mul(u64::from(bytes))
        .and_then(|all| all.checked_add(start))
        .map(|_| ())
        .ok_or_else(|| {
            Error::failed(format!(
                "the header claims {points} points of {bytes} bytes, which no file can hold; the file is damaged, copy it again"
            ))
        })
}

/// How colours are kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Colours {
    None,
    Bytes,
    Words,
}

/// The columns that the file has.
struct Plan {
    colours: Colours,
    has_time: bool,
    has_infrared: bool,
    extras: Vec<Extra>,
}

impl Plan {
    fn declare(&self, out: &mut Output<'_>, expected: u64) -> Result<()> {
        let mut columns = vec![
            Column::POSITION_F64,
            Column::named(INTENSITY, ScalarType::U16, 1),
            Column::named(CLASSIFICATION, ScalarType::U8, 1),
            Column::named(RETURN_NUMBER, ScalarType::U8, 1),
            Column::named(NUMBER_OF_RETURNS, ScalarType::U8, 1),
            Column::named(POINT_SOURCE_ID, ScalarType::U16, 1),
            Column::named(USER_DATA, ScalarType::U8, 1),
            Column::named(SCAN_ANGLE, ScalarType::F32, 1),
        ];
        match self.colours {
            Colours::None => {}
            Colours::Bytes => columns.push(Column::RGB_U8),
            Colours::Words => columns.push(Column::RGB_U16),
        }
        if self.has_time {
            columns.push(Column::named(GPS_TIME, ScalarType::F64, 1));
        }
        if self.has_infrared {
            columns.push(Column::named(NEAR_INFRARED, ScalarType::U16, 1));
        }
        columns.extend(self.extras.iter().map(Extra::column));
        out.columns(&columns, expected)
    }

    fn write(&self, out: &mut Output<'_>, points: &PointData) -> Result<()> {
        let axes = points.x().zip(points.y()).zip(points.z());
        let positions: Vec<[f64; 3]> = axes.map(|((x, y), z)| [x, y, z]).collect();
        let intensities: Vec<u16> = points.intensity().collect();
        let classes: Vec<u8> = points.classification().collect();
        let returns: Vec<u8> = points.return_number().collect();
        let counts: Vec<u8> = points.number_of_returns().collect();
        let sources: Vec<u16> = points.point_source_id().collect();
        let own: Vec<u8> = points.user_data().collect();
        let angles: Vec<f32> = points.scan_angle_degrees().collect();
        let words: Vec<[u16; 3]> = match self.colours {
            Colours::None => Vec::new(),
            Colours::Bytes | Colours::Words => {
                let colours = points.rgb().into_iter().flatten();
                colours
                    .map(|(red, green, blue)| [red, green, blue])
                    .collect()
            }
        };
        let bytes: Vec<[u8; 3]> = match self.colours {
            Colours::Bytes => words
                .iter()
                .map(|colour| colour.map(|value| value as u8))
                .collect(),
            Colours::None | Colours::Words => Vec::new(),
        };
        let times: Vec<f64> = points.gps_time().into_iter().flatten().collect();
        let infrared: Vec<u16> = points.nir().into_iter().flatten().collect();
        let extras: Vec<Vec<u8>> = self
            .extras
            .iter()
            .map(|extra| extra.bytes(points))
            .collect();
        let mut columns = vec![
            bytes_of(&positions),
            bytes_of(&intensities),
            bytes_of(&classes),
            bytes_of(&returns),
            bytes_of(&counts),
            bytes_of(&sources),
            bytes_of(&own),
            bytes_of(&angles),
        ];
        match self.colours {
            Colours::None => {}
            Colours::Bytes => columns.push(bytes_of(&bytes)),
            Colours::Words => columns.push(bytes_of(&words)),
        }
        if self.has_time {
            columns.push(bytes_of(&times));
        }
        if self.has_infrared {
            columns.push(bytes_of(&infrared));
        }
        columns.extend(extras.iter().map(Vec::as_slice));
        out.rows(points.len(), &columns)
    }
}
