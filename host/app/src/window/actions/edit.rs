//! The *Edit* menu: undo, redo, resets, the selection, and what is done with selected objects.

use egui::{Key, Modifiers};
use pointstage_scene::estimate::{DEFAULT_NEIGHBOURS, Steps};

use super::{Action, COMMAND_SHIFT, Menu, Place, Scope};
use crate::window::app::App;
use crate::window::intent::{EditIntent, LightIntent, RendererIntent, SceneIntent};

pub(super) fn actions(app: &App) -> Vec<Action> {
    let mut actions = steps(app);
    actions.extend(resets(app));
    actions.extend(selection(app));
    actions.extend(estimates(app));
    actions
}

/// Columns of the selected objects, or of all, anew.
fn estimates(app: &App) -> Vec<Action> {
    let place = Place::new(Menu::Edit, 3).within("Estimate");
    let is_empty = app.session.scene.objects().is_empty();
    ESTIMATES
        .iter()
        .map(|(id, title, steps)| {
            let steps = Steps {
                neighbours: app.session.neighbours,
                ..*steps
            };
            let nothing = is_empty.then(|| "The scene is empty.".to_owned());
            Action::new(*id, *title, place, SceneIntent::EstimateAnew(steps)).unless(nothing)
        })
        .collect()
}

/// No step yet.
const NO_STEP: Steps = Steps {
    normals: false,
    orientation: false,
    radii: false,
    axes: false,
    neighbours: DEFAULT_NEIGHBOURS,
};

/// What can be estimated: id, title, steps.
pub(crate) const ESTIMATES: [(&str, &str, Steps); 4] = [
    (
        "edit.estimate_normals",
        "Estimate normals",
        Steps {
            normals: true,
            ..NO_STEP
        },
    ),
    (
        "edit.orient_normals",
        "Orient normals",
        Steps {
            orientation: true,
            ..NO_STEP
        },
    ),
    (
        "edit.estimate_radii",
        "Estimate radii",
        Steps {
            radii: true,
            ..NO_STEP
        },
    ),
    (
        "edit.estimate_axes",
        "Estimate axes",
        Steps {
            axes: true,
            ..NO_STEP
        },
    ),
];

/// Ctrl+Z belongs to the text while one is typed.
fn steps(app: &App) -> Vec<Action> {
    let place = Place::new(Menu::Edit, 0);
    let step = |id: &str, verb: &str, what: Option<&str>, intent| {
        let title = what.map_or(verb.to_owned(), |what| format!("{verb} {what}"));
        let obstacle = what
            .is_none()
            .then(|| format!("There is nothing to {}.", verb.to_lowercase()));
        Action::new(id, title, place, intent).unless(obstacle)
    };
    let undo = step(
        "edit.undo",
        "Undo",
        app.history.next_undo(),
        EditIntent::Undo,
    );
    let redo = step(
        "edit.redo",
        "Redo",
        app.history.next_redo(),
        EditIntent::Redo,
    );
    vec![
        undo.keys_in(Scope::NotTyping, Modifiers::COMMAND, Key::Z),
        redo.keys_in(Scope::NotTyping, COMMAND_SHIFT, Key::Z)
            .keys_in(Scope::NotTyping, Modifiers::COMMAND, Key::Y),
    ]
}

fn resets(app: &App) -> Vec<Action> {
    let place = Place::new(Menu::Edit, 1);
    let is_changed = !app.session.chosen_settings().is_empty();
    let defaults = (!is_changed).then(|| "Every setting has its default.".to_owned());
    vec![
        Action::new(
            "edit.reset_settings",
            "Reset all settings of the renderer",
            place,
            RendererIntent::ResetAll,
        )
        .unless(defaults),
        Action::new(
            "edit.reset_lights",
            "Reset lights",
            place,
            LightIntent::Set(pointstage_scene::Lights::default()),
        ),
        Action::new(
            "edit.reset_material",
            "Reset material",
            place,
            LightIntent::Material(pointstage_scene::Material::default()),
        ),
    ]
}

fn selection(app: &App) -> Vec<Action> {
    let place = Place::new(Menu::Edit, 2);
    let objects = app.session.scene.objects();
    let is_empty = objects.is_empty().then(|| "The scene is empty.".to_owned());
    let is_any_selected = objects.iter().any(|object| object.selected);
    let none = (!is_any_selected).then(|| "No object is selected.".to_owned());
    let unselected = || {
        let none = !is_any_selected;
        none.then(|| "No object is selected: click on its name in the Scene tab.".to_owned())
    };
    let are_several = objects.iter().filter(|object| object.selected).count() > 1;
    let alone =
        (!are_several).then(|| "Two objects or more have to be selected to be merged.".to_owned());
    vec![
        Action::new(
            "edit.duplicate_objects",
            "Duplicate selected objects",
            place,
            SceneIntent::Duplicate,
        )
        .unless(unselected()),
        Action::new(
            "edit.merge_objects",
            "Merge selected objects",
            place,
            SceneIntent::Merge,
        )
        .unless(alone),
        Action::new(
            "edit.remove_objects",
            "Remove selected objects",
            place,
            SceneIntent::RemoveSelected,
        )
        .unless(unselected()),
        Action::new(
            "edit.select_all",
            "Select all objects",
            place,
            SceneIntent::SelectAll,
        )
        .keys_in(Scope::NotTyping, Modifiers::COMMAND, Key::A)
        .unless(is_empty),
        Action::new(
            "edit.select_none",
            "Select no object",
            place,
            SceneIntent::SelectNone,
        )
        .keys_in(Scope::NotTyping, COMMAND_SHIFT, Key::A)
        .unless(none),
    ]
}
