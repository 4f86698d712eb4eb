//! Ways to name files: the system's dialog on a thread of its own, and a field to type a path.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError, channel};

use egui::{Align2, Context, Key, TextEdit, Window};

use super::intent::{FileIntent, Intents, OpenMode};

/// A system dialog that is open.
pub(crate) struct FileDialog {
    answer: Receiver<Vec<PathBuf>>,
    mode: OpenMode,
}

impl FileDialog {
    /// Opens the system's dialog; `wake` is called from its thread once it closes.
    pub(crate) fn open(mode: OpenMode, wake: Arc<dyn Fn() + Send + Sync>) -> std::io::Result<Self> {
        let (sender, answer) = channel();
        std::thread::Builder::new()
            .name("pointstage-dialog".to_owned())
            .spawn(move || {
                let chosen = rfd::FileDialog::new()
                    .set_title("Open surfels or a mesh")
                    .add_filter("PLY", &["ply", "PLY"])
                    .add_filter("All files", &["*"])
                    .pick_files();
                // Nobody listens when the window has closed meanwhile.
                let _ = sender.send(chosen.unwrap_or_default());
                wake();
            })?;
        Ok(Self { answer, mode })
    }

    /// Pushes what was chosen, once. True while the dialog is open.
    pub(crate) fn poll(&self, out: &mut Intents) -> bool {
        match self.answer.try_recv() {
            Ok(files) => {
                if !files.is_empty() {
                    out.push(FileIntent::Open(files, self.mode));
                }
                false
            }
            Err(TryRecvError::Empty) => true,
            Err(TryRecvError::Disconnected) => false,
        }
    }
}

/// The field for a typed path.
#[derive(Debug)]
pub(crate) struct PathField {
    text: String,
    mode: OpenMode,
    has_been_focused: bool,
}

impl PathField {
    /// An empty field.
    pub(crate) fn new(mode: OpenMode) -> Self {
        Self {
            text: String::new(),
            mode,
            has_been_focused: false,
        }
    }

    /// The dialog. True while it is open.
    pub(crate) fn ui(&mut self, ctx: &Context, out: &mut Intents) -> bool {
        let mut is_open = true;
        let mut is_done = ctx.input(|input| input.key_pressed(Key::Escape));
        let title = match self.mode {
            OpenMode::Replace => "Open path",
            OpenMode::Add => "Add path to scene",
        };
        Window::new(title)
            .open(&mut is_open)
            .anchor(Align2::CENTER_CENTER, egui::Vec2::ZERO)
            .resizable(false)
            .collapsible(false)
            .show(ctx, |ui| {
                let label = ui.label("Path of a PLY file:");
                let field = TextEdit::singleline(&mut self.text)
                    .desired_width(420.0)
                    .hint_text("/home/me/scan.ply");
                let response = ui.add(field).labelled_by(label.id);
                if !self.has_been_focused {
                    response.request_focus();
                    self.has_been_focused = true;
                }
                let is_entered =
                    response.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
                ui.horizontal(|ui| {
                    let has_text = !self.text.trim().is_empty();
                    let is_pressed = ui
                        .add_enabled(has_text, egui::Button::new("Open"))
                        .clicked();
                    if has_text && (is_entered || is_pressed) {
                        out.push(FileIntent::Open(vec![typed_path(&self.text)], self.mode));
                        is_done = true;
                    }
                    is_done |= ui.button("Close").clicked();
                });
            });
        is_open && !is_done
    }
}

/// The path that a typed text means: without surrounding space or quotes, `~` for the home folder, `file://` of a pasted
/// address taken off.
pub(crate) fn typed_path(text: &str) -> PathBuf {
    let text = text.trim().trim_matches(['"', '\'']);
    let text = text.strip_prefix("file://").unwrap_or(text);
    if let Some(rest) = text.strip_prefix("~/")
        && let Ok(home) = etcetera::home_dir()
    {
        return home.join(rest);
    }
    PathBuf::from(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pasted_paths_lose_their_wrapping() {
        for text in ["/a b.ply", " /a b.ply\n", "\"/a b.ply\"", "file:///a b.ply"] {
            assert_eq!(typed_path(text), PathBuf::from("/a b.ply"), "{text:?}");
        }
    }
}
