//! The menu bar.

use egui::{Button, KeyboardShortcut, MenuBar, ThemePreference, Ui};
use pointstage_engine::stage::Show;
use pointstage_scene::Camera;

use super::intent::{Intent, Intents, OpenMode, Part, Tab};
use super::navigation::{Axis, CameraMove, UpAxis};
use super::rows::RendererRow;
use super::session::ViewOptions;
use super::{legend, shortcuts};

/// What the menus show.
pub(crate) struct Menu<'a> {
    /// Every renderer found.
    pub(crate) renderers: &'a [RendererRow],
    /// The chosen renderer's id.
    pub(crate) chosen: &'a str,
    /// How the picture is shown.
    pub(crate) view: &'a ViewOptions,
    /// The eye.
    pub(crate) camera: &'a Camera,
    /// Targets that the renderer gives.
    pub(crate) targets: &'a [String],
    /// Whether the settings panel is open.
    pub(crate) is_settings_open: bool,
    /// Whether the log is open.
    pub(crate) is_log_open: bool,
}

/// The bar with all menus.
pub(crate) fn menu_ui(ui: &mut Ui, menu: &Menu<'_>, out: &mut Intents) {
    MenuBar::new().ui(ui, |ui| {
        ui.menu_button("File", |ui| file_ui(ui, out));
        ui.menu_button("View", |ui| view_ui(ui, menu, out));
        ui.menu_button("Renderer", |ui| renderer_ui(ui, menu, out));
        ui.menu_button("Window", |ui| window_ui(ui, menu, out));
        ui.menu_button("Help", |ui| {
            item(
                ui,
                "Keys and mouse",
                Some(shortcuts::KEYS),
                Intent::Toggle(Part::Keys),
                out,
            );
            item(ui, "About", None, Intent::Toggle(Part::About), out);
            ui.separator();
            ui.menu_button("For plugin authors", |ui| {
                item(
                    ui,
                    "Lose the graphics device",
                    None,
                    Intent::LoseDevice,
                    out,
                );
            });
        });
    });
}

fn item(
    ui: &mut Ui,
    name: &str,
    shortcut: Option<KeyboardShortcut>,
    intent: Intent,
    out: &mut Intents,
) {
    let mut button = Button::new(name);
    if let Some(shortcut) = shortcut {
        button = button.shortcut_text(shortcut_text(ui, shortcut));
    }
    if ui.add(button).clicked() {
        out.push(intent);
        ui.close();
    }
}

fn file_ui(ui: &mut Ui, out: &mut Intents) {
    item(
        ui,
        "Open…",
        Some(shortcuts::OPEN),
        Intent::ChooseFiles(OpenMode::Replace),
        out,
    );
    item(
        ui,
        "Open path…",
        Some(shortcuts::TYPE_PATH),
        Intent::TypePath(OpenMode::Replace),
        out,
    );
    item(
        ui,
        "Add to scene…",
        None,
        Intent::ChooseFiles(OpenMode::Add),
        out,
    );
    item(
        ui,
        "Add path to scene…",
        None,
        Intent::TypePath(OpenMode::Add),
        out,
    );
    ui.separator();
    item(ui, "Quit", Some(shortcuts::QUIT), Intent::Quit, out);
}

fn view_ui(ui: &mut Ui, menu: &Menu<'_>, out: &mut Intents) {
    item(
        ui,
        "Frame scene",
        None,
        Intent::Move(CameraMove::Frame),
        out,
    );
    ui.menu_button("Look from", |ui| {
        for (axis, name) in Axis::ALL {
            item(ui, name, None, Intent::Move(CameraMove::Axis(axis)), out);
        }
    });
    ui.menu_button("Up axis", |ui| {
        for (axis, name) in [(UpAxis::Y, "Y"), (UpAxis::Z, "Z")] {
            let is_now = UpAxis::of(menu.camera) == axis;
            if ui.radio(is_now, name).clicked() {
                out.push(Intent::Move(CameraMove::Upwards(axis)));
                ui.close();
            }
        }
    });
    item(
        ui,
        "Perspective or orthographic",
        None,
        Intent::Move(CameraMove::SwitchProjection),
        out,
    );
    ui.separator();
    ui.menu_button("Show", |ui| {
        show_choices_ui(ui, &menu.view.show, menu.targets, out);
    });
    item(
        ui,
        "Background, exposure, radius…",
        None,
        Intent::ChooseTab(Tab::View),
        out,
    );
}

/// Colours and every target, to choose one.
pub(crate) fn show_choices_ui(ui: &mut Ui, shown: &Show, targets: &[String], out: &mut Intents) {
    let colours = std::iter::once(Show::Colours);
    let others = targets
        .iter()
        .filter(|key| *key != "colour")
        .map(|key| Show::Target(key.clone()));
    for show in colours.chain(others) {
        if ui.radio(*shown == show, legend::title_of(&show)).clicked() {
            out.push(Intent::Show(show));
            ui.close();
        }
    }
}

fn renderer_ui(ui: &mut Ui, menu: &Menu<'_>, out: &mut Intents) {
    for row in menu.renderers {
        let radio = egui::RadioButton::new(row.id == menu.chosen, &row.title);
        let response = ui.add_enabled(row.obstacle.is_none(), radio);
        let response = match &row.obstacle {
            Some(obstacle) => response.on_disabled_hover_text(&obstacle.reason),
            None => response,
        };
        if response.clicked() {
            out.push(Intent::ChooseRenderer(row.id.clone()));
            ui.close();
        }
    }
    ui.separator();
    item(ui, "Settings…", None, Intent::ChooseTab(Tab::Renderer), out);
    item(ui, "Plugins…", None, Intent::ChooseTab(Tab::Plugins), out);
}

fn window_ui(ui: &mut Ui, menu: &Menu<'_>, out: &mut Intents) {
    let panels = [
        (
            "Settings panel",
            menu.is_settings_open,
            Part::Settings,
            shortcuts::SETTINGS,
        ),
        ("Log", menu.is_log_open, Part::Log, shortcuts::LOG),
    ];
    for (name, is_open, part, shortcut) in panels {
        let shortcut = shortcut_text(ui, shortcut);
        let button = Button::selectable(is_open, name).shortcut_text(shortcut);
        if ui.add(button).clicked() {
            out.push(Intent::Toggle(part));
            ui.close();
        }
    }
    ui.separator();
    ui.menu_button("Theme", theme_ui);
}

fn theme_ui(ui: &mut Ui) {
    let chosen = ui.ctx().options(|options| options.theme_preference);
    let themes = [
        (ThemePreference::System, "As the system"),
        (ThemePreference::Light, "Light"),
        (ThemePreference::Dark, "Dark"),
    ];
    for (theme, name) in themes {
        if ui.radio(theme == chosen, name).clicked() {
            ui.ctx().set_theme(theme);
            ui.close();
        }
    }
}

/// A shortcut as it stands in menus. The toolkit spells out signs that its font lacks, and one that it has.
fn shortcut_text(ui: &Ui, shortcut: KeyboardShortcut) -> String {
    ui.ctx().format_shortcut(&shortcut).replace("Comma", ",")
}
