//! The camera path in the window: played ([`player`]), changed ([`edit`]), shown ([`panel`]), and rendered to files
//! ([`dialog`], [`filming`]).

mod dialog;
mod edit;
mod filming;
mod panel;
mod player;

pub(super) use dialog::{FilmDialog, FilmFacts};
pub(super) use filming::{Film, Filming};
pub(super) use panel::{PathPanel, path_ui};
pub(super) use player::Player;
