//! One point of an E57 scan from its raw values: which of them say what, which of that is valid, and where it stands.
//!
//! Normals are those of the extension for surface normals (`nor:normalX` and so on), turned by the scan's pose as positions are.

use e57::{ColorLimits, PointCloud, RecordDataType, RecordName, RecordValue, Translation};
use pointstage_plugin_api::glam::{DQuat, DVec3};

/// Where a scan keeps what.
pub(crate) struct Fields<'s> {
    scan: &'s PointCloud,
    cartesian: Option<[usize; 3]>,
    cartesian_state: Option<usize>,
    /// Range, azimuth, elevation.
    spherical: Option<[usize; 3]>,
    spherical_state: Option<usize>,
    colour: Option<[usize; 3]>,
    colour_state: Option<usize>,
    /// Least and greatest value of each colour.
    colour_ranges: [[f64; 2]; 3],
    intensity: Option<usize>,
    intensity_state: Option<usize>,
    normal: Option<[usize; 3]>,
    turn: DQuat,
    way: DVec3,
}

/// What one point has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Found {
    /// In the file's axes; `None` if the file gives no place, or only a direction.
    pub(crate) position: Option<[f64; 3]>,
    /// Zeros, which the host replaces, where there is none.
    pub(crate) normal: [f32; 3],
    /// 0 to 1.
    pub(crate) colour: Option<[f32; 3]>,
    pub(crate) intensity: Option<f32>,
}

impl<'s> Fields<'s> {
    pub(crate) fn of(scan: &'s PointCloud) -> Self {
        let place = |wanted: &RecordName| {
            let records = &scan.prototype;
            records.iter().position(|record| record.name == *wanted)
        };
        let all = |names: [RecordName; 3]| {
            let [a, b, c] = names.map(|name| place(&name));
            Some([a?, b?, c?])
        };
        let extension = |wanted: &str| {
            scan.prototype.iter().position(
                |record| matches!(&record.name, RecordName::Unknown { name, .. } if name == wanted),
            )
        };
        let normal = ["normalX", "normalY", "normalZ"].map(extension);
        let pose = scan.transform.as_ref();
        let turn = pose.map_or(DQuat::IDENTITY, |pose| {
            let turn = &pose.rotation;
            let quaternion = DQuat::from_xyzw(turn.x, turn.y, turn.z, turn.w);
            // A rotation that is none says nothing.
            if quaternion.length_squared() > 0.0 {
                quaternion.normalize()
            } else {
                DQuat::IDENTITY
            }
        });
        let way = pose.map_or(DVec3::ZERO, |pose| {
            let Translation { x, y, z } = pose.translation;
            DVec3::new(x, y, z)
        });
        let colour = all([
            RecordName::ColorRed,
            RecordName::ColorGreen,
            RecordName::ColorBlue,
        ]);
        Self {
            scan,
            cartesian: all([
                RecordName::CartesianX,
                RecordName::CartesianY,
                RecordName::CartesianZ,
            ]),
            cartesian_state: place(&RecordName::CartesianInvalidState),
            spherical: all([
                RecordName::SphericalRange,
                RecordName::SphericalAzimuth,
                RecordName::SphericalElevation,
            ]),
            spherical_state: place(&RecordName::SphericalInvalidState),
            colour,
            colour_state: place(&RecordName::IsColorInvalid),
            colour_ranges: colour.map_or([[0.0, 1.0]; 3], |places| colour_ranges(scan, places)),
            intensity: place(&RecordName::Intensity),
            intensity_state: place(&RecordName::IsIntensityInvalid),
            normal: normal[0]
                .zip(normal[1])
                .zip(normal[2])
                .map(|((x, y), z)| [x, y, z]),
            turn,
            way,
        }
    }

    pub(crate) fn has_normal(&self) -> bool {
        self.normal.is_some()
    }

    /// Reads a point.
    ///
    /// # Errors
    /// A value does not fit its type.
    pub(crate) fn read(&self, values: &[RecordValue]) -> e57::Result<Found> {
        let number = |place: usize| match values.get(place).zip(self.scan.prototype.get(place)) {
            Some((value, record)) => value.to_f64(&record.data_type),
            None => Ok(f64::NAN),
        };
        let three = |places: [usize; 3]| -> e57::Result<[f64; 3]> {
            let [a, b, c] = places.map(number);
            Ok([a?, b?, c?])
        };
        // 0 stands for valid; some programs write states as floats.
        let is_valid =
            |state: Option<usize>| state.map_or(Ok(true), |place| Ok(number(place)? == 0.0));
        let mut place = None;
        if let Some(places) = self.cartesian
            && is_valid(self.cartesian_state)?
        {
            place = Some(DVec3::from_array(three(places)?));
        } else if let Some(places) = self.spherical
            && is_valid(self.spherical_state)?
        {
            let [range, azimuth, elevation] = three(places)?;
            let (sin_azimuth, cos_azimuth) = azimuth.sin_cos();
            let (sin_elevation, cos_elevation) = elevation.sin_cos();
            place = Some(
                range
                    * DVec3::new(
                        cos_elevation * cos_azimuth,
                        cos_elevation * sin_azimuth,
                        sin_elevation,
                    ),
            );
        }
        let colour = match self.colour {
            Some(places) if is_valid(self.colour_state)? => {
                let values = three(places)?;
                Some(std::array::from_fn(|channel| {
                    let [least, greatest] = self.colour_ranges[channel];
                    let part = (values[channel] - least) / (greatest - least);
                    part.clamp(0.0, 1.0) as f32
                }))
            }
            _ => None,
        };
        let intensity = match self.intensity {
            Some(place) if is_valid(self.intensity_state)? => Some(number(place)? as f32),
            _ => None,
        };
        let normal = self.normal.map(three).transpose()?;
        let normal = normal.map_or(DVec3::ZERO, |normal| self.turn * DVec3::from_array(normal));
        Ok(Found {
            position: place.map(|place| (self.turn * place + self.way).to_array()),
            normal: normal.as_vec3().to_array(),
            colour,
            intensity,
        })
    }
}

/// Ranges of colours as the scan gives them, else those of their types; floats without any go from 0 to 1.
fn colour_ranges(scan: &PointCloud, places: [usize; 3]) -> [[f64; 2]; 3] {
    let given = |channel: usize| {
        let ColorLimits {
            red_min,
            red_max,
            green_min,
            green_max,
            blue_min,
            blue_max,
        } = scan.color_limits.as_ref()?;
        let (least, greatest) = [
            (red_min, red_max),
            (green_min, green_max),
            (blue_min, blue_max),
        ][channel];
        let kind = &scan.prototype[places[channel]].data_type;
        let number = |value: &Option<RecordValue>| value.as_ref()?.to_f64(kind).ok();
        Some([number(least)?, number(greatest)?])
    };
    std::array::from_fn(|channel| {
        let of_type = match &scan.prototype[places[channel]].data_type {
            RecordDataType::Single { min, max } => {
                [f64::from(min.unwrap_or(0.0)), f64::from(max.unwrap_or(1.0))]
            }
            RecordDataType::Double { min, max } => [min.unwrap_or(0.0), max.unwrap_or(1.0)],
            RecordDataType::ScaledInteger {
                min,
                max,
                scale,
                offset,
            } => [min, max].map(|value| *value as f64 * scale + offset),
            RecordDataType::Integer { min, max } => [min, max].map(|value| *value as f64),
        };
        given(channel)
            .filter(|[least, greatest]| least < greatest)
            .unwrap_or(of_type)
    })
}
