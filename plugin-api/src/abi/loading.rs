//! Files into columns: what a loader is asked, what it is lent, and where it puts what it reads. Since 1.1.

use super::objects::{CallRef, ExtensionBox, HostRef, unsupported};
use super::scene::ScalarType;
use super::values::{ErrorRecord, SettingRecord, open_number};
use abi_stable::sabi_types::RRef;
use abi_stable::std_types::{RBox, ROption, RResult, RSlice, RStr};
use abi_stable::{StableAbi, sabi_trait};

open_number! {
    /// How sure a loader is that a file is its own, by its content. More is surer.
    ClaimLevel(u32) {
        /// The content contradicts.
        NO = 0,
        /// The content neither says so nor contradicts; the extension decides.
        POSSIBLE = 1,
        /// It looks like it.
        LIKELY = 2,
        /// It has the format's signature.
        CERTAIN = 3,
    }
}

open_number! {
    /// What a column means.
    ColumnRole(u32) {
        /// Only its name says.
        NAMED = 0,
        /// x, y, z, or x and y; scene units, any scalar.
        POSITION = 1,
        /// Three components of any length above 0.
        NORMAL = 2,
        /// Red, green, blue, perhaps alpha: sRGB in U8, U16, or floats from 0 to 1.
        COLOUR = 3,
        /// One component, scene units.
        RADIUS = 4,
        /// Tangent half-axes u and v, six components, scene units.
        AXES = 5,
    }
}

/// A file's start, before it is loaded.
#[repr(C)]
#[derive(StableAbi, Clone, Copy, Debug)]
pub struct FileStartRecord<'a> {
    /// The first 4,096 bytes, or all if there are fewer.
    pub bytes: RSlice<'a, u8>,
    /// Name without folder.
    pub name: RStr<'a>,
    /// Length of the whole file, bytes.
    pub length: u64,
}

/// A column that a loader is going to fill.
#[repr(C)]
#[derive(StableAbi, Clone, Copy, Debug)]
pub struct LoadColumnRecord<'a> {
    pub role: ColumnRole,
    /// Not I64 or U64.
    pub scalar: ScalarType,
    /// Scalars per surfel.
    pub components: u32,
    /// The file's name for it; of no meaning unless the role is NAMED.
    pub name: RStr<'a>,
}

/// A run of surfels.
#[repr(C)]
#[derive(StableAbi, Clone, Copy, Debug)]
pub struct LoadRowsRecord<'a> {
    pub count: u64,
    /// The bytes of each declared column, in that order; native byte order, surfel by surfel. Any alignment.
    pub columns: RSlice<'a, RSlice<'a, u8>>,
}

/// The picture of a texture.
#[repr(C)]
#[derive(StableAbi, Clone, Copy, Debug)]
pub struct LoadTextureRecord<'a> {
    /// What the file calls it.
    pub name: RStr<'a>,
    /// A whole PNG or JPEG file.
    pub file: RSlice<'a, u8>,
}

/// What whole numbers of a position stand for: `value = scale · number + offset`, axis by axis, in f64.
#[repr(C)]
#[derive(StableAbi, Clone, Copy, Debug, PartialEq)]
pub struct LoadScaleRecord {
    pub scale: [f64; 3],
    /// Scene units.
    pub offset: [f64; 3],
}

/// Where a loader puts what it reads; the host checks every length. Thread: any, while the call lasts.
#[sabi_trait]
pub trait LoadSinkObject: Send + Sync {
    /// Declares the columns, once and first. `expected` surfels will come, as far as is known; 0 if it is not.
    fn columns(
        &self,
        columns: RSlice<'_, LoadColumnRecord<'_>>,
        expected: u64,
    ) -> RResult<(), ErrorRecord>;
    /// Adds surfels. CANCELLED once the call was cancelled.
    fn rows(&self, rows: &LoadRowsRecord<'_>) -> RResult<(), ErrorRecord>;
    /// Adds polygons of surfels, which are counted from 0 over all rows: the length of each, and all their corners. Without
    /// lengths all are triangles. CANCELLED once the call was cancelled.
    fn polygons(
        &self,
        lengths: RSlice<'_, u32>,
        corners: RSlice<'_, u32>,
    ) -> RResult<(), ErrorRecord>;
    /// Notes what was done, but not as asked; equal texts are one warning with the sum of their counts.
    fn warn(&self, text: RStr<'_>, count: u64);
    #[sabi(last_prefix_field)]
    fn extension(&self, name: RStr<'_>) -> ROption<ExtensionBox>;
    /// Keeps a texture's picture with the object; its number, counted from 0. Since 1.2.
    fn texture(&self, _texture: &LoadTextureRecord<'_>) -> RResult<u32, ErrorRecord> {
        unsupported("this host keeps no textures")
    }
    /// The textures of the next polygons that have none yet, in the order in which they were added: the number of each one's texture,
    /// `u32::MAX` for none, and the texture coordinates of all their corners, v from the top of the picture. Since 1.2.
    fn polygon_textures(
        &self,
        _textures: RSlice<'_, u32>,
        _uvs: RSlice<'_, [f32; 2]>,
    ) -> RResult<(), ErrorRecord> {
        unsupported("this host keeps no textures")
    }
    /// Says what the numbers of the column of positions stand for, which must then be I32. Before the columns. Since 1.2.
    fn scaled_positions(&self, _scale: &LoadScaleRecord) -> RResult<(), ErrorRecord> {
        unsupported("this host takes positions as they are")
    }
    /// Forgets all that was handed over, warnings included: the loader begins again. Since 1.2.
    fn begin_again(&self) -> RResult<(), ErrorRecord> {
        unsupported("this host keeps what it was given")
    }
}
pub type LoadSinkRef<'a> = LoadSinkObject_TO<'a, RRef<'a, ()>>;

/// What `load` is given.
#[repr(C)]
#[derive(StableAbi)]
pub struct LoadRecord<'a> {
    pub host: HostRef,
    /// Where the file is, for files beside it that it names.
    pub path: RStr<'a>,
    /// The whole file, mapped: its bytes may change under the reader, their number does not.
    pub bytes: RSlice<'a, u8>,
    pub settings: RSlice<'a, SettingRecord<'a>>,
    pub sink: LoadSinkRef<'a>,
    pub call: CallRef<'a>,
}

/// A loader of one file format.
#[sabi_trait]
pub trait LoaderObject: Send + Sync {
    /// Thread: any. Cheap: asked about every file that is opened.
    fn claims(&self, start: &FileStartRecord<'_>) -> RResult<ClaimLevel, ErrorRecord>;
    /// Thread: worker. Cancellable.
    fn load(&self, call: &LoadRecord<'_>) -> RResult<(), ErrorRecord>;
    #[sabi(last_prefix_field)]
    fn extension(&self, _name: RStr<'_>) -> ROption<ExtensionBox> {
        ROption::RNone
    }
}
pub type LoaderBox = LoaderObject_TO<'static, RBox<()>>;
