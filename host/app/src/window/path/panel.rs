//! The strip of the camera path below the picture: time, views, turntable, settings over time.

use egui::{Button, Checkbox, ComboBox, DragValue, ScrollArea, Slider, Ui};
use pointstage_plugin_api::settings_schema::SettingSchema;
use pointstage_scene::Easing;

use crate::camera_path::{Around, FPS, MOST_SECS, MotionPath, SettingTrack, Turntable, ViewKey};
use crate::window::intent::{Intents, PathIntent};
use crate::window::rows::Rows;
use crate::window::views::{ListWay, StoredViews, slot_key};

/// How long a turn takes at first, seconds.
const TURN_SECS: f64 = 4.0;

/// What the strip shows.
pub(crate) struct PathPanel<'a> {
    /// The path.
    pub(crate) path: &'a MotionPath,
    /// The time that is shown, seconds.
    pub(crate) time: f64,
    /// Whether it plays.
    pub(crate) is_playing: bool,
    /// Views to take.
    pub(crate) views: &'a StoredViews,
    /// Renderers and structures with their settings.
    pub(crate) rows: &'a Rows,
    /// Id of the renderer whose settings can be taken.
    pub(crate) renderer: &'a str,
    /// That of the structure.
    pub(crate) structure: Option<&'a str>,
    /// Why no pictures can be rendered.
    pub(crate) obstacle: Option<&'a str>,
}

/// The strip.
pub(crate) fn path_ui(ui: &mut Ui, panel: &PathPanel<'_>, out: &mut Intents) {
    time_ui(ui, panel, out);
    ui.separator();
    ui.columns(2, |columns| {
        if let [views, settings] = columns {
            ScrollArea::both()
                .id_salt("views of the path")
                .auto_shrink(false)
                .show(views, |ui| views_ui(ui, panel, out));
            ScrollArea::both()
                .id_salt("settings of the path")
                .auto_shrink(false)
                .show(settings, |ui| tracks_ui(ui, panel, out));
        }
    });
}

/// Play, the time, and what belongs to the path as a whole.
fn time_ui(ui: &mut Ui, panel: &PathPanel<'_>, out: &mut Intents) {
    let (path, duration) = (panel.path, panel.path.duration_s());
    ui.horizontal_wrapped(|ui| {
        ui.strong("Camera path");
        let word = if panel.is_playing { "Pause" } else { "Play" };
        let play = ui.add_enabled(duration > 0.0, Button::new(word));
        let nothing = "Nothing moves yet: add two views, a turntable, or two values of a setting";
        if play.on_disabled_hover_text(nothing).clicked() {
            out.push(PathIntent::TogglePlay);
        }
        let mut time = panel.time.min(duration);
        ui.spacing_mut().slider_width = 260.0;
        let slider = Slider::new(&mut time, 0.0..=duration.max(f64::MIN_POSITIVE))
            .suffix(" s")
            .fixed_decimals(2);
        let slider = ui.add_enabled(duration > 0.0, slider);
        if slider.accessible_name("Time").changed() {
            out.push(PathIntent::Scrub(time));
        }
        let mut loops = path.loops;
        if ui.add(Checkbox::new(&mut loops, "Loop")).changed() {
            out.push(PathIntent::Loop(loops));
        }
        duration_ui(ui, path, out);
        let mut fps = path.fps;
        let rate = DragValue::new(&mut fps)
            .range(FPS)
            .max_decimals(2)
            .suffix(" pictures/s");
        let rate = ui.add(rate).on_hover_text("Pictures a second of a film");
        if rate.accessible_name("Pictures a second").changed() {
            out.push(PathIntent::Rate(fps));
        }
        let obstacle = panel.obstacle.unwrap_or_default();
        let render = ui.add_enabled(panel.obstacle.is_none(), Button::new("Render frames…"));
        if render.on_disabled_hover_text(obstacle).clicked() {
            out.push(PathIntent::ShowDialog);
        }
        let clear = ui.add_enabled(!path.is_empty(), Button::new("Clear"));
        if clear
            .on_hover_text("Takes everything out; Undo brings it back")
            .clicked()
        {
            out.push(PathIntent::Clear);
        }
    });
}

fn duration_ui(ui: &mut Ui, path: &MotionPath, out: &mut Intents) {
    let mut secs = path.duration_s();
    let value = DragValue::new(&mut secs)
        .range(0.01..=MOST_SECS)
        // A path without parts takes no time.
        .clamp_existing_to_range(false)
        .speed(0.05)
        .max_decimals(2)
        .suffix(" s long");
    let value = ui.add_enabled(!path.is_empty(), value);
    if value.accessible_name("Duration").changed() {
        out.push(PathIntent::Duration(Some(secs)));
    }
    if path.duration.is_some() {
        let reset = ui.small_button("as its parts");
        if reset
            .on_hover_text("Until the last of its parts ends")
            .clicked()
        {
            out.push(PathIntent::Duration(None));
        }
    }
}

