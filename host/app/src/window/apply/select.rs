//! Carries out intents about surfels: the work is a worker's, its results come back into the scene here.

use std::sync::Arc;
use std::time::Instant;

use egui::Context;
use pointstage_engine::stage::Severity;
use pointstage_scene::edit::{Occluder, ScreenView};
use pointstage_scene::{
    Bounds, Cancelled, Job, MarkMode, Marks, Object, ObjectId, Revision, Scene,
};

use crate::window::app::App;
use crate::window::intent::SelectIntent;
use crate::window::loading::Finished;
use crate::window::selecting::{
    BRUSH_RADII, Clipboard, Depths, Drawn, Found, Pieces, Purpose, Reach, Tool, find_in_box,
    find_in_region, keep_in_box, take_pieces,
};
use crate::window::status::grouped;
use crate::window::tasks::guarded;

impl App {
    pub(super) fn apply_select(&mut self, intent: SelectIntent) {
        match intent {
            SelectIntent::Tool(tool) => {
                // A tool that is chosen again is put away.
                let is_same = self.selecting.tool == tool;
                self.selecting.tool = if is_same { Tool::Navigate } else { tool };
            }
            SelectIntent::Reach(reach) => self.selecting.reach = reach,
            SelectIntent::BrushRadius(radius) => {
                self.selecting.brush_radius =
                    radius.clamp(*BRUSH_RADII.start(), *BRUSH_RADII.end());
            }
            SelectIntent::Region(drawn, mode) => self.select_region(drawn, mode),
            SelectIntent::Invert => self.invert_marks(),
            SelectIntent::Clear => self.clear_marks(),
            SelectIntent::Cut => self.take("Cut surfels", Purpose::Cut),
            SelectIntent::Copy => self.take("Copy surfels", Purpose::Copy),
            SelectIntent::Delete => self.take("Delete surfels", Purpose::Delete),
            SelectIntent::Paste => self.paste(),
            SelectIntent::ToggleCropBox => {
                let bounds = self.session.scene.bounds_world();
                let crop_box = &mut self.selecting.crop_box;
                *crop_box = crop_box.is_none().then_some(bounds);
            }
            SelectIntent::SetCropBox(bounds) => self.selecting.crop_box = Some(bounds),
            SelectIntent::SelectInCropBox(mode) => {
                if let Some(bounds) = self.selecting.crop_box {
                    let find = move |scene: &Scene, job: &Job| {
                        let found = find_in_box(scene, &bounds, mode, job)?;
                        Ok(Finished::Found(Box::new(found)))
                    };
                    self.work_on_scene("Select in the crop box", find);
                }
            }
            SelectIntent::KeepInCropBox => self.crop(),
        }
    }

    /// Has a worker look for the surfels of a part of a view.
    fn select_region(&mut self, drawn: Drawn, mode: MarkMode) {
        let view = self.session.panes.get(drawn.view);
        let Some((pane, screen)) = view.zip(self.screens.get(drawn.view)) else {
            return;
        };
        let Some(viewport) = screen.viewport else {
            return;
        };
        let camera = pane.camera;
        let shown = screen.shown.as_deref();
        let depths = match self.selecting.reach {
            Reach::Through => None,
            Reach::Visible => {
                let depths = shown.and_then(|shown| Depths::of(shown, &camera));
                if depths.is_none() {
                    let text = "What is visible is known once the picture rests; try again then.";
                    self.log.say(Severity::Info, text, Instant::now());
                    return;
                }
                depths
            }
        };
        let size_px = depths.as_ref().map_or(viewport.size_px, Depths::size_px);
        self.work_on_scene("Select surfels", move |scene, job| {
            let view = ScreenView {
                camera: &camera,
                size_px,
                occluder: depths.as_ref().map(|depths| depths as &dyn Occluder),
            };
            let found = find_in_region(scene, view, &drawn.region(size_px), mode, job)?;
            Ok(Finished::Found(Box::new(found)))
        });
    }

    fn crop(&mut self) {
        if let Some(bounds) = self.selecting.crop_box {
            self.work_on_scene("Keep what is in the crop box", move |scene, job| {
                let pieces = keep_in_box(scene, &bounds, job)?;
                Ok(Finished::Pieces(Box::new(pieces)))
            });
        }
    }

    fn take(&mut self, title: &str, purpose: Purpose) {
        self.work_on_scene(title, move |scene, job| {
            let pieces = take_pieces(scene, purpose, job)?;
            Ok(Finished::Pieces(Box::new(pieces)))
        });
    }

