//! Who measured, on what, by which command, and when.

use std::time::{SystemTime, UNIX_EPOCH};

use pointstage_engine::stage::Stage;
use serde::Serialize;

/// What is needed to measure again, and to judge the numbers.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct MadeBy {
    /// The program and its version.
    pub(crate) program: String,
    /// The command line, quoted for a shell.
    pub(crate) command: String,
    /// Year, month, day, hour, minute and second, UTC, as ISO 8601 has them.
    pub(crate) time: String,
    /// The graphics device; none where only the CPU draws.
    pub(crate) adapter: Option<AdapterFacts>,
    /// Operating system and processor architecture.
    pub(crate) system: String,
    /// Threads that the processor runs at a time.
    pub(crate) threads: usize,
}

/// The graphics device.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct AdapterFacts {
    /// As the driver says.
    pub(crate) name: String,
    /// `vulkan`, `gl`, …
    pub(crate) backend: String,
    /// Name and version; may be empty.
    pub(crate) driver: String,
    /// Whether it runs on the CPU.
    pub(crate) is_software: bool,
}

impl MadeBy {
    /// Of this very process.
    pub(crate) fn now(stage: &Stage) -> Self {
        let arguments = std::env::args().skip(1).map(|argument| quoted(&argument));
        let words = std::iter::once("pointstage".to_owned()).chain(arguments);
        let since_epoch = SystemTime::now().duration_since(UNIX_EPOCH);
        Self {
            program: format!("pointstage {}", env!("CARGO_PKG_VERSION")),
            command: words.collect::<Vec<_>>().join(" "),
            time: utc(since_epoch.map_or(0, |time| time.as_secs())),
            adapter: stage.adapter().map(|adapter| AdapterFacts {
                name: adapter.name,
                backend: adapter.backend,
                driver: adapter.driver,
                is_software: adapter.is_software,
            }),
            system: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
            threads: std::thread::available_parallelism().map_or(1, usize::from),
        }
    }

    /// The device with its driver, in words.
    pub(crate) fn device_in_words(&self) -> String {
        let Some(adapter) = &self.adapter else {
            return "no graphics device".to_owned();
        };
        let AdapterFacts {
            name,
            backend,
            driver,
            is_software,
        } = adapter;
        let software = if *is_software { ", in software" } else { "" };
        let driver = if driver.is_empty() {
            String::new()
        } else {
            format!(", driver {driver}")
        };
        format!("{name} ({backend}{software}{driver})")
    }
}

/// A word as a POSIX shell takes it back.
fn quoted(word: &str) -> String {
    let is_plain = |letter: char| letter.is_alphanumeric() || "-_./=:,+@%".contains(letter);
    if !word.is_empty() && word.chars().all(is_plain) {
        return word.to_owned();
    }
    format!("'{}'", word.replace('\'', r"'\''"))
}

/// A time as `2026-03-01T12:30:05Z`.
///
/// * `secs`: since 1970, UTC.
fn utc(secs: u64) -> String {
    let (mut days, of_day) = (secs / 86_400, secs % 86_400);
    let is_leap = |year: u64| {
        year.is_multiple_of(4) && (!year.is_multiple_of(100) || year.is_multiple_of(400))
    };
    let mut year = 1970;
    loop {
        let length = 365 + u64::from(is_leap(year));
        if days < length {
            break;
        }
        days -= length;
        year += 1;
    }
    let february = 28 + u64::from(is_leap(year));
    let mut month = 1;
    for length in [31, february, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31] {
        if days < length {
            break;
        }
        days -= length;
        month += 1;
    }
    format!(
        "{year:04}-{month:02}-{:02}T{:02}:{:02}:{:02}Z",
        days + 1,
        of_day / 3600,
        of_day / 60 % 60,
        of_day % 60
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_quoted_where_a_shell_would_split_them() {
        let cases = [
            ("orbit:12", "orbit:12"),
            ("#ffffff", "'#ffffff'"),
            ("a b", "'a b'"),
            ("it's", r"'it'\''s'"),
            ("", "''"),
            ("$(x)", "'$(x)'"),
        ];
        for (word, expected) in cases {
            assert_eq!(quoted(word), expected);
        }
    }

    #[test]
    fn times_are_dates() {
        assert_eq!(utc(0), "1970-01-01T00:00:00Z");
        // 29 February of a year that 100 and 400 divide.
        assert_eq!(utc(951_782_400), "2000-02-29T00:00:00Z");
        assert_eq!(utc(1_735_689_599), "2024-12-31T23:59:59Z");
        assert_eq!(utc(1_772_368_205), "2026-03-01T12:30:05Z");
    }
}
