//! Targets in memory: the planes that CPU renderers fill.

use std::sync::Arc;

use abi_stable::std_types::{RSliceMut, RStr};
use pointstage_plugin_api::abi::PlaneRecord;

use super::picture::Plane;
use super::targets::{PlaneFormat, TargetSpec};

/// The values of one plane, rows from the top, without gaps.
#[derive(Clone, Debug, PartialEq)]
pub enum PlaneValues {
    /// One or four floats a pixel.
    Float(Vec<f32>),
    /// One number a pixel.
    Uint(Vec<u32>),
}

/// One target in memory.
#[derive(Clone, Debug, PartialEq)]
pub struct CpuPlane {
    /// What it is.
    pub spec: TargetSpec,
    /// Its values.
    pub values: PlaneValues,
}

/// The planes of one frame, all of one size.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CpuTargets {
    size_px: [u32; 2],
    planes: Vec<CpuPlane>,
}

impl CpuTargets {
    /// Planes of this size for these targets, cleared. A target that is named twice gets one plane.
    pub fn new(size_px: [u32; 2], specs: &[TargetSpec]) -> Self {
        let mut targets = Self::default();
        targets.fit(size_px, specs);
        targets
    }

    /// Makes the planes fit another size or other targets and clears them. Memory is kept where it is large enough.
    pub fn fit(&mut self, size_px: [u32; 2], specs: &[TargetSpec]) {
        let mut old = core::mem::take(&mut self.planes);
        self.size_px = size_px;
        for spec in specs {
            if self.get(&spec.key).is_some() {
                continue;
            }
            let kept = old
                .iter()
                .position(|plane| plane.spec.key == spec.key)
                .map(|index| old.swap_remove(index).values);
            let values = match (spec.plane_format(), kept) {
                (PlaneFormat::Uint, Some(values @ PlaneValues::Uint(_)))
                | (
                    PlaneFormat::Float | PlaneFormat::Float4,
                    Some(values @ PlaneValues::Float(_)),
                ) => values,
                (PlaneFormat::Uint, _) => PlaneValues::Uint(Vec::new()),
                _ => PlaneValues::Float(Vec::new()),
            };
            self.planes.push(CpuPlane {
                spec: spec.clone(),
                values,
            });
        }
        self.clear();
    }

    /// Sets every pixel of every plane to its clear value.
    pub fn clear(&mut self) {
        let pixel_count = pixel_count(self.size_px);
        for CpuPlane { spec, values } in &mut self.planes {
            match values {
                PlaneValues::Uint(values) => {
                    values.clear();
                    values.resize(pixel_count, spec.clear_number());
                }
                PlaneValues::Float(values) => {
                    let clear = spec.clear.map(|value| value as f32);
                    let channels = spec.plane_format().channels() as usize;
                    values.clear();
                    if clear.iter().all(|value| *value == clear[0]) {
                        values.resize(pixel_count * channels, clear[0]);
                    } else {
                        let pixel = clear[..channels].iter().copied();
                        values.extend(pixel.cycle().take(pixel_count * channels));
                    }
                }
            }
        }
    }

    /// Width and height, px.
    pub fn size_px(&self) -> [u32; 2] {
        self.size_px
    }

    /// The planes, in the order asked for.
    pub fn planes(&self) -> &[CpuPlane] {
        &self.planes
    }

    /// The planes, to be filled.
    pub fn planes_mut(&mut self) -> &mut [CpuPlane] {
        &mut self.planes
    }

    /// The plane of this key.
    pub fn get(&self, key: &str) -> Option<&CpuPlane> {
        self.planes.iter().find(|plane| plane.spec.key == key)
    }

    /// The floats of this key: one or four a pixel.
    pub fn floats(&self, key: &str) -> Option<&[f32]> {
        match &self.get(key)?.values {
            PlaneValues::Float(values) => Some(values),
            PlaneValues::Uint(_) => None,
        }
    }

    /// The numbers of this key, one a pixel.
    pub fn numbers(&self, key: &str) -> Option<&[u32]> {
        match &self.get(key)?.values {
            PlaneValues::Uint(values) => Some(values),
            PlaneValues::Float(_) => None,
        }
    }

