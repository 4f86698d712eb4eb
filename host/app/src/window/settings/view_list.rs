//! The stored views in the *View* tab: ten by number, and a list with names and small pictures.

use egui::{Button, Id, Image, Key, TextEdit, TextureHandle, Ui, Vec2};

use crate::window::intent::{Intents, ViewsIntent};
use crate::window::thumbnail;
use crate::window::views::{ListWay, NamedView, StoredViews, slot_key};

/// Width of a thumbnail in the list, points.
const THUMBNAIL_WIDTH: f32 = 72.0;

/// Size of a view without a picture, points: one that came out of a file.
const EMPTY_SIZE: Vec2 = Vec2::new(THUMBNAIL_WIDTH, 48.0);

/// The slots, the list, and what makes new views.
pub(crate) fn view_list_ui(ui: &mut Ui, views: &StoredViews, out: &mut Intents) {
    ui.strong("Stored views");
    slots_ui(ui, views, out);
    for (index, view) in views.named.iter().enumerate() {
        ui.push_id(("named view", index), |ui| {
            let is_last = index + 1 == views.named.len();
            named_ui(ui, view, index, is_last, out);
        });
    }
    // Places whose views are gone.
    for index in views.named.len().. {
        if !thumbnail::forget(ui.ctx(), thumbnail_place(index)) {
            break;
        }
    }
    ui.horizontal_wrapped(|ui| {
        let buttons = [
            ("Keep this view", "Appends it to the list", ViewsIntent::Add),
            (
                "Copy view",
                "Puts this view on the clipboard as text",
                ViewsIntent::Copy,
            ),
            (
                "Paste view",
                "Takes a view from the text on the clipboard",
                ViewsIntent::AskPaste,
            ),
        ];
        for (name, help, intent) in buttons {
            if ui.button(name).on_hover_text(help).clicked() {
                out.push(intent);
            }
        }
    });
}

/// One button a number: those that hold a view recall it.
fn slots_ui(ui: &mut Ui, views: &StoredViews, out: &mut Intents) {
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        for (slot, view) in views.slots.iter().enumerate() {
            let key = slot_key(slot);
            let button = ui.add_enabled(view.is_some(), Button::new(key.to_string()).small());
            let button = button
                .accessible_name(format!("Recall view {key}"))
                .on_hover_text(format!("{key} goes to this view"))
                .on_disabled_hover_text(format!("Empty: Ctrl+{key} stores this view here"));
            if button.clicked() {
                out.push(ViewsIntent::Recall(slot));
            }
        }
    });
}

/// One view of the list: its picture recalls it, its name can be typed anew.
fn named_ui(ui: &mut Ui, view: &NamedView, index: usize, is_last: bool, out: &mut Intents) {
    let mut asked = None;
    ui.horizontal(|ui| {
        let place = thumbnail_place(index);
        let recall = match thumbnail::texture(ui.ctx(), place, &view.thumbnail) {
            Some(texture) => ui.add(Button::image(small_picture(&texture))),
            None => ui.add_sized(EMPTY_SIZE, Button::new("Recall")),
        };
        let name = format!("Recall {}", view.name);
        if recall.on_hover_text(&name).accessible_name(name).clicked() {
            asked = Some(ViewsIntent::RecallNamed(index));
        }
        ui.vertical(|ui| {
            if let Some(name) = name_ui(ui, view) {
                asked = Some(ViewsIntent::Rename(index, name));
            }
            ui.horizontal(|ui| {
                let buttons = [
                    (
                        "Overwrite",
                        "Overwrite",
                        true,
                        ViewsIntent::Overwrite(index),
                    ),
                    (
                        "Up",
                        "Move up",
                        index > 0,
                        ViewsIntent::Shift(index, ListWay::Up),
                    ),
                    (
                        "Down",
                        "Move down",
                        !is_last,
                        ViewsIntent::Shift(index, ListWay::Down),
                    ),
                    ("Delete", "Delete", true, ViewsIntent::Delete(index)),
                ];
                for (short, verb, is_enabled, intent) in buttons {
                    let name = format!("{verb} {}", view.name);
                    let button = ui.add_enabled(is_enabled, Button::new(short).small());
                    if button.on_hover_text(&name).accessible_name(name).clicked() {
                        asked = Some(intent);
                    }
                }
            });
        });
    });
    if let Some(intent) = asked {
        out.push(intent);
    }
}

