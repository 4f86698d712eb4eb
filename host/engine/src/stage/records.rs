//! The scene as border records: borrowed from the scene itself, with the handles of what is on the device.

use abi_stable::std_types::{RSlice, RStr};
use glam::DMat4;
use pointstage_plugin_api::abi::{
    BlockRecord, ColumnRecord, Handle, MaterialRecord, ObjectFlags, ObjectRecord,
    ScalarType as Scalar, SceneRecord,
};
use pointstage_plugin_api::columns;
use pointstage_scene::{Block, NamedColumn, Object, Provenance, ScalarType, Scene};

/// Finds the device's copy of a column by the address of its content; [`Handle::NONE`] if there is none.
pub(super) type Lookup<'a> = &'a dyn Fn(*const u8) -> Handle;

/// Lends the scene as a record.
pub(super) fn with_scene_record<T>(
    scene: &Scene,
    lookup: Lookup<'_>,
    act: impl FnOnce(SceneRecord<'_>) -> T,
) -> T {
    let objects = scene.objects();
    let columns: Vec<Vec<Vec<ColumnRecord<'_>>>> = objects
        .iter()
        .map(|object| {
            object
                .geometry
                .blocks
                .iter()
                .map(|b| block_columns(b, object, lookup))
                .collect()
        })
        .collect();
    let blocks: Vec<Vec<BlockRecord<'_>>> = objects
        .iter()
        .zip(&columns)
        .map(|(object, columns)| block_records(object, columns))
        .collect();
    let whole: Vec<Vec<ColumnRecord<'_>>> = objects
        .iter()
        .map(|object| object_columns(object, lookup))
        .collect();
    let records: Vec<ObjectRecord<'_>> = objects
        .iter()
        .zip(&blocks)
        .zip(&whole)
        .map(|((object, blocks), whole)| object_record(object, blocks, whole))
        .collect();
    act(SceneRecord {
        revision: scene.revision().number(),
        objects: RSlice::from_slice(&records),
    })
}

fn object_record<'a>(
    object: &'a Object,
    blocks: &'a [BlockRecord<'a>],
    columns: &'a [ColumnRecord<'a>],
) -> ObjectRecord<'a> {
    let mut flags = ObjectFlags::NONE;
    for (on, flag) in [
        (object.visible, ObjectFlags::VISIBLE),
        (object.selected, ObjectFlags::SELECTED),
        (
            object.geometry.origins.normals == Provenance::Estimated,
            ObjectFlags::TWO_SIDED,
        ),
    ] {
        if on {
            flags |= flag;
        }
    }
    let bounds = &object.geometry.bounds;
    ObjectRecord {
        id: object.id.0,
        name: RStr::from_str(&object.name),
        flags,
        revision: object.revision.number(),
        world_from_object: DMat4::from(object.world_from_local()).to_cols_array(),
        material: MaterialRecord {
            ambient: object.material.ka,
            diffuse: object.material.kd,
            specular: object.material.ks,
            shininess: object.material.shininess,
        },
        bounds: [
            bounds.min.as_vec3().to_array(),
            bounds.max.as_vec3().to_array(),
        ],
        surfel_count: object.geometry.surfel_count as u64,
        blocks: RSlice::from_slice(blocks),
        columns: RSlice::from_slice(columns),
    }
}

fn block_records<'a>(
    object: &'a Object,
    columns: &'a [Vec<ColumnRecord<'a>>],
) -> Vec<BlockRecord<'a>> {
    let mut first_surfel = 0;
    let mut records = Vec::with_capacity(columns.len());
    for (block, columns) in object.geometry.blocks.iter().zip(columns) {
        let columns = RSlice::from_slice(columns);
        records.push(BlockRecord {
            first_surfel,
            surfel_count: block.len() as u32,
            columns,
        });
        first_surfel += block.len() as u64;
    }
    records
}

/// Columns of a block, standard ones first.
pub(super) fn block_columns<'a>(
    block: &'a Block,
    object: &Object,
    lookup: Lookup<'_>,
) -> Vec<ColumnRecord<'a>> {
    let revision = object.geometry.revision.number();
    let standard = [
        Some(record(
            columns::POSITION_RADIUS,
            Scalar::F32,
            4,
            bytemuck::cast_slice(&block.position_radius),
            revision,
            lookup,
        )),
        block.normal.as_ref().map(|c| {
            record(
                columns::NORMAL,
                Scalar::U32,
                1,
                bytemuck::cast_slice(c),
                revision,
                lookup,
            )
        }),
        block.colour.as_ref().map(|c| {
            record(
                columns::COLOUR,
                Scalar::U32,
                1,
                bytemuck::cast_slice(c),
                revision,
                lookup,
            )
        }),
        block.axes.as_ref().map(|c| {
            record(
                columns::AXES,
                Scalar::F32,
                8,
                bytemuck::cast_slice(c),
                revision,
                lookup,
            )
        }),
    ];
    let named = block.named.iter().map(|column: &NamedColumn| {
        record(
            &column.name,
            scalar(column.scalar),
            column.components,
            &column.bytes,
            revision,
            lookup,
        )
    });
    standard.into_iter().flatten().chain(named).collect()
}

fn object_columns<'a>(object: &'a Object, lookup: Lookup<'_>) -> Vec<ColumnRecord<'a>> {
    let geometry = &object.geometry;
    let revision = geometry.revision.number();
    let of_object =
        |name, scalar, components, bytes| record(name, scalar, components, bytes, revision, lookup);
    let mut records = Vec::new();
    if let Some(triangles) = &geometry.triangles {
        let bytes = bytemuck::cast_slice(triangles);
        records.push(of_object(columns::TRIANGLES, Scalar::U32, 3, bytes));
    }
    if let Some(textures) = &geometry.textures {
        let of_triangle = bytemuck::cast_slice(&textures.of_triangle);
        let uvs = bytemuck::cast_slice(&textures.uvs);
        records.extend([
            of_object(columns::TRIANGLE_TEXTURES, Scalar::U32, 1, of_triangle),
            of_object(columns::TRIANGLE_UVS, Scalar::F32, 6, uvs),
        ]);
        let files = textures.pictures.iter();
        records
            .extend(files.map(|file| of_object(columns::TEXTURE_FILE, Scalar::U8, 1, &file.bytes)));
    }
    records
}

fn record<'a>(
    name: &'a str,
    scalar: Scalar,
    components: u32,
    bytes: &'a [u8],
    revision: u64,
    lookup: Lookup<'_>,
) -> ColumnRecord<'a> {
    ColumnRecord {
        buffer: lookup(bytes.as_ptr()),
        ..ColumnRecord::new(name, scalar, components, revision, bytes)
    }
}

fn scalar(scalar: ScalarType) -> Scalar {
    match scalar {
        ScalarType::I8 => Scalar::I8,
        ScalarType::U8 => Scalar::U8,
        ScalarType::I16 => Scalar::I16,
        ScalarType::U16 => Scalar::U16,
        ScalarType::I32 => Scalar::I32,
        ScalarType::U32 => Scalar::U32,
        ScalarType::F32 => Scalar::F32,
        ScalarType::F64 => Scalar::F64,
    }
}
