//! The stage itself: device, plugins, preparations; and which renderer draws.

use super::options::{FrameError, StageError, StageOptions};
use super::prepare::{Inputs, PrepareKey, Product, Ready, Slot, Standing, Wait};
use super::request::{
    FrameRequest, FrameResult, Notice, Patience, Preparing, Role, Severity, ViewportId,
};
use super::upload::SceneOnDevice;
use super::viewport::Viewport;
use crate::device::GpuDevice;
use crate::frame::compose::Composer;
use crate::gpu::{GpuService, Owner};
use crate::plugins::{Act, Factory, HostInstance, PluginInfo, Registry, Watch, suitability};
use pointstage_plugin_api::Error as PluginError;
use pointstage_plugin_api::abi::{HostRef, RendererBox, StructureBox};
use pointstage_plugin_api::settings_schema::{SettingCost, SettingValues, snapshot};
use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Id of the built-in renderer, which is no plugin and draws on the CPU.
pub const FALLBACK_ID: &str = "pointstage.fallback";

/// How long an interactive frame waits for a renderer to prepare before the last good one stands in: most need less.
const GRACE: Duration = Duration::from_millis(25);

/// Losses of the device that are mended within [`LOSS_WINDOW`]; after more, the stage stays on the CPU.
const MOST_LOSSES: usize = 3;
const LOSS_WINDOW: Duration = Duration::from_mins(1);

/// The engine's session. Synchronous; [`StageThread`](super::StageThread) runs it beside a window.
pub struct Stage {
    pub(super) options: StageOptions,
    pub(super) registry: Arc<Registry>,
    pub(super) gpu: Option<OnDevice>,
    no_device: Option<String>,
    losses: Vec<Instant>,
    renderers: HashMap<String, Instance<RendererBox>>,
    structures: HashMap<String, Instance<StructureBox>>,
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

/// One plugin in use.
pub(super) struct Instance<P> {
    slot: Slot<P>,
    factory: Arc<Factory>,
    pub host: HostRef,
    /// Whose handles its are; none without a device.
    pub owner: Option<Owner>,
    device: u64,
    /// The failure that was last told, so that it is told once.
    told: Option<PluginError>,
    /// Names the plugin in the crash journal until it has drawn once, or failed in a way that was survived.
    watch: Option<Watch>,
}

/// A plugin, and how its preparation stands.
pub(super) type Prepared<P> = (Arc<PluginInfo>, Standing<P>);

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
            renderers: HashMap::new(),
            structures: HashMap::new(),
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