/// The field with the name: a name that was typed, once it is entered or left. Escape gives it up.
fn name_ui(ui: &mut Ui, view: &NamedView) -> Option<String> {
    let id = ui.scope_id().with("name");
    let draft_id: Id = id.with("draft");
    let draft: Option<String> = ui.data(|data| data.get_temp(draft_id));
    let mut text = draft.unwrap_or_else(|| view.name.clone());
    let field = ui.add(TextEdit::singleline(&mut text).id(id));
    let field = field.accessible_name(format!("Name of {}", view.name));
    if field.has_focus() {
        ui.data_mut(|data| data.insert_temp(draft_id, text));
        return None;
    }
    if !field.lost_focus() {
        return None;
    }
    ui.data_mut(|data| data.remove::<String>(draft_id));
    let is_given_up = ui.input(|input| input.key_pressed(Key::Escape));
    (!is_given_up && text.trim() != view.name).then_some(text)
}

/// Where the texture of a view in the list is kept.
fn thumbnail_place(index: usize) -> Id {
    Id::unique(("thumbnail of named view", index))
}

fn small_picture(texture: &TextureHandle) -> Image<'static> {
    let size = texture.size_vec2();
    Image::new((texture.id(), size * (THUMBNAIL_WIDTH / size.x.max(1.0))))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::window::intent::Intent;
    use egui::accesskit::Role;
    use egui_kittest::Harness;
    use egui_kittest::kittest::{NodeT as _, Queryable as _};
    use pointstage_scene::{Camera, ViewRecord};

    fn record() -> ViewRecord {
        ViewRecord::new(Camera::default(), 800, 600)
    }

    /// A list with the views 'Front' and 'Face', and one in the slot 2.
    fn harness() -> Harness<'static, Intents> {
        let mut views = StoredViews::default();
        views.add(record(), Vec::new());
        views.add(record(), Vec::new());
        views.rename(0, "Front");
        views.rename(1, "Face");
        views.slots[1] = Some(record());
        let app = move |ui: &mut Ui, asked: &mut Intents| view_list_ui(ui, &views, asked);
        Harness::builder()
            .with_size([340.0, 400.0])
            .build_ui_state(app, Intents::new())
    }

    fn asked(harness: &Harness<'static, Intents>) -> Vec<ViewsIntent> {
        let views = harness.state().iter().map(|intent| match intent {
            Intent::Views(intent) => intent.clone(),
            other => panic!("{other:?} is no intent about views"),
        });
        views.collect()
    }

    #[test]
    fn each_button_asks_for_what_it_says() {
        let buttons = [
            ("Recall Front", ViewsIntent::RecallNamed(0)),
            ("Overwrite Face", ViewsIntent::Overwrite(1)),
            ("Move up Face", ViewsIntent::Shift(1, ListWay::Up)),
            ("Move down Front", ViewsIntent::Shift(0, ListWay::Down)),
            ("Delete Front", ViewsIntent::Delete(0)),
            ("Recall view 2", ViewsIntent::Recall(1)),
            ("Keep this view", ViewsIntent::Add),
            ("Copy view", ViewsIntent::Copy),
            ("Paste view", ViewsIntent::AskPaste),
        ];
        for (name, intent) in buttons {
            let mut harness = harness();
            harness.get_by_role_and_label(Role::Button, name).click();
            harness.run();
            assert_eq!(asked(&harness), [intent], "'{name}'");
        }
    }

    #[test]
    fn what_cannot_be_done_is_grey() {
        let harness = harness();
        for name in ["Recall view 1", "Move up Front", "Move down Face"] {
            let button = harness.get_by_role_and_label(Role::Button, name);
            assert!(button.accesskit_node().is_disabled(), "'{name}'");
        }
    }

    #[test]
    fn a_view_is_renamed_by_typing_and_enter() {
        let mut harness = harness();
        let name = "Name of Face";
        harness.get_by_role_and_label(Role::TextInput, name).focus();
        harness.run();
        let field = harness.get_by_role_and_label(Role::TextInput, name);
        field.type_text(" left");
        harness.run();
        assert!(harness.state().is_empty(), "not at every letter");
        harness.key_press(Key::Enter);
        harness.run();
        let [ViewsIntent::Rename(1, text)] = &asked(&harness)[..] else {
            panic!("asked for {:?}", harness.state())
        };
        assert!(text.contains("left") && text.contains("Face"), "{text}");
    }

    #[test]
    fn escape_keeps_the_name() {
        let mut harness = harness();
        let name = "Name of Face";
        harness.get_by_role_and_label(Role::TextInput, name).focus();
        harness.run();
        let field = harness.get_by_role_and_label(Role::TextInput, name);
        field.type_text("x");
        harness.run();
        harness.key_press(Key::Escape);
        harness.run();
        assert!(harness.state().is_empty(), "{:?}", harness.state());
    }

    #[test]
    fn the_keyboard_reaches_the_list() {
        let mut harness = harness();
        // The one slot that is filled, then the first view's picture.
        for _ in 0..2 {
            harness.key_press(Key::Tab);
            harness.run();
        }
        harness.key_press(Key::Space);
        harness.run();
        assert_eq!(asked(&harness), [ViewsIntent::RecallNamed(0)]);
    }
}
