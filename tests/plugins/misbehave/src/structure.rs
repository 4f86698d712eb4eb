//! Structures that end the process, or fail while they select.

use pointstage_plugin_api::OwnBlock;
use pointstage_plugin_api::prelude::*;

/// Ends the process while it is prepared.
pub struct Aborting;

/// Its selector, which there never is.
pub struct AbortingSelector;

impl Structure for Aborting {
    type Selector = AbortingSelector;

    fn prepare(
        _: &Host,
        _: Scene<'_>,
        _: Option<(&Self, Changes<'_>)>,
        _: Settings<'_>,
        _: &Progress<'_>,
    ) -> Result<Self> {
        std::process::abort()
    }

    fn blocks(&self) -> Vec<OwnBlock<'_>> {
        Vec::new()
    }

    fn selector(&self, _: &Host) -> Result<AbortingSelector> {
        Ok(AbortingSelector)
    }
}

impl Selector<Aborting> for AbortingSelector {
    fn select(&mut self, _: &Aborting, _: &Query<'_>) -> Result<Selection> {
        Ok(Selection::new())
    }
}

/// Panics while it selects.
pub struct Panicking;

/// Its selector.
pub struct PanickingSelector;

impl Structure for Panicking {
    type Selector = PanickingSelector;

    fn prepare(
        _: &Host,
        _: Scene<'_>,
        _: Option<(&Self, Changes<'_>)>,
        _: Settings<'_>,
        _: &Progress<'_>,
    ) -> Result<Self> {
        Ok(Self)
    }

    fn blocks(&self) -> Vec<OwnBlock<'_>> {
        Vec::new()
    }

    fn selector(&self, _: &Host) -> Result<PanickingSelector> {
        Ok(PanickingSelector)
    }
}

impl Selector<Panicking> for PanickingSelector {
    fn select(&mut self, _: &Panicking, _: &Query<'_>) -> Result<Selection> {
        panic!("asked to panic in select")
    }
}
