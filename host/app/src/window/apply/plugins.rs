//! Carries out intents about plugin files.

use std::convert::Infallible;
use std::time::Instant;

use pointstage_engine::stage::Stage;

use crate::window::app::App;
use crate::window::folder_dialog::FolderDialog;
use crate::window::intent::PluginsIntent;

impl App {
    pub(super) fn apply_plugins(&mut self, intent: PluginsIntent) {
        match intent {
            PluginsIntent::Retry(path) => self.manage(move |stage| stage.retry_plugin(&path)),
            PluginsIntent::SetAside(path) => {
                tracing::info!("plugin set aside: {}", path.display());
                self.manage(move |stage| {
                    stage.set_plugin_aside(&path);
                });
            }
            PluginsIntent::Reload => self.manage(Stage::rescan),
            PluginsIntent::ChooseFolder => match FolderDialog::open(self.wake.clone()) {
                Ok(dialog) => self.folder_dialog = Some(dialog),
                Err(error) => self.log.error(
                    format!("No folder dialog can be opened ({error}); type the folder instead."),
                    Instant::now(),
                ),
            },
            PluginsIntent::AddFolder(folder) => {
                let scene = self.session.scene.clone();
                self.stage
                    .manage_plugins(scene, move |stage| stage.add_plugin_folder(&folder));
            }
            PluginsIntent::RemoveFolder(folder) => self.manage(move |stage| {
                stage.remove_plugin_folder(&folder);
            }),
            PluginsIntent::LoseDevice => {
                self.stage.lose_device();
                self.screens.active.asking.invalidate();
            }
        }
    }

    /// Does something about plugin files that cannot fail.
    fn manage(&mut self, act: impl FnOnce(&mut Stage) + Send + 'static) {
        let scene = self.session.scene.clone();
        self.stage.manage_plugins(scene, move |stage| {
            act(stage);
            Ok::<(), Infallible>(())
        });
    }
}
