//! The surfels of all sets in one row.

use std::ops::Range;

use glam::{DAffine3, DMat3, DVec3, Vec3};

use super::property::Property;
use super::sets::SurfelSet;
use crate::load::assemble::usable;

/// The surfels that are kept, set after set.
#[derive(Debug)]
pub(super) struct Rows<'a> {
    pub(super) parts: Vec<Part<'a>>,
    pub(super) count: usize,
}

/// Those of one set.
#[derive(Debug)]
pub(super) struct Part<'a> {
    pub(super) set: &'a SurfelSet<'a>,
    pub(super) placement: Placement,
    /// Number of the set in the file.
    pub(super) set_index: u32,
    /// Index of its first surfel over all sets.
    start: usize,
    /// Records that are kept; `None` when all are.
    kept: Option<Vec<u32>>,
    count: usize,
}

/// How the values of a record get into the object's space.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placement {
    /// Nothing is to be done.
    is_identity: bool,
    object_from_set: DAffine3,
    /// Inverse transpose.
    normals: DMat3,
    /// −1 where the map is a mirror: one of the axes is turned, so that their cross product still is the normal.
    mirror: f64,
    /// What radii are multiplied by.
    pub(super) radius_scale: f64,
}

impl Placement {
    pub(super) fn new(object_from_set: DAffine3, radius_scale: f64) -> Self {
        let matrix = object_from_set.matrix3;
        Self {
            is_identity: object_from_set == DAffine3::IDENTITY,
            object_from_set,
            normals: matrix.inverse().transpose(),
            mirror: if matrix.determinant() < 0.0 {
                -1.0
            } else {
                1.0
            },
            radius_scale,
        }
    }

    #[inline]
    pub(super) fn position(&self, position: DVec3) -> DVec3 {
        if self.is_identity {
            position
        } else {
            self.object_from_set.transform_point3(position)
        }
    }

    /// A normal of any length.
    #[inline]
    pub(super) fn normal(&self, normal: DVec3) -> DVec3 {
        if self.is_identity {
            normal
        } else {
            self.normals * normal
        }
    }

    #[inline]
    pub(super) fn axes(&self, [u, v]: [Vec3; 2]) -> [Vec3; 2] {
        if self.is_identity {
            return [u, v];
        }
        let matrix = self.object_from_set.matrix3;
        [
            (matrix * u.as_dvec3()).as_vec3(),
            (matrix * v.as_dvec3() * self.mirror).as_vec3(),
        ]
    }
}

impl Part<'_> {
    /// Calls `each` with the place in `range` and the record of some surfels of this part, counted from its first.
    #[inline]
    fn each(&self, range: Range<usize>, mut each: impl FnMut(usize, &[u8])) {
        let bytes = self.set.layout.record_bytes;
        match &self.kept {
            None => {
                let records = self.set.records.get(range.start * bytes..);
                let records = records.unwrap_or_default().chunks_exact(bytes.max(1));
                for (index, record) in records.take(range.len()).enumerate() {
                    each(index, record);
                }
            }
            Some(kept) => {
                for (index, row) in kept[range].iter().enumerate() {
                    let start = *row as usize * bytes;
                    let record = self.set.records.get(start..start + bytes);
                    each(index, record.unwrap_or_default());
                }
            }
        }
    }

    #[inline]
    pub(super) fn position(&self, record: &[u8]) -> DVec3 {
        let offset = self.set.layout.offset(Property::POSITION).unwrap_or(0);
        self.placement
            .position(vector_at(record, offset).as_dvec3())
    }

    /// Leaves out the surfels that cannot be placed.
    fn drop_unusable(&mut self) {
        let mut kept = Vec::new();
        self.each(0..self.set.count, |row, record| {
            if usable(self.position(record).to_array()) {
                kept.push(row as u32);
            }
        });
        self.count = kept.len();
        self.kept = (kept.len() < self.set.count).then_some(kept);
    }
}

impl<'a> Rows<'a> {
    /// All surfels of the sets.
    pub(super) fn new(
        sets: &'a [SurfelSet<'a>],
        place: impl Fn(&SurfelSet<'_>) -> Placement,
    ) -> Self {
        let mut rows = Self {
            parts: Vec::new(),
            count: 0,
        };
        for (set, set_index) in sets.iter().zip(0..) {
            if set.count > 0 {
                rows.parts.push(Part {
                    set,
                    placement: place(set),
                    set_index,
                    start: rows.count,
                    kept: None,
                    count: set.count,
                });
                rows.count += set.count;
            }
        }
        rows
    }

    /// Leaves out the surfels that cannot be placed.
    pub(super) fn drop_unusable(&mut self) {
        self.count = 0;
        for part in &mut self.parts {
            part.drop_unusable();
            part.start = self.count;
            self.count += part.count;
        }
        self.parts.retain(|part| part.count > 0);
    }

    /// Calls `each` with a place in `range`, a part and a record, for all surfels of `range` in order.
    #[inline]
    pub(super) fn each(&self, range: Range<usize>, mut each: impl FnMut(usize, &Part<'a>, &[u8])) {
        let first = self
            .parts
            .partition_point(|part| part.start + part.count <= range.start);
        for part in self.parts.get(first..).unwrap_or_default() {
            let start = range.start.max(part.start);
            let end = range.end.min(part.start + part.count);
            if start >= end {
                return;
            }
            part.each(start - part.start..end - part.start, |index, record| {
                each(start - range.start + index, part, record);
            });
        }
    }

    /// Whether any set stores `property`.
    pub(super) fn have(&self, property: Property) -> bool {
        self.parts
            .iter()
            .any(|part| part.set.layout.offset(property).is_some())
    }
}

/// A float of a record.
#[inline]
pub(super) fn f32_at(record: &[u8], offset: usize) -> f32 {
    let bytes = record.get(offset..).and_then(<[u8]>::first_chunk);
    bytes.copied().map_or(0.0, f32::from_be_bytes)
}

/// Three floats of a record.
#[inline]
pub(super) fn vector_at(record: &[u8], offset: usize) -> Vec3 {
    let bytes: [u8; 12] = record
        .get(offset..)
        .and_then(<[u8]>::first_chunk)
        .copied()
        .unwrap_or_default();
    let (numbers, _) = bytes.as_chunks::<4>();
    Vec3::from_array(std::array::from_fn(|index| {
        numbers.get(index).copied().map_or(0.0, f32::from_be_bytes)
    }))
}
