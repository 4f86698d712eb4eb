//! Pointer and keys, by the X test extension.

use std::time::Duration;

use anyhow::{Context as _, Result};
use x11rb::connection::Connection as _;
use x11rb::protocol::xproto::{
    BUTTON_PRESS_EVENT, BUTTON_RELEASE_EVENT, ConnectionExt as _, KEY_PRESS_EVENT,
    KEY_RELEASE_EVENT, Keycode, Keysym, MOTION_NOTIFY_EVENT, Window,
};
use x11rb::protocol::xtest::ConnectionExt as _;
use x11rb::rust_connection::RustConnection;

pub(super) const WHEEL_UP: u8 = 4;
pub(super) const WHEEL_DOWN: u8 = 5;

/// Positions between the ends of a drag; a program that waits for a first movement before it drags needs several.
const DRAG_STEPS: i16 = 12;

pub(super) fn point_at(connection: &RustConnection, root: Window, x: i16, y: i16) -> Result<()> {
    connection
        .xtest_fake_input(MOTION_NOTIFY_EVENT, 0, x11rb::CURRENT_TIME, root, x, y, 0)?
        .check()?;
    Ok(())
}

pub(super) fn press(connection: &RustConnection, root: Window, button: u8) -> Result<()> {
    event(connection, root, BUTTON_PRESS_EVENT, button)
}

pub(super) fn release(connection: &RustConnection, root: Window, button: u8) -> Result<()> {
    event(connection, root, BUTTON_RELEASE_EVENT, button)
}

/// Moves the pointer in a straight line, at once.
pub(super) fn glide(
    connection: &RustConnection,
    root: Window,
    from: (i16, i16),
    to: (i16, i16),
) -> Result<()> {
    glide_in(connection, root, from, to, Duration::ZERO)
}

/// Moves the pointer in a straight line, so that a window on a busy machine sees it move in several passes.
pub(super) fn glide_slowly(
    connection: &RustConnection,
    root: Window,
    from: (i16, i16),
    to: (i16, i16),
) -> Result<()> {
    glide_in(connection, root, from, to, Duration::from_millis(80))
}

fn glide_in(
    connection: &RustConnection,
    root: Window,
    from: (i16, i16),
    to: (i16, i16),
    time_of_a_step: Duration,
) -> Result<()> {
    for step in 1..=DRAG_STEPS {
        std::thread::sleep(time_of_a_step);
        let between = |a: i16, b: i16| {
            (i32::from(a) + i32::from(b - a) * i32::from(step) / i32::from(DRAG_STEPS)) as i16
        };
        point_at(
            connection,
            root,
            between(from.0, to.0),
            between(from.1, to.1),
        )?;
    }
    Ok(())
}

/// Presses the keys named between `+` together and lets go in the opposite order.
pub(super) fn press_keys(connection: &RustConnection, root: Window, keys: &str) -> Result<()> {
    strike(connection, root, &codes_of(connection, keys)?)
}

/// Presses the keys named between `+` and holds them.
pub(super) fn hold_keys(connection: &RustConnection, root: Window, keys: &str) -> Result<()> {
    for code in codes_of(connection, keys)? {
        event(connection, root, KEY_PRESS_EVENT, code)?;
    }
    Ok(())
}

/// Lets go of keys that are held.
pub(super) fn release_keys(connection: &RustConnection, root: Window, keys: &str) -> Result<()> {
    for code in codes_of(connection, keys)?.into_iter().rev() {
        event(connection, root, KEY_RELEASE_EVENT, code)?;
    }
    Ok(())
}

/// The keys named between `+`, with Shift before one that takes it.
fn codes_of(connection: &RustConnection, keys: &str) -> Result<Vec<Keycode>> {
    let keyboard = Keyboard::read(connection)?;
    let mut codes = Vec::new();
    for name in keys.split('+') {
        let (code, shifted) = keyboard
            .find(symbol(name)?)
            .with_context(|| format!("no key '{name}'"))?;
        if shifted {
            codes.push(keyboard.shift()?);
        }
        codes.push(code);
    }
    Ok(codes)
}

pub(super) fn type_text(connection: &RustConnection, root: Window, text: &str) -> Result<()> {
    let keyboard = Keyboard::read(connection)?;
    for character in text.chars() {
        // The symbols of Latin-1 are their code points.
        let found = keyboard
            .find(u32::from(character))
            .with_context(|| format!("no key for '{character}'"))?;
        match found {
            (code, false) => strike(connection, root, &[code])?,
            (code, true) => strike(connection, root, &[keyboard.shift()?, code])?,
        }
    }
    Ok(())
}

fn strike(connection: &RustConnection, root: Window, codes: &[Keycode]) -> Result<()> {
    for &code in codes {
        event(connection, root, KEY_PRESS_EVENT, code)?;
    }
    for &code in codes.iter().rev() {
        event(connection, root, KEY_RELEASE_EVENT, code)?;
    }
    Ok(())
}

fn event(connection: &RustConnection, root: Window, kind: u8, detail: u8) -> Result<()> {
    connection
        .xtest_fake_input(kind, detail, x11rb::CURRENT_TIME, root, 0, 0, 0)?
        .check()?;
    Ok(())
}

/// The number of a key symbol, from X's keysymdef.h.
fn symbol(name: &str) -> Result<Keysym> {
    let mut characters = name.chars();
    if let (Some(character), None) = (characters.next(), characters.next()) {
        return Ok(u32::from(character));
    }
    Ok(match name.to_ascii_lowercase().as_str() {
        "backspace" => 0xff08,
        "tab" => 0xff09,
        "return" | "enter" => 0xff0d,
        "escape" => 0xff1b,
        "home" => 0xff50,
        "left" => 0xff51,
        "up" => 0xff52,
        "right" => 0xff53,
        "down" => 0xff54,
        "end" => 0xff57,
        "shift" => SHIFT,
        "ctrl" => 0xffe3,
        "alt" => 0xffe9,
        "delete" => 0xffff,
        "space" => u32::from(' '),
        function => {
            let number: Option<u32> = function
                .strip_prefix('f')
                .and_then(|digits| digits.parse().ok());
            let number = number.filter(|number| (1..=12).contains(number));
            0xffbd + number.with_context(|| format!("no key is called '{name}'"))?
        }
    })
}

const SHIFT: Keysym = 0xffe1;

/// The display's key map.
struct Keyboard {
    first: Keycode,
    symbols_per_key: usize,
    symbols: Vec<Keysym>,
}

impl Keyboard {
    fn read(connection: &RustConnection) -> Result<Self> {
        let (first, last) = (
            connection.setup().min_keycode,
            connection.setup().max_keycode,
        );
        let map = connection
            .get_keyboard_mapping(first, last - first + 1)?
            .reply()?;
        Ok(Self {
            first,
            symbols_per_key: usize::from(map.keysyms_per_keycode).max(1),
            symbols: map.keysyms,
        })
    }

    /// The key that bears `wanted`, and whether it takes Shift.
    fn find(&self, wanted: Keysym) -> Option<(Keycode, bool)> {
        let column_of =
            |symbols: &[Keysym]| symbols.iter().take(2).position(|&symbol| symbol == wanted);
        let mut keys = self.symbols.chunks(self.symbols_per_key).enumerate();
        let (index, column) =
            keys.find_map(|(index, symbols)| Some((index, column_of(symbols)?)))?;
        Some((self.first + u8::try_from(index).ok()?, column == 1))
    }

    fn shift(&self) -> Result<Keycode> {
        Ok(self.find(SHIFT).context("the keyboard has no Shift")?.0)
    }
}
