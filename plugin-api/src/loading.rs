//! What the author of a loader writes: is this file mine, and what is in it?
//!
//! A loader reads one file format. The host shows it the first 4 KB of every file that is opened; the loader that claims a
//! file most gets it whole, as bytes, and hands over columns in runs of surfels, and polygons. The host does the rest for all
//! formats alike: it finds an origin that keeps map coordinates precise, drops what is not finite, cuts polygons into
//! triangles, and estimates the normals and radii that a file lacks.
//!
//! ```
//! use pointstage_plugin_api::loading::{Claim, Column, FileStart, Loader, Output, SourceFile, bytes_of};
//! use pointstage_plugin_api::{Error, Host, Progress, Result, Settings};
//!
//! /// Triples of little-endian floats behind the word `DOTS`.
//! struct Dots;
//!
//! impl Loader for Dots {
//!     fn claims(start: &FileStart<'_>) -> Claim {
//!         if start.bytes.starts_with(b"DOTS") { Claim::Certain } else { Claim::No }
//!     }
//!
//!     fn load(
//!         _host: &Host, file: &SourceFile<'_>, _settings: Settings<'_>, out: &mut Output<'_>, progress: &Progress<'_>,
//!     ) -> Result<()> {
//!         let (points, rest) = file.bytes.get(4..).unwrap_or_default().as_chunks::<12>();
//!         if !rest.is_empty() {
//!             return Err(Error::failed(format!(
//!                 "byte {}: expected points of 12 bytes, found {} bytes; the file is truncated, copy it again",
//!                 file.bytes.len() - rest.len(), rest.len()
//!             )));
//!         }
//!         out.columns(&[Column::POSITION_F32], points.len() as u64)?;
//!         for (run, some) in points.chunks(65_536).enumerate() {
//!             progress.check()?;
//!             progress.set(run as f32 * 65_536.0 / points.len() as f32, "reading points");
//!             let number = |point: &[u8; 12], at: usize| f32::from_le_bytes(*point[4 * at..].first_chunk().unwrap());
//!             let positions: Vec<[f32; 3]> = some.iter().map(|p| [number(p, 0), number(p, 1), number(p, 2)]).collect();
//!             out.rows(some.len(), &[bytes_of(&positions)])?;
//!         }
//!         Ok(())
//!     }
//! }
//! ```

use crate::abi::{
    self, ClaimLevel, ColumnRole, ErrorCode, LoadColumnRecord, LoadRowsRecord, LoadScaleRecord,
    LoadSinkRef, LoadTextureRecord, ScalarType,
};
use crate::error::{Result, from_border};
use crate::host::{Host, Progress};
use crate::settings::Settings;
use abi_stable::std_types::{ROption, RResult, RSlice, RStr};
use std::path::Path;

/// Bytes at a file's start that a loader sees before it claims the file.
pub const START_BYTES: usize = 4096;

/// Stands for the texture of a polygon that has none.
pub const NO_TEXTURE: u32 = u32::MAX;

/// A loader of one file format. It has no state: every call says all.
pub trait Loader: 'static {
    /// How sure is it that the file is its own? Thread: any. Cheap: asked about every file that is opened.
    fn claims(start: &FileStart<'_>) -> Claim;

    /// Reads the file. Thread: worker; cancellable.
    ///
    /// # Errors
    /// The file says something that cannot be. The message says where (byte or line), what was expected, what was found, and
    /// what to do; the host puts the file's name before it. Nothing is kept of what was handed over.
    fn load(
        host: &Host,
        file: &SourceFile<'_>,
        settings: Settings<'_>,
        out: &mut Output<'_>,
        progress: &Progress<'_>,
    ) -> Result<()>;
}

/// What a loader sees of a file before it claims it.
#[derive(Clone, Copy, Debug)]
pub struct FileStart<'a> {
    /// The first [`START_BYTES`], or all if there are fewer.
    pub bytes: &'a [u8],
    /// The file's name, without its folder.
    pub name: &'a str,
    /// Length of the file, bytes.
    pub length: u64,
}

