//! Messages for the user: kept in a log, the newest shown as toasts.

use std::time::{Duration, Instant};

use pointstage_engine::stage::{Notice, Severity};

use super::intent::{Intent, Intents, WindowIntent};

/// The most entries kept; the oldest go first.
const MOST: usize = 500;

/// How long a toast without an error stays.
const TOAST_TIME: Duration = Duration::from_secs(6);

/// All messages of the session.
#[derive(Debug, Default)]
pub(crate) struct Log {
    entries: Vec<Entry>,
    next: u64,
}

/// One message, with how often it came in a row.
#[derive(Clone, Debug)]
pub(crate) struct Entry {
    /// Names it.
    pub(crate) id: u64,
    /// The message.
    pub(crate) notice: Notice,
    /// How often it came.
    pub(crate) count: u32,
    /// What the program can do about it.
    pub(crate) offer: Option<Offer>,
    /// When its toast goes, if it has not gone; errors stay until they are dismissed.
    toast: Toast,
}

/// A button on a message.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Offer {
    /// The button's text.
    pub(crate) label: &'static str,
    /// What it asks for.
    pub(crate) intent: Intent,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Toast {
    Until(Instant),
    Stays,
    Gone,
}

impl Log {
    /// Adds a message. One that is already there is counted, and moves to the end: never a flood.
    pub(crate) fn add(&mut self, notice: Notice, now: Instant) {
        self.add_with(notice, None, now);
    }

    fn add_with(&mut self, notice: Notice, offer: Option<Offer>, now: Instant) {
        match notice.severity {
            Severity::Error => tracing::error!("{}{}", prefix(&notice), notice.text),
            Severity::Warning => tracing::warn!("{}{}", prefix(&notice), notice.text),
            Severity::Info => tracing::info!("{}{}", prefix(&notice), notice.text),
        }
        let toast = match notice.severity {
            Severity::Error => Toast::Stays,
            _ if offer.is_some() => Toast::Stays,
            _ => Toast::Until(now + TOAST_TIME),
        };
        if let Some(position) = self.entries.iter().position(|entry| entry.notice == notice) {
            let mut entry = self.entries.remove(position);
            entry.count += 1;
            entry.toast = toast;
            entry.offer = offer;
            self.entries.push(entry);
            return;
        }
        let id = self.next;
        self.next += 1;
        self.entries.push(Entry {
            id,
            notice,
            count: 1,
            offer,
            toast,
        });
        if self.entries.len() > MOST {
            self.entries.remove(0);
        }
    }

    /// Adds an error of the program itself.
    pub(crate) fn error(&mut self, text: impl Into<String>, now: Instant) {
        self.say(Severity::Error, text, now);
    }

    /// Adds a message of the program itself.
    pub(crate) fn say(&mut self, severity: Severity, text: impl Into<String>, now: Instant) {
        self.add(own_notice(severity, text.into()), now);
    }

    /// Adds a warning of the program itself, with what it can do about it.
    pub(crate) fn warn_with(&mut self, text: impl Into<String>, offer: Offer, now: Instant) {
        self.say_with(Severity::Warning, text, offer, now);
    }

    /// Adds a message of the window itself with something to do about it.
    pub(crate) fn say_with(
        &mut self,
        severity: Severity,
        text: impl Into<String>,
        offer: Offer,
        now: Instant,
    ) {
        self.add_with(own_notice(severity, text.into()), Some(offer), now);
    }

    /// All messages, oldest first.
    pub(crate) fn entries(&self) -> &[Entry] {
        &self.entries
    }

    /// Messages of this severity.
    pub(crate) fn count(&self, severity: Severity) -> usize {
        let of_severity = |entry: &&Entry| entry.notice.severity == severity;
        self.entries.iter().filter(of_severity).count()
    }

    /// Messages whose toast is up, newest first.
    pub(crate) fn toasts(&self, now: Instant) -> impl Iterator<Item = &Entry> {
        self.entries
            .iter()
            .rev()
            .filter(move |entry| match entry.toast {
                Toast::Until(end) => now < end,
                Toast::Stays => true,
                Toast::Gone => false,
            })
    }

    /// Time until the next toast goes by itself.
    pub(crate) fn next_change(&self, now: Instant) -> Option<Duration> {
        let ends = self.entries.iter().filter_map(|entry| match entry.toast {
            Toast::Until(end) if now < end => Some(end - now),
            _ => None,
        });
        ends.min()
    }

    /// Takes a toast away; the message stays in the log.
    pub(crate) fn dismiss(&mut self, id: u64) {
        if let Some(entry) = self.entries.iter_mut().find(|entry| entry.id == id) {
            entry.toast = Toast::Gone;
        }
    }

    /// Empties the log.
    pub(crate) fn clear(&mut self) {
        self.entries.clear();
    }

    /// The whole log as text, for a report.
    pub(crate) fn as_text(&self) -> String {
        self.entries.iter().map(Entry::as_text).collect()
    }
}

