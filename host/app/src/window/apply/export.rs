//! Carries out intents about pictures in files: the stage draws and writes them as background work, and the list of tasks
//! shows how far it is.

use std::ops::ControlFlow;
use std::path::Path;
use std::time::Instant;

use pointstage_engine::stage::{Background, FrameRequest, Patience, SettingValues, Severity};

use crate::output::export::{
    CPU_TILE_PX, Export, ExportError, Exporting, Format, SMALL_TILE_PX, Saved,
};
use crate::output::record;
use crate::window::app::App;
use crate::window::dialogs::Asked;
use crate::window::intent::{Backdrop, ExportIntent, ImageFile, Replace, WindowIntent};
use crate::window::loading::Finished;
use crate::window::log::Offer;
use crate::window::save_image::SaveImage;
use crate::window::tasks::guarded;

impl App {
    pub(super) fn apply_export(&mut self, intent: ExportIntent) {
        match intent {
            ExportIntent::ShowDialog => {
                let previous = self.save_image.take().or(self.last_save_image.take());
                let name = self.session.scene.objects().first();
                let name = name.map_or("picture", |object| object.name.as_str());
                self.save_image = Some(previous.unwrap_or_else(|| SaveImage::new(name)));
            }
            ExportIntent::ChoosePath(path) => self.choose_files(Asked::SaveImage(path)),
            ExportIntent::SetPath(path) => {
                if let Some(dialog) = &mut self.save_image {
                    dialog.set_path(&path);
                }
            }
            ExportIntent::Save(image) => self.save(&image),
        }
    }

    fn save(&mut self, image: &ImageFile) {
        if image.replace == Replace::Ask && image.path.exists() {
            if let Some(dialog) = &mut self.save_image {
                dialog.ask_to_replace();
            }
            return;
        }
        let Some(format) = Format::of(&image.path) else {
            let text = format!(
                "{}: the name must end in .png or .exr",
                image.path.display()
            );
            return self.log.error(text, Instant::now());
        };
        self.last_save_image = self.save_image.take().map(SaveImage::for_next_time);
        let frame = self.frame_to_save(image);
        let export = Export {
            path: image.path.clone(),
            format,
            record: record::of_frame(&frame, &self.session.warnings, &image.path),
            frame,
            targets: Vec::new(),
            most_tile_px: if self.stage.draws_on_cpu() {
                CPU_TILE_PX
            } else {
                SMALL_TILE_PX
            },
        };
        let name = file_name(&image.path);
        let title = format!("Save {name}");
        tracing::info!("{title}");
        let lost = Finished::Failed(format!(
            "{}: not saved, because drawing has ended; restart the program",
            image.path.display()
        ));
        let mut task = Some(self.tasks.push_elsewhere(title, lost));
        let mut exporting = None;
        self.stage.background(move |stage| {
            let Some(running) = &task else {
                return ControlFlow::Break(());
            };
            let mut step = || match &mut exporting {
                Some(exporting) => Exporting::step(exporting, stage),
                none => Exporting::begin(export.clone(), running.job().clone()).map(|begun| {
                    *none = Some(begun);
                    None
                }),
            };
            let outcome = guarded(
                || step().map_err(|error| failed(&export, error)),
                |panic| {
                    Err(Finished::Failed(format!(
                        "{}: saving has a defect and stopped ({panic}); please report it",
                        export.path.display()
                    )))
                },
            );
            let finished = match outcome {
                Ok(None) => return ControlFlow::Continue(()),
                Ok(Some(saved)) => Finished::ImageSaved(Box::new(saved), export.frame.size_px),
                Err(finished) => finished,
            };
            // What is left of it goes before anybody hears of the end.
            exporting = None;
            if let Some(task) = task.take() {
                task.finish(finished);
            }
            ControlFlow::Break(())
        });
    }

    /// The present look in another size.
    pub(in crate::window) fn frame_to_save(&self, image: &ImageFile) -> FrameRequest {
        let session = &self.session;
        let renderer = self.drawing_renderer();
        let structure = &session.panes.active.structure;
        FrameRequest {
            lights: session.panes.active.lights.clone(),
            structure: structure.clone(),
            settings: session.settings_of(&renderer),
            structure_settings: structure
                .as_ref()
                .map_or_else(SettingValues::new, |id| session.settings_of(id)),
            show: session.panes.active.view.show.clone(),
            background: match image.backdrop {
                Backdrop::AsShown => session.panes.active.view.background,
                Backdrop::Transparent => Background::Transparent,
            },
            exposure: session.panes.active.view.exposure,
            radius_scale: session.panes.active.view.radius_scale,
            patience: Patience::DrawMeanwhile,
            ..FrameRequest::still(
                session.scene.clone(),
                session.panes.active.camera,
                image.size_px,
                renderer,
            )
        }
    }

    /// The renderer that draws the picture: the chosen one, or another one if that cannot draw this scene.
    fn drawing_renderer(&self) -> String {
        let chosen = self.rows.renderer(&self.session.panes.active.renderer);
        let drawing = chosen
            .filter(|row| row.obstacle.is_none())
            .or_else(|| self.rows.first_suitable());
        drawing.map_or_else(
            || self.session.panes.active.renderer.clone(),
            |row| row.id.clone(),
        )
    }

    /// Says where an image is.
    pub(in crate::window) fn tell_of_saved_image(&mut self, saved: Saved, size_px: [u32; 2]) {
        let now = Instant::now();
        let Saved { path, notices, .. } = saved;
        for notice in notices {
            self.log.add(notice, now);
        }
        let path = std::path::absolute(&path).unwrap_or(path);
        let [width, height] = size_px;
        let text = format!("Saved {} ({width} × {height} px)", path.display());
        tracing::info!("{text}");
        let intent = WindowIntent::Copy(path.display().to_string()).into();
        let offer = Offer {
            label: "Copy path",
            intent,
        };
        self.log.say_with(Severity::Info, text, offer, now);
    }
}

/// What comes of a step that failed.
fn failed(export: &Export, error: ExportError) -> Finished {
    match error {
        ExportError::Cancelled(_) => Finished::ImageCancelled(file_name(&export.path)),
        // It names the file.
        ExportError::Write(error) => Finished::Failed(error.to_string()),
        error => Finished::Failed(format!("{} was not saved: {error}", export.path.display())),
    }
}

fn file_name(path: &Path) -> String {
    let name = path.file_name().unwrap_or(path.as_os_str());
    name.to_string_lossy().into_owned()
}
