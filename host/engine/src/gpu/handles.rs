//! The table of handles: who owns what, and of which kind.

use super::bytes::{Charge, OwnerState};
use super::tickets::Ticket;
use crate::device::GpuError;
use pointstage_plugin_api::abi::{BindingLayoutRecord, BufferUsage, Handle};
use std::collections::HashMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

/// Names an owner of GPU resources: one plugin instance.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Owner(pub(super) u32);

impl Owner {
    /// The host itself: its resources are there for all.
    pub(super) const HOST: Self = Self(0);
}

/// High half of the next handle. One counter for the process, so that a handle of a lost device is stale on the next.
static SERIALS: AtomicU32 = AtomicU32::new(1);

fn next_serial() -> u32 {
    loop {
        let serial = SERIALS.fetch_add(1, Ordering::Relaxed);
        // 0 would make `Handle::NONE`; it comes round after four billion handles.
        if serial != 0 {
            return serial;
        }
    }
}

/// Bytes shared by a resource and what refers to it; none for the host's.
pub(super) type SharedCharge = Option<Arc<Charge>>;

#[derive(Debug)]
pub(super) struct BufferEntry {
    pub(super) buffer: wgpu::Buffer,
    pub(super) usage: BufferUsage,
    pub(super) charge: SharedCharge,
}

#[derive(Debug)]
pub(super) struct TextureEntry {
    pub(super) texture: wgpu::Texture,
    /// Of the whole texture.
    pub(super) view: wgpu::TextureView,
    pub(super) charge: SharedCharge,
}

#[derive(Debug)]
pub(super) struct ViewEntry {
    pub(super) view: wgpu::TextureView,
    pub(super) charge: SharedCharge,
}

#[derive(Debug)]
pub(super) struct LayoutEntry {
    pub(super) layout: wgpu::BindGroupLayout,
    pub(super) bindings: Vec<BindingLayoutRecord>,
}

#[derive(Debug)]
pub(super) struct GroupEntry {
    pub(super) group: wgpu::BindGroup,
    /// Offsets that `SetBindGroup` must give.
    pub(super) dynamic_offsets: usize,
    /// Keeps the bytes of what is bound counted.
    #[expect(dead_code, reason = "held for its drop")]
    pub(super) charges: Vec<Arc<Charge>>,
}

#[derive(Debug)]
pub(super) struct ShaderEntry {
    pub(super) label: String,
    pub(super) module: wgpu::ShaderModule,
    pub(super) interface: super::shader::Interface,
}

#[derive(Debug)]
pub(super) struct RenderPipelineEntry {
    pub(super) pipeline: wgpu::RenderPipeline,
    pub(super) immediate_size: u32,
}

#[derive(Debug)]
pub(super) struct ComputePipelineEntry {
    pub(super) pipeline: wgpu::ComputePipeline,
    pub(super) immediate_size: u32,
}

/// Declares the kinds of resources: variant, its content, what it is called, and how it alone is fetched.
macro_rules! resources {
    ($($variant:ident($content:ty) $name:literal $($get:ident)?),* $(,)?) => {
        /// What a handle names.
        #[derive(Debug)]
        pub(super) enum Resource { $($variant($content)),* }

        impl Resource {
            pub(super) fn kind(&self) -> &'static str {
                match self { $(Self::$variant(_) => $name),* }
            }
        }

        $(impl From<$content> for Resource {
            fn from(content: $content) -> Self {
                Self::$variant(content)
            }
        })*

        impl Table {
            $($(pub(super) fn $get(&self, owner: Owner, handle: Handle) -> Result<&$content, GpuError> {
                match self.get(owner, handle) {
                    Some(Resource::$variant(content)) => Ok(content),
                    _ => Err(self.refusal(owner, handle, $name)),
                }
            })?)*
        }
    };
}

resources! {
    Buffer(BufferEntry) "a buffer" buffer,
    Texture(TextureEntry) "a texture" texture,
    View(ViewEntry) "a texture view",
    Sampler(wgpu::Sampler) "a sampler" sampler,
    Shader(ShaderEntry) "a shader" shader,
    Layout(LayoutEntry) "a bind group layout" layout,
    Group(GroupEntry) "a bind group" group,
    RenderPipeline(RenderPipelineEntry) "a render pipeline" render_pipeline,
    ComputePipeline(ComputePipelineEntry) "a compute pipeline" compute_pipeline,
    Ticket(Arc<Ticket>) "a ticket" ticket,
}

#[derive(Debug)]
struct Slot {
    serial: u32,
    owner: Owner,
    /// None: free.
    resource: Option<Resource>,
}

/// All resources of one device.
#[derive(Debug, Default)]
pub(super) struct Table {
    slots: Vec<Slot>,
    free: Vec<u32>,
    owners: HashMap<Owner, Arc<OwnerState>>,
}

impl Table {
    pub(super) fn add_owner(&mut self, owner: Owner, state: Arc<OwnerState>) {
        self.owners.insert(owner, state);
    }

    pub(super) fn owner(&self, owner: Owner) -> Option<&Arc<OwnerState>> {
        self.owners.get(&owner)
    }

    /// Adds a resource. The caller has checked that the owner is there.
    pub(super) fn insert(&mut self, owner: Owner, resource: impl Into<Resource>) -> Handle {
        let slot = Slot {
            serial: next_serial(),
            owner,
            resource: Some(resource.into()),
        };
        let serial = u64::from(slot.serial);
        let index = if let Some(index) = self.free.pop() {
            self.slots[index as usize] = slot;
            index
        } else {
            self.slots.push(slot);
            self.slots.len() as u32 - 1
        };
        Handle(serial << 32 | u64::from(index + 1))
    }

