//! The plugins in use: by id and content, since two builds of one plugin may draw side by side, and within each what it
//! prepared, once for each set of costly settings that some viewport draws with.

use super::prepare::{Product, Ready, Slot};
use super::request::{Role, ViewportId};
use crate::gpu::Owner;
use crate::plugins::{Factory, PluginInfo, Watch};
use pointstage_plugin_api::Error as PluginError;
use pointstage_plugin_api::abi::HostRef;
use pointstage_plugin_api::settings_schema::SettingValues;
use std::collections::{BTreeSet, HashMap, HashSet};
use std::sync::Arc;

/// Who draws with what was prepared: a viewport in one of its roles.
pub(super) type User = (ViewportId, Role);

/// One plugin in use.
pub(super) struct Instance<P> {
    variants: Vec<Variant<P>>,
    pub factory: Arc<Factory>,
    /// Content hash of its library.
    pub hash: String,
    pub host: HostRef,
    /// Whose handles its are; none without a device.
    pub owner: Option<Owner>,
    /// Generation of the device that it was made for.
    pub device: u64,
    /// The failure that was last told, so that it is told once.
    pub told: Option<PluginError>,
    /// Names the plugin in the crash journal until it has drawn once, or failed in a way that was survived.
    pub watch: Option<Watch>,
}

/// What is prepared for one set of costly settings, and for whom.
struct Variant<P> {
    /// Values of the settings whose cost is 'prepare'.
    settings: SettingValues,
    users: HashSet<User>,
    slot: Slot<P>,
}

/// What an instance is made of.
pub(super) struct Parts {
    pub factory: Arc<Factory>,
    pub hash: String,
    pub host: HostRef,
    pub owner: Option<Owner>,
    pub device: u64,
    pub watch: Option<Watch>,
}

impl<P: Product> Instance<P> {
    pub(super) fn new(parts: Parts) -> Self {
        let Parts {
            factory,
            hash,
            host,
            owner,
            device,
            watch,
        } = parts;
        Self {
            variants: Vec::new(),
            factory,
            hash,
            host,
            owner,
            device,
            told: None,
            watch,
        }
    }

    /// What is prepared, or is to be, for `settings`; from now on that is what `user` draws with. What nobody draws with any
    /// more is dropped. A user who alone drew with the former settings takes that preparation along: it is what the next
    /// one goes on from, and draws until then.
    pub(super) fn slot_for(&mut self, user: User, settings: &SettingValues) -> &mut Slot<P> {
        let known = self
            .variants
            .iter()
            .position(|variant| variant.settings == *settings);
        let index = known.unwrap_or_else(|| self.new_variant(user, settings));
        for (at, variant) in self.variants.iter_mut().enumerate() {
            if at == index {
                variant.users.insert(user);
            } else {
                variant.users.remove(&user);
            }
        }
        // The one asked for has a user, so it stays; how many before it go is needed to find it again.
        let gone = self.variants[..index]
            .iter()
            .filter(|variant| variant.users.is_empty());
        let index = index - gone.count();
        self.variants.retain(|variant| !variant.users.is_empty());
        &mut self.variants[index].slot
    }

    fn new_variant(&mut self, user: User, settings: &SettingValues) -> usize {
        let own = self
            .variants
            .iter()
            .position(|variant| variant.users.contains(&user));
        // Without one of its own, the user goes on from what some other viewport has.
        let from = own.or_else(|| (!self.variants.is_empty()).then_some(0));
        if let Some(index) = from
            && self.variants[index]
                .users
                .iter()
                .all(|other| *other == user)
        {
            self.variants[index].settings = settings.clone();
            return index;
        }
        let ready = from.and_then(|index| self.variants[index].slot.last_good().cloned());
        self.variants.push(Variant {
            settings: settings.clone(),
            users: HashSet::new(),
            slot: Slot::starting_from(ready),
        });
        self.variants.len() - 1
    }

    /// The last good preparation of a user; of somebody else if that user never drew with it.
    pub(super) fn last_good(&self, user: User) -> Option<&Arc<Ready<P>>> {
        let own = self
            .variants
            .iter()
            .find(|variant| variant.users.contains(&user));
        let own = own.or_else(|| self.variants.first());
        own.and_then(|variant| variant.slot.last_good())
    }

