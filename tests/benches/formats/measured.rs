//! What one reader took for one file.

use std::path::Path;
use std::process::Command;

use anyhow::{Context as _, Result, ensure};
use serde::{Deserialize, Serialize};

/// Times, counts and memory of one reader on one file.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Measured {
    /// The format, in words; only ours.
    #[serde(default)]
    pub(crate) format: String,
    /// Points, or vertices of a mesh.
    #[serde(alias = "vertices")]
    pub(crate) surfels: u64,
    pub(crate) triangles: u64,
    /// Largest resident size less that before the load.
    pub(crate) peak_bytes: u64,
    /// Of each load.
    pub(crate) seconds: Vec<f64>,
}

impl Measured {
    /// Adds what another process measured.
    pub(crate) fn join(&mut self, other: Self) {
        let mut seconds = std::mem::take(&mut self.seconds);
        seconds.extend(&other.seconds);
        *self = Self {
            peak_bytes: self.peak_bytes.max(other.peak_bytes),
            seconds,
            ..other
        };
    }

    /// The median of all loads; NaN without one.
    pub(crate) fn median(&self) -> f64 {
        let mut seconds = self.seconds.clone();
        seconds.sort_by(f64::total_cmp);
        seconds.get(seconds.len() / 2).copied().unwrap_or(f64::NAN)
    }
}

/// Measures ourselves in a process of its own.
pub(crate) fn in_child(file: &Path) -> Result<Measured> {
    let output = Command::new(std::env::current_exe()?)
        .arg("--read")
        .arg(file)
        .output()?;
    ensure!(
        output.status.success(),
        "{}: {}",
        file.display(),
        String::from_utf8_lossy(&output.stderr)
    );
    serde_json::from_slice(&output.stdout).context("the child answers with its measurements")
}

/// A line of this process's status, bytes. Linux only.
pub(crate) fn resident_bytes(key: &str) -> Result<u64> {
    let text = std::fs::read_to_string("/proc/self/status").context("memory is read on Linux")?;
    let line = text.lines().find_map(|line| line.strip_prefix(key));
    let kib: u64 = line
        .and_then(|line| line.split_whitespace().next()?.parse().ok())
        .with_context(|| format!("no {key} in the status of the process"))?;
    Ok(kib * 1024)
}
