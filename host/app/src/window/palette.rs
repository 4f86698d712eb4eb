//! The command palette: a search over all actions and all settings of the chosen renderer.

use egui::{Align2, Context, Key, Label, Modifiers, RichText, ScrollArea, TextEdit, Ui, Window};

use super::actions::{Action, shortcut_text};
use super::help::in_full;
use super::intent::{Intent, Intents, WindowIntent};
use super::rows::RendererRow;

/// Entries shown at once; the rest is reached by typing more.
const MOST: usize = 200;

/// What the palette holds while it is open.
#[derive(Debug, Default)]
pub(crate) struct Palette {
    is_open: bool,
    text: String,
    /// Which of the entries found is marked.
    marked: usize,
    has_been_focused: bool,
}

/// One thing that can be found.
struct Entry {
    title: String,
    /// Where it lives: a menu, or a renderer's settings.
    place: String,
    keys: String,
    /// Why it cannot be done now, if so.
    obstacle: Option<String>,
    intent: Intent,
}

impl Palette {
    /// Opens it, or closes it.
    pub(crate) fn toggle(&mut self) {
        *self = Self {
            is_open: !self.is_open,
            ..Self::default()
        };
    }

    /// The search field and what it finds, if it is open.
    pub(crate) fn ui(
        &mut self,
        ctx: &Context,
        actions: &[Action],
        renderer: Option<&RendererRow>,
        out: &mut Intents,
    ) {
        if !self.is_open {
            return;
        }
        let step = ctx.input_mut(|input| {
            let down = input.count_and_consume_key(Modifiers::NONE, Key::ArrowDown);
            let up = input.count_and_consume_key(Modifiers::NONE, Key::ArrowUp);
            down as isize - up as isize
        });
        let is_entered = ctx.input_mut(|input| input.consume_key(Modifiers::NONE, Key::Enter));
        let mut is_done = ctx.input_mut(|input| input.consume_key(Modifiers::NONE, Key::Escape));
        let all = entries(ctx, actions, renderer);
        let mut chosen = None;
        let mut is_open = true;
        Window::new("Find an action or a setting")
            .open(&mut is_open)
            .anchor(Align2::CENTER_TOP, egui::vec2(0.0, 60.0))
            .resizable(false)
            .collapsible(false)
            .show(ctx, |ui| {
                // What was typed before Enter, in this very pass, counts.
                self.field_ui(ui);
                let found = found(&self.text, all);
                self.marked = self
                    .marked
                    .saturating_add_signed(step)
                    .min(found.len().saturating_sub(1));
                let mut picked = is_entered.then_some(self.marked);
                let height = (ctx.content_rect().height() - 180.0).clamp(60.0, 360.0);
                ScrollArea::vertical()
                    .max_height(height)
                    .auto_shrink([false, true])
                    .show(ui, |ui| {
                        for (index, entry) in found.iter().enumerate() {
                            let is_marked = index == self.marked;
                            if entry_ui(ui, entry, is_marked, step != 0) {
                                picked = Some(index);
                            }
                        }
                        if found.is_empty() {
                            ui.weak("Nothing is called so.");
                        }
                    });
                chosen = picked.and_then(|index| found.into_iter().nth(index));
            });
        if let Some(entry) = chosen.filter(|entry| entry.obstacle.is_none()) {
            out.push(entry.intent);
            is_done = true;
        }
        if is_done || !is_open {
            *self = Self::default();
        }
    }

    fn field_ui(&mut self, ui: &mut Ui) {
        let field = TextEdit::singleline(&mut self.text)
            .desired_width(460.0)
            .hint_text("frame, exposure, point size …");
        let response = ui.add(field).accessible_name("Find");
        if response.changed() {
            self.marked = 0;
        }
        if !self.has_been_focused {
            response.request_focus();
            self.has_been_focused = true;
        }
    }
}

