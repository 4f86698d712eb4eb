//! Carries out intents that make, unite and remove objects.

use std::time::Instant;

use pointstage_engine::stage::Severity;
use pointstage_scene::{Object, ObjectId, duplicate, merge};

use crate::window::app::App;
use crate::window::history::MOST_HELD_BYTES;
use crate::window::loading::{Finished, Merged};
use crate::window::tasks::guarded;

impl App {
    /// The selected objects, in order.
    pub(super) fn selected_objects(&self) -> Vec<ObjectId> {
        let objects = self.session.scene.objects().iter();
        objects
            .filter(|object| object.selected)
            .map(|object| object.id)
            .collect()
    }

    /// Changes an object, if it is there.
    pub(super) fn edit_object(&mut self, id: ObjectId, change: impl FnOnce(&mut Object)) {
        self.session.edit_scene(|scene| scene.edit(id, change));
    }

    /// Takes objects out of the scene, and says so if there is no way back.
    pub(super) fn remove_objects(&mut self, ids: &[ObjectId]) {
        let objects = ids.iter().filter_map(|id| self.session.scene.object(*id));
        let bytes: usize = objects.map(|object| object.geometry.byte_count()).sum();
        self.session.edit_scene(|scene| {
            for id in ids {
                scene.remove(*id);
            }
        });
        for id in ids {
            self.session.warnings.remove(id);
        }
        if bytes > MOST_HELD_BYTES {
            let text = format!(
                "What was removed is larger than the {} GiB that Undo keeps: it cannot be brought back.",
                MOST_HELD_BYTES >> 30
            );
            self.log.say(Severity::Info, text, Instant::now());
        }
    }

    /// Copies the selected objects; the copies are selected then.
    pub(super) fn duplicate_selected(&mut self) {
        let mut copies = Vec::new();
        for id in self.selected_objects() {
            let Some(object) = self.session.scene.object(id) else {
                continue;
            };
            let names = self.session.scene.objects().iter().chain(&copies);
            let names: Vec<&str> = names.map(|object| object.name.as_str()).collect();
            let copy = duplicate(object, name_of_copy(&object.name, &names));
            if let Some(warnings) = self.session.warnings.get(&id).cloned() {
                self.session.warnings.insert(copy.id, warnings);
            }
            copies.push(copy);
        }
        let Some(last) = copies.last().map(|copy| copy.id) else {
            return;
        };
        self.select(|_| false);
        self.session.edit_scene(|scene| {
            for copy in copies {
                scene.add(copy);
            }
        });
        self.session.active = Some(last);
    }

    /// Has the selected objects merged on the worker: it takes a while for large ones.
    pub(super) fn merge_selected(&mut self) {
        let objects = self.session.scene.objects().iter();
        let parts: Vec<Object> = objects.filter(|object| object.selected).cloned().collect();
        let Some(first) = parts.first() else {
            return;
        };
        let name = first.name.clone();
        let title = format!("Merge {} objects", parts.len());
        self.tasks.push(title, move |_| {
            guarded(
                || match merge(&parts.iter().collect::<Vec<_>>(), name) {
                    Ok(object) => Finished::Merged(Box::new(Merged { object, parts })),
                    Err(error) => Finished::Failed(error.to_string()),
                },
                |panic| {
                    Finished::Failed(format!(
                        "merging stopped by a defect ({panic}); the objects are as they were; please report it"
                    ))
                },
            )
        });
    }

    /// Puts a merged object in the place of its parts, if they still are what was merged.
    pub(in crate::window) fn take_merged(&mut self, merged: Merged) {
        let Merged { mut object, parts } = merged;
        let are_there = parts.iter().all(|part| {
            let now = self.session.scene.object(part.id);
            now.is_some_and(|now| now.revision == part.revision)
        });
        if !are_there {
            let text = "The objects have changed while they were merged: they stay as they are. Merge them again.";
            self.log.say(Severity::Warning, text, Instant::now());
            return;
        }
        object.selected = true;
        self.session.active = Some(object.id);
        self.session.edit_scene(|scene| {
            for part in &parts {
                scene.remove(part.id);
            }
            scene.add(object);
        });
        for part in &parts {
            self.session.warnings.remove(&part.id);
        }
    }
}

/// `bust copy`, or `bust copy 2` if that is taken; a copy of a copy counts on.
fn name_of_copy(name: &str, taken: &[&str]) -> String {
    let is_number = |text: &str| text.is_empty() || text.trim_start().parse::<u32>().is_ok();
    let stem = match name.rsplit_once(" copy") {
        Some((stem, number)) if is_number(number) => stem,
        _ => name,
    };
    let first = format!("{stem} copy");
    let others = (2..).map(|number: u32| format!("{stem} copy {number}"));
    let mut names = std::iter::once(first.clone()).chain(others);
    names
        .find(|name| !taken.contains(&name.as_str()))
        .unwrap_or(first)
}

#[cfg(test)]
#[path = "objects_tests.rs"]
pub(super) mod tests;
