//! One frame: camera, draws, lights, targets; and what a renderer answers.

use super::commands::CommandListRecord;
use super::descriptors::Format;
use super::objects::CallRef;
use super::scene::SceneRecord;
use super::values::{Handle, SettingRecord, StatisticRecord, open_flags, open_number};
use abi_stable::StableAbi;
use abi_stable::std_types::{RSlice, RSliceMut, RStr, RVec};
use bytemuck::{Pod, Zeroable};

/// The bindings of groups 0 and 1, which every linked shader of `shaders/lib` reads.
pub mod standard_bindings {
    /// Group 0, uniform: [`FrameUniform`](super::FrameUniform).
    pub const FRAME: u32 = 0;
    /// Group 0, uniform with a dynamic offset: [`DrawUniform`](super::DrawUniform).
    pub const DRAW: u32 = 1;
    /// Group 1, read-only storage: `vec4f` a surfel, centre and radius.
    pub const POSITION_RADIUS: u32 = 0;
    /// Group 1, read-only storage: `u32` a surfel, octahedral normal.
    pub const NORMAL: u32 = 1;
    /// Group 1, read-only storage: `u32` a surfel, sRGB colour.
    pub const COLOUR: u32 = 2;
    /// Group 1, read-only storage: two `vec4f` a surfel, tangent half-axes u and v.
    pub const AXES: u32 = 3;
    /// Group 1, read-only storage: `u32` numbers of the selected surfels, if the draw is indexed.
    pub const INDICES: u32 = 4;
    /// Group 1, read-only storage: `u32` counts of indirect draws.
    pub const INDIRECT: u32 = 5;
}

/// A light in view space.
#[repr(C)]
#[derive(StableAbi, Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct LightUniform {
    /// w = 0: xyz is the unit direction towards the light; w = 1: xyz is its position.
    pub position_view: [f32; 4],
    /// Linear RGB times intensity; w unused.
    pub colour: [f32; 4],
}

/// What is the same for all draws of a frame; group 0, binding 0. Matrices are column-major.
#[repr(C)]
#[derive(StableAbi, Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct FrameUniform {
    /// Reversed z: 1 at the near plane, 0 at infinity (perspective) or the far plane (orthographic). Covers the tile.
    pub clip_from_view: [[f32; 4]; 4],
    pub view_from_clip: [[f32; 4]; 4],
    /// Rotation and translation, f32: good for directions, not for positions far from the world's origin.
    pub view_from_world: [[f32; 4]; 4],
    /// Size of the whole image, px.
    pub image_size_px: [f32; 2],
    /// The tile's corner in the image, px.
    pub tile_origin_px: [f32; 2],
    /// Size of the targets, px.
    pub tile_size_px: [f32; 2],
    /// Pixels that one scene unit covers at distance 1 (perspective) or everywhere (orthographic).
    pub pixels_per_unit: f32,
    /// Distance of the near plane, scene units.
    pub near: f32,
    /// Distance of the far plane, scene units; 0 for infinity.
    pub far: f32,
    /// 0 perspective, 1 orthographic.
    pub is_orthographic: u32,
    /// Factor for every surfel's radius and axes; an object's own factor stands in [`DrawUniform`].
    pub radius_scale: f32,
    pub light_count: u32,
    pub frame_index: u32,
    /// Number of the sample of a progressive picture of a still scene.
    pub sample_index: u32,
    pub seed: u32,
    /// [`Interaction`].
    pub interaction: u32,
    /// Linear RGB; w unused.
    pub ambient: [f32; 4],
    pub lights: [LightUniform; 4],
}

open_flags! {
    /// What holds of a draw.
    DrawFlags {
        /// Group 1 has normals.
        HAS_NORMAL = 1,
        /// Group 1 has colours.
        HAS_COLOUR = 2,
        /// Group 1 has tangent axes.
        HAS_AXES = 4,
        /// Surfel numbers come from the index buffer.
        INDEXED = 8,
        /// The count comes from the indirect buffer; `count` is its upper bound.
        INDIRECT = 16,
        /// Normals have no outside: light the side that faces the eye.
        TWO_SIDED = 32,
        /// The object is selected.
        SELECTED = 64,
        /// The surfels are inner nodes of a level-of-detail structure.
        NODES = 128,
    }
}

