//! One frame: camera, selection, settings, targets; and what the renderer gives back.

use crate::abi::{
    self, DrawFlags, DrawUniform, Format, FrameChanges, FrameUniform, Interaction, PlaneRecord,
    Purpose, StatisticRecord,
};
use crate::gpu::{GroupRef, Recorder, TextureRef};
use crate::host::{Call, Progress};
use crate::scene::{Block, Object, Scene};
use crate::settings::Settings;
use abi_stable::std_types::{RSliceMut, RStr};
use glam::DMat4;

/// What a renderer says of the picture it gave.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outcome {
    /// The picture is as good as it gets.
    Done,
    /// The picture refines if it is asked again while nothing changes; 0 to 1.
    Refining(f32),
}

/// All that a view is given for one frame.
pub struct Frame<'a> {
    uniform: &'a FrameUniform,
    group: GroupRef,
    world_from_view: DMat4,
    size_px: [u32; 2],
    scene: Scene<'a>,
    draws: &'a [abi::DrawRecord<'a>],
    settings: Settings<'a>,
    actions: &'a [RStr<'a>],
    targets: &'a [abi::TargetRecord<'a>],
    planes: Vec<Option<Plane<'a>>>,
    interaction: Interaction,
    purpose: Purpose,
    changes: FrameChanges,
    changed_settings: &'a [RStr<'a>],
    thread_count: usize,
    call: &'a dyn Call,
    recorder: Recorder,
    statistics: Vec<StatisticRecord>,
}

impl<'a> Frame<'a> {
    /// Takes the border's record apart, so that one short lifetime is left of it.
    pub(crate) fn new<'f: 'a>(record: &'a mut abi::FrameRecord<'f>) -> Self {
        let planes = core::mem::take(&mut record.planes).into_mut_slice();
        let record: &'a abi::FrameRecord<'f> = record;
        Self {
            uniform: &record.uniform,
            group: GroupRef(record.frame_group),
            world_from_view: DMat4::from_cols_array(&record.world_from_view),
            size_px: record.size_px,
            scene: Scene::new(record.scene),
            draws: record.draws.as_slice(),
            settings: Settings::new(record.settings.as_slice()),
            actions: record.actions.as_slice(),
            targets: record.targets.as_slice(),
            planes: planes
                .iter_mut()
                .map(|plane| Some(Plane::new(plane)))
                .collect(),
            interaction: record.interaction,
            purpose: record.purpose,
            changes: record.changes,
            changed_settings: record.changed_settings.as_slice(),
            thread_count: record.thread_count.max(1) as usize,
            call: &record.call,
            recorder: Recorder::new(),
            statistics: Vec::new(),
        }
    }

    /// Camera, lights and counters, as shaders read them in group 0.
    pub fn uniform(&self) -> &'a FrameUniform {
        self.uniform
    }

    /// Group 0, to be set with each draw's [`Draw::uniform_offset`].
    pub fn group(&self) -> GroupRef {
        self.group
    }

    /// World coordinates from view coordinates, f64.
    pub fn world_from_view(&self) -> DMat4 {
        self.world_from_view
    }

    /// Size of the targets: of the whole image, or of a tile of it; px.
    pub fn size_px(&self) -> [u32; 2] {
        self.size_px
    }

    /// The scene. Draw [`Frame::selection`], not this.
    pub fn scene(&self) -> Scene<'a> {
        self.scene
    }

    /// What to draw, in order. Who made the selection (all of the scene, or a level-of-detail structure) is not told.
    pub fn selection(&self) -> impl ExactSizeIterator<Item = Draw<'a>> + use<'a> {
        let scene = self.scene;
        self.draws.iter().map(move |record| Draw { record, scene })
    }

    /// The settings' values.
    pub fn settings(&self) -> Settings<'a> {
        self.settings
    }

    /// Whether the action setting of this id was pressed since the last frame.
    pub fn pressed(&self, id: &str) -> bool {
        self.actions.iter().any(|action| action.as_str() == id)
    }

    /// The target of this key, if it was asked for. The host has cleared it.
    pub fn target(&self, key: &str) -> Option<Target> {
        let record = self
            .targets
            .iter()
            .find(|record| record.key.as_str() == key)?;
        record.texture.is_some().then_some(Target {
            texture: TextureRef(record.texture),
            format: record.format,
        })
    }

    /// Keys of all targets asked for, in the host's order.
    pub fn target_keys(&self) -> impl ExactSizeIterator<Item = &'a str> + use<'a> {
        self.targets.iter().map(|record| record.key.as_str())
    }

    /// CPU renderers: takes the plane of this key, if it was asked for. The host has cleared it.
    pub fn take_plane(&mut self, key: &str) -> Option<Plane<'a>> {
        self.planes
            .iter_mut()
            .find(|plane| plane.as_ref().is_some_and(|plane| plane.key == key))?
            .take()
    }

    /// What the user is doing.
    pub fn interaction(&self) -> Interaction {
        self.interaction
    }

    /// What the picture is for.
    pub fn purpose(&self) -> Purpose {
        self.purpose
    }

    /// What changed since this view's last frame.
    pub fn changes(&self) -> FrameChanges {
        self.changes
    }

    /// Whether the setting of this id changed since this view's last frame.
    pub fn setting_changed(&self, id: &str) -> bool {
        self.changed_settings
            .iter()
            .any(|setting| setting.as_str() == id)
    }

    /// Threads that the renderer may keep busy.
    pub fn thread_count(&self) -> usize {
        self.thread_count
    }

    /// Whether the frame's deadline has passed or the frame is no longer wanted: return what there is.
    pub fn should_stop(&self) -> bool {
        self.call.stop()
    }

    /// Tells how far a long frame is.
    pub fn progress(&self) -> Progress<'a> {
        Progress::new(self.call)
    }

    /// Hands recorded commands to the host, which runs them after `render` returns, in the order of submission.
    #[expect(
        clippy::needless_pass_by_value,
        reason = "what is submitted is handed over: recording on in it would reach nobody"
    )]
    pub fn submit(&mut self, commands: Recorder) {
        self.recorder.append(&commands);
    }

    /// Reports a count or a time: a key of [`crate::statistics`] or one's own.
    pub fn report(&mut self, key: &str, value: f64) {
        self.statistics.push(StatisticRecord {
            key: key.into(),
            value,
        });
    }

    pub(crate) fn into_outcome(self, outcome: Outcome) -> abi::OutcomeRecord {
        let progress = match outcome {
            Outcome::Done => 1.0,
            Outcome::Refining(progress) => progress.clamp(0.0, 0.999),
        };
        abi::OutcomeRecord {
            progress,
            commands: self.recorder.into_record(),
            statistics: self.statistics.into(),
        }
    }
}

