//! E57 (ASTM E2807): the scans of a file as one object, each where its pose puts it.
//!
//! The library's reader of raw values is taken: the other one knows no extensions, and stops at a packet that completes no point.

use std::io::Cursor;

use e57::{E57Reader, PointCloud};
use pointstage_plugin_api::abi::ScalarType;
use pointstage_plugin_api::loading::{
    Claim, Column, FileStart, Loader, Output, SourceFile, bytes_of,
};
use pointstage_plugin_api::{Error, Host, Progress, Result, Settings};

use crate::columns::RUN;
use crate::e57_point::{Fields, Found};

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
            let fields = Fields::of(scan);
            let points = reader
                .pointcloud_raw(scan)
                .map_err(|error| fail(&error, 0))?;
            for (index, values) in points.enumerate() {
                let point = values
                    .and_then(|values| fields.read(&values))
                    .map_err(|error| fail(&error, index as u64))?;
                read += 1;
                if read.is_multiple_of(RUN as u64) {
                    progress.check()?;
                    progress.set((read as f64 / expected as f64) as f32, "reading scans");
                }
                let Some(position) = point.position else {
                    invalid += 1;
                    continue;
                };
                run.push(position, &point, number);
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
            has_normal: scans.iter().any(|scan| Fields::of(scan).has_normal()),
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

    fn push(&mut self, position: [f64; 3], point: &Found, scan: usize) {
        self.positions.push(position);
        if self.has_normal {
            self.normals.push(point.normal);
        }
        if self.has_colour {
            // White where a scan, or a point, has none.
            self.colours.push(point.colour.unwrap_or([1.0; 3]));
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