impl Entry {
    /// The message with its details, as text.
    pub(crate) fn as_text(&self) -> String {
        let Self { notice, count, .. } = self;
        let times = if *count > 1 {
            format!(" ({count} times)")
        } else {
            String::new()
        };
        let mut text = format!(
            "{}: {}{}{times}\n",
            word(notice.severity),
            prefix(notice),
            notice.text
        );
        for line in notice.detail.lines() {
            text.push_str("    ");
            text.push_str(line);
            text.push('\n');
        }
        text
    }
}

fn own_notice(severity: Severity, text: String) -> Notice {
    Notice {
        severity,
        plugin: String::new(),
        text,
        detail: String::new(),
    }
}

fn prefix(notice: &Notice) -> String {
    if notice.plugin.is_empty() {
        String::new()
    } else {
        format!("{}: ", notice.plugin)
    }
}

/// A severity, for people.
pub(crate) fn word(severity: Severity) -> &'static str {
    match severity {
        Severity::Error => "Error",
        Severity::Warning => "Warning",
        Severity::Info => "Note",
    }
}

/// The log panel: every message with its plugin, its details folded away, and buttons to copy it.
pub(crate) fn log_ui(ui: &mut egui::Ui, log: &Log, out: &mut Intents) {
    ui.horizontal(|ui| {
        ui.strong("Log");
        if ui.button("Copy all").clicked() {
            out.push(WindowIntent::Copy(log.as_text()));
        }
        if ui.button("Clear").clicked() {
            out.push(WindowIntent::ClearLog);
        }
        if ui.button("Close").clicked() {
            out.push(WindowIntent::Toggle(super::intent::Part::Log));
        }
    });
    ui.separator();
    egui::ScrollArea::vertical()
        .auto_shrink(false)
        .stick_to_bottom(true)
        .show(ui, |ui| {
            if log.entries().is_empty() {
                ui.weak("Nothing to report.");
            }
            for entry in log.entries() {
                entry_ui(ui, entry, out);
            }
        });
}

fn entry_ui(ui: &mut egui::Ui, entry: &Entry, out: &mut Intents) {
    let Entry {
        id, notice, count, ..
    } = entry;
    ui.push_id(id, |ui| {
        ui.horizontal_wrapped(|ui| {
            super::theme::severity_label(ui, notice.severity);
            if !notice.plugin.is_empty() {
                ui.strong(&notice.plugin);
            }
            ui.label(&notice.text);
            if *count > 1 {
                ui.weak(format!("{count} times"));
            }
            if let Some(offer) = &entry.offer
                && ui.small_button(offer.label).clicked()
            {
                out.push(offer.intent.clone());
            }
            if ui.small_button("Copy").clicked() {
                out.push(WindowIntent::Copy(entry.as_text()));
            }
        });
        if !notice.detail.is_empty() {
            ui.collapsing("Details", |ui| {
                ui.monospace(&notice.detail);
            });
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::window::intent::SceneIntent;

    #[test]
    fn the_same_message_is_counted_not_repeated() {
        let now = Instant::now();
        let mut log = Log::default();
        log.error("disk is full", now);
        log.error("file is missing", now);
        log.error("disk is full", now);
        let texts: Vec<(&str, u32)> = log
            .entries()
            .iter()
            .map(|entry| (entry.notice.text.as_str(), entry.count))
            .collect();
        assert_eq!(texts, [("file is missing", 1), ("disk is full", 2)]);
    }

    #[test]
    fn a_warning_goes_by_itself_and_an_error_stays() {
        let now = Instant::now();
        let mut log = Log::default();
        log.say(Severity::Warning, "slow", now);
        log.error("broken", now);
        assert_eq!(log.toasts(now).count(), 2);
        let later = now + TOAST_TIME;
        let left: Vec<&str> = log
            .toasts(later)
            .map(|entry| entry.notice.text.as_str())
            .collect();
        assert_eq!(left, ["broken"]);
        let id = log.entries()[1].id;
        log.dismiss(id);
        assert_eq!(log.toasts(later).count(), 0);
        assert_eq!(log.entries().len(), 2, "the log keeps what was dismissed");
    }

    #[test]
    fn a_warning_that_offers_something_stays_until_it_is_answered() {
        let now = Instant::now();
        let mut log = Log::default();
        let intent = SceneIntent::Flip(pointstage_scene::ObjectId(1)).into();
        let label = "Flip";
        log.warn_with("wound inward", Offer { label, intent }, now);
        let later = now + 2 * TOAST_TIME;
        assert_eq!(log.toasts(later).count(), 1);
        assert_eq!(log.next_change(later), None, "it asks for no redraw");
    }

    #[test]
    fn the_log_is_bounded() {
        let now = Instant::now();
        let mut log = Log::default();
        for number in 0..2 * MOST {
            log.error(format!("error {number}"), now);
        }
        assert_eq!(log.entries().len(), MOST);
        assert_eq!(log.entries()[0].notice.text, format!("error {MOST}"));
    }
}
