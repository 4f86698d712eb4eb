//! The program's window on a virtual display, used as a person would use it.
//!
//! [`Display`] is an X server without a screen (Xvfb). [`Window`] starts the program on it, finds widgets by their names
//! and waits for what it should show ([`State`]), and moves the pointer, presses keys, drops files and takes pictures
//! through the X protocol, so that nothing besides Xvfb has to be installed. Pixels are of the display, from its upper left
//! corner, which is the window's too: there is no window manager.

use std::time::{Duration, Instant};

mod capture;
mod display;
mod drop;
mod input;
mod log;
mod session;
mod state;
mod watching;

pub use display::Display;
pub use session::Window;
pub use state::{State, Widget};

/// How long a window may take for what it is asked. Far above what it needs alone: it draws in software here, and
/// other tests run beside it.
pub const TIME_LIMIT: Duration = Duration::from_secs(90);

/// How often something outside this process is looked at again.
const LOOK_AGAIN: Duration = Duration::from_millis(25);

/// Looks with `look` until it finds something, at most [`TIME_LIMIT`]; `None` when it never did.
fn wait_for<T>(mut look: impl FnMut() -> anyhow::Result<Option<T>>) -> anyhow::Result<Option<T>> {
    let start = Instant::now();
    loop {
        if let Some(found) = look()? {
            return Ok(Some(found));
        }
        if start.elapsed() > TIME_LIMIT {
            return Ok(None);
        }
        std::thread::sleep(LOOK_AGAIN);
    }
}