/// What belongs to one draw; group 0, binding 1, at [`DrawRecord::uniform_offset`]. Matrices are column-major.
#[repr(C)]
#[derive(StableAbi, Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct DrawUniform {
    /// Computed in f64 by the host, so that objects far from the world's origin do not jitter.
    pub view_from_object: [[f32; 4]; 4],
    pub object_from_view: [[f32; 4]; 4],
    /// For normals: the inverse transpose of the upper 3×3. The last element is the object's radius scale, 1 unless the
    /// user says otherwise: half-axes in object space = columns · this · the frame's `radius_scale`.
    pub view_from_object_normal: [[f32; 4]; 4],
    /// ka, kd, ks, shininess.
    pub material: [f32; 4],
    /// Largest scale of `view_from_object` times the object's radius scale: radius in view space = radius · this · the
    /// frame's `radius_scale`.
    pub radius_factor: f32,
    /// First surfel, or first entry of the index buffer.
    pub first: u32,
    pub count: u32,
    /// A surfel's id in the `id` target = `id_base` + its number in the block. 0 is 'nothing'.
    pub id_base: u32,
    /// [`DrawFlags`].
    pub flags: u32,
    /// Entry of the indirect buffer.
    pub indirect_index: u32,
    /// Level in a structure's tree, 0 the root; for the `lod` target.
    pub level: f32,
    /// Object-space error of the draw's surfels, scene units; 0 for leaves.
    pub error: f32,
    /// Linear RGBA where the scene has no colour.
    pub default_colour: [f32; 4],
}

impl DrawUniform {
    /// The object's radius scale.
    pub fn object_radius_scale(&self) -> f32 {
        self.view_from_object_normal[3][3]
    }
}

/// One draw of the selection.
#[repr(C)]
#[derive(StableAbi, Clone, Copy, Debug)]
pub struct DrawRecord<'a> {
    /// Number of the object in the scene.
    pub object: u32,
    /// The columns on the CPU: a block of the scene or of the structure.
    pub block: super::scene::BlockRecord<'a>,
    pub uniform: DrawUniform,
    /// Dynamic offset of `uniform` in group 0; bytes.
    pub uniform_offset: u32,
    /// Group 1.
    pub columns_group: Handle,
    /// The selected surfels' numbers on the CPU, or empty for the range `first .. first + count`.
    pub indices: RSlice<'a, u32>,
    /// The buffer of the count, if indirect.
    pub indirect_buffer: Handle,
}

open_number! {
    /// What the user is doing.
    Interaction(u32) { STILL = 0, MOVING = 1, HELD = 2 }
}

open_number! {
    /// What the picture is for.
    Purpose(u32) { INTERACTIVE = 0, EXPORT = 1, COMPARE = 2 }
}

open_flags! {
    /// What changed since the view's last frame.
    FrameChanges { CAMERA = 1, SETTINGS = 2, SIZE = 4, SELECTION = 8, SCENE = 16, LIGHTS = 32, TARGETS = 64 }
}

/// One requested target.
#[repr(C)]
#[derive(StableAbi, Clone, Copy, Debug)]
pub struct TargetRecord<'a> {
    pub key: RStr<'a>,
    pub format: Format,
    /// The texture, usable as attachment, storage (where the format allows) and sampled; none on the CPU path.
    pub texture: Handle,
}

/// One requested target on the CPU path, cleared to its clear value.
#[repr(C)]
#[derive(StableAbi, Debug)]
pub struct PlaneRecord<'a> {
    pub key: RStr<'a>,
    /// [`Format::RGBA32_FLOAT`] (colour, normal), [`Format::R32_FLOAT`] (depth and others) or [`Format::R32_UINT`].
    pub format: Format,
    /// Bytes from row to row.
    pub row_stride: u32,
    pub bytes: RSliceMut<'a, u8>,
}

