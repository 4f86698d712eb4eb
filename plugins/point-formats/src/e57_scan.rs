//! E57 (ASTM E2807): the scans of a file as one object, each where its pose puts it.
//!
//! Normals are those of the extension for surface normals (`nor:normalX` and so on), turned by the scan's pose. The library's reader of
//! points passes over extensions, so a second one reads the same scan's raw values alongside.

use std::io::Cursor;

use e57::{CartesianCoordinate, E57Reader, PointCloud, Quaternion, RecordName, RecordValue};
use pointstage_plugin_api::abi::ScalarType;
use pointstage_plugin_api::glam::{DQuat, DVec3};
use pointstage_plugin_api::loading::{
    Claim, Column, FileStart, Loader, Output, SourceFile, bytes_of,
};
use pointstage_plugin_api::{Error, Host, Progress, Result, Settings};

use crate::columns::RUN;

/// The loader of E57 files.
pub struct E57Loader;

impl Loader for E57Loader {
    fn claims(start: &FileStart<'_>) -> Claim {
        if start.bytes.starts_with(b"ASTM-E57") {
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
        progress.set(0.0, "reading scans");
        let mut reader = E57Reader::new(Cursor::new(file.bytes)).map_err(|error| {
            let text = whole_message(&error);
            Error::failed(format!("the description of the scans cannot be read: {text}; the file is damaged or truncated, copy it again"))
        })?;
        let scans = reader.pointclouds();
        let expected = scans
            .iter()
            .fold(0_u64, |sum, scan| sum.saturating_add(scan.records));
        if expected == 0 {
            return Err(Error::failed(format!(
                "the file has {} scans with 0 points in all; there is nothing to show",
                scans.len()
            )));
        }
        let mut run = Run::new(&scans);
        let mut extended = if run.has_normal {
            let again = E57Reader::new(Cursor::new(file.bytes));
            Some(again.map_err(|error| Error::failed(whole_message(&error)))?)
        } else {
            None
        };
        run.declare(out, expected)?;
        let (mut read, mut invalid) = (0_u64, 0_u64);
        for (number, scan) in scans.iter().enumerate() {
            let fail = |error: &e57::Error, point: u64| {
                Error::failed(format!(
                    "scan {} of {}, point {} of {}: {}; the file is damaged or truncated, copy it again",
                    number + 1,
                    scans.len(),
                    point + 1,
                    scan.records,
                    whole_message(error)
                ))
            };
            let mut points = reader
                .pointcloud_simple(scan)
                .map_err(|error| fail(&error, 0))?;
            points.intensity_to_color(false);
            points.normalize_intensity(false);
            let mut normals = match (&mut extended, Normals::of(scan)) {
                (Some(reader), Some(normals)) => {
                    let raw = reader.pointcloud_raw(scan);
                    Some((normals, raw.map_err(|error| fail(&error, 0))?))
                }
                _ => None,
            };
            for (index, point) in points.enumerate() {
                let point = point.map_err(|error| fail(&error, index as u64))?;
                let normal = match &mut normals {
                    Some((normals, raw)) => match raw.next() {
                        Some(Ok(values)) => normals.read(&values),
                        Some(Err(error)) => return Err(fail(&error, index as u64)),
                        None => [0.0; 3],
                    },
                    None => [0.0; 3],
                };
                read += 1;
                if read.is_multiple_of(RUN as u64) {
                    progress.check()?;
                    progress.set((read as f64 / expected as f64) as f32, "reading scans");
                }
                let CartesianCoordinate::Valid { x, y, z } = point.cartesian else {
                    invalid += 1;
                    continue;
                };
                run.push([x, y, z], normal, &point, number);
                if run.positions.len() == RUN {
                    run.flush(out)?;
                }
            }
        }
        run.flush(out)?;
        out.warn(
            "a point of which the file gives no place, or only the direction, is left out",
            invalid,
        );
        Ok(())
    }
}

/// An error of the library with what caused it.
fn whole_message(error: &e57::Error) -> String {
    let mut text = error.to_string();
    let mut source = std::error::Error::source(error);
    while let Some(cause) = source {
        text = format!("{text}: {cause}");
        source = cause.source();
    }
    text
}

/// Where a scan keeps its normals, and what turns them into the file's axes.
struct Normals<'s> {
    scan: &'s PointCloud,
    places: [usize; 3],
    turn: DQuat,
}

