//! The cut of a part made on the device: the tree's levels one after the other, each asking the children of what the one
//! above found too large.

use crate::part::Part;
use crate::passes::{Passes, UNIFORM_BYTES};
use crate::uniforms::STRIDE;
use pointstage_plugin_api::Result;
use pointstage_plugin_api::abi::commands::CopyBufferToBuffer;
use pointstage_plugin_api::abi::{self, BufferUsage, Handle};
use pointstage_plugin_api::gpu::{
    AsHandle as _, BindGroup, Buffer, Gpu, GroupRef, Recorder, Ticket,
};
use pointstage_pop_tree::cut::{View as CutView, ViewWords};
use pointstage_visibility::group_size;
use std::sync::Arc;

/// Words before a list's entries.
pub(crate) const LIST_HEAD: u32 = 2;
/// Bits of a queue's entry that hold the node; above are what is open for its children. `NODE_BITS` in the shader.
pub(crate) const NODE_BITS: u32 = 25;
/// Words of the arguments: `shaders/pop/select_draws.wesl`.
const ARGUMENT_WORDS: u64 = 14;
/// Words that come back: asked, culled, splats, triangles.
const TALLY_WORDS: u64 = 4;

/// What a selection found, a frame or more ago.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Tally {
    pub(crate) asked: u32,
    pub(crate) culled: u32,
    pub(crate) splats: u32,
    pub(crate) triangles: u32,
}

/// Buffers of a part's selection in one viewport.
pub(crate) struct DeviceCut {
    part: Arc<Part>,
    judge: Buffer,
    counts: Buffer,
    queue: Buffer,
    found: Buffer,
    found_arguments: Buffer,
    /// Arguments of the indirect draws: a copy, since a buffer cannot be written and give arguments at once.
    pub(crate) arguments: Buffer,
    tally: Buffer,
    _levels: Buffer,
    select_group: BindGroup,
    draws_group: BindGroup,
    uniforms: Option<Uniforms>,
    ticket: Option<Ticket>,
    pub(crate) last: Option<Tally>,
}

/// Groups that hold the view's uniforms.
struct Uniforms {
    buffer: Handle,
    /// Group 2 of the selection.
    alone: BindGroup,
    /// Group 2 of the draws.
    with_list: BindGroup,
}

impl DeviceCut {
    /// Whether a part's numbers fit the queue.
    pub(crate) fn fits(part: &Part) -> bool {
        part.tree.first_leaf() < 1 << NODE_BITS
    }

    /// # Errors
    /// If the device refuses a resource.
    pub(crate) fn new(passes: &Passes, part: &Arc<Part>) -> Result<Self> {
        let gpu = &passes.gpu;
        let tree = &part.tree;
        let storage = BufferUsage::STORAGE | BufferUsage::COPY_DST;
        let readable = storage | BufferUsage::COPY_SRC;
        let level_count = tree.level_starts.len();
        let mut levels = vec![0_u32; level_count.max(1) * STRIDE as usize / 4];
        for (level, words) in levels.chunks_exact_mut(STRIDE as usize / 4).enumerate() {
            let start = |level: usize| tree.level_starts.get(level).copied().unwrap_or_default();
            words[..4].copy_from_slice(&[
                level as u32,
                start(level),
                start(level + 1),
                capacity(part),
            ]);
        }
        let levels = gpu.buffer_with("levels", BufferUsage::UNIFORM, &levels)?;
        let judge = gpu.buffer(
            "judge",
            size_of::<ViewWords>() as u64,
            BufferUsage::UNIFORM | BufferUsage::COPY_DST,
        )?;
        let counts = gpu.buffer("counts", 4 * (3 + level_count as u64), readable)?;
        let queue = gpu.buffer("queue", 4 * u64::from(tree.first_leaf().max(1)), storage)?;
        let found = gpu.buffer(
            "found",
            4 * (u64::from(LIST_HEAD) + u64::from(capacity(part))),
            readable,
        )?;
        let found_arguments = gpu.buffer("found arguments", 4 * ARGUMENT_WORDS, readable)?;
        let arguments = gpu.buffer(
            "arguments",
            4 * ARGUMENT_WORDS,
            BufferUsage::INDIRECT | BufferUsage::COPY_DST,
        )?;
        let tally = gpu.buffer("tally", 4 * TALLY_WORDS, readable)?;
        let entries = [
            whole(0, &judge),
            whole(1, &counts),
            whole(2, &queue),
            whole(3, &found),
            abi::BindingRecord {
                size: UNIFORM_BYTES,
                ..whole(4, &levels)
            },
        ];
        let select_group = gpu.bind_group_from(&abi::BindGroupDescriptor {
            label: "selection".into(),
            layout: passes.select_layout.handle(),
            entries: entries.as_slice().into(),
        })?;
        let draws_group = gpu.bind_group(
            "draws",
            &passes.draws_layout,
            &[(0, &found), (1, &found_arguments)],
        )?;
        Ok(Self {
            part: Arc::clone(part),
            judge,
            counts,
            queue,
            found,
            found_arguments,
            arguments,
            tally,
            _levels: levels,
            select_group,
            draws_group,
            uniforms: None,
            ticket: None,
            last: None,
        })
    }

