//! Intents about stored views.

/// What to do with stored views.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum ViewsIntent {
    /// Keep the present view under this number, 0 to 9.
    Store(usize),
    /// Look from the view of this number, 0 to 9.
    Recall(usize),
}
