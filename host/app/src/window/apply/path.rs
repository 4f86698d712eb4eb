//! Carries out intents about the camera path, and plays it from pass to pass.

use std::ops::ControlFlow;
use std::time::Instant;

use egui::Context;
use pointstage_engine::stage::{SettingValue, Severity};
use pointstage_plugin_api::settings_schema::SettingSchema;
use pointstage_scene::NearClipping;

use crate::camera_path::{
    Drawer, MotionPath, Track, TrackError, ValuesAt, frame_times, resolve, values_at,
};
use crate::output::export::{CPU_TILE_PX, ExportError, Format, SMALL_TILE_PX};
use crate::window::app::App;
use crate::window::intent::{Backdrop, FilmFiles, ImageFile, PathIntent, Replace};
use crate::window::loading::Finished;
use crate::window::path::{Film, FilmDialog, Filming};
use crate::window::tasks::guarded;

impl App {
    pub(super) fn apply_path(&mut self, ctx: &Context, intent: PathIntent) {
        let view = self.view_record();
        let (path, time) = (&mut self.session.path, self.player.time());
        match intent {
            PathIntent::Append => path.append("", view),
            PathIntent::AppendStored(name, view) => path.append(&name, view),
            PathIntent::SetHere => path.set_view_at(time, view),
            PathIntent::Overwrite(index) => {
                if let Some(key) = path.keys.get_mut(index) {
                    key.view = view;
                }
            }
            PathIntent::GoTo(index) => {
                if let Some(time) = path.keys.get(index).map(|key| key.time) {
                    self.scrub(ctx, time);
                }
            }
            PathIntent::SetTime(index, time) => path.set_time(index, time),
            PathIntent::SetEasing(index, easing) => {
                if let Some(key) = path.keys.get_mut(index) {
                    key.easing = easing;
                }
            }
            PathIntent::Shift(index, way) => path.shift(index, way),
            PathIntent::Delete(index) => {
                if index < path.keys.len() {
                    path.keys.remove(index);
                }
            }
            PathIntent::Turntable(turntable) => {
                // So that its beginning is in the session, wherever the camera is when that is saved.
                if turntable.is_some() && path.keys.is_empty() {
                    path.append("", view);
                }
                path.turntable = turntable;
            }
            PathIntent::Duration(secs) => path.duration = secs,
            PathIntent::Rate(fps) => path.fps = fps,
            PathIntent::Loop(loops) => path.loops = loops,
            PathIntent::SetValue { owner, setting } => self.set_value_here(&owner, &setting),
            PathIntent::SetValueTime(track, index, time) => path.set_value_time(track, index, time),
            PathIntent::DeleteValue(track, index) => path.delete_value(track, index),
            PathIntent::DeleteTrack(index) => {
                if index < path.tracks.len() {
                    path.tracks.remove(index);
                }
            }
            PathIntent::Clear => *path = MotionPath::default(),
            PathIntent::TogglePlay => self.toggle_play(),
            PathIntent::Scrub(time) => self.scrub(ctx, time),
            PathIntent::ShowDialog => {
                let dialog = FilmDialog::new([view.width, view.height], path.fps);
                self.film_dialog.get_or_insert(dialog);
            }
            PathIntent::Render(files) => self.film(&files),
        }
    }

    fn toggle_play(&mut self) {
        if self.player.is_playing() {
            return self.player.pause();
        }
        if let Err(error) = self.resolved_tracks() {
            self.log
                .error(format!("Camera path: {error}"), Instant::now());
        }
        self.stop_camera();
        self.player.play(self.session.path.duration_s());
        let camera = self.session.panes.active.camera;
        self.player.base(&camera);
        self.player.leave(camera);
    }

    fn scrub(&mut self, ctx: &Context, time: f64) {
        // What else this pass changed is a step of its own.
        self.note_history(ctx);
        self.stop_camera();
        self.player.scrub(time);
        self.show_path();
    }

    fn stop_camera(&mut self) {
        let around = self.surroundings();
        self.navigator
            .stop(&mut self.session.panes.active.camera, &around);
    }

