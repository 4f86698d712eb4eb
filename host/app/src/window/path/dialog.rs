//! The dialog that renders the path's pictures: where, how large, how many a second.

use egui::{Align2, Button, Context, DragValue, Key, TextEdit, Ui, Window};
use pointstage_engine::stage::{LARGEST_IMAGE_PX, Severity};

use crate::camera_path::FPS;
use crate::output::export::Format;
use crate::window::dialogs::typed_path;
use crate::window::intent::{FilmFiles, Intents, PathIntent, Replace};
use crate::window::theme;

/// The dialog, while it is open.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct FilmDialog {
    path: String,
    size_px: [u32; 2],
    fps: f64,
    asks_to_replace: bool,
    has_been_focused: bool,
}

/// What the dialog shows of the window.
#[derive(Clone, Debug)]
pub(crate) struct FilmFacts {
    /// How many pictures there are at so many a second, or why there are none.
    pub(crate) count: Result<u32, String>,
}

impl FilmDialog {
    /// A dialog that suggests a folder in the present one.
    pub(crate) fn new(size_px: [u32; 2], fps: f64) -> Self {
        let folder = std::env::current_dir().unwrap_or_default();
        let path = folder.join("frames").join("frame_%04d.png");
        Self {
            path: path.display().to_string(),
            size_px,
            fps,
            asks_to_replace: false,
            has_been_focused: false,
        }
    }

    /// Pictures a second.
    pub(crate) fn fps(&self) -> f64 {
        self.fps
    }

    /// Asks whether the files that are there may go.
    pub(crate) fn ask_to_replace(&mut self) {
        self.asks_to_replace = true;
    }

    /// The dialog. True while it is open.
    pub(crate) fn ui(&mut self, ctx: &Context, facts: &FilmFacts, out: &mut Intents) -> bool {
        let mut is_open = true;
        let mut is_done = ctx.input(|input| input.key_pressed(Key::Escape));
        Window::new("Render frames")
            .open(&mut is_open)
            .anchor(Align2::CENTER_CENTER, egui::Vec2::ZERO)
            .resizable(false)
            .collapsible(false)
            .show(ctx, |ui| {
                self.files_ui(ui);
                ui.add_space(6.0);
                self.size_ui(ui, facts);
                ui.add_space(6.0);
                is_done |= self.buttons_ui(ui, facts, out);
            });
        is_open && !is_done
    }

    fn files_ui(&mut self, ui: &mut Ui) {
        let label = ui.label("Files:");
        let field = TextEdit::singleline(&mut self.path)
            .desired_width(460.0)
            .hint_text("/home/me/frames/frame_%04d.png");
        let response = ui.add(field).labelled_by(label.id);
        if !self.has_been_focused {
            response.request_focus();
            self.has_been_focused = true;
        }
        self.asks_to_replace &= !response.changed();
        ui.weak("%04d stands for the number; .png, or .exr for all targets. The folder is made.");
    }

    fn size_ui(&mut self, ui: &mut Ui, facts: &FilmFacts) {
        ui.horizontal(|ui| {
            for (axis, name) in ["Width", "Height"].into_iter().enumerate() {
                let label = ui.label(name);
                let value = DragValue::new(&mut self.size_px[axis])
                    .range(1..=LARGEST_IMAGE_PX)
                    .suffix(" px");
                ui.add(value).labelled_by(label.id);
            }
            let label = ui.label("Pictures a second");
            let rate = DragValue::new(&mut self.fps).range(FPS).max_decimals(2);
            ui.add(rate).labelled_by(label.id);
        });
        match &facts.count {
            Ok(1) => ui.label("1 picture"),
            Ok(count) => ui.label(format!("{count} pictures")),
            Err(error) => ui.label(error),
        };
    }

    /// Render, Replace and Cancel; whether the dialog is done with.
    fn buttons_ui(&self, ui: &mut Ui, facts: &FilmFacts, out: &mut Intents) -> bool {
        if self.asks_to_replace {
            ui.horizontal(|ui| {
                theme::severity_label(ui, Severity::Warning);
                ui.label("There are such files already.");
            });
        }
        let mut is_done = false;
        ui.horizontal(|ui| {
            let (word, replace) = if self.asks_to_replace {
                ("Replace", Replace::Yes)
            } else {
                ("Render", Replace::Ask)
            };
            let path = typed_path(&self.path);
            let can_render = facts.count.is_ok() && Format::of(&path).is_some();
            let render = ui.add_enabled(can_render, Button::new(word));
            let help = "The name must end in .png or .exr, and there must be pictures";
            if render.on_disabled_hover_text(help).clicked() {
                out.push(PathIntent::Render(FilmFiles {
                    path,
                    size_px: self.size_px,
                    fps: self.fps,
                    replace,
                }));
            }
            is_done = ui.button("Cancel").clicked();
        });
        is_done
    }
}
