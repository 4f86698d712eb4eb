//! What the window shows, written to a file: the hook by which tests and scripts drive the window.
//!
//! With the environment variable `POINTSTAGE_UI_STATE=FILE`, the window writes FILE anew after every pass that changed
//! something: each widget by the role, name and place that a screen reader is told, and what the session holds. A driver
//! finds a button as a person does, by its text, clicks at its middle, and waits for the state that it expects. The user
//! guide (`docs/user-guide/driving.md`) lists the fields.

use std::path::PathBuf;

use egui::accesskit::{Node, NodeId, Role, Toggled, TreeUpdate};
use egui::{Context, Event, FullOutput, Plugin, RawInput};
use pointstage_engine::stage;
use pointstage_scene::ViewRecord;
use serde_json::{Map, Value, json};

use super::app::App;
use super::comparison::Numbers;
use crate::output::whole_file;

/// The environment variable that names the file.
const VARIABLE: &str = "POINTSTAGE_UI_STATE";

/// Watches the window and writes the file.
pub(crate) struct UiState {
    path: PathBuf,
    /// What the session held at the end of the pass.
    session: Value,
    /// Where the pass saw the pointer.
    pointer_px: Option<[f32; 2]>,
    /// How often a button was released: a driver that moves on before its click was seen takes it along.
    release_count: u64,
    /// Passes over the window so far: a window in which nothing changes makes none.
    pass_count: u64,
    written: String,
}

impl UiState {
    /// The writer, if the environment asks for one.
    pub(crate) fn from_environment() -> Option<Self> {
        let path = std::env::var_os(VARIABLE).filter(|path| !path.is_empty())?;
        Some(Self::new(path.into()))
    }

    fn new(path: PathBuf) -> Self {
        Self {
            path,
            session: Value::Null,
            pointer_px: None,
            release_count: 0,
            pass_count: 0,
            written: String::new(),
        }
    }

    fn write(&mut self, tree: &TreeUpdate, pixels_per_point: f32) {
        let state = json!({
            "session": self.session,
            "passes": self.pass_count,
            "pointer": { "at": self.pointer_px, "releases": self.release_count },
            "widgets": widgets(tree, f64::from(pixels_per_point)),
        });
        let text = state.to_string();
        if text == self.written {
            return;
        }
        match whole_file::replace(&self.path, text.as_bytes()) {
            Ok(()) => self.written = text,
            Err(error) => tracing::error!("{VARIABLE}: {error}"),
        }
    }
}

impl Plugin for UiState {
    fn debug_name(&self) -> &'static str {
        "ui state"
    }

    /// The platform's own reader switches the tree off when nobody listens to it; this one always does.
    fn input_hook(&mut self, ctx: &Context, input: &mut RawInput) {
        ctx.enable_accesskit();
        let is_release =
            |event: &&Event| matches!(event, Event::PointerButton { pressed: false, .. });
        self.release_count += input.events.iter().filter(is_release).count() as u64;
    }

    fn output_hook(&mut self, ctx: &Context, output: &mut FullOutput) {
        self.pass_count += 1;
        if let Some(tree) = output.platform_output.accesskit_update.take() {
            self.write(&tree, ctx.pixels_per_point());
            output.platform_output.accesskit_update = Some(tree);
        }
    }
}

/// Every widget that has a place and a name or a value, from top to bottom and from left to right.
fn widgets(tree: &TreeUpdate, pixels_per_point: f64) -> Vec<Value> {
    let mut placed: Vec<([i64; 4], Value)> = tree
        .nodes
        .iter()
        .filter_map(|(id, node)| {
            let (rect_px, mut widget) = widget(node, tree, pixels_per_point)?;
            if *id == tree.focus {
                widget["focused"] = json!(true);
            }
            Some((rect_px, widget))
        })
        .collect();
    // The tree comes in no order.
    placed.sort_by_cached_key(|([left, top, ..], widget)| (*top, *left, widget.to_string()));
    placed.into_iter().map(|(_, widget)| widget).collect()
}

fn widget(node: &Node, tree: &TreeUpdate, pixels_per_point: f64) -> Option<([i64; 4], Value)> {
    // A run of text repeats the label that it is part of.
    let is_shown = !node.is_hidden() && node.role() != Role::TextRun;
    let bounds = node.bounds().filter(|_| is_shown)?;
    let rect_px = [bounds.x0, bounds.y0, bounds.x1, bounds.y1]
        .map(|edge| (edge * pixels_per_point).round() as i64);
    let mut widget = Map::new();
    if let Some(name) = name(node, tree) {
        widget.insert("name".to_owned(), json!(name));
    }
    if let Some(value) = node.value() {
        widget.insert("value".to_owned(), json!(value));
    } else if let Some(value) = node.numeric_value() {
        widget.insert("value".to_owned(), json!(value));
    }
    if widget.is_empty() {
        return None;
    }
    widget.insert("role".to_owned(), json!(format!("{:?}", node.role())));
    widget.insert("rect".to_owned(), json!(rect_px));
    if let Some(toggled) = node.toggled() {
        widget.insert("on".to_owned(), json!(toggled == Toggled::True));
    }
    if node.is_disabled() {
        widget.insert("disabled".to_owned(), json!(true));
    }
    Some((rect_px, Value::Object(widget)))
}

