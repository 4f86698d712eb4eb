//! Which renderer draws a frame and which structure selects for it; preparing both.

use super::instances::{Instance, Instances, Parts, User};
use super::options::FrameError;
use super::prepare::{Inputs, PrepareKey, Product, Standing, Wait};
use super::request::{FrameRequest, Patience, Preparing, Role, Severity};
use super::session::{Drawer, FALLBACK_ID, Selecting, Stage};
use super::upload::Extra;
use crate::plugins::{Act, HostInstance, PluginInfo, suitability};
use pointstage_plugin_api::abi::{RendererBox, StructureBox, share_host};
use pointstage_plugin_api::settings_schema::{SettingCost, SettingValues, snapshot};
use std::sync::Arc;
use std::time::Duration;

/// How long an interactive frame waits for a renderer to prepare before the last good one stands in: most need less.
const GRACE: Duration = Duration::from_millis(25);

/// A plugin, and how its preparation stands.
type Prepared<P> = (Arc<PluginInfo>, Standing<P>);

impl Stage {
    /// Who draws: the one asked for, or, while it is prepared or if it cannot, a stand-in.
    pub(super) fn choose(
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
                    .get(&info)
                    .and_then(|instance| instance.last_good(user_of(request)).cloned());
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
                let instance = self.renderers.get_mut(&info);
                let is_new = instance.is_none_or(|instance| instance.note_failure(&source));
                let plugin = info.id.clone();
                let error = FrameError::Plugin { plugin, source };
                self.stand_in(request, &info.id, error, is_new)
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

    /// The viewport's last good renderer, of this role or of the main one, if it is another one and ready for this device.
    pub(super) fn last_good(&mut self, request: &FrameRequest, but: &str) -> Option<Drawer> {
        let roles = [request.role, Role::Main];
        let infos = roles.map(|role| {
            let viewport = self.viewports.get(&(request.viewport, role));
            viewport.and_then(|viewport| viewport.last_good.clone())
        });
        let info = infos.into_iter().flatten().find(|info| info.id != but)?;
        let instance = self.renderers.get(&info)?;
        let ready = instance.last_good(user_of(request))?.clone();
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

    /// The structure that selects, if one is asked for and good: the one prepared for the scene asked for or, while that
    /// is under way, the last good one, which serves as long as its own scene is drawn.
    pub(super) fn selecting(
        &mut self,
        request: &FrameRequest,
    ) -> Result<(Option<Selecting>, Option<Preparing>), FrameError> {
        let Some(key) = &request.structure else {
            return Ok((None, None));
        };
        let (id, error) = match self.structure(request, key) {
            Ok((info, Standing::Ready(ready))) => return Ok((Some((info, ready)), None)),
            Ok((info, Standing::Preparing(fraction, stage))) => {
                let preparing = Preparing {
                    id: info.id.clone(),
                    fraction,
                    stage,
                };
                let generation = self.generation();
                let instance = self.structures.get(&info);
                let last_good = instance.and_then(|instance| instance.last_good(user_of(request)));
                let selecting = last_good
                    .filter(|ready| ready.key.device == generation)
                    .map(|ready| (info, Arc::clone(ready)));
                return Ok((selecting, Some(preparing)));
            }
            Ok((info, Standing::Failed(source))) => {
                let instance = self.structures.get_mut(&info);
                let is_new = instance.is_none_or(|instance| instance.note_failure(&source));
                if !is_new && request.patience != Patience::Wait {
                    return Ok((None, None));
                }
                let plugin = info.id.clone();
                (info.id.clone(), FrameError::Plugin { plugin, source })
            }
            Err(error) => (key.clone(), error),
        };
        if request.patience == Patience::Wait {
            return Err(error);
        }
        let detail = error.detail().to_owned();
        self.tell(Severity::Error, &id, error.to_string(), detail);
        Ok((None, None))
    }

    fn structure(
        &mut self,
        request: &FrameRequest,
        key: &str,
    ) -> Result<Prepared<StructureBox>, FrameError> {
        let info = self.registry.find_structure(key)?;
        self.check_suitable(request, &info)?;
        let settings = snapshot(&info.entry.settings, &request.structure_settings)?;
        let standing = self.prepare(request, &info, &settings, |stage| &mut stage.structures)?;
        Ok((info, standing))
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
        instances: fn(&mut Self) -> &mut Instances<P>,
    ) -> Result<Standing<P>, FrameError> {
        let generation = self.generation();
        if instances(self)
            .get(info)
            .is_none_or(|instance| instance.device != generation)
        {
            let instance = self.instance(info)?;
            instances(self).insert(&info.id, instance);
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
            let extra = Extra::of(&info.entry.needs);
            gpu.scene
                .prepare(request.viewport, &request.scene, &extra)?;
        }
        let wait = match request.patience {
            Patience::Wait => Wait::Until(self.options.prepare_limit),
            Patience::DrawMeanwhile => Wait::Grace(GRACE),
        };
        let on_device = self.gpu.as_ref().map(|gpu| Arc::clone(&gpu.scene));
        let Some(instance) = instances(self).get_mut(info) else {
            unreachable!("inserted above")
        };
        let inputs = Inputs {
            key,
            factory: Arc::clone(&instance.factory),
            host: share_host(&instance.host),
            scene: Arc::clone(&request.scene),
            settings: settings.clone(),
            on_device,
        };
        let slot = instance.slot_for(user_of(request), &inputs.key.settings);
        Ok(slot.standing(inputs, wait))
    }

    /// Loads a plugin and makes its host object.
    fn instance<P: Product>(&self, info: &Arc<PluginInfo>) -> Result<Instance<P>, FrameError> {
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
        Ok(Instance::new(Parts {
            factory,
            hash: info.hash.clone(),
            host,
            owner,
            device: self.generation(),
            watch: Some(watch),
        }))
    }

    /// The instance of a renderer in use.
    pub(super) fn renderer_instance(&self, info: &PluginInfo) -> Option<&Instance<RendererBox>> {
        self.renderers.get(info)
    }

    /// The instance of a structure in use.
    pub(super) fn structure_instance(&self, info: &PluginInfo) -> Option<&Instance<StructureBox>> {
        self.structures.get(info)
    }
}

/// Whose preparations a request draws with.
pub(super) fn user_of(request: &FrameRequest) -> User {
    (request.viewport, request.role)
}
