//! Carries out what the user asked for.

use std::path::PathBuf;
use std::time::Instant;

use egui::{Context, ViewportCommand};
use pointstage_engine::stage::{SettingValue, Severity};
use pointstage_scene::{LoadOptions, ObjectId, Provenance, WarningKind};

use super::app::App;
use super::dialogs::{FileDialog, PathField};
use super::intent::{Intent, OpenMode, Part};
use super::loading::{Batch, Place, flipped, load_file, with_estimates};

impl App {
    /// Carries out one intent.
    pub(super) fn apply(&mut self, ctx: &Context, intent: Intent) {
        tracing::debug!(?intent);
        match intent {
            Intent::ChooseFiles(mode) => self.choose_files(mode),
            Intent::TypePath(mode) => self.path_field = Some(PathField::new(mode)),
            Intent::Open(files, mode) => {
                self.dialog = None;
                self.open(files, mode);
            }
            Intent::Cancel(task) => self.tasks.cancel(task),
            Intent::Quit => ctx.send_viewport_cmd(ViewportCommand::Close),
            Intent::ChooseRenderer(id) => {
                tracing::info!("renderer chosen: {id}");
                self.session.renderer = id;
            }
            Intent::ChooseStructure(id) => self.session.structure = id,
            Intent::Set(id, value) => self.set(id, &value),
            Intent::Reset(id) => {
                if let Some(values) = self.session.settings.get_mut(&self.session.renderer) {
                    values.remove(&id);
                }
            }
            Intent::ResetAll => {
                self.session.settings.remove(&self.session.renderer);
            }
            Intent::Press(id) => self.asking.press(id),
            Intent::Move(camera_move) => self.move_camera(camera_move),
            Intent::Project(projection) => self.session.camera.projection = projection,
            Intent::Light(lights) => self.session.lights = lights,
            Intent::Show(show) => self.session.view.show = show,
            Intent::Background(background) => self.session.view.background = background,
            Intent::Exposure(exposure) => self.session.view.exposure = exposure,
            Intent::RadiusScale(scale) => self.session.view.radius_scale = scale,
            Intent::Estimate => self.estimate(),
            Intent::Flip(id) => self.flip(id),
            Intent::SetVisible(id, visible) => {
                self.session
                    .edit_scene(|scene| scene.edit(id, |object| object.visible = visible));
            }
            Intent::Remove(id) => {
                self.session.edit_scene(|scene| scene.remove(id));
                self.session.warnings.remove(&id);
            }
            Intent::RetryPlugin(path) => {
                self.stage.retry_plugin(path, self.session.scene.clone());
            }
            Intent::LoseDevice => {
                self.stage.lose_device();
                self.asking.invalidate();
            }
            Intent::Toggle(part) => self.toggle(part),
            Intent::Copy(text) => ctx.copy_text(text),
            Intent::Dismiss(id) => self.log.dismiss(id),
            Intent::ClearLog => self.log.clear(),
            Intent::ChooseTab(tab) => {
                self.panels.settings = true;
                self.panels.tab = tab;
            }
        }
    }

    /// Puts the loading of files into the queue.
    pub(super) fn open(&mut self, files: Vec<PathBuf>, mode: OpenMode) {
        let batch = Batch(self.next_batch);
        self.next_batch += 1;
        for path in files {
            self.push_load(
                path,
                LoadOptions::default(),
                Place::New(batch, mode),
                "Load",
            );
        }
    }

    fn push_load(&mut self, path: PathBuf, options: LoadOptions, place: Place, verb: &str) {
        let name = path.file_name().unwrap_or(path.as_os_str());
        let title = format!("{verb} {}", name.to_string_lossy());
        tracing::info!("{title}");
        self.tasks
            .push(title, move |job| load_file(&path, options, place, job));
    }

    fn choose_files(&mut self, mode: OpenMode) {
        match FileDialog::open(mode, self.wake.clone()) {
            Ok(dialog) => self.dialog = Some(dialog),
            Err(error) => self.log.error(
                format!("No file dialog can be opened ({error}); use File, Open path… instead."),
                Instant::now(),
            ),
        }
    }

    /// Keeps values that differ from the default, checked.
    fn set(&mut self, id: String, value: &SettingValue) {
        let row = self.rows.renderer(&self.session.renderer);
        let schema = row.and_then(|row| row.settings.iter().find(|setting| setting.id == id));
        match schema.map(|setting| setting.check(value)) {
            Some(Ok(value)) => {
                tracing::info!("setting {id} = {value}");
                let renderer = self.session.renderer.clone();
                self.session
                    .settings
                    .entry(renderer)
                    .or_default()
                    .insert(id, value);
            }
            Some(Err(error)) => self.log.error(error.to_string(), Instant::now()),
            // The renderer went away between showing the widget and applying its edit.
            None => {}
        }
    }

    fn estimate(&mut self) {
        let objects = self.without_estimates();
        if objects.is_empty() {
            let text = "No object with a file lacks normals or radii.";
            self.log.say(Severity::Info, text, Instant::now());
        }
        for (id, path) in objects {
            let options = with_estimates(self.loaded_as(id));
            self.push_load(
                path,
                options,
                Place::InsteadOf(id),
                "Estimate normals and radii of",
            );
        }
    }

    fn flip(&mut self, id: ObjectId) {
        let source = self
            .session
            .scene
            .object(id)
            .and_then(|object| object.source.clone());
        if let Some(path) = source {
            let options = flipped(self.loaded_as(id));
            self.push_load(path, options, Place::InsteadOf(id), "Flip");
        }
    }

    /// How the object's file was loaded, as its warnings tell.
    fn loaded_as(&self, id: ObjectId) -> LoadOptions {
        let is_flipped = self
            .session
            .warnings
            .get(&id)
            .is_some_and(|warnings| warnings.count(&WarningKind::Flipped) > 0);
        if is_flipped {
            flipped(LoadOptions::default())
        } else {
            LoadOptions::default()
        }
    }

    fn toggle(&mut self, part: Part) {
        let panel = match part {
            Part::Settings => &mut self.panels.settings,
            Part::Log => &mut self.panels.log,
            Part::Keys => &mut self.panels.keys,
            Part::About => &mut self.panels.about,
        };
        *panel = !*panel;
    }

    /// Objects that lack normals or radii, with the files to read them from again.
    fn without_estimates(&self) -> Vec<(ObjectId, PathBuf)> {
        let objects = self.session.scene.objects().iter();
        objects
            .filter(|object| {
                let origins = &object.geometry.origins;
                origins.normals == Provenance::Missing || origins.radii == Provenance::Missing
            })
            .filter_map(|object| Some((object.id, object.source.clone()?)))
            .collect()
    }
}
