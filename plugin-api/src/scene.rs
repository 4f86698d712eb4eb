//! The scene, borrowed for one call: objects, blocks of surfels, columns, and what changed.

use crate::abi::{
    BlockRecord, ChangeKind, ChangeRecord, ColumnRecord, Handle, MaterialRecord, ObjectFlags,
    ObjectRecord, ScalarType, SceneRecord,
};
use crate::columns;
use crate::gpu::BufferRef;
use glam::{DMat4, Vec3};

/// The scene. Owned by the host; nothing of it outlives the call.
#[derive(Clone, Copy)]
pub struct Scene<'a> {
    record: SceneRecord<'a>,
}

impl<'a> Scene<'a> {
    pub(crate) fn new(record: SceneRecord<'a>) -> Self {
        Self { record }
    }

    /// Grows with every change.
    pub fn revision(&self) -> u64 {
        self.record.revision
    }

    /// The objects, hidden ones too.
    pub fn objects(&self) -> impl ExactSizeIterator<Item = Object<'a>> + use<'a> {
        self.record
            .objects
            .as_slice()
            .iter()
            .map(|record| Object { record })
    }

    /// The object of this number.
    pub fn object(&self, index: u32) -> Option<Object<'a>> {
        self.record
            .objects
            .as_slice()
            .get(index as usize)
            .map(|record| Object { record })
    }

    /// Surfels of all objects.
    pub fn surfel_count(&self) -> u64 {
        self.objects().map(|object| object.surfel_count()).sum()
    }
}

/// One object of the scene.
#[derive(Clone, Copy)]
pub struct Object<'a> {
    record: &'a ObjectRecord<'a>,
}

impl<'a> Object<'a> {
    /// Stable while the object lives.
    pub fn id(&self) -> u64 {
        self.record.id
    }

    /// The object's name.
    pub fn name(&self) -> &'a str {
        self.record.name.as_str()
    }

    /// Grows with every change of the object.
    pub fn revision(&self) -> u64 {
        self.record.revision
    }

    /// Whether the object is shown.
    pub fn visible(&self) -> bool {
        self.record.flags.contains(ObjectFlags::VISIBLE)
    }

    /// Whether normals have no outside.
    pub fn two_sided(&self) -> bool {
        self.record.flags.contains(ObjectFlags::TWO_SIDED)
    }

    /// World coordinates from object coordinates.
    pub fn world_from_object(&self) -> DMat4 {
        DMat4::from_cols_array(&self.record.world_from_object)
    }

    /// Phong material.
    pub fn material(&self) -> MaterialRecord {
        self.record.material
    }

    /// Least and greatest centre; object coordinates.
    pub fn bounds(&self) -> [Vec3; 2] {
        self.record.bounds.map(Vec3::from_array)
    }

    /// Surfels of all blocks.
    pub fn surfel_count(&self) -> u64 {
        self.record.surfel_count
    }

    /// The blocks, in order.
    pub fn blocks(&self) -> impl ExactSizeIterator<Item = Block<'a>> + use<'a> {
        self.record
            .blocks
            .as_slice()
            .iter()
            .map(|record| Block { record: *record })
    }

    /// Triangles over the object's surfels (three numbers each, counted through all blocks), if it is a mesh.
    pub fn triangles(&self) -> Option<&'a [[u32; 3]]> {
        let column = self.column(columns::TRIANGLES)?;
        bytemuck::try_cast_slice(column.bytes()).ok()
    }

    /// Textures on the triangles, where the object's file had some. Its surfels have the means of their texels as colours.
    pub fn textures(&self) -> Option<Textures<'a>> {
        let column = |name| self.column(name).map(|column| column.bytes());
        let files = self.record.columns.as_slice().iter();
        let files = files.filter(|record| record.name.as_str() == columns::TEXTURE_FILE);
        Some(Textures {
            of_triangle: bytemuck::try_cast_slice(column(columns::TRIANGLE_TEXTURES)?).ok()?,
            uvs: bytemuck::try_cast_slice(column(columns::TRIANGLE_UVS)?).ok()?,
            files: files.map(|record| record.bytes.as_slice()).collect(),
        })
    }

    /// A column of the object as a whole.
    pub fn column(&self, name: &str) -> Option<Column<'a>> {
        find_column(self.record.columns.as_slice(), name)
    }
}

