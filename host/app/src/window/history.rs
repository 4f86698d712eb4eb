//! Undo and redo: snapshots of what the user has chosen, one a gesture.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

use super::choices::{Choices, Field, in_words};
use super::rows::Rows;
use super::session::Session;

/// The most steps that can be undone. A snapshot has a few kilobytes.
const MOST_STEPS: usize = 200;

/// Changes of the same things that come within this time are one step: a wheel over a number, a held arrow key.
const PAUSE: Duration = Duration::from_millis(700);

/// The steps behind and ahead of what the session holds.
#[derive(Debug, Default)]
pub(crate) struct History {
    /// The session as it was noted last.
    present: Option<Choices>,
    /// What can be undone, the last step last.
    done: VecDeque<Step>,
    /// What can be done again, the next step last.
    undone: Vec<Step>,
    /// The step that may still grow.
    open: Option<Open>,
}

/// One step.
#[derive(Debug)]
struct Step {
    /// What it changed, in words.
    title: String,
    /// The session at its other end: before it in `done`, after it in `undone`.
    choices: Choices,
}

/// The last step, while a change of the same things still belongs to it.
#[derive(Debug)]
struct Open {
    fields: Vec<Field>,
    until: Instant,
    /// The pointer's button has been down ever since.
    is_held: bool,
}

impl History {
    /// Looks at the session after a pass. `is_held` says that a button of the pointer is down: a drag is one step.
    pub(crate) fn note(&mut self, session: &Session, rows: &Rows, is_held: bool, now: Instant) {
        if let Some(open) = &mut self.open {
            open.is_held &= is_held;
        }
        let Some(present) = &self.present else {
            self.present = Some(Choices::of(session));
            return;
        };
        if present.are_of(session) {
            return;
        }
        let after = Choices::of(session);
        let fields = after.differences(present);
        // Nobody chose the first renderer, and files that come and go are no choice.
        if fields.is_empty() || present.is_without_renderer() {
            self.present = Some(after);
            return;
        }
        let before = self.present.replace(after.clone());
        self.undone.clear();
        let grows = self.open.as_ref().is_some_and(|open| {
            open.fields == fields && (open.is_held || now < open.until) && !self.done.is_empty()
        });
        if !grows && let Some(choices) = before {
            let title = in_words(&fields, rows);
            self.done.push_back(Step { title, choices });
            if self.done.len() > MOST_STEPS {
                self.done.pop_front();
            }
        }
        self.open = Some(Open {
            fields,
            until: now + PAUSE,
            is_held,
        });
        // There and back again is no step.
        self.done.pop_back_if(|step| {
            let is_back = after.differences(&step.choices).is_empty();
            if is_back {
                self.open = None;
            }
            is_back
        });
    }

    /// Takes the last step back; says what it changed.
    pub(crate) fn undo(&mut self, session: &mut Session) -> Option<String> {
        let Step { title, choices } = self.done.pop_back()?;
        let after = self.turn_to(&choices, session);
        self.undone.push(Step {
            title: title.clone(),
            choices: after,
        });
        Some(title)
    }

    /// Makes the step that was taken back last again; says what it changes.
    pub(crate) fn redo(&mut self, session: &mut Session) -> Option<String> {
        let Step { title, choices } = self.undone.pop()?;
        let before = self.turn_to(&choices, session);
        self.done.push_back(Step {
            title: title.clone(),
            choices: before,
        });
        Some(title)
    }

    /// Gives the session `choices`, and returns those that it had.
    fn turn_to(&mut self, choices: &Choices, session: &mut Session) -> Choices {
        let had = Choices::of(session);
        choices.restore(session);
        self.present = Some(Choices::of(session));
        self.open = None;
        had
    }

    /// What *Undo* would take back.
    pub(crate) fn next_undo(&self) -> Option<&str> {
        self.done.back().map(|step| step.title.as_str())
    }

    /// What *Redo* would make again.
    pub(crate) fn next_redo(&self) -> Option<&str> {
        self.undone.last().map(|step| step.title.as_str())
    }
}

#[cfg(test)]
#[path = "history_tests.rs"]
mod tests;
