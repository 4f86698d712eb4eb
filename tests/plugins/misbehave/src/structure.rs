//! One structure per fault.

use pointstage_plugin_api::OwnBlock;
use pointstage_plugin_api::prelude::*;

/// Ends the process while it is prepared.
pub const ABORT_PREPARE: usize = 0;
/// Panics while it selects.
pub const PANIC_SELECT: usize = 1;

/// The structure with fault `FAULT`.
pub struct Faulty<const FAULT: usize>;

/// Its selector.
pub struct FaultySelector<const FAULT: usize>;

impl<const FAULT: usize> Structure for Faulty<FAULT> {
    type Selector = FaultySelector<FAULT>;

    fn prepare(
        _: &Host,
        _: Scene<'_>,
        _: Option<(&Self, Changes<'_>)>,
        _: Settings<'_>,
        _: &Progress<'_>,
    ) -> Result<Self> {
        if FAULT == ABORT_PREPARE {
            std::process::abort();
        }
        Ok(Self)
    }

    fn blocks(&self) -> Vec<OwnBlock<'_>> {
        Vec::new()
    }

    fn selector(&self, _: &Host) -> Result<FaultySelector<FAULT>> {
        Ok(FaultySelector)
    }
}

impl<const FAULT: usize> Selector<Faulty<FAULT>> for FaultySelector<FAULT> {
    fn select(&mut self, _: &Faulty<FAULT>, _: &Query<'_>) -> Result<Selection> {
        if FAULT == PANIC_SELECT {
            panic!("asked to panic in select");
        }
        Ok(Selection::new())
    }
}