impl<'s> Normals<'s> {
    /// `None` for a scan without normals.
    fn of(scan: &'s PointCloud) -> Option<Self> {
        let place = |wanted: &str| {
            scan.prototype.iter().position(|record| {
                matches!(&record.name, RecordName::Unknown { name, .. } if name == wanted)
            })
        };
        let places = [place("normalX")?, place("normalY")?, place("normalZ")?];
        let turn = scan.transform.as_ref().map_or(DQuat::IDENTITY, |pose| {
            let Quaternion { w, x, y, z } = pose.rotation.clone();
            DQuat::from_xyzw(x, y, z, w).normalize()
        });
        Some(Self {
            scan,
            places,
            turn,
        })
    }

    /// Of a point's raw values; zeros, which the host replaces, where a number cannot be read.
    fn read(&self, values: &[RecordValue]) -> [f32; 3] {
        let value = |place: usize| {
            let kind = &self.scan.prototype.get(place)?.data_type;
            values.get(place)?.to_f64(kind).ok()
        };
        let [x, y, z] = self.places.map(value);
        let normal = x.zip(y).zip(z).map(|((x, y), z)| DVec3::new(x, y, z));
        let turned = normal.map_or(DVec3::ZERO, |normal| self.turn * normal);
        turned.as_vec3().to_array()
    }
}

/// Points that have not been handed over yet.
struct Run {
    has_normal: bool,
    has_colour: bool,
    has_intensity: bool,
    has_scans: bool,
    positions: Vec<[f64; 3]>,
    normals: Vec<[f32; 3]>,
    colours: Vec<[f32; 3]>,
    intensities: Vec<f32>,
    scans: Vec<u16>,
}

impl Run {
    fn new(scans: &[PointCloud]) -> Self {
        Self {
            has_normal: scans.iter().any(|scan| Normals::of(scan).is_some()),
            has_colour: scans.iter().any(PointCloud::has_color),
            has_intensity: scans.iter().any(PointCloud::has_intensity),
            has_scans: scans.len() > 1,
            positions: Vec::with_capacity(RUN),
            normals: Vec::new(),
            colours: Vec::new(),
            intensities: Vec::new(),
            scans: Vec::new(),
        }
    }

    fn declare(&self, out: &mut Output<'_>, expected: u64) -> Result<()> {
        let mut columns = vec![Column::POSITION_F64];
        if self.has_normal {
            columns.push(Column::NORMAL_F32);
        }
        if self.has_colour {
            columns.push(Column::of(
                pointstage_plugin_api::ColumnRole::COLOUR,
                ScalarType::F32,
                3,
            ));
        }
        if self.has_intensity {
            columns.push(Column::named("intensity", ScalarType::F32, 1));
        }
        if self.has_scans {
            columns.push(Column::named("scan", ScalarType::U16, 1));
        }
        out.columns(&columns, expected)
    }

    fn push(&mut self, position: [f64; 3], normal: [f32; 3], point: &e57::Point, scan: usize) {
        self.positions.push(position);
        if self.has_normal {
            self.normals.push(normal);
        }
        if self.has_colour {
            // White where a scan, or a point, has none.
            let colour = point.color.as_ref();
            self.colours
                .push(colour.map_or([1.0; 3], |colour| [colour.red, colour.green, colour.blue]));
        }
        if self.has_intensity {
            self.intensities.push(point.intensity.unwrap_or(f32::NAN));
        }
        if self.has_scans {
            self.scans.push(u16::try_from(scan).unwrap_or(u16::MAX));
        }
    }

    fn flush(&mut self, out: &mut Output<'_>) -> Result<()> {
        let mut columns = vec![bytes_of(&self.positions)];
        if self.has_normal {
            columns.push(bytes_of(&self.normals));
        }
        if self.has_colour {
            columns.push(bytes_of(&self.colours));
        }
        if self.has_intensity {
            columns.push(bytes_of(&self.intensities));
        }
        if self.has_scans {
            columns.push(bytes_of(&self.scans));
        }
        out.rows(self.positions.len(), &columns)?;
        self.positions.clear();
        self.normals.clear();
        self.colours.clear();
        self.intensities.clear();
        self.scans.clear();
        Ok(())
    }
}