/// The textures of a mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct Textures<'a> {
    /// Number of each triangle's texture; one that is not in `files` means none.
    pub of_triangle: &'a [u32],
    /// Texture coordinates of each triangle's corners: v counts from the top of the picture, NaN stands for none, and what
    /// lies outside 0 to 1 repeats the picture.
    pub uvs: &'a [[[f32; 2]; 3]],
    /// Whole PNG or JPEG files.
    pub files: Vec<&'a [u8]>,
}

/// A run of surfels whose columns lie together.
#[derive(Clone, Copy)]
pub struct Block<'a> {
    record: BlockRecord<'a>,
}

impl<'a> Block<'a> {
    pub(crate) fn new(record: BlockRecord<'a>) -> Self {
        Self { record }
    }

    /// Number of the block's first surfel within its object.
    pub fn first_surfel(&self) -> u64 {
        self.record.first_surfel
    }

    /// Surfels of the block.
    pub fn surfel_count(&self) -> u32 {
        self.record.surfel_count
    }

    /// Centre and radius of each surfel; object coordinates, scene units.
    pub fn position_radius(&self) -> &'a [[f32; 4]] {
        self.standard(columns::POSITION_RADIUS).unwrap_or_default()
    }

    /// Octahedral normal of each surfel; see [`columns`].
    pub fn normals(&self) -> Option<&'a [u32]> {
        self.standard(columns::NORMAL)
    }

    /// Packed sRGB colour of each surfel; see [`columns`].
    pub fn colours(&self) -> Option<&'a [u32]> {
        self.standard(columns::COLOUR)
    }

    /// Tangent half-axes of each surfel: u.xyz, 0, v.xyz, 0; object coordinates, scene units.
    pub fn axes(&self) -> Option<&'a [[f32; 8]]> {
        self.standard(columns::AXES)
    }

    /// Any column by name.
    pub fn column(&self, name: &str) -> Option<Column<'a>> {
        find_column(self.record.columns.as_slice(), name)
    }

    /// All columns.
    pub fn columns(&self) -> impl ExactSizeIterator<Item = Column<'a>> + use<'a> {
        self.record
            .columns
            .as_slice()
            .iter()
            .map(|record| Column { record })
    }

    fn standard<T: bytemuck::AnyBitPattern>(&self, name: &str) -> Option<&'a [T]> {
        let column = self.column(name)?;
        // The host aligns columns for their scalars; a foreign one that is not is treated as absent.
        bytemuck::try_cast_slice(column.bytes()).ok()
    }
}

/// One column.
#[derive(Clone, Copy)]
pub struct Column<'a> {
    record: &'a ColumnRecord<'a>,
}

impl<'a> Column<'a> {
    /// Its name: a standard one of [`columns`], or the file's.
    pub fn name(&self) -> &'a str {
        self.record.name.as_str()
    }

    /// Type of its scalars on the CPU.
    pub fn scalar(&self) -> ScalarType {
        self.record.scalar
    }

    /// Scalars per surfel.
    pub fn components(&self) -> u32 {
        self.record.components
    }

    /// Grows with every change of the content.
    pub fn revision(&self) -> u64 {
        self.record.revision
    }

    /// The content on the CPU.
    pub fn bytes(&self) -> &'a [u8] {
        self.record.bytes.as_slice()
    }

    /// A number of a surfel, whatever its type; none beyond the content or of an unknown type. 64-bit integers lose what an f64
    /// cannot hold.
    pub fn number(&self, surfel: u32, component: u32) -> Option<f64> {
        if component >= self.components() {
            return None;
        }
        let place = u64::from(surfel) * u64::from(self.components()) + u64::from(component);
        self.scalar()
            .read_at(self.bytes(), usize::try_from(place).ok()?)
    }

    /// The content on the GPU: standard columns as they are, named ones as f32 if the manifest's `needs.columns` asks.
    pub fn buffer(&self) -> Option<BufferRef> {
        BufferRef::new(self.record.buffer)
    }
}