    /// Looks for plugins again. What is in use stays in use until it is asked for under a changed file.
    pub fn rescan(&mut self) {
        self.registry = Arc::new(Registry::discover(&self.options.plugins));
        self.forget_plugins();
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

    /// Handles and bytes that a renderer holds on the device.
    pub fn holdings(&self, renderer_id: &str) -> (usize, u64) {
        let owner = self
            .renderers
            .get(renderer_id)
            .and_then(|instance| instance.owner);
        match (&self.gpu, owner) {
            (Some(gpu), Some(owner)) => (gpu.service.handle_count(owner), gpu.service.bytes(owner)),
            _ => (0, 0),
        }
    }

    /// Tries a failed renderer again with the next frame.
    pub fn retry(&mut self, renderer_id: &str) {
        if let Some(instance) = self.renderers.get_mut(renderer_id) {
            instance.slot.retry();
            instance.told = None;
        }
    }

    /// Drops what a viewport holds.
    pub fn close_viewport(&mut self, viewport: ViewportId) {
        self.viewports.retain(|(id, _), _| *id != viewport);
    }

    /// Draws one frame.
    ///
    /// With [`Patience::Wait`], whatever keeps the renderer asked for from drawing is an error. Otherwise it is a
    /// [`Notice`], and the last good renderer or the fallback draws.
    pub fn frame(&mut self, request: &FrameRequest) -> Result<FrameResult, FrameError> {
        let start = Instant::now();
        self.mend_device();
        self.check_size(request.size_px)?;
        let (drawer, preparing) = self.choose(request)?;
        let mut result = self.draw_or_fall_back(request, &drawer)?;
        result.preparing = preparing;
        result.stats.total = start.elapsed();
        result.notices = std::mem::take(&mut self.notices);
        Ok(result)
    }

    /// Draws with the one chosen; if it fails, with the last good one, then with the fallback.
    fn draw_or_fall_back(
        &mut self,
        request: &FrameRequest,
        drawer: &Drawer,
    ) -> Result<FrameResult, FrameError> {
        let id = match drawer {
            Drawer::Plugin(info, _) => info.id.clone(),
            Drawer::Fallback => return self.draw(request, drawer),
        };
        let error = match self.draw(request, drawer) {
            Ok(result) => {
                if let Some(instance) = self.renderers.get_mut(&id) {
                    instance.watch = None;
                }
                self.viewport(request).last_good = Some(id);
                return Ok(result);
            }
            Err(error) => error,
        };
        let lost = self.gpu.as_ref().is_some_and(|gpu| gpu.device.is_lost());
        if lost {
            // Not the plugin's fault as far as anybody can tell: mend the device and draw on.
            self.mend_device();
        } else {
            self.drop_plugin(&id, &error);
        }
        if request.patience == Patience::Wait && !lost {
            return Err(error);
        }
        self.tell(
            Severity::Error,
            &id,
            error.to_string(),
            error.detail().to_owned(),
        );
        let stand_in = self.last_good(request, &id).unwrap_or(Drawer::Fallback);
        self.draw(request, &stand_in)
            .or_else(|_| self.draw(request, &Drawer::Fallback))
    }

    /// Who draws: the one asked for, or, while it is prepared or if it cannot, a stand-in.
    fn choose(
        &mut self,
        request: &FrameRequest,
    ) -> Result<(Drawer, Option<Preparing>), FrameError> {
        if request.renderer == FALLBACK_ID {
            return Ok((Drawer::Fallback, None));
        }
        match self.standing(request) {
            Ok((info, Standing::Ready(ready))) => Ok((Drawer::Plugin(info, ready), None)),
            Ok((info, Standing::Preparing(fraction, stage))) => {
                let preparing = Preparing {
                    id: info.id.clone(),
                    fraction,
                    stage,
                };
                let own = self
                    .renderers
                    .get(&info.id)
                    .and_then(|instance| instance.slot.last_good().cloned());
                let own = own.filter(|ready| ready.key.device == self.generation());
                let drawer = match own {
                    Some(ready) => Drawer::Plugin(info, ready),
                    None => self
                        .last_good(request, &info.id)
                        .unwrap_or(Drawer::Fallback),
                };
                Ok((drawer, Some(preparing)))
            }
            Ok((info, Standing::Failed(source))) => {
                let told = self.renderers.get_mut(&info.id).and_then(|instance| {
                    instance.watch = None;
                    instance.told.replace(source.clone())
                });
                let error = FrameError::Plugin {
                    plugin: info.id.clone(),
                    source: source.clone(),
                };
                self.stand_in(request, &info.id, error, told.as_ref() != Some(&source))
            }
            Err(error) => self.stand_in(request, &request.renderer, error, true),
        }
    }

    fn stand_in(
        &mut self,
        request: &FrameRequest,
        id: &str,
        error: FrameError,
        tell: bool,
    ) -> Result<(Drawer, Option<Preparing>), FrameError> {
        if request.patience == Patience::Wait {
            return Err(error);
        }
        if tell {
            self.tell(
                Severity::Error,
                id,
                error.to_string(),
                error.detail().to_owned(),
            );
        }
        Ok((
            self.last_good(request, id).unwrap_or(Drawer::Fallback),
            None,
        ))
    }

    /// The viewport's last good renderer, if it is another one and ready for this device.
    fn last_good(&mut self, request: &FrameRequest, but: &str) -> Option<Drawer> {
        let id = self
            .viewport(request)
            .last_good
            .clone()
            .filter(|id| id != but)?;
        let ready = self.renderers.get(&id)?.slot.last_good()?.clone();
        let info = self.registry.find_renderer(&id).ok()?;
        (ready.key.device == self.generation()).then_some(Drawer::Plugin(info, ready))
    }

    /// How the renderer asked for stands; starts what is due.
    fn standing(&mut self, request: &FrameRequest) -> Result<Prepared<RendererBox>, FrameError> {
        let info = self.registry.find_renderer(&request.renderer)?;
        self.check_suitable(request, &info)?;
        let settings = snapshot(&info.entry.settings, &request.settings)?;
        let standing = self.prepare(request, &info, &settings, |stage| &mut stage.renderers)?;
        Ok((info, standing))
    }

    /// The same for the structure, if one is asked for.
    pub(super) fn structure(
        &mut self,
        request: &FrameRequest,
    ) -> Result<Option<Prepared<StructureBox>>, FrameError> {
        let Some(key) = &request.structure else {
            return Ok(None);
        };
        let info = self.registry.find_structure(key)?;
        self.check_suitable(request, &info)?;
        let settings = snapshot(&info.entry.settings, &request.structure_settings)?;
        let standing = self.prepare(request, &info, &settings, |stage| &mut stage.structures)?;
        Ok(Some((info, standing)))
    }

    fn check_suitable(&self, request: &FrameRequest, info: &PluginInfo) -> Result<(), FrameError> {
        let device = self.gpu.as_ref().map(|gpu| &*gpu.device);
        match suitability(&info.entry.needs, &request.scene, device).reason() {
            Some(reason) => Err(FrameError::Unsuitable {
                renderer: info.id.clone(),
                reason,
            }),
            None => Ok(()),
        }
    }

    fn prepare<P: Product>(
        &mut self,
        request: &FrameRequest,
        info: &Arc<PluginInfo>,
        settings: &SettingValues,
        instances: fn(&mut Self) -> &mut HashMap<String, Instance<P>>,
    ) -> Result<Standing<P>, FrameError> {
        let generation = self.generation();
        if instances(self)
            .get(&info.id)
            .is_none_or(|instance| instance.device != generation)
        {
            let instance = self.instance(info)?;
            instances(self).insert(info.id.clone(), instance);
        }
        let costly = info
            .entry
            .settings
            .iter()
            .filter(|setting| setting.cost == SettingCost::Prepare);
        let costly = costly
            .filter_map(|setting| Some((setting.id.clone(), settings.get(&setting.id)?.clone())))
            .collect();
        let key = PrepareKey {
            scene: request.scene.revision(),
            settings: costly,
            device: generation,
        };
        if let Some(gpu) = &self.gpu {
            gpu.scene.update(
                &request.scene,
                std::iter::empty(),
                &super::upload::Extra::of(&info.entry.needs),
            )?;
        }
        let wait = match request.patience {
            Patience::Wait => Wait::Until(self.options.prepare_limit),
            Patience::DrawMeanwhile => Wait::Grace(GRACE),
        };
        let on_device = self.gpu.as_ref().map(|gpu| Arc::clone(&gpu.scene));
        let Some(instance) = instances(self).get_mut(&info.id) else {
            unreachable!("inserted above")
        };
        let inputs = Inputs {
            key,
            factory: Arc::clone(&instance.factory),
            host: pointstage_plugin_api::abi::share_host(&instance.host),
            scene: Arc::clone(&request.scene),
            settings: settings.clone(),
            on_device,
        };
        Ok(instance.slot.standing(inputs, wait))
    }

    /// Loads a plugin and makes its host object.
    fn instance<P>(&self, info: &Arc<PluginInfo>) -> Result<Instance<P>, FrameError> {
        self.try_first(info)?;
        let watch = self.registry.watch(info, Act::FirstUse);
        let factory = self.registry.load(info)?;
        let needs = &info.entry.needs;
        let features: Vec<String> = needs
            .features
            .iter()
            .chain(&needs.optional_features)
            .cloned()
            .collect();
        let owner = self.gpu.as_ref().map(|gpu| {
            gpu.service
                .owner(&info.id, &features, self.options.plugin_quota_bytes)
        });
        let gpu = self
            .gpu
            .as_ref()
            .zip(owner)
            .map(|(gpu, owner)| gpu.service.object(owner));
        let host = HostInstance::border(info, gpu, self.thread_count(), self.registry.log());
        Ok(Instance {
            slot: Slot::default(),
            factory,
            host,
            owner,
            device: self.generation(),
            told: None,
            watch: Some(watch),
        })
    }

    /// Threads that a plugin may keep busy.
    pub(super) fn thread_count(&self) -> usize {
        match self.options.thread_count {
            0 => std::thread::available_parallelism().map_or(1, usize::from),
            count => count,
        }
    }

    /// The instance of a renderer in use.
    pub(super) fn renderer_instance(&self, id: &str) -> Option<&Instance<RendererBox>> {
        self.renderers.get(id)
    }

    /// The instance of a structure in use.
    pub(super) fn structure_instance(&self, id: &str) -> Option<&Instance<StructureBox>> {
        self.structures.get(id)
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

    /// After an error: drops the renderer's views everywhere, and its preparation.
    fn drop_plugin(&mut self, id: &str, error: &FrameError) {
        for viewport in self.viewports.values_mut() {
            viewport.views.remove(id);
            viewport.last_good.take_if(|good| good == id);
        }
        if let Some(instance) = self.renderers.get_mut(id) {
            let source = match error {
                FrameError::Plugin { source, .. } => source.clone(),
                other => PluginError::failed(other),
            };
            instance.told = Some(source.clone());
            instance.slot.fail(source);
            instance.watch = None;
        }
    }

    fn check_size(&self, [width, height]: [u32; 2]) -> Result<(), FrameError> {
        let most = self
            .gpu
            .as_ref()
            .map_or(16_384, |gpu| gpu.device.limits.max_texture_dimension_2d);
        let what = match (width == 0 || height == 0, width > most || height > most) {
            (true, _) => "it needs at least one in each direction".into(),
            (_, true) => {
                format!("this device draws at most {most} in each direction; ask for less")
            }
            _ => return Ok(()),
        };
        Err(FrameError::Size {
            width,
            height,
            what,
        })
    }

    /// Opens the device, or notes why not.
    fn open_device(&mut self) -> Result<(), StageError> {
        match GpuDevice::open(&self.options.device) {
            Ok(device) => {
                let service = GpuService::new(Arc::clone(&device));
                let scene = Arc::new(SceneOnDevice::new(&device, &service)?);
                let composer = Composer::new(Arc::clone(&device))?;
                self.gpu = Some(OnDevice {
                    device,
                    service,
                    scene,
                    composer,
                });
                self.no_device = None;
            }
            Err(error) => {
                self.tell(
                    Severity::Warning,
                    "",
                    format!("no graphics device: {error}; drawing on the CPU"),
                    String::new(),
                );
                self.no_device = Some(error.to_string());
            }
        }
        Ok(())
    }

    /// If the device is lost: forgets all that was on it and opens another one, at most three times in a minute.
    fn mend_device(&mut self) {
        let Some(gpu) = &self.gpu else { return };
        for error in gpu.device.take_errors() {
            self.tell(
                Severity::Error,
                "",
                format!("the graphics device reports: {error}"),
                String::new(),
            );
        }
        if !self.gpu.as_ref().is_some_and(|gpu| gpu.device.is_lost()) {
            return;
        }
        self.viewports
            .values_mut()
            .for_each(Viewport::forget_device);
        self.forget_plugins();
        self.gpu = None;
        let now = Instant::now();
        self.losses
            .retain(|loss| now.duration_since(*loss) < LOSS_WINDOW);
        self.losses.push(now);
        if self.losses.len() > MOST_LOSSES {
            let text = "the graphics device was lost again; drawing on the CPU from now on. Restart the program to try it again";
            self.no_device = Some("it was lost more than three times in a minute".into());
            self.tell(Severity::Error, "", text.into(), String::new());
            return;
        }
        self.tell(
            Severity::Warning,
            "",
            "the graphics device was lost; a new one was opened".into(),
            String::new(),
        );
        if let Err(error) = self.open_device() {
            self.no_device = Some(error.to_string());
            self.tell(Severity::Error, "", error.to_string(), String::new());
        }
    }

    /// Drops all that plugins made: views first.
    fn forget_plugins(&mut self) {
        for viewport in self.viewports.values_mut() {
            viewport.views.clear();
            viewport.selectors.clear();
        }
        self.renderers.clear();
        self.structures.clear();
    }

    /// What plugins reported of themselves, by renderer, for tests.
    pub fn prepared_renderers(&self) -> BTreeMap<String, bool> {
        self.renderers
            .iter()
            .map(|(id, instance)| (id.clone(), instance.slot.last_good().is_some()))
            .collect()
    }
}

impl Drop for Stage {
    fn drop(&mut self) {
        self.forget_plugins();
    }
}
