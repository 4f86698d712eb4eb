//! The system's dialog for a folder, on a thread of its own.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError, channel};

use super::intent::{Intents, PluginsIntent};

/// The system's dialog for a folder with plugins, while it is open.
pub(crate) struct FolderDialog {
    answer: Receiver<Option<PathBuf>>,
}

impl FolderDialog {
    /// Opens the dialog; `wake` is called from its thread once it closes.
    pub(crate) fn open(wake: Arc<dyn Fn() + Send + Sync>) -> std::io::Result<Self> {
        let (sender, answer) = channel();
        std::thread::Builder::new()
            .name("pointstage-dialog".to_owned())
            .spawn(move || {
                let chosen = rfd::FileDialog::new()
                    .set_title("Look for plugins in")
                    .pick_folder();
                // Nobody listens when the window has closed meanwhile.
                let _ = sender.send(chosen);
                wake();
            })?;
        Ok(Self { answer })
    }

    /// Pushes what was chosen, once. True while the dialog is open.
    pub(crate) fn poll(&self, out: &mut Intents) -> bool {
        match self.answer.try_recv() {
            Ok(folder) => {
                if let Some(folder) = folder {
                    out.push(PluginsIntent::AddFolder(folder));
                }
                false
            }
            Err(TryRecvError::Empty) => true,
            Err(TryRecvError::Disconnected) => false,
        }
    }
}