    /// Whether the buffers are this part's.
    pub(crate) fn is_of(&self, part: &Arc<Part>) -> bool {
        Arc::ptr_eq(&self.part, part)
    }

    /// Place of the first triangle in the list; the others go backwards from there.
    pub(crate) fn triangles_first(&self) -> u32 {
        LIST_HEAD + capacity(&self.part) - 1
    }

    /// Takes what the device counted, if it has arrived.
    pub(crate) fn look(&mut self) -> Result<()> {
        let Some(ticket) = &self.ticket else {
            return Ok(());
        };
        if let Some(bytes) = ticket.poll()? {
            self.ticket = None;
            let words: Vec<u32> = bytes
                .chunks_exact(4)
                .filter_map(|word| word.try_into().ok())
                .map(u32::from_ne_bytes)
                .collect();
            if let [asked, culled, splats, triangles] = words[..] {
                self.last = Some(Tally {
                    asked,
                    culled,
                    splats,
                    triangles,
                });
            }
        }
        Ok(())
    }

    /// Group 2 of the draws, with these uniforms.
    pub(crate) fn ready_uniforms(
        &mut self,
        passes: &Passes,
        uniforms: &Buffer,
    ) -> Result<BindGroup> {
        if let Some(ready) = &self.uniforms
            && ready.buffer == uniforms.as_handle()
        {
            return Ok(ready.with_list.clone());
        }
        let uniform = abi::BindingRecord {
            size: UNIFORM_BYTES,
            ..whole(0, uniforms)
        };
        let group = |layout, entries: &[abi::BindingRecord]| {
            passes.gpu.bind_group_from(&abi::BindGroupDescriptor {
                label: "list".into(),
                layout,
                entries: entries.into(),
            })
        };
        let with_list = group(
            passes.list_layout.handle(),
            &[uniform, whole(1, &self.found)],
        )?;
        let alone = group(passes.uniform_layout.handle(), &[uniform])?;
        self.uniforms = Some(Uniforms {
            buffer: uniforms.as_handle(),
            alone,
            with_list: with_list.clone(),
        });
        Ok(with_list)
    }

    /// Records the selection.
    ///
    /// * `open`: what the root leaves open for its children.
    /// * `uniform`: which of the view's uniforms is the part's.
    ///
    /// # Errors
    /// If the device refuses a shader or a write.
    pub(crate) fn record(
        &mut self,
        passes: &Passes,
        recorder: &mut Recorder,
        view: &CutView,
        open: u32,
        (frame, draw_offset, uniform): (GroupRef, u32, u32),
    ) -> Result<()> {
        let gpu: &Gpu = &passes.gpu;
        let Some(uniforms) = &self.uniforms else {
            return Ok(());
        };
        let [level_kernel, draws_kernel] = passes.select()?;
        let tree = &self.part.tree;
        gpu.write(&self.judge, 0, &[view.words()])?;
        // The root waits on the first level; it was asked on the CPU.
        let mut counts = vec![0_u32; 3 + tree.level_starts.len()];
        (counts[0], counts[2]) = (1, 1);
        gpu.write(&self.counts, 0, &counts)?;
        gpu.write(&self.queue, 0, &[open << NODE_BITS])?;
        gpu.write(&self.found, 0, &[0_u32; 2])?;
        let mut pass = recorder.compute_pass("selection");
        pass.set_pipeline(&level_kernel);
        pass.set_bind_group(0, &frame, &[draw_offset]);
        pass.set_bind_group(1, &self.part.group, &[]);
        pass.set_bind_group(2, &uniforms.alone, &[uniform * STRIDE]);
        for (level, pair) in (0_u32..).zip(tree.level_starts.windows(2)) {
            pass.set_bind_group(3, &self.select_group, &[level * STRIDE]);
            pass.dispatch_linear(pair[1] - pair[0], group_size(gpu));
        }
        drop(pass);
        let mut pass = recorder.compute_pass("draws of the selection");
        pass.set_pipeline(&draws_kernel);
        pass.set_bind_group(0, &self.draws_group, &[]);
        pass.dispatch([1, 1, 1]);
        drop(pass);
        let mut copy = |source: &Buffer, target: &Buffer, target_word: u64, words: u64| {
            recorder.push(CopyBufferToBuffer {
                source: source.as_handle(),
                source_offset: 0,
                target: target.as_handle(),
                target_offset: 4 * target_word,
                size: 4 * words,
            });
        };
        copy(&self.found_arguments, &self.arguments, 0, ARGUMENT_WORDS);
        if self.ticket.is_none() {
            copy(&self.counts, &self.tally, 0, 2);
            copy(&self.found, &self.tally, 2, 2);
            let ticket = gpu.ticket()?;
            recorder.read_back(&self.tally, 0, 4 * TALLY_WORDS, &ticket);
            self.ticket = Some(ticket);
        }
        Ok(())
    }
}

/// Entries of the list: a cut has no more than one a triangle.
fn capacity(part: &Part) -> u32 {
    part.triangle_count.max(1)
}

/// A binding of a buffer from its start.
fn whole(binding: u32, buffer: &Buffer) -> abi::BindingRecord {
    abi::BindingRecord {
        binding,
        resource: buffer.as_handle(),
        ..Default::default()
    }
}