/// A row of the list. True if it is clicked.
fn entry_ui(ui: &mut Ui, entry: &Entry, is_marked: bool, has_moved: bool) -> bool {
    ui.add_enabled_ui(entry.obstacle.is_none(), |ui| {
        ui.horizontal(|ui| {
            let response = ui.selectable_label(is_marked, &entry.title);
            if is_marked && has_moved {
                response.scroll_to_me(None);
            }
            ui.add(Label::new(RichText::new(&entry.place).weak()).selectable(false));
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                ui.add(Label::new(RichText::new(&entry.keys).weak()).selectable(false));
            });
            match &entry.obstacle {
                Some(reason) => response.on_disabled_hover_text(reason),
                None => response,
            }
            .clicked()
        })
        .inner
    })
    .inner
}

/// Everything that can be found: the actions, then the chosen renderer's settings.
fn entries(ctx: &Context, actions: &[Action], renderer: Option<&RendererRow>) -> Vec<Entry> {
    let of_actions = actions.iter().map(|action| Entry {
        title: in_full(action),
        place: action.place.menu.name().to_owned(),
        keys: action
            .keys
            .first()
            .map_or_else(String::new, |keys| shortcut_text(ctx, keys.shortcut)),
        obstacle: action.obstacle.clone(),
        intent: action.intent.clone(),
    });
    let of_settings = renderer.into_iter().flat_map(|row| {
        row.settings.iter().map(|setting| Entry {
            title: setting.label.clone(),
            place: format!("setting of {}", row.title),
            keys: String::new(),
            obstacle: None,
            intent: WindowIntent::FocusSetting(setting.id.clone()).into(),
        })
    });
    of_actions.chain(of_settings).collect()
}

/// The entries that a text finds, best first; all of them, in their order, for an empty text.
fn found(text: &str, entries: Vec<Entry>) -> Vec<Entry> {
    let mut ranked: Vec<(u32, Entry)> = entries
        .into_iter()
        .filter_map(|entry| Some((rank(text, &entry.title)?, entry)))
        .collect();
    // Stable: equals keep the order of the menus.
    ranked.sort_by_key(|(rank, _)| *rank);
    ranked.truncate(MOST);
    ranked.into_iter().map(|(_, entry)| entry).collect()
}

/// How well a text fits a title, 0 best; `None` if it does not. Each word of the text has to start a word of the title, be
/// within it, or have its letters there in order.
fn rank(text: &str, title: &str) -> Option<u32> {
    let title = title.to_lowercase();
    let starts_word = |word: &str| {
        let mut places = title.match_indices(word);
        places.any(|(at, _)| !title[..at].ends_with(char::is_alphanumeric))
    };
    let mut total = 0;
    for word in text.to_lowercase().split_whitespace() {
        total += if title.starts_with(word) {
            0
        } else if starts_word(word) {
            1
        } else if title.contains(word) {
            3
        } else if has_letters_in_order(word, &title) {
            10
        } else {
            return None;
        };
    }
    Some(total)
}

fn has_letters_in_order(word: &str, title: &str) -> bool {
    let mut letters = title.chars();
    word.chars()
        .all(|letter| letters.any(|other| other == letter))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_found_by_their_beginnings_first() {
        let titles = [
            "Frame scene",
            "Look from: Top",
            "Perspective or orthographic",
        ];
        let best = |text: &str| {
            let ranked = titles
                .iter()
                .filter_map(|title| Some((rank(text, title)?, *title)));
            ranked.min_by_key(|(rank, _)| *rank).map(|(_, title)| title)
        };
        assert_eq!(best("frame"), Some("Frame scene"));
        assert_eq!(best("top"), Some("Look from: Top"));
        assert_eq!(best("ortho"), Some("Perspective or orthographic"));
        assert_eq!(best("scene FRAME"), Some("Frame scene"));
        assert_eq!(best("frsc"), Some("Frame scene"), "letters in order");
        assert_eq!(best("xyz"), None);
    }

    #[test]
    fn an_empty_text_finds_everything() {
        assert_eq!(rank("", "Quit"), Some(0));
        assert_eq!(rank("  ", "Quit"), Some(0));
    }
}