impl FileStart<'_> {
    /// Extension of the name, lower case, without the dot; empty if it has none.
    pub fn extension(&self) -> String {
        let extension = Path::new(self.name).extension();
        extension.map_or_else(String::new, |extension| {
            extension.to_string_lossy().to_ascii_lowercase()
        })
    }
}

/// How sure a loader is that a file is its own, by what the file holds. The host weighs the extension itself, after the
/// content.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Claim {
    /// It is not: the content contradicts.
    #[default]
    No,
    /// The content neither says so nor contradicts; the extension decides.
    Possible,
    /// It looks like it.
    Likely,
    /// It has the format's signature.
    Certain,
}

impl Claim {
    /// As the border has it.
    pub const fn level(self) -> ClaimLevel {
        match self {
            Self::No => ClaimLevel::NO,
            Self::Possible => ClaimLevel::POSSIBLE,
            Self::Likely => ClaimLevel::LIKELY,
            Self::Certain => ClaimLevel::CERTAIN,
        }
    }

    /// Of a level of the border; one that a later version invents counts as what it is above.
    pub const fn from_level(level: ClaimLevel) -> Self {
        match level.0 {
            0 => Self::No,
            1 => Self::Possible,
            2 => Self::Likely,
            _ => Self::Certain,
        }
    }
}

/// A file that is being loaded.
#[derive(Clone, Copy, Debug)]
pub struct SourceFile<'a> {
    /// Where it is, for files beside it that it names.
    pub path: &'a Path,
    /// The whole file, mapped into memory: its bytes may change under the reader if somebody writes it, so check what you
    /// index with where you use it.
    pub bytes: &'a [u8],
}

/// A column that is going to be filled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Column<'a> {
    /// What it means.
    pub role: ColumnRole,
    /// Type of a component; not `I64` or `U64`.
    pub scalar: ScalarType,
    /// Components a surfel.
    pub components: u32,
    /// The file's name for it; of no meaning unless the role is `NAMED`.
    pub name: &'a str,
}

impl<'a> Column<'a> {
    /// x, y, z as f64: for coordinates that may be far from 0. The host finds an origin for them.
    pub const POSITION_F64: Self = Self::of(ColumnRole::POSITION, ScalarType::F64, 3);
    /// x, y, z as whole numbers, of which [`Output::scaled_positions`] says what they stand for.
    pub const POSITION_I32: Self = Self::of(ColumnRole::POSITION, ScalarType::I32, 3);
    /// x, y, z as f32.
    pub const POSITION_F32: Self = Self::of(ColumnRole::POSITION, ScalarType::F32, 3);
    /// Normals; their length does not matter.
    pub const NORMAL_F32: Self = Self::of(ColumnRole::NORMAL, ScalarType::F32, 3);
    /// sRGB bytes: red, green, blue.
    pub const RGB_U8: Self = Self::of(ColumnRole::COLOUR, ScalarType::U8, 3);
    /// sRGB bytes with straight alpha.
    pub const RGBA_U8: Self = Self::of(ColumnRole::COLOUR, ScalarType::U8, 4);
    /// sRGB of 16 bits a component.
    pub const RGB_U16: Self = Self::of(ColumnRole::COLOUR, ScalarType::U16, 3);
    /// Radii, scene units.
    pub const RADIUS_F32: Self = Self::of(ColumnRole::RADIUS, ScalarType::F32, 1);

    /// A column whose role says all.
    pub const fn of(role: ColumnRole, scalar: ScalarType, components: u32) -> Self {
        Self {
            role,
            scalar,
            components,
            name: "",
        }
    }

    /// A column kept under the file's name: intensity, time, class …
    pub const fn named(name: &'a str, scalar: ScalarType, components: u32) -> Self {
        Self {
            name,
            ..Self::of(ColumnRole::NAMED, scalar, components)
        }
    }
}

/// Where a loader puts what it reads. The host checks every length, and answers with an error once the load is cancelled.
pub struct Output<'a> {
    sink: &'a dyn Sink,
}

