//! What plugins log: passed on to `tracing` with the plugin's id, and kept in a bounded list that a window can show.

use super::call::shorten;
use pointstage_plugin_api::abi::LogLevel;
use std::collections::VecDeque;
use std::sync::{Mutex, PoisonError};
use std::time::SystemTime;

/// Lines that are kept; the oldest go first.
const MOST_LINES: usize = 1_000;
/// Bytes of a line that are kept.
const LONGEST_LINE: usize = 4_096;

/// One line of a plugin's log.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LogLine {
    /// When it was last said.
    pub time: SystemTime,
    /// How serious.
    pub level: LogLevel,
    /// The plugin's id.
    pub plugin: String,
    /// What it said.
    pub text: String,
    /// How often in a row.
    pub count: u64,
}

/// The log of all plugins of a session. Thread: any.
#[derive(Debug, Default)]
pub struct LogBook {
    lines: Mutex<VecDeque<LogLine>>,
}

impl LogBook {
    /// Adds a line. The same text of the same plugin in a row is counted instead.
    pub fn add(&self, plugin: &str, level: LogLevel, text: &str) {
        let text = shorten(text.trim_end(), LONGEST_LINE);
        match level {
            LogLevel::ERROR => tracing::error!(plugin, "{text}"),
            LogLevel::WARN => tracing::warn!(plugin, "{text}"),
            LogLevel::PERFORMANCE => tracing::warn!(plugin, "performance: {text}"),
            LogLevel::INFO => tracing::info!(plugin, "{text}"),
            LogLevel::TRACE => tracing::trace!(plugin, "{text}"),
            // A level of a later version is at least worth a look.
            _ => tracing::debug!(plugin, "{text}"),
        }
        if level == LogLevel::TRACE {
            return;
        }
        let time = SystemTime::now();
        let mut lines = self.lines.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(last) = lines.back_mut()
            && (last.level, last.plugin.as_str(), last.text.as_str()) == (level, plugin, text)
        {
            last.count += 1;
            last.time = time;
            return;
        }
        if lines.len() == MOST_LINES {
            lines.pop_front();
        }
        lines.push_back(LogLine {
            time,
            level,
            plugin: plugin.to_owned(),
            text: text.to_owned(),
            count: 1,
        });
    }

    /// All lines that are kept, oldest first.
    pub fn lines(&self) -> Vec<LogLine> {
        self.lines
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .iter()
            .cloned()
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn repeated_lines_are_counted() {
        let book = LogBook::default();
        for _ in 0..5 {
            book.add("a.b", LogLevel::WARN, "slow\n");
        }
        book.add("a.c", LogLevel::WARN, "slow");
        let lines = book.lines();
        assert_eq!(
            (lines.len(), lines[0].count, lines[0].text.as_str()),
            (2, 5, "slow")
        );
    }

    #[test]
    fn the_list_is_bounded_and_drops_the_oldest() {
        let book = LogBook::default();
        for number in 0..MOST_LINES + 10 {
            book.add("a.b", LogLevel::INFO, &number.to_string());
        }
        let lines = book.lines();
        assert_eq!((lines.len(), lines[0].text.as_str()), (MOST_LINES, "10"));
    }
}
