//! What came of looking at a plugin's file, and of trying one of its plugins.

use serde::{Deserialize, Serialize};

/// How an examination ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum VerdictClass {
    /// It may be used.
    Ok,
    /// It said, or we saw, what is wrong with it.
    Rejected,
    /// It ended the process that examined it.
    Crashed,
    /// It did not come to an end in time.
    Hung,
    /// It ended the examining process without a crash and without an answer.
    OddExit,
    /// The examination itself failed: nothing is known about the plugin.
    NotExamined,
    /// The user does not want it to run.
    SetAside,
}

/// How an examination ended, and why.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Verdict {
    /// How it ended.
    pub class: VerdictClass,
    /// Why, in one or two sentences; empty when all is well.
    pub message: String,
    /// The long form; may be empty.
    #[serde(default)]
    pub detail: String,
}

impl Verdict {
    /// All is well.
    pub fn ok() -> Self {
        Self::new(VerdictClass::Ok, String::new())
    }

    /// Refused, with the reason.
    pub fn rejected(message: impl Into<String>) -> Self {
        Self::new(VerdictClass::Rejected, message.into())
    }

    /// Set aside by the user; `file` is the library's name.
    pub(super) fn set_aside(file: &str) -> Self {
        let message = format!("{file}: set aside by you; it is not loaded until you try it again");
        Self::new(VerdictClass::SetAside, message)
    }

    pub(super) fn new(class: VerdictClass, message: String) -> Self {
        Self {
            class,
            message,
            detail: String::new(),
        }
    }

    /// The same with a long form.
    #[must_use]
    pub fn with_detail(mut self, detail: impl Into<String>) -> Self {
        self.detail = detail.into();
        self
    }

    /// Whether the plugin may be used. An examination that failed by itself does not hold against it.
    pub fn is_usable(&self) -> bool {
        matches!(self.class, VerdictClass::Ok | VerdictClass::NotExamined)
    }

    /// Whether only the user should let it run again: it misbehaved, or was set aside by hand.
    pub fn is_quarantined(&self) -> bool {
        matches!(
            self.class,
            VerdictClass::Crashed
                | VerdictClass::Hung
                | VerdictClass::OddExit
                | VerdictClass::SetAside
        )
    }

    /// `ok`, `rejected`, `quarantined (crash)`, …: one or two words for lists.
    pub fn in_words(&self) -> &'static str {
        match self.class {
            VerdictClass::Ok => "ok",
            VerdictClass::Rejected => "rejected",
            VerdictClass::Crashed => "quarantined (crash)",
            VerdictClass::Hung => "quarantined (hang)",
            VerdictClass::OddExit => "quarantined (odd exit)",
            VerdictClass::NotExamined => "not examined",
            VerdictClass::SetAside => "quarantined by you",
        }
    }
}