/// The node's own name, or the texts that label it.
fn name(node: &Node, tree: &TreeUpdate) -> Option<String> {
    if let Some(label) = node.label() {
        return Some(label.to_owned());
    }
    let text_of = |id: &NodeId| {
        let (_, node) = tree.nodes.iter().find(|(other, _)| other == id)?;
        node.value().or(node.label()).map(ToOwned::to_owned)
    };
    let texts: Vec<String> = node.labelled_by().iter().filter_map(text_of).collect();
    (!texts.is_empty()).then(|| texts.join(" "))
}

impl App {
    /// Tells the writer, if there is one, what the session holds. `is_settled` says that nothing is under way: the picture
    /// on the screen is the final one of what the session holds.
    pub(super) fn report_state(&self, ctx: &Context, is_settled: bool) {
        let pixels_per_point = ctx.pixels_per_point();
        let pointer = ctx.input(|input| input.pointer.latest_pos());
        let pointer_px = pointer.map(|at| [at.x, at.y].map(|side| side * pixels_per_point));
        ctx.with_plugin(|ui_state: &mut UiState| {
            ui_state.session = self.state(is_settled);
            ui_state.pointer_px = pointer_px;
        });
    }

    /// Which of the two chosen renderers was asked last, in a word.
    fn role(&self) -> &'static str {
        let wish = self.screens.active.asking.last_wish();
        match wish.map_or(stage::Role::Main, |wish| wish.role) {
            stage::Role::Preview => "preview",
            stage::Role::Main | stage::Role::Auxiliary => "main",
        }
    }

    /// Each view beside the others: what draws it, its picture, and how far that is from the reference.
    fn panes_state(&self) -> Vec<Value> {
        let views = self.session.panes.iter().zip(self.screens.iter());
        let state = views.enumerate().map(|(index, (pane, screen))| {
            let shown = screen.shown.as_deref();
            let size_px = screen.viewport.map_or([0; 2], |viewport| viewport.size_px);
            let unmet = super::comparison::unmet(&self.session, &self.rows, index);
            let unmet: Vec<String> = unmet.into_iter().map(|unmet| unmet.0).collect();
            json!({
                "renderer": pane.renderer,
                "settings": pane.settings_of(&pane.renderer),
                "drawn_by": shown.map(|shown| &shown.drawn_by),
                "picture_px": shown.map(|shown| shown.picture.size_px),
                "rect": screen.viewport.map(|viewport| {
                    let rect = viewport.rect;
                    [rect.left(), rect.top(), rect.right(), rect.bottom()]
                }),
                "view": ViewRecord::new(pane.camera, size_px[0], size_px[1]),
                "scene_bytes": shown.map(|shown| shown.stats.scene_bytes),
                "unmet": unmet,
                "numbers": self.comparing.numbers(screen.shown.as_ref()).map(Numbers::in_words),
            })
        });
        state.collect()
    }

    fn state(&self, is_settled: bool) -> Value {
        let session = &self.session;
        let shown = self.screens.active.shown.as_deref();
        let preparing = shown.and_then(|shown| shown.preparing.as_ref());
        let size_px = self
            .screens
            .active
            .viewport
            .map_or([0; 2], |viewport| viewport.size_px);
        let objects = session.scene.objects().iter();
        let tasks = self.tasks.open().iter();
        let messages = self.log.entries().iter();
        json!({
            "settled": is_settled,
            "renderer": session.panes.active.renderer,
            "settings": session.chosen_settings(),
            "drawn_by": shown.map(|shown| &shown.drawn_by),
            "preview": session.panes.active.preview,
            "role": self.role(),
            "hand_over_ms": self.screens.active.roles.hand_over().map(|time| time.as_secs_f64() * 1e3),
            "host_ms": {
                "ask": self.host_times.ask.as_secs_f64() * 1e3,
                "engine": self.host_times.engine.as_secs_f64() * 1e3,
                "show": self.host_times.show.as_secs_f64() * 1e3,
            },
            "picture_px": shown.map(|shown| shown.picture.size_px),
            "pinned": self.inspector.pinned_surfel().map(|(object, surfel)| json!({
                "object": object,
                "surfel": surfel,
            })),
            "preparing": preparing.map(|preparing| &preparing.id),
            "structure": session.panes.active.structure,
            "pacing": {
                "rate_limit": session.pacing.rate_limit,
                "target_rate": session.pacing.target_rate,
            },
            "preset": super::presets::list(session, &session.panes.active.renderer).active,
            "undo": self.history.next_undo(),
            "redo": self.history.next_redo(),
            "objects": objects.map(|object| json!({
                "name": object.name,
                "surfels": object.geometry.surfel_count,
                "selected": object.selected,
            })).collect::<Vec<_>>(),
            "view": ViewRecord::new(session.panes.active.camera, size_px[0], size_px[1]),
            "lights": session.panes.active.lights,
            "flight": self.navigator.is_flight(),
            "flying": self.is_flying(),
            "tool": self.selecting.tool.key(),
            "surfels_selected": session.scene.marked_count(),
            "turntable": session.navigation.turntable,
            "panes": self.panes_state(),
            "comparison": {
                "linked": session.comparison.is_linked,
                "fair": session.comparison.is_locked,
                "layout": session.comparison.way.key(),
                "against": session.comparison.against,
                "split": session.comparison.split,
                "wipe": self.comparing.wipe,
                "zoom": self.comparing.zoom.map(|zoom| zoom.factor),
                "active": session.panes.active_index(),
                "difference": self.comparing.difference.is_some(),
            },
            "views": {
                "slots": session.views.slots.iter().map(Option::is_some).collect::<Vec<_>>(),
                "named": session.views.named.iter().map(|view| &view.name).collect::<Vec<_>>(),
            },
            "show": super::legend::title_of(&session.panes.active.view.show),
            "tasks": tasks.map(|task| json!({
                "title": task.title,
                "progress": task.job.progress(),
            })).collect::<Vec<_>>(),
            "messages": messages.map(|entry| json!({
                "severity": super::log::word(entry.notice.severity).to_lowercase(),
                "plugin": entry.notice.plugin,
                "text": entry.notice.text,
            })).collect::<Vec<_>>(),
            "adapter": self.stage.adapter(),
            "recent": self.remembered.recent.paths(),
            "path": {
                "views": session.path.keys.iter().map(|key| key.time).collect::<Vec<_>>(),
                "tracks": session.path.tracks.iter().map(|track| &track.setting).collect::<Vec<_>>(),
                "turntable": session.path.turntable.is_some(),
                "duration": session.path.duration_s(),
                "time": self.player.time(),
                "playing": self.player.is_playing(),
            },
            "session_path": self.remembered.session_path,
            "theme": self.remembered.appearance().0,
            "text_scale": self.remembered.appearance().1,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Runs one pass with `add` under a writer, and reads the file.
    fn state_of(add: impl FnMut(&mut egui::Ui)) -> Value {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("state.json");
        let ctx = Context::default();
        ctx.add_plugin(UiState::new(path.clone()));
        let input = RawInput {
            screen_rect: Some(egui::Rect::from_min_size(
                egui::Pos2::ZERO,
                egui::vec2(200.0, 100.0),
            )),
            ..RawInput::default()
        };
        // Nobody draws.
        ctx.run_ui(input, add).textures_delta.clear();
        let text = std::fs::read_to_string(path).expect("the file was written");
        serde_json::from_str(&text).expect("it is JSON")
    }

    fn named<'a>(state: &'a Value, role: Role, name: &str) -> Option<&'a Value> {
        let widgets = state["widgets"].as_array()?;
        let role = format!("{role:?}");
        widgets
            .iter()
            .find(|widget| widget["name"] == name && widget["role"] == *role)
    }

    #[test]
    fn the_widget_with_the_keyboard_is_told() {
        let state = state_of(|ui| {
            let _ = ui.button("Open");
            ui.button("Save").request_focus();
        });
        let save = named(&state, Role::Button, "Save").expect("the button");
        assert_eq!(save["focused"], true, "{save}");
        let open = named(&state, Role::Button, "Open").expect("the other button");
        assert_eq!(open["focused"], Value::Null, "{open}");
    }

    #[test]
    fn widgets_are_found_by_the_names_that_people_see() {
        let state = state_of(|ui| {
            let _ = ui.radio(true, "Points");
            ui.add_enabled(false, egui::Button::new("Open"));
            let label = ui.label("Path");
            let mut text = "a.ply".to_owned();
            ui.text_edit_singleline(&mut text).labelled_by(label.id);
        });
        let radio = named(&state, Role::RadioButton, "Points").expect("the radio button");
        assert_eq!(radio["on"], true, "{radio}");
        let button = named(&state, Role::Button, "Open").expect("the button");
        assert_eq!(button["disabled"], true, "{button}");
        let field = named(&state, Role::TextInput, "Path").expect("the field");
        assert_eq!(field["value"], "a.ply", "{field}");
        let rect: Vec<i64> = serde_json::from_value(radio["rect"].clone()).expect("four edges");
        assert!(rect[0] < rect[2] && rect[1] < rect[3], "{rect:?}");
        assert!(rect[3] <= 100, "{rect:?} is outside the window");
    }
}
