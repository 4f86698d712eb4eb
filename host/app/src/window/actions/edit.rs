//! The *Edit* menu: undo and redo.

use super::Action;
use crate::window::app::App;

pub(super) fn actions(_app: &App) -> Vec<Action> {
    Vec::new()
}