/// A target's texture: attach it to a pass, bind it, or copy to it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Target {
    /// The texture.
    pub texture: TextureRef,
    /// Its format.
    pub format: Format,
}

/// One draw of the selection: a block, and which of its surfels.
#[derive(Clone, Copy)]
pub struct Draw<'a> {
    record: &'a abi::DrawRecord<'a>,
    scene: Scene<'a>,
}

impl<'a> Draw<'a> {
    /// Object matrices, material, range and ids, as shaders read them in group 0.
    pub fn uniform(&self) -> &'a DrawUniform {
        &self.record.uniform
    }

    /// Dynamic offset of this draw in group 0.
    pub fn uniform_offset(&self) -> u32 {
        self.record.uniform_offset
    }

    /// Group 1: the columns.
    pub fn columns(&self) -> GroupRef {
        GroupRef(self.record.columns_group)
    }

    /// How many surfels (at most, if the device counts them): the number of shader invocations or instances.
    pub fn count(&self) -> u32 {
        self.record.uniform.count
    }

    /// What holds of the draw.
    pub fn flags(&self) -> DrawFlags {
        DrawFlags(self.record.uniform.flags)
    }

    /// The object that the surfels belong to.
    pub fn object(&self) -> Option<Object<'a>> {
        self.scene.object(self.record.object)
    }

    /// The columns on the CPU.
    pub fn block(&self) -> Block<'a> {
        Block::new(self.record.block)
    }

    /// Numbers of the drawn surfels within the block. Empty if only the device knows them.
    pub fn surfels(&self) -> impl Iterator<Item = u32> + use<'a> {
        let DrawUniform { first, count, .. } = self.record.uniform;
        let indices = self.record.indices.as_slice();
        let on_device = self.flags().contains(DrawFlags::INDEXED) && indices.is_empty();
        let range = if on_device {
            0..0
        } else {
            first..first.saturating_add(count)
        };
        let block_count = self.record.block.surfel_count;
        range
            .filter_map(move |entry| {
                if indices.is_empty() {
                    Some(entry)
                } else {
                    indices.get(entry as usize).copied()
                }
            })
            .filter(move |&surfel| surfel < block_count)
    }
}

/// A target on the CPU: rows from the top, with a stride.
pub struct Plane<'a> {
    key: &'a str,
    /// Format of the pixels.
    pub format: Format,
    row_stride: usize,
    bytes: &'a mut [u8],
}

impl<'a> Plane<'a> {
    fn new<'f: 'a>(record: &'a mut PlaneRecord<'f>) -> Self {
        let bytes = core::mem::replace(&mut record.bytes, RSliceMut::from_mut_slice(&mut []))
            .into_mut_slice();
        Self {
            key: record.key.as_str(),
            format: record.format,
            row_stride: record.row_stride as usize,
            bytes,
        }
    }

    /// Its rows as scalars: `f32`, `[f32; 4]` or `u32` as the format says. Rows may be filled in parallel.
    pub fn rows<T: bytemuck::Pod>(&mut self) -> impl Iterator<Item = &mut [T]> {
        let size = size_of::<T>();
        self.bytes
            .chunks_exact_mut(self.row_stride.max(1))
            .map(move |row| {
                let whole = row.len() / size * size;
                // The host aligns planes to 16 bytes, and strides to 4.
                bytemuck::try_cast_slice_mut(&mut row[..whole]).unwrap_or_default()
            })
    }
}
