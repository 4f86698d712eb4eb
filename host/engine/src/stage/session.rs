//! The stage itself: device, plugins, preparations; and which renderer draws.

use super::draw::given_targets;
use super::instances::{Instance, Instances};
use super::options::{FrameError, StageError, StageOptions};
use super::prepare::Ready;
use super::request::{FrameRequest, FrameResult, Notice, Patience, Role, Severity, ViewportId};
use super::thread::PluginHoldings;
use super::upload::SceneOnDevice;
use super::viewport::Viewport;
use crate::device::GpuDevice;
use crate::frame::compose::Composer;
use crate::frame::targets::TargetSpec;
use crate::gpu::GpuService;
use crate::plugins::{PluginFile, PluginInfo, Registry, UnknownPlugin};
use pointstage_plugin_api::abi::{RendererBox, StructureBox};
use std::collections::{BTreeSet, HashMap};
use std::sync::Arc;
use std::time::Instant;

/// Id of the built-in renderer, which is no plugin and draws on the CPU.
pub const FALLBACK_ID: &str = "pointstage.fallback";

/// The greatest width and height of a frame without a device, px: what most devices draw.
const LARGEST_CPU_FRAME_PX: u32 = 16_384;

/// The engine's session. Synchronous; [`StageThread`](super::StageThread) runs it beside a window.
pub struct Stage {
    pub(super) options: StageOptions,
    pub(super) registry: Arc<Registry>,
    pub(super) gpu: Option<OnDevice>,
    pub(super) no_device: Option<String>,
    pub(super) losses: Vec<Instant>,
    pub(super) renderers: Instances<RendererBox>,
    pub(super) structures: Instances<StructureBox>,
    pub(super) viewports: HashMap<(ViewportId, Role), Viewport>,
    pub(super) notices: Vec<Notice>,
}

/// The adapter in use, for people.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Adapter {
    /// As the driver says.
    pub name: String,
    /// 'vulkan', 'gl', …
    pub backend: String,
    /// Name and version; may be empty.
    pub driver: String,
    /// Whether it runs on the CPU.
    pub is_software: bool,
}

/// What there is once per device.
pub(super) struct OnDevice {
    pub device: Arc<GpuDevice>,
    pub service: Arc<GpuService>,
    pub scene: Arc<SceneOnDevice>,
    pub composer: Composer,
}

/// A structure that is ready to select.
pub(super) type Selecting = (Arc<PluginInfo>, Arc<Ready<StructureBox>>);

/// Who draws a frame.
pub(super) enum Drawer {
    /// A plugin.
    Plugin(Arc<PluginInfo>, Arc<Ready<RendererBox>>),
    /// The built-in renderer.
    Fallback,
}

impl Stage {
    /// Opens device and plugins. A missing device is not an error: the stage then draws on the CPU, see
    /// [`Stage::no_device`].
    pub fn new(options: StageOptions) -> Result<Self, StageError> {
        let registry = Arc::new(Registry::discover(&options.plugins));
        let mut stage = Self {
            options,
            registry,
            gpu: None,
            no_device: None,
            losses: Vec::new(),
            renderers: Instances::default(),
            structures: Instances::default(),
            viewports: HashMap::new(),
            notices: Vec::new(),
        };
        if stage.options.use_device {
            stage.open_device()?;
        }
        Ok(stage)
    }

    /// The plugins found.
    pub fn registry(&self) -> Arc<Registry> {
        Arc::clone(&self.registry)
    }

    /// The device's adapter; none on the CPU.
    pub fn adapter(&self) -> Option<Adapter> {
        let device = &self.gpu.as_ref()?.device;
        Some(Adapter {
            name: device.info.name.clone(),
            backend: device.backend_name().to_owned(),
            driver: format!("{} {}", device.info.driver, device.info.driver_info)
                .trim()
                .to_owned(),
            is_software: device.is_software(),
        })
    }

    /// Why there is no device although one was wanted.
    pub fn no_device(&self) -> Option<&str> {
        self.no_device.as_deref()
    }

    /// The device, for tests and measurements.
    pub fn device(&self) -> Option<&Arc<GpuDevice>> {
        self.gpu.as_ref().map(|gpu| &gpu.device)
    }

    /// The greatest width and height of a frame, px; larger images are drawn in tiles.
    pub fn largest_frame_px(&self) -> u32 {
        self.gpu.as_ref().map_or(LARGEST_CPU_FRAME_PX, |gpu| {
            gpu.device.limits.max_texture_dimension_2d
        })
    }

    /// The targets that a renderer gives, in the host's order, then its own.
    pub fn given_targets(&self, renderer: &str) -> Result<Vec<TargetSpec>, UnknownPlugin> {
        if renderer == FALLBACK_ID {
            return Ok(given_targets(None));
        }
        let info = self.registry.find_renderer(renderer)?;
        Ok(given_targets(Some(&info)))
    }

    /// Handles and bytes that a renderer or structure holds on the device.
    pub fn holdings(&self, id: &str) -> (usize, u64) {
        let renderers = self.renderers.of_id(id).filter_map(|build| build.owner);
        let structures = self.structures.of_id(id).filter_map(|build| build.owner);
        let Some(gpu) = &self.gpu else { return (0, 0) };
        let owners = renderers.chain(structures);
        owners.fold((0, 0), |(handles, bytes), owner| {
            (
                handles + gpu.service.handle_count(owner),
                bytes + gpu.service.bytes(owner),
            )
        })
    }