    /// Goes on along the path, at the beginning of a pass. A camera that was moved by hand stops it.
    pub(in crate::window) fn advance_path(&mut self, ctx: &Context) {
        if !self.player.is_playing() {
            return;
        }
        let path = &self.session.path;
        let camera = &self.session.panes.active.camera;
        if path.moves_camera() && self.player.is_overtaken(camera) {
            return self.player.pause();
        }
        let now = ctx.input(|input| input.time);
        self.player.advance(now, path.duration_s(), path.loops);
        self.show_path();
        ctx.request_repaint();
    }

    /// Shows what the path says at the player's time. It is no change of the user's.
    fn show_path(&mut self) {
        let (path, time) = (&self.session.path, self.player.time());
        if path.moves_camera() {
            let base = self.player.base(&self.session.panes.active.camera);
            let camera = match path.way(base, &self.session.scene) {
                Ok(way) => way.at(time),
                Err(error) => {
                    self.player.pause();
                    return self.log.error(error.to_string(), Instant::now());
                }
            };
            let pane = &mut self.session.panes.active;
            pane.near = NearClipping::of(&camera);
            pane.camera = camera;
            self.player.leave(camera);
        }
        // Tracks that do not fit were told of when it began to play.
        let values = self
            .resolved_tracks()
            .map(|tracks| values_at(&tracks, time));
        self.take_values(values.unwrap_or_default());
        self.history.absorb(&self.session);
    }

    fn take_values(&mut self, values: ValuesAt) {
        let pane = &self.session.panes.active;
        let owners = [
            (Some(pane.renderer.clone()), values.renderer),
            (pane.structure.clone(), values.structure),
        ];
        for (owner, values) in owners {
            let Some(owner) = owner else { continue };
            let row = self
                .rows
                .renderer(&owner)
                .or_else(|| self.rows.structure(&owner));
            let settings = row.map_or(&[][..], |row| row.settings.as_slice());
            for (id, value) in values {
                let setting = settings.iter().find(|setting| setting.id == id);
                let default = setting.and_then(SettingSchema::default_value);
                let own = self.session.panes.active.settings.entry(owner.clone());
                let own = own.or_default();
                if default.as_ref() == Some(&value) {
                    own.remove(&id);
                } else {
                    own.insert(id, value);
                }
            }
        }
    }

    /// The path's tracks of those that draw.
    fn resolved_tracks(&self) -> Result<Vec<Track>, TrackError> {
        let pane = &self.session.panes.active;
        let renderer = self.rows.renderer(&pane.renderer).map(|row| (row, false));
        let structure = pane.structure.as_deref();
        let structure = structure.and_then(|id| Some((self.rows.structure(id)?, true)));
        let rows = renderer.into_iter().chain(structure);
        let drawers: Vec<Drawer<'_>> = rows
            .map(|(row, is_structure)| Drawer {
                id: &row.id,
                alias: &row.alias,
                schema: &row.settings,
                is_structure,
            })
            .collect();
        Ok(resolve(&self.session.path.tracks, &drawers)?.0)
    }

    /// Gives a setting its present value at the player's time.
    fn set_value_here(&mut self, owner: &str, setting: &str) {
        let pane = &self.session.panes.active;
        let id = if owner.is_empty() {
            pane.renderer.as_str()
        } else {
            owner
        };
        let row = self.rows.renderer(id).or_else(|| self.rows.structure(id));
        let schema = row.and_then(|row| row.settings.iter().find(|other| other.id == setting));
        let own = pane.settings.get(id).and_then(|values| values.get(setting));
        let value: Option<SettingValue> = own
            .cloned()
            .or_else(|| schema.and_then(SettingSchema::default_value));
        let time = self.player.time();
        if let Some(value) = value {
            self.session.path.set_value(owner, setting, time, value);
        }
    }

