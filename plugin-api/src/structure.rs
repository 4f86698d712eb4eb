//! What the author of a level-of-detail structure writes: which surfels, at which level, for this view?

use crate::abi::{
    self, BlockSource, ColumnRecord, DrawUniform, FrameUniform, Handle, Interaction, ScalarType,
};
use crate::columns;
use crate::error::Result;
use crate::gpu::{Buffer, Recorder};
use crate::host::{Call, Host, Progress};
use crate::scene::{Changes, Scene};
use crate::settings::Settings;
use glam::DMat4;

/// A structure built for one state of the scene.
pub trait Structure: Sized + Send + Sync + 'static {
    /// What belongs to one viewport.
    type Selector: Selector<Self>;

    /// Builds the structure. Thread: worker; cancellable.
    fn prepare(
        host: &Host,
        scene: Scene<'_>,
        previous: Option<(&Self, Changes<'_>)>,
        settings: Settings<'_>,
        progress: &Progress<'_>,
    ) -> Result<Self>;

    /// The structure's own blocks (inner nodes are surfels too), which the host copies. Thread: worker.
    fn blocks(&self) -> Vec<OwnBlock<'_>> {
        Vec::new()
    }

    /// Makes what one viewport needs. Thread: render or worker.
    fn selector(&self, host: &Host) -> Result<Self::Selector>;
}

/// A structure in one viewport.
pub trait Selector<S>: Send + 'static {
    /// Finds the LOD cut. Thread: render.
    fn select(&mut self, structure: &S, query: &Query<'_>) -> Result<Selection>;
}

/// A block that a structure brings.
#[derive(Clone, Copy, Default)]
pub struct OwnBlock<'a> {
    /// Number of the object in whose coordinates the surfels are.
    pub object: u32,
    /// Centre and radius; object coordinates, scene units.
    pub position_radius: &'a [[f32; 4]],
    /// Octahedral normals.
    pub normals: Option<&'a [u32]>,
    /// Packed sRGB colours.
    pub colours: Option<&'a [u32]>,
    /// Tangent half-axes.
    pub axes: Option<&'a [[f32; 8]]>,
}

/// The view for which surfels are sought.
pub struct Query<'a> {
    uniform: &'a FrameUniform,
    world_from_view: DMat4,
    scene: Scene<'a>,
    objects: &'a [DrawUniform],
    settings: Settings<'a>,
    interaction: Interaction,
    call: &'a dyn Call,
}

/// What a selector answers.
#[derive(Default)]
pub struct Selection {
    draws: Vec<abi::SelectedDrawRecord>,
    recorder: Recorder,
    statistics: Vec<abi::StatisticRecord>,
}

/// Which block a draw takes its surfels from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// A block of the scene's object, by number.
    Scene(u32),
    /// One of the structure's own, by its place in [`Structure::blocks`].
    Own(u32),
}

impl<'a> Query<'a> {
    /// Takes the border's record apart, so that one short lifetime is left of it.
    pub(crate) fn new<'f: 'a>(record: &'a abi::SelectRecord<'f>) -> Self {
        Self {
            uniform: &record.uniform,
            world_from_view: DMat4::from_cols_array(&record.world_from_view),
            scene: Scene::new(record.scene),
            objects: record.objects.as_slice(),
            settings: Settings::new(record.settings.as_slice()),
            interaction: record.interaction,
            call: &record.call,
        }
    }

    /// Camera and image size.
    pub fn uniform(&self) -> &'a FrameUniform {
        self.uniform
    }

    /// World coordinates from view coordinates, f64.
    pub fn world_from_view(&self) -> DMat4 {
        self.world_from_view
    }

    /// The scene.
    pub fn scene(&self) -> Scene<'a> {
        self.scene
    }

    /// View from object and the rest, one for each object of the scene.
    pub fn objects(&self) -> &'a [DrawUniform] {
        self.objects
    }

    /// The settings' values.
    pub fn settings(&self) -> Settings<'a> {
        self.settings
    }

    /// What the user is doing.
    pub fn interaction(&self) -> Interaction {
        self.interaction
    }

    /// Cancel and progress of the call.
    pub fn progress(&self) -> Progress<'a> {
        Progress::new(self.call)
    }
}

