//! The objects that each side offers the other. Every method states its thread.

use super::commands::CommandListRecord;
use super::descriptors::{
    BindGroupDescriptor, BindGroupLayoutDescriptor, BufferDescriptor, ComputePipelineDescriptor,
    DeviceRecord, RenderPipelineDescriptor, SamplerDescriptor, ShaderDescriptor, TextureDescriptor,
    TextureViewDescriptor, TextureWriteRecord,
};
use super::frame::{
    FrameRecord, OutcomeRecord, SelectRecord, SelectionRecord, StructureBlockRecord,
};
use super::loading::LoaderBox;
use super::scene::{ChangeRecord, SceneRecord};
use super::values::{ErrorCode, ErrorRecord, Handle, LogLevel, SettingRecord, VersionRecord};
use abi_stable::sabi_types::RRef;
use abi_stable::std_types::{RArc, RBox, ROption, RResult, RSlice, RStr, RString, RVec};
use abi_stable::{StableAbi, sabi_trait};

/// Result of a border call.
pub type Outcome<T> = RResult<T, ErrorRecord>;

/// For what nobody thought of: a named object that takes numbered operations.
#[sabi_trait]
pub trait ExtensionObject: Send + Sync {
    /// Thread: as the extension's own documentation says.
    #[sabi(last_prefix_field)]
    fn call(&self, operation: u32, payload: RSlice<'_, u8>) -> RResult<RVec<u8>, ErrorRecord>;
}
pub type ExtensionBox = ExtensionObject_TO<'static, RBox<()>>;

/// The host's GPU service, one object per plugin instance. Thread: any; all calls are checked, none panics.
#[sabi_trait]
pub trait GpuObject: Send + Sync {
    fn device(&self) -> DeviceRecord;
    /// A WebGPU limit by its wgpu name ('max_storage_buffer_binding_size').
    fn limit(&self, name: RStr<'_>) -> ROption<u64>;
    /// 1 if the feature ('float32-blendable', 'shader-int64-atomic-min-max') was granted: the device has it and the
    /// manifest asks for it.
    fn feature(&self, name: RStr<'_>) -> u32;
    /// Layout of group 0 (`index` 0: frame and draw) or group 1 (columns).
    fn standard_layout(&self, index: u32) -> RResult<Handle, ErrorRecord>;
    fn create_buffer(&self, descriptor: &BufferDescriptor<'_>) -> RResult<Handle, ErrorRecord>;
    fn create_texture(&self, descriptor: &TextureDescriptor<'_>) -> RResult<Handle, ErrorRecord>;
    fn create_texture_view(
        &self,
        descriptor: &TextureViewDescriptor<'_>,
    ) -> RResult<Handle, ErrorRecord>;
    fn create_sampler(&self, descriptor: &SamplerDescriptor<'_>) -> RResult<Handle, ErrorRecord>;
    fn create_shader(&self, descriptor: &ShaderDescriptor<'_>) -> RResult<Handle, ErrorRecord>;
    fn create_bind_group_layout(
        &self,
        descriptor: &BindGroupLayoutDescriptor<'_>,
    ) -> RResult<Handle, ErrorRecord>;
    fn create_bind_group(
        &self,
        descriptor: &BindGroupDescriptor<'_>,
    ) -> RResult<Handle, ErrorRecord>;
    fn create_render_pipeline(
        &self,
        descriptor: &RenderPipelineDescriptor<'_>,
    ) -> RResult<Handle, ErrorRecord>;
    fn create_compute_pipeline(
        &self,
        descriptor: &ComputePipelineDescriptor<'_>,
    ) -> RResult<Handle, ErrorRecord>;
    /// Copies `data` before it returns; the write happens before any command submitted or recorded later.
    fn write_buffer(
        &self,
        buffer: Handle,
        offset: u64,
        data: RSlice<'_, u8>,
    ) -> RResult<(), ErrorRecord>;
    fn write_texture(
        &self,
        target: &TextureWriteRecord,
        data: RSlice<'_, u8>,
    ) -> RResult<(), ErrorRecord>;
    /// Thread: worker. Checks and runs commands now; in `render` they are returned instead.
    fn submit(&self, commands: &CommandListRecord) -> RResult<(), ErrorRecord>;
    /// A ticket for one `ReadBack` command.
    fn create_ticket(&self) -> RResult<Handle, ErrorRecord>;
    /// The bytes if they have arrived. Never waits.
    fn poll_ticket(&self, ticket: Handle) -> RResult<ROption<RVec<u8>>, ErrorRecord>;
    /// Frees a resource; of no effect on a stale handle.
    fn destroy(&self, handle: Handle);
    #[sabi(last_prefix_field)]
    fn extension(&self, name: RStr<'_>) -> ROption<ExtensionBox>;
}
pub type GpuRef = GpuObject_TO<'static, RArc<()>>;

/// The host, as one plugin instance sees it. Thread: any.
#[sabi_trait]
pub trait HostObject: Send + Sync {
    /// The border version that the host was built with: major, minor, patch.
    fn api_version(&self) -> VersionRecord;
    fn log(&self, level: LogLevel, text: RStr<'_>);
    /// The GPU service; none if the session has no device.
    fn gpu(&self) -> ROption<GpuRef>;
    /// Threads that the plugin may keep busy.
    fn thread_count(&self) -> u32;
    /// Folder of the plugin's original file (it is loaded from a copy).
    fn plugin_folder(&self) -> RString;
    #[sabi(last_prefix_field)]
    fn extension(&self, name: RStr<'_>) -> ROption<ExtensionBox>;
}
pub type HostRef = HostObject_TO<'static, RArc<()>>;

/// Another reference to the same host.
pub fn share_host(host: &HostRef) -> HostRef {
    HostObject_TO::from_sabi(host.obj.shallow_clone())
}

/// One running call: cancel and progress. Thread: any, while the call lasts.
#[sabi_trait]
pub trait CallObject: Send + Sync {
    /// 1 when the result is no longer wanted (cancelled, or the frame's deadline has passed).
    fn should_stop(&self) -> u32;
    /// `fraction` in 0..1.
    fn progress(&self, fraction: f32, stage: RStr<'_>);
    #[sabi(last_prefix_field)]
    fn extension(&self, name: RStr<'_>) -> ROption<ExtensionBox>;
}
pub type CallRef<'a> = CallObject_TO<'a, RRef<'a, ()>>;

/// What `prepare` is given.
#[repr(C)]
#[derive(StableAbi)]
pub struct PrepareRecord<'a> {
    pub host: HostRef,
    pub scene: SceneRecord<'a>,
    /// What changed since the previous preparation; empty for the first one.
    pub changes: RSlice<'a, ChangeRecord<'a>>,
    pub settings: RSlice<'a, SettingRecord<'a>>,
    pub call: CallRef<'a>,
}

/// Makes things of one kind: the plugin's side of one entry of the manifest.
#[sabi_trait]
pub trait FactoryObject: Send + Sync {
    /// Thread: any. 'renderer', 'structure', 'loader', …; a kind that the host does not know is ignored.
    fn kind(&self) -> RString;
    /// Thread: any. The id in the manifest.
    fn id(&self) -> RString;
    /// Thread: worker. Cancellable; GPU work allowed.
    fn prepare_renderer(&self, _call: &PrepareRecord<'_>) -> RResult<RendererBox, ErrorRecord> {
        unsupported("this factory makes no renderer")
    }
    /// Thread: worker. Cancellable; GPU work allowed.
    fn prepare_structure(&self, _call: &PrepareRecord<'_>) -> RResult<StructureBox, ErrorRecord> {
        unsupported("this factory makes no structure")
    }
    #[sabi(last_prefix_field)]
    fn extension(&self, _name: RStr<'_>) -> ROption<ExtensionBox> {
        ROption::RNone
    }
    /// Thread: any. Since 1.1.
    fn loader(&self) -> RResult<LoaderBox, ErrorRecord> {
        unsupported("this factory makes no loader")
    }
}
pub type FactoryBox = FactoryObject_TO<'static, RBox<()>>;

/// A renderer prepared for one state of the scene; shared by all its views.
#[sabi_trait]
pub trait RendererObject: Send + Sync {
    /// Thread: worker. The same for a changed scene or changed settings; this one goes on drawing meanwhile.
    fn prepare_next(&self, call: &PrepareRecord<'_>) -> RResult<RendererBox, ErrorRecord>;
    /// Thread: render or worker. One per viewport.
    fn view(&self, host: HostRef) -> RResult<ViewBox, ErrorRecord>;
    #[sabi(last_prefix_field)]
    fn extension(&self, _name: RStr<'_>) -> ROption<ExtensionBox> {
        ROption::RNone
    }
}
pub type RendererBox = RendererObject_TO<'static, RBox<()>>;

/// A renderer in one viewport.
#[sabi_trait]
pub trait ViewObject: Send {
    /// Thread: render. State: no other call on this view.
    fn render(&mut self, frame: &mut FrameRecord<'_>) -> RResult<OutcomeRecord, ErrorRecord>;
    #[sabi(last_prefix_field)]
    fn extension(&self, _name: RStr<'_>) -> ROption<ExtensionBox> {
        ROption::RNone
    }
}
pub type ViewBox = ViewObject_TO<'static, RBox<()>>;

/// A level-of-detail structure built for one state of the scene.
#[sabi_trait]
pub trait StructureObject: Send + Sync {
    /// Thread: worker.
    fn prepare_next(&self, call: &PrepareRecord<'_>) -> RResult<StructureBox, ErrorRecord>;
    /// Thread: worker. The structure's own blocks, which the host copies.
    fn blocks<'a>(&'a self) -> RResult<RVec<StructureBlockRecord<'a>>, ErrorRecord>;
    /// Thread: render or worker. One per viewport.
    fn selector(&self, host: HostRef) -> RResult<SelectorBox, ErrorRecord>;
    #[sabi(last_prefix_field)]
    fn extension(&self, _name: RStr<'_>) -> ROption<ExtensionBox> {
        ROption::RNone
    }
}
pub type StructureBox = StructureObject_TO<'static, RBox<()>>;

/// A structure in one viewport: finds the LOD cut.
#[sabi_trait]
pub trait SelectorObject: Send {
    /// Thread: render.
    fn select(&mut self, view: &SelectRecord<'_>) -> RResult<SelectionRecord, ErrorRecord>;
    #[sabi(last_prefix_field)]
    fn extension(&self, _name: RStr<'_>) -> ROption<ExtensionBox> {
        ROption::RNone
    }
}
pub type SelectorBox = SelectorObject_TO<'static, RBox<()>>;

/// An error value for what a side does not offer.
pub(super) fn unsupported<T>(what: &str) -> RResult<T, ErrorRecord> {
    RResult::RErr(ErrorRecord {
        code: ErrorCode::UNSUPPORTED,
        message: RString::from(what),
        detail: RString::new(),
    })
}