    /// A viewport was closed: nothing is kept for it. What was prepared last stays, for whoever comes next.
    fn forget_viewport(&mut self, viewport: ViewportId) {
        for variant in &mut self.variants {
            variant.users.retain(|(user, _)| *user != viewport);
        }
        let is_used = |variant: &Variant<P>| !variant.users.is_empty();
        if self.variants.iter().any(is_used) {
            self.variants.retain(is_used);
        } else {
            self.variants.truncate(1);
        }
    }

    /// Marks the preparation of `user` as failed, as people are told.
    pub(super) fn fail(&mut self, user: User, error: &PluginError) {
        self.told = Some(error.clone());
        for variant in &mut self.variants {
            if variant.users.contains(&user) {
                variant.slot.fail(error.clone());
            }
        }
        self.watch = None;
    }

    /// Notes that the preparation failed in a way that was survived; whether that is still to be told.
    pub(super) fn note_failure(&mut self, error: &PluginError) -> bool {
        self.watch = None;
        self.told.replace(error.clone()).as_ref() != Some(error)
    }

    /// Cancels what is under way; whether there was anything. The user asked for it, so it is not told as a failure.
    pub(super) fn cancel(&mut self) -> bool {
        let slots = self.variants.iter_mut().map(|variant| &mut variant.slot);
        let errors: Vec<PluginError> = slots.filter_map(Slot::cancel).collect();
        let is_cancelled = !errors.is_empty();
        if is_cancelled {
            self.told = errors.into_iter().next_back();
            self.watch = None;
        }
        is_cancelled
    }

    /// Forgets failures, so that the next frame tries again.
    pub(super) fn retry(&mut self) {
        for variant in &mut self.variants {
            variant.slot.retry();
        }
        self.told = None;
    }
}

/// All instances of one kind.
pub(super) struct Instances<P>(HashMap<String, Vec<Instance<P>>>);

impl<P> Default for Instances<P> {
    fn default() -> Self {
        Self(HashMap::new())
    }
}

impl<P: Product> Instances<P> {
    /// The instance of just this build.
    pub(super) fn get(&self, info: &PluginInfo) -> Option<&Instance<P>> {
        self.of_id(&info.id)
            .find(|instance| instance.hash == info.hash)
    }

    /// The instance of just this build, to change.
    pub(super) fn get_mut(&mut self, info: &PluginInfo) -> Option<&mut Instance<P>> {
        self.of_id_mut(&info.id)
            .find(|instance| instance.hash == info.hash)
    }

    /// All builds of a plugin.
    pub(super) fn of_id(&self, id: &str) -> impl Iterator<Item = &Instance<P>> {
        self.0.get(id).into_iter().flatten()
    }

    /// All builds of a plugin, to change.
    pub(super) fn of_id_mut(&mut self, id: &str) -> impl Iterator<Item = &mut Instance<P>> {
        self.0.get_mut(id).into_iter().flatten()
    }

    /// Puts an instance in the place of the one of the same build.
    pub(super) fn insert(&mut self, id: &str, instance: Instance<P>) {
        let builds = self.0.entry(id.to_owned()).or_default();
        builds.retain(|build| build.hash != instance.hash);
        builds.push(instance);
    }

    /// Ids of the plugins in use.
    pub(super) fn ids(&self) -> impl Iterator<Item = &String> {
        self.0.keys()
    }

    /// Takes out those that `is_stale`; the builds that went, as id and hash.
    pub(super) fn take_out(
        &mut self,
        is_stale: impl Fn(&str, &Instance<P>) -> bool,
    ) -> BTreeSet<(String, String)> {
        let mut gone = BTreeSet::new();
        for (id, builds) in &mut self.0 {
            builds.retain(|build| {
                let goes = is_stale(id, build);
                if goes {
                    gone.insert((id.clone(), build.hash.clone()));
                }
                !goes
            });
        }
        self.0.retain(|_, builds| !builds.is_empty());
        gone
    }

    /// A viewport was closed.
    pub(super) fn forget_viewport(&mut self, viewport: ViewportId) {
        for instance in self.0.values_mut().flatten() {
            instance.forget_viewport(viewport);
        }
    }

    /// Drops all.
    pub(super) fn clear(&mut self) {
        self.0.clear();
    }
}
