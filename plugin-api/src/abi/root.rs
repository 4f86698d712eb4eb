//! The root module of a plugin library, and what `export!` needs to make one.

use super::objects::FactoryBox;
use super::values::ErrorRecord;
use abi_stable::StableAbi;
use abi_stable::library::RootModule;
use abi_stable::package_version_strings;
use abi_stable::sabi_types::VersionStrings;
use abi_stable::std_types::{RResult, RSlice, RVec};

/// What a plugin library exports.
#[repr(C)]
#[derive(StableAbi)]
#[sabi(kind(Prefix(prefix_ref = PluginRootRef)))]
#[sabi(missing_field(option))]
pub struct PluginRoot {
    /// Thread: any. The manifest, byte for byte as in the library's link section.
    pub manifest: extern "C" fn() -> RSlice<'static, u8>,
    /// Thread: worker. One factory for each entry of the manifest.
    #[sabi(last_prefix_field)]
    pub factories: extern "C" fn() -> RResult<RVec<FactoryBox>, ErrorRecord>,
}

impl RootModule for PluginRootRef {
    abi_stable::declare_root_module_statics! {PluginRootRef}
    const BASE_NAME: &'static str = "pointstage_plugin";
    const NAME: &'static str = "pointstage_plugin";
    const VERSION_STRINGS: VersionStrings = package_version_strings!();
}

/// Name of the symbol under which abi_stable looks for the library's header, with the closing NUL.
pub use abi_stable::library::ROOT_MODULE_LOADER_NAME_WITH_NUL;

/// Name of the link section that holds the manifest: ELF, and PE (at most 8 bytes).
pub const MANIFEST_SECTION: &str = ".ptstage";
/// Name of the link section on macOS: segment and section.
pub const MANIFEST_SECTION_MACHO: &str = "__DATA,__ptstage";
