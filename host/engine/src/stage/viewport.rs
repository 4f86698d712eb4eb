//! What belongs to one viewport and role: targets, buffers, views, and what their last frame was.

use super::prepare::Ready;
use super::request::FrameRequest;
use super::selection::FrameBuffers;
use crate::frame::fallback::Fallback;
use crate::frame::{CpuTargets, TargetSet};
use crate::plugins::PluginInfo;
use pointstage_plugin_api::abi::{
    FrameChanges, Handle, RendererBox, SelectorBox, StructureBox, ViewBox,
};
use std::collections::HashMap;
use std::sync::Arc;

/// One viewport in one role.
#[derive(Default)]
pub(super) struct Viewport {
    pub views: HashMap<String, ViewSlot>,
    pub selectors: HashMap<String, SelectorSlot>,
    pub gpu: Option<ViewportOnDevice>,
    pub cpu_targets: Option<CpuTargets>,
    pub fallback: Fallback,
    /// The renderer that drew last without an error.
    pub last_good: Option<Arc<PluginInfo>>,
}

impl Viewport {
    /// Drops what was on a lost device.
    pub(super) fn forget_device(&mut self) {
        self.views.clear();
        self.selectors.clear();
        self.gpu = None;
    }
}

/// A viewport's things on the device.
pub(super) struct ViewportOnDevice {
    pub targets: TargetSet,
    /// Handles of the targets' textures, by key.
    pub handles: Vec<(String, Handle)>,
    pub buffers: FrameBuffers,
}

/// A renderer's view, and what it drew last.
pub(super) struct ViewSlot {
    pub view: ViewBox,
    pub ready: Arc<Ready<RendererBox>>,
    pub last: Option<LastFrame>,
    pub frame_index: u32,
    pub sample_index: u32,
    /// Whether it ends a call that runs out of time with an error instead of with what there is.
    pub gives_up: bool,
}

/// A structure's selector.
pub(super) struct SelectorSlot {
    pub selector: SelectorBox,
    pub ready: Arc<Ready<StructureBox>>,
}

/// What the last frame was asked for, to tell what changed.
#[derive(Clone)]
pub(super) struct LastFrame {
    request: FrameRequest,
    targets: Vec<String>,
}

impl LastFrame {
    pub(super) fn new(request: &FrameRequest, targets: Vec<String>) -> Self {
        Self {
            request: request.clone(),
            targets,
        }
    }
}

/// What changed since the last frame, and the ids of the settings that did.
pub(super) fn changes_since(
    last: Option<&LastFrame>,
    request: &FrameRequest,
    targets: &[String],
) -> (FrameChanges, Vec<String>) {
    let Some(LastFrame {
        request: last,
        targets: last_targets,
    }) = last
    else {
        let all = [
            FrameChanges::CAMERA,
            FrameChanges::SETTINGS,
            FrameChanges::SIZE,
            FrameChanges::SELECTION,
            FrameChanges::SCENE,
            FrameChanges::LIGHTS,
            FrameChanges::TARGETS,
        ];
        let all = all
            .into_iter()
            .fold(FrameChanges::NONE, |all, flag| all | flag);
        return (all, request.settings.keys().cloned().collect());
    };
    let changed = |id: &&String| last.settings.get(*id) != request.settings.get(*id);
    let mut settings: Vec<String> = request
        .settings
        .keys()
        .chain(last.settings.keys())
        .filter(changed)
        .cloned()
        .collect();
    settings.sort();
    settings.dedup();
    let selection = last.structure != request.structure
        || last.structure_settings != request.structure_settings;
    let mut flags = FrameChanges::NONE;
    for (changed, flag) in [
        (
            last.camera != request.camera || last.tile != request.tile,
            FrameChanges::CAMERA,
        ),
        (
            !settings.is_empty() || last.radius_scale != request.radius_scale,
            FrameChanges::SETTINGS,
        ),
        (last.size_px != request.size_px, FrameChanges::SIZE),
        (
            selection
                || (request.structure.is_some()
                    && (last.camera != request.camera || last.tile != request.tile)),
            FrameChanges::SELECTION,
        ),
        (
            last.scene.revision() != request.scene.revision(),
            FrameChanges::SCENE,
        ),
        (last.lights != request.lights, FrameChanges::LIGHTS),
        (last_targets != targets, FrameChanges::TARGETS),
    ] {
        if changed {
            flags |= flag;
        }
    }
    (flags, settings)
}