/// What [`Output`] needs of the border's object; hides its lifetime.
pub(crate) trait Sink {
    fn declare(&self, columns: &[LoadColumnRecord<'_>], expected: u64) -> Result<()>;
    fn add(&self, rows: &LoadRowsRecord<'_>) -> Result<()>;
    fn connect(&self, lengths: &[u32], corners: &[u32]) -> Result<()>;
    fn note(&self, text: &str, count: u64);
    fn keep(&self, texture: &LoadTextureRecord<'_>) -> Result<u32>;
    fn cover(&self, textures: &[u32], uvs: &[[f32; 2]]) -> Result<()>;
    fn scale(&self, scale: &LoadScaleRecord) -> Result<()>;
    fn forget(&self) -> Result<()>;
}

impl Sink for LoadSinkRef<'_> {
    fn declare(&self, columns: &[LoadColumnRecord<'_>], expected: u64) -> Result<()> {
        from_border(self.columns(RSlice::from_slice(columns), expected))
    }

    fn add(&self, rows: &LoadRowsRecord<'_>) -> Result<()> {
        from_border(self.rows(rows))
    }

    fn connect(&self, lengths: &[u32], corners: &[u32]) -> Result<()> {
        from_border(self.polygons(RSlice::from_slice(lengths), RSlice::from_slice(corners)))
    }

    fn note(&self, text: &str, count: u64) {
        self.warn(RStr::from_str(text), count);
    }

    fn keep(&self, texture: &LoadTextureRecord<'_>) -> Result<u32> {
        from_border(self.texture(texture))
    }

    fn cover(&self, textures: &[u32], uvs: &[[f32; 2]]) -> Result<()> {
        from_border(self.polygon_textures(RSlice::from_slice(textures), RSlice::from_slice(uvs)))
    }

    fn scale(&self, scale: &LoadScaleRecord) -> Result<()> {
        from_border(self.scaled_positions(scale))
    }

    fn forget(&self) -> Result<()> {
        from_border(self.begin_again())
    }
}

impl<'a> Output<'a> {
    pub(crate) fn new(sink: &'a dyn Sink) -> Self {
        Self { sink }
    }

    /// Declares the columns, once and first. `expected` surfels will come, as far as is known; 0 if it is not.
    ///
    /// # Errors
    /// There is no position, a role or a name comes twice, or a column cannot have so many components.
    pub fn columns(&mut self, columns: &[Column<'_>], expected: u64) -> Result<()> {
        let records: Vec<LoadColumnRecord<'_>> = columns
            .iter()
            .map(|column| LoadColumnRecord {
                role: column.role,
                scalar: column.scalar,
                components: column.components,
                name: RStr::from_str(column.name),
            })
            .collect();
        self.sink.declare(&records, expected)
    }

    /// Adds `count` surfels: the bytes of each column in the order of their declaration (see [`bytes_of`]). Runs of some ten
    /// thousand are best: few calls, and a cancel is noticed soon.
    ///
    /// # Errors
    /// A column is missing or of another length, or the load was cancelled.
    pub fn rows(&mut self, count: usize, columns: &[&[u8]]) -> Result<()> {
        let columns: Vec<RSlice<'_, u8>> = columns
            .iter()
            .map(|bytes| RSlice::from_slice(bytes))
            .collect();
        self.sink.add(&LoadRowsRecord {
            count: count as u64,
            columns: RSlice::from_slice(&columns),
        })
    }

    /// Adds triangles of surfels, which are counted from 0 over all rows. Those that name a surfel that never comes are
    /// dropped and counted.
    ///
    /// # Errors
    /// The load was cancelled.
    pub fn triangles(&mut self, triangles: &[[u32; 3]]) -> Result<()> {
        self.sink.connect(&[], triangles.as_flattened())
    }

    /// Adds polygons: the length of each, and the corners of all. The host cuts them into triangles.
    ///
    /// # Errors
    /// The lengths do not add up to the corners, or the load was cancelled.
    pub fn polygons(&mut self, lengths: &[u32], corners: &[u32]) -> Result<()> {
        // Without lengths all would be triangles.
        if lengths.is_empty() && corners.is_empty() {
            return Ok(());
        }
        if lengths.is_empty() {
            return Err("corners of polygons came without lengths".into());
        }
        self.sink.connect(lengths, corners)
    }

    /// Keeps the picture of a texture with the object: its name and a whole PNG or JPEG file. Gives its number, counted from 0;
    /// `None` by a host that keeps none, which takes no [`polygon_textures`](Self::polygon_textures) either (before 1.2).
    ///
    /// # Errors
    /// It comes before the columns, or the load was cancelled.
    pub fn texture(&mut self, name: &str, file: &[u8]) -> Result<Option<u32>> {
        let kept = self.sink.keep(&LoadTextureRecord {
            name: RStr::from_str(name),
            file: RSlice::from_slice(file),
        });
        if_supported(kept)
    }

    /// Says, before the columns, that positions come as [`Column::POSITION_I32`], whole numbers that stand for
    /// `scale · number + offset`, axis by axis, in f64: half the memory of f64, and the host finds their box sooner. `false` by
    /// a host that only takes positions as they are (before 1.2).
    ///
    /// # Errors
    /// It comes after the columns, or the load was cancelled.
    pub fn scaled_positions(&mut self, scale: [f64; 3], offset: [f64; 3]) -> Result<bool> {
        let answer = self.sink.scale(&LoadScaleRecord { scale, offset });
        Ok(if_supported(answer)?.is_some())
    }

    /// Forgets all that was handed over, warnings included, so that a loader which finds late that it took the file wrong can begin
    /// again, with other columns if need be. `false` by a host that keeps what it was given (before 1.2): ask before the columns
    /// whether that is so.
    ///
    /// # Errors
    /// The load was cancelled.
    pub fn begin_again(&mut self) -> Result<bool> {
        Ok(if_supported(self.sink.forget())?.is_some())
    }

    /// Textures of the next polygons that have none yet, in the order in which polygons and triangles were added: the number of
    /// each one's texture, or [`NO_TEXTURE`], and texture coordinates of all their corners. v counts from the top of the
    /// picture, NaN stands for none, and what lies outside 0 to 1 repeats the picture.
    ///
    /// # Errors
    /// There are not so many polygons, the coordinates do not add up to their corners, there is no such texture, or the load was
    /// cancelled.
    pub fn polygon_textures(&mut self, textures: &[u32], uvs: &[[f32; 2]]) -> Result<()> {
        self.sink.cover(textures, uvs)
    }

    /// Notes what was done, but not as asked; equal texts are one warning with the sum of their counts. 0 notes nothing.
    pub fn warn(&mut self, text: &str, count: u64) {
        if count > 0 {
            self.sink.note(text, count);
        }
    }
}

/// What a host answered; `None` if it does not know what it was asked.
fn if_supported<T>(answer: Result<T>) -> Result<Option<T>> {
    match answer {
        Err(error) if error.code == ErrorCode::UNSUPPORTED => Ok(None),
        other => other.map(Some),
    }
}

/// Values as the bytes that [`Output::rows`] takes.
pub fn bytes_of<T: bytemuck::NoUninit>(values: &[T]) -> &[u8] {
    bytemuck::cast_slice(values)
}

/// A loader at the border.
pub(crate) struct LoaderAdapter<L>(pub(crate) std::marker::PhantomData<fn() -> L>);

impl<L: Loader> abi::LoaderObject for LoaderAdapter<L> {
    fn claims(&self, start: &abi::FileStartRecord<'_>) -> RResult<ClaimLevel, abi::ErrorRecord> {
        crate::guard::border("claims", || {
            let start = FileStart {
                bytes: start.bytes.as_slice(),
                name: start.name.as_str(),
                length: start.length,
            };
            Ok(L::claims(&start).level())
        })
    }

    fn load(&self, call: &abi::LoadRecord<'_>) -> RResult<(), abi::ErrorRecord> {
        crate::guard::border("load", || {
            let host = Host::new(abi::share_host(&call.host));
            let file = SourceFile {
                path: Path::new(call.path.as_str()),
                bytes: call.bytes.as_slice(),
            };
            L::load(
                &host,
                &file,
                Settings::new(call.settings.as_slice()),
                &mut Output::new(&call.sink),
                &Progress::new(&call.call),
            )
        })
    }

    fn extension(&self, _name: RStr<'_>) -> ROption<abi::ExtensionBox> {
        ROption::RNone
    }
}
