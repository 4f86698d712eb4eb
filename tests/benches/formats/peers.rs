//! The readers of other programs, run by a script.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;

use anyhow::{Context as _, Result, ensure};
use pointstage_tests::data;

use crate::measured::Measured;

/// The others by name; one that gave up, or was given up, has no times.
#[derive(Debug, Default)]
pub(crate) struct Peers(pub(crate) BTreeMap<String, Measured>);

impl Peers {
    /// Adds what they took in another round.
    pub(crate) fn join(&mut self, other: Self) {
        for (name, measured) in other.0 {
            self.0.entry(name).or_default().join(measured);
        }
    }

    /// Names of those that were measured once, as the script does with slow ones, or not to the end.
    fn slow(&self) -> impl Iterator<Item = &str> {
        let slow = self.0.iter().filter(|(_, all)| all.seconds.len() < 2);
        slow.map(|(name, _)| name.as_str())
    }

    /// The fastest by its median.
    pub(crate) fn fastest(&self) -> Option<(&str, &Measured)> {
        let timed = self.0.iter().filter(|(_, all)| !all.seconds.is_empty());
        let all = timed.map(|(name, measured)| (name.as_str(), measured));
        all.min_by(|a, b| a.1.median().total_cmp(&b.1.median()))
    }
}

/// All who read the file, less those that were too slow before to be measured again; nobody without `POINTSTAGE_PEERS_PYTHON`.
pub(crate) fn measure(file: &Path, runs: usize, before: &Peers) -> Result<Peers> {
    let Some(python) = std::env::var_os("POINTSTAGE_PEERS_PYTHON") else {
        return Ok(Peers::default());
    };
    let output = Command::new(python)
        .arg(data::repository().join("tests/peers/read_file.py"))
        .arg(file)
        .arg(runs.to_string())
        .arg("--without")
        .args(before.slow())
        .output()
        .context("POINTSTAGE_PEERS_PYTHON names a python")?;
    let said = String::from_utf8_lossy(&output.stderr);
    ensure!(output.status.success(), "read_file.py failed: {said}");
    eprint!("{said}");
    let peers = serde_json::from_slice(&output.stdout).context("read_file.py prints JSON")?;
    Ok(Peers(peers))
}
