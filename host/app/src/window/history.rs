//! Undo and redo: snapshots of what the user has chosen, one a gesture.

use std::collections::{HashMap, HashSet, VecDeque};
use std::time::{Duration, Instant};

use super::choices::{Choices, Field, in_words};
use super::rows::Rows;
use super::session::Session;

/// The most steps that can be undone. A snapshot has a few kilobytes, besides columns that it shares with the scene.
const MOST_STEPS: usize = 200;

/// The most memory for surfels that the scene does not hold any more and a step can bring back, bytes; the steps
/// farthest away are forgotten for it.
pub(crate) const MOST_HELD_BYTES: usize = 1 << 30;

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
    /// Whether there have ever been objects.
    has_had_objects: bool,
    /// Whether no step has been made since the first objects came.
    is_at_first_objects: bool,
    /// Whether the next change belongs to what came before it.
    is_joining: bool,
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
            let present = Choices::of(session);
            self.has_had_objects = present.has_objects();
            self.is_at_first_objects = self.has_had_objects;
            self.present = Some(present);
            return;
        };
        if present.are_of(session) {
            return;
        }
        let after = Choices::of(session);
        // Nobody goes back to before the first files.
        let joins = std::mem::take(&mut self.is_joining);
        let is_first = !self.has_had_objects && after.has_objects();
        self.has_had_objects |= is_first;
        self.is_at_first_objects |= is_first;
        if is_first || (joins && self.is_at_first_objects) {
            self.adopt_objects(&after);
        }
        let fields = match &self.present {
            Some(present) => after.differences(present),
            None => Vec::new(),
        };
        // Nobody chose the first renderer.
        let is_unchosen = self
            .present
            .as_ref()
            .is_none_or(Choices::is_without_renderer);
        if fields.is_empty() || is_unchosen {
            self.present = Some(after);
            return;
        }
        let before = self.present.replace(after.clone());
        self.undone.clear();
        self.is_at_first_objects = false;
        let is_at_once = fields.iter().any(Field::is_done_at_once);
        let grows = self.open.as_ref().is_some_and(|open| {
            let is_soon = open.is_held || now < open.until;
            // Each view that is put into the path or taken out is a step, however fast they come.
            let is_of_parts = fields.contains(&Field::PathParts);
            let is_more = open.fields == fields && is_soon && !is_at_once && !is_of_parts;
            let both_are_objects = is_at_once && open.fields.iter().any(Field::is_done_at_once);
            !self.done.is_empty() && (is_more || (joins && both_are_objects))
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
        if is_at_once {
            self.forget_beyond(MOST_HELD_BYTES);
        }
    }

    /// Says that the next change belongs to the last step: one more file of several that were opened together.
    pub(crate) fn join_next(&mut self) {
        self.is_joining = true;
    }

    /// Gives every snapshot these objects: there is no way back to before them.
    fn adopt_objects(&mut self, after: &Choices) {
        let steps = self.done.iter_mut().chain(&mut self.undone);
        let snapshots = steps.map(|step| &mut step.choices).chain(&mut self.present);
        snapshots.for_each(|choices| choices.adopt_objects(after));
    }

    /// Forgets steps until those that are left hold so many bytes that the scene does not: what could be made again first,
    /// the farthest steps first.
    fn forget_beyond(&mut self, most_bytes: usize) {
        while self.held_bytes() > most_bytes {
            if self.undone.is_empty() {
                self.done.pop_front();
            } else {
                self.undone.remove(0);
            }
        }
        if self.done.is_empty() {
            self.open = None;
        }
    }

    /// Bytes of columns that steps hold and the present does not.
    fn held_bytes(&self) -> usize {
        let shown: HashSet<usize> = self
            .present
            .iter()
            .flat_map(Choices::columns)
            .map(|(address, _)| address)
            .collect();
        let steps = self.done.iter().chain(&self.undone);
        let held: HashMap<usize, usize> = steps.flat_map(|step| step.choices.columns()).collect();
        let held = held.iter().filter(|(address, _)| !shown.contains(address));
        held.map(|(_, bytes)| bytes).sum()
    }

    /// Takes the session as it is: what changed since the last pass was no change of the user's.
    pub(crate) fn absorb(&mut self, session: &Session) {
        if self.present.is_some() {
            self.present = Some(Choices::of(session));
        }
    }

    /// Takes the last step back; says what it changed.
    pub(crate) fn undo(&mut self, session: &mut Session) -> Option<String> {
        let Step { title, choices } = self.done.pop_back()?;
        let after = self.turn_to(&choices, session);
        self.undone.push(Step {
            title: title.clone(),
            choices: after,
        });
        self.forget_beyond(MOST_HELD_BYTES);
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
        self.forget_beyond(MOST_HELD_BYTES);
        Some(title)
    }

    /// Gives the session `choices`, and returns those that it had.
    fn turn_to(&mut self, choices: &Choices, session: &mut Session) -> Choices {
        let had = Choices::of(session);
        choices.restore(session);
        self.present = Some(Choices::of(session));
        self.open = None;
        self.is_joining = false;
        self.is_at_first_objects = false;
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