    /// Frees a resource of this owner; what has another owner, or none, stays.
    pub(super) fn remove(&mut self, owner: Owner, handle: Handle) -> Option<Resource> {
        let index = Self::index(handle)?;
        let slot = self.slots.get_mut(index)?;
        if slot.serial != (handle.0 >> 32) as u32 || slot.owner != owner {
            return None;
        }
        let resource = slot.resource.take()?;
        self.free.push(index as u32);
        Some(resource)
    }

    /// Frees all of an owner, and the owner.
    pub(super) fn remove_owner(&mut self, owner: Owner) -> Vec<Resource> {
        if let Some(state) = self.owners.remove(&owner) {
            state.freed.store(true, Ordering::Release);
        }
        let mut removed = Vec::new();
        for (index, slot) in self.slots.iter_mut().enumerate() {
            if slot.owner == owner
                && let Some(resource) = slot.resource.take()
            {
                self.free.push(index as u32);
                removed.push(resource);
            }
        }
        removed
    }

    /// Number of resources of an owner.
    pub(super) fn count(&self, owner: Owner) -> usize {
        self.slots
            .iter()
            .filter(|slot| slot.owner == owner && slot.resource.is_some())
            .count()
    }

    #[inline]
    fn index(handle: Handle) -> Option<usize> {
        (handle.0 as u32).checked_sub(1).map(|index| index as usize)
    }

    #[inline]
    fn slot(&self, handle: Handle) -> Option<&Slot> {
        self.slots
            .get(Self::index(handle)?)
            .filter(|slot| slot.serial == (handle.0 >> 32) as u32)
    }

    /// The resource, if this owner may use it.
    #[inline]
    pub(super) fn get(&self, owner: Owner, handle: Handle) -> Option<&Resource> {
        let slot = self.slot(handle)?;
        if slot.owner != owner && slot.owner != Owner::HOST {
            return None;
        }
        slot.resource.as_ref()
    }

    /// Whether the host owns it.
    pub(super) fn is_hosts(&self, handle: Handle) -> bool {
        self.slot(handle)
            .is_some_and(|slot| slot.owner == Owner::HOST)
    }

    /// Why the handle does not give what was expected.
    pub(super) fn refusal(&self, owner: Owner, handle: Handle, expected: &str) -> GpuError {
        let found = match self.slot(handle) {
            _ if handle == Handle::NONE => "no handle is given".to_owned(),
            None => format!("handle {:#x} is stale", handle.0),
            Some(Slot { resource: None, .. }) => {
                format!("handle {:#x} is stale: its resource was freed", handle.0)
            }
            Some(slot) if slot.owner != owner && slot.owner != Owner::HOST => {
                format!("handle {:#x} belongs to another plugin", handle.0)
            }
            Some(Slot {
                resource: Some(resource),
                ..
            }) => format!("handle {:#x} is {}", handle.0, resource.kind()),
        };
        GpuError::BadHandle(format!(
            "expected {expected}, but {found}; pass a live handle of that kind"
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ticket() -> Arc<Ticket> {
        Arc::new(Ticket::default())
    }

    #[test]
    fn a_reused_slot_refuses_the_old_handle() {
        let mut table = Table::default();
        let owner = Owner(7);
        let old = table.insert(owner, ticket());
        table.remove(owner, old).expect("it is there");
        let new = table.insert(owner, ticket());
        assert_eq!(old.0 as u32, new.0 as u32, "the slot is reused");
        assert!(table.ticket(owner, old).is_err());
        assert!(table.ticket(owner, new).is_ok());
        assert!(table.remove(owner, old).is_none());
        assert_eq!(table.count(owner), 1);
    }

    #[test]
    fn each_misuse_of_a_handle_has_its_own_message() {
        let mut table = Table::default();
        let (mine, theirs) = (Owner(1), Owner(2));
        let handle = table.insert(mine, ticket());
        let message = |owner, handle| match table.buffer(owner, handle) {
            Err(GpuError::BadHandle(message)) => message,
            other => panic!("expected a refusal, found {other:?}"),
        };
        assert!(message(mine, handle).contains("is a ticket"));
        assert!(message(theirs, handle).contains("another plugin"));
        assert!(message(mine, Handle::NONE).contains("no handle"));
        assert!(message(mine, Handle(u64::MAX)).contains("stale"));
        assert!(message(mine, Handle(handle.0 ^ 1 << 40)).contains("stale"));
    }

    #[test]
    fn what_the_host_owns_is_there_for_all_and_stays() {
        let mut table = Table::default();
        let handle = table.insert(Owner::HOST, ticket());
        assert!(table.ticket(Owner(5), handle).is_ok());
        assert!(table.remove(Owner(5), handle).is_none());
        assert!(table.ticket(Owner(5), handle).is_ok());
    }

    #[test]
    fn removing_an_owner_removes_all_of_it() {
        let mut table = Table::default();
        let handles: Vec<_> = (0..10)
            .map(|i| table.insert(Owner(i % 2), ticket()))
            .collect();
        assert_eq!(table.remove_owner(Owner(1)).len(), 5);
        assert_eq!(table.count(Owner(1)), 0);
        assert!(table.ticket(Owner(1), handles[1]).is_err());
        assert!(table.ticket(Owner(0), handles[0]).is_ok());
    }
}
