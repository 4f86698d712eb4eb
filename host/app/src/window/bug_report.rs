//! Everything that a developer asks for first, as Markdown for the clipboard.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use super::rows::PluginRow;

/// What a report is made from.
pub(crate) struct Report<'a> {
    /// Versions, system, adapter: name and value.
    pub(crate) facts: &'a [(String, String)],
    /// Every plugin file found.
    pub(crate) plugins: &'a [PluginRow],
    /// The session as TOML.
    pub(crate) session: &'a str,
    /// The window's messages.
    pub(crate) messages: &'a str,
    /// The last lines of the program's log.
    pub(crate) log: &'a [String],
}

/// What of the user must not be in a report.
#[derive(Clone, Debug, Default)]
pub(crate) struct Private {
    /// Their home folder.
    pub(crate) home: Option<PathBuf>,
    /// Their name on this system.
    pub(crate) user: Option<String>,
}

impl Private {
    /// As the system says.
    pub(crate) fn of_this_user() -> Self {
        let names = ["USER", "LOGNAME", "USERNAME"];
        let name = names.iter().find_map(|name| std::env::var(name).ok());
        Self {
            home: etcetera::home_dir().ok(),
            user: name.filter(|name| !name.is_empty()),
        }
    }

    /// `text` with the home folder, and the user's name where it is a folder's, as `~`.
    fn hidden_in(&self, text: &str) -> String {
        let mut text = text.to_owned();
        if let Some(home) = self.home.as_deref().and_then(Path::to_str)
            && home.len() > 1
        {
            text = replace_name(&text, home, "~", |_| true);
        }
        if let Some(user) = &self.user {
            let is_separator = |before: Option<char>| matches!(before, Some('/' | '\\'));
            text = replace_name(&text, user, "~", is_separator);
        }
        text
    }
}

/// Replaces `name` where it ends as a folder's name does and stands behind a letter that `starts` says yes to.
fn replace_name(text: &str, name: &str, by: &str, starts: impl Fn(Option<char>) -> bool) -> String {
    let mut replaced = String::new();
    let mut rest = text;
    while let Some(at) = rest.find(name) {
        let (before, after) = (&rest[..at], &rest[at + name.len()..]);
        let last = before.chars().last().or(replaced.chars().last());
        // `/home/me` is no part of `/home/mercury`.
        let ends = !after.starts_with(|next: char| next.is_alphanumeric() || "_-.".contains(next));
        replaced.push_str(before);
        replaced.push_str(if ends && starts(last) { by } else { name });
        rest = after;
    }
    replaced.push_str(rest);
    replaced
}

/// The report. It names no home folder and no user.
pub(crate) fn bug_report(report: &Report<'_>, private: &Private) -> String {
    let Report {
        facts,
        plugins,
        session,
        messages,
        log,
    } = report;
    let mut text = String::from(
        "# Pointstage: bug report\n\n## What happened\n\n(What you did, what you expected, what came.)\n\n## Versions\n\n",
    );
    for (name, value) in *facts {
        let _ = writeln!(text, "- {name}: {value}");
    }
    text.push_str("\n## Plugins\n\n");
    if plugins.is_empty() {
        text.push_str("None was found.\n");
    }
    for plugin in *plugins {
        text.push_str(&plugin_lines(plugin));
    }
    for (title, language, content) in [
        ("Session", "toml", *session),
        ("Messages", "text", *messages),
        ("Log", "text", &*log.join("\n")),
    ] {
        let content = content.trim();
        let content = if content.is_empty() {
            "(none)"
        } else {
            content
        };
        let fence = fence_for(content);
        let _ = write!(
            text,
            "\n## {title}\n\n{fence}{language}\n{content}\n{fence}\n"
        );
    }
    private.hidden_in(&text)
}

fn plugin_lines(plugin: &PluginRow) -> String {
    let mut lines = format!(
        "- **{}**: {} ({})\n",
        plugin.title,
        plugin.verdict,
        plugin.path.display()
    );
    let _ = writeln!(lines, "  - {}", plugin.versions);
    for (name, value) in &plugin.facts {
        let _ = writeln!(lines, "  - {name}: {value}");
    }
    if !plugin.message.is_empty() {
        let _ = writeln!(lines, "  - {}", plugin.message);
    }
    lines
}

/// Backticks that do not occur in a row in `content`.
fn fence_for(content: &str) -> String {
    let mut fence = "```".to_owned();
    while content.contains(&fence) {
        fence.push('`');
    }
    fence
}

#[cfg(test)]
mod tests {
    use super::*;
    use pointstage_engine::stage::Severity;

    fn private() -> Private {
        Private {
            home: Some("/home/me".into()),
            user: Some("me".to_owned()),
        }
    }

    #[test]
    fn a_report_holds_what_is_asked_first_and_no_names() {
        let plugin = PluginRow {
            path: "/home/me/.local/lib/libfast.so".into(),
            title: "Fast".to_owned(),
            verdict: "quarantined (crash)".to_owned(),
            severity: Severity::Error,
            message: "it ended with SIGSEGV".to_owned(),
            detail: String::new(),
            facts: vec![("Hash".to_owned(), "abc123".to_owned())],
            versions: "1.2 (API 1.0)".to_owned(),
            found_in: "added folder".to_owned(),
            load_time: None,
            ids: vec!["org.example.fast".to_owned()],
            can_retry: true,
        };
        let report = Report {
            facts: &[("Pointstage".to_owned(), "0.1.0".to_owned())],
            plugins: &[plugin],
            session: "format = 1\nfile = \"/home/me/a.ply\"\n",
            messages: "Error: /media/me/disk is full, ``` and so on\n",
            log: &["INFO /home/mercury/x".to_owned()],
        };
        let text = bug_report(&report, &private());
        for part in [
            "- Pointstage: 0.1.0",
            "- **Fast**: quarantined (crash) (~/.local/lib/libfast.so)",
            "  - Hash: abc123",
            "  - it ended with SIGSEGV",
            "```toml\nformat = 1\nfile = \"~/a.ply\"\n```",
            "````text\nError: /media/~/disk is full, ``` and so on\n````",
            "INFO /home/mercury/x",
        ] {
            assert!(text.contains(part), "no '{part}' in:\n{text}");
        }
        assert!(!text.contains("/home/me/"), "{text}");
    }

    #[test]
    fn a_name_is_hidden_as_a_folder_and_kept_as_a_word() {
        let hidden = private().hidden_in("to me: C:\\Users\\me\\a, /srv/me and /srv/men, /home/me");
        assert_eq!(hidden, "to me: C:\\Users\\~\\a, /srv/~ and /srv/men, ~");
    }
}