fn find_column<'a>(records: &'a [ColumnRecord<'a>], name: &str) -> Option<Column<'a>> {
    records
        .iter()
        .find(|record| record.name.as_str() == name)
        .map(|record| Column { record })
}

/// What changed since the previous preparation.
#[derive(Clone, Copy)]
pub struct Changes<'a> {
    records: &'a [ChangeRecord<'a>],
}

impl<'a> Changes<'a> {
    pub(crate) fn new(records: &'a [ChangeRecord<'a>]) -> Self {
        Self { records }
    }

    /// Kind of change, id of the object (0 if none), name of the column or setting (or empty).
    pub fn iter(&self) -> impl ExactSizeIterator<Item = (ChangeKind, u64, &'a str)> + use<'a> {
        self.records
            .iter()
            .map(|record| (record.kind, record.object, record.name.as_str()))
    }

    /// Whether any change is of this kind.
    pub fn any(&self, kind: ChangeKind) -> bool {
        self.records.iter().any(|record| record.kind == kind)
    }

    /// Whether surfels came, went or changed: if not, GPU data made from them is still good.
    pub fn geometry(&self) -> bool {
        [
            ChangeKind::OBJECT_ADDED,
            ChangeKind::OBJECT_REMOVED,
            ChangeKind::COLUMN_ADDED,
            ChangeKind::COLUMN_CHANGED,
            ChangeKind::COLUMN_REMOVED,
            ChangeKind::DEVICE,
        ]
        .into_iter()
        .any(|kind| self.any(kind))
    }
}

impl BufferRef {
    fn new(handle: Handle) -> Option<Self> {
        handle.is_some().then_some(Self(handle))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use abi_stable::std_types::{RSlice, RStr};

    fn column<'a>(
        name: &'a str,
        scalar: ScalarType,
        components: u32,
        bytes: &'a [u8],
    ) -> ColumnRecord<'a> {
        ColumnRecord::new(name, scalar, components, 1, bytes)
    }

    #[test]
    fn textures_are_columns_of_the_object() {
        let uvs = [[[0.0_f32, 0.5], [1.0, 0.5], [1.0, 0.0]]];
        let columns = [
            column(
                columns::TRIANGLE_TEXTURES,
                ScalarType::U32,
                1,
                bytemuck::cast_slice(&[1_u32]),
            ),
            column(
                columns::TRIANGLE_UVS,
                ScalarType::F32,
                6,
                bytemuck::cast_slice(&uvs),
            ),
            column(columns::TEXTURE_FILE, ScalarType::U8, 1, b"first"),
            column(columns::TEXTURE_FILE, ScalarType::U8, 1, b"second"),
        ];
        let record = |columns| ObjectRecord {
            id: 1,
            name: RStr::from_str("square"),
            flags: ObjectFlags::VISIBLE,
            revision: 1,
            world_from_object: DMat4::IDENTITY.to_cols_array(),
            material: MaterialRecord {
                ambient: 1.0,
                diffuse: 1.0,
                specular: 0.0,
                shininess: 1.0,
            },
            bounds: [[0.0; 3]; 2],
            surfel_count: 3,
            blocks: RSlice::EMPTY,
            columns: RSlice::from_slice(columns),
        };
        let all = record(&columns);
        let textures = Object { record: &all }.textures().expect("it has some");
        assert_eq!((textures.of_triangle, textures.uvs), (&[1][..], &uvs[..]));
        assert_eq!(textures.files, [&b"first"[..], b"second"]);
        let some = record(&columns[1..]);
        assert!(Object { record: &some }.textures().is_none());
    }
}
