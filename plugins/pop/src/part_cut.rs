//! The last cut of a part in a viewport, and the list of it on the device.

use crate::device_cut::{DeviceCut, LIST_HEAD};
use crate::part::Part;
use crate::passes::{Passes, UNIFORM_BYTES};
use crate::settings::Walk;
use crate::took::Took;
use pointstage_plugin_api::Result;
use pointstage_plugin_api::abi::{self, BufferUsage, Handle};
use pointstage_plugin_api::gpu::{AsHandle as _, BindGroup, Buffer, GroupRef, Recorder};
use pointstage_pop_tree::cut::{CoherentCut, Cut, Keep, Root, View as CutView};
use std::sync::Arc;
use std::time::Instant;

/// A part's last cut in this view.
#[derive(Default)]
pub(crate) struct PartCut {
    pub(crate) part: Option<Arc<Part>>,
    pub(crate) coherent: CoherentCut,
    pub(crate) cut: Cut,
    pub(crate) list: Option<List>,
    /// Whether splats are in the list: not if the CPU draws them.
    pub(crate) lists_splats: bool,
    pub(crate) device: Option<DeviceCut>,
    /// The view and what the root leaves open, if the device makes this frame's cut.
    pub(crate) on_device: Option<(CutView, u32)>,
}

/// The list on the device.
pub(crate) struct List {
    pub(crate) bytes: u64,
    /// None if it is the device's own.
    pub(crate) buffer: Option<Buffer>,
    pub(crate) uniforms: Handle,
    pub(crate) group: BindGroup,
}

impl PartCut {
    /// The part's cut for a view.
    pub(crate) fn update(
        &mut self,
        part: &Arc<Part>,
        view: &CutView,
        keep: Keep,
        thread_count: usize,
        took: &mut Took,
    ) -> &Cut {
        let is_same = self
            .part
            .as_ref()
            .is_some_and(|last| Arc::ptr_eq(last, part));
        if !is_same {
            self.part = Some(Arc::clone(part));
            self.coherent.forget();
        }
        let start = Instant::now();
        self.coherent
            .update(&part.tree, view, keep, thread_count, &mut self.cut);
        took.selection += start.elapsed();
        took.splats += self.cut.splats.len() as u64;
        took.triangles += self.cut.triangles.len() as u64;
        took.evaluated += self.cut.counts.evaluated;
        took.culled += self.cut.counts.culled;
        &self.cut
    }

    /// Whether the device makes this frame's cut; then its buffers are ready.
    pub(crate) fn starts_on_device(
        &mut self,
        passes: &Passes,
        part: &Arc<Part>,
        view: &CutView,
        walk: Walk,
    ) -> Result<bool> {
        self.on_device = None;
        let wanted = match walk {
            Walk::Auto => !passes.gpu.is_software(),
            Walk::Cpu => false,
            Walk::Device => true,
        };
        let Root::Open(open) = view.root(&part.tree) else {
            return Ok(false);
        };
        if !wanted || !DeviceCut::fits(part) {
            self.device = None;
            return Ok(false);
        }
        if !self
            .device
            .as_ref()
            .is_some_and(|device| device.is_of(part))
        {
            self.device = Some(DeviceCut::new(passes, part)?);
            self.list = None;
        }
        self.on_device = Some((view.clone(), open));
        Ok(true)
    }

    /// Adds what the device counted last; where the list's triangles are.
    pub(crate) fn look(&mut self, took: &mut Took) -> Result<u32> {
        let Some(device) = &mut self.device else {
            return Ok(0);
        };
        device.look()?;
        if let Some(tally) = device.last {
            took.splats += u64::from(tally.splats);
            took.triangles += u64::from(tally.triangles);
            took.evaluated += u64::from(tally.asked);
            took.culled += u64::from(tally.culled);
        }
        Ok(device.triangles_first())
    }

    /// Records the device's selection.
    pub(crate) fn record_selection(
        &mut self,
        passes: &Passes,
        recorder: &mut Recorder,
        place: (GroupRef, u32, u32),
    ) -> Result<()> {
        match (&mut self.device, &self.on_device) {
            (Some(device), Some((view, open))) => {
                device.record(passes, recorder, view, *open, place)
            }
            _ => Ok(()),
        }
    }

    /// The list on the device: written, or to be filled there.
    pub(crate) fn ready_list(&mut self, passes: &Passes, uniforms: &Buffer) -> Result<()> {
        match (&mut self.device, &self.on_device) {
            (Some(device), Some(_)) => {
                let group = device.ready_uniforms(passes, uniforms)?;
                self.list = Some(List {
                    bytes: 0,
                    buffer: None,
                    uniforms: uniforms.as_handle(),
                    group,
                });
                Ok(())
            }
            _ => self.write_list(passes, uniforms),
        }
    }

    /// Writes the cut's list to the device.
    pub(crate) fn write_list(&mut self, passes: &Passes, uniforms: &Buffer) -> Result<()> {
        let gpu = &passes.gpu;
        let Cut {
            splats, triangles, ..
        } = &self.cut;
        let splats = if self.lists_splats { &splats[..] } else { &[] };
        let bytes = 4 * (u64::from(LIST_HEAD) + (splats.len() + triangles.len()) as u64);
        let uniform_handle = uniforms.as_handle();
        let fits = |list: &List| list.bytes >= bytes && list.uniforms == uniform_handle;
        if !self.list.as_ref().is_some_and(fits) {
            let capacity = bytes.next_power_of_two();
            let buffer = gpu.buffer(
                "list",
                capacity,
                BufferUsage::STORAGE | BufferUsage::COPY_DST,
            )?;
            let entries = [
                abi::BindingRecord {
                    binding: 0,
                    resource: uniform_handle,
                    offset: 0,
                    size: UNIFORM_BYTES,
                },
                abi::BindingRecord {
                    binding: 1,
                    resource: buffer.as_handle(),
                    ..Default::default()
                },
            ];
            let group = gpu.bind_group_from(&abi::BindGroupDescriptor {
                label: "list".into(),
                layout: passes.list_layout.handle(),
                entries: entries.as_slice().into(),
            })?;
            self.list = Some(List {
                bytes: capacity,
                buffer: Some(buffer),
                uniforms: uniform_handle,
                group,
            });
        }
        let Some(List {
            buffer: Some(buffer),
            ..
        }) = &self.list
        else {
            return Ok(());
        };
        gpu.write(buffer, 0, &[splats.len() as u32, triangles.len() as u32])?;
        let mut at = 4 * u64::from(LIST_HEAD);
        for entries in [splats, &triangles[..]] {
            if !entries.is_empty() {
                gpu.write(buffer, at, entries)?;
                at += 4 * entries.len() as u64;
            }
        }
        Ok(())
    }
}
