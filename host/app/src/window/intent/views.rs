//! Intents about stored views.

use crate::window::views::ListWay;

/// What to do with stored views.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum ViewsIntent {
    /// Keep the present view under this number, 0 to 9.
    Store(usize),
    /// Look from the view of this number, 0 to 9.
    Recall(usize),
    /// Keep the present view at the end of the list.
    Add,
    /// Look from the view at this place of the list.
    RecallNamed(usize),
    /// Give the view at this place another name.
    Rename(usize, String),
    /// Put the present view in the place of this one, under the same name.
    Overwrite(usize),
    /// Take the view at this place out of the list.
    Delete(usize),
    /// Move the view at this place by one.
    Shift(usize, ListWay),
    /// Put the present view on the clipboard as text.
    Copy,
    /// Ask the system for the text on the clipboard.
    AskPaste,
    /// Look from the view that is written down here.
    Paste(String),
}
