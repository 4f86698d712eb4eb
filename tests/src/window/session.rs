//! The running program with its window.

use std::ffi::OsStr;
use std::path::PathBuf;
use std::process::{Child, ExitStatus, Stdio};

use anyhow::{Context as _, Result, bail};
use wait_timeout::ChildExt as _;
use x11rb::connection::Connection as _;
use x11rb::protocol::xproto::{
    AtomEnum, ClientMessageEvent, ConnectionExt as _, EventMask, InputFocus, MapState,
    Window as WindowId,
};
use x11rb::rust_connection::RustConnection;

use super::log::Log;
use super::state::State;
use super::{Display, TIME_LIMIT, drop, input, wait_for};
use crate::program::Program;

/// The program's window. The program is ended with this value if it still runs.
pub struct Window {
    pub(super) child: Child,
    log: Log,
    /// Number of the first line of the log that [`Window::wait_for_log`] has not passed yet.
    unread: usize,
    pub(super) connection: RustConnection,
    pub(super) root: WindowId,
    id: WindowId,
    /// Where the program writes what it shows.
    pub(super) state_path: PathBuf,
}

impl Window {
    /// Starts `program` with `arguments` on `display`, waits for its window and gives it the keyboard.
    ///
    /// # Errors
    /// When the program ends or shows no window in time; the message holds what it wrote.
    pub fn open<A: AsRef<OsStr>>(
        display: &Display,
        program: &Program,
        arguments: impl IntoIterator<Item = A>,
    ) -> Result<Self> {
        let (connection, screen) = x11rb::connect(Some(display.name()))
            .with_context(|| format!("connecting to {}", display.name()))?;
        let root = connection.setup().roots[screen].root;
        let state_path = program.home().join("ui_state.json");
        let mut child = program
            .command()
            .args(arguments)
            .env("DISPLAY", display.name())
            .env("POINTSTAGE_UI_STATE", &state_path)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .context("starting the program")?;
        let log = Log::default();
        child
            .stdout
            .take()
            .into_iter()
            .for_each(|pipe| log.follow(pipe));
        child
            .stderr
            .take()
            .into_iter()
            .for_each(|pipe| log.follow(pipe));

        // Made before the wait, so that the child is ended if the wait fails.
        let mut window = Self {
            child,
            log,
            unread: 0,
            connection,
            root,
            id: root,
            state_path,
        };
        let found = wait_for(|| {
            window.must_run()?;
            program_window(&window.connection, window.root)
        })?;
        let Some(id) = found else {
            bail!("no window appeared; the program said:\n{}", window.said())
        };
        window.id = id;
        // There is no window manager that would do it.
        window
            .connection
            .set_input_focus(InputFocus::PARENT, id, x11rb::CURRENT_TIME)?
            .check()?;
        Ok(window)
    }

    /// Waits for the next line of the program's log that contains `text`, and returns it. Lines before it are passed.
    ///
    /// # Errors
    /// When the program ends or does not write such a line in time.
    pub fn wait_for_log(&mut self, text: &str) -> Result<String> {
        let found = wait_for(|| {
            // Looked at first: a program that is gone has written its last line.
            let ended = self.child.try_wait()?;
            match (self.log.find(self.unread, text), ended) {
                (Some(found), _) => Ok(Some(found)),
                (None, None) => Ok(None),
                (None, Some(status)) => {
                    bail!("the program ended ({status}) and said:\n{}", self.said())
                }
            }
        })?;
        let Some((number, line)) = found else {
            bail!(
                "no line with '{text}' came; the program said:\n{}",
                self.said()
            )
        };
        self.unread = number + 1;
        Ok(line)
    }

    /// Everything that the program has written.
    pub fn said(&self) -> String {
        self.log.lines().join("\n")
    }

    /// Moves the pointer.
    ///
    /// # Errors
    /// When the display is gone.
    pub fn point_at(&self, x: i16, y: i16) -> Result<()> {
        input::point_at(&self.connection, self.root, x, y)
    }

