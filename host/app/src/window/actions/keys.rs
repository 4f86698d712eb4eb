//! Reads keys: which actions were asked for by keyboard in this pass.

use egui::{Context, Event, Id, InputState, Key, KeyboardShortcut, Modifiers};

use super::{Action, Keys, Scope};
use crate::window::intent::{Intent, Intents};

/// Pushes what this pass's keys ask for, and takes those keys away from widgets. `picture` is the picture's widget.
pub(crate) fn read_keys(ctx: &Context, actions: &[Action], picture: Option<Id>, out: &mut Intents) {
    let is_typing = ctx.text_edit_focused();
    let focused = ctx.memory(egui::Memory::focused);
    let is_on_picture = focused.is_none() || focused == picture;
    let counts = |scope| match scope {
        Scope::Everywhere => true,
        Scope::NotTyping => !is_typing,
        Scope::OnPicture => is_on_picture && !is_typing,
    };
    for action in actions.iter().filter(|action| action.obstacle.is_none()) {
        // A held key repeats what is a step, not what switches.
        let repeats = matches!(action.intent, Intent::Edit(_));
        for Keys { shortcut, scope } in &action.keys {
            if counts(*scope) && ctx.input_mut(|input| take(input, *shortcut, repeats)) {
                out.push(action.intent.clone());
            }
        }
    }
}

/// Takes the events of just these keys. True if they ask for the action.
fn take(input: &mut InputState, shortcut: KeyboardShortcut, repeats: bool) -> bool {
    let mut is_asked = false;
    let command = Modifiers {
        shift: input.modifiers.shift,
        alt: input.modifiers.alt,
        ..Modifiers::COMMAND
    };
    input.events.retain(|event| {
        let (key, repeat, modifiers) = match event {
            Event::Key {
                key,
                pressed: true,
                repeat,
                modifiers,
                ..
            } => (*key, *repeat, *modifiers),
            // The toolkit makes these of Ctrl+C and Ctrl+X, and tells no keys then.
            Event::Copy => (Key::C, false, command),
            Event::Cut => (Key::X, false, command),
            _ => return true,
        };
        let is_meant = key == shortcut.logical_key && modifiers.matches_exact(shortcut.modifiers);
        is_asked |= is_meant && (repeats || !repeat);
        !is_meant
    });
    is_asked
}

/// A shortcut as menus and Help write it. The toolkit spells out signs that its font lacks, and one that it has.
pub(crate) fn shortcut_text(ctx: &Context, shortcut: KeyboardShortcut) -> String {
    let text = ctx.format_shortcut(&shortcut);
    match shortcut.logical_key {
        Key::Comma => text.replace("Comma", ","),
        _ => text,
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Menu, Place};
    use super::*;
    use crate::window::intent::{Part, WindowIntent};
    use egui::RawInput;

    fn toggle(part: Part, modifiers: Modifiers, key: Key) -> Action {
        let place = Place::new(Menu::Window, 0);
        Action::new("window.test", "Test", place, WindowIntent::Toggle(part)).keys(modifiers, key)
    }

    /// What a press of `key` with `modifiers` asks for.
    fn asked(actions: &[Action], modifiers: Modifiers, key: Key) -> Vec<Intent> {
        let ctx = Context::default();
        let event = Event::Key {
            key,
            physical_key: None,
            pressed: true,
            repeat: false,
            modifiers,
        };
        let input = RawInput {
            events: vec![Event::ModifiersChanged(modifiers), event],
            ..RawInput::default()
        };
        let mut out = Intents::new();
        let run = |ui: &mut egui::Ui| read_keys(ui.ctx(), actions, None, &mut out);
        ctx.run_ui(input, run).textures_delta.clear();
        out.into_iter().collect()
    }

    #[test]
    fn keys_count_with_just_their_modifiers() {
        let actions = [
            toggle(Part::Log, Modifiers::COMMAND, Key::L),
            toggle(
                Part::Keys,
                Modifiers::COMMAND.plus(Modifiers::SHIFT),
                Key::L,
            ),
            toggle(Part::About, Modifiers::NONE, Key::L),
        ];
        let ctrl = Modifiers {
            ctrl: true,
            command: true,
            ..Modifiers::NONE
        };
        for (modifiers, part) in [
            (ctrl, Part::Log),
            (ctrl.plus(Modifiers::SHIFT), Part::Keys),
            (Modifiers::NONE, Part::About),
        ] {
            let expected = Intent::Window(WindowIntent::Toggle(part));
            assert_eq!(asked(&actions, modifiers, Key::L), [expected]);
        }
        assert_eq!(asked(&actions, Modifiers::ALT, Key::L), []);
    }

    #[test]
    fn what_the_toolkit_makes_of_copying_and_cutting_is_keys_again() {
        let actions = [
            toggle(Part::Log, Modifiers::COMMAND, Key::C),
            toggle(Part::Keys, Modifiers::COMMAND, Key::X),
        ];
        for (event, part) in [(Event::Copy, Part::Log), (Event::Cut, Part::Keys)] {
            let input = RawInput {
                events: vec![event],
                ..RawInput::default()
            };
            let mut out = Intents::new();
            let run = |ui: &mut egui::Ui| read_keys(ui.ctx(), &actions, None, &mut out);
            Context::default().run_ui(input, run).textures_delta.clear();
            let asked: Vec<Intent> = out.into_iter().collect();
            assert_eq!(asked, [Intent::Window(WindowIntent::Toggle(part))]);
        }
    }

    #[test]
    fn what_cannot_be_done_now_leaves_its_keys_alone() {
        let action = toggle(Part::Log, Modifiers::COMMAND, Key::L).unless(Some("not now".into()));
        assert_eq!(asked(&[action], Modifiers::COMMAND, Key::L), []);
    }
}
