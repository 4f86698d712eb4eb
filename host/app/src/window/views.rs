//! Views that were kept: ten by number, any number by name. Plain data.

use pointstage_scene::ViewRecord;

/// Views by number.
pub(crate) const SLOT_COUNT: usize = 10;

/// The views of a session.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct StoredViews {
    /// By number: Ctrl+N stores, N recalls.
    pub(crate) slots: [Option<ViewRecord>; SLOT_COUNT],
    /// By name, in the list's order.
    pub(crate) named: Vec<NamedView>,
}

/// A view with a name.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct NamedView {
    /// For people; unique in the list.
    pub(crate) name: String,
    /// Camera and picture size.
    pub(crate) record: ViewRecord,
    /// A small picture of it, encoded as PNG; empty if there is none.
    pub(crate) thumbnail: Vec<u8>,
}
