//! How much memory the program holds.

use std::time::{Duration, Instant};

/// The system is asked no more often.
const PERIOD: Duration = Duration::from_secs(1);

/// What the system last said.
#[derive(Debug, Default)]
pub(crate) struct Memory {
    asked_at: Option<Instant>,
    resident_bytes: Option<u64>,
}

impl Memory {
    /// Bytes of the program in memory, as of about a second; `None` where the system does not say.
    pub(crate) fn resident_bytes(&mut self, now: Instant) -> Option<u64> {
        if self.asked_at.is_none_or(|at| now >= at + PERIOD) {
            self.asked_at = Some(now);
            self.resident_bytes = resident_bytes();
        }
        self.resident_bytes
    }
}

/// Linux says it in `/proc/self/status`, in kB.
fn resident_bytes() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status
        .lines()
        .find_map(|line| line.strip_prefix("VmRSS:"))?;
    let kilobytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kilobytes * 1024)
}

#[cfg(test)]
#[cfg(target_os = "linux")]
mod tests {
    use super::*;

    #[test]
    fn a_program_holds_some_memory() {
        let bytes = resident_bytes().expect("Linux says it");
        assert!((1 << 20..1 << 40).contains(&bytes), "{bytes}");
    }
}
