//! The frame's draws, with their columns as typed slices and all their surfels numbered through.

use bytemuck::AnyBitPattern;
use glam::{Mat3, Mat4, Vec4};
use pointstage_plugin_api::abi::{BlockRecord, DrawFlags, DrawRecord};
use pointstage_plugin_api::columns;

use super::lighting::Phong;

/// One draw, readable on the CPU.
#[derive(Debug)]
pub(super) struct Draw<'a> {
    pub(super) view_from_object: Mat4,
    pub(super) normal_matrix: Mat3,
    /// Factor from a column's radius to view space, the frame's radius scale not included.
    pub(super) radius_factor: f32,
    pub(super) surface: Phong,
    pub(super) two_sided: bool,
    pub(super) id_base: u32,
    pub(super) level: u32,
    pub(super) default_colour: Vec4,
    /// Centre and radius, one a surfel of the block.
    pub(super) centres: &'a [[f32; 4]],
    pub(super) normals: Option<&'a [u32]>,
    pub(super) colours: Option<&'a [u32]>,
    members: Members<'a>,
}

/// Which surfels of the block.
#[derive(Debug)]
enum Members<'a> {
    Range { first: u32, count: u32 },
    Numbers(&'a [u32]),
}

/// All draws of a frame. A surfel's *ordinal* counts through them in order.
#[derive(Debug)]
pub(super) struct Draws<'a> {
    draws: Vec<Draw<'a>>,
    /// Ordinal of each draw's first surfel, and at the end the number of all.
    starts: Vec<u32>,
}

impl<'a> Draw<'a> {
    /// `None` if the surfel numbers are on the device alone, or there are no centres of the known layout.
    fn readable(record: &'a DrawRecord<'_>) -> Option<Self> {
        let uniform = &record.uniform;
        let flags = DrawFlags(uniform.flags);
        // A column that the flags promise and the block lacks is a column less, not a draw less.
        let packed = |flag, name| {
            let promised = flags.contains(flag);
            promised
                .then(|| column::<u32>(&record.block, name))
                .flatten()
        };
        let centres = column(&record.block, columns::POSITION_RADIUS)?;
        let members = if record.indices.is_empty() {
            if flags.contains(DrawFlags::INDEXED) && uniform.count > 0 {
                return None;
            }
            let first = uniform.first.min(centres.len() as u32);
            Members::Range {
                first,
                count: uniform.count.min(centres.len() as u32 - first),
            }
        } else {
            Members::Numbers(record.indices.as_slice())
        };
        Some(Self {
            view_from_object: Mat4::from_cols_array_2d(&uniform.view_from_object),
            normal_matrix: Mat3::from_mat4(Mat4::from_cols_array_2d(
                &uniform.view_from_object_normal,
            )),
            radius_factor: uniform.radius_factor,
            surface: Phong::from(uniform.material),
            two_sided: flags.contains(DrawFlags::TWO_SIDED),
            id_base: uniform.id_base,
            level: uniform.level.round() as u32,
            default_colour: Vec4::from_array(uniform.default_colour),
            centres,
            normals: packed(DrawFlags::HAS_NORMAL, columns::NORMAL),
            colours: packed(DrawFlags::HAS_COLOUR, columns::COLOUR),
            members,
        })
    }

    /// How many surfels it draws.
    pub(super) fn len(&self) -> u32 {
        match self.members {
            Members::Range { count, .. } => count,
            Members::Numbers(numbers) => numbers.len() as u32,
        }
    }

    /// The number within the block of the draw's `index`-th surfel; it may lie outside the block.
    #[inline]
    pub(super) fn number(&self, index: u32) -> u32 {
        match self.members {
            Members::Range { first, .. } => first + index,
            Members::Numbers(numbers) => numbers[index as usize],
        }
    }
}

impl<'a> Draws<'a> {
    /// The draws that can be read, and how many cannot.
    ///
    /// Ordinals have 32 bits: what lies beyond 4 billion surfels counts as not readable.
    pub(super) fn readable(records: &'a [DrawRecord<'_>]) -> (Self, u32) {
        let mut draws = Vec::with_capacity(records.len());
        let mut starts = vec![0_u32];
        for record in records {
            let Some(draw) = Draw::readable(record) else {
                continue;
            };
            // One less than u32 has, since the visibility buffer keeps ordinal + 1.
            let end = starts[draws.len()].checked_add(draw.len());
            let Some(end) = end.filter(|end| *end < u32::MAX) else {
                continue;
            };
            draws.push(draw);
            starts.push(end);
        }
        let unreadable = (records.len() - draws.len()) as u32;
        (Self { draws, starts }, unreadable)
    }

    /// Surfels in all draws.
    pub(super) fn surfel_count(&self) -> u32 {
        self.starts[self.draws.len()]
    }

    /// The draws that have surfels among these ordinals, each with the range of its own.
    pub(super) fn spans(
        &self,
        ordinals: core::ops::Range<u32>,
    ) -> impl Iterator<Item = Span<'_, 'a>> {
        let first = self.index_of(ordinals.start);
        let starts = self.starts[first..].windows(2);
        let begun = starts.take_while(move |edges| edges[0] < ordinals.end);
        self.draws[first..]
            .iter()
            .zip(begun)
            .map(move |(draw, edges)| {
                let begin = ordinals.start.max(edges[0]);
                Span {
                    draw,
                    first_ordinal: begin,
                    range: begin - edges[0]..ordinals.end.min(edges[1]) - edges[0],
                }
            })
    }

    /// The draw of an ordinal, and the surfel's number in the draw.
    #[inline]
    pub(super) fn find(&self, ordinal: u32) -> (&Draw<'a>, u32) {
        let index = self.index_of(ordinal);
        (&self.draws[index], ordinal - self.starts[index])
    }

    fn index_of(&self, ordinal: u32) -> usize {
        // Most frames have one draw an object; empty draws share their start with the next.
        self.starts.partition_point(|start| *start <= ordinal) - 1
    }
}

/// Neighbouring surfels of one draw.
pub(super) struct Span<'s, 'a> {
    pub(super) draw: &'s Draw<'a>,
    pub(super) first_ordinal: u32,
    /// Within the draw.
    pub(super) range: core::ops::Range<u32>,
}

/// A column by name as a slice of its rows; `None` if it is absent or not a whole number of rows.
fn column<'a, T: AnyBitPattern>(block: &BlockRecord<'a>, name: &str) -> Option<&'a [T]> {
    let column = block
        .columns
        .as_slice()
        .iter()
        .find(|column| column.name == name)?;
    bytemuck::try_cast_slice(column.bytes.as_slice()).ok()
}