impl Selection {
    /// Nothing selected.
    pub fn new() -> Self {
        Self::default()
    }

    /// Selects a range of surfels of a block.
    ///
    /// `level` counts from the root; `error` is the object-space error, scene units, 0 for leaves.
    pub fn range(
        &mut self,
        object: u32,
        source: Source,
        range: core::ops::Range<u32>,
        level: f32,
        error: f32,
    ) {
        let (source, block) = split(source);
        self.draws.push(abi::SelectedDrawRecord {
            object,
            source,
            block,
            first: range.start,
            count: range.end.saturating_sub(range.start),
            indices: Vec::new().into(),
            index_buffer: Handle::NONE,
            indirect_buffer: Handle::NONE,
            indirect_offset: 0,
            error,
            level,
        });
    }

    /// Selects surfels of a block by their numbers.
    pub fn surfels(
        &mut self,
        object: u32,
        source: Source,
        surfels: Vec<u32>,
        level: f32,
        error: f32,
    ) {
        self.range(object, source, 0..surfels.len() as u32, level, error);
        if let Some(draw) = self.draws.last_mut() {
            draw.indices = surfels.into();
        }
    }

    /// Selects surfels by numbers that a buffer of the structure holds, at most `count`; how many of them, another
    /// buffer may say, as a `u32` at a byte offset.
    pub fn surfels_on_device(
        &mut self,
        object: u32,
        source: Source,
        numbers: &Buffer,
        count: u32,
        counter: Option<(&Buffer, u64)>,
    ) {
        self.range(object, source, 0..count, 0.0, 0.0);
        if let Some(draw) = self.draws.last_mut() {
            draw.index_buffer = numbers.handle();
            if let Some((buffer, offset)) = counter {
                draw.indirect_buffer = buffer.handle();
                draw.indirect_offset = offset;
            }
        }
    }

    /// Commands to run before the renderer's.
    pub fn submit(&mut self, commands: &Recorder) {
        self.recorder.append(commands);
    }

    /// Reports a count or a time.
    pub fn report(&mut self, key: &str, value: f64) {
        self.statistics.push(abi::StatisticRecord {
            key: key.into(),
            value,
        });
    }

    pub(crate) fn into_record(self) -> abi::SelectionRecord {
        abi::SelectionRecord {
            draws: self.draws.into(),
            commands: self.recorder.into_record(),
            statistics: self.statistics.into(),
            progress: 1.0,
        }
    }
}

fn split(source: Source) -> (BlockSource, u32) {
    match source {
        Source::Scene(block) => (BlockSource::SCENE, block),
        Source::Own(block) => (BlockSource::STRUCTURE, block),
    }
}

/// The columns of own blocks as border records; lent by the adapter while the host copies them.
pub(crate) fn own_columns<'a>(block: &OwnBlock<'a>) -> Vec<ColumnRecord<'a>> {
    fn column<'a, T: bytemuck::NoUninit>(
        name: &'static str,
        content: &'a [T],
        scalar: ScalarType,
        scalar_bytes: usize,
    ) -> ColumnRecord<'a> {
        let components = (size_of::<T>() / scalar_bytes) as u32;
        ColumnRecord::new(name, scalar, components, 0, content)
    }
    let OwnBlock {
        position_radius,
        normals,
        colours,
        axes,
        ..
    } = *block;
    [
        Some(column(
            columns::POSITION_RADIUS,
            position_radius,
            ScalarType::F32,
            4,
        )),
        normals.map(|content| column(columns::NORMAL, content, ScalarType::U32, 4)),
        colours.map(|content| column(columns::COLOUR, content, ScalarType::U32, 4)),
        axes.map(|content| column(columns::AXES, content, ScalarType::F32, 4)),
    ]
    .into_iter()
    .flatten()
    .collect()
}