    /// What every plugin in use holds on the device, by id.
    pub fn all_holdings(&self) -> Vec<PluginHoldings> {
        let ids: BTreeSet<&String> = self.renderers.ids().chain(self.structures.ids()).collect();
        ids.into_iter()
            .map(|id| {
                let (handle_count, bytes) = self.holdings(id);
                let mut files = self.registry.files().iter();
                let file = files.find(|file| file.has(id));
                PluginHoldings {
                    id: id.clone(),
                    handle_count,
                    bytes,
                    load_time: file.and_then(PluginFile::load_time),
                }
            })
            .collect()
    }

    /// Tries a failed renderer or structure again with the next frame.
    pub fn retry(&mut self, id: &str) {
        self.renderers.of_id_mut(id).for_each(Instance::retry);
        self.structures.of_id_mut(id).for_each(Instance::retry);
    }

    /// Drops what a viewport holds, and what was prepared or kept on the device for it alone.
    pub fn close_viewport(&mut self, viewport: ViewportId) {
        self.viewports.retain(|(id, _), _| *id != viewport);
        self.renderers.forget_viewport(viewport);
        self.structures.forget_viewport(viewport);
        if let Some(gpu) = &self.gpu {
            gpu.scene.forget_viewport(viewport);
        }
    }

    /// Draws one frame.
    ///
    /// With [`Patience::Wait`], whatever keeps the renderer asked for from drawing is an error. Otherwise it is a
    /// [`Notice`], and the last good renderer or the fallback draws.
    pub fn frame(&mut self, request: &FrameRequest) -> Result<FrameResult, FrameError> {
        let start = Instant::now();
        self.mend_device();
        self.check_size(request.size_px)?;
        if let Some(tile) = request.tile {
            tile.check(request.size_px)?;
        }
        let (structure, structure_preparing) = self.selecting(request)?;
        let (drawer, preparing) = self.choose(request)?;
        let mut result = self.draw_or_fall_back(request, &drawer, structure.as_ref())?;
        result.preparing = preparing.or(structure_preparing);
        result.stats.total = start.elapsed();
        result.notices = std::mem::take(&mut self.notices);
        Ok(result)
    }

    /// Draws with the one chosen; if it fails, with the last good one, then with the fallback. A structure that fails is
    /// done without.
    fn draw_or_fall_back(
        &mut self,
        request: &FrameRequest,
        drawer: &Drawer,
        structure: Option<&Selecting>,
    ) -> Result<FrameResult, FrameError> {
        let error = match self.draw(request, drawer, structure) {
            Ok(result) => {
                self.note_success(request, drawer, structure);
                return Ok(result);
            }
            Err(error) => error,
        };
        let lost = self.gpu.as_ref().is_some_and(|gpu| gpu.device.is_lost());
        let culprit = match (structure, drawer) {
            (Some((info, _)), _) if error.is_of(&info.id) => info,
            (_, Drawer::Plugin(info, _)) => info,
            (_, Drawer::Fallback) => return Err(error),
        };
        if lost {
            // Not the plugin's fault as far as anybody can tell: mend the device and draw on.
            self.mend_device();
        } else {
            self.drop_plugin(request, culprit, &error);
        }
        if request.patience == Patience::Wait && !lost {
            return Err(error);
        }
        self.tell(
            Severity::Error,
            &culprit.id,
            error.to_string(),
            error.detail().to_owned(),
        );
        if !lost && structure.is_some_and(|(info, _)| info.id == culprit.id) {
            return self.draw_or_fall_back(request, drawer, None);
        }
        let stand_in = self.last_good(request, &culprit.id);
        let stand_in = stand_in.unwrap_or(Drawer::Fallback);
        self.draw(request, &stand_in, structure)
            .or_else(|_| self.draw(request, &Drawer::Fallback, None))
    }

    /// Who drew without an error is no longer under suspicion.
    fn note_success(
        &mut self,
        request: &FrameRequest,
        drawer: &Drawer,
        structure: Option<&Selecting>,
    ) {
        let instance = structure.and_then(|(info, _)| self.structures.get_mut(info));
        if let Some(instance) = instance {
            instance.watch = None;
        }
        if let Drawer::Plugin(info, _) = drawer {
            if let Some(instance) = self.renderers.get_mut(info) {
                instance.watch = None;
            }
            self.viewport(request).last_good = Some(Arc::clone(info));
        }
    }

    /// Threads that a plugin may keep busy.
    pub(super) fn thread_count(&self) -> usize {
        match self.options.thread_count {
            0 => std::thread::available_parallelism().map_or(1, usize::from),
            count => count,
        }
    }

    /// The request's viewport in its role.
    pub(super) fn viewport(&mut self, request: &FrameRequest) -> &mut Viewport {
        self.viewports
            .entry((request.viewport, request.role))
            .or_default()
    }

    /// Generation of the device; 0 without one.
    pub(super) fn generation(&self) -> u64 {
        self.gpu.as_ref().map_or(0, |gpu| gpu.device.generation)
    }

    pub(super) fn tell(&mut self, severity: Severity, plugin: &str, text: String, detail: String) {
        self.notices.push(Notice {
            severity,
            plugin: plugin.into(),
            text,
            detail,
        });
    }

    fn check_size(&self, [width, height]: [u32; 2]) -> Result<(), FrameError> {
        let most = self.largest_frame_px();
        let what = match (width == 0 || height == 0, width > most || height > most) {
            (true, _) => "it needs at least one in each direction".into(),
            (_, true) => {
                format!(
                    "this device draws at most {most} in each direction at once; ask for less, or draw in tiles"
                )
            }
            _ => return Ok(()),
        };
        Err(FrameError::Size {
            width,
            height,
            what,
        })
    }
}

impl Drop for Stage {
    fn drop(&mut self) {
        self.forget_plugins();
    }
}
