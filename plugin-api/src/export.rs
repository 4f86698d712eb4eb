//! The macro that makes a plugin library of a crate.

/// Exports a crate's renderers, structures and loaders as a plugin library.
///
/// The first argument is the manifest, relative to the crate's folder. Then the types, in the order of the manifest's
/// entries of each kind:
///
/// ```ignore
/// pointstage_plugin_api::export! { "plugin.json", renderers: [Points], structures: [Tree], loaders: [Xyz] }
/// ```
///
/// The crate has to be a `cdylib`, and to be built with unwinding panics: the guards catch them.
#[macro_export]
macro_rules! export {
    ($manifest:literal $(, renderers: [$($renderer:ty),* $(,)?])? $(, structures: [$($structure:ty),* $(,)?])? $(, loaders: [$($loader:ty),* $(,)?])? $(,)?) => {
        #[cfg(panic = "abort")]
        compile_error!(
            "Pointstage plugins need unwinding panics, so that a panic can be caught at the border: \
             remove panic = \"abort\" from the profile"
        );

        const _: () = {
            use $crate::__export as export;

            const MANIFEST_LENGTH: usize =
                ::core::include_bytes!(::core::concat!(::core::env!("CARGO_MANIFEST_DIR"), "/", $manifest)).len();

            // The host reads this section without running any code of the library.
            #[used]
            #[cfg_attr(target_os = "macos", unsafe(link_section = "__DATA,__ptstage"))]
            #[cfg_attr(not(target_os = "macos"), unsafe(link_section = ".ptstage"))]
            static MANIFEST: [u8; MANIFEST_LENGTH] =
                *::core::include_bytes!(::core::concat!(::core::env!("CARGO_MANIFEST_DIR"), "/", $manifest));

            extern "C" fn manifest() -> export::RSlice<'static, u8> {
                export::RSlice::from_slice(&MANIFEST)
            }

            extern "C" fn factories() -> export::RResult<export::RVec<export::FactoryBox>, export::ErrorRecord> {
                export::collect_factories(
                    &MANIFEST,
                    &[$($(export::renderer_factory::<$renderer>),*)?],
                    &[$($(export::structure_factory::<$structure>),*)?],
                    &[$($(export::loader_factory::<$loader>),*)?],
                )
            }

            extern "C" fn root() -> export::RootModuleResult {
                export::root_result(|| export::leak_root(manifest, factories))
            }

            #[unsafe(export_name = "_1as_0lib_1header_0root_bmodule_bloader")]
            static HEADER: export::LibHeader = export::header(root);
        };
    };
}

/// What [`export!`](crate::export) expands to; not for use by hand.
#[doc(hidden)]
pub mod parts {
    pub use crate::abi::export_parts::{header, leak_root, root_result};
    pub use crate::abi::{ErrorRecord, FactoryBox};
    pub use crate::adapter::{
        collect_factories, loader_factory, renderer_factory, structure_factory,
    };
    pub use abi_stable::library::{LibHeader, RootModuleResult};
    pub use abi_stable::std_types::{RResult, RSlice, RVec};
}