fn views_ui(ui: &mut Ui, panel: &PathPanel<'_>, out: &mut Intents) {
    ui.horizontal_wrapped(|ui| {
        ui.strong("Views");
        let add = ui
            .button("Add this view")
            .on_hover_text("Behind the last one");
        if add.clicked() {
            out.push(PathIntent::Append);
        }
        let here = format!("Set at {:.2} s", panel.time);
        let help = "This view is reached at the shown time";
        if ui.button(here).on_hover_text(help).clicked() {
            out.push(PathIntent::SetHere);
        }
        stored_ui(ui, panel.views, out);
        let has_turntable = panel.path.turntable.is_some();
        let turn = ui.add_enabled(!has_turntable, Button::new("Turntable"));
        let help = "Once around the scene; with no view yet, from this one";
        if turn.on_hover_text(help).clicked() {
            let turntable = Turntable::new(TURN_SECS, 360.0);
            out.push(PathIntent::Turntable(Some(turntable)));
        }
    });
    if let Some(turntable) = panel.path.turntable {
        turntable_ui(ui, turntable, out);
    }
    let count = panel.path.keys.len();
    for (index, key) in panel.path.keys.iter().enumerate() {
        ui.push_id(("view of the path", index), |ui| {
            view_ui(ui, key, index, count, out);
        });
    }
}

/// Views that were kept, to take.
fn stored_ui(ui: &mut Ui, views: &StoredViews, out: &mut Intents) {
    let slots = views.slots.iter().enumerate();
    let slots = slots.filter_map(|(slot, view)| Some((slot_key(slot).to_string(), (*view)?)));
    let named = views.named.iter();
    let named = named.map(|view| (view.name.clone(), view.record));
    let stored: Vec<_> = slots.chain(named).collect();
    ui.add_enabled_ui(!stored.is_empty(), |ui| {
        let combo = ComboBox::from_id_salt("stored view for the path").selected_text("Add stored…");
        combo
            .show_ui(ui, |ui| {
                for (name, view) in stored {
                    if ui.selectable_label(false, &name).clicked() {
                        out.push(PathIntent::AppendStored(name, view));
                    }
                }
            })
            .response
            .on_disabled_hover_text("No view is stored: Ctrl+1 stores one")
            .accessible_name("Add stored view");
    });
}

fn view_ui(ui: &mut Ui, key: &ViewKey, index: usize, count: usize, out: &mut Intents) {
    ui.horizontal(|ui| {
        let name = if key.name.is_empty() {
            format!("View {}", index + 1)
        } else {
            key.name.clone()
        };
        let go = ui.button(&name).on_hover_text("Show this time");
        if go.accessible_name(format!("Go to {name}")).clicked() {
            out.push(PathIntent::GoTo(index));
        }
        if let Some(time) = key_time_ui(ui, key.time, &format!("Time of {name}")) {
            out.push(PathIntent::SetTime(index, time));
        }
        let mut is_linear = key.easing == Easing::Linear;
        let linear = ui.checkbox(&mut is_linear, "even pace");
        let help = "From here on at an even pace, with corners; else smoothly";
        if linear.on_hover_text(help).changed() {
            let easing = if is_linear {
                Easing::Linear
            } else {
                Easing::Smooth
            };
            out.push(PathIntent::SetEasing(index, easing));
        }
        let buttons = [
            ("Overwrite", true, PathIntent::Overwrite(index)),
            ("Up", index > 0, PathIntent::Shift(index, ListWay::Up)),
            (
                "Down",
                index + 1 < count,
                PathIntent::Shift(index, ListWay::Down),
            ),
            ("Delete", true, PathIntent::Delete(index)),
        ];
        for (word, is_enabled, intent) in buttons {
            let button = ui.add_enabled(is_enabled, Button::new(word).small());
            if button.accessible_name(format!("{word} {name}")).clicked() {
                out.push(intent);
            }
        }
    });
}

/// A key's time; the new one if it was changed.
fn key_time_ui(ui: &mut Ui, time: f64, name: &str) -> Option<f64> {
    let mut edited = time;
    let value = DragValue::new(&mut edited)
        .range(0.0..=MOST_SECS)
        .speed(0.02)
        .max_decimals(2)
        .suffix(" s");
    let response = ui.add(value).accessible_name(name.to_owned());
    (response.changed() && edited != time).then_some(edited)
}

