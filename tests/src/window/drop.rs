//! Dropping files on a window, as a file manager does: the source's part of the XDND protocol, version 5.
//!
//! Enter, position, status (the window says whether it would take them), drop, finished; in between the window asks
//! for the selection XdndSelection as `text/uri-list` and is given the files' addresses.

use std::path::Path;

use anyhow::{Context as _, Result, bail, ensure};
use x11rb::COPY_DEPTH_FROM_PARENT;
use x11rb::connection::Connection as _;
use x11rb::protocol::Event;
use x11rb::protocol::xproto::{
    Atom, AtomEnum, ClientMessageEvent, ConnectionExt as _, CreateWindowAux, EventMask, PropMode,
    SELECTION_NOTIFY_EVENT, SelectionNotifyEvent, SelectionRequestEvent, Window, WindowClass,
};
use x11rb::rust_connection::RustConnection;
use x11rb::wrapper::ConnectionExt as _;

use super::wait_for;

x11rb::atom_manager! {
    Atoms: AtomsCookie {
        XdndAware, XdndEnter, XdndPosition, XdndStatus, XdndDrop, XdndFinished, XdndSelection, XdndActionCopy,
        UriList: b"text/uri-list",
    }
}

const VERSION: u32 = 5;

/// Drops `files` on `target` at `at`, pixels of the display.
pub(super) fn drop_files(
    connection: &RustConnection,
    root: Window,
    target: Window,
    files: &[&Path],
    at: (i16, i16),
) -> Result<()> {
    let atoms = Atoms::new(connection)?.reply()?;
    let aware = connection
        .get_property(false, target, atoms.XdndAware, AtomEnum::ATOM, 0, 1)?
        .reply()?;
    ensure!(aware.value_len > 0, "the window takes no drops");

    let source = connection.generate_id()?;
    let (class, aux) = (WindowClass::INPUT_ONLY, CreateWindowAux::new());
    connection
        .create_window(
            COPY_DEPTH_FROM_PARENT,
            source,
            root,
            0,
            0,
            1,
            1,
            0,
            class,
            0,
            &aux,
        )?
        .check()?;
    connection
        .set_selection_owner(source, atoms.XdndSelection, x11rb::CURRENT_TIME)?
        .check()?;
    let drag = Drag {
        connection,
        atoms,
        target,
        list: uri_list(files)?,
    };

    super::input::point_at(connection, root, at.0, at.1)?;
    drag.tell(
        atoms.XdndEnter,
        [source, VERSION << 24, atoms.UriList, 0, 0],
    )?;
    let place = (u32::from(at.0.cast_unsigned()) << 16) | u32::from(at.1.cast_unsigned());
    drag.tell(
        atoms.XdndPosition,
        [source, 0, place, x11rb::CURRENT_TIME, atoms.XdndActionCopy],
    )?;
    let status = drag.answer(atoms.XdndStatus)?;
    ensure!(
        status[1] & 1 == 1,
        "the window refuses what is dragged over it"
    );
    drag.tell(atoms.XdndDrop, [source, 0, x11rb::CURRENT_TIME, 0, 0])?;
    let finished = drag.answer(atoms.XdndFinished)?;
    connection.destroy_window(source)?.check()?;
    ensure!(
        finished[1] & 1 == 1,
        "the window did not take what was dropped"
    );
    Ok(())
}

struct Drag<'a> {
    connection: &'a RustConnection,
    atoms: Atoms,

    target: Window,
    list: String,
}

impl Drag<'_> {
    fn tell(&self, kind: Atom, data: [u32; 5]) -> Result<()> {
        let message = ClientMessageEvent::new(32, self.target, kind, data);
        self.connection
            .send_event(false, self.target, EventMask::NO_EVENT, message)?
            .check()?;
        Ok(())
    }

    /// Waits for the target's message `kind`, and serves the selection while it waits.
    fn answer(&self, kind: Atom) -> Result<[u32; 5]> {
        let answer = wait_for(|| {
            while let Some(event) = self.connection.poll_for_event()? {
                match event {
                    Event::ClientMessage(message) if message.type_ == kind => {
                        return Ok(Some(message.data.as_data32()));
                    }
                    Event::SelectionRequest(request) => self.serve(&request)?,
                    _ => {}
                }
            }
            Ok(None)
        })?;
        answer.context("the window did not answer the drag")
    }

    fn serve(&self, request: &SelectionRequestEvent) -> Result<()> {
        let known = request.target == self.atoms.UriList;
        if known {
            let (owner, property) = (request.requestor, request.property);
            let bytes = self.list.as_bytes();
            self.connection
                .change_property8(PropMode::REPLACE, owner, property, request.target, bytes)?
                .check()?;
        }
        let reply = SelectionNotifyEvent {
            response_type: SELECTION_NOTIFY_EVENT,
            sequence: 0,
            time: request.time,
            requestor: request.requestor,
            selection: request.selection,
            target: request.target,
            property: if known {
                request.property
            } else {
                AtomEnum::NONE.into()
            },
        };
        self.connection
            .send_event(false, request.requestor, EventMask::NO_EVENT, reply)?
            .check()?;
        Ok(())
    }
}

/// The files as addresses, one a line; everything but letters, digits and `-._~/` is escaped.
fn uri_list(files: &[&Path]) -> Result<String> {
    let mut list = String::new();
    for file in files {
        let file = file
            .canonicalize()
            .with_context(|| format!("{}", file.display()))?;
        let Some(path) = file.to_str() else {
            bail!("{} is not Unicode", file.display())
        };
        list.push_str("file://");
        list.extend(path.bytes().map(escaped));
        list.push_str("\r\n");
    }
    Ok(list)
}

fn escaped(byte: u8) -> String {
    match byte {
        b'A'..=b'Z' | b'a'..=b'z' | b'0'..=b'9' | b'-' | b'.' | b'_' | b'~' | b'/' => {
            char::from(byte).to_string()
        }
        other => format!("%{other:02X}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_are_escaped() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("a b%é.ply");
        std::fs::write(&file, "").unwrap();
        let list = uri_list(&[&file]).unwrap();
        assert!(
            list.starts_with("file:///") && list.ends_with("/a%20b%25%C3%A9.ply\r\n"),
            "{list}"
        );
    }
}
