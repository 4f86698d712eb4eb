//! The dialog that saves the picture: where, how large, on what background.

use std::path::Path;

use egui::{Align2, Button, Checkbox, ComboBox, Context, DragValue, Key, TextEdit, Ui, Window};
use pointstage_engine::stage::LARGEST_IMAGE_PX;

use super::dialogs::typed_path;
use super::intent::{Backdrop, ExportIntent, ImageFile, Intents, Replace};
use super::theme;
use crate::output::export::Format;

/// The dialog, while it is open and until it is opened again.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SaveImage {
    path: String,
    size: SizeChoice,
    /// For [`SizeChoice::Typed`], px.
    typed_px: [u32; 2],
    is_transparent: bool,
    asks_to_replace: bool,
    has_been_focused: bool,
}

/// What the dialog shows of the window.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SaveFacts<'a> {
    /// Size of the picture on the screen, px.
    pub(crate) view_px: [u32; 2],
    /// Targets that the renderer gives: the layers of an EXR file.
    pub(crate) targets: &'a [String],
}

/// Sizes that have a name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum SizeChoice {
    View,
    TwiceView,
    FullHd,
    UltraHd,
    Typed,
}

impl SizeChoice {
    const ALL: [Self; 5] = [
        Self::View,
        Self::TwiceView,
        Self::FullHd,
        Self::UltraHd,
        Self::Typed,
    ];

    fn size_px(self, view_px: [u32; 2], typed_px: [u32; 2]) -> [u32; 2] {
        let size = match self {
            Self::View => view_px,
            Self::TwiceView => view_px.map(|side| side.saturating_mul(2)),
            Self::FullHd => [1920, 1080],
            Self::UltraHd => [3840, 2160],
            Self::Typed => typed_px,
        };
        size.map(|side| side.clamp(1, LARGEST_IMAGE_PX))
    }

    fn title(self, view_px: [u32; 2]) -> String {
        let [width, height] = self.size_px(view_px, view_px);
        match self {
            Self::View => format!("As shown, {width} × {height}"),
            Self::TwiceView => format!("Twice as shown, {width} × {height}"),
            Self::FullHd => format!("Full HD, {width} × {height}"),
            Self::UltraHd => format!("4K, {width} × {height}"),
            Self::Typed => "Other".to_owned(),
        }
    }
}

impl SaveImage {
    /// A dialog that suggests a file in the present folder named after the scene.
    pub(crate) fn new(scene_name: &str) -> Self {
        let name: String = scene_name
            .chars()
            .map(|letter| match letter {
                '/' | '\\' | ':' => '_',
                letter => letter,
            })
            .collect();
        let folder = std::env::current_dir().unwrap_or_default();
        Self {
            path: folder.join(name).display().to_string() + ".png",
            size: SizeChoice::View,
            typed_px: [1920, 1080],
            is_transparent: false,
            asks_to_replace: false,
            has_been_focused: false,
        }
    }

    /// The same, to be opened again.
    pub(crate) fn for_next_time(self) -> Self {
        Self {
            asks_to_replace: false,
            has_been_focused: false,
            ..self
        }
    }

    /// Fills in where the image goes.
    pub(crate) fn set_path(&mut self, path: &Path) {
        self.path = path.display().to_string();
        self.asks_to_replace = false;
    }

    /// Asks whether the file that is there may go.
    pub(crate) fn ask_to_replace(&mut self) {
        self.asks_to_replace = true;
    }

    /// The dialog. True while it is open.
    pub(crate) fn ui(&mut self, ctx: &Context, facts: &SaveFacts<'_>, out: &mut Intents) -> bool {
        let mut is_open = true;
        let mut is_done = ctx.input(|input| input.key_pressed(Key::Escape));
        Window::new("Save image")
            .open(&mut is_open)
            .anchor(Align2::CENTER_CENTER, egui::Vec2::ZERO)
            .resizable(false)
            .collapsible(false)
            .show(ctx, |ui| {
                let is_entered = self.path_ui(ui, out);
                let format = Format::of(Path::new(self.path.trim()));
                format_ui(ui, format, facts.targets);
                ui.add_space(6.0);
                self.size_ui(ui, facts.view_px);
                ui.add_space(6.0);
                let background = Checkbox::new(&mut self.is_transparent, "Transparent background");
                ui.add_enabled(format != Some(Format::Exr), background)
                    .on_disabled_hover_text("An EXR file holds the targets, without a background.");
                ui.add_space(6.0);
                is_done |= self.buttons_ui(ui, facts, format.is_some(), is_entered, out);
            });
        is_open && !is_done
    }

