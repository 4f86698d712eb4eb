//! Keys that work anywhere in the window, and the list that Help shows of them.

use egui::{Context, Key, KeyboardShortcut, Modifiers};

use super::intent::{Intent, Intents, OpenMode, Part};
use super::navigation::{Axis, CameraMove};

const COMMAND_SHIFT: Modifiers = Modifiers::COMMAND.plus(Modifiers::SHIFT);

/// Opens the file dialog.
pub(crate) const OPEN: KeyboardShortcut = KeyboardShortcut::new(Modifiers::COMMAND, Key::O);
/// Opens the field for a path.
pub(crate) const TYPE_PATH: KeyboardShortcut = KeyboardShortcut::new(COMMAND_SHIFT, Key::O);
/// Ends the program.
pub(crate) const QUIT: KeyboardShortcut = KeyboardShortcut::new(Modifiers::COMMAND, Key::Q);
/// Shows or hides the log.
pub(crate) const LOG: KeyboardShortcut = KeyboardShortcut::new(Modifiers::COMMAND, Key::L);
/// Shows or hides the settings panel.
pub(crate) const SETTINGS: KeyboardShortcut = KeyboardShortcut::new(Modifiers::COMMAND, Key::Comma);
/// Shows or hides the list of keys.
pub(crate) const KEYS: KeyboardShortcut = KeyboardShortcut::new(Modifiers::NONE, Key::F1);

/// Keys and mouse actions with what they do, for Help.
pub(crate) const LIST: [(&str, &str); 21] = [
    ("Drag", "turn around the scene"),
    ("Shift+drag, middle drag", "shift the scene"),
    ("Wheel, pinch", "zoom to the pointer"),
    ("F, Home", "frame the whole scene"),
    ("X, Shift+X", "look from the right, from the left"),
    ("Y, Shift+Y", "look from above, from below"),
    ("Z, Shift+Z", "look from the front, from behind"),
    ("O", "perspective or orthographic"),
    ("Arrow keys", "turn, after a click on the picture"),
    ("Shift+arrow keys", "shift, after a click on the picture"),
    ("+, −", "zoom, after a click on the picture"),
    ("Ctrl+O", "open files"),
    ("Ctrl+Shift+O", "open a typed path"),
    ("Drop files", "open them"),
    ("Shift+drop files", "add them to the scene"),
    ("Ctrl+,", "settings panel"),
    ("Ctrl+L", "log"),
    ("F1", "this list"),
    ("Tab, Shift+Tab", "next and previous control"),
    ("Space, Enter", "press the control"),
    ("Ctrl+Q", "quit"),
];

/// Reads the keys of this pass. Letters do nothing while a text is typed.
pub(crate) fn read(ctx: &Context, out: &mut Intents) {
    // The longer shortcut first: consuming Ctrl+O also takes Ctrl+Shift+O.
    let commands = [
        (TYPE_PATH, Intent::TypePath(OpenMode::Replace)),
        (OPEN, Intent::ChooseFiles(OpenMode::Replace)),
        (QUIT, Intent::Quit),
        (LOG, Intent::Toggle(Part::Log)),
        (SETTINGS, Intent::Toggle(Part::Settings)),
        (KEYS, Intent::Toggle(Part::Keys)),
    ];
    for (shortcut, intent) in commands {
        if ctx.input_mut(|input| input.consume_shortcut(&shortcut)) {
            out.push(intent);
        }
    }
    if ctx.text_edit_focused() {
        return;
    }
    let letters = [
        (Modifiers::SHIFT, Key::X, CameraMove::Axis(Axis::Left)),
        (Modifiers::SHIFT, Key::Y, CameraMove::Axis(Axis::Bottom)),
        (Modifiers::SHIFT, Key::Z, CameraMove::Axis(Axis::Back)),
        (Modifiers::NONE, Key::X, CameraMove::Axis(Axis::Right)),
        (Modifiers::NONE, Key::Y, CameraMove::Axis(Axis::Top)),
        (Modifiers::NONE, Key::Z, CameraMove::Axis(Axis::Front)),
        (Modifiers::NONE, Key::F, CameraMove::Frame),
        (Modifiers::NONE, Key::Home, CameraMove::Frame),
        (Modifiers::NONE, Key::O, CameraMove::SwitchProjection),
    ];
    for (modifiers, key, camera_move) in letters {
        if ctx.input_mut(|input| input.consume_key(modifiers, key)) {
            out.push(Intent::Move(camera_move));
        }
    }
}