fn turntable_ui(ui: &mut Ui, turntable: Turntable, out: &mut Intents) {
    let mut edited = turntable;
    ui.horizontal(|ui| {
        ui.label("Turntable");
        let seconds = DragValue::new(&mut edited.seconds)
            .range(0.01..=MOST_SECS)
            .speed(0.05)
            .max_decimals(2)
            .suffix(" s");
        ui.add(seconds).accessible_name("Seconds of the turntable");
        let degrees = DragValue::new(&mut edited.degrees)
            .range(-36_000.0..=36_000.0)
            .max_decimals(1)
            .suffix("°");
        ui.add(degrees).accessible_name("Degrees of the turntable");
        let mut is_around_pivot = turntable.around == Around::Pivot;
        let pivot = ui.checkbox(&mut is_around_pivot, "around what it looks at");
        pivot.on_hover_text("Else around the middle of the scene");
        edited.around = if is_around_pivot {
            Around::Pivot
        } else {
            Around::Scene
        };
        let remove = ui
            .small_button("Delete")
            .accessible_name("Delete turntable");
        if remove.clicked() {
            out.push(PathIntent::Turntable(None));
        }
    });
    if edited != turntable {
        out.push(PathIntent::Turntable(Some(edited)));
    }
}

fn tracks_ui(ui: &mut Ui, panel: &PathPanel<'_>, out: &mut Intents) {
    ui.horizontal_wrapped(|ui| {
        ui.strong("Settings");
        let text = format!("Set value at {:.2} s…", panel.time);
        ComboBox::from_id_salt("setting for the path")
            .selected_text(text)
            .show_ui(ui, |ui| setting_choices_ui(ui, panel, out))
            .response
            .on_hover_text("Gives a setting the value that it has now at the shown time")
            .accessible_name("Set value");
    });
    for (index, track) in panel.path.tracks.iter().enumerate() {
        ui.push_id(("track", index), |ui| {
            track_ui(ui, panel, track, index, out);
        });
    }
}

/// All settings of who draws.
fn setting_choices_ui(ui: &mut Ui, panel: &PathPanel<'_>, out: &mut Intents) {
    let structure = panel.structure.and_then(|id| panel.rows.structure(id));
    for row in panel
        .rows
        .renderer(panel.renderer)
        .into_iter()
        .chain(structure)
    {
        ui.weak(&row.title);
        let settings = row.settings.iter();
        for setting in settings.filter(|setting| setting.default_value().is_some()) {
            if ui.selectable_label(false, &setting.label).clicked() {
                out.push(PathIntent::SetValue {
                    owner: row.id.clone(),
                    setting: setting.id.clone(),
                });
            }
        }
    }
}

fn track_ui(
    ui: &mut Ui,
    panel: &PathPanel<'_>,
    track: &SettingTrack,
    index: usize,
    out: &mut Intents,
) {
    let label = title_of(panel, track);
    ui.horizontal(|ui| {
        ui.label(&label);
        let again = ui.small_button(format!("Set at {:.2} s", panel.time));
        if again.accessible_name(format!("Set {label} here")).clicked() {
            out.push(PathIntent::SetValue {
                owner: track.owner.clone(),
                setting: track.setting.clone(),
            });
        }
        let delete = ui.small_button("Delete");
        if delete.accessible_name(format!("Delete {label}")).clicked() {
            out.push(PathIntent::DeleteTrack(index));
        }
    });
    ui.indent("values", |ui| {
        for (number, key) in track.keys.iter().enumerate() {
            ui.push_id(number, |ui| {
                ui.horizontal(|ui| {
                    let name = format!("Time of value {} of {label}", number + 1);
                    if let Some(time) = key_time_ui(ui, key.time, &name) {
                        out.push(PathIntent::SetValueTime(index, number, time));
                    }
                    ui.monospace(key.value.to_string());
                    let delete = ui.small_button("Delete");
                    let name = format!("Delete value {} of {label}", number + 1);
                    if delete.accessible_name(name).clicked() {
                        out.push(PathIntent::DeleteValue(index, number));
                    }
                });
            });
        }
    });
}

/// Whose setting a track changes, and which.
fn title_of(panel: &PathPanel<'_>, track: &SettingTrack) -> String {
    let owner = if track.owner.is_empty() {
        panel.renderer
    } else {
        &track.owner
    };
    let row = panel
        .rows
        .renderer(owner)
        .or_else(|| panel.rows.structure(owner));
    let is_meant = |setting: &&SettingSchema| setting.id == track.setting;
    let setting = row.and_then(|row| row.settings.iter().find(is_meant));
    let label = setting.map_or(&track.setting, |setting| &setting.label);
    let title = row.map_or(owner, |row| &row.title);
    format!("{label} ({title})")
}