    /// A copy of the plane of this key, as it is read back.
    pub fn read(&self, key: &str) -> Option<Plane> {
        let CpuPlane { spec, values } = self.get(key)?;
        Some(match values {
            PlaneValues::Float(values) => Plane::Float {
                channels: spec.plane_format().channels(),
                values: Arc::from(values.as_slice()),
            },
            PlaneValues::Uint(values) => Plane::Uint(Arc::from(values.as_slice())),
        })
    }

    /// Lends the planes to a plugin for one call.
    pub fn records(&mut self) -> Vec<PlaneRecord<'_>> {
        let width = self.size_px[0];
        self.planes
            .iter_mut()
            .map(|CpuPlane { spec, values }| PlaneRecord {
                key: RStr::from_str(&spec.key),
                format: spec.plane_format().abi(),
                row_stride: width * spec.plane_format().channels() * 4,
                bytes: RSliceMut::from_mut_slice(match values {
                    PlaneValues::Float(values) => bytemuck::cast_slice_mut(values),
                    PlaneValues::Uint(values) => bytemuck::cast_slice_mut(values),
                }),
            })
            .collect()
    }

    /// Bytes that the planes hold.
    pub fn bytes(&self) -> u64 {
        let length = |plane: &CpuPlane| match &plane.values {
            PlaneValues::Float(values) => values.len(),
            PlaneValues::Uint(values) => values.len(),
        };
        self.planes.iter().map(length).sum::<usize>() as u64 * 4
    }
}

/// Pixels of a picture.
pub(crate) fn pixel_count([width, height]: [u32; 2]) -> usize {
    width as usize * height as usize
}

#[cfg(test)]
mod tests {
    use super::super::targets::{COLOUR, DEPTH, HOST_TARGETS, LOD, NO_LEVEL};
    use super::*;
    use pointstage_plugin_api::abi::Format;

    #[test]
    fn planes_start_at_their_clear_values_and_return_to_them() {
        let mut targets = CpuTargets::new([3, 2], &HOST_TARGETS);
        let untouched = targets.clone();
        assert_eq!(targets.numbers(LOD), Some(&[NO_LEVEL; 6][..]));
        assert_eq!(targets.floats(COLOUR), Some(&[0.0; 24][..]));
        for record in targets.records() {
            record.bytes.into_mut_slice().fill(7);
        }
        assert_ne!(targets, untouched);
        targets.clear();
        assert_eq!(targets, untouched);
    }

    #[test]
    fn a_clear_value_of_four_components_fills_every_pixel() {
        let clear = [0.25, 0.5, 0.75, 1.0];
        let spec = TargetSpec::declared("tint", Format::RGBA16_FLOAT, clear, "").unwrap();
        let targets = CpuTargets::new([2, 1], &[spec]);
        let expected = [0.25, 0.5, 0.75, 1.0, 0.25, 0.5, 0.75, 1.0];
        assert_eq!(targets.floats("tint"), Some(&expected[..]));
    }

    #[test]
    fn another_size_or_selection_leaves_nothing_of_the_last_frame() {
        let mut targets = CpuTargets::new([8, 8], &HOST_TARGETS);
        for record in targets.records() {
            record.bytes.into_mut_slice().fill(7);
        }
        targets.fit([3, 5], &HOST_TARGETS[..2]);
        assert_eq!(targets, CpuTargets::new([3, 5], &HOST_TARGETS[..2]));
        assert_eq!(targets.bytes(), 3 * 5 * 5 * 4);
    }

    #[test]
    fn lent_planes_name_their_format_and_stride() {
        let mut targets = CpuTargets::new([5, 2], &HOST_TARGETS);
        let records = targets.records();
        let depth = records.iter().find(|record| record.key.as_str() == DEPTH);
        let depth = depth.unwrap();
        assert_eq!((depth.format, depth.row_stride), (Format::R32_FLOAT, 20));
        assert_eq!(depth.bytes.len(), 40);
        let colour = &records[0];
        assert_eq!(
            (colour.format, colour.row_stride),
            (Format::RGBA32_FLOAT, 80)
        );
    }
}
