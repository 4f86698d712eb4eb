//! A virtual display of its own for each test.

use std::io::{BufRead as _, BufReader};
use std::process::{Child, Command, Stdio};

use anyhow::{Context as _, Result, ensure};

use crate::data;

/// An X server that draws into memory. It ends with this value.
#[derive(Debug)]
pub struct Display {
    server: Child,
    name: String,
}

impl Display {
    /// Starts a display of `width` × `height` pixels.
    ///
    /// `None`, with a line that counts as a skip, when this machine has no Xvfb.
    ///
    /// # Errors
    /// When Xvfb is there and does not start.
    pub fn start(width: u16, height: u16) -> Result<Option<Self>> {
        let started = Command::new("Xvfb")
            // The server takes the first free number and writes it to its standard output.
            .args([
                "-displayfd",
                "1",
                "-nolisten",
                "tcp",
                "-noreset",
                "-screen",
                "0",
            ])
            .arg(format!("{width}x{height}x24"))
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn();
        let mut server = match started {
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
                data::skip("no Xvfb on this machine; `cargo xtask test` installs it");
                return Ok(None);
            }
            other => other.context("starting Xvfb")?,
        };
        let mut number = String::new();
        if let Some(stdout) = server.stdout.take() {
            BufReader::new(stdout)
                .read_line(&mut number)
                .context("reading the display's number from Xvfb")?;
        }
        let number = number.trim();
        ensure!(!number.is_empty(), "Xvfb ended before it had a display");
        let name = format!(":{number}");
        Ok(Some(Self { server, name }))
    }

    /// What goes into the environment variable `DISPLAY`.
    pub fn name(&self) -> &str {
        &self.name
    }
}

impl Drop for Display {
    fn drop(&mut self) {
        // It may have ended already; there is nobody to tell.
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}
