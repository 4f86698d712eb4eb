//! The memory of this process, where the system tells.

/// A look at the process before something is done.
pub(super) struct Watch {
    before_bytes: u64,
}

impl Watch {
    /// Forgets the peak so far. None where the system has no such thing.
    pub(super) fn begin() -> Option<Self> {
        // Linux sets the peak back to what is held now.
        std::fs::write("/proc/self/clear_refs", "5").ok()?;
        let before_bytes = field_bytes("VmRSS:")?;
        Some(Self { before_bytes })
    }

    /// How far the process grew at most since, bytes.
    pub(super) fn grown_bytes(&self) -> Option<u64> {
        Some(field_bytes("VmHWM:")?.saturating_sub(self.before_bytes))
    }
}

/// A size that the system tells of this process.
fn field_bytes(name: &str) -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix(name))?;
    let kib: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    kib.checked_mul(1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[cfg(target_os = "linux")]
    fn memory_that_was_used_and_given_back_is_in_the_peak() {
        let Some(watch) = Watch::begin() else {
            println!("skipped: this system does not let the peak be set back");
            return;
        };
        let mut used = vec![0_u8; 64 << 20];
        // Touched, so that it is there.
        for byte in used.iter_mut().step_by(4096) {
            *byte = 1;
        }
        drop(std::hint::black_box(used));
        let grown = watch.grown_bytes().expect("Linux tells");
        assert!(grown > 60 << 20, "{grown}");
    }
}