    /// Clicks with `button`: 1 left, 2 middle, 3 right.
    ///
    /// # Errors
    /// When the display is gone.
    pub fn click(&self, x: i16, y: i16, button: u8) -> Result<()> {
        self.point_at(x, y)?;
        input::press(&self.connection, self.root, button)?;
        input::release(&self.connection, self.root, button)
    }

    /// Drags with `button` from one place to another and back, and so on, until `accept` says yes to the state.
    ///
    /// The window may take all movements for one where it draws slowly, so each way is waited for.
    ///
    /// # Errors
    /// As for [`Window::wait_for_state`].
    pub fn drag_until(
        &mut self,
        from: (i16, i16),
        to: (i16, i16),
        button: u8,
        mut accept: impl FnMut(&State) -> bool,
    ) -> Result<()> {
        let (mut start, mut end) = (from, to);
        self.point_at(from.0, from.1)?;
        // What the button goes down on is what the window saw under the pointer.
        wait_for(|| {
            self.must_run()?;
            Ok(self
                .state()?
                .filter(|state| state.has_pointer_at(from.0, from.1)))
        })?;
        input::press(&self.connection, self.root, button)?;
        input::glide(&self.connection, self.root, start, end)?;
        let found = wait_for(|| {
            self.must_run()?;
            let Some(state) = self.state()? else {
                return Ok(None);
            };
            if accept(&state) {
                return Ok(Some(()));
            }
            if state.has_pointer_at(end.0, end.1) {
                std::mem::swap(&mut start, &mut end);
                input::glide(&self.connection, self.root, start, end)?;
            }
            Ok(None)
        });
        input::release(&self.connection, self.root, button)?;
        if found?.is_none() {
            bail!("waited in vain for a drag; {}", self.last_words()?);
        }
        Ok(())
    }

    /// Drags with the left button in a movement that takes its time, lets go while it goes on, and returns the first state
    /// in which the window has seen that.
    ///
    /// # Errors
    /// As for [`Window::wait_for_state`].
    pub fn throw(&mut self, from: (i16, i16), to: (i16, i16)) -> Result<State> {
        self.point_at(from.0, from.1)?;
        let releases = self.wait_for_state("the pointer", |state| {
            state
                .has_pointer_at(from.0, from.1)
                .then(|| state.releases())
        })?;
        input::press(&self.connection, self.root, 1)?;
        let thrown = input::glide_slowly(&self.connection, self.root, from, to);
        input::release(&self.connection, self.root, 1)?;
        thrown?;
        self.wait_for_state("the button to go up", |state| {
            (state.releases() > releases).then(|| state.clone())
        })
    }

    /// Drags once with `button` between two places, and does not wait.
    ///
    /// # Errors
    /// When the display is gone.
    pub fn drag(&self, from: (i16, i16), to: (i16, i16), button: u8) -> Result<()> {
        self.point_at(from.0, from.1)?;
        input::press(&self.connection, self.root, button)?;
        let glided = input::glide(&self.connection, self.root, from, to);
        input::release(&self.connection, self.root, button)?;
        glided
    }

    /// Clicks twice with the left button.
    ///
    /// # Errors
    /// When the display is gone.
    pub fn double_click(&self, x: i16, y: i16) -> Result<()> {
        self.click(x, y, 1)?;
        self.click(x, y, 1)
    }

    /// The program's number in the system.
    pub fn process_id(&self) -> u32 {
        self.child.id()
    }

    /// Turns the wheel at (x, y) by `clicks`, up when positive.
    ///
    /// # Errors
    /// When the display is gone.
    pub fn scroll(&self, x: i16, y: i16, clicks: i8) -> Result<()> {
        self.point_at(x, y)?;
        let button = if clicks > 0 {
            input::WHEEL_UP
        } else {
            input::WHEEL_DOWN
        };
        for _ in 0..clicks.unsigned_abs() {
            input::press(&self.connection, self.root, button)?;
            input::release(&self.connection, self.root, button)?;
        }
        Ok(())
    }

    /// Presses keys together, such as `ctrl+o`, `alt+F4`, `Return`, `a`.
    ///
    /// # Errors
    /// When a key is not on the keyboard, or the display is gone.
    pub fn press_keys(&self, keys: &str) -> Result<()> {
        input::press_keys(&self.connection, self.root, keys)
    }

