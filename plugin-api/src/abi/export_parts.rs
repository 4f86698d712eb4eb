//! The unsafe half of `export!`.

use super::objects::FactoryBox;
use super::root::{PluginRoot, PluginRootRef};
use super::values::ErrorRecord;
use abi_stable::library::{CheckTypeLayout, LibHeader, RootModuleResult};
use abi_stable::prefix_type::PrefixTypeTrait as _;
use abi_stable::std_types::{RResult, RSlice, RVec};

/// The header that abi_stable's loader looks for.
pub const fn header(root: extern "C" fn() -> RootModuleResult) -> LibHeader {
    // SAFETY: `export!` passes only its own `root`, which answers with `load_root()`: an erased PluginRootRef.
    unsafe { LibHeader::from_constructor::<PluginRootRef>(root, CheckTypeLayout::Yes) }
}

/// Makes the root module on the heap, for ever.
pub fn leak_root(
    manifest: extern "C" fn() -> RSlice<'static, u8>,
    factories: extern "C" fn() -> RResult<RVec<FactoryBox>, ErrorRecord>,
) -> PluginRootRef {
    PluginRoot {
        manifest,
        factories,
    }
    .leak_into_prefix()
}

/// Runs `make` under abi_stable's own guard.
pub fn root_result(make: fn() -> PluginRootRef) -> RootModuleResult {
    abi_stable::library::__call_root_module_loader(make)
}