    /// The path as a film in the present look.
    fn film_of(&self, files: &FilmFiles, format: Format) -> Result<Film, String> {
        let path = &self.session.path;
        let frame = self.frame_to_save(&ImageFile {
            path: files.path.clone(),
            size_px: files.size_px,
            backdrop: Backdrop::AsShown,
            replace: Replace::Yes,
        });
        let mut player = self.player.clone();
        let base = player.base(&self.session.panes.active.camera);
        let way = path
            .way(base, &self.session.scene)
            .map_err(|error| error.to_string())?;
        let way = path.moves_camera().then_some(way);
        let tracks = self.resolved_tracks().map_err(|error| error.to_string())?;
        let end = path.duration_s();
        let is_closed = way.as_ref().is_none_or(|way| way.at(0.0) == way.at(end))
            && values_at(&tracks, 0.0) == values_at(&tracks, end);
        Ok(Film {
            frame,
            way,
            tracks,
            times: frame_times(end, files.fps, is_closed)?,
            path: files.path.clone(),
            format,
            warnings: self.session.warnings.clone(),
            most_tile_px: if self.stage.draws_on_cpu() {
                CPU_TILE_PX
            } else {
                SMALL_TILE_PX
            },
        })
    }

    /// How many pictures a film at so many a second has, or why there is none.
    pub(in crate::window) fn film_count(&self, fps: f64) -> Result<u32, String> {
        let files = FilmFiles {
            path: "frame.png".into(),
            size_px: [1, 1],
            fps,
            replace: Replace::Ask,
        };
        self.film_of(&files, Format::Png)
            .map(|film| film.times.count)
    }

    fn film(&mut self, files: &FilmFiles) {
        let now = Instant::now();
        let Some(format) = Format::of(&files.path) else {
            let text = format!(
                "{}: the name must end in .png or .exr",
                files.path.display()
            );
            return self.log.error(text, now);
        };
        let film = match self.film_of(files, format) {
            Ok(film) => film,
            Err(error) => return self.log.error(format!("Camera path: {error}"), now),
        };
        let count = film.times.count;
        if files.replace == Replace::Ask && (0..count).any(|index| film.file(index).exists()) {
            if let Some(dialog) = &mut self.film_dialog {
                dialog.ask_to_replace();
            }
            return;
        }
        if let Some(folder) = files.path.parent()
            && let Err(error) = std::fs::create_dir_all(folder)
        {
            let text = format!(
                "{}: the folder cannot be made: {error}; name one in a place that may be written to",
                folder.display()
            );
            return self.log.error(text, now);
        }
        self.film_dialog = None;
        self.player.pause();
        let title = format!("Render {count} pictures of the path");
        tracing::info!("{title}");
        let first = film.file(0);
        let lost = Finished::Failed(format!(
            "{}: not rendered, because drawing has ended; restart the program",
            first.display()
        ));
        let mut task = Some(self.tasks.push_elsewhere(title, lost));
        let mut filming = Filming::new(film);
        self.stage.background(move |stage| {
            let Some(running) = &task else {
                return ControlFlow::Break(());
            };
            let outcome = guarded(
                || filming.step(stage, running.job()).map_err(Some),
                |_| Err(None),
            );
            let done = filming.done();
            let finished = match outcome {
                Ok(false) => return ControlFlow::Continue(()),
                Ok(true) => Finished::Filmed(first.clone(), count),
                Err(Some(ExportError::Cancelled(_))) => Finished::FilmCancelled(done),
                Err(Some(error)) => Finished::Failed(format!(
                    "picture {} of the path was not rendered: {error}",
                    done + 1
                )),
                Err(None) => Finished::Failed(format!(
                    "picture {} of the path: rendering has a defect and stopped; please report it",
                    done + 1
                )),
            };
            filming.forget();
            if let Some(task) = task.take() {
                task.finish(finished);
            }
            ControlFlow::Break(())
        });
    }

    /// Says where the pictures of a film are.
    pub(in crate::window) fn tell_of_film(&mut self, first: &std::path::Path, count: u32) {
        let text = format!(
            "Rendered {count} pictures, the first is {}",
            first.display()
        );
        tracing::info!("{text}");
        self.log.say(Severity::Info, text, Instant::now());
    }
}
