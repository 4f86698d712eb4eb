//! The scene as a plugin sees it: borrowed for the length of a call.

use super::values::{Handle, open_flags, open_number};
use abi_stable::StableAbi;
use abi_stable::std_types::{RSlice, RStr};

open_number! {
    /// Type of a column's scalars.
    ScalarType(u32) { I8 = 1, U8 = 2, I16 = 3, U16 = 4, I32 = 5, U32 = 6, F32 = 7, F64 = 8, I64 = 9, U64 = 10 }
}

impl ScalarType {
    /// The scalar at a place in a column's content; none beyond its end or of an unknown type.
    pub(crate) fn read_at(self, bytes: &[u8], place: usize) -> Option<f64> {
        fn at<const N: usize>(bytes: &[u8], place: usize) -> Option<[u8; N]> {
            bytes.get(place.checked_mul(N)?..)?.first_chunk().copied()
        }
        Some(match self {
            Self::I8 => f64::from(i8::from_ne_bytes(at(bytes, place)?)),
            Self::U8 => f64::from(u8::from_ne_bytes(at(bytes, place)?)),
            Self::I16 => f64::from(i16::from_ne_bytes(at(bytes, place)?)),
            Self::U16 => f64::from(u16::from_ne_bytes(at(bytes, place)?)),
            Self::I32 => f64::from(i32::from_ne_bytes(at(bytes, place)?)),
            Self::U32 => f64::from(u32::from_ne_bytes(at(bytes, place)?)),
            Self::F32 => f64::from(f32::from_ne_bytes(at(bytes, place)?)),
            Self::F64 => f64::from_ne_bytes(at(bytes, place)?),
            Self::I64 => i64::from_ne_bytes(at(bytes, place)?) as f64,
            Self::U64 => u64::from_ne_bytes(at(bytes, place)?) as f64,
            _ => return None,
        })
    }
}

/// One column of a block (or of an object: `triangles`).
#[repr(C)]
#[derive(StableAbi, Clone, Copy, Debug)]
pub struct ColumnRecord<'a> {
    /// A standard name of [`crate::columns`], or the file's own.
    pub name: RStr<'a>,
    pub scalar: ScalarType,
    /// Scalars per surfel.
    pub components: u32,
    /// Changes whenever the content does.
    pub revision: u64,
    /// The content on the CPU, aligned for its scalar.
    pub bytes: RSlice<'a, u8>,
    /// The content on the GPU: standard columns as they are, named ones as f32; none without a device or if the
    /// manifest's `needs.columns` does not ask for it.
    pub buffer: Handle,
}

impl<'a> ColumnRecord<'a> {
    /// A column that is on the CPU only.
    pub fn new<T: bytemuck::NoUninit>(
        name: &'a str,
        scalar: ScalarType,
        components: u32,
        revision: u64,
        values: &'a [T],
    ) -> Self {
        Self {
            name: RStr::from_str(name),
            scalar,
            components,
            revision,
            bytes: RSlice::from_slice(bytemuck::cast_slice(values)),
            buffer: Handle::NONE,
        }
    }
}

/// A run of surfels of one object whose columns lie together.
#[repr(C)]
#[derive(StableAbi, Clone, Copy, Debug)]
pub struct BlockRecord<'a> {
    /// Number of the block's first surfel within its object.
    pub first_surfel: u64,
    pub surfel_count: u32,
    pub columns: RSlice<'a, ColumnRecord<'a>>,
}

open_flags! {
    /// What holds of an object.
    ObjectFlags { VISIBLE = 1, SELECTED = 2, TWO_SIDED = 4 }
}

/// Phong material of an object, as in PointShop3D.
#[repr(C)]
#[derive(StableAbi, Clone, Copy, Debug, PartialEq)]
pub struct MaterialRecord {
    pub ambient: f32,
    pub diffuse: f32,
    pub specular: f32,
    pub shininess: f32,
}

/// One object of the scene.
#[repr(C)]
#[derive(StableAbi, Clone, Copy, Debug)]
pub struct ObjectRecord<'a> {
    pub id: u64,
    pub name: RStr<'a>,
    pub flags: ObjectFlags,
    pub revision: u64,
    /// World coordinates from object coordinates, column-major, f64. Object coordinates are relative to the object's
    /// own origin, whose offset is part of this matrix.
    pub world_from_object: [f64; 16],
    pub material: MaterialRecord,
    /// Least and greatest centre, object coordinates, without radii.
    pub bounds: [[f32; 3]; 2],
    pub surfel_count: u64,
    pub blocks: RSlice<'a, BlockRecord<'a>>,
    /// Columns of the object as a whole: `triangles`.
    pub columns: RSlice<'a, ColumnRecord<'a>>,
}

/// The scene.
#[repr(C)]
#[derive(StableAbi, Clone, Copy, Debug)]
pub struct SceneRecord<'a> {
    pub revision: u64,
    pub objects: RSlice<'a, ObjectRecord<'a>>,
}

open_number! {
    /// What changed between two preparations.
    ChangeKind(u32) {
        OBJECT_ADDED = 1, OBJECT_REMOVED = 2, OBJECT_MOVED = 3, COLUMN_ADDED = 4, COLUMN_CHANGED = 5,
        COLUMN_REMOVED = 6, MATERIAL = 7, FLAGS = 8,
        /// A setting whose cost is 'prepare'; `name` is its id.
        SETTING = 9,
        /// The device is a new one: all handles of before are stale.
        DEVICE = 10,
    }
}

/// One change.
#[repr(C)]
#[derive(StableAbi, Clone, Copy, Debug)]
pub struct ChangeRecord<'a> {
    pub kind: ChangeKind,
    /// Id of the object, or 0.
    pub object: u64,
    /// The column or setting, or empty.
    pub name: RStr<'a>,
}
