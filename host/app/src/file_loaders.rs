//! The loaders of the program: those that come with it, and those of its plugins, found when a file first needs them.

use std::sync::{Arc, Mutex, PoisonError};

use pointstage_engine::plugins::{self, Registry};
use pointstage_scene::{Loader, Loaders};

/// The loaders of a registry and the registry itself, once it has been asked for.
type Known = Option<(Arc<Registry>, Vec<Arc<dyn Loader>>)>;

/// The loaders that come with the program, and those of the registry that `registry` gives whenever it is asked: the same
/// one, or a newer one once plugins were looked for again.
pub(crate) fn loaders(
    registry: impl Fn() -> Option<Arc<Registry>> + Send + Sync + 'static,
) -> Loaders {
    let known: Mutex<Known> = Mutex::default();
    Loaders::built_in().with_others(move || {
        let Some(registry) = registry() else {
            return Vec::new();
        };
        let mut known = known.lock().unwrap_or_else(PoisonError::into_inner);
        match &*known {
            // They hold what they have loaded, so they are kept for as long as the registry is the same.
            Some((of, loaders)) if Arc::ptr_eq(of, &registry) => loaders.clone(),
            _ => {
                let loaders = plugins::loaders(&registry);
                *known = Some((registry, loaders.clone()));
                loaders
            }
        }
    })
}