    /// Has a worker do something with the scene as it is now.
    fn work_on_scene(
        &mut self,
        title: &str,
        work: impl FnOnce(&Scene, &Job) -> Result<Finished, Cancelled> + Send + 'static,
    ) {
        let (scene, name) = (Arc::clone(&self.session.scene), title.to_owned());
        self.tasks.push(title, move |job| {
            let failed = |panic| {
                Finished::Failed(format!(
                    "{name}: the program has a defect and stopped ({panic}); nothing was changed, please report it"
                ))
            };
            guarded(
                || work(&scene, job).unwrap_or_else(|Cancelled| Finished::Unchanged(name.clone())),
                failed,
            )
        });
    }

    /// Marks what a worker found.
    pub(in crate::window) fn take_found(&mut self, found: Found) {
        let Found { marks, mode } = found;
        let replaces = mode == MarkMode::Replace;
        self.change_marks(|object| {
            let found = marks.iter().find(|(id, _)| *id == object.id);
            let found = found.filter(|(_, marks)| marks.len() == object.geometry.surfel_count);
            match (object.marked(), found) {
                (None, None) => None,
                (Some(old), None) => (!replaces).then(|| Arc::clone(old)),
                (old, Some((_, new))) => {
                    let none = Arc::new(Marks::none(new.len()));
                    Some(Arc::new(old.unwrap_or(&none).combined(new, mode)))
                }
            }
        });
    }

    /// Marks just what was not marked, of visible objects.
    fn invert_marks(&mut self) {
        self.change_marks(|object| {
            let all = || Marks::all(object.geometry.surfel_count);
            match object.marked() {
                marks if !object.visible => marks.cloned(),
                Some(marks) => Some(Arc::new(marks.inverted())),
                None => Some(Arc::new(all())),
            }
        });
    }

    fn clear_marks(&mut self) {
        self.change_marks(|_| None);
    }

    fn change_marks(&mut self, marks_of: impl Fn(&Object) -> Option<Arc<Marks>>) {
        let objects = self.session.scene.objects().iter();
        let marks: Vec<(ObjectId, Option<Arc<Marks>>)> = objects
            .map(|object| (object.id, marks_of(object)))
            .collect();
        self.session.edit_scene(|scene| {
            for (id, marks) in marks {
                scene.set_marks(id, marks);
            }
        });
    }

    /// Puts what a worker made of objects in their place, and what it copied on the clipboard.
    pub(in crate::window) fn take_over_pieces(&mut self, ctx: &Context, pieces: Pieces) {
        let Pieces {
            purpose,
            copies,
            rests,
        } = pieces;
        let copied: usize = copies.iter().map(|copy| copy.geometry.surfel_count).sum();
        if !copies.is_empty() {
            self.selecting.clipboard = Clipboard::of(copies);
            ctx.copy_text(self.selecting.clipboard.token.clone());
        }
        let mut gone = 0;
        for rest in rests {
            let now = self.session.scene.object(rest.id);
            if now.is_none_or(|object| object.geometry.revision != rest.of) {
                let text = "An object changed while surfels were taken out of it; it stays as it is. Try again.";
                self.log.say(Severity::Warning, text, Instant::now());
                continue;
            }
            gone += rest.gone;
            self.session.edit_scene(|scene| match rest.geometry {
                None => {
                    scene.remove(rest.id);
                }
                Some(geometry) => {
                    scene.set_marks(rest.id, None);
                    scene.edit(rest.id, |object| {
                        object.geometry = Arc::new(geometry);
                        // It is no longer what the file holds.
                        object.source = None;
                        object.loader = None;
                        object.loaded = None;
                    });
                }
            });
        }
        let verb = match purpose {
            Purpose::Copy => "copied",
            Purpose::Cut => "cut",
            Purpose::Delete | Purpose::Crop => "deleted",
        };
        let count = if purpose == Purpose::Copy {
            copied
        } else {
            gone
        };
        let s = if count == 1 { "" } else { "s" };
        let text = format!("{} surfel{s} {verb}", grouped(count as u64));
        tracing::info!("{text}");
        self.log.say(Severity::Info, text, Instant::now());
    }

    /// Adds what was copied last, and marks it alone.
    fn paste(&mut self) {
        let pieces = Arc::clone(&self.selecting.clipboard.pieces);
        if pieces.is_empty() {
            return;
        }
        self.clear_marks();
        self.session.edit_scene(|scene| {
            for piece in pieces.iter() {
                let id = scene.add(Object {
                    id: ObjectId::next(),
                    revision: Revision::next(),
                    ..piece.clone()
                });
                let marks = Marks::all(piece.geometry.surfel_count);
                scene.set_marks(id, Some(Arc::new(marks)));
            }
        });
    }

    /// Selected surfels and surfels of all objects.
    pub(in crate::window) fn marked_counts(&self) -> [usize; 2] {
        let scene = &self.session.scene;
        [scene.marked_count(), scene.surfel_count()]
    }

    /// The box around all that is drawn, for the crop box.
    pub(in crate::window) fn scene_bounds(&self) -> Bounds {
        self.session.scene.bounds_world()
    }
}