    /// Presses keys and holds them while `act` runs; they are let go of even if it fails.
    ///
    /// # Errors
    /// As for [`Window::press_keys`], and what `act` says.
    pub fn while_holding<T>(
        &mut self,
        keys: &str,
        act: impl FnOnce(&mut Self) -> Result<T>,
    ) -> Result<T> {
        input::hold_keys(&self.connection, self.root, keys)?;
        let done = act(self);
        input::release_keys(&self.connection, self.root, keys)?;
        done
    }

    /// Presses `button` at (x, y) and holds it while `act` runs; it is let go of even if that fails.
    ///
    /// # Errors
    /// When the display is gone, and what `act` says.
    pub fn while_pressing<T>(
        &mut self,
        (x, y): (i16, i16),
        button: u8,
        act: impl FnOnce(&mut Self) -> Result<T>,
    ) -> Result<T> {
        self.point_at(x, y)?;
        input::press(&self.connection, self.root, button)?;
        let done = act(self);
        input::release(&self.connection, self.root, button)?;
        done
    }

    /// Types ASCII text.
    ///
    /// # Errors
    /// When a character is not on the keyboard, or the display is gone.
    pub fn type_text(&self, text: &str) -> Result<()> {
        input::type_text(&self.connection, self.root, text)
    }

    /// Drops files at (x, y), as from a file manager.
    ///
    /// # Errors
    /// When the window does not take them.
    pub fn drop_files(&self, files: &[&std::path::Path], x: i16, y: i16) -> Result<()> {
        drop::drop_files(&self.connection, self.root, self.id, files, (x, y))
    }

    /// Gives the window another size.
    ///
    /// # Errors
    /// When the display is gone.
    pub fn resize(&self, width: u32, height: u32) -> Result<()> {
        let size = x11rb::protocol::xproto::ConfigureWindowAux::new()
            .x(0)
            .y(0)
            .width(width)
            .height(height);
        self.connection.configure_window(self.id, &size)?.check()?;
        Ok(())
    }

    /// Closes the window as its close button would, and waits for the program's end.
    ///
    /// # Errors
    /// When the program does not end in time.
    pub fn close(mut self) -> Result<ExitStatus> {
        let atom = |name: &str| -> Result<u32> {
            Ok(self
                .connection
                .intern_atom(false, name.as_bytes())?
                .reply()?
                .atom)
        };
        let data = [atom("WM_DELETE_WINDOW")?, x11rb::CURRENT_TIME, 0, 0, 0];
        let message = ClientMessageEvent::new(32, self.id, atom("WM_PROTOCOLS")?, data);
        self.connection
            .send_event(false, self.id, EventMask::NO_EVENT, message)?
            .check()?;
        match self.child.wait_timeout(TIME_LIMIT)? {
            Some(status) => Ok(status),
            None => bail!(
                "the program went on after its window was closed; it said:\n{}",
                self.said()
            ),
        }
    }

    /// Whether the program still runs.
    ///
    /// # Errors
    /// When the system does not say.
    pub fn runs(&mut self) -> Result<bool> {
        Ok(self.child.try_wait()?.is_none())
    }

    pub(super) fn must_run(&mut self) -> Result<()> {
        match self.child.try_wait()? {
            None => Ok(()),
            Some(status) => bail!("the program ended ({status}) and said:\n{}", self.said()),
        }
    }
}

impl Drop for Window {
    fn drop(&mut self) {
        // It may have ended already; there is nobody to tell.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// The one top-level window that is shown and has a name.
fn program_window(connection: &RustConnection, root: WindowId) -> Result<Option<WindowId>> {
    for id in connection.query_tree(root)?.reply()?.children {
        // A window may go between one question and the next.
        let Ok(attributes) = connection.get_window_attributes(id)?.reply() else {
            continue;
        };
        let name = connection
            .get_property(false, id, AtomEnum::WM_NAME, AtomEnum::ANY, 0, 64)?
            .reply();
        if attributes.map_state == MapState::VIEWABLE
            && name.is_ok_and(|name| !name.value.is_empty())
        {
            return Ok(Some(id));
        }
    }
    Ok(None)
}