/// All that a renderer is given for one frame.
#[repr(C)]
#[derive(StableAbi)]
pub struct FrameRecord<'a> {
    pub uniform: FrameUniform,
    /// Group 0.
    pub frame_group: Handle,
    /// Eye and axes in world coordinates, column-major, f64.
    pub world_from_view: [f64; 16],
    /// Targets' size, px.
    pub size_px: [u32; 2],
    pub scene: SceneRecord<'a>,
    pub draws: RSlice<'a, DrawRecord<'a>>,
    pub settings: RSlice<'a, SettingRecord<'a>>,
    /// Ids of the action settings pressed since the last frame.
    pub actions: RSlice<'a, RStr<'a>>,
    pub targets: RSlice<'a, TargetRecord<'a>>,
    /// CPU renderers: the same targets as planes.
    pub planes: RSliceMut<'a, PlaneRecord<'a>>,
    pub interaction: Interaction,
    pub purpose: Purpose,
    pub changes: FrameChanges,
    /// Ids of the settings that changed.
    pub changed_settings: RSlice<'a, RStr<'a>>,
    pub thread_count: u32,
    pub call: CallRef<'a>,
}

/// What a view answers.
#[repr(C)]
#[derive(StableAbi, Debug)]
pub struct OutcomeRecord {
    /// 1: done; less: the picture refines if asked again while nothing changes.
    pub progress: f32,
    pub commands: CommandListRecord,
    pub statistics: RVec<StatisticRecord>,
}

/// What a structure is asked: which surfels for this view?
#[repr(C)]
#[derive(StableAbi)]
pub struct SelectRecord<'a> {
    pub uniform: FrameUniform,
    pub world_from_view: [f64; 16],
    pub scene: SceneRecord<'a>,
    /// One per object of the scene, as if all of it were drawn.
    pub objects: RSlice<'a, DrawUniform>,
    pub settings: RSlice<'a, SettingRecord<'a>>,
    pub interaction: Interaction,
    pub call: CallRef<'a>,
}

open_number! {
    /// Whose block a draw takes.
    BlockSource(u32) { SCENE = 0, STRUCTURE = 1 }
}

/// One draw that a structure selects.
#[repr(C)]
#[derive(StableAbi, Clone, Debug)]
pub struct SelectedDrawRecord {
    pub object: u32,
    pub source: BlockSource,
    /// Number of the block in the object, or in the structure's own list.
    pub block: u32,
    pub first: u32,
    pub count: u32,
    /// Surfel numbers in the block; empty for the range.
    pub indices: RVec<u32>,
    /// Instead of `indices`: a buffer of the structure with them (STORAGE), already filled.
    pub index_buffer: Handle,
    /// A buffer of the structure (STORAGE) that holds the count as `u32` at `indirect_offset`; `count` bounds it.
    pub indirect_buffer: Handle,
    pub indirect_offset: u64,
    pub error: f32,
    pub level: f32,
}

/// What a structure answers.
#[repr(C)]
#[derive(StableAbi, Debug)]
pub struct SelectionRecord {
    pub draws: RVec<SelectedDrawRecord>,
    /// Run before the renderer's (culling in compute, uploads).
    pub commands: CommandListRecord,
    pub statistics: RVec<StatisticRecord>,
    /// 1: settled; less: ask again.
    pub progress: f32,
}

/// A block that a structure brings: inner nodes are surfels too. Only the standard columns.
#[repr(C)]
#[derive(StableAbi, Clone, Debug)]
pub struct StructureBlockRecord<'a> {
    /// Number of the object whose coordinates the block uses.
    pub object: u32,
    pub surfel_count: u32,
    pub columns: RVec<super::scene::ColumnRecord<'a>>,
}