    /// The field for the path; whether Enter was pressed in it.
    fn path_ui(&mut self, ui: &mut Ui, out: &mut Intents) -> bool {
        let label = ui.label("File:");
        let response = ui
            .horizontal(|ui| {
                let field = TextEdit::singleline(&mut self.path)
                    .desired_width(420.0)
                    .hint_text("/home/me/picture.png");
                let response = ui.add(field).labelled_by(label.id);
                if ui.button("Choose…").clicked() {
                    out.push(ExportIntent::ChoosePath(typed_path(&self.path)));
                }
                response
            })
            .inner;
        if !self.has_been_focused {
            response.request_focus();
            self.has_been_focused = true;
        }
        if response.changed() {
            self.asks_to_replace = false;
        }
        // Enter leaves the keyboard to nobody. Where another widget has it, Enter was meant for that one.
        let is_entered = ui.input(|input| input.key_pressed(Key::Enter));
        let is_left = ui.memory(|memory| memory.focused().is_none());
        response.lost_focus() && is_left && is_entered
    }

    fn size_ui(&mut self, ui: &mut Ui, view_px: [u32; 2]) {
        ui.horizontal(|ui| {
            let label = ui.label("Size:");
            let combo = ComboBox::from_id_salt("size of the image")
                .selected_text(self.size.title(view_px))
                .width(220.0);
            let shown = combo.show_ui(ui, |ui| {
                for choice in SizeChoice::ALL {
                    ui.selectable_value(&mut self.size, choice, choice.title(view_px));
                }
            });
            shown.response.labelled_by(label.id);
        });
        let before = self.size.size_px(view_px, self.typed_px);
        let mut typed = before;
        ui.horizontal(|ui| {
            for (axis, name) in ["Width", "Height"].into_iter().enumerate() {
                let label = ui.label(name);
                let value = DragValue::new(&mut typed[axis])
                    .range(1..=LARGEST_IMAGE_PX)
                    .suffix(" px");
                ui.add(value).labelled_by(label.id);
            }
        });
        if typed != before {
            (self.size, self.typed_px) = (SizeChoice::Typed, typed);
        }
        let [width, height] = self.size.size_px(view_px, self.typed_px);
        let kept = height_of_shape(width, view_px);
        if kept.abs_diff(height) > 1 {
            ui.horizontal(|ui| {
                ui.weak("Another shape than the view: more or less shows at the sides.");
                if ui.small_button("Keep the view's shape").clicked() {
                    (self.size, self.typed_px) = (SizeChoice::Typed, [width, kept]);
                }
            });
        }
    }

    /// Save, Replace and Cancel; whether the dialog is done with.
    fn buttons_ui(
        &self,
        ui: &mut Ui,
        facts: &SaveFacts<'_>,
        has_format: bool,
        is_entered: bool,
        out: &mut Intents,
    ) -> bool {
        if self.asks_to_replace {
            ui.horizontal(|ui| {
                theme::severity_label(ui, pointstage_engine::stage::Severity::Warning);
                ui.label("There is such a file already.");
            });
        }
        let mut is_done = false;
        ui.horizontal(|ui| {
            let (label, replace) = if self.asks_to_replace {
                ("Replace", Replace::Yes)
            } else {
                ("Save", Replace::Ask)
            };
            let is_pressed = ui.add_enabled(has_format, Button::new(label)).clicked();
            // Enter never replaces a file: that is asked for by name.
            if has_format && (is_pressed || (is_entered && !self.asks_to_replace)) {
                out.push(ExportIntent::Save(ImageFile {
                    path: typed_path(&self.path),
                    size_px: self.size.size_px(facts.view_px, self.typed_px),
                    backdrop: if self.is_transparent {
                        Backdrop::Transparent
                    } else {
                        Backdrop::AsShown
                    },
                    replace,
                }));
            }
            is_done = ui.button("Cancel").clicked();
        });
        is_done
    }
}

/// Says what the extension stands for.
fn format_ui(ui: &mut Ui, format: Option<Format>, targets: &[String]) {
    match format {
        Some(Format::Png) => ui.weak("PNG: the picture as it is shown, 8 bits, sRGB."),
        Some(Format::Exr) => {
            let layers = targets.join(", ");
            ui.weak(format!(
                "EXR: the values of every target, a layer each ({layers})."
            ))
        }
        None => {
            ui.weak("The name must end in .png (the picture) or .exr (the values of all targets).")
        }
    };
}

/// The height that gives a picture of this width the view's shape.
fn height_of_shape(width: u32, view_px: [u32; 2]) -> u32 {
    let [view_width, view_height] = view_px.map(|side| u64::from(side.max(1)));
    let height = (u64::from(width) * view_height + view_width / 2) / view_width;
    u32::try_from(height)
        .unwrap_or(LARGEST_IMAGE_PX)
        .clamp(1, LARGEST_IMAGE_PX)
}

#[cfg(test)]
#[path = "save_image_tests.rs"]
mod tests;
